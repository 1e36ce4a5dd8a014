//! Recordings for other programs: tables, plots, nets at any tick, and what `info` says.

use crate::common::{Laws as _, World};
use crate::session::{RIGID, Script, record, slab};
use palpate_geometry::exchange::{Format, Pick, read_surface};
use palpate_geometry::math::Point3;
use palpate_record::{
    Contents, ExportError, Range, Session, USUAL, computed_info, csv, explain, info, net_at, plots,
    series,
};
use palpate_sim::tick::quantity::{Number, QUANTITIES};
use palpate_sim::tick::stage::Stage;
use palpate_sim::tick::{apply, step};
use std::path::{Path, PathBuf};
use std::process::Command as Process;

const PROGRAM: &str = env!("CARGO_BIN_EXE_palpate");

fn palpate(arguments: &[&str]) -> (String, String, i32) {
    let output = Process::new(PROGRAM).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        text(&output.stdout),
        text(&output.stderr),
        output.status.code().unwrap_or(-1),
    )
}

#[test]
fn every_quantity_is_a_column_and_can_be_plotted() {
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = soft(directory.path(), 20, false);
    let session = Session::open(&file).unwrap();
    let mut table = Vec::new();
    csv(&session, &Range::default(), &mut table).unwrap();
    let table = String::from_utf8(table).unwrap();
    let columns: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    for column in QUANTITIES.iter().flat_map(|quantity| quantity.columns) {
        let column = format!("second.{column}");
        assert!(columns.contains(&column.as_str()), "{column}");
    }
    let names: Vec<&str> = Number::names().collect();
    let plot = plots(&session, &Range::default(), "all", &names).unwrap();
    for name in names {
        assert!(plot.contains(&format!(">{name}")), "{name}");
    }
    let path = directory.path().join("out.svg");
    let (file, path) = (file.to_str().unwrap(), path.to_str().unwrap());
    let (_, err, code) = palpate(&["export", file, "--svg", path, "--plot", "proxy_z_m,banana"]);
    assert!(code == 2 && err.contains("contact_force"), "{err}");
}

/// Two balls on a soft slab.
fn two_tools() -> String {
    let one = slab("lattice", "layers = 2, refine = \"none\"", "");
    let tool = &one[one.find("[[tool]]").unwrap()..];
    let second = tool
        .replace("id = \"ball\"", "id = \"second\"")
        .replace("[0.0, 0.0, 0.03]", "[0.0, 0.03, 0.03]");
    format!(
        "{one}{}",
        second.replace("radius_m = 0.02", "radius_m = 0.01")
    )
}

fn soft(directory: &Path, ticks: u64, commands: bool) -> (PathBuf, Script) {
    let file = directory.join("soft.mcap");
    let script = Script::new(4, ticks, commands);
    record(&file, &two_tools(), &script);
    (file, script)
}

