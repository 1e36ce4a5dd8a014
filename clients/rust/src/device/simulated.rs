//! A device with a hand on it, one servo period at a time.
//!
//! ```text
//! force ─▶ saturation ─▶ amplifier lag ─▶ ( mass + hand's mass ) ◀─ hand's spring and damper ◀─ goal (+ tremor)
//!                                            │        ▲ friction, damping
//!                                            └─▶ encoder ─▶ pose
//! ```
//! The force is held over the period. Without lag the motion is exact (see `carriage`), so that the
//! stability of a sampled loop is that of theory; with it, the amplifier's output is held at its
//! mean over each of a few substeps.

use super::carriage::{Carriage, Load, Pull, State, Work};
use super::encoder::Encoder;
use super::hand::{Goal, Hand, Tremor};
use super::model::DeviceModel;
use super::rotation::{Grasp, Spin};
use super::v3;
use palpate_proto::messages::ToolPose;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Where the energy went since the start, J: `hand = loop + viscous + coulomb + kinetic`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Energy {
    /// Work of the hand on the device.
    pub hand_j: f64,
    /// Work of the device on the loop, against the force that really acted. Negative: the loop made
    /// energy.
    pub loop_j: f64,
    /// Lost in the device's damping.
    pub viscous_j: f64,
    /// Lost in dry friction.
    pub coulomb_j: f64,
    /// Kinetic now (at the start it was at rest).
    pub kinetic_j: f64,
}

/// Substeps of a period when dry friction or a lag is at work.
const SUBSTEPS: usize = 8;

/// State of a device.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedDevice {
    model: DeviceModel,
    hand: Hand,
    tremor: Tremor,
    state: State,
    spin: Spin,
    encoder: Encoder,
    carriage: Carriage,
    work: Work,
    amplifier_n: [f64; 3],
    amplifier_nm: [f64; 3],
    applied_n: [f64; 3],
    time_s: f64,
}

impl SimulatedDevice {
    /// At rest at a place. The seed decides the tremor and nothing else.
    ///
    /// The figures of model and hand must be possible ones, see [`DeviceModel::checked`] and
    /// [`Hand::checked`].
    pub fn new(model: DeviceModel, hand: Hand, start: [f64; 3], seed: u64) -> Self {
        let load = load(&model, &hand, 1.0);
        Self {
            tremor: Tremor::new(hand.tremor_m, seed),
            state: State {
                position: start,
                velocity: [0.0; 3],
            },
            spin: Spin {
                orientation: v3::UNTURNED,
                angular_velocity: [0.0; 3],
            },
            encoder: Encoder::new(&model, start),
            carriage: Carriage::new(load, 1.0 / model.rate_hz),
            work: Work::default(),
            amplifier_n: [0.0; 3],
            amplifier_nm: [0.0; 3],
            applied_n: [0.0; 3],
            time_s: 0.0,
            model,
            hand,
        }
    }

    /// What it is made of.
    pub fn model(&self) -> &DeviceModel {
        &self.model
    }

    /// s since the start.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Where it is, m.
    pub fn true_position(&self) -> [f64; 3] {
        self.state.position
    }

    /// True velocity, m/s.
    pub fn true_velocity(&self) -> [f64; 3] {
        self.state.velocity
    }

    /// Unit quaternion x y z w.
    pub fn true_orientation(&self) -> [f64; 4] {
        self.spin.orientation
    }

    /// Mean force that acted over the last period, after saturation and amplifier, N.
    pub fn applied_n(&self) -> [f64; 3] {
        self.applied_n
    }

    /// One servo period of `dt_s` under a held force. `goal` is where the hand wants to be in the
    /// middle of the period.
    pub fn advance(&mut self, goal: Goal, force_n: [f64; 3], dt_s: f64) {
        self.advance_with_torque(goal, force_n, [0.0; 3], dt_s);
    }

