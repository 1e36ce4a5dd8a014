//! Laws of friction and of grips.

use palpate_geometry::math::Vector3;

/// Coulomb's law for a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Largest tangential over normal force while it sticks (> 0).
    pub mu: f64,
    /// The same while it slips, at most `mu`.
    pub mu_kinetic: f64,
    /// Drag of the whole contact against its slip, N·s/m.
    pub viscous_n_s_m: f64,
}

/// Where a row sticks: a place of the body, and how far from it the holder was. It lasts until the
/// row slips, so nothing that sweeps leave over, and no trembling of the hand, adds up to a walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stick {
    /// On the body's surface.
    pub u: f64,
    /// On the body's surface.
    pub v: f64,
    /// From there to the tool's reference point, m; in the tool's frame unless it is a ball.
    /// Between bodies, which have no such point: what the row has crept.
    pub offset: Vector3,
}

/// What a row may do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrictionLaw {
    /// It pushes, and resists slip by at most this multiple of its normal force.
    Push {
        /// μ (≥ 0).
        mu: f64,
        /// Drag for each metre it slips within the tick, N/m (≥ 0).
        drag_n_m: f64,
    },
    /// It holds in every direction.
    Grip {
        /// Greatest force, N.
        limit_n: f64,
    },
}

impl FrictionLaw {
    /// It pushes, and nothing else.
    pub const SMOOTH: Self = Self::Push {
        mu: 0.0,
        drag_n_m: 0.0,
    };

    /// A force across the normal may act.
    pub fn acts_across(&self) -> bool {
        *self != Self::SMOOTH
    }

    /// It pushes, with Coulomb's friction.
    pub fn coulomb(mu: f64) -> Self {
        Self::Push { mu, drag_n_m: 0.0 }
    }
}
