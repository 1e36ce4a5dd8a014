//! `palpate play`: recordings on the bus as if they were live.

use crate::daemon::{Daemon, PROGRAM};
use crate::golden::made_again;
use palpate_client::proto::messages::{EventKind, LoopState, ToolForce};
use palpate_client::proto::rpc::Call;
use palpate_client::{Palpate, pose_at};
use palpate_drive::playback::{PlayRequest, playback};
use palpate_drive::ports::ports;
use palpate_geometry::math::Point3;
use palpate_record::{
    Contents, PlayError, PlayReport, PlaySettings, Player, Session, played_scene,
};
use palpate_sim::scene::Scene;
use palpate_sim::tick::SceneState;
use palpate_sim::tick::record::{TickOutput, TickRecord};
use palpate_sim::tick::{apply, restore, step};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

fn golden() -> PathBuf {
    made_again("small-lattice-press")
}

/// A player in a process of its own, that listens on a free port.
fn play(arguments: &[&str]) -> Daemon {
    let port = std::net::TcpListener::bind("127.0.0.1:0")
        .unwrap()
        .local_addr()
        .unwrap()
        .port();
    Daemon::spawn(
        port,
        Command::new(PROGRAM)
            .arg("play")
            .arg(golden())
            .arg("--json")
            .args(arguments),
    )
}

fn until<T: std::fmt::Debug>(
    what: &str,
    mut look: impl FnMut() -> T,
    holds: impl Fn(&T) -> bool,
) -> T {
    let started = Instant::now();
    loop {
        let seen = look();
        if holds(&seen) {
            return seen;
        }
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "{what}: {seen:?}"
        );
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

fn net(scene: &Scene, state: &SceneState) -> Vec<u64> {
    let mut points = vec![Point3::origin(); scene.rest_surface(0).unwrap().net().points().len()];
    state.copy_net(scene, 0, &mut points);
    bits(
        &points
            .iter()
            .flat_map(|p| [p.x, p.y, p.z])
            .collect::<Vec<_>>(),
    )
}

/// Nets after some ticks, by a replay of our own: from the first keyframe through every record.
fn nets_after(session: &Session, ticks: &[u64]) -> BTreeMap<u64, Vec<u64>> {
    let scene = played_scene(session, &[]).unwrap();
    let session = Contents::of(session).unwrap();
    let mut state = scene.initial_state();
    let mut scratch = scene.scratch(&state);
    restore(
        &scene,
        &mut state,
        &mut scratch,
        &session.keyframes[0].saved,
    )
    .unwrap();
    let mut commands = session.commands.iter().peekable();
    let mut found = BTreeMap::from([(0, net(&scene, &state))]);
    for record in &session.ticks {
        while let Some((_, command)) = commands.next_if(|(after, _)| *after < record.output.tick) {
            apply(&scene, &mut state, &mut scratch, *command);
        }
        let output = step(&scene, &mut state, &mut scratch, &record.input);
        assert_eq!(
            output.state_hash, record.output.state_hash,
            "another build: tick {}",
            output.tick
        );
        if ticks.contains(&output.tick) {
            found.insert(output.tick, net(&scene, &state));
        }
    }
    found
}

fn shown_net(palpate: &Palpate) -> (u64, Vec<u64>) {
    let scene = palpate.scene().unwrap();
    (scene.tick, bits(scene.bodies[0].points.as_flattened()))
}

fn recorded_force(session: &Contents, tick: u64) -> Vec<u64> {
    let force = session.ticks[tick as usize - 1].output.tools[0].force_n;
    bits(force.as_slice())
}

#[test]
fn a_recording_played_fast_gives_its_forces_and_its_last_net() {
    let session = Session::open(&golden()).unwrap();
    let kept = Contents::of(&session).unwrap();
    let last = session.tick_range().unwrap().1;
    let player = play(&["--paused", "--stay", "--rate", "10000"]);
    let palpate = player.connect();
    let forces = Arc::new(Mutex::new(Vec::<ToolForce>::new()));
    let taken = forces.clone();
    let watching = palpate.watch("palpate/default/tool/ball/force", move |seen| {
        let force = palpate_client::proto::codec::decode(&seen.bytes, seen.schema()).unwrap();
        taken.lock().unwrap().push(force);
    });
    // A status that arrives says that subscriptions are known over there.
    let statuses = palpate.statuses().unwrap();
    until("a status", || statuses.get(), Option::is_some);
    assert_eq!(palpate.status().unwrap().state, LoopState::Paused);
    assert_eq!(
        shown_net(&palpate),
        (0, nets_after(&session, &[])[&0].clone())
    );
    palpate.rpc(Call::Resume).unwrap();
    until(
        "the end",
        || palpate.status().unwrap(),
        |status| status.tick == last && status.state == LoopState::Paused,
    );
    assert_eq!(
        shown_net(&palpate),
        (last, nets_after(&session, &[last])[&last].clone())
    );
    // What a full network dropped is not sent again; where it stands still it is.
    let tick = palpate.rpc(Call::Seek { tick: last }).unwrap();
    let newest = || forces.lock().unwrap().last().map_or(0, |force| force.tick);
    until("the last force", newest, |newest| *newest == tick);
    drop(watching);
    let forces = forces.lock().unwrap();
    for force in forces.iter() {
        let recorded = &kept.ticks[force.tick as usize - 1].output.tools[0];
        assert_eq!(
            bits(&force.force),
            bits(recorded.force_n.as_slice()),
            "tick {}",
            force.tick
        );
        assert_eq!(
            (force.pose_seq, force.flags),
            (recorded.pose_seq, recorded.flags)
        );
    }
    assert!(forces.windows(2).all(|pair| pair[1].tick >= pair[0].tick));
    assert!(
        forces.len() as u64 > last / 4,
        "only {} forces of {last}",
        forces.len()
    );
    assert!(
        forces.iter().any(|force| force.force != [0.0; 3]),
        "nothing was felt"
    );
    palpate.rpc(Call::Shutdown).unwrap();
    let (text, code) = player.end();
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (code, report["ticks"].as_u64(), report["last_tick"].as_u64()),
        (0, Some(last), Some(last)),
        "{text}"
    );
    assert_eq!(
        (report["gaps"].as_u64(), &report["diverged"]),
        (Some(0), &serde_json::Value::Null)
    );
}

