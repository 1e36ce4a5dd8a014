//! The Haply Inverse Service: JSON over a WebSocket, a state for each message.
//!
//! Source: docs.haply.co, Inverse SDK 3.5, "WebSocket protocol". Metres, m/s, newtons. On connect the
//! service sends all that it has; afterwards exactly one state for each message it gets. It keeps no
//! command: a device whose program stops is idle.

use crate::link::Reading;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// A vector.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Xyz {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
    /// Along z.
    pub z: f64,
}

impl From<[f64; 3]> for Xyz {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl From<Xyz> for [f64; 3] {
    fn from(Xyz { x, y, z }: Xyz) -> Self {
        [x, y, z]
    }
}

/// A quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wxyz {
    /// Scalar part.
    pub w: f64,
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
    /// Along z.
    pub z: f64,
}

impl From<[f64; 4]> for Wxyz {
    /// From x y z w.
    fn from([x, y, z, w]: [f64; 4]) -> Self {
        Self { w, x, y, z }
    }
}

impl From<Wxyz> for [f64; 4] {
    /// To x y z w.
    fn from(Wxyz { w, x, y, z }: Wxyz) -> Self {
        [x, y, z, w]
    }
}

/// Why a message of the service is of no use.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HaplyError {
    /// Not such JSON.
    #[error("this is no message of the Inverse Service: {0}")]
    Json(String),
    /// No device is connected.
    #[error("the Inverse Service has no Inverse3: plug it in and wake it up")]
    NoDevice,
    /// More than one, and none was named.
    #[error("the Inverse Service has several devices ({}): name one with --device-id", known.join(", "))]
    Several {
        /// What there is.
        known: Vec<String>,
    },
    /// Not the one that was named.
    #[error("the Inverse Service has no device {wanted:?}; it has {}", known.join(", "))]
    Unknown {
        /// The device id that was asked for.
        wanted: String,
        /// What there is.
        known: Vec<String>,
    },
    /// A snapshot without a state.
    #[error("device {0:?} has no state")]
    NoState(String),
}

#[derive(Debug, Deserialize)]
struct StateMessage {
    #[serde(default)]
    inverse3: Vec<InverseEntry>,
    #[serde(default)]
    wireless_verse_grip: Vec<GripEntry>,
}

#[derive(Debug, Deserialize)]
struct InverseEntry {
    device_id: String,
    state: Option<InverseState>,
}

#[derive(Debug, Deserialize)]
struct InverseState {
    cursor_position: Xyz,
    cursor_velocity: Option<Xyz>,
    body_orientation: Option<Wxyz>,
}

#[derive(Debug, Deserialize)]
struct GripEntry {
    state: Option<GripState>,
}

#[derive(Debug, Deserialize)]
struct GripState {
    orientation: Option<Wxyz>,
    #[serde(default)]
    buttons: Buttons,
}

/// Buttons of a grip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Buttons {
    /// Grabs while it is held.
    pub a: bool,
    /// Clutch, where one is asked for.
    pub b: bool,
    /// Free for use.
    pub c: bool,
}

impl Buttons {
    /// a, b and c as bits 0, 1 and 2.
    pub fn bits(self) -> u32 {
        u32::from(self.a) | u32::from(self.b) << 1 | u32::from(self.c) << 2
    }
}

/// Reads a state: the id of the device and what it says. `wanted` names it where there are several.
///
/// # Errors
/// Not a state, or not of that device.
pub fn read_state(
    text: &str,
    wanted: Option<&str>,
    time_ns: u64,
) -> Result<(String, Reading), HaplyError> {
    let message: StateMessage =
        serde_json::from_str(text).map_err(|error| HaplyError::Json(error.to_string()))?;
    let known = || -> Vec<String> {
        let ids = message.inverse3.iter();
        ids.map(|entry| entry.device_id.clone()).collect()
    };
    let entry = match (wanted, message.inverse3.as_slice()) {
        (_, []) => return Err(HaplyError::NoDevice),
        (None, [entry]) => entry,
        (None, _) => return Err(HaplyError::Several { known: known() }),
        (Some(wanted), all) => all
            .iter()
            .find(|entry| entry.device_id == wanted)
            .ok_or_else(|| HaplyError::Unknown {
                wanted: wanted.to_owned(),
                known: known(),
            })?,
    };
    let Some(state) = &entry.state else {
        return Err(HaplyError::NoState(entry.device_id.clone()));
    };
    let grip = message.wireless_verse_grip.first();
    let grip = grip.and_then(|grip| grip.state.as_ref());
    let orientation = grip
        .and_then(|grip| grip.orientation)
        .or(state.body_orientation);
    Ok((
        entry.device_id.clone(),
        Reading {
            position: state.cursor_position.into(),
            orientation: orientation.map_or([0.0, 0.0, 0.0, 1.0], Into::into),
            velocity: state
                .cursor_velocity
                .map(|velocity| [velocity.into(), [0.0; 3]]),
            buttons: grip.map_or(0, |grip| grip.buttons.bits()),
            time_ns,
        },
    ))
}

