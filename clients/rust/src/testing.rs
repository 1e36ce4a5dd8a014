//! Sessions for integration tests: each starts its own daemon in lockstep on a free endpoint and ends
//! it when dropped.
//!
//! ```no_run
//! use palpate_client::{pose_at, testing::TestSession};
//! let scene = std::fs::read_to_string("scenes/rigid-teardrop.toml").unwrap();
//! let mut session = TestSession::of(&scene).start()?;
//! let mut ball = session.tool("ball")?;
//! let force = session.step(&mut ball, pose_at([0.05, 0.003, 0.045]))?;
//! assert!(force.force[0] > 0.0);
//! let recording = session.finish(ball)?; // the bytes of the MCAP file
//! # Ok::<(), palpate_client::testing::TestError>(())
//! ```

use crate::{ClientError, Connect, Palpate, Tool};
use palpate_proto::messages::{ToolForce, ToolPose};
use palpate_proto::rpc::Call;
use std::io::Read as _;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Environment variable with the path of the daemon's program, unless a test sets it.
pub const PROGRAM_VARIABLE: &str = "PALPATE";

/// Why a test session failed.
#[derive(Debug, thiserror::Error)]
pub enum TestError {
    /// No such program, or a file that cannot be written.
    #[error("{what}: {source}")]
    Io {
        /// What was tried.
        what: String,
        /// The underlying error.
        source: std::io::Error,
    },
    /// The daemon ended by itself.
    #[error("the daemon ended ({status}): {stderr}")]
    Ended {
        /// Its exit status.
        status: ExitStatus,
        /// What it wrote to stderr.
        stderr: String,
    },
    /// Communication with the daemon failed.
    #[error(transparent)]
    Client(#[from] ClientError),
    /// No force arrived.
    #[error(
        "no force for pose {seq} after {timeout:?}: in lockstep a tick waits for a pose of every tool of the scene"
    )]
    NoForce {
        /// Sequence number of the pose.
        seq: u64,
        /// How long the test waited.
        timeout: Duration,
    },
}

/// Settings of a test session.
#[derive(Clone, Debug)]
pub struct TestSettings {
    scene: String,
    program: Option<PathBuf>,
    record: Option<PathBuf>,
    lockstep: bool,
    arguments: Vec<String>,
    timeout: Duration,
}

impl TestSettings {
    /// Sets the daemon's program. The default is the environment variable `PALPATE`, or else `palpate`
    /// on the path.
    pub fn program(self, program: impl Into<PathBuf>) -> Self {
        Self {
            program: Some(program.into()),
            ..self
        }
    }

    /// Keeps the recording in this file instead of a temporary directory. The file must not exist.
    pub fn record(self, path: impl Into<PathBuf>) -> Self {
        Self {
            record: Some(path.into()),
            ..self
        }
    }

    /// Runs in real time instead of one tick per pose.
    pub fn realtime(self) -> Self {
        Self {
            lockstep: false,
            ..self
        }
    }

    /// Adds arguments of `palpate serve`.
    pub fn arguments(mut self, arguments: &[&str]) -> Self {
        self.arguments
            .extend(arguments.iter().map(|argument| (*argument).to_owned()));
        self
    }

    /// Sets how long to wait for the daemon, and for a force. The default of 60 s allows for slow test
    /// machines.
    pub fn timeout(self, timeout: Duration) -> Self {
        Self { timeout, ..self }
    }

    /// Starts the daemon and connects.
    ///
    /// # Errors
    /// The program is missing, the scene is rejected (with the daemon's message), or the connection
    /// fails.
    pub fn start(&self) -> Result<TestSession, TestError> {
        // Another process may take the port between our look and the daemon's.
        let mut last = None;
        for _ in 0..5 {
            match self.start_once() {
                Err(TestError::Ended { stderr, status }) if stderr.contains("cannot listen") => {
                    last = Some(TestError::Ended { stderr, status });
                }
                other => return other,
            }
        }
        Err(last.expect("five tries"))
    }

