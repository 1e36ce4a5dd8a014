//! What a new user does in the first hour: nothing wrong passes without a sign.

use crate::daemon::{Daemon, PROGRAM, device, free_port, side_by_side};
use crate::scenes::RIGID_TEARDROP;
use palpate_geometry::exchange::{Format, write_mesh};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{Mesh, builtin};
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

fn palpate(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(PROGRAM)
        .args(arguments)
        .current_dir(directory)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or(-1)
}

fn words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(output: &Output) -> Value {
    let text = String::from_utf8_lossy(&output.stdout);
    let line = text.lines().last().unwrap_or_default();
    serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {text}\n{}", words(output)))
}

fn write_stl(path: &Path, mesh: &Mesh, unit: Unit) {
    std::fs::write(path, write_mesh(mesh, Format::Stl, unit).unwrap()).unwrap();
}

fn surface(name: &str, size: Option<f64>) -> Mesh {
    let surface = builtin(name, None, size).unwrap();
    surface.tessellated([4; 2]).unwrap()
}

fn cube(edge: f64) -> Mesh {
    let corner =
        |k: usize| Point3::new((k & 1) as f64, ((k >> 1) & 1) as f64, (k >> 2) as f64) * edge;
    let faces = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = faces
        .iter()
        .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
        .collect();
    Mesh::from_triangles((0..8).map(corner).collect(), triangles).unwrap()
}

// Only its corners have points: a fit measured there reports 0 whatever it does between them.
#[test]
fn a_fit_beyond_tolerance_fails_with_figures_over_both_areas() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    write_stl(&path.join("cube.stl"), &cube(0.04), Unit::Metre);
    let coarse = palpate(
        path,
        &[
            "surface", "fit", "cube.stl", "--net", "6x6", "-o", "c.json", "--json",
        ],
    );
    assert_eq!(code(&coarse), 1, "{}", words(&coarse));
    let report = json(&coarse);
    let largest = report["max_error_m"].as_f64().unwrap();
    assert!((1e-3..2e-2).contains(&largest), "{report}");
    assert!(
        report["compared_points"].as_u64().unwrap() > 10_000,
        "{report}"
    );
    assert!((report["triangles_volume_m3"].as_f64().unwrap() - 6.4e-5).abs() < 1e-9);
    assert!(words(&coarse).contains("tolerance"), "{}", words(&coarse));
    let allowed = palpate(
        path,
        &[
            "surface",
            "fit",
            "cube.stl",
            "--net",
            "24x24",
            "-o",
            "f.json",
            "--tolerance",
            "0.003",
        ],
    );
    assert_eq!(code(&allowed), 0, "{}", words(&allowed));
    // Closed without being asked for, and said.
    assert!(words(&allowed).contains("--open"), "{}", words(&allowed));
    let info = json(&palpate(path, &["surface", "info", "f.json", "--json"]));
    assert_eq!(info["closed"], true);
}

#[test]
fn tori_and_pairs_are_not_fitted_as_one_ball() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    write_stl(
        &path.join("torus.stl"),
        &surface("torus", None),
        Unit::Metre,
    );
    let ball = surface("sphere", None);
    let shift = ball.points.len() as u32;
    let points = ball.points.iter().map(|p| p + Vector3::x());
    let triangles = ball.triangles.iter().map(|t| t.map(|k| k + shift));
    let two = Mesh::from_triangles(
        ball.points.iter().copied().chain(points).collect(),
        ball.triangles.iter().copied().chain(triangles).collect(),
    );
    write_stl(&path.join("two.stl"), &two.unwrap(), Unit::Metre);
    for (name, what) in [("torus.stl", "genus 1"), ("two.stl", "2 separate parts")] {
        let fit = palpate(
            path,
            &[
                "surface", "fit", name, "--unit", "m", "--closed", "-o", "out.json",
            ],
        );
        assert_eq!(code(&fit), 1, "{name}");
        assert!(words(&fit).contains(what), "{}", words(&fit));
        assert!(!path.join("out.json").exists());
    }
}