#[test]
fn a_table_reads_back_to_the_bit() {
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = soft(directory.path(), 300, true);
    let table = directory.path().join("out.csv");
    let (_, told, code) = palpate(&[
        "export",
        file.to_str().unwrap(),
        "--csv",
        table.to_str().unwrap(),
    ]);
    assert_eq!(code, 0, "{told}");
    let text = std::fs::read_to_string(&table).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| {
        names
            .iter()
            .position(|n| *n == name)
            .unwrap_or_else(|| panic!("{name}: {names:?}"))
    };
    let session = Session::open(&file).unwrap();
    let (mut rows, mut silent, mut in_contact) = (0, 0, 0);
    for (line, record) in lines.zip(&Contents::of(&session).unwrap().ticks) {
        rows += 1;
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), names.len(), "{line}");
        let bits = |name: &str| fields[column(name)].parse::<f64>().unwrap().to_bits();
        let output = &record.output;
        assert_eq!(fields[column("tick")], output.tick.to_string());
        assert_eq!(
            fields[column("state_hash")],
            format!("{:016x}", output.state_hash)
        );
        assert_eq!(
            fields[column("deform_ns")],
            record.stage_ns[Stage::Deform].to_string()
        );
        assert_eq!(fields[column("late_ns")], record.late_ns.to_string());
        for (t, id) in ["ball", "second"].into_iter().enumerate() {
            let (tool, name) = (&output.tools[t], |what: &str| format!("{id}.{what}"));
            assert_eq!(bits(&name("force_z_n")), tool.force_n.z.to_bits());
            assert_eq!(bits(&name("torque_x_nm")), tool.torque_nm.x.to_bits());
            assert_eq!(
                bits(&name("contact_force_y_n")),
                tool.contact_force_n.y.to_bits()
            );
            assert_eq!(
                bits(&name("proxy_orientation_w")),
                tool.proxy_orientation.coords.w.to_bits()
            );
            assert_eq!(bits(&name("energy_j")), tool.energy_j.to_bits());
            match &record.input.poses[t] {
                None => {
                    silent += 1;
                    assert_eq!(fields[column(&name("position_x_m"))], "");
                    assert_eq!(fields[column(&name("buttons"))], "");
                }
                Some(pose) => {
                    assert_eq!(bits(&name("position_x_m")), pose.position.x.to_bits());
                    // Written as -0.0.
                    assert_eq!(
                        bits(&name("velocity_y_m_s")),
                        pose.linear_velocity.y.to_bits()
                    );
                    assert_eq!(fields[column(&name("buttons"))], pose.buttons.to_string());
                }
            }
            match &tool.contact {
                None => assert_eq!(fields[column(&name("depth_m"))], ""),
                Some(contact) => {
                    in_contact += 1;
                    assert_eq!(bits(&name("depth_m")), contact.depth_m.to_bits());
                    assert_eq!(bits(&name("contact_u")), contact.u.to_bits());
                    assert_eq!(fields[column(&name("contact_body"))], "slab");
                }
            }
        }
    }
    assert_eq!(rows, 300);
    assert!(
        silent > 10 && in_contact > 50,
        "{silent} without news, {in_contact} in contact"
    );
    // On stdout, of some ticks.
    let (part, _, code) = palpate(&[
        "export",
        file.to_str().unwrap(),
        "--csv",
        "-",
        "--from",
        "10",
        "--until",
        "19",
    ]);
    assert_eq!((part.lines().count(), code), (11, 0));
    assert!(
        part.lines().nth(1).unwrap().starts_with("10,0.01,"),
        "{part}"
    );
    let (_, told, code) = palpate(&[
        "export",
        file.to_str().unwrap(),
        "--csv",
        "-",
        "--from",
        "301",
    ]);
    assert!(
        code == 2 && told.contains("no tick from 301") && told.contains("1 to 300"),
        "{told}"
    );
    let mut out = Vec::new();
    assert!(matches!(
        csv(&session, &Range { from: 5, until: 4 }, &mut out),
        Err(ExportError::NoTicks { .. })
    ));
}

#[test]
fn a_plot_has_four_panels_with_units_and_every_peak() {
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = soft(directory.path(), 300, true);
    let plot = directory.path().join("out.svg");
    let (_, told, code) = palpate(&[
        "export",
        file.to_str().unwrap(),
        "--svg",
        plot.to_str().unwrap(),
    ]);
    assert_eq!(code, 0, "{told}");
    let svg = std::fs::read_to_string(&plot).unwrap();
    for label in [
        "force, N",
        "depth, mm",
        "energy, mJ",
        "tick time, µs",
        "t, s",
        "ball",
        "second",
        "soft.mcap",
    ] {
        assert!(svg.contains(label), "{label}");
    }
    assert!(
        svg.ends_with("</svg>\n") && svg.matches("<polyline").count() >= 7 && svg.len() < 1_000_000
    );
    let session = Session::open(&file).unwrap();
    let (curves, figures) = (
        series(&session, &Range::default(), &USUAL).unwrap(),
        info(&session).unwrap(),
    );
    for (t, tool) in figures.tools.iter().enumerate() {
        let most = |curve: &palpate_record::BucketedCurve| {
            curve
                .pieces
                .iter()
                .flatten()
                .map(|bucket| bucket.most)
                .fold(f64::NEG_INFINITY, f64::max)
        };
        assert_eq!(
            (
                most(&curves.panels[0].curves[t]),
                most(&curves.panels[1].curves[t])
            ),
            (tool.peak_force_n, tool.peak_depth_m)
        );
    }
    assert!(
        series(
            &session,
            &Range {
                from: 400,
                until: 500
            },
            &USUAL
        )
        .is_err()
    );
}

/// Nets of the slab after every tick, by simulating the script without a recorder.
fn simulated(script: &Script) -> Vec<Vec<Point3>> {
    let mut world = World::new(&two_tools());
    let mut net = world.scene.rest_surface(0).unwrap().net().points().to_vec();
    let mut nets = vec![net.clone()];
    for tick in 0..script.ticks {
        for command in script.commands_after(tick) {
            apply(&world.scene, &mut world.state, &mut world.scratch, command);
        }
        let input = script.input(tick + 1, &world.scene);
        step(&world.scene, &mut world.state, &mut world.scratch, &input);
        world.state.copy_net(&world.scene, 0, &mut net);
        nets.push(net.clone());
    }
    nets
}

