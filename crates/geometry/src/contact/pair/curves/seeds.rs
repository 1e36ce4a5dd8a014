//! Places to start from, at least one on every curve.
//!
//! A line of cells and a cell are halved until the line's tangents all pass through the cell's
//! tangent planes to one side: then it pierces the cell once at most, and Newton's method finds
//! where.

use super::super::cells::Cells;
use super::super::cone::Cone;
use super::super::facing::{Half, face};
use super::join::JoinedCurve;
use super::parts::{CurvePart, boxed, halves, parted, passes_once, projected, range};
use crate::math::Vector3;

/// Pairs of cells that may cross.
const MOST_PAIRS: usize = 1 << 14;
/// Parts of one line against one cell looked at, first and when all lines have had their turn; and
/// of all lines.
const FIRST_PARTS: usize = 40;
const MOST_PARTS: usize = 400;
const ALL_PARTS: usize = 6_000;
/// Halvings after which Newton's method is believed without proof that there is one crossing only.
const TRUSTED: u32 = 9;
const DEEPEST: u32 = 21;
/// Stationary pairs that loops are looked for around.
const MOST_STATIONARY: usize = 48;
/// Halvings of the distance that lines from a stationary pair are followed to: a loop may be a
/// millionth of a cell.
const RAY_STEPS: i32 = 20;

/// A place on a curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seed {
    /// (u, v) on the first surface, (s, t) on the second.
    pub at: [f64; 4],
    /// An open edge of either surface.
    pub edge: bool,
    /// On a crease or an end, where the curve may turn.
    wall: bool,
}

/// A line of one surface's cells: parameter `d` of surface `side` is `value`.
#[derive(Clone, Copy)]
struct Line {
    side: usize,
    d: usize,
    value: f64,
}

/// One of the lines around a cell: parameter `d` at its low or high end.
#[derive(Clone, Copy)]
struct CellSide {
    cell: usize,
    /// Row and column of the cell.
    place: [usize; 2],
    d: usize,
    high: bool,
}

/// Points of all touched cells of one surface.
struct SeedPoints {
    /// First point of each cell.
    first: Vec<usize>,
    all: Vec<[f64; 4]>,
    /// The points of `all`, projected.
    flat: Vec<[f64; 3]>,
    size: usize,
}

impl SeedPoints {
    fn of(&self, cell: usize) -> &[[f64; 4]] {
        &self.all[self.first[cell]..self.first[cell] + self.size]
    }

    fn flat(&self, cell: usize) -> &[[f64; 3]] {
        &self.flat[self.first[cell]..self.first[cell] + self.size]
    }
}

/// Seeds: those on open edges first, those on creases last.
pub(super) fn seeds(joined: &mut JoinedCurve<'_>) -> Vec<Seed> {
    let points = [0, 1].map(|side| {
        let cells = joined.cells[side];
        let [p, q] = cells.degrees();
        let mut points = SeedPoints {
            first: vec![0; cells.cell_count()],
            all: vec![],
            flat: vec![],
            size: (p + 1) * (q + 1),
        };
        for cell in 0..cells.cell_count() {
            if cells.touched[cell] {
                points.first[cell] = points.all.len();
                cells.points_of(joined.solvers[side].pieces_now(), cell, &mut points.all);
            }
        }
        points.flat = projected(&points.all);
        points
    });
    let pairs = near(joined, &points);
    let mut found = vec![];
    pierced(joined, &points, &pairs, &mut found);
    rays(joined, &pairs, &mut found);
    let rank = |s: &Seed| if s.edge { 0 } else { 1 + u8::from(s.wall) };
    found.sort_by_key(rank);
    found
}

/// Pairs of cells that no plane across either's mean normal parts.
fn near(joined: &JoinedCurve<'_>, points: &[SeedPoints; 2]) -> Vec<(usize, usize)> {
    let [a, b] = joined.cells;
    let margin = 1e-12 * joined.size_m;
    let mut pairs = vec![];
    for x in (0..a.cell_count()).filter(|&x| a.touched[x]) {
        for y in (0..b.cell_count()).filter(|&y| b.touched[y]) {
            if !a.box_of(x).meets(b.box_of(y), margin) {
                continue;
            }
            let (p, q) = (points[0].flat(x), points[1].flat(y));
            let part = |axis: &Vector3| parted(range(p, axis), range(q, axis), margin);
            if !part(&a.cone_of(x).axis) && !part(&b.cone_of(y).axis) && pairs.len() < MOST_PAIRS {
                pairs.push((x, y));
            }
        }
    }
    pairs
}

