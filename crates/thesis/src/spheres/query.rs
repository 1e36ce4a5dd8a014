//! The method as pairs of a scene are made with it.

use super::{Counters, Solid, Spheres, SpheresPair};
use palpate_geometry::contact::dispatch::{BodyShape, Party};
use palpate_geometry::contact::implicit::ImplicitTool;
use palpate_geometry::contact::mesh::MeshTool;
use palpate_geometry::contact::{ContactQuery, ContactSet, OtherMethod, Reach, ToolShape};
use palpate_geometry::math::{Point3, Pose, Vector3};
use palpate_geometry::surface::Surface;
use std::any::Any;

/// `method = "spheres"`.
pub static SPHERES: OtherMethod = OtherMethod {
    name: "spheres",
    refuses,
    make,
    query_us,
};

/// What the last query did, if it was one of this method.
pub fn counters_of(query: &dyn ContactQuery) -> Option<&Counters> {
    let query: &dyn Any = query;
    Some(match query.downcast_ref()? {
        Query::One(spheres) => spheres.counters(),
        Query::Two(two) => two.pair.counters(),
    })
}

fn refuses(body: BodyShape<'_>, party: Party<'_>) -> Option<&'static str> {
    let is_part = |body: &BodyShape<'_>| body.skin.part().is_some();
    let joined = |surface: &Surface| surface.joints().is_some();
    if matches!(party, Party::Itself) {
        Some("its points cannot tell a fold from a wall")
    } else if is_part(&body) || matches!(&party, Party::Body(other) if is_part(other)) {
        Some("a part has no rows of points")
    } else if body.skin.surface().is_some_and(joined) || party.surface().is_some_and(joined) {
        Some("the surface is in joined pieces")
    } else {
        None
    }
}

fn make(body: &Surface, party: Party<'_>, rows: [usize; 2]) -> Box<dyn ContactQuery> {
    Box::new(match party.surface() {
        Some(other) => Query::Two(Box::new(TwoSpheres::new(body, other, rows))),
        None => Query::One(Box::new(Spheres::new(body, rows))),
    })
}

fn query_us([u, v]: [usize; 2], two_surfaces: bool) -> f64 {
    (u * v) as f64 * if two_surfaces { 0.15 } else { 0.015 }
}

/// What finds the contacts of a pair.
#[derive(Debug)]
enum Query {
    /// A tool without a surface, on points of the body's.
    One(Box<Spheres>),
    /// On points of both.
    Two(Box<TwoSpheres>),
}

impl ContactQuery for Query {
    fn contacts(
        &mut self,
        body: &Surface,
        shape: &ToolShape,
        pose: &Pose,
        reach: &Reach,
        set: &mut ContactSet,
    ) {
        let place = Point3::from(pose.translation.vector);
        match (self, shape) {
            (Self::One(spheres), shape) => {
                spheres.load(body);
                match shape {
                    ToolShape::Plane { normal } => {
                        spheres.plane(&place, &(pose.rotation * normal), reach, set);
                    }
                    ToolShape::Implicit { tool, .. } => {
                        spheres.solid(&Placed::new(&**tool, shape, pose), reach, set);
                    }
                    ToolShape::Mesh(tool) => {
                        spheres.solid(&Placed::new(&**tool, shape, pose), reach, set);
                    }
                    _ => {
                        let radius_m = shape.ball_radius_m().unwrap_or(0.0);
                        spheres.ball(&place, radius_m, reach, set);
                    }
                }
            }
            (Self::Two(two), ToolShape::Surface(tool)) => {
                two.body.load(body);
                two.other.load_at(tool.surface(), pose);
                two.find(reach, set);
            }
            (Self::Two(_), _) => debug_assert!(false, "this pair was made for a surface"),
        }
    }

    fn body_contacts(
        &mut self,
        body: &Surface,
        other: &Surface,
        reach: &Reach,
        set: &mut ContactSet,
    ) {
        let Self::Two(two) = self else {
            debug_assert!(false, "this pair was not made for two bodies");
            return;
        };
        two.body.load(body);
        two.other.load(other);
        two.find(reach, set);
    }
}

/// Points of two surfaces.
#[derive(Debug)]
struct TwoSpheres {
    body: Spheres,
    other: Spheres,
    pair: SpheresPair,
}

impl TwoSpheres {
    fn new(body: &Surface, other: &Surface, rows: [usize; 2]) -> Self {
        let (body, other) = (Spheres::new(body, rows), Spheres::new(other, rows));
        let pair = SpheresPair::new(&body, &other);
        Self { body, other, pair }
    }

    fn find(&mut self, reach: &Reach, set: &mut ContactSet) {
        self.pair.find(&mut self.body, &mut self.other, reach, set);
    }
}

/// A solid tool at a pose, as the `spheres` method sees it.
struct Placed<'a, T> {
    tool: &'a T,
    pose: &'a Pose,
    bounds: Option<(Point3, Point3)>,
}

impl<'a, T> Placed<'a, T> {
    fn new(tool: &'a T, shape: &ToolShape, pose: &'a Pose) -> Self {
        let bounds = shape.bounds(pose);
        Self { tool, pose, bounds }
    }

    fn may_meet(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        self.bounds.is_none_or(|(from, to)| {
            (0..3).all(|c| low[c] <= to[c] + margin_m && high[c] >= from[c] - margin_m)
        })
    }
}

// The normals of tools point towards their matter, those of solids out of it.
impl Solid for Placed<'_, ImplicitTool> {
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3) {
        let seen = self.tool.signed_gap(self.pose, point);
        let (gap_m, inwards) = seen.unwrap_or((f64::INFINITY, Vector3::z()));
        (gap_m, -inwards)
    }

    fn may_meet_box(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        self.may_meet(low, high, margin_m)
    }
}

impl Solid for Placed<'_, MeshTool> {
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3) {
        let (gap_m, inwards) = self.tool.signed_gap(self.pose, point);
        (gap_m, -inwards)
    }

    fn bounded_gap(&self, point: &Point3) -> Option<f64> {
        Some(self.tool.signed_gap(self.pose, point).0)
    }

    fn may_meet_box(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        self.may_meet(low, high, margin_m)
    }
}
