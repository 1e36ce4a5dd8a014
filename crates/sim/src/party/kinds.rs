//! Of which kind a body is.

use super::body::{BodyScratch, BodyState, Of};
use super::contract::Party;
use super::fixed::Fixed;
use super::free::Freed;
use super::on_coupling::OnCoupling;
use crate::scene::{BodyModel, DeformingBody, Mover, Scene};
use std::ops::Deref;

/// A body of any kind.
pub(crate) enum BodyParty<'a> {
    Fixed(Of<'a, Fixed>),
    Moved(Of<'a, &'a Mover>),
    Free(Of<'a, Freed<'a>>),
    Deforming(Of<'a, &'a DeformingBody>),
}

impl<'a> Deref for BodyParty<'a> {
    type Target = dyn Party<State = BodyState, Scratch = BodyScratch> + 'a;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Fixed(party) => party,
            Self::Moved(party) => party,
            Self::Free(party) => party,
            Self::Deforming(party) => party,
        }
    }
}

impl Scene {
    /// A body as a party of contact: the one place that says of which kind it is.
    pub(crate) fn party(&self, index: usize) -> BodyParty<'_> {
        fn of<K>(scene: &Scene, index: usize, kind: K) -> Of<'_, K> {
            let body = &scene.bodies[index];
            Of {
                scene,
                index,
                body,
                kind,
            }
        }
        let body = &self.bodies[index];
        match (&body.model, &body.mover) {
            (BodyModel::Deforming(kind), _) => BodyParty::Deforming(of(self, index, kind)),
            (BodyModel::Rigid, None) => BodyParty::Fixed(of(self, index, Fixed)),
            (BodyModel::Rigid, Some(mover)) => match mover.free() {
                Some(free) => BodyParty::Free(of(self, index, Freed { mover, free })),
                None => BodyParty::Moved(of(self, index, mover)),
            },
        }
    }

    /// All bodies.
    pub(crate) fn parties(&self) -> impl Iterator<Item = BodyParty<'_>> {
        (0..self.bodies.len()).map(|index| self.party(index))
    }

    /// All tools.
    pub(crate) fn tool_parties(&self) -> impl Iterator<Item = OnCoupling<'_>> {
        (0..self.tools.len()).map(|index| self.tool_party(index))
    }

    /// A tool as a party of contact.
    pub(crate) fn tool_party(&self, index: usize) -> OnCoupling<'_> {
        OnCoupling {
            scene: self,
            index,
            tool: &self.tools[index],
        }
    }
}
