//! Recordings reduced to what went into their ticks: some twenty bytes a pose instead of a thousand a
//! tick. What came of it is made again by running it.
//!
//! ```text
//! FILE ─▶ Session ─ reduce ─▶ INPUTS.mcap, and hashes of what it came to
//! FILE or INPUTS.mcap ─▶ InputRun: scene, poses, commands, tick by tick ─┬▶ figures and hashes
//!                                                                        └▶ record_again ─▶ a whole recording
//! ```

mod again;
mod column;
mod error;
mod reduce;
mod run;

pub use again::record_again;
pub use error::{InputsError, RunError};
pub use reduce::{Reduced, reduce};
pub use run::Start;
pub(super) use run::{Input, InputRun};

use column::{packed, unpacked};
use palpate_proto::recording as pb;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::spec::MAX_TOOLS;
use palpate_sim::tick::record::{Command, TickInput};
use palpate_wire::{
    ConvertError, command_from_proto, command_to_proto, pose_from_values, pose_values,
};

/// Most ticks in a block.
const MOST_TICKS: usize = 1_000;

/// Inputs of consecutive ticks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputBlock {
    /// The first of the ticks, or the next one if there are none.
    pub tick: u64,
    /// Commands before it, with the ticks after which they act.
    pub commands: Vec<(u64, Command)>,
    /// What goes into each tick.
    pub ticks: Vec<TickInput>,
}

impl InputBlock {
    /// A block of a scene with so many tools.
    fn to_proto(&self, tool_count: usize) -> pb::Inputs {
        let commands = self.commands.iter();
        let tools = (0..tool_count).map(|tool| {
            let poses = self.ticks.iter().map(|input| input.poses[tool].as_ref());
            tool_to_proto(poses)
        });
        pb::Inputs {
            tick: self.tick,
            commands: commands
                .map(|(after_tick, command)| command_to_proto(*after_tick, *command))
                .collect(),
            ticks: self.ticks.len() as u32,
            tools: tools.collect(),
            skipped: if self.ticks.iter().any(|input| input.skipped > 0) {
                self.ticks.iter().map(|input| input.skipped).collect()
            } else {
                Vec::new()
            },
        }
    }

    /// The block again.
    ///
    /// # Errors
    /// Columns of the wrong length, more ticks or tools than a block has, or a command that there is
    /// not.
    pub(super) fn from_proto(block: &pb::Inputs) -> Result<Self, ConvertError> {
        let wrong = |what: String| ConvertError {
            tick: block.tick,
            what,
        };
        let count = block.ticks as usize;
        if count > MOST_TICKS || block.tools.len() > MAX_TOOLS {
            return Err(wrong(format!(
                "{count} ticks of {} tools in a block; at most {MOST_TICKS} of {MAX_TOOLS}",
                block.tools.len()
            )));
        }
        let mut ticks = vec![TickInput::for_tools(block.tools.len()); count];
        for (t, tool) in block.tools.iter().enumerate() {
            let mut poses = tool_from_proto(tool).map_err(wrong)?.into_iter();
            let (mut at, mut fresh) = (0, false);
            for &run in &tool.runs {
                let end = at + run as usize;
                for input in ticks
                    .get_mut(at..end)
                    .into_iter()
                    .flatten()
                    .filter(|_| fresh)
                {
                    input.poses[t] = poses.next();
                }
                (at, fresh) = (end.min(count + 1), !fresh);
            }
            if at != count || poses.next().is_some() {
                return Err(wrong(format!(
                    "poses of tool {t} are not those of {count} ticks"
                )));
            }
        }
        if !block.skipped.is_empty() && block.skipped.len() != count {
            let dropped = block.skipped.len();
            return Err(wrong(format!(
                "deadlines dropped before {dropped} ticks of {count}"
            )));
        }
        for (input, &skipped) in ticks.iter_mut().zip(&block.skipped) {
            input.skipped = skipped;
        }
        let commands = block.commands.iter().map(|command| {
            let after_tick = command.after_tick;
            command_from_proto(command).map(|command| (after_tick, command))
        });
        Ok(Self {
            tick: block.tick,
            commands: commands.collect::<Result<_, _>>()?,
            ticks,
        })
    }
}

