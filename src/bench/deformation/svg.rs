//! Pictures of the suite: time against force error, and curves.

use super::Row;
use std::fmt::Write;

const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 600.0;
/// Left, top, right and bottom of the plot.
const FRAME: [f64; 4] = [80.0, 40.0, 720.0, 540.0];
const COLOURS: [&str; 10] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f", "#8c564b", "#17becf"];
/// Smaller errors are drawn here: a logarithmic axis has no zero.
const LEAST_ERROR: f64 = 1e-4;

/// How an axis is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scale {
    Linear,
    Decades(Unit),
}

/// What its labels say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Seconds,
    Percent,
}

/// Marks of one colour.
pub(super) struct Curve {
    pub name: String,
    pub points: Vec<(f64, f64)>,
    /// Joined by a line.
    pub lined: bool,
    pub hollow: bool,
    /// (points) or none: what shows under the pointer.
    pub titles: Vec<String>,
}

/// One plot.
pub(super) struct Chart {
    pub title: String,
    pub across: String,
    pub down: String,
    /// Across and down.
    pub scales: [Scale; 2],
    pub curves: Vec<Curve>,
}

/// Median time of a step against the size of the force error, of the rows that have one: an SVG document. A line joins
/// those of ours that nothing of ours beats in both.
pub fn pareto(rows: &[Row]) -> String {
    let shown: Vec<&Row> = rows
        .iter()
        .filter(|row| row.error_unit == "of the force" && row.error.is_finite() && row.median_s > 0.0)
        .collect();
    let place = |row: &Row| (row.median_s, row.error.abs().max(LEAST_ERROR));
    let mut curves: Vec<Curve> = Vec::new();
    for row in &shown {
        let k = curves.iter().position(|curve| curve.name == row.method).unwrap_or_else(|| {
            let (name, hollow) = (row.method.clone(), row.peer);
            curves.push(Curve { name, points: Vec::new(), lined: false, hollow, titles: Vec::new() });
            curves.len() - 1
        });
        curves[k].points.push(place(row));
        curves[k].titles.push(format!("{} {}: {:+.1} %", row.case, row.method, row.error * 100.0));
    }
    let ours: Vec<(f64, f64)> = shown.iter().filter(|row| !row.peer).map(|row| place(row)).collect();
    let mut front: Vec<(f64, f64)> = ours
        .iter()
        .copied()
        .filter(|a| !ours.iter().any(|b| b.0 <= a.0 && b.1 <= a.1 && (b.0 < a.0 || b.1 < a.1)))
        .collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let chart = Chart {
        title: "Pressed bodies: median time of a step against error of the force".to_owned(),
        across: "median time of one step".to_owned(),
        down: "relative error of the force".to_owned(),
        scales: [Scale::Decades(Unit::Seconds), Scale::Decades(Unit::Percent)],
        curves,
    };
    page_with(&[chart], &front)
}

/// Plots below each other, as one SVG document.
pub(super) fn page(charts: &[Chart]) -> String {
    page_with(charts, &[])
}

