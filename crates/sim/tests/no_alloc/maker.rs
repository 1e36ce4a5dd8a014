//! Matrices that follow a body are made on another thread; the tick that asks for one and takes it over allocates nothing.

use crate::common::{Laws as _, World, teardrop};
use crate::counting::allocations;
use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::body::{DeformableState, Field, Made};
use palpate_sim::scene::Scene;
use palpate_sim::tick::Pipeline;
use std::sync::{Arc, Condvar, Mutex};

/// What the loop and the thread hand each other.
#[derive(Debug)]
struct Desk {
    state: DeformableState,
    asked: bool,
    made: Option<Made>,
    old: Option<Made>,
    count: usize,
    done: bool,
}

/// A thread that makes matrices of the first body.
#[derive(Debug)]
struct Elsewhere(Arc<(Mutex<Desk>, Condvar)>);

impl Elsewhere {
    fn new(scene: Arc<Scene>) -> Self {
        let state = scene.deformable(0).unwrap().rest_state();
        let desk = Desk {
            state,
            asked: false,
            made: None,
            old: None,
            count: 0,
            done: false,
        };
        let shared = Arc::new((Mutex::new(desk), Condvar::new()));
        let there = shared.clone();
        std::thread::spawn(move || {
            let (desk, bell) = &*there;
            let body = scene.deformable(0).unwrap();
            let mut desk = desk.lock().unwrap();
            while !desk.done {
                if desk.asked {
                    desk.old = None;
                    desk.made = body.make(&desk.state);
                    (desk.asked, desk.count) = (false, desk.count + 1);
                    bell.notify_all();
                }
                desk = bell.wait(desk).unwrap();
            }
        });
        Self(shared)
    }
}

impl Drop for Elsewhere {
    fn drop(&mut self) {
        self.0.0.lock().unwrap().done = true;
        self.0.1.notify_all();
    }
}

impl Pipeline for Elsewhere {
    fn start(&mut self, _: usize, _: Field, _: &DeformableState, _: &[Point3], _: &[Vector3]) {}

    fn is_ready(&mut self, _: usize) -> bool {
        true
    }

    fn finish(&mut self, _: usize, _: &mut DeformableState, _: &mut [Point3]) -> bool {
        false
    }

    fn make(&mut self, _: usize, state: &DeformableState) {
        let mut desk = self.0.0.lock().unwrap();
        desk.state.clone_from(state);
        desk.asked = true;
        self.0.1.notify_all();
    }

    fn made(&mut self, _: usize, old: Option<Made>) -> Option<Made> {
        let (desk, bell) = &*self.0;
        let mut desk = desk.lock().unwrap();
        while desk.asked {
            desk = bell.wait(desk).unwrap();
        }
        desk.old = old;
        desk.made.take()
    }

    fn cancel(&mut self) {}
}

#[test]
fn a_tick_that_takes_over_a_matrix_allocates_nothing() {
    let text = teardrop(20e3, "\"none\"")
        .replace("lattice\"\n", "continuum\"\n")
        .replace("stiffness_n_m = inf", "stiffness_n_m = 800.0");
    let mut world = World::new(&text);
    let maker = Elsewhere::new(World::new(&text).scene);
    let shared = maker.0.clone();
    world.scratch.set_pipeline(Box::new(maker));
    for _ in 0..5 {
        world.at_in_place([0.06, 0.003, 0.045]);
    }
    let count = allocations(|| {
        for k in 0..1_500 {
            let t = f64::from(k) * 1e-3;
            world.at_in_place([0.030 + 0.020 * (4.0 * t).cos(), 0.003, 0.045]);
        }
    });
    let made = shared.0.lock().unwrap().count;
    assert!(made > 2, "{made} matrices");
    assert_eq!(count, 0);
}
