//! The `palpate-bench` program: times and errors of our methods and of other libraries, measured in
//! the same run.

use anyhow::Context;
use clap::Parser;
use palpate_bench::{
    Effort, FaultOptions, Figure, HardRow, LEFT_OUT, RecorderOptions, RelayOptions, Row, SoakOptions,
    SubscriberOptions, contact, deformation, faults, figures_table, haptics, hard_cases,
    hard_table, modeling, pareto, picture, plasticine_picture, plasticine_table,
    record_until_killed, recording, relay, soak, subscribers, surface, table, viewer,
};
use std::io::Write;
use std::process::ExitCode;

/// Time against error: Palpate next to other libraries, in the same run on the same inputs.
///
/// Wall-clock times of one run on one machine; compare ratios, not runs.
#[derive(Parser, Debug)]
#[command(name = "palpate-bench", version)]
struct Cli {
    #[command(subcommand)]
    suite: Suite,
}

#[derive(clap::Subcommand, Debug)]
enum Suite {
    /// Closest points, grids, fits and bounds of B-spline surfaces.
    Surface(Options),
    /// Forces of pressed bodies, paths of moving ones and the cost of a step, for all models,
    /// methods, grids and stiffnesses, and for other engines.
    ///
    /// `--only hard` prints the table of hard cases: ticks, largest energy beyond what was put in,
    /// forces and places with their expected values, faults, median tick. Runs them in a full run.
    ///
    /// MuJoCo and PyBullet run too when PALPATE_PYTHON names a Python that can import them.
    Deformation {
        #[command(flatten)]
        options: Options,
        /// Write plots of time against force error and motion error to this SVG file.
        #[arg(long)]
        svg: Option<std::path::PathBuf>,
        /// Write a plot of plasticine displacement over force and stiffness to this SVG file.
        #[arg(long)]
        plasticine_svg: Option<std::path::PathBuf>,
    },
    /// Stiffest stable walls of devices, energy with delay, accuracy of forces, latency and timing.
    Haptics {
        #[command(flatten)]
        options: Options,
        /// Write a plot of the stiffest walls over damping to this SVG file.
        #[arg(long)]
        svg: Option<std::path::PathBuf>,
        /// Write a plot of energy over time, with and without passivity control, to this SVG file.
        #[arg(long)]
        energy_svg: Option<std::path::PathBuf>,
    },
    /// Cost, size, losses, kills and replay speed of recordings.
    Recording(Options),
    /// What pages cost the loop and the daemon, and how soon they have something to show.
    Viewer(Options),
    /// The daemon under faults of network, disk, processes and clock, on a virtual clock, by seeds.
    Faults(FaultOptions),
    /// A relay with hundreds who watch: what they cost the daemon, and what each receives.
    Relay(RelayOptions),
    /// Some of those who watch, in a process of their own.
    #[command(hide = true)]
    Subscribers(SubscriberOptions),
    /// A recorder on a disk that is slow, until it is killed.
    #[command(hide = true)]
    Recorder(RecorderOptions),
    /// A daemon at work for long: growth of memory, descriptors and threads, late ticks.
    Soak(SoakOptions),
    /// Merge, isolate, pipe and branch: times, deviations, ratios, gaps and angles.
    Modeling(Options),
    /// Contact queries of points, balls, planes, solids, meshes and surfaces with a body.
    Contact {
        #[command(flatten)]
        options: Options,
        /// Write a plot of time against error to this SVG file.
        #[arg(long)]
        svg: Option<std::path::PathBuf>,
    },
}

#[derive(clap::Args, Debug)]
struct Options {
    /// Print one JSON object per line as soon as it is measured, instead of a table.
    #[arg(long)]
    json: bool,
    /// Run for seconds instead of minutes: fewer queries, coarser percentiles.
    #[arg(long)]
    quick: bool,
    /// Run only cases whose name contains this.
    #[arg(long)]
    only: Option<String>,
}

fn main() -> ExitCode {
    // Daemons and devices of the suites are this program as well, so that they are of the same build.
    let mut arguments = std::env::args_os().skip(1).peekable();
    if arguments.next_if(|first| first == "palpate").is_some() {
        return palpate::cli::main_with(arguments);
    }
    palpate::cli::end_when_nobody_reads();
    match run(&Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(3)
        }
    }
}

