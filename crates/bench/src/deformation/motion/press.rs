//! The teardrop, pressed at a speed and held.

use super::super::indent::first_touch;
use super::path::{largest, rms};
use super::{CONVERGED, Effort, Row, SETTINGS, Setting, UNITS, World, failed, row};

/// How far the ball presses, m.
const DEPTH_M: f64 = 4e-3;
/// And for how long it stays there, in ticks.
const HOLD: usize = 100;

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
    let exact = match run(Setting::auto(CONVERGED)) {
        Ok((forces, _)) => forces,
        Err(why) => return out(failed(case, "none", &why)),
    };
    let peak = most(&exact);
    // What the reference itself is good for: said once a case, and in a hurry where it is quick.
    let said = effort == Effort::Full || (model != "net" && speed_mm_s == 50.0);
    let mut settled = match said {
        true => run(Setting::auto(CONVERGED / 2)).map_or(String::new(), |(forces, _)| {
            let change = largest(&forces, &exact, peak);
            let doubt = if change > 0.01 { ": not converged" } else { "" };
            format!(
                "; from {} to {CONVERGED} iterations the path changes by {change:.1e} of the peak{doubt}",
                CONVERGED / 2,
            )
        }),
        false => String::new(),
    };
    for setting in SETTINGS {
        let method = setting.method();
        let (forces, ticks_s) = match run(setting) {
            Ok(done) => done,
            Err(why) => {
                out(failed(case, &method, &why));
                continue;
            }
        };
        let note = format!(
            "peak {:.4} N, {:.3} of the exact step's, path off by at most {:.1} % of it, {} iterations, matrix {}{}",
            most(&forces),
            most(&forces) / peak,
            largest(&forces, &exact, peak) * 100.0,
            setting.iterations,
            setting.matrix,
            std::mem::take(&mut settled),
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

/// Force on the tool in each tick, N, and what each took, s.
fn pressed(text: &str, speed_m_s: f64) -> Result<(Vec<f64>, Vec<f64>), String> {
    let mut world = World::new(text)?;
    let touch = first_touch(world.scene.rest_surface(0));
    // Half a millimetre of approach, so that the device has been seen before it touches.
    let (from, to) = (touch + 0.5e-3, touch - DEPTH_M);
    let ticks = ((from - to) / (speed_m_s * 1e-3)).ceil() as usize;
    let forces = (0..ticks + HOLD)
        .map(|k| {
            let x = (from - speed_m_s * 1e-3 * k as f64).max(to);
            world.at([x, 0.003, 0.045]).tools[0].force_n.x
        })
        .collect();
    Ok((forces, world.ticks_s))
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
material = {{ young_pa = 20e3, {poisson}density_kg_m3 = 1000.0, damping_s = 2e-3 }}
lattice = {{ {lattice} }}
{}
fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.01 }} }}
pose = {{ position = [0.06, 0.003, 0.045] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#,
        setting.text()
    )
}
