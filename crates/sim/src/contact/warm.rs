//! Contact forces of the last tick: where solves start, and what contacts remember.

use crate::in_place::clone_in_place;
use crate::solve::friction::Stick;
use crate::solve::row_key::{RowId, RowKey};
use palpate_geometry::math::Vector3;
use palpate_geometry::stateful;

/// A contact force to start from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WarmRow {
    /// Which row of the last tick it was.
    pub id: RowId,
    /// Where it is on the body; kept for feet, which have no sample to say so.
    pub uv: [f64; 2],
    /// Along the normal, N.
    pub force_n: f64,
    /// Across it, N.
    pub tangent_n: Vector3,
    /// It had friction, or was of a grip: what follows of it counts.
    pub rubs: bool,
    /// Where it sticks, unless it slips.
    pub stick: Stick,
    /// It slipped.
    pub slips: bool,
    /// Where on the tool, from its reference point in its frame, m; kept for feet, and for all rows
    /// of tools that may turn.
    pub on_tool: Vector3,
}

/// Rows of the last tick that carried or may carry soon, ordered by their ids.
#[derive(Debug, PartialEq)]
pub struct Warm {
    /// (rows of a tick at most): `len` are valid.
    rows: Vec<WarmRow>,
    len: usize,
    /// Some of them are of tools that may turn.
    pub arms: bool,
}

impl Warm {
    /// None yet, with room for so many.
    pub(crate) fn with_room(most: usize) -> Self {
        Self {
            rows: vec![WarmRow::default(); most],
            len: 0,
            arms: false,
        }
    }

    /// All of them.
    pub fn rows(&self) -> &[WarmRow] {
        &self.rows[..self.len]
    }

    /// A row, if it is among them.
    pub fn of_row(&self, id: RowId) -> Option<&WarmRow> {
        let found = self.rows().binary_search_by_key(&id, |row| row.id);
        found.ok().map(|at| &self.rows[at])
    }

    /// Those of a pair.
    pub fn of_pair(&self, pair: usize) -> &[WarmRow] {
        let rows = self.rows();
        let first = rows.partition_point(|row| (row.id.pair as usize) < pair);
        let own = |row: &WarmRow| row.id.pair as usize == pair;
        let count = rows[first..].partition_point(own);
        &rows[first..first + count]
    }

    /// No rows, and no trace of them.
    pub(crate) fn forget(&mut self) {
        self.rows.fill(WarmRow::default());
        (self.len, self.arms) = (0, false);
    }

    /// No rows; what follows is pushed in order.
    pub(crate) fn begin(&mut self) {
        (self.len, self.arms) = (0, false);
    }

    /// The next one.
    pub(crate) fn push(&mut self, row: WarmRow) {
        debug_assert!(
            self.rows().last().is_none_or(|last| last.id < row.id),
            "rows that are kept are out of order"
        );
        self.rows[self.len] = row;
        self.len += 1;
    }

    /// Puts others, in order, among them; those that find no room are left out.
    pub(crate) fn merge(&mut self, others: &[WarmRow]) {
        // From behind: both lists are ordered, and there is room.
        let (mut from, mut kept) = (self.len, others.len());
        let mut to = (from + kept).min(self.rows.len());
        kept = to - from;
        self.len = to;
        while kept > 0 {
            to -= 1;
            if from > 0 && self.rows[from - 1].id > others[kept - 1].id {
                from -= 1;
                self.rows[to] = self.rows[from];
            } else {
                kept -= 1;
                self.rows[to] = others[kept];
            }
        }
    }

    /// As long as can be.
    pub(crate) fn fill(&mut self) {
        (self.len, self.arms) = (self.rows.len(), true);
        for row in &mut self.rows {
            (row.id.key, row.rubs) = (RowKey::Foot(0), true);
        }
    }
}

clone_in_place!(Warm { rows, len, arms });

stateful!(Warm, |this, walk| {
    let Warm { rows, len, arms } = this;
    walk.packed("number of contact rows", [(0, len), (33, arms)])?;
    let count = *len as u64;
    walk.ensure(*len <= rows.len(), "number of contact rows", count)?;
    for (_, row) in std::iter::zip(0..*len, rows) {
        walk.clear(row)?;
        let WarmRow {
            id: RowId { pair, key },
            uv,
            force_n,
            tangent_n,
            rubs,
            stick: Stick { u, v, offset },
            slips,
            on_tool,
        } = row;
        walk.packed(
            "pair of a contact row",
            [(0, pair), (32, rubs), (33, slips)],
        )?;
        walk.coded("key of a contact row", key)?;
        walk.float(force_n)?;
        if key.is_foot() {
            walk.floats(uv)?;
        }
        if *arms || key.is_foot() {
            walk.vector(on_tool)?;
        }
        if *rubs {
            walk.vector(tangent_n)?;
            walk.float(u)?;
            walk.float(v)?;
            walk.vector(offset)?;
        }
    }
    Ok(())
});
