//! `palpate batch`: its runs have the bits of a daemon's, shards make the whole, nothing is run twice.

use crate::daemon::{Daemon, PROGRAM, device, free_port};
use crate::scenes::SOFT_DROP;
use palpate_client::proto::rpc::Call;
use palpate_experiment::batch::{Cache, Settings, Sweep, Table};
use palpate_sim::tick::quantity::Number;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Two values, two motions, three seeds: twelve runs of 0.3 s.
const SWEEP: &str = r#"
scene = "scene.toml"
for_s = 0.3
seeds = { from = 5, count = 3 }

[set]
"body.drop.lattice.refine" = "none"

[vary]
"tool.ball.coupling.stiffness_n_m" = [400.0, 800.0]

[[motion]]
name = "tap"
hands.ball = { motion = "tap", depth_m = 0.003 }

[[motion]]
name = "trembling"
hands.ball = { motion = "tap", device = "touch", tremor_m = 1e-4, delay_s = 0.002, loss = 0.1 }
"#;

fn settings(jobs: usize, shard: (usize, usize), cache: Option<Cache>) -> Settings {
    Settings { jobs, shard, cache }
}

/// A folder with a scene and a sweep.
fn folder(sweep: &str) -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    let scene = format!("{SOFT_DROP}coupling = {{ stiffness_n_m = 800.0, damping_n_s_m = 0.5 }}\n");
    std::fs::write(directory.path().join("scene.toml"), scene).unwrap();
    std::fs::write(directory.path().join("sweep.toml"), sweep).unwrap();
    directory
}

fn load(directory: &Path) -> Sweep {
    Sweep::load(&directory.join("sweep.toml")).unwrap_or_else(|error| panic!("{error}"))
}

/// stdout, stderr, exit code.
fn palpate(directory: &Path, arguments: &[&str]) -> (String, String, i32) {
    let output = Command::new(PROGRAM)
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let code = output.status.code().unwrap_or(-1);
    (text(output.stdout), text(output.stderr), code)
}

// The daemon's loop, bus, recorder and client take the same steps as a run of a batch, or one of them is
// wrong: nothing of it is shared but the tick and the servo period.
#[test]
fn a_run_has_the_bits_of_a_daemon_in_lockstep_with_a_device() {
    let directory = folder(
        "scene = \"scene.toml\"\nfor_s = 1.5\nseeds = [7]\n[[motion]]\nname = \"p\"\n\
         hands.ball = { motion = \"press\", depth_m = 0.005, device = \"touch\", hand = \"firm\", tremor_m = 2e-4, \
         delay_s = 0.003, jitter_s = 0.002, loss = 0.05, reorder = 0.05, passivity = true }\n",
    );
    let batch = load(directory.path()).run(&settings(1, (1, 1), None), |_, _| {});
    let outcome = &batch.rows[0].outcome;
    assert_eq!((outcome.error.as_ref(), outcome.ticks), (None, 1500));
    let scene = std::fs::read_to_string(directory.path().join("scene.toml")).unwrap();
    let file = directory.path().join("session.mcap");
    let served = directory.path().join("served");
    std::fs::create_dir(&served).unwrap();
    let arguments = [
        "--clock",
        "lockstep",
        "--json",
        "--record",
        file.to_str().unwrap(),
    ];
    let daemon = Daemon::start_at(free_port(), &served, &scene, &arguments);
    let told = "--device touch --hand firm --tremor 2e-4 --motion press --depth 0.005 --delay 3ms --jitter 2ms \
                --loss 0.05 --reorder 0.05 --passivity --seed 7 --for 1500ms";
    let (report, code) = device(
        &daemon.endpoint,
        &told.split_whitespace().collect::<Vec<_>>(),
    );
    assert_eq!(code, 0, "{report}");
    daemon.connect().rpc(Call::Shutdown).unwrap();
    let (summary, _) = daemon.end();
    let last: serde_json::Value = serde_json::from_str(summary.lines().last().unwrap()).unwrap();
    let recorded = &last["recordings"][0]["session_hash"];
    assert_eq!(*recorded, outcome.session_hash, "{last}");
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let peak_n = report["peak_force_n"].as_f64().unwrap();
    let ours_n = outcome.tools[0].peak_force_n;
    // The device's first force is that of the first tick it waited for.
    assert!(
        peak_n > 0.05 && (peak_n - ours_n).abs() < 1e-12,
        "{peak_n} {ours_n}"
    );
}

