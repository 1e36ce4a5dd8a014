//! Marching along a curve of intersection.
//!
//! A chord of length h whose ends turn by θ misses a smooth curve by about h θ / 8: that decides
//! how long steps are. Steps that would pass a crease are cut there.

use super::join::{CurvePlace, JoinedCurve, Lost};
use crate::math::Point3;

/// Most a curve turns in one step, rad.
const MOST_TURN: f64 = 0.35;
/// Steps shorter than this, relative to the size, lead nowhere.
const SHORTEST: f64 = 1e-9;
const MOST_PLACES: usize = 20_000;

/// How a march ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    Closed,
    /// At an open edge.
    Edge,
    /// Where the surfaces become tangent, or work was spent.
    Lost,
}

/// Places from `start` on, itself first; `sense` −1 goes against the curve's direction.
pub(super) fn march(
    joined: &mut JoinedCurve<'_>,
    start: &CurvePlace,
    sense: f64,
    tolerance_m: f64,
) -> (Vec<CurvePlace>, End) {
    let shortest = SHORTEST * joined.size_m;
    let mut places = vec![*start];
    let mut h = 0.1 * start.reach_m;
    while places.len() < MOST_PLACES && !joined.spent() {
        let here = places[places.len() - 1];
        h = h.min(here.reach_m);
        // False for NaN.
        let goes = h > shortest;
        if !goes {
            return (places, End::Lost);
        }
        let before = joined.work();
        let target = here.point + here.way * (sense * h);
        match joined.correct(here.at, &target, &here.way) {
            Ok(next) => {
                let miss = miss(&here, &next, sense);
                if let Some(missed_m) = miss.filter(|m| *m <= 0.5 * tolerance_m) {
                    if let Some(drop) = closes(joined, &places, &next, sense, tolerance_m) {
                        places.truncate(places.len() - drop);
                        return (places, End::Closed);
                    }
                    places.push(next);
                    joined.earned(before);
                    // Half of what is allowed, next time.
                    let growth = (0.25 * tolerance_m / missed_m.max(1e-3 * tolerance_m)).sqrt();
                    h *= growth.clamp(0.5, 2.0);
                    continue;
                }
                if let Some(crease) = crease(joined, &here, &next, sense, tolerance_m) {
                    if (crease.point - here.point).norm() > shortest {
                        places.push(crease);
                    }
                    if (next.point - crease.point).norm() > shortest {
                        places.push(next);
                    }
                    continue;
                }
            }
            Err(Lost::Left { side, d, value }) => {
                if let Some(at) = joined.pierce(side, d, value, here.at) {
                    let edge = joined.place(at);
                    let way = edge.map(|e| e.point - here.point);
                    let reached = way.is_some_and(|w| {
                        w.norm() <= 2.0 * h && w.dot(&here.way) * sense >= -shortest
                    });
                    if let Some(edge) =
                        edge.filter(|e| reached && small(&here, e, sense, tolerance_m, shortest))
                    {
                        if (edge.point - here.point).norm() > shortest {
                            places.push(edge);
                        }
                        return (places, End::Edge);
                    }
                }
            }
            Err(Lost::Nowhere) => {}
        }
        h *= 0.4;
    }
    (places, End::Lost)
}

fn small(
    here: &CurvePlace,
    next: &CurvePlace,
    sense: f64,
    tolerance_m: f64,
    shortest: f64,
) -> bool {
    (next.point - here.point).norm() <= shortest
        || miss(here, next, sense).is_some_and(|missed_m| missed_m <= 0.5 * tolerance_m)
}

