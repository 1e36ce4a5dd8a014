//! What a scenario came to: a table, the bars it missed, and what the source says.

use super::error::ScenarioError;
use super::measure::{Look, Meter};
use super::played::{Played, Trace};
use super::spec::{RunSpec, ScenarioSpec};
use serde::Serialize;
use std::fmt::Write as _;

/// A figure of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// Name of the measure.
    pub measure: String,
    /// Its unit.
    pub unit: String,
    /// `None`: there was nothing to measure, or it never came to be.
    pub value: Option<f64>,
    /// Bars, if it has any.
    pub at_least: Option<f64>,
    /// See `at_least`.
    pub at_most: Option<f64>,
    /// It keeps them.
    pub kept: bool,
    #[serde(skip)]
    digits: usize,
    /// It is a time of the machine: not the same in the next run.
    #[serde(skip)]
    of_machine: bool,
}

/// A run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the run.
    pub run: String,
    /// In the order of the measures, those that it has.
    pub cells: Vec<Cell>,
    /// Ticks that ran.
    pub ticks: u64,
    /// Hash of the state after the last tick: the same on every machine with the same build.
    pub state_hash: String,
    /// Files written.
    pub files: Vec<String>,
}

/// A claim, and whether it holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Claimed {
    /// In words.
    pub says: String,
    /// `None`: not all of its runs were run.
    pub holds: Option<bool>,
    /// Printed for information: nothing has to meet it.
    pub reported: bool,
}

/// All of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Name of the scenario.
    pub scenario: String,
    /// Its title.
    pub title: String,
    /// Where it comes from.
    pub source: String,
    /// Runs, in their order.
    pub rows: Vec<Row>,
    /// Claims.
    pub claims: Vec<Claimed>,
    /// Figure and what it says.
    pub says: Vec<[String; 2]>,
    /// No bar was missed.
    pub passed: bool,
}

impl Report {
    pub(super) fn new(name: &str, spec: &ScenarioSpec) -> Self {
        Self {
            scenario: name.to_owned(),
            title: spec.title.clone(),
            source: spec.source.clone(),
            rows: Vec::new(),
            claims: Vec::new(),
            says: (spec.says.iter())
                .map(|says| [says.figure.clone(), says.text.clone()])
                .collect(),
            passed: true,
        }
    }

    pub(super) fn push(
        &mut self,
        run: &RunSpec,
        meters: &[Meter],
        played: &Played,
        traces: &[(String, Trace)],
    ) -> Result<(), ScenarioError> {
        let mut cells = Vec::with_capacity(meters.len());
        for meter in meters {
            let spec = &meter.spec;
            let value = match &spec.what {
                Look::Deviation { tool, from } => {
                    deviation_m(tool, from, played, traces).map(|value| value * spec.scale)
                }
                _ => meter.value(),
            };
            let value = value.filter(|value| value.is_finite());
            cells.push(Cell {
                measure: spec.name.clone(),
                unit: spec.unit.clone(),
                value,
                at_least: spec.at_least,
                at_most: spec.at_most,
                kept: spec.keeps(value),
                digits: spec.digits,
                of_machine: matches!(spec.what, Look::TickTime(_)),
            });
        }
        self.passed &= cells.iter().all(|cell| cell.kept);
        self.rows.push(Row {
            run: run.name.clone(),
            cells,
            ticks: played.ticks,
            state_hash: format!("{:016x}", played.state_hash),
            files: (played.files.iter())
                .map(|path| path.display().to_string())
                .collect(),
        });
        Ok(())
    }

    pub(super) fn judge(&mut self, spec: &ScenarioSpec) {
        for claim in &spec.claims {
            let value = |run: &String| self.value(run, &claim.measure);
            let growing: Option<Vec<f64>> = claim.growing.iter().map(value).collect();
            let grows = growing.map(|values| values.is_sorted_by(|a, b| a < b));
            let least = claim.least.as_ref().map(|run| {
                let least = value(run)?;
                let others = (self.rows.iter()).filter(|row| row.run != *run);
                let mut others = others.filter_map(|row| value(&row.run)).peekable();
                others.peek()?;
                Some(others.all(|other| least < other))
            });
            let holds = match least {
                None => grows,
                Some(least) => grows.zip(least).map(|(a, b)| a && b),
            };
            self.passed &= claim.reported || holds != Some(false);
            self.claims.push(Claimed {
                says: claim.says.clone(),
                holds,
                reported: claim.reported,
            });
        }
    }

    /// A figure, in the unit of its column.
    pub fn value(&self, run: &str, measure: &str) -> Option<f64> {
        let row = self.rows.iter().find(|row| row.run == run)?;
        row.cells.iter().find(|cell| cell.measure == measure)?.value
    }