#[test]
fn shards_together_are_the_whole_whatever_the_jobs() {
    let directory = folder(SWEEP);
    let sweep = load(directory.path());
    let table = |jobs, shard| {
        let batch = sweep.run(&settings(jobs, shard, None), |_, _| {});
        assert_eq!(batch.failed(), 0);
        Table::new(sweep.plan(), &batch.rows, false)
    };
    let whole = String::from_utf8(table(2, (1, 1)).csv()).unwrap();
    let mut lines: Vec<String> = Vec::new();
    for shard in 1..=5 {
        let part = String::from_utf8(table(1, (shard, 5)).csv()).unwrap();
        let mut part = part.lines();
        assert_eq!(part.next(), whole.lines().next());
        lines.extend(part.map(str::to_owned));
    }
    lines.sort_by_key(|line| line.split(',').next().unwrap().parse::<usize>().unwrap());
    let rows: Vec<&str> = whole.lines().skip(1).collect();
    assert_eq!(lines, rows);
    assert_eq!(rows.len(), 12);
    // Runs differ where they should: by value, and by seed where there is a device.
    let hashes: Vec<String> = (table(1, (1, 1)).json().lines())
        .filter_map(|line| {
            serde_json::from_str::<serde_json::Value>(line.trim_end_matches(',')).ok()
        })
        .map(|row| row["session_hash"].as_str().unwrap().to_owned())
        .collect();
    let distinct: std::collections::BTreeSet<&String> = hashes.iter().collect();
    assert_eq!((hashes.len(), distinct.len()), (12, 2 + 6), "{hashes:?}");
    assert!(
        hashes[0] == hashes[1] && hashes[3] != hashes[4],
        "{hashes:?}"
    );
}

#[test]
fn nothing_is_run_twice_unless_something_that_decides_it_changed() {
    let directory = folder(SWEEP);
    let cache = Cache::at(directory.path().join("cache"));
    let run = |sweep: &Sweep| sweep.run(&settings(2, (1, 1), Some(cache.clone())), |_, _| {});
    let sweep = load(directory.path());
    // Without a device seeds decide nothing of the bits, and are part of the key all the same.
    let first = run(&sweep);
    let again = run(&sweep);
    assert_eq!((first.cached, again.cached, again.rows.len()), (0, 12, 12));
    let csv = |rows| Table::new(sweep.plan(), rows, true).csv();
    assert_eq!(
        csv(&first.rows),
        csv(&again.rows),
        "wall times are those of the first"
    );
    // A damaged entry is made again, and so is one that says something else.
    let mut files = Vec::new();
    for folder in std::fs::read_dir(directory.path().join("cache")).unwrap() {
        for file in std::fs::read_dir(folder.unwrap().path()).unwrap() {
            files.push(file.unwrap().path());
        }
    }
    files.sort();
    assert_eq!(files.len(), 12);
    let text = std::fs::read_to_string(&files[0]).unwrap();
    std::fs::write(&files[0], text.replace("\"ticks\":300", "\"ticks\":301")).unwrap();
    std::fs::write(&files[1], &text[..text.len() / 2]).unwrap();
    std::fs::write(&files[2], "").unwrap();
    let mended = run(&sweep);
    assert_eq!(mended.cached, 9);
    assert_eq!(
        Table::new(sweep.plan(), &mended.rows, false).csv(),
        Table::new(sweep.plan(), &first.rows, false).csv()
    );
    for (from, to, cached) in [
        ("for_s = 0.3", "for_s = 0.301", 0),
        ("800.0]", "801.0]", 6),
        ("loss = 0.1", "loss = 0.2", 6),
        ("from = 5", "from = 6", 8),
        ("refine\" = \"none\"", "layers\" = 3", 0),
    ] {
        let other = SWEEP.replace(from, to);
        assert_ne!(other, SWEEP);
        std::fs::write(directory.path().join("sweep.toml"), other).unwrap();
        assert_eq!(run(&load(directory.path())).cached, cached, "{to}");
    }
}

