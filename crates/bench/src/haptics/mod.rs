//! The haptics suite: how stiff a wall each device can hold, what energy the loop makes over
//! delays, how near to the analytic force it renders, and how fast and how punctual it is.
//!
//! Devices and hands are simulated, in lockstep with the loop, so all but the last two cases give
//! the same figures everywhere.

mod devices;
mod energy;
mod friction;
mod hands;
mod realtime;
mod render;
mod rig;
mod soak;
mod svg;
mod tools;
mod zwidth;

pub use energy::Trace;
pub use hands::{HandsReport, hands};
pub use svg::{energy_picture, zwidth_picture};
pub use zwidth::WidthCurve;

use super::figure::{Bar, Figure};
use super::{Cases, Effort, processes};

/// What can be drawn of a run.
#[derive(Debug, Default)]
pub struct Drawn {
    /// By device.
    pub widths: Vec<WidthCurve>,
    /// Energy over time, with and without control.
    pub traces: Vec<Trace>,
    /// Cases that could not be measured, with the reason.
    pub failed: Vec<String>,
}

/// Runs cases of the suite. Each figure is handed out as soon
/// as it is measured.
pub fn haptics<'a>(
    effort: Effort,
    cases: impl Into<Cases<'a>>,
    out: &mut dyn FnMut(Figure),
) -> Drawn {
    let cases = cases.into();
    let wanted = |case: &str| cases.has(case);
    let mut drawn = Drawn::default();
    zwidth::run(effort, &wanted, out, &mut drawn.widths);
    energy::run(effort, &wanted, out, &mut drawn.traces);
    if wanted("energy/hands") {
        out(hands::figure(effort));
    }
    tools::run(&wanted, out);
    render::run(&wanted, out);
    friction::run(&wanted, out);
    realtime::run(effort, &wanted, out, &mut drawn.failed);
    devices::run(effort, &wanted, out, &mut drawn.failed);
    // Ten minutes: only when asked for.
    if cases.are_chosen() && (wanted("soak/drift") || wanted("soak/growth")) {
        soak::run(effort, out, &mut drawn.failed);
    }
    drawn
}
