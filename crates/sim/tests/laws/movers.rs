//! Rigid bodies that move: contact sees their velocity, friction counts relative to them, and a
//! replay finds them where they were.

use crate::common::{Laws as _, World, pose};
use palpate_geometry::math::{Point3, Rotation, SavedState, Vector3, rotation_by, state_hash};
use palpate_sim::tick::record::{Command, TickInput};
use palpate_sim::tick::{apply, restore, step};

fn plate(motion: &str, friction: &str) -> World {
    World::new(&format!(
        "[[body]]\nid = \"plate\"\nsurface = {{ builtin = \"sheet\", size = 0.2 }}\n{motion}\n\
         [[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = 0.01 }} }}\npose = {{ position = [0.0, 0.0, 0.02] }}\n\
         coupling = {{ stiffness_n_m = 800.0, damping_n_s_m = 0.0 }}\n{friction}\n"
    ))
}

// 20 mm/s upwards, then 30 mm/s to the side, against the same way of the tool against a plate at
// rest: only what is relative counts. Without a script's smoothing, so that both are known in closed
// form.
#[test]
fn a_plate_that_comes_is_felt_as_a_tool_that_goes() {
    let way = "motion = { interpolation = \"linear\", waypoint = [ { time_s = 0.0, position = [0.0, 0.0, 0.0] }, \
               { time_s = 0.7, position = [0.0, 0.0, 0.014] }, { time_s = 1.0, position = [0.009, 0.0, 0.014] } ] }";
    for friction in ["", "friction = { mu = 0.3 }"] {
        let (mut comes, mut goes) = (plate(way, friction), plate("", friction));
        let mut farthest: f64 = 0.0;
        let mut last = Vector3::zeros();
        for k in 1..=1_000 {
            let t = f64::from(k) * 1e-3;
            let up = 0.02 * t.min(0.7);
            let aside = 0.03 * (t - 0.7).max(0.0);
            let felt = comes.at([0.0, 0.0, 0.02]).tools[0].force_n;
            let known = goes.at([-aside, 0.0, 0.02 - up]).tools[0].force_n;
            farthest = farthest.max((felt - known).norm());
            last = felt;
        }
        assert!(farthest < 1e-9, "{friction}: differs by {farthest} N");
        // 4 mm into a spring of 800 N/m; the plate went 9 mm aside, which is more than the cone holds.
        assert!((last.z - 3.2).abs() < 1e-9, "{last}");
        let dragged = if friction.is_empty() { 0.0 } else { 0.3 * 3.2 };
        assert!((last.x - dragged).abs() < 1e-6, "{friction}: {last}");
    }
}

// A soft block lies on a plate that is turned and shaken: it goes along, and its base presses on the
// plate with its weight and inertia.
#[test]
fn a_block_is_carried_up_by_its_plate() {
    let mut world = World::new(
        "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n[[body]]\nid = \"plate\"\n\
         surface = { builtin = \"sheet\", size = 0.2 }\n\
         motion = { waypoint = [ { time_s = 0.5, position = [0.0, 0.0, 0.0] }, { time_s = 1.0, position = [0.0, 0.0, 0.05] } ] }\n\
         [[body]]\nid = \"ball\"\nsurface = { builtin = \"sphere\", size = 0.02 }\npose = { position = [0.0, 0.0, 0.0201] }\n\
         model = \"continuum\"\nmaterial = { young_pa = 50e3, damping_s = 5e-3 }\nlattice = { layers = 2, refine = [10, 8] }\n\
         [[contact]]\npair = [\"ball\", \"plate\"]\nfriction = { mu = 0.5 }\n",
    );
    let mut input = TickInput::for_tools(0);
    input.poses.reset(0);
    let mass = world.scene.deformable(1).unwrap().mass_kg();
    let mut lowest = f64::INFINITY;
    for k in 0..1_600 {
        step(&world.scene, &mut world.state, &mut world.scratch, &input);
        let plate = world
            .state
            .carried_point(&world.scene, 0, &Point3::origin())
            .z;
        let mut surface = world.scene.rest_surface(1).unwrap().clone();
        world
            .state
            .copy_net(&world.scene, 1, surface.net_mut().points_mut());
        let (low, _, _) = (0..200).fold((f64::INFINITY, 0.0, 0.0), |best, i| {
            let v = f64::from(i) / 199.0;
            let z = surface.point(0.3, v).z;
            if z < best.0 { (z, 0.3, v) } else { best }
        });
        lowest = lowest.min(low - plate);
        if k == 1_599 {
            let weight = world.scratch.contact_force_on(1).z;
            assert!((weight / (mass * 9.81) - 1.0).abs() < 0.02, "{weight} N");
            assert!((plate - 0.05).abs() < 1e-15 && low > 0.0499, "{low}");
        }
    }
    assert!(lowest > -1e-4, "the plate goes {lowest} m into the ball");
}

