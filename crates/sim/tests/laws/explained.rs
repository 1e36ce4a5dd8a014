//! A force explains itself: the numbers of its rows are closed forms, and bodies say what their step leaves.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{Random, Vector3};
use palpate_sim::tick::explain::{Explanation, RowExplained};
use palpate_sim::tick::flags::DEGRADED;
use palpate_sim::tick::record::{Command, TickOutput};
use palpate_sim::tick::{apply, quality, step_explained};

/// One tick with every tool at a place, explained.
fn explain(world: &mut World, tools: &[[f64; 3]]) -> (TickOutput, Explanation) {
    world.seq += 1;
    world.record.input.poses.reset(world.scene.tool_count());
    for (tool, &place) in tools.iter().enumerate() {
        world.record.input.poses[tool] = Some(crate::common::pose(world.seq, place));
    }
    let mut output = TickOutput::for_tools(world.scene.tool_count());
    let explanation = step_explained(
        &world.scene,
        &mut world.state,
        &mut world.scratch,
        &world.record.input,
        &mut output,
    );
    (output, explanation)
}

fn row<'a>(explanation: &'a Explanation, holder: &str, body: &str) -> &'a RowExplained {
    let mut rows = explanation.rows.iter();
    let own = rows.find(|row| row.holder == holder && row.body == body);
    own.unwrap_or_else(|| panic!("no row of {holder} on {body}: {explanation:?}"))
}

fn near(got: f64, wanted: f64, what: &str) {
    let miss = (got - wanted).abs();
    assert!(
        miss <= 1e-9 * wanted.abs().max(1e-3),
        "{what}: {got}, not {wanted}"
    );
}

/// Radius (m) and density of the free ball; dt² / m.
const RADIUS_M: f64 = 0.02;

/// A free ball over a floor, without gravity, and a ball on a coupling over or beside it.
fn free_ball(height_m: f64, density: f64, tools: &[(&str, [f64; 3], f64)]) -> World {
    let tools: String = (tools.iter())
        .map(|(id, place, stiffness)| {
            format!(
                "[[tool]]\nid = {id:?}\nshape = {{ sphere = {{ radius_m = 0.005 }} }}\npose = {{ position = {place:?} }}\n\
                 coupling = {{ stiffness_n_m = {stiffness:?}, damping_n_s_m = 0.0 }}\n\
                 device = {{ force_max_n = 1e6, ramp_s = 0.0 }}\n"
            )
        })
        .collect();
    World::new(&format!(
        "[gravity]\nacceleration = [0.0, 0.0, 0.0]\n\
         [[body]]\nid = \"floor\"\nsurface = {{ builtin = \"sheet\", size = 0.2 }}\n\
         [[body]]\nid = \"ball\"\nsurface = {{ builtin = \"sphere\", size = {RADIUS_M:?} }}\n\
         pose = {{ position = [0.0, 0.0, {height_m:?}] }}\nfree = true\n\
         material = {{ density_kg_m3 = {density:?} }}\n{tools}"
    ))
}

// Two rows in a line: the floor holds the ball, the tool presses it. With a = dt² / m and c = 1 / K:
// g + a f₁ − a f₂ = 0 and −d − a f₁ + (a + c) f₂ = 0, g the gap over the floor and d how far the tool is in.
#[test]
fn a_free_ball_between_a_floor_and_a_tool_carries_the_solution_of_two_equations() {
    let mut random = Random(41);
    for _ in 0..40 {
        let density = 500.0 * libm::exp(2.0 * random.unit());
        let stiffness = 200.0 * libm::exp(2.0 * random.unit());
        // Rows join a little before they touch: 2 µm here.
        let (gap_m, in_m) = (1e-6 * random.float(0.1, 1.0), random.float(5e-4, 1.5e-3));
        let height_m = RADIUS_M + gap_m;
        let touching_m = height_m + RADIUS_M + 0.005;
        let start = [0.0, 0.0, touching_m + 0.001];
        let mut world = free_ball(height_m, density, &[("hand", start, stiffness)]);
        explain(&mut world, &[start]);
        let mass_kg = world.state.rigid_motion(&world.scene, 1).unwrap().mass_kg;
        let (a, c) = (1e-6 / mass_kg, 1.0 / stiffness);
        let (_, explanation) = explain(&mut world, &[[0.0, 0.0, touching_m - in_m]]);
        let under = (explanation.rows.iter()).find(|row| {
            row.holder != "hand" && [&row.body, &row.holder].contains(&&"floor".to_owned())
        });
        let under = under.expect("a row on the floor");
        // A search finds it to a hundredth of a nanometre, which is no rounding to a row this firm.
        let miss_m = (under.gap_m - gap_m).abs();
        assert!(miss_m < 1e-11, "gap over the floor: {miss_m} m off");
        let gap_m = under.gap_m;
        let pressed_n = (in_m - gap_m) / c;
        let floor_n = pressed_n - gap_m / a;
        let expected = match floor_n > 0.0 {
            true => [floor_n, pressed_n],
            // The floor is not reached within the tick.
            false => [0.0, in_m / (a + c)],
        };
        let hand = row(&explanation, "hand", "ball");
        near(hand.gap_free_m, -in_m, "gap of the hand");
        near(hand.compliance_m_per_n.by_party["tool:hand"], c, "coupling");
        near(hand.compliance_m_per_n.by_party["body:ball"], a, "ball");
        near(hand.compliance_m_per_n.sum, a + c, "both");
        near(hand.force_n, expected[1], "hand");
        assert!(hand.residual_m.abs() <= 1e-12, "{}", hand.residual_m);
        near(under.compliance_m_per_n.sum, a, "ball over the floor");
        // Its normal is a difference of two points over the gap: tilted by 1e-4, which is 5e-9 along it.
        let off = (under.force_n - expected[0]).abs();
        assert!(off < 1e-7 * expected[1], "floor: off by {off} N");
    }
}

