//! Facts about two surfaces in contact, against dense sampling and closed forms.

use super::*;
pub(crate) use crate::math::Random;
use crate::math::{Point3, Rotation, Vector3};
use crate::surface::builtin;

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
        PairSide {
            surface: body,
            solver: &mut a,
        },
        PairSide {
            surface: tool,
            solver: &mut b,
        },
        Reach {
            margin_m,
            below: false,
            closing_m: 0.0,
        },
        &mut set,
    );
    check(body, tool, margin_m, &set);
    set
}

/// What holds for every contact.
fn check(body: &Surface, tool: &Surface, margin_m: f64, set: &ContactSet) {
    let size = body.size() + tool.size();
    let (mut a, mut b) = (ClosestSolver::new(body), ClosestSolver::new(tool));
    let closed = body.topology().is_closed() && tool.topology().is_closed();
    for c in set.contacts() {
        let [s, t] = c.tool_uv.unwrap();
        let (of_body, of_tool) = (
            -b.closest(tool, &c.on_body).signed_distance,
            -a.closest(body, &c.on_tool).signed_distance,
        );
        let depths = [of_body, of_tool].map(|d| (d - c.depth_m).abs() < 1e-11 * size);
        assert!(
            !closed || depths[0] || depths[1],
            "{c:?}: {of_body}, {of_tool}"
        );
        assert!(
            (c.on_body - c.on_tool - c.normal * c.depth_m).norm() < 1e-11 * size,
            "{c:?}"
        );
        assert!((c.normal.norm() - 1.0).abs() < 1e-12, "{c:?}");
        assert!(
            (body.point(c.u, c.v) - c.on_body).norm() < 1e-12 * size,
            "{c:?}"
        );
        assert!(
            (tool.point(s, t) - c.on_tool).norm() < 1e-12 * size,
            "{c:?}"
        );
        assert!(c.depth_m >= -margin_m - 1e-11 * size, "{c:?}");
    }
}

