//! How far each force is from that of the exact step from the same state, beside what the tick says of it.
//!
//! The exact step is Newton's method with contact at the places of the tick's own rows ([`crate::exact_step`]), from the
//! state before the tick, with the tool where its coupling then holds it: what is left between both is the step.

use super::super::indent::first_touch;
use super::drop::{Drop, RADIUS_M, SIDE_M};
use super::{Effort, Setting, World};
use crate::exact_step::ExactStep;
use crate::exact_step::contact::{Skin, Touch};
use crate::exact_step::obstacle::Obstacle;
use palpate_geometry::math::{Point3, Random, Vector3};
use palpate_sim::body::DeformableState;

/// d of the body, s.
const DAMPING_S: f64 = 2e-3;
/// Ticks of a way whose force is compared, at most.
const COMPARED: [usize; 2] = [30, 100];
/// Errors below this share of the peak force are those of the exact step, too.
const ROUNDING: f64 = 1e-6;
/// Errors above this share of the force count for the mean ratio.
const COUNTS: f64 = 1e-3;
/// Rounds until tool and body agree about the force.
const ROUNDS: usize = 20;
/// That they do, m.
const AGREED_M: f64 = 1e-9;

/// Errors of one way with one setting.
#[derive(Clone, Debug, serde::Serialize)]
pub struct TrustRow {
    /// What is done to which body.
    pub case: String,
    /// Iterations of a step.
    pub iterations: usize,
    /// Ticks with contact that were compared.
    pub ticks: usize,
    /// Ticks for which there was no exact step.
    pub unsolved: usize,
    /// Share of ticks whose true error is below twice the estimate; none without ticks.
    pub within_twice: Option<f64>,
    /// Mean of estimate over true error where that is more than 0.1 % of the force; none without such ticks.
    pub mean_ratio: Option<f64>,
    /// Mean of the true error over the force.
    pub mean_error: f64,
    /// By tick: true error and estimate over the force.
    #[serde(skip)]
    pub points: Vec<(f64, f64)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// A press of the side at a speed, mm/s, to a depth, mm; then it stays.
    Press(f64, f64),
    /// A press, then to and fro across.
    Slide,
    /// In and out at random, with a limp coupling.
    Poke,
    /// 7 mm in one tick.
    Jump,
}

const WAYS: [(&str, Way); 7] = [
    ("press/1mm_s", Way::Press(1.0, 4.0)),
    ("press/50mm_s", Way::Press(50.0, 4.0)),
    ("press/200mm_s", Way::Press(200.0, 4.0)),
    ("press-deep/200mm_s", Way::Press(200.0, 10.0)),
    ("slide", Way::Slide),
    ("poke", Way::Poke),
    ("jump", Way::Jump),
];
const BODIES: [(&str, f64); 7] = [
    ("continuum", 0.3),
    ("continuum", 0.49),
    ("continuum", 0.499),
    ("net", 0.3),
    ("net", 0.49),
    ("net", 0.499),
    ("lattice", 0.25),
];

impl Way {
    /// Keys of the tool's coupling and of its device, and 1 / (K + B / dt), m/N.
    fn coupling(self) -> (&'static str, &'static str, f64) {
        match self {
            Self::Poke => (
                "stiffness_n_m = 1000.0, damping_n_s_m = 1.0",
                "force_max_n = 1e9, ramp_s = 0.0",
                1.0 / (1000.0 + 1.0 / 1e-3),
            ),
            Self::Jump => (
                "stiffness_n_m = 1e5, damping_n_s_m = 0.0",
                "force_max_n = 1e9, ramp_s = 0.0, speed_max_m_s = 1e6",
                1e-5,
            ),
            Self::Press(..) | Self::Slide => (
                "stiffness_n_m = inf, damping_n_s_m = 0.0",
                "force_max_n = 1e9, ramp_s = 0.0",
                0.0,
            ),
        }
    }

