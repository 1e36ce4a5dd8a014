//! Energy at the port between a device and the loop: watched always, kept from being made on
//! request.
//!
//! A device holds each force until the next, so what it puts into the loop between two ticks is
//! known without error from the poses: E += −f · (x − x₀), with the force of the tick before (Ryu,
//! Kim & Hannaford 2004, "Stable and high performance haptic interfaces"). A loop that gives back
//! more than it got has E < 0. The controller then adds a damper whose size is just what pays for
//! the next tick, if that goes on as this one did (Hannaford & Ryu 2002, "Time-domain passivity
//! control of haptic interfaces"). Energy taken by an earlier contact is not credited to the next.
//!
//! This is the port as the loop sees it. Delays between here and the device make energy beyond it,
//! which only a controller at the device can see: `palpate_client::device` has one.

use palpate_geometry::math::{StateError, StateSink, StateSource, Vector3};

/// Length by which rotations count as motion, m: that of a stylus between the fingers.
const REACH_M: f64 = 0.05;

/// Force and torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force, N.
    pub force_n: Vector3,
    /// Torque, N·m.
    pub torque_nm: Vector3,
}

/// Motion of a device within a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Displacement, m.
    pub moved: Vector3,
    /// Rotation vector, rad.
    pub turned: Vector3,
}

impl Wrench {
    fn work_j(&self, motion: &Motion) -> f64 {
        self.force_n.dot(&motion.moved) + self.torque_nm.dot(&motion.turned)
    }
}

/// The port of one tool. Part of the state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Port {
    /// Net work of the device on the loop since the start, J.
    energy_j: f64,
    /// What the controller's damper took of it, J.
    dissipated_j: f64,
    /// What this contact may give back, J.
    credit_j: f64,
    /// What the device holds now.
    held: Wrench,
    /// The damper's part of it.
    damper: Wrench,
}

impl Port {
    /// Net work of the device on the loop since the start, J; below zero: the loop has made energy.
    pub fn energy_j(&self) -> f64 {
        self.energy_j
    }

    /// Part of it that the controller's damper took, J.
    pub fn dissipated_j(&self) -> f64 {
        self.dissipated_j
    }

    /// The device moved under what it held.
    pub fn observe(&mut self, motion: &Motion) {
        let work = self.held.work_j(motion);
        self.energy_j -= work;
        self.credit_j -= work;
        self.dissipated_j -= self.damper.work_j(motion);
    }

    /// The device is somewhere else, without having been moved there.
    pub fn seat(&mut self) {
        (self.held, self.damper, self.credit_j) = (Wrench::default(), Wrench::default(), 0.0);
    }

    /// What a damper should add to `wanted` so that no energy is made, if the next tick goes on as
    /// this one did; no stronger than `damping_max_n_s_m`.
    pub fn damper(
        &mut self,
        wanted: &Wrench,
        motion: &Motion,
        dt_s: f64,
        damping_max_n_s_m: f64,
    ) -> Wrench {
        if *wanted == Wrench::default() && self.held == Wrench::default() {
            self.credit_j = self.credit_j.min(0.0);
        }
        let ahead_j = self.credit_j - wanted.work_j(motion);
        let way = motion.moved.norm_squared() + REACH_M * REACH_M * motion.turned.norm_squared();
        let lacks = ahead_j < 0.0 && way > 0.0;
        if !lacks {
            return Wrench::default();
        }
        let share = (-ahead_j / way).min(damping_max_n_s_m / dt_s);
        Wrench {
            force_n: motion.moved * -share,
            torque_nm: motion.turned * (-share * REACH_M * REACH_M),
        }
    }

    /// What the device holds from now on, and the damper's part of it.
    pub fn hold(&mut self, held: Wrench, damper: Wrench) {
        (self.held, self.damper) = (held, damper);
    }

    /// All of it, in order.
    pub fn save(&self, sink: &mut impl StateSink) {
        sink.floats(&[self.energy_j, self.dissipated_j, self.credit_j]);
        for wrench in [&self.held, &self.damper] {
            sink.floats(wrench.force_n.as_slice());
            sink.floats(wrench.torque_nm.as_slice());
        }
    }

