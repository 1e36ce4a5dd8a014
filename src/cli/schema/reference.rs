//! The reference of scene files as Markdown: one section per table, one row per key.

use serde_json::{Map, Value};
use std::fmt::Write as _;

/// Tables of a scene in the order in which a reader of the file meets them.
struct Reference<'s> {
    definitions: &'s Map<String, Value>,
    /// Definitions that have a section, and the path under which it stands.
    placed: Vec<(String, String)>,
    text: String,
}

/// All sections; `schema` is that of a scene.
pub fn markdown(schema: &Value) -> String {
    let none = Map::new();
    let mut reference = Reference {
        definitions: schema["definitions"].as_object().unwrap_or(&none),
        placed: Vec::new(),
        text: String::new(),
    };
    reference.table("", false, schema);
    reference.text
}

/// The name of the definition that a schema refers to.
fn referred(schema: &Value) -> Option<&str> {
    let whole = schema.get("$ref").or_else(|| match &schema["allOf"] {
        Value::Array(one) if one.len() == 1 => one[0].get("$ref"),
        _ => None,
    });
    whole?.as_str()?.strip_prefix("#/definitions/")
}

fn described(schema: &Value) -> &str {
    schema["description"].as_str().unwrap_or_default()
}

/// A heading as TOML writes the table.
fn heading(path: &str, list: bool) -> String {
    match (path, list) {
        ("", _) => "Top of the file".into(),
        (path, true) => format!("`[[{path}]]`"),
        (path, false) => format!("`[{path}]`"),
    }
}

/// The anchor of a heading, as GitHub and mdBook make it.
fn anchor(path: &str) -> String {
    path.chars()
        .filter(|c| c.is_alphanumeric() || "_-".contains(*c))
        .collect()
}

/// A value as TOML writes it.
fn toml(value: &Value) -> String {
    match value {
        Value::Array(items) => {
            let items: Vec<String> = items.iter().map(toml).collect();
            format!("[{}]", items.join(", "))
        }
        Value::Number(number) => match number.as_f64() {
            Some(x) if !number.is_u64() && x != 0.0 && !(1e-3..1e6).contains(&x.abs()) => {
                format!("{x:e}")
            }
            _ => number.to_string(),
        },
        Value::Object(_) => String::new(),
        other => other.to_string(),
    }
}

