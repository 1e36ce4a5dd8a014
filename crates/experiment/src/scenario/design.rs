//! Modeling steps of a run: patches that become one, bodies that are moved apart, pipes.

use super::error::ScenarioError;
use super::files::Source;
use super::played::{Played, RunSettings, View};
use super::scan::picture;
use super::spec::{IsolateSpec, MergeSpec, PipeSpec, RunSpec};
use super::surfaces::surface_now;
use palpate_geometry::exchange::{Format, Pick, read_surface, write_surface};
use palpate_geometry::surface::Surface;
use palpate_geometry::surface::file::{self, Unit};
use palpate_modeling::isolate::{
    IsolateMethod, IsolateSpec as Isolation, IsolateStatus, isolate, isolate_all,
};
use palpate_modeling::merge::{Arrangement, Edge, MergeSpec as Merge, merge};
use palpate_modeling::pipe::{PipeLimits, Spine};
use std::path::Path;

/// Runs the steps that a run asks for after its simulation.
pub fn after(
    run: &RunSpec,
    source: &Source,
    settings: &RunSettings,
    view: &View<'_>,
    played: &mut Played,
) -> Result<(), ScenarioError> {
    if let Some(spec) = &run.merge {
        merged(run, spec, source, settings, view, played)?;
    }
    if let Some(spec) = &run.isolate {
        isolated(run, spec, view, played)?;
    }
    if let Some(spec) = &run.pipe {
        pipe(run, spec, source, played)?;
    }
    if let (Some(map), Some(out)) = (&played.map, &settings.out) {
        let svg = picture(map, &nodules(view));
        write(
            out,
            &format!("{}-map.svg", slug(&run.name)),
            svg.as_bytes(),
            played,
        )?;
    }
    Ok(())
}

/// Middles of the balls of another material of all bodies, as seen from above, m.
fn nodules(view: &View<'_>) -> Vec<[f64; 2]> {
    let regions = (view.scene.spec.bodies.iter()).flat_map(|body| {
        let [x, y, _] = body.pose.position;
        (body.regions.iter()).filter_map(move |region| {
            let ball = region.ball.as_ref()?;
            Some([ball.centre[0] + x, ball.centre[1] + y])
        })
    });
    regions.collect()
}

fn merged(
    run: &RunSpec,
    spec: &MergeSpec,
    source: &Source,
    settings: &RunSettings,
    view: &View<'_>,
    played: &mut Played,
) -> Result<(), ScenarioError> {
    let wrong =
        |reason: &dyn std::fmt::Display| ScenarioError::run(&run.name, format!("merge: {reason}"));
    let text = source.text(&spec.surface)?;
    let first = file::read(&text).map_err(|error| wrong(&error))?;
    let body = (view.scene.body_index(&spec.body))
        .ok_or_else(|| wrong(&format!("the scene has no body {:?}", spec.body)))?;
    let second = surface_now(view.scene, view.state, body);
    let second =
        second.ok_or_else(|| wrong(&format!("{:?} is a part: it has no net", spec.body)))?;
    let patches = [first, second];
    let edge = |name: &String| match name.as_str() {
        "u0" => Ok(Edge::U0),
        "u1" => Ok(Edge::U1),
        "v0" => Ok(Edge::V0),
        "v1" => Ok(Edge::V1),
        _ => Err(wrong(&format!(
            "{name:?} is no edge; there are u0, u1, v0, v1"
        ))),
    };
    let merge_spec = Merge {
        continuity: spec.continuity,
        arrangement: Arrangement::Edges([edge(&spec.edges[0])?, edge(&spec.edges[1])?]),
        ..Merge::default()
    };
    let one = merge(&patches, &merge_spec).map_err(|error| wrong(&error))?;
    let report = one.report(&patches);
    let worst = |of: fn(&palpate_modeling::merge::Continuity) -> f64| {
        (report.seams.iter())
            .map(|(_, c)| of(c))
            .fold(0.0, f64::max)
    };
    let net = one.surface.net();
    // The file is what a CAD system gets: it is read back, and compared.
    let format = Format::of(&spec.output).map_err(|error| wrong(&error))?;
    let bytes = write_surface(&one.surface, format, Unit::Metre).map_err(|error| wrong(&error))?;
    let back = read_surface(&bytes, format, Pick::First).map_err(|error| wrong(&error))?;
    if back.count != 1 {
        return Err(wrong(&format!("the file holds {} surfaces", back.count)));
    }
    let back = &back.surface;
    let apart = (net.points().iter().zip(back.net().points()))
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, f64::max);
    let same = net.points().len() == back.net().points().len();
    for (name, value) in [
        ("patches", patches.len() as f64),
        ("rows", net.rows() as f64),
        ("columns", net.columns() as f64),
        ("greatest deviation", report.deviation.maximum_m),
        ("mean deviation", report.deviation.average_m),
        ("gap before", report.before.gap_m),
        ("gap", worst(|c| c.gap_m)),
        ("tangents before", report.before.tangent_deg),
        ("tangents", worst(|c| c.tangent_deg)),
        ("file", if same { apart } else { f64::INFINITY }),
    ] {
        played.values.insert(name.to_owned(), value);
    }
    if let Some(out) = &settings.out {
        write(out, &spec.output, &bytes, played)?;
    }
    Ok(())
}

