//! A recording: its head, where its chunks are, and what is known of them without reading them all.

use super::super::FORMAT_VERSION;
use super::super::channel::Topic;
use super::super::format::{HOLDS, HOLDS_INPUTS};
use super::error::ReadError;
use super::index::{self, Indexed};
use super::layout::{Chunk, Layout, SessionHeader};
use super::page::{Page, PageError, Topics};
use super::source::Source;
use prost::Message as _;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// A recording on disk or in memory, opened but not read: ticks, states, commands, nets and events
/// come from a [`super::Follower`]. Clones share one file.
///
/// What it takes of memory does not grow with the ticks in the file, but with its chunks, by some
/// sixty bytes each.
#[derive(Clone, Debug)]
pub struct Session {
    /// File it came from.
    pub path: PathBuf,
    /// Head.
    pub header: Arc<SessionHeader>,
    inner: Arc<Inner>,
}

#[derive(Debug)]
struct Inner {
    source: Source,
    layout: Layout,
    topics: Topics,
    /// First and last tick.
    ends: Option<(u64, u64)>,
    /// The index at the end of the file was followed.
    indexed: bool,
    /// What is missing of the file: known from the start, or met while it was read.
    cut_short: OnceLock<String>,
}

/// The tick of any message: our messages have it as their first field.
#[derive(Clone, Copy, PartialEq, prost::Message)]
struct TickOf {
    #[prost(uint64, tag = "1")]
    tick: u64,
}

/// Messages of a channel, from a file or from the recorder's word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in super::super) struct ChannelHead {
    pub topic: String,
    pub schema: String,
    pub encoding: String,
}

