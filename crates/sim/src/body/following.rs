//! Which matrix a body's step takes, and where the next one is made.

use crate::in_place::clone_in_place;
use palpate_geometry::math::{Lane, Point3};
use palpate_geometry::stateful;

/// Steps from where a matrix is made until it is taken over.
pub(super) const DUE: u32 = 32;

/// Where a matrix is made.
#[derive(Debug, Default, PartialEq)]
pub struct Shape {
    /// It is not that of rest.
    pub is_set: bool,
    /// (coordinates), m.
    pub positions: Vec<Point3>,
    /// As those of the state.
    pub pressures: Vec<Lane>,
    /// As [`super::DeformableState::rest_lengths`].
    pub metrics: Vec<Lane>,
}

clone_in_place!(Shape {
    is_set,
    positions,
    pressures,
    metrics
});

stateful!(Shape, |this, walk| {
    let Shape {
        is_set,
        positions,
        pressures,
        metrics,
    } = this;
    walk.coded("matrix of another shape", is_set)?;
    if *is_set {
        walk.triples(positions)?;
        walk.lanes(pressures)?;
        walk.lanes(metrics)?;
    }
    Ok(())
});

/// Which matrix a body takes. One without room for shapes keeps that of rest.
#[derive(Debug, Default, PartialEq)]
pub struct Following {
    /// Where that of the step was made.
    pub now: Shape,
    /// Where the next one is made.
    pub next: Shape,
    /// Steps since then.
    pub age: u32,
    /// Steps, counted round.
    pub step: u32,
}

clone_in_place!(Following {
    now,
    next,
    age,
    step
});

stateful!(Following, |this, walk| {
    let Following {
        now,
        next,
        age,
        step,
    } = this;
    walk.packed("steps of a matrix", [(0, age), (32, step)])?;
    walk.part(now)?;
    walk.part(next)
});

impl Shape {
    /// Of a state; nothing is allocated where there is room.
    pub(super) fn set(
        &mut self,
        positions: &Vec<Point3>,
        pressures: &Vec<Lane>,
        metrics: &Vec<Lane>,
    ) {
        self.is_set = true;
        self.positions.clone_from(positions);
        self.pressures.clone_from(pressures);
        self.metrics.clone_from(metrics);
    }
}

impl Following {
    /// That of rest, of a body with as many coordinates, lanes of pressures, and of what flows; nothing is allocated
    /// where there is room.
    pub(super) fn set_to_rest(&mut self) {
        (self.now.is_set, self.next.is_set) = (false, false);
        (self.age, self.step) = (0, 0);
    }

    /// Room for shapes of a state.
    pub(super) fn for_state(positions: &[Point3], pressures: &[Lane], metrics: &[Lane]) -> Self {
        let room = || Shape {
            is_set: false,
            positions: positions.to_vec(),
            pressures: pressures.to_vec(),
            metrics: metrics.to_vec(),
        };
        Self {
            now: room(),
            next: room(),
            age: 0,
            step: 0,
        }
    }

    /// A matrix is to be taken over in the step that begins.
    pub fn is_due(&self) -> bool {
        self.next.is_set && self.age >= DUE
    }

    /// It will be at the end of this step.
    pub fn is_nearly_due(&self) -> bool {
        self.next.is_set && self.age + 1 >= DUE
    }

    /// A matrix that is due is not there yet: it is taken over a step later.
    pub fn put_off(&mut self) {
        self.age = self.age.saturating_sub(1);
    }
}

/// What a step found of its matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follows {
    /// It goes on with it.
    On,
    /// Another one is to be made, of [`Following::next`].
    Begun,
    /// It goes on with that of rest.
    AtRest,
}
