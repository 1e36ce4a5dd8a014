//! Facts about two surfaces in contact, against dense sampling and closed forms.

use super::*;
use crate::math::{Point3, Rotation, Vector3};
use crate::surface::builtin;

/// Knuth's MMIX generator.
pub(crate) struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn vector(&mut self) -> Vector3 {
        Vector3::from_fn(|_, _| 2.0 * self.unit() - 1.0)
    }

    pub fn rotation(&mut self) -> Rotation {
        Rotation::from_scaled_axis(self.vector() * 3.0)
    }
}

pub(super) fn posed(surface: &Surface, rotation: &Rotation, shift: &Vector3) -> Surface {
    let mut moved = surface.clone();
    for p in moved.net_mut().points_mut() {
        *p = rotation * *p + shift;
    }
    moved
}

pub(super) fn contacts(body: &Surface, tool: &Surface, margin_m: f64) -> ContactSet {
    let mut set = ContactSet::new();
    let (mut a, mut b) = (ClosestSolver::new(body), ClosestSolver::new(tool));
    PairSolver::new(body, tool).contacts(
        PairSide { surface: body, solver: &mut a },
        PairSide { surface: tool, solver: &mut b },
        Reach { margin_m, below: false },
        &mut set,
    );
    check(body, tool, margin_m, &set);
    set
}

/// What holds for every contact.
fn check(body: &Surface, tool: &Surface, margin_m: f64, set: &ContactSet) {
    let size = body.size() + tool.size();
    for c in set.contacts() {
        let [s, t] = c.tool_uv.unwrap();
        assert!((c.on_body - c.on_tool - c.normal * c.depth_m).norm() < 1e-11 * size, "{c:?}");
        assert!((c.normal.norm() - 1.0).abs() < 1e-12, "{c:?}");
        assert!((body.point(c.u, c.v) - c.on_body).norm() < 1e-12 * size, "{c:?}");
        assert!((tool.point(s, t) - c.on_tool).norm() < 1e-12 * size, "{c:?}");
        assert!(c.depth_m >= -margin_m - 1e-11 * size, "{c:?}");
    }
}

/// Depth of the deepest point of each connected part of `upper` below the closed `lower`, by `n × n` samples joined with
/// their neighbours, the highest polished by a shrinking pattern. Regions smaller than a cell are not seen.
fn brute(upper: &Surface, lower: &Surface, n: usize) -> Vec<(f64, Point3)> {
    let mut solver = ClosestSolver::new(lower);
    let mut depth = |u: f64, v: f64| -solver.closest(lower, &upper.point(u, v)).signed_distance;
    let ((u0, u1), (v0, v1)) = (upper.knots_u().domain(), upper.knots_v().domain());
    let at =
        |k: usize| (u0 + (u1 - u0) * (k / n) as f64 / n as f64, v0 + (v1 - v0) * ((k % n) as f64 + 0.5) / n as f64);
    let values: Vec<f64> = (0..n * n).map(|k| depth(at(k).0, at(k).1)).collect();
    let poles = upper.topology().poles;
    let mut random = Random(9);
    let mut seen = vec![false; n * n];
    let mut regions = vec![];
    for k in 0..n * n {
        if seen[k] || values[k] <= 0.0 {
            continue;
        }
        let (mut stack, mut best) = (vec![k], k);
        seen[k] = true;
        while let Some(x) = stack.pop() {
            best = if values[x] > values[best] { x } else { best };
            let (i, j) = (x / n, x % n);
            let mut near = vec![(i + 1) % n * n + j, (i + n - 1) % n * n + j];
            if j + 1 < n || upper.topology().wraps(1) {
                near.push(i * n + (j + 1) % n);
            }
            if j > 0 || upper.topology().wraps(1) {
                near.push(i * n + (j + n - 1) % n);
            }
            if (j == 0 && poles[1][0]) || (j + 1 == n && poles[1][1]) {
                near.extend((0..n).map(|i| i * n + j));
            }
            for y in near {
                if !seen[y] && values[y] > 0.0 {
                    seen[y] = true;
                    stack.push(y);
                }
            }
        }
        let ((mut u, mut v), mut d) = (at(best), values[best]);
        let mut step = [(u1 - u0) / n as f64, (v1 - v0) / n as f64];
        while step[0] > 1e-8 * (u1 - u0) {
            let mut moved = false;
            // Ridges rise in a narrow sector: directions of no pattern.
            for _ in 0..48 {
                let angle = std::f64::consts::TAU * random.unit();
                let (a, b) = (u + step[0] * angle.cos(), v + step[1] * angle.sin());
                let a = if upper.topology().wraps(0) { u0 + (a - u0).rem_euclid(u1 - u0) } else { a.clamp(u0, u1) };
                let b = if upper.topology().wraps(1) { v0 + (b - v0).rem_euclid(v1 - v0) } else { b.clamp(v0, v1) };
                let new = depth(a, b);
                if new > d {
                    (u, v, d, moved) = (a, b, new, true);
                }
            }
            if !moved {
                step = step.map(|s| s * 0.6);
            }
        }
        regions.push((d, upper.point(u, v)));
    }
    regions.sort_by(|a, b| b.0.total_cmp(&a.0));
    regions
}

