//! Bodies that deform, cut by a plane or by a tool while they run, recorded and replayed.

use crate::editing::{ids, refused, replays};
use palpate_client::proto::messages::{EventKind, ToolForce};
use palpate_client::proto::rpc::{Call, PlaneArgument};
use palpate_client::testing::TestSession;
use palpate_client::{Palpate, Tool, pose_at};
use palpate_record::{Session, recorded_scene};
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_palpate");

/// A ball of gel that is held below, a plate under it, a stone beside it, and a pen above it.
const GEL: &str = r#"
[[body]]
id = "plate"
surface = { builtin = "sheet", net = [4, 4], size = 0.5 }

[[body]]
id = "gel"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [0.0, 0.0, 0.0205] }
fixed = [{ point = [0.0, 0.0, -0.012], normal = [0.0, 0.0, 1.0] }]
model = "lattice"
material = { young_pa = 20e3, density_kg_m3 = 1000.0, damping_s = 1e-2 }
lattice = { layers = 2, refine = [10, 8] }

[[body]]
id = "stone"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [0.2, 0.0, 0.03] }

[[tool]]
id = "pen"
shape = { sphere = { radius_m = 5e-3 } }
pose = { position = [0.0, 0.01, 0.06] }
"#;

/// A sheet that is held at its ends, and a plane that cuts.
const KNIFE: &str = r#"
[[body]]
id = "sheet"
surface = { builtin = "sheet", size = 0.1 }
model = "lattice"
material = { young_pa = 20e3 }
lattice = { thickness_m = 2e-3, layers = 2, refine = "none" }
fixed = [{ point = [0, -0.049, 0], normal = [0, 1, 0] }, { point = [0, 0.049, 0], normal = [0, -1, 0] }]

[[body]]
id = "stone"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [0.2, 0.0, 0.0] }

[[tool]]
id = "knife"
shape = { plane = { normal = [1, 0, 0] } }
action = "cut"
pose = { position = [0.3, 0.0, 0.0] }
"#;

/// Across x, through a point of the x axis.
fn across(x: f64) -> PlaneArgument {
    PlaneArgument {
        point: [x, 0.0, 0.0],
        normal: [2.0, 0.0, 0.0],
    }
}

fn cut(body: &str, plane: PlaneArgument, kerf: f64) -> Call {
    Call::Cut {
        body: body.into(),
        plane: Some(plane),
        tool: None,
        kerf,
    }
}

/// Presses from a height down, by so much a tick, to another.
struct Press {
    at: [f64; 3],
    down_m: f64,
    lowest_m: f64,
}

impl Press {
    fn run(&mut self, session: &mut TestSession, pen: &mut Tool, ticks: usize) -> ToolForce {
        let mut last = None;
        for _ in 0..ticks {
            self.at[2] = (self.at[2] - self.down_m).max(self.lowest_m);
            last = Some(session.step(pen, pose_at(self.at)).unwrap());
        }
        last.unwrap()
    }
}

fn masses(path: &Path) -> Vec<(String, f64)> {
    let session = Session::open(path).unwrap();
    let scene = recorded_scene(&session).unwrap();
    let mass = |body: usize| {
        let deformable = scene.deformable(body)?;
        Some((scene.body_id(body).to_owned(), deformable.mass_kg()))
    };
    (0..scene.body_count()).filter_map(mass).collect()
}

fn volumes(report: &Value) -> Vec<f64> {
    let pieces = report["pieces"].as_array().unwrap();
    let volume = |piece: &Value| piece["volume"].as_f64().unwrap();
    pieces.iter().map(volume).collect()
}

