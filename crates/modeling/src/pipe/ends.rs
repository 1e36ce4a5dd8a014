//! End circle to end circle, and end circle to body.
//!
//! Two end circles touch where a point y (from the first centre) lies in both planes and at equal
//! distance from both centres: T₀ · y = 0, T₁ · y = T₁ · e, e · y = |e|² / 2 (Patrikalakis &
//! Maekawa, (11.116) to (11.121)). We take the shortest solution; a planar spine makes the three
//! planes share a line or none, so singular systems are the normal case.
//!
//! An end circle touches the body at t where r = R(t) = |d|² / (2 |d⊥|) and R'(t) = 0, d = c(t) −
//! c₀ and d⊥ its part normal to T₀: the angle on the circle of (11.132) to (11.134) is eliminated.
//! In homogeneous form, with D = X − c₀ W, F = 2 (D · N) |D⊥|² − |D|² (D⊥ · N⊥) = 0; on the end's
//! own piece D = t D̂, D⊥ = t² D̂⊥, N⊥ = t N̂⊥ leave degree 5n − 7, and what is left still vanishes
//! at t = 0 (R runs into the radius of curvature there, F/t⁵ into 2 a² (b/2)² − a² (b/2) b with a =
//! c', b the normal part of c''): degree 5n − 8.

use super::forms::{Bernstein3, Forms, dot};
use super::piece::Piece;
use super::spine::Spine;
use crate::ipp::{Bernstein, Interval, SingleRoot, Status, roots};
use palpate_geometry::math::{Point3, Vector3};

/// End circle to end circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndToEnd {
    /// Radius, m.
    pub radius_m: f64,
    /// Where the circles touch, m.
    pub point: Point3,
}

/// End circle to body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndToBody {
    /// Radius, m.
    pub radius_m: f64,
    /// The end: 0 for the start, 1 for the end.
    pub end: usize,
    /// Parameter of the body's circle that is touched.
    pub parameter: f64,
    /// Where they touch, m.
    pub point: Point3,
}

/// The answer for end circle to body.
#[derive(Clone, Debug, Default)]
pub struct EndsToBody {
    /// Every stationary touch, the smallest radius first.
    pub touches: Vec<EndToBody>,
    /// What the answer rests on.
    pub status: Status,
}

/// Singular values and residuals below this share count as zero.
const SINGULAR: f64 = 1e-9;
/// A radius of so many sizes of the spine is a pole of R, not a touch.
const POLE: f64 = 1e3;
/// Samples of a part where F is all rounding: R is constant there.
const SAMPLES: usize = 32;

/// `None` where the end circles never touch, and for closed spines, which have none.
pub fn end_to_end(spine: &Spine) -> Option<EndToEnd> {
    if spine.is_closed() {
        return None;
    }
    let [(start, t0), (end, t1)] = spine.ends();
    let e = end - start;
    let length = e.norm();
    if length <= SINGULAR {
        return Some(EndToEnd {
            radius_m: 0.0,
            point: spine.place(&start),
        });
    }
    let toward = e / length;
    let y = least_norm([t0, t1, toward], [0.0, t1.dot(&e), 0.5 * length])?;
    let residual = t0
        .dot(&y)
        .abs()
        .max((t1.dot(&y) - t1.dot(&e)).abs())
        .max((toward.dot(&y) - 0.5 * length).abs());
    let touch = EndToEnd {
        radius_m: spine.metres(y.norm()),
        point: spine.place(&(start + y)),
    };
    (residual <= SINGULAR * length).then_some(touch)
}

/// The shortest x with least |A x − b|, A given by unit rows: one-sided Jacobi rotations make the
/// rows orthogonal.
fn least_norm(mut rows: [Vector3; 3], mut b: [f64; 3]) -> Option<Vector3> {
    for _ in 0..30 {
        let mut turned = 0.0_f64;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (ii, jj, ij) = (
                rows[i].norm_squared(),
                rows[j].norm_squared(),
                rows[i].dot(&rows[j]),
            );
            if ij.abs() <= 1e-30 || ij * ij <= 1e-34 * ii * jj {
                continue;
            }
            let zeta = (jj - ii) / (2.0 * ij);
            let tangent = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
            let c = 1.0 / (1.0 + tangent * tangent).sqrt();
            let s = c * tangent;
            (rows[i], rows[j]) = (rows[i] * c - rows[j] * s, rows[i] * s + rows[j] * c);
            (b[i], b[j]) = (b[i] * c - b[j] * s, b[i] * s + b[j] * c);
            turned = turned.max(tangent.abs());
        }
        if turned == 0.0 {
            break;
        }
    }
    let largest = rows.iter().map(|row| row.norm()).fold(0.0, f64::max);
    let mut x = Vector3::zeros();
    for (row, side) in rows.iter().zip(b) {
        if row.norm() > SINGULAR * largest {
            x += row * (side / row.norm_squared());
        }
    }
    x.iter().all(|x| x.is_finite()).then_some(x)
}

