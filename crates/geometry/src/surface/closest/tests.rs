//! Facts about the closest point, against a dense sampling polished by its own damped Gauss–Newton,
//! and closed forms.

use super::super::bezier::shares;
use super::super::{BezierPieces, ClosestSolver, ControlNet, Surface, WarmFoot};
use crate::basis::{KnotVector, Side};
pub(super) use crate::math::Random;
use crate::math::{Point3, Vector3};

fn read(text: &str) -> Surface {
    let file: serde_json::Value = serde_json::from_str(text).unwrap();
    let floats = |v: &serde_json::Value| -> Vec<f64> {
        v.as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect()
    };
    let degree = |k: usize| file["degree"][k].as_u64().unwrap() as usize;
    let rows = file["points"].as_array().unwrap();
    let points: Vec<Point3> = rows
        .iter()
        .flat_map(|row| row.as_array().unwrap())
        .map(|p| Point3::from_slice(&floats(p)) * 1e-3)
        .collect();
    let columns = points.len() / rows.len();
    let weights = file["weights"]
        .as_array()
        .map(|rows| rows.iter().flat_map(&floats).collect::<Vec<f64>>());
    Surface::new(
        KnotVector::new(degree(0), floats(&file["knots"][0])).unwrap(),
        KnotVector::new(degree(1), floats(&file["knots"][1])).unwrap(),
        ControlNet::new(rows.len(), columns, points).unwrap(),
        weights,
    )
    .unwrap()
}

pub(super) fn teardrop(count: usize) -> Surface {
    read(match count {
        8 => include_str!("../data/teardrop_8.json"),
        12 => include_str!("../data/teardrop_12.json"),
        _ => include_str!("../data/teardrop_20.json"),
    })
}

pub(super) fn size(surface: &Surface) -> f64 {
    let (mut low, mut high) = (surface.net().points()[0], surface.net().points()[0]);
    for p in surface.net().points() {
        (low, high) = (low.inf(p), high.sup(p));
    }
    (high - low).norm()
}

/// Samples of every span rectangle, ends included, to find basins with; and the rectangles, to
/// polish in.
struct Brute {
    cells: usize,
    boxes: Vec<[f64; 4]>,
    points: Vec<Point3>,
}

fn side(x: f64, end: f64) -> Side {
    if x >= end { Side::Left } else { Side::Right }
}

impl Brute {
    fn new(surface: &Surface, cells: usize) -> Self {
        let spans = |k: &KnotVector| -> Vec<(f64, f64)> {
            k.spans()
                .map(|i| (k.knots()[i], k.knots()[i + 1]))
                .collect()
        };
        let mut new = Self {
            cells,
            boxes: vec![],
            points: vec![],
        };
        for (u0, u1) in spans(surface.knots_u()) {
            for (v0, v1) in spans(surface.knots_v()) {
                new.boxes.push([u0, u1, v0, v1]);
                for a in 0..=cells {
                    for b in 0..=cells {
                        let at = |x0: f64, x1: f64, k: usize| {
                            if k == cells {
                                x1
                            } else {
                                x0 + (x1 - x0) * k as f64 / cells as f64
                            }
                        };
                        let (u, v) = (at(u0, u1, a), at(v0, v1, b));
                        new.points
                            .push(surface.frame_from(u, v, side(u, u1), side(v, v1)).point);
                    }
                }
            }
        }
        new
    }

    /// Least distance: every sample that beats its neighbours is polished, the best `most` of them.
    fn distance(&self, surface: &Surface, q: &Point3, most: usize) -> f64 {
        let n = self.cells + 1;
        let values: Vec<f64> = self.points.iter().map(|p| (p - q).norm_squared()).collect();
        let mut starts: Vec<(f64, usize)> = vec![];
        for (k, block) in values.chunks(n * n).enumerate() {
            for a in 0..n {
                for b in 0..n {
                    let value = block[a * n + b];
                    let lower = (a.saturating_sub(1)..(a + 2).min(n))
                        .flat_map(|x| (b.saturating_sub(1)..(b + 2).min(n)).map(move |y| x * n + y))
                        .all(|x| block[x] >= value);
                    if lower {
                        starts.push((value, k * n * n + a * n + b));
                    }
                }
            }
        }
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        starts
            .iter()
            .take(most)
            .map(|(_, k)| self.polish(surface, q, *k))
            .fold(f64::INFINITY, f64::min)
    }

