//! The stiffest wall that a device holds without swinging by itself, over the damping of the
//! coupling, beside the lines of theory (Colgate & Brown 1994, "Factors affecting the Z-width of a
//! haptic display").

use super::rig::{Rig, wall};
use super::{Bar, Figure};
use crate::Effort;
use palpate_client::device::{DeviceModel, Goal, Hand, devices};
use palpate_sim::haptics::{DeviceFigures, StiffnessLimits};

/// Measured and theoretical limits of a device over the coupling's damping.
#[derive(Clone, Debug, PartialEq)]
pub struct WidthCurve {
    /// Of the device.
    pub device: String,
    /// Damping of the coupling over that of the device.
    pub damping_share: Vec<f64>,
    /// Stiffest steady wall, N/m.
    pub measured_n_m: Vec<f64>,
    /// 2 (b − B) / (T + 2 t_d), N/m.
    pub sampling_n_m: Vec<f64>,
}

/// Force that presses the device on the wall, N: a weight has no damping that could help.
const WEIGHT_N: f64 = 1.0;
/// Drop above the wall from which it falls, m.
const DROP_M: f64 = 5e-4;
/// What grows by less than this in [`APART_S`] is not called growing.
const STEADY: f64 = 0.98;
const APART_S: f64 = 4.0;
const WINDOW_S: f64 = 1.0;
const SETTLE_S: f64 = 3.0;
/// Multiple of the line beyond which nothing is tried: dry friction may hold any wall.
const SIGHT: f64 = 64.0;

/// Figures of a device for the theory. The lag of its amplifier counts as a delay.
pub(super) fn figures(model: &DeviceModel, dt_s: f64) -> DeviceFigures {
    let lag_s = if model.bandwidth_hz.is_finite() {
        1.0 / (std::f64::consts::TAU * model.bandwidth_hz)
    } else {
        0.0
    };
    DeviceFigures {
        damping_n_s_m: model.damping_n_s_m,
        coulomb_n: model.coulomb_n,
        encoder_m: model.encoder_m,
        period_s: dt_s.max(1.0 / model.rate_hz),
        delay_s: lag_s,
    }
}

pub(super) fn run(
    effort: Effort,
    wanted: &dyn Fn(&str) -> bool,
    out: &mut dyn FnMut(Figure),
    curves: &mut Vec<WidthCurve>,
) {
    let shares: &[f64] = if effort == Effort::Quick {
        &[0.0]
    } else {
        &[0.0, 0.2, 0.4, 0.6, 0.8]
    };
    for model in devices() {
        let case = format!("zwidth/{}", model.name);
        if !wanted(&case) {
            continue;
        }
        let theory = figures(&model, 1e-3);
        // Its lines without and with dry friction: as it is, and as Colgate's line has it.
        let smooth = DeviceModel {
            coulomb_n: 0.0,
            encoder_m: 0.0,
            ..model.clone()
        };
        let mut curve = WidthCurve {
            device: model.name.clone(),
            damping_share: Vec::new(),
            measured_n_m: Vec::new(),
            sampling_n_m: Vec::new(),
        };
        for share in shares {
            let damping = share * model.damping_n_s_m;
            let limits = theory.stiffness_limits(damping);
            let measured = stiffest(&smooth, damping, limits.sampling_n_m);
            curve.damping_share.push(*share);
            curve.measured_n_m.push(measured);
            curve.sampling_n_m.push(limits.sampling_n_m);
        }
        let limits = theory.stiffness_limits(0.0);
        out(figure(
            &case,
            "without dry friction",
            curve.measured_n_m[0],
            limits.sampling_n_m,
            "of 2 b / (T + 2 t)",
        ));
        if model.coulomb_n > 0.0 || model.encoder_m > 0.0 {
            let StiffnessLimits {
                quantization_n_m, ..
            } = limits;
            let passive = limits.passive_n_m();
            let measured = stiffest(&model, 0.0, passive);
            let mut row = figure(
                &case,
                "as it is",
                measured,
                passive,
                "of min(2 b / (T + 2 t), 2 f / Δ)",
            );
            let more = if measured >= SIGHT * passive {
                ", and not looked beyond"
            } else {
                ""
            };
            row.note = format!("{}; 2 f / Δ = {quantization_n_m:.0} N/m{more}", row.note);
            out(row);
        }
        curves.push(curve);
    }
}

fn figure(
    case: &str,
    method: &str,
    measured_n_m: f64,
    line_n_m: f64,
    reference_is: &'static str,
) -> Figure {
    Figure {
        suite: "haptics",
        case: case.to_owned(),
        method: method.to_owned(),
        value: measured_n_m / line_n_m,
        unit: "1",
        reference: 1.0,
        reference_is,
        bar: Some(Bar::AtLeast(0.9)),
        note: format!("{measured_n_m:.0} N/m, line {line_n_m:.0} N/m"),
    }
}

/// Bisection between a steady and a swinging wall, to 0.5 %; what is steady at [`SIGHT`] times the
/// line is not looked beyond.
fn stiffest(model: &DeviceModel, damping_n_s_m: f64, line_n_m: f64) -> f64 {
    let (mut low, mut high) = (0.0, line_n_m * 0.25);
    while is_steady(model, high, damping_n_s_m) {
        low = high;
        high *= 2.0;
        if high > SIGHT * line_n_m {
            return low;
        }
    }
    while high - low > 5e-3 * high {
        let middle = 0.5 * (low + high);
        if is_steady(model, middle, damping_n_s_m) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// A device that falls on the wall comes to rest on it, or comes nearer to rest.
fn is_steady(model: &DeviceModel, stiffness_n_m: f64, damping_n_s_m: f64) -> bool {
    // A spring so soft that it is a weight.
    let hand = Hand {
        stiffness_n_m: 1e-3,
        ..Hand::absent()
    };
    let world = crate::world(&wall(stiffness_n_m, damping_n_s_m, ""));
    let start = [0.0, 0.0, DROP_M];
    let mut rig = Rig::new(world, (model, &hand), start, 0.0, None, 1);
    let goal = Goal::at([0.0, 0.0, -WEIGHT_N / hand.stiffness_n_m]);
    let ticks = |seconds: f64| (seconds * 1e3) as usize;
    let swing = |rig: &mut Rig| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for _ in 0..ticks(WINDOW_S) {
            rig.period(goal);
            let z = rig.device.true_position()[2];
            (low, high) = (low.min(z), high.max(z));
        }
        high - low
    };
    for _ in 0..ticks(SETTLE_S) {
        rig.period(goal);
    }
    let first = swing(&mut rig);
    for _ in 0..ticks(APART_S - WINDOW_S) {
        rig.period(goal);
    }
    let last = swing(&mut rig);
    last <= 3.0 * model.encoder_m + 1e-7 || last < STEADY * first
}
