//! A piece of the wall as a B-spline: a disc with a pole inside, or a ring.
//!
//! ```text
//! sheet laid flat ──▶ a grid of places, moved onto φ_A = φ_B, even along each meridian ──▶ fit ──▶ its own places, moved on
//! ```
//! Its outermost control points are those of the rims' curves, so the edges of the wall are these curves exactly. What it
//! misses inside is measured between the places of the fit; columns are doubled until that is within the tolerance.

use super::TruncateError;
use super::fields::Fields;
use super::flat::Flat;
use super::rim::{Rim, RimCurve};
use super::sheet::{Sheet, Unclear};
use nalgebra::{DMatrix, DVector};
use palpate_geometry::basis::{Blending, BlendingInverse, KnotVector};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ControlNet, Curve, Surface};

/// Cells of a sheet along its rim, at first; halved so many times.
const CELLS: f64 = 64.0;
const HALVINGS: usize = 3;
/// How near a rim's curve is to the surfaces, of what the wall may miss.
const RIM_SHARE: f64 = 1e-3;
/// And no nearer than this, of the size.
const RIM_LEAST: f64 = 1e-9;
/// Control points from the pole or the second rim to the rim: at first, and at most.
const COLUMNS: [usize; 2] = [8, 64];
/// Control points round, at most.
const MOST_ROWS: usize = 256;
/// Twice the columns helped where they brought what is missed below this share.
const HELPED: f64 = 0.5;
/// Places of the fit in a span.
const SAMPLES: usize = 2;
/// Places round, at most, at which what is missed is measured.
const MEASURED: usize = 96;

/// A B-spline between the rims of a connected piece of the wall.
#[derive(Clone, Debug)]
pub(super) struct Wall {
    /// u goes round; v ends at the first rim.
    pub surface: Surface,
    /// Rim, its curve, and whether that goes along n_A × n_B. The second one, of a ring, does not.
    pub rims: Vec<(usize, RimCurve, bool)>,
    /// Largest |φ_A − φ_B|, m.
    pub uneven_m: f64,
    /// Largest distance from the places where they are equal, m.
    pub off_m: f64,
}

/// The pieces of the wall; each rim ends one of them.
pub(super) fn walls(
    fields: &mut Fields<'_>,
    rims: &[Rim],
    tolerance_m: f64,
) -> Result<Vec<Wall>, TruncateError> {
    let mut done = vec![false; rims.len()];
    let mut all = Vec::new();
    for rim in 0..rims.len() {
        if done[rim] {
            continue;
        }
        let sheet = sheet(fields, rims, rim)?;
        for (k, _) in &sheet.loops {
            if std::mem::replace(&mut done[*k], true) {
                return Err(unclear(rims, rim));
            }
        }
        if sheet.loops.len() > 2 {
            return Err(TruncateError::Branches {
                rims: sheet.loops.len(),
                at: rims[rim].point(0.0).into(),
            });
        }
        let flat = Flat::new(&sheet, rims).ok_or_else(|| unclear(rims, rim))?;
        let names: Vec<usize> = sheet.loops.iter().map(|(k, _)| *k).collect();
        all.push(
            fitted(fields, rims, &names, &flat, tolerance_m).ok_or_else(|| unclear(rims, rim))?,
        );
    }
    Ok(all)
}

fn unclear(rims: &[Rim], rim: usize) -> TruncateError {
    TruncateError::Unclear {
        at: rims[rim].point(0.0).into(),
    }
}

fn sheet(fields: &mut Fields<'_>, rims: &[Rim], rim: usize) -> Result<Sheet, TruncateError> {
    let mut step_m = rims[rim].length_m() / CELLS;
    for _ in 0..=HALVINGS {
        match Sheet::at_rim(fields, rims, rim, step_m) {
            Ok(sheet) => return Ok(sheet),
            Err(Unclear::Large) => break,
            Err(Unclear::Coarse) => step_m *= 0.5,
        }
    }
    Err(unclear(rims, rim))
}

