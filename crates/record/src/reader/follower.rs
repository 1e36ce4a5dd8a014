//! What happened, in the order in which it happened.
//!
//! The order is that of the file: the record of tick t, the nets after it, commands and keyframes
//! of the state after it in the order in which they came (a keyframe holds the commands before it),
//! then tick t + 1. Events stand where they became known.

use super::super::channel::{Happening, Topic};
use super::error::ReadError;
use super::page::{Page, PageError};
use super::session::Session;
use std::collections::BTreeMap;
use std::thread::JoinHandle;

/// A place in a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Chunk, by number.
    pub(super) chunk: usize,
    /// Message of ours in it.
    pub(super) entry: usize,
}

/// Reads a recording from a place on, one chunk at a time.
///
/// A chunk that is damaged is left out, and [`Session::cut_short`] says so from then on; what
/// follows it comes all the same. A message that does not hold what its type promises, or a disk
/// that refuses, is an error and the end.
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use palpate_record::{Follower, Happening, Session};
/// let session = Session::open("session.mcap".as_ref())?;
/// for happening in Follower::new(&session) {
///     if let Happening::Tick(record) = happening? {
///         println!("{} {}", record.output.tick, record.output.tools[0].force_n.norm());
///     }
/// }
/// # Ok(()) }
/// ```
#[derive(Debug)]
pub struct Follower {
    session: Session,
    next: Place,
    /// The chunk of `next`, once it is read.
    page: Option<Page>,
    /// First and last tick of interest.
    range: (u64, u64),
    only: &'static [Topic],
    reads_ahead: bool,
    /// A chunk that is being read, by number.
    ahead: Option<(usize, JoinHandle<Result<Page, PageError>>)>,
    /// By channel: messages and bytes of the chunks read so far.
    counts: BTreeMap<u16, (u64, u64)>,
    failed: bool,
}

impl Follower {
    /// From the start.
    pub fn new(session: &Session) -> Self {
        Self::at(session, Place::default())
    }

    /// From a place on.
    pub fn at(session: &Session, place: Place) -> Self {
        Self {
            session: session.clone(),
            next: place,
            page: None,
            range: (0, u64::MAX),
            only: &[],
            reads_ahead: false,
            ahead: None,
            counts: BTreeMap::new(),
            failed: false,
        }
    }

    /// All that has a tick from `from` to `until`, both included. Chunks that end before or begin
    /// after are not read.
    pub fn between(session: &Session, from: u64, until: u64) -> Self {
        let from_ns = from.saturating_mul(session.dt_ns());
        let chunk = session
            .chunks()
            .partition_point(|chunk| chunk.past_to_ns < from_ns);
        let place = Place { chunk, entry: 0 };
        Self {
            range: (from, until),
            ..Self::at(session, place)
        }
    }

    /// Leaves out what lies after a tick.
    #[must_use]
    pub fn until(self, until: u64) -> Self {
        let range = (self.range.0, until);
        Self { range, ..self }
    }

    /// Leaves out what is of other topics, without decoding it.
    #[must_use]
    pub fn only(self, only: &'static [Topic]) -> Self {
        Self { only, ..self }
    }

    /// Reads the next chunk on a thread of its own while messages of this one are used, to avoid waiting
    /// for the disk and for decompression.
    #[must_use]
    pub fn reading_ahead(self) -> Self {
        Self {
            reads_ahead: true,
            ..self
        }
    }

    /// Place of the next message.
    pub fn place(&self) -> Place {
        self.next
    }

    /// Goes elsewhere.
    pub fn go(&mut self, place: Place) {
        if place.chunk != self.next.chunk {
            self.page = None;
        }
        self.next = place;
    }

    /// The last that came comes once more.
    pub fn step_back(&mut self) {
        self.next.entry = self.next.entry.saturating_sub(1);
    }

    /// By channel: messages and their bytes, of all topics, in the chunks that were read.
    pub(in super::super) fn counts(&self) -> &BTreeMap<u16, (u64, u64)> {
        &self.counts
    }

    /// The next, but nothing of chunks after number `last`.
    pub(super) fn next_until(&mut self, last: usize) -> Option<Result<Happening, ReadError>> {
        while !self.failed {
            if let Err(error) = self.load(last)? {
                self.failed = true;
                return Some(Err(error));
            }
            let page = self.page.as_ref()?;
            let Some(entry) = page.entries.get(self.next.entry) else {
                self.leave();
                continue;
            };
            self.next.entry += 1;
            if !self.only.is_empty() && !self.only.contains(&entry.topic) {
                continue;
            }
            match entry.topic.decode(page.message(entry)) {
                Ok(happening) if (self.range.0..=self.range.1).contains(&happening.tick()) => {
                    return Some(Ok(happening));
                }
                Ok(_) => {}
                Err(source) => {
                    self.failed = true;
                    let path = self.session.path.clone();
                    return Some(Err(ReadError::Message { path, source }));
                }
            }
        }
        None
    }

    fn read(&mut self, chunk: usize) -> Result<Page, PageError> {
        let ahead = self.ahead.take().filter(|(number, _)| *number == chunk);
        let page = match ahead.map(|(_, thread)| thread.join()) {
            Some(Ok(page)) => page,
            _ => self.session.page(chunk),
        };
        let next = chunk + 1;
        if self.reads_ahead && next < self.session.chunks().len() {
            let session = self.session.clone();
            // Without a thread it is read when it is needed.
            let thread = std::thread::Builder::new().name("palpate-reader".into());
            let thread = thread.spawn(move || session.page(next));
            self.ahead = thread.ok().map(|thread| (next, thread));
        }
        page
    }

    /// Goes to the start of the next chunk.
    fn leave(&mut self) {
        self.page = None;
        self.next = Place {
            chunk: self.next.chunk + 1,
            entry: 0,
        };
    }

    /// Has the page of `next`, or of the first whole chunk after it; `None` at the end.
    fn load(&mut self, last: usize) -> Option<Result<(), ReadError>> {
        while self.page.is_none() {
            let chunk = self.session.chunks().get(self.next.chunk)?;
            let until_ns = self.range.1.saturating_mul(self.session.dt_ns());
            if chunk.rest_from_ns > until_ns || self.next.chunk > last {
                return None;
            }
            match self.read(self.next.chunk) {
                Ok(page) => {
                    for (id, (messages, bytes)) in &page.counts {
                        let count = self.counts.entry(*id).or_default();
                        *count = (count.0 + messages, count.1 + bytes);
                    }
                    self.page = Some(page);
                }
                Err(PageError::Damaged(reason)) => {
                    self.session.damaged(format!("a damaged chunk: {reason}"));
                    self.leave();
                }
                Err(PageError::Io(source)) => {
                    let path = self.session.path.clone();
                    return Some(Err(ReadError::Io { path, source }));
                }
            }
        }
        Some(Ok(()))
    }
}

impl Iterator for Follower {
    type Item = Result<Happening, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_until(usize::MAX)
    }
}
