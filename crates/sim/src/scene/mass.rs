//! Mass, centre and moments of inertia of the matter inside a closed surface.
//!
//! The divergence theorem makes integrals over the volume integrals over the surface, with the area
//! vector N = S_u × S_v and x from the middle of the net:
//!
//! ```text
//! V          = 1/3 ∮ x · N du dv
//! ∫ x_i dV   = 1/2 ∮ x_i² N_i du dv
//! ∫ x_i² dV  = 1/3 ∮ x_i³ N_i du dv        ∫ x_i x_j dV = 1/2 ∮ x_i² x_j N_i du dv
//! ```
//! In each knot span the integrands are polynomials of a degree of at most 5p − 1, so that Gauss's rule
//! with 5p/2 points is exact up to rounding. With weights it is not, and takes more points.

use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{
    Matrix3, Point3, Rotation, Vector3, gauss_legendre, rotation_by, symmetric_eigen,
};
use palpate_geometry::part::PartMoments;
use palpate_geometry::skin::PlacedPart;
use palpate_geometry::surface::Surface;

/// Fewest Gauss points a knot span of a surface with weights.
const RATIONAL_POINTS: usize = 24;
/// Least moment of inertia relative to the greatest; a thinner body counts as a sheet.
const THINNEST: f64 = 1e-9;

/// How the matter of a rigid body is spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mass {
    /// kg.
    pub mass_kg: f64,
    /// Centre of mass at rest, m; in the world.
    pub centre: Point3,
    /// Principal moments of inertia about the centre, kg·m².
    pub moments_kg_m2: [f64; 3],
    /// From the principal axes to the world, at rest.
    pub axes: Rotation,
    /// Of the control point farthest from the centre, m: no point of the surface is farther.
    pub reach_m: f64,
}

impl Mass {
    /// Of matter of one density (kg/m³) inside a closed surface whose normals point outwards; `None`
    /// if it encloses nothing, or a sheet as good as without thickness.
    pub fn inside(surface: &Surface, density_kg_m3: f64) -> Option<Self> {
        let points = surface.net().points();
        let middle = points.iter().map(|p| p.coords).sum::<Vector3>() / points.len().max(1) as f64;
        let mut volume = 0.0;
        let mut first = Vector3::zeros();
        let mut second = Matrix3::zeros();
        let outwards = if surface.flip_normal() { -1.0 } else { 1.0 };
        let rational = surface.weights().is_some();
        let (in_u, in_v) = (
            nodes(surface.knots_u(), rational),
            nodes(surface.knots_v(), rational),
        );
        for &(u, weight_u) in &in_u {
            for &(v, weight_v) in &in_v {
                let frame = surface.frame(u, v);
                let x = frame.point.coords - middle;
                let area = frame.du.cross(&frame.dv) * (outwards * weight_u * weight_v);
                volume += x.dot(&area) / 3.0;
                for i in 0..3 {
                    let squared = x[i] * x[i] * area[i];
                    first[i] += 0.5 * squared;
                    for j in 0..3 {
                        // Both orders of a mixed moment: their mean is as exact and symmetric.
                        let part = if i == j { 1.0 / 3.0 } else { 0.25 } * squared * x[j];
                        second[(i, j)] += part;
                        if i != j {
                            second[(j, i)] += part;
                        }
                    }
                }
            }
        }
        Self::of(density_kg_m3, (middle, volume, first, second), points)
    }

    /// Of matter of one density (kg/m³) inside a part; `None` if it has no inside.
    pub fn inside_part(
        placed: &PlacedPart,
        corners: &[Point3],
        density_kg_m3: f64,
    ) -> Option<Self> {
        let PartMoments {
            about,
            volume_m3,
            first,
            second,
        } = placed.part().moments()?;
        let turn = placed.pose().rotation.to_rotation_matrix().into_inner();
        let middle = (placed.pose() * about).coords;
        let moments = (
            middle,
            volume_m3,
            turn * first,
            turn * second * turn.transpose(),
        );
        Self::of(density_kg_m3, moments, corners)
    }

