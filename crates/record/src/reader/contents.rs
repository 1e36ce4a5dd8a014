//! All of a short recording at once, to compare, to edit, and to make a recording of again.

use super::super::channel::{EventRecord, Happening, Keyframe, NetRecord, Topic};
use super::super::format::{CHECK, END, RUN, SCENE_EFFECTIVE, SCENE_TEXT, checked};
use super::super::message::Message;
use super::error::ReadError;
use super::follower::Follower;
use super::layout::SessionHeader;
use super::session::Session;
use mcap::records::{MessageHeader, Metadata};
use palpate_proto::recording as pb;
use palpate_sim::tick::record::{Command, TickRecord};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// A whole session in memory, each list in the order of the file: for tests and notebooks. It takes
/// some six kilobytes a tick; what has to go through a long recording follows it instead.
#[derive(Clone, Debug)]
pub struct Contents {
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
    /// What is missing of the file, if anything.
    pub cut_short: Option<String>,
}

impl Contents {
    /// Reads all that can be read of a file.
    ///
    /// # Errors
    /// As of [`Session::open`] and [`Follower`].
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::of(&Session::open(path)?)
    }

    /// [`Contents::open`] on bytes at hand; `path` is for messages.
    ///
    /// # Errors
    /// As there.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, ReadError> {
        Self::of(&Session::parse(path, bytes)?)
    }

    /// All of a session.
    ///
    /// # Errors
    /// As of [`Follower`].
    pub fn of(session: &Session) -> Result<Self, ReadError> {
        let mut all = Self {
            path: session.path.clone(),
            header: SessionHeader::clone(&session.header),
            ticks: Vec::new(),
            keyframes: Vec::new(),
            commands: Vec::new(),
            nets: Vec::new(),
            events: Vec::new(),
            cut_short: None,
        };
        for happening in Follower::new(session) {
            match happening? {
                Happening::Tick(record) => all.ticks.push(*record),
                Happening::Keyframe(keyframe) => all.keyframes.push(keyframe),
                Happening::Command(after_tick, command) => all.commands.push((after_tick, command)),
                Happening::Net(net) => all.nets.push(net),
                Happening::Event(event) => all.events.push(event),
                Happening::Inputs(_) | Happening::Other(_) => {}
            }
        }
        all.cut_short = session.cut_short().map(str::to_owned);
        Ok(all)
    }

    /// A recording of what is in the lists, in memory. Things are put in the order of the
    /// simulation, by tick; commands and keyframes of one tick stand as the keyframes say.
    ///
    /// # Errors
    /// As of [`Session::parse`].
    pub fn session(&self) -> Result<Session, ReadError> {
        let not_made = |e: mcap::McapError| ReadError::NotMcap {
            path: self.path.clone(),
            reason: e.to_string(),
        };
        Session::parse(&self.path, &self.bytes().map_err(not_made)?)
    }

    fn bytes(&self) -> mcap::McapResult<Vec<u8>> {
        // Small chunks, so that a short recording has several.
        let options = mcap::WriteOptions::new()
            .compression(None)
            .chunk_size(Some(32 << 10));
        let mut mcap = options.create(Cursor::new(Vec::new()))?;
        let metadata = |name: &str, metadata: &BTreeMap<String, String>| Metadata {
            name: name.into(),
            metadata: match metadata.contains_key(CHECK) {
                true => checked(metadata.clone()),
                false => metadata.clone(),
            },
        };
        mcap.write_metadata(&metadata(RUN, &self.header.run))?;
        for (name, text) in [
            (SCENE_TEXT, &self.header.scene_text),
            (SCENE_EFFECTIVE, &self.header.effective_scene),
        ] {
            mcap.attach(&mcap::Attachment {
                log_time: 0,
                create_time: 0,
                name: name.into(),
                media_type: "application/toml".into(),
                data: text.as_bytes().into(),
            })?;
        }
        let mut channels = BTreeMap::new();
        for (topic, message) in self.messages() {
            let channel_id = match channels.get(&topic) {
                Some(id) => *id,
                None => {
                    let id = mcap.add_channel(0, &topic, "protobuf", &BTreeMap::new())?;
                    channels.insert(topic, id);
                    id
                }
            };
            let dt_ns = self.header.run.get("dt_ns").and_then(|n| n.parse().ok());
            let log_time = message.tick.saturating_mul(dt_ns.unwrap_or(1_000_000));
            let header = MessageHeader {
                channel_id,
                sequence: message.tick as u32,
                log_time,
                publish_time: log_time,
            };
            mcap.write_to_known_channel(&header, &message.data)?;
        }
        mcap.write_metadata(&metadata(END, &self.header.end))?;
        if self.cut_short.is_some() {
            mcap.flush()?;
            return Ok(mcap.into_inner().into_inner());
        }
        mcap.finish()?;
        Ok(mcap.into_inner().into_inner())
    }

    /// All messages with their topics: a tick, its nets, its events, what came between it and the
    /// next.
    fn messages(&self) -> Vec<(String, Message)> {
        let mut all: Vec<(u64, u8, String, Message)> = Vec::new();
        let tools = self.header.names("tools").len();
        let mut put = |rank: u8, body: &str, message: Message| {
            let name = message.topic.name(body).into_owned();
            all.push((message.tick, rank, name, message));
        };
        for record in &self.ticks {
            put(0, "", Message::tick(record, tools));
        }
        for net in &self.nets {
            let message = pb::ControlNet {
                tick: net.tick,
                revision: net.revision,
                body: net.body.clone(),
                points: net.points.clone(),
                ..pb::ControlNet::default()
            };
            let message = Message::new(Topic::Net, net.tick, &message);
            put(1, &net.body, message);
        }
        for event in &self.events {
            let message = Message::event(event.tick, &event.kind, &event.detail);
            put(2, "", message);
        }
        let mut rest = &self.commands[..];
        let commands = |commands: &[(u64, Command)], put: &mut dyn FnMut(u8, &str, Message)| {
            for (after_tick, command) in commands {
                put(3, "", Message::command(*after_tick, *command));
            }
        };
        for keyframe in &self.keyframes {
            let passed = self.commands.len() - rest.len();
            let earlier = (self.commands.iter())
                .take_while(|(after, _)| *after < keyframe.tick)
                .count();
            // Those of earlier ticks, and of its own as many as it holds.
            let own = rest.iter().skip(earlier.saturating_sub(passed));
            let own = own.take_while(|(after, _)| *after == keyframe.tick).count();
            let held = (keyframe.commands as usize).saturating_sub(passed.saturating_sub(earlier));
            let count = earlier.saturating_sub(passed) + held.min(own);
            let (now, later) = rest.split_at(count.min(rest.len()));
            commands(now, &mut put);
            rest = later;
            let Keyframe {
                tick,
                state_hash,
                commands: held,
                saved,
            } = keyframe;
            let message = Message::keyframe(*tick, *state_hash, *held, saved, 0);
            put(3, "", message);
        }
        commands(rest, &mut put);
        all.sort_by_key(|(tick, rank, ..)| (*tick, *rank));
        let all = all.into_iter();
        all.map(|(_, _, topic, message)| (topic, message)).collect()
    }
}
