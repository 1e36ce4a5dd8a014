//! The surface itself: evaluation of points, derivatives and normals.

use super::{ControlNet, NetError};
use crate::basis::{BasisWindow, KnotError, KnotVector, Side};
use crate::math::{Point3, Vector3};
use std::ops::RangeInclusive;

/// Weights that a surface or a curve may have. Homogeneous coordinates, and quotients of them, stay finite; circles
/// need weights from 0.5 to 1.
pub const WEIGHTS: RangeInclusive<f64> = 1e-9..=1e9;

/// How many times the smallest weight of a surface its largest may be. Of random nets, the closest
/// points of 4,800 queries each are within 1e-13 of the size at ratios of 1e4 and 3e4; one of 3,600
/// is wrong at 1e5 (3e-6 of the size) and three at 1e6 (up to 4e-3): heavy points draw most of the
/// surface so near to them that its parts cannot be told apart.
pub const MOST_WEIGHTS: f64 = 1e4;

/// Why a surface was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// The knots of one direction.
    #[error("knots in {direction}: {source}")]
    Knots {
        /// `u` or `v`.
        direction: char,
        /// What is wrong.
        source: KnotError,
    },
    /// The net.
    #[error(transparent)]
    Net(#[from] NetError),
    /// Net and knots disagree.
    #[error("the net has {given} points in {direction}, but the knots require {needed}")]
    Size {
        /// `u` or `v`.
        direction: char,
        /// Points of the net.
        given: usize,
        /// Points the knots want.
        needed: usize,
    },
    /// Wrong number of weights.
    #[error("{given} weights for {needed} control points")]
    WeightCount {
        /// Given number.
        given: usize,
        /// Needed number.
        needed: usize,
    },
    /// An approximation whose weights left the allowed range.
    #[error("simplified so far, a weight would be {value}; weights are from {:e} to {:e}", WEIGHTS.start(), WEIGHTS.end())]
    Unweighable {
        /// The weight, or 1 where a coordinate is not finite.
        value: f64,
    },
    /// A weight outside [`WEIGHTS`].
    #[error(
        "weight ({row}, {column}) is {value}; weights are from {:e} to {:e}", WEIGHTS.start(), WEIGHTS.end()
    )]
    Weight {
        /// Row, u.
        row: usize,
        /// Column, v.
        column: usize,
        /// The value.
        value: f64,
    },
    /// Weights of which one is more than [`MOST_WEIGHTS`] times another.
    #[error(
        "the largest weight is {ratio:.3e} times the smallest; closest points are exact up to {MOST_WEIGHTS:e} times"
    )]
    WeightRatio {
        /// Largest over smallest.
        ratio: f64,
    },
    /// Knots that differ in their last digits, with a part of the surface between them.
    #[error(
        "knots {first} to {last} in {direction} differ in their last digits near {value}: the part of the surface between them is \
         too narrow for parameters, and {}; make them equal if that is what is meant, or set them at least 1e-11 of the domain \
         apart",
        .moved_m.map_or("they are too many to be one knot".to_owned(), |m| format!("without it points would move by {m:.1e} m"))
    )]
    NearKnots {
        /// `u` or `v`.
        direction: char,
        /// The first of them, in the list of the file.
        first: usize,
        /// The last of them.
        last: usize,
        /// Their value.
        value: f64,
        /// How far points would move if they were made equal, m; `None` where degree + 2 or more
        /// would be.
        moved_m: Option<f64>,
    },
}

/// Point and derivatives at a parameter: S, S_u, S_v, S_uu, S_uv, S_vv, metres per unit of
/// parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Point S(u, v), m.
    pub point: Point3,
    /// First derivative S_u.
    pub du: Vector3,
    /// First derivative S_v.
    pub dv: Vector3,
    /// Second derivative S_uu.
    pub duu: Vector3,
    /// Mixed derivative S_uv.
    pub duv: Vector3,
    /// Second derivative S_vv.
    pub dvv: Vector3,
}

/// A tensor-product surface. Knots, weights and orientation never change; the net may move.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    knots_u: KnotVector,
    knots_v: KnotVector,
    net: ControlNet,
    weights: Option<Vec<f64>>,
    flip_normal: bool,
}

