//! Commands over queryables, one a method; JSON in and out, so that any tool can send them.

use serde::{Deserialize, Serialize};

/// Methods, as the last chunk of their keys.
pub const METHODS: [&str; 12] = [
    "reset",
    "pause",
    "resume",
    "step",
    "shutdown",
    "record_start",
    "record_stop",
    "snapshot",
    "seek",
    "rate",
    "merge",
    "isolate",
];

/// Longest arguments that are read, bytes.
pub const MAX_REQUEST_BYTES: usize = 16 << 10;

/// Arguments; absent ones take their defaults. An empty payload is `{}`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// `step`: ticks to run, 1 if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ticks: Option<u32>,
    /// `record_start`, `snapshot`: file on the daemon's machine; where it keeps recordings if
    /// absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// `snapshot`: seconds before now.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub before: Option<f64>,
    /// `snapshot`: seconds after now.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<f64>,
    /// `seek`: where to go on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tick: Option<u64>,
    /// `rate`: simulated over real time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
    /// `merge`, `isolate`: ids of bodies; of `isolate` the first moves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bodies: Option<Vec<String>>,
    /// `merge`: id of the merged body; those of its parts, joined, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<String>,
    /// `merge`: continuous derivatives at the seam.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continuity: Option<u32>,
    /// `merge`: `seed`, `constrained` or `exact`; `isolate`: `1` … `7`, `local` or `global`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub method: Option<String>,
    /// `merge`: deviation allowed, m; knots are inserted until it is met.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// `isolate`: gap left between the bodies, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
    /// `isolate`: most turn of one body about the other, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_turn: Option<f64>,
}

/// Answer to a command.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reply {
    /// It was carried out.
    pub ok: bool,
    /// First tick it had effect on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tick: Option<u64>,
    /// File that was begun or finished.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<String>,
    /// What else there is to say: figures of a merge, the translation of an isolation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub report: Option<serde_json::Value>,
    /// Why not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

impl Reply {
    /// Carried out, with effect from a tick on.
    pub fn at(tick: u64) -> Self {
        Self {
            ok: true,
            tick: Some(tick),
            ..Self::default()
        }
    }

    /// Not carried out.
    pub fn refused(reason: impl Into<String>) -> Self {
        Self {
            error: Some(reason.into()),
            ..Self::default()
        }
    }
}

/// Why arguments were refused.
#[derive(Debug, thiserror::Error)]
pub enum RequestError {
    /// Too long.
    #[error("the arguments of {method} have {bytes} bytes; at most {MAX_REQUEST_BYTES} are read")]
    Oversized {
        /// Method.
        method: String,
        /// How many.
        bytes: usize,
    },
    /// Not JSON, or arguments that no method has.
    #[error("the arguments of {method} do not parse: {source}")]
    Parse {
        /// Method.
        method: String,
        /// Cause.
        source: serde_json::Error,
    },
    /// JSON, but no object.
    #[error(
        "the arguments of {method} do not parse: they are a JSON object, like {{\"ticks\": 5}}"
    )]
    NotObject {
        /// Method.
        method: String,
    },
    /// An argument of another method.
    #[error("{method} has no argument {argument:?}; it has {known}")]
    Foreign {
        /// Method.
        method: String,
        /// As given.
        argument: &'static str,
        /// What there is.
        known: String,
    },
    /// A value that cannot be.
    #[error("{argument} of {method} is {value}; it must be between {least} and {most}")]
    Range {
        /// Method.
        method: String,
        /// Which.
        argument: &'static str,
        /// As given.
        value: f64,
        /// Least.
        least: f64,
        /// Greatest.
        most: f64,
    },
}

/// Arguments of a method.
fn arguments(method: &str) -> &'static [&'static str] {
    match method {
        "step" => &["ticks"],
        "record_start" => &["path"],
        "snapshot" => &["before", "after", "path"],
        "seek" => &["tick"],
        "rate" => &["rate"],
        "merge" => &["bodies", "id", "continuity", "method", "tolerance"],
        "isolate" => &["bodies", "method", "gap", "max_turn"],
        _ => &[],
    }
}

