//! Surfaces through, or near, a grid of points.
//!
//! Parameters are mean chord lengths, knots follow them so that every span has points (Piegl &
//! Tiller, *The NURBS Book*, eq. 9.5, 9.8 and 9.69); as many control points as points interpolate,
//! fewer give the least sum of squares between the ends of clamped lines, which stay in place:
//! edges and poles are kept.

use super::{ControlNet, Surface, SurfaceError};
use crate::basis::{Blending, KnotError, KnotVector};
use crate::math::{Cholesky, MOST_COORDINATE_M, Point3, SymmetricTriplets, Vector3, first_outside};

/// What surface to look for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridSpec {
    /// Degrees in u and v.
    pub degree: [usize; 2],
    /// Control points in u and v; at most as many as grid points.
    pub counts: [usize; 2],
    /// The grid's rows (u), columns (v) go round: the first follows the last, and is not given
    /// twice.
    pub periodic: [bool; 2],
}

/// A fitted surface and what it misses.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The surface.
    pub surface: Surface,
    /// Root mean square of the distances, m: to the grid's points at their parameters, or to a
    /// cloud's at their feet.
    pub rms_error: f64,
    /// Largest distance, m.
    pub max_error: f64,
}

/// Most control points of a fit.
pub(super) const MOST_POINTS: usize = 1 << 16;

/// Why points were not fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Wrong number of points.
    #[error("{given} points do not form a grid of {rows} × {columns}")]
    Count {
        /// Points given.
        given: usize,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// A coordinate that is not finite, or too large to calculate with.
    #[error(
        "point {index} has coordinate {value} m, not a finite number within ±{MOST_COORDINATE_M:e} m"
    )]
    NotFinite {
        /// Index in the list.
        index: usize,
        /// The value given.
        value: f64,
    },
    /// More unknowns than the points tell.
    #[error("{points} points in {direction} are too few for {count} control points: ask for fewer")]
    TooFew {
        /// `u` or `v`, or `all` of a cloud.
        direction: &'static str,
        /// Number of points given.
        points: usize,
        /// Control points.
        count: usize,
    },
    /// More than anyone means.
    #[error("{count} control points are more than a fit supports ({MOST_POINTS})")]
    TooMany {
        /// Control points asked for.
        count: usize,
    },
    /// More points than a fit of this degree has memory for.
    #[error(
        "{points} points are more than a fit of this degree supports ({most}): give fewer, or a lower degree"
    )]
    TooLarge {
        /// Points given.
        points: usize,
        /// How many may be.
        most: usize,
    },
    /// Several shells in one.
    #[error(
        "the triangles form {components} separate parts; a surface has one: fit each from a file of its own"
    )]
    Components {
        /// How many.
        components: usize,
    },
    /// Triangles that bound nothing.
    #[error(
        "the triangles are not closed: {edges} edges do not have one triangle on each side; repair the mesh, or fit a sheet"
    )]
    OpenShell {
        /// How many edges.
        edges: usize,
    },
    /// A hole goes through.
    #[error(
        "the triangles have genus {genus} (a ball has 0, a torus 1); a closed surface with two poles has no holes through it"
    )]
    Handles {
        /// Holes through it.
        genus: usize,
    },
    /// Two lines of a grid at the same places.
    #[error("lines {} and {index} in {direction} of the grid are identical: remove one", index - 1)]
    Coincident {
        /// `u` or `v`.
        direction: &'static str,
        /// The second of the two.
        index: usize,
    },
    /// A cloud that is a point or a line, or, where a closed surface is wanted, flat.
    #[error(
        "the points have no extent in {missing} of three directions: no such surface spans them"
    )]
    Flat {
        /// Directions without extent.
        missing: usize,
    },
    /// A smoothing weight out of range.
    #[error("smoothing is {0}; it must be above 0 and at most 1000, such as 1e-6")]
    Smoothing(f64),
    /// Equations without a solution in double precision.
    #[error(
        "{unknowns} control points cannot be determined from these points: ask for fewer, or for less smoothing"
    )]
    Singular {
        /// Control points.
        unknowns: usize,
    },
    /// Degree or count.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

