//! How rows between rigid bodies end a tick: what is inside comes out slowly, and what meets may bounce.

use crate::scene::{Body, Scene};
use crate::solve::impacts::Impacts;
use crate::solve::matrix::ContactMatrix;
use crate::solve::rows::{Holder, Row};
use palpate_geometry::math::Vector3;

/// Surfaces that are inside each other part no faster than this, m/s: a depth that was there before contact
/// must not become energy.
const PARTING_M_S: f64 = 0.05;

/// Surfaces that meet more slowly do not bounce, m/s; nor do those that meet no faster than gravity gives in
/// [`REST_TICKS`] ticks. Otherwise what lies on others would never come to rest.
const REST_M_S: f64 = 0.01;
const REST_TICKS: f64 = 4.0;

/// How much more than by its bodies a row gives way that meets, so that more rows than bodies have ways to move have
/// an answer.
pub(super) const TRACE: f64 = 1e-3;

/// What lies inside another rigid body, of which one is free, is not thrown out.
pub(crate) fn meet(scene: &Scene, rows: &mut [Row]) {
    let most_m = PARTING_M_S * scene.dt_s;
    let rest_m_s = rest_m_s(scene);
    for row in rows {
        if !is_between_rigid(scene, row) {
            continue;
        }
        if (row.now_m - row.gap_m) / scene.dt_s > rest_m_s {
            row.regularization = row.regularization.min(TRACE);
        }
        if row.now_m < -most_m {
            row.gap_m -= row.now_m + most_m;
        }
    }
}

/// Below this nothing bounces, m/s.
fn rest_m_s(scene: &Scene) -> f64 {
    let gravity = Vector3::from(scene.spec.gravity.acceleration);
    REST_M_S.max(REST_TICKS * scene.dt_s * gravity.norm())
}

/// Rows of pairs with a restitution that meet within the tick part as fast as they do after all impacts.
pub(crate) fn part(scene: &Scene, rows: &mut [Row], matrix: &ContactMatrix, impacts: &mut Impacts) {
    let restitution = |row: &Row| scene.pairs[row.id.pair as usize].restitution;
    if rows.iter().all(|row| restitution(row) <= 0.0) {
        return;
    }
    let gravity = Vector3::from(scene.spec.gravity.acceleration);
    let (rest_m_s, dt_s) = (rest_m_s(scene), scene.dt_s);
    let most_m = PARTING_M_S * dt_s;
    let closing_m_s = |row: &Row| match is_between_rigid(scene, row) {
        // Bodies that overlap are pushed apart slowly; that is not a speed at which they meet.
        true => (row.now_m.max(-most_m) - row.gap_m) / dt_s,
        false => 0.0,
    };
    let parts = |i: usize, meeting_m_s: f64| {
        let row = &rows[i];
        let [body, holder] = rigid_parties(scene, row.body as usize, row.holder)?;
        let meets = restitution(row) > 0.0
            && meeting_m_s > rest_m_s
            && row.now_m.max(-most_m) < meeting_m_s * dt_s;
        let falls = |body: &Body| f64::from(!body.is_firm());
        let pull = row.normal.dot(&gravity) * (falls(body) - falls(holder));
        let parting = || parting(restitution(row), meeting_m_s, row.now_m, pull, dt_s);
        meets.then(parting).flatten()
    };
    let of_rows = rows.iter().map(|row| (row.id.pair, closing_m_s(row)));
    impacts.run(matrix, dt_s, of_rows, parts);
    for (row, impact) in rows.iter_mut().zip(impacts.rows()) {
        if impact.struck {
            // Contact closes this gap and so gives that change of speed.
            let parting_m_s = (-impact.meeting_m_s).max(0.0);
            let met_m_s = closing_m_s(row);
            (row.gap_m, row.regularization) = (-(met_m_s + parting_m_s) * dt_s, 0.0);
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
    let parties = [body, other as usize].map(|body| &*scene.bodies[body]);
    let soft = parties.iter().any(|body| body.is_soft());
    (!soft).then_some(parties)
}
