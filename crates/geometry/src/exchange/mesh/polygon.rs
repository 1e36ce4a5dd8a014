//! Polygons of mesh files as triangles.
//!
//! ```text
//! corners ── seen along the axis that its normal is nearest to ──▶ a fan from the first corner, where all of it turns the same way
//!                                                              └─▶ else ears, cut off in turn, and compared with each other
//! ```
//! All decisions are those of exact predicates on the coordinates as they stand (Shewchuk, 1997; crate `robust`). Triangles that
//! all turn the polygon's way cover each place as often as the polygon winds round it: if no two of them overlap, they are the
//! polygon. So one that crosses itself has no answer, and bridges to holes (corners that come twice) have the right one. A
//! polygon that is not flat is taken by the same rule: its triangles are those of its picture along that axis.

use crate::math::{Point3, Vector3};
use robust::{Coord, orient2d};

/// Corners of a polygon at most, if it is no fan: ears take time with the square of their number.
const MOST_EARS: usize = 4096;

/// Why a polygon has no triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// Its corners are on a line, or in less than three places.
    Flat,
    /// Its edges cross, or it turns back on itself.
    Crossed,
    /// It is concave with more corners than are looked at.
    Long,
}

impl std::fmt::Display for Flaw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Flat => "enclose no area",
            Self::Crossed => "make edges that cross or turn back on each other",
            Self::Long => "are too many for a polygon that is not convex",
        })
    }
}

/// The triangles of a polygon, by the numbers of its corners. Three corners are one triangle, whatever its area.
pub(super) fn triangles(points: &[Point3], corners: &[u32]) -> Result<Vec<[u32; 3]>, Flaw> {
    if let &[a, b, c] = corners {
        return Ok(vec![[a, b, c]]);
    }
    let place = |corner: u32| points[corner as usize];
    let mut corners = corners.to_vec();
    corners.dedup_by(|a, b| place(*a) == place(*b));
    while corners.len() > 1 && place(corners[0]) == place(corners[corners.len() - 1]) {
        corners.pop();
    }
    let picture =
        picture(&corners.iter().map(|&k| place(k)).collect::<Vec<_>>()).ok_or(Flaw::Flat)?;
    let found = match fan(&picture) {
        Some(fan) => fan,
        None if corners.len() > MOST_EARS => return Err(Flaw::Long),
        None => ears(&picture)
            .filter(|ears| !overlap(&picture, ears))
            .ok_or(Flaw::Crossed)?,
    };
    Ok(found.into_iter().map(|t| t.map(|k| corners[k])).collect())
}

/// Corners along the axis that is nearest to the normal, so that the polygon turns to the left. `None` without a normal.
fn picture(corners: &[Point3]) -> Option<Vec<Coord<f64>>> {
    let first = corners.first()?;
    let normal: Vector3 = corners
        .windows(2)
        .map(|pair| (pair[0] - first).cross(&(pair[1] - first)))
        .sum();
    let axis = normal.iamax();
    let (x, y) = if normal[axis] > 0.0 {
        ((axis + 1) % 3, (axis + 2) % 3)
    } else {
        ((axis + 2) % 3, (axis + 1) % 3)
    };
    (corners.len() > 2 && normal[axis] != 0.0)
        .then(|| corners.iter().map(|p| Coord { x: p[x], y: p[y] }).collect())
}

/// The side of the line from `a` to `b` that `c` is on: positive to the left.
fn side([a, b, c]: [Coord<f64>; 3]) -> f64 {
    orient2d(a, b, c)
}

/// The fan from the first corner; `None` where it is not all of one turn, and at most one round.
fn fan(at: &[Coord<f64>]) -> Option<Vec<[usize; 3]>> {
    let fan: Vec<[usize; 3]> = (1..at.len() - 1).map(|k| [0, k, k + 1]).collect();
    // Seen from its first edge: left of it for half a round, then right of it.
    let mut beyond = at[2..]
        .iter()
        .skip_while(|p| side([at[0], at[1], **p]) > 0.0);
    let one_round = beyond.all(|p| side([at[0], at[1], *p]) <= 0.0);
    (one_round && fan.iter().all(|t| side(t.map(|k| at[k])) > 0.0)).then_some(fan)
}

