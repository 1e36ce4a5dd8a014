//! Commands and programs of the guides are executed as they stand.
//!
//! A `sh` block runs in bash, in a directory with the repository's files; after the language stands
//! what else it needs: `daemon`, a running teardrop; `recording`, a session.mcap; `build`, that
//! Cargo builds, `npm`, what npm runs in clients/web, and `peer`, another program (these only parsed, in `documents`; what needs a peer runs
//! with one in the tests of that peer). What would run until it is stopped is given two
//! seconds, what would run for longer than four seconds is given four, and port 7447 is another for each block.

use crate::daemon::{Daemon, PROGRAM, free_port};
use crate::documents::{Block, blocks, root};
use crate::golden::made_again;
use crate::scenes::RIGID_TEARDROP;
use palpate_client::testing::TestSession;
use palpate_client::{Connect, Palpate, pose_at};
use std::collections::BTreeSet;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// `palpate` as blocks call it.
const WRAPPER: &str = r#"#!/bin/bash
args=()
for word in "$@"; do
  word=${word//7447/$DOC_PORT}
  [[ $before = --for && $word =~ ^[0-9]+s$ && ${word%s} -gt 4 ]] && word=4s
  [ "$word" = 127.0.0.1:8080 ] && word=127.0.0.1:0
  args+=("$word")
  before=$word
done
export XDG_CACHE_HOME="$PWD/.cache"
has() { for word in "${args[@]}"; do [ "$word" = "$1" ] && return 0; done; return 1; }
short=0
case "$1" in
  serve) has --listen || args+=(--listen "tcp/127.0.0.1:$DOC_SERVE_PORT"); args+=(--no-rt); has --for || args+=(--for 2s);;
  demo) has --for || args+=(--for 2s);;
  device) has --list || has --connect || args+=(--connect "tcp/127.0.0.1:$DOC_PORT"); has --for || has --list || args+=(--for 2s);;
  rpc|ls|echo) has --connect || args+=(--connect "tcp/127.0.0.1:$DOC_PORT");;
  doctor) args+=(--for 200ms --ticks 300);;
  hz) has --connect || args+=(--connect "tcp/127.0.0.1:$DOC_PORT"); short=1;;
  play) args+=(--listen "tcp/127.0.0.1:$DOC_SERVE_PORT"); short=1;;
  lobby) args+=(--http 127.0.0.1:0);;
  view) args+=(--no-open); has --html || short=1;;
esac
if [ $short = 1 ]; then
  # Ended by the signal that Ctrl-C sends.
  timeout --signal INT --kill-after 20 2 "$DOC_PROGRAM" "${args[@]}" < /dev/null
  code=$?
  [ $code = 124 ] && code=0
  exit $code
fi
exec "$DOC_PROGRAM" "${args[@]}" < /dev/null
"#;

/// A directory like the repository's root: what blocks write stays there.
fn workplace() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    for entry in std::fs::read_dir(root()).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name();
        if !["target", ".git", "recordings"].contains(&&*name.to_string_lossy()) {
            std::os::unix::fs::symlink(entry.path(), directory.path().join(name)).unwrap();
        }
    }
    let wrapper = directory.path().join("bin/palpate");
    std::fs::create_dir(wrapper.parent().unwrap()).unwrap();
    std::fs::write(&wrapper, WRAPPER).unwrap();
    std::fs::set_permissions(&wrapper, std::fs::Permissions::from_mode(0o755)).unwrap();
    directory
}

fn add_recording(directory: &Path) {
    let golden = root().join("recordings/golden/rigid-teardrop-press.mcap");
    let made = made_again("rigid-teardrop-press");
    std::fs::create_dir_all(directory.join("recordings")).unwrap();
    for name in ["session.mcap", "replayed.mcap", "recordings/session.mcap"] {
        std::fs::copy(&made, directory.join(name)).unwrap();
    }
    std::fs::copy(
        golden.with_extension("mcap.figures.json"),
        directory.join("session.mcap.figures.json"),
    )
    .unwrap();
}

