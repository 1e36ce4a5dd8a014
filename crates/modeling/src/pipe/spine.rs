//! A spine, ready for the questions: Bézier pieces in a scale of its own, checked to be one regular
//! curve.

use super::PipeError;
use super::forms::Forms;
use super::piece::{Piece, power_of_two_below};
use crate::ipp::common_zero;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Curve;

/// End points nearer than this share of the spine's size are one point.
const SAME: f64 = 1e-9;

/// Tangents that turn by more than this at a joint make a corner, rad: files with seven digits
/// pass.
pub const CORNER_RAD: f64 = 1e-6;

/// Most pieces of a spine: pairs grow with the square.
pub const MOST_PIECES: usize = 1_000;

/// A regular curve in Bézier pieces.
#[derive(Clone, Debug)]
pub struct Spine {
    /// In order; each ends bit for bit where the next starts.
    pub(super) pieces: Vec<Piece>,
    pub(super) forms: Vec<Forms>,
    origin: Vector3,
    /// Metres to one unit of the pieces; a power of two.
    scale_m: f64,
    closed: bool,
    corners: Vec<Corner>,
}

/// A place where the tangent jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Parameter of the spine.
    pub parameter: f64,
    /// Angle between the tangents, rad.
    pub turn_rad: f64,
    /// Index of the piece that ends there.
    pub(super) piece: usize,
}

impl Spine {
    /// Splits a curve into its pieces and checks them.
    ///
    /// # Errors
    /// A curve without length, of too many pieces, in parts that do not meet, or with a point where
    /// c' = 0.
    pub fn new(curve: &Curve) -> Result<Self, PipeError> {
        let spans: Vec<usize> = curve.knots().spans().collect();
        if spans.len() > MOST_PIECES {
            return Err(PipeError::TooManyPieces {
                pieces: spans.len(),
            });
        }
        let (origin, scale_m) = frame(curve.points())?;
        let knots = curve.knots().knots();
        let mut pieces = Vec::with_capacity(spans.len());
        for span in spans {
            pieces.push(bezier(
                curve,
                knots[span],
                knots[span + 1],
                origin,
                scale_m,
            )?);
        }
        let mut closed = false;
        join(&mut pieces, scale_m)?;
        let (first, last) = (
            pieces[0].points[0],
            *pieces[pieces.len() - 1]
                .points
                .last()
                .expect("degree + 1 points"),
        );
        let forms: Vec<Forms> = pieces.iter().map(Forms::new).collect();
        for (piece, forms) in pieces.iter().zip(&forms) {
            if let Some(x) = common_zero(&forms.hodograph) {
                return Err(PipeError::NotRegular {
                    parameter: piece.parameter(x),
                });
            }
        }
        let ends = (
            pieces[0].jet(0.0).first,
            pieces[pieces.len() - 1].jet(1.0).first,
        );
        if (first - last).norm() <= SAME {
            closed = angle(&ends.1, &ends.0) <= CORNER_RAD || curve.knots().is_periodic();
        }
        let mut spine = Self {
            pieces,
            forms,
            origin,
            scale_m,
            closed,
            corners: Vec::new(),
        };
        if spine.closed {
            spine.cut_to_three();
        }
        spine.corners = spine.find_corners();
        Ok(spine)
    }

    /// True when it ends where it starts, in the same direction.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Bézier pieces. Those of a closed spine are at least three.
    pub fn piece_count(&self) -> usize {
        self.pieces.len()
    }

    /// Where the tangent jumps.
    pub fn corners(&self) -> &[Corner] {
        &self.corners
    }

    /// First and last parameter.
    pub fn domain(&self) -> (f64, f64) {
        (self.pieces[0].start, self.pieces[self.pieces.len() - 1].end)
    }

    /// A length in metres.
    pub(super) fn metres(&self, length: f64) -> f64 {
        length * self.scale_m
    }

    /// A length of metres in the spine's unit.
    pub(super) fn units(&self, length_m: f64) -> f64 {
        length_m / self.scale_m
    }

    /// A place in metres.
    pub(super) fn place(&self, point: &Vector3) -> Point3 {
        Point3::from(point * self.scale_m + self.origin)
    }

