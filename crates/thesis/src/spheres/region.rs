//! The parts of one surface that are inside another: cells that cross it, and those that they
//! enclose.
//!
//! Cells that cross come from the triangle tests. Beyond them the surface is inside or outside as a
//! whole, so one signed distance decides for all cells that are joined without crossing. The
//! deepest point of a part is looked for on its rows, first every 27th, 9th or 3rd, then closer and
//! closer about the deepest.

use super::cover::{CellId, Cover};
use super::grid::FACING;
use super::levels::{Levels, Nearest};
use super::peaks;
use super::peaks::wrapped;
use super::triangles::Triangle;
use palpate_geometry::contact::{MAX_CONTACTS, Rectangle};
use palpate_geometry::math::{Point3, Vector3};

const UNKNOWN: u8 = 0;
/// The lower four bits say which corners are on the inner side of what crosses the cell.
const CROSSING: u8 = 16;
const INSIDE: u8 = 32;
const OUTSIDE: u8 = 64;
const DONE: u8 = 128;

/// First samples of a part, at least, where it has as many.
const FEW: usize = 5;
/// Rows that were just asked for: neighbours of a deepest point come up again and again.
const RECENT: usize = 32;
/// Questions for the inside that may turn out wrong, before no more are asked.
const DOUBTS: u32 = 64;
/// Moves to a deeper neighbour.
const MOVES: usize = 200;

/// The deepest point of a part of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deep {
    pub depth_m: f64,
    pub point: Point3,
    pub uv: [f64; 2],
    /// Where the other surface is nearest.
    pub foot_uv: [f64; 2],
    /// Unit, out of the other surface there.
    pub normal: Vector3,
}

/// Room for the parts of one surface.
#[derive(Clone, Debug)]
pub(super) struct SphereRegion {
    /// (finest u × finest v)
    state: Vec<u8>,
    touched: Vec<u32>,
    stack: Vec<u32>,
    part: Vec<u32>,
    marked: [Vec<bool>; 2],
}

impl SphereRegion {
    pub fn new(cover: &Cover) -> Self {
        let (u, v) = (cover.u.finest(), cover.v.finest());
        let room = || Vec::with_capacity(u * v);
        Self {
            state: vec![UNKNOWN; u * v],
            touched: room(),
            stack: room(),
            part: room(),
            marked: [vec![false; u], vec![false; v]],
        }
    }

    pub fn clear(&mut self) {
        for cell in self.touched.drain(..) {
            self.state[cell as usize] = UNKNOWN;
        }
    }

    fn touch(&mut self, cell: usize, state: u8) {
        if self.state[cell] == UNKNOWN {
            self.touched.push(cell as u32);
        }
        self.state[cell] |= state;
    }

    /// A cell with these corners crosses a triangle of the other surface.
    pub fn cross(
        &mut self,
        cover: &Cover,
        id: CellId,
        corners: &[Point3; 4],
        other: &Triangle,
        outward: f64,
    ) {
        let normal = (other[1] - other[0]).cross(&(other[2] - other[0])) * outward;
        let mut state = CROSSING;
        for (k, p) in corners.iter().enumerate() {
            state |= u8::from((p - other[0]).dot(&normal) < 0.0) << k;
        }
        let (u, v) = cover.cells(id);
        for i in u.finest[0]..u.finest[1] {
            for j in v.finest[0]..v.finest[1] {
                self.touch(i as usize * cover.v.finest() + j as usize, state);
            }
        }
    }

    /// Every cell is inside.
    pub fn take_all(&mut self, cover: &Cover) {
        (0..cover.u.finest() * cover.v.finest()).for_each(|cell| self.touch(cell, INSIDE));
    }

    /// The first point of this surface is inside the other.
    pub fn is_inside(
        &self,
        cover: &mut Cover,
        other: &mut Cover,
        levels: &mut Levels,
        side: f64,
    ) -> bool {
        depth(cover, other, levels, [0, 0], f64::INFINITY, side)
            .is_some_and(|(deep, _)| deep.depth_m > 0.0)
    }

    /// Calls with the deepest point and the parameters of every part; the number of distances asked
    /// for.
    pub fn contacts(
        &mut self,
        cover: &mut Cover,
        other: &mut Cover,
        levels: &mut Levels,
        side: f64,
        mut each: impl FnMut(Option<Deep>, Rectangle),
    ) -> u32 {
        let mut queries = self.enclose(cover, other, levels, side);
        let mut parts = 0;
        for k in 0..self.touched.len() {
            let first = self.touched[k] as usize;
            if self.state[first] & (CROSSING | INSIDE) == 0 || self.state[first] & DONE != 0 {
                continue;
            }
            self.collect(cover, first);
            let deepest = self.deepest(cover, other, levels, side, &mut queries);
            let area = self.area(cover);
            each(deepest, area);
            parts += 1;
            if parts == MAX_CONTACTS {
                break;
            }
        }
        queries
    }

