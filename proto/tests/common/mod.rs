//! One value of every message, chosen so that each field differs from its neighbours. Integers stay
//! below 2^53, so that readers whose JSON numbers are doubles can check them too.

use palpate_proto::messages::*;

pub fn tool_pose() -> ToolPose {
    ToolPose {
        seq: 300,
        t_client_ns: 1_234_567_890_123,
        position: [0.125, -0.25, 0.03],
        orientation: [0.0, 0.6, 0.0, 0.8],
        linear_velocity: [0.5, -0.0, 1e-3],
        angular_velocity: [0.1, 0.2, -0.3],
        buttons: 1,
        flags: 0,
    }
}

pub fn tool_force() -> ToolForce {
    ToolForce {
        tick: 70_000,
        pose_seq: 300,
        t_client_ns: 1_234_567_890_123,
        t_server_ns: 9_876_543_210,
        force: [-1.5, 0.25, 2.0],
        torque: [0.001, -0.002, 0.003],
        proxy_position: [0.125, -0.25, 0.032],
        proxy_orientation: [0.0, 0.6, 0.0, 0.8],
        depth: 0.002,
        contact_count: 3,
        flags: force_flags::SATURATED | force_flags::RAMPING,
    }
}

pub fn tool_force_v2() -> ToolForceV2 {
    let ToolForce {
        tick,
        pose_seq,
        t_client_ns,
        t_server_ns,
        force,
        torque,
        proxy_position,
        proxy_orientation,
        depth,
        contact_count,
        flags,
    } = tool_force();
    ToolForceV2 {
        tick,
        pose_seq,
        t_client_ns,
        t_server_ns,
        force,
        torque,
        proxy_position,
        proxy_orientation,
        depth,
        contact_count,
        flags,
        error_n: 0.0625,
        jaw_force: -0.125,
    }
}

pub fn tool_contact() -> ToolContact {
    ToolContact {
        tick: 70_003,
        pose_seq: 301,
        t_client_ns: 1_234_567_890_124,
        force: [-2.5, 0.5, 3.0],
        torque: [0.004, -0.005, 0.006],
        energy_j: -0.0,
        dissipated_j: 0.0625,
        force_limit: 8.0,
    }
}

pub fn device_info() -> DeviceInfo {
    DeviceInfo {
        name: "Gerät 1".into(),
        dof_force: 3,
        dof_torque: 2,
        workspace: [0.16, 0.12, 0.07],
        force_max: 3.3,
        force_continuous: 0.88,
        torque_max: 0.0625,
        mass: 0.045,
        damping: 0.25,
        coulomb_friction: 0.26,
        encoder_resolution: 5.5e-5,
        rate_hz: 1000.0,
        delay_s: 0.0015,
        deadband: 0.1,
    }
}

pub fn control_net() -> ControlNet {
    ControlNet {
        tick: 70_000,
        revision: 41,
        body: "jelly".into(),
        degree_u: 1,
        degree_v: 2,
        count_u: 2,
        count_v: 3,
        points: (0..6)
            .map(|k| [f64::from(k) * 0.01, -f64::from(k) * 0.5, 0.1 + f64::from(k)])
            .collect(),
        weights: Some(vec![1.0, 0.5, 1.0, 1.0, 0.75, 1.0]),
    }
}

pub fn control_net_polynomial() -> ControlNet {
    ControlNet {
        weights: None,
        ..control_net()
    }
}

pub fn contact_set() -> ContactSet {
    let contact = Contact {
        tool: "pen".into(),
        body: "jelly".into(),
        u: 0.25,
        v: 0.75,
        point: [0.1, 0.2, 0.3],
        normal: [0.0, 0.0, 1.0],
        depth: 0.0015,
        force: [0.0, 0.5, 1.25],
    };
    let other = Contact {
        tool: "thumb".into(),
        u: 0.5,
        depth: 0.0005,
        ..contact.clone()
    };
    ContactSet {
        tick: 70_001,
        contacts: vec![contact, other],
    }
}

