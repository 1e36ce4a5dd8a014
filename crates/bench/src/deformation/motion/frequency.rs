//! Natural frequencies of a free bar and a clamped plate, against theory.
//!
//! A body starts in the shape of a mode, small enough to be linear. Its amplitude is the product of
//! its displacement with that shape, weighted by mass. Backward Euler multiplies a mode by
//! 1 / (1 ∓ i ω dt) a step, so what it should swing with is atan(ω dt) / dt.

use super::beam::{FAR_TOOL, LENGTH_M, Strip, surface};
use super::path::crossings;
use super::{Effort, Row, SETTINGS, Setting, World, failed, row};
use crate::exact_step::ExactStep;
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::body::{Deformable, DeformableState};
use std::f64::consts::{PI, TAU};

/// A body that swings in one of its modes.
struct Mode<'a> {
    /// The scene, with the integrator left out.
    text: &'a dyn Fn(&str) -> String,
    /// Displacement at a place of rest, largest about 1.
    shape: &'a dyn Fn(&Point3) -> Vector3,
    /// ω of theory, 1/s.
    omega: f64,
    /// Of the displacement, m.
    amplitude_m: f64,
}

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for model in ["lattice", "continuum", "net"] {
        let case = format!("motion/frequency/bar/{model}");
        if wanted(&case) {
            (1..=3).for_each(|n| bar(&case, model, n, effort, out));
        }
    }
    let case = "motion/frequency/plate/membrane";
    if wanted(case) {
        (0..3).for_each(|n| plate(case, n, effort, out));
    }
}

/// Along a free bar: u = cos(n π x / L), ω = n π c / L / √(1 + ν² k² r²), r² the polar radius of
/// gyration (Rayleigh and Love's correction).
fn bar(case: &str, model: &'static str, n: usize, effort: Effort, out: &mut dyn FnMut(Row)) {
    let (young_pa, side) = (20e3_f64, 0.01);
    let nu = if model == "lattice" { 0.25 } else { 0.0 };
    let strip = Strip {
        poisson: nu,
        counts: if model == "net" { [17, 4] } else { [21, 3] },
        layers: 3,
        width_m: side,
        thickness_m: side,
        fixed: "",
        ..Strip::clamped(model, young_pa)
    };
    let wave = n as f64 * PI / LENGTH_M;
    let gyration = side * side / 6.0;
    let omega =
        wave * (young_pa / 1_000.0).sqrt() / (1.0 + nu * nu * wave * wave * gyration).sqrt();
    let shape = |p: &Point3| {
        // Drawn places are thinner.
        let strain = wave * libm::sin(wave * p.x);
        let across = Vector3::new(0.0, p.y, p.z + 0.5 * side) * (nu * strain);
        Vector3::x() * libm::cos(wave * p.x) + across
    };
    let mode = Mode {
        text: &|integrator| strip.text(integrator),
        shape: &shape,
        omega,
        amplitude_m: 1e-5,
    };
    measured(case, n, &mode, effort, out);
}

/// Across a square plate that is clamped all around: ω = λ² / a² √(D / ρ h), λ² of Leissa,
/// *Vibration of Plates*, 1969; shapes are products of those of clamped beams. Rows of a membrane bend
/// each for themselves and do not resist twist, so that λ² = √(β_i⁴ + β_j⁴) is 31.6, 65.6 and 87.2 for
/// its own equations: what the exact step is off by.
fn plate(case: &str, n: usize, effort: Effort, out: &mut dyn FnMut(Row)) {
    let (young_pa, thickness_m, count) = (200e3_f64, 4e-3_f64, 21);
    let [lambda_squared, i, j] = [[35.985, 1.0, 1.0], [73.394, 2.0, 1.0], [108.22, 2.0, 2.0]][n];
    // Control points of a polygon are where its surface is, and held are the outermost two.
    let pitch = LENGTH_M / (count - 1) as f64;
    let side = LENGTH_M - 2.0 * pitch;
    let edge = 1.5 / (count - 1) as f64;
    let plane = surface(1, [count, count], LENGTH_M, LENGTH_M);
    let text = |integrator: &str| {
        let (low, high) = (edge, 1.0 - edge);
        format!(
            "[loop]\nrate_hz = 1000\n[[body]]\nid = \"plate\"\nsurface = {{ inline = {plane} }}\nmodel = \"membrane\"\n\
             material = {{ young_pa = {young_pa:?}, density_kg_m3 = 1000.0, damping_s = 0.0 }}\n\
             lattice = {{ refine = \"none\", thickness_m = {thickness_m:?} }}\n{integrator}\n\
             fixed = [{{ u = [0.0, {low:?}], v = [0.0, 1.0] }}, {{ u = [{high:?}, 1.0], v = [0.0, 1.0] }}, \
             {{ u = [0.0, 1.0], v = [0.0, {low:?}] }}, {{ u = [0.0, 1.0], v = [{high:?}, 1.0] }}]\n{FAR_TOOL}"
        )
    };
    let rigidity = young_pa * thickness_m.powi(3) / (12.0 * (1.0 - 1.0 / 9.0));
    let omega = lambda_squared / (side * side) * (rigidity / (1_000.0 * thickness_m)).sqrt();
    let shape = |p: &Point3| {
        let [x, y] = [p.x - pitch, p.y + 0.5 * side];
        Vector3::z() * clamped_beam(i, x / side) * clamped_beam(j, y / side)
    };
    let mode = Mode {
        text: &text,
        shape: &shape,
        omega,
        amplitude_m: 1e-5,
    };
    measured(case, n + 1, &mode, effort, out);
}

