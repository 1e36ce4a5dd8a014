//! Joints: where patches meet, and how well.
//!
//! Front and back joints of each tube, its outline on the tube below (or the passage through a level), and the arch of
//! each fork. At 201 points of a joint the surface is seen from both sides: the gap is the distance of the two points,
//! the angle that of the two normals, `atan2(|n₁ × n₂|, n₁ · n₂)`, and regular is a joint where S_u and S_v are not
//! parallel: `|S_u × S_v| / (|S_u| |S_v|)` stays above 0.

use super::patches::{Patch, PatchTable};
use palpate_geometry::basis::Side;
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::{Frame, Surface};
use serde::Serialize;

/// Points of a joint.
const POINTS: usize = 201;

/// Points by which an edge finds the one that it lies on.
const PROBES: usize = 9;

/// What meets at a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JointKind {
    /// Start and end of a leaf's loop.
    Front,
    /// Its two arcs.
    Back,
    /// The stroke of the inverted T: two branches of a fork.
    Arch,
    /// A tube and the one it stands on.
    Outline,
}

/// One joint, measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Joint {
    /// What meets.
    pub kind: JointKind,
    /// Tubes on both sides.
    pub nodes: [String; 2],
    /// Part of the first side.
    pub part: usize,
    /// Leaves by which the sides are drawn.
    pub leaves: [usize; 2],
    /// Greatest distance of the two sides, m.
    pub gap_m: f64,
    /// Greatest angle between their normals, degrees; 180 where a side has none.
    pub angle_deg: f64,
    /// Least sine of the angle between S_u and S_v on either side.
    pub min_sine: f64,
}

/// A border of a patch, walked from s = 0 to 1.
#[derive(Clone, Copy, Debug)]
struct JointEdge {
    u: [f64; 2],
    v: [f64; 2],
    sides: [Side; 2],
}

impl JointEdge {
    /// The border at one end of u.
    fn across(patch: &Patch, end: usize) -> Self {
        Self {
            u: [patch.u[end]; 2],
            v: patch.v,
            sides: [[Side::Right, Side::Left][end], Side::Right],
        }
    }

    /// The border at one end of v.
    fn along(patch: &Patch, end: usize) -> Self {
        Self {
            u: patch.u,
            v: [patch.v[end]; 2],
            sides: [Side::Right, [Side::Right, Side::Left][end]],
        }
    }

    fn reversed(self) -> Self {
        Self {
            u: [self.u[1], self.u[0]],
            v: [self.v[1], self.v[0]],
            ..self
        }
    }

    fn frame(&self, surface: &Surface, s: f64) -> Frame {
        // Exact at both ends, and there seen from inside.
        let at = |[a, b]: [f64; 2]| if s == 1.0 { b } else { a + (b - a) * s };
        let side = |[a, b]: [f64; 2], side: Side| match at([a, b]) {
            _ if a == b => side,
            x if x == a.max(b) => Side::Left,
            _ => Side::Right,
        };
        surface.frame_from(
            at(self.u),
            at(self.v),
            side(self.u, self.sides[0]),
            side(self.v, self.sides[1]),
        )
    }

    /// Greatest distance of two edges at a few points, m.
    fn distance(&self, other: &Self, surface: &Surface) -> f64 {
        let probe =
            |edge: &Self, k: usize| edge.frame(surface, k as f64 / (PROBES - 1) as f64).point;
        (0..PROBES)
            .map(|k| (probe(self, k) - probe(other, k)).norm())
            .fold(0.0, f64::max)
    }
}

/// All joints of the distinct patches, measured; the table is the surface's own.
pub fn joints(surface: &Surface, table: &PatchTable) -> Vec<Joint> {
    let mut joints = Vec::new();
    let normals_of = |sides: [JointEdge; 2]| Meeting::of(surface, sides);
    for patch in table.distinct().filter(|patch| patch.arc == 1) {
        let other = table.patch(patch.part, patch.leaf, 2);
        for (kind, sides) in [
            (
                JointKind::Front,
                [JointEdge::across(patch, 0), JointEdge::across(other, 1)],
            ),
            (
                JointKind::Back,
                [JointEdge::across(patch, 1), JointEdge::across(other, 0)],
            ),
        ] {
            joints.push(normals_of(sides).named(kind, patch, other));
        }
    }
    for patch in table
        .distinct()
        .filter(|patch| patch.part + 1 < table.parts)
    {
        let edge = JointEdge::along(patch, 1);
        let below = table.patch(patch.part + 1, patch.leaf, patch.arc);
        let beside = table
            .distinct()
            .filter(|other| other.part == patch.part && other.arc != patch.arc);
        let found = beside
            .map(|other| {
                (
                    JointKind::Arch,
                    other,
                    JointEdge::along(other, 1).reversed(),
                )
            })
            .chain([(JointKind::Outline, below, JointEdge::along(below, 0))])
            .map(|candidate| (edge.distance(&candidate.2, surface), candidate))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        // An arch is found from both its sides.
        if let Some((_, (kind, other, sides))) = found
            && (kind == JointKind::Outline || patch.leaf < other.leaf)
        {
            joints.push(normals_of([edge, sides]).named(kind, patch, other));
        }
    }
    joints
}

struct Meeting {
    gap_m: f64,
    angle_deg: f64,
    min_sine: f64,
}

impl Meeting {
    fn of(surface: &Surface, sides: [JointEdge; 2]) -> Self {
        let mut worst = Self {
            gap_m: 0.0,
            angle_deg: 0.0,
            min_sine: 1.0,
        };
        for k in 0..POINTS {
            let s = k as f64 / (POINTS - 1) as f64;
            let [a, b] = sides.map(|edge| edge.frame(surface, s));
            worst.gap_m = worst.gap_m.max((a.point - b.point).norm());
            worst.angle_deg = worst.angle_deg.max(angle_deg(&normal(&a), &normal(&b)));
            worst.min_sine = worst.min_sine.min(sine(&a)).min(sine(&b));
        }
        worst
    }

    fn named(self, kind: JointKind, a: &Patch, b: &Patch) -> Joint {
        Joint {
            kind,
            nodes: [a.node.clone(), b.node.clone()],
            part: a.part,
            leaves: [a.leaf, b.leaf],
            gap_m: self.gap_m,
            angle_deg: self.angle_deg,
            min_sine: self.min_sine,
        }
    }
}

fn normal(frame: &Frame) -> Vector3 {
    let (du, dv) = (frame.du.try_normalize(0.0), frame.dv.try_normalize(0.0));
    du.zip(dv)
        .map_or_else(Vector3::zeros, |(du, dv)| du.cross(&dv))
}

fn sine(frame: &Frame) -> f64 {
    normal(frame).norm()
}

fn angle_deg(a: &Vector3, b: &Vector3) -> f64 {
    if a.norm_squared() == 0.0 || b.norm_squared() == 0.0 {
        return 180.0;
    }
    libm::atan2(a.cross(b).norm(), a.dot(b)).to_degrees()
}
