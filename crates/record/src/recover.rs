//! Mends a recording that was cut short: everything readable goes into a finished file that says it
//! is not clean.

use super::channel::Happening;
use super::disk::FileSystem;
use super::file::SessionFile;
use super::format::WriteError;
use super::head::{BodyHead, Head, Shown};
use super::message::Message;
use super::reader::{Follower, ReadError, Session, recorded_spec};
use super::views::Views;
use palpate_sim::scene::Scene;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Why nothing could be recovered.
#[derive(Debug, thiserror::Error)]
pub enum RecoverError {
    /// The source.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The new file.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Source and target are one file.
    #[error("{0} would be overwritten by its own recovery; name another output")]
    SameFile(PathBuf),
}

/// What was recovered.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Recovered {
    /// New file.
    pub path: PathBuf,
    /// Ticks in it.
    pub ticks: u64,
    /// Last of them.
    pub last_tick: u64,
    /// Why the source ended, if it was cut short.
    pub cut_short: Option<String>,
}

/// Writes what `source` holds to `target`. A source that was finished cleanly stays clean.
///
/// # Errors
/// A source that is not a session, or a target that cannot be written.
pub fn recover(source: &Path, target: &Path) -> Result<Recovered, RecoverError> {
    if source
        .canonicalize()
        .ok()
        .is_some_and(|s| target.canonicalize().ok() == Some(s))
    {
        return Err(RecoverError::SameFile(source.to_owned()));
    }
    let session = Session::open(source)?;
    let scene = scene_of(&session);
    let head = head_of(&session, scene.as_ref(), ("recovered_from", source));
    let views = scene.as_ref().and_then(Views::of);
    // The source may be the target's own `.part`.
    let part = PathBuf::from(format!("{}.recovering", target.display()));
    let file = SessionFile::create_as(&FileSystem, part.clone(), target, &head, &[], views)?;
    copy(&session, &head, file).inspect_err(|_| {
        // Half a copy is of no use.
        let _ = std::fs::remove_file(&part);
    })
}

/// The scene of a session, if this program can build it.
fn scene_of(session: &Session) -> Option<Scene> {
    recorded_spec(&session.header.effective_scene)
        .ok()
        .and_then(|spec| Scene::build_with(&spec, Path::new("."), palpate_thesis::METHODS).ok())
}

/// The head of another file that holds this session; `origin`: where it is from.
pub(super) fn head_of(session: &Session, scene: Option<&Scene>, origin: (&str, &Path)) -> Head {
    let header = &session.header;
    let bodies = header
        .names("bodies")
        .into_iter()
        .enumerate()
        .map(|(b, id)| {
            let known = scene.filter(|scene| b < scene.body_count());
            let (degree, count) = known.map_or_else(Default::default, |scene| scene.net_size(b));
            BodyHead { id, degree, count }
        });
    let mut extra = header.run.clone();
    let name = (origin.1.file_name().unwrap_or_default()).to_string_lossy();
    extra.insert(origin.0.into(), name.into_owned());
    Head {
        scene: header.run.get("scene").cloned().unwrap_or_default(),
        scene_text: header.scene_text.clone(),
        effective_scene: header.effective_scene.clone(),
        dt_ns: session.dt_ns(),
        tools: header.names("tools"),
        bodies: bodies.collect(),
        extra,
        shown: scene.map_or_else(Shown::default, |scene| Shown::of(scene, &header.scene_text)),
    }
}

/// Copies all that can be read, in the order in which it is there.
fn copy(session: &Session, head: &Head, mut file: SessionFile) -> Result<Recovered, RecoverError> {
    for happening in Follower::new(session).reading_ahead() {
        if let Some(message) = message(&happening?, head) {
            file.put(&message)?;
        }
    }
    let (ticks, last_tick) = (file.ticks, file.last_tick);
    let dropped = session.end_number("dropped_records").unwrap_or(0);
    let path = file.finish(dropped, session.is_whole(), &[])?.wait()?;
    Ok(Recovered {
        path,
        ticks,
        last_tick,
        cut_short: session.cut_short().map(str::to_owned),
    })
}

/// `None`: a net of a body that the scene does not have, or what no whole recording holds.
pub(super) fn message(happening: &Happening, head: &Head) -> Option<Message> {
    Some(match happening {
        Happening::Tick(record) => Message::tick(record, head.tools.len()),
        Happening::Keyframe(keyframe) => {
            let (tick, hash, held) = (keyframe.tick, keyframe.state_hash, keyframe.commands);
            Message::keyframe(tick, hash, held, &keyframe.saved, 0)
        }
        Happening::Command(after_tick, command) => Message::command(*after_tick, *command),
        Happening::Event(event) => Message::event(event.tick, &event.kind, &event.detail),
        Happening::Net(net) => {
            let body = head.bodies.iter().position(|body| body.id == net.body)?;
            let points = net.points.chunks_exact(3);
            let points: Vec<_> = points.map(|p| [p[0], p[1], p[2]].into()).collect();
            let of = &head.bodies[body];
            Message::net(net.tick, net.revision, body, of, &points)
        }
        Happening::Inputs(_) => return None,
        Happening::Other(other) => Message::encoded(other.topic, other.tick, other.data.clone()),
    })
}
