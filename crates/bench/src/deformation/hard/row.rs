//! What a hard case reports, and the run that gathers it.

use super::super::world::World;
use palpate_geometry::math::Vector3;
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::record::TickOutput;
use std::fmt::Write;

/// Energy beyond what was put in that a tick may hold for a moment, of what is there: one iteration is
/// not yet the converged step.
const MOST_EXCESS: f64 = 0.05;
/// Ticks that a case has to last.
const LEAST_TICKS: usize = 10_000;

/// A figure that is known.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Check {
    /// What was compared with what.
    pub what: String,
    /// As found.
    pub value: f64,
    /// As it should be; `None` where only bounds are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub expected: Option<f64>,
    /// Least that is right.
    pub low: f64,
    /// Most that is right.
    pub high: f64,
    /// Unit of the four.
    pub unit: &'static str,
    /// Relative to what is expected; absolute where that is zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
}

impl Check {
    /// What is not a number is wrong.
    pub fn is_right(&self) -> bool {
        self.value >= self.low && self.value <= self.high
    }
}

/// One hard case with one model and method.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct HardRow {
    /// `deformation`.
    pub suite: &'static str,
    /// `hard/CASE/MODEL/METHOD`.
    pub case: String,
    /// Ticks, those of runs that it is compared with left out.
    pub ticks: usize,
    /// Largest energy beyond what was there at the start and what tools put in, relative to the
    /// largest that may have been there; `None` for a case that did not run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_excess: Option<f64>,
    /// Forces and places, with what they should be.
    pub checks: Vec<Check>,
    /// Ticks that reported a fault.
    pub faults: usize,
    /// Median time of a tick, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub median_s: Option<f64>,
    /// What is wrong, in words; empty if nothing is.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wrong: Vec<String>,
}

impl HardRow {
    /// A case that did not run.
    pub(super) fn refused(case: String, why: String) -> Self {
        Self {
            suite: "deformation",
            case,
            ticks: 0,
            energy_excess: None,
            checks: Vec::new(),
            faults: 0,
            median_s: None,
            wrong: vec![why],
        }
    }
}

/// A world that is watched, and what was found in it.
pub(super) struct Run {
    pub world: World,
    checks: Vec<Check>,
}

impl Run {
    /// A scene without gravity.
    pub fn new(text: &str) -> Result<Self, String> {
        Self::under(text, Vector3::zeros())
    }

    /// A scene with this gravity, m/s².
    pub fn under(text: &str, gravity: Vector3) -> Result<Self, String> {
        let mut world = World::new(text)?;
        world.watch_energy(gravity);
        Ok(Self {
            world,
            checks: Vec::new(),
        })
    }

    /// One tick with the first tool there: the force on it, N.
    pub fn at(&mut self, position: [f64; 3]) -> Vector3 {
        self.world.at(position).tools[0].force_n
    }

    /// So many ticks with the first tool there: the last force on it, N.
    pub fn stay(&mut self, position: [f64; 3], ticks: usize) -> Vector3 {
        let each = (0..ticks).map(|_| self.at(position));
        each.last().unwrap_or_default()
    }

    /// One tick with a pose for each of the first tools.
    pub fn posed(&mut self, poses: &[DevicePose]) -> TickOutput {
        self.world.posed(poses)
    }

    /// The first body's base bears this, N, but for a share of it.
    pub fn base_bears(&mut self, force_n: f64, share: f64) -> Result<(), String> {
        let (body, state) = self.world.body()?;
        let base = body.base_reaction_n(state).z.abs();
        self.near(
            "force on the base against that on the tool",
            base,
            force_n,
            share,
            "N",
        );
        Ok(())
    }

    /// A value, but for a share of it.
    pub fn near(&mut self, what: &str, value: f64, expected: f64, share: f64, unit: &'static str) {
        let slack = share * expected.abs();
        self.checks.push(Check {
            what: what.to_owned(),
            value,
            expected: Some(expected),
            low: expected - slack,
            high: expected + slack,
            unit,
            error: Some(value / expected - 1.0),
        });
    }