/// The same; `front` is a thin line in the first.
fn page_with(charts: &[Chart], front: &[(f64, f64)]) -> String {
    let height = HEIGHT * charts.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    for (k, chart) in charts.iter().enumerate() {
        let _ = writeln!(svg, "<g transform=\"translate(0 {})\">", HEIGHT * k as f64);
        draw(chart, if k == 0 { front } else { &[] }, &mut svg);
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

/// Where values lie along an axis, from its first tick to its last.
struct Axis {
    scale: Scale,
    low: f64,
    high: f64,
    ticks: Vec<(f64, String)>,
}

impl Axis {
    fn new(scale: Scale, values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in values.filter(|x| x.is_finite()) {
            let x = if scale == Scale::Linear { x } else { libm::log10(x) };
            (low, high) = (low.min(x), high.max(x));
        }
        let (step, unit) = match scale {
            Scale::Linear => {
                (low, high) = (low.min(0.0), if high.is_finite() { high.max(0.0) } else { 1.0 });
                let span = if high > low { high - low } else { 1.0 };
                let decade = libm::pow(10.0, libm::floor(libm::log10(span / 4.0)));
                let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * decade).into_iter().find(|step| span / step <= 8.0);
                (step.unwrap_or(span), None)
            }
            Scale::Decades(unit) => (1.0, Some(unit)),
        };
        if !low.is_finite() {
            (low, high) = (0.0, step);
        }
        let (first, last) = (libm::floor(low / step), libm::ceil(high / step).max(libm::floor(low / step) + 1.0));
        let ticks = (first as i64..=last as i64).map(|k| {
            let at = k as f64 * step;
            (at, unit.map_or_else(|| rounded(at), |unit| decade(unit, k)))
        });
        Self { scale, low: first * step, high: last * step, ticks: ticks.collect() }
    }

    /// 0 at the first tick, 1 at the last.
    fn share(&self, value: f64) -> f64 {
        let value = if self.scale == Scale::Linear { value } else { libm::log10(value) };
        (value - self.low) / (self.high - self.low)
    }
}

fn rounded(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn decade(unit: Unit, exponent: i64) -> String {
    match unit {
        Unit::Percent => format!("{} %", rounded(libm::pow(10.0, exponent as f64 + 2.0))),
        Unit::Seconds => {
            let (name, least) = match exponent {
                ..=-7 => ("ns", -9),
                -6..=-4 => ("µs", -6),
                -3..=-1 => ("ms", -3),
                0.. => ("s", 0),
            };
            format!("{} {name}", rounded(libm::pow(10.0, (exponent - least) as f64)))
        }
    }
}

fn draw(chart: &Chart, front: &[(f64, f64)], svg: &mut String) {
    let [left, top, right, bottom] = FRAME;
    let points = || chart.curves.iter().flat_map(|curve| &curve.points);
    let x = Axis::new(chart.scales[0], points().map(|p| p.0));
    let y = Axis::new(chart.scales[1], points().map(|p| p.1));
    let across = |value: f64| left + x.share(value) * (right - left);
    let down = |value: f64| bottom - y.share(value) * (bottom - top);
    let middle = (0.5 * (left + right), 0.5 * (top + bottom));
    let _ = writeln!(svg, "<text x=\"{left}\" y=\"24\" font-size=\"16\">{}</text>", escaped(&chart.title));
    for (at, label) in &x.ticks {
        let at = left + (at - x.low) / (x.high - x.low) * (right - left);
        let _ = writeln!(svg, "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"#ddd\"/>");
        let _ = writeln!(svg, "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>", bottom + 18.0);
    }
    for (at, label) in &y.ticks {
        let at = bottom - (at - y.low) / (y.high - y.low) * (bottom - top);
        let _ = writeln!(svg, "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#ddd\"/>");
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>", left - 6.0, at + 4.0);
    }
    let name = escaped(&chart.across);
    let _ = writeln!(svg, "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{name}</text>", middle.0, bottom + 40.0);
    let name = escaped(&chart.down);
    let _ = writeln!(
        svg,
        "<text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">{name}</text>",
        middle.1
    );
    let line = |points: &[(f64, f64)], colour: &str, svg: &mut String| {
        let places: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", across(p.0), down(p.1))).collect();
        let _ = writeln!(svg, "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\"/>", places.join(" "));
    };
    if front.len() > 1 {
        line(front, "#aaa", svg);
    }
    for (k, curve) in chart.curves.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        if curve.lined && curve.points.len() > 1 {
            line(&curve.points, colour, svg);
        }
        for (i, point) in curve.points.iter().enumerate() {
            let title = curve.titles.get(i).unwrap_or(&curve.name);
            mark(svg, across(point.0), down(point.1), colour, curve.hollow, Some(title));
        }
        let at = top + 10.0 + 22.0 * k as f64;
        mark(svg, right + 24.0, at, colour, curve.hollow, None);
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{}\">{}</text>", right + 38.0, at + 4.0, escaped(&curve.name));
    }
}

/// A disc, or a hollow square on its corner.
fn mark(svg: &mut String, x: f64, y: f64, colour: &str, hollow: bool, title: Option<&str>) {
    let title = title.map_or(String::new(), |title| format!("<title>{}</title>", escaped(title)));
    let _ = if hollow {
        writeln!(
            svg,
            "<path d=\"M{x:.1} {:.1}l6 6l-6 6l-6 -6z\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\">{title}</path>",
            y - 6.0
        )
    } else {
        writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\" fill=\"{colour}\" fill-opacity=\"0.75\">{title}</circle>"
        )
    };
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: &str, peer: bool, median_s: f64, error: f64) -> Row {
        Row {
            suite: "deformation",
            case: "indent/12/x1".to_owned(),
            method: method.to_owned(),
            peer,
            median_s,
            p99_s: median_s,
            error,
            error_unit: "of the force",
            n: 1,
            wrong: None,
            note: String::new(),
        }
    }

    #[test]
    fn every_force_has_a_mark_inside_the_frame_and_every_method_a_line_of_the_legend() {
        let rows = [
            row("lattice", false, 3e-4, -0.15),
            row("continuum", false, 7e-4, 0.02),
            row("net", false, 9e-4, 0.5),
            row("a <peer>", true, 1e-2, -0.4),
            row("none", false, f64::NAN, f64::NAN),
            Row { error_unit: "of the volume", ..row("som", false, 3.0, 1e-3) },
        ];
        let svg = pareto(&rows);
        assert_eq!(svg.matches("<circle").count(), 3 + 3, "three marks, three of the legend");
        assert_eq!(svg.matches("stroke-width").count(), 1 + 1);
        assert!(svg.contains("a &lt;peer&gt;") && svg.contains("10 ms") && svg.contains("100 %"), "{svg}");
        assert!(svg.contains("-15.0 %"), "errors keep their signs under the pointer");
        for part in svg.split("<circle cx=\"").skip(1) {
            let x: f64 = part.split('"').next().unwrap().parse().unwrap();
            assert!((FRAME[0]..=WIDTH).contains(&x), "{x}");
        }
        // The front has two of ours: `net` is beaten in both.
        let front = svg.split("<polyline points=\"").nth(1).unwrap().split('"').next().unwrap();
        assert_eq!(front.split(' ').count(), 2, "{front}");
        assert!(pareto(&[]).ends_with("</svg>\n"), "nothing measured is a picture too");
    }

    #[test]
    fn linear_axes_start_at_zero_and_have_round_ticks() {
        let axis = Axis::new(Scale::Linear, [10.0, 60.0].into_iter());
        assert_eq!(axis.ticks.first().map(|t| t.1.as_str()), Some("0"));
        assert_eq!(axis.ticks.last().map(|t| t.1.as_str()), Some("60"));
        assert_eq!(axis.share(60.0), 1.0);
        let flat = Axis::new(Scale::Linear, std::iter::empty());
        assert!(flat.share(0.5).is_finite() && flat.ticks.len() >= 2);
    }
}
