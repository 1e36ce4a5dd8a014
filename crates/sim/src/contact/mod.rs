//! From poses to contact rows, and what is remembered of contact from tick to tick.
//!
//! ```text
//! near      which pairs can touch
//! find      for each of them the query, and its rows: tools here, bodies in between
//! points    follow (feet of tools), manifold (rigid), meeting and lying (bodies), stick, grip: places that last
//! feet      rows of contacts and samples
//! dent      how far a tool goes in beyond what a net shows, profile and face: its heights there; bounce: how rows of rigid bodies end a tick
//! warm      forces of the last tick, by row
//! ```

mod between;
pub(crate) mod bounce;
mod face;
pub(crate) mod feet;
pub(crate) mod find;
mod follow;
pub(crate) mod grip;
pub(crate) mod lying;
mod manifold;
mod meeting;
pub(crate) mod near;
pub(crate) mod near_field;
mod profile;
mod search;
pub(crate) mod stick;
pub(crate) mod warm;

pub use search::PairState;
pub(crate) use search::Search;
pub use warm::{Warm, WarmRow};
