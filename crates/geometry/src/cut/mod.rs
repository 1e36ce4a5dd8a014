//! A surface cut by a plane: its pieces, with the loops and caps that bound them, and their measures.
//!
//! ```text
//! n · S − offset, by Bézier pieces ──▶ rectangles in which the curve is nothing or one graph ──▶ regions, loops
//! regions ──▶ integrals;  loops ──▶ rims in space and in (u, v) ──▶ caps ──▶ pieces ──▶ Brep, triangles
//! triangles at rest ──▶ sections between rims, laid out ──▶ one closed surface of a piece
//! triangles of a sheet's piece at rest ──▶ disc, ring or rectangle ──▶ one open surface of it
//! ```
//! The curve is found with certainty: a rectangle is halved until Bernstein coefficients show that it has no zero, or that
//! the field is monotone across it and has one root at most on each side (Descartes). What stays unclear at a millionth of a
//! span is one point: a saddle in the plane, or a place where the surface touches it. There, what is left and right of the
//! point does not hang together.

mod brep;
mod caps;
mod field;
mod graph;
mod grid;
mod leaves;
mod measure;
mod pieces;
mod regions;
mod rim;
mod skin;
#[cfg(test)]
mod tests;
mod triangles;

pub use pieces::{Cap, Cut, Piece, cut_by_plane, cut_sheet_by_plane};
pub use rim::RimPiece;
pub use skin::{LEAST_COUNTS, PieceSkin, PieceSkinError, SheetSpec, SkinSpec};
pub use triangles::{CutMesh, CutMeshError, Origin};

use crate::math::{Point3, Vector3};

/// n · x = offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutPlane {
    /// Of unit length; it points to what is above.
    pub normal: Vector3,
    /// Of the plane from the origin along the normal, m.
    pub offset_m: f64,
}

impl CutPlane {
    /// Through a point (m), across a direction of any length; `None` where the direction has none or a number is not finite.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::cut::CutPlane;
    /// use palpate_geometry::math::{Point3, Vector3};
    /// let plane = CutPlane::through(&Point3::new(0.0, 0.0, 0.03), &(2.0 * Vector3::z())).expect("a direction");
    /// assert_eq!((plane.normal, plane.offset_m), (Vector3::z(), 0.03));
    /// assert!(CutPlane::through(&Point3::origin(), &Vector3::zeros()).is_none());
    /// ```
    pub fn through(point: &Point3, direction: &Vector3) -> Option<Self> {
        let normal = crate::math::direction_of(direction)?;
        let offset_m = normal.dot(&point.coords);
        offset_m.is_finite().then_some(Self { normal, offset_m })
    }

    /// The foot of the origin on it, m.
    pub fn origin(&self) -> Point3 {
        Point3::from(self.normal * self.offset_m)
    }

    /// The height of a point above it, m.
    pub fn height(&self, point: &Point3) -> f64 {
        self.normal.dot(&point.coords) - self.offset_m
    }
}

/// Why a surface was not cut.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CutError {
    /// The plane and the surface have no curve in common.
    #[error(
        "the plane does not cut the surface: all of it is {} the plane, the nearest of it {distance_m:.3e} m away; move the \
         plane",
        if *above { "above" } else { "below" }
    )]
    Misses {
        /// The surface is on the side that the normal points to.
        above: bool,
        /// Between the plane and the net's nearest sample of the surface, m; 0 where it touches the plane.
        distance_m: f64,
    },
    /// Patches joined in ways of their own, or sides of a knot that are apart.
    #[error(
        "a surface of joined patches, or one that comes apart at a knot, cannot be cut: fit one surface to it with `palpate \
         surface fit`"
    )]
    Joined,
    /// A curve without end in detail.
    #[error(
        "the curve of surface and plane takes more than {most} rectangles: move or tilt the plane by a millionth of the size"
    )]
    TooFine {
        /// As allowed.
        most: usize,
    },
    /// Rounding hides how the curve goes on.
    #[error(
        "how the curve of surface and plane goes on near (u, v) = ({u}, {v}) is lost in rounding, as where the surface lies in \
         the plane: move or tilt the plane by a millionth of the size"
    )]
    Unclear {
        /// Parameter of the surface.
        u: f64,
        /// Parameter of the surface.
        v: f64,
    },
    /// A rim within no other: the surface passes through itself.
    #[error(
        "the surface passes through itself where the plane cuts it near ({x:.6} m, {y:.6} m, {z:.6} m): its inside is not known \
         there"
    )]
    Crossed {
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// m.
        z: f64,
    },
}
