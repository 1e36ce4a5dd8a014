//! Fewer control points, with a bound on what that costs: knot removal and degree reduction.
//!
//! Both compare control points over common knots: by the convex-hull property no point of the
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
    /// One copy of an interior knot less. Of all nets over the remaining knots the one whose
    /// control points, with the knot put back, miss the old ones least.
    ///
    /// # Errors
    /// Not a knot inside the domain, too few control points left, or weights that come out at or
    /// below 0.
    pub fn knot_removed(
        &self,
        direction: Direction,
        knot: f64,
    ) -> Result<Simplified, SurfaceError> {
        let fewer = self
            .knots(direction)
            .without(knot)
            .map_err(|e| direction.refused(e))?;
        let insertion = fewer.insertion(knot).map_err(|e| direction.refused(e))?;
        let chain = RemovalChain::new(&insertion.alphas);
        let first = insertion.first;
        self.simplified(direction, fewer.clone(), |old| {
            let (count, degree) = (old.len(), insertion.alphas.len());
            let window: Vec<Homogeneous> = (0..degree + 2)
                .map(|k| old[(first + count + k - 1) % count])
                .collect();
            let (inner, miss) = chain.solve(&window);
            // The points that the knot had made give way to those it was made of.
            let mut points = old.to_vec();
            if fewer.is_periodic() {
                points.rotate_left(first % count);
                points.splice(..degree, inner);
                points.rotate_right(first % (count - 1));
            } else {
                points.splice(first..first + degree, inner);
            }
            (points, miss)
        })
    }

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

/// The equations `Q_k = (1 − α_k) P_{k−1} + α_k P_k`, k < degree, for the points before an
/// insertion: one more than unknowns.
struct RemovalChain<'a> {
    alphas: &'a [f64],
    /// What is orthogonal to all that an insertion can make, its absolute values adding up to 1.
    across: Vec<f64>,
}

impl<'a> RemovalChain<'a> {
    fn new(alphas: &'a [f64]) -> Self {
        let mut across = vec![1.0];
        for pair in alphas.windows(2) {
            let last = across[across.len() - 1];
            across.push(-last * pair[0] / (1.0 - pair[1]));
            // Uneven knots make the ratios large; only ratios matter.
            let largest = across.iter().fold(0.0_f64, |a, n| a.max(n.abs()));
            across.iter_mut().for_each(|n| *n /= largest);
        }
        let sum: f64 = across.iter().map(|n| n.abs()).sum();
        across.iter_mut().for_each(|n| *n /= sum);
        Self { alphas, across }
    }

    /// From Q_{−1} ..= Q_degree, the ends of which an insertion does not move: P_0 .. P_{degree −
    /// 1} without the last, and by how much the insertion of the knot then misses each Q. The
    /// largest miss is the least that can be.
    fn solve(&self, q: &[Homogeneous]) -> (Vec<Homogeneous>, Vec<Homogeneous>) {
        let (alphas, p) = (self.alphas, self.alphas.len());
        let (before, after) = (q[0], q[p + 1]);
        let mut off: Homogeneous = self.across.iter().zip(&q[1..]).map(|(n, q)| q * *n).sum();
        off -= before * (self.across[0] * (1.0 - alphas[0]))
            + after * (self.across[p - 1] * alphas[p - 1]);
        let miss: Vec<Homogeneous> = self
            .across
            .iter()
            .map(|n| {
                if *n == 0.0 {
                    Homogeneous::zeros()
                } else {
                    off * n.signum()
                }
            })
            .collect();
        let fitted: Vec<Homogeneous> = q[1..=p]
            .iter()
            .zip(&miss)
            .map(|(q, miss)| q - miss)
            .collect();
        // From either side, each time dividing by the larger share; α falls with k.
        let forward = alphas
            .iter()
            .take(p - 1)
            .take_while(|alpha| **alpha >= 0.5)
            .count();
        let mut inner = vec![Homogeneous::zeros(); p - 1];
        let mut last = before;
        for k in 0..forward {
            last = last + (fitted[k] - last) / alphas[k];
            inner[k] = last;
        }
        last = after;
        for k in (forward + 1..p).rev() {
            last = last + (fitted[k] - last) / (1.0 - alphas[k]);
            inner[k - 1] = last;
        }
        (inner, miss)
    }
}

#[cfg(test)]
mod tests {
    use super::super::builtin::builtin;
    use super::super::testing::{fifty_surfaces, pairs};
    use super::*;
    use crate::basis::Side;
    use crate::basis::testing::Random;

    const BOTH: [Direction; 2] = [Direction::U, Direction::V];

    /// Largest distance at equal parameters, seen on a grid.
    fn distance(a: &Surface, b: &Surface, seed: u64) -> f64 {
        let pairs = pairs(&mut Random(seed), a, 9);
        pairs
            .iter()
            .map(|&(u, v)| (a.point(u, v) - b.point(u, v)).norm())
            .fold(0.0, f64::max)
    }

