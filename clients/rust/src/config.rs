//! Zenoh configurations of users: our defaults below them, and what this build does not have.

use palpate_proto::text::without_value;
use serde_json::Value;
use std::path::Path;

/// Which of the settings that decide where a session links to a configuration file names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Named {
    /// `listen/endpoints`.
    pub listen: bool,
    /// `connect/endpoints`.
    pub connect: bool,
}

/// A configuration file as Zenoh reads it.
fn read(path: &Path) -> Result<zenoh::Config, String> {
    let known =
        |kind: &std::ffi::OsStr| ["json5", "json", "yaml", "yml"].iter().any(|k| kind == *k);
    if !path.extension().is_some_and(known) {
        return Err("a configuration is a file .json5, .json or .yaml".into());
    }
    if (path.extension()).is_some_and(|kind| kind == "json5" || kind == "json") {
        // Zenoh would quote the line.
        json5_value(&std::fs::read_to_string(path).map_err(|e| e.to_string())?)?;
    }
    zenoh::Config::from_file(path).map_err(|e| refusal(&e.to_string()))
}

/// What a configuration file names.
///
/// # Errors
/// It cannot be read or parsed.
pub fn named(path: &Path) -> Result<Named, String> {
    let config = read(path)?;
    let own = zenoh::Config::default();
    let differs = |key: &str| config.get_json(key).ok() != own.get_json(key).ok();
    Ok(Named {
        // Zenoh's default says it too.
        listen: differs("listen/endpoints") || writes_listen_endpoints(path)?,
        connect: differs("connect/endpoints"),
    })
}

fn writes_listen_endpoints(path: &Path) -> Result<bool, String> {
    let text = std::fs::read_to_string(path).map_err(|e| e.to_string())?;
    Ok(match json5::from_str::<Value>(&text) {
        Ok(value) => value
            .pointer("/listen/endpoints")
            .is_some_and(|value| !value.is_null()),
        // YAML, by its words.
        Err(_) => text
            .lines()
            .any(|line| line.trim_start().starts_with("listen:")),
    })
}

/// A configuration that links to nobody but whom it names: what the file does not say is this mode, no
/// multicast, no listening, and no links to whom others name. Zenoh's own defaults listen on all interfaces, are found
/// by multicast, and connect to whatever address a connected session gossips about, whoever that is.
///
/// # Errors
/// The file cannot be read or parsed, asks for what this build does not have, or has or names a private key that
/// others can read.
pub fn configuration(path: Option<&Path>, mode: &str) -> Result<zenoh::Config, String> {
    let (mut config, named) = match path {
        None => (zenoh::Config::default(), Named::default()),
        Some(path) => {
            let config = read(path)?;
            check_built_in(&config)?;
            check_keys(&config, path)?;
            (config, named(path)?)
        }
    };
    let said = |config: &zenoh::Config, key: &str| Said(config).value(key) != Value::Null;
    if !said(&config, "mode") {
        set(&mut config, "mode", &format!("\"{mode}\""))?;
    }
    if !said(&config, "scouting/multicast/enabled") {
        set(&mut config, "scouting/multicast/enabled", "false")?;
    }
    let gossip = "scouting/gossip/autoconnect";
    if Said(&config).of_mode(gossip) == Value::Null {
        set(&mut config, gossip, "[]")?;
    }
    if !named.listen {
        set(&mut config, "listen/endpoints", "[]")?;
    }
    Ok(config)
}

