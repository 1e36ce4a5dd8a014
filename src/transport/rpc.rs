//! Commands of clients: to the loop, to the keeper of recordings, to the editor or to a player.

use super::answers::reply_to_call;
use super::desk::Desk;
use super::edit::Edits;
use super::events::Events;
use super::knives;
use super::link::LoopLink;
use super::nets::Nets;
use super::post::Asked;
use super::states;
use palpate_drive::archive::{ArchiveNews, ArchiveRequest};
use palpate_drive::editor::Edit;
use palpate_drive::playback::{PlayNews, PlayRequest, PlayerEnd};
use palpate_geometry::cut::CutPlane;
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_proto::messages::{EventKind, LoopState};
use palpate_proto::rpc::{Answer, Call, PlaneArgument};
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::{Command, TickOutput};
use std::sync::Arc;
use zenoh::bytes::ZBytes;

/// Takes commands, passes them on and answers them.
pub(super) struct Rpc {
    /// Commands under way.
    pub(super) desk: Desk,
    /// Plays a recording instead of a loop, if that is what runs here.
    player: Option<PlayerEnd>,
    /// What the loop was asked to do.
    state: LoopState,
}

/// Who carries out commands, and what they need to know.
pub(super) struct Parties<'a> {
    pub link: &'a mut LoopLink,
    pub events: &'a mut Events,
    pub edits: &'a mut Edits,
    pub scene: &'a Arc<Scene>,
    pub nets: &'a Nets,
    /// The newest tick that was published.
    pub newest: &'a TickOutput,
}

impl Rpc {
    /// Nothing is under way.
    pub(super) fn new(player: Option<PlayerEnd>) -> Self {
        Self {
            desk: Desk::new(),
            player,
            state: LoopState::Running,
        }
    }

    /// What the loop was asked to do.
    pub(super) fn state(&self) -> LoopState {
        self.state
    }

    /// A recording is played.
    pub(super) fn plays(&self) -> bool {
        self.player.is_some()
    }

    /// Pauses the loop of our own accord; nothing to pause where a recording is played.
    pub(super) fn pause(&mut self, link: &mut LoopLink, events: &mut Events) -> Result<(), String> {
        if self.player.is_some() || self.state != LoopState::Running {
            return Ok(());
        }
        // No one waits for its receipt: number 0.
        link.command(0, Command::Pause)?;
        self.change(Command::Pause, events);
        Ok(())
    }

    /// The loop ends, whoever said so.
    pub(super) fn end(&mut self) {
        self.state = LoopState::Stopping;
    }

    /// Takes what a command makes of the loop, and reports it.
    fn change(&mut self, command: Command, events: &mut Events) {
        let (state, event) = states::after(self.state, command);
        self.state = state;
        if let Some(kind) = event {
            events.tell(kind);
        }
    }

    /// Carries out a command, or passes it on and keeps the query until its answer comes.
    pub(super) fn take(&mut self, method: &str, query: Asked, mut parties: Parties<'_>) {
        let asked = read(method, &query).and_then(|call| {
            let id = self.desk.next_id();
            if self.player.is_some() {
                self.ask_player(id, call)
            } else {
                self.ask_live(id, call, &mut parties)
            }
        });
        match asked {
            Ok(()) => self.desk.keep(query),
            Err(reason) => reply_to_call(&query, &Answer::refused(reason)),
        }
    }