fn run(args: &Cli) -> anyhow::Result<()> {
    if let Suite::Haptics {
        options,
        svg,
        energy_svg,
    } = &args.suite
    {
        return run_haptics(options, svg.as_deref(), energy_svg.as_deref());
    }
    if let Suite::Recording(options) = &args.suite {
        return all_measured(&figures(options, recording)?);
    }
    if let Suite::Viewer(options) = &args.suite {
        return all_measured(&figures(options, viewer)?);
    }
    if let Suite::Faults(options) = &args.suite {
        return faults(options);
    }
    if let Suite::Soak(options) = &args.suite {
        return soak(options);
    }
    if let Suite::Relay(options) = &args.suite {
        return relay(options);
    }
    if let Suite::Subscribers(options) = &args.suite {
        return subscribers(options);
    }
    if let Suite::Recorder(options) = &args.suite {
        return record_until_killed(options);
    }
    let (options, svg) = match &args.suite {
        Suite::Surface(options)
        | Suite::Recording(options)
        | Suite::Viewer(options)
        | Suite::Modeling(options) => (options, None),
        Suite::Contact { options, svg }
        | Suite::Deformation { options, svg, .. }
        | Suite::Haptics { options, svg, .. } => (options, svg.as_deref()),
        Suite::Faults(_)
        | Suite::Soak(_)
        | Suite::Relay(_)
        | Suite::Subscribers(_)
        | Suite::Recorder(_) => return Ok(()),
    };
    let effort = if options.quick {
        Effort::Quick
    } else {
        Effort::Full
    };
    let mut rows: Vec<Row> = Vec::new();
    let mut failed = None;
    let mut take = |row: Row| {
        if options.json {
            let line = serde_json::to_string(&row).map_err(anyhow::Error::from);
            let written = line.and_then(|line| Ok(writeln!(std::io::stdout(), "{line}")?));
            failed = failed.take().or(written.err());
        } else {
            eprintln!("{} {}", row.case, row.method);
        }
        rows.push(row);
    };
    let only = options.only.as_deref();
    let (mut sweeps, mut hard) = (Vec::new(), Vec::new());
    match &args.suite {
        Suite::Surface(_) => surface(effort, only, &mut take),
        Suite::Contact { .. } => contact(effort, only, &mut take),
        Suite::Modeling(_) => modeling(effort, only, &mut take),
        Suite::Deformation { .. } => sweeps = deformation(effort, only, &mut take),
        Suite::Haptics { .. }
        | Suite::Recording(_)
        | Suite::Viewer(_)
        | Suite::Faults(_)
        | Suite::Soak(_)
        | Suite::Relay(_)
        | Suite::Subscribers(_)
        | Suite::Recorder(_) => {}
    }
    // They take a minute: when there is time, or when they are asked for.
    if matches!(&args.suite, Suite::Deformation { .. })
        && (effort == Effort::Full || only.is_some())
    {
        hard_cases(only, &mut |row: HardRow| {
            if options.json {
                let line = serde_json::to_string(&row).map_err(anyhow::Error::from);
                let written = line.and_then(|line| Ok(writeln!(std::io::stdout(), "{line}")?));
                failed = failed.take().or(written.err());
            } else {
                eprintln!("{}", row.case);
            }
            hard.push(row);
        });
    }
    if let Some(error) = failed {
        return Err(error);
    }
    if !options.json {
        let plasticine = plasticine_table(&sweeps);
        print!("{}{plasticine}{}", table(&rows), hard_table(&hard));
        let compared = matches!(&args.suite, Suite::Surface(_) | Suite::Deformation { .. });
        if let Some(left_out) = LEFT_OUT.filter(|_| compared) {
            eprintln!("{left_out}");
        }
    }
    if let Some(path) = svg {
        let deforming = matches!(&args.suite, Suite::Deformation { .. });
        write(
            path,
            if deforming {
                pareto(&rows)
            } else {
                picture(&rows)
            },
        )?;
    }
    if let Suite::Deformation {
        plasticine_svg: Some(path),
        ..
    } = &args.suite
    {
        write(path, plasticine_picture(&sweeps))?;
    }
    Ok(())
}

fn write(path: &std::path::Path, drawn: String) -> anyhow::Result<()> {
    std::fs::write(path, drawn).with_context(|| format!("cannot write {}", path.display()))
}

/// Runs a suite of figures and prints them; gives back what else it made.
fn figures<T>(
    options: &Options,
    suite: impl FnOnce(Effort, Option<&str>, &mut dyn FnMut(Figure)) -> T,
) -> anyhow::Result<T> {
    let effort = if options.quick {
        Effort::Quick
    } else {
        Effort::Full
    };
    let (mut figures, mut failed) = (Vec::new(), None);
    let made = suite(effort, options.only.as_deref(), &mut |figure| {
        if options.json {
            let line = serde_json::to_string(&figure).map_err(anyhow::Error::from);
            let written = line.and_then(|line| Ok(writeln!(std::io::stdout(), "{line}")?));
            failed = failed.take().or(written.err());
        } else {
            eprintln!("{} {}", figure.case, figure.method);
        }
        figures.push(figure);
    });
    if let Some(error) = failed {
        return Err(error);
    }
    if !options.json {
        print!("{}", figures_table(&figures));
    }
    Ok(made)
}

fn run_haptics(
    options: &Options,
    svg: Option<&std::path::Path>,
    energy_svg: Option<&std::path::Path>,
) -> anyhow::Result<()> {
    let drawn = figures(options, |effort, only, out| {
        haptics::haptics(effort, only, out)
    })?;
    if let Some(path) = svg {
        write(path, haptics::zwidth_picture(&drawn.widths))?;
    }
    if let Some(path) = energy_svg {
        write(path, haptics::energy_picture(&drawn.traces))?;
    }
    all_measured(&drawn.failed)
}

fn all_measured(failed: &[String]) -> anyhow::Result<()> {
    anyhow::ensure!(
        failed.is_empty(),
        "{} cases could not be measured\n{}",
        failed.len(),
        failed.join("\n")
    );
    Ok(())
}
