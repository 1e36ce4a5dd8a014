//! Who may ask: the `Host` and `Origin` of every request, and the headers of every answer.
//!
//! A page of another site can send requests to loopback. It cannot set `Origin`, so that gives it
//! away; by DNS rebinding it can be of "the same origin", but then `Host` is its name and not ours.

use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::IpAddr;
use std::sync::Arc;

/// The page loads its own files only, connects to its own server only, and is in no frame.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const HEADERS: [(HeaderName, &str); 5] = [
    (header::CONTENT_SECURITY_POLICY, POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        "same-origin",
    ),
    (
        HeaderName::from_static("cross-origin-opener-policy"),
        "same-origin",
    ),
];

/// Paths that pages of named other sites may ask for: they are for programs of others.
const FOR_OTHERS: [&str; 2] = ["/foxglove", "/rosbridge"];

/// Who may ask.
#[derive(Clone, Debug, Default)]
pub struct Hosts {
    /// Names other than numbers and `localhost` under which the page may be opened.
    pub names: Arc<[String]>,
    /// Sites that may connect to what is for others.
    pub origins: Arc<[String]>,
    /// All paths are for others.
    pub for_others: bool,
}

/// Refuses requests that another site may have made; adds the headers to all others.
pub(crate) async fn check(State(hosts): State<Hosts>, request: Request, next: Next) -> Response {
    if let Err(reason) = hosts.check(request.headers(), request.uri().path()) {
        return (StatusCode::FORBIDDEN, format!("{reason}\n")).into_response();
    }
    let mut response = next.run(request).await;
    for (name, value) in HEADERS {
        (response.headers_mut()).insert(name, HeaderValue::from_static(value));
    }
    (response.headers_mut())
        .entry(header::CACHE_CONTROL)
        .or_insert(HeaderValue::from_static("no-cache"));
    response
}

impl Hosts {
    fn check(&self, headers: &HeaderMap, path: &str) -> Result<(), String> {
        let text = |name| match headers.get(name).map(HeaderValue::to_str) {
            None => Ok(None),
            Some(Ok(text)) => Ok(Some(text)),
            Some(Err(_)) => Err(String::from("a header is not text")),
        };
        let host = text(header::HOST)?.ok_or("the request has no Host")?;
        let name = name_of(host);
        let known = is_number_or_local(name)
            || self
                .names
                .iter()
                .any(|known| known.eq_ignore_ascii_case(name));
        if !known {
            return Err(format!(
                "this page is not served as {name:?}: open it by number, like http://127.0.0.1:PORT/, or start \
                 the daemon with --http-host {name}"
            ));
        }
        match text(header::ORIGIN)? {
            None => Ok(()),
            Some(origin) if origin_host(origin) == Some(host) => Ok(()),
            Some(origin) if !self.for_others && !FOR_OTHERS.contains(&path) => {
                Err(format!("a page of {origin} may not ask here"))
            }
            Some(origin) if self.origins.iter().any(|known| known == origin) => Ok(()),
            Some(origin) => Err(format!(
                "a page of {origin} may not ask here, unless the daemon is started with --http-origin {origin}"
            )),
        }
    }
}

/// A host without its port.
fn name_of(host: &str) -> &str {
    match host.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
        Some((name, _)) => name,
        None => host.split_once(':').map_or(host, |(name, _)| name),
    }
}

/// A name that no DNS server answers for.
fn is_number_or_local(name: &str) -> bool {
    name.parse::<IpAddr>().is_ok() || name.eq_ignore_ascii_case("localhost")
}

fn origin_host(origin: &str) -> Option<&str> {
    origin
        .strip_prefix("http://")
        .or_else(|| origin.strip_prefix("https://"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(host: Option<&str>, origin: Option<&str>) -> bool {
        let mut headers = HeaderMap::new();
        let mut add = |name, value: Option<&str>| {
            if let Some(value) = value {
                headers.insert(name, HeaderValue::from_bytes(value.as_bytes()).unwrap());
            }
        };
        add(header::HOST, host);
        add(header::ORIGIN, origin);
        let hosts = Hosts {
            names: Arc::new(["lab-pc".to_owned()]),
            origins: Arc::new(["https://viewer.example".to_owned()]),
            for_others: false,
        };
        let at = |path| hosts.check(&headers, path).is_ok();
        assert!(at("/foxglove") || !at("/live"), "{headers:?}");
        at("/live")
    }

    #[test]
    fn a_named_site_reaches_what_is_for_others_and_nothing_else() {
        let mut headers = HeaderMap::new();
        headers.insert(header::HOST, HeaderValue::from_static("127.0.0.1:1"));
        headers.insert(
            header::ORIGIN,
            HeaderValue::from_static("https://viewer.example"),
        );
        let mut hosts = Hosts {
            origins: Arc::new(["https://viewer.example".to_owned()]),
            ..Hosts::default()
        };
        let at = |hosts: &Hosts, path| hosts.check(&headers, path).is_ok();
        assert!(at(&hosts, "/foxglove") && at(&hosts, "/rosbridge"));
        for path in ["/live", "/", "/session.json", "/foxglove/..", "//foxglove"] {
            assert!(!at(&hosts, path), "{path}");
        }
        hosts.for_others = true;
        assert!(at(&hosts, "/"));
        hosts.origins = Arc::default();
        assert!(!at(&hosts, "/foxglove"));
    }

    #[test]
    fn numbers_localhost_and_named_hosts_are_served() {
        for host in [
            "127.0.0.1:8080",
            "127.0.0.1",
            "[::1]:8080",
            "localhost:9",
            "LOCALHOST",
            "192.168.1.7:80",
            "lab-pc:8080",
        ] {
            assert!(check(Some(host), None), "{host}");
            let origin = format!("http://{host}");
            assert!(check(Some(host), Some(&origin)), "{origin}");
        }
    }

    #[test]
    fn rebound_names_and_other_origins_are_not() {
        for host in [
            None,
            Some("evil.example"),
            Some("127.0.0.1.evil.example:8080"),
            Some("localhost.evil.example"),
            Some(""),
            Some("\u{e9}"),
        ] {
            assert!(!check(host, None), "{host:?}");
        }
        for origin in [
            "http://evil.example",
            "null",
            "http://127.0.0.1:8081",
            "file://",
        ] {
            assert!(!check(Some("127.0.0.1:8080"), Some(origin)), "{origin}");
        }
    }
}