impl<'s> Reference<'s> {
    fn definition(&self, name: &str) -> &'s Value {
        self.definitions.get(name).unwrap_or(&Value::Null)
    }

    /// The object that a schema is or refers to, with the name of its definition.
    fn object(&self, schema: &'s Value) -> Option<(Option<&'s str>, &'s Value)> {
        let name = referred(schema);
        let target = name.map_or(schema, |name| self.definition(name));
        let shapes = target["oneOf"]
            .as_array()
            .is_some_and(|forms| forms.iter().all(|form| form["properties"].is_object()));
        (target["properties"].is_object() || shapes).then_some((name, target))
    }

    /// A section, then those of the tables inside it.
    fn table(&mut self, path: &str, list: bool, schema: &'s Value) {
        let depth = path.split('.').count().min(3) + 1;
        let title = heading(path, list);
        let _ = writeln!(self.text, "{} {title}\n", "#".repeat(depth));
        if !path.is_empty() {
            let said = described(schema);
            let said = said.strip_prefix(&format!("{title}: ")).unwrap_or(said);
            let _ = writeln!(self.text, "{}\n", sentence(said));
        }
        if let Some(forms) = schema["oneOf"].as_array() {
            self.text.push_str("Exactly one of:\n\n");
            self.head();
            let mut inside = Vec::new();
            for form in forms {
                inside.extend(self.rows(path, form, true));
            }
            self.text.push('\n');
            self.sections(inside);
            return;
        }
        self.head();
        let inside = self.rows(path, schema, false);
        self.text.push('\n');
        self.values(schema);
        self.sections(inside);
    }

    fn sections(&mut self, inside: Vec<(String, bool, &'s Value)>) {
        for (path, list, schema) in inside {
            self.table(&path, list, schema);
        }
    }

    fn head(&mut self) {
        self.text.push_str(
            "| key | value | unit | default | range | meaning |\n|---|---|---|---|---|---|\n",
        );
    }

    /// A row per key; gives the tables that these keys open and that have no section yet. A `variant`
    /// is one of several tables with one key each, whose meaning stands at the table.
    fn rows(
        &mut self,
        path: &str,
        schema: &'s Value,
        variant: bool,
    ) -> Vec<(String, bool, &'s Value)> {
        let required = schema["required"].as_array();
        let mut inside = Vec::new();
        for (key, value) in schema["properties"].as_object().into_iter().flatten() {
            let below = match path {
                "" => key.clone(),
                path => format!("{path}.{key}"),
            };
            let items = value.get("items").and_then(|items| self.object(items));
            let (list, target) = match items {
                Some(found) => (true, Some(found)),
                None => (false, self.object(value)),
            };
            let kind = match target {
                Some((name, table)) => {
                    let known =
                        name.and_then(|name| self.placed.iter().find(|(placed, _)| placed == name));
                    let at = match known {
                        Some((_, at)) => at.clone(),
                        None => {
                            if let Some(name) = name {
                                self.placed.push((name.to_owned(), below.clone()));
                            }
                            inside.push((below.clone(), list, table));
                            below
                        }
                    };
                    let what = if list { "list of tables" } else { "table" };
                    format!("[{what}](#{})", anchor(&at))
                }
                None => self.kind(value),
            };
            let default = match (value.get("x-default"), value.get("default")) {
                (Some(text), _) => format!("`{}`", text.as_str().unwrap_or_default()),
                (None, Some(Value::Array(empty))) if empty.is_empty() => String::new(),
                (None, Some(default)) if !default.is_object() => format!("`{}`", toml(default)),
                _ if !variant && required.is_some_and(|keys| keys.iter().any(|r| r == key)) => {
                    "required".into()
                }
                _ => String::new(),
            };
            let meaning = described(if variant { schema } else { value });
            let _ = writeln!(
                self.text,
                "| `{key}` | {kind} | {} | {default} | {} | {} |",
                value["x-unit"].as_str().unwrap_or_default(),
                range(value),
                sentence(meaning).replace('|', "\\|"),
            );
        }
        inside
    }

    /// What may stand after the key.
    fn kind(&self, schema: &Value) -> String {
        if let Some(name) = referred(schema) {
            return self.kind(self.definition(name));
        }
        let names = |values: &Vec<Value>| {
            let names: Vec<String> = values.iter().map(|value| format!("`{value}`")).collect();
            names.join(", ")
        };
        if let Some(values) = schema["enum"].as_array() {
            return names(values);
        }
        if schema["const"].is_string() {
            return format!("`{}`", schema["const"]);
        }
        for choice in ["oneOf", "anyOf"] {
            if let Some(forms) = schema[choice].as_array() {
                let forms: Vec<String> = forms.iter().map(|form| self.kind(form)).collect();
                return forms.join(", ");
            }
        }
        if let Some(properties) = schema["properties"].as_object() {
            let keys: Vec<String> = properties
                .iter()
                .map(|(key, value)| format!("{key} = {}", self.kind(value)))
                .collect();
            return format!("{{ {} }}", keys.join(", "));
        }
        let items = || self.kind(&schema["items"]);
        match schema["type"].as_str() {
            Some("integer") => "whole number".into(),
            Some("number") => "number".into(),
            Some("boolean") => "true, false".into(),
            Some("string") => "text".into(),
            Some("array") => match schema["minItems"].as_u64().filter(|n| *n > 1) {
                Some(count) => format!("{count} × {}", items()),
                None => format!("list of {}", items()),
            },
            _ => "table".into(),
        }
    }

    /// What the names mean that a key may have.
    fn values(&mut self, schema: &'s Value) {
        let Some(properties) = schema["properties"].as_object() else {
            return;
        };
        for (key, value) in properties {
            let target = referred(value).map_or(value, |name| self.definition(name));
            let forms = target["oneOf"].as_array().or(target["anyOf"].as_array());
            let Some(forms) = forms.filter(|_| self.object(value).is_none()) else {
                continue;
            };
            let mut forms: Vec<&Value> = forms.iter().collect();
            // A choice of names inside a choice.
            while let Some(at) = forms.iter().position(|form| referred(form).is_some()) {
                let inner = self.definition(referred(forms[at]).unwrap_or_default());
                let inner = inner["oneOf"]
                    .as_array()
                    .map(Vec::as_slice)
                    .unwrap_or_default();
                forms.splice(at..=at, inner);
            }
            if forms.iter().all(|form| described(form).is_empty()) {
                continue;
            }
            let _ = writeln!(self.text, "Values of `{key}`:\n");
            for form in forms {
                let kind = self.kind(form);
                let kind = if kind.starts_with('`') {
                    kind
                } else {
                    format!("*{kind}*")
                };
                let _ = writeln!(self.text, "- {kind}: {}", sentence(described(form)));
            }
            self.text.push('\n');
        }
    }
}

/// `1 to 100`, `> 0`, `≥ 0, < 0.5`.
fn range(schema: &Value) -> String {
    let of = |schema: &Value| {
        let get = |key: &str| schema.get(key).filter(|bound| bound.is_number()).map(toml);
        let (low, high) = (get("minimum"), get("maximum"));
        let (above, below) = (get("exclusiveMinimum"), get("exclusiveMaximum"));
        let mut said = match (low, high) {
            (Some(low), Some(high)) => vec![format!("{low} to {high}")],
            (low, high) => {
                let low = low.map(|low| format!("≥ {low}"));
                low.into_iter()
                    .chain(high.map(|high| format!("≤ {high}")))
                    .collect()
            }
        };
        said.extend(above.map(|above| format!("> {above}")));
        said.extend(below.map(|below| format!("< {below}")));
        said.join(", ")
    };
    match schema.get("items") {
        Some(items) if !of(items).is_empty() => format!("each {}", of(items)),
        _ => of(schema),
    }
}

/// With a full stop, and with a capital where it begins with a plain word.
fn sentence(text: &str) -> String {
    let text = text.trim();
    let Some(word) = text.split_whitespace().next() else {
        return String::new();
    };
    let end = if text.ends_with(['.', '…']) {
        ""
    } else {
        "."
    };
    let plain = word.chars().all(|c| c.is_ascii_lowercase() || c == ',');
    let (first, rest) = text.split_at(text.chars().next().map_or(0, char::len_utf8));
    match plain {
        true => format!("{}{rest}{end}", first.to_uppercase()),
        false => format!("{text}{end}"),
    }
}
