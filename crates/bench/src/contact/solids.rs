//! Cases of one surface and a tool of another kind.

use super::inputs::{TOOL_RADIUS_M, near, planes, poses, slide, solid_torus, tool};
use super::methods::{Mesh, ball_mesh};
use super::{Known, RESOLUTIONS, Suite, oracle};
use crate::inputs::{Random, walk};
use crate::measure::clocked;
use crate::oracle::Oracle;
use palpate_geometry::contact::dispatch::{Method, Narrow, Party};
use palpate_geometry::contact::exact::{self, ExactScratch};
use palpate_geometry::contact::implicit::{ImplicitShape, ImplicitSolver, ImplicitTool};
use palpate_geometry::contact::mesh::MeshSolver;
use palpate_geometry::contact::{ContactSet, Reach, ToolShape};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::skin::{Skin, SkinSide, SkinSolver};
use palpate_geometry::surface::{ClosestSolver, Surface, WarmFoot};
use palpate_thesis::spheres::Solid;

/// The depth next to the one that is known. Corners and edges of a tool inside the body are contacts too, and may be deeper
/// than any point of the surface, which is what the oracle knows.
fn next_to_known(known: &Known, k: usize, set: &ContactSet) -> Option<f64> {
    let mut depths = known.depths.iter();
    let wanted = depths
        .find(|known| known.0 == k)
        .map_or(0.0, |known| known.1);
    let miss = |depth: &f64| (depth - wanted).abs();
    let depths = set.contacts().iter().map(|c| c.depth_m);
    depths.min_by(|a, b| miss(a).total_cmp(&miss(b)))
}

