//! A tree of boxes over triangles, built once: bodies are only translated.
//!
//! Split at the median of the centres along the longest axis, so the depth is the logarithm of the
//! count. Nodes lie in depth-first order: the left child follows its parent.
//!
//! The tree of parry3d has no search for the nearest pair of two trees under a translation, which is
//! what bodies are moved apart with.

use super::triangle::Triangle;
use palpate_geometry::math::Vector3;

/// Most triangles of a leaf.
const LEAF: usize = 1;
/// Room on the stack of a walk over two trees: more than twice the depth of a tree of 2³²
/// triangles.
const STACK: usize = 160;

/// An axis-aligned box, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Block {
    pub low: [f64; 3],
    pub high: [f64; 3],
}

impl Block {
    pub const EMPTY: Self = Self {
        low: [f64::INFINITY; 3],
        high: [f64::NEG_INFINITY; 3],
    };

    pub fn add(&mut self, p: &Vector3) {
        for k in 0..3 {
            self.low[k] = self.low[k].min(p[k]);
            self.high[k] = self.high[k].max(p[k]);
        }
    }

    pub fn diagonal(&self) -> f64 {
        (Vector3::from(self.high) - Vector3::from(self.low)).norm()
    }

    /// Whether this box moved by `by` comes within `margin` of the other along every axis.
    #[inline]
    pub fn meets(&self, by: &Vector3, other: &Self, margin: f64) -> bool {
        // No short cut: six comparisons without a branch are faster than a branch that is missed.
        let mut apart = false;
        for k in 0..3 {
            apart |= self.low[k] + by[k] > other.high[k] + margin;
            apart |= self.high[k] + by[k] < other.low[k] - margin;
        }
        !apart
    }

    /// Squared distance of this box moved by `by` from the other.
    fn distance_squared(&self, by: &Vector3, other: &Self) -> f64 {
        let mut sum = 0.0;
        for k in 0..3 {
            let gap = (self.low[k] + by[k] - other.high[k])
                .max(other.low[k] - self.high[k] - by[k])
                .max(0.0);
            sum += gap * gap;
        }
        sum
    }

    /// How far this box moved by `by` lies beyond the other along a unit vector; negative when it
    /// does not.
    fn distance_along(&self, axis: &Vector3, by: &Vector3, other: &Self) -> f64 {
        let mut sum = 0.0;
        for k in 0..3 {
            let near = if axis[k] > 0.0 {
                self.low[k] + by[k] - other.high[k]
            } else {
                self.high[k] + by[k] - other.low[k]
            };
            sum += axis[k] * near;
        }
        sum
    }

    fn longest(&self) -> f64 {
        (0..3)
            .map(|k| self.high[k] - self.low[k])
            .fold(0.0, f64::max)
    }
}

#[derive(Clone, Copy, Debug)]
struct Node {
    block: Block,
    /// A leaf: its first triangle. Otherwise: its right child; the left one is next.
    at: u32,
    /// Triangles of a leaf; 0 for the others.
    count: u32,
    /// Longest side of the block: of two nodes the longer one is opened.
    longest: f64,
}

/// Triangles in the order of the leaves, and the boxes over them.
#[derive(Clone, Debug)]
pub(super) struct Bvh {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
    /// (triangle count) corner numbers.
    corners: Vec<[u32; 3]>,
}

impl Bvh {
    /// Over at least one triangle.
    pub fn new(points: &[Vector3], triangles: &[[u32; 3]]) -> Self {
        debug_assert!(!triangles.is_empty(), "a tree needs a triangle");
        let all: Vec<Triangle> = triangles
            .iter()
            .map(|t| Triangle::new(t.map(|k| points[k as usize])))
            .collect();
        let mut order: Vec<u32> = (0..all.len() as u32).collect();
        let mut nodes = Vec::with_capacity(2 * all.len());
        split(&all, &mut order, 0, &mut nodes);
        Self {
            nodes,
            triangles: order.iter().map(|&k| all[k as usize]).collect(),
            corners: order.iter().map(|&k| triangles[k as usize]).collect(),
        }
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    pub fn triangle(&self, k: usize) -> &Triangle {
        &self.triangles[k]
    }

    pub fn corners(&self, k: usize) -> [u32; 3] {
        self.corners[k]
    }

    pub fn block(&self) -> &Block {
        &self.nodes[0].block
    }

    /// Calls `visit` for triangles of this tree moved by `by`, and of the other, whose boxes meet;
    /// ends when it says true.
    pub fn pairs(
        &self,
        by: &Vector3,
        other: &Self,
        margin: f64,
        mut visit: impl FnMut(usize, usize) -> bool,
    ) -> bool {
        let mut stack = [(0_u32, 0_u32); STACK];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let (i, j) = stack[depth];
            let (a, b) = (&self.nodes[i as usize], &other.nodes[j as usize]);
            if !a.block.meets(by, &b.block, margin) {
                continue;
            }
            if a.count > 0 && b.count > 0 {
                for x in a.at..a.at + a.count {
                    for y in b.at..b.at + b.count {
                        if visit(x as usize, y as usize) {
                            return true;
                        }
                    }
                }
                continue;
            }
            let open_first = b.count > 0 || (a.count == 0 && a.longest >= b.longest);
            let next = if open_first {
                [(i + 1, j), (a.at, j)]
            } else {
                [(i, j + 1), (i, b.at)]
            };
            stack[depth..depth + 2].copy_from_slice(&next);
            depth += 2;
        }
        false
    }

