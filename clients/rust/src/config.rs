//! What a Zenoh configuration may ask for that this build does not have.

use serde_json::Value;

/// Protocols that are built in.
const PROTOCOLS: [&str; 2] = ["tcp", "unixsock-stream"];

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
                "{key} is set, but this build has no authentication: anyone could connect. Restrict who reaches the \
                 port instead (loopback, a Unix socket, a firewall, a tunnel), or put a Zenoh router with \
                 authentication in front"
            ));
        }
    }
    for key in ["listen/endpoints", "connect/endpoints"] {
        let mut texts = Vec::new();
        let endpoints = value(key);
        gather(&endpoints, &mut texts);
        let other = texts.iter().find(|text| {
            text.split_once('/')
                .is_some_and(|(protocol, _)| !PROTOCOLS.contains(&protocol))
        });
        if let Some(endpoint) = other {
            return Err(format!(
                "{key}: {endpoint:?} uses a protocol that is not built in; there are {}",
                PROTOCOLS.join(", ")
            ));
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

    #[test]
    fn what_would_not_be_enforced_is_refused_by_its_key() {
        assert_eq!(check_built_in(&zenoh::Config::default()), Ok(()));
        let user = refused("transport/auth/usrpwd/user", "\"me\"");
        assert!(user.starts_with("transport/auth/usrpwd is set"), "{user}");
        let file = refused("transport/auth/usrpwd/dictionary_file", "\"users.txt\"");
        assert!(file.contains("no authentication"), "{file}");
        let key = refused("transport/auth/pubkey/known_keys_file", "\"keys.pem\"");
        assert!(key.starts_with("transport/auth/pubkey is set"), "{key}");
        let tls = refused("listen/endpoints", "[\"tls/0.0.0.0:7447\"]");
        assert!(tls.contains("tls/0.0.0.0:7447"), "{tls}");
    }
}
