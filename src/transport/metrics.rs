//! What is counted, as OpenMetrics text.

use super::clients::ClientCounts;
use palpate_adapters::AdapterCount;
use palpate_drive::overload::CAUSES;
use palpate_proto::messages::{LoopState, LoopStatus, Quantiles, ToolLink};
use std::fmt::{Display, Write as _};

/// Everything that is counted, at one moment.
#[derive(Clone, Debug)]
pub struct LoopMetrics {
    /// Instance name.
    pub instance: String,
    /// Where others than this machine and holders of identities may come in and do everything.
    pub open: u64,
    /// Scene name.
    pub scene: String,
    /// Health of the loop.
    pub status: LoopStatus,
    /// Overruns since the start, by cause.
    pub overruns: [u64; CAUSES.len()],
    /// Records that the bus did not take in time.
    pub bus_drops: u64,
    /// Events published.
    pub events: u64,
    /// Forces left out because no hand could tell them apart, by tool.
    pub suppressed: Vec<u64>,
    /// What reaches the clients that say so, by tool.
    pub clients: Vec<Option<ClientCounts>>,
    /// Ticks whose forces were not published, because newer ones were there.
    pub overtaken: u64,
    /// Poses of clients that did not hold their tool, by tool.
    pub strangers: Vec<u64>,
    /// Ticks whose force was less accurate than the scene asks for, by tool.
    pub degraded: Vec<u64>,
    /// Ticks a second, by the clock.
    pub measured_hz: f64,
    /// The loop is so slow that forces fade.
    pub rate_lost: bool,
    /// Messages of other programs.
    pub adapters: Vec<AdapterCount>,
    /// Descriptions of devices that were dropped, by tool.
    pub descriptions_refused: Vec<u64>,
}

impl LoopMetrics {
    /// OpenMetrics text.
    pub fn text(&self) -> String {
        let mut out = Exposition::default();
        self.write_loop(&mut out);
        self.write_tools(&mut out);
        self.write_clients(&mut out);
        out.0.push_str("# EOF\n");
        out.0
    }

    fn write_loop(&self, out: &mut Exposition) {
        let status = &self.status;
        let words = [
            ("version", env!("CARGO_PKG_VERSION")),
            ("instance", &*self.instance),
            ("scene", &*self.scene),
        ];
        out.family("build", "What runs here", "", INFO, [(words, 1)]);
        let one = |value: u64| [(NONE, value)];
        let help = "Endpoints where others than this machine and holders of identities may come in";
        out.family("open_endpoints", help, "", GAUGE, one(self.open));
        let state = match status.state {
            LoopState::Running => 0,
            LoopState::Paused => 1,
            LoopState::Stopping => 2,
        };
        let counts = [
            ("loop_ticks", "Ticks run", status.tick),
            (
                "loop_late_ticks",
                "Ticks that began more than 100 us late",
                status.late_ticks,
            ),
            (
                "loop_skipped_ticks",
                "Deadlines dropped",
                status.skipped_ticks,
            ),
            (
                "loop_forces_overtaken",
                "Ticks whose forces were not sent because newer ones were there",
                self.overtaken,
            ),
            (
                "bus_drops",
                "Records that the bus did not take in time",
                self.bus_drops,
            ),
            ("events", "Events published", self.events),
            (
                "recorder_drops",
                "Records lost by the recorder",
                status.recorder_drops,
            ),
        ];
        for (name, help, value) in counts {
            out.family(name, help, "", COUNTER, one(value));
        }
        let help = "Bytes written by the recorder";
        out.family(
            "recorder_written",
            help,
            "bytes",
            COUNTER,
            one(status.recorder_bytes),
        );
        let gauges = [
            ("loop_state", "0 running, 1 paused, 2 stopping", state),
            (
                "loop_quality",
                "Level of quality, 0 is full",
                status.quality_level.into(),
            ),
            (
                "recorder_state",
                "0 off, 1 recording, 2 ring, 3 failed",
                status.recorder as u64,
            ),
        ];
        for (name, help, value) in gauges {
            out.family(name, help, "", GAUGE, one(value));
        }
        out.family(
            "loop_rate",
            "Nominal rate",
            "hertz",
            GAUGE,
            [(NONE, status.rate_hz)],
        );
        let help = "Ticks a second by the clock; below half the nominal rate forces fade";
        out.family(
            "loop_measured_rate",
            help,
            "hertz",
            GAUGE,
            [(NONE, self.measured_hz)],
        );
        let help = "Time between tick starts over the last status period";
        out.family(
            "loop_period",
            help,
            "seconds",
            GAUGE,
            quantiles(&status.period),
        );
        let help = "Time in a tick over the last status period";
        out.family("loop_step", help, "seconds", GAUGE, quantiles(&status.step));
        let stages = CAUSES.iter().zip(self.overruns);
        let overruns = stages.map(|(stage, value)| ([("stage", *stage)], value));
        out.family(
            "loop_overruns",
            "Ticks longer than their period",
            "",
            COUNTER,
            overruns,
        );
    }

