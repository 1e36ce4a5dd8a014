//! What a recording is made of: size, compression, channels.

use super::reader::{chunk_records, records};
use mcap::records::Record;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// Figures of a file. Of one that was cut short, of what can be read.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FileInfo {
    /// Bytes on disk.
    pub bytes: u64,
    /// Chunks.
    pub chunks: u64,
    /// How chunks are compressed: each way that occurs.
    pub compression: Vec<String>,
    /// Bytes of chunks before compression.
    pub uncompressed_bytes: u64,
    /// Bytes of chunks on disk.
    pub compressed_bytes: u64,
    /// By topic.
    pub channels: Vec<ChannelInfo>,
}

/// Figures of a channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ChannelInfo {
    /// Topic.
    pub topic: String,
    /// Name of its schema.
    pub schema: String,
    /// How messages are encoded.
    pub encoding: String,
    /// Messages.
    pub messages: u64,
    /// Bytes of its messages, before compression.
    pub bytes: u64,
    /// The same a second of the session.
    pub bytes_per_s: f64,
}

/// Looks into a file; `duration_s` is that of its session.
///
/// # Errors
/// The file cannot be read. One that is no MCAP file has no chunks.
pub fn file_info(path: &Path, duration_s: f64) -> std::io::Result<FileInfo> {
    Ok(inspect(&std::fs::read(path)?, duration_s))
}

#[derive(Default)]
struct Inspected {
    info: FileInfo,
    schemas: BTreeMap<u16, String>,
    /// By channel id.
    channels: BTreeMap<u16, (u16, ChannelInfo)>,
}

fn inspect(bytes: &[u8], duration_s: f64) -> FileInfo {
    let mut seen = Inspected::default();
    seen.info.bytes = bytes.len() as u64;
    if bytes.starts_with(mcap::MAGIC) {
        for (record, whole) in records(bytes).flatten() {
            if let Record::Chunk { header, .. } = &record {
                seen.chunk(
                    &header.compression,
                    header.uncompressed_size,
                    header.compressed_size,
                );
                // A damaged chunk counts for its size only.
                chunk_records(whole)
                    .unwrap_or_default()
                    .into_iter()
                    .for_each(|record| seen.take(record));
            } else {
                seen.take(record);
            }
        }
    }
    let Inspected {
        mut info,
        schemas,
        channels,
    } = seen;
    let channels = channels.into_values().map(|(schema, channel)| ChannelInfo {
        schema: schemas.get(&schema).cloned().unwrap_or_default(),
        bytes_per_s: if duration_s > 0.0 {
            channel.bytes as f64 / duration_s
        } else {
            0.0
        },
        ..channel
    });
    info.channels = channels.collect();
    info.channels.sort_by(|a, b| a.topic.cmp(&b.topic));
    info
}

impl Inspected {
    fn chunk(&mut self, compression: &str, uncompressed: u64, compressed: u64) {
        let info = &mut self.info;
        info.chunks += 1;
        info.uncompressed_bytes = info.uncompressed_bytes.saturating_add(uncompressed);
        info.compressed_bytes = info.compressed_bytes.saturating_add(compressed);
        let name = if compression.is_empty() {
            "none"
        } else {
            compression
        };
        if !info.compression.iter().any(|known| known == name) {
            info.compression.push(name.to_owned());
        }
    }

    fn take(&mut self, record: Record<'_>) {
        match record {
            Record::Schema { header, .. } => drop(self.schemas.insert(header.id, header.name)),
            // Told once more at the end of the file; what was counted stays.
            Record::Channel(channel) => {
                let (topic, encoding) = (channel.topic, channel.message_encoding);
                let fresh = || {
                    (
                        channel.schema_id,
                        ChannelInfo {
                            topic,
                            encoding,
                            ..ChannelInfo::default()
                        },
                    )
                };
                self.channels.entry(channel.id).or_insert_with(fresh);
            }
            Record::Message { header, data } => {
                if let Some((_, channel)) = self.channels.get_mut(&header.channel_id) {
                    channel.messages += 1;
                    channel.bytes += data.len() as u64;
                }
            }
            _ => {}
        }
    }
}

impl fmt::Display for FileInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ratio = self.uncompressed_bytes as f64 / (self.compressed_bytes as f64).max(1.0);
        writeln!(
            f,
            "  {} bytes in {} chunks, compression {}, {ratio:.2} to 1",
            self.bytes,
            self.chunks,
            if self.compression.is_empty() {
                "none".into()
            } else {
                self.compression.join(" and ")
            }
        )?;
        writeln!(
            f,
            "  {:<28} {:<24} {:>10} {:>14} {:>12}",
            "channel", "schema", "messages", "bytes", "bytes/s"
        )?;
        for channel in &self.channels {
            let ChannelInfo {
                topic,
                schema,
                messages,
                bytes,
                bytes_per_s,
                ..
            } = channel;
            writeln!(
                f,
                "  {topic:<28} {schema:<24} {messages:>10} {bytes:>14} {bytes_per_s:>12.0}"
            )?;
        }
        Ok(())
    }
}
