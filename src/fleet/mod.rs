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
mod session;
mod settings;
mod shelf;
mod sidecar;

pub use agones::{Agones, AgonesError, PORT_VARIABLE, port as agones_port};
pub use lobby::{Lobby, LobbyError};
pub use session::{Refusal, Session, SessionState};
pub use settings::LobbySettings;
pub use shelf::{Offer, Shelf};