    /// In the order of [`Port::save`].
    ///
    /// # Errors
    /// The source is too short.
    pub fn restore(&mut self, source: &mut impl StateSource) -> Result<(), StateError> {
        let mut sums = [0.0; 3];
        source.floats(&mut sums)?;
        [self.energy_j, self.dissipated_j, self.credit_j] = sums;
        for wrench in [&mut self.held, &mut self.damper] {
            source.floats(wrench.force_n.as_mut_slice())?;
            source.floats(wrench.torque_nm.as_mut_slice())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(x: f64) -> Motion {
        Motion {
            moved: Vector3::new(x, 0.0, 0.0),
            ..Motion::default()
        }
    }

    fn push(x: f64) -> Wrench {
        Wrench {
            force_n: Vector3::new(x, 0.0, 0.0),
            ..Wrench::default()
        }
    }

    /// A wall of stiffness K that the device enters and leaves at speed v makes K v² T² for every
    /// tick of the way, all of it by the hold: in, the force lags; out, it lags too.
    #[test]
    fn the_observer_sees_exactly_what_a_held_wall_makes() {
        let (stiffness, step, count) = (1_000.0, 1e-4, 50);
        let mut port = Port::default();
        let mut x = 0.0;
        let mut expected = 0.0;
        for tick in 0..=2 * count {
            let moved = if tick == 0 {
                0.0
            } else {
                if tick <= count { -step } else { step }
            };
            expected -= f64::max(-x * stiffness, 0.0) * moved;
            x += moved;
            port.observe(&along(moved));
            port.hold(push(f64::max(-x * stiffness, 0.0)), Wrench::default());
        }
        let made = stiffness * step * step * f64::from(count);
        assert!(
            (port.energy_j() + made).abs() < 1e-12,
            "{} for {}",
            port.energy_j(),
            -made
        );
        assert!((port.energy_j() - expected).abs() < 1e-15);
    }

    #[test]
    fn the_damper_pays_for_the_next_tick_and_no_more() {
        let mut port = Port::default();
        port.observe(&along(-1e-4));
        let damper = port.damper(&push(2.0), &along(1e-4), 1e-3, 100.0);
        // The next tick would make 2 N × 0.1 mm.
        assert!((damper.force_n.x + 2.0).abs() < 1e-12, "{}", damper.force_n);
        port.hold(
            Wrench {
                force_n: push(2.0).force_n + damper.force_n,
                ..Wrench::default()
            },
            damper,
        );
        port.observe(&along(1e-4));
        assert!(port.energy_j().abs() < 1e-18 && (port.dissipated_j() - 2e-4).abs() < 1e-15);
        // Bounded: 5 N s/m at 0.1 m/s.
        assert!((port.damper(&push(2.0), &along(1e-4), 1e-3, 5.0).force_n.x + 0.5).abs() < 1e-12);
        // Nothing to pay with while it stands still, and nothing to pay while the hand pushes in.
        assert_eq!(
            port.damper(&push(2.0), &along(0.0), 1e-3, 5.0),
            Wrench::default()
        );
        assert_eq!(
            port.damper(&push(2.0), &along(-1e-4), 1e-3, 5.0),
            Wrench::default()
        );
    }

    #[test]
    fn what_an_earlier_contact_took_is_no_credit() {
        let mut port = Port::default();
        port.hold(push(3.0), Wrench::default());
        port.observe(&along(-1e-2));
        port.hold(Wrench::default(), Wrench::default());
        assert_eq!(
            port.damper(&push(0.0), &along(1e-4), 1e-3, 50.0),
            Wrench::default()
        );
        assert!(port.damper(&push(1.0), &along(1e-4), 1e-3, 50.0).force_n.x < 0.0);
        assert!((port.energy_j() - 3e-2).abs() < 1e-15, "the sum stays");
    }
}