// A fit with folded poles builds as a lattice and as nothing else.
#[test]
fn an_imported_scan_runs_as_lattice_continuum_and_net() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    write_stl(
        &path.join("organ.stl"),
        &surface("sphere", Some(0.08)),
        Unit::Millimetre,
    );
    let unit = palpate(path, &["import", "organ.stl"]);
    assert_eq!(code(&unit), 2);
    assert!(words(&unit).contains("--unit mm"), "{}", words(&unit));
    for model in ["lattice", "continuum", "net"] {
        let scene = format!("{model}.toml");
        let done = palpate(
            path,
            &[
                "import",
                "organ.stl",
                "--unit",
                "mm",
                "-o",
                &scene,
                "--model",
                model,
            ],
        );
        assert_eq!(code(&done), 0, "{model}: {}", words(&done));
    }
    // Nothing is overwritten.
    let again = palpate(
        path,
        &["import", "organ.stl", "--unit", "mm", "-o", "net.toml"],
    );
    assert_eq!(code(&again), 2);
}

#[test]
fn millimetres_read_as_metres_do_not_pass() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    // 80 "metres" long.
    let mut drop = surface("sphere", Some(0.08));
    drop.points.iter_mut().for_each(|p| *p *= 1e3);
    write_stl(&path.join("mm.stl"), &drop, Unit::Metre);
    let fit = palpate(path, &["surface", "fit", "mm.stl", "-o", "mm.json"]);
    assert_eq!(code(&fit), 2);
    assert!(words(&fit).contains("--unit mm"), "{}", words(&fit));
    let done = palpate(
        path,
        &["import", "mm.stl", "--unit", "m", "--model", "rigid"],
    );
    assert_eq!(code(&done), 1, "{}", words(&done));
    assert!(
        words(&done).contains("is its file in millimetres"),
        "{}",
        words(&done)
    );
    let meant = palpate(path, &["check", "mm.toml", "--any-size", "--json"]);
    assert_eq!(code(&meant), 0);
    let report = json(&meant);
    let unusual = |warning: &&Value| warning["kind"] == "unusual";
    let warnings = report["warnings"].as_array().unwrap().iter();
    assert_eq!(warnings.filter(unusual).count(), 2, "{report}");
    let scene = r#"
[[body]]
id = "drop"
surface = { builtin = "teardrop" }
[[tool]]
id = "probe"
shape = { mesh = { file = "mm.stl" } }
pose = { position = [200.0, 0.0, 0.0] }
"#;
    std::fs::write(path.join("tool.toml"), scene).unwrap();
    let tool = palpate(path, &["check", "tool.toml"]);
    assert_eq!(code(&tool), 1, "{}", words(&tool));
    assert!(words(&tool).contains("tool probe"), "{}", words(&tool));
}

#[test]
fn check_says_which_rate_a_scene_holds() {
    let directory = tempfile::tempdir().unwrap();
    let report = json(&palpate(
        directory.path(),
        &["check", "builtin:rigid-teardrop", "--json"],
    ));
    assert_eq!(report["rate_hz"], 1000.0);
    let (tick_us, holds) = (&report["tick_us"], &report["holds_hz"]);
    let product = tick_us.as_f64().unwrap() * holds.as_f64().unwrap();
    assert!((product / 1e6 - 1.0).abs() < 0.01, "{report}");
    let slow = "[loop]\nrate_hz = 10000\n[[body]]\nid = \"drop\"\nsurface = { builtin = \"teardrop\", net = [8, 8] }\n\
                model = \"continuum\"\nlattice = { layers = 6, refine = \"none\" }\nintegrator = { iterations = 10 }\n\
                [[tool]]\nid = \"ball\"\nshape = { sphere = { radius_m = 0.01 } }\npose = { position = [0.06, 0.0, 0.045] }\n";
    std::fs::write(directory.path().join("slow.toml"), slow).unwrap();
    let slow = palpate(directory.path(), &["check", "slow.toml"]);
    assert!(
        words(&slow).contains("too slow for 10000 Hz"),
        "{}",
        words(&slow)
    );
}

