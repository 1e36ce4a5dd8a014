//! Results as a table: a row per run, the same bits however the runs were made.

use super::error::BatchError;
use super::outcome::{Outcome, ToolFigures};
use super::plan::{Case, Plan};
use std::io::Write;
use std::path::Path;
use toml::Value;

/// A run and what it came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What ran.
    pub case: Case,
    /// What came of it.
    pub outcome: Outcome,
}

/// How to write results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Comma-separated values (RFC 4180), numbers in the fewest digits that read back to the same.
    Csv,
    /// A list of objects.
    Json,
    /// Apache Parquet, one row group, uncompressed.
    Parquet,
}

impl Format {
    /// By the ending of a file's name.
    ///
    /// # Errors
    /// Another ending.
    pub fn of(path: &Path) -> Result<Self, BatchError> {
        match path.extension().and_then(std::ffi::OsStr::to_str) {
            Some("csv") => Ok(Self::Csv),
            Some("json") => Ok(Self::Json),
            Some("parquet") => Ok(Self::Parquet),
            _ => Err(BatchError::Format {
                path: path.display().to_string(),
            }),
        }
    }
}

/// Cells of a column, one per run; `None` where there is nothing.
#[derive(Clone, Debug, PartialEq)]
pub enum Cells {
    /// Whole numbers.
    Whole(Vec<Option<i64>>),
    /// Numbers with a point; those that are not finite are written as nothing.
    Number(Vec<Option<f64>>),
    /// Yes or no.
    Truth(Vec<Option<bool>>),
    /// Text.
    Text(Vec<Option<String>>),
}

/// Columns by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub(super) columns: Vec<(String, Cells)>,
    count: usize,
}

impl Table {
    /// Of rows of a plan. The types of columns follow from the plan, so that all shards have the
    /// same. `timings`: with the wall time of each run, which is not the same twice.
    pub fn new(plan: &Plan, rows: &[Row], timings: bool) -> Self {
        let mut table = Self {
            columns: Vec::new(),
            count: rows.len(),
        };
        let whole = |of: &dyn Fn(&Row) -> u64| {
            Cells::Whole(rows.iter().map(|row| Some(of(row) as i64)).collect())
        };
        let text = |of: &dyn Fn(&Row) -> Option<String>| Cells::Text(rows.iter().map(of).collect());
        table.add("run", whole(&|row| row.case.run as u64));
        table.add(
            "motion",
            text(&|row| Some(plan.motion_name(row.case.motion).to_owned())),
        );
        table.add("seed", whole(&|row| row.case.seed));
        for (k, varied) in plan.varied().iter().enumerate() {
            let cells = rows.iter().map(|row| &row.case.values[k]);
            let cells = if varied.all(Value::is_integer) {
                Cells::Whole(cells.map(Value::as_integer).collect())
            } else if varied.all(|value| value.is_integer() || value.is_float()) {
                Cells::Number(cells.map(number).collect())
            } else if varied.all(Value::is_bool) {
                Cells::Truth(cells.map(Value::as_bool).collect())
            } else {
                Cells::Text(cells.map(words).collect())
            };
            table.add(&varied.key, cells);
        }
        table.add("error", text(&|row| row.outcome.error.clone()));
        table.add("ticks", whole(&|row| row.outcome.ticks));
        let figure = |of: &dyn Fn(&Outcome) -> Option<f64>| {
            // Of a run that did not come to its end there are no figures.
            let of = |row: &Row| of(&row.outcome).filter(|_| row.outcome.ticks > 0);
            Cells::Number(rows.iter().map(of).collect())
        };
        table.add("time_s", figure(&|outcome| Some(outcome.time_s)));
        for (name, of) in FIGURES {
            let all = |outcome: &Outcome| Some(outcome.tools.iter().map(of).fold(0.0, f64::max));
            let sum = |outcome: &Outcome| Some(outcome.tools.iter().map(of).sum());
            match name {
                "energy_j" => table.add(name, figure(&sum)),
                // That of the tool with the greatest force.
                "peak_force_s" => {
                    let strongest = |outcome: &Outcome| {
                        let by = |a: &&ToolFigures, b: &&ToolFigures| {
                            a.peak_force_n.total_cmp(&b.peak_force_n)
                        };
                        Some(outcome.tools.iter().max_by(by).map_or(0.0, of))
                    };
                    table.add(name, figure(&strongest));
                }
                _ => table.add(name, figure(&all)),
            }
        }
        let tools = plan.tools();
        for tool in tools.iter().filter(|_| tools.len() > 1) {
            for (name, of) in FIGURES {
                let of = |outcome: &Outcome| {
                    let figures = outcome.tools.iter().find(|figures| figures.tool == *tool);
                    figures.map(of)
                };
                table.add(&format!("{tool}.{name}"), figure(&of));
            }
        }
        for tool in &tools {
            for (k, name) in plan.columns.iter().enumerate() {
                let of = |outcome: &Outcome| {
                    let figures = outcome.tools.iter().find(|figures| figures.tool == *tool)?;
                    *figures.asked.get(k)?
                };
                let name = match tools.len() {
                    1 => name.clone(),
                    _ => format!("{tool}.{name}"),
                };
                table.add(&name, figure(&of));
            }
        }
        let kept = |hash: &String| (!hash.is_empty()).then(|| hash.clone());
        table.add("session_hash", text(&|row| kept(&row.outcome.session_hash)));
        table.add("state_hash", text(&|row| kept(&row.outcome.state_hash)));
        table.add("key", text(&|row| kept(&row.outcome.key)));
        if timings {
            table.add("wall_s", figure(&|outcome| Some(outcome.wall_s)));
        }
        table
    }

