//! Text files with lines of numbers.

use anyhow::Context as _;
use palpate_geometry::math::MOST_COORDINATE_M;
use std::path::Path;

/// A line, with its number in the file.
pub struct NumberLine {
    /// From 1.
    pub line: usize,
    pub values: Vec<f64>,
}

/// Reads lines of numbers to calculate with, between commas, semicolons or blanks; `#` starts a comment, and a
/// first line of words is a heading. A line has as many numbers as one of `widths`; `names` says
/// which, for messages. The crate `csv` reads one separator only, and no comments behind numbers.
pub fn read(path: &Path, widths: &[usize], names: &str) -> anyhow::Result<Vec<NumberLine>> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let mut rows: Vec<NumberLine> = Vec::new();
    let mut headed = false;
    for (k, whole) in text.lines().enumerate() {
        let text = whole.split('#').next().unwrap_or_default().trim();
        if text.is_empty() {
            continue;
        }
        let fields = text.split([',', ';', ' ', '\t']);
        let fields = fields.filter(|field| !field.is_empty());
        let values: Vec<Option<f64>> = fields.map(|field| field.parse().ok()).collect();
        if rows.is_empty() && !headed && values.iter().all(Option::is_none) {
            headed = true;
            continue;
        }
        let values: Option<Vec<f64>> = values.into_iter().collect();
        let fits = |values: &Vec<f64>| {
            widths.contains(&values.len()) && values.iter().all(|x| x.abs() <= MOST_COORDINATE_M)
        };
        let Some(values) = values.filter(fits) else {
            anyhow::bail!(
                "{}:{}: expected {names}, finite numbers within ±{MOST_COORDINATE_M:e}",
                path.display(),
                k + 1
            );
        };
        let line = k + 1;
        rows.push(NumberLine { line, values });
    }
    anyhow::ensure!(
        !rows.is_empty(),
        "{}: the file has no line with {names}",
        path.display()
    );
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<Vec<(usize, Vec<f64>)>, String> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let rows = read(file.path(), &[2, 3], "u,v or x,y,z").map_err(|e| e.to_string())?;
        Ok(rows.into_iter().map(|row| (row.line, row.values)).collect())
    }

    #[test]
    fn headings_comments_and_separators_are_passed_over() {
        let text = "# a file\nu, v\n\n1, 2 # first\n3;4;5\n 6\t7 \n";
        let rows = vec![
            (4, vec![1.0, 2.0]),
            (5, vec![3.0, 4.0, 5.0]),
            (6, vec![6.0, 7.0]),
        ];
        assert_eq!(of(text), Ok(rows));
    }

    #[test]
    fn a_line_that_is_wrong_is_named() {
        for (text, line) in [
            ("1,2\nu,v\n", 2),
            ("1,x\n", 1),
            ("1,2\n\n1,2,3,4\n", 3),
            ("1,inf\n", 1),
            ("1,nan\n", 1),
            ("1,1e400\n", 1),
            ("1e308,-1e155\n", 1),
            ("u,v\nx,y\n", 2),
        ] {
            let error = of(text).unwrap_err();
            assert!(error.contains(&format!(":{line}: ")), "{text:?}: {error}");
        }
        assert!(of("# nothing\n").unwrap_err().contains("no line with"));
    }
}
