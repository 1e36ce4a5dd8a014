use super::*;

const MS: u64 = 1_000_000;

fn reading(k: u64, position: [f64; 3], buttons: u32) -> Reading {
    Reading {
        position,
        orientation: [0.0, 0.0, 0.0, 1.0],
        velocity: None,
        buttons,
        time_ns: k * MS,
    }
}

fn answer(tick: u64, force: [f64; 3]) -> ToolAnswer {
    ToolAnswer {
        tick,
        force,
        torque: [0.0; 3],
        time_ns: tick * MS,
        stale: false,
        paused: false,
        fault: false,
        silent: false,
    }
}

fn with_clutch() -> Coupler {
    Coupler::new(CouplerSettings {
        clutch_button: Some(1),
        ..CouplerSettings::default()
    })
}

#[test]
fn a_clutch_pressed_in_contact_neither_moves_the_tool_nor_steps_the_force() {
    let mut coupler = with_clutch();
    // A wall: 1000 N/m below z = 0. The hand presses 4 mm deep, presses the clutch, draws back 50 mm,
    // releases and goes on from there.
    let wall = |z: f64| 1_000.0 * (-z).max(0.0);
    let (mut last_force, mut last_z, mut largest) = (0.0, -0.004_f64, 0.0_f64);
    let mut least = f64::INFINITY;
    for k in 1..=3_000_u64 {
        let clutched = (1_000..2_000).contains(&k);
        let z = match k {
            0..1_000 => -0.004,
            1_000..2_000 => -0.004 + 0.05 * (k - 1_000) as f64 / 1_000.0,
            _ => 0.046,
        };
        let motion = coupler
            .motion(&reading(k, [0.0, 0.0, z], u32::from(clutched) << 1))
            .unwrap();
        assert!(
            (motion.position[2] - last_z).abs() < 1e-4,
            "{k}: the tool jumped"
        );
        if clutched {
            assert_eq!(motion.linear_velocity, [0.0; 3]);
        }
        last_z = motion.position[2];
        let command = coupler.command(&answer(k, [0.0, 0.0, wall(last_z)]));
        let force = command.force[2];
        if k > 1 {
            largest = largest.max((force - last_force).abs());
        }
        if k == 1_990 {
            least = force;
        }
        last_force = force;
    }
    assert_eq!(least, 0.0, "the clutched hand is free");
    assert!((last_force - 4.0).abs() < 0.1, "{last_force}");
    assert!(largest <= 0.041 + 1e-9, "a step of {largest} N");
}

#[test]
fn a_clutch_keeps_the_orientation_too() {
    let mut coupler = with_clutch();
    let turned = |angle: f64| [0.0, 0.0, (0.5 * angle).sin(), (0.5 * angle).cos()];
    let mut at = |k, angle, buttons| {
        let reading = Reading {
            orientation: turned(angle),
            ..reading(k, [0.0; 3], buttons)
        };
        coupler.motion(&reading).unwrap().orientation
    };
    let before = at(1, 0.3, 0);
    assert_eq!(at(2, 0.4, 2), before);
    assert_eq!(at(3, 1.0, 2), before);
    let after = at(4, 1.0, 0);
    assert!(before.iter().zip(after).all(|(a, b)| (a - b).abs() < 1e-12));
    let on = at(5, 1.1, 0);
    assert!((on[2] - turned(0.4)[2]).abs() < 1e-12, "{on:?}");
}

#[test]
fn readings_that_are_not_finite_or_no_rotation_are_counted_and_left() {
    let mut coupler = Coupler::new(CouplerSettings::default());
    let good = reading(1, [0.0; 3], 0);
    let bad = [
        Reading {
            position: [f64::NAN, 0.0, 0.0],
            ..good
        },
        Reading {
            position: [0.0, f64::INFINITY, 0.0],
            ..good
        },
        Reading {
            orientation: [0.0; 4],
            ..good
        },
        Reading {
            orientation: [1.0; 4],
            ..good
        },
        Reading {
            velocity: Some([[f64::NAN; 3]; 2]),
            ..good
        },
    ];
    for reading in &bad {
        assert!(coupler.motion(reading).is_none());
    }
    assert_eq!(coupler.refused(), bad.len() as u64);
    assert!(coupler.motion(&good).is_some());
}

#[test]
fn stale_fault_and_silence_are_zero_at_once_and_a_pause_fades() {
    let mut coupler = Coupler::new(CouplerSettings::default());
    let pressing = answer(1, [0.0, 0.0, 3.0]);
    assert_eq!(coupler.command(&pressing).force, [0.0, 0.0, 3.0]);
    let told = [
        (
            ToolAnswer {
                stale: true,
                ..pressing
            },
            Rest::Stale,
        ),
        (
            ToolAnswer {
                fault: true,
                ..pressing
            },
            Rest::Fault,
        ),
        (
            ToolAnswer {
                silent: true,
                ..pressing
            },
            Rest::Silent,
        ),
    ];
    for (answer, why) in told {
        let command = coupler.command(&answer);
        assert_eq!(
            (command.force, command.state),
            ([0.0; 3], State::Resting(why))
        );
    }
    // Silence ends with another force: how it comes back is not known here.
    assert_eq!(coupler.command(&pressing).state, State::Active);
    let mut last = 3.0;
    for tick in 2..=101 {
        let paused = ToolAnswer {
            paused: true,
            ..answer(tick, [0.0, 0.0, 3.0])
        };
        let command = coupler.command(&paused);
        assert!(last - command.force[2] < 0.031, "{tick}");
        last = command.force[2];
        if tick == 101 {
            assert_eq!(command.state, State::Resting(Rest::Paused));
        }
    }
    assert_eq!(last, 0.0);
}

#[test]
fn without_clutch_frame_or_cap_every_bit_passes() {
    let mut coupler = Coupler::new(CouplerSettings::default());
    let odd = Reading {
        velocity: Some([[-0.0, 0.1 + 0.2, 1e-300], [0.3; 3]]),
        orientation: [0.0, 0.6, 0.0, 0.8],
        ..reading(1, [-0.0, 0.1, 1e-9], 1)
    };
    let motion = coupler.motion(&odd).unwrap();
    assert_eq!(
        motion.position.map(f64::to_bits),
        odd.position.map(f64::to_bits)
    );
    assert_eq!(motion.orientation, odd.orientation);
    assert_eq!(
        motion.linear_velocity.map(f64::to_bits),
        [-0.0, 0.1 + 0.2, 1e-300_f64].map(f64::to_bits)
    );
    assert_eq!(motion.buttons, 1);
    let force = [-0.0, 0.1 + 0.2, 1e-12];
    let command = coupler.command(&answer(1, force));
    assert_eq!(command.force.map(f64::to_bits), force.map(f64::to_bits));
}

#[test]
fn a_device_of_any_rate_has_the_velocity_of_its_motion() {
    for rate_hz in [100_u64, 500, 4_000] {
        let mut coupler = Coupler::new(CouplerSettings::default());
        let mut motion = None;
        for k in 0..rate_hz {
            let time_ns = k * 1_000_000_000 / rate_hz;
            let z = 0.05 - 0.02 * time_ns as f64 * 1e-9;
            motion = coupler.motion(&Reading {
                time_ns,
                ..reading(0, [0.0, 0.0, z], 0)
            });
        }
        let velocity = motion.unwrap().linear_velocity[2];
        assert!((velocity + 0.02).abs() < 1e-6, "{rate_hz} Hz: {velocity}");
    }
}
