//! Changes of a scene by the path of a key.

use toml::{Table, Value};

/// Sets the value at a path such as `body.bowl.pose.position`. Entries of arrays of tables are named
/// by their `id` or by their number from 0; tables that are missing on the way are made.
///
/// # Errors
/// A path that leads through something else than tables.
pub fn set(scene: &mut Table, path: &str, value: &Value) -> Result<(), String> {
    let parts: Vec<&str> = path.split('.').collect();
    let Some((last, way)) = parts.split_last() else {
        return Err("a path is empty".into());
    };
    let mut table = scene;
    let mut k = 0;
    while k < way.len() {
        let key = way[k];
        let there = (table.entry(key)).or_insert_with(|| Value::Table(Table::new()));
        k += 1;
        table = match there {
            Value::Table(table) => table,
            Value::Array(list) => {
                let entry = way.get(k).copied().unwrap_or(last);
                k += 1;
                let is = |(number, value): &(usize, &mut Value)| {
                    value.get("id").and_then(Value::as_str) == Some(entry)
                        || entry.parse() == Ok(*number)
                };
                let found = list.iter_mut().enumerate().find(is);
                found
                    .and_then(|(_, value)| value.as_table_mut())
                    .ok_or_else(|| format!("{path}: {key} has no entry {entry:?}"))?
            }
            _ => return Err(format!("{path}: {key} is not a table")),
        };
    }
    table.insert((*last).to_owned(), value.clone());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_through_tables_and_named_entries() {
        let mut scene: Table = toml::from_str(
            "[[body]]\nid = \"a\"\n[[body]]\nid = \"b\"\nmaterial = { young_pa = 1.0 }\n",
        )
        .unwrap();
        for (path, value) in [
            ("body.b.material.young_pa", Value::Float(2.0)),
            ("body.0.pose.position", Value::Integer(7)),
            ("gravity.smoothing_s", Value::Float(0.5)),
            ("name", Value::String("x".into())),
        ] {
            set(&mut scene, path, &value).unwrap();
        }
        assert_eq!(scene["body"][1]["material"]["young_pa"], Value::Float(2.0));
        assert_eq!(scene["body"][0]["pose"]["position"], Value::Integer(7));
        assert_eq!(scene["gravity"]["smoothing_s"], Value::Float(0.5));
        for path in ["body.c.pose", "name.x.y", "body.2.id"] {
            assert!(set(&mut scene, path, &Value::Integer(1)).is_err(), "{path}");
        }
    }
}
