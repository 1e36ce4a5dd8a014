//! A body that is poked at random: whether anything grows.
//!
//! Its energy may never exceed what the tool put in, and when the tool is gone it comes back to rest.

use super::world::World;
use super::{Effort, Row};
use palpate_geometry::math::{Point3, Random, Vector3};

/// Stiffnesses, as multiples of 20 kPa.
const SCALES: [(f64, &str); 4] = [(1e-3, "x1e-3"), (1.0, "x1"), (1e3, "x1e3"), (1e6, "x1e6")];
/// Models and Poisson ratios; that of a lattice is 1/4, of a membrane 1/3.
const MODELS: [(&str, f64); 8] = [
    ("membrane", 0.33),
    ("lattice", 0.25),
    ("continuum", 0.3),
    ("continuum", 0.45),
    ("continuum", 0.499),
    ("net", 0.3),
    ("net", 0.45),
    ("net", 0.499),
];
/// Ticks of a case; all 32 are more than a million.
const TICKS: usize = 37_000;
const QUICK_TICKS: usize = 2_000;
/// Ticks that a body of 20 kPa has to come to rest; a softer one swings more slowly.
const REST_TICKS: f64 = 4_000.0;
/// Of the greatest energy that the body held, what may be left after that; of a body that is softer by a factor s,
/// the √s-th power. A swing loses its energy as exp(−ω² (d + dt) t): ω² is s times as much, t 1 / √s times.
const MOST_LEFT: f64 = 1e-3;
/// What rests is slower, m/s.
const STILL_M_S: f64 = 1e-6;
/// Fastest that the tool moves, m/s; never faster than waves of shear in the body.
const FASTEST_M_S: f64 = 0.5;
/// What the tool works through, m: about half of the body's half thickness.
const DEEPEST_M: f64 = 0.008;
/// Centre of the part that is poked, m.
const CENTRE: Vector3 = Vector3::new(0.0, 0.0, 0.045);
/// Farthest that a node can be from its place, m: the free part of the body to the other side of what is held.
const FARTHEST_M: f64 = 0.17;

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for (model, poisson) in MODELS {
        for (scale, label) in SCALES {
            let case = format!("stability/poking/{model}/{poisson}/{label}");
            if wanted(&case) {
                let ticks = if effort == Effort::Quick {
                    QUICK_TICKS
                } else {
                    TICKS
                };
                let row = poked(&case, model, poisson, scale, ticks);
                out(row.unwrap_or_else(|why| Row {
                    wrong: Some(1),
                    ..super::indent::failed(&case, &why)
                }));
            }
        }
    }
}

fn text(model: &str, poisson: f64, scale: f64) -> String {
    let poisson = match model {
        "lattice" | "membrane" => String::new(),
        _ => format!("poisson = {poisson:?}, "),
    };
    let thickness = match model {
        "membrane" => ", thickness_m = 0.008",
        _ => "",
    };
    format!(
        r#"
[loop]
rate_hz = 1000
[[body]]
id = "drop"
surface = {{ builtin = "teardrop", net = [8, 8] }}
model = "{model}"
material = {{ young_pa = {:?}, {poisson}density_kg_m3 = 1000.0, damping_s = 2e-3 }}
lattice = {{ refine = "none"{thickness} }}
fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.005 }} }}
pose = {{ position = [0.2, 0.0, 0.045] }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#,
        20e3 * scale
    )
}

/// Pokes: to a place outside, straight in, a while there, out again.
struct Pokes {
    random: Random,
    at: Point3,
    /// Still to be visited, with the speed on the way, m/s, and the time to stay, in ticks.
    way: Vec<(Point3, f64, usize)>,
    stay: usize,
    /// Fastest, m/s.
    fastest: f64,
}

impl Pokes {
    fn next(&mut self, surface: &palpate_geometry::surface::Surface) -> Point3 {
        if self.stay > 0 {
            self.stay -= 1;
            return self.at;
        }
        if self.way.is_empty() {
            let random = &mut self.random;
            let (u, v) = (random.unit(), random.unit());
            let point = surface.point(u, v);
            // Towards a place near the middle, so that it meets the body.
            let aim = Point3::from(CENTRE) + random.vector() * 0.01;
            let inward = (aim - point).normalize();
            let depth = DEEPEST_M * random.unit();
            let mut speed = || self.fastest * libm::pow(10.0, random.float(-1.7, 0.0));
            let (slow, out) = (speed(), speed());
            let stay = random.below(50);
            let outside = point - inward * 0.009;
            // Around the body, not through it.
            let side =
                (outside - CENTRE).coords.normalize() + (self.at - CENTRE).coords.normalize();
            let around = Point3::from(CENTRE) + side.normalize() * 0.1;
            self.way = vec![
                (outside, out, 0),
                (point + inward * depth, slow, stay),
                (outside, self.fastest, 0),
                (around, self.fastest, 0),
            ];
        }
        let Some(&(to, speed, stay)) = self.way.last() else {
            return self.at;
        };
        let left = to - self.at;
        let step = speed * 1e-3;
        if left.norm() <= step {
            (self.at, self.stay) = (to, stay);
            self.way.pop();
        } else {
            self.at += left * (step / left.norm());
        }
        self.at
    }
}

