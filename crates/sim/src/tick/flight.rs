//! Rigid bodies that contact and gravity move.
//!
//! ```text
//! Render   free motion      v* = v + dt g, x* = x + dt v*, R* = turned by L; rows see how far it takes them
//!          contact          a row's force f at the arm r moves the body by dt² (f / m + (I⁻¹ (r × f)) × r')
//! Deform   with its forces  v' = v* + dt Σ f / m, L' = L + dt Σ r × f, x' = x + dt v', R' = turned by L'
//! ```
//! That is symplectic Euler for the centre of mass and, for the rotation, the implicit midpoint rule of
//! [`Mass::turned`]. Contact takes all of the speed at which surfaces meet, unless the pair has a restitution
//! (Moreau 1988): then they part with that share of it. Angular momentum in the world changes by moments alone, so that in flight it keeps its bits.

use super::scratch::ToolScratch;
use super::{BodyScratch, load};
use crate::scene::{Body, Free, Mass, Mover, Scene};
use crate::solve::rows::{Holder, Row};
use crate::solve::solver::Solver;
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_geometry::stateful;

/// Ticks after which a body that is slow is at rest.
const CALM_TICKS: u32 = 100;
/// Slow is slower than so many times `sleep_m_s`: as for deforming bodies that lie on others, whose contact
/// points tremble.
const TREMBLES: f64 = 300.0;
/// Surfaces that are inside each other part no faster than this, m/s: a depth that was there before contact
/// must not become energy.
const PARTING_M_S: f64 = 0.05;

/// Surfaces that meet more slowly do not bounce, m/s; nor do those that meet no faster than gravity gives in
/// [`REST_TICKS`] ticks. Otherwise what lies on others would never come to rest.
const REST_M_S: f64 = 0.01;
const REST_TICKS: f64 = 4.0;

/// How a free rigid body moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flight {
    /// Of its centre of mass, m/s.
    pub velocity_m_s: Vector3,
    /// Angular momentum about its centre of mass, kg·m²/s; in the world.
    pub momentum: Vector3,
    /// Ticks for which it has been slow, up to [`CALM_TICKS`].
    calm: u32,
    /// It lies at rest and neither moves nor is looked at.
    left_alone: bool,
}

stateful!(Flight, |this, walk| {
    let Flight {
        velocity_m_s,
        momentum,
        calm,
        left_alone,
    } = this;
    walk.packed("rest of a free body", [(0, calm), (32, left_alone)])?;
    walk.ensure(*calm <= CALM_TICKS, "calm ticks", u64::from(*calm))?;
    walk.vector(velocity_m_s)?;
    walk.vector(momentum)
});

impl Flight {
    /// At the start.
    pub(super) fn start(free: &Free) -> Self {
        Self {
            velocity_m_s: free.velocity_m_s,
            momentum: free.mass.momentum(&free.mass.axes, &free.spin_rad_s),
            ..Self::default()
        }
    }

    /// It has been at rest for a while.
    pub(super) fn lies_calm(&self) -> bool {
        self.calm >= CALM_TICKS
    }

    /// It lies at rest and neither moves nor is looked at.
    pub(super) fn is_left_alone(&self) -> bool {
        self.left_alone
    }

    /// Leaves it alone, at rest, or takes it up again.
    pub(super) fn leave_alone(&mut self, left_alone: bool) {
        *self = match left_alone {
            true => Self {
                calm: CALM_TICKS,
                left_alone,
                ..Self::default()
            },
            false => Self {
                calm: 0,
                left_alone,
                ..*self
            },
        };
    }

    /// Where the body is after a tick, and how it moves then, under a force (N) and a moment about its
    /// centre (N·m) beside gravity.
    pub(super) fn after(
        &self,
        (position, rotation): (&Point3, &Rotation),
        free: &Free,
        gravity: &Vector3,
        (force_n, moment_nm): (&Vector3, &Vector3),
        dt_s: f64,
    ) -> (Point3, Rotation, Self) {
        let mass = &free.mass;
        let velocity_m_s = self.velocity_m_s + (gravity + force_n / mass.mass_kg) * dt_s;
        let momentum = self.momentum + moment_nm * dt_s;
        let rim_m_s = mass.spin(rotation, &momentum).norm() * mass.reach_m;
        let slow = velocity_m_s.norm() + rim_m_s < TREMBLES * free.sleep_m_s;
        let next = Self {
            velocity_m_s,
            momentum,
            calm: if slow {
                (self.calm + 1).min(CALM_TICKS)
            } else {
                0
            },
            left_alone: false,
        };
        (
            position + velocity_m_s * dt_s,
            mass.turned(rotation, &momentum, dt_s),
            next,
        )
    }
}

/// What a free body gives way in one tick, in the pose it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gives {
    /// Centre of mass, m.
    centre: Point3,
    /// From its principal axes to the world.
    rotation: Rotation,
    /// The principal axes, in the world.
    axes: [Vector3; 3],
    /// dt² / m, m/N.
    pub shift_m_n: f64,
    /// dt² / I about each axis, rad/(N·m).
    pub turn_rad_nm: [f64; 3],
}

impl Gives {
    pub(super) fn new(mass: &Mass, position: &Point3, rotation: &Rotation, dt_s: f64) -> Self {
        Self {
            centre: *position,
            rotation: *rotation,
            axes: [0, 1, 2].map(|k| rotation * Vector3::ith(k, 1.0)),
            shift_m_n: dt_s * dt_s / mass.mass_kg,
            turn_rad_nm: mass.moments_kg_m2.map(|moment| dt_s * dt_s / moment),
        }
    }

