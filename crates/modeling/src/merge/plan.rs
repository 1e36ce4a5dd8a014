//! A merge as a pair of matrices for each patch.
//!
//! Sampling a patch is linear in its net (M = A_u P A_vᵀ), and so is fitting samples in each
//! direction (P = F_u M F_vᵀ). Put together, the merged net is a sum over the patches,
//! ```text
//! P = Σ G_u P_patch G_vᵀ,   G_u = F_u A_u,   G_v = F_v A_v
//! ```
//! with small matrices that depend on knots and parameters only: the blendings at hand. A plan
//! keeps them, so patches that move are merged again without sampling or fitting. Where lines end on curves (`Sheet`)
//! no product of matrices samples them: a plan then keeps knots and curves, and samples and fits anew.

use super::axis::normalised;
use super::fit::{Ends, LineFit};
use super::ground::check_nets;
use super::layout::Layout;
use super::rim::Graph;
use super::sheet::Sheet;
use super::{Edge, MergeError, Seam};
use palpate_geometry::basis::{Blending, KnotVector};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{ControlNet, Direction, Surface};

/// Where the rows of one block lie: as fractions of its patches, and on the merged parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockRows {
    /// Fractions of the patch's domain, rising; where lines end on a curve, of the mean of the lines.
    pub fractions: Vec<f64>,
    /// Merged parameters, as many.
    pub parameters: Vec<f64>,
}

/// One direction of the merged surface.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    pub knots: KnotVector,
    /// Parameters at which patches meet.
    pub seams: Vec<f64>,
    /// Rows of each block (blocks).
    pub rows: Vec<BlockRows>,
}

impl Line {
    /// Of all rows.
    fn parameters(&self) -> Vec<f64> {
        let blocks = self.rows.iter();
        blocks
            .flat_map(|rows| rows.parameters.iter().copied())
            .collect()
    }
}

/// Everything about a merge but the nets.
#[derive(Clone, Debug)]
pub struct MergePlan {
    pub(super) layout: Layout,
    pub(super) lines: [Line; 2],
    /// (places) of the matrices G for u and v, (merged count × patch count), row after row; none where lines end on curves.
    maps: Vec<[Map; 2]>,
    /// (places) the curves on which lines end.
    curves: Vec<Option<(Edge, Graph)>>,
    ends: Ends,
    /// (places) control points of the turned patches.
    counts: Vec<[usize; 2]>,
}

/// A dense matrix.
#[derive(Clone, Debug)]
struct Map {
    columns: usize,
    values: Vec<f64>,
}

impl MergePlan {
    /// `sheets` are the patches as the layout places them.
    pub(super) fn new(sheets: &[Sheet], layout: Layout, lines: [Line; 2], ends: Ends) -> Self {
        let maps = if sheets.iter().any(|sheet| sheet.end.is_some()) {
            Vec::new()
        } else {
            let maps_u = maps(sheets, &layout, Direction::U, &lines[0], ends);
            let maps_v = maps(sheets, &layout, Direction::V, &lines[1], ends);
            (maps_u.into_iter().zip(maps_v))
                .map(|(u, v)| [u, v])
                .collect()
        };
        Self {
            layout,
            lines,
            maps,
            curves: sheets.iter().map(|sheet| sheet.end.clone()).collect(),
            ends,
            counts: sheets.iter().map(Sheet::counts).collect(),
        }
    }

    /// Which patch lies where.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Rows of points of the blocks in a direction.
    pub fn rows(&self, direction: Direction) -> &[BlockRows] {
        &self.line(direction).rows
    }

    /// Where the merged surface was joined.
    pub fn seams(&self) -> Vec<Seam> {
        let of = |direction| {
            self.line(direction)
                .seams
                .iter()
                .map(move |&at| Seam { direction, at })
        };
        of(Direction::U).chain(of(Direction::V)).collect()
    }

    fn line(&self, direction: Direction) -> &Line {
        &self.lines[if direction == Direction::U { 0 } else { 1 }]
    }

    /// The merged surface of patches as they stand now: those that the plan was made for, with nets
    /// that may have moved.
    ///
    /// # Errors
    /// Another number of patches, nets of other sizes, or a net that is not finite. Knots must be
    /// the same: that is not checked.
    pub fn merge(&self, surfaces: &[Surface]) -> Result<Surface, MergeError> {
        check_nets(surfaces)?;
        let (rows, columns) = (self.layout.rows, self.layout.columns);
        if surfaces.len() != rows * columns {
            return Err(MergeError::Arrangement {
                given: surfaces.len(),
                rows,
                columns,
            });
        }
        let mut sheets = Sheet::laid(surfaces, &self.layout);
        for (k, sheet) in sheets.iter().enumerate() {
            if sheet.counts() != self.counts[k] {
                return Err(MergeError::OtherNet {
                    patch: self.layout.places[k].patch,
                });
            }
        }
        for (sheet, curve) in sheets.iter_mut().zip(&self.curves) {
            sheet.end.clone_from(curve);
        }
        self.combined(&sheets)
    }

