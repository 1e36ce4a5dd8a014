//! The teardrop, pressed at a speed and held, against the exact step with an analytic ball.
//!
//! The ball has no indentation of its own where a net is coarse: both paths then follow one law of contact, and
//! differ by the step.

use super::super::indent::first_touch;
use super::drop::{Drop, RADIUS_M, SIDE_M};
use super::path::{largest, rms};
use super::touching::Touching;
use super::{CONVERGED, Effort, Row, SETTINGS, Setting, UNITS, World, failed, row};
use crate::exact_step::obstacle::Obstacle;
use palpate_geometry::math::{Point3, Vector3};

/// And for how long it stays there, in ticks.
const HOLD: usize = 100;
/// d of the body, s.
const DAMPING_S: f64 = 2e-3;
/// At how many places around and along the body contact is asked for: every third of a millimetre, or
/// closer.
const PLACES: [usize; 2] = [400, 280];

/// How far the ball presses, m, and how far from where it ends contact is asked for, m.
#[derive(Clone, Copy)]
struct Press {
    depth_m: f64,
    around_m: f64,
}

const SHALLOW: Press = Press {
    depth_m: 4e-3,
    around_m: 0.013,
};
const DEEP: Press = Press {
    depth_m: 1e-2,
    around_m: 0.018,
};

/// What is pressed, and how.
struct Case {
    name: String,
    model: &'static str,
    poisson: f64,
    speed_mm_s: u32,
    press: Press,
}

impl Case {
    fn text(&self, setting: Setting) -> String {
        Drop::led(self.model, self.poisson, DAMPING_S, setting).text()
    }

    fn speed_m_s(&self) -> f64 {
        f64::from(self.speed_mm_s) * 1e-3
    }

    /// In a hurry only what is quick, and of solids two materials.
    fn is_long(&self) -> bool {
        let usual = self.model == "lattice" || [0.3, 0.49].contains(&self.poisson);
        self.speed_mm_s < 50 || self.press.depth_m > SHALLOW.depth_m || !usual
    }
}

/// All cases: at four speeds, and deep at the highest.
fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for model in ["lattice", "continuum", "net"] {
        for poisson in [0.25, 0.3, 0.45, 0.49, 0.499] {
            // Springs have one Poisson's ratio.
            if model == "lattice" && poisson != 0.25 {
                continue;
            }
            let case = |group: &str, speed_mm_s: u32, press| Case {
                name: format!("motion/{group}/{model}/{poisson}/{speed_mm_s}mm_s"),
                model,
                poisson,
                speed_mm_s,
                press,
            };
            cases.extend([1, 10, 50, 200].map(|speed| case("press", speed, SHALLOW)));
            cases.push(case("press-deep", 200, DEEP));
        }
    }
    cases
}

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    let quick = effort == Effort::Quick;
    for case in cases() {
        if wanted(&case.name) && !(quick && case.is_long()) {
            measured(&case, effort, out);
        }
    }
}

fn measured(case: &Case, effort: Effort, out: &mut dyn FnMut(Row)) {
    let (exact, mut about) = match exactly(case, PLACES) {
        Ok(done) => done,
        Err(why) => return out(failed(&case.name, "exact step", &why)),
    };
    let peak = most(&exact);
    // What the reference itself is good for: said once a case, and in a hurry where it is quick.
    if effort == Effort::Full || (case.model != "net" && case.speed_mm_s == 50) {
        about += &match exactly(case, PLACES.map(|count| count / 2)) {
            Ok((forces, _)) => format!(
                "; at every other place the path changes by {:.1e} rms of the peak",
                rms(&forces, &exact, peak)
            ),
            Err(why) => format!("; at every other place: {why}"),
        };
    }
    for setting in SETTINGS.into_iter().chain([Setting::auto(CONVERGED)]) {
        let method = setting.method();
        let (forces, ticks_s) = match pressed(case, setting) {
            Ok(done) => done,
            Err(why) => {
                out(failed(&case.name, &method, &why));
                continue;
            }
        };
        let note = format!(
            "peak {:.4} N, {:.3} of the exact step's, path off by at most {:.1} % of it, at the end {}, \
             {} iterations, matrix {}{}",
            most(&forces),
            most(&forces) / peak,
            largest(&forces, &exact, peak) * 100.0,
            end(&forces, &exact).map_or("none".to_owned(), |end| format!("{:+.2} %", end * 100.0)),
            setting.iterations,
            setting.matrix,
            std::mem::take(&mut about),
        );
        let error = rms(&forces, &exact, peak);
        out(row(&case.name, &method, ticks_s, (error, UNITS[1]), note));
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
fn way(world: &World, case: &Case) -> Vec<f64> {
    let touch = first_touch(world.scene.rest_surface(0).expect("a surface"));
    // Half a millimetre of approach, so that the device has been seen before it touches.
    let (from, to) = (touch + 0.5e-3, touch - case.press.depth_m);
    let speed_m_s = case.speed_m_s();
    let ticks = ((from - to) / (speed_m_s * 1e-3)).ceil() as usize;
    (0..ticks + HOLD)
        .map(|k| (from - speed_m_s * 1e-3 * k as f64).max(to))
        .collect()
}

/// Force on the tool in each tick, N, and what each took, s.
fn pressed(case: &Case, setting: Setting) -> Result<(Vec<f64>, Vec<f64>), String> {
    let mut world = World::new(&case.text(setting))?;
    let forces = way(&world, case)
        .into_iter()
        .map(|x| world.at([x, SIDE_M[0], SIDE_M[1]]).tools[0].force_n.x)
        .collect();
    Ok((forces, world.ticks_s))
}

/// Force on the ball in each tick by the exact step, N, and how it was found.
fn exactly(case: &Case, counts: [usize; 2]) -> Result<(Vec<f64>, String), String> {
    let world = World::new(&case.text(Setting::auto(1)))?;
    let way = way(&world, case);
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
        |place| (place - middle).norm() < case.press.around_m,
        |tick| Obstacle::Sphere {
            centre: Point3::new(way[tick], SIDE_M[0], SIDE_M[1]),
            radius_m: RADIUS_M,
        },
        |_, force_n| forces.push(-force_n.x),
    )?;
    Ok((forces, format!("; {}", taken.said(way.len()))))
}