pub fn loop_status() -> LoopStatus {
    LoopStatus {
        tick: 70_002,
        state: LoopState::Paused,
        rate_hz: 1000.0,
        late_ticks: 12,
        skipped_ticks: 3,
        period: Quantiles {
            p50_ns: 1_000_000,
            p99_ns: 1_050_000,
            max_ns: 2_300_000,
        },
        step: Quantiles {
            p50_ns: 310_000,
            p99_ns: 520_000,
            max_ns: 900_000,
        },
        tools: vec![ToolLink {
            tool: "pen".into(),
            received: 69_000,
            superseded: 120,
            wrong_version: 3,
            malformed: 4,
            oversized: 5,
            not_finite: 6,
            bad_quaternion: 7,
            duplicated: 8,
            out_of_order: 9,
            jumps: 10,
            stale_ticks: 188,
            energy_j: -0.0125,
            forces_sent: 68_000,
            forces_overtaken: 13,
            forces_lost: 14,
        }],
        recorder: RecorderState::Ring,
        recorder_bytes: 12_345_678,
        recorder_drops: 1,
        quality_level: 2,
        followed_tool: "pen".into(),
        shift_s: -2.5e-4,
        wait: Quantiles {
            p50_ns: 12_000,
            p99_ns: 80_000,
            max_ns: 410_000,
        },
    }
}

pub fn events() -> Vec<(&'static str, SimEvent)> {
    let tool = || "pen".to_owned();
    let kinds = [
        ("reset", EventKind::Reset),
        ("paused", EventKind::Paused),
        ("resumed", EventKind::Resumed),
        ("tool_joined", EventKind::ToolJoined { tool: tool() }),
        ("tool_lost", EventKind::ToolLost { tool: tool() }),
        (
            "pose_refused",
            EventKind::PoseRefused {
                tool: tool(),
                reason: "12.5 m/s is a jump ±".into(),
            },
        ),
        (
            "fault",
            EventKind::Fault {
                reason: "force not finite".into(),
            },
        ),
        (
            "record_started",
            EventKind::RecordStarted {
                path: "run.mcap".into(),
            },
        ),
        (
            "record_stopped",
            EventKind::RecordStopped {
                path: "run.mcap".into(),
            },
        ),
        ("stopping", EventKind::Stopping),
        (
            "overrun",
            EventKind::Overrun {
                stage: "deform".into(),
                count: 400,
                worst_ns: 1_750_000,
            },
        ),
        (
            "quality_changed",
            EventKind::QualityChanged {
                level: 2,
                reason: "deform took too long".into(),
            },
        ),
        (
            "device_told",
            EventKind::DeviceTold {
                tool: tool(),
                name: device_info().name,
            },
        ),
        (
            "record_failed",
            EventKind::RecordFailed {
                path: "run.mcap".into(),
                reason: "no space left on device".into(),
            },
        ),
        (
            "scene_changed",
            EventKind::SceneChanged {
                what: "a and b are one body, a-b".into(),
            },
        ),
        ("force_withheld", EventKind::ForceWithheld { tool: tool() }),
        (
            "force_degraded",
            EventKind::ForceDegraded {
                tool: tool(),
                reason: "quality is lowered".into(),
            },
        ),
        (
            "force_restored",
            EventKind::ForceRestored {
                tool: tool(),
                ticks: 120,
            },
        ),
    ];
    let event = |k: usize, kind| SimEvent {
        tick: 500,
        seq: k as u64 + 1,
        t_ns: 1_700_000_000_123,
        kind,
    };
    kinds
        .into_iter()
        .enumerate()
        .map(|(k, (name, kind))| (name, event(k, kind)))
        .collect()
}

pub fn scene_snapshot() -> SceneSnapshot {
    SceneSnapshot {
        tick: 70_000,
        scene_hash: std::array::from_fn(|k| (k * 7) as u8),
        scene_name: "teardrop".into(),
        dt_ns: 1_000_000,
        lockstep: true,
        bodies: vec![BodySnapshot {
            id: "jelly".into(),
            model: "lattice".into(),
            degree: [1, 2],
            periodic: [false, true],
            knots: [vec![0.0, 0.0, 1.0, 1.0], vec![0.0, 0.25, 0.5, 1.0]],
            count: [2, 3],
            points: control_net().points,
            rest_points: (0..6).map(|k| [f64::from(k), 0.0, 1.0]).collect(),
            weights: None,
            revision: 41,
        }],
        tools: vec![ToolSnapshot {
            id: "pen".into(),
            shape: "sphere".into(),
            radius: 0.01,
            stiffness: 1000.0,
            damping: 1.5,
            force_max: 10.0,
            position: [0.2, 0.0, 0.1],
            orientation: [0.0, 0.0, 0.0, 1.0],
        }],
    }
}
