//! Exact refinement, placement and renaming: other nets of the same surface.
//!
//! Insertion works on points and weights apart, as `a + alpha (b − a)`: rows that were equal stay
//! equal bit for bit, so seams and poles survive.

use super::joints::{Joints, SAME_KNOT};
use super::lines::{Direction, LinePoint};
use super::{Closing, ControlNet, Surface, SurfaceError};
use crate::basis::KnotVector;
use crate::math::{Point3, Pose};

impl Surface {
    /// Returns this surface with knots inserted in a direction, each as often as it is listed; knots
    /// are wrapped into the period if there is one. The shape is unchanged.
    ///
    /// # Errors
    /// A knot that is not finite, outside a domain that does not wrap, or repeated more than
    /// `degree + 1` times.
    pub fn insert_knots(&self, direction: Direction, knots: &[f64]) -> Result<Self, SurfaceError> {
        let mut surface = self.clone();
        for &knot in knots {
            let insertion = surface
                .knots(direction)
                .insertion(knot)
                .map_err(|e| direction.refused(e))?;
            let finer = insertion.knots.clone();
            surface = surface.with_lines(direction, finer, |line| insertion.apply(line, blend));
        }
        Ok(surface)
    }

    /// [`Surface::insert_knots`] in both directions; on a branching surface also at all places that
    /// must be cut alike, so that joined edges and duplicates stay equal. Knots that are listed for
    /// one of those places count for all of them.
    ///
    /// # Errors
    /// As for [`Surface::insert_knots`].
    pub fn insert_knots_alike(&self, knots: [&[f64]; 2]) -> Result<Self, SurfaceError> {
        let all = match self.joints() {
            None => knots.map(<[f64]>::to_vec),
            Some(joints) => all_alike(&joints, knots),
        };
        let finer = self
            .insert_knots(Direction::U, &all[0])?
            .insert_knots(Direction::V, &all[1])?;
        Ok(if self.joints().is_some() {
            finer.with_exact_seams()
        } else {
            finer
        })
    }

    /// Returns this surface with its longest knot spans split evenly until the net has that many
    /// distinct control points in u and v (a seam counts once, see [`Surface::distinct_counts`]). A
    /// direction that has as many already stays as it is. A branching surface is cut in all copies
    /// alike, and may so get more.
    ///
    /// # Errors
    /// A span too short to be split once more in `f64`.
    pub fn refined_to(&self, count_u: usize, count_v: usize) -> Result<Self, SurfaceError> {
        let [have_u, have_v] = self.distinct_counts();
        if self.joints().is_some() {
            return self.refined_alike([count_u, count_v]);
        }
        self.insert_knots(
            Direction::U,
            &even_knots(self.knots_u(), count_u.saturating_sub(have_u)),
        )?
        .insert_knots(
            Direction::V,
            &even_knots(self.knots_v(), count_v.saturating_sub(have_v)),
        )
    }

    /// Halves the longest span, and those that go with it, until there are enough.
    fn refined_alike(&self, counts: [usize; 2]) -> Result<Self, SurfaceError> {
        let mut finer = self.clone();
        for (d, count) in counts.into_iter().enumerate() {
            loop {
                let knots = if d == 0 {
                    finer.knots_u()
                } else {
                    finer.knots_v()
                };
                if knots.count() >= count {
                    break;
                }
                let t = knots.knots();
                let mut longest = (0.0, 0.0);
                for (a, b) in knots.spans().map(|i| (t[i], t[i + 1])) {
                    if b - a > (longest.1 - longest.0) * (1.0 + 1e-9) {
                        longest = (a, b);
                    }
                }
                let middle = [0.5 * (longest.0 + longest.1)];
                finer = finer.insert_knots_alike(if d == 0 {
                    [&middle, &[]]
                } else {
                    [&[], &middle]
                })?;
            }
        }
        Ok(finer)
    }

    /// Control points in u and v, the doubled row of a clamped seam counted once.
    pub fn distinct_counts(&self) -> [usize; 2] {
        let topology = self.topology();
        let seam = |direction: usize| usize::from(topology.closing[direction] == Closing::Seam);
        [self.net().rows() - seam(0), self.net().columns() - seam(1)]
    }

    /// Rotated, then moved.
    pub fn transformed(&self, pose: &Pose) -> Self {
        let mut moved = self.clone();
        moved
            .net_mut()
            .points_mut()
            .iter_mut()
            .for_each(|point| *point = pose * *point);
        moved
    }

