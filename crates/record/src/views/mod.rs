//! What viewers show of a session: Foxglove messages made from ticks and nets, so often as eyes can
//! follow and only when something changed. A replay does not read them.
//!
//! | topic | message | for |
//! |---|---|---|
//! | `/view/scene` | `foxglove.SceneUpdate` | bodies, control nets, forces in a 3D panel |
//! | `/view/body/{id}/points` | `foxglove.PointCloud` | x y z and displacement, for viewers that draw no scenes |
//! | `/view/tool/{id}` | `foxglove.PoseInFrame` | the proxy of a tool |
//! | `/view/tool/{id}/shape` | `foxglove.SceneUpdate` | its shape, once, in the frame of the tool |
//! | `/tool/{id}/wrench` | `palpate.v1.Wrench` | force and torque by name, for plots: every tick in which they change |
//! | `/tf` | `foxglove.FrameTransforms` | `world` → `tool/{id}` |
//! | `/log` | `foxglove.Log` | events, as they come |

mod draw;
mod picture;

pub use picture::{LOG, Pictures, ViewTopic, log, stamp_of};

use super::channel::Topic;
use super::container::Container;
use super::message::Message;
use palpate_proto::recording as pb;
use palpate_sim::scene::Scene;
use prost::Message as _;
use std::io::{self, Write};

/// Views of one file.
#[derive(Clone)]
pub(super) struct Views {
    pictures: Pictures,
    /// By view: its channel in the file.
    channels: Vec<u16>,
    dt_ns: u64,
    /// Tick of the next picture.
    next: Option<u64>,
    every: u64,
}

impl Views {
    /// Views of a scene, if it wants any.
    pub fn of(scene: &Scene) -> Option<Self> {
        let record = &scene.spec.record;
        record.views.then(|| Self {
            pictures: Pictures::of(scene),
            channels: Vec::new(),
            dt_ns: (scene.dt_s * 1e9).round() as u64,
            next: None,
            every: ((1.0 / scene.dt_s / record.view_hz).round() as u64).max(1),
        })
    }

    /// The same with its channels in a file.
    pub fn declared<W: Write>(mut self, file: &mut Container<W>) -> Self {
        let channel = |view: &ViewTopic| {
            let descriptors = pb::descriptors(view.schema).unwrap_or_default();
            file.channel(&view.topic, view.schema, &descriptors)
        };
        self.channels = self.pictures.topics().iter().map(channel).collect();
        self
    }

    /// Takes a message of the session; what is to be shown goes to `put`, with its channel.
    pub fn show(
        &mut self,
        message: &Message,
        mut put: impl FnMut(u16, &[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let channels = &self.channels;
        let mut put = |view: usize, data: &[u8]| put(channels[view], data);
        let stamp = stamp_of(message.tick.saturating_mul(self.dt_ns));
        match message.topic {
            Topic::Net => {
                let data = &message.data[..];
                let points = pb::ControlNet::decode(data).ok().map(|net| net.points);
                if let Some(points) = points {
                    self.pictures.net(usize::from(message.body), points);
                }
            }
            Topic::Event => {
                if let Ok(event) = pb::Event::decode(&message.data[..]) {
                    put(LOG, &log(stamp, &event.kind, &event.detail))?;
                }
            }
            Topic::Tick => {
                let Ok(tick) = pb::Tick::decode(&message.data[..]) else {
                    return Ok(());
                };
                let values = || tick.tools.iter().map(|tool| &tool.values[..]);
                self.pictures.wrenches(values(), |_| true, &mut put)?;
                // The nets of a file's start come with its first ticks.
                let next = self.next.get_or_insert(message.tick.saturating_add(1));
                if message.tick >= *next {
                    self.next = Some(message.tick.saturating_add(self.every));
                    self.pictures.draw(stamp, values(), |_| true, put)?;
                }
            }
            _ => {}
        }
        Ok(())
    }
}
