//! The thread on which matrices are made for bodies that are strained too far for theirs.
//!
//! ```text
//! tick t        make ──▶ job (places, pressures) ──▶ the thread: tangent there, factor, blocks of the net
//! tick t + 64   made ◀── the same job ◀──────────────┘   (waits if it is late; in real time the loop puts it off instead)
//! ```
//! Jobs go round between two rings, so the tick allocates nothing and locks nothing; what a matrix replaces is dropped
//! on the thread as well.

use palpate_sim::body::{DeformableState, Made};
use palpate_sim::scene::Scene;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// A matrix to be made, or one that was.
#[derive(Debug)]
struct Job {
    body: usize,
    state: DeformableState,
    made: Option<Made>,
    /// To be dropped.
    old: Option<Made>,
}

/// The thread and its jobs.
#[derive(Debug)]
pub(super) struct Maker {
    /// By body: here while nothing is made for it.
    idle: Vec<Option<Box<Job>>>,
    /// By body: someone still wants what is being made.
    pub(super) wanted: Vec<bool>,
    out: rtrb::Producer<Box<Job>>,
    back: rtrb::Consumer<Box<Job>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Maker {
    /// The thread of a scene; `None` where no body ever asks for a matrix.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub(super) fn start(scene: &Arc<Scene>) -> std::io::Result<Option<Self>> {
        let job = |body| {
            let model = scene
                .deformable(body)
                .filter(|_| scene.makes_matrices(body))?;
            Some(Box::new(Job {
                body,
                state: model.rest_state(),
                made: None,
                old: None,
            }))
        };
        let idle: Vec<_> = (0..scene.body_count()).map(job).collect();
        let count = idle.iter().flatten().count();
        if count == 0 {
            return Ok(None);
        }
        let (out, mut jobs) = rtrb::RingBuffer::<Box<Job>>::new(count);
        let (mut done, back) = rtrb::RingBuffer::<Box<Job>>::new(count);
        let stop = Arc::new(AtomicBool::new(false));
        let (theirs, asked) = (scene.clone(), stop.clone());
        let run = move || {
            while !asked.load(Ordering::Acquire) {
                let Ok(mut job) = jobs.pop() else {
                    std::thread::park_timeout(Duration::from_millis(50));
                    continue;
                };
                job.old = None;
                let model = theirs.deformable(job.body);
                job.made = model.and_then(|model| model.make(&job.state));
                let _ = done.push(job);
            }
        };
        let thread = std::thread::Builder::new()
            .name("matrices".into())
            .spawn(run)?;
        Ok(Some(Self {
            wanted: vec![false; idle.len()],
            idle,
            out,
            back,
            stop,
            thread: Some(thread),
        }))
    }

    pub(super) fn make(&mut self, body: usize, state: &DeformableState) {
        self.fetch();
        // Busy with one that no one wants any more: this one is made in its tick.
        let Some(mut job) = self.idle[body].take() else {
            return;
        };
        job.state.clone_from(state);
        match self.out.push(job) {
            Ok(()) => {
                self.wanted[body] = true;
                if let Some(thread) = &self.thread {
                    thread.thread().unpark();
                }
            }
            Err(rtrb::PushError::Full(job)) => self.idle[body] = Some(job),
        }
    }

    /// [`Maker::made`] would not wait.
    pub(super) fn is_ready(&mut self, body: usize) -> bool {
        self.fetch();
        self.idle[body].is_some() || !self.wanted[body] || self.is_dead()
    }

    /// The matrix that was begun for a body; `old` is what it replaces.
    pub(super) fn made(&mut self, body: usize, old: Option<Made>) -> Option<Made> {
        if !std::mem::take(&mut self.wanted[body]) {
            return None;
        }
        while self.idle[body].is_none() && !self.is_dead() {
            self.fetch();
            std::thread::yield_now();
        }
        self.fetch();
        let job = self.idle[body].as_mut()?;
        job.old = old;
        job.made.take()
    }

    /// Takes back the jobs that are done.
    fn fetch(&mut self) {
        while let Ok(job) = self.back.pop() {
            let body = job.body;
            self.idle[body] = Some(job);
        }
    }

    /// A thread that died leaves matrices to the tick.
    fn is_dead(&self) -> bool {
        self.back.is_empty() && self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for Maker {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            let _ = thread.join();
        }
    }
}
