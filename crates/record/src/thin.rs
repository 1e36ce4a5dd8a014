//! A recording for looking at: as long as the whole, with fewer ticks and nets, in so many bytes.
//!
//! Every n-th tick is kept, and nets as much rarer; keyframes, commands and what only other viewers
//! read are left out. It does not replay.

use super::channel::Happening;
use super::disk::InMemory;
use super::file::SessionFile;
use super::head::{Head, Shown};
use super::reader::{Follower, Session};
use super::recover::{RecoverError, head_of, message};
use palpate_sim::scene::Scene;
use std::collections::BTreeMap;
use std::path::Path;

/// Times that a recording is copied before it is given up as too long.
const TRIES: u32 = 6;
/// Between two nets of a body in a whole recording, s.
const NET_S: f64 = 1.0 / 30.0;

/// What is left of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thinned {
    /// The file.
    pub bytes: Vec<u8>,
    /// One tick in so many was kept; 1: the file is whole, and replays.
    pub every: u64,
}

/// The recording in at most `most` bytes: whole if it fits, else thinned. `scene` is its scene.
///
/// # Errors
/// A recording that cannot be read.
pub fn thinned(session: &Session, scene: &Scene, most: u64) -> Result<Thinned, RecoverError> {
    let whole = session.file_bytes();
    if whole <= most {
        return Ok(Thinned {
            bytes: read(&session.path)?,
            every: 1,
        });
    }
    // About half of a file are keyframes, and what other viewers read.
    let mut every = (whole / 2).div_ceil(most.max(1)).max(1);
    let mut smallest = None;
    for _ in 0..TRIES {
        let bytes = copy(session, scene, every)?;
        let size = bytes.len() as u64;
        let fits = size <= most;
        smallest = Some(Thinned { bytes, every });
        if fits {
            break;
        }
        // A little more than what is asked for: heads do not become smaller.
        every = (every * size).div_ceil(most.max(1)).max(every + 1) * 9 / 8;
    }
    smallest.ok_or(RecoverError::SameFile(session.path.clone()))
}

fn read(path: &Path) -> Result<Vec<u8>, RecoverError> {
    std::fs::read(path).map_err(|source| io(path, source))
}

fn io(path: &Path, source: std::io::Error) -> RecoverError {
    RecoverError::Write(super::WriteError::Io {
        path: path.to_owned(),
        source,
    })
}

fn copy(session: &Session, scene: &Scene, every: u64) -> Result<Vec<u8>, RecoverError> {
    let memory = InMemory::default();
    let path = Path::new("thinned.mcap");
    let mut head: Head = head_of(session, Some(scene), ("thinned_from", &session.path));
    head.extra.insert("thinned_every".into(), every.to_string());
    // The page that it goes into has them beside it.
    head.shown = Shown::default();
    let mut file = SessionFile::create_as(&memory, path.into(), path, &head, &[], None)?;
    let net_ticks = (NET_S * every as f64 / scene.dt_s) as u64;
    let mut others = 0_u64;
    let mut last_net = BTreeMap::<String, u64>::new();
    for happening in Follower::new(session).reading_ahead() {
        let happening = happening?;
        let kept = match &happening {
            Happening::Tick(record) => record.output.tick.is_multiple_of(every),
            Happening::Net(net) => {
                let due = last_net.get(&net.body).is_none_or(|last| {
                    net.tick >= last.saturating_add(net_ticks) || net.tick < *last
                });
                if due {
                    last_net.insert(net.body.clone(), net.tick);
                }
                due
            }
            Happening::Event(_) => true,
            Happening::Other(_) => {
                others += 1;
                (others - 1).is_multiple_of(every)
            }
            Happening::Keyframe(_) | Happening::Command(..) | Happening::Inputs(_) => false,
        };
        if let Some(message) = message(&happening, &head).filter(|_| kept) {
            file.put(&message)?;
        }
    }
    file.finish(0, false, &[])?.wait()?;
    Ok(memory.take())
}
