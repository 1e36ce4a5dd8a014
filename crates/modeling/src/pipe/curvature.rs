//! Local self-intersection: the largest curvature.
//!
//! κ² = |K|² W⁶ / |N|⁶ is stationary where K · K' W |N|² + 3 |K|² W' |N|² − 3 |K|² (N · N') W = 0,
//! of degree 11n − 17. The candidates are those roots and both ends of every piece, since curvature
//! may jump at joints. Where the spine turns by a corner the pipe of any radius intersects itself:
//! radius 0.

use super::forms::{Bernstein3, Forms, derivative, dot};
use super::spine::Spine;
use crate::ipp::{Bernstein, SingleRoot, Status, roots};
use palpate_geometry::math::Point3;

/// What makes the curvature largest at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum LocalKind {
    /// Curvature is stationary.
    Critical,
    /// An end of a piece.
    Joint,
    /// An end of the spine.
    End,
    /// The tangent jumps: the radius is 0.
    Corner,
}

/// The answer for local self-intersection.
#[derive(Clone, Copy, Debug, Default)]
pub struct LocalCurvature {
    /// 1 / κ_max, m; `None` for a straight spine.
    pub radius_m: Option<f64>,
    /// Where the bound is attained.
    pub witness: Option<LocalWitness>,
    /// What the answer rests on.
    pub status: Status,
}

/// Where the spine bends most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalWitness {
    /// Parameter on the curve.
    pub parameter: f64,
    /// The point, m.
    pub point: Point3,
    /// What makes it largest there.
    pub kind: LocalKind,
}

/// Samples of a part in which the derivative of the curvature is all rounding: curvature is
/// constant there.
const SAMPLES: usize = 32;

/// Largest curvature of a spine.
pub fn largest_curvature(spine: &Spine) -> LocalCurvature {
    let mut status = Status::default();
    let (mut most, mut witness) = (0.0, None);
    let count = spine.pieces.len();
    for (k, (piece, forms)) in spine.pieces.iter().zip(&spine.forms).enumerate() {
        let Some(wronskian) = forms.wronskian().filter(bends) else {
            continue;
        };
        let solution = roots(&derivative_of_square(forms, &wronskian));
        status = status.max(solution.status);
        let end = |outer: bool| {
            if outer && !spine.is_closed() {
                LocalKind::End
            } else {
                LocalKind::Joint
            }
        };
        let mut candidates = vec![(0.0, end(k == 0)), (1.0, end(k + 1 == count))];
        candidates.extend(
            solution
                .roots
                .iter()
                .flat_map(places)
                .map(|x| (x, LocalKind::Critical)),
        );
        for (x, kind) in candidates {
            let jet = piece.jet(x);
            if jet.curvature() > most {
                most = jet.curvature();
                let (parameter, point) = (piece.parameter(x), spine.place(&jet.point));
                witness = Some(LocalWitness {
                    parameter,
                    point,
                    kind,
                });
            }
        }
    }
    if let Some(corner) = spine
        .corners()
        .iter()
        .max_by(|a, b| a.turn_rad.total_cmp(&b.turn_rad))
    {
        let point = spine.place(&spine.pieces[corner.piece].jet(1.0).point);
        let witness = LocalWitness {
            parameter: corner.parameter,
            point,
            kind: LocalKind::Corner,
        };
        return LocalCurvature {
            radius_m: Some(0.0),
            witness: Some(witness),
            status: Status::Complete,
        };
    }
    LocalCurvature {
        radius_m: witness.map(|_| spine.metres(1.0 / most)),
        witness,
        status,
    }
}

/// The places to look at: a root, or samples of a part that is not resolved.
fn places(root: &SingleRoot) -> Vec<f64> {
    if root.simple {
        return vec![root.at];
    }
    let count = if root.high - root.low > 1e-6 {
        SAMPLES
    } else {
        2
    };
    (0..=count)
        .map(|k| root.low + (root.high - root.low) * k as f64 / count as f64)
        .collect()
}

/// False where K is nothing but rounding: the piece is straight.
fn bends(wronskian: &Bernstein3) -> bool {
    wronskian.iter().any(|axis| {
        axis.coefficients()
            .iter()
            .any(|a| a.mid().abs() > 4.0 * a.radius())
    })
}

fn derivative_of_square(forms: &Forms, k: &Bernstein3) -> Bernstein {
    let (n, w) = (&forms.hodograph, forms.weight());
    let (kk, nn) = (dot(k, k), dot(n, n));
    let rise = dot(k, &derivative(k)).times(&w).times(&nn);
    let thin = kk.times(&w.derivative()).times(&nn).scaled(3.0);
    let fast = kk.times(&dot(n, &derivative(n))).times(&w).scaled(3.0);
    rise.plus(&thin).minus(&fast)
}
