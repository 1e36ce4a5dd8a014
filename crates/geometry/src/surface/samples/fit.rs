//! Nets back from grids of points: the least-squares inverse of sampling, a direction at a time.

use super::SampleGrid;
use crate::basis::BlendingInverse;
use crate::math::{Point3, Vector3};
use crate::surface::ControlNet;

/// Fits nets to grids of points at the parameters of two blendings.
#[derive(Clone, Debug)]
pub struct GridFit {
    u: BlendingInverse,
    v: BlendingInverse,
    /// (rows × net columns): fitted in v, not yet in u.
    half: Vec<Vector3>,
    line: Vec<Vector3>,
    fitted: Vec<Vector3>,
    scratch: Vec<Vector3>,
}

impl GridFit {
    /// Factors both directions and allocates what fits need.
    pub fn new(grid: &SampleGrid) -> Self {
        let (u, v) = (&grid.u, &grid.v);
        let longest = u.rows().max(v.rows()).max(u.columns()).max(v.columns());
        Self {
            half: vec![Vector3::zeros(); u.rows() * v.columns()],
            line: vec![Vector3::zeros(); longest],
            fitted: vec![Vector3::zeros(); longest],
            scratch: vec![Vector3::zeros(); 2 * longest],
            u: BlendingInverse::new(u.clone()),
            v: BlendingInverse::new(v.clone()),
        }
    }

    /// The net, without weights, whose points at the grid miss `points` (u-major) least in the sum
    /// of squares.
    pub fn fit_into(&mut self, points: &[Point3], net: &mut ControlNet) {
        let (rows, per_row) = (self.u.blending().rows(), self.v.blending().rows());
        let (net_rows, net_columns) = (self.u.blending().columns(), self.v.blending().columns());
        debug_assert_eq!(points.len(), rows * per_row, "points and grid disagree");
        debug_assert_eq!(
            (net.rows(), net.columns()),
            (net_rows, net_columns),
            "net and grid disagree"
        );
        for i in 0..rows {
            for (j, sample) in self.line[..per_row].iter_mut().enumerate() {
                *sample = points[i * per_row + j].coords;
            }
            let fitted = &mut self.half[i * net_columns..(i + 1) * net_columns];
            self.v.fit(&self.line[..per_row], fitted, &mut self.scratch);
        }
        for j in 0..net_columns {
            for (i, sample) in self.line[..rows].iter_mut().enumerate() {
                *sample = self.half[i * net_columns + j];
            }
            self.u.fit(
                &self.line[..rows],
                &mut self.fitted[..net_rows],
                &mut self.scratch,
            );
            for (i, fitted) in self.fitted[..net_rows].iter().enumerate() {
                net.points_mut()[i * net_columns + j] = Point3::from(*fitted);
            }
        }
    }
}
