//! Free rigid bodies with faces, beside rapier3d and MuJoCo: pucks that slide, spin, stand and lean,
//! and balls in a row.
//!
//! All engines have the same bodies and steps of 1 ms. What a case asks has an answer in closed form.
//! The others run with their own softness of contacts, and with contacts as stiff as the step allows;
//! MuJoCo's stiff ones have round cones of friction, and its balls meet as springs. The exact slide
//! is that of steps of 1 ms; an engine that takes substeps goes up to 0.1 % farther.

mod engines;
mod setup;

use self::engines::{Frame, Outcome, outcomes};
use self::setup::{
    BALL_M, DENSITY_KG_M3, DT_S, GRAVITY_M_S2, HEIGHT_M, Motion, RADIUS_M, Setup, Thing,
};
use super::Suite;
use crate::measure::Times;
use crate::table::seconds;
use crate::{Effort, Row};
use palpate_geometry::math::Vector3;

/// Between the pucks of a stack before they fall on each other, m.
const GAP_M: f64 = 2e-5;
/// Of a stack and a slope.
const MU: f64 = 0.3;
/// A puck stands on another if it is no farther from where it should be, m.
const STANDS_M: f64 = 5e-4;
/// At the end of a run, ticks in which speeds are looked at.
const LAST: usize = 100;

/// What is asked of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Question {
    Slide,
    Spin,
    Stack,
    Ratio,
    Cradle,
    Slope,
}

/// What a run answered.
struct Answer {
    error: Option<f64>,
    unit: &'static str,
    note: String,
}

impl Suite<'_> {
    pub(super) fn rigid(&mut self, wanted: &dyn Fn(&str) -> bool) {
        for (name, question, setup) in cases() {
            let case = format!("rigid/{name}");
            let too_long = self.effort == Effort::Quick && name == "stack/10";
            if too_long || !wanted(&case) {
                continue;
            }
            for outcome in outcomes(&setup) {
                (self.out)(row(&case, question, &setup, outcome));
            }
        }
    }
}

fn cases() -> Vec<(&'static str, Question, Setup)> {
    vec![
        ("slide", Question::Slide, slide()),
        ("spin", Question::Spin, spin()),
        ("stack/2", Question::Stack, stack(&[DENSITY_KG_M3; 2])),
        ("stack/5", Question::Stack, stack(&[DENSITY_KG_M3; 5])),
        ("stack/10", Question::Stack, stack(&[DENSITY_KG_M3; 10])),
        ("ratio/100", Question::Ratio, stack(&[1e3, 1e5])),
        ("ratio/1000", Question::Ratio, stack(&[1e2, 1e5])),
        ("cradle", Question::Cradle, cradle()),
        ("slope", Question::Slope, slope()),
    ]
}

fn slide() -> Setup {
    let puck = Thing {
        velocity_m_s: [0.6, 0.0, 0.0],
        ..Thing::puck(0.0, DENSITY_KG_M3)
    };
    Setup::on_floor(vec![puck], 0.1, 200)
}

fn spin() -> Setup {
    let puck = Thing {
        spin_rad_s: [0.0, 0.0, 5.0],
        ..Thing::puck(5e-5, DENSITY_KG_M3)
    };
    Setup::on_floor(vec![puck], 0.3, 200)
}

/// Pucks of these densities on each other, the first the lowest.
fn stack(densities_kg_m3: &[f64]) -> Setup {
    let pucks = densities_kg_m3.iter().enumerate();
    let pucks =
        pucks.map(|(k, density)| Thing::puck(GAP_M + (HEIGHT_M + GAP_M) * k as f64, *density));
    Setup::on_floor(pucks.collect(), MU, 2_000)
}

/// The first ball comes from 1 mm away, and the others are in touch.
fn cradle() -> Setup {
    let ball = |k: u8| {
        let (speed, gap_m) = if k == 0 { (0.5, 1e-3) } else { (0.0, 0.0) };
        Thing {
            velocity_m_s: [speed, 0.0, 0.0],
            ..Thing::ball(2.0 * BALL_M * f64::from(k) - gap_m)
        }
    };
    Setup {
        gravity_m_s2: [0.0; 3],
        restitution: 1.0,
        floor: false,
        ..Setup::on_floor((0..6).map(ball).collect(), 0.0, 200)
    }
}

