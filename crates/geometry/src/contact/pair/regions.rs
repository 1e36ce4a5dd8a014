//! The parts of one surface below another: which vertices are inside, which belong together, and
//! where each is deepest.

use super::cells::{Cells, arc};
use super::depth::Below;
use super::facing::StationaryPair;
use super::tops::{Top, Upper};
use crate::contact::set::Reach;
use crate::math::Point3;

/// Depths within this of each other, relative to the size, are level: faces that lie on each other.
const LEVEL: f64 = 1e-10;

/// Most vertices of a manifold that one surface adds.
const MOST_SPREAD: usize = 8;
/// What is less deep than the deepest place by no more than this, relative to the size of the surface, is of one face.
const FACE: f64 = 1e-4;
/// Points of a manifold closer than this, relative to the size of the surface, are one.
const APART: f64 = 0.02;

/// Most places of greatest depth kept for one surface.
pub(super) const MOST_TOPS: usize = 64;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Unknown,
    /// Outside, farther than the margin.
    Out,
    /// Its depth is known.
    Sounded,
}

/// A region: its deepest place, or a place that nearly touches.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairRegion {
    pub top: Top,
    /// Node of its component.
    root: u32,
}

/// Where a climb starts.
#[derive(Clone, Copy)]
struct Start {
    /// Parameters on the upper surface.
    at: (f64, f64),
    /// Those of its foot on the one below.
    foot: (f64, f64),
    /// Of a vertex inside.
    vertex: Option<u32>,
}

/// Scratch for one surface.
#[derive(Clone, Debug)]
pub(super) struct Regions {
    state: Vec<State>,
    points: Vec<Point3>,
    depth: Vec<f64>,
    foot: Vec<(f64, f64)>,
    /// (vertices + tops): union–find.
    parent: Vec<u32>,
    /// (vertices + tops): a class of vertices has one outside the other surface's box; or a
    /// component's best depth.
    best: Vec<f64>,
    outer: Vec<bool>,
    shared: Vec<bool>,
    order: Vec<(f64, u32)>,
    /// Depths that differ by less are level, m.
    flat_m: f64,
    /// What rises by less than this across a cell is not climbed, m.
    pub level_m: f64,
    tops: Vec<Top>,
    pub found: Vec<PairRegion>,
    /// Vertices that span what touches beside the deepest places.
    pub spread: Vec<Top>,
    /// Rows and columns of cells in a region.
    taken: [Vec<bool>; 2],
    /// (cells): in a region; and those whose neighbours are still to be looked at.
    held: Vec<bool>,
    stack: Vec<u32>,
}

impl Regions {
    pub fn new(cells: &Cells) -> Self {
        let n = cells.vertex_count();
        Self {
            state: vec![State::Unknown; n],
            points: vec![Point3::origin(); n],
            depth: vec![f64::NEG_INFINITY; n],
            foot: vec![(0.0, 0.0); n],
            parent: vec![0; n + MOST_TOPS],
            best: vec![f64::NEG_INFINITY; n + MOST_TOPS],
            outer: vec![false; n],
            shared: vec![false; n],
            order: Vec::with_capacity(n),
            flat_m: 0.0,
            level_m: 0.0,
            tops: Vec::with_capacity(MOST_TOPS),
            found: Vec::with_capacity(MOST_TOPS),
            spread: Vec::with_capacity(MOST_SPREAD),
            taken: [vec![false; cells.counts[0]], vec![false; cells.counts[1]]],
            held: vec![false; cells.cell_count()],
            stack: Vec::with_capacity(cells.cell_count()),
        }
    }

    fn root(&mut self, node: u32) -> u32 {
        let mut x = node;
        while self.parent[x as usize] != x {
            self.parent[x as usize] = self.parent[self.parent[x as usize] as usize];
            x = self.parent[x as usize];
        }
        x
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller name stays, whatever the order of joining.
        if a < b {
            self.parent[b as usize] = a;
        } else {
            self.parent[a as usize] = b;
        }
    }

