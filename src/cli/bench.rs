//! `palpate bench`: times of our methods beside other libraries', in the same run and each with its error.

use super::Outcome;
use crate::bench::{Effort, Row, surface, table};
use std::io::Write;

/// What to time.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(subcommand)]
    suite: Suite,
}

#[derive(clap::Subcommand, Debug)]
enum Suite {
    /// Closest points, grids, fits and bounds of B-spline surfaces.
    Surface {
        /// One JSON object a line, as soon as it is measured, instead of a table.
        #[arg(long)]
        json: bool,
        /// Some seconds instead of minutes: fewer queries, coarser percentiles.
        #[arg(long)]
        quick: bool,
        /// Only cases whose names contain this.
        #[arg(long)]
        only: Option<String>,
    },
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let Suite::Surface { json, quick, only } = &args.suite;
    let effort = if *quick { Effort::Quick } else { Effort::Full };
    let mut rows: Vec<Row> = Vec::new();
    let mut failed = None;
    surface(effort, only.as_deref(), &mut |row| {
        if *json {
            let line = serde_json::to_string(&row).map_err(anyhow::Error::from);
            let written = line.and_then(|line| Ok(writeln!(std::io::stdout(), "{line}")?));
            failed = failed.take().or(written.err());
        } else {
            eprintln!("{} {}", row.case, row.method);
        }
        rows.push(row);
    });
    if let Some(error) = failed {
        return Err(error);
    }
    if !json {
        print!("{}", table(&rows));
    }
    Ok(Outcome::Ok)
}
