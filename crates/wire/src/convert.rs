//! Tick records to Protobuf and back, bit for bit.

use palpate_geometry::math::{Point3, Rotation, Vector3, first_outside};
use palpate_proto::recording as pb;
use palpate_sim::haptics::{DeviceBounds, DevicePose};
use palpate_sim::scene::spec::MAX_TOOLS;
use palpate_sim::solve::rows::Holder;
use palpate_sim::tick::quality;
use palpate_sim::tick::record::{Command, ContactReport, TickFault, TickRecord, ToolOutput};
use palpate_sim::tick::stage::StageTimes;

/// A message that does not hold what its type promises.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("tick {tick}: {what}")]
pub struct ConvertError {
    /// Tick.
    pub tick: u64,
    /// What is missing.
    pub what: String,
}

fn extend(values: &mut Vec<f64>, parts: &[&[f64]]) {
    parts.iter().for_each(|part| values.extend_from_slice(part));
}

/// Position, orientation, linear and angular velocity.
pub fn pose_values(pose: &DevicePose) -> [f64; 13] {
    let mut values = [0.0; 13];
    let parts = [
        pose.position.coords.as_slice(),
        pose.orientation.coords.as_slice(),
        pose.linear_velocity.as_slice(),
        pose.angular_velocity.as_slice(),
    ];
    let parts = parts.into_iter().flatten();
    values.iter_mut().zip(parts).for_each(|(to, x)| *to = *x);
    values
}

/// The pose of [`pose_values`] again.
pub fn pose_from_values(
    seq: u64,
    t_client_ns: u64,
    buttons: u32,
    values: &[f64; 13],
) -> DevicePose {
    let mut values = Floats { rest: values };
    DevicePose {
        seq,
        t_client_ns,
        position: values.point(),
        orientation: values.rotation(),
        linear_velocity: values.vector(),
        angular_velocity: values.vector(),
        buttons,
    }
}

fn pose_to_proto(pose: &DevicePose) -> pb::Pose {
    pb::Pose {
        seq: pose.seq,
        t_client_ns: pose.t_client_ns,
        values: pose_values(pose).to_vec(),
        buttons: pose.buttons,
    }
}

/// Numbers of a tool in a tick.
const TOOL_VALUES: usize = 22;

/// Reads fixed groups of floats one after another.
struct Floats<'a> {
    rest: &'a [f64],
}

impl<'a> Floats<'a> {
    fn new(
        tick: u64,
        what: &'static str,
        values: &'a [f64],
        len: usize,
    ) -> Result<Self, ConvertError> {
        if values.len() == len {
            Ok(Self { rest: values })
        } else {
            Err(ConvertError {
                tick,
                what: format!("{what} has {} values, not {len}", values.len()),
            })
        }
    }

    fn take<const N: usize>(&mut self) -> [f64; N] {
        let (head, rest) = self.rest.split_at(N);
        self.rest = rest;
        head.try_into().expect("split at N")
    }

    fn vector(&mut self) -> Vector3 {
        Vector3::from(self.take::<3>())
    }

    fn point(&mut self) -> Point3 {
        Point3::from(self.take::<3>())
    }

    /// As saved: normalising again would change the last bit.
    fn rotation(&mut self) -> Rotation {
        Rotation::new_unchecked(nalgebra::Quaternion::from(nalgebra::Vector4::from(
            self.take::<4>(),
        )))
    }
}

fn pose_from_proto(tick: u64, pose: &pb::Pose) -> Result<DevicePose, ConvertError> {
    let values = Floats::new(tick, "pose", &pose.values, 13)?.take();
    Ok(pose_from_values(
        pose.seq,
        pose.t_client_ns,
        pose.buttons,
        &values,
    ))
}

