//! Which tools and bodies may touch: a dynamic tree of boxes.
//!
//! The tree is parry's; ours are the fat boxes, the swept ones, the order of the answer, and that
//! nothing is allocated after the start. A box that stays inside its fat one costs a comparison;
//! one that leaves is put back into the tree anew.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::glamx::DVec3;
use parry3d_f64::partitioning::{Bvh, TraversalAction};

use crate::math::{Point3, Vector3};
use crate::surface::Bounds;

/// Most boxes of one tree: a tick's worth of pairs has room.
pub const MAX_BOXES: usize = 512;

/// Boxes by number, and the pairs of them that meet.
#[derive(Clone, Debug)]
pub struct BroadPhase {
    tree: Bvh,
    margin_m: f64,
    /// (capacity): the fat box of each number in the tree.
    fat: Vec<Option<Bounds>>,
    pairs: Vec<(u32, u32)>,
}

impl BroadPhase {
    /// Room for the numbers below `capacity` (at most [`MAX_BOXES`]). Boxes are widened by
    /// `margin_m` on each side.
    pub fn new(capacity: usize, margin_m: f64) -> Self {
        let capacity = capacity.min(MAX_BOXES);
        let mut new = Self {
            tree: Bvh::new(),
            margin_m: if margin_m.is_finite() {
                margin_m.max(0.0)
            } else {
                0.0
            },
            fat: vec![None; capacity],
            pairs: Vec::with_capacity(capacity * capacity.saturating_sub(1) / 2),
        };
        // Filled and emptied once: the tree keeps its room.
        for turn in 0..2 {
            for k in 0..capacity as u32 {
                let at = Point3::new(f64::from(k), 0.0, 0.0);
                let _ = if turn == 0 {
                    new.set(k, &Bounds { min: at, max: at }, &Vector3::zeros())
                } else {
                    new.remove(k)
                };
            }
        }
        new
    }

    /// Puts or moves a box, along with the way it is about to go (zero for one that stands). True
    /// if the tree changed. A box that is not finite, or that has no number, is taken out: what has
    /// no place touches nothing.
    pub fn set(&mut self, number: u32, bounds: &Bounds, displacement: &Vector3) -> bool {
        let min = bounds.min.inf(&(bounds.min + displacement));
        let max = bounds.max.sup(&(bounds.max + displacement));
        let whole = (0..3).all(|c| min[c].is_finite() && max[c].is_finite() && min[c] <= max[c]);
        let sound = whole && displacement.iter().all(|x| x.is_finite());
        let Some(slot) = self.fat.get_mut(number as usize) else {
            return false;
        };
        if !sound {
            return self.remove(number);
        }
        if slot.is_some_and(|fat| (0..3).all(|c| fat.min[c] <= min[c] && max[c] <= fat.max[c])) {
            return false;
        }
        let was_in = slot.is_some();
        let wide = Vector3::repeat(self.margin_m);
        let fat = Bounds {
            min: min - wide,
            max: max + wide,
        };
        *slot = Some(fat);
        if was_in {
            self.tree.remove(number);
        }
        self.tree.insert(aabb(&fat), number);
        true
    }

    /// Takes a box out. True if it was in.
    pub fn remove(&mut self, number: u32) -> bool {
        let was_in = self
            .fat
            .get_mut(number as usize)
            .is_some_and(|slot| slot.take().is_some());
        if was_in {
            self.tree.remove(number);
        }
        was_in
    }

    /// All pairs of numbers whose fat boxes meet, in ascending order, the smaller number first.
    pub fn pairs(&mut self) -> &[(u32, u32)] {
        self.pairs.clear();
        let (fat, pairs, tree) = (&self.fat, &mut self.pairs, &self.tree);
        for (k, bounds) in fat.iter().enumerate() {
            let Some(bounds) = bounds else { continue };
            let own = aabb(bounds);
            let k = k as u32;
            let first = pairs.len();
            tree.traverse(|node| {
                let meets =
                    (0..3).all(|c| node.mins()[c] <= own.maxs[c] && own.mins[c] <= node.maxs()[c]);
                if !meets {
                    return TraversalAction::Prune;
                }
                if let Some(other) = node.leaf_data().filter(|other| *other > k) {
                    pairs.push((k, other));
                }
                TraversalAction::Continue
            });
            pairs[first..].sort_unstable();
        }
        pairs
    }
}

