//! The page of recordings: files by ranges, and what their scenes look like.

use super::files;
use super::session::{ListedRecording, SessionInfo, json};
use super::{ViewerError, ViewerSettings, listen};
use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Path as UrlPath, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use palpate_http::{Hosts, Server};
use palpate_proto::codec::encode;
use palpate_proto::text::printable;
use palpate_record::{Session, recorded_scene};
use palpate_wire::{bodies_inside, first_snapshot, tool_outlines};
use sha2::Digest as _;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// Read from the disk at once.
const BLOCK: u64 = 1 << 20;

/// A recording that is served.
struct Served {
    path: PathBuf,
    /// Of its scene, or why that cannot be built.
    made: OnceLock<Result<Made, String>>,
}

/// What pages get that is made from the scene of a recording.
#[derive(Clone)]
struct Made {
    snapshot: Bytes,
    outlines: Bytes,
    inside: Bytes,
}

type All = Arc<Vec<Served>>;

/// A server of recordings; it ends when dropped.
pub struct RecordingsViewer {
    server: Server,
}

impl RecordingsViewer {
    /// Serves these files; the second may be `against` the first.
    ///
    /// # Errors
    /// The address is taken, or the system refused a thread.
    pub fn start(
        settings: &ViewerSettings,
        files: &[PathBuf],
        against: bool,
    ) -> Result<Self, ViewerError> {
        let anywhere = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let listener = listen(settings.address.unwrap_or(anywhere), "--http")?;
        let served = files.iter().map(|path| Served {
            path: path.clone(),
            made: OnceLock::new(),
        });
        let all: All = Arc::new(served.collect());
        let routes = Router::new()
            .route("/session.json", get(move |all| session_json(all, against)))
            .route("/recordings/{number}/file.mcap", get(file))
            .route("/recordings/{number}/tools.json", get(tools))
            .route("/recordings/{number}/inside.json", get(inside))
            .route("/recordings/{number}/scene", get(scene))
            .route("/healthz", get(|| async { "ok\n" }))
            .with_state(all)
            .merge(files::files());
        let hosts = Hosts {
            names: settings.hosts.clone().into(),
            ..Hosts::default()
        };
        let mut server = Server::start(listener, routes, hosts)
            .map_err(|error| ViewerError::System(error.to_string()))?;
        server.open();
        Ok(Self { server })
    }

    /// Where the page is.
    pub fn url(&self) -> String {
        self.server.url()
    }
}

async fn session_json(State(all): State<All>, against: bool) -> Response {
    let recordings = all.iter().enumerate().map(|(k, served)| ListedRecording {
        name: printable(
            &served
                .path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy(),
        )
        .into_owned(),
        url: format!("/recordings/{k}/file.mcap"),
        bytes: std::fs::metadata(&served.path).map_or(0, |file| file.len()),
        tools_url: format!("/recordings/{k}/tools.json"),
        inside_url: format!("/recordings/{k}/inside.json"),
        scene_url: format!("/recordings/{k}/scene"),
        against: against && k == 1,
    });
    json(&SessionInfo {
        open: Vec::new(),
        mode: "view",
        instance: String::new(),
        version: env!("CARGO_PKG_VERSION"),
        token: None,
        recordings: recordings.collect(),
        instances: Vec::new(),
        pages: Default::default(),
        played: false,
        lockstep: false,
    })
}

fn not_found() -> Response {
    (StatusCode::NOT_FOUND, "there is no such recording\n").into_response()
}

/// A file, or a range of it.
async fn file(
    State(all): State<All>,
    UrlPath(number): UrlPath<usize>,
    headers: HeaderMap,
) -> Response {
    let Some(served) = all.get(number) else {
        return not_found();
    };
    let opened = File::open(&served.path).and_then(|file| Ok((file.metadata()?.len(), file)));
    let (length, file) = match opened {
        Ok(opened) => opened,
        Err(error) => {
            let words = format!("{}: {error}\n", served.path.display());
            return (StatusCode::NOT_FOUND, words).into_response();
        }
    };
    let range = headers
        .get(header::RANGE)
        .and_then(|range| range.to_str().ok())
        .map_or(Wanted::All, |range| Wanted::of(range, length));
    let (status, first, end) = match range {
        Wanted::All => (StatusCode::OK, 0, length),
        Wanted::Part(first, end) => (StatusCode::PARTIAL_CONTENT, first, end),
        Wanted::Nothing => {
            let range = [(header::CONTENT_RANGE, format!("bytes */{length}"))];
            return (StatusCode::RANGE_NOT_SATISFIABLE, range).into_response();
        }
    };
    let mut response = (status, body(file, first, end)).into_response();
    let mut set = |name, value: String| {
        if let Ok(value) = value.parse() {
            response.headers_mut().insert(name, value);
        }
    };
    set(header::CONTENT_TYPE, "application/octet-stream".into());
    set(header::ACCEPT_RANGES, "bytes".into());
    set(header::CONTENT_LENGTH, (end - first).to_string());
    if status == StatusCode::PARTIAL_CONTENT {
        let last = end - 1;
        set(
            header::CONTENT_RANGE,
            format!("bytes {first}-{last}/{length}"),
        );
    }
    response
}

