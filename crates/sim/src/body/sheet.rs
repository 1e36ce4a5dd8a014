//! Which control points of a surface are neighbours: quadrilaterals, and rows of three that bend.

use palpate_geometry::surface::{Joints, Surface};
use std::collections::BTreeSet;

/// The neighbours of a membrane, as coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Corners in order around each.
    pub quads: Vec<[u32; 4]>,
    /// Before, middle and after, along rows and columns.
    pub rows: Vec<[u32; 3]>,
}

impl Sheet {
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
                if let Some([before, after]) = around(row, rows, wraps[0], |r| at(r, column)) {
                    sheet.bend([before, middle, after]);
                }
                if let Some([before, after]) = around(column, columns, wraps[1], |c| at(row, c)) {
                    sheet.bend([before, middle, after]);
                }
            }
        }
        sheet
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
        // A row along a joint belongs to both sides.
        let mut known = BTreeSet::new();
        sheet
            .rows
            .retain(|&[a, b, c]| known.insert([a.min(c), b, a.max(c)]));
        sheet
    }

    fn bend(&mut self, row: [u32; 3]) {
        let [before, middle, after] = row;
        if before != middle && middle != after && before != after {
            self.rows.push(row);
        }
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
