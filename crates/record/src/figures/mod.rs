//! Figures of a session that another version must come to again: forces, depths, energies,
//! contacts, displacements.
//!
//! Bits are promised by the same build only. What a change of the program may not change, beyond a
//! tolerance, is written into `FILE.figures.json` beside the recording, with the tolerances, and
//! held against a new simulation of the same inputs.
//!
//! A recording that is reduced to its inputs has hashes there as well: they take the place of its
//! outputs, in as many bytes as git keeps for each change of them without pain.

mod compare;
mod hashes;
mod simulate;

pub use compare::{Deviation, Tolerances, deviations};
pub(super) use hashes::Hasher;
pub use hashes::{HashDifference, Hashes};
pub use simulate::{Simulation, simulate, simulate_figures};

use palpate_geometry::math::Point3;
use palpate_proto::text::without_value;
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;
use palpate_sim::tick::flags;
use palpate_sim::tick::quantity::{Number, ToolTick};
use palpate_sim::tick::record::{TickOutput, ToolOutput};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Layout of the file.
const FORMAT: &str = "palpate.figures.v1";

/// Why figures could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FiguresError {
    /// No figures yet.
    #[error("{}: {source}; `palpate replay FILE --check figures --bless` writes it", path.display())]
    Io {
        /// The file of figures.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// Figures alone.
    #[error("{}: it has no hashes; `palpate replay FILE --check hashes --bless` adds them", .0.display())]
    NoHashes(PathBuf),
    /// Figures of another session.
    #[error("{}: it is of another session: its {what} is {expected:?}, that of this one {found:?}", path.display())]
    OtherSession {
        /// The file.
        path: PathBuf,
        /// What is another.
        what: &'static str,
        /// In the file.
        expected: String,
        /// In the session.
        found: String,
    },
    /// A file of something else.
    #[error("{}: not figures of this version: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
}

/// Figures of a session, with how far another version may be from them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figures {
    /// `palpate.figures.v1`.
    pub format: String,
    /// Scene name.
    pub scene: String,
    /// Ticks.
    pub ticks: u64,
    /// How far off is still the same.
    pub tolerances: Tolerances,
    /// By tool.
    pub tools: Vec<ToolFigures>,
    /// By body.
    pub bodies: Vec<BodyFigures>,
    /// Of all states and outputs, for the build that wrote them and others that give the same bits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hashes: Option<Hashes>,
}

/// Figures of a tool.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolFigures {
    /// Id.
    pub id: String,
    /// Largest force for the device, N.
    pub peak_force_n: f64,
    /// Root of the mean square of the force over all ticks, N.
    pub rms_force_n: f64,
    /// Deepest penetration of the device's tool, m.
    pub peak_depth_m: f64,
    /// Work of the hand at the end, J.
    pub energy_j: f64,
    /// Largest amount of that work at any tick, J: what errors of energies are measured against.
    pub peak_energy_j: f64,
    /// What the passivity controller took away, J.
    pub dissipated_j: f64,
    /// Ticks in contact.
    pub contact_ticks: u64,
    /// Times that contact began.
    pub contact_phases: u64,
    /// First tick in contact.
    pub first_contact_tick: Option<u64>,
}

/// Figures of a body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyFigures {
    /// Id.
    pub id: String,
    /// Farthest that any control point was from its place at rest, m.
    pub peak_displacement_m: f64,
}

/// Sums a tool's ticks up.
#[derive(Clone, Debug)]
pub(super) struct ToolSum {
    figures: ToolFigures,
    /// Force, depth, energy and what was dissipated.
    numbers: [Number; 4],
    ticks: u64,
    squares_n2: f64,
    touching: bool,
}

impl ToolSum {
    pub fn new(id: String) -> Self {
        Self {
            figures: ToolFigures {
                id,
                ..ToolFigures::default()
            },
            numbers: ["force", "depth", "energy", "dissipated"]
                .map(|name| Number::named(name).expect("in the table")),
            ticks: 0,
            squares_n2: 0.0,
            touching: false,
        }
    }

    pub fn push(&mut self, tick: u64, output: &ToolOutput) {
        let figures = &mut self.figures;
        let of = ToolTick::from(output);
        let [force_n, depth_m, energy_j, dissipated_j] = self.numbers.map(|number| number.of(&of));
        self.ticks += 1;
        self.squares_n2 += force_n * force_n;
        figures.peak_force_n = figures.peak_force_n.max(force_n);
        let touching = output.contact.is_some();
        if touching {
            // A tool that no one holds stays where it was left, and what it presses comes back over it.
            if output.flags & flags::STALE == 0 {
                figures.peak_depth_m = figures.peak_depth_m.max(depth_m);
            }
            figures.contact_ticks += 1;
            figures.contact_phases += u64::from(!self.touching);
            figures.first_contact_tick.get_or_insert(tick);
        }
        self.touching = touching;
        (figures.energy_j, figures.dissipated_j) = (energy_j, dissipated_j);
        figures.peak_energy_j = figures.peak_energy_j.max(energy_j.abs());
    }

    pub fn finish(&self) -> ToolFigures {
        let rms_force_n = if self.ticks == 0 {
            0.0
        } else {
            libm::sqrt(self.squares_n2 / self.ticks as f64)
        };
        ToolFigures {
            rms_force_n,
            ..self.figures.clone()
        }
    }
}

/// Sums the ticks of a simulation up.
struct Sum<'a> {
    scene: &'a Scene,
    ticks: u64,
    tools: Vec<ToolSum>,
    /// By body: farthest so far, m, and a net to copy into.
    bodies: Vec<(f64, Vec<Point3>)>,
}

