//! Picture of the suite: time against force error, and against error of the motion.

use super::{Row, TrustRow, motion};
use crate::Deviation;
use palpate_record::chart::{Chart, Curve, Scale, Unit, page_with};

/// Smaller errors are drawn here: a logarithmic axis has no zero.
const LEAST_ERROR: f64 = 1e-4;

/// Median time of a step against the size of the force error, of the rows that have one, and below
/// it against that of the motion, if any has one: an SVG document. A line joins those forces of ours
/// that nothing of ours beats in both.
pub fn pareto(rows: &[Row]) -> String {
    let of = |units: &[&str]| -> Vec<&Row> {
        rows.iter()
            .filter(|row| {
                let drawn =
                    |error: &Deviation| units.contains(&error.unit) && error.value.is_finite();
                row.error.as_ref().is_some_and(drawn) && row.times.is_some()
            })
            .collect()
    };
    let (shown, moving) = (of(&["of the force"]), of(&motion::UNITS));
    let ours: Vec<(f64, f64)> = shown
        .iter()
        .filter(|row| !row.peer)
        .filter_map(|&row| place(row))
        .collect();
    let mut front: Vec<(f64, f64)> = ours
        .iter()
        .copied()
        .filter(|a| {
            !ours
                .iter()
                .any(|b| b.0 <= a.0 && b.1 <= a.1 && (b.0 < a.0 || b.1 < a.1))
        })
        .collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut charts = vec![panel(
        &shown,
        "Pressed bodies: median time of a step against error of the force",
        "relative error of the force",
    )];
    if !moving.is_empty() {
        charts.push(panel(
            &moving,
            "Moving bodies: median time of a tick against error of the path, exact step of the same dt",
            "rms error over amplitude or peak",
        ));
    }
    page_with(&charts, &front)
}

/// How soon a pose is answered, and how well, for one pressed body: an SVG document. Of the whole loop, the
/// time from a client's pose to its force over the bus; of solvers alone, a step, which is the least that any
/// loop around them takes. A line marks the period of 1 kHz.
pub fn latency_picture(rows: &[Row]) -> String {
    let shown: Vec<&Row> = rows
        .iter()
        .filter(|row| row.case == "indent/12/x1")
        .collect();
    let title = "Pressed box: time from pose to force against error of the force";
    let mut chart = panel(&shown, title, "relative error of the force");
    chart.across = "median time from pose to force; of solvers alone, of one step".to_owned();
    for curve in &mut chart.curves {
        if curve.name == super::indent::WHOLE_LOOP {
            curve.name = "continuum, over Zenoh".to_owned();
        }
    }
    chart.curves.push(Curve {
        name: "period of 1 kHz".to_owned(),
        points: vec![(1e-3, LEAST_ERROR), (1e-3, 1.0)],
        lined: true,
        hollow: true,
        titles: Vec::new(),
    });
    page_with(&[chart], &[])
}

/// True errors of forces against their estimates, a colour a body: an SVG document. Between the two lines an estimate is
/// at least half of the error and at most five times it.
pub fn trust_picture(rows: &[TrustRow]) -> String {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows {
        // The body: the end of the case's name.
        let parts: Vec<&str> = row.case.rsplitn(3, '/').collect();
        let name = match parts[..] {
            [poisson, model, _] => format!("{model} {poisson}"),
            _ => row.case.clone(),
        };
        let k = curves.iter().position(|curve| curve.name == name);
        let k = k.unwrap_or_else(|| {
            curves.push(Curve {
                name,
                points: Vec::new(),
                lined: false,
                hollow: true,
                titles: Vec::new(),
            });
            curves.len() - 1
        });
        for (off, said) in &row.points {
            let shown = [*said, *off].map(|share| share.clamp(LEAST_ERROR, 10.0));
            curves[k].points.push((shown[0], shown[1]));
            curves[k]
                .titles
                .push(format!("{}, {} it", row.case, row.iterations));
        }
    }
    for (name, times) in [("2 × estimate", 2.0), ("estimate / 5", 0.2)] {
        curves.push(Curve {
            name: name.to_owned(),
            points: vec![(LEAST_ERROR, times * LEAST_ERROR), (1.0, times)],
            lined: true,
            hollow: true,
            titles: Vec::new(),
        });
    }
    page_with(
        &[Chart {
            title: "How far a force is from that of the exact step: true error against estimate"
                .to_owned(),
            across: "estimate over force".to_owned(),
            down: "true error over force".to_owned(),
            scales: [Scale::Decades(Unit::Percent), Scale::Decades(Unit::Percent)],
            curves,
        }],
        &[],
    )
}

