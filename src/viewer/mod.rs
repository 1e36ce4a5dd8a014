//! The viewer: one page on loopback, fed over a WebSocket.
//!
//! The bus thread hands newest states to watch channels and never waits; a small runtime of its own
//! serves the page. The page draws control nets, tools and forces; nothing is loaded from
//! elsewhere.

mod health;

use crate::transport::{LoopMetrics, ViewSink};
use axum::Router;
use axum::extract::State;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use palpate_proto::messages::{
    ContactSet, ControlNet, LoopStatus, RecorderState, ToolForce, ToolLink,
};
use palpate_sim::scene::Scene;
use serde::Serialize;
use std::net::SocketAddr;
use std::sync::{Arc, OnceLock, PoisonError};
use std::time::Duration;
use tokio::sync::{oneshot, watch};

const PAGE: &str = include_str!("page.html");
const SCRIPT: &str = include_str!("page.js");
/// Pictures a second.
const FRAME: Duration = Duration::from_millis(33);
/// Only our own page may be drawn and only our own socket opened.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'unsafe-inline'; connect-src 'self'; base-uri 'none'";

/// What the page draws. JSON, metres and newtons.
#[derive(Clone, Debug, Default, Serialize)]
struct Picture {
    nets: Vec<Net>,
    /// Grows when the bodies become others: displacements begin anew.
    scene: u32,
    tools: Vec<ToolView>,
    contacts: Vec<Contact>,
    tick: u64,
    late: u64,
    skipped: u64,
    step_p99_us: f64,
    /// Poses dropped before the loop, of all tools.
    refused: u64,
    recorder: RecorderState,
}

#[derive(Clone, Debug, Default, Serialize)]
struct Net {
    body: String,
    count: [u16; 2],
    points: Vec<[f32; 3]>,
    /// Rows and columns after which the net begins anew: no line goes on from there.
    gaps: [Vec<usize>; 2],
}

#[derive(Clone, Copy, Debug, Default, Serialize)]
struct ToolView {
    proxy: [f64; 3],
    /// x y z w.
    orientation: [f64; 4],
    force: [f64; 3],
    depth: f64,
}

/// The shape of a tool, in its frame: what `/tools.json` lists, by tool.
#[derive(Clone, Debug, Serialize)]
struct Outline {
    id: String,
    shape: &'static str,
    /// m.
    points: Vec<[f32; 3]>,
    /// Counter-clockwise seen from outside.
    triangles: Vec<[u32; 3]>,
}

#[derive(Clone, Copy, Debug, Default, Serialize)]
struct Contact {
    point: [f64; 3],
    normal: [f64; 3],
    depth: f64,
    force: [f64; 3],
}

/// A running viewer; it ends when dropped.
pub struct Viewer {
    address: SocketAddr,
    _stop: oneshot::Sender<()>,
}

/// Takes states for the page.
pub struct Feed {
    picture: Picture,
    gaps: Vec<(String, [Vec<usize>; 2])>,
    channel: watch::Sender<String>,
    health: Arc<health::Newest>,
    /// What `/tools.json` answers, once it is known.
    outlines: Arc<OnceLock<String>>,
    last: std::time::Instant,
}

impl Viewer {
    /// Serves on an address (port 0: any free one).
    ///
    /// # Errors
    /// The address is taken, or no thread could be made.
    pub fn start(address: SocketAddr) -> std::io::Result<(Self, Feed)> {
        let listener = std::net::TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()?;
        let (channel, pictures) = watch::channel(String::from("{}"));
        let health = Arc::new(health::Newest::default());
        let routes = health::routes(health.clone());
        let outlines = Arc::new(OnceLock::<String>::new());
        let answer = outlines.clone();
        let (stop, stopped) = oneshot::channel::<()>();
        std::thread::Builder::new()
            .name("palpate-viewer".into())
            .spawn(move || {
                runtime.block_on(async move {
                    let app = Router::new()
                        .route("/", get(async || asset("text/html; charset=utf-8", PAGE)))
                        .route(
                            "/page.js",
                            get(async || asset("text/javascript; charset=utf-8", SCRIPT)),
                        )
                        .route(
                            "/tools.json",
                            get(move || {
                                let text = answer.get().map_or("[]", String::as_str);
                                std::future::ready(asset("application/json", text.to_owned()))
                            }),
                        )
                        .route("/live", get(live))
                        .with_state(pictures)
                        .merge(routes);
                    match tokio::net::TcpListener::from_std(listener) {
                        // Open sockets do not keep the daemon: the runtime ends when it is asked to.
                        Ok(listener) => {
                            tokio::select! {
                                served = axum::serve(listener, app) => if let Err(error) = served {
                                    tracing::warn!(%error, "viewer");
                                },
                                _ = stopped => {}
                            }
                        }
                        Err(error) => tracing::warn!(%error, "viewer"),
                    }
                });
            })?;
        let feed = Feed {
            picture: Picture::default(),
            gaps: Vec::new(),
            channel,
            health,
            outlines,
            last: std::time::Instant::now(),
        };
        Ok((
            Self {
                address,
                _stop: stop,
            },
            feed,
        ))
    }

