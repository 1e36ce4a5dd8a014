//! Pictures of a scene as Foxglove messages, for files and for viewers that are connected.

use super::draw::{BodyShape, ToolShape};
use palpate_proto::foxglove as fox;
use palpate_proto::recording as pb;
use palpate_sim::scene::Scene;
use prost::Message as _;
use std::sync::Arc;

/// Number of the view that shows scenes.
const SCENE: usize = 0;
/// Number of the view that has the tools' frames.
const TF: usize = 1;
/// Number of the view that shows events.
pub const LOG: usize = 2;
/// Views before those of bodies.
const FIXED: usize = 3;

/// A view: where its messages go, and what they are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ViewTopic {
    /// Topic, for example `/view/scene`.
    pub topic: String,
    /// Full name of the message.
    pub schema: &'static str,
}

/// Draws a scene from its nets and tools. Views are numbered as in [`Pictures::topics`].
#[derive(Clone)]
pub struct Pictures {
    shapes: Arc<Shapes>,
    /// By body: x y z of a net that no picture shows yet.
    nets: Vec<Option<Vec<f64>>>,
    /// By tool: what the last picture showed of it.
    tools: Vec<Vec<f64>>,
    /// By tool: force and torque of its last wrench.
    wrenches: Vec<[f64; 6]>,
    drawn: bool,
}

struct Shapes {
    bodies: Vec<BodyShape>,
    tools: Vec<ToolShape>,
}

impl Pictures {
    /// Pictures of a scene; the first one shows all of it.
    pub fn of(scene: &Scene) -> Self {
        let bodies = (0..scene.body_count()).map(|body| BodyShape::of(scene, body));
        let tools = (0..scene.tool_count()).map(|tool| ToolShape::of(scene, tool));
        Self {
            nets: vec![None; scene.body_count()],
            tools: vec![Vec::new(); scene.tool_count()],
            // Unlike anything: the first one is written.
            wrenches: vec![[f64::NAN; 6]; scene.tool_count()],
            shapes: Arc::new(Shapes {
                bodies: bodies.collect(),
                tools: tools.collect(),
            }),
            drawn: false,
        }
    }

    /// All views, by number.
    pub fn topics(&self) -> Vec<ViewTopic> {
        let view = |topic: String, schema| ViewTopic { topic, schema };
        let Shapes { bodies, tools } = &*self.shapes;
        let mut topics = vec![
            view("/view/scene".into(), "foxglove.SceneUpdate"),
            view("/tf".into(), "foxglove.FrameTransforms"),
            view("/log".into(), "foxglove.Log"),
        ];
        topics.extend(
            bodies
                .iter()
                .map(|b| view(b.topic(), "foxglove.PointCloud")),
        );
        topics.extend(
            tools
                .iter()
                .map(|t| view(t.topic(), "foxglove.PoseInFrame")),
        );
        let shapes = tools.iter().map(|t| t.shape_topic());
        topics.extend(shapes.map(|topic| view(topic, "foxglove.SceneUpdate")));
        let wrenches = tools.iter().map(|t| t.wrench_topic());
        topics.extend(wrenches.map(|topic| view(topic, "palpate.v1.Wrench")));
        topics
    }

    /// Takes the net of a body: x y z of each control point.
    pub fn net(&mut self, body: usize, points: Vec<f64>) {
        if let Some(net) = self.nets.get_mut(body) {
            *net = Some(points);
        }
    }

    /// The next picture shows all again, except nets that no one gives anew.
    pub fn start_again(&mut self) {
        self.drawn = false;
        self.tools.iter_mut().for_each(Vec::clear);
        self.wrenches.fill([f64::NAN; 6]);
    }

