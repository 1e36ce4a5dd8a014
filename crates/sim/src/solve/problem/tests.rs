//! The solver against its laws as they are written, and against another method.

use super::*;
use nalgebra::{DMatrix, DVector};
use palpate_geometry::math::Random;

fn empty(normals: &[Vector3]) -> ContactMatrix {
    of_kinds(normals, |_| true)
}

/// Rows whose forces have all directions, or only their normal.
fn of_kinds(normals: &[Vector3], whole: impl Fn(usize) -> bool) -> ContactMatrix {
    let mut matrix = ContactMatrix::new(normals.len(), 3 * normals.len());
    let rows = normals.iter().enumerate();
    matrix.begin(rows.map(|(i, normal)| (*normal, whole(i))));
    matrix
}

fn normals(random: &mut Random, n: usize) -> Vec<Vector3> {
    (0..n).map(|_| random.vector().normalize()).collect()
}

/// D = G Gᵀ + shift 1, with a number for each pair of rows or with blocks.
fn matrix(random: &mut Random, normals: &[Vector3], shift: f64, isotropic: bool) -> ContactMatrix {
    let mut matrix = empty(normals);
    fill(&mut [&mut matrix], random, shift, isotropic);
    matrix
}

/// The same D in several.
fn fill(matrices: &mut [&mut ContactMatrix], random: &mut Random, shift: f64, isotropic: bool) {
    let n = matrices[0].rows();
    let size = if isotropic { n } else { 3 * n };
    let g: Vec<f64> = (0..size * size).map(|_| random.float(-0.5, 0.5)).collect();
    let entry = |a: usize, b: usize| {
        let own = if a == b { shift } else { 0.0 };
        own + (0..size)
            .map(|k| g[a * size + k] * g[b * size + k])
            .sum::<f64>()
    };
    for i in 0..n {
        for j in 0..=i {
            let block = match isotropic {
                true => Matrix3::from_diagonal_element(entry(i, j)),
                false => Matrix3::from_fn(|a, b| entry(3 * i + a, 3 * j + b)),
            };
            for matrix in matrices.iter_mut() {
                match isotropic {
                    true => matrix.add_isotropic(i, j, block.m11),
                    false => matrix.add(i, j, &block),
                }
            }
        }
    }
}

fn problem(
    normals: &[Vector3],
    free: &[Vector3],
    law: impl Fn(usize) -> FrictionLaw,
) -> ContactProblem {
    of_rows(normals, free, |i| (true, law(i)))
}

fn of_rows(
    normals: &[Vector3],
    free: &[Vector3],
    row: impl Fn(usize) -> (bool, FrictionLaw),
) -> ContactProblem {
    let n = normals.len();
    let mut problem = ContactProblem::new(n, 3 * n);
    for (i, (normal, free)) in normals.iter().zip(free).enumerate() {
        let (whole, law) = row(i);
        problem.push(normal, whole, law, Default::default());
        problem.set_free(i, free.dot(normal), free);
    }
    problem
}

fn one(normal: Vector3, free: Vector3, law: FrictionLaw, own: f64) -> ContactProblem {
    let mut matrix = empty(&[normal]);
    matrix.add_isotropic(0, 0, own);
    let mut problem = problem(&[normal], &[free], |_| law);
    problem.solve(&matrix, 1);
    problem
}

#[test]
fn one_row_sticks_below_its_cone_and_slips_against_the_slip_at_its_edge() {
    for (slip, expected) in [(0.29, 0.29), (0.31, 0.3), (5.0, 0.3)] {
        let problem = one(
            Vector3::z(),
            Vector3::new(slip, 0.0, -1.0),
            FrictionLaw::coulomb(0.3),
            0.5,
        );
        assert!((problem.normal_n(0) - 2.0).abs() < 1e-15);
        assert!((problem.tangent_n(0) + Vector3::x() * (2.0 * expected)).norm() < 1e-15);
        assert_eq!(problem.slips(0), slip > 0.3);
    }
    assert_eq!(
        one(
            Vector3::z(),
            Vector3::new(1.0, 0.0, 1e-9),
            FrictionLaw::coulomb(9.0),
            0.5
        )
        .force_n(0)
        .norm(),
        0.0
    );
    let held = one(
        Vector3::z(),
        Vector3::new(3.0, 0.0, 4.0),
        FrictionLaw::Grip { limit_n: 2.0 },
        1.0,
    );
    assert!((held.force_n(0) - Vector3::new(-1.2, 0.0, -1.6)).norm() < 1e-15);
}

