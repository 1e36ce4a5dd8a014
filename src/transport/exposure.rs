//! What a session listens on that everybody can reach.

use palpate_client::is_secured;
use serde_json::Value;
use std::net::{IpAddr, ToSocketAddrs};

/// Endpoints on which a session with this configuration would let in who comes over a network:
/// neither loopback nor a Unix socket, and without TLS or QUIC, certificates of clients and access rules.
pub(super) fn open_endpoints(config: &zenoh::Config) -> Vec<String> {
    let value = |key: &str| -> Value {
        let text = config.get_json(key).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    };
    let says = |key: &str| value(key) == Value::Bool(true);
    let guarded = says("transport/link/tls/enable_mtls") && says("access_control/enabled");
    let mut endpoints = Vec::new();
    texts(&value("listen/endpoints"), &mut endpoints);
    endpoints.retain(|endpoint| match endpoint.split_once('/') {
        Some(("unixsock-stream", _)) => false,
        Some((_, address)) => !(is_local(address) || (is_secured(endpoint) && guarded)),
        None => false,
    });
    endpoints
}

fn texts(value: &Value, into: &mut Vec<String>) {
    match value {
        Value::String(text) => into.push(text.clone()),
        Value::Array(values) => values.iter().for_each(|value| texts(value, into)),
        Value::Object(fields) => fields.values().for_each(|value| texts(value, into)),
        _ => {}
    }
}

/// Only this machine reaches the address. A name that nobody knows is not believed to be local.
fn is_local(address: &str) -> bool {
    let address = address.split(['#', '?']).next().unwrap_or_default();
    let Ok(addresses) = address.to_socket_addrs() else {
        return false;
    };
    let mut addresses = addresses.map(|address| address.ip()).peekable();
    addresses.peek().is_some() && addresses.all(is_loopback)
}

/// Loopback, also when it is written as IPv6.
pub fn is_loopback(address: IpAddr) -> bool {
    address.to_canonical().is_loopback()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn open(listen: &str, more: &[(&str, &str)]) -> Vec<String> {
        let mut config = zenoh::Config::default();
        config.insert_json5("listen/endpoints", listen).unwrap();
        for (key, value) in more {
            config.insert_json5(key, value).unwrap();
        }
        open_endpoints(&config)
    }

    #[test]
    fn loopback_unix_sockets_and_guarded_tls_are_not_open() {
        let mtls = ("transport/link/tls/enable_mtls", "true");
        let rules = ("access_control/enabled", "true");
        for local in [
            "tcp/127.0.0.1:7447",
            "tcp/localhost:7447",
            "tcp/[::1]:7447",
            "tcp/127.3.2.1:7447",
            "tcp/[::ffff:127.0.0.1]:7447",
            "tls/127.0.0.1:7447",
            "quic/127.0.0.1:7447",
            "unixsock-stream//tmp/palpate",
        ] {
            assert!(open(&format!("[{local:?}]"), &[]).is_empty(), "{local}");
        }
        for wide in [
            "tcp/0.0.0.0:7447",
            "tcp/[::]:7447",
            "tls/0.0.0.0:7447",
            "quic/0.0.0.0:7447",
        ] {
            let listen = format!("[{wide:?}]");
            for more in [&[][..], &[mtls], &[rules]] {
                assert_eq!(open(&listen, more), [wide], "{more:?}");
            }
            assert_eq!(
                open(&listen, &[mtls, rules]).is_empty(),
                !wide.starts_with("tcp")
            );
        }
        // Zenoh's way to say it by mode.
        let by_mode = r#"{ peer: ["tcp/0.0.0.0:0"], router: [] }"#;
        assert_eq!(open(by_mode, &[]), ["tcp/0.0.0.0:0"]);
    }
}