    fn polish(&self, surface: &Surface, q: &Point3, sample: usize) -> f64 {
        let n = self.cells + 1;
        let [u0, u1, v0, v1] = self.boxes[sample / (n * n)];
        let (a, b) = ((sample / n) % n, sample % n);
        let mut u = u0 + (u1 - u0) * a as f64 / self.cells as f64;
        let mut v = v0 + (v1 - v0) * b as f64 / self.cells as f64;
        let look = |u: f64, v: f64| surface.frame_from(u, v, side(u, u1), side(v, v1));
        let mut frame = look(u, v);
        let mut value = (frame.point - q).norm_squared();
        let mut damping = 1e-3;
        for _ in 0..300 {
            let r = frame.point - q;
            let (gu, gv) = (r.dot(&frame.du), r.dot(&frame.dv));
            let (e, f, g) = (
                frame.du.norm_squared(),
                frame.du.dot(&frame.dv),
                frame.dv.norm_squared(),
            );
            // Full second derivatives when they are positive, first derivatives only otherwise.
            let (fe, ff, fg) = (
                e + r.dot(&frame.duu),
                f + r.dot(&frame.duv),
                g + r.dot(&frame.dvv),
            );
            let (e, f, g) = if fe > 0.0 && fe * fg > ff * ff {
                (fe, ff, fg)
            } else {
                (e, f, g)
            };
            let hold_u = (u <= u0 && gu > 0.0) || (u >= u1 && gu < 0.0);
            let hold_v = (v <= v0 && gv > 0.0) || (v >= v1 && gv < 0.0);
            let (e, g, f) = (
                e * (1.0 + damping) + 1e-300,
                g * (1.0 + damping) + 1e-300,
                f,
            );
            let (du, dv) = match (hold_u, hold_v) {
                (true, true) => break,
                (true, false) => (0.0, -gv / g),
                (false, true) => (-gu / e, 0.0),
                _ => (
                    (f * gv - g * gu) / (e * g - f * f),
                    (f * gu - e * gv) / (e * g - f * f),
                ),
            };
            let (x, y) = ((u + du).clamp(u0, u1), (v + dv).clamp(v0, v1));
            let next = look(x, y);
            let better = (next.point - q).norm_squared();
            if better < value {
                (u, v, frame, value) = (x, y, next, better);
                damping = (damping * 0.1).max(1e-16);
            } else {
                damping *= 10.0;
                if damping > 1e12 {
                    break;
                }
            }
        }
        value.sqrt()
    }
}

/// Near, far, inside, on the surface, along the axis, at poles and corners.
pub(super) fn query(surface: &Surface, random: &mut Random, k: usize) -> Point3 {
    let size = size(surface);
    let ((u0, u1), (v0, v1)) = (surface.knots_u().domain(), surface.knots_v().domain());
    let u = random.float(u0, u1);
    let v = random.float(v0, v1);
    let frame = surface.frame(u, v);
    let normal = frame
        .du
        .cross(&frame.dv)
        .try_normalize(0.0)
        .unwrap_or_else(Vector3::z);
    let net = surface.net().points();
    let centre = Point3::from(net.iter().map(|p| p.coords).sum::<Vector3>() / net.len() as f64);
    match k % 8 {
        0 => frame.point + normal * random.float(-1e-2, 1e-2) * size,
        1 => frame.point + normal * random.float(-0.3, 0.3) * size,
        2 => centre + random.vector() * size * 0.6,
        3 => centre + random.vector() * size * [2.0, 10.0, 50.0][random.below(3)],
        4 => frame.point,
        5 => {
            // The middle of an iso-line: the axis of a body of revolution.
            let n = 16;
            let sum: Vector3 = (0..n)
                .map(|k| {
                    surface
                        .point(u0 + (u1 - u0) * k as f64 / n as f64, v)
                        .coords
                })
                .sum();
            Point3::from(sum / n as f64)
        }
        6 => {
            let corner = surface.point(
                if random.below(2) == 0 { u0 } else { u1 },
                if random.below(2) == 0 { v0 } else { v1 },
            );
            corner + random.vector() * size * [0.0, 1e-6, 1e-2, 0.2][random.below(4)]
        }
        _ => net[random.below(net.len())],
    }
}

fn check(surface: &Surface, seed: u64, queries: usize, cells: usize, name: &str) -> usize {
    let mut solver = ClosestSolver::new(surface);
    let brute = Brute::new(surface, cells);
    let mut random = Random(seed);
    let (size, mut most) = (size(surface), 0);
    for k in 0..queries {
        let q = query(surface, &mut random, k);
        let answer = solver.closest(surface, &q);
        most = most.max(solver.parts_visited());
        let reference = brute.distance(surface, &q, 12);
        // Far away, the rounding of the coordinates themselves.
        let tolerance = 1e-9 * size + 4e-16 * q.coords.amax();
        assert!(
            answer.distance <= reference + tolerance,
            "{name}, query {k} {q:?}: {} is farther than {reference} by {:e} of the size",
            answer.distance,
            (answer.distance - reference) / size
        );
        assert!(
            (surface.point(answer.u, answer.v) - answer.point).norm() <= 1e-12 * size,
            "{name}, query {k}"
        );
        assert!(
            (answer.normal.norm() - 1.0).abs() < 1e-12,
            "{name}, query {k}: {:?}",
            answer.normal
        );
        assert_eq!(answer.distance, (q - answer.point).norm());
        assert_eq!(answer.signed_distance.abs(), answer.distance);
    }
    most
}

const MANY: usize = if cfg!(debug_assertions) { 400 } else { 10_000 };

