//! Branching surfaces: which parts of one net are the same place, and which edges are joined.
//!
//! A branching surface is one tensor product whose knots part it: multiplicity = degree creases it,
//! degree + 1 disjoins it. Between such knots lie *patches*, which only touch where their edges are
//! equal. Two edges are joined where they are equal as curves (control points, weights and relative
//! knots, along each other or against), so two walls of a squeezed tube that touch in one control
//! point stay apart. A patch that equals an earlier one as a whole is a *duplicate*: the stem of a
//! branching tube is drawn once for each leaf. Found from the net itself, in order of the patches;
//! nothing is hashed.
//!
//! Only surfaces with a disjoined knot, clamped in both directions, are looked at; others cost
//! nothing.

mod cuts;
mod find;
mod places;
#[cfg(test)]
mod tests;

pub(crate) use self::cuts::SAME_KNOT;
pub(crate) use self::find::Sets;
pub(crate) use self::places::Spot;
use super::Surface;
use crate::basis::KnotKind;
use std::ops::Range;

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
    /// Range of parameters.
    pub range: [f64; 2],
    /// Among the spans of positive length.
    pub spans: Range<usize>,
    /// Control points, both ends included.
    pub controls: [usize; 2],
    /// Knots inside, from 0 to 1.
    inner: Vec<f64>,
}

/// An edge of a patch: `2 d` where parameter d (0: u, 1: v) is at its start, `2 d + 1` where it is
/// at its end.
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

/// The patches of a branching surface and how they are joined.
#[derive(Clone, Debug, PartialEq)]
pub struct Joints {
    patches: Vec<Patch>,
    strips: [Vec<Strip>; 2],
    /// (patches × 4): edges of patches that are not duplicates.
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
    /// The patches of a branching surface; `None` for one without a disjoined knot, with a
    /// direction that is not clamped, or with more than 1024 patches.
    pub fn joints(&self) -> Option<Joints> {
        let both = [self.knots_u(), self.knots_v()];
        let branches = both.iter().any(|knots| !knots.disjoined().is_empty());
        let clamped = both.iter().all(|knots| knots.kind() == KnotKind::Clamped);
        (branches && clamped).then(|| Joints::new(self)).flatten()
    }
}

impl Joints {
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
        self.patches[self.patch_at([u, v])].duplicate_of.is_some()
    }

    /// (spans in u × spans in v).
    pub(crate) fn hidden(&self) -> &[bool] {
        &self.hidden
    }

    /// The piece that a duplicate draws again; itself for one that is none.
    pub(crate) fn original(&self, piece: usize) -> usize {
        let at = [piece / self.columns, piece % self.columns];
        let Some(patch) = self.patch_of(at) else {
            return piece;
        };
        let Some(other) = self.patches[patch].duplicate_of else {
            return piece;
        };
        let from = |d: usize, patch: usize| {
            let k = if d == 0 {
                patch / self.strips[1].len()
            } else {
                patch % self.strips[1].len()
            };
            self.strips[d][k].spans.start
        };
        let [i, j] = [0, 1].map(|d| at[d] - from(d, patch) + from(d, other));
        i * self.columns + j
    }

    /// Parameters inside the domain between which patches lie.
    pub(crate) fn breaks(&self, direction: usize) -> Vec<f64> {
        self.strips[direction]
            .iter()
            .skip(1)
            .map(|strip| strip.range[0])
            .collect()
    }

    /// Pairs of edges of patches that are joined, each once; `against`: one runs the other way.
    /// Duplicates are left out.
    pub(crate) fn seams(&self) -> impl Iterator<Item = (Edge, Edge, bool)> + '_ {
        self.joined.iter().enumerate().flat_map(move |(k, list)| {
            let edge = Edge {
                patch: k / 4,
                side: k % 4,
            };
            let shown = self.patches[edge.patch].duplicate_of.is_none();
            let later = list
                .iter()
                .filter(move |j| shown && (j.edge.patch, j.edge.side) > (edge.patch, edge.side));
            later.map(move |j| (edge, j.edge, j.against))
        })
    }

    /// Every edge along a knot inside the domain is joined to another, or is one point.
    pub fn is_whole(&self) -> bool {
        (0..self.joined.len()).all(|e| {
            let (patch, side) = (e / 4, e % 4);
            let d = side / 2;
            let k = if d == 0 {
                patch / self.strips[1].len()
            } else {
                patch % self.strips[1].len()
            };
            let at_end = if side.is_multiple_of(2) {
                k == 0
            } else {
                k + 1 == self.strips[d].len()
            };
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
        [
            &self.strips[0][patch / across],
            &self.strips[1][patch % across],
        ]
    }
}
