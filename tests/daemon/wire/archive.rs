//! Recording on demand, with a keeper of recordings that only plays one.

use super::{SCENE, until};
use palpate::transport::{Bus, BusSettings, SessionSettings, open};
use palpate_client::proto::messages::{EventKind, RecorderState};
use palpate_client::proto::rpc::Call;
use palpate_client::{Connect, Palpate};
use palpate_drive::archive::{Archive, ArchiveNews, ArchiveRequest};
use palpate_drive::driver::{self, DriverSettings};
use palpate_drive::journal::{JournalGauges, NoJournal, keeping};
use palpate_drive::ports::ports;
use palpate_sim::scene::{Scene, file};
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::time::Duration;

type Log = Arc<Mutex<Vec<String>>>;

/// Says yes to a start, no to a stop, and that a snapshot met a full disk.
struct Pretender {
    log: Log,
    news: VecDeque<ArchiveNews>,
    gauges: Arc<JournalGauges>,
}

impl Archive for Pretender {
    fn event(&mut self, _: u64, kind: &str, detail: &str) {
        self.log.lock().unwrap().push(format!("{kind} {detail}"));
    }

    fn ask(&mut self, id: u64, request: ArchiveRequest) {
        self.log.lock().unwrap().push(format!("{request:?}"));
        match request {
            ArchiveRequest::Start { path } => {
                let path = path.unwrap_or_else(|| PathBuf::from("kept/here.mcap"));
                self.gauges
                    .state
                    .store(keeping::RECORDING, Ordering::Relaxed);
                self.news
                    .push_back(ArchiveNews::Started { path: path.clone() });
                self.news.push_back(ArchiveNews::Done { id, tick: 7, path });
            }
            ArchiveRequest::Stop => {
                self.news.push_back(ArchiveNews::Refused {
                    id,
                    reason: "nothing is being recorded".into(),
                });
            }
            ArchiveRequest::Snapshot { .. } => {
                let (path, reason) = (
                    PathBuf::from("s.mcap"),
                    "no space left on device".to_owned(),
                );
                self.gauges.state.store(keeping::FAILED, Ordering::Relaxed);
                self.news.push_back(ArchiveNews::Failed {
                    path,
                    reason: reason.clone(),
                });
                self.news.push_back(ArchiveNews::Refused { id, reason });
            }
        }
    }

    fn news(&mut self) -> Option<ArchiveNews> {
        self.news.pop_front()
    }
}

#[test]
fn requests_go_to_the_keeper_and_its_news_become_answers_events_and_tokens() {
    let loaded = file::parse(SCENE, "test.toml", Path::new(".")).unwrap();
    let scene = Arc::new(Scene::build(&loaded.spec, Path::new(".")).unwrap());
    let port = std::net::TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port();
    let endpoint = format!("tcp/127.0.0.1:{port}");
    let session = open(&SessionSettings {
        listen: vec![endpoint.clone()],
        ..Default::default()
    })
    .unwrap();
    let (tick_ports, bus_ports) = ports(&scene);
    let (log, gauges) = (Log::default(), Arc::new(JournalGauges::default()));
    let archive = Pretender {
        log: log.clone(),
        news: VecDeque::new(),
        gauges: gauges.clone(),
    };
    let settings = BusSettings {
        open: Vec::new(),
        scene: scene.clone(),
        scene_hash: loaded.sha256,
        instance: "default".into(),
        viewer: None,
        viewer_url: None,
        recorder: Some(gauges),
        archive: Some(Box::new(archive)),
        editor: None,
        player: None,
        adapters: Default::default(),
        health: None,
    };
    let bus = Bus::start(session, bus_ports, settings).unwrap();
    let driving = DriverSettings {
        clock: scene.clock,
        ticks: None,
        privileged: false,
        follow: false,
        threads: 1,
    };
    let thread = driver::start(scene, tick_ports, Box::new(NoJournal), driving).unwrap();

    let palpate = Palpate::connect(&Connect {
        timeout: Duration::from_secs(20),
        ..Connect::to(&endpoint)
    })
    .unwrap();
    assert_eq!(palpate.status().unwrap().recorder, RecorderState::Off);
    let path = |path: &str| Some(path.to_owned());
    let done = palpate
        .call(Call::RecordStart {
            path: path("a.mcap"),
        })
        .unwrap();
    assert_eq!((done.tick, done.path), (7, path("a.mcap")));
    let done = palpate.call(Call::RecordStart { path: None }).unwrap();
    assert_eq!(done.path, path("kept/here.mcap"));
    until(
        "the status says so",
        || palpate.status().unwrap().recorder,
        |state| *state == RecorderState::Recording,
    );
    let token = "palpate/default/@live/recorder/*";
    let patience = Duration::from_secs(20);
    assert_eq!(
        palpate
            .live(token, patience, |keys| !keys.is_empty())
            .unwrap()
            .len(),
        1
    );
    let refused = palpate.call(Call::RecordStop).unwrap_err().to_string();
    assert!(
        refused.contains("record_stop was refused: nothing is being recorded"),
        "{refused}"
    );
    let snapshot = Call::Snapshot {
        before: 2.5,
        after: 0.25,
        path: path("s.mcap"),
    };
    let refused = palpate.call(snapshot).unwrap_err().to_string();
    assert!(refused.contains("no space left"), "{refused}");
    until(
        "the token goes",
        || palpate.live(token, Duration::ZERO, |_| true).unwrap(),
        Vec::is_empty,
    );
    assert_eq!(palpate.status().unwrap().recorder, RecorderState::Failed);

    let events: Vec<EventKind> = palpate
        .past_events(0)
        .unwrap()
        .into_iter()
        .map(|event| event.kind)
        .collect();
    let failed = EventKind::RecordFailed {
        path: "s.mcap".into(),
        reason: "no space left on device".into(),
    };
    assert!(
        events.contains(&EventKind::RecordStarted {
            path: "a.mcap".into()
        }) && events.contains(&failed),
        "{events:?}"
    );
    palpate.rpc(Call::Pause).unwrap();
    palpate.rpc(Call::Shutdown).unwrap();
    thread.join().unwrap();
    bus.finish();
    let log = log.lock().unwrap();
    for line in [
        "Start { path: Some(\"a.mcap\") }",
        "Start { path: None }",
        "Stop",
        "Snapshot { before_s: 2.5, after_s: 0.25, path: Some(\"s.mcap\") }",
        "record_started a.mcap",
        "record_failed s.mcap: no space left on device",
        "paused ",
        "stopping ",
    ] {
        assert!(
            log.iter().any(|entry| entry == line),
            "{line:?} is missing in {log:?}"
        );
    }
}
