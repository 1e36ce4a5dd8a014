//! The surface of a piece, and how near to it that is.

use crate::surface::Surface;

/// A piece's boundary as one closed surface, or the piece of a sheet as one open surface.
#[derive(Clone, Debug)]
pub struct PieceSkin {
    /// Bicubic. A boundary is periodic in u, with poles at both ends of v, normals outwards. A sheet is periodic in u with a
    /// pole at the end of v, or none if it is a ring, or has four sides; its normals are those of the surface that was cut.
    pub surface: Surface,
    /// The farthest that a sample of the piece's boundary at rest is from the surface, m; samples are everywhere, also between
    /// those that were fitted.
    pub off_m: f64,
    /// How many of the rims are creases of the surface; 0 of a sheet.
    pub creases: usize,
    /// Rims of the piece, and creases that the surface had and that no rim meets, as those of a former cut.
    pub rims: usize,
}
