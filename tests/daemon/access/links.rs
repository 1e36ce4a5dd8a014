//! Where links lead: a session has those that it was told of, and rules know this machine by its loopback
//! interface.

use super::namespaces::{Cable, Ended, words};
use super::{SCENE, request};
use crate::daemon::{Daemon, free_port};
use crate::wire::until;
use palpate::auth::{Authority, Request, Role};
use palpate::transport::daemon_of;
use palpate_client::links::is_here;
use std::process::Stdio;
use std::time::Duration;
use zenoh::Wait as _;

/// A session of Zenoh in mode peer. Credulous is Zenoh's own way: it joins whoever it hears of.
fn peer(credulous: bool, listen: &[&str], connect: &[&str]) -> zenoh::Session {
    assert!(listen.iter().chain(connect).all(|at| is_here(at)));
    let mut config = zenoh::Config::default();
    for (key, value) in [
        ("mode", serde_json::json!("peer")),
        ("scouting/multicast/enabled", false.into()),
        ("listen/endpoints", listen.into()),
        ("connect/endpoints", connect.into()),
    ] {
        config.insert_json5(key, &value.to_string()).unwrap();
    }
    if !credulous {
        config
            .insert_json5("scouting/gossip/autoconnect", "[]")
            .unwrap();
    }
    zenoh::open(config).wait().unwrap()
}

fn linked(session: &zenoh::Session) -> Vec<String> {
    let info = session.info();
    let all = info.peers_zid().wait().chain(info.routers_zid().wait());
    let mut all: Vec<String> = all.map(|id| id.to_string()).collect();
    all.sort();
    all
}

fn id(session: &zenoh::Session) -> String {
    session.info().zid().wait().to_string()
}

// Seen: a viewer told the daemon where a session without a certificate listens; the daemon connected to it, and its
// `pause` was carried out. Another viewer's address went to a device, which connected to it.
#[test]
fn nobody_is_joined_because_a_neighbour_names_him() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let tool = daemon.connect();
    let endpoint = format!("tcp/127.0.0.1:{}", free_port());
    let stranger = peer(false, &[&endpoint], &[]);
    let neighbour_at = format!("tcp/127.0.0.1:{}", free_port());
    let neighbour = peer(false, &[&neighbour_at], &[&daemon.endpoint, &endpoint]);
    // One that joins whom it hears of, as Zenoh does: by the neighbour the stranger, by the daemon the neighbour.
    let credulous = peer(true, &[], &[&neighbour_at]);
    let by_daemon = peer(true, &[], &[&daemon.endpoint]);
    let of_stranger = until(
        "the stranger is named",
        || linked(&stranger),
        |all| all.contains(&id(&credulous)),
    );
    let of_neighbour = until(
        "the neighbour is named",
        || linked(&neighbour),
        |all| all.contains(&id(&by_daemon)),
    );
    // What the others did the daemon and the tool's session had the same time for, and this more.
    std::thread::sleep(Duration::from_millis(300));
    let mut expected = [&neighbour, &credulous, &by_daemon].map(id).to_vec();
    expected.sort();
    let seen: Vec<String> = [of_stranger, linked(&stranger)].concat();
    assert!(seen.iter().all(|id| expected.contains(id)), "{seen:?}");
    let keys = palpate_client::proto::keys::Keys::new("default").unwrap();
    let daemon_id = daemon_of(&by_daemon, &keys, Duration::from_secs(20));
    let daemon_id = daemon_id.unwrap().expect("the daemon is there");
    let known: Vec<String> = [
        [&stranger, &credulous, &by_daemon].map(id).to_vec(),
        vec![daemon_id],
    ]
    .concat();
    let seen = [of_neighbour, linked(&neighbour)].concat();
    assert!(seen.iter().all(|id| known.contains(id)), "{seen:?}");
    assert!(tool.status().is_ok());
}