/// What a request wants of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    All,
    /// From, and before.
    Part(u64, u64),
    /// Nothing that is there.
    Nothing,
}

impl Wanted {
    /// `bytes=a-b`, `bytes=a-`, `bytes=-last`. Others, and lists of ranges, may be answered with all.
    fn of(range: &str, length: u64) -> Self {
        let Some((from, to)) = range
            .strip_prefix("bytes=")
            .and_then(|range| range.split_once('-'))
        else {
            return Self::All;
        };
        let (first, end) = match (from.parse::<u64>(), to.parse::<u64>()) {
            (Ok(first), Ok(last)) if first <= last => (first, last.saturating_add(1).min(length)),
            (Ok(first), Err(_)) if to.is_empty() => (first, length),
            (Err(_), Ok(count)) if from.is_empty() => (length.saturating_sub(count), length),
            _ => return Self::All,
        };
        if first < end {
            Self::Part(first, end)
        } else {
            Self::Nothing
        }
    }
}

/// Bytes of a file, block by block, as they are taken.
fn body(file: File, first: u64, end: u64) -> Body {
    let blocks = futures_util::stream::unfold((Some(file), first), move |(file, at)| async move {
        // After an error there is no file any more.
        let mut file = file.filter(|_| at < end)?;
        let read = tokio::task::spawn_blocking(move || {
            let mut block = vec![0; BLOCK.min(end - at) as usize];
            file.seek(SeekFrom::Start(at))?;
            file.read_exact(&mut block)?;
            Ok::<_, std::io::Error>((block, file))
        });
        match read.await {
            Ok(Ok((block, file))) => {
                let next = at + block.len() as u64;
                Some((Ok(Bytes::from(block)), (Some(file), next)))
            }
            Ok(Err(error)) => Some((Err(error), (None, end))),
            Err(_) => None,
        }
    });
    Body::from_stream(blocks)
}

async fn tools(all: State<All>, number: UrlPath<usize>) -> Response {
    answer(all, number, "application/json", |made| made.outlines).await
}

async fn inside(all: State<All>, number: UrlPath<usize>) -> Response {
    answer(all, number, "application/json", |made| made.inside).await
}

async fn scene(all: State<All>, number: UrlPath<usize>) -> Response {
    let kind = "application/octet-stream";
    answer(all, number, kind, |made| made.snapshot).await
}

/// What is made from the scene of a recording, at the first question and aside: a scene may take
/// seconds to build.
async fn answer(
    State(all): State<All>,
    UrlPath(number): UrlPath<usize>,
    kind: &'static str,
    part: impl FnOnce(Made) -> Bytes,
) -> Response {
    let made = tokio::task::spawn_blocking(move || {
        let served = all.get(number)?;
        Some(served.made.get_or_init(|| made_of(served)).clone())
    });
    match made.await {
        Ok(Some(Ok(made))) => ([(header::CONTENT_TYPE, kind)], part(made)).into_response(),
        Ok(Some(Err(reason))) => {
            (StatusCode::UNPROCESSABLE_ENTITY, format!("{reason}\n")).into_response()
        }
        Ok(None) | Err(_) => not_found(),
    }
}

fn made_of(served: &Served) -> Result<Made, String> {
    let session = Session::open(&served.path).map_err(|e| e.to_string())?;
    let scene = recorded_scene(&session).map_err(|e| e.to_string())?;
    let hash = sha2::Sha256::digest(session.header.scene_text.as_bytes()).into();
    Ok(Made {
        snapshot: encode(&first_snapshot(&scene, hash)).into(),
        outlines: tool_outlines(&scene).into(),
        inside: bodies_inside(&scene).into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_those_of_rfc_9110() {
        let of = |range| Wanted::of(range, 100);
        assert_eq!(of("bytes=0-0"), Wanted::Part(0, 1));
        assert_eq!(of("bytes=10-19"), Wanted::Part(10, 20));
        assert_eq!(of("bytes=90-"), Wanted::Part(90, 100));
        assert_eq!(of("bytes=90-400"), Wanted::Part(90, 100));
        assert_eq!(of("bytes=-7"), Wanted::Part(93, 100));
        assert_eq!(of("bytes=-700"), Wanted::Part(0, 100));
        for nothing in ["bytes=100-", "bytes=100-200", "bytes=-0"] {
            assert_eq!(of(nothing), Wanted::Nothing, "{nothing}");
        }
        for odd in [
            "bytes=5-2",
            "bytes=-",
            "bytes=a-b",
            "lines=1-2",
            "bytes=0-1,5-6",
            "bytes=18446744073709551616-",
        ] {
            assert_eq!(of(odd), Wanted::All, "{odd}");
        }
        assert_eq!(Wanted::of("bytes=0-", 0), Wanted::Nothing);
    }
}
