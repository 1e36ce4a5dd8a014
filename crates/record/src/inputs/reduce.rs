//! Takes the inputs out of a recording.

use super::super::channel::{Channels, Happening, Keyframe, Topic};
use super::super::container::{Container, MessageHead};
use super::super::disk::{create_new, give_name};
use super::super::figures::{Figures, Hasher, Hashes, simulate};
use super::super::file::part_of;
use super::super::format::{
    END, HOLDS, HOLDS_INPUTS, LIBRARY, RUN, SCENE_EFFECTIVE, SCENE_TEXT, WriteError, checked,
};
use super::super::message::Message;
use super::super::reader::{Follower, Session, first_keyframe};
use super::super::replay::{ReplayError, recorded_scene};
use super::super::rerun::Rerun;
use super::error::{InputsError, RunError};
use super::{InputBlock, MOST_TICKS};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use std::sync::Arc;

/// What a recording was reduced to.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced {
    /// Its figures and hashes.
    pub figures: Figures,
    /// Bytes of the new recording.
    pub bytes: u64,
}

/// Writes what went into the ticks of a session to `target`, and beside it what they came to:
/// figures and hashes. The inputs are run to make sure that this build gives every output that is
/// left out.
///
/// # Errors
/// A session that is incomplete, or gives other outputs with this build; a file that exists, or
/// cannot be written. Nothing is left of `target` then.
pub fn reduce(
    session: &Session,
    target: &Path,
    progress: impl FnMut(u64, u64),
) -> Result<Reduced, InputsError> {
    let path = || session.path.clone();
    if session.holds_inputs_only() {
        return Err(InputsError::Reduced(path()));
    }
    let figures_path = Figures::path_for(target);
    for path in [target, &figures_path] {
        if path.exists() {
            return Err(InputsError::Write(WriteError::Exists {
                path: path.to_owned(),
                advice: "move it away, or name another file",
            }));
        }
    }
    let part = part_of(target);
    let io = |source| {
        let path = part.clone();
        InputsError::Write(WriteError::Io { path, source })
    };
    let file = create_new(&part).map_err(io)?;
    let reduced = (|| {
        let (recorded, bytes) = write(session, file, io)?;
        if !session.is_whole() {
            let reason = session.cut_short().unwrap_or("it was not ended");
            return Err(InputsError::Incomplete {
                path: path(),
                reason: reason.to_owned(),
            });
        }
        let inputs = Session::open_any(&part).map_err(RunError::from)?;
        let found = simulate(&inputs, progress)?;
        let (ticks, mut figures) = (found.figures.ticks, found.figures);
        // Nets are not in it for every tick: a replay of the recording compares them.
        let nets = found.hashes.nets.clone();
        let recorded = Hashes { nets, ..recorded };
        if let Some(difference) = recorded.first_difference(&found.hashes, ticks) {
            let build = session.header.run.get("build").cloned();
            return Err(InputsError::Differs {
                path: path(),
                ticks: difference.ticks,
                build: build.unwrap_or_else(|| "another build".to_owned()),
            });
        }
        debug_assert_eq!(recorded, found.hashes, "inputs are written without loss");
        if let Ok(own) = Figures::read(&Figures::path_for(&session.path)) {
            figures.tolerances = own.tolerances;
        }
        figures.hashes = Some(found.hashes);
        figures.write(&figures_path)?;
        give_name(&part, target).map_err(io)?;
        Ok(Reduced { figures, bytes })
    })();
    reduced.inspect_err(|_| {
        for path in [&part, &figures_path] {
            let _ = std::fs::remove_file(path);
        }
    })
}

