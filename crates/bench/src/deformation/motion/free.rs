//! Bodies that nothing holds: a drop on a plane, and a spin.

use super::beam::Strip;
use super::path::rms;
use super::touching::Touching;
use super::{CONVERGED, Effort, Row, SETTINGS, Setting, UNITS, World, failed, row};
use crate::exact_step::obstacle::Obstacle;
use palpate_geometry::math::{Matrix3, Point3, Vector3};
use palpate_sim::body::DeformableState;
use std::f64::consts::TAU;

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    if wanted("motion/bounce") {
        bounce("motion/bounce", out);
    }
    for model in ["lattice", "continuum", "net"] {
        let case = format!("motion/spin/{model}");
        if wanted(&case) {
            for setting in SETTINGS {
                let method = setting.method();
                out(spin(&case, model, setting, effort)
                    .unwrap_or_else(|why| failed(&case, &method, &why)));
            }
        }
    }
}

/// Radius of the ball that is dropped, and its height above the plane, m.
const RADIUS_M: f64 = 0.03;
const DROP_M: f64 = 0.1;
/// d of the ball, s.
const DAMPING_S: f64 = 1e-3;
/// Ticks from the start to the top after the first bounce, and more.
const TICKS: usize = 450;
/// Places of the ball along both parameters where the exact step asks for contact.
const PLACES: [usize; 2] = [120, 120];

