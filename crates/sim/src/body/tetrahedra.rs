//! Cells as tetrahedra: which of them holds a place, and where in it.

use super::cells::Cell;
use palpate_geometry::math::{Matrix3, Point3, Vector3};

/// Corners of the six tetrahedra of a cell, all around its diagonal: those of cells that lie in rows fit together.
const SIX: [[usize; 4]; 6] = [
    [0, 4, 6, 7],
    [0, 4, 5, 7],
    [0, 2, 6, 7],
    [0, 2, 3, 7],
    [0, 1, 5, 7],
    [0, 1, 3, 7],
];
/// Volume relative to the cube of the longest edge below which a tetrahedron is flat.
const FLAT: f64 = 1e-9;
/// Shares below 0 that are rounding.
const ROUNDING: f64 = 1e-9;

/// Nodes and their shares of a place: they add up to one, and give any affine motion exactly.
pub(super) type Shares = [(u32, f64); 4];

/// Tetrahedra between nodes.
#[derive(Debug)]
pub(super) struct Tetrahedra {
    all: Vec<Tetrahedron>,
    /// Of the box around them.
    low: Point3,
    /// Of a bin, m.
    side_m: f64,
    counts: [usize; 3],
    /// By bin: tetrahedra whose boxes reach into it.
    bins: Vec<Vec<u32>>,
}

#[derive(Debug)]
struct Tetrahedron {
    nodes: [u32; 4],
    first: Point3,
    /// Rows: how the shares of the last three nodes grow, 1/m.
    slopes: Matrix3,
    /// Of the share of each node, m: from the face opposite to it to the node.
    heights_m: [f64; 4],
    middle: Point3,
    radius_m: f64,
}

impl Tetrahedron {
    fn new(nodes: [u32; 4], points: &[Point3]) -> Option<Self> {
        let corner = nodes.map(|node| points[node as usize]);
        let edges = Matrix3::from_columns(&[1, 2, 3].map(|k| corner[k] - corner[0]));
        let longest = (edges.column_iter().map(|edge| edge.norm())).fold(0.0, f64::max);
        if edges.determinant().abs() <= FLAT * longest * longest * longest {
            return None;
        }
        let slopes = edges.try_inverse()?;
        let slope = |k: usize| Vector3::new(slopes[(k, 0)], slopes[(k, 1)], slopes[(k, 2)]);
        let [b, c, d] = [slope(0), slope(1), slope(2)];
        let middle = Point3::from(corner.iter().map(|p| p.coords).sum::<Vector3>() / 4.0);
        let reach = corner.iter().map(|p| (p - middle).norm());
        Some(Self {
            nodes,
            first: corner[0],
            slopes,
            heights_m: [-(b + c + d), b, c, d].map(|slope| 1.0 / slope.norm()),
            middle,
            radius_m: reach.fold(0.0, f64::max),
        })
    }

    fn shares(&self, place: &Point3) -> [f64; 4] {
        let last = self.slopes * (place - self.first);
        [1.0 - last.sum(), last.x, last.y, last.z]
    }