#[test]
fn no_query_of_the_teardrops_is_answered_worse_than_by_sampling() {
    for (count, cells) in [(8, 14), (12, 9), (20, 5)] {
        let most = check(&teardrop(count), count as u64, MANY, cells, "teardrop");
        println!("teardrop {count}: most parts in a search {most}");
    }
    let rational = read(include_str!("../data/teardrop_8_rational.json"));
    let most = check(&rational, 7, MANY / 2, 14, "rational teardrop");
    println!("rational teardrop: most parts in a search {most}");
}

fn random_knots(random: &mut Random) -> KnotVector {
    let degree = 1 + random.below(7);
    let count = degree + 1 + random.below(6);
    match random.below(4) {
        0 => {
            let mut t = 0.0;
            let knots: Vec<f64> = (0..=count)
                .map(|_| {
                    t += random.float(0.3, 1.0);
                    t
                })
                .collect();
            KnotVector::periodic(degree, knots).unwrap()
        }
        1 => {
            let mut t = 0.0;
            let knots: Vec<f64> = (0..count + degree + 1)
                .map(|_| {
                    t += random.float(0.3, 1.0);
                    t
                })
                .collect();
            KnotVector::new(degree, knots).unwrap()
        }
        _ => {
            // Clamped, interior knots repeated at random up to degree + 1 times: creases and tears.
            let mut knots = vec![0.0; degree + 1];
            let mut t = 0.0;
            while knots.len() < count {
                t += random.float(0.3, 1.0);
                let left = count - knots.len();
                let times = if random.below(2) == 0 {
                    1
                } else {
                    1 + random.below(degree + 1)
                };
                knots.extend(std::iter::repeat_n(t, times.min(left)));
            }
            t += 0.7;
            knots.extend(std::iter::repeat_n(t, degree + 1));
            KnotVector::new(degree, knots).unwrap()
        }
    }
}

pub(super) fn random_surface(random: &mut Random) -> Surface {
    let (u, v) = (random_knots(random), random_knots(random));
    let (rows, columns) = (u.count(), v.count());
    let rough = random.float(0.05, 0.6);
    let points = (0..rows * columns)
        .map(|k| {
            let (i, j) = (k / columns, k % columns);
            let flat = Point3::new(i as f64 / rows as f64, j as f64 / columns as f64, 0.0);
            flat + random.vector() * rough
        })
        .collect();
    let weights = (random.below(3) == 0).then(|| {
        (0..rows * columns)
            .map(|_| random.float(0.3, 3.0))
            .collect()
    });
    Surface::new(
        u,
        v,
        ControlNet::new(rows, columns, points).unwrap(),
        weights,
    )
    .unwrap()
}

#[test]
fn no_query_of_random_surfaces_is_answered_worse_than_by_sampling() {
    let mut random = Random(2);
    let surfaces = if cfg!(debug_assertions) { 40 } else { 300 };
    let mut most = 0;
    for k in 0..surfaces {
        let surface = random_surface(&mut random);
        let name = format!(
            "random surface {k}, degrees {} {}",
            surface.knots_u().degree(),
            surface.knots_v().degree()
        );
        most = most.max(check(
            &surface,
            1000 + k,
            if cfg!(debug_assertions) { 16 } else { 80 },
            12,
            &name,
        ));
    }
    println!("random surfaces: most parts in a search {most}");
}

#[test]
fn pieces_are_the_surface() {
    let mut random = Random(3);
    for _ in 0..60 {
        let surface = random_surface(&mut random);
        let pieces = BezierPieces::new(&surface);
        for k in 0..pieces.len() {
            let ([u0, u1], [v0, v1]) = pieces.rectangle(k);
            let bounds = pieces.bounds(k);
            for _ in 0..4 {
                let (s, t) = (random.unit(), random.unit());
                let (u, v) = (u0 + s * (u1 - u0), v0 + t * (v1 - v0));
                let (s, t) = ((u - u0) / (u1 - u0), (v - v0) / (v1 - v0));
                let expected = surface.frame_from(u, v, side(u, u1), side(v, v1));
                let columns = pieces.v.spans.len();
                let given = pieces.frame(k / columns, k % columns, s, t);
                // Derivatives grow with degree over span; 1e-10 of their scale is the kernel's own
                // bar.
                assert!(
                    (given.point - expected.point).norm() < 1e-12,
                    "{:?} {:?}",
                    given.point,
                    expected.point
                );
                for (a, b) in [
                    (given.du, expected.du),
                    (given.dv, expected.dv),
                    (given.duu, expected.duu),
                    (given.duv, expected.duv),
                    (given.dvv, expected.dvv),
                ] {
                    assert!((a - b).norm() < 1e-10 * (1.0 + b.norm()), "{a:?} {b:?}");
                }
                let p = given.point;
                for c in 0..3 {
                    assert!(bounds.min[c] - 1e-12 <= p[c] && p[c] <= bounds.max[c] + 1e-12);
                }
            }
        }
    }
}

#[test]
fn one_piece_refreshed_alone_has_the_bits_of_a_full_refresh() {
    let mut random = Random(4);
    for _ in 0..20 {
        let mut surface = random_surface(&mut random);
        let (mut alone, mut all) = (BezierPieces::new(&surface), BezierPieces::new(&surface));
        for p in surface.net_mut().points_mut() {
            *p += random.vector() * 0.1;
        }
        alone.net_changed();
        all.refresh(&surface);
        for i in 0..alone.u.spans.len() {
            for j in 0..alone.v.spans.len() {
                alone.refresh_piece(&surface, i, j);
                let piece = i * alone.v.spans.len() + j;
                assert_eq!(alone.points(piece), all.points(piece));
            }
        }
    }
}

