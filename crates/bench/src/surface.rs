//! The surface suite: closest points cold and warm, grids, fits, refreshed bounds.

use super::inputs::{breathe, largest_movement, scattered, spread, walk};
use super::measure::{Times, clocked, time};
use super::oracle::Oracle;
use super::peers;
use super::{Cases, Effort, Row};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{
    ClosestSolver, ControlNet, GridFit, SampleGrid, Surface, WarmFoot, builtin,
};
use std::time::Duration;

const NETS: [usize; 3] = [8, 12, 20];

/// Runs cases of the suite. Each row is handed out as soon as
/// it is measured.
pub fn surface(effort: Effort, cases: Cases<'_>, out: &mut dyn FnMut(Row)) {
    let mut suite = Suite { effort, out };
    let wanted = |case: &str| cases.has(case);
    for count in NETS {
        let case = format!("closest/cold/{count}x{count}");
        if wanted(&case) {
            suite.cold(&case, &teardrop(count));
        }
    }
    for count in NETS {
        let case = format!("closest/warm/{count}x{count}");
        if wanted(&case) {
            suite.warm(&case, &teardrop(count), false);
        }
    }
    if wanted("closest/warm/20x20/moving-net") {
        suite.warm("closest/warm/20x20/moving-net", &teardrop(20), true);
    }
    if wanted("grid/82x82/normals") {
        suite.grid("grid/82x82/normals", &teardrop(8), 82, true);
    }
    if wanted("blending/50x50/244x244") {
        suite.grid("blending/50x50/244x244", &refined(50), 244, false);
    }
    if wanted("fit/8x8/82x82") {
        suite.fit("fit/8x8/82x82", &teardrop(8));
    }
    for count in NETS {
        let case = format!("refresh-bounds/{count}x{count}");
        if wanted(&case) {
            suite.refresh(&case, &teardrop(count));
        }
    }
}

fn teardrop(count: usize) -> Surface {
    builtin("teardrop", Some([count; 2]), None).expect("a builtin")
}

/// A sheet's net of `count` × `count`, bent so that no blend is trivial.
fn refined(count: usize) -> Surface {
    let mut sheet = builtin("sheet", Some([count; 2]), None).expect("a builtin");
    for point in sheet.net_mut().points_mut() {
        point.z = 0.02 * libm::sin(60.0 * point.x) * libm::cos(45.0 * point.y);
    }
    sheet
}

struct Suite<'a> {
    effort: Effort,
    out: &'a mut dyn FnMut(Row),
}

/// What a method answered: the worst excess over the exact distance, m, and how many answers are
/// wrong.
#[derive(Default)]
struct Verdict {
    error: f64,
    wrong: usize,
}

/// The oracle may miss: beside a pole its samples start Newton on the wrong meridian. Our feet are
/// points of the surface, so where one is nearer than what the oracle found, that distance is the
/// better reference for all.
fn sharpen(exact: &mut [(usize, f64)], feet: &[Option<Point3>], queries: &[Point3]) {
    for (k, distance) in exact {
        if let Some(foot) = feet[*k] {
            *distance = distance.min((foot - queries[*k]).norm());
        }
    }
}

impl Verdict {
    fn of(
        answers: &[Option<Point3>],
        queries: &[Point3],
        exact: &[(usize, f64)],
        size_m: f64,
    ) -> Self {
        let mut verdict = Self::default();
        for &(k, distance) in exact.iter().filter(|(k, _)| *k < answers.len()) {
            // Rounding of the coordinates when the query is far away.
            let tolerance = 1e-9 * size_m + 4.0 * f64::EPSILON * queries[k].coords.amax();
            match answers[k].map(|foot| (foot - queries[k]).norm() - distance) {
                Some(excess) => {
                    // A foot beside the surface may be nearer than the surface: wrong as well.
                    verdict.error = verdict.error.max(excess.abs());
                    verdict.wrong += usize::from(excess.is_nan() || excess.abs() > tolerance);
                }
                None => verdict.wrong += 1,
            }
        }
        verdict
    }
}