#[test]
fn a_seek_shows_the_net_and_the_force_of_its_tick() {
    let session = Session::open(&golden()).unwrap();
    let kept = Contents::of(&session).unwrap();
    let last = session.tick_range().unwrap().1;
    let ticks = [700, 3, last, 1_000, 1_001, 999, 1, 700];
    let nets = nets_after(&session, &[&ticks[..], &[705]].concat());
    let player = play(&["--paused", "--stay"]);
    let palpate = player.connect();
    let force = palpate.forces("ball").unwrap();
    until(
        "a status",
        || palpate.status().unwrap().tick,
        |tick| *tick == 0,
    );
    let seek = |tick| palpate.rpc(Call::Seek { tick });
    for tick in ticks {
        assert_eq!(seek(tick).unwrap(), tick);
        assert_eq!(
            shown_net(&palpate),
            (tick, nets[&tick].clone()),
            "tick {tick}"
        );
        assert_eq!(palpate.status().unwrap().tick, tick);
        // A tick without a pose in effect has no force to send.
        if kept.ticks[tick as usize - 1].output.tools[0].pose_seq > 0 {
            let felt = until(
                "the force",
                || force.newest().force,
                |force| force.is_some_and(|force| force.tick == tick),
            )
            .unwrap();
            assert_eq!(
                bits(&felt.force),
                recorded_force(&kept, tick),
                "tick {tick}"
            );
        }
    }
    // From there it goes on by steps, and to where there is nothing it does not go.
    assert_eq!(palpate.rpc(Call::Step { ticks: 5 }).unwrap(), 705);
    assert_eq!(shown_net(&palpate), (705, nets[&705].clone()));
    let error = seek(last + 1).unwrap_err().to_string();
    assert!(
        error.contains("cannot be reached") && error.contains(&last.to_string()),
        "{error}"
    );
    assert_eq!(palpate.status().unwrap().tick, 705, "a refused seek moved");
    assert_eq!(seek(0).unwrap(), 0);
    assert_eq!(shown_net(&palpate), (0, nets[&0].clone()));
}