// A box with a hole through it, each face a B-spline but that of the hole.
#[test]
fn a_trimmed_step_file_is_a_part_and_one_of_its_surfaces_is_refused_or_taken_whole() {
    let directory = tempfile::tempdir().unwrap();
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("crates/geometry/tests/opencascade/drilled_box.step");
    let file = file.to_str().unwrap();
    let part = palpate(directory.path(), &["surface", "info", file, "--json"]);
    assert_eq!(code(&part), 0, "{}", words(&part));
    let faces = json(&part)["faces"].as_array().unwrap().clone();
    let bored = faces.iter().filter(|face| face["loops"] == 2).count();
    assert_eq!((faces.len(), bored), (7, 3), "{faces:?}");
    let refused = palpate(directory.path(), &["surface", "info", file, "--index", "4"]);
    assert_eq!(code(&refused), 1);
    assert!(
        words(&refused).contains("the trimming of its face"),
        "{}",
        words(&refused)
    );
    assert!(
        words(&refused).contains("1 of 7 faces"),
        "{}",
        words(&refused)
    );
    let taken = palpate(
        directory.path(),
        &[
            "surface",
            "info",
            file,
            "--index",
            "4",
            "--ignore-trims",
            "--json",
        ],
    );
    assert_eq!(code(&taken), 0, "{}", words(&taken));
    let left = &json(&taken)["left_out"];
    assert_eq!(
        (&left["trimmed"], &left["other_faces"]),
        (&Value::Bool(true), &1.into())
    );
}

#[test]
fn a_configuration_that_would_not_be_enforced_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let configuration =
        r#"{ mode: "peer", transport: { auth: { usrpwd: { user: "me", password: "secret" } } } }"#;
    std::fs::write(directory.path().join("zenoh.json5"), configuration).unwrap();
    let serve = palpate(
        directory.path(),
        &[
            "serve",
            "builtin:rigid-teardrop",
            "--zenoh-config",
            "zenoh.json5",
            "--for",
            "1s",
        ],
    );
    assert_eq!(code(&serve), 2);
    assert!(
        words(&serve).contains("transport/auth/usrpwd"),
        "{}",
        words(&serve)
    );
}

fn serve(directory: &Path, arguments: &[&str]) -> Child {
    Command::new(PROGRAM)
        .args(["serve", "builtin:rigid-teardrop", "--no-rt", "--json"])
        .args(arguments)
        .current_dir(directory)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn first_line(child: &mut Child) -> Value {
    use std::io::{BufRead as _, BufReader};
    let mut line = String::new();
    BufReader::new(child.stdout.as_mut().unwrap())
        .read_line(&mut line)
        .unwrap();
    serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line:?}"))
}

#[test]
fn serve_says_where_it_listens_and_ends_by_the_clock() {
    let directory = tempfile::tempdir().unwrap();
    let mut child = serve(
        directory.path(),
        &["--listen", "tcp/127.0.0.1:0", "--for", "20s"],
    );
    let ready = first_line(&mut child);
    assert_eq!(ready["ready"], true);
    let endpoint = ready["listen"][0].as_str().unwrap().to_owned();
    assert!(!endpoint.ends_with(":0"), "{ready}");
    let (report, status) = device(&endpoint, &["--for", "1s"]);
    assert_eq!(status, 0, "{report}");
    // The daemon is stopped before its time.
    let stopped = palpate(
        directory.path(),
        &["rpc", "shutdown", "--connect", &endpoint],
    );
    assert_eq!(code(&stopped), 0, "{}", words(&stopped));
    let ended = child.wait_with_output().unwrap();
    assert_eq!(code(&ended), 0);
    assert!(json(&ended)["ticks"].as_u64().unwrap() > 0);
}

#[test]
fn daemons_and_devices_say_for_whom_they_wait_and_who_has_what() {
    side_by_side![
        a_daemon_that_nobody_uses_ends_and_lockstep_says_for_whom_it_waits,
        a_device_waits_for_its_daemon_and_a_second_one_is_refused,
        hz_prints_while_it_watches_and_echo_names_flags,
    ];
}

