//! Zenoh configurations of users: our defaults below them, and what this build does not have.

use palpate_proto::text::without_value;
use serde_json::Value;
use std::path::Path;

/// Which of the settings that decide who can reach a session a configuration file names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Named {
    /// `mode`.
    pub mode: bool,
    /// `scouting/multicast/enabled`.
    pub multicast: bool,
    /// `listen/endpoints`.
    pub listen: bool,
    /// `connect/endpoints`.
    pub connect: bool,
}

/// Reads a configuration file over our defaults: what it does not name stays as without a file (this
/// mode, no multicast, no listening). Zenoh's own defaults listen on all interfaces and are found by
/// multicast.
///
/// # Errors
/// The file cannot be read or parsed, or asks for what this build does not have.
pub fn read_config(path: &Path, mode: &str) -> Result<(zenoh::Config, Named), String> {
    let named = named(path)?;
    let known =
        |kind: &std::ffi::OsStr| ["json5", "json", "yaml", "yml"].iter().any(|k| kind == *k);
    if !path.extension().is_some_and(known) {
        return Err("a configuration is a file .json5, .json or .yaml".into());
    }
    let mut config = zenoh::Config::from_file(path).map_err(|e| refusal(&e.to_string()))?;
    check_built_in(&config)?;
    let mode = format!("\"{mode}\"");
    let defaults = [
        (named.mode, "mode", mode.as_str()),
        (named.multicast, "scouting/multicast/enabled", "false"),
        (named.listen, "listen/endpoints", "[]"),
    ];
    for (_, key, value) in defaults.into_iter().filter(|(named, ..)| !named) {
        config
            .insert_json5(key, value)
            .map_err(|e| format!("{key}: {e}"))?;
    }
    Ok((config, named))
}

/// What a configuration file names.
///
/// # Errors
/// It cannot be read or parsed.
pub fn named(path: &Path) -> Result<Named, String> {
    let text = std::fs::read_to_string(path).map_err(|e| e.to_string())?;
    let yaml = path
        .extension()
        .is_some_and(|kind| kind == "yaml" || kind == "yml");
    if yaml {
        // By its words: a section that is there counts as named.
        let has = |word: &str| text.lines().any(|line| line.trim_start().starts_with(word));
        return Ok(Named {
            mode: has("mode:"),
            multicast: has("multicast:"),
            listen: has("listen:"),
            connect: has("connect:"),
        });
    }
    let value = json5_value(&text)?;
    let has = |keys: &[&str]| {
        let found = keys.iter().try_fold(&value, |value, key| value.get(key));
        found.is_some_and(|value| !value.is_null())
    };
    Ok(Named {
        mode: has(&["mode"]),
        multicast: has(&["scouting", "multicast", "enabled"]),
        listen: has(&["listen", "endpoints"]),
        connect: has(&["connect", "endpoints"]),
    })
}

/// Reads JSON5. What is wrong is said by its place: the file may hold a key, or be another than was
/// meant, and its lines do not belong into a log.
fn json5_value(text: &str) -> Result<Value, String> {
    json5::from_str(text).map_err(|json5::Error::Message { location, .. }| {
        let place = location.map_or(String::new(), |at| {
            format!(" at line {}, column {}", at.line, at.column)
        });
        format!("it is not JSON5{place}")
    })
}

/// Zenoh's refusal of a configuration, without the values that stand there: `… msg: "unknown variant
/// `x`, expected one of `a`, `b`", location: Some(Location { line: 1, column: 9 }) } at …`.
fn refusal(zenoh: &str) -> String {
    let number = |name: &str| {
        let (_, rest) = zenoh.rsplit_once(name)?;
        let end = rest.find(|c: char| !c.is_ascii_digit())?;
        rest[..end].parse::<u32>().ok()
    };
    let place = match (number("line: "), number("column: ")) {
        (Some(line), Some(column)) => format!("line {line}, column {column}: "),
        _ => String::new(),
    };
    let message = zenoh
        .split_once("\", l")
        .map_or(zenoh, |(message, _)| message);
    match message.contains(", expected ") {
        true => format!("{place}{}", without_value(message)),
        false => format!("{place}Zenoh does not take the value that stands there"),
    }
}

/// The TLS section of an identity file that `palpate auth` made: keys and certificates of one role.
///
/// # Errors
/// The file cannot be read, or is none.
pub fn identity(path: &Path) -> Result<Value, String> {
    let text = std::fs::read_to_string(path).map_err(|e| e.to_string())?;
    let value = json5_value(&text)?;
    match value.pointer("/transport/link/tls") {
        Some(tls) if tls["connect_certificate_base64"].is_string() => Ok(tls.clone()),
        _ => Err("it is no identity: `palpate auth issue` makes one".into()),
    }
}

/// Gives a configuration an identity: what it says of TLS itself is replaced.
///
/// # Errors
/// As of [`identity`].
pub fn add_identity(config: &mut zenoh::Config, path: &Path) -> Result<(), String> {
    let wrong = |reason: String| format!("identity {}: {reason}", path.display());
    let tls = identity(path).map_err(wrong)?;
    let done = config.insert_json5("transport/link/tls", &tls.to_string());
    done.map_err(|e| wrong(refusal(&e.to_string())))
}