    /// Where the page is.
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }
}

fn asset(kind: &'static str, text: impl IntoResponse) -> Response {
    let headers = [
        (header::CONTENT_TYPE, kind),
        (header::CONTENT_SECURITY_POLICY, POLICY),
    ];
    (headers, text).into_response()
}

/// A page of another site must not listen in: its Origin is not our Host.
fn same_origin(headers: &HeaderMap) -> bool {
    let text = |name| {
        headers
            .get(name)
            .and_then(|value: &header::HeaderValue| value.to_str().ok())
    };
    match (text(header::ORIGIN), text(header::HOST)) {
        (None, _) => true,
        (Some(origin), Some(host)) => origin.strip_prefix("http://") == Some(host),
        (Some(_), None) => false,
    }
}

async fn live(
    State(pictures): State<watch::Receiver<String>>,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if !same_origin(&headers) {
        return (StatusCode::FORBIDDEN, "another site's page may not watch").into_response();
    }
    upgrade.on_upgrade(|socket| watch_over(socket, pictures))
}

async fn watch_over(mut socket: WebSocket, mut pictures: watch::Receiver<String>) {
    loop {
        let text = pictures.borrow_and_update().clone();
        if socket.send(Message::Text(text.into())).await.is_err() {
            return;
        }
        tokio::time::sleep(FRAME).await;
        if pictures.changed().await.is_err() {
            return;
        }
    }
}

impl Feed {
    /// Gives the page what does not change from tick to tick: where nets are in pieces, and the
    /// shapes of tools.
    #[must_use]
    pub fn with_scene(mut self, scene: &Scene) -> Self {
        self.gaps = scene.net_gaps();
        let size_m = (0..scene.body_count())
            .map(|body| scene.rest_surface(body).size())
            .fold(1e-3, f64::max);
        let outlines = (0..scene.tool_count()).map(|tool| {
            let mesh = scene.tool_outline(tool, size_m);
            Outline {
                id: scene.tool_id(tool).to_owned(),
                shape: scene.shape_name(tool),
                points: (mesh.points.iter())
                    .map(|p| [p.x as f32, p.y as f32, p.z as f32])
                    .collect(),
                triangles: mesh.triangles,
            }
        });
        let outlines: Vec<Outline> = outlines.collect();
        let _ = self
            .outlines
            .set(serde_json::to_string(&outlines).unwrap_or_default());
        self
    }

    fn show(&mut self) {
        if self.last.elapsed() >= FRAME && self.channel.receiver_count() > 0 {
            self.last = std::time::Instant::now();
            let _ = self
                .channel
                .send(serde_json::to_string(&self.picture).unwrap_or_default());
        }
    }
}

impl ViewSink for Feed {
    fn force(&mut self, tool: usize, force: &ToolForce) {
        if self.picture.tools.len() <= tool {
            self.picture.tools.resize(tool + 1, ToolView::default());
        }
        self.picture.tools[tool] = ToolView {
            proxy: force.proxy_position,
            orientation: force.proxy_orientation,
            force: force.force,
            depth: force.depth,
        };
        self.picture.tick = force.tick;
        self.show();
    }

