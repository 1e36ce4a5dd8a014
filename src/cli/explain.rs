//! `palpate explain`: why the forces of a recorded tick are what they are.

use super::Outcome;
use palpate_proto::messages::force_flags;
use palpate_record::{Session, explain};
use palpate_sim::body::FallBack;
use palpate_sim::tick::explain::{
    BodyExplained, Explanation, RowExplained, SolveExplained, ToolExplained,
};
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// Recording file.
    file: PathBuf,
    /// The tick.
    #[arg(long, value_name = "TICK")]
    tick: u64,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub fn run(args: &Args) -> anyhow::Result<Outcome> {
    let session = Session::open_any(&args.file)?.with_outputs()?;
    let explanation = explain(&session, args.tick)?;
    match args.json {
        true => println!("{}", serde_json::to_string(&explanation)?),
        false => print!("{}", words(&explanation)),
    }
    Ok(Outcome::Ok)
}

/// An explanation for people.
pub fn words(explanation: &Explanation) -> String {
    let Explanation {
        tick,
        quality,
        tools,
        rows,
        solve,
        bodies,
    } = explanation;
    let mut out = format!("tick {tick}");
    if *quality > 0 {
        let _ = write!(out, ", quality lowered to level {quality}");
    }
    out.push('\n');
    tools.iter().for_each(|tool| tell_tool(&mut out, tool));
    rows.iter().for_each(|row| tell_row(&mut out, row));
    match rows.is_empty() {
        true => out.push_str("nothing touches\n"),
        false => tell_solve(&mut out, solve),
    }
    bodies.iter().for_each(|body| tell_body(&mut out, body));
    out
}

fn norm(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn tell_tool(out: &mut String, tool: &ToolExplained) {
    let ToolExplained {
        tool: id,
        force_n,
        contact_force_n,
        borne,
        error_n,
        flags: bits,
    } = tool;
    let _ = write!(out, "tool {id}: force {:.6} N", norm(force_n));
    if *error_n > 0.0 {
        let _ = write!(out, ", off by about {error_n:.1e} N");
    }
    if force_n != contact_force_n {
        let _ = write!(
            out,
            ", of its contacts {:.6} N, of which the device gets {:.1} %",
            norm(contact_force_n),
            borne * 1e2
        );
    }
    for (bit, name) in force_flags::NAMES {
        if bits & bit != 0 {
            let _ = write!(out, "; {}", name.to_lowercase());
        }
    }
    out.push('\n');
}

fn tell_solve(out: &mut String, solve: &SolveExplained) {
    let SolveExplained { direct_steps, left } = solve;
    out.push_str("solve: ");
    if *direct_steps > 0 {
        let _ = write!(out, "{direct_steps} direct steps after the sweeps; ");
    }
    let _ = writeln!(out, "{left:.1e} of the largest force left");
}

fn tell_row(out: &mut String, row: &RowExplained) {
    let [x, y, z] = row.point_m;
    let kind = if row.grip { " (grip)" } else { "" };
    let _ = writeln!(
        out,
        "row {} on {}{kind} at {x:.6} {y:.6} {z:.6} m: gap {:.6} mm, after free motion {:.6} mm",
        row.holder,
        row.body,
        row.gap_m * 1e3,
        row.gap_free_m * 1e3
    );
    let parties = row.compliance_m_per_n.by_party.iter();
    let parties: Vec<String> = parties
        .map(|(party, m_per_n)| format!("{party} {:.6}", m_per_n * 1e3))
        .collect();
    let _ = writeln!(
        out,
        "    gives way {:.6} mm/N ({}): {:.6} N along its normal, {:.6} N across, {:.1e} mm left",
        row.compliance_m_per_n.sum * 1e3,
        parties.join(", "),
        row.force_n,
        norm(&row.tangent_n),
        row.residual_m * 1e3
    );
}

fn tell_body(out: &mut String, body: &BodyExplained) {
    let BodyExplained {
        body: id,
        residual_n,
        contact_n,
        matrix,
        fall_back,
        energy,
    } = body;
    let _ = write!(out, "body {id}: ");
    match residual_n {
        Some(residual_n) => {
            let _ = write!(
                out,
                "{residual_n:.3e} N left of its equation, beside contact forces of {contact_n:.3e} N"
            );
        }
        None => out
            .push_str("no residual: no step ended in this tick, or its method solves no equation"),
    }
    if let Some(matrix) = matrix {
        let _ = write!(out, "; matrix: {matrix}");
    }
    match fall_back {
        Some(FallBack::Shortened) => out.push_str("; the step was shortened"),
        Some(FallBack::Halved) => out.push_str("; half of a correction was taken back"),
        _ => (),
    }
    out.push('\n');
    if let Some(energy) = energy {
        let _ = writeln!(
            out,
            "    work {:.3e} J: kinetic {:+.3e}, elastic {:+.3e}; lost to the step {:.3e}, damping {:.3e}, pressures {:.3e}, \
             flow {:.3e}, residual {:.3e}",
            energy.contact_j + energy.field_j,
            energy.kinetic_j,
            energy.elastic_j,
            energy.step_j,
            energy.damping_j,
            energy.pressure_j,
            energy.flow_j,
            energy.residual_j
        );
    }
}
