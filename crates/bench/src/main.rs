//! The `palpate-bench` program: times and errors of our methods and of other libraries, measured in
//! the same run.

use anyhow::Context;
use clap::Parser;
use palpate_bench::{
    BarOptions, Cases, DocumentOptions, Effort, FaultOptions, Figure, HardRow, LEFT_OUT,
    RecorderOptions, RelayOptions, Row, SoakOptions, SubscriberOptions, TrustRow, bars, census,
    contact, deformation, documents, faults, figures_table, haptics, hard_cases, hard_table,
    latency_picture, modeling, pareto, parts, parts_picture, picture, plasticine_picture,
    plasticine_table, record_until_killed, recording, relay, scaling, soak, subscribers, surface,
    table, trust, trust_picture, trust_table, viewer, whole_loop,
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
    /// How far forces are from those of the exact step, beside the `error_n` of their ticks.
    Trust {
        #[command(flatten)]
        options: Options,
        /// Write a plot of true errors against estimates to this SVG file.
        #[arg(long)]
        svg: Option<std::path::PathBuf>,
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
    /// What the project promises as errors and ratios, a line each, met or missed.
    ///
    /// Exit codes: 0 all are met, 1 one is missed, 3 one could not be measured.
    Bars(BarOptions),
    /// Tables of the documents that are written by this program: which are stale, or write them anew.
    ///
    /// Exit codes: 0 none is stale, 1 one is, 3 one could not be measured.
    Documents(DocumentOptions),
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
    /// From pose to force over Zenoh, beside steps of other engines, of one pressed box.
    Loop {
        #[command(flatten)]
        options: Options,
        /// Write a plot of the time from pose to force against the force's error to this SVG file.
        #[arg(long)]
        svg: Option<std::path::PathBuf>,
    },
    /// What a tick costs over tools, bodies, contacts, nodes, nets and faces, with fitted exponents.
    Scaling(Options),
    /// Closest points of parts from STEP files, their areas and volumes, against references; and a ball slid over
    /// them in the loop.
    ///
    /// OpenCASCADE runs too when PALPATE_PYTHON names a Python that can import OCP.
    Parts {
        #[command(flatten)]
        options: Options,
        /// Instead: a line for each STEP file of this folder, with its faces, what was left out, its gap and the time.
        #[arg(long)]
        census: Option<std::path::PathBuf>,
        /// Write a plot of forces over a fillet, a sharp edge and a thread to this SVG file.
        #[arg(long)]
        svg: Option<std::path::PathBuf>,
    },
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

impl Options {
    fn effort(&self) -> Effort {
        match self.quick {
            true => Effort::Quick,
            false => Effort::Full,
        }
    }

    fn cases(&self) -> Cases<'_> {
        self.only.as_deref().into()
    }

    /// Runs a suite, which hands out what it measures: prints that as JSON, or its name as it comes. All of
    /// it, and what else the suite made.
    fn run<R: serde::Serialize, T>(
        &self,
        name: fn(&R) -> String,
        suite: impl FnOnce(&mut dyn FnMut(R)) -> T,
    ) -> anyhow::Result<(Vec<R>, T)> {
        let (mut rows, mut written) = (Vec::new(), Ok(()));
        let made = suite(&mut |row| {
            if self.json {
                let line = serde_json::to_string(&row).map_err(anyhow::Error::from);
                let line = line.and_then(|line| Ok(writeln!(std::io::stdout(), "{line}")?));
                written = std::mem::replace(&mut written, Ok(())).and(line);
            } else {
                eprintln!("{}", name(&row));
            }
            rows.push(row);
        });
        written.map(|()| (rows, made))
    }

    /// A suite of rows, printed as a table.
    fn rows<T>(
        &self,
        suite: fn(Effort, Cases<'_>, &mut dyn FnMut(Row)) -> T,
    ) -> anyhow::Result<(Vec<Row>, T)> {
        let name = |row: &Row| format!("{} {}", row.case, row.method);
        let (rows, made) = self.run(name, |out| suite(self.effort(), self.cases(), out))?;
        if !self.json {
            print!("{}", table(&rows));
        }
        Ok((rows, made))
    }

    /// A suite of figures, printed as a table.
    fn figures<T>(
        &self,
        suite: fn(Effort, Cases<'_>, &mut dyn FnMut(Figure)) -> T,
    ) -> anyhow::Result<T> {
        let name = |figure: &Figure| format!("{} {}", figure.case, figure.method);
        let (figures, made) = self.run(name, |out| suite(self.effort(), self.cases(), out))?;
        if !self.json {
            print!("{}", figures_table(&figures));
        }
        Ok(made)
    }
}

fn main() -> ExitCode {
    // Daemons and devices of the suites are this program as well, so that they are of the same build.
    let mut arguments = std::env::args_os().skip(1).peekable();
    if arguments.next_if(|first| first == "palpate").is_some() {
        return palpate::cli::main_with(arguments);
    }
    palpate::cli::end_when_nobody_reads();
    match run(&Cli::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(3)
        }
    }
}

fn run(args: &Cli) -> anyhow::Result<ExitCode> {
    match &args.suite {
        Suite::Surface(options) => {
            options.rows(surface)?;
            say_what_is_left_out();
        }
        Suite::Modeling(options) => drop(options.rows(modeling)?),
        Suite::Scaling(options) => drop(options.rows(scaling)?),
        Suite::Loop { options, svg } => {
            let (rows, ()) = options.rows(whole_loop)?;
            say_what_is_left_out();
            write(svg, || latency_picture(&rows))?;
        }
        Suite::Parts {
            census: Some(folder),
            ..
        } => print!("{}", census(folder)?),
        Suite::Parts { options, svg, .. } => {
            options.rows(parts)?;
            write(svg, parts_picture)?;
        }
        Suite::Contact { options, svg } => {
            let (rows, ()) = options.rows(contact)?;
            write(svg, || picture(&rows))?;
        }
        Suite::Deformation {
            options,
            svg,
            plasticine_svg,
        } => {
            let (rows, sweeps) = options.rows(deformation)?;
            // They take a minute: when there is time, or when they are asked for.
            let hard = if options.quick && options.only.is_none() {
                Vec::new()
            } else {
                let name = |row: &HardRow| row.case.clone();
                options.run(name, |out| hard_cases(options.cases(), out))?.0
            };
            if !options.json {
                print!("{}{}", plasticine_table(&sweeps), hard_table(&hard));
            }
            say_what_is_left_out();
            write(svg, || pareto(&rows))?;
            write(plasticine_svg, || plasticine_picture(&sweeps))?;
        }
        Suite::Trust { options, svg } => {
            let name = |row: &TrustRow| format!("{} {} it", row.case, row.iterations);
            let measure =
                |out: &mut dyn FnMut(TrustRow)| trust(options.effort(), options.cases(), out);
            let (rows, measured) = options.run(name, measure)?;
            measured.map_err(anyhow::Error::msg)?;
            if !options.json {
                print!("{}", trust_table(&rows));
            }
            write(svg, || trust_picture(&rows))?;
        }
        Suite::Haptics {
            options,
            svg,
            energy_svg,
        } => {
            let drawn =
                options.figures(|effort, cases, out| haptics::haptics(effort, cases, out))?;
            write(svg, || haptics::zwidth_picture(&drawn.widths))?;
            write(energy_svg, || haptics::energy_picture(&drawn.traces))?;
            all_measured(&drawn.failed)?;
        }
        Suite::Recording(options) => all_measured(&options.figures(recording)?)?,
        Suite::Viewer(options) => all_measured(&options.figures(viewer)?)?,
        Suite::Bars(options) => {
            if !bars(options)? {
                return Ok(ExitCode::from(1));
            }
        }
        Suite::Documents(options) => {
            if !documents(options)? {
                return Ok(ExitCode::from(1));
            }
        }
        Suite::Faults(options) => faults(options)?,
        Suite::Soak(options) => soak(options)?,
        Suite::Relay(options) => relay(options)?,
        Suite::Subscribers(options) => subscribers(options)?,
        Suite::Recorder(options) => record_until_killed(options)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Peers that are not compared with, because this build has none of them.
fn say_what_is_left_out() {
    if let Some(left_out) = LEFT_OUT {
        eprintln!("{left_out}");
    }
}

fn write(path: &Option<std::path::PathBuf>, drawn: impl FnOnce() -> String) -> anyhow::Result<()> {
    let Some(path) = path else { return Ok(()) };
    std::fs::write(path, drawn()).with_context(|| format!("cannot write {}", path.display()))
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
