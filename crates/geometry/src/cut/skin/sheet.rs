//! A piece of a sheet as one open surface, so that the piece can be a body like the one it was cut from.
//!
//! ```text
//! skin ──▶ even triangles at rest ──▶ rims ──▶ one with corners: a square;  one without: a disc;  two: a ring
//! ```
//! A rim of the cut is a line v = const or u = const of the surface, and as flat at rest as the cut is.

use super::chart::{Chart, Kind, Maker, RimTurns};
use super::error::PieceSkinError;
use super::fine::{Corner, EDGES, Fine, Sheets, finite};
use super::fit::{MOST_POINTS, farther};
use super::harmonic::Harmonic;
use super::made::PieceSkin;
use super::outline::{Turn, begin_at, four_corners, has_corners, rims, sharp_corners};
use super::patch::{self, Line, four_sides, lengths_m};
use super::sections::{Net, Rim};
use super::sheet_fit::SheetLayout;
use crate::cut::{Cut, Origin};
use crate::math::Point3;
use crate::surface::Surface;

/// Control points at least, around and from the rim on, or along each side of a square.
const LEAST_ROUND: [usize; 2] = [12, 10];
const LEAST_SQUARE: [usize; 2] = [8; 2];
/// Of the size and of the area: a surface that is farther off is made in the other way too, and the better one is taken.
const GOOD: f64 = 5e-3;
/// Of the area: a surface that has more or less of it than by this is folded.
const MOST_MORE: f64 = 0.02;
/// Squares of its rim's length by the area below which a sheet is a bag with a narrow opening, and no square.
const NARROW: f64 = 3.5;
/// A square that bulges is so much longer than its sides at most.
const MOST_BULGE: f64 = 1.5;
/// A disc that bulges is wider than in the mean of its lines around.
const BULGE: f64 = 1.5;

/// What the surface of a piece of a sheet shall be like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetSpec {
    /// About how far apart control points are, m; small pieces have 8 along each side at least.
    pub spacing_m: f64,
}

/// A sheet laid out.
struct Plan {
    chart: Chart,
    shape: Shape,
    /// Along u and along v, m.
    lengths_m: [f64; 2],
    /// In u and in v: where rims have sharp corners that are not those of a square.
    breaks: [Vec<f64>; 2],
}

enum Shape {
    /// The rim, at v = 0.
    Disc(Line),
    /// The rims, at both ends of v.
    Ring([Line; 2]),
    /// v = 0, u = 1, v = 1, u = 0.
    Square([Line; 4]),
}

