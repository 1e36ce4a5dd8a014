//! What is done with a surface that comes from a file: numbers that agree but for rounding are made
//! to agree.
//!
//! ```text
//! file ──▶ knots that nearly agree: one knot, or refused ──▶ seams and poles: equal bit for bit ──▶ surface
//! ```
//! Between two knots that differ in their last digits lies a piece that is too narrow for
//! parameters. Where that many of them lie together that the piece is a bridge between two rows of
//! control points, it is a part of the shape, so they are not simply made equal.

use super::bezier::extraction;
use super::tensor::wrap;
use super::{Closing, SAME_POINT, Surface, SurfaceError};
use crate::basis::{KnotKind, KnotVector, Side};
use crate::math::{Point3, Vector3};
use std::fmt;

/// Knots nearer to each other than this share of the domain are made one.
const NEAR_KNOTS: f64 = 1e-11;

/// Gaps of seams and poles up to this share of the size are hardly meant.
const SLIT: f64 = 1e-3;

/// A slit is narrow beside the surface: what lies between its lips reaches this many times as far.
const BESIDE: f64 = 20.0;

/// A surface as it was loaded.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The surface, m.
    pub surface: Surface,
    /// Knots of the file that were made one.
    pub merged: Vec<MergedKnots>,
}

/// Knots that differed in their last digits, and were made one.
#[derive(Clone, Debug, PartialEq)]
pub struct MergedKnots {
    /// `u` or `v`.
    pub direction: char,
    /// Their places in the list of the file.
    pub places: [usize; 2],
    /// What they are now.
    pub value: f64,
    /// A bound of how far a point of the surface moved, m.
    pub moved_m: f64,
}

impl fmt::Display for MergedKnots {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            direction,
            places: [first, last],
            value,
            moved_m,
        } = self;
        write!(
            f,
            "knots {first} to {last} in {direction} differ in their last digits and were made {value}, which moves no point by \
             more than {moved_m:.0e} m"
        )
    }
}

/// A narrow opening where a surface is hardly meant to be open.
#[derive(Clone, Debug, PartialEq)]
pub struct Slit {
    /// `u` or `v`: the parameter across it.
    pub direction: char,
    /// Where it is.
    pub place: SlitPlace,
    /// Its greatest width, m.
    pub gap_m: f64,
}

/// Where a [`Slit`] is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SlitPlace {
    /// Between both ends of the direction.
    Seam,
    /// At a knot that parts the surface.
    Joint(f64),
    /// Within the edge at this parameter, which is nearly one point.
    Pole(f64),
}

impl fmt::Display for Slit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (d, gap_m) = (self.direction, self.gap_m);
        match self.place {
            SlitPlace::Seam => write!(f, "the seam in {d} is open by {gap_m:.1e} m"),
            SlitPlace::Joint(knot) => {
                write!(f, "the joint at {d} = {knot} is open by {gap_m:.1e} m")
            }
            SlitPlace::Pole(end) => write!(f, "the pole at {d} = {end} is open by {gap_m:.1e} m"),
        }
    }
}

impl Surface {
    /// Makes of a surface that was read one to work with: knots nearer to each other than 1e-11 of
    /// the domain become one where that moves nothing by 1e-9 of the size, and what is closed but
    /// for rounding (1e-9 of the size) is closed bit for bit.
    ///
    /// # Errors
    /// [`SurfaceError::NearKnots`] where making them one would change the surface.
    pub fn loaded(self) -> Result<Loaded, SurfaceError> {
        let mut merged = Vec::new();
        let u = self.with_merged_knots(0, &mut merged)?;
        let v = u.with_merged_knots(1, &mut merged)?;
        Ok(Loaded {
            surface: v.with_exact_seams(),
            merged,
        })
    }

