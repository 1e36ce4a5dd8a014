//! Finding the patches of a net, and which of their edges are equal.

use super::{Edge, Joined, Joints, Patch, SAME_KNOT, Strip};
use crate::basis::KnotVector;
use crate::math::Point3;
use crate::surface::{SAME_POINT, Surface};

/// Most patches of a surface that is looked at: every edge is compared with every other.
const MOST_PATCHES: usize = 1024;

impl Joints {
    pub(super) fn new(surface: &Surface) -> Option<Self> {
        let strips = [strips(surface.knots_u()), strips(surface.knots_v())];
        if strips[0].len() * strips[1].len() > MOST_PATCHES {
            return None;
        }
        let net = Net {
            surface,
            strips: &strips,
            tolerance: SAME_POINT * surface.size(),
        };
        let count = strips[0].len() * strips[1].len();
        let across = strips[1].len();
        let mut patches = Vec::with_capacity(count);
        let mut first = Sets::new(surface.net().points().len());
        for patch in 0..count {
            let duplicate_of = (0..patch).find(|&other| net.same_patch(patch, other));
            if let Some(other) = duplicate_of {
                net.controls(patch)
                    .into_iter()
                    .zip(net.controls(other))
                    .for_each(|(a, b)| first.join(a, b));
            }
            let (u, v) = (
                strips[0][patch / across].range,
                strips[1][patch % across].range,
            );
            patches.push(Patch { u, v, duplicate_of });
        }
        let edges: Vec<Vec<usize>> = (0..4 * count)
            .map(|e| {
                net.edge(Edge {
                    patch: e / 4,
                    side: e % 4,
                })
            })
            .collect();
        let poles: Vec<bool> = edges.iter().map(|points| net.one_point(points)).collect();
        for (edge, _) in edges.iter().zip(&poles).filter(|(_, pole)| **pole) {
            edge.iter().for_each(|&k| first.join(edge[0], k));
        }
        let mut joined: Vec<Vec<Joined>> = vec![Vec::new(); edges.len()];
        for a in (0..edges.len()).filter(|&a| !poles[a]) {
            for b in (a + 1..edges.len()).filter(|&b| !poles[b]) {
                let ways = [
                    Edge {
                        patch: a / 4,
                        side: a % 4,
                    },
                    Edge {
                        patch: b / 4,
                        side: b % 4,
                    },
                ];
                for against in [false, true] {
                    if !net.same_edge(ways, [&edges[a], &edges[b]], against) {
                        continue;
                    }
                    for (k, &one) in edges[a].iter().enumerate() {
                        let other = if against { edges[b].len() - 1 - k } else { k };
                        first.join(one, edges[b][other]);
                    }
                    let hidden = |e: Edge| patches[e.patch].duplicate_of.is_some();
                    if !hidden(ways[1]) {
                        joined[a].push(Joined {
                            edge: ways[1],
                            against,
                        });
                    }
                    if !hidden(ways[0]) {
                        joined[b].push(Joined {
                            edge: ways[0],
                            against,
                        });
                    }
                    break;
                }
            }
        }
        let spans = [0, 1].map(|d| strips[d].last().map_or(0, |s| s.spans.end));
        let mut hidden = vec![false; spans[0] * spans[1]];
        for (k, patch) in patches
            .iter()
            .enumerate()
            .filter(|(_, patch)| patch.duplicate_of.is_some())
        {
            debug_assert!(patch.duplicate_of < Some(k), "of an earlier one");
            for i in strips[0][k / across].spans.clone() {
                strips[1][k % across]
                    .spans
                    .clone()
                    .for_each(|j| hidden[i * spans[1] + j] = true);
            }
        }
        let first = (0..surface.net().points().len())
            .map(|k| first.root(k))
            .collect();
        let net_columns = surface.net().columns();
        Some(Self {
            patches,
            strips,
            joined,
            poles,
            first,
            hidden,
            columns: spans[1],
            net_columns,
        })
    }
}

fn strips(knots: &KnotVector) -> Vec<Strip> {
    let (t, p) = (knots.knots(), knots.degree());
    let (start, end) = knots.domain();
    let spans: Vec<usize> = knots.spans().collect();
    let mut breaks = vec![start];
    breaks.extend(
        spans
            .iter()
            .map(|&i| t[i])
            .filter(|&x| x > start && knots.multiplicity(x) >= p),
    );
    breaks.push(end);
    breaks
        .windows(2)
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            let first = t.partition_point(|&x| x <= a) - 1;
            let last = t.partition_point(|&x| x < b);
            Strip {
                range: [a, b],
                spans: spans.partition_point(|&i| t[i] < a)..spans.partition_point(|&i| t[i] < b),
                controls: [first - p, last - 1],
                inner: t[first + 1..last]
                    .iter()
                    .map(|x| (x - a) / (b - a))
                    .collect(),
            }
        })
        .collect()
}

