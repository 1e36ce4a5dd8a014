//! Edges of functions against those of the same solids given by sizes.

use super::{ImplicitShape, ImplicitTool};
use crate::contact::{Edge, Features};
use crate::math::Point3;

fn found(f: &str) -> ImplicitTool {
    let text = f.to_owned();
    let tool = ImplicitShape::Expression { text }.compile().unwrap();
    tool.with_edges_found(0.05)
}

/// A point of each kind of place on all edges.
fn along(features: &Features) -> Vec<Point3> {
    let at = |edge: &Edge| {
        (0..101)
            .map(|k| edge.at(f64::from(k) / 100.0).0)
            .collect::<Vec<_>>()
    };
    features.edges.iter().flat_map(at).collect()
}

#[test]
fn the_edges_of_a_block_are_straight_between_its_corners() {
    let known = ImplicitShape::Box {
        half_extents_m: [0.011, 0.008, 0.006],
    };
    let f = "max(abs(x) - 0.011, abs(y) - 0.008, abs(z) - 0.006)";
    let (found, known) = (found(f).features().clone(), known.features());
    assert_eq!(
        (found.corners.len(), found.edges.len()),
        (8, 12),
        "{found:?}"
    );
    assert!(
        found
            .edges
            .iter()
            .all(|e| matches!(e, Edge::Segment { .. }))
    );
    for corner in &known.corners {
        let near = found.corners.iter().map(|c| (c - corner).norm());
        assert!(
            near.fold(f64::INFINITY, f64::min) < 1e-11 * 0.011,
            "{found:?}"
        );
    }
}

#[test]
fn round_edges_are_where_they_are_to_nine_digits() {
    for (f, z, radius_m) in [
        (
            "max(x^2 + y^2 - 0.009^2, (abs(z) - 0.012) * 0.02)",
            0.012,
            0.009,
        ),
        ("max(hypot(x, y) - 0.015, abs(z) - 0.0015)", 0.0015, 0.015),
        ("max(hypot(x, y) - 0.5 * z, z - 0.02)", 0.02, 0.01),
        // A ball cut off.
        ("max(x^2 + y^2 + z^2 - 0.02^2, -z - 0.012)", -0.012, 0.016),
    ] {
        let features = found(f).features().clone();
        let points = along(&features);
        assert!(!points.is_empty(), "{f}");
        assert!(features.edges.iter().all(Edge::is_round), "{f}");
        for p in points {
            let off_m = (p.x.hypot(p.y) - radius_m)
                .abs()
                .max((p.z.abs() - f64::abs(z)).abs());
            assert!(off_m < 1e-9 * radius_m, "{f}: {p} is off by {off_m}");
        }
        let length_m = features.edges[0].length_m();
        assert!(
            (length_m / (std::f64::consts::TAU * radius_m) - 1.0).abs() < 1e-8,
            "{f}: {length_m}"
        );
        assert_eq!(
            features.corners.len(),
            usize::from(f.contains("0.5 * z")),
            "{f}: {:?}",
            features.corners
        );
    }
}

// Two bars across each other: their common part has four edges that are bent, up to where its sides meet at less than 1°.
#[test]
fn bent_edges_end_in_corners() {
    let features = found("max(hypot(x, y) - 0.01, hypot(y, z) - 0.01)")
        .features()
        .clone();
    assert_eq!(
        (features.corners.len(), features.edges.len()),
        (8, 4),
        "{features:?}"
    );
    for corner in &features.corners {
        let away_m = (Point3::new(corner.x, corner.y.abs() - 0.01, corner.z))
            .coords
            .norm();
        assert!(away_m < 0.01 * 0.02, "{corner}");
    }
    for p in along(&features) {
        let off_m = (p.x.hypot(p.y) - 0.01)
            .abs()
            .max((p.y.hypot(p.z) - 0.01).abs());
        assert!(off_m < 1e-9 * 0.01, "{p}: {off_m}");
    }
}

#[test]
fn what_is_smooth_or_runs_inwards_has_no_edges() {
    for f in [
        "hypot(hypot(x, y), z) - 0.01",
        // A capsule: its slope goes on over its seams.
        "hypot(hypot(x, y), max(abs(z) - 0.01, 0)) - 0.005",
        // Two balls together.
        "min(hypot(hypot(x - 0.01, y), z) - 0.015, hypot(hypot(x + 0.01, y), z) - 0.015)",
    ] {
        let features = found(f).features().clone();
        assert!(features.is_empty(), "{f}: {features:?}");
    }
}

// A bar of four sides without end, and a wedge: their edges go on for ever, and are followed as far as the tool reaches.
#[test]
fn edges_without_end_end_at_the_reach() {
    for (f, count) in [("max(abs(x) - 0.01, abs(y) - 0.01)", 4), ("abs(x) + z", 1)] {
        let features = found(f).features().clone();
        assert_eq!(features.edges.len(), count, "{f}: {features:?}");
        for edge in &features.edges {
            assert!((edge.length_m() - 0.1).abs() < 1e-9, "{f}: {edge:?}");
        }
    }
}

#[test]
fn a_side_goes_on_beyond_its_edge() {
    let tool = found("max(abs(x) - 0.011, abs(y) - 0.008, abs(z) - 0.006)");
    let inside = Point3::new(0.010, 0.003, 0.001);
    let side = tool.side(&inside, 0).unwrap();
    for y in [0.0, 0.01, 0.03] {
        let below_m = tool.depth_below(side, &Point3::new(0.010, y, 0.002));
        assert!((below_m - 0.001).abs() < 1e-15, "{y}: {below_m}");
    }
}