// Two tools press a ball from both sides: −d₁ + (a + c₁) f₁ − a f₂ = 0, and the mirror of it.
#[test]
fn two_tools_on_a_free_ball_carry_the_solution_of_two_equations() {
    let mut random = Random(42);
    for _ in 0..40 {
        let density = 500.0 * libm::exp(2.0 * random.unit());
        let stiffness = [(); 2].map(|()| 200.0 * libm::exp(2.0 * random.unit()));
        let in_m = [(); 2].map(|()| 2e-4 + 1e-3 * random.unit());
        let (height_m, apart_m) = (0.1, RADIUS_M + 0.005);
        let at = |side: f64, in_m: f64| [side * (apart_m - in_m), 0.0, height_m];
        let (left, right) = (at(-1.0, -0.001), at(1.0, -0.001));
        let tools = [("left", left, stiffness[0]), ("right", right, stiffness[1])];
        let mut world = free_ball(height_m, density, &tools);
        explain(&mut world, &[left, right]);
        let mass_kg = world.state.rigid_motion(&world.scene, 1).unwrap().mass_kg;
        let a = 1e-6 / mass_kg;
        let [k, l] = stiffness.map(|stiffness| a + 1.0 / stiffness);
        let (_, explanation) = explain(&mut world, &[at(-1.0, in_m[0]), at(1.0, in_m[1])]);
        let whole = k * l - a * a;
        let expected = [
            (l * in_m[0] + a * in_m[1]) / whole,
            (k * in_m[1] + a * in_m[0]) / whole,
        ];
        for (tool, force_n) in ["left", "right"].into_iter().zip(expected) {
            near(row(&explanation, tool, "ball").force_n, force_n, tool);
        }
    }
}

#[test]
fn on_a_rigid_floor_the_force_is_the_gap_over_the_compliance_of_the_coupling() {
    let mut world = free_ball(0.1, 1000.0, &[("hand", [0.05, 0.0, 0.01], 800.0)]);
    explain(&mut world, &[[0.05, 0.0, 0.01]]);
    let (output, explanation) = explain(&mut world, &[[0.05, 0.0, 0.004]]);
    let own = row(&explanation, "hand", "floor");
    near(own.gap_free_m, -0.001, "gap");
    near(own.force_n, 0.8, "force");
    near(
        own.force_n,
        -own.gap_free_m / own.compliance_m_per_n.sum,
        "their share",
    );
    near(output.tools[0].force_n.z, 0.8, "what the hand gets");
    assert_eq!(
        explanation.tools[0].force_n,
        <[f64; 3]>::from(output.tools[0].force_n)
    );
    assert!(explanation.bodies.is_empty());
}

/// A soft block on its base with so many iterations, and a ball over it.
fn soft(model: &str, iterations: u32) -> World {
    World::new(&soft_text(model, iterations))
}

fn soft_text(model: &str, iterations: u32) -> String {
    format!(
        "[[body]]\nid = \"block\"\nsurface = {{ builtin = \"sheet\", net = [8, 8], size = 0.06 }}\nmodel = {model:?}\n\
         material = {{ young_pa = 20e3, damping_s = 2e-3 }}\nintegrator = {{ iterations = {iterations} }}\n\
         lattice = {{ layers = 2, thickness_m = 0.02, refine = \"none\" }}\n\
         fixed = [{{ point = [0.0, 0.0, -0.019], normal = [0.0, 0.0, 1.0] }}]\n\
         [[tool]]\nid = \"hand\"\nshape = {{ sphere = {{ radius_m = 0.01 }} }}\npose = {{ position = [0.0, 0.0, 0.03] }}\n\
         coupling = {{ stiffness_n_m = 1000.0, damping_n_s_m = 0.0 }}\n"
    )
}