/// Walks between random targets around and inside the body, at several speeds, and compares every
/// answer with a cold one.
fn walk(mut surface: Surface, seed: u64, deform: bool, steps: usize, name: &str) -> usize {
    let size = size(&surface);
    let mut random = Random(seed);
    let (mut warm_solver, mut cold_solver) =
        (ClosestSolver::new(&surface), ClosestSolver::new(&surface));
    let mut warm = WarmFoot::default();
    let net = surface.net().points();
    let centre = Point3::from(net.iter().map(|p| p.coords).sum::<Vector3>() / net.len() as f64);
    let (mut q, mut target, mut speed) = (centre, centre, 1.0);
    let mut searches = 0;
    for k in 0..steps {
        if (target - q).norm() <= speed || k % 300 == 0 {
            target = centre + random.vector() * 0.5 * size;
            speed = [2e-4, 1e-3, 1e-2][random.below(3)] * size;
        }
        let step = (target - q).try_normalize(0.0).unwrap_or_else(Vector3::x) * speed;
        q += step;
        let mut net_moved = 0.0;
        if deform {
            let amount = 2e-5 * size * (1 + k % 5) as f64;
            for p in surface.net_mut().points_mut() {
                let d = random.vector() * amount;
                *p += d;
                net_moved = f64::max(net_moved, d.norm());
            }
            warm_solver.net_changed();
            cold_solver.net_changed();
        }
        let before = warm;
        let answer =
            warm_solver.closest_warm_moved(&surface, &q, step.norm(), net_moved, &mut warm);
        searches += usize::from(warm.budget_m >= before.budget_m);
        let reference = cold_solver.closest(&surface, &q);
        assert!(
            (answer.distance - reference.distance).abs() <= 1e-9 * size,
            "{name}, step {k}: warm {} cold {} (budget {} after {})",
            answer.distance,
            reference.distance,
            warm.budget_m,
            before.budget_m
        );
    }
    searches
}

#[test]
fn warm_answers_are_the_cold_answers_on_random_walks() {
    let steps = if cfg!(debug_assertions) { 600 } else { 20_000 };
    for (count, deform) in [(8, false), (8, true), (12, true), (20, false)] {
        let searches = walk(
            teardrop(count),
            50 + count as u64,
            deform,
            steps,
            "teardrop",
        );
        println!("teardrop {count}, deforming {deform}: {searches} searches in {steps} steps");
        assert!(searches < steps * 9 / 10, "the certificate never helps");
    }
    let rational = read(include_str!("../data/teardrop_8_rational.json"));
    let searches = walk(rational, 57, true, steps, "rational teardrop");
    println!("rational teardrop, deforming: {searches} searches in {steps} steps");
    let mut random = Random(58);
    for k in 0..if cfg!(debug_assertions) { 10 } else { 60 } {
        let surface = random_surface(&mut random);
        walk(
            surface,
            500 + k,
            k % 2 == 0,
            400,
            &format!("random surface {k}"),
        );
    }
}

#[test]
fn points_of_a_piece_on_a_grid_are_those_of_its_frames() {
    let rational = read(include_str!("../data/teardrop_8_rational.json"));
    let mut random = Random(61);
    let others = [teardrop(8), rational, random_surface(&mut random)];
    for surface in others {
        let pieces = BezierPieces::new(&surface);
        let at = [[0.1, 0.5, 0.8], [0.0, 0.25, 1.0]];
        let (p, q) = (pieces.u.degree, pieces.v.degree);
        let (us, vs) = (at[0].map(|t| shares(p, t)), at[1].map(|t| shares(q, t)));
        for piece in 0..pieces.len() {
            let columns = pieces.v.spans.len();
            pieces.points_at(piece, [&us, &vs], |k, point| {
                let (s, t) = (at[0][k / 3], at[1][k % 3]);
                let frame = pieces.frame(piece / columns, piece % columns, s, t);
                assert_eq!(point, frame.point, "piece {piece} at {s}, {t}");
            });
        }
    }
}

#[test]
fn local_descent_from_a_foot_nearby_finds_that_foot() {
    let surface = teardrop(12);
    let mut solver = ClosestSolver::new(&surface);
    let mut random = Random(60);
    for k in 0..500 {
        let (u, v) = (random.float(0.02, 0.98), random.float(0.05, 0.95));
        let frame = surface.frame(u, v);
        let normal = frame.du.cross(&frame.dv).normalize();
        let q = frame.point + normal * random.float(-2e-3, 5e-3);
        let cold = solver.closest(&surface, &q);
        let local = solver.local(
            &surface,
            &q,
            u + random.float(-0.02, 0.02),
            v + random.float(-0.02, 0.02),
        );
        let local = local.unwrap_or_else(|| panic!("query {k} did not settle"));
        assert!(
            (local.distance - cold.distance).abs() < 1e-12,
            "query {k}: {} {}",
            local.distance,
            cold.distance
        );
    }
}

