//! The pipe as a surface to touch: circles swept along the spine.
//!
//! ```text
//! Spine ─▶ stretches ─▶ sections (frame) ─▶ cubic Hermite control rows, exact circles round
//!             ▲                                   │ deviation from the exact pipe, stretch by stretch
//!             └────────── halved where too large ◀┘
//! ```
//! Round the section (v) the surface is a rational quadratic circle of four arcs, periodic; along
//! the spine (u, the spine's parameter) each of its eight control points is a cubic Hermite spline
//! through its place at the sections, with double knots, triple ones where the curvature or the
//! speed of the spine jumps. The error falls with the fourth power of the stretches' length.
//! Normals point outwards.

use super::frame::{Section, Stretch, sections};
use super::piece::Piece;
use super::spine::Spine;
use palpate_geometry::basis::{KnotError, KnotVector};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ControlNet, NetError, Surface, SurfaceError};

/// Most stretches of a pipe.
pub const MOST_STRETCHES: usize = 8_192;

/// Rounds of halving.
const ROUNDS: usize = 20;

/// A pipe's surface with what it is worth.
#[derive(Clone, Debug)]
pub struct PipeSurface {
    /// m; u along the spine, v round it.
    pub surface: Surface,
    /// Largest distance from the exact pipe that was measured, m.
    pub deviation_m: f64,
    /// Cubic stretches along the spine.
    pub stretches: usize,
}