impl Session {
    /// Opens a file: reads its head and its index. Chunks are read when someone follows the
    /// session; damage in them shows then.
    ///
    /// A file without an index, or with one that is wrong, is read through once, to find out what
    /// chunks it has and whether they are whole.
    ///
    /// # Errors
    /// Not a file, not MCAP, not ours, of another format, or reduced to its inputs. A file cut short is
    /// not an error: see [`Session::cut_short`].
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::open_any(path)?.with_outputs()
    }

    /// [`Session::open`], also of a recording that is reduced to its inputs.
    ///
    /// # Errors
    /// As there, but for that.
    pub fn open_any(path: &Path) -> Result<Self, ReadError> {
        let source = Source::open(path).map_err(|source| io(path, source))?;
        Self::of(path, source)
    }

    /// [`Session::open`] on bytes at hand; `path` is for messages.
    ///
    /// # Errors
    /// As there.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, ReadError> {
        Self::parse_any(path, bytes)?.with_outputs()
    }

    /// [`Session::open_any`] on bytes at hand; `path` is for messages.
    ///
    /// # Errors
    /// As there.
    pub fn parse_any(path: &Path, bytes: &[u8]) -> Result<Self, ReadError> {
        Self::of(path, Source::Memory(bytes.into()))
    }

    /// The session, if it holds what came of its inputs.
    ///
    /// # Errors
    /// It was reduced to its inputs.
    pub fn with_outputs(self) -> Result<Self, ReadError> {
        match self.holds_inputs_only() {
            true => Err(ReadError::InputsOnly(self.path)),
            false => Ok(self),
        }
    }

    /// It was reduced to what goes into its ticks.
    pub fn holds_inputs_only(&self) -> bool {
        let holds = self.header.run.get(HOLDS);
        holds.is_some_and(|holds| holds == HOLDS_INPUTS)
    }

    fn of(path: &Path, source: Source) -> Result<Self, ReadError> {
        let io = |source| io(path, source);
        let magic = mcap::MAGIC.len();
        let short = source.len() < magic as u64;
        if short || source.read(0, magic).map_err(io)? != mcap::MAGIC {
            return Err(ReadError::NotMcap {
                path: path.to_owned(),
                reason: "the first eight bytes are not its magic".into(),
            });
        }
        let (mut layout, indexed) = match index::read(&source).map_err(io)? {
            Indexed::Whole(layout) => (*layout, true),
            other => {
                let mut layout = Layout::default();
                layout
                    .walk(&source, magic as u64..source.len())
                    .map_err(io)?;
                if let Indexed::Wrong(why) = other {
                    layout.damaged(format!("the index at the end of the file is wrong: {why}"));
                }
                if !layout.ended {
                    layout.damaged("the file ends before its footer");
                }
                (layout, false)
            }
        };
        check(path, &layout.header)?;
        // One chunk that names another way is damage; all of them are someone else's choice.
        let known = |name: &String| ["none", "zstd"].contains(&name.as_str());
        if let Some(found) = layout.compression.first()
            && !layout.compression.iter().any(known)
        {
            return Err(ReadError::Compression {
                path: path.to_owned(),
                found: found.clone(),
            });
        }
        let ends = if indexed {
            layout.order();
            ends(&source, &mut layout).map_err(io)?
        } else {
            let ends = survey(&source, &mut layout).map_err(io)?;
            layout.order();
            ends
        };
        let cut_short = OnceLock::new();
        if let Some(damage) = layout.damage.take() {
            let _ = cut_short.set(damage);
        }
        let topics = topics_of(&layout);
        Ok(Self {
            path: path.to_owned(),
            header: Arc::new(std::mem::take(&mut layout.header)),
            inner: Arc::new(Inner {
                source,
                layout,
                topics,
                ends,
                indexed,
                cut_short,
            }),
        })
    }

    /// Why the file is not whole, as far as that is known: a file without an index was read to its
    /// end when it was opened; of one with an index, each chunk says so when it is read.
    pub fn cut_short(&self) -> Option<&str> {
        self.inner.cut_short.get().map(String::as_str)
    }

    /// Notes damage that was met on the way; the first is kept.
    pub(super) fn damaged(&self, reason: String) {
        let _ = self.inner.cut_short.set(reason);
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

    /// The file was finished without a loss, and nothing of it was found damaged so far.
    pub fn is_whole(&self) -> bool {
        self.is_clean() && self.cut_short().is_none()
    }

    /// Ticks in it: counted where the file had to be read through, else as its index says.
    pub fn tick_count(&self) -> u64 {
        match self.holds_inputs_only() {
            true => self.end_number("ticks").unwrap_or(0),
            false => self.message_count(Topic::Tick),
        }
    }

    /// Messages of a topic: as [`Session::tick_count`].
    pub fn message_count(&self, topic: Topic) -> u64 {
        let own = |id: &u16| self.inner.topics.get(id).copied().flatten() == Some(topic);
        let messages = self.inner.layout.messages.iter();
        let counts = messages.filter(|(id, _)| own(id)).map(|(_, count)| *count);
        counts.fold(0, u64::saturating_add)
    }

    /// First and last tick; `None` without ticks.
    pub fn tick_range(&self) -> Option<(u64, u64)> {
        self.inner.ends
    }

    /// Ticks missing between the first and the last.
    pub fn gaps(&self) -> u64 {
        self.inner.ends.map_or(0, |(first, last)| {
            let span = last.saturating_sub(first).saturating_add(1);
            span.saturating_sub(self.tick_count())
        })
    }

    /// Length of a tick, ns.
    pub fn dt_ns(&self) -> u64 {
        self.run_number("dt_ns").unwrap_or(1_000_000)
    }

    /// The index at the end of the file was followed: nothing but it, the head and two chunks were
    /// read to open the file.
    pub fn has_index(&self) -> bool {
        self.inner.indexed
    }

    /// What the recorder summed up when it finished, as written.
    pub(in super::super) fn written_totals(&self) -> Option<&str> {
        self.inner.layout.totals.as_deref()
    }

    pub(in super::super) fn file_bytes(&self) -> u64 {
        self.inner.source.len()
    }

    /// Bytes of chunks before compression and on disk, and how they are compressed.
    pub(in super::super) fn compression(&self) -> (u64, u64, Vec<String>) {
        let layout = &self.inner.layout;
        let names = layout.compression.iter().cloned().collect();
        (layout.uncompressed_bytes, layout.compressed_bytes, names)
    }

    /// By id.
    pub(in super::super) fn channels(&self) -> BTreeMap<u16, ChannelHead> {
        let layout = &self.inner.layout;
        let channels = layout.channels.iter().map(|(id, channel)| {
            let schema = layout.schemas.get(&channel.schema);
            let head = ChannelHead {
                topic: channel.topic.clone(),
                schema: schema.cloned().unwrap_or_default(),
                encoding: channel.encoding.clone(),
            };
            (*id, head)
        });
        channels.collect()
    }

    /// Chunks, in the order of the file.
    pub(in super::super) fn chunk_count(&self) -> usize {
        self.inner.layout.chunks.len()
    }

    pub(super) fn chunks(&self) -> &[Chunk] {
        &self.inner.layout.chunks
    }

    pub(super) fn page(&self, chunk: usize) -> Result<Page, PageError> {
        let chunk = &self.inner.layout.chunks[chunk];
        let page = Page::read(&self.inner.source, chunk, &self.inner.topics)?;
        if self.inner.indexed
            && page
                .span_ns
                .is_some_and(|(from, to)| from < chunk.from_ns || to > chunk.to_ns)
        {
            self.damaged("the index at the end of the file is wrong: times of a chunk".into());
        }
        Ok(page)
    }
}

