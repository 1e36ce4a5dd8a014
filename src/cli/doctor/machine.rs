//! What the operating system grants.

use palpate_drive::pacer::Privileges;
use serde::Serialize;
use std::io;
use std::net::{Ipv4Addr, TcpListener, UdpSocket};
use std::os::fd::AsRawFd;
use std::time::Duration;

/// Group in which Zenoh sessions look for each other.
const GROUP: Ipv4Addr = Ipv4Addr::new(224, 0, 0, 224);
/// The default port of a daemon, and the ports after it.
const PORTS: [u16; 4] = [7447, 7448, 7449, 7450];

/// What this machine allows.
#[derive(Serialize)]
pub(super) struct Machine {
    cores: usize,
    /// Frequency governor of the first core.
    governor: Option<String>,
    sched_fifo: bool,
    mlockall: bool,
    timer_slack: bool,
    /// Memory that may be locked, bytes; absent: all.
    memory_lock_limit: Option<u64>,
    /// Why a multicast message did not come back, if it did not.
    multicast_error: Option<String>,
    port_7447_free: bool,
    free_ports: Vec<u16>,
}

impl Machine {
    pub(super) fn look(privileges: Privileges) -> Self {
        let free_ports: Vec<u16> = PORTS
            .into_iter()
            .filter(|&port| TcpListener::bind(("127.0.0.1", port)).is_ok())
            .collect();
        let governor =
            std::fs::read_to_string("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
        Self {
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            governor: governor.ok().map(|text| text.trim().to_owned()),
            sched_fifo: privileges.fifo,
            mlockall: privileges.locked,
            timer_slack: privileges.slack,
            memory_lock_limit: memory_lock_limit(),
            multicast_error: hears_itself().err().map(|e| e.to_string()),
            port_7447_free: free_ports.contains(&PORTS[0]),
            free_ports,
        }
    }

    pub(super) fn print(&self) {
        let granted = |yes: bool| {
            if yes {
                "granted"
            } else {
                "refused (the loop runs without it)"
            }
        };
        let line = |name: &str, value: &str| println!("{name:<26}{value}");
        line("cores", &self.cores.to_string());
        match self.governor.as_deref() {
            Some("performance") => line("frequency governor", "performance"),
            Some(other) => line(
                "frequency governor",
                &format!("{other}: `performance` gives lower latency"),
            ),
            None => line("frequency governor", "not readable"),
        }
        line("SCHED_FIFO", granted(self.sched_fifo));
        line("mlockall", granted(self.mlockall));
        match self.memory_lock_limit {
            None => line("memory lock limit", "none"),
            Some(bytes) => line(
                "memory lock limit",
                &format!("{} KiB (ulimit -l)", bytes / 1024),
            ),
        }
        line("timer slack of 1 ns", granted(self.timer_slack));
        match &self.multicast_error {
            None => line("multicast", "works (not needed by a daemon)"),
            Some(error) => line(
                "multicast",
                &format!("does not work: {error} (not needed by a daemon)"),
            ),
        }
        let free: Vec<String> = self.free_ports.iter().map(u16::to_string).collect();
        match (self.port_7447_free, free.first()) {
            (true, _) => line(
                "ports",
                &format!("7447 is free (so are {})", free[1..].join(", ")),
            ),
            (false, Some(other)) => {
                line(
                    "ports",
                    &format!(
                        "7447 is taken: use --listen tcp/127.0.0.1:{other} (free: {})",
                        free.join(", ")
                    ),
                );
            }
            (false, None) => line(
                "ports",
                "7447 to 7450 are taken: use --listen tcp/127.0.0.1:PORT",
            ),
        }
    }
}

/// Bytes this process may lock; `None` without a limit.
#[allow(unsafe_code)]
fn memory_lock_limit() -> Option<u64> {
    let mut limit = libc::rlimit {
        rlim_cur: 0,
        rlim_max: 0,
    };
    // SAFETY: `limit` is a valid rlimit that the call fills.
    let done = unsafe { libc::getrlimit(libc::RLIMIT_MEMLOCK, &mut limit) } == 0;
    (done && limit.rlim_cur != libc::RLIM_INFINITY).then_some(limit.rlim_cur)
}

/// Joins the group on the loopback interface, sends a message to it and waits for that message.
fn hears_itself() -> io::Result<()> {
    let ears = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))?;
    ears.join_multicast_v4(&GROUP, &Ipv4Addr::LOCALHOST)?;
    ears.set_read_timeout(Some(Duration::from_millis(200)))?;
    let mouth = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
    send_through_loopback(&mouth)?;
    mouth.set_multicast_loop_v4(true)?;
    let word = b"palpate doctor";
    mouth.send_to(word, (GROUP, ears.local_addr()?.port()))?;
    let mut heard = [0; 64];
    let (len, _) = ears.recv_from(&mut heard)?;
    if heard[..len] == *word {
        Ok(())
    } else {
        Err(io::Error::other("another process answered"))
    }
}

/// Multicast leaves this socket by the loopback interface.
#[allow(unsafe_code)]
fn send_through_loopback(socket: &UdpSocket) -> io::Result<()> {
    let interface = libc::in_addr {
        s_addr: u32::from(Ipv4Addr::LOCALHOST).to_be(),
    };
    let size = size_of::<libc::in_addr>() as libc::socklen_t;
    // SAFETY: the descriptor is open, and the option takes an in_addr of this size.
    let done = unsafe {
        let value = std::ptr::from_ref(&interface).cast();
        libc::setsockopt(
            socket.as_raw_fd(),
            libc::IPPROTO_IP,
            libc::IP_MULTICAST_IF,
            value,
            size,
        )
    };
    if done == 0 {
        Ok(())
    } else {
        Err(io::Error::last_os_error())
    }
}