    /// Unit tangents and end points: at the start, at the end.
    pub(super) fn ends(&self) -> [(Vector3, Vector3); 2] {
        let (first, last) = (&self.pieces[0], &self.pieces[self.pieces.len() - 1]);
        let (a, b) = (first.jet(0.0), last.jet(1.0));
        [
            (a.point, a.first.normalize()),
            (b.point, b.first.normalize()),
        ]
    }

    /// The pieces in reverse order, each reversed.
    pub(super) fn reversed_pieces(&self) -> Vec<Piece> {
        self.pieces.iter().rev().map(Piece::reversed).collect()
    }

    /// A closed spine of one or two pieces would have pieces that meet at both ends.
    fn cut_to_three(&mut self) {
        while self.pieces.len() < 3 {
            self.pieces = self
                .pieces
                .iter()
                .flat_map(|piece| <[Piece; 2]>::from(piece.split(0.5)))
                .collect();
            self.forms = self.pieces.iter().map(Forms::new).collect();
        }
    }

    fn find_corners(&self) -> Vec<Corner> {
        let count = self.pieces.len();
        let joints = if self.closed { count } else { count - 1 };
        let mut corners = Vec::new();
        for piece in 0..joints {
            let (before, after) = (&self.pieces[piece], &self.pieces[(piece + 1) % count]);
            let turn_rad = angle(&before.jet(1.0).first, &after.jet(0.0).first);
            if turn_rad > CORNER_RAD {
                corners.push(Corner {
                    parameter: before.end,
                    turn_rad,
                    piece,
                });
            }
        }
        corners
    }
}

/// Angle between two directions, rad, in [0, π].
pub(super) fn angle(a: &Vector3, b: &Vector3) -> f64 {
    libm::atan2(a.cross(b).norm(), a.dot(b))
}

/// The middle of the control points' box, and a power of two near its size, m.
fn frame(points: &[Point3]) -> Result<(Vector3, f64), PipeError> {
    let (mut low, mut high) = (points[0], points[0]);
    for point in points {
        low = low.inf(point);
        high = high.sup(point);
    }
    let size_m = (high - low).amax();
    if size_m.is_nan() || !(1e-140..1e140).contains(&size_m) {
        return Err(PipeError::Size { size_m });
    }
    let origin = low.coords + (high - low) * 0.5;
    // Coordinates that are all rounding: far from 0 beside their differences.
    if size_m < 1e-10 * origin.amax() {
        return Err(PipeError::FarAway {
            size_m,
            distance_m: origin.amax(),
        });
    }
    Ok((origin, power_of_two_below(size_m)))
}

/// The control points of one span: blossoms of the homogeneous curve.
fn bezier(
    curve: &Curve,
    start: f64,
    end: f64,
    origin: Vector3,
    scale_m: f64,
) -> Result<Piece, PipeError> {
    // A periodic vector's spans may lie beside its domain by whole periods only; those of the
    // domain are listed.
    let change = curve
        .knots()
        .restriction(start, end)
        .map_err(PipeError::Knots)?;
    let line: Vec<(Vector3, f64)> = (0..change.knots().count())
        .map(|row| {
            change
                .entries(row)
                .fold((Vector3::zeros(), 0.0), |(point, weight), (k, factor)| {
                    let w = factor * curve.weights().map_or(1.0, |weights| weights[k]);
                    (
                        point + (curve.points()[k].coords - origin) / scale_m * w,
                        weight + w,
                    )
                })
        })
        .collect();
    if let Some(index) = line
        .iter()
        .position(|(p, w)| !(*w > 0.0 && p.iter().all(|x| x.is_finite())))
    {
        return Err(PipeError::Weights {
            parameter: start,
            weight: line[index].1,
        });
    }
    Ok(Piece::from_homogeneous(start, end, &line))
}

/// Makes neighbours share their common point bit for bit; refuses a gap.
fn join(pieces: &mut [Piece], scale_m: f64) -> Result<(), PipeError> {
    for k in 1..pieces.len() {
        let (before, after) = pieces.split_at_mut(k);
        let last = before[k - 1].points.last().expect("degree + 1 points");
        let gap = (last - after[0].points[0]).norm();
        if gap > SAME {
            return Err(PipeError::Disjoined {
                parameter: after[0].start,
                gap_m: gap * scale_m,
            });
        }
        after[0].points[0] = *last;
    }
    Ok(())
}