fn io(path: &Path, source: std::io::Error) -> ReadError {
    let path = path.to_owned();
    ReadError::Io { path, source }
}

fn topics_of(layout: &Layout) -> Topics {
    let channels = layout.channels.iter();
    channels
        .map(|(id, channel)| (*id, Topic::of(&channel.topic)))
        .collect()
}

fn check(path: &Path, header: &SessionHeader) -> Result<(), ReadError> {
    let path = || path.to_owned();
    let missing = match header.run.get("format") {
        Some(found) if *found != FORMAT_VERSION.to_string() => {
            return Err(ReadError::Format {
                path: path(),
                found: found.clone(),
            });
        }
        None => "the metadata record palpate.run",
        Some(_) if header.effective_scene.is_empty() => "the attachment scene.effective.toml",
        Some(_) => return Ok(()),
    };
    Err(ReadError::Foreign {
        path: path(),
        missing,
    })
}

/// Ticks of a page.
fn ticks(page: &Page) -> impl Iterator<Item = u64> + '_ {
    let ticks = page.entries.iter().filter(|e| e.topic == Topic::Tick);
    // What does not parse is met again by whoever follows, who says so.
    ticks.filter_map(|entry| Some(TickOf::decode(page.message(entry)).ok()?.tick))
}

/// Reads each chunk of a file without an index: counts, times, which have keyframes. Gives the
/// first and the last tick.
fn survey(source: &Source, layout: &mut Layout) -> std::io::Result<Option<(u64, u64)>> {
    let (mut ends, mut topics) = (None, topics_of(layout));
    for k in 0..layout.chunks.len() {
        match Page::read(source, &layout.chunks[k], &topics) {
            Err(PageError::Io(error)) => return Err(error),
            Err(PageError::Damaged(reason)) => layout.damaged(format!("a damaged chunk: {reason}")),
            Ok(page) => {
                for tick in ticks(&page) {
                    let (first, last) = ends.unwrap_or((tick, tick));
                    ends = Some((tick.min(first), tick.max(last)));
                }
                for (id, (messages, _)) in &page.counts {
                    let count = layout.messages.entry(*id).or_default();
                    *count = count.saturating_add(*messages);
                }
                let chunk = &mut layout.chunks[k];
                (chunk.from_ns, chunk.to_ns) = page.span_ns.unwrap_or((u64::MAX, 0));
                chunk.keyframe = page.entries.iter().any(|e| e.topic == Topic::Keyframe);
                for (id, channel) in page.announced {
                    topics.insert(id, Topic::of(&channel.topic));
                    layout.announce(id, channel);
                }
            }
        }
    }
    Ok(ends)
}

/// The first and the last tick of a file with an index, from the first and the last chunk that has
/// any.
fn ends(source: &Source, layout: &mut Layout) -> std::io::Result<Option<(u64, u64)>> {
    let ticks_of = |name: &str| Topic::of(name) == Some(Topic::Tick);
    let ids = layout.channels.iter().filter(|(_, c)| ticks_of(&c.topic));
    let counted = |(id, _): (&u16, _)| layout.messages.get(id).is_some_and(|n| *n > 0);
    if !ids.into_iter().any(counted) {
        return Ok(None);
    }
    let topics = topics_of(layout);
    let mut found = [None, None];
    for (side, found) in found.iter_mut().enumerate() {
        for k in 0..layout.chunks.len() {
            let k = if side == 0 {
                k
            } else {
                layout.chunks.len() - 1 - k
            };
            match Page::read(source, &layout.chunks[k], &topics) {
                Err(PageError::Io(error)) => return Err(error),
                Err(PageError::Damaged(reason)) => {
                    layout.damaged(format!("a damaged chunk: {reason}"));
                }
                Ok(page) => {
                    *found = match side {
                        0 => ticks(&page).min(),
                        _ => ticks(&page).max(),
                    };
                }
            }
            if found.is_some() {
                break;
            }
        }
    }
    Ok(found[0].zip(found[1]))
}