    /// A size that should be zero.
    pub fn below(&mut self, what: &str, value: f64, most: f64, unit: &'static str) {
        self.checks.push(Check {
            what: what.to_owned(),
            value,
            expected: Some(0.0),
            low: -most,
            high: most,
            unit,
            error: Some(value),
        });
    }

    /// A value between two known ones.
    pub fn between(&mut self, what: &str, value: f64, [low, high]: [f64; 2], unit: &'static str) {
        self.checks.push(Check {
            what: what.to_owned(),
            value,
            expected: None,
            low,
            high,
            unit,
            error: None,
        });
    }

    /// The row, without a name.
    pub fn done(self) -> Result<HardRow, String> {
        let Self { world, checks } = self;
        let (ticks, energy_excess) = (world.ticks_s.len(), world.energy_excess());
        let mut wrong: Vec<String> = checks
            .iter()
            .filter(|check| !check.is_right())
            .map(|check| format!("{}: {:.4e} {}", check.what, check.value, check.unit))
            .collect();
        if world.faults > 0 {
            wrong.push(format!("{} faults", world.faults));
        }
        if energy_excess.is_nan() || energy_excess > MOST_EXCESS {
            wrong.push(format!(
                "{energy_excess:.1e} of the energy came from nowhere"
            ));
        }
        if ticks < LEAST_TICKS {
            wrong.push(format!("only {ticks} ticks"));
        }
        Ok(HardRow {
            suite: "deformation",
            case: String::new(),
            ticks,
            energy_excess: Some(energy_excess),
            checks,
            faults: world.faults,
            median_s: world.median_s(),
            wrong,
        })
    }
}

/// All rows for the eye; empty for none.
pub fn hard_table(rows: &[HardRow]) -> String {
    let mut text = String::new();
    for row in rows {
        let excess = row
            .energy_excess
            .map(|excess| format!("energy excess {excess:>8.1e}  "));
        let median = row
            .median_s
            .map(|median_s| format!("tick p50 {:>8.2} µs  ", median_s * 1e6));
        let _ = writeln!(
            text,
            "{:<40} {:>6} ticks  {}{} faults  {}{}",
            row.case,
            row.ticks,
            excess.unwrap_or_default(),
            row.faults,
            median.unwrap_or_default(),
            if row.wrong.is_empty() {
                "right"
            } else {
                "WRONG"
            },
        );
        for check in &row.checks {
            let _ = writeln!(text, "    {}", said(check));
        }
        for wrong in &row.wrong {
            let _ = writeln!(text, "    WRONG: {wrong}");
        }
    }
    if !rows.is_empty() {
        let wrong = rows.iter().filter(|row| !row.wrong.is_empty()).count();
        let _ = writeln!(text, "{} hard cases, {wrong} wrong", rows.len());
    }
    text
}

fn said(check: &Check) -> String {
    let Check {
        what,
        value,
        expected,
        low,
        high,
        unit,
        error,
    } = check;
    let value = number(*value);
    match (expected, error) {
        (Some(expected), _) if *expected == 0.0 => {
            format!("{what}: {value} {unit}, expected 0, at most {high:.0e}")
        }
        (Some(expected), Some(error)) => {
            let most = high / expected - 1.0;
            let expected = number(*expected);
            format!(
                "{what}: {value} {unit}, expected {expected}, error {error:+.1e}, at most {most:.0e}"
            )
        }
        _ if high.is_infinite() => {
            format!("{what}: {value} {unit}, expected {} or more", number(*low))
        }
        _ => format!(
            "{what}: {value} {unit}, expected from {} to {}",
            number(*low),
            number(*high)
        ),
    }
}

/// A number with the digits that it has.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        format!("{value:.6}")
    } else {
        format!("{value:.3e}")
    }
}