/// A force for a device. The first message of a session names its profile.
pub fn force_message(device_id: &str, force: [f64; 3], profile: Option<&str>) -> String {
    let mut message = json!({
        "inverse3": [{
            "device_id": device_id,
            "commands": { "set_cursor_force": { "vector": Xyz::from(force) } },
        }],
    });
    if let Some(name) = profile {
        message["session"] = json!({ "configure": { "profile": { "name": name } } });
    }
    message.to_string()
}

/// What the service says of one device with a grip.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceState {
    /// `049D`.
    pub device_id: String,
    /// Of the grip.
    pub grip_id: String,
    /// m.
    pub position: [f64; 3],
    /// m/s.
    pub velocity: [f64; 3],
    /// x y z w.
    pub orientation: [f64; 4],
    /// Of the grip.
    pub buttons: Buttons,
    /// The force that acts, N.
    pub force: [f64; 3],
}

/// A state as the service sends it; the first one of a connection with the configuration.
pub fn state_message(states: &[DeviceState], first: Option<u64>) -> String {
    let inverse3: Vec<Value> = states
        .iter()
        .map(|state| inverse3(state, first.is_some()))
        .collect();
    let grips = states.iter().map(|state| {
        json!({
            "device_id": state.grip_id,
            "state": {
                "orientation": Wxyz::from(state.orientation),
                "buttons": state.buttons,
                "hall": 0,
                "battery_level": 1.0,
            },
            "status": { "connected": true, "awake": true },
        })
    });
    let mut message = json!({
        "inverse3": inverse3,
        "wireless_verse_grip": grips.collect::<Vec<_>>(),
    });
    if let Some(session) = first {
        message["session_id"] = json!(session);
    }
    message.to_string()
}

fn inverse3(state: &DeviceState, whole: bool) -> Value {
    let unturned = Wxyz::from([0.0, 0.0, 0.0, 1.0]);
    let active = state.force != [0.0; 3];
    let mut entry = json!({
        "device_id": state.device_id,
        "state": {
            "cursor_position": Xyz::from(state.position),
            "cursor_velocity": Xyz::from(state.velocity),
            "angular_position": { "a0": 0.0, "a1": 0.0, "a2": 0.0 },
            "angular_velocity": { "a0": 0.0, "a1": 0.0, "a2": 0.0 },
            "body_orientation": unturned,
            "current_cursor_force": Xyz::from(state.force),
            "current_cursor_position": Xyz::from(state.position),
            "control_domain": "cartesian",
            "control_mode": if active { "force" } else { "idle" },
        },
        "status": { "calibrated": true, "in_use": true, "power_supply": true, "ready": true },
    });
    if whole {
        entry["config"] = json!({
            "type": "inverse3",
            "device_info": { "id": state.device_id, "device_type": 4 },
            "handedness": "right",
            "streaming_mode": "simulated",
            "gravity_compensation": { "enabled": true, "scaling_factor": 1.0 },
            "basis": { "permutation": "XYZ" },
        });
    }
    entry
}

