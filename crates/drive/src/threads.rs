//! Threads that take part in a tick, so that bodies step side by side.
//!
//! ```text
//! tick thread   wake ─── run: offers ─▶ does its own piece ─▶ takes back what no one has begun ─▶ waits ─── rest
//! worker        parked ─▶ looks out for an offer ─▶ takes it ─▶ done ─▶ looks out ───────────────────────▶ parked
//! ```
//! A worker that does not come in time costs nothing but the time saved: the tick thread does its piece as well.
//! Nothing is allocated after the start, nothing locked.

use super::pacer::{ask_privileges, now_ns};
use palpate_sim::tick::{Executor, MOST_LOTS};
use std::cell::Cell;
use std::hint::spin_loop;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::thread::JoinHandle;

/// A worker that has found nothing for so long parks though it was asked to look out, ns.
const LOOKS_OUT_NS: u64 = 5_000_000;
/// Looks between two looks at the clock.
const LOOKS: u32 = 256;

/// Nothing is on offer.
const NONE: u8 = 0;
/// A piece of work is there, and no one has begun it.
const OFFERED: u8 = 1;
/// A worker does it.
const TAKEN: u8 = 2;
/// It is done.
const DONE: u8 = 3;
/// It panicked.
const PANICKED: u8 = 4;

type Work = *mut (dyn FnMut() + Send);

/// Where one worker finds its work. Alone on its line of the cache.
#[derive(Debug)]
#[repr(align(128))]
struct Desk {
    state: AtomicU8,
    /// Written by the tick thread before it says [`OFFERED`], read by the worker after it says [`TAKEN`].
    work: Cell<Option<Work>>,
    /// The worker is to look out for offers.
    awake: AtomicBool,
    stop: AtomicBool,
}

// SAFETY: `work` is written by the thread that owns `Threads` while `state` is NONE, and read by the worker only
// after it has changed `state` from OFFERED to TAKEN, which orders the two.
#[allow(unsafe_code)]
unsafe impl Sync for Desk {}
// SAFETY: what `work` points to is `Send`, and lives until `Threads::run` has seen the worker done.
#[allow(unsafe_code)]
unsafe impl Send for Desk {}

/// Workers beside the thread of the tick.
#[derive(Debug)]
pub struct Threads {
    workers: Vec<(Arc<Desk>, JoinHandle<()>)>,
}

impl Threads {
    /// As many as there are processors beside that of the tick, at most `most` together with it; `None` for fewer than
    /// two. `privileged`: they ask for FIFO scheduling, as the thread of the tick does.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn start(most: usize, privileged: bool) -> std::io::Result<Option<Self>> {
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        let width = processors.min(most).min(MOST_LOTS);
        let start = |k| {
            let desk = Arc::new(Desk {
                state: AtomicU8::new(NONE),
                work: Cell::new(None),
                awake: AtomicBool::new(false),
                stop: AtomicBool::new(false),
            });
            let theirs = desk.clone();
            let thread = std::thread::Builder::new()
                .name(format!("palpate-step-{k}"))
                .spawn(move || {
                    if privileged {
                        ask_privileges();
                    }
                    theirs.work();
                })?;
            Ok((desk, thread))
        };
        let workers = (1..width).map(start).collect::<std::io::Result<Vec<_>>>()?;
        Ok((!workers.is_empty()).then_some(Self { workers }))
    }
}

impl Desk {
    /// Takes what is offered, until it is to stop.
    fn work(&self) {
        let mut since_ns = now_ns();
        let mut looks = 0;
        while !self.stop.load(Ordering::Acquire) {
            if self.take(TAKEN) {
                let work = AssertUnwindSafe(|| self.do_it());
                let ended = catch_unwind(work).map_or(PANICKED, |()| DONE);
                self.state.store(ended, Ordering::Release);
                (since_ns, looks) = (now_ns(), 0);
                continue;
            }
            looks += 1;
            let tired = looks % LOOKS == 0 && now_ns() - since_ns > LOOKS_OUT_NS;
            if tired || !self.awake.load(Ordering::Acquire) {
                std::thread::park();
                (since_ns, looks) = (now_ns(), 0);
            }
            spin_loop();
        }
    }

    /// Takes what is offered: true if no one else did. `to`: [`TAKEN`] by the worker, [`NONE`] by the tick thread.
    fn take(&self, to: u8) -> bool {
        let state = &self.state;
        state.load(Ordering::Relaxed) == OFFERED
            && (state.compare_exchange(OFFERED, to, Ordering::AcqRel, Ordering::Relaxed)).is_ok()
    }

