//! Panels below each other over one axis of time: quantities of tools, then tick time.

use super::super::chart::{Axis, COLOURS, Scale, axis_down, escaped, line_down};
use super::super::reader::Session;
use super::series::{Bucket, BucketedCurve, Series, series};
use super::{ExportError, Range};
use std::fmt::Write;

const WIDTH: f64 = 1000.0;
const LEFT: f64 = 90.0;
const RIGHT: f64 = 840.0;
const TOP: f64 = 50.0;
/// Height of a panel, and from one to the next.
const PANEL: f64 = 180.0;
const PITCH: f64 = 210.0;

struct Panel<'a> {
    name: String,
    curves: &'a [BucketedCurve],
    /// Units of the axis in one of SI.
    scale: f64,
    /// A line across, in SI, with its name.
    line: Option<(f64, &'static str)>,
}

/// Plots of a range as SVG, of quantities by their names ([`USUAL`](super::USUAL) or others).
///
/// # Errors
/// A name that there is not, no tick in the range, or a file that cannot be read.
pub fn plots(
    session: &Session,
    range: &Range,
    title: &str,
    names: &[impl AsRef<str>],
) -> Result<String, ExportError> {
    Ok(page(title, &series(session, range, names)?))
}

fn page(title: &str, series: &Series) -> String {
    let of_tools = series.panels.iter().map(|panel| {
        let (name, unit) = (panel.number.name(), panel.number.quantity().unit);
        // What hands do is millimetres and millijoules.
        let (scale, milli) = match unit {
            "m" | "J" => (1e3, "m"),
            _ => (1.0, ""),
        };
        Panel {
            name: match unit {
                "" => name.to_owned(),
                _ => format!("{name}, {milli}{unit}"),
            },
            curves: &panel.curves,
            scale,
            line: None,
        }
    });
    let mut panels: Vec<Panel<'_>> = of_tools.collect();
    panels.push(Panel {
        name: "tick time, µs".into(),
        curves: std::slice::from_ref(&series.tick_s),
        scale: 1e6,
        line: Some((series.dt_s, "due")),
    });
    let height = TOP + PITCH * panels.len() as f64 + 30.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"white\"/>\n\
         <text x=\"{LEFT}\" y=\"24\" font-size=\"16\">{}</text>\n",
        escaped(title)
    );
    for (k, panel) in panels.iter().enumerate() {
        let last = k + 1 == panels.len();
        draw(&mut svg, panel, series.span_s, TOP + PITCH * k as f64, last);
    }
    svg.push_str("</svg>\n");
    svg
}

fn draw(svg: &mut String, panel: &Panel<'_>, span_s: [f64; 2], top: f64, last: bool) {
    let bottom = top + PANEL;
    // Times are drawn from the first tick to the last; the axis finds round numbers between them.
    let [begin, end] = [span_s[0], span_s[1].max(span_s[0] + 1e-9)];
    let across = |t_s: f64| LEFT + (t_s - begin) / (end - begin) * (RIGHT - LEFT);
    let buckets = || {
        panel
            .curves
            .iter()
            .flat_map(|curve| curve.pieces.iter().flatten())
    };
    let values = buckets()
        .flat_map(|bucket| [bucket.least, bucket.most])
        .chain(panel.line.map(|line| line.0));
    let y = Axis::new(Scale::Linear, values.map(|value| value * panel.scale));
    let down = |value: f64| bottom - y.share(value * panel.scale) * (bottom - top);
    for (t_s, label) in times(begin, end) {
        let label = if last { label.as_str() } else { "" };
        line_down(svg, across(t_s), [top, bottom], label);
    }
    axis_down(svg, [LEFT, top, RIGHT, bottom], &y, &panel.name);
    if last {
        let middle = 0.5 * (LEFT + RIGHT);
        let _ = writeln!(
            svg,
            "<text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">t, s</text>",
            bottom + 38.0
        );
    }
    if let Some((value, name)) = panel.line {
        let at = down(value);
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {at:.1}H{RIGHT}\" stroke=\"#777\" stroke-dasharray=\"6 4\"/>"
        );
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{:.1}\">{name}</text>",
            RIGHT + 6.0,
            at + 4.0
        );
    }
    for (k, curve) in panel.curves.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        for piece in &curve.pieces {
            let places = outline(piece, across, down);
            let _ = writeln!(
                svg,
                "<polyline points=\"{places}\" fill=\"none\" stroke=\"{colour}\"/>"
            );
        }
        let at = top + 10.0 + 16.0 * k as f64;
        let _ = writeln!(
            svg,
            "<path d=\"M{} {at}h14\" stroke=\"{colour}\" stroke-width=\"3\"/>",
            RIGHT + 20.0
        );
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\">{}</text>",
            RIGHT + 40.0,
            at + 4.0,
            escaped(&curve.name)
        );
    }
}

