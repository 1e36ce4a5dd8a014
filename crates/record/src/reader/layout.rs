//! Where things are in a file: its records from end to end, without looking into chunks.

use super::super::format::{END, RUN, SCENE_EFFECTIVE, SCENE_TEXT, TOTALS, is_as_written};
use super::scene_text::without_bus;
use super::source::Source;
use mcap::records::{ChunkHeader, Metadata, Record, op};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::ops::Range;

/// A chunk or any other record that is longer than this is not read: ours have a quarter of a
/// megabyte, and one large message more. The bytes of a chunk before compression are bounded alike.
pub(super) const LARGEST: usize = 64 << 20;

/// Operation code and length, before every record.
pub(super) const RECORD_HEAD: u64 = 9;

/// Messages outside chunks are read in stretches of about this many bytes.
const LOOSE: u64 = 1 << 20;

/// Head of a session.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
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

impl SessionHeader {
    /// Names in the head of a session, for example of its `tools` or `bodies`, by index.
    pub fn names(&self, key: &str) -> Vec<String> {
        let names = self.run.get(key).map_or("", String::as_str);
        names
            .split(',')
            .filter(|name| !name.is_empty())
            .map(str::to_owned)
            .collect()
    }
}

/// A chunk, or a stretch of messages that lie outside chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Chunk {
    /// Offset of its first record.
    pub at: u64,
    /// Bytes, with the heads of its records.
    pub len: u64,
    /// Messages outside chunks.
    pub loose: bool,
    /// It holds a keyframe, or may hold one.
    pub keyframe: bool,
    /// Earliest log_time in it, ns; what the file says until it is read.
    pub from_ns: u64,
    /// Latest log_time in it, ns.
    pub to_ns: u64,
    /// Earliest log_time in it and all that follow, ns.
    pub rest_from_ns: u64,
    /// Latest log_time in it and all before, ns.
    pub past_to_ns: u64,
}

impl Chunk {
    pub fn new(at: u64, len: u64, span_ns: [u64; 2]) -> Self {
        Self {
            at,
            len,
            loose: false,
            keyframe: false,
            from_ns: span_ns[0],
            to_ns: span_ns[1],
            rest_from_ns: 0,
            past_to_ns: u64::MAX,
        }
    }

    /// Offset of what follows it.
    pub fn end(&self) -> u64 {
        self.at.saturating_add(self.len)
    }
}

/// What is known of a channel.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Channel {
    pub topic: String,
    pub encoding: String,
    pub schema: u16,
}

/// What a file is made of.
#[derive(Clone, Debug, Default)]
pub(super) struct Layout {
    pub header: SessionHeader,
    /// What the recorder summed up when it finished, as it was written.
    pub totals: Option<String>,
    pub chunks: Vec<Chunk>,
    pub channels: BTreeMap<u16, Channel>,
    /// Names of schemas.
    pub schemas: BTreeMap<u16, String>,
    /// By channel: messages, where they are known.
    pub messages: BTreeMap<u16, u64>,
    /// Bytes of chunks before compression, as the file says.
    pub uncompressed_bytes: u64,
    /// Bytes of chunks on disk, as the file says.
    pub compressed_bytes: u64,
    /// How chunks are compressed.
    pub compression: BTreeSet<String>,
    /// The footer was met.
    pub ended: bool,
    /// What is wrong with the file: the first that was met.
    pub damage: Option<String>,
}

impl Layout {
    /// Notes what is wrong.
    pub fn damaged(&mut self, reason: impl Into<String>) {
        self.damage.get_or_insert_with(|| reason.into());
    }

    /// Takes in what a chunk says of itself.
    pub fn count_chunk(&mut self, compression: &str, compressed: u64, uncompressed: u64) {
        self.compressed_bytes = self.compressed_bytes.saturating_add(compressed);
        self.uncompressed_bytes = self.uncompressed_bytes.saturating_add(uncompressed);
        // A few bytes of a name; a file that names thousands of ways has none that we know.
        if self.compression.len() < 8 && compression.len() < 32 {
            let name = if compression.is_empty() {
                "none"
            } else {
                compression
            };
            self.compression.insert(name.to_owned());
        }
    }

    /// Takes in the records of a range, up to its end or to the first that is cut short.
    ///
    /// # Errors
    /// The disk refuses.
    pub fn walk(&mut self, source: &Source, range: Range<u64>) -> io::Result<()> {
        let mut at = range.start;
        while at < range.end && !self.ended {
            let Some((op, len)) = head(source, at, range.end)? else {
                self.damaged("the file ends within a record");
                return Ok(());
            };
            let body = at + RECORD_HEAD;
            match op {
                op::FOOTER => self.ended = true,
                op::CHUNK => self.chunk(source, at, len)?,
                op::MESSAGE => self.loose(at, RECORD_HEAD + len),
                op::METADATA | op::ATTACHMENT | op::SCHEMA | op::CHANNEL => {
                    if len > LARGEST as u64 {
                        self.damaged(format!("a record of {len} bytes, more than {LARGEST}"));
                    } else {
                        self.take(op, &source.read(body, len as usize)?);
                    }
                }
                _ => {}
            }
            at = body + len;
        }
        Ok(())
    }