fn poked(case: &str, model: &str, poisson: f64, scale: f64, ticks: usize) -> Result<Row, String> {
    let mut world = World::new(&text(model, poisson, scale))?;
    let surface = world.scene.rest_surface(0).expect("a surface").clone();
    let start = Point3::new(0.2, 0.0, 0.045);
    let mut pokes = Pokes {
        random: Random(0x5eed),
        at: start,
        way: Vec::new(),
        stay: 0,
        fastest: FASTEST_M_S.min((20.0 * scale / (2.0 + 2.0 * poisson)).sqrt()),
    };
    let (mut most_m, mut peak_n) = (0.0_f64, 0.0_f64);
    world.watch_energy(Vector3::zeros());
    for _ in 0..ticks {
        let position = pokes.next(&surface);
        let output = world.at(position.into());
        peak_n = peak_n.max(output.tools[0].force_n.norm());
        most_m = most_m.max(world.away_m()?);
    }
    let ((most_j, excess_j), work_j, faults) = (world.energies_j(), world.put_in_j, world.faults);
    // Shells bend more softly than solids.
    let longer = if model == "membrane" { 4.0 } else { 1.0 };
    let rest_ticks = (longer * REST_TICKS / scale.min(1.0).sqrt()).ceil();
    for _ in 0..rest_ticks as usize {
        world.at(start.into());
    }
    let (constants, state) = world.body()?;
    let (left_m, left) = (world.away_m()?, constants.energy_j(state) / most_j);
    let may_be_left = MOST_LEFT.powf(scale.min(1.0).sqrt());
    let cautious = state.convergence.level;
    let fastest_m_s = state.velocities.iter().map(|v| v.norm());
    // A shell may snap through, and then rests in another shape.
    let dented = model == "membrane" && fastest_m_s.fold(0.0, f64::max) < STILL_M_S;
    // What is not a number is a problem too.
    let problem = if faults > 0 {
        Some(format!("{faults} faults"))
    } else if most_m.is_nan() || most_m >= FARTHEST_M {
        Some(format!("a node was {most_m:.3} m from its place"))
    } else if left.is_nan() || (left >= may_be_left && !dented) {
        Some(format!("{left:.1e} of the greatest energy is left"))
    } else {
        None
    };
    let note = format!(
        "{ticks} ticks, {peak_n:.3e} N and {:.1} mm at most, {work_j:.3e} J put in, at most {most_j:.3e} J held; {:.0} s later {left:.0e} of that, {left_m:.1e} m from rest{}{}{}",
        most_m * 1e3,
        rest_ticks * 1e-3,
        if cautious > 0 {
            ", on a firmer matrix"
        } else {
            ""
        },
        match left >= may_be_left && dented {
            true => ", still, with a dent",
            false => "",
        },
        problem
            .as_ref()
            .map_or(String::new(), |problem| format!("; WRONG: {problem}"))
    );
    let row = world.row(case, &format!("palpate {model}"), note);
    let excess = excess_j / work_j.max(f64::MIN_POSITIVE);
    Ok(Row {
        wrong: Some(usize::from(problem.is_some())),
        ..row.off_by(excess, "of the work, in excess")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    // Most of the body is free, pokes put energy in, and no model makes any.
    #[test]
    fn poked_bodies_make_no_energy_and_come_to_rest() {
        for (model, poisson) in MODELS.into_iter().filter(|(_, poisson)| *poisson < 0.4) {
            let world = World::new(&text(model, poisson, 1.0)).unwrap();
            let (body, _) = world.body().unwrap();
            let high = (0..body.coordinate_count())
                .filter(|&c| body.unknown(c).is_some())
                .map(|c| body.rest()[c].z)
                .fold(0.0, f64::max);
            assert!(high > 0.05, "{model}: the free part ends at {high} m");
            let row = poked(model, model, poisson, 1.0, QUICK_TICKS).unwrap();
            assert_eq!(row.wrong, Some(0), "{}", row.note);
            assert!(
                row.error_size().is_some_and(|error| error < 1e-9),
                "{row:?}"
            );
        }
    }
}
