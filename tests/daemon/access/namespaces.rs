//! Two machines, as two network namespaces with a cable between them. Needs `ip netns` (root); skipped
//! with a line where that is missing.

use super::{SCENE, request};
use crate::daemon::PROGRAM;
use palpate::auth::{Authority, Role};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Namespaces `…a` and `…b`, 10.77.X.1 and 10.77.X.2.
pub(super) struct Cable {
    name: String,
    pub(super) net: u32,
}

fn ip(arguments: &str) -> bool {
    let mut command = Command::new("ip");
    let done = command.args(arguments.split(' ')).output();
    done.is_ok_and(|output| output.status.success())
}

impl Cable {
    pub(super) fn lay() -> Option<Self> {
        // Tests of one program run at the same time.
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let (pid, k) = (std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let cable = Self {
            name: format!("plp{}{k}", pid % 100_000),
            net: (pid + 97 * k) % 250,
        };
        let Self { name, net } = &cable;
        // What fails half way is taken down again.
        let laid = ip(&format!("netns add {name}a"))
            && ip(&format!("netns add {name}b"))
            && ip(&format!("link add {name}x type veth peer name {name}y"))
            && ip(&format!("link set {name}x netns {name}a"))
            && ip(&format!("link set {name}y netns {name}b"))
            && ip(&format!("-n {name}a addr add 10.77.{net}.1/24 dev {name}x"))
            && ip(&format!("-n {name}b addr add 10.77.{net}.2/24 dev {name}y"))
            && ["a", "b"]
                .iter()
                .all(|end| ip(&format!("-n {name}{end} link set lo up")))
            && ip(&format!("-n {name}a link set {name}x up"))
            && ip(&format!("-n {name}b link set {name}y up"));
        laid.then_some(cable)
    }

    /// The program on one of the machines.
    pub(super) fn at(&self, end: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new("ip");
        command.args(["netns", "exec", &format!("{}{end}", self.name), PROGRAM]);
        command.args(arguments).stdin(Stdio::null());
        command
    }
}

impl Drop for Cable {
    fn drop(&mut self) {
        for end in ["a", "b"] {
            ip(&format!("netns del {}{end}", self.name));
        }
        ip(&format!("link del {}x", self.name));
    }
}

pub(super) struct Ended(pub(super) Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

pub(super) fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

pub(super) fn another_machine_comes_in_with_its_role_and_without_one_not_at_all() {
    let Some(cable) = Cable::lay() else {
        println!("skipped: `ip netns` does not work here");
        return;
    };
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name).display().to_string();
    std::fs::write(at("scene.toml"), SCENE).unwrap();
    let authority = Authority::create(directory.path()).unwrap();
    let host = format!("10.77.{}.1", cable.net);
    let daemon = palpate::auth::Request {
        hosts: vec![host.clone()],
        ..request(Role::Daemon)
    };
    authority.issue(&daemon, None).unwrap();
    for role in [Role::Viewer, Role::Operator, Role::tool("ball").unwrap()] {
        authority.issue(&request(role), None).unwrap();
    }
    let endpoint = format!("tls/{host}:7447");
    let (scene, identity) = (at("scene.toml"), at("daemon.json5"));
    let serve = [
        "serve",
        &scene,
        "--no-rt",
        "--listen",
        &endpoint,
        "--identity",
        &identity,
    ];
    let child = cable.at("a", &serve).stderr(Stdio::null()).spawn().unwrap();
    let _daemon = Ended(child);
    let from_there = |arguments: &[&str], identity: &str| {
        let identity = at(identity);
        let more = ["--connect", &endpoint, "--identity", &identity];
        cable
            .at("b", &[arguments, &more[..]].concat())
            .output()
            .unwrap()
    };
    let begun = Instant::now();
    while !from_there(&["ls"], "viewer.json5").status.success() {
        assert!(begun.elapsed() < Duration::from_secs(60), "nobody serves");
        std::thread::sleep(Duration::from_millis(100));
    }
    let device = [
        "device", "--tool", "ball", "--motion", "press", "--for", "1s",
    ];
    let pressed = from_there(&device, "tool-ball.json5");
    assert!(pressed.status.success(), "{}", words(&pressed));
    assert!(
        !from_there(&["rpc", "pause"], "viewer.json5")
            .status
            .success()
    );
    let paused = from_there(&["rpc", "pause"], "operator.json5");
    assert!(paused.status.success(), "{}", words(&paused));
    let plain = format!("tcp/{host}:7447");
    let stranger = cable
        .at("b", &["ls", "--connect", &plain])
        .output()
        .unwrap();
    assert!(!stranger.status.success(), "{}", words(&stranger));
    let bare = cable
        .at("b", &["ls", "--connect", &endpoint])
        .output()
        .unwrap();
    assert!(words(&bare).contains("--identity"), "{}", words(&bare));
}
