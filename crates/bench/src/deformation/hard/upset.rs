//! Bodies that are torn out of shape, and what becomes of them.

use super::Kind;
use super::row::Run;
use super::slab::{RADIUS_M, SIDE_M, Slab, THICKNESS_M, ball, tool};
use palpate_geometry::math::{Point3, Random, Vector3};
use palpate_sim::tick::flags;

/// A place far above the slab.
const ASIDE: [f64; 3] = [0.0, 0.0, 0.5];

/// Where a net may fall asleep, m: its last, softest motions are slower than 0.1 µm/s.
const NET_REST_M: f64 = 1e-5;

/// Free coordinates of the slab.
fn free(run: &Run) -> Result<Vec<usize>, String> {
    let (body, _) = run.world.body()?;
    Ok((0..body.coordinate_count())
        .filter(|&k| body.unknown(k).is_some())
        .collect())
}

/// How far from rest the slab ends. Springs have inverted equilibria, and may stay in one: of them
/// only that they stay together.
fn comes_back(run: &mut Run, kind: Kind, most_m: f64) -> Result<(), String> {
    let away = run.world.away_m()?;
    let most_m = match kind.model {
        "lattice" => SIDE_M / 2.0,
        "net" => most_m.max(NET_REST_M),
        _ => most_m,
    };
    run.below(
        "farthest coordinate from rest at the end",
        away,
        most_m,
        "m",
    );
    Ok(())
}

/// A quarter of the free nodes in one place, with no length between them.
pub(super) fn coincident(kind: Kind) -> Result<Run, String> {
    let mut run = Slab::new(kind).run()?;
    let free = free(&run)?;
    run.world.put(|state| {
        let place = state.positions[free[0]];
        for &node in free.iter().step_by(4) {
            state.positions[node] = place;
        }
    })?;
    run.world.watch_energy(Vector3::zeros());
    run.stay(ASIDE, 10_000);
    comes_back(&mut run, kind, 1e-6)?;
    Ok(run)
}

/// All free nodes anywhere within twice the size of the slab.
pub(super) fn scrambled(kind: Kind) -> Result<Run, String> {
    let mut run = Slab::new(kind).run()?;
    let (free, mut random) = (free(&run)?, Random(17));
    run.world.put(|state| {
        for &node in &free {
            state.positions[node] = Point3::from(random.vector() * SIDE_M);
        }
    })?;
    run.world.watch_energy(Vector3::zeros());
    run.stay(ASIDE, 20_000);
    comes_back(&mut run, kind, 1e-5)?;
    Ok(run)
}

/// Squeezed to a tenth of its thickness between a plane and the fixed underside, and released.
///
/// How far the force can grow with the squeeze is a matter of the law: springs turn over at half of
/// the thickness, the rim of a continuum folds out at a third.
pub(super) fn squeezed(kind: Kind) -> Result<Run, String> {
    let sound_m = if kind.model == "lattice" {
        0.013
    } else {
        0.019
    };
    let plane = "{ plane = { normal = [0.0, 0.0, -1.0] } }";
    let mut run = Slab {
        tools: tool("press", plane, [0.0, 0.0, 0.02], "inf"),
        ..Slab::new(kind)
    }
    .run()?;
    let (mut last, mut fell, mut above_m, mut unborne): (f64, f64, f64, f64) = (0.0, 0.0, 0.0, 0.0);
    for k in 0..6_000 {
        let z = 0.001 - (0.9 * THICKNESS_M + 0.001) * (k as f64 / 4_000.0).min(1.0);
        let force = run.at([0.0, 0.0, z]).z;
        if k % 250 != 249 || -z >= sound_m {
            continue;
        }
        fell = fell.max(last - force);
        last = force;
        let (body, state) = run.world.body()?;
        let tops = state.positions.iter().map(|p| p.z);
        above_m = above_m.max(tops.fold(f64::NEG_INFINITY, f64::max) - z);
        if force > 0.0 {
            unborne = unborne.max((body.base_reaction_n(state).z.abs() / force - 1.0).abs());
        }
    }
    run.between(
        "force as it was squeezed so far that its law is sound",
        last,
        [10.0, 1e3],
        "N",
    );
    run.below("how much the force fell on the way", fell, 1e-9, "N");
    run.below(
        "how far a control point stood over the plane",
        above_m.max(0.0),
        1e-3,
        "m",
    );
    run.below(
        "share of the force that the base did not bear",
        unborne,
        0.05,
        "of it",
    );
    run.stay(ASIDE, 10_000);
    comes_back(&mut run, kind, 1e-8)?;
    Ok(run)
}

