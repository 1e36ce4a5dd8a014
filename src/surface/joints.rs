//! Branching surfaces: which parts of one net are the same place, and which edges are joined.
//!
//! A branching surface is one tensor product whose knots part it: multiplicity = degree creases it, degree + 1 disjoins it.
//! Between such knots lie *patches*, which only touch where their edges are equal. Two edges are joined where they are equal
//! as curves (control points, weights and relative knots, along each other or against), so two walls of a squeezed tube that
//! touch in one control point stay apart. A patch that equals an earlier one as a whole is a *duplicate*: the stem of a
//! branching tube is drawn once for each leaf. Found from the net itself, in order of the patches; nothing is hashed.
//!
//! Only surfaces with a disjoined knot, clamped in both directions, are looked at; others cost nothing.

use super::{SAME_POINT, Surface};
use crate::basis::{KnotKind, KnotVector};
use crate::math::Point3;
use std::ops::Range;

/// Most places that meet in a point and are looked at.
const MOST_MEETING: usize = 16;

/// A part of a surface between creases, disjoined knots and ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Parameters in u, from and to.
    pub u: [f64; 2],
    /// Parameters in v, from and to.
    pub v: [f64; 2],
    /// The earlier patch that this one draws again.
    pub duplicate_of: Option<usize>,
}

/// A direction between two such knots.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Strip {
    /// Parameters.
    pub range: [f64; 2],
    /// Among the spans of positive length.
    pub spans: Range<usize>,
    /// Control points, both ends included.
    pub controls: [usize; 2],
    /// Knots inside, from 0 to 1.
    inner: Vec<f64>,
}

/// An edge of a patch: `2 d` where parameter d (0: u, 1: v) is at its start, `2 d + 1` where it is at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Edge {
    pub patch: usize,
    pub side: usize,
}

/// Another edge at the same place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Joined {
    edge: Edge,
    /// Its parameter runs the other way.
    against: bool,
}

/// A place: spans of positive length, and parameters in them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spot {
    pub i: usize,
    pub j: usize,
    pub u: f64,
    pub v: f64,
}

/// The patches of a branching surface and how they are joined.
#[derive(Clone, Debug, PartialEq)]
pub struct Joints {
    patches: Vec<Patch>,
    strips: [Vec<Strip>; 2],
    /// (patches × 4): edges of patches that are no duplicates.
    joined: Vec<Vec<Joined>>,
    /// (patches × 4): the edge is one point.
    poles: Vec<bool>,
    /// (control points): the first control point at the same place.
    first: Vec<usize>,
    /// (spans in u × spans in v): duplicates.
    hidden: Vec<bool>,
    columns: usize,
    net_columns: usize,
}

impl Surface {
    /// The patches of a branching surface; `None` for one without a disjoined knot, or with a direction that is not clamped.
    pub fn joints(&self) -> Option<Joints> {
        let both = [self.knots_u(), self.knots_v()];
        let branches = both.iter().any(|knots| !knots.disjoined().is_empty());
        let clamped = both.iter().all(|knots| knots.kind() == KnotKind::Clamped);
        (branches && clamped).then(|| Joints::new(self))
    }
}

