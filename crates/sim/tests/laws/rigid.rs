//! A ball, a point and a plane on rigid bodies: closed forms.

use crate::common::{Laws as _, World, pose};
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::flags;

const SPHERE: &str = r#"
[[body]]
id = "globe"
surface = { builtin = "sphere", size = 0.05 }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.09, 0.0, 0.0] }
coupling = { stiffness_n_m = 700.0, damping_n_s_m = 0.0 }
device = { force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }
"#;

/// A point 30 mm over an open sheet.
fn point_over_sheet() -> String {
    SPHERE
        .replace("builtin = \"sphere\", size = 0.05", "builtin = \"sheet\"")
        .replace("{ sphere = { radius_m = 0.01 } }", "{ point = {} }")
        .replace("position = [0.09, 0.0, 0.0]", "position = [0.0, 0.0, 0.03]")
}

// On a globe of 50 mm a ball of 10 mm feels K (60 mm − |c|) along c, wherever it is.
#[test]
fn force_is_stiffness_times_depth_along_an_analytic_path() {
    let mut world = World::new(SPHERE);
    let (mut touched, mut worst) = (0, 0.0f64);
    world.at([0.09, 0.0, 0.0]);
    for k in 0..4_000 {
        let t = f64::from(k) * 1e-3;
        // Round the globe over a pole and the seam, in and out by 4 mm.
        let radius = 0.059 + 0.003 * (9.0 * t).cos();
        let (polar, azimuth) = (1.2 * t + 0.3, 1.7 * t);
        let c = [
            radius * polar.sin() * azimuth.cos(),
            radius * polar.sin() * azimuth.sin(),
            radius * polar.cos(),
        ];
        // From the start, outside, to the first place of the path.
        if k == 0 {
            for s in 0..=100 {
                let s = f64::from(s) / 100.0;
                let way = [
                    0.09 * (1.0 - s) + 2.0 * c[0] * s,
                    2.0 * c[1] * s,
                    2.0 * c[2] * s,
                ];
                world.at(way);
            }
            for s in 0..=100 {
                let s = 2.0 - f64::from(s) / 100.0;
                world.at(c.map(|x| x * s));
            }
        }
        let tool = world.at(c).tools[0];
        let depth = 0.06 - radius;
        if depth > 0.0 {
            touched += 1;
            let expected = 700.0 * depth;
            let along: f64 = (0..3).map(|i| tool.force_n[i] * c[i] / radius).sum();
            let error = ((along - expected).powi(2)
                + (tool.force_n.norm_squared() - along * along).max(0.0))
            .sqrt();
            worst = worst.max(error / 700.0 / 0.004);
            assert!(
                error <= 1e-3 * expected + 1e-9,
                "at {k}: force {} for {expected} N along {c:?}",
                tool.force_n
            );
            let reported = tool.contact.expect("force without contact").depth_m;
            assert!(
                (reported - depth).abs() < 1e-9,
                "at {k}: depth {reported} for {depth}"
            );
        } else {
            assert!(
                tool.force_n.norm() < 1e-9,
                "at {k}: {} N at {depth} m",
                tool.force_n
            );
        }
    }
    println!("{touched} ticks in touch, worst error {worst:.1e} of full scale");
    assert!(touched > 1_500);
}

// 120 mm in one tick, past the middle of the globe; and straight through a sheet that has no inside
// at all.
#[test]
fn a_tool_that_jumps_through_the_body_is_held_on_the_side_it_came_from() {
    let mut world = World::new(SPHERE);
    world.at([0.09, 0.0, 0.0]);
    let tool = world.at([-0.03, 0.0, 0.0]).tools[0];
    assert!(
        (tool.proxy_position.x - 0.06).abs() < 1e-9,
        "proxy at {}",
        tool.proxy_position
    );
    assert!(
        (tool.force_n.x - 700.0 * 0.09).abs() < 1e-6,
        "{}",
        tool.force_n
    );

    let sheet = point_over_sheet();
    for side in [1.0, -1.0] {
        let mut world = World::new(&sheet);
        world.at([0.0, 0.0, 0.03 * side]);
        let tool = world.at([0.001, 0.0, -0.03 * side]).tools[0];
        assert!(
            (tool.force_n.z - 700.0 * 0.03 * side).abs() < 1e-6,
            "from side {side}: {}",
            tool.force_n
        );
    }
}

// A point that comes down on a sheet from anywhere near is never let through, however its last step
// rounds.
#[test]
fn a_point_that_comes_to_lie_on_a_sheet_stays_on_its_side() {
    let sheet = point_over_sheet();
    for side in [1.0, -1.0] {
        let mut world = World::new(&sheet);
        world.at([0.0, 0.0, 0.03 * side]);
        for k in 1..2_000 {
            let (x, height) = (1e-5 * f64::from(k % 97), 1e-7 * f64::from(1 + k * k % 613));
            world.at([x, 0.0, height * side]);
            let tool = world.at([x, 0.0, -1.37 * height * side]).tools[0];
            let expected = 700.0 * 1.37 * height * side;
            assert!(
                (tool.force_n.z - expected).abs() < 1e-6 * expected.abs(),
                "{k}: {} for {expected}",
                tool.force_n.z
            );
        }
    }
}