fn displaced(problem: &ContactProblem, matrix: &ContactMatrix, free: &[Vector3]) -> Vec<Vector3> {
    let moved = |i: usize, j: usize| matrix.block(i, j) * problem.force_n(j);
    let all = |i: usize| (0..matrix.rows()).fold(free[i], |u, j| u + moved(i, j));
    (0..matrix.rows()).map(all).collect()
}

/// How far forces and displacements are from the laws: written from the definitions, not from the
/// solver.
fn residual(problem: &ContactProblem, matrix: &ContactMatrix, free: &[Vector3]) -> f64 {
    let mut worst = 0.0f64;
    for (i, u) in displaced(problem, matrix, free).into_iter().enumerate() {
        let f = problem.force_n(i);
        let normal = problem.rows[i].normal;
        let miss = match problem.law(i) {
            FrictionLaw::Push { mu, .. } => {
                let (lambda, gap) = (f.dot(&normal), u.dot(&normal));
                let (t, slip) = (f - normal * lambda, u - normal * gap);
                // Maximal dissipation: t · u_t is the least that |t| ≤ μ λ allows.
                let dissipation = t.dot(&slip) + mu * lambda * slip.norm();
                (-lambda)
                    .max(-gap)
                    .max((lambda * gap).abs())
                    .max(t.norm() - mu * lambda)
                    .max(dissipation)
            }
            FrictionLaw::Grip { limit_n } => {
                (f.norm() - limit_n).max(f.dot(&u) + limit_n * u.norm())
            }
        };
        worst = worst.max(miss).max((problem.displaced_m(i) - u).norm());
    }
    worst
}

#[test]
fn random_problems_meet_cone_complementarity_and_maximal_dissipation() {
    let mut random = Random(5);
    for case in 0..400 {
        let n = 1 + case % 14;
        let normals = normals(&mut random, n);
        let matrix = matrix(&mut random, &normals, 0.5, case < 200);
        let free: Vec<Vector3> = (0..n).map(|_| random.vector() * 0.5).collect();
        let laws: Vec<FrictionLaw> = (0..n)
            .map(|_| match case % 3 {
                0 => FrictionLaw::coulomb(0.3),
                1 => FrictionLaw::coulomb(0.8 * random.unit()),
                _ if random.signed() > 0.0 => FrictionLaw::Grip { limit_n: 0.4 },
                _ => FrictionLaw::coulomb(0.3),
            })
            .collect();
        let mut problem = problem(&normals, &free, |i| laws[i]);
        problem.solve(&matrix, 5_000);
        let miss = residual(&problem, &matrix, &free);
        assert!(
            miss < 1e-10,
            "case {case} of {n} rows misses its laws by {miss}"
        );
    }
}

// Grips that nothing pulls out of their hold are a linear system, which a dense factor solves.
#[test]
fn grips_agree_with_a_dense_solve() {
    let mut random = Random(29);
    for case in 0..40 {
        let n = 1 + case % 14;
        let normals = normals(&mut random, n);
        let matrix = matrix(&mut random, &normals, 0.5, false);
        let free: Vec<Vector3> = (0..n).map(|_| random.vector()).collect();
        let mut problem = problem(&normals, &free, |_| FrictionLaw::Grip { limit_n: 1e9 });
        problem.solve(&matrix, 5_000);
        let dense = DMatrix::from_fn(3 * n, 3 * n, |a, b| matrix.entry(a, b));
        let load = DVector::from_fn(3 * n, |a, _| -free[a / 3][a % 3]);
        let forces = dense.cholesky().unwrap().solve(&load);
        for i in 0..n {
            let off = problem.force_n(i) - forces.fixed_rows::<3>(3 * i);
            assert!(
                off.norm() < 1e-12 * forces.norm(),
                "case {case}, row {i}: {off}"
            );
        }
    }
}

