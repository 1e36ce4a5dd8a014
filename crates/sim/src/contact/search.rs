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
use palpate_geometry::math::Vector3;
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
    /// How much farther than the body's net shows the forces of the last tick brought the tool in, m.
    pub sunk_m: f64,
    /// Radius over which the net spreads its force, m; 0 where it does not touch.
    pub patch_m: f64,
    /// By how much less it goes in where the net shows more than one place, m.
    pub less_m: f64,
    /// How far friction drew the surface aside from under the tool beyond what the body's net shows, m.
    pub drawn_m: Vector3,
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
        sunk_m,
        patch_m,
        less_m,
        drawn_m,
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
    walk.float(sunk_m)?;
    walk.float(patch_m)?;
    walk.float(less_m)?;
    walk.vector(drawn_m)?;
    for value in [u, v, budget_m, net_cost] {
        walk.float(value)?;
    }
    walk.point(queried)
});
