//! How commands that talk to a daemon find it.

use crate::transport::DEFAULT_ENDPOINT;
use palpate_client::{Connect, Palpate};
use std::path::PathBuf;
use std::time::Duration;

#[derive(clap::Args, Debug, Clone)]
pub struct Connection {
    /// Where the daemon listens; several may be given.
    #[arg(short = 'e', long, default_value = DEFAULT_ENDPOINT)]
    connect: Vec<String>,
    /// Instance name.
    #[arg(long, default_value = "default")]
    instance: String,
    /// Stock Zenoh JSON5 configuration.
    #[arg(long)]
    zenoh_config: Option<PathBuf>,
}

/// How long to wait for answers.
pub const PATIENCE: Duration = Duration::from_secs(5);

impl Connection {
    /// Connects.
    pub fn open(&self) -> anyhow::Result<Palpate> {
        self.connect(false)
    }

    /// Connects to look on: hears what other clients of the daemon publish.
    pub fn look_on(&self) -> anyhow::Result<Palpate> {
        self.connect(true)
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
