//! The scene that a recording carries, as far as it is trusted.

use palpate_proto::text::located;
use palpate_sim::scene::spec::SceneSpec;
use toml::{Table, Value};

/// Reads the scene of a recording. Our recordings have every file of their scene in it; a recording of
/// someone else's that names files of this machine is refused before anything is opened.
///
/// # Errors
/// It does not parse, or names a file.
pub(crate) fn recorded_spec(text: &str) -> Result<SceneSpec, String> {
    let wrong = |error: toml::de::Error| located(text, error.span(), error.message());
    let value: Value = toml::from_str(text).map_err(wrong)?;
    match ["body", "tool"]
        .iter()
        .find_map(|key| named_file(value.get(key)?))
    {
        None => toml::from_str(text).map_err(wrong),
        Some(file) => Err(format!(
            "it names the file {file:?}, and recordings carry all that their scene needs"
        )),
    }
}

/// A recorded scene without the table `[zenoh]` that earlier builds wrote: where the bus leads is not for a file to say.
pub(super) fn without_bus(text: String) -> String {
    if !text.contains("[zenoh]") {
        return text;
    }
    let Ok(mut scene) = toml::from_str::<Table>(&text) else {
        return text;
    };
    match scene.remove("zenoh") {
        Some(_) => toml::to_string(&scene).unwrap_or(text),
        None => text,
    }
}

/// The first value of a key `file`.
fn named_file(value: &Value) -> Option<String> {
    match value {
        Value::Table(table) => table.iter().find_map(|(key, value)| match key.as_str() {
            "file" => Some(
                value
                    .as_str()
                    .map_or_else(|| value.to_string(), str::to_owned),
            ),
            _ => named_file(value),
        }),
        Value::Array(values) => values.iter().find_map(named_file),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recording_that_names_files_is_refused_by_their_names() {
        let body = |surface: &str| format!("[[body]]\nid = \"drop\"\nsurface = {surface}\n");
        assert!(recorded_spec(&body("{ builtin = \"teardrop\" }")).is_ok());
        for file in ["/etc/shadow", "/dev/zero", "drop.json"] {
            let error = recorded_spec(&body(&format!("{{ file = \"{file}\" }}"))).unwrap_err();
            assert!(error.contains(file), "{error}");
        }
        let tool = "[[tool]]\nid = \"pen\"\nshape = { mesh = { file = \"/dev/zero\" } }\n";
        let tool = body("{ builtin = \"teardrop\" }") + tool;
        let error = recorded_spec(&tool).unwrap_err();
        assert!(error.contains("/dev/zero"), "{error}");
    }

    #[test]
    fn a_recording_of_an_earlier_build_that_names_a_bus_configuration_is_read_without_it() {
        let scene = "[[body]]\nid = \"drop\"\nsurface = { builtin = \"teardrop\" }\n[loop]\nrate_hz = 500\n";
        let named = format!("{scene}[zenoh]\nconfig = \"/tmp/dial.json5\"\n");
        assert!(recorded_spec(&named).is_err());
        let read = without_bus(named);
        assert!(!read.contains("zenoh"), "{read}");
        assert_eq!(recorded_spec(&read), recorded_spec(scene));
        assert_eq!(without_bus(scene.into()), scene);
    }
}
