//! The manifests of `packaging/kubernetes`: by the schema of Agones' and Kubernetes' resources, by what the
//! program understands, and by what they say of each other.

use crate::documents::root;
use serde_json::Value;
use std::collections::BTreeMap;

/// Documents of all manifests, with the file that each is from.
fn manifests() -> Vec<(String, Value)> {
    let folder = root().join("packaging/kubernetes");
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "yaml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        for document in serde_yaml::Deserializer::from_str(&text) {
            let value = <Value as serde::Deserialize>::deserialize(document).unwrap();
            found.push((name.clone(), value));
        }
    }
    found.sort_by(|a, b| a.0.cmp(&b.0));
    found
}

fn schema() -> Value {
    let path = root().join("packaging/kubernetes/manifests.schema.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// What is wrong with a value, by a schema made of the words that the file uses.
fn check(whole: &Value, schema: &Value, value: &Value, at: &str, wrong: &mut Vec<String>) {
    for (word, argument) in schema.as_object().unwrap() {
        let good = match word.as_str() {
            "$ref" => {
                let name = argument.as_str().unwrap().trim_start_matches('#');
                check(whole, whole.pointer(name).unwrap(), value, at, wrong);
                true
            }
            "type" => {
                let kind = match value {
                    Value::Null => "null",
                    Value::Bool(_) => "boolean",
                    Value::Number(number) if number.is_f64() => "number",
                    Value::Number(_) => "integer",
                    Value::String(_) => "string",
                    Value::Array(_) => "array",
                    Value::Object(_) => "object",
                };
                match argument {
                    Value::Array(kinds) => kinds.contains(&kind.into()),
                    one => one == kind,
                }
            }
            "const" => value == argument,
            "enum" => argument.as_array().unwrap().contains(value),
            "minimum" => value
                .as_f64()
                .is_none_or(|n| n >= argument.as_f64().unwrap()),
            "maximum" => value
                .as_f64()
                .is_none_or(|n| n <= argument.as_f64().unwrap()),
            "minLength" => value
                .as_str()
                .is_none_or(|text| text.len() as u64 >= argument.as_u64().unwrap()),
            "maxLength" => value
                .as_str()
                .is_none_or(|text| text.len() as u64 <= argument.as_u64().unwrap()),
            "minItems" => value
                .as_array()
                .is_none_or(|list| list.len() as u64 >= argument.as_u64().unwrap()),
            "pattern" => {
                assert_eq!(
                    argument, "^[a-z0-9]([-a-z0-9]*[a-z0-9])?$",
                    "the one pattern that is known here"
                );
                let plain = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit();
                value.as_str().is_none_or(|text| {
                    text.starts_with(plain)
                        && text.ends_with(plain)
                        && text.chars().all(|c| plain(c) || c == '-')
                })
            }
            "required" => {
                let has = |name: &Value| value.get(name.as_str().unwrap()).is_some();
                argument.as_array().unwrap().iter().all(has)
            }
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    check(whole, argument, item, &format!("{at}[{k}]"), wrong);
                }
                true
            }
            "properties" => {
                for (name, property) in argument.as_object().unwrap() {
                    if let Some(value) = value.get(name) {
                        check(whole, property, value, &format!("{at}.{name}"), wrong);
                    }
                }
                true
            }
            "additionalProperties" => {
                let known = schema.get("properties").and_then(Value::as_object);
                for (name, value) in value.as_object().into_iter().flatten() {
                    if known.is_some_and(|known| known.contains_key(name)) {
                        continue;
                    }
                    let at = format!("{at}.{name}");
                    match argument {
                        Value::Bool(false) => wrong.push(format!("{at}: there is no such field")),
                        schema => check(whole, schema, value, &at, wrong),
                    }
                }
                true
            }
            other => panic!("{other:?} is a word of schemas that is not known here"),
        };
        if !good {
            wrong.push(format!("{at}: {word} {argument}, but it is {value}"));
        }
    }
}

