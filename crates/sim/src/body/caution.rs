//! Whether the tangent of rest can follow springs, and the buffers of a correction.

use super::core::FactorWork;
use super::follow::Made;
use super::frame::Frame;
use super::rigid_motion::Inertia;
use crate::in_place::clone_in_place;
use crate::solve::rigid_part::RigidPart;
use palpate_geometry::math::{Lane, Point3, Rows, Vector3};

/// Fewest and most steps that are left to a firmer matrix once one cannot follow.
const CAUTIOUS_STEPS: [u32; 2] = [16, 1024];
/// The level of the bounding matrix.
pub(super) const BOUNDING: u32 = 2;

/// How corrections went so far: whether the tangent of rest can follow the body.
#[derive(Debug, Default, PartialEq)]
pub struct Caution {
    /// (unknowns): last correction, m, and how often in a row it has turned over.
    pub corrections: Vec<Lane>,
    /// Which matrix: the tangent of rest, the firmer one, the bounding one.
    pub level: u32,
    /// For so many steps more.
    pub steps: u32,
    /// For how many it would be next time.
    pub next: u32,
}

clone_in_place!(Caution {
    corrections,
    level,
    steps,
    next
});

impl Caution {
    /// That of a body at rest; a body without a tangent, or with pressures, needs none.
    pub(super) fn set_to_rest(&mut self) {
        self.corrections.fill([0.0; 4]);
        (self.level, self.steps) = (0, 0);
        self.next = match self.corrections.is_empty() {
            true => 0,
            false => CAUTIOUS_STEPS[0],
        };
    }

    /// Another step: trust comes back by and by.
    pub(super) fn step(&mut self) {
        if self.steps > 0 {
            self.steps -= 1;
        } else if self.level > 0 {
            self.level -= 1;
            self.steps = if self.level > 0 { self.next } else { 0 };
            self.corrections.fill([0.0; 4]);
        } else {
            self.next = self.next.saturating_sub(1).max(CAUTIOUS_STEPS[0]);
        }
    }

    /// A firmer matrix.
    pub(super) fn raise(&mut self, level: u32) {
        self.level = level.min(BOUNDING);
        self.steps = self.next;
        self.next = (4 * self.next).min(CAUTIOUS_STEPS[1]);
        self.corrections.fill([0.0; 4]);
    }
}

/// Buffers of a correction.
#[derive(Clone, Debug, Default)]
pub(super) struct ImplicitScratch {
    /// (unknowns).
    pub(super) frames: Vec<Frame>,
    pub(super) work: FactorWork,
    /// (unknowns): right-hand side and solution, in the frame of the matrix.
    pub(super) rows: Rows,
    /// (unknowns), N: the right-hand side once more, of steps of several iterations.
    pub(super) loads: Rows,
    /// Of the last residual, its product with the correction: its square in the norm of B⁻¹, J.
    pub(super) merit_j: f64,
    /// (unknowns), m: the solution in the world.
    pub(super) moved: Vec<Vector3>,
    /// The state's caution after the step.
    pub(super) caution: Caution,
    /// Σ |correction|² of the last further iteration, m².
    pub(super) last_m2: f64,
    /// Pressures so far, Pa, and the gaps between them and the volumes at the last look.
    pub(super) pressures: Vec<Lane>,
    pub(super) gaps: Vec<Lane>,
    /// Which core the step takes.
    pub(super) core: usize,
    /// Which of them a sheet as taut as in this step takes.
    pub(super) taut: usize,
    /// (coordinates), m: where the step starts.
    pub(super) starts: Vec<Point3>,
    /// Of a free body, there.
    pub(super) inertia: Option<Inertia>,
    /// How its rigid motions answer, once contact has asked for it.
    pub(super) rigid: RigidPart,
    /// The core that was made where the body is, in place of that of rest.
    pub(super) followed: Option<Made>,
}