#[test]
fn a_tool_behind_a_router_gets_forces_through_it() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), SCENE, &[]);
    let relay = Daemon::spawn(
        free_port(),
        std::process::Command::new(crate::daemon::PROGRAM).args([
            "relay",
            "--from",
            &daemon.endpoint,
        ]),
    );
    let (report, code) = crate::daemon::device(&relay.endpoint, &["--for", "1s"]);
    assert_eq!(code, 0, "{report}");
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert!(report["forces"].as_u64().unwrap() > 0, "{report}");
}

#[test]
fn a_daemon_that_joins_another_says_that_whoever_is_let_in_there_may_command() {
    let directory = tempfile::tempdir().unwrap();
    let first = Daemon::start(directory.path(), SCENE, &[]);
    let second = Daemon::start(
        directory.path(),
        SCENE,
        &["--instance", "second", "--connect", &first.endpoint],
    );
    let info = palpate_client::Palpate::connect(&palpate_client::Connect {
        instance: "second".into(),
        timeout: Duration::from_secs(20),
        ..palpate_client::Connect::to(&second.endpoint)
    })
    .unwrap()
    .info()
    .unwrap();
    let info: serde_json::Value = serde_json::from_str(&info).unwrap();
    let said = format!("{} (whoever it lets in)", first.endpoint);
    assert_eq!(info["open"], serde_json::json!([said]));
}