/// Writes the inputs; gives the hashes of what was recorded, and the bytes of the file.
fn write(
    session: &Session,
    file: File,
    io: impl Fn(io::Error) -> InputsError + Copy,
) -> Result<(Hashes, u64), InputsError> {
    let scene = Arc::new(recorded_scene(session).map_err(RunError::from)?);
    let (from, first) = (0, None);
    let none = RunError::Replay(ReplayError::NoKeyframe { from, first });
    let (place, keyframe) = first_keyframe(session)
        .map_err(RunError::from)?
        .ok_or(none)?;
    // The scene's own start needs no keyframe, and so has none that another version cannot read.
    let own = keyframe.tick == 0 && Rerun::new(&scene).hash() == keyframe.state_hash;
    let keyframe = (!own).then_some(keyframe);
    let tool_count = scene.tool_count();
    let mut file = InputsFile::begin(session, file, keyframe.as_ref(), tool_count).map_err(io)?;
    let mut hasher = Hasher::new(tool_count, session.tick_count());
    let topics = &[Topic::Tick, Topic::Command];
    for happening in Follower::at(session, place).only(topics).reading_ahead() {
        match happening.map_err(RunError::from)? {
            Happening::Tick(record) => {
                let tick = file.block.tick + file.block.ticks.len() as u64;
                if record.output.tick != tick {
                    return Err(RunError::Gap { tick }.into());
                }
                hasher.input(record.output.tick, &record.input);
                hasher.output(&record.output);
                if file.block.ticks.len() == MOST_TICKS {
                    file.end_block().map_err(io)?;
                }
                file.block.ticks.push(record.input);
            }
            Happening::Command(after_tick, command) => {
                hasher.command(after_tick, command);
                if !file.block.ticks.is_empty() {
                    file.end_block().map_err(io)?;
                }
                file.block.commands.push((after_tick, command));
            }
            _ => {}
        }
    }
    let bytes = file.finish(session).map_err(io)?;
    Ok((hasher.finish(), bytes))
}

struct InputsFile {
    mcap: Container<BufWriter<File>>,
    channels: Channels,
    dt_ns: u64,
    tool_count: usize,
    /// Not written yet.
    block: InputBlock,
}

impl InputsFile {
    fn begin(
        session: &Session,
        file: File,
        keyframe: Option<&Keyframe>,
        tool_count: usize,
    ) -> io::Result<Self> {
        let header = &session.header;
        let mut mcap = Container::new(BufWriter::new(file), LIBRARY)?;
        let mut run = header.run.clone();
        run.insert(HOLDS.into(), HOLDS_INPUTS.into());
        mcap.metadata(RUN, &checked(run))?;
        for (name, text) in [
            (SCENE_TEXT, &header.scene_text),
            (SCENE_EFFECTIVE, &header.effective_scene),
        ] {
            mcap.attach(name, "application/toml", 0, 0, text.as_bytes())?;
        }
        let mut topics = vec![Topic::Inputs];
        topics.extend(keyframe.map(|_| Topic::Keyframe));
        let mut file = Self {
            channels: Channels::announce(&mut mcap, &topics, &[]),
            mcap,
            dt_ns: session.dt_ns(),
            tool_count,
            block: InputBlock {
                tick: keyframe.map_or(0, |keyframe| keyframe.tick) + 1,
                ..InputBlock::default()
            },
        };
        if let Some(Keyframe {
            tick,
            state_hash,
            saved,
            ..
        }) = keyframe
        {
            // Commands that it holds stay behind.
            file.put(&Message::keyframe(*tick, *state_hash, 0, saved, 0))?;
        }
        Ok(file)
    }

    fn put(&mut self, message: &Message) -> io::Result<()> {
        let time = message.tick.saturating_mul(self.dt_ns);
        let head = MessageHead {
            channel: self.channels.number(message.topic, 0),
            sequence: message.tick as u32,
            log_time: time,
            publish_time: time,
        };
        self.mcap.message(head, &message.data)
    }

    fn end_block(&mut self) -> io::Result<()> {
        let block = std::mem::take(&mut self.block);
        self.block.tick = block.tick + block.ticks.len() as u64;
        let message = block.to_proto(self.tool_count);
        self.put(&Message::new(Topic::Inputs, block.tick, &message))
    }

    fn finish(mut self, session: &Session) -> io::Result<u64> {
        if self.block.commands.len() + self.block.ticks.len() > 0 {
            self.end_block()?;
        }
        let mut end: BTreeMap<String, String> = session.header.end.clone();
        // Of what came of it nothing is here.
        end.retain(|key, _| !key.ends_with("_hash"));
        self.mcap.metadata(END, &checked(end))?;
        self.mcap.finish()
    }
}
