//! The index at the end of a finished file: where chunks are, without reading what lies between.
//!
//! Nothing in it is believed that would lead beyond the file or over a chunk twice: its checksum,
//! its order, and that it leaves out no chunk are checked here; what it says of a chunk, when that
//! chunk is read.

use super::super::channel::Topic;
use super::layout::{Chunk, LARGEST, Layout, RECORD_HEAD, head};
use super::source::Source;
use mcap::records::{Record, op};
use std::collections::BTreeMap;
use std::io;

/// Footer record: summary start, offset start, checksum.
const FOOTER: u64 = RECORD_HEAD + 20;

/// What became of the index.
pub(super) enum Indexed {
    /// It was followed.
    Whole(Box<Layout>),
    /// There is none: the file was cut short, or its writer made none.
    None,
    /// There is one, and it is wrong.
    Wrong(&'static str),
}

/// Reads the index of a file.
///
/// # Errors
/// The disk refuses.
pub(super) fn read(source: &Source) -> io::Result<Indexed> {
    let magic = mcap::MAGIC.len() as u64;
    let Some(footer_at) = source
        .len()
        .checked_sub(magic + FOOTER)
        .filter(|at| *at >= magic)
    else {
        return Ok(Indexed::None);
    };
    let tail = source.read(footer_at, (FOOTER + magic) as usize)?;
    if !tail.ends_with(mcap::MAGIC)
        || head(source, footer_at, footer_at + FOOTER)? != Some((op::FOOTER, 20))
    {
        return Ok(Indexed::None);
    }
    let Ok(Record::Footer(footer)) =
        mcap::read::parse_record(op::FOOTER, &tail[RECORD_HEAD as usize..FOOTER as usize])
    else {
        return Ok(Indexed::None);
    };
    if footer.summary_start == 0 {
        return Ok(Indexed::None);
    }
    let start = footer.summary_start;
    if start < magic || start >= footer_at {
        return Ok(Indexed::Wrong("it does not lie within the file"));
    }
    // The checksum covers the footer as well, up to itself.
    let crc_end = footer_at + FOOTER - 4;
    if footer.summary_crc != 0 && checksum(source, start, crc_end)? != footer.summary_crc {
        return Ok(Indexed::Wrong("its checksum is another"));
    }
    let mut summary = Summary::default();
    if !summary.read(source, start, footer_at)? {
        return Ok(Indexed::Wrong("its records are not whole"));
    }
    summary.check(source, start)
}

fn checksum(source: &Source, from: u64, to: u64) -> io::Result<u32> {
    const STEP: u64 = 64 << 10;
    let mut hasher = crc32fast::Hasher::new();
    let (mut at, mut buffer) = (from, [0; STEP as usize]);
    while at < to {
        let part = &mut buffer[..(to - at).min(STEP) as usize];
        source.fill(at, part)?;
        hasher.update(part);
        at += part.len() as u64;
    }
    Ok(hasher.finalize())
}

#[derive(Default)]
struct Summary {
    layout: Layout,
    /// By chunk: bytes of the message indexes behind it, and whether it says which channels it has.
    behind: Vec<(u64, Vec<u16>)>,
    statistics: Option<(u64, BTreeMap<u16, u64>)>,
}

impl Summary {
    /// False when a record is cut short or does not parse.
    fn read(&mut self, source: &Source, from: u64, to: u64) -> io::Result<bool> {
        let mut at = from;
        while at < to {
            let Some((op, len)) = head(source, at, to)?.filter(|(_, len)| *len <= LARGEST as u64)
            else {
                return Ok(false);
            };
            if matches!(
                op,
                op::SCHEMA | op::CHANNEL | op::CHUNK_INDEX | op::STATISTICS
            ) {
                let body = source.read(at + RECORD_HEAD, len as usize)?;
                match (op, mcap::read::parse_record(op, &body)) {
                    (_, Err(_)) => return Ok(false),
                    (_, Ok(Record::ChunkIndex(index))) => {
                        let span_ns = [index.message_start_time, index.message_end_time];
                        let (at, len) = (index.chunk_start_offset, index.chunk_length);
                        self.layout.chunks.push(Chunk::new(at, len, span_ns));
                        let channels = index.message_index_offsets.into_keys().collect();
                        self.behind.push((index.message_index_length, channels));
                        let (compressed, uncompressed) =
                            (index.compressed_size, index.uncompressed_size);
                        self.layout
                            .count_chunk(&index.compression, compressed, uncompressed);
                    }
                    (_, Ok(Record::Statistics(statistics))) => {
                        self.statistics = Some((
                            statistics.chunk_count.into(),
                            statistics.channel_message_counts,
                        ));
                    }
                    _ => self.layout.take(op, &body),
                }
            }
            at += RECORD_HEAD + len;
        }
        Ok(true)
    }

    /// Are the chunks where the index says, in order, and are there no others?
    fn check(mut self, source: &Source, data_end: u64) -> io::Result<Indexed> {
        let Some((chunk_count, messages)) = self.statistics.take() else {
            return Ok(Indexed::Wrong("it has no statistics"));
        };
        let chunks = std::mem::take(&mut self.layout.chunks);
        if chunk_count != chunks.len() as u64 {
            return Ok(Indexed::Wrong("it lists other chunks than it counts"));
        }
        let mut at = mcap::MAGIC.len() as u64;
        for (chunk, (behind, _)) in chunks.iter().zip(&self.behind) {
            if chunk.at < at || chunk.len < RECORD_HEAD || chunk.end() > data_end {
                return Ok(Indexed::Wrong("its chunks overlap or lie outside"));
            }
            self.layout.walk(source, at..chunk.at)?;
            at = chunk.end();
            // Message indexes hold nothing that we need.
            at += if *behind <= data_end - at { *behind } else { 0 };
        }
        self.layout.walk(source, at..data_end)?;
        if self.layout.damage.is_some() || !self.layout.chunks.is_empty() || self.layout.ended {
            return Ok(Indexed::Wrong(
                "something else lies where it says there is nothing",
            ));
        }
        let keyframes: Vec<u16> = (self.layout.channels.iter())
            .filter(|(_, channel)| Topic::of(&channel.topic) == Some(Topic::Keyframe))
            .map(|(id, _)| *id)
            .collect();
        let total: u64 = messages.values().fold(0, |sum, n| sum.saturating_add(*n));
        if total > 0 && self.behind.iter().all(|(_, channels)| channels.is_empty()) {
            // A writer that left message indexes out: which chunk has a keyframe is not known.
            return Ok(Indexed::None);
        }
        self.layout.chunks = chunks;
        for (chunk, (_, channels)) in self.layout.chunks.iter_mut().zip(&self.behind) {
            chunk.keyframe = channels.iter().any(|id| keyframes.contains(id));
        }
        (self.layout.messages, self.layout.ended) = (messages, true);
        Ok(Indexed::Whole(Box::new(self.layout)))
    }
}