#[test]
fn the_net_of_any_tick_is_exact() {
    let directory = tempfile::tempdir().unwrap();
    let (file, script) = soft(directory.path(), 300, true);
    let session = Session::open(&file).unwrap();
    let nets = simulated(&script);
    let moved = |tick: usize| {
        nets[tick]
            .iter()
            .zip(&nets[0])
            .map(|(a, b)| (a - b).norm())
            .fold(0.0, f64::max)
    };
    let deepest = (0..=300)
        .max_by(|a, b| moved(*a).total_cmp(&moved(*b)))
        .unwrap();
    assert!(moved(deepest) > 1e-4, "{} m", moved(deepest));
    let kept = Contents::of(&session).unwrap();
    assert!(kept.nets.iter().filter(|net| net.tick > 0).count() < 100);
    let resets = (0..300).filter(|&tick| {
        script
            .commands_after(tick)
            .any(|c| c == palpate_sim::tick::record::Command::Reset)
    });
    let around = resets.flat_map(|tick| [tick, tick + 1]);
    for tick in [0, 1, 99, 100, 101, 150, deepest as u64, 299, 300]
        .into_iter()
        .chain(around)
    {
        let surface = net_at(&session, "slab", tick).unwrap_or_else(|e| panic!("tick {tick}: {e}"));
        assert_eq!(
            surface.net().points(),
            &nets[tick as usize][..],
            "tick {tick}"
        );
    }
    // Files: exact as a surface, near as triangles.
    let tick = deepest.to_string();
    for ending in ["step", "iges", "json", "obj", "stl", "glb"] {
        let out = directory.path().join(format!("net.{ending}"));
        let (_, told, code) = palpate(&[
            "export",
            file.to_str().unwrap(),
            "--net",
            "slab",
            "--tick",
            &tick,
            out.to_str().unwrap(),
        ]);
        assert_eq!(code, 0, "{ending}: {told}");
        let bytes = std::fs::read(&out).unwrap();
        let format = Format::of(&out).unwrap();
        if matches!(format, Format::Step | Format::Iges | Format::Json) {
            let read = read_surface(&bytes, format, Pick::First).unwrap();
            assert_eq!(read.surface.net().points(), &nets[deepest][..], "{ending}");
        } else {
            assert!(bytes.len() > 1_000, "{ending}");
        }
    }
}

// The same ticks, run once more and asked: what they say is what was recorded.
#[test]
fn a_recorded_force_is_explained_and_a_tick_that_is_not_there_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = soft(directory.path(), 300, false);
    let kept = Contents::open(&file).unwrap();
    let explained = |tick: u64| {
        let tick = tick.to_string();
        let file = file.to_str().unwrap();
        let (out, told, code) = palpate(&["explain", file, "--tick", &tick, "--json"]);
        assert_eq!(code, 0, "tick {tick}: {told}");
        serde_json::from_str::<serde_json::Value>(&out).unwrap()
    };
    let (mut touching, mut touched) = (0, String::new());
    for record in kept.ticks.iter().step_by(23).chain(kept.ticks.last()) {
        let (output, tick) = (&record.output, record.output.tick);
        let explanation = explained(tick);
        assert_eq!(explanation["tick"], tick);
        let force = &explanation["tools"][0]["force_n"];
        for (k, part) in output.tools[0].force_n.iter().enumerate() {
            assert_eq!(force[k].as_f64().unwrap(), *part, "tick {tick}");
        }
        for row in explanation["rows"].as_array().unwrap() {
            let number = |key: &str| row[key].as_f64().unwrap();
            let compliance = &row["compliance_m_per_n"];
            let parties = compliance["by_party"].as_object().unwrap().values();
            let sum: f64 = parties.map(|part| part.as_f64().unwrap()).sum();
            assert!((sum / compliance["sum"].as_f64().unwrap() - 1.0).abs() < 1e-12);
            let (residual, force) = (number("residual_m"), number("force_n"));
            // A grip pulls too, and slips at its limit.
            assert!(
                row["grip"] == true || residual.abs() < 1e-5 && force >= 0.0,
                "tick {tick}: {row}"
            );
            touching += 1;
            touched = tick.to_string();
        }
    }
    assert!(touching > 10, "{touching} rows");
    let (out, _, code) = palpate(&["explain", file.to_str().unwrap(), "--tick", &touched]);
    assert!(
        code == 0 && out.contains("left of its equation") && out.contains("tool:"),
        "{out}"
    );
    for tick in ["0", "301"] {
        let (_, told, code) = palpate(&["explain", file.to_str().unwrap(), "--tick", tick]);
        assert!(code == 2 && told.contains("no state after tick"), "{told}");
    }
    let mut other = kept.clone();
    let states = other.ticks.iter_mut();
    states.for_each(|record| record.output.state_hash ^= 1);
    let told = explain(&other.session().unwrap(), 150).unwrap_err();
    assert!(
        told.to_string()
            .contains("diverges from the recording at tick 150"),
        "{told}"
    );
}

