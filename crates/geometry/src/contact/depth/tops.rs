//! The tops of depth above starts: climbed side by side where the sides of a solid are known, one of each set that a way of
//! equal depth joins.

use super::climb::{ClimbTop, Map};
use super::{
    DepthField, GRID, JUST_BEYOND, MOST_CLIMBS, MOST_CROSSED, MOST_FINISHED, MOST_SIDES, ONE_PLACE,
    SAME, SAME_ROUGHLY, Shortlist,
};
use crate::contact::{Contact, MAX_CONTACTS};
use crate::math::Point3;
use crate::surface::Joints;

/// What is climbed on: a surface, or a face of a part.
pub(in crate::contact) trait Ground {
    /// The point at a place, m.
    fn point(&self, at: [f64; 2]) -> Point3;
}

/// Scratch of climbs, sized once.
#[derive(Clone, Debug)]
pub(in crate::contact) struct Tops {
    pub map: Map,
    /// Of a branching surface.
    pub joints: Option<Box<Joints>>,
    pub size_m: f64,
    /// Between samples, m.
    pub spacing_m: f64,
    /// What was found, deepest starts first.
    pub found: Vec<ClimbTop>,
    /// Where to climb from.
    pub starts: Shortlist<[f64; 2], MOST_CLIMBS>,
}

impl Tops {
    /// Scratch for climbs on a map; lengths in m.
    pub fn new(map: Map, joints: Option<Box<Joints>>, size_m: f64, spacing_m: f64) -> Self {
        Self {
            map,
            joints,
            size_m,
            spacing_m,
            // Finished tops are gathered behind the rough ones.
            found: Vec::with_capacity(MOST_CLIMBS + MAX_CONTACTS),
            starts: Shortlist::new(),
        }
    }

    /// Climbs from the starts that were picked: each on its sides, or on the whole solid.
    pub fn climb_all(
        &mut self,
        by_sides: bool,
        field: &impl DepthField,
        margin_m: f64,
        beside: &[Contact],
        ground: &impl Ground,
    ) {
        let depth = |x: [f64; 2]| field.depth_m(&ground.point(x));
        let level = 1e-3 * SAME * self.size_m;
        for k in 0..self.starts.0.len() {
            let start = self.starts.0[k].1;
            // A start that a level or rising way joins with a top already climbed would end there.
            let here = depth(start);
            let mut known = self
                .found
                .iter()
                .filter(|t| t.height_m >= here)
                .map(|t| (t.at, here - level));
            if known.any(|(at, level)| self.joined(start, at, level, depth)) {
                continue;
            }
            let p = ground.point(start);
            let first = (by_sides.then(|| self.side_below(field, &p, 0))).flatten();
            let Some(first) = first else {
                self.climb_from(start, None, field, margin_m, beside, ground);
                continue;
            };
            // Beside an edge the start stands for the sides that meet there.
            let nearest_m = field.depth_below(first, &p);
            for after in 0..MOST_SIDES {
                let side = self.side_below(field, &p, after);
                let meets =
                    |side: &usize| field.depth_below(*side, &p) - nearest_m < self.spacing_m;
                let Some(side) = side.filter(meets) else {
                    break;
                };
                self.climb_from(start, Some(side), field, margin_m, beside, ground);
            }
        }
    }

    /// Where a climb from a place may go: of a branching surface, over one patch.
    fn map_at(&self, at: [f64; 2]) -> Map {
        self.joints.as_ref().map_or(self.map, |joints| {
            self.map.within(joints.rectangle(joints.patch_at(at)))
        })
    }

    /// No more than samples are from each other.
    fn are_neighbours(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        let way = self.map.way(a, b);
        (0..2).all(|k| way[k].abs() * GRID as f64 <= self.map.spans[k])
    }

    fn is_same(&self, a_m: f64, b_m: f64) -> bool {
        (a_m - b_m).abs() <= SAME * self.size_m
    }

    /// A side below which a climb from a point goes, if it is known.
    fn side_below(&self, field: &impl DepthField, p: &Point3, after: usize) -> Option<usize> {
        // At an edge that runs inwards the solid is deeper than below each of its sides.
        let equal = SAME * self.size_m;
        field
            .side(p, after)
            .filter(|&side| field.depth_m(p) <= field.depth_below(side, p) + equal)
    }

