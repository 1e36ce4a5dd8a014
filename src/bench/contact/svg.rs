//! Time against error as a picture: logarithmic axes, a mark for each case and a colour for each method.

use super::Row;
use std::fmt::Write;

const WIDTH: f64 = 960.0;
const HEIGHT: f64 = 600.0;
/// Left, top, right and bottom of the plot.
const FRAME: [f64; 4] = [80.0, 40.0, 720.0, 540.0];
/// Errors below are drawn here: an exact answer has no place on a logarithmic axis.
const LEAST_ERROR_M: f64 = 1e-16;
const COLOURS: [&str; 8] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#7f7f7f"];

/// The picture of all rows, as an SVG document.
pub fn picture(rows: &[Row]) -> String {
    let mut methods: Vec<&str> = Vec::new();
    for row in rows {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let decades = |values: &mut dyn Iterator<Item = f64>| {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in values.filter(|x| x.is_finite()) {
            (low, high) = (low.min(libm::floor(libm::log10(x))), high.max(libm::ceil(libm::log10(x))));
        }
        if low.is_finite() { (low, high.max(low + 1.0)) } else { (0.0, 1.0) }
    };
    let error = |row: &Row| row.error.max(LEAST_ERROR_M);
    let time = |row: &Row| row.median_s.max(1e-9);
    let (x, y) = (decades(&mut rows.iter().map(time)), decades(&mut rows.iter().map(error)));
    let [left, top, right, bottom] = FRAME;
    let across = |t: f64| left + (libm::log10(t) - x.0) / (x.1 - x.0) * (right - left);
    let down = |e: f64| bottom - (libm::log10(e) - y.0) / (y.1 - y.0) * (bottom - top);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n\
         <text x=\"{left}\" y=\"24\" font-size=\"16\">Contact: median time of one query against largest error</text>\n"
    );
    for decade in x.0 as i32..=x.1 as i32 {
        let at = across(libm::pow(10.0, f64::from(decade)));
        let _ = writeln!(svg, "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"#ddd\"/>");
        let label = ["1 ns", "10 ns", "100 ns", "1 µs", "10 µs", "100 µs", "1 ms", "10 ms", "100 ms", "1 s"];
        let label = label.get((decade + 9) as usize).map_or_else(|| format!("1e{decade} s"), |text| (*text).to_owned());
        let _ = writeln!(svg, "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{label}</text>", bottom + 18.0);
    }
    for decade in y.0 as i32..=y.1 as i32 {
        let at = down(libm::pow(10.0, f64::from(decade)));
        let _ = writeln!(svg, "<path d=\"M{left} {at:.1}H{right}\" stroke=\"#ddd\"/>");
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">1e{decade}</text>", left - 6.0, at + 4.0);
    }
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">median time of one query</text>",
        0.5 * (left + right),
        bottom + 40.0
    );
    let _ = writeln!(
        svg,
        "<text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\">largest depth error, m</text>",
        0.5 * (top + bottom)
    );
    for row in rows.iter().filter(|row| row.median_s.is_finite() && row.error.is_finite()) {
        let k = methods.iter().position(|method| *method == row.method).unwrap_or(0);
        mark(
            &mut svg,
            across(time(row)),
            down(error(row)),
            COLOURS[k % COLOURS.len()],
            row.peer,
            &format!("{} {}", row.case, row.method),
        );
    }
    for (k, method) in methods.iter().enumerate() {
        let at = top + 10.0 + 22.0 * k as f64;
        let peer = rows.iter().any(|row| row.method == *method && row.peer);
        mark(&mut svg, right + 24.0, at, COLOURS[k % COLOURS.len()], peer, method);
        let note = if peer { " (peer)" } else { "" };
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{}\">{}{note}</text>", right + 38.0, at + 4.0, escaped(method));
    }
    svg.push_str("</svg>\n");
    svg
}

/// A disc, or for other libraries a square on its corner; the name shows under the pointer.
fn mark(svg: &mut String, x: f64, y: f64, colour: &str, peer: bool, title: &str) {
    let title = escaped(title);
    let _ = if peer {
        writeln!(
            svg,
            "<path d=\"M{x:.1} {:.1}l6 6l-6 6l-6 -6z\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"><title>{title}</title></path>",
            y - 6.0
        )
    } else {
        writeln!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.5\" fill=\"{colour}\" fill-opacity=\"0.75\"><title>{title}</title></circle>"
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
            suite: "contact",
            case: "point/8x8/cold".to_owned(),
            method: method.to_owned(),
            peer,
            median_s,
            p99_s: median_s,
            error,
            error_unit: "m",
            n: 1,
            wrong: None,
            note: String::new(),
        }
    }

    #[test]
    fn every_row_has_a_mark_inside_the_frame_and_every_method_a_line_of_the_legend() {
        let rows =
            [row("exact", false, 2e-6, 0.0), row("spheres 82", false, 3e-5, 1e-5), row("a <peer>", true, 1e-3, 1e-4)];
        let svg = picture(&rows);
        assert_eq!(svg.matches("<circle").count(), 2 + 2, "two marks, two of the legend");
        assert_eq!(svg.matches("stroke-width").count(), 1 + 1);
        assert!(svg.contains("a &lt;peer&gt; (peer)") && svg.contains("10 µs"));
        for part in svg.split("<circle cx=\"").skip(1) {
            let x: f64 = part.split('"').next().unwrap().parse().unwrap();
            assert!((FRAME[0]..=WIDTH).contains(&x), "{x}");
        }
        assert!(picture(&[]).ends_with("</svg>\n"), "nothing measured is a picture too");
    }
}