    /// Places of the device, m, tick by tick; `touch_m`: where it touches along x.
    fn places(self, touch_m: f64) -> Vec<[f64; 3]> {
        let at = |x: f64| [x, SIDE_M[0], SIDE_M[1]];
        let mut places = Vec::new();
        match self {
            Self::Press(speed_mm_s, depth_mm) => {
                let (from, to) = (touch_m + 0.5e-3, touch_m - depth_mm * 1e-3);
                let stride = speed_mm_s * 1e-6;
                let ticks = ((from - to) / stride).ceil() as usize;
                places.extend((0..ticks + 50).map(|k| at((from - stride * k as f64).max(to))));
            }
            Self::Slide => {
                places = Self::Press(200.0, 4.0).places(touch_m);
                let [x, y, z] = places[places.len() - 1];
                places.extend((0..200).map(|k| {
                    let t = k as f64;
                    let aside = [4e-3 * libm::sin(t / 15.0), 3e-3 * libm::sin(t / 23.0)];
                    [x, y + aside[0], z + aside[1]]
                }));
            }
            Self::Poke => {
                let (mut random, outside) = (Random(7), touch_m + 2e-3);
                let (mut place, mut goal, mut stride) = (at(outside), outside, 0.0);
                for _ in 0..600 {
                    if (place[0] - goal).abs() < 1e-9 {
                        goal = outside - 12e-3 * random.unit();
                        stride = random.float(0.01, 0.5) * 1e-3;
                        place[1] = SIDE_M[0] + 2e-3 * random.signed();
                        place[2] = SIDE_M[1] + 3e-3 * random.signed();
                    }
                    place[0] += (goal - place[0]).clamp(-stride, stride);
                    places.push(place);
                }
            }
            Self::Jump => {
                places.extend([at(touch_m + 1e-4); 10]);
                places.extend([at(touch_m - 7e-3); 60]);
            }
        }
        places
    }
}

/// Measures all rows, of which those `wanted`.
pub(in crate::deformation) fn rows(
    effort: Effort,
    wanted: &dyn Fn(&str) -> bool,
    out: &mut dyn FnMut(TrustRow),
) -> Result<(), String> {
    let quick = effort == Effort::Quick;
    for (model, poisson) in BODIES {
        for (name, way) in WAYS {
            let case = format!("trust/{name}/{model}/{poisson}");
            if !wanted(&case) {
                continue;
            }
            for iterations in 1..=if quick { 1 } else { 3 } {
                let compared = COMPARED[usize::from(!quick)];
                out(measured(&case, way, (model, poisson), iterations, compared)
                    .map_err(|why| format!("{case}: {why}"))?);
            }
        }
    }
    Ok(())
}