    fn interior(knots: &KnotVector) -> Vec<f64> {
        let (start, end) = knots.domain();
        let mut inner: Vec<f64> = knots
            .knots()
            .iter()
            .copied()
            .filter(|&t| t > start && t < end)
            .collect();
        inner.dedup();
        inner
    }

    #[test]
    fn a_knot_that_was_inserted_comes_out_again_at_no_cost() {
        let mut random = Random(71);
        for surface in fifty_surfaces(71) {
            for direction in BOTH {
                let (start, end) = surface.knots(direction).domain();
                // A new knot, and one more of an old one.
                let mut at = vec![random.float(start, end)];
                at.extend(interior(surface.knots(direction)).first());
                for knot in at {
                    let Ok(finer) = surface.insert_knots(direction, &[knot]) else {
                        continue;
                    };
                    let back = finer.knot_removed(direction, knot).unwrap();
                    assert_eq!(back.surface.knots(direction), surface.knots(direction));
                    assert!(
                        back.error_bound < 1e-12,
                        "{surface:?}: {knot} {direction:?} costs {}",
                        back.error_bound
                    );
                    // Points where the new knot is nearly another one's are hardly held by
                    // anything.
                    let error = distance(&surface, &back.surface, 5);
                    assert!(
                        error < 1e-11,
                        "{surface:?}: {knot} {direction:?} moved points by {error}"
                    );
                }
            }
        }
    }

    #[test]
    fn what_a_removed_knot_costs_stays_under_its_bound_and_near_it() {
        let (mut tried, mut tight) = (0, 0);
        for surface in fifty_surfaces(72) {
            for direction in BOTH {
                for knot in interior(surface.knots(direction)) {
                    // The sides of a gap would be glued; a bound holds there too, but not at the
                    // knot itself.
                    if surface.knots(direction).disjoined().contains(&knot) {
                        continue;
                    }
                    let Ok(simple) = surface.knot_removed(direction, knot) else {
                        continue;
                    };
                    let error = distance(&surface, &simple.surface, 6);
                    let bound = simple.error_bound;
                    assert!(
                        error <= bound * (1.0 + 1e-9) + 1e-14,
                        "{surface:?}: {error} above {bound}"
                    );
                    tried += 1;
                    tight += usize::from(error > 0.05 * bound);
                }
            }
        }
        assert!(
            tried > 60 && tight * 2 > tried,
            "{tight} of {tried} bounds are within twenty times the error"
        );
    }

    // One knot of a cubic: among all P the least largest miss, found by brute force over the two
    // unknowns.
    #[test]
    fn no_other_points_would_miss_less() {
        let alphas = [0.9, 0.45, 0.2];
        let q = [0.3, -0.2, 0.9, 0.1, -0.5].map(|x| Homogeneous::new(x, 0.0, 0.0, 1.0));
        let (inner, miss) = RemovalChain::new(&alphas).solve(&q);
        let largest = |a: f64, b: f64| -> f64 {
            let p = [q[0].x, a, b, q[4].x];
            (0..3)
                .map(|k| ((1.0 - alphas[k]) * p[k] + alphas[k] * p[k + 1] - q[k + 1].x).abs())
                .fold(0.0, f64::max)
        };
        let ours = largest(inner[0].x, inner[1].x);
        assert!((ours - miss[0].x.abs()).abs() < 1e-14);
        for i in -200..=200 {
            for j in -200..=200 {
                let (a, b) = (
                    inner[0].x + f64::from(i) * 0.01,
                    inner[1].x + f64::from(j) * 0.01,
                );
                assert!(largest(a, b) >= ours - 1e-12, "({a}, {b}) misses less");
            }
        }
    }

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
            let knot = interior(drop.knots(direction))[3];
            for simple in [
                drop.knot_removed(direction, knot).unwrap(),
                drop.degree_reduced(direction).unwrap(),
            ] {
                assert_eq!(simple.surface.topology(), drop.topology());
                assert!(
                    simple.error_bound < 0.1 * drop.size(),
                    "{} m",
                    simple.error_bound
                );
            }
        }
    }

    #[test]
    fn what_is_no_interior_knot_cannot_be_removed() {
        let sheet = builtin("sheet", None, None).unwrap();
        for (knot, text) in [
            (0.3, "0.3 is not a knot inside the domain"),
            (0.0, "0 is not a knot inside the domain"),
        ] {
            let error = sheet
                .knot_removed(Direction::U, knot)
                .unwrap_err()
                .to_string();
            assert_eq!(error, format!("knots in u: {text}"));
        }
        let flat = builtin("sheet", Some([4, 4]), None).unwrap();
        let mut linear = flat;
        for _ in 0..2 {
            linear = linear.degree_reduced(Direction::U).unwrap().surface;
        }
        assert!(linear.degree_reduced(Direction::U).is_err());
    }
}