/// Protocols that are built in.
const PROTOCOLS: [&str; 4] = ["tcp", "tls", "quic", "unixsock-stream"];

/// Both sides of an endpoint show certificates: TLS, and QUIC, which is TLS over UDP.
pub fn is_secured(endpoint: &str) -> bool {
    ["tls/", "quic/"]
        .iter()
        .any(|head| endpoint.starts_with(head))
}

/// Refuses an endpoint whose protocol is not built in: Zenoh would say so in words of its own.
///
/// # Errors
/// The protocol, and those there are.
pub fn check_protocol(endpoint: &str) -> Result<(), String> {
    match endpoint.split_once('/') {
        None => Err("the protocol is missing".into()),
        Some((protocol, _)) if PROTOCOLS.contains(&protocol) => Ok(()),
        Some((protocol, _)) => Err(format!(
            "the protocol {protocol} is not built in; there are {}",
            PROTOCOLS.join(", ")
        )),
    }
}

/// Refuses a configuration that asks for authentication or protocols that are not built in: Zenoh
/// would accept it and not enforce it.
///
/// # Errors
/// What is asked for, by its key.
pub fn check_built_in(config: &zenoh::Config) -> Result<(), String> {
    let value = |key: &str| -> Value {
        config
            .get_json(key)
            .ok()
            .and_then(|text| serde_json::from_str(&text).ok())
            .unwrap_or_default()
    };
    for key in ["transport/auth/usrpwd", "transport/auth/pubkey"] {
        if says_anything(&value(key)) {
            return Err(format!(
                "{key} is set, but this build has no authentication by passwords or bare keys: anyone could connect. \
                 Certificates are built in: see `palpate auth`"
            ));
        }
    }
    for key in ["listen/endpoints", "connect/endpoints"] {
        let mut texts = Vec::new();
        let endpoints = value(key);
        gather(&endpoints, &mut texts);
        for endpoint in texts.iter().filter(|text| text.contains('/')) {
            check_protocol(endpoint).map_err(|reason| format!("{key}: {endpoint:?}: {reason}"))?;
        }
    }
    Ok(())
}

fn says_anything(value: &Value) -> bool {
    match value {
        Value::Null => false,
        Value::Object(fields) => fields.values().any(says_anything),
        _ => true,
    }
}

fn gather<'a>(value: &'a Value, into: &mut Vec<&'a str>) {
    match value {
        Value::String(text) => into.push(text),
        Value::Array(values) => values.iter().for_each(|value| gather(value, into)),
        Value::Object(fields) => fields.values().for_each(|value| gather(value, into)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(key: &str, value: &str) -> String {
        let mut config = zenoh::Config::default();
        config.insert_json5(key, value).unwrap();
        check_built_in(&config).unwrap_err()
    }

    // Zenoh's defaults listen on every interface and answer multicast: a file that sets a lease must not
    // bring them in.
    #[test]
    fn a_file_changes_only_what_it_names() {
        let directory = std::env::temp_dir().join(format!("palpate-config-{}", std::process::id()));
        std::fs::create_dir_all(&directory).unwrap();
        let read = |name: &str, text: &str| {
            let path = directory.join(name);
            std::fs::write(&path, text).unwrap();
            let (config, named) = read_config(&path, "peer").unwrap();
            let get = |key: &str| config.get_json(key).unwrap();
            let all = ["mode", "scouting/multicast/enabled", "listen/endpoints"].map(get);
            (all, named)
        };
        let safe = ["\"peer\"", "false", "[]"].map(str::to_owned);
        let lease = "{ transport: { link: { tx: { lease: 5000 } } } } // a comment";
        assert_eq!(read("lease.json5", lease), (safe.clone(), Named::default()));
        let yaml = "transport:\n  link:\n    tx:\n      lease: 5000\n";
        assert_eq!(read("lease.yaml", yaml), (safe, Named::default()));
        let all = r#"{ mode: "client", scouting: { multicast: { enabled: true } },
            listen: { endpoints: ["tcp/127.0.0.1:0"] } }"#;
        let (own, named) = read("all.json5", all);
        assert_eq!(own[0], "\"client\"");
        assert_eq!(own[1], "true");
        assert!(own[2].contains("tcp/127.0.0.1:0"), "{}", own[2]);
        assert!(named.mode && named.multicast && named.listen && !named.connect);
        std::fs::remove_dir_all(&directory).unwrap();
    }

    #[test]
    fn what_would_not_be_enforced_is_refused_by_its_key() {
        assert_eq!(check_built_in(&zenoh::Config::default()), Ok(()));
        let user = refused("transport/auth/usrpwd/user", "\"me\"");
        assert!(user.starts_with("transport/auth/usrpwd is set"), "{user}");
        let file = refused("transport/auth/usrpwd/dictionary_file", "\"users.txt\"");
        assert!(file.contains("no authentication"), "{file}");
        let key = refused("transport/auth/pubkey/known_keys_file", "\"keys.pem\"");
        assert!(key.starts_with("transport/auth/pubkey is set"), "{key}");
        let udp = refused("listen/endpoints", "[\"udp/0.0.0.0:7447\"]");
        assert!(udp.contains("udp/0.0.0.0:7447"), "{udp}");
        assert!(udp.contains("there are tcp, tls, quic"), "{udp}");
    }
}