#[test]
fn a_point_and_a_plane_meet_the_globe_at_their_depths() {
    let point = SPHERE.replace("{ sphere = { radius_m = 0.01 } }", "{ point = {} }");
    let mut world = World::new(&point);
    world.at([0.09, 0.0, 0.0]);
    let tool = world.at([0.048, 0.0, 0.0]).tools[0];
    assert!(
        (tool.force_n.x - 700.0 * 0.002).abs() < 1e-9,
        "{}",
        tool.force_n
    );

    // The half-space above the globe's top, pressed down by 1.5 mm.
    let plane = SPHERE
        .replace(
            "{ sphere = { radius_m = 0.01 } }",
            "{ plane = { normal = [0.0, 0.0, -1.0] } }",
        )
        .replace("position = [0.09, 0.0, 0.0]", "position = [0.0, 0.0, 0.07]");
    let mut world = World::new(&plane);
    world.at([0.0, 0.0, 0.07]);
    let tool = world.at([0.0, 0.0, 0.0485]).tools[0];
    assert!(
        (tool.force_n.z - 700.0 * 0.0015).abs() < 1e-9,
        "{}",
        tool.force_n
    );
    assert!(tool.force_n.x.abs() + tool.force_n.y.abs() < 1e-9);
}

#[test]
fn stale_and_jumping_poses_fade_the_force_to_zero_without_a_step() {
    let text = SPHERE.replace(
        "force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0",
        "force_max_n = 50.0, ramp_s = 0.02, speed_max_m_s = 1.0",
    );
    let mut world = World::new(&text);
    for k in 0..200 {
        world.at([0.09 - 0.0316 * f64::from(k.min(100)) / 100.0, 0.0, 0.0]);
    }
    let mut before = world.at([0.0584, 0.0, 0.0]).tools[0].force_n.norm();
    assert!((before - 700.0 * 0.0016).abs() < 1e-9, "{before} N");
    let step_max = 50.0 / 20.0;
    let mut silent = 0;
    while before > 0.0 {
        let now = world.silent().tools[0].force_n.norm();
        assert!(
            before - now <= step_max + 1e-12,
            "a step from {before} to {now} N"
        );
        before = now;
        silent += 1;
        assert!(silent < 200, "the force of a stale tool stays");
    }
    assert!(
        silent > 50,
        "it faded after {silent} ticks, before the pose was stale"
    );

    // A pose 10 cm away is refused at first, then taken as a new place.
    let mut world = World::new(&text);
    for k in 0..200 {
        world.at([0.09 - 0.0316 * f64::from(k.min(100)) / 100.0, 0.0, 0.0]);
    }
    let out = world.at([0.0, 0.0, -0.09]);
    assert_ne!(out.tools[0].flags & flags::REFUSED, 0);
    let mut moved = 0;
    while world.state.tools[0].link.pose.position.z > -0.08 {
        world.at([0.0, 0.0, -0.09]);
        moved += 1;
        assert!(moved < 100);
    }
    assert_eq!(world.at([0.0, 0.0, -0.09]).tools[0].force_n.norm(), 0.0);
}

// A client in lockstep sends its next pose when the number of the last one comes back.
#[test]
fn every_pose_is_answered_by_its_number_also_a_refused_one() {
    let mut world = World::new(
        "[[body]]\nid = \"ball\"\nsurface = { builtin = \"sphere\" }\n\
         [[tool]]\nid = \"pen\"\nshape = { point = {} }\npose = { position = [0.0, 0.0, 0.1] }\n",
    );
    let mut refusals = 0;
    for k in 1..=400 {
        // It jumps by 20 cm at once, where 5 mm are plausible, and stays.
        let x = if k > 200 { 0.2 } else { 0.0 };
        let sent = DevicePose {
            t_client_ns: 1_000 * k,
            ..pose(0, [x, 0.0, 0.1])
        };
        let tool = world.posed(sent).tools[0];
        assert_eq!(
            (tool.pose_seq, tool.t_client_ns),
            (k, 1_000 * k),
            "tick {k}"
        );
        let refused = tool.flags & flags::REFUSED != 0;
        refusals += u32::from(refused);
        // A refused pose moves nothing.
        let used = world.state.tools[0].link.pose;
        assert_eq!(
            used.seq == k,
            !refused,
            "tick {k}: pose {} is in use",
            used.seq
        );
        if refused {
            let silent = world.silent().tools[0];
            assert_eq!(
                silent.pose_seq, used.seq,
                "the pose in use, where there is no new one"
            );
        }
    }
    assert!(refusals > 0, "no pose was refused");
    assert_eq!(
        world.state.tools[0].link.pose.seq, 400,
        "the new place was never taken"
    );
}
