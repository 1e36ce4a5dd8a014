//! Coulomb friction in the loop: its threshold, its direction, and that what sticks stays.

use crate::common::{Laws as _, World, teardrop};
use palpate_geometry::math::{SavedState, Vector3};
use palpate_sim::solve::rows::Holder;
use palpate_sim::tick::restore;

const BALL: &str = r#"
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.0, 0.0, 0.03] }
coupling = { stiffness_n_m = 1000.0, damping_n_s_m = 0.0 }
device = { force_max_n = 1e6, ramp_s = 0.0, speed_max_m_s = 1e6 }
"#;

fn sheet(mu: f64) -> String {
    let body = "[[body]]\nid = \"floor\"\nsurface = { builtin = \"sheet\", size = 0.2 }\n";
    format!("{body}{}friction = {{ mu = {mu:?} }}\n", BALL.trim_start())
}

/// A soft drop, small enough for long tests, fixed at its tip; the ball comes along −x.
fn soft(mu: f64) -> String {
    let text = teardrop(20e3, "\"none\"").replace("layers = 4", "layers = 2");
    format!(
        "{}friction = {{ mu = {mu:?} }}\n",
        text.replace("stiffness_n_m = inf", "stiffness_n_m = 1000.0")
    )
}

fn across(v: &Vector3) -> f64 {
    (v.x * v.x + v.y * v.y).sqrt()
}

// Pressed 2 mm into a rigid plane and dragged: the coupling pulls back with K times the way until
// that is μ times the pressure, then with just so much, against the way.
#[test]
fn a_ball_on_a_plane_sticks_to_its_threshold_and_slips_at_it() {
    for mu in [0.1, 0.3, 1.0, 10.0] {
        let mut world = World::new(&sheet(mu));
        world.at([0.0, 0.0, 0.03]);
        world.at([0.0, 0.0, 0.0101]);
        world.at([0.0, 0.0, 0.008]);
        let (direction, threshold) = ([0.8, -0.6], mu * 0.002);
        let mut slipped_at = None;
        for k in 0..400 {
            let way = threshold * f64::from(k) / 200.0;
            let tool = world
                .at([direction[0] * way, direction[1] * way, 0.008])
                .tools[0];
            let drag = across(&tool.force_n);
            assert!(
                (tool.force_n.z - 2.0).abs() < 1e-9,
                "μ {mu}, {way} m: pressed with {} N",
                tool.force_n.z
            );
            assert!(
                (drag - (1000.0 * way).min(2.0 * mu)).abs() < 1e-9 * mu,
                "μ {mu}, {way} m: {drag} N"
            );
            if k > 0 {
                let against =
                    -(tool.force_n.x * direction[0] + tool.force_n.y * direction[1]) / drag;
                assert!(
                    (against - 1.0).abs() < 1e-9,
                    "μ {mu}: dragged along {}",
                    tool.force_n
                );
            }
            if slipped_at.is_none() && across(&tool.proxy_position.coords) > 1e-12 {
                slipped_at = Some(way);
            }
        }
        let slipped_at = slipped_at.expect("it never slips");
        assert!(
            (slipped_at / threshold - 1.0).abs() < 0.01,
            "μ {mu}: slips at {slipped_at} m, not {threshold}"
        );
    }
}

// Each row has the directions of its own law: who rubs beside it is nothing to a smooth tool, and the other way round.
#[test]
fn a_tool_that_rubs_and_a_smooth_one_beside_it_feel_what_they_feel_alone() {
    let other = BALL
        .replace("\"ball\"", "\"pen\"")
        .replace("[0.0,", "[0.05,");
    let floor = "[[body]]\nid = \"floor\"\nsurface = { builtin = \"sheet\", size = 0.2 }\n";
    let mut both = World::new(&format!("{}{other}", sheet(0.4)));
    let mut rubbing = World::new(&sheet(0.4));
    let mut smooth = World::new(&format!("{floor}{other}"));
    for k in 0..300 {
        let (x, z) = (1e-5 * f64::from(k), (0.03 - 2e-4 * f64::from(k)).max(0.008));
        let (first, second) = ([x, 0.5 * x, z], [0.05 + x, 0.5 * x, z]);
        let together = both.all(&[(first, 0), (second, 0)]).tools;
        let alone = [rubbing.at(first).tools[0], smooth.at(second).tools[0]];
        for (together, alone) in together.as_slice().iter().zip(&alone) {
            // Alone, one sweep settles a row; two rows are gone over more often.
            let off_n = (together.force_n - alone.force_n).norm();
            let off_nm = (together.torque_nm - alone.torque_nm).norm();
            assert!(off_n < 1e-12 && off_nm < 1e-14, "tick {k}: {off_n} N");
        }
    }
}

