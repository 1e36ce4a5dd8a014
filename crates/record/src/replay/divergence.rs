//! The ticks around a difference, from both runs, in an MCAP file that any reader of recordings
//! opens.

use super::super::build_id;
use super::super::channel::{Happening, Topic};
use super::super::format::{SCENE_EFFECTIVE, WriteError, options};
use super::super::reader::{Follower, Session};
use super::Difference;
use mcap::records::{MessageHeader, Metadata};
use palpate_proto::recording as pb;
use palpate_sim::tick::record::TickRecord;
use prost::Message as _;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Ticks kept before and after a difference.
pub(super) const WINDOW: usize = 50;

/// Topic of the ticks as they were recorded.
const RECORDED: &str = "/recorded/sim/tick";
/// Topic of the ticks as they were replayed.
const REPLAYED: &str = "/replayed/sim/tick";
/// Metadata record with the difference.
const DIVERGENCE: &str = "palpate.divergence";

/// A difference and what was replayed around it.
#[derive(Clone, Debug, PartialEq)]
pub struct Divergence {
    /// The first one.
    pub difference: Difference,
    /// Up to 50 ticks before it (no farther back than the keyframe from which it was replayed), its
    /// own, up to 50 after.
    pub replayed: Vec<TickRecord>,
}

impl Divergence {
    /// Ticks of both runs from `WINDOW` before the difference to `WINDOW` after it, as recorded and
    /// as replayed.
    fn both(&self, session: &Session) -> (Vec<TickRecord>, Vec<TickRecord>) {
        let tick = self.difference.tick;
        let (low, high) = (
            tick.saturating_sub(WINDOW as u64),
            tick.saturating_add(WINDOW as u64),
        );
        // What cannot be read is not there; a tick may be there twice, but not a thousand times.
        let recorded = Follower::between(session, low, high).only(&[Topic::Tick]);
        let recorded = recorded.map_while(Result::ok).take(4 * WINDOW);
        let recorded: Vec<TickRecord> = recorded
            .filter_map(|happening| match happening {
                Happening::Tick(record) => Some(*record),
                _ => None,
            })
            .collect();
        // Ticks before the keyframe were replayed by the stretch before, and all their bits were
        // equal.
        let begun = self
            .replayed
            .first()
            .map_or(u64::MAX, |record| record.output.tick)
            .min(tick.saturating_add(1));
        let equal = recorded
            .iter()
            .take_while(|record| record.output.tick < begun);
        let own = self
            .replayed
            .iter()
            .filter(|record| record.output.tick >= low);
        let replayed = equal.chain(own).cloned().collect();
        (recorded, replayed)
    }

    /// Writes `divergence-<tick>.mcap` into a directory: both runs around the difference, the
    /// difference as metadata, and the scene.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, session: &Session, directory: &Path) -> Result<PathBuf, WriteError> {
        let path = directory.join(format!("divergence-{}.mcap", self.difference.tick));
        let io = |source| WriteError::Io {
            path: path.clone(),
            source,
        };
        let bad = |source| WriteError::mcap(&path, source);
        std::fs::create_dir_all(directory).map_err(io)?;
        let file = std::fs::File::create(&path).map_err(io)?;
        // Two hundred ticks need no compression, and so the file opens everywhere.
        let mut mcap = options()
            .compression(None)
            .create(std::io::BufWriter::new(file))
            .map_err(bad)?;
        mcap.write_metadata(&Metadata {
            name: DIVERGENCE.into(),
            metadata: self.metadata(session),
        })
        .map_err(bad)?;
        let scene = mcap::Attachment {
            log_time: 0,
            create_time: 0,
            name: SCENE_EFFECTIVE.into(),
            media_type: "application/toml".into(),
            data: session.header.effective_scene.as_bytes().into(),
        };
        mcap.attach(&scene).map_err(bad)?;
        let tools = session.header.names("tools").len();
        let dt_ns = session.dt_ns();
        let schema = mcap
            .add_schema(
                "palpate.v1.Tick",
                "protobuf",
                &pb::descriptors("palpate.v1.Tick").unwrap_or_default(),
            )
            .map_err(bad)?;
        let (recorded, replayed) = self.both(session);
        for (topic, ticks) in [(RECORDED, recorded), (REPLAYED, replayed)] {
            let channel_id = mcap
                .add_channel(schema, topic, "protobuf", &BTreeMap::new())
                .map_err(bad)?;
            for record in ticks {
                let tick = record.output.tick;
                let log_time = tick.saturating_mul(dt_ns);
                let header = MessageHeader {
                    channel_id,
                    sequence: tick as u32,
                    log_time,
                    publish_time: log_time,
                };
                let data = palpate_wire::tick_to_proto(&record, tools).encode_to_vec();
                mcap.write_to_known_channel(&header, &data).map_err(bad)?;
            }
        }
        mcap.finish().map_err(bad)?;
        std::io::Write::flush(&mut mcap.into_inner()).map_err(io)?;
        Ok(path)
    }

    fn metadata(&self, session: &Session) -> BTreeMap<String, String> {
        let Difference {
            tick,
            field,
            recorded,
            replayed,
            ulps,
        } = &self.difference;
        let run = |key: &str| session.header.run.get(key).cloned().unwrap_or_default();
        let mut entries = BTreeMap::from([
            ("tick".to_string(), tick.to_string()),
            ("field".to_string(), field.clone()),
            ("recorded".to_string(), recorded.clone()),
            ("replayed".to_string(), replayed.clone()),
            ("file".to_string(), session.path.display().to_string()),
            ("scene".to_string(), run("scene")),
            ("recorded_by".to_string(), run("build")),
            ("replayed_by".to_string(), build_id()),
        ]);
        if let Some(ulps) = ulps {
            entries.insert("ulps".into(), ulps.to_string());
        }
        entries
    }
}
