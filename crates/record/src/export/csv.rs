//! A row a tick, every number as exact as it was recorded.

use super::super::reader::Session;
use super::{ExportError, Range, dt_s};
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::record::{TickRecord, ToolOutput};
use palpate_sim::tick::stage::Stage;
use std::io::Write;

/// A field: its name, and where its three or four components stop.
const POSE: [(&str, &[&str]); 4] = [
    ("position", &["x_m", "y_m", "z_m"]),
    ("orientation", &["x", "y", "z", "w"]),
    ("velocity", &["x_m_s", "y_m_s", "z_m_s"]),
    ("turning", &["x_rad_s", "y_rad_s", "z_rad_s"]),
];
const OUTPUT: [(&str, &[&str]); 6] = [
    ("force", &["x_n", "y_n", "z_n"]),
    ("torque", &["x_nm", "y_nm", "z_nm"]),
    ("contact_force", &["x_n", "y_n", "z_n"]),
    ("contact_torque", &["x_nm", "y_nm", "z_nm"]),
    ("proxy", &["x_m", "y_m", "z_m"]),
    ("proxy_orientation", &["x", "y", "z", "w"]),
];
const CONTACT: [&str; 10] = [
    "contact_u",
    "contact_v",
    "depth_m",
    "contact_x_m",
    "contact_y_m",
    "contact_z_m",
    "normal_x",
    "normal_y",
    "normal_z",
    "contact_body",
];

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
    let parts = |groups: &[(&str, &[&str])]| -> Vec<String> {
        groups
            .iter()
            .flat_map(|(name, parts)| parts.iter().map(move |part| format!("{name}_{part}")))
            .collect()
    };
    let mut columns = vec!["tick".to_owned(), "t_s".to_owned()];
    for tool in tools {
        let mut own = parts(&POSE);
        own.push("buttons".into());
        own.extend(["pose_seq", "t_client_ns", "pose_age_ticks"].map(str::to_owned));
        own.extend(parts(&OUTPUT));
        own.extend(CONTACT.map(str::to_owned));
        own.extend(
            [
                "contact_count",
                "energy_j",
                "dissipated_j",
                "flags",
                "error_n",
            ]
            .map(str::to_owned),
        );
        columns.extend(own.into_iter().map(|column| format!("{tool}.{column}")));
    }
    columns.extend(
        [
            "moving",
            "quality",
            "fault",
            "net_revision",
            "state_hash",
            "skipped",
            "late_ns",
        ]
        .map(str::to_owned),
    );
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
        use std::fmt::Write as _;
        let _ = write!(self.0, "{value:?},");
    }

    fn floats(&mut self, values: &[f64]) {
        values.iter().for_each(|value| self.float(*value));
    }

    fn empty(&mut self, count: usize) {
        (0..count).for_each(|_| self.0.push(','));
    }
}

fn write_row(line: &mut String, record: &TickRecord, tools: usize, bodies: &[String], dt_s: f64) {
    let output = &record.output;
    let mut row = CsvRow(line);
    row.text(output.tick);
    row.float(output.tick as f64 * dt_s);
    let poses = record.input.poses.first(tools);
    for (pose, tool) in poses.zip(output.tools.first(tools)) {
        write_pose(&mut row, pose.as_ref());
        write_tool(&mut row, tool, bodies);
    }
    row.text(u8::from(output.moving));
    row.text(output.quality);
    row.text(u8::from(output.fault.is_some()));
    row.text(output.net_revision);
    row.text(format_args!("{:016x}", output.state_hash));
    row.text(record.input.skipped);
    row.text(record.late_ns);
    let times = record.stage_ns.values();
    times.iter().for_each(|ns| row.text(ns));
    line.pop();
    line.push('\n');
}

fn write_pose(row: &mut CsvRow<'_>, pose: Option<&DevicePose>) {
    let Some(pose) = pose else {
        return row.empty(14);
    };
    row.floats(pose.position.coords.as_slice());
    row.floats(pose.orientation.coords.as_slice());
    row.floats(pose.linear_velocity.as_slice());
    row.floats(pose.angular_velocity.as_slice());
    row.text(pose.buttons);
}

fn write_tool(row: &mut CsvRow<'_>, tool: &ToolOutput, bodies: &[String]) {
    row.text(tool.pose_seq);
    row.text(tool.t_client_ns);
    row.text(tool.pose_age_ticks);
    row.floats(tool.force_n.as_slice());
    row.floats(tool.torque_nm.as_slice());
    row.floats(tool.contact_force_n.as_slice());
    row.floats(tool.contact_torque_nm.as_slice());
    row.floats(tool.proxy_position.coords.as_slice());
    row.floats(tool.proxy_orientation.coords.as_slice());
    match &tool.contact {
        None => row.empty(CONTACT.len()),
        Some(contact) => {
            row.floats(&[contact.u, contact.v, contact.depth_m]);
            row.floats(contact.point.coords.as_slice());
            row.floats(contact.normal.as_slice());
            match bodies.get(contact.body as usize) {
                Some(id) => row.text(id),
                None => row.text(contact.body),
            }
        }
    }
    row.text(tool.contact_count);
    row.floats(&[tool.energy_j, tool.dissipated_j]);
    row.text(tool.flags);
    match tool.error_n.is_nan() {
        // An older file.
        true => row.empty(1),
        false => row.float(tool.error_n),
    }
}
