//! Truncation: two overlapping bodies get a common wall, as deep in one as in the other.
//!
//! With signed distances φ, negative inside, A′ = A \ {x ∈ B : φ_B < φ_A} and B′ = B \ {x ∈ A : φ_A ≤ φ_B}. The wall is
//! {φ_A = φ_B ≤ 0}, and its edges are the curves in which the surfaces cross. So nothing overlaps any more, nothing of the
//! union is lost, and neither body is preferred: of equal spheres the wall is a plane, of others a sheet of a hyperboloid.
//!
//! ```text
//! fields   signed distances, places on both surfaces, places where both are equally deep
//! rim      the curves in which the surfaces cross, as B-splines
//! sheet    a lattice around the wall ──▶ triangles: how many pieces there are, and which rims end each
//! flat     a piece laid out flat: a disc or a ring
//! wall     a grid of places on the wall ──▶ a B-spline between its rims
//! kept     which rims bound the same region of a surface
//! solid    faces, edges, shells ──▶ parts; volumes; places on either side compared
//! ```

mod error;
mod fields;
mod flat;
mod kept;
mod rim;
mod sheet;
mod solid;
#[cfg(test)]
mod tests;
mod wall;

pub use error::TruncateError;

use self::fields::Fields;
use crate::isolate::{Body, IsolateError};
use palpate_geometry::part::{Brep, Part};
use palpate_geometry::surface::Surface;

/// Of the smaller body's size: how far the wall may be from where it should be.
const USUAL_TOLERANCE: f64 = 1e-4;
/// Cells in which a surface is checked for crossing itself.
const CHECKED: [usize; 2] = [48, 24];
/// Places of a surface in u and v that are compared with the other one.
const PLACES: usize = 24;
/// Of the size: nearer to a surface than this, a place lies on it.
const ON: f64 = 1e-7;
/// More of the places than this on the other surface: the surfaces lie on each other.
const MOST_ON: f64 = 0.02;

/// What to ask.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TruncateSpec {
    /// How far the wall may be from {φ_A = φ_B}, m; 1e-4 of the size of the smaller body's net if absent.
    pub tolerance_m: Option<f64>,
}

/// A connected piece of the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPiece {
    /// Curves that bound it: 1 of a disc, 2 of a ring.
    pub rims: usize,
    /// Control points in u, round it, and in v.
    pub net: [usize; 2],
    /// Largest |φ_A − φ_B| between the places of the fit, m.
    pub uneven_m: f64,
    /// Largest distance from {φ_A = φ_B} there, m.
    pub off_m: f64,
}

/// Two bodies with a common wall.
#[derive(Clone, Debug)]
pub struct Truncated {
    /// A′ and B′ as boundaries: faces on the given surfaces, then the pieces of the wall; m.
    pub breps: [Brep; 2],
    /// What the boundaries make: A′ and B′ as parts.
    pub parts: [Part; 2],
    /// Pieces of the wall.
    pub walls: Vec<WallPiece>,
    /// As asked, m.
    pub tolerance_m: f64,
    /// Volumes of A, B and of what both have, m³.
    pub before_m3: [f64; 3],
    /// Volumes of A′ and B′, m³.
    pub volumes_m3: [f64; 2],
}

impl Truncated {
    /// The wall is nowhere farther off than asked.
    pub fn within_tolerance(&self) -> bool {
        self.walls.iter().all(|wall| wall.off_m <= self.tolerance_m)
    }

    /// |A ∪ B|, m³.
    pub fn union_m3(&self) -> f64 {
        let [a, b, both] = self.before_m3;
        a + b - both
    }
}