#[test]
fn every_quantity_is_a_column_on_request() {
    let columns: Vec<String> = Number::names().map(|name| format!("end_{name}")).collect();
    let directory =
        folder(&SWEEP.replacen("\n[set]", &format!("columns = {columns:?}\n\n[set]"), 1));
    let sweep = load(directory.path());
    let batch = sweep.run(&settings(2, (1, 12), None), |_, _| {});
    let table = Table::new(sweep.plan(), &batch.rows, false).csv();
    let table = String::from_utf8(table).unwrap();
    let heading: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let cells: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
    let cell = |name: &str| cells[heading.iter().position(|column| *column == name).unwrap()];
    assert!(columns.iter().all(|name| heading.contains(&name.as_str())));
    assert_eq!(cell("end_energy"), cell("energy_j"));
    let wrong = SWEEP.replacen("\n[set]", "columns = [\"end_banana\"]\n\n[set]", 1);
    let error = Sweep::parse(&wrong, "sweep", directory.path()).unwrap_err();
    assert!(error.to_string().contains("contact_force"), "{error}");
}

#[test]
fn a_run_that_fails_is_a_row_and_an_exit_code() {
    let text = SWEEP.replace("[400.0, 800.0]", "[400.0, -1.0, \"stiff\"]");
    let directory = folder(&text);
    let arguments = [
        "batch",
        "sweep.toml",
        "--no-cache",
        "-o",
        "a.json",
        "-o",
        "a.csv",
        "--shard",
        "1/3",
        "--json",
    ];
    let (out, err, code) = palpate(directory.path(), &arguments);
    assert_eq!(code, 3, "{err}");
    let told: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(
        (&told["runs"], &told["failed"]),
        (&6.into(), &4.into()),
        "{told}"
    );
    let text = std::fs::read_to_string(directory.path().join("a.json")).unwrap();
    let rows: Vec<BTreeMap<String, serde_json::Value>> = serde_json::from_str(&text).unwrap();
    for row in &rows {
        let stiffness = row["tool.ball.coupling.stiffness_n_m"].as_str().unwrap();
        let error = row["error"].as_str();
        match stiffness {
            "400.0" => assert!(error.is_none() && row["peak_force_n"].as_f64().unwrap() > 0.0),
            "-1.0" => assert!(error.unwrap().contains("stiffness_n_m") && row["time_s"].is_null()),
            _ => assert!(error.unwrap().contains("stiff"), "{row:?}"),
        }
    }
    assert!(err.contains("run 6 first"), "{err}");
    assert_eq!(
        std::fs::read_to_string(directory.path().join("a.csv"))
            .unwrap()
            .lines()
            .count(),
        7
    );
}

#[test]
fn what_cannot_be_a_sweep_is_refused_before_the_first_run() {
    let directory = folder(SWEEP);
    let refused = |text: &str, words: &[&str]| {
        std::fs::write(directory.path().join("sweep.toml"), text).unwrap();
        let arguments = ["batch", "sweep.toml", "--no-cache", "-o", "a.csv"];
        let (_, err, code) = palpate(directory.path(), &arguments);
        assert_eq!(code, 2, "{text}: {err}");
        for word in words {
            assert!(err.contains(word), "{word}: {err}");
        }
        assert!(!directory.path().join("a.csv").exists());
    };
    let with = |from: &str, to: &str| SWEEP.replace(from, to);
    refused(
        &with("coupling.stiffness_n_m\"", "coupling.stifness\""),
        &["stifness", "known are stiffness_n_m"],
    );
    refused(
        &with("tool.ball.coupling", "tool.bell.coupling"),
        &["no entry \"bell\""],
    );
    refused(
        &with("hands.ball", "hands.bell"),
        &["no tool \"bell\"", "ball"],
    );
    refused(
        &with("motion = \"tap\", depth", "motion = \"poke\", depth"),
        &["poke", "tremor"],
    );
    refused(
        &with("motion = \"tap\", depth", "motion = \"gone.toml\", depth"),
        &["gone.toml"],
    );
    refused(&with("device = \"touch\", ", ""), &["those of a device"]);
    refused(&with("\"touch\"", "\"feel\""), &["feel"]);
    refused(&with("scene.toml", "builtin:nothing"), &["rigid-teardrop"]);
    refused(&with("count = 3 }", "count = 0 }"), &["0 runs"]);
    refused(
        &with("count = 3 }", "count = 3000000 }"),
        &["12000000 runs"],
    );
    refused(&with("for_s = 0.3", "for_s = nan"), &["for_s"]);
    refused(&with("for_s", "fors"), &["line 3", "for_s"]);
    std::fs::write(directory.path().join("sweep.toml"), SWEEP).unwrap();
    for (more, words) in [
        (vec!["-o", "a.xls"], ".parquet"),
        (vec!["-o", "gone/a.csv"], "no such folder"),
        (vec!["-o", "a.csv", "--shard", "3/2"], "1/4"),
        (vec!["-o", "a.csv", "--shard", "0/2"], "1/4"),
    ] {
        let arguments: Vec<&str> = ["batch", "sweep.toml"].into_iter().chain(more).collect();
        let (_, err, code) = palpate(directory.path(), &arguments);
        assert!(code == 2 && err.contains(words), "{arguments:?}: {err}");
    }
}

