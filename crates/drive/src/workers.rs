//! Threads on which bodies step that take longer than a tick.
//!
//! ```text
//! tick t       start ──▶ job (state, forces) ──▶ worker: advance, predict
//! tick t + k   finish ◀── the same job ◀──────────┘   (waits if it is late: the bits do not depend on when it comes)
//! or before    is_ready? ── no ──▶ the loop in real time puts the step off by a tick, and records that
//! ```
//! Jobs go round between two rings, so nothing is allocated and nothing locked.

use super::maker::Maker;
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::body::{DeformableScratch, DeformableState, Field, Made};
use palpate_sim::scene::Scene;
use palpate_sim::tick::Pipeline;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// A body's step.
#[derive(Debug)]
struct BodyStep {
    state: DeformableState,
    scratch: DeformableScratch,
}

/// A worker for each body that steps once in several ticks, and one that makes matrices for those that are strained.
#[derive(Debug)]
pub struct Workers {
    /// By body.
    workers: Vec<Option<Worker>>,
    maker: Option<Maker>,
}

/// Two threads for one body: after a reset the next step begins on the other one, so that nothing
/// waits for the step that no one wants any more.
#[derive(Debug)]
struct Worker {
    scene: Arc<Scene>,
    body: usize,
    lanes: [Lane; 2],
    current: usize,
}

/// A thread and its job.
#[derive(Debug)]
struct Lane {
    /// Here between steps.
    idle: Option<Box<BodyStep>>,
    /// No one wants the step that is under way.
    forgotten: bool,
    out: rtrb::Producer<Box<BodyStep>>,
    back: rtrb::Consumer<Box<BodyStep>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Workers {
    /// Threads for the bodies that need one; `None` if none does.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn start(scene: &Arc<Scene>) -> std::io::Result<Option<Self>> {
        let start = |body| {
            scene
                .steps_apart(body)
                .then(|| Worker::start(scene, body))
                .transpose()
        };
        let workers = (0..scene.body_count())
            .map(start)
            .collect::<Result<Vec<_>, _>>()?;
        let maker = Maker::start(scene)?;
        let any = maker.is_some() || workers.iter().any(Option::is_some);
        Ok(any.then_some(Self { workers, maker }))
    }
}

impl Worker {
    fn start(scene: &Arc<Scene>, body: usize) -> std::io::Result<Self> {
        Ok(Self {
            scene: scene.clone(),
            body,
            lanes: [Lane::start(scene, body)?, Lane::start(scene, body)?],
            current: 0,
        })
    }

    fn lane(&mut self) -> &mut Lane {
        &mut self.lanes[self.current]
    }
}

impl Lane {
    fn start(scene: &Arc<Scene>, body: usize) -> std::io::Result<Self> {
        let (out, mut jobs) = rtrb::RingBuffer::<Box<BodyStep>>::new(1);
        let (mut done, back) = rtrb::RingBuffer::<Box<BodyStep>>::new(1);
        let stop = Arc::new(AtomicBool::new(false));
        let (theirs, asked) = (scene.clone(), stop.clone());
        let run = move || {
            let Some(model) = theirs.deformable(body) else {
                return;
            };
            while !asked.load(Ordering::Acquire) {
                let Ok(mut job) = jobs.pop() else {
                    std::thread::park_timeout(Duration::from_millis(50));
                    continue;
                };
                let BodyStep { state, scratch } = &mut *job;
                model.renew(state, scratch);
                model.advance(state, scratch);
                model.predict(state, scratch);
                let _ = done.push(job);
            }
        };
        let thread = std::thread::Builder::new()
            .name(format!("body {}", scene.body_id(body)))
            .spawn(run)?;
        let idle = scene.deformable(body).map(|model| {
            Box::new(BodyStep {
                state: model.rest_state(),
                scratch: model.scratch(),
            })
        });
        Ok(Self {
            idle,
            forgotten: false,
            out,
            back,
            stop,
            thread: Some(thread),
        })
    }

    /// The job is here; fetches it if the thread is done with it.
    fn is_idle(&mut self) -> bool {
        if self.idle.is_none() {
            self.idle = self.back.pop().ok();
        }
        self.idle.is_some()
    }

    /// [`Lane::wait`] would not wait.
    fn is_ready(&self) -> bool {
        self.idle.is_some()
            || !self.back.is_empty()
            || self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits for the job that is out, if one is.
    fn wait(&mut self) -> Option<&mut Box<BodyStep>> {
        if self.idle.is_some() {
            return None;
        }
        loop {
            if let Ok(job) = self.back.pop() {
                return Some(self.idle.insert(job));
            }
            // A worker that died leaves the step to the tick.
            if self.thread.as_ref().is_none_or(JoinHandle::is_finished) {
                return None;
            }
            std::thread::yield_now();
        }
    }
}

impl Pipeline for Workers {
    fn start(
        &mut self,
        body: usize,
        field: Field,
        state: &DeformableState,
        predicted: &[Point3],
        loads: &[Vector3],
    ) {
        let Some(worker) = &mut self.workers[body] else {
            return;
        };
        let Worker {
            scene,
            body,
            lanes,
            current,
        } = worker;
        let Some(model) = scene.deformable(*body) else {
            return;
        };
        let lane = &mut lanes[*current];
        lane.wait();
        lane.forgotten = false;
        let Some(mut job) = lane.idle.take() else {
            return;
        };
        job.state.clone_from(state);
        job.scratch.predicted.copy_from_slice(predicted);
        model.set_field(&mut job.scratch, field);
        model.give_loads(&mut job.scratch, loads);
        if let Err(rtrb::PushError::Full(job)) = lane.out.push(job) {
            lane.idle = Some(job);
            return;
        }
        if let Some(thread) = &lane.thread {
            thread.thread().unpark();
        }
    }

    fn is_ready(&mut self, body: usize) -> bool {
        let worker = self.workers[body].as_mut();
        worker.is_none_or(|worker| worker.lane().is_ready())
    }

    fn finish(
        &mut self,
        body: usize,
        state: &mut DeformableState,
        predicted: &mut [Point3],
    ) -> bool {
        let worker = self.workers[body].as_mut();
        let wanted = worker.map(Worker::lane).filter(|lane| !lane.forgotten);
        let Some(job) = wanted.and_then(Lane::wait) else {
            return false;
        };
        state.clone_from(&job.state);
        predicted.copy_from_slice(&job.scratch.predicted);
        true
    }

    fn make(&mut self, body: usize, state: &DeformableState) {
        if let Some(maker) = &mut self.maker {
            maker.make(body, state);
        }
    }

    fn is_made(&mut self, body: usize) -> bool {
        (self.maker.as_mut()).is_none_or(|maker| maker.is_ready(body))
    }

    fn made(&mut self, body: usize, old: Option<Made>) -> Option<Made> {
        self.maker.as_mut()?.made(body, old)
    }

    fn cancel(&mut self) {
        if let Some(maker) = &mut self.maker {
            maker.wanted.fill(false);
        }
        for worker in self.workers.iter_mut().flatten() {
            if !worker.lane().is_idle() {
                worker.lane().forgotten = true;
                worker.current = 1 - worker.current;
                // Here a step is only if the one before was forgotten a moment ago as well: it is in
                // no one's way until the next begins.
                let busy = !worker.lane().is_idle();
                worker.lane().forgotten = busy;
            }
        }
    }
}

impl Drop for Lane {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            let _ = thread.join();
        }
    }
}
