//! A scene that runs, and what is kept of it: times, work of the tools, energy, faults.

use crate::Times;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;
use palpate_sim::body::{Deformable, DeformableState};
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::record::TickOutput;
use std::ops::{Deref, DerefMut};
use std::time::Instant;

/// A scene that runs.
pub(super) struct World {
    run: palpate_sim::World,
    /// Time of each tick so far, s.
    pub ticks_s: Vec<f64>,
    /// Done by the first tool on the bodies, J.
    pub work_j: f64,
    /// Put in by all tools, J: what one took out again is not deducted. Forces count with the mean of
    /// a tick's two ends: along a round surface either of them does work that is none.
    pub put_in_j: f64,
    /// Ticks that reported a fault.
    pub faults: usize,
    /// (tools): proxy and force after the last tick.
    last: Vec<(Point3, Vector3)>,
    energy: Option<Energy>,
}

/// Energy of all deforming bodies against what was put in.
struct Energy {
    gravity: Vector3,
    first_j: f64,
    most_j: f64,
    excess_j: f64,
}

impl World {
    pub(super) fn new(text: &str) -> Result<Self, String> {
        Ok(Self {
            run: crate::parse(text)?,
            ticks_s: Vec::new(),
            work_j: 0.0,
            put_in_j: 0.0,
            faults: 0,
            last: Vec::new(),
            energy: None,
        })
    }

    pub(super) fn at(&mut self, position: [f64; 3]) -> TickOutput {
        self.pressing(position, 0)
    }

    /// One tick with the device there and these buttons down.
    pub(super) fn pressing(&mut self, position: [f64; 3], buttons: u32) -> TickOutput {
        self.posed(&[DevicePose {
            buttons,
            ..DevicePose::at_rest(position)
        }])
    }

    /// One tick with a pose for each of the first tools; `seq` is the world's.
    pub(super) fn posed(&mut self, poses: &[DevicePose]) -> TickOutput {
        self.run.take(poses.iter().copied());
        let start = Instant::now();
        self.run.tick();
        self.ticks_s.push(start.elapsed().as_secs_f64());
        let output = self.run.record.output.clone();
        self.account(&output, poses.len());
        output
    }

    /// Changes the state of the first body between ticks.
    pub(super) fn put(&mut self, change: impl FnOnce(&mut DeformableState)) -> Result<(), String> {
        let state = self.state.bodies.first_mut();
        let state = state.and_then(|state| state.deformable.as_mut());
        change(state.ok_or("the scene has no deforming body")?);
        self.run.scratch = self.run.scene.scratch(&self.run.state);
        Ok(())
    }

    /// Puts held coordinates of the first body so far from their places, for the ticks to come.
    pub(super) fn move_held(
        &mut self,
        held: &[(usize, Point3)],
        by: Vector3,
    ) -> Result<(), String> {
        let state = self.state.bodies.first_mut();
        let state = state.and_then(|state| state.deformable.as_mut());
        let state = state.ok_or("the scene has no deforming body")?;
        for &(c, place) in held {
            state.positions[c] = place + by;
        }
        Ok(())
    }

    /// The deforming body of a scene that has one, and its state.
    pub(super) fn body(&self) -> Result<(&Deformable, &DeformableState), String> {
        let state = self.state.bodies.first();
        let parts = self
            .scene
            .deformable(0)
            .zip(state.and_then(|state| state.deformable.as_ref()));
        parts.ok_or_else(|| "the scene has no deforming body".to_owned())
    }

    /// How far the coordinate of the first body that is farthest from its place at rest is from it, m.
    pub(super) fn away_m(&self) -> Result<f64, String> {
        let (body, state) = self.body()?;
        let moved = state.positions.iter().zip(body.rest());
        // What is not a number stays.
        Ok(moved
            .map(|(x, rest)| (x - rest).norm())
            .fold(0.0, |most, m| if m > most || m.is_nan() { m } else { most }))
    }

    /// The first body's surface as it is now.
    pub(super) fn surface(&self) -> Surface {
        let mut surface = self.scene.rest_surface(0).expect("a surface").clone();
        let points = surface.net_mut().points_mut();
        self.state.copy_net(&self.scene, 0, points);
        surface
    }