impl Surface {
    /// The surface through or near `rows × columns` points, u-major.
    ///
    /// # Errors
    /// Points that are not such a grid or not finite, two equal lines, or counts that the points or
    /// the degree do not allow.
    pub fn fitted_to_grid(
        points: &[Point3],
        rows: usize,
        columns: usize,
        spec: &GridSpec,
    ) -> Result<Fitted, FitError> {
        if rows.checked_mul(columns) != Some(points.len()) || points.is_empty() {
            return Err(FitError::Count {
                given: points.len(),
                rows,
                columns,
            });
        }
        finite(points)?;
        let count = spec.counts[0].saturating_mul(spec.counts[1]);
        if count > MOST_POINTS {
            return Err(FitError::TooMany { count });
        }
        let lines = |direction: usize| -> Vec<Vec<Point3>> {
            match direction {
                0 => (0..columns)
                    .map(|j| (0..rows).map(|i| points[i * columns + j]).collect())
                    .collect(),
                _ => points.chunks(columns).map(<[Point3]>::to_vec).collect(),
            }
        };
        let mut both = Vec::new();
        for (direction, name) in ["u", "v"].into_iter().enumerate() {
            let (given, count) = ([rows, columns][direction], spec.counts[direction]);
            if count > given {
                return Err(FitError::TooFew {
                    direction: name,
                    points: given,
                    count,
                });
            }
            let parameters = chord_parameters(&lines(direction), spec.periodic[direction])
                .map_err(|index| FitError::Coincident {
                    direction: name,
                    index,
                })?;
            let knots = knots_for(
                &parameters,
                spec.degree[direction],
                count,
                spec.periodic[direction],
            );
            let letter = if direction == 0 { 'u' } else { 'v' };
            let knots = knots.map_err(|source| SurfaceError::Knots {
                direction: letter,
                source,
            })?;
            both.push((knots, parameters));
        }
        let [(knots_u, us), (knots_v, vs)] = <[_; 2]>::try_from(both).expect("two directions");
        // From a point of the grid, so that its place costs no digits.
        let origin = points[0];
        let offsets: Vec<Vector3> = points.iter().map(|point| point - origin).collect();
        let half = LineFit::new(&knots_v, &vs).apply(&offsets);
        let turned = transposed(&half, rows, knots_v.count());
        let fitted = transposed(
            &LineFit::new(&knots_u, &us).apply(&turned),
            knots_v.count(),
            knots_u.count(),
        );
        let net = ControlNet::new(
            knots_u.count(),
            knots_v.count(),
            fitted.iter().map(|x| origin + x).collect(),
        );
        let surface =
            Self::new(knots_u, knots_v, net.map_err(SurfaceError::from)?, None)?.with_exact_seams();
        let (mut sum, mut most) = (0.0, 0.0_f64);
        for (i, &u) in us.iter().enumerate() {
            for (j, &v) in vs.iter().enumerate() {
                let distance = (surface.point(u, v) - points[i * columns + j]).norm();
                sum += distance * distance;
                most = most.max(distance);
            }
        }
        Ok(Fitted {
            surface,
            rms_error: (sum / points.len() as f64).sqrt(),
            max_error: most,
        })
    }
}

/// Least squares for lines of points at fixed parameters; the ends of a clamped line stay where
/// they are.
pub(crate) struct LineFit {
    blending: Blending,
    pinned: usize,
    normal: Option<Cholesky>,
}

/// Keeps the factor positive where rounding would not; refinement takes its effect out again.
const RIDGE: f64 = 1e-13;

/// Rounds of refinement: the normal equations square the condition, each round gives back what that
/// cost.
const REFINEMENTS: usize = 4;

impl LineFit {
    /// Every span needs its parameters.
    pub fn new(knots: &KnotVector, parameters: &[f64]) -> Self {
        let blending = Blending::new(knots, parameters);
        let pinned = usize::from(!knots.is_periodic());
        let free = knots.count() - 2 * pinned;
        let mut normal = SymmetricTriplets::new(free);
        for row in 0..blending.rows() {
            let inner = || {
                blending
                    .entries(row, 0)
                    .filter(|(k, _)| (pinned..pinned + free).contains(k))
            };
            for (i, a) in inner() {
                for (j, b) in inner().filter(|(j, _)| *j <= i) {
                    normal.add(i - pinned, j - pinned, a * b);
                }
            }
        }
        (0..free).for_each(|k| normal.add(k, k, RIDGE));
        let normal = (free > 0).then(|| Cholesky::new(&normal).expect("every span has its points"));
        Self {
            blending,
            pinned,
            normal,
        }
    }

