//! Whether the tangent of rest can follow springs.

use crate::in_place::clone_in_place;
use palpate_geometry::math::Lane;

/// Fewest and most steps by a firmer matrix once one cannot follow.
const FIRMER_STEPS: [u32; 2] = [16, 1024];
/// The level of the bounding matrix.
pub(super) const BOUNDING: u32 = 2;

/// How corrections went so far: whether the tangent of rest can follow the body.
#[derive(Debug, Default, PartialEq)]
pub struct Convergence {
    /// (unknowns): last correction, m, and how often in a row it has turned over.
    pub corrections: Vec<Lane>,
    /// Which matrix: the tangent of rest, the firmer one, the bounding one.
    pub level: u32,
    /// For so many steps more.
    pub steps: u32,
    /// For how many it would be next time.
    pub next: u32,
}

clone_in_place!(Convergence {
    corrections,
    level,
    steps,
    next
});

impl Convergence {
    /// That of a body at rest; a body without a tangent, or with pressures, needs none.
    pub(super) fn set_to_rest(&mut self) {
        self.corrections.fill([0.0; 4]);
        (self.level, self.steps) = (0, 0);
        self.next = match self.corrections.is_empty() {
            true => 0,
            false => FIRMER_STEPS[0],
        };
    }

    /// Another step: the tangent is tried again after a while.
    pub(super) fn step(&mut self) {
        if self.steps > 0 {
            self.steps -= 1;
        } else if self.level > 0 {
            self.level -= 1;
            self.steps = if self.level > 0 { self.next } else { 0 };
            self.corrections.fill([0.0; 4]);
        } else {
            self.next = self.next.saturating_sub(1).max(FIRMER_STEPS[0]);
        }
    }

    /// A firmer matrix.
    pub(super) fn raise(&mut self, level: u32) {
        self.level = level.min(BOUNDING);
        self.steps = self.next;
        self.next = (4 * self.next).min(FIRMER_STEPS[1]);
        self.corrections.fill([0.0; 4]);
    }
}
