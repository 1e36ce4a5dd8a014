//! Time-domain passivity at the device's port: what the loop gives may not exceed what it was
//! given.
//!
//! A stiff wall behind a delay pushes the hand out harder than the hand pushed in, and the contact
//! swings. The observer (Hannaford & Ryu 2002) counts the energy that went into the loop, for a
//! force held over each period exactly (Ryu, Kim & Hannaford 2004): E_k = E_{k−1} − f_{k−1}·(x_k −
//! x_{k−1}). The controller acts where E would be negative after the next period: a damper along
//! the received force, and if that is not enough the push itself is cut.
//!
//! What the device loses by itself is counted as given: b |Δx|²/T, a damper's least for that way,
//! and dry friction times the way that was surely gone. Up to the limit K = 2b/T of Colgate &
//! Schenkel (1997) a sampled wall then never runs out (E ≥ ½ K d² + (b/T − K/2) Σ Δx² at a depth
//! d), and what was received is passed on to the bit.

use super::v3;

/// How to keep the port passive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassivitySettings {
    /// Mass that surely moves with the device, kg: bounds the damper to what a sampled damper can
    /// be.
    pub mass_kg: f64,
    /// Damping the device surely has, N·s/m: what it takes counts as given. 0: the loop must pay
    /// for itself.
    pub damping_n_s_m: f64,
    /// Dry friction the device surely has, N: likewise.
    pub coulomb_n: f64,
    /// First-order lag between a commanded and an acting force, Hz; infinite: none.
    pub bandwidth_hz: f64,
    /// Greatest force, N.
    pub force_max_n: f64,
    /// Resolution of the reported position, m.
    pub encoder_m: f64,
    /// Energy that every contact leaves behind, J: covers what predictions of the next period miss
    /// where the loop alone has to pay for itself. 0: none.
    pub reserve_j: f64,
    /// Without force for this long a contact is over, s: its energy is not credited to the next.
    pub rest_s: f64,
}

impl PassivitySettings {
    /// For a device as it is.
    pub fn of(model: &super::DeviceModel) -> Self {
        Self {
            mass_kg: model.mass_kg,
            damping_n_s_m: model.damping_n_s_m,
            coulomb_n: model.coulomb_n,
            bandwidth_hz: model.bandwidth_hz,
            force_max_n: model.force_max_n,
            encoder_m: model.encoder_m,
            reserve_j: 0.0,
            rest_s: 0.05,
        }
    }

    /// As [`Self::of`], but nothing that the device loses by itself counts: the loop alone has to
    /// be passive.
    pub fn strict(model: &super::DeviceModel) -> Self {
        Self {
            damping_n_s_m: 0.0,
            coulomb_n: 0.0,
            reserve_j: 2e-5,
            ..Self::of(model)
        }
    }
}

/// Samples the velocity is looked for in.
const WINDOW: usize = 16;
/// The damper is at most this share of mass over period. At 1/2 the lag of encoder and amplifier
/// makes it ring on a wall of 3000 N/m behind 2 ms; at 1/8 it is too weak there.
const DAMPER_SHARE: f64 = 0.25;
/// The damper stays for some swings of a contact, s.
const DAMPER_FADE_S: f64 = 1.0;
/// What was cut comes back in this time, faster while the hand presses in: slower loses contact,
/// faster buzzes, s.
const CUT_FADE_S: f64 = 0.03;
const CUT_FADE_PRESSED_S: f64 = 0.01;
/// A contact that needs cuts again and again is softened, both ways alike, instead of cut each
/// time: soft within the first time, hard again within the second, or when the contact ends, s.
/// Held presses behind 2 to 40 ms, 1000 and 3000 N/m, pulse by up to 0.7 N at 0.05 and 1 s, by 0.05
/// N at these.
const SOFTEN_S: f64 = 0.02;
const HARDEN_S: f64 = 6.0;
/// A debt of this many times what the encoder leaves in doubt is paid before the force comes back.
/// At 1 a light touch sinks in twice as far, at 6 a strict bound leaks more.
const DOUBTS: f64 = 3.0;
/// The damper's force never exceeds the received force, or this, with which debts are paid in the
/// free, N.
const LEAST_BRAKE_N: f64 = 0.3;