#[test]
fn local_descent_crosses_the_seam_and_leaves_the_pole() {
    let surface = teardrop(8);
    let mut solver = ClosestSolver::new(&surface);
    for (u, v, u0, v0) in [
        (0.98, 0.5, 0.01, 0.5),
        (0.03, 0.6, 1.0, 0.6),
        (0.4, 0.06, 0.9, 0.0),
        (0.7, 0.95, 0.1, 1.0),
    ] {
        let frame = surface.frame(u, v);
        let q = frame.point + frame.du.cross(&frame.dv).normalize() * 1e-3;
        let cold = solver.closest(&surface, &q);
        let local = solver.local(&surface, &q, u0, v0).expect("settles");
        assert!(
            (local.distance - cold.distance).abs() < 1e-12,
            "{u} {v}: {} {}",
            local.distance,
            cold.distance
        );
    }
}

// There a tangent is as short as its rounding, and the product of both points anywhere.
#[test]
fn normals_beside_a_pole_are_that_of_the_pole() {
    let mut surface = super::super::builtin("sphere", None, Some(0.05)).unwrap();
    for p in surface.net_mut().points_mut() {
        *p += Vector3::new(0.3, 0.2, -0.1);
    }
    let mut solver = ClosestSolver::new(&surface);
    let mut random = Random(44);
    for v in [0.0, 1.0] {
        let pole = surface.point(0.0, v);
        let axis = (pole - Point3::new(0.3, 0.2, -0.1)).normalize();
        for k in 0..200 {
            let aside = random.vector() * libm::pow(10.0, -8.0 - 10.0 * random.unit());
            let query = pole + axis * 1e-3 + aside.cross(&axis);
            let foot = solver.closest(&surface, &query);
            let off = (foot.normal - axis).norm();
            assert!(
                off < 1e-6,
                "{k}: the normal is off by {off} at v {}",
                foot.v
            );
        }
    }
}

#[test]
fn support_points_are_the_farthest_of_a_sampling() {
    let mut random = Random(70);
    let mut surfaces: Vec<Surface> = (0..if cfg!(debug_assertions) { 20 } else { 100 })
        .map(|_| random_surface(&mut random))
        .collect();
    surfaces.extend([8, 12, 20].map(teardrop));
    for (k, surface) in surfaces.iter().enumerate() {
        let mut solver = ClosestSolver::new(surface);
        let brute = Brute::new(surface, 12);
        for _ in 0..20 {
            let d = random.vector().normalize();
            let (u, v, point) = solver.deepest_along(surface, &d);
            assert!(
                (surface.point(u, v) - point).norm() <= 1e-12 * size(surface),
                "surface {k}"
            );
            let height = d.dot(&point.coords);
            let sampled = brute
                .points
                .iter()
                .map(|p| d.dot(&p.coords))
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(
                height >= sampled - 1e-12 * size(surface),
                "surface {k}, {d:?}: {height} below {sampled}"
            );
            // A sample plane far out has its closest point there: two ways to the same height.
            let far = point + d * 1e5 * size(surface);
            let closest = solver.closest(surface, &far);
            assert!(
                d.dot(&closest.point.coords) <= height + 1e-9 * size(surface),
                "surface {k}"
            );
        }
    }
}

/// A quarter circle of radius 1 as a rational quadratic, and its neighbours, make a whole one with
/// creases in the basis only.
fn circle() -> (KnotVector, Vec<(f64, f64, f64)>) {
    let r = 0.5_f64.sqrt();
    let points = [
        (1.0, 0.0),
        (1.0, 1.0),
        (0.0, 1.0),
        (-1.0, 1.0),
        (-1.0, 0.0),
        (-1.0, -1.0),
        (0.0, -1.0),
        (1.0, -1.0),
        (1.0, 0.0),
    ];
    let points = points
        .iter()
        .enumerate()
        .map(|(k, &(x, y))| (x, y, if k % 2 == 0 { 1.0 } else { r }))
        .collect();
    let knots = KnotVector::new(
        2,
        vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0],
    )
    .unwrap();
    (knots, points)
}

pub(super) fn sphere(radius: f64) -> Surface {
    let (u, ring) = circle();
    // Half a circle from the south pole to the north.
    let half = &ring[..5];
    let v = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]).unwrap();
    let (mut points, mut weights) = (vec![], vec![]);
    for &(x, y, w) in &ring {
        for &(c, s, h) in half {
            points.push(Point3::new(x * s, y * s, -c) * radius);
            weights.push(w * h);
        }
    }
    Surface::new(u, v, ControlNet::new(9, 5, points).unwrap(), Some(weights)).unwrap()
}

pub(super) fn cylinder(radius: f64, height: f64) -> Surface {
    let (u, ring) = circle();
    let v = KnotVector::clamped_uniform(1, 2).unwrap();
    let (mut points, mut weights) = (vec![], vec![]);
    for &(x, y, w) in &ring {
        for z in [0.0, height] {
            points.push(Point3::new(x * radius, y * radius, z));
            weights.push(w);
        }
    }
    Surface::new(u, v, ControlNet::new(9, 2, points).unwrap(), Some(weights)).unwrap()
}

