//! The contact suite: the narrow phases and a triangle mesh on the same poses, each with its error.
//!
//! `exact` answers with certified queries, `spheres N` with points on an N × N grid, the mesh of parry with 82 × 82 vertices
//! of the surface. "Cold" takes a net that has moved and a tool anywhere near, "warm" a rigid body and a tool that wanders.

mod inputs;
mod methods;
mod oracle;
mod svg;

use self::inputs::{body, flat, near, solid_torus, tool};
use self::methods::{Mesh, NOT_A_DEPTH};
use super::inputs::{Random, walk};
use super::measure::{Times, clocked, time};
use super::{Effort, Row};
use crate::contact::spheres::{Solid, Spheres, SpheresPair};
use crate::contact::{ContactSet, Reach};
use crate::math::{Point3, Pose, Vector3};
use crate::surface::{ClosestSolver, Surface, WarmFoot};
use std::time::Duration;

pub use self::svg::picture;

/// Nets of the table: the source thesis has 4 × 4 to 20 × 20.
const NETS: [usize; 9] = [4, 6, 8, 10, 12, 14, 16, 18, 20];
/// Resolutions of the table.
const RESOLUTIONS: [[usize; 2]; 5] = [[28, 28], [28, 82], [82, 82], [82, 244], [244, 244]];
/// Shares of a flat patch in touch, in percent.
const AREAS: [u32; 5] = [1, 5, 25, 50, 100];
/// Radius of the ball, m; the bodies are about 0.1 m long.
const RADIUS_M: f64 = 0.01;

/// Runs the suite; `only` keeps the cases whose names contain it. Each row is handed out as soon as it is measured.
pub fn contact(effort: Effort, only: Option<&str>, out: &mut dyn FnMut(Row)) {
    let mut suite = Suite { effort, out };
    let wanted = |case: &str| only.is_none_or(|part| case.contains(part));
    for (name, radius_m) in [("point", 0.0), ("sphere", RADIUS_M)] {
        for count in NETS {
            for (warm, temper) in [(false, "cold"), (true, "warm")] {
                let case = format!("{name}/{count}x{count}/{temper}");
                if wanted(&case) {
                    suite.ball(&case, &body(count), radius_m, warm, resolutions(count));
                }
            }
        }
    }
    for count in NETS {
        let case = format!("plane/{count}x{count}");
        if wanted(&case) {
            suite.plane(&case, &body(count), resolutions(count));
        }
    }
    for count in [8, 20] {
        let case = format!("implicit/{count}x{count}");
        if wanted(&case) {
            suite.implicit(&case, &body(count));
        }
        let case = format!("mesh/{count}x{count}");
        if wanted(&case) {
            suite.mesh(&case, &body(count));
        }
    }
    for count in NETS {
        // "When these surfaces just start colliding", and when they have.
        for (depth_m, name) in [(1e-3, ""), (4e-3, "/deep")] {
            let case = format!("surface/{count}x{count}{name}");
            if wanted(&case) && (name.is_empty() || count == 8 || count == 20) {
                suite.surfaces(&case, &body(count), &tool(count), depth_m, resolutions(count));
            }
        }
    }
    for percent in AREAS {
        for name in ["", "/sphere", "/plane"] {
            let case = format!("flat/{percent}{name}");
            if wanted(&case) {
                match name {
                    "" => suite.flat_surfaces(&case, percent),
                    "/sphere" => suite.flat_sphere(&case, percent),
                    _ => suite.flat_plane(&case, percent),
                }
            }
        }
    }
}

/// The whole dial on the nets of the thesis' second table, else its middle.
fn resolutions(count: usize) -> &'static [[usize; 2]] {
    if count == 8 || count == 20 { &RESOLUTIONS } else { &RESOLUTIONS[2..3] }
}

fn label([u, v]: [usize; 2]) -> String {
    if u == v { format!("spheres {u}") } else { format!("spheres {u}x{v}") }
}

/// How well a method did: its times, and its largest error where the answer is known.
struct Outcome {
    times: Times,
    error: f64,
}

struct Suite<'a> {
    effort: Effort,
    out: &'a mut dyn FnMut(Row),
}