impl Surface {
    /// Checks that knots, net and weights agree.
    ///
    /// # Errors
    /// Sizes that disagree, or weights that are not in [`WEIGHTS`] or more than [`MOST_WEIGHTS`]
    /// apart.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::basis::KnotVector;
    /// use palpate_geometry::math::Point3;
    /// use palpate_geometry::surface::{ControlNet, Surface};
    /// // A bilinear patch over the unit square.
    /// let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
    /// let points = corners.map(|[x, y]| Point3::new(x, y, x * y)).to_vec();
    /// let knots = KnotVector::clamped_uniform(1, 2)?;
    /// let surface = Surface::new(knots.clone(), knots, ControlNet::new(2, 2, points)?, None)?;
    /// assert_eq!(surface.point(0.5, 0.5), Point3::new(0.5, 0.5, 0.25));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(
        knots_u: KnotVector,
        knots_v: KnotVector,
        net: ControlNet,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, SurfaceError> {
        for (direction, given, needed) in [
            ('u', net.rows(), knots_u.count()),
            ('v', net.columns(), knots_v.count()),
        ] {
            if given != needed {
                return Err(SurfaceError::Size {
                    direction,
                    given,
                    needed,
                });
            }
        }
        if let Some(weights) = &weights {
            if weights.len() != net.points().len() {
                return Err(SurfaceError::WeightCount {
                    given: weights.len(),
                    needed: net.points().len(),
                });
            }
            if let Some(k) = weights.iter().position(|w| !WEIGHTS.contains(w)) {
                let (row, column) = (k / net.columns(), k % net.columns());
                return Err(SurfaceError::Weight {
                    row,
                    column,
                    value: weights[k],
                });
            }
            check_ratio(weights)?;
        }
        Ok(Self {
            knots_u,
            knots_v,
            net,
            weights,
            flip_normal: false,
        })
    }

    /// Parts that were checked, or made of such.
    pub(crate) fn from_checked(
        knots_u: KnotVector,
        knots_v: KnotVector,
        net: ControlNet,
        weights: Option<Vec<f64>>,
    ) -> Self {
        debug_assert_eq!(
            (net.rows(), net.columns()),
            (knots_u.count(), knots_v.count()),
            "net and knots disagree"
        );
        Self {
            knots_u,
            knots_v,
            net,
            weights,
            flip_normal: false,
        }
    }

    /// Returns this surface with its outward side at `-(S_u × S_v)` if `flip` is true.
    pub fn with_flip_normal(mut self, flip: bool) -> Self {
        self.flip_normal = flip;
        self
    }

    /// Leaves out weights that are all the same: they say nothing, and queries are dearer with them.
    pub(crate) fn without_even_weights(mut self) -> Self {
        (self.weights).take_if(|weights| weights.iter().all(|w| *w == weights[0]));
        self
    }

    /// Knots in u.
    pub fn knots_u(&self) -> &KnotVector {
        &self.knots_u
    }

    /// Knots in v.
    pub fn knots_v(&self) -> &KnotVector {
        &self.knots_v
    }

    /// The net.
    pub fn net(&self) -> &ControlNet {
        &self.net
    }

    /// The net, to be moved. Points must stay finite.
    pub fn net_mut(&mut self) -> &mut ControlNet {
        &mut self.net
    }

    /// Weights, u-major, if rational.
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// Weights, to be changed by rounding only.
    pub(super) fn weights_mut(&mut self) -> Option<&mut [f64]> {
        self.weights.as_deref_mut()
    }

    /// True when the outward side is `-(S_u × S_v)`.
    pub fn flip_normal(&self) -> bool {
        self.flip_normal
    }

    /// S(u, v), parameters confined to the domain.
    pub fn point(&self, u: f64, v: f64) -> Point3 {
        self.point_in(&self.knots_u.window(u), &self.knots_v.window(v))
    }

    /// [`Surface::point`] from windows at hand.
    pub fn point_in(&self, wu: &BasisWindow, wv: &BasisWindow) -> Point3 {
        let columns = self.net.columns();
        let points = self.net.points();
        let (mut sum, mut weight) = (Vector3::zeros(), 0.0);
        for (a, n) in wu.values().iter().enumerate() {
            let row = wrap(wu.first + a, self.net.rows()) * columns;
            for (b, m) in wv.values().iter().enumerate() {
                let k = row + wrap(wv.first + b, columns);
                let share = n * m * self.weights.as_ref().map_or(1.0, |w| w[k]);
                sum += points[k].coords * share;
                weight += share;
            }
        }
        // Values sum to one: without weights there is nothing to divide by.
        Point3::from(if self.weights.is_some() {
            sum / weight
        } else {
            sum
        })
    }

