//! How long ticks take here, and which rate that allows.

use palpate_client::device::Motion;
use palpate_drive::pacer::{now_ns, sleep_until};
use palpate_drive::threads::Threads;
use palpate_drive::workers::Workers;
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::{TickOutput, TickRecord};
use palpate_sim::tick::{deform, hash, render};
use palpate_wire as wire;
use serde::Serialize;
use std::sync::Arc;

/// Rates that are considered, Hz, the highest first.
pub(super) const RATES_HZ: [u32; 6] = [4_000, 2_000, 1_000, 500, 250, 125];
/// Part of the ticks that must end in time.
const IN_TIME: f64 = 0.999;
/// Ticks before any counts: caches and branch predictors are cold.
const WARM_TICKS: u64 = 100;
/// How long the script of a press is, s.
const PRESS_S: f64 = 4.0;
/// How far a press goes in, m.
const DEPTH_M: f64 = 0.004;

/// Quantiles of durations, µs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct RateFigures {
    pub p50_us: f64,
    pub p99_us: f64,
    pub p999_us: f64,
    pub max_us: f64,
}

impl RateFigures {
    /// Of durations in ascending order, ns.
    pub(super) fn of(sorted_ns: &[u64]) -> Self {
        let at = |share: f64| {
            let rank =
                ((share * sorted_ns.len() as f64).ceil() as usize).clamp(1, sorted_ns.len().max(1));
            sorted_ns.get(rank - 1).map_or(0.0, |&ns| ns as f64 * 1e-3)
        };
        Self {
            p50_us: at(0.5),
            p99_us: at(0.99),
            p999_us: at(0.999),
            max_us: at(1.0),
        }
    }
}

/// What a scene's ticks took.
#[derive(Serialize)]
pub(super) struct SceneRate {
    pub scene: String,
    /// Rate for which it is written, Hz.
    pub scene_hz: f64,
    pub ticks: u64,
    pub contact_ticks: u64,
    pub tick: RateFigures,
    /// From the poses to the forces.
    pub force: RateFigures,
    /// Highest of [`RATES_HZ`] that the machine holds.
    pub holds_hz: Option<f64>,
}

/// A scene and hands that press it.
pub(super) struct Pressing {
    scene: Arc<Scene>,
    /// By tool; tools that have nothing to press stay where they are.
    motions: Vec<Option<Motion>>,
}

impl Pressing {
    pub(super) fn new(loaded: &file::Loaded) -> anyhow::Result<Self> {
        let scene = Arc::new(loaded.build_to_run()?);
        let nets = wire::all_nets(&scene, &scene.initial_state());
        let snapshot = wire::scene_snapshot(&scene, loaded.sha256, &nets, &TickOutput::default());
        let motion = |tool| Motion::named("press", &snapshot, scene.tool_id(tool), DEPTH_M).ok();
        let motions = (0..scene.tool_count()).map(motion).collect();
        Ok(Self { scene, motions })
    }

    pub(super) fn period_s(&self) -> f64 {
        self.scene.dt_s
    }

    /// Runs the ticks at the scene's own rate, as the loop does: between ticks the thread sleeps
    /// and caches cool.
    pub(super) fn run(self, ticks: u64, sorted_lateness_ns: &[u64]) -> SceneRate {
        let Self { scene, motions } = self;
        let period_ns = (scene.dt_s * 1e9).round() as u64;
        let mut state = scene.initial_state();
        let mut scratch = scene.scratch(&state);
        if let Ok(Some(workers)) = Workers::start(&scene) {
            scratch.set_pipeline(Box::new(workers));
        }
        if let Ok(Some(threads)) = Threads::start(usize::MAX, true) {
            scratch.set_executor(&scene, Some(Box::new(threads)));
        }
        let mut took_ns = Vec::with_capacity(ticks as usize);
        let mut force_ns = Vec::with_capacity(ticks as usize);
        let (mut contact_ticks, mut due, mut took) = (0, now_ns(), 0);
        // All ticks together are one press, however few they are.
        let pace_s = PRESS_S / ticks.max(1) as f64;
        let TickRecord {
            mut input,
            mut output,
            ..
        } = TickRecord::for_tools(scene.tool_count());
        for k in 0..WARM_TICKS + ticks {
            let t = k.saturating_sub(WARM_TICKS) as f64 * pace_s;
            for (tool, motion) in motions.iter().enumerate() {
                input.poses[tool] = motion
                    .as_ref()
                    .map(|motion| pose(motion, k + 1, t, pace_s, scene.dt_s));
            }
            // Ticks that fill their period leave the others a tenth of their time: Linux stops a
            // real-time thread that takes more than 95 % of a second for the rest of it.
            due = (due + period_ns).max(now_ns() + took / 9);
            sleep_until(due);
            let start = now_ns();
            render(&scene, &mut state, &mut scratch, &input, &mut output);
            let felt = now_ns() - start;
            deform(&scene, &mut state, &mut scratch, &mut output);
            hash(&state, &mut output);
            took = now_ns() - start;
            if k >= WARM_TICKS {
                force_ns.push(felt);
                took_ns.push(took);
                contact_ticks += u64::from(!output.contacts.list().is_empty());
            }
        }
        took_ns.sort_unstable();
        force_ns.sort_unstable();
        let holds = |hz: &u32| {
            share_in_time(&took_ns, sorted_lateness_ns, 1_000_000_000 / u64::from(*hz)) >= IN_TIME
        };
        SceneRate {
            scene: scene.name.clone(),
            scene_hz: 1.0 / scene.dt_s,
            ticks,
            contact_ticks,
            tick: RateFigures::of(&took_ns),
            force: RateFigures::of(&force_ns),
            holds_hz: RATES_HZ.into_iter().find(holds).map(f64::from),
        }
    }
}