impl Joints {
    fn new(surface: &Surface) -> Self {
        let strips = [strips(surface.knots_u()), strips(surface.knots_v())];
        let net = Net { surface, strips: &strips, tolerance: SAME_POINT * surface.size() };
        let count = strips[0].len() * strips[1].len();
        let across = strips[1].len();
        let mut patches = Vec::with_capacity(count);
        let mut first = Sets::new(surface.net().points().len());
        for patch in 0..count {
            let duplicate_of = (0..patch).find(|&other| net.same_patch(patch, other));
            if let Some(other) = duplicate_of {
                net.controls(patch).into_iter().zip(net.controls(other)).for_each(|(a, b)| first.join(a, b));
            }
            let (u, v) = (strips[0][patch / across].range, strips[1][patch % across].range);
            patches.push(Patch { u, v, duplicate_of });
        }
        let edges: Vec<Vec<usize>> = (0..4 * count).map(|e| net.edge(Edge { patch: e / 4, side: e % 4 })).collect();
        let poles: Vec<bool> = edges.iter().map(|points| net.one_point(points)).collect();
        for (edge, _) in edges.iter().zip(&poles).filter(|(_, pole)| **pole) {
            edge.iter().for_each(|&k| first.join(edge[0], k));
        }
        let mut joined: Vec<Vec<Joined>> = vec![Vec::new(); edges.len()];
        for a in (0..edges.len()).filter(|&a| !poles[a]) {
            for b in (a + 1..edges.len()).filter(|&b| !poles[b]) {
                let ways = [Edge { patch: a / 4, side: a % 4 }, Edge { patch: b / 4, side: b % 4 }];
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
                        joined[a].push(Joined { edge: ways[1], against });
                    }
                    if !hidden(ways[0]) {
                        joined[b].push(Joined { edge: ways[0], against });
                    }
                    break;
                }
            }
        }
        let spans = [0, 1].map(|d| strips[d].last().map_or(0, |s| s.spans.end));
        let mut hidden = vec![false; spans[0] * spans[1]];
        for (k, patch) in patches.iter().enumerate().filter(|(_, patch)| patch.duplicate_of.is_some()) {
            debug_assert!(patch.duplicate_of < Some(k), "of an earlier one");
            for i in strips[0][k / across].spans.clone() {
                strips[1][k % across].spans.clone().for_each(|j| hidden[i * spans[1] + j] = true);
            }
        }
        let first = (0..surface.net().points().len()).map(|k| first.root(k)).collect();
        let net_columns = surface.net().columns();
        Self { patches, strips, joined, poles, first, hidden, columns: spans[1], net_columns }
    }

    /// All patches, u-major.
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// (control points, u-major): the first one that is the same point.
    pub fn first_at_place(&self) -> &[usize] {
        &self.first
    }

    /// The Bézier piece of these spans of positive length is drawn elsewhere.
    pub fn is_duplicate(&self, span_u: usize, span_v: usize) -> bool {
        self.hidden[span_u * self.columns + span_v]
    }

    /// A place is on a patch that is drawn elsewhere.
    pub fn is_duplicate_at(&self, u: f64, v: f64) -> bool {
        let strip = |d: usize, x: f64| self.strips[d].partition_point(|s| s.range[0] <= x).max(1) - 1;
        self.patches[strip(0, u) * self.strips[1].len() + strip(1, v)].duplicate_of.is_some()
    }

    /// (spans in u × spans in v).
    pub(crate) fn hidden(&self) -> &[bool] {
        &self.hidden
    }

    /// The piece that a duplicate draws again; itself for one that is none.
    pub(crate) fn original(&self, piece: usize) -> usize {
        let at = [piece / self.columns, piece % self.columns];
        let Some(patch) = self.patch_of(at) else { return piece };
        let Some(other) = self.patches[patch].duplicate_of else { return piece };
        let from = |d: usize, patch: usize| {
            let k = if d == 0 { patch / self.strips[1].len() } else { patch % self.strips[1].len() };
            self.strips[d][k].spans.start
        };
        let [i, j] = [0, 1].map(|d| at[d] - from(d, patch) + from(d, other));
        i * self.columns + j
    }

    /// Pairs of edges of patches that are joined, each once; `against`: one runs the other way. Duplicates are left out.
    pub(crate) fn seams(&self) -> impl Iterator<Item = (Edge, Edge, bool)> + '_ {
        self.joined.iter().enumerate().flat_map(move |(k, list)| {
            let edge = Edge { patch: k / 4, side: k % 4 };
            let shown = self.patches[edge.patch].duplicate_of.is_none();
            let later = list.iter().filter(move |j| shown && (j.edge.patch, j.edge.side) > (edge.patch, edge.side));
            later.map(move |j| (edge, j.edge, j.against))
        })
    }

    /// Every edge along a knot inside the domain is joined to another, or is one point.
    pub fn is_whole(&self) -> bool {
        (0..self.joined.len()).all(|e| {
            let (patch, side) = (e / 4, e % 4);
            let d = side / 2;
            let k = if d == 0 { patch / self.strips[1].len() } else { patch % self.strips[1].len() };
            let at_end = if side % 2 == 0 { k == 0 } else { k + 1 == self.strips[d].len() };
            at_end || self.poles[e] || !self.joined[e].is_empty()
        })
    }

    /// First and last control point of a patch, in u and in v.
    pub fn controls_of(&self, patch: usize) -> [[usize; 2]; 2] {
        self.strips_of(patch).map(|strip| strip.controls)
    }

    /// Rows of three control points (u-major indices) that cross the joined edges at right angles.
    pub fn rows_across(&self) -> Vec<[usize; 3]> {
        let mut rows = Vec::new();
        for (a, b, against) in self.seams() {
            let (inner, outer) = (self.lines_at(a), self.lines_at(b));
            let n = outer.len();
            for (k, [middle, before]) in inner.into_iter().enumerate() {
                let [_, after] = outer[if against { n - 1 - k } else { k }];
                rows.push([before, middle, after]);
            }
        }
        rows
    }

    /// Control points of an edge, each with the one next to it inside the patch.
    fn lines_at(&self, edge: Edge) -> Vec<[usize; 2]> {
        let [[u0, u1], [v0, v1]] = self.controls_of(edge.patch);
        let at = |i: usize, j: usize| i * self.net_columns + j;
        match edge.side {
            0 => (v0..=v1).map(|j| [at(u0, j), at(u0 + 1, j)]).collect(),
            1 => (v0..=v1).map(|j| [at(u1, j), at(u1 - 1, j)]).collect(),
            2 => (u0..=u1).map(|i| [at(i, v0), at(i, v0 + 1)]).collect(),
            _ => (u0..=u1).map(|i| [at(i, v1), at(i, v1 - 1)]).collect(),
        }
    }

    /// Strips of a patch, u and v.
    pub(crate) fn strips_of(&self, patch: usize) -> [&Strip; 2] {
        let across = self.strips[1].len();
        [&self.strips[0][patch / across], &self.strips[1][patch % across]]
    }

    /// Parameters, one in each direction, that a cut of a patch at `x` brings about elsewhere, itself included: joined edges
    /// and duplicates are cut alike.
    pub(crate) fn cuts(&self, direction: usize, x: f64) -> Vec<(usize, f64)> {
        let place = |d: usize, x: f64| {
            let k = self.strips[d].iter().position(|s| x > s.range[0] && x < s.range[1])?;
            let [a, b] = self.strips[d][k].range;
            Some((k, (x - a) / (b - a)))
        };
        let Some((k, share)) = place(direction, x) else { return vec![(direction, x)] };
        // (direction, strip, share of it).
        let mut all = vec![(direction, k, share)];
        let mut next = 0;
        while next < all.len() {
            let (d, k, share) = all[next];
            next += 1;
            let mut add = |d: usize, k: usize, share: f64| {
                let known =
                    |&(e, l, other): &(usize, usize, f64)| e == d && l == k && (other - share).abs() < SAME_KNOT;
                if !all.iter().any(known) {
                    all.push((d, k, share));
                }
            };
            let strip_of = |patch: usize, d: usize| {
                if d == 0 { patch / self.strips[1].len() } else { patch % self.strips[1].len() }
            };
            for (patch, Patch { duplicate_of, .. }) in self.patches.iter().enumerate() {
                let Some(other) = *duplicate_of else { continue };
                if strip_of(patch, d) == k {
                    add(d, strip_of(other, d), share);
                }
                if strip_of(other, d) == k {
                    add(d, strip_of(patch, d), share);
                }
            }
            for (a, b, against) in self.seams() {
                // An edge along which u is constant runs in v.
                let (along_a, along_b) = (1 - a.side / 2, 1 - b.side / 2);
                let turned = if against { 1.0 - share } else { share };
                if along_a == d && strip_of(a.patch, d) == k {
                    add(along_b, strip_of(b.patch, along_b), turned);
                }
                if along_b == d && strip_of(b.patch, d) == k {
                    add(along_a, strip_of(a.patch, along_a), turned);
                }
            }
        }
        let at = |&(d, k, share): &(usize, usize, f64)| {
            let [a, b] = self.strips[d][k].range;
            (d, a + share * (b - a))
        };
        let mut found: Vec<(usize, f64)> = all.iter().map(at).collect();
        // The one that was asked for, to the last bit.
        found[0].1 = x;
        found
    }

    /// Cells of spans, u and v, made equal along joined edges: as many as any of them has.
    pub(crate) fn cut_alike(&self, cells: [&mut Vec<usize>; 2]) {
        let seams: Vec<_> = self.seams().collect();
        let mut changed = true;
        while std::mem::take(&mut changed) {
            for &(a, b, against) in &seams {
                let (along_a, along_b) = (1 - a.side / 2, 1 - b.side / 2);
                let (x, y) = (&self.strips_of(a.patch)[along_a].spans, &self.strips_of(b.patch)[along_b].spans);
                for k in 0..x.len().min(y.len()) {
                    let (i, j) = (x.start + k, if against { y.end - 1 - k } else { y.start + k });
                    let most = cells[along_a][i].max(cells[along_b][j]);
                    changed |= cells[along_a][i] != most || cells[along_b][j] != most;
                    (cells[along_a][i], cells[along_b][j]) = (most, most);
                }
            }
        }
    }

    /// The patch of two spans.
    pub(crate) fn patch_of(&self, spans: [usize; 2]) -> Option<usize> {
        let find = |d: usize| self.strips[d].iter().position(|s| s.spans.contains(&spans[d]));
        Some(find(0)? * self.strips[1].len() + find(1)?)
    }

    /// The places on the other side of an edge, from a place on it: each patch that is joined there, none that is a
    /// duplicate. No allocation.
    pub(crate) fn beyond(&self, at: Spot, side: usize) -> impl Iterator<Item = (Spot, usize)> + '_ {
        let patch = self.patch_of([at.i, at.j]);
        let joined = patch.map_or(&[] as &[Joined], |patch| self.joined[4 * patch + side].as_slice());
        let share = patch.map_or(0.0, |patch| self.share_along(patch, side, at));
        joined
            .iter()
            .map(move |other| (self.spot(other.edge, if other.against { 1.0 - share } else { share }), other.edge.side))
    }

    /// The place of an edge of a patch that is nearest, in parameters, to one in the patch.
    pub(crate) fn on_edge(&self, patch: usize, side: usize, at: Spot) -> Spot {
        self.spot(Edge { patch, side }, self.share_along(patch, side, at))
    }

    fn share_along(&self, patch: usize, side: usize, at: Spot) -> f64 {
        let along = 1 - side / 2;
        let [a, b] = self.strips_of(patch)[along].range;
        ((if along == 0 { at.u } else { at.v } - a) / (b - a)).clamp(0.0, 1.0)
    }

    /// Ways over an edge to another patch: straight on from a place of the edge, straight to a place of that patch, and in
    /// between. Each is a place of the edge on either side. No allocation.
    pub(crate) fn crossings(
        &self,
        from: Spot,
        side: usize,
        to: usize,
        target: Spot,
    ) -> impl Iterator<Item = [Spot; 2]> + '_ {
        let patch = self.patch_of([from.i, from.j]).unwrap_or(0);
        let own = self.share_along(patch, side, from);
        self.joined[4 * patch + side].iter().filter(move |other| other.edge.patch == to).flat_map(move |other| {
            let turned = |share: f64| if other.against { 1.0 - share } else { share };
            let there = turned(self.share_along(to, other.edge.side, target));
            [own, there, 0.5 * (own + there)]
                .map(|share| [self.spot(Edge { patch, side }, share), self.spot(other.edge, turned(share))])
        })
    }

    /// A place on an edge.
    fn spot(&self, edge: Edge, share: f64) -> Spot {
        let strips = self.strips_of(edge.patch);
        let held = edge.side / 2;
        let mut spans = [0; 2];
        let mut x = [0.0; 2];
        for d in 0..2 {
            let Strip { range: [a, b], spans: of, inner, .. } = strips[d];
            if d == held {
                let end = edge.side % 2 == 1;
                (spans[d], x[d]) = if end { (of.end - 1, *b) } else { (of.start, *a) };
            } else {
                let before = distinct_below(inner, share);
                spans[d] = (of.start + before).min(of.end - 1);
                x[d] = if share <= 0.0 {
                    *a
                } else if share >= 1.0 {
                    *b
                } else {
                    a + share * (b - a)
                };
            }
        }
        Spot { i: spans[0], j: spans[1], u: x[0], v: x[1] }
    }

    /// The edges of its patch on which a place lies.
    pub(crate) fn edges_at(&self, at: Spot) -> [bool; 4] {
        let Some(patch) = self.patch_of([at.i, at.j]) else { return [false; 4] };
        let [u, v] = self.strips_of(patch);
        [at.u <= u.range[0], at.u >= u.range[1], at.v <= v.range[0], at.v >= v.range[1]]
    }

    /// Runs round a place: all places of the surface at the same point that edges join, the given one first. No allocation.
    pub(crate) fn meeting(&self, at: Spot) -> Meeting {
        let mut all = Meeting { spots: [at; MOST_MEETING], count: 1 };
        let mut next = 0;
        while next < all.count {
            let here = all.spots[next];
            next += 1;
            for (side, on) in self.edges_at(here).into_iter().enumerate() {
                if !on {
                    continue;
                }
                for (spot, _) in self.beyond(here, side) {
                    let patch = self.patch_of([spot.i, spot.j]);
                    let known = all.spots[..all.count]
                        .iter()
                        .any(|s| self.patch_of([s.i, s.j]) == patch && self.edges_at(*s) == self.edges_at(spot));
                    if !known && all.count < MOST_MEETING {
                        all.spots[all.count] = spot;
                        all.count += 1;
                    }
                }
            }
        }
        all
    }
}

