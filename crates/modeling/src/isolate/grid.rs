//! Triangles over a grid of parameters: the tessellation that all overlap tests share.
//!
//! Lines are even in the parameter, with those knots added at which the surface may have a crease.
//! Ends that meet are one line of corners and a pole is one corner, so that a closed surface gives
//! a closed mesh.

use super::IsolateError;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::{Surface, Topology};

/// Most corners of a mesh.
pub(super) const MOST_CORNERS: usize = 1 << 20;
/// Default number of cells per knot span, and the smallest and largest number in a direction.
const CELLS_PER_SPAN: usize = 3;
const FEWEST_CELLS: usize = 24;
const MOST_CELLS: usize = 96;

/// Corners and triangles, counter-clockwise seen from outside.
#[derive(Clone, Debug)]
pub(super) struct CellGrid {
    pub points: Vec<Vector3>,
    pub triangles: Vec<[u32; 3]>,
}

/// Cells in u and v for a surface of which nothing else is known: three to a span, 24 to 96 in all.
pub(super) fn usual_cells(surface: &Surface) -> [usize; 2] {
    [surface.knots_u(), surface.knots_v()]
        .map(|knots| (CELLS_PER_SPAN * knots.spans().count()).clamp(FEWEST_CELLS, MOST_CELLS))
}

impl CellGrid {
    /// A closed surface over `cells` in u and v.
    ///
    /// # Errors
    /// Fewer than three cells in a direction, or too many.
    pub fn new(
        surface: &Surface,
        topology: &Topology,
        cells: [usize; 2],
    ) -> Result<Self, IsolateError> {
        let too_many =
            |[n, m]: [usize; 2]| n.checked_mul(m).is_none_or(|count| count > MOST_CORNERS);
        if cells.iter().any(|n| *n < 3) || too_many(cells.map(|n| n.saturating_add(1))) {
            return Err(IsolateError::Resolution { cells });
        }
        let (us, vs) = (
            lines(surface.knots_u(), cells[0]),
            lines(surface.knots_v(), cells[1]),
        );
        if too_many([us.len(), vs.len()]) {
            return Err(IsolateError::Resolution { cells });
        }
        let windows: Vec<_> = vs.iter().map(|&v| surface.knots_v().window(v)).collect();
        let mut points = Vec::with_capacity(us.len() * vs.len());
        let mut numbers = vec![0_u32; us.len() * vs.len()];
        for (i, &u) in us.iter().enumerate() {
            let window = surface.knots_u().window(u);
            for j in 0..vs.len() {
                let ends = [[i == 0, i + 1 == us.len()], [j == 0, j + 1 == vs.len()]];
                let (row, column) = owner(topology, [i, j], ends);
                numbers[i * vs.len() + j] = if (row, column) == (i, j) {
                    points.push(surface.point_in(&window, &windows[j]).coords);
                    points.len() as u32 - 1
                } else {
                    numbers[row * vs.len() + column]
                };
            }
        }
        let mut triangles = Vec::with_capacity(2 * us.len() * vs.len());
        for i in 0..us.len() - 1 {
            for j in 0..vs.len() - 1 {
                let at = |i: usize, j: usize| numbers[i * vs.len() + j];
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let two = [[a, b, c], [a, c, d]];
                triangles.extend(
                    two.into_iter()
                        .filter(|[a, b, c]| a != b && b != c && c != a),
                );
            }
        }
        Ok(Self { points, triangles })
    }

    /// The other side of each triangle.
    pub fn turned(mut self) -> Self {
        self.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        self
    }

    /// Signed volume (m³) and centroid of what the triangles enclose.
    pub fn volume_and_centroid(&self) -> (f64, Vector3) {
        let origin = self.points[0];
        let (mut six, mut first) = (0.0, Vector3::zeros());
        for t in &self.triangles {
            let [a, b, c] = t.map(|k| self.points[k as usize] - origin);
            let part = a.dot(&b.cross(&c));
            six += part;
            first += (a + b + c) * part;
        }
        (six / 6.0, origin + first / (4.0 * six))
    }
}

/// The grid point that (i, j) is the same corner as.
fn owner(topology: &Topology, at: [usize; 2], ends: [[bool; 2]; 2]) -> (usize, usize) {
    let [mut i, mut j] = at;
    if ends[0][1] && topology.wraps(0) {
        i = 0;
    }
    if ends[1][1] && topology.wraps(1) {
        j = 0;
    }
    let pole = |d: usize| (0..2).any(|e| ends[d][e] && topology.poles[d][e]);
    if pole(0) {
        j = 0;
    }
    if pole(1) {
        i = 0;
    }
    (i, j)
}

/// Parameters from the start of the domain to its end.
fn lines(knots: &KnotVector, cells: usize) -> Vec<f64> {
    let (start, end) = knots.domain();
    let mut lines: Vec<f64> = (0..=cells)
        .map(|k| start + (end - start) * (k as f64 / cells as f64))
        .collect();
    lines[cells] = end;
    let near = (end - start) * 1e-9;
    let creases = knots.spans().map(|span| knots.knots()[span]);
    let creases: Vec<f64> = creases
        .filter(|&knot| knot > start && knots.multiplicity(knot) >= knots.degree())
        .collect();
    lines.retain(|line| creases.iter().all(|crease| (crease - line).abs() > near));
    lines.extend(creases);
    lines.sort_by(f64::total_cmp);
    lines
}
