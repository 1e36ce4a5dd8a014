//! Commands over queryables, one key for each method; JSON in and out, so that any tool can send
//! them.
//!
//! [`Call`] is the list of methods and their arguments. The method is the last chunk of the key,
//! the payload holds the arguments as a JSON object. [`Answer`] is what comes back.

mod answer;

pub use answer::{Answer, Done};

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Longest arguments that are read, bytes.
pub const MAX_REQUEST_BYTES: usize = 16 << 10;

/// Makes everything that is known about methods from one block each. An argument has a type, a
/// default (`= value`) or, where the method cannot do without it, an example for the error text
/// (`=> value`), and the range of a number if it has one.
macro_rules! calls {
    ($(
        $(#[$doc:meta])*
        $method:literal => $variant:ident $({ $(
            $(#[$argument_doc:meta])*
            $argument:ident: $type:ty
                $(= $default:expr)? $(=> $example:literal)? $(, $least:literal ..= $most:literal)?;
        )* })?
    )*) => {
        /// A command to a daemon: a method with its arguments.
        #[derive(Clone, Debug, PartialEq, Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Call { $(
            $(#[$doc])*
            $variant $({ $( $(#[$argument_doc])* $argument: $type ),* })?
        ),* }

        /// Methods, as the last chunk of their keys.
        pub const METHODS: &[&str] = &[$($method),*];

        impl Call {
            /// Method, as the last chunk of its key.
            pub fn method(&self) -> &'static str {
                match self { $( Self::$variant { .. } => $method ),* }
            }

            /// Names of the arguments of a method, in the order of the documentation; `None` for
            /// a method that does not exist.
            pub fn arguments_of(method: &str) -> Option<&'static [&'static str]> {
                match method {
                    $( $method => Some(&[$($( stringify!($argument) ),*)?]), )*
                    _ => None,
                }
            }

            /// The call, if its numbers are within their ranges.
            ///
            /// # Errors
            /// The first argument that is not.
            pub fn checked(self) -> Result<Self, CallError> {
                match &self { $(
                    Self::$variant $({ $( $argument ),* })? => { $($(
                        let _ = $argument;
                        $( check_range($method, stringify!($argument), $argument, $least, $most)?; )?
                    )*)? }
                )* }
                Ok(self)
            }

            fn read(method: &str, payload: &[u8]) -> Result<Self, CallError> {
                match method {
                    $( $method => {
                        // A missing argument and `null` are the same: each takes its default.
                        #[derive(Default, Deserialize)]
                        struct Arguments { $($( #[serde(default)] $argument: Option<$type> ),*)? }
                        let given: Arguments = parse($method, payload)?;
                        let _ = &given;
                        Ok(Self::$variant $({ $(
                            $argument: given.$argument
                                $(.or_else(|| Some($default)))?
                                .ok_or_else(|| missing($method, stringify!($argument), concat!("", $($example)?)))?
                        ),* })?)
                    } )*
                    _ => Err(CallError::Method { method: method.chars().take(64).collect() }),
                }
            }
        }
    };
}

calls! {
    /// State back to the scene's start; a recording that is played goes back before its first
    /// tick.
    "reset" => Reset
    /// Stop ticking; the forces fade.
    "pause" => Pause
    /// Go on after a pause.
    "resume" => Resume
    /// While paused: run a number of ticks.
    "step" => Step {
        /// How many.
        ticks: u32 = 1;
    }
    /// Fade the forces and end the daemon.
    "shutdown" => Shutdown
    /// A rigid body with a motion or a carrier goes to a place and stays there until a reset.
    "move_body" => MoveBody {
        /// Id of the body.
        body: String => "\"bowl\"";
        /// Origin of its frame, x y z, m in the world.
        position: Vec<f64> => "[0, 0, 0.1]";
        /// Of its frame, unit quaternion x y z w; unturned if absent.
        orientation: Option<Vec<f64>> = None;
        /// How long it takes, from rest to rest.
        seconds: f64 = 0.5, 0.0..=3600.0;
    }
    /// Record from the next tick on.
    "record_start" => RecordStart {
        /// File name on the daemon's machine; the daemon chooses one if absent.
        path: Option<String> = None;
    }
    /// End the recording.
    "record_stop" => RecordStop
    /// Write the last seconds kept in memory, and the next ones.
    "snapshot" => Snapshot {
        /// Seconds before now.
        before: f64 = 30.0, 0.0..=86_400.0;
        /// Seconds after now.
        after: f64 = 0.0, 0.0..=86_400.0;
        /// File name on the daemon's machine; the daemon chooses one if absent.
        path: Option<String> = None;
    }
    /// Of a recording that is played: go on from the state after a tick.
    "seek" => Seek {
        /// The tick.
        tick: u64 => 1500;
    }
    /// Of a recording that is played: set its speed.
    "rate" => Rate {
        /// Simulated over real time.
        rate: f64 => 0.5, 1e-3..=1e4;
    }
    /// One body in the place of several.
    "merge" => Merge {
        /// Ids of the bodies.
        bodies: Vec<String> = Vec::new();
        /// Id of the merged body; the ids of its parts, joined, if absent.
        id: Option<String> = None;
        /// Continuous derivatives at the seam.
        continuity: Option<u32> = None;
        /// `seed`, `constrained` or `exact`.
        method: Option<String> = None;
        /// Where bodies end on the curve in which they cross: `rows` or `lines`; the better one if absent.
        hidden: Option<String> = None;
        /// Deviation allowed, m; knots are inserted until it is met.
        tolerance: Option<f64> = None, 1e-12..=1e3;
    }
    /// Overlapping bodies moved apart.
    "isolate" => Isolate {
        /// Ids of the bodies; each moves away from those after it.
        bodies: Vec<String> = Vec::new();
        /// `1` … `7`, `local` or `global`.
        method: Option<String> = None;
        /// Gap left between the bodies, m.
        gap: Option<f64> = None, 0.0..=1e3;
        /// Greatest turn of one body about the other, degrees.
        max_turn: Option<f64> = None, 0.0..=180.0;
    }
    /// A common wall between two overlapping rigid bodies, which become parts.
    "truncate" => Truncate {
        /// Ids of the two bodies.
        bodies: Vec<String> = Vec::new();
        /// How far the wall may be from where both are equally deep, m; 1e-4 of the smaller body's size if absent.
        tolerance: Option<f64> = None, 1e-12..=1e3;
    }
    /// A body that deforms, cut by a plane: its pieces are bodies.
    "cut" => Cut {
        /// Id of the body.
        body: String => "\"jelly\"";
        /// By which plane, in the world; this or `tool`.
        plane: Option<PlaneArgument> = None;
        /// Id of a tool whose shape is a plane: it cuts where it is.
        tool: Option<String> = None;
        /// Width of what is lost in the cut, m.
        kerf: f64 = 0.0, 0.0..=1.0;
    }
}

/// A plane in the world: `{"point": [0, 0, 0.02], "normal": [0, 0, 1]}`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlaneArgument {
    /// A point of it, m.
    pub point: [f64; 3],
    /// Across it, of any length; it points to what is above.
    pub normal: [f64; 3],
}

impl Call {
    /// Reads a call; no bytes count as `{}`.
    ///
    /// # Errors
    /// A method that does not exist; arguments that are too long, not a JSON object, missing, of
    /// another method, of another type or out of range.
    pub fn parse(method: &str, payload: &[u8]) -> Result<Self, CallError> {
        Self::check_length(method, payload.len())?;
        Self::read(method, payload)?.checked()
    }

    /// What can be checked before the bytes are copied.
    ///
    /// # Errors
    /// More than [`MAX_REQUEST_BYTES`].
    pub fn check_length(method: &str, bytes: usize) -> Result<(), CallError> {
        if bytes > MAX_REQUEST_BYTES {
            let method = method.into();
            return Err(CallError::Oversized { method, bytes });
        }
        Ok(())
    }

    /// The arguments as the JSON object that [`Call::parse`] reads. Absent ones are left out.
    pub fn arguments(&self) -> Map<String, Value> {
        match serde_json::to_value(self) {
            Ok(Value::Object(call)) => match call.into_iter().next() {
                Some((_, Value::Object(mut arguments))) => {
                    arguments.retain(|_, value| !value.is_null());
                    arguments
                }
                _ => Map::new(),
            },
            _ => Map::new(),
        }
    }
}

/// Why a call was refused before anyone acted on it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CallError {
    /// No such method.
    #[error("there is no method {method:?}; there are {}", METHODS.join(", "))]
    Method {
        /// As given, shortened.
        method: String,
    },
    /// Too long.
    #[error("the arguments of {method} have {bytes} bytes; at most {MAX_REQUEST_BYTES} are read")]
    Oversized {
        /// Method.
        method: String,
        /// How many.
        bytes: usize,
    },
    /// Not JSON, or a value of another type.
    #[error("the arguments of {method} do not parse: {reason}; it takes {known}")]
    Parse {
        /// Method.
        method: &'static str,
        /// Cause.
        reason: String,
        /// Its arguments.
        known: String,
    },
    /// JSON, but not an object.
    #[error(
        "the arguments of {method} do not parse: they are a JSON object, like {{\"ticks\": 5}}; it takes {known}"
    )]
    NotObject {
        /// Method.
        method: &'static str,
        /// Its arguments.
        known: String,
    },
    /// An argument that this method does not have.
    #[error("{method} has no argument {argument:?}; it takes {known}")]
    Foreign {
        /// Method.
        method: &'static str,
        /// As given, shortened.
        argument: String,
        /// What there is.
        known: String,
    },
    /// An argument without which the method does nothing.
    #[error("{method} needs its argument {argument:?}, for example {{\"{argument}\": {example}}}")]
    Missing {
        /// Method.
        method: &'static str,
        /// Which.
        argument: &'static str,
        /// A value.
        example: &'static str,
    },
    /// A number out of its range.
    #[error("{argument} of {method} is {value}; it must be between {least} and {most}")]
    Range {
        /// Method.
        method: &'static str,
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

fn known(method: &str) -> String {
    match Call::arguments_of(method) {
        None | Some([]) => "no arguments".into(),
        Some(arguments) => arguments.join(", "),
    }
}

fn parse<A: for<'de> Deserialize<'de> + Default>(
    method: &'static str,
    payload: &[u8],
) -> Result<A, CallError> {
    let refused = |error: serde_json::Error| CallError::Parse {
        method,
        reason: error.to_string(),
        known: known(method),
    };
    if payload.is_empty() {
        return Ok(A::default());
    }
    if payload.trim_ascii_start().first() != Some(&b'{') {
        let known = known(method);
        return Err(CallError::NotObject { method, known });
    }
    let names: Map<String, Value> = serde_json::from_slice(payload).map_err(refused)?;
    let own = Call::arguments_of(method).unwrap_or_default();
    if let Some(argument) = names.keys().find(|name| !own.contains(&name.as_str())) {
        return Err(CallError::Foreign {
            method,
            argument: argument.chars().take(64).collect(),
            known: known(method),
        });
    }
    serde_json::from_slice(payload).map_err(refused)
}

fn missing(method: &'static str, argument: &'static str, example: &'static str) -> CallError {
    CallError::Missing {
        method,
        argument,
        example,
    }
}

/// A number that may be absent.
trait Number {
    fn number(&self) -> Option<f64>;
}

impl Number for f64 {
    fn number(&self) -> Option<f64> {
        Some(*self)
    }
}

impl Number for Option<f64> {
    fn number(&self) -> Option<f64> {
        *self
    }
}

fn check_range(
    method: &'static str,
    argument: &'static str,
    value: &impl Number,
    least: f64,
    most: f64,
) -> Result<(), CallError> {
    match value.number() {
        Some(value) if !(least..=most).contains(&value) => Err(CallError::Range {
            method,
            argument,
            value,
            least,
            most,
        }),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(method: &str, payload: &str) -> String {
        Call::parse(method, payload.as_bytes())
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn calls_parse_from_nothing_and_refuse_unknown_arguments_with_their_own() {
        assert_eq!(Call::parse("step", b"").unwrap(), Call::Step { ticks: 1 });
        for payload in ["{\"ticks\": 5}", " {\"ticks\":5} "] {
            assert_eq!(
                Call::parse("step", payload.as_bytes()).unwrap(),
                Call::Step { ticks: 5 }
            );
        }
        // `null` is an argument left out.
        assert_eq!(
            Call::parse("step", b"{\"ticks\": null}").unwrap(),
            Call::Step { ticks: 1 }
        );
        assert!(
            error("step", "{\"tick\": 5}")
                .contains("step has no argument \"tick\"; it takes ticks")
        );
        assert!(error("reset", "{\"ticks\": 5}").contains("it takes no arguments"));
        assert!(
            error("isolate", "{\"continuity\": 1}")
                .contains("it takes bodies, method, gap, max_turn")
        );
        assert!(error("fly", "").contains("there are reset, "));
    }

    #[test]
    fn what_does_not_parse_is_out_of_range_or_missing_is_named() {
        // A list would be taken for the arguments in order.
        for payload in [
            "[5]",
            "\u{fe}",
            "{\"ticks\": -5}",
            "{\"ticks\": 1, \"ticks\": 2}",
        ] {
            let error = error("step", payload);
            assert!(
                error.contains("do not parse") && error.contains("takes ticks"),
                "{error}"
            );
        }
        assert!(error("rate", "{\"rate\": 0}").contains("between 0.001 and 10000"));
        assert!(error("merge", "{\"tolerance\": 0}").contains("tolerance of merge is 0"));
        assert!(error("snapshot", "{\"before\": -1}").contains("before of snapshot is -1"));
        assert!(
            error("cut", "{\"body\": \"a\", \"kerf\": -1e-4}").contains("kerf of cut is -0.0001")
        );
        for plane in [
            "{\"point\": [0, 0, 0]}",
            "{\"point\": [0, 0], \"normal\": [0, 0, 1]}",
            "{\"point\": [0, 0, null], \"normal\": [0, 0, 1]}",
            "{\"point\": [0, 0, 1e999], \"normal\": [0, 0, 1]}",
            "{\"point\": [0, 0, 0], \"normal\": [0, 0, 1], \"width\": 1}",
        ] {
            let error = error("cut", &format!("{{\"body\": \"a\", \"plane\": {plane}}}"));
            assert!(
                error.contains("the arguments of cut do not parse"),
                "{error}"
            );
        }
        assert!(
            error("seek", "")
                .contains("seek needs its argument \"tick\", for example {\"tick\": 1500}")
        );
        let long = format!("{{\"path\": \"{}\"}}", "x".repeat(20_000));
        assert!(error("snapshot", &long).contains("at most 16384"));
    }

    #[test]
    fn every_call_comes_back_from_its_method_and_arguments() {
        let bodies = || vec!["a".to_owned(), "b".to_owned()];
        let calls = [
            Call::Reset,
            Call::Step { ticks: 7 },
            Call::RecordStart { path: None },
            Call::Snapshot {
                before: 2.5,
                after: 0.25,
                path: Some("s.mcap".into()),
            },
            Call::Seek { tick: u64::MAX },
            Call::Rate { rate: 0.1 },
            Call::Merge {
                bodies: bodies(),
                id: None,
                continuity: Some(1),
                method: None,
                hidden: Some("lines".into()),
                tolerance: Some(1e-4),
            },
            Call::Isolate {
                bodies: bodies(),
                method: Some("global".into()),
                gap: None,
                max_turn: Some(30.0),
            },
            Call::Truncate {
                bodies: bodies(),
                tolerance: Some(1e-5),
            },
            Call::Cut {
                body: "a".into(),
                plane: Some(PlaneArgument {
                    point: [0.0, 0.01, 0.02],
                    normal: [0.0, 0.0, 2.0],
                }),
                tool: None,
                kerf: 1e-4,
            },
            Call::Cut {
                body: "a".into(),
                plane: None,
                tool: Some("knife".into()),
                kerf: 0.0,
            },
        ];
        for call in calls {
            let payload = serde_json::to_vec(&call.arguments()).unwrap();
            assert_eq!(Call::parse(call.method(), &payload).unwrap(), call);
        }
        assert_eq!(Call::RecordStart { path: None }.arguments(), Map::new());
        assert!(Call::Rate { rate: f64::NAN }.checked().is_err());
    }

    /// The table of methods in docs/wire.md names every method and every argument.
    #[test]
    fn every_method_and_argument_is_documented() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/wire.md");
        let document = std::fs::read_to_string(path).unwrap();
        let section = document.split("## RPC").nth(1).unwrap();
        let section = section.split("## Layouts").next().unwrap();
        for method in METHODS {
            let rows: Vec<&str> = section
                .lines()
                .filter(|line| line.starts_with('|') && line.contains(&format!("`{method}`")))
                .collect();
            assert!(!rows.is_empty(), "no row of {method}");
            for argument in Call::arguments_of(method).unwrap_or_default() {
                assert!(
                    rows.iter()
                        .any(|row| row.contains(&format!("\"{argument}\": "))),
                    "{argument} of {method} is not in its row"
                );
            }
        }
    }
}
