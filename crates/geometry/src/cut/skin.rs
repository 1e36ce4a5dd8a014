//! A piece's boundary as one closed surface, so that the piece can be a body like the one it was cut from.
//!
//! ```text
//! skin and caps ──▶ even triangles at rest ──▶ faces and rims, a chain of sections from pole to pole
//! section ──▶ longitude and share of the length (harmonic) ──▶ samples on skin and caps ──▶ cubics, creases at the rims
//! ```
//! Rims of the chain are lines v = const with three knots: there the surface has an edge, and a flat cap is flat.

mod chart;
mod fine;
mod fit;
mod harmonic;
mod levels;
mod sections;
#[cfg(test)]
mod tests;

use super::{Cut, CutMeshError, Origin};
use crate::math::{MOST_COORDINATE_M, Point3};
use crate::surface::{Surface, SurfaceError};
use chart::{Chart, Kind, RimTurns, charts};
use fine::{Corner, Fine, Lies, Sheets};
use fit::{LEAST_STEPS, Layout, farther};
use sections::{Net, Rim, Sections};

/// Control points that a net has at least, around and from pole to pole: a disc on each side of a rim.
pub const LEAST_COUNTS: [usize; 2] = [4, 2 * LEAST_STEPS + 1];
/// Control points at most.
const MOST_POINTS: usize = 1 << 16;
/// Edges of the triangles, of the root of the area: for this many control points, and no longer or shorter than these.
const EDGE_COUNTS: f64 = 0.75;
const EDGES: [f64; 2] = [1.0 / 50.0, 1.0 / 14.0];

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

/// A piece's boundary as one closed surface.
#[derive(Clone, Debug)]
pub struct PieceSkin {
    /// Bicubic, periodic in u, with poles at both ends of v, normals outwards.
    pub surface: Surface,
    /// The farthest that a sample of the piece's boundary at rest is from the surface, m; samples are everywhere, also between
    /// those that were fitted.
    pub off_m: f64,
    /// How many of the rims are creases of the surface.
    pub creases: usize,
    /// Rims of the piece, and creases that the surface had and that no rim meets, as those of a former cut.
    pub rims: usize,
}

/// Why a piece has no such surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PieceSkinError {
    /// A number that is not of a piece.
    #[error("there is no piece {piece}: the cut has {count}, counted from 0")]
    Piece {
        /// As asked for.
        piece: usize,
        /// As there are.
        count: usize,
    },
    /// A sheet has no inside.
    #[error("a piece of an open sheet bounds no body: close the surface before the cut")]
    Sheet,
    /// Too small or too large a net.
    #[error(
        "a net of {} × {} is not possible: it takes {} × {} control points at least, {MOST_POINTS} at most altogether",
        counts[0], counts[1], LEAST_COUNTS[0], LEAST_COUNTS[1]
    )]
    Counts {
        /// As asked for.
        counts: [usize; 2],
    },
    /// The surface at rest is another one.
    #[error(
        "the surface at rest does not have the knots and the net of the surface that was cut: give the same one, moved"
    )]
    Rest,
    /// A hole goes through the piece.
    #[error(
        "the piece has {handles} holes through it, as a ring cut along its plane: a surface with two poles has none; cut the \
         ring across first"
    )]
    Handles {
        /// How many.
        handles: usize,
    },
    /// Rims or faces that touch in a point.
    #[error(
        "parts of the piece's boundary touch in single points: move or tilt the plane by a thousandth of the size"
    )]
    Pinched,
    /// More triangles than allowed.
    #[error(
        "the piece's boundary takes more than {most} triangles: it is too thin or too rough; move or tilt the plane"
    )]
    TooFine {
        /// As allowed.
        most: usize,
    },
    /// Matter goes nowhere.
    #[error(
        "a place of the piece is at ({x} m, {y} m, {z} m) at rest, not finite within ±{MOST_COORDINATE_M:e} m: `matter` must \
         give a place for every point of the caps"
    )]
    NotFinite {
        /// m.
        x: f64,
        /// m.
        y: f64,
        /// m.
        z: f64,
    },
    /// Triangles of skin and caps.
    #[error("the piece is not divided into triangles: {0}")]
    Triangles(#[from] CutMeshError),
    /// A surface that cannot be.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
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
        let own = &self.surface;
        let still = rest.net() == own.net() && rest.weights() == own.weights();
        let mut sheets = Sheets {
            cut: self,
            rest: if still { own } else { rest },
            matter,
        };
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
        let own = &self.surface;
        let same = rest.knots_u() == own.knots_u()
            && rest.knots_v() == own.knots_v()
            && rest.net().points().len() == own.net().points().len()
            && rest.topology() == own.topology();
        if piece >= self.pieces.len() {
            return Err(PieceSkinError::Piece {
                piece,
                count: self.pieces.len(),
            });
        }
        if !self.closed {
            return Err(PieceSkinError::Sheet);
        }
        let few = around < LEAST_COUNTS[0] || along < LEAST_COUNTS[1];
        if few || around.saturating_mul(along) > MOST_POINTS {
            return Err(PieceSkinError::Counts {
                counts: spec.counts,
            });
        }
        match same {
            true => Ok(()),
            false => Err(PieceSkinError::Rest),
        }
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
                Kind::Ring => None,
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
        let (triangle, weights) = chart.find(turn, share);
        let corners = self.fine.triangles[triangle as usize].map(|c| self.fine.corners[c as usize]);
        let lies = match self.fine.caps[triangle as usize] {
            Some(_) => Lies::Cap,
            None => Lies::Skin,
        };
        let [a, b, c] = [0, 1, 2].map(|k| (corners[k], weights[k]));
        self.sheets.between(&[a, b, c], lies)
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

/// All can be calculated with.
fn finite(corners: &[Corner]) -> Result<(), PieceSkinError> {
    let good = |p: &Point3| p.iter().all(|x| x.abs() <= MOST_COORDINATE_M);
    match corners.iter().find(|corner| !good(&corner.rest)) {
        Some(Corner { rest, .. }) => Err(PieceSkinError::NotFinite {
            x: rest.x,
            y: rest.y,
            z: rest.z,
        }),
        None => Ok(()),
    }
}