fn tool_to_proto<'a>(poses: impl Iterator<Item = Option<&'a DevicePose>>) -> pb::ToolInputs {
    let (mut runs, mut fresh) = (vec![0], false);
    let (mut integers, mut floats) = ([const { Vec::new() }; 3], [const { Vec::new() }; 13]);
    for pose in poses {
        if pose.is_some() != fresh {
            fresh = !fresh;
            runs.push(0);
        }
        *runs.last_mut().unwrap_or_else(|| unreachable!()) += 1;
        let Some(pose) = pose else { continue };
        let numbers = [pose.seq, pose.t_client_ns, pose.buttons.into()];
        integers
            .iter_mut()
            .zip(numbers)
            .for_each(|(to, x)| to.push(x));
        floats
            .iter_mut()
            .zip(pose_values(pose))
            .for_each(|(to, x)| to.push(x));
    }
    pb::ToolInputs {
        runs,
        integers: integers
            .iter()
            .map(|column| packed::<u64>(column))
            .collect(),
        floats: floats.iter().map(|column| packed::<f64>(column)).collect(),
    }
}

fn tool_from_proto(tool: &pb::ToolInputs) -> Result<Vec<DevicePose>, String> {
    let (integers, floats) = (
        columns::<u64, 3>(&tool.integers)?,
        columns::<f64, 13>(&tool.floats)?,
    );
    let count = integers[0].len();
    if integers.iter().any(|column| column.len() != count)
        || floats.iter().any(|column| column.len() != count)
    {
        return Err("columns of a tool have different lengths".into());
    }
    let poses = (0..count).map(|k| {
        let [seq, t_client_ns, buttons] = integers.each_ref().map(|column| column[k]);
        let buttons = u32::try_from(buttons).map_err(|_| format!("buttons {buttons:#x}"))?;
        let values = floats.each_ref().map(|column| column[k]);
        Ok(pose_from_values(seq, t_client_ns, buttons, &values))
    });
    poses.collect()
}

fn columns<T: column::Number, const N: usize>(all: &[pb::Column]) -> Result<[Vec<T>; N], String> {
    let columns: Vec<Vec<T>> = all.iter().map(unpacked).collect::<Result<_, _>>()?;
    let count = columns.len();
    columns
        .try_into()
        .map_err(|_| format!("{count} columns of a tool, not {N}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::{Point3, Rotation, Vector3};

    fn block() -> InputBlock {
        let mut ticks = vec![TickInput::for_tools(2); 7];
        (ticks[1].skipped, ticks[5].skipped) = (3, u32::MAX);
        for (k, tool) in [(0, 1), (2, 0), (3, 0), (3, 1), (6, 0)] {
            ticks[k].poses[tool] = Some(DevicePose {
                seq: k as u64 + 1,
                t_client_ns: u64::MAX - k as u64,
                position: Point3::new(0.1 * k as f64, -0.0, f64::NAN),
                orientation: Rotation::identity(),
                linear_velocity: Vector3::new(1.0 / 3.0, f64::INFINITY, -1e-310),
                angular_velocity: Vector3::zeros(),
                buttons: u32::MAX * (k as u32 % 2),
            });
        }
        InputBlock {
            tick: 41,
            commands: vec![(40, Command::Reset), (40, Command::Quality(2))],
            ticks,
        }
    }

    #[test]
    fn a_block_comes_back_with_every_bit() {
        let message = block().to_proto(2);
        let back = InputBlock::from_proto(&message).unwrap();
        // Not a number is not equal to itself; its bits in a second trip are.
        assert_eq!(back.to_proto(2), message);
        assert_eq!(format!("{back:?}"), format!("{:?}", block()));
        assert_eq!(message.tools[0].runs, [2, 2, 2, 1]);
        assert_eq!(message.tools[1].runs, [0, 1, 2, 1, 3]);
    }

    #[test]
    fn blocks_of_the_wrong_shape_are_refused() {
        type Edit = fn(&mut pb::Inputs);
        let edits: [(&str, Edit); 9] = [
            ("deadlines dropped before 6 ticks of 7", |b| {
                b.skipped.truncate(6)
            }),
            ("at most", |b| b.ticks = MOST_TICKS as u32 + 1),
            ("at most", |b| {
                b.tools.resize(MAX_TOOLS + 1, pb::ToolInputs::default())
            }),
            ("are not those of 8 ticks", |b| b.ticks = 8),
            ("are not those of 7 ticks", |b| {
                b.tools[0].runs = vec![u32::MAX; 5]
            }),
            ("are not those of 7 ticks", |b| b.tools[1].runs = vec![7]),
            ("different lengths", |b| {
                b.tools[0].floats[3].residuals.truncate(1)
            }),
            ("12 columns of a tool, not 13", |b| {
                drop(b.tools[0].floats.pop())
            }),
            ("unknown command", |b| b.commands[0].name = "fly".into()),
        ];
        for (words, edit) in edits {
            let mut message = block().to_proto(2);
            edit(&mut message);
            let error = InputBlock::from_proto(&message).unwrap_err();
            assert!(error.what.contains(words), "{words}: {error}");
        }
    }
}