    fn write_tools(&self, out: &mut Exposition) {
        type Read = fn(&LoopMetrics, usize, &ToolLink) -> u64;
        let counters: [(&str, &str, Read); 9] = [
            ("tool_poses_received", "Poses taken", |_, _, tool| {
                tool.received
            }),
            (
                "tool_poses_superseded",
                "Poses that a newer one replaced before a tick used them",
                |_, _, tool| tool.superseded,
            ),
            (
                "tool_poses_jumped",
                "Poses that the loop refused as a jump",
                |_, _, tool| tool.jumps,
            ),
            (
                "tool_stale_ticks",
                "Ticks whose newest pose was stale",
                |_, _, tool| tool.stale_ticks,
            ),
            (
                "tool_degraded_ticks",
                "Ticks whose force was less accurate than the scene asks for",
                |all, t, _| at(&all.degraded, t),
            ),
            (
                "tool_forces_published",
                "Forces sent to devices",
                |_, _, tool| tool.forces_sent,
            ),
            (
                "tool_poses_of_strangers",
                "Poses of clients that did not hold the tool",
                |all, t, _| at(&all.strangers, t),
            ),
            (
                "tool_forces_suppressed",
                "Forces left out by a deadband",
                |all, t, _| at(&all.suppressed, t),
            ),
            (
                "tool_descriptions_refused",
                "Descriptions of devices that were dropped",
                |all, t, _| at(&all.descriptions_refused, t),
            ),
        ];
        let tools = &self.status.tools;
        for (name, help, read) in counters {
            let values = tools.iter().enumerate();
            let values = values.map(|(t, tool)| ([("tool", &*tool.tool)], read(self, t, tool)));
            out.family(name, help, "", COUNTER, values);
        }
        let refused = tools.iter().flat_map(|tool| {
            let labels = |cause| [("tool", &*tool.tool), ("cause", cause)];
            tool.refused()
                .map(move |(cause, value)| (labels(cause), value))
        });
        out.family(
            "tool_poses_refused",
            "Poses dropped before the loop",
            "",
            COUNTER,
            refused,
        );
        let energy = tools
            .iter()
            .map(|tool| ([("tool", &*tool.tool)], tool.energy_j));
        out.family(
            "tool_energy",
            "Net work of the hand",
            "joules",
            GAUGE,
            energy,
        );
        let adapters = self.adapters.iter();
        let adapters =
            adapters.map(|(tool, what, n)| ([("tool", &**tool), ("outcome", *what)], *n));
        let help = "Poses of ROS 2 drivers, by what became of them";
        out.family("ros2_poses", help, "", COUNTER, adapters);
    }

    /// What reaches the client of each tool, where it says so.
    fn write_clients(&self, out: &mut Exposition) {
        let clients = || {
            let clients = self.status.tools.iter().zip(&self.clients);
            clients.filter_map(|(tool, counts)| Some((&*tool.tool, counts.as_ref()?)))
        };
        fn labels<'a>(tool: &'a str, counts: &'a ClientCounts) -> [(&'static str, &'a str); 2] {
            [("tool", tool), ("client", &counts.client)]
        }
        let published = clients().map(|(tool, counts)| (labels(tool, counts), counts.published));
        let help = "Forces sent to the client that holds a tool, since it has it";
        out.family("client_forces_published", help, "", COUNTER, published);
        let received = clients().map(|(tool, counts)| (labels(tool, counts), counts.received));
        let help = "Forces that reached it, as it says";
        out.family("client_forces_received", help, "", COUNTER, received);
        let ages = clients().flat_map(|(tool, counts)| {
            QUANTILES
                .into_iter()
                .zip(counts.age_ns)
                .map(move |(quantile, ns)| {
                    let labels = [
                        ("tool", tool),
                        ("client", &*counts.client),
                        ("quantile", quantile),
                    ];
                    (labels, ns as f64 * 1e-9)
                })
        });
        let help =
            "Age of the newest force that a client had when it sent a pose, as that pose arrived";
        out.family("client_force_age", help, "seconds", GAUGE, ages);
    }
}

const NONE: [(&str, &str); 0] = [];
const QUANTILES: [&str; 3] = ["0.5", "0.99", "1"];

fn quantiles(values: &Quantiles) -> impl Iterator<Item = ([(&'static str, &'static str); 1], f64)> {
    let values = [values.p50_ns, values.p99_ns, values.max_ns].map(|ns| ns as f64 * 1e-9);
    QUANTILES
        .into_iter()
        .zip(values)
        .map(|(quantile, s)| ([("quantile", quantile)], s))
}

/// The count of a tool; 0 for one that nothing was counted of yet.
fn at(values: &[u64], tool: usize) -> u64 {
    values.get(tool).copied().unwrap_or(0)
}

/// A kind of family: its name in a `TYPE` line, and what its samples' names end in.
type Kind = (&'static str, &'static str);
const COUNTER: Kind = ("counter", "_total");
const GAUGE: Kind = ("gauge", "");
const INFO: Kind = ("info", "_info");

/// Families of metrics in the text format of OpenMetrics 1.0.
#[derive(Default)]
struct Exposition(String);

impl Exposition {
    /// Writes a family with all its samples. Its name gets the prefix of the program and the unit, if it has one.
    fn family<const N: usize, V: Display>(
        &mut self,
        name: &str,
        help: &str,
        unit: &str,
        (kind, ending): Kind,
        samples: impl IntoIterator<Item = ([(&'static str, impl AsRef<str>); N], V)>,
    ) {
        let join = if unit.is_empty() { "" } else { "_" };
        let name = format!("palpate_{name}{join}{unit}");
        let out = &mut self.0;
        // Writing into a string does not fail.
        let _ = writeln!(out, "# HELP {name} {help}\n# TYPE {name} {kind}");
        if !unit.is_empty() {
            let _ = writeln!(out, "# UNIT {name} {unit}");
        }
        for (labels, value) in samples {
            out.push_str(&name);
            out.push_str(ending);
            for (l, (key, text)) in labels.iter().enumerate() {
                let open = if l == 0 { '{' } else { ',' };
                let text = text
                    .as_ref()
                    .replace('\\', r"\\")
                    .replace('"', "\\\"")
                    .replace('\n', r"\n");
                let _ = write!(out, "{open}{key}=\"{text}\"");
            }
            out.push_str(if N == 0 { "" } else { "}" });
            let _ = writeln!(out, " {value}");
        }
    }
}
