//! What comes back from a command.

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::Value;

/// What comes back from a command. `R` is the type of its report; any JSON if nothing else is
/// said.
///
/// On the wire `{"ok": true, "tick": 1234, "path": …, "report": …}` without what is absent, or
/// `{"ok": false, "error": "…"}`.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer<R = Value> {
    /// It was carried out.
    Done(Done<R>),
    /// It was refused; nothing changed.
    Refused {
        /// Why.
        error: String,
    },
}

/// What a command did.
#[derive(Clone, Debug, PartialEq)]
pub struct Done<R = Value> {
    /// First tick on which it had effect; for a recording that ended, its last.
    pub tick: u64,
    /// File that was begun or finished.
    pub path: Option<String>,
    /// Figures of a merge, the translation of an isolation.
    pub report: Option<R>,
}

impl<R> Answer<R> {
    /// Carried out, with effect from a tick on.
    pub fn at(tick: u64) -> Self {
        Self::Done(Done {
            tick,
            path: None,
            report: None,
        })
    }

    /// Carried out, with a file to name.
    pub fn with_path(tick: u64, path: impl Into<String>) -> Self {
        Self::Done(Done {
            tick,
            path: Some(path.into()),
            report: None,
        })
    }

    /// Carried out, with a report.
    pub fn with_report(tick: u64, report: R) -> Self {
        Self::Done(Done {
            tick,
            path: None,
            report: Some(report),
        })
    }

    /// Not carried out.
    pub fn refused(error: impl Into<String>) -> Self {
        Self::Refused {
            error: error.into(),
        }
    }

    /// As a result; the error is the reason of the refusal.
    ///
    /// # Errors
    /// It was refused.
    pub fn into_result(self) -> Result<Done<R>, String> {
        match self {
            Self::Done(done) => Ok(done),
            Self::Refused { error } => Err(error),
        }
    }
}

/// An answer as it is written.
#[derive(Serialize, Deserialize)]
struct Flat<R> {
    ok: bool,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tick: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    path: Option<String>,
    #[serde(default = "Option::default", skip_serializing_if = "Option::is_none")]
    report: Option<R>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

impl<R: Serialize> Serialize for Answer<R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let flat = match self {
            Self::Done(done) => Flat {
                ok: true,
                tick: Some(done.tick),
                path: done.path.clone(),
                report: done.report.as_ref(),
                error: None,
            },
            Self::Refused { error } => Flat {
                ok: false,
                tick: None,
                path: None,
                report: None,
                error: Some(error.clone()),
            },
        };
        flat.serialize(serializer)
    }
}

impl<'de, R: Deserialize<'de>> Deserialize<'de> for Answer<R> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let flat = Flat::deserialize(deserializer)?;
        if !flat.ok {
            let error = flat.error.unwrap_or_else(|| "no reason given".into());
            return Ok(Self::Refused { error });
        }
        let tick = flat
            .tick
            .ok_or_else(|| serde::de::Error::missing_field("tick"))?;
        Ok(Self::Done(Done {
            tick,
            path: flat.path,
            report: flat.report,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_written_without_what_is_absent_and_read_back() {
        let text = |answer: &Answer| serde_json::to_string(answer).unwrap();
        let answers: [(Answer, &str); 4] = [
            (Answer::at(7), r#"{"ok":true,"tick":7}"#),
            (
                Answer::with_path(7, "a.mcap"),
                r#"{"ok":true,"tick":7,"path":"a.mcap"}"#,
            ),
            (
                Answer::with_report(7, serde_json::json!({"id": "ab"})),
                r#"{"ok":true,"tick":7,"report":{"id":"ab"}}"#,
            ),
            (
                Answer::refused("too late"),
                r#"{"ok":false,"error":"too late"}"#,
            ),
        ];
        for (answer, written) in answers {
            assert_eq!(text(&answer), written);
            assert_eq!(serde_json::from_str::<Answer>(written).unwrap(), answer);
        }
        assert!(serde_json::from_str::<Answer>(r#"{"ok":true}"#).is_err());
    }
}
