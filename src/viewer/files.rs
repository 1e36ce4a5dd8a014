//! The page's files.

use axum::Router;
use axum::http::header;
use axum::response::IntoResponse;
use axum::routing::get;
use std::borrow::Cow;

/// The bundle that `clients/web` makes.
const PAGE: &str = include_str!("page/index.html");
const SCRIPT: &str = include_str!("page/app.js");
const STYLE: &str = include_str!("page/app.css");

/// Page, style and script, in this order.
pub(super) fn bundle() -> [&'static str; 3] {
    [PAGE, STYLE, SCRIPT]
}

/// The page's files.
pub(super) fn files() -> Router {
    let file = |kind: &'static str, name: &'static str, built_in: &'static str| {
        get(move || {
            let text = from_disk(name).map_or(Cow::Borrowed(built_in), Cow::Owned);
            std::future::ready(([(header::CONTENT_TYPE, kind)], text).into_response())
        })
    };
    Router::new()
        .route("/", file("text/html; charset=utf-8", "index.html", PAGE))
        .route(
            "/app.js",
            file("text/javascript; charset=utf-8", "app.js", SCRIPT),
        )
        .route(
            "/app.css",
            file("text/css; charset=utf-8", "app.css", STYLE),
        )
}

/// For those who work on the page: a bundle that is newer than this program.
fn from_disk(name: &str) -> Option<String> {
    let directory = cfg!(debug_assertions).then(|| std::env::var_os("PALPATE_PAGE_DIR"))??;
    std::fs::read_to_string(std::path::Path::new(&directory).join(name)).ok()
}