/// Closest points that were asked for, and distances that are known.
struct Asked<'a> {
    case: &'a str,
    queries: &'a [Point3],
    /// Query and distance, m.
    exact: &'a [(usize, f64)],
    size_m: f64,
}

impl Suite<'_> {
    fn judge(
        &mut self,
        method: &str,
        peer: bool,
        times: Times,
        answers: &[Option<Point3>],
        asked: &Asked<'_>,
    ) {
        let verdict = Verdict::of(answers, asked.queries, asked.exact, asked.size_m);
        let (error, wrong) = ((verdict.error, "m"), Some(verdict.wrong));
        self.report(asked.case, method, peer, times, error, wrong);
    }

    fn queries(&self) -> usize {
        if self.effort == Effort::Quick {
            500
        } else {
            10_000
        }
    }

    /// Peers that take long are cut short; their `n` tells.
    fn patience(&self) -> Duration {
        Duration::from_millis(if self.effort == Effort::Quick {
            200
        } else {
            4_000
        })
    }

    fn report(
        &mut self,
        case: &str,
        method: &str,
        peer: bool,
        times: Times,
        error: (f64, &'static str),
        wrong: Option<usize>,
    ) {
        (self.out)(Row {
            peer,
            wrong,
            ..Row::new("surface", case, method)
                .timed(times)
                .off_by(error.0, error.1)
        });
    }

    fn cold(&mut self, case: &str, surface: &Surface) {
        let queries = scattered(surface, self.queries());
        let mut oracle = Oracle::new(surface);
        let mut exact: Vec<(usize, f64)> = queries
            .iter()
            .enumerate()
            .map(|(k, q)| (k, oracle.distance(surface, q)))
            .collect();
        let mut solver = ClosestSolver::new(surface);
        let mut answers = Vec::with_capacity(queries.len());
        let times = time(queries.len(), Duration::MAX, |k| {
            let (time, foot) = clocked(|| solver.closest(surface, &queries[k]));
            answers.push(Some(foot.point));
            time
        });
        sharpen(&mut exact, &answers, &queries);
        let asked = Asked {
            case,
            queries: &queries,
            exact: &exact,
            size_m: surface.size(),
        };
        self.judge("palpate", false, times, &answers, &asked);
        for mut peer in peers::all(surface) {
            let mut answers = Vec::with_capacity(queries.len());
            let patience = self.patience();
            let times = peers::quietly(|| {
                time(queries.len(), patience, |k| {
                    let (time, foot) = clocked(|| peer.closest(&queries[k], false));
                    answers.push(foot);
                    time
                })
            });
            self.judge(peer.name(), true, times, &answers, &asked);
        }
    }

    fn warm(&mut self, case: &str, surface: &Surface, moving: bool) {
        let queries = walk(surface, self.queries());
        let rest = surface.net().points().to_vec();
        let size_m = surface.size();
        let mut surface = surface.clone();
        let mut oracle = Oracle::new(&surface);
        // A moved net must be sampled anew for each exact answer: then only every tenth is checked.
        let mut exact: Vec<(usize, f64)> = (0..queries.len())
            .step_by(if moving { 10 } else { 1 })
            .map(|k| {
                if moving {
                    breathe(&rest, k, surface.net_mut().points_mut());
                    oracle.moved(&surface);
                }
                (k, oracle.distance(&surface, &queries[k]))
            })
            .collect();
        let mut solver = ClosestSolver::new(&surface);
        let (mut warm, mut last) = (WarmFoot::default(), queries[0]);
        let mut before = surface.net().points().to_vec();
        let mut answers = Vec::with_capacity(queries.len());
        let times = time(queries.len(), Duration::MAX, |k| {
            let mut moved_m = 0.0;
            if moving {
                before.copy_from_slice(surface.net().points());
                breathe(&rest, k, surface.net_mut().points_mut());
                moved_m = largest_movement(&before, surface.net().points());
            }
            let (time, foot) = clocked(|| {
                if moving {
                    solver.net_changed();
                }
                solver.closest_warm_moved(
                    &surface,
                    &queries[k],
                    (queries[k] - last).norm(),
                    moved_m,
                    &mut warm,
                )
            });
            last = queries[k];
            answers.push(Some(foot.point));
            time
        });
        sharpen(&mut exact, &answers, &queries);
        let asked = Asked {
            case,
            queries: &queries,
            exact: &exact,
            size_m,
        };
        self.judge("palpate", false, times, &answers, &asked);
        for mut peer in peers::all(&surface) {
            let mut answers = Vec::with_capacity(queries.len());
            let patience = self.patience();
            let times = peers::quietly(|| {
                time(queries.len(), patience, |k| {
                    if moving {
                        breathe(&rest, k, surface.net_mut().points_mut());
                    }
                    let (time, foot) = clocked(|| {
                        if moving {
                            peer.moved(&surface);
                        }
                        peer.closest(&queries[k], true)
                    });
                    answers.push(foot);
                    time
                })
            });
            self.judge(peer.name(), true, times, &answers, &asked);
        }
    }

    fn grid(&mut self, case: &str, surface: &Surface, count: usize, with_normals: bool) {
        let (us, vs) = (
            spread(surface.knots_u().domain(), count),
            spread(surface.knots_v().domain(), count),
        );
        let grid = SampleGrid::new(surface, &us, &vs);
        let mut samples = grid.samples();
        let n = if self.effort == Effort::Quick {
            50
        } else {
            2_000
        };
        let times = time(n, Duration::MAX, |_| {
            clocked(|| {
                if with_normals {
                    grid.evaluate_into(surface, &mut samples);
                } else {
                    grid.points_into(surface, &mut samples);
                }
            })
            .0
        });
        let error = |points: &[Point3], normals: &[Vector3]| {
            if with_normals {
                (normal_error(surface, &us, &vs, normals), "rad")
            } else {
                (point_error(surface, &us, &vs, points), "m")
            }
        };
        let normals = if with_normals {
            &samples.normals[..]
        } else {
            &[]
        };
        self.report(
            case,
            "palpate",
            false,
            times,
            error(&samples.points, normals),
            None,
        );
        for mut peer in peers::all(surface) {
            let mut points = vec![Point3::origin(); count * count];
            let mut normals = if with_normals {
                vec![Vector3::zeros(); count * count]
            } else {
                vec![]
            };
            if !peer.grid(&us, &vs, &mut points, &mut normals) {
                continue;
            }
            let times = time(n, self.patience(), |_| {
                clocked(|| peer.grid(&us, &vs, &mut points, &mut normals)).0
            });
            self.report(
                case,
                peer.name(),
                true,
                times,
                error(&points, &normals),
                None,
            );
        }
    }

    fn fit(&mut self, case: &str, surface: &Surface) {
        // No sample lies on seam or poles twice: the net is determined.
        let (us, vs) = (
            spread(surface.knots_u().domain(), 82),
            spread(surface.knots_v().domain(), 82),
        );
        let grid = SampleGrid::new(surface, &us, &vs);
        let mut samples = grid.samples();
        grid.points_into(surface, &mut samples);
        let mut fit = GridFit::new(&grid);
        let mut net: ControlNet = surface.net().clone();
        let n = if self.effort == Effort::Quick {
            20
        } else {
            1_000
        };
        let times = time(n, Duration::MAX, |_| {
            clocked(|| fit.fit_into(&samples.points, &mut net)).0
        });
        let error = largest_movement(net.points(), surface.net().points());
        self.report(case, "palpate", false, times, (error, "m"), None);
    }

    fn refresh(&mut self, case: &str, surface: &Surface) {
        let rest = surface.net().points().to_vec();
        let mut surface = surface.clone();
        let mut solver = ClosestSolver::new(&surface);
        let n = self.queries();
        let times = time(n, Duration::MAX, |k| {
            breathe(&rest, k, surface.net_mut().points_mut());
            clocked(|| {
                solver.net_changed();
                solver.pieces(&surface).len()
            })
            .0
        });
        self.report(
            case,
            "palpate",
            false,
            times,
            (outside(&surface, &mut solver), "m"),
            None,
        );
        let queries = scattered(&surface, n);
        let mut oracle = Oracle::new(&surface);
        let mut exact = Vec::new();
        let mut answers = Vec::new();
        let times = time(n, Duration::MAX, |k| {
            breathe(&rest, k, surface.net_mut().points_mut());
            let (time, foot) = clocked(|| {
                solver.net_changed();
                solver.closest(&surface, &queries[k])
            });
            answers.push(Some(foot.point));
            if k.is_multiple_of(10) {
                oracle.moved(&surface);
                exact.push((k, oracle.distance(&surface, &queries[k])));
            }
            time
        });
        sharpen(&mut exact, &answers, &queries);
        let asked = Asked {
            case,
            queries: &queries,
            exact: &exact,
            size_m: surface.size(),
        };
        self.judge("palpate, with a cold query", false, times, &answers, &asked);
        // Of the peers only the mesh has anything to refresh.
        let Some(mut peer) = peers::all(&surface).into_iter().next() else {
            return;
        };
        let mut answers = Vec::new();
        let times = time(n, self.patience(), |k| {
            breathe(&rest, k, surface.net_mut().points_mut());
            let (time, foot) = clocked(|| {
                peer.moved(&surface);
                peer.closest(&queries[k], false)
            });
            answers.push(foot);
            time
        });
        let verdict = Verdict::of(&answers, &queries, &exact, surface.size());
        let name = format!("{}, with a query", peer.name());
        self.report(
            case,
            &name,
            true,
            times,
            (verdict.error, "m"),
            Some(verdict.wrong),
        );
    }
}