/// Depth of the deepest point of each connected part of `upper` below the closed `lower`, by `n ×
/// n` samples joined with their neighbours, the highest polished by a shrinking pattern. Regions
/// smaller than a cell are not seen.
fn brute(upper: &Surface, lower: &Surface, n: usize) -> Vec<(f64, Point3)> {
    let mut solver = ClosestSolver::new(lower);
    let mut depth = |u: f64, v: f64| -solver.closest(lower, &upper.point(u, v)).signed_distance;
    let ((u0, u1), (v0, v1)) = (upper.knots_u().domain(), upper.knots_v().domain());
    let at = |k: usize| {
        (
            u0 + (u1 - u0) * (k / n) as f64 / n as f64,
            v0 + (v1 - v0) * ((k % n) as f64 + 0.5) / n as f64,
        )
    };
    let values: Vec<f64> = (0..n * n).map(|k| depth(at(k).0, at(k).1)).collect();
    let topology = upper.topology();
    let (poles, wraps) = (topology.poles, [topology.wraps(0), topology.wraps(1)]);
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
            if j + 1 < n || wraps[1] {
                near.push(i * n + (j + 1) % n);
            }
            if j > 0 || wraps[1] {
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
        // Windows of 25 × 25 around the best, each 0.7 times as wide: they follow ridges, which
        // patterns of a few ways miss.
        let mut wide = [3.0 * (u1 - u0) / n as f64, 3.0 * (v1 - v0) / n as f64];
        while wide[0] > 1e-8 * (u1 - u0) {
            let (cu, cv) = (u, v);
            for k in 0..625 {
                let (x, y) = (f64::from(k / 25 - 12) / 12.0, f64::from(k % 25 - 12) / 12.0);
                let (a, b) = (cu + wide[0] * x, cv + wide[1] * y);
                let a = if wraps[0] {
                    u0 + (a - u0).rem_euclid(u1 - u0)
                } else {
                    a.clamp(u0, u1)
                };
                let b = if wraps[1] {
                    v0 + (b - v0).rem_euclid(v1 - v0)
                } else {
                    b.clamp(v0, v1)
                };
                let new = depth(a, b);
                if new > d {
                    (u, v, d) = (a, b, new);
                }
            }
            wide = wide.map(|s| s * 0.7);
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
        // Depths are certified, so a deeper one is nearer to the truth; windows climb a ridge only
        // so far.
        let more = |c: &Contact| c.depth_m - depth;
        let found = set
            .contacts()
            .iter()
            .any(|c| more(c) >= -1e-6 * size && more(c) <= 1e-4 * size);
        if !found {
            wrong += 1;
            println!(
                "{name}: region of depth {depth} at {point} (body {on_body}) is not in {:?}",
                depths(&set)
            );
        }
    }
    // Regions that the sampling sees are wider than one of its cells.
    for c in set.contacts() {
        let found = wanted
            .iter()
            .any(|(d, _, _)| (c.depth_m - d).abs() <= 1e-4 * size);
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
    let mut random = Random(3);
    for k in 0..60 {
        let way = random.vector().normalize();
        let depth = [0.02, 1e-3, 1e-5, 1e-7, 0.0, -1e-7, -1e-4, -0.004][k % 8];
        let tool = posed(&sphere, &random.rotation(), &(way * (0.1 - depth)));
        let set = contacts(&sphere, &tool, 0.005);
        assert_eq!(
            set.contacts().len(),
            1,
            "{k} depth {depth}: {:?}",
            set.contacts()
        );
        let c = &set.contacts()[0];
        assert!(
            (c.depth_m - depth).abs() < 1e-13,
            "{k}: depth {} for {depth}",
            c.depth_m
        );
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
        wrong += agree(
            &format!("pose {k}"),
            &drop,
            &tool,
            if cfg!(debug_assertions) { 60 } else { 160 },
        );
    }
    assert_eq!(wrong, 0);
}

/// A surface scaled about the origin.
fn scaled(surface: &Surface, scale: f64) -> Surface {
    let mut scaled = surface.clone();
    for p in scaled.net_mut().points_mut() {
        *p = Point3::from(p.coords * scale);
    }
    scaled
}

pub(super) fn overlap(body: &Surface, tool: &Surface) -> bool {
    let (mut a, mut b) = (ClosestSolver::new(body), ClosestSolver::new(tool));
    PairSolver::new(body, tool).overlap(
        PairSide {
            surface: body,
            solver: &mut a,
        },
        PairSide {
            surface: tool,
            solver: &mut b,
        },
    )
}

// Convex bodies: support functions along the normal of the closest pair say what is true, without
// any contact search.
#[test]
fn ellipsoids_overlap_exactly_when_a_plane_does_not_part_them() {
    let ball = builtin("sphere", None, Some(0.05)).unwrap();
    let mut random = Random(5);
    let rounds = if cfg!(debug_assertions) { 60 } else { 10_000 };
    for k in 0..rounds {
        let mut made = || {
            let axes = Vector3::from_fn(|_, _| 0.4 + 0.6 * random.unit());
            let rotation = random.rotation();
            let mut surface = ball.clone();
            for p in surface.net_mut().points_mut() {
                *p = rotation * Point3::from(p.coords.component_mul(&axes));
            }
            (surface, rotation, axes * 0.05)
        };
        let ((body, ra, a), (tool, rb, b)) = (made(), made());
        // The point of an ellipsoid with a given normal is M n / |M^1/2 n|, M = R diag(a²) Rᵀ; they
        // touch there.
        let way = random.vector().normalize();
        let support = |r: &Rotation, axes: &Vector3, n: &Vector3| {
            let m = r.inverse() * n;
            let scaled = m.component_mul(axes);
            r * scaled.component_mul(axes) / scaled.norm()
        };
        let size = body.size();
        let gap = [1e-6, -1e-6, 1e-3, -1e-3, 0.05, -0.05][k % 6] * size;
        let shift = support(&ra, &a, &way) - support(&rb, &b, &-way) + way * gap;
        let tool = posed(&tool, &Rotation::identity(), &shift);
        assert_eq!(
            overlap(&body, &tool),
            gap < 0.0,
            "pair {k}: gap {gap} along {way}"
        );
    }
}

#[test]
fn a_tool_entirely_inside_and_one_larger_than_the_body_overlap_in_its_farthest_point() {
    let (large, small) = (
        builtin("sphere", None, Some(0.1)).unwrap(),
        builtin("sphere", None, Some(0.02)).unwrap(),
    );
    let shift = Vector3::new(0.03, 0.01, -0.02);
    let inner = posed(&small, &Random(3).rotation(), &shift);
    // The point of the small ball nearest to the centre of the large one, or that centre if the
    // ball holds it.
    let depth = 0.1 - (shift.norm() - 0.02);
    for (body, tool) in [(&large, &inner), (&inner, &large)] {
        let set = contacts(body, tool, 0.0);
        assert!(set.overlap());
        assert_eq!(set.contacts().len(), 1, "{set:?}");
        assert!((set.contacts()[0].depth_m - depth).abs() < 1e-7, "{set:?}");
    }
}

#[test]
fn two_regions_of_equal_depth_are_two() {
    // A cigar across the top of a lying ring touches it on both sides.
    let ring = builtin("torus", None, Some(0.05)).unwrap();
    let mut cigar = builtin("sphere", None, Some(0.01)).unwrap();
    for p in cigar.net_mut().points_mut() {
        *p = Point3::new(20.0 * p.x, p.y, p.z + 0.029);
    }
    let set = contacts(&ring, &cigar, 0.0);
    assert_eq!(set.contacts().len(), 2, "{set:?}");
    let [a, b] = [set.contacts()[0], set.contacts()[1]];
    assert!(
        (a.depth_m - b.depth_m).abs() < 1e-12 && (a.on_body.x + b.on_body.x).abs() < 1e-7,
        "{set:?}"
    );
    assert_eq!(set.rectangles().len(), 2, "{set:?}");
}

#[test]
fn the_answer_moves_with_the_pair_and_scales_with_it_and_does_not_mind_who_is_first() {
    let drop = builtin("teardrop", None, None).unwrap();
    let mut random = Random(8);
    for k in 0..12 {
        let tool = posed(&drop, &random.rotation(), &(random.vector() * 0.06));
        let first = contacts(&drop, &tool, 0.002);
        let (rotation, shift) = (random.rotation(), random.vector());
        let moved = contacts(
            &posed(&drop, &rotation, &shift),
            &posed(&tool, &rotation, &shift),
            0.002,
        );
        let swapped = contacts(&tool, &drop, 0.002);
        for (name, scale, other) in [("moved", 1.0, &moved), ("swapped", 1.0, &swapped)] {
            assert_eq!(
                other.contacts().len(),
                first.contacts().len(),
                "{k} {name}: {first:?} {other:?}"
            );
            for (a, b) in first.contacts().iter().zip(other.contacts()) {
                assert!(
                    (a.depth_m * scale - b.depth_m).abs() < 1e-9,
                    "{k} {name}: {a:?} {b:?}"
                );
            }
        }
        for scale in [1e-6, 1e3] {
            let tiny = contacts(&scaled(&drop, scale), &scaled(&tool, scale), 0.002 * scale);
            assert_eq!(
                tiny.contacts().len(),
                first.contacts().len(),
                "{k} × {scale}: {first:?} {tiny:?}"
            );
            for (a, b) in first.contacts().iter().zip(tiny.contacts()) {
                assert!(
                    (a.depth_m - b.depth_m / scale).abs() < 1e-9,
                    "{k} × {scale}: {a:?} {b:?}"
                );
            }
        }
    }
}

#[test]
fn a_pole_pressed_into_a_body_is_as_deep_as_its_tip() {
    let drop = builtin("teardrop", None, None).unwrap();
    let tip = drop.net().at(0, drop.net().columns() - 1);
    let ball = builtin("sphere", None, Some(0.05)).unwrap();
    let n = drop.normal(0.0, 1.0);
    for depth in [1e-3, 1e-5, 0.0, -1e-4] {
        let tool = posed(
            &ball,
            &Rotation::identity(),
            &(tip.coords + n * (0.05 - depth)),
        );
        let set = contacts(&drop, &tool, 1e-3);
        let c = set
            .deepest()
            .unwrap_or_else(|| panic!("nothing at depth {depth}"));
        assert!((c.depth_m - depth).abs() < 1e-9, "{depth}: {set:?}");
    }
}

#[test]
fn what_is_not_finite_or_far_away_touches_nothing() {
    let drop = builtin("teardrop", None, None).unwrap();
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        let mut tool = drop.clone();
        tool.net_mut().points_mut()[20].x = bad;
        let mut set = ContactSet::new();
        let (mut a, mut b) = (ClosestSolver::new(&drop), ClosestSolver::new(&drop));
        let mut pair = PairSolver::new(&drop, &drop);
        b.net_changed();
        pair.contacts(
            PairSide {
                surface: &drop,
                solver: &mut a,
            },
            PairSide {
                surface: &tool,
                solver: &mut b,
            },
            Reach {
                margin_m: 0.01,
                below: false,
                closing_m: 0.0,
            },
            &mut set,
        );
        assert!(
            set.contacts().iter().all(|c| c.depth_m.is_finite()),
            "{set:?}"
        );
    }
    assert!(
        contacts(
            &drop,
            &posed(&drop, &Rotation::identity(), &Vector3::x()),
            0.01
        )
        .contacts()
        .is_empty()
    );
}

#[test]
fn coincident_flat_patches_are_one_region_of_their_common_depth() {
    let sheet = builtin("sheet", None, None).unwrap();
    for depth in [0.0, 1e-3, 1e-7] {
        let tool = posed(
            &sheet,
            &Rotation::identity(),
            &Vector3::new(0.01, 0.02, -depth),
        );
        let set = contacts(&sheet, &tool, 0.0);
        assert_eq!(set.contacts().len(), 1, "{depth}: {set:?}");
        let c = &set.contacts()[0];
        assert!(
            (c.depth_m - depth).abs() < 1e-12 && (c.normal - Vector3::z()).norm() < 1e-9,
            "{depth}: {c:?}"
        );
        assert!(set.overlap());
    }
    assert!(
        !contacts(
            &sheet,
            &posed(&sheet, &Rotation::identity(), &(Vector3::z() * 1e-4)),
            0.0
        )
        .overlap()
    );
}

#[test]
fn a_ball_on_an_open_edge_and_under_a_sheet_is_as_deep_as_it_is_below() {
    let sheet = builtin("sheet", None, None).unwrap();
    let ball = builtin("sphere", None, Some(0.01)).unwrap();
    for (x, depth) in [(0.0, 0.002), (0.03, 0.0), (0.045, -1e-4), (-0.03, 0.012)] {
        let tool = posed(
            &ball,
            &Rotation::identity(),
            &Vector3::new(x, 0.013, 0.01 - depth),
        );
        let set = contacts(&sheet, &tool, 1e-3);
        let c = set
            .deepest()
            .unwrap_or_else(|| panic!("nothing at depth {depth}"));
        assert!((c.depth_m - depth).abs() < 1e-9, "{depth}: {set:?}");
        assert!((c.normal - Vector3::z()).norm() < 1e-6, "{depth}: {c:?}");
    }
}
