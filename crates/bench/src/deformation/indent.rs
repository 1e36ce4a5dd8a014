//! Pressing a body with a ball that a rigid hand holds.

use super::refit::Refit;
use super::scenes::{BoxCase, TeardropCase};
use super::world::World;
use super::{BOX_REFERENCE_N, Effort, Row, TEARDROP_REFERENCE_N};
use crate::Times;
use crate::processes::{Files, Process, Servo, connect, free_port};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::{ClosestSolver, Surface};
use std::time::{Duration, Instant};

impl World {
    /// Force on the tool held there until it is at rest.
    fn settle(&mut self, position: [f64; 3], effort: Effort) -> Held {
        let dt_s = self.scene.dt_s;
        settled(dt_s, effort, || self.at(position).tools[0].force_n.z)
    }

    /// A row of its ticks, without an error.
    pub(super) fn row(&self, case: &str, method: &str, note: String) -> Row {
        let row = Row::new("deformation", case, method).saying(note);
        row.timed(Times::of(self.ticks_s.clone()))
    }

    fn counts(&self) -> String {
        let body = self.scene.deformable(0);
        body.map_or(String::new(), |body| {
            let energy = self.state.bodies[0].deformable.as_ref().map_or(0.0, |state| body.energy_j(state));
            let (_, passes) = body.integration();
            let (energy_mj, work_mj, free) = (energy * 1e3, self.work_j * 1e3, body.unknown_count());
            format!("{energy_mj:.4} of {work_mj:.4} mJ stored, {free} free coordinates, {passes} passes a step")
        })
    }
}

/// A force that is held.
#[derive(Clone, Copy, Default)]
pub(super) struct Held {
    /// Mean over the last 0.1 s, N.
    pub force_n: f64,
    /// Greatest less least in that time, N.
    ripple_n: f64,
}

/// The force of a tick, held until its mean over 0.1 s changes by less than 1e-5 from one to the
/// next, or for two seconds; quick: 1e-4, or one second.
pub(super) fn settled(dt_s: f64, effort: Effort, mut tick: impl FnMut() -> f64) -> Held {
    let (bursts, share) = if effort == Effort::Quick {
        (10, 1e-4)
    } else {
        (20, 1e-5)
    };
    let ticks = (0.1 / dt_s).ceil().max(1.0) as usize;
    let mut held = Held::default();
    for _ in 0..bursts {
        let (mut sum, mut least, mut most) = (0.0, f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..ticks {
            let force = tick();
            (sum, least, most) = (sum + force, force.min(least), force.max(most));
        }
        let before = std::mem::replace(
            &mut held,
            Held {
                force_n: sum / ticks as f64,
                ripple_n: most - least,
            },
        );
        if (held.force_n - before.force_n).abs() <= share * held.force_n.abs() {
            break;
        }
    }
    held
}

/// A row that says why there is none.
pub(super) fn failed(case: &str, why: &str) -> Row {
    Row::new("deformation", case, "none").saying(why)
}

/// 10 mm in 0.1 s, then held.
pub(super) fn box_row(case: &BoxCase, effort: Effort) -> Row {
    let method = format!("{} {}", case.model, case.method);
    let mut world = match World::new(&case.text()) {
        Ok(world) => world,
        Err(why) => {
            return Row {
                method,
                ..failed(&case.group, &why)
            };
        }
    };
    let ticks = (0.1 / case.dt_s).round() as usize;
    for k in 0..=ticks {
        world.at([0.0, 0.0, 0.03 - 0.01 * k as f64 / ticks as f64]);
    }
    let Held {
        force_n: force,
        ripple_n,
    } = world.settle([0.0, 0.0, 0.02], effort);
    let base = world
        .scene
        .deformable(0)
        .zip(world.state.bodies[0].deformable.as_ref());
    let base = base.map_or(0.0, |(body, state)| body.base_reaction_n(state).z.abs());
    let error = force / case.scale / BOX_REFERENCE_N - 1.0;
    let [unscaled, ripple, base] = [force, ripple_n, base].map(|force_n| force_n / case.scale);
    let note = format!(
        "F/scale {unscaled:.4} N, ripple {ripple:.4} N, base {base:.4} N, {}",
        world.counts()
    );
    let row = world.row(&case.group, &method, note);
    row.off_by(error, "of the force")
}

/// The method of the whole loop, from a pose that a client sends to the force that it receives.
pub(super) const WHOLE_LOOP: &str = "continuum implicit, from pose to force over Zenoh";

/// The box in a daemon in real time, pressed by a client of 1 kHz.
pub(super) fn loop_row(case: &BoxCase, effort: Effort) -> Row {
    let measure = || -> anyhow::Result<Row> {
        let files = Files::new("loop")?;
        let scene = files.write("box.toml", &case.text())?;
        let endpoint = format!("tcp/127.0.0.1:{}", free_port()?);
        let _daemon = Process::start(&["serve", &scene, "--listen", &endpoint])?;
        let palpate = connect(&endpoint)?;
        let servo = Servo {
            every: Duration::from_millis(1),
            first: 1_500,
            count: if effort == Effort::Quick {
                1_000
            } else {
                10_000
            },
        };
        let place = |k: usize| [0.0, 0.0, 0.035 - 1e-5 * k.min(1_500) as f64];
        let (times_s, force_n) = servo.run(palpate.tool("ball")?, place)?;
        palpate.close();
        let row = Row::new("deformation", &case.group, WHOLE_LOOP).timed(Times::of(times_s));
        Ok(row.off_by(force_n / case.scale / BOX_REFERENCE_N - 1.0, "of the force"))
    };
    measure().unwrap_or_else(|error| failed(&case.group, &format!("{error:#}")))
}

/// x of the ball's centre at first touch, coming along -x at the height and side of the table.
pub(super) fn first_touch(surface: &Surface) -> f64 {
    let mut solver = ClosestSolver::new(surface);
    let (mut low, mut high) = (0.02, 0.06);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let gap = solver
            .closest(surface, &Point3::new(middle, 0.003, 0.045))
            .signed_distance
            - 0.01;
        *if gap > 0.0 { &mut high } else { &mut low } = middle;
    }
    high
}