/// Where lines of cells pierce cells of the other surface.
fn pierced(
    joined: &mut JoinedCurve<'_>,
    points: &[SeedPoints; 2],
    pairs: &[(usize, usize)],
    found: &mut Vec<Seed>,
) {
    let mut left = ALL_PARTS;
    let mut again = vec![];
    for &(x, y) in pairs {
        for (side, own, other) in [(0, x, y), (1, y, x)] {
            let cells = joined.cells[side];
            let columns = cells.counts[1];
            let place = [own / columns, own % columns];
            for d in 0..2 {
                let last = place[d] + 1 == cells.counts[d];
                for high in [false, true] {
                    // The upper line of a cell is the lower one of the next.
                    let end = if high { last && !cells.wraps[d] } else { true };
                    let pole = if high {
                        cells.poles[d][1]
                    } else {
                        place[d] == 0 && cells.poles[d][0]
                    };
                    if !end || pole {
                        continue;
                    }
                    let line = Line {
                        side,
                        d,
                        value: cells.lines[d][place[d] + usize::from(high)],
                    };
                    let of = CellSide {
                        cell: own,
                        place,
                        d,
                        high,
                    };
                    let start = whole(joined, points, side, of, other);
                    let done = halve(joined, line, start, FIRST_PARTS, &mut left, found);
                    if !done {
                        again.push((line, of, other));
                    }
                }
            }
        }
    }
    for (line, of, other) in again {
        let start = whole(joined, points, line.side, of, other);
        halve(joined, line, start, MOST_PARTS, &mut left, found);
    }
}

/// One side of a cell of surface `side` against a cell of the other surface.
fn whole(
    joined: &JoinedCurve<'_>,
    points: &[SeedPoints; 2],
    side: usize,
    of: CellSide,
    other: usize,
) -> CurvePart {
    let (cells, others) = (joined.cells[side], joined.cells[1 - side]);
    let (points, sheet) = (points[side].of(of.cell), &points[1 - side]);
    let CellSide { place, d, high, .. } = of;
    let [p, q] = cells.degrees();
    let curve = if d == 0 {
        let row = if high { p * (q + 1) } else { 0 };
        points[row..=row + q].to_vec()
    } else {
        (0..=p)
            .map(|k| points[k * (q + 1) + if high { q } else { 0 }])
            .collect()
    };
    let along = &cells.lines[1 - d];
    let (middle, wide) = others.middle(other);
    CurvePart {
        curve,
        range: [along[place[1 - d]], along[place[1 - d] + 1]],
        sheet: sheet.of(other).to_vec(),
        rectangle: [0, 1].map(|c| [middle[c] - 0.5 * wide[c], middle[c] + 0.5 * wide[c]]),
        depth: 0,
    }
}

/// Halves until every part is empty or has its crossing. False when parts are left.
fn halve(
    joined: &mut JoinedCurve<'_>,
    line: Line,
    start: CurvePart,
    most: usize,
    left: &mut usize,
    found: &mut Vec<Seed>,
) -> bool {
    let degrees = joined.cells[1 - line.side].degrees();
    let rational = joined.surfaces[1 - line.side].weights().is_some();
    let margin = 1e-12 * joined.size_m;
    let mut stack = vec![start];
    let mut looked = 0;
    while let Some(part) = stack.pop() {
        let (curve, sheet) = (projected(&part.curve), projected(&part.sheet));
        if !boxed(&curve).meets(&boxed(&sheet), margin) {
            continue;
        }
        looked += 1;
        if looked > most || *left == 0 {
            return false;
        }
        *left -= 1;
        let cone = Cone::of_normals(&sheet, degrees[0], degrees[1], false, rational);
        if parted(range(&curve, &cone.axis), range(&sheet, &cone.axis), margin) {
            continue;
        }
        let proved = passes_once(&curve, &cone);
        if (proved || part.depth >= TRUSTED)
            && let Some(at) = newton(joined, line, &part)
        {
            let inside = holds(joined, line, &part, &at, 1e-9);
            if inside {
                found.push(seed(joined, at));
            }
            // Proved to be the only one here; or it is another part's.
            if inside || (proved && !holds(joined, line, &part, &at, 0.5)) || part.depth >= TRUSTED
            {
                continue;
            }
        }
        if part.depth < DEEPEST {
            let [a, b] = halves(part, degrees);
            stack.push(b);
            stack.push(a);
        }
    }
    true
}

fn newton(joined: &mut JoinedCurve<'_>, line: Line, part: &CurvePart) -> Option<[f64; 4]> {
    let (own, other) = (2 * line.side, 2 * (1 - line.side));
    let mut at = [0.0; 4];
    at[own + 1 - line.d] = 0.5 * (part.range[0] + part.range[1]);
    for c in 0..2 {
        at[other + c] = 0.5 * (part.rectangle[c][0] + part.rectangle[c][1]);
    }
    joined.pierce(line.side, line.d, line.value, at)
}

