//! Who may touch: certificates, roles, and what is refused.

mod commands;
mod exposure;
mod leaving;
mod links;
mod namespaces;
mod roles;
mod router;
mod strangers;

use crate::daemon::{PROGRAM, free_port};
use palpate::auth::{Authority, Request, Role};
use palpate::transport::{Access, SessionError, SessionSettings};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Two balls on a rigid drop.
const SCENE: &str = r#"
[[body]]
id = "drop"
surface = { builtin = "teardrop" }
model = "rigid"
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
[[tool]]
id = "pen"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [-0.06, 0.003, 0.045] }
"#;

const YEAR: Duration = Duration::from_secs(365 * 86_400);

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
