//! `palpate schema`: what a scene file may say, for editors and for people.

mod reference;

use super::Outcome;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Print the reference of all keys as Markdown instead: what docs/scene.md holds.
    #[arg(long)]
    markdown: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let schema = palpate_sim::scene::schema();
    if args.markdown {
        print!("{}", reference::markdown(&schema));
    } else {
        println!("{}", serde_json::to_string_pretty(&schema)?);
    }
    Ok(Outcome::Ok)
}