/// Largest miss of a grid's points, m.
fn point_error(surface: &Surface, us: &[f64], vs: &[f64], points: &[Point3]) -> f64 {
    let pairs = us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v)));
    pairs
        .zip(points)
        .map(|((u, v), point)| (point - surface.point(u, v)).norm())
        .fold(0.0, f64::max)
}

/// Largest angle between a grid's normals and the exact ones, poles included, rad.
fn normal_error(surface: &Surface, us: &[f64], vs: &[f64], normals: &[Vector3]) -> f64 {
    let pairs = us.iter().flat_map(|&u| vs.iter().map(move |&v| (u, v)));
    let angle = |((u, v), normal): ((f64, f64), &Vector3)| {
        let exact = surface.normal(u, v);
        libm::atan2(normal.cross(&exact).norm(), normal.dot(&exact))
    };
    pairs.zip(normals).map(angle).fold(0.0, f64::max)
}

/// How far the surface reaches out of the boxes of its pieces, m.
fn outside(surface: &Surface, solver: &mut ClosestSolver) -> f64 {
    let pieces = solver.pieces(surface);
    let mut worst: f64 = 0.0;
    for piece in 0..pieces.len() {
        let ([u0, u1], [v0, v1]) = pieces.rectangle(piece);
        let bounds = pieces.bounds(piece);
        for k in 0..25 {
            let (s, t) = (f64::from(k % 5) / 4.0, f64::from(k / 5) / 4.0);
            let p = surface.point(u0 + s * (u1 - u0), v0 + t * (v1 - v0));
            for c in 0..3 {
                worst = worst.max(p[c] - bounds.max[c]).max(bounds.min[c] - p[c]);
            }
        }
    }
    worst
}
