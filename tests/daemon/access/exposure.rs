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
    private(&no_client_certificates);
    // Zenoh lets an endpoint say otherwise than the configuration.
    let own_way = format!("{lone_tls}#enable_mtls=false");
    for arguments in [
        &["--listen", &wide][..],
        &["--listen", &local, "--listen", &wide],
        &["--zenoh-config", &config],
        // An identity does not guard what has no TLS.
        &["--listen", &wide, "--identity", &daemon],
        &["--listen", &lone_tls, "--zenoh-config", &daemon],
        &["--listen", &lone_tls, "--identity", &no_client_certificates],
        &["--listen", &own_way, "--identity", &daemon],
        &["--listen", &local, "--http", &page],
    ] {
        let output = serve(directory.path(), arguments);
        let text = words(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(
            text.contains("--insecure") && text.contains("other machines"),
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

/// Only its owner reads a file.
pub(super) fn private(path: impl AsRef<Path>) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o600)).unwrap();
    }
}

// Nobody listens at these addresses, and none of them is asked: the refusal comes before.
#[test]
fn no_command_links_to_another_machine_without_tls_and_an_identity() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    let write = |name: &str, text: &str| {
        std::fs::write(at(name), text).unwrap();
        at(name)
    };
    let scene = write("scene.toml", SCENE);
    let authority = Authority::create(&directory.path().join("ca")).unwrap();
    let daemon = authority
        .issue(&super::request(Role::Daemon), None)
        .unwrap();
    let daemon = daemon.display().to_string();
    let local = format!("tcp/127.0.0.1:{}", free_port());
    let dials = write(
        "dials.json5",
        "{ connect: { endpoints: { peer: ['tcp/127.0.0.1:9', 'tcp/10.99.0.2:7447'] } } }",
    );
    let multicast = write(
        "multicast.json5",
        "{ scouting: { multicast: { enabled: true } } }",
    );
    let gossip = write(
        "gossip.json5",
        "{ scouting: { gossip: { autoconnect: ['peer', 'router'] } } }",
    );
    let admin = write(
        "admin.json5",
        "{ adminspace: { enabled: true, permissions: { read: true, write: true } } }",
    );
    let client = write(
        "client.json5",
        "{ mode: 'client', listen: { endpoints: ['tcp/[::]:7447'] } }",
    );
    let away = "tcp/10.99.0.2:7447";
    let switched_off = "tls/10.99.0.2:7447#enable_mtls=false";
    let serve = ["serve", &scene, "--no-rt", "--for", "300ms"];
    let recording = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/recordings/golden/teardrop-tap.mcap"
    );
    let play = ["play", recording, "--end", "3", "--listen", &local];
    let relay = ["relay", "--for", "300ms", "--listen", &local, "--from"];
    let device = ["device", "--tool", "ball", "--for", "300ms"];
    for arguments in [
        [&serve[..], &["--connect", away]].concat(),
        [&serve[..], &["--connect", away, "--ros2"]].concat(),
        [&serve[..], &["--connect", away, "--identity", &daemon]].concat(),
        [
            &serve[..],
            &["--connect", switched_off, "--identity", &daemon],
        ]
        .concat(),
        [&serve[..], &["--connect", "tls/10.99.0.2:7447"]].concat(),
        [&serve[..], &["--connect", "quic/10.99.0.2:7447"]].concat(),
        [&serve[..], &["--connect", "tcp/[::ffff:10.99.0.2]:7447"]].concat(),
        [&serve[..], &["--listen", &local, "--zenoh-config", &dials]].concat(),
        [
            &serve[..],
            &["--listen", &local, "--zenoh-config", &multicast],
        ]
        .concat(),
        [&serve[..], &["--listen", &local, "--zenoh-config", &gossip]].concat(),
        [&serve[..], &["--listen", &local, "--zenoh-config", &admin]].concat(),
        [&serve[..], &["--zenoh-config", &client]].concat(),
        [&play[..], &["--connect", away]].concat(),
        [&relay[..], &[away]].concat(),
        [&relay[..], &[away, "--read-only"]].concat(),
        [&relay[..], &["tls/10.99.0.2:7447"]].concat(),
        [&device[..], &["--connect", away]].concat(),
        [&device[..], &["--zenoh-config", &client]].concat(),
        [&device[..], &["--zenoh-config", &multicast]].concat(),
        [
            &device[..],
            &["--hardware", "haply", "--uri", "ws://10.99.0.2"],
        ]
        .concat(),
        vec!["device", "--as", "crtk", "--connect", away],
        vec!["device", "--guard", "crtk", "--connect", away],
        vec!["rpc", "shutdown", "--connect", away],
        vec!["ls", "--connect", away],
        vec!["echo", "status", "--connect", away],
        vec!["hz", "status", "--connect", away],
        vec!["doctor", "--connect", away],
        vec!["lobby", "--for", "300ms", "--listen", "tcp/10.99.0.2:0"],
    ] {
        let output = Command::new(PROGRAM)
            .args(&arguments)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let text = words(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        let told = text.contains("--insecure") || text.contains("--identity");
        assert!(told, "{arguments:?}: {text}");
    }
}

#[test]
fn a_private_key_that_others_can_read_is_used_by_no_command() {
    let directory = tempfile::tempdir().unwrap();
    let authority = Authority::create(&directory.path().join("ca")).unwrap();
    let identity = authority
        .issue(&super::request(Role::Daemon), None)
        .unwrap();
    let ca = directory.path().join("ca");
    let identity = identity.display().to_string();
    let scene = directory.path().join("scene.toml").display().to_string();
    std::fs::write(&scene, SCENE).unwrap();
    let [ca, key] = [ca.clone(), ca.join("ca.key")].map(|path| path.display().to_string());
    let endpoint = format!("tls/127.0.0.1:{}", free_port());
    let endpoint = endpoint.as_str();
    let all = [
        vec![
            "serve",
            &scene,
            "--for",
            "300ms",
            "--listen",
            endpoint,
            "--identity",
            &identity,
        ],
        vec![
            "relay",
            "--from",
            endpoint,
            "--listen",
            "tcp/127.0.0.1:0",
            "--identity",
            &identity,
        ],
        vec!["lobby", "--for", "300ms", "--identity", &identity],
        vec![
            "device",
            "--tool",
            "ball",
            "--connect",
            endpoint,
            "--identity",
            &identity,
        ],
        vec![
            "device",
            "--as",
            "crtk",
            "--connect",
            endpoint,
            "--identity",
            &identity,
        ],
        vec!["ls", "--connect", endpoint, "--identity", &identity],
        vec!["ls", "--connect", endpoint, "--zenoh-config", &identity],
        vec!["auth", "issue", &ca, "--role", "viewer"],
    ];
    use std::os::unix::fs::PermissionsExt as _;
    for (mode, arguments) in all.iter().flat_map(|all| [(0o644, all), (0o640, all)]) {
        for file in [&identity, &key] {
            std::fs::set_permissions(file, std::fs::Permissions::from_mode(mode)).unwrap();
        }
        let output = Command::new(PROGRAM)
            .args(arguments)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let text = words(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains("chmod 600"), "{arguments:?}: {text}");
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
        listed.contains(&format!(
            "OPEN to others, who can move tools and give commands: {wide}"
        )),
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
