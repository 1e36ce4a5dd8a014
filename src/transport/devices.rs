//! What the devices of tools can do, as their clients report.

use super::deadband::Deadband;
use super::events::Events;
use super::link::LoopLink;
use palpate_drive::ports::SenderId;
use palpate_proto::codec::{check_head, decode};
use palpate_proto::messages::{DeviceInfo, EventKind};
use palpate_sim::haptics::DeviceBounds;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::{Command, ToolOutput};
use palpate_wire as wire;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use zenoh::bytes::ZBytes;

/// With a deadband a force is sent at least this often, s.
const LONGEST_S: f64 = 0.05;

/// By tool: the newest description of its device, and what follows from it.
pub(super) struct Devices {
    tools: Vec<Device>,
}

struct Device {
    info: Option<DeviceInfo>,
    deadband: Deadband,
    /// As the loop has them.
    bounds: DeviceBounds,
    /// Descriptions that were dropped.
    refused: Arc<AtomicU64>,
}

impl Devices {
    /// None reported yet.
    pub(super) fn new(scene: &Scene) -> Self {
        let longest_ticks = ((LONGEST_S / scene.dt_s).round() as u64).max(1);
        let none = || Device {
            info: None,
            deadband: Deadband::new(longest_ticks),
            bounds: DeviceBounds::default(),
            refused: Arc::default(),
        };
        Self {
            tools: (0..scene.tool_count()).map(|_| none()).collect(),
        }
    }

    /// Counts what a receive thread drops.
    pub(super) fn refused(&self, tool: usize) -> Arc<AtomicU64> {
        self.tools[tool].refused.clone()
    }

    /// The newest description.
    pub(super) fn info(&self, tool: usize) -> Option<&DeviceInfo> {
        self.tools[tool].info.as_ref()
    }

    /// Greatest force that the device can bear, as reported, N.
    pub(super) fn force_max_n(&self, tool: usize) -> f64 {
        self.tools[tool].bounds.force_max_n
    }

    /// Forces left out so far, by tool.
    pub(super) fn all_suppressed(&self) -> Vec<u64> {
        let suppressed = |device: &Device| device.deadband.suppressed();
        self.tools.iter().map(suppressed).collect()
    }

    /// Descriptions that were dropped, by tool.
    pub(super) fn all_refused(&self) -> Vec<u64> {
        let refused = |device: &Device| device.refused.load(Ordering::Relaxed);
        self.tools.iter().map(refused).collect()
    }

    /// Whether the hand at this device could tell this force from the last one sent.
    pub(super) fn wants(&mut self, tool: usize, tick: u64, out: &ToolOutput) -> bool {
        self.tools[tool].deadband.wants(tick, out)
    }

    /// Its holder is gone: the next may have another device.
    pub(super) fn forget(&mut self, tool: usize) {
        let device = &mut self.tools[tool];
        device.info = None;
        device.deadband.set(0.0);
    }

    /// For people, by tool; `of`: its id, and who holds it.
    pub(super) fn report<'a>(
        &self,
        of: impl Fn(usize) -> (&'a str, Option<SenderId>),
    ) -> serde_json::Value {
        let tools = self.tools.iter().enumerate().map(|(tool, device)| {
            let (id, holder) = of(tool);
            let report = serde_json::json!({
                "holder": holder.map(|holder| holder.short()),
                "info": device.info,
                "refused": device.refused.load(Ordering::Relaxed),
                "forces_suppressed": device.deadband.suppressed(),
            });
            (id.to_owned(), report)
        });
        serde_json::Value::Object(tools.collect())
    }
}

