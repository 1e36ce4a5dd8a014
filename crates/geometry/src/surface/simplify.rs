//! Fewer control points, with a bound on what that costs: degree reduction.
//!
//! Control points are compared over common knots: by the convex-hull property no point of the
//! surface moves further than the control points differ there. With weights the difference `(A − w
//! S') / w`, where S' = A' / w', is bounded by `(max |A − A'| + max |w − w'| · max |S'|) / min w`,
//! lengths measured from the net's centre.

use super::lines::{Direction, LinePoint};
use super::tensor::{WEIGHTS, check_ratio};
use super::{Surface, SurfaceError};
use crate::basis::{BasisChange, KnotKind, KnotVector};
use crate::math::{Point3, Vector3};
use nalgebra::{DMatrix, Vector4};

/// A surface with fewer control points, and how far it may lie from the one it came from.
#[derive(Clone, Debug)]
pub struct Simplified {
    /// The new surface.
    pub surface: Surface,
    /// No point has moved by more, at equal parameters, m.
    pub error_bound: f64,
}

impl Surface {
    /// One degree lower in a direction, every knot once less (but simple knots stay): the
    /// least-squares fit of the control points over common knots, ends kept in place. An elevated
    /// surface gets back what it had.
    ///
    /// # Errors
    /// Degree 1, or weights that come out at or below 0.
    pub fn degree_reduced(&self, direction: Direction) -> Result<Simplified, SurfaceError> {
        let refused = |e| direction.refused(e);
        let knots = self.knots(direction);
        let lower = knots.reduced().map_err(refused)?;
        let raised = lower.elevation().map_err(refused)?;
        let (e, r) = (dense(&raised), dense(&knots.refinement(raised.knots())));
        // Clamped ends are points of the surface, and hold seams and poles together.
        let fixed = usize::from(knots.kind() == KnotKind::Clamped);
        let (count, free) = (lower.count(), lower.count() - 2 * fixed);
        let solver = (free > 0).then(|| e.columns(fixed, free).clone_owned().svd(true, true));
        self.simplified(direction, lower, |old| {
            let old = DMatrix::from_fn(old.len(), 4, |i, c| old[i][c]);
            let wanted = &r * &old;
            let mut new = DMatrix::zeros(count, 4);
            if fixed == 1 {
                new.set_row(0, &old.row(0));
                new.set_row(count - 1, &old.row(old.nrows() - 1));
            }
            let rest = &wanted - &e * &new;
            if let Some(solver) = &solver {
                let solved = solver
                    .solve(&rest, 1e-13)
                    .expect("both factors were asked for");
                new.rows_mut(fixed, free).copy_from(&solved);
            }
            let miss = &e * &new - wanted;
            let rows = |m: &DMatrix<f64>| {
                m.row_iter()
                    .map(|row| Homogeneous::from_fn(|c, _| row[c]))
                    .collect()
            };
            (rows(&new), rows(&miss))
        })
    }

    /// Every line replaced by `change`, which gives new points and by how much they miss the old
    /// ones over common knots.
    fn simplified(
        &self,
        direction: Direction,
        knots: KnotVector,
        change: impl Fn(&[Homogeneous]) -> (Vec<Homogeneous>, Vec<Homogeneous>),
    ) -> Result<Simplified, SurfaceError> {
        let centre = self.centre();
        let (mut moved, mut reweighted) = (0.0_f64, 0.0_f64);
        let mut fault = None;
        let surface = self.with_lines(direction, knots, |line| {
            // From a point of the line: a line that is one point, as at a pole, stays exactly that
            // point.
            let origin = line[0].0;
            let old: Vec<Homogeneous> = line
                .iter()
                .map(|point| homogeneous(point, origin))
                .collect();
            let (new, miss) = change(&old);
            for m in &miss {
                // What is missed as seen from the centre.
                let shift = (origin - centre) * m.w;
                moved = moved.max((m.xyz() + shift).norm());
                reweighted = reweighted.max(m.w.abs());
            }
            let weighted = |m: &Homogeneous| if self.weights().is_some() { m.w } else { 1.0 };
            if let Some(m) = new
                .iter()
                .find(|m| !(WEIGHTS.contains(&weighted(m)) && m.iter().all(|x| x.is_finite())))
            {
                fault.get_or_insert(weighted(m));
            }
            new.iter()
                .map(|m| (origin + m.xyz() / weighted(m), weighted(m)))
                .collect()
        });
        if let Some(value) = fault {
            return Err(SurfaceError::Unweighable { value });
        }
        if let Some(weights) = surface.weights() {
            check_ratio(weights)?;
        }
        let error_bound = match self.weights() {
            None => moved,
            Some(weights) => {
                let least = weights.iter().copied().fold(f64::INFINITY, f64::min);
                let reach = surface
                    .net()
                    .points()
                    .iter()
                    .map(|p| (p - centre).norm())
                    .fold(0.0, f64::max);
                (moved + reweighted * reach) / least
            }
        };
        Ok(Simplified {
            surface,
            error_bound,
        })
    }