#[test]
fn a_gel_body_is_cut_into_three_and_the_recording_replays() {
    let directory = tempfile::tempdir().unwrap();
    let record = directory.path().join("cut.mcap");
    let mut session = TestSession::of(GEL)
        .program(PROGRAM)
        .record(&record)
        .start()
        .unwrap();
    let mut pen = session.tool("pen").unwrap();
    let mut press = Press {
        at: [0.0, 0.01, 0.06],
        down_m: 5e-5,
        lowest_m: 0.036,
    };
    press.run(&mut session, &mut pen, 300);
    let done = session
        .palpate()
        .call(cut("gel", across(0.0), 0.0))
        .unwrap();
    assert_eq!(done.tick, 301);
    let first = done.report.unwrap();
    assert_eq!(
        ids(session.palpate()),
        ["plate", "gel-1", "gel-2", "stone"],
        "{first}"
    );
    // The sphere has its volume, whatever was made of it.
    let whole = std::f64::consts::PI * 4.0 / 3.0 * 8e-6;
    let sum: f64 = volumes(&first).iter().sum();
    assert!((sum / whole - 1.0).abs() < 0.02, "{first}");
    assert_eq!(first["lost"], 0.0);
    for (k, piece) in first["pieces"].as_array().unwrap().iter().enumerate() {
        assert_eq!(piece["id"], format!("gel-{}", k + 1));
        assert_eq!(piece["above"], k == 0);
        assert!(piece["off"].as_f64().unwrap() < 1e-3, "{first}");
        let x = piece["centroid"][0].as_f64().unwrap();
        assert!(if k == 0 { x > 0.004 } else { x < -0.004 }, "{first}");
    }
    // The pen goes on to one of them.
    press.at = [0.006, 0.01, 0.045];
    let force = press.run(&mut session, &mut pen, 401);
    assert!(force.force[2] > 1e-3, "{force:?}");
    let plane = PlaneArgument {
        point: [0.0, 0.0, 0.0],
        normal: [0.0, 1.0, 0.0],
    };
    let done = session.palpate().call(cut("gel-1", plane, 2e-4)).unwrap();
    assert_eq!(done.tick, 702);
    let second = done.report.unwrap();
    assert_eq!(ids(session.palpate()).len(), 5, "{second}");
    let lost = second["lost"].as_f64().unwrap();
    assert!(lost > 0.0, "{second}");
    // The same piece, 400 ticks later.
    let sum = volumes(&second).iter().sum::<f64>() + lost;
    assert!((sum / volumes(&first)[0] - 1.0).abs() < 0.05, "{second}");
    press.run(&mut session, &mut pen, 300);
    // Bodies that are gone are not there to be cut again.
    let gone = refused(session.palpate(), cut("gel", across(0.0), 0.0));
    assert!(gone.contains("there is no body \"gel\""), "{gone}");
    let status = session.palpate().status().unwrap();
    assert_eq!((status.skipped_ticks, status.quality_level), (0, 0));
    let faults = faults(session.palpate());
    assert!(faults.is_empty(), "{faults:?}");
    session.finish(pen).unwrap();

    let (_, last) = replays(&record, 0);
    assert_eq!(last, 300);
    let next = |k: usize| directory.path().join(format!("cut-000{k}.mcap"));
    let (halves, last) = replays(&next(2), 300);
    assert_eq!(last, 701);
    assert!(halves.header.run["scene_change"].contains("cut gel"));
    replays(&next(3), 701);
    let mass = |path: &Path| masses(path).into_iter().map(|(_, mass)| mass).sum::<f64>();
    let [one, two, three] = [&record, &next(2), &next(3)].map(|path| mass(path));
    assert!((two / one - 1.0).abs() < 0.01, "{one} {two}");
    assert!(
        three < two && (three / two - 1.0).abs() < 0.05,
        "{two} {three}"
    );
    assert_eq!(masses(&next(3)).len(), 3);
}

/// What comes some time after.
fn awaited<T>(mut look: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing came");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn faults(palpate: &Palpate) -> Vec<String> {
    let reasons = palpate.past_events(0).unwrap().into_iter();
    let reasons = reasons.filter_map(|event| match event.kind {
        EventKind::Fault { reason } => Some(reason),
        _ => None,
    });
    reasons.collect()
}

