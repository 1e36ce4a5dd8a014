//! Static answers against closed forms.

use super::statics::{equilibrium, reaction};
use super::*;

// A linear map of the boundary must be taken up by every node inside, however its cells are shaped.
#[test]
fn patch_test_holds_to_rounding() {
    let map = nalgebra::Matrix3::new(1.05, 0.02, -0.03, 0.01, 0.97, 0.04, -0.02, 0.03, 1.02);
    for poisson in [0.0, 0.3, 0.49] {
        let grid = distorted(cuboid([3, 3, 3], [0.03; 3]), 0.002, 3);
        let solid = uniform(&grid, 20e3, poisson);
        let edge = |x: f64| !(1e-9..=0.03 - 1e-9).contains(&x);
        let fixed =
            |p: &Point3, axis: usize| p.iter().any(|&x| edge(x)).then(|| (map * p - p)[axis]);
        let places = equilibrium(&solid, &fixed, &|_| Vector3::zeros());
        for (place, rest) in places.iter().zip(&grid.nodes) {
            let error = (Point3::new(place[0], place[1], place[2]) - map * rest).norm();
            assert!(
                error < 1e-13,
                "ν = {poisson}: a node is {error} m off the linear map"
            );
        }
    }
}

// F / A = E ε for a bar whose sides are free; ε = 1e-5, so that the law's curvature is 1e-5 too.
#[test]
fn bar_shows_young_modulus_and_poisson_ratio() {
    for poisson in [0.0, 0.1, 0.3, 0.45, 0.49] {
        let grid = distorted(cuboid([2, 2, 4], [0.02, 0.02, 0.04]), 0.001, 7);
        let solid = uniform(&grid, 20e3, poisson);
        let strain = 1e-5;
        let fixed = |p: &Point3, axis: usize| match axis {
            2 if p.z == 0.0 => Some(0.0),
            2 if p.z == 0.04 => Some(strain * 0.04),
            0 if p.x == 0.0 => Some(0.0),
            1 if p.y == 0.0 => Some(0.0),
            _ => None,
        };
        let places = equilibrium(&solid, &fixed, &|_| Vector3::zeros());
        let young = reaction(&solid, &places, |p| p.z == 0.04).z / (0.02 * 0.02 * strain);
        let corner = grid
            .nodes
            .iter()
            .position(|p| *p == Point3::new(0.02, 0.02, 0.04))
            .unwrap();
        let lateral = -(places[corner][0] - 0.02) / (0.02 * strain);
        println!("ν = {poisson}: E {young:.3} Pa, ν {lateral:.6}");
        assert!(
            (young / 20e3 - 1.0).abs() < 1e-4,
            "ν = {poisson}: E = {young}"
        );
        assert!(
            (lateral - poisson).abs() < 1e-4,
            "ν = {poisson}: measured {lateral}"
        );
    }
}

// All the boundary sheared by γ: the force on the top is μ γ A.
#[test]
fn shear_shows_the_shear_modulus() {
    for poisson in [0.0, 0.3, 0.49] {
        let grid = distorted(cuboid([3, 3, 3], [0.03; 3]), 0.002, 8);
        let solid = uniform(&grid, 20e3, poisson);
        let strain = 1e-5;
        let edge = |x: f64| !(1e-9..=0.03 - 1e-9).contains(&x);
        let fixed = |p: &Point3, axis: usize| {
            p.iter()
                .any(|&x| edge(x))
                .then(|| if axis == 0 { strain * p.z } else { 0.0 })
        };
        let places = equilibrium(&solid, &fixed, &|_| Vector3::zeros());
        // The virtual work of the boundary's forces in a unit of γ, over the volume.
        let forces = solid.forces(&places);
        let work: f64 = grid
            .nodes
            .iter()
            .zip(&forces)
            .map(|(p, f)| -f.x * p.z)
            .sum();
        let shear = work / (strain * 2.7e-5);
        let expected = 20e3 / (2.0 * (1.0 + poisson));
        assert!(
            (shear / expected - 1.0).abs() < 1e-4,
            "ν = {poisson}: μ = {shear}, not {expected}"
        );
    }
}

/// Deflection of the tip under a small shear load over that of Timoshenko's beam: square bar,
/// length 5 sides, held at the root as a beam is (axial motion only), `n` cells across.
fn cantilever(n: usize, poisson: f64) -> f64 {
    let (side, length, young, load) = (0.01, 0.05, 20e3, 1e-6);
    let grid = cuboid([n, n, 5 * n], [side, 0.5 * side, length]);
    let solid = uniform(&grid, young, poisson);
    let fixed = |p: &Point3, axis: usize| {
        let held = match axis {
            2 => p.z == 0.0,
            0 => p.z == 0.0 && (p.x - 0.5 * side).abs() < 1e-9,
            _ => p.y == 0.0,
        };
        held.then_some(0.0)
    };
    // Parabolic shear over the depth, as in the beam's interior, by the nodes' shares.
    let tip: Vec<(usize, f64)> = (0..grid.nodes.len())
        .filter(|&k| grid.nodes[k].z == length)
        .map(|k| {
            let p = grid.nodes[k];
            let across = if p.y == 0.0 || p.y == 0.5 * side {
                0.5
            } else {
                1.0
            };
            let s = 2.0 * p.x / side - 1.0;
            let down = if p.x == 0.0 || p.x == side { 0.5 } else { 1.0 };
            (k, across * down * (1.0 - s * s + 0.5 / (n * n) as f64))
        })
        .collect();
    let total: f64 = tip.iter().map(|(_, w)| w).sum();
    let mut share = vec![0.0; grid.nodes.len()];
    tip.iter()
        .for_each(|&(k, w)| share[k] = 0.5 * load * w / total);
    let places = equilibrium(&solid, &fixed, &|node| Vector3::new(share[node], 0.0, 0.0));
    let moved = |k: usize| places[k][0] - grid.nodes[k].x;
    let deflection = tip.iter().map(|&(k, w)| w * moved(k)).sum::<f64>() / total;
    let (inertia, area, shear) = (
        side.powi(4) / 12.0,
        side * side,
        young / (2.0 * (1.0 + poisson)),
    );
    let factor = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    deflection
        / (load * length.powi(3) / (3.0 * young * inertia)
            + load * length / (factor * shear * area))
}

#[test]
fn cantilever_meets_the_beam_within_2_percent_from_two_cells_on_at_any_poisson_ratio() {
    for poisson in [0.0, 0.3, 0.49] {
        let ratios: Vec<f64> = [2, 4].into_iter().map(|n| cantilever(n, poisson)).collect();
        println!("ν = {poisson}: tip over Timoshenko's {ratios:.4?}");
        assert!(
            ratios[0] > 0.98 && (ratios[1] - 1.0).abs() < 0.01,
            "ν = {poisson}: {ratios:?}"
        );
    }
}
