//! How commands that talk to a daemon find it.

use crate::auth::Identity;
use crate::transport::{
    self, Access, DEFAULT_ENDPOINT, DEFAULT_SECURE_ENDPOINT, Role, SessionSettings,
};
use palpate_client::{ClientError, Connect, Palpate};
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[derive(clap::Args, Debug, Clone)]
#[command(next_help_heading = "Connection")]
pub struct Connection {
    /// Endpoint of the daemon; can be repeated [default: tcp/127.0.0.1:7447, with --identity
    /// tls/127.0.0.1:7447].
    #[arg(short = 'e', long)]
    pub connect: Vec<String>,
    /// Instance name.
    #[arg(long, default_value = "default")]
    pub instance: String,
    /// Zenoh configuration file (JSON5).
    #[arg(long)]
    pub zenoh_config: Option<PathBuf>,
    /// Identity file for endpoints with TLS (see `palpate auth issue`).
    #[arg(long, value_name = "FILE")]
    pub identity: Option<PathBuf>,
    /// Also connect to other machines without TLS, where no one knows who answers.
    #[arg(long)]
    pub insecure: bool,
}

/// How long to wait for replies.
pub const PATIENCE: Duration = Duration::from_secs(5);

impl Connection {
    /// Connects as a client that sends and receives its own messages.
    pub fn open(&self) -> anyhow::Result<Palpate> {
        self.connect(false)
    }

    /// Connects as [`Connection::open`] does; a daemon that is not there yet is waited for.
    pub fn open_within(&self, wait: Duration) -> anyhow::Result<Palpate> {
        let begun = Instant::now();
        loop {
            match Palpate::connect(&self.settings(false)?) {
                Err(ClientError::Unreachable { .. }) if begun.elapsed() < wait => {
                    std::thread::sleep(Duration::from_millis(50));
                }
                done => return Ok(done?),
            }
        }
    }

    /// Connects as an observer, which also receives what other clients of the daemon publish.
    pub fn look_on(&self) -> anyhow::Result<Palpate> {
        self.connect(true)
    }

    /// A session without our client, for other protocols.
    pub fn session(&self) -> anyhow::Result<zenoh::Session> {
        Ok(transport::open(&SessionSettings {
            connect: self.endpoints(),
            config: self.zenoh_config.clone(),
            role: Role::Client,
            access: Access {
                identity: self.usable_identity()?,
                insecure: self.insecure,
                ..Access::default()
            },
            ..SessionSettings::default()
        })?)
    }

    fn endpoints(&self) -> Vec<String> {
        match (&self.identity, self.connect.is_empty()) {
            (_, false) => self.connect.clone(),
            (None, true) => vec![DEFAULT_ENDPOINT.to_owned()],
            (Some(_), true) => vec![DEFAULT_SECURE_ENDPOINT.to_owned()],
        }
    }

    fn usable_identity(&self) -> anyhow::Result<Option<PathBuf>> {
        self.identity
            .iter()
            .try_for_each(|path| Identity::usable(path).map(drop))?;
        Ok(self.identity.clone())
    }

    fn connect(&self, onlooker: bool) -> anyhow::Result<Palpate> {
        Ok(Palpate::connect(&self.settings(onlooker)?)?)
    }

    fn settings(&self, onlooker: bool) -> anyhow::Result<Connect> {
        Ok(Connect {
            endpoints: self.endpoints(),
            instance: self.instance.clone(),
            zenoh_config: self.zenoh_config.clone(),
            identity: self.usable_identity()?,
            timeout: PATIENCE,
            onlooker,
            insecure: self.insecure,
        })
    }
}