impl Cut {
    /// A piece of a sheet as it is at rest, as one open surface.
    ///
    /// The cut is of the surface as it stands; `rest` is that surface at rest. With sharp corners of its rim, a piece becomes a
    /// surface of four sides, whose corners are the sharpest; without, a disc about a pole; with two rims, a ring.
    ///
    /// # Errors
    /// A cut into bodies with caps; a piece with more than two rims, with a hole through it or that touches itself; one on which
    /// no net lies without folds; a spacing that is not finite and above 0, or that takes too many points; a surface at rest
    /// with other knots.
    ///
    /// # Examples
    /// ```
    /// use palpate_geometry::cut::{CutPlane, SheetSpec, cut_sheet_by_plane};
    /// use palpate_geometry::math::{Point3, Vector3};
    /// use palpate_geometry::surface::builtin;
    /// let ball = builtin("sphere", None, Some(0.02))?;
    /// let plane = CutPlane::through(&Point3::origin(), &Vector3::z()).expect("a direction");
    /// let cut = cut_sheet_by_plane(&ball, &plane)?;
    /// let bowl = cut.sheet(0, &ball, &SheetSpec { spacing_m: 0.004 })?;
    /// assert!(!bowl.surface.topology().is_closed());
    /// assert!((bowl.surface.area() / cut.pieces[0].skin_area_m2 - 1.0).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn sheet(
        &self,
        piece: usize,
        rest: &Surface,
        spec: &SheetSpec,
    ) -> Result<PieceSkin, PieceSkinError> {
        self.check_rest(piece, rest)?;
        let SheetSpec { spacing_m } = *spec;
        if self.closed {
            return Err(PieceSkinError::Solid);
        }
        if !(spacing_m > 0.0 && spacing_m.is_finite()) {
            return Err(PieceSkinError::Spacing { spacing_m });
        }
        let mut still = |p: &Point3| *p;
        let mut sheets = Sheets::new(self, rest, &mut still);
        let root_m = libm::sqrt(self.pieces[piece].skin_area_m2);
        let edge = (spacing_m / root_m).clamp(EDGES[0], EDGES[1]);
        let fine = Fine::new(&mut sheets, piece, edge)?;
        finite(&fine.corners)?;
        let net = Net::open(&fine)?;
        let rims = rims(&fine, &net)?;
        let count = rims.len();
        check_shape(&fine, &net, count)?;
        let mut best: Result<(f64, PieceSkin), _> = Err(PieceSkinError::Pinched);
        for way in ways(&fine, &rims) {
            let is_tip = |corner: u32| match fine.corners[corner as usize].origin {
                Origin::Skin { u, v } => sheets.is_tip([u, v]),
                Origin::Cap => false,
            };
            let plan = Plan::new(&fine, &net, &rims, (way, &is_tip));
            let made = plan.and_then(|plan| plan.made(&fine, &mut sheets, spacing_m));
            let cost = |made: &PieceSkin| {
                let area = made.surface.area() / fine.area_m2() - 1.0;
                area.abs() + made.off_m / root_m
            };
            best = match (made.map(|made| (cost(&made), made)), best) {
                (Ok(made), Ok(known)) if known.0 <= made.0 => Ok(known),
                (Ok(made), _) => Ok(made),
                (Err(_), Ok(known)) => Ok(known),
                (Err(error), Err(_)) => Err(error),
            };
            if best.as_ref().is_ok_and(|(cost, _)| *cost <= GOOD) {
                break;
            }
        }
        let (_, skin) = best?;
        let more = skin.surface.area() / fine.area_m2() - 1.0;
        if more.is_nan() || more.abs() > MOST_MORE {
            return Err(PieceSkinError::Folded { more });
        }
        Ok(PieceSkin {
            rims: count,
            ..skin
        })
    }
}

/// One net covers it.
fn check_shape(fine: &Fine, net: &Net, rims: usize) -> Result<(), PieceSkinError> {
    let (parts, euler) = net.shape(fine);
    let missing = 2 - rims as i64 - euler;
    match (parts, missing) {
        (1, 0) if rims == 1 || rims == 2 => Ok(()),
        (1, 0) => Err(PieceSkinError::Rims { rims }),
        (1, missing) if missing > 0 && missing % 2 == 0 => Err(PieceSkinError::Handles {
            handles: (missing / 2) as usize,
        }),
        _ => Err(PieceSkinError::Pinched),
    }
}

impl Line {
    /// All of a rim.
    fn round(rim: &Rim, turns: RimTurns) -> Self {
        let mut corners = rim.corners.clone();
        corners.push(rim.corners[0]);
        Self {
            corners,
            at: turns.turns,
        }
    }
}

/// What a sheet is laid out as.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Square,
    Disc,
    Ring,
}

/// Those that are possible, the one that suits it first.
fn ways(fine: &Fine, rims: &[Rim]) -> &'static [Way] {
    let [rim] = rims else { return &[Way::Ring] };
    let narrow = rim.length_m * rim.length_m < NARROW * fine.area_m2();
    match has_corners(&sharp_corners(fine, rim)) {
        _ if narrow => &[Way::Disc],
        true => &[Way::Square, Way::Disc],
        false => &[Way::Disc, Way::Square],
    }
}

impl Plan {
    fn new(
        fine: &Fine,
        net: &Net,
        rims: &[Rim],
        (way, is_tip): (&Way, &dyn Fn(u32) -> bool),
    ) -> Result<Self, PieceSkinError> {
        match (way, rims) {
            (Way::Square, [rim, ..]) => Self::square(fine, net, rim),
            (Way::Disc, [rim, ..]) => Self::disc(fine, net, rim.clone(), is_tip),
            (Way::Ring, [near, far, ..]) => Self::ring(fine, net, [near.clone(), far.clone()]),
            _ => Err(PieceSkinError::Pinched),
        }
    }

    fn of(chart: Chart, shape: Shape, lengths_m: [f64; 2]) -> Self {
        Self {
            chart,
            shape,
            lengths_m,
            breaks: [Vec::new(), Vec::new()],
        }
    }

