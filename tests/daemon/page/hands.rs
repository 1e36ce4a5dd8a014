//! The page as a device: it holds a tool, moves it, gives commands.

use super::{SOFT, TWO_BALLS};
use crate::daemon::PROGRAM;
use crate::page::{Page, serve};
use palpate_client::pose_at;
use palpate_client::proto::codec::decode;
use palpate_client::proto::messages::{
    EventKind, LoopState, SimEvent, ToolForce, ToolPose, force_flags,
};
use std::process::Command;
use std::time::{Duration, Instant};

fn press(page: &mut Page, ticks: u64) -> f64 {
    let mut strongest = 0.0_f64;
    for seq in 1..=ticks {
        let depth = 0.045 * (seq as f64 / ticks as f64);
        let pose = ToolPose {
            seq,
            t_client_ns: seq * 16_000_000,
            ..pose_at([0.06 - depth, 0.003, 0.045])
        };
        page.pose("ball", &pose);
        let force = page.until("its force", |key, payload| {
            (key == "tool/ball/force").then_some(())?;
            let force: ToolForce = decode(payload, "").unwrap();
            (force.pose_seq >= seq).then_some(force)
        });
        strongest = strongest.max(force.force[0].abs());
    }
    strongest
}

#[test]
fn a_page_s_mouse_presses_the_body_and_its_recording_replays_bit_for_bit() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("drag.mcap");
    let record = path.to_str().unwrap();
    let (daemon, port) = serve(directory.path(), SOFT, &["--record", record]);
    let palpate = daemon.connect();
    let mut page = Page::open(port);
    page.claim("ball", "mouse of a test");
    page.holder("ball", |who| who == Some("mouse of a test"));
    let strongest = press(&mut page, 60);
    assert!(strongest > 0.05, "{strongest} N");
    // On the bus it is a device like any other.
    assert_eq!(palpate.device("ball").unwrap().name, "mouse of a test");
    let status = palpate.status().unwrap();
    assert_eq!(status.tools[0].received, 60, "{:?}", status.tools[0]);
    let tokens = palpate.live(
        "palpate/default/@live/tool/*",
        Duration::from_secs(20),
        |keys| !keys.is_empty(),
    );
    assert_eq!(tokens.unwrap(), ["palpate/default/@live/tool/ball"]);
    assert_eq!(page.call("shutdown", "{}")["ok"], true);
    let (_, code) = daemon.end();
    assert_eq!(code, 0);
    let replay = Command::new(PROGRAM)
        .args(["replay", record])
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&replay.stdout).into_owned();
    assert!(replay.status.success(), "{words}");
    let info = Command::new(PROGRAM)
        .args(["info", record, "--json"])
        .output()
        .unwrap();
    let info: serde_json::Value = serde_json::from_slice(&info.stdout).unwrap();
    let peak = info["tools"][0]["peak_force_n"].as_f64().unwrap();
    assert!(peak >= strongest - 1e-9, "{peak} N, {strongest} N");
}

/// A soft drop and a ball whose pose is stale after 0.4 s, long enough for a busy machine.
fn patient() -> String {
    format!("{SOFT}device = {{ stale_s = 0.4 }}\n")
}

/// The next event that `take` takes.
fn event<T>(page: &mut Page, what: &str, take: impl Fn(&EventKind) -> Option<T>) -> T {
    page.until(what, |key, payload| {
        (key == "event").then_some(())?;
        take(&decode::<SimEvent>(payload, "").unwrap().kind)
    })
}

fn lost(kind: &EventKind) -> Option<()> {
    matches!(kind, EventKind::ToolLost { .. }).then_some(())
}

pub fn a_hand_without_motors_stays_while_its_page_is_silent_and_is_lost_after_half_a_second() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("silent.mcap");
    let record = path.to_str().unwrap();
    let (daemon, port) = serve(directory.path(), &patient(), &["--record", record]);
    let palpate = daemon.connect();
    let mut page = Page::open(port);
    page.claim_without_motors("ball", "mouse");
    page.holder("ball", |who| who == Some("mouse"));
    let sent = 60;
    assert!(press(&mut page, sent) > 0.05);
    let silent = Instant::now();
    page.seen.clear();
    event(&mut page, "its loss", lost);
    // A pose that is not repeated is lost after 0.4 s.
    let held = silent.elapsed().as_secs_f64();
    assert!(held > 0.6, "lost after {held} s");
    let received = palpate.status().unwrap().tools[0].received;
    assert!(received >= sent + 2, "{received} poses");
    let forces = page.seen.iter().filter(|(key, _)| key == "tool/ball/force");
    let forces = forces.map(|(_, payload)| decode::<ToolForce>(payload, "").unwrap());
    let pressed =
        forces.filter(|force| force.flags & force_flags::STALE == 0 && force.force[0] > 0.05);
    assert!(pressed.count() > 5, "the force went with the first silence");
    // It speaks again, by its own count, and is heard.
    let again = ToolPose {
        seq: sent + 1,
        t_client_ns: 77,
        ..pose_at([0.05, 0.003, 0.045])
    };
    page.pose("ball", &again);
    page.until("its force", |key, payload| {
        (key == "tool/ball/force").then_some(())?;
        (decode::<ToolForce>(payload, "").unwrap().t_client_ns == 77).then_some(())
    });
    // What it gives back is not repeated any more.
    page.send("tool/ball/release", &[]);
    page.holder("ball", |who| who.is_none());
    let received = palpate.status().unwrap().tools[0].received;
    event(&mut page, "its end", lost);
    assert_eq!(palpate.status().unwrap().tools[0].received, received);
    assert_eq!(page.call("shutdown", "{}")["ok"], true);
    assert_eq!(daemon.end().1, 0);
    let replay = Command::new(PROGRAM)
        .args(["replay", record])
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&replay.stdout).into_owned();
    assert!(replay.status.success(), "{words}");
}

