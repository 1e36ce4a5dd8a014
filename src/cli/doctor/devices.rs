//! Devices of a running daemon: how often they speak.

use crate::cli::connection::Connection;
use serde::Serialize;

/// A slower device makes a stiff contact vibrate.
const USUAL_HZ: f64 = 900.0;

/// A device that holds a tool.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct HeldTool {
    pub tool: String,
    pub device: String,
    /// As it reported, or as its adapter measured; 0 where neither did.
    pub rate_hz: f64,
}

/// Asks a daemon for the devices of its tools.
///
/// # Errors
/// No one answers there.
pub(super) fn ask(connection: &Connection) -> anyhow::Result<Vec<HeldTool>> {
    let palpate = connection.open()?;
    let info: serde_json::Value = serde_json::from_str(&palpate.info()?)?;
    palpate.close();
    Ok(held(&info))
}

fn held(info: &serde_json::Value) -> Vec<HeldTool> {
    let Some(devices) = info["devices"].as_object() else {
        return Vec::new();
    };
    let read = |(tool, about): (&String, &serde_json::Value)| {
        let device = about["info"]["name"].as_str()?;
        Some(HeldTool {
            tool: tool.clone(),
            device: device.to_owned(),
            rate_hz: about["info"]["rate_hz"].as_f64().unwrap_or(0.0),
        })
    };
    devices.iter().filter_map(read).collect()
}

/// What to say of a device.
pub(super) fn words(held: &HeldTool) -> String {
    let HeldTool {
        tool,
        device,
        rate_hz,
    } = held;
    match *rate_hz {
        rate if rate <= 0.0 => format!("tool {tool}: {device}, rate not known"),
        rate if rate < USUAL_HZ => format!(
            "tool {tool}: {device}, {rate:.0} Hz, below 1000: stiff contact can vibrate; raise the driver's rate, or set \
             `bounded = true` in the tool's coupling"
        ),
        rate => format!("tool {tool}: {device}, {rate:.0} Hz"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_devices_are_warned_of() {
        let info = serde_json::json!({ "devices": {
            "ball": { "info": { "name": "ros2 /arm/measured_cp", "rate_hz": 497.2 } },
            "pen": { "info": { "name": "omega.3", "rate_hz": 4000.0 } },
            "probe": { "info": null },
        }});
        let all = held(&info);
        assert_eq!(all.len(), 2);
        assert!(
            words(&all[0]).contains("497 Hz, below 1000"),
            "{}",
            words(&all[0])
        );
        assert_eq!(words(&all[1]), "tool pen: omega.3, 4000 Hz");
        assert!(held(&serde_json::Value::Null).is_empty());
    }
}
