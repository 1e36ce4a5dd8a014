//! How several rigid contacts of one tool share its force.
//!
//! A tool that only translates has three equations and any number of contacts: balance fixes the
//! sum of their forces, not each. The moment needs each. Of all shares f_i, each within its contact's cone of friction
//! (without friction a ray, of a grip anywhere), with Σ f_i = F, the one with least Σ |f_i|² / w_i is taken, w_i being
//! how deep the device is in contact i: what springs of equal stiffness under every contact would do. A contact that
//! appears begins with w = 0, so the moment does not jump.
//!
//! The minimum is f_i = w_i P_i(y), P_i being the nearest point of cone i, where y minimises ½ Σ w_i |P_i(y)|² − F · y:
//! convex in three unknowns, solved by Newton's method with the projections' derivatives.

use super::friction::FrictionLaw;
use palpate_geometry::math::{Matrix3, Vector3};

/// Rounds of Newton; each that does not end changes the set of contacts that carry.
const ROUNDS: usize = 60;
/// Stiffness given to y itself, relative to the sum of the weights. Normals that nearly lie in a
/// plane would otherwise share by how they do not; so the sum may be off by [`KEPT`] in that
/// direction.
const WHISPER: f64 = 1e-7;
/// Largest slope left, relative to the force, that counts as solved: far above rounding.
const SOLVED: f64 = 1e-9;
/// Largest change of the sum, relative to the force: far below what a hand feels.
const KEPT: f64 = 1e-4;

/// One contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Unit vector on which it pushes the tool.
    pub normal: Vector3,
    /// What force it may have.
    pub law: FrictionLaw,
    /// How deep the device is in it, m (≥ 0).
    pub weight_m: f64,
    /// Its part of the force, N.
    pub force_n: Vector3,
}

/// The point of a contact's cone nearest to y, and its derivative.
fn nearest(law: FrictionLaw, normal: &Vector3, y: &Vector3) -> (Vector3, Matrix3) {
    let FrictionLaw::Push { mu, .. } = law else {
        return (*y, Matrix3::identity());
    };
    let along = normal.dot(y);
    let across = y - normal * along;
    let size = across.norm();
    if size < mu * along {
        return (*y, Matrix3::identity());
    }
    if mu * size <= -along {
        return (Vector3::zeros(), Matrix3::zeros());
    }
    // A ray has no round, and y may lie on it.
    let direction = across / size.max(f64::MIN_POSITIVE);
    let edge = (normal + direction * mu) / (1.0 + mu * mu).sqrt();
    let reach = edge.dot(y);
    let round =
        Matrix3::identity() - normal * normal.transpose() - direction * direction.transpose();
    let lean = match mu > 0.0 {
        true => mu * reach / ((1.0 + mu * mu).sqrt() * size),
        false => 0.0,
    };
    (edge * reach, edge * edge.transpose() + round * lean)
}

/// What y minimises: its value, falling slope and second derivative.
struct Look {
    cost: f64,
    miss: Vector3,
    bend: Matrix3,
}

impl Look {
    /// Adds a contact that bears `weight_m` times `onto`, which has this derivative.
    fn add(&mut self, weight_m: f64, onto: Vector3, derivative: Matrix3) {
        self.cost += 0.5 * weight_m * onto.norm_squared();
        self.miss -= onto * weight_m;
        self.bend += derivative * weight_m;
    }
}

