use super::*;

fn ideal() -> DeviceModel {
    DeviceModel::preset("ideal").unwrap()
}

fn alone(model: DeviceModel) -> SimulatedDevice {
    SimulatedDevice::new(model, Hand::absent(), [0.0; 3], 1)
}

#[test]
fn released_from_a_stretch_it_swings_as_the_closed_form_says() {
    let (model, hand) = (ideal(), Hand::relaxed());
    let (m, k) = (model.mass_kg + hand.mass_kg, hand.stiffness_n_m);
    let decay = (model.damping_n_s_m + hand.damping_n_s_m) / (2.0 * m);
    let omega = (k / m - decay * decay).sqrt();
    let mut device = SimulatedDevice::new(model, hand, [0.01, 0.0, 0.0], 1);
    for step in 1..=300 {
        device.advance(Goal::at([0.0; 3]), [0.0; 3], 1e-3);
        let t = f64::from(step) * 1e-3;
        let exact =
            0.01 * (-decay * t).exp() * ((omega * t).cos() + decay / omega * (omega * t).sin());
        assert!(
            (device.true_position()[0] - exact).abs() < 1e-15,
            "at {t} s"
        );
    }
}

#[test]
fn a_held_force_moves_it_by_force_over_stiffness_and_saturates() {
    let mut device = SimulatedDevice::new(ideal(), Hand::relaxed(), [0.0; 3], 1);
    for _ in 0..3_000 {
        device.advance(Goal::at([0.0; 3]), [0.0, 100.0, 0.0], 1e-3);
    }
    assert!((device.true_position()[1] - 8.0 / 400.0).abs() < 1e-12);
    assert_eq!(device.applied_n(), [0.0, 8.0, 0.0]);
}

#[test]
fn a_moving_goal_is_followed_behind_by_what_the_devices_damping_costs() {
    // The hand's damper follows the goal's velocity, so only the device's own damping holds back: b
    // v / k.
    let mut device = SimulatedDevice::new(ideal(), Hand::relaxed(), [0.0; 3], 1);
    for k in 0..3_000 {
        let middle = (f64::from(k) + 0.5) * 1e-3;
        device.advance(
            Goal::moving([0.05 * middle, 0.0, 0.0], [0.05, 0.0, 0.0]),
            [0.0; 3],
            1e-3,
        );
    }
    assert!((device.true_position()[0] - (0.15 - 0.5 * 0.05 / 400.0)).abs() < 1e-13);
}

#[test]
fn the_sampled_spring_is_stable_up_to_two_b_over_t() {
    // ẍ = −(b/m) ẋ + (F/m) with F = −K x held over T: the product of the loop's two poles is
    // e^{−bT/m} + K (A²/m − G e^{−bT/m}), which is 1 at K = 2b/T (1 + O(bT/m)); bT/m is 1e-4 here.
    let model = DeviceModel {
        mass_kg: 1.0,
        damping_n_s_m: 0.1,
        force_max_n: 1e9,
        ..ideal()
    };
    let period = 1e-3;
    let product = |stiffness: f64| {
        let mut device = alone(model.clone());
        let mut states = Vec::new();
        device.advance(Goal::at([0.0; 3]), [1.0, 0.0, 0.0], period);
        for _ in 0..3 {
            let (x, v) = (device.true_position()[0], device.true_velocity()[0]);
            states.push((x, v));
            device.advance(Goal::at([0.0; 3]), [-stiffness * x, 0.0, 0.0], period);
        }
        let cross = |a: (f64, f64), b: (f64, f64)| a.0 * b.1 - a.1 * b.0;
        cross(states[1], states[2]) / cross(states[0], states[1])
    };
    let (mut low, mut high) = (1.0, 1_000.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if product(middle) < 1.0 {
            low = middle
        } else {
            high = middle
        }
    }
    let theory = 2.0 * model.damping_n_s_m / period;
    assert!(
        (low / theory - 1.0).abs() < 1e-3,
        "{low} N/m, by theory {theory}"
    );
    // And so it does swing: 2 % below the limit it dies away, 2 % above it grows.
    for (share, grows) in [(0.98, false), (1.02, true)] {
        let mut device = alone(model.clone());
        device.advance(Goal::at([0.0; 3]), [1.0, 0.0, 0.0], period);
        let mut most = [0.0f64; 2];
        for k in 0..100_000 {
            let x = device.true_position()[0];
            device.advance(Goal::at([0.0; 3]), [-share * theory * x, 0.0, 0.0], period);
            most[usize::from(k >= 50_000)] = most[usize::from(k >= 50_000)].max(x.abs());
        }
        assert_eq!(most[1] > most[0], grows, "{share}: {most:?}");
    }
}

