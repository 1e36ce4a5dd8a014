//! What must hold at every tick, and of every recording.

use super::host::{Ended, Session};
use palpate_geometry::math::Point3;
use palpate_record::{ReplayOptions, SessionHash, recover, replay_with};
use palpate_sim::haptics::DeviceBounds;
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;
use palpate_sim::tick::record::TickRecord;

/// A kill loses no more than this, ticks of 1 ms, whatever syncs take: a flush is due every 100 ms,
/// and is looked for every 5. What is promised, for threads that are not woken in time, is 250.
const LOST_TICKS: u64 = 120;
/// No point of a body is farther from where the scene is at rest than this many times its size.
const SIZES: f64 = 3.0;
/// Points are looked at every so many ticks.
const POINTS_EVERY: u64 = 16;

/// Looks at ticks.
pub(super) struct LoopCheck {
    /// Of the scene, N.
    scene_max_n: f64,
    /// Of the device, N.
    device_max_n: f64,
    /// What the force may be, N: to a lower limit it goes by the ramp of the scene, not in a step.
    limit_n: f64,
    /// Change of it a tick, N.
    ramp_n: f64,
    /// From here on, without a new pose, the force is zero, ticks.
    silent_ticks: u64,
    since_news: u64,
    centre: Point3,
    size_m: f64,
    points: Vec<Point3>,
}

impl LoopCheck {
    pub fn new(scene: &Scene) -> Self {
        let device = &scene.spec.tools[0].device;
        let ticks = |seconds: f64| (seconds / scene.dt_s).ceil() as u64;
        let all = (0..scene.body_count()).flat_map(|body| scene.skin(body).points());
        let (mut low, mut high) = (
            all.clone().next().copied().unwrap_or_default(),
            Point3::origin(),
        );
        high.clone_from(&low);
        for point in all {
            low = low.inf(point);
            high = high.sup(point);
        }
        Self {
            scene_max_n: device.force_max_n,
            device_max_n: f64::INFINITY,
            limit_n: device.force_max_n,
            ramp_n: match device.ramp_s > 0.0 {
                true => device.force_max_n * scene.dt_s / device.ramp_s,
                false => device.force_max_n,
            },
            // And a tick each for the pose that was on its way and for rounding of the ramp.
            silent_ticks: ticks(device.stale_s) + ticks(device.ramp_s) + 2,
            since_news: u64::MAX,
            centre: nalgebra::center(&low, &high),
            size_m: (high - low).norm(),
            points: Vec::new(),
        }
    }

    /// A device described itself; it counts from the next tick.
    pub fn bounds(&mut self, bounds: DeviceBounds) {
        self.device_max_n = bounds.force_max_n;
    }

    pub fn tick(
        &mut self,
        scene: &Scene,
        state: &SceneState,
        record: &TickRecord,
    ) -> Result<(), String> {
        let output = &record.output;
        let out = &output.tools[0];
        if let Some(fault) = output.fault {
            return Err(format!("tick {}: fault {fault:?}", output.tick));
        }
        let goal_n = self.scene_max_n.min(self.device_max_n);
        self.limit_n = (self.limit_n - self.ramp_n).max(goal_n);
        let most_n = self.limit_n;
        let force_n = out.force_n.norm();
        if force_n.is_nan() || force_n > most_n * (1.0 + 1e-12) {
            return Err(format!(
                "tick {}: {force_n} N, the limit is {most_n} N",
                output.tick
            ));
        }
        self.since_news = match record.input.poses[0] {
            Some(_) => 0,
            None => (self.since_news.saturating_add(1)).saturating_add(record.input.skipped.into()),
        };
        if self.since_news > self.silent_ticks && force_n > 0.0 {
            return Err(format!(
                "tick {}: {force_n} N, {} ticks after the last pose",
                output.tick, self.since_news
            ));
        }
        if output.tick.is_multiple_of(POINTS_EVERY) {
            self.points(scene, state)?;
        }
        Ok(())
    }

    fn points(&mut self, scene: &Scene, state: &SceneState) -> Result<(), String> {
        for body in 0..scene.body_count() {
            let rest = scene.skin(body).points();
            self.points.clear();
            self.points.extend_from_slice(rest);
            state.copy_net(scene, body, &mut self.points);
            let far = |point: &&Point3| {
                let distance = (**point - self.centre).norm();
                distance.is_nan() || distance > SIZES * self.size_m
            };
            if let Some(point) = self.points.iter().find(far) {
                return Err(format!("a point of body {body} is at {point:?}"));
            }
        }
        Ok(())
    }
}

/// Recovers and replays what a daemon left; ticks that it holds.
pub(super) fn session(session: &Session) -> Result<u64, String> {
    let name = session.file.display();
    let part = palpate_record::part_of(&session.file);
    let ran = session.hashes.len() as u64;
    // What must be there: all, or what a flush before the end or the refusal has handed over.
    let (until, behind) = match (session.ended, session.disk_refused) {
        (_, Some(refused)) => (refused, 0),
        (Ended::Cleanly, None) => (ran, 0),
        (Ended::Killed { behind }, None) => (ran, behind),
    };
    let whole = session.ended == Ended::Cleanly && session.disk_refused.is_none();
    let least = match whole {
        true => ran,
        false => until.saturating_sub(LOST_TICKS + behind),
    };
    if session.unconfirmed == session.file.exists() && session.ended == Ended::Cleanly && whole {
        return Err(format!("{name}: it has its name before the disk has it"));
    }
    let path = match session.file.exists() {
        true => session.file.clone(),
        false => {
            let target = session.file.with_extension("recovered.mcap");
            match recover(&part, &target) {
                Ok(_) => target,
                // Nothing was flushed yet, and nothing had to be.
                Err(_) if least == 0 => return Ok(0),
                Err(error) => return Err(format!("{name}: not recovered: {error}")),
            }
        }
    };
    let opened = palpate_record::Session::open(&path);
    let opened = opened.map_err(|error| format!("{name}: {error}"))?;
    let options = ReplayOptions {
        jobs: 1,
        ..ReplayOptions::default()
    };
    let count = opened.tick_count();
    if count < least {
        return Err(format!(
            "{name}: {ran} ticks ran, {} of them lost: {count} recorded, {least} must be ({:?}, disk refused at {:?})",
            ran - count,
            session.ended,
            session.disk_refused
        ));
    }
    if count == 0 {
        return Ok(0);
    }
    let report = replay_with(&opened, &options, |_, _| {}).map_err(|e| format!("{name}: {e}"))?;
    if let Some(difference) = &report.first_difference {
        return Err(format!("{name}: the replay differs: {difference:?}"));
    }
    if report.gaps > 0 || report.ticks_unreached > 0 || whole != report.clean {
        return Err(format!("{name}: {report:?}"));
    }
    // Not only equal to itself: equal to what the loop did.
    let mut expected = SessionHash::default();
    for (tick, hash) in (1..=count).zip(&session.hashes) {
        expected.push(tick, *hash);
    }
    match report.session_hash == format!("{:016x}", expected.0) {
        true => Ok(count),
        false => Err(format!("{name}: what was recorded is not what ran")),
    }
}
