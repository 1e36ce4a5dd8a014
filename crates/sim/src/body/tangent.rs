//! The tangent of backward Euler, `M / dt² + (1 + d / dt) K`, in 3 × 3 blocks of coordinates, and what is added for
//! springs.
//!
//! Springs alone are soft against turning (cells that are long and thin, light nodes). What their tension adds there is
//! met by a share of a Laplacian, as large as slow motions allow: it resists turning too, as if the body were heavier.

use super::elements::{Place, Weight};
use super::matter::Matter;
use super::neighbours::middle;
use super::node_map::{NodeMap, SparseRows};
use palpate_geometry::math::{BlockTriplets, Matrix3, SymmetricTriplets, Vector3};
use std::collections::BTreeMap;

/// Shares of the firm Laplacian: at most in the tangent of rest, and in the firmer one.
const MOST_SHARE: f64 = 0.5;
const FIRM_SHARE: f64 = 1.0;
/// Of the middle length: edges shorter than this have a larger share.
const SHORT: f64 = 0.5;
/// The largest share of a short edge.
const SHORT_SHARE: f64 = 1.0;
/// How much the share may add to the inertia of turning: slow swings become longer by half of it.
const ADDED_INERTIA: f64 = 0.01;
/// A beam's slowest swing turns its parts more than turning as a whole does, for the same kinetic
/// energy; measured on beams of 12 to 16 cells.
const SWING: f64 = 4.4;

/// Edges of the firm Laplacian, (nodes, nodes, N/m).
pub(super) struct Firm {
    /// What they carry in the tangent of rest.
    pub rest: Vec<(u32, u32, f64)>,
    /// And in the firmer one.
    pub firmer: Vec<(u32, u32, f64)>,
    /// What short ones carry more than others in the tangent of rest.
    pub short: Vec<(u32, u32, f64)>,
}

/// The firm Laplacian in the matrices of a lattice.
///
/// Edges have the same share, except that short ones have more, by the square of the
/// middle length over theirs: they add no more to the inertia of turning, and it is there (poles) that
/// the frames of neighbours differ most against their distance.
pub(super) fn firm(matter: &Matter) -> Firm {
    let nodes = matter.map.nodes(&matter.rest);
    let dt = matter.settings.dt_s;
    let (mut at, mut weight) = (Vector3::zeros(), 0.0);
    for (c, place) in matter.rest.iter().enumerate() {
        if matter.is_free() || matter.unknown(c).is_none() {
            at += place.coords * matter.masses[c];
            weight += matter.masses[c];
        }
    }
    let centre = at / weight;
    let inertia: f64 = (matter.masses.iter().zip(&matter.rest))
        .map(|(m, place)| m * (place.coords - centre).norm_squared())
        .sum();
    let edges = matter.law.edges(Weight::Firm);
    let squares: Vec<f64> = (edges.iter())
        .map(|&(a, b, _)| (nodes[a as usize] - nodes[b as usize]).norm_squared())
        .collect();
    let middle = middle(&squares);
    let boost = |square: f64| (SHORT * SHORT * middle / square.max(f64::MIN_POSITIVE)).max(1.0);
    let share = |least: f64, most: f64, square: f64| (least * boost(square)).min(most);
    // Turning about each axis at 1 rad/s adds up to |r|² twice.
    let heavier = |least: f64| {
        let each = edges.iter().zip(&squares);
        let turning: f64 = each
            .map(|(&(_, _, k), &square)| k * square * share(least, SHORT_SHARE, square))
            .sum();
        SWING * turning * dt * dt / inertia
    };
    // The largest share that makes turning no heavier than allowed, by bisection.
    let (mut low, mut high) = (0.0, MOST_SHARE);
    for _ in 0..60 {
        let share = 0.5 * (low + high);
        match heavier(share) <= ADDED_INERTIA {
            true => low = share,
            false => high = share,
        }
    }
    let carried = |least: f64| -> Vec<(u32, u32, f64)> {
        let each = edges.iter().zip(&squares);
        each.map(|(&(a, b, k), &square)| (a, b, k * share(least, SHORT_SHARE, square)))
            .collect()
    };
    let short = edges
        .iter()
        .zip(&squares)
        .filter_map(|(&(a, b, k), &square)| {
            let more = share(low, SHORT_SHARE, square) - low;
            (more > 0.0).then_some((a, b, k * more))
        });
    Firm {
        rest: carried(low),
        firmer: carried(FIRM_SHARE),
        short: short.collect(),
    }
}