#[test]
fn friction_brings_it_to_rest_where_it_must_and_holds_it_there() {
    // Pushed at 2 N for 50 ms against 0.5 N of friction, then left: v = 1.5 t/m, and ½ m v² = 0.5 N
    // × way.
    let model = DeviceModel {
        damping_n_s_m: 0.0,
        coulomb_n: 0.5,
        ..ideal()
    };
    for period in [1e-3, 7.3e-4, 1e-2] {
        let mut device = alone(model.clone());
        let pushes = (0.05 / period) as usize;
        for _ in 0..pushes {
            device.advance(Goal::at([0.0; 3]), [0.0, 2.0, 0.0], period);
        }
        let t = pushes as f64 * period;
        let (way, speed) = (0.5 * 15.0 * t * t, 15.0 * t);
        assert!(
            (device.true_position()[1] - way).abs() < 1e-12
                && (device.true_velocity()[1] - speed).abs() < 1e-12
        );
        let rest = way + 0.5 * 0.1 * speed * speed / 0.5;
        for _ in 0..(0.3 / period) as usize {
            device.advance(Goal::at([0.0; 3]), [0.0; 3], period);
        }
        assert!(
            (device.true_position()[1] - rest).abs() < 1e-12,
            "{} for {rest}",
            device.true_position()[1]
        );
        // Up to the friction nothing moves it: no creep, no chatter.
        let there = device.true_position();
        for k in 0..2_000 {
            let push = if k % 2 == 0 { 0.499_999 } else { -0.499_999 };
            device.advance(Goal::at([0.0; 3]), [0.0, push, 0.0], period);
            assert_eq!(
                (device.true_position(), device.true_velocity()),
                (there, [0.0; 3])
            );
        }
        device.advance(Goal::at([0.0; 3]), [0.0, 0.500_001, 0.0], period);
        assert!(device.true_position()[1] > there[1]);
    }
}

#[test]
fn a_hand_with_friction_stops_within_what_friction_can_hold() {
    let model = DeviceModel::preset("touch").unwrap();
    let mut device = SimulatedDevice::new(model.clone(), Hand::light(), [0.0; 3], 1);
    for _ in 0..3_000 {
        device.advance(Goal::at([0.02, -0.01, 0.005]), [0.0; 3], 1e-3);
    }
    assert_eq!(device.true_velocity(), [0.0; 3]);
    let gap = v3::norm(v3::sub(device.true_position(), [0.02, -0.01, 0.005]));
    assert!(gap <= model.coulomb_n / 100.0 && gap > 0.0, "{gap}");
}

#[test]
fn the_amplifier_answers_at_its_bandwidth() {
    let model = DeviceModel {
        bandwidth_hz: 100.0,
        damping_n_s_m: 0.0,
        ..ideal()
    };
    let mut device = alone(model);
    for k in 1..=20 {
        device.advance(Goal::at([0.0; 3]), [1.0, 0.0, 0.0], 1e-3);
        // v = (F/m) (t − τ (1 − e^{−t/τ})): the mean of each substep is exact, so is the velocity.
        let (t, tau) = (f64::from(k) * 1e-3, 1.0 / (TAU * 100.0));
        let exact = (t - tau * (1.0 - (-t / tau).exp())) / 0.1;
        assert!((device.true_velocity()[0] - exact).abs() < 1e-14, "{k}");
    }
}

