//! A tool on its virtual coupling: the hand's device, and where the surfaces hold the tool back.

use crate::haptics::{DeviceBounds, Link, Port};
use crate::solve::grip::{GRAB, GripState};
use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_geometry::stateful;

/// State of a tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolState {
    /// Its device.
    pub link: Link,
    /// Where the surface holds the tool back, m.
    pub proxy: Point3,
    /// How it is turned there; without a coupling for rotation, as the device is.
    pub orientation: Rotation,
    /// Energy between its device and the loop.
    pub port: Port,
    /// What its device can bear, as reported.
    pub bounds: DeviceBounds,
    /// What it grabs; nothing while the button is up.
    pub grip: GripState,
}

stateful!(ToolState, |this, walk| {
    let ToolState {
        link,
        proxy,
        orientation,
        port,
        bounds,
        grip,
    } = this;
    walk.part(link)?;
    walk.point(proxy)?;
    walk.rotation(orientation)?;
    walk.part(port)?;
    walk.part(bounds)?;
    if link.pose.buttons & GRAB != 0 {
        walk.part(grip)
    } else {
        walk.clear(grip)
    }
});

/// Buffers of a tool.
#[derive(Clone, Debug)]
pub(crate) struct ToolScratch {
    /// Where free motion of the coupling takes the proxy, m.
    pub free: Point3,
    /// How it turns it.
    pub free_turn: Rotation,
    /// The proxy held back by the surfaces as they stand, m.
    pub proxy: Point3,
    /// Force of its contacts, N.
    pub force_n: Vector3,
    /// Torque of its contacts about its reference point, N·m.
    pub torque_nm: Vector3,
    /// Share of them that the limiter lets through.
    pub borne: f64,
    /// The proxy under those forces, m.
    pub held: Point3,
}

impl Default for ToolScratch {
    fn default() -> Self {
        Self {
            free: Point3::origin(),
            free_turn: Rotation::identity(),
            proxy: Point3::origin(),
            force_n: Vector3::zeros(),
            torque_nm: Vector3::zeros(),
            borne: 0.0,
            held: Point3::origin(),
        }
    }
}
