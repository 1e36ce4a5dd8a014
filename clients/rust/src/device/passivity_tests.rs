use super::super::motion::tests::TARGET;
use super::super::{Channel, DeviceModel, Hand, Kind, Motion, Network, SimulatedDevice, Target};
use super::*;

/// What a run against a wall x < 0 of stiffness K showed.
#[derive(Debug, Default)]
struct Seen {
    /// Least of what the loop was given so far, and of that with the device's own damping, J.
    least_j: f64,
    least_own_j: f64,
    end_j: f64,
    most_n: f64,
    most_depth: f64,
    /// Rms of the force around its mean over 25 ms while pressed, N; and of what a controller changed.
    ripple_n: f64,
    speed: f64,
    changed_n: f64,
    dissipated_j: f64,
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
        let target = Target { point: [0.0; 3], ..TARGET };
        let motion = Motion::Named { kind: self.kind, target, depth_m: self.depth_m };
        let dt = 1.0 / self.model.rate_hz;
        let way = Network { delay_s: self.delay_s, ..Network::default() };
        let (mut there, mut back) = (Channel::new(way).unwrap(), Channel::new(way).unwrap());
        let mut device = SimulatedDevice::new(self.model.clone(), self.hand.clone(), motion.goal(0.0).position, 1);
        let mut passivity = self.control.map(Passivity::new);
        let (mut received, mut seen) = ([0.0; 3], Seen::default());
        let mut forces: Vec<f64> = Vec::new();
        let mut pressed: Vec<(usize, f64)> = Vec::new();
        for k in 0..(self.seconds / dt) as usize {
            let now = k as f64 * dt;
            let reported = device.pose().position;
            there.send(now, reported);
            for position in there.receive(now) {
                back.send(now, [self.stiffness * (-position[0]).max(0.0), 0.0, 0.0]);
            }
            received = back.receive(now).last().unwrap_or(received);
            let held = passivity.as_mut().map_or(received, |p| p.force(received, reported, dt));
            seen.changed_n = seen.changed_n.max(v3::norm(v3::sub(held, received)));
            device.advance(motion.goal(now + 0.5 * dt), held, dt);
            let energy = device.energy();
            seen.least_j = seen.least_j.min(energy.loop_j);
            seen.least_own_j = seen.least_own_j.min(energy.loop_j + energy.viscous_j + energy.coulomb_j);
            seen.observed_j = seen.observed_j.min(passivity.as_ref().map_or(0.0, Passivity::energy_j));
            seen.end_j = energy.loop_j;
            seen.most_n = seen.most_n.max(held[0].abs());
            seen.most_depth = seen.most_depth.max(-device.true_position()[0]);
            forces.push(held[0]);
            if self.kind == Kind::Press && (1.9..2.45).contains(&(now % 4.0)) {
                pressed.push((k, device.true_velocity()[0]));
            }
        }
        let half = (0.0125 / dt) as usize;
        let mut sum = [0.0; 2];
        for &(k, speed) in &pressed {
            let around = &forces[k - half..=(k + half).min(forces.len() - 1)];
            let mean = around.iter().sum::<f64>() / around.len() as f64;
            sum[0] += (forces[k] - mean) * (forces[k] - mean);
            sum[1] += speed * speed;
        }
        let count = pressed.len().max(1) as f64;
        (seen.ripple_n, seen.speed) = ((sum[0] / count).sqrt(), (sum[1] / count).sqrt());
        seen.dissipated_j = passivity.map_or(0.0, |p| p.dissipated_j());
        seen
    }
}

#[test]
#[ignore]
fn survey() {
    let mut worst = [0.0f64; 2];
    for device in ["ideal", "touch", "touch-x", "falcon"] {
        for hand in [Hand::light(), Hand::firm()] {
            for stiffness in [1_000.0, 3_000.0] {
                for delay_ms in [0.0, 1.0, 5.0, 20.0] {
                    for kind in [Kind::Press, Kind::Tap, Kind::Slide] {
                        let model = DeviceModel::preset(device).unwrap();
                        let run = |control| {
                            Run {
                                model: model.clone(),
                                hand: hand.clone(),
                                stiffness,
                                delay_s: delay_ms * 1e-3,
                                kind,
                                depth_m: 0.004,
                                seconds: 10.0,
                                control,
                            }
                            .see()
                        };
                        let off = run(None);
                        let on = run(Some(PassivitySettings::of(&model)));
                        let strict = run(Some(PassivitySettings::strict(&model)));
                        let unit = |seen: &Seen| model.encoder_m.max(1e-6) * seen.most_n;
                        worst[0] = worst[0].min(on.least_own_j / unit(&on));
                        worst[1] = worst[1].min(strict.least_j / unit(&strict));
                        print!(
                            "{device:8} {:7} K {stiffness:4} d {delay_ms:2} {kind:6?} | off {:9.2e} rip {:6.3} max {:5.2} ",
                            hand.name, off.least_own_j, off.ripple_n, off.most_n
                        );
                        print!(
                            "| on {:9.2e} = {:6.2} q f rip {:6.3} v {:6.4} max {:5.2} chg {:5.2} diss {:8.2e} depth {:5.2} ",
                            on.least_own_j, on.least_own_j / unit(&on), on.ripple_n, on.speed, on.most_n, on.changed_n, on.dissipated_j, on.most_depth * 1e3
                        );
                        println!(
                            "| strict {:9.2e} = {:6.2} q f rip {:6.3} chg {:5.2} obs {:9.2e}",
                            strict.least_j, strict.least_j / unit(&strict), strict.ripple_n, strict.changed_n, strict.observed_j
                        );
                    }
                }
            }
        }
    }
    println!("|| worst {worst:?}");
}
