//! A simulated device on a loop, both in lockstep, with a network between them if wanted.

use palpate_client::device::{
    Channel, DeviceModel, Goal, Hand, Network, Passivity, SimulatedDevice,
};
use palpate_proto::messages::ToolPose;
use palpate_sim::World;
use palpate_sim::tick::record::ToolOutput;
use palpate_wire as wire;

/// A wall at z = 0 under a point: text of the scene.
pub(super) fn wall(stiffness_n_m: f64, damping_n_s_m: f64, extra: &str) -> String {
    format!(
        "[[body]]\nid = \"wall\"\nsurface = {{ builtin = \"sheet\", size = 0.4 }}\n[[tool]]\nid = \"tip\"\nshape = {{ point = {{}} }}\n\
         pose = {{ position = [0.0, 0.0, 0.02] }}\n\
         coupling = {{ stiffness_n_m = {stiffness_n_m:?}, damping_n_s_m = {damping_n_s_m:?} }}\n\
         device = {{ force_max_n = 100.0, ramp_s = 0.0, speed_max_m_s = 100.0{extra} }}\n"
    )
}

/// A device, a hand and a loop.
pub(super) struct Rig {
    pub world: World,
    pub device: SimulatedDevice,
    poses: Channel<ToolPose>,
    forces: Channel<[f64; 3]>,
    passivity: Option<Passivity>,
    force_n: [f64; 3],
    dt_s: f64,
}

impl Rig {
    /// `delay_s` in each direction.
    pub fn new(
        world: World,
        (model, hand): (&DeviceModel, &Hand),
        start: [f64; 3],
        delay_s: f64,
        passivity: Option<Passivity>,
        seed: u64,
    ) -> Self {
        let channel = || Network {
            delay_s,
            seed,
            ..Network::default()
        };
        let dt_s = world.scene.dt_s;
        Self {
            device: SimulatedDevice::new(model.clone(), hand.clone(), start, seed),
            poses: Channel::new(channel()).unwrap_or_else(|error| panic!("{error}")),
            forces: Channel::new(channel()).unwrap_or_else(|error| panic!("{error}")),
            passivity,
            force_n: [0.0; 3],
            dt_s,
            world,
        }
    }

    /// One period: the device moves under the force it holds, reports where it is, and gets what
    /// has arrived.
    pub fn period(&mut self, goal: Goal) -> ToolOutput {
        let held = match &mut self.passivity {
            Some(passivity) => {
                passivity.force(self.force_n, self.device.pose().position, self.dt_s)
            }
            None => self.force_n,
        };
        self.device.advance(goal, held, self.dt_s);
        let now_s = self.device.time_s();
        self.poses.send(now_s, self.device.pose());
        let newest = self.poses.receive(now_s).last();
        self.world.record.input.poses[0] = newest.map(|pose| {
            self.world.seq += 1;
            wire::device_pose(&ToolPose {
                seq: self.world.seq,
                ..pose
            })
        });
        let out = self.world.tick().tools[0];
        self.forces.send(now_s, out.force_n.into());
        if let Some(force) = self.forces.receive(now_s).last() {
            self.force_n = force;
        }
        out
    }
}
