use super::super::motion::tests::TARGET;
use super::super::{Channel, DeviceModel, Hand, Kind, Motion, Network, SimulatedDevice, Target};
use super::*;

/// What a run against a wall x < 0 of stiffness K showed.
#[derive(Debug, Default)]
struct Seen {
    /// Least of what the loop was given so far, and of that with the device's own damping, J.
    least_j: f64,
    least_own_j: f64,
    most_n: f64,
    /// Rms of the force around its mean over 25 ms while a press is held, N.
    ripple_n: f64,
    /// Most that a controller changed, N.
    changed_n: f64,
    /// Least the observer saw, J.
    observed_j: f64,
}

struct Run {
    model: DeviceModel,
    hand: Hand,
    stiffness: f64,
    delay_s: f64,
    kind: Kind,
    depth_m: f64,
    seconds: f64,
    control: Option<PassivitySettings>,
}

impl Run {
    fn see(&self) -> Seen {
        let target = Target {
            point: [0.0; 3],
            ..TARGET
        };
        let motion = Motion::Named {
            kind: self.kind,
            target,
            depth_m: self.depth_m,
        };
        let dt = 1.0 / self.model.rate_hz;
        let way = Network {
            delay_s: self.delay_s,
            ..Network::default()
        };
        let (mut there, mut back) = (Channel::new(way).unwrap(), Channel::new(way).unwrap());
        let mut device = SimulatedDevice::new(
            self.model.clone(),
            self.hand.clone(),
            motion.goal(0.0).position,
            1,
        );
        let mut passivity = self.control.map(Passivity::new);
        let (mut received, mut seen) = ([0.0; 3], Seen::default());
        let mut forces: Vec<f64> = Vec::new();
        let mut pressed: Vec<usize> = Vec::new();
        for k in 0..(self.seconds / dt) as usize {
            let now = k as f64 * dt;
            let reported = device.pose().position;
            there.send(now, reported);
            for position in there.receive(now) {
                back.send(now, [self.stiffness * (-position[0]).max(0.0), 0.0, 0.0]);
            }
            received = back.receive(now).last().unwrap_or(received);
            let held = passivity
                .as_mut()
                .map_or(received, |p| p.force(received, reported, dt));
            seen.changed_n = seen.changed_n.max(v3::norm(v3::sub(held, received)));
            device.advance(motion.goal(now + 0.5 * dt), held, dt);
            let energy = device.energy();
            seen.least_j = seen.least_j.min(energy.loop_j);
            seen.least_own_j = seen
                .least_own_j
                .min(energy.loop_j + energy.viscous_j + energy.coulomb_j);
            seen.observed_j = seen
                .observed_j
                .min(passivity.as_ref().map_or(0.0, Passivity::energy_j));
            seen.most_n = seen.most_n.max(held[0].abs());
            forces.push(held[0]);
            if self.kind == Kind::Press && (1.9..2.45).contains(&(now % 4.0)) {
                pressed.push(k);
            }
        }
        let half = (0.0125 / dt) as usize;
        let mut sum = 0.0;
        for &k in &pressed {
            let around = &forces[k - half..=(k + half).min(forces.len() - 1)];
            let mean = around.iter().sum::<f64>() / around.len() as f64;
            sum += (forces[k] - mean) * (forces[k] - mean);
        }
        seen.ripple_n = (sum / pressed.len().max(1) as f64).sqrt();
        seen
    }
}

fn run(device: &str, hand: Hand, stiffness: f64, delay_ms: f64, kind: Kind) -> Run {
    let model = DeviceModel::preset(device).unwrap();
    Run {
        model,
        hand,
        stiffness,
        delay_s: delay_ms * 1e-3,
        kind,
        depth_m: 0.004,
        seconds: 10.0,
        control: None,
    }
}

impl Run {
    fn controlled(self) -> Self {
        Self {
            control: Some(PassivitySettings::of(&self.model)),
            ..self
        }
    }
}

const KINDS: [Kind; 3] = [Kind::Press, Kind::Tap, Kind::Slide];

