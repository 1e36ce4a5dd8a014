//! A recording as a bag of ROS 2: MCAP with CDR messages, and the metadata that `ros2 bag` wants.

use super::super::channel::{Happening, NetRecord, Topic};
use super::super::reader::{Follower, Session};
use super::super::replay::{ReplayError, recorded_scene};
use super::{ExportError, Range};
use mcap::records::MessageHeader;
use palpate_devices::cdr::{Cdr, encode};
use palpate_devices::ros2::{
    Header, MarkerArray, NetLines, PoseStamped, RosMessage, RosType, TwistStamped, WrenchStamped,
    schema_text,
};
use palpate_proto::messages::BodySnapshot;
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::record::{TickRecord, ToolOutput};
use palpate_wire::first_snapshot;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{BufWriter, Seek, Write};
use std::path::Path;

const FRAME: &str = "world";
const NETS: &str = "/palpate/nets";
/// Time between two nets of a body, ns.
const NETS_EVERY_NS: u64 = 33_000_000;

/// A topic of the bag.
struct Line {
    topic: String,
    ros_type: &'static RosType,
    channel: u16,
    count: u64,
}

/// Writes a bag directory: `OUT/OUT_0.mcap` and `OUT/metadata.yaml`. Each tool has the topics of a CRTK
/// arm in the namespace of its id; control nets are on `/palpate/nets`, at most 30 of each body in a
/// second. Stamps are simulated time.
///
/// # Errors
/// No tick in the range, the directory exists, or the disk refuses.
pub fn ros2_bag(session: &Session, range: &Range, out: &Path) -> Result<u64, ExportError> {
    let mut records = range.of(session).peekable();
    if records.peek().is_none() {
        return Err(range.no_ticks(session));
    }
    std::fs::create_dir(out)?;
    let stem = out.file_name().unwrap_or_default().to_string_lossy();
    let name = format!("{stem}_0.mcap");
    let file = BufWriter::new(std::fs::File::create(out.join(&name))?);
    let tools = session.header.names("tools");
    // A scene that this build cannot read has ticks nevertheless, but no one knows its nets.
    let hash = [0; 32];
    let scene = recorded_scene(session).map(|scene| first_snapshot(&scene, hash).bodies);
    let bodies = scene.unwrap_or_default();
    let mut bag = Bag::begin(file, &tools, bodies).map_err(std::io::Error::other)?;
    let dt_ns = session.dt_ns();
    drop(records);
    let kept = Follower::between(session, range.from, range.until).only(&[Topic::Tick, Topic::Net]);
    for happening in kept.reading_ahead() {
        let written = match happening.map_err(ReplayError::Read)? {
            Happening::Tick(record) => bag.tick(&record, tools.len(), dt_ns),
            Happening::Net(net) => bag.net(&net, dt_ns),
            _ => Ok(()),
        };
        written.map_err(std::io::Error::other)?;
    }
    let metadata = bag.metadata(&name);
    let count = bag.count();
    bag.finish()?;
    std::fs::write(out.join("metadata.yaml"), metadata)?;
    Ok(count)
}

struct Bag<W: Write + Seek> {
    mcap: mcap::Writer<W>,
    /// Four a tool, then that of nets if there are bodies.
    lines: Vec<Line>,
    bodies: Vec<BodySnapshot>,
    /// By body: when its last net was written, ns.
    drawn_ns: Vec<Option<u64>>,
    first_ns: Option<u64>,
    last_ns: u64,
}

