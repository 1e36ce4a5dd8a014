//! Writes an MCAP file (<https://mcap.dev/spec>): chunks compressed one at a time, and their index.
//!
//! The writer of the `mcap` crate keeps some 600 bytes for each chunk until the file ends, which at
//! ten chunks a second is 370 kB a minute; [`ChunkIndexes`] keeps some sixty. Finished records wait
//! in memory for [`Container::hand_over`], so that a slow disk is asked once for all of them.

use mcap::records::op;
use prost::encoding::{decode_varint, encode_varint};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// Largest chunk before compression, bytes; and one message more.
const CHUNK: usize = 256 << 10;
/// Most bytes of finished records that wait.
const WAITING: usize = 4 << 20;
/// Compression of chunks. Low-order digits of measured numbers do not compress at any level.
const ZSTD: (&str, i32) = ("zstd", 1);
/// Operation code and length, before every record.
const RECORD_HEAD: u64 = 9;

/// A file under way.
pub(super) struct Container<W> {
    to: W,
    /// Finished records that the file does not have yet.
    waiting: Vec<u8>,
    /// Bytes of finished records so far.
    at: u64,
    /// Of all of them; in the summary, of those in it.
    crc: crc32fast::Hasher,
    zstd: zstd::bulk::Compressor<'static>,
    chunk: OpenChunk,
    chunks: ChunkIndexes,
    /// Records for the summary, as they are written there.
    schemas: Records,
    channels: Records,
    attachments: Records,
    metadata: Records,
    /// By channel: messages.
    counts: Vec<u64>,
    span_ns: Option<(u64, u64)>,
}

/// Where a message belongs.
#[derive(Clone, Copy, Debug)]
pub(super) struct MessageHead {
    pub channel: u16,
    pub sequence: u32,
    pub log_time: u64,
    pub publish_time: u64,
}

#[derive(Default)]
struct Records {
    count: u32,
    bytes: Vec<u8>,
}

#[derive(Default)]
struct OpenChunk {
    bytes: Vec<u8>,
    span_ns: Option<(u64, u64)>,
    /// By channel: log_time and offset of each message.
    messages: Vec<Vec<[u64; 2]>>,
}

impl<W: Write> Container<W> {
    /// Begins a file; `library` says who writes it.
    pub fn new(to: W, library: &str) -> io::Result<Self> {
        let mut file = Self {
            to,
            waiting: Vec::new(),
            at: 0,
            crc: crc32fast::Hasher::new(),
            zstd: zstd::bulk::Compressor::new(ZSTD.1)?,
            chunk: OpenChunk::default(),
            chunks: ChunkIndexes::default(),
            schemas: Records::default(),
            channels: Records::default(),
            attachments: Records::default(),
            metadata: Records::default(),
            counts: Vec::new(),
            span_ns: None,
        };
        file.append(|out| {
            out.extend(mcap::MAGIC);
            record(out, op::HEADER, |out| {
                text(out, "");
                text(out, library);
            });
        });
        Ok(file)
    }

    /// Bytes of finished records so far.
    pub fn len(&self) -> u64 {
        self.at
    }

    /// Announces a channel of Protobuf messages; gives its number.
    pub fn channel(&mut self, topic: &str, schema: &str, descriptors: &[u8]) -> u16 {
        let schemas = &mut self.schemas;
        // Few, so that a search costs nothing: the second field of each record is its name.
        let known = schemas
            .iter()
            .position(|body| named(body) == schema.as_bytes());
        let id = known.map_or(schemas.count, |k| k as u32) as u16 + 1;
        if known.is_none() {
            let from = schemas.add(op::SCHEMA, |out| {
                out.extend(id.to_le_bytes());
                text(out, schema);
                text(out, "protobuf");
                bytes(out, descriptors);
            });
            self.chunk.bytes.extend(&schemas.bytes[from..]);
        }
        let channel = self.channels.count as u16 + 1;
        let from = self.channels.add(op::CHANNEL, |out| {
            out.extend(channel.to_le_bytes());
            out.extend(id.to_le_bytes());
            text(out, topic);
            text(out, "protobuf");
            out.extend(0_u32.to_le_bytes());
        });
        self.chunk.bytes.extend(&self.channels.bytes[from..]);
        self.counts.resize(usize::from(channel) + 1, 0);
        self.chunk.messages.resize_with(self.counts.len(), Vec::new);
        channel
    }

