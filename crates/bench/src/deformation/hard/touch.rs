//! Tools that share a body, tips, slides, and contacts that last.

use super::Kind;
use super::row::Run;
use super::slab::{RADIUS_M, SIDE_M, Slab, ball, body, press, tool};
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_geometry::surface::ClosestSolver;
use palpate_sim::haptics::DevicePose;

/// Two balls beside each other feel the same; in one place they press as one does.
pub(super) fn two_tools(kind: Kind) -> Result<Run, String> {
    const SMALL_M: f64 = 0.01;
    let mut run = Slab {
        tools: ball("left", "inf", SMALL_M) + &ball("right", "inf", SMALL_M),
        ..Slab::new(kind)
    }
    .run()?;
    let mut forces = [Vector3::zeros(); 2];
    let both = |run: &mut Run, places: [[f64; 3]; 2]| {
        let out = run.posed(&places.map(DevicePose::at_rest));
        [0, 1].map(|tool| out.tools[tool].force_n)
    };
    for k in 0..10_000 {
        let z = SMALL_M - 0.003 * (f64::from(k) / 5_000.0).min(1.0);
        forces = both(&mut run, [[-0.012, 0.0, z], [0.012, 0.0, z]]);
    }
    let [left, right] = forces;
    run.near(
        "force on the left ball against the right",
        left.z,
        right.z,
        1e-6,
        "N",
    );
    run.below(
        "sum of the forces to the sides",
        left.x + right.x,
        1e-6 * left.z,
        "N",
    );
    run.base_bears(left.z + right.z, 1e-3)?;
    let mut one = Slab {
        tools: ball("ball", "inf", SMALL_M),
        ..Slab::new(kind)
    }
    .run()?;
    let alone = press(&mut one, SMALL_M, 0.003, 2_000);
    for _ in 0..5_000 {
        forces = both(&mut run, [[0.0, 0.0, SMALL_M - 0.003]; 2]);
    }
    let sum = forces[0].z + forces[1].z;
    run.near(
        "force of two in one place against that of one",
        sum,
        alone,
        2e-3,
        "N",
    );
    Ok(run)
}

/// A sharp cone.
pub(super) fn cone(kind: Kind) -> Result<Run, String> {
    let shape = "{ cone = { half_angle_rad = 0.5, height_m = 0.03 } }";
    tip(kind, shape, Rotation::identity(), 0.0)
}

/// A cube, corner down.
pub(super) fn corner(kind: Kind) -> Result<Run, String> {
    let down = Rotation::rotation_between(&Vector3::new(-1.0, -1.0, -1.0), &-Vector3::z());
    let shape = "{ box = { half_extents_m = [0.01, 0.01, 0.01] } }";
    // From its middle to a corner.
    tip(kind, shape, down.unwrap_or_default(), 0.01 * 3.0_f64.sqrt())
}

/// A tip pressed 3 mm deep, held, and drawn across the slab. It has no normal of its own: the force is
/// along that of the surface where it stands.
fn tip(kind: Kind, shape: &str, orientation: Rotation, reach_m: f64) -> Result<Run, String> {
    let mut run = Slab {
        tools: tool("tip", shape, [0.0, 0.0, 0.04], "inf"),
        ..Slab::new(kind)
    }
    .run()?;
    let (pressed, held, drawn) = (500_usize, 4_500, 5_000);
    let mut last = Vector3::zeros();
    let (mut ripple, mut jump) = (0.0_f64, 0.0_f64);
    for k in 0..pressed + held + drawn {
        let depth = 0.003 * (k as f64 / pressed as f64).min(1.0);
        let way = 0.02 * (k.saturating_sub(pressed + held) as f64 / drawn as f64);
        let place = [0.001 + way, 0.002 - 0.3 * way, reach_m - depth];
        let posed = DevicePose {
            orientation,
            ..DevicePose::at_rest(place)
        };
        let force = run.posed(&[posed]).tools[0].force_n;
        let change = (force - last).norm() / force.norm().max(1.0);
        if k >= pressed + held / 2 && k < pressed + held {
            ripple = ripple.max(change);
        } else if k > pressed + held {
            jump = jump.max(change);
        }
        last = force;
        if k + 1 == pressed + held {
            let surface = run.world.surface();
            let mut solver = ClosestSolver::new(&surface);
            let tip = Point3::from(place) - Vector3::z() * reach_m;
            let foot = solver.closest(&surface, &tip);
            let frame = surface.frame(foot.u, foot.v);
            let normal = frame.du.cross(&frame.dv).normalize();
            let aside = force.cross(&normal).norm() / force.norm();
            run.below(
                "force along the surface over all of it",
                aside,
                5e-3,
                "of it",
            );
            run.base_bears(force.z, 1e-3)?;
        }
    }
    // A net still settles by a ten-millionth in a tick.
    let most = if kind.model == "net" { 1e-6 } else { 1e-9 };
    run.below(
        "change of the held force in a tick",
        ripple,
        most,
        "of it or of 1 N",
    );
    run.below(
        "change of the force in a tick as it is drawn",
        jump,
        0.02,
        "of it or of 1 N",
    );
    Ok(run)
}

