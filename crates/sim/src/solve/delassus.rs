//! What rows on a deforming surface do to each other: C W Cᵀ, C the weights of the rows, W the
//! surface's compliance.
//!
//! Rows share control points: each column of W that any row touches is read once, at those of its
//! entries that matter.

use palpate_geometry::math::Lane;
use palpate_geometry::math::simd;

/// No slot.
const NONE: u32 = u32::MAX;

/// Buffers for up to a number of sides of rows on one body.
#[derive(Clone, Debug)]
pub struct Delassus {
    /// (unknowns): place among those concerned.
    slot_of: Vec<u32>,
    sides: Vec<Side>,
    /// Of side after side: unknown, later slot, and weight.
    entries: Vec<(u32, f64)>,
    /// Unknowns concerned, ascending, and where the entries of each begin in `by_slot`.
    concerned: Vec<Concerned>,
    /// Entries of slot after slot: side and weight.
    by_slot: Vec<(u32, f64)>,
    /// One column of W at the slots, padded to whole lanes.
    column: Vec<Lane>,
    /// What a unit force on each side does at the slots, side after side, m/N.
    response: Vec<Lane>,
}

#[derive(Clone, Copy, Debug)]
struct Side {
    row: u32,
    sign: f64,
    start: u32,
    end: u32,
}

#[derive(Clone, Copy, Debug)]
struct Concerned {
    unknown: u32,
    coordinate: u32,
    start: u32,
}

impl Delassus {
    /// Room for `sides` of `width` weights each, on bodies of at most `unknowns`, `surface` of them
    /// of the net.
    pub fn new(sides: usize, width: usize, unknowns: usize, surface: usize) -> Self {
        let entries = sides * width;
        let slots = surface.min(entries);
        let lanes = slots.div_ceil(4);
        Self {
            slot_of: vec![NONE; unknowns],
            sides: Vec::with_capacity(sides),
            entries: Vec::with_capacity(entries),
            concerned: Vec::with_capacity(slots),
            by_slot: vec![(0, 0.0); entries],
            column: vec![[0.0; 4]; lanes],
            response: vec![[0.0; 4]; lanes * sides],
        }
    }

    /// No sides.
    pub fn clear(&mut self) {
        for seen in &self.concerned {
            self.slot_of[seen.unknown as usize] = NONE;
        }
        self.sides.clear();
        self.entries.clear();
        self.concerned.clear();
    }

    /// Adds a side of a row, pushed along the row's normal times `sign`: (unknown, coordinate,
    /// weight) of its control points that move.
    pub fn add(
        &mut self,
        row: usize,
        sign: f64,
        weights: impl Iterator<Item = (usize, usize, f64)>,
    ) {
        debug_assert!(sign.abs() == 1.0, "a side is pushed along or against");
        debug_assert!(
            self.sides.len() < self.sides.capacity(),
            "no room for a side"
        );
        let start = self.entries.len() as u32;
        for (unknown, coordinate, weight) in weights {
            if self.slot_of[unknown] == NONE {
                self.slot_of[unknown] = 0;
                let (unknown, coordinate) = (unknown as u32, coordinate as u32);
                self.concerned.push(Concerned {
                    unknown,
                    coordinate,
                    start: 0,
                });
            }
            self.entries.push((unknown as u32, weight));
        }
        self.sides.push(Side {
            row: row as u32,
            sign,
            start,
            end: self.entries.len() as u32,
        });
    }

    /// Finds what each side does to all others. `column_of`: the column of W of a coordinate, by
    /// unknown, m/N.
    pub fn respond<'a>(&mut self, column_of: impl Fn(usize) -> Option<&'a [f64]>) {
        debug_assert!(
            self.entries.len() <= self.by_slot.len(),
            "no room for weights"
        );
        self.sort();
        let lanes = self.concerned.len().div_ceil(4);
        self.response[..lanes * self.sides.len()].fill([0.0; 4]);
        self.column[..lanes].fill([0.0; 4]);
        for slot in 0..self.concerned.len() {
            let Some(column) = column_of(self.concerned[slot].coordinate as usize) else {
                continue;
            };
            let to = self.column.as_flattened_mut().iter_mut();
            for (value, seen) in to.zip(&self.concerned) {
                *value = column[seen.unknown as usize];
            }
            let end = self
                .concerned
                .get(slot + 1)
                .map_or(self.entries.len(), |next| next.start as usize);
            for &(side, weight) in &self.by_slot[self.concerned[slot].start as usize..end] {
                let start = side as usize * lanes;
                add_scaled(
                    &mut self.response[start..start + lanes],
                    &self.column[..lanes],
                    weight,
                );
            }
        }
    }

    /// Orders what is concerned by unknown, whose entries lie near each other in every column, and
    /// entries by slot.
    fn sort(&mut self) {
        self.concerned.sort_unstable_by_key(|seen| seen.unknown);
        for (slot, seen) in self.concerned.iter_mut().enumerate() {
            self.slot_of[seen.unknown as usize] = slot as u32;
            seen.start = 0;
        }
        for (unknown, _) in &mut self.entries {
            *unknown = self.slot_of[*unknown as usize];
        }
        // Counts, then ends, then, filled from the back, starts.
        for &(slot, _) in &self.entries {
            self.concerned[slot as usize].start += 1;
        }
        let mut end = 0;
        for seen in &mut self.concerned {
            end += seen.start;
            seen.start = end;
        }
        for (s, side) in self.sides.iter().enumerate().rev() {
            for &(slot, weight) in self.entries[side.start as usize..side.end as usize]
                .iter()
                .rev()
            {
                let start = &mut self.concerned[slot as usize].start;
                *start -= 1;
                self.by_slot[*start as usize] = (s as u32, weight);
            }
        }
    }

    /// Calls `add` with (row, row, signs × what a force on the one does to the other) for every
    /// pair of sides, once each, the first no later than the second.
    pub fn each_pair(&self, mut add: impl FnMut(PairOfSides)) {
        let stride = 4 * self.concerned.len().div_ceil(4);
        let response = self.response.as_flattened();
        for (s, a) in self.sides.iter().enumerate() {
            let response = &response[s * stride..(s + 1) * stride];
            for (t, b) in self.sides.iter().enumerate().skip(s) {
                let mut moved = 0.0;
                for &(slot, weight) in &self.entries[b.start as usize..b.end as usize] {
                    moved += weight * response[slot as usize];
                }
                let rows = [a.row as usize, b.row as usize];
                add(PairOfSides {
                    rows,
                    same: s == t,
                    compliance: a.sign * b.sign * moved,
                });
            }
        }
    }
}

