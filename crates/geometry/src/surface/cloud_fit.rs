//! Surfaces near scattered points: from a scanned object to a first design.
//!
//! Points get parameters by projection on their principal plane (open) or on their ellipsoid of
//! inertia (closed: u runs round the longest axis, v from pole to pole). Then in turn: the net of
//! the least sum of squared distances at these parameters plus a thin-plate energy `∬ S_uu² + 2
//! S_uv² + S_vv²`, whose weight falls by ten each round; and new parameters, the feet of the points
//! on that surface (Hoschek's correction, by certified projection).

use super::grid_fit::{FitError, Fitted, MOST_POINTS, finite};
use super::{ClosestSolver, ControlNet, Surface, SurfaceError};
use crate::basis::{KnotVector, MAX_DEGREE};
use crate::math::{Cholesky, Point3, SymmetricTriplets, Vector3};
use nalgebra::SymmetricEigen;

/// What surface to look for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudSpec {
    /// A surface of the kind of a sphere (periodic in u, poles at the ends of v) instead of a
    /// sheet.
    pub closed: bool,
    /// Degrees in u and v.
    pub degree: [usize; 2],
    /// Control points in u and v.
    pub counts: [usize; 2],
    /// Weight of the thin-plate energy in the last rounds, relative to the points: 1e-6 follows
    /// them, 1e-2 smooths noise.
    pub smoothing: f64,
    /// Most rounds.
    pub rounds: usize,
}

impl Default for CloudSpec {
    fn default() -> Self {
        Self {
            closed: false,
            degree: [3; 2],
            counts: [8; 2],
            smoothing: 1e-7,
            rounds: 40,
        }
    }
}

/// The energy's weight in the first round.
const FIRST_SMOOTHING: f64 = 1e-2;

/// Weights of the first rings round a pole against the points.
const POLE_RINGS: [f64; 3] = [3.0, 0.3, 0.03];

/// A round that gains less than this share of the error is the last.
const LEAST_GAIN: f64 = 1e-3;

/// More smoothing than this leaves nothing of the points.
const MOST_SMOOTHING: f64 = 1e3;

/// Most products of basis functions that are summed: 1.6 GB.
const MOST_PRODUCTS: usize = 1 << 26;

impl Surface {
    /// The surface near scattered points (m). The errors are distances from the points to their
    /// closest points on it.
    ///
    /// # Errors
    /// Points that are not finite, too few or without the extent such a surface needs; degree,
    /// counts or smoothing out of range.
    pub fn fitted_to_cloud(points: &[Point3], spec: &CloudSpec) -> Result<Fitted, FitError> {
        finite(points)?;
        check_size(spec, points.len())?;
        let needed = spec.degree.iter().map(|p| p.min(&MAX_DEGREE) + 1).product();
        if points.len() < needed {
            return Err(FitError::TooFew {
                direction: "all",
                points: points.len(),
                count: needed,
            });
        }
        let bad = |direction| move |source| SurfaceError::Knots { direction, source };
        let [p, q] = spec.degree;
        let knots_u = match spec.closed {
            true => KnotVector::periodic_uniform(p, spec.counts[0]),
            false => KnotVector::clamped_uniform(p, spec.counts[0]),
        };
        let knots_u = knots_u.map_err(bad('u'))?;
        let knots_v = KnotVector::clamped_uniform(q, spec.counts[1]).map_err(bad('v'))?;
        let axes = PrincipalAxes::of(points);
        let missing = axes
            .deviations
            .iter()
            .filter(|d| **d <= 1e-9 * axes.deviations[0])
            .count();
        if axes.deviations[0] == 0.0 || missing > usize::from(!spec.closed) {
            return Err(FitError::Flat {
                missing: if axes.deviations[0] == 0.0 {
                    3
                } else {
                    missing
                },
            });
        }
        let parameters: Vec<(f64, f64)> = if spec.closed {
            axes.on_ellipsoid(points)
        } else {
            axes.on_plane(points)
        };
        let count = knots_u.count() * knots_v.count();
        let net = ControlNet::from_checked(
            knots_u.count(),
            knots_v.count(),
            vec![Point3::origin(); count],
        );
        let problem = Problem::new(Self::from_checked(knots_u, knots_v, net, None), spec.closed);
        let first = FIRST_SMOOTHING.max(spec.smoothing);
        let mut fitted = problem.rounds(points, parameters, spec, first)?;
        fitted.surface = fitted.surface.oriented_outward();
        Ok(fitted)
    }
}