fn a_daemon_that_nobody_uses_ends_and_lockstep_says_for_whom_it_waits() {
    let directory = tempfile::tempdir().unwrap();
    let arguments = [
        "--listen",
        "tcp/127.0.0.1:0",
        "--clock",
        "lockstep",
        "--idle-timeout",
        "6s",
    ];
    let done = serve(directory.path(), &arguments)
        .wait_with_output()
        .unwrap();
    assert_eq!(code(&done), 0, "{}", words(&done));
    assert!(
        words(&done).contains("nobody holds ball"),
        "{}",
        words(&done)
    );
}

#[test]
fn a_daemon_that_connects_leaves_the_routers_port_alone() {
    let directory = tempfile::tempdir().unwrap();
    let router = Daemon::start(directory.path(), RIGID_TEARDROP, &[]);
    let mut child = serve(
        directory.path(),
        &[
            "--connect",
            &router.endpoint,
            "--instance",
            "second",
            "--for",
            "1s",
        ],
    );
    let ready = first_line(&mut child);
    assert_eq!(ready["listen"].as_array().unwrap().len(), 0, "{ready}");
    assert_eq!(code(&child.wait_with_output().unwrap()), 0);
}

fn a_device_waits_for_its_daemon_and_a_second_one_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let port = free_port();
    let endpoint = format!("tcp/127.0.0.1:{port}");
    // The device is there first.
    let first = Command::new(PROGRAM)
        .args([
            "device",
            "--tool",
            "ball",
            "--for",
            "5s",
            "--wait",
            "60s",
            "--connect",
            &endpoint,
        ])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(500));
    let daemon = Daemon::start_at(port, directory.path(), RIGID_TEARDROP, &[]);
    let palpate_client = daemon.connect();
    let begun = Instant::now();
    while palpate_client.device("ball").is_err() {
        assert!(begun.elapsed() < Duration::from_secs(60), "no device came");
    }
    let second = palpate(
        directory.path(),
        &[
            "device",
            "--tool",
            "ball",
            "--for",
            "1s",
            "--connect",
            &endpoint,
        ],
    );
    assert_eq!(code(&second), 2, "{}", words(&second));
    assert!(
        words(&second).contains("held by another client (ideal)"),
        "{}",
        words(&second)
    );
    // The daemon goes: the first device says so.
    palpate_client.close();
    drop(daemon);
    let first = first.wait_with_output().unwrap();
    assert_eq!(code(&first), 3);
}

#[test]
fn scenes_of_the_program_are_listed_written_and_built() {
    let directory = tempfile::tempdir().unwrap();
    let listed = palpate(directory.path(), &["scenes", "--json"]);
    let listed = String::from_utf8(listed.stdout).unwrap();
    let names: Vec<Value> = listed
        .lines()
        .map(|line| serde_json::from_str::<Value>(line).unwrap()["scene"].clone())
        .collect();
    assert!(names.len() >= 5, "{listed}");
    for name in &names {
        let name = name.as_str().unwrap();
        let checked = palpate(directory.path(), &["plan", name]);
        assert_eq!(code(&checked), 0, "{name}: {}", words(&checked));
    }
    let new = palpate(directory.path(), &["new", "mine"]);
    assert_eq!(code(&new), 0);
    assert_eq!(code(&palpate(directory.path(), &["check", "mine.toml"])), 0);
    let twice = palpate(directory.path(), &["new", "mine"]);
    assert_eq!(code(&twice), 2);
    let unknown = palpate(directory.path(), &["check", "builtin:teardorp"]);
    assert!(
        words(&unknown).contains("rigid-teardrop"),
        "{}",
        words(&unknown)
    );
}

#[test]
fn completions_into_a_closed_pipe_end_quietly() {
    let done = Command::new("bash")
        .args([
            "-c",
            "set -o pipefail; \"$0\" completions bash | head -c 1 > /dev/null",
            PROGRAM,
        ])
        .output()
        .unwrap();
    assert_eq!(code(&done), 0, "{}", words(&done));
    assert!(!words(&done).contains("panicked"), "{}", words(&done));
}