    fn square(fine: &Fine, net: &Net, rim: &Rim) -> Result<Self, PieceSkinError> {
        let turns = sharp_corners(fine, rim);
        let places = four_corners(fine, rim, &turns).ok_or(PieceSkinError::Pinched)?;
        let sides = four_sides(fine, rim, places);
        let [along, across] = lengths_m(fine, &sides);
        let area_m2 = fine.area_m2();
        let chart = patch::chart(fine, net, rim, &sides)?;
        let long = |own: f64, other: f64| (area_m2 / other).clamp(own, MOST_BULGE * own);
        let lengths = [long(along, across), long(across, along)];
        Ok(Self::of(chart, Shape::Square(sides), lengths).with_breaks(&turns))
    }

    fn disc(
        fine: &Fine,
        net: &Net,
        mut rim: Rim,
        is_tip: &dyn Fn(u32) -> bool,
    ) -> Result<Self, PieceSkinError> {
        let turns = sharp_corners(fine, &rim);
        begin_at(&mut rim, &turns);
        let of = vec![0; fine.triangles.len()];
        let maker = round(fine, net, &of, Kind::Last);
        let harmonic = Harmonic::new(fine, net, &maker.triangles, &[&rim.corners]);
        let harmonic = harmonic.ok_or(PieceSkinError::Pinched)?;
        let longitudes = RimTurns::new(fine, &rim, 0.0);
        let chart = maker.disc(&harmonic, &rim, &longitudes, is_tip)?;
        let wide_m = BULGE * fine.area_m2() / chart.length_m;
        let lengths = [rim.length_m.max(wide_m), chart.length_m];
        let shape = Shape::Disc(Line::round(&rim, longitudes));
        Ok(Self::of(chart, shape, lengths).with_breaks(&turns))
    }

    fn ring(fine: &Fine, net: &Net, rims: [Rim; 2]) -> Result<Self, PieceSkinError> {
        let turns = rims.each_ref().map(|rim| sharp_corners(fine, rim));
        let ([mut near, mut far], [first, second]) = (rims, turns);
        let mut all = [first.clone(), second.clone()].concat();
        // What goes round begins at an edge, if it has any.
        if first.is_empty() && !second.is_empty() {
            std::mem::swap(&mut near, &mut far);
            all = second;
        }
        begin_at(&mut near, &all);
        let of = vec![0; fine.triangles.len()];
        let maker = round(fine, net, &of, Kind::Ring);
        let corners: [&[u32]; 2] = [&near.corners, &far.corners];
        let harmonic = Harmonic::new(fine, net, &maker.triangles, &corners);
        let harmonic = harmonic.ok_or(PieceSkinError::Pinched)?;
        // The sheet is on the right of the far one.
        far.turn();
        let (far_edge, steps) = maker.way_across(&near, &far)?;
        far.end_with(far_edge);
        let longitudes = RimTurns::new(fine, &near, 0.0);
        let (chart, offset) = maker.ring(&harmonic, [&near, &far], &longitudes, &steps)?;
        let mean_m = fine.area_m2() / chart.length_m;
        let rims_m = 0.5 * (near.length_m + far.length_m);
        let lengths = [mean_m.max(rims_m), chart.length_m];
        let far_longitudes = RimTurns::new(fine, &far, offset);
        let shape = Shape::Ring([
            Line::round(&near, longitudes),
            Line::round(&far, far_longitudes),
        ]);
        Ok(Self::of(chart, shape, lengths).with_breaks(&all))
    }

    /// Where rims have these corners, but for those of a square.
    fn with_breaks(mut self, turns: &[Turn]) -> Self {
        let round = self.is_round();
        let mut breaks = [Vec::new(), Vec::new()];
        for side in 0..4 {
            let Some(line) = self.line(side) else {
                continue;
            };
            for turn in turns {
                let place = line
                    .corners
                    .iter()
                    .position(|&corner| corner == turn.corner);
                match place.map(|k| line.at[k]) {
                    Some(at) if round => breaks[0].push(at - at.floor()),
                    Some(at) if at > 0.0 && at < 1.0 => breaks[side % 2].push(at),
                    _ => {}
                }
            }
        }
        self.breaks = breaks;
        self
    }