fn set(config: &mut zenoh::Config, key: &str, value: &str) -> Result<(), String> {
    config
        .insert_json5(key, value)
        .map_err(|e| format!("{key}: {e}"))
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
/// As of [`identity`] and [`check_private`].
pub fn add_identity(config: &mut zenoh::Config, path: &Path) -> Result<(), String> {
    check_private(path)?;
    let wrong = |reason: String| format!("identity {}: {reason}", path.display());
    let tls = identity(path).map_err(wrong)?;
    let done = config.insert_json5("transport/link/tls", &tls.to_string());
    done.map_err(|e| wrong(refusal(&e.to_string())))
}

/// Refuses a file with a private key that others can read, as ssh does. Of root's files, which a program of
/// another user cannot own, the group may read: volumes of secrets are mounted so.
///
/// # Errors
/// Who can read it, and what to do.
pub fn check_private(path: &Path) -> Result<(), String> {
    #[cfg(unix)]
    if let Ok(data) = std::fs::metadata(path) {
        use std::os::unix::fs::MetadataExt as _;
        let mode = data.mode() & 0o777;
        let roots = data.uid() == 0 && !rustix::process::geteuid().is_root();
        if mode & if roots { 0o037 } else { 0o077 } != 0 {
            let path = path.display();
            return Err(format!(
                "{path} contains a private key, and others on this machine can read or change it (mode {mode:04o}): chmod \
                 600 {path}"
            ));
        }
    }
    Ok(())
}

/// The same for the keys that a configuration file has or names.
fn check_keys(config: &zenoh::Config, path: &Path) -> Result<(), String> {
    for key in ["listen_private_key", "connect_private_key"] {
        let value = |kind: &str| Said(config).value(&format!("transport/link/tls/{key}{kind}"));
        if value("_base64").is_string() {
            check_private(path)?;
        }
        if let Some(file) = value("").as_str() {
            check_private(Path::new(file))?;
        }
    }
    Ok(())
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
fn check_built_in(config: &zenoh::Config) -> Result<(), String> {
    let said = Said(config);
    for key in ["transport/auth/usrpwd", "transport/auth/pubkey"] {
        if says_anything(&said.value(key)) {
            return Err(format!(
                "{key} is set, but this build has no authentication by passwords or bare keys: anyone could connect. \
                 Certificates are built in: see `palpate auth`"
            ));
        }
    }
    for key in ["plugins", "plugins_loading/enabled"] {
        if !matches!(said.value(key), Value::Null | Value::Bool(false))
            && said.value(key) != serde_json::json!({})
        {
            return Err(format!("{key} is set, but this build has no plugins"));
        }
    }
    for key in ["listen/endpoints", "connect/endpoints"] {
        let mut all = Vec::new();
        texts(&said.value(key), &mut all);
        for endpoint in all.iter().filter(|text| text.contains('/')) {
            check_protocol(endpoint).map_err(|reason| format!("{key}: {endpoint:?}: {reason}"))?;
        }
    }
    Ok(())
}

/// A configuration, read as Zenoh reads it.
pub(crate) struct Said<'a>(pub(crate) &'a zenoh::Config);

impl Said<'_> {
    /// What it has under a key; null where it has nothing.
    pub(crate) fn value(&self, key: &str) -> Value {
        let text = self.0.get_json(key).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    }

    /// A value that may be said by mode, for the session's own; null where it is not said for that.
    pub(crate) fn of_mode(&self, key: &str) -> Value {
        match self.value(key) {
            Value::Object(mut by_mode) => by_mode.remove(&self.mode()).unwrap_or_default(),
            value => value,
        }
    }

    /// Mode of the session.
    pub(crate) fn mode(&self) -> String {
        (self.value("mode").as_str()).map_or_else(|| "peer".to_owned(), str::to_owned)
    }

    /// Endpoints in use under a key.
    pub(crate) fn endpoints(&self, key: &str) -> Vec<String> {
        let mut all = Vec::new();
        texts(&self.of_mode(key), &mut all);
        all.retain(|text| text.contains('/')); // A group of endpoints also says how they are used.
        all
    }
}

fn says_anything(value: &Value) -> bool {
    match value {
        Value::Null => false,
        Value::Object(fields) => fields.values().any(says_anything),
        _ => true,
    }
}