#[test]
fn a_player_is_steered_by_rpc_and_hears_no_poses() {
    let arguments = [
        "--loop",
        "--end",
        "300",
        "--rate",
        "100",
        "--remap",
        "ball:=pen",
        "--remap",
        "drop:=jelly",
    ];
    let player = play(&[&arguments[..], &["--instance", "film"]].concat());
    let settings = palpate_client::Connect {
        instance: "film".into(),
        timeout: Duration::from_secs(20),
        ..palpate_client::Connect::to(&player.endpoint)
    };
    let palpate = Palpate::connect(&settings).unwrap();
    let scene = palpate.scene().unwrap();
    assert_eq!(
        (scene.tools[0].id.as_str(), scene.bodies[0].id.as_str()),
        ("pen", "jelly")
    );
    assert!(!scene.lockstep, "nobody is waited for");
    let resets = || {
        let events = palpate.past_events(0).unwrap();
        events
            .iter()
            .filter(|event| event.kind == EventKind::Reset)
            .count()
    };
    until("two rounds", resets, |resets| *resets >= 2);
    let refused = |call: Call, words: &str| {
        let error = palpate.call(call.clone()).unwrap_err().to_string();
        assert!(error.contains(words), "{call:?}: {error}");
    };
    refused(Call::Step { ticks: 1 }, "pause it first");
    refused(
        Call::RecordStart { path: None },
        "record_start makes no sense here",
    );
    let snapshot = Call::parse("snapshot", b"").unwrap();
    refused(snapshot, "snapshot makes no sense here");
    refused(Call::Rate { rate: 1e9 }, "between");
    palpate.rpc(Call::Rate { rate: 0.001 }).unwrap();
    palpate.rpc(Call::Pause).unwrap();
    let tick = palpate.rpc(Call::Seek { tick: 120 }).unwrap();
    assert_eq!(tick, 120);
    // Poses for a tool that is played do not move it.
    let mut tool = palpate.tool("pen").unwrap();
    let before = palpate.scene().unwrap();
    for _ in 0..20 {
        tool.send(pose_at([1.0, 2.0, 3.0])).unwrap();
    }
    assert_eq!(palpate.rpc(Call::Step { ticks: 1 }).unwrap(), 121);
    let after = palpate.scene().unwrap();
    assert!(
        (0..3).all(|k| (after.tools[0].position[k] - before.tools[0].position[k]).abs() < 1e-3),
        "{after:?}"
    );
    assert_eq!(palpate.status().unwrap().tools[0].received, 0);
    // Steps end at the last tick to play.
    assert_eq!(palpate.rpc(Call::Step { ticks: 10_000 }).unwrap(), 300);
    assert_eq!(palpate.rpc(Call::Reset).unwrap(), 0);
    drop(tool);
    palpate.rpc(Call::Shutdown).unwrap();
    let (text, code) = player.end();
    assert_eq!(code, 0, "{text}");
}

#[test]
fn what_cannot_be_played_is_said_and_ends_with_two() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("garbage.mcap");
    std::fs::write(&path, b"no recording").unwrap();
    let golden = golden();
    let run = |file: &Path, arguments: &[&str]| {
        let output = Command::new(PROGRAM)
            .arg("play")
            .arg(file)
            .args(arguments)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        (
            String::from_utf8_lossy(&output.stderr).into_owned(),
            output.status.code(),
        )
    };
    for (file, arguments, words) in [
        (path.as_path(), &[][..], "not an MCAP file"),
        (&directory.path().join("none.mcap"), &[], "none.mcap"),
        (&golden, &["--remap", "bull:=pen"], "it has ball, drop"),
        (&golden, &["--remap", "ball:=Pen"], "is not a valid id"),
        (&golden, &["--remap", "ball"], "write old:=new"),
        (&golden, &["--start", "5000"], "the recording has 1 to 1500"),
        (
            &golden,
            &["--start", "900", "--end", "800"],
            "no tick lies between",
        ),
        (&golden, &["--rate", "0"], "0.001 to 10000"),
    ] {
        let (error, code) = run(file, arguments);
        assert!(
            code == Some(2) && error.contains(words),
            "{arguments:?}: {code:?} {error}"
        );
    }
}