impl<'a> Sum<'a> {
    fn new(scene: &'a Scene) -> Self {
        let bodies = (0..scene.body_count()).map(|body| (0.0, scene.skin(body).points().to_vec()));
        let tools =
            (0..scene.tool_count()).map(|tool| ToolSum::new(scene.tool_id(tool).to_owned()));
        Self {
            scene,
            ticks: 0,
            tools: tools.collect(),
            bodies: bodies.collect(),
        }
    }

    fn push(&mut self, output: &TickOutput, state: &SceneState) {
        self.ticks += 1;
        let outputs = output.tools.first(self.tools.len());
        self.tools
            .iter_mut()
            .zip(outputs)
            .for_each(|(sum, output_of)| sum.push(output.tick, output_of));
        for (body, (farthest_m, net)) in self
            .bodies
            .iter_mut()
            .enumerate()
            .filter(|(b, _)| self.scene.deforms(*b))
        {
            state.copy_net(self.scene, body, net);
            let rest = self.scene.skin(body).points();
            let apart = net.iter().zip(rest).map(|(now, rest)| (now - rest).norm());
            *farthest_m = apart.fold(*farthest_m, f64::max);
        }
    }

    fn finish(self) -> Figures {
        let bodies = self
            .bodies
            .iter()
            .enumerate()
            .map(|(body, (peak_displacement_m, _))| BodyFigures {
                id: self.scene.body_id(body).to_owned(),
                peak_displacement_m: *peak_displacement_m,
            });
        Figures {
            format: FORMAT.into(),
            scene: self.scene.name.clone(),
            ticks: self.ticks,
            tolerances: Tolerances::default(),
            tools: self.tools.iter().map(ToolSum::finish).collect(),
            bodies: bodies.collect(),
            hashes: None,
        }
    }
}

impl Figures {
    /// Where the figures of a recording are: its name with `.figures.json` behind.
    pub fn path_for(recording: &Path) -> PathBuf {
        PathBuf::from(format!("{}.figures.json", recording.display()))
    }

    /// Reads them.
    ///
    /// # Errors
    /// No such file, or one of something else.
    pub fn read(path: &Path) -> Result<Self, FiguresError> {
        let text = std::fs::read_to_string(path).map_err(|source| FiguresError::Io {
            path: path.to_owned(),
            source,
        })?;
        let wrong = |reason: String| FiguresError::Format {
            path: path.to_owned(),
            reason,
        };
        let figures: Self = serde_json::from_str(&text)
            .map_err(|e| wrong(without_value(&e.to_string()).into_owned()))?;
        if figures.format != FORMAT {
            return Err(wrong(format!("its format is another than {FORMAT:?}")));
        }
        figures.tolerances.check().map_err(wrong)?;
        Ok(figures)
    }

    /// Hashes of the same session as `now` has them: what goes in is the same, what comes out may
    /// differ. `path` is for messages.
    ///
    /// # Errors
    /// No hashes, or those of another session.
    pub fn hashes_of_session(
        &self,
        now: &Simulation,
        path: &Path,
    ) -> Result<&Hashes, FiguresError> {
        let path = || path.to_owned();
        let hashes = self.hashes.as_ref();
        let hashes = hashes.ok_or_else(|| FiguresError::NoHashes(path()))?;
        let list = |figures: &Self, hashes: &Hashes| {
            let ids = figures.tools.iter().map(|tool| tool.id.as_str());
            let ids = ids.chain(figures.bodies.iter().map(|body| body.id.as_str()));
            [
                ("scene", figures.scene.clone()),
                (
                    "list of tools and bodies",
                    ids.collect::<Vec<_>>().join(", "),
                ),
                ("number of ticks", figures.ticks.to_string()),
                ("first tick", hashes.first_tick.to_string()),
                ("length of stretches", hashes.every.to_string()),
                ("hash of inputs", hashes.inputs.clone()),
            ]
        };
        let own = list(self, hashes);
        for ((what, expected), (_, found)) in own.into_iter().zip(list(&now.figures, &now.hashes)) {
            if expected != found {
                return Err(FiguresError::OtherSession {
                    path: path(),
                    what,
                    expected,
                    found,
                });
            }
        }
        Ok(hashes)
    }

    /// Writes them, readable by people.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), FiguresError> {
        let mut text = serde_json::to_string_pretty(self).expect("plain data");
        text.push('\n');
        std::fs::write(path, text).map_err(|source| FiguresError::Io {
            path: path.to_owned(),
            source,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Vector3;
    use palpate_sim::tick::record::ContactReport;

    #[test]
    fn depth_counts_only_while_the_tool_is_held() {
        let output = |depth_m: f64, flags: u32| ToolOutput {
            flags,
            contact: Some(ContactReport {
                body: 0,
                holder: palpate_sim::solve::rows::Holder::Tool(0),
                u: 0.0,
                v: 0.0,
                point: Point3::origin(),
                normal: Vector3::z(),
                depth_m,
                force_n: Vector3::zeros(),
            }),
            ..ToolOutput::default()
        };
        let mut sum = ToolSum::new("ball".into());
        sum.push(1, &output(2e-4, 0));
        sum.push(2, &output(2e-3, flags::STALE | flags::RAMPING));
        let figures = sum.finish();
        assert_eq!((figures.peak_depth_m, figures.contact_ticks), (2e-4, 2));
    }
}
