//! Equilibria with known forces.

use super::*;
use crate::body::continuum::tests::{cuboid, uniform};

/// A quarter of a block `[side, side, height]` pressed by a ball at the middle of its top, `counts` cells in the quarter:
/// forces of the whole at each depth.
fn pressed_block(
    counts: [usize; 3],
    sides_m: [f64; 3],
    (young_pa, poisson): (f64, f64),
    radius_m: f64,
    depths_m: &[f64],
) -> Vec<f64> {
    let grid = cuboid(counts, [0.5 * sides_m[0], 0.5 * sides_m[1], sides_m[2]]);
    let solid = uniform(&grid, young_pa, poisson);
    let fixed: Vec<[bool; 3]> =
        grid.nodes.iter().map(|p| if p.z == 0.0 { [true; 3] } else { [p.x == 0.0, p.y == 0.0, false] }).collect();
    let top = |node: &usize| grid.nodes[*node].z == sides_m[2];
    let samples = (0..grid.nodes.len()).filter(top).map(|node| vec![(node as u32, 1.0)]).collect();
    let problem = Reference::new(&solid, &fixed, samples);
    let mut state = problem.at_rest();
    depths_m
        .iter()
        .map(|depth| {
            let centre = Point3::new(0.0, 0.0, sides_m[2] + radius_m - depth);
            problem.press(&mut state, Some(&Obstacle::Sphere { centre, radius_m }), &|_| Vector3::zeros()).unwrap();
            println!(
                "  {counts:?} depth {depth}: {} N, base {} N, {} touching, {} steps",
                4.0 * state.force_n.z,
                -4.0 * state.base_n.z,
                state.touching,
                state.newton_steps
            );
            4.0 * state.force_n.z
        })
        .collect()
}

#[test]
fn tmp_box() {
    let depths: Vec<f64> = (1..=5).map(|k| 2e-3 * f64::from(k)).collect();
    for n in std::env::var("CELLS").unwrap_or("4 6 8 12".into()).split(' ').map(|n| n.parse::<usize>().unwrap()) {
        let start = std::time::Instant::now();
        let forces = pressed_block([n / 2, n / 2, n], [0.1; 3], (20e3, 0.3), 0.03, &depths);
        println!("{n} cells: {:?} in {:?}", forces, start.elapsed());
    }
}

#[test]
fn tmp_time() {
    let grid = cuboid([11; 3], [0.1; 3]);
    let solid = uniform(&grid, 20e3, 0.3);
    let places = crate::body::continuum::tests::lanes(&grid.nodes);
    let mut residual = vec![[0.0; 4]; places.len()];
    let mut best = f64::INFINITY;
    for _ in 0..300 {
        let start = std::time::Instant::now();
        std::hint::black_box(solid.add_forces(std::hint::black_box(&places), &mut residual));
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("force pass {} us", best * 1e6);
}