impl<W: Write + Seek> Bag<W> {
    fn begin(out: W, tools: &[String], bodies: Vec<BodySnapshot>) -> mcap::McapResult<Self> {
        let mut mcap = mcap::WriteOptions::new()
            .profile("ros2")
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0)
            .create(out)?;
        let mut lines = Vec::new();
        let mut schemas: BTreeMap<&str, u16> = BTreeMap::new();
        let of_tool = |tool: &String| {
            let namespace = tool.replace('-', "_");
            [
                ("measured_cp", PoseStamped::TYPE),
                ("measured_cv", TwistStamped::TYPE),
                ("servo_cf", WrenchStamped::TYPE),
                ("contact/measured_cf", WrenchStamped::TYPE),
            ]
            .map(|(topic, ros_type)| (format!("/{namespace}/{topic}"), ros_type))
        };
        let nets = (!bodies.is_empty()).then(|| (NETS.to_owned(), MarkerArray::TYPE));
        for (topic, ros_type) in tools.iter().flat_map(of_tool).chain(nets) {
            let schema = match schemas.get(ros_type.name) {
                Some(schema) => *schema,
                None => {
                    let text = schema_text(ros_type);
                    let schema = mcap.add_schema(ros_type.name, "ros2msg", text.as_bytes())?;
                    schemas.insert(ros_type.name, schema);
                    schema
                }
            };
            let about = BTreeMap::from([("offered_qos_profiles".to_owned(), String::new())]);
            let channel = mcap.add_channel(schema, &topic, "cdr", &about)?;
            lines.push(Line {
                topic,
                ros_type,
                channel,
                count: 0,
            });
        }
        Ok(Self {
            mcap,
            lines,
            drawn_ns: vec![None; bodies.len()],
            bodies,
            first_ns: None,
            last_ns: 0,
        })
    }

    fn tick(&mut self, record: &TickRecord, tools: usize, dt_ns: u64) -> mcap::McapResult<()> {
        let time_ns = record.output.tick * dt_ns;
        self.first_ns.get_or_insert(time_ns);
        self.last_ns = self.last_ns.max(time_ns);
        let poses = record.input.poses.first(tools);
        for (k, (pose, output)) in poses.zip(record.output.tools.first(tools)).enumerate() {
            let line = 4 * k;
            if let Some(pose) = pose {
                let (pose, twist) = motion(pose, time_ns);
                self.put(line, time_ns, &pose)?;
                self.put(line + 1, time_ns, &twist)?;
            }
            let (force, contact) = wrenches(output, time_ns);
            self.put(line + 2, time_ns, &force)?;
            self.put(line + 3, time_ns, &contact)?;
        }
        Ok(())
    }

    /// A net, unless the last one of its body was just before.
    fn net(&mut self, net: &NetRecord, dt_ns: u64) -> mcap::McapResult<()> {
        let Some(number) = self.bodies.iter().position(|body| body.id == net.body) else {
            return Ok(());
        };
        let time_ns = net.tick * dt_ns;
        if self.drawn_ns[number].is_some_and(|last| time_ns < last.saturating_add(NETS_EVERY_NS)) {
            return Ok(());
        }
        self.drawn_ns[number] = Some(time_ns);
        // The nets at the start come before the first tick.
        self.first_ns = Some(self.first_ns.map_or(time_ns, |first| first.min(time_ns)));
        self.last_ns = self.last_ns.max(time_ns);
        let points: Vec<[f64; 3]> = (net.points.chunks_exact(3))
            .map(|point| [point[0], point[1], point[2]])
            .collect();
        let body = &self.bodies[number];
        let lines = NetLines {
            number,
            body: &body.id,
            count: body.count.map(usize::from),
            periodic: body.periodic,
            points: &points,
        };
        let markers = vec![lines.marker(time_ns, FRAME)];
        self.put(self.lines.len() - 1, time_ns, &MarkerArray { markers })
    }

    fn put(&mut self, line: usize, time_ns: u64, message: &impl Cdr) -> mcap::McapResult<()> {
        let line = &mut self.lines[line];
        line.count += 1;
        let header = MessageHeader {
            channel_id: line.channel,
            sequence: line.count as u32,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.mcap.write_to_known_channel(&header, &encode(message))
    }

    fn count(&self) -> u64 {
        self.lines.iter().map(|line| line.count).sum()
    }

    /// As rosbag2 writes it, version 5.
    fn metadata(&self, file: &str) -> String {
        let (first, last) = (self.first_ns.unwrap_or(0), self.last_ns);
        let (duration, count) = (last - first, self.count());
        let mut text = format!(
            "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  duration:\n    nanoseconds: \
             {duration}\n  starting_time:\n    nanoseconds_since_epoch: {first}\n  message_count: {count}\n  \
             topics_with_message_count:\n"
        );
        for line in &self.lines {
            let _ = write!(
                text,
                "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n        \
                 offered_qos_profiles: \"\"\n      message_count: {}\n",
                line.topic, line.ros_type.name, line.count
            );
        }
        let _ = write!(
            text,
            "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - \"{file}\"\n  files:\n    \
             - path: \"{file}\"\n      starting_time:\n        nanoseconds_since_epoch: {first}\n      duration:\n        \
             nanoseconds: {duration}\n      message_count: {count}\n"
        );
        text
    }

    fn finish(mut self) -> Result<(), ExportError> {
        self.mcap.finish().map_err(std::io::Error::other)?;
        self.mcap.into_inner().flush()?;
        Ok(())
    }
}

fn motion(pose: &DevicePose, time_ns: u64) -> (PoseStamped, TwistStamped) {
    let orientation = pose.orientation.coords;
    (
        PoseStamped {
            header: Header::new(time_ns, FRAME),
            position: pose.position.coords.into(),
            orientation: orientation.into(),
        },
        TwistStamped {
            header: Header::new(time_ns, FRAME),
            linear: pose.linear_velocity.into(),
            angular: pose.angular_velocity.into(),
        },
    )
}

fn wrenches(output: &ToolOutput, time_ns: u64) -> (WrenchStamped, WrenchStamped) {
    let header = || Header::new(time_ns, FRAME);
    (
        WrenchStamped {
            header: header(),
            force: output.force_n.into(),
            torque: output.torque_nm.into(),
        },
        WrenchStamped {
            header: header(),
            force: output.contact_force_n.into(),
            torque: output.contact_torque_nm.into(),
        },
    )
}
