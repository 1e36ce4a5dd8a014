//! The only place where domain types meet palpate-proto.

mod convert;
mod inside;
mod outlines;

pub use convert::{
    ConvertError, command_from_proto, command_to_proto, pose_from_values, pose_values,
    tick_from_proto, tick_to_proto,
};
pub use inside::{bodies_inside, is_nodes_key, nodes_key, nodes_payload};
pub use outlines::{first_snapshot, tool_outlines};

use palpate_geometry::basis::KnotVector;
use palpate_geometry::contact::ToolShape;
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_geometry::surface::Surface;
use palpate_proto::messages as wire;
use palpate_sim::haptics::{DeviceBounds, DeviceFigures, DevicePose};
use palpate_sim::scene::Scene;
use palpate_sim::solve::rows::Holder;
use palpate_sim::tick::SceneState;
use palpate_sim::tick::record::{TickOutput, ToolOutput};

fn xyzw(rotation: &Rotation) -> [f64; 4] {
    rotation.coords.into()
}

fn xyz(point: &Point3) -> [f64; 3] {
    point.coords.into()
}

/// A validated pose as the loop takes it.
pub fn device_pose(pose: &wire::ToolPose) -> DevicePose {
    let [x, y, z, w] = pose.orientation;
    DevicePose {
        seq: pose.seq,
        t_client_ns: pose.t_client_ns,
        position: Point3::from(pose.position),
        // `validated` brought it to unit length.
        orientation: Rotation::new_unchecked(nalgebra::Quaternion::new(w, x, y, z)),
        linear_velocity: Vector3::from(pose.linear_velocity),
        angular_velocity: Vector3::from(pose.angular_velocity),
        buttons: pose.buttons,
    }
}

/// A tool's force message.
pub fn tool_force(tick: u64, t_server_ns: u64, tool: &ToolOutput) -> wire::ToolForce {
    wire::ToolForce {
        tick,
        pose_seq: tool.pose_seq,
        t_client_ns: tool.t_client_ns,
        t_server_ns,
        force: tool.force_n.into(),
        torque: tool.torque_nm.into(),
        proxy_position: xyz(&tool.proxy_position),
        proxy_orientation: xyzw(&tool.proxy_orientation),
        depth: tool.contact.map_or(0.0, |contact| contact.depth_m),
        contact_count: tool.contact_count.min(u32::from(u16::MAX)) as u16,
        flags: tool.flags,
    }
}

/// The same with how far it may be off.
pub fn tool_force_v2(force: &wire::ToolForce, error_n: f64) -> wire::ToolForceV2 {
    let wire::ToolForce {
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
    } = *force;
    wire::ToolForceV2 {
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
        error_n,
        jaw_force: 0.0,
    }
}

/// What contacts do to a tool; `force_limit_n` is the greatest force for its device.
pub fn tool_contact(tick: u64, force_limit_n: f64, tool: &ToolOutput) -> wire::ToolContact {
    wire::ToolContact {
        tick,
        pose_seq: tool.pose_seq,
        t_client_ns: tool.t_client_ns,
        force: tool.contact_force_n.into(),
        torque: tool.contact_torque_nm.into(),
        energy_j: tool.energy_j,
        dissipated_j: tool.dissipated_j,
        force_limit: force_limit_n,
    }
}

/// What a device reported, as far as it decides how stiff it may be coupled. A pose and its force both
/// take the delay.
pub fn device_figures(info: &wire::DeviceInfo) -> DeviceFigures {
    DeviceFigures {
        damping_n_s_m: info.damping,
        coulomb_n: info.coulomb_friction,
        encoder_m: info.encoder_resolution,
        period_s: if info.rate_hz > 0.0 {
            1.0 / info.rate_hz
        } else {
            0.0
        },
        delay_s: 2.0 * info.delay_s,
    }
}

/// What the loop may do with a device that reported itself so.
pub fn device_bounds(scene: &Scene, tool: usize, info: &wire::DeviceInfo) -> DeviceBounds {
    // A device that pushes and does not twist has no use for torque. Without any motor both are looked at only.
    let torque_max_nm = match info.dof_torque {
        0 if info.has_motors() => 0.0,
        _ => info.torque_max,
    };
    DeviceBounds {
        force_max_n: info.force_max,
        torque_max_nm,
        ..scene.bounds_of(tool, &device_figures(info))
    }
}

/// All contacts of a tick, deepest first.
pub fn contact_set(scene: &Scene, output: &TickOutput) -> wire::ContactSet {
    let contacts = output.contacts.list().iter().map(|contact| wire::Contact {
        tool: match contact.holder {
            Holder::Tool(tool) => scene.tool_id(tool as usize).to_owned(),
            Holder::Body(body) => scene.body_id(body as usize).to_owned(),
        },
        body: scene.body_id(contact.body as usize).to_owned(),
        u: contact.u,
        v: contact.v,
        point: xyz(&contact.point),
        normal: contact.normal.into(),
        depth: contact.depth_m,
        force: contact.force_n.into(),
    });
    wire::ContactSet {
        tick: output.tick,
        contacts: contacts.collect(),
    }
}