    /// The surface, with control points about so far apart.
    fn made(
        &self,
        fine: &Fine,
        sheets: &mut Sheets<'_>,
        spacing_m: f64,
    ) -> Result<PieceSkin, PieceSkinError> {
        let layout = SheetLayout::new(self.counts(spacing_m)?, self.is_round(), &self.breaks)?;
        let samples = self.samples(fine, sheets, &layout);
        finite(&samples)?;
        let samples: Vec<Point3> = samples.into_iter().map(|sample| sample.rest).collect();
        let surface = layout.fitted(&samples, matches!(self.shape, Shape::Disc(_)))?;
        let off_m = (self.chart.corners.iter()).fold(0.0, |most, &(corner, at)| {
            farther(&surface, at, &fine.corners[corner as usize].rest, most)
        });
        Ok(PieceSkin {
            surface,
            off_m,
            creases: 0,
            rims: 0,
        })
    }

    fn is_round(&self) -> bool {
        !matches!(self.shape, Shape::Square(_))
    }

    /// Control points in u and in v.
    fn counts(&self, spacing_m: f64) -> Result<[usize; 2], PieceSkinError> {
        let round = self.is_round();
        let least = if round { LEAST_ROUND } else { LEAST_SQUARE };
        let counts = [0, 1].map(|d| {
            let ends = if round && d == 0 { 0 } else { 1 };
            let steps = libm::ceil(self.lengths_m[d] / spacing_m).min(1e9) as usize;
            (steps + ends).max(least[d])
        });
        match counts[0].saturating_mul(counts[1]) <= MOST_POINTS {
            true => Ok(counts),
            false => Err(PieceSkinError::Spacing { spacing_m }),
        }
    }

    /// (u × v) Places of the piece.
    fn samples(&self, fine: &Fine, sheets: &mut Sheets<'_>, layout: &SheetLayout) -> Vec<Corner> {
        let [us, vs] = &layout.samples;
        let [last_u, last_v] = [us.len() - 1, vs.len() - 1];
        let pole = match self.shape {
            Shape::Disc(_) => Some(self.chart.corner(fine, sheets, [0.0, 1.0])),
            _ => None,
        };
        let mut samples = Vec::with_capacity(us.len() * vs.len());
        for (i, &u) in us.iter().enumerate() {
            for (j, &v) in vs.iter().enumerate() {
                let ends = [
                    (j == 0, 0, u),
                    (j == last_v, 2, u),
                    (i == last_u, 1, v),
                    (i == 0, 3, v),
                ];
                let line = ends.into_iter().find_map(|(there, side, at)| {
                    let line = self.line(side).filter(|_| there)?;
                    Some(on(line, at, fine, sheets))
                });
                let sample = match (line, pole) {
                    (Some(sample), _) => sample,
                    (None, Some(pole)) if j == last_v => pole,
                    _ => self.chart.corner(fine, sheets, [u, v]),
                };
                samples.push(sample);
            }
        }
        samples
    }

    /// The rim at v = 0, u = 1, v = 1 or u = 0.
    fn line(&self, side: usize) -> Option<&Line> {
        match (&self.shape, side) {
            (Shape::Disc(line), 0) => Some(line),
            (Shape::Ring([near, _]), 0) => Some(near),
            (Shape::Ring([_, far]), 2) => Some(far),
            (Shape::Square(sides), side) => sides.get(side),
            _ => None,
        }
    }
}

/// Lays out all of a sheet around.
fn round<'a>(fine: &'a Fine, net: &'a Net, of: &'a [u32], kind: Kind) -> Maker<'a> {
    Maker {
        fine,
        net,
        of,
        section: 0,
        triangles: (0..fine.triangles.len() as u32).collect(),
        kind,
    }
}

/// A place of a rim.
fn on(line: &Line, at: f64, fine: &Fine, sheets: &mut Sheets<'_>) -> Corner {
    let first = line.at[0];
    // All of a rim begins anywhere; a side of a square at 0.
    let turns = if first == 0.0 && at == 1.0 {
        0.0
    } else {
        (at - first).floor()
    };
    let (ends, share) = line.find(at - turns);
    let [a, b] = ends.map(|k| fine.corners[k as usize]);
    match share {
        0.0 => a,
        1.0 => b,
        _ => {
            let lies = fine.outer(sheets, ends);
            sheets.between(&[(a, 1.0 - share), (b, share)], lies)
        }
    }
}
