//! What a search for contacts reads and writes.

use super::near::Near;
use super::warm::Warm;
use crate::party::{BodyScratch, BodyState, ToolScratch, ToolState};
use crate::rest::Rest;
use crate::scene::Scene;
use crate::solve::indentation::Touch;
use crate::solve::proxy::ProxyState;
use crate::solve::rows::{RowSet, SampleInTouch};
use palpate_geometry::contact::dispatch::Narrow;
use palpate_geometry::stateful;
use palpate_geometry::surface::WarmFoot;

/// What a search for contacts reads and writes.
pub(crate) struct Search<'a> {
    pub scene: &'a Scene,
    pub tools: &'a [ToolState],
    pub states: &'a [BodyState],
    pub warm: &'a Warm,
    pub near: &'a Near,
    /// By pair.
    pub pairs: &'a mut [PairState],
    pub tool_parts: &'a mut [ToolScratch],
    pub bodies: &'a mut [BodyScratch],
    /// By pair: the queries.
    pub narrow: &'a mut [Narrow],
    pub rest: &'a mut Rest,
    pub rows: &'a mut RowSet,
    /// Samples of one pair in touch.
    pub hits: &'a mut Vec<SampleInTouch>,
    /// By pair.
    pub touches: &'a mut [Touch],
}

/// State of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PairState {
    /// The proxy's.
    pub proxy: ProxyState,
    /// Every which of the body's samples is a row, in u and v: 2 and more where the contact has more
    /// than there are rows; 0 before there was a contact.
    pub thinned: u8,
}

stateful!(PairState, |this, walk| {
    let PairState {
        proxy:
            ProxyState {
                touching,
                below,
                known,
                clear_m,
                met,
                deepest_m,
                foot,
                queried,
            },
        thinned,
    } = this;
    let WarmFoot {
        u,
        v,
        budget_m,
        net_cost,
    } = foot;
    walk.packed(
        "proxy",
        [
            (0, touching),
            (1, below),
            (2, known),
            (3, met),
            (8, thinned),
        ],
    )?;
    walk.float(clear_m)?;
    walk.float(deepest_m)?;
    for value in [u, v, budget_m, net_cost] {
        walk.float(value)?;
    }
    walk.point(queried)
});