/// Curves of the rims with one number of control points.
fn rim_curves(
    fields: &mut Fields<'_>,
    rims: &[Rim],
    names: &[usize],
    turn: Option<f64>,
    mut least: usize,
    tolerance_m: f64,
) -> Vec<RimCurve> {
    let tolerance_m = (RIM_SHARE * tolerance_m).max(RIM_LEAST * fields.size_m);
    loop {
        let fit = |(k, &name): (usize, &usize)| match (k, turn) {
            (1, Some(turn)) => rims[name].fitted(fields, |u| turn - u, least, tolerance_m),
            _ => rims[name].fitted(fields, |u| u, least, tolerance_m),
        };
        let all: Vec<RimCurve> = names.iter().enumerate().map(fit).collect();
        let counts = all.iter().map(|rim| rim.curve.points().len());
        let most = counts.clone().max().unwrap_or(0);
        if counts.into_iter().all(|count| count == most) {
            return all;
        }
        least = most;
    }
}

fn fitted(
    fields: &mut Fields<'_>,
    rims: &[Rim],
    names: &[usize],
    flat: &Flat,
    tolerance_m: f64,
) -> Option<Wall> {
    let mut curves = rim_curves(fields, rims, names, flat.turn, 0, tolerance_m);
    let (outer, inner) = (&curves[0].curve, curves.get(1).map(|rim| &rim.curve));
    let mut columns = COLUMNS[0];
    let grid = Grid::new(outer.knots(), columns);
    let mut places = grid.places(|u, v| flat.point(u, v));
    grid.hold(&mut places, outer, inner);
    grid.settle(fields, &mut places)?;
    grid.even(&mut places);
    grid.settle(fields, &mut places)?;
    let mut surface = grid.fit(&places, outer, inner)?;
    let mut before_m = f64::INFINITY;
    loop {
        let (outer, inner) = (&curves[0].curve, curves.get(1).map(|rim| &rim.curve));
        let grid = Grid::new(outer.knots(), columns);
        let mut places = grid.places(|u, v| surface.point(u, v));
        grid.hold(&mut places, outer, inner);
        grid.settle(fields, &mut places)?;
        surface = grid.fit(&places, outer, inner)?;
        let [uneven_m, off_m] = grid.missed(fields, &surface)?;
        let rows = outer.points().len();
        let more = [2 * rows <= MOST_ROWS, 2 * columns <= COLUMNS[1]];
        if off_m <= tolerance_m || more == [false; 2] {
            let rims = names.iter().zip(curves).enumerate();
            return Some(Wall {
                surface,
                rims: rims
                    .map(|(k, (&name, curve))| (name, curve, k == 0))
                    .collect(),
                uneven_m,
                off_m,
            });
        }
        // Where more columns did not help, more rows may.
        if more[0] && (!more[1] || off_m > HELPED * before_m) {
            curves = rim_curves(fields, rims, names, flat.turn, 2 * rows, tolerance_m);
        }
        if more[1] {
            columns *= 2;
        }
        before_m = off_m;
    }
}

/// The places of a fit: all pairs of parameters.
struct Grid {
    knots: [KnotVector; 2],
    us: Vec<f64>,
    vs: Vec<f64>,
}

impl Grid {
    fn new(round: &KnotVector, columns: usize) -> Self {
        let across = KnotVector::clamped_uniform(3, columns).expect("more than the degree");
        let (rows, spans) = (SAMPLES * round.count(), SAMPLES * (columns - 3));
        Self {
            us: (0..rows).map(|k| k as f64 / rows as f64).collect(),
            vs: (0..=spans).map(|k| k as f64 / spans as f64).collect(),
            knots: [round.clone(), across],
        }
    }

    /// (us × vs).
    fn places(&self, at: impl Fn(f64, f64) -> Point3) -> Vec<Point3> {
        let pairs = self
            .us
            .iter()
            .flat_map(|&u| self.vs.iter().map(move |&v| (u, v)));
        pairs.map(|(u, v)| at(u, v)).collect()
    }

    /// Puts the ends of all meridians where they belong: on the rims; at the pole they stay.
    fn hold(&self, places: &mut [Point3], outer: &Curve, inner: Option<&Curve>) {
        for (meridian, &u) in places.chunks_mut(self.vs.len()).zip(&self.us) {
            meridian[self.vs.len() - 1] = outer.point(u);
            if let Some(inner) = inner {
                meridian[0] = inner.point(u);
            }
        }
    }

