//! The teardrop, pressed at a speed and held, against the exact step with an analytic ball.
//!
//! The tool is a capsule that is shorter than a micrometre, and so a ball without the indentation that the loop
//! adds for balls where a net is coarse: both paths then follow one law of contact, and differ by the step.

use super::super::indent::first_touch;
use super::path::{largest, rms};
use super::touching::Touching;
use super::{CONVERGED, Effort, Row, SETTINGS, Setting, UNITS, World, failed, row};
use crate::exact_step::obstacle::Obstacle;
use palpate_geometry::math::{Point3, Vector3};

/// How far the ball presses, m.
const DEPTH_M: f64 = 4e-3;
/// And for how long it stays there, in ticks.
const HOLD: usize = 100;
/// d of the body, s.
const DAMPING_S: f64 = 2e-3;
/// Radius of the ball, m, and where it comes along −x, m.
const RADIUS_M: f64 = 0.01;
const SIDE_M: [f64; 2] = [0.003, 0.045];
/// How far from there contact is asked for, m, and at how many places around and along the body: every
/// third of a millimetre, or closer.
const AROUND_M: f64 = 0.013;
const PLACES: [usize; 2] = [400, 280];

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    let quick = effort == Effort::Quick;
    for model in ["lattice", "continuum", "net"] {
        for poisson in [0.25, 0.3, 0.45, 0.49] {
            // Springs have one Poisson's ratio.
            if model == "lattice" && poisson != 0.25 {
                continue;
            }
            for speed_mm_s in [1, 10, 50, 200] {
                let case = format!("motion/press/{model}/{poisson}/{speed_mm_s}mm_s");
                let hurried = quick
                    && (speed_mm_s < 50 || (model != "lattice" && ![0.3, 0.49].contains(&poisson)));
                if wanted(&case) && !hurried {
                    speed(&case, model, poisson, f64::from(speed_mm_s), effort, out);
                }
            }
        }
    }
}

fn speed(
    case: &str,
    model: &str,
    poisson: f64,
    speed_mm_s: f64,
    effort: Effort,
    out: &mut dyn FnMut(Row),
) {
    let run = |setting: Setting| pressed(&text(model, poisson, setting), speed_mm_s * 1e-3);
    let one = text(model, poisson, Setting::auto(1));
    let (exact, mut about) = match exactly(&one, speed_mm_s * 1e-3, PLACES) {
        Ok(done) => done,
        Err(why) => return out(failed(case, "exact step", &why)),
    };
    let peak = most(&exact);
    // What the reference itself is good for: said once a case, and in a hurry where it is quick.
    if effort == Effort::Full || (model != "net" && speed_mm_s == 50.0) {
        let coarse = exactly(&one, speed_mm_s * 1e-3, PLACES.map(|count| count / 2));
        about += &match coarse {
            Ok((forces, _)) => format!(
                "; at every other place the path changes by {:.1e} rms of the peak",
                rms(&forces, &exact, peak)
            ),
            Err(why) => format!("; at every other place: {why}"),
        };
    }
    for setting in SETTINGS.into_iter().chain([Setting::auto(CONVERGED)]) {
        let method = setting.method();
        let (forces, ticks_s) = match run(setting) {
            Ok(done) => done,
            Err(why) => {
                out(failed(case, &method, &why));
                continue;
            }
        };
        let note = format!(
            "peak {:.4} N, {:.3} of the exact step's, path off by at most {:.1} % of it, at the end {}, \
             {} iterations, matrix {}{}",
            most(&forces),
            most(&forces) / peak,
            largest(&forces, &exact, peak) * 100.0,
            end(&forces, &exact).map_or("none".to_owned(), |end| format!("{:+.1} %", end * 100.0)),
            setting.iterations,
            setting.matrix,
            std::mem::take(&mut about),
        );
        out(row(
            case,
            &method,
            ticks_s,
            (rms(&forces, &exact, peak), UNITS[1]),
            note,
        ));
    }
}

fn most(forces: &[f64]) -> f64 {
    forces.iter().fold(0.0, |most: f64, f| most.max(f.abs()))
}

/// By how much the last force is more than the exact one, of it.
fn end(forces: &[f64], exact: &[f64]) -> Option<f64> {
    Some(forces.last()? / exact.last()? - 1.0)
}

/// Places of the ball's centre along x, m, tick by tick.
fn way(world: &World, speed_m_s: f64) -> Vec<f64> {
    let touch = first_touch(world.scene.rest_surface(0));
    // Half a millimetre of approach, so that the device has been seen before it touches.
    let (from, to) = (touch + 0.5e-3, touch - DEPTH_M);
    let ticks = ((from - to) / (speed_m_s * 1e-3)).ceil() as usize;
    (0..ticks + HOLD)
        .map(|k| (from - speed_m_s * 1e-3 * k as f64).max(to))
        .collect()
}

/// Force on the tool in each tick, N, and what each took, s.
fn pressed(text: &str, speed_m_s: f64) -> Result<(Vec<f64>, Vec<f64>), String> {
    let mut world = World::new(text)?;
    let forces = way(&world, speed_m_s)
        .into_iter()
        .map(|x| world.at([x, SIDE_M[0], SIDE_M[1]]).tools[0].force_n.x)
        .collect();
    Ok((forces, world.ticks_s))
}

/// Force on the ball in each tick by the exact step, N, and how it was found.
fn exactly(text: &str, speed_m_s: f64, counts: [usize; 2]) -> Result<(Vec<f64>, String), String> {
    let world = World::new(text)?;
    let way = way(&world, speed_m_s);
    let middle = Point3::new(way[way.len() - 1] - RADIUS_M, SIDE_M[0], SIDE_M[1]);
    let mut forces = Vec::new();
    let touching = Touching {
        world: &world,
        damping_s: DAMPING_S,
        gravity: Vector3::zeros(),
        counts,
    };
    let taken = touching.path(
        way.len(),
        |place| (place - middle).norm() < AROUND_M,
        |tick| Obstacle::Sphere {
            centre: Point3::new(way[tick], SIDE_M[0], SIDE_M[1]),
            radius_m: RADIUS_M,
        },
        |_, force_n| forces.push(-force_n.x),
    )?;
    Ok((forces, format!("; {}", taken.said(way.len()))))
}

fn text(model: &str, poisson: f64, setting: Setting) -> String {
    let poisson = match model {
        "lattice" => String::new(),
        _ => format!("poisson = {poisson:?}, "),
    };
    let lattice = match model {
        "net" => "layers = 3, refine = [12, 13]",
        _ => "layers = 3, refine = \"none\"",
    };
    format!(
        r#"
[loop]
rate_hz = 1000
[[body]]
id = "drop"
surface = {{ builtin = "teardrop", net = [8, 8] }}
model = "{model}"
material = {{ young_pa = 20e3, {poisson}density_kg_m3 = 1000.0, damping_s = {DAMPING_S:?} }}
lattice = {{ {lattice} }}
{}
fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ capsule = {{ radius_m = {RADIUS_M:?}, half_length_m = 1e-7 }} }}
pose = {{ position = [0.06, 0.003, 0.045] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#,
        setting.text()
    )
}
