//! The schema against what reads scenes: serde's own lists of keys, and the checks of values.

use super::schema;
use crate::scene::file;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::path::Path;

#[test]
fn the_file_is_what_the_types_say() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/scene/schema/scene.schema.json");
    let text = serde_json::to_string_pretty(&super::generate::generated()).unwrap() + "\n";
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let file = std::fs::read_to_string(&path).unwrap();
    assert!(
        file == text,
        "{} is not what the types say: BLESS=1 cargo test -p palpate-sim --lib the_file_is_what_the_types_say",
        path.display()
    );
}

/// The schema that another refers to, or itself.
fn resolved<'s>(root: &'s Value, schema: &'s Value) -> &'s Value {
    let whole = schema
        .get("$ref")
        .or_else(|| schema["allOf"][0].get("$ref"));
    let name = whole
        .and_then(Value::as_str)
        .map(|text| text.rsplit('/').next().unwrap());
    name.map_or(schema, |name| resolved(root, &root["definitions"][name]))
}

/// The least that a schema accepts.
fn sample(root: &Value, schema: &Value) -> Value {
    let schema = resolved(root, schema);
    if let Some(values) = schema["enum"].as_array() {
        return values[0].clone();
    }
    if let Some(value) = schema.get("const") {
        return value.clone();
    }
    for choice in ["oneOf", "anyOf"] {
        if let Some(forms) = schema[choice].as_array() {
            return sample(root, &forms[0]);
        }
    }
    match schema["type"].as_str() {
        Some("object") => {
            let required = schema["required"].as_array().cloned().unwrap_or_default();
            let keys = required.iter().map(|key| key.as_str().unwrap());
            let whole = keys.map(|key| (key.to_owned(), sample(root, &schema["properties"][key])));
            Value::Object(whole.collect::<Map<_, _>>())
        }
        Some("array") => {
            let count = schema["minItems"].as_u64().unwrap_or(0) as usize;
            vec![sample(root, &schema["items"]); count].into()
        }
        Some("integer") => schema["minimum"].as_u64().unwrap_or(1).max(1).into(),
        Some("number") => 0.01.into(),
        Some("boolean") => false.into(),
        Some("string") => "drop".into(),
        other => panic!("{other:?} of {schema}"),
    }
}

/// A table of the scene: how to come to it from the top, and its schema.
struct Table {
    path: Vec<String>,
    schema: Value,
}

/// Every table that a scene may have, each definition once; lists have one entry.
fn tables() -> (Value, Vec<Table>) {
    let root = schema();
    let (mut found, mut seen) = (Vec::new(), BTreeSet::new());
    let mut waiting = vec![(Vec::<String>::new(), root.clone())];
    while let Some((path, schema)) = waiting.pop() {
        let forms = schema["oneOf"].as_array().cloned().unwrap_or_default();
        for form in forms.iter().filter(|form| form["properties"].is_object()) {
            for (key, value) in form["properties"].as_object().unwrap() {
                let inner = [path.clone(), vec![key.clone()]].concat();
                waiting.push((inner, resolved(&root, value).clone()));
            }
        }
        let Some(properties) = schema["properties"].as_object() else {
            continue;
        };
        if !seen.insert(schema.to_string()) {
            continue;
        }
        for (key, value) in properties {
            let value = resolved(&root, value);
            let inner = [path.clone(), vec![key.clone()]].concat();
            match value["type"].as_str() {
                Some("array") => {
                    let item = resolved(&root, &value["items"]).clone();
                    waiting.push(([inner, vec!["0".into()]].concat(), item));
                }
                _ => waiting.push((inner, value.clone())),
            }
        }
        found.push(Table { path, schema });
    }
    (root, found)
}

/// A scene with this table, and in it this key.
fn scene_with(root: &Value, table: &Table, key: &str, value: &Value) -> Value {
    let mut scene = json!({
        "body": [{"id": "drop", "surface": {"builtin": "sheet"}}],
        "tool": [{"id": "ball"}],
    });
    let mut at = &mut scene;
    let mut schema = root.clone();
    for step in &table.path {
        let next = match step.parse::<usize>() {
            Ok(_) => resolved(root, &schema["items"]).clone(),
            Err(_) => {
                let forms = schema["oneOf"].as_array().cloned().unwrap_or_default();
                let all = forms.iter().chain([&schema]);
                let found = all
                    .map(|form| &form["properties"][step])
                    .find(|s| !s.is_null());
                resolved(root, found.unwrap()).clone()
            }
        };
        at = match step.parse::<usize>() {
            Ok(_) => {
                if !at.is_array() {
                    *at = json!([]);
                }
                let list = at.as_array_mut().unwrap();
                if list.is_empty() {
                    list.push(sample(root, &next));
                }
                &mut list[0]
            }
            Err(_) => {
                let object = at.as_object_mut().unwrap();
                if next["type"] == "array" && !object.contains_key(step) {
                    object.insert(step.clone(), json!([]));
                }
                let made = object.entry(step.clone()).or_insert_with(|| {
                    if next["oneOf"].is_array() {
                        json!({})
                    } else {
                        sample(root, &next)
                    }
                });
                // A choice of shapes: the one that is asked for.
                if next["oneOf"].is_array() && next["oneOf"][0]["properties"].is_object() {
                    *made = json!({});
                }
                made
            }
        };
        schema = next;
    }
    at.as_object_mut()
        .unwrap()
        .insert(key.into(), value.clone());
    scene
}