#[test]
fn what_is_not_finite_pushes_nothing() {
    let mut left = SimulatedDevice::new(ideal(), Hand::relaxed(), [0.0; 3], 1);
    let mut pushed = left.clone();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        left.advance(Goal::at([0.01; 3]), [0.0; 3], 1e-3);
        pushed.advance_with_torque(Goal::at([0.01; 3]), [bad, 1.0, 0.0], [bad, 0.0, 0.0], 1e-3);
        assert_eq!(left, pushed);
    }
}

/// Pushed about at random, with friction, lag, tremor and a grip that changes.
#[test]
fn the_books_of_energy_balance() {
    for (name, hand) in [
        ("ideal", Hand::relaxed()),
        ("touch", Hand::light()),
        ("omega.7", Hand::firm()),
        ("virtuose-6d", Hand::light()),
    ] {
        let grip = vec![
            super::super::Grip {
                time_s: 0.5,
                factor: 0.3,
            },
            super::super::Grip {
                time_s: 1.5,
                factor: 3.0,
            },
        ];
        let hand = Hand {
            tremor_m: 1e-3,
            grip,
            ..hand
        };
        let mut device = SimulatedDevice::new(
            DeviceModel::preset(name).unwrap(),
            hand,
            [0.1, -0.2, 0.3],
            5,
        );
        let mut random = super::super::random::Random::new(11);
        let mut loop_j = 0.0;
        for k in 0..4_000 {
            let angle = f64::from(k) * 5e-3;
            let goal = Goal::moving(
                [
                    0.1 + 0.02 * libm::sin(angle),
                    -0.2,
                    0.3 + 0.01 * libm::sin(2.0 * angle),
                ],
                [0.1 * libm::cos(angle), 0.0, 0.1 * libm::cos(2.0 * angle)],
            );
            let force = [0; 3].map(|_| 6.0 * random.uniform() - 3.0);
            let before = device.true_position();
            device.advance(goal, force, 1e-3);
            loop_j -= v3::dot(device.applied_n(), v3::sub(device.true_position(), before));
            let e = device.energy();
            let gap = e.hand_j - e.loop_j - e.viscous_j - e.coulomb_j - e.kinetic_j;
            let size = e.hand_j.abs() + e.viscous_j + e.coulomb_j + e.loop_j.abs();
            assert!(gap.abs() <= 1e-9 * size, "{name} at {k}: {gap} J of {e:?}");
            assert!(e.viscous_j >= 0.0 && e.coulomb_j >= 0.0);
        }
        // Without a lag the held force's work is force times way.
        if name == "ideal" {
            assert!((device.energy().loop_j - loop_j).abs() < 1e-12 * loop_j.abs().max(1e-3));
        }
    }
}

#[test]
fn the_pose_is_what_the_encoder_sees() {
    let model = DeviceModel::preset("touch").unwrap();
    let quantum = model.encoder_m;
    let mut device = SimulatedDevice::new(model, Hand::relaxed(), [0.05, 0.0, 0.1], 1);
    for k in 1..=500 {
        device.advance(Goal::at([0.06, 0.003, 0.1]), [0.0; 3], 1e-3);
        let pose = device.pose();
        assert_eq!(pose.t_client_ns, k * 1_000_000);
        for c in 0..3 {
            let counts = pose.position[c] / quantum;
            assert!((counts - counts.round()).abs() < 1e-9);
            assert!(
                (pose.position[c] - device.true_position()[c]).abs() <= 0.5 * quantum * 1.000_001
            );
        }
    }
}

#[test]
fn the_seed_decides_the_tremor_to_the_bit() {
    let walk = |seed| {
        let hand = Hand {
            tremor_m: 1e-3,
            ..Hand::relaxed()
        };
        let mut device = SimulatedDevice::new(
            DeviceModel::preset("touch-x").unwrap(),
            hand,
            [0.0; 3],
            seed,
        );
        (0..300).for_each(|_| device.advance(Goal::at([0.0; 3]), [0.0; 3], 1e-3));
        device.true_position().map(f64::to_bits)
    };
    assert_eq!(walk(7), walk(7));
    assert_ne!(walk(7), walk(8));
}