impl Request {
    /// Reads the arguments of a method; no bytes count as `{}`.
    ///
    /// # Errors
    /// Too long, not JSON, an argument that this method does not have, or a value that cannot be.
    pub fn parse(method: &str, payload: &[u8]) -> Result<Self, RequestError> {
        Self::check_length(method, payload.len())?;
        let request: Self = if payload.is_empty() {
            Self::default()
        } else if payload.trim_ascii_start().first() != Some(&b'{') {
            return Err(RequestError::NotObject {
                method: method.into(),
            });
        } else {
            serde_json::from_slice(payload).map_err(|source| RequestError::Parse {
                method: method.into(),
                source,
            })?
        };
        request.checked(method)
    }

    /// What can be told before the bytes are copied.
    ///
    /// # Errors
    /// Too long.
    pub fn check_length(method: &str, bytes: usize) -> Result<(), RequestError> {
        if bytes > MAX_REQUEST_BYTES {
            return Err(RequestError::Oversized {
                method: method.into(),
                bytes,
            });
        }
        Ok(())
    }

    fn checked(self, method: &str) -> Result<Self, RequestError> {
        let known = arguments(method);
        let given = [
            ("ticks", self.ticks.is_some()),
            ("path", self.path.is_some()),
            ("before", self.before.is_some()),
            ("after", self.after.is_some()),
            ("tick", self.tick.is_some()),
            ("rate", self.rate.is_some()),
            ("bodies", self.bodies.is_some()),
            ("id", self.id.is_some()),
            ("continuity", self.continuity.is_some()),
            ("method", self.method.is_some()),
            ("tolerance", self.tolerance.is_some()),
            ("gap", self.gap.is_some()),
            ("max_turn", self.max_turn.is_some()),
        ];
        if let Some((argument, _)) = given
            .into_iter()
            .find(|(argument, given)| *given && !known.contains(argument))
        {
            let known = if known.is_empty() {
                "none".into()
            } else {
                known.join(", ")
            };
            return Err(RequestError::Foreign {
                method: method.into(),
                argument,
                known,
            });
        }
        let ranges = [
            ("before", self.before, 0.0, 86_400.0),
            ("after", self.after, 0.0, 86_400.0),
            ("rate", self.rate, 1e-3, 1e4),
            ("tolerance", self.tolerance, 1e-12, 1e3),
            ("gap", self.gap, 0.0, 1e3),
            ("max_turn", self.max_turn, 0.0, 180.0),
        ];
        for (argument, value, least, most) in ranges {
            if let Some(value) = value.filter(|value| !(least..=most).contains(value)) {
                return Err(RequestError::Range {
                    method: method.into(),
                    argument,
                    value,
                    least,
                    most,
                });
            }
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(method: &str, payload: &str) -> String {
        Request::parse(method, payload.as_bytes())
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn requests_parse_from_nothing_and_refuse_unknown_arguments() {
        assert_eq!(Request::parse("step", b"").unwrap(), Request::default());
        assert_eq!(
            Request::parse("step", b"{\"ticks\": 5}").unwrap(),
            Request {
                ticks: Some(5),
                ..Request::default()
            }
        );
        assert!(error("step", "{\"tick_count\": 5}").contains("do not parse"));
        // A list would be taken for the arguments in order.
        assert!(
            error("step", "[5]").contains("do not parse")
                && error("step", "\u{fe}").contains("do not parse")
        );
        assert!(error("step", "{\"ticks\": -5}").contains("do not parse"));
        assert!(
            error("step", "{\"tick\": 5}").contains("step has no argument \"tick\"; it has ticks")
        );
        assert!(error("reset", "{\"ticks\": 5}").contains("it has none"));
        assert!(error("rate", "{\"rate\": 0}").contains("between 0.001 and 10000"));
        assert!(
            error("isolate", "{\"continuity\": 1}")
                .contains("it has bodies, method, gap, max_turn")
        );
        assert!(error("merge", "{\"tolerance\": 0}").contains("tolerance of merge is 0"));
        assert!(error("snapshot", "{\"before\": -1}").contains("before of snapshot is -1"));
        assert!(
            error(
                "snapshot",
                &format!("{{\"path\": \"{}\"}}", "x".repeat(20_000))
            )
            .contains("at most 16384")
        );
    }
}