fn measured(
    case: &str,
    way: Way,
    (model, poisson): (&'static str, f64),
    iterations: usize,
    compared: usize,
) -> Result<TrustRow, String> {
    let (coupling, device, m_per_n) = way.coupling();
    let drop = Drop {
        coupling,
        device,
        ..Drop::led(model, poisson, DAMPING_S, Setting::auto(iterations))
    };
    // The exact step meets a ball: the capsule must be one to less than what counts.
    let text = drop
        .text()
        .replace("half_length_m = 1e-7", "half_length_m = 1e-9");
    let (mut world, other) = (World::new(&text)?, World::new(&text)?);
    let (body, _) = other.body()?;
    let mut exact = ExactStep::new(body);
    exact.damping_s = DAMPING_S;
    let places = way.places(first_touch(world.scene.rest_surface(0).expect("a surface")));
    let every = places.len().div_ceil(compared).max(1);
    let mut forces = Vec::new();
    let mut unsolved = 0;
    for (tick, place) in places.iter().enumerate() {
        let (_, before) = world.body()?;
        let before = before.clone();
        let tool = world.at(*place).tools[0];
        let force_n = tool.contact_force_n;
        if tick % every != 0 || force_n == Vector3::zeros() {
            continue;
        }
        let skin = Skin::at(world.scratch.contact_places(&world.scene, 0));
        let free = tool.proxy_position - force_n * m_per_n;
        match exactly(
            &mut exact,
            &before,
            &skin,
            tool.proxy_position,
            (free, m_per_n),
        ) {
            Some(right_n) => {
                forces.push(((right_n - force_n).norm(), tool.error_n, force_n.norm()))
            }
            None => unsolved += 1,
        }
    }
    Ok(row(case, iterations, &forces, unsolved))
}

/// Force on the tool by the exact step, N. A tool on a coupling is where that force holds it, from `free`.
fn exactly(
    exact: &mut ExactStep<'_>,
    before: &DeformableState,
    skin: &Skin,
    first: Point3,
    (free, m_per_n): (Point3, f64),
) -> Option<Vector3> {
    let none = vec![Vector3::zeros(); before.positions.len()];
    let (mut centre, mut share, mut last) = (first, 0.5, Vector3::zeros());
    for _ in 0..ROUNDS {
        let (mut state, mut touch) = (before.clone(), Touch::default());
        let obstacle = Obstacle::Sphere {
            centre,
            radius_m: RADIUS_M,
        };
        let step = exact.step_touching(&mut state, &none, skin, &obstacle, &mut touch);
        step.ok()?;
        let force_n = -touch.force_n;
        let away = free + force_n * m_per_n - centre;
        if m_per_n == 0.0 || away.norm() < AGREED_M {
            return Some(force_n);
        }
        // Aitken's share: a body may be stiffer within a tick than the coupling.
        let change = away - last;
        if last != Vector3::zeros() && change != Vector3::zeros() {
            share = (-share * last.dot(&change) / change.norm_squared()).clamp(-2.0, 2.0);
        }
        last = away;
        centre += away * share;
    }
    None
}

/// `forces`: true error, estimate and force, N.
fn row(case: &str, iterations: usize, forces: &[(f64, f64, f64)], unsolved: usize) -> TrustRow {
    let peak = forces.iter().map(|force| force.2).fold(0.0, f64::max);
    let mean = |values: &[f64]| match values.len() {
        0 => None,
        count => Some(values.iter().sum::<f64>() / count as f64),
    };
    let within =
        |(off, said, _): &(f64, f64, f64)| f64::from(u8::from(*off < 2.0 * said + ROUNDING * peak));
    let counts = forces
        .iter()
        .filter(|(off, _, force)| *off > COUNTS * force);
    let ratios: Vec<f64> = counts.map(|(off, said, _)| said / off).collect();
    let points: Vec<(f64, f64)> = (forces.iter())
        .map(|(off, said, force)| (off / force, said / force))
        .collect();
    let errors: Vec<f64> = points.iter().map(|point| point.0).collect();
    TrustRow {
        case: case.to_owned(),
        iterations,
        ticks: forces.len(),
        unsolved,
        within_twice: mean(&forces.iter().map(within).collect::<Vec<_>>()),
        mean_ratio: mean(&ratios),
        mean_error: mean(&errors).unwrap_or(0.0),
        points,
    }
}

/// All rows, a line each.
pub fn trust_table(rows: &[TrustRow]) -> String {
    let mut text = "| case | iterations | ticks | true error of the force, mean | true < 2 × estimate | estimate / true, mean |\n\
                    |---|---|---|---|---|---|\n"
        .to_owned();
    for row in rows {
        let unsolved = match row.unsolved {
            0 => String::new(),
            count => format!(" ({count} unsolved)"),
        };
        let percent =
            |share: Option<f64>| share.map_or("–".to_owned(), |s| format!("{:.0} %", s * 1e2));
        let ratio = row
            .mean_ratio
            .map_or("–".to_owned(), |ratio| format!("{ratio:.2}"));
        text += &format!(
            "| `{}` | {} | {}{unsolved} | {:.2} % | {} | {ratio} |\n",
            row.case,
            row.iterations,
            row.ticks,
            row.mean_error * 1e2,
            percent(row.within_twice),
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(model: &'static str, poisson: f64, way: Way, iterations: usize) -> TrustRow {
        measured("test", way, (model, poisson), iterations, 40).unwrap()
    }

    /// The bars of the estimate, on a row of each kind.
    #[test]
    fn errors_of_forces_are_below_twice_their_estimates_which_are_not_far_above() {
        for (model, poisson, way, iterations) in [
            ("continuum", 0.3, Way::Press(200.0, 4.0), 1),
            ("continuum", 0.499, Way::Press(200.0, 4.0), 2),
            ("continuum", 0.49, Way::Press(50.0, 4.0), 1),
            ("continuum", 0.49, Way::Poke, 1),
            ("net", 0.49, Way::Slide, 1),
            ("lattice", 0.25, Way::Press(200.0, 4.0), 1),
        ] {
            let row = of(model, poisson, way, iterations);
            let said = format!("{model} {poisson} {way:?}: {row:?}");
            assert!(row.ticks > 10, "{said}");
            assert!(row.within_twice.unwrap() >= 0.95, "{said}");
            assert!(row.mean_ratio.is_none_or(|ratio| ratio < 5.0), "{said}");
        }
    }
}