#[test]
fn what_is_passive_passes_to_the_bit() {
    // 2b/T is 1000 N/m for this device. Above it the controller has something to do.
    for hand in [Hand::light(), Hand::firm()] {
        for kind in KINDS {
            let seen = run("ideal", hand.clone(), 1_000.0, 0.0, kind)
                .controlled()
                .see();
            assert_eq!(seen.changed_n, 0.0, "{kind:?}");
            assert!(seen.most_n > 0.3);
        }
    }
    let seen = run("ideal", Hand::light(), 3_000.0, 0.0, Kind::Tap)
        .controlled()
        .see();
    assert!(seen.changed_n > 0.1);
    // A real device's friction does for a press what its damping does not.
    for device in ["touch", "touch-x", "falcon"] {
        let seen = run(device, Hand::firm(), 3_000.0, 0.0, Kind::Press)
            .controlled()
            .see();
        assert_eq!(seen.changed_n, 0.0, "{device}");
    }
}

#[test]
fn behind_a_delay_a_wall_makes_energy_and_under_control_it_does_not() {
    let mut unstable = 0;
    for device in ["ideal", "touch", "touch-x"] {
        for hand in [Hand::light(), Hand::firm()] {
            for stiffness in [1_000.0, 3_000.0] {
                for delay_ms in [1.0, 5.0, 20.0] {
                    for kind in KINDS {
                        let run = || run(device, hand.clone(), stiffness, delay_ms, kind);
                        let (off, on) = (run().see(), run().controlled().see());
                        let case = format!(
                            "{device} {} K {stiffness} {delay_ms} ms {kind:?}",
                            hand.name
                        );
                        // What the loop made never exceeds what the device took: the hand meets
                        // something passive.
                        let doubt = run().model.encoder_m * on.most_n;
                        assert!(on.least_own_j >= -doubt, "{case}: {on:?}");
                        unstable += i32::from(off.least_own_j < -0.1);
                        // And it is still a wall: at least a quarter of the force that a stable one
                        // gives.
                        if off.least_own_j == 0.0 {
                            assert!(on.most_n > 0.25 * off.most_n, "{case}: {off:?} {on:?}");
                        }
                    }
                }
            }
        }
    }
    assert!(unstable > 30, "{unstable}");
}

#[test]
fn with_nothing_counted_but_the_loop_it_makes_nothing_either() {
    // With an exact encoder the only doubt is how much farther the next period goes than the last:
    // T²/m times the force and the hand's, whose goal is never more than 14 mm away; and that under
    // the force.
    for hand in [Hand::light(), Hand::firm()] {
        for (stiffness, delay_ms) in [
            (1_000.0, 1.0),
            (1_000.0, 20.0),
            (3_000.0, 0.0),
            (3_000.0, 5.0),
            (3_000.0, 20.0),
        ] {
            for kind in KINDS {
                let run = run("ideal", hand.clone(), stiffness, delay_ms, kind);
                let mass_kg = run.model.mass_kg + run.hand.mass_kg;
                let control = Some(PassivitySettings {
                    damping_n_s_m: 0.0,
                    ..PassivitySettings::of(&run.model)
                });
                let seen = Run { control, ..run }.see();
                let doubt =
                    seen.most_n * (seen.most_n + 0.014 * hand.stiffness_n_m) / mass_kg * 1e-6;
                assert!(
                    seen.least_j >= -doubt,
                    "{} K {stiffness} {delay_ms} ms {kind:?}: {seen:?}",
                    hand.name
                );
                // What it saw is what there was.
                assert!((seen.observed_j - seen.least_j).abs() <= 1e-12 * (1.0 + seen.most_n));
            }
        }
    }
}

