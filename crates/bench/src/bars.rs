//! What the project promises as errors and as ratios, held to what the suites measure.
//!
//! A promise is data (`list`): rows of a suite, a field of theirs, and its bar. Nothing is measured here.

mod list;

use crate::deformation::HardRow;
use crate::figure::{self, Bar, Figure};
use crate::suite::{Suite, matches, row_of};
use crate::{Effort, Row};
use palpate_experiment::scenario::{Cell, Report, Scenario, Settings};
use std::collections::BTreeSet;
use std::io::Write as _;

/// Which promises, and how they are printed.
#[derive(clap::Args, Debug)]
pub struct BarOptions {
    /// Only errors and ratios that do not depend on the machine, and take seconds.
    #[arg(long)]
    quick: bool,
    /// Print one JSON object per line.
    #[arg(long)]
    json: bool,
    /// Run only promises whose names, SUITE CASE METHOD, contain this.
    #[arg(long)]
    only: Option<String>,
}

/// What of a row is promised.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Field {
    /// The size of its error.
    Error,
    /// The signed error: a negative one meets every upper bound.
    Excess,
    /// Answers that are wrong.
    Wrong,
    /// Its error over that of this method in the same case.
    ErrorOver(&'static str),
    /// By how much a force of this case differs, each over its own modulus: the errors of both are of the
    /// same reference.
    ApartFrom(&'static str),
    /// Powers of the resolution with which the error falls, to this method, whose grid is so many times as
    /// fine.
    Order(&'static str, f64),
    /// How many times longer this method of the same case takes.
    TimesLonger(&'static str),
    /// How many times longer the fastest of the other libraries takes.
    PeersTakeTimesLonger,
    /// The 99th percentile of its times.
    Slowest,
    /// What the row itself says: figures, hard cases and scenarios have their bars beside them.
    Own,
}

/// A promise.
#[derive(Clone, Copy, Debug)]
struct Promise {
    suite: Suite,
    /// Of the rows; one `*` stands for anything.
    case: &'static str,
    method: &'static str,
    field: Field,
    bar: Bar,
    quick: bool,
}

/// How a promise came out.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct Verdict {
    suite: &'static str,
    name: String,
    /// `None` if there was nothing to measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    unit: String,
    #[serde(flatten)]
    bar: Bar,
    met: bool,
    #[serde(skip_serializing_if = "String::is_empty")]
    note: String,
}

impl Verdict {
    fn new(suite: &'static str, name: String, value: Option<f64>, unit: &str, bar: Bar) -> Self {
        Self {
            suite,
            name,
            value,
            unit: unit.to_owned(),
            bar,
            met: value.is_some_and(|value| bar.holds(value)),
            note: String::new(),
        }
    }

    fn text(&self) -> String {
        let value = self.value.map_or("none".to_owned(), figure::short);
        let unit = if self.unit == "1" { "" } else { &self.unit };
        let met = if self.met { "met   " } else { "MISSED" };
        let note = if self.note.is_empty() {
            String::new()
        } else {
            format!("  ({})", self.note)
        };
        format!(
            "{met} {} {}: {value} {unit}, bar {}{note}",
            self.suite, self.name, self.bar
        )
    }
}

/// Measures what is promised, prints a line for each; true if all is met.
///
/// # Errors
/// Something could not be measured, or nothing has that name.
pub fn bars(options: &BarOptions) -> anyhow::Result<bool> {
    let effort = match options.quick {
        true => Effort::Quick,
        false => Effort::Full,
    };
    let wanted = |promise: &&Promise| {
        let name = format!(
            "{} {} {}",
            promise.suite.name(),
            promise.case,
            promise.method
        );
        (promise.quick || !options.quick)
            && (options.only.as_ref()).is_none_or(|part| name.contains(part))
    };
    let promises = list::promises();
    let chosen: Vec<&Promise> = promises.iter().filter(wanted).collect();
    anyhow::ensure!(!chosen.is_empty(), "nothing is promised under that name");
    let (mut printed, mut missed, mut unmeasured) = (BTreeSet::new(), 0, Vec::new());
    for suite in Suite::ALL {
        let of: Vec<&Promise> = (chosen.iter().copied())
            .filter(|promise| promise.suite == suite)
            .collect();
        if of.is_empty() {
            continue;
        }
        let mut print = |verdict: Verdict| {
            // A row may be promised by itself and with others.
            if !printed.insert(format!(
                "{} {} {}",
                verdict.suite, verdict.name, verdict.bar
            )) {
                return Ok(());
            }
            missed += usize::from(!verdict.met);
            let line = match options.json {
                true => serde_json::to_string(&verdict)?,
                false => verdict.text(),
            };
            anyhow::Ok(writeln!(std::io::stdout(), "{line}")?)
        };
        for verdict in judged(suite, &of, effort, &mut unmeasured)? {
            print(verdict)?;
        }
    }
    if !options.json {
        println!("{} bars, {missed} missed", printed.len());
    }
    anyhow::ensure!(
        unmeasured.is_empty(),
        "{} could not be measured\n{}",
        unmeasured.len(),
        unmeasured.join("\n")
    );
    Ok(missed == 0)
}

/// Runs what these promises of a suite ask for.
fn judged(
    suite: Suite,
    promises: &[&Promise],
    effort: Effort,
    unmeasured: &mut Vec<String>,
) -> anyhow::Result<Vec<Verdict>> {
    if suite == Suite::Scenario {
        let mut verdicts = Vec::new();
        for promise in promises {
            let scenario = Scenario::load(promise.case)?;
            let report = scenario.run(&Settings::default(), |_| {})?;
            verdicts.extend(of_report(&report));
        }
        return Ok(verdicts);
    }
    let asked: Vec<String> = promises.iter().flat_map(|promise| promise.rows()).collect();
    let measured = suite.run(effort, &asked);
    unmeasured.extend(measured.failed);
    let mut verdicts = Vec::new();
    for promise in promises {
        let before = verdicts.len();
        verdicts.extend(promise.of_rows(&measured.rows));
        verdicts.extend(promise.of_figures(&measured.figures));
        verdicts.extend(promise.of_hard(&measured.hard));
        if verdicts.len() == before {
            unmeasured.push(format!(
                "{} {} {}: there is no such row",
                suite.name(),
                promise.case,
                promise.method
            ));
        }
    }
    Ok(verdicts)
}

impl Promise {
    /// What it needs of its suite, as [`Cases::Rows`] has it.
    fn rows(&self) -> Vec<String> {
        let mut rows = vec![row_of(self.case, self.method)];
        match self.field {
            Field::ApartFrom(case) => rows.push(row_of(case, self.method)),
            // A case is asked for by the library, which runs in all its ways.
            Field::ErrorOver(method) | Field::Order(method, _) | Field::TimesLonger(method) => {
                let library = method.split([',', ' ']).next().unwrap_or_default();
                rows.push(row_of(self.case, library));
            }
            Field::Error
            | Field::Excess
            | Field::Wrong
            | Field::PeersTakeTimesLonger
            | Field::Slowest
            | Field::Own => {}
        }
        rows
    }

    fn is_of(&self, case: &str, method: &str) -> bool {
        matches(self.case, case) && matches(self.method, method)
    }

    fn of_rows(&self, rows: &[Row]) -> Vec<Verdict> {
        let own = rows.iter().filter(|row| self.is_of(&row.case, &row.method));
        let verdict = |row: &Row| {
            let other = |case: &str, method: &str| {
                let found = |other: &&Row| other.case == case && other.method == method;
                rows.iter().find(found)
            };
            let errors =
                |method| Some((row.error_size()?, other(&row.case, method)?.error_size()?));
            let longer = |other: &Row| Some(other.times?.median_s / row.times?.median_s);
            let (what, value, unit) = match self.field {
                Field::Error => (
                    "error".to_owned(),
                    row.error_size(),
                    row.error.map_or("", |error| error.unit),
                ),
                Field::Excess => (
                    "excess".to_owned(),
                    row.error.map(|error| error.value),
                    row.error.map_or("", |error| error.unit),
                ),
                Field::Wrong => ("wrong answers".to_owned(), row.wrong.map(|n| n as f64), "1"),
                Field::ErrorOver(method) => (
                    format!("error over that of {method}"),
                    errors(method).map(|(own, theirs)| own / theirs),
                    "1",
                ),
                Field::ApartFrom(case) => {
                    let there = other(case, &row.method).and_then(|other| other.error);
                    let both = row.error.zip(there);
                    (
                        format!("force over modulus beside {case}"),
                        both.map(|(a, b)| ((1.0 + a.value) / (1.0 + b.value) - 1.0).abs()),
                        "of it",
                    )
                }
                Field::Order(method, finer) => (
                    format!("order of the error to {method}"),
                    errors(method).map(|(own, theirs)| libm::log(own / theirs) / libm::log(finer)),
                    "1",
                ),
                Field::TimesLonger(method) => (
                    format!("time of {method} over its own"),
                    other(&row.case, method).and_then(longer),
                    "×",
                ),
                Field::PeersTakeTimesLonger => {
                    let peers = rows
                        .iter()
                        .filter(|other| other.peer && other.case == row.case);
                    (
                        "time of the fastest peer over its own".to_owned(),
                        peers.filter_map(longer).min_by(f64::total_cmp),
                        "×",
                    )
                }
                Field::Slowest => (
                    "99th percentile".to_owned(),
                    row.times.map(|times| times.p99_s * 1e6),
                    "µs",
                ),
                Field::Own => return None,
            };
            let name = format!("{} {}: {what}", row.case, row.method);
            let verdict = Verdict::new(row.suite, name, value, unit, self.bar);
            Some(Verdict {
                note: match verdict.met {
                    true => String::new(),
                    false => row.note.clone(),
                },
                ..verdict
            })
        };
        own.filter_map(verdict).collect()
    }

    fn of_figures(&self, figures: &[Figure]) -> Vec<Verdict> {
        let own = figures
            .iter()
            .filter(|figure| self.is_of(&figure.case, &figure.method));
        let verdict = |figure: &Figure| {
            let name = format!("{} {}", figure.case, figure.method);
            let value = Some(figure.value);
            Some(Verdict {
                note: figure.note.clone(),
                ..Verdict::new(figure.suite, name, value, figure.unit, figure.bar?)
            })
        };
        own.filter_map(verdict).collect()
    }

    fn of_hard(&self, rows: &[HardRow]) -> Vec<Verdict> {
        let own = rows.iter().filter(|row| matches(self.case, &row.case));
        let verdict = |row: &HardRow| Verdict {
            note: row.wrong.join("; "),
            ..Verdict::new(
                row.suite,
                format!("{}: wrong figures", row.case),
                Some(row.wrong.len() as f64),
                "1",
                Bar::AtMost(0.0),
            )
        };
        own.map(verdict).collect()
    }
}

/// A line for each cell that has a bar, and for each claim.
fn of_report(report: &Report) -> Vec<Verdict> {
    let mut verdicts = Vec::new();
    for row in &report.rows {
        let name = |cell: &Cell| format!("{}, {}: {}", report.scenario, row.run, cell.measure);
        for cell in &row.cells {
            let bars = [
                cell.at_least.map(Bar::AtLeast),
                cell.at_most.map(Bar::AtMost),
            ];
            verdicts.extend(
                bars.into_iter()
                    .flatten()
                    .map(|bar| Verdict::new("scenario", name(cell), cell.value, &cell.unit, bar)),
            );
        }
    }
    for claim in report.claims.iter().filter(|claim| !claim.reported) {
        let name = format!("{}: {}", report.scenario, claim.says);
        let holds = claim.holds.map(|holds| f64::from(u8::from(holds)));
        verdicts.push(Verdict::new(
            "scenario",
            name,
            holds,
            "1",
            Bar::AtLeast(1.0),
        ));
    }
    verdicts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cases, Times};

    const PROMISE: Promise = Promise {
        suite: Suite::Contact,
        case: "plane/*",
        method: "exact",
        field: Field::Error,
        bar: Bar::AtMost(1e-10),
        quick: true,
    };

    fn row(case: &str, method: &str, error: f64, median_s: f64) -> Row {
        let times = Times {
            median_s,
            p99_s: median_s,
            n: 1,
        };
        Row::new("contact", case, method)
            .timed(times)
            .off_by(error, "m")
    }

    fn peer(method: &str, median_s: f64) -> Row {
        Row {
            peer: true,
            ..row("plane/8x8", method, 1e-4, median_s)
        }
    }

    #[test]
    fn a_promise_is_judged_by_the_rows_that_it_names() {
        let rows = [
            row("plane/8x8", "exact", 1e-12, 1e-5),
            row("plane/20x20", "exact", 1e-9, 2e-5),
            row("plane/8x8", "spheres 28", 9e-4, 1e-4),
            row("plane/8x8", "spheres 84", 1e-4, 1e-3),
            peer("slow", 5e-4),
            peer("fast", 3e-4),
            row("mesh/8x8", "exact", 1.0, 1.0),
        ];
        let met: Vec<bool> = PROMISE.of_rows(&rows).iter().map(|v| v.met).collect();
        assert_eq!(met, [true, false]);
        let value = |field, method| {
            let promise = Promise {
                field,
                method,
                case: "plane/8x8",
                ..PROMISE
            };
            promise.of_rows(&rows)[0].value.unwrap()
        };
        assert!((value(Field::Order("spheres 84", 3.0), "spheres 28") - 2.0).abs() < 1e-12);
        assert!((value(Field::ErrorOver("spheres 84"), "exact") - 1e-8).abs() < 1e-20);
        assert!((value(Field::PeersTakeTimesLonger, "exact") - 30.0).abs() < 1e-9);
        assert!((value(Field::TimesLonger("slow"), "exact") - 50.0).abs() < 1e-9);
        let apart = value(Field::ApartFrom("plane/20x20"), "exact");
        assert!((apart - 0.999e-9).abs() < 1e-12, "{apart}");
    }

    #[test]
    fn what_was_not_measured_is_missed() {
        let rows = [Row::new("contact", "plane/8x8", "exact").saying("refused")];
        let verdict = &PROMISE.of_rows(&rows)[0];
        assert!(!verdict.met && verdict.note == "refused");
        assert!(
            verdict
                .text()
                .starts_with("MISSED contact plane/8x8 exact: error: none")
        );
        assert!(PROMISE.of_rows(&[]).is_empty());
    }

    #[test]
    fn promises_ask_their_suites_for_their_cases_only() {
        let rows = PROMISE.rows();
        let cases = Cases::Rows(&rows);
        assert!(cases.has("plane/8x8") && !cases.has("point/8x8/cold"));
        let promise = Promise {
            case: "indent/12/x1",
            method: "lattice implicit",
            ..PROMISE
        };
        let rows = promise.rows();
        let cases = Cases::Rows(&rows);
        assert!(cases.has("indent/12/x1") && cases.has("indent/12/x1/lattice/implicit"));
        assert!(!cases.has("indent/12/x10") && !cases.has("indent/12/x1/continuum/implicit"));
    }
}
