//! Cutting patches: what is joined, or drawn again, is cut alike.

use super::{Joints, Patch};

/// Knots are the same, as shares of their strip, within this.
pub(crate) const SAME_KNOT: f64 = 1e-9;

impl Joints {
    /// Parameters, one in each direction, that a cut of a patch at `x` brings about elsewhere,
    /// itself included: joined edges and duplicates are cut alike.
    pub fn cuts(&self, direction: usize, x: f64) -> Vec<(usize, f64)> {
        let place = |d: usize, x: f64| {
            let k = self.strips[d]
                .iter()
                .position(|s| x > s.range[0] && x < s.range[1])?;
            let [a, b] = self.strips[d][k].range;
            Some((k, (x - a) / (b - a)))
        };
        let Some((k, share)) = place(direction, x) else {
            return vec![(direction, x)];
        };
        // (direction, strip, share of it).
        let mut all = vec![(direction, k, share)];
        let mut next = 0;
        while next < all.len() {
            let (d, k, share) = all[next];
            next += 1;
            let mut add = |d: usize, k: usize, share: f64| {
                let known = |&(e, l, other): &(usize, usize, f64)| {
                    e == d && l == k && (other - share).abs() < SAME_KNOT
                };
                if !all.iter().any(known) {
                    all.push((d, k, share));
                }
            };
            let strip_of = |patch: usize, d: usize| {
                if d == 0 {
                    patch / self.strips[1].len()
                } else {
                    patch % self.strips[1].len()
                }
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
                let (x, y) = (
                    &self.strips_of(a.patch)[along_a].spans,
                    &self.strips_of(b.patch)[along_b].spans,
                );
                for k in 0..x.len().min(y.len()) {
                    let (i, j) = (
                        x.start + k,
                        if against { y.end - 1 - k } else { y.start + k },
                    );
                    let most = cells[along_a][i].max(cells[along_b][j]);
                    changed |= cells[along_a][i] != most || cells[along_b][j] != most;
                    (cells[along_a][i], cells[along_b][j]) = (most, most);
                }
            }
        }
    }
}
