//! The queue of events, and the network between daemon and client.

use super::check;
use super::client::Client;
use super::host::{Host, Session};
use super::plan::{Fault, LENGTH_NS, Plan, SCENES, Weather};
use super::{Violation, now_ns, set_now};
use palpate_drive::ports::SenderId;
use palpate_geometry::math::Random;
use palpate_proto::messages::{SceneSnapshot, ToolForce, ToolPose};
use palpate_record::SteppedRecorder;
use palpate_sim::scene::Scene;
use palpate_sim::scene::file::{self, Loaded};
use palpate_sim::tick::record::Command;
use palpate_wire as wire;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::{Arc, OnceLock};

const MS: u64 = 1_000_000;

/// What a simulation came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Hash of everything that happened, in order: the same for the same seed and build.
    pub trace: u64,
    /// Ticks of all daemons.
    pub ticks: u64,
    /// Servo periods of all clients.
    pub periods: u64,
    /// Packets lost, duplicated.
    pub packets: [u64; 2],
    /// Daemons started.
    pub daemons: u64,
    /// Ticks that recordings hold, of all.
    pub recorded: u64,
    /// Ticks of killed daemons that are lost: the most of one.
    pub most_lost: u64,
    /// Greatest force that acted on a hand, N.
    pub peak_force_n: f64,
    /// Least energy at a controlled port with the device's own losses, J.
    pub least_own_j: f64,
}

/// One of a kind at a time: those of an incarnation that is gone are void.
#[derive(Clone, Copy, Debug)]
enum Event {
    Tick(u64),
    Bus(u64),
    Record(u64),
    Period(u64),
    ToHost(Packet),
    ToClient(ToolForce),
    Goes(usize),
    StormEnds,
    HostStarts,
    ClientStarts,
    Resumes,
    StrangerSends(u64, u64),
}

#[derive(Clone, Copy, Debug)]
enum Packet {
    Pose(ToolPose, SenderId),
    Describes(u64),
    Gone,
}

struct World<'w> {
    plan: &'w Plan,
    folder: &'w Path,
    loaded: Loaded,
    scene: Arc<Scene>,
    snapshot: SceneSnapshot,
    random: Random,
    queue: BTreeMap<(u64, u64), Event>,
    order: u64,
    host: Option<Host>,
    client: Option<Client>,
    /// Incarnations so far.
    hosts: u64,
    clients: u64,
    sessions: Vec<Session>,
    weather: Weather,
    cut_until_ns: u64,
    /// In order: nothing arrives before what was sent before it; by way.
    last_arrival_ns: [u64; 2],
    host_stopped_ns: u64,
    bus_stopped_ns: u64,
    disk_stalled_ns: u64,
    client_stopped_ns: u64,
    wall_ns: u64,
    report: Report,
}

/// Runs the simulation of a seed; recordings go to `folder`, which is the simulation's own.
///
/// # Errors
/// The first thing that happened and must not.
pub fn run(seed: u64, folder: &Path) -> Result<Report, Violation> {
    set_now(0);
    let plan = Plan::of(seed);
    let violation = |what: String| Violation {
        seed,
        at_s: now_ns() as f64 * 1e-9,
        what,
    };
    let mut world = World::new(&plan, folder).map_err(violation)?;
    world.run().map_err(violation)?;
    Ok(world.report)
}

pub(super) type Built = (Loaded, Arc<Scene>);

/// Read and built once: thousands of seeds share three scenes.
pub(super) fn scene(index: usize) -> Result<Built, String> {
    static BUILT: [OnceLock<Result<Built, String>>; SCENES.len()] =
        [const { OnceLock::new() }; SCENES.len()];
    let build = || {
        let loaded = file::parse(SCENES[index], "faults.toml", Path::new("."));
        let loaded = loaded.map_err(|error| error.to_string())?;
        let scene = loaded.build().map_err(|error| error.to_string())?;
        Ok((loaded, Arc::new(scene)))
    };
    BUILT[index].get_or_init(build).clone()
}

