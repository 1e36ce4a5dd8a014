//! Energy, forces and second derivatives against each other, and the laws they keep.

use super::*;
use palpate_geometry::math::Rotation;

/// Random states up to a strain of about `amount`, cells not folded.
fn strained(grid: &CellGrid, length_m: f64, amount: f64, seed: u64) -> Vec<Lane> {
    let mut random = Random(seed);
    let points: Vec<Point3> = grid
        .nodes
        .iter()
        .map(|p| p + random.vector() * (0.25 * amount * length_m))
        .collect();
    lanes(&points)
}

fn largest(forces: &[Vector3]) -> f64 {
    forces.iter().map(|f| f.amax()).fold(0.0, f64::max)
}

#[test]
fn force_is_minus_the_gradient_of_energy() {
    for (name, grid, length_m) in samples() {
        for (seed, poisson) in [(1, 0.0), (2, 0.3), (3, 0.45)] {
            let solid = uniform(&grid, 20e3, poisson);
            let mut places = strained(&grid, length_m, 0.07, seed);
            let force = solid.forces(&places);
            let scale = largest(&force);
            let step = 1e-5 * length_m;
            for node in (0..places.len()).step_by(3) {
                for c in 0..3 {
                    // Fourth order: the error is (step / length)^4, far below the rounding of the
                    // energies.
                    let mut difference = 0.0;
                    for (shift, factor) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
                        let kept = places[node][c];
                        places[node][c] = kept + shift * step;
                        difference += factor * solid.energy_j(&places) / (12.0 * step);
                        places[node][c] = kept;
                    }
                    let error = (force[node][c] + difference).abs();
                    assert!(
                        error < 1e-7 * scale,
                        "{name}, ν = {poisson}, node {node}: {error} N of {scale} N"
                    );
                }
            }
        }
    }
}

#[test]
fn hessian_is_minus_the_gradient_of_force() {
    for (name, grid, length_m) in samples() {
        for (seed, poisson) in [(1, 0.0), (2, 0.3), (3, 0.45)] {
            let solid = uniform(&grid, 20e3, poisson);
            let mut places = strained(&grid, length_m, 0.07, seed);
            let n = 3 * places.len();
            let mut hessian = vec![0.0; n * n];
            solid.add_hessian(&places, false, &mut |row, column, value| {
                hessian[row * n + column] += value
            });
            let scale = hessian.iter().fold(0.0f64, |a, b| a.max(b.abs()));
            let step = 1e-4 * length_m;
            for column in (0..n).step_by(7) {
                let (node, c) = (column / 3, column % 3);
                let mut slope = vec![0.0; n];
                for (shift, factor) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
                    let kept = places[node][c];
                    places[node][c] = kept + shift * step;
                    let force = solid.forces(&places);
                    places[node][c] = kept;
                    for row in 0..n {
                        slope[row] -= factor * force[row / 3][row % 3] / (12.0 * step);
                    }
                }
                for row in 0..n {
                    let error = (hessian[row * n + column] - slope[row]).abs();
                    assert!(
                        error < 1e-9 * scale,
                        "{name}, ν = {poisson}, ({row}, {column}): {error} of {scale}"
                    );
                    assert!(
                        (hessian[row * n + column] - hessian[column * n + row]).abs()
                            <= 1e-15 * scale,
                        "symmetry"
                    );
                }
            }
        }
    }
}

