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
        let ratio = ours.map_or(String::new(), |ours| {
            format!("{:.1} ×", row.median_s / ours.median_s)
        });
        let note = if row.note.is_empty() {
            String::new()
        } else {
            format!("  {}", row.note)
        };
        let wrong = row
            .wrong
            .map_or(String::new(), |wrong| format!(", {wrong} wrong"));
        let _ = writeln!(
            text,
            "  {:<38} median {:>9}  p99 {:>9}  {:>9}  error {:.1e} {}{wrong}  ({} calls){note}",
            row.method,
            seconds(row.median_s),
            seconds(row.p99_s),
            ratio,
            row.error,
            row.error_unit,
            row.n
        );
    }
    text
}

fn seconds(s: f64) -> String {
    match s {
        s if s < 1e-6 => format!("{:.0} ns", s * 1e9),
        s if s < 1e-3 => format!("{:.2} µs", s * 1e6),
        s => format!("{:.2} ms", s * 1e3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peers_show_how_many_times_longer_they_take() {
        let row = |method: &str, peer, median_s| Row {
            suite: "surface",
            case: "closest".to_owned(),
            method: method.to_owned(),
            peer,
            median_s,
            p99_s: 2.0 * median_s,
            error: 1e-12,
            error_unit: "m",
            n: 7,
            wrong: Some(0),
            note: String::new(),
        };
        let text = table(&[row("ours", false, 2e-6), row("theirs", true, 5e-6)]);
        assert_eq!(text.lines().count(), 3);
        assert!(
            text.contains("2.5 ×") && text.contains("2.00 µs") && text.contains("0 wrong"),
            "{text}"
        );
    }
}
