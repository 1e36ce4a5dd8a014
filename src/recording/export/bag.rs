//! A recording as a bag of ROS 2: MCAP with CDR messages, and the metadata that `ros2 bag` wants.

use super::super::reader::Session;
use super::{ExportError, Range};
use mcap::records::MessageHeader;
use palpate_devices::cdr::{Cdr, encode};
use palpate_devices::ros2::{
    Header, PoseStamped, RosMessage, RosType, TwistStamped, WrenchStamped, schema_text,
};
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::record::{TickRecord, ToolOutput};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{BufWriter, Seek, Write};
use std::path::Path;

const FRAME: &str = "world";

/// A topic of the bag.
struct Line {
    topic: String,
    ros_type: &'static RosType,
    channel: u16,
    count: u64,
}

/// Writes a bag directory: `OUT/OUT_0.mcap` and `OUT/metadata.yaml`. Each tool has the topics of a CRTK
/// arm in the namespace of its id; stamps are simulated time.
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
    let mut bag = Bag::begin(file, &tools).map_err(std::io::Error::other)?;
    let dt_ns = session.dt_ns();
    for record in records {
        let record = record?;
        bag.tick(&record, tools.len(), dt_ns)
            .map_err(std::io::Error::other)?;
    }
    let metadata = bag.metadata(&name);
    let count = bag.count();
    bag.finish()?;
    std::fs::write(out.join("metadata.yaml"), metadata)?;
    Ok(count)
}

struct Bag<W: Write + Seek> {
    mcap: mcap::Writer<W>,
    /// Four a tool.
    lines: Vec<Line>,
    first_ns: Option<u64>,
    last_ns: u64,
}

impl<W: Write + Seek> Bag<W> {
    fn begin(out: W, tools: &[String]) -> mcap::McapResult<Self> {
        let mut mcap = mcap::WriteOptions::new()
            .profile("ros2")
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0)
            .create(out)?;
        let mut lines = Vec::new();
        let mut schemas: BTreeMap<&str, u16> = BTreeMap::new();
        for tool in tools {
            let namespace = tool.replace('-', "_");
            for (topic, ros_type) in [
                ("measured_cp", PoseStamped::TYPE),
                ("measured_cv", TwistStamped::TYPE),
                ("servo_cf", WrenchStamped::TYPE),
                ("contact/measured_cf", WrenchStamped::TYPE),
            ] {
                let schema = match schemas.get(ros_type.name) {
                    Some(schema) => *schema,
                    None => {
                        let text = schema_text(ros_type);
                        let schema = mcap.add_schema(ros_type.name, "ros2msg", text.as_bytes())?;
                        schemas.insert(ros_type.name, schema);
                        schema
                    }
                };
                let topic = format!("/{namespace}/{topic}");
                let about = BTreeMap::from([("offered_qos_profiles".to_owned(), String::new())]);
                let channel = mcap.add_channel(schema, &topic, "cdr", &about)?;
                lines.push(Line {
                    topic,
                    ros_type,
                    channel,
                    count: 0,
                });
            }
        }
        Ok(Self {
            mcap,
            lines,
            first_ns: None,
            last_ns: 0,
        })
    }

    fn tick(&mut self, record: &TickRecord, tools: usize, dt_ns: u64) -> mcap::McapResult<()> {
        let time_ns = record.output.tick * dt_ns;
        self.first_ns.get_or_insert(time_ns);
        self.last_ns = time_ns;
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