#[test]
fn kinetic_friction_holds_less_and_static_friction_comes_back() {
    let text = sheet(0.5).replace("mu = 0.5", "mu = 0.5, mu_kinetic = 0.3");
    let mut world = World::new(&text);
    for z in [0.03, 0.0101, 0.008] {
        world.at([0.0, 0.0, z]);
    }
    let mut drag = |x: f64| -world.at([x, 0.0, 0.008]).tools[0].force_n.x;
    assert!(
        (drag(0.000_99) - 0.99).abs() < 1e-9,
        "it sticks to 0.5 × 2 N"
    );
    drag(0.0012);
    let sliding = drag(0.0014);
    assert!((sliding - 0.6).abs() < 1e-9, "0.3 × 2 N: {sliding}");
    // Back a little: it sticks where it is, and then again up to 0.5 × 2 N.
    assert!((drag(0.0012) - 0.4).abs() < 1e-9);
    assert!((drag(0.001_79) - 0.99).abs() < 1e-9);
    assert!((drag(0.001_79) - 0.99).abs() < 1e-9);
}

// On a globe with a damper in the coupling, the device deep in it and to the side, trembling at 8
// Hz below the threshold.
#[test]
fn what_sticks_on_a_rigid_globe_for_a_minute_stays_within_a_nanometre() {
    let text = sheet(0.8)
        .replace(
            "builtin = \"sheet\", size = 0.2",
            "builtin = \"sphere\", size = 0.05",
        )
        .replace("damping_n_s_m = 0.0", "damping_n_s_m = 2.0")
        .replace("[0.0, 0.0, 0.03]", "[0.0, 0.0, 0.09]");
    let mut world = World::new(&text);
    let off = Vector3::new(0.01, 0.02, 0.055).normalize();
    let side = off.cross(&Vector3::x()).normalize();
    world.at((off * 0.07).into());
    world.at((off * 0.0601).into());
    let place = |k: u32| {
        let tremor = 0.0004 * libm::sin(std::f64::consts::TAU * 8.0 * f64::from(k) * 1e-3);
        (off * (0.057 + tremor) + side * (0.0012 + tremor)).into()
    };
    for k in 0..1_000 {
        world.at(place(k));
    }
    let start = world.at(place(0)).tools[0].proxy_position;
    let mut drift = 0.0f64;
    for k in 0..60_000 {
        let tool = world.at(place(k)).tools[0];
        drift = drift.max((tool.proxy_position - start).norm());
        assert!(tool.force_n.dot(&off) > 1.0);
    }
    assert!(drift < 1e-9, "drifted by {drift} m");
}

// The same held back by the device's limit: what it cannot bear moves nothing either.
#[test]
fn what_sticks_beyond_the_force_limit_stays_as_well() {
    let text = sheet(0.8).replace("force_max_n = 1e6", "force_max_n = 1.0");
    let globe = text
        .replace(
            "builtin = \"sheet\", size = 0.2",
            "builtin = \"sphere\", size = 0.05",
        )
        .replace("[0.0, 0.0, 0.03]", "[0.0, 0.0, 0.09]");
    for text in [text, globe] {
        let mut world = World::new(&text);
        let top = if text.contains("sphere\",") {
            0.05
        } else {
            0.0
        };
        for z in [0.03, 0.0101, 0.006] {
            world.at([0.0, 0.0, top + z]);
        }
        let start = world.at([0.0025, 0.0, top + 0.006]).tools[0].proxy_position;
        for _ in 0..10_000 {
            let tool = world.at([0.0025, 0.0, top + 0.006]).tools[0];
            assert!((tool.force_n.norm() - 1.0).abs() < 1e-12);
            let drift = (tool.proxy_position - start).norm();
            assert!(drift < 1e-9, "drifted by {drift} m");
        }
    }
}

/// Presses the soft drop by 4 mm at 45 % of its length and then drags the device upwards.
fn press_and_drag(world: &mut World, up_m: f64) {
    for k in 0..=500 {
        let s = f64::from(k.min(400)) / 400.0;
        world.at([0.06 - 0.0362 * s, 0.003, 0.045]);
    }
    for k in 0..=600 {
        let s = f64::from(k.min(400)) / 400.0;
        world.at([0.0238, 0.003, 0.045 + up_m * s]);
    }
}

