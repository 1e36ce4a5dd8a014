//! Are two sets of figures the same, within tolerances?

use super::{Figures, ToolFigures};
use serde::{Deserialize, Serialize};

/// How far figures of another version may be off.
///
/// The contact solve is iterated to the last bits, so that another order of sums moves a force by
/// some 1e-12 of itself; over thousands of ticks of contact that grows, but stays far below one
/// millionth in sessions as short as the golden ones. What changes the answer (another law, another
/// rule of friction) is far above. Ticks of contact are counted: a touch may begin or end a tick
/// earlier.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerances {
    /// Of forces, relative.
    pub force: f64,
    /// Of depths, relative.
    pub depth: f64,
    /// Of energies, relative to the tool's peak.
    pub energy: f64,
    /// Of displacements, relative.
    pub displacement: f64,
    /// Of ticks in contact: so many for each time that contact began; of the first one: so many.
    pub contact_ticks: u64,
}

impl Default for Tolerances {
    fn default() -> Self {
        Self {
            force: 1e-6,
            depth: 1e-6,
            energy: 1e-6,
            displacement: 1e-6,
            contact_ticks: 1,
        }
    }
}

impl Tolerances {
    pub(super) fn check(&self) -> Result<(), String> {
        let shares = [self.force, self.depth, self.energy, self.displacement];
        match shares.iter().find(|share| !(0.0..=1.0).contains(*share)) {
            Some(share) => Err(format!("a tolerance is {share}; it must be 0 to 1")),
            None => Ok(()),
        }
    }
}

/// A figure that is off.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Deviation {
    /// For example `tools.ball.peak_force_n`.
    pub figure: String,
    /// As written down.
    pub expected: String,
    /// As simulated now.
    pub found: String,
    /// How far apart they are, in the figure's unit.
    pub apart: Option<f64>,
    /// How far they may be.
    pub allowed: Option<f64>,
}

impl std::fmt::Display for Deviation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{}: {} expected, {} found",
            self.figure, self.expected, self.found
        )?;
        match (self.apart, self.allowed) {
            (Some(apart), Some(allowed)) => write!(f, " ({apart:e} apart, {allowed:e} allowed)"),
            _ => Ok(()),
        }
    }
}

/// Figures that are farther apart than `expected` allows; with `exact`, all that are not equal.
pub fn deviations(expected: &Figures, found: &Figures, exact: bool) -> Vec<Deviation> {
    let mut list = List {
        found: Vec::new(),
        exact,
    };
    let tolerances = &expected.tolerances;
    list.text("scene", &expected.scene, &found.scene);
    list.text(
        "ticks",
        &expected.ticks.to_string(),
        &found.ticks.to_string(),
    );
    let ids = |figures: &Figures| -> Vec<String> {
        let tools = figures.tools.iter().map(|tool| format!("tool {}", tool.id));
        tools
            .chain(
                figures
                    .bodies
                    .iter()
                    .map(|body| format!("body {}", body.id)),
            )
            .collect()
    };
    list.text(
        "tools and bodies",
        &ids(expected).join(", "),
        &ids(found).join(", "),
    );
    for (a, b) in expected.tools.iter().zip(&found.tools) {
        list.tool(tolerances, a, b);
    }
    for (a, b) in expected.bodies.iter().zip(&found.bodies) {
        let (a_m, b_m) = (a.peak_displacement_m, b.peak_displacement_m);
        let name = format!("bodies.{}.peak_displacement_m", a.id);
        list.number(name, a_m, b_m, tolerances.displacement * a_m.abs());
    }
    list.found
}

struct List {
    found: Vec<Deviation>,
    exact: bool,
}

impl List {
    fn text(&mut self, figure: &str, expected: &str, found: &str) {
        if expected != found {
            let (figure, expected, found) = (figure.into(), expected.into(), found.into());
            self.found.push(Deviation {
                figure,
                expected,
                found,
                apart: None,
                allowed: None,
            });
        }
    }

    fn number(&mut self, figure: String, expected: f64, found: f64, allowed: f64) {
        let allowed = if self.exact { 0.0 } else { allowed };
        let apart = (expected - found).abs();
        // Not a number is never near enough.
        if apart <= allowed {
            return;
        }
        let (expected, found) = (format!("{expected:e}"), format!("{found:e}"));
        self.found.push(Deviation {
            figure,
            expected,
            found,
            apart: Some(apart),
            allowed: Some(allowed),
        });
    }