    /// How far outside a place with these shares is: beyond the face that it is farthest from, m.
    fn outside_m(&self, shares: &[f64; 4]) -> f64 {
        let beyond = shares.iter().zip(&self.heights_m).map(|(s, h)| -s * h);
        beyond.fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The tetrahedra of a cell: around the first of its diagonals with which every node is of one that is not flat. Around the
/// others, nodes of a cell with collapsed edges may be of none.
fn parts(cell: &Cell, points: &[Point3]) -> Vec<Tetrahedron> {
    let around = |diagonal: usize| -> Vec<Tetrahedron> {
        let six = SIX.map(|corners| corners.map(|corner| cell[corner ^ diagonal]));
        let all = six.into_iter();
        all.filter_map(|nodes| Tetrahedron::new(nodes, points))
            .collect()
    };
    let holds_all = |parts: &Vec<Tetrahedron>| {
        let held = |node: &u32| parts.iter().any(|part| part.nodes.contains(node));
        cell.iter().all(held)
    };
    let mut ways = [0, 4, 2, 1].map(around).into_iter();
    let first = ways.next().unwrap_or_default();
    if holds_all(&first) {
        return first;
    }
    ways.find(holds_all).unwrap_or(first)
}

impl Tetrahedra {
    /// Of cells between nodes at these places; flat ones are left out. `None` if nothing is left.
    pub fn new(cells: &[Cell], points: &[Point3]) -> Option<Self> {
        let all: Vec<Tetrahedron> = cells.iter().flat_map(|cell| parts(cell, points)).collect();
        let ends = |reach: f64| {
            let each = all
                .iter()
                .map(move |t| t.middle + Vector3::repeat(reach * t.radius_m));
            each.collect::<Vec<_>>()
        };
        let low = ends(-1.0).into_iter().reduce(|a, b| a.inf(&b))?;
        let high = ends(1.0).into_iter().reduce(|a, b| a.sup(&b))?;
        let sides = high - low;
        let side_m = libm::cbrt(sides.iter().product::<f64>() * 6.0 / all.len() as f64);
        let side_m = side_m.max(sides.max() / 256.0);
        let counts = [0, 1, 2].map(|axis| (sides[axis] / side_m) as usize + 1);
        let mut tetrahedra = Self {
            bins: vec![Vec::new(); counts.iter().product()],
            all: Vec::new(),
            low,
            side_m,
            counts,
        };
        for (k, one) in all.iter().enumerate() {
            let reach = Vector3::repeat(one.radius_m);
            let [from, to] = [one.middle - reach, one.middle + reach].map(|p| tetrahedra.bin(&p));
            for x in from[0]..=to[0] {
                for y in from[1]..=to[1] {
                    for z in from[2]..=to[2] {
                        let bin = (x * counts[1] + y) * counts[2] + z;
                        tetrahedra.bins[bin].push(k as u32);
                    }
                }
            }
        }
        tetrahedra.all = all;
        Some(tetrahedra)
    }

    /// The bin of a place, or the one nearest to it.
    fn bin(&self, place: &Point3) -> [usize; 3] {
        let along = (place - self.low) / self.side_m;
        // A float that is too small becomes 0.
        [0, 1, 2].map(|axis| (along[axis] as usize).min(self.counts[axis] - 1))
    }

    /// The shares of a place: of the tetrahedron that holds it, or of the nearest.
    pub fn shares(&self, place: &Point3) -> Shares {
        let [x, y, z] = self.bin(place);
        let near = &self.bins[(x * self.counts[1] + y) * self.counts[2] + z];
        let mut best = Best::default();
        for &k in near {
            best.look(&self.all, k as usize, place);
        }
        if best.outside_m > 0.0 {
            for k in 0..self.all.len() {
                let one = &self.all[k];
                if (place - one.middle).norm() - one.radius_m < best.outside_m {
                    best.look(&self.all, k, place);
                }
            }
        }
        let held = &self.all[best.one];
        let shares = held.shares(place);
        [0, 1, 2, 3].map(|k| (held.nodes[k], shares[k]))
    }
}

/// The best tetrahedron for a place: the one that it is least outside of; of several that hold it, as where cells with bent
/// faces overlap, the one in which it is nearest to a node, so that a node is always itself.
struct Best {
    outside_m: f64,
    largest: f64,
    one: usize,
}

impl Default for Best {
    fn default() -> Self {
        Self {
            outside_m: f64::INFINITY,
            largest: 0.0,
            one: 0,
        }
    }
}

impl Best {
    fn look(&mut self, all: &[Tetrahedron], one: usize, place: &Point3) {
        let shares = all[one].shares(place);
        let outside_m = all[one].outside_m(&shares);
        // Held but for rounding is held.
        let outside_m = match outside_m <= ROUNDING * all[one].radius_m {
            true => 0.0,
            false => outside_m,
        };
        let largest = shares.iter().copied().fold(0.0, f64::max);
        if outside_m < self.outside_m || outside_m == self.outside_m && largest > self.largest {
            *self = Self {
                outside_m,
                largest,
                one,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::CellGrid;

    fn block() -> (CellGrid, impl FnMut() -> f64) {
        let (low, high) = (Point3::new(-1.0, 0.0, 2.0), Point3::new(1.0, 3.0, 3.0));
        let block = CellGrid::cuboid(&low, &high, [5, 6, 4]);
        let mut state = 3_u64;
        let random = move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (block, random)
    }

    #[test]
    fn affine_motions_are_exact_inside_and_outside() {
        let (mut block, mut random) = block();
        for node in &mut block.nodes {
            *node += Vector3::new(random(), random(), random()) * 0.05;
        }
        let nodes = &block.nodes;
        let found = Tetrahedra::new(&block.cells, nodes).unwrap();
        let map = Matrix3::new(1.0, 0.2, -0.4, 0.1, 0.7, 0.3, -0.2, 0.5, 1.3);
        for _ in 0..2_000 {
            let place = Point3::new(
                random() * 4.0 - 2.0,
                random() * 5.0 - 1.0,
                random() * 3.0 + 1.0,
            );
            let shares = found.shares(&place);
            let at = |of: &dyn Fn(&Point3) -> Vector3| -> Vector3 {
                (shares.iter())
                    .map(|&(node, share)| of(&nodes[node as usize]) * share)
                    .sum()
            };
            // Shares of places outside grow with their distance.
            assert!((at(&|p| p.coords) - place.coords).norm() < 1e-12);
            assert!((at(&|p| map * p.coords) - map * place.coords).norm() < 1e-12);
        }
    }

    #[test]
    fn a_place_inside_has_shares_from_0_to_1() {
        let (block, mut random) = block();
        let found = Tetrahedra::new(&block.cells, &block.nodes).unwrap();
        for _ in 0..2_000 {
            let place = Point3::new(random() * 2.0 - 1.0, random() * 3.0, random() + 2.0);
            let shares = found.shares(&place);
            assert!(
                shares
                    .iter()
                    .all(|share| (-1e-9..=1.0 + 1e-9).contains(&share.1))
            );
        }
    }

    #[test]
    fn nothing_comes_of_cells_without_volume() {
        let points = vec![Point3::origin(); 8];
        assert!(Tetrahedra::new(&[[0, 1, 2, 3, 4, 5, 6, 7]], &points).is_none());
        assert!(Tetrahedra::new(&[], &[]).is_none());
    }
}
