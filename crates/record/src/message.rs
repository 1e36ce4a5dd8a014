//! What travels from the stream to files and to memory: encoded messages in the order of the
//! simulation.

use super::channel::Topic;
use super::head::BodyHead;
use palpate_geometry::math::{Point3, SavedState};
use palpate_proto::recording as pb;
use palpate_sim::tick::record::{Command, TickRecord};
use palpate_wire::{command_to_proto, tick_to_proto};

/// What its file has to know of a message without decoding it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Mark {
    /// Nothing.
    #[default]
    None,
    Tick {
        state_hash: u64,
        skipped: u32,
    },
    Keyframe {
        generation: u32,
    },
}

/// An encoded message.
#[derive(Clone, Debug)]
pub(super) struct Message {
    pub topic: Topic,
    /// Body index, for topics that each body has; else 0.
    pub body: u16,
    pub mark: Mark,
    pub tick: u64,
    /// Wall clock when it was encoded, ns.
    pub wall_ns: u64,
    pub data: Vec<u8>,
}

impl Message {
    pub fn new(topic: Topic, tick: u64, message: &impl prost::Message) -> Self {
        Self::encoded(topic, tick, message.encode_to_vec())
    }

    pub fn encoded(topic: Topic, tick: u64, data: Vec<u8>) -> Self {
        Self {
            topic,
            body: 0,
            mark: Mark::None,
            tick,
            wall_ns: wall_ns(),
            data,
        }
    }

    pub fn is_tick(&self) -> bool {
        self.topic == Topic::Tick
    }

    pub fn is_keyframe(&self) -> bool {
        self.topic == Topic::Keyframe
    }

    pub fn tick(record: &TickRecord, tool_count: usize) -> Self {
        let output = &record.output;
        let mark = Mark::Tick {
            state_hash: output.state_hash,
            skipped: record.input.skipped,
        };
        Self {
            mark,
            ..Self::new(Topic::Tick, output.tick, &tick_to_proto(record, tool_count))
        }
    }

    /// `commands`: how many of the commands after `tick` the state holds already.
    pub fn keyframe(
        tick: u64,
        state_hash: u64,
        commands: u32,
        saved: &SavedState,
        generation: u32,
    ) -> Self {
        let (words, floats) = (saved.words.clone(), saved.floats.clone());
        let keyframe = pb::Keyframe {
            tick,
            state_hash,
            words,
            floats,
            commands,
        };
        Self {
            mark: Mark::Keyframe { generation },
            ..Self::new(Topic::Keyframe, tick, &keyframe)
        }
    }

    pub fn command(after_tick: u64, command: Command) -> Self {
        let message = command_to_proto(after_tick, command);
        Self::new(Topic::Command, after_tick, &message)
    }

    pub fn event(tick: u64, kind: &str, detail: &str) -> Self {
        let (kind, detail) = (kind.into(), detail.into());
        Self::new(Topic::Event, tick, &pb::Event { tick, kind, detail })
    }

    pub fn net(tick: u64, revision: u64, body: usize, head: &BodyHead, points: &[Point3]) -> Self {
        let message = pb::ControlNet {
            tick,
            revision,
            body: head.id.clone(),
            degree_u: head.degree[0] as u32,
            degree_v: head.degree[1] as u32,
            count_u: head.count[0] as u32,
            count_v: head.count[1] as u32,
            points: points.iter().flat_map(|p| [p.x, p.y, p.z]).collect(),
        };
        Self {
            body: body as u16,
            ..Self::new(Topic::Net, tick, &message)
        }
    }
}

/// Wall clock, ns.
pub fn wall_ns() -> u64 {
    let now = std::time::SystemTime::now();
    now.duration_since(std::time::UNIX_EPOCH)
        .map_or(0, |t| t.as_nanos() as u64)
}

/// Running hash of all ticks of a file: two with equal hashes went through the same states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SessionHash(pub u64);

impl std::fmt::Display for SessionHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

impl SessionHash {
    /// Takes the next tick in.
    pub fn push(&mut self, tick: u64, state_hash: u64) {
        let mixed = (self.0 ^ state_hash)
            .wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .rotate_left(29);
        self.0 = (mixed ^ tick).wrapping_mul(0xbf58_476d_1ce4_e5b9) ^ (mixed >> 31);
    }
}
