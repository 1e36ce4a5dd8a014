//! What a lobby answers over HTTP, as JSON.
//!
//! | request | answer |
//! |---|---|
//! | `GET /scenes` | what is offered |
//! | `POST /sessions` with `{"scene": NAME}` | 201 and the session, once clients can connect |
//! | `GET /sessions`, `GET /sessions/ID` | what runs |
//! | `DELETE /sessions/ID` | 204 once its daemon has ended |
//! | `GET /healthz` | `ok` while daemons are looked after |

use super::session::{Ask, Refusal, Session};
use super::shelf::{Offer, Shelf};
use axum::Router;
use axum::body::Body;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use serde_json::json;
use std::sync::mpsc::Sender;
use std::time::Duration;
use tokio::sync::oneshot;

/// A request names one scene.
const LONGEST_BODY: usize = 4 << 10;
/// A body that comes more slowly is not waited for.
const BODY: Duration = Duration::from_secs(10);

#[derive(Clone)]
struct Desk {
    asks: Sender<Ask>,
    shelf: Shelf,
}

/// What a session is asked for with.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Wanted {
    scene: String,
}

pub(super) fn routes(asks: Sender<Ask>, shelf: Shelf) -> Router {
    Router::new()
        .route("/scenes", get(scenes))
        .route("/sessions", get(list).post(start))
        .route("/sessions/{id}", get(one).delete(end))
        .route("/healthz", get(health))
        .with_state(Desk { asks, shelf })
}

async fn scenes(State(desk): State<Desk>) -> Response {
    let offers = tokio::task::spawn_blocking(move || desk.shelf.offers()).await;
    let offers: Vec<Offer> = offers.unwrap_or_default();
    json_answer(StatusCode::OK, &offers)
}

async fn start(State(desk): State<Desk>, request: Request) -> Response {
    let wanted = match wanted(request.into_body()).await {
        Ok(wanted) => wanted,
        Err((status, reason)) => return problem(status, &reason),
    };
    let (reply, answer) = oneshot::channel();
    let scene = wanted.scene;
    let asked = desk.asks.send(Ask::Start { scene, reply });
    let answer = match asked {
        Ok(()) => answer.await.unwrap_or(Err(Refusal::Closing)),
        Err(_) => Err(Refusal::Closing),
    };
    match answer {
        Ok(session) => {
            let place = format!("/sessions/{}", session.id);
            let answer = json_answer(StatusCode::CREATED, &session);
            ([(header::LOCATION, place)], answer).into_response()
        }
        Err(refusal) => refuse(&refusal),
    }
}

/// Reads a request's body, which must be small, quick and of the one form.
async fn wanted(body: Body) -> Result<Wanted, (StatusCode, String)> {
    let form = r#"send {"scene": "builtin:teardrop"}; GET /scenes lists the names"#;
    let bytes = tokio::time::timeout(BODY, axum::body::to_bytes(body, LONGEST_BODY)).await;
    let bytes = match bytes {
        Ok(Ok(bytes)) => bytes,
        Ok(Err(_)) => {
            let reason =
                format!("the body is longer than {LONGEST_BODY} bytes, or was cut short: {form}");
            return Err((StatusCode::PAYLOAD_TOO_LARGE, reason));
        }
        Err(_) => {
            let reason = format!("the body did not come within {} s: {form}", BODY.as_secs());
            return Err((StatusCode::REQUEST_TIMEOUT, reason));
        }
    };
    serde_json::from_slice(&bytes).map_err(|error| {
        (
            StatusCode::BAD_REQUEST,
            format!("the body: {error}; {form}"),
        )
    })
}

async fn sessions(desk: &Desk) -> Option<Vec<Session>> {
    let (reply, answer) = oneshot::channel();
    desk.asks.send(Ask::List(reply)).ok()?;
    answer.await.ok()
}

async fn list(State(desk): State<Desk>) -> Response {
    match sessions(&desk).await {
        Some(sessions) => json_answer(StatusCode::OK, &sessions),
        None => refuse(&Refusal::Closing),
    }
}

async fn one(State(desk): State<Desk>, Path(id): Path<String>) -> Response {
    let Some(sessions) = sessions(&desk).await else {
        return refuse(&Refusal::Closing);
    };
    match sessions.into_iter().find(|session| session.id == id) {
        Some(session) => json_answer(StatusCode::OK, &session),
        None => no_session(),
    }
}

async fn end(State(desk): State<Desk>, Path(id): Path<String>) -> Response {
    let (reply, answer) = oneshot::channel();
    let asked = desk.asks.send(Ask::End { id, reply });
    match asked {
        Err(_) => refuse(&Refusal::Closing),
        Ok(()) => match answer.await {
            Ok(true) => StatusCode::NO_CONTENT.into_response(),
            Ok(false) => no_session(),
            Err(_) => refuse(&Refusal::Closing),
        },
    }
}

async fn health(State(desk): State<Desk>) -> Response {
    match sessions(&desk).await {
        Some(_) => "ok\n".into_response(),
        None => refuse(&Refusal::Closing),
    }
}

fn no_session() -> Response {
    problem(
        StatusCode::NOT_FOUND,
        "there is no session of this id; GET /sessions lists them",
    )
}

fn problem(status: StatusCode, reason: &str) -> Response {
    json_answer(status, &json!({ "error": reason }))
}

fn json_answer(status: StatusCode, body: &impl serde::Serialize) -> Response {
    let kind = [(header::CONTENT_TYPE, "application/json")];
    match serde_json::to_string(body) {
        Ok(text) => (status, kind, text).into_response(),
        Err(error) => (StatusCode::INTERNAL_SERVER_ERROR, error.to_string()).into_response(),
    }
}

fn refuse(refusal: &Refusal) -> Response {
    let reason = refusal.to_string();
    match refusal {
        Refusal::Unknown { scenes, .. } => {
            let body = json!({ "error": reason, "scenes": scenes });
            json_answer(StatusCode::NOT_FOUND, &body)
        }
        Refusal::Full { max, retry_after } => {
            let body = json!({ "error": reason, "max": max });
            let mut response = json_answer(StatusCode::SERVICE_UNAVAILABLE, &body);
            let seconds = HeaderValue::from(retry_after.as_secs().max(1));
            response.headers_mut().insert(header::RETRY_AFTER, seconds);
            response
        }
        Refusal::Failed(_) => problem(StatusCode::INTERNAL_SERVER_ERROR, &reason),
        Refusal::Slow(_) => problem(StatusCode::GATEWAY_TIMEOUT, &reason),
        Refusal::Closing => problem(StatusCode::SERVICE_UNAVAILABLE, &reason),
    }
}