    fn with_merged_knots(
        self,
        direction: usize,
        merged: &mut Vec<MergedKnots>,
    ) -> Result<Self, SurfaceError> {
        let name = ['u', 'v'][direction];
        let mut surface = self;
        let old = [surface.knots_u(), surface.knots_v()][direction].clone();
        for run in near_runs(&old) {
            let knots = [surface.knots_u(), surface.knots_v()][direction];
            let joined = joined(knots, &run);
            let moved_m = joined
                .as_ref()
                .map(|to| surface.moved_by(direction, knots, to));
            let (Some(joined), Some(moved_m)) = (joined, moved_m) else {
                return Err(refused(name, &run, None));
            };
            if moved_m > SAME_POINT * surface.size() {
                return Err(refused(name, &run, Some(moved_m)));
            }
            merged.push(MergedKnots {
                direction: name,
                places: run.places,
                value: run.value,
                moved_m,
            });
            surface = surface.with_knots(direction, joined);
        }
        Ok(surface)
    }

    /// A bound of how far points move when the knots of a direction are exchanged for others as
    /// many, m.
    fn moved_by(&self, direction: usize, from: &KnotVector, to: &KnotVector) -> f64 {
        let (p, t) = (from.degree(), from.knots());
        let across = [self.net().columns(), self.net().rows()][direction];
        let origin = self.net().points()[0];
        let size_m = self.size();
        let mut most: f64 = 0.0;
        for i in from.spans() {
            let ends = [t[i], t[i + 1]];
            let k = to.span(ends[0] + 0.5 * (ends[1] - ends[0]), Side::Right);
            let rows = [(from, i), (to, k)]
                .map(|(knots, span)| (span - p, extraction(knots.knots(), p, span, ends)));
            for row in 0..=p {
                for j in 0..across {
                    let [a, b] = [0, 1].map(|side| {
                        let (first, matrix) = &rows[side];
                        self.blended(
                            direction,
                            *first,
                            &matrix[row * (p + 1)..][..=p],
                            j,
                            &origin,
                        )
                    });
                    // A quotient of sums is at most the greatest quotient of their terms.
                    let apart = (a.0 - b.0).norm() + size_m * (a.1 - b.1).abs();
                    most = most.max(apart / a.1);
                }
            }
        }
        most
    }

    /// Sum of a window of weighted control points, from an origin, and of their weights.
    fn blended(
        &self,
        direction: usize,
        first: usize,
        shares: &[f64],
        across: usize,
        origin: &Point3,
    ) -> (Vector3, f64) {
        let (rows, columns) = (self.net().rows(), self.net().columns());
        let mut sum = (Vector3::zeros(), 0.0);
        for (a, share) in shares.iter().enumerate() {
            let k = match direction {
                0 => wrap(first + a, rows) * columns + across,
                _ => across * columns + wrap(first + a, columns),
            };
            let share = share * self.weights().map_or(1.0, |w| w[k]);
            sum.0 += (self.net().points()[k] - origin) * share;
            sum.1 += share;
        }
        sum
    }

    fn with_knots(self, direction: usize, knots: KnotVector) -> Self {
        let (u, v) = match direction {
            0 => (knots, self.knots_v().clone()),
            _ => (self.knots_u().clone(), knots),
        };
        let flip = self.flip_normal();
        let weights = self.weights().map(<[f64]>::to_vec);
        Self::from_checked(u, v, self.net().clone(), weights).with_flip_normal(flip)
    }