    /// Finds the cells inside, starting beside corners that seem to be.
    fn enclose(
        &mut self,
        cover: &mut Cover,
        other: &mut Cover,
        levels: &mut Levels,
        side: f64,
    ) -> u32 {
        let (mut queries, mut doubts) = (0, 0);
        // Those that are added on the way do not cross.
        for k in 0..self.touched.len() {
            let cell = self.touched[k] as usize;
            let state = self.state[cell];
            if state & CROSSING == 0 || state & 15 == 0 || doubts >= DOUBTS {
                continue;
            }
            let (i, j) = (cell / cover.v.finest(), cell % cover.v.finest());
            for (di, dj, beside) in [
                (1, 0, 0b0110),
                (-1, 0, 0b1001),
                (0, 1, 0b1100),
                (0, -1, 0b0011),
            ] {
                let Some(next) = neighbour(cover, i, j, di, dj) else {
                    continue;
                };
                if state & beside == 0 || self.state[next] != UNKNOWN {
                    continue;
                }
                let (a, b) = (next / cover.v.finest(), next % cover.v.finest());
                // Of the new cell, the corner away from the crossing.
                let row = cover.u.level(usize::MAX)[a].rows[usize::from(di > 0)];
                let column = cover.v.level(usize::MAX)[b].rows[usize::from(dj > 0)];
                queries += 1;
                let found = depth(cover, other, levels, [row, column], f64::INFINITY, side);
                if found.is_some_and(|(deep, _)| deep.depth_m > 0.0) {
                    self.flood(cover, next);
                } else {
                    doubts += 1;
                    self.touch(next, OUTSIDE);
                }
            }
        }
        queries
    }

    /// All cells that are joined to this one without crossing are inside too.
    fn flood(&mut self, cover: &Cover, first: usize) {
        self.stack.clear();
        self.touch(first, INSIDE);
        self.stack.push(first as u32);
        while let Some(cell) = self.stack.pop() {
            let (i, j) = (
                cell as usize / cover.v.finest(),
                cell as usize % cover.v.finest(),
            );
            for (di, dj) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
                if let Some(next) =
                    neighbour(cover, i, j, di, dj).filter(|&next| self.state[next] == UNKNOWN)
                {
                    self.touch(next, INSIDE);
                    self.stack.push(next as u32);
                }
            }
        }
    }

    /// The part that a cell belongs to.
    fn collect(&mut self, cover: &Cover, first: usize) {
        self.stack.clear();
        self.part.clear();
        self.state[first] |= DONE;
        self.stack.push(first as u32);
        while let Some(cell) = self.stack.pop() {
            self.part.push(cell);
            let (i, j) = (
                cell as usize / cover.v.finest(),
                cell as usize % cover.v.finest(),
            );
            for (di, dj) in [
                (1, 0),
                (-1, 0),
                (0, 1),
                (0, -1),
                (1, 1),
                (1, -1),
                (-1, 1),
                (-1, -1),
            ] {
                let Some(next) = neighbour(cover, i, j, di, dj) else {
                    continue;
                };
                if self.state[next] & (CROSSING | INSIDE) != 0 && self.state[next] & DONE == 0 {
                    self.state[next] |= DONE;
                    self.stack.push(next as u32);
                }
            }
        }
    }

    fn area(&mut self, cover: &Cover) -> Rectangle {
        self.marked.iter_mut().for_each(|marked| marked.fill(false));
        for &cell in &self.part {
            self.marked[0][cell as usize / cover.v.finest()] = true;
            self.marked[1][cell as usize % cover.v.finest()] = true;
        }
        Rectangle {
            u: peaks::interval(&cover.u, &self.marked[0]),
            v: peaks::interval(&cover.v, &self.marked[1]),
        }
    }

    fn deepest(
        &self,
        cover: &mut Cover,
        other: &mut Cover,
        levels: &mut Levels,
        side: f64,
        queries: &mut u32,
    ) -> Option<Deep> {
        let corner = |cover: &Cover, cell: u32, k: usize| {
            let (i, j) = (
                cell as usize / cover.v.finest(),
                cell as usize % cover.v.finest(),
            );
            [
                cover.u.level(usize::MAX)[i].rows[k & 1],
                cover.v.level(usize::MAX)[j].rows[k >> 1],
            ]
        };
        let on = |[i, j]: [u32; 2], step: u32| i.is_multiple_of(step) && j.is_multiple_of(step);
        // The lower corner of each cell is taken for it; on the finest step all corners do.
        let enough = |step: &u32| {
            self.part
                .iter()
                .filter(|&&cell| on(corner(cover, cell, 0), *step))
                .nth(FEW - 1)
                .is_some()
        };
        let first_step = [27, 9, 3].into_iter().find(enough).unwrap_or(1);
        let mut best: Option<(Deep, [u32; 2])> = None;
        let mut last: Option<(Point3, f64)> = None;
        let mut recent = [[u32::MAX; 2]; RECENT];
        let mut asked = 0;
        let mut ask = |at: [u32; 2], cover: &mut Cover, best: &mut Option<(Deep, [u32; 2])>| {
            if recent.contains(&at) {
                return false;
            }
            recent[asked % RECENT] = at;
            asked += 1;
            let point = cover.points.at(&cover.u, &cover.v, at[0], at[1]);
            // Distances differ by no more than the points do.
            let within = last.map_or(f64::INFINITY, |(from, distance)| {
                (distance + (point - from).norm()) * (1.0 + 1e-9)
                    + cover.noise_m()
                    + other.noise_m()
            });
            *queries += 1;
            let Some((deep, distance)) = depth(cover, other, levels, at, within, side) else {
                return false;
            };
            last = Some((point, distance));
            let deeper = best
                .as_ref()
                .is_none_or(|(best, _)| deep.depth_m > best.depth_m);
            if deeper {
                *best = Some((deep, at));
            }
            deeper
        };
        let all = if first_step == 1 { 4 } else { 1 };
        for &cell in &self.part {
            for k in 0..all {
                let at = corner(cover, cell, k);
                // Of the four only those that no neighbour of the part brings.
                let first = k == 0 || !self.has_corner_elsewhere(cover, cell, k);
                if first && on(at, first_step) {
                    ask(at, cover, &mut best);
                }
            }
        }
        let mut step = first_step / 3;
        while step > 0 {
            for _ in 0..MOVES {
                let (_, [i, j]) = best?;
                let mut moved = false;
                for (di, dj) in [
                    (1, 0),
                    (-1, 0),
                    (0, 1),
                    (0, -1),
                    (1, 1),
                    (1, -1),
                    (-1, 1),
                    (-1, -1),
                ] {
                    let a = shifted(
                        cover.u.parameters.len(),
                        cover.u.wraps,
                        i,
                        di * i64::from(step),
                    );
                    let b = shifted(
                        cover.v.parameters.len(),
                        cover.v.wraps,
                        j,
                        dj * i64::from(step),
                    );
                    if let (Some(a), Some(b)) = (a, b) {
                        moved |= ask([a, b], cover, &mut best);
                    }
                }
                if !moved {
                    break;
                }
            }
            step /= 3;
        }
        best.map(|(deep, _)| Deep {
            depth_m: deep.depth_m.max(0.0),
            ..deep
        })
    }

    /// Corner `k` of a cell is the lower corner of another cell of the part.
    fn has_corner_elsewhere(&self, cover: &Cover, cell: u32, k: usize) -> bool {
        let (i, j) = (
            cell as usize / cover.v.finest(),
            cell as usize % cover.v.finest(),
        );
        neighbour(cover, i, j, (k & 1) as i64, (k >> 1) as i64)
            .is_some_and(|next| self.state[next] & (CROSSING | INSIDE) != 0)
    }
}