    fn inside(&self, vertex: u32) -> bool {
        self.state[vertex as usize] == State::Sounded && self.depth[vertex as usize] >= -self.flat_m
    }

    /// Finds all regions of `upper` below `below`, and near places up to `margin_m`. `pairs` start
    /// climbs: places of the upper surface and their feet.
    pub fn find(
        &mut self,
        upper: &mut Upper<'_>,
        cells: &mut Cells,
        below: &mut Below<'_>,
        pairs: impl Iterator<Item = StationaryPair>,
        margin_m: f64,
    ) {
        self.found.clear();
        self.tops.clear();
        self.flat_m = LEVEL * upper.size_m;
        self.classify(upper, cells, below, margin_m);
        self.connect(cells);
        for pair in pairs {
            let [u, v, s, t] = pair.at;
            // Too far to be reported, unless it leads to a deeper place.
            let (x, y) = (
                upper.solver.frame_at(upper.surface, u, v),
                below.solver.frame_at(below.surface, s, t),
            );
            let cell = cells.cell_at(u, v);
            cells.look(upper.surface, upper.solver.pieces_now(), cell);
            let way = x.point - y.point;
            let outward = y.du.cross(&y.dv)
                * if below.surface.flip_normal() {
                    -below.side
                } else {
                    below.side
                };
            if way.norm() > margin_m + 1e-11 * upper.size_m && way.dot(&outward) > 0.0 {
                continue;
            }
            let depth_m = -way.dot(&outward) / outward.norm();
            let corners = cells.corners(cell);
            let known = match pair.flat {
                // A corner is as deep, if it is over the other face; climbs from vertices go there.
                true => corners
                    .into_iter()
                    .any(|corner| self.depth[corner as usize] >= depth_m - self.flat_m),
                // Of a region whose depth is known, one place is as good as another.
                false => {
                    let root = self.root(corners[0]) as usize;
                    corners.iter().all(|&corner| self.inside(corner))
                        && self.best[root] >= depth_m - self.flat_m
                }
            };
            if known {
                continue;
            }
            let start = Start {
                at: (u, v),
                foot: (s, t),
                vertex: None,
            };
            self.climb(upper, cells, below, start, margin_m);
        }
        self.order.clear();
        for vertex in 0..cells.vertex_count() {
            if cells.alias[vertex] as usize != vertex || self.state[vertex] != State::Sounded {
                continue;
            }
            let d = self.depth[vertex];
            let summit = cells.around(vertex).iter().all(|&w| {
                let w = w as usize;
                w == vertex || d > self.depth[w] || (d == self.depth[w] && vertex < w)
            });
            if summit {
                self.order.push((d, vertex as u32));
            }
        }
        self.order
            .sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for k in 0..self.order.len() {
            let (d, vertex) = self.order[k];
            let (u, v) = cells.parameters(vertex as usize);
            let cell = cells.cell_at(u, v);
            cells.look(upper.surface, upper.solver.pieces_now(), cell);
            let across = 0.5 * cells.box_of(cell).diagonal();
            if d >= -self.flat_m {
                let root = self.root(vertex) as usize;
                // On a face in touch, one place is as good as another.
                let plateau = cells
                    .around(vertex as usize)
                    .iter()
                    .any(|&w| w != vertex && (self.depth[w as usize] - d).abs() <= self.flat_m);
                if self.best[root] > d + across || (plateau && self.best[root] >= d - self.flat_m) {
                    continue;
                }
            } else if d < -margin_m - across {
                continue;
            } else {
                // Of a level face, one place is as good as another.
                let root = self.root(vertex) as usize;
                if self.best[root] >= d - self.flat_m {
                    continue;
                }
                self.best[root] = d;
            }
            let start = Start {
                at: (u, v),
                foot: self.foot[vertex as usize],
                vertex: (d >= -self.flat_m).then_some(vertex),
            };
            self.climb(upper, cells, below, start, margin_m);
        }
        self.gather(cells);
    }