    /// Writes a message of a channel that was announced.
    pub fn message(&mut self, head: MessageHead, data: &[u8]) -> io::Result<()> {
        let time = head.log_time;
        let chunk = &mut self.chunk;
        let offset = chunk.bytes.len() as u64;
        chunk.messages[usize::from(head.channel)].push([time, offset]);
        record(&mut chunk.bytes, op::MESSAGE, |out| {
            out.extend(head.channel.to_le_bytes());
            out.extend(head.sequence.to_le_bytes());
            out.extend(time.to_le_bytes());
            out.extend(head.publish_time.to_le_bytes());
            out.extend(data);
        });
        self.counts[usize::from(head.channel)] += 1;
        for span_ns in [&mut chunk.span_ns, &mut self.span_ns] {
            let (from, to) = span_ns.unwrap_or((time, time));
            *span_ns = Some((from.min(time), to.max(time)));
        }
        match chunk.bytes.len() >= CHUNK {
            true => self.end_chunk(),
            false => Ok(()),
        }
    }

    /// Writes an attachment.
    pub fn attach(
        &mut self,
        name: &str,
        media_type: &str,
        log_time: u64,
        create_time: u64,
        data: &[u8],
    ) -> io::Result<()> {
        self.end_chunk()?;
        let at = self.at;
        self.append(|out| {
            record(out, op::ATTACHMENT, |out| {
                let from = out.len();
                out.extend(log_time.to_le_bytes());
                out.extend(create_time.to_le_bytes());
                text(out, name);
                text(out, media_type);
                out.extend((data.len() as u64).to_le_bytes());
                out.extend(data);
                let crc = crc32fast::hash(&out[from..]);
                out.extend(crc.to_le_bytes());
            });
        });
        let len = self.at - at;
        self.attachments.add(op::ATTACHMENT_INDEX, |out| {
            for number in [at, len, log_time, create_time, data.len() as u64] {
                out.extend(number.to_le_bytes());
            }
            text(out, name);
            text(out, media_type);
        });
        self.hand_over_much()
    }

    /// Writes a metadata record.
    pub fn metadata(&mut self, name: &str, entries: &BTreeMap<String, String>) -> io::Result<()> {
        self.end_chunk()?;
        let at = self.at;
        self.append(|out| {
            record(out, op::METADATA, |out| {
                text(out, name);
                list(out, |out| {
                    for (key, value) in entries {
                        text(out, key);
                        text(out, value);
                    }
                });
            });
        });
        let len = self.at - at;
        self.metadata.add(op::METADATA_INDEX, |out| {
            out.extend(at.to_le_bytes());
            out.extend(len.to_le_bytes());
            text(out, name);
        });
        self.hand_over_much()
    }

    /// Ends the open chunk: what is handed over from now on can be read without what follows.
    pub fn end_chunk(&mut self) -> io::Result<()> {
        let mut chunk = std::mem::take(&mut self.chunk);
        if !chunk.bytes.is_empty() {
            let mut data = Vec::with_capacity(zstd::zstd_safe::compress_bound(chunk.bytes.len()));
            self.zstd.compress_to_buffer(&chunk.bytes, &mut data)?;
            let counts = chunk.messages.iter().enumerate();
            let entry = ChunkEntry {
                at: self.at,
                span_ns: chunk.span_ns.unwrap_or((0, 0)),
                bytes: chunk.bytes.len() as u64,
                compressed: data.len() as u64,
                messages: counts
                    .filter(|(_, messages)| !messages.is_empty())
                    .map(|(channel, messages)| (channel as u16, messages.len() as u64))
                    .collect(),
            };
            self.append(|out| entry.write(out, &chunk, &data));
            self.chunks.push(&entry);
            debug_assert_eq!(self.at, self.chunks.next_at, "the index counts other bytes");
            // Their memory serves the next chunk.
            chunk.bytes.clear();
            chunk.span_ns = None;
            chunk.messages.iter_mut().for_each(Vec::clear);
        }
        self.chunk = chunk;
        self.hand_over_much()
    }

