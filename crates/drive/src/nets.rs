//! Control nets on their way out of the tick thread: the bus and the journal take them at rates of
//! their own, from one pool. A body's net is copied at most once a tick, whoever asks for it.

use super::pool::Pool;
use palpate_geometry::math::Point3;
use palpate_sim::scene::Scene;
use palpate_sim::tick::{SceneState, quality};
use std::sync::Arc;

/// The net of a body after a tick.
#[derive(Clone, Debug, PartialEq)]
pub struct NetFrame {
    /// Tick after which it stood so.
    pub tick: u64,
    /// Revision of the net.
    pub revision: u64,
    /// Body index.
    pub body: usize,
    /// Control points, u-major, m.
    pub points: Vec<Point3>,
    /// Coordinates of a deforming body, m, of which its nodes are made; none of others.
    pub coordinates: Vec<Point3>,
}

/// The nets of a scene's bodies. Bodies that cannot move have no frames.
#[derive(Debug)]
pub struct NetPool {
    /// By body.
    bodies: Vec<Frames>,
}

#[derive(Debug)]
struct Frames {
    pool: Pool<NetFrame>,
    /// The net of the present tick, if someone asked for it.
    filled: Option<Arc<NetFrame>>,
}

impl NetPool {
    /// Frames for `in_use` readers' frames a body at once, and one to fill.
    pub fn new(scene: &Scene, in_use: usize) -> Self {
        let frames = |body: usize| {
            let points = scene.skin(body).points();
            // One more is the pool's own: that of the present tick.
            let count = if scene.moves(body) { in_use + 2 } else { 0 };
            let make = || NetFrame {
                tick: 0,
                revision: 0,
                body,
                points: points.to_vec(),
                coordinates: (scene.deformable(body))
                    .map_or_else(Vec::new, |deformable| deformable.rest().to_vec()),
            };
            Frames {
                pool: Pool::new(count, make),
                filled: None,
            }
        };
        Self {
            bodies: (0..scene.body_count()).map(frames).collect(),
        }
    }

    /// Begins the next tick: nets are copied anew.
    pub fn begin(&mut self) {
        self.bodies.iter_mut().for_each(|body| body.filled = None);
    }

    /// The net of a body after tick `tick`; `None` for a body that cannot move, or while readers
    /// hold all frames.
    pub fn frame(
        &mut self,
        scene: &Scene,
        state: &SceneState,
        body: usize,
        tick: u64,
    ) -> Option<Arc<NetFrame>> {
        let Frames { pool, filled } = &mut self.bodies[body];
        if filled.is_none() {
            let fill = |frame: &mut NetFrame| {
                (frame.tick, frame.revision) = (tick, state.net_revision(body));
                state.copy_net(scene, body, &mut frame.points);
                if let Some(coordinates) = state.coordinates(body) {
                    frame.coordinates.copy_from_slice(coordinates);
                }
            };
            *filled = pool.fill(fill).cloned();
        }
        let frame = filled.clone()?;
        debug_assert_eq!(
            (frame.tick, frame.revision),
            (tick, state.net_revision(body)),
            "NetPool::begin was not called before this tick"
        );
        Some(frame)
    }
}

/// When a reader gets nets: changed ones, at most once in so many ticks.
#[derive(Clone, Debug)]
pub struct NetSchedule {
    every: u64,
    /// By body: revision and tick of the last net handed over; revision `u64::MAX` when the next is
    /// due whatever was handed over before.
    sent: Vec<(u64, u64)>,
}

impl NetSchedule {
    /// For a scene, at most `rate_hz` nets a second (at a low quality a tenth of that).
    pub fn new(scene: &Scene, rate_hz: f64) -> Self {
        Self {
            every: ((1.0 / scene.dt_s / rate_hz).round() as u64).max(1),
            sent: vec![(0, 0); scene.body_count()],
        }
    }

    /// The net of a body is to be handed over after this tick.
    pub fn is_due(&self, state: &SceneState, body: usize, tick: u64) -> bool {
        let rarer = if state.quality < quality::RARE_NETS {
            1
        } else {
            10
        };
        let (revision, at) = self.sent[body];
        state.net_revision(body) != revision
            && (revision == u64::MAX || tick >= at + self.every * rarer)
    }

    /// It was.
    pub fn sent(&mut self, frame: &NetFrame) {
        self.sent[frame.body] = (frame.revision, frame.tick);
    }

    /// Every net is due next.
    pub fn restart(&mut self) {
        self.sent.fill((u64::MAX, 0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_sim::scene::file;
    use std::path::Path;

    #[test]
    fn both_readers_get_the_same_frame_at_rates_of_their_own() {
        let text = "[[body]]\nid = \"soft\"\nsurface = { builtin = \"sheet\", size = 0.1 }\nmodel = \"membrane\"\n\
                    lattice = { thickness_m = 2e-3 }\nfixed = [{ point = [-0.049, 0, 0], normal = [1, 0, 0] }]\n\
                    [[body]]\nid = \"hard\"\nsurface = { builtin = \"sphere\", size = 0.02 }\npose = { position = [0.5, 0, 0] }\n";
        let loaded = file::parse(text, "nets.toml", Path::new(".")).unwrap();
        let scene = Scene::build(&loaded.spec, Path::new(".")).unwrap();
        let mut state = scene.initial_state();
        let mut nets = NetPool::new(&scene, 2);
        let (mut often, mut rarely) = (
            NetSchedule::new(&scene, 500.0),
            NetSchedule::new(&scene, 100.0),
        );
        let (mut got, mut shared) = ([0, 0], 0);
        for tick in 1..=1_000 {
            nets.begin();
            state.bodies[0].revision = tick;
            let mut of_tick = Vec::new();
            for (k, schedule) in [&mut often, &mut rarely].into_iter().enumerate() {
                assert!(
                    nets.frame(&scene, &state, 1, tick).is_none(),
                    "it cannot move"
                );
                if schedule.is_due(&state, 0, tick) {
                    let frame = nets.frame(&scene, &state, 0, tick).unwrap();
                    assert_eq!((frame.tick, frame.revision), (tick, tick));
                    schedule.sent(&frame);
                    got[k] += 1;
                    of_tick.push(frame);
                }
            }
            if let [a, b] = &of_tick[..] {
                assert!(Arc::ptr_eq(a, b));
                shared += 1;
            }
        }
        assert_eq!((got, shared), ([500, 100], 100));
        state.quality = quality::RARE_NETS;
        assert!(!often.is_due(&state, 0, 1_010));
        often.restart();
        assert!(often.is_due(&state, 0, 1_010));
    }
}
