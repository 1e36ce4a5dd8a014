//! One value of a scene by its path, such as `body/drop/material/young_pa`.

use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use toml::Value;

/// Replaces or adds a value. The last key may be new (a default that the file does not write);
/// tables on the way are made, entries of lists must be there.
pub fn set_value(document: &mut Value, path: &str, value: Value) -> PyResult<()> {
    let mut parts = path.split('/').filter(|part| !part.is_empty()).peekable();
    if parts.peek().is_none() {
        return Err(PyKeyError::new_err(
            "a path is needed, for example body/drop/material/young_pa",
        ));
    }
    let mut at = document;
    let mut walked = String::new();
    while let Some(part) = parts.next() {
        let last = parts.peek().is_none();
        let place = match at {
            Value::Table(table) => {
                if last {
                    table.insert(part.to_owned(), same_kind(table.get(part), value));
                    return Ok(());
                }
                table
                    .entry(part)
                    .or_insert_with(|| Value::Table(toml::Table::new()))
            }
            Value::Array(list) => {
                let index = entry(list, part).ok_or_else(|| {
                    let ids: Vec<String> = list
                        .iter()
                        .enumerate()
                        .map(|(k, entry)| name_of(entry, k))
                        .collect();
                    PyKeyError::new_err(format!(
                        "{path}: {walked} has no entry {part:?}; it has {}",
                        ids.join(", ")
                    ))
                })?;
                if last {
                    list[index] = value;
                    return Ok(());
                }
                &mut list[index]
            }
            other => {
                let kind = other.type_str();
                return Err(PyKeyError::new_err(format!(
                    "{path}: {walked} is a {kind} and has no {part:?} inside"
                )));
            }
        };
        walked = if walked.is_empty() {
            part.to_owned()
        } else {
            format!("{walked}/{part}")
        };
        at = place;
    }
    Ok(())
}

/// A whole number where the scene has one with a point: 20000 for 20000.0.
fn same_kind(old: Option<&Value>, new: Value) -> Value {
    match (old, &new) {
        (Some(Value::Float(_)), Value::Integer(whole)) => Value::Float(*whole as f64),
        (Some(Value::Integer(_)), Value::Float(x)) if x.fract() == 0.0 && x.abs() < 9e15 => {
            Value::Integer(*x as i64)
        }
        _ => new,
    }
}

fn entry(list: &[Value], name: &str) -> Option<usize> {
    let by_id = list
        .iter()
        .position(|entry| entry.get("id").and_then(Value::as_str) == Some(name));
    by_id.or_else(|| {
        name.parse()
            .ok()
            .filter(|index: &usize| *index < list.len())
    })
}

fn name_of(entry: &Value, index: usize) -> String {
    entry
        .get("id")
        .and_then(Value::as_str)
        .map_or_else(|| index.to_string(), |id| format!("{id:?}"))
}
