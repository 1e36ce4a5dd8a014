//! Hashes of all that came of a session, a stretch of ticks at a time: what takes the place of its
//! outputs where only its inputs are kept.

use super::super::message::SessionHash;
use super::super::replay::compared_words;
use super::super::rerun::Rerun;
use palpate_geometry::math::Point3;
use palpate_sim::tick::record::{Command, TickInput, TickOutput};
use palpate_wire::{command_to_proto, pose_values};
use prost::Message as _;
use serde::{Deserialize, Serialize};

/// Most stretches of a session.
const MOST: u64 = 1_000;

/// Hashes of a session, hexadecimal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hashes {
    /// First tick.
    pub first_tick: u64,
    /// Ticks of a stretch.
    pub every: u64,
    /// Of the poses and commands.
    pub inputs: String,
    /// Of the states of all ticks, as `palpate info` and a replay print it.
    pub session: String,
    /// Of the control nets of all bodies at the ends of stretches.
    pub nets: String,
    /// By stretch: of its states and of what its tools were given.
    pub stretches: Vec<String>,
}

/// Where two runs of the same inputs part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct HashDifference {
    /// `outputs`, or `nets` alone.
    pub of: &'static str,
    /// First and last of the ticks that the hash covers.
    pub ticks: (u64, u64),
    /// As written down.
    pub expected: String,
    /// As it is now.
    pub found: String,
    /// Stretches before it.
    pub matched: usize,
}

impl std::fmt::Display for HashDifference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (first, last) = self.ticks;
        write!(
            f,
            "{} of ticks {first} to {last}: hash {} expected, {} found",
            self.of, self.expected, self.found
        )
    }
}

impl Hashes {
    /// First and last tick of a stretch, in a session of so many ticks.
    fn ticks_of(&self, stretch: usize, ticks: u64) -> (u64, u64) {
        let from = stretch as u64 * self.every;
        let last = (from + self.every).min(ticks).saturating_sub(1);
        (self.first_tick + from, self.first_tick + last)
    }

    /// Where another run of the same inputs parts from these; both have so many ticks.
    pub fn first_difference(&self, now: &Self, ticks: u64) -> Option<HashDifference> {
        let apart = |of, ticks, expected: &str, found: &str, matched| HashDifference {
            of,
            ticks,
            expected: expected.to_owned(),
            found: found.to_owned(),
            matched,
        };
        let pairs = self.stretches.iter().zip(&now.stretches).enumerate();
        for (k, (expected, found)) in pairs {
            if expected != found {
                return Some(apart(
                    "outputs",
                    self.ticks_of(k, ticks),
                    expected,
                    found,
                    k,
                ));
            }
        }
        let all = (self.first_tick, self.first_tick + ticks.saturating_sub(1));
        (self.nets != now.nets)
            .then(|| apart("nets", all, &self.nets, &now.nets, self.stretches.len()))
    }
}

/// Makes [`Hashes`], tick by tick.
pub(in super::super) struct Hasher {
    every: u64,
    tool_count: usize,
    first_tick: Option<u64>,
    ticks: u64,
    inputs: SessionHash,
    session: SessionHash,
    nets: SessionHash,
    stretch: SessionHash,
    stretches: Vec<String>,
    net: Vec<Point3>,
}

impl Hasher {
    /// Of a session of so many ticks.
    pub fn new(tool_count: usize, ticks: u64) -> Self {
        let mut every = 100;
        while ticks.div_ceil(every) > MOST {
            every *= 10;
        }
        Self {
            every,
            tool_count,
            first_tick: None,
            ticks: 0,
            inputs: SessionHash::default(),
            session: SessionHash::default(),
            nets: SessionHash::default(),
            stretch: SessionHash::default(),
            stretches: Vec::new(),
            net: Vec::new(),
        }
    }

    /// Takes a command in.
    pub fn command(&mut self, after_tick: u64, command: Command) {
        let bytes = command_to_proto(after_tick, command).encode_to_vec();
        bytes
            .iter()
            .for_each(|byte| self.inputs.push(after_tick, u64::from(*byte)));
    }

    /// Takes in what went into a tick.
    pub fn input(&mut self, tick: u64, input: &TickInput) {
        let poses = input.poses.first(self.tool_count).enumerate();
        for (tool, pose) in poses.filter_map(|(tool, pose)| Some((tool, pose.as_ref()?))) {
            let head = [tool as u64, pose.seq, pose.t_client_ns, pose.buttons.into()];
            let values = pose_values(pose).map(f64::to_bits);
            (head.into_iter().chain(values)).for_each(|word| self.inputs.push(tick, word));
        }
        if input.skipped > 0 {
            self.inputs.push(tick, input.skipped.into());
        }
    }

    /// Takes in what came of a tick.
    pub fn output(&mut self, output: &TickOutput) {
        let tick = output.tick;
        self.first_tick.get_or_insert(tick);
        self.ticks += 1;
        self.session.push(tick, output.state_hash);
        let stretch = &mut self.stretch;
        compared_words(output, self.tool_count, |word| stretch.push(tick, word));
        if self.ticks.is_multiple_of(self.every) {
            self.end_stretch();
        }
    }

    fn end_stretch(&mut self) {
        let hash = std::mem::take(&mut self.stretch);
        self.stretches.push(hash.to_string());
    }

    /// Takes in the nets after a tick, if it ends a stretch or is the last.
    pub fn nets(&mut self, rerun: &Rerun, last: bool) {
        if self.ticks.is_multiple_of(self.every) == last {
            return;
        }
        for body in 0..rerun.scene().body_count() {
            rerun.copy_net(body, &mut self.net);
            let words = self.net.iter().flat_map(|point| point.coords.as_slice());
            words.for_each(|x| self.nets.push(body as u64, x.to_bits()));
        }
    }

    /// All that was taken in.
    pub fn finish(mut self) -> Hashes {
        if !self.ticks.is_multiple_of(self.every) {
            self.end_stretch();
        }
        Hashes {
            first_tick: self.first_tick.unwrap_or(0),
            every: self.every,
            inputs: self.inputs.to_string(),
            session: self.session.to_string(),
            nets: self.nets.to_string(),
            stretches: self.stretches,
        }
    }
}
