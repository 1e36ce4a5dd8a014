//! `palpate info`: a recording at a glance.

use super::Outcome;
use crate::recording::{Session, file_info, info};
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Recording file.
    file: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let mut info = info(&Session::open(&args.file)?);
    info.file = file_info(&args.file, info.duration_s).ok();
    if args.json {
        println!("{}", serde_json::to_string(&info)?);
    } else {
        print!("{info}");
    }
    Ok(Outcome::Ok)
}