#[test]
fn what_sticks_on_a_soft_body_for_a_minute_stays_within_a_nanometre() {
    let mut world = World::new(&soft(0.6));
    press_and_drag(&mut world, 0.002);
    let hold = [0.0238, 0.003, 0.047];
    // The body itself comes to rest first.
    for _ in 0..20_000 {
        world.at(hold);
    }
    let start = world.at(hold).tools[0];
    assert!(
        start.force_n.x > 0.05 && start.force_n.z < -0.01,
        "it drags: {}",
        start.force_n
    );
    let (mut drift, mut change) = (0.0f64, 0.0f64);
    for _ in 0..60_000 {
        let tool = world.at(hold).tools[0];
        drift = drift.max((tool.proxy_position - start.proxy_position).norm());
        change = change.max((tool.force_n - start.force_n).norm());
    }
    assert!(drift < 1e-9, "drifted by {drift} m");
    assert!(change < 1e-6, "the force changed by {change} N");
}

// A hand that trembles must not walk: the proxy comes back each period to where it was.
#[test]
fn a_trembling_tool_on_a_soft_body_does_not_walk() {
    let mut world = World::new(&soft(0.8));
    press_and_drag(&mut world, 0.0005);
    let place = |k: u32| {
        let tremor = libm::sin(std::f64::consts::TAU * 8.0 * f64::from(k) * 1e-3);
        [0.0238 + 0.0002 * tremor, 0.003, 0.0455 + 0.0002 * tremor]
    };
    for k in 0..4_000 {
        world.at(place(k));
    }
    let start = world.at(place(0)).tools[0].proxy_position;
    let mut drift = 0.0;
    for period in 0..100 {
        for k in 1..=125 {
            let tool = world.at(place(125 * period + k)).tools[0];
            drift = (tool.proxy_position - start).norm();
        }
    }
    assert!(drift < 1e-7, "walked {drift} m in 100 periods");
}

#[test]
fn a_coefficient_of_zero_is_no_friction_to_the_bit() {
    for with in [sheet(0.0), soft(0.0)] {
        let without = with.replace("friction = { mu = 0.0 }\n", "");
        assert_ne!(with, without);
        let (mut a, mut b) = (World::new(&with), World::new(&without));
        let mut touched = 0;
        for start in [[0.05, 0.003, 0.045], [0.042, 0.003, 0.045]] {
            assert_eq!(a.at(start), b.at(start));
        }
        for k in 0..3_000 {
            let t = f64::from(k) * 1e-3;
            let place = if with.contains("drop") {
                [
                    0.03 + 0.006 * libm::cos(6.0 * t),
                    0.003,
                    0.045 + 0.005 * libm::sin(9.0 * t),
                ]
            } else {
                [
                    0.01 * libm::sin(9.0 * t),
                    0.0,
                    0.012 + 0.006 * libm::cos(6.0 * t),
                ]
            };
            let (one, two) = (a.at(place), b.at(place));
            assert_eq!(one, two);
            touched += usize::from(one.tools[0].contact.is_some());
        }
        assert!(touched > 500);
    }
}

// To and fro at 1 m/s for 10 s. Forces stay in the cone, press as the depth says, and drag against
// the way.
#[test]
fn a_slide_at_a_metre_a_second_keeps_the_cone_on_a_rigid_plane() {
    for mu in [0.0, 0.3, 1.0, 10.0] {
        let mut world = World::new(&sheet(mu));
        for z in [0.03, 0.0101, 0.009] {
            world.at([0.0, 0.0, z]);
        }
        let mut slid = 0;
        for k in 0..10_000 {
            // A triangle of 0.16 m.
            let phase = f64::from(k % 320) * 1e-3;
            let (x, forward) = if phase < 0.16 {
                (phase - 0.08, 1.0)
            } else {
                (0.24 - phase, -1.0)
            };
            let tool = world.at([x, 0.0, 0.009]).tools[0];
            assert!(
                (tool.force_n.z - 1.0).abs() < 1e-9,
                "μ {mu}, tick {k}: pressed with {} N",
                tool.force_n.z
            );
            assert!(
                across(&tool.force_n) <= mu * (1.0 + 1e-9) + 1e-12,
                "μ {mu}, tick {k}: {}",
                tool.force_n
            );
            // Turned round, the coupling's own way of 2 μ mm comes first.
            if k > 400 && phase % 0.16 > 0.002 + 0.002 * mu {
                assert!(
                    (tool.force_n.x * forward + mu).abs() < 1e-9 * mu.max(1.0),
                    "tick {k}: {}",
                    tool.force_n
                );
                slid += 1;
            }
        }
        assert!(slid > 7_000, "μ {mu}: {slid} ticks of sliding");
    }
}

