//! Energy that a delayed loop makes, with and without a passivity controller at the device.

use super::rig::{Rig, wall};
use super::{Bar, Figure};
use crate::Effort;
use palpate_client::device::{DeviceModel, Goal, Hand, Passivity, PassivitySettings};

/// Energy that went into the loop over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// What it is of.
    pub name: String,
    /// s, J.
    pub points: Vec<(f64, f64)>,
}

/// One way, s.
const DELAYS_S: [f64; 4] = [0.0, 1e-3, 5e-3, 20e-3];
/// Stiffness of the wall, N/m.
const WALL_N_M: f64 = 2_000.0;

/// What the hand does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Task {
    Press,
    Tap,
    Slide,
}

impl Task {
    pub(super) const ALL: [Self; 3] = [Self::Press, Self::Tap, Self::Slide];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Press => "press",
            Self::Tap => "tap",
            Self::Slide => "slide",
        }
    }

    /// Where the hand wants the device: 15 mm over the wall, down to `depth_m` below it.
    pub(super) fn goal(self, t_s: f64, depth_m: f64) -> Goal {
        let (height, fall) = (0.015, 0.015 + depth_m);
        // Down and up as a raised cosine, each in `rise_s`.
        let stroke = |t_s: f64, down_s: f64, hold_s: f64, rise_s: f64| -> (f64, f64) {
            let turn = |t: f64| {
                let s = (t / rise_s).clamp(0.0, 1.0);
                let rate = if (0.0..1.0).contains(&(t / rise_s)) {
                    1.0 / rise_s
                } else {
                    0.0
                };
                let angle = std::f64::consts::PI * s;
                (
                    0.5 - 0.5 * libm::cos(angle),
                    0.5 * std::f64::consts::PI * libm::sin(angle) * rate,
                )
            };
            let (down, up) = (turn(t_s - down_s), turn(t_s - down_s - rise_s - hold_s));
            (down.0 - up.0, down.1 - up.1)
        };
        let ((share, rate), x, v) = match self {
            Self::Press => (stroke(t_s % 3.0, 0.2, 1.6, 0.5), 0.0, 0.0),
            Self::Tap => (stroke(t_s % 0.5, 0.05, 0.05, 0.12), 0.0, 0.0),
            Self::Slide => {
                let w = std::f64::consts::TAU * 0.5;
                (
                    stroke(t_s, 0.2, 1e9, 0.5),
                    0.03 * libm::sin(w * t_s),
                    0.03 * w * libm::cos(w * t_s),
                )
            }
        };
        Goal::moving([x, 0.0, height - fall * share], [v, 0.0, -fall * rate])
    }
}

pub(super) fn run(
    effort: Effort,
    wanted: &dyn Fn(&str) -> bool,
    out: &mut dyn FnMut(Figure),
    traces: &mut Vec<Trace>,
) {
    let presets: &[&str] = if effort == Effort::Quick {
        &["ideal"]
    } else {
        &["ideal", "touch", "omega.3"]
    };
    for delay_s in DELAYS_S {
        for (control, name) in [(false, "off"), (true, "on")] {
            let case = format!("energy/delay/{}/{name}", (delay_s * 1e3).round());
            if !wanted(&case) {
                continue;
            }
            for preset in presets {
                let model = DeviceModel::preset(preset).unwrap_or_else(|error| panic!("{error}"));
                out(figure(&case, &model, delay_s, control, traces));
            }
        }
    }
}

fn figure(
    case: &str,
    model: &DeviceModel,
    delay_s: f64,
    control: bool,
    traces: &mut Vec<Trace>,
) -> Figure {
    let mut worst = (f64::NEG_INFINITY, String::new());
    let mut ripple: f64 = 0.0;
    for hand in [Hand::light(), Hand::relaxed(), Hand::firm()] {
        for task in Task::ALL {
            let run = session(model, &hand, task, delay_s, control);
            if run.made_j > worst.0 {
                worst = (run.made_j, format!("{} hand, {}", hand.name, task.name()));
            }
            ripple = ripple.max(run.swing_m);
            if model.name == "ideal" && hand.name == "light" && task == Task::Press {
                let name = format!(
                    "{} ms each way, control {}",
                    delay_s * 1e3,
                    if control { "on" } else { "off" }
                );
                traces.push(Trace {
                    name,
                    points: run.trace,
                });
            }
        }
    }
    // What an encoder cannot show, nobody can keep account of: one of its steps at the greatest
    // force, for each contact.
    Figure {
        suite: "haptics",
        case: case.to_owned(),
        method: model.name.clone(),
        value: worst.0,
        unit: "J",
        reference: 0.0,
        reference_is: "passive",
        bar: control.then_some(Bar::AtMost(0.0)),
        note: format!(
            "worst: {}; held still, it moves by {:.2} mm",
            worst.1,
            ripple * 1e3
        ),
    }
}

/// What a session of ten seconds did.
struct Run {
    /// Energy that the loop made, J; below zero: took.
    made_j: f64,
    /// How far the device moved in the last half second of a press, m.
    swing_m: f64,
    trace: Vec<(f64, f64)>,
}

fn session(model: &DeviceModel, hand: &Hand, task: Task, delay_s: f64, control: bool) -> Run {
    let passivity = control.then(|| Passivity::new(PassivitySettings::strict(model)));
    let world = crate::world(&wall(WALL_N_M, 0.0, ""));
    let depth_m = 0.015;
    let start = task.goal(0.0, depth_m).position;
    let mut rig = Rig::new(world, (model, hand), start, delay_s, passivity, 1);
    let (mut trace, mut low, mut high) = (Vec::new(), f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..10_000 {
        let t_s = rig.device.time_s();
        rig.period(task.goal(t_s + 0.5e-3, depth_m));
        if k % 20 == 0 {
            trace.push((t_s, rig.device.energy().loop_j));
        }
        // Held since 0.7 s in every cycle of 3 s, until 2.3 s.
        if task == Task::Press && (1.8..2.3).contains(&(t_s % 3.0)) {
            let z = rig.device.true_position()[2];
            (low, high) = (low.min(z), high.max(z));
        }
    }
    let swing_m = if high > low { high - low } else { 0.0 };
    Run {
        made_j: -rig.device.energy().loop_j,
        swing_m,
        trace,
    }
}
