//! Commands of clients: to the loop, to the keeper of recordings, or to a player.

use super::answers::reply_json;
use super::bus::BusThread;
use super::edit::edit;
use crate::drive::archive::{ArchiveNews, ArchiveRequest};
use crate::drive::playback::{PlayNews, PlayRequest};
use crate::drive::ports::CommandRequest;
use palpate_proto::messages::{EventKind, LoopState};
use palpate_proto::rpc::{Reply, Request};
use palpate_sim::tick::record::Command;
use zenoh::bytes::ZBytes;
use zenoh::query::Query;

/// Commands under way; more are refused.
const MOST_PENDING: usize = 256;

impl BusThread {
    /// Carries out a command, or passes it on and keeps the query until its answer comes.
    pub(super) fn rpc(&mut self, method: &'static str, query: Query) {
        let refuse =
            |reason: String| reply_json(&query, query.key_expr().clone(), &Reply::refused(reason));
        let length = query.payload().map_or(0, ZBytes::len);
        if let Err(error) = Request::check_length(method, length) {
            return refuse(error.to_string());
        }
        let payload = query
            .payload()
            .map(|p| p.to_bytes().into_owned())
            .unwrap_or_default();
        let request = match Request::parse(method, &payload) {
            Ok(request) => request,
            Err(error) => return refuse(error.to_string()),
        };
        if self.pending.len() >= MOST_PENDING {
            return refuse("too many commands are waiting; try again".into());
        }
        let id = self.next_id;
        let asked = if self.settings.player.is_some() {
            self.ask_player(id, method, &request)
        } else if let Some(command) = loop_command(method, &request) {
            self.ask_loop(id, command)
        } else if let Some(edit) = edit(method, &request) {
            self.ask_editor(id, edit, request.bodies)
        } else {
            self.ask_archive(id, method, request)
        };
        match asked {
            Ok(()) => {
                self.next_id += 1;
                self.pending.push((id, query));
            }
            Err(reason) => refuse(reason),
        }
    }

    fn ask_loop(&mut self, id: u64, command: Command) -> Result<(), String> {
        if self
            .ports
            .commands
            .push(CommandRequest { id, command })
            .is_err()
        {
            return Err("too many commands are waiting; try again".into());
        }
        let (state, event) = match command {
            Command::Reset => (None, Some(EventKind::Reset)),
            Command::Pause => (Some(LoopState::Paused), Some(EventKind::Paused)),
            Command::Resume => (Some(LoopState::Running), Some(EventKind::Resumed)),
            Command::Stop => (Some(LoopState::Stopping), None),
            Command::Step(_) | Command::Quality(_) | Command::Device { .. } => (None, None),
        };
        // Once it is stopping it does nothing else.
        if self.status.state != LoopState::Stopping {
            self.status.state = state.unwrap_or(self.status.state);
        }
        if let Some(kind) = event {
            self.event(kind);
        }
        Ok(())
    }

    fn ask_archive(&mut self, id: u64, method: &str, request: Request) -> Result<(), String> {
        let path = request.path.map(Into::into);
        let wanted = match method {
            "record_start" => ArchiveRequest::Start { path },
            "record_stop" => ArchiveRequest::Stop,
            "snapshot" => ArchiveRequest::Snapshot {
                before_s: request.before.unwrap_or(DEFAULT_BEFORE_S),
                after_s: request.after.unwrap_or(0.0),
                path,
            },
            _ => {
                return Err(format!(
                    "{method} is for recordings that are played (`palpate play`); this is a live scene"
                ));
            }
        };
        match &mut self.settings.archive {
            Some(archive) => {
                archive.ask(id, wanted);
                Ok(())
            }
            None => Err(format!("{method}: this daemon has nobody who records")),
        }
    }

    fn ask_player(&mut self, id: u64, method: &str, request: &Request) -> Result<(), String> {
        let wanted = match method {
            "reset" => PlayRequest::Reset,
            "pause" => PlayRequest::Pause,
            "resume" => PlayRequest::Resume,
            "step" => PlayRequest::Step(request.ticks.unwrap_or(1)),
            "shutdown" => PlayRequest::Stop,
            "seek" => PlayRequest::Seek(
                request
                    .tick
                    .ok_or("seek needs its argument: {\"tick\": 1500}")?,
            ),
            "rate" => PlayRequest::Rate(
                request
                    .rate
                    .ok_or("rate needs its argument: {\"rate\": 0.5}")?,
            ),
            _ => {
                return Err(format!(
                    "{method} makes no sense here: this is a recording that is played, not a live scene"
                ));
            }
        };
        let gone = "the player has ended";
        let player = self.settings.player.as_ref().ok_or(gone)?;
        player.requests.send((id, wanted)).map_err(|_| gone)?;
        if wanted == PlayRequest::Stop {
            self.status.state = LoopState::Stopping;
        }
        Ok(())
    }

    /// Answers the command that has this number.
    pub(super) fn settle(&mut self, id: u64, reply: &Reply) {
        if let Some(k) = self.pending.iter().position(|(pending, _)| *pending == id) {
            let (_, query) = self.pending.swap_remove(k);
            reply_json(&query, query.key_expr().clone(), reply);
        }
    }

    /// What the keeper of recordings has to tell.
    pub(super) fn take_archive_news(&mut self) {
        while let Some(news) = self
            .settings
            .archive
            .as_mut()
            .and_then(|archive| archive.news())
        {
            let text = |path: std::path::PathBuf| path.to_string_lossy().into_owned();
            match news {
                ArchiveNews::Done { id, tick, path } => {
                    self.settle(
                        id,
                        &Reply {
                            path: Some(text(path)),
                            ..Reply::at(tick)
                        },
                    );
                }
                ArchiveNews::Refused { id, reason } => self.settle(id, &Reply::refused(reason)),
                ArchiveNews::Started { path } => {
                    self.event(EventKind::RecordStarted { path: text(path) })
                }
                ArchiveNews::Stopped { path } => {
                    self.event(EventKind::RecordStopped { path: text(path) })
                }
                ArchiveNews::Failed { path, reason } => {
                    self.event(EventKind::RecordFailed {
                        path: text(path),
                        reason,
                    });
                }
            }
        }
    }

    /// What a player has told so far. Taken before its forces and nets are, answered after them:
    /// who has the answer to a seek finds the net of that tick.
    pub(super) fn player_news(&self) -> Vec<PlayNews> {
        self.settings
            .player
            .as_ref()
            .map_or_else(Vec::new, |player| player.news.try_iter().collect())
    }

    /// Tells clients.
    pub(super) fn take_player_news(&mut self, news: Vec<PlayNews>) {
        for news in news {
            match news {
                PlayNews::Done { id, tick } => self.settle(id, &Reply::at(tick)),
                PlayNews::Refused { id, reason } => self.settle(id, &Reply::refused(reason)),
                PlayNews::Reset => self.event(EventKind::Reset),
                PlayNews::Paused(paused) => {
                    let (state, kind) = if paused {
                        (LoopState::Paused, EventKind::Paused)
                    } else {
                        (LoopState::Running, EventKind::Resumed)
                    };
                    self.status.state = state;
                    self.event(kind);
                }
            }
        }
    }
}

/// A snapshot that does not say: seconds before now.
const DEFAULT_BEFORE_S: f64 = 30.0;

fn loop_command(method: &str, request: &Request) -> Option<Command> {
    Some(match method {
        "reset" => Command::Reset,
        "pause" => Command::Pause,
        "resume" => Command::Resume,
        "step" => Command::Step(request.ticks.unwrap_or(1)),
        "shutdown" => Command::Stop,
        _ => return None,
    })
}