    /// Does what the caller has taken.
    #[allow(unsafe_code)]
    fn do_it(&self) {
        if let Some(work) = self.work.get() {
            // SAFETY: the pointer was made of a `&mut` that `Threads::run` holds until no desk is TAKEN, and only the
            // one who took it from OFFERED comes here.
            unsafe { (*work)() }
        }
    }
}

/// Waits, also when the tick's own piece panics, until no worker uses what was lent to it.
struct Lent<'a>(&'a [(Arc<Desk>, JoinHandle<()>)]);

impl Lent<'_> {
    /// Does what no one has begun, waits for the rest; true if any of it panicked.
    fn end(&self, mut own: impl FnMut(&Desk)) -> bool {
        let mut panicked = false;
        for (desk, _) in self.0 {
            if desk.take(NONE) {
                own(desk);
            }
        }
        for (desk, _) in self.0 {
            while matches!(desk.state.load(Ordering::Acquire), OFFERED | TAKEN) {
                spin_loop();
            }
            panicked |= desk.state.swap(NONE, Ordering::AcqRel) == PANICKED;
            desk.work.set(None);
        }
        panicked
    }
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        self.end(|_| {});
    }
}

impl Executor for Threads {
    fn width(&self) -> usize {
        self.workers.len() + 1
    }

    fn wake(&mut self, count: usize) {
        for (desk, thread) in self.workers.iter().take(count.saturating_sub(1)) {
            desk.awake.store(true, Ordering::Release);
            thread.thread().unpark();
        }
    }

    fn rest(&mut self) {
        for (desk, _) in &self.workers {
            desk.awake.store(false, Ordering::Release);
        }
    }

    #[allow(unsafe_code)]
    fn run(&mut self, work: &mut [&mut (dyn FnMut() + Send)]) {
        let Some((own, others)) = work.split_first_mut() else {
            return;
        };
        let (offered, left) = others.split_at_mut(others.len().min(self.workers.len()));
        for ((desk, _), work) in self.workers.iter().zip(offered.iter_mut()) {
            debug_assert_eq!(desk.state.load(Ordering::Relaxed), NONE, "nothing is lent");
            let work: *mut (dyn FnMut() + Send + '_) = &mut **work;
            // SAFETY: only the lifetime changes; `lent` waits for the worker before `work` can end.
            let work = unsafe { std::mem::transmute::<*mut (dyn FnMut() + Send + '_), Work>(work) };
            desk.work.set(Some(work));
            desk.state.store(OFFERED, Ordering::Release);
        }
        let lent = Lent(&self.workers[..offered.len()]);
        own();
        left.iter_mut().for_each(|work| work());
        assert!(
            !lent.end(Desk::do_it),
            "a body's step panicked on its thread"
        );
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        for (desk, thread) in self.workers.drain(..) {
            desk.stop.store(true, Ordering::Release);
            thread.thread().unpark();
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces of work that count how often they ran.
    fn run_all(threads: &mut Threads, counts: &mut [u32]) {
        let mut works: Vec<_> = (counts.iter_mut()).map(|count| || *count += 1).collect();
        let mut works: Vec<_> = works
            .iter_mut()
            .map(|work| work as &mut (dyn FnMut() + Send))
            .collect();
        threads.run(&mut works);
    }

    #[test]
    fn each_piece_is_done_once_whether_workers_are_awake_or_not() {
        let Some(mut threads) = Threads::start(4, false).unwrap() else {
            return;
        };
        for round in 1..=2_000 {
            let mut counts = [0; 6];
            if round % 3 > 0 {
                threads.wake(round % 7);
            }
            for _ in 0..3 {
                run_all(&mut threads, &mut counts);
            }
            if round % 5 > 0 {
                threads.rest();
            }
            assert_eq!(counts, [3; 6], "round {round}");
        }
    }

    #[test]
    fn a_panic_of_any_piece_comes_back_after_all_are_done() {
        for bad in 0..3 {
            let Some(mut threads) = Threads::start(3, false).unwrap() else {
                return;
            };
            threads.wake(3);
            let done = AtomicU8::new(0);
            let panicked = catch_unwind(AssertUnwindSafe(|| {
                let piece = |k: usize| {
                    let done = &done;
                    move || {
                        assert!(k != bad, "the piece that fails");
                        done.fetch_add(1, Ordering::Relaxed);
                    }
                };
                let (mut a, mut b, mut c) = (piece(0), piece(1), piece(2));
                threads.run(&mut [&mut a, &mut b, &mut c]);
            }));
            assert!(panicked.is_err());
            assert!(done.load(Ordering::Relaxed) >= 1);
            // It goes on.
            let mut counts = [0; 3];
            run_all(&mut threads, &mut counts);
            assert_eq!(counts, [1; 3]);
        }
    }
}
