//! How rows between rigid bodies end a tick: what is inside comes out slowly, and what meets may bounce.

use crate::scene::{Body, Scene};
use crate::solve::rows::{Holder, Row};
use palpate_geometry::math::Vector3;

/// Surfaces that are inside each other part no faster than this, m/s: a depth that was there before contact
/// must not become energy.
const PARTING_M_S: f64 = 0.05;

/// Surfaces that meet more slowly do not bounce, m/s; nor do those that meet no faster than gravity gives in
/// [`REST_TICKS`] ticks. Otherwise what lies on others would never come to rest.
const REST_M_S: f64 = 0.01;
const REST_TICKS: f64 = 4.0;

/// How rows between rigid bodies, of which one is free, end the tick: what lies inside is not thrown out, and
/// pairs with a restitution that are going to meet part.
pub(crate) fn meet(scene: &Scene, rows: &mut [Row]) {
    let most_m = PARTING_M_S * scene.dt_s;
    let gravity = Vector3::from(scene.spec.gravity.acceleration);
    let rest_m_s = REST_M_S.max(REST_TICKS * scene.dt_s * gravity.norm());
    for row in rows {
        let Some([body, holder]) = rigid_parties(scene, row.body as usize, row.holder) else {
            continue;
        };
        let restitution = scene.pairs[row.id.pair as usize].restitution;
        let meeting_m_s = (row.now_m - row.gap_m) / scene.dt_s;
        if meeting_m_s > rest_m_s {
            row.ease = 0.0;
        }
        let meets = restitution > 0.0 && row.gap_m < 0.0 && meeting_m_s > rest_m_s;
        let parting_m_s = meets.then(|| {
            let falls = |body: &Body| f64::from(!body.is_firm());
            let pull = row.normal.dot(&gravity) * (falls(body) - falls(holder));
            parting(restitution, meeting_m_s, row.now_m, pull, scene.dt_s)
        });
        if let Some(parting_m_s) = parting_m_s.flatten() {
            // Contact closes this gap and so gives that change of speed.
            row.gap_m = -(meeting_m_s + parting_m_s) * scene.dt_s;
        } else if row.now_m < -most_m {
            row.gap_m -= row.now_m + most_m;
        }
    }
}

/// Speed (m/s) at which surfaces part that would meet at `meeting_m_s` within a tick and are `now_m` apart
/// before it, pulled together with `pull` (m/s²); none where they do not come apart.
///
/// They turn round where they are and not where they would touch. The speed makes up for that, so that of the
/// energy that symplectic Euler keeps, v² / 2 + g (z − v dt / 2), the square of the restitution is left.
fn parting(restitution: f64, meeting_m_s: f64, now_m: f64, pull: f64, dt_s: f64) -> Option<f64> {
    debug_assert!(meeting_m_s >= 0.0, "surfaces that part");
    let touching = meeting_m_s * meeting_m_s + pull * (2.0 * now_m - dt_s * meeting_m_s);
    let half = 0.5 * pull * dt_s;
    let left = half * half + restitution * restitution * touching - 2.0 * pull * now_m;
    let parting = libm::sqrt(left.max(0.0)) - half;
    (parting > 0.0).then_some(parting)
}

/// Two rigid bodies, one of them free.
pub(crate) fn is_between_rigid(scene: &Scene, row: &Row) -> bool {
    are_rigid(scene, row.body as usize, row.holder)
}

/// A pair is of two rigid bodies.
pub(crate) fn are_rigid(scene: &Scene, body: usize, holder: Holder) -> bool {
    rigid_parties(scene, body, holder).is_some()
}

/// The body and the holder of a pair of two rigid bodies, of which one is free.
fn rigid_parties(scene: &Scene, body: usize, holder: Holder) -> Option<[&Body; 2]> {
    let Holder::Body(other) = holder else {
        return None;
    };
    let parties = [body, other as usize].map(|body| &scene.bodies[body]);
    let soft = parties.iter().any(|body| body.is_soft());
    (!soft).then_some(parties)
}