#[test]
fn a_device_of_a_page_that_can_push_loses_its_force_with_its_poses() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), &patient(), &[]);
    let palpate = daemon.connect();
    let mut page = Page::open(port);
    page.claim("ball", "arm");
    page.holder("ball", |who| who == Some("arm"));
    for seq in 1..=5 {
        let pose = pose_at([0.05, 0.003, 0.045]);
        page.pose("ball", &ToolPose { seq, ..pose });
    }
    event(&mut page, "its loss", lost);
    assert_eq!(palpate.status().unwrap().tools[0].received, 5);
    // Whether there is somebody to push does not change while a tool is held.
    page.claim_without_motors("ball", "arm");
    let refused = page.refusal()["error"].as_str().unwrap().to_owned();
    assert!(
        refused.contains("with motors") && refused.contains("give it back"),
        "{refused}"
    );
}

#[test]
fn a_tool_whose_hand_left_touches_nothing_and_a_reset_takes_its_last_force_away() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), SOFT, &[]);
    let mut page = Page::open(port);
    page.claim("ball", "arm");
    page.holder("ball", |who| who == Some("arm"));
    assert!(press(&mut page, 60) > 0.05);
    page.send("tool/ball/release", &[]);
    event(&mut page, "its loss", lost);
    let force = |page: &mut Page, from: usize, what: &str, wanted: fn(&ToolForce) -> bool| {
        page.until_from(from, what, |key, payload| {
            (key == "tool/ball/force").then_some(())?;
            let force: ToolForce = decode(payload, "").unwrap();
            wanted(&force).then_some(force)
        })
    };
    let now = page.seen.len();
    let gone = force(&mut page, now, "a force that has faded", |force| {
        force.flags & force_flags::RAMPING == 0
    });
    assert_eq!(gone.flags, force_flags::STALE);
    assert_eq!(
        (gone.contact_count, gone.depth, gone.force),
        (0, 0.0, [0.0; 3])
    );
    let now = page.seen.len();
    assert_eq!(page.call("reset", "{}")["ok"], true);
    let reset = force(&mut page, now, "a force without a pose", |force| {
        force.pose_seq == 0
    });
    assert_eq!(
        (reset.flags, reset.contact_count, reset.force),
        (0, 0, [0.0; 3])
    );
    assert_eq!(reset.proxy_position, [0.06, 0.003, 0.045]);
}

#[test]
fn what_changes_nothing_is_not_told_and_a_reset_does_not_end_a_pause() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let palpate = daemon.connect();
    let mut page = Page::open(port);
    for method in ["resume", "pause", "pause", "reset"] {
        assert_eq!(page.call(method, "{}")["ok"], true, "{method}");
    }
    assert_eq!(palpate.status().unwrap().state, LoopState::Paused);
    for method in ["resume", "resume", "reset"] {
        assert_eq!(page.call(method, "{}")["ok"], true, "{method}");
    }
    assert_eq!(palpate.status().unwrap().state, LoopState::Running);
    let told: Vec<EventKind> = palpate
        .past_events(0)
        .unwrap()
        .into_iter()
        .map(|event| event.kind)
        .collect();
    let of_the_loop: Vec<&EventKind> = told
        .iter()
        .filter(|kind| {
            !matches!(
                kind,
                EventKind::Overrun { .. }
                    | EventKind::QualityChanged { .. }
                    | EventKind::Fault { .. }
            )
        })
        .collect();
    use EventKind::{Paused, Reset, Resumed};
    assert_eq!(of_the_loop, [&Paused, &Reset, &Resumed, &Reset]);
}