/// Runs a block; on failure the document's line of the command and what it printed.
fn run(block: &Block) -> Result<(), String> {
    let directory = workplace();
    let (port, serve_port) = (free_port(), free_port());
    let mut kinds = block.kind.split_whitespace();
    let needs = |kind: &str| block.kind.split_whitespace().any(|word| word == kind);
    if let Some(other) = kinds.find(|kind| !["daemon", "recording"].contains(kind)) {
        return Err(format!("{}: {other:?} is no kind of block", block.place));
    }
    if needs("recording") {
        add_recording(directory.path());
    }
    let daemon = needs("daemon").then(|| {
        let kept = directory.path().join("kept");
        let arguments = ["--ring", "30s", "--record-dir", kept.to_str().unwrap()];
        Daemon::start_at(port, directory.path(), RIGID_TEARDROP, &arguments)
    });
    // Without a daemon of its own a block starts the one that its clients connect to.
    let serve_port = if daemon.is_some() { serve_port } else { port };
    let script = format!(
        "set -E\ntrap 'code=$?; echo \"@$((LINENO - {HEAD})) exit code $code\" >&2; exit 1' ERR\n{}",
        block.code
    );
    const HEAD: usize = 2;
    let path = std::env::var("PATH").unwrap_or_default();
    let bin = directory.path().join("bin");
    let done = Command::new("timeout")
        .args(["--kill-after", "10", "120", "bash", "-c", &script])
        .current_dir(directory.path())
        .env("PATH", format!("{}:{path}", bin.display()))
        .env("DOC_PROGRAM", PROGRAM)
        .env("DOC_PORT", port.to_string())
        .env("DOC_SERVE_PORT", serve_port.to_string())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    if done.status.success() {
        return Ok(());
    }
    let stderr = String::from_utf8_lossy(&done.stderr);
    let (file, fence) = block.place.rsplit_once(':').unwrap();
    let line = stderr
        .rsplit('@')
        .next()
        .and_then(|rest| rest.split(' ').next())
        .and_then(|line| line.parse::<usize>().ok())
        .unwrap_or(0);
    let fence: usize = fence.parse().unwrap();
    Err(format!(
        "{file}:{}: {}\n{stderr}",
        fence + line,
        block
            .code
            .lines()
            .nth(line.saturating_sub(1))
            .unwrap_or_default()
    ))
}

