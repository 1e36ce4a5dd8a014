//! Membranes that are cut: their pieces are sheets without caps, and areas count for volumes.

use super::Scene;
use crate::body::membrane_area_m2;
use palpate_geometry::cut::{
    Cut, CutError, CutPlane, PieceSkin, PieceSkinError, SheetSpec, cut_sheet_by_plane,
};
use palpate_geometry::surface::Surface;

/// A surface that misses its piece by more than this, relative to the piece's size, is made once more with a finer net.
const FAR: f64 = 1e-3;
/// How many times closer together the control points of a finer net are, and how many it has at most.
const FINER: f64 = 1.5;
const MOST: usize = 900;

/// A membrane that is cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct CutMembrane {
    thickness_m: f64,
    /// About how far apart its control points are, m.
    spacing_m: f64,
}

impl CutMembrane {
    /// `None` of bodies of other kinds.
    pub fn of(scene: &Scene, body: usize) -> Option<Self> {
        let spec = &scene.spec.bodies[body];
        let thickness_m = spec.lattice.thickness_m?;
        let rest = scene.rest_surface(body)?;
        let count = scene.deformable(body)?.rest().len().max(1);
        scene.is_membrane(body).then(|| Self {
            thickness_m,
            spacing_m: libm::sqrt(rest.area() / count as f64),
        })
    }

    /// As it stands. The volume of a piece is its area times the thickness.
    pub fn cut(&self, surface: &Surface, plane: &CutPlane) -> Result<Cut, CutError> {
        let mut cut = cut_sheet_by_plane(surface, plane)?;
        for piece in &mut cut.pieces {
            piece.volume_m3 = piece.skin_area_m2 * self.thickness_m;
        }
        Ok(cut)
    }

    /// A piece at rest as one surface.
    pub fn skin(
        &self,
        cut: &Cut,
        piece: usize,
        rest: &Surface,
    ) -> Result<PieceSkin, PieceSkinError> {
        let made = |spacing_m: f64| cut.sheet(piece, rest, &SheetSpec { spacing_m });
        let far_m = FAR * libm::sqrt(cut.pieces[piece].skin_area_m2);
        let skin = match made(self.spacing_m) {
            Ok(skin) if skin.off_m <= far_m => return Ok(skin),
            Err(error) if !matches!(error, PieceSkinError::Folded { .. }) => return Err(error),
            skin => skin,
        };
        match (made(self.spacing_m / FINER), skin) {
            (Ok(finer), Ok(skin)) if finer.off_m < skin.off_m && points(&finer) <= MOST => {
                Ok(finer)
            }
            (finer, Err(_)) => finer,
            (_, skin) => skin,
        }
    }

    /// The volume that counts for the mass of a surface at rest, m³.
    pub fn volume_m3(&self, surface: &Surface) -> f64 {
        membrane_area_m2(surface) * self.thickness_m
    }
}

fn points(skin: &PieceSkin) -> usize {
    skin.surface.net().points().len()
}
