//! A clamped beam that is let go.

use super::beam::{LENGTH_M, Strip};
use super::path::{Swings, rms};
use super::{Effort, Row, SETTINGS, Setting, UNITS, World, failed, row};
use crate::exact_step::ExactStep;
use crate::peers::python;
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::body::{Deformable, DeformableState};

/// Stiffnesses, Pa.
const YOUNG_PA: [(f64, &str); 4] = [(2e3, "2e3"), (20e3, "20e3"), (200e3, "200e3"), (2e6, "2e6")];
/// The tip starts so far out, of the length.
const BENT: f64 = 0.1;
/// Less than this of the start has died out.
const DEAD: f64 = 2e-3;

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    // Five swings of the softest take 10 s.
    let ticks = if effort == Effort::Quick {
        3_000
    } else {
        10_000
    };
    for model in ["lattice", "continuum", "net", "membrane"] {
        for (young_pa, label) in YOUNG_PA {
            let case = format!("motion/ringdown/{model}/{label}");
            if !wanted(&case) {
                continue;
            }
            let beam = Strip::clamped(model, young_pa);
            match exact(&beam, ticks) {
                Ok(exact) => {
                    for setting in SETTINGS {
                        out(ours(&case, &beam, setting, &exact));
                    }
                    if model == "continuum" {
                        #[cfg(feature = "peers")]
                        rapier(&case, &beam, &exact, effort, out);
                        mujoco(&case, &beam, &exact, effort, out);
                    }
                }
                Err(why) => out(failed(&case, "exact step", &why)),
            }
        }
    }
}

/// The exact step's path.
struct Exact {
    rest: Vec<Point3>,
    /// Farthest that is held, m.
    held_m: f64,
    start: Vec<Point3>,
    tips_m: Vec<f64>,
    swings: Swings,
    /// Of a step, s.
    median_s: f64,
}

/// Coordinates at the free end.
struct Tip(Vec<usize>);

impl Tip {
    fn of(body: &Deformable) -> Self {
        let rest = body.rest_state().positions;
        Self(
            (0..rest.len())
                .filter(|&c| rest[c].x > LENGTH_M - 1e-9)
                .collect(),
        )
    }

    /// How far it is above where it was, as rest is about z of the same mean.
    fn height_m(&self, state: &DeformableState, rest: &[Point3]) -> f64 {
        let Self(tip) = self;
        let sum: f64 = tip.iter().map(|&c| state.positions[c].z - rest[c].z).sum();
        sum / tip.len() as f64
    }
}

/// At rest under a load on the tip that bends it by [`BENT`].
fn bent(body: &Deformable, beam: &Strip) -> Result<DeformableState, String> {
    let rest = body.rest_state();
    let tip = Tip::of(body);
    let goal = BENT * LENGTH_M;
    let mut exact = ExactStep::new(body);
    exact.tolerance = 1e-9;
    let settle = |exact: &mut ExactStep<'_>, load_n: f64| {
        let mut loads = vec![Vector3::zeros(); rest.positions.len()];
        tip.0
            .iter()
            .for_each(|&c| loads[c].z = load_n / tip.0.len() as f64);
        let mut parts = 4;
        loop {
            let mut state = rest.clone();
            match exact.settle(&mut state, &loads, parts) {
                Ok(()) => return Ok(state),
                Err(why) if parts >= 64 => return Err(why.to_string()),
                Err(_) => parts *= 4,
            }
        }
    };
    let inertia = beam.width_m * beam.thickness_m.powi(3) / 12.0;
    let mut load_n = 3.0 * beam.young_pa * inertia * goal / LENGTH_M.powi(3);
    let mut state = settle(&mut exact, load_n)?;
    for _ in 0..3 {
        load_n *= goal / tip.height_m(&state, &rest.positions);
        state = settle(&mut exact, load_n)?;
    }
    Ok(state)
}

fn exact(beam: &Strip, ticks: usize) -> Result<Exact, String> {
    let world = World::new(&beam.text(&Setting::auto(1).text()))?;
    let body = world.body()?.0;
    let rest = body.rest_state();
    let mut state = bent(body, beam)?;
    let start = state.positions.clone();
    let tip = Tip::of(body);
    let none = vec![Vector3::zeros(); start.len()];
    let mut exact = ExactStep::new(body);
    // Far below what is measured, and above the rounding of stiff bodies.
    exact.tolerance = 1e-9;
    let mut tips_m = vec![tip.height_m(&state, &rest.positions)];
    let mut times = Vec::with_capacity(ticks);
    for _ in 0..ticks {
        let (took, solved) = crate::measure::clocked(|| exact.step(&mut state, &none));
        solved.map_err(|why| why.to_string())?;
        times.push(took.as_secs_f64());
        tips_m.push(tip.height_m(&state, &rest.positions));
        let recent = &tips_m[tips_m.len().saturating_sub(50)..];
        let most = recent.iter().fold(0.0, |most: f64, z| most.max(z.abs()));
        if most < DEAD * tips_m[0].abs() || super::path::crossings(&tips_m).len() > 11 {
            break;
        }
    }
    times.sort_by(f64::total_cmp);
    let held = (0..start.len()).filter(|&c| body.unknown(c).is_none());
    Ok(Exact {
        held_m: held.map(|c| rest.positions[c].x).fold(0.0, f64::max),
        rest: rest.positions,
        start,
        swings: Swings::of(&tips_m),
        tips_m,
        median_s: times[times.len() / 2],
    })
}