// --- messages

#[test]
fn a_missing_file_is_named_once_with_one_reason() {
    let directory = tempfile::tempdir().unwrap();
    let commands: [&[&str]; 6] = [
        &["surface", "info", "gone.json"],
        &["surface", "fit", "gone.stl", "-o", "x.json"],
        &["check", "gone.json"],
        &["replay", "gone.json"],
        &["export", "gone.json", "--csv", "x.csv"],
        &["probe", "builtin:sheet", "--poses", "gone.json"],
    ];
    for command in commands {
        let output = palpate(directory.path(), command);
        let said = words(&output);
        assert_eq!(code(&output), 2, "{command:?}: {said}");
        assert_eq!(said.matches("os error 2").count(), 1, "{command:?}: {said}");
        assert_eq!(said.matches("gone.").count(), 1, "{command:?}: {said}");
    }
}

#[test]
fn a_tool_with_two_shapes_or_none_is_told_which_there_are() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let body = "[[body]]\nid = \"a\"\nsurface = { builtin = \"sheet\" }\n[[tool]]\nid = \"b\"\n";
    for (shape, wanted) in [
        (
            "{ sphere = { radius_m = 0.01 }, point = {} }",
            "more than one",
        ),
        ("{}", "none"),
    ] {
        std::fs::write(path.join("s.toml"), format!("{body}shape = {shape}\n")).unwrap();
        let said = words(&palpate(path, &["check", "s.toml"]));
        assert!(said.contains("s.toml:6:"), "{said}");
        assert!(said.contains(wanted) && said.contains("capsule"), "{said}");
    }
}

#[test]
fn a_tool_that_starts_inside_a_body_is_told_where_it_could_start() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let scene = RIGID_TEARDROP;
    let inside = scene.replace(
        "position = [0.06, 0.003, 0.045]",
        "position = [0.0, 0.003, 0.045]",
    );
    assert_ne!(scene, inside);
    std::fs::write(path.join("in.toml"), &inside).unwrap();
    let output = palpate(path, &["check", "in.toml", "--json"]);
    let report = json(&output);
    assert_eq!(report["warnings"][0]["path"], "tool[0].pose", "{report}");
    let said = report["warnings"][0]["what"].as_str().unwrap().to_owned();
    assert!(
        said.contains("tool ball: it starts") && said.contains("inside body drop"),
        "{said}"
    );
    // What it suggests is outside.
    let place = said.rsplit_once("position = ").unwrap().1;
    std::fs::write(
        path.join("out.toml"),
        scene.replace("[0.06, 0.003, 0.045]", place),
    )
    .unwrap();
    let report = json(&palpate(path, &["check", "out.toml", "--json"]));
    assert_eq!(report["warnings"], serde_json::json!([]), "{place}");
}

#[test]
fn what_would_take_gigabytes_is_refused_at_once() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    let body = "[[body]]\nid = \"a\"\nsurface = { builtin = \"teardrop\" }\nmodel = \"lattice\"\n";
    for (lattice, wanted) in [
        (
            "{ layers = 1000000000 }",
            "layers is 1000000000; it must be 1 to 64",
        ),
        (
            "{ refine = [1000, 1000] }",
            "1000 x 1000 points in 3 layers are more than",
        ),
    ] {
        std::fs::write(path.join("s.toml"), format!("{body}lattice = {lattice}\n")).unwrap();
        let output = palpate(path, &["check", "s.toml"]);
        assert_eq!(code(&output), 2);
        assert!(words(&output).contains(wanted), "{}", words(&output));
    }
    write_stl(
        &path.join("ball.stl"),
        &surface("sphere", None),
        Unit::Metre,
    );
    for (options, wanted) in [
        (["--smoothing", "1e30"], "at most 1000"),
        (["--net", "1000x1000"], "are more than"),
    ] {
        let mut command = vec!["surface", "fit", "ball.stl", "-o", "x.json"];
        command.extend(options);
        let output = palpate(path, &command);
        assert_eq!(code(&output), 2, "{}", words(&output));
        assert!(words(&output).contains(wanted), "{}", words(&output));
    }
}

