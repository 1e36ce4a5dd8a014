//! Plots as SVG: linear or logarithmic axes, a colour and a line of the legend for each curve.
//! Each mark says under the pointer what it is, which the crate `plotters` does not write.

use std::fmt::Write;

/// Width of a page, units of the SVG.
pub const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 600.0;
/// Left, top, right and bottom of the plot.
pub const FRAME: [f64; 4] = [80.0, 40.0, 720.0, 540.0];
/// Marks on a line at most; a line of more points has none.
const MOST_MARKS: usize = 64;
/// As many as a suite has methods.
pub(crate) const COLOURS: [&str; 16] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f",
    "#8c564b", "#17becf", "#4b0082", "#ff5c8a", "#7cb518", "#6b4c9a", "#b8860b", "#003f5c",
];

/// How an axis is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Even steps of 1, 2 or 5.
    Linear,
    /// A power of ten a step.
    Decades(Unit),
}

/// What its labels say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Seconds, with their prefixes.
    Seconds,
    /// Of a ratio.
    Percent,
    /// The power of ten alone.
    Plain,
}

/// Marks of one colour.
pub struct Curve {
    /// In the legend.
    pub name: String,
    /// Across and down.
    pub points: Vec<(f64, f64)>,
    /// Joined by a line.
    pub lined: bool,
    /// Marks are outlines.
    pub hollow: bool,
    /// (points) or none: what shows under the pointer.
    pub titles: Vec<String>,
}

/// One plot.
pub struct Chart {
    /// Above it.
    pub title: String,
    /// Name of the axis across.
    pub across: String,
    /// Name of the axis down.
    pub down: String,
    /// Across and down.
    pub scales: [Scale; 2],
    /// In the order of the legend.
    pub curves: Vec<Curve>,
}

/// Plots below each other, as one SVG document.
pub fn page(charts: &[Chart]) -> String {
    page_with(charts, &[])
}

