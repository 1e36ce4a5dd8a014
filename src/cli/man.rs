//! `palpate man`: manual pages.

use super::Outcome;
use anyhow::Context as _;
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Directory for the pages, for example ~/.local/share/man/man1; created if missing.
    directory: PathBuf,
}

pub fn run(args: &Args, command: clap::Command) -> anyhow::Result<Outcome> {
    let directory = &args.directory;
    std::fs::create_dir_all(directory).with_context(|| directory.display().to_string())?;
    clap_mangen::generate_to(command, directory)
        .with_context(|| directory.display().to_string())?;
    println!("{}", directory.join("palpate.1").display());
    Ok(Outcome::Ok)
}