    /// Where the surface is open by more than rounding, and by less than anybody would mean: seams,
    /// joints and poles whose gaps are wider than 1e-9 of the size and at most 1e-3 of it.
    pub fn slits(&self) -> Vec<Slit> {
        let topology = self.topology();
        let (least_m, most_m) = (SAME_POINT * self.size(), SLIT * self.size());
        let hardly_meant = |gap_m: f64| gap_m > least_m && gap_m <= most_m;
        let mut slits = Vec::new();
        for (d, knots) in [self.knots_u(), self.knots_v()].into_iter().enumerate() {
            let direction = ['u', 'v'][d];
            let (start, end) = knots.domain();
            let mut add = |place, gap_m| {
                slits.push(Slit {
                    direction,
                    place,
                    gap_m,
                });
            };
            let gap_m = self.gap_between(d, [(start, Side::Right), (end, Side::Left)]);
            if topology.closing[d] == Closing::Open
                && hardly_meant(gap_m)
                && self.extent(d) > BESIDE * gap_m
            {
                add(SlitPlace::Seam, gap_m);
            }
            for knot in knots.disjoined() {
                let gap_m = self.gap_between(d, [(knot, Side::Left), (knot, Side::Right)]);
                if hardly_meant(gap_m) && self.extent(d) > BESIDE * gap_m {
                    add(SlitPlace::Joint(knot), gap_m);
                }
            }
            for (k, (at, side)) in [(start, Side::Right), (end, Side::Left)]
                .into_iter()
                .enumerate()
            {
                let width_m = self.width_at(d, at, side);
                let open = !knots.is_periodic() && !topology.poles[d][k];
                if open && hardly_meant(width_m) && self.extent(1 - d) > BESIDE * width_m {
                    add(SlitPlace::Pole(at), width_m);
                }
            }
        }
        slits
    }

    /// Greatest distance of the control points of two curves of constant parameter, m.
    fn gap_between(&self, direction: usize, at: [(f64, Side); 2]) -> f64 {
        let [a, b] = at.map(|(x, side)| self.iso_row(direction, x, side));
        let apart = a.iter().zip(&b).map(|(a, b)| (a.0 - b.0).norm());
        apart.fold(0.0, f64::max)
    }

    /// How far the control points of a curve of constant parameter are from its first, m.
    fn width_at(&self, direction: usize, x: f64, side: Side) -> f64 {
        let row = self.iso_row(direction, x, side);
        let far = row.iter().map(|(point, _)| (point - row[0].0).norm());
        far.fold(0.0, f64::max)
    }

    /// How far the net goes along a direction from where it starts, m.
    fn extent(&self, direction: usize) -> f64 {
        let columns = self.net().columns();
        let points = self.net().points();
        let far = points.iter().enumerate().map(|(k, point)| {
            let first = [k % columns, k - k % columns][direction];
            (point - points[first]).norm()
        });
        far.fold(0.0, f64::max)
    }
}

/// Knots that nearly agree.
struct Run {
    /// Among those of the file.
    places: [usize; 2],
    /// What to make them.
    value: f64,
}

/// Runs of knots that nearly agree, but not to the last bit.
fn near_runs(knots: &KnotVector) -> Vec<Run> {
    let t = knots.file_knots();
    let near = NEAR_KNOTS * knots.length();
    let ends = match knots.kind() {
        KnotKind::Periodic => [0, t.len() - 1],
        KnotKind::Clamped | KnotKind::Open => [knots.degree(), knots.count()],
    };
    let mut runs = Vec::new();
    let mut first = 0;
    for k in 1..=t.len() {
        if k < t.len() && t[k] - t[k - 1] < near {
            continue;
        }
        let places = [first, k - 1];
        if t[first] < t[k - 1] {
            // An end of the domain stays where it is.
            let kept = ends.into_iter().find(|end| (first..k).contains(end));
            runs.push(Run {
                places,
                value: t[kept.unwrap_or(first)],
            });
        }
        first = k;
    }
    runs
}

/// The knots with a run made one; `None` where they are too many for that.
fn joined(knots: &KnotVector, run: &Run) -> Option<KnotVector> {
    let mut t = knots.file_knots().to_vec();
    t[run.places[0]..=run.places[1]].fill(run.value);
    if knots.is_periodic() {
        KnotVector::periodic(knots.degree(), t).ok()
    } else {
        KnotVector::new(knots.degree(), t).ok()
    }
}

fn refused(direction: char, run: &Run, moved_m: Option<f64>) -> SurfaceError {
    SurfaceError::NearKnots {
        direction,
        first: run.places[0],
        last: run.places[1],
        value: run.value,
        moved_m,
    }
}

#[cfg(test)]
mod tests;
