//! Who may touch: certificates, roles, and what is refused.

mod commands;
mod exposure;
mod leaving;
mod links;
mod namespaces;
mod roles;
mod router;
mod strangers;

use crate::daemon::{PROGRAM, free_port, side_by_side};
use crate::scenes::TWO_BALLS as SCENE;
use palpate::auth::{Authority, Request, Role};
use palpate::transport::{Access, SessionError, SessionSettings};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const YEAR: Duration = Duration::from_secs(365 * 86_400);

#[test]
fn of_two_machines_one_comes_in_by_its_role_alone_and_stays_behind_routers() {
    side_by_side![
        links::behind_a_router_with_our_rules_a_link_without_certificate_is_this_machines_only_on_loopback,
        links::a_router_of_strangers_sees_a_daemon_only_if_that_was_allowed_and_then_it_is_said,
        router::a_router_with_tls_between_two_machines_goes_and_comes_back_and_the_force_with_it,
        namespaces::another_machine_comes_in_with_its_role_and_without_one_not_at_all,
    ];
}

#[test]
fn strangers_are_kept_out_and_an_identity_lets_in_as_long_and_as_far_as_it_says() {
    side_by_side![
        strangers::strangers_are_refused_and_told_why,
        strangers::strangers_are_refused_over_quic_too,
        strangers::a_link_ends_when_its_certificate_does,
        commands::a_device_presses_with_its_own_identity_and_a_viewer_gives_no_commands,
    ];
}

pub fn request(role: Role) -> Request {
    let hosts = match role {
        Role::Daemon => vec!["127.0.0.1".to_owned(), "localhost".to_owned()],
        _ => Vec::new(),
    };
    Request {
        role,
        name: None,
        hosts,
        valid: YEAR,
    }
}

/// A daemon with TLS, and the authority of its clients.
struct Secured {
    directory: tempfile::TempDir,
    authority: Authority,
    endpoint: String,
    child: Child,
}

impl Drop for Secured {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Secured {
    fn start() -> Self {
        Self::start_as(&request(Role::Daemon), "tls")
    }

    /// With a daemon's identity and a protocol of choice.
    fn start_as(daemon: &Request, protocol: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let authority = Authority::create(&directory.path().join("ca")).unwrap();
        let identity = directory.path().join("daemon.json5");
        authority.issue(daemon, Some(&identity)).unwrap();
        let scene = directory.path().join("scene.toml");
        std::fs::write(&scene, SCENE).unwrap();
        let port = free_port();
        let endpoint = format!("{protocol}/127.0.0.1:{port}");
        let child = Command::new(PROGRAM)
            .arg("serve")
            .arg(&scene)
            .args(["--no-rt", "--listen", &endpoint, "--identity"])
            .arg(&identity)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let begun = Instant::now();
        while !palpate::transport::is_taken(&endpoint) {
            assert!(begun.elapsed() < Duration::from_secs(60), "nobody listens");
            std::thread::sleep(Duration::from_millis(20));
        }
        Self {
            directory,
            authority,
            endpoint,
            child,
        }
    }

    fn path(&self) -> &Path {
        self.directory.path()
    }

    /// An identity file of a role.
    fn identity(&self, role: Role) -> PathBuf {
        let path = self.path().join(format!("{}.json5", role.stem()));
        if !path.exists() {
            self.authority.issue(&request(role), Some(&path)).unwrap();
        }
        path
    }

    /// A bare session with an identity.
    fn session(&self, identity: &Path) -> Result<zenoh::Session, SessionError> {
        palpate::transport::open(&SessionSettings {
            connect: vec![self.endpoint.clone()],
            role: palpate::transport::Role::Client,
            access: Access {
                identity: Some(identity.to_owned()),
                ..Access::default()
            },
            ..SessionSettings::default()
        })
    }

    fn palpate(&self, arguments: &[&str], identity: &Path) -> (i32, String) {
        let output = Command::new(PROGRAM)
            .args(arguments)
            .args(["--connect", &self.endpoint, "--identity"])
            .arg(identity)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&output.stdout).into_owned()
            + &String::from_utf8_lossy(&output.stderr);
        (output.status.code().unwrap_or(-1), words)
    }
}