fn problems(manifest: &Value) -> Vec<String> {
    let whole = schema();
    let kind = manifest["kind"].as_str().unwrap_or_default();
    let mut wrong = Vec::new();
    match whole["definitions"].get(kind) {
        Some(schema) => check(&whole, schema, manifest, kind, &mut wrong),
        None => wrong.push(format!("{kind:?} is a kind that the schema does not have")),
    }
    wrong
}

#[test]
fn the_manifests_fit_the_schemas_of_their_kinds() {
    let manifests = manifests();
    let kinds: Vec<&str> = (manifests.iter())
        .map(|(_, manifest)| manifest["kind"].as_str().unwrap())
        .collect();
    for kind in ["Fleet", "FleetAutoscaler", "Deployment", "Service"] {
        assert!(kinds.contains(&kind), "{kinds:?}");
    }
    for (file, manifest) in &manifests {
        assert_eq!(problems(manifest), [""; 0], "{file}");
    }
}

#[test]
fn the_schema_refuses_what_agones_would_refuse_or_drop() {
    let find = |kind: &str| {
        let found = manifests()
            .into_iter()
            .find(|(_, manifest)| manifest["kind"] == kind);
        found.unwrap().1
    };
    type Change = (&'static str, &'static str, Value);
    let changes: [Change; 13] = [
        ("Fleet", "/apiVersion", "agones.dev/v1alpha1".into()),
        ("Fleet", "/spec/replicas", (-1).into()),
        ("Fleet", "/spec/replicas", "2".into()),
        ("Fleet", "/spec/scheduling", "packed".into()),
        (
            "Fleet",
            "/spec/template/spec/ports/0/portPolicy",
            "dynamic".into(),
        ),
        (
            "Fleet",
            "/spec/template/spec/ports/0/protocol",
            "tcp".into(),
        ),
        (
            "Fleet",
            "/spec/template/spec/ports/0/containerPort",
            70_000.into(),
        ),
        (
            "Fleet",
            "/spec/template/spec/health/failureThreshold",
            0.into(),
        ),
        (
            "Fleet",
            "/spec/template/spec/health",
            serde_json::json!({ "period_seconds": 5 }),
        ),
        (
            "Fleet",
            "/spec/template/spec/template/spec/containers",
            serde_json::json!([]),
        ),
        ("FleetAutoscaler", "/spec/fleetName", "Palpate".into()),
        (
            "FleetAutoscaler",
            "/spec/policy/buffer",
            serde_json::json!({ "bufferSize": 2 }),
        ),
        ("FleetAutoscaler", "/spec/policy/type", "buffer".into()),
    ];
    for (kind, place, value) in changes {
        let mut manifest = find(kind);
        *manifest.pointer_mut(place).unwrap() = value.clone();
        assert!(!problems(&manifest).is_empty(), "{kind}{place}: {value}");
    }
}

