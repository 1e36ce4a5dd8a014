//! Who may reach a daemon: what `serve`, `demo` and `play` share.

use crate::auth;
use crate::transport::{Access, Open};
use palpate_sim::scene::Scene;
use std::path::PathBuf;

/// Options of access.
#[derive(clap::Args, Debug, Clone, Default)]
#[command(next_help_heading = "Access")]
pub struct AccessArgs {
    /// Identity file of the daemon for TLS: clients need a certificate of the same authority, and do
    /// what its role allows (see `palpate auth`).
    #[arg(long, value_name = "FILE")]
    pub identity: Option<PathBuf>,
    /// Also listen, and connect, where everybody on the network can move tools and give commands.
    #[arg(long)]
    pub insecure: bool,
}

impl AccessArgs {
    /// With the rules of all roles of a scene.
    ///
    /// # Errors
    /// The instance name or a tool's id cannot be one.
    pub fn of(&self, instance: &str, scene: &Scene) -> anyhow::Result<Access> {
        let tools = (0..scene.tool_count()).map(|tool| scene.tool_id(tool));
        let rules = match &self.identity {
            None => None,
            Some(identity) => {
                auth::Identity::usable(identity)?;
                Some(auth::rules(instance, tools, self.insecure)?)
            }
        };
        Ok(Access {
            identity: self.identity.clone(),
            rules,
            insecure: self.insecure,
        })
    }
}

/// Says where others may come in, and lists it.
pub fn announce(open: Open) -> Vec<String> {
    let Open {
        mut everybody,
        others,
    } = open;
    if !everybody.is_empty() {
        let open = everybody.join(", ");
        tracing::warn!(
            open,
            "everybody on the network can move tools and give commands (--insecure)"
        );
    }
    if !others.is_empty() {
        let connect = others.join(", ");
        tracing::info!(
            connect,
            "whoever is let in there can move tools and give commands"
        );
    }
    everybody.extend(others.iter().map(|at| format!("{at} (whoever it lets in)")));
    everybody
}
