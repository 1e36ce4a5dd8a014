//! What viewers show of a session: Foxglove messages made from ticks and nets, so often as eyes can
//! follow and only when something changed. A replay does not read them.
//!
//! | topic | message | for |
//! |---|---|---|
//! | `/view/scene` | `foxglove.SceneUpdate` | bodies, control nets, forces in a 3D panel |
//! | `/view/body/{id}/points` | `foxglove.PointCloud` | x y z and displacement, for viewers that draw no scenes |
//! | `/view/tool/{id}` | `foxglove.PoseInFrame` | the proxy of a tool |
//! | `/view/tool/{id}/shape` | `foxglove.SceneUpdate` | its shape, once, in the frame of the tool |
//! | `/tf` | `foxglove.FrameTransforms` | `world` → `tool/{id}` |
//! | `/log` | `foxglove.Log` | events, as they come |

mod draw;

use super::channel::Topic;
use super::message::Message;
use draw::{BodyShape, ToolShape};
use palpate_proto::foxglove as fox;
use palpate_proto::recording as pb;
use palpate_sim::scene::Scene;
use prost::Message as _;
use std::collections::BTreeMap;
use std::io::{Seek, Write};
use std::sync::Arc;

/// Views of one file.
#[derive(Clone)]
pub(super) struct Views {
    shapes: Arc<Shapes>,
    channels: ViewChannels,
    /// Tick of the next picture.
    next: Option<u64>,
    every: u64,
    /// By body: a net that no picture shows yet.
    nets: Vec<Option<Vec<u8>>>,
    /// By tool: what the last picture showed of it.
    tools: Vec<Vec<f64>>,
    drawn: bool,
}

struct Shapes {
    bodies: Vec<BodyShape>,
    tools: Vec<ToolShape>,
    dt_ns: u64,
}

#[derive(Clone, Default)]
struct ViewChannels {
    scene: u16,
    tf: u16,
    log: u16,
    points: Vec<u16>,
    tools: Vec<u16>,
    tool_shapes: Vec<u16>,
}

impl Views {
    /// Views of a scene, if it wants any.
    pub fn of(scene: &Scene) -> Option<Self> {
        let record = &scene.spec.record;
        if !record.views {
            return None;
        }
        let shapes = Shapes {
            bodies: (0..scene.body_count())
                .map(|body| BodyShape::of(scene, body))
                .collect(),
            tools: (0..scene.tool_count())
                .map(|tool| ToolShape::of(scene, tool))
                .collect(),
            dt_ns: (scene.dt_s * 1e9).round() as u64,
        };
        Some(Self {
            nets: vec![None; shapes.bodies.len()],
            tools: vec![Vec::new(); shapes.tools.len()],
            shapes: Arc::new(shapes),
            channels: ViewChannels::default(),
            next: None,
            every: ((1.0 / scene.dt_s / record.view_hz).round() as u64).max(1),
            drawn: false,
        })
    }

    /// The same with its channels in a file.
    pub fn declared<W: Write + Seek>(
        mut self,
        mcap: &mut mcap::Writer<W>,
    ) -> mcap::McapResult<Self> {
        let mut channel = |topic: String, message: &str| {
            let name = format!("foxglove.{message}");
            let schema = mcap.add_schema(
                &name,
                "protobuf",
                &pb::descriptors(&name).unwrap_or_default(),
            )?;
            mcap.add_channel(schema, &topic, "protobuf", &BTreeMap::new())
        };
        self.channels = ViewChannels {
            scene: channel("/view/scene".into(), "SceneUpdate")?,
            tf: channel("/tf".into(), "FrameTransforms")?,
            log: channel("/log".into(), "Log")?,
            points: self
                .shapes
                .bodies
                .iter()
                .map(|b| channel(b.topic(), "PointCloud"))
                .collect::<Result<_, _>>()?,
            tools: self
                .shapes
                .tools
                .iter()
                .map(|t| channel(t.topic(), "PoseInFrame"))
                .collect::<Result<_, _>>()?,
            tool_shapes: self
                .shapes
                .tools
                .iter()
                .map(|t| channel(t.shape_topic(), "SceneUpdate"))
                .collect::<Result<_, _>>()?,
        };
        Ok(self)
    }

