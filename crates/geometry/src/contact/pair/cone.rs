//! Cones that hold the normals of a part of a surface.

use crate::basis::MAX_DEGREE;
use crate::math::Vector3;

/// Angle to which the normal of a plane is known, rad.
const FLAT: f64 = 1e-9;
/// Points this near to a plane, relative to how far they are from each other, lie in it.
const IN_PLANE: f64 = 1e-12;

/// Most differences of points along one direction.
const MOST: usize = (MAX_DEGREE + 1) * MAX_DEGREE;

/// All directions within an angle of an axis.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact) struct Cone {
    pub axis: Vector3,
    /// Cosine of the half angle; −1: every direction.
    pub cos: f64,
    pub sin: f64,
}

impl Cone {
    pub const ANY: Self = Self {
        axis: Vector3::new(0.0, 0.0, 1.0),
        cos: -1.0,
        sin: 0.0,
    };

    /// Normals of a Bézier part from its points, `(p + 1) × (q + 1)`, u-major; `flip` for those
    /// along −S_u × S_v.
    ///
    /// S_u is a positive combination of differences along u, S_v of those along v, and the normals
    /// of two cones' products fill the cone below (Sederberg & Meyers, *Loop detection in surface
    /// patch intersections*, 1988). Points of rational parts are projected; there, the cone is
    /// widened by a third, which is generous where weights differ by less than 2.
    pub fn of_normals(points: &[[f64; 3]], p: usize, q: usize, flip: bool, rational: bool) -> Self {
        if let Some(axis) = plane(points, p, q) {
            return Self {
                axis: if flip { -axis } else { axis },
                cos: 1.0,
                sin: FLAT,
            };
        }
        let width = q + 1;
        let (at_u, at_v) = (|k, l| &points[k * width + l], |l, k| &points[k * width + l]);
        let (along_u, along_v) = match p <= 3 && q <= 3 {
            true => (tangents::<12>(at_u, p, q), tangents::<12>(at_v, q, p)),
            false => (tangents::<MOST>(at_u, p, q), tangents::<MOST>(at_v, q, p)),
        };
        let (Some((a, cos_a)), Some((b, cos_b))) = (along_u, along_v) else {
            return Self::ANY;
        };
        let across = a.cross(&b);
        let sin_ab = across.norm();
        let (sin2_a, sin2_b) = (1.0 - cos_a * cos_a, 1.0 - cos_b * cos_b);
        let product = (sin2_a * sin2_b).max(0.0).sqrt();
        let sin2 = (sin2_a + 2.0 * product * a.dot(&b).abs() + sin2_b) / (sin_ab * sin_ab);
        let sin = sin2.max(0.0).sqrt() * if rational { 4.0 / 3.0 } else { 1.0 } + 1e-12;
        // False for NaN as well.
        if !(sin < 1.0 && sin_ab > 1e-9) {
            return Self::ANY;
        }
        let axis = across * (if flip { -1.0 } else { 1.0 } / sin_ab);
        Self {
            axis,
            cos: (1.0 - sin * sin).sqrt(),
            sin,
        }
    }

    /// All directions are one, but for rounding.
    pub fn is_flat(&self) -> bool {
        self.cos > 0.0 && self.sin <= FLAT
    }

    /// Some direction of this cone may be the opposite of one of the other.
    pub fn may_face(&self, other: &Self) -> bool {
        let cos = self.cos * other.cos - self.sin * other.sin;
        if self.cos < 0.0 || other.cos < 0.0 || self.sin * other.cos + self.cos * other.sin < 0.0 {
            return true;
        }
        -self.axis.dot(&other.axis) >= cos - 1e-12
    }

    /// Some vector no farther than `away` from this one may lie along a direction of the cone, forth or back.
    pub fn may_hold(&self, way: &Vector3, away: f64) -> bool {
        let length = way.norm();
        if self.cos < 0.0 || length <= away {
            return true;
        }
        let sin = away / length;
        let cos = self.cos * (1.0 - sin * sin).sqrt() - self.sin * sin;
        way.dot(&self.axis).abs() >= (cos - 1e-12) * length
    }
}

/// Normal of the plane in which all points lie.
fn plane(points: &[[f64; 3]], p: usize, q: usize) -> Option<Vector3> {
    let width = q + 1;
    let first = Vector3::from(points[0]);
    let [far, u, v] = [p * width + q, p * width, q].map(|k| Vector3::from(points[k]));
    let (along, across) = (far - first, v - u);
    let size = along.norm().max(across.norm());
    let normal = along.cross(&across).try_normalize(1e-3 * size * size)?;
    let near = IN_PLANE * size + 4.0 * f64::EPSILON * first.amax();
    let mut points = points.iter();
    let flat = points.all(|x| (Vector3::from(*x) - first).dot(&normal).abs() <= near);
    flat.then_some(normal)
}

/// Mean direction of the differences along the first index, and the cosine of the widest angle to
/// it.
fn tangents<'a, const ROOM: usize>(
    at: impl Fn(usize, usize) -> &'a [f64; 3],
    p: usize,
    q: usize,
) -> Option<(Vector3, f64)> {
    let mut units = [Vector3::zeros(); ROOM];
    let (mut count, mut sum) = (0, Vector3::zeros());
    for k in 0..p {
        for l in 0..=q {
            let (x, y) = (at(k, l), at(k + 1, l));
            let d = Vector3::new(y[0] - x[0], y[1] - x[1], y[2] - x[2]);
            let square = d.norm_squared();
            // At a pole the tangents around it vanish; those beside it bound what is left.
            if square > 1e-30 * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) && square > 0.0 {
                let unit = d * (1.0 / square.sqrt());
                units[count] = unit;
                count += 1;
                sum += unit;
            }
        }
    }
    let axis = sum.try_normalize(1e-3)?;
    let least = units[..count]
        .iter()
        .fold(1.0_f64, |m, x| m.min(x.dot(&axis)));
    (least > 0.0).then_some((axis, least))
}
