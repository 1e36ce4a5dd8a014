//! Which control points of a surface are neighbours: quadrilaterals, and rows of three that bend.

use palpate_geometry::surface::{Closing, Joints, Surface};
use std::collections::{BTreeMap, BTreeSet};

/// The neighbours of a membrane, as coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Corners in order around each.
    pub quads: Vec<[u32; 4]>,
    /// Before, middle and after, along rows and columns and through poles.
    pub rows: Vec<Row>,
}

/// Three neighbours that bend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Before the middle.
    pub before: u32,
    /// Which stands off.
    pub middle: u32,
    /// After the middle; of two, the point half way between.
    pub after: [u32; 2],
    /// Left and right of the middle, where the sheet goes on there.
    pub across: Option<[u32; 2]>,
    /// What the row counts beside those that cross it.
    pub share: f64,
}

impl Row {
    /// Three in a row, nothing beside them.
    pub fn of([before, middle, after]: [u32; 3]) -> Self {
        Self {
            before,
            middle,
            after: [after; 2],
            across: None,
            share: 1.0,
        }
    }
}

impl Sheet {
    /// Of a surface as its knots go round, whose control points are these coordinates.
    pub fn of_surface(surface: &Surface, coordinate_of_control: &[u32]) -> Self {
        let closing = surface.topology().closing;
        let wraps = closing.map(|closing| closing == Closing::Periodic);
        Self::of(surface, wraps, coordinate_of_control)
    }

    /// Of a surface, whose control points are these coordinates; `wraps` says which directions go
    /// on with their first points after the last.
    pub fn of(surface: &Surface, wraps: [bool; 2], coordinate_of_control: &[u32]) -> Self {
        match surface.joints() {
            Some(joints) => {
                Self::of_patches(&joints, surface.net().columns(), coordinate_of_control)
            }
            None => Self::of_grid(
                [surface.net().rows(), surface.net().columns()],
                wraps,
                coordinate_of_control,
            ),
        }
    }

    /// Of a net in one piece.
    fn of_grid(
        [rows, columns]: [usize; 2],
        wraps: [bool; 2],
        coordinate_of_control: &[u32],
    ) -> Self {
        let at = |row: usize, column: usize| {
            coordinate_of_control[row % rows * columns + column % columns]
        };
        let mut sheet = Self {
            quads: Vec::new(),
            rows: Vec::new(),
        };
        for row in 0..rows - usize::from(!wraps[0]) {
            for column in 0..columns - usize::from(!wraps[1]) {
                sheet.quads.push([
                    at(row, column),
                    at(row, column + 1),
                    at(row + 1, column + 1),
                    at(row + 1, column),
                ]);
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let middle = at(row, column);
                let along_u = around(row, rows, wraps[0], |r| at(r, column));
                let along_v = around(column, columns, wraps[1], |c| at(row, c));
                for [before, after] in along_u.into_iter().chain(along_v) {
                    sheet.bend([before, middle, after]);
                }
            }
        }
        let mut sheet = sheet.crossed();
        // Lines of control points and the next ones inwards: the first may be poles.
        let [last_row, last_column] = [rows - 1, columns - 1];
        let line = |row: usize| (0..columns).map(|column| at(row, column)).collect();
        let column = |column: usize| (0..rows).map(|row| at(row, column)).collect();
        if !wraps[0] && rows > 2 {
            sheet.through_pole(line(0), line(1));
            sheet.through_pole(line(last_row), line(last_row - 1));
        }
        if !wraps[1] && columns > 2 {
            sheet.through_pole(column(0), column(1));
            sheet.through_pole(column(last_column), column(last_column - 1));
        }
        sheet
    }