#[test]
fn a_net_that_cannot_be_had_says_what_there_is() {
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = soft(directory.path(), 300, false);
    let whole = Contents::open(&file).unwrap();
    let told = |session: &Contents, body: &str, tick| {
        net_at(&session.session().unwrap(), body, tick)
            .unwrap_err()
            .to_string()
    };
    assert!(told(&whole, "drop", 10).contains("no body \"drop\"; the scene has slab"));
    assert!(
        told(&whole, "slab", 301).contains("no state after tick 301; the recording has 0 to 300")
    );
    let without_net = (101..200)
        .find(|tick| whole.nets.iter().all(|net| net.tick != *tick))
        .unwrap();
    let mut torn = whole.clone();
    torn.ticks.retain(|record| record.output.tick != 101);
    let text = told(&torn, "slab", without_net);
    assert!(
        text.contains("follows a gap") && text.contains("at tick 200"),
        "{text}"
    );
    // Another build: what it comes to is not what was recorded. Nets in the file are.
    let mut other = whole.clone();
    other
        .ticks
        .iter_mut()
        .for_each(|record| record.output.state_hash ^= 1);
    let text = told(&other, "slab", without_net);
    assert!(
        text.contains("diverges from the recording at tick"),
        "{text}"
    );
    let kept = whole.nets.iter().find(|net| net.tick > 101).unwrap();
    let surface = net_at(&other.session().unwrap(), "slab", kept.tick).unwrap();
    let points: Vec<f64> = surface
        .net()
        .points()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect();
    assert_eq!(points, kept.points);
    // Usage.
    let file = file.to_str().unwrap();
    assert_eq!(palpate(&["export", file]).2, 2);
    assert_eq!(palpate(&["export", file, "--net", "slab", "net.step"]).2, 2);
    let (_, text, code) = palpate(&["export", file, "--net", "slab", "--tick", "3", "net.dae"]);
    assert!(code == 2 && text.contains(".dae"), "{text}");
}