#[test]
fn a_piece_that_is_held_everywhere_is_rigid_and_said_to_be() {
    let mut session = TestSession::of(GEL).program(PROGRAM).start().unwrap();
    let mut pen = session.tool("pen").unwrap();
    session.step(&mut pen, pose_at([0.0, 0.0, 0.06])).unwrap();
    let below = PlaneArgument {
        point: [0.0, 0.0, 0.0055],
        normal: [0.0, 0.0, 1.0],
    };
    let done = session.palpate().call(cut("gel", below, 0.0)).unwrap();
    let report = done.report.unwrap();
    let pieces = report["pieces"].as_array().unwrap();
    let said = |k: usize| (&pieces[k]["model"], &pieces[k]["layers"]);
    assert_eq!(said(0), (&"lattice".into(), &2.into()), "{report}");
    assert_eq!(said(1), (&"rigid".into(), &Value::Null), "{report}");
    let events = session.palpate().past_events(0).unwrap().into_iter();
    let what = events.filter_map(|event| match event.kind {
        EventKind::SceneChanged { what } => Some(what),
        _ => None,
    });
    let expected = "cut gel into 2 pieces; gel-2 is rigid, since it is held everywhere";
    assert_eq!(what.collect::<Vec<_>>(), [expected]);
    session.step(&mut pen, pose_at([0.0, 0.0, 0.06])).unwrap();
    session.finish(pen).unwrap();
}

#[test]
fn what_cannot_be_cut_is_refused_and_the_scene_goes_on() {
    let mut session = TestSession::of(GEL).program(PROGRAM).start().unwrap();
    let mut pen = session.tool("pen").unwrap();
    session.step(&mut pen, pose_at([0.0, 0.0, 0.06])).unwrap();
    let palpate = session.palpate();
    let unknown = refused(palpate, cut("jel", across(0.0), 0.0));
    assert!(
        unknown.contains("no body \"jel\"") && unknown.contains("gel"),
        "{unknown}"
    );
    for rigid in ["plate", "stone"] {
        let said = refused(palpate, cut(rigid, across(0.0), 0.0));
        assert!(said.contains(&format!("{rigid:?}")), "{said}");
    }
    let misses = refused(palpate, cut("gel", across(0.05), 0.0));
    assert!(
        misses.contains("does not cut the surface") && misses.contains("below"),
        "{misses}"
    );
    // Within the surface, but not both sides of what is lost.
    let wide = refused(palpate, cut("gel", across(0.019), 4e-3));
    assert!(wide.contains("does not cut the surface"), "{wide}");
    let flat = PlaneArgument {
        point: [0.0; 3],
        normal: [0.0; 3],
    };
    let flat = refused(palpate, cut("gel", flat, 0.0));
    assert!(flat.contains("has no direction"), "{flat}");
    let far = PlaneArgument {
        point: [f64::MAX; 3],
        normal: [1.0; 3],
    };
    let far = refused(palpate, cut("gel", far, 0.0));
    assert!(far.contains("out of reach"), "{far}");
    // JSON has no numbers that are not finite: they are left out.
    for not_a_number in [f64::NAN, f64::INFINITY] {
        let said = refused(palpate, cut("gel", across(not_a_number), 0.0));
        assert!(said.contains("the arguments of cut do not parse"), "{said}");
    }
    let by = |plane, tool: Option<&str>| Call::Cut {
        body: "gel".into(),
        plane,
        tool: tool.map(Into::into),
        kerf: 0.0,
    };
    let ball = refused(palpate, by(None, Some("pen")));
    assert!(
        ball.contains("\"pen\" has the shape sphere") && ball.contains("only a plane cuts"),
        "{ball}"
    );
    let unknown = refused(palpate, by(None, Some("knife")));
    assert!(
        unknown.contains("no tool \"knife\"") && unknown.contains("pen"),
        "{unknown}"
    );
    for (plane, tool) in [(None, None), (Some(across(0.0)), Some("pen"))] {
        let said = refused(palpate, by(plane, tool));
        assert!(said.contains("a plane or a tool"), "{said}");
    }
    assert_eq!(ids(palpate), ["plate", "gel", "stone"]);
    let force = session.step(&mut pen, pose_at([0.0, 0.0, 0.06])).unwrap();
    assert_eq!(force.tick, 2);
    session.finish(pen).unwrap();
}

