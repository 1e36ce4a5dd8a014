//! The flat face with which a tool touches.
//!
//! A flat punch of radius R goes into a half-space by F / (2 E* R), under a pressure that grows without bound
//! towards its rim. A net cannot show that rim: it goes in like a punch whose rim is farther out by [`WIDER`] of the radius
//! over which it spreads a force. A face of another outline with the area π R² goes in nearly as far: 1 % less if it is a
//! square (R. B. King, Int. J. Solids Structures 23 (1987) 1657).

use super::profile::across;
use palpate_geometry::contact::dispatch::Narrow;
use palpate_geometry::contact::{Edge, ToolShape};
use palpate_geometry::math::{Point3, Pose, Vector3};

/// Measured: slabs with spans of 5 and 7.5 mm under punches of 4 and 8 mm then have their force.
const WIDER: f64 = 0.66;
/// Cosines and sines of the directions in which the rim is looked for.
const DIRECTIONS: [(f64, f64); 16] = {
    // Of π / 8, π / 4 and 3 π / 8.
    const A: f64 = 0.923_879_532_511_286_7;
    const B: f64 = std::f64::consts::FRAC_1_SQRT_2;
    const C: f64 = 0.382_683_432_365_089_8;
    [
        (1.0, 0.0),
        (A, C),
        (B, B),
        (C, A),
        (0.0, 1.0),
        (-C, A),
        (-B, B),
        (-A, C),
        (-1.0, 0.0),
        (-A, -C),
        (-B, -B),
        (-C, -A),
        (0.0, -1.0),
        (C, -A),
        (B, -B),
        (A, -C),
    ]
};
/// An edge that rises faster over a face is not its rim.
const STEEPEST: f64 = 0.3;
/// Cosines between its normal and the body's, between which a face comes to lie on the body.
const LEANS: [f64; 2] = [0.85, 0.97];
/// The least cosine between a direction and the way across the rim there.
const LEAST_COS: f64 = 0.2;
/// Pieces of a curved edge.
const PIECES: usize = 64;

/// Where a tool touches.
pub(super) struct Place<'a> {
    pub point: &'a Point3,
    /// Normal of the body's surface.
    pub outward: &'a Vector3,
    /// The box around the body, m.
    pub bounds: &'a (Point3, Point3),
    /// Over which radius the body spreads a force, m.
    pub patch_m: f64,
}

/// A flat face of a tool over a place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Face {
    /// How much less a net goes in under it than a half-space, times 2 E*, 1/m.
    pub missing_1_m: f64,
    /// 1 where the face lies on the body, 0 where it leans on an edge or reaches beyond the body.
    pub share: f64,
    /// Out of the body.
    pub normal: Vector3,
}

/// The face that a place looks at; none of a tool without edges.
pub(super) fn of(
    shape: &ToolShape,
    narrow: &Narrow,
    pose: &Pose,
    place: &Place<'_>,
) -> Option<Face> {
    let edges = &shape.features()?.edges;
    let seen = narrow.facing(shape, pose, place.point, f64::INFINITY)?;
    let normal = seen.normal;
    let lies = (normal.dot(place.outward) - LEANS[0]) / (LEANS[1] - LEANS[0]);
    if edges.is_empty() || lies <= 0.0 {
        return None;
    }
    let (x, y) = across(&normal);
    let at = *place.point + normal * seen.gap_m;
    let frame = Frame {
        origin: pose.inverse_transform_point(&at),
        axes: [x, y, normal].map(|axis| pose.inverse_transform_vector(&axis)),
    };
    let wider_m = WIDER * place.patch_m;
    let (mut shares, mut squares, mut own, mut wide) = (0.0, 0.0, 0.0, 0.0);
    for (cos, sin) in DIRECTIONS {
        let rim = edges.iter().filter_map(|edge| frame.rim(edge, (cos, sin)));
        let Some(rim) = rim.min_by(|a, b| a.slope.total_cmp(&b.slope)) else {
            continue;
        };
        let room_m = room_m(place.bounds, place.point, &(x * cos + y * sin)) - rim.far_m;
        let flat = (1.0 - (rim.slope / STEEPEST).powi(2)).max(0.0);
        let share = flat * (room_m / (2.0 * place.patch_m)).clamp(0.0, 1.0);
        shares += share;
        squares += share * share;
        own += share * rim.far_m * rim.far_m;
        // Its area and length, and what J. Steiner says of its surroundings.
        let beside_m = 2.0 * rim.far_m / rim.cos.max(LEAST_COS) + wider_m;
        wide += share * (rim.far_m * rim.far_m + beside_m * wider_m);
    }
    if shares == 0.0 {
        return None;
    }
    let missing_1_m = (shares / own).sqrt() - (shares / wide).sqrt();
    let share = lies.min(1.0) * squares / DIRECTIONS.len() as f64;
    Some(Face {
        missing_1_m: share * missing_1_m,
        share,
        normal,
    })
}

/// A place on a face, in the tool's frame.
struct Frame {
    origin: Point3,
    axes: [Vector3; 3],
}

impl Frame {
    /// Along the face and over it, m.
    fn of(&self, p: &Point3) -> [f64; 3] {
        let way = p - self.origin;
        self.axes.map(|axis| axis.dot(&way))
    }

