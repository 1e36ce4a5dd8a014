//! `palpate recover`: what a killed daemon left, as a finished file.

use super::Outcome;
use palpate_record::recover;
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Recording that was cut short, usually `….mcap.part`.
    file: PathBuf,
    /// New file [default: FILE without `.part`].
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let output = match &args.output {
        Some(output) => output.clone(),
        None if args
            .file
            .extension()
            .is_some_and(|extension| extension == "part") =>
        {
            args.file.with_extension("")
        }
        None => anyhow::bail!(
            "{} does not end in .part: give the output file with -o",
            args.file.display()
        ),
    };
    let recovered = recover(&args.file, &output)?;
    if args.json {
        println!("{}", serde_json::to_string(&recovered)?);
    } else {
        println!(
            "{}: {} ticks, up to tick {}",
            recovered.path.display(),
            recovered.ticks,
            recovered.last_tick
        );
        if let Some(reason) = &recovered.cut_short {
            println!("the source was cut short: {reason}");
        }
    }
    Ok(Outcome::Ok)
}
