//! What [`Surface::topology`](super::Surface::topology) finds.

/// How the two ends of one direction relate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closing {
    /// They are apart.
    Open,
    /// Clamped, and the first and last row of control points are at the same places.
    Seam,
    /// Not clamped, but the edge curves coincide.
    Touching,
    /// The knots wrap.
    Periodic,
}

/// How a surface closes. Index 0 is u, index 1 is v.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Topology {
    /// How the ends of each direction relate.
    pub closing: [Closing; 2],
    /// `poles[d][e]`: the edge where parameter d is at its start (e = 0) or end (e = 1) is a single
    /// point.
    pub poles: [[bool; 2]; 2],
    /// An interior knot of full multiplicity parts the surface along that direction, and its sides
    /// do not meet again.
    pub torn: [bool; 2],
}

impl Topology {
    /// True when the surface bounds a volume: in each direction its ends meet, or both are poles;
    /// and nothing is torn.
    pub fn is_closed(&self) -> bool {
        (0..2).all(|d| {
            (self.closing[d] != Closing::Open || self.poles[d] == [true; 2]) && !self.torn[d]
        })
    }

    /// True when walking on in a direction (0: u, 1: v) leads round: periodic, seam, or touching
    /// ends.
    pub fn wraps(&self, direction: usize) -> bool {
        self.closing[direction] != Closing::Open
    }
}