    /// What is seen of an edge in a direction.
    fn rim(&self, edge: &Edge, way: (f64, f64)) -> Option<Rim> {
        match edge {
            Edge::Segment { ends, .. } => crossed(ends.map(|end| self.of(&end)), way),
            &Edge::Circle { z, radius_m } => {
                let [x, y, _] = self.axes;
                let way = x * way.0 + y * way.1;
                let from = self.origin;
                let (a, b) = (way.xy().norm_squared(), way.xy().dot(&from.coords.xy()));
                let c = from.coords.xy().norm_squared() - radius_m * radius_m;
                let far_m = ((b * b - a * c).max(0.0).sqrt() - b) / a;
                (c < 0.0 && far_m.is_finite()).then(|| {
                    let at = from + way * far_m;
                    let cos = at.coords.xy().dot(&way.xy()) / radius_m;
                    let [x, y, up] = self.of(&Point3::new(at.x, at.y, z));
                    Rim::new(libm::hypot(x, y), up, cos)
                })
            }
            Edge::Curve(_) => {
                let at = |k: usize| self.of(&edge.at(k as f64 / PIECES as f64).0);
                let pieces = (0..PIECES).filter_map(|k| crossed([at(k), at(k + 1)], way));
                pieces.min_by(|a, b| a.slope.total_cmp(&b.slope))
            }
        }
    }
}

/// An edge in a direction along a face.
struct Rim {
    /// Distance, m.
    far_m: f64,
    /// How steeply it stands over the face.
    slope: f64,
    /// Cosine between the direction and the way across the edge.
    cos: f64,
}

impl Rim {
    fn new(far_m: f64, up_m: f64, cos: f64) -> Self {
        let slope = up_m.abs() / far_m;
        Self { far_m, slope, cos }
    }
}

/// Where a ray from the origin crosses a piece of an edge.
fn crossed([a, b]: [[f64; 3]; 2], way: (f64, f64)) -> Option<Rim> {
    let beside = |p: [f64; 3]| way.0 * p[1] - way.1 * p[0];
    let (from, to) = (beside(a), beside(b));
    if (from < 0.0) == (to < 0.0) {
        return None;
    }
    let t = from / (from - to);
    let along = [0, 1, 2].map(|k| b[k] - a[k]);
    let [x, y, up] = [0, 1, 2].map(|k| a[k] + t * along[k]);
    let far_m = x * way.0 + y * way.1;
    let cos = (to - from).abs() / libm::hypot(along[0], along[1]);
    (far_m > 0.0).then(|| Rim::new(far_m, up, cos))
}

/// How far a box reaches from a place in a direction, m.
fn room_m((low, high): &(Point3, Point3), from: &Point3, way: &Vector3) -> f64 {
    let along = |k: usize| {
        let end = if way[k] > 0.0 { high[k] } else { low[k] };
        if way[k] == 0.0 {
            f64::INFINITY
        } else {
            (end - from[k]) / way[k]
        }
    };
    along(0).min(along(1)).min(along(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::contact::implicit::ImplicitShape;
    use std::f64::consts::{PI, TAU};

    /// Area, m², and length, m, of what is seen of edges from a place in the frame of a tool.
    fn measured(edges: &[Edge], origin: [f64; 3]) -> (f64, f64) {
        let frame = Frame {
            origin: origin.into(),
            axes: [Vector3::x(), Vector3::y(), Vector3::z()],
        };
        let many = 4_000;
        let (mut area_m2, mut length_m) = (0.0, 0.0);
        for k in 0..many {
            let angle = TAU * (f64::from(k) + 0.5) / f64::from(many);
            let way = (libm::cos(angle), libm::sin(angle));
            let rims = edges.iter().filter_map(|edge| frame.rim(edge, way));
            let rim = rims.min_by(|a, b| a.slope.total_cmp(&b.slope)).unwrap();
            assert!(rim.slope < 1e-12, "{}", rim.slope);
            area_m2 += PI * rim.far_m * rim.far_m / f64::from(many);
            length_m += TAU * rim.far_m / rim.cos / f64::from(many);
        }
        (area_m2, length_m)
    }

    fn near(found: f64, expected: f64) {
        assert!(
            (found / expected - 1.0).abs() < 1e-3,
            "{found}, not {expected}"
        );
    }

    #[test]
    fn rims_of_faces_have_their_area_and_length_from_any_place() {
        let block = ImplicitShape::Box {
            half_extents_m: [3e-3, 5e-3, 1e-3],
        };
        let edges = block.features().edges;
        for place in [[0.0, 0.0, -1e-3], [2e-3, -3e-3, -1e-3], [1e-3, 1e-3, 1e-3]] {
            let (area_m2, length_m) = measured(&edges, place);
            near(area_m2, 60e-6);
            near(length_m, 32e-3);
        }
        let rod = ImplicitShape::Cylinder {
            radius_m: 4e-3,
            half_length_m: Some(0.02),
        };
        let edges = rod.features().edges;
        for place in [[0.0, 0.0, 0.02], [2e-3, -1e-3, 0.02], [-1e-3, 3e-3, -0.02]] {
            let (area_m2, length_m) = measured(&edges, place);
            near(area_m2, PI * 16e-6);
            near(length_m, TAU * 4e-3);
        }
    }

    #[test]
    fn directions_go_round() {
        for (k, (cos, sin)) in DIRECTIONS.into_iter().enumerate() {
            let angle = TAU * k as f64 / DIRECTIONS.len() as f64;
            let off = libm::hypot(cos - libm::cos(angle), sin - libm::sin(angle));
            assert!(off < 1e-15, "{k}: {off}");
        }
    }

    #[test]
    fn a_box_reaches_as_far_as_its_nearest_side() {
        let bounds = (Point3::new(-1.0, -2.0, -3.0), Point3::new(4.0, 5.0, 6.0));
        let room = |way: [f64; 3]| room_m(&bounds, &Point3::origin(), &way.into());
        assert_eq!(room([1.0, 0.0, 0.0]), 4.0);
        assert_eq!(room([-1.0, 0.0, 0.0]), 1.0);
        assert_eq!(room([0.0, -0.6, 0.8]), 2.0 / 0.6);
    }
}
