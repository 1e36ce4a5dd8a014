//! The control net: a grid of points.

use crate::math::{MOST_COORDINATE_M, Point3, first_outside};

/// Why a net was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NetError {
    /// Wrong number of points.
    #[error("{given} control points, but {rows} × {columns} needs {}", rows * columns)]
    Count {
        /// Given number.
        given: usize,
        /// Rows, u.
        rows: usize,
        /// Columns, v.
        columns: usize,
    },
    /// A coordinate that is not finite, or too large to calculate with.
    #[error(
        "control point ({row}, {column}) has coordinate {value} m, not a finite number within ±{MOST_COORDINATE_M:e} m"
    )]
    NotFinite {
        /// Row, u.
        row: usize,
        /// Column, v.
        column: usize,
        /// The value.
        value: f64,
    },
}

/// `rows × columns` points within ±[`MOST_COORDINATE_M`], u-major and contiguous, m.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlNet {
    rows: usize,
    columns: usize,
    points: Vec<Point3>,
}

impl ControlNet {
    /// Checks counts and values.
    ///
    /// # Errors
    /// Wrong count, or a coordinate that is not a number within ±[`MOST_COORDINATE_M`].
    pub fn new(rows: usize, columns: usize, points: Vec<Point3>) -> Result<Self, NetError> {
        if points.len() != rows * columns {
            return Err(NetError::Count {
                given: points.len(),
                rows,
                columns,
            });
        }
        if let Some((k, value)) = first_outside(&points) {
            return Err(NetError::NotFinite {
                row: k / columns,
                column: k % columns,
                value,
            });
        }
        Ok(Self {
            rows,
            columns,
            points,
        })
    }

    /// A net of points that were checked, or made of such.
    pub(crate) fn from_checked(rows: usize, columns: usize, points: Vec<Point3>) -> Self {
        debug_assert_eq!(
            points.len(),
            rows * columns,
            "points and shape of the net disagree"
        );
        Self {
            rows,
            columns,
            points,
        }
    }

    /// Rows, u.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Columns, v.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// All points, u-major.
    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// Diagonal of the bounding box, m.
    pub(crate) fn size(&self) -> f64 {
        let Some(&first) = self.points.first() else {
            return 0.0;
        };
        let (mut low, mut high) = (first, first);
        for point in &self.points {
            low = low.inf(point);
            high = high.sup(point);
        }
        (high - low).norm()
    }

    /// All points, to be moved; their number cannot change.
    pub fn points_mut(&mut self) -> &mut [Point3] {
        &mut self.points
    }

    /// Point (row, column).
    pub fn at(&self, row: usize, column: usize) -> &Point3 {
        &self.points[row * self.columns + column]
    }
}
