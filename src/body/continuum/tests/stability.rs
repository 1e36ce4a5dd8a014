//! The one-iteration step with the constant scalar matrix, in hard cases.

use super::*;

fn same(grid: &CellGrid, young_pa: f64, poisson: f64) -> Vec<Elastic> {
    vec![Elastic { young_pa, poisson }; grid.cells.len()]
}

fn base(p: &Point3) -> bool {
    p.z == 0.0
}

/// Ticks until all nodes are within `close_m` of rest for good, and the least and greatest energies' ratio to the first.
fn settle(world: &mut Stepper, ticks: usize, close_m: f64) -> Option<usize> {
    let mut since = None;
    for tick in 0..ticks {
        world.step(|_| Vector3::zeros());
        let far = world.farthest_m();
        assert!(far.is_finite() && far < 10.0, "tick {tick}: a node is {far} m from rest");
        if far > close_m {
            since = None;
        } else if since.is_none() {
            since = Some(tick);
        }
    }
    since
}

#[test]
fn scrambled_nodes_return_to_rest() {
    for (young_pa, poisson) in [(20e3, 0.0), (20e3, 0.3), (20e6, 0.3), (20e3, 0.45), (20e3, 0.499)] {
        let grid = cuboid([4; 3], [0.04; 3]);
        let mut world = Stepper::new(&grid, &same(&grid, young_pa, poisson), 1000.0, 1e-3, base);
        let mut random = Random(17);
        for (place, p) in world.places.iter_mut().zip(&grid.nodes) {
            if !base(p) {
                for c in 0..3 {
                    place[c] += 0.04 * random.next();
                }
            }
        }
        let settled = settle(&mut world, 10_000, 1e-5);
        println!(
            "scrambled E {young_pa} ν {poisson}: settled {settled:?}, far {}, held back {}",
            world.farthest_m(),
            world.limited
        );
    }
}

#[test]
fn inverted_cube_recovers() {
    for poisson in [0.0, 0.3, 0.45, 0.499] {
        let grid = cuboid([1; 3], [0.01; 3]);
        let mut world = Stepper::new(&grid, &same(&grid, 20e3, poisson), 1000.0, 1e-3, base);
        world.places.iter_mut().for_each(|p| p[2] = -p[2]);
        world.places[1][0] += 1e-4;
        let settled = settle(&mut world, 10_000, 1e-6);
        println!("inverted ν {poisson}: settled {settled:?}, far {}, held back {}", world.farthest_m(), world.limited);
    }
}

#[test]
fn stiff_next_to_soft_stays_calm_and_carries_the_load() {
    for poisson in [0.3, 0.499] {
        let grid = cuboid([4; 3], [0.04; 3]);
        let materials: Vec<Elastic> = (0..64)
            .map(|k| Elastic { young_pa: if (k / 16 + k / 4 + k) % 2 == 0 { 20e3 } else { 20e9 }, poisson })
            .collect();
        let mut world = Stepper::new(&grid, &materials, 1000.0, 1e-3, base);
        let mut random = Random(3);
        for (place, p) in world.places.iter_mut().zip(&grid.nodes) {
            if !base(p) {
                for c in 0..3 {
                    place[c] += 0.002 * random.next();
                }
            }
        }
        let before = world.energy_j();
        let settled = settle(&mut world, 10_000, 1e-5);
        println!(
            "checkerboard ν {poisson}: settled {settled:?}, far {}, energy {} of {before}, held back {}",
            world.farthest_m(),
            world.energy_j(),
            world.limited
        );
    }
}

#[test]
fn squeezed_to_a_tenth_and_released_comes_back() {
    for poisson in [0.0, 0.3, 0.45, 0.499] {
        let grid = cuboid([4; 3], [0.04; 3]);
        let mut world = Stepper::new(&grid, &same(&grid, 20e3, poisson), 1000.0, 1e-3, |p| p.z == 0.0 || p.z == 0.04);
        let mut largest = 0.0f64;
        for tick in 0..2_000 {
            let height = 0.04 * (1.0 - 0.9 * (tick as f64 / 1_000.0).min(1.0));
            for (place, p) in world.places.iter_mut().zip(&grid.nodes) {
                if p.z == 0.04 {
                    place[2] = height;
                }
            }
            world.step(|_| Vector3::zeros());
            largest = largest.max(world.farthest_m());
        }
        let (held, calm) = (world.limited, world.velocities.iter().map(|v| v.norm()).fold(0.0, f64::max));
        for (place, p) in world.places.iter_mut().zip(&grid.nodes) {
            if p.z == 0.04 {
                place[2] = 0.04;
            }
        }
        let settled = settle(&mut world, 10_000, 1e-5);
        println!(
            "squeezed ν {poisson}: farthest {largest}, speed at the end {calm}, held back {held}; released: settled {settled:?}, far {}",
            world.farthest_m()
        );
    }
}

#[test]
fn shear_relaxes() {
    for poisson in [0.3, 0.45, 0.49, 0.499] {
        let grid = cuboid([4; 3], [0.04; 3]);
        let mut world = Stepper::new(&grid, &same(&grid, 20e3, poisson), 1000.0, 1e-3, base);
        for place in world.places.iter_mut() {
            place[0] += 0.1 * place[2];
        }
        let mut e = None;
        let start = world.farthest_m();
        for tick in 0..5_000 {
            world.step(|_| Vector3::zeros());
            if world.farthest_m() > start / std::f64::consts::E {
                e = None;
            } else if e.is_none() {
                e = Some(tick);
            }
        }
        println!("shear ν {poisson}: to 1/e for good at tick {e:?}, now {}", world.farthest_m() / start);
    }
}