// Rows along their normals next to others: the same as if all directions of all were looked at.
#[test]
fn rows_along_their_normals_agree_with_whole_ones() {
    let mut random = Random(31);
    for case in 0..80 {
        let n = 1 + case % 14;
        let normals = normals(&mut random, n);
        let rubs = |i: usize| case >= 40 && i % 3 == 1;
        let law = |i: usize| match rubs(i) {
            true => FrictionLaw::Grip { limit_n: 0.4 },
            false => FrictionLaw::SMOOTH,
        };
        let (mut whole, mut mixed) = (empty(&normals), of_kinds(&normals, rubs));
        fill(&mut [&mut whole, &mut mixed], &mut random, 0.5, false);
        let free: Vec<Vector3> = (0..n).map(|_| random.vector()).collect();
        let mut one = problem(&normals, &free, law);
        one.solve(&whole, 5_000);
        let mut other = of_rows(&normals, &free, |i| (rubs(i), law(i)));
        other.solve(&mixed, 5_000);
        let miss = residual(&one, &whole, &free);
        assert!(miss < 1e-10, "case {case} misses its laws by {miss}");
        for i in 0..n {
            let off = one.force_n(i) - other.force_n(i);
            assert!(off.norm() < 1e-12, "case {case}, row {i}: {off}");
            assert!((one.gap_after(i) - other.gap_after(i)).abs() < 1e-12);
        }
    }
}

// As a linear complementarity problem: λ ≥ 0, u ≥ 0, λ u = 0.
#[test]
fn rows_along_their_normals_are_complementary() {
    let mut random = Random(7);
    for case in 0..40 {
        let n = 1 + case % 14;
        let normals = normals(&mut random, n);
        let mut matrix = of_kinds(&normals, |_| false);
        fill(&mut [&mut matrix], &mut random, 0.3, case % 2 == 0);
        let free: Vec<Vector3> = (0..n).map(|_| random.vector()).collect();
        let mut problem = of_rows(&normals, &free, |_| (false, FrictionLaw::SMOOTH));
        problem.solve(&matrix, 5_000);
        for i in 0..n {
            let moved = (0..n).map(|j| matrix.entry(i, j) * problem.normal_n(j));
            let gap = free[i].dot(&normals[i]) + moved.sum::<f64>();
            let force = problem.normal_n(i);
            assert!(gap > -1e-12, "row {i} is violated by {gap}");
            assert!(
                force >= 0.0 && (force * gap).abs() < 1e-12,
                "row {i}: force {force} with gap {gap}"
            );
            assert!((problem.gap_after(i) - gap).abs() < 1e-12);
            assert_eq!(problem.tangent_n(i), Vector3::zeros());
        }
    }
}

#[test]
fn one_spring_gives_stiffness_times_depth() {
    let (normal, free) = (Vector3::z(), Vector3::new(0.3, 0.0, -0.002));
    let mut matrix = of_kinds(&[normal], |_| false);
    matrix.add_isotropic(0, 0, 1.0 / 500.0);
    let mut problem = of_rows(&[normal], &[free], |_| (false, FrictionLaw::SMOOTH));
    problem.solve(&matrix, 1);
    assert_eq!(problem.normal_n(0), 1.0);
}

