//! Mends a recording that was cut short: everything readable goes into a finished file that says it
//! is not clean.

use super::disk::FileSystem;
use super::file::{SessionFile, WriteError};
use super::head::Head;
use super::message::{BodyHead, Message};
use super::names;
use super::reader::{Keyframe, ReadError, Session};
use super::views::Views;
use palpate_proto::recording as pb;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::SceneSpec;
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
    if source
        .canonicalize()
        .ok()
        .is_some_and(|s| target.canonicalize().ok() == Some(s))
    {
        return Err(RecoverError::SameFile(source.to_owned()));
    }
    let session = Session::open(source)?;
    let header = &session.header;
    let scene = toml::from_str::<SceneSpec>(&header.effective_scene)
        .ok()
        .and_then(|spec| Scene::build(&spec, Path::new(".")).ok());
    let bodies = names(&session, "bodies")
        .into_iter()
        .enumerate()
        .map(|(b, id)| {
            let surface = scene
                .as_ref()
                .filter(|scene| b < scene.body_count())
                .map(|scene| scene.rest_surface(b));
            BodyHead {
                id,
                degree: surface.map_or([0; 2], |s| [s.knots_u().degree(), s.knots_v().degree()]),
                count: surface.map_or([0; 2], |s| [s.net().rows(), s.net().columns()]),
            }
        });
    let mut extra = header.run.clone();
    let name = source
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    extra.insert("recovered_from".into(), name);
    let head = Head {
        scene: header.run.get("scene").cloned().unwrap_or_default(),
        scene_text: header.scene_text.clone(),
        effective_scene: header.effective_scene.clone(),
        dt_ns: session.run_number("dt_ns").unwrap_or(1_000_000),
        tools: names(&session, "tools"),
        bodies: bodies.collect(),
        extra,
    };
    let views = scene.as_ref().and_then(Views::of);
    // The source may be the target's own `.part`.
    let part = PathBuf::from(format!("{}.recovering", target.display()));
    let mut file = SessionFile::create_as(&FileSystem, part, target, &head, &[], views)?;
    for message in messages(&session, &head) {
        file.put(&message)?;
    }
    let (ticks, last_tick) = (file.ticks, file.last_tick);
    file.put(&Message::stats(&pb::Stats {
        tick: last_tick,
        ..pb::Stats::default()
    }))?;
    let clean = session.is_clean() && session.cut_short.is_none();
    let path = file.finish(
        session.end_number("dropped_records").unwrap_or(0),
        clean,
        &[],
    )?;
    Ok(Recovered {
        path,
        ticks,
        last_tick,
        cut_short: session.cut_short,
    })
}

/// All messages, in the order of the simulation: a tick, its nets, what came between it and the
/// next.
fn messages(session: &Session, head: &Head) -> Vec<Message> {
    let mut all: Vec<(u64, u8, Message)> = Vec::new();
    for record in &session.ticks {
        all.push((
            record.output.tick,
            0,
            Message::tick(record, head.tools.len()),
        ));
    }
    for net in &session.nets {
        let Some(body) = head.bodies.iter().position(|body| body.id == net.body) else {
            continue;
        };
        let points: Vec<_> = net
            .points
            .chunks_exact(3)
            .map(|p| [p[0], p[1], p[2]].into())
            .collect();
        all.push((
            net.tick,
            1,
            Message::net(net.tick, net.revision, body, &head.bodies[body], &points),
        ));
    }
    for event in &session.events {
        all.push((
            event.tick,
            2,
            Message::event(event.tick, &event.kind, &event.detail),
        ));
    }
    // Commands and keyframes of one tick keep the order that the keyframes tell.
    let mut commands = &session.commands[..];
    for keyframe in &session.keyframes {
        let before = commands.partition_point(|(after, _)| *after < keyframe.tick);
        let (first, rest) = commands.split_at(before);
        let own = rest.partition_point(|(after, _)| *after <= keyframe.tick);
        let earlier = session
            .commands
            .partition_point(|(after, _)| *after < keyframe.tick);
        let passed = (session.commands.len() - rest.len()).saturating_sub(earlier);
        let (held, rest) =
            rest.split_at(own.min((keyframe.commands as usize).saturating_sub(passed)));
        let between = first.iter().chain(held);
        all.extend(between.map(|(after, command)| (*after, 3, Message::command(*after, *command))));
        let Keyframe {
            tick,
            state_hash,
            commands: count,
            saved,
        } = keyframe;
        all.push((
            *tick,
            3,
            Message::keyframe(*tick, *state_hash, *count, saved, 0),
        ));
        commands = rest;
    }
    all.extend(
        commands
            .iter()
            .map(|(after, command)| (*after, 3, Message::command(*after, *command))),
    );
    all.sort_by_key(|(tick, rank, _)| (*tick, *rank));
    all.into_iter().map(|(_, _, message)| message).collect()
}
