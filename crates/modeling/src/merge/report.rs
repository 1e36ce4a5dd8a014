//! What a merge did to the patches: distances of their points from the merged surface, and
//! continuity as measured.

use super::layout::Layout;
use super::sheet::Sheet;
use super::{BlockRows, Merged, Seam};
use palpate_geometry::basis::Side;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ClosestSolver, Direction, Frame, Surface};

/// Places along a seam at which continuity is measured.
const PLACES: usize = 101;

/// Distances of the patches' points from the merged surface.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Deviation {
    /// Points measured: those of the patches that show, or where patches have hidden ranges those of the rows that are left.
    pub points: usize,
    /// Those not farther off than `close_m`.
    pub close: usize,
    /// What counts as close, m.
    pub close_m: f64,
    /// Mean distance, m.
    pub average_m: f64,
    /// Median, m.
    pub median_m: f64,
    /// Standard deviation of the distances about their mean, m.
    pub standard_m: f64,
    /// Largest, m.
    pub maximum_m: f64,
}

/// What differs between the two sides of a seam: the largest of 101 places along it.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Continuity {
    /// Distance of the points of both sides, m.
    pub gap_m: f64,
    /// Angle between the tangents across the seam, degrees.
    pub tangent_deg: f64,
    /// Difference of normal curvatures across the seam, 1/m.
    pub curvature_jump_per_m: f64,
    /// Largest normal curvature across the seam, 1/m: how sharp the blend is.
    pub curvature_per_m: f64,
    /// Jump of the first derivative across the seam, as a share of it: 0 where the surface is C¹.
    pub first_jump: f64,
    /// Largest jump of the second derivative across the seam: 0 where it is C².
    pub second_jump: f64,
}

/// What a merge did.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Distances of points.
    pub deviation: Deviation,
    /// Each seam of the merged surface.
    pub seams: Vec<(Seam, Continuity)>,
    /// The patches where they met before, over all their edges that meet.
    pub before: Continuity,
}

/// Points within this are close, m: 0.01 mm.
pub const CLOSE_M: f64 = 1e-5;

impl Merged {
    /// Measures deviation and continuity; `surfaces` are those that were merged. Where patches end on curves the deviation is
    /// that of all points that show, of the reading that was taken.
    pub fn report(&self, surfaces: &[Surface]) -> Report {
        let sheets = Sheet::laid(surfaces, &self.layout);
        let measured = self.readings.iter().find_map(|reading| {
            let taken = Some(reading.hide_by) == self.hide_by;
            reading.outcome.as_ref().ok().filter(|_| taken)
        });
        Report {
            deviation: measured.map_or_else(
                || deviation_of(&self.distances(&sheets)),
                |seen| seen.deviation,
            ),
            seams: self
                .seams
                .iter()
                .map(|seam| (*seam, across(&self.surface, *seam)))
                .collect(),
            before: before(&sheets, &self.layout),
        }
    }

    /// Distance of every point of the turned patches, place after place, row after row, m.
    ///
    /// The distance is that of the foot to which descent from the point's own parameters leads: the
    /// closest point of that neighbourhood, never farther than the surface at those parameters.
    pub(super) fn distances(&self, sheets: &[Sheet]) -> Vec<f64> {
        self.distances_on(sheets, &self.rows)
    }

    /// Distances half way between the rows of points, where the fit had no data.
    pub(super) fn distances_between(&self, sheets: &[Sheet]) -> Vec<f64> {
        let means = |x: &[f64]| {
            x.windows(2)
                .map(|w| 0.5 * (w[0] + w[1]))
                .collect::<Vec<f64>>()
        };
        let between = |rows: &BlockRows| BlockRows {
            fractions: means(&rows.fractions),
            parameters: means(&rows.parameters),
        };
        let rows = [0, 1].map(|d: usize| self.rows[d].iter().map(between).collect());
        self.distances_on(sheets, &rows)
    }

    fn distances_on(&self, sheets: &[Sheet], all_rows: &[Vec<BlockRows>; 2]) -> Vec<f64> {
        let solver = ClosestSolver::new(&self.surface);
        let mut all = Vec::new();
        for (k, sheet) in sheets.iter().enumerate() {
            let (i, j) = (k / self.layout.columns, k % self.layout.columns);
            let (rows, columns) = (&all_rows[0][i], &all_rows[1][j]);
            for (&f, &u) in rows.fractions.iter().zip(&rows.parameters) {
                for (&g, &v) in columns.fractions.iter().zip(&columns.parameters) {
                    all.push(self.distance(&solver, &sheet.point([f, g]), [u, v]));
                }
            }
        }
        all
    }

    /// Distance of a point, m, by descent from parameters of the merged surface.
    pub(super) fn distance(&self, solver: &ClosestSolver, point: &Point3, [u, v]: [f64; 2]) -> f64 {
        let there = (self.surface.point(u, v) - point).norm();
        let foot = solver
            .local(&self.surface, point, u, v)
            .map_or(there, |foot| foot.distance);
        foot.min(there)
    }
}