    /// S and its derivatives to order 2, parameters confined to the domain.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::surface::builtin;
    /// let sphere = builtin("sphere", None, Some(0.02))?;
    /// let frame = sphere.frame(0.3, 0.4);
    /// let normal = sphere.normal(0.3, 0.4);
    /// assert!(normal.dot(&frame.du).abs() < 1e-12 && normal.dot(&frame.dv).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn frame(&self, u: f64, v: f64) -> Frame {
        self.frame_from(u, v, Side::Right, Side::Right)
    }

    /// [`Surface::frame`], each parameter seen from a chosen side: matters at creases and where the
    /// surface is disjoined.
    pub fn frame_from(&self, u: f64, v: f64, side_u: Side, side_v: Side) -> Frame {
        self.frame_in(
            &self.knots_u.window_from(u, side_u),
            &self.knots_v.window_from(v, side_v),
        )
    }

    /// [`Surface::frame`] from windows at hand.
    pub fn frame_in(&self, wu: &BasisWindow, wv: &BasisWindow) -> Frame {
        if self.weights.is_none() {
            return self.polynomial_frame(wu, wv);
        }
        // Quotient rule on A / w; The NURBS Book, eq. 4.20.
        let [
            (a, w),
            (a_u, w_u),
            (a_v, w_v),
            (a_uu, w_uu),
            (a_uv, w_uv),
            (a_vv, w_vv),
        ] = self.homogeneous_frame(wu, wv);
        let s = a / w;
        let du = (a_u - s * w_u) / w;
        let dv = (a_v - s * w_v) / w;
        Frame {
            point: Point3::from(s),
            du,
            dv,
            duu: (a_uu - du * (2.0 * w_u) - s * w_uu) / w,
            duv: (a_uv - du * w_v - dv * w_u - s * w_uv) / w,
            dvv: (a_vv - dv * (2.0 * w_v) - s * w_vv) / w,
        }
    }

    fn polynomial_frame(&self, wu: &BasisWindow, wv: &BasisWindow) -> Frame {
        let columns = self.net.columns();
        let points = self.net.points();
        let zero = Vector3::zeros();
        let (mut s, mut du, mut dv, mut duu, mut duv, mut dvv) =
            (zero, zero, zero, zero, zero, zero);
        for a in 0..wu.len {
            let row = wrap(wu.first + a, self.net.rows()) * columns;
            let (mut p, mut q, mut r) = (zero, zero, zero);
            for b in 0..wv.len {
                let point = points[row + wrap(wv.first + b, columns)].coords;
                p += point * wv.values()[b];
                q += point * wv.first_derivatives()[b];
                r += point * wv.second_derivatives()[b];
            }
            let (n, d, dd) = (
                wu.values()[a],
                wu.first_derivatives()[a],
                wu.second_derivatives()[a],
            );
            s += p * n;
            du += p * d;
            duu += p * dd;
            dv += q * n;
            duv += q * d;
            dvv += r * n;
        }
        Frame {
            point: Point3::from(s),
            du,
            dv,
            duu,
            duv,
            dvv,
        }
    }

    /// (Σ N_i M_j w_ij P_ij, Σ N_i M_j w_ij) and its derivatives u, v, uu, uv, vv.
    fn homogeneous_frame(&self, wu: &BasisWindow, wv: &BasisWindow) -> [(Vector3, f64); 6] {
        let columns = self.net.columns();
        let points = self.net.points();
        let mut frame = [(Vector3::zeros(), 0.0); 6];
        for a in 0..wu.len {
            let row = wrap(wu.first + a, self.net.rows()) * columns;
            let mut along = [(Vector3::zeros(), 0.0); 3];
            for b in 0..wv.len {
                let k = row + wrap(wv.first + b, columns);
                let weight = self.weights.as_ref().map_or(1.0, |w| w[k]);
                let weighted = points[k].coords * weight;
                for (sum, order) in along.iter_mut().zip(0..) {
                    let m = wv.order(order)[b];
                    sum.0 += weighted * m;
                    sum.1 += weight * m;
                }
            }
            let n = [
                wu.values()[a],
                wu.first_derivatives()[a],
                wu.second_derivatives()[a],
            ];
            for (sum, (order_u, order_v)) in
                frame
                    .iter_mut()
                    .zip([(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)])
            {
                sum.0 += along[order_v].0 * n[order_u];
                sum.1 += along[order_v].1 * n[order_u];
            }
        }
        frame
    }
}