/// The same; `front` is a thin line in the first.
pub fn page_with(charts: &[Chart], front: &[(f64, f64)]) -> String {
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
pub(crate) struct Axis {
    scale: Scale,
    /// First tick, as a power of ten where the axis has decades.
    pub low: f64,
    /// Last tick.
    pub high: f64,
    /// Where they are, and what they say.
    pub ticks: Vec<(f64, String)>,
}

impl Axis {
    /// The axis that has room for finite `values`.
    pub fn new(scale: Scale, values: impl Iterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in values.filter(|x| x.is_finite()) {
            let x = if scale == Scale::Linear {
                x
            } else {
                libm::log10(x)
            };
            (low, high) = (low.min(x), high.max(x));
        }
        let (step, unit) = match scale {
            Scale::Linear => {
                (low, high) = (
                    low.min(0.0),
                    if high.is_finite() { high.max(0.0) } else { 1.0 },
                );
                let span = if high > low { high - low } else { 1.0 };
                let decade = libm::pow(10.0, libm::floor(libm::log10(span / 4.0)));
                let step = [1.0, 2.0, 5.0, 10.0]
                    .map(|k| k * decade)
                    .into_iter()
                    .find(|step| span / step <= 8.0);
                (step.unwrap_or(span), None)
            }
            Scale::Decades(unit) => (1.0, Some(unit)),
        };
        if !low.is_finite() {
            (low, high) = (0.0, step);
        }
        let (first, last) = (
            libm::floor(low / step),
            libm::ceil(high / step).max(libm::floor(low / step) + 1.0),
        );
        let ticks = (first as i64..=last as i64).map(|k| {
            let at = k as f64 * step;
            (at, unit.map_or_else(|| rounded(at), |unit| decade(unit, k)))
        });
        Self {
            scale,
            low: first * step,
            high: last * step,
            ticks: ticks.collect(),
        }
    }

    /// 0 at the first tick, 1 at the last.
    pub fn share(&self, value: f64) -> f64 {
        let value = if self.scale == Scale::Linear {
            value
        } else {
            libm::log10(value)
        };
        (value - self.low) / (self.high - self.low)
    }
}

fn rounded(value: f64) -> String {
    let text = format!("{value:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn decade(unit: Unit, exponent: i64) -> String {
    match unit {
        Unit::Plain => format!("1e{exponent}"),
        Unit::Percent => format!("{} %", rounded(libm::pow(10.0, exponent as f64 + 2.0))),
        Unit::Seconds => {
            let (name, least) = match exponent {
                ..=-7 => ("ns", -9),
                -6..=-4 => ("µs", -6),
                -3..=-1 => ("ms", -3),
                0.. => ("s", 0),
            };
            format!(
                "{} {name}",
                rounded(libm::pow(10.0, (exponent - least) as f64))
            )
        }
    }
}

/// A line of the grid from top to bottom, with a label below if it has one.
pub(crate) fn line_down(svg: &mut String, at: f64, [top, bottom]: [f64; 2], label: &str) {
    let _ = writeln!(svg, "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"#ddd\"/>");
    if !label.is_empty() {
        let _ = writeln!(
            svg,
            "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
            bottom + 18.0
        );
    }
}

/// An axis at the left of a frame: lines across with their labels, and its name.
pub(crate) fn axis_down(svg: &mut String, frame: [f64; 4], y: &Axis, name: &str) {
    let [left, top, right, bottom] = frame;
    for (at, label) in &y.ticks {
        let at = bottom - (at - y.low) / (y.high - y.low) * (bottom - top);
        let _ = writeln!(svg, "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#ddd\"/>");
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{label}</text>",
            left - 6.0,
            at + 4.0
        );
    }
    let (middle, name) = (0.5 * (top + bottom), escaped(name));
    let _ = writeln!(
        svg,
        "<text transform=\"translate(20 {middle}) rotate(-90)\" text-anchor=\"middle\">{name}</text>"
    );
}

fn draw(chart: &Chart, front: &[(f64, f64)], svg: &mut String) {
    let [left, top, right, bottom] = FRAME;
    let points = || chart.curves.iter().flat_map(|curve| &curve.points);
    let x = Axis::new(chart.scales[0], points().map(|p| p.0));
    let y = Axis::new(chart.scales[1], points().map(|p| p.1));
    let across = |value: f64| left + x.share(value) * (right - left);
    let down = |value: f64| bottom - y.share(value) * (bottom - top);
    let _ = writeln!(
        svg,
        "<text x=\"{left}\" y=\"24\" font-size=\"16\">{}</text>",
        escaped(&chart.title)
    );
    for (at, label) in &x.ticks {
        let at = left + (at - x.low) / (x.high - x.low) * (right - left);
        line_down(svg, at, [top, bottom], label);
    }
    let name = escaped(&chart.across);
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{name}</text>",
        0.5 * (left + right),
        bottom + 40.0
    );
    axis_down(svg, FRAME, &y, &chart.down);
    let line = |points: &[(f64, f64)], colour: &str, svg: &mut String| {
        let places: Vec<String> = points
            .iter()
            .map(|p| format!("{:.1},{:.1}", across(p.0), down(p.1)))
            .collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\"/>",
            places.join(" ")
        );
    };
    if front.len() > 1 {
        line(front, "#aaa", svg);
    }
    for (k, curve) in chart.curves.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        if curve.lined && curve.points.len() > 1 {
            line(&curve.points, colour, svg);
        }
        // Many marks on a line hide it.
        let marked = !curve.lined || curve.points.len() <= MOST_MARKS;
        for (i, point) in curve.points.iter().enumerate().filter(|_| marked) {
            let title = curve.titles.get(i).unwrap_or(&curve.name);
            mark(
                svg,
                across(point.0),
                down(point.1),
                colour,
                curve.hollow,
                Some(title),
            );
        }
        let at = top + 10.0 + 22.0 * k as f64;
        mark(svg, right + 24.0, at, colour, curve.hollow, None);
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\">{}</text>",
            right + 38.0,
            at + 4.0,
            escaped(&curve.name)
        );
    }
}

/// A disc, or a hollow square on its corner.
fn mark(svg: &mut String, x: f64, y: f64, colour: &str, hollow: bool, title: Option<&str>) {
    let title = title.map_or(String::new(), |title| {
        format!("<title>{}</title>", escaped(title))
    });
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

/// Text as it stands in XML.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

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