/// Refuses smoothing that is no weight, and what would take more memory or time than a fit may.
pub(super) fn check_size(spec: &CloudSpec, points: usize) -> Result<(), FitError> {
    if !(spec.smoothing > 0.0 && spec.smoothing <= MOST_SMOOTHING) {
        return Err(FitError::Smoothing(spec.smoothing));
    }
    let count = spec.counts[0].saturating_mul(spec.counts[1]);
    if count > MOST_POINTS {
        return Err(FitError::TooMany { count });
    }
    // Products of basis functions: each point has those of its window.
    let window = spec.degree[0].min(MAX_DEGREE) + 1;
    let window = window * (spec.degree[1].min(MAX_DEGREE) + 1);
    let products = window * (window + 1) / 2 * points;
    if products > MOST_PRODUCTS {
        return Err(FitError::TooLarge {
            points,
            most: MOST_PRODUCTS / (window * (window + 1) / 2),
        });
    }
    Ok(())
}

/// Mean and axes of a cloud, by falling extent.
struct PrincipalAxes {
    mean: Point3,
    axes: [Vector3; 3],
    /// Root mean square extent along each, m.
    deviations: [f64; 3],
}

impl PrincipalAxes {
    fn of(points: &[Point3]) -> Self {
        let n = points.len() as f64;
        let mean = points[0] + points.iter().map(|p| p - points[0]).sum::<Vector3>() / n;
        let covariance = points
            .iter()
            .map(|p| (p - mean) * (p - mean).transpose())
            .sum::<crate::math::Matrix3>()
            / n;
        let eigen = SymmetricEigen::new(covariance);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let axes = order.map(|k| eigen.eigenvectors.column(k).clone_owned());
        let deviations = order.map(|k| eigen.eigenvalues[k].max(0.0).sqrt());
        Self {
            mean,
            axes,
            deviations,
        }
    }

    fn on_plane(&self, points: &[Point3]) -> Vec<(f64, f64)> {
        let flat: Vec<[f64; 2]> = points
            .iter()
            .map(|p| [0, 1].map(|k| (p - self.mean).dot(&self.axes[k])))
            .collect();
        let range = |k: usize| {
            let (low, high) = flat
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                    (l.min(x[k]), h.max(x[k]))
                });
            (low, high - low)
        };
        let [(x, width), (y, height)] = [range(0), range(1)];
        flat.iter()
            .map(|p| ((p[0] - x) / width, (p[1] - y) / height))
            .collect()
    }

    fn on_ellipsoid(&self, points: &[Point3]) -> Vec<(f64, f64)> {
        use std::f64::consts::{PI, TAU};
        let angle = |point: &Point3| {
            let [z, x, y] =
                [0, 1, 2].map(|k| (point - self.mean).dot(&self.axes[k]) / self.deviations[k]);
            let u = libm::atan2(y, x) / TAU;
            (
                if u < 0.0 { u + 1.0 } else { u },
                libm::atan2(libm::hypot(x, y), z) / PI,
            )
        };
        points.iter().map(angle).collect()
    }
}

/// The least-squares problem of one pair of knot vectors: unknowns, and the energy.
pub(super) struct Problem {
    shape: Surface,
    /// (net) number of the unknown that a control point is.
    unknown: Vec<usize>,
    count: usize,
    /// Non-zeros of the energy's matrix, (i, j, value), i ≥ j.
    energy: Vec<(usize, usize, f64)>,
    /// The same of what keeps poles fair.
    poles: Vec<(usize, usize, f64)>,
}