impl<'w> World<'w> {
    fn new(plan: &'w Plan, folder: &'w Path) -> Result<Self, String> {
        let (loaded, scene) = scene(plan.scene)?;
        let mut world = Self {
            plan,
            folder,
            loaded,
            snapshot: wire::first_snapshot(&scene, [0; 32]),
            scene,
            random: Random(plan.seed),
            queue: BTreeMap::new(),
            order: 0,
            host: None,
            client: None,
            hosts: 0,
            clients: 0,
            sessions: Vec::new(),
            weather: plan.fair,
            cut_until_ns: 0,
            last_arrival_ns: [0; 2],
            host_stopped_ns: 0,
            bus_stopped_ns: 0,
            disk_stalled_ns: 0,
            client_stopped_ns: 0,
            wall_ns: 1_700_000_000_000_000_000,
            report: Report::default(),
        };
        for (number, (at_ns, _)) in plan.faults.iter().enumerate() {
            world.at(*at_ns, Event::Goes(number));
        }
        world.at(0, Event::HostStarts);
        world.at(10 * MS, Event::ClientStarts);
        Ok(world)
    }

    fn at(&mut self, ns: u64, event: Event) {
        self.order += 1;
        self.queue.insert((ns, self.order), event);
    }

    fn trace(&mut self, word: u64) {
        let mixed = (self.report.trace ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        self.report.trace = mixed.rotate_left(29) ^ (mixed >> 31);
    }

    fn run(&mut self) -> Result<(), String> {
        while let Some(((ns, _), event)) = self.queue.pop_first() {
            if ns > LENGTH_NS {
                break;
            }
            set_now(ns);
            self.happens(event)?;
        }
        if let Some(host) = self.host.take() {
            self.sessions.push(host.end());
        }
        if let Some(client) = self.client.take() {
            self.report.least_own_j = self.report.least_own_j.min(client.least_own_j);
        }
        for session in std::mem::take(&mut self.sessions) {
            let count = check::session(&session)?;
            self.report.recorded += count;
            let lost = session.hashes.len() as u64 - count;
            if session.disk_refused.is_none() {
                self.report.most_lost = self.report.most_lost.max(lost);
            }
            self.trace(count);
        }
        Ok(())
    }

    fn happens(&mut self, event: Event) -> Result<(), String> {
        let now = now_ns();
        match event {
            Event::HostStarts => self.start_host()?,
            Event::ClientStarts => self.start_client()?,
            Event::Goes(number) => self.go_wrong(self.plan.faults[number].1),
            Event::StormEnds => self.weather = self.plan.fair,
            Event::Resumes => {
                if let Some(host) = &mut self.host {
                    host.command(Command::Resume);
                }
            }
            Event::StrangerSends(until_ns, seq) => self.stranger(until_ns, seq),
            // Whoever stands still does it when it goes on.
            Event::Tick(_) | Event::Record(_) | Event::Bus(_) | Event::ToHost(_)
                if now < self.host_stopped_ns =>
            {
                self.at(self.host_stopped_ns, event);
            }
            Event::Bus(_) if now < self.bus_stopped_ns => self.at(self.bus_stopped_ns, event),
            Event::Record(_) if now < self.disk_stalled_ns => self.at(self.disk_stalled_ns, event),
            Event::Period(_) | Event::ToClient(_) if now < self.client_stopped_ns => {
                self.at(self.client_stopped_ns, event);
            }
            Event::Tick(of) if of == self.hosts => self.tick()?,
            Event::Bus(of) if of == self.hosts => self.bus(),
            Event::Record(of) if of == self.hosts => {
                if let Some(host) = &mut self.host {
                    host.record();
                    let every_ns = SteppedRecorder::TURN.as_nanos() as u64;
                    self.at(now + every_ns, event);
                }
            }
            Event::Period(of) if of == self.clients => self.period()?,
            Event::ToHost(packet) => self.host_gets(packet),
            Event::ToClient(force) => {
                if let Some(client) = &mut self.client {
                    client.hear(force);
                }
            }
            Event::Tick(_) | Event::Bus(_) | Event::Record(_) | Event::Period(_) => {}
        }
        Ok(())
    }

    fn start_host(&mut self) -> Result<(), String> {
        if self.host.is_some() {
            return Ok(());
        }
        self.hosts += 1;
        self.report.daemons += 1;
        let file = self.folder.join(format!("session-{}.mcap", self.hosts));
        let host = Host::start(&self.loaded, &self.scene, &file)?;
        let (of, now) = (self.hosts, now_ns());
        self.at(host.due_ns(), Event::Tick(of));
        self.at(now + self.plan.phases_ns[1], Event::Bus(of));
        self.at(now + self.plan.phases_ns[2], Event::Record(of));
        self.host = Some(host);
        // Its client notices, and says again what its device can do.
        let takes_ns = self.random.below(20 * MS as usize) as u64;
        self.at(
            now + takes_ns,
            Event::ToHost(Packet::Describes(self.clients)),
        );
        Ok(())
    }

    fn start_client(&mut self) -> Result<(), String> {
        if self.client.is_some() {
            return Ok(());
        }
        self.clients += 1;
        let client = Client::start(self.plan, &self.snapshot, self.clients as u8)?;
        let (of, now) = (self.clients, now_ns());
        self.at(client.due_ns() + self.plan.phases_ns[0], Event::Period(of));
        self.client = Some(client);
        let takes_ns = self.random.below(20 * MS as usize) as u64;
        self.at(now + takes_ns, Event::ToHost(Packet::Describes(of)));
        Ok(())
    }

    fn tick(&mut self) -> Result<(), String> {
        let Some(host) = &mut self.host else {
            return Ok(());
        };
        let hash = host.tick()?;
        let due_ns = host.due_ns();
        self.report.ticks += 1;
        self.trace(hash);
        // The system wakes it a little late, now and then very late.
        let late_ns = match self.random.below(200) {
            0 => self.random.below(3_000_000) as u64,
            _ => self.random.below(50_000) as u64,
        };
        self.at(due_ns + late_ns, Event::Tick(self.hosts));
        // The bus is woken by the force.
        if now_ns() >= self.bus_stopped_ns {
            self.bus_turn();
        }
        Ok(())
    }

    fn bus(&mut self) {
        self.bus_turn();
        self.at(now_ns() + MS, Event::Bus(self.hosts));
    }

    fn bus_turn(&mut self) {
        let wall_ns = self.wall_ns + now_ns();
        if let Some(force) = self.host.as_mut().and_then(Host::bus) {
            let force = ToolForce {
                t_server_ns: wall_ns,
                ..force
            };
            self.trace(force.force[0].to_bits() ^ force.tick);
            for ns in self.arrivals(1) {
                self.at(ns, Event::ToClient(force));
            }
        }
    }

    fn period(&mut self) -> Result<(), String> {
        let of = self.clients;
        let Some(client) = &mut self.client else {
            return Ok(());
        };
        let (pose, applied_n) = client.period()?;
        let (due_ns, sender) = (client.due_ns(), client.sender);
        let force_n = applied_n.iter().map(|f| f * f).sum::<f64>().sqrt();
        self.report.peak_force_n = self.report.peak_force_n.max(force_n);
        self.report.periods += 1;
        self.trace(applied_n[0].to_bits() ^ pose.position[0].to_bits().rotate_left(17));
        for ns in self.arrivals(0) {
            self.at(ns, Event::ToHost(Packet::Pose(pose, sender)));
        }
        let due_ns = due_ns + self.plan.phases_ns[0];
        let late_ns = self.random.below(50_000) as u64;
        self.at(due_ns.max(now_ns()) + late_ns, Event::Period(of));
        Ok(())
    }

    /// When a packet that is sent now arrives: never, once, or twice. `way`: 0 to the daemon.
    fn arrivals(&mut self, way: usize) -> Vec<u64> {
        let weather = self.weather;
        let [lost, again, a, b] = [(); 4].map(|()| self.random.unit());
        if now_ns() < self.cut_until_ns || lost < weather.loss {
            self.report.packets[0] += 1;
            return Vec::new();
        }
        let takes = |share: f64| weather.delay_ns + (share * weather.jitter_ns as f64) as u64;
        let mut arrivals = vec![now_ns() + 10_000 + takes(a)];
        if again < weather.duplicate {
            self.report.packets[1] += 1;
            arrivals.push(now_ns() + 10_000 + takes(b));
        }
        if weather.in_order {
            for ns in &mut arrivals {
                *ns = (*ns).max(self.last_arrival_ns[way]);
                self.last_arrival_ns[way] = *ns;
            }
        }
        arrivals
    }

    fn host_gets(&mut self, packet: Packet) {
        // What must not be lost is sent again until it arrives.
        if now_ns() < self.cut_until_ns && !matches!(packet, Packet::Pose(..)) {
            return self.at(self.cut_until_ns, Event::ToHost(packet));
        }
        let Some(host) = &mut self.host else {
            return;
        };
        match packet {
            Packet::Pose(pose, sender) => host.pose(&pose, sender),
            Packet::Describes(of) if of == self.clients && self.client.is_some() => {
                host.described(&self.plan.model);
            }
            Packet::Describes(_) => {}
            Packet::Gone => host.gone(),
        }
    }

    fn stranger(&mut self, until_ns: u64, seq: u64) {
        let pose = palpate_client::pose_at([
            0.02 + 0.02 * self.random.signed(),
            0.01 * self.random.signed(),
            0.045,
        ]);
        let pose = ToolPose { seq, ..pose };
        let sender = SenderId::of(Some(b"a stranger"));
        for ns in self.arrivals(0) {
            self.at(ns, Event::ToHost(Packet::Pose(pose, sender)));
        }
        if now_ns() < until_ns {
            self.at(now_ns() + MS, Event::StrangerSends(until_ns, seq + 1));
        }
    }

    fn go_wrong(&mut self, fault: Fault) {
        let now = now_ns();
        self.trace(now);
        match fault {
            Fault::Cut(ns) => self.cut_until_ns = self.cut_until_ns.max(now + ns),
            Fault::Storm(ns) => {
                self.weather = self.plan.storm;
                self.at(now + ns, Event::StormEnds);
            }
            Fault::DiskStalls(ns) => self.disk_stalled_ns = self.disk_stalled_ns.max(now + ns),
            Fault::SyncStalls(ns) => {
                if let Some(host) = &self.host {
                    host.health
                        .syncs_at_ns
                        .fetch_max(now + ns, Ordering::Relaxed);
                }
            }
            Fault::DiskIsFull | Fault::DiskFails | Fault::SyncFails => {
                if let Some(host) = &self.host {
                    let health = &host.health;
                    let sick = match fault {
                        Fault::DiskFails => &health.fails,
                        Fault::SyncFails => &health.sync_fails,
                        _ => &health.full,
                    };
                    sick.store(true, Ordering::Relaxed);
                }
            }
            Fault::DaemonKilled(ns) => {
                if let Some(host) = self.host.take() {
                    self.sessions.push(host.kill());
                    self.host_stopped_ns = 0;
                    self.at(now + ns, Event::HostStarts);
                }
            }
            Fault::DaemonStopped(ns) => self.host_stopped_ns = self.host_stopped_ns.max(now + ns),
            Fault::BusStopped(ns) => self.bus_stopped_ns = self.bus_stopped_ns.max(now + ns),
            Fault::ClientKilled(ns) => {
                if let Some(client) = self.client.take() {
                    self.report.least_own_j = self.report.least_own_j.min(client.least_own_j);
                    self.client_stopped_ns = 0;
                    self.at(now + ns, Event::ClientStarts);
                    let takes_ns = 5 * MS + self.random.below(45 * MS as usize) as u64;
                    self.at(now + takes_ns, Event::ToHost(Packet::Gone));
                }
            }
            Fault::ClientStopped(ns) => {
                self.client_stopped_ns = self.client_stopped_ns.max(now + ns);
            }
            Fault::ClockJumps(ns) => self.wall_ns = self.wall_ns.saturating_add_signed(ns),
            Fault::Stranger(ns) => {
                let seq = self.random.word() >> self.random.below(64);
                self.at(now, Event::StrangerSends(now + ns, seq.min(u64::MAX / 2)));
            }
            Fault::HandJumps => {
                if let Some(client) = &mut self.client {
                    client.jumps = true;
                }
            }
            Fault::Paused(ns) => {
                if let Some(host) = &mut self.host {
                    host.command(Command::Pause);
                }
                self.at(now + ns, Event::Resumes);
            }
            Fault::Reset => {
                if let Some(host) = &mut self.host {
                    host.command(Command::Reset);
                }
            }
        }
    }
}
