//! Steps on other threads that are not done when they are due.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{Point3, SavedState, Vector3, state_hash};
use palpate_sim::body::{DeformableScratch, DeformableState, Field};
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::Command;
use palpate_sim::tick::{Pipeline, apply, late_step, restore};
use std::sync::Arc;

/// A slab of gel that steps every fourth tick, and a ball.
const SLAB: &str = r#"
[[body]]
id = "slab"
surface = { builtin = "sheet", net = [7, 7], size = 0.1 }
model = "lattice"
lattice = { layers = 4, refine = "none", thickness_m = 0.03 }
fixed = [{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }]
integrator = { every = 4 }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.02 } }
pose = { position = [0.0, 0.0, 0.05] }
coupling = { stiffness_n_m = inf, damping_n_s_m = 0.0 }
device = { force_max_n = 1e9, ramp_s = 0.0 }
"#;

/// A worker that is done with a step when it has been asked for so many times as `late` says of it.
#[derive(Debug)]
struct Slow {
    scene: Arc<Scene>,
    state: DeformableState,
    scratch: DeformableScratch,
    begun: usize,
    asked: usize,
    under_way: bool,
    late: fn(usize) -> usize,
}

impl Slow {
    fn new(scene: &Arc<Scene>, late: fn(usize) -> usize) -> Self {
        let body = scene.deformable(0).unwrap();
        Self {
            scene: scene.clone(),
            state: body.rest_state(),
            scratch: body.scratch(),
            begun: 0,
            asked: 0,
            under_way: false,
            late,
        }
    }
}

impl Pipeline for Slow {
    fn start(
        &mut self,
        body: usize,
        field: Field,
        state: &DeformableState,
        predicted: &[Point3],
        loads: &[Vector3],
    ) {
        let model = self.scene.deformable(body).unwrap();
        assert!(!self.under_way, "one step at a time");
        self.state.clone_from(state);
        self.scratch.predicted.copy_from_slice(predicted);
        model.set_field(&mut self.scratch, field);
        model.give_loads(&mut self.scratch, loads);
        model.renew(&self.state, &mut self.scratch);
        model.advance(&mut self.state, &mut self.scratch);
        model.predict(&self.state, &mut self.scratch);
        (self.begun, self.asked, self.under_way) = (self.begun + 1, 0, true);
    }

    fn is_ready(&mut self, _: usize) -> bool {
        if !self.under_way {
            return true;
        }
        self.asked += 1;
        self.asked > (self.late)(self.begun)
    }

    fn finish(&mut self, _: usize, state: &mut DeformableState, predicted: &mut [Point3]) -> bool {
        if !self.under_way {
            return false;
        }
        assert!(self.asked > (self.late)(self.begun), "the tick waits");
        self.under_way = false;
        state.clone_from(&self.state);
        predicted.copy_from_slice(&self.scratch.predicted);
        true
    }

    fn cancel(&mut self) {
        self.under_way = false;
    }
}

/// Presses, drags and lets go.
fn place(k: u32) -> [f64; 3] {
    let t = f64::from(k) * 1e-3;
    let deep = 0.009 * (t / 0.4).min(1.0) * (3.0 - 2.5 * t).clamp(0.0, 1.0);
    [0.001 * libm::sin(10.0 * t), 0.0, 0.025 - deep]
}

const TICKS: u32 = 1_400;

/// The ticks with a worker that is late as often as `late` says: commands by the tick before which they
/// acted, hashes, and forces.
fn live(late: fn(usize) -> usize) -> (Vec<(u32, Command)>, Vec<u64>, Vec<f64>) {
    let mut world = World::new(SLAB);
    let scene = Arc::new(World::new(SLAB).scene);
    world
        .scratch
        .set_pipeline(Box::new(Slow::new(&scene, late)));
    let (mut commands, mut hashes, mut forces) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..TICKS {
        while let Some(body) = late_step(&world.scene, &world.state, &mut world.scratch) {
            let command = Command::PutOff { body };
            commands.push((k, command));
            apply(&world.scene, &mut world.state, &mut world.scratch, command);
        }
        let output = world.at_in_place(place(k));
        assert!(output.fault.is_none());
        forces.push(output.tools[0].force_n.norm());
        hashes.push(state_hash(&world.state));
    }
    (commands, hashes, forces)
}

#[test]
fn late_steps_are_put_off_and_a_replay_has_the_same_bits() {
    // One in three is late by up to nine ticks.
    let (commands, hashes, _) = live(|step| [0, 3, 0, 0, 9, 0][step % 6]);
    println!("{} ticks put off", commands.len());
    assert!(commands.len() > 100);
    // Without a worker, from the start and from the middle of a step that was put off.
    let mut world = World::new(SLAB);
    let mut saved = SavedState::default();
    let middle = commands.iter().find(|(k, _)| *k > 600).unwrap().0;
    for from in [0, middle + 1] {
        if from > 0 {
            restore(&world.scene, &mut world.state, &mut world.scratch, &saved).unwrap();
            world.seq = u64::from(from);
        }
        for k in from..TICKS {
            for (_, command) in commands.iter().filter(|(at, _)| *at == k) {
                apply(&world.scene, &mut world.state, &mut world.scratch, *command);
            }
            world.at_in_place(place(k));
            assert_eq!(state_hash(&world.state), hashes[k as usize], "tick {k}");
            if k == middle {
                saved.save_from(&world.state);
            }
        }
    }
}

#[test]
fn a_worker_that_is_never_late_changes_no_bit() {
    let (commands, hashes, _) = live(|_| 0);
    assert!(commands.is_empty());
    let mut world = World::new(SLAB);
    for k in 0..TICKS {
        world.at_in_place(place(k));
        assert_eq!(state_hash(&world.state), hashes[k as usize], "tick {k}");
    }
}

#[test]
fn forces_go_on_smoothly_while_every_step_is_late() {
    let jump = |forces: &[f64]| {
        let steps = forces.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        steps.fold(0.0, f64::max)
    };
    let (_, _, in_time) = live(|_| 0);
    let (commands, _, late) = live(|_| 8);
    let most = in_time.iter().copied().fold(0.0, f64::max);
    println!(
        "peak {most} N in time; largest change in a tick {} N, late {} N; {} ticks put off",
        jump(&in_time),
        jump(&late),
        commands.len()
    );
    assert!(commands.len() > 800, "two ticks in three");
    assert!(late.iter().all(|force| force.is_finite()));
    // The ball goes on for three times as many ticks between steps, against the compliance of one.
    assert!(jump(&late) < 5.0 * jump(&in_time));
    // A quarter of the peak: the ball comes down by 9 mm in 0.4 s, and three times four ticks of that against the
    // compliance of one.
    assert!(jump(&late) < 0.25 * most);
}

#[test]
fn only_bodies_that_step_apart_can_be_put_off() {
    let text = SLAB.replace("every = 4", "every = 1");
    let (mut plain, mut reported) = (World::new(&text), World::new(&text));
    for k in 0..50 {
        for body in [0, 7] {
            let command = Command::PutOff { body };
            apply(
                &reported.scene,
                &mut reported.state,
                &mut reported.scratch,
                command,
            );
        }
        plain.at_in_place(place(k));
        reported.at_in_place(place(k));
        assert_eq!(state_hash(&plain.state), state_hash(&reported.state));
    }
}
