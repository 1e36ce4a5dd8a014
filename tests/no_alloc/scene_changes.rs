//! Scenes that become others: what goes on, what begins anew, and that a running loop takes it over
//! without allocating.

use crate::common::pose;
use crate::counting::allocations;
use palpate_drive::journal::NoJournal;
use palpate_drive::swap::Swap;
use palpate_geometry::math::Vector3;
use palpate_sim::body::DeformableState;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::spec::FixedSpec;
use palpate_sim::scene::{Origin, Scene, SceneChange, file};
use palpate_sim::tick::record::{TickInput, TickRecord};
use palpate_sim::tick::{CarryOver, SceneState};
use palpate_sim::tick::{step, step_into};
use std::path::Path;
use std::sync::Arc;

const TWO: &str = r#"
[[body]]
id = "a"
surface = { builtin = "sheet", size = 0.1 }
model = "membrane"
lattice = { thickness_m = 2e-3, refine = "auto" }
fixed = [{ point = [-0.049, 0, 0], normal = [1, 0, 0] }]

[[body]]
id = "b"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [0.2, 0.0, 0.0] }

[[body]]
id = "c"
surface = { builtin = "sheet", size = 0.1 }
pose = { position = [0.1, 0.0, 0.0] }
model = "membrane"
lattice = { thickness_m = 2e-3 }
fixed = [{ point = [0.049, 0, 0], normal = [-1, 0, 0] }]

[[tool]]
id = "pen"
shape = { sphere = { radius_m = 5e-3 } }

[[contact]]
pair = ["pen", "b"]
method = "none"

[[contact]]
pair = ["a", "c"]
method = "none"
"#;

