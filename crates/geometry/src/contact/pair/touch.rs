//! Which cells of two surfaces come near each other, and which of these may face.

use super::cells::{Block, Cells};
use crate::surface::{BezierPieces, Surface};

/// Most pairs of facing cells looked at.
const MOST_PAIRS: usize = 4096;

/// A surface, its Bézier pieces, and the cells that these are divided into.
pub(super) struct Divided<'a> {
    pub surface: &'a Surface,
    pub pieces: &'a BezierPieces,
    pub cells: &'a mut Cells,
}

impl Divided<'_> {
    fn look(&mut self, cell: usize) {
        self.cells.look(self.surface, self.pieces, cell);
    }
}

/// Scratch memory of a query.
#[derive(Clone, Debug)]
pub(super) struct Touch {
    /// Pieces of the second surface that may touch the first at all.
    near: Vec<u32>,
    blocks: Vec<Block>,
    facing: Vec<(u32, u32)>,
}

impl Touch {
    pub fn new(tool: usize) -> Self {
        Self {
            near: Vec::with_capacity(tool),
            blocks: Vec::with_capacity(tool),
            facing: Vec::with_capacity(MOST_PAIRS),
        }
    }

    /// Pairs of cells that are near and may face each other.
    pub fn facing(&self) -> &[(u32, u32)] {
        &self.facing
    }

    /// Marks touched cells of both, and lists the facing pairs.
    pub fn find(&mut self, a: &mut Divided<'_>, b: &mut Divided<'_>, reach_m: f64) {
        self.near.clear();
        self.blocks.clear();
        self.facing.clear();
        for k in 0..b.pieces.len() {
            let block = block(b.pieces, k);
            if block.meets(&a.cells.whole, reach_m) {
                self.near.push(k as u32);
                self.blocks.push(block);
            }
        }
        for x in 0..a.pieces.len() {
            let own = block(a.pieces, x);
            if !own.meets(&b.cells.whole, reach_m) {
                continue;
            }
            for k in 0..self.near.len() {
                if own.meets(&self.blocks[k], reach_m) {
                    self.pieces(a, x, b, k, reach_m);
                }
            }
        }
    }

    fn pieces(
        &mut self,
        a: &mut Divided<'_>,
        x: usize,
        b: &mut Divided<'_>,
        k: usize,
        reach_m: f64,
    ) {
        let (y, whole) = (self.near[k] as usize, self.blocks[k]);
        let (([i, j], [m, n]), ([k, l], [p, q])) = (a.cells.of_piece(x), b.cells.of_piece(y));
        let (columns_a, columns_b) = (a.cells.counts[1], b.cells.counts[1]);
        for r in 0..m * n {
            let cell = (i + r / n) * columns_a + j + r % n;
            a.look(cell);
            if !a.cells.box_of(cell).meets(&whole, reach_m) {
                continue;
            }
            for s in 0..p * q {
                let other = (k + s / q) * columns_b + l + s % q;
                b.look(other);
                if !a.cells.box_of(cell).meets(b.cells.box_of(other), reach_m) {
                    continue;
                }
                a.cells.touched[cell] = true;
                b.cells.touched[other] = true;
                if self.facing.len() < MOST_PAIRS
                    && a.cells.cone_of(cell).may_face(b.cells.cone_of(other))
                {
                    a.cells.facing[cell] = true;
                    b.cells.facing[other] = true;
                    self.facing.push((cell as u32, other as u32));
                }
            }
        }
    }
}

fn block(pieces: &BezierPieces, k: usize) -> Block {
    let b = pieces.bounds(k);
    Block {
        low: [b.min.x, b.min.y, b.min.z],
        high: [b.max.x, b.max.y, b.max.z],
    }
}