    fn start_once(&self) -> Result<TestSession, TestError> {
        let files = Files::new()?;
        let scene = files.0.join("scene.toml");
        std::fs::write(&scene, &self.scene).map_err(io(&scene.display()))?;
        let record = self
            .record
            .clone()
            .unwrap_or_else(|| files.0.join("session.mcap"));
        let free = TcpListener::bind("127.0.0.1:0").and_then(|listener| listener.local_addr());
        let endpoint = format!("tcp/{}", free.map_err(io(&"a free port"))?);
        let program = self
            .program
            .clone()
            .or_else(|| std::env::var_os(PROGRAM_VARIABLE).map(PathBuf::from));
        let program = program.unwrap_or_else(|| PathBuf::from("palpate"));
        let words = files.0.join("stderr");
        let stderr = std::fs::File::create(&words).map_err(io(&words.display()))?;
        let child = Command::new(&program)
            .arg("serve")
            .arg(&scene)
            .args([
                "--clock",
                if self.lockstep {
                    "lockstep"
                } else {
                    "realtime"
                },
            ])
            .args([
                "--listen",
                &endpoint,
                "--no-rt",
                "--with-parent",
                "--record",
            ])
            .arg(&record)
            .args(&self.arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(stderr)
            .spawn()
            .map_err(io(&program.display()))?;
        let mut daemon = Daemon { child, words };
        let begun = Instant::now();
        let settings = Connect {
            timeout: self.timeout,
            ..Connect::to(&endpoint)
        };
        let palpate = loop {
            match Palpate::connect(&settings) {
                Ok(palpate) => break palpate,
                Err(error) if begun.elapsed() >= self.timeout => return Err(error.into()),
                Err(_) => daemon.still_runs()?,
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        // It listens before it answers.
        palpate.scene()?;
        Ok(TestSession {
            palpate,
            daemon,
            record,
            endpoint,
            timeout: self.timeout,
            _files: files,
        })
    }
}

fn io(what: &dyn std::fmt::Display) -> impl FnOnce(std::io::Error) -> TestError {
    let what = what.to_string();
    move |source| TestError::Io { what, source }
}

/// A running daemon with a connection to it. Dropping it stops the daemon.
pub struct TestSession {
    // Fields are dropped in this order: first the link, then the daemon, then its files.
    palpate: Palpate,
    daemon: Daemon,
    record: PathBuf,
    endpoint: String,
    timeout: Duration,
    _files: Files,
}

impl TestSession {
    /// A session of a scene, given as the text of its file: in lockstep, recorded.
    pub fn of(scene: &str) -> TestSettings {
        TestSettings {
            scene: scene.to_owned(),
            program: None,
            record: None,
            lockstep: true,
            arguments: Vec::new(),
            timeout: Duration::from_secs(60),
        }
    }

    /// The connection.
    pub fn palpate(&self) -> &Palpate {
        &self.palpate
    }

    /// Where the daemon listens.
    pub fn endpoint(&self) -> &str {
        &self.endpoint
    }

    /// Takes ownership of a tool of the scene.
    ///
    /// # Errors
    /// No such tool, or the daemon has ended.
    pub fn tool(&mut self, id: &str) -> Result<Tool, TestError> {
        self.daemon.still_runs()?;
        Ok(self.palpate.tool(id)?)
    }

    /// Sends a pose and waits for its force: one tick, in a scene with one tool.
    ///
    /// # Errors
    /// The daemon has ended, or no force comes.
    pub fn step(&mut self, tool: &mut Tool, pose: ToolPose) -> Result<ToolForce, TestError> {
        let seq = tool.send(pose)?;
        let force = tool.wait_force(seq, self.timeout);
        if force.is_none() {
            tool.take_refusal()?;
            self.daemon.still_runs()?;
        }
        force.ok_or(TestError::NoForce {
            seq,
            timeout: self.timeout,
        })
    }

    /// Stops the daemon, which finishes its recording, and returns the recording's bytes. Pass in the
    /// tools: they are released first.
    ///
    /// # Errors
    /// The daemon failed; a recording with losses counts as a failure.
    pub fn finish(mut self, tools: impl Sized) -> Result<Vec<u8>, TestError> {
        // The last pose of a lockstep session may be under way no more: the daemon stops between
        // ticks.
        self.palpate.rpc(Call::Shutdown)?;
        drop(tools);
        let begun = Instant::now();
        while begun.elapsed() < self.timeout {
            if let Some(status) = self.daemon.status()? {
                if !status.success() {
                    return Err(TestError::Ended {
                        status,
                        stderr: self.daemon.words(),
                    });
                }
                return std::fs::read(&self.record).map_err(io(&self.record.display()));
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        let source = std::io::Error::from(std::io::ErrorKind::TimedOut);
        Err(TestError::Io {
            what: "the daemon does not end".into(),
            source,
        })
    }
}

struct Daemon {
    child: Child,
    words: PathBuf,
}

impl Daemon {
    fn status(&mut self) -> Result<Option<ExitStatus>, TestError> {
        self.child.try_wait().map_err(io(&"waiting for the daemon"))
    }

    fn still_runs(&mut self) -> Result<(), TestError> {
        match self.status()? {
            None => Ok(()),
            Some(status) => Err(TestError::Ended {
                status,
                stderr: self.words(),
            }),
        }
    }

    fn words(&self) -> String {
        let mut text = String::new();
        let read =
            std::fs::File::open(&self.words).and_then(|mut file| file.read_to_string(&mut text));
        read.map_or_else(|error| error.to_string(), |_| text)
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A directory of its own, gone with this.
struct Files(PathBuf);

impl Files {
    fn new() -> Result<Self, TestError> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path: &Path =
            &std::env::temp_dir().join(format!("palpate-test-{}-{number}", std::process::id()));
        std::fs::create_dir_all(path).map_err(io(&path.display()))?;
        Ok(Self(path.to_owned()))
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
