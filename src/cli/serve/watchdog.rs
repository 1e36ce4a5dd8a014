//! Ends a session by the clock or for want of clients, and says for whom a lockstep waits.

use super::Common;
use palpate_drive::ports::LoopCounters;
use palpate_proto::keys::Keys;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::Clock;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use zenoh::Wait as _;

/// How often is looked.
const PERIOD: Duration = Duration::from_millis(100);

/// How often the clients are asked for, in periods.
const ASK_EVERY: u32 = 10;

/// A lockstep without a holder for each tool says so after this long.
const QUIET: Duration = Duration::from_secs(5);

/// Says whether someone has begun to use a daemon that waits in a fleet.
pub type InUse = Box<dyn Fn() -> bool + Send>;

/// Starts the thread if there is something to watch.
///
/// # Errors
/// The thread does not start.
pub fn start(
    scene: &Scene,
    common: &Common,
    session: zenoh::Session,
    counters: Arc<LoopCounters>,
    in_use: Option<InUse>,
) -> anyhow::Result<()> {
    let lockstep = scene.clock == Clock::Lockstep;
    let ends = common.duration.filter(|_| !lockstep);
    if ends.is_none() && common.idle_timeout.is_none() && !lockstep {
        return Ok(());
    }
    let keys = Keys::new(&common.instance)?;
    let tools = (0..scene.tool_count())
        .map(|t| scene.tool_id(t).to_owned())
        .collect();
    let watchdog = Watchdog {
        keys,
        tools,
        lockstep,
        ends,
        idle: common.idle_timeout,
        counters,
        in_use,
    };
    std::thread::Builder::new()
        .name("palpate-watchdog".into())
        .spawn(move || watchdog.run(&session))?;
    Ok(())
}

struct Watchdog {
    keys: Keys,
    tools: Vec<String>,
    lockstep: bool,
    ends: Option<Duration>,
    idle: Option<Duration>,
    counters: Arc<LoopCounters>,
    in_use: Option<InUse>,
}

impl Watchdog {
    fn run(mut self, session: &zenoh::Session) {
        let begun = Instant::now();
        let mut held = begun;
        for round in 1_u32.. {
            let left = self
                .ends
                .map_or(PERIOD, |ends| ends.saturating_sub(begun.elapsed()));
            std::thread::sleep(left.min(PERIOD));
            if self.counters.finished.load(Ordering::Acquire) {
                return;
            }
            if self.ends.is_some_and(|ends| begun.elapsed() >= ends) {
                self.counters.stop.store(true, Ordering::Release);
                return;
            }
            let asks = self.idle.is_some() || self.lockstep;
            if !asks || round % ASK_EVERY != 0 {
                continue;
            }
            let holders = self.holders(session);
            let waits = self.in_use.as_ref().is_some_and(|in_use| !in_use());
            if !holders.is_empty() || waits {
                held = Instant::now();
            }
            if let Some(idle) = self.idle.filter(|idle| held.elapsed() >= *idle) {
                tracing::info!("nobody has held a tool for {idle:?}: ending");
                self.counters.stop.store(true, Ordering::Release);
                return;
            }
            if self.lockstep && begun.elapsed() >= QUIET {
                let free: Vec<&str> = self
                    .tools
                    .iter()
                    .filter(|tool| !holders.contains(tool))
                    .map(String::as_str)
                    .collect();
                if !free.is_empty() {
                    let free = free.join(", ");
                    tracing::warn!(
                        "in lockstep a tick waits for a pose of every tool; nobody holds {free}"
                    );
                }
                self.lockstep = false;
            }
        }
    }

    /// Tools that a client holds.
    fn holders(&self, session: &zenoh::Session) -> Vec<String> {
        let replies = session
            .liveliness()
            .get(self.keys.live_tool("*"))
            .timeout(PERIOD)
            .wait();
        let mut tools = Vec::new();
        if let Ok(replies) = replies {
            while let Ok(reply) = replies.recv() {
                if let Ok(sample) = reply.result() {
                    let tool = self.keys.tool_of_live(sample.key_expr().as_str());
                    tools.extend(tool.map(str::to_owned));
                }
            }
        }
        tools
    }
}
