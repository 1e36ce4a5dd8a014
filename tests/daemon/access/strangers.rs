//! Those without a certificate, with one that is over, of another authority, of another name.

use super::exposure::private;
use super::{Secured, request};
use palpate::auth::{Authority, Role};
use palpate_client::{ClientError, Connect, Palpate};
use std::path::{Path, PathBuf};
use std::time::Duration;
use time::OffsetDateTime;

fn connect(endpoint: &str, identity: Option<&Path>) -> Result<String, ClientError> {
    let palpate = Palpate::connect(&Connect {
        identity: identity.map(Path::to_owned),
        timeout: Duration::from_secs(5),
        ..Connect::to(endpoint)
    })?;
    palpate
        .status()
        .map(|status| format!("tick {}", status.tick))
}

/// The words with which somebody is refused; he must be.
fn refused(endpoint: &str, identity: Option<&Path>) -> String {
    match connect(endpoint, identity) {
        Err(error @ ClientError::Certificate { .. }) => error.to_string(),
        other => panic!("{other:?}"),
    }
}

fn issued(authority: &Authority, role: Role, from: OffsetDateTime, path: PathBuf) -> PathBuf {
    let short = palpate::auth::Request {
        valid: Duration::from_secs(86_400),
        ..request(role)
    };
    write(&path, &authority.identity(&short, from).unwrap());
    path
}

/// Writes an identity.
fn write(path: &Path, text: &str) {
    std::fs::write(path, text).unwrap();
    private(path);
}

pub(super) fn strangers_are_refused_and_told_why() {
    strangers("tls");
}

pub(super) fn strangers_are_refused_over_quic_too() {
    strangers("quic");
}

fn strangers(protocol: &str) {
    let secured = Secured::start_as(&request(Role::Daemon), protocol);
    let (now, at) = (OffsetDateTime::now_utc(), &secured.endpoint);
    let file = |name: &str| secured.path().join(name);
    let viewer = secured.identity(Role::Viewer);
    assert!(connect(at, Some(&viewer)).is_ok(), "a viewer");

    let none = refused(at, None);
    assert!(none.contains("--identity"), "{none}");
    let days = |n: u64| Duration::from_secs(n * 86_400);
    let over = issued(
        &secured.authority,
        Role::Operator,
        now - days(30),
        file("over.json5"),
    );
    // Over QUIC Zenoh says why in its log only.
    let says_why = protocol == "tls";
    let words = refused(at, Some(&over));
    assert!(!says_why || words.contains("not valid now"), "{words}");
    // The program says it before it connects.
    let (code, words) = secured.palpate(&["ls"], &over);
    assert!(code == 2 && words.contains("it has expired on"), "{words}");
    let early = issued(
        &secured.authority,
        Role::Operator,
        now + days(30),
        file("early.json5"),
    );
    println!("not yet valid: {}", refused(at, Some(&early)));

    // An authority of the same name: another key.
    let others = Authority::create(&file("others")).unwrap();
    let foreign = issued(&others, Role::Operator, now, file("foreign.json5"));
    let words = refused(at, Some(&foreign));
    assert!(words.contains("another authority"), "{words}");
    // He may trust our daemon, and is not trusted by it.
    let read = |path: &Path| -> serde_json::Value {
        let text = std::fs::read_to_string(path).unwrap();
        serde_json::from_str(text.split_once('\n').unwrap().1).unwrap()
    };
    let mut mixed = read(&foreign);
    let ca = "root_ca_certificate_base64";
    mixed["transport"]["link"]["tls"][ca] = read(&viewer)["transport"]["link"]["tls"][ca].clone();
    write(&file("mixed.json5"), &mixed.to_string());
    println!(
        "of another authority: {}",
        refused(at, Some(&file("mixed.json5")))
    );
    // Somebody else's certificate with one's own key.
    let mut stolen = read(&secured.identity(Role::Operator));
    let key = "connect_private_key_base64";
    stolen["transport"]["link"]["tls"][key] =
        read(&foreign)["transport"]["link"]["tls"][key].clone();
    write(&file("stolen.json5"), &stolen.to_string());
    println!(
        "a certificate without its key: {}",
        refused(at, Some(&file("stolen.json5")))
    );
    // TLS without a certificate of the client's.
    let mut bare = read(&viewer);
    bare["transport"]["link"]["tls"]["enable_mtls"] = false.into();
    write(&file("bare.json5"), &bare.to_string());
    println!("no certificate: {}", refused(at, Some(&file("bare.json5"))));
    // No TLS at all: the port does not speak.
    let plain = at.replace(protocol, "tcp");
    let plain = Palpate::connect(&Connect {
        timeout: Duration::from_secs(2),
        ..Connect::to(&plain)
    });
    assert!(plain.is_err() || plain.unwrap().status().is_err());
    assert!(
        connect(at, Some(&viewer)).is_ok(),
        "and the daemon is as well as before"
    );
}

