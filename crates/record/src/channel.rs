//! The channels of a recording, one row each: topic, message, and how readers take it in.

use super::container::Container;
use super::inputs::InputBlock;
use palpate_geometry::math::SavedState;
use palpate_proto::recording as pb;
use palpate_sim::tick::record::{Command, TickRecord};
use palpate_wire::{ConvertError, command_from_proto, tick_from_proto};
use prost::Message as _;
use std::borrow::Cow;
use std::io::Write;

/// What a message is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Ticks.
    Tick,
    /// Full states.
    Keyframe,
    /// Commands.
    Command,
    /// Events.
    Event,
    /// Loop statistics.
    Stats,
    /// Control nets.
    Net,
    /// What goes into ticks, where it is alone.
    Inputs,
}

/// Name of a topic.
enum Name {
    Whole(&'static str),
    /// One topic for each body: what comes before its id, and after.
    PerBody(&'static str, &'static str),
}

/// A channel.
struct ChannelRow {
    topic: Topic,
    name: Name,
    /// Message in the package `palpate.v1`.
    message: &'static str,
    decode: fn(&[u8]) -> Result<Happening, DecodeError>,
}

/// All channels but those that only viewers read ([`super::views`]), in the order in which files
/// announce them.
const ROWS: &[ChannelRow] = &[
    ChannelRow {
        topic: Topic::Tick,
        name: Name::Whole("/sim/tick"),
        message: "Tick",
        decode: |data| {
            let tick = tick_from_proto(&pb::Tick::decode(data)?)?;
            Ok(Happening::Tick(Box::new(tick)))
        },
    },
    ChannelRow {
        topic: Topic::Keyframe,
        name: Name::Whole("/sim/keyframe"),
        message: "Keyframe",
        decode: |data| {
            let keyframe = pb::Keyframe::decode(data)?;
            Ok(Happening::Keyframe(Keyframe {
                tick: keyframe.tick,
                state_hash: keyframe.state_hash,
                commands: keyframe.commands,
                saved: SavedState {
                    words: keyframe.words,
                    floats: keyframe.floats,
                },
            }))
        },
    },
    ChannelRow {
        topic: Topic::Command,
        name: Name::Whole("/sim/command"),
        message: "Command",
        decode: |data| {
            let command = pb::Command::decode(data)?;
            let after_tick = command.after_tick;
            Ok(Happening::Command(
                after_tick,
                command_from_proto(&command)?,
            ))
        },
    },
    ChannelRow {
        topic: Topic::Event,
        name: Name::Whole("/sim/event"),
        message: "Event",
        decode: |data| {
            let pb::Event { tick, kind, detail } = pb::Event::decode(data)?;
            Ok(Happening::Event(EventRecord { tick, kind, detail }))
        },
    },
    ChannelRow {
        topic: Topic::Stats,
        name: Name::Whole("/sim/stats"),
        message: "Stats",
        decode: |data| {
            let tick = pb::Stats::decode(data)?.tick;
            Ok(Happening::other(Topic::Stats, tick, data))
        },
    },
    ChannelRow {
        topic: Topic::Net,
        name: Name::PerBody("/body/", "/net"),
        message: "ControlNet",
        decode: |data| {
            let net = pb::ControlNet::decode(data)?;
            Ok(Happening::Net(NetRecord {
                tick: net.tick,
                revision: net.revision,
                body: net.body,
                points: net.points,
            }))
        },
    },
    ChannelRow {
        topic: Topic::Inputs,
        name: Name::Whole("/sim/inputs"),
        message: "Inputs",
        decode: |data| {
            let block = InputBlock::from_proto(&pb::Inputs::decode(data)?)?;
            Ok(Happening::Inputs(block))
        },
    },
];

impl Topic {
    /// Those of a whole recording.
    pub(super) const RECORDED: [Self; 6] = [
        Self::Tick,
        Self::Keyframe,
        Self::Command,
        Self::Event,
        Self::Stats,
        Self::Net,
    ];

    /// `None`: what only viewers read.
    pub(super) fn of(name: &str) -> Option<Self> {
        let row = ROWS.iter().find(|row| match row.name {
            Name::Whole(whole) => name == whole,
            Name::PerBody(before, after) => name.starts_with(before) && name.ends_with(after),
        });
        row.map(|row| row.topic)
    }