/// A gel ball above a plane that a tool is.
fn ball(setting: Setting) -> String {
    format!(
        r#"
[loop]
rate_hz = 1000
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
id = "ball"
surface = {{ builtin = "sphere", net = [8, 8], size = {RADIUS_M:?} }}
pose = {{ position = [0.0, 0.0, {:?}] }}
model = "continuum"
material = {{ young_pa = 20e3, poisson = 0.3, density_kg_m3 = 1000.0, damping_s = {DAMPING_S:?} }}
lattice = {{ layers = 3, refine = "none" }}
{}
[[tool]]
id = "floor"
shape = {{ plane = {{ normal = [0.0, 0.0, 1.0] }} }}
pose = {{ position = [0.0, 0.0, 0.0] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#,
        RADIUS_M + DROP_M,
        setting.text()
    )
}

/// Heights of the centre of mass over its lowest place after the drop, m, and times.
fn dropped(setting: Setting) -> Result<(Vec<f64>, Vec<f64>), String> {
    let mut world = World::new(&ball(setting))?;
    let mut heights = Vec::new();
    for _ in 0..TICKS {
        world.at([0.0; 3]);
        let (body, state) = world.body()?;
        let sum: f64 = body
            .masses()
            .iter()
            .zip(&state.positions)
            .map(|(m, p)| m * p.z)
            .sum();
        heights.push(sum / body.mass_kg());
    }
    Ok((heights, world.ticks_s))
}

/// Height above the plane that the ball comes back to, m, and when, in ticks.
fn rebound(heights: &[f64]) -> (f64, usize) {
    let lowest = (0..heights.len())
        .take_while(|&k| k < 300)
        .min_by(|&a, &b| heights[a].total_cmp(&heights[b]))
        .unwrap_or(0);
    let after = (lowest..heights.len()).max_by(|&a, &b| heights[a].total_cmp(&heights[b]));
    let top = after.unwrap_or(lowest);
    // Places are in the body's frame, which stands where the ball began.
    (heights[top] - heights[0] + DROP_M, top)
}

/// Heights of the same ball (m, one a tick) by the exact step on an analytic plane, and a note on its
/// resolution.
fn exactly(counts: [usize; 2]) -> Result<(Vec<f64>, String), String> {
    let world = World::new(&ball(Setting::auto(1)))?;
    let (body, state) = world.body()?;
    let height = |state: &DeformableState| {
        let points = body.masses().iter().zip(&state.positions);
        points.map(|(m, p)| m * p.z).sum::<f64>() / body.mass_kg()
    };
    let middle_m = height(state);
    let mut heights = Vec::new();
    let touching = Touching {
        world: &world,
        damping_s: DAMPING_S,
        gravity: Vector3::new(0.0, 0.0, -9.81),
        counts,
    };
    // Its lower half touches the plane, which the body's frame has so far below the middle.
    let taken = touching.path(
        TICKS,
        |place| place.z < middle_m - 0.3 * RADIUS_M,
        |_| Obstacle::Plane {
            point: Point3::new(0.0, 0.0, middle_m - RADIUS_M - DROP_M),
            normal: Vector3::z(),
        },
        |state, _| heights.push(height(state)),
    )?;
    Ok((heights, taken.said(TICKS)))
}

fn bounce(case: &str, out: &mut dyn FnMut(Row)) {
    let (exact, mut about) = match exactly(PLACES) {
        Ok((heights, about)) => (heights, format!("; {about}")),
        Err(why) => return out(failed(case, "exact step", &why)),
    };
    let (right_m, right_top) = rebound(&exact);
    about += &match exactly(PLACES.map(|count| count / 2)) {
        Ok((heights, _)) => format!(
            ", at every other place to {:.2} mm",
            rebound(&heights).0 * 1e3
        ),
        Err(why) => format!(", at every other place: {why}"),
    };
    for setting in SETTINGS.into_iter().chain([Setting::auto(CONVERGED)]) {
        let method = setting.method();
        match dropped(setting) {
            Ok((heights, ticks_s)) => {
                let (height_m, top) = rebound(&heights);
                let note = format!(
                    "comes back to {:.2} mm after {top} ticks, by the exact step to {:.2} mm after {right_top}, of {:.0} mm; \
                     path off by {:.1e} rms of that; {} iterations, matrix {}{}",
                    height_m * 1e3,
                    right_m * 1e3,
                    DROP_M * 1e3,
                    rms(&heights, &exact, DROP_M),
                    setting.iterations,
                    setting.matrix,
                    std::mem::take(&mut about),
                );
                let error = height_m / right_m - 1.0;
                out(row(case, &method, ticks_s, (error, UNITS[2]), note));
            }
            Err(why) => out(failed(case, &method, &why)),
        }
    }
}

/// Turns a second.
const TURNS: f64 = 10.0;

/// Motion of a body as a whole.
struct Whole {
    linear: Vector3,
    angular: Vector3,
    /// I⁻¹ L, rad/s.
    turning: Vector3,
}

fn whole(masses: &[f64], state: &DeformableState) -> Whole {
    let mass: f64 = masses.iter().sum();
    let points = || masses.iter().zip(&state.positions).zip(&state.velocities);
    let centre: Vector3 = points().map(|((m, p), _)| p.coords * *m).sum::<Vector3>() / mass;
    let linear: Vector3 = points().map(|((m, _), v)| v * *m).sum();
    let (mut angular, mut inertia) = (Vector3::zeros(), Matrix3::zeros());
    for ((m, p), v) in points() {
        let arm = p.coords - centre;
        angular += arm.cross(v) * *m;
        inertia += (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * *m;
    }
    Whole {
        linear,
        angular,
        turning: inertia
            .try_inverse()
            .map_or(Vector3::zeros(), |i| i * angular),
    }
}

/// A bar that turns about the axis across it and moves along.
fn spin(case: &str, model: &'static str, setting: Setting, effort: Effort) -> Result<Row, String> {
    let bar = Strip {
        fixed: "",
        counts: if model == "net" { [9, 5] } else { [11, 4] },
        layers: 3,
        ..Strip::clamped(model, 200e3)
    };
    let mut world = World::new(&bar.text(&setting.text()))?;
    let masses = world.body()?.0.masses().to_vec();
    let middle = {
        let (body, state) = world.body()?;
        let points = body.masses().iter().zip(&state.positions);
        points.map(|(m, p)| p.coords * *m).sum::<Vector3>() / body.mass_kg()
    };
    let omega = Vector3::new(0.0, 0.0, TURNS * TAU);
    world.put(|state| {
        for (v, x) in state.velocities.iter_mut().zip(&state.positions) {
            *v = Vector3::new(0.1, -0.05, 0.02) + omega.cross(&(x.coords - middle));
        }
    })?;
    let before = whole(&masses, world.body()?.1);
    let energy_j = |world: &World| world.body().map(|(body, state)| body.energy_j(state));
    let first_j = energy_j(&world)?;
    let ticks = if effort == Effort::Quick { 500 } else { 1_000 };
    // Direction from the middle to an end, in turns; and turns so far.
    let heading = |state: &DeformableState| {
        let far = |p: &Point3| p.coords;
        let (first, last) = (
            &state.positions[0],
            &state.positions[state.positions.len() - 1],
        );
        let along = far(last) - far(first);
        libm::atan2(along.y, along.x) / TAU
    };
    let (mut turned, mut turns) = (0.0, vec![0.0]);
    // Least and most I⁻¹ L over that of the start: a bar that swings in length has two.
    let (mut least, mut most) = (1.0f64, 1.0f64);
    let mut at = heading(world.body()?.1);
    for _ in 0..ticks {
        world.at([0.0, 0.0, 10.0]);
        let now = heading(world.body()?.1);
        let step = now - at;
        (turned, at) = (turned + step - step.round(), now);
        turns.push(turned);
        let rate = whole(&masses, world.body()?.1).turning.norm() / before.turning.norm();
        (least, most) = (least.min(rate), most.max(rate));
    }
    let after = whole(&masses, world.body()?.1);
    // Rates over a fifth of the time each, once the bar has stretched.
    let part = ticks / 5;
    let rate = |from: usize| (turns[from + part] - turns[from]) / (part as f64 * 1e-3);
    let (early, late) = (rate(part), rate(ticks - part));
    let between = turns[ticks - part] - turns[part];
    let loss = if between.abs() > 0.1 {
        (1.0 - late / early) / between
    } else {
        1.0
    };
    let of = |now: Vector3, then: Vector3| (now - then).norm() / then.norm();
    let note = format!(
        "{turned:.4} turns in {:.1} s, ω {:.3} ({least:.3} to {most:.3}) of the start's, energy {:.4}, linear momentum off by {:.1e}, angular by {:.1e}, \
         {} iterations, matrix {}",
        ticks as f64 * 1e-3,
        after.turning.norm() / before.turning.norm(),
        energy_j(&world)? / first_j,
        of(after.linear, before.linear),
        of(after.angular, before.angular),
        setting.iterations,
        setting.matrix
    );
    let ticks_s = world.ticks_s.clone();
    Ok(row(
        case,
        &setting.method(),
        ticks_s,
        (loss, "of the speed a turn"),
        note,
    ))
}