    pub(super) fn combined(&self, sheets: &[Sheet]) -> Result<Surface, MergeError> {
        if self.maps.is_empty() {
            return fitted(sheets, &self.layout, &self.lines, self.ends);
        }
        let [rows, columns] = self.lines.each_ref().map(|line| line.knots.count());
        // From a point of their own: far from the origin nothing is lost.
        let origin = sheets[0].surface.net().points()[0];
        let mut points = vec![Vector3::zeros(); rows * columns];
        let mut half = Vec::new();
        for (sheet, [map_u, map_v]) in sheets.iter().zip(&self.maps) {
            let net = sheet.surface.net();
            half.clear();
            for i in 0..net.rows() {
                let line = &net.points()[i * net.columns()..(i + 1) * net.columns()];
                half.extend(map_v.values.chunks_exact(map_v.columns).map(|share| {
                    line.iter()
                        .zip(share)
                        .fold(Vector3::zeros(), |sum, (p, s)| sum + (p - origin) * *s)
                }));
            }
            for (share, out) in map_u
                .values
                .chunks_exact(map_u.columns)
                .zip(points.chunks_exact_mut(columns))
            {
                for (s, line) in share.iter().zip(half.chunks_exact(columns)) {
                    out.iter_mut().zip(line).for_each(|(o, p)| *o += p * *s);
                }
            }
        }
        finished(&self.lines, sheets, &self.layout, origin, points)
    }
}

/// The surface of fitted points, which are from an origin; its sides are those of the first patch.
fn finished(
    [u, v]: &[Line; 2],
    sheets: &[Sheet],
    layout: &Layout,
    origin: Point3,
    points: Vec<Vector3>,
) -> Result<Surface, MergeError> {
    let (u, v) = (u.knots.clone(), v.knots.clone());
    let points: Vec<Point3> = points.into_iter().map(|p| origin + p).collect();
    let net = ControlNet::new(u.count(), v.count(), points)
        .map_err(palpate_geometry::surface::SurfaceError::from)?;
    let first = layout.places.iter().position(|p| p.patch == 0).unwrap_or(0);
    Ok(Surface::new(u, v, net, None)?.with_flip_normal(sheets[first].surface.flip_normal()))
}

/// The surface fitted to points of patches whose lines end on curves: no product of matrices samples them.
fn fitted(
    sheets: &[Sheet],
    layout: &Layout,
    lines: &[Line; 2],
    ends: Ends,
) -> Result<Surface, MergeError> {
    let origin = sheets[0].surface.net().points()[0];
    let mut samples = Vec::new();
    for (i, rows) in lines[0].rows.iter().enumerate() {
        for &f in &rows.fractions {
            for (j, columns) in lines[1].rows.iter().enumerate() {
                let sheet = &sheets[i * layout.columns + j];
                let point = |&g: &f64| <[f64; 3]>::from(sheet.point([f, g]) - origin);
                samples.extend(columns.fractions.iter().flat_map(point));
            }
        }
    }
    for line in lines {
        let parameters = line.parameters();
        let width = samples.len() / parameters.len();
        let fit = LineFit::new(&line.knots, &parameters, ends);
        samples = transposed(&fit.fit(&samples, width), width / 3);
    }
    let points = samples.chunks_exact(3).map(Vector3::from_column_slice);
    finished(lines, sheets, layout, origin, points.collect())
}

/// Columns of points as rows.
fn transposed(points: &[f64], columns: usize) -> Vec<f64> {
    let rows = points.len() / (3 * columns);
    let places = (0..columns).flat_map(|j| (0..rows).map(move |i| 3 * (i * columns + j)));
    places
        .flat_map(|k| [points[k], points[k + 1], points[k + 2]])
        .collect()
}

/// G of every place for one direction.
fn maps(
    sheets: &[Sheet],
    layout: &Layout,
    direction: Direction,
    line: &Line,
    ends: Ends,
) -> Vec<Map> {
    let parameters = line.parameters();
    let fit = LineFit::new(&line.knots, &parameters, ends);
    let mut starts = vec![0];
    line.rows
        .iter()
        .for_each(|rows| starts.push(starts[starts.len() - 1] + rows.parameters.len()));
    let place_map = |k: usize| {
        let block = if direction == Direction::U {
            k / layout.columns
        } else {
            k % layout.columns
        };
        let knots = normalised(sheets[k].surface.knots(direction));
        let blending = Blending::new(&knots, &line.rows[block].fractions);
        let width = knots.count();
        // The other blocks' samples are zero: fits add up.
        let mut samples = vec![0.0; parameters.len() * width];
        for row in 0..blending.rows() {
            for (column, value) in blending.entries(row, 0) {
                samples[(starts[block] + row) * width + column] = value;
            }
        }
        Map {
            columns: width,
            values: fit.fit(&samples, width),
        }
    };
    (0..sheets.len()).map(place_map).collect()
}