/// A ball 2 mm deep that slides to and fro over 40 mm at 1 m/s, with μ of 0, 0.3, 1 and 10, then rests
/// in the middle.
pub(super) fn slide(kind: Kind) -> Result<Run, String> {
    let mut whole: Option<Run> = None;
    for mu in [0.0, 0.3, 1.0, 10.0] {
        let mut run = Slab {
            tools: ball("ball", "1000.0", RADIUS_M) + &format!("friction = {{ mu = {mu:?} }}\n"),
            material: "young_pa = 20e3, damping_s = 5e-3".to_owned(),
            ..Slab::new(kind)
        }
        .run()?;
        let z = RADIUS_M - 0.002;
        for k in 0..200 {
            run.at([0.0, 0.0, RADIUS_M - 0.002 * f64::from(k) / 200.0]);
        }
        let (mut outside, mut touched): (f64, usize) = (0.0, 0);
        for k in 0..10_000 {
            // A triangle of 40 mm to either side and back, from the middle.
            let phase = f64::from((k + 20) % 80) * 1e-3;
            let x = if phase < 0.04 {
                phase - 0.02
            } else {
                0.06 - phase
            };
            let out = run.posed(&[DevicePose::at_rest([x, 0.0, z])]);
            for contact in out.contacts.list() {
                let along = contact.force_n.dot(&contact.normal);
                let drag = (contact.force_n - contact.normal * along).norm();
                // Both must not pull, nor drag beyond the cone.
                outside = outside
                    .max((drag - mu * along) / along.max(1e-3))
                    .max(-along);
                touched += 1;
            }
        }
        let rest = run.stay([0.0, 0.0, z], 4_000);
        let (_, state) = run.world.body()?;
        let pressed = run.world.body()?.0.base_reaction_n(state).norm();
        let checks = |into: &mut Run| {
            let what = |what: &str| format!("μ = {mu}: {what}");
            into.between(
                &what("contacts on the way"),
                touched as f64,
                [5e3, f64::INFINITY],
                "",
            );
            into.below(
                &what("force outside the friction cone"),
                outside.max(0.0),
                1e-9,
                "of it",
            );
            let bears = what("force on the base at rest against that on the tool");
            into.near(&bears, pressed, rest.norm(), 1e-3, "N");
        };
        match &mut whole {
            Some(whole) => {
                whole.world.add(&run.world);
                checks(whole);
            }
            None => {
                checks(&mut run);
                whole = Some(run);
            }
        }
    }
    whole.ok_or_else(|| "no friction is given".to_owned())
}

/// Ten minutes of a tool at rest: its force is that of the first second to the last digits.
pub(super) fn ten_minutes(kind: Kind) -> Result<Run, String> {
    let mut run = Slab {
        side: 4,
        layers: 2,
        rate_hz: 100,
        ..Slab::new(kind)
    }
    .run()?;
    let first = press(&mut run, RADIUS_M, 0.003, 2_000);
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..60_000 {
        let force = run.at([0.0, 0.0, RADIUS_M - 0.003]).z;
        (low, high) = (low.min(force), high.max(force));
    }
    run.near(
        "largest force in ten minutes against that at first",
        high,
        first,
        1e-6,
        "N",
    );
    run.near(
        "least force in ten minutes against that at first",
        low,
        first,
        1e-6,
        "N",
    );
    Ok(run)
}

/// A hundred slabs, of which a ball visits ten in turn: each gives the same force, and those that
/// nobody touches sleep.
pub(super) fn hundred_bodies(kind: Kind) -> Result<Run, String> {
    let mut text = String::new();
    for k in 0..100 {
        let (x, y) = (
            1.5 * SIDE_M * f64::from(k % 10),
            1.5 * SIDE_M * f64::from(k / 10),
        );
        let slab = body(kind.model, kind.method, 4, 2, "preset = \"gel\"");
        text += &format!(
            "[[body]]\nid = \"b{k}\"\npose = {{ position = [{x:?}, {y:?}, 0.0] }}\n{slab}"
        );
    }
    let mut run = Run::new(&(text + &ball("ball", "inf", RADIUS_M)))?;
    let mut forces = Vec::new();
    for k in 0..10 {
        let x = 1.5 * SIDE_M * f64::from(k);
        run.stay([x, 0.0, 0.05], 100);
        let mut force = 0.0;
        for j in 0..900 {
            let depth = 0.003 * (f64::from(j) / 500.0).min(1.0);
            force = run.at([x, 0.0, RADIUS_M - depth]).z;
        }
        forces.push(force);
    }
    let first = forces[0];
    let alone = Slab {
        side: 4,
        layers: 2,
        material: "preset = \"gel\"".to_owned(),
        ..Slab::new(kind)
    };
    let alone = alone.force_n(0.003, 500)?;
    run.near(
        "force of the first slab against that of one alone",
        first,
        alone,
        1e-3,
        "N",
    );
    let most = |worst: f64, f: &f64| {
        if (f - first).abs() > (worst - first).abs() {
            *f
        } else {
            worst
        }
    };
    let farthest = forces.iter().fold(first, most);
    run.near(
        "force of the slab that differs most from the first",
        farthest,
        first,
        1e-9,
        "N",
    );
    let bodies = run.world.state.bodies.iter().enumerate();
    let asleep = bodies.filter(|(index, state)| {
        let parts = run
            .world
            .scene
            .deformable(*index)
            .zip(state.deformable.as_ref());
        parts.is_some_and(|(body, state)| body.asleep(state))
    });
    let asleep = asleep.count() as f64;
    run.between("slabs that sleep", asleep, [98.0, 100.0], "of 100");
    Ok(run)
}
