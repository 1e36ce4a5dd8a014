//! Which places are near another.

use palpate_geometry::math::Point3;
use std::collections::BTreeMap;

/// Places by boxes of one size.
pub(super) struct Bins {
    side_m: f64,
    boxes: BTreeMap<[i64; 3], Vec<usize>>,
}

impl Bins {
    /// Of places, by their numbers; the side is above 0.
    pub fn new(side_m: f64, places: impl Iterator<Item = Point3>) -> Self {
        debug_assert!(side_m > 0.0, "boxes have a size");
        let mut bins = Self {
            side_m,
            boxes: BTreeMap::new(),
        };
        for (k, place) in places.enumerate() {
            let key = bins.key(&place);
            bins.boxes.entry(key).or_default().push(k);
        }
        bins
    }

    fn key(&self, place: &Point3) -> [i64; 3] {
        [place.x, place.y, place.z].map(|x| (x / self.side_m).floor() as i64)
    }

    /// Every place within a side of another, and some beyond: by boxes, in each by number.
    pub fn around(&self, place: &Point3, mut out: impl FnMut(usize)) {
        let [x, y, z] = self.key(place);
        for i in x - 1..=x + 1 {
            for j in y - 1..=y + 1 {
                for k in z - 1..=z + 1 {
                    (self.boxes.get(&[i, j, k]).into_iter().flatten()).for_each(|&one| out(one));
                }
            }
        }
    }
}
