//! Which forces a hand could tell from the last one.
//!
//! Weber's law as a filter: a force is sent when |f − f_last| > δ |f_last|, with f_last the last
//! one sent (Hinterseer, Hirche, Chaudhuri, Steinbach and Buss 2008, "Perception-based data
//! reduction and transmission of haptic data in telepresence and teleaction systems", IEEE Trans.
//! Signal Processing 56 (2), eq. 3). The same for the torque. What a hand notices by itself passes
//! always: contact that begins or ends, flags that change. After a while without any the newest is
//! sent anyway, so that a lost message does no lasting harm.

use palpate_geometry::math::Vector3;
use palpate_sim::tick::record::ToolOutput;

/// The last force sent, and what may be left out since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Deadband {
    /// δ; 0: every force is sent.
    fraction: f64,
    /// A force at least this often, ticks.
    longest_ticks: u64,
    last: Option<Sent>,
    suppressed: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Sent {
    tick: u64,
    force_n: Vector3,
    torque_nm: Vector3,
    touching: bool,
    flags: u32,
}

impl Deadband {
    /// Lets everything through; sends at least once in `longest_ticks`.
    pub(super) fn new(longest_ticks: u64) -> Self {
        Self {
            fraction: 0.0,
            longest_ticks,
            last: None,
            suppressed: 0,
        }
    }

    /// From now on with the fraction δ.
    pub(super) fn set(&mut self, fraction: f64) {
        (self.fraction, self.last) = (fraction, None);
    }

    /// Forces left out so far.
    pub(super) fn suppressed(&self) -> u64 {
        self.suppressed
    }

    /// True when this force is to be sent; it then is the last one sent.
    pub(super) fn wants(&mut self, tick: u64, out: &ToolOutput) -> bool {
        if self.fraction == 0.0 {
            return true;
        }
        let now = Sent {
            tick,
            force_n: out.force_n,
            torque_nm: out.torque_nm,
            touching: out.contact.is_some(),
            flags: out.flags,
        };
        let felt =
            |now: &Vector3, last: &Vector3| (now - last).norm() > self.fraction * last.norm();
        let wanted = self.last.is_none_or(|last| {
            felt(&now.force_n, &last.force_n)
                || felt(&now.torque_nm, &last.torque_nm)
                || now.touching != last.touching
                || now.flags != last.flags
                || tick >= last.tick.saturating_add(self.longest_ticks)
        });
        if wanted {
            self.last = Some(now);
        } else {
            self.suppressed += 1;
        }
        wanted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::Point3;
    use palpate_sim::solve::rows::Holder;
    use palpate_sim::tick::record::ContactReport;

    fn pushing(force_n: f64) -> ToolOutput {
        let contact = ContactReport {
            body: 0,
            holder: Holder::Tool(0),
            u: 0.0,
            v: 0.0,
            point: Point3::origin(),
            normal: Vector3::z(),
            depth_m: 1e-3,
            force_n: Vector3::zeros(),
        };
        ToolOutput {
            force_n: Vector3::new(0.0, 0.0, force_n),
            contact: Some(contact),
            ..ToolOutput::default()
        }
    }

    /// Ticks (of those given, from 1) whose force was sent.
    fn sent(band: &mut Deadband, outs: impl IntoIterator<Item = ToolOutput>) -> Vec<u64> {
        (1..)
            .zip(outs)
            .filter(|(tick, out)| band.wants(*tick, out))
            .map(|(tick, _)| tick)
            .collect()
    }

    #[test]
    fn without_a_fraction_every_force_is_sent() {
        let mut band = Deadband::new(50);
        assert_eq!(sent(&mut band, [pushing(1.0); 4]), [1, 2, 3, 4]);
        assert_eq!(band.suppressed(), 0);
    }

    // A ramp f = t N under δ = 1/4: sent when f > 5/4 of the last one.
    #[test]
    fn a_ramp_is_sent_at_the_steps_of_weber() {
        let mut band = Deadband::new(1_000);
        band.set(0.25);
        let ramp = (1..=20).map(|t| pushing(f64::from(t)));
        let (mut last, mut expected) = (1.0, vec![1]);
        for t in 2..=20u32 {
            if f64::from(t) - last > 0.25 * last {
                (last, _) = (f64::from(t), expected.push(u64::from(t)));
            }
        }
        assert_eq!(sent(&mut band, ramp), expected);
        assert_eq!(expected, [1, 2, 3, 4, 6, 8, 11, 14, 18], "by hand");
        assert_eq!(band.suppressed(), 11);
    }

    // A force that only turns is felt too: the difference is a vector's.
    #[test]
    fn a_turning_force_and_a_torque_are_felt() {
        let mut band = Deadband::new(1_000);
        band.set(0.1);
        let turned = |angle: f64| ToolOutput {
            force_n: Vector3::new(libm::sin(angle), 0.0, libm::cos(angle)),
            ..pushing(0.0)
        };
        // |f − f'| = 2 sin(angle / 2) passes 0.1 at 0.100042 rad.
        assert_eq!(
            sent(&mut band, [turned(0.0), turned(0.1000), turned(0.1001)]),
            [1, 3]
        );
        let twisted = |torque_nm| ToolOutput {
            torque_nm: Vector3::new(torque_nm, 0.0, 0.0),
            ..turned(0.1001)
        };
        assert_eq!(
            sent(
                &mut band,
                [
                    twisted(0.0),
                    twisted(1e-6),
                    twisted(1.05e-6),
                    twisted(1.2e-6)
                ]
            ),
            [2, 4]
        );
    }

    #[test]
    fn make_break_and_flags_pass_and_so_does_the_longest_silence() {
        let mut band = Deadband::new(10);
        band.set(0.5);
        let free = ToolOutput::default();
        let ramping = ToolOutput { flags: 16, ..free };
        assert_eq!(
            sent(&mut band, [free, free, ramping, ramping, free, free]),
            [1, 3, 5]
        );
        let touching = pushing(0.0);
        band.set(0.5);
        assert_eq!(
            sent(&mut band, [free, touching, touching, free, free]),
            [1, 2, 4]
        );
        band.set(0.5);
        assert_eq!(sent(&mut band, [pushing(1.0); 25]), [1, 11, 21]);
    }

    // From nothing every force is felt, and to nothing as well: δ |f_last| is 0, and |f_last| is
    // more than its part.
    #[test]
    fn from_zero_and_to_zero_are_felt() {
        let mut band = Deadband::new(1_000);
        band.set(0.99);
        assert_eq!(
            sent(
                &mut band,
                [
                    pushing(0.0),
                    pushing(1e-9),
                    pushing(1e-9),
                    pushing(0.0),
                    pushing(0.0)
                ]
            ),
            [1, 2, 4]
        );
    }
}
