//! The client: a simulated device in its servo loop, as `palpate device` runs it, by virtual time.

use super::now;
use super::plan::Plan;
use palpate_client::NewestForce;
use palpate_client::device::servo::Servo;
use palpate_client::device::{Motion, Network, PassivitySettings, SimulatedDevice};
use palpate_drive::ports::SenderId;
use palpate_proto::messages::{SceneSnapshot, ToolForce, ToolPose};

/// The hand feels nothing this long after the last news, ns: what clients promise.
const SILENT_NS: u64 = 60_000_000;

/// A running client.
pub(super) struct Client {
    device: SimulatedDevice,
    servo: Servo,
    motion: Motion,
    newest: NewestForce,
    pub sender: SenderId,
    seq: u64,
    passivity: bool,
    /// Its first period began, ns.
    begun_ns: u64,
    periods: u64,
    heard_ns: Option<u64>,
    most_n: f64,
    /// The next pose is sent from elsewhere.
    pub jumps: bool,
    /// Least of what the loop gave back beyond what the device itself takes, J.
    pub least_own_j: f64,
    /// Least of that with what cannot be known added: below zero, energy was made, J.
    pub least_margin_j: f64,
}

impl Client {
    /// A new client with its device where the motion begins.
    pub fn start(plan: &Plan, scene: &SceneSnapshot, number: u8) -> Result<Self, String> {
        let kind = match plan.motion {
            palpate_client::device::Kind::Press => "press",
            palpate_client::device::Kind::Slide => "slide",
            palpate_client::device::Kind::Tap => "tap",
            palpate_client::device::Kind::Circle => "circle",
            _ => "pull",
        };
        let motion = Motion::named(kind, scene, "ball", plan.depth_m).map_err(|e| e.to_string())?;
        let start = motion.goal(0.0).position;
        let settings = (plan.passivity).then(|| PassivitySettings::of(&plan.model));
        let servo = Servo::new(Network::default(), settings);
        Ok(Self {
            device: SimulatedDevice::new(plan.model.clone(), plan.hand.clone(), start, plan.seed),
            servo: servo.map_err(|error| error.to_string())?,
            motion,
            newest: NewestForce::new(false, false),
            sender: SenderId::of(Some(&[number; 8])),
            seq: 0,
            passivity: plan.passivity,
            begun_ns: super::now_ns(),
            periods: 0,
            heard_ns: None,
            most_n: 0.0,
            jumps: false,
            least_own_j: 0.0,
            least_margin_j: 0.0,
        })
    }

    fn period_s(&self) -> f64 {
        1.0 / self.device.model().rate_hz
    }

    /// When its next period is due, ns. Like the real one it catches up with those that it missed.
    pub fn due_ns(&self) -> u64 {
        let ns = (self.periods + 1) as f64 * self.period_s() * 1e9;
        self.begun_ns + ns as u64
    }

    /// A force arrives.
    pub fn hear(&mut self, force: ToolForce) {
        self.newest.offer(force, now());
        self.heard_ns = Some(super::now_ns());
    }

    /// A servo period: the pose to send, and the force that acted.
    pub fn period(&mut self) -> Result<(ToolPose, [f64; 3]), String> {
        self.periods += 1;
        let now_s = self.device.time_s();
        if let Some(force) = self.newest.force {
            self.servo.hear(now_s, force);
        }
        self.servo.collect(now_s);
        let dt_s = self.period_s();
        let gain = Some(self.newest.gain(now()));
        let period = self
            .servo
            .period(&mut self.device, &self.motion, dt_s, gain);
        let felt_n = norm(period.sample.received_n);
        self.most_n = self.most_n.max(felt_n).max(norm(period.sample.applied_n));
        if let Some(heard_ns) = self.heard_ns {
            let silent_ns = super::now_ns() - heard_ns;
            let period_ns = (dt_s * 1e9) as u64;
            if silent_ns > SILENT_NS + period_ns && felt_n > 0.0 {
                let silent_ms = silent_ns as f64 * 1e-6;
                return Err(format!(
                    "the hand feels {felt_n} N {silent_ms:.3} ms after the last news"
                ));
            }
        }
        let most_n = self.device.model().force_max_n;
        if !felt_n.is_finite() || norm(period.sample.applied_n) > most_n * (1.0 + 1e-9) {
            return Err(format!(
                "the device got {felt_n} N and made {:?} N; it bears {most_n} N",
                period.sample.applied_n
            ));
        }
        self.check_energy(dt_s)?;
        self.seq += 1;
        let mut pose = ToolPose {
            seq: self.seq,
            t_client_ns: super::now_ns(),
            ..period.poses.last().copied().unwrap_or(self.device.pose())
        };
        if std::mem::take(&mut self.jumps) {
            pose.position[2] += 0.3;
        }
        Ok((pose, period.sample.applied_n))
    }

    /// The hand meets something passive: what the loop gave back the device's own losses took. What
    /// no one can know of the next period is left: the encoder's step, and how much farther than the
    /// last it goes, under the greatest force.
    fn check_energy(&mut self, dt_s: f64) -> Result<(), String> {
        if !self.passivity {
            return Ok(());
        }
        let energy = self.device.energy();
        let own_j = energy.loop_j + energy.viscous_j + energy.coulomb_j;
        self.least_own_j = self.least_own_j.min(own_j);
        let model = self.device.model();
        let stride_m = dt_s * dt_s * 2.0 * self.most_n / model.mass_kg;
        let doubt_j = self.most_n * (model.encoder_m + stride_m);
        self.least_margin_j = self.least_margin_j.min(own_j + doubt_j);
        match own_j >= -doubt_j {
            true => Ok(()),
            false => Err(format!(
                "the loop made {} J that nothing took, {doubt_j} J cannot be known",
                -own_j
            )),
        }
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}
