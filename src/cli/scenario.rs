//! `palpate scenario`: scenes with hands and measures, run headless, with what the source says.

use super::{Outcome, text, view};
use anyhow::Context as _;
use palpate_experiment::scenario::{NAMES, Scenario, Settings};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

#[derive(clap::Args, Debug)]
#[command(
    after_help = "Exit codes: 0 every bar was kept, 1 a bar was missed, 2 the scenario cannot be run."
)]
pub struct Args {
    /// Scenario: a name (see --list), a folder with a scenario.toml, or `all`.
    #[arg(required_unless_present = "list")]
    name: Option<String>,
    /// List the scenarios inside the program.
    #[arg(long, conflicts_with_all = ["name", "record", "http", "out"])]
    list: bool,
    /// Only runs of this name; can be repeated.
    #[arg(long, value_name = "RUN")]
    run: Vec<String>,
    /// Record to this file; of several runs each to its own, with its number in the name.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Write the surfaces and pictures that runs make into this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Afterwards, show the recording on a page at this address, for example 127.0.0.1:8080.
    #[arg(long, value_name = "ADDR", requires = "record")]
    http: Option<SocketAddr>,
    /// Make every run no longer than this: a quick look, with other figures.
    #[arg(long = "for", value_parser = text::duration)]
    duration: Option<Duration>,
    /// Print one JSON object per scenario.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    if args.list {
        return list(args.json);
    }
    let name = args.name.as_deref().unwrap_or_default();
    let names = match name {
        "all" => NAMES.to_vec(),
        name => vec![name],
    };
    let settings = Settings {
        record: args.record.clone(),
        only: args.run.clone(),
        out: args.out.clone(),
        most_s: args.duration.map(|duration| duration.as_secs_f64()),
    };
    anyhow::ensure!(
        names.len() == 1 || settings.record.is_none(),
        "--record takes one scenario, not all"
    );
    let mut outcome = Outcome::Ok;
    for name in names {
        let scenario = Scenario::load(name)?;
        for run in &settings.only {
            let known: Vec<&str> = scenario.spec.runs.iter().map(|r| r.name.as_str()).collect();
            anyhow::ensure!(
                known.contains(&run.as_str()),
                "{name} has no run {run:?}; it has {known:?}"
            );
        }
        let report = scenario.run(&settings, |run| {
            eprintln!("{}: {run} …", scenario.name);
        })?;
        if args.json {
            println!("{}", serde_json::to_string(&report)?);
        } else {
            println!("{}", report.text());
        }
        if !report.passed {
            outcome = Outcome::Difference;
        }
    }
    if let (Some(address), Some(record)) = (args.http, &args.record) {
        anyhow::ensure!(
            record.is_file(),
            "{} runs were recorded; name one with --run to see it on a page",
            "several"
        );
        view::show(record, address).context("showing the recording")?;
    }
    Ok(outcome)
}

fn list(json: bool) -> anyhow::Result<Outcome> {
    for name in NAMES {
        let scenario = Scenario::load(name)?;
        let spec = &scenario.spec;
        if json {
            let runs: Vec<&str> = spec.runs.iter().map(|run| run.name.as_str()).collect();
            println!(
                "{}",
                serde_json::json!({ "name": name, "title": spec.title, "source": spec.source, "runs": runs })
            );
        } else {
            println!("{name:16} {}", spec.title);
        }
    }
    Ok(Outcome::Ok)
}
