//! Texts are sent compressed to who takes that: the page's script is a third of its size over a network.

use axum::body::{Bytes, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write as _;
use std::sync::{Arc, OnceLock};

/// Shorter texts fit a packet or two as they are.
const LEAST_BYTES: usize = 1_400;
/// Longer than any text that is served.
const MOST_BYTES: usize = 256 << 20;

/// What does not change while the program runs, compressed once.
#[derive(Clone, Default)]
pub(crate) struct Kept(Arc<[OnceLock<Bytes>; 3]>);

impl Kept {
    fn of(&self, path: &str) -> Option<&OnceLock<Bytes>> {
        // A page from disk changes.
        if cfg!(debug_assertions) && std::env::var_os("PALPATE_PAGE_DIR").is_some() {
            return None;
        }
        let place = ["/", "/app.js", "/app.css"]
            .iter()
            .position(|known| *known == path)?;
        self.0.get(place)
    }
}

/// Compresses texts of answers that are whole.
pub(crate) async fn texts(State(kept): State<Kept>, request: Request, next: Next) -> Response {
    let taken = takes_gzip(request.headers());
    let path = request.uri().path().to_owned();
    let mut response = next.run(request).await;
    let text = (response.headers().get(header::CONTENT_TYPE))
        .and_then(|kind| kind.to_str().ok())
        .is_some_and(is_text);
    if response.status() != StatusCode::OK || !text {
        return response;
    }
    // Whoever keeps answers must not give a compressed one to who cannot read it.
    response
        .headers_mut()
        .insert(header::VARY, HeaderValue::from_static("accept-encoding"));
    if !taken || response.headers().contains_key(header::CONTENT_ENCODING) {
        return response;
    }
    let (mut head, body) = response.into_parts();
    let Ok(plain) = to_bytes(body, MOST_BYTES).await else {
        return failed();
    };
    if plain.len() < LEAST_BYTES {
        return Response::from_parts(head, plain.into());
    }
    // Aside: others are served meanwhile.
    let packed = tokio::task::spawn_blocking(move || match kept.of(&path) {
        Some(once) => once
            .get_or_init(|| gzip(&plain, Compression::best()))
            .clone(),
        None => gzip(&plain, Compression::fast()),
    });
    let Ok(packed) = packed.await else {
        return failed();
    };
    head.headers.remove(header::CONTENT_LENGTH);
    head.headers
        .insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
    Response::from_parts(head, packed.into())
}

fn failed() -> Response {
    StatusCode::INTERNAL_SERVER_ERROR.into_response()
}

fn gzip(plain: &[u8], level: Compression) -> Bytes {
    let mut encoder = GzEncoder::new(Vec::with_capacity(plain.len() / 3), level);
    // A vector takes everything.
    let _ = encoder.write_all(plain);
    encoder.finish().unwrap_or_default().into()
}

fn is_text(kind: &str) -> bool {
    kind.starts_with("text/") || kind.starts_with("application/json")
}

/// RFC 9110, 12.5.3: named, or any, and not with a weight of zero.
fn takes_gzip(headers: &HeaderMap) -> bool {
    let values = headers.get_all(header::ACCEPT_ENCODING).iter();
    let codings = values
        .filter_map(|value| value.to_str().ok())
        .flat_map(|value| value.split(','));
    let mut any = None;
    for coding in codings {
        let (name, weight) = coding.split_once(';').unwrap_or((coding, ""));
        let weight = weight
            .trim()
            .strip_prefix("q=")
            .and_then(|q| q.trim().parse().ok());
        let wanted = weight.is_none_or(|q: f64| q > 0.0);
        match name.trim().to_ascii_lowercase().as_str() {
            "gzip" | "x-gzip" => return wanted,
            "*" => any = Some(wanted),
            _ => {}
        }
    }
    any.unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read as _;

    #[test]
    fn who_takes_gzip_is_read_as_rfc_9110_says() {
        let takes = |text: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::ACCEPT_ENCODING, text.parse().unwrap());
            takes_gzip(&headers)
        };
        for yes in [
            "gzip",
            "gzip, deflate, br",
            "br;q=1.0, gzip;q=0.1",
            "*",
            "GZIP",
            "x-gzip",
        ] {
            assert!(takes(yes), "{yes}");
        }
        for no in [
            "",
            "identity",
            "br",
            "gzip;q=0",
            "*;q=0",
            "gzip;q=0, *",
            "gzippy",
        ] {
            assert!(!takes(no), "{no}");
        }
        assert!(!takes_gzip(&HeaderMap::new()));
    }

    #[test]
    fn what_is_compressed_comes_back() {
        let plain: Vec<u8> = (0..100_000_u32)
            .map(|k| (k.wrapping_mul(k) / 7) as u8)
            .collect();
        let mut back = Vec::new();
        flate2::read::GzDecoder::new(&gzip(&plain, Compression::fast())[..])
            .read_to_end(&mut back)
            .unwrap();
        assert_eq!(back, plain);
    }
}
