//! Rows for the eye: times with units, and how many times longer each peer takes.

use super::Row;
use std::fmt::Write;

/// All rows, a case at a time, in the order in which cases first come.
pub fn table(rows: &[Row]) -> String {
    let mut text = String::new();
    let mut case = "";
    let mut cases: Vec<&str> = Vec::new();
    for row in rows {
        if !cases.contains(&row.case.as_str()) {
            cases.push(&row.case);
        }
    }
    for row in cases
        .iter()
        .flat_map(|case| rows.iter().filter(move |row| row.case == *case))
    {
        if row.case != case {
            case = &row.case;
            let _ = writeln!(text, "{case}");
        }
        let ours = rows
            .iter()
            .find(|other| other.case == row.case && !other.peer)
            .filter(|_| row.peer);
        let ratio = ours.and_then(|ours| {
            let ratio = row.times?.median_s / ours.times?.median_s;
            Some(format!("{ratio:.1} ×"))
        });
        let times = row.times.map_or(String::new(), |times| {
            format!(
                "median {:>9}  p99 {:>9}",
                seconds(times.median_s),
                seconds(times.p99_s)
            )
        });
        let wrong = row.wrong.map(|wrong| format!("{wrong} wrong"));
        let said: Vec<String> = [
            row.error
                .map(|error| format!("error {:.1e} {}", error.value, error.unit)),
            wrong,
            row.times.map(|times| format!("{} calls", times.n)),
            (!row.note.is_empty()).then(|| row.note.clone()),
        ]
        .into_iter()
        .flatten()
        .collect();
        let _ = writeln!(
            text,
            "  {:<38} {times:<32}  {:>9}  {}",
            row.method,
            ratio.unwrap_or_default(),
            said.join(", ")
        );
    }
    text
}

/// With a unit that suits its size.
pub(crate) fn seconds(s: f64) -> String {
    match s {
        s if s < 1e-6 => format!("{:.0} ns", s * 1e9),
        s if s < 1e-3 => format!("{:.2} µs", s * 1e6),
        s => format!("{:.2} ms", s * 1e3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Times;

    #[test]
    fn peers_show_how_many_times_longer_they_take() {
        let row = |method: &str, peer, median_s| Row {
            peer,
            wrong: Some(0),
            ..Row::new("surface", "closest", method)
                .timed(Times {
                    median_s,
                    p99_s: 2.0 * median_s,
                    n: 7,
                })
                .off_by(1e-12, "m")
        };
        let text = table(&[row("ours", false, 2e-6), row("theirs", true, 5e-6)]);
        assert_eq!(text.lines().count(), 3);
        assert!(
            text.contains("2.5 ×") && text.contains("2.00 µs") && text.contains("0 wrong"),
            "{text}"
        );
    }
    #[test]
    fn what_was_not_measured_is_left_out() {
        let row = Row::new("surface", "closest", "ours").off_by(f64::NAN, "m");
        let text = table(std::slice::from_ref(&row));
        assert!(!text.contains("NaN") && !text.contains("error"), "{text}");
        let json = serde_json::to_value(&row).unwrap();
        assert_eq!(json.get("error"), None, "{json}");
        assert_eq!(json.get("median_s"), None, "{json}");
    }
}