#[test]
fn info_says_what_a_file_holds() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("rigid.mcap");
    record(&file, RIGID, &Script::new(8, 3_000, true));
    let (text, _, code) = palpate(&["info", file.to_str().unwrap(), "--json"]);
    assert_eq!(code, 0);
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let session = Contents::open(&file).unwrap();
    assert_eq!(
        (
            json["ticks"].as_u64(),
            json["first_tick"].as_u64(),
            json["last_tick"].as_u64()
        ),
        (Some(3_000), Some(1), Some(3_000))
    );
    assert_eq!(
        (json["clean"].as_bool(), json["is_part"].as_bool()),
        (Some(true), Some(false))
    );
    let commands: u64 = json["commands_by_name"]
        .as_object()
        .unwrap()
        .values()
        .map(|n| n.as_u64().unwrap())
        .sum();
    assert!(commands > 3 && commands == session.commands.len() as u64);
    // Contact phases and RMS, by hand.
    let outputs = || session.ticks.iter().map(|record| &record.output.tools[0]);
    let touching: Vec<bool> = outputs().map(|tool| tool.contact.is_some()).collect();
    let phases = touching
        .windows(2)
        .filter(|pair| !pair[0] && pair[1])
        .count()
        + usize::from(touching[0]);
    let tool = &json["tools"][0];
    assert!(phases > 2);
    assert_eq!(tool["contact_phases"].as_u64(), Some(phases as u64));
    let mean = outputs()
        .map(|tool| tool.force_n.norm_squared())
        .sum::<f64>()
        / 3_000.0;
    let rms_n = tool["rms_force_n"].as_f64().unwrap();
    assert!(
        (rms_n / mean.sqrt() - 1.0).abs() < 1e-12 && rms_n > 0.01,
        "{rms_n} N"
    );
    // Channels, beside the library's own count.
    let bytes = std::fs::read(&file).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let counted = summary.stats.unwrap();
    let channels = json["file"]["channels"].as_array().unwrap();
    assert_eq!(channels.len(), summary.channels.len());
    assert_eq!(json["file"]["bytes"].as_u64(), Some(bytes.len() as u64));
    assert_eq!(
        json["file"]["chunks"].as_u64(),
        Some(u64::from(counted.chunk_count))
    );
    let of = |topic: &str| {
        channels
            .iter()
            .find(|channel| channel["topic"] == topic)
            .unwrap()
    };
    for (id, channel) in &summary.channels {
        let expected = counted.channel_message_counts.get(id).copied().unwrap_or(0);
        assert_eq!(
            of(&channel.topic)["messages"].as_u64(),
            Some(expected),
            "{}",
            channel.topic
        );
    }
    let tick = of("/sim/tick");
    let (total, rate) = (
        tick["bytes"].as_u64().unwrap(),
        tick["bytes_per_s"].as_f64().unwrap(),
    );
    assert!(
        total > 100_000 && (3.0 * rate - total as f64).abs() < 1e-6 * rate,
        "{total} bytes in three seconds, {rate} B/s"
    );
    assert_eq!(tick["schema"], "palpate.v1.Tick");
    let (text, _, _) = palpate(&["info", file.to_str().unwrap()]);
    for part in [
        "RMS",
        "/sim/tick",
        "bytes/s",
        "compression",
        "commands: ",
        "late ",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // Cut short: told, and what is there is counted.
    let cut = directory.path().join("cut.mcap");
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let (text, _, code) = palpate(&["info", cut.to_str().unwrap(), "--json"]);
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(
        code == 0 && json["cut_short"].is_string() && json["clean"] == false,
        "{text}"
    );
    let half = info(&Session::open(&cut).unwrap()).unwrap();
    let ticks = half
        .file
        .channels
        .iter()
        .find(|channel| channel.topic == "/sim/tick")
        .unwrap();
    assert_eq!(Some(ticks.messages), json["ticks"].as_u64());
    assert!(ticks.messages > 100 && ticks.messages < 3_000);
}

// What can be read of a damaged file is exported, or refused in words; nothing panics, nothing
// hangs.
#[test]
fn damaged_files_are_no_reason_to_panic() {
    let directory = tempfile::tempdir().unwrap();
    let (file, _) = soft(directory.path(), 120, true);
    let whole = std::fs::read(&file).unwrap();
    let mut random = crate::session::Random(17);
    let odd = directory.path().join("odd.mcap");
    let mut read = 0;
    for k in 0..30 {
        let mut bytes = whole.clone();
        if k % 3 == 0 {
            bytes.truncate(random.below(whole.len()));
        } else {
            for _ in 0..1 + k % 4 {
                let at = random.below(bytes.len());
                bytes[at] ^= 1 << random.below(8);
            }
        }
        std::fs::write(&odd, &bytes).unwrap();
        let Ok(session) = Session::open(&odd) else {
            continue;
        };
        read += 1;
        if let Ok(found) = computed_info(&session) {
            assert_eq!(found.file.bytes, bytes.len() as u64);
            let _ = (found.to_string(), info(&session));
        }
        let _ = csv(&session, &Range::default(), &mut Vec::new());
        let _ = series(&session, &Range::default(), &USUAL);
        let _ = net_at(&session, "slab", 100);
    }
    assert!(read > 10, "only {read} of 30 were read");
    // Numbers that no recorder writes.
    let mut odd = Contents::open(&file).unwrap();
    odd.ticks[50].output.tick = 0;
    odd.ticks[119].output.tick = u64::MAX;
    odd.ticks[60].output.tools[0].force_n.x = f64::NAN;
    odd.ticks.sort_by_key(|record| record.output.tick);
    odd.keyframes.last_mut().unwrap().tick = u64::MAX;
    let odd = odd.session().unwrap();
    assert!(
        csv(&odd, &Range::default(), &mut Vec::new()).is_ok()
            && series(&odd, &Range::default(), &USUAL).is_ok()
    );
    for tick in [0, 51, 119, u64::MAX - 1, u64::MAX] {
        let _ = net_at(&odd, "slab", tick);
    }
    let _ = palpate_record::replay(&odd, 0, |_, _| {});
    let _ = palpate_record::simulate_figures(&odd, |_, _| {});
}
