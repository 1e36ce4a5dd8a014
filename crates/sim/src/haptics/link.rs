//! Whether a device's poses may be believed: stale, jumping and lost links lead to zero force by a
//! ramp.
//!
//! ```text
//! Absent ─first pose─▶ Live ─stale or jump─▶ Fading ─limit at zero, next pose─▶ Live (proxy seated anew)
//!                       ▲───────── a pose near the last believed one ───────────┘
//! ```
//! Time is counted in ticks: a replay sees the same ages.

use super::DevicePose;
use palpate_geometry::math::{Point3, Rotation, StateError, StateSink, StateSource, Vector3};

/// Bounds of one tool's link, from the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkLimits {
    /// Greatest force, N.
    pub force_max_n: f64,
    /// Change of the force limit a tick, N.
    pub ramp_n: f64,
    /// A pose older than this is stale, ticks.
    pub stale_ticks: u32,
    /// Farthest plausible motion in one tick, m.
    pub stride_max_m: f64,
}

/// Where a link stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkPhase {
    /// No pose yet.
    Absent,
    /// Poses are believed.
    Live,
    /// Poses stopped: the force fades.
    Stale,
    /// A pose was no possible motion: the force fades, then the new place is taken.
    Jumped,
}

/// State of a tool's link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Current phase of the link.
    pub phase: LinkPhase,
    /// The pose in effect; of no meaning while absent.
    pub pose: DevicePose,
    /// Its age, ticks.
    pub age_ticks: u32,
    /// What the force may be now, N.
    pub limit_n: f64,
}

/// What this tick's pose did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Admission {
    /// The tool is somewhere new: seat its proxy at the device.
    pub seated: bool,
    /// The pose was refused.
    pub refused: bool,
}

impl Default for Link {
    fn default() -> Self {
        let pose = DevicePose {
            seq: 0,
            t_client_ns: 0,
            position: Point3::origin(),
            orientation: Rotation::identity(),
            linear_velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            buttons: 0,
        };
        Self {
            phase: LinkPhase::Absent,
            pose,
            age_ticks: 0,
            limit_n: 0.0,
        }
    }
}

impl Link {
    /// Takes this tick's pose, if any, and moves the force limit towards its goal. `wanted`: forces
    /// may be felt at all.
    pub fn admit(
        &mut self,
        new: Option<&DevicePose>,
        limits: &LinkLimits,
        wanted: bool,
    ) -> Admission {
        let mut admission = Admission::default();
        self.age_ticks = self.age_ticks.saturating_add(1);
        if let Some(new) = new {
            let stride = (new.position - self.pose.position).norm();
            let plausible = stride <= limits.stride_max_m * f64::from(self.age_ticks);
            let faded =
                self.limit_n == 0.0 && matches!(self.phase, LinkPhase::Stale | LinkPhase::Jumped);
            if self.phase == LinkPhase::Absent || faded {
                self.believe(new);
                admission.seated = true;
            } else if plausible {
                self.believe(new);
            } else {
                self.phase = LinkPhase::Jumped;
                admission.refused = true;
            }
        } else if self.phase == LinkPhase::Live && self.age_ticks > limits.stale_ticks {
            self.phase = LinkPhase::Stale;
        }
        let goal = if wanted && self.phase == LinkPhase::Live {
            limits.force_max_n
        } else {
            0.0
        };
        self.limit_n = if self.limit_n < goal {
            (self.limit_n + limits.ramp_n).min(goal)
        } else {
            (self.limit_n - limits.ramp_n).max(goal)
        };
        admission
    }

    fn believe(&mut self, new: &DevicePose) {
        self.pose = *new;
        self.age_ticks = 0;
        self.phase = LinkPhase::Live;
    }

    /// Velocity the coupling may use: none once the pose is old.
    pub fn velocity(&self) -> Vector3 {
        if self.phase == LinkPhase::Live {
            self.pose.linear_velocity
        } else {
            Vector3::zeros()
        }
    }

    /// Angular velocity the coupling may use, rad/s: none once the pose is old.
    pub fn angular_velocity(&self) -> Vector3 {
        if self.phase == LinkPhase::Live {
            self.pose.angular_velocity
        } else {
            Vector3::zeros()
        }
    }