    /// Passes a call on to the loop, the keeper of recordings or the editor of a live scene.
    fn ask_live(&mut self, id: u64, call: Call, parties: &mut Parties<'_>) -> Result<(), String> {
        let method = call.method();
        if let Some(command) = loop_command(&call, parties.scene) {
            return self.ask_loop(id, parties, command?);
        }
        match call {
            Call::RecordStart { path } => {
                let path = path.map(Into::into);
                ask_archive(id, parties.events, method, ArchiveRequest::Start { path })
            }
            Call::RecordStop => ask_archive(id, parties.events, method, ArchiveRequest::Stop),
            Call::Snapshot {
                before,
                after,
                path,
            } => {
                let wanted = ArchiveRequest::Snapshot {
                    before_s: before,
                    after_s: after,
                    path: path.map(Into::into),
                };
                ask_archive(id, parties.events, method, wanted)
            }
            Call::Merge {
                bodies,
                id: name,
                continuity,
                method,
                hidden,
                tolerance,
            } => {
                let edit = Edit::Merge {
                    id: name,
                    continuity,
                    method,
                    hidden,
                    tolerance_m: tolerance,
                };
                parties
                    .edits
                    .ask(id, parties.scene, parties.nets, edit, &bodies)
            }
            Call::Isolate {
                bodies,
                method,
                gap,
                max_turn,
            } => {
                let edit = Edit::Isolate {
                    method,
                    gap_m: gap,
                    max_turn_deg: max_turn,
                };
                parties
                    .edits
                    .ask(id, parties.scene, parties.nets, edit, &bodies)
            }
            Call::Truncate { bodies, tolerance } => {
                let edit = Edit::Truncate {
                    tolerance_m: tolerance,
                };
                parties
                    .edits
                    .ask(id, parties.scene, parties.nets, edit, &bodies)
            }
            Call::Cut {
                body,
                plane,
                tool,
                kerf,
            } => {
                let edit = Edit::Cut {
                    plane: plane_of(plane, tool.as_deref(), parties)?,
                    kerf_m: kerf,
                };
                parties
                    .edits
                    .ask(id, parties.scene, parties.nets, edit, &[body])
            }
            // Seek and rate; what is for the loop has gone there.
            _ => Err(format!(
                "{method} is for recordings that are played (`palpate play`); this is a live scene"
            )),
        }
    }

    fn ask_loop(
        &mut self,
        id: u64,
        parties: &mut Parties<'_>,
        command: Command,
    ) -> Result<(), String> {
        parties.link.command(id, command)?;
        self.change(command, parties.events);
        Ok(())
    }

    fn ask_player(&mut self, id: u64, call: Call) -> Result<(), String> {
        let wanted = match call {
            Call::Reset => PlayRequest::Reset,
            Call::Pause => PlayRequest::Pause,
            Call::Resume => PlayRequest::Resume,
            Call::Step { ticks } => PlayRequest::Step(ticks),
            Call::Shutdown => PlayRequest::Stop,
            Call::Seek { tick } => PlayRequest::Seek(tick),
            Call::Rate { rate } => PlayRequest::Rate(rate),
            _ => {
                return Err(format!(
                    "{} makes no sense here: this is a recording that is played, not a live scene",
                    call.method()
                ));
            }
        };
        let gone = "the player has ended";
        let player = self.player.as_ref().ok_or(gone)?;
        player.requests.send((id, wanted)).map_err(|_| gone)?;
        if wanted == PlayRequest::Stop {
            self.state = LoopState::Stopping;
        }
        Ok(())
    }

    /// What the keeper of recordings has to tell.
    pub(super) fn take_archive_news(&mut self, events: &mut Events) {
        while let Some(news) = events.archive().and_then(|archive| archive.news()) {
            let text = |path: std::path::PathBuf| path.to_string_lossy().into_owned();
            match news {
                ArchiveNews::Done { id, tick, path } => {
                    self.desk.settle(id, &Answer::with_path(tick, text(path)));
                }
                ArchiveNews::Refused { id, reason } => {
                    self.desk.settle(id, &Answer::refused(reason));
                }
                ArchiveNews::Started { path } => {
                    events.tell(EventKind::RecordStarted { path: text(path) });
                }
                ArchiveNews::Stopped { path } => {
                    events.tell(EventKind::RecordStopped { path: text(path) });
                }
                ArchiveNews::Failed { path, reason } => {
                    events.tell(EventKind::RecordFailed {
                        path: text(path),
                        reason,
                    });
                }
            }
        }
    }

    /// What a player has reported so far. Taken before its forces and nets are, answered after them:
    /// who has the answer to a seek finds the net of that tick.
    pub(super) fn player_news(&self) -> Vec<PlayNews> {
        self.player
            .as_ref()
            .map_or_else(Vec::new, |player| player.news.try_iter().collect())
    }

    /// Tells clients what a player reported.
    pub(super) fn take_player_news(&mut self, news: Vec<PlayNews>, events: &mut Events) {
        for news in news {
            match news {
                PlayNews::Done { id, tick } => self.desk.settle(id, &Answer::at(tick)),
                PlayNews::Refused { id, reason } => {
                    self.desk.settle(id, &Answer::refused(reason));
                }
                PlayNews::Reset => events.tell(EventKind::Reset),
                PlayNews::Paused(true) => self.change(Command::Pause, events),
                PlayNews::Paused(false) => self.change(Command::Resume, events),
            }
        }
    }
}