    /// Nearest points (on this tree moved by `by`, on the other) with their squared distance; or
    /// any that are within `enough` of each other, with which the search ends.
    ///
    /// Two bounds from below leave pairs of boxes out: their distance, and their distance along the
    /// line of the nearest points so far, which is nearly normal to both bodies where they are
    /// near.
    pub fn nearest(
        &self,
        by: &Vector3,
        other: &Self,
        enough: f64,
    ) -> Option<(f64, Vector3, Vector3)> {
        let mut best: Option<(f64, Vector3, Vector3)> = None;
        let (mut least, mut distance, mut axis) = (f64::INFINITY, f64::INFINITY, Vector3::zeros());
        let mut stack = [(0_u32, 0_u32, 0.0_f64); STACK];
        let mut depth = 1;
        while depth > 0 && distance > enough {
            depth -= 1;
            let (i, j, lower) = stack[depth];
            let (a, b) = (&self.nodes[i as usize], &other.nodes[j as usize]);
            if lower >= least || a.block.distance_along(&axis, by, &b.block) >= distance {
                continue;
            }
            if a.count > 0 && b.count > 0 {
                for x in a.at..a.at + a.count {
                    let moved = self.triangles[x as usize].moved(by);
                    for y in b.at..b.at + b.count {
                        let fixed = &other.triangles[y as usize];
                        if super::triangle::certainly_farther(&moved, fixed, least) {
                            continue;
                        }
                        let found = super::triangle::nearest(&moved, fixed);
                        if found.0 < least {
                            (least, distance, best) = (found.0, found.0.sqrt(), Some(found));
                            axis = (found.1 - found.2)
                                .try_normalize(0.0)
                                .unwrap_or_else(Vector3::zeros);
                        }
                    }
                }
                continue;
            }
            let open_first = b.count > 0 || (a.count == 0 && a.longest >= b.longest);
            let mut next = if open_first {
                [(i + 1, j), (a.at, j)]
            } else {
                [(i, j + 1), (i, b.at)]
            }
            .map(|(i, j)| {
                (
                    i,
                    j,
                    self.nodes[i as usize]
                        .block
                        .distance_squared(by, &other.nodes[j as usize].block),
                )
            });
            // The nearer one is looked at first: it lies on top.
            if next[0].2 < next[1].2 {
                next.swap(0, 1);
            }
            stack[depth..depth + 2].copy_from_slice(&next);
            depth += 2;
        }
        best
    }

    /// Calls `visit` for each triangle whose box is crossed by the ray from `from` along +z.
    pub fn above(&self, from: &Vector3, mut visit: impl FnMut(usize)) {
        let mut stack = [0_u32; STACK];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let i = stack[depth];
            let node = &self.nodes[i as usize];
            let Block { low, high } = &node.block;
            let beside = from.x < low[0]
                || from.x > high[0]
                || from.y < low[1]
                || from.y > high[1]
                || from.z > high[2];
            if beside {
                continue;
            }
            if node.count > 0 {
                (node.at..node.at + node.count).for_each(|k| visit(k as usize));
            } else {
                stack[depth..depth + 2].copy_from_slice(&[node.at, i + 1]);
                depth += 2;
            }
        }
    }
}

/// Makes the nodes over `order`, whose first entry is triangle number `start` of the leaves.
fn split(all: &[Triangle], order: &mut [u32], start: usize, nodes: &mut Vec<Node>) {
    let mut block = Block::EMPTY;
    let mut centres = Block::EMPTY;
    for &k in order.iter() {
        let triangle = &all[k as usize];
        triangle.corners.iter().for_each(|p| block.add(p));
        centres.add(&centre(triangle));
    }
    let node = nodes.len();
    nodes.push(Node {
        block,
        at: start as u32,
        count: order.len() as u32,
        longest: block.longest(),
    });
    if order.len() <= LEAF {
        return;
    }
    let axis = (0..3).fold(0, |best, k| {
        if centres.high[k] - centres.low[k] > centres.high[best] - centres.low[best] {
            k
        } else {
            best
        }
    });
    let middle = order.len() / 2;
    // Equal centres keep their order, so that the tree is the same everywhere.
    order.select_nth_unstable_by(middle, |&a, &b| {
        centre(&all[a as usize])[axis]
            .total_cmp(&centre(&all[b as usize])[axis])
            .then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(middle);
    split(all, left, start, nodes);
    nodes[node].at = nodes.len() as u32;
    nodes[node].count = 0;
    split(all, right, start + middle, nodes);
}

fn centre(t: &Triangle) -> Vector3 {
    t.corners[0] + t.corners[1] + t.corners[2]
}