impl Problem {
    pub(super) fn new(shape: Surface, poles: bool) -> Self {
        let (rows, columns) = (shape.net().rows(), shape.net().columns());
        let mut unknown = vec![0; rows * columns];
        let mut count = 0;
        for i in 0..rows {
            for j in 0..columns {
                let same = poles && i > 0 && (j == 0 || j + 1 == columns);
                unknown[i * columns + j] = if same { unknown[j] } else { count };
                count += usize::from(!same);
            }
        }
        let mut problem = Self {
            shape,
            unknown,
            count,
            energy: Vec::new(),
            poles: Vec::new(),
        };
        // Two points a span and direction integrate the second derivatives of a cubic exactly.
        let nodes =
            |knots: &KnotVector| super::closed::gauss_nodes(knots, knots.degree().max(2) - 1);
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); count];
        for (u, a) in nodes(problem.shape.knots_u()) {
            for (v, b) in nodes(problem.shape.knots_v()) {
                for (order_u, order_v, factor) in [(2, 0, 1.0), (1, 1, 2.0), (0, 2, 1.0)] {
                    let row = problem.row(u, v, order_u, order_v);
                    for &(i, x) in &row {
                        for &(j, y) in row.iter().filter(|(j, _)| *j <= i) {
                            let value = a * b * factor * x * y;
                            match rows[i].iter_mut().find(|entry| entry.0 == j) {
                                Some(entry) => entry.1 += value,
                                None => rows[i].push((j, value)),
                            }
                        }
                    }
                }
            }
        }
        problem.poles = if poles {
            problem.pole_rings()
        } else {
            Vec::new()
        };
        problem.energy = rows
            .into_iter()
            .enumerate()
            .flat_map(|(i, row)| row.into_iter().map(move |(j, value)| (i, j, value)))
            .collect();
        problem
    }

    /// Squares of what rings round a pole should not have. A function that is smooth across a pole
    /// has in its j-th ring of control points waves of at most j periods: the first is an ellipse
    /// in the tangent plane, about the pole. Without this a ring that few points see crosses
    /// itself, and the surface folds.
    fn pole_rings(&self) -> Vec<(usize, usize, f64)> {
        use std::f64::consts::TAU;
        let (rows, columns) = (self.shape.net().rows(), self.shape.net().columns());
        let n = rows as f64;
        let mut entries = Vec::new();
        for (ring, weight) in POLE_RINGS.into_iter().enumerate() {
            let waves = ring + 1;
            if columns < 2 * (waves + 1) || rows <= 2 * waves + 1 {
                break;
            }
            for (pole, column) in [(0, waves), (columns - 1, columns - 1 - waves)] {
                let unknown = |i: usize| self.unknown[i * columns + column];
                // 1 less the projection on those waves.
                for i in 0..rows {
                    for k in 0..=i {
                        let kept: f64 = (1..=waves)
                            .map(|w| libm::cos(TAU * (w * (i - k)) as f64 / n))
                            .sum();
                        let own = if i == k { 1.0 } else { 0.0 };
                        // Of the first ring the mean is the pole: what is left of it counts too.
                        let mean = if waves == 1 { 0.0 } else { 1.0 / n };
                        let value = own - mean - 2.0 / n * kept;
                        entries.push((unknown(i), unknown(k), weight * value));
                    }
                }
                if waves == 1 {
                    // Σ (P_i − P)² instead of Σ P_i².
                    let at_pole = self.unknown[pole];
                    entries.push((at_pole, at_pole, weight * n));
                    entries.extend((0..rows).map(|i| (unknown(i), at_pole, -weight)));
                }
            }
        }
        entries
    }

    /// What a point, or a derivative, is of the unknowns; control points that are one are one
    /// entry.
    fn row(&self, u: f64, v: f64, order_u: usize, order_v: usize) -> Vec<(usize, f64)> {
        let (wu, wv) = (
            self.shape.knots_u().window(u),
            self.shape.knots_v().window(v),
        );
        let (rows, columns) = (self.shape.net().rows(), self.shape.net().columns());
        let mut row: Vec<(usize, f64)> = Vec::with_capacity(wu.len * wv.len);
        for (a, n) in wu.order(order_u).iter().enumerate() {
            for (b, m) in wv.order(order_v).iter().enumerate() {
                let k = self.unknown[(wu.first + a) % rows * columns + wv.first + b];
                match row.iter_mut().find(|entry| entry.0 == k) {
                    Some(entry) => entry.1 += n * m,
                    None => row.push((k, n * m)),
                }
            }
        }
        row
    }

    /// In turn the least net at these parameters, and new parameters: the feet of the points. Ends
    /// when that gains little. The best of all rounds.
    pub(super) fn rounds(
        &self,
        points: &[Point3],
        mut parameters: Vec<(f64, f64)>,
        spec: &CloudSpec,
        mut smoothing: f64,
    ) -> Result<Fitted, FitError> {
        let origin =
            points[0] + points.iter().map(|p| p - points[0]).sum::<Vector3>() / points.len() as f64;
        let mut round = |smoothing: f64| {
            let surface = self.solve(points, &parameters, smoothing, origin)?;
            let mut solver = ClosestSolver::new(&surface);
            let (mut sum, mut most) = (0.0, 0.0_f64);
            for (point, parameters) in points.iter().zip(&mut parameters) {
                let foot = solver.closest(&surface, point);
                *parameters = (foot.u, foot.v);
                let distance = (foot.point - point).norm();
                sum += distance * distance;
                most = most.max(distance);
            }
            Ok::<_, FitError>(Fitted {
                surface,
                rms_error: (sum / points.len() as f64).sqrt(),
                max_error: most,
            })
        };
        let mut best = round(smoothing)?;
        let mut best_folds = self.folds(&best.surface);
        for _ in 1..spec.rounds {
            let last = smoothing <= spec.smoothing;
            smoothing = (0.1 * smoothing).max(spec.smoothing);
            let now = round(smoothing)?;
            let settled = last && now.rms_error > best.rms_error * (1.0 - LEAST_GAIN);
            let folds = self.folds(&now.surface);
            if (folds, now.rms_error) < (best_folds, best.rms_error) {
                (best, best_folds) = (now, folds);
            }
            if settled {
                break;
            }
        }
        Ok(best)
    }

    /// Neighbouring places, three a knot span, between which the normal of a closed surface turns
    /// round.
    fn folds(&self, surface: &Surface) -> usize {
        if self.poles.is_empty() {
            return 0;
        }
        let (rows, columns) = (3 * surface.net().rows(), 3 * surface.net().columns());
        let normal = |i: usize, j: usize| {
            let (u, v) = (
                (i % rows) as f64 / rows as f64,
                (j as f64 + 0.5) / columns as f64,
            );
            let frame = surface.frame(u, v);
            frame.du.cross(&frame.dv)
        };
        let normals: Vec<Vector3> = (0..rows)
            .flat_map(|i| (0..columns).map(move |j| (i, j)))
            .map(|(i, j)| normal(i, j))
            .collect();
        let at = |i: usize, j: usize| &normals[i % rows * columns + j];
        (0..rows)
            .flat_map(|i| (0..columns).map(move |j| (i, j)))
            .map(|(i, j)| {
                let around = at(i, j).dot(at(i + 1, j)) <= 0.0;
                let along = j + 1 < columns && at(i, j).dot(at(i, j + 1)) <= 0.0;
                usize::from(around) + usize::from(along)
            })
            .sum()
    }

    fn solve(
        &self,
        points: &[Point3],
        parameters: &[(f64, f64)],
        smoothing: f64,
        origin: Point3,
    ) -> Result<Surface, FitError> {
        let mut matrix = SymmetricTriplets::new(self.count);
        let mut right = [(); 3].map(|()| vec![0.0; self.count]);
        let share = 1.0 / points.len() as f64;
        let mut data = 0.0;
        for (point, &(u, v)) in points.iter().zip(parameters) {
            let row = self.row(u, v, 0, 0);
            for &(i, x) in &row {
                for &(j, y) in row.iter().filter(|(j, _)| *j <= i) {
                    matrix.add(i, j, share * x * y);
                }
                data += share * x * x;
                for (axis, right) in right.iter_mut().enumerate() {
                    right[i] += share * x * (point[axis] - origin[axis]);
                }
            }
        }
        let bending: f64 = self
            .energy
            .iter()
            .filter(|(i, j, _)| i == j)
            .map(|(_, _, value)| value)
            .sum();
        let weight = if bending > 0.0 {
            smoothing * data / bending
        } else {
            0.0
        };
        self.energy
            .iter()
            .for_each(|&(i, j, value)| matrix.add(i, j, weight * value));
        // As much as the points say about a control point on average.
        for &(i, j, value) in &self.poles {
            matrix.add(i, j, value * data / self.count as f64);
        }
        // Nothing holds a control point that no point sees where the energy is blind too; it goes
        // to the middle.
        for i in 0..self.count {
            matrix.add(i, i, 1e-12 * data / self.count as f64);
        }
        // A sum of squares, and more than nothing on the diagonal; rounding may take that away.
        let unknowns = self.count;
        let factor = Cholesky::new(&matrix).map_err(|_| FitError::Singular { unknowns })?;
        right.iter_mut().for_each(|right| factor.solve_one(right));
        let mut surface = self.shape.clone();
        for (point, &k) in surface.net_mut().points_mut().iter_mut().zip(&self.unknown) {
            *point = origin + Vector3::new(right[0][k], right[1][k], right[2][k]);
        }
        Ok(surface)
    }
}