#[test]
fn a_sphere_has_the_signed_distance_of_a_sphere() {
    let surface = sphere(0.05);
    let mut solver = ClosestSolver::new(&surface);
    let mut random = Random(80);
    for k in 0..400 {
        let q = Point3::from(random.vector() * 0.1);
        // Poles, seam, creases of the basis and the centre too.
        let q = match k % 8 {
            0 => Point3::new(0.0, 0.0, q.z),
            1 => Point3::new(q.x.abs(), 0.0, q.z),
            2 => Point3::new(0.0, q.y, 0.0),
            _ => q,
        };
        let answer = solver.closest(&surface, &q);
        let expected = q.coords.norm() - 0.05;
        assert!(
            (answer.signed_distance - expected).abs() < 1e-13,
            "{q:?}: {} {expected}",
            answer.signed_distance
        );
        let normal = answer.point.coords / 0.05;
        assert!(
            (answer.normal - normal).norm() < 1e-6,
            "{q:?}: {:?} {normal:?}",
            answer.normal
        );
    }
    let centre = solver.closest(&surface, &Point3::origin());
    assert!((centre.signed_distance + 0.05).abs() < 1e-13, "{centre:?}");
    println!("sphere centre: {} parts", solver.parts_visited());
}

#[test]
fn a_cylinder_and_its_open_rims_have_their_closed_form() {
    let surface = cylinder(0.02, 0.1);
    let mut solver = ClosestSolver::new(&surface);
    let mut random = Random(90);
    for k in 0..400 {
        let mut q = Point3::from(random.vector() * 0.08) + Vector3::new(0.0, 0.0, 0.05);
        if k % 10 == 0 {
            (q.x, q.y) = (0.0, 0.0);
        }
        let answer = solver.closest(&surface, &q);
        let radial = q.x.hypot(q.y) - 0.02;
        let beyond = (q.z - q.z.clamp(0.0, 0.1)).abs();
        let expected = radial.hypot(beyond);
        assert!(
            (answer.distance - expected).abs() < 1e-13,
            "{q:?}: {} {expected}",
            answer.distance
        );
        assert_eq!(answer.signed_distance < 0.0, radial < 0.0, "{q:?}");
    }
}

#[test]
fn a_flat_sheet_has_the_distance_of_a_rectangle() {
    for degree in 1..=5 {
        let knots = KnotVector::clamped_uniform(degree, degree + 3).unwrap();
        let g = knots.greville();
        let points = g
            .iter()
            .flat_map(|x| g.iter().map(move |y| Point3::new(*x, 2.0 * y, 0.0)))
            .collect();
        let surface = Surface::new(
            knots.clone(),
            knots.clone(),
            ControlNet::new(g.len(), g.len(), points).unwrap(),
            None,
        )
        .unwrap();
        let mut solver = ClosestSolver::new(&surface);
        let mut random = Random(100);
        for _ in 0..200 {
            let q = Point3::from(random.vector() * 3.0);
            let foot = Point3::new(q.x.clamp(0.0, 1.0), q.y.clamp(0.0, 2.0), 0.0);
            let answer = solver.closest(&surface, &q);
            assert!(
                (answer.point - foot).norm() < 1e-12,
                "degree {degree} {q:?}: {:?}",
                answer.point
            );
            assert_eq!(answer.signed_distance < 0.0, q.z < 0.0, "{q:?}");
            assert!((answer.normal - Vector3::z()).norm() < 1e-12);
        }
    }
}

// On z = x² the point 1/2 above the vertex is its centre of curvature: the squared distance is x⁴ +
// 1/4, its second derivative is zero at the answer, and each Newton step removes only a third of
// the error.
#[test]
fn closest_point_at_a_centre_of_curvature_still_arrives() {
    let u = KnotVector::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).unwrap();
    let v = KnotVector::clamped_uniform(1, 2).unwrap();
    let points = [(-1.0, 1.0), (0.1, -1.2), (1.2, 1.44)]
        .iter()
        .flat_map(|&(x, z)| [0.0, 1.0].map(|y| Point3::new(x, y, z)))
        .collect();
    let surface = Surface::new(u, v, ControlNet::new(3, 2, points).unwrap(), None).unwrap();
    let answer = ClosestSolver::new(&surface).closest(&surface, &Point3::new(0.0, 0.5, 0.5));
    assert!((answer.distance - 0.5).abs() < 1e-12, "{answer:?}");
}

