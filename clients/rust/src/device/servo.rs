//! What a device does in a servo period, apart from clock and bus: the force that may act now, the
//! device under it, and the poses that reach the daemon.
//!
//! ```text
//! newest force ─▶ hear ─▶ network ─▶ × gain ─▶ passivity ─▶ device ─▶ network ─▶ poses to send
//!                                     ▲ of the watchdog
//! ```
//! [`super::run`] joins it to a [`crate::Tool`]; simulations without a bus step it themselves.

use super::run::Sample;
use super::{Channel, DeviceError, Motion, Network, Passivity, PassivitySettings, SimulatedDevice};
use palpate_proto::messages::{ToolForce, ToolPose};

/// What goes between device and daemon: poses out, forces in, each through its own channel.
struct Link {
    poses: Channel<ToolPose>,
    forces: Channel<(u64, ToolForce)>,
    last_pose: Option<ToolPose>,
    /// The newest force, and its number among those that arrived.
    held: Option<(u64, ToolForce)>,
    arrived: u64,
    late: u64,
}

impl Link {
    fn new(network: Network) -> Result<Self, DeviceError> {
        // The two ways fail independently.
        let back = Network {
            seed: network.seed ^ 0x5851_f42d_4c95_7f2d,
            ..network
        };
        let (poses, forces) = (Channel::new(network)?, Channel::new(back)?);
        Ok(Self {
            poses,
            forces,
            last_pose: None,
            held: None,
            arrived: 0,
            late: 0,
        })
    }

    /// What the daemon gets for the pose of now: those that have arrived, in their order.
    fn deliver(&mut self, now_s: f64, pose: ToolPose, lockstep: bool) -> Vec<ToolPose> {
        self.poses.send(now_s, pose);
        let mut arrived: Vec<ToolPose> = self.poses.receive(now_s).collect();
        if lockstep {
            // A tick needs one pose and no more: the last that came, or again the one before.
            let newest = arrived.pop().or(self.last_pose).unwrap_or(pose);
            arrived = vec![newest];
        }
        self.last_pose = arrived.last().copied().or(self.last_pose);
        arrived
    }

    /// Takes a force of the daemon. Their order is that of arrival: ticks of a daemon that was started
    /// again count from below.
    fn answer(&mut self, now_s: f64, force: ToolForce) {
        self.arrived += 1;
        self.forces.send(now_s, (self.arrived, force));
    }

    /// Takes what has come back; the newest counts.
    fn collect(&mut self, now_s: f64) {
        for (number, force) in self.forces.receive(now_s) {
            match self.held {
                Some((held, _)) if number < held => self.late += 1,
                _ => self.held = Some((number, force)),
            }
        }
    }
}

/// The share of forces that may act in a period: of the watchdog ([`crate::NewestForce::gain`]), in real time.
pub type Gain = Option<f64>;

/// A servo period.
#[derive(Clone, Debug, PartialEq)]
pub struct Period {
    /// Poses that reach the daemon in it, in their order; in lockstep one.
    pub poses: Vec<ToolPose>,
    /// What was told and felt.
    pub sample: Sample,
}

/// Between a device and what carries its poses and forces.
pub struct Servo {
    link: Link,
    passivity: Option<Passivity>,
    /// Tick and time of the force heard last.
    last: Option<(u64, u64)>,
}

impl Servo {
    /// Nothing has been heard.
    ///
    /// # Errors
    /// A figure that no network has.
    pub fn new(
        network: Network,
        passivity: Option<PassivitySettings>,
    ) -> Result<Self, DeviceError> {
        Ok(Self {
            link: Link::new(network)?,
            passivity: passivity.map(Passivity::new),
            last: None,
        })
    }

    /// The newest force that has come through the network of the settings.
    pub fn held(&self) -> Option<&ToolForce> {
        self.link.held.as_ref().map(|(_, force)| force)
    }

