//! Loops as they go through the parameters of a face, past the ends of periods.

use super::super::chart::lifted;

/// A stretch of an edge as a loop walks it: places count segments from the start of the edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub edge: u32,
    pub from: f64,
    pub to: f64,
}

/// A loop with the places it passes, lifted.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    pub spans: Vec<Span>,
    /// Place on a span (index, place) and parameters; the last one is the first one, gone round.
    pub places: Vec<((usize, f64), [f64; 2])>,
}

impl Walk {
    pub fn turns(&self, periods: [f64; 2]) -> [i32; 2] {
        let (first, last) = (self.places[0].1, self.places[self.places.len() - 1].1);
        std::array::from_fn(|k| match periods[k] {
            0.0 => 0,
            period => ((last[k] - first[k]) / period).round() as i32,
        })
    }

    pub fn range(&self, k: usize) -> [f64; 2] {
        let all = self.places.iter().map(|(_, uv)| uv[k]);
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
            [a.min(x), b.max(x)]
        })
    }

    pub fn shift(&mut self, k: usize, by: f64) {
        self.places.iter_mut().for_each(|(_, uv)| uv[k] += by);
    }

    /// How often it crosses a line or a copy of it.
    pub fn crossings(&self, k: usize, line: f64, period: f64) -> usize {
        let turn = |x: f64| ((x - line) / period).floor();
        let pairs = self.places.windows(2);
        let turns = pairs.map(|pair| (turn(pair[1].1[k]) - turn(pair[0].1[k])).abs());
        turns.sum::<f64>() as usize
    }

    /// Twice the area within, positive if it is on the left.
    pub fn area(&self) -> f64 {
        let pairs = self.places.windows(2);
        pairs
            .map(|pair| {
                let ([a, b], [c, d]) = (pair[0].1, pair[1].1);
                a * d - c * b
            })
            .sum()
    }
}

/// A range that goes over a line, or a copy of it.
pub(super) fn crosses([low, high]: [f64; 2], line: f64, period: f64) -> bool {
    let slack = 1e-6 * period;
    let line = lifted(line, 0.5 * (low + high), period);
    line > low - slack && line < high + slack
}