fn aabb(bounds: &Bounds) -> Aabb {
    Aabb::new(
        DVec3::new(bounds.min.x, bounds.min.y, bounds.min.z),
        DVec3::new(bounds.max.x, bounds.max.y, bounds.max.z),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::testing::Random;

    fn meets(a: &Bounds, b: &Bounds) -> bool {
        (0..3).all(|c| a.min[c] <= b.max[c] && b.min[c] <= a.max[c])
    }

    #[test]
    fn every_pair_that_meets_is_named_and_only_fat_boxes_that_meet() {
        let mut random = Random(21);
        let mut vector = |s: f64| {
            Vector3::new(
                random.float(-s, s),
                random.float(-s, s),
                random.float(-s, s),
            )
        };
        let n = 60;
        let margin = 0.05;
        let mut broad = BroadPhase::new(n, margin);
        assert!(broad.pairs().is_empty());
        let mut at: Vec<Vector3> = (0..n).map(|_| vector(1.0)).collect();
        let half: Vec<Vector3> = (0..n).map(|_| vector(0.15).abs()).collect();
        let mut named = 0;
        for step in 0..300 {
            let moves: Vec<Vector3> = (0..n)
                .map(|k| vector(if k % 7 == 0 { 0.3 } else { 0.01 }))
                .collect();
            let gone = |k: usize| (k + step / 20).is_multiple_of(11);
            let mut swept = vec![];
            for k in 0..n {
                let now = Bounds {
                    min: (at[k] - half[k]).into(),
                    max: (at[k] + half[k]).into(),
                };
                if gone(k) {
                    broad.remove(k as u32);
                } else {
                    broad.set(k as u32, &now, &moves[k]);
                }
                swept.push(Bounds {
                    min: now.min.inf(&(now.min + moves[k])),
                    max: now.max.sup(&(now.max + moves[k])),
                });
                at[k] += moves[k];
            }
            let pairs = broad.pairs().to_vec();
            assert!(pairs.is_sorted() && pairs.windows(2).all(|w| w[0] != w[1]));
            for a in 0..n {
                for b in a + 1..n {
                    let has = pairs.contains(&(a as u32, b as u32));
                    let must = !gone(a) && !gone(b) && meets(&swept[a], &swept[b]);
                    assert!(
                        has || !must,
                        "step {step}: {a} and {b} meet and are not named"
                    );
                    let fat = [a, b].map(|k| broad.fat[k]);
                    assert_eq!(
                        has,
                        matches!(fat, [Some(p), Some(q)] if meets(&p, &q)),
                        "step {step}: {a} {b}"
                    );
                }
            }
            named += pairs.len();
        }
        assert!(named > 1000, "{named}");
    }

    #[test]
    fn boxes_that_are_not_finite_or_have_no_number_are_not_there() {
        let mut broad = BroadPhase::new(2, 0.1);
        let unit = Bounds {
            min: Point3::origin(),
            max: Point3::new(1.0, 1.0, 1.0),
        };
        assert!(broad.set(0, &unit, &Vector3::zeros()) && broad.set(1, &unit, &Vector3::zeros()));
        assert_eq!(broad.pairs(), [(0, 1)]);
        assert!(!broad.set(7, &unit, &Vector3::zeros()));
        assert!(broad.set(
            1,
            &Bounds {
                min: Point3::new(f64::NAN, 0.0, 0.0),
                ..unit
            },
            &Vector3::zeros()
        ));
        assert!(broad.pairs().is_empty());
        assert!(!broad.set(1, &unit, &Vector3::new(f64::INFINITY, 0.0, 0.0)));
        assert!(broad.pairs().is_empty());
    }
}
