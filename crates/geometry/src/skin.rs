//! What contact touches: a B-spline surface, or a part where it stands. Places of both are two numbers (u, v).

use crate::math::{Matrix3, Point3, Pose, Rotation, Vector3};
use crate::part::{Part, PartFoot, PartSolver};
use crate::surface::{ClosestPoint, ClosestSolver, Surface, WarmFoot};
use std::sync::Arc;

/// The outside of a body.
#[derive(Clone, Debug)]
pub enum Skin {
    /// One B-spline surface, in the world.
    Surface(Surface),
    /// What a CAD system wrote.
    Part(PlacedPart),
}

/// A body as contact queries take it.
#[derive(Debug)]
pub struct SkinSide<'a> {
    /// As it stands.
    pub skin: &'a Skin,
    /// Its solver.
    pub solver: &'a mut SkinSolver,
}

/// A part where it stands.
#[derive(Clone, Debug)]
pub struct PlacedPart {
    part: Arc<Part>,
    pose: Pose,
    /// Corners of the box around it, in the world, m.
    corners: [Point3; 8],
}

impl PlacedPart {
    /// A part at a pose.
    pub fn new(part: Arc<Part>, pose: Pose) -> Self {
        let corners = corners(&part, &pose);
        Self {
            part,
            pose,
            corners,
        }
    }

    /// In its own frame, to be kept.
    pub fn shared(&self) -> Arc<Part> {
        self.part.clone()
    }

    /// In its own frame.
    pub fn part(&self) -> &Part {
        &self.part
    }

    /// Of its frame in the world.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// The middle of the box around it, in the world, m.
    pub fn middle(&self) -> Point3 {
        nalgebra::center(&self.corners[0], &self.corners[7])
    }

    /// Puts it elsewhere.
    pub fn place(&mut self, pose: Pose) {
        self.pose = pose;
        self.corners = corners(&self.part, &pose);
    }
}

/// The motion that took the corners of a part's box from one place to another; `None` where they are no such corners.
pub fn motion_of_corners(from: &[Point3], to: &[Point3]) -> Option<Pose> {
    let frame = |corners: &[Point3]| {
        let [o, x, y, _, z, ..] = *corners else {
            return None;
        };
        let mut edges = [x - o, y - o, z - o];
        // The shortest edge of a flat part has no length: its direction comes from the other two.
        let shortest = edges.map(|edge| edge.norm()).iter().enumerate().fold(
            (0, f64::INFINITY),
            |least, (k, &length)| {
                if length < least.1 { (k, length) } else { least }
            },
        );
        let k = shortest.0;
        edges[k] = edges[(k + 1) % 3].cross(&edges[(k + 2) % 3]);
        let axes = Matrix3::from_columns(&edges.map(|edge| edge.normalize()));
        let axes_turn = nalgebra::Rotation3::from_matrix_unchecked(axes);
        let turn = Rotation::from_rotation_matrix(&axes_turn);
        axes.iter()
            .all(|x| x.is_finite())
            .then(|| Pose::from_parts(o.coords.into(), turn))
    };
    Some(frame(to)? * frame(from)?.inverse())
}

fn corners(part: &Part, pose: &Pose) -> [Point3; 8] {
    let (low, high) = part.bounds();
    std::array::from_fn(|k| {
        let end = |axis: usize| {
            if k >> axis & 1 == 0 {
                low[axis]
            } else {
                high[axis]
            }
        };
        pose * Point3::new(end(0), end(1), end(2))
    })
}

impl Skin {
    /// The surface, if it is one.
    pub fn surface(&self) -> Option<&Surface> {
        match self {
            Self::Surface(surface) => Some(surface),
            Self::Part(_) => None,
        }
    }

    /// The surface, if it is one; mutable.
    pub fn surface_mut(&mut self) -> Option<&mut Surface> {
        match self {
            Self::Surface(surface) => Some(surface),
            Self::Part(_) => None,
        }
    }

    /// The part, if it is one.
    pub fn part(&self) -> Option<&PlacedPart> {
        match self {
            Self::Part(part) => Some(part),
            Self::Surface(_) => None,
        }
    }

    /// Points in whose box it lies, m: the control points of a surface, eight corners around a part.
    pub fn points(&self) -> &[Point3] {
        match self {
            Self::Surface(surface) => surface.net().points(),
            Self::Part(placed) => &placed.corners,
        }
    }

    /// The point at a place, m.
    pub fn point(&self, u: f64, v: f64) -> Point3 {
        match self {
            Self::Surface(surface) => surface.point(u, v),
            Self::Part(placed) => placed.pose * placed.part.point([u, v]),
        }
    }

    /// Unit normal at a place, outwards.
    pub fn normal(&self, u: f64, v: f64) -> Vector3 {
        match self {
            Self::Surface(surface) => surface.normal(u, v),
            Self::Part(placed) => placed.pose.rotation * placed.part.normal([u, v]),
        }
    }

    /// Diagonal of the box around its points, m.
    pub fn size_m(&self) -> f64 {
        match self {
            Self::Surface(surface) => surface.size(),
            Self::Part(placed) => placed.part.size_m(),
        }
    }

