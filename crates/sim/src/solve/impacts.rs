//! Impacts within a tick, one after the other.
//!
//! In a chain of bodies that touch, a blow goes from one to the next, and each pair parts with its own restitution
//! before the next one meets (sequential impulses; Han & Gilmore 1993). Solved all at once, the first of five balls
//! would be thrown back. What meets first is what meets fastest; pairs that do so alike meet at once, so that what is
//! symmetric stays so.

use super::matrix::ContactMatrix;

/// Speeds this near to the greatest, relative to it, are as great.
const ALIKE: f64 = 1e-9;
/// Most rounds for each row: a blow that runs to the end of a chain and back takes two.
const ROUNDS: usize = 8;
/// Sweeps over the rows that meet at once, and when they have settled, relative to the greatest speed.
const SWEEPS: usize = 100;
const SETTLED: f64 = 1e-14;

/// One row that impacts may concern.
#[derive(Clone, Copy, Debug, Default)]
pub struct Impact {
    /// Its pair.
    pub pair: u32,
    /// How fast its surfaces meet, m/s, negative where they part.
    pub meeting_m_s: f64,
    /// It has been struck.
    pub struck: bool,
    /// It bounces if it meets now, and its surfaces part at this speed then, m/s.
    parting_m_s: Option<f64>,
    /// It meets in this round.
    meets: bool,
    /// Of this round, N.
    force_n: f64,
}

/// Buffers for a number of rows.
#[derive(Clone, Debug, Default)]
pub struct Impacts {
    rows: Vec<Impact>,
}

impl Impacts {
    /// Room for `rows` rows.
    pub fn new(rows: usize) -> Self {
        Self {
            rows: Vec::with_capacity(rows),
        }
    }

    /// By row, after [`Impacts::run`].
    pub fn rows(&self) -> &[Impact] {
        &self.rows
    }

    /// Lets rows meet until none does. `rows`: pair and speed of each; `parts` says of a row that meets at a speed
    /// whether it bounces, and at what speed its surfaces part then.
    pub fn run(
        &mut self,
        matrix: &ContactMatrix,
        dt_s: f64,
        rows: impl Iterator<Item = (u32, f64)>,
        parts: impl Fn(usize, f64) -> Option<f64>,
    ) {
        self.rows.clear();
        self.rows.extend(rows.map(|(pair, meeting_m_s)| Impact {
            pair,
            meeting_m_s,
            ..Impact::default()
        }));
        debug_assert_eq!(self.rows.len(), matrix.rows(), "a speed a row");
        for _ in 0..ROUNDS * self.rows.len() {
            let mut fastest = 0.0f64;
            for (i, row) in self.rows.iter_mut().enumerate() {
                row.parting_m_s = parts(i, row.meeting_m_s).filter(|_| row.meeting_m_s > 0.0);
                if row.parting_m_s.is_some() {
                    fastest = fastest.max(row.meeting_m_s);
                }
            }
            if fastest == 0.0 {
                return;
            }
            // All rows of a pair meet at once, if one of them is among the fastest.
            for i in 0..self.rows.len() {
                let pair = self.rows[i].pair;
                let first = |row: &Impact| {
                    row.pair == pair
                        && row.parting_m_s.is_some()
                        && row.meeting_m_s >= (1.0 - ALIKE) * fastest
                };
                let meets = self.rows[i].parting_m_s.is_some() && self.rows.iter().any(first);
                let row = &mut self.rows[i];
                row.struck |= meets;
                (row.meets, row.force_n) = (meets, 0.0);
            }
            self.strike(matrix, dt_s, fastest);
        }
    }

    /// Forces under which those that meet part.
    fn strike(&mut self, matrix: &ContactMatrix, dt_s: f64, fastest_m_s: f64) {
        for _ in 0..SWEEPS {
            let mut most = 0.0f64;
            for i in 0..self.rows.len() {
                let row = self.rows[i];
                let Some(parting_m_s) = row.parting_m_s.filter(|_| row.meets) else {
                    continue;
                };
                let own = matrix.along(i);
                let wish = row.force_n + (row.meeting_m_s + parting_m_s) * dt_s / own;
                let next = if own > 0.0 && wish > 0.0 { wish } else { 0.0 };
                let change = next - row.force_n;
                if change != 0.0 {
                    self.rows[i].force_n = next;
                    for j in 0..self.rows.len() {
                        let at = |row| (row, matrix.normal(row));
                        let moved_m = change * matrix.between(at(j), at(i));
                        self.rows[j].meeting_m_s -= moved_m / dt_s;
                    }
                    most = most.max((change * own / dt_s).abs());
                }
            }
            if most <= SETTLED * fastest_m_s {
                return;
            }
        }
    }
}
