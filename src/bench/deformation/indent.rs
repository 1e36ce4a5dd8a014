//! Pressing a body with a ball that a rigid hand holds.

use super::scenes::{BoxCase, TeardropCase};
use super::{BOX_REFERENCE_N, Effort, Row, TEARDROP_REFERENCE_N};
use crate::haptics::DevicePose;
use crate::math::{Point3, Rotation, Vector3};
use crate::scene::{Scene, SceneState, Scratch, file};
use crate::surface::ClosestSolver;
use crate::tick::record::{TickInput, TickOutput};
use crate::tick::step;
use std::path::Path;
use std::time::Instant;

/// A scene that runs.
pub(super) struct World {
    pub scene: Scene,
    pub state: SceneState,
    pub scratch: Scratch,
    seq: u64,
    /// Time of each tick so far, s.
    pub ticks_s: Vec<f64>,
}

impl World {
    pub(super) fn new(text: &str) -> Result<Self, String> {
        let loaded = file::parse(text, "bench.toml", Path::new(".")).map_err(|e| e.to_string())?;
        let scene = Scene::build(&loaded.spec, Path::new(".")).map_err(|e| e.to_string())?;
        let state = scene.initial_state();
        let scratch = scene.scratch(&state);
        Ok(Self { scene, state, scratch, seq: 0, ticks_s: Vec::new() })
    }

    pub(super) fn at(&mut self, position: [f64; 3]) -> TickOutput {
        self.seq += 1;
        let mut input = TickInput::default();
        input.poses[0] = Some(DevicePose {
            seq: self.seq,
            t_client_ns: 0,
            position: Point3::from(position),
            orientation: Rotation::identity(),
            linear_velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            buttons: 0,
        });
        let start = Instant::now();
        let output = step(&self.scene, &mut self.state, &mut self.scratch, &input);
        self.ticks_s.push(start.elapsed().as_secs_f64());
        output
    }

    /// Force on the tool after it has been held until the force settles (to 1e-5, or for two seconds).
    fn settle(&mut self, position: [f64; 3]) -> Vector3 {
        let (dt_s, mut force) = (self.scene.dt_s, Vector3::zeros());
        let burst = (0.1 / dt_s).ceil() as usize;
        for _ in 0..20 {
            let before = force;
            for _ in 0..burst {
                force = self.at(position).tools[0].force_n;
            }
            if (force - before).norm() <= 1e-5 * force.norm() {
                break;
            }
        }
        force
    }

    fn percentiles(&self) -> (f64, f64) {
        let mut times = self.ticks_s.clone();
        times.sort_by(f64::total_cmp);
        let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
        (at(0.5), at(0.99))
    }

    fn row(&self, case: &str, method: &str, error: f64, note: String) -> Row {
        let (median_s, p99_s) = self.percentiles();
        Row {
            suite: "deformation",
            case: case.to_owned(),
            method: method.to_owned(),
            peer: false,
            median_s,
            p99_s,
            error,
            error_unit: "of the force",
            n: self.ticks_s.len(),
            wrong: None,
            note,
        }
    }

    fn counts(&self) -> String {
        let body = self.scene.lattice(0);
        body.map_or(String::new(), |body| {
            let energy = self.state.bodies[0].lattice.as_ref().map_or(0.0, |state| body.energy_j(state));
            let (_, passes) = body.integration();
            let deforming = self.scratch.bodies[0].deforming.as_ref();
            let held = deforming.map_or(0, |deforming| body.limited(&deforming.lattice));
            let held = if held > 0 { format!(", {held} cells held back") } else { String::new() };
            format!("{} free coordinates, {passes} passes a step, {:.4} mJ{held}", body.unknown_count(), energy * 1e3)
        })
    }
}

/// A row that says why there is none.
pub(super) fn failed(case: &str, why: &str) -> Row {
    Row {
        suite: "deformation",
        case: case.to_owned(),
        method: "none".to_owned(),
        peer: false,
        median_s: f64::NAN,
        p99_s: f64::NAN,
        error: f64::NAN,
        error_unit: "of the force",
        n: 0,
        wrong: None,
        note: why.to_owned(),
    }
}