/// The first and second shape of a beam that is clamped at 0 and 1.
pub(super) fn clamped_beam(n: f64, s: f64) -> f64 {
    let beta = if n < 1.5 {
        4.730_040_744_862_704
    } else {
        7.853_204_624_095_838
    };
    let ratio = (libm::cosh(beta) - libm::cos(beta)) / (libm::sinh(beta) - libm::sin(beta));
    let at = beta * s;
    let value = libm::cosh(at) - libm::cos(at) - ratio * (libm::sinh(at) - libm::sin(at));
    0.6 * value
}

fn measured(case: &str, n: usize, mode: &Mode<'_>, effort: Effort, out: &mut dyn FnMut(Row)) {
    const DT_S: f64 = 1e-3;
    let right_hz = libm::atan(mode.omega * DT_S) / DT_S / TAU;
    let periods = if effort == Effort::Quick { 3.0 } else { 5.0 };
    let ticks = (periods / right_hz / DT_S).ceil() as usize;
    let exact_hz = exactly(mode, ticks).map(|path| frequency_hz(&path, DT_S));
    let exact = match &exact_hz {
        Ok(Some(hz)) => format!(
            "exact step {hz:.3} Hz ({:+.2} %)",
            (hz / right_hz - 1.0) * 100.0
        ),
        Ok(None) => "exact step: no swing".to_owned(),
        Err(why) => format!("exact step: {why}"),
    };
    let case = format!("{case}/{n}");
    for setting in SETTINGS {
        let method = setting.method();
        match swung(mode, setting, ticks) {
            Ok((path, ticks_s)) => {
                let hz = frequency_hz(&path, DT_S);
                let error = hz.map(|hz| hz / right_hz - 1.0);
                let own = hz.map_or("no swing".to_owned(), |hz| format!("{hz:.3} Hz"));
                let note = format!(
                    "mode {n}: {own}, theory {:.3} Hz, backward Euler's {right_hz:.3} Hz, {exact}, \
                     {} iterations, matrix {}",
                    mode.omega / TAU,
                    setting.iterations,
                    setting.matrix
                );
                out(row(
                    &case,
                    &method,
                    ticks_s,
                    (error, "of the frequency"),
                    note,
                ));
            }
            Err(why) => out(failed(&case, &method, &why)),
        }
    }
}

/// Half a swing lies between changes of sign.
fn frequency_hz(path: &[f64], dt_s: f64) -> Option<f64> {
    let zeros = crossings(path);
    let [first, .., last] = zeros[..] else {
        return None;
    };
    Some((zeros.len() - 1) as f64 / (2.0 * (last - first) * dt_s))
}

/// The amplitude of the mode in a state.
fn amplitude(mode: &Mode<'_>, body: &Deformable, rest: &[Point3], state: &DeformableState) -> f64 {
    let points = state.positions.iter().zip(rest).zip(body.masses());
    points
        .map(|((now, rest), m)| m * (now - rest).dot(&(mode.shape)(rest)))
        .sum()
}

fn start(mode: &Mode<'_>, body: &Deformable, state: &mut DeformableState) {
    for (c, place) in state.positions.iter_mut().enumerate() {
        if body.unknown(c).is_some() {
            *place += (mode.shape)(place) * mode.amplitude_m;
        }
    }
}

fn exactly(mode: &Mode<'_>, ticks: usize) -> Result<Vec<f64>, String> {
    let world = World::new(&(mode.text)(&Setting::auto(1).text()))?;
    let (body, state) = world.body()?;
    let rest = state.positions.clone();
    let mut state = state.clone();
    start(mode, body, &mut state);
    let mut exact = ExactStep::new(body);
    exact.tolerance = 1e-7;
    let none = vec![Vector3::zeros(); rest.len()];
    let mut path = vec![amplitude(mode, body, &rest, &state)];
    for _ in 0..ticks {
        exact
            .step(&mut state, &none)
            .map_err(|why| why.to_string())?;
        path.push(amplitude(mode, body, &rest, &state));
    }
    Ok(path)
}

fn swung(mode: &Mode<'_>, setting: Setting, ticks: usize) -> Result<(Vec<f64>, Vec<f64>), String> {
    let mut world = World::new(&(mode.text)(&setting.text()))?;
    let mut moved = world.body()?.1.clone();
    let rest = moved.positions.clone();
    start(mode, world.body()?.0, &mut moved);
    world.put(|state| state.positions.clone_from(&moved.positions))?;
    let mut path = Vec::with_capacity(ticks + 1);
    path.push(amplitude(mode, world.body()?.0, &rest, &moved));
    for _ in 0..ticks {
        world.at([0.0, 0.0, 10.0]);
        let (body, state) = world.body()?;
        path.push(amplitude(mode, body, &rest, state));
    }
    Ok((path, world.ticks_s))
}