#[test]
fn drawn_values_stay_as_they_are_when_another_key_is_drawn_too() {
    let random = "[random]\nsamples = 40\nseed = 9\n[vary]\n\"tool.ball.coupling.stiffness_n_m\" = { from = 100, to = 900 }\n";
    let text = |more: &str| {
        format!(
            "scene = \"scene.toml\"\nfor_s = 0.1\n{random}{more}[[motion]]\nname = \"tap\"\nhands.ball = {{ motion = \"tap\" }}\n"
        )
    };
    let directory = folder(&text(""));
    let plain = load(directory.path());
    let more = "\"body.drop.material.young_pa\" = { from = 1e3, to = 1e6, scale = \"log\" }\n";
    std::fs::write(directory.path().join("sweep.toml"), text(more)).unwrap();
    let both = load(directory.path());
    let mut sum = 0.0;
    for run in 0..40 {
        let (a, b) = (plain.plan().case(run).values, both.plan().case(run).values);
        let stiffness = a[0].as_float().unwrap();
        assert!((100.0..900.0).contains(&stiffness) && b[1].as_float() == Some(stiffness));
        assert!((1e3..1e6).contains(&b[0].as_float().unwrap()));
        sum += stiffness;
    }
    // Evenly from 100 to 900: the mean of 40 is 500 with a standard deviation of 37.
    assert!((sum / 40.0 - 500.0).abs() < 120.0, "{}", sum / 40.0);
}

// Read by others: Apache Arrow, which most tools have inside.
#[test]
fn parquet_reads_elsewhere_as_the_csv_does() {
    let python = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".into());
    let has = Command::new(&python)
        .args(["-c", "import pyarrow.parquet"])
        .output();
    if !has.is_ok_and(|output| output.status.success()) {
        println!("skipped: no Python with pyarrow (set PALPATE_PYTHON)");
        return;
    }
    let text = SWEEP.replace("[400.0, 800.0]", "[400.0, -1.0]").replace(
        "[vary]",
        "[vary]\n\"tool.ball.pose.position\" = [[0.06, 0.003, 0.045]]",
    );
    let directory = folder(&text);
    let arguments = [
        "batch",
        "sweep.toml",
        "--no-cache",
        "-o",
        "a.parquet",
        "-o",
        "a.json",
    ];
    let (_, err, code) = palpate(directory.path(), &arguments);
    assert_eq!(code, 3, "{err}");
    let script = "import json, pyarrow.parquet as p\nt = p.read_table('a.parquet')\n\
                  r = json.load(open('a.json'))\nassert t.to_pylist() == r, (t.to_pylist()[0], r[0])\n\
                  print(len(r), t.schema.field('peak_force_n').type, t.schema.field('error').type)";
    let output = Command::new(&python)
        .args(["-c", script])
        .current_dir(directory.path())
        .output()
        .unwrap();
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{err}");
    assert_eq!(
        String::from_utf8_lossy(&output.stdout).trim(),
        "12 double string"
    );
}