impl Devices {
    /// The client of a tool described its device; `info` is validated. Comes again after each
    /// reconnect, often with the same content.
    pub(super) fn reported(
        &mut self,
        tool: usize,
        info: DeviceInfo,
        scene: &Scene,
        link: &mut LoopLink,
        events: &mut Events,
    ) {
        let device = &mut self.tools[tool];
        if device.info.as_ref() == Some(&info) {
            return;
        }
        device.deadband.set(info.deadband);
        let name = info.name.clone();
        let bounds = wire::device_bounds(scene, tool, &info);
        // Where nothing is passive `bounded` follows nothing: that advice would be wrong.
        if let Some(passive_n_m) = scene.stiffer_than(tool, &wire::device_figures(&info))
            && passive_n_m > 0.0
        {
            tracing::info!(
                tool = scene.tool_id(tool),
                device = name,
                passive_n_m,
                "the coupling is stiffer than this device holds in any hand; `bounded = true` would follow it"
            );
        }
        device.info = Some(info);
        self.bind(tool, bounds, link);
        let tool = scene.tool_id(tool).to_owned();
        events.tell(EventKind::DeviceTold { tool, name });
    }

    /// Hands over what a device can bear, if that is news.
    fn bind(&mut self, tool: usize, bounds: DeviceBounds, link: &mut LoopLink) {
        if self.tools[tool].bounds == bounds {
            return;
        }
        let command = Command::Device {
            tool: tool as u32,
            bounds,
        };
        // No one waits for its receipt: number 0.
        if link.command(0, command).is_ok() {
            self.tools[tool].bounds = bounds;
        } else {
            tracing::warn!(
                "too many commands are waiting: what a device can bear was not taken over"
            );
        }
    }

    /// A tool has a new holder: what the device before it could bear does not bind this one.
    pub(super) fn release(&mut self, tool: usize, link: &mut LoopLink) {
        self.bind(tool, DeviceBounds::default(), link);
    }
}

/// Counts a description by a client that does not hold the tool.
pub(super) fn refuse_stranger(refused: &AtomicU64) {
    if refused.fetch_add(1, Ordering::Relaxed) == 0 {
        tracing::warn!(
            "a description of a device was dropped: its sender does not hold the tool; later ones are only counted"
        );
    }
}

/// Decodes and checks. Runs on a receive thread: counts what it refuses and never logs a flood.
pub(super) fn take_device(
    refused: &AtomicU64,
    payload: &ZBytes,
    schema: &str,
) -> Option<DeviceInfo> {
    // What is too long is not even copied.
    let read = check_head::<DeviceInfo>(payload.len(), schema)
        .and_then(|()| decode::<DeviceInfo>(&payload.to_bytes(), schema))
        .map_err(|e| e.to_string());
    match read.and_then(|info| info.validated().map_err(|e| e.to_string())) {
        Ok(info) => Some(info),
        Err(error) => {
            if refused.fetch_add(1, Ordering::Relaxed) == 0 {
                tracing::warn!(
                    error,
                    "a description of a device was dropped; later ones are only counted"
                );
            }
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_proto::codec::encode;

    #[test]
    fn bad_descriptions_are_counted_and_dropped() {
        let info = DeviceInfo {
            name: "arm".into(),
            dof_force: 3,
            dof_torque: 0,
            workspace: [0.1; 3],
            force_max: 3.0,
            force_continuous: 1.0,
            torque_max: 0.0,
            mass: 0.1,
            damping: 0.0,
            coulomb_friction: 0.0,
            encoder_resolution: 1e-5,
            rate_hz: 1e3,
            delay_s: 0.0,
            deadband: 0.0,
        };
        let refused = AtomicU64::new(0);
        let schema = "postcard;palpate.DeviceInfo.v1";
        let take = |bytes: &[u8], schema| take_device(&refused, &ZBytes::from(bytes), schema);
        assert_eq!(take(&encode(&info), schema), Some(info.clone()));
        assert_eq!(refused.load(Ordering::Relaxed), 0);
        let negative = DeviceInfo {
            mass: -1.0,
            ..info.clone()
        };
        assert_eq!(take(&encode(&negative), schema), None);
        assert_eq!(take(&encode(&info)[..20], schema), None);
        assert_eq!(take(&encode(&info), "postcard;palpate.DeviceInfo.v9"), None);
        assert_eq!(take(&vec![0; 1 << 20], schema), None);
        assert_eq!(refused.load(Ordering::Relaxed), 4);
    }
}