/// A record of a scene with `tool_count` tools.
pub fn tick_to_proto(record: &TickRecord, tool_count: usize) -> pb::Tick {
    let output = &record.output;
    let tools = output.tools.first(tool_count).enumerate().map(|(t, out)| {
        let mut values = Vec::with_capacity(TOOL_VALUES);
        extend(
            &mut values,
            &[
                out.force_n.as_slice(),
                out.torque_nm.as_slice(),
                out.proxy_position.coords.as_slice(),
                out.proxy_orientation.coords.as_slice(),
                out.contact_force_n.as_slice(),
                out.contact_torque_nm.as_slice(),
                &[out.energy_j, out.dissipated_j, out.error_n],
            ],
        );
        let contact = out.contact.map(|contact| {
            let mut values = Vec::with_capacity(12);
            extend(
                &mut values,
                &[
                    &[contact.u, contact.v],
                    contact.point.coords.as_slice(),
                    contact.normal.as_slice(),
                    &[contact.depth_m],
                    contact.force_n.as_slice(),
                ],
            );
            pb::Contact {
                body: contact.body,
                values,
            }
        });
        pb::Tool {
            applied: record.input.poses[t].as_ref().map(pose_to_proto),
            pose_seq: out.pose_seq,
            t_client_ns: out.t_client_ns,
            pose_age_ticks: out.pose_age_ticks,
            flags: out.flags,
            contact_count: out.contact_count,
            values,
            contact,
        }
    });
    pb::Tick {
        tick: output.tick,
        tools: tools.collect(),
        state_hash: output.state_hash,
        net_revision: output.net_revision,
        fault: match output.fault {
            None => 0,
            Some(TickFault::NotFinite) => 1,
            Some(TickFault::CameApart { body }) => body.saturating_add(2),
        },
        moving: output.moving,
        quality: u32::from(output.quality),
        late_ns: record.late_ns,
        skipped: record.input.skipped,
        stage_ns: record.stage_ns.values().to_vec(),
        shift_ns: record.shift_ns,
        wait_ns: record.wait_ns,
    }
}

/// The record again.
///
/// # Errors
/// Groups of values with the wrong length, or more tools than a record holds.
pub fn tick_from_proto(tick: &pb::Tick) -> Result<TickRecord, ConvertError> {
    let number = tick.tick;
    let wrong = |what: String| ConvertError { tick: number, what };
    if tick.tools.len() > MAX_TOOLS {
        return Err(wrong(format!(
            "{} tools; a scene has at most {MAX_TOOLS}",
            tick.tools.len()
        )));
    }
    let mut record = TickRecord {
        late_ns: tick.late_ns,
        shift_ns: tick.shift_ns,
        wait_ns: tick.wait_ns,
        stage_ns: StageTimes::from_recorded(&tick.stage_ns),
        ..TickRecord::for_tools(tick.tools.len())
    };
    record.input.skipped = tick.skipped;
    let output = &mut record.output;
    (
        output.tick,
        output.state_hash,
        output.net_revision,
        output.moving,
    ) = (number, tick.state_hash, tick.net_revision, tick.moving);
    output.fault = match tick.fault {
        0 => None,
        1 => Some(TickFault::NotFinite),
        more => Some(TickFault::CameApart { body: more - 2 }),
    };
    output.quality = level(number, tick.quality)?;
    for (t, tool) in tick.tools.iter().enumerate() {
        record.input.poses[t] = tool
            .applied
            .as_ref()
            .map(|pose| pose_from_proto(number, pose))
            .transpose()?;
        // Older files end before it.
        let error_n = match tool.values.get(TOOL_VALUES - 1) {
            Some(error_n) => *error_n,
            None => f64::NAN,
        };
        let count = TOOL_VALUES - usize::from(tool.values.len() < TOOL_VALUES);
        let mut values = Floats::new(number, "tool", &tool.values, count)?;
        let contact = tool.contact.as_ref().map(|contact| {
            let mut values = Floats::new(number, "contact", &contact.values, 12)?;
            let [u, v] = values.take();
            Ok(ContactReport {
                body: contact.body,
                holder: Holder::Tool(t as u32),
                u,
                v,
                point: values.point(),
                normal: values.vector(),
                depth_m: values.take::<1>()[0],
                force_n: values.vector(),
            })
        });
        output.tools[t] = ToolOutput {
            pose_seq: tool.pose_seq,
            t_client_ns: tool.t_client_ns,
            pose_age_ticks: tool.pose_age_ticks,
            force_n: values.vector(),
            torque_nm: values.vector(),
            proxy_position: values.point(),
            proxy_orientation: values.rotation(),
            flags: tool.flags,
            contact_count: tool.contact_count,
            contact: contact.transpose()?,
            contact_force_n: values.vector(),
            contact_torque_nm: values.vector(),
            energy_j: values.take::<1>()[0],
            dissipated_j: values.take::<1>()[0],
            error_n,
            // They follow from the poses; a replay makes them again.
            device_moved: Vector3::zeros(),
            device_turned: Vector3::zeros(),
        };
    }
    Ok(record)
}

