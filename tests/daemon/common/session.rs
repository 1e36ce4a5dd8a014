//! Sessions made in process: scripted poses and commands, recorded as the daemon's loop does.
#![allow(dead_code)]

use crate::common::pose;
pub use crate::scenes::RIGID;
use palpate_drive::journal::Journal;
use palpate_drive::nets::NetPool;
pub use palpate_geometry::math::Random;
use palpate_geometry::math::{Rotation, Vector3, state_hash};
use palpate_record::{Recorder, RecorderSettings, RecordingSummary};
use palpate_sim::haptics::{DeviceBounds, DevicePose};
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::{Command, TickInput, TickRecord};
use palpate_sim::tick::{apply, step};
use std::path::Path;
use std::time::Duration;

/// A slab of 0.1 m × 0.1 m with its underside and an edge fixed, and a ball of 20 mm above it.
pub fn slab(model: &str, lattice: &str, more: &str) -> String {
    format!(
        "[record]\nkeyframe_s = 0.1\n[[body]]\nid = \"slab\"\nsurface = {{ builtin = \"sheet\", net = [7, 7], size = 0.1 }}\n\
         model = \"{model}\"\nlattice = {{ thickness_m = 0.03, {lattice} }}\n\
         fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}, {{ u = [0.0, 0.1], v = [0.0, 1.0] }}]\n{more}\n\
         [[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = 0.02 }} }}\n\
         pose = {{ position = [0.0, 0.0, 0.03] }}\ncoupling = {{ stiffness_n_m = 800.0, damping_n_s_m = 0.0 }}\n"
    )
}

/// Scenes that between them have every kind of state.
pub fn scenes() -> Vec<(&'static str, String)> {
    let plain = "layers = 3, refine = \"none\"";
    let turning = RIGID
        .replace("sphere = { radius_m = 0.01 }", "cylinder = { radius_m = 0.008, half_length_m = 0.02 }")
        .replace("damping_n_s_m = 0.0 }", "damping_n_s_m = 0.5, turning_stiffness_nm_rad = 0.3, turning_damping_nm_s_rad = 1e-4 }\nfriction = { mu = 0.3, viscous_n_s_m = 0.2 }\ndevice = { passivity = true }\ngrip = { force_max_n = 0.3 }");
    let plastic = "material = { plastic = { yield_strain = 0.01, rate_per_s = 20.0, hardening = 0.1, spread_m = 0.03 } }";
    let two = std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/two-drops.toml"),
    )
    .unwrap();
    vec![
        ("rigid", RIGID.to_owned()),
        ("turning with friction and grip", turning),
        (
            "lattice",
            slab("lattice", plain, "integrator = { iterations = 2 }"),
        ),
        ("membrane", slab("membrane", plain, "")),
        ("continuum", slab("continuum", plain, "")),
        ("net", slab("net", "layers = 3, refine = \"none\"", "")),
        (
            "every = 4",
            slab("continuum", plain, "integrator = { every = 4 }"),
        ),
        ("plastic", slab("lattice", plain, plastic)),
        ("two drops", two),
    ]
}

/// What hands and clients do, by seed: every tool is pressed towards the body from where it starts,
/// rubbed, turned, its button pressed; now and then there is no news, or a command.
pub struct Script {
    seed: u64,
    pub ticks: u64,
    commands: Vec<(u64, Command)>,
}

impl Script {
    pub fn new(seed: u64, ticks: u64, commands: bool) -> Self {
        let mut random = Random(seed);
        let mut list = Vec::new();
        let mut at = 10;
        while commands && at + 10 < ticks {
            let bounds = DeviceBounds {
                force_max_n: 1.5,
                torque_max_nm: 0.002,
                stiffness_max_n_m: 400.0,
            };
            let made = match random.below(6) {
                0 => vec![(at, Command::Reset)],
                1 => vec![
                    (at, Command::Pause),
                    (at + 3, Command::Step(4)),
                    (at + 9, Command::Resume),
                ],
                2 => vec![
                    (at, Command::Quality(random.below(4) as u8)),
                    (at + 8, Command::Quality(0)),
                ],
                3 => vec![(at, Command::Device { tool: 0, bounds })],
                4 => vec![
                    (at, Command::Quality(2)),
                    (at, Command::Reset),
                    (at, Command::Quality(0)),
                ],
                _ => vec![(
                    at,
                    Command::Device {
                        tool: 0,
                        bounds: DeviceBounds::default(),
                    },
                )],
            };
            list.extend(made);
            at += 12 + random.below(60) as u64;
        }
        Self {
            seed,
            ticks,
            commands: list,
        }
    }

