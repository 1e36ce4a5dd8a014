//! Many daemons: a lobby that starts them on this machine, one for each session, and what Agones learns of
//! one that it started elsewhere.
//!
//! ```text
//! requests ─▶ routes ─▶ Keeper (one thread) ─▶ processes `palpate serve …`
//!                 ▲        │ ready lines, ends
//!                 └────────┘
//! ```

mod agones;
mod daemon;
mod keeper;
mod lobby;
mod routes;
mod shelf;
mod sidecar;

pub use agones::{Agones, AgonesError, PORT_VARIABLE, port as agones_port};
pub use keeper::{Refusal, Session, SessionState};
pub use lobby::{Lobby, LobbyError, LobbySettings};
pub use shelf::{Offer, Shelf};
