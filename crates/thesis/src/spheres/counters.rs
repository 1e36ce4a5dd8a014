//! What a query did.

/// Levels that are counted apart; the last takes all beyond.
pub const MAX_LEVELS: usize = 8;

/// One level of one surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelCounters {
    /// Points computed.
    pub points: u32,
    /// Spheres looked at.
    pub spheres: u32,
    /// Spheres tested against a tool, or against the other side's.
    pub tests: u32,
    /// Tests that met.
    pub meets: u32,
}

/// What a query did, level by level, coarsest first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// The body.
    pub body: [LevelCounters; MAX_LEVELS],
    /// The tool, where it is a surface.
    pub tool: [LevelCounters; MAX_LEVELS],
    /// The hulls were apart: nothing else was done.
    pub hulls_apart: bool,
    /// First level of which all spheres met: flat cells went no further.
    pub early_stop: Option<u8>,
    /// Cells that were split into two triangles each.
    pub triangulated_cells: u32,
    /// Triangle–triangle tests.
    pub triangle_tests: u32,
    /// Of these, pairs that meet.
    pub triangle_meets: u32,
    /// Points whose distance from the other surface was asked for, to find depths.
    pub depth_queries: u32,
    /// Cells or pairs that found no room.
    pub dropped: u32,
}

impl Counters {
    /// Points computed on both sides and all levels.
    pub fn points(&self) -> u32 {
        self.body
            .iter()
            .chain(&self.tool)
            .map(|level| level.points)
            .sum()
    }
}

/// The counters of a level.
pub(super) fn of(levels: &mut [LevelCounters; MAX_LEVELS], level: usize) -> &mut LevelCounters {
    &mut levels[level.min(MAX_LEVELS - 1)]
}
