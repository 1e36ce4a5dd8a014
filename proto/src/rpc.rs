//! Commands over queryables, one a method; JSON in and out, so that any tool can send them.

use serde::{Deserialize, Serialize};

/// Methods, as the last chunk of their keys.
pub const METHODS: [&str; 5] = ["reset", "pause", "resume", "step", "shutdown"];

/// Arguments; absent ones take their defaults. An empty payload is `{}`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// `step`: ticks to run, 1 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ticks: Option<u32>,
}

/// Answer to a command.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reply {
    /// It was carried out.
    pub ok: bool,
    /// First tick it had effect on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tick: Option<u64>,
    /// Why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

impl Request {
    /// Reads a payload; none counts as `{}`.
    ///
    /// # Errors
    /// Not JSON, or an argument no method has.
    pub fn parse(payload: &[u8]) -> Result<Self, serde_json::Error> {
        if payload.is_empty() { Ok(Self::default()) } else { serde_json::from_slice(payload) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_parse_from_nothing_and_refuse_unknown_arguments() {
        assert_eq!(Request::parse(b"").unwrap(), Request { ticks: None });
        assert_eq!(Request::parse(b"{\"ticks\": 5}").unwrap(), Request { ticks: Some(5) });
        assert!(Request::parse(b"{\"tick\": 5}").is_err());
    }
}