    /// All of it, in order.
    pub fn save(&self, sink: &mut impl StateSink) {
        let pose = &self.pose;
        let phase = match self.phase {
            LinkPhase::Absent => 0,
            LinkPhase::Live => 1,
            LinkPhase::Stale => 2,
            LinkPhase::Jumped => 3,
        };
        for word in [
            phase,
            u64::from(self.age_ticks),
            pose.seq,
            pose.t_client_ns,
            u64::from(pose.buttons),
        ] {
            sink.word(word);
        }
        sink.floats(pose.position.coords.as_slice());
        sink.floats(pose.orientation.coords.as_slice());
        sink.floats(pose.linear_velocity.as_slice());
        sink.floats(pose.angular_velocity.as_slice());
        sink.floats(&[self.limit_n]);
    }

    /// In the order of [`Link::save`].
    ///
    /// # Errors
    /// The source is too short or its phase unknown.
    pub fn restore(&mut self, source: &mut impl StateSource) -> Result<(), StateError> {
        self.phase = match source.word()? {
            0 => LinkPhase::Absent,
            1 => LinkPhase::Live,
            2 => LinkPhase::Stale,
            3 => LinkPhase::Jumped,
            value => {
                return Err(StateError::Value {
                    what: "link phase",
                    value,
                });
            }
        };
        self.age_ticks = small(source.word()?, "pose age")?;
        self.pose.seq = source.word()?;
        self.pose.t_client_ns = source.word()?;
        self.pose.buttons = small(source.word()?, "button mask")?;
        source.floats(self.pose.position.coords.as_mut_slice())?;
        let mut quaternion = [0.0; 4];
        source.floats(&mut quaternion)?;
        // Taken as saved: normalising again would change the last bit.
        self.pose.orientation = Rotation::new_unchecked(nalgebra::Quaternion::from(
            nalgebra::Vector4::from(quaternion),
        ));
        source.floats(self.pose.linear_velocity.as_mut_slice())?;
        source.floats(self.pose.angular_velocity.as_mut_slice())?;
        let mut limit = [0.0];
        source.floats(&mut limit)?;
        self.limit_n = limit[0];
        Ok(())
    }
}

fn small(value: u64, what: &'static str) -> Result<u32, StateError> {
    u32::try_from(value).map_err(|_| StateError::Value { what, value })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: LinkLimits = LinkLimits {
        force_max_n: 10.0,
        ramp_n: 1.0,
        stale_ticks: 50,
        stride_max_m: 0.01,
    };

    fn at(x: f64, seq: u64) -> DevicePose {
        DevicePose {
            seq,
            position: Point3::new(x, 0.0, 0.0),
            ..Link::default().pose
        }
    }

    #[test]
    fn force_limit_ramps_up_on_connect_and_down_when_poses_stop() {
        let mut link = Link::default();
        assert!(link.admit(Some(&at(0.0, 1)), &LIMITS, true).seated);
        assert_eq!(link.limit_n, 1.0);
        for seq in 2..=20 {
            link.admit(Some(&at(0.0, seq)), &LIMITS, true);
        }
        assert_eq!(link.limit_n, 10.0);
        for _ in 0..50 {
            link.admit(None, &LIMITS, true);
        }
        assert_eq!((link.phase, link.limit_n), (LinkPhase::Live, 10.0));
        for tick in 1..=10 {
            link.admit(None, &LIMITS, true);
            assert_eq!(link.limit_n, 10.0 - f64::from(tick));
        }
        assert_eq!(link.phase, LinkPhase::Stale);
    }

    #[test]
    fn a_jump_is_refused_until_the_force_has_faded_then_taken_as_a_new_place() {
        let mut link = Link::default();
        for seq in 1..=10 {
            link.admit(Some(&at(0.0, seq)), &LIMITS, true);
        }
        let mut refusals = 0;
        for seq in 11..=40 {
            let admission = link.admit(Some(&at(1.0, seq)), &LIMITS, true);
            if admission.seated {
                break;
            }
            assert!(admission.refused);
            assert_eq!(link.pose.position.x, 0.0, "a refused pose moved the tool");
            refusals += 1;
        }
        assert_eq!(refusals, 10, "one refusal for each tick of the ramp");
        assert_eq!(link.pose.position.x, 1.0);
        assert_eq!(link.limit_n, 1.0);
    }

    #[test]
    fn a_pause_fades_the_force_but_believes_the_device() {
        let mut link = Link::default();
        for seq in 1..=10 {
            link.admit(Some(&at(0.0, seq)), &LIMITS, true);
        }
        for seq in 11..=30 {
            link.admit(Some(&at(0.001, seq)), &LIMITS, false);
        }
        assert_eq!(
            (link.phase, link.limit_n, link.pose.seq),
            (LinkPhase::Live, 0.0, 30)
        );
    }
}