/// A place lies in a part, widened by a share of its widths.
fn holds(
    joined: &JoinedCurve<'_>,
    line: Line,
    part: &CurvePart,
    at: &[f64; 4],
    share: f64,
) -> bool {
    let within = |side: usize, d: usize, [low, high]: [f64; 2]| {
        let cells = joined.cells[side];
        let period = cells.lines[d][cells.counts[d]] - cells.lines[d][0];
        let mut off = (at[2 * side + d] - 0.5 * (low + high)).abs();
        if cells.wraps[d] {
            off = off.min(period - off);
        }
        off <= (0.5 + share) * (high - low) + 1e-12 * period
    };
    within(line.side, 1 - line.d, part.range)
        && (0..2).all(|c| within(1 - line.side, c, part.rectangle[c]))
}

fn seed(joined: &JoinedCurve<'_>, at: [f64; 4]) -> Seed {
    let any = |test: fn(&Cells, f64, f64) -> bool| {
        (0..2).any(|k| test(joined.cells[k], at[2 * k], at[2 * k + 1]))
    };
    Seed {
        at,
        edge: any(Cells::on_open_edge),
        wall: any(Cells::wall),
    }
}

/// Crossings on lines away from stationary pairs of places: every loop inside a pair of cells goes
/// around one.
fn rays(joined: &mut JoinedCurve<'_>, pairs: &[(usize, usize)], found: &mut Vec<Seed>) {
    let mut stationary: Vec<([f64; 4], usize)> = vec![];
    for &(x, y) in pairs {
        let (a, b) = (joined.cells[0], joined.cells[1]);
        let (ca, cb) = (*a.cone_of(x), *b.cone_of(y));
        let turned = Cone {
            axis: -cb.axis,
            ..cb
        };
        if !(ca.may_face(&cb) || ca.may_face(&turned)) {
            continue;
        }
        let ((am, aw), (bm, bw)) = (a.middle(x), b.middle(y));
        let [a, b] = [0, 1].map(|k| Half {
            surface: joined.surfaces[k],
            pieces: joined.solvers[k].pieces_now(),
        });
        let Some(pair) = face(a, b, [am, bm], [aw, bw]) else {
            continue;
        };
        let wide = [aw[0], aw[1], bw[0], bw[1]];
        let same = |(other, _): &([f64; 4], usize)| {
            (0..4).all(|k| (other[k] - pair.at[k]).abs() < 1e-6 * wide[k])
        };
        if stationary.len() < MOST_STATIONARY && !stationary.iter().any(same) {
            stationary.push((pair.at, x));
        }
    }
    for (at, cell) in stationary {
        let (a, b) = (joined.frame(0, at), joined.frame(1, at));
        if (a.point - b.point).norm() > joined.cells[0].box_of(cell).diagonal() {
            continue;
        }
        for d in 0..2 {
            for sense in [1.0, -1.0] {
                ray(joined, at, d, sense, found);
            }
        }
    }
}

/// Follows parameter `d` of the first surface from a stationary pair until it passes the second
/// surface.
fn ray(joined: &mut JoinedCurve<'_>, from: [f64; 4], d: usize, sense: f64, found: &mut Vec<Seed>) {
    let cells = joined.cells[0];
    let (_, wide) = cells.middle(cells.cell_at(from[0], from[1]));
    let mut foot = [from[2], from[3]];
    let mut last: Option<(f64, f64)> = None;
    let sound =
        |joined: &mut JoinedCurve<'_>, r: f64, foot: &mut [f64; 2]| -> Option<([f64; 2], f64)> {
            let mut step = [0.0; 2];
            step[d] = sense * r;
            let at = cells.moved([from[0], from[1]], step);
            if at[1 - d] != from[1 - d] || (r > 0.0 && at[d] == from[d]) {
                return None;
            }
            let point = joined.solvers[0]
                .frame_at(joined.surfaces[0], at[0], at[1])
                .point;
            let near = joined.solvers[1]
                .near_from(joined.surfaces[1], &point, foot[0], foot[1])
                .at;
            *foot = [near.u, near.v];
            (!joined.cells[1].on_open_edge(near.u, near.v)).then_some((at, near.signed_distance))
        };
    for k in 0..=RAY_STEPS {
        let r = if k == 0 {
            0.0
        } else {
            1.5 * wide[d] * 0.5_f64.powi(RAY_STEPS - k)
        };
        let Some((_, value)) = sound(joined, r, &mut foot) else {
            return;
        };
        // A place that touches has no side.
        if value.abs() <= 1e-13 * joined.size_m {
            continue;
        }
        if let Some((low, side)) = last
            && (side > 0.0) != (value > 0.0)
        {
            let (mut low, mut high) = (low, r);
            let mut middle = from;
            for _ in 0..8 {
                let m = 0.5 * (low + high);
                let Some((at, x)) = sound(joined, m, &mut foot) else {
                    return;
                };
                (middle[0], middle[1], middle[2], middle[3]) = (at[0], at[1], foot[0], foot[1]);
                if (x > 0.0) == (side > 0.0) {
                    low = m;
                } else {
                    high = m;
                }
            }
            if let Some(at) = joined.pierce(0, 1 - d, from[1 - d], middle) {
                found.push(seed(joined, at));
            }
        }
        last = Some((r, value));
    }
}