    /// It has an inside.
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Surface(surface) => surface.topology().is_closed(),
            Self::Part(placed) => placed.part.is_closed(),
        }
    }

    /// A point of it lies where it ends: on the rim of a sheet.
    pub fn ends_at(&self, foot: &ClosestPoint, close_m: f64) -> bool {
        match self {
            Self::Surface(surface) => surface.ends_at(foot, close_m),
            Self::Part(placed) => {
                let point = placed.pose.inverse_transform_point(&foot.point);
                placed.part.ends_at(&point, close_m)
            }
        }
    }
}

impl From<Surface> for Skin {
    fn from(surface: Surface) -> Self {
        Self::Surface(surface)
    }
}

/// Closest-point queries on one skin. Scratch: its answers depend on the arguments only.
#[derive(Clone, Debug)]
pub enum SkinSolver {
    /// On a surface.
    Surface(Box<ClosestSolver>),
    /// On a part.
    Part(Box<PartSolver>),
}

impl SkinSolver {
    /// Scratch for a skin.
    pub fn new(skin: &Skin) -> Self {
        match skin {
            Skin::Surface(surface) => Self::Surface(Box::new(ClosestSolver::new(surface))),
            Skin::Part(placed) => Self::Part(Box::new(PartSolver::new(&placed.part))),
        }
    }

    /// The solver of a surface.
    pub fn surface_mut(&mut self) -> Option<&mut ClosestSolver> {
        match self {
            Self::Surface(solver) => Some(solver),
            Self::Part(_) => None,
        }
    }

    /// The solver of a surface.
    pub fn surface(&self) -> Option<&ClosestSolver> {
        match self {
            Self::Surface(solver) => Some(solver),
            Self::Part(_) => None,
        }
    }

    /// The net of the surface moved.
    pub fn net_changed(&mut self) {
        if let Self::Surface(solver) = self {
            solver.net_changed();
        }
    }

    /// Pieces of the surface that searches gave up so far.
    pub fn pieces_given_up(&self) -> u64 {
        match self {
            Self::Surface(solver) => solver.pieces_given_up(),
            Self::Part(solver) => solver.given_up(),
        }
    }

    /// The closest point, proved. As for [`ClosestSolver::closest`], a query that is not finite has a meaningless answer.
    pub fn closest(&mut self, skin: &Skin, query: &Point3) -> ClosestPoint {
        match (self, skin) {
            (Self::Surface(solver), Skin::Surface(surface)) => solver.closest(surface, query),
            (Self::Part(solver), Skin::Part(placed)) => {
                let q = placed.pose.inverse_transform_point(query);
                in_world(placed, query, solver.closest(&placed.part, &q))
            }
            _ => made_for_another(query),
        }
    }

    /// [`SkinSolver::closest`], from the last foot where that is proved to be enough. Movements of the query and of the
    /// skin since the last call, m.
    pub fn closest_warm_moved(
        &mut self,
        skin: &Skin,
        query: &Point3,
        query_moved_m: f64,
        skin_moved_m: f64,
        warm: &mut WarmFoot,
    ) -> ClosestPoint {
        match (self, skin) {
            (Self::Surface(solver), Skin::Surface(surface)) => {
                solver.closest_warm_moved(surface, query, query_moved_m, skin_moved_m, warm)
            }
            (Self::Part(solver), Skin::Part(placed)) => {
                let q = placed.pose.inverse_transform_point(query);
                let moved_m = query_moved_m + skin_moved_m;
                let foot = solver.closest_warm_moved(&placed.part, &q, moved_m, warm);
                in_world(placed, query, foot)
            }
            _ => made_for_another(query),
        }
    }

    /// The local minimum of the distance that descent from a place leads to; `None` where it does not arrive.
    pub fn local(&self, skin: &Skin, query: &Point3, u: f64, v: f64) -> Option<ClosestPoint> {
        match (self, skin) {
            (Self::Surface(solver), Skin::Surface(surface)) => solver.local(surface, query, u, v),
            (Self::Part(solver), Skin::Part(placed)) => {
                let q = placed.pose.inverse_transform_point(query);
                let foot = solver.local(&placed.part, &q, [u, v])?;
                Some(in_world(placed, query, Some(foot)))
            }
            _ => None,
        }
    }
}

/// A foot as surfaces have it. The sign of a sheet's distance is that of the side the query is on.
fn in_world(placed: &PlacedPart, query: &Point3, foot: Option<PartFoot>) -> ClosestPoint {
    let Some(foot) = foot else {
        return made_for_another(query);
    };
    let (point, normal) = (placed.pose * foot.point, placed.pose.rotation * foot.normal);
    let along = normal.dot(&(query - point));
    ClosestPoint {
        u: foot.place[0],
        v: foot.place[1],
        point,
        normal,
        distance: foot.distance,
        signed_distance: (foot.signed_distance).unwrap_or(foot.distance.copysign(along)),
    }
}

/// What a query that has no answer gets.
fn made_for_another(query: &Point3) -> ClosestPoint {
    debug_assert!(
        !query.iter().all(|x| x.is_finite()),
        "a solver of another skin"
    );
    ClosestPoint {
        u: 0.0,
        v: 0.0,
        point: *query,
        normal: Vector3::z(),
        distance: f64::NAN,
        signed_distance: f64::NAN,
    }
}