    fn chunk(&mut self, source: &Source, at: u64, len: u64) -> io::Result<()> {
        // Times, sizes, checksum, the name of the compression: all before the data.
        let header = source.read(at + RECORD_HEAD, len.min(128) as usize)?;
        let header: Option<ChunkHeader> = chunk_header(&header);
        let mut chunk = Chunk::new(at, RECORD_HEAD + len, [0, u64::MAX]);
        if let Some(header) = header {
            (chunk.from_ns, chunk.to_ns) = (header.message_start_time, header.message_end_time);
            let (compressed, uncompressed) = (header.compressed_size, header.uncompressed_size);
            self.count_chunk(&header.compression, compressed, uncompressed);
        }
        self.chunks.push(chunk);
        Ok(())
    }

    fn loose(&mut self, at: u64, len: u64) {
        match self.chunks.last_mut() {
            Some(open) if open.loose && open.end() == at && open.len + len <= LOOSE => {
                open.len += len;
            }
            _ => self.chunks.push(Chunk {
                loose: true,
                ..Chunk::new(at, len, [0, u64::MAX])
            }),
        }
    }

    /// Takes in a record of any other kind.
    pub fn take(&mut self, op: u8, body: &[u8]) {
        // The parser expects an attachment to be at least as long as its fixed fields.
        if op == op::ATTACHMENT && !attachment_is_whole(body) {
            return self.damaged("an attachment is shorter than its own head");
        }
        match mcap::read::parse_record(op, body) {
            Err(e) => self.damaged(e.to_string()),
            Ok(Record::Metadata(metadata)) if metadata.name == RUN => {
                self.check_metadata(&metadata);
                self.header.run = metadata.metadata;
            }
            Ok(Record::Metadata(metadata)) if metadata.name == END => {
                self.check_metadata(&metadata);
                self.header.end = metadata.metadata;
            }
            Ok(Record::Attachment { header, data, .. }) => {
                let text = || String::from_utf8_lossy(&data).into_owned();
                match header.name.as_str() {
                    SCENE_TEXT => self.header.scene_text = text(),
                    SCENE_EFFECTIVE => self.header.effective_scene = without_bus(text()),
                    TOTALS => self.totals = Some(text()),
                    _ => {}
                }
            }
            Ok(Record::Schema { header, .. }) => drop(self.schemas.insert(header.id, header.name)),
            Ok(Record::Channel(channel)) => self.announce(
                channel.id,
                Channel {
                    topic: channel.topic,
                    encoding: channel.message_encoding,
                    schema: channel.schema_id,
                },
            ),
            Ok(_) => {}
        }
    }

    fn check_metadata(&mut self, metadata: &Metadata) {
        if !is_as_written(&metadata.metadata) {
            let name = &metadata.name;
            self.damaged(format!("the metadata {name} is not as it was written"));
        }
    }

    /// A channel is announced in the first chunk that uses it and once more at the end.
    pub fn announce(&mut self, id: u16, channel: Channel) {
        self.channels.insert(id, channel);
    }

    /// Chunks by time, as far as is known now: call when all are there.
    pub fn order(&mut self) {
        let mut past = 0;
        for chunk in &mut self.chunks {
            past = chunk.to_ns.max(past);
            chunk.past_to_ns = past;
        }
        let mut rest = u64::MAX;
        for chunk in self.chunks.iter_mut().rev() {
            rest = chunk.from_ns.min(rest);
            chunk.rest_from_ns = rest;
        }
    }
}

/// Operation code and length of the record at an offset, if all of it lies before `end`.
pub(super) fn head(source: &Source, at: u64, end: u64) -> io::Result<Option<(u8, u64)>> {
    let mut bytes = [0; RECORD_HEAD as usize];
    if end.saturating_sub(at) < RECORD_HEAD {
        return Ok(None);
    }
    source.fill(at, &mut bytes)?;
    let [op, len @ ..] = bytes;
    let len = u64::from_le_bytes(len);
    Ok((len <= end - at - RECORD_HEAD).then_some((op, len)))
}

/// The fixed fields of a chunk, from its first bytes.
fn chunk_header(bytes: &[u8]) -> Option<ChunkHeader> {
    let number = |at: usize| Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk::<8>()?));
    let short = |at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk::<4>()?));
    let name = short(28)? as usize;
    let name_end = name.checked_add(32)?;
    Some(ChunkHeader {
        message_start_time: number(0)?,
        message_end_time: number(8)?,
        uncompressed_size: number(16)?,
        uncompressed_crc: short(24)?,
        compression: String::from_utf8(bytes.get(32..name_end)?.to_vec()).ok()?,
        compressed_size: number(name_end)?,
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