#[test]
fn definite_hessian_has_no_negative_eigenvalues_and_is_the_hessian_where_that_has_none() {
    let grid = cuboid([1, 1, 1], [0.01; 3]);
    let solid = uniform(&grid, 20e3, 0.3);
    let matrix = |places: &[Lane], definite: bool| {
        let mut matrix = nalgebra::DMatrix::<f64>::zeros(24, 24);
        solid.add_hessian(places, definite, &mut |i, j, value| matrix[(i, j)] += value);
        matrix
    };
    let flat: Vec<Lane> = grid
        .nodes
        .iter()
        .map(|p| [p.x, p.y, -0.5 * p.z, 0.0])
        .collect();
    let (raw, kept) = (
        matrix(&flat, false).symmetric_eigenvalues(),
        matrix(&flat, true).symmetric_eigenvalues(),
    );
    assert!(
        raw.min() < -0.01 * raw.max(),
        "an inverted cell should have directions of release: {}",
        raw.min()
    );
    assert!(kept.min() > -1e-13 * kept.max() && (kept.max() / raw.max() - 1.0).abs() < 1e-12);
    let rest = lanes(&grid.nodes);
    assert!(
        (matrix(&rest, true) - matrix(&rest, false)).amax() <= 1e-12 * matrix(&rest, false).amax()
    );
}

#[test]
fn rest_has_no_energy_and_no_force_to_rounding() {
    for (name, grid, length_m) in samples() {
        for poisson in [0.0, 0.3, 0.49, 0.499] {
            let solid = uniform(&grid, 20e3, poisson);
            let places = lanes(&grid.nodes);
            let force = solid.forces(&places);
            // Sums of a few hundred terms of λ' h² and λ' h³.
            let modulus = 20e3 / (1.0 - 2.0 * poisson);
            let (force, energy) = (largest(&force), solid.energy_j(&places));
            assert!(
                force < 1e-14 * modulus * length_m.powi(2),
                "{name}, ν = {poisson}: {force} N"
            );
            assert!(
                energy.abs() < 1e-14 * modulus * length_m.powi(3),
                "{name}, ν = {poisson}: {energy} J"
            );
        }
    }
}

#[test]
fn turning_and_moving_the_solid_turns_its_forces_and_keeps_its_energy() {
    let turn = Rotation::from_euler_angles(0.7, -2.1, 0.4);
    for (name, grid, length_m) in samples() {
        let solid = uniform(&grid, 20e3, 0.4);
        let places = strained(&grid, length_m, 0.5, 9);
        let moved: Vec<Point3> = places
            .iter()
            .map(|p| turn * Point3::new(p[0], p[1], p[2]) + Vector3::new(0.05, -0.02, 0.03))
            .collect();
        let here = solid.forces(&places);
        let there = solid.forces(&lanes(&moved));
        let scale = largest(&here);
        for (a, b) in here.iter().zip(&there) {
            assert!(
                (turn * a - b).norm() < 1e-12 * scale,
                "{name}: {a} became {b}"
            );
        }
        let (a, b) = (solid.energy_j(&places), solid.energy_j(&lanes(&moved)));
        assert!((a / b - 1.0).abs() < 1e-12, "{name}: {a} J became {b} J");
    }
}

// A pressure acts on the cell's own volume, whose gradient has neither sum nor moment.
#[test]
fn forces_have_no_sum_and_no_moment_however_wild_the_state() {
    for (name, grid, length_m) in samples() {
        for amount in [0.05, 10.0, 1e3] {
            let solid = uniform(&grid, 20e3, 0.45);
            let places = strained(&grid, length_m, amount, 4);
            let force = solid.forces(&places);
            let far = places
                .iter()
                .flat_map(|p| p.iter().map(|x| x.abs()))
                .fold(0.0, f64::max);
            let size: f64 = force.iter().map(|f| f.norm()).sum();
            let sum: Vector3 = force.iter().sum();
            let moment: Vector3 = places
                .iter()
                .zip(&force)
                .map(|(p, f)| Vector3::new(p[0], p[1], p[2]).cross(f))
                .sum();
            assert!(
                sum.norm() < 1e-13 * size,
                "{name} at {amount}: sum {sum} of {size} N"
            );
            assert!(
                moment.norm() < 1e-13 * size * far,
                "{name} at {amount}: moment {moment}"
            );
        }
    }
}

