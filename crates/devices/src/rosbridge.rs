//! The part of the rosbridge v2 protocol that a haptic server needs, as JSON.
//!
//! `advertise`, `publish`, `subscribe`, `call_service` and their opposites come in; `publish`,
//! `service_response` and `status` go out. Source: RobotWebTools/rosbridge_suite, `ROSBRIDGE_PROTOCOL.md`.
//! Stamps may be written as in ROS 1 (`secs`, `nsecs`) or ROS 2 (`sec`, `nanosec`).

use serde::Deserialize;
use serde_json::{Value, json};

/// What a client asks for.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(tag = "op", rename_all = "snake_case")]
pub enum Request {
    /// The client will publish on a topic.
    Advertise {
        /// Name of the ROS topic.
        topic: String,
        /// Type of its messages.
        #[serde(rename = "type")]
        kind: String,
        /// For the answer, if there is one.
        id: Option<String>,
    },
    /// The client no longer publishes on a topic.
    Unadvertise {
        /// Name of the ROS topic.
        topic: String,
        /// For the answer, if there is one.
        id: Option<String>,
    },
    /// A message of the client.
    Publish {
        /// Name of the ROS topic.
        topic: String,
        /// The message.
        msg: Value,
        /// For the answer, if there is one.
        id: Option<String>,
    },
    /// The client wants the messages of a topic.
    Subscribe {
        /// Name of the ROS topic.
        topic: String,
        /// Type of its messages, if the client says it.
        #[serde(rename = "type")]
        kind: Option<String>,
        /// Least time between two messages, ms.
        #[serde(default)]
        throttle_rate: f64,
        /// Messages that may wait for a client that is throttled; the oldest are dropped.
        #[serde(default)]
        queue_length: usize,
        /// `none`, or what is not spoken.
        compression: Option<String>,
        /// Names the subscription.
        id: Option<String>,
    },
    /// The client no longer wants the messages of a topic.
    Unsubscribe {
        /// Name of the ROS topic.
        topic: String,
        /// The subscription; all of this topic if there is no `id`.
        id: Option<String>,
    },
    /// The client calls a service.
    CallService {
        /// Name of the service.
        service: String,
        /// Its arguments.
        #[serde(default)]
        args: Value,
        /// For the answer.
        id: Option<String>,
    },
    /// Which status messages the client wants; all are sent whatever it asks.
    SetLevel {
        /// `info`, `warning`, `error` or `none`.
        level: String,
    },
}

/// Why a frame or a message was not taken.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RosbridgeError {
    /// Not a request.
    #[error("not a request of rosbridge: {0}")]
    Request(String),
    /// A field of a message.
    #[error("{field} of the message is missing or of another kind; {expected}")]
    Field {
        /// Its path.
        field: &'static str,
        /// What would do.
        expected: &'static str,
    },
}

/// Reads a frame.
///
/// # Errors
/// It is not JSON, or not a request that is spoken.
pub fn read_request(text: &str) -> Result<Request, RosbridgeError> {
    serde_json::from_str(text).map_err(|error| RosbridgeError::Request(error.to_string()))
}

/// The same type, written as in ROS 1 or in ROS 2.
pub fn same_type(ours: &str, theirs: &str) -> bool {
    let plain = |name: &str| name.replace("/msg/", "/").replace("/srv/", "/");
    plain(ours) == plain(theirs)
}

/// A pose with what its header says.
#[derive(Clone, Debug, PartialEq)]
pub struct JsonPose {
    /// m.
    pub position: [f64; 3],
    /// Quaternion x y z w.
    pub orientation: [f64; 4],
    /// Time of the stamp, ns; `None` without a stamp.
    pub stamp_ns: Option<u64>,
    /// Empty when it is not said.
    pub frame: String,
}

/// Reads a `geometry_msgs/PoseStamped`.
///
/// # Errors
/// A number that is missing.
pub fn read_pose(msg: &Value) -> Result<JsonPose, RosbridgeError> {
    let missing = |field, expected| RosbridgeError::Field { field, expected };
    let pose = &msg["pose"];
    let position = numbers(&pose["position"], ["x", "y", "z"])
        .ok_or(missing("pose.position", "it has the numbers x, y and z"))?;
    let orientation = numbers(&pose["orientation"], ["x", "y", "z", "w"]).ok_or(missing(
        "pose.orientation",
        "it has the numbers x, y, z and w",
    ))?;
    let frame = msg["header"]["frame_id"].as_str().unwrap_or_default();
    Ok(JsonPose {
        position,
        orientation,
        stamp_ns: stamp_ns(&msg["header"]["stamp"]),
        frame: frame.to_owned(),
    })
}

