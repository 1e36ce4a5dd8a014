//! Writes IGES files: their sections, and one surface. Same surface, same bytes.

use crate::exchange::number::real;
use crate::exchange::spline::{SplineError, Written};
use crate::math::Point3;
use crate::surface::Surface;
use crate::surface::file::Unit;
use std::fmt::Write as _;

/// The file of a surface, as entity 128. In metres, reading it gives the same numbers bit for bit.
///
/// Which side is out has no place in the file: a closed surface is turned outwards when it is read,
/// an open one with `flip_normal` is written with u and v exchanged.
///
/// # Errors
/// A surface that comes apart at a knot.
pub fn write(surface: &Surface, unit: Unit) -> Result<String, SplineError> {
    let written = Written::new(surface)?;
    let mut entities = Entities::default();
    let scale = unit.per_metre();
    entities.add(128, FREE, "SURFACE", &parameters(&written, scale));
    let head = Head {
        name: "surface",
        unit: match unit {
            Unit::Metre => (6, "M"),
            Unit::Millimetre => (2, "MM"),
        },
        resolution: 1e-9 * scale,
        largest: largest(&written.points) * scale,
    };
    Ok(entities.file("B-spline surface", &head))
}

/// Status of an entity of its own, and of one that only another one uses: in space, and in parameters.
pub(super) const FREE: &str = "00000000";
pub(super) const PART_OF: &str = "00010000";
pub(super) const IN_PARAMETERS: &str = "00010500";

/// What the global section says of a file.
pub(super) struct Head<'a> {
    pub name: &'a str,
    /// Flag and name.
    pub unit: (u8, &'a str),
    /// Least distance that matters and largest coordinate, in the file's unit.
    pub resolution: f64,
    pub largest: f64,
}

/// The greatest coordinate.
pub(super) fn largest(points: &[Point3]) -> f64 {
    points.iter().fold(0.0, |most, p| most.max(p.coords.amax()))
}

/// Entities as they come: two lines of the directory each.
#[derive(Default)]
pub(super) struct Entities {
    directory: String,
    parameters: String,
    /// Lines of parameters.
    count: usize,
    entities: u64,
}

impl Entities {
    /// Returns the number by which others refer to it.
    pub fn add(&mut self, kind: u32, status: &str, label: &str, parameters: &[String]) -> u64 {
        let id = 2 * self.entities + 1;
        self.entities += 1;
        let lines = lines(parameters, 64);
        // Entity, its first parameter line, five defaults (structure, font, level, view, matrix), label
        // display, status.
        let _ = writeln!(
            self.directory,
            "{kind:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{status}D{id:>7}",
            self.count + 1,
            0,
            0,
            0,
            0,
            0,
            0,
        );
        // Entity, weight, colour, lines of parameters, form, reserved twice, label, subscript.
        let _ = writeln!(
            self.directory,
            "{kind:>8}{:>8}{:>8}{:>8}{:>8}{label:>24}{:>8}D{:>7}",
            0,
            0,
            lines.len(),
            0,
            0,
            id + 1,
        );
        for line in &lines {
            self.count += 1;
            let _ = writeln!(self.parameters, "{line:<64}{id:>8}P{:>7}", self.count);
        }
        id
    }

    /// The whole file.
    pub fn file(self, start: &str, head: &Head<'_>) -> String {
        let mut out = String::new();
        let _ = writeln!(out, "{start:<72}S{:>7}", 1);
        let global = lines(&global(head), 72);
        for (k, line) in global.iter().enumerate() {
            let _ = writeln!(out, "{line:<72}G{:>7}", k + 1);
        }
        out += &self.directory;
        out += &self.parameters;
        let _ = writeln!(
            out,
            "S{:>7}G{:>7}D{:>7}P{:>7}{:>40}T{:>7}",
            1,
            global.len(),
            2 * self.entities,
            self.count,
            "",
            1
        );
        out
    }
}

/// Free-format parameters as lines of a width: a parameter is never broken.
fn lines(parameters: &[String], width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for (k, parameter) in parameters.iter().enumerate() {
        let delimiter = if k + 1 < parameters.len() { ',' } else { ';' };
        if lines[lines.len() - 1].len() + parameter.len() + 1 > width {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            line.push_str(parameter);
            line.push(delimiter);
        }
    }
    lines
}

fn hollerith(text: &str) -> String {
    format!("{}H{text}", text.len())
}

fn global(head: &Head<'_>) -> Vec<String> {
    let (flag, name) = head.unit;
    let program = format!("palpate {}", env!("CARGO_PKG_VERSION"));
    // A time would make two files of one surface differ.
    let date = "19700101.000000";
    vec![
        hollerith(","),
        hollerith(";"),
        hollerith(head.name),
        hollerith(&format!("{}.igs", head.name)),
        hollerith(&program),
        hollerith(&program),
        // Bits of an integer; powers of ten and digits of a single and of a double.
        "32".to_owned(),
        "38".to_owned(),
        "6".to_owned(),
        "308".to_owned(),
        "15".to_owned(),
        hollerith(head.name),
        "1.0".to_owned(),
        flag.to_string(),
        hollerith(name),
        "1".to_owned(),
        "0.0".to_owned(),
        hollerith(date),
        real(head.resolution, 'D'),
        real(head.largest, 'D'),
        String::new(),
        String::new(),
        // Version 5.3, no drafting standard.
        "11".to_owned(),
        "0".to_owned(),
        hollerith(date),
    ]
}

/// Of entity 128, with so many units to a metre.
pub(super) fn parameters(written: &Written, scale: f64) -> Vec<String> {
    let (rows, columns) = (written.rows, written.columns);
    let flag = |flag: bool| u8::from(flag).to_string();
    let mut out: Vec<String> = vec![
        "128".to_owned(),
        (rows - 1).to_string(),
        (columns - 1).to_string(),
        written.degrees[0].to_string(),
        written.degrees[1].to_string(),
        flag(written.closed[0]),
        flag(written.closed[1]),
        flag(written.weights.is_none()),
        flag(written.periodic[0]),
        flag(written.periodic[1]),
    ];
    out.extend(written.knots.iter().flatten().map(|&knot| real(knot, 'D')));
    // The file runs through u first.
    let order = || (0..columns).flat_map(|j| (0..rows).map(move |i| i * columns + j));
    out.extend(order().map(|k| real(written.weights.as_ref().map_or(1.0, |w| w[k]), 'D')));
    out.extend(
        order().flat_map(|k| written.points[k].coords.data.0[0].map(|x| real(x * scale, 'D'))),
    );
    out.extend(
        written
            .domains
            .iter()
            .flat_map(|domain| [real(domain.0, 'D'), real(domain.1, 'D')]),
    );
    out
}