/// All radii at which an end circle touches the body.
pub fn ends_to_body(spine: &Spine) -> EndsToBody {
    let mut answer = EndsToBody::default();
    if spine.is_closed() {
        return answer;
    }
    for (end, pieces) in [spine.pieces.clone(), spine.reversed_pieces()]
        .iter()
        .enumerate()
    {
        let (centre, tangent) = (pieces[0].points[0], pieces[0].jet(0.0).first.normalize());
        for (k, piece) in pieces.iter().enumerate() {
            let from = if k == 0 {
                FromEnd::own(piece, tangent)
            } else {
                FromEnd::other(piece, centre, tangent)
            };
            let Some(from) = from else { continue };
            let solution = roots(&from.equation);
            let mut counts = false;
            for x in solution.roots.iter().flat_map(places) {
                let radius = from.radius(x);
                if radius.is_nan() || radius > POLE {
                    continue;
                }
                counts = true;
                let point = touching_point(piece.jet(x).point, centre, tangent, radius);
                let (parameter, radius_m) = (piece.parameter(x), spine.metres(radius));
                answer.touches.push(EndToBody {
                    radius_m,
                    end,
                    parameter,
                    point: spine.place(&point),
                });
            }
            // A straight piece has F = 0 too, with R infinite: nothing is in doubt there.
            if counts || solution.status == Status::Budget {
                answer.status = answer.status.max(solution.status);
            }
        }
    }
    answer
        .touches
        .sort_by(|a, b| a.radius_m.total_cmp(&b.radius_m));
    answer
}

/// On the end circle, in the direction of the body's point.
fn touching_point(body: Vector3, centre: Vector3, tangent: Vector3, radius: f64) -> Vector3 {
    let d = body - centre;
    let across = d - tangent * d.dot(&tangent);
    if across.norm() > 0.0 {
        centre + across.normalize() * radius
    } else {
        centre
    }
}

fn places(root: &SingleRoot) -> Vec<f64> {
    if root.simple || root.high - root.low < 1e-9 {
        return vec![root.at];
    }
    (0..=SAMPLES)
        .map(|k| root.low + (root.high - root.low) * k as f64 / SAMPLES as f64)
        .collect()
}

/// R along a piece, and the equation of its stationary points.
struct FromEnd {
    equation: Bernstein,
    /// |D|².
    square: Bernstein,
    /// |D⊥|².
    across: Bernstein,
    weight: Bernstein,
}

impl FromEnd {
    /// The piece that starts at the end, the trivial factors removed. `None` for a line of degree
    /// 1: R is infinite.
    fn own(piece: &Piece, tangent: Vector3) -> Option<Self> {
        let forms = Forms::new(piece);
        if forms.degree < 2 {
            return None;
        }
        let direction = intervals(tangent);
        // D = t D̂, D̂ = Σ (n / j) w_j (P_j − P_0): differences only.
        let d = relative(&forms, forms.points[0]).map(|axis| axis.without_root_at_zero());
        let d_across = across(&d, &direction).map(|axis| axis.without_root_at_zero());
        let n_across = across(&forms.hodograph, &direction).map(|axis| axis.without_root_at_zero());
        let mut own = Self::assemble(&forms, d, d_across, n_across);
        own.equation = own.equation.without_root_at_zero();
        Some(own)
    }

    fn other(piece: &Piece, centre: Vector3, tangent: Vector3) -> Option<Self> {
        let forms = Forms::new(piece);
        let direction = intervals(tangent);
        let d = relative(&forms, [0, 1, 2].map(|axis| Interval::point(centre[axis])));
        let (d_across, n_across) = (across(&d, &direction), across(&forms.hodograph, &direction));
        Some(Self::assemble(&forms, d, d_across, n_across))
    }

    fn assemble(forms: &Forms, d: Bernstein3, d_across: Bernstein3, n_across: Bernstein3) -> Self {
        let (square, across) = (dot(&d, &d), dot(&d_across, &d_across));
        let first = dot(&d, &forms.hodograph).times(&across).scaled(2.0);
        let equation = first.minus(&square.times(&dot(&d_across, &n_across)));
        Self {
            equation,
            square,
            across,
            weight: forms.weight(),
        }
    }

    /// R, in units of the pieces; 0 where the body passes through the centre.
    fn radius(&self, x: f64) -> f64 {
        let square = self.square.value(x);
        if square <= 0.0 {
            0.0
        } else {
            square / (2.0 * self.weight.value(x) * self.across.value(x).max(0.0).sqrt())
        }
    }
}

/// X − c₀ W.
fn relative(forms: &Forms, centre: [Interval; 3]) -> Bernstein3 {
    [0, 1, 2].map(|axis| {
        let terms = forms.points.iter().zip(&forms.weights);
        Bernstein::new(terms.map(|(p, &w)| w * (p[axis] - centre[axis])).collect())
    })
}

/// A unit vector to within its rounding.
fn intervals(unit: Vector3) -> [Interval; 3] {
    [0, 1, 2].map(|axis| Interval::around(unit[axis], 4.0 * f64::EPSILON))
}

/// The part normal to a direction.
fn across(a: &Bernstein3, direction: &[Interval; 3]) -> Bernstein3 {
    let along: Vec<Interval> = (0..=a[0].degree())
        .map(|k| {
            (0..3).fold(Interval::ZERO, |sum, axis| {
                sum + a[axis].coefficients()[k] * direction[axis]
            })
        })
        .collect();
    [0, 1, 2].map(|axis| {
        let terms = a[axis].coefficients().iter().zip(&along);
        Bernstein::new(
            terms
                .map(|(&a, &along)| a - along * direction[axis])
                .collect(),
        )
    })
}
