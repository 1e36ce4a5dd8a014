//! A piece of a cut as one closed surface.

use super::Cut;
use crate::math::Point3;
use crate::surface::Surface;

/// How fine the surface of a piece is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkinSpec {
    /// Control points around and from pole to pole.
    pub counts: [usize; 2],
}

/// A piece as one surface.
#[derive(Clone, Debug)]
pub struct PieceSkin {
    /// Closed.
    pub surface: Surface,
    /// How far it is from the piece, m.
    pub off_m: f64,
    /// Edges of the piece along which it is sharp.
    pub creases: usize,
    /// Rims of its caps.
    pub rims: usize,
}

/// Why a piece has no such surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PieceSkinError {
    /// Always, here.
    #[error("piece {piece} has no surface of its own yet")]
    Stub {
        /// Which.
        piece: usize,
    },
}

impl Cut {
    /// A piece as one surface at rest.
    ///
    /// # Errors
    /// Always, here.
    pub fn skin(
        &self,
        piece: usize,
        _rest: &Surface,
        _matter: &mut dyn FnMut(&Point3) -> Point3,
        _spec: &SkinSpec,
    ) -> Result<PieceSkin, PieceSkinError> {
        Err(PieceSkinError::Stub { piece })
    }
}
