//! `palpate man`: manual pages, and the reference of all commands.

mod reference;

use super::Outcome;
use anyhow::Context as _;
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Directory for the pages, for example ~/.local/share/man/man1; created if missing.
    #[arg(required_unless_present = "markdown")]
    directory: Option<PathBuf>,
    /// Print the reference of all commands as Markdown instead: what docs/commands.md holds.
    #[arg(long, conflicts_with = "directory")]
    markdown: bool,
}

pub fn run(args: &Args, command: clap::Command) -> anyhow::Result<Outcome> {
    let Some(directory) = &args.directory else {
        print!("{}", reference::markdown(command));
        return Ok(Outcome::Ok);
    };
    std::fs::create_dir_all(directory).with_context(|| directory.display().to_string())?;
    clap_mangen::generate_to(command, directory)
        .with_context(|| directory.display().to_string())?;
    println!("{}", directory.join("palpate.1").display());
    Ok(Outcome::Ok)
}
