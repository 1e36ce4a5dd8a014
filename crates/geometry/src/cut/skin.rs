//! A piece's boundary as one closed surface, so that the piece can be a body like the one it was cut from.
//!
//! ```text
//! skin and caps ──▶ even triangles at rest ──▶ faces and rims, a chain of sections from pole to pole
//! section ──▶ longitude and share of the length (harmonic) ──▶ samples on skin and caps ──▶ cubics, creases at the rims
//! ```
//! Rims of the chain are lines v = const with three knots: there the surface has an edge, and a flat cap is flat.

mod chart;
mod error;
mod fine;
mod fit;
mod harmonic;
mod levels;
mod made;
mod outline;
mod patch;
mod sections;
mod sheet;
mod sheet_fit;
#[cfg(test)]
mod sheet_tests;
#[cfg(test)]
mod tests;

pub use error::PieceSkinError;
pub use fit::LEAST_COUNTS;
pub use made::PieceSkin;
pub use sheet::SheetSpec;

use super::{Cut, Origin};
use crate::math::Point3;
use crate::surface::Surface;
use chart::{Chart, Kind, RimTurns, charts};
use fine::{Corner, EDGES, Fine, Sheets, finite};
use fit::{LEAST_STEPS, Layout, MOST_POINTS, farther};
use sections::{Net, Rim, Sections};

/// Edges of the triangles, of the root of the area: for this many control points.
const EDGE_COUNTS: f64 = 0.75;

/// What a piece's surface shall be like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkinSpec {
    /// Distinct control points around (u) and from pole to pole (v), poles included; at least [`LEAST_COUNTS`].
    pub counts: [usize; 2],
    /// Rims that become creases at most; the longest ones that are on one way from pole to pole do, if v has control points
    /// for them: 7 for one, 3 for each more.
    pub most_creases: usize,
}

impl Default for SkinSpec {
    fn default() -> Self {
        Self {
            counts: [24; 2],
            most_creases: 4,
        }
    }
}

impl Cut {
    /// The boundary of a piece as it is at rest, as one closed surface.
    ///
    /// The cut is of the surface as it stands; `rest` is that surface at rest, and `matter` gives the place at rest of a point
    /// (m) in the plane within the body. Of a body that is not deformed, `rest` is the surface that was cut, and `matter` gives
    /// each point back.
    ///
    /// # Errors
    /// A piece of a sheet, with a hole through it or that touches itself; fewer control points than [`LEAST_COUNTS`]; a surface at
    /// rest with other knots; places at rest that are not finite.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::cut::{CutPlane, SkinSpec, cut_by_plane};
    /// use palpate_geometry::math::{Point3, Vector3};
    /// use palpate_geometry::surface::builtin;
    /// let ball = builtin("sphere", None, Some(0.02))?;
    /// let plane = CutPlane::through(&Point3::origin(), &Vector3::z()).expect("a direction");
    /// let cut = cut_by_plane(&ball, &plane)?;
    /// let half = cut.skin(0, &ball, &mut |p| *p, &SkinSpec::default())?;
    /// assert!(half.surface.topology().is_closed());
    /// assert_eq!((half.creases, half.rims), (1, 1));
    /// assert!((half.surface.volume() / cut.pieces[0].volume_m3 - 1.0).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn skin(
        &self,
        piece: usize,
        rest: &Surface,
        matter: &mut dyn FnMut(&Point3) -> Point3,
        spec: &SkinSpec,
    ) -> Result<PieceSkin, PieceSkinError> {
        self.check(piece, rest, spec)?;
        let mut sheets = Sheets::new(self, rest, matter);
        let most = spec.counts[0].max(spec.counts[1]) as f64;
        let edge = (1.0 / (EDGE_COUNTS * most)).clamp(EDGES[0], EDGES[1]);
        let fine = Fine::new(&mut sheets, piece, edge)?;
        finite(&fine.corners)?;
        let net = Net::new(&fine)?;
        let sections =
            ((spec.counts[1] - 1) / LEAST_STEPS).min(spec.most_creases.clamp(1, MOST_POINTS) + 1);
        let mut sections = Sections::new(&fine, &net, sections)?;
        let is_tip = |corner: u32| match fine.corners[corner as usize].origin {
            Origin::Skin { u, v } => sheets.is_tip([u, v]),
            Origin::Cap => false,
        };
        let (charts, turns) = charts(&fine, &net, &mut sections, &is_tip)?;
        let lengths: Vec<f64> = charts.iter().map(|chart| chart.length_m).collect();
        let layout = Layout::new(spec.counts, &lengths)?;
        let samples = Sampler {
            sheets,
            fine: &fine,
            rims: &sections.rims,
            turns: &turns,
            layout: &layout,
        }
        .all(&charts)?;
        let surface = layout.fitted(&samples)?;
        let off_m = farthest(&surface, &fine, &charts, &layout);
        Ok(PieceSkin {
            surface,
            off_m,
            creases: sections.rims.len(),
            rims: sections.all_rims,
        })
    }

    fn check(&self, piece: usize, rest: &Surface, spec: &SkinSpec) -> Result<(), PieceSkinError> {
        let [around, along] = spec.counts;
        self.check_rest(piece, rest)?;
        if !self.closed {
            return Err(PieceSkinError::Sheet);
        }
        let few = around < LEAST_COUNTS[0] || along < LEAST_COUNTS[1];
        if few || around.saturating_mul(along) > MOST_POINTS {
            return Err(PieceSkinError::Counts {
                counts: spec.counts,
            });
        }
        Ok(())
    }
}