/// Two sides of rows on one body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairOfSides {
    /// Their rows.
    pub rows: [usize; 2],
    /// They are one side.
    pub same: bool,
    /// What a unit force on the one moves the other along the same direction, m/N, with the signs
    /// of both.
    pub compliance: f64,
}

impl PairOfSides {
    /// What the pair adds to what its rows do to each other: two sides of one row move each other both ways.
    pub fn of_rows(&self) -> f64 {
        let both = self.rows[0] == self.rows[1] && !self.same;
        self.compliance * if both { 2.0 } else { 1.0 }
    }
}

/// y += w x.
fn add_scaled(to: &mut [Lane], x: &[Lane], weight: f64) {
    #[cfg(target_arch = "x86_64")]
    if simd::has_avx2() {
        // SAFETY: the processor has AVX2, asked just above.
        #[allow(unsafe_code)]
        return unsafe { add_scaled_wide(to, x, weight) };
    }
    add_scaled_lanes(to, x, weight);
}

#[inline(always)]
fn add_scaled_lanes(to: &mut [Lane], x: &[Lane], weight: f64) {
    for (to, x) in to.iter_mut().zip(x) {
        for k in 0..4 {
            to[k] += weight * x[k];
        }
    }
}

/// The same code with 256-bit registers; nothing is fused, so the bits are the same.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn add_scaled_wide(to: &mut [Lane], x: &[Lane], weight: f64) {
    add_scaled_lanes(to, x, weight);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the product of dense matrices.
    #[test]
    fn pairs_are_those_of_the_dense_product() {
        let mut state = 3u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let unknowns = 40;
        let factor: Vec<f64> = (0..unknowns * unknowns).map(|_| random()).collect();
        let entry = |i: usize, j: usize| {
            (0..unknowns)
                .map(|k| factor[i * unknowns + k] * factor[j * unknowns + k])
                .sum()
        };
        let compliance: Vec<f64> = (0..unknowns * unknowns)
            .map(|k| entry(k / unknowns, k % unknowns))
            .collect();
        let mut delassus = Delassus::new(24, 5, unknowns, unknowns);
        for round in 0..3 {
            delassus.clear();
            // Coordinates are unknowns counted from the back; some rows have two sides here, some
            // none.
            let mut dense: Vec<(usize, f64, Vec<f64>)> = Vec::new();
            for row in 0..12 {
                for side in 0..(row + round) % 3 {
                    let sign = if side == 0 { -1.0 } else { 1.0 };
                    let weights: Vec<(usize, f64)> = (0..1 + row % 5)
                        .map(|k| {
                            (
                                (7 * row + 3 * k + 11 * side + 13 * round) % unknowns,
                                random(),
                            )
                        })
                        .collect();
                    let mut whole = vec![0.0; unknowns];
                    weights
                        .iter()
                        .for_each(|&(unknown, weight)| whole[unknown] += weight);
                    delassus.add(
                        row,
                        sign,
                        weights
                            .iter()
                            .map(|&(u, weight)| (u, unknowns - 1 - u, weight)),
                    );
                    dense.push((row, sign, whole));
                }
            }
            delassus.respond(|coordinate| {
                let unknown = unknowns - 1 - coordinate;
                Some(&compliance[unknown * unknowns..(unknown + 1) * unknowns])
            });
            let mut seen = 0;
            let mut pairs = (0..dense.len()).flat_map(|s| (s..dense.len()).map(move |t| (s, t)));
            delassus.each_pair(|pair| {
                let (s, t) = pairs.next().unwrap();
                let ((row_a, sign_a, a), (row_b, sign_b, b)) = (&dense[s], &dense[t]);
                let mut expected = 0.0;
                for i in 0..unknowns {
                    for j in 0..unknowns {
                        expected += sign_a * a[i] * compliance[i * unknowns + j] * b[j] * sign_b;
                    }
                }
                assert_eq!((pair.rows, pair.same), ([*row_a, *row_b], s == t));
                assert!(
                    (pair.compliance - expected).abs() < 1e-12,
                    "{} is not {expected}",
                    pair.compliance
                );
                seen += 1;
            });
            assert_eq!(seen, dense.len() * (dense.len() + 1) / 2);
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn wide_registers_give_the_same_bits() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            return;
        }
        let x: Vec<Lane> = (0..9)
            .map(|k| [0.1 * f64::from(k), 1.0 / 3.0, -7.7, 1e-30])
            .collect();
        let (mut slow, mut fast) = (x.clone(), x.clone());
        add_scaled_lanes(&mut slow, &x, 0.37);
        // SAFETY: asked just above.
        #[allow(unsafe_code)]
        unsafe {
            add_scaled_wide(&mut fast, &x, 0.37);
        }
        assert_eq!(slow, fast);
    }
}