    fn net(&mut self, net: &ControlNet) {
        let points = net.points.iter().map(|p| p.map(|x| x as f32)).collect();
        let gaps = self
            .gaps
            .iter()
            .find(|(body, _)| *body == net.body)
            .map(|(_, gaps)| gaps.clone())
            .unwrap_or_default();
        let drawn = Net {
            body: net.body.clone(),
            count: [net.count_u, net.count_v],
            points,
            gaps,
        };
        match self
            .picture
            .nets
            .iter_mut()
            .find(|old| old.body == net.body)
        {
            Some(old) => *old = drawn,
            None => self.picture.nets.push(drawn),
        }
        self.show();
    }

    fn contacts(&mut self, set: &ContactSet) {
        let drawn = set.contacts.iter().map(|c| Contact {
            point: c.point,
            normal: c.normal,
            depth: c.depth,
            force: c.force,
        });
        self.picture.contacts = drawn.collect();
        self.show();
    }

    fn bodies(&mut self, ids: &[&str], gaps: Vec<(String, [Vec<usize>; 2])>) {
        self.gaps = gaps;
        self.picture
            .nets
            .retain(|net| ids.contains(&net.body.as_str()));
        self.picture.contacts.clear();
        self.picture.scene += 1;
        self.show();
    }

    fn status(&mut self, status: &LoopStatus) {
        self.picture.late = status.late_ticks;
        self.picture.skipped = status.skipped_ticks;
        self.picture.step_p99_us = status.step.p99_ns as f64 * 1e-3;
        self.picture.refused = status
            .tools
            .iter()
            .flat_map(ToolLink::refused)
            .map(|(_, count)| count)
            .sum();
        self.picture.recorder = status.recorder;
        self.show();
    }

    fn figures(&mut self, figures: &LoopMetrics) {
        let newest = (std::time::Instant::now(), figures.clone());
        *self.health.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(newest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_its_own_page_may_open_the_socket() {
        let headers = |origin: Option<&str>| {
            let mut headers = HeaderMap::new();
            headers.insert(header::HOST, "127.0.0.1:8080".parse().unwrap());
            if let Some(origin) = origin {
                headers.insert(header::ORIGIN, origin.parse().unwrap());
            }
            same_origin(&headers)
        };
        assert!(headers(None) && headers(Some("http://127.0.0.1:8080")));
        assert!(!headers(Some("http://evil.example")) && !headers(Some("null")));
    }

    // The page draws no line across a gap: it gets a list of them and uses it.
    #[test]
    fn nets_in_pieces_are_drawn_in_pieces() {
        let path = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/vessel.toml"));
        let loaded = palpate_sim::scene::file::load(path).unwrap();
        let scene = Scene::build(&loaded.spec, path.parent().unwrap()).unwrap();
        let (_viewer, feed) = Viewer::start("127.0.0.1:0".parse().unwrap()).unwrap();
        let mut feed = feed.with_scene(&scene);
        let net = ControlNet {
            tick: 1,
            revision: 1,
            body: "vessel".into(),
            degree_u: 3,
            degree_v: 2,
            count_u: 34,
            count_v: 15,
            points: Vec::new(),
            weights: None,
        };
        feed.net(&net);
        feed.net(&ControlNet {
            body: "other".into(),
            ..net
        });
        let picture = serde_json::to_value(&feed.picture).unwrap();
        assert_eq!(picture["nets"][0]["gaps"], serde_json::json!([[16], [7]]));
        assert_eq!(picture["nets"][1]["gaps"], serde_json::json!([[], []]));
        assert!(
            SCRIPT.contains("!net.gaps[0].includes(i)")
                && SCRIPT.contains("!net.gaps[1].includes(j)")
        );
    }

    #[test]
    fn the_page_is_served_with_its_policy() {
        use std::io::{Read as _, Write as _};
        let (viewer, _feed) = Viewer::start("127.0.0.1:0".parse().unwrap()).unwrap();
        let mut stream = std::net::TcpStream::connect(viewer.address).unwrap();
        stream
            .write_all(b"GET / HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
            .unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        assert!(
            text.starts_with("HTTP/1.1 200")
                && text.contains("content-security-policy")
                && text.contains("Palpate")
        );
    }
}