#[cfg(test)]
mod tests {
    use super::super::builtin::builtin;
    use super::super::testing::tilted;
    use super::*;
    use crate::basis::testing::Random;

    fn cloud(surface: &Surface, count: usize, noise: f64, seed: u64) -> Vec<Point3> {
        let mut random = Random(seed);
        (0..count)
            .map(|_| {
                let point = surface.point(random.float(0.0, 1.0), random.float(0.0, 1.0));
                let mut jitter = || random.float(-noise, noise);
                point + Vector3::new(jitter(), jitter(), jitter())
            })
            .collect()
    }

    #[test]
    fn a_scanned_teardrop_becomes_a_closed_surface_near_every_point() {
        let drop = tilted(&builtin("teardrop", None, None).unwrap());
        let points = cloud(&drop, 3000, 0.0, 101);
        let spec = CloudSpec {
            closed: true,
            counts: [12, 12],
            ..CloudSpec::default()
        };
        let fitted = Surface::fitted_to_cloud(&points, &spec).unwrap();
        assert!(fitted.surface.topology().is_closed() && fitted.surface.volume() > 0.0);
        println!(
            "rms {:e}, max {:e} of {}",
            fitted.rms_error,
            fitted.max_error,
            drop.size()
        );
        assert!(
            fitted.rms_error < 2e-3 * drop.size(),
            "{} m",
            fitted.rms_error
        );
        assert!((fitted.surface.volume() / drop.volume() - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_bent_sheet_is_found_and_noise_is_not() {
        let mut sheet = tilted(&builtin("sheet", None, Some(0.1)).unwrap());
        let mut random = Random(102);
        sheet
            .net_mut()
            .points_mut()
            .iter_mut()
            .for_each(|p| *p += Vector3::new(0.0, 0.0, random.float(-0.01, 0.01)));
        let fit = |noise: f64, smoothing: f64| {
            let spec = CloudSpec {
                counts: [12, 12],
                smoothing,
                ..CloudSpec::default()
            };
            Surface::fitted_to_cloud(&cloud(&sheet, 2500, noise, 103), &spec).unwrap()
        };
        let exact = fit(0.0, 1e-8);
        println!("rms {:e}, max {:e}", exact.rms_error, exact.max_error);
        assert!(exact.rms_error < 1e-4, "{} m", exact.rms_error);
        // Uniform noise of ± 1 mm in a direction has 0.58 mm; the surface should be nearer to the
        // truth than that.
        let noisy = fit(1e-3, 1e-4);
        // The fit may reach past the cloud's corners; what counts is that it passes where the sheet
        // is.
        let mut solver = ClosestSolver::new(&noisy.surface);
        let truth: f64 = cloud(&sheet, 400, 0.0, 104)
            .iter()
            .map(|p| solver.closest(&noisy.surface, p).distance.powi(2))
            .sum();
        let truth = (truth / 400.0).sqrt();
        assert!(truth < 2.5e-4, "{truth} m from the surface without noise");
    }

    #[test]
    fn clouds_that_span_nothing_are_refused() {
        let line: Vec<Point3> = (0..50)
            .map(|k| Point3::new(f64::from(k), 0.0, 0.0))
            .collect();
        let fit = |points: &[Point3], closed| {
            Surface::fitted_to_cloud(
                points,
                &CloudSpec {
                    closed,
                    ..CloudSpec::default()
                },
            )
            .unwrap_err()
        };
        assert_eq!(fit(&line, false), FitError::Flat { missing: 2 });
        assert_eq!(
            fit(&[Point3::origin(); 30], false),
            FitError::Flat { missing: 3 }
        );
        let flat = cloud(&builtin("sheet", None, None).unwrap(), 50, 0.0, 105);
        assert_eq!(fit(&flat, true), FitError::Flat { missing: 1 });
        assert_eq!(
            fit(&flat[..15], false),
            FitError::TooFew {
                direction: "all",
                points: 15,
                count: 16
            }
        );
        let mut broken = flat.clone();
        broken[3].z = f64::INFINITY;
        assert!(matches!(
            fit(&broken, false),
            FitError::NotFinite { index: 3, .. }
        ));
        let spec = CloudSpec {
            counts: [1 << 40, 1 << 40],
            ..CloudSpec::default()
        };
        assert!(matches!(
            Surface::fitted_to_cloud(&flat, &spec),
            Err(FitError::TooMany { .. })
        ));
        let spec = CloudSpec {
            smoothing: f64::NAN,
            ..CloudSpec::default()
        };
        assert!(matches!(
            Surface::fitted_to_cloud(&flat, &spec),
            Err(FitError::Smoothing(_))
        ));
    }
}
