//! Energy that a step makes where it holds cells back.
//!
//! Forces of cells that are held back are no gradient of an energy, and pump: without damping a body
//! that is hit hard once scrambles itself within seconds. What a step has more than before, and was
//! not given by loads, is taken from the motion within the body; its momentum stays.

use super::matter::{Matter, lanes};
use super::node_map::NodeMap;
use super::rigid_motion::Momentum;
use super::rigid_velocity::RigidVelocity;
use palpate_geometry::math::{Lane, Point3, Vector3};

/// Takes so much energy (J), as far as there is motion to take it from.
pub(super) fn take(matter: &Matter, places: &[Point3], speeds: &mut [Vector3], excess_j: f64) {
    if excess_j.is_nan() || excess_j <= 0.0 {
        return;
    }
    let rigid = match matter.is_free() {
        true => Momentum::of(matter, places, speeds).rigid(matter, places),
        false => RigidVelocity::default(),
    };
    let moving = speeds.iter().zip(places).zip(&matter.masses);
    let within_j: f64 = moving
        .map(|((v, x), m)| 0.5 * m * (v - rigid.velocity(x)).norm_squared())
        .sum();
    let share = (1.0 - excess_j / within_j).max(0.0).sqrt();
    if share.is_finite() {
        for (v, x) in speeds.iter_mut().zip(places) {
            let along = rigid.velocity(x);
            *v = along + (*v - along) * share;
        }
    }
}

/// Elastic and kinetic, J. `rest`: as [`Matter::rest_lengths`]; `coordinates` and `nodes` are buffers.
pub(super) fn energy_j(
    matter: &Matter,
    rest: &[Lane],
    places: &[Point3],
    speeds: &[Vector3],
    coordinates: &mut [Lane],
    nodes: &mut [Lane],
) -> f64 {
    lanes(places, coordinates);
    let moving = matter.masses.iter().zip(speeds);
    let kinetic: f64 = moving.map(|(m, v)| 0.5 * m * v.norm_squared()).sum();
    let all: &[Lane] = match &matter.map {
        NodeMap::Same => coordinates,
        NodeMap::Sparse(map) => {
            map.apply(coordinates, nodes);
            nodes
        }
    };
    matter.law.energy_j(rest, all) + kinetic
}