/// y by Newton's method; `add` adds every contact at a y. `None` when there is no force or no
/// weight to share by, or when the sum would not stay what it was to 1e-4 of itself.
fn multiplier(
    total: &Vector3,
    weights_m: f64,
    add: impl Fn(&Vector3, &mut Look),
) -> Option<Vector3> {
    let size = total.norm();
    if !(size > 0.0 && weights_m > 0.0 && size.is_finite() && weights_m.is_finite()) {
        return None;
    }
    let whisper = WHISPER * weights_m;
    let look = |y: &Vector3| {
        let cost = 0.5 * whisper * y.norm_squared() - total.dot(y);
        let mut look = Look {
            cost,
            miss: total - y * whisper,
            bend: Matrix3::identity() * whisper,
        };
        add(y, &mut look);
        look
    };
    let mut y = total / weights_m;
    let mut now = look(&y);
    for _ in 0..ROUNDS {
        if now.miss.norm() <= SOLVED * size {
            return (y.norm() * whisper <= KEPT * size).then_some(y);
        }
        let step = now.bend.cholesky()?.solve(&now.miss);
        let slope = now.miss.dot(&step);
        let mut scale = 1.0;
        loop {
            let next = y + step * scale;
            let looked = look(&next);
            // Near the end the cost is flat to rounding; the gradient still decides.
            let better = looked.cost <= now.cost - 1e-4 * scale * slope
                || looked.miss.norm() <= 0.5 * now.miss.norm();
            if better || scale < 1e-6 {
                (y, now) = (next, looked);
                break;
            }
            scale *= 0.5;
        }
    }
    None
}

/// Shares Σ force anew; the sum stays what it was to 1e-4 of itself. False, with nothing changed,
/// when weights or a grip's limit do not allow it.
pub fn share(contacts: &mut [Share]) -> bool {
    debug_assert!(
        contacts
            .iter()
            .all(|s| s.weight_m >= 0.0 || s.weight_m.is_nan()),
        "depths"
    );
    let total: Vector3 = contacts.iter().map(|c| c.force_n).sum();
    let weights: f64 = contacts.iter().map(|c| c.weight_m).sum();
    let add = |y: &Vector3, look: &mut Look| {
        for c in contacts.iter() {
            let (onto, derivative) = nearest(c.law, &c.normal, y);
            look.add(c.weight_m, onto, derivative);
        }
    };
    let force = |c: &Share, y: &Vector3| nearest(c.law, &c.normal, y).0 * c.weight_m;
    let sum = |y: &Vector3| contacts.iter().map(|c| force(c, y)).sum::<Vector3>();
    // What the stiffness of y itself took away is asked for once more.
    let again = |y: &Vector3| {
        let missing = total - sum(y);
        multiplier(&(total + missing), weights, add)
            .filter(|y| (total - sum(y)).norm() < missing.norm())
    };
    let Some(y) = multiplier(&total, weights, add) else {
        return false;
    };
    let y = again(&y).unwrap_or(y);
    let over = |c: &Share| match c.law {
        FrictionLaw::Grip { limit_n } => y.norm() * c.weight_m > limit_n,
        FrictionLaw::Push { .. } => false,
    };
    if contacts.iter().any(over) {
        return false;
    }
    for c in contacts.iter_mut() {
        c.force_n = force(c, &y);
    }
    keep_sum(contacts, &total);
    true
}

