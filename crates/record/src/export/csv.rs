//! A row a tick, every number as exact as it was recorded.

use super::super::reader::Session;
use super::{ExportError, Range, dt_s};
use palpate_sim::tick::quantity::{OF_LOOP, QUANTITIES, Quantity, Read, ToolTick};
use palpate_sim::tick::record::TickRecord;
use palpate_sim::tick::stage::Stage;
use std::io::Write;

/// Writes a table with a heading: tick and time, then for each tool `ID.column`, then the loop.
/// What there is not (a pose in a tick without news, a contact) is empty. Numbers read back as the
/// same bits; quaternions are x y z w.
///
/// # Errors
/// No tick in the range, or `out` refuses.
pub fn csv(session: &Session, range: &Range, out: &mut impl Write) -> Result<(), ExportError> {
    let (tools, bodies, dt_s) = (
        session.header.names("tools"),
        session.header.names("bodies"),
        dt_s(session),
    );
    let mut records = range.of(session).peekable();
    if records.peek().is_none() {
        return Err(range.no_ticks(session));
    }
    let mut row = heading(&tools);
    out.write_all(row.as_bytes())?;
    for record in records {
        row.clear();
        write_row(&mut row, &*record?, tools.len(), &bodies, dt_s);
        out.write_all(row.as_bytes())?;
    }
    out.flush()?;
    Ok(())
}

fn heading(tools: &[String]) -> String {
    let mut columns = vec!["tick".to_owned(), "t_s".to_owned()];
    for tool in tools {
        let own = QUANTITIES.iter().flat_map(|quantity| quantity.columns);
        columns.extend(own.map(|column| format!("{tool}.{column}")));
    }
    let of_loop = OF_LOOP.iter().filter_map(|quantity| quantity.column);
    columns.extend(of_loop.map(str::to_owned));
    columns.extend(Stage::ALL.map(|stage| format!("{}_ns", stage.name())));
    columns.join(",") + "\n"
}

/// Adds fields to a row, each followed by a comma.
struct CsvRow<'a>(&'a mut String);

impl CsvRow<'_> {
    fn text(&mut self, value: impl std::fmt::Display) {
        use std::fmt::Write as _;
        let _ = write!(self.0, "{value},");
    }

    /// The shortest text that reads back as the same bits.
    fn float(&mut self, value: f64) {
        self.text(format_args!("{value:?}"));
    }

    fn quantity(&mut self, quantity: &Quantity, of: &ToolTick<'_>, bodies: &[String]) {
        let output = of.output;
        let written = match quantity.read {
            Read::Whole(read) => return self.text(read(output)),
            Read::WholeOfPose(read) => of.pose.map(|pose| self.text(read(pose))),
            Read::Body(read) => read(output).map(|body| match bodies.get(body as usize) {
                Some(id) => self.text(id),
                None => self.text(body),
            }),
            Read::Numbers(_) | Read::OfPose(_) => quantity.components(of).map(|numbers| {
                let numbers = &numbers[..quantity.width()];
                numbers.iter().for_each(|number| self.float(*number));
            }),
        };
        if written.is_none() {
            quantity.columns.iter().for_each(|_| self.0.push(','));
        }
    }
}

fn write_row(line: &mut String, record: &TickRecord, tools: usize, bodies: &[String], dt_s: f64) {
    let output = &record.output;
    let mut row = CsvRow(line);
    row.text(output.tick);
    row.float(output.tick as f64 * dt_s);
    for tool in 0..tools {
        let of = ToolTick::of(record, tool);
        for quantity in QUANTITIES {
            row.quantity(quantity, &of, bodies);
        }
    }
    for quantity in OF_LOOP {
        match quantity.column {
            None => {}
            Some("state_hash") => row.text(format_args!("{:016x}", (quantity.read)(record))),
            Some(_) => row.text((quantity.read)(record)),
        }
    }
    let times = record.stage_ns.values();
    times.iter().for_each(|ns| row.text(ns));
    line.pop();
    line.push('\n');
}
