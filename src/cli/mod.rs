//! The command line: one file per subcommand. Results go to stdout, messages to stderr.
//!
//! Exit codes: 0 success, 1 a difference was found, 2 usage or configuration error, 3 a run-time
//! fault or an incomplete recording.

mod access;
mod auth;
mod batch;
mod check;
mod connection;
mod demo;
mod device;
mod doctor;
mod echo;
mod explain;
mod export;
mod help;
mod hz;
mod import;
mod info;
mod keys;
mod lobby;
mod ls;
mod man;
mod numbers;
mod page;
mod plan;
mod play;
mod probe;
mod recover;
mod relay;
mod replay;
mod rpc;
mod scenario;
mod scenes;
mod schema;
mod serve;
mod surface;
mod text;
mod view;
mod waiting;

use crate::transport::threads_for_many_clients;
use clap::{CommandFactory, FromArgMatches as _, Parser, Subcommand};
use palpate_proto::text::printable;
use palpate_record::InputsError;
use std::process::ExitCode;

/// Haptic simulation of deforming B-spline surfaces at 1 kHz, over Zenoh, with exact replay.
#[derive(Parser, Debug)]
#[command(
    version,
    about,
    long_about = None,
    arg_required_else_help = false,
    after_help = "Results go to stdout, messages to stderr. Exit codes: 0 success, 1 a difference was \
                  found, 2 usage or configuration error, 3 a run-time fault or an incomplete recording."
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Commands>,
    /// Log messages on stderr as text or as one JSON object per line; RUST_LOG selects them, for
    /// example RUST_LOG=palpate=debug.
    #[arg(long, global = true, value_enum, default_value_t = LogFormat::Text)]
    log_format: LogFormat,
}

/// How log messages are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum LogFormat {
    Text,
    Json,
}

/// Sends log messages to stderr. The default is warnings of all and messages of ours.
fn start_logs(format: LogFormat) {
    let filter = tracing_subscriber::EnvFilter::try_from_default_env()
        .unwrap_or_else(|_| tracing_subscriber::EnvFilter::new("warn,palpate=info"));
    let colour = std::env::var_os("NO_COLOR").is_none()
        && std::io::IsTerminal::is_terminal(&std::io::stderr());
    let logs = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr);
    match format {
        LogFormat::Text => logs.with_ansi(colour).without_time().init(),
        LogFormat::Json => logs.json().flatten_event(true).init(),
    }
}

/// An error with its causes, without those that it repeats.
fn said(error: &anyhow::Error) -> String {
    let mut said = String::new();
    for cause in error.chain() {
        let cause = cause.to_string();
        if said.is_empty() || cause.starts_with(&format!("{said}: ")) {
            said = cause;
        } else if !said.ends_with(&cause) {
            said = format!("{said}: {cause}");
        }
    }
    said
}

#[derive(Subcommand, Debug)]
enum Commands {
    /// Run a built-in scene: a simulated device presses a soft teardrop; record and summarise it.
    Demo(demo::Args),
    /// Run a scene: receive poses, send forces and control nets, over Zenoh.
    Serve(serve::Args),
    /// List the scenes inside the program, for `serve builtin:NAME`.
    Scenes(scenes::Args),
    /// Run a scenario: a scene with hands that do something, and bars for what comes of it.
    Scenario(scenario::Args),
    /// Run a scene many times: over its values, motions and seeds, and tabulate what comes of it.
    Batch(batch::Args),
    /// Print the JSON Schema of scene files, for editors, or the reference of their keys.
    Schema(schema::Args),
    /// Write a scene file to start from.
    New(scenes::NewArgs),
    /// Make a scene from a scan or a CAD surface: fit, write the surface and the scene, check it.
    Import(import::Args),
    /// Validate a scene: read it, build it and run some ticks, without opening sockets.
    Check(check::Args),
    /// Print what a scene builds: bodies, pairs, stages with their cost, buffers.
    Plan(plan::Args),
    /// Re-run a recording and compare every bit with what was recorded.
    Replay(replay::Args),
    /// Publish a recording as if it were live.
    Play(play::Args),
    /// Show recordings on a page: timeline, forces, deforming surfaces.
    View(view::Args),
    /// Summarise a recording.
    Info(info::Args),
    /// Export a recording: a table of ticks, plots, the control net of a body at any tick.
    Export(export::Args),
    /// Say why the forces of a recorded tick are what they are: gaps, compliances, residuals.
    Explain(explain::Args),
    /// Turn a recording that was cut short into a finished file.
    Recover(recover::Args),
    /// Run a simulated haptic device that moves a tool of a running scene.
    Device(device::Args),
    /// Compute contacts and forces of a tool at given poses, without a loop.
    Probe(probe::Args),
    /// Send a command to a running daemon: reset, pause, resume, step, record_start, snapshot,
    /// shutdown…
    Rpc(rpc::Args),
    /// Pass a daemon's messages on to many who watch, thinned, and on request read-only.
    Relay(relay::Args),
    /// Ask for a scene, get an endpoint: start a daemon for each who asks, up to the number of cores.
    Lobby(lobby::Args),
    /// Print messages on the bus as they arrive.
    Echo(echo::Args),
    /// List the instances on the bus with their tools, bodies and published keys.
    Ls(ls::Args),
    /// Measure message rate, period, bandwidth and losses per key.
    Hz(hz::Args),
    /// Work with surface files: inspect, evaluate, convert, fit, merge, isolate, sweep, branch.
    Surface(surface::Args),
    /// Make certificates that say who may move which tool, read, or command.
    #[command(subcommand)]
    Auth(auth::Args),
    /// Check this machine: scheduling, timers, ports, and the rate at which it can run a scene.
    Doctor(doctor::Args),
    /// Print shell completions.
    Completions {
        /// Shell: bash, zsh, fish, elvish or powershell.
        shell: clap_complete::Shell,
    },
    /// Write manual pages into a directory.
    Man(man::Args),
}

