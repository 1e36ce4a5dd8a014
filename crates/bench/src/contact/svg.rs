//! Time against error as a picture: logarithmic axes, a mark for each case and a colour for each
//! method.

use super::Row;
use palpate_record::chart::{Chart, Curve, Scale, Unit, page};

/// Errors below are drawn here: an exact answer has no place on a logarithmic axis.
const LEAST_ERROR_M: f64 = 1e-16;

/// The picture of all rows, as an SVG document.
pub fn picture(rows: &[Row]) -> String {
    let mut methods: Vec<&str> = Vec::new();
    for row in rows {
        if !methods.contains(&row.method.as_str()) {
            methods.push(&row.method);
        }
    }
    let curve = |method: &&str| {
        let of_method = || rows.iter().filter(|row| row.method == *method);
        let shown = || {
            let places = of_method().map(|row| Some((row, row.times?.median_s, row.error?.value)));
            places.flatten().filter(|(.., error)| error.is_finite())
        };
        let hollow = of_method().any(|row| row.peer);
        Curve {
            name: format!("{method}{}", if hollow { " (peer)" } else { "" }),
            points: shown()
                .map(|(_, median_s, error)| (median_s.max(1e-9), error.max(LEAST_ERROR_M)))
                .collect(),
            lined: false,
            hollow,
            titles: shown()
                .map(|(row, ..)| format!("{} {}", row.case, row.method))
                .collect(),
        }
    };
    page(&[Chart {
        title: "Contact: median time of one query against largest error".to_owned(),
        across: "median time of one query".to_owned(),
        down: "largest depth error, m".to_owned(),
        scales: [Scale::Decades(Unit::Seconds), Scale::Decades(Unit::Plain)],
        curves: methods.iter().map(curve).collect(),
    }])
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
            ..Row::new("contact", "point/8x8/cold", method)
                .timed(times)
                .off_by(error, "m")
        }
    }

    #[test]
    fn every_row_has_a_mark_inside_the_frame_and_every_method_a_line_of_the_legend() {
        let rows = [
            row("exact", false, 2e-6, 0.0),
            row("spheres 82", false, 3e-5, 1e-5),
            row("a <peer>", true, 1e-3, 1e-4),
        ];
        let svg = picture(&rows);
        assert_eq!(
            svg.matches("<circle").count(),
            2 + 2,
            "two marks, two of the legend"
        );
        assert_eq!(svg.matches("stroke-width").count(), 1 + 1);
        assert!(svg.contains("a &lt;peer&gt; (peer)") && svg.contains("10 µs"));
        for part in svg.split("<circle cx=\"").skip(1) {
            let x: f64 = part.split('"').next().unwrap().parse().unwrap();
            assert!((FRAME[0]..=WIDTH).contains(&x), "{x}");
        }
        assert!(
            picture(&[]).ends_with("</svg>\n"),
            "nothing measured is a picture too"
        );
    }
}
