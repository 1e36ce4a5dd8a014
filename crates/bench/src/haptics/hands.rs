//! A thousand hands: whatever the hand, a device whose coupling is within its limits gives back no
//! more than it got.

use super::energy::Task;
use super::rig::{Rig, wall};
use super::zwidth::figures;
use super::{Bar, Figure};
use crate::Effort;
use palpate_client::device::{Hand, devices};

/// What hands of many kinds found.
#[derive(Clone, Debug, PartialEq)]
pub struct HandsReport {
    /// How many.
    pub hands: usize,
    /// Of those, how many felt a force.
    pub touched: usize,
    /// Greatest energy that a device gave a hand beyond what it had got, over that of one encoder
    /// step at the greatest force.
    pub worst_of_quantum: f64,
    /// Which.
    pub worst: String,
}

struct Random(u64);

impl Random {
    /// Between two values, evenly by their logarithm.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.share())
    }

    fn share(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Lets `count` seeded hands press, tap and slide for three seconds each on a wall as stiff as
/// their device's limit allows.
pub fn hands(count: usize, seed: u64) -> HandsReport {
    let models = devices();
    let mut random = Random(seed);
    let mut report = HandsReport {
        hands: count,
        touched: 0,
        worst_of_quantum: 0.0,
        worst: String::new(),
    };
    for k in 0..count {
        let model = &models[k % models.len()];
        let hand = Hand {
            name: "seeded".to_owned(),
            mass_kg: random.between(0.005, 0.3),
            stiffness_n_m: random.between(20.0, 3_000.0),
            damping_n_s_m: random.between(0.1, 40.0),
            tremor_m: if random.share() < 0.5 {
                random.between(1e-5, 1e-3)
            } else {
                0.0
            },
            ..Hand::relaxed()
        };
        let (task, depth_m) = (Task::ALL[k / models.len() % 3], random.between(1e-3, 2e-2));
        let limit = figures(model, 1e-3).stiffness_limits(0.0).passive_n_m();
        let stiffness = limit * random.between(0.2, 1.0);
        let world = crate::world(&wall(stiffness, 0.0, ""));
        let mut rig = Rig::new(
            world,
            (model, &hand),
            task.goal(0.0, depth_m).position,
            0.0,
            None,
            seed ^ k as u64,
        );
        let (mut peak_n, mut given): (f64, f64) = (0.0, 0.0);
        for _ in 0..3_000 {
            let out = rig.period(task.goal(rig.device.time_s() + 0.5e-3, depth_m));
            peak_n = peak_n.max(out.force_n.norm());
            // At the port of the hand: what it did to the device is all there is to give back.
            given = given.max(-rig.device.energy().hand_j);
        }
        report.touched += usize::from(peak_n > 0.0);
        let quantum_j = (peak_n * model.encoder_m).max(1e-9);
        if given / quantum_j > report.worst_of_quantum {
            report.worst_of_quantum = given / quantum_j;
            report.worst = format!(
                "{}, {}, {stiffness:.0} N/m, hand {:.0} N/m",
                model.name,
                task.name(),
                hand.stiffness_n_m
            );
        }
    }
    report
}

pub(super) fn figure(effort: Effort) -> Figure {
    let report = hands(if effort == Effort::Quick { 100 } else { 1_000 }, 7);
    Figure {
        suite: "haptics",
        case: "energy/hands".to_owned(),
        method: format!("{} hands", report.hands),
        value: report.worst_of_quantum,
        unit: "1",
        reference: 1.0,
        reference_is: "of an encoder's step at the greatest force",
        bar: Some(Bar::AtMost(1.0)),
        note: format!("{} touched; worst: {}", report.touched, report.worst),
    }
}
