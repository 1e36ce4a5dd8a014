//! Whole numbers for places of a surface's parameters: each span of knots is divided into [`WHOLE`] steps.

use crate::basis::KnotVector;
use crate::surface::{Surface, Topology};

/// Halvings of a span at most. What is smaller than a step of the finest grid is a point.
pub(super) const DEPTH: u32 = 20;
/// Steps of a span.
pub(super) const WHOLE: u64 = 1 << DEPTH;

/// Spans in both directions, and how their ends relate.
pub(super) struct Grid {
    spans: [Vec<[f64; 2]>; 2],
    /// The end of a direction is its start.
    pub wraps: [bool; 2],
    /// By direction and end: all points of that side are one.
    pub poles: [[bool; 2]; 2],
}

/// A straight side of the grid, from a place to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Side {
    /// 0: u runs along it, 1: v.
    pub direction: usize,
    /// The other parameter.
    pub line: u64,
    pub from: u64,
    pub to: u64,
}

impl Side {
    pub fn place(&self, along: u64) -> [u64; 2] {
        match self.direction {
            0 => [along, self.line],
            _ => [self.line, along],
        }
    }
}

impl Grid {
    pub fn new(surface: &Surface, topology: &Topology) -> Self {
        let spans = |knots: &KnotVector| {
            let t = knots.knots();
            knots.spans().map(|k| [t[k], t[k + 1]]).collect()
        };
        Self {
            spans: [spans(surface.knots_u()), spans(surface.knots_v())],
            wraps: [topology.wraps(0), topology.wraps(1)],
            poles: topology.poles,
        }
    }

    /// Spans in both directions.
    pub fn counts(&self) -> [usize; 2] {
        [self.spans[0].len(), self.spans[1].len()]
    }

    /// The last number of a direction.
    pub fn end(&self, d: usize) -> u64 {
        self.spans[d].len() as u64 * WHOLE
    }

    /// The length of the domain where it wraps, else 0.
    pub fn period(&self, d: usize) -> f64 {
        match self.wraps[d] {
            true => self.parameter(d, self.end(d)) - self.spans[d][0][0],
            false => 0.0,
        }
    }

    /// The one number of those that wrapping makes equal.
    pub fn canonical(&self, d: usize, x: u64) -> u64 {
        if self.wraps[d] && x == self.end(d) {
            0
        } else {
            x
        }
    }

    /// A side by its one name.
    pub fn named(&self, side: Side) -> Side {
        Side {
            line: self.canonical(1 - side.direction, side.line),
            ..side
        }
    }

    /// The piece that answers for a place, and the place within it.
    pub fn piece(&self, place: [u64; 2]) -> ([usize; 2], [f64; 2]) {
        let mut piece = [0; 2];
        let mut local = [0.0; 2];
        for d in 0..2 {
            let x = self.canonical(d, place[d]);
            piece[d] = ((x / WHOLE) as usize).min(self.spans[d].len() - 1);
            local[d] = (x - piece[d] as u64 * WHOLE) as f64 / WHOLE as f64;
        }
        (piece, local)
    }

    pub fn parameter(&self, d: usize, x: u64) -> f64 {
        let span = ((x / WHOLE) as usize).min(self.spans[d].len() - 1);
        let local = (x - span as u64 * WHOLE) as f64 / WHOLE as f64;
        self.parameter_within(d, span, local)
    }

    /// At t of a span, from 0 to 1.
    pub fn parameter_within(&self, d: usize, span: usize, t: f64) -> f64 {
        let [a, b] = self.spans[d][span];
        if t == 1.0 { b } else { a + (b - a) * t }
    }

    pub fn parameters(&self, place: [u64; 2]) -> [f64; 2] {
        [0, 1].map(|d| self.parameter(d, place[d]))
    }

    /// The place on the grid at or below parameters of the domain.
    pub fn below(&self, uv: [f64; 2]) -> [u64; 2] {
        [0, 1].map(|d| {
            let spans = &self.spans[d];
            let k = spans.partition_point(|s| s[0] <= uv[d]).max(1) - 1;
            let [a, b] = spans[k];
            let t = ((uv[d] - a) / (b - a)).clamp(0.0, 1.0);
            k as u64 * WHOLE + ((t * WHOLE as f64) as u64).min(WHOLE - 1)
        })
    }

    /// The representative of parameters that is nearest to others.
    pub fn lifted(&self, uv: [f64; 2], near: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| match self.period(d) {
            0.0 => uv[d],
            period => uv[d] + period * ((near[d] - uv[d]) / period).round(),
        })
    }

    /// The representative of parameters within the domain.
    pub fn reduced(&self, uv: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|d| {
            let [low, high] = [self.spans[d][0][0], self.parameter(d, self.end(d))];
            let turns = match self.period(d) {
                0.0 => 0.0,
                period => period * ((uv[d] - low) / period).floor(),
            };
            (uv[d] - turns).clamp(low, high)
        })
    }
}
