//! A body: its state and its buffers.

use super::flight::Gives;
use super::rigid::{RigidScratch, RigidState, RigidStep};
use crate::body::{DeformableScratch, DeformableState};
use crate::in_place::clone_in_place;
use crate::scene::{Body, Scene};
use crate::solve::side::Sided;
use crate::tick::record::TickFault;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::skin::{Skin, SkinSide, SkinSolver};
use palpate_geometry::stateful;

/// State of a body.
#[derive(Debug, Default, PartialEq)]
pub struct BodyState {
    /// Nodes, when it deforms.
    pub deformable: Option<DeformableState>,
    /// Grows with every change of the net.
    pub revision: u64,
    /// How far the farthest control point moved in the last tick, m.
    pub moved_m: f64,
    /// Ticks since the body's step began, for bodies that step once in several ticks; those by which it
    /// was put off do not count.
    pub phase: u32,
    /// The next tick neither begins nor takes over a step: it is late.
    pub put_off: bool,
    /// (coordinates), N: contact forces of the tick in which that step began; empty for bodies that
    /// step every tick.
    pub loads: Vec<Vector3>,
    /// Where it is, when it is rigid and moves.
    pub rigid: Option<RigidState>,
}

clone_in_place!(BodyState {
    deformable,
    revision,
    moved_m,
    phase,
    put_off,
    loads,
    rigid
});

impl BodyState {
    /// It lies at rest, and may sleep with its contacts.
    pub(crate) fn lies_still(&self) -> bool {
        let free = self.rigid.as_ref().and_then(RigidState::flight);
        self.deformable
            .as_ref()
            .is_some_and(|body| body.lies_still())
            || free.is_some_and(|flight| flight.lies_still())
    }

    /// It sleeps.
    pub(crate) fn is_left_alone(&self) -> bool {
        let free = self.rigid.as_ref().and_then(RigidState::flight);
        self.deformable
            .as_ref()
            .is_some_and(|body| body.is_left_alone())
            || free.is_some_and(|flight| flight.is_left_alone())
    }
}

stateful!(BodyState, |this, walk| {
    let BodyState {
        deformable,
        revision,
        moved_m,
        phase,
        put_off,
        loads,
        rigid,
    } = this;
    walk.word(revision)?;
    walk.float(moved_m)?;
    if let Some(deformable) = deformable {
        walk.part(deformable)?;
        if !loads.is_empty() {
            walk.packed("phase of a body's step", [(0, phase), (32, put_off)])?;
            walk.triples(loads)?;
        }
    }
    if let Some(rigid) = rigid {
        walk.part(rigid)?;
    }
    Ok(())
});

/// Buffers of a body.
#[derive(Debug)]
pub struct BodyScratch {
    /// As it stands.
    pub(crate) skin: Skin,
    pub(crate) solver: SkinSolver,
    /// Box of the net now and after free motion: the surface stays in it through the tick.
    pub(crate) bounds: (Point3, Point3),
    pub(super) deforming: Option<DeformingScratch>,
    /// Why it was set back in this tick.
    pub(crate) fault: Option<TickFault>,
    /// How far it goes in the tick under way, when it is rigid and moves.
    pub(crate) step: RigidStep,
    pub(super) rigid: Option<Box<RigidScratch>>,
}

impl BodyScratch {
    /// Of a body that stands still.
    pub(crate) fn of(body: &Body) -> Self {
        Self {
            skin: body.skin.clone(),
            solver: SkinSolver::new(&body.skin),
            bounds: box_of(body.skin.points()),
            deforming: None,
            fault: None,
            step: RigidStep::NONE,
            rigid: None,
        }
    }

    /// The body as points see it that keep their side of it.
    pub(crate) fn sided(&mut self, body: &Body) -> Sided<'_> {
        Sided {
            skin: &self.skin,
            solver: &mut self.solver,
            size_m: body.size_m,
            two_sided: body.two_sided,
        }
    }

    /// The body as contact queries take it.
    pub(crate) fn side(&mut self) -> SkinSide<'_> {
        SkinSide {
            skin: &self.skin,
            solver: &mut self.solver,
        }
    }
}

/// Buffers of a body that deforms.
#[derive(Debug)]
pub(crate) struct DeformingScratch {
    pub deformable: DeformableScratch,
    /// Net after the next free motion.
    pub predicted_net: Vec<Point3>,
    /// What one more iteration changed of it.
    pub change: Vec<Vector3>,
    pub stepped: Stepped,
}

/// How a body's step goes in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stepped {
    /// It goes on elsewhere, or is put off.
    Not,
    /// It is taken in the tick.
    Here,
    /// It was taken elsewhere, with the free motion of the next.
    Elsewhere,
}

impl BodyScratch {
    /// What the body gives way in this tick, when it is rigid and free.
    pub(crate) fn gives(&self) -> Option<&Gives> {
        self.rigid.as_ref()?.gives.as_ref()
    }
}

/// Least and greatest coordinates.
pub(crate) fn box_of(points: &[Point3]) -> (Point3, Point3) {
    let infinite = Point3::from([f64::INFINITY; 3]);
    points.iter().fold((infinite, -infinite), |(low, high), p| {
        (low.inf(p), high.sup(p))
    })
}

/// A body with its constants of one kind.
pub(crate) struct Of<'a, K> {
    pub scene: &'a Scene,
    pub index: usize,
    pub body: &'a Body,
    pub kind: K,
}