fn level(tick: u64, level: u32) -> Result<u8, ConvertError> {
    let known = u8::try_from(level)
        .ok()
        .filter(|level| *level <= quality::LOWEST);
    known.ok_or_else(|| ConvertError {
        tick,
        what: format!("unknown level of quality {level}"),
    })
}

fn bounds(command: &pb::Command) -> Result<DeviceBounds, ConvertError> {
    let found = match command.bounds[..] {
        [force_max_n, torque_max_nm, stiffness_max_n_m] => DeviceBounds {
            force_max_n,
            torque_max_nm,
            stiffness_max_n_m,
        }
        .checked(),
        _ => None,
    };
    found.ok_or_else(|| {
        let what = format!("{:?} are not valid device bounds", command.bounds);
        ConvertError {
            tick: command.after_tick,
            what,
        }
    })
}

/// A body that is sent to a place, `bounds` being x y z and a unit quaternion x y z w.
fn sent(command: &pb::Command) -> Result<Command, ConvertError> {
    let wrong = || ConvertError {
        tick: command.after_tick,
        what: format!("{:?} is not a place of a body", command.bounds),
    };
    let [x, y, z, i, j, k, w] = command.bounds[..] else {
        return Err(wrong());
    };
    let turned = nalgebra::Quaternion::new(w, i, j, k);
    let unit = (turned.norm() - 1.0).abs() < 1e-6;
    let position = Point3::new(x, y, z);
    if !unit || first_outside(&[position]).is_some() {
        return Err(wrong());
    }
    Ok(Command::Send {
        body: command.tool,
        position,
        rotation: Rotation::new_unchecked(turned),
        ticks: command.ticks,
    })
}

/// A command with the tick after which it acts.
pub fn command_to_proto(after_tick: u64, command: Command) -> pb::Command {
    let (mut device, mut values) = (0, Vec::new());
    let (name, ticks) = match command {
        Command::Device { tool, bounds } => {
            (device, values) = (
                tool,
                vec![
                    bounds.force_max_n,
                    bounds.torque_max_nm,
                    bounds.stiffness_max_n_m,
                ],
            );
            ("device", 0)
        }
        Command::Reset => ("reset", 0),
        Command::Pause => ("pause", 0),
        Command::Resume => ("resume", 0),
        Command::Step(ticks) => ("step", ticks),
        Command::Stop => ("stop", 0),
        Command::Quality(level) => ("quality", u32::from(level)),
        Command::PutOff { body } => {
            device = body;
            ("put_off", 0)
        }
        Command::Send {
            body,
            position: p,
            rotation: q,
            ticks,
        } => {
            (device, values) = (body, vec![p.x, p.y, p.z, q.i, q.j, q.k, q.w]);
            ("move_body", ticks)
        }
    };
    pb::Command {
        after_tick,
        name: name.into(),
        ticks,
        tool: device,
        bounds: values,
    }
}