    /// Takes a message of the session; what is to be shown goes to `put`, with its channel.
    pub fn show(
        &mut self,
        message: &Message,
        mut put: impl FnMut(u16, &[u8]) -> mcap::McapResult<()>,
    ) -> mcap::McapResult<()> {
        match message.topic {
            Topic::Net => self.nets[usize::from(message.body)] = Some(message.data.clone()),
            Topic::Event => {
                if let Ok(event) = pb::Event::decode(&message.data[..]) {
                    put(
                        self.channels.log,
                        &log(self.stamp(message.tick), &event).encode_to_vec(),
                    )?;
                }
            }
            // The nets of a file's start come with its first ticks.
            Topic::Tick
                if message.tick >= *self.next.get_or_insert(message.tick.saturating_add(1)) =>
            {
                self.next = Some(message.tick.saturating_add(self.every));
                if let Ok(tick) = pb::Tick::decode(&message.data[..]) {
                    self.picture(&tick, put)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn stamp(&self, tick: u64) -> fox::Timestamp {
        let ns = tick.saturating_mul(self.shapes.dt_ns);
        fox::Timestamp {
            seconds: (ns / 1_000_000_000) as i64,
            nanos: (ns % 1_000_000_000) as i32,
        }
    }

    fn picture(
        &mut self,
        tick: &pb::Tick,
        mut put: impl FnMut(u16, &[u8]) -> mcap::McapResult<()>,
    ) -> mcap::McapResult<()> {
        let stamp = self.stamp(tick.tick);
        let shapes = self.shapes.clone();
        let mut scene = fox::SceneUpdate::default();
        for (body, shape) in shapes.bodies.iter().enumerate() {
            let net = self.nets[body]
                .take()
                .and_then(|data| pb::ControlNet::decode(&data[..]).ok());
            if net.is_none() && self.drawn {
                continue;
            }
            let drawn = shape.drawn(net.as_ref().map_or(&[], |net| &net.points[..]));
            scene.entities.push(shape.entity(stamp, &drawn));
            put(
                self.channels.points[body],
                &shape.cloud(stamp, &drawn).encode_to_vec(),
            )?;
        }
        let mut transforms = fox::FrameTransforms::default();
        for (t, (shape, tool)) in shapes.tools.iter().zip(&tick.tools).enumerate() {
            if self.tools[t] == tool.values {
                continue;
            }
            self.tools[t].clone_from(&tool.values);
            let Some((position, orientation)) = shape.pose(&tool.values) else {
                continue;
            };
            scene
                .entities
                .push(shape.entity(stamp, &tool.values, position));
            transforms.transforms.push(fox::FrameTransform {
                timestamp: Some(stamp),
                parent_frame_id: "world".into(),
                child_frame_id: shape.frame(),
                translation: Some(position),
                rotation: Some(orientation),
            });
            let pose = fox::Pose {
                position: Some(position),
                orientation: Some(orientation),
            };
            let pose = fox::PoseInFrame {
                timestamp: Some(stamp),
                frame_id: "world".into(),
                pose: Some(pose),
            };
            put(self.channels.tools[t], &pose.encode_to_vec())?;
        }
        if !self.drawn {
            for (shape, &channel) in shapes.tools.iter().zip(&self.channels.tool_shapes) {
                put(channel, &shape.shape(stamp).encode_to_vec())?;
            }
        }
        self.drawn = true;
        if !transforms.transforms.is_empty() {
            put(self.channels.tf, &transforms.encode_to_vec())?;
        }
        if !scene.entities.is_empty() {
            put(self.channels.scene, &scene.encode_to_vec())?;
        }
        Ok(())
    }
}

fn log(stamp: fox::Timestamp, event: &pb::Event) -> fox::Log {
    use fox::log::Level;
    let level = match event.kind.as_str() {
        "fault" | "record_failed" => Level::Error,
        "overrun" | "quality_changed" | "pose_refused" | "tool_lost" => Level::Warning,
        _ => Level::Info,
    };
    let message = match event.detail.as_str() {
        "" => event.kind.replace('_', " "),
        detail => format!("{}: {detail}", event.kind.replace('_', " ")),
    };
    fox::Log {
        timestamp: Some(stamp),
        level: level.into(),
        message,
        name: "palpate".into(),
        file: String::new(),
        line: 0,
    }
}
