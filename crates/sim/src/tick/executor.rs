//! Steps of bodies side by side, on threads that wait for them.
//!
//! ```text
//! bodies      0 1 2 │ 3 4 │ 5          lots: neighbours that take about as long as those of any other lot
//! this thread ──────▶
//! a worker          ──────▶            no body reads what another one writes: the bits do not depend on
//! a worker                ────▶        who steps it, or when
//! ```

use crate::scene::Scene;
use std::array::from_fn;
use std::mem::take;

/// Most lots of bodies.
pub const MOST_LOTS: usize = 8;
/// A lot whose step takes less, µs, costs more to hand over than it saves.
const LEAST_LOT_US: f64 = 10.0;

/// Threads that take part in a tick. Handing work over allocates nothing and locks nothing.
pub trait Executor: Send + std::fmt::Debug {
    /// Pieces of work that it does at once.
    fn width(&self) -> usize;
    /// A tick begins: so many pieces of work at once come soon, several times.
    fn wake(&mut self, count: usize);
    /// The tick has no more of them.
    fn rest(&mut self);
    /// Does each piece once, on any thread, and returns when all are done.
    fn run(&mut self, work: &mut [&mut (dyn FnMut() + Send)]);
}

/// An executor, and which bodies its threads step.
#[derive(Debug, Default)]
pub(crate) struct SideBySide {
    executor: Option<Box<dyn Executor>>,
    /// By lot, the end of its bodies.
    ends: [usize; MOST_LOTS],
    count: usize,
}

/// Bodies of one lot with what is changed of them.
struct Lot<'a, A, B> {
    first: usize,
    a: &'a mut [A],
    b: &'a mut [B],
}

impl SideBySide {
    /// Shares the bodies of a scene among the threads of an executor.
    pub(super) fn new(scene: &Scene, executor: Option<Box<dyn Executor>>) -> Self {
        let mut this = Self {
            executor,
            ..Self::default()
        };
        let width = this.executor.as_ref().map_or(1, |one| one.width());
        let steps_us = || (0..scene.bodies.len()).map(|body| scene.step_us(body));
        let (sum_us, soft) = (steps_us().sum::<f64>(), steps_us().filter(|us| *us > 0.0));
        let most = width.min(MOST_LOTS).min(soft.count());
        this.count = most.min((sum_us / LEAST_LOT_US) as usize).max(1);
        this.ends = [scene.bodies.len(); MOST_LOTS];
        let (mut lot, mut so_far_us) = (0, 0.0);
        for (body, us) in steps_us().enumerate() {
            // The body goes where most of it belongs.
            let middle = (so_far_us + 0.5 * us) * this.count as f64;
            while lot + 1 < this.count && middle >= sum_us * (lot + 1) as f64 {
                this.ends[lot] = body;
                lot += 1;
            }
            so_far_us += us;
        }
        this
    }

    /// The executor, for the bodies of another scene.
    pub(super) fn into_executor(self) -> Option<Box<dyn Executor>> {
        self.executor
    }

    pub(super) fn wake(&mut self) {
        if let Some(executor) = self.executor.as_mut().filter(|_| self.count > 1) {
            executor.wake(self.count);
        }
    }

    pub(super) fn rest(&mut self) {
        if let Some(executor) = self.executor.as_mut().filter(|_| self.count > 1) {
            executor.rest();
        }
    }

    /// Works on each body, with its part of `a` and of `b`; of one lot the bodies in their order.
    pub(super) fn each<A: Send, B: Send>(
        &mut self,
        mut a: &mut [A],
        mut b: &mut [B],
        work: impl Fn(usize, &mut A, &mut B) + Sync,
    ) {
        debug_assert_eq!(a.len(), b.len(), "an entry for each body");
        let executor = self.executor.as_mut().filter(|_| self.count > 1);
        let Some(executor) = executor else {
            for (body, (a, b)) in a.iter_mut().zip(b).enumerate() {
                work(body, a, b);
            }
            return;
        };
        let mut first = 0;
        let mut lots: [_; MOST_LOTS] = from_fn(|k| {
            let end = self.ends[k];
            let count = end - first;
            let (lot_a, rest_a) = take(&mut a).split_at_mut(count);
            let (lot_b, rest_b) = take(&mut b).split_at_mut(count);
            (a, b) = (rest_a, rest_b);
            let lot = Lot {
                first,
                a: lot_a,
                b: lot_b,
            };
            first = end;
            lot
        });
        let work = &work;
        let mut calls = lots.each_mut().map(|lot| {
            move || {
                for (k, (a, b)) in lot.a.iter_mut().zip(&mut *lot.b).enumerate() {
                    work(lot.first + k, a, b);
                }
            }
        });
        let mut calls = (calls.each_mut()).map(|call| call as &mut (dyn FnMut() + Send));
        executor.run(&mut calls[..self.count]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::World;

    /// Does what it is handed from the last to the first.
    #[derive(Debug)]
    struct Backwards(usize);

    impl Executor for Backwards {
        fn width(&self) -> usize {
            self.0
        }
        fn wake(&mut self, _: usize) {}
        fn rest(&mut self) {}
        fn run(&mut self, work: &mut [&mut (dyn FnMut() + Send)]) {
            work.iter_mut().rev().for_each(|work| work());
        }
    }

    /// Soft drops in a row with that many layers each, 0 of a rigid one.
    fn row_of(layers: &[usize]) -> World {
        let mut text = String::new();
        for (k, layers) in layers.iter().enumerate() {
            let soft = format!(
                "model = \"continuum\"\nmaterial = {{ young_pa = 20e3 }}\n\
                 lattice = {{ layers = {layers}, refine = \"none\" }}\n\
                 fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]\n"
            );
            text += &format!(
                "[[body]]\nid = \"b{k}\"\nsurface = {{ builtin = \"teardrop\", net = [8, 8] }}\n\
                 pose = {{ position = [0.0, {:?}, 0.0] }}\n{}",
                0.15 * k as f64,
                if *layers > 0 { &soft } else { "" }
            );
        }
        World::parse(&text).expect("a scene")
    }

    fn ends(layers: &[usize], width: usize) -> Vec<usize> {
        let world = row_of(layers);
        let bodies = SideBySide::new(&world.scene, Some(Box::new(Backwards(width))));
        bodies.ends[..bodies.count].to_vec()
    }

    #[test]
    fn neighbours_are_shared_by_what_they_cost() {
        assert_eq!(ends(&[2, 2], 2), [1, 2]);
        assert_eq!(ends(&[2, 2], 1), [2]);
        assert_eq!(ends(&[0, 0, 0], 4), [3]);
        assert_eq!(ends(&[2], 4), [1]);
        assert_eq!(ends(&[0, 2, 0, 2, 2, 2], 2), [4, 6]);
        assert_eq!(ends(&[4, 2, 2], 2), [1, 3]);
        assert_eq!(ends(&[2; 5], 3).last(), Some(&5));
    }

    #[test]
    fn each_body_is_worked_on_once_in_any_lot() {
        for width in 1..=MOST_LOTS + 1 {
            let world = row_of(&[2, 0, 2, 2]);
            let mut bodies = SideBySide::new(&world.scene, Some(Box::new(Backwards(width))));
            let (mut a, mut b) = ([0; 4], [10, 20, 30, 40]);
            bodies.each(&mut a, &mut b, |body, a, b| (*a, *b) = (*a + body, *b + 1));
            assert_eq!((a, b), ([0, 1, 2, 3], [11, 21, 31, 41]));
        }
    }
}