#[test]
fn a_slide_at_a_metre_a_second_over_a_soft_body_stays_calm() {
    // Strokes take 60 ms, near the body's own period: each throws it off the ball, with less damping
    // (2 ms, and what sticks) farther each time, and it comes back for about half of each.
    for mu in [0.0, 0.3, 1.0, 10.0] {
        let mut world = World::new(
            &soft(mu).replace("young_pa = 20000.0", "young_pa = 20000.0, damping_s = 5e-3"),
        );
        world.at([0.06, 0.003, 0.045]);
        for x in [0.05, 0.042, 0.034, 0.028] {
            world.at([x, 0.003, 0.045]);
        }
        let (mut most_energy, mut most_force, mut pressed, mut in_cone) = (0.0f64, 0.0f64, 0, 0);
        for k in 0..12_000 {
            let phase = f64::from(k % 60) * 1e-3;
            let up = if phase < 0.03 {
                phase - 0.015
            } else {
                0.045 - phase
            };
            let out = world.at([0.0248, 0.003, 0.045 + up]);
            let tool = &out.tools[0];
            assert!(tool.force_n.iter().all(|x| x.is_finite()) && out.fault.is_none());
            let deformable = world.state.bodies[0].deformable.as_ref().unwrap();
            most_energy = most_energy.max(world.scene.deformable(0).unwrap().energy_j(deformable));
            most_force = most_force.max(tool.force_n.norm());
            pressed += usize::from(tool.force_n.x > 0.02);
            for contact in out.contacts.list() {
                let along = contact.force_n.dot(&contact.normal);
                let drag = (contact.force_n - contact.normal * along).norm();
                assert!(
                    along >= 0.0 && drag <= mu * along * (1.0 + 1e-9) + 1e-12,
                    "μ {mu}, tick {k}"
                );
                in_cone += 1;
            }
        }
        // What the coupling would hold if it were stretched by all of the stroke.
        assert!(
            most_energy < 0.5 * 1000.0 * 0.03 * 0.03,
            "μ {mu}: {most_energy} J in the body"
        );
        // And where it sticks at one end, by half of the stroke.
        assert!(most_force < 1000.0 * 0.015, "μ {mu}: {most_force} N");
        assert!(
            pressed > 5_000 && in_cone > 5_000,
            "μ {mu}: pressed in {pressed} ticks"
        );
        println!("μ {mu}: {most_energy} J, {most_force} N, pressed {pressed}");
    }
}

#[test]
fn at_rest_the_base_bears_what_the_hand_feels() {
    // Fine enough that no fixed control point has a weight at the contact.
    let mut world = World::new(&soft(0.6).replace("\"none\"", "[16, 17]"));
    press_and_drag(&mut world, 0.002);
    let mut force = Vector3::zeros();
    for _ in 0..6_000 {
        force = world.at([0.0238, 0.003, 0.047]).tools[0].force_n;
    }
    let deformable = world.state.bodies[0].deformable.as_ref().unwrap();
    let reaction = world
        .scene
        .deformable(0)
        .unwrap()
        .base_reaction_n(deformable);
    assert!(force.z < -0.02, "nothing drags: {force}");
    // Springs pull on the base as the hand is pushed back on.
    let off = (reaction + force).norm().min((reaction - force).norm());
    assert!(
        off < 1e-6 * force.norm(),
        "{reaction} at the base for {force}"
    );
}

// Two balls squeeze a soft drop that nothing else holds, lift it against its weight, and turn it
// about the vertical.
#[test]
fn two_tools_squeeze_and_lift_a_soft_body() {
    for young_pa in [56e3, 60e3, 72e3] {
        squeeze_and_lift(young_pa);
    }
}

