//! Mends a recording that was cut short: everything readable goes into a finished file that says it is not clean.

use super::reader::{ReadError, Session};
use super::writer::{BodyHead, Head, WriteError, Writer};
use crate::scene::Scene;
use crate::scene::spec::SceneSpec;
use palpate_proto::recording as pb;
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
/// A source that is no session, or a target that cannot be written.
pub fn recover(source: &Path, target: &Path) -> Result<Recovered, RecoverError> {
    if source.canonicalize().ok().is_some_and(|s| target.canonicalize().ok() == Some(s)) {
        return Err(RecoverError::SameFile(source.to_owned()));
    }
    let session = Session::open(source)?;
    let header = &session.header;
    let list = |key: &str| -> Vec<String> {
        let names = header.run.get(key).map_or("", String::as_str);
        names.split(',').filter(|name| !name.is_empty()).map(str::to_owned).collect()
    };
    let scene = toml::from_str::<SceneSpec>(&header.effective_scene)
        .ok()
        .and_then(|spec| Scene::build(&spec, Path::new(".")).ok());
    let bodies = list("bodies").into_iter().enumerate().map(|(b, id)| {
        let surface = scene.as_ref().filter(|scene| b < scene.body_count()).map(|scene| scene.rest_surface(b));
        BodyHead {
            id,
            degree: surface.map_or([0; 2], |s| [s.knots_u().degree(), s.knots_v().degree()]),
            count: surface.map_or([0; 2], |s| [s.net().rows(), s.net().columns()]),
        }
    });
    let mut extra = header.run.clone();
    extra.insert("recovered_from".into(), source.display().to_string());
    let head = Head {
        scene: header.run.get("scene").cloned().unwrap_or_default(),
        scene_text: header.scene_text.clone(),
        effective_scene: header.effective_scene.clone(),
        dt_ns: session.run_number("dt_ns").unwrap_or(1_000_000),
        tools: list("tools"),
        bodies: bodies.collect(),
        extra,
    };
    let ids: Vec<String> = head.bodies.iter().map(|body| body.id.clone()).collect();
    let mut writer = Writer::create(target, head)?;
    for keyframe in &session.keyframes {
        writer.keyframe(keyframe.tick, keyframe.state_hash, keyframe.commands, &keyframe.saved)?;
    }
    for (after_tick, command) in &session.commands {
        writer.command(*after_tick, *command)?;
    }
    for record in &session.ticks {
        writer.tick(record)?;
    }
    for net in &session.nets {
        if let Some(body) = ids.iter().position(|id| *id == net.body) {
            let points: Vec<_> = net.points.chunks_exact(3).map(|p| [p[0], p[1], p[2]].into()).collect();
            writer.net(net.tick, net.revision, body, &points)?;
        }
    }
    writer.stats(&pb::Stats { tick: writer.last_tick, ..pb::Stats::default() })?;
    let (ticks, last_tick) = (writer.ticks, writer.last_tick);
    let clean = session.is_clean() && session.cut_short.is_none();
    let path = writer.finish(session.end_number("dropped_records").unwrap_or(0), clean)?;
    Ok(Recovered { path, ticks, last_tick, cut_short: session.cut_short })
}
