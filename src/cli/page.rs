//! Serving the page: what `serve`, `demo` and `play` share.

use crate::transport::ViewSink;
use crate::viewer::{Viewer, ViewerSettings};
use palpate_adapters::rosbridge;
use palpate_client::links::is_loopback;
use palpate_sim::scene::Scene;
use std::net::SocketAddr;
use std::process::Stdio;
use std::sync::Arc;

/// Options of the page.
#[derive(clap::Args, Debug, Clone)]
#[command(next_help_heading = "Page and viewers")]
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
    /// A site whose pages may connect to /foxglove and /rosbridge, for example
    /// https://app.foxglove.dev; can be repeated.
    #[arg(long, value_name = "ORIGIN")]
    pub http_origin: Vec<String>,
    /// Let Foxglove and Lichtblick connect to this port of this machine (ws://localhost:8765).
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "8765")]
    pub foxglove: Option<u16>,
    /// Do not open the page in a browser (demo and view do where there is a desktop).
    #[arg(long)]
    pub no_open: bool,
}

impl PageArgs {
    /// The address of the page, if everybody on the network may do everything there.
    ///
    /// # Errors
    /// It is so, and no one said that it may be.
    pub fn everybody(&self, insecure: bool) -> anyhow::Result<Option<String>> {
        let wide = self.http.filter(|address| !is_loopback(address.ip()));
        let Some(address) = wide.filter(|_| !self.http_view_only) else {
            return Ok(None);
        };
        anyhow::ensure!(
            insecure,
            "--http {address} can be reached from other machines, and everybody there could move tools and give \
             commands: serve the page on 127.0.0.1 (and reach it through ssh -L), allow looking only with \
             --http-view-only, or say --insecure"
        );
        Ok(Some(format!("http://{address}/")))
    }

    /// Serves the page if it is asked for, and says where.
    ///
    /// # Errors
    /// It cannot be served there.
    pub fn start(
        &self,
        instance: &str,
        scene: &Arc<Scene>,
        session: &zenoh::Session,
        played: bool,
        open: &[String],
    ) -> anyhow::Result<Option<(Viewer, Box<dyn ViewSink>)>> {
        if self.http.is_none() && self.foxglove.is_none() {
            return Ok(None);
        }
        let settings = ViewerSettings {
            address: self.http,
            hosts: self.http_host.clone(),
            origins: self.http_origin.clone(),
            foxglove: self.foxglove,
            view_only: self.http_view_only,
            instance: instance.to_owned(),
            played,
            open: open.to_vec(),
        };
        let writable = !played && !self.http_view_only;
        let others = rosbridge::routes(session, instance, scene, writable);
        let (viewer, feed) = Viewer::start(&settings, scene, session, others)?;
        if let Some(url) = viewer.url() {
            eprintln!("page: {url}");
        }
        if let Some(url) = viewer.foxglove_url() {
            eprintln!("foxglove: {url}");
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
        // No one waits for it, but someone must.
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