    /// As people read it: a Markdown table, bars that were missed marked with `!`.
    pub fn text(&self) -> String {
        let mut text = format!("{}: {}\n", self.scenario, self.title);
        if !self.source.is_empty() {
            let _ = writeln!(text, "source: {}", self.source);
        }
        table(&self.lines(|_| true), &mut text);
        for claim in &self.claims {
            let _ = writeln!(text, "{}: {}", claim.verdict(), claim.says);
        }
        for [figure, says] in &self.says {
            let _ = writeln!(text, "source, {figure}: {says}");
        }
        for row in &self.rows {
            for file in &row.files {
                let _ = writeln!(text, "wrote {file}");
            }
        }
        if !self.passed {
            text.push_str("a bar was missed: marked with !\n");
        }
        text
    }

    /// For a document: the table without times of the machine, claims, and what the source says, as
    /// Markdown.
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        for (k, line) in self.lines(|cell| !cell.of_machine).iter().enumerate() {
            let _ = writeln!(text, "| {} |", line.join(" | "));
            if k == 0 {
                let _ = writeln!(text, "|{}", "---|".repeat(line.len()));
            }
        }
        if !(self.claims.is_empty() && self.says.is_empty()) {
            text.push('\n');
        }
        for claim in &self.claims {
            let says = claim.says.trim_end_matches('.');
            let _ = writeln!(text, "- {says}: {}.", claim.verdict());
        }
        for [figure, says] in &self.says {
            let _ = writeln!(text, "- The source, {figure}: {says}");
        }
        text
    }

    /// The table: a heading, a line for each run, and the bars if there are any.
    fn lines(&self, shown: impl Fn(&Cell) -> bool) -> Vec<Vec<String>> {
        let mut columns: Vec<(String, String)> = Vec::new();
        for cell in self.rows.iter().flat_map(|row| &row.cells) {
            let column = (cell.measure.clone(), cell.unit.clone());
            if shown(cell) && !columns.contains(&column) {
                columns.push(column);
            }
        }
        let mut lines: Vec<Vec<String>> = Vec::new();
        let heading = columns.iter().map(|(name, unit)| match unit.as_str() {
            "" => name.clone(),
            unit => format!("{name}, {unit}"),
        });
        lines.push(std::iter::once("run".to_owned()).chain(heading).collect());
        for row in &self.rows {
            let cell = |(name, _): &(String, String)| {
                let found = row.cells.iter().find(|cell| cell.measure == *name);
                found.map_or(String::new(), Cell::text)
            };
            let cells = columns.iter().map(cell);
            lines.push(std::iter::once(row.run.clone()).chain(cells).collect());
        }
        let bars: Vec<String> = (columns.iter()).map(|(name, _)| self.bar(name)).collect();
        if bars.iter().any(|bar| !bar.is_empty()) {
            lines.push(std::iter::once("bar".to_owned()).chain(bars).collect());
        }
        lines
    }

    fn bar(&self, measure: &str) -> String {
        let mut cells = self.rows.iter().flat_map(|row| &row.cells);
        let cell = cells.find(|cell| cell.measure == measure);
        let Some(cell) = cell else {
            return String::new();
        };
        match (cell.at_least, cell.at_most) {
            (None, None) => String::new(),
            (Some(least), None) => format!("≥ {least}"),
            (None, Some(most)) => format!("≤ {most}"),
            (Some(least), Some(most)) => format!("{least} … {most}"),
        }
    }
}

impl Claimed {
    fn verdict(&self) -> &'static str {
        match (self.holds, self.reported) {
            (None, _) => "not judged",
            (Some(true), _) => "holds",
            (Some(false), true) => "does not hold",
            (Some(false), false) => "MISSED",
        }
    }
}

impl Cell {
    fn text(&self) -> String {
        let value = match self.value {
            None => "none".to_owned(),
            Some(value) => format!("{value:.*}", self.digits),
        };
        if self.kept {
            value
        } else {
            format!("{value} !")
        }
    }
}

/// Rms distance of a tool from where it was in another run, over the ticks that both have.
fn deviation_m(tool: &str, from: &str, played: &Played, traces: &[(String, Trace)]) -> Option<f64> {
    let (_, other) = traces.iter().find(|(run, _)| run == from)?;
    let (here, there) = (played.trace.tools.get(tool)?, other.tools.get(tool)?);
    let count = here.len().min(there.len());
    let squares = here
        .iter()
        .zip(there)
        .map(|((a, _), (b, _))| (0..3).map(|c| (a[c] - b[c]) * (a[c] - b[c])).sum::<f64>());
    (count > 0).then(|| (squares.sum::<f64>() / count as f64).sqrt())
}

/// Lines of equal width, the first of them underlined.
fn table(lines: &[Vec<String>], text: &mut String) {
    let columns = lines.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = lines.iter().filter_map(|line| line.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    for (k, line) in lines.iter().enumerate() {
        for (cell, width) in line.iter().zip(&widths) {
            let _ = write!(text, "| {cell:<width$} ");
        }
        text.push_str("|\n");
        if k == 0 {
            for width in &widths {
                let _ = write!(text, "|{}", "-".repeat(width + 2));
            }
            text.push_str("|\n");
        }
    }
}