fn squeeze_and_lift(young_pa: f64) {
    let text = soft(0.8)
        .replace("20000.0", &format!("{young_pa:?}"))
        .replace(
            "fixed = [{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }]\n",
            "",
        );
    let second = text[text.find("[[tool]]").unwrap()..]
        .replace("\"ball\"", "\"other\"")
        .replace("[0.06,", "[-0.06,");
    let floor = "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n";
    let mut world = World::new(&format!("{floor}{text}{second}"));
    let mass = world.scene.deformable(0).unwrap().mass_kg();
    let places = |distance: f64, z: f64, turn: f64| {
        let (c, s) = (libm::cos(turn), libm::sin(turn));
        [
            ([distance * c, distance * s, z], 0),
            ([-distance * c, -distance * s, z], 0),
        ]
    };
    // The body falls until it is held: quickly, then, but not like a hammer that drives it out.
    for k in 1..=10 {
        let distance = 0.03 + (0.0218 - 0.03) * f64::from(k) / 10.0;
        world.all(&places(distance, 0.045, 0.0));
    }
    let middle = |world: &World| {
        let positions = &world.state.bodies[0].deformable.as_ref().unwrap().positions;
        positions
            .iter()
            .fold(Vector3::zeros(), |sum, p| sum + p.coords)
            / positions.len() as f64
    };
    for _ in 0..2_000 {
        world.all(&places(0.0218, 0.045, 0.0));
    }
    let low = middle(&world);
    for k in 0..3_000 {
        let s = f64::from(k) / 3_000.0;
        world.all(&places(0.0218, 0.045 + 0.05 * s, 1.0 * s));
    }
    world.rest(
        |world| _ = world.all_in_place(&places(0.0218, 0.095, 1.0)),
        3_000,
    );
    let output = world.record.output.clone();
    let lifted = middle(&world).z - low.z;
    let weight = output.tools[0].force_n.z + output.tools[1].force_n.z;
    // Balls that do not turn roll on the body while they carry it round, by their radius times the
    // angle.
    assert!((lifted - 0.05).abs() < 3e-3, "lifted by {lifted} m");
    assert!(
        (weight + 9.81 * mass).abs() < 1e-3 * 9.81 * mass,
        "{weight} N for {mass} kg"
    );
}

#[test]
fn two_bodies_rub_on_each_other() {
    let base = include_str!("../../../../scenes/two-drops.toml");
    let drag = |mu: f64| {
        let text = format!(
            "{base}\n[[contact]]\npair = [\"left\", \"right\"]\nfriction = {{ mu = {mu:?} }}\n"
        );
        let mut world = World::new(&text);
        for _ in 0..5 {
            world.at([0.06, 0.003, 0.045]);
        }
        let (mut most, mut met) = (0.0f64, 0);
        for k in 0..1_500 {
            let t = f64::from(k.min(1_000)) * 1e-3;
            let out = world.at([0.045 - 0.03 * t, 0.003, 0.045 + 0.008 * t]);
            for contact in out
                .contacts
                .list()
                .iter()
                .filter(|c| matches!(c.holder, Holder::Body(_)))
            {
                let along = contact.force_n.dot(&contact.normal);
                let across = (contact.force_n - contact.normal * along).norm();
                assert!(along >= 0.0 && across <= mu * along * (1.0 + 1e-9) + 1e-12);
                most = most.max(across);
                met += 1;
            }
        }
        assert!(met > 100, "they met {met} times");
        most
    };
    assert!(drag(0.0) < 1e-12);
    assert!(drag(0.5) > 1e-3);
}

#[test]
fn a_world_restored_while_it_sticks_goes_on_to_the_bit() {
    for text in [sheet(0.5), soft(0.5)] {
        let mut world = World::new(&text);
        let place = |k: u32| {
            let t = f64::from(k) * 1e-3;
            if text.contains("drop") {
                [
                    0.0245 + 0.05 * (0.2 - t).max(0.0),
                    0.003,
                    0.045 + 0.004 * libm::sin(6.0 * t),
                ]
            } else {
                [
                    0.004 * libm::sin(6.0 * t),
                    0.0,
                    0.008 + 0.05 * (0.2 - t).max(0.0),
                ]
            }
        };
        for k in 0..700 {
            world.at(place(k));
        }
        assert!(world.state.warm.rows().iter().any(|row| row.rubs));
        let mut saved = SavedState::default();
        saved.save_from(&world.state);
        let mut again = World::new(&text);
        restore(&again.scene, &mut again.state, &mut again.scratch, &saved).unwrap();
        again.seq = world.seq;
        for k in 700..1_700 {
            assert_eq!(world.at(place(k)), again.at(place(k)), "tick {k}");
        }
    }
}