/// Forces at rest at 1 ... 4 mm beyond `touch`, reached slowly; `tick` is one of 1 ms at x and
/// gives the force.
fn slowly(touch: f64, effort: Effort, mut tick: impl FnMut(f64) -> f64) -> [f64; 4] {
    let mut x = touch + 1e-3;
    [1.0, 2.0, 3.0, 4.0].map(|millimetres| {
        let goal = touch - 1e-3 * millimetres;
        while x > goal {
            x = (x - 4e-5).max(goal);
            tick(x);
        }
        settled(1e-3, effort, || tick(x)).force_n
    })
}

/// The largest deviation from 2 mm on, with its sign, and all of them in words.
fn deviations(forces: &[f64; 4]) -> (f64, String) {
    let each: Vec<f64> = forces
        .iter()
        .zip(TEARDROP_REFERENCE_N)
        .map(|(f, reference)| f / reference - 1.0)
        .collect();
    let error = each[1..].iter().copied().fold(
        0.0,
        |worst: f64, d| if d.abs() > worst.abs() { d } else { worst },
    );
    let listed: Vec<String> = forces
        .iter()
        .zip(&each)
        .map(|(f, d)| format!("{f:.4} ({:+.1} %)", d * 100.0))
        .collect();
    (error, format!("{} N", listed.join(" ")))
}

/// Forces at rest at 1 ... 4 mm, reached slowly.
pub(super) fn teardrop_row(case: &TeardropCase, effort: Effort) -> Row {
    let mut world = match World::new(&case.text(1_000)) {
        Ok(world) => world,
        Err(why) => {
            return Row {
                method: case.method.clone(),
                ..failed(&case.name, &why)
            };
        }
    };
    let touch = first_touch(world.scene.rest_surface(0).expect("a surface"));
    let forces = slowly(touch, effort, |x| {
        world.at([x, 0.003, 0.045]).tools[0].force_n.x
    });
    let (error, listed) = deviations(&forces);
    let note = format!("{listed}, {}", world.counts());
    let row = world.row(&case.name, &case.method, note);
    row.off_by(error, "of the force")
}

