use super::*;
use crate::solve::motions::Lever;
use palpate_geometry::math::Random;

const DT_S: f64 = 1e-3;
const EASE: f64 = 0.1;
const MU: f64 = 0.3;

/// A tower of blocks on a floor, four rows to each joint, pushed about at random.
struct Tower {
    matrix: ContactMatrix,
    motions: Motions,
    normals: Vec<Vector3>,
    /// By row: how it goes without contact, m.
    free: Vec<Vector3>,
}

impl Tower {
    fn new(random: &mut Random, blocks: usize) -> Self {
        let rows = 4 * blocks;
        let mut motions = Motions::new(rows, blocks);
        motions.begin(rows);
        let mut free_motions = Vec::new();
        for _ in 0..blocks {
            // Up to a thousand times as heavy as the others.
            let mass_kg = 0.01 * libm::exp(3.4 * (1.0 + random.unit()));
            let per_square = mass_kg / (DT_S * DT_S);
            let inertia = Matrix3::from_diagonal_element(1e-4 * per_square);
            motions.add_body((per_square, inertia));
            let fall = Vector3::new(0.0, 0.0, -9.81 * DT_S * DT_S);
            free_motions.push([fall + random.vector() * 2e-6, random.vector() * 1e-3]);
        }
        let (mut normals, mut free) = (Vec::new(), vec![Vector3::zeros(); rows]);
        for row in 0..rows {
            let (joint, corner) = (row / 4, row % 4);
            let [x, y] = [corner % 2, corner / 2].map(|side| 0.02 * side as f64 - 0.01);
            let aside = random.vector() * 1e-3;
            normals.push((Vector3::z() + random.vector() * 0.05).normalize());
            let sides = [(joint, 1.0, -0.01), (joint.wrapping_sub(1), -1.0, 0.01)];
            for (body, sign, height) in sides.into_iter().filter(|side| side.0 < blocks) {
                let arm = Vector3::new(x, y, height) + aside;
                motions.add_lever(row, Lever { body, sign, arm });
                let [along, about] = free_motions[body];
                free[row] += (along + about.cross(&arm)) * sign;
            }
        }
        let mut matrix = ContactMatrix::new(rows, 3 * rows);
        matrix.begin(normals.iter().map(|normal| (*normal, true)));
        for i in 0..rows {
            for j in 0..=i {
                for (a, b) in pairs(&motions, i, j) {
                    let (mass, inertia) = motions.inertia(a.body);
                    let ([ax, at], [bx, bt]) = (a.blocks(), b.blocks());
                    let turned = at * inertia.try_inverse().unwrap() * bt.transpose();
                    matrix.add(i, j, &(ax * bx.transpose() / *mass + turned));
                }
            }
        }
        (0..rows).for_each(|row| matrix.regularize(row, EASE));
        Self {
            matrix,
            motions,
            normals,
            free,
        }
    }

    fn problem(&self) -> ContactProblem {
        let rows = self.normals.len();
        let mut problem = ContactProblem::new(rows, 3 * rows);
        for (row, (normal, free)) in self.normals.iter().zip(&self.free).enumerate() {
            let law = FrictionLaw::Push {
                mu: MU,
                drag_n_m: 0.0,
            };
            problem.push(normal, true, law, (0.0, Vector3::zeros()));
            problem.set_free(row, free.dot(normal), free);
        }
        problem
    }

    /// How far each row goes under forces, by the motions of the bodies alone, m.
    fn displaced(&self, force_n: impl Fn(usize) -> Vector3) -> Vec<Vector3> {
        let mut loads = vec![[Vector3::zeros(); 2]; self.motions.bodies()];
        for row in 0..self.normals.len() {
            for lever in self.motions.of_row(row) {
                let pushed = force_n(row) * lever.sign;
                loads[lever.body][0] += pushed;
                loads[lever.body][1] += lever.arm.cross(&pushed);
            }
        }
        let goes = |row: usize| {
            let own = self.matrix.block(row, row) * force_n(row) * (EASE / (1.0 + EASE));
            let moved = self.motions.of_row(row).map(|lever| {
                let (mass, inertia) = self.motions.inertia(lever.body);
                let [force, moment] = loads[lever.body];
                let about = inertia.try_inverse().unwrap() * moment;
                (force / *mass + about.cross(&lever.arm)) * lever.sign
            });
            self.free[row] + own + moved.sum::<Vector3>()
        };
        (0..self.normals.len()).map(goes).collect()
    }
}