fn problems(scene: &Value) -> Option<String> {
    let text = toml::to_string(scene).unwrap_or_else(|e| panic!("{e}: {scene}"));
    let built = file::parse(&text, "s.toml", Path::new(".")).and_then(|loaded| loaded.build());
    built.err().map(|error| error.to_string())
}

// serde refuses an unknown key with the list of those that it knows.
#[test]
fn the_schema_has_the_keys_that_are_read_and_no_others() {
    let (root, tables) = tables();
    let mut compared = 0;
    for table in &tables {
        // Of forms without a name serde does not say which one was meant.
        if table.path.contains(&"refine".into()) || table.path.contains(&"fixed".into()) {
            continue;
        }
        let scene = scene_with(&root, table, "zzz", &json!(1));
        let said = problems(&scene).unwrap_or_else(|| panic!("{:?} takes zzz", table.path));
        let line = said
            .lines()
            .find(|line| line.contains("\"zzz\""))
            .unwrap_or_default();
        let known = line.rsplit("known are ").next().unwrap();
        let known: BTreeSet<&str> = known.split(", ").collect();
        let ours = table.schema["properties"].as_object().unwrap();
        let ours: BTreeSet<&str> = ours.keys().map(String::as_str).collect();
        if ours.is_empty() {
            continue;
        }
        assert_eq!(known, ours, "{:?}: {said}", table.path);
        compared += 1;
    }
    assert!(compared > 25, "{compared} tables");
}

#[test]
fn a_value_outside_its_range_in_the_schema_is_refused() {
    let (root, tables) = tables();
    let mut tried = 0;
    for table in &tables {
        for (key, value) in table.schema["properties"].as_object().unwrap() {
            let value = resolved(&root, value);
            let (bounds, list) = match value["items"].is_object() && value["maxItems"].is_u64() {
                true => (
                    &value["items"],
                    value["maxItems"].as_u64().unwrap() as usize,
                ),
                false => (value, 0),
            };
            let whole = bounds["type"] == "integer";
            let out = |bound: &str, step: f64| {
                let at = bounds[bound].as_f64()?;
                let beyond = if whole {
                    at + step.signum()
                } else {
                    at + step * at.abs().max(1e-3)
                };
                Some(if bound.starts_with("ex") { at } else { beyond })
            };
            let outside = [
                out("minimum", -0.5),
                out("maximum", 0.5),
                out("exclusiveMinimum", 0.0),
                out("exclusiveMaximum", 0.0),
            ];
            for outside in outside.into_iter().flatten() {
                let wrong = if whole {
                    json!(outside as i64)
                } else {
                    json!(outside)
                };
                let wrong = if list > 0 {
                    json!(vec![wrong; list])
                } else {
                    wrong
                };
                let scene = scene_with(&root, table, key, &wrong);
                let said = problems(&scene);
                assert!(said.is_some(), "{:?}.{key} = {wrong} is taken", table.path);
                tried += 1;
            }
        }
    }
    assert!(tried > 80, "{tried} values");
}

#[test]
fn every_key_has_a_description_and_every_measured_number_a_unit() {
    let (root, tables) = tables();
    for table in &tables {
        for (key, value) in table.schema["properties"].as_object().unwrap() {
            let own = value["description"].as_str();
            let described = own.or(resolved(&root, value)["description"].as_str());
            let variant = table.schema["description"].as_str();
            assert!(
                described.or(variant).is_some_and(|text| text.len() > 5),
                "{:?}.{key}",
                table.path
            );
            let measured = ["_m", "_s", "_n", "_pa", "_hz", "_rad"]
                .iter()
                .any(|end| key.ends_with(end));
            assert!(
                !measured || value["x-unit"].is_string(),
                "{:?}.{key} has no unit",
                table.path
            );
        }
    }
}