/// Where the hand is at time `t` of its script, of which a tick is `pace_s`.
fn pose(motion: &Motion, seq: u64, t: f64, pace_s: f64, dt_s: f64) -> DevicePose {
    let place = motion.goal(t);
    let before = motion.goal((t - pace_s).max(0.0));
    DevicePose {
        seq,
        t_client_ns: 0,
        position: Point3::from(place.position),
        orientation: palpate_geometry::math::Rotation::identity(),
        linear_velocity: (Vector3::from(place.position) - Vector3::from(before.position)) / dt_s,
        angular_velocity: Vector3::zeros(),
        buttons: motion.buttons(t),
    }
}

/// How late a sleeping thread is woken at 1 kHz, ns, in ascending order.
pub(super) fn lateness_ns(ticks: u64) -> Vec<u64> {
    let mut late_ns = Vec::with_capacity(ticks as usize);
    let mut due = now_ns();
    for _ in 0..ticks {
        due += 1_000_000;
        sleep_until(due);
        let now = now_ns();
        late_ns.push(now.saturating_sub(due));
        due = due.max(now.saturating_sub(1_000_000));
    }
    late_ns.sort_unstable();
    late_ns
}

/// Share of ticks that end before the next is due, when any may begin as late as any wake-up was:
/// of all pairs of a tick and a lateness, those whose sum is below the period. Both lists in
/// ascending order; without ticks, 0.
fn share_in_time(took_ns: &[u64], late_ns: &[u64], period_ns: u64) -> f64 {
    let in_time = |took: &u64| {
        let left = period_ns.saturating_sub(*took);
        late_ns.partition_point(|&late| late < left) as f64
    };
    let pairs = took_ns.len() as f64 * late_ns.len() as f64;
    if pairs > 0.0 {
        took_ns.iter().map(in_time).sum::<f64>() / pairs
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn the_share_in_time_is_that_of_all_pairs() {
        let mut state = 3u64;
        let mut random = |most: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % most
        };
        let mut list = |len: usize, most: u64| {
            let mut values: Vec<u64> = (0..len).map(|_| random(most)).collect();
            values.sort_unstable();
            values
        };
        for (most_took, most_late) in [(1_000, 1_000), (2_500, 10), (10, 2_500)] {
            let (took, late) = (list(300, most_took), list(200, most_late));
            for period in [1, 500, 1_000, 2_000, 5_000] {
                let in_time = took
                    .iter()
                    .flat_map(|t| late.iter().map(move |l| t + l))
                    .filter(|sum| *sum < period);
                let expected = in_time.count() as f64 / 60_000.0;
                assert_eq!(
                    share_in_time(&took, &late, period),
                    expected,
                    "{most_took} {most_late} {period}"
                );
            }
        }
        assert_eq!(share_in_time(&[], &[1], 100), 0.0);
    }

    #[test]
    fn figures_are_ranks_of_the_sorted_list() {
        let ns: Vec<u64> = (1..=1_000).map(|k| k * 1_000).collect();
        assert_eq!(
            RateFigures::of(&ns),
            RateFigures {
                p50_us: 500.0,
                p99_us: 990.0,
                p999_us: 999.0,
                max_us: 1_000.0
            }
        );
        assert_eq!(
            RateFigures::of(&[7_000]),
            RateFigures {
                p50_us: 7.0,
                p99_us: 7.0,
                p999_us: 7.0,
                max_us: 7.0
            }
        );
        assert_eq!(RateFigures::of(&[]).max_us, 0.0);
    }

    // The script reaches the bodies: a rate without contact would be a rate of nothing.
    #[test]
    fn the_hands_press_the_built_in_scene() {
        let (name, text) = super::super::SCENES[0];
        let loaded = file::parse(text, name, Path::new(".")).unwrap();
        let pressing = Pressing::new(&loaded).unwrap();
        assert!(pressing.motions.iter().all(Option::is_some));
        let rate = pressing.run(500, &[0]);
        assert!(
            rate.contact_ticks > 100 && rate.ticks == 500,
            "{} in contact",
            rate.contact_ticks
        );
    }
}