#[test]
fn a_held_press_is_quiet_where_it_would_swing() {
    for (device, stiffness, delay_ms, without, with) in [
        ("ideal", 1_000.0, 1.0, 0.03, 0.001),
        ("ideal", 1_000.0, 5.0, 0.4, 0.005),
        ("ideal", 3_000.0, 5.0, 2.0, 0.005),
        ("touch", 3_000.0, 5.0, 1.0, 0.005),
        ("touch-x", 1_000.0, 5.0, 0.7, 0.005),
        ("touch-x", 3_000.0, 1.0, 0.6, 0.005),
        ("touch-x", 3_000.0, 20.0, 4.0, 0.1),
    ] {
        let run = || run(device, Hand::light(), stiffness, delay_ms, Kind::Press);
        let (off, on) = (run().see(), run().controlled().see());
        assert!(
            off.ripple_n > without && on.ripple_n < with,
            "{device} {stiffness} {delay_ms}: {off:?} {on:?}"
        );
    }
}

fn plain() -> PassivitySettings {
    PassivitySettings {
        mass_kg: 0.1,
        damping_n_s_m: 0.0,
        coulomb_n: 0.0,
        bandwidth_hz: f64::INFINITY,
        force_max_n: 5.0,
        encoder_m: 0.0,
        reserve_j: 0.0,
        rest_s: 0.05,
    }
}

/// Moves along x by `ways` (m a period) under one received force; gives what was held.
fn drive(passivity: &mut Passivity, x: &mut f64, received: f64, ways: &[f64]) -> Vec<f64> {
    ways.iter()
        .map(|way| {
            *x += way;
            passivity.force([received, 0.0, 0.0], [*x, 0.0, 0.0], 1e-3)[0]
        })
        .collect()
}

#[test]
fn one_contact_is_no_credit_for_the_next() {
    let (mut passivity, mut x) = (Passivity::new(plain()), 0.0);
    // Pressed in under 2 N by 5 mm: 10 mJ, of which 2 mJ come back at once without a change.
    assert_eq!(drive(&mut passivity, &mut x, 2.0, &[-1e-4; 51])[50], 2.0);
    assert_eq!(drive(&mut passivity, &mut x, 2.0, &[1e-4; 10]), [2.0; 10]);
    drive(&mut passivity, &mut x, 0.0, &[0.0; 100]);
    let held = drive(&mut passivity, &mut x, 2.0, &[1e-4; 10]);
    assert!(held[1..].iter().all(|force| *force <= 0.0), "{held:?}");
    // The report has them all: 10 − 2 mJ, and no more came out.
    assert!(
        (passivity.energy_j() - 8e-3).abs() < 3e-4,
        "{}",
        passivity.energy_j()
    );
}

#[test]
fn a_short_rest_ends_no_contact() {
    let (mut passivity, mut x) = (Passivity::new(plain()), 0.0);
    drive(&mut passivity, &mut x, 2.0, &[-1e-4; 51]);
    drive(&mut passivity, &mut x, 0.0, &[0.0; 30]);
    assert_eq!(drive(&mut passivity, &mut x, 2.0, &[1e-4; 10]), [2.0; 10]);
}

#[test]
fn forces_that_are_none_or_too_great_are_not_passed_on() {
    let (mut passivity, mut x) = (Passivity::new(plain()), 0.0);
    assert_eq!(drive(&mut passivity, &mut x, f64::NAN, &[0.0; 3]), [0.0; 3]);
    assert_eq!(drive(&mut passivity, &mut x, 90.0, &[-1e-3; 3]), [5.0; 3]);
    let wild = drive(
        &mut passivity,
        &mut x,
        90.0,
        &[0.01, -0.01, 0.01, 0.02, -0.03],
    );
    assert!(wild.iter().all(|force| force.abs() <= 5.0), "{wild:?}");
}

#[test]
fn velocity_is_found_between_an_encoders_steps() {
    let settings = PassivitySettings {
        encoder_m: 1e-4,
        ..plain()
    };
    let mut passivity = Passivity::new(settings);
    // 1/7 of a step a period: differences are 0 or a whole step, the fitted line's slope is right
    // within a fourth.
    for k in 0..60 {
        let counted = (f64::from(k) / 7.0).round() * 1e-4;
        passivity.force([0.0; 3], [counted, 0.0, 0.0], 1e-3);
        if k > 20 {
            let way = passivity.next_way()[0];
            assert!((way - 1e-4 / 7.0).abs() < 0.5e-4 / 7.0, "{k}: {way}");
        }
    }
}