#[test]
fn inside_is_negative_everywhere_around_a_teardrop() {
    // Oracle: the solid angle of a fine triangulation, ±4π or 0; far from the facets it cannot be
    // wrong.
    for count in [8, 20] {
        let surface = teardrop(count);
        let mut solver = ClosestSolver::new(&surface);
        let n = 60;
        let grid: Vec<Point3> = (0..=n)
            .flat_map(|i| (0..=n).map(move |j| (i as f64 / n as f64, j as f64 / n as f64)))
            .map(|(u, v)| surface.point(u, v))
            .collect();
        let angle = |q: &Point3| -> f64 {
            let mut sum = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                        .map(|(i, j)| grid[i * (n + 1) + j] - q);
                    for [a, b, c] in [[a, b, c], [a, c, d]] {
                        // Van Oosterom & Strackee, 1983.
                        let (x, y, z) = (a.norm(), b.norm(), c.norm());
                        sum += 2.0
                            * a.dot(&b.cross(&c))
                                .atan2(x * y * z + a.dot(&b) * z + a.dot(&c) * y + b.dot(&c) * x);
                    }
                }
            }
            sum
        };
        let mut random = Random(110);
        for k in 0..if cfg!(debug_assertions) { 150 } else { 1500 } {
            let q = query(&surface, &mut random, k);
            let answer = solver.closest(&surface, &q);
            if answer.distance < 1e-3 {
                continue;
            }
            let inside = angle(&q).abs() > std::f64::consts::PI * 2.0;
            assert_eq!(
                answer.signed_distance < 0.0,
                inside,
                "teardrop {count}, query {k} {q:?}: {answer:?}"
            );
        }
        // Beyond the poles, on the axis.
        for v in [0.0, 1.0] {
            let (pole, inner) = (
                surface.point(0.0, v),
                surface.point(0.0, v + if v == 0.0 { 0.2 } else { -0.2 }),
            );
            let middle = nalgebra::center(
                &inner,
                &surface.point(0.5, v + if v == 0.0 { 0.2 } else { -0.2 }),
            );
            let out = (pole - middle).normalize();
            assert!(
                solver
                    .closest(&surface, &(pole + out * 1e-3))
                    .signed_distance
                    > 0.0
            );
            assert!(
                solver
                    .closest(&surface, &(pole - out * 1e-3))
                    .signed_distance
                    < 0.0
            );
        }
    }
}

#[test]
fn a_query_that_is_not_finite_gets_a_finite_normal_and_no_hang() {
    let surface = teardrop(8);
    let mut solver = ClosestSolver::new(&surface);
    for x in [f64::NAN, f64::INFINITY, 1e200] {
        let q = Point3::new(x, 0.0, 0.0);
        let answer = solver.closest(&surface, &q);
        assert!(
            answer.normal.iter().all(|x| x.is_finite()) && answer.distance > 1e3,
            "{answer:?}"
        );
        let mut warm = WarmFoot::default();
        solver.closest_warm(&surface, &q, 0.0, &mut warm);
        solver.closest_warm(&surface, &q, f64::NAN, &mut warm);
    }
}

#[test]
fn scale_does_not_matter() {
    for scale in [1e-5, 1e4] {
        let mut surface = teardrop(8);
        for p in surface.net_mut().points_mut() {
            *p *= scale;
        }
        check(&surface, 120, 160, 14, "scaled teardrop");
    }
}

/// A roof over x in [-1, 1] with its ridge at height `ridge` along y: degree 2 in u with a full
/// interior knot, or torn by `gap` at an interior knot of multiplicity 3.
fn roof(ridge: f64, gap: f64) -> Surface {
    let v = KnotVector::clamped_uniform(1, 2).unwrap();
    let (u, xs) = if gap == 0.0 {
        let u = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 0.5, 1.0, 1.0, 1.0]).unwrap();
        (u, vec![-1.0, -0.5, 0.0, 0.5, 1.0])
    } else {
        let u = KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0]).unwrap();
        (u, vec![-1.0, -0.5, -gap, gap, 0.5, 1.0])
    };
    let points: Vec<Point3> = xs
        .iter()
        .flat_map(|&x: &f64| [0.0, 1.0].map(|y| Point3::new(x, y, ridge * (1.0 - x.abs()))))
        .collect();
    Surface::new(u, v, ControlNet::new(xs.len(), 2, points).unwrap(), None).unwrap()
}

#[test]
fn above_a_ridge_is_outside_and_its_normal_is_the_mean() {
    let surface = roof(1.0, 0.0);
    let mut solver = ClosestSolver::new(&surface);
    for x in [-0.2, 0.0, 0.1] {
        let q = Point3::new(x, 0.5, 1.6);
        let answer = solver.closest(&surface, &q);
        assert!(
            (answer.point - Point3::new(0.0, 0.5, 1.0)).norm() < 1e-12,
            "{answer:?}"
        );
        assert!(
            (answer.normal - Vector3::z()).norm() < 1e-12 && answer.signed_distance > 0.0,
            "{answer:?}"
        );
        let local = solver.local(&surface, &q, 0.2, 0.4).expect("settles");
        assert!(
            (local.distance - answer.distance).abs() < 1e-12,
            "{local:?}"
        );
    }
    // A valley seen from below its ridge line: outside the roof is above it, so this is inside.
    let valley = roof(-1.0, 0.0);
    let answer = ClosestSolver::new(&valley).closest(&valley, &Point3::new(0.0, 0.5, -1.6));
    assert!(
        answer.signed_distance < 0.0 && (answer.distance - 0.6).abs() < 1e-12,
        "{answer:?}"
    );
}