/// Runs the blocks of a document that can be run here, four at a time: most of the time they wait.
fn run_all(document: &str) {
    let blocks: Vec<Block> = runnable().filter(|block| of(block) == document).collect();
    assert!(!blocks.is_empty(), "{document} has no commands");
    let next = AtomicUsize::new(0);
    let worker = || -> Vec<String> {
        std::iter::from_fn(|| blocks.get(next.fetch_add(1, Ordering::Relaxed)))
            .filter_map(|block| {
                let begun = Instant::now();
                let done = run(block);
                println!("{}: {:.1} s", block.place, begun.elapsed().as_secs_f64());
                done.err()
            })
            .collect()
    };
    let failures = std::thread::scope(|scope| {
        let workers = [(); 4].map(|()| scope.spawn(worker));
        workers.map(|worker| worker.join().unwrap()).concat()
    });
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Output as documents show it: lines that begin with `$ ` are run, and each other line is one of those that the
/// commands print, in their order.
#[test]
fn output_is_what_commands_print() {
    let shown = blocks().into_iter().filter(|block| block.kind == "output");
    for block in shown {
        let directory = workplace();
        let lines = || block.code.lines();
        let commands: Vec<&str> = lines().filter_map(|line| line.strip_prefix("$ ")).collect();
        let path = std::env::var("PATH").unwrap_or_default();
        let done = Command::new("bash")
            .args(["-e", "-c", &commands.join("\n")])
            .current_dir(directory.path())
            .env(
                "PATH",
                format!("{}:{path}", directory.path().join("bin").display()),
            )
            .env("DOC_PROGRAM", PROGRAM)
            .output()
            .unwrap();
        let printed = String::from_utf8(done.stdout).unwrap();
        let mut printed_lines = printed.lines().map(str::trim);
        for line in lines().filter(|line| !line.starts_with("$ ")) {
            let found = printed_lines.any(|printed| printed == line);
            assert!(found, "{}: {line:?} is not next in\n{printed}", block.place);
        }
    }
}

fn runnable() -> impl Iterator<Item = Block> {
    blocks().into_iter().filter(|block| {
        block.language == "sh" && !["build", "npm", "peer"].contains(&block.kind.as_str())
    })
}

/// The document of a block.
fn of(block: &Block) -> &str {
    block.place.rsplit_once(':').unwrap().0
}

/// A test for each document, and one that none is left out.
macro_rules! documents {
    ($($test:ident: $document:literal;)*) => {
        $(
            #[test]
            fn $test() {
                run_all($document);
            }
        )*

        #[test]
        fn the_commands_of_every_document_are_run() {
            let run = BTreeSet::from([$($document.to_owned()),*]);
            let all: BTreeSet<String> = runnable().map(|block| of(&block).to_owned()).collect();
            assert_eq!(run, all);
        }
    };
}

documents! {
    commands_of_the_readme_run: "README.md";
    commands_of_batch_run: "docs/batch.md";
    commands_of_branch_run: "docs/branch.md";
    commands_of_connect_run: "docs/connect.md";
    commands_of_deployment_run: "docs/deployment.md";
    commands_of_devices_run: "docs/devices.md";
    commands_of_getting_started_run: "docs/getting-started.md";
    commands_of_merge_run: "docs/merge.md";
    commands_of_page_run: "docs/page.md";
    commands_of_recording_run: "docs/recording.md";
    commands_of_replay_run: "docs/replay.md";
    commands_of_scenarios_run: "docs/scenarios.md";
    commands_of_scene_run: "docs/scene.md";
    commands_of_security_run: "docs/security.md";
    commands_of_wire_run: "docs/wire.md";
}

// The line is that of the command, not of the fence.
#[test]
fn a_block_that_fails_is_named_with_its_line() {
    let block = Block {
        place: "docs/page.md:10".into(),
        language: "sh".into(),
        kind: String::new(),
        code: "palpate scenes\npalpate surface info nothing.json\npalpate scenes\n".into(),
    };
    let failure = run(&block).unwrap_err();
    assert!(
        failure.starts_with("docs/page.md:12: palpate surface info nothing.json"),
        "{failure}"
    );
}

/// The text between two comments of this file, without its indentation.
fn region(name: &str) -> String {
    let source = include_str!("documents_run.rs");
    let begin = format!("// begin {name}\n");
    let text = source.split(&begin).nth(1).unwrap();
    let text = text.split("// end").next().unwrap();
    plain(text)
}

/// Words of a program, whatever its lines and comments.
fn plain(text: &str) -> String {
    let code = text.lines().map(|line| line.split("   //").next().unwrap());
    code.flat_map(str::split_whitespace).collect()
}

fn rust_block(document: &str) -> String {
    let of = blocks()
        .into_iter()
        .find(|block| block.place.starts_with(document) && block.language == "rust");
    plain(&of.unwrap().code)
}

// What the README shows, at the endpoint of a daemon of this test.
#[test]
fn the_client_of_the_readme_feels_the_surface() {
    let directory = tempfile::tempdir().unwrap();
    let daemon = Daemon::start(directory.path(), RIGID_TEARDROP, &[]);
    let client = || -> Result<Option<f64>, Box<dyn std::error::Error>> {
        // begin client
        let palpate = Palpate::connect(&Connect::to(&daemon.endpoint))?;
        let mut ball = palpate.tool("ball")?;
        // The drop is touched at x = 0.0274.
        for k in 0..1000 {
            let x = 0.06 - 3.5e-5 * f64::from(k);
            let seq = ball.send(pose_at([x, 0.003, 0.045]))?;
            let force = ball.wait_force(seq, Duration::from_millis(50));
            if let Some(force) = force.filter(|force| force.contact_count > 0) {
                println!("x = {x:.4} m: {:?} N", force.force);
                // end
                return Ok(Some(x));
            }
        }
        Ok(None)
    };
    let x = client().unwrap().expect("the ball touched nothing");
    assert!((0.025..0.028).contains(&x), "{x}");
    let shown = rust_block("README.md").replace("\"tcp/127.0.0.1:7447\"", "&daemon.endpoint");
    assert!(
        shown.contains(&region("client")),
        "{shown}\n{}",
        region("client")
    );
}

// What docs/recording.md shows, with the program of this build.
#[test]
fn the_test_of_the_recording_guide_passes() {
    let directory = tempfile::tempdir().unwrap();
    let record = directory.path().join("press.mcap");
    let the_test = || -> Result<(), Box<dyn std::error::Error>> {
        let mut session = TestSession::of(RIGID_TEARDROP)
            .program(PROGRAM)
            .record(&record)
            .start()?;
        // begin press
        let mut ball = session.tool("ball")?;
        let mut peak = 0.0_f64;
        for k in 0..700 {
            let force = session.step(&mut ball, pose_at([0.06 - 5e-5 * k as f64, 0.003, 0.045]))?;
            peak = peak.max(force.force[0]);
        }
        assert!((1.0..8.0).contains(&peak), "{peak} N");
        session.finish(ball)?;
        // end
        Ok(())
    };
    the_test().unwrap();
    assert!(record.exists());
    let shown = rust_block("docs/recording.md");
    assert!(
        shown.contains(&region("press")),
        "{shown}\n{}",
        region("press")
    );
}