/// Gravity leans, and the floor is level.
fn slope() -> Setup {
    let lean = 0.9 * libm::atan(MU);
    let [x, z] = [libm::sin(lean), -libm::cos(lean)].map(|part| GRAVITY_M_S2 * part);
    Setup {
        gravity_m_s2: [x, 0.0, z],
        ..Setup::on_floor(vec![Thing::puck(0.0, DENSITY_KG_M3)], MU, 1_000)
    }
}

fn row(case: &str, question: Question, setup: &Setup, outcome: Outcome) -> Row {
    let row = Row {
        peer: outcome.peer,
        ..Row::new("contact", case, outcome.method)
    };
    match outcome.frames {
        Ok(frames) if frames.len() == setup.ticks => {
            let answer = question.answer(setup, &frames);
            let (times, sleep) = sleep(&frames);
            row.timed(times)
                .off_by(answer.error, answer.unit)
                .saying(format!("{}, {sleep}", answer.note))
        }
        Ok(frames) => row.saying(format!("it took {} ticks", frames.len())),
        Err(why) => row.saying(why),
    }
}

/// What a tick takes while something is awake; and when all fall asleep, and what a tick takes then.
fn sleep(frames: &[Frame]) -> (Option<Times>, String) {
    let awake = frames.iter().rposition(|frame| !frame.asleep);
    // The tick that puts them to sleep is a whole one.
    let whole = awake.map_or(0, |last| last + 2).min(frames.len());
    let of = |frames: &[Frame]| Times::of(frames.iter().map(|frame| frame.took_s).collect());
    let said = match of(&frames[whole..]) {
        Some(times) => format!(
            "asleep after {whole} ticks, then {} a tick",
            seconds(times.median_s)
        ),
        None => "never asleep".to_owned(),
    };
    (of(&frames[..whole]), said)
}

impl Question {
    fn answer(self, setup: &Setup, frames: &[Frame]) -> Answer {
        match self {
            Self::Slide => slid(setup, frames),
            Self::Spin => stopped(frames),
            Self::Stack => stood(setup, frames),
            Self::Ratio => held(setup, frames),
            Self::Cradle => sent_off(frames),
            Self::Slope => crept(frames),
        }
    }
}

/// Where a body was after so many ticks, m.
fn centre(frames: &[Frame], ticks: usize, body: usize) -> Vector3 {
    frames[ticks - 1].bodies[body].centre_m.into()
}

fn slid(setup: &Setup, frames: &[Frame]) -> Answer {
    let ticks = frames.len() as f64;
    let lost_m = 0.1 * GRAVITY_M_S2 * DT_S * DT_S * ticks * (ticks + 1.0) / 2.0;
    let exact_m = 0.6 * DT_S * ticks - lost_m;
    let slid_m = centre(frames, frames.len(), 0).x - setup.things[0].centre_m()[0];
    let tilts = frames.iter().map(|frame| frame.bodies[0].tilt_rad());
    Answer {
        error: Some(100.0 * (slid_m / exact_m - 1.0)),
        unit: "% of the way",
        note: format!("tilts by {:.1e} rad", tilts.fold(0.0, f64::max)),
    }
}

/// A disc whose weight is spread evenly loses (4/3) μ g / R of its spin in a second. On average it
/// does so while it lands, too.
fn stopped(frames: &[Frame]) -> Answer {
    const STILL_RAD_S: f64 = 0.01;
    let exact_s = 5.0 / (4.0 / 3.0 * 0.3 * GRAVITY_M_S2 / RADIUS_M);
    let spin = |frame: &Frame| Vector3::from(frame.bodies[0].spin_rad_s).norm();
    let ticks = frames.iter().position(|frame| spin(frame) < STILL_RAD_S);
    let ticks = ticks.map(|k| k + 1);
    Answer {
        error: ticks.map(|ticks| 100.0 * (DT_S * ticks as f64 / exact_s - 1.0)),
        unit: "% of the time",
        note: match ticks {
            Some(ticks) => format!("stops after {ticks} ticks of {:.1}", exact_s / DT_S),
            None => format!("does not stop in {} ticks", frames.len()),
        },
    }
}

fn stood(setup: &Setup, frames: &[Frame]) -> Answer {
    let top = setup.things.len() - 1;
    let [before, after] = [frames.len() - 1_000, frames.len()].map(|k| centre(frames, k, top));
    Answer {
        error: Some((after - before).xy().norm()),
        unit: "m of creep",
        note: format!(
            "top {:.1e} m from its place, at most {:.1e} m/s at the end, gains {:.1e} J",
            off_place_m(setup, frames),
            fastest_m_s(frames),
            gained_j(setup, frames)
        ),
    }
}

