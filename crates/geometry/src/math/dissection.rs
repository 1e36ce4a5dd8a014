//! Nested dissection of a graph whose nodes have places (George 1973; Lipton, Rose & Tarjan 1979): the
//! factor of a lattice of n nodes has O(n^(4/3)) numbers, where minimum degree has more the larger the
//! lattice is.
//!
//! A part is cut across one of its axes: of the nodes within a band around its middle, the fewest that
//! separate the two sides are numbered last. They are a minimum vertex cut, found as a maximum flow in
//! which each node of the band passes one unit (Ford & Fulkerson 1956, by Dinic's method), so planes
//! need not follow the grid.

use super::{Point3, Vector3, symmetric_eigen};

/// Parts of no more nodes are left to minimum degree.
const LEAF: usize = 200;
/// Share of a part's nodes on each side that stay there, whatever the cut.
const CORE: f64 = 0.4;

/// The places of a graph's nodes in an order of elimination; `leaf` orders small parts, given the
/// nodes of each.
pub(super) fn order(
    adjacent: &[Vec<u32>],
    places: &[Point3],
    leaf: &mut dyn FnMut(&[u32]) -> Option<Vec<u32>>,
) -> Option<Vec<u32>> {
    let mut side = vec![NOWHERE; adjacent.len()];
    let mut order = Vec::with_capacity(adjacent.len());
    let all = (0..adjacent.len() as u32).collect();
    // Parts still to be ordered, and separators that come after theirs.
    let mut todo = vec![Work::Part(all)];
    while let Some(work) = todo.pop() {
        match work {
            Work::Cut(nodes) => order.extend(leaf(&nodes)?),
            Work::Part(nodes) if nodes.len() <= LEAF => order.extend(leaf(&nodes)?),
            Work::Part(nodes) => match cut(adjacent, places, &nodes, &mut side) {
                Some(Parts {
                    cut,
                    halves: [a, b],
                }) => {
                    todo.extend([Work::Cut(cut), Work::Part(b), Work::Part(a)]);
                }
                None => order.extend(leaf(&nodes)?),
            },
        }
    }
    Some(order)
}

enum Work {
    Part(Vec<u32>),
    Cut(Vec<u32>),
}

struct Parts {
    cut: Vec<u32>,
    halves: [Vec<u32>; 2],
}

/// Where a node is in the part that is being cut.
type Side = u32;
const NOWHERE: Side = u32::MAX;
const FIRST: Side = u32::MAX - 1;
const SECOND: Side = u32::MAX - 2;

/// The part cut across the axis with the fewest nodes in the cut; `None` where no cut leaves two halves
/// worth it.
fn cut(
    adjacent: &[Vec<u32>],
    places: &[Point3],
    nodes: &[u32],
    side: &mut [Side],
) -> Option<Parts> {
    let mut best: Option<Parts> = None;
    for axis in axes(places, nodes) {
        let parts = across(adjacent, places, nodes, &axis, side);
        for &node in nodes {
            side[node as usize] = NOWHERE;
        }
        if best
            .as_ref()
            .is_none_or(|best| parts.cut.len() < best.cut.len())
        {
            best = Some(parts);
        }
    }
    best.filter(|parts| {
        let least = parts.halves.iter().map(Vec::len).min().unwrap_or(0);
        parts.cut.len() < nodes.len() / 3 && least > nodes.len() / 8
    })
}

/// The principal axes of the nodes' places, and those of the places' own frame.
fn axes(places: &[Point3], nodes: &[u32]) -> Vec<Vector3> {
    let of = |&node: &u32| places[node as usize].coords;
    let centre = nodes.iter().map(of).sum::<Vector3>() / nodes.len() as f64;
    let mut moments = [0.0; 9];
    for r in nodes.iter().map(|node| of(node) - centre) {
        for (k, moment) in moments.iter_mut().enumerate() {
            *moment += r[k / 3] * r[k % 3];
        }
    }
    let (_, vectors) = symmetric_eigen(&moments, 3);
    let principal = (0..3).map(|k| Vector3::new(vectors[k], vectors[3 + k], vectors[6 + k]));
    principal
        .chain([Vector3::x(), Vector3::y(), Vector3::z()])
        .collect()
}