#[test]
fn what_nothing_can_move_bears_nothing_and_a_solution_stays() {
    let normals = [Vector3::z(); 3];
    let mut matrix = of_kinds(&normals, |_| false);
    let entries = [[2.0, 0.0, 0.5], [0.0, 0.0, 0.0], [0.5, 0.0, 1.0]];
    for i in 0..3 {
        (0..=i).for_each(|j| matrix.add_isotropic(i, j, entries[i][j]));
    }
    let solved = |warm_n: [f64; 3], sweeps: usize| {
        let mut problem = ContactProblem::new(3, 3);
        for (i, gap_m) in [-1.0, -1.0, 0.3].into_iter().enumerate() {
            let warm = (warm_n[i], Vector3::zeros());
            problem.push(&normals[i], false, FrictionLaw::SMOOTH, warm);
            problem.set_free(i, gap_m, &Vector3::zeros());
        }
        problem.solve(&matrix, sweeps);
        [0, 1, 2].map(|i| problem.normal_n(i))
    };
    let forces = solved([5.0; 3], 100);
    assert!(
        (forces[0] - 0.5).abs() < 1e-15 && forces[1..] == [0.0, 0.0],
        "{forces:?}"
    );
    assert_eq!(solved(forces, 1), forces);
}

#[test]
fn displacements_follow_a_force_that_is_replaced() {
    let mut random = Random(41);
    let normals = normals(&mut random, 9);
    let rubs = |i: usize| i % 3 == 1;
    let mut matrix = of_kinds(&normals, rubs);
    fill(&mut [&mut matrix], &mut random, 0.5, false);
    let free: Vec<Vector3> = (0..9).map(|_| random.vector()).collect();
    let law = |i: usize| match rubs(i) {
        true => FrictionLaw::coulomb(0.3),
        false => FrictionLaw::SMOOTH,
    };
    let mut problem = of_rows(&normals, &free, |i| (rubs(i), law(i)));
    problem.solve(&matrix, 50);
    for i in 0..9 {
        problem.set_force(&matrix, i, &(normals[i] * random.unit()));
    }
    let mut again = problem.clone();
    again.displaced.copy_from_slice(&again.free);
    for i in 0..9 {
        let force = &again.forces[again.rows[i].span.clone()];
        displace(&mut again.displaced, matrix.columns(i), force);
    }
    for (now, then) in problem.displaced.iter().zip(&again.displaced) {
        assert!((now - then).abs() < 1e-13);
    }
}

// The bound of a block with two numbers: it must be one, or sweeps could go up.
#[test]
fn a_row_is_no_softer_than_its_block() {
    let mut random = Random(37);
    for _ in 0..1_000 {
        let normals = normals(&mut random, 1);
        let matrix = matrix(&mut random, &normals, 1e-3, false);
        let block = matrix.block(0, 0);
        let problem = problem(&normals, &[Vector3::zeros()], |_| FrictionLaw::coulomb(0.5));
        let [along, across] = problem.rows[0]
            .bound(&matrix, 0)
            .map(|stiffness| 1.0 / stiffness);
        let push = normals[0] * normals[0].transpose();
        let bound = push * along + (Matrix3::identity() - push) * across;
        let least = (bound - block).symmetric_eigenvalues().min();
        assert!(least > -1e-12, "softer by {least}");
        assert!(along.max(across) <= 2.0 * block.symmetric_eigenvalues().max());
    }
}