#[test]
fn a_second_page_is_told_who_holds_the_tool_until_the_first_is_gone() {
    let directory = tempfile::tempdir().unwrap();
    let (_daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let (mut first, mut second) = (Page::open(port), Page::open(port));
    first.claim("ball", "mouse A");
    second.holder("ball", |who| who == Some("mouse A"));
    second.claim("ball", "mouse B");
    let refusal = second.refusal();
    assert_eq!(refusal["key"], "tool/ball/device");
    assert!(
        refusal["error"].as_str().unwrap().contains("mouse A"),
        "{refusal}"
    );
    second.pose("ball", &pose_at([0.0; 3]));
    assert!(
        second.refusal()["error"]
            .as_str()
            .unwrap()
            .contains("does not hold")
    );
    // Another tool is free.
    second.claim("pen", "mouse B");
    second.holder("pen", |who| who == Some("mouse B"));
    // Given back, then taken and lost with the socket.
    first.send("tool/ball/release", &[]);
    second.holder("ball", |who| who.is_none());
    first.claim("ball", "mouse A");
    second.holder("ball", |who| who == Some("mouse A"));
    drop(first);
    second.holder("ball", |who| who.is_none());
    second.claim("ball", "mouse B");
    second.holder("ball", |who| who == Some("mouse B"));
    second.claim("saw", "mouse B");
    assert!(
        second.refusal()["error"]
            .as_str()
            .unwrap()
            .contains("ball, pen")
    );
}

#[test]
fn a_tool_that_a_device_holds_is_not_a_page_s() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let palpate = daemon.connect();
    let tool = palpate.tool("ball").unwrap();
    let mut page = Page::open(port);
    page.holder("ball", |who| who.is_some());
    page.claim("ball", "mouse");
    let refusal = page.refusal();
    assert!(
        refusal["error"]
            .as_str()
            .unwrap()
            .contains("a client on the bus"),
        "{refusal}"
    );
    drop(tool);
    page.holder("ball", |who| who.is_none());
    page.claim("ball", "mouse");
    page.holder("ball", |who| who == Some("mouse"));
}

#[test]
fn bad_poses_of_a_page_are_counted_as_those_of_any_client() {
    let directory = tempfile::tempdir().unwrap();
    let (daemon, port) = serve(directory.path(), TWO_BALLS, &[]);
    let palpate = daemon.connect();
    let mut page = Page::open(port);
    page.claim("ball", "mouse");
    page.holder("ball", |who| who == Some("mouse"));
    page.send("tool/ball/pose", &[1, 2, 3]);
    page.send("tool/ball/pose", &[0; 5_000]);
    page.pose(
        "ball",
        &ToolPose {
            seq: 1,
            ..pose_at([f64::NAN, 0.0, 0.0])
        },
    );
    page.pose(
        "ball",
        &ToolPose {
            seq: 1,
            ..pose_at([0.1, 0.0, 0.0])
        },
    );
    let link = crate::wire::until(
        "all four were counted",
        || palpate.status().unwrap().tools[0].clone(),
        |link| link.received == 1,
    );
    assert_eq!(
        (link.malformed, link.oversized, link.not_finite),
        (1, 1, 1),
        "{link:?}"
    );
    // A device that cannot be is refused with the reason.
    let mut info = crate::page::mouse("mouse");
    info.mass = -1.0;
    page.send(
        "tool/ball/device",
        &palpate_client::proto::codec::encode(&info),
    );
    assert!(page.refusal()["error"].as_str().unwrap().contains("mass"));
}

#[test]
fn commands_of_a_page_are_carried_out_or_refused_in_the_daemon_s_words() {
    let directory = tempfile::tempdir().unwrap();
    let records = directory.path().join("records");
    let (daemon, port) = serve(
        directory.path(),
        TWO_BALLS,
        &["--record-dir", records.to_str().unwrap(), "--ring", "5s"],
    );
    let mut page = Page::open(port);
    assert_eq!(page.call("pause", "{}")["ok"], true);
    let status = daemon.connect().status().unwrap();
    assert_eq!(status.state, LoopState::Paused);
    assert_eq!(page.call("step", "{\"ticks\": 5}")["ok"], true);
    assert_eq!(page.call("resume", "{}")["ok"], true);
    assert_eq!(page.call("record_start", "{}")["ok"], true);
    let stopped = page.call("record_stop", "{}");
    assert!(
        stopped["path"].as_str().unwrap().ends_with(".mcap"),
        "{stopped}"
    );
    let snapshot = page.call("snapshot", "{\"before\": 1}");
    assert_eq!(snapshot["ok"], true, "{snapshot}");
    let refused = page.call("seek", "{\"tick\": 5}");
    assert!(refused["error"].as_str().unwrap().contains("palpate play"));
    let refused = page.call("step", "{\"steps\": 5}");
    assert!(
        refused["error"].as_str().unwrap().contains("steps"),
        "{refused}"
    );
    let refused = page.call("dance", "{}");
    assert!(
        refused["error"].as_str().unwrap().contains("pause"),
        "{refused}"
    );
}