    /// Hands finished records to the system: those survive the end of this process. After an error
    /// the file is of no more use, but for what it had before.
    pub fn hand_over(&mut self) -> io::Result<()> {
        if !self.waiting.is_empty() {
            self.to.write_all(&self.waiting)?;
            self.to.flush()?;
            self.waiting.clear();
            self.waiting.shrink_to(CHUNK);
        }
        Ok(())
    }

    fn hand_over_much(&mut self) -> io::Result<()> {
        match self.waiting.len() >= WAITING {
            true => self.hand_over(),
            false => Ok(()),
        }
    }

    /// Writes the summary, and hands all over; gives the length of the file.
    pub fn finish(mut self) -> io::Result<u64> {
        self.end_chunk()?;
        let crc = std::mem::take(&mut self.crc).finalize();
        self.append(|out| record(out, op::DATA_END, |out| out.extend(crc.to_le_bytes())));
        self.crc.reset();
        let start = self.at;
        let mut groups = Vec::new();
        let statistics = self.statistics();
        let chunks = std::mem::take(&mut self.chunks);
        for (code, records) in [
            (op::SCHEMA, std::mem::take(&mut self.schemas)),
            (op::CHANNEL, std::mem::take(&mut self.channels)),
            (op::STATISTICS, statistics),
            (op::CHUNK_INDEX, Records::default()),
            (op::ATTACHMENT_INDEX, std::mem::take(&mut self.attachments)),
            (op::METADATA_INDEX, std::mem::take(&mut self.metadata)),
        ] {
            let at = self.at;
            self.append(|out| out.extend(&records.bytes));
            if code == op::CHUNK_INDEX {
                for entry in chunks.entries() {
                    self.append(|out| entry.write_index(out));
                    self.hand_over_much()?;
                }
            }
            if self.at > at {
                groups.push((code, at, self.at - at));
            }
        }
        let offsets = self.at;
        self.append(|out| {
            for (code, at, len) in groups {
                record(out, op::SUMMARY_OFFSET, |out| {
                    out.push(code);
                    out.extend(at.to_le_bytes());
                    out.extend(len.to_le_bytes());
                });
            }
            // Its checksum covers the footer up to itself.
            out.push(op::FOOTER);
            for number in [20, start, offsets] {
                out.extend(u64::to_le_bytes(number));
            }
        });
        let crc = std::mem::take(&mut self.crc).finalize();
        self.append(|out| {
            out.extend(crc.to_le_bytes());
            out.extend(mcap::MAGIC);
        });
        self.hand_over()?;
        Ok(self.at)
    }

    fn statistics(&self) -> Records {
        let (from, to) = self.span_ns.unwrap_or((0, 0));
        let mut statistics = Records::default();
        statistics.add(op::STATISTICS, |out| {
            out.extend(self.counts.iter().sum::<u64>().to_le_bytes());
            out.extend((self.schemas.count as u16).to_le_bytes());
            for count in [
                self.channels.count,
                self.attachments.count,
                self.metadata.count,
                self.chunks.count,
            ] {
                out.extend(count.to_le_bytes());
            }
            out.extend(from.to_le_bytes());
            out.extend(to.to_le_bytes());
            list(out, |out| {
                let counts = self.counts.iter().enumerate();
                for (channel, count) in counts.filter(|(_, count)| **count > 0) {
                    out.extend((channel as u16).to_le_bytes());
                    out.extend(count.to_le_bytes());
                }
            });
        });
        statistics
    }

    fn append(&mut self, write: impl FnOnce(&mut Vec<u8>)) {
        let from = self.waiting.len();
        write(&mut self.waiting);
        self.crc.update(&self.waiting[from..]);
        self.at += (self.waiting.len() - from) as u64;
    }
}

