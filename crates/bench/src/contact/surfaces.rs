//! Cases of two surfaces, of a surface with itself, and of flat patches.

use super::inputs::{TOOL_RADIUS_M, ball_over, covering, flat, plane_over, poses, sausage};
use super::methods::{Mesh, PARRY};
use super::{RESOLUTIONS, Suite, label};
use crate::measure::clocked;
use crate::oracle::Oracle;
use palpate_geometry::contact::own::SelfSolver;
use palpate_geometry::contact::pair::{PairSide, PairSolver};
use palpate_geometry::contact::{ContactSet, Reach};
use palpate_geometry::math::{Point3, Pose};
use palpate_geometry::surface::{ClosestSolver, Surface};
use palpate_thesis::spheres::{Spheres, SpheresPair};

impl Suite<'_> {
    /// The certified pair on nets that have both moved.
    fn exact_pair(
        &mut self,
        case: &str,
        body: &Surface,
        tool: &Surface,
        poses: &[Pose],
        known: &[(usize, f64)],
    ) {
        let mut placed = tool.clone();
        let (mut of_body, mut of_tool) = (ClosestSolver::new(body), ClosestSolver::new(tool));
        let (mut pair, mut set) = (PairSolver::new(body, tool), ContactSet::new());
        let result = self.measure(poses.len(), known, |k| {
            let (time, ()) = clocked(|| {
                for (to, from) in placed
                    .net_mut()
                    .points_mut()
                    .iter_mut()
                    .zip(tool.net().points())
                {
                    *to = poses[k] * from;
                }
                of_body.net_changed();
                of_tool.net_changed();
                let (body, tool) = (
                    PairSide {
                        surface: body,
                        solver: &mut of_body,
                    },
                    PairSide {
                        surface: &placed,
                        solver: &mut of_tool,
                    },
                );
                pair.contacts(body, tool, Reach::TOUCH, &mut set);
            });
            (time, set.deepest().map(|c| c.depth_m))
        });
        self.report(case, "exact", false, &result);
    }

    /// Where a body and the ball-shaped tool cross, chords within a micrometre. The error is how
    /// far the points are from the ball, whose radius is known; they are points of the body's
    /// surface by its own evaluation.
    pub(super) fn curves(&mut self, case: &str, body: &Surface, tool: &Surface) {
        let n = self.count(400);
        let poses = poses(body, n, 4e-3);
        let (mut of_body, mut of_tool) = (ClosestSolver::new(body), ClosestSolver::new(tool));
        let mut pair = PairSolver::new(body, tool);
        let known: Vec<(usize, f64)> = (0..n).map(|k| (k, 0.0)).collect();
        let result = self.measure(n, &known, |k| {
            let placed = tool.transformed(&poses[k]);
            let (time, curves) = clocked(|| {
                of_body.net_changed();
                of_tool.net_changed();
                let sides = (
                    PairSide {
                        surface: body,
                        solver: &mut of_body,
                    },
                    PairSide {
                        surface: &placed,
                        solver: &mut of_tool,
                    },
                );
                pair.curves(sides.0, sides.1, 1e-6)
            });
            let centre = Point3::from(poses[k].translation.vector);
            let points = curves.iter().flat_map(|curve| &curve.points);
            let miss = points.map(|p| {
                let off_ball = ((p.point - centre).norm() - TOOL_RADIUS_M).abs();
                off_ball.max((p.point - body.point(p.u, p.v)).norm())
            });
            // No curve at all would be a miss of any size: at these depths all poses cross.
            let miss = if curves.is_empty() {
                f64::INFINITY
            } else {
                miss.fold(0.0, f64::max)
            };
            (time, Some(miss))
        });
        self.report(case, "exact", false, &result);
    }

    /// A folded sausage that passes through itself.
    pub(super) fn sausage(&mut self, case: &str) {
        let n = self.count(2_000);
        let (surface, depth_m) = sausage();
        let mut solver = ClosestSolver::new(&surface);
        let (mut own, mut set) = (SelfSolver::new(&surface), ContactSet::new());
        let known: Vec<(usize, f64)> = (0..n).map(|k| (k, depth_m)).collect();
        let result = self.measure(n, &known, |_| {
            let (time, ()) = clocked(|| {
                solver.net_changed();
                own.contacts(
                    &surface,
                    &mut solver,
                    Reach::TOUCH,
                    surface.size(),
                    &mut set,
                );
            });
            (time, set.deepest().map(|c| c.depth_m))
        });
        self.report(case, "exact", false, &result);
    }

    pub(super) fn surfaces(
        &mut self,
        case: &str,
        surface: &Surface,
        tool: &Surface,
        depth_m: f64,
        resolutions: &[[usize; 2]],
    ) {
        let n = self.count(1_000);
        let poses = poses(surface, n, depth_m);
        // The tool is a ball with a net: its deepest point inside is as deep as the ball is, while
        // its centre is outside.
        let mut oracle = Oracle::new(surface);
        let known: Vec<(usize, f64)> = (0..n)
            .step_by((n / 100).max(1))
            .map(|k| {
                (
                    k,
                    TOOL_RADIUS_M
                        - oracle.distance(surface, &Point3::from(poses[k].translation.vector)),
                )
            })
            .collect();
        self.exact_pair(case, surface, tool, &poses, &known);
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
        self.report(case, PARRY, true, &result);
    }

    /// Two flat patches, the second moved along itself until that share of the first is covered.
    pub(super) fn flat_surfaces(&mut self, case: &str, percent: u32) {
        let n = self.count(400);
        let (sheet, pose) = (flat(), covering(percent));
        let known: Vec<(usize, f64)> = (0..n).map(|k| (k, 0.0)).collect();
        self.exact_pair(case, &sheet, &sheet, &vec![pose; n], &known);
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
                (
                    time,
                    Some(set.deepest().map_or(f64::INFINITY, |c| c.depth_m)),
                )
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
        self.report(case, PARRY, true, &result);
    }

    /// A ball above the middle of a flat patch, so large that that share of it is inside.
    pub(super) fn flat_sphere(&mut self, case: &str, percent: u32) {
        let sheet = flat();
        let (centre, radius_m) = ball_over(percent);
        self.flat_solid(case, &sheet, radius_m - centre.z, |spheres, set| {
            spheres.ball(&centre, radius_m, &Reach::TOUCH, set);
        });
    }

    /// A half-space that holds that share of a flat patch, an edge being a millimetre deep.
    pub(super) fn flat_plane(&mut self, case: &str, percent: u32) {
        let sheet = flat();
        let (origin, normal) = plane_over(percent);
        self.flat_solid(case, &sheet, 1e-3, |spheres, set| {
            spheres.plane(&origin, &normal, &Reach::TOUCH, set)
        });
    }

    fn flat_solid(
        &mut self,
        case: &str,
        sheet: &Surface,
        exact: f64,
        ask: impl Fn(&mut Spheres, &mut ContactSet),
    ) {
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