/// Adds what edges carry to blocks of the coordinates that can move.
pub(super) fn add_edges(matter: &Matter, edges: &[(u32, u32, f64)], to: &mut BlockTriplets) {
    let scale = matter.voigt();
    let mut scalar = SymmetricTriplets::new(to.n);
    let edges: Vec<_> = edges.iter().map(|&(a, b, k)| (a, b, k * scale)).collect();
    (matter.map).add_edges(&edges, |c| matter.unknown(c as usize), &mut scalar);
    for &(i, j, value) in &scalar.entries {
        let block = Matrix3::from_diagonal_element(value);
        to.add(i as usize, j as usize, block);
    }
}

/// The tangent at a place, in blocks of the coordinates that can move.
pub(super) fn at(matter: &Matter, place: &Place<'_>) -> BlockTriplets {
    let dt = matter.settings.dt_s;
    let scale = 1.0 + matter.damping_s / dt;
    let mut matrix = BlockTriplets::new(matter.unknown_count());
    for (row, &coordinate) in matter.coordinate_of_unknown.iter().enumerate() {
        let share = matter.masses[coordinate as usize] / (dt * dt);
        matrix.add(row, row, Matrix3::from_diagonal_element(share));
    }
    match &matter.map {
        NodeMap::Same => {
            matter.law.tangent_at(place, &mut |a, b, block| {
                let (a, b) = (matter.unknown(a as usize), matter.unknown(b as usize));
                if let (Some(a), Some(b)) = (a, b) {
                    matrix.add(a, b, block * scale);
                }
            });
            matter
                .law
                .shared_at(place.places, &mut |growth, stiffness| {
                    let gradient = gathered(matter, growth.iter().copied());
                    each_product(&gradient, stiffness * scale, &mut |i, j, block| {
                        matrix.add(i, j, block);
                    });
                });
        }
        NodeMap::Sparse(map) => {
            let pairs = node_pairs(matter, place);
            let mut shared = Vec::new();
            (matter.law).shared_at(place.places, &mut |growth, stiffness| {
                let of_nodes = growth.iter().map(|&(node, gradient)| {
                    let (coordinates, weights) = map.row(node as usize);
                    (gradient, coordinates.iter().zip(weights))
                });
                let of_coordinates =
                    of_nodes.flat_map(|(gradient, row)| row.map(move |(&c, &w)| (c, gradient * w)));
                shared.push((gathered(matter, of_coordinates), stiffness * scale));
            });
            let mut rows = BlockRows::new(matter, map, &pairs, &shared);
            rows.add_pairs(matter, map, &pairs, scale);
            for (gradient, stiffness) in &shared {
                each_product(gradient, *stiffness, &mut |i, j, block| {
                    let at = rows.find(i, j);
                    rows.blocks[at] += block;
                });
            }
            rows.add_to(&mut matrix);
        }
    }
    matrix
}

/// The tangent by pairs of nodes, sorted; each pair once.
fn node_pairs(matter: &Matter, place: &Place<'_>) -> Vec<(u32, u32, Matrix3)> {
    let merge = |pairs: &mut Vec<(u32, u32, Matrix3)>| {
        pairs.sort_by_key(|&(a, b, _)| (a, b));
        pairs.dedup_by(|later, first| {
            let same = (later.0, later.1) == (first.0, first.1);
            if same {
                first.2 += later.2;
            }
            same
        });
    };
    // Cells share most of their pairs: merged before they fill the memory.
    let (mut pairs, mut most) = (Vec::new(), 1 << 16);
    (matter.law).tangent_at(place, &mut |a, b, block| {
        if pairs.len() == most {
            merge(&mut pairs);
            most = most.max(2 * pairs.len());
        }
        pairs.push((a, b, block));
    });
    merge(&mut pairs);
    pairs
}

/// A gradient by unknown, sorted, from its parts by coordinate.
fn gathered(matter: &Matter, parts: impl Iterator<Item = (u32, Vector3)>) -> Vec<(usize, Vector3)> {
    let mut gradient: BTreeMap<usize, Vector3> = BTreeMap::new();
    for (coordinate, part) in parts {
        if let Some(unknown) = matter.unknown(coordinate as usize) {
            *gradient.entry(unknown).or_insert_with(Vector3::zeros) += part;
        }
    }
    gradient.into_iter().collect()
}

/// Hands out the lower blocks of k g gᵀ by unknowns.
fn each_product(
    gradient: &[(usize, Vector3)],
    stiffness: f64,
    out: &mut impl FnMut(usize, usize, Matrix3),
) {
    for (row, (i, a)) in gradient.iter().enumerate() {
        for (j, b) in &gradient[..=row] {
            out(*i, *j, a * b.transpose() * stiffness);
        }
    }
}

