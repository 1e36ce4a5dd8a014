//! Beams, free bars and plates that are bent, let go and left alone: their periods beside those of the
//! exact step.
//!
//! A body starts at rest in the shape of its softest mode, far enough out for its turns to count. Its
//! amplitude is the product of its displacement with that shape, weighted by mass, over that of the
//! start. Beams of ν = 1/4 are those of [`super::ringdown`].

use super::beam::{LENGTH_M, Strip};
use super::frequency::clamped_beam;
use super::path::{Swings, crossings, rms};
use super::{Effort, Row, Setting, World, failed, row};
use crate::exact_step::ExactStep;
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::body::{Deformable, DeformableState};

const YOUNG_PA: [(f64, &str); 4] = [(2e3, "2e3"), (20e3, "20e3"), (200e3, "200e3"), (2e6, "2e6")];
/// Less than this of the start has died out.
const DEAD: f64 = 2e-3;
/// Changes of sign in five swings.
const ENOUGH: usize = 11;
/// How far the largest place starts out, m.
const BENT_M: f64 = 5e-3;
const PLATE_M: f64 = 2e-3;
/// Thickness of the plate, m.
const THIN_M: f64 = 0.01;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// Clamped at x = 0.
    Beam,
    /// Held by nothing.
    Bar,
    /// Clamped at all of its edges.
    Plate,
}

/// Forms and materials, with the part of the case's name that says which.
const BODIES: [(&str, Form, &str, f64); 12] = [
    ("beam/continuum/0.49", Form::Beam, "continuum", 0.49),
    ("beam/net/0.49", Form::Beam, "net", 0.49),
    ("bar/lattice", Form::Bar, "lattice", 0.25),
    ("bar/continuum/0.25", Form::Bar, "continuum", 0.25),
    ("bar/continuum/0.49", Form::Bar, "continuum", 0.49),
    ("bar/net/0.25", Form::Bar, "net", 0.25),
    ("bar/net/0.49", Form::Bar, "net", 0.49),
    ("plate/lattice", Form::Plate, "lattice", 0.25),
    ("plate/continuum/0.25", Form::Plate, "continuum", 0.25),
    ("plate/continuum/0.49", Form::Plate, "continuum", 0.49),
    ("plate/net/0.25", Form::Plate, "net", 0.25),
    ("plate/net/0.49", Form::Plate, "net", 0.49),
];

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    let quick = effort == Effort::Quick;
    for (name, form, model, poisson) in BODIES {
        for (young_pa, label) in YOUNG_PA {
            let case = format!("motion/ring/{name}/{label}");
            let hurried = quick && (young_pa < 20e3 || model != "continuum");
            if wanted(&case) && !hurried {
                rung(&case, &Ring::new(form, model, young_pa, poisson), out);
            }
        }
    }
}

/// A strip, and where its points start.
struct Ring {
    form: Form,
    strip: Strip,
}

impl Ring {
    fn new(form: Form, model: &'static str, young_pa: f64, poisson: f64) -> Self {
        let clamped = Strip {
            poisson,
            ..Strip::clamped(model, young_pa)
        };
        let strip = match form {
            Form::Beam => clamped,
            Form::Bar => Strip {
                fixed: "",
                ..clamped
            },
            Form::Plate => Strip {
                counts: [11, 11],
                layers: 2,
                width_m: LENGTH_M,
                thickness_m: THIN_M,
                fixed: "fixed = [{ u = [0.0, 0.05], v = [0.0, 1.0] }, { u = [0.95, 1.0], v = [0.0, 1.0] }, \
                        { u = [0.0, 1.0], v = [0.0, 0.05] }, { u = [0.0, 1.0], v = [0.95, 1.0] }]",
                ..clamped
            },
        };
        Self { form, strip }
    }

    /// From where a point rests to where it starts, m. Sections of beams and bars stay across.
    fn shape(&self, p: &Point3) -> Vector3 {
        let s = p.x / LENGTH_M;
        let (out_m, slope) = match self.form {
            Form::Plate => {
                let across = clamped_beam(1.0, p.y / LENGTH_M + 0.5);
                return Vector3::z() * (PLATE_M * clamped_beam(1.0, s) * across);
            }
            Form::Beam => {
                let slope = 1.5 * BENT_M * (2.0 * s - s * s) / LENGTH_M;
                (0.5 * BENT_M * s * s * (3.0 - s), slope)
            }
            Form::Bar => {
                let (value, slope) = free_beam(s);
                (BENT_M * value, BENT_M * slope / LENGTH_M)
            }
        };
        let above_m = p.z + 0.5 * self.strip.thickness_m;
        Vector3::new(-slope * above_m, 0.0, out_m)
    }

