//! Commands of clients: to the loop, to the keeper of recordings, or to a player.

use super::answers::reply_json;
use super::bus::BusThread;
use crate::drive::archive::{ArchiveNews, ArchiveRequest};
use crate::drive::editor::Edit;
use crate::drive::playback::{PlayNews, PlayRequest};
use crate::drive::ports::CommandRequest;
use palpate_proto::messages::{EventKind, LoopState};
use palpate_proto::rpc::{Answer, Call};
use palpate_sim::tick::record::Command;
use zenoh::bytes::ZBytes;
use zenoh::query::Query;

/// Commands under way; more are refused.
const MOST_PENDING: usize = 256;

impl BusThread {
    /// Carries out a command, or passes it on and keeps the query until its answer comes.
    pub(super) fn rpc(&mut self, method: &'static str, query: Query) {
        let refuse = |reason: String| {
            reply_json(
                &query,
                query.key_expr().clone(),
                &Answer::<()>::refused(reason),
            )
        };
        let length = query.payload().map_or(0, ZBytes::len);
        if let Err(error) = Call::check_length(method, length) {
            return refuse(error.to_string());
        }
        let payload = query
            .payload()
            .map(|p| p.to_bytes().into_owned())
            .unwrap_or_default();
        let call = match Call::parse(method, &payload) {
            Ok(call) => call,
            Err(error) => return refuse(error.to_string()),
        };
        if self.pending.len() >= MOST_PENDING {
            return refuse("too many commands are waiting; try again".into());
        }
        let id = self.next_id;
        let asked = if self.settings.player.is_some() {
            self.ask_player(id, call)
        } else {
            self.ask_live(id, call)
        };
        match asked {
            Ok(()) => {
                self.next_id += 1;
                self.pending.push((id, query));
            }
            Err(reason) => refuse(reason),
        }
    }

    /// Passes a call on to the loop, the keeper of recordings or the editor of a live scene.
    fn ask_live(&mut self, id: u64, call: Call) -> Result<(), String> {
        let method = call.method();
        match call {
            Call::Reset => self.ask_loop(id, Command::Reset),
            Call::Pause => self.ask_loop(id, Command::Pause),
            Call::Resume => self.ask_loop(id, Command::Resume),
            Call::Step { ticks } => self.ask_loop(id, Command::Step(ticks)),
            Call::Shutdown => self.ask_loop(id, Command::Stop),
            Call::RecordStart { path } => {
                let path = path.map(Into::into);
                self.ask_archive(id, method, ArchiveRequest::Start { path })
            }
            Call::RecordStop => self.ask_archive(id, method, ArchiveRequest::Stop),
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
                self.ask_archive(id, method, wanted)
            }
            Call::Merge {
                bodies,
                id: name,
                continuity,
                method,
                tolerance,
            } => {
                let edit = Edit::Merge {
                    id: name,
                    continuity,
                    method,
                    tolerance_m: tolerance,
                };
                self.ask_editor(id, edit, &bodies)
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
                self.ask_editor(id, edit, &bodies)
            }
            Call::Seek { .. } | Call::Rate { .. } => Err(format!(
                "{method} is for recordings that are played (`palpate play`); this is a live scene"
            )),
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

    fn ask_archive(&mut self, id: u64, method: &str, wanted: ArchiveRequest) -> Result<(), String> {
        match &mut self.settings.archive {
            Some(archive) => {
                archive.ask(id, wanted);
                Ok(())
            }
            None => Err(format!("{method}: recording is not enabled on this daemon")),
        }
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
        let player = self.settings.player.as_ref().ok_or(gone)?;
        player.requests.send((id, wanted)).map_err(|_| gone)?;
        if wanted == PlayRequest::Stop {
            self.status.state = LoopState::Stopping;
        }
        Ok(())
    }

    /// Answers the command that has this number.
    pub(super) fn settle(&mut self, id: u64, answer: &Answer) {
        if let Some(k) = self.pending.iter().position(|(pending, _)| *pending == id) {
            let (_, query) = self.pending.swap_remove(k);
            reply_json(&query, query.key_expr().clone(), answer);
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
                    self.settle(id, &Answer::with_path(tick, text(path)));
                }
                ArchiveNews::Refused { id, reason } => self.settle(id, &Answer::refused(reason)),
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
                PlayNews::Done { id, tick } => self.settle(id, &Answer::at(tick)),
                PlayNews::Refused { id, reason } => self.settle(id, &Answer::refused(reason)),
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
