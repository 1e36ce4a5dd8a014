//! Whether a device's poses may be believed: stale, jumping and lost links lead to zero force by a
//! ramp.
//!
//! ```text
//! Absent ─first pose─▶ Withheld ─contact force small─▶ Live ─stale or jump─▶ Fading
//!                       ▲                               ▲── a pose near the last ──┤
//!                       └───────── limit at zero, next pose (proxy seated anew) ───┘
//! ```
//! A device may be switched on inside a body. Its force then stays zero until what the contacts would give has been
//! small once: it must not be thrown out of where it rests.
//! Time is counted in ticks and in deadlines of ticks that were dropped, both recorded: a replay sees the same
//! ages, and a loop that cannot keep its rate lets no force act longer.

use super::DevicePose;
use palpate_geometry::math::{Coded, Point3, Rotation, Vector3};
use palpate_geometry::stateful;

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
    /// Poses are believed, and their force may act.
    Live,
    /// Poses stopped: the force fades.
    Stale,
    /// A pose was no possible motion: the force fades, then the new place is taken.
    Jumped,
    /// Poses are believed, and none had a small force yet since the tool was seated.
    Withheld,
}

/// State of a tool's link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Current phase of the link.
    pub phase: LinkPhase,
    /// The pose in effect; of no meaning while absent.
    pub pose: DevicePose,
    /// Its age, ticks; those that the loop dropped count.
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
    /// Accounts for ticks that the loop dropped: the pose ages and its force fades as if nothing had come in
    /// them; no limit grows. Whether the holder was silent is known in the next tick: one who was not moves the
    /// tool on from where it is, and stays on the side of a sheet that it was on.
    pub fn pass(&mut self, ticks: u32, limits: &LinkLimits, wanted: bool) {
        let until_stale = limits.stale_ticks.saturating_sub(self.age_ticks);
        let fresh = match self.phase {
            LinkPhase::Live => ticks.min(until_stale),
            _ => 0,
        };
        self.age_ticks = self.age_ticks.saturating_add(ticks);
        self.fade(fresh, self.goal_n(limits, wanted), limits);
        self.fade(ticks - fresh, 0.0, limits);
    }

    /// Lowers the limit, N, for so many ticks, at most to a goal.
    fn fade(&mut self, ticks: u32, goal_n: f64, limits: &LinkLimits) {
        let least_n = goal_n.min(self.limit_n);
        self.limit_n = (self.limit_n - limits.ramp_n * f64::from(ticks)).max(least_n);
    }

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
            // Over a longer stall a hand may have gone anywhere: what is far then is a new place.
            let ticks = match self.is_believed() {
                true => self.age_ticks.min(limits.stale_ticks.saturating_add(1)),
                false => self.age_ticks,
            };
            let plausible = stride <= limits.stride_max_m * f64::from(ticks);
            let faded =
                self.limit_n == 0.0 && matches!(self.phase, LinkPhase::Stale | LinkPhase::Jumped);
            if !new.is_somewhere() {
                // Nor does a tool start there, whose next real pose would be the jump.
                if self.phase != LinkPhase::Absent {
                    self.phase = LinkPhase::Jumped;
                }
                admission.refused = true;
            } else if self.phase == LinkPhase::Absent || faded {
                self.believe(new, LinkPhase::Withheld);
                admission.seated = true;
            } else if plausible {
                let withheld = self.phase == LinkPhase::Withheld;
                self.believe(
                    new,
                    if withheld {
                        self.phase
                    } else {
                        LinkPhase::Live
                    },
                );
            } else {
                self.phase = LinkPhase::Jumped;
                admission.refused = true;
            }
        } else if self.is_believed() && self.age_ticks > limits.stale_ticks {
            self.phase = LinkPhase::Stale;
        }
        self.ramp(limits, wanted);
        admission
    }

    /// The contact force is small: what comes after it may be felt, by the ramp that begins here.
    pub fn release(&mut self, limits: &LinkLimits, wanted: bool) {
        if self.phase == LinkPhase::Withheld {
            self.phase = LinkPhase::Live;
            self.ramp(limits, wanted);
        }
    }

    /// Moves the force limit towards its goal.
    fn ramp(&mut self, limits: &LinkLimits, wanted: bool) {
        debug_assert!(limits.ramp_n >= 0.0, "a ramp the other way");
        let goal = self.goal_n(limits, wanted);
        self.limit_n = if self.limit_n < goal {
            (self.limit_n + limits.ramp_n).min(goal)
        } else {
            (self.limit_n - limits.ramp_n).max(goal)
        };
    }

    /// Where the force limit goes, N: all that the device can bear, or nothing.
    pub fn goal_n(&self, limits: &LinkLimits, wanted: bool) -> f64 {
        if wanted && self.phase == LinkPhase::Live {
            limits.force_max_n
        } else {
            0.0
        }
    }

    /// No one ever moved the tool, or its force has faded since: what it touches pushes no one.
    pub fn feels_nothing(&self) -> bool {
        self.phase == LinkPhase::Absent || self.has_let_go()
    }

    /// No one moves the tool, and its force has faded: it touches nothing any more.
    pub fn has_let_go(&self) -> bool {
        matches!(self.phase, LinkPhase::Stale | LinkPhase::Jumped) && self.limit_n == 0.0
    }

    fn believe(&mut self, new: &DevicePose, phase: LinkPhase) {
        (self.pose, self.age_ticks, self.phase) = (*new, 0, phase);
    }

    /// Poses come and are believed.
    fn is_believed(&self) -> bool {
        matches!(self.phase, LinkPhase::Live | LinkPhase::Withheld)
    }

    /// Velocity the coupling may use: none once the pose is old.
    pub fn velocity(&self) -> Vector3 {
        if self.is_believed() {
            self.pose.linear_velocity
        } else {
            Vector3::zeros()
        }
    }

    /// Angular velocity the coupling may use, rad/s: none once the pose is old.
    pub fn angular_velocity(&self) -> Vector3 {
        if self.is_believed() {
            self.pose.angular_velocity
        } else {
            Vector3::zeros()
        }
    }
}