    /// As [`Self::advance`], with a torque for devices that can twist.
    ///
    /// What exceeds the motors is shortened; what is not finite counts as none.
    pub fn advance_with_torque(
        &mut self,
        goal: Goal,
        force_n: [f64; 3],
        torque_nm: [f64; 3],
        dt_s: f64,
    ) {
        let mut goal = goal;
        let middle_s = self.time_s + 0.5 * dt_s;
        self.tremor.shake(&mut goal, middle_s);
        let load = load(
            &self.model,
            &self.hand,
            goal.grip * self.hand.grip_at(middle_s),
        );
        let lag = self.model.bandwidth_hz.is_finite();
        let least = if lag || load.coulomb_n > 0.0 {
            SUBSTEPS
        } else {
            1
        };
        let count = Carriage::steps(&load, dt_s).max(least);
        let step_s = dt_s / count as f64;
        if !self.carriage.is_for(&load, step_s) {
            self.carriage = Carriage::new(load, step_s);
        }
        let wanted = v3::limited(force_n, self.model.force_max_n);
        let mut pull = Pull {
            position: v3::add(goal.position, v3::scale(goal.velocity, -0.5 * dt_s)),
            velocity: goal.velocity,
        };
        let mut applied = [0.0; 3];
        for _ in 0..count {
            let force = lagged(
                &mut self.amplifier_n,
                wanted,
                self.model.bandwidth_hz,
                step_s,
            );
            self.carriage
                .step(&mut self.state, &pull, force, &mut self.work);
            pull.position = v3::add(pull.position, v3::scale(pull.velocity, step_s));
            applied = v3::add(applied, force);
        }
        self.applied_n = v3::scale(applied, 1.0 / count as f64);
        self.turn(&goal, torque_nm, dt_s);
        self.time_s += dt_s;
        let spin = (self.spin.orientation, self.spin.angular_velocity);
        self.encoder
            .sample((self.state.position, self.state.velocity), spin, dt_s);
    }

    fn turn(&mut self, goal: &Goal, torque_nm: [f64; 3], dt_s: f64) {
        let most = if self.model.torque_dof == 3 {
            self.model.torque_max_nm
        } else {
            0.0
        };
        let wanted = v3::limited(torque_nm, most);
        let torque = lagged(
            &mut self.amplifier_nm,
            wanted,
            self.model.bandwidth_hz,
            dt_s,
        );
        let grip = goal.grip * self.hand.grip_at(self.time_s + 0.5 * dt_s);
        let grasp = Grasp {
            inertia_kg_m2: self.model.inertia_kg_m2 + self.hand.inertia_kg_m2,
            damping_nm_s: self.model.rotation_damping_nm_s,
            torsion_nm: self.hand.torsion_nm * grip,
            torsion_damping_nm_s: self.hand.torsion_damping_nm_s * grip,
        };
        self.spin.step(&grasp, goal, torque, dt_s);
    }

    /// The pose its encoders tell, on its own clock.
    pub fn pose(&self) -> ToolPose {
        ToolPose {
            t_client_ns: (self.time_s * 1e9).round() as u64,
            orientation: self.encoder.orientation,
            linear_velocity: self.encoder.velocity,
            angular_velocity: self.encoder.angular_velocity,
            ..crate::pose_at(self.encoder.position)
        }
    }

    /// Where the energy went.
    pub fn energy(&self) -> Energy {
        let mass_kg = self.model.mass_kg + self.hand.mass_kg;
        let Work {
            hand_j,
            loop_j,
            viscous_j,
            coulomb_j,
        } = self.work;
        let kinetic_j = 0.5 * mass_kg * v3::dot(self.state.velocity, self.state.velocity);
        Energy {
            hand_j,
            loop_j,
            viscous_j,
            coulomb_j,
            kinetic_j,
        }
    }
}

fn load(model: &DeviceModel, hand: &Hand, grip: f64) -> Load {
    Load {
        mass_kg: model.mass_kg + hand.mass_kg,
        damping_n_s_m: model.damping_n_s_m,
        coulomb_n: model.coulomb_n,
        hand_stiffness_n_m: hand.stiffness_n_m * grip,
        hand_damping_n_s_m: hand.damping_n_s_m * grip,
    }
}

/// Mean output of the amplifier over a step; `state` is its output at the begin and becomes that at
/// the end.
pub(super) fn lagged(
    state: &mut [f64; 3],
    wanted: [f64; 3],
    bandwidth_hz: f64,
    step_s: f64,
) -> [f64; 3] {
    if !bandwidth_hz.is_finite() {
        *state = wanted;
        return wanted;
    }
    let turns = TAU * bandwidth_hz * step_s;
    let done = -libm::expm1(-turns);
    let gap = v3::sub(*state, wanted);
    *state = v3::add(wanted, v3::scale(gap, 1.0 - done));
    v3::add(wanted, v3::scale(gap, done / turns))
}

#[cfg(test)]
#[path = "simulated_tests.rs"]
mod tests;