// Another method: De Saxcé's reformulation turns Coulomb's law into one projection on the
// second-order cone, here in a damped fixed-point iteration over all rows at once with steps so
// small that it converges.
#[test]
fn forces_agree_with_a_slow_projection_on_de_saxces_cone() {
    let mut random = Random(11);
    for case in 0..20 {
        let (n, mu) = (2 + case % 5, 0.25);
        let normals = normals(&mut random, n);
        let matrix = matrix(&mut random, &normals, 1.0, case % 2 == 0);
        let free: Vec<Vector3> = (0..n).map(|_| random.vector() * 0.5).collect();
        let mut problem = problem(&normals, &free, |_| FrictionLaw::coulomb(mu));
        problem.solve(&matrix, 2_000);
        let mut slow = vec![Vector3::zeros(); n];
        let step = 0.5 / (0..n).map(|i| matrix.block(i, i).trace()).sum::<f64>();
        for _ in 0..60_000 {
            let mut next = slow.clone();
            for i in 0..n {
                let u = (0..n).fold(free[i], |u, j| u + matrix.block(i, j) * slow[j]);
                let slip = u - normals[i] * u.dot(&normals[i]);
                let wish = slow[i] - (u + normals[i] * (mu * slip.norm())) * step;
                let (along, across) = (
                    wish.dot(&normals[i]),
                    wish - normals[i] * wish.dot(&normals[i]),
                );
                let size = across.norm();
                next[i] = if size <= mu * along {
                    wish
                } else if mu * size <= -along {
                    Vector3::zeros()
                } else {
                    let onto = (along + mu * size) / (1.0 + mu * mu);
                    normals[i] * onto + across * (mu * onto / size)
                };
            }
            slow = next;
        }
        for (i, expected) in slow.iter().enumerate() {
            let off = (problem.force_n(i) - expected).norm();
            assert!(
                off < 1e-8,
                "case {case}, row {i}: {} for {expected}",
                problem.force_n(i)
            );
        }
    }
}

// Jams have many answers or none, some matrices are singular: forces stay finite and in their
// cones.
#[test]
fn hopeless_problems_stay_finite_and_in_their_cones() {
    let mut random = Random(3);
    for case in 0..300 {
        let n = 2 + case % 20;
        let normals = normals(&mut random, n);
        let mut matrix = match case % 4 {
            kind @ 2.. => matrix(&mut random, &normals, 0.0, kind == 2),
            _ => empty(&normals),
        };
        if case % 4 == 0 {
            for i in 0..n {
                (0..=i).for_each(|j| matrix.add_isotropic(i, j, 1e-3));
            }
        }
        let laws: Vec<FrictionLaw> = (0..n)
            .map(|_| match random.float(-0.5, 0.5) > 0.3 {
                true => FrictionLaw::Grip { limit_n: 1.0 },
                false => FrictionLaw::coulomb(10.0),
            })
            .collect();
        let free: Vec<Vector3> = (0..n).map(|_| random.vector() * 0.5).collect();
        let mut problem = problem(&normals, &free, |i| laws[i]);
        problem.solve(&matrix, 50);
        for i in 0..n {
            let (f, along) = (problem.force_n(i), problem.normal_n(i));
            assert!(f.iter().all(|x| x.is_finite()), "case {case}: {f}");
            match problem.law(i) {
                FrictionLaw::Push { mu, .. } => {
                    assert!(problem.tangent_n(i).norm() <= mu * along * (1.0 + 1e-9) + 1e-12)
                }
                FrictionLaw::Grip { limit_n } => assert!(f.norm() <= limit_n * (1.0 + 1e-15)),
            }
        }
    }
}

#[test]
fn wide_registers_give_the_same_bits() {
    let mut random = Random(17);
    for n in [1, 3, 4, 17, 60] {
        let kinds: [fn(usize) -> bool; 3] = [|_| true, |_| false, |i| i % 3 == 1];
        for rubs in kinds {
            let normals = normals(&mut random, n);
            let mut matrix = of_kinds(&normals, rubs);
            fill(&mut [&mut matrix], &mut random, 0.1, n == 4);
            let mut problem = ContactProblem::new(n, 3 * n);
            for (i, normal) in normals.iter().enumerate() {
                let law = match rubs(i) {
                    true => FrictionLaw::coulomb(0.4),
                    false => FrictionLaw::SMOOTH,
                };
                let (free, warm) = (random.vector() * 0.5, random.vector() * 0.5);
                problem.push(normal, rubs(i), law, (0.1, warm));
                problem.set_free(i, free.dot(normal), &free);
            }
            let mut plain = problem.clone();
            problem.solve(&matrix, 20);
            plain.sweep(&matrix, 20);
            assert_eq!(problem.forces, plain.forces);
            assert_eq!(problem.displaced, plain.displaced);
        }
    }
}
