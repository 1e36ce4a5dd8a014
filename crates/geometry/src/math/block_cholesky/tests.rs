//! Solutions against a dense factor, and the same bits with any registers.

use super::*;
use crate::math::{Random, Vector3};
use nalgebra::{DMatrix, DVector};

/// Springs between neighbours of a box of nodes, diagonals too, and a little mass.
fn lattice(side: usize, mass: f64) -> (BlockTriplets, DMatrix<f64>) {
    let n = side * side * side;
    let (mut sparse, mut dense) = (BlockTriplets::new(n), DMatrix::zeros(3 * n, 3 * n));
    let mut random = Random(7);
    let mut add = |i: usize, j: usize, block: Matrix3| {
        sparse.add(i, j, block);
        for r in 0..3 {
            for c in 0..3 {
                dense[(3 * i + r, 3 * j + c)] += block[(r, c)];
                if i != j {
                    dense[(3 * j + c, 3 * i + r)] += block[(r, c)];
                }
            }
        }
    };
    let index = |x: usize, y: usize, z: usize| (x * side + y) * side + z;
    for x in 0..side {
        for y in 0..side {
            for z in 0..side {
                let i = index(x, y, z);
                add(i, i, Matrix3::identity() * mass);
                let near = [
                    (1, 0, 0),
                    (0, 1, 0),
                    (0, 0, 1),
                    (1, 1, 0),
                    (0, 1, 1),
                    (1, 0, 1),
                ];
                for (dx, dy, dz) in near {
                    if x + dx < side && y + dy < side && z + dz < side {
                        let j = index(x + dx, y + dy, z + dz);
                        let way =
                            Vector3::new(dx as f64, dy as f64, dz as f64) + random.vector() * 0.1;
                        let block = way * way.transpose() * (1.0 + random.float(0.0, 1.0));
                        add(i, i, block);
                        add(j, j, block);
                        add(i, j, -block);
                    }
                }
            }
        }
    }
    (sparse, dense)
}

fn random_load(n: usize, scale: f64, random: &mut Random) -> Vec<Lane> {
    (0..n)
        .map(|_| {
            let v = random.vector() * scale;
            [v.x, v.y, v.z, 0.0]
        })
        .collect()
}

fn flat(lanes: &[Lane]) -> DVector<f64> {
    let numbers = lanes.iter().flat_map(|lane| lane[..3].to_vec());
    DVector::from_iterator(3 * lanes.len(), numbers)
}

#[test]
fn blocks_are_solved_as_a_dense_matrix_is() {
    for (side, mass) in [(1, 1.0), (2, 0.3), (5, 0.3), (6, 3.0)] {
        let (sparse, dense) = lattice(side, mass);
        let factor = build::factor(&sparse, &[], usize::MAX).unwrap().unwrap();
        assert_eq!(factor.bits(), 32);
        let oracle = dense.cholesky().unwrap();
        let mut random = Random(11);
        for scale in [1.0, 1e-30, 1e30] {
            let mut x = random_load(sparse.n, scale, &mut random);
            let expected = oracle.solve(&flat(&x));
            factor.solve(&mut x, &mut factor.work());
            // Single precision times a condition of about a hundred.
            let off = (flat(&x) - &expected).amax() / expected.amax();
            assert!(off < 2e-5, "{} nodes: off by {off}", sparse.n);
        }
    }
}