/// By how much the chord between two places misses the curve, m; none when the second is no place
/// to go to.
fn miss(here: &CurvePlace, next: &CurvePlace, sense: f64) -> Option<f64> {
    let chord = next.point - here.point;
    let length = chord.norm();
    let unit = chord.try_normalize(0.0)? * sense;
    // Sines serve as angles; both ends also turn against the chord, by half as much where the curve
    // is an arc.
    let turn = here.way.cross(&next.way).norm();
    let ends = unit
        .cross(&here.way)
        .norm()
        .max(unit.cross(&next.way).norm());
    let forward = here.way.dot(&next.way) > 0.0 && here.way.dot(&unit) > 0.0;
    let turn = turn.max(2.0 * ends);
    (forward && turn <= MOST_TURN).then_some(length * turn / 8.0)
}

/// The step to `next` passes the first place again: how many of the last places are to go.
fn closes(
    joined: &mut JoinedCurve<'_>,
    places: &[CurvePlace],
    next: &CurvePlace,
    sense: f64,
    tolerance_m: f64,
) -> Option<usize> {
    let (start, here) = (&places[0], &places[places.len() - 1]);
    if places.len() < 3 {
        return None;
    }
    let (from, to) = (
        (start.point - here.point).dot(&here.way) * sense,
        (next.point - start.point).dot(&next.way) * sense,
    );
    let chord = next.point - here.point;
    let same = 1e-8 * joined.size_m;
    if from < -same || to < -same || start.way.dot(&here.way) < 0.5 {
        return None;
    }
    let away = (start.point - here.point)
        - chord * ((start.point - here.point).dot(&chord) / chord.norm_squared());
    if away.norm() > 2.0 * tolerance_m + same
        || (start.point - here.point).norm() > 1.5 * chord.norm() + same
    {
        return None;
    }
    let there = joined.correct(here.at, &start.point, &start.way).ok()?;
    let arrived = (there.point - start.point).norm() <= same;
    arrived.then_some(usize::from((start.point - here.point).norm() <= same))
}

/// A step that turns too far because a crease lies in it: the place on the crease.
fn crease(
    joined: &mut JoinedCurve<'_>,
    here: &CurvePlace,
    next: &CurvePlace,
    sense: f64,
    tolerance_m: f64,
) -> Option<CurvePlace> {
    let shortest = SHORTEST * joined.size_m;
    for side in 0..2 {
        for d in 0..2 {
            let (x, y) = (here.at[2 * side + d], next.at[2 * side + d]);
            let cells = joined.cells[side];
            let (start, end) = (cells.lines[d][0], cells.lines[d][cells.counts[d]]);
            let around = cells.wraps[d] && (x - y).abs() > 0.5 * (end - start);
            for k in 0..cells.walls(d).len() {
                let wall = cells.walls(d)[k];
                let between = if around {
                    wall == start || wall == end
                } else {
                    (x <= wall && wall <= y) || (y <= wall && wall <= x)
                };
                if !between {
                    continue;
                }
                // Around a seam: on this side of it.
                let value = if around {
                    if x > 0.5 * (start + end) { end } else { start }
                } else {
                    wall
                };
                let Some(at) = joined.pierce(side, d, value, here.at) else {
                    continue;
                };
                let Some(there) = joined.place(at) else {
                    continue;
                };
                if straight(
                    &here.point,
                    &here.way,
                    &there.point,
                    sense,
                    tolerance_m,
                    shortest,
                ) && straight(
                    &next.point,
                    &next.way,
                    &there.point,
                    -sense,
                    tolerance_m,
                    shortest,
                ) {
                    return Some(there);
                }
            }
        }
    }
    None
}

/// The way from a place to a crease is as straight as chords are to be; its own direction there is
/// of either side.
fn straight(
    from: &Point3,
    way: &crate::math::Vector3,
    to: &Point3,
    sense: f64,
    tolerance_m: f64,
    shortest: f64,
) -> bool {
    let chord = to - from;
    let length = chord.norm();
    if length <= shortest {
        return true;
    }
    let turn = 2.0 * chord.cross(way).norm() / length;
    chord.dot(way) * sense > 0.0 && turn <= MOST_TURN && length * turn / 8.0 <= 0.5 * tolerance_m
}
