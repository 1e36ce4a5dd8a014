//! ROS 2 without ROS: the daemon speaks rmw_zenoh itself.
//!
//! ```text
//! RosNode: tokens, keys, attachments ─┬─ RosArm, a thread per tool: poses in, forces out
//!                                     └─ Scenery, one thread: contact wrenches, nets, services
//! ```

mod arm;
mod guard;
mod node;
mod plan;
mod scenery;
mod sim_arm;

pub use arm::RosArm;
pub use guard::{GuardReport, guard_crtk};
pub use node::{Intake, RosNode, RosPublisher, RosReceiver, TriggerCall};
pub use plan::{ArmPlan, Plan};
pub use sim_arm::{ArmReport, simulate_arm};

use super::{CoupleError, Coupling, couple};
use crate::AdapterCounts;
use palpate_client::proto::messages::DeviceInfo;
use palpate_client::{ClientError, Palpate, Tool};
use palpate_devices::Coupler;
use scenery::Scenery;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A node at work; it leaves the devices without force when it is stopped or dropped.
pub struct Ros2 {
    stop: Arc<AtomicBool>,
    threads: Vec<JoinHandle<()>>,
}

/// How long the daemon may take to know what a device can do, in lockstep.
const PATIENCE: Duration = Duration::from_secs(5);

impl Ros2 {
    /// Joins the graph with everything of a plan. `session` is the daemon's own; its bus is running, and
    /// shows `counts`.
    ///
    /// # Errors
    /// Zenoh or the system refused.
    pub fn start(
        session: &zenoh::Session,
        instance: &str,
        plan: &Plan,
        counts: &AdapterCounts,
    ) -> anyhow::Result<Self> {
        let zenoh = |error: zenoh::Error| anyhow::anyhow!("Zenoh: {error}");
        let node = Arc::new(RosNode::new(session, plan.domain, &plan.node).map_err(zenoh)?);
        let mut ros2 = Self {
            stop: Arc::default(),
            threads: Vec::new(),
        };
        let mut tools = Vec::new();
        for arm in &plan.arms {
            let device = RosArm::new(&node, arm, &plan.frame, plan.lockstep).map_err(zenoh)?;
            let palpate = Palpate::over(session.clone(), instance)?;
            tools.push(arm.tool.clone());
            let (intake, id) = (device.intake().clone(), arm.tool.clone());
            counts.add(move || {
                let counts = intake.counts();
                counts
                    .map(|(what, count)| (id.clone(), what, count))
                    .to_vec()
            });
            let (node, arm, stop) = (node.clone(), arm.clone(), ros2.stop.clone());
            let lockstep = plan.lockstep;
            ros2.spawn(format!("palpate-ros2-{}", arm.tool), move || {
                let _node = node;
                if let Err(error) = serve_arm(device, &palpate, &arm, lockstep, &stop) {
                    tracing::error!(%error, tool = arm.tool, "a ROS device is not served any more");
                }
            })?;
        }
        let palpate = Palpate::over(session.clone(), instance)?;
        let scenery =
            Scenery::new(&node, palpate, &plan.node, &plan.frame, &tools).map_err(zenoh)?;
        let stop = ros2.stop.clone();
        ros2.spawn("palpate-ros2".into(), move || {
            let _node = node;
            scenery.run(&stop);
        })?;
        for arm in &plan.arms {
            tracing::info!(
                tool = arm.tool,
                poses = arm.pose,
                forces = arm.force,
                "ROS 2"
            );
        }
        Ok(ros2)
    }

    fn spawn(&mut self, name: String, work: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
        self.threads
            .push(std::thread::Builder::new().name(name).spawn(work)?);
        Ok(())
    }

    /// Leaves the graph. Devices get a last force of zero.
    pub fn stop(self) {}
}

impl Drop for Ros2 {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// One tool and its topics, until `stop` is set.
fn serve_arm(
    mut device: RosArm,
    palpate: &Palpate,
    arm: &ArmPlan,
    lockstep: bool,
    stop: &AtomicBool,
) -> anyhow::Result<()> {
    let (mut tool, info) = hold_tool(palpate, arm, &format!("ros2 {}", arm.pose), lockstep)?;
    let mut reported = false;
    let report = loop {
        let coupling = Coupling {
            coupler: Coupler::new(arm.coupler.clone()),
            info: info.clone(),
            stop,
        };
        match couple(&mut device, &mut tool, coupling) {
            // The device has no force, and tries again with its next pose: the other may have left.
            Err(CoupleError::Bus(error @ ClientError::Held { .. })) => {
                if !std::mem::replace(&mut reported, true) {
                    tracing::warn!(%error, "poses of a ROS device are dropped; later ones without a word");
                }
            }
            ended => break ended?,
        }
    };
    let dropped: Vec<String> = device.intake().counts()[1..]
        .iter()
        .filter(|(_, count)| *count > 0)
        .map(|(cause, count)| format!("{count} {cause}"))
        .collect();
    tracing::info!(
        tool = arm.tool,
        poses = report.readings,
        refused = report.refused,
        forces = report.commands,
        peak_n = report.peak_force_n,
        dropped = dropped.join(", "),
        "ROS device"
    );
    Ok(())
}

/// Takes the tool of an arm and reports what its device can do. In lockstep the first tick waits until
/// the daemon has it, so that sessions repeat.
pub(super) fn hold_tool(
    palpate: &Palpate,
    arm: &ArmPlan,
    name: &str,
    lockstep: bool,
) -> anyhow::Result<(Tool, DeviceInfo)> {
    let info = info_of(arm, name);
    let mut tool = palpate.tool(&arm.tool)?;
    tool.announce(&info)?;
    let begun = Instant::now();
    while lockstep && palpate.device(&arm.tool).ok().as_ref() != Some(&info) {
        anyhow::ensure!(
            begun.elapsed() < PATIENCE,
            "the device's description was not taken"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok((tool, info))
}

fn info_of(arm: &ArmPlan, name: &str) -> DeviceInfo {
    let cap = arm.coupler.cap;
    DeviceInfo {
        dof_force: 3,
        dof_torque: if cap.torque_nm > 0.0 { 3 } else { 0 },
        force_max: cap.force_n,
        torque_max: cap.torque_nm,
        ..DeviceInfo::named(name)
    }
}