/// A net message.
pub fn control_net(
    scene: &Scene,
    body: usize,
    tick: u64,
    revision: u64,
    points: &[Point3],
) -> wire::ControlNet {
    let ([degree_u, degree_v], [count_u, count_v]) = scene.net_size(body);
    let weights = scene.rest_surface(body).and_then(Surface::weights);
    wire::ControlNet {
        tick,
        revision,
        body: scene.body_id(body).to_owned(),
        degree_u: degree_u as u8,
        degree_v: degree_v as u8,
        count_u: count_u as u16,
        count_v: count_v as u16,
        points: points.iter().map(xyz).collect(),
        weights: weights.map(<[f64]>::to_vec),
    }
}

/// Everything a late joiner needs; `nets` are the newest nets by body, `tools` the newest outputs.
pub fn scene_snapshot(
    scene: &Scene,
    scene_hash: [u8; 32],
    nets: &[wire::ControlNet],
    output: &TickOutput,
) -> wire::SceneSnapshot {
    let bodies = (0..scene.body_count()).map(|body| {
        let knots = scene
            .rest_surface(body)
            .map(|surface| [surface.knots_u(), surface.knots_v()]);
        let net = &nets[body];
        wire::BodySnapshot {
            id: net.body.clone(),
            model: scene.model_name(body).into(),
            degree: [net.degree_u, net.degree_v],
            periodic: knots.map_or([false; 2], |knots| knots.map(KnotVector::is_periodic)),
            knots: knots.map_or_else(Default::default, |knots| {
                knots.map(|knots| knots.file_knots().to_vec())
            }),
            count: [net.count_u, net.count_v],
            points: net.points.clone(),
            rest_points: scene.skin(body).points().iter().map(xyz).collect(),
            weights: net.weights.clone(),
            revision: net.revision,
        }
    });
    let tools = (0..scene.tool_count()).map(|t| {
        let (spec, out) = (&scene.spec.tools[t], &output.tools[t]);
        wire::ToolSnapshot {
            id: scene.tool_id(t).to_owned(),
            shape: scene.tool_shape(t).name().into(),
            radius: match scene.tool_shape(t) {
                ToolShape::Sphere { radius_m } => *radius_m,
                _ => 0.0,
            },
            stiffness: spec.coupling.stiffness_n_m,
            damping: spec.coupling.damping_n_s_m,
            force_max: spec.device.force_max_n,
            position: if output.tick == 0 {
                spec.pose.position
            } else {
                xyz(&out.proxy_position)
            },
            orientation: if output.tick == 0 {
                spec.pose.orientation
            } else {
                xyzw(&out.proxy_orientation)
            },
        }
    });
    wire::SceneSnapshot {
        tick: output.tick,
        scene_hash,
        scene_name: scene.name.clone(),
        dt_ns: (scene.dt_s * 1e9).round() as u64,
        lockstep: scene.clock == palpate_sim::scene::spec::Clock::Lockstep,
        bodies: bodies.collect(),
        tools: tools.collect(),
    }
}

/// The nets of a state, as messages.
pub fn all_nets(scene: &Scene, state: &SceneState) -> Vec<wire::ControlNet> {
    (0..scene.body_count())
        .map(|body| {
            let mut points = scene.skin(body).points().to_vec();
            state.copy_net(scene, body, &mut points);
            control_net(scene, body, state.tick, state.net_revision(body), &points)
        })
        .collect()
}

/// An event as a name and words about it, as recordings keep it.
pub fn event_words(kind: &wire::EventKind) -> (&'static str, String) {
    use wire::EventKind as Kind;
    match kind {
        Kind::Reset => ("reset", String::new()),
        Kind::Paused => ("paused", String::new()),
        Kind::Resumed => ("resumed", String::new()),
        Kind::ToolJoined { tool } => ("tool_joined", tool.clone()),
        Kind::ToolLost { tool } => ("tool_lost", tool.clone()),
        Kind::ForceWithheld { tool } => ("force_withheld", tool.clone()),
        Kind::ForceDegraded { tool, reason } => ("force_degraded", format!("{tool}: {reason}")),
        Kind::ForceRestored { tool, ticks } => ("force_restored", format!("{tool}: {ticks} ticks")),
        Kind::PoseRefused { tool, reason } => ("pose_refused", format!("{tool}: {reason}")),
        Kind::Fault { reason } => ("fault", reason.clone()),
        Kind::RecordStarted { path } => ("record_started", path.clone()),
        Kind::RecordStopped { path } => ("record_stopped", path.clone()),
        Kind::Stopping => ("stopping", String::new()),
        Kind::Overrun {
            stage,
            count,
            worst_ns,
        } => (
            "overrun",
            format!("{stage}: {count} ticks, worst {worst_ns} ns"),
        ),
        Kind::QualityChanged { level, reason } => ("quality_changed", format!("{level}: {reason}")),
        Kind::DeviceTold { tool, name } => ("device_told", format!("{tool}: {name}")),
        Kind::RecordFailed { path, reason } => ("record_failed", format!("{path}: {reason}")),
        Kind::SceneChanged { what } => ("scene_changed", what.clone()),
    }
}
