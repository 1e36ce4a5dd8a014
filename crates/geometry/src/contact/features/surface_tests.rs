//! Edges of surfaces against closed forms.

use super::{Edge, Features};
use crate::basis::KnotVector;
use crate::math::Point3;
use crate::surface::{ControlNet, Surface, builtin};

/// Rows of points as a surface of degree 2 × 1 around z, a square turned round: (radius, z) of each row.
fn turned(profile: &[(f64, f64)]) -> Surface {
    // An exact circle: nine points with the weights of quarter arcs.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let around = [
        (1.0, 0.0, 1.0),
        (1.0, 1.0, half),
        (0.0, 1.0, 1.0),
        (-1.0, 1.0, half),
        (-1.0, 0.0, 1.0),
        (-1.0, -1.0, half),
        (0.0, -1.0, 1.0),
        (1.0, -1.0, half),
        (1.0, 0.0, 1.0),
    ];
    let knots_u = KnotVector::new(2, vec![0., 0., 0., 1., 1., 2., 2., 3., 3., 4., 4., 4.]).unwrap();
    let mut knots = vec![0.0];
    knots.extend((0..profile.len()).map(|k| k as f64));
    knots.push(profile.len() as f64 - 1.0);
    let knots_v = KnotVector::new(1, knots).unwrap();
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for (x, y, weight) in around {
        for &(r, z) in profile {
            points.push(Point3::new(x * r, y * r, z));
            weights.push(weight);
        }
    }
    let net = ControlNet::new(9, profile.len(), points).unwrap();
    Surface::new(knots_u, knots_v, net, Some(weights))
        .unwrap()
        .oriented_outward()
}

fn off_m(features: &Features, radius_m: f64, z: f64) -> f64 {
    let places = features
        .edges
        .iter()
        .flat_map(|e| (0..200).map(|k| e.at(f64::from(k) / 200.0).0));
    let off = places.map(|p| (p.x.hypot(p.y) - radius_m).abs().max((p.z.abs() - z).abs()));
    off.fold(0.0, f64::max)
}

#[test]
fn a_turned_puck_has_two_round_edges_and_a_turned_cone_one_and_its_tip() {
    let puck = Features::of_surface(&turned(&[
        (0.0, -0.006),
        (0.01, -0.006),
        (0.01, 0.006),
        (0.0, 0.006),
    ]));
    assert_eq!((puck.corners.len(), puck.edges.len()), (0, 2), "{puck:?}");
    assert!(puck.edges.iter().all(Edge::is_round));
    assert!(
        off_m(&puck, 0.01, 0.006) < 1e-9 * 0.01,
        "{}",
        off_m(&puck, 0.01, 0.006)
    );
    let cone = Features::of_surface(&turned(&[(0.0, 0.0), (0.01, 0.02), (0.0, 0.02)]));
    assert_eq!(
        (cone.corners.as_slice(), cone.edges.len()),
        (&[Point3::origin()][..], 1)
    );
    assert!(off_m(&cone, 0.01, 0.02) < 1e-9 * 0.01);
}

// What runs inwards is no edge: a waist.
#[test]
fn a_waist_is_no_edge_and_what_is_smooth_has_none() {
    let waist = turned(&[
        (0.0, -0.02),
        (0.01, -0.02),
        (0.005, 0.0),
        (0.01, 0.02),
        (0.0, 0.02),
    ]);
    let waist = Features::of_surface(&waist);
    assert_eq!(waist.edges.len(), 2, "{waist:?}");
    for name in ["sphere", "torus"] {
        let features = Features::of_surface(&builtin(name, None, None).unwrap());
        assert!(features.is_empty(), "{name}: {features:?}");
    }
}

#[test]
fn the_rim_of_a_sheet_is_four_straight_edges_between_four_corners() {
    let sheet = Features::of_surface(&builtin("sheet", None, Some(0.1)).unwrap());
    assert_eq!(
        (sheet.corners.len(), sheet.edges.len()),
        (4, 4),
        "{sheet:?}"
    );
    for edge in &sheet.edges {
        assert!(
            edge.is_straight() && (edge.length_m() - 0.1).abs() < 1e-15,
            "{edge:?}"
        );
    }
}
