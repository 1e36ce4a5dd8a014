//! How several rigid contacts of one tool share a force with friction and grips: [`super::sharing`]
//! for forces that have three components.
//!
//! Of all shares f_i, each within its contact's cone of friction (a grip: anywhere), with Σ f_i =
//! F, the one with least Σ |f_i|² / w_i: f_i = w_i P_i(y), P_i being the nearest point of cone i,
//! where y minimises ½ Σ w_i |P_i(y)|² − F · y. Convex in three unknowns; Newton's method with the
//! projections' derivatives. Without friction a cone is a ray, and this is the other module's
//! formula.

use super::friction::FrictionLaw;
use super::sharing::{Look, multiplier};
use palpate_geometry::math::{Matrix3, Vector3};

/// One contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeShare {
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
    if size <= mu * along {
        return (*y, Matrix3::identity());
    }
    if mu * size <= -along {
        return (Vector3::zeros(), Matrix3::zeros());
    }
    let direction = across / size;
    let edge = (normal + direction * mu) / (1.0 + mu * mu).sqrt();
    let reach = edge.dot(y);
    let round =
        Matrix3::identity() - normal * normal.transpose() - direction * direction.transpose();
    let lean = mu * reach / ((1.0 + mu * mu).sqrt() * size);
    (edge * reach, edge * edge.transpose() + round * lean)
}

/// Shares Σ force anew; the sum stays what it was to 1e-4 of itself. False, with nothing changed,
/// when weights or a grip's limit do not allow it.
pub fn share(contacts: &mut [ConeShare]) -> bool {
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
    let Some(y) = multiplier(&total, weights, add) else {
        return false;
    };
    let over = |c: &ConeShare| match c.law {
        FrictionLaw::Grip { limit_n } => y.norm() * c.weight_m > limit_n,
        FrictionLaw::Push { .. } => false,
    };
    if contacts.iter().any(over) {
        return false;
    }
    for c in contacts.iter_mut() {
        c.force_n = nearest(c.law, &c.normal, &y).0 * c.weight_m;
    }
    keep_sum(contacts, &total);
    true
}

/// A grip bears what is left to the sum, in whatever direction: what it holds does not move by this
/// module's whisper.
fn keep_sum(contacts: &mut [ConeShare], total: &Vector3) {
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
    use super::super::sharing::KEPT;
    use super::*;
    use palpate_geometry::math::Random;

    #[test]
    fn the_nearest_point_is_nearest_and_its_derivative_that_of_differences() {
        let mut random = Random(2);
        for _ in 0..2_000 {
            let mut any = || {
                Vector3::new(
                    random.float(-0.5, 0.5),
                    random.float(-0.5, 0.5),
                    random.float(-0.5, 0.5),
                )
            };
            let (normal, y, towards) = (any().normalize(), any(), any());
            let law = FrictionLaw::coulomb(0.4);
            let (onto, derivative) = nearest(law, &normal, &y);
            // Moreau: y splits into a point of the cone and one of its polar, which are at right
            // angles.
            let rest = y - onto;
            assert!(onto.dot(&rest).abs() < 1e-14);
            let along = onto.dot(&normal);
            assert!((onto - normal * along).norm() <= 0.4 * along + 1e-14);
            assert!(0.4 * (rest - normal * rest.dot(&normal)).norm() <= -rest.dot(&normal) + 1e-14);
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
            let mut set: Vec<ConeShare> = (0..count)
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
                    ConeShare {
                        normal,
                        law,
                        weight_m: 1e-4 + 1e-3 * random.float(-0.5, 0.5).abs(),
                        force_n,
                    }
                })
                .collect();
            let before: Vector3 = set.iter().map(|c| c.force_n).sum();
            let energy = |set: &[ConeShare]| {
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
        let contact = |weight_m: f64, force_n: Vector3| ConeShare {
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
}