/// Reads a `geometry_msgs/TwistStamped`: linear and angular velocity, m/s and rad/s.
///
/// # Errors
/// A number that is missing.
pub fn read_twist(msg: &Value) -> Result<[[f64; 3]; 2], RosbridgeError> {
    let part = |field, name: &str| {
        let expected = "it has the numbers x, y and z";
        numbers(&msg["twist"][name], ["x", "y", "z"])
            .ok_or(RosbridgeError::Field { field, expected })
    };
    Ok([
        part("twist.linear", "linear")?,
        part("twist.angular", "angular")?,
    ])
}

/// Reads the buttons of a `sensor_msgs/Joy` (a list), a `std_msgs/Bool` or an
/// `omni_msgs/OmniButtonEvent`: bit k is button k.
///
/// # Errors
/// None of these.
pub fn read_buttons(msg: &Value) -> Result<u32, RosbridgeError> {
    let bit = |value: &Value| value.as_bool().or_else(|| value.as_f64().map(|x| x != 0.0));
    let bits = |values: &[&Value]| {
        let down = values.iter().take(32).enumerate();
        down.map(|(k, value)| bit(value).map(|down| u32::from(down) << k))
            .try_fold(0, |bits, one| one.map(|one| bits | one))
    };
    let read = match (&msg["buttons"], &msg["data"], &msg["grey_button"]) {
        (Value::Array(buttons), _, _) => bits(&buttons.iter().collect::<Vec<_>>()),
        (_, Value::Null, grey) => bits(&[grey, &msg["white_button"]]),
        (_, data, _) => bits(&[data]),
    };
    read.ok_or(RosbridgeError::Field {
        field: "buttons",
        expected: "a list of 0 and 1, or data with true or false",
    })
}

fn numbers<const N: usize>(object: &Value, names: [&str; N]) -> Option<[f64; N]> {
    let mut values = [0.0; N];
    for (value, name) in values.iter_mut().zip(names) {
        *value = object[name].as_f64()?;
    }
    Some(values)
}

fn stamp_ns(stamp: &Value) -> Option<u64> {
    let part = |names: [&str; 2]| names.iter().find_map(|name| stamp[*name].as_u64());
    let seconds = part(["sec", "secs"])?;
    let rest = part(["nanosec", "nsecs"]).unwrap_or(0);
    seconds.checked_mul(1_000_000_000)?.checked_add(rest)
}

fn stamp(ns: u64) -> Value {
    json!({ "sec": ns / 1_000_000_000, "nanosec": ns % 1_000_000_000 })
}

fn vector([x, y, z]: [f64; 3]) -> Value {
    json!({ "x": x, "y": y, "z": z })
}

/// A `geometry_msgs/WrenchStamped`: N and N·m.
pub fn wrench(time_ns: u64, frame: &str, force: [f64; 3], torque: [f64; 3]) -> Value {
    json!({
        "header": { "stamp": stamp(time_ns), "frame_id": frame },
        "wrench": { "force": vector(force), "torque": vector(torque) },
    })
}

/// A `geometry_msgs/Wrench`: N and N·m.
pub fn plain_wrench(force: [f64; 3], torque: [f64; 3]) -> Value {
    json!({ "force": vector(force), "torque": vector(torque) })
}

/// A `geometry_msgs/Vector3Stamped`.
pub fn vector_stamped(time_ns: u64, frame: &str, value: [f64; 3]) -> Value {
    json!({
        "header": { "stamp": stamp(time_ns), "frame_id": frame },
        "vector": vector(value),
    })
}

/// A `std_msgs/Float64MultiArray`.
pub fn array(values: [f64; 3]) -> Value {
    json!({ "layout": { "dim": [], "data_offset": 0 }, "data": values })
}

/// An `omni_msgs/OmniFeedback`.
pub fn omni_feedback(force: [f64; 3]) -> Value {
    json!({ "force": vector(force), "position": vector([0.0; 3]) })
}

/// A message for a subscriber.
pub fn publish(topic: &str, msg: &Value) -> String {
    json!({ "op": "publish", "topic": topic, "msg": msg }).to_string()
}

/// The answer of a service. `values`: its response, or why there is none.
pub fn service_response(service: &str, id: Option<&str>, values: Result<Value, String>) -> String {
    let (result, values) = match values {
        Ok(values) => (true, values),
        Err(why) => (false, Value::String(why)),
    };
    let mut answer = json!({
        "op": "service_response", "service": service, "values": values, "result": result,
    });
    if let Some(id) = id {
        answer["id"] = id.into();
    }
    answer.to_string()
}