    /// Finds the region around the deepest of these places of `upper`, after a search that found none: it may lie
    /// between vertices.
    pub fn find_from(
        &mut self,
        upper: &mut Upper<'_>,
        cells: &mut Cells,
        below: &mut Below<'_>,
        starts: &[(f64, f64)],
        margin_m: f64,
    ) {
        let mut deepest = None;
        let mut most_m = f64::NEG_INFINITY;
        for &(u, v) in starts {
            let point = upper.solver.frame_at(upper.surface, u, v).point;
            let (depth_m, foot) = below.rough(&point);
            if depth_m >= most_m {
                (deepest, most_m) = (Some(((u, v), foot)), depth_m);
            }
        }
        let Some(((u, v), foot)) = deepest else {
            return;
        };
        let cell = cells.cell_at(u, v);
        cells.look(upper.surface, upper.solver.pieces_now(), cell);
        let start = Start {
            at: (u, v),
            foot,
            vertex: None,
        };
        self.climb(upper, cells, below, start, margin_m);
        self.found.clear();
        self.gather(cells);
    }

    /// Which vertices are outside, and the depth of the others.
    fn classify(
        &mut self,
        upper: &mut Upper<'_>,
        cells: &Cells,
        below: &mut Below<'_>,
        margin_m: f64,
    ) {
        let n = cells.vertex_count();
        for k in 0..n + MOST_TOPS {
            self.parent[k] = k as u32;
            self.best[k] = f64::NEG_INFINITY;
        }
        self.state.fill(State::Unknown);
        self.depth.fill(f64::NEG_INFINITY);
        self.outer.fill(false);
        self.shared.fill(false);
        let solid = below.cells.closed;
        if solid {
            // A cell that the other surface does not touch is on one side of it.
            for cell in 0..cells.cell_count() {
                if !cells.touched[cell] {
                    let corners = cells.corners(cell);
                    for &corner in &corners {
                        self.join(corners[0], corner);
                        self.shared[corner as usize] = true;
                    }
                }
            }
        }
        for vertex in 0..n {
            if cells.alias[vertex] as usize != vertex {
                continue;
            }
            let (u, v) = cells.parameters(vertex);
            self.points[vertex] = upper.solver.frame_at(upper.surface, u, v).point;
            if solid && !below.cells.whole.holds(&self.points[vertex], margin_m) {
                let root = self.root(vertex as u32) as usize;
                self.outer[root] = true;
                self.state[vertex] = State::Out;
            }
        }
        for vertex in 0..n {
            if cells.alias[vertex] as usize != vertex || self.state[vertex] != State::Unknown {
                continue;
            }
            let root = self.root(vertex as u32) as usize;
            if self.outer[root] && self.shared[vertex] {
                self.state[vertex] = State::Out;
                continue;
            }
            let point = self.points[vertex];
            // One certified sign for each class that nothing touches.
            let certify = self.shared[vertex] && self.best[root] == f64::NEG_INFINITY;
            let (depth, foot) = if certify {
                let sure = below.certain(&point);
                (sure.depth_m, (sure.foot.at.u, sure.foot.at.v))
            } else {
                below.rough(&point)
            };
            if certify {
                self.best[root] = 0.0;
                if depth < 0.0 {
                    self.outer[root] = true;
                    self.state[vertex] = State::Out;
                    continue;
                }
            }
            self.state[vertex] = State::Sounded;
            self.depth[vertex] = depth;
            self.foot[vertex] = foot;
        }
        self.best.fill(f64::NEG_INFINITY);
        // Classes of vertices outside are not components.
        if solid {
            for vertex in 0..n {
                if self.state[vertex] == State::Out {
                    self.parent[vertex] = vertex as u32;
                }
            }
        }
    }

    /// Joins neighbouring vertices inside, and those outside that are level.
    fn connect(&mut self, cells: &Cells) {
        for cell in 0..cells.cell_count() {
            let c = cells.corners(cell);
            for k in 0..4 {
                let (a, b) = (c[k], c[(k + 1) % 4]);
                let level = || {
                    let [a, b] = [a, b].map(|vertex| self.depth[vertex as usize]);
                    (a - b).abs() <= self.flat_m
                };
                if self.inside(a) && self.inside(b) || level() {
                    self.join(a, b);
                }
            }
        }
    }

