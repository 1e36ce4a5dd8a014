//! How good a branching surface is: joints, the welded mesh, and how often its area is drawn.

use super::crossing::crossing_pairs;
use super::joints::{Joint, joints};
use super::patches::{Patch, PatchTable};
use super::rules::{Broken, broken};
use super::weld::{Welded, welded};
use palpate_geometry::basis::BasisWindow;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::gauss_legendre;
use palpate_geometry::surface::Surface;
use serde::Serialize;

/// Greatest gap of a generated net, of its size.
pub const GOAL_GAP: f64 = 1e-12;
/// Greatest angle of a generated net, degrees.
pub const GOAL_ANGLE_DEG: f64 = 1e-6;
/// Greatest angle of an edited net, degrees.
pub const GOAL_EDITED_ANGLE_DEG: f64 = 0.1;

/// Joints whose S_u and S_v enclose less than this sine are singular.
const REGULAR_SINE: f64 = 1e-3;

/// Cells to a span of the welded mesh.
const CELLS: usize = 4;

/// Crossing pairs are counted up to here.
const MOST_CROSSINGS: usize = 1000;

/// What was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measures {
    /// Diagonal of the net's box, m.
    pub size_m: f64,
    /// Greatest gap of a joint, m.
    pub gap_m: f64,
    /// Greatest angle between normals at a joint, degrees.
    pub angle_deg: f64,
    /// Least |S_u × S_v| / (|S_u| |S_v|) at a joint.
    pub min_sine: f64,
    /// Rules that the net breaks; those say why a joint is not smooth.
    pub rules: Vec<Broken>,
    /// Every joint.
    pub joints: Vec<Joint>,
    /// Leaves of the net.
    pub leaves: usize,
    /// Euler number of the welded mesh of the distinct patches.
    pub euler: i64,
    /// What it should be: 2 − (leaves + 1).
    pub euler_wanted: i64,
    /// Its open ends.
    pub loops: usize,
    /// Edges with more than two triangles.
    pub non_manifold: usize,
    /// Edges whose triangles turn against each other.
    pub inconsistent: usize,
    /// Edges whose triangles face away from each other.
    pub folded: usize,
    /// Pairs of triangles that cross; 1000 stands for more.
    pub crossings: usize,
    /// Triangles of the welded mesh.
    pub triangles: usize,
    /// Area of all patches by that of the distinct ones.
    pub coverage: f64,
    /// Area of the distinct patches, m².
    pub area_m2: f64,
    /// Greatest distance of a copy's control points from the original's, m.
    pub copy_deviation_m: f64,
}

impl Measures {
    /// Measures a surface by its own table, and gives the mesh that was made for it.
    pub fn of(surface: &Surface, table: &PatchTable) -> (Self, Welded) {
        let joints = joints(surface, table);
        let worst = |f: fn(&Joint) -> f64| joints.iter().map(f).fold(0.0, f64::max);
        let welded = welded(surface, table, CELLS);
        let areas: Vec<f64> = table
            .patches
            .iter()
            .map(|patch| area(surface, patch))
            .collect();
        let distinct: f64 = table
            .patches
            .iter()
            .zip(&areas)
            .filter(|(patch, _)| patch.duplicate_of.is_none())
            .map(|(_, area)| area)
            .sum();
        let measures = Self {
            size_m: surface.size(),
            gap_m: worst(|joint| joint.gap_m),
            angle_deg: worst(|joint| joint.angle_deg),
            min_sine: joints
                .iter()
                .map(|joint| joint.min_sine)
                .fold(1.0, f64::min),
            rules: broken(surface, table),
            leaves: table.leaves,
            euler: welded.euler,
            euler_wanted: 1 - table.leaves as i64,
            loops: welded.loops,
            non_manifold: welded.non_manifold,
            inconsistent: welded.inconsistent,
            folded: welded.folded,
            crossings: crossing_pairs(&welded.mesh, MOST_CROSSINGS).len(),
            triangles: welded.mesh.triangles.len(),
            coverage: if distinct > 0.0 {
                areas.iter().sum::<f64>() / distinct
            } else {
                1.0
            },
            area_m2: distinct,
            copy_deviation_m: table.copy_deviation_m(surface),
            joints,
        };
        (measures, welded)
    }

    /// What misses its goal when joints may open to an angle: [`GOAL_ANGLE_DEG`] or
    /// [`GOAL_EDITED_ANGLE_DEG`].
    pub fn misses(&self, angle_deg: f64) -> Vec<String> {
        let gap_m = GOAL_GAP * self.size_m;
        let mut misses = Vec::new();
        let mut say = |missed: bool, what: String| misses.extend(missed.then_some(what));
        say(
            self.gap_m > gap_m,
            format!("a joint gapes by {:e} m, more than {gap_m:e} m", self.gap_m),
        );
        say(
            self.angle_deg > angle_deg,
            format!(
                "normals differ by {:e}° at a joint, more than {angle_deg:e}°",
                self.angle_deg
            ),
        );
        say(
            self.min_sine < REGULAR_SINE,
            format!(
                "S_u and S_v are parallel at a joint: sine {:e}",
                self.min_sine
            ),
        );
        say(
            self.euler != self.euler_wanted,
            format!("Euler number {}, not {}", self.euler, self.euler_wanted),
        );
        say(
            self.loops != self.leaves + 1,
            format!("{} open ends, not {}", self.loops, self.leaves + 1),
        );
        for (count, what) in [
            (self.non_manifold, "edges with more than two triangles"),
            (
                self.inconsistent,
                "edges whose triangles turn against each other",
            ),
            (self.folded, "folded edges"),
            (self.crossings, "crossing pairs of triangles"),
        ] {
            say(count > 0, format!("{count} {what}"));
        }
        misses
    }
}

/// Area of a patch, m², by Gauss points in each span.
fn area(surface: &Surface, patch: &Patch) -> f64 {
    let nodes = |knots: &KnotVector, [start, end]: [f64; 2]| -> Vec<(BasisWindow, f64)> {
        let rule = gauss_legendre(knots.degree() + 3);
        let t = knots.knots();
        let spans = knots.spans().filter(|&i| t[i] >= start && t[i + 1] <= end);
        spans
            .flat_map(|i| {
                let half = 0.5 * (t[i + 1] - t[i]);
                rule.iter()
                    .map(move |&(x, weight)| (0.5 * (t[i] + t[i + 1]) + half * x, weight * half))
                    .collect::<Vec<_>>()
            })
            .map(|(at, weight)| (knots.window(at), weight))
            .collect()
    };
    let (us, vs) = (
        nodes(surface.knots_u(), patch.u),
        nodes(surface.knots_v(), patch.v),
    );
    let mut sum = 0.0;
    for (wu, a) in &us {
        for (wv, b) in &vs {
            let frame = surface.frame_in(wu, wv);
            sum += a * b * frame.du.cross(&frame.dv).norm();
        }
    }
    sum
}