impl Records {
    /// Gives the offset of the record.
    fn add(&mut self, code: u8, body: impl FnOnce(&mut Vec<u8>)) -> usize {
        let from = self.bytes.len();
        record(&mut self.bytes, code, body);
        self.count += 1;
        from
    }

    /// Bodies of the records.
    fn iter(&self) -> impl Iterator<Item = &[u8]> {
        let mut rest = &self.bytes[..];
        std::iter::from_fn(move || {
            let (head, after) = rest.split_first_chunk::<{ RECORD_HEAD as usize }>()?;
            let [_, len @ ..] = *head;
            let (body, after) = after.split_at_checked(u64::from_le_bytes(len) as usize)?;
            rest = after;
            Some(body)
        })
    }
}

/// The name in the body of a schema.
fn named(schema: &[u8]) -> &[u8] {
    let name = schema
        .get(2..)
        .and_then(|rest| rest.split_first_chunk::<4>());
    name.and_then(|(len, rest)| rest.get(..u32::from_le_bytes(*len) as usize))
        .unwrap_or_default()
}

fn record(out: &mut Vec<u8>, code: u8, body: impl FnOnce(&mut Vec<u8>)) {
    out.push(code);
    let at = out.len();
    out.extend([0; 8]);
    body(out);
    let len = (out.len() - at - 8) as u64;
    out[at..at + 8].copy_from_slice(&len.to_le_bytes());
}

/// Items with the number of their bytes before them.
fn list(out: &mut Vec<u8>, items: impl FnOnce(&mut Vec<u8>)) {
    let at = out.len();
    out.extend([0; 4]);
    items(out);
    let len = (out.len() - at - 4) as u32;
    out[at..at + 4].copy_from_slice(&len.to_le_bytes());
}

fn bytes(out: &mut Vec<u8>, bytes: &[u8]) {
    list(out, |out| out.extend(bytes));
}

fn text(out: &mut Vec<u8>, text: &str) {
    bytes(out, text.as_bytes());
}

/// What the index says of a chunk.
#[derive(Clone, Debug, PartialEq, Eq)]
struct ChunkEntry {
    at: u64,
    span_ns: (u64, u64),
    /// Before compression.
    bytes: u64,
    compressed: u64,
    /// By channel that has any, ascending: messages.
    messages: Vec<(u16, u64)>,
}

impl ChunkEntry {
    /// Bytes of the chunk's record: times, size, checksum, compression, size, data.
    fn len(&self) -> u64 {
        RECORD_HEAD + 3 * 8 + 4 + (4 + ZSTD.0.len() as u64) + 8 + self.compressed
    }

    /// Bytes of the message index of so many messages.
    fn index_len(messages: u64) -> u64 {
        RECORD_HEAD + 2 + 4 + 16 * messages
    }

    fn indexes_len(&self) -> u64 {
        let lengths = self
            .messages
            .iter()
            .map(|(_, count)| Self::index_len(*count));
        lengths.sum()
    }

    /// The chunk, and the indexes of its messages.
    fn write(&self, out: &mut Vec<u8>, chunk: &OpenChunk, data: &[u8]) {
        record(out, op::CHUNK, |out| {
            for number in [self.span_ns.0, self.span_ns.1, self.bytes] {
                out.extend(number.to_le_bytes());
            }
            out.extend(crc32fast::hash(&chunk.bytes).to_le_bytes());
            text(out, ZSTD.0);
            out.extend(self.compressed.to_le_bytes());
            out.extend(data);
        });
        for (channel, _) in &self.messages {
            record(out, op::MESSAGE_INDEX, |out| {
                out.extend(channel.to_le_bytes());
                list(out, |out| {
                    let messages = chunk.messages[usize::from(*channel)].as_flattened();
                    out.extend(messages.iter().flat_map(|number| number.to_le_bytes()));
                });
            });
        }
    }

