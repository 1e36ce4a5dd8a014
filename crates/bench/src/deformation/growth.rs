//! What a tick costs over the nodes of a lattice: cubes of nodes in the teardrop, pressed, with each
//! matrix, and the exponent p of t ~ nᵖ that fits them best.

use super::indent::{failed, first_touch};
use super::scenes::TeardropCase;
use super::world::World;
use super::{Effort, Row, TEARDROP_REFERENCE_N};

/// Nodes along each axis.
const SIDES: [usize; 6] = [8, 12, 16, 20, 24, 30];
/// Ticks of a press by 3 mm, and those that are timed after it.
const PRESS: usize = 300;

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for matrix in ["auto", "bounding"] {
        let sides = match effort {
            Effort::Quick => &SIDES[..4],
            Effort::Full => &SIDES[..],
        };
        let mut points = Vec::new();
        for &side in sides {
            let case = format!("growth/{matrix}/{side}");
            if wanted(&case) {
                let row = pressed(&case, matrix, side, effort, &mut points);
                out(row);
            }
        }
        if points.len() > 1 {
            out(fitted(&format!("growth/{matrix}"), &points));
        }
    }
}

/// Ticks of a pressed cube; adds its free nodes and the median tick to `points`. Error: of the force at
/// 3 mm against the converged solid, after a press that is not quite over.
fn pressed(
    case: &str,
    matrix: &str,
    side: usize,
    effort: Effort,
    points: &mut Vec<[f64; 2]>,
) -> Row {
    // One coarse net for all, which even the smallest cube sees.
    let scene = TeardropCase::cube(case, side, "\"none\"").text(1_000);
    let chosen = format!("integrator = {{ matrix = \"{matrix}\", ");
    let mut world = match World::new(&scene.replace("integrator = { ", &chosen)) {
        Ok(world) => world,
        Err(why) => return failed(case, &why),
    };
    let touch = first_touch(world.scene.rest_surface(0).expect("a surface"));
    let mut press = |k: usize| {
        let depth = 3e-3 * (k as f64 / PRESS as f64).min(1.0);
        world.at([touch - depth, 0.003, 0.045]).tools[0]
            .force_n
            .norm()
    };
    for k in 0..PRESS {
        press(k);
    }
    let held = match effort {
        Effort::Quick => 100,
        Effort::Full => 500,
    };
    let force_n = (PRESS..PRESS + held)
        .map(&mut press)
        .fold(0.0, |_, force_n| force_n);
    world.ticks_s.drain(..PRESS);
    let Some(body) = world.scene.deformable(0) else {
        return failed(case, "it does not deform");
    };
    let (free, matrix) = (body.unknown_count(), body.step_matrix().unwrap_or("none"));
    let note = format!(
        "{free} nodes are free; {matrix} matrix, {} numbers in its factor, compliance {:.1} MB; force {force_n:.4} N",
        body.factor_non_zeros(),
        body.compliance_bytes() as f64 * 1e-6,
    );
    let error = (force_n / TEARDROP_REFERENCE_N[2] - 1.0).abs();
    let row = world.row(case, matrix, note);
    points.extend(row.times.map(|times| [free as f64, times.median_s]));
    row.off_by(error, "of the force")
}

/// The exponent of times over sizes, by least squares on their logarithms; error: the farthest point's
/// share off that line.
fn fitted(case: &str, points: &[[f64; 2]]) -> Row {
    let logs: Vec<[f64; 2]> = points.iter().map(|point| point.map(libm::log)).collect();
    let (exponent, at_one) = line(&logs);
    let off = |[x, y]: &[f64; 2]| (libm::exp(y - at_one - exponent * x) - 1.0).abs();
    let worst = logs.iter().map(off).fold(0.0, f64::max);
    let row = Row::new("deformation", case, "fit").off_by(worst, "of the time, off the fit");
    row.saying(format!(
        "the tick grows with the {exponent:.2}th power of the free nodes, of {} sizes",
        points.len()
    ))
}

/// Slope and intercept of the line nearest to points.
fn line(points: &[[f64; 2]]) -> (f64, f64) {
    let n = points.len() as f64;
    let mean = |k: usize| points.iter().map(|point| point[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let both: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let own: f64 = points.iter().map(|p| (p[0] - x) * (p[0] - x)).sum();
    let slope = both / own;
    (slope, y - slope * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_a_power_law_is_found() {
        let points = [100.0, 500.0, 4_000.0].map(|n: f64| [n, 3e-7 * libm::pow(n, 1.4)]);
        let row = fitted("case", &points);
        assert!(row.note.contains("1.40th"), "{}", row.note);
        assert!(row.error_size().is_some_and(|error| error < 1e-9));
    }
}
