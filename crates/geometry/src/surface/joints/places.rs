//! Places on patches: over edges, round the points where edges meet.

use super::{Edge, Joined, Joints, Strip};

/// Most places that meet in a point and are looked at.
const MOST_MEETING: usize = 16;

/// A place: spans of positive length, and parameters in them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spot {
    pub i: usize,
    pub j: usize,
    pub u: f64,
    pub v: f64,
}

impl Joints {
    /// The patch of two spans.
    pub(crate) fn patch_of(&self, spans: [usize; 2]) -> Option<usize> {
        let find = |d: usize| {
            self.strips[d]
                .iter()
                .position(|s| s.spans.contains(&spans[d]))
        };
        Some(find(0)? * self.strips[1].len() + find(1)?)
    }

    /// The last spans, u and v, of the patch that holds two.
    pub(crate) fn last_spans(&self, spans: [usize; 2]) -> [usize; 2] {
        self.patch_of(spans).map_or([usize::MAX; 2], |patch| {
            self.strips_of(patch).map(|s| s.spans.end - 1)
        })
    }

    /// The patch of a parameter pair; on an edge the one that starts there.
    pub(crate) fn patch_at(&self, at: [f64; 2]) -> usize {
        let strip = |d: usize| {
            self.strips[d]
                .partition_point(|s| s.range[0] <= at[d])
                .max(1)
                - 1
        };
        strip(0) * self.strips[1].len() + strip(1)
    }

    /// Parameters of a patch such that each is seen on it: its upper ends from just below, but for
    /// the domain's.
    pub(crate) fn rectangle(&self, patch: usize) -> [[f64; 2]; 2] {
        let strips = self.strips_of(patch);
        [0, 1].map(|d| {
            let [a, b] = strips[d].range;
            let last = self.strips[d].last().is_some_and(|s| s.range[1] == b);
            [a, if last { b } else { b.next_down() }]
        })
    }

    /// The edges of its patch on which a place lies.
    pub(crate) fn edges_at(&self, at: Spot) -> [bool; 4] {
        let Some(patch) = self.patch_of([at.i, at.j]) else {
            return [false; 4];
        };
        let [u, v] = self.strips_of(patch);
        [
            at.u <= u.range[0],
            at.u >= u.range[1],
            at.v <= v.range[0],
            at.v >= v.range[1],
        ]
    }