/// Observer and controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Passivity {
    settings: PassivitySettings,
    credit_j: f64,
    energy_j: f64,
    dissipated_j: f64,
    positions: [[f64; 3]; WINDOW], // newest first
    known: usize,
    slack: [f64; 3], // reported position through a play as wide as a step of the encoder
    amplifier_n: [f64; 3], // as modelled, at the begin of the period
    held_n: [f64; 3], // mean that acts over the period
    changed_n: [f64; 3], // by the control, as commanded
    damper: f64,
    cut: f64,
    soft: f64,
    quiet_s: f64,
    begun: bool, // a contact, which has left its reserve
}

impl Passivity {
    /// Nothing given yet.
    pub fn new(settings: PassivitySettings) -> Self {
        Self {
            settings,
            credit_j: 0.0,
            energy_j: 0.0,
            dissipated_j: 0.0,
            positions: [[0.0; 3]; WINDOW],
            known: 0,
            slack: [0.0; 3],
            amplifier_n: [0.0; 3],
            held_n: [0.0; 3],
            changed_n: [0.0; 3],
            damper: 0.0,
            cut: 0.0,
            soft: 0.0,
            quiet_s: 0.0,
            begun: false,
        }
    }

    /// Energy that went into the loop since the start, as far as the encoder shows, J. Negative:
    /// the loop made energy.
    pub fn energy_j(&self) -> f64 {
        self.energy_j
    }

    /// What the controller took, J: the difference it made to the force, times the way.
    pub fn dissipated_j(&self) -> f64 {
        self.dissipated_j
    }

    /// The force to hold over the next period, N, for the newest force received and the position
    /// reported now.
    pub fn force(&mut self, received_n: [f64; 3], position_m: [f64; 3], dt_s: f64) -> [f64; 3] {
        let received = v3::limited(received_n, self.settings.force_max_n);
        self.observe(position_m, dt_s);
        self.restart(received, dt_s);
        let held = self.control(received, dt_s);
        let acting = super::simulated::lagged(
            &mut self.amplifier_n,
            held,
            self.settings.bandwidth_hz,
            dt_s,
        );
        self.held_n = acting;
        self.changed_n = v3::sub(held, received);
        held
    }

    fn observe(&mut self, position: [f64; 3], dt_s: f64) {
        if self.known > 0 {
            let way = v3::sub(position, self.positions[0]);
            let given = -v3::dot(self.held_n, way);
            self.energy_j += given;
            self.credit_j += given + self.settings.damping_n_s_m * v3::dot(way, way) / dt_s;
            self.credit_j += self.settings.coulomb_n * self.sure_way(position);
            self.dissipated_j -= v3::dot(self.changed_n, way);
        }
        if self.known == 0 {
            self.slack = position;
        }
        self.positions.copy_within(0..WINDOW - 1, 1);
        self.positions[0] = position;
        self.known = (self.known + 1).min(WINDOW);
    }

    /// Way that was surely gone, m: two reports a step apart may be but a hair's breadth apart in
    /// truth, so a step back does not count.
    fn sure_way(&mut self, position: [f64; 3]) -> f64 {
        let mut most = 0.0f64;
        for c in 0..3 {
            let half = 0.5 * self.settings.encoder_m;
            let moved = self.slack[c].clamp(position[c] - half, position[c] + half);
            most = most.max((moved - self.slack[c]).abs());
            self.slack[c] = moved;
        }
        most
    }

    fn restart(&mut self, received: [f64; 3], dt_s: f64) {
        if received != [0.0; 3] && !self.begun {
            self.begun = true;
            self.credit_j -= self.settings.reserve_j;
        }
        self.quiet_s = if received == [0.0; 3] {
            self.quiet_s + dt_s
        } else {
            0.0
        };
        if self.quiet_s >= self.settings.rest_s {
            self.credit_j = self.credit_j.min(0.0);
            self.damper = 0.0;
            self.cut = 0.0;
            self.soft = 0.0;
            self.begun = false;
        }
    }