fn ours(case: &str, beam: &Strip, setting: Setting, exact: &Exact) -> Row {
    let method = setting.method();
    let run = || -> Result<Row, String> {
        let mut world = World::new(&beam.text(&setting.text()))?;
        let rest = world.body()?.0.rest_state().positions;
        let tip = Tip::of(world.body()?.0);
        world.put(|state| state.positions.clone_from(&exact.start))?;
        let (mut tips_m, mut cautious) = (vec![exact.tips_m[0]], 0);
        while tips_m.len() < exact.tips_m.len() {
            world.at([0.0, 0.0, 10.0]);
            let state = world.body()?.1;
            cautious += usize::from(state.convergence.level > 0);
            tips_m.push(tip.height_m(state, &rest));
        }
        let (body, _) = world.body()?;
        let note = format!(
            "{}, {:.2} s, {} free coordinates, {} iterations, matrix {}, {cautious} ticks with a firmer one, \
             exact step {:.1} ms",
            Swings::of(&tips_m).beside(&exact.swings, 1e-3),
            exact.tips_m.len() as f64 * 1e-3,
            body.unknown_count(),
            setting.iterations,
            setting.matrix,
            exact.median_s * 1e3,
        );
        let error = rms(&tips_m, &exact.tips_m, exact.tips_m[0]);
        Ok(row(
            case,
            &method,
            world.ticks_s.clone(),
            (error, UNITS[0]),
            note,
        ))
    };
    run().unwrap_or_else(|why| failed(case, &method, &why))
}

/// The same beam on the same points by rapier3d. Its cells are tetrahedra and its step is its own, so
/// its own converged step would swing differently (substeps also damp less); it states neither. The
/// error is therefore not drawn beside ours.
#[cfg(feature = "peers")]
fn rapier(case: &str, beam: &Strip, exact: &Exact, effort: Effort, out: &mut dyn FnMut(Row)) {
    use crate::peers::rapier::{SoftBeam, Solver};
    // In a hurry only what swings or dies out soon: a path that is cut short has other errors.
    let (patience_s, most_ticks) = match effort {
        Effort::Quick => (10.0, 1_500),
        Effort::Full => (120.0, usize::MAX),
    };
    if exact.tips_m.len() > most_ticks {
        return;
    }
    let [along, across] = beam.counts;
    let sides_m = [LENGTH_M, beam.width_m, beam.thickness_m];
    let starts = |place: [f64; 3]| {
        let at = Point3::from(place);
        let points = exact.rest.iter().zip(&exact.start);
        let nearest = points.min_by(|a, b| (a.0 - at).norm().total_cmp(&(b.0 - at).norm()));
        nearest.map_or(place, |(_, start)| start.coords.into())
    };
    for (method, substeps, solver) in [
        ("rapier3d, 4 substeps", 4, Solver::Rows),
        ("rapier3d fem, 1 substep", 1, Solver::Elements),
    ] {
        let counts = [along, across, beam.layers];
        let of = (substeps, solver);
        let mut soft = SoftBeam::new(counts, sides_m, exact.held_m, beam.young_pa, of, starts);
        let (mut tips_m, mut times, mut spent_s) = (vec![exact.tips_m[0]], Vec::new(), 0.0);
        while tips_m.len() < exact.tips_m.len() && spent_s < patience_s {
            let (took, tip_m) = crate::measure::clocked(|| soft.step());
            times.push(took.as_secs_f64());
            spent_s += took.as_secs_f64();
            tips_m.push(tip_m);
        }
        let note = format!(
            "{}, {:.2} of {:.2} s, its own cells and step against our exact one",
            Swings::of(&tips_m).beside(&exact.swings, 1e-3),
            tips_m.len() as f64 * 1e-3,
            exact.tips_m.len() as f64 * 1e-3
        );
        let error = rms(&tips_m, &exact.tips_m, exact.tips_m[0]);
        out(Row {
            peer: true,
            ..row(
                case,
                method,
                times,
                (error, "of the amplitude, other cells"),
                note,
            )
        });
    }
}

/// What MuJoCo says of the beam.
#[derive(serde::Deserialize)]
struct Swung {
    method: String,
    tips_m: Vec<f64>,
    times_s: Vec<f64>,
}

/// The same beam on the same points, simulated by MuJoCo where Python has it. MuJoCo makes its own cells
/// and takes its own step. PyBullet is left out because its bodies cannot start bent.
fn mujoco(case: &str, beam: &Strip, exact: &Exact, effort: Effort, out: &mut dyn FnMut(Row)) {
    let ticks = exact.tips_m.len() - 1;
    if effort == Effort::Quick && ticks > 1_500 {
        return;
    }
    let [along, across] = beam.counts;
    let places = |points: &[Point3]| -> Vec<[f64; 3]> {
        points.iter().map(|point| point.coords.into()).collect()
    };
    let input = serde_json::json!({
        "counts": [along, across, beam.layers],
        "sides": [LENGTH_M, beam.width_m, beam.thickness_m],
        "young_pa": beam.young_pa, "poisson": beam.poisson, "density_kg_m3": 1000.0, "held_m": exact.held_m,
        "rest": places(&exact.rest), "start": places(&exact.start), "ticks": ticks,
    });
    let unit = "of the amplitude, other cells";
    match python::answer::<Swung>(
        include_str!("../../../../../benches/peers/motion.py"),
        &input,
    ) {
        None => {}
        Some(Err(why)) => out(Row {
            peer: true,
            ..failed(case, "mujoco", &why)
        }),
        Some(Ok(swung)) => {
            let tips_m = [&exact.tips_m[..1], &swung.tips_m].concat();
            let swings = Swings::of(&tips_m).beside(&exact.swings, 1e-3);
            let note = format!("{swings}, its own cells and step against our exact one");
            let error = rms(&tips_m, &exact.tips_m, exact.tips_m[0]);
            out(Row {
                peer: true,
                ..row(case, &swung.method, swung.times_s, (error, unit), note)
            });
        }
    }
}