    /// Lines one after the other, each (parameters) → each (control points).
    pub fn apply(&self, lines: &[Vector3]) -> Vec<Vector3> {
        let (given, count) = (self.blending.rows(), self.blending.columns());
        let mut out = Vec::with_capacity(lines.len() / given * count);
        let mut missed = vec![Vector3::zeros(); given];
        for line in lines.chunks(given) {
            let mut points = vec![Vector3::zeros(); count];
            if self.pinned == 1 {
                (points[0], points[count - 1]) = (line[0], line[given - 1]);
            }
            for _ in 0..=REFINEMENTS {
                let Some(normal) = &self.normal else { break };
                self.blending.apply(0, &points, &mut missed);
                let free = count - 2 * self.pinned;
                let mut right = [(); 3].map(|()| vec![0.0; free]);
                for (row, missed) in missed.iter().enumerate() {
                    for (k, value) in self.blending.entries(row, 0) {
                        if (self.pinned..self.pinned + free).contains(&k) {
                            (0..3).for_each(|c| {
                                right[c][k - self.pinned] += value * (line[row][c] - missed[c])
                            });
                        }
                    }
                }
                for (c, right) in right.iter_mut().enumerate() {
                    normal.solve_one(right);
                    points[self.pinned..]
                        .iter_mut()
                        .zip(right)
                        .for_each(|(point, x)| point[c] += *x);
                }
            }
            out.extend(points);
        }
        out
    }
}

fn transposed(points: &[Vector3], rows: usize, columns: usize) -> Vec<Vector3> {
    (0..columns)
        .flat_map(|j| (0..rows).map(move |i| points[i * columns + j]))
        .collect()
}

/// Every coordinate can be calculated with.
pub(super) fn finite(points: &[Point3]) -> Result<(), FitError> {
    match first_outside(points) {
        Some((index, value)) => Err(FitError::NotFinite { index, value }),
        None => Ok(()),
    }
}

/// Shares of the chord length up to each point, the mean of all lines, in [0, 1]; below 1 when
/// periodic. An error names the line that coincides with the one before.
fn chord_parameters(lines: &[Vec<Point3>], periodic: bool) -> Result<Vec<f64>, usize> {
    let count = lines[0].len();
    let steps = if periodic { count } else { count - 1 };
    let mut mean = vec![0.0; steps];
    for line in lines {
        let chords: Vec<f64> = (0..steps)
            .map(|k| (line[(k + 1) % count] - line[k]).norm())
            .collect();
        let length: f64 = chords.iter().sum();
        // A line that is one point, at a pole, says nothing.
        if length > 0.0 {
            mean.iter_mut()
                .zip(&chords)
                .for_each(|(sum, chord)| *sum += chord / length);
        }
    }
    let total: f64 = mean.iter().sum();
    if let Some(k) = mean
        .iter()
        .position(|step| step.is_nan() || *step <= 1e-14 * total)
    {
        return Err(k + 1);
    }
    let mut at = 0.0;
    let mut parameters = vec![0.0];
    for step in mean {
        at += step;
        parameters.push(at / total);
    }
    if periodic {
        parameters.pop();
    } else {
        parameters[count - 1] = 1.0;
    }
    Ok(parameters)
}

/// Knots of which every span has its points.
fn knots_for(
    parameters: &[f64],
    degree: usize,
    count: usize,
    periodic: bool,
) -> Result<KnotVector, KnotError> {
    let n = parameters.len();
    if degree == 0 || degree > crate::basis::MAX_DEGREE {
        return Err(KnotError::Degree(degree));
    }
    if count < degree + 1 {
        return Err(KnotError::TooFew { count, degree });
    }
    // The parameter at a place between points, going on round the end.
    let at = |place: f64| {
        let (k, share) = (place.floor() as usize, place - place.floor());
        let value = |k: usize| parameters[k % n] + (k / n) as f64;
        value(k) + share * (value(k + 1) - value(k))
    };
    if periodic {
        // A basis function of odd degree has a knot at its middle, one of even degree two beside
        // it.
        let shift = if degree.is_multiple_of(2) { 0.5 } else { 0.0 };
        let start = at(shift);
        let mut knots: Vec<f64> = (0..count)
            .map(|k| at(shift + k as f64 * n as f64 / count as f64))
            .collect();
        knots.push(start + 1.0);
        return KnotVector::periodic(degree, knots);
    }
    let mut knots = vec![0.0; degree + 1];
    for j in 1..count - degree {
        knots.push(if count == n {
            parameters[j..j + degree].iter().sum::<f64>() / degree as f64
        } else {
            let place = j as f64 * n as f64 / (count - degree) as f64;
            let (k, share) = (place.floor() as usize, place - place.floor());
            (1.0 - share) * parameters[k - 1] + share * parameters[k]
        });
    }
    knots.extend(std::iter::repeat_n(1.0, degree + 1));
    KnotVector::new(degree, knots)
}

#[cfg(test)]
mod tests {
    use super::super::builtin::builtin;
    use super::*;
    use crate::basis::testing::Random;