/// The same by the seed's coupling, or with contact at free nodes.
pub(super) fn refit_row(case: &str, net: Option<[usize; 2]>, effort: Effort) -> Row {
    let method = net.map_or("free nodes".to_owned(), |_| "refit".to_owned());
    let mut refit = match Refit::new(12, net) {
        Ok(refit) => refit,
        Err(why) => {
            return Row {
                method,
                ..failed(case, &why)
            };
        }
    };
    let touch = first_touch(&refit.surface);
    let (mut times, mut work_j, mut last) = (Vec::new(), 0.0, touch + 1e-3);
    let forces = slowly(touch, effort, |x| {
        let start = Instant::now();
        let force = refit.step(&Point3::new(x, 0.003, 0.045)).x;
        times.push(start.elapsed().as_secs_f64());
        work_j -= force * (x - last);
        last = x;
        force
    });
    let (error, listed) = deviations(&forces);
    let (energy_j, free) = (
        refit.body.energy_j(&refit.state),
        refit.body.unknown_count(),
    );
    let note = format!(
        "{listed}, {:.4} of {:.4} mJ stored, {free} free coordinates",
        energy_j * 1e3,
        work_j * 1e3
    );
    let row = Row::new("deformation", case, method).timed(Times::of(times));
    row.off_by(error, "of the force").saying(note)
}

/// Whole ticks of the main scene while the ball presses, slides and leaves.
pub(super) fn tick_row(case: &str, model: &'static str, effort: Effort) -> Row {
    let shape = match model {
        "net" => TeardropCase::new(case, "net", "[12, 13]", 2),
        _ => TeardropCase::new(case, model, "[20, 21]", 4),
    };
    ticks_of(case, model, &shape.text(1_000), effort)
}

/// The method of rows without wide instructions.
const BASELINE: &str = "without AVX2 and F16C";

/// Ticks of the scene that people meet first.
pub(super) fn default_tick_row(case: &str, effort: Effort) -> Row {
    let text = include_str!("../../../../scenes/teardrop.toml");
    ticks_of(case, "default", text, effort)
}

/// The same in a process of this program that is held to the instructions of every x86-64 processor.
pub(super) fn baseline_tick_row(case: &str) -> Option<Row> {
    let program = std::env::current_exe().ok()?;
    // Tests are another program, and that process has no such process.
    if program.file_stem()? != "palpate-bench" || std::env::var_os("PALPATE_SIMD").is_some() {
        return None;
    }
    let mut command = std::process::Command::new(program);
    command.args(["deformation", "--quick", "--json", "--only", case]);
    let output = command.env("PALPATE_SIMD", "baseline").output().ok()?;
    let printed = String::from_utf8(output.stdout).ok()?;
    let row = printed.lines().find_map(|line| {
        let row: serde_json::Value = serde_json::from_str(line).ok()?;
        let times = Times {
            median_s: row["median_s"].as_f64()?,
            p99_s: row["p99_s"].as_f64()?,
            n: row["n"].as_u64()? as usize,
        };
        let note = row["note"].as_str()?;
        Some(
            Row::new("deformation", case, BASELINE)
                .timed(times)
                .saying(note),
        )
    });
    Some(row.unwrap_or_else(|| failed(case, "the process without AVX2 printed no times")))
}

/// Pressed 0 to 3 mm deep and slid over.
fn ticks_of(case: &str, model: &'static str, text: &str, effort: Effort) -> Row {
    let mut world = match World::new(text) {
        Ok(world) => world,
        Err(why) => return failed(case, &why),
    };
    let touch = first_touch(world.scene.rest_surface(0).expect("a surface"));
    let ticks = if effort == Effort::Quick { 500 } else { 5_000 };
    for k in 0..ticks {
        let t = k as f64 * 1e-3;
        let depth = 1.5e-3 + 1.5e-3 * libm::sin(std::f64::consts::TAU * 0.5 * t);
        let along = 0.045 + 5e-3 * libm::sin(std::f64::consts::TAU * 0.3 * t);
        world.at([touch - depth, 0.003, along]);
    }
    let note = world.counts();
    world.row(case, model, note)
}
