//! A surface made ready: triangles, tree, centroid. Checked once, translated ever after.

use super::IsolateError;
use super::bvh::{Block, Bvh};
use super::grid::CellGrid;
use super::triangle::{Crossing, crossing};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::Surface;

/// Touching, relative to the size of the bodies.
pub(super) const TOUCHING: f64 = 1e-12;

/// A closed body as a triangle mesh, m.
#[derive(Clone, Debug)]
pub struct Body {
    /// (corner count).
    pub(super) points: Vec<Vector3>,
    pub(super) bvh: Bvh,
    pub(super) centroid: Vector3,
    cells: [usize; 2],
}

impl Body {
    /// Tessellates `surface` into `cells` in u and v and checks that it bounds a solid. `number`
    /// names it in errors.
    ///
    /// # Errors
    /// Open, without volume, crossing itself, not finite; or a grid that is too coarse or too fine.
    pub fn new(surface: &Surface, cells: [usize; 2], number: usize) -> Result<Self, IsolateError> {
        let body = Self::unchecked(surface, cells, number)?;
        match body.crosses_itself() {
            Some(at) => Err(IsolateError::SelfIntersecting {
                body: number,
                at: at.into(),
            }),
            None => Ok(body),
        }
    }

    /// [`Body::new`] for a surface that was found free of self-intersections before, with another
    /// grid.
    pub(super) fn unchecked(
        surface: &Surface,
        cells: [usize; 2],
        number: usize,
    ) -> Result<Self, IsolateError> {
        if surface
            .net()
            .points()
            .iter()
            .any(|p| p.iter().any(|x| !x.is_finite() || x.abs() > 1e60))
        {
            return Err(IsolateError::TooLarge { body: number });
        }
        let topology = surface.topology();
        if !topology.is_closed() {
            return Err(IsolateError::Open { body: number });
        }
        let grid = CellGrid::new(surface, &topology, cells)?;
        let (volume, _) = grid.volume_and_centroid();
        let size = surface.size();
        if grid.triangles.is_empty()
            || volume.abs().partial_cmp(&(1e-9 * size * size * size))
                != Some(std::cmp::Ordering::Greater)
        {
            return Err(IsolateError::NoVolume { body: number });
        }
        let grid = if volume < 0.0 { grid.turned() } else { grid };
        let (_, centroid) = grid.volume_and_centroid();
        let bvh = Bvh::new(&grid.points, &grid.triangles);
        Ok(Self {
            points: grid.points,
            bvh,
            centroid,
            cells,
        })
    }

    /// Cells in u and v.
    pub fn cells(&self) -> [usize; 2] {
        self.cells
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.bvh.len()
    }

    pub(super) fn block(&self) -> &Block {
        self.bvh.block()
    }

    /// How often the mesh winds round a point: 1 inside, 0 outside.
    ///
    /// The signed triangles above the point are counted. Which triangles lie above is decided edge
    /// by edge, and both triangles of an edge decide with the same numbers in the same order: no
    /// ray slips through an edge or counts it twice.
    pub(super) fn winding(&self, point: &Vector3) -> i32 {
        let mut winding = 0;
        self.bvh.above(point, |k| {
            let triangle = self.bvh.triangle(k);
            let turns = self.turns_in_plan(self.bvh.corners(k), point);
            if turns != 0 && triangle.normal.z != 0.0 {
                let height = (triangle.offset - triangle.normal.dot(point)) / triangle.normal.z;
                if height > 0.0 {
                    winding += turns;
                }
            }
        });
        winding
    }

    /// How often the outline of a triangle, seen along z, winds round the point: −1, 0, 1.
    fn turns_in_plan(&self, corners: [u32; 3], point: &Vector3) -> i32 {
        let mut turns = 0;
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let (p, q) = (&self.points[a as usize], &self.points[b as usize]);
            if (p.y <= point.y) == (q.y <= point.y) {
                continue;
            }
            let (low, high) = if a < b { (p, q) } else { (q, p) };
            let turn = (high.x - low.x) * (point.y - low.y) - (point.x - low.x) * (high.y - low.y);
            // The edge crosses the ray to +x when the point is left of it, seen from its lower end.
            let left = if high.y > low.y {
                turn > 0.0
            } else {
                turn < 0.0
            };
            if left {
                turns += if q.y > p.y { 1 } else { -1 };
            }
        }
        turns
    }

    /// A point where triangles without a common corner cross.
    fn crosses_itself(&self) -> Option<Vector3> {
        let tolerance = TOUCHING * self.block().diagonal();
        let mut found = None;
        self.bvh.pairs(&Vector3::zeros(), &self.bvh, 0.0, |i, j| {
            let (a, b) = (self.bvh.corners(i), self.bvh.corners(j));
            if i >= j || a.iter().any(|corner| b.contains(corner)) {
                return false;
            }
            let (first, second) = (self.bvh.triangle(i), self.bvh.triangle(j));
            found = crossing(first, second, tolerance).map(|how| match how {
                Crossing::Coplanar => first.corners[0],
                Crossing::Segment(p, q) => (p + q) / 2.0,
            });
            found.is_some()
        });
        found
    }
}