/// Why no surface was made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SweepError {
    /// A radius or tolerance that is not a finite positive length.
    #[error("{what} is {value} m; it is a finite length above 0")]
    Length {
        /// `the radius` or `the tolerance`.
        what: &'static str,
        /// As given, m.
        value: f64,
    },
    /// A spine with a corner.
    #[error(
        "the spine turns by {turn_deg}° at parameter {parameter}; round the corner before sweeping"
    )]
    Corner {
        /// Parameter on the spine.
        parameter: f64,
        /// How far, degrees.
        turn_deg: f64,
    },
    /// A tolerance that takes too many stretches.
    #[error(
        "with {stretches} segments the surface still deviates by {deviation_m} m, more than {tolerance_m} m; raise the tolerance"
    )]
    Tolerance {
        /// Stretches along the spine.
        stretches: usize,
        /// Measured, m.
        deviation_m: f64,
        /// Wanted, m.
        tolerance_m: f64,
    },
    /// Control points that overflow.
    #[error(transparent)]
    Net(#[from] NetError),
    /// Knots that are too close.
    #[error("knots along the spine: {0}")]
    Knots(#[from] KnotError),
    /// Parts that make no surface.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

/// The pipe of a radius (m) around a spine, no further than a tolerance (m) from the exact one.
///
/// The radius may be above the largest one without self-intersection: the surface then intersects
/// itself.
///
/// # Errors
/// See [`SweepError`].
pub fn pipe_surface(
    spine: &Spine,
    radius_m: f64,
    tolerance_m: f64,
) -> Result<PipeSurface, SweepError> {
    for (what, value) in [("the radius", radius_m), ("the tolerance", tolerance_m)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(SweepError::Length { what, value });
        }
    }
    if let Some(corner) = spine.corners().first() {
        return Err(SweepError::Corner {
            parameter: corner.parameter,
            turn_deg: corner.turn_rad.to_degrees(),
        });
    }
    let (radius, tolerance) = (spine.units(radius_m), spine.units(tolerance_m));
    let halves =
        |piece: usize| [(0.0, 0.5), (0.5, 1.0)].map(|(from, to)| Stretch { piece, from, to });
    let mut stretches: Vec<Stretch> = (0..spine.pieces.len()).flat_map(halves).collect();
    for _ in 0..ROUNDS {
        let strips = strips(spine, &stretches, radius);
        let deviations: Vec<f64> = strips
            .iter()
            .zip(&stretches)
            .map(|(strip, s)| strip.deviation(&spine.pieces[s.piece], s, radius))
            .collect();
        let deviation = deviations.iter().copied().fold(0.0, f64::max);
        if deviation <= tolerance {
            let surface = assemble(spine, &strips)?;
            return Ok(PipeSurface {
                surface,
                deviation_m: spine.metres(deviation),
                stretches: strips.len(),
            });
        }
        // NaN counts as too far.
        let far = |d: f64| d.is_nan() || d > tolerance;
        let next: Vec<Stretch> = stretches
            .iter()
            .zip(&deviations)
            .flat_map(|(s, &d)| s.halved_if(far(d)))
            .collect();
        if next.len() > MOST_STRETCHES {
            break;
        }
        stretches = next;
    }
    let worst = strips(spine, &stretches, radius)
        .iter()
        .zip(&stretches)
        .map(|(strip, s)| strip.deviation(&spine.pieces[s.piece], s, radius))
        .fold(0.0, f64::max);
    Err(SweepError::Tolerance {
        stretches: stretches.len(),
        deviation_m: spine.metres(worst),
        tolerance_m,
    })
}

impl Stretch {
    fn halved_if(self, halve: bool) -> Vec<Self> {
        if !halve {
            return vec![self];
        }
        let middle = 0.5 * (self.from + self.to);
        vec![
            Self { to: middle, ..self },
            Self {
                from: middle,
                ..self
            },
        ]
    }
}

/// Control points round a section.
const ROUND: usize = 8;

/// One stretch of the surface: cubic Bézier rows of circle control points.
struct Strip {
    ends: [Section; 2],
    rows: [[Vector3; ROUND]; 4],
}

fn strips(spine: &Spine, stretches: &[Stretch], radius: f64) -> Vec<Strip> {
    sections(&spine.pieces, stretches, spine.is_closed())
        .into_iter()
        .map(|ends| {
            let third = (ends[1].parameter - ends[0].parameter) / 3.0;
            let row = |end: usize, step: f64| {
                let (places, rates) = circle(&ends[end], radius);
                std::array::from_fn(|j| places[j] + rates[j] * step)
            };
            Strip {
                ends,
                rows: [row(0, 0.0), row(0, third), row(1, -third), row(1, 0.0)],
            }
        })
        .collect()
}

/// Control points of a section's circle and their derivatives by the spine's parameter: on the
/// circle, and on the corners of the square around it. Clockwise about the tangent, so that S_u ×
/// S_v points outwards.
fn circle(section: &Section, radius: f64) -> ([Vector3; ROUND], [Vector3; ROUND]) {
    const DIRECTIONS: [[f64; 2]; ROUND] = [
        [1.0, 0.0],
        [1.0, -1.0],
        [0.0, -1.0],
        [-1.0, -1.0],
        [-1.0, 0.0],
        [-1.0, 1.0],
        [0.0, 1.0],
        [1.0, 1.0],
    ];
    let ([n, b], [dn, db]) = (section.normals, section.turning);
    (
        DIRECTIONS.map(|[x, y]| section.centre + (n * x + b * y) * radius),
        DIRECTIONS.map(|[x, y]| section.velocity + (dn * x + db * y) * radius),
    )
}

/// Weight of the corners of a circle's square.
const CORNER_WEIGHT: f64 = std::f64::consts::FRAC_1_SQRT_2;

impl Strip {
    /// Largest distance from the exact pipe at samples: seven between the sections, sixteen round.
    fn deviation(&self, piece: &Piece, stretch: &Stretch, radius: f64) -> f64 {
        let mut worst = 0.0_f64;
        for k in 1..8 {
            let y = f64::from(k) / 8.0;
            let basis = [
                (1.0 - y).powi(3),
                3.0 * y * (1.0 - y).powi(2),
                3.0 * y * y * (1.0 - y),
                y.powi(3),
            ];
            let round: [Vector3; ROUND] =
                std::array::from_fn(|j| (0..4).map(|i| self.rows[i][j] * basis[i]).sum());
            let x = stretch.from + y * (stretch.to - stretch.from);
            for arc in 0..4 {
                let [a, corner, b] = [0, 1, 2].map(|j| round[(2 * arc + j) % ROUND]);
                for z in [0.0, 0.25, 0.5, 0.75] {
                    let weights = [
                        (1.0 - z) * (1.0 - z),
                        2.0 * z * (1.0 - z) * CORNER_WEIGHT,
                        z * z,
                    ];
                    let point = (a * weights[0] + corner * weights[1] + b * weights[2])
                        / weights.iter().sum::<f64>();
                    worst = worst.max(distance_from_pipe(piece, x, &point, radius));
                }
            }
        }
        worst
    }
}

/// Distance of a point from the circle of the pipe in whose plane it lies, near x.
fn distance_from_pipe(piece: &Piece, x: f64, point: &Vector3, radius: f64) -> f64 {
    let mut x = x;
    for _ in 0..6 {
        let jet = piece.jet(x);
        let d = point - jet.point;
        let (residual, slope) = (
            d.dot(&jet.first),
            jet.first.norm_squared() - d.dot(&jet.second),
        );
        let step = residual / slope;
        // On the axis of curvature all planes nearby meet: any of them will do.
        if step.is_nan() || step.abs() >= 0.1 {
            break;
        }
        x = (x + step).clamp(0.0, 1.0);
    }
    let jet = piece.jet(x);
    let (d, tangent) = (point - jet.point, jet.first.normalize());
    let axial = d.dot(&tangent);
    let radial = (d - tangent * axial).norm() - radius;
    (axial * axial + radial * radial).sqrt()
}

/// One surface of all strips.
fn assemble(spine: &Spine, strips: &[Strip]) -> Result<Surface, SweepError> {
    let count = strips.len();
    let smooth = |k: usize| joins(&strips[(k + count - 1) % count], &strips[k]);
    let periodic = spine.is_closed() && count >= 3;
    let (mut knots, mut rows): (Vec<f64>, Vec<[Vector3; ROUND]>) = (Vec::new(), Vec::new());
    for (k, strip) in strips.iter().enumerate() {
        let start = strip.ends[0].parameter;
        let disjoined = k == 0 && !periodic;
        let sharp = disjoined || !smooth(k);
        knots.extend(std::iter::repeat_n(
            start,
            if disjoined {
                4
            } else if sharp {
                3
            } else {
                2
            },
        ));
        if sharp {
            rows.push(strip.rows[0]);
        }
        rows.extend([strip.rows[1], strip.rows[2]]);
    }
    let end = strips[count - 1].ends[1].parameter;
    let knots_u = if periodic {
        knots.push(end);
        // The first control point of a periodic direction lies two before its first knot.
        rows.rotate_right(2);
        KnotVector::periodic(3, knots)?
    } else {
        knots.extend([end; 4]);
        rows.push(strips[count - 1].rows[3]);
        KnotVector::new(3, knots)?
    };
    let knots_v = KnotVector::periodic(2, vec![0.0, 0.0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1.0])?;
    let mut weights = Vec::with_capacity(rows.len() * ROUND);
    let mut points: Vec<Point3> = Vec::with_capacity(rows.len() * ROUND);
    for row in &mut rows {
        // And one before it in v.
        row.rotate_right(1);
        points.extend(row.iter().map(|p| spine.place(p)));
        weights.extend([CORNER_WEIGHT, 1.0].repeat(ROUND / 2));
    }
    let net = ControlNet::new(rows.len(), ROUND, points)?;
    Ok(Surface::new(knots_u, knots_v, net, Some(weights))?)
}

/// True where the rows before and after a section have it on their segments, in proportion to the
/// knots: a double knot.
fn joins(before: &Strip, after: &Strip) -> bool {
    let length = |strip: &Strip| strip.ends[1].parameter - strip.ends[0].parameter;
    let (a, b) = (length(before), length(after));
    (0..ROUND).all(|j| {
        let (left, middle, right) = (before.rows[2][j], before.rows[3][j], after.rows[1][j]);
        let wanted = (left * b + right * a) / (a + b);
        (wanted - middle).norm() <= 1e-11 * (1.0 + middle.norm())
    })
}

#[cfg(test)]
#[path = "sweep_tests.rs"]
mod tests;
