//! Makes the schema from the types of [`crate::scene::spec`] and their doc comments. Compiled for the tests only: the
//! library and the program hold the file that it makes.

use crate::scene::spec::SceneSpec;
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value};

/// Endings of keys and the units that they mean; longer ones first.
const UNITS: [(&str, &str); 15] = [
    ("_nm_s_rad", "N·m·s/rad"),
    ("_nm_rad", "N·m/rad"),
    ("_kg_m3", "kg/m³"),
    ("_per_s", "1/s"),
    ("_n_s_m", "N·s/m"),
    ("_n_m", "N/m"),
    ("_m_s", "m/s"),
    ("_rad", "rad"),
    ("_pa", "Pa"),
    ("_nm", "N·m"),
    ("_hz", "Hz"),
    ("_kg", "kg"),
    ("_n", "N"),
    ("_s", "s"),
    ("_m", "m"),
];

/// The schema of the types as they are.
pub(super) fn generated() -> Value {
    let generator = SchemaSettings::draft07().into_generator();
    let mut schema = Value::from(generator.into_root_schema_for::<SceneSpec>());
    tidy(&mut schema);
    schema["title"] = "Palpate scene".into();
    schema
}

/// TOML has no null: an absent value is a key that is not there.
fn is_null(schema: &Value) -> bool {
    schema.get("type").is_some_and(|kind| kind == "null")
}

/// Takes out nulls, sizes of machine numbers and line breaks of comments, everywhere; adds units.
fn tidy(schema: &mut Value) {
    match schema {
        Value::Array(list) => list.iter_mut().for_each(tidy),
        Value::Object(map) => tidy_object(map),
        _ => {}
    }
}

fn tidy_object(map: &mut Map<String, Value>) {
    map.remove("format");
    if map.get("default").is_some_and(Value::is_null) {
        map.remove("default");
    }
    if let Some(Value::Array(kinds)) = map.get_mut("type") {
        kinds.retain(|kind| kind != "null");
        if let [only] = kinds.as_slice() {
            let only = only.clone();
            map.insert("type".into(), only);
        }
    }
    for list in ["anyOf", "enum"] {
        if let Some(Value::Array(items)) = map.get_mut(list) {
            items.retain(|item| !is_null(item) && !item.is_null());
        }
    }
    // What was "this or null" is this.
    let only = match map.get("anyOf") {
        Some(Value::Array(items)) if items.len() == 1 => Some(items[0].clone()),
        _ => None,
    };
    if let Some(only) = only {
        map.remove("anyOf");
        map.insert("allOf".into(), Value::Array(vec![only]));
    }
    if let Some(Value::String(text)) = map.get_mut("description") {
        *text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    }
    for (key, value) in map.iter_mut() {
        match (key.as_str(), value) {
            // Names of keys and of types: what stands below them are schemas.
            ("properties" | "definitions", Value::Object(named)) => {
                for (name, schema) in named.iter_mut() {
                    tidy(schema);
                    if let (Some(unit), Value::Object(schema)) = (unit_of(name), schema) {
                        schema.entry("x-unit").or_insert(unit.into());
                    }
                }
            }
            ("default" | "enum" | "const", _) => {}
            (_, value) => tidy(value),
        }
    }
}

/// The unit that a key says it is in.
fn unit_of(key: &str) -> Option<&'static str> {
    let ending = |(ending, _): &&(&str, &str)| key.ends_with(ending);
    UNITS.iter().find(ending).map(|(_, unit)| *unit)
}
