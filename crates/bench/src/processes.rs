//! Daemons and devices in processes of their own, and the files that they read.

use palpate_client::proto::messages::force_flags;
use palpate_client::{Connect, Palpate, Tool, pose_at};
use palpate_drive::pacer::{ask_privileges, now_ns, sleep_until};
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

/// A client with a clock of its own, as a device has one.
pub(super) struct Servo {
    pub every: Duration,
    /// Poses before any counts: to be seated, to press, to be followed.
    pub first: usize,
    pub count: usize,
}

impl Servo {
    /// Sends a pose in each period, at the place of its number, and waits for its force. Gives the times
    /// from pose to force, in ascending order, s, and the last force along z, N.
    pub(super) fn run(
        &self,
        mut tool: Tool,
        place: impl Fn(usize) -> [f64; 3] + Send + 'static,
    ) -> anyhow::Result<(Vec<f64>, f64)> {
        let (first, count) = (self.first, self.count);
        let every_ns = self.every.as_nanos() as u64;
        let run = move || {
            ask_privileges();
            let (mut times_s, mut force_n) = (Vec::with_capacity(count), 0.0);
            let lost = force_flags::STALE | force_flags::WITHHELD;
            let mut due = now_ns();
            for k in 0..first + count {
                due += every_ns;
                sleep_until(due);
                let sent = Instant::now();
                let seq = tool.send(pose_at(place(k)))?;
                if let Some(force) = tool.wait_force(seq, Duration::from_millis(100)) {
                    force_n = force.force[2];
                    let held = k < first || force.flags & lost == 0;
                    anyhow::ensure!(held, "the tool's link was lost: this machine is too busy");
                    if k >= first {
                        times_s.push(sent.elapsed().as_secs_f64());
                    }
                }
                // What is late is not caught up in a burst.
                due += now_ns().saturating_sub(due) / every_ns * every_ns;
            }
            times_s.sort_by(f64::total_cmp);
            anyhow::Ok((times_s, force_n))
        };
        // A thread of its own: what it is granted ends with it.
        let run = std::thread::spawn(run).join();
        let (times_s, force_n) =
            run.map_err(|_| anyhow::anyhow!("the client's thread panicked"))??;
        anyhow::ensure!(!times_s.is_empty(), "no force came back");
        Ok((times_s, force_n))
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