    /// From the centre of mass to where a row acts, m: on a tool's row where it is on the body, on others
    /// in the middle between both surfaces, so that two bodies keep their angular momentum together.
    pub(super) fn arm(&self, row: &Row) -> Vector3 {
        let place = match row.tool() {
            Some(_) => row.point,
            None => row.point + row.normal * (0.5 * row.now_m),
        };
        place - self.centre
    }

    /// How a moment turns it, rad.
    pub(super) fn turned(&self, moment: &Vector3) -> Vector3 {
        let parts = self.axes.iter().zip(&self.turn_rad_nm);
        parts
            .map(|(axis, gain)| axis * (gain * axis.dot(moment)))
            .sum()
    }

    /// How a turn by one rad about each of its axes moves a point at an arm, m.
    pub(super) fn moves(&self, arm: &Vector3) -> [Vector3; 3] {
        self.axes.map(|axis| axis.cross(arm))
    }

    /// A point of the world, from the centre of mass in the principal axes, m.
    pub(super) fn to_body(self, point: &Point3) -> Vector3 {
        self.rotation
            .inverse_transform_vector(&(point - self.centre))
    }

    /// The reverse.
    pub(super) fn to_world(self, place: &Vector3) -> Point3 {
        self.centre + self.rotation * place
    }
}

impl BodyScratch {
    /// What the body gives way in this tick, when it is rigid and free.
    pub(super) fn gives(&self) -> Option<&Gives> {
        self.rigid.as_ref()?.gives.as_ref()
    }
}

/// Where a row acts on its holder, m.
pub(super) fn on_holder(row: &Row) -> Point3 {
    row.point + row.normal * row.now_m
}

/// Force (N) and moment about its centre of mass (N·m) of the contacts of the tick on a free body.
pub(super) fn load_on(
    rows: &[Row],
    solver: &Solver,
    tools: &[ToolScratch],
    body: usize,
    gives: &Gives,
) -> (Vector3, Vector3) {
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for (i, row) in rows.iter().enumerate() {
        for (sign, _) in row.sides_on(body) {
            if solver.carries(i) {
                let push = load::on_bodies(row, i, solver, tools) * sign;
                force += push;
                moment += gives.arm(row).cross(&push);
            }
        }
    }
    (force, moment)
}

/// How rows between rigid bodies, of which one is free, end the tick: what lies inside is not thrown out, and
/// pairs with a restitution that are going to meet part.
pub(super) fn meet(scene: &Scene, rows: &mut [Row]) {
    let most_m = PARTING_M_S * scene.dt_s;
    let gravity = Vector3::from(scene.spec.gravity.acceleration);
    let rest_m_s = REST_M_S.max(REST_TICKS * scene.dt_s * gravity.norm());
    for row in rows {
        let Some([body, holder]) = rigid_parties(scene, row) else {
            continue;
        };
        let restitution = scene.pairs[row.id.pair as usize].restitution;
        let meeting_m_s = (row.now_m - row.gap_m) / scene.dt_s;
        let meets = restitution > 0.0 && row.gap_m < 0.0 && meeting_m_s > rest_m_s;
        let parting_m_s = meets.then(|| {
            let falls = |body: &Body| f64::from(body.free().is_some());
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
    let touching = meeting_m_s * meeting_m_s + pull * (2.0 * now_m - dt_s * meeting_m_s);
    let half = 0.5 * pull * dt_s;
    let left = half * half + restitution * restitution * touching - 2.0 * pull * now_m;
    let parting = libm::sqrt(left.max(0.0)) - half;
    (parting > 0.0).then_some(parting)
}

/// Two rigid bodies, one of them free.
pub(super) fn is_between_rigid(scene: &Scene, row: &Row) -> bool {
    rigid_parties(scene, row).is_some()
}

/// The body and the holder of a row between two rigid bodies, of which one is free.
fn rigid_parties<'s>(scene: &'s Scene, row: &Row) -> Option<[&'s Body; 2]> {
    let Holder::Body(other) = row.holder else {
        return None;
    };
    let parties = [row.body, other].map(|body| &scene.bodies[body as usize]);
    let rigid = |body: &Body| body.is_firm() || body.free().is_some();
    parties.into_iter().all(rigid).then_some(parties)
}

/// How a free rigid body moves, for whoever measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// kg.
    pub mass_kg: f64,
    /// Centre of mass, m.
    pub centre: Point3,
    /// Of it, m/s.
    pub velocity_m_s: Vector3,
    /// rad/s; in the world.
    pub spin_rad_s: Vector3,
    /// About the centre of mass, kg·m²/s; in the world.
    pub momentum: Vector3,
    /// Of the motion, J.
    pub energy_j: f64,
}

impl RigidMotion {
    pub(super) fn of(mover: &Mover, state: &super::RigidState) -> Option<Self> {
        let (mass, flight) = (&mover.free()?.mass, state.flight()?);
        let spin_rad_s = mass.spin(&state.rotation, &flight.momentum);
        let velocity_m_s = flight.velocity_m_s;
        Some(Self {
            mass_kg: mass.mass_kg,
            centre: state.position,
            velocity_m_s,
            spin_rad_s,
            momentum: flight.momentum,
            energy_j: 0.5 * mass.mass_kg * velocity_m_s.norm_squared()
                + 0.5 * flight.momentum.dot(&spin_rad_s),
        })
    }
}