/// A grip bears what is left to the sum, in whatever direction: what it holds does not move by this
/// module's whisper.
fn keep_sum(contacts: &mut [Share], total: &Vector3) {
    let left = total - contacts.iter().map(|c| c.force_n).sum::<Vector3>();
    let grip = contacts.iter_mut().find(
        |c| matches!(c.law, FrictionLaw::Grip { limit_n } if (c.force_n + left).norm() <= limit_n),
    );
    if let Some(grip) = grip {
        grip.force_n += left;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    #[test]
    fn the_nearest_point_is_nearest_and_its_derivative_that_of_differences() {
        let mut random = Random(2);
        for case in 0..3_000 {
            let mut any = || {
                Vector3::new(
                    random.float(-0.5, 0.5),
                    random.float(-0.5, 0.5),
                    random.float(-0.5, 0.5),
                )
            };
            let (normal, y, towards) = (any().normalize(), any(), any());
            let mu = if case % 3 == 0 { 0.0 } else { 0.4 };
            let law = FrictionLaw::coulomb(mu);
            let (onto, derivative) = nearest(law, &normal, &y);
            // Moreau: y splits into a point of the cone and one of its polar, which are at right
            // angles.
            let rest = y - onto;
            assert!(onto.dot(&rest).abs() < 1e-14);
            let along = onto.dot(&normal);
            assert!((onto - normal * along).norm() <= mu * along + 1e-14);
            assert!(mu * (rest - normal * rest.dot(&normal)).norm() <= -rest.dot(&normal) + 1e-14);
            let h = 1e-7;
            let slope = (nearest(law, &normal, &(y + towards * h)).0
                - nearest(law, &normal, &(y - towards * h)).0)
                / (2.0 * h);
            let regular = (nearest(law, &normal, &(y + towards * 1e-3)).1 - derivative).norm()
                < 0.1
                && (nearest(law, &normal, &(y - towards * 1e-3)).1 - derivative).norm() < 0.1;
            assert!(
                !regular || (slope - derivative * towards).norm() < 1e-6,
                "{slope} for {}",
                derivative * towards
            );
        }
    }

    #[test]
    fn random_sets_keep_their_sum_and_cones_and_lower_their_energy() {
        let mut random = Random(11);
        let mut solved = 0;
        for case in 0..1_000 {
            let count = 2 + (random.float(-0.5, 0.5).abs() * 20.0) as usize;
            let mut set: Vec<Share> = (0..count)
                .map(|k| {
                    let normal = Vector3::new(
                        random.float(-0.5, 0.5),
                        random.float(-0.5, 0.5),
                        0.3 + random.float(-0.5, 0.5).abs(),
                    )
                    .normalize();
                    let mu = if case % 2 == 0 {
                        0.5
                    } else {
                        0.5 * random.float(-0.5, 0.5).abs()
                    };
                    let lambda = (3.0 * random.float(-0.5, 0.5)).max(0.0);
                    let across = normal
                        .cross(&Vector3::new(
                            random.float(-0.5, 0.5),
                            random.float(-0.5, 0.5),
                            random.float(-0.5, 0.5),
                        ))
                        .normalize();
                    let (law, force_n) = if case % 5 == 0 && k == 0 {
                        (
                            FrictionLaw::Grip { limit_n: 100.0 },
                            Vector3::new(
                                random.float(-0.5, 0.5),
                                random.float(-0.5, 0.5),
                                random.float(-0.5, 0.5),
                            ),
                        )
                    } else {
                        (
                            FrictionLaw::coulomb(mu),
                            (normal + across * (mu * random.float(-0.5, 0.5).abs())) * lambda,
                        )
                    };
                    Share {
                        normal,
                        law,
                        weight_m: 1e-4 + 1e-3 * random.float(-0.5, 0.5).abs(),
                        force_n,
                    }
                })
                .collect();
            let before: Vector3 = set.iter().map(|c| c.force_n).sum();
            let energy = |set: &[Share]| {
                set.iter()
                    .map(|c| c.force_n.norm_squared() / c.weight_m)
                    .sum::<f64>()
            };
            let energy_before = energy(&set);
            if share(&mut set) {
                solved += 1;
                let after: Vector3 = set.iter().map(|c| c.force_n).sum();
                assert!((after - before).norm() <= KEPT * before.norm());
                for c in &set {
                    let along = c.force_n.dot(&c.normal);
                    let across = (c.force_n - c.normal * along).norm();
                    assert!(
                        !matches!(c.law, FrictionLaw::Push { mu, .. } if across > mu * along + 1e-12)
                    );
                }
                assert!(energy(&set) <= energy_before * (1.0 + 4.0 * KEPT));
            }
        }
        assert!(solved > 950, "{solved} solved");
    }

    #[test]
    fn a_flat_contact_shares_push_and_drag_by_depth() {
        let contact = |weight_m: f64, force_n: Vector3| Share {
            normal: Vector3::z(),
            law: FrictionLaw::coulomb(0.5),
            weight_m,
            force_n,
        };
        let mut two = [
            contact(1.0, Vector3::new(2.0, 0.0, 4.0)),
            contact(3.0, Vector3::zeros()),
        ];
        assert!(share(&mut two));
        assert!(
            (two[0].force_n - Vector3::new(0.5, 0.0, 1.0)).norm() < 1e-6,
            "{}",
            two[0].force_n
        );
        assert!(
            (two[1].force_n - Vector3::new(1.5, 0.0, 3.0)).norm() < 1e-6,
            "{}",
            two[1].force_n
        );
    }

    fn contacts(given: &[([f64; 3], f64, f64)]) -> Vec<Share> {
        let share = |&(normal, weight_m, force_n): &([f64; 3], f64, f64)| Share {
            normal: Vector3::from(normal),
            law: FrictionLaw::SMOOTH,
            weight_m,
            force_n: Vector3::from(normal) * force_n,
        };
        given.iter().map(share).collect()
    }

    #[test]
    fn parallel_contacts_share_by_depth() {
        let mut three = contacts(&[
            ([0.0, 0.0, 1.0], 1.0, 4.0),
            ([0.0, 0.0, 1.0], 1.0, 0.0),
            ([0.0, 0.0, 1.0], 2.0, 0.0),
        ]);
        assert!(share(&mut three));
        let forces: Vec<f64> = three.iter().map(|c| c.force_n.z).collect();
        assert!(
            (forces[0] - 1.0).abs() + (forces[1] - 1.0).abs() + (forces[2] - 2.0).abs()
                < 4.0 * WHISPER * 4.0,
            "{forces:?}"
        );
    }

    #[test]
    fn a_contact_that_appears_begins_with_nothing() {
        for depth in [0.0, 1e-12, 1e-9, 1e-6] {
            let mut two = contacts(&[([0.0, 0.0, 1.0], 1.0, 5.0), ([0.0, 0.6, 0.8], depth, 0.0)]);
            assert!(share(&mut two));
            assert!(
                two[1].force_n.norm() <= 10.0 * depth,
                "{} N at a depth of {depth}",
                two[1].force_n
            );
        }
    }

    // The sum stays what it was, forces stay ≥ 0, and no other share seen has less energy.
    #[test]
    fn random_sets_without_friction_keep_their_sum_and_meet_the_optimum() {
        let mut state = 11u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let (mut solved, mut unsolved) = (0, 0);
        for _ in 0..2_000 {
            let count = 2 + (random().abs() * 20.0) as usize;
            let mut set: Vec<Share> = (0..count)
                .map(|_| {
                    let normal = Vector3::new(random(), random(), 0.3 + random().abs()).normalize();
                    Share {
                        normal,
                        law: FrictionLaw::SMOOTH,
                        weight_m: 1e-4 + 1e-3 * random().abs(),
                        force_n: normal * (3.0 * random()).max(0.0),
                    }
                })
                .collect();
            let before: Vector3 = set.iter().map(|c| c.force_n).sum();
            let energy = |set: &[Share]| {
                set.iter()
                    .map(|c| c.force_n.norm_squared() / c.weight_m)
                    .sum::<f64>()
            };
            let energy_before = energy(&set);
            if share(&mut set) {
                solved += 1;
                let after: Vector3 = set.iter().map(|c| c.force_n).sum();
                assert!((after - before).norm() <= KEPT * before.norm());
                for c in &set {
                    let along = c.force_n.dot(&c.normal);
                    assert!(along >= 0.0);
                    assert!((c.force_n - c.normal * along).norm() <= 1e-15 * before.norm());
                }
                assert!(energy(&set) <= energy_before * (1.0 + 4.0 * KEPT));
            } else {
                // Sums in the narrow cone of nearly parallel normals, just outside of what the
                // weights reach.
                unsolved += u32::from(before.norm() > 0.0);
            }
        }
        assert!(
            solved > 1_800 && unsolved < 10,
            "{solved} solved, {unsolved} not"
        );
    }
}
