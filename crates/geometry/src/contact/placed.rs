//! A surface that stands against a body, where it is.

use super::pair::PairSide;
use crate::math::Pose;
use crate::skin::{Skin, SkinSolver};
use crate::surface::Surface;

/// A rigid surface where its tool stands.
#[derive(Debug)]
pub(super) struct PlacedSurface {
    pub skin: Skin,
    pub solver: SkinSolver,
}

impl PlacedSurface {
    pub fn new(at_rest: &Surface) -> Self {
        let skin = Skin::from(at_rest.clone());
        Self {
            solver: SkinSolver::new(&skin),
            skin,
        }
    }

    pub fn place(&mut self, at_rest: &Surface, pose: &Pose) {
        let now = self
            .skin
            .surface_mut()
            .map(|now| now.net_mut().points_mut());
        for (now, rest) in now.into_iter().flatten().zip(at_rest.net().points()) {
            *now = pose * rest;
        }
        self.solver.net_changed();
    }

    pub fn side(&mut self) -> Option<PairSide<'_>> {
        Some(PairSide {
            surface: self.skin.surface()?,
            solver: self.solver.surface_mut()?,
        })
    }
}