fn held(setup: &Setup, frames: &[Frame]) -> Answer {
    let off_m = off_place_m(setup, frames);
    let said = if off_m < STANDS_M {
        "stands"
    } else {
        "does not stand"
    };
    Answer {
        error: Some(off_m),
        unit: "m from its place",
        note: format!("{said}, at most {:.1e} m/s at the end", fastest_m_s(frames)),
    }
}

/// How far the top of a stack is from where it should be at the end.
fn off_place_m(setup: &Setup, frames: &[Frame]) -> f64 {
    let top = setup.things.len() - 1;
    let should = Vector3::new(0.0, 0.0, HEIGHT_M * (top as f64 + 0.5));
    (centre(frames, frames.len(), top) - should).norm()
}

/// Greatest speed of a body in the last ticks.
fn fastest_m_s(frames: &[Frame]) -> f64 {
    let last = &frames[frames.len() - LAST..];
    let bodies = last.iter().flat_map(|frame| &frame.bodies);
    let speeds = bodies.map(|body| Vector3::from(body.velocity_m_s).norm());
    speeds.fold(0.0, f64::max)
}

/// By how much energy of motion ever exceeds what falling gives.
fn gained_j(setup: &Setup, frames: &[Frame]) -> f64 {
    let gravity = Vector3::from(setup.gravity_m_s2);
    let gained = |frame: &Frame| -> f64 {
        let both = setup.things.iter().zip(&frame.bodies);
        let of = |(thing, body): (&Thing, &Motion)| {
            let fell = Vector3::from(body.centre_m) - Vector3::from(thing.centre_m());
            thing.energy_j(body) - thing.mass_kg() * gravity.dot(&fell)
        };
        both.map(of).sum()
    };
    frames.iter().map(gained).fold(0.0, f64::max)
}

fn sent_off(frames: &[Frame]) -> Answer {
    let bodies = &frames[frames.len() - 1].bodies;
    let speeds: Vec<f64> = bodies.iter().map(|b| b.velocity_m_s[0] / 0.5).collect();
    let last = speeds.len() - 1;
    let off = speeds.iter().enumerate().map(|(k, speed)| {
        let exact = if k == last { 1.0 } else { 0.0 };
        (speed - exact).abs()
    });
    let said: Vec<String> = speeds.iter().map(|speed| format!("{speed:.2}")).collect();
    Answer {
        error: Some(off.fold(0.0, f64::max)),
        unit: "of the speed",
        note: format!("speeds {}", said.join(" ")),
    }
}

fn crept(frames: &[Frame]) -> Answer {
    let [half, end] = [frames.len() / 2, frames.len()].map(|ticks| centre(frames, ticks, 0));
    let tilt = frames[frames.len() - 1].bodies[0].tilt_rad();
    Answer {
        error: Some(1e6 * (end - half).xy().norm()),
        unit: "µm of creep",
        note: format!("tilts by {tilt:.1e} rad"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(setup: &Setup) -> Vec<Frame> {
        engines::ours(setup).unwrap_or_else(|why| panic!("{why}"))
    }

    #[test]
    fn a_slide_and_a_row_of_balls_are_answered() {
        for (question, setup) in [(Question::Slide, slide()), (Question::Cradle, cradle())] {
            let answer = question.answer(&setup, &frames(&setup));
            assert!(
                answer.error.is_some_and(|error| error.abs() < 0.1),
                "{question:?}: {:?}, {}",
                answer.error,
                answer.note
            );
        }
    }

    #[test]
    fn ticks_after_the_last_that_is_awake_are_asleep() {
        let frame = |asleep, took_s| Frame {
            took_s,
            asleep,
            bodies: Vec::new(),
        };
        let [awake, dozes] = [frame(false, 1.0), frame(true, 1.0)];
        let frames = [awake, dozes, frame(true, 1e-6), frame(true, 1e-6)];
        let (times, said) = sleep(&frames);
        assert_eq!(times.map(|times| (times.n, times.median_s)), Some((2, 1.0)));
        assert!(said.starts_with("asleep after 2 ticks"), "{said}");
        assert_eq!(sleep(&frames[..2]).1, "never asleep");
    }
}
