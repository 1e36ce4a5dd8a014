//! The suites by name, and what rows of them measure.

use crate::deformation::{HardRow, deformation, hard_cases};
use crate::figure::Figure;
use crate::haptics::haptics;
use crate::{Cases, Effort, Row, contact, modeling, parts, recording, scaling, surface, viewer};

/// Where something is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Suite {
    Surface,
    Contact,
    Parts,
    Deformation,
    Scaling,
    Hard,
    Modeling,
    Haptics,
    Recording,
    Viewer,
    Scenario,
}

/// What a suite handed out.
#[derive(Default)]
pub(crate) struct Measured {
    pub rows: Vec<Row>,
    pub figures: Vec<Figure>,
    pub hard: Vec<HardRow>,
    /// What could not be measured, with the reason.
    pub failed: Vec<String>,
}

impl Suite {
    /// Those that take little time first.
    pub(crate) const ALL: [Self; 11] = [
        Self::Surface,
        Self::Contact,
        Self::Parts,
        Self::Modeling,
        Self::Deformation,
        Self::Scaling,
        Self::Haptics,
        Self::Scenario,
        Self::Hard,
        Self::Recording,
        Self::Viewer,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Surface => "surface",
            Self::Contact => "contact",
            Self::Parts => "parts",
            Self::Deformation | Self::Hard => "deformation",
            Self::Modeling => "modeling",
            Self::Scaling => "scaling",
            Self::Haptics => "haptics",
            Self::Recording => "recording",
            Self::Viewer => "viewer",
            Self::Scenario => "scenario",
        }
    }

    /// Measures these rows ([`Cases::Rows`]), and perhaps more. Scenarios have reports instead.
    pub(crate) fn run(self, effort: Effort, rows: &[String]) -> Measured {
        let cases = Cases::Rows(rows);
        let mut all = Measured::default();
        match self {
            Self::Surface => surface(effort, cases, &mut |row| all.rows.push(row)),
            Self::Contact => contact(effort, cases, &mut |row| all.rows.push(row)),
            Self::Parts => parts(effort, cases, &mut |row| all.rows.push(row)),
            Self::Modeling => modeling(effort, cases, &mut |row| all.rows.push(row)),
            Self::Scaling => scaling(effort, cases, &mut |row| all.rows.push(row)),
            Self::Deformation => drop(deformation(effort, cases, &mut |row| all.rows.push(row))),
            Self::Hard => hard_cases(cases, &mut |row| all.hard.push(row)),
            Self::Haptics => {
                all.failed = haptics(effort, cases, &mut |figure| all.figures.push(figure)).failed;
            }
            Self::Recording => {
                all.failed = recording(effort, cases, &mut |figure| all.figures.push(figure));
            }
            Self::Viewer => {
                all.failed = viewer(effort, cases, &mut |figure| all.figures.push(figure));
            }
            Self::Scenario => {}
        }
        all
    }
}

/// A row as [`Cases::Rows`] has it.
pub(crate) fn row_of(case: &str, method: &str) -> String {
    match case.contains('*') {
        true => case.to_owned(),
        false => format!("{case}/{}", method.replace(' ', "/")),
    }
}

/// True if a name is this; one `*` in it stands for anything.
pub(crate) fn matches(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        Some((begin, end)) => name
            .strip_prefix(begin)
            .is_some_and(|rest| rest.ends_with(end)),
        None => name == pattern,
    }
}