    /// Way of the next period if the motion goes on: the slope of the longest line from here back
    /// that passes every sample within the encoder's resolution (Janabi-Sharifi, Hayward & Chen
    /// 2000). Smooth at slow motion, prompt at fast; without an encoder's steps it is the last
    /// difference.
    fn next_way(&self) -> [f64; 3] {
        let mut way = [0.0; 3];
        for c in 0..3 {
            let at = |k: usize| self.positions[k][c];
            for n in 1..self.known {
                let slope = (at(0) - at(n)) / n as f64;
                let fits = (1..n)
                    .all(|k| (at(0) - slope * k as f64 - at(k)).abs() <= self.settings.encoder_m);
                if !fits {
                    break;
                }
                way[c] = slope;
            }
        }
        way
    }

    fn control(&mut self, received: [f64; 3], dt_s: f64) -> [f64; 3] {
        let way = self.next_way();
        let size = v3::norm(received);
        // Along the force; a debt that is left when the force has gone is paid along the motion.
        let along = if size > 0.0 {
            v3::scale(received, 1.0 / size)
        } else if self.credit_j < 0.0 && way != [0.0; 3] {
            v3::scale(way, 1.0 / v3::norm(way))
        } else {
            return received;
        };
        // Positive: the force pushes along the motion, the loop gives.
        let out = v3::dot(way, along);
        self.fade(size, out, dt_s);
        if out > 0.0 {
            self.grip(size, out, dt_s);
        }
        let raised = self.cut > self.soft;
        self.soft += (if raised {
            self.cut - self.soft
        } else {
            -self.soft
        }) * (dt_s / if raised { SOFTEN_S } else { HARDEN_S }).min(1.0);
        if self.damper == 0.0 && self.cut == 0.0 && self.soft == 0.0 {
            return received;
        }
        let most = size.max(LEAST_BRAKE_N);
        let brake = (self.damper * out / dt_s).clamp(-most, most);
        let left = size * (1.0 - self.cut.max(self.soft));
        v3::limited(v3::scale(along, left - brake), self.settings.force_max_n)
    }

    fn damper_max(&self, dt_s: f64) -> f64 {
        DAMPER_SHARE * self.settings.mass_kg / dt_s
    }

    /// What is not needed any more goes, unless there is a debt to pay.
    fn fade(&mut self, size: f64, out: f64, dt_s: f64) {
        let most = self.damper_max(dt_s);
        let gone = |value: f64, fade_s: f64| value * (1.0 - dt_s / fade_s).max(0.0);
        self.damper = gone(self.damper, DAMPER_FADE_S);
        let doubt = DOUBTS * self.settings.encoder_m.max(1e-6) * size.max(0.1);
        if self.credit_j < -doubt {
            self.damper = self
                .damper
                .max(most * (-self.credit_j / doubt - 1.0).min(1.0));
        } else {
            self.cut = gone(
                self.cut,
                if out < 0.0 {
                    CUT_FADE_PRESSED_S
                } else {
                    CUT_FADE_S
                },
            );
        }
        // So that a contact is again what was received, to the bit, some time after the last act.
        if self.damper < 1e-3 * most {
            self.damper = 0.0;
        }
        for share in [&mut self.cut, &mut self.soft] {
            if *share < 1e-3 {
                *share = 0.0;
            }
        }
    }

    /// Where the next period would take more than there is: as much damper as may be, and the rest
    /// of the push is cut.
    fn grip(&mut self, size: f64, out: f64, dt_s: f64) {
        let own = self.settings.damping_n_s_m * out * out / dt_s;
        let short = size * out - own - self.credit_j;
        if short <= 0.0 {
            return;
        }
        let needed = short * dt_s / (out * out);
        self.damper = self.damper.max(needed.min(self.damper_max(dt_s)));
        let still = short - self.damper * out * out / dt_s;
        if still > 0.0 && size > 0.0 {
            self.cut = self.cut.max((still / (size * out)).min(1.0));
        }
    }
}

#[cfg(test)]
#[path = "passivity_tests.rs"]
mod tests;