    fn tool(&mut self, tolerances: &Tolerances, a: &ToolFigures, b: &ToolFigures) {
        let name = |figure: &str| format!("tools.{}.{figure}", a.id);
        let energy_j = tolerances.energy * a.peak_energy_j;
        let numbers = [
            (
                "peak_force_n",
                a.peak_force_n,
                b.peak_force_n,
                tolerances.force * a.peak_force_n,
            ),
            (
                "rms_force_n",
                a.rms_force_n,
                b.rms_force_n,
                tolerances.force * a.rms_force_n,
            ),
            (
                "peak_depth_m",
                a.peak_depth_m,
                b.peak_depth_m,
                tolerances.depth * a.peak_depth_m,
            ),
            ("energy_j", a.energy_j, b.energy_j, energy_j),
            ("peak_energy_j", a.peak_energy_j, b.peak_energy_j, energy_j),
            ("dissipated_j", a.dissipated_j, b.dissipated_j, energy_j),
        ];
        for (figure, a, b, allowed) in numbers {
            self.number(name(figure), a, b, allowed);
        }
        let ticks = tolerances.contact_ticks as f64;
        let allowed = ticks * a.contact_phases as f64;
        self.number(
            name("contact_ticks"),
            a.contact_ticks as f64,
            b.contact_ticks as f64,
            allowed,
        );
        // A grazing touch may be one or two: how often contact began is reported, and compared only
        // when it must be equal.
        if self.exact {
            self.number(
                name("contact_phases"),
                a.contact_phases as f64,
                b.contact_phases as f64,
                0.0,
            );
        }
        match (a.first_contact_tick, b.first_contact_tick) {
            (Some(a), Some(b)) => {
                self.number(name("first_contact_tick"), a as f64, b as f64, ticks)
            }
            (a, b) => {
                let text = |tick: Option<u64>| tick.map_or("none".into(), |tick| tick.to_string());
                self.text(&name("first_contact_tick"), &text(a), &text(b));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::BodyFigures;

    fn figures() -> Figures {
        let tool = ToolFigures {
            id: "ball".into(),
            peak_force_n: 2.0,
            rms_force_n: 1.0,
            peak_depth_m: 1e-3,
            energy_j: 1e-9,
            peak_energy_j: 1e-2,
            dissipated_j: 0.0,
            contact_ticks: 100,
            contact_phases: 3,
            first_contact_tick: Some(40),
        };
        Figures {
            format: super::super::FORMAT.into(),
            scene: "test".into(),
            ticks: 1_000,
            tolerances: Tolerances::default(),
            tools: vec![tool],
            bodies: vec![BodyFigures {
                id: "drop".into(),
                peak_displacement_m: 2e-3,
            }],
            hashes: None,
        }
    }

    #[test]
    fn figures_are_the_same_up_to_their_tolerance_and_no_farther() {
        type FigureEdit = fn(&mut Figures, f64);
        let edits: [(&str, FigureEdit); 8] = [
            ("tools.ball.peak_force_n", |f, off| {
                f.tools[0].peak_force_n += 2e-6 * off
            }),
            ("tools.ball.rms_force_n", |f, off| {
                f.tools[0].rms_force_n -= 1e-6 * off
            }),
            ("tools.ball.peak_depth_m", |f, off| {
                f.tools[0].peak_depth_m += 1e-9 * off
            }),
            // Of the peak: what is left of an energy may be next to nothing.
            ("tools.ball.energy_j", |f, off| {
                f.tools[0].energy_j += 1e-8 * off
            }),
            ("tools.ball.dissipated_j", |f, off| {
                f.tools[0].dissipated_j += 1e-8 * off
            }),
            ("tools.ball.contact_ticks", |f, off| {
                f.tools[0].contact_ticks += (3.0 * off) as u64
            }),
            ("tools.ball.first_contact_tick", |f, off| {
                f.tools[0].first_contact_tick = Some(40 + off as u64)
            }),
            ("bodies.drop.peak_displacement_m", |f, off| {
                f.bodies[0].peak_displacement_m += 2e-9 * off
            }),
        ];
        for (figure, edit) in edits {
            let (mut near, mut far) = (figures(), figures());
            edit(&mut near, if figure.contains("tick") { 1.0 } else { 0.99 });
            edit(&mut far, 2.01);
            assert_eq!(deviations(&figures(), &near, false), [], "{figure}");
            assert_eq!(deviations(&figures(), &near, true).len(), 1, "{figure}");
            let found = deviations(&figures(), &far, false);
            assert!(
                found.len() == 1 && found[0].figure == figure,
                "{figure}: {found:?}"
            );
        }
    }

    #[test]
    fn nan_and_a_touch_that_never_came_are_off() {
        let mut other = figures();
        other.tools[0].peak_force_n = f64::NAN;
        other.tools[0].first_contact_tick = None;
        let found: Vec<String> = deviations(&figures(), &other, false)
            .iter()
            .map(ToString::to_string)
            .collect();
        assert_eq!(found.len(), 2, "{found:?}");
        assert_eq!(
            found[1],
            "tools.ball.first_contact_tick: 40 expected, none found"
        );
    }
}