/// Up and down through each bucket; a bucket that is flat is one point.
fn outline(piece: &[Bucket], across: impl Fn(f64) -> f64, down: impl Fn(f64) -> f64) -> String {
    let mut places = String::new();
    for bucket in piece {
        let x = across(bucket.t_s);
        let (least, most) = (down(bucket.least), down(bucket.most));
        let _ = write!(places, "{x:.1},{least:.1} ");
        if (least - most).abs() >= 0.05 {
            let _ = write!(places, "{x:.1},{most:.1} ");
        }
    }
    places.pop();
    places
}

/// Round times within a span, at most ten, with their labels.
fn times(begin: f64, end: f64) -> Vec<(f64, String)> {
    let span = end - begin;
    let decade = libm::pow(10.0, libm::floor(libm::log10(span / 5.0)));
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|k| k * decade)
        .into_iter()
        .find(|step| span / step <= 10.0)
        .unwrap_or(span);
    let first = libm::ceil(begin / step) as i64;
    let last = libm::floor(end / step) as i64;
    let decimals = libm::ceil(-libm::log10(step)).clamp(0.0, 9.0) as usize;
    (first..=last)
        .take(20)
        .map(|k| (k as f64 * step, format!("{:.decimals$}", k as f64 * step)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::USUAL;
    use super::*;
    use palpate_sim::tick::quantity::Number;

    #[test]
    fn times_are_round_and_few() {
        let labels = |begin, end| {
            times(begin, end)
                .into_iter()
                .map(|(_, label)| label)
                .collect::<Vec<_>>()
        };
        assert_eq!(
            labels(0.001, 1.0),
            [
                "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1.0"
            ]
        );
        assert_eq!(
            labels(590.0, 600.0),
            (590..=600).map(|t| t.to_string()).collect::<Vec<_>>()
        );
        assert!(labels(3.0, 3.0 + 1e-9).len() <= 20);
    }

    // However long a session: 800 buckets a curve, each with both its ends, for as many tools as a
    // scene has.
    #[test]
    fn the_largest_page_there_is_stays_below_a_megabyte() {
        let curve = |name: usize| {
            let piece = (0..=800).map(|k| Bucket {
                t_s: 0.75 * f64::from(k),
                least: -f64::from(k % 7),
                most: 11.0,
            });
            BucketedCurve {
                name: format!("tool {name}"),
                pieces: vec![piece.collect()],
            }
        };
        let curves: Vec<BucketedCurve> = (0..8).map(curve).collect();
        let panel = |name: &&str| super::super::series::Panel {
            number: Number::named(name).unwrap(),
            curves: curves.clone(),
        };
        let series = Series {
            span_s: [0.0, 600.0],
            panels: USUAL.iter().map(panel).collect(),
            tick_s: curve(0),
            dt_s: 1e-3,
        };
        let size = page("noise", &series).len();
        assert!(size > 300_000 && size < 1_000_000, "{size} bytes");
    }
}
