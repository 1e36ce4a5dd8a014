//! The solver against its laws as they are written, and against another method.

use super::*;
use palpate_geometry::math::Random;

/// S = G Gᵀ + shift 1.
fn matrix(random: &mut Random, n: usize, shift: f64) -> Vec<f64> {
    let g: Vec<f64> = (0..n * n).map(|_| random.float(-0.5, 0.5)).collect();
    let entry = |i: usize, j: usize| (0..n).map(|k| g[i * n + k] * g[j * n + k]).sum::<f64>();
    let both = |k: usize| entry(k / n, k % n) + if k / n == k % n { shift } else { 0.0 };
    (0..n * n).map(both).collect()
}

fn one(normal: Vector3, free: Vector3, law: FrictionLaw, own: f64) -> FrictionProblem {
    let mut problem = FrictionProblem::new(1, 8, 0, 0);
    problem.push(&normal, &free, law, &Vector3::zeros());
    problem.solve(&[own], 1);
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

/// How far forces and displacements are from the laws: written from the definitions, not from the
/// solver.
fn residual(problem: &FrictionProblem, matrix: &[f64], free: &[Vector3]) -> f64 {
    let n = free.len();
    let mut worst = 0.0f64;
    for i in 0..n {
        let u = (0..n).fold(free[i], |u, j| u + problem.force_n(j) * matrix[i * n + j]);
        let f = problem.force_n(i);
        let normal = problem.normal(i);
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
        worst = worst.max(miss);
    }
    worst
}

#[test]
fn random_problems_meet_cone_complementarity_and_maximal_dissipation() {
    let mut random = Random(5);
    for case in 0..200 {
        let n = 1 + case % 14;
        let matrix = matrix(&mut random, n, 0.5);
        let free: Vec<Vector3> = (0..n).map(|_| random.vector() * 0.5).collect();
        let mut problem = FrictionProblem::new(n, 8, 0, 0);
        for b in &free {
            let normal = (random.vector() * 0.5).normalize();
            let law = match case % 3 {
                0 => FrictionLaw::coulomb(0.3),
                1 => FrictionLaw::coulomb(0.8 * (random.float(-0.5, 0.5) + 0.5)),
                _ if random.float(-0.5, 0.5) > 0.0 => FrictionLaw::Grip { limit_n: 0.4 },
                _ => FrictionLaw::coulomb(0.3),
            };
            problem.push(&normal, b, law, &Vector3::zeros());
        }
        problem.solve(&matrix, 5_000);
        let miss = residual(&problem, &matrix, &free);
        assert!(
            miss < 1e-10,
            "case {case} of {n} rows misses its laws by {miss}"
        );
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
        let matrix = matrix(&mut random, n, 1.0);
        let free: Vec<Vector3> = (0..n).map(|_| random.vector() * 0.5).collect();
        let normals: Vec<Vector3> = (0..n)
            .map(|_| (random.vector() * 0.5).normalize())
            .collect();
        let mut problem = FrictionProblem::new(n, 8, 0, 0);
        for (normal, b) in normals.iter().zip(&free) {
            problem.push(normal, b, FrictionLaw::coulomb(mu), &Vector3::zeros());
        }
        problem.solve(&matrix, 2_000);
        let mut slow = vec![Vector3::zeros(); n];
        let step = 0.5 / (0..n).map(|i| matrix[i * n + i]).sum::<f64>();
        for _ in 0..60_000 {
            let mut next = slow.clone();
            for i in 0..n {
                let u = (0..n).fold(free[i], |u, j| u + slow[j] * matrix[i * n + j]);
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
        let matrix = match case % 3 {
            0 => vec![1e-3; n * n],
            1 => vec![0.0; n * n],
            _ => matrix(&mut random, n, 0.0),
        };
        let mut problem = FrictionProblem::new(n, 8, 0, 0);
        for _ in 0..n {
            let law = if random.float(-0.5, 0.5) > 0.3 {
                FrictionLaw::Grip { limit_n: 1.0 }
            } else {
                FrictionLaw::coulomb(10.0)
            };
            problem.push(
                &(random.vector() * 0.5).normalize(),
                &(random.vector() * 0.5),
                law,
                &Vector3::zeros(),
            );
        }
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
        let matrix = matrix(&mut random, n, 0.1);
        let mut problem = FrictionProblem::new(n, 8, 0, 0);
        for _ in 0..n {
            let law = FrictionLaw::coulomb(0.4);
            problem.push(
                &(random.vector() * 0.5).normalize(),
                &(random.vector() * 0.5),
                law,
                &(random.vector() * 0.5),
            );
        }
        let mut plain = problem.clone();
        problem.solve(&matrix, 20);
        plain.sweep(&matrix, 20);
        for i in 0..n {
            assert_eq!(problem.force_n(i), plain.force_n(i));
            assert_eq!(problem.displaced_m(i), plain.displaced_m(i));
        }
    }
}