/// Levers of two rows on the same body.
fn pairs(motions: &Motions, i: usize, j: usize) -> impl Iterator<Item = (&Lever, &Lever)> {
    let own = motions.of_row(i);
    own.flat_map(move |a| motions.of_row(j).map(move |b| (a, b)))
        .filter(|(a, b)| a.body == b.body)
}

// Signorini's and Coulomb's laws, looked at with displacements that the matrix has no part in.
#[test]
fn towers_keep_the_laws_of_all_rows() {
    let mut random = Random(53);
    let (mut slipped, mut stuck, mut open) = (0, 0, 0);
    for round in 0..60 {
        let tower = Tower::new(&mut random, 1 + round % 5);
        let rows = tower.normals.len();
        let mut problem = tower.problem();
        let mut direct = Direct::new(rows, 3 * rows, tower.motions.bodies());
        problem.solve(&tower.matrix, 30);
        let coupled = Coupled {
            matrix: &tower.matrix,
            motions: &tower.motions,
        };
        let own = EASE / (1.0 + EASE);
        assert!(direct.end(&mut problem, coupled, |_| Change::Free { own }));
        assert!(direct.steps() > 0 || problem.missed() <= ENOUGH);
        let forces = (0..rows).map(|row| problem.force_n(row).norm());
        let largest_n = forces.fold(0.0, f64::max);
        for (row, moved) in tower.displaced(|i| problem.force_n(i)).iter().enumerate() {
            let normal = tower.normals[row];
            let (along_n, across_n) = (problem.normal_n(row), problem.tangent_n(row));
            let gap_m = moved.dot(&normal);
            let slip = moved - normal * gap_m;
            // As forces: what a displacement is worth to the row.
            let off_n = |m: f64| m / tower.matrix.along(row);
            let tolerance_n = 1e-7 * largest_n;
            assert!(
                along_n >= 0.0 && off_n(gap_m) > -tolerance_n,
                "{round}, {row}"
            );
            if along_n == 0.0 {
                open += 1;
                continue;
            }
            assert!(off_n(gap_m.abs()) < tolerance_n, "{round}, {row}: open");
            let most_n = MU * along_n;
            assert!(
                across_n.norm() < most_n + tolerance_n,
                "{round}, {row}: cone"
            );
            if across_n.norm() < most_n - tolerance_n {
                stuck += 1;
                assert!(off_n(slip.norm()) < tolerance_n, "{round}, {row}: slips");
            } else if off_n(slip.norm()) > tolerance_n {
                slipped += 1;
                let against = -across_n.dot(&slip) / (across_n.norm() * slip.norm());
                assert!(against > 1.0 - 1e-6, "{round}, {row}: {against}");
            }
        }
    }
    println!("{slipped} rows slip, {stuck} stick, {open} are open");
    assert!(slipped > 50 && stuck > 50 && open > 50);
}

#[test]
fn a_matrix_whose_pivot_is_rounding_has_no_inverse() {
    // The third row is the sum of the others, but for rounding.
    let mut rows = [
        0.1,
        0.7,
        0.3,
        1.0,
        0.2,
        0.1,
        0.9,
        1.0,
        0.1 + 0.2,
        0.7 + 0.1,
        0.3 + 0.9,
        1.0,
    ];
    let (mut ends, mut scales) = ([0; 3], [0.0; 3]);
    assert!(!eliminate(&mut rows, &mut ends, &mut scales));
    let mut rows = [2.0, 1.0, 3.0, 1.0, 3.0, 4.0];
    assert!(eliminate(&mut rows, &mut ends[..2], &mut scales[..2]));
    assert_eq!(
        [rows[2], rows[5]].map(|x| (x * 1e12).round() / 1e12),
        [1.0, 1.0]
    );
}
