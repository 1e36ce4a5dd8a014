//! `palpate rpc`: a command to a running daemon.

use super::Outcome;
use super::connection::Connection;
use anyhow::Context;
use palpate_proto::rpc::{Answer, Call, METHODS};
use serde_json::{Map, Value};

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
    let call = call(
        &args.method,
        args.arguments.as_deref().unwrap_or(""),
        args.ticks,
    )?;
    let palpate = args.connection.open()?;
    let done = palpate.call(call)?;
    println!("{}", serde_json::to_string(&Answer::Done(done))?);
    palpate.close();
    Ok(Outcome::Ok)
}

/// The call of a method with arguments as JSON; `ticks` goes over the one given there.
fn call(method: &str, arguments: &str, ticks: Option<u32>) -> anyhow::Result<Call> {
    // What is not an object is refused here, with the words of the daemon.
    let call = Call::parse(method, arguments.as_bytes());
    let Some(ticks) = ticks else {
        return Ok(call?);
    };
    let mut arguments: Map<String, Value> = match arguments.trim() {
        "" => Map::new(),
        text => serde_json::from_str(text).context("the arguments are a JSON object")?,
    };
    arguments.insert("ticks".into(), ticks.into());
    Ok(Call::parse(method, &serde_json::to_vec(&arguments)?)?)
}