/// Every region of the sampling is there, and nothing else.
fn agree(name: &str, body: &Surface, tool: &Surface, n: usize) -> usize {
    let set = contacts(body, tool, 0.0);
    let size = body.size();
    let mut wanted: Vec<(f64, Point3, bool)> = vec![];
    wanted.extend(brute(body, tool, n).into_iter().map(|(d, p)| (d, p, true)));
    wanted.extend(brute(tool, body, n).into_iter().map(|(d, p)| (d, p, false)));
    let mut wrong = 0;
    for (depth, point, on_body) in &wanted {
        let found = set.contacts().iter().any(|c| (c.depth_m - depth).abs() <= 1e-6 * size);
        if !found {
            wrong += 1;
            println!("{name}: region of depth {depth} at {point} (body {on_body}) is not in {:?}", depths(&set));
        }
    }
    // Regions that the sampling sees are wider than one of its cells.
    for c in set.contacts() {
        let found = wanted.iter().any(|(d, _, _)| (c.depth_m - d).abs() <= 1e-6 * size);
        if !found && c.depth_m > 2e-3 * size {
            wrong += 1;
            let all: Vec<f64> = wanted.iter().map(|w| w.0).collect();
            println!("{name}: contact {c:?} is not among {all:?}");
        }
    }
    wrong
}

fn depths(set: &ContactSet) -> Vec<f64> {
    set.contacts().iter().map(|c| c.depth_m).collect()
}

#[test]
fn spheres_touch_as_deep_as_their_radii_say() {
    let sphere = builtin("sphere", None, Some(0.05)).unwrap();
    let mut random = Random(1);
    for k in 0..60 {
        let way = random.vector().normalize();
        let depth = [0.02, 1e-3, 1e-5, 1e-7, 0.0, -1e-7, -1e-4, -0.004][k % 8];
        let tool = posed(&sphere, &random.rotation(), &(way * (0.1 - depth)));
        let set = contacts(&sphere, &tool, 0.005);
        assert_eq!(set.contacts().len(), 1, "{k} depth {depth}: {:?}", set.contacts());
        let c = &set.contacts()[0];
        assert!((c.depth_m - depth).abs() < 1e-13, "{k}: depth {} for {depth}", c.depth_m);
        assert!((c.normal - way).norm() < 1e-6, "{k}: {c:?}");
        assert_eq!(set.overlap(), depth >= -1e-12, "{k}");
    }
}

#[test]
fn regions_of_teardrops_are_those_of_a_dense_sampling() {
    let mut random = Random(2);
    let mut wrong = 0;
    for k in 0..if cfg!(debug_assertions) { 8 } else { 60 } {
        let count = [8, 12, 20][k % 3];
        let drop = builtin("teardrop", Some([count; 2]), None).unwrap();
        let tool = posed(&drop, &random.rotation(), &(random.vector() * 0.07));
        wrong += agree(&format!("pose {k}"), &drop, &tool, if cfg!(debug_assertions) { 60 } else { 160 });
    }
    assert_eq!(wrong, 0);
}

#[test]
#[ignore = "prints times"]
fn pair_speed() {
    for (name, count) in [("8x8", 8), ("20x20", 20)] {
        let drop = builtin("teardrop", Some([count; 2]), None).unwrap();
        for spread in [0.1, 0.03] {
            let mut random = Random(3);
            let mut times = vec![];
            let mut touching = 0;
            let mut tool = drop.clone();
            let mut pair = PairSolver::new(&drop, &tool);
            let (mut a, mut b) = (ClosestSolver::new(&drop), ClosestSolver::new(&tool));
            let mut set = ContactSet::new();
            let mut split = [0.0; 4];
            for _ in 0..400 {
                tool = posed(&drop, &random.rotation(), &(random.vector() * spread));
                let start = std::time::Instant::now();
                b.net_changed();
                pair.contacts(
                    PairSide { surface: &drop, solver: &mut a },
                    PairSide { surface: &tool, solver: &mut b },
                    Reach::TOUCH,
                    &mut set,
                );
                let time = start.elapsed().as_secs_f64() * 1e6;
                if set.overlap() {
                    touching += 1;
                    times.push(time);
                    let start = std::time::Instant::now();
                    b.net_changed();
                    b.pieces(&tool);
                    split[0] += start.elapsed().as_secs_f64() * 1e6;
                    split[1] += pair.touch.facing().len() as f64;
                    split[2] += pair.facing.len() as f64;
                    let start = std::time::Instant::now();
                    for k in 0..10 {
                        std::hint::black_box(b.near(&tool, &drop.point(0.1 * f64::from(k), 0.3)));
                    }
                    split[3] += start.elapsed().as_secs_f64() * 1e5;
                }
            }
            times.sort_by(f64::total_cmp);
            let at = |q: f64| times[((times.len() - 1) as f64 * q) as usize];
            println!(
                "{name} spread {spread}: {touching} touch, median {:.1} µs, p90 {:.1}, p99 {:.1}; refresh {:.1}, pairs {:.0}, roots {:.1}, near {:.2}",
                at(0.5),
                at(0.9),
                at(0.99),
                split[0] / times.len() as f64,
                split[1] / times.len() as f64,
                split[2] / times.len() as f64,
                split[3] / times.len() as f64
            );
        }
    }
}
