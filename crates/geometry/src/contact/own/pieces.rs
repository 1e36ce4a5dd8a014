//! Pairs of pieces that may come near each other, found anew only when the surface has moved.
//!
//! No point of a piece moves farther than some point of the net. So pairs that were far apart stay so
//! until the net has moved by half of what lies between; the others are judged at each query, and no answer depends
//! on when the pairs were found.

use super::{Half, block};
use crate::math::Point3;
use crate::surface::{BezierPieces, Surface};

/// How far the net may move before pairs are found anew, relative to the width of a piece.
const SLACK: f64 = 0.1;

/// Which pairs of pieces may be near.
#[derive(Clone, Debug)]
pub(super) struct NearPieces {
    /// The net for which they were found, and how far any coordinate of it may have moved since, m.
    net: Vec<Point3>,
    slack_m: f64,
    /// Nearer than this they may be, m.
    reach_m: f64,
    /// (pieces × words): bit b of row a, for a ≤ b.
    near: Vec<u64>,
    words: usize,
}

impl NearPieces {
    pub fn new(surface: &Surface, pieces: &BezierPieces) -> Self {
        let words = pieces.len().div_ceil(64);
        Self {
            net: surface.net().points().to_vec(),
            slack_m: 0.0,
            reach_m: f64::NEG_INFINITY,
            near: vec![0; pieces.len() * words],
            words,
        }
    }

    /// Sees to it that all pairs nearer than `reach_m` are known.
    pub fn follow(&mut self, half: Half<'_>, size_m: f64, reach_m: f64) {
        let Half { surface, pieces } = half;
        let points = surface.net().points();
        let moved = self.net.iter().zip(points);
        let moved_m = moved.fold(0.0_f64, |most, (old, new)| most.max((new - old).amax()));
        if moved_m <= self.slack_m && reach_m <= self.reach_m {
            return;
        }
        self.net.copy_from_slice(points);
        let count = pieces.len();
        self.slack_m = SLACK * size_m / (count as f64).sqrt();
        self.reach_m = reach_m + self.slack_m;
        let largest_m = points
            .iter()
            .fold(0.0_f64, |most, x| most.max(x.coords.amax()));
        let within_m = self.reach_m + 2.0 * self.slack_m + 1e-12 * largest_m;
        self.near.fill(0);
        for a in 0..count {
            let own = block(pieces, a);
            for b in a..count {
                let near = own.meets(&block(pieces, b), within_m);
                self.near[a * self.words + b / 64] |= u64::from(near) << (b % 64);
            }
        }
    }

    /// The next piece from `from` on that may be near this one.
    pub fn next(&self, piece: usize, from: usize) -> Option<usize> {
        let row = &self.near[piece * self.words..(piece + 1) * self.words];
        let mut word = from / 64;
        let mut bits = row.get(word)? & (u64::MAX << (from % 64));
        while bits == 0 {
            word += 1;
            bits = *row.get(word)?;
        }
        Some(word * 64 + bits.trailing_zeros() as usize)
    }
}