    /// Columns by name, in their order.
    pub fn columns(&self) -> &[(String, Cells)] {
        &self.columns
    }

    /// Rows.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    fn add(&mut self, name: &str, cells: Cells) {
        self.columns.push((name.to_owned(), cells));
    }

    /// Writes it beside `path` and renames it: a file of that name is a whole one.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path, format: Format) -> Result<(), BatchError> {
        let wrong = |error: &dyn std::fmt::Display| BatchError::file(path, error);
        let bytes = match format {
            Format::Csv => self.csv(),
            Format::Json => self.json().into_bytes(),
            Format::Parquet => super::parquet::bytes(self),
        };
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(".part");
        let part = path.with_file_name(name);
        let written = std::fs::File::create(&part)
            .and_then(|mut file| file.write_all(&bytes).and_then(|()| file.sync_all()))
            .and_then(|()| std::fs::rename(&part, path));
        written.map_err(|error| wrong(&error))
    }

    /// With a line of names first.
    pub fn csv(&self) -> Vec<u8> {
        let names = self.columns.iter().map(|(name, _)| quoted(name));
        let mut text = names.collect::<Vec<_>>().join(",");
        text.push('\n');
        for row in 0..self.count {
            let cells = self.columns.iter().map(|(_, cells)| match cells {
                Cells::Whole(cells) => cells[row].map(|cell| cell.to_string()),
                Cells::Number(cells) => finite(cells[row]).map(|cell| cell.to_string()),
                Cells::Truth(cells) => cells[row].map(|cell| cell.to_string()),
                Cells::Text(cells) => cells[row].as_deref().map(quoted),
            });
            let cells: Vec<String> = cells.map(Option::unwrap_or_default).collect();
            text.push_str(&cells.join(","));
            text.push('\n');
        }
        text.into_bytes()
    }

    /// A list of objects, one to a line.
    pub fn json(&self) -> String {
        let rows: Vec<String> = (0..self.count)
            .map(|row| {
                let cells = self.columns.iter().map(|(name, cells)| {
                    let cell = match cells {
                        Cells::Whole(cells) => serde_json::json!(cells[row]),
                        Cells::Number(cells) => serde_json::json!(finite(cells[row])),
                        Cells::Truth(cells) => serde_json::json!(cells[row]),
                        Cells::Text(cells) => serde_json::json!(cells[row]),
                    };
                    // Not a map of serde_json's: that would order the names.
                    format!("{}: {cell}", serde_json::json!(name))
                });
                format!("{{{}}}", cells.collect::<Vec<_>>().join(", "))
            })
            .collect();
        format!("[\n{}\n]\n", rows.join(",\n"))
    }
}

type Figure = fn(&ToolFigures) -> f64;

/// Figures of a tool, in the order of their columns.
const FIGURES: [(&str, Figure); 5] = [
    ("peak_force_n", |figures| figures.peak_force_n),
    ("peak_force_s", |figures| figures.peak_force_s),
    ("peak_depth_m", |figures| figures.peak_depth_m),
    ("energy_j", |figures| figures.energy_j),
    ("made_j", |figures| figures.made_j),
];

pub(super) fn finite(cell: Option<f64>) -> Option<f64> {
    cell.filter(|value| value.is_finite())
}

fn number(value: &Value) -> Option<f64> {
    (value.as_float()).or_else(|| value.as_integer().map(|whole| whole as f64))
}

/// Text as it is; positions and tables as JSON.
fn words(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        value => serde_json::to_string(value).ok(),
    }
}

fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}