    /// From a point, and volume, first and second moments about it; the matter is within the box of the points.
    fn of(
        density_kg_m3: f64,
        (middle, volume, first, second): (Vector3, f64, Vector3, Matrix3),
        points: &[Point3],
    ) -> Option<Self> {
        let from_middle = first / volume;
        let about = second - from_middle * from_middle.transpose() * volume;
        let (spread, columns) = symmetric_eigen(about.as_slice(), 3);
        let total: f64 = spread.iter().sum();
        let moments = [0, 1, 2].map(|k| density_kg_m3 * (total - spread[k]));
        let mass_kg = density_kg_m3 * volume;
        let most = moments.iter().fold(0.0, |most: f64, m| most.max(*m));
        let solid = moments.iter().all(|&m| m > THINNEST * most);
        if !(mass_kg > 0.0 && mass_kg.is_finite() && most.is_finite() && solid) {
            return None;
        }
        let column = |k: usize| Vector3::new(columns[k], columns[3 + k], columns[6 + k]);
        let (a, b) = (column(0), column(1));
        // Right-handed, whatever signs the columns have.
        let axes = Matrix3::from_columns(&[a, b, a.cross(&b)]);
        let axes =
            Rotation::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(axes));
        let centre = Point3::from(middle + from_middle);
        let reach = points.iter().map(|p| (p - centre).norm_squared());
        Some(Self {
            mass_kg,
            centre,
            moments_kg_m2: moments,
            axes: Rotation::new_normalize(axes.into_inner()),
            reach_m: reach.fold(0.0, f64::max).sqrt(),
        })
    }

    /// Angular velocity (rad/s) with an angular momentum (kg·m²/s) about the centre, both in the
    /// world, when the principal axes are turned so.
    pub fn spin(&self, rotation: &Rotation, momentum: &Vector3) -> Vector3 {
        let own = rotation.inverse_transform_vector(momentum);
        let [a, b, c] = self.moments_kg_m2;
        rotation * Vector3::new(own.x / a, own.y / b, own.z / c)
    }

    /// The reverse: angular momentum with an angular velocity.
    pub fn momentum(&self, rotation: &Rotation, spin: &Vector3) -> Vector3 {
        let own = rotation.inverse_transform_vector(spin);
        let [a, b, c] = self.moments_kg_m2;
        rotation * Vector3::new(own.x * a, own.y * b, own.z * c)
    }

    /// How the principal axes are turned after `dt_s` seconds without a moment: the implicit midpoint
    /// rule on rotations, R' = exp(dt ω) R with I(R½) ω = L and R½ = exp(dt/2 ω) R (Simo and Wong 1991,
    /// "Unconditionally stable algorithms for rigid body dynamics that exactly preserve energy and
    /// momentum"). L in the world is kept as it is, and the energy drifts by what the iteration leaves
    /// over. A fast body takes several smaller steps.
    pub fn turned(&self, rotation: &Rotation, momentum: &Vector3, dt_s: f64) -> Rotation {
        if *momentum == Vector3::zeros() {
            return *rotation;
        }
        let angle = self.spin(rotation, momentum).norm() * dt_s;
        let pieces = (angle / MOST_TURN_RAD).ceil().clamp(1.0, MOST_PIECES);
        let step_s = dt_s / pieces;
        let mut rotation = *rotation;
        for _ in 0..pieces as u32 {
            let mut spin = self.spin(&rotation, momentum);
            for _ in 0..MIDPOINT_ROUNDS {
                let half = rotation_by(&(spin * (0.5 * step_s))) * rotation;
                spin = self.spin(&half, momentum);
            }
            let next = rotation_by(&(spin * step_s)) * rotation;
            rotation = Rotation::new_normalize(next.into_inner());
        }
        rotation
    }
}

/// Rounds of the implicit midpoint rule: each leaves at most a twentieth of what the one before left over.
const MIDPOINT_ROUNDS: usize = 12;
/// Most that one step turns a body, rad.
const MOST_TURN_RAD: f64 = 0.1;
/// Most steps of a tick.
const MOST_PIECES: f64 = 16.0;

/// Gauss points and weights over all spans of positive length.
fn nodes(knots: &KnotVector, rational: bool) -> Vec<(f64, f64)> {
    let exact = (5 * knots.degree()).div_ceil(2);
    let rule = gauss_legendre(if rational {
        exact.max(RATIONAL_POINTS)
    } else {
        exact
    });
    let t = knots.knots();
    let spans = knots.spans();
    spans
        .flat_map(|i| {
            let (middle, half) = (0.5 * (t[i] + t[i + 1]), 0.5 * (t[i + 1] - t[i]));
            let node = move |&(x, weight): &(f64, f64)| (middle + half * x, half * weight);
            rule.iter().map(node).collect::<Vec<_>>()
        })
        .collect()
}

#[cfg(test)]
mod tests;