    /// [`Surface::transformed`] by a placement that may be anything.
    ///
    /// # Errors
    /// A point that comes to lie outside ±[`MOST_COORDINATE_M`](crate::math::MOST_COORDINATE_M), or nowhere.
    pub fn placed(&self, pose: &Pose) -> Result<Self, SurfaceError> {
        let mut placed = self.transformed(pose);
        let net = placed.net();
        let points = net.points().to_vec();
        *placed.net_mut() = ControlNet::new(net.rows(), net.columns(), points)?;
        Ok(placed)
    }

    /// Scaled about the origin by a factor above 0.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scaled = self.clone();
        scaled
            .net_mut()
            .points_mut()
            .iter_mut()
            .for_each(|point| *point *= factor);
        scaled
    }

    /// Returns this surface with u and v exchanged; the outward side is unchanged.
    pub fn swap_uv(&self) -> Self {
        let (rows, columns) = (self.net().rows(), self.net().columns());
        let order: Vec<usize> = (0..columns)
            .flat_map(|j| (0..rows).map(move |i| i * columns + j))
            .collect();
        let points = order.iter().map(|&k| self.net().points()[k]).collect();
        let weights = self
            .weights()
            .map(|w| order.iter().map(|&k| w[k]).collect());
        self.rebuilt(
            self.knots_v().clone(),
            self.knots_u().clone(),
            points,
            weights,
        )
        .with_flip_normal(!self.flip_normal())
    }

    /// A surface whose parts are known to agree, and whose values are means of values that were
    /// checked.
    pub(super) fn rebuilt(
        &self,
        knots_u: KnotVector,
        knots_v: KnotVector,
        points: Vec<Point3>,
        weights: Option<Vec<f64>>,
    ) -> Self {
        let net = ControlNet::from_checked(knots_u.count(), knots_v.count(), points);
        Self::from_checked(knots_u, knots_v, net, weights)
    }
}

/// `a + alpha (b − a)` in homogeneous coordinates, written so that equal points give exactly that
/// point.
fn blend(a: LinePoint, b: LinePoint, alpha: f64) -> LinePoint {
    // At the ends the sum may miss b by a rounding, and the exact point is at hand.
    if alpha == 1.0 {
        return b;
    }
    let weight = a.1 + alpha * (b.1 - a.1);
    (a.0 + (b.0 - a.0) * (alpha * b.1 / weight), weight)
}

/// Knots with those that go with them.
fn all_alike(joints: &Joints, knots: [&[f64]; 2]) -> [Vec<f64>; 2] {
    let mut all = [Vec::new(), Vec::new()];
    // Brought about by an earlier one, and not listed yet.
    let mut owed: Vec<(usize, f64)> = Vec::new();
    for d in 0..2 {
        for &x in knots[d] {
            let near =
                |&(e, y): &(usize, f64)| e == d && (y - x).abs() <= SAME_KNOT * x.abs().max(1.0);
            if let Some(k) = owed.iter().position(near) {
                owed.swap_remove(k);
                continue;
            }
            let cuts = joints.cuts(d, x);
            owed.extend_from_slice(&cuts[1..]);
            cuts.into_iter().for_each(|(e, y)| all[e].push(y));
        }
    }
    all
}

/// The knots that split the longest spans evenly, `more` in all.
fn even_knots(knots: &KnotVector, more: usize) -> Vec<f64> {
    let t = knots.knots();
    let mut spans: Vec<(f64, f64, usize)> = knots.spans().map(|i| (t[i], t[i + 1], 1)).collect();
    // Spans meant to be equal differ by roundings: then the first one is split.
    let slack = 1.0 + 1e-9;
    for _ in 0..more {
        let mut longest = 0;
        for k in 1..spans.len() {
            let piece = |s: &(f64, f64, usize)| (s.1 - s.0) / s.2 as f64;
            if piece(&spans[k]) > piece(&spans[longest]) * slack {
                longest = k;
            }
        }
        spans[longest].2 += 1;
    }
    let split = |&(start, end, pieces): &(f64, f64, usize)| {
        (1..pieces).map(move |k| start + (end - start) * (k as f64 / pieces as f64))
    };
    spans.iter().flat_map(split).collect()
}

#[cfg(test)]
mod tests {
    use super::super::builtin::builtin;
    use super::super::testing::{fifty_surfaces, pairs};
    use super::*;
    use crate::basis::testing::{Random, parameters};