fn scene(text: &str) -> Scene {
    let loaded = file::parse(text, "two.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    Scene::build(&loaded.spec, Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

fn rebuilt(change: &SceneChange) -> Scene {
    // Through its text, as a replay does.
    let text = toml::to_string(change.spec()).unwrap();
    Scene::build(&toml::from_str(&text).unwrap(), Path::new("")).unwrap_or_else(|e| panic!("{e}"))
}

fn swap(old: &Scene, next: Arc<Scene>, change: &SceneChange) -> Swap {
    let carry = CarryOver::new(old, &next, change.origins().to_vec());
    let (swap, _nets) = Swap::new(1, next, carry, Box::new(NoJournal)).unwrap();
    swap
}

/// The tool sinks into the first sheet, 10 µm a tick.
fn pressing(seq: u64) -> DevicePose {
    pose(seq, [0.0, 0.0, 8e-3 - 1e-5 * seq as f64])
}

fn input(seq: u64) -> TickInput {
    let mut input = TickInput::default();
    input.poses[0] = Some(pressing(seq));
    input
}

fn press(scene: &Scene, ticks: u64) -> SceneState {
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    for seq in 1..=ticks {
        step(scene, &mut state, &mut scratch, &input(seq));
    }
    state
}

#[test]
fn a_moved_body_takes_its_state_along_and_the_others_stay_bit_for_bit() {
    let old = scene(TWO);
    let by = Vector3::new(0.01, -0.02, 0.03);
    let change = SceneChange::moved(&old, &[(2, by)]).unwrap();
    let new = rebuilt(&change);
    assert!(change.fits(&old, &new));
    let before = press(&old, 600);
    let mut after = new.initial_state();
    new.carry_over(
        &old,
        &before,
        &CarryOver::new(&old, &new, change.origins().to_vec()),
        &mut after,
    );
    assert_eq!(after.tick, 600);
    assert_eq!(after.tools[0].link, before.tools[0].link);
    let lattice = |state: &SceneState, body: usize| state.bodies[body].deformable.clone().unwrap();
    assert_eq!(lattice(&after, 0), lattice(&before, 0));
    assert_eq!(
        old.rest_surface(0),
        new.rest_surface(0),
        "the automatic net of a body that stays is the same"
    );
    for (p, q) in lattice(&before, 2)
        .positions
        .iter()
        .zip(&lattice(&after, 2).positions)
    {
        assert_eq!(p + by, *q);
    }
    for (p, q) in old
        .rest_surface(2)
        .unwrap()
        .net()
        .points()
        .iter()
        .zip(new.rest_surface(2).unwrap().net().points())
    {
        assert!((p + by - q).norm() < 1e-15);
    }
    let newest = before
        .bodies
        .iter()
        .map(|body| body.revision)
        .max()
        .unwrap();
    assert!(after.bodies.iter().all(|body| body.revision > newest));
    assert!(newest > 0, "the tool pressed nothing");
}

#[test]
fn a_merged_body_stands_in_the_place_of_its_first_part() {
    let old = scene(TWO);
    let surface = old.rest_surface(0).unwrap().clone();
    let change = SceneChange::merged(&old, &[0, 2], "a-c", &surface).unwrap();
    let new = rebuilt(&change);
    assert_eq!(
        (0..new.body_count())
            .map(|b| new.body_id(b))
            .collect::<Vec<_>>(),
        ["a-c", "b"]
    );
    assert_eq!(
        *change.origins(),
        [
            Origin::New,
            Origin::Kept {
                from: 1,
                moved: Vector3::zeros()
            }
        ]
    );
    assert_eq!(new.rest_surface(0).unwrap().net(), surface.net());
    // Both planes hold it, each where it was in the world.
    let held: Vec<FixedSpec> = new.spec.bodies[0].fixed.clone();
    assert_eq!(held.len(), 2);
    assert_eq!(
        held[1],
        FixedSpec::Plane {
            point: [0.1 + 0.049, 0.0, 0.0],
            normal: [-1.0, 0.0, 0.0]
        }
    );
    // The exception between the parts is gone, that of another body stays.
    assert_eq!(new.spec.contacts.len(), 1);
    assert_eq!(
        new.spec.contacts[0].pair,
        ["pen".to_owned(), "b".to_owned()]
    );
}

#[test]
fn what_cannot_be_carried_over_is_refused_with_its_place() {
    let old = scene(TWO);
    let surface = old.rest_surface(0).unwrap().clone();
    let refused = |old: &Scene, id: &str| {
        SceneChange::merged(old, &[0, 2], id, &surface)
            .unwrap_err()
            .to_string()
    };
    assert!(
        refused(&old, "b").contains("in use already")
            && refused(&old, "pen").contains("in use already")
    );
    let ranged = TWO.replace(
        "fixed = [{ point = [0.049, 0, 0], normal = [-1, 0, 0] }]",
        "fixed = [{ u = [0.9, 1.0], v = [0.0, 1.0] }]",
    );
    let refused = refused(&scene(&ranged), "a-c");
    assert!(
        refused.contains("body[2].fixed[0]") && refused.contains("plane"),
        "{refused}"
    );
}

/// A loop that changes its scene under a tool: the sheet that the tool presses stays, another
/// moves. The force has no gap, and nothing is allocated between the ticks or in those that follow.
#[test]
fn a_running_loop_takes_the_next_scene_over_without_a_gap_or_an_allocation() {
    let mut scene = Arc::new(scene(TWO));
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    let TickRecord {
        input: mut poses,
        mut output,
        ..
    } = TickRecord::for_tools(1);
    let mut tick = |scene: &Scene,
                    state: &mut SceneState,
                    scratch: &mut palpate_sim::tick::Scratch,
                    seq: u64| {
        poses.poses[0] = Some(pressing(seq));
        step_into(scene, state, scratch, &poses, &mut output);
        (output.tick, output.tools[0].force_n.z)
    };
    let mut force_n = 0.0;
    for seq in 1..=600 {
        (_, force_n) = tick(&scene, &mut state, &mut scratch, seq);
    }
    assert!(force_n > 0.0);
    let change = SceneChange::moved(&scene, &[(2, Vector3::new(0.0, 0.0, -0.05))]).unwrap();
    let next = Arc::new(rebuilt(&change));
    let mut swap = swap(&scene, next, &change);
    let mut jump_n = f64::INFINITY;
    let count = allocations(|| {
        swap.exchange(&mut scene, &mut state, &mut scratch);
        for seq in 601..=700 {
            let (number, now_n) = tick(&scene, &mut state, &mut scratch, seq);
            assert_eq!(number, seq);
            if seq == 601 {
                jump_n = (now_n - force_n).abs();
            }
        }
    });
    assert_eq!(count, 0);
    // A tick presses 10 µm deeper; beyond that the contact solve has lost its start only.
    assert!(
        jump_n < 0.05 * force_n,
        "the force jumped by {jump_n} N from {force_n} N"
    );
    assert_eq!(
        swap.scene().rest_surface(2).unwrap().net().at(0, 0).z,
        0.0,
        "the scene before it comes back"
    );
}

/// A sheet that sags under its weight and steps once in four ticks: whenever the scene changes
/// round it, in the midst of a step as well, it moves as if nothing had happened.
#[test]
fn a_body_that_stays_moves_on_bit_for_bit_also_in_the_midst_of_its_step() {
    const SAGGING: &str = r#"
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
id = "sheet"
surface = { builtin = "sheet", size = 0.1 }
model = "membrane"
lattice = { thickness_m = 2e-3 }
integrator = { every = 4 }
fixed = [{ point = [-0.049, 0, 0], normal = [1, 0, 0] }]
[[body]]
id = "ball"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [0.5, 0.0, 0.0] }
"#;
    let run = |change_after: Option<u64>| {
        let mut scene = Arc::new(scene(SAGGING));
        let mut state = scene.initial_state();
        let mut scratch = scene.scratch(&state);
        for tick in 1..=80 {
            step(&scene, &mut state, &mut scratch, &TickInput::default());
            if change_after == Some(tick) {
                let change =
                    SceneChange::moved(&scene, &[(1, Vector3::new(0.0, 0.1, 0.0))]).unwrap();
                let next = Arc::new(rebuilt(&change));
                let mut swap = swap(&scene, next, &change);
                swap.exchange(&mut scene, &mut state, &mut scratch);
            }
        }
        state.bodies[0].deformable.clone().unwrap()
    };
    let undisturbed = run(None);
    assert!(
        undisturbed.positions.iter().any(|p| p.z < -1e-4),
        "nothing sags"
    );
    for tick in 40..44 {
        assert_eq!(run(Some(tick)), undisturbed, "changed after tick {tick}");
    }
}

/// A body that is in one piece: what it had, it has, to rounding, and goes on with.
#[test]
fn a_piece_that_is_the_whole_body_goes_on_as_it_was() {
    const CLAY: &str = r#"
[[body]]
id = "ball"
surface = { builtin = "sphere", size = 0.02 }
lattice = { layers = 3, refine = "none" }
spin_rad_s = [0.0, 20.0, 5.0]
velocity_m_s = [0.1, 0.0, -0.2]
MODEL
[[tool]]
id = "pen"
shape = { sphere = { radius_m = 0.005 } }
pose = { position = [0.0, 0.0, 0.5] }
"#;
    let plastic = "plastic = { yield_strain = 0.001, rate_per_s = 50.0 }";
    for model in [
        format!("model = \"continuum\"\nmaterial = {{ {plastic} }}"),
        format!("model = \"lattice\"\nmaterial = {{ {plastic} }}"),
        "model = \"net\"".to_owned(),
    ] {
        let mut old = Arc::new(scene(&CLAY.replace("MODEL", &model)));
        let mut state = old.initial_state();
        let mut scratch = old.scratch(&state);
        for _ in 0..100 {
            step(&old, &mut state, &mut scratch, &TickInput::default());
        }
        let before = state.bodies[0].deformable.clone().unwrap();
        let whole = old.rest_surface(0).unwrap().clone();
        let (change, _) = SceneChange::cut(&old, 0, &[&whole], 1.0).unwrap();
        assert_eq!(change.spec().bodies[0].id, "ball-1");
        let new = Arc::new(rebuilt(&change));
        let mut swap = swap(&old, new, &change);
        let count = allocations(|| swap.exchange(&mut old, &mut state, &mut scratch));
        assert_eq!(count, 0);
        let after = state.bodies[0].deformable.as_ref().unwrap();
        let apart = before.positions.iter().zip(&after.positions);
        let farthest = apart.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        // Control points of a net are beside its cells, and go with what is near.
        let within = if model.contains("net") { 1e-4 } else { 1e-12 };
        assert!(farthest < within, "{model}: {farthest:e}");
        let slower = before
            .velocities
            .iter()
            .zip(&after.velocities)
            .map(|(a, b)| (a - b).norm());
        let slower = slower.fold(0.0, f64::max);
        assert!(slower < 1e3 * within, "{model}: {slower:e}");
        let flowed = |state: &DeformableState| state.plastic_strain.as_flattened().to_vec();
        assert_eq!(flowed(&before).len(), flowed(after).len());
        if model.contains("plastic") {
            assert!(
                flowed(&before).iter().any(|strain| *strain > 0.0),
                "{model}: nothing flowed"
            );
        }
        let most = flowed(&before)
            .into_iter()
            .zip(flowed(after))
            .map(|(a, b)| (a - b).abs());
        let most = most.fold(0.0, f64::max);
        assert!(most < 1e-12, "{model}: {most:e}");
    }
}