    /// Climbs from a place; what is found becomes a top, joined with the vertex it was climbed from, or those around it.
    fn climb(
        &mut self,
        upper: &mut Upper<'_>,
        cells: &Cells,
        below: &mut Below<'_>,
        start: Start,
        margin_m: f64,
    ) {
        let Start { at, foot, vertex } = start;
        let across = cells.box_of(cells.cell_at(at.0, at.1)).diagonal();
        let reach_m = if across.is_finite() {
            0.5 * across
        } else {
            0.05 * upper.size_m
        };
        let level = (self.level_m > 0.0)
            .then(|| {
                let part_m = reach_m.min(0.1 * below.cells.whole.diagonal());
                upper.level(below, at, foot, part_m, self.level_m)
            })
            .flatten();
        let top = level.or_else(|| upper.climb(cells, below, at.0, at.1, foot, reach_m));
        let Some(top) = top else { return };
        let depth = top.sounding.depth_m;
        let near = depth >= -margin_m - 1e-12 * upper.size_m;
        if !near || (depth < -self.flat_m && !top.summit) {
            return;
        }
        let same = |other: &Top| {
            (other.point - top.point).norm() <= 1e-5 * upper.size_m
                && (other.sounding.depth_m - depth).abs() <= 1e-9 * upper.size_m
        };
        let slot = match self.tops.iter().position(same) {
            Some(slot) => slot,
            None if self.tops.len() < MOST_TOPS => {
                self.tops.push(top);
                self.tops.len() - 1
            }
            None => return,
        };
        if depth < -self.flat_m {
            return;
        }
        let node = (cells.vertex_count() + slot) as u32;
        if let Some(vertex) = vertex {
            self.join(node, vertex);
        } else {
            let cell = cells.cell_at(top.u, top.v);
            let ((i, j), corners) = (
                (cell / cells.counts[1], cell % cells.counts[1]),
                cells.corners(cell),
            );
            for (k, corner) in corners.into_iter().enumerate() {
                if self.inside(corner) && self.root(corner) != self.root(node) {
                    let (a, b) = ([0, 0, 1, 1][k], [0, 1, 1, 0][k]);
                    let end = (cells.lines[0][i + a], cells.lines[1][j + b]);
                    if self.passage(
                        upper,
                        below,
                        (top.u, top.v),
                        depth,
                        end,
                        self.depth[corner as usize],
                    ) {
                        self.join(node, corner);
                    }
                }
            }
        }
        let root = self.root(node) as usize;
        self.best[root] = self.best[root].max(depth);
    }

    /// The straight way between two parameter pairs inside stays inside.
    fn passage(
        &self,
        upper: &mut Upper<'_>,
        below: &mut Below<'_>,
        a: (f64, f64),
        depth_a: f64,
        b: (f64, f64),
        depth_b: f64,
    ) -> bool {
        const STEPS: usize = 8;
        let at = |k: usize| {
            let x = k as f64 / STEPS as f64;
            (a.0 + x * (b.0 - a.0), a.1 + x * (b.1 - a.1))
        };
        let start = upper.solver.frame_at(upper.surface, a.0, a.1).point;
        let end = upper.solver.frame_at(upper.surface, b.0, b.1).point;
        // Depth changes by at most a metre a metre; ways are a little longer than their chords.
        if depth_a + depth_b > 1.3 * (end - start).norm() {
            return true;
        }
        (1..STEPS).all(|k| {
            let (u, v) = at(k);
            let point = upper.solver.frame_at(upper.surface, u, v).point;
            below.rough(&point).0 >= -self.flat_m
        })
    }