// F = I_C at every Gauss point of every cell, so the energy has a closed form for any linear map.
#[test]
fn energy_of_a_linear_map_is_the_formula_times_the_volume() {
    let map = nalgebra::Matrix3::new(1.1, 0.2, -0.1, 0.05, 0.9, 0.15, -0.2, 0.1, 1.2);
    for (name, grid, _) in samples() {
        let solid = uniform(&grid, 20e3, 0.3);
        let places = lanes(&grid.nodes.iter().map(|p| map * p).collect::<Vec<_>>());
        let (shear, lame) = (20e3 / 2.6, 20e3 * 0.3 / (1.3 * 0.4));
        let (invariant, grown) = (map.norm_squared(), map.determinant() - 1.0);
        let density = 2.0 / 3.0 * shear * (invariant - 3.0 - ((invariant + 1.0) / 4.0).ln())
            + 0.5 * (lame + 5.0 / 6.0 * shear) * grown * grown
            - shear * grown;
        let expected = density * grid.quality().volume_m3;
        let energy = solid.energy_j(&places);
        assert!(
            (energy / expected - 1.0).abs() < 1e-12,
            "{name}: {energy} J, not {expected} J"
        );
    }
}

#[cfg(target_arch = "x86_64")]
#[test]
fn wide_forces_have_the_bits_of_the_baseline() {
    if !std::arch::is_x86_feature_detected!("avx2") {
        return;
    }
    for (name, grid, length_m) in samples() {
        for amount in [0.0, 0.3, 10.0, 1e30, 1e90] {
            let solid = uniform(&grid, 20e3, 0.45);
            let places = strained(&grid, length_m, amount, 11);
            let (mut slow, mut fast) = (vec![[0.5; 4]; places.len()], vec![[0.5; 4]; places.len()]);
            add_forces::<Baseline>(&solid, &[], None, &places, &mut slow);
            // SAFETY: the processor has AVX2, asked above.
            #[allow(unsafe_code)]
            unsafe {
                add_forces_avx2(&solid, &[], None, &places, &mut fast);
            }
            for (a, b) in slow.iter().flatten().zip(fast.iter().flatten()) {
                assert!(
                    a.is_finite() && a.to_bits() == b.to_bits(),
                    "{name} at {amount}: {a} is not {b}"
                );
            }
        }
    }
}

#[test]
fn what_is_no_solid_is_refused_with_its_figures() {
    let grid = cuboid([2, 2, 2], [0.02; 3]);
    for (young_pa, poisson) in [
        (0.0, 0.3),
        (-1.0, 0.3),
        (f64::NAN, 0.3),
        (1.0, 0.5),
        (1.0, -0.1),
        (1.0, f64::NAN),
    ] {
        let mut materials = vec![
            Elastic {
                young_pa: 1e4,
                poisson: 0.3
            };
            8
        ];
        materials[5] = Elastic { young_pa, poisson };
        assert!(matches!(
            ContinuumLaw::new(&grid, &materials),
            Err(ContinuumError::Material { cell: 5, .. })
        ));
    }
    let materials = [Elastic {
        young_pa: 1e4,
        poisson: 0.3,
    }; 8];
    assert!(matches!(
        ContinuumLaw::new(&grid, &materials[1..]),
        Err(ContinuumError::Count {
            materials: 7,
            cells: 8
        })
    ));
    // Leaning a cube until its edges meet at 10°: scaled Jacobian sin 10° = 0.17.
    let mut leaning = grid.clone();
    let slope = 1.0 / 10f64.to_radians().tan();
    leaning.nodes.iter_mut().for_each(|p| p.x += slope * p.z);
    let Err(ContinuumError::Distorted {
        count: 8,
        total: 8,
        quality,
        ..
    }) = ContinuumLaw::new(&leaning, &materials)
    else {
        panic!("leaning cells were let in");
    };
    assert!(
        (quality - 10f64.to_radians().sin()).abs() < 1e-12,
        "{quality}"
    );
    // One node pushed through the cell's far face.
    let mut folded = grid;
    folded.nodes[13] = Point3::new(0.025, 0.025, 0.025);
    assert!(matches!(
        ContinuumLaw::new(&folded, &materials),
        Err(ContinuumError::Distorted { .. })
    ));
}
