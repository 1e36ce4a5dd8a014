//! `palpate info`: a recording at a glance.

use super::Outcome;
use palpate_proto::text::printable;
use palpate_record::{Session, computed_info, info};
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Recording file.
    file: PathBuf,
    /// Read every chunk: figures are computed, and damage is found. Without it they are those that
    /// the recorder summed up, where it could finish the file.
    #[arg(long)]
    check: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let session = Session::open_any(&args.file)?;
    let info = if args.check {
        computed_info(&session)?
    } else {
        info(&session)?
    };
    if args.json {
        println!("{}", serde_json::to_string(&info)?);
    } else {
        print!("{}", printable(&info.to_string()));
    }
    Ok(Outcome::Ok)
}
