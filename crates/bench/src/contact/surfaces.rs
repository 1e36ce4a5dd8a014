//! Cases of two surfaces, of a surface with itself, and of flat patches.

use super::inputs::{TOOL_RADIUS_M, ball_over, covering, flat, plane_over, poses, sausage};
use super::methods::Mesh;
use super::{Known, RESOLUTIONS, Suite, label};
use crate::Row;
use crate::measure::{Times, clocked};
use crate::oracle::Oracle;
use palpate_geometry::contact::own::SelfSolver;
use palpate_geometry::contact::pair::{PairSide, PairSolver};
use palpate_geometry::contact::{ContactSet, Reach};
use palpate_geometry::math::{Point3, Pose};
use palpate_geometry::surface::{ClosestSolver, Surface};
use palpate_sim::solve::rows::Holder;
use palpate_thesis::spheres::{Spheres, SpheresPair};

/// Two surfaces, the second at some poses.
struct Pair<'a> {
    body: &'a Surface,
    tool: &'a Surface,
    poses: &'a [Pose],
}

impl Suite<'_> {
    /// Points on both; `none`: the depth where they find nothing.
    fn pair_of_spheres(
        &mut self,
        case: &str,
        Pair { body, tool, poses }: &Pair<'_>,
        resolutions: &[[usize; 2]],
        known: &Known,
        none: Option<f64>,
    ) {
        for &rows in resolutions {
            let (mut b, mut t) = (Spheres::new(body, rows), Spheres::new(tool, rows));
            let mut pair = SpheresPair::new(&b, &t);
            let mut set = ContactSet::new();
            let result = self.measure(known, |k| {
                let (time, ()) = clocked(|| {
                    b.load(body);
                    t.load_at(tool, &poses[k]);
                    pair.find(&mut b, &mut t, &Reach::TOUCH, &mut set);
                });
                (time, set.deepest().map(|c| c.depth_m).or(none))
            });
            self.report(case, &label(rows), false, &result);
        }
    }

    /// The certified pair on nets that have both moved.
    fn exact_pair(&mut self, case: &str, Pair { body, tool, poses }: &Pair<'_>, known: &Known) {
        let mut placed = Surface::clone(tool);
        let (mut of_body, mut of_tool) = (ClosestSolver::new(body), ClosestSolver::new(tool));
        let mut pair = PairSolver::new(body, tool);
        self.deepest(case, "exact", known, |k, set| {
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
            pair.contacts(body, tool, Reach::TOUCH, set);
        });
    }

    /// Where a body and the ball-shaped tool cross, chords within a micrometre. The error is how
    /// far the points are from the ball, whose radius is known; they are points of the body's
    /// surface by its own evaluation.
    pub(super) fn curves(&mut self, case: &str, body: &Surface, tool: &Surface) {
        let n = self.count(400);
        let poses = poses(body, n, 4e-3);
        let (mut of_body, mut of_tool) = (ClosestSolver::new(body), ClosestSolver::new(tool));
        let mut pair = PairSolver::new(body, tool);
        let known = Known::all(n, 0.0);
        let result = self.measure(&known, |k| {
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
        let (surface, depth_m) = sausage(0.0075);
        let mut solver = ClosestSolver::new(&surface);
        let mut own = SelfSolver::new(&surface);
        let known = Known::all(n, depth_m);
        self.deepest(case, "exact", &known, |_, set| {
            solver.net_changed();
            own.contacts(&surface, &mut solver, Reach::TOUCH, surface.size(), set);
        });
    }

    /// A sausage that folds slowly, with a query as a tick makes it: for gaps and folds up to a small share of the size.
    pub(super) fn folding_sausage(&mut self, case: &str) {
        let n = self.count(2_000);
        let belly_m = |k: usize| 0.0064 + 1.5e-4 * k as f64 / n as f64;
        let known = Known::of(n, 20, |k| sausage(belly_m(k)).1);
        let [(start, _), (end, _)] = [0, n].map(|k| sausage(belly_m(k)));
        let mut surface = start.clone();
        let mut solver = ClosestSolver::new(&surface);
        let mut own = SelfSolver::new(&surface);
        let size_m = surface.size();
        let reach = Reach {
            margin_m: 1e-4 * size_m,
            ..Reach::TOUCH
        };
        self.deepest(case, "exact", &known, |k, set| {
            let share = k as f64 / n as f64;
            let ends = start.net().points().iter().zip(end.net().points());
            for (point, (from, to)) in surface.net_mut().points_mut().iter_mut().zip(ends) {
                *point = from + share * (to - from);
            }
            solver.net_changed();
            own.contacts(&surface, &mut solver, reach, 5e-3 * size_m, set);
        });
    }

    /// Whole ticks of a soft one, one leg held, the other pressed onto it with 2 mm/s by a plate.
    pub(super) fn pressed_sausage(&mut self, case: &str) {
        let mut row = Row::new("contact", case, "exact");
        match crate::parse(&soft(&sausage(0.006).0)) {
            Ok(mut world) => {
                let (mut times, mut touching) = (Vec::new(), 0);
                let ticks = 2_500;
                for k in 0..ticks {
                    let (time, ()) = clocked(|| {
                        world.at_in_place([0.031 - 2e-6 * f64::from(k), 0.04, 0.0]);
                    });
                    let contacts = world.record.output.contacts.list();
                    if contacts.iter().any(|c| c.holder == Holder::Body(0)) {
                        touching += 1;
                        times.push(time.as_secs_f64());
                    }
                }
                row = row
                    .timed(Times::of(times))
                    .saying(format!("{touching} of {ticks} ticks in touch with itself"));
            }
            Err(why) => row = row.saying(why),
        }
        (self.out)(row);
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
        let known = Known::of(n, 100, |k| {
            TOOL_RADIUS_M - oracle.distance(surface, &Point3::from(poses[k].translation.vector))
        });
        let pair = Pair {
            body: surface,
            tool,
            poses: &poses,
        };
        self.exact_pair(case, &pair, &known);
        self.pair_of_spheres(case, &pair, resolutions, &known, None);
        let other = Mesh::new(tool);
        self.parry(case, surface, &known, |mesh, k| {
            mesh.load(surface);
            mesh.other(&other, &poses[k])
        });
    }

    /// Two flat patches, the second moved along itself until that share of the first is covered.
    pub(super) fn flat_surfaces(&mut self, case: &str, percent: u32) {
        let n = self.count(400);
        let (sheet, pose) = (flat(), covering(percent));
        let known = Known::all(n, 0.0);
        let pair = Pair {
            body: &sheet,
            tool: &sheet,
            poses: &vec![pose; n],
        };
        self.exact_pair(case, &pair, &known);
        // None here is a miss of any size.
        self.pair_of_spheres(case, &pair, &RESOLUTIONS[..3], &known, Some(f64::INFINITY));
        let other = Mesh::new(&sheet);
        self.parry(case, &sheet, &known, |mesh, _| {
            mesh.load(&sheet);
            mesh.other(&other, &pose)
        });
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
        let known = Known::all(n, exact);
        self.spheres(case, sheet, &RESOLUTIONS[..3], &known, |spheres, _, set| {
            spheres.load(sheet);
            ask(spheres, set);
        });
    }
}

/// A scene with a soft sausage of twelve controls around.
fn soft(sausage: &Surface) -> String {
    let columns = sausage.net().columns();
    let points: Vec<Vec<[f64; 3]>> = (sausage.net().points().chunks(columns))
        .map(|row| row.iter().map(|x| [x.x, x.y, x.z]).collect())
        .collect();
    let around: Vec<usize> = (0..=points.len()).collect();
    let along: Vec<usize> = (0..columns + 4).map(|k| k.clamp(3, columns) - 3).collect();
    format!(
        r#"
[[body]]
id = "sausage"
model = "lattice"
self_contact = true
material = {{ young_pa = 8e3 }}
lattice = {{ layers = 2, refine = "none" }}
fixed = [{{ point = [-0.015, 0.0, 0.0], normal = [1.0, 0.0, 0.0] }}]
[body.surface.inline]
format = "palpate.surface.v1"
degree = [3, 3]
periodic = [true, false]
knots = [{around:?}, {along:?}]
points = {points:?}
[[tool]]
id = "plate"
shape = {{ plane = {{ normal = [-1.0, 0.0, 0.0] }} }}
pose = {{ position = [0.031, 0.04, 0.0] }}
coupling = {{ stiffness_n_m = 500.0, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}
"#
    )
}