fn place(surface: &Surface, direction: Direction, fraction: f64) -> f64 {
    let knots = surface.knots(direction);
    knots.domain().0 + knots.length() * fraction
}

/// The statistics of distances; of none, zeros.
pub(super) fn deviation_of(distances: &[f64]) -> Deviation {
    let mut sorted = distances.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len().max(1) as f64;
    let average_m = sorted.iter().sum::<f64>() / n;
    let variance = sorted
        .iter()
        .map(|d| (d - average_m) * (d - average_m))
        .sum::<f64>()
        / n;
    let middle = |k: usize| sorted.get(k).copied().unwrap_or(0.0);
    Deviation {
        points: sorted.len(),
        close: sorted.partition_point(|&d| d <= CLOSE_M),
        close_m: CLOSE_M,
        average_m,
        median_m: 0.5 * (middle(sorted.len().saturating_sub(1) / 2) + middle(sorted.len() / 2)),
        standard_m: variance.sqrt(),
        maximum_m: sorted.last().copied().unwrap_or(0.0),
    }
}

/// Both sides of a seam of one surface.
pub(super) fn across(surface: &Surface, seam: Seam) -> Continuity {
    let other = if seam.direction == Direction::U {
        Direction::V
    } else {
        Direction::U
    };
    let sides = (0..PLACES).map(|k| {
        let along = place(surface, other, k as f64 / (PLACES - 1) as f64);
        [Side::Left, Side::Right].map(|side| match seam.direction {
            Direction::U => surface.frame_from(seam.at, along, side, Side::Right),
            Direction::V => surface.frame_from(along, seam.at, Side::Right, side),
        })
    });
    sides.fold(Continuity::default(), |worst, [a, b]| {
        worst.with(&a, &b, seam.direction, 1.0)
    })
}

/// Patches that meet, before they are merged.
fn before(sheets: &[Sheet], layout: &Layout) -> Continuity {
    let mut worst = Continuity::default();
    let at = |i: usize, j: usize| &sheets[i * layout.columns + j].surface;
    for (i, j) in (0..layout.rows).flat_map(|i| (0..layout.columns).map(move |j| (i, j))) {
        let below = (i + 1 < layout.rows).then(|| (at(i, j), at(i + 1, j), Direction::U));
        let right = (j + 1 < layout.columns).then(|| (at(i, j), at(i, j + 1), Direction::V));
        for (a, b, direction) in below.into_iter().chain(right) {
            for k in 0..PLACES {
                let along = k as f64 / (PLACES - 1) as f64;
                let frame = |s: &Surface, end: f64| match direction {
                    Direction::U => {
                        s.frame(place(s, Direction::U, end), place(s, Direction::V, along))
                    }
                    Direction::V => {
                        s.frame(place(s, Direction::U, along), place(s, Direction::V, end))
                    }
                };
                let (x, y) = (frame(a, 1.0), frame(b, 0.0));
                // Parameters of patches are their own: lengths of derivatives are compared after
                // scaling.
                let d = |f: &Frame| {
                    if direction == Direction::U {
                        f.du.norm()
                    } else {
                        f.dv.norm()
                    }
                };
                worst = worst.with(&x, &y, direction, d(&x) / d(&y).max(f64::MIN_POSITIVE));
            }
        }
    }
    worst
}

impl Continuity {
    /// The larger of each, this and two one-sided frames; `scale` is the left parameter's unit over
    /// the right one's.
    fn with(self, a: &Frame, b: &Frame, direction: Direction, scale: f64) -> Self {
        let parts = |f: &Frame, scale: f64| match direction {
            Direction::U => (f.du * scale, f.duu * (scale * scale)),
            Direction::V => (f.dv * scale, f.dvv * (scale * scale)),
        };
        let ((a1, a2), (b1, b2)) = (parts(a, 1.0), parts(b, scale));
        let (ka, kb) = (curvature(a, &a1, &a2), curvature(b, &b1, &b2));
        let angle = libm::atan2(a1.cross(&b1).norm(), a1.dot(&b1)).to_degrees();
        let share = |x: &Vector3, y: &Vector3| {
            let largest = x.norm().max(y.norm());
            if largest > 0.0 {
                (x - y).norm() / largest
            } else {
                0.0
            }
        };
        Self {
            gap_m: self.gap_m.max((b.point - a.point).norm()),
            tangent_deg: self.tangent_deg.max(angle),
            curvature_jump_per_m: self.curvature_jump_per_m.max((kb - ka).abs()),
            curvature_per_m: self.curvature_per_m.max(ka.abs()).max(kb.abs()),
            first_jump: self.first_jump.max(share(&a1, &b1)),
            second_jump: self.second_jump.max(share(&a2, &b2)),
        }
    }
}

/// Normal curvature along a derivative; 0 where the surface has no normal.
fn curvature(frame: &Frame, first: &Vector3, second: &Vector3) -> f64 {
    let normal = frame.du.cross(&frame.dv);
    let (length, speed) = (normal.norm(), first.norm_squared());
    if length > 0.0 && speed > 0.0 {
        normal.dot(second) / (length * speed)
    } else {
        0.0
    }
}