/// 10 mm in 0.1 s, then held.
pub(super) fn box_row(case: &BoxCase) -> Row {
    let mut world = match World::new(&case.text()) {
        Ok(world) => world,
        Err(why) => return failed(&case.name, &why),
    };
    let ticks = (0.1 / case.dt_s).round() as usize;
    for k in 0..=ticks {
        world.at([0.0, 0.0, 0.03 - 0.01 * k as f64 / ticks as f64]);
    }
    let force = world.settle([0.0, 0.0, 0.02]).z;
    let base = world.scene.lattice(0).zip(world.state.bodies[0].lattice.as_ref());
    let base = base.map_or(0.0, |(body, state)| body.base_reaction_n(state).z.abs());
    let error = force / case.scale / BOX_REFERENCE_N - 1.0;
    let note = format!("F/scale {:.4} N, base {:.4} N, {}", force / case.scale, base / case.scale, world.counts());
    let method = format!("{} {}", case.model, case.method);
    world.row(&case.name, &method, error, note)
}

/// x of the ball's centre at first touch, coming along -x at the height and side of the table.
fn first_touch(scene: &Scene) -> f64 {
    let surface = scene.rest_surface(0);
    let mut solver = ClosestSolver::new(surface);
    let (mut low, mut high) = (0.02, 0.06);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        let gap = solver.closest(surface, &Point3::new(middle, 0.003, 0.045)).signed_distance - 0.01;
        *if gap > 0.0 { &mut high } else { &mut low } = middle;
    }
    high
}

/// Forces at rest at 1 ... 4 mm, reached slowly.
pub(super) fn teardrop_row(case: &TeardropCase) -> Row {
    let mut world = match World::new(&case.text(1_000)) {
        Ok(world) => world,
        Err(why) => return failed(&case.name, &why),
    };
    let touch = first_touch(&world.scene);
    let mut x = touch + 1e-3;
    let mut forces = [0.0; 4];
    for (k, force) in forces.iter_mut().enumerate() {
        let goal = touch - 1e-3 * (k + 1) as f64;
        while x > goal {
            x = (x - 4e-5).max(goal);
            world.at([x, 0.003, 0.045]);
        }
        *force = world.settle([x, 0.003, 0.045]).x;
    }
    let deviations: Vec<f64> =
        forces.iter().zip(TEARDROP_REFERENCE_N).map(|(f, reference)| f / reference - 1.0).collect();
    let error =
        deviations[1..].iter().copied().fold(0.0, |worst: f64, d| if d.abs() > worst.abs() { d } else { worst });
    let listed: Vec<String> =
        forces.iter().zip(&deviations).map(|(f, d)| format!("{f:.4} ({:+.1} %)", d * 100.0)).collect();
    let note = format!("{} N, {}", listed.join(" "), world.counts());
    world.row(&case.name, case.model, error, note)
}

/// Whole ticks of the main scene while the ball presses, slides and leaves.
pub(super) fn tick_row(case: &str, model: &'static str, effort: Effort) -> Row {
    let shape = match model {
        "net" => TeardropCase::new(case, "net", "[12, 13]", 2),
        _ => TeardropCase::new(case, "lattice", "[20, 21]", 4),
    };
    let mut world = match World::new(&shape.text(1_000)) {
        Ok(world) => world,
        Err(why) => return failed(case, &why),
    };
    let touch = first_touch(&world.scene);
    let ticks = if effort == Effort::Quick { 500 } else { 5_000 };
    for k in 0..ticks {
        let t = k as f64 * 1e-3;
        let depth = 1.5e-3 + 1.5e-3 * libm::sin(std::f64::consts::TAU * 0.5 * t);
        let along = 0.045 + 5e-3 * libm::sin(std::f64::consts::TAU * 0.3 * t);
        world.at([touch - depth, 0.003, along]);
    }
    let note = world.counts();
    world.row(case, model, f64::NAN, note)
}