    /// Name of the topic, for the body with this id where each has its own.
    pub(super) fn name(self, body: &str) -> Cow<'static, str> {
        match self.row().name {
            Name::Whole(whole) => whole.into(),
            Name::PerBody(before, after) => format!("{before}{body}{after}").into(),
        }
    }

    /// What a message of this topic holds.
    pub(super) fn decode(self, data: &[u8]) -> Result<Happening, ConvertError> {
        (self.row().decode)(data).map_err(|error| match error {
            DecodeError::Malformed(error) => ConvertError {
                tick: 0,
                what: format!("{self:?}: {error}"),
            },
            DecodeError::Content(error) => error,
        })
    }

    fn row(self) -> &'static ChannelRow {
        let row = ROWS.iter().find(|row| row.topic == self);
        row.unwrap_or_else(|| unreachable!("every topic has a row"))
    }
}

/// Channel numbers of a file.
pub(super) struct Channels(Vec<(Topic, Vec<u16>)>);

impl Channels {
    /// Announces the channels of topics with their schemas, for bodies with these ids.
    pub(super) fn announce<W: Write>(
        file: &mut Container<W>,
        topics: &[Topic],
        bodies: &[&str],
    ) -> Self {
        let mut channel = |row: &ChannelRow, body: &str| {
            let message = format!("palpate.v1.{}", row.message);
            let descriptors = pb::descriptors(&message).unwrap_or_default();
            file.channel(&row.topic.name(body), &message, &descriptors)
        };
        let rows = topics.iter().map(|topic| {
            let row = topic.row();
            let numbers = match row.name {
                Name::Whole(_) => vec![channel(row, "")],
                Name::PerBody(..) => bodies.iter().map(|body| channel(row, body)).collect(),
            };
            (row.topic, numbers)
        });
        Self(rows.collect())
    }

    /// Channel of a topic, for the body with this index where each has its own.
    pub(super) fn number(&self, topic: Topic, body: u16) -> u16 {
        let row = self.0.iter().find(|(of, _)| *of == topic);
        let (_, numbers) = row.unwrap_or_else(|| unreachable!("every topic was announced"));
        numbers[usize::from(body)]
    }
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

/// Something that happened beside the ticks.
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

/// A message that readers pass on without decoding it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OtherRecord {
    /// When.
    pub tick: u64,
    /// What it is about.
    pub topic: Topic,
    /// As in the file.
    pub data: Vec<u8>,
}

/// One thing that a recording holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Happening {
    /// A tick: what was applied and what came out.
    Tick(Box<TickRecord>),
    /// The state after a tick.
    Keyframe(Keyframe),
    /// A command, with the tick after which it acts.
    Command(u64, Command),
    /// Something else.
    Event(EventRecord),
    /// A control net after a tick.
    Net(NetRecord),
    /// Inputs of ticks, alone.
    Inputs(InputBlock),
    /// A message that no reader uses; `recover` keeps it.
    Other(OtherRecord),
}

impl Happening {
    /// The tick, or that after which it is.
    pub fn tick(&self) -> u64 {
        match self {
            Self::Tick(record) => record.output.tick,
            Self::Keyframe(keyframe) => keyframe.tick,
            Self::Command(after_tick, _) => *after_tick,
            Self::Event(event) => event.tick,
            Self::Net(net) => net.tick,
            Self::Inputs(block) => block.tick,
            Self::Other(other) => other.tick,
        }
    }

    fn other(topic: Topic, tick: u64, data: &[u8]) -> Self {
        let data = data.to_vec();
        Self::Other(OtherRecord { tick, topic, data })
    }
}

/// Why a message cannot be taken in.
enum DecodeError {
    Malformed(prost::DecodeError),
    Content(ConvertError),
}

impl From<prost::DecodeError> for DecodeError {
    fn from(error: prost::DecodeError) -> Self {
        Self::Malformed(error)
    }
}

impl From<ConvertError> for DecodeError {
    fn from(error: ConvertError) -> Self {
        Self::Content(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_topic_is_found_by_its_name_and_has_a_schema() {
        for row in ROWS {
            assert_eq!(Topic::of(&row.topic.name("drop")), Some(row.topic));
            let message = format!("palpate.v1.{}", row.message);
            assert!(pb::descriptors(&message).is_some(), "{message}");
        }
        for name in ["/body/drop/points", "/sim/ticks", "/scene", ""] {
            assert_eq!(Topic::of(name), None, "{name}");
        }
    }
}
