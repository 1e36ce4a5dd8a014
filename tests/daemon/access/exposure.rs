//! A daemon does not listen to the network by accident.

use super::SCENE;
use crate::daemon::{Daemon, PROGRAM, free_port};
use palpate::auth::{Authority, Role};
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn serve(directory: &Path, arguments: &[&str]) -> Output {
    let scene = directory.join("scene.toml");
    std::fs::write(&scene, SCENE).unwrap();
    Command::new(PROGRAM)
        .arg("serve")
        .arg(&scene)
        .args(["--no-rt", "--for", "300ms"])
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn what_the_network_reaches_is_refused_without_tls_and_rules() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    let wide = format!("tcp/0.0.0.0:{}", free_port());
    let local = format!("tcp/127.0.0.1:{}", free_port());
    std::fs::write(
        at("wide.json5"),
        format!("{{ listen: {{ endpoints: [{wide:?}] }} }}"),
    )
    .unwrap();
    let page = format!("0.0.0.0:{}", free_port());
    let authority = Authority::create(&directory.path().join("ca")).unwrap();
    let daemon = authority
        .issue(&super::request(Role::Daemon), None)
        .unwrap();
    let daemon = daemon.display().to_string();
    let config = at("wide.json5");
    // TLS alone does not say who may come.
    let lone_tls = format!("tls/0.0.0.0:{}", free_port());
    std::fs::write(
        at("tls.json5"),
        std::fs::read_to_string(&daemon)
            .unwrap()
            .replace("\"enable_mtls\": true", "\"enable_mtls\": false"),
    )
    .unwrap();
    let no_client_certificates = at("tls.json5");
    for arguments in [
        &["--listen", &wide][..],
        &["--listen", &local, "--listen", &wide],
        &["--zenoh-config", &config],
        // An identity does not guard what has no TLS.
        &["--listen", &wide, "--identity", &daemon],
        &["--listen", &lone_tls, "--zenoh-config", &daemon],
        &["--listen", &lone_tls, "--identity", &no_client_certificates],
        &["--listen", &local, "--http", &page],
    ] {
        let output = serve(directory.path(), arguments);
        let text = words(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(
            text.contains("--insecure") && text.contains("from other machines"),
            "{arguments:?}: {text}"
        );
    }
    for arguments in [
        &["--listen", &wide, "--insecure"][..],
        &["--listen", &lone_tls, "--identity", &daemon],
        &["--listen", &local, "--http", &page, "--http-view-only"],
    ] {
        let output = serve(directory.path(), arguments);
        let text = words(&output);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {text}");
        assert_eq!(
            text.contains("everybody on the network"),
            arguments.contains(&"--insecure"),
            "{text}"
        );
    }
}

#[test]
fn what_is_open_is_said_by_ls_the_page_and_the_metrics() {
    let directory = tempfile::tempdir().unwrap();
    let wide = format!("tcp/0.0.0.0:{}", free_port());
    let page = free_port();
    let http = format!("127.0.0.1:{page}");
    let arguments = ["--insecure", "--listen", &wide, "--http", &http];
    let daemon = Daemon::start(directory.path(), SCENE, &arguments);
    let output = Command::new(PROGRAM)
        .args(["ls", "--connect", &daemon.endpoint])
        .output()
        .unwrap();
    let listed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        listed.contains(&format!("OPEN to everybody on the network: {wide}")),
        "{listed}"
    );
    let metrics = daemon.connect().metrics().unwrap();
    assert!(metrics.contains("palpate_open_endpoints 1"), "{metrics}");
    let answer = crate::page::get(page, "/session.json");
    let session = answer.text();
    let session: serde_json::Value = serde_json::from_str(session).unwrap();
    assert_eq!(session["open"], serde_json::json!([wide]));
}

// Seen: Zenoh's own words for protocols that are not there.
#[test]
fn protocols_that_are_not_built_in_are_refused_by_name() {
    let directory = tempfile::tempdir().unwrap();
    for protocol in ["ws", "udp", "serial", "vsock"] {
        let endpoint = format!("{protocol}/127.0.0.1:7447");
        let output = serve(directory.path(), &["--listen", &endpoint]);
        let text = words(&output);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(
            text.contains(&format!(
                "protocol {protocol} is not built in; there are tcp, tls"
            )),
            "{text}"
        );
        let output = Command::new(PROGRAM)
            .args(["ls", "--connect", &endpoint])
            .output()
            .unwrap();
        assert_ne!(output.status.code(), Some(0));
        assert!(
            words(&output).contains("is not built in"),
            "{}",
            words(&output)
        );
    }
}