impl Suite<'_> {
    fn count(&self, full: usize) -> usize {
        if self.effort == Effort::Quick { full / 20 } else { full }
    }

    fn patience(&self) -> Duration {
        Duration::from_millis(if self.effort == Effort::Quick { 100 } else { 3_000 })
    }

    fn report(&mut self, case: &str, method: &str, peer: bool, result: &Outcome) {
        (self.out)(Row {
            suite: "contact",
            case: case.to_owned(),
            method: method.to_owned(),
            peer,
            median_s: result.times.median_s,
            p99_s: result.times.p99_s,
            error: result.error,
            error_unit: "m",
            n: result.times.n,
            wrong: None,
        });
    }

    /// Times `ask` over the poses, and compares the depths it gives with those that are known: (pose, depth), a depth below
    /// zero standing for none.
    fn measure(
        &self,
        poses: usize,
        known: &[(usize, f64)],
        mut ask: impl FnMut(usize) -> (Duration, Option<f64>),
    ) -> Outcome {
        let mut depths = Vec::with_capacity(poses);
        let times = time(poses, self.patience(), |k| {
            let (time, depth) = ask(k);
            depths.push(depth);
            time
        });
        let miss = |&(k, exact): &(usize, f64)| match depths.get(k) {
            Some(Some(depth)) => (depth - exact.max(0.0)).abs(),
            Some(None) => exact.max(0.0),
            None => 0.0,
        };
        Outcome { times, error: known.iter().map(miss).fold(0.0, f64::max) }
    }

    fn ball(&mut self, case: &str, surface: &Surface, radius_m: f64, warm: bool, resolutions: &[[usize; 2]]) {
        let n = self.count(10_000);
        let centres: Vec<Point3> = if warm { walk(surface, n) } else { near(surface, n, radius_m) };
        let mut oracle = super::oracle::Oracle::new(surface);
        let mut solver = ClosestSolver::new(surface);
        // The oracle knows no sides: which one is taken from the certified answer, the distance is its own.
        let known: Vec<(usize, f64)> = (0..n)
            .step_by((n / 200).max(1))
            .map(|k| {
                let side = solver.closest(surface, &centres[k]).signed_distance.signum();
                (k, radius_m - side * oracle.distance(surface, &centres[k]))
            })
            .collect();
        let (mut foot, mut last) = (WarmFoot::default(), centres[0]);
        let result = self.measure(n, &known, |k| {
            let (time, found) = clocked(|| {
                if warm {
                    solver.closest_warm_moved(surface, &centres[k], (centres[k] - last).norm(), 0.0, &mut foot)
                } else {
                    solver.net_changed();
                    solver.closest(surface, &centres[k])
                }
            });
            last = centres[k];
            let depth = radius_m - found.signed_distance;
            (time, (depth >= 0.0).then_some(depth))
        });
        self.report(case, "exact", false, &result);
        for &rows in resolutions {
            let mut spheres = Spheres::new(surface, rows);
            let mut set = ContactSet::new();
            let result = self.measure(n, &known, |k| {
                let (time, ()) = clocked(|| {
                    if !warm {
                        spheres.load(surface);
                    }
                    spheres.ball(&centres[k], radius_m, &Reach::TOUCH, &mut set);
                });
                (time, set.deepest().map(|c| c.depth_m))
            });
            self.report(case, &label(rows), false, &result);
        }
        let mut mesh = Mesh::new(surface);
        let result = self.measure(n, &known, |k| {
            clocked(|| {
                if !warm {
                    mesh.load(surface);
                }
                mesh.ball(&centres[k], radius_m)
            })
        });
        self.report(case, methods::PARRY, true, &result);
    }

    fn plane(&mut self, case: &str, surface: &Surface, resolutions: &[[usize; 2]]) {
        let n = self.count(2_000);
        let mut solver = ClosestSolver::new(surface);
        let planes: Vec<(Point3, Vector3)> = inputs::planes(surface, &mut solver, n);
        let mut oracle = oracle::Sampled::new(surface);
        let known: Vec<(usize, f64)> = (0..n)
            .step_by((n / 40).max(1))
            .map(|k| (k, oracle.greatest(surface, |p| (planes[k].0 - p).dot(&planes[k].1))))
            .collect();
        let result = self.measure(n, &known, |k| {
            let (origin, normal) = planes[k];
            let (time, found) = clocked(|| {
                solver.net_changed();
                solver.deepest_along(surface, &-normal)
            });
            let depth = (origin - found.2).dot(&normal);
            (time, (depth >= 0.0).then_some(depth))
        });
        self.report(case, "exact", false, &result);
        for &rows in resolutions {
            let mut spheres = Spheres::new(surface, rows);
            let mut set = ContactSet::new();
            let result = self.measure(n, &known, |k| {
                let (origin, normal) = planes[k];
                let (time, ()) = clocked(|| {
                    spheres.load(surface);
                    spheres.plane(&origin, &normal, &Reach::TOUCH, &mut set);
                });
                (time, set.deepest().map(|c| c.depth_m))
            });
            self.report(case, &label(rows), false, &result);
        }
        let mut mesh = Mesh::new(surface);
        let result = self.measure(n, &known, |k| {
            let (origin, normal) = planes[k];
            clocked(|| {
                mesh.load(surface);
                mesh.plane(&origin, &normal)
            })
        });
        self.report(case, methods::PARRY, true, &result);
    }

    fn implicit(&mut self, case: &str, surface: &Surface) {
        let n = self.count(2_000);
        let mut random = Random(4);
        let tools: Vec<_> = (0..n).map(|_| solid_torus(surface, &mut random)).collect();
        let mut oracle = oracle::Sampled::new(surface);
        let known: Vec<(usize, f64)> = (0..n)
            .step_by((n / 40).max(1))
            .map(|k| (k, oracle.greatest(surface, |p| -tools[k].signed_gap(p).0)))
            .collect();
        for rows in RESOLUTIONS {
            let mut spheres = Spheres::new(surface, rows);
            let mut set = ContactSet::new();
            let result = self.measure(n, &known, |k| {
                let (time, ()) = clocked(|| {
                    spheres.load(surface);
                    spheres.solid(&tools[k], &Reach::TOUCH, &mut set);
                });
                (time, set.deepest().map(|c| c.depth_m))
            });
            self.report(case, &label(rows), false, &result);
        }
    }

    /// The tool is a triangle mesh. For the spheres it is a solid that parry measures the distance to.
    fn mesh(&mut self, case: &str, surface: &Surface) {
        let n = self.count(400);
        let tool = tool(8);
        let mesh_tool = Mesh::new(&tool);
        let poses: Vec<Pose> = inputs::poses(surface, n, 3e-3);
        let mut oracle = oracle::Sampled::coarse(surface);
        let known: Vec<(usize, f64)> = (0..n)
            .step_by((n / 4).max(1))
            .map(|k| (k, oracle.greatest(surface, |p| -mesh_tool.at(&poses[k]).signed_gap(p).0)))
            .collect();
        for rows in &RESOLUTIONS[..3] {
            let mut spheres = Spheres::new(surface, *rows);
            let mut set = ContactSet::new();
            let result = self.measure(n, &known, |k| {
                let (time, ()) = clocked(|| {
                    spheres.load(surface);
                    spheres.solid(&mesh_tool.at(&poses[k]), &Reach::TOUCH, &mut set);
                });
                (time, set.deepest().map(|c| c.depth_m))
            });
            self.report(case, &label(*rows), false, &result);
        }
        let mut mesh = Mesh::new(surface);
        let result = self.measure(n, &known, |k| {
            clocked(|| {
                mesh.load(surface);
                mesh.other(&mesh_tool, &poses[k])
            })
        });
        self.report(case, NOT_A_DEPTH, true, &result);
    }

    fn surfaces(&mut self, case: &str, surface: &Surface, tool: &Surface, depth_m: f64, resolutions: &[[usize; 2]]) {
        let n = self.count(1_000);
        let poses = inputs::poses(surface, n, depth_m);
        // The tool is a ball with a net: its deepest point inside is as deep as the ball is, while its centre is outside.
        let mut oracle = super::oracle::Oracle::new(surface);
        let known: Vec<(usize, f64)> = (0..n)
            .step_by((n / 100).max(1))
            .map(|k| (k, inputs::TOOL_RADIUS_M - oracle.distance(surface, &Point3::from(poses[k].translation.vector))))
            .collect();
        for &rows in resolutions {
            let (mut b, mut t) = (Spheres::new(surface, rows), Spheres::new(tool, rows));
            let mut pair = SpheresPair::new(&b, &t);
            let mut set = ContactSet::new();
            let result = self.measure(n, &known, |k| {
                let (time, ()) = clocked(|| {
                    b.load(surface);
                    t.load_at(tool, &poses[k]);
                    pair.find(&mut b, &mut t, &Reach::TOUCH, &mut set);
                });
                (time, set.deepest().map(|c| c.depth_m))
            });
            self.report(case, &label(rows), false, &result);
        }
        let (mut mesh, other) = (Mesh::new(surface), Mesh::new(tool));
        let result = self.measure(n, &known, |k| {
            clocked(|| {
                mesh.load(surface);
                mesh.other(&other, &poses[k])
            })
        });
        self.report(case, NOT_A_DEPTH, true, &result);
    }

    /// Two flat patches, the second moved along itself until that share of the first is covered.
    fn flat_surfaces(&mut self, case: &str, percent: u32) {
        let n = self.count(400);
        let (sheet, pose) = (flat(), inputs::covering(percent));
        let known: Vec<(usize, f64)> = (0..n).map(|k| (k, 0.0)).collect();
        for rows in &RESOLUTIONS[..3] {
            let (mut b, mut t) = (Spheres::new(&sheet, *rows), Spheres::new(&sheet, *rows));
            let mut pair = SpheresPair::new(&b, &t);
            let mut set = ContactSet::new();
            let result = self.measure(n, &known, |_| {
                let (time, ()) = clocked(|| {
                    b.load(&sheet);
                    t.load_at(&sheet, &pose);
                    pair.find(&mut b, &mut t, &Reach::TOUCH, &mut set);
                });
                // None here is a miss of any size.
                (time, Some(set.deepest().map_or(f64::INFINITY, |c| c.depth_m)))
            });
            self.report(case, &label(*rows), false, &result);
        }
        let (mut mesh, other) = (Mesh::new(&sheet), Mesh::new(&sheet));
        let result = self.measure(n, &known, |_| {
            clocked(|| {
                mesh.load(&sheet);
                mesh.other(&other, &pose)
            })
        });
        self.report(case, NOT_A_DEPTH, true, &result);
    }

    /// A ball above the middle of a flat patch, so large that that share of it is inside.
    fn flat_sphere(&mut self, case: &str, percent: u32) {
        let sheet = flat();
        let (centre, radius_m) = inputs::ball_over(percent);
        self.flat_solid(case, &sheet, radius_m - centre.z, |spheres, set| {
            spheres.ball(&centre, radius_m, &Reach::TOUCH, set);
        });
    }

    /// A half-space that holds that share of a flat patch, an edge being a millimetre deep.
    fn flat_plane(&mut self, case: &str, percent: u32) {
        let sheet = flat();
        let (origin, normal) = inputs::plane_over(percent);
        self.flat_solid(case, &sheet, 1e-3, |spheres, set| spheres.plane(&origin, &normal, &Reach::TOUCH, set));
    }

    fn flat_solid(&mut self, case: &str, sheet: &Surface, exact: f64, ask: impl Fn(&mut Spheres, &mut ContactSet)) {
        let n = self.count(1_000);
        let known: Vec<(usize, f64)> = (0..n).map(|k| (k, exact)).collect();
        for rows in &RESOLUTIONS[..3] {
            let mut spheres = Spheres::new(sheet, *rows);
            let mut set = ContactSet::new();
            let result = self.measure(n, &known, |_| {
                let (time, ()) = clocked(|| {
                    spheres.load(sheet);
                    ask(&mut spheres, &mut set);
                });
                (time, set.deepest().map(|c| c.depth_m))
            });
            self.report(case, &label(*rows), false, &result);
        }
    }
}
