//! A figure beside what it is compared with, and the bar that it should reach.

use std::fmt::Write;

/// One figure, beside what it is compared with.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Figure {
    /// Which.
    pub suite: &'static str,
    /// What was asked.
    pub case: String,
    /// In which way, or by whom.
    pub method: String,
    /// The figure.
    pub value: f64,
    /// Its unit; `1` for ratios.
    pub unit: &'static str,
    /// What it is compared with, in the same unit.
    pub reference: f64,
    /// What the reference is.
    pub reference_is: &'static str,
    /// The value must not be beyond this, where there is a bar.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bar: Option<Bar>,
    /// What there is to say beyond that.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// What a figure should reach.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bar {
    /// As much or more.
    AtLeast(f64),
    /// As much or less.
    AtMost(f64),
}

impl Bar {
    /// True for a value that reaches it; what is not a number does not.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Self::AtLeast(bar) => value >= bar,
            Self::AtMost(bar) => value <= bar,
        }
    }
}

impl std::fmt::Display for Bar {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::AtLeast(bar) => write!(f, "≥ {}", short(*bar)),
            Self::AtMost(bar) => write!(f, "≤ {}", short(*bar)),
        }
    }
}

impl Figure {
    /// True if there is no bar or it is reached.
    pub fn is_met(&self) -> bool {
        self.bar.is_none_or(|bar| bar.holds(self.value))
    }
}

/// All figures, a line each.
pub fn figures_table(figures: &[Figure]) -> String {
    let mut text = String::new();
    for figure in figures {
        let bar = figure
            .bar
            .map_or(String::new(), |bar| format!("  bar {bar}"));
        let reference = match figure.reference_is {
            "" => String::new(),
            is => format!(" {is} {}", short(figure.reference)),
        };
        let met = if figure.is_met() { "" } else { "  NOT MET" };
        let unit = if figure.unit == "1" { "" } else { figure.unit };
        let note = if figure.note.is_empty() {
            String::new()
        } else {
            format!("  ({})", figure.note)
        };
        let _ = writeln!(
            text,
            "{:<26} {:<30} {:>10} {unit:<3}{reference}{bar}{met}{note}",
            figure.case,
            figure.method,
            short(figure.value),
        );
    }
    text
}

pub(crate) fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if (1e-2..1e4).contains(&size) => format!("{value:.4}"),
        _ => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_beyond_its_bar_is_told_as_such() {
        let figure = |bar, value| Figure {
            suite: "haptics",
            case: "zwidth/x".to_owned(),
            method: "m".to_owned(),
            value,
            unit: "1",
            reference: 1.0,
            reference_is: "line",
            bar,
            note: String::new(),
        };
        assert!(figure(None, 5.0).is_met());
        assert!(
            figure(Some(Bar::AtLeast(0.9)), 0.9).is_met()
                && !figure(Some(Bar::AtLeast(0.9)), 0.89).is_met()
        );
        assert!(
            figure(Some(Bar::AtMost(0.0)), -1.0).is_met()
                && !figure(Some(Bar::AtMost(0.0)), f64::NAN).is_met()
        );
        let text = figures_table(&[figure(Some(Bar::AtMost(1.0)), 2.0)]);
        assert!(
            text.contains("NOT MET") && text.lines().count() == 1,
            "{text}"
        );
    }
}