/// A ball that jumps by up to a metre in, out and through for ten seconds. A ball that appears a metre
/// off throws springs into an inverted equilibrium, and leaves a net a tenth of a millimetre off its
/// place for many seconds; a device's limit of speed keeps both from it. What work a jump does, nobody
/// can say: energy is watched once the ball is gone.
pub(super) fn jumps(kind: Kind) -> Result<Run, String> {
    let speed_max_m_s = if kind.model == "continuum" { 1e6 } else { 10.0 };
    let tools = ball("ball", "inf", RADIUS_M).replace(
        "speed_max_m_s = 1e6",
        &format!("speed_max_m_s = {speed_max_m_s:?}"),
    );
    let mut run = Slab {
        tools,
        ..Slab::new(kind)
    }
    .run()?;
    let (mut pressed, mut random): (f64, _) = (0.0, Random(23));
    for k in 0..10_000 {
        // Where jumps are refused, the tool presses only after it has come from outside.
        let place = match k % 8 {
            0 => [0.0, 0.0, 0.5],
            1 => [0.0, 0.0, -0.5],
            2 => (random.vector() * 0.5).into(),
            6 => [0.0, 0.0, RADIUS_M + 0.002],
            7 => [0.0, 0.0, RADIUS_M - 0.005],
            _ => [0.0, 0.0, RADIUS_M + 0.01],
        };
        let force = run.at(place).norm();
        pressed = if force.is_nan() {
            force
        } else {
            pressed.max(force)
        };
    }
    run.between(
        "largest force on the way",
        pressed,
        [1.0, f64::INFINITY],
        "N",
    );
    run.at([0.0, 0.0, 0.3]);
    run.world.watch_energy(Vector3::zeros());
    run.stay([0.0, 0.0, 0.3], 5_000);
    let away = run.world.away_m()?;
    let most_m = if kind.model == "net" {
        NET_REST_M
    } else {
        1e-8
    };
    run.below(
        "farthest coordinate from rest at the end",
        away,
        most_m,
        "m",
    );
    Ok(run)
}

/// A ball that presses with 1000 N, as its device's limit says, for one tick: or less, where the slab cannot follow, and
/// then it is flagged. What is said is what acts.
pub(super) fn thousand_newtons(kind: Kind) -> Result<Run, String> {
    const FORCE_N: f64 = 1e3;
    let tools = ball("ball", "1e8", RADIUS_M)
        .replace("force_max_n = 1e9", &format!("force_max_n = {FORCE_N:?}"));
    let mut run = Slab {
        tools,
        ..Slab::new(kind)
    }
    .run()?;
    run.stay([0.0, 0.0, RADIUS_M + 0.001], 100);
    let output = run.world.at([0.0, 0.0, -0.1]);
    let (hit, flagged) = (output.tools[0].force_n.z, output.tools[0].flags);
    let least = match flagged & flags::DEGRADED {
        0 => FORCE_N * (1.0 - 1e-6),
        _ => 10.0,
    };
    run.between(
        "force of the hit",
        hit,
        [least, FORCE_N * (1.0 + 1e-6)],
        "N",
    );
    if kind.method == "implicit" {
        let (_, state) = run.world.body()?;
        let taken = state.contact_n.iter().map(|force| force.z).sum::<f64>();
        run.near("force that the slab took", -taken, hit, 1e-9, "N");
    }
    // The force acts through all of its tick: energy is watched from its end on.
    run.world.watch_energy(Vector3::zeros());
    run.stay(ASIDE, 10_000);
    let (away, most_m) = (
        run.world.away_m()?,
        if kind.model == "net" {
            NET_REST_M
        } else {
            1e-6
        },
    );
    run.below(
        "farthest coordinate from rest ten seconds later",
        away,
        most_m,
        "m",
    );
    Ok(run)
}
