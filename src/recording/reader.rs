//! Reads a session, finished or cut short.

use super::convert::{ConvertError, command_from_proto, tick_from_proto};
use super::file::{END, RUN, SCENE_EFFECTIVE, SCENE_TEXT};
use super::{FORMAT_VERSION, topics};
use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use palpate_geometry::math::SavedState;
use palpate_proto::recording as pb;
use palpate_sim::tick::record::{Command, TickRecord};
use prost::Message as _;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Why a file could not be read as a session.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file system.
    #[error("{path}: {source}")]
    Io {
        /// File.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// Not an MCAP file.
    #[error("{path}: not an MCAP file ({reason})")]
    NotMcap {
        /// File.
        path: PathBuf,
        /// What the reader met.
        reason: String,
    },
    /// An MCAP file of something else.
    #[error("{path}: an MCAP file, but not a Palpate recording: {missing} is missing")]
    Foreign {
        /// File.
        path: PathBuf,
        /// What.
        missing: &'static str,
    },
    /// A later layout.
    #[error(
        "{path}: recording format {found}, this program reads {FORMAT_VERSION}; use the program that made it"
    )]
    Format {
        /// File.
        path: PathBuf,
        /// Its version.
        found: String,
    },
    /// A message that does not hold what its type promises.
    #[error("{path}: {source}")]
    Message {
        /// File.
        path: PathBuf,
        /// Cause.
        source: ConvertError,
    },
}

/// Head of a session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SessionHeader {
    /// Metadata from the start: build, scene, dt_ns, tools, bodies…
    pub run: BTreeMap<String, String>,
    /// Metadata from the end; empty when the file was cut short.
    pub end: BTreeMap<String, String>,
    /// Scene file as written.
    pub scene_text: String,
    /// Scene as built.
    pub effective_scene: String,
}

/// A state to start a replay from.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframe {
    /// The state is that after this tick.
    pub tick: u64,
    /// Its hash.
    pub state_hash: u64,
    /// How many of the commands after that tick it holds already: those up to a reset.
    pub commands: u32,
    /// The state.
    pub saved: SavedState,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EventRecord {
    /// When.
    pub tick: u64,
    /// For example `tool_joined`.
    pub kind: String,
    /// Words about it.
    pub detail: String,
}

/// A net as recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct NetRecord {
    /// After this tick.
    pub tick: u64,
    /// Revision.
    pub revision: u64,
    /// Body id.
    pub body: String,
    /// x y z of each point, m.
    pub points: Vec<f64>,
}

/// A whole session in memory, each list ordered by tick.
#[derive(Clone, Debug)]
pub struct Session {
    /// File it came from.
    pub path: PathBuf,
    /// Head.
    pub header: SessionHeader,
    /// Every tick.
    pub ticks: Vec<TickRecord>,
    /// Full states.
    pub keyframes: Vec<Keyframe>,
    /// Commands with the tick after which they act.
    pub commands: Vec<(u64, Command)>,
    /// Nets.
    pub nets: Vec<NetRecord>,
    /// What happened.
    pub events: Vec<EventRecord>,
    /// Why reading stopped before the end, if it did.
    pub cut_short: Option<String>,
}

impl Session {
    /// Reads all that can be read.
    ///
    /// # Errors
    /// Not a file, not MCAP, not ours, or of another format. A file cut short is no error: see
    /// [`Session::cut_short`].
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let bytes = std::fs::read(path).map_err(|source| ReadError::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(path, &bytes)
    }