    fn assert_same_shape(a: &Surface, b: &Surface, seed: u64) {
        for (u, v) in pairs(&mut Random(seed), a, 4) {
            let error = (a.point(u, v) - b.point(u, v)).norm();
            assert!(
                error <= 1e-12 * a.size(),
                "{a:?} moved by {error} at ({u}, {v})"
            );
        }
    }

    #[test]
    fn insertion_leaves_every_kind_of_surface_where_it_is() {
        let mut random = Random(41);
        for (k, surface) in fifty_surfaces(41).into_iter().enumerate() {
            let room = |knots: &KnotVector, value: f64| knots.insertion(value).is_ok();
            let mut us = parameters(&mut random, surface.knots_u(), 3);
            us.retain(|&u| room(surface.knots_u(), u));
            us.pop();
            let mut vs = parameters(&mut random, surface.knots_v(), 3);
            vs.retain(|&v| room(surface.knots_v(), v));
            vs.pop();
            let fine = surface
                .insert_knots(Direction::U, &us)
                .unwrap()
                .insert_knots(Direction::V, &vs)
                .unwrap();
            let (rows, columns) = (
                surface.net().rows() + us.len(),
                surface.net().columns() + vs.len(),
            );
            assert_eq!((fine.net().rows(), fine.net().columns()), (rows, columns));
            assert_same_shape(&surface, &fine, k as u64);
        }
    }

    #[test]
    fn refinement_reaches_the_counts_and_keeps_seams_and_poles_exact() {
        for name in ["teardrop", "sphere", "torus", "sheet"] {
            let surface = builtin(name, None, None).unwrap();
            let fine = surface.refined_to(22, 23).unwrap();
            assert_eq!(fine.distinct_counts(), [22, 23], "{name}");
            assert_eq!(fine.topology(), surface.topology(), "{name}");
            assert_same_shape(&surface, &fine, 5);
            assert_eq!(
                fine.clone().with_exact_seams(),
                fine,
                "{name}: seams and poles are equal bit for bit"
            );
            assert!((fine.volume() - surface.volume()).abs() < 1e-12 * surface.size().powi(3));
        }
    }

    #[test]
    fn refinement_splits_spans_evenly() {
        let sheet = builtin("sheet", Some([4, 4]), None)
            .unwrap()
            .refined_to(8, 4)
            .unwrap();
        assert_eq!(sheet.knots_u(), &KnotVector::clamped_uniform(3, 8).unwrap());
        assert_eq!(sheet.knots_v(), &KnotVector::clamped_uniform(3, 4).unwrap());
        assert_eq!(sheet.refined_to(3, 3).unwrap(), sheet, "as many already");
    }

    #[test]
    fn exchanging_u_and_v_keeps_points_and_the_outward_side() {
        for surface in fifty_surfaces(42).into_iter().take(10) {
            let swapped = surface.swap_uv();
            for (u, v) in pairs(&mut Random(1), &surface, 2) {
                assert!((surface.point(u, v) - swapped.point(v, u)).norm() < 1e-14);
            }
            assert_eq!(swapped.swap_uv(), surface);
        }
        let drop = builtin("teardrop", None, None).unwrap();
        assert!((drop.volume() - drop.swap_uv().volume()).abs() < 1e-15);
    }

    #[test]
    fn placement_moves_points_as_the_net() {
        let pose = Pose::new(
            crate::math::Vector3::new(0.1, -0.2, 0.3),
            crate::math::Vector3::new(0.4, 1.0, -0.3),
        );
        for surface in fifty_surfaces(43).into_iter().take(10) {
            let moved = surface.transformed(&pose);
            for (u, v) in pairs(&mut Random(1), &surface, 2) {
                assert!((pose * surface.point(u, v) - moved.point(u, v)).norm() < 1e-14);
            }
        }
    }

    #[test]
    fn a_knot_that_cannot_be_inserted_is_named() {
        let sheet = builtin("sheet", None, None).unwrap();
        let message = sheet
            .insert_knots(Direction::V, &[0.1, 1.5])
            .unwrap_err()
            .to_string();
        assert_eq!(message, "knots in v: 1.5 is outside the domain 0 ..= 1");
        let message = sheet
            .insert_knots(Direction::U, &[0.3; 5])
            .unwrap_err()
            .to_string();
        assert_eq!(
            message,
            "knots in u: knot 0.3 is repeated 5 times; degree 3 allows 4"
        );
    }
}