    /// The places on the other side of an edge, from a place on it: each patch that is joined
    /// there, none that is a duplicate. No allocation.
    pub(crate) fn beyond(&self, at: Spot, side: usize) -> impl Iterator<Item = (Spot, usize)> + '_ {
        let patch = self.patch_of([at.i, at.j]);
        let joined = patch.map_or(&[] as &[Joined], |patch| {
            self.joined[4 * patch + side].as_slice()
        });
        let share = patch.map_or(0.0, |patch| self.share_along(patch, side, at));
        joined.iter().map(move |other| {
            (
                self.spot(other.edge, if other.against { 1.0 - share } else { share }),
                other.edge.side,
            )
        })
    }

    /// Where the edge of a patch that is nearest to a parameter pair is joined to another: there,
    /// just inside, and on which of its sides.
    pub(crate) fn beyond_side(
        &self,
        patch: usize,
        side: usize,
        at: [f64; 2],
    ) -> Option<([f64; 2], usize)> {
        let spans = self.strips_of(patch).map(|s| s.spans.start);
        let here = Spot {
            i: spans[0],
            j: spans[1],
            u: at[0],
            v: at[1],
        };
        let (spot, side) = self.beyond(here, side).next()?;
        let rectangle = self.rectangle(self.patch_of([spot.i, spot.j])?);
        let x = [spot.u, spot.v];
        Some((
            [0, 1].map(|d| x[d].clamp(rectangle[d][0], rectangle[d][1])),
            side,
        ))
    }

    /// Places just beyond the edges of its patch on which a parameter pair lies, a share of the
    /// strips inside.
    pub(crate) fn just_beyond(
        &self,
        at: [f64; 2],
        share: f64,
    ) -> impl Iterator<Item = [f64; 2]> + '_ {
        let patch = self.patch_at(at);
        let [u, v] = self.rectangle(patch);
        let on = [at[0] <= u[0], at[0] >= u[1], at[1] <= v[0], at[1] >= v[1]];
        let spans = self.strips_of(patch).map(|s| s.spans.start);
        let here = Spot {
            i: spans[0],
            j: spans[1],
            u: at[0],
            v: at[1],
        };
        (0..4)
            .filter(move |&side| on[side])
            .flat_map(move |side| self.beyond(here, side))
            .map(move |(spot, side)| {
                let patch = self.patch_of([spot.i, spot.j]).unwrap_or(0);
                let [a, b] = self.strips_of(patch)[side / 2].range;
                let inward = if side.is_multiple_of(2) {
                    share
                } else {
                    -share
                } * (b - a);
                let rectangle = self.rectangle(patch);
                let mut x = [spot.u, spot.v];
                x[side / 2] += inward;
                [0, 1].map(|d| x[d].clamp(rectangle[d][0], rectangle[d][1]))
            })
    }

    /// The place of an edge of a patch that is nearest, in parameters, to one in the patch.
    pub(crate) fn on_edge(&self, patch: usize, side: usize, at: Spot) -> Spot {
        self.spot(Edge { patch, side }, self.share_along(patch, side, at))
    }

    fn share_along(&self, patch: usize, side: usize, at: Spot) -> f64 {
        let along = 1 - side / 2;
        let [a, b] = self.strips_of(patch)[along].range;
        ((if along == 0 { at.u } else { at.v } - a) / (b - a)).clamp(0.0, 1.0)
    }

    /// Ways over an edge to another patch: straight on from a place of the edge, straight to a
    /// place of that patch, and in between. Each is a place of the edge on either side. No
    /// allocation.
    pub(crate) fn crossings(
        &self,
        from: Spot,
        side: usize,
        to: usize,
        target: Spot,
    ) -> impl Iterator<Item = [Spot; 2]> + '_ {
        let patch = self.patch_of([from.i, from.j]).unwrap_or(0);
        let own = self.share_along(patch, side, from);
        self.joined[4 * patch + side]
            .iter()
            .filter(move |other| other.edge.patch == to)
            .flat_map(move |other| {
                let turned = |share: f64| if other.against { 1.0 - share } else { share };
                let there = turned(self.share_along(to, other.edge.side, target));
                [own, there, 0.5 * (own + there)].map(|share| {
                    [
                        self.spot(Edge { patch, side }, share),
                        self.spot(other.edge, turned(share)),
                    ]
                })
            })
    }

    /// A place on an edge.
    pub(super) fn spot(&self, edge: Edge, share: f64) -> Spot {
        let strips = self.strips_of(edge.patch);
        let held = edge.side / 2;
        let mut spans = [0; 2];
        let mut x = [0.0; 2];
        for d in 0..2 {
            let Strip {
                range: [a, b],
                spans: of,
                inner,
                ..
            } = strips[d];
            if d == held {
                let end = edge.side % 2 == 1;
                (spans[d], x[d]) = if end {
                    (of.end - 1, *b)
                } else {
                    (of.start, *a)
                };
            } else {
                let before = distinct_below(inner, share);
                spans[d] = (of.start + before).min(of.end - 1);
                x[d] = if share <= 0.0 {
                    *a
                } else if share >= 1.0 {
                    *b
                } else {
                    a + share * (b - a)
                };
            }
        }
        Spot {
            i: spans[0],
            j: spans[1],
            u: x[0],
            v: x[1],
        }
    }

    /// Runs round a place: all places of the surface at the same point that edges join, the given
    /// one first. No allocation.
    pub(crate) fn meeting(&self, at: Spot) -> Meeting {
        let mut all = Meeting {
            spots: [at; MOST_MEETING],
            count: 1,
        };
        let mut next = 0;
        while next < all.count {
            let here = all.spots[next];
            next += 1;
            for (side, on) in self.edges_at(here).into_iter().enumerate() {
                if !on {
                    continue;
                }
                for (spot, _) in self.beyond(here, side) {
                    let patch = self.patch_of([spot.i, spot.j]);
                    let known = all.spots[..all.count].iter().any(|s| {
                        self.patch_of([s.i, s.j]) == patch
                            && self.edges_at(*s) == self.edges_at(spot)
                    });
                    if !known && all.count < MOST_MEETING {
                        all.spots[all.count] = spot;
                        all.count += 1;
                    }
                }
            }
        }
        all
    }
}

/// Places at one point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meeting {
    spots: [Spot; MOST_MEETING],
    count: usize,
}

impl Meeting {
    pub fn spots(&self) -> &[Spot] {
        &self.spots[..self.count]
    }
}

/// Distinct values up to a share.
fn distinct_below(inner: &[f64], share: f64) -> usize {
    let mut count = 0;
    let mut last = f64::NAN;
    for &x in inner.iter().take_while(|&&x| x <= share) {
        count += usize::from(x != last);
        last = x;
    }
    count
}