    /// [`Session::open`] on bytes at hand; `path` is for messages.
    ///
    /// # Errors
    /// As there.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, ReadError> {
        let owned = || path.to_owned();
        if !bytes.starts_with(mcap::MAGIC) {
            return Err(ReadError::NotMcap {
                path: owned(),
                reason: "the first eight bytes are not its magic".into(),
            });
        }
        let header = SessionHeader {
            run: BTreeMap::new(),
            end: BTreeMap::new(),
            scene_text: String::new(),
            effective_scene: String::new(),
        };
        let mut session = Self {
            path: owned(),
            header,
            ticks: Vec::new(),
            keyframes: Vec::new(),
            commands: Vec::new(),
            nets: Vec::new(),
            events: Vec::new(),
            cut_short: None,
        };
        // A channel is announced in the first chunk that uses it and once more at the end: should
        // the chunk be damaged.
        let mut channels: BTreeMap<u16, String> = records(bytes)
            .filter_map(|record| match record {
                Ok((Record::Channel(channel), _)) => Some((channel.id, channel.topic)),
                _ => None,
            })
            .collect();
        let mut ended = false;
        for record in records(bytes) {
            let (record, whole) = match record {
                Ok(both) => both,
                Err(e) => {
                    session.cut_short.get_or_insert(e);
                    continue;
                }
            };
            match record {
                Record::Metadata(metadata) if metadata.name == RUN => {
                    session.header.run = metadata.metadata
                }
                Record::Metadata(metadata) if metadata.name == END => {
                    session.header.end = metadata.metadata
                }
                Record::Attachment { header, data, .. } => {
                    let text = String::from_utf8_lossy(&data).into_owned();
                    match header.name.as_str() {
                        SCENE_TEXT => session.header.scene_text = text,
                        SCENE_EFFECTIVE => session.header.effective_scene = text,
                        _ => {}
                    }
                }
                Record::Chunk { .. } => match chunk_records(whole) {
                    Ok(records) => session.take_all(&mut channels, records).map_err(|source| {
                        ReadError::Message {
                            path: owned(),
                            source,
                        }
                    })?,
                    // What follows a damaged chunk is as good as ever.
                    Err(e) => drop(
                        session
                            .cut_short
                            .get_or_insert(format!("a damaged chunk: {e}")),
                    ),
                },
                message @ Record::Message { .. } => session
                    .take_all(&mut channels, vec![message])
                    .map_err(|source| ReadError::Message {
                        path: owned(),
                        source,
                    })?,
                Record::Footer(_) => ended = true,
                _ => {}
            }
        }
        if !ended && session.cut_short.is_none() {
            session.cut_short = Some("the file ends before its footer".into());
        }
        session.check()?;
        session.ticks.sort_by_key(|record| record.output.tick);
        // Stable: keyframes and commands of one tick stay in the order in which they came.
        session.keyframes.sort_by_key(|keyframe| keyframe.tick);
        session.commands.sort_by_key(|(after_tick, _)| *after_tick);
        session.nets.sort_by_key(|net| net.tick);
        session.events.sort_by_key(|event| event.tick);
        Ok(session)
    }

    /// Takes messages in, and the channels announced among them.
    fn take_all(
        &mut self,
        channels: &mut BTreeMap<u16, String>,
        records: Vec<Record<'_>>,
    ) -> Result<(), ConvertError> {
        for record in records {
            match record {
                Record::Channel(channel) => drop(channels.insert(channel.id, channel.topic)),
                // Topics mean what we think only after our own head.
                Record::Message { header, data } if self.header.run.contains_key("format") => {
                    self.take(
                        channels.get(&header.channel_id).map_or("", String::as_str),
                        &data,
                    )?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn take(&mut self, topic: &str, data: &[u8]) -> Result<(), ConvertError> {
        let malformed = |e: prost::DecodeError| ConvertError {
            tick: 0,
            what: format!("{topic}: {e}"),
        };
        match topic {
            topics::TICK => self.ticks.push(tick_from_proto(
                &pb::Tick::decode(data).map_err(malformed)?,
            )?),
            topics::KEYFRAME => {
                let keyframe = pb::Keyframe::decode(data).map_err(malformed)?;
                let pb::Keyframe {
                    tick,
                    state_hash,
                    words,
                    floats,
                    commands,
                } = keyframe;
                self.keyframes.push(Keyframe {
                    tick,
                    state_hash,
                    commands,
                    saved: SavedState { words, floats },
                });
            }
            topics::COMMAND => {
                let command = pb::Command::decode(data).map_err(malformed)?;
                self.commands
                    .push((command.after_tick, command_from_proto(&command)?));
            }
            topics::EVENT => {
                let pb::Event { tick, kind, detail } =
                    pb::Event::decode(data).map_err(malformed)?;
                self.events.push(EventRecord { tick, kind, detail });
            }
            _ if topic.starts_with("/body/") => {
                let net = pb::ControlNet::decode(data).map_err(malformed)?;
                self.nets.push(NetRecord {
                    tick: net.tick,
                    revision: net.revision,
                    body: net.body,
                    points: net.points,
                });
            }
            _ => {}
        }
        Ok(())
    }

    fn check(&self) -> Result<(), ReadError> {
        let path = || self.path.clone();
        match self.header.run.get("format") {
            None => {
                return Err(ReadError::Foreign {
                    path: path(),
                    missing: "the metadata record palpate.run",
                });
            }
            Some(found) if *found != FORMAT_VERSION.to_string() => {
                return Err(ReadError::Format {
                    path: path(),
                    found: found.clone(),
                });
            }
            Some(_) => {}
        }
        if self.header.effective_scene.is_empty() {
            return Err(ReadError::Foreign {
                path: path(),
                missing: "the attachment scene.effective.toml",
            });
        }
        Ok(())
    }

    /// A number from the head.
    pub fn run_number(&self, key: &str) -> Option<u64> {
        self.header.run.get(key)?.parse().ok()
    }

    /// A number from the end.
    pub fn end_number(&self, key: &str) -> Option<u64> {
        self.header.end.get(key)?.parse().ok()
    }

    /// The file says that nothing was lost and it was finished.
    pub fn is_clean(&self) -> bool {
        self.header
            .end
            .get("clean")
            .is_some_and(|clean| clean == "true")
    }

    /// Ticks missing between the first and the last.
    pub fn gaps(&self) -> u64 {
        self.ticks
            .windows(2)
            .map(|pair| (pair[1].output.tick - pair[0].output.tick).saturating_sub(1))
            .sum()
    }
}

/// The records of a file, each with its bytes, up to its footer or to the first that is cut short.
pub(super) fn records(bytes: &[u8]) -> impl Iterator<Item = Result<(Record<'_>, &[u8]), String>> {
    const FOOTER: u8 = 0x02;
    const ATTACHMENT: u8 = 0x09;
    let mut rest = Some(&bytes[mcap::MAGIC.len()..]).filter(|rest| !rest.is_empty());
    std::iter::from_fn(move || {
        let now = rest.take()?;
        let whole = now.split_first_chunk::<9>().and_then(|(head, after)| {
            let [op, len @ ..] = *head;
            let len = usize::try_from(u64::from_le_bytes(len))
                .ok()
                .filter(|len| *len <= after.len())?;
            Some((op, after.split_at(len)))
        });
        let Some((op, (body, after))) = whole else {
            return Some(Err("the file ends within a record".into()));
        };
        rest = Some(after).filter(|after| op != FOOTER && !after.is_empty());
        // The parser expects an attachment to be at least as long as its fixed fields.
        if op == ATTACHMENT && !attachment_is_whole(body) {
            return Some(Err("an attachment is shorter than its own head".into()));
        }
        let whole = &now[..now.len() - after.len()];
        Some(
            mcap::read::parse_record(op, body)
                .map(|record| (record, whole))
                .map_err(|e| e.to_string()),
        )
    })
}

/// Two times, two texts with their lengths, the length of the data, and a checksum fit in.
fn attachment_is_whole(body: &[u8]) -> bool {
    let mut need = 16_usize;
    for _ in 0..2 {
        let Some(len) = body.get(need..).and_then(|rest| rest.first_chunk::<4>()) else {
            return false;
        };
        need = need
            .saturating_add(4)
            .saturating_add(u32::from_le_bytes(*len) as usize);
    }
    body.len() >= need.saturating_add(12)
}

/// The records of a chunk, or none of them. `chunk` is the whole chunk record.
///
/// Its checksum is compared before anything in it is believed, and no length it claims, of itself
/// or of a record inside, makes room for more than a chunk of ours can have.
pub(super) fn chunk_records(chunk: &[u8]) -> Result<Vec<Record<'static>>, mcap::McapError> {
    /// Zstandard makes a few bytes of many equal ones; our chunks are far smaller than this.
    const LARGEST: usize = 64 << 20;
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(LARGEST);
    let mut reader = LinearReader::new_with_options(options);
    let mut rest = chunk;
    let mut records = Vec::new();
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(need) => {
                let (now, later) = rest.split_at(need.min(rest.len()));
                reader.insert(now.len()).copy_from_slice(now);
                reader.notify_read(now.len());
                rest = later;
            }
            LinearReadEvent::Record { data, opcode } => {
                records.push(mcap::read::parse_record(opcode, data)?.into_owned());
            }
        }
    }
    Ok(records)
}