/// What a call asks of the loop; `None` if it asks someone else.
pub fn loop_command(call: &Call, scene: &Scene) -> Option<Result<Command, String>> {
    Some(match call {
        Call::Reset => Ok(Command::Reset),
        Call::Pause => Ok(Command::Pause),
        Call::Resume => Ok(Command::Resume),
        Call::Step { ticks } => Ok(Command::Step(*ticks)),
        Call::Shutdown => Ok(Command::Stop),
        Call::MoveBody {
            body,
            position,
            orientation,
            seconds,
        } => sent(scene, body, position, orientation.as_deref(), *seconds),
        _ => return None,
    })
}

/// By which plane a call cuts: one that is given, or that of a tool where it is now.
fn plane_of(
    plane: Option<PlaneArgument>,
    tool: Option<&str>,
    parties: &Parties<'_>,
) -> Result<CutPlane, String> {
    match (plane, tool) {
        (Some(PlaneArgument { point, normal }), None) => {
            CutPlane::through(&point.into(), &Vector3::from(normal)).ok_or_else(|| {
                format!("the plane's normal {normal:?} has no direction, or its point {point:?} is out of reach")
            })
        }
        (None, Some(id)) => knives::plane_now(parties.scene, id, parties.newest),
        _ => Err(
            "cut takes a plane or a tool that is one: {\"plane\": {\"point\": [0, 0, 0.02], \"normal\": [0, 0, 1]}, \
             \"body\": \"jelly\"} or {\"tool\": \"knife\", \"body\": \"jelly\"}"
                .into(),
        ),
    }
}

/// The command that sends a body to a place.
fn sent(
    scene: &Scene,
    id: &str,
    position: &[f64],
    orientation: Option<&[f64]>,
    seconds: f64,
) -> Result<Command, String> {
    let body = (scene.body_index(id)).ok_or_else(|| format!("there is no body {id:?}"))?;
    if !scene.can_be_sent(body) {
        return Err(format!(
            "body {id:?} cannot be moved: it needs `motion` (`motion = {{}}` is enough) or `carried_by` in the scene, and model = \"rigid\""
        ));
    }
    let &[x, y, z] = position else {
        return Err(format!(
            "position is {position:?}; it has three numbers, m in the world"
        ));
    };
    let turned = orientation.unwrap_or(&[0.0, 0.0, 0.0, 1.0]);
    let &[i, j, k, w] = turned else {
        return Err(format!(
            "orientation is {turned:?}; it has four numbers, x y z w"
        ));
    };
    let quaternion = nalgebra::Quaternion::new(w, i, j, k);
    // JSON has no numbers that are not finite; the norm of what it has may still overflow.
    if !((quaternion.norm() - 1.0).abs() < 1e-6 && [x, y, z].iter().all(|x| x.abs() < 1e6)) {
        return Err(format!(
            "orientation {turned:?} has length {}; give a unit quaternion, and a position within 1e6 m",
            quaternion.norm()
        ));
    }
    Ok(Command::Send {
        body: body as u32,
        position: Point3::new(x, y, z),
        rotation: Rotation::new_normalize(quaternion),
        ticks: (seconds / scene.dt_s).round() as u32,
    })
}

/// The call of a query. Arguments are given even where there are none: who reads all keys of a bus sends no
/// payload, and means no command. What is too long is not even copied.
fn read(method: &str, query: &Asked) -> Result<Call, String> {
    let length = query.payload().map_or(0, ZBytes::len);
    Call::check_length(method, length).map_err(|e| e.to_string())?;
    let payload = query.payload().map(|p| p.to_bytes().into_owned());
    let payload = payload.filter(|bytes| !bytes.is_empty()).ok_or_else(|| {
        format!("{method} is a command: send its arguments as a JSON object, {{}} where it needs none; without a payload it has no effect")
    })?;
    Call::parse(method, &payload).map_err(|e| e.to_string())
}

fn ask_archive(
    id: u64,
    events: &mut Events,
    method: &str,
    wanted: ArchiveRequest,
) -> Result<(), String> {
    match events.archive() {
        Some(archive) => {
            archive.ask(id, wanted);
            Ok(())
        }
        None => Err(format!("{method}: recording is not enabled on this daemon")),
    }
}