#[test]
fn a_knife_touches_nothing_and_its_button_reports_what_cannot_be_cut() {
    let mut session = TestSession::of(KNIFE).program(PROGRAM).start().unwrap();
    let mut knife = session.tool("knife").unwrap();
    // The sheet and the stone are within what a plane that touches would hold.
    let at = |x: f64, buttons: u32| {
        let mut pose = pose_at([x, 0.0, 0.0]);
        pose.buttons = buttons;
        pose
    };
    for (k, buttons) in [0, 0, 1, 1, 1, 0, 0].into_iter().enumerate() {
        let x = 0.3 - 5e-3 * k as f64;
        let force = session.step(&mut knife, at(x, buttons)).unwrap();
        assert_eq!((force.force, force.contact_count), ([0.0; 3], 0));
    }
    assert!(
        faults(session.palpate()).is_empty(),
        "it is beside all bodies"
    );
    // By its plane where it is now.
    let by_tool = Call::Cut {
        body: "sheet".into(),
        plane: None,
        tool: Some("knife".into()),
        kerf: 0.0,
    };
    assert!(!refused(session.palpate(), by_tool).is_empty());
    for k in 0..60 {
        session
            .step(&mut knife, at(0.27 - 5e-3 * f64::from(k), 0))
            .unwrap();
    }
    session.step(&mut knife, at(-0.02, 1)).unwrap();
    let said = awaited(|| Some(faults(session.palpate())).filter(|said| !said.is_empty()));
    // The stone is rigid: no knife cuts it.
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(
        said[0].contains("tool knife did not cut sheet: "),
        "{said:?}"
    );
    assert_eq!(ids(session.palpate()), ["sheet", "stone"]);
    session.step(&mut knife, at(-0.02, 1)).unwrap();
    assert_eq!(faults(session.palpate()).len(), 1);
    session.finish(knife).unwrap();
}

/// Two balls of gel above a plane that cuts, which is turned on its way to them.
const TWO: &str = r#"
[[body]]
id = "left"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [-0.03, 0.0, 0.0] }
model = "lattice"
material = { young_pa = 20e3 }
lattice = { layers = 1, refine = "none" }

[[body]]
id = "right"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [0.03, 0.0, 0.0] }
model = "lattice"
material = { young_pa = 20e3 }
lattice = { layers = 1, refine = "none" }

[[body]]
id = "above"
surface = { builtin = "sphere", size = 0.02 }
pose = { position = [0.0, 0.0, 0.1] }
model = "lattice"
material = { young_pa = 20e3 }
lattice = { layers = 1, refine = "none" }

[[tool]]
id = "knife"
shape = { plane = { normal = [1, 0, 0] } }
action = "cut"
pose = { position = [0.0, 0.0, 2e-3] }
"#;

#[test]
fn a_knife_cuts_all_that_its_plane_crosses_one_after_the_other() {
    let directory = tempfile::tempdir().unwrap();
    let record = directory.path().join("knife.mcap");
    let mut session = TestSession::of(TWO)
        .program(PROGRAM)
        .record(&record)
        .start()
        .unwrap();
    let mut knife = session.tool("knife").unwrap();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let at = |buttons: u32| {
        let mut pose = pose_at([0.0, 0.0, 2e-3]);
        // Its x axis shows down.
        (pose.orientation, pose.buttons) = ([0.0, half, 0.0, half], buttons);
        pose
    };
    session.step(&mut knife, at(0)).unwrap();
    session.step(&mut knife, at(1)).unwrap();
    let pieces = ["left-1", "left-2", "right-1", "right-2", "above"];
    awaited(|| (ids(session.palpate()) == pieces).then_some(()));
    for _ in 0..50 {
        session.step(&mut knife, at(1)).unwrap();
    }
    assert_eq!(ids(session.palpate()), pieces);
    let faults = faults(session.palpate());
    assert!(faults.is_empty(), "{faults:?}");
    session.finish(knife).unwrap();
    let (_, last) = replays(&record, 0);
    assert_eq!(last, 2);
    // Both changes came between the same two ticks.
    let next = |k: usize| directory.path().join(format!("knife-000{k}.mcap"));
    let (pieces, last) = replays(&next(3), 2);
    assert_eq!(last, 52);
    assert!(pieces.header.run["scene_change"].contains("cut right into 2 pieces"));
}