/// Puts samples on skin, rims and caps.
struct Sampler<'a, 'b> {
    sheets: Sheets<'a>,
    fine: &'b Fine,
    rims: &'b [Rim],
    turns: &'b [RimTurns],
    layout: &'b Layout,
}

impl Sampler<'_, '_> {
    /// (sections) (turns × shares), at rest.
    fn all(&mut self, charts: &[Chart]) -> Result<Vec<Vec<Point3>>, PieceSkinError> {
        let turns = self.layout.turns();
        let rims: Vec<Vec<Corner>> = (0..self.rims.len())
            .map(|rim| turns.iter().map(|&turn| self.on_rim(rim, turn)).collect())
            .collect();
        let mut all = Vec::with_capacity(charts.len());
        for (k, chart) in charts.iter().enumerate() {
            // At a pole all lines are one point.
            let pole = match chart.kind {
                Kind::First => Some(self.within(chart, 0.0, 0.0)),
                Kind::Last => Some(self.within(chart, 0.0, 1.0)),
                Kind::Ring | Kind::Patch => None,
            };
            let shares = self.layout.shares(k);
            let mut samples = Vec::with_capacity(turns.len() * shares.len());
            for (i, &turn) in turns.iter().enumerate() {
                for (j, &share) in shares.iter().enumerate() {
                    let sample = match (j == 0, j + 1 == shares.len(), chart.kind, pole) {
                        (true, _, Kind::First, Some(pole)) => pole,
                        (_, true, Kind::Last, Some(pole)) => pole,
                        (true, ..) => rims[k - 1][i],
                        (_, true, ..) => rims[k][i],
                        _ => self.within(chart, turn, share),
                    };
                    samples.push(sample);
                }
            }
            finite(&samples)?;
            all.push(samples.into_iter().map(|sample| sample.rest).collect());
        }
        Ok(all)
    }

    fn on_rim(&mut self, rim: usize, turn: f64) -> Corner {
        let (k, t) = self.turns[rim].find(turn);
        let corners = &self.rims[rim].corners;
        let ends = [corners[k], corners[(k + 1) % corners.len()]];
        let [a, b] = ends.map(|c| self.fine.corners[c as usize]);
        let lies = self.rims[rim].lies;
        self.sheets.between(&[(a, 1.0 - t), (b, t)], lies)
    }

    fn within(&mut self, chart: &Chart, turn: f64, share: f64) -> Corner {
        chart.corner(self.fine, &mut self.sheets, [turn, share])
    }
}

/// The farthest that a corner of the triangles is from the surface, m.
fn farthest(surface: &Surface, fine: &Fine, charts: &[Chart], layout: &Layout) -> f64 {
    let mut most = 0.0_f64;
    for (k, chart) in charts.iter().enumerate() {
        for &(corner, [turn, share]) in &chart.corners {
            let at = [turn, layout.v(k, share)];
            most = farther(surface, at, &fine.corners[corner as usize].rest, most);
        }
    }
    most
}
