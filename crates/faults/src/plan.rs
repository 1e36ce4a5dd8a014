//! What a seed decides: a scene, a hand, a network, and what goes wrong when.

use palpate_client::device::{DeviceModel, Hand, Kind};
use palpate_geometry::math::Random;

/// Virtual time of a simulation, ns.
pub(super) const LENGTH_NS: u64 = 1_200_000_000;
/// Faults begin after this, ns: the hand has reached the body.
const CALM_NS: u64 = 150_000_000;
const MS: u64 = 1_000_000;

/// What goes wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The network loses all, both ways, for so long, ns.
    Cut(u64),
    /// It is worse than it was for so long, ns.
    Storm(u64),
    /// The disk takes no bytes for so long, ns: who writes stands still.
    DiskStalls(u64),
    /// No sync comes to an end for so long, ns.
    SyncStalls(u64),
    /// One sync fails.
    SyncFails,
    /// The disk takes part of what is written, and no more from then on.
    DiskIsFull,
    /// One write fails.
    DiskFails,
    /// The daemon is killed, and started again after so long, ns.
    DaemonKilled(u64),
    /// The daemon stands still for so long, ns: stopped, or the machine slept.
    DaemonStopped(u64),
    /// Its thread for the bus stands still for so long, ns.
    BusStopped(u64),
    /// The client is killed, and started again after so long, ns.
    ClientKilled(u64),
    /// The client reads and sends nothing for so long, ns.
    ClientStopped(u64),
    /// The daemon's wall clock jumps by so many ns.
    ClockJumps(i64),
    /// Another client sends poses for the same tool for so long, ns.
    Stranger(u64),
    /// The client's hand is somewhere else from one pose to the next.
    HandJumps,
    /// Someone commands a pause, and to go on after so long, ns.
    Paused(u64),
    /// Someone commands a reset.
    Reset,
}

/// One way of the network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Weather {
    pub delay_ns: u64,
    pub jitter_ns: u64,
    pub loss: f64,
    pub duplicate: f64,
    /// Packets keep their order.
    pub in_order: bool,
}

/// A simulation before it runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What decides all of it.
    pub seed: u64,
    /// Index into [`SCENES`].
    pub(super) scene: usize,
    pub(super) model: DeviceModel,
    pub(super) hand: Hand,
    pub(super) motion: Kind,
    pub(super) depth_m: f64,
    /// The client controls its device's port.
    pub(super) passivity: bool,
    /// Phases of client, bus and recorder within their periods, ns.
    pub(super) phases_ns: [u64; 3],
    pub(super) fair: Weather,
    pub(super) storm: Weather,
    /// With their times, ns.
    pub faults: Vec<(u64, Fault)>,
}

/// Scenes small enough for thousands of seeds: one that does not give way, one that does, one with
/// friction, grip and a port that is kept passive.
pub(super) const SCENES: [&str; 3] = [
    r#"
name = "faults-rigid"
[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [8, 8] }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
coupling = { stiffness_n_m = 600.0, damping_n_s_m = 0.5 }
device = { force_max_n = 6.0 }
[record]
keyframe_s = 0.2
"#,
    r#"
name = "faults-soft"
[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [8, 8] }
model = "lattice"
lattice = { layers = 2, refine = "none" }
fixed = [{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }]
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
coupling = { stiffness_n_m = 800.0, damping_n_s_m = 0.5 }
device = { force_max_n = 8.0 }
[record]
keyframe_s = 0.2
"#,
    r#"
name = "faults-grip"
[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [8, 8] }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
coupling = { stiffness_n_m = 900.0, damping_n_s_m = 0.5 }
friction = { mu = 0.4, viscous_n_s_m = 0.2 }
device = { force_max_n = 5.0, passivity = true }
grip = { force_max_n = 0.5 }
[record]
keyframe_s = 0.1
"#,
];

impl Plan {
    /// Of a seed.
    pub fn of(seed: u64) -> Self {
        let mut random = Random(seed ^ 0x7061_6c70_6174_6521);
        let models = ["ideal", "touch", "touch-x", "falcon"];
        let model = DeviceModel::preset(models[random.below(models.len())]);
        let hands = [Hand::light(), Hand::relaxed(), Hand::firm()];
        let motions = [
            Kind::Press,
            Kind::Slide,
            Kind::Tap,
            Kind::Circle,
            Kind::Pull,
        ];
        let mut weather = |worse: bool| {
            let most = if worse { 40 * MS } else { 3 * MS };
            Weather {
                delay_ns: random.below(most as usize) as u64,
                jitter_ns: random.below(most as usize) as u64,
                loss: random.unit() * if worse { 0.6 } else { 0.05 },
                duplicate: random.unit() * if worse { 0.2 } else { 0.02 },
                in_order: random.unit() < 0.5,
            }
        };
        let (fair, storm) = (weather(false), weather(true));
        let count = 1 + random.below(6);
        let mut faults: Vec<(u64, Fault)> = (0..count)
            .map(|_| {
                let span = (LENGTH_NS - CALM_NS) as f64;
                let at_ns = CALM_NS + (random.unit() * span) as u64;
                (at_ns, fault(&mut random))
            })
            .collect();
        faults.sort_by_key(|(at_ns, _)| *at_ns);
        Self {
            seed,
            // The soft one costs ten times as much.
            scene: [0, 0, 2, 2, 1][random.below(5)],
            model: model.unwrap_or_else(|error| unreachable!("a preset: {error}")),
            hand: hands[random.below(hands.len())].clone(),
            motion: motions[random.below(motions.len())],
            depth_m: random.float(0.001, 0.02),
            passivity: random.unit() < 0.5,
            phases_ns: [(); 3].map(|()| random.below(1_000_000) as u64),
            fair,
            storm,
            faults,
        }
    }
}

fn fault(random: &mut Random) -> Fault {
    let mut long = |most_ms: usize| (1 + random.below(most_ms)) as u64 * MS;
    let (short, medium, wide) = (long(60), long(300), long(700));
    match random.below(17) {
        0 => Fault::Cut(medium),
        1 => Fault::Storm(wide),
        2 => Fault::DiskStalls(wide),
        3 => Fault::DiskIsFull,
        4 => Fault::DiskFails,
        5 => Fault::DaemonKilled(medium),
        6 => Fault::DaemonStopped(medium),
        7 => Fault::BusStopped(wide),
        8 => Fault::ClientKilled(medium),
        9 => Fault::ClientStopped(medium),
        10 => Fault::ClockJumps((random.signed() * 1e13) as i64),
        11 => Fault::Stranger(wide),
        12 => Fault::HandJumps,
        13 => Fault::Paused(medium),
        14 => Fault::SyncStalls(20 * wide),
        15 => Fault::SyncFails,
        _ => match random.below(3) {
            0 => Fault::Reset,
            1 => Fault::DaemonStopped(short),
            _ => Fault::Cut(short),
        },
    }
}
