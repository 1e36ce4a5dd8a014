//! What holds a tool that only translates, exactly.
//!
//! Its proxy is the place nearest to the hand that no contact forbids, and the coupling pulls it with the way between
//! both: the least ½ |x|² with n_i · x ≥ b_i, in three unknowns. Sweeps over its rows need 1 / ε² rounds where two
//! normals differ by ε; the dual method of Goldfarb & Idnani (1983) ends after a few exchanges of at most three rows.

use nalgebra::{Matrix3, Vector3 as Column};
use palpate_geometry::math::Vector3;

/// A contact: where it allows the tool to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barrier {
    /// Unit vector on which it pushes the tool.
    pub normal: Vector3,
    /// How deep the hand is in it, m; negative: a gap.
    pub depth_m: f64,
    /// How much of the way is its own, m: the sum of these along their normals is the way.
    pub part_m: f64,
}

/// Barriers added or let go.
const EXCHANGES: usize = 200;
/// Deeper than this, relative to the deepest, is inside.
const INSIDE: f64 = 1e-13;
/// Of a unit normal, what others leave of it below this is nothing.
const NOTHING: f64 = 1e-12;

/// The rows that hold the tool, and their parts.
#[derive(Clone, Copy, Default)]
struct Holding {
    rows: [usize; 3],
    parts_m: [f64; 3],
    count: usize,
}

impl Holding {
    fn drop(&mut self, k: usize) {
        self.rows.copy_within(k + 1..self.count, k);
        self.parts_m.copy_within(k + 1..self.count, k);
        self.count -= 1;
    }

    /// A normal by those that hold: how much of each, and what is left.
    fn split(&self, barriers: &[Barrier], normal: &Vector3) -> ([f64; 3], Vector3) {
        // Rows beyond the count are of the identity, so that they solve to nothing.
        let mut gram = Matrix3::identity();
        let mut onto = Column::zeros();
        for a in 0..self.count {
            let own = barriers[self.rows[a]].normal;
            onto[a] = own.dot(normal);
            for b in 0..self.count {
                gram[(a, b)] = own.dot(&barriers[self.rows[b]].normal);
            }
        }
        let Some(solved) = gram.cholesky().map(|c| c.solve(&onto)) else {
            return ([0.0; 3], Vector3::zeros());
        };
        let of_rows = (0..self.count).map(|a| barriers[self.rows[a]].normal * solved[a]);
        (solved.into(), normal - of_rows.sum::<Vector3>())
    }
}

/// Sets the parts of all barriers. False, with nothing changed, when there is no such place.
pub fn hold(barriers: &mut [Barrier]) -> bool {
    debug_assert!(
        barriers
            .iter()
            .all(|b| (b.normal.norm() - 1.0).abs() < 1e-6),
        "unit normals"
    );
    let deepest_m = barriers.iter().map(|b| b.depth_m).fold(0.0, f64::max);
    let mut way = Vector3::zeros();
    let mut holding = Holding::default();
    let mut wanted: Option<(usize, f64)> = None;
    for _ in 0..EXCHANGES {
        let inside_m = |b: &Barrier| b.depth_m - b.normal.dot(&way);
        let worst = || {
            let held = |k: &usize| !holding.rows[..holding.count].contains(k);
            let others = (0..barriers.len()).filter(held);
            let inside =
                |&a: &usize, &b: &usize| inside_m(&barriers[a]).total_cmp(&inside_m(&barriers[b]));
            others
                .max_by(inside)
                .filter(|&k| inside_m(&barriers[k]) > INSIDE * deepest_m)
        };
        let Some((row, part_m)) = wanted.or_else(|| worst().map(|k| (k, 0.0))) else {
            barriers.iter_mut().for_each(|b| b.part_m = 0.0);
            for (row, part_m) in holding.rows.iter().zip(holding.parts_m).take(holding.count) {
                barriers[*row].part_m = part_m;
            }
            return true;
        };
        let (of_rows, left) = holding.split(barriers, &barriers[row].normal);
        let slope = left.dot(&barriers[row].normal);
        let whole = match holding.count < 3 && slope > NOTHING {
            true => inside_m(&barriers[row]) / slope,
            false => f64::INFINITY,
        };
        // The first that would pull is let go.
        let gone = |&k: &usize| of_rows[k] > 0.0;
        let step_to = |k: usize| holding.parts_m[k] / of_rows[k];
        let first = (0..holding.count)
            .filter(gone)
            .min_by(|&a, &b| step_to(a).total_cmp(&step_to(b)));
        let step = first.map_or(whole, |k| whole.min(step_to(k)));
        if !step.is_finite() {
            return false;
        }
        if whole.is_finite() {
            way += left * step;
        }
        for k in 0..holding.count {
            holding.parts_m[k] -= step * of_rows[k];
        }
        match first.filter(|_| step < whole) {
            Some(k) => {
                holding.drop(k);
                wanted = Some((row, part_m + step));
            }
            None => {
                holding.rows[holding.count] = row;
                holding.parts_m[holding.count] = part_m + step;
                holding.count += 1;
                wanted = None;
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    fn barrier(normal: [f64; 3], depth_m: f64) -> Barrier {
        Barrier {
            normal: Vector3::from(normal).normalize(),
            depth_m,
            part_m: 0.0,
        }
    }

    fn way(barriers: &[Barrier]) -> Vector3 {
        barriers.iter().map(|b| b.normal * b.part_m).sum()
    }

    // The conditions of the optimum: no barrier is passed, none pulls, and those that push are touched.
    #[test]
    fn random_barriers_hold_as_the_optimum_says() {
        let mut random = Random(11);
        for spread in [1.0, 0.1, 1e-3, 1e-5] {
            for _ in 0..2_000 {
                let count = 2 + (random.unit() * 18.0) as usize;
                let mut one = |scale: f64| scale * (2.0 * random.unit() - 1.0);
                let mut barriers: Vec<Barrier> = (0..count)
                    .map(|_| barrier([one(spread), one(spread), 1.0], 1e-3 + one(4e-3)))
                    .collect();
                assert!(hold(&mut barriers));
                let way = way(&barriers);
                for b in &barriers {
                    let inside_m = b.depth_m - b.normal.dot(&way);
                    assert!(b.part_m >= 0.0, "{b:?}");
                    assert!(inside_m < 1e-14, "{inside_m}");
                    assert!(
                        b.part_m == 0.0 || inside_m.abs() < 1e-12,
                        "{inside_m} {b:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn opposite_walls_without_room_hold_nothing() {
        let mut walls = [
            barrier([0.0, 0.0, 1.0], 1e-3),
            barrier([0.0, 0.0, -1.0], 1e-3),
        ];
        assert!(!hold(&mut walls));
        assert!(walls.iter().all(|b| b.part_m == 0.0));
    }

    #[test]
    fn a_hand_that_is_free_is_not_held() {
        let mut gaps = [
            barrier([0.0, 0.0, 1.0], -1e-3),
            barrier([0.0, 1.0, 1.0], 0.0),
        ];
        assert!(hold(&mut gaps));
        assert_eq!(way(&gaps), Vector3::zeros());
    }
}