/// Refuses weights that are more than [`MOST_WEIGHTS`] apart.
pub(super) fn check_ratio(weights: &[f64]) -> Result<(), SurfaceError> {
    let (low, high) = (weights.iter()).fold((f64::INFINITY, 0.0_f64), |(low, high), &w| {
        (low.min(w), high.max(w))
    });
    if high > MOST_WEIGHTS * low {
        return Err(SurfaceError::WeightRatio { ratio: high / low });
    }
    Ok(())
}

/// Index modulo count, for windows that run past the end of a period.
pub(crate) fn wrap(index: usize, count: usize) -> usize {
    if index < count { index } else { index - count }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{fifty_surfaces, pairs, twin_derivative};
    use super::*;
    use crate::basis::testing::Random;

    #[test]
    fn points_and_derivatives_agree_with_the_recursive_definition() {
        let mut random = Random(31);
        let mut tried = 0;
        for surface in fifty_surfaces(31) {
            for (u, v) in pairs(&mut random, &surface, 20) {
                tried += 1;
                let frame = surface.frame(u, v);
                let point = twin_derivative(&surface, u, v, 0, 0);
                let error = (frame.point.coords - point).norm();
                assert!(
                    error <= 1e-12 * surface.size(),
                    "{surface:?} at ({u}, {v}): point off by {error}"
                );
                assert!(
                    (surface.point(u, v) - frame.point).norm() <= 1e-14,
                    "point and frame disagree"
                );
                let derivatives = [
                    (frame.du, 1, 0),
                    (frame.dv, 0, 1),
                    (frame.duu, 2, 0),
                    (frame.duv, 1, 1),
                    (frame.dvv, 0, 2),
                ];
                for (derivative, k, l) in derivatives {
                    let wanted = twin_derivative(&surface, u, v, k, l);
                    let error = (derivative - wanted).norm();
                    // Relative, but not to a derivative that cancels to nothing.
                    let scale = wanted.norm().max(surface.size());
                    assert!(
                        error <= 1e-10 * scale,
                        "{surface:?} at ({u}, {v}), order ({k}, {l}): off by {error}"
                    );
                }
            }
        }
        assert!(
            tried >= 10_000,
            "{tried} pairs are fewer than the bar names"
        );
    }

    // Values in 60 digits from another language, kept as data; tests/oracles/surface_values.py
    // wrote them.
    #[test]
    fn points_and_derivatives_agree_with_sixty_digits() {
        let cases: serde_json::Value =
            serde_json::from_str(include_str!("data/high_precision.json")).unwrap();
        let mut tried = 0;
        for case in cases.as_array().unwrap() {
            let surface = super::super::file::from_value(&case["surface"]).unwrap();
            for answer in case["answers"].as_array().unwrap() {
                let frame =
                    surface.frame(answer["u"].as_f64().unwrap(), answer["v"].as_f64().unwrap());
                let got = [
                    frame.point.coords,
                    frame.du,
                    frame.dv,
                    frame.duu,
                    frame.duv,
                    frame.dvv,
                ];
                for (order, got) in got.into_iter().enumerate() {
                    let wanted = &answer["orders"][order];
                    let wanted = Vector3::from_fn(|c, _| wanted[c].as_f64().unwrap());
                    // Of the larger of value and size: what cancels to nothing has no relative
                    // error.
                    let bar =
                        if order == 0 { 1e-12 } else { 1e-10 } * wanted.norm().max(surface.size());
                    let error = (got - wanted).norm();
                    assert!(
                        error <= bar,
                        "order {order} at {answer}: off by {error}, allowed {bar}"
                    );
                    tried += 1;
                }
            }
        }
        assert_eq!(tried, 10 * 6 * 6);
    }

    #[test]
    fn derivatives_of_rational_surfaces_agree_with_differences() {
        for surface in fifty_surfaces(32)
            .into_iter()
            .filter(|s| s.weights().is_some())
        {
            let middle = |knots: &KnotVector| {
                let i = knots.spans().next().unwrap();
                (
                    0.5 * (knots.knots()[i] + knots.knots()[i + 1]),
                    1e-4 * (knots.knots()[i + 1] - knots.knots()[i]),
                )
            };
            let ((u, h), (v, k)) = (middle(surface.knots_u()), middle(surface.knots_v()));
            let at = |a: f64, b: f64| surface.frame(u + a * h, v + b * k);
            let frame = at(0.0, 0.0);
            let along_u = (at(1.0, 0.0).point - at(-1.0, 0.0).point) / (2.0 * h);
            let along_v = (at(0.0, 1.0).point - at(0.0, -1.0).point) / (2.0 * k);
            let uu = (at(1.0, 0.0).du - at(-1.0, 0.0).du) / (2.0 * h);
            let uv = (at(1.0, 0.0).dv - at(-1.0, 0.0).dv) / (2.0 * h);
            let vv = (at(0.0, 1.0).dv - at(0.0, -1.0).dv) / (2.0 * k);
            let pairs = [
                (along_u, frame.du),
                (along_v, frame.dv),
                (uu, frame.duu),
                (uv, frame.duv),
                (vv, frame.dvv),
            ];
            for (k, (difference, derivative)) in pairs.into_iter().enumerate() {
                // Truncation h² S''' with spans of about 1/2 and steps of 1e-4 of them.
                let error = (difference - derivative).norm();
                assert!(
                    error < 1e-4 * derivative.norm().max(1.0),
                    "{surface:?}: derivative {k} off by {error}"
                );
            }
        }
    }

    #[test]
    fn equal_weights_change_nothing() {
        for surface in fifty_surfaces(33)
            .into_iter()
            .filter(|s| s.weights().is_none())
            .take(10)
        {
            let weights = vec![1.7; surface.net().points().len()];
            let rational = Surface::new(
                surface.knots_u().clone(),
                surface.knots_v().clone(),
                surface.net().clone(),
                Some(weights),
            )
            .unwrap();
            for (u, v) in pairs(&mut Random(33), &surface, 2) {
                let (a, b) = (surface.frame(u, v), rational.frame(u, v));
                assert!((a.point - b.point).norm() < 1e-14);
                assert!(
                    (a.duv - b.duv).norm() < 1e-11 * (1.0 + a.duv.norm()),
                    "{} {}",
                    a.duv,
                    b.duv
                );
            }
        }
    }

    // Left and right of a knot of full multiplicity are two surfaces.
    #[test]
    fn a_disjoined_surface_has_two_points_at_its_gap() {
        let u = KnotVector::new(1, vec![0.0, 0.0, 1.0, 1.0, 2.0, 2.0]).unwrap();
        let v = KnotVector::clamped_uniform(1, 2).unwrap();
        let xs = [0.0, 1.0, 3.0, 4.0];
        let points = xs
            .iter()
            .flat_map(|&x| [Point3::new(x, 0.0, 0.0), Point3::new(x, 1.0, 0.0)])
            .collect();
        let surface = Surface::new(u, v, ControlNet::new(4, 2, points).unwrap(), None).unwrap();
        assert_eq!(
            surface.frame_from(1.0, 0.5, Side::Left, Side::Right).point,
            Point3::new(1.0, 0.5, 0.0)
        );
        assert_eq!(
            surface.frame_from(1.0, 0.5, Side::Right, Side::Right).point,
            Point3::new(3.0, 0.5, 0.0)
        );
    }

    #[test]
    fn bad_nets_and_weights_are_refused_with_what_and_where() {
        let knots = || KnotVector::clamped_uniform(1, 2).unwrap();
        let net = |rows, columns| {
            ControlNet::new(rows, columns, vec![Point3::origin(); rows * columns]).unwrap()
        };
        let error = Surface::new(knots(), knots(), net(2, 3), None).unwrap_err();
        assert_eq!(
            error,
            SurfaceError::Size {
                direction: 'v',
                given: 3,
                needed: 2
            }
        );
        let weighted = |weights: Vec<f64>| {
            Surface::new(knots(), knots(), net(2, 2), Some(weights)).unwrap_err()
        };
        assert_eq!(
            weighted(vec![1.0; 3]),
            SurfaceError::WeightCount {
                given: 3,
                needed: 4
            }
        );
        assert_eq!(
            weighted(vec![1.0, 1.0, 0.0, 1.0]),
            SurfaceError::Weight {
                row: 1,
                column: 0,
                value: 0.0
            }
        );
        assert!(matches!(
            weighted(vec![1.0, f64::NAN, 1.0, 1.0]),
            SurfaceError::Weight {
                row: 0,
                column: 1,
                ..
            }
        ));
        let points = vec![Point3::origin(), Point3::new(0.0, f64::INFINITY, 0.0)];
        let error = ControlNet::new(1, 2, points).unwrap_err();
        assert_eq!(
            error,
            NetError::NotFinite {
                row: 0,
                column: 1,
                value: f64::INFINITY
            }
        );
    }
}