    /// Moves the device on by a period of `dt_s` under the force that may act now. `gain`: `None` in lockstep.
    pub fn period(
        &mut self,
        device: &mut SimulatedDevice,
        motion: &Motion,
        dt_s: f64,
        gain: Gain,
    ) -> Period {
        let (force, torque) =
            (self.held()).map_or(([0.0; 3], [0.0; 3]), |held| (held.force, held.torque));
        let (force, torque) = match gain {
            Some(gain) if gain < 1.0 => (force.map(|f| f * gain), torque.map(|t| t * gain)),
            _ => (force, torque),
        };
        let reported = device.pose().position;
        let command = self
            .passivity
            .as_mut()
            .map_or(force, |control| control.force(force, reported, dt_s));
        let goal = motion.goal(device.time_s() + 0.5 * dt_s);
        device.advance_with_torque(goal, command, torque, dt_s);
        let now_s = device.time_s();
        let pose = ToolPose {
            buttons: motion.buttons(now_s),
            ..device.pose()
        };
        let sample = Sample {
            time_s: now_s,
            true_position: device.true_position(),
            reported_position: pose.position,
            received_n: force,
            applied_n: device.applied_n(),
            loop_j: device.energy().loop_j,
        };
        Period {
            poses: self.link.deliver(now_s, pose, gain.is_none()),
            sample,
        }
    }

    /// Takes the newest force of the daemon at the end of a period. False: it was heard before.
    pub fn hear(&mut self, now_s: f64, force: ToolForce) -> bool {
        let identity = Some((force.tick, force.t_server_ns));
        if self.last == identity {
            return false;
        }
        self.last = identity;
        self.link.answer(now_s, force);
        true
    }

    /// Anything has been heard.
    pub fn has_heard(&self) -> bool {
        self.last.is_some()
    }

    /// Takes what has come through the network by now.
    pub fn collect(&mut self, now_s: f64) {
        self.link.collect(now_s);
    }

    /// What the passivity controller took, J.
    pub fn dissipated_j(&self) -> f64 {
        (self.passivity.as_ref()).map_or(0.0, Passivity::dissipated_j)
    }

    /// Poses and forces lost on the network of the settings.
    pub fn lost(&self) -> [u64; 2] {
        [self.link.poses.lost(), self.link.forces.lost()]
    }

    /// Forces that came after a newer one, and were left.
    pub fn late(&self) -> u64 {
        self.link.late
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pose(k: u64) -> ToolPose {
        ToolPose {
            t_client_ns: k,
            ..crate::pose_at([0.0; 3])
        }
    }

    fn force(tick: u64) -> ToolForce {
        ToolForce {
            tick,
            pose_seq: 0,
            t_client_ns: 0,
            t_server_ns: 0,
            force: [tick as f64, 0.0, 0.0],
            torque: [0.0; 3],
            proxy_position: [0.0; 3],
            proxy_orientation: [0.0, 0.0, 0.0, 1.0],
            depth: 0.0,
            contact_count: 0,
            flags: 0,
        }
    }

    #[test]
    fn in_lockstep_every_tick_gets_one_pose_whatever_the_network_does() {
        let network = Network {
            delay_s: 0.003,
            jitter_s: 0.002,
            loss: 0.3,
            reorder: 0.2,
            seed: 4,
        };
        let mut link = Link::new(network).unwrap();
        let mut newest = 0;
        for k in 1..=1_000 {
            let got = link.deliver(k as f64 * 1e-3, pose(k), true);
            assert_eq!(got.len(), 1);
            assert!(k < 20 || got[0].t_client_ns + 3 <= k, "{k}");
            newest = got[0].t_client_ns.max(newest);
        }
        assert!(newest > 980);
    }

    #[test]
    fn a_force_that_was_overtaken_is_left() {
        let mut link = Link::new(Network {
            reorder: 0.3,
            seed: 2,
            ..Network::default()
        })
        .unwrap();
        let mut last = 0;
        for k in 1..=1_000 {
            link.answer(k as f64 * 1e-3, force(k));
            link.collect(k as f64 * 1e-3);
            let tick = link.held.map_or(0, |(_, force)| force.tick);
            assert!(tick >= last);
            last = tick;
        }
        assert!(link.late > 100, "{}", link.late);
    }

    #[test]
    fn forces_of_a_daemon_that_was_started_again_count_at_once() {
        let mut link = Link::new(Network::default()).unwrap();
        for tick in [5_000, 5_001, 1, 2] {
            link.answer(0.0, force(tick));
            link.collect(0.0);
            assert_eq!(link.held.map(|(_, force)| force.tick), Some(tick));
        }
        assert_eq!(link.late, 0);
    }
}
