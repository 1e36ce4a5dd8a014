//! A ball that is led 7 mm into the teardrop in one tick, stays, and goes.

use super::super::indent::first_touch;
use super::drop::{Drop, SIDE_M};
use super::held::{REST, larger};
use super::{Effort, Row, Setting, World, failed, row};

const DEPTH_M: f64 = 7e-3;
/// How far before the surface it starts, m.
const BEFORE_M: f64 = 1e-4;
/// Ticks before the jump, and after it.
const BEFORE: usize = 50;
const STAY: usize = 500;

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for model in ["continuum", "net"] {
        for poisson in [0.3, 0.49, 0.499] {
            let case = format!("motion/jump/{model}/{poisson}");
            if !wanted(&case) || (effort == Effort::Quick && model == "net") {
                continue;
            }
            for setting in [1, 2].map(Setting::auto) {
                let drop = Drop {
                    coupling: "stiffness_n_m = 1e5, damping_n_s_m = 0.0",
                    device: "force_max_n = 1e9, ramp_s = 0.0, speed_max_m_s = 1e6",
                    ..Drop::led(model, poisson, 2e-3, setting)
                };
                let row = jumped(&case, drop);
                out(row.unwrap_or_else(|why| failed(&case, &setting.method(), &why)));
            }
        }
    }
}

/// One tick with the ball there: the force on it, N.
fn at(world: &mut World, x: f64) -> f64 {
    let output = world.at([x, SIDE_M[0], SIDE_M[1]]);
    output.tools[0].force_n.norm()
}

fn jumped(case: &str, drop: Drop) -> Result<Row, String> {
    let mut world = World::new(&drop.text())?;
    let touch_m = first_touch(world.scene.rest_surface(0).expect("a surface"));
    for _ in 0..BEFORE {
        at(&mut world, touch_m + BEFORE_M);
    }
    let (mut forces_n, mut farthest_m) = (Vec::new(), 0.0);
    for _ in 0..STAY {
        forces_n.push(at(&mut world, touch_m - DEPTH_M));
        farthest_m = larger(farthest_m, world.away_m()?);
    }
    for _ in 0..REST {
        at(&mut world, 0.2);
    }
    let left_m = world.away_m()?;
    let most_n = forces_n.iter().copied().fold(0.0, larger);
    let last_n = forces_n[STAY - 1];
    let note = format!(
        "at most {most_n:.3} N and {:.2} mm, {:.3} N in the tick of the jump and {last_n:.4} N after {:.1} s; let go, {:.1} s later {:.4} mm from rest; {} faults",
        farthest_m * 1e3,
        forces_n[0],
        STAY as f64 * 1e-3,
        REST as f64 * 1e-3,
        left_m * 1e3,
        world.faults,
    );
    let finite = most_n.is_finite() && farthest_m.is_finite() && left_m.is_finite();
    Ok(Row {
        wrong: Some(world.faults + usize::from(!finite)),
        ..row(
            case,
            &drop.setting.method(),
            world.ticks_s,
            (left_m, "m from rest at the end"),
            note,
        )
    })
}