/// Two machines. On the second a router of strangers, open to everybody, with a daemon `theirs` behind it.
fn strangers(cable: &Cable, scene: &str) -> [Ended; 2] {
    let theirs = "tcp/127.0.0.1:7448";
    let router = format!("tcp/10.77.{}.2:7447", cable.net);
    let start = |arguments: &[&str]| {
        let mut child = cable
            .at("b", arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        super::router::wait_for(&mut child, "\"ready\":true");
        Ended(child)
    };
    let daemon = start(&[
        "serve",
        scene,
        "--no-rt",
        "--json",
        "--instance",
        "theirs",
        "--listen",
        theirs,
    ]);
    let relay = start(&[
        "relay",
        "--json",
        "--from",
        theirs,
        "--listen",
        "tcp/127.0.0.1:7447",
        "--listen",
        &router,
        "--insecure",
    ]);
    [daemon, relay]
}

pub(super) fn a_router_of_strangers_sees_a_daemon_only_if_that_was_allowed_and_then_it_is_said() {
    let Some(cable) = Cable::lay() else {
        println!("skipped: `ip netns` does not work here");
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    let write = |name: &str, text: &str| {
        std::fs::write(at(name), text).unwrap();
        at(name)
    };
    let scene = write("scene.toml", SCENE);
    let authority = Authority::create(directory.path()).unwrap();
    authority.issue(&request(Role::Daemon), None).unwrap();
    let (identity, router) = (
        at("daemon.json5"),
        format!("tcp/10.77.{}.2:7447", cable.net),
    );
    let dials = write(
        "dials.json5",
        &format!("{{ connect: {{ endpoints: [{router:?}] }} }}"),
    );
    let multicast = write(
        "multicast.json5",
        "{ scouting: { multicast: { enabled: true } } }",
    );
    let told = write(
        "told.toml",
        &format!("{SCENE}\n[zenoh]\nconfig = \"dials.json5\"\n"),
    );
    let _strangers = strangers(&cable, &scene);
    let listed = || words(&cable.at("b", &["ls"]).output().unwrap());
    for arguments in [
        &[scene.as_str(), "--connect", &router][..],
        &[&scene, "--connect", &router, "--ros2"],
        &[&scene, "--connect", &router, "--identity", &identity],
        &[&scene, "--zenoh-config", &dials],
        &[&scene, "--zenoh-config", &multicast],
        &[&told],
    ] {
        let serve = ["serve", "--no-rt", "--for", "3s"];
        let output = cable
            .at("a", &[&serve, arguments].concat())
            .output()
            .unwrap();
        assert_eq!(
            output.status.code(),
            Some(2),
            "{arguments:?}: {}",
            words(&output)
        );
    }
    let refused = words(&cable.at("a", &["serve", &told]).output().unwrap());
    assert!(refused.contains("--zenoh-config FILE"), "{refused}");
    let seen = listed();
    assert!(
        seen.contains("theirs:") && !seen.contains("default:"),
        "{seen}"
    );
    // The same with the word that allows it.
    let serve = [
        "serve",
        &scene,
        "--no-rt",
        "--json",
        "--connect",
        &router,
        "--insecure",
    ];
    let mut child = (cable.at("a", &serve).stdout(Stdio::piped()))
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    super::router::wait_for(&mut child, "\"ready\":true");
    let _daemon = Ended(child);
    let seen = until("the daemon at the router", listed, |seen| {
        seen.contains("default:")
    });
    assert!(
        seen.contains(&format!("give commands: {router}\n")),
        "{seen}"
    );
}

// A link over plain TCP says nothing of who is there. At a router as at a daemon only the loopback interface does.
pub(super) fn behind_a_router_with_our_rules_a_link_without_certificate_is_this_machines_only_on_loopback()
 {
    let Some(cable) = Cable::lay() else {
        println!("skipped: `ip netns` does not work here");
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    std::fs::write(at("scene.toml"), SCENE).unwrap();
    let scene = at("scene.toml");
    let rules = cable.at("a", &["auth", "rules", &scene]).output().unwrap();
    std::fs::write(at("rules.json5"), rules.stdout).unwrap();
    let rules = at("rules.json5");
    let start = |arguments: &[&str]| {
        let mut child = cable
            .at("a", arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        super::router::wait_for(&mut child, "\"ready\":true");
        Ended(child)
    };
    let local = "tcp/127.0.0.1:7448";
    let _daemon = start(&["serve", &scene, "--no-rt", "--json", "--listen", local]);
    let wide = format!("tcp/10.77.{}.1:7447", cable.net);
    let _router = start(&[
        "relay",
        "--json",
        "--from",
        local,
        "--listen",
        &wide,
        "--listen",
        "tcp/127.0.0.1:7447",
        "--zenoh-config",
        &rules,
        "--insecure",
    ]);
    // At the same time: who is refused waits for an answer.
    let pause = |end: &str, endpoint: &str| {
        let mut asked = cable.at(end, &["rpc", "pause", "--insecure", "--connect", endpoint]);
        let asked = asked.stdout(Stdio::piped()).stderr(Stdio::piped());
        asked.spawn().unwrap()
    };
    let from_there = pause("b", &wide);
    // From its own machine, but over the network's interface: nobody can tell.
    let own = pause("a", &wide);
    let from_here = pause("a", "tcp/127.0.0.1:7447");
    let [from_there, own, from_here] =
        [from_there, own, from_here].map(|asked| asked.wait_with_output().unwrap());
    assert!(!from_there.status.success(), "{}", words(&from_there));
    assert!(!own.status.success(), "{}", words(&own));
    assert!(from_here.status.success(), "{}", words(&from_here));
}

#[test]
fn beside_tls_a_daemon_lets_programs_of_its_machine_in_by_loopback_and_sockets() {
    let directory = tempfile::tempdir().unwrap();
    let authority = Authority::create(&directory.path().join("ca")).unwrap();
    let identity = authority
        .issue(
            &Request {
                hosts: vec!["127.0.0.1".into()],
                ..request(Role::Daemon)
            },
            None,
        )
        .unwrap();
    let identity = identity.display().to_string();
    let socket = format!("unixsock-stream/{}", directory.path().join("bus").display());
    let tls = format!("tls/127.0.0.1:{}", free_port());
    let arguments = [
        "--listen",
        &tls,
        "--listen",
        &socket,
        "--identity",
        &identity,
    ];
    let daemon = Daemon::start(directory.path(), SCENE, &arguments);
    for endpoint in [&daemon.endpoint, &socket] {
        let palpate = palpate_client::Palpate::connect(&palpate_client::Connect {
            timeout: Duration::from_secs(20),
            ..palpate_client::Connect::to(endpoint)
        })
        .unwrap();
        palpate
            .rpc(palpate_client::proto::rpc::Call::Pause)
            .unwrap();
    }
}
