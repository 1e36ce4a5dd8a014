//! The ten spines that the pipe is measured with, and what is known of them.
//!
//! `example-…` are those of Patrikalakis & Maekawa; the others were made to be hard. Parameters and
//! distances of the pairs come from 40-digit arithmetic, the radii of the splines and all other
//! figures from double precision.

use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::Point3;
use palpate_geometry::surface::Curve;

/// A spine with its reference figures, m.
#[derive(Clone, Debug, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PipeCase {
    /// Name of the case.
    pub name: String,
    degree: usize,
    knots: Vec<f64>,
    points: Vec<[f64; 3]>,
    weights: Vec<f64>,
    /// Stationary pairs: s, t, distance.
    pub pairs: Vec<[f64; 3]>,
    /// 1 / κ_max.
    pub r_local: f64,
    /// Body to body; `None` where infinite.
    pub r_bb: Option<f64>,
    /// End to end; `None` where infinite or not known.
    pub r_ee: Option<f64>,
    /// End to body; `None` where infinite or not known.
    pub r_eb: Option<f64>,
    /// Where the curvature is largest, if known.
    pub t_kappa_max: Option<f64>,
}

impl PipeCase {
    /// The spine.
    pub fn curve(&self) -> Curve {
        let knots = KnotVector::new(self.degree, self.knots.clone()).expect("knots of the data");
        let points = self.points.iter().map(|p| Point3::from(*p)).collect();
        Curve::new(knots, points, Some(self.weights.clone())).expect("points of the data")
    }
}

/// All cases, in order of the table.
pub fn cases() -> Vec<PipeCase> {
    serde_json::from_str(include_str!("data/cases.json")).expect("the data are a list of cases")
}