/// Truncates two bodies; `None` where they do not overlap.
///
/// # Errors
/// Surfaces that bound no solid, one body inside the other, surfaces that lie on each other or are tangent where they cross,
/// a wall that is neither discs nor rings.
///
/// # Examples
/// ```
/// use palpate_geometry::math::Pose;
/// use palpate_geometry::surface::builtin;
/// use palpate_modeling::truncate::{TruncateSpec, truncate};
/// let a = builtin("sphere", None, Some(0.05))?; // radius 50 mm
/// let b = a.transformed(&Pose::translation(0.08, 0.0, 0.0));
/// let two = truncate(&a, &b, &TruncateSpec::default())?.ok_or("they overlap")?;
/// // Each loses a cap of height 10 mm: π h² (3 r − h) / 3.
/// let cap = std::f64::consts::PI * 0.01 * 0.01 * (0.15 - 0.01) / 3.0;
/// assert!((a.volume() - two.volumes_m3[0] - cap).abs() < 1e-9 * a.volume());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn truncate(
    a: &Surface,
    b: &Surface,
    spec: &TruncateSpec,
) -> Result<Option<Truncated>, TruncateError> {
    let bodies = [solid(a, 0)?, solid(b, 1)?];
    let mut fields = Fields::new([&bodies[0], &bodies[1]]);
    let tolerance_m = spec.tolerance_m.unwrap_or(USUAL_TOLERANCE * fields.size_m);
    if !(tolerance_m > 0.0 && tolerance_m.is_finite()) {
        return Err(TruncateError::Tolerance(tolerance_m));
    }
    let inside = compared(&mut fields)?;
    let rims = rim::rims(&mut fields)?;
    if rims.is_empty() {
        return without_rims(inside, fields.size_m);
    }
    let walls = wall::walls(&mut fields, &rims, tolerance_m)?;
    solid::truncated(&mut fields, &rims, &walls, tolerance_m).map(Some)
}

/// A closed surface with its normals outwards.
fn solid(surface: &Surface, body: usize) -> Result<Surface, TruncateError> {
    match Body::new(surface, CHECKED, body) {
        Ok(_) => {
            // Parts go round a face in u where they go round it one way.
            let topology = surface.topology();
            let turned = topology.wraps(1) && !topology.wraps(0);
            let surface = if turned {
                surface.swap_uv()
            } else {
                surface.clone()
            };
            Ok(surface.oriented_outward())
        }
        Err(IsolateError::Open { .. }) => Err(TruncateError::Open { body }),
        Err(IsolateError::SelfIntersecting { at, .. }) => {
            Err(TruncateError::SelfCrossing { body, at })
        }
        Err(_) => Err(TruncateError::NoVolume { body }),
    }
}

/// The least and the greatest signed distance of places of each surface to the other body, m.
fn compared(fields: &mut Fields<'_>) -> Result<[[f64; 2]; 2], TruncateError> {
    let within_m = ON * fields.size_m;
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for body in 0..2 {
        let surface = fields.surfaces[body];
        let mut on = 0.0;
        let [u, v] = [surface.knots_u(), surface.knots_v()].map(|knots| {
            let (low, high) = knots.domain();
            (0..PLACES).map(move |k| low + (high - low) * (k as f64 + 0.5) / PLACES as f64)
        });
        for u in u {
            for v in v.clone() {
                let phi = fields.phi(1 - body, &surface.point(u, v));
                ranges[body] = [ranges[body][0].min(phi), ranges[body][1].max(phi)];
                on += f64::from(u8::from(phi.abs() <= within_m));
            }
        }
        let share = on / (PLACES * PLACES) as f64;
        if share > MOST_ON {
            return Err(TruncateError::Coincident {
                share: 100.0 * share,
                within_m,
            });
        }
    }
    Ok(ranges)
}

/// What surfaces are that do not cross.
fn without_rims(ranges: [[f64; 2]; 2], size_m: f64) -> Result<Option<Truncated>, TruncateError> {
    let on_m = ON * size_m;
    for (inner, range) in ranges.iter().enumerate() {
        if range[1] <= on_m {
            let outer = 1 - inner;
            return Err(TruncateError::Contained { inner, outer });
        }
    }
    let depth_m = -ranges[0][0].min(ranges[1][0]);
    match depth_m > on_m {
        true => Err(TruncateError::NoCurve { depth_m }),
        false => Ok(None),
    }
}