    /// Its record in the summary.
    fn write_index(&self, out: &mut Vec<u8>) {
        record(out, op::CHUNK_INDEX, |out| {
            for number in [self.span_ns.0, self.span_ns.1, self.at, self.len()] {
                out.extend(number.to_le_bytes());
            }
            list(out, |out| {
                let mut at = self.at + self.len();
                for (channel, count) in &self.messages {
                    out.extend(channel.to_le_bytes());
                    out.extend(at.to_le_bytes());
                    at += Self::index_len(*count);
                }
            });
            out.extend(self.indexes_len().to_le_bytes());
            text(out, ZSTD.0);
            out.extend(self.compressed.to_le_bytes());
            out.extend(self.bytes.to_le_bytes());
        });
    }
}

/// The index of chunks, packed: differences as varints.
#[derive(Default)]
struct ChunkIndexes {
    count: u32,
    packed: Vec<u8>,
    /// Where the last chunk and its message indexes end, and its first time.
    next_at: u64,
    last_ns: u64,
}

impl ChunkIndexes {
    fn push(&mut self, entry: &ChunkEntry) {
        let (from, to) = entry.span_ns;
        let mut put = |number| encode_varint(number, &mut self.packed);
        // A file may go back in time; what wraps around here does so again when it is unpacked.
        let step = from.wrapping_sub(self.last_ns) as i64;
        put(((step << 1) ^ (step >> 63)) as u64);
        put(to - from);
        put(entry.at - self.next_at);
        put(entry.bytes);
        put(entry.compressed);
        put(entry.messages.len() as u64);
        for (channel, count) in &entry.messages {
            put(u64::from(*channel));
            put(*count);
        }
        self.last_ns = from;
        self.next_at = entry.at + entry.len() + entry.indexes_len();
        self.count += 1;
    }