    fn grid(surface: &Surface, us: &[f64], vs: &[f64]) -> Vec<Point3> {
        us.iter()
            .flat_map(|&u| vs.iter().map(move |&v| surface.point(u, v)))
            .collect()
    }

    fn even(count: usize, periodic: bool) -> Vec<f64> {
        let last = if periodic { count } else { count - 1 };
        (0..count).map(|k| k as f64 / last as f64).collect()
    }

    #[test]
    fn as_many_control_points_as_points_go_through_all_of_them() {
        let mut random = Random(91);
        for degree in 1..=5 {
            for periodic in [false, true] {
                let (rows, columns) =
                    (degree + random.integer(3, 9), degree + random.integer(3, 9));
                let points: Vec<Point3> = (0..rows * columns)
                    .map(|k| {
                        let turn = std::f64::consts::TAU * (k / columns) as f64 / rows as f64;
                        let mut jitter = || random.float(-0.05, 0.05);
                        Point3::new(
                            turn.cos() + jitter(),
                            turn.sin() + jitter(),
                            (k % columns) as f64 + jitter(),
                        )
                    })
                    .collect();
                let spec = GridSpec {
                    degree: [degree; 2],
                    counts: [rows, columns],
                    periodic: [periodic, false],
                };
                let fitted = Surface::fitted_to_grid(&points, rows, columns, &spec).unwrap();
                assert!(
                    fitted.max_error < 1e-10,
                    "degree {degree}, periodic {periodic}: {} m",
                    fitted.max_error
                );
            }
        }
    }

    // Halving the cells divides the error of a cubic by sixteen where the surface is smooth.
    #[test]
    fn fits_of_a_torus_converge_with_the_fourth_power() {
        let torus = builtin("torus", Some([40, 40]), None).unwrap();
        let (us, vs) = (even(120, true), even(120, true));
        let points = grid(&torus, &us, &vs);
        let error = |count: usize| {
            let spec = GridSpec {
                degree: [3; 2],
                counts: [count; 2],
                periodic: [true; 2],
            };
            Surface::fitted_to_grid(&points, 120, 120, &spec).unwrap()
        };
        let (coarse, fine) = (error(8), error(16));
        assert!(
            fine.rms_error < coarse.rms_error / 10.0,
            "{} m, then {} m",
            coarse.rms_error,
            fine.rms_error
        );
        assert!(fine.surface.topology().is_closed());
    }

    #[test]
    fn points_of_a_pole_stay_together() {
        let drop = builtin("teardrop", None, None).unwrap();
        let (us, vs) = (even(24, true), even(20, false));
        let spec = GridSpec {
            degree: [3; 2],
            counts: [12, 10],
            periodic: [true, false],
        };
        let fitted = Surface::fitted_to_grid(&grid(&drop, &us, &vs), 24, 20, &spec).unwrap();
        assert!(
            fitted.surface.topology().is_closed(),
            "{:?}",
            fitted.surface.topology()
        );
        assert!(
            fitted.rms_error < 2e-3 * drop.size(),
            "{} m",
            fitted.rms_error
        );
    }

    #[test]
    fn grids_that_cannot_be_fitted_are_refused_with_what_and_where() {
        let sheet = builtin("sheet", None, None).unwrap();
        let points = grid(&sheet, &even(5, false), &even(6, false));
        let spec = |counts, degree| GridSpec {
            degree: [degree; 2],
            counts,
            periodic: [false; 2],
        };
        let fit = |points: &[Point3], spec: &GridSpec| {
            Surface::fitted_to_grid(points, 5, 6, spec).unwrap_err()
        };
        assert_eq!(
            fit(&points[1..], &spec([4, 4], 3)),
            FitError::Count {
                given: 29,
                rows: 5,
                columns: 6
            }
        );
        assert_eq!(
            fit(&points, &spec([4, 7], 3)),
            FitError::TooFew {
                direction: "v",
                points: 6,
                count: 7
            }
        );
        assert!(
            fit(&points, &spec([3, 3], 3))
                .to_string()
                .contains("too few for degree 3")
        );
        assert!(
            fit(&points, &spec([4, 4], 0))
                .to_string()
                .contains("degree 0")
        );
        let mut twice = points.clone();
        twice.copy_within(6..12, 12);
        assert_eq!(
            fit(&twice, &spec([4, 4], 3)),
            FitError::Coincident {
                direction: "u",
                index: 2
            }
        );
        let mut broken = points.clone();
        broken[7] = Point3::from(Vector3::new(0.0, f64::NAN, 0.0));
        assert!(matches!(
            fit(&broken, &spec([4, 4], 3)),
            FitError::NotFinite { index: 7, .. }
        ));
    }
}