/// Plays a session without a network; gives what was published, or why it cannot be played.
fn try_published(
    session: Session,
    settings: PlaySettings,
    requests: &[PlayRequest],
) -> Result<(Vec<TickOutput>, PlayReport), PlayError> {
    let scene = Arc::new(played_scene(&session, &[])?);
    let (tick_ports, mut bus) = ports(&scene);
    let (_end, port, own) = playback();
    for &request in requests {
        own.send((0, request)).unwrap();
    }
    let player = Player::new(session, scene.clone(), tick_ports, port, settings)?;
    let thread = std::thread::spawn(move || player.run(&scene));
    let mut outputs = Vec::new();
    loop {
        let over = thread.is_finished();
        while bus.records.pop().is_ok() {}
        bus.nets.iter_mut().for_each(|net| drop(net.newest()));
        while let Ok(told) = bus.outputs.pop() {
            outputs.push(told.output.clone());
        }
        if over {
            return thread.join().unwrap().map(|report| (outputs, report));
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn published(
    session: Session,
    settings: PlaySettings,
    requests: &[PlayRequest],
) -> (Vec<TickOutput>, PlayReport) {
    try_published(session, settings, requests).unwrap()
}

const FAST: PlaySettings = PlaySettings {
    start: None,
    end: None,
    rate: 1e4,
    paused: false,
    looped: false,
    stay: false,
};

#[test]
fn a_gap_is_jumped_to_the_next_keyframe() {
    let mut session = Contents::open(&golden()).unwrap();
    session
        .ticks
        .retain(|record| !(300..=900).contains(&record.output.tick));
    let (outputs, report) = published(session.session().unwrap(), FAST, &[]);
    let ticks: Vec<u64> = outputs.iter().map(|output| output.tick).collect();
    // The start is shown, then 1 to 299, then from the keyframe at 1000 on.
    let expected: Vec<u64> = (0..=299).chain(1_001..=1_500).collect();
    assert_eq!(ticks, expected);
    assert_eq!((report.gaps, report.ticks, report.diverged), (1, 799, None));
    // Into the gap nobody can seek.
    let (outputs, _) = published(
        session.session().unwrap(),
        PlaySettings {
            paused: true,
            ..FAST
        },
        &[PlayRequest::Seek(950), PlayRequest::Stop],
    );
    assert_eq!(outputs.len(), 1);
}

#[test]
fn where_this_build_steps_otherwise_the_recorded_force_wins() {
    let mut session = Contents::open(&golden()).unwrap();
    let forge = |record: &mut TickRecord| {
        record.output.tools[0].force_n.x += 0.125;
        record.output.state_hash ^= 1;
    };
    for record in session
        .ticks
        .iter_mut()
        .filter(|record| record.output.tick >= 400)
    {
        forge(record);
    }
    let (outputs, report) = published(session.session().unwrap(), FAST, &[]);
    assert_eq!((report.diverged, report.ticks), (Some(400), 1_500));
    for (output, record) in outputs[1..].iter().zip(&session.ticks) {
        let (felt, recorded) = (output.tools[0].force_n, record.output.tools[0].force_n);
        assert_eq!(
            bits(felt.as_slice()),
            bits(recorded.as_slice()),
            "tick {}",
            output.tick
        );
    }
}

#[test]
fn start_end_and_steps_bound_what_is_played() {
    let session = Session::open(&golden()).unwrap();
    let (outputs, report) = published(
        session.clone(),
        PlaySettings {
            start: Some(500),
            end: Some(520),
            ..FAST
        },
        &[],
    );
    let ticks: Vec<u64> = outputs.iter().map(|output| output.tick).collect();
    assert_eq!(ticks, (499..=520).collect::<Vec<_>>());
    assert_eq!((report.ticks, report.last_tick, report.loops), (21, 520, 0));
    let requests = [
        PlayRequest::Step(3),
        PlayRequest::Seek(1_200),
        PlayRequest::Back,
        PlayRequest::Back,
        PlayRequest::Stop,
    ];
    let (outputs, report) = published(
        session,
        PlaySettings {
            paused: true,
            ..FAST
        },
        &requests,
    );
    let ticks: Vec<u64> = outputs.iter().map(|output| output.tick).collect();
    assert_eq!(ticks, [0, 1, 2, 3, 1_200, 1_000, 0]);
    assert_eq!(report.ticks, 3);
}

#[test]
fn damaged_recordings_are_played_as_far_as_they_go_or_refused() {
    let golden = std::fs::read(golden()).unwrap();
    let mut state = 5u64;
    let mut below = |count: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % count
    };
    let (mut played, mut gaps) = (0, 0);
    for change in 0..40 {
        let mut bytes = golden.clone();
        let at = below(bytes.len());
        match change % 4 {
            0 => bytes.truncate(at),
            1 => bytes[at] ^= 1 << below(8),
            2 => drop(bytes.drain(at..(at + below(5_000)).min(golden.len()))),
            _ => bytes[at..(at + 64).min(golden.len())].fill(0xff),
        }
        let Ok(session) = Session::parse(Path::new("damaged"), &bytes) else {
            continue;
        };
        let requests = [
            PlayRequest::Seek(700),
            PlayRequest::Back,
            PlayRequest::Rate(1e4),
        ];
        if let Ok((outputs, report)) = try_published(session, FAST, &requests) {
            assert!(
                outputs.iter().all(|output| output.tick <= 1_500),
                "change {change}"
            );
            played += 1;
            gaps += report.gaps;
        }
    }
    assert!(
        played > 10 && gaps > 0,
        "{played} of 40 were played, over {gaps} gaps"
    );
}

#[test]
fn ticks_that_repeat_or_states_of_other_ticks_do_not_hang() {
    let mut twice = Contents::open(&golden()).unwrap();
    let again = twice.ticks[200].clone();
    twice.ticks.insert(200, again);
    let (outputs, report) = published(twice.session().unwrap(), FAST, &[]);
    assert_eq!((report.ticks, outputs.last().unwrap().tick), (1_500, 1_500));
    let mut moved = Contents::open(&golden()).unwrap();
    moved
        .ticks
        .retain(|record| !(300..=900).contains(&record.output.tick));
    for keyframe in moved
        .keyframes
        .iter_mut()
        .filter(|keyframe| keyframe.tick > 0)
    {
        keyframe.tick += 7;
    }
    let error = try_published(moved.session().unwrap(), FAST, &[])
        .unwrap_err()
        .to_string();
    assert!(error.contains("keyframe at tick 1007"), "{error}");
}