/// Triangles that are cut off the polygon one by one; `None` where none can be.
fn ears(at: &[Coord<f64>]) -> Option<Vec<[usize; 3]>> {
    let mut left: Vec<usize> = (0..at.len()).collect();
    let mut found = Vec::with_capacity(at.len() - 2);
    // Of each corner that is left, whether it was looked at since its neighbours changed.
    let mut refused = vec![false; at.len()];
    let (mut k, mut in_vain) = (0, 0);
    while left.len() > 2 && in_vain < left.len() {
        let count = left.len();
        k %= count;
        let around = [(k + count - 1) % count, k, (k + 1) % count];
        let ear = around.map(|k| left[k]);
        if refused[ear[1]] || !is_ear(at, &left, around) {
            refused[ear[1]] = true;
            (k, in_vain) = (k + 1, in_vain + 1);
            continue;
        }
        found.push(ear);
        refused[ear[0]] = false;
        refused[ear[2]] = false;
        left.remove(k);
        // Every second corner, so that a round is cut rather than a fan of slivers.
        (k, in_vain) = (k + 1, 0);
    }
    (left.len() == 2).then_some(found)
}

/// Whether the triangle of three corners in turn lies within the polygon `left`.
fn is_ear(at: &[Coord<f64>], left: &[usize], around: [usize; 3]) -> bool {
    let ear = around.map(|k| at[left[k]]);
    let sides = |p: Coord<f64>| [0, 1, 2].map(|k| side([ear[k], ear[(k + 1) % 3], p]));
    let (low, high) = bounds(&ear);
    side(ear) > 0.0
        && (0..left.len()).all(|k| {
            let p = at[left[k]];
            if around.contains(&k) || p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y {
                return true;
            }
            // A corner at the same place may touch, unless an edge goes on from it into the triangle.
            if let Some(same) = ear.iter().position(|corner| *corner == p) {
                let enters = |next: usize| {
                    let next = sides(at[left[next % left.len()]]);
                    next[same] > 0.0 && next[(same + 2) % 3] > 0.0
                };
                return !enters(k + 1) && !enters(k + left.len() - 1);
            }
            sides(p).iter().any(|side| *side < 0.0)
        })
}

fn bounds(corners: &[Coord<f64>; 3]) -> (Coord<f64>, Coord<f64>) {
    let [a, b, c] = *corners;
    let low = Coord {
        x: a.x.min(b.x).min(c.x),
        y: a.y.min(b.y).min(c.y),
    };
    (
        low,
        Coord {
            x: a.x.max(b.x).max(c.x),
            y: a.y.max(b.y).max(c.y),
        },
    )
}

/// Whether two of the triangles, which all turn to the left, have a place in common.
fn overlap(at: &[Coord<f64>], triangles: &[[usize; 3]]) -> bool {
    let mut all: Vec<_> = triangles
        .iter()
        .map(|t| t.map(|k| at[k]))
        .map(|t| (t, bounds(&t)))
        .collect();
    all.sort_by(|a, b| a.1.0.x.total_cmp(&b.1.0.x));
    // Apart by a line along an edge of one of them.
    let beyond = |a: &[Coord<f64>; 3], b: &[Coord<f64>; 3]| {
        (0..3).any(|k| b.iter().all(|p| side([a[k], a[(k + 1) % 3], *p]) <= 0.0))
    };
    all.iter().enumerate().any(|(k, (a, (low, high)))| {
        let near = all[k + 1..]
            .iter()
            .take_while(|(_, others)| others.0.x < high.x);
        near.filter(|(_, others)| others.0.y < high.y && low.y < others.1.y)
            .any(|(b, _)| !beyond(a, b) && !beyond(b, a))
    })
}

#[cfg(test)]
mod tests;