    /// Tells force and torque of each tool where they are not those of the last time. `tools`, `wanted`
    /// and `put` as for [`Pictures::draw`].
    pub fn wrenches<'a, E>(
        &mut self,
        tools: impl Iterator<Item = &'a [f64]>,
        wanted: impl Fn(usize) -> bool,
        mut put: impl FnMut(usize, &[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let Shapes {
            bodies,
            tools: shapes,
        } = &*self.shapes;
        let first = FIXED + bodies.len() + 2 * shapes.len();
        for (t, (last, values)) in self.wrenches.iter_mut().zip(tools).enumerate() {
            let Some((&values, _)) = values.split_first_chunk::<6>() else {
                continue;
            };
            if *last == values || !wanted(first + t) {
                continue;
            }
            *last = values;
            let [fx, fy, fz, tx, ty, tz] = values;
            let vector = |x, y, z| Some(pb::Vector { x, y, z });
            let wrench = pb::Wrench {
                force: vector(fx, fy, fz),
                torque: vector(tx, ty, tz),
            };
            put(first + t, &wrench.encode_to_vec())?;
        }
        Ok(())
    }

    /// Draws what changed since the last picture. `tools`: of each tool force, torque, and position
    /// and orientation of its proxy. Views that are not `wanted` are not made; others go to `put` with
    /// their number.
    pub fn draw<'a, E>(
        &mut self,
        stamp: fox::Timestamp,
        tools: impl Iterator<Item = &'a [f64]>,
        wanted: impl Fn(usize) -> bool,
        mut put: impl FnMut(usize, &[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let shapes = self.shapes.clone();
        let (bodies, tool_count) = (shapes.bodies.len(), shapes.tools.len());
        let mut scene = fox::SceneUpdate::default();
        for (body, shape) in shapes.bodies.iter().enumerate() {
            let net = self.nets[body].take();
            let cloud = FIXED + body;
            if (net.is_none() && self.drawn) || !(wanted(SCENE) || wanted(cloud)) {
                continue;
            }
            let drawn = shape.drawn(net.as_deref().unwrap_or_default());
            if wanted(SCENE) {
                scene.entities.push(shape.entity(stamp, &drawn));
            }
            if wanted(cloud) {
                put(cloud, &shape.cloud(stamp, &drawn).encode_to_vec())?;
            }
        }
        let mut transforms = fox::FrameTransforms::default();
        for (t, (shape, values)) in shapes.tools.iter().zip(tools).enumerate() {
            if self.tools[t] == values {
                continue;
            }
            self.tools[t].clear();
            self.tools[t].extend_from_slice(values);
            let Some((position, orientation)) = shape.pose(values) else {
                continue;
            };
            if wanted(SCENE) {
                scene.entities.push(shape.entity(stamp, values, position));
            }
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
            if wanted(FIXED + bodies + t) {
                put(FIXED + bodies + t, &pose.encode_to_vec())?;
            }
        }
        if !self.drawn {
            for (t, shape) in shapes.tools.iter().enumerate() {
                let view = FIXED + bodies + tool_count + t;
                if wanted(view) {
                    put(view, &shape.shape(stamp).encode_to_vec())?;
                }
            }
        }
        self.drawn = true;
        if !transforms.transforms.is_empty() && wanted(TF) {
            put(TF, &transforms.encode_to_vec())?;
        }
        if !scene.entities.is_empty() {
            put(SCENE, &scene.encode_to_vec())?;
        }
        Ok(())
    }
}

/// A time in ns as Foxglove writes it.
pub fn stamp_of(ns: u64) -> fox::Timestamp {
    fox::Timestamp {
        seconds: (ns / 1_000_000_000) as i64,
        nanos: (ns % 1_000_000_000) as i32,
    }
}

/// An event as a line of a log, encoded.
pub fn log(stamp: fox::Timestamp, kind: &str, detail: &str) -> Vec<u8> {
    use fox::log::Level;
    let level = match kind {
        "fault" | "record_failed" => Level::Error,
        "overrun" | "pose_refused" => Level::Warning,
        // Its reason begins with the way it went.
        "quality_changed" if detail.contains(": lowered") => Level::Warning,
        // Quality that rises, a hand that lets go.
        _ => Level::Info,
    };
    let message = match detail {
        "" => kind.replace('_', " "),
        detail => format!("{}: {detail}", kind.replace('_', " ")),
    };
    let log = fox::Log {
        timestamp: Some(stamp),
        level: level.into(),
        message,
        name: "palpate".into(),
        file: String::new(),
        line: 0,
    };
    log.encode_to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fox::log::Level;

    #[test]
    fn good_news_is_no_warning_in_the_log() {
        let level = |kind: &str, detail: &str| {
            let line = log(stamp_of(0), kind, detail);
            fox::Log::decode(&line[..]).unwrap().level()
        };
        let table = [
            ("fault", "a state was not finite", Level::Error),
            ("record_failed", "a.mcap: disk full", Level::Error),
            ("overrun", "wake: 3 ticks, worst 5 ns", Level::Warning),
            ("pose_refused", "ball: it jumped", Level::Warning),
            (
                "quality_changed",
                "1: lowered from level 0: a tenth of the ticks overran",
                Level::Warning,
            ),
            (
                "quality_changed",
                "1: raised from level 2: ticks have ended in good time",
                Level::Info,
            ),
            (
                "quality_changed",
                "0: raised from level 1: ticks have ended in good time",
                Level::Info,
            ),
            ("tool_joined", "ball", Level::Info),
            ("tool_lost", "ball", Level::Info),
            ("resumed", "", Level::Info),
        ];
        for (kind, detail, expected) in table {
            assert_eq!(level(kind, detail), expected, "{kind} {detail}");
        }
    }
}
