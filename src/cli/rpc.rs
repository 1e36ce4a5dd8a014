//! `palpate rpc`: a command to a running daemon.

use super::Outcome;
use crate::transport::DEFAULT_ENDPOINT;
use palpate_client::{Connect, Palpate};
use palpate_proto::rpc::{METHODS, Request};

#[derive(clap::Args, Debug)]
pub struct Args {
    /// reset, pause, resume, step or shutdown.
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(METHODS))]
    method: String,
    /// `step`: ticks to run.
    #[arg(long)]
    ticks: Option<u32>,
    /// Where the daemon listens.
    #[arg(short = 'e', long, default_value = DEFAULT_ENDPOINT)]
    connect: Vec<String>,
    /// Instance name.
    #[arg(long, default_value = "default")]
    instance: String,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let settings =
        Connect { endpoints: args.connect.clone(), instance: args.instance.clone(), ..Connect::to(DEFAULT_ENDPOINT) };
    let palpate = Palpate::connect(&settings)?;
    let tick = palpate.rpc(&args.method, &Request { ticks: args.ticks })?;
    println!("{}", serde_json::json!({ "ok": true, "tick": tick }));
    palpate.close();
    Ok(Outcome::Ok)
}