/// Places at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    spots: [Spot; MOST_MEETING],
    count: usize,
}

impl Meeting {
    pub fn spots(&self) -> &[Spot] {
        &self.spots[..self.count]
    }
}

/// Knots are the same, as shares of their strip, within this.
pub(crate) const SAME_KNOT: f64 = 1e-9;

/// Distinct values up to a share.
fn distinct_below(inner: &[f64], share: f64) -> usize {
    let mut count = 0;
    let mut last = f64::NAN;
    for &x in inner.iter().take_while(|&&x| x <= share) {
        count += usize::from(x != last);
        last = x;
    }
    count
}

fn strips(knots: &KnotVector) -> Vec<Strip> {
    let (t, p) = (knots.knots(), knots.degree());
    let (start, end) = knots.domain();
    let spans: Vec<usize> = knots.spans().collect();
    let mut breaks = vec![start];
    breaks.extend(spans.iter().map(|&i| t[i]).filter(|&x| x > start && knots.multiplicity(x) >= p));
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
                inner: t[first + 1..last].iter().map(|x| (x - a) / (b - a)).collect(),
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
        [&self.strips[0][patch / across], &self.strips[1][patch % across]]
    }

    /// Control points of a patch, u-major.
    fn controls(&self, patch: usize) -> Vec<usize> {
        let ([u0, u1], [v0, v1]) = (self.strips_of(patch)[0].controls, self.strips_of(patch)[1].controls);
        let columns = self.surface.net().columns();
        (u0..=u1).flat_map(|i| (v0..=v1).map(move |j| i * columns + j)).collect()
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
        let Some(weights) = self.surface.weights() else { return true };
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
        let degree = |d: usize| if d == 0 { self.surface.knots_u().degree() } else { self.surface.knots_v().degree() };
        let n = y.len();
        let turned = |k: usize| y[if against { n - 1 - k } else { k }];
        x.len() == n
            && self.near(x[0], turned(0))
            && degree(along(a)) == degree(along(b))
            && (0..n).all(|k| self.near(x[k], turned(k)))
            && same_knots(self.strips_of(a.patch)[along(a)], self.strips_of(b.patch)[along(b)], against)
            && self.alike(x.iter().copied().zip((0..n).map(turned)))
    }
}

fn same_knots(a: &Strip, b: &Strip, against: bool) -> bool {
    let n = b.inner.len();
    let turned = |k: usize| if against { 1.0 - b.inner[n - 1 - k] } else { b.inner[k] };
    a.inner.len() == n && (0..n).all(|k| (a.inner[k] - turned(k)).abs() <= SAME_KNOT)
}

/// Points joined into sets; the least index of a set is its root.
pub(crate) struct Sets {
    to: Vec<usize>,
}

impl Sets {
    pub fn new(count: usize) -> Self {
        Self { to: (0..count).collect() }
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

#[cfg(test)]
mod tests;