#[test]
fn a_daemon_under_another_name_or_with_a_clients_certificate_is_refused() {
    for protocol in ["tls", "quic"] {
        false_daemons(protocol);
    }
}

fn false_daemons(protocol: &str) {
    let named = palpate::auth::Request {
        hosts: vec!["elsewhere.example".to_owned()],
        ..request(Role::Daemon)
    };
    let elsewhere = Secured::start_as(&named, protocol);
    let viewer = elsewhere.identity(Role::Viewer);
    let words = refused(&elsewhere.endpoint, Some(&viewer));
    assert!(words.contains("for other names"), "{words}");

    // A tool's key and certificate behind a listening port: it may not pass for the daemon.
    let directory = tempfile::tempdir().unwrap();
    let authority = Authority::create(directory.path()).unwrap();
    let named = palpate::auth::Request {
        hosts: vec!["127.0.0.1".to_owned()],
        ..request(Role::tool("ball").unwrap())
    };
    let text = authority
        .identity(&named, OffsetDateTime::now_utc())
        .unwrap();
    let mut own: serde_json::Value =
        serde_json::from_str(text.split_once('\n').unwrap().1).unwrap();
    let tls = &mut own["transport"]["link"]["tls"];
    for what in ["private_key", "certificate"] {
        tls[format!("listen_{what}_base64")] = tls[format!("connect_{what}_base64")].clone();
    }
    own["mode"] = "peer".into();
    let endpoint = format!("{protocol}/127.0.0.1:{}", crate::daemon::free_port());
    own["listen"] = serde_json::json!({ "endpoints": [endpoint] });
    let config = directory.path().join("impostor.json5");
    std::fs::write(&config, own.to_string()).unwrap();
    let impostor = zenoh::Config::from_file(&config).unwrap();
    let _impostor = zenoh::Wait::wait(zenoh::open(impostor)).unwrap();
    let viewer = authority.issue(&request(Role::Viewer), None).unwrap();
    println!("an impostor: {}", refused(&endpoint, Some(&viewer)));
}

// Short-lived certificates are the only way to take rights back: links must not outlive them.
pub(super) fn a_link_ends_when_its_certificate_does() {
    std::thread::scope(|scope| {
        for protocol in ["tls", "quic"] {
            scope.spawn(move || ended_link(protocol));
        }
    });
}

fn ended_link(protocol: &str) {
    let secured = Secured::start_as(&request(Role::Daemon), protocol);
    let short = palpate::auth::Request {
        valid: Duration::from_secs(6),
        ..request(Role::Viewer)
    };
    let path = secured.path().join("short.json5");
    secured.authority.issue(&short, Some(&path)).unwrap();
    let palpate = Palpate::connect(&Connect {
        identity: Some(path),
        timeout: Duration::from_millis(300),
        ..Connect::to(&secured.endpoint)
    })
    .unwrap();
    let begun = std::time::Instant::now();
    let mut answered = 0;
    while palpate.status().is_ok() {
        answered += 1;
        assert!(begun.elapsed() < Duration::from_secs(60), "it goes on");
        std::thread::sleep(Duration::from_millis(50));
    }
    println!("{answered} answers, none after {:?}", begun.elapsed());
    assert!(answered > 0);
    let again = connect(&secured.endpoint, Some(&secured.path().join("short.json5")));
    assert!(again.is_err(), "{again:?}");
}