// In lockstep a tick waits for a pose, and a page has sixty a second: the daemon repeats them, as
// often as the speed asks for.
#[test]
fn in_lockstep_a_page_s_pose_drives_the_loop_at_the_speed_it_asks_for() {
    let directory = tempfile::tempdir().unwrap();
    let text = TWO_BALLS.rsplit_once("[[tool]]").unwrap().0;
    let (daemon, port) = serve(directory.path(), text, &["--clock", "lockstep"]);
    let palpate = daemon.connect();
    let mut page = Page::open(port);
    assert_eq!(
        crate::page::get(port, "/session.json").json()["lockstep"],
        true
    );
    page.claim("ball", "mouse");
    page.holder("ball", |who| who == Some("mouse"));
    assert_eq!(palpate.status().unwrap().tick, 0);
    page.send("speed", &0.2_f64.to_le_bytes());
    page.pose("ball", &pose_at([0.05, 0.003, 0.045]));
    let begun = Instant::now();
    let tick = crate::wire::until(
        "it runs",
        || palpate.status().unwrap().tick,
        |tick| *tick >= 200,
    );
    let seconds = begun.elapsed().as_secs_f64();
    assert!(seconds > 0.7, "{tick} ticks in {seconds} s");
    page.send("speed", &f64::NAN.to_le_bytes());
    assert!(
        page.refusal()["error"]
            .as_str()
            .unwrap()
            .contains("0.001 to 10")
    );
    page.send("tool/ball/release", &[]);
    page.holder("ball", |who| who.is_none());
    let tick = palpate.status().unwrap().tick;
    std::thread::sleep(Duration::from_millis(200));
    assert!(palpate.status().unwrap().tick <= tick + 1);
}

#[test]
fn a_tool_of_the_mouse_is_there_where_the_daemon_was_told_so_and_its_recording_replays() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("mouse.mcap");
    let record = path.to_str().unwrap();
    // A scene that has no tool at all.
    let (bare, _) = TWO_BALLS.split_once("[[tool]]").unwrap();
    let arguments = ["--mouse-tool", "8mm", "--record", record];
    let (daemon, port) = serve(directory.path(), bare, &arguments);
    let mut page = Page::open(port);
    let scene: palpate_client::proto::messages::SceneSnapshot = page.message("scene");
    let [mouse] = &scene.tools[..] else {
        panic!("{} tools", scene.tools.len())
    };
    assert_eq!((mouse.id.as_str(), mouse.radius), ("mouse", 0.008));
    page.claim("mouse", "mouse of a test");
    page.holder("mouse", |who| who == Some("mouse of a test"));
    // Down on the drop's tip, beside its middle.
    let mut strongest = 0.0_f64;
    for seq in 1..=60_u64 {
        let [x, y, z] = mouse.position;
        let down = 0.09 * seq as f64 / 60.0;
        page.pose(
            "mouse",
            &ToolPose {
                seq,
                ..pose_at([x, y, z - down])
            },
        );
        let force = page.until("its force", |key, payload| {
            (key == "tool/mouse/force").then_some(())?;
            let force: ToolForce = decode(payload, "").unwrap();
            (force.pose_seq >= seq).then_some(force)
        });
        strongest = (force.force.iter()).fold(strongest, |most, f| most.max(f.abs()));
    }
    assert!(strongest > 0.05, "{strongest} N");
    assert_eq!(page.call("shutdown", "{}")["ok"], true);
    assert_eq!(daemon.end().1, 0);
    let replay = Command::new(PROGRAM)
        .args(["replay", record])
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&replay.stdout).into_owned();
    assert!(replay.status.success(), "{words}");
}

#[test]
fn a_tool_of_the_mouse_that_cannot_be_is_refused_in_words() {
    let directory = tempfile::tempdir().unwrap();
    let scene = directory.path().join("scene.toml");
    let try_with = |text: &str, arguments: &[&str]| {
        std::fs::write(&scene, text).unwrap();
        let mut command = Command::new(PROGRAM);
        let done = (command.arg("serve").arg(&scene).args(["--for", "1s"]))
            .args(arguments)
            .output()
            .unwrap();
        assert_eq!(done.status.code(), Some(2), "{arguments:?}");
        String::from_utf8_lossy(&done.stderr).into_owned()
    };
    let lockstep = ["--clock", "lockstep", "--mouse-tool"];
    assert!(try_with(TWO_BALLS, &lockstep).contains("lockstep"));
    let taken = TWO_BALLS.replace("\"pen\"", "\"mouse\"");
    assert!(try_with(&taken, &["--mouse-tool"]).contains("of its own"));
    assert!(try_with(TWO_BALLS, &["--mouse-tool=10"]).contains("not a radius"));
}
