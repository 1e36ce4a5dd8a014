//! Threads that replay segments, and whoever puts together what they find.

use super::super::reader::Session;
use super::error::ReplayError;
use super::stretches::{Equal, Findings, Runner, Segment};
use palpate_sim::scene::Scene;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError, mpsc};
use std::time::Duration;

/// Threads that replay segments.
pub(super) struct Team<'a> {
    pub session: &'a Session,
    pub scene: &'a Arc<Scene>,
    pub segments: &'a [Segment],
    /// Last tick to replay.
    pub until: u64,
    /// Threads.
    pub jobs: usize,
}

/// What threads report.
enum News {
    /// Of a segment, some that were equal.
    Equal(usize, Equal),
    /// What was found of a segment, after all its ticks.
    Found(usize, Box<Result<Findings, ReplayError>>),
}

/// What came of a segment before those ahead of it were done.
#[derive(Default)]
struct WaitingStretch {
    equal: Vec<Equal>,
    found: Option<Result<Findings, ReplayError>>,
}

/// What threads share.
struct TeamShare {
    next: AtomicUsize,
    /// The first segment that parts: those after it are of no interest.
    parted: AtomicUsize,
    /// Segments that were taken in. Threads do not run far ahead of it, so that what waits stays
    /// small.
    taken: Mutex<usize>,
    moved: Condvar,
}

/// Segments that may wait for an earlier one, for each thread.
const AHEAD: usize = 8;

impl TeamShare {
    /// Waits until segment `k` may begin; false when it is not wanted.
    fn admit(&self, k: usize, ahead: usize) -> bool {
        let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
        while k < self.parted.load(Ordering::Relaxed) {
            if k < taken.saturating_add(ahead) {
                return true;
            }
            let waited = self.moved.wait_timeout(taken, Duration::from_millis(50));
            taken = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        false
    }

    fn advance(&self, taken: usize) {
        *self.taken.lock().unwrap_or_else(PoisonError::into_inner) = taken;
        self.moved.notify_all();
    }
}

impl Team<'_> {
    /// Hands out what was found in the order of ticks, up to the first segment that parts: none is
    /// missing before it.
    pub fn run(
        &self,
        mut progress: impl FnMut(u64),
        mut take_equal: impl FnMut(Equal),
        mut take: impl FnMut(Findings),
    ) -> Result<(), ReplayError> {
        let shared = TeamShare {
            next: AtomicUsize::new(0),
            parted: AtomicUsize::new(usize::MAX),
            taken: Mutex::new(0),
            moved: Condvar::new(),
        };
        std::thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            for _ in 0..self.jobs {
                let (sender, shared) = (sender.clone(), &shared);
                scope.spawn(move || self.work(shared, &sender));
            }
            drop(sender);
            let (mut done, mut taken, mut over) = (0, 0, Ok(()));
            let mut waiting = BTreeMap::<usize, WaitingStretch>::new();
            for news in receiver {
                match news {
                    News::Equal(k, equal) => {
                        done += equal.len() as u64;
                        progress(done);
                        waiting.entry(k).or_default().equal.push(equal);
                    }
                    News::Found(k, found) => waiting.entry(k).or_default().found = Some(*found),
                }
                while let Some(first) = waiting.get_mut(&taken) {
                    first.equal.drain(..).for_each(&mut take_equal);
                    let Some(found) = first.found.take() else {
                        break;
                    };
                    waiting.remove(&taken);
                    // Nothing after the first that parts is taken in.
                    taken = match found {
                        Ok(found) if found.divergence.is_none() => {
                            take(found);
                            taken + 1
                        }
                        Ok(found) => {
                            take(found);
                            usize::MAX
                        }
                        Err(error) => {
                            over = Err(error);
                            usize::MAX
                        }
                    };
                    shared.advance(taken);
                }
            }
            over
        })
    }

    fn work(&self, shared: &TeamShare, sender: &mpsc::Sender<News>) {
        let mut runner = Runner::new(self.session, self.scene, self.until);
        loop {
            let k = shared.next.fetch_add(1, Ordering::Relaxed);
            let Some(segment) = self.segments.get(k) else {
                break;
            };
            if !shared.admit(k, AHEAD * self.jobs) {
                break;
            }
            let abandon = || shared.parted.load(Ordering::Relaxed) < k;
            let done = runner.run(segment, abandon, |equal| {
                drop(sender.send(News::Equal(k, equal)));
            });
            let Some(done) = done.transpose() else {
                continue;
            };
            if done
                .as_ref()
                .map_or(true, |found| found.divergence.is_some())
            {
                shared.parted.fetch_min(k, Ordering::Relaxed);
            }
            let _ = sender.send(News::Found(k, Box::new(done)));
        }
    }
}