    /// Mean of the control points.
    fn centre(&self) -> Point3 {
        let points = self.net().points();
        points[0]
            + points
                .iter()
                .map(|point| point - points[0])
                .sum::<Vector3>()
                / points.len() as f64
    }
}

/// (w (P − origin), w).
type Homogeneous = Vector4<f64>;

fn homogeneous((point, weight): &LinePoint, origin: Point3) -> Homogeneous {
    let from = (point - origin) * *weight;
    Homogeneous::new(from.x, from.y, from.z, *weight)
}

fn dense(change: &BasisChange) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(change.knots().count(), change.old_count());
    for row in 0..matrix.nrows() {
        for (column, weight) in change.entries(row) {
            matrix[(row, column)] += weight;
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::super::builtin::builtin;
    use super::super::testing::{fifty_surfaces, pairs};
    use super::*;
    use crate::basis::Side;
    use crate::basis::testing::Random;

    const BOTH: [Direction; 2] = [Direction::U, Direction::V];

    #[test]
    fn an_elevated_surface_is_reduced_to_what_it_was() {
        for surface in fifty_surfaces(73) {
            for direction in BOTH {
                let back = surface
                    .elevated(direction)
                    .unwrap()
                    .degree_reduced(direction)
                    .unwrap();
                assert_eq!(
                    back.surface.knots(direction).degree(),
                    surface.knots(direction).degree()
                );
                assert!(
                    back.error_bound < 1e-11,
                    "{surface:?} in {direction:?}: {}",
                    back.error_bound
                );
                if surface.knots(direction).kind() == KnotKind::Clamped {
                    let pairs = surface
                        .net()
                        .points()
                        .iter()
                        .zip(back.surface.net().points());
                    let error = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
                    assert!(
                        error < 1e-11,
                        "{surface:?} in {direction:?}: the net is {error} off"
                    );
                }
            }
        }
    }

    #[test]
    fn what_a_lower_degree_costs_stays_under_its_bound() {
        let mut random = Random(74);
        for surface in fifty_surfaces(74) {
            for direction in BOTH {
                let Ok(simple) = surface.degree_reduced(direction) else {
                    assert!(surface.knots(direction).degree() == 1 || surface.weights().is_some());
                    continue;
                };
                let parted = |knots: &KnotVector, t: f64| {
                    knots
                        .disjoined()
                        .contains(&knots.confine_from(t, Side::Right))
                };
                for (u, v) in pairs(&mut random, &surface, 5) {
                    if parted(surface.knots_u(), u) || parted(surface.knots_v(), v) {
                        continue;
                    }
                    let (error, bound) = (
                        (surface.point(u, v) - simple.surface.point(u, v)).norm(),
                        simple.error_bound,
                    );
                    assert!(
                        error <= bound * (1.0 + 1e-9) + 1e-14,
                        "{surface:?}: {error} above {bound}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_teardrop_stays_closed_with_less() {
        let drop = builtin("teardrop", None, None)
            .unwrap()
            .refined_to(12, 13)
            .unwrap();
        for direction in BOTH {
            let simple = drop.degree_reduced(direction).unwrap();
            assert_eq!(simple.surface.topology(), drop.topology());
            assert!(
                simple.error_bound < 0.1 * drop.size(),
                "{} m",
                simple.error_bound
            );
        }
    }

    #[test]
    fn no_degree_is_below_1() {
        let flat = builtin("sheet", Some([4, 4]), None).unwrap();
        let mut linear = flat;
        for _ in 0..2 {
            linear = linear.degree_reduced(Direction::U).unwrap().surface;
        }
        assert!(linear.degree_reduced(Direction::U).is_err());
    }
}
