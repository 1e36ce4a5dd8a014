//! Who starts, watches and ends the daemons of a lobby: one thread that owns them all.

use super::daemon::Daemon;
use super::session::{Ask, Refusal, Session, SessionState};
use super::settings::LobbySettings;
use super::shelf::{Offer, Shelf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

/// How often ends are looked for.
const LOOK_EVERY: Duration = Duration::from_millis(50);
/// A daemon that is not ready by then is killed: large scenes take seconds to build.
const LONGEST_START: Duration = Duration::from_secs(120);
/// A daemon that was asked to end and has not by then is killed.
const LONGEST_END: Duration = Duration::from_secs(10);
/// After the end of a process, for what it said.
const LAST_WORDS: Duration = Duration::from_secs(1);
/// No answer asks to wait longer than this before the next try.
const LONGEST_WAIT: Duration = Duration::from_secs(30);

/// A daemon, and who waits for it.
struct Place {
    session: Session,
    daemon: Daemon,
    asked: Instant,
    waits_for_start: Option<oneshot::Sender<Result<Session, Refusal>>>,
    asked_to_end: Option<Instant>,
    wait_for_end: Vec<oneshot::Sender<bool>>,
    /// What it said was wrong, before it ended.
    failure: Option<String>,
    /// All that it said has come.
    heard: bool,
    /// Its process has ended: when, and how.
    ended: Option<(Instant, String)>,
}

pub(super) struct Keeper {
    settings: LobbySettings,
    shelf: Shelf,
    asks: Receiver<Ask>,
    tell: Sender<Ask>,
    places: Vec<Place>,
}

impl Keeper {
    pub(super) fn new(settings: LobbySettings, shelf: Shelf) -> Self {
        let (tell, asks) = channel();
        Self {
            settings,
            shelf,
            asks,
            tell,
            places: Vec::new(),
        }
    }

    /// Where to ask.
    pub(super) fn asks(&self) -> Sender<Ask> {
        self.tell.clone()
    }

    /// Serves until `stop`, then ends all daemons. Daemons end with the thread that calls this.
    pub(super) fn run(mut self, stop: &AtomicBool) {
        while !stop.load(Ordering::Relaxed) {
            match self.asks.recv_timeout(LOOK_EVERY) {
                Ok(ask) => self.take(ask),
                Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {}
            }
            self.look();
        }
        self.close();
    }

    fn take(&mut self, ask: Ask) {
        match ask {
            Ask::Start { scene, reply } => self.start(scene, reply),
            Ask::List(reply) => {
                let sessions = self.places.iter().map(Place::session).collect();
                let _ = reply.send(sessions);
            }
            Ask::End { id, reply } => {
                let place = self.places.iter_mut().find(|place| place.session.id == id);
                let Some(place) = place else {
                    let _ = reply.send(false);
                    return;
                };
                place.ask_to_end();
                place.wait_for_end.push(reply);
            }
            Ask::Said { id, line } => self.said(&id, &line),
            Ask::Closed(id) => {
                let place = self.places.iter_mut().find(|place| place.session.id == id);
                if let Some(place) = place {
                    place.heard = true;
                }
            }
        }
    }

    fn start(&mut self, scene: String, reply: oneshot::Sender<Result<Session, Refusal>>) {
        let started = match self.refusal(&scene) {
            Err(refusal) => Err(refusal),
            Ok(offer) => self.spawn(&offer),
        };
        match started {
            Ok(mut place) => {
                place.waits_for_start = Some(reply);
                self.places.push(place);
            }
            Err(refusal) => drop(reply.send(Err(refusal))),
        }
    }

    fn refusal(&self, scene: &str) -> Result<Offer, Refusal> {
        let offer = self.shelf.find(scene).ok_or_else(|| Refusal::Unknown {
            name: scene.to_owned(),
            scenes: names(&self.shelf),
        })?;
        if self.places.len() >= self.settings.max {
            return Err(Refusal::Full {
                max: self.settings.max,
                retry_after: self.settings.idle_timeout.min(LONGEST_WAIT),
            });
        }
        Ok(offer)
    }

    fn spawn(&self, offer: &Offer) -> Result<Place, Refusal> {
        let failed = |error: &dyn std::fmt::Display| Refusal::Failed(error.to_string());
        let mut bits = [0; 6];
        getrandom::fill(&mut bits).map_err(|error| failed(&error))?;
        let bits: String = bits.iter().map(|byte| format!("{byte:02x}")).collect();
        let id = format!("lobby-{bits}");
        let arguments = self.settings.arguments(&offer.source, &id);
        let daemon = Daemon::start(&id, &arguments, self.tell.clone());
        let daemon = daemon.map_err(|error| failed(&error))?;
        tracing::info!(
            session = id,
            scene = offer.name,
            pid = daemon.pid(),
            "starting"
        );
        Ok(Place {
            session: Session {
                instance: id.clone(),
                id,
                scene: offer.name.clone(),
                state: SessionState::Starting,
                endpoint: None,
                page: None,
                pid: daemon.pid(),
                age_s: 0.0,
            },
            daemon,
            asked: Instant::now(),
            waits_for_start: None,
            asked_to_end: None,
            wait_for_end: Vec::new(),
            failure: None,
            heard: false,
            ended: None,
        })
    }

    /// A daemon says where it listens, or why it does not.
    fn said(&mut self, id: &str, line: &serde_json::Value) {
        let host = self.settings.host.as_deref();
        let Some(place) = self.places.iter_mut().find(|place| place.session.id == id) else {
            return;
        };
        if line["ready"] != true {
            place.failure = line["error"].as_str().map(str::to_owned);
            return;
        }
        let text = |value: &serde_json::Value| value.as_str().map(str::to_owned);
        let endpoint = text(&line["listen"][0]);
        place.session.endpoint = endpoint.map(|endpoint| reached_at(&endpoint, host));
        place.session.page = text(&line["page"]);
        if place.asked_to_end.is_none() {
            place.session.state = SessionState::Ready;
        }
        if let Some(reply) = place.waits_for_start.take() {
            let _ = reply.send(Ok(place.session()));
        }
    }

    /// Ends what takes too long, and lets go of what has ended.
    fn look(&mut self) {
        self.places.retain_mut(|place| {
            let starting = place.waits_for_start.is_some();
            if starting && place.asked.elapsed() > LONGEST_START {
                place.daemon.kill();
                if let Some(reply) = place.waits_for_start.take() {
                    let _ = reply.send(Err(Refusal::Slow(LONGEST_START)));
                }
            }
            if place
                .asked_to_end
                .is_some_and(|at| at.elapsed() > LONGEST_END)
            {
                place.daemon.kill();
            }
            if place.ended.is_none() {
                let status = place.daemon.ended();
                place.ended = status.map(|status| (Instant::now(), status.to_string()));
            }
            // Its last words may still be on their way from the thread that reads them.
            let over = |at: Instant| place.heard || at.elapsed() > LAST_WORDS;
            match place.ended.clone().filter(|(at, _)| over(*at)) {
                None => true,
                Some((_, status)) => {
                    place.over(&status);
                    false
                }
            }
        });
    }

    /// Ends all daemons, each as gently as it lets itself be ended.
    fn close(mut self) {
        self.places.iter_mut().for_each(Place::ask_to_end);
        let begun = Instant::now();
        while !self.places.is_empty() && begun.elapsed() < LONGEST_END {
            while let Ok(ask) = self.asks.try_recv() {
                match ask {
                    Ask::Start { reply, .. } => drop(reply.send(Err(Refusal::Closing))),
                    ask => self.take(ask),
                }
            }
            self.look();
            std::thread::sleep(LOOK_EVERY);
        }
    }
}

impl Place {
    fn session(&self) -> Session {
        Session {
            age_s: self.asked.elapsed().as_secs_f64(),
            ..self.session.clone()
        }
    }

    fn ask_to_end(&mut self) {
        if self.asked_to_end.is_none() {
            self.daemon.ask_to_end();
            self.asked_to_end = Some(Instant::now());
            self.session.state = SessionState::Ending;
        }
    }

    /// The daemon has ended.
    fn over(&mut self, status: &str) {
        let session = &self.session.id;
        match self.asked_to_end {
            Some(_) => tracing::info!(session, status, "ended"),
            None => tracing::warn!(session, status, "a daemon ended by itself"),
        }
        if let Some(reply) = self.waits_for_start.take() {
            let reason = self.failure.take();
            let reason =
                reason.unwrap_or_else(|| format!("{status}; its messages are in the lobby's log"));
            let _ = reply.send(Err(Refusal::Failed(reason)));
        }
        for reply in self.wait_for_end.drain(..) {
            let _ = reply.send(true);
        }
    }
}

pub(super) fn names(shelf: &Shelf) -> Vec<String> {
    shelf.offers().into_iter().map(|offer| offer.name).collect()
}

/// An endpoint under the host by which clients reach this machine.
fn reached_at(endpoint: &str, host: Option<&str>) -> String {
    let parts = endpoint.split_once('/').and_then(|(protocol, address)| {
        let (_, port) = address.rsplit_once(':')?;
        Some((protocol, port))
    });
    match (parts, host) {
        (Some((protocol, port)), Some(host)) => format!("{protocol}/{host}:{port}"),
        _ => endpoint.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endpoints_are_told_under_the_name_of_the_host() {
        assert_eq!(
            reached_at("tls/0.0.0.0:4711", Some("lab.example")),
            "tls/lab.example:4711"
        );
        assert_eq!(reached_at("tcp/[::]:1", Some("10.0.0.7")), "tcp/10.0.0.7:1");
        assert_eq!(reached_at("tcp/127.0.0.1:5", None), "tcp/127.0.0.1:5");
        let socket = "unixsock-stream//run/palpate.sock";
        assert_eq!(reached_at(socket, Some("lab")), socket);
    }
}