#[test]
fn logs_are_json_where_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    let output = palpate(
        directory.path(),
        &[
            "serve",
            "builtin:rigid-teardrop",
            "--listen",
            "tcp/127.0.0.1:0",
            "--no-rt",
            "--for",
            "300ms",
            "--log-format",
            "json",
        ],
    );
    assert_eq!(code(&output), 0, "{}", words(&output));
    let said = words(&output);
    let logs: Vec<Value> = said
        .lines()
        .filter(|line| line.starts_with('{'))
        .map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}")))
        .collect();
    assert!(!logs.is_empty(), "{said}");
    for log in &logs {
        assert!(
            log["timestamp"].is_string() && log["level"].is_string(),
            "{log}"
        );
    }
}

fn hz_prints_while_it_watches_and_echo_names_flags() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), RIGID_TEARDROP, &[]);
    let endpoint = daemon.endpoint.as_str();
    let run = |arguments: &[&str]| {
        let arguments = [arguments, &["--connect", endpoint]].concat();
        let output = palpate(directory.path(), &arguments);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        (output, said)
    };
    std::thread::scope(|scope| {
        let watched = scope.spawn(|| run(&["hz", "status", "--for", "3500ms"]));
        // A tool that does not exist is named, not the body that it was to press.
        let (wrong, _) = run(&["device", "--tool", "bll", "--for", "1s"]);
        assert_eq!(code(&wrong), 2);
        assert!(
            words(&wrong).contains("no tool \"bll\"; it has ball"),
            "{}",
            words(&wrong)
        );
        let echo = ["echo", "tool/ball/force", "--count", "200", "--for", "5s"];
        let echoed = scope.spawn(move || run(&echo));
        device(endpoint, &["--motion", "press", "--for", "2s"]);
        let (_, said) = echoed.join().unwrap();
        assert!(said.contains("\"RAMPING\""), "{said}");
        let (_, said) = watched.join().unwrap();
        assert!(
            said.matches("Hz now").count() >= 2 && said.contains("period p50"),
            "{said}"
        );
    });
}

#[test]
fn the_plan_measures_ticks_in_contact() {
    let directory = tempfile::tempdir().unwrap();
    for scene in ["builtin:rigid-teardrop", "builtin:sheet"] {
        let output = palpate(directory.path(), &["plan", scene, "--json"]);
        assert_eq!(code(&output), 0);
        assert!(
            !words(&output).contains("tools in contact"),
            "{scene}: {}",
            words(&output)
        );
    }
}

#[test]
fn the_plan_compares_forces_at_rest_with_those_of_finer_nets() {
    let directory = tempfile::tempdir().unwrap();
    let slab = |layers: usize| {
        let scene = format!(
            "[[body]]\nid = \"gel\"\nsurface = {{ builtin = \"sheet\", net = [7, 7], size = 0.06 }}\n\
             material = {{ young_pa = 20e3 }}\nlattice = {{ layers = {layers}, thickness_m = 0.02 }}\n\
             fixed = [{{ point = [0.0, 0.0, -0.02], normal = [0.0, 0.0, 1.0] }}]\n\
             [[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = 0.01 }} }}\n\
             pose = {{ position = [0.0, 0.0, 0.02] }}\n"
        );
        std::fs::write(directory.path().join("s.toml"), scene).unwrap();
    };
    let off = |scene: &str| {
        let output = palpate(directory.path(), &["plan", scene, "--finer", "--json"]);
        assert_eq!(code(&output), 0, "{}", words(&output));
        let plan: Value = serde_json::from_slice(&output.stdout).unwrap();
        let rest = &plan["rest"][0];
        assert_eq!(rest["tool"], "ball");
        assert_eq!(rest["at_rest"], true);
        let [force_n, finer_n] = ["force_n", "finer_n"].map(|key| rest[key].as_f64().unwrap());
        assert!(force_n > 0.05, "{force_n} N");
        force_n / finer_n - 1.0
    };
    // One layer of cells is too stiff under a ball of half its thickness.
    slab(2);
    let one_layer = off("s.toml");
    slab(3);
    let two_layers = off("s.toml");
    assert!(one_layer > 0.1, "{one_layer}");
    assert!(two_layers.abs() < 0.05, "{two_layers}");
    // Nothing of a rigid body depends on its net.
    assert_eq!(off("builtin:rigid-teardrop"), 0.0);
}