/// The command again.
///
/// # Errors
/// An unknown name, or a level of quality that there is not.
pub fn command_from_proto(command: &pb::Command) -> Result<Command, ConvertError> {
    Ok(match command.name.as_str() {
        "reset" => Command::Reset,
        "pause" => Command::Pause,
        "resume" => Command::Resume,
        "step" => Command::Step(command.ticks),
        "stop" => Command::Stop,
        "device" => Command::Device {
            tool: command.tool,
            bounds: bounds(command)?,
        },
        "quality" => Command::Quality(level(command.after_tick, command.ticks)?),
        "put_off" => Command::PutOff { body: command.tool },
        "move_body" => sent(command)?,
        other => {
            return Err(ConvertError {
                tick: command.after_tick,
                what: format!("unknown command {other:?}"),
            });
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use prost::Message as _;

    #[test]
    fn every_bit_of_every_float_survives_the_file() {
        let special = [
            0.0,
            -0.0,
            1.0 / 3.0,
            f64::MIN_POSITIVE / 8.0,
            f64::MAX,
            f64::INFINITY,
            f64::from_bits(0x7ff8_dead_beef_0001),
        ];
        for value in special {
            let vector = Vector3::new(value, -value, 1.0);
            let rotation =
                Rotation::new_unchecked(nalgebra::Quaternion::new(1.0, value, -0.0, 0.0));
            let mut record = TickRecord::default();
            record.input.poses[1] = Some(DevicePose {
                seq: u64::MAX,
                t_client_ns: 7,
                position: Point3::from(vector),
                orientation: rotation,
                linear_velocity: vector,
                angular_velocity: -vector,
                buttons: 3,
            });
            record.output.tick = 9;
            (record.output.state_hash, record.output.quality) = (u64::MAX - 1, 2);
            let tool = &mut record.output.tools[1];
            (tool.force_n, tool.torque_nm, tool.energy_j) = (vector, -vector, value);
            tool.proxy_orientation = rotation;
            tool.contact = Some(ContactReport {
                body: 4,
                holder: Holder::Tool(1),
                u: value,
                v: 0.5,
                point: Point3::from(vector),
                normal: vector,
                depth_m: -value,
                force_n: -vector,
            });
            let bytes = tick_to_proto(&record, 2).encode_to_vec();
            let back = tick_from_proto(&pb::Tick::decode(&bytes[..]).unwrap()).unwrap();
            // Equality of floats would not tell -0.0 from 0.0; the debug text and the bytes of a
            // second trip do.
            assert_eq!(tick_to_proto(&back, 2).encode_to_vec(), bytes);
            let bits = |record: &TickRecord| {
                let tool = &record.output.tools[1];
                [
                    tool.force_n.x,
                    tool.force_n.y,
                    tool.energy_j,
                    tool.contact.unwrap().depth_m,
                ]
                .map(f64::to_bits)
            };
            assert_eq!(bits(&back), bits(&record));
        }
    }

    #[test]
    fn messages_of_the_wrong_shape_are_refused() {
        let mut tick = tick_to_proto(&TickRecord::default(), 1);
        // Recordings without errors of forces have one value less.
        tick.tools[0].values.truncate(TOOL_VALUES - 2);
        assert!(
            tick_from_proto(&tick)
                .unwrap_err()
                .what
                .contains("20 values, not 21")
        );
        let crowd = pb::Tick {
            tools: vec![tick.tools[0].clone(); MAX_TOOLS + 1],
            ..tick
        };
        assert!(tick_from_proto(&crowd).is_err());
        let poor = pb::Tick {
            quality: 4,
            ..tick_to_proto(&TickRecord::default(), 1)
        };
        assert!(
            tick_from_proto(&poor)
                .unwrap_err()
                .what
                .contains("quality 4")
        );
        let bounds = DeviceBounds {
            force_max_n: 3.3,
            torque_max_nm: 0.0,
            stiffness_max_n_m: f64::INFINITY,
        };
        let device = Command::Device { tool: 2, bounds };
        for command in [
            Command::Reset,
            Command::Step(7),
            Command::Stop,
            Command::Quality(3),
            Command::PutOff { body: 2 },
            device,
            Command::Send {
                body: 3,
                position: Point3::new(0.1, -0.2, 1.0 / 3.0),
                rotation: Rotation::new_unchecked(nalgebra::Quaternion::new(0.6, 0.0, 0.8, 0.0)),
                ticks: 250,
            },
        ] {
            assert_eq!(
                command_from_proto(&command_to_proto(5, command)),
                Ok(command)
            );
        }
        let worse = pb::Command {
            after_tick: 5,
            name: "quality".into(),
            ticks: 260,
            ..Default::default()
        };
        assert!(command_from_proto(&worse).is_err());
        for bounds in [
            vec![0.0; 7],
            vec![0.0; 6],
            vec![f64::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        ] {
            let nowhere = pb::Command {
                name: "move_body".into(),
                bounds,
                ..worse.clone()
            };
            assert!(command_from_proto(&nowhere).is_err());
        }
    }
}