/// Depth of a point along the gradient of a function that grows on this way out, by bisection.
fn depth_along(tool: &ImplicitTool, p: &Point3) -> f64 {
    let (value, gradient) = tool.tape().gradient(p);
    if value > 0.0 {
        return -value / gradient.norm();
    }
    let out = gradient.normalize();
    let (mut low, mut high) = (0.0, 4.0 * TOOL_RADIUS_M);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        match tool.tape().value(&(p + out * middle)) <= 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

impl Suite<'_> {
    pub(super) fn ball(
        &mut self,
        case: &str,
        surface: &Surface,
        radius_m: f64,
        warm: bool,
        resolutions: &[[usize; 2]],
    ) {
        let n = self.count(10_000);
        let centres: Vec<Point3> = if warm {
            walk(surface, n)
        } else {
            near(surface, n, radius_m)
        };
        let mut oracle = Oracle::new(surface);
        let mut solver = ClosestSolver::new(surface);
        // The oracle knows no sides: which one is taken from the certified answer, the distance is
        // its own.
        let known = Known::of(n, 200, |k| {
            let foot = solver.closest(surface, &centres[k]);
            radius_m - foot.signed_distance.signum() * oracle.distance(surface, &centres[k])
        });
        let (mut foot, mut last) = (WarmFoot::default(), centres[0]);
        let (mut scratch, mut set) = (ExactScratch::new(surface, &mut solver), ContactSet::new());
        let result = self.measure(&known, |k| {
            let centre = &centres[k];
            if warm {
                // What the tick does: the foot is followed while its certificate lasts.
                let moved_m = (centre - last).norm();
                last = *centre;
                let (time, found) =
                    clocked(|| solver.closest_warm_moved(surface, centre, moved_m, 0.0, &mut foot));
                let depth = radius_m - found.signed_distance;
                return (time, (depth >= 0.0).then_some(depth));
            }
            let (time, ()) = clocked(|| {
                solver.net_changed();
                exact::ball::contacts(
                    surface,
                    &mut solver,
                    centre,
                    radius_m,
                    &Reach::TOUCH,
                    &mut scratch,
                    &mut set,
                );
            });
            (time, set.deepest().map(|c| c.depth_m))
        });
        self.report(case, "exact", false, &result);
        self.spheres(case, surface, resolutions, &known, |spheres, k, set| {
            if !warm {
                spheres.load(surface);
            }
            spheres.ball(&centres[k], radius_m, &Reach::TOUCH, set);
        });
        self.parry(case, surface, &known, |mesh, k| {
            if !warm {
                mesh.load(surface);
            }
            mesh.ball(&centres[k], radius_m)
        });
    }

    pub(super) fn plane(&mut self, case: &str, surface: &Surface, resolutions: &[[usize; 2]]) {
        let n = self.count(2_000);
        let mut solver = ClosestSolver::new(surface);
        let planes: Vec<(Point3, Vector3)> = planes(surface, &mut solver, n);
        let mut oracle = oracle::Sampled::new(surface);
        let known = Known::of(n, 40, |k| {
            oracle.greatest(surface, |p| (planes[k].0 - p).dot(&planes[k].1))
        });
        let mut scratch = ExactScratch::new(surface, &mut solver);
        self.deepest(case, "exact", &known, |k, set| {
            let (origin, normal) = &planes[k];
            solver.net_changed();
            exact::plane::contacts(
                surface,
                &mut solver,
                origin,
                normal,
                &Reach::TOUCH,
                &mut scratch,
                set,
            );
        });
        self.spheres(case, surface, resolutions, &known, |spheres, k, set| {
            let (origin, normal) = planes[k];
            spheres.load(surface);
            spheres.plane(&origin, &normal, &Reach::TOUCH, set);
        });
        self.parry(case, surface, &known, |mesh, k| {
            let (origin, normal) = planes[k];
            mesh.load(surface);
            mesh.plane(&origin, &normal)
        });
    }

    pub(super) fn implicit(&mut self, case: &str, surface: &Surface) {
        let n = self.count(2_000);
        let mut random = Random(4);
        let tools: Vec<_> = (0..n).map(|_| solid_torus(surface, &mut random)).collect();
        let mut oracle = oracle::Sampled::new(surface);
        let known = Known::of(n, 40, |k| {
            oracle.greatest(surface, |p| -tools[k].signed_gap(p).0)
        });
        let skin = Skin::from(surface.clone());
        let mut solver = SkinSolver::new(&skin);
        let mut exact = ImplicitSolver::new(&skin);
        self.deepest(case, "exact", &known, |k, set| {
            solver.net_changed();
            exact.contacts(
                SkinSide {
                    skin: &skin,
                    solver: &mut solver,
                },
                &tools[k].tool,
                &tools[k].pose,
                &Reach::TOUCH,
                &[],
                set,
            );
        });
        self.spheres(case, surface, &RESOLUTIONS, &known, |spheres, k, set| {
            spheres.load(surface);
            spheres.solid(&tools[k], &Reach::TOUCH, set);
        });
    }

    /// A function whose edges are known, or that has none, asked for as a tick does.
    pub(super) fn function(&mut self, case: &str, surface: &Surface, text: &str) {
        let n = self.count(400);
        let text = text.to_owned();
        let tool = ImplicitShape::Expression { text }.compile();
        let tool = tool
            .expect("a function")
            .with_edges_found(1.5 * TOOL_RADIUS_M);
        let poses = poses(surface, n, 8e-3);
        let mut oracle = oracle::Sampled::coarse(surface);
        let known = Known::of(n, 4, |k| {
            oracle.greatest(surface, |p| {
                depth_along(&tool, &poses[k].inverse_transform_point(p))
            })
        });
        let skin = Skin::from(surface.clone());
        let mut solver = SkinSolver::new(&skin);
        let shape = ToolShape::Implicit {
            tool: Box::new(tool),
            reach_m: None,
        };
        let pair = Narrow::new((&skin).into(), Party::Tool(&shape), Method::Exact);
        let mut pair = pair.expect("functions touch surfaces");
        let result = self.measure(&known, |k| {
            let (time, ()) = clocked(|| {
                solver.net_changed();
                let body = SkinSide {
                    skin: &skin,
                    solver: &mut solver,
                };
                pair.contacts(&shape, &poses[k], body, Reach::TOUCH);
            });
            (time, next_to_known(&known, k, &pair.set))
        });
        self.report(case, "exact", false, &result);
    }

    /// The tool is a triangle mesh of so many cells a piece; cold, also for the spheres, as a solid by its signed distance.
    pub(super) fn mesh(&mut self, case: &str, surface: &Surface, cells: [usize; 2], warm: bool) {
        let n = self.count(400);
        let (tool_surface, tool_mesh) = (tool(8), ball_mesh(cells));
        let poses = if warm {
            slide(surface, &walk(surface, n))
        } else {
            poses(surface, n, 3e-3)
        };
        let mut oracle = oracle::Sampled::coarse(surface);
        let known = Known::of(n, 4, |k| {
            oracle.greatest(surface, |p| -tool_mesh.at(&poses[k]).signed_gap(p).0)
        });
        let skin = Skin::from(surface.clone());
        let mut solver = SkinSolver::new(&skin);
        let (mut exact, mut set) = (MeshSolver::new(&skin, &tool_mesh.tool), ContactSet::new());
        let result = self.measure(&known, |k| {
            let (time, ()) = clocked(|| {
                if !warm {
                    solver.net_changed();
                }
                exact.contacts(
                    SkinSide {
                        skin: &skin,
                        solver: &mut solver,
                    },
                    &tool_mesh.tool,
                    &poses[k],
                    &Reach::TOUCH,
                    &[],
                    &mut set,
                );
            });
            (time, next_to_known(&known, k, &set))
        });
        self.report(case, "exact", false, &result);
        if warm {
            return;
        }
        self.spheres(
            case,
            surface,
            &RESOLUTIONS[..3],
            &known,
            |spheres, k, set| {
                spheres.load(surface);
                spheres.solid(&tool_mesh.at(&poses[k]), &Reach::TOUCH, set);
            },
        );
        let other = Mesh::new(&tool_surface);
        self.parry(case, surface, &known, |mesh, k| {
            mesh.load(surface);
            mesh.other(&other, &poses[k])
        });
    }
}
