//! Which cells of two surfaces come near each other, and which of these may face.

use super::cells::{Block, Cells};
use crate::surface::{BezierPieces, Surface};

/// Most pairs of facing cells looked at.
const MOST_PAIRS: usize = 4096;

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
    pub fn find(
        &mut self,
        a: &Surface,
        a_pieces: &BezierPieces,
        a_cells: &mut Cells,
        b: &Surface,
        b_pieces: &BezierPieces,
        b_cells: &mut Cells,
        reach_m: f64,
    ) {
        self.near.clear();
        self.blocks.clear();
        self.facing.clear();
        for k in 0..b_pieces.len() {
            let block = block(b_pieces, k);
            if block.meets(&a_cells.whole, reach_m) {
                self.near.push(k as u32);
                self.blocks.push(block);
            }
        }
        for x in 0..a_pieces.len() {
            let own = block(a_pieces, x);
            if !own.meets(&b_cells.whole, reach_m) {
                continue;
            }
            for k in 0..self.near.len() {
                if own.meets(&self.blocks[k], reach_m) {
                    self.pieces(a, a_pieces, a_cells, x, b, b_pieces, b_cells, k, reach_m);
                }
            }
        }
    }

    fn pieces(
        &mut self,
        a: &Surface,
        a_pieces: &BezierPieces,
        a_cells: &mut Cells,
        x: usize,
        b: &Surface,
        b_pieces: &BezierPieces,
        b_cells: &mut Cells,
        k: usize,
        reach_m: f64,
    ) {
        let (y, whole) = (self.near[k] as usize, self.blocks[k]);
        let (([i, j], [m, n]), ([k, l], [p, q])) = (a_cells.of_piece(x), b_cells.of_piece(y));
        let (columns_a, columns_b) = (a_cells.counts[1], b_cells.counts[1]);
        for r in 0..m * n {
            let cell = (i + r / n) * columns_a + j + r % n;
            a_cells.look(a, a_pieces, cell);
            if !a_cells.box_of(cell).meets(&whole, reach_m) {
                continue;
            }
            for s in 0..p * q {
                let other = (k + s / q) * columns_b + l + s % q;
                b_cells.look(b, b_pieces, other);
                if !a_cells.box_of(cell).meets(b_cells.box_of(other), reach_m) {
                    continue;
                }
                a_cells.touched[cell] = true;
                b_cells.touched[other] = true;
                if self.facing.len() < MOST_PAIRS
                    && a_cells.cone_of(cell).may_face(b_cells.cone_of(other))
                {
                    a_cells.facing[cell] = true;
                    b_cells.facing[other] = true;
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