#[test]
fn a_carried_body_follows_its_device_and_replays_to_the_bit() {
    let text = "[[body]]\nid = \"plate\"\nsurface = { builtin = \"sheet\", size = 0.2 }\npose = { position = [0.0, 0.0, 0.1] }\ncarried_by = \"hand\"\n\
                [[body]]\nid = \"other\"\nsurface = { builtin = \"sheet\" }\npose = { position = [0.0, 0.0, 0.3] }\nmotion = {}\n\
                [[tool]]\nid = \"hand\"\nshape = { point = {} }\n[[tool]]\nid = \"ball\"\nshape = { sphere = { radius_m = 0.01 } }\npose = { position = [0.0, 0.0, 0.13] }\n";
    let turn = |k: u32| rotation_by(&Vector3::new(0.0, 5e-4 * f64::from(k), 0.0));
    let place = |k: u32| [2e-5 * f64::from(k), 0.0, 6e-5 * f64::from(k)];
    let input = |k: u32| {
        let mut input = TickInput::for_tools(2);
        input.poses.reset(2);
        let mut hand = pose(u64::from(k) + 1, place(k));
        hand.orientation = turn(k);
        input.poses[0] = Some(hand);
        input.poses[1] = Some(pose(u64::from(k) + 1, [0.0, 0.0, 0.125]));
        input
    };
    let run = |world: &mut World, ticks: std::ops::Range<u32>| -> Vec<u64> {
        ticks
            .map(|k| {
                if k == 150 {
                    let send = Command::Send {
                        body: 1,
                        position: Point3::new(0.0, 0.1, 0.2),
                        rotation: turn(1_000),
                        ticks: 100,
                    };
                    apply(&world.scene, &mut world.state, &mut world.scratch, send);
                }
                step(
                    &world.scene,
                    &mut world.state,
                    &mut world.scratch,
                    &input(k),
                )
                .state_hash
            })
            .collect()
    };
    let mut whole = World::new(text);
    let hashes = run(&mut whole, 0..400);
    let rest = Point3::new(0.05, 0.02, 0.1);
    let carried = whole.state.carried_point(&whole.scene, 0, &rest);
    let expected = Point3::from(place(399)) + turn(399) * rest.coords;
    assert!((carried - expected).norm() < 1e-12, "{carried} {expected}");
    let sent = whole
        .state
        .carried_point(&whole.scene, 1, &Point3::new(0.0, 0.0, 0.3));
    assert_eq!(sent, Point3::new(0.0, 0.1, 0.2));
    // Stopped in the middle of the way of a command, saved, and gone on with elsewhere.
    let mut half = World::new(text);
    run(&mut half, 0..200);
    let mut saved = SavedState::default();
    saved.save_from(&half.state);
    let mut other = World::new(text);
    run(&mut other, 0..37);
    restore(&other.scene, &mut other.state, &mut other.scratch, &saved).unwrap();
    assert_eq!(state_hash(&other.state), hashes[199]);
    assert_eq!(run(&mut other, 200..400), hashes[200..]);
    // A reset takes all of them back to the start, a pause leaves them where they are.
    apply(
        &other.scene,
        &mut other.state,
        &mut other.scratch,
        Command::Pause,
    );
    let before = other.state.carried_point(&other.scene, 0, &rest);
    run(&mut other, 0..5);
    assert_eq!(other.state.carried_point(&other.scene, 0, &rest), before);
    apply(
        &other.scene,
        &mut other.state,
        &mut other.scratch,
        Command::Reset,
    );
    assert_eq!(other.state.carried_point(&other.scene, 0, &rest), rest);
}

// A device that appears a metre away does not tear the body there in a tick.
#[test]
fn a_carried_body_comes_no_faster_than_bodies_go() {
    let mut world = World::new(
        "[[body]]\nid = \"plate\"\nsurface = { builtin = \"sheet\" }\ncarried_by = \"hand\"\n[[tool]]\nid = \"hand\"\nshape = { point = {} }\ndevice = { speed_max_m_s = 1e6 }\n",
    );
    let mut before = 0.0;
    for k in 0..200 {
        world.at([0.0, 0.0, 1.0]);
        let z = world
            .state
            .carried_point(&world.scene, 0, &Point3::origin())
            .z;
        assert!(z - before < 0.0101, "tick {k}: {} m", z - before);
        before = z;
    }
    assert_eq!(before, 1.0);
    assert_eq!(
        Rotation::identity(),
        world.state.bodies[0].rigid.unwrap().rotation
    );
}
