//! The given pairs, hard cases, laws.

mod gaps;
mod hard;
mod laws;
mod table;

use super::given::GivenPair;
use super::{Body, IsolateSpec, Isolated, isolate_ready};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ControlNet, Surface};

fn solved(pair: &GivenPair, [moving, fixed]: &[Body; 2], spec: &IsolateSpec) -> Isolated {
    isolate_ready(
        (&pair.moving, moving),
        (&pair.fixed, fixed),
        &Vector3::zeros(),
        spec,
    )
    .unwrap()
}

/// A ball-like body with half axes, m: nets as in the given pairs.
fn ellipsoid(axes: [f64; 3], centre: Vector3) -> Surface {
    let (rows, columns) = (12, 9);
    let points = (0..rows * columns)
        .map(|k| {
            let theta = std::f64::consts::TAU * (k / columns) as f64 / rows as f64;
            let phi = std::f64::consts::PI * (k % columns) as f64 / (columns - 1) as f64;
            // Poles to the last bit.
            let sine = if k % columns == 0 || k % columns == columns - 1 {
                0.0
            } else {
                phi.sin()
            };
            let p = Vector3::new(sine * theta.cos(), sine * theta.sin(), phi.cos());
            Point3::from(p.component_mul(&Vector3::from(axes)) + centre)
        })
        .collect();
    let net = ControlNet::new(rows, columns, points).unwrap();
    let knots = (
        KnotVector::periodic_uniform(3, rows).unwrap(),
        KnotVector::clamped_uniform(3, columns).unwrap(),
    );
    Surface::new(knots.0, knots.1, net, None)
        .unwrap()
        .oriented_outward()
}

/// A box with plane faces and sharp edges, m: degree 1 round four edges, bottom and top drawn
/// together to poles.
fn block(low: [f64; 3], high: [f64; 3]) -> Surface {
    let middle = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
    let corners = [
        [low[0], low[1]],
        [high[0], low[1]],
        [high[0], high[1]],
        [low[0], high[1]],
    ];
    let points = corners
        .iter()
        .flat_map(|&[x, y]| {
            [
                [middle[0], middle[1], low[2]],
                [x, y, low[2]],
                [x, y, high[2]],
                [middle[0], middle[1], high[2]],
            ]
        })
        .map(Point3::from)
        .collect();
    let net = ControlNet::new(4, 4, points).unwrap();
    let knots = (
        KnotVector::periodic_uniform(1, 4).unwrap(),
        KnotVector::clamped_uniform(1, 4).unwrap(),
    );
    Surface::new(knots.0, knots.1, net, None)
        .unwrap()
        .oriented_outward()
}
