//! Serving the page: what `serve`, `demo` and `play` share.

use crate::transport::ViewSink;
use crate::viewer::{Viewer, ViewerSettings};
use palpate_sim::scene::Scene;
use std::net::SocketAddr;
use std::process::Stdio;

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
    /// Do not open the page in a browser (demo and view do where there is a desktop).
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

/// Opens a page in the browser of the desktop, if there is one.
pub fn open_in_browser(url: &str) {
    let Some((program, arguments)) = opener() else {
        return;
    };
    let started = std::process::Command::new(program)
        .args(arguments)
        .arg(url)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    match started {
        // Nobody waits for it, but somebody must.
        Ok(mut child) => drop(std::thread::spawn(move || child.wait())),
        Err(error) => tracing::debug!(%error, program, "opening the page"),
    }
}

/// What opens addresses here.
fn opener() -> Option<(&'static str, &'static [&'static str])> {
    if cfg!(target_os = "macos") {
        return Some(("open", &[]));
    }
    if cfg!(windows) {
        return Some(("cmd", &["/C", "start", ""]));
    }
    let desktop = ["DISPLAY", "WAYLAND_DISPLAY"]
        .iter()
        .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()));
    desktop.then_some(("xdg-open", &[]))
}
