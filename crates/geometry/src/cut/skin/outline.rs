//! The rims of a sheet: closed walks with the sheet on their left, and their sharp corners.

use super::error::PieceSkinError;
use super::fine::{Fine, Lies};
use super::sections::{Net, Rim};
use std::f64::consts::PI;

/// A rim turns by more than this at a corner, rad.
const SHARP: f64 = 0.6;
/// Of a rim's length: corners nearer to each other are one.
const LEAST_SIDE: f64 = 0.008;

/// All rims of a sheet.
pub(super) fn rims(fine: &Fine, net: &Net) -> Result<Vec<Rim>, PieceSkinError> {
    // (corners) The walk goes on along this edge to that corner.
    let mut next: Vec<Option<(u32, u32)>> = vec![None; fine.corners.len()];
    let mut starts = Vec::new();
    for (e, edge) in net.edges.iter().enumerate() {
        let [(t, k), other] = edge.sides;
        if (t, k) != other {
            continue;
        }
        let corners = fine.triangles[t as usize];
        let (from, to) = (corners[k as usize], corners[(k as usize + 1) % 3]);
        if next[from as usize].replace((e as u32, to)).is_some() {
            return Err(PieceSkinError::Pinched);
        }
        starts.push(from);
    }
    let mut rims = Vec::new();
    for start in starts {
        let mut rim = Rim {
            faces: [0; 2],
            edges: Vec::new(),
            corners: Vec::new(),
            length_m: 0.0,
            lies: Lies::Rim,
        };
        let mut at = start;
        while let Some((edge, to)) = next[at as usize].take() {
            rim.edges.push(edge);
            rim.corners.push(at);
            let [p, q] = [at, to].map(|k| fine.corners[k as usize].rest);
            rim.length_m += (q - p).norm();
            at = to;
        }
        match rim.edges.len() {
            0 => {}
            _ if at != start => return Err(PieceSkinError::Pinched),
            1 | 2 => return Err(PieceSkinError::Pinched),
            _ => rims.push(rim),
        }
    }
    Ok(rims)
}

/// A sharp corner of a rim.
#[derive(Clone, Copy)]
pub(super) struct Turn {
    /// In the walk.
    place: usize,
    /// Of the triangles.
    pub corner: u32,
    /// From where the walk begins, m.
    passed_m: f64,
    /// By how much it turns towards the sheet, rad.
    angle: f64,
}

/// The sharp corners of a rim, in the order of the walk.
pub(super) fn sharp_corners(fine: &Fine, rim: &Rim) -> Vec<Turn> {
    let mut turns = sharp(fine, rim, &passed_m(fine, rim));
    while let Some(drop) = crowded(&turns, rim.length_m) {
        turns.remove(drop);
    }
    turns
}

/// Some of them turn towards the sheet, as the corners of a rectangle do.
pub(super) fn has_corners(turns: &[Turn]) -> bool {
    turns.iter().any(|turn| turn.angle > 0.0)
}

/// The places in a walk that are the corners of a rectangle: the sharpest, and middles of the longest sides where there are
/// fewer than four. `None` of a rim without so many places.
pub(super) fn four_corners(fine: &Fine, rim: &Rim, turns: &[Turn]) -> Option<[usize; 4]> {
    let passed = passed_m(fine, rim);
    let mut turns: Vec<Turn> = turns.to_vec();
    turns.sort_by(|a, b| b.angle.total_cmp(&a.angle).then(a.place.cmp(&b.place)));
    let convex = turns.iter().filter(|turn| turn.angle > 0.0).take(4);
    let mut places: Vec<usize> = convex.map(|turn| turn.place).collect();
    if places.is_empty() {
        places.push(turns.last().map_or(0, |turn| turn.place));
    }
    places.sort_unstable();
    while places.len() < 4 {
        let way = |k: usize| {
            let (from, to) = (passed[places[k]], passed[places[(k + 1) % places.len()]]);
            let length = to - from;
            let whole = if length <= 0.0 { rim.length_m } else { 0.0 };
            (from, length + whole)
        };
        let longest = (0..places.len()).max_by(|&a, &b| way(a).1.total_cmp(&way(b).1))?;
        let (from, length) = way(longest);
        let middle = (from + 0.5 * length) % rim.length_m;
        let off = |k: &usize| {
            let off = (passed[*k] - middle).abs();
            off.min(rim.length_m - off)
        };
        let free = (0..rim.corners.len()).filter(|k| !places.contains(k));
        places.push(free.min_by(|a, b| off(a).total_cmp(&off(b)))?);
        places.sort_unstable();
    }
    Some([places[0], places[1], places[2], places[3]])
}

/// Begins the walk at the first of its sharp corners.
pub(super) fn begin_at(rim: &mut Rim, turns: &[Turn]) {
    if let Some(first) = turns.first() {
        rim.corners.rotate_left(first.place);
        rim.edges.rotate_left(first.place);
    }
}

/// Of each corner of a walk from where it begins, m.
fn passed_m(fine: &Fine, rim: &Rim) -> Vec<f64> {
    let mut passed = vec![0.0];
    for pair in rim.corners.windows(2) {
        let [p, q] = [pair[0], pair[1]].map(|k| fine.corners[k as usize].rest);
        passed.push(passed[passed.len() - 1] + (q - p).norm());
    }
    passed
}

fn sharp(fine: &Fine, rim: &Rim, passed: &[f64]) -> Vec<Turn> {
    let mut inside = vec![0.0; fine.corners.len()];
    for (t, corners) in fine.triangles.iter().enumerate() {
        let points = fine.rest(t);
        for k in 0..3 {
            let [a, b] = [1, 2].map(|d| points[(k + d) % 3] - points[k]);
            inside[corners[k] as usize] += libm::atan2(a.cross(&b).norm(), a.dot(&b));
        }
    }
    let turns = rim.corners.iter().enumerate().map(|(place, &corner)| Turn {
        place,
        corner,
        passed_m: passed[place],
        angle: PI - inside[corner as usize],
    });
    turns.filter(|turn| turn.angle.abs() > SHARP).collect()
}

/// The blunter of two corners, in the order of the walk, that are too near to each other.
fn crowded(turns: &[Turn], length_m: f64) -> Option<usize> {
    let count = turns.len();
    let near = |k: &usize| {
        let apart = turns[(k + 1) % count].passed_m - turns[*k].passed_m;
        let apart = if apart < 0.0 { apart + length_m } else { apart };
        apart < LEAST_SIDE * length_m
    };
    let first = (0..count).filter(|_| count > 1).find(near)?;
    let second = (first + 1) % count;
    Some(match turns[first].angle.abs() < turns[second].angle.abs() {
        true => first,
        false => second,
    })
}
