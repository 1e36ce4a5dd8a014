//! Triangles of a mesh that cross each other.
//!
//! Boxes halve the triangles at the median of their longest side; boxes that meet are opened, two
//! at a time. Two triangles that share no corner cross when an edge of one passes through the
//! inside of the other: its ends lie on different sides of the plane and it goes round the three
//! sides in one sense. What only touches, within rounding, does not count, and neither does what
//! lies in one plane: a sheet folded in its plane is found by its edges.

use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Mesh;

/// Triangles to a leaf.
const LEAF: usize = 8;

/// Volumes below this fraction of the size cubed are rounding.
const FLAT: f64 = 1e-13;

/// Pairs of triangles that cross, up to `most`, in ascending order.
pub(super) fn crossing_pairs(mesh: &Mesh, most: usize) -> Vec<[usize; 2]> {
    if mesh.triangles.is_empty() {
        return Vec::new();
    }
    let tree = CrossingTree::new(mesh);
    let mut pairs = Vec::new();
    let mut open = vec![(0, 0)];
    while let Some((a, b)) = open.pop() {
        if pairs.len() >= most {
            break;
        }
        let (x, y) = (&tree.nodes[a], &tree.nodes[b]);
        if !x.meets(y) {
            continue;
        }
        match (x.children, y.children) {
            (None, None) => tree.test(mesh, x, y, a == b, &mut pairs),
            (Some([c, d]), _) if a == b => open.extend([(c, c), (d, d), (c, d)]),
            (Some([c, d]), None) => open.extend([(c, b), (d, b)]),
            (Some([c, d]), Some(_)) if x.count() >= y.count() => open.extend([(c, b), (d, b)]),
            (_, Some([c, d])) => open.extend([(a, c), (a, d)]),
        }
    }
    pairs.sort_unstable();
    pairs.truncate(most);
    pairs
}

struct CrossingNode {
    low: Point3,
    high: Point3,
    range: [usize; 2],
    children: Option<[usize; 2]>,
}

impl CrossingNode {
    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|c| self.low[c] <= other.high[c] && other.low[c] <= self.high[c])
    }

    fn count(&self) -> usize {
        self.range[1] - self.range[0]
    }
}

struct CrossingTree {
    nodes: Vec<CrossingNode>,
    order: Vec<usize>,
    /// Volumes that are rounding, m³.
    flat: f64,
}

impl CrossingTree {
    fn new(mesh: &Mesh) -> Self {
        let mut tree = Self {
            nodes: Vec::new(),
            order: (0..mesh.triangles.len()).collect(),
            flat: 0.0,
        };
        tree.add(mesh, [0, mesh.triangles.len()]);
        let size = (tree.nodes[0].high - tree.nodes[0].low).norm();
        tree.flat = FLAT * size * size * size;
        tree
    }

    /// Depth is logarithmic: each range is halved.
    fn add(&mut self, mesh: &Mesh, range: [usize; 2]) -> usize {
        let corners = |t: usize| mesh.triangles[t].map(|k| mesh.points[k as usize]);
        let first = corners(self.order[range[0]])[0];
        let (mut low, mut high) = (first, first);
        for &t in &self.order[range[0]..range[1]] {
            for corner in corners(t) {
                (low, high) = (low.inf(&corner), high.sup(&corner));
            }
        }
        let number = self.nodes.len();
        self.nodes.push(CrossingNode {
            low,
            high,
            range,
            children: None,
        });
        if range[1] - range[0] > LEAF {
            let axis = (high - low).imax();
            let middle = range[0] + (range[1] - range[0]) / 2;
            let height = |t: &usize| corners(*t).iter().map(|corner| corner[axis]).sum::<f64>();
            self.order[range[0]..range[1]]
                .sort_by(|a, b| height(a).total_cmp(&height(b)).then(a.cmp(b)));
            let children = [
                self.add(mesh, [range[0], middle]),
                self.add(mesh, [middle, range[1]]),
            ];
            self.nodes[number].children = Some(children);
        }
        number
    }

    fn test(
        &self,
        mesh: &Mesh,
        x: &CrossingNode,
        y: &CrossingNode,
        same: bool,
        pairs: &mut Vec<[usize; 2]>,
    ) {
        for i in x.range[0]..x.range[1] {
            let others = if same { i + 1 } else { y.range[0] }..y.range[1];
            for j in others {
                let (a, b) = (self.order[i], self.order[j]);
                let (ta, tb) = (mesh.triangles[a], mesh.triangles[b]);
                if ta.iter().any(|k| tb.contains(k)) {
                    continue;
                }
                let place = |t: [u32; 3]| t.map(|k| mesh.points[k as usize]);
                if cross(&place(ta), &place(tb), self.flat) {
                    pairs.push([a.min(b), a.max(b)]);
                }
            }
        }
    }
}