/// The part cut across an axis.
fn across(
    adjacent: &[Vec<u32>],
    places: &[Point3],
    nodes: &[u32],
    axis: &Vector3,
    side: &mut [Side],
) -> Parts {
    let along = |node: u32| places[node as usize].coords.dot(axis);
    let mut sorted = nodes.to_vec();
    sorted.sort_by(|&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
    let core = (CORE * nodes.len() as f64) as usize;
    let (first, rest) = sorted.split_at(core);
    let (middle, second) = rest.split_at(rest.len() - core);
    first.iter().for_each(|&k| side[k as usize] = FIRST);
    second.iter().for_each(|&k| side[k as usize] = SECOND);
    let mut band = middle.to_vec();
    // Edges that leap over the band: both ends go into it.
    let leaping = |from: &[u32], to: Side| -> Vec<u32> {
        let reaches = |&&node: &&u32| {
            let mut ends = adjacent[node as usize].iter();
            ends.any(|&other| side[other as usize] == to)
        };
        from.iter().filter(reaches).copied().collect()
    };
    band.extend([leaping(first, SECOND), leaping(second, FIRST)].concat());
    for (k, &node) in band.iter().enumerate() {
        side[node as usize] = k as u32;
    }
    let reached = Flow::new(adjacent, &band, side).cut();
    let mut parts = Parts {
        cut: Vec::new(),
        halves: [Vec::new(), Vec::new()],
    };
    for &node in nodes {
        match side[node as usize] {
            FIRST => parts.halves[0].push(node),
            SECOND => parts.halves[1].push(node),
            k => match reached[k as usize] {
                [true, true] => parts.halves[0].push(node),
                [true, false] => parts.cut.push(node),
                _ => parts.halves[1].push(node),
            },
        }
    }
    parts
}

/// Units from the first side through nodes of the band to the second.
struct Flow {
    /// Edges by the vertex that they leave: node k of the band is entered at 2 k and left at 2 k + 1.
    edges: Vec<Vec<Edge>>,
    source: usize,
    sink: usize,
}

struct Edge {
    to: u32,
    /// Place of the edge back among those of `to`.
    back: u32,
    room: u32,
}

impl Flow {
    fn new(adjacent: &[Vec<u32>], band: &[u32], side: &[Side]) -> Self {
        const MANY: u32 = u32::MAX / 2;
        let (source, sink) = (2 * band.len(), 2 * band.len() + 1);
        let mut flow = Self {
            edges: (0..sink + 1).map(|_| Vec::new()).collect(),
            source,
            sink,
        };
        for (k, &node) in band.iter().enumerate() {
            flow.add(2 * k, 2 * k + 1, 1);
            let (mut from_first, mut to_second) = (false, false);
            for &other in &adjacent[node as usize] {
                match side[other as usize] {
                    NOWHERE => {}
                    FIRST => from_first = true,
                    SECOND => to_second = true,
                    other => flow.add(2 * k + 1, 2 * other as usize, MANY),
                }
            }
            if from_first {
                flow.add(source, 2 * k, MANY);
            }
            if to_second {
                flow.add(2 * k + 1, sink, MANY);
            }
        }
        flow
    }

    fn add(&mut self, from: usize, to: usize, room: u32) {
        let (there, back) = (self.edges[from].len() as u32, self.edges[to].len() as u32);
        self.edges[from].push(Edge {
            to: to as u32,
            back,
            room,
        });
        self.edges[to].push(Edge {
            to: from as u32,
            back: there,
            room: 0,
        });
    }

    /// Of each node of the band: whether it can be entered and left from the first side once no more
    /// flows.
    fn cut(mut self) -> Vec<[bool; 2]> {
        let mut levels = vec![NOWHERE; self.edges.len()];
        loop {
            self.fill_levels(&mut levels);
            if levels[self.sink] == NOWHERE {
                break;
            }
            let mut next = vec![0; self.edges.len()];
            while self.push_one(&levels, &mut next) {}
        }
        let (reached, _) = levels[..self.source].as_chunks::<2>();
        reached
            .iter()
            .map(|pair| pair.map(|level| level != NOWHERE))
            .collect()
    }

    /// Fewest edges with room from the source to each vertex.
    fn fill_levels(&self, levels: &mut [u32]) {
        levels.fill(NOWHERE);
        levels[self.source] = 0;
        let mut front = vec![self.source as u32];
        let mut at = 0;
        while let Some(&from) = front.get(at) {
            at += 1;
            for edge in &self.edges[from as usize] {
                if edge.room > 0 && levels[edge.to as usize] == NOWHERE {
                    levels[edge.to as usize] = levels[from as usize] + 1;
                    front.push(edge.to);
                }
            }
        }
    }

    /// A unit along edges that lead one level on; `next`: the first edge of each vertex that may.
    fn push_one(&mut self, levels: &[u32], next: &mut [usize]) -> bool {
        let mut path: Vec<usize> = Vec::new();
        let mut from = self.source;
        while from != self.sink {
            let edges = &self.edges[from];
            let onwards = (next[from]..edges.len())
                .find(|&e| edges[e].room > 0 && levels[edges[e].to as usize] == levels[from] + 1);
            next[from] = onwards.unwrap_or(edges.len());
            match onwards {
                Some(e) => {
                    path.push(from);
                    from = edges[e].to as usize;
                }
                None => {
                    let Some(back) = path.pop() else {
                        return false;
                    };
                    next[back] += 1;
                    from = back;
                }
            }
        }
        for from in path {
            let edge = &mut self.edges[from][next[from]];
            edge.room -= 1;
            let (to, back) = (edge.to as usize, edge.back as usize);
            self.edges[to][back].room += 1;
        }
        true
    }
}
