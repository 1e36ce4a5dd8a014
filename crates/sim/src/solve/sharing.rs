//! How several rigid contacts of one tool share its force.
//!
//! A tool that only translates has three equations and any number of contacts: balance fixes the
//! sum of their forces, not each. The moment needs each. Of all shares λ ≥ 0 with Σ λ_i n_i = F,
//! the one with least Σ λ_i² / w_i is taken, w_i being how deep the device is in contact i: what
//! springs of equal stiffness under every contact would do. A contact that appears begins with w =
//! 0, so the moment does not jump.
//!
//! The minimum is λ_i = w_i max(0, n_i · y), where y minimises ½ Σ w_i max(0, n_i · y)² − F · y:
//! convex in three unknowns, solved by Newton's method over the set of contacts that carry.

use nalgebra::Matrix3;
use palpate_geometry::math::Vector3;

/// Rounds of Newton; each that does not end changes the set of contacts that carry.
const ROUNDS: usize = 60;
/// Stiffness given to y itself, relative to the sum of the weights. Normals that nearly lie in a
/// plane would otherwise share by how they do not; so the sum may be off by [`KEPT`] in that
/// direction.
const WHISPER: f64 = 1e-7;
/// Largest slope left, relative to the force, that counts as solved: far above rounding.
const SOLVED: f64 = 1e-9;
/// Largest change of the sum, relative to the force: far below what a hand feels.
pub(super) const KEPT: f64 = 1e-4;

/// One contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Unit vector on which it pushes the tool.
    pub normal: Vector3,
    /// How deep the device is in it, m (≥ 0).
    pub weight_m: f64,
    /// Its part of the force, N.
    pub force_n: f64,
}

/// What y minimises: its value, falling slope and second derivative.
pub(super) struct Look {
    cost: f64,
    miss: Vector3,
    bend: Matrix3<f64>,
}

impl Look {
    /// Adds a contact that bears `weight_m` times `onto`, which has this derivative.
    pub(super) fn add(&mut self, weight_m: f64, onto: Vector3, derivative: Matrix3<f64>) {
        self.cost += 0.5 * weight_m * onto.norm_squared();
        self.miss -= onto * weight_m;
        self.bend += derivative * weight_m;
    }
}

/// y by Newton's method; `add` adds every contact at a y. `None` when there is no force or no
/// weight to share by, or when the sum would not stay what it was to 1e-4 of itself.
pub(super) fn multiplier(
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
            // Near the end the cost is flat to rounding; the gradient still tells.
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

/// Shares Σ force · normal anew; the sum stays what it was to 1e-4 of itself. False, with nothing
/// changed, when weights do not allow it.
pub fn share(contacts: &mut [Share]) -> bool {
    debug_assert!(
        contacts
            .iter()
            .all(|s| s.weight_m >= 0.0 || s.weight_m.is_nan()),
        "depths"
    );
    let total: Vector3 = contacts.iter().map(|c| c.normal * c.force_n).sum();
    let weights: f64 = contacts.iter().map(|c| c.weight_m).sum();
    let add = |y: &Vector3, look: &mut Look| {
        for c in contacts.iter() {
            let along = c.normal.dot(y).max(0.0);
            look.cost += 0.5 * c.weight_m * along * along;
            look.miss -= c.normal * (c.weight_m * along);
            if along > 0.0 {
                look.bend += c.normal * c.normal.transpose() * c.weight_m;
            }
        }
    };
    let sum = |y: &Vector3| -> Vector3 {
        let push = |c: &Share| c.normal * (c.weight_m * c.normal.dot(y).max(0.0));
        contacts.iter().map(push).sum()
    };
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
    for c in contacts.iter_mut() {
        c.force_n = c.weight_m * c.normal.dot(&y).max(0.0);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contacts(given: &[([f64; 3], f64, f64)]) -> Vec<Share> {
        let share = |&(normal, weight_m, force_n)| Share {
            normal: Vector3::from(normal),
            weight_m,
            force_n,
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
        let forces: Vec<f64> = three.iter().map(|c| c.force_n).collect();
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
                two[1].force_n <= 10.0 * depth,
                "{} N at a depth of {depth}",
                two[1].force_n
            );
        }
    }

    // The sum stays what it was, forces stay ≥ 0, and no other share seen has less energy.
    #[test]
    fn random_sets_keep_their_sum_and_meet_the_optimum() {
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
                        weight_m: 1e-4 + 1e-3 * random().abs(),
                        force_n: (3.0 * random()).max(0.0),
                    }
                })
                .collect();
            let before: Vector3 = set.iter().map(|c| c.normal * c.force_n).sum();
            let energy = |set: &[Share]| {
                set.iter()
                    .map(|c| c.force_n * c.force_n / c.weight_m)
                    .sum::<f64>()
            };
            let energy_before = energy(&set);
            if share(&mut set) {
                solved += 1;
                let after: Vector3 = set.iter().map(|c| c.normal * c.force_n).sum();
                assert!((after - before).norm() <= KEPT * before.norm());
                assert!(set.iter().all(|c| c.force_n >= 0.0));
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