fn isolated(
    run: &RunSpec,
    spec: &IsolateSpec,
    view: &View<'_>,
    played: &mut Played,
) -> Result<(), ScenarioError> {
    let wrong = |reason: &dyn std::fmt::Display| {
        ScenarioError::run(&run.name, format!("isolate: {reason}"))
    };
    let method = IsolateMethod::of(&spec.method)
        .ok_or_else(|| wrong(&format!("{:?} is no method", spec.method)))?;
    let spec = Isolation {
        method,
        gap_m: Some(spec.gap_m),
        ..Isolation::default()
    };
    let bodies: Vec<Surface> = (0..view.scene.body_count())
        .filter_map(|body| surface_now(view.scene, view.state, body))
        .collect();
    if bodies.len() < view.scene.body_count() {
        return Err(wrong(
            &"parts have no net to move; leave them out of the scene",
        ));
    }
    let overlapping = |bodies: &[Surface]| -> Result<usize, ScenarioError> {
        let mut count = 0;
        for a in 0..bodies.len() {
            for b in a + 1..bodies.len() {
                let answer =
                    isolate(&bodies[a], &bodies[b], &spec).map_err(|error| wrong(&error))?;
                count += usize::from(answer.status != IsolateStatus::Apart);
            }
        }
        Ok(count)
    };
    let before = overlapping(&bodies)?;
    let answer = isolate_all(&bodies, &spec).map_err(|error| wrong(&error))?;
    let mut moved = bodies.clone();
    for (body, by) in moved.iter_mut().zip(&answer.translations_m) {
        body.net_mut()
            .points_mut()
            .iter_mut()
            .for_each(|point| *point += by);
    }
    // A gap of 1 to 1.3 times what was asked for is none of overlap, but near.
    let after = overlapping(&moved)?;
    let lengths: Vec<f64> = answer.translations_m.iter().map(|by| by.norm()).collect();
    for (name, value) in [
        ("pairs before", before as f64),
        ("pairs after", after as f64),
        ("passes", answer.passes as f64),
        (
            "bodies moved",
            lengths.iter().filter(|length| **length > 0.0).count() as f64,
        ),
        ("longest move", lengths.iter().copied().fold(0.0, f64::max)),
        ("sum of moves", lengths.iter().sum()),
        ("unsettled", f64::from(u8::from(answer.unsettled.is_some()))),
    ] {
        played.values.insert(name.to_owned(), value);
    }
    Ok(())
}

fn pipe(
    run: &RunSpec,
    spec: &PipeSpec,
    source: &Source,
    played: &mut Played,
) -> Result<(), ScenarioError> {
    let wrong =
        |reason: &dyn std::fmt::Display| ScenarioError::run(&run.name, format!("pipe: {reason}"));
    let (curve, _) = palpate_modeling::pipe::file::read(&source.text(&spec.spine)?)
        .map_err(|error| wrong(&error))?;
    let spine = Spine::new(&curve).map_err(|error| wrong(&error))?;
    let limits = PipeLimits::of_spine(&spine);
    let names = ["local radius", "body to body", "end to end", "end to body"];
    for (name, (_, radius_m)) in names.into_iter().zip(limits.bounds_m()) {
        if let Some(radius_m) = radius_m {
            played.values.insert(name.to_owned(), radius_m);
        }
    }
    if let Some((radius_m, _)) = limits.r_max_m() {
        played.values.insert("safe radius".into(), radius_m);
    }
    Ok(())
}

/// A run's name as part of a file's.
fn slug(name: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '-'
        }
    };
    name.chars().map(plain).collect()
}

fn write(out: &Path, name: &str, bytes: &[u8], played: &mut Played) -> Result<(), ScenarioError> {
    let path = out.join(name);
    let made = std::fs::create_dir_all(out).and_then(|()| std::fs::write(&path, bytes));
    made.map_err(|error| ScenarioError::File {
        path: path.display().to_string(),
        reason: error.to_string(),
    })?;
    played.files.push(path);
    Ok(())
}