/// Where a row stands.
fn place(row: &Row) -> Option<(f64, f64)> {
    Some((row.times?.median_s, row.error_size()?.max(LEAST_ERROR)))
}

/// Marks of rows, a colour a method.
fn panel(rows: &[&Row], title: &str, down: &str) -> Chart {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows {
        let (Some(at), Some(error)) = (place(row), row.error) else {
            continue;
        };
        let k = curves
            .iter()
            .position(|curve| curve.name == row.method)
            .unwrap_or_else(|| {
                let (name, hollow) = (row.method.clone(), row.peer);
                curves.push(Curve {
                    name,
                    points: Vec::new(),
                    lined: false,
                    hollow,
                    titles: Vec::new(),
                });
                curves.len() - 1
            });
        curves[k].points.push(at);
        curves[k].titles.push(format!(
            "{} {}: {:+.1} %",
            row.case,
            row.method,
            error.value * 100.0
        ));
    }
    Chart {
        title: title.to_owned(),
        across: "median time of one step".to_owned(),
        down: down.to_owned(),
        scales: [Scale::Decades(Unit::Seconds), Scale::Decades(Unit::Percent)],
        curves,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Times;
    use palpate_record::chart::{FRAME, WIDTH};

    fn row(method: &str, peer: bool, median_s: f64, error: f64) -> Row {
        let times = Times {
            median_s,
            p99_s: median_s,
            n: 1,
        };
        Row {
            peer,
            ..Row::new("deformation", "indent/12/x1", method)
                .timed(times)
                .off_by(error, "of the force")
        }
    }

    #[test]
    fn every_force_has_a_mark_inside_the_frame_and_every_method_a_line_of_the_legend() {
        let rows = [
            row("lattice", false, 3e-4, -0.15),
            row("continuum", false, 7e-4, 0.02),
            row("net", false, 9e-4, 0.5),
            row("a <peer>", true, 1e-2, -0.4),
            Row::new("deformation", "indent/12/x1", "none"),
            row("som", false, 3.0, 0.0).off_by(1e-3, "of the volume"),
        ];
        let svg = pareto(&rows);
        assert_eq!(
            svg.matches("<circle").count(),
            3 + 3,
            "three marks, three of the legend"
        );
        assert_eq!(svg.matches("stroke-width").count(), 1 + 1);
        assert!(
            svg.contains("a &lt;peer&gt;") && svg.contains("10 ms") && svg.contains("100 %"),
            "{svg}"
        );
        assert!(
            svg.contains("-15.0 %"),
            "errors keep their signs under the pointer"
        );
        for part in svg.split("<circle cx=\"").skip(1) {
            let x: f64 = part.split('"').next().unwrap().parse().unwrap();
            assert!((FRAME[0]..=WIDTH).contains(&x), "{x}");
        }
        // The front has two of ours: `net` is beaten in both.
        let front = svg
            .split("<polyline points=\"")
            .nth(1)
            .unwrap()
            .split('"')
            .next()
            .unwrap();
        assert_eq!(front.split(' ').count(), 2, "{front}");
        assert!(
            pareto(&[]).ends_with("</svg>\n"),
            "nothing measured is a picture too"
        );
    }
    #[test]
    fn motion_has_a_panel_of_its_own_below_the_forces() {
        let moving = row("palpate 1 it", false, 5e-5, 0.0).off_by(0.005, "of the amplitude");
        let svg = pareto(&[row("lattice", false, 3e-4, -0.15), moving]);
        assert_eq!(svg.matches("<g transform").count(), 2);
        assert!(
            svg.contains("Moving bodies") && svg.contains("palpate 1 it: +0.5 %"),
            "{svg}"
        );
        assert!(!pareto(&[row("lattice", false, 3e-4, -0.15)]).contains("Moving bodies"));
    }
}