fn neighbour(cover: &Cover, i: usize, j: usize, di: i64, dj: i64) -> Option<usize> {
    let i = wrapped(&cover.u, i as i64 + di)?;
    let j = wrapped(&cover.v, j as i64 + dj)?;
    Some(i * cover.v.finest() + j)
}

/// A row some steps on; the first and the last are one where the direction wraps.
fn shifted(rows: usize, wraps: bool, row: u32, by: i64) -> Option<u32> {
    let (at, last) = (i64::from(row) + by, rows as i64 - 1);
    if (0..=last).contains(&at) {
        Some(at as u32)
    } else {
        wraps.then(|| at.rem_euclid(last) as u32)
    }
}

/// How deep a point of a grid is inside the other surface, negative outside, and its distance;
/// `None` when nothing is within `within_m`.
fn depth(
    cover: &mut Cover,
    other: &mut Cover,
    levels: &mut Levels,
    [i, j]: [u32; 2],
    within_m: f64,
    side: f64,
) -> Option<(Deep, f64)> {
    let point = cover.points.at(&cover.u, &cover.v, i, j);
    let Nearest {
        point: foot,
        uv: foot_uv,
        distance_m,
        normals,
    } = levels.nearest(other, &point, within_m)?;
    let away = point - foot;
    let along = away.dot(&normals) * side;
    let inside = along < 0.0 && (other.closed || -along > FACING * distance_m * normals.norm());
    let sign = if inside { -1.0 } else { 1.0 };
    let normal = if distance_m > 1e-9 * other.size_m {
        away * (sign / distance_m)
    } else {
        normals.try_normalize(0.0).unwrap_or_else(Vector3::z) * side
    };
    let uv = [
        cover.u.parameters[i as usize],
        cover.v.parameters[j as usize],
    ];
    Some((
        Deep {
            depth_m: -sign * distance_m,
            point,
            uv,
            foot_uv,
            normal,
        },
        distance_m,
    ))
}
