//! Writes one surface as an IGES file. Same surface, same bytes.

use crate::exchange::number::real;
use crate::exchange::spline::{SplineError, Written};
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
    let parameters = lines(&parameters(&written, unit), 64);
    let global = lines(&global(&written, unit), 72);
    let mut out = String::new();
    let _ = writeln!(out, "{:<72}S{:>7}", "B-spline surface", 1);
    for (k, line) in global.iter().enumerate() {
        let _ = writeln!(out, "{line:<72}G{:>7}", k + 1);
    }
    // Entity, its first parameter line, five defaults (structure, font, level, view, matrix), label
    // display, status.
    let _ = writeln!(
        out,
        "{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}00000000D{:>7}",
        128, 1, 0, 0, 0, 0, 0, 0, 1
    );
    // Entity, weight, colour, lines of parameters, form, reserved twice, label, subscript.
    let _ = writeln!(
        out,
        "{:>8}{:>8}{:>8}{:>8}{:>8}{:>24}{:>8}D{:>7}",
        128,
        0,
        0,
        parameters.len(),
        0,
        "SURFACE",
        0,
        2
    );
    for (k, line) in parameters.iter().enumerate() {
        let _ = writeln!(out, "{line:<64}{:>8}P{:>7}", 1, k + 1);
    }
    let _ = writeln!(
        out,
        "S{:>7}G{:>7}D{:>7}P{:>7}{:>40}T{:>7}",
        1,
        global.len(),
        2,
        parameters.len(),
        "",
        1
    );
    Ok(out)
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

fn global(written: &Written, unit: Unit) -> Vec<String> {
    let largest = written
        .points
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .fold(0.0, |a: f64, x| a.max(x.abs()));
    let largest = largest * unit.per_metre();
    let (flag, name) = match unit {
        Unit::Metre => (6, "M"),
        Unit::Millimetre => (2, "MM"),
    };
    let program = format!("palpate {}", env!("CARGO_PKG_VERSION"));
    // A time would make two files of one surface differ.
    let date = "19700101.000000";
    vec![
        hollerith(","),
        hollerith(";"),
        hollerith("surface"),
        hollerith("surface.igs"),
        hollerith(&program),
        hollerith(&program),
        // Bits of an integer; powers of ten and digits of a single and of a double.
        "32".to_owned(),
        "38".to_owned(),
        "6".to_owned(),
        "308".to_owned(),
        "15".to_owned(),
        hollerith("surface"),
        "1.0".to_owned(),
        flag.to_string(),
        hollerith(name),
        "1".to_owned(),
        "0.0".to_owned(),
        hollerith(date),
        real(1e-9 * unit.per_metre(), 'D'),
        real(largest, 'D'),
        String::new(),
        String::new(),
        // Version 5.3, no drafting standard.
        "11".to_owned(),
        "0".to_owned(),
        hollerith(date),
    ]
}

fn parameters(written: &Written, unit: Unit) -> Vec<String> {
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
    let scale = unit.per_metre();
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
