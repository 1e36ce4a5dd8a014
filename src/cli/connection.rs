//! How commands that talk to a daemon find it.

use crate::transport::DEFAULT_ENDPOINT;
use palpate_client::{Connect, Palpate};
use std::path::PathBuf;
use std::time::Duration;

#[derive(clap::Args, Debug, Clone)]
pub struct Connection {
    /// Endpoint of the daemon; can be repeated.
    #[arg(short = 'e', long, default_value = DEFAULT_ENDPOINT)]
    connect: Vec<String>,
    /// Instance name.
    #[arg(long, default_value = "default")]
    instance: String,
    /// Zenoh configuration file (JSON5).
    #[arg(long)]
    zenoh_config: Option<PathBuf>,
}

/// How long to wait for replies.
pub const PATIENCE: Duration = Duration::from_secs(5);

impl Connection {
    /// Connects as a client that sends and receives its own messages.
    pub fn open(&self) -> anyhow::Result<Palpate> {
        self.connect(false)
    }

    /// Connects as an observer, which also receives what other clients of the daemon publish.
    pub fn look_on(&self) -> anyhow::Result<Palpate> {
        self.connect(true)
    }

    /// Endpoints, for sessions of other protocols.
    pub fn endpoints(&self) -> Vec<String> {
        self.connect.clone()
    }

    fn connect(&self, onlooker: bool) -> anyhow::Result<Palpate> {
        let settings = Connect {
            endpoints: self.connect.clone(),
            instance: self.instance.clone(),
            zenoh_config: self.zenoh_config.clone(),
            timeout: PATIENCE,
            onlooker,
        };
        Ok(Palpate::connect(&settings)?)
    }
}