/// All texts of a value.
fn texts(value: &Value, into: &mut Vec<String>) {
    match value {
        Value::String(text) => into.push(text.clone()),
        Value::Array(values) => values.iter().for_each(|value| texts(value, into)),
        Value::Object(fields) => fields.values().for_each(|value| texts(value, into)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn refused(key: &str, value: &str) -> String {
        let mut config = zenoh::Config::default();
        config.insert_json5(key, value).unwrap();
        check_built_in(&config).unwrap_err()
    }

    // Zenoh's defaults listen on every interface, answer multicast and connect to whoever is gossiped about: a
    // file that sets a lease must not bring them in.
    #[test]
    fn a_file_changes_only_what_it_names() {
        let directory = tempfile::tempdir().unwrap();
        let read = |name: &str, text: &str| {
            let path = directory.path().join(name);
            std::fs::write(&path, text).unwrap();
            let config = configuration(Some(&path), "peer").unwrap();
            let said = Said(&config);
            let all = [
                said.value("mode"),
                said.value("scouting/multicast/enabled"),
                said.value("listen/endpoints"),
                said.of_mode("scouting/gossip/autoconnect"),
            ];
            (all, named(&path).unwrap())
        };
        let safe = [json!("peer"), json!(false), json!([]), json!([])];
        let nothing = Named::default();
        let lease = "{ transport: { link: { tx: { lease: 5000 } } } } // a comment";
        assert_eq!(read("lease.json5", lease), (safe.clone(), nothing));
        let yaml = "transport:\n  link:\n    tx:\n      lease: 5000\n";
        assert_eq!(read("lease.yaml", yaml), (safe.clone(), nothing));
        let others = "{ scouting: { gossip: { autoconnect: { router: ['peer'] } } } }";
        assert_eq!(read("others.json5", others), (safe, nothing));
        let all = r#"{ mode: "client", scouting: { multicast: { enabled: true }, gossip: { autoconnect: ["peer"] } },
            listen: { endpoints: ["tcp/127.0.0.1:0"] } }"#;
        let own = [
            json!("client"),
            json!(true),
            json!(["tcp/127.0.0.1:0"]),
            json!(["peer"]),
        ];
        let listens = Named {
            listen: true,
            connect: false,
        };
        assert_eq!(read("all.json5", all), (own.clone(), listens));
        let yaml = "{mode: client, scouting: {multicast: {enabled: true}, gossip: {autoconnect: [peer]}}, \
                    'listen': {endpoints: ['tcp/127.0.0.1:0']}}";
        assert_eq!(read("all.yaml", yaml), (own, listens));
        // Zenoh's default, but somebody wrote it.
        let wide = "{ listen: { endpoints: { router: ['tcp/[::]:7447'], peer: ['tcp/[::]:0'] } } }";
        assert_eq!(read("wide.json5", wide).1, listens);
    }

    #[cfg(unix)]
    #[test]
    fn a_private_key_that_others_can_read_is_refused_wherever_it_is_named() {
        use std::os::unix::fs::PermissionsExt as _;
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let key = at("key.pem").display().to_string();
        let with = |key: &str, value: &str| {
            format!("{{ transport: {{ link: {{ tls: {{ {key}: {value:?} }} }} }} }}")
        };
        let inside = "connect_private_key_base64";
        std::fs::write(at("key.pem"), "a key").unwrap();
        std::fs::write(at("connect.json5"), with("connect_private_key", &key)).unwrap();
        std::fs::write(at("listen.json5"), with("listen_private_key", &key)).unwrap();
        let own = with(inside, "a2V5").replace(inside, "connect_certificate_base64: 'YQ==', $0");
        std::fs::write(at("own.json5"), own.replace("$0", inside)).unwrap();
        let mode = |name: &str, mode: u32| {
            std::fs::set_permissions(at(name), std::fs::Permissions::from_mode(mode)).unwrap();
        };
        for bits in [0o644, 0o640, 0o604, 0o660, 0o620] {
            mode("key.pem", bits);
            mode("own.json5", bits);
            for name in ["connect.json5", "listen.json5", "own.json5"] {
                let error = configuration(Some(&at(name)), "peer").unwrap_err();
                assert!(error.contains("chmod 600"), "{name} {bits:o}: {error}");
            }
            let error = add_identity(&mut zenoh::Config::default(), &at("own.json5")).unwrap_err();
            assert!(error.contains("own.json5"), "{bits:o}: {error}");
        }
        for bits in [0o600, 0o400] {
            mode("key.pem", bits);
            mode("own.json5", bits);
            for name in ["connect.json5", "listen.json5", "own.json5"] {
                configuration(Some(&at(name)), "peer").unwrap();
            }
            add_identity(&mut zenoh::Config::default(), &at("own.json5")).unwrap();
        }
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
        let plugin = refused("plugins/rest", "{ http_port: 8000 }");
        assert!(plugin.contains("no plugins"), "{plugin}");
        let plugins = refused("plugins_loading/enabled", "true");
        assert!(
            plugins.starts_with("plugins_loading/enabled is set"),
            "{plugins}"
        );
        let udp = refused("listen/endpoints", "[\"udp/0.0.0.0:7447\"]");
        assert!(udp.contains("udp/0.0.0.0:7447"), "{udp}");
        assert!(udp.contains("there are tcp, tls, quic"), "{udp}");
    }
}