#[test]
fn an_explained_tick_has_the_bits_of_a_plain_one_and_a_converged_step_leaves_nothing() {
    for model in ["lattice", "continuum"] {
        let mut left = Vec::new();
        for iterations in [1, 30] {
            let (mut plain, mut explained) = (soft(model, iterations), soft(model, iterations));
            let mut worst: f64 = 0.0;
            for k in 0..120 {
                let place = [0.001, 0.002, 0.0125 - 3e-5 * f64::from(k)];
                let expected = plain.at(place);
                let (output, explanation) = explain(&mut explained, &[place]);
                assert_eq!(output, expected, "{model}, tick {k}");
                let [body] = &explanation.bodies[..] else {
                    panic!("{explanation:?}");
                };
                if k >= 100 {
                    let residual_n = body.residual_n.expect("an implicit step");
                    assert!(body.contact_n > 0.01, "{}", body.contact_n);
                    worst = worst.max(residual_n / body.contact_n);
                    let carried = explanation.rows.iter().filter(|row| row.force_n > 0.0);
                    for row in carried {
                        let parties = &row.compliance_m_per_n.by_party;
                        assert!(parties["body:block"] > 0.0 && parties["tool:hand"] == 1e-3);
                        assert!(row.residual_m.abs() < 1e-6, "{}", row.residual_m);
                    }
                }
            }
            left.push(worst);
        }
        // What thirty iterations leave is what their matrix contracts; one leaves what the table of
        // motion calls its error.
        assert!(
            left[1] < 1e-4 && left[0] > 10.0 * left[1],
            "{model}: {left:?}"
        );
        assert!(left[0] < 1.0, "{model}: {left:?}");
    }
}

#[test]
fn a_force_under_lowered_quality_is_degraded_where_it_touches_and_nowhere_else() {
    let mut world = soft("lattice", 4);
    let (above, inside) = ([0.0, 0.0, 0.03], [0.0, 0.0, 0.0095]);
    // At the speed of a hand.
    let degraded = |world: &mut World, place: [f64; 3]| {
        let from = world.state.tools[0].link.pose.position.z;
        let ways = (1..=50).map(|k| from + (place[2] - from) * f64::from(k) / 50.0);
        ways.fold(false, |_, z| {
            world.at([0.0, 0.0, z]).tools[0].flags & DEGRADED != 0
        })
    };
    assert!(!degraded(&mut world, above) && !degraded(&mut world, inside));
    for level in [
        quality::ONE_ITERATION,
        quality::FEWER_SWEEPS,
        quality::LOWEST,
    ] {
        apply(
            &world.scene,
            &mut world.state,
            &mut world.scratch,
            Command::Quality(level),
        );
        assert!(degraded(&mut world, inside), "level {level}");
        assert!(!degraded(&mut world, above), "level {level}, above");
    }
    // One iteration is all that this one makes.
    let mut world = soft("lattice", 1);
    degraded(&mut world, above);
    apply(
        &world.scene,
        &mut world.state,
        &mut world.scratch,
        Command::Quality(quality::ONE_ITERATION),
    );
    assert!(!degraded(&mut world, inside));
}

// A hit of 1000 N on a body of 50 g, asleep or not, is more than a tick can follow: what is out is what acts, and flagged.
#[test]
fn a_hit_that_a_body_cannot_follow_is_degraded_whether_it_slept_or_not() {
    for model in ["lattice", "continuum", "net"] {
        for asleep in [true, false] {
            let strong = "device = { force_max_n = 1e3, ramp_s = 0.0, speed_max_m_s = 1e6 }\n";
            let text = soft_text(model, 1).replace("n_m = 1000.0", "n_m = 1e8");
            let mut world = World::new(&(text + strong));
            let place = |z: f64| [0.001, 0.002, z];
            if asleep {
                (0..300).for_each(|_| {
                    world.at(place(0.03));
                });
            } else {
                (0..=20).for_each(|k| {
                    world.at(place(0.03 - 1.005e-3 * f64::from(k)));
                });
            }
            let state = world.state.bodies[0].deformable.as_ref().unwrap();
            assert_eq!(state.still >= 100, asleep, "{model}: {}", state.still);
            let tool = world.at(place(-0.2)).tools[0];
            assert!(
                tool.flags & DEGRADED != 0,
                "{model}, asleep {asleep}: {tool:?}"
            );
            let state = world.state.bodies[0].deformable.as_ref().unwrap();
            let taken: Vector3 = state.contact_n.iter().sum();
            near(-taken.z, tool.contact_force_n.z, "what the body took");
        }
    }
}