impl Coded for LinkPhase {
    fn code(&self) -> u64 {
        match self {
            Self::Absent => 0,
            Self::Live => 1,
            Self::Stale => 2,
            Self::Jumped => 3,
            Self::Withheld => 4,
        }
    }

    fn set_code(&mut self, code: u64) -> bool {
        *self = match code {
            0 => Self::Absent,
            1 => Self::Live,
            2 => Self::Stale,
            3 => Self::Jumped,
            4 => Self::Withheld,
            _ => return false,
        };
        true
    }
}

stateful!(Link, |this, walk| {
    let Link {
        phase,
        pose,
        age_ticks,
        limit_n,
    } = this;
    let DevicePose {
        seq,
        t_client_ns,
        position,
        orientation,
        linear_velocity,
        angular_velocity,
        buttons,
    } = pose;
    walk.coded("link phase", phase)?;
    walk.coded("pose age", age_ticks)?;
    walk.word(seq)?;
    walk.word(t_client_ns)?;
    walk.coded("button mask", buttons)?;
    walk.point(position)?;
    walk.rotation(orientation)?;
    walk.vector(linear_velocity)?;
    walk.vector(angular_velocity)?;
    walk.float(limit_n)
});

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Random;

    const LIMITS: LinkLimits = LinkLimits {
        force_max_n: 10.0,
        ramp_n: 1.0,
        stale_ticks: 50,
        stride_max_m: 0.01,
    };

    /// A tick of a tool that touches nothing.
    fn free(link: &mut Link, new: Option<&DevicePose>, wanted: bool) -> Admission {
        let admission = link.admit(new, &LIMITS, wanted);
        link.release(&LIMITS, wanted);
        admission
    }

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
        assert!(free(&mut link, Some(&at(0.0, 1)), true).seated);
        assert_eq!(link.limit_n, 1.0);
        for seq in 2..=20 {
            free(&mut link, Some(&at(0.0, seq)), true);
        }
        assert_eq!(link.limit_n, 10.0);
        for _ in 0..50 {
            free(&mut link, None, true);
        }
        assert_eq!((link.phase, link.limit_n), (LinkPhase::Live, 10.0));
        for tick in 1..=10 {
            free(&mut link, None, true);
            assert_eq!(link.limit_n, 10.0 - f64::from(tick));
        }
        assert_eq!(link.phase, LinkPhase::Stale);
    }

    // A loop that drops deadlines takes a force away as soon as one that does not.
    #[test]
    fn ticks_that_were_dropped_age_a_pose_and_fade_its_force_like_any_other() {
        let mut random = Random(39);
        for case in 0..2_000 {
            let wanted = case % 5 > 0;
            let (mut all, mut dropping) = (Link::default(), Link::default());
            for seq in 1..=20 {
                for link in [&mut all, &mut dropping] {
                    free(link, Some(&at(0.0, seq)), true);
                }
            }
            let mut late = 0;
            while late < 70 {
                let dropped = random.below(12) as u32;
                for _ in 0..=dropped {
                    free(&mut all, None, wanted);
                }
                dropping.pass(dropped, &LIMITS, wanted);
                free(&mut dropping, None, wanted);
                late += dropped + 1;
                assert_eq!(dropping, all, "{late} ticks after the last pose");
            }
            assert!(dropping.limit_n == 0.0 && dropping.phase == LinkPhase::Stale);
            // What comes after a silence is a new place.
            assert!(free(&mut dropping, Some(&at(1.0, 99)), true).seated);
        }
        let mut stalled = Link::default();
        for seq in 1..=20 {
            free(&mut stalled, Some(&at(0.0, seq)), true);
        }
        stalled.pass(u32::MAX, &LIMITS, true);
        assert_eq!(stalled.limit_n, 0.0);
        // A hand that went on meanwhile moves the tool on, and its force begins anew; one that is elsewhere is seated
        // there with the next pose.
        let mut elsewhere = stalled;
        let admission = free(&mut stalled, Some(&at(0.3, 21)), true);
        assert_eq!((admission, stalled.limit_n), (Admission::default(), 1.0));
        assert!(free(&mut elsewhere, Some(&at(1.0, 21)), true).refused);
        assert!(free(&mut elsewhere, Some(&at(1.0, 22)), true).seated);
    }

    #[test]
    fn a_jump_is_refused_until_the_force_has_faded_then_taken_as_a_new_place() {
        let mut link = Link::default();
        for seq in 1..=10 {
            free(&mut link, Some(&at(0.0, seq)), true);
        }
        let mut refusals = 0;
        for seq in 11..=40 {
            let admission = free(&mut link, Some(&at(1.0, seq)), true);
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
    fn a_pose_with_numbers_that_nothing_can_be_computed_of_is_refused_wherever_the_tool_is() {
        for bad in [1e300, -1e155, f64::NAN, f64::INFINITY] {
            let fast = DevicePose {
                linear_velocity: Vector3::new(0.0, bad, 0.0),
                ..at(0.0, 1)
            };
            for pose in [at(bad, 1), fast] {
                let mut link = Link::default();
                let first = free(&mut link, Some(&pose), true);
                assert_eq!((first.seated, first.refused), (false, true), "{pose:?}");
                // The next is the first.
                assert!(free(&mut link, Some(&at(0.0, 2)), true).seated);
                assert!(free(&mut link, Some(&pose), true).refused, "{pose:?}");
                for _ in 0..100 {
                    free(&mut link, Some(&pose), true);
                }
                assert_eq!(link.pose.position, Point3::origin(), "{pose:?}");
            }
        }
    }

    #[test]
    fn a_pause_fades_the_force_but_believes_the_device() {
        let mut link = Link::default();
        for seq in 1..=10 {
            free(&mut link, Some(&at(0.0, seq)), true);
        }
        for seq in 11..=30 {
            free(&mut link, Some(&at(0.001, seq)), false);
        }
        assert_eq!(
            (link.phase, link.limit_n, link.pose.seq),
            (LinkPhase::Live, 0.0, 30)
        );
    }

    // A device that is switched on inside a body, or comes back there.
    #[test]
    fn the_force_of_a_seated_tool_is_withheld_until_it_is_released() {
        let mut link = Link::default();
        for again in 0..3_u64 {
            let begun = 1_000 * again + 1;
            assert!(link.admit(Some(&at(1.0, begun)), &LIMITS, true).seated);
            for seq in begun + 1..begun + 40 {
                let admission = link.admit(Some(&at(1.0, seq)), &LIMITS, true);
                assert_eq!(admission, Admission::default());
                assert_eq!((link.phase, link.limit_n), (LinkPhase::Withheld, 0.0));
            }
            assert_eq!(link.velocity(), link.pose.linear_velocity);
            link.release(&LIMITS, true);
            assert_eq!((link.phase, link.limit_n), (LinkPhase::Live, 1.0));
            // Once is enough.
            link.release(&LIMITS, true);
            assert_eq!(link.limit_n, 1.0);
            for _ in 0..100 {
                link.admit(None, &LIMITS, true);
            }
        }
        // Poses that stop meanwhile, or jump, seat it anew with the next.
        for missing in [51, 1] {
            let mut link = Link::default();
            link.admit(Some(&at(1.0, 1)), &LIMITS, true);
            for _ in 0..missing {
                link.admit(Some(&at(9.0, 2)).filter(|_| missing == 1), &LIMITS, true);
            }
            assert!(link.admit(Some(&at(9.0, 3)), &LIMITS, true).seated);
            assert_eq!((link.phase, link.limit_n), (LinkPhase::Withheld, 0.0));
        }
    }
}