// --- files of scanners and of CAD

#[test]
fn scenes_take_cad_files_and_scans_where_one_surface_results() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    for arguments in [
        ["surface", "convert", "builtin:sphere", "ball.step"],
        ["surface", "convert", "builtin:sphere", "ball.igs"],
        ["surface", "convert", "builtin:sphere", "ball.stl"],
        ["surface", "convert", "builtin:sphere", "ball.glb"],
    ] {
        let output = palpate(path, &arguments);
        assert_eq!(code(&output), 0, "{}", words(&output));
    }
    let check = |surface: &str| {
        let tool = "[[tool]]\nid = \"t\"\npose = { position = [0.2, 0.0, 0.0] }\n";
        let text = format!("[[body]]\nid = \"a\"\nsurface = {surface}\n{tool}");
        std::fs::write(path.join("s.toml"), text).unwrap();
        let output = palpate(path, &["check", "s.toml"]);
        (code(&output), words(&output))
    };
    for surface in [
        "{ file = \"ball.step\" }",
        "{ file = \"ball.igs\" }",
        "{ file = \"ball.stl\", unit = \"m\" }",
        "{ file = \"ball.glb\", net = [12, 10] }",
    ] {
        assert_eq!(check(surface), (0, String::new()), "{surface}");
    }
    for (surface, wanted) in [
        ("{ file = \"ball.stl\" }", "does not give its unit"),
        (
            "{ file = \"ball.step\", unit = \"mm\" }",
            "unit is for mesh files",
        ),
        (
            "{ file = \"ball.step\", index = 3 }",
            "the file has 1 of them",
        ),
        (
            "{ builtin = \"sheet\", index = 0 }",
            "index is for STEP and IGES",
        ),
        ("{ file = \"s.toml\" }", "s.toml"),
    ] {
        let (code, said) = check(surface);
        assert_eq!(code, 2, "{surface}: {said}");
        assert!(said.contains(wanted), "{surface}: {said}");
    }
    // A recording of such a scene needs no file.
    let text = "[[body]]\nid = \"a\"\nsurface = { file = \"ball.step\" }\n[[tool]]\nid = \"t\"\npose = { position = [0.2, 0.0, 0.0] }\n";
    std::fs::write(path.join("s.toml"), text).unwrap();
    let arguments = [
        "serve",
        "s.toml",
        "--listen",
        "tcp/127.0.0.1:0",
        "--no-rt",
        "--for",
        "300ms",
        "--record",
        "r.mcap",
    ];
    assert_eq!(code(&palpate(path, &arguments)), 0);
    for name in ["s.toml", "ball.step"] {
        std::fs::remove_file(path.join(name)).unwrap();
    }
    let replayed = palpate(path, &["replay", "r.mcap"]);
    assert_eq!(code(&replayed), 0, "{}", words(&replayed));
}

