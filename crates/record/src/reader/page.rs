//! A chunk, decompressed: its messages in the order of the file.

use super::super::channel::Topic;
use super::layout::{Channel, Chunk, LARGEST, RECORD_HEAD};
use super::source::Source;
use mcap::records::{Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::BTreeMap;
use std::io;
use std::ops::Range;

/// Topics by channel.
pub(super) type Topics = BTreeMap<u16, Option<Topic>>;

/// A message of one of our topics.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub topic: Topic,
    start: u32,
    len: u32,
}

/// A decompressed chunk.
#[derive(Debug, Default)]
pub(super) struct Page {
    data: Vec<u8>,
    /// In the order of the file.
    pub entries: Vec<Entry>,
    /// By channel: messages and their bytes, of every topic.
    pub counts: BTreeMap<u16, (u64, u64)>,
    /// Channels that are announced in it.
    pub announced: BTreeMap<u16, Channel>,
    /// Earliest and latest log_time, ns.
    pub span_ns: Option<(u64, u64)>,
    /// Bytes of its records, before compression.
    bytes: usize,
}

/// Why a chunk has no page.
#[derive(Debug)]
pub(super) enum PageError {
    /// The disk.
    Io(io::Error),
    /// What is wrong with the chunk. What follows it may be as good as ever.
    Damaged(String),
}

impl From<io::Error> for PageError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::Damaged("the file ends within it".into()),
            _ => Self::Io(error),
        }
    }
}

fn damaged(what: impl std::fmt::Display) -> PageError {
    PageError::Damaged(what.to_string())
}

impl Page {
    /// Reads a chunk, whole or not at all. `topics` are the channels known so far.
    pub fn read(source: &Source, chunk: &Chunk, topics: &Topics) -> Result<Self, PageError> {
        let Some(len) = usize::try_from(chunk.len)
            .ok()
            .filter(|len| *len <= LARGEST)
        else {
            let len = chunk.len;
            return Err(damaged(format!("{len} bytes, more than {LARGEST}")));
        };
        let bytes = source.read(chunk.at, len)?;
        let mut page = Self::default();
        if chunk.loose {
            page.take_loose(&bytes, topics)?;
        } else {
            page.take_chunk(&bytes, topics)?;
        }
        Ok(page)
    }

    /// Bytes of a message.
    pub fn message(&self, entry: &Entry) -> &[u8] {
        let start = entry.start as usize;
        let range: Range<usize> = start..start + entry.len as usize;
        &self.data[range]
    }

    fn take_loose(&mut self, mut rest: &[u8], topics: &Topics) -> Result<(), PageError> {
        while let Some((head, after)) = rest.split_first_chunk::<{ RECORD_HEAD as usize }>() {
            let [op, len @ ..] = *head;
            let len = usize::try_from(u64::from_le_bytes(len))
                .ok()
                .filter(|len| *len <= after.len())
                .ok_or_else(|| damaged("a record is cut short"))?;
            self.take(op, &after[..len], topics)?;
            rest = &after[len..];
        }
        Ok(())
    }

    /// The checksum is compared before anything in the chunk is believed, and no length it claims,
    /// of itself or of a record inside, makes room for more than a chunk may have.
    fn take_chunk(&mut self, chunk: &[u8], topics: &Topics) -> Result<(), PageError> {
        let is_one = chunk
            .split_first_chunk::<{ RECORD_HEAD as usize }>()
            .is_some_and(|(head, after)| {
                let [op, len @ ..] = *head;
                op == op::CHUNK && u64::from_le_bytes(len) == after.len() as u64
            });
        if !is_one {
            return Err(damaged("it is not where the index says"));
        }
        let options = LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(LARGEST);
        let mut reader = LinearReader::new_with_options(options);
        let mut rest = chunk;
        while let Some(event) = reader.next_event() {
            match event.map_err(damaged)? {
                LinearReadEvent::ReadRequest(need) => {
                    let (now, later) = rest.split_at(need.min(rest.len()));
                    reader.insert(now.len()).copy_from_slice(now);
                    reader.notify_read(now.len());
                    rest = later;
                }
                LinearReadEvent::Record { data, opcode } => self.take(opcode, data, topics)?,
            }
        }
        Ok(())
    }

    fn take(&mut self, op: u8, body: &[u8], topics: &Topics) -> Result<(), PageError> {
        /// Channel, sequence and two times.
        const MESSAGE_HEAD: usize = 22;
        // Without a checksum, nothing but this bounds what a few bytes may unpack to.
        self.bytes = self.bytes.saturating_add(body.len() + RECORD_HEAD as usize);
        if self.bytes > LARGEST {
            return Err(damaged(format!("it unpacks to more than {LARGEST} bytes")));
        }
        match op {
            op::CHANNEL => {
                if let Record::Channel(channel) =
                    mcap::read::parse_record(op, body).map_err(damaged)?
                {
                    let (topic, encoding) = (channel.topic, channel.message_encoding);
                    let known = Channel {
                        topic,
                        encoding,
                        schema: channel.schema_id,
                    };
                    self.announced.insert(channel.id, known);
                }
            }
            op::MESSAGE => {
                let Some((head, data)) = body.split_first_chunk::<MESSAGE_HEAD>() else {
                    return Err(damaged("a message is shorter than its own head"));
                };
                let [id0, id1, _, _, _, _, time @ .., _, _, _, _, _, _, _, _] = *head;
                let (id, log_time) = (u16::from_le_bytes([id0, id1]), u64::from_le_bytes(time));
                let count = self.counts.entry(id).or_default();
                *count = (count.0 + 1, count.1 + data.len() as u64);
                let (from, to) = self.span_ns.unwrap_or((log_time, log_time));
                self.span_ns = Some((from.min(log_time), to.max(log_time)));
                let own = self.announced.get(&id).map(|c| Topic::of(&c.topic));
                if let Some(topic) = own.or_else(|| topics.get(&id).copied()).flatten() {
                    let (start, len) = (self.data.len() as u32, data.len() as u32);
                    self.entries.push(Entry { topic, start, len });
                    self.data.extend_from_slice(data);
                }
            }
            _ => {}
        }
        Ok(())
    }
}