    /// Rows from one side of a pole to the other, if the line is one point. With curvatures κ₁, κ₂,
    /// m ≥ 3 rows at even angles have the mean square ⅜ (κ₁² + κ₂²) + ¼ κ₁κ₂, so at 8 / (3 m) each
    /// they are together a plate of ν = 1/3.
    fn through_pole(&mut self, line: Vec<u32>, mut ring: Vec<u32>) {
        let pole = line[0];
        if ring.len() > 1 && ring[0] == ring[ring.len() - 1] {
            ring.pop();
        }
        let n = ring.len();
        if n < 3 || line.iter().any(|&node| node != pole) || ring.contains(&pole) {
            return;
        }
        let on = |k: usize| ring[k % n];
        let odd = n % 2;
        let rows = if odd == 1 { n } else { n / 2 };
        for k in 0..rows {
            self.rows.push(Row {
                before: on(k),
                middle: pole,
                after: [on(k + n / 2), on(k + n / 2 + odd)],
                across: (odd == 0).then(|| [on(k + n / 4), on(k + n / 4 + n / 2)]),
                share: 8.0 / (3.0 * rows as f64),
            });
        }
    }

    /// Of a branching surface: each patch by itself and once, and rows of three over the edges that
    /// join them.
    fn of_patches(joints: &Joints, columns: usize, coordinate_of_control: &[u32]) -> Self {
        let at = |row: usize, column: usize| coordinate_of_control[row * columns + column];
        let mut sheet = Self {
            quads: Vec::new(),
            rows: Vec::new(),
        };
        for (k, _) in joints
            .patches()
            .iter()
            .enumerate()
            .filter(|(_, patch)| patch.duplicate_of.is_none())
        {
            let [[u0, u1], [v0, v1]] = joints.controls_of(k);
            for row in u0..=u1 {
                for column in v0..=v1 {
                    if row < u1 && column < v1 {
                        let quad = [
                            at(row, column),
                            at(row, column + 1),
                            at(row + 1, column + 1),
                            at(row + 1, column),
                        ];
                        sheet.quads.push(quad);
                    }
                    if row > u0 && row < u1 {
                        sheet.bend([at(row - 1, column), at(row, column), at(row + 1, column)]);
                    }
                    if column > v0 && column < v1 {
                        sheet.bend([at(row, column - 1), at(row, column), at(row, column + 1)]);
                    }
                }
            }
        }
        for [before, middle, after] in joints.rows_across() {
            sheet.bend([before, middle, after].map(|control| coordinate_of_control[control]));
        }
        sheet.crossed()
    }

    fn bend(&mut self, row: [u32; 3]) {
        let [before, middle, after] = row;
        if before != middle && middle != after && before != after {
            self.rows.push(Row::of(row));
        }
    }

    /// Each row once, and where two cross, each with the ends of the other beside it.
    fn crossed(mut self) -> Self {
        // A row along a seam or a joint belongs to both sides.
        let mut known = BTreeSet::new();
        self.rows.retain(|row| {
            let (a, c) = (row.before, row.after[0]);
            known.insert([a.min(c), row.middle, a.max(c)])
        });
        let mut of_middle: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (k, row) in self.rows.iter().enumerate() {
            of_middle.entry(row.middle).or_default().push(k);
        }
        for rows in of_middle.into_values() {
            let [a, b] = rows[..] else { continue };
            for (one, other) in [(a, b), (b, a)] {
                let Row { before, after, .. } = self.rows[other];
                self.rows[one].across = Some([before, after[0]]);
            }
        }
        self
    }
}

/// Neighbours of place `k` of `count`; across the seam where the last place repeats the first.
fn around(k: usize, count: usize, wraps: bool, at: impl Fn(usize) -> u32) -> Option<[u32; 2]> {
    let closed = count > 3 && at(0) == at(count - 1);
    match k {
        k if wraps => Some([at(k + count - 1), at(k + 1)]),
        0 if closed => Some([at(count - 2), at(1)]),
        k if k > 0 && k + 1 < count => Some([at(k - 1), at(k + 1)]),
        _ => None,
    }
}
