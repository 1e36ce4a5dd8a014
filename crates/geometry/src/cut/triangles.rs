//! Triangles of a piece, for contact, display and export.

use super::pieces::Cut;
use crate::part::{Fineness, Part, PartError, TrianglesError};
use crate::surface::{Mesh, SurfaceError};

/// Where a corner of a piece's triangles comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// A place of the surface, on a rim or within the skin: it goes where (u, v) goes.
    Skin {
        /// Parameter of the surface that was cut.
        u: f64,
        /// Parameter of the surface that was cut.
        v: f64,
    },
    /// Within a cap: a place of the plane, which goes with the matter.
    Cap,
}

/// Triangles of a piece: skin and caps share the points of their rims.
#[derive(Clone, Debug, PartialEq)]
pub struct CutMesh {
    /// Counter-clockwise seen from outside; closed where the surface was.
    pub mesh: Mesh,
    /// (corners).
    pub origins: Vec<Origin>,
    /// (triangles): the cap, as [`super::Piece::caps`] counts them; `None` on the skin.
    pub caps: Vec<Option<u32>>,
    /// The farthest that the middle of a triangle or of one of its sides is from the surface, or a rim from its chords, m.
    pub deviation_m: f64,
}

/// Why a piece was not divided into triangles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CutMeshError {
    /// Of a surface without a curve along its border.
    #[error(transparent)]
    Border(#[from] SurfaceError),
    /// Rims that bound nothing.
    #[error(transparent)]
    Part(#[from] PartError),
    /// Tolerance, count, coordinates.
    #[error(transparent)]
    Triangles(#[from] TrianglesError),
}

impl Cut {
    /// Triangles of a piece within `fineness.tolerance_m` of the surface.
    ///
    /// # Errors
    /// A tolerance that is not finite and above 0, more triangles than allowed.
    ///
    /// # Panics
    /// A number that is not of a piece.
    pub fn triangles(&self, piece: usize, fineness: &Fineness) -> Result<CutMesh, CutMeshError> {
        let part = Part::new(&self.brep(&[piece])?)?;
        let made = part.divided(fineness)?;
        let skins = self.pieces[piece].skins.len() as u32;
        let swapped = self.is_swapped();
        let origin = |place: Option<[f64; 2]>| match place {
            Some([v, u]) if swapped => Origin::Skin { u, v },
            Some([u, v]) => Origin::Skin { u, v },
            None => Origin::Cap,
        };
        Ok(CutMesh {
            mesh: made.mesh,
            origins: made.places.into_iter().map(origin).collect(),
            caps: (made.faces.into_iter())
                .map(|face| face.checked_sub(skins))
                .collect(),
            deviation_m: made.deviation_m,
        })
    }
}