    /// Climbs on a side and keeps what is found.
    fn climb_from(
        &mut self,
        start: [f64; 2],
        side: Option<usize>,
        field: &impl DepthField,
        margin_m: f64,
        beside: &[Contact],
        ground: &impl Ground,
    ) {
        let depth = |x: [f64; 2]| field.depth_m(&ground.point(x));
        let height = |x: [f64; 2]| match side {
            Some(side) => field.depth_below(side, &ground.point(x)),
            None => depth(x),
        };
        let beyond = |x: [f64; 2]| side.is_some() && !self.is_same(height(x), depth(x));
        // Beside a tip a side may be bent more than samples show: from there it is nearer.
        let feet = beside.iter().map(|contact| [contact.u, contact.v]);
        let near = feet
            .filter(|_| side.is_some())
            .filter(|&foot| self.are_neighbours(start, foot) && height(foot) > height(start))
            .max_by(|&a, &b| height(a).total_cmp(&height(b)));
        let from_near = near.and_then(|foot| self.climb(foot, height, beyond));
        let Some(top) = from_near.or_else(|| self.climb(start, height, beyond)) else {
            return;
        };
        if top.height_m >= -margin_m - 1e-3 * SAME * self.size_m {
            self.keep_from(0, top, depth, ground);
        }
    }

    /// Climbs, going on over joints while that leads up; `None`: beyond the edge of a side.
    fn climb(
        &self,
        start: [f64; 2],
        depth: impl Fn([f64; 2]) -> f64,
        beyond: impl Fn([f64; 2]) -> bool,
    ) -> Option<ClimbTop> {
        let climb = |from| self.map_at(from).climb(from, self.size_m, &depth, &beyond);
        let mut top = climb(start)?;
        let Some(joints) = &self.joints else {
            return Some(top);
        };
        for _ in 0..MOST_CROSSED {
            let higher = |x: &[f64; 2]| depth(*x) > top.height_m;
            let Some(next) = joints.just_beyond(top.at, JUST_BEYOND).find(higher) else {
                break;
            };
            let other = climb(next)?;
            if other.height_m <= top.height_m {
                break;
            }
            top = other;
        }
        Some(top)
    }

    /// A straight way of at least a height; between places of two patches there is none.
    fn joined(
        &self,
        a: [f64; 2],
        b: [f64; 2],
        level: f64,
        depth: impl FnMut([f64; 2]) -> f64,
    ) -> bool {
        let apart = self
            .joints
            .as_ref()
            .is_some_and(|joints| joints.patch_at(a) != joints.patch_at(b));
        !apart && self.map.joined(a, b, level, depth)
    }

    /// Keeps a top that no level way joins with one from `first` on; of two that are joined, the
    /// higher.
    fn keep_from(
        &mut self,
        first: usize,
        top: ClimbTop,
        depth: impl Fn([f64; 2]) -> f64,
        ground: &impl Ground,
    ) {
        for k in first..self.found.len() {
            let t = self.found[k];
            let equal = if t.settled && top.settled {
                SAME
            } else {
                SAME_ROUGHLY
            } * self.size_m;
            let level = t.height_m.min(top.height_m) - equal;
            // On a joint a top is found from either side.
            let one_place = || {
                self.joints.is_some()
                    && (ground.point(t.at) - ground.point(top.at)).norm() <= ONE_PLACE * self.size_m
            };
            if (t.height_m - top.height_m).abs() <= equal
                && (self.joined(t.at, top.at, level, &depth) || one_place())
            {
                if top.height_m > t.height_m {
                    self.found[k] = top;
                }
                return;
            }
        }
        self.found.push(top);
    }

    /// What has kinks was climbed coarsely; now that there are few, exactly. Sorted, deepest first, at the end one of each set.
    pub fn finish(&mut self, by_sides: bool, field: &impl DepthField, ground: &impl Ground) {
        let depth = |x: [f64; 2]| field.depth_m(&ground.point(x));
        self.found.sort_unstable_by(|a, b| {
            let place = a.at[0]
                .total_cmp(&b.at[0])
                .then(a.at[1].total_cmp(&b.at[1]));
            b.height_m.total_cmp(&a.height_m).then(place)
        });
        self.found.truncate(MAX_CONTACTS);
        for k in 0..self.found.len().min(MOST_FINISHED) {
            if !self.found[k].settled {
                let mut top = self.found[k];
                let p = ground.point(top.at);
                let side = (by_sides.then(|| self.side_below(field, &p, 0))).flatten();
                self.map_at(top.at)
                    .finish(&mut top, self.size_m, |x| match side {
                        Some(side) => field.depth_below(side, &ground.point(x)),
                        None => depth(x),
                    });
                top.settled = true;
                self.found[k] = top;
            }
        }
        let rough = self.found.len();
        for k in 0..rough {
            let top = self.found[k];
            self.keep_from(rough, top, depth, ground);
        }
        self.found.drain(..rough);
    }
}
