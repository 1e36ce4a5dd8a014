//! What a recording is made of: size, compression, channels.

use super::reader::Session;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

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
    /// Name of the channel's topic.
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

/// What a session's file is made of. `counts`: by channel id, messages and their bytes.
pub(super) fn file_info(
    session: &Session,
    counts: &BTreeMap<u16, (u64, u64)>,
    duration_s: f64,
) -> FileInfo {
    let (uncompressed_bytes, compressed_bytes, compression) = session.compression();
    let channels = session.channels().into_iter().map(|(id, channel)| {
        let (messages, bytes) = counts.get(&id).copied().unwrap_or_default();
        ChannelInfo {
            topic: channel.topic,
            schema: channel.schema,
            encoding: channel.encoding,
            messages,
            bytes,
            bytes_per_s: if duration_s > 0.0 {
                bytes as f64 / duration_s
            } else {
                0.0
            },
        }
    });
    let mut info = FileInfo {
        bytes: session.file_bytes(),
        chunks: session.chunk_count() as u64,
        compression,
        uncompressed_bytes,
        compressed_bytes,
        channels: channels.collect(),
    };
    info.channels.sort_by(|a, b| a.topic.cmp(&b.topic));
    info
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
