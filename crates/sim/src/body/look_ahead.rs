//! Damping by strain rates: the law is asked where its coordinates will be after d ẋ.
//!
//! The force there is f − d K ẋ to first order, that of a Voigt solid, and rigid motion, which the
//! caller takes out, is not damped at all. Far ahead cells would be turned inside out: a coordinate
//! that parts from a neighbour or meets it by more than a share of their distance looks ahead less far.

use super::matter::Matter;
use super::neighbours::adjacent;
use palpate_geometry::math::{Rows, Vector3};

/// Of the distance of two neighbours: how much of it they may part or meet by.
const SHARE: f64 = 0.3;

/// How far damping may look ahead.
#[derive(Debug)]
pub(super) struct LookAhead {
    /// (coordinates): so far nothing can be too far, m.
    safe_m: Vec<f64>,
    /// (coordinates + 1): where the neighbours of each begin.
    starts: Vec<u32>,
    /// A neighbour, and by how much the two may part, m.
    neighbours: Vec<(u32, f64)>,
}

impl LookAhead {
    /// None for a body without damping.
    pub fn new(matter: &Matter) -> Option<Self> {
        if matter.damping_s <= 0.0 {
            return None;
        }
        let (mut safe_m, mut starts, mut neighbours) = (Vec::new(), vec![0], Vec::new());
        for (c, adjacent) in adjacent(matter).into_iter().enumerate() {
            let mut shortest = f64::INFINITY;
            for other in adjacent {
                let length = (matter.rest[other as usize] - matter.rest[c]).norm();
                // Coordinates of nets may stand in one place.
                if length > 0.0 {
                    neighbours.push((other, SHARE * length));
                    shortest = shortest.min(SHARE * length);
                }
            }
            // Both may move, away from each other.
            safe_m.push(0.5 * shortest);
            starts.push(neighbours.len() as u32);
        }
        Some(Self {
            safe_m,
            starts,
            neighbours,
        })
    }

    /// Adds `ahead` (coordinates, m), as far as it may be, to the places in `lanes`.
    pub fn add(&self, ahead: &[Vector3], lanes: &mut Rows) {
        for (c, (way, lane)) in ahead.iter().zip(lanes.iter_mut()).enumerate() {
            let share = self.share(c, ahead);
            for (value, part) in lane.iter_mut().zip(way.iter()) {
                *value += share * part;
            }
        }
    }

    /// How much of its way a coordinate may look ahead.
    fn share(&self, c: usize, ahead: &[Vector3]) -> f64 {
        if ahead[c].norm_squared() <= self.safe_m[c] * self.safe_m[c] {
            return 1.0;
        }
        let neighbours = self.starts[c] as usize..self.starts[c + 1] as usize;
        let mut share: f64 = 1.0;
        for &(other, most_m) in &self.neighbours[neighbours] {
            let parted_m = (ahead[c] - ahead[other as usize]).norm();
            if parted_m * share > most_m {
                share = most_m / parted_m;
            }
        }
        share
    }
}
