//! Measures: what is looked at, when, and in which unit it is reported.
//!
//! One module for each that is more than a line: volume outside a prism, penetration, edges, maps.

mod edge;
mod look;
mod penetration;
mod prism;

pub use look::Look;

use super::played::{Played, View};
use palpate_sim::scene::Scene;
use serde::Deserialize;

/// `[[measure]]`: a column of the table.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasureSpec {
    /// Heading.
    pub name: String,
    /// Heading, below.
    #[serde(default)]
    pub unit: String,
    /// From SI to that unit.
    #[serde(default = "one")]
    pub scale: f64,
    /// Decimals.
    #[serde(default = "three")]
    pub digits: usize,
    /// What is looked at.
    pub what: Look,
    /// When.
    #[serde(default)]
    pub when: When,
    /// Runs that it is of; all when empty.
    #[serde(default)]
    pub runs: Vec<String>,
    /// Bars, in the unit of the column, that every run must keep.
    #[serde(default)]
    pub at_least: Option<f64>,
    /// See `at_least`.
    #[serde(default)]
    pub at_most: Option<f64>,
}

fn one() -> f64 {
    1.0
}

fn three() -> usize {
    3
}

impl MeasureSpec {
    /// It is measured in that run.
    pub fn is_of(&self, run: &str) -> bool {
        self.runs.is_empty() || self.runs.iter().any(|name| name == run)
    }

    /// The value keeps the bars; one that could not be measured does not.
    pub fn keeps(&self, value: Option<f64>) -> bool {
        if self.at_least.is_none() && self.at_most.is_none() {
            return true;
        }
        value.is_some_and(|value| {
            self.at_least.is_none_or(|least| value >= least)
                && self.at_most.is_none_or(|most| value <= most)
        })
    }
}

/// When something is looked at, and what is reported of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// After the last tick.
    #[default]
    End,
    /// After the tick nearest to a time, s.
    At(f64),
    /// The greatest from a time on, s, looked at every so many ticks.
    Max(f64, u64),
    /// The least.
    Min(f64, u64),
    /// The mean.
    Mean(f64, u64),
    /// Time after which it stays below a value, s: never is infinite.
    StaysBelow(f64),
}

/// A measure at work in one run.
#[derive(Debug)]
pub struct Meter {
    pub spec: MeasureSpec,
    start: look::Start,
    ticks: u64,
    sum: f64,
    count: u64,
    value: Option<f64>,
}

impl Meter {
    /// Nothing seen yet.
    pub fn new(spec: &MeasureSpec) -> Self {
        Self {
            spec: spec.clone(),
            start: look::Start::default(),
            ticks: 0,
            sum: 0.0,
            count: 0,
            value: None,
        }
    }

    /// Looks at the scene before the first tick: names that it has, what is relative to rest.
    pub fn begin(&mut self, scene: &Scene) -> Result<(), String> {
        self.start = self.spec.what.begin(scene)?;
        Ok(())
    }

    /// Looks at a tick, if it is to.
    pub fn tick(&mut self, view: &View<'_>) {
        self.ticks += 1;
        let half_s = 0.5 * view.scene.dt_s;
        let (from_s, every) = match self.spec.when {
            When::End => return,
            When::At(time_s) => {
                if (view.time_s - time_s).abs() <= half_s {
                    self.value = self.look(view);
                }
                return;
            }
            When::StaysBelow(bar) => {
                let below = self.look(view).is_some_and(|value| value < bar);
                self.value = match (below, self.value) {
                    (false, _) => Some(f64::INFINITY),
                    (true, Some(since)) if since.is_finite() => Some(since),
                    (true, _) => Some(view.time_s),
                };
                return;
            }
            When::Max(from_s, every) | When::Min(from_s, every) | When::Mean(from_s, every) => {
                (from_s, every)
            }
        };
        if view.time_s + half_s < from_s || !self.ticks.is_multiple_of(every.max(1)) {
            return;
        }
        let Some(value) = self.look(view) else { return };
        (self.sum, self.count) = (self.sum + value, self.count + 1);
        self.value = Some(match (self.spec.when, self.value) {
            (When::Max(..), Some(most)) => most.max(value),
            (When::Min(..), Some(least)) => least.min(value),
            (When::Mean(..), _) => self.sum / self.count as f64,
            (_, _) => value,
        });
    }

    /// After the last tick.
    pub fn finish(&mut self, view: &View<'_>, played: &Played) {
        if let Some(value) = self.spec.what.after(played) {
            self.value = value;
        } else if self.spec.when == When::End {
            self.value = self.look(view);
        }
    }

    fn look(&self, view: &View<'_>) -> Option<f64> {
        let value = self.spec.what.look(view, &self.start)?;
        value.is_finite().then_some(value)
    }

    /// In the unit of the column; `None` if there was nothing to measure.
    pub fn value(&self) -> Option<f64> {
        self.value.map(|value| value * self.spec.scale)
    }
}