/// How a command ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    Ok,
    Difference,
    Fault,
}

/// Makes a closed stdout pipe end the program quietly: `palpate info FILE | head` is not an error.
pub fn end_when_nobody_reads() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        let words = panic.payload().downcast_ref::<String>();
        if words.is_some_and(|words| {
            words.starts_with("failed printing to stdout") && words.contains("Broken pipe")
        }) {
            std::process::exit(0);
        }
        usual(panic);
    }));
}

/// The command line's definition, for completions, manual pages and checks of documents.
#[doc(hidden)]
pub fn command() -> clap::Command {
    help::dressed(Cli::command())
}

/// Runs the program with the arguments of the process.
pub fn main() -> ExitCode {
    main_with(std::env::args_os().skip(1))
}

/// Runs the program with these arguments, without the program's name.
pub fn main_with(arguments: impl IntoIterator<Item = std::ffi::OsString>) -> ExitCode {
    ExitCode::from(code_with(arguments))
}

/// [`main_with`] for callers that need the exit code as a number: a Python process.
pub fn code_with(arguments: impl IntoIterator<Item = std::ffi::OsString>) -> u8 {
    end_when_nobody_reads();
    let named = std::iter::once("palpate".into()).chain(arguments);
    let matches = command().get_matches_from(named);
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    start_logs(cli.log_format);
    let Some(command) = cli.command else {
        let _ = command().print_help();
        return 0;
    };
    if matches!(
        command,
        Commands::Demo(_) | Commands::Serve(_) | Commands::Play(_) | Commands::Relay(_)
    ) {
        threads_for_many_clients();
    }
    let done = match command {
        Commands::Demo(args) => demo::run(&args),
        Commands::Serve(args) => serve::run(&args),
        Commands::Scenario(args) => scenario::run(&args),
        Commands::Batch(args) => batch::run(&args),
        Commands::Scenes(args) => scenes::list(&args),
        Commands::Schema(args) => schema::run(&args),
        Commands::New(args) => scenes::new(&args),
        Commands::Import(args) => import::run(&args),
        Commands::Check(args) => check::run(&args),
        Commands::Plan(args) => plan::run(&args),
        Commands::Replay(args) => replay::run(&args),
        Commands::Play(args) => play::run(&args),
        Commands::View(args) => view::run(&args),
        Commands::Info(args) => info::run(&args),
        Commands::Export(args) => export::run(&args),
        Commands::Explain(args) => explain::run(&args),
        Commands::Recover(args) => recover::run(&args),
        Commands::Device(args) => device::run(&args),
        Commands::Probe(args) => probe::run(&args),
        Commands::Rpc(args) => rpc::run(&args),
        Commands::Relay(args) => relay::run(&args),
        Commands::Lobby(args) => lobby::run(&args),
        Commands::Echo(args) => echo::run(&args),
        Commands::Ls(args) => ls::run(&args),
        Commands::Hz(args) => hz::run(&args),
        Commands::Man(args) => man::run(&args, self::command()),
        Commands::Auth(args) => auth::run(&args),
        Commands::Surface(args) => surface::run(&args),
        Commands::Doctor(args) => doctor::run(&args),
        Commands::Completions { shell } => {
            // Into memory first: the generator panics where a pipe is closed.
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut self::command(), "palpate", &mut script);
            print!("{}", String::from_utf8_lossy(&script));
            Ok(Outcome::Ok)
        }
    };
    match done {
        Ok(Outcome::Ok) => 0,
        Ok(Outcome::Difference) => 1,
        Ok(Outcome::Fault) => 3,
        Err(error) => {
            eprintln!("error: {}", printable(&said(&error)));
            match error.downcast_ref() {
                Some(InputsError::Differs { .. }) => 1,
                Some(InputsError::Incomplete { .. }) => 3,
                _ if error.is::<surface::Incomplete>() => 1,
                _ => 2,
            }
        }
    }
}