    /// The deepest top of each component, and every near place.
    fn gather(&mut self, cells: &Cells) {
        let n = cells.vertex_count();
        for k in 0..self.tops.len() {
            let top = self.tops[k];
            let node = (n + k) as u32;
            if top.sounding.depth_m < -self.flat_m {
                self.found.push(PairRegion { top, root: node });
                continue;
            }
            let root = self.root(node);
            match self.found.iter_mut().find(|r| r.root == root) {
                Some(region) if region.top.sounding.depth_m < top.sounding.depth_m => {
                    region.top = top
                }
                Some(_) => {}
                None => self.found.push(PairRegion { top, root }),
            }
        }
    }

    /// Finds vertices within the margin that span what touches: each as far as can be from `others` and those before it.
    pub fn spread(
        &mut self,
        cells: &Cells,
        below: &mut Below<'_>,
        reach: Reach,
        others: impl Iterator<Item = Point3>,
    ) {
        self.spread.clear();
        let depths = (self.found.iter()).map(|region| region.top.sounding.depth_m);
        let Some(deepest_m) = depths.max_by(f64::total_cmp) else {
            return;
        };
        let face_m = reach.closing_m.max(FACE * cells.whole.diagonal());
        let least_m = (-reach.margin_m).max(deepest_m - face_m);
        let apart_m = APART * cells.whole.diagonal();
        // (vertices): how far from the nearest that is there already, squared.
        self.best.fill(f64::INFINITY);
        let points = &self.points;
        let add = |best: &mut [f64], point: &Point3| {
            for (away, vertex) in best.iter_mut().zip(points) {
                *away = away.min((vertex - point).norm_squared());
            }
        };
        for point in others {
            add(&mut self.best, &point);
        }
        let tops = self.found.iter().map(|region| region.top.point);
        for point in tops {
            add(&mut self.best, &point);
        }
        while self.spread.len() < MOST_SPREAD {
            let near = (0..cells.vertex_count()).filter(|&vertex| {
                cells.alias[vertex] as usize == vertex
                    && self.state[vertex] == State::Sounded
                    && self.depth[vertex] >= least_m
            });
            let farthest =
                near.max_by(|&a, &b| self.best[a].total_cmp(&self.best[b]).then(b.cmp(&a)));
            let Some(vertex) = farthest.filter(|&vertex| self.best[vertex] > apart_m * apart_m)
            else {
                return;
            };
            let (point, foot) = (self.points[vertex], self.foot[vertex]);
            add(&mut self.best, &point);
            let sounding = below.follow(&point, foot.0, foot.1);
            if sounding.depth_m < least_m {
                continue;
            }
            let (u, v) = cells.parameters(vertex);
            self.spread.push(Top {
                u,
                v,
                point,
                sounding,
                summit: false,
            });
        }
    }

    /// Rows and columns of cells that may hold a part of a region, as index ranges; `high` may pass
    /// the count where ends meet. A region goes from cell to cell through vertices inside, or where
    /// the other surface touches both.
    pub fn extent(&mut self, cells: &Cells, region: usize) -> [[usize; 2]; 2] {
        let PairRegion { top, root } = self.found[region];
        self.held.fill(false);
        self.stack.clear();
        self.hold(cells.cell_at(top.u, top.v));
        if top.sounding.depth_m >= -self.flat_m {
            for cell in 0..cells.cell_count() {
                let corners = cells.corners(cell);
                if corners
                    .iter()
                    .any(|&c| self.inside(c) && self.root(c) == root)
                {
                    self.hold(cell);
                }
            }
            while let Some(cell) = self.stack.pop() {
                for beside in cells.beside(cell as usize).into_iter().flatten() {
                    if cells.touched[cell as usize] && cells.touched[beside] {
                        self.hold(beside);
                    }
                }
            }
        }
        self.taken[0].fill(false);
        self.taken[1].fill(false);
        for cell in 0..cells.cell_count() {
            if self.held[cell] {
                self.taken[0][cell / cells.counts[1]] = true;
                self.taken[1][cell % cells.counts[1]] = true;
            }
        }
        [0, 1].map(|d| arc(&self.taken[d], cells.wraps[d]))
    }

    fn hold(&mut self, cell: usize) {
        if !self.held[cell] {
            self.held[cell] = true;
            self.stack.push(cell as u32);
        }
    }
}