    fn world(&self, setting: Setting) -> Result<World, String> {
        World::new(&self.strip.text(&setting.text()))
    }

    fn start(&self, body: &Deformable) -> DeformableState {
        let mut state = body.rest_state();
        for (c, place) in state.positions.iter_mut().enumerate() {
            if body.unknown(c).is_some() {
                *place += self.shape(place);
            }
        }
        state
    }

    /// The amplitude of a state, kg·m².
    fn amplitude(&self, body: &Deformable, state: &DeformableState) -> f64 {
        let points = state.positions.iter().zip(body.rest()).zip(body.masses());
        points
            .map(|((now, rest), m)| m * (now - rest).dot(&self.shape(rest)))
            .sum()
    }

    /// Amplitudes of the exact step over that of the start, until they have died out or swung enough.
    fn exactly(&self) -> Result<Vec<f64>, String> {
        let world = self.world(Setting::auto(1))?;
        let (body, _) = world.body()?;
        let mut state = self.start(body);
        let whole = self.amplitude(body, &state);
        let mut exact = ExactStep::new(body);
        exact.tolerance = 1e-9;
        let none = vec![Vector3::zeros(); state.positions.len()];
        let mut path = vec![1.0];
        while !is_over(&path) {
            let solved = exact.step(&mut state, &none);
            solved.map_err(|why| why.to_string())?;
            path.push(self.amplitude(body, &state) / whole);
        }
        Ok(path)
    }

    /// The same by our step, and what ticks took.
    fn swung(&self, setting: Setting, ticks: usize) -> Result<(Vec<f64>, Vec<f64>), String> {
        let mut world = self.world(setting)?;
        let start = self.start(world.body()?.0);
        let whole = self.amplitude(world.body()?.0, &start);
        world.put(|state| state.positions.clone_from(&start.positions))?;
        let mut path = vec![1.0];
        while path.len() < ticks {
            world.at([0.0, 0.0, 10.0]);
            let (body, state) = world.body()?;
            path.push(self.amplitude(body, state) / whole);
        }
        Ok((path, world.ticks_s))
    }
}

fn is_over(path: &[f64]) -> bool {
    const MOST_TICKS: usize = 10_000;
    let recent = &path[path.len().saturating_sub(50)..];
    let most = recent.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
    most < DEAD || path.len() > MOST_TICKS || crossings(path).len() > ENOUGH
}

/// The softest shape of a beam that nothing holds, 1 at its ends, and its slope.
fn free_beam(s: f64) -> (f64, f64) {
    const BETA: f64 = 4.730_040_744_862_704;
    let ratio = (libm::cosh(BETA) - libm::cos(BETA)) / (libm::sinh(BETA) - libm::sin(BETA));
    let at = BETA * s;
    let (c, s) = (libm::cos(at), libm::sin(at));
    let (ch, sh) = (libm::cosh(at), libm::sinh(at));
    (
        0.5 * (ch + c - ratio * (sh + s)),
        0.5 * BETA * (sh - s - ratio * (ch + c)),
    )
}

fn rung(case: &str, ring: &Ring, out: &mut dyn FnMut(Row)) {
    let exact = match ring.exactly() {
        Ok(path) => path,
        Err(why) => return out(failed(case, "exact step", &why)),
    };
    let right = Swings::of(&exact);
    for setting in [1, 2].map(Setting::auto) {
        let method = setting.method();
        match ring.swung(setting, exact.len()) {
            Ok((path, ticks_s)) => {
                let own = Swings::of(&path);
                let note = format!(
                    "{}, path off by {:.2e} rms of the start, {:.2} s",
                    own.beside(&right, 1e-3),
                    rms(&path, &exact, 1.0),
                    exact.len() as f64 * 1e-3,
                );
                let error = own
                    .period
                    .zip(right.period)
                    .map(|(own, right)| own / right - 1.0);
                out(row(case, &method, ticks_s, (error, "of the period"), note));
            }
            Err(why) => out(failed(case, &method, &why)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_bar_bends_about_its_middle_and_has_its_slope() {
        let h = 1e-6;
        for s in [0.0, 0.2, 0.5, 0.9] {
            let (there, back) = (free_beam(s + h).0, free_beam(s - h).0);
            let slope = (there - back) / (2.0 * h);
            assert!((free_beam(s).1 - slope).abs() < 1e-8, "{s}");
            assert!((free_beam(s).0 - free_beam(1.0 - s).0).abs() < 1e-9, "{s}");
        }
        assert_eq!(free_beam(0.0).0, 1.0);
    }
}