// A validator of others, where there is one, comes to the same.
#[test]
fn the_manifests_fit_by_jsonschema_too() {
    let name = std::env::var("PALPATE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let program = r##"
import json, sys
import jsonschema
schema, manifests = json.load(sys.stdin)
jsonschema.Draft7Validator.check_schema(schema)
for manifest in manifests:
    part = {"$ref": "#/definitions/" + manifest["kind"], "definitions": schema["definitions"]}
    for error in jsonschema.Draft7Validator(part).iter_errors(manifest):
        print(manifest["kind"], error.json_path, error.message)
"##;
    let mut child = std::process::Command::new(&name)
        .args(["-c", program])
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let documents: Vec<Value> = manifests()
        .into_iter()
        .map(|(_, manifest)| manifest)
        .collect();
    let input = serde_json::json!([schema(), documents]).to_string();
    std::io::Write::write_all(child.stdin.as_mut().unwrap(), input.as_bytes()).ok();
    let done = child.wait_with_output().unwrap();
    let err = String::from_utf8_lossy(&done.stderr);
    if err.contains("ModuleNotFoundError") {
        println!("skipped: {name} lacks jsonschema (pip install jsonschema)");
        return;
    }
    assert!(done.status.success(), "{err}");
    assert_eq!(String::from_utf8_lossy(&done.stdout), "");
}

/// Containers of a manifest, with the volumes of their pod.
fn containers(manifest: &Value) -> Vec<(Value, Value)> {
    let pods = ["/spec/template/spec/template/spec", "/spec/template/spec"];
    let pod = pods.iter().find_map(|place| {
        let pod = manifest.pointer(place)?;
        pod.get("containers").map(|_| pod.clone())
    });
    let Some(pod) = pod else { return Vec::new() };
    let containers = pod["containers"].as_array().unwrap().clone();
    containers
        .into_iter()
        .map(|container| (container, pod["volumes"].clone()))
        .collect()
}

#[test]
fn what_containers_run_is_what_this_program_understands() {
    let mut ran = Vec::new();
    for (file, manifest) in manifests() {
        for (container, volumes) in containers(&manifest) {
            let args = container["args"].as_array().unwrap().iter();
            let args: Vec<&str> = args.map(|argument| argument.as_str().unwrap()).collect();
            let command = palpate::cli::command();
            let read = command.try_get_matches_from([&["palpate"], &args[..]].concat());
            assert!(read.is_ok(), "{file}: {}", read.unwrap_err());
            // What it reads is mounted, and what is mounted is there.
            let mounts: BTreeMap<&str, &str> = container["volumeMounts"]
                .as_array()
                .unwrap()
                .iter()
                .map(|mount| {
                    (
                        mount["mountPath"].as_str().unwrap(),
                        mount["name"].as_str().unwrap(),
                    )
                })
                .collect();
            for path in args.iter().filter(|argument| argument.starts_with('/')) {
                let mounted = mounts.keys().any(|mount| path.starts_with(mount));
                assert!(mounted, "{file}: {path} is in no volume");
            }
            for volume in mounts.values() {
                let mut all = volumes.as_array().unwrap().iter();
                assert!(
                    all.any(|known| known["name"] == *volume),
                    "{file}: {volume}"
                );
            }
            ran.push(args[0].to_owned());
        }
    }
    ran.sort();
    assert_eq!(ran, ["relay", "serve"]);
}

#[test]
fn the_manifests_agree_with_each_other() {
    let all = manifests();
    let find = |kind: &str| {
        &all.iter()
            .find(|(_, manifest)| manifest["kind"] == kind)
            .unwrap()
            .1
    };
    let (fleet, scaler) = (find("Fleet"), find("FleetAutoscaler"));
    assert_eq!(scaler["spec"]["fleetName"], fleet["metadata"]["name"]);
    let server = &fleet["spec"]["template"]["spec"];
    let (container, _) = &containers(fleet)[0];
    assert_eq!(server["container"], container["name"]);
    let args: Vec<&str> = (container["args"].as_array().unwrap().iter())
        .filter_map(Value::as_str)
        .collect();
    assert!(args.contains(&"--agones"));
    let port = &server["ports"][0]["containerPort"];
    assert!(args.contains(&&*format!("tls/0.0.0.0:{port}")), "{args:?}");
    // Health every 2 s, or twice in a period that is shorter.
    assert!(server["health"]["periodSeconds"].as_u64().unwrap() >= 2);
    let (deployment, service) = (find("Deployment"), find("Service"));
    let labels = &deployment["spec"]["template"]["metadata"]["labels"];
    assert_eq!(&deployment["spec"]["selector"]["matchLabels"], labels);
    assert_eq!(&service["spec"]["selector"], labels);
    let (relay, _) = &containers(deployment)[0];
    assert_eq!(
        service["spec"]["ports"][0]["targetPort"],
        relay["ports"][0]["name"]
    );
}

// Kubernetes mounts secrets readable by everybody unless it is told otherwise.
#[test]
fn keys_are_mounted_so_that_nobody_else_reads_them() {
    let mut found = 0;
    for (file, manifest) in manifests() {
        for (container, volumes) in containers(&manifest) {
            let is_root = container["securityContext"]["runAsNonRoot"] != true;
            for volume in volumes.as_array().unwrap() {
                let Some(secret) = volume.get("secret") else {
                    continue;
                };
                let expected = if is_root { 0o400 } else { 0o440 };
                assert_eq!(secret["defaultMode"], expected, "{file}");
                found += 1;
            }
        }
    }
    assert_eq!(found, 2);
}