    /// From now on compares the energy of the bodies in each tick with that of now and what tools put
    /// in. `gravity`: m/s², for their height.
    pub(super) fn watch_energy(&mut self, gravity: Vector3) {
        self.put_in_j = 0.0;
        let first_j = self.energy_j(&gravity);
        self.energy = Some(Energy {
            gravity,
            first_j,
            most_j: first_j,
            excess_j: 0.0,
        });
    }

    /// Largest energy since [`World::watch_energy`], J, and the largest excess of it over what it
    /// was then and what was put in; zero if nobody watches.
    pub(super) fn energies_j(&self) -> (f64, f64) {
        let energy = self.energy.as_ref();
        energy.map_or((0.0, 0.0), |energy| (energy.most_j, energy.excess_j))
    }

    /// The excess over the largest energy that may have been there.
    pub(super) fn energy_excess(&self) -> f64 {
        let Some(energy) = &self.energy else {
            return 0.0;
        };
        let there_j = (self.put_in_j + energy.first_j).max(energy.most_j);
        energy.excess_j / there_j.max(f64::MIN_POSITIVE)
    }

    /// Adds what was counted in another world, as if it had run in this one.
    pub(super) fn add(&mut self, other: &Self) {
        self.ticks_s.extend_from_slice(&other.ticks_s);
        self.faults += other.faults;
        if let Some((energy, more)) = self.energy.as_mut().zip(other.energy.as_ref()) {
            // The larger of the two shares.
            let there_j = (other.put_in_j + more.first_j).max(more.most_j);
            let own_j = (self.put_in_j + energy.first_j).max(energy.most_j);
            if more.excess_j * own_j > energy.excess_j * there_j || more.excess_j.is_nan() {
                self.put_in_j = other.put_in_j;
                *energy = Energy { ..*more };
            }
        }
    }

    /// Kinetic and elastic energy, and that of height, of all deforming bodies, J.
    fn energy_j(&self, gravity: &Vector3) -> f64 {
        let mut sum_j = 0.0;
        for (index, state) in self.state.bodies.iter().enumerate() {
            let Some((body, state)) = self.scene.deformable(index).zip(state.deformable.as_ref())
            else {
                continue;
            };
            // What sleeps as it was built has none.
            if body.asleep(state) && state.positions == body.rest() {
                continue;
            }
            sum_j += body.energy_j(state);
            if *gravity != Vector3::zeros() {
                let moved = state.positions.iter().zip(body.rest());
                sum_j -= moved
                    .zip(body.masses())
                    .map(|((x, rest), m)| m * gravity.dot(&(x - rest)))
                    .sum::<f64>();
            }
        }
        sum_j
    }

    fn account(&mut self, output: &TickOutput, tools: usize) {
        self.faults += usize::from(output.fault.is_some());
        for tool in 0..tools {
            let (place, force_n) = (
                output.tools[tool].proxy_position,
                output.tools[tool].contact_force_n,
            );
            if self.last.len() == tool {
                self.last.push((place, Vector3::zeros()));
            }
            let (from, before_n) = std::mem::replace(&mut self.last[tool], (place, force_n));
            if tool == 0 {
                self.work_j -= force_n.dot(&(place - from));
            }
            self.put_in_j += (-(force_n + before_n).dot(&(place - from)) * 0.5).max(0.0);
        }
        if let Some(gravity) = self.energy.as_ref().map(|energy| energy.gravity) {
            let now_j = self.energy_j(&gravity);
            let put_in_j = self.put_in_j;
            if let Some(energy) = &mut self.energy {
                // What is not a number stays.
                let most = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
                energy.most_j = most(energy.most_j, now_j);
                energy.excess_j = most(energy.excess_j, now_j - energy.first_j - put_in_j);
            }
        }
    }

    /// Median time of a tick, s; `None` before the first.
    pub(super) fn median_s(&self) -> Option<f64> {
        Times::of(self.ticks_s.clone()).map(|times| times.median_s)
    }
}

impl Deref for World {
    type Target = palpate_sim::World;

    fn deref(&self) -> &Self::Target {
        &self.run
    }
}

impl DerefMut for World {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.run
    }
}
