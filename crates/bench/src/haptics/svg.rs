//! Pictures of the suite.

use super::{Trace, WidthCurve};
use palpate_record::chart::{Chart, Curve, Scale, Unit, page};

fn curve(name: String, points: Vec<(f64, f64)>, lined: bool, hollow: bool) -> Curve {
    Curve {
        name,
        points,
        lined,
        hollow,
        titles: Vec::new(),
    }
}

/// Stiffest steady walls over the damping of the coupling, measured (marks) and by theory (lines):
/// an SVG document.
pub fn zwidth_picture(widths: &[WidthCurve]) -> String {
    let mut curves = Vec::new();
    for width in widths {
        let points = |values: &[f64]| {
            width
                .damping_share
                .iter()
                .copied()
                .zip(values.iter().copied())
                .collect()
        };
        curves.push(curve(
            width.device.clone(),
            points(&width.measured_n_m),
            false,
            false,
        ));
        curves.push(curve(
            format!("{} (theory)", width.device),
            points(&width.sampling_n_m),
            true,
            true,
        ));
    }
    page(&[Chart {
        title: "Stiffest wall that does not swing by itself".to_owned(),
        across: "damping of the coupling / damping of the device".to_owned(),
        down: "stiffness of the coupling, N/m".to_owned(),
        scales: [Scale::Linear, Scale::Decades(Unit::Plain)],
        curves,
    }])
}

/// Energy that went into the loop over time: an SVG document.
pub fn energy_picture(traces: &[Trace]) -> String {
    let chart = |title: &str, part: &str| Chart {
        title: title.to_owned(),
        across: "time, s".to_owned(),
        down: "energy that went into the loop, J (below 0: it was made)".to_owned(),
        scales: [Scale::Linear, Scale::Linear],
        curves: traces
            .iter()
            .filter(|trace| trace.name.ends_with(part))
            .map(|trace| curve(trace.name.clone(), trace.points.clone(), true, false))
            .collect(),
    };
    page(&[
        chart(
            "A light hand presses a wall of 2000 N/m behind a delay, without passivity control",
            "off",
        ),
        chart("The same with passivity control at the device", "on"),
    ])
}