#[test]
fn both_lips_of_a_tear_are_found_and_evaluate_where_they_were_found() {
    let surface = roof(1.0, 0.1);
    let mut solver = ClosestSolver::new(&surface);
    for x in [-0.08, -0.01, 0.01, 0.08] {
        let answer = solver.closest(&surface, &Point3::new(x, 0.5, 2.0));
        let lip = Point3::new(0.1_f64.copysign(x), 0.5, 0.9);
        assert!((answer.point - lip).norm() < 1e-12, "{answer:?}");
        assert!(
            (surface.point(answer.u, answer.v) - lip).norm() < 1e-12,
            "{answer:?}"
        );
    }
}

#[test]
fn coincident_control_points_do_no_harm() {
    let mut surface = teardrop(8);
    let columns = surface.net().columns();
    let points = surface.net_mut().points_mut();
    for row in 2..5 {
        points[row * columns + 4] = points[3 * columns + 4];
        points[row * columns + 5] = points[3 * columns + 4];
    }
    check(&surface, 130, 200, 14, "teardrop with a cusp");
    // All of them: the surface is a point.
    let only = Point3::new(0.1, 0.2, 0.3);
    points_at(&mut surface, only);
    let mut solver = ClosestSolver::new(&surface);
    let answer = solver.closest(&surface, &Point3::origin());
    assert!(
        (answer.distance - only.coords.norm()).abs() < 1e-15,
        "{answer:?}"
    );
    assert!(answer.normal.iter().all(|x| x.is_finite()));
}

fn points_at(surface: &mut Surface, point: Point3) {
    surface.net_mut().points_mut().fill(point);
}

#[test]
fn two_sheets_closer_than_a_micrometre_are_told_apart() {
    // A strip folded onto itself: the query's foot must be on the right leaf.
    let u = KnotVector::clamped_uniform(3, 8).unwrap();
    let v = KnotVector::clamped_uniform(1, 2).unwrap();
    let gap = 1e-6;
    let line = [
        (0.0, 0.0),
        (0.3, 0.0),
        (0.6, 0.0),
        (1.0, 0.0),
        (1.0, gap),
        (0.6, gap),
        (0.3, gap),
        (0.0, gap),
    ];
    let points = line
        .iter()
        .flat_map(|&(x, z)| [0.0, 1.0].map(|y| Point3::new(x, y, z)))
        .collect();
    let surface = Surface::new(u, v, ControlNet::new(8, 2, points).unwrap(), None).unwrap();
    let mut solver = ClosestSolver::new(&surface);
    for (z, leaf) in [
        (-1e-3, 0.0),
        (0.4 * gap, 0.0),
        (0.6 * gap, gap),
        (1e-3, gap),
    ] {
        let answer = solver.closest(&surface, &Point3::new(0.2, 0.5, z));
        assert!(
            (answer.distance - (z - leaf).abs()).abs() < 1e-12,
            "{z}: {answer:?}"
        );
    }
}

// Boxes of an earlier net only sort out what is far: the answer has the same bits as from boxes of
// the present one, so a replay that starts in the middle answers alike.
#[test]
fn answers_do_not_depend_on_how_old_the_boxes_are() {
    let mut random = Random(91);
    let rational = read(include_str!("../data/teardrop_8_rational.json"));
    let mut surfaces = vec![teardrop(8), teardrop(20), rational];
    surfaces.extend((0..12).map(|_| random_surface(&mut random)));
    for (k, mut surface) in surfaces.into_iter().enumerate() {
        let size = size(&surface);
        let first = ClosestSolver::new(&surface);
        let (mut solver, mut warm, mut last) =
            (first.clone(), WarmFoot::default(), Point3::origin());
        for tick in 0..60 {
            // Mostly little, sometimes so much that all boxes are computed anew.
            let most = if tick % 17 == 16 { 2e-2 } else { 1e-4 } * size;
            let mut moved: f64 = 0.0;
            for p in surface.net_mut().points_mut() {
                let step = random.vector() * most;
                moved = moved.max(step.norm());
                *p += step;
            }
            solver.net_changed();
            let mut fresh = first.clone();
            fresh.net_changed();
            fresh.pieces(&surface);
            let q = query(&surface, &mut random, tick);
            assert_eq!(
                solver.closest(&surface, &q),
                fresh.closest(&surface, &q),
                "surface {k}, tick {tick}, {q:?}"
            );
            let near = surface.point(0.3, 0.4) + random.vector() * (1e-2 * size);
            let mut fresh_warm = warm;
            let answer =
                solver.closest_warm_moved(&surface, &near, (near - last).norm(), moved, &mut warm);
            let wanted = fresh.closest_warm_moved(
                &surface,
                &near,
                (near - last).norm(),
                moved,
                &mut fresh_warm,
            );
            assert_eq!(
                (answer, warm),
                (wanted, fresh_warm),
                "surface {k}, tick {tick}, {near:?}"
            );
            last = near;
            if tick % 5 == 0 {
                let d = random.vector();
                assert_eq!(
                    solver.deepest_along(&surface, &d),
                    fresh.deepest_along(&surface, &d)
                );
            }
        }
    }
}