// glTF is in metres; of the others the unit is asked for.
#[test]
fn scans_in_ply_and_gltf_are_imported() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path();
    // Round: how far a net follows a pointed tip is another question.
    let ball = surface("sphere", None);
    std::fs::write(
        path.join("scan.glb"),
        write_mesh(&ball, Format::Glb, Unit::Metre).unwrap(),
    )
    .unwrap();
    let mut ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        ball.points.len(),
        ball.triangles.len()
    );
    for p in &ball.points {
        ply += &format!("{} {} {}\n", p.x * 1e3, p.y * 1e3, p.z * 1e3);
    }
    for [a, b, c] in &ball.triangles {
        ply += &format!("3 {a} {b} {c}\n");
    }
    std::fs::write(path.join("scan.ply"), ply).unwrap();
    let imported = palpate(
        path,
        &[
            "import", "scan.glb", "--net", "20x20", "--model", "rigid", "-o", "a.toml",
        ],
    );
    assert_eq!(code(&imported), 0, "{}", words(&imported));
    let asked = palpate(path, &["import", "scan.ply", "-o", "b.toml"]);
    assert_eq!(code(&asked), 2);
    assert!(words(&asked).contains("--unit mm"), "{}", words(&asked));
    let volume = |name: &str| {
        let info = json(&palpate(path, &["surface", "info", name, "--json"]));
        // In the unit of the file.
        let metres = if info["unit"] == "mm" { 1e-3_f64 } else { 1.0 };
        info["volume"].as_f64().unwrap() * metres.powi(3)
    };
    let of_glb = volume("a.json");
    let fitted = palpate(
        path,
        &[
            "surface", "fit", "scan.ply", "--unit", "mm", "--net", "20x20", "-o", "b.json",
        ],
    );
    assert_eq!(code(&fitted), 0, "{}", words(&fitted));
    // Of the triangles themselves, by the divergence theorem.
    let corner = |k: u32| ball.points[k as usize].coords;
    let ball_m3: f64 = ball
        .triangles
        .iter()
        .map(|&[a, b, c]| corner(a).dot(&corner(b).cross(&corner(c))) / 6.0)
        .sum();
    for volume in [of_glb, volume("b.json")] {
        assert!(
            (volume / ball_m3 - 1.0).abs() < 0.02,
            "{volume} m³ of {ball_m3}"
        );
    }
}

// Nothing deforms, and still the force is there only when the tool has come to rest.
#[test]
fn a_probe_of_a_rigid_body_waits_until_the_force_has_settled() {
    let directory = tempfile::tempdir().unwrap();
    let mut random = palpate_geometry::math::Random(8);
    for (shape, low_m) in [
        ("cylinder = { radius_m = 0.01, half_length_m = 0.01 }", 0.01),
        ("box = { half_extents_m = [0.02, 0.01, 0.005] }", 0.005),
        ("cone = { half_angle_rad = 0.4, height_m = 0.02 }", 0.0),
        ("sphere = { radius_m = 0.007 }", 0.007),
        ("point = {}", 0.0),
    ] {
        let scene = format!(
            "[[body]]\nid = \"sheet\"\nsurface = {{ builtin = \"sheet\", size = 0.2 }}\n\
             [[tool]]\nid = \"t\"\nshape = {{ {shape} }}\npose = {{ position = [0.0, 0.0, 0.05] }}\n"
        );
        std::fs::write(directory.path().join("scene.toml"), scene).unwrap();
        let depths: [f64; 4] = std::array::from_fn(|_| random.float(1e-4, 6e-3));
        let place = |random: &mut palpate_geometry::math::Random| random.float(-0.03, 0.03);
        let line = |depth: &f64| {
            let (x, y) = (place(&mut random), place(&mut random));
            format!("{x},{y},{}\n", low_m - depth)
        };
        let poses: String = depths.iter().map(line).collect();
        std::fs::write(directory.path().join("at.csv"), poses).unwrap();
        let output = palpate(
            directory.path(),
            &["probe", "scene.toml", "--poses", "at.csv", "--json"],
        );
        let text = String::from_utf8_lossy(&output.stdout);
        let rows: Vec<Value> = text
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        assert_eq!(
            rows.len(),
            depths.len(),
            "{shape}: {text}{}",
            words(&output)
        );
        for (row, depth) in rows.iter().zip(depths) {
            let force = row["force"][2].as_f64().unwrap();
            assert_eq!(row["settled"], true, "{shape} {depth} m: {row}");
            let error = force / (1_000.0 * depth) - 1.0;
            assert!(
                error.abs() < 1e-4,
                "{shape} {depth} m deep: {force} N, {row}"
            );
        }
    }
}
