//! What goes on when one scene becomes another between two ticks.

use super::state::SceneState;
use crate::body::{Deformable, DeformableState, SharedMomentum, Transfer};
use crate::contact::PairState;
use crate::party::BodyState;
use crate::scene::{Origin, Scene};
use crate::side_by_side::side_by_side;
use palpate_geometry::math::Vector3;

/// Where the bodies of a scene come from, and what those need that are pieces of another.
#[derive(Debug)]
pub struct CarryOver {
    /// By body.
    origins: Vec<Origin>,
    /// By body; none but of pieces.
    transfers: Vec<Option<Transfer>>,
    /// Bodies of the old scene that are in pieces now.
    cut: Vec<usize>,
}

impl CarryOver {
    /// From one scene to another, whose bodies come from `origins`.
    pub fn new(old: &Scene, new: &Scene, origins: Vec<Origin>) -> Self {
        debug_assert_eq!(origins.len(), new.bodies.len(), "an origin a body");
        let from = |origin: &Origin| match *origin {
            Origin::Piece { from } => Some(from),
            Origin::Kept { .. } | Origin::New => None,
        };
        let pieces: Vec<(usize, usize)> = (origins.iter().enumerate())
            .filter_map(|(body, origin)| Some((body, from(origin)?)))
            .collect();
        let made = side_by_side(pieces.len(), |k| {
            let (body, from) = pieces[k];
            transfer((old, from), (new, body))
        });
        let mut transfers: Vec<Option<Transfer>> = origins.iter().map(|_| None).collect();
        for ((body, _), made) in pieces.into_iter().zip(made) {
            transfers[body] = made;
        }
        let mut cut: Vec<usize> = origins.iter().filter_map(from).collect();
        cut.dedup();
        let carry = Self {
            origins,
            transfers,
            cut,
        };
        debug_assert!(
            carry.origins.iter().enumerate().all(|(body, origin)| {
                from(origin).is_none() || !new.deforms(body) || carry.transfers[body].is_some()
            }),
            "a transfer a piece that deforms"
        );
        carry
    }

    /// Pieces of a body of the old scene.
    fn pieces(&self, body: usize) -> impl Iterator<Item = (usize, &Transfer)> {
        let all = self.origins.iter().zip(&self.transfers).enumerate();
        let of = move |origin: &Origin| *origin == Origin::Piece { from: body };
        all.filter(move |(_, (origin, _))| of(origin))
            .filter_map(|(piece, (_, transfer))| Some((piece, transfer.as_ref()?)))
    }
}

/// From a body of one scene to its piece in another.
fn transfer((old, body): (&Scene, usize), (new, piece): (&Scene, usize)) -> Option<Transfer> {
    let (whole, part) = (old.deformable(body)?, new.deformable(piece)?);
    let surfaces = old.rest_surface(body).zip(new.rest_surface(piece));
    match old.is_membrane(body) {
        true => {
            let (skin, sheet) = surfaces?;
            Transfer::of_membrane((whole, skin), (part, sheet))
        }
        false => Transfer::new(whole, part, surfaces.map(|(skin, new)| [skin, new])),
    }
}

impl Scene {
    /// Fills the state of this scene with what the old one goes on with: time, tools, the bodies it shares with it, and the
    /// matter of those that are in pieces now. Contacts begin anew. `state` is an initial state of this scene; nothing is
    /// allocated.
    pub fn carry_over(
        &self,
        old: &Scene,
        from: &SceneState,
        carry: &CarryOver,
        state: &mut SceneState,
    ) {
        let origins = &carry.origins;
        debug_assert_eq!(origins.len(), self.bodies.len(), "an origin a body");
        (state.tick, state.run, state.quality) = (from.tick, from.run, from.quality);
        state.faulted = from.faulted;
        (state.frame, state.carried) = (from.frame, from.carried);
        // Whoever keeps a net of the old scene must see that this is another.
        let revision = from
            .bodies
            .iter()
            .map(|body| body.revision)
            .max()
            .unwrap_or(0)
            + 1;
        for (body, origin) in origins.iter().enumerate() {
            let new = &mut state.bodies[body];
            if let Origin::Kept { from: old, moved } = *origin {
                let old = &from.bodies[old];
                if let (Some(new), Some(old)) = (&mut new.deformable, &old.deformable) {
                    new.clone_from(old);
                    if new.is_left_alone() {
                        new.leave_alone(false);
                    }
                    if moved != Vector3::zeros() {
                        new.positions.iter_mut().for_each(|p| *p += moved);
                    }
                }
                new.loads.clone_from(&old.loads);
                (new.moved_m, new.phase, new.put_off) = (old.moved_m, old.phase, old.put_off);
                if let (Some(new), Some(old)) = (&mut new.rigid, &old.rigid) {
                    *new = old.moved(&moved);
                    if let Some(flight) = new.flight_mut().filter(|flight| flight.is_left_alone()) {
                        flight.leave_alone(false);
                    }
                }
            }
            new.revision = revision;
        }
        for &body in &carry.cut {
            let was = &from.bodies[body].deformable;
            if let (Some(whole), Some(was)) = (old.deformable(body), was) {
                self.carry_pieces(carry, body, (whole, was), &mut state.bodies);
            }
        }
        for (new, old) in state.tools.iter_mut().zip(&from.tools) {
            *new = *old;
            // It held on to places of a body that may be no more.
            new.grip = Default::default();
        }
        state.pairs.fill(PairState::default());
        state.warm.forget();
    }

    /// Has the pieces of a body go on with its motion: with all of its momentum and angular momentum.
    fn carry_pieces(
        &self,
        carry: &CarryOver,
        body: usize,
        (whole, was): (&Deformable, &DeformableState),
        bodies: &mut [BodyState],
    ) {
        let (mut before, mut after) = (SharedMomentum::default(), SharedMomentum::default());
        before.add(whole, was);
        for (piece, transfer) in carry.pieces(body) {
            let parts = (self.deformable(piece)).zip(bodies[piece].deformable.as_mut());
            if let Some((part, now)) = parts {
                transfer.carry([whole, part], was, now);
                after.add(part, now);
            }
        }
        let missing = after.missing(&before);
        for (piece, _) in carry.pieces(body) {
            let parts = (self.deformable(piece)).zip(bodies[piece].deformable.as_mut());
            if let Some((part, now)) = parts {
                missing.add_to(part, now);
            }
        }
    }
}