    pub fn commands_after(&self, tick: u64) -> impl Iterator<Item = Command> {
        self.commands
            .iter()
            .filter(move |(after, _)| *after == tick)
            .map(|(_, command)| *command)
    }

    /// Poses of a tick.
    pub fn input(&self, tick: u64, scene: &Scene) -> TickInput {
        let mut input = TickInput::default();
        let start = scene.initial_state();
        for (t, tool) in start.tools.iter().enumerate() {
            let mut random = Random(self.seed ^ tick << 8 ^ t as u64);
            if random.below(12) == 0 {
                continue;
            }
            let place = tool.proxy;
            // Towards the nearest body: from the side where tools stand beside it, from above where
            // they stand above it.
            let aside = place.z > 0.04;
            let phase =
                std::f64::consts::TAU * (tick as f64 / 160.0 + 0.01 * (self.seed % 7) as f64);
            let press = 0.5 - 0.5 * libm::cos(phase);
            let deep = if aside {
                [-0.034, 0.0, 0.0]
            } else {
                [0.0, 0.0, -0.016]
            };
            let rub = 0.004 * libm::sin(2.3 * phase);
            let tremor = 1e-4 * random.signed();
            let position = [
                place.x + deep[0] * press + if aside { 0.0 } else { rub } + tremor,
                place.y + if aside { rub } else { 0.0 },
                place.z + deep[2] * press,
            ];
            input.poses[t] = Some(DevicePose {
                t_client_ns: tick * 1_000_000,
                orientation: Rotation::from_axis_angle(
                    &Vector3::y_axis(),
                    0.2 * libm::sin(1.7 * phase),
                ),
                linear_velocity: Vector3::new(0.02 * libm::sin(phase), -0.0, 0.0),
                buttons: u32::from(tick % 120 > 70),
                ..pose(tick, position)
            });
        }
        // A loop that is late now and then: longer than a pose is believed, too.
        if tick % 23 == 7 {
            input.skipped = (tick % 71) as u32;
        }
        input
    }
}

/// Records a script.
pub fn record(path: &Path, text: &str, script: &Script) -> RecordingSummary {
    record_lying(path, text, script, |_| {})
}

/// The same; the recorder is told what `lie` makes of each tick.
pub fn record_lying(
    path: &Path,
    text: &str,
    script: &Script,
    lie: impl Fn(&mut TickRecord),
) -> RecordingSummary {
    let loaded = file::parse(text, "test.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    let scene = Scene::build(&loaded.spec, Path::new(".")).unwrap();
    let settings = RecorderSettings::new(&loaded.text, &loaded.spec).to(path);
    let (recorder, mut port) = Recorder::start(settings, &scene).unwrap();
    let mut nets = NetPool::new(&scene, port.nets_held());
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    port.keyframe(&state, state_hash(&state));
    for tick in 0..script.ticks {
        for command in script.commands_after(tick) {
            port.command(tick, command);
            apply(&scene, &mut state, &mut scratch, command);
            if command == Command::Reset {
                port.keyframe(&state, state_hash(&state));
            }
        }
        let input = script.input(tick + 1, &scene);
        let output = step(&scene, &mut state, &mut scratch, &input);
        let mut record = TickRecord {
            input,
            output,
            late_ns: tick % 7,
            shift_ns: -(tick as i64 % 5),
            wait_ns: tick.is_multiple_of(3).then_some(tick),
            stage_ns: [1, 20, 250, 50, 4].into(),
        };
        lie(&mut record);
        nets.begin();
        port.tick(&scene, &state, &record, &mut nets);
        // A disk has a second for a second; a test runs faster than its recorder may write.
        if tick.is_multiple_of(100) {
            std::thread::sleep(Duration::from_millis(10));
        }
    }
    drop(port);
    recorder.finish().last().unwrap()
}
