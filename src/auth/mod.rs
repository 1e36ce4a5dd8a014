//! Who may touch: certificates with roles, and the rules that a daemon makes of them.
//!
//! ```text
//! Authority (ca.pem, ca.key) ─▶ identity file: key, certificate with a role, the authority's certificate
//! identity of a client ─▶ TLS ─▶ role (common name) ─▶ rules(instance, tools): keys and verbs
//! ```
//! TLS and the enforcement are Zenoh's; here is how they are configured. An identity file is a Zenoh
//! configuration, so that clients in any language can use it.

mod authority;
mod identity;
mod role;
mod rules;

pub use authority::{Authority, Request};
pub use identity::Identity;
pub use role::Role;
pub use rules::{Grant, grants, rules};

use std::path::PathBuf;

/// Why an identity cannot be made or read.
#[derive(Debug, thiserror::Error)]
pub enum AuthError {
    /// The file system.
    #[error("{path}: {source}")]
    Io {
        /// File.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// A file is in the way: keys are never overwritten.
    #[error("{0} exists already; nothing is overwritten: name another directory, or move it away")]
    Exists(PathBuf),
    /// Others have the key too.
    #[error("{0}")]
    Readable(String),
    /// No authority is there.
    #[error("{0} has no ca.pem and ca.key; `palpate auth init {0}` makes them")]
    NoAuthority(PathBuf),
    /// A key or certificate that does not parse, or cannot be made.
    #[error("{what}: {reason}")]
    Certificate {
        /// Which.
        what: String,
        /// What is wrong.
        reason: String,
    },
    /// A role that cannot be.
    #[error(transparent)]
    Id(#[from] palpate_proto::keys::IdError),
}