/// True when an edge of one triangle passes through the inside of the other.
fn cross(a: &[Point3; 3], b: &[Point3; 3], flat: f64) -> bool {
    pierces(a, b, flat) || pierces(b, a, flat)
}

fn pierces(edges_of: &[Point3; 3], triangle: &[Point3; 3], flat: f64) -> bool {
    let [p, q, r] = triangle;
    let heights = edges_of.map(|x| volume(p, q, r, &x));
    (0..3).any(|k| {
        let (from, to) = (k, (k + 1) % 3);
        let parted = (heights[from] > flat && heights[to] < -flat)
            || (heights[from] < -flat && heights[to] > flat);
        parted && {
            let (s, t) = (&edges_of[from], &edges_of[to]);
            let round = [volume(s, t, p, q), volume(s, t, q, r), volume(s, t, r, p)];
            round.iter().all(|v| *v > flat) || round.iter().all(|v| *v < -flat)
        }
    })
}

/// Six times the signed volume of a tetrahedron.
fn volume(a: &Point3, b: &Point3, c: &Point3, d: &Point3) -> f64 {
    let [x, y, z]: [Vector3; 3] = [b - a, c - a, d - a];
    x.cross(&y).dot(&z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn triangle(points: [[f64; 3]; 3]) -> [Point3; 3] {
        points.map(|p| Point3::new(p[0], p[1], p[2]))
    }

    #[test]
    fn triangles_cross_when_an_edge_passes_through_the_inside() {
        let floor = triangle([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let post = |x: f64, y: f64, low: f64, high: f64| {
            triangle([[x, y, low], [x, y, high], [x + 2.0, y + 2.0, high]])
        };
        assert!(cross(&floor, &post(0.2, 0.3, -1.0, 1.0), 1e-13));
        assert!(
            !cross(&floor, &post(0.7, 0.7, -1.0, 1.0), 1e-13),
            "beside it"
        );
        assert!(!cross(&floor, &post(0.2, 0.3, 0.1, 1.0), 1e-13), "above it");
        assert!(
            !cross(&floor, &post(0.2, 0.3, 0.0, 1.0), 1e-13),
            "standing on it"
        );
        assert!(
            !cross(
                &floor,
                &floor.map(|p| p + Vector3::new(0.1, 0.1, 0.0)),
                1e-13
            ),
            "in its plane"
        );
    }

    /// By the interval that each triangle cuts from the line of the two planes; Möller's test,
    /// another way.
    fn cross_by_intervals(a: &[Point3; 3], b: &[Point3; 3]) -> bool {
        let normal = |t: &[Point3; 3]| (t[1] - t[0]).cross(&(t[2] - t[0]));
        let (na, nb) = (normal(a), normal(b));
        let line = na.cross(&nb);
        let cut = |t: &[Point3; 3], n: Vector3, on: Point3| {
            let heights = t.map(|p| n.dot(&(p - on)));
            let mut ends = Vec::new();
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                if (heights[i] > 0.0) != (heights[j] > 0.0) {
                    let share = heights[i] / (heights[i] - heights[j]);
                    ends.push(line.dot(&(t[i] + (t[j] - t[i]) * share).coords));
                }
            }
            (ends.len() == 2).then(|| [ends[0].min(ends[1]), ends[0].max(ends[1])])
        };
        match (cut(a, nb, b[0]), cut(b, na, a[0])) {
            (Some(x), Some(y)) => x[0] < y[1] && y[0] < x[1],
            _ => false,
        }
    }

    #[test]
    fn pairs_are_those_of_all_triangles_against_all() {
        let mut random = Random(77);
        for _ in 0..20 {
            let mut points = Vec::new();
            for _ in 0..60 {
                let centre = Point3::from([0; 3].map(|_| random.float(0.0, 1.0)));
                points.extend(
                    [0; 3].map(|_| centre + Vector3::from([0; 3].map(|_| random.float(-0.3, 0.3)))),
                );
            }
            let triangles: Vec<[u32; 3]> = (0..60).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let mesh = Mesh::from_triangles(points, triangles).unwrap();
            let corners = |t: usize| mesh.triangles[t].map(|k| mesh.points[k as usize]);
            let mut wanted = Vec::new();
            for i in 0..60 {
                wanted.extend(
                    (i + 1..60)
                        .filter(|&j| cross_by_intervals(&corners(i), &corners(j)))
                        .map(|j| [i, j]),
                );
            }
            assert!(wanted.len() >= 10, "{} pairs", wanted.len());
            assert_eq!(crossing_pairs(&mesh, usize::MAX), wanted);
            assert_eq!(crossing_pairs(&mesh, 5).len(), 5);
        }
    }
}
