//! Connecting with TLS: a refusal is an error at once, instead of silent retries.

use crate::{ClientError, Connect};
use std::net::{Ipv4Addr, Ipv6Addr, SocketAddr, TcpStream, ToSocketAddrs, UdpSocket};
use std::time::Duration;

/// Makes Zenoh try once and give up: it would go on trying without a word.
///
/// # Errors
/// No identity was given, so there is no authority to check the daemon's certificate against.
pub(crate) fn demand(
    config: &mut zenoh::Config,
    endpoint: &str,
    settings: &Connect,
) -> Result<(), ClientError> {
    let has = |key: &str| config.get_json(key).is_ok_and(|value| value != "null");
    let known = has("transport/link/tls/root_ca_certificate")
        || has("transport/link/tls/root_ca_certificate_base64");
    if settings.identity.is_none() && !known {
        return Err(ClientError::Certificate {
            endpoint: endpoint.to_owned(),
            reason:
                "it wants a certificate: give --identity FILE, which `palpate auth issue` makes"
                    .into(),
        });
    }
    for (key, value) in [
        ("connect/timeout_ms", "0"),
        ("connect/exit_on_failure", "true"),
    ] {
        config
            .insert_json5(key, value)
            .map_err(ClientError::zenoh)?;
    }
    Ok(())
}

/// What TLS's words mean. Those of alerts are the daemon's, the others ours about its certificate.
const MEANINGS: [(&[&str], &str); 6] = [
    (
        &["alert: certificateexpired"],
        "the daemon refused our certificate: it is not valid now; `palpate auth issue` makes a new one",
    ),
    (
        &["alert: unknownca", "alert: decrypterror"],
        "the daemon refused our certificate: it is of another authority than the daemon's",
    ),
    (
        &["alert: certificaterequired", "alert: badcertificate"],
        "the daemon refused us: it wants a certificate of its clients",
    ),
    (
        &["not valid for name", "notvalidforname"],
        "the daemon's certificate is for other names: connect by one of them, or issue it for this one with --host",
    ),
    (
        &["certificate expired", "certificate: expired"],
        "the daemon's certificate has expired",
    ),
    (
        &["unknownissuer", "badsignature"],
        "the daemon's certificate is of another authority than our identity",
    ),
];

/// Whether somebody listens at an endpoint. Over UDP only a machine that says that nobody does is
/// certain.
fn reach(endpoint: &str) -> std::io::Result<()> {
    let (protocol, address) = endpoint.split_once('/').unwrap_or_default();
    let address = address.split(['#', '?']).next().unwrap_or_default();
    let mut addresses = address.to_socket_addrs()?;
    let address = addresses.next().ok_or(std::io::ErrorKind::NotFound)?;
    if protocol != "quic" {
        return TcpStream::connect_timeout(&address, Duration::from_secs(3)).map(drop);
    }
    let own: SocketAddr = match address {
        SocketAddr::V4(_) => (Ipv4Addr::UNSPECIFIED, 0).into(),
        SocketAddr::V6(_) => (Ipv6Addr::UNSPECIFIED, 0).into(),
    };
    let socket = UdpSocket::bind(own)?;
    socket.connect(address)?;
    socket.set_read_timeout(Some(Duration::from_millis(300)))?;
    // No QUIC packet: whoever listens passes it over.
    socket.send(&[0])?;
    match socket.recv(&mut [0; 1]) {
        Err(error) if error.kind() == std::io::ErrorKind::ConnectionRefused => Err(error),
        _ => Ok(()),
    }
}

/// Why there is no link: nobody listens, or certificates are not accepted. To clients that look on
/// Zenoh says which only in its log.
pub(crate) fn refused(endpoint: &str, words: &str) -> ClientError {
    let words = words.to_lowercase();
    let meaning = MEANINGS
        .iter()
        .find(|(marks, _)| marks.iter().any(|mark| words.contains(mark)))
        .map(|(_, meaning)| *meaning);
    match reach(endpoint) {
        Err(error) => ClientError::Unreachable {
            endpoint: endpoint.to_owned(),
            reason: error.to_string(),
        },
        Ok(()) => ClientError::Certificate {
            endpoint: endpoint.to_owned(),
            reason: meaning.unwrap_or(
                "the daemon and this identity do not accept each other: one of them has expired or is of \
                     another authority, or the daemon's is for other names than this (the log says which; \
                     `palpate auth show` shows an identity)",
            )
            .into(),
        },
    }
}
