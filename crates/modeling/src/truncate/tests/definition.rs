//! What truncation is, on random bodies.

use super::*;
use crate::truncate::fields::Fields;
use palpate_geometry::part::PartSolver;

/// A pair that overlaps, with its truncation.
fn pairs(count: usize) -> Vec<([Surface; 2], Truncated)> {
    let mut random = Random(20261130);
    let mut all = Vec::new();
    while all.len() < count {
        let (a, b) = (knobbly(&mut random), knobbly(&mut random));
        let way = random.vector().normalize() * random.float(0.03, 0.055);
        let b = moved(&b, way.into());
        if let Some(two) =
            truncate(&a, &b, &TruncateSpec::default()).unwrap_or_else(|e| panic!("{e}"))
        {
            all.push(([a, b], two));
        }
    }
    all
}

/// The signed distance of a part, m.
fn signed(part: &palpate_geometry::part::Part, solver: &mut PartSolver, q: &Point3) -> f64 {
    let foot = solver.closest(part, q).unwrap();
    foot.signed_distance.expect("it is closed")
}

#[test]
fn each_place_of_random_bodies_is_in_the_part_that_the_definition_says() {
    let mut random = Random(3);
    for (k, ([a, b], two)) in pairs(5).iter().enumerate() {
        let mut fields = Fields::new([a, b]);
        let mut solvers = two.parts.each_ref().map(PartSolver::new);
        let off_m = two
            .walls
            .iter()
            .fold(two.tolerance_m, |m, w| m.max(w.off_m));
        let gap_m = two.parts.iter().fold(off_m, |m, p| m.max(p.gap_m()));
        let (low, high) = two.parts[0].bounds();
        let wall = walls(two)[0];
        let mut counts = [0; 4];
        for n in 0..400 {
            let by = (high - low).component_mul(&random.vector());
            let q = match n % 2 {
                0 => nalgebra::center(&low, &high) + by * 0.6,
                _ => wall.point(random.unit(), random.unit()) + by * 0.1,
            };
            let depths = fields.at(&q);
            let [phi_a, phi_b] = depths.phi;
            // What the definition does not decide: within what the wall and the edges are off.
            if phi_a.abs().min(phi_b.abs()).min(0.5 * depths.lead().abs()) <= 2.0 * gap_m {
                continue;
            }
            let wanted = [
                phi_a < 0.0 && !(phi_b < 0.0 && phi_b < phi_a),
                phi_b < 0.0 && !(phi_a < 0.0 && phi_a <= phi_b),
            ];
            let found = [0, 1].map(|k| signed(&two.parts[k], &mut solvers[k], &q) < 0.0);
            assert_eq!(found, wanted, "pair {k}, {q}: {depths:?}");
            let kind = usize::from(phi_a < 0.0) + 2 * usize::from(phi_b < 0.0);
            counts[kind] += 1;
        }
        assert!(counts.iter().all(|&n| n > 0), "pair {k}: {counts:?}");
        assert_union(two, 1e-7);
    }
}

#[test]
fn the_order_of_the_bodies_does_not_matter() {
    for (k, ([a, b], two)) in pairs(2).iter().enumerate() {
        let other = truncated(b, a);
        let near = |x: f64, y: f64| (x / y - 1.0).abs() < 1e-4;
        for (x, y) in two.volumes_m3.iter().zip(other.volumes_m3.iter().rev()) {
            assert!(near(*x, *y), "pair {k}: {x} {y}");
        }
        let mut fields = Fields::new([a, b]);
        let most_m = other
            .walls
            .iter()
            .fold(other.tolerance_m, |m, w| m.max(w.uneven_m));
        for wall in walls(&other) {
            for p in places(wall) {
                let lead = fields.at(&p).lead().abs();
                assert!(lead <= 3.0 * most_m, "pair {k}, {p}: {lead}");
            }
        }
    }
}

#[test]
fn the_wall_moves_with_the_bodies() {
    let mut random = Random(9);
    for (k, ([a, b], two)) in pairs(2).iter().enumerate() {
        let pose = Pose::from_parts(random.vector().into(), random.rotation());
        let other = truncated(&a.transformed(&pose), &b.transformed(&pose));
        for (x, y) in two.volumes_m3.iter().zip(&other.volumes_m3) {
            assert!((x / y - 1.0).abs() < 1e-4, "pair {k}: {x} {y}");
        }
        let mut fields = Fields::new([a, b]);
        let most_m = other
            .walls
            .iter()
            .fold(other.tolerance_m, |m, w| m.max(w.uneven_m));
        for wall in walls(&other) {
            for p in places(wall) {
                let lead = fields.at(&pose.inverse_transform_point(&p)).lead().abs();
                assert!(lead <= 3.0 * most_m, "pair {k}, {p}: {lead}");
            }
        }
    }
}

#[test]
fn a_finer_tolerance_is_reached_and_edges_are_shut() {
    let (a, b) = (sphere(0.05, [0.0; 3]), sphere(0.03, [0.01, 0.02, 0.06]));
    let size_m = b.size();
    for share in [1e-3, 1e-5, 1e-6] {
        let spec = TruncateSpec {
            tolerance_m: Some(share * size_m),
        };
        let two = truncate(&a, &b, &spec).unwrap().unwrap();
        assert!(two.within_tolerance(), "{share}: {:?}", two.walls);
        for part in &two.parts {
            assert!(part.is_closed());
            // A thousandth of the tolerance, between the places at which that was measured too, or a billionth of the size.
            let most_m = 2.0 * (1e-3 * share).max(1e-9) * size_m;
            assert!(part.gap_m() <= most_m, "{share}: {}", part.gap_m());
        }
    }
}
