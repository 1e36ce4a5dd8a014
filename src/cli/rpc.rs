//! `palpate rpc`: a command to a running daemon.

use super::Outcome;
use super::connection::Connection;
use palpate_proto::rpc::{METHODS, Request};

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Method to call.
    #[arg(value_parser = clap::builder::PossibleValuesParser::new(METHODS))]
    method: String,
    /// Arguments as JSON, for example '{"before": 10, "after": 2}' for a snapshot.
    arguments: Option<String>,
    /// For `step`: number of ticks to run.
    #[arg(long)]
    ticks: Option<u32>,
    #[command(flatten)]
    connection: Connection,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let request = Request::parse(
        &args.method,
        args.arguments.as_deref().unwrap_or("").as_bytes(),
    )?;
    let request = Request {
        ticks: args.ticks.or(request.ticks),
        ..request
    };
    let palpate = args.connection.open()?;
    let reply = palpate.call(&args.method, &request)?;
    println!("{}", serde_json::to_string(&reply)?);
    palpate.close();
    Ok(Outcome::Ok)
}