    fn entries(&self) -> impl Iterator<Item = ChunkEntry> {
        let mut rest = &self.packed[..];
        let (mut next_at, mut last_ns) = (0, 0_u64);
        std::iter::from_fn(move || {
            let mut get = || decode_varint(&mut rest).ok();
            let step = get()?;
            let step = (step >> 1) as i64 ^ -((step & 1) as i64);
            last_ns = last_ns.wrapping_add(step as u64);
            let (span, gap) = (get()?, get()?);
            let mut entry = ChunkEntry {
                at: next_at + gap,
                span_ns: (last_ns, last_ns + span),
                bytes: get()?,
                compressed: get()?,
                messages: Vec::new(),
            };
            for _ in 0..get()? {
                entry.messages.push((get()? as u16, get()?));
            }
            next_at = entry.at + entry.len() + entry.indexes_len();
            Some(entry)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three channels of two schemas, 500 messages in chunks of uneven length, one of which goes back
    /// in time.
    fn written() -> Vec<u8> {
        let mut out = Vec::new();
        let mut file = Container::new(&mut out, "a test").unwrap();
        let entries = BTreeMap::from([("key".to_owned(), "value".to_owned())]);
        file.metadata("begin", &entries).unwrap();
        file.attach("scene", "text/plain", 0, 7, b"a scene")
            .unwrap();
        let channels = ["/a", "/b", "/c"].map(|topic| {
            let schema = if topic == "/c" { "Other" } else { "One" };
            file.channel(topic, schema, schema.as_bytes())
        });
        file.end_chunk().unwrap();
        for k in 0..500_u32 {
            let head = MessageHead {
                channel: channels[[0, 0, 1, 0, 2][k as usize % 5]],
                sequence: k,
                log_time: if k < 400 { 1_000 * u64::from(k) } else { 77 },
                publish_time: 5,
            };
            file.message(head, &vec![k as u8; 3 * k as usize]).unwrap();
            if k % 33 == 0 {
                file.end_chunk().unwrap();
            }
        }
        file.metadata("end", &entries).unwrap();
        assert_eq!(file.finish().unwrap(), out.len() as u64);
        out
    }

    #[test]
    fn the_mcap_library_reads_the_same_with_the_index_and_without() {
        let bytes = written();
        let streamed: Vec<_> = mcap::MessageStream::new(&bytes)
            .unwrap()
            .map(Result::unwrap)
            .collect();
        assert_eq!(streamed.len(), 500);
        for (k, message) in streamed.iter().enumerate() {
            let topic = ["/a", "/a", "/b", "/a", "/c"][k % 5];
            assert_eq!(
                (message.sequence, &*message.channel.topic),
                (k as u32, topic)
            );
            assert_eq!(*message.data, vec![k as u8; 3 * k]);
            let schema = message.channel.schema.as_ref().unwrap();
            assert_eq!(schema.name, if topic == "/c" { "Other" } else { "One" });
        }
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        let mut indexed = Vec::new();
        // The first announces channels and has no messages.
        assert!(summary.chunk_indexes[0].message_index_offsets.is_empty());
        for chunk in &summary.chunk_indexes[1..] {
            let behind = chunk.chunk_start_offset + chunk.chunk_length;
            let messages = summary.read_message_indexes(&bytes, chunk).unwrap();
            let of_channel = |offset: u64| bytes[offset as usize] == op::MESSAGE_INDEX;
            assert!(
                chunk
                    .message_index_offsets
                    .values()
                    .all(|at| of_channel(*at))
            );
            assert_eq!(
                bytes[(behind + chunk.message_index_length) as usize],
                match indexed.len() + messages.values().map(Vec::len).sum::<usize>() {
                    500 => op::METADATA,
                    _ => op::CHUNK,
                }
            );
            let mut found: Vec<_> = messages.into_values().flatten().collect();
            found.sort_by_key(|entry| entry.offset);
            for entry in found {
                indexed.push(summary.seek_message(&bytes, chunk, &entry).unwrap());
            }
        }
        assert_eq!(indexed, streamed);
        let stats = summary.stats.unwrap();
        assert_eq!(
            (stats.message_count, stats.schema_count, stats.channel_count),
            (500, 2, 3)
        );
        assert_eq!((stats.attachment_count, stats.metadata_count), (1, 2));
        assert_eq!(
            (stats.message_start_time, stats.message_end_time),
            (0, 399_000)
        );
        assert_eq!(
            stats.channel_message_counts,
            BTreeMap::from([(1, 300), (2, 100), (3, 100)])
        );
        let attachment = &summary.attachment_indexes[0];
        assert_eq!(
            &*mcap::read::attachment(&bytes, attachment).unwrap().data,
            b"a scene"
        );
        for index in &summary.metadata_indexes {
            let metadata = mcap::read::metadata(&bytes, index).unwrap();
            assert_eq!(
                (&metadata.name, &metadata.metadata["key"][..]),
                (&index.name, "value")
            );
        }
    }

    // Foxglove and others compare these; our reader compares that of the summary.
    #[test]
    fn the_checksums_of_data_and_summary_are_those_of_the_mcap_library() {
        let bytes = written();
        let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
        let crc = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let footer = bytes.len() - mcap::MAGIC.len() - 20;
        let start = number(footer) as usize;
        assert_eq!(crc(start - 4), crc32fast::hash(&bytes[..start - 13]));
        assert_eq!(
            crc(footer + 16),
            crc32fast::hash(&bytes[start..footer + 16])
        );
        // Its groups, in order and without a gap, end where their offsets begin.
        let mut at = start;
        let mut offsets = number(footer + 8) as usize;
        while bytes[offsets] == op::SUMMARY_OFFSET {
            let (code, from, len) = (
                bytes[offsets + 9],
                number(offsets + 10),
                number(offsets + 18),
            );
            assert_eq!((bytes[at], at as u64), (code, from));
            at += len as usize;
            offsets += 26;
        }
        assert_eq!(at as u64, number(footer + 8));
    }

    #[test]
    fn a_chunk_takes_some_sixty_bytes_of_memory_until_the_file_ends() {
        let entry = |k: u64| ChunkEntry {
            at: 90_000 * k,
            span_ns: (100_000_000 * k, 100_000_000 * k + 99_000_000),
            bytes: 95_000,
            compressed: 45_000 + k,
            messages: (1..=15).map(|channel| (channel, 100)).collect(),
        };
        let mut chunks = ChunkIndexes::default();
        (0..600).for_each(|k| chunks.push(&entry(k)));
        assert!(
            chunks.packed.len() < 600 * 60,
            "{} bytes",
            chunks.packed.len()
        );
        assert!(chunks.entries().eq((0..600).map(entry)));
    }
}
