//! How a free rigid body moves, and what it gives way.

use crate::body::stillness::{BORNE, Stillness};
use crate::scene::{Free, Mass};
use crate::solve::rows::Row;
use palpate_geometry::math::{Matrix3, Point3, Rotation, Vector3};
use palpate_geometry::stateful;

/// How a free rigid body moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flight {
    /// Of its centre of mass, m/s.
    pub velocity_m_s: Vector3,
    /// Angular momentum about its centre of mass, kg·m²/s; in the world.
    pub momentum: Vector3,
    /// Since when it stays where it is.
    stillness: Stillness,
    /// It lies at rest and neither moves nor is looked at.
    left_alone: bool,
}

stateful!(Flight, |this, walk| {
    let Flight {
        velocity_m_s,
        momentum,
        stillness: Stillness { from, steps },
        left_alone,
    } = this;
    walk.packed("rest of a free body", [(0, steps), (32, left_alone)])?;
    walk.triples(from)?;
    walk.vector(velocity_m_s)?;
    walk.vector(momentum)
});

impl Flight {
    /// At the start.
    pub(crate) fn start(free: &Free) -> Self {
        Self {
            velocity_m_s: free.velocity_m_s,
            momentum: free.mass.momentum(&free.mass.axes, &free.spin_rad_s),
            ..Self::default()
        }
    }

    /// It has been at rest for a while.
    pub(crate) fn lies_still(&self) -> bool {
        self.stillness.is_long()
    }

    /// It lies at rest and neither moves nor is looked at.
    pub(crate) fn is_left_alone(&self) -> bool {
        self.left_alone
    }

    /// Leaves it alone, at rest, or takes it up again.
    pub(crate) fn leave_alone(&mut self, left_alone: bool) {
        self.left_alone = left_alone;
        if left_alone {
            (self.velocity_m_s, self.momentum) = Default::default();
        } else {
            self.stillness.steps = 0;
        }
    }

    /// Where the body is after a tick, and how it moves then, under a force (N) and a moment about its
    /// centre (N·m) beside gravity.
    pub(crate) fn after(
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
        let spin_rad_s = mass.spin(rotation, &momentum);
        let place = position + velocity_m_s * dt_s;
        let turned = mass.turned(rotation, &momentum, dt_s);
        let gained = (velocity_m_s - self.velocity_m_s).norm()
            + (spin_rad_s - mass.spin(rotation, &self.momentum)).norm() * mass.reach_m;
        let mut stillness = self.stillness;
        stillness.count(
            || {
                let axes = turned.to_rotation_matrix().into_inner() * mass.reach_m;
                let axis = |k| axes.column(k).into_owned();
                [place.coords, axis(0), axis(1), axis(2)]
            },
            velocity_m_s.norm() + spin_rad_s.norm() * mass.reach_m,
            gained <= BORNE * gravity.norm() * dt_s,
            free.sleep_m_s,
            dt_s,
        );
        let next = Self {
            velocity_m_s,
            momentum,
            stillness,
            left_alone: false,
        };
        (place, turned, next)
    }
}

/// What a free body gives way in one tick, in the pose it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gives {
    /// Centre of mass, m.
    centre: Point3,
    /// From its principal axes to the world.
    rotation: Rotation,
    /// dt² / m, m/N.
    shift_m_n: f64,
    /// dt² I⁻¹ in the world, rad/(N·m).
    turn_rad_nm: Matrix3,
}

impl Gives {
    pub(crate) fn new(mass: &Mass, position: &Point3, rotation: &Rotation, dt_s: f64) -> Self {
        debug_assert!(mass.mass_kg > 0.0, "a body without mass");
        let gains = Vector3::from(mass.moments_kg_m2.map(|moment| dt_s * dt_s / moment));
        let axes = rotation.to_rotation_matrix().into_inner();
        Self {
            centre: *position,
            rotation: *rotation,
            shift_m_n: dt_s * dt_s / mass.mass_kg,
            turn_rad_nm: axes * Matrix3::from_diagonal(&gains) * axes.transpose(),
        }
    }

    /// m / dt², N/m, and I / dt² in the world, N·m/rad.
    pub(crate) fn inertia(&self, mass: &Mass, dt_s: f64) -> (f64, Matrix3) {
        let per_square = 1.0 / (dt_s * dt_s);
        let moments = Vector3::from(mass.moments_kg_m2) * per_square;
        let axes = self.rotation.to_rotation_matrix().into_inner();
        let turned = axes * Matrix3::from_diagonal(&moments) * axes.transpose();
        (mass.mass_kg * per_square, turned)
    }

    /// From the centre of mass to where a row acts, m: on a tool's row where it is on the body, on others
    /// in the middle between both surfaces, so that two bodies keep their angular momentum together.
    pub(crate) fn arm(&self, row: &Row) -> Vector3 {
        let place = match row.tool() {
            Some(_) => row.point,
            None => row.point + row.normal * (0.5 * row.now_m),
        };
        place - self.centre
    }

    /// How a moment moves a row by turning the body: (dt² I⁻¹ moment) × r, 1/N.
    pub(crate) fn turned(&self, row: &Row) -> Matrix3 {
        self.arm(row).cross_matrix().transpose() * self.turn_rad_nm
    }

    /// What a force at row b does at a row that is [turned](Gives::turned) like this, m/N: dt² / m, and by turning
    /// the body dt² (I⁻¹ (r_b × f)) × r_a.
    pub(crate) fn block(&self, turned: &Matrix3, b: &Row) -> Matrix3 {
        Matrix3::from_diagonal_element(self.shift_m_n) + turned * self.arm(b).cross_matrix()
    }

    /// A point of the world, from the centre of mass in the principal axes, m.
    pub(crate) fn to_body(self, point: &Point3) -> Vector3 {
        self.rotation
            .inverse_transform_vector(&(point - self.centre))
    }

    /// The reverse.
    pub(crate) fn to_world(self, place: &Vector3) -> Point3 {
        self.centre + self.rotation * place
    }
}

/// How a free rigid body moves.
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
    pub(super) fn of(
        mass: &Mass,
        (position, rotation): (&Point3, &Rotation),
        flight: &Flight,
    ) -> Self {
        let spin_rad_s = mass.spin(rotation, &flight.momentum);
        let velocity_m_s = flight.velocity_m_s;
        Self {
            mass_kg: mass.mass_kg,
            centre: *position,
            velocity_m_s,
            spin_rad_s,
            momentum: flight.momentum,
            energy_j: 0.5 * mass.mass_kg * velocity_m_s.norm_squared()
                + 0.5 * flight.momentum.dot(&spin_rad_s),
        }
    }
}