/// A surface and its strips, to compare parts of its net.
struct Net<'a> {
    surface: &'a Surface,
    strips: &'a [Vec<Strip>; 2],
    tolerance: f64,
}

impl Net<'_> {
    fn strips_of(&self, patch: usize) -> [&Strip; 2] {
        let across = self.strips[1].len();
        [
            &self.strips[0][patch / across],
            &self.strips[1][patch % across],
        ]
    }

    /// Control points of a patch, u-major.
    fn controls(&self, patch: usize) -> Vec<usize> {
        let ([u0, u1], [v0, v1]) = (
            self.strips_of(patch)[0].controls,
            self.strips_of(patch)[1].controls,
        );
        let columns = self.surface.net().columns();
        (u0..=u1)
            .flat_map(|i| (v0..=v1).map(move |j| i * columns + j))
            .collect()
    }

    /// Control points of an edge.
    fn edge(&self, edge: Edge) -> Vec<usize> {
        let strips = self.strips_of(edge.patch);
        let columns = self.surface.net().columns();
        let ([u0, u1], [v0, v1]) = (strips[0].controls, strips[1].controls);
        match edge.side {
            0 => (v0..=v1).map(|j| u0 * columns + j).collect(),
            1 => (v0..=v1).map(|j| u1 * columns + j).collect(),
            2 => (u0..=u1).map(|i| i * columns + v0).collect(),
            _ => (u0..=u1).map(|i| i * columns + v1).collect(),
        }
    }

    fn point(&self, k: usize) -> &Point3 {
        &self.surface.net().points()[k]
    }

    fn near(&self, a: usize, b: usize) -> bool {
        (self.point(a) - self.point(b)).norm() <= self.tolerance
    }

    fn one_point(&self, edge: &[usize]) -> bool {
        edge.iter().all(|&k| self.near(k, edge[0]))
    }

    /// Weights in one ratio.
    fn alike(&self, pairs: impl Iterator<Item = (usize, usize)>) -> bool {
        let Some(weights) = self.surface.weights() else {
            return true;
        };
        let mut ratio = None;
        pairs.into_iter().all(|(a, b)| {
            let here = weights[a] / weights[b];
            let ratio = *ratio.get_or_insert(here);
            (here - ratio).abs() <= SAME_POINT * ratio
        })
    }

    fn same_patch(&self, a: usize, b: usize) -> bool {
        let (x, y) = (self.strips_of(a), self.strips_of(b));
        if !(0..2).all(|d| same_knots(x[d], y[d], false)) {
            return false;
        }
        let (x, y) = (self.controls(a), self.controls(b));
        x.iter().zip(&y).all(|(&a, &b)| self.near(a, b)) && self.alike(x.into_iter().zip(y))
    }

    fn same_edge(&self, [a, b]: [Edge; 2], [x, y]: [&Vec<usize>; 2], against: bool) -> bool {
        let along = |edge: Edge| 1 - edge.side / 2;
        let degree = |d: usize| {
            if d == 0 {
                self.surface.knots_u().degree()
            } else {
                self.surface.knots_v().degree()
            }
        };
        let n = y.len();
        let turned = |k: usize| y[if against { n - 1 - k } else { k }];
        x.len() == n
            && self.near(x[0], turned(0))
            && degree(along(a)) == degree(along(b))
            && (0..n).all(|k| self.near(x[k], turned(k)))
            && same_knots(
                self.strips_of(a.patch)[along(a)],
                self.strips_of(b.patch)[along(b)],
                against,
            )
            && self.alike(x.iter().copied().zip((0..n).map(turned)))
    }
}

fn same_knots(a: &Strip, b: &Strip, against: bool) -> bool {
    let n = b.inner.len();
    let turned = |k: usize| {
        if against {
            1.0 - b.inner[n - 1 - k]
        } else {
            b.inner[k]
        }
    };
    a.inner.len() == n && (0..n).all(|k| (a.inner[k] - turned(k)).abs() <= SAME_KNOT)
}

/// Points joined into sets; the least index of a set is its root.
pub(crate) struct Sets {
    to: Vec<usize>,
}

impl Sets {
    pub fn new(count: usize) -> Self {
        Self {
            to: (0..count).collect(),
        }
    }

    pub fn root(&self, mut k: usize) -> usize {
        while self.to[k] != k {
            k = self.to[k];
        }
        k
    }

    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.to[a.max(b)] = a.min(b);
    }
}