/// Tells a client what it did wrong.
pub fn status(id: Option<&str>, words: &str) -> String {
    let mut status = json!({ "op": "status", "level": "error", "msg": words });
    if let Some(id) = id {
        status["id"] = id.into();
    }
    status.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read_as_roslib_writes_them() {
        let advertise = r#"{"op":"advertise","id":"advertise:/a:1","type":"geometry_msgs/PoseStamped","topic":"/a",
            "latch":false,"queue_size":100}"#;
        assert!(matches!(
            read_request(advertise),
            Ok(Request::Advertise { topic, kind, .. })
                if topic == "/a" && same_type("geometry_msgs/msg/PoseStamped", &kind)
        ));
        let subscribe = r#"{"op":"subscribe","id":"s","type":"geometry_msgs/WrenchStamped","topic":"/f",
            "compression":"none","throttle_rate":5,"queue_length":2}"#;
        assert!(matches!(
            read_request(subscribe),
            Ok(Request::Subscribe { throttle_rate, queue_length: 2, .. }) if throttle_rate == 5.0
        ));
        let call = r#"{"op":"call_service","id":"c","service":"/palpate/pause","args":{}}"#;
        assert!(matches!(
            read_request(call),
            Ok(Request::CallService { .. })
        ));
        for wrong in [
            "",
            "[]",
            "{}",
            r#"{"op":"publish"}"#,
            r#"{"op":"png","data":""}"#,
            r#"{"op":"subscribe","topic":7}"#,
            r#"{"op":"subscribe","topic":"/f","queue_length":-1}"#,
        ] {
            assert!(read_request(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn poses_have_stamps_of_either_ros_or_none() {
        let pose = |stamp: Value| {
            json!({
                "header": { "frame_id": "base", "stamp": stamp },
                "pose": {
                    "position": { "x": 1, "y": -2.5, "z": 0.03 },
                    "orientation": { "x": 0, "y": 0.6, "z": 0, "w": 0.8 },
                },
            })
        };
        let read = |stamp| read_pose(&pose(stamp)).unwrap();
        let two = read(json!({ "sec": 3, "nanosec": 5 }));
        assert_eq!(
            (two.position, two.orientation),
            ([1.0, -2.5, 0.03], [0.0, 0.6, 0.0, 0.8])
        );
        assert_eq!(
            (two.stamp_ns, two.frame.as_str()),
            (Some(3_000_000_005), "base")
        );
        assert_eq!(
            read(json!({ "secs": 3, "nsecs": 5 })).stamp_ns,
            two.stamp_ns
        );
        assert_eq!(read(Value::Null).stamp_ns, None);
        assert_eq!(
            read(json!({ "sec": u64::MAX, "nanosec": 1 })).stamp_ns,
            None
        );
    }

    #[test]
    fn a_message_that_is_not_whole_is_named_by_its_field() {
        for (text, field) in [
            ("{}", "pose.position"),
            ("7", "pose.position"),
            (r#"{"pose":{"position":{"x":1,"y":2}}}"#, "pose.position"),
            (
                r#"{"pose":{"position":{"x":1,"y":2,"z":"3"}}}"#,
                "pose.position",
            ),
            (
                r#"{"pose":{"position":{"x":1,"y":2,"z":3}}}"#,
                "pose.orientation",
            ),
        ] {
            let error = read_pose(&serde_json::from_str(text).unwrap()).unwrap_err();
            assert!(error.to_string().starts_with(field), "{text}: {error}");
        }
        assert!(read_twist(&json!({ "twist": { "linear": {} } })).is_err());
    }

    #[test]
    fn buttons_are_bits_in_every_form() {
        assert_eq!(read_buttons(&json!({ "buttons": [1, 0, 1] })), Ok(5));
        assert_eq!(read_buttons(&json!({ "data": true })), Ok(1));
        let omni = json!({ "grey_button": 0, "white_button": 1 });
        assert_eq!(read_buttons(&omni), Ok(2));
        assert_eq!(read_buttons(&json!({ "buttons": [] })), Ok(0));
        assert!(read_buttons(&json!({ "buttons": ["a"] })).is_err());
        assert!(read_buttons(&json!({})).is_err());
        let many = vec![1; 100];
        assert_eq!(read_buttons(&json!({ "buttons": many })), Ok(u32::MAX));
    }

    #[test]
    fn numbers_keep_their_bits_in_json() {
        let force = [0.1 + 0.2, -1.0 / 3.0, f64::MIN_POSITIVE];
        let text = publish("/f", &wrench(1_000_000_002, "world", force, [0.0; 3]));
        let read: Value = serde_json::from_str(&text).unwrap();
        let back = numbers(&read["msg"]["wrench"]["force"], ["x", "y", "z"]).unwrap();
        assert_eq!(back.map(f64::to_bits), force.map(f64::to_bits));
        assert_eq!(read["msg"]["header"]["stamp"]["nanosec"], 2);
    }
}