#[test]
fn a_halved_factor_misses_no_motion_by_more_than_it_says() {
    for (side, mass) in [(2, 0.3), (5, 0.3), (6, 3.0)] {
        let (sparse, dense) = lattice(side, mass);
        let factor = BlockCholesky::new(&sparse).unwrap();
        assert_eq!(factor.bits(), 16);
        let error = build::worst_error(&sparse, &factor);
        assert!(error > 1e-6 && error <= HALF_ERROR, "{error}");
        // Refinement gains that factor in every round, in the norm of the scaled coordinates.
        let mut random = Random(5);
        let load = random_load(sparse.n, 1.0, &mut random);
        let exact = dense.clone().cholesky().unwrap().solve(&flat(&load));
        let mut x = DVector::zeros(3 * sparse.n);
        let mut work = factor.work();
        for round in 1..=3 {
            let left = flat(&load) - &dense * &x;
            let mut step: Vec<Lane> = (left.as_slice().chunks_exact(3))
                .map(|v| [v[0], v[1], v[2], 0.0])
                .collect();
            factor.solve(&mut step, &mut work);
            x += flat(&step);
            let off = (&x - &exact).norm() / exact.norm();
            // The diagonal differs by less than three from node to node.
            let bound = 3.0 * HALF_ERROR.powi(round);
            assert!(off < bound, "round {round}: off by {off}");
        }
    }
}

#[test]
fn a_matrix_too_stiff_for_half_precision_is_kept_in_single() {
    let (sparse, _) = lattice(6, 1e-5);
    let factor = BlockCholesky::new(&sparse).unwrap();
    assert_eq!(factor.bits(), 32);
    assert!(build::worst_error(&sparse, &factor) < HALF_ERROR);
}

#[test]
fn no_load_moves_nothing_and_an_indefinite_matrix_is_refused() {
    let (sparse, _) = lattice(3, 1.0);
    let factor = BlockCholesky::new(&sparse).unwrap();
    let mut x = vec![[0.0, 0.0, 0.0, 5.0]; sparse.n];
    factor.solve(&mut x, &mut factor.work());
    assert!(x.iter().all(|lane| *lane == [0.0; 4]));
    let mut worse = sparse.clone();
    worse.add(4, 4, Matrix3::identity() * -100.0);
    let error = BlockCholesky::new(&worse).unwrap_err();
    assert!(matches!(error, CholeskyError::Pivot { .. }), "{error}");
}

#[test]
#[cfg(target_arch = "x86_64")]
fn wide_registers_and_the_baseline_have_the_same_bits() {
    if !std::arch::is_x86_feature_detected!("avx2") || !std::arch::is_x86_feature_detected!("f16c")
    {
        eprintln!("skipped: this processor has no AVX2 and F16C");
        return;
    }
    let (sparse, _) = lattice(6, 0.5);
    for factor in [
        build::factor(&sparse, &[], usize::MAX).unwrap().unwrap(),
        BlockCholesky::new(&sparse).unwrap(),
    ] {
        let mut wide = factor.work();
        for (k, x) in wide.x[0].iter_mut().enumerate() {
            *x = 1.0 / (1.0 + k as f32);
        }
        let mut plain = wide.clone();
        // SAFETY: asked just above.
        #[allow(unsafe_code)]
        match &factor.below {
            Below::Single(below) => {
                factor.solve_in::<_, BaselineEight, 1>(below, &mut plain);
                unsafe { solve_wide(&factor, below, &mut wide) };
            }
            Below::Half(below) => {
                factor.solve_in::<_, BaselineEight, 1>(below, &mut plain);
                unsafe { solve_wide(&factor, below, &mut wide) };
            }
        }
        let bits = |work: &BlockWork| work.x[0].iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&plain), bits(&wide));
    }
}

#[test]
fn right_hand_sides_together_have_the_bits_of_each_alone() {
    let mut random = Random(7);
    for stiff in [0.5, 1e9] {
        let (sparse, _) = lattice(5, stiff);
        let factor = BlockCholesky::new(&sparse).unwrap();
        let mut loads = [1.0, 1e-200, 0.0].map(|scale| random_load(sparse.n, scale, &mut random));
        // A load on one node leaves most of the way down at rest.
        loads[1]
            .iter_mut()
            .skip(1)
            .for_each(|lane| *lane = [0.0; 4]);
        let mut together = loads.clone();
        factor.solve_all(
            together.each_mut().map(|b| &mut b[..]),
            &mut factor.work_of(),
        );
        for (mut alone, together) in loads.into_iter().zip(together) {
            factor.solve(&mut alone, &mut factor.work());
            assert_eq!(alone, together);
        }
    }
}
