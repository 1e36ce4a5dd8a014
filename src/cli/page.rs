//! Serving the page: what `serve`, `demo` and `play` share.

use crate::transport::ViewSink;
use crate::viewer::{Viewer, ViewerSettings};
use palpate_sim::scene::Scene;
use std::net::SocketAddr;

/// Options of the page.
#[derive(clap::Args, Debug, Clone)]
pub struct PageArgs {
    /// Serve the page at this address, for example 127.0.0.1:8080.
    #[arg(long, value_name = "ADDRESS")]
    pub http: Option<SocketAddr>,
    /// Pages may only view: no tool is moved and no command sent from them.
    #[arg(long, requires = "http")]
    pub http_view_only: bool,
    /// A name under which the page may be opened, beside numbers and localhost; can be repeated.
    #[arg(long, value_name = "NAME", requires = "http")]
    pub http_host: Vec<String>,
    /// Do not open the page in a browser.
    #[arg(long)]
    pub no_open: bool,
}

impl PageArgs {
    /// Serves the page if it is asked for, and says where.
    ///
    /// # Errors
    /// It cannot be served there.
    pub fn start(
        &self,
        instance: &str,
        scene: &Scene,
        session: &zenoh::Session,
        played: bool,
    ) -> anyhow::Result<Option<(Viewer, Box<dyn ViewSink>)>> {
        let Some(address) = self.http else {
            return Ok(None);
        };
        let settings = ViewerSettings {
            address,
            hosts: self.http_host.clone(),
            view_only: self.http_view_only,
            instance: instance.to_owned(),
            played,
        };
        let (viewer, feed) = Viewer::start(&settings, scene, session)?;
        eprintln!("page: {}", viewer.url());
        if !address.ip().is_loopback() && !self.http_view_only {
            eprintln!(
                "note: everyone who reaches {address} can move tools and give commands; --http-view-only forbids it"
            );
        }
        Ok(Some((viewer, Box::new(feed))))
    }
}