/// Lower rows of blocks whose places are known before the blocks are: many small products add up in each.
struct BlockRows {
    /// (unknowns + 1).
    starts: Vec<usize>,
    /// Sorted within a row.
    columns: Vec<u32>,
    blocks: Vec<Matrix3>,
}

impl BlockRows {
    /// All zero, with a place for each pair of unknowns that a pair of nodes or a shared gradient joins.
    fn new(
        matter: &Matter,
        map: &SparseRows,
        pairs: &[(u32, u32, Matrix3)],
        shared: &[(Vec<(usize, Vector3)>, f64)],
    ) -> Self {
        let n = matter.unknown_count();
        let mut nodes_of = vec![Vec::new(); n];
        for node in 0..map.rows() {
            for &c in map.row(node).0 {
                if let Some(unknown) = matter.unknown(c as usize) {
                    nodes_of[unknown].push(node as u32);
                }
            }
        }
        let mut beside = vec![Vec::new(); map.rows()];
        for &(a, b, _) in pairs {
            beside[a as usize].push(b);
            if a != b {
                beside[b as usize].push(a);
            }
        }
        let mut gradients_of = vec![Vec::new(); n];
        for (k, (gradient, _)) in shared.iter().enumerate() {
            gradient.iter().for_each(|(i, _)| gradients_of[*i].push(k));
        }
        let (mut starts, mut columns) = (vec![0], Vec::new());
        let (mut seen_node, mut seen) = (vec![usize::MAX; map.rows()], vec![usize::MAX; n]);
        for i in 0..n {
            let from = columns.len();
            let mut put = |j: usize| {
                if j <= i && std::mem::replace(&mut seen[j], i) != i {
                    columns.push(j as u32);
                }
            };
            for b in nodes_of[i].iter().flat_map(|a| &beside[*a as usize]) {
                if std::mem::replace(&mut seen_node[*b as usize], i) != i {
                    let unknowns = map.row(*b as usize).0.iter();
                    (unknowns.filter_map(|&c| matter.unknown(c as usize))).for_each(&mut put);
                }
            }
            for &k in &gradients_of[i] {
                shared[k].0.iter().for_each(|(j, _)| put(*j));
            }
            columns[from..].sort_unstable();
            starts.push(columns.len());
        }
        Self {
            blocks: vec![Matrix3::zeros(); columns.len()],
            starts,
            columns,
        }
    }

    fn find(&self, i: usize, j: usize) -> usize {
        self.find_from(self.starts[i], i, j)
    }

    /// The place of a block at `from` or later in its row.
    fn find_from(&self, from: usize, i: usize, j: usize) -> usize {
        let row = &self.columns[from..self.starts[i + 1]];
        // Most often the next one.
        let at = match row.first() {
            Some(&first) if first as usize == j => 0,
            _ => row.partition_point(|column| (*column as usize) < j),
        };
        debug_assert!(row[at] as usize == j, "no place for a block");
        from + at
    }

    /// Wᵀ K W, scaled; K by pairs of nodes.
    fn add_pairs(
        &mut self,
        matter: &Matter,
        map: &SparseRows,
        pairs: &[(u32, u32, Matrix3)],
        scale: f64,
    ) {
        let unknowns = |node: u32, out: &mut Vec<(usize, f64)>| {
            let (coordinates, weights) = map.row(node as usize);
            let known = coordinates.iter().zip(weights);
            out.clear();
            out.extend(known.filter_map(|(&c, &w)| Some((matter.unknown(c as usize)?, w))));
            out.sort_by_key(|entry| entry.0);
        };
        let (mut left, mut right) = (Vec::new(), Vec::new());
        // Where the search in the row of each right unknown goes on.
        let mut next = Vec::new();
        for &(a, b, block) in pairs {
            unknowns(a, &mut left);
            unknowns(b, &mut right);
            next.clear();
            next.extend(right.iter().map(|(j, _)| self.starts[*j]));
            for &(i, u) in &left {
                let mut from = self.starts[i];
                for (&(j, w), next) in right.iter().zip(&mut next) {
                    let part = block * (u * w * scale);
                    if i >= j {
                        let at = self.find_from(from, i, j);
                        self.blocks[at] += part;
                        from = at + 1;
                    }
                    if a != b && j >= i {
                        let at = self.find_from(*next, j, i);
                        self.blocks[at] += part.transpose();
                        *next = at + 1;
                    }
                }
            }
        }
    }

    fn add_to(self, matrix: &mut BlockTriplets) {
        for (i, range) in self.starts.windows(2).enumerate() {
            for at in range[0]..range[1] {
                matrix.add(i, self.columns[at] as usize, self.blocks[at]);
            }
        }
    }
}