    /// Moves places, but for those at the outer end, onto the wall.
    fn settle(&self, fields: &mut Fields<'_>, places: &mut [Point3]) -> Option<()> {
        let count = self.vs.len();
        for meridian in places.chunks_mut(count) {
            for place in &mut meridian[..count - 1] {
                *place = fields.onto_wall(place)?;
            }
        }
        Some(())
    }

    /// Moves places along their meridians so that they are as far from each other as their parameters say.
    fn even(&self, places: &mut [Point3]) {
        let count = self.vs.len();
        for meridian in places.chunks_mut(count) {
            let old = meridian.to_vec();
            let mut lengths = vec![0.0];
            for k in 1..count {
                lengths.push(lengths[k - 1] + (old[k] - old[k - 1]).norm());
            }
            for (place, v) in meridian.iter_mut().zip(&self.vs) {
                let along = v * lengths[count - 1];
                let k = lengths.partition_point(|&l| l < along).clamp(1, count - 1);
                let step = (lengths[k] - lengths[k - 1]).max(f64::MIN_POSITIVE);
                *place = old[k - 1] + (old[k] - old[k - 1]) * ((along - lengths[k - 1]) / step);
            }
        }
    }

    /// The B-spline near the places, with the control points of the rims' curves at its ends; a pole is the first place.
    fn fit(&self, places: &[Point3], outer: &Curve, inner: Option<&Curve>) -> Option<Surface> {
        let (rows, columns) = (self.knots[0].count(), self.knots[1].count());
        let (across, origin) = (self.vs.len(), places[0]);
        let inverse = BlendingInverse::new(Blending::new(&self.knots[0], &self.us));
        let mut scratch = vec![Vector3::zeros(); self.us.len() + rows];
        // (vs × rows): control points in u of each line of one v.
        let mut lines = vec![vec![Vector3::zeros(); rows]; across];
        for (j, line) in lines.iter_mut().enumerate() {
            let samples: Vec<Vector3> = (0..self.us.len())
                .map(|i| places[i * across + j] - origin)
                .collect();
            inverse.fit(&samples, line, &mut scratch);
        }
        let blending = Blending::new(&self.knots[1], &self.vs);
        let matrix = DMatrix::from_fn(across, columns, |row, column| {
            let mut entries = blending.entries(row, 0);
            entries.find(|e| e.0 == column).map_or(0.0, |e| e.1)
        });
        let free = matrix.columns(1, columns - 2).clone_owned();
        let factor = (free.transpose() * &free).cholesky()?;
        let mut net = Vec::with_capacity(rows * columns);
        for i in 0..rows {
            let ends = [
                inner.map_or(Vector3::zeros(), |inner| inner.points()[i] - origin),
                outer.points()[i] - origin,
            ];
            let of_line: [DVector<f64>; 3] = std::array::from_fn(|c| {
                let rest = DVector::from_fn(across, |j, _| {
                    let held = matrix[(j, 0)] * ends[0][c] + matrix[(j, columns - 1)] * ends[1][c];
                    lines[j][i][c] - held
                });
                factor.solve(&(free.transpose() * rest))
            });
            net.push(origin + ends[0]);
            let inside = (0..columns - 2).map(|k| Vector3::from([0, 1, 2].map(|c| of_line[c][k])));
            net.extend(inside.map(|x| origin + x));
            net.push(origin + ends[1]);
        }
        let net = ControlNet::new(rows, columns, net).ok()?;
        let [round, across] = self.knots.clone();
        Surface::new(round, across, net, None).ok()
    }

    /// Largest |φ_A − φ_B| and largest distance from where they are equal, m, between the places of the fit.
    fn missed(&self, fields: &mut Fields<'_>, surface: &Surface) -> Option<[f64; 2]> {
        let every = self.us.len().div_ceil(MEASURED);
        let half = [0.5 / self.us.len() as f64, 0.5 / (self.vs.len() - 1) as f64];
        let mut most = [0.0f64; 2];
        for u in self.us.iter().step_by(every) {
            for v in &self.vs[..self.vs.len() - 1] {
                let q = surface.point(u + half[0], v + half[1]);
                let settled = fields.onto_wall(&q)?;
                most[0] = most[0].max(fields.at(&q).lead().abs());
                most[1] = most[1].max((settled - q).norm());
            }
        }
        Some(most)
    }
}