/// Forces that a program commands, by device. Anything else in the message is left: sessions, probes,
/// configurations. Version 3.1 says `values` for `vector`; both are read.
///
/// # Errors
/// Not JSON, or a force that is none.
pub fn read_forces(text: &str) -> Result<Vec<(String, [f64; 3])>, HaplyError> {
    #[derive(Deserialize)]
    struct Message {
        #[serde(default)]
        inverse3: Vec<Entry>,
    }
    #[derive(Deserialize)]
    struct Entry {
        #[serde(default)]
        device_id: String,
        #[serde(default)]
        commands: Commands,
    }
    #[derive(Default, Deserialize)]
    struct Commands {
        set_cursor_force: Option<Force>,
    }
    #[derive(Deserialize)]
    struct Force {
        #[serde(alias = "values")]
        vector: Xyz,
    }
    let message: Message =
        serde_json::from_str(text).map_err(|error| HaplyError::Json(error.to_string()))?;
    let force = |entry: Entry| {
        let force = entry.commands.set_cursor_force?;
        Some((entry.device_id, force.vector.into()))
    };
    Ok(message.inverse3.into_iter().filter_map(force).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abridged from the vendor's page.
    const STATE: &str = r#"{"inverse3":[{"device_id":"049D","state":{
        "cursor_position":{"x":0.01,"y":-0.12,"z":0.15},"cursor_velocity":{"x":0.5,"y":0.0,"z":-0.25},
        "body_orientation":{"w":1.0,"x":0.0,"y":0.0,"z":0.0},"current_cursor_force":{"x":0,"y":0,"z":0}},
        "status":{"calibrated":true}}],
        "wireless_verse_grip":[{"device_id":"61548","state":{
        "orientation":{"w":0.8,"x":0.0,"y":0.6,"z":0.0},"buttons":{"a":true,"b":false,"c":true}}}]}"#;

    #[test]
    fn a_state_of_the_vendors_page_is_a_reading() {
        let (id, reading) = read_state(STATE, None, 7).unwrap();
        assert_eq!(id, "049D");
        assert_eq!(reading.position, [0.01, -0.12, 0.15]);
        assert_eq!(reading.orientation, [0.0, 0.6, 0.0, 0.8]);
        assert_eq!(reading.velocity, Some([[0.5, 0.0, -0.25], [0.0; 3]]));
        assert_eq!((reading.buttons, reading.time_ns), (0b101, 7));
    }

    #[test]
    fn a_device_without_grip_has_the_orientation_of_its_body() {
        let mut message: Value = serde_json::from_str(STATE).unwrap();
        message["wireless_verse_grip"] = json!([]);
        let (_, reading) = read_state(&message.to_string(), None, 0).unwrap();
        assert_eq!(
            (reading.orientation, reading.buttons),
            ([0.0, 0.0, 0.0, 1.0], 0)
        );
    }

    #[test]
    fn two_devices_must_be_told_apart_and_an_unknown_one_is_named() {
        let mut message: Value = serde_json::from_str(STATE).unwrap();
        let mut other = message["inverse3"][0].clone();
        other["device_id"] = json!("04A0");
        message["inverse3"].as_array_mut().unwrap().push(other);
        let two = message.to_string();
        let known = vec!["049D".to_owned(), "04A0".to_owned()];
        assert_eq!(
            read_state(&two, None, 0),
            Err(HaplyError::Several {
                known: known.clone()
            })
        );
        assert_eq!(read_state(&two, Some("04A0"), 0).unwrap().0, "04A0");
        let wanted = "FFFF".to_owned();
        assert_eq!(
            read_state(&two, Some("FFFF"), 0),
            Err(HaplyError::Unknown { wanted, known })
        );
        assert_eq!(read_state("{}", None, 0), Err(HaplyError::NoDevice));
    }

    #[test]
    fn half_a_message_is_an_error() {
        for cut in 1..STATE.len() - 1 {
            assert!(matches!(
                read_state(&STATE[..cut], None, 0),
                Err(HaplyError::Json(_))
            ));
        }
    }

    #[test]
    fn forces_of_both_versions_are_read_bit_for_bit() {
        let force = [0.1 + 0.2, -1e-300, 1.5];
        let ours = force_message("049D", force, Some("palpate"));
        assert!(ours.contains(r#""profile":{"name":"palpate"}"#), "{ours}");
        for text in [ours.clone(), ours.replace("vector", "values")] {
            let read = read_forces(&text).unwrap();
            assert_eq!(read[0].0, "049D");
            assert_eq!(read[0].1.map(f64::to_bits), force.map(f64::to_bits));
        }
        assert_eq!(read_forces(r#"{"session":{}}"#), Ok(Vec::new()));
        let probe = r#"{"inverse3":[{"device_id":"049D","commands":{"probe_position":{}}}]}"#;
        assert_eq!(read_forces(probe), Ok(Vec::new()));
        assert!(
            read_forces(r#"{"inverse3":[{"commands":{"set_cursor_force":{"vector":{"x":1}}}}]}"#)
                .is_err()
        );
    }

    #[test]
    fn a_service_and_a_program_understand_each_other() {
        let state = DeviceState {
            device_id: "SIM0".into(),
            grip_id: "SIM1".into(),
            position: [0.1 + 0.2, -0.0, 1e-9],
            velocity: [1.0, 2.0, 3.0],
            orientation: [0.0, 0.6, 0.0, 0.8],
            buttons: Buttons {
                a: true,
                ..Buttons::default()
            },
            force: [0.0; 3],
        };
        for first in [Some(1), None] {
            let text = state_message(std::slice::from_ref(&state), first);
            let (id, reading) = read_state(&text, None, 0).unwrap();
            assert_eq!(id, "SIM0");
            assert_eq!(
                reading.position.map(f64::to_bits),
                state.position.map(f64::to_bits)
            );
            assert_eq!(
                (reading.orientation, reading.buttons),
                (state.orientation, 1)
            );
        }
    }
}
