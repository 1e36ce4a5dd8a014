//! Daemons and devices in processes of their own, and the files that they read.

use palpate_client::{Connect, Palpate};
use std::net::TcpListener;
use std::os::unix::process::CommandExt as _;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A directory of its own, gone with this.
pub(super) struct Files(PathBuf);

impl Files {
    pub(super) fn new(name: &str) -> anyhow::Result<Self> {
        let directory = std::env::temp_dir().join(format!("palpate-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&directory)?;
        Ok(Self(directory))
    }

    /// A path in it.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file; gives its path.
    pub(super) fn write(&self, name: &str, text: &str) -> anyhow::Result<String> {
        let path = self.0.join(name);
        std::fs::write(&path, text)?;
        Ok(path.to_string_lossy().into_owned())
    }
}

impl Drop for Files {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// `palpate` in a process of its own, out of this program; it dies with this.
pub(super) struct Process(Child);

impl Process {
    /// With these arguments, silent. It dies with the calling thread even if this program is
    /// killed.
    pub(super) fn start(args: &[&str]) -> anyhow::Result<Self> {
        let mut command = Command::new(std::env::current_exe()?);
        command
            .arg("palpate")
            .args(args)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        Ok(Self(spawn_below(&mut command)?))
    }

    /// A simulated device that presses the tool `ball` of a daemon until it is dropped.
    pub(super) fn pressing(endpoint: &str) -> anyhow::Result<Self> {
        Self::start(&[
            "device",
            "--tool",
            "ball",
            "--motion",
            "press",
            "--for",
            "36000s",
            "--connect",
            endpoint,
        ])
    }

    /// Its number.
    pub(super) fn id(&self) -> u32 {
        self.0.id()
    }

    /// Time that it has spent on cores, s.
    pub(super) fn cpu_s(&self) -> anyhow::Result<f64> {
        let text = std::fs::read_to_string(format!("/proc/{}/stat", self.0.id()))?;
        // After the name, which may hold anything: state is the first, user and system time the
        // twelfth and thirteenth.
        let fields = text.rsplit_once(')').map_or("", |(_, fields)| fields);
        let ticks: u64 = (fields.split_whitespace().skip(11).take(2))
            .filter_map(|field| field.parse::<u64>().ok())
            .sum();
        // SAFETY: a plain question to the system.
        #[allow(unsafe_code)]
        let per_s = unsafe { libc::sysconf(libc::_SC_CLK_TCK) };
        Ok(ticks as f64 / per_s as f64)
    }

    /// Ends it as a crash would, without a word.
    pub(super) fn kill(mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Starts a process that the system ends with the calling thread, even if this program is killed.
pub(super) fn spawn_below(command: &mut Command) -> std::io::Result<Child> {
    // SAFETY: prctl is async-signal-safe and touches nothing but the new process.
    #[allow(unsafe_code)]
    unsafe {
        command.pre_exec(|| {
            libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
            Ok(())
        });
    }
    command.spawn()
}

/// A loopback port that nobody uses now.
pub(super) fn free_port() -> anyhow::Result<u16> {
    Ok(TcpListener::bind("127.0.0.1:0")?.local_addr()?.port())
}

/// Joins a daemon that has just been started.
pub(super) fn connect(endpoint: &str) -> anyhow::Result<Palpate> {
    let begun = Instant::now();
    loop {
        match Palpate::connect(&Connect {
            timeout: Duration::from_secs(10),
            ..Connect::to(endpoint)
        }) {
            Err(_) if begun.elapsed() < Duration::from_secs(20) => {
                std::thread::sleep(Duration::from_millis(50))
            }
            answer => return Ok(answer?),
        }
    }
}
