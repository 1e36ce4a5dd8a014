//! What is counted, as OpenMetrics text.

use super::clients::ClientCounts;
use crate::drive::overload::CAUSES;
use palpate_proto::messages::{LoopState, LoopStatus, Quantiles, ToolLink};
use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, EncodeLabelSet, EncodeMetric, text};
use prometheus_client::metrics::MetricType;
use prometheus_client::metrics::counter::ConstCounter;
use prometheus_client::metrics::gauge::ConstGauge;
use prometheus_client::metrics::info::Info;
use prometheus_client::registry::{Registry, Unit};
use std::fmt::Error;
use std::sync::{Arc, Mutex, PoisonError};

/// What came of messages that an adapter took from other programs: tool, what became of them, how many.
pub type AdapterCount = (String, &'static str, u64);

type Source = Box<dyn Fn() -> Vec<AdapterCount> + Send>;

/// Counters of adapters, which come and go while the bus runs.
#[derive(Clone, Default)]
pub struct AdapterCounts(Arc<Mutex<Vec<Source>>>);

impl AdapterCounts {
    /// Adds counters; `read` is called ten times a second.
    pub fn add(&self, read: impl Fn() -> Vec<AdapterCount> + Send + 'static) {
        let mut sources = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        sources.push(Box::new(read));
    }

    /// All of them now.
    pub fn read(&self) -> Vec<AdapterCount> {
        let sources = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        sources.iter().flat_map(|read| read()).collect()
    }
}

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
        let mut registry = Registry::with_prefix("palpate");
        registry.register_collector(Box::new(self.clone()));
        let mut out = String::new();
        // Writing into a string does not fail.
        let _ = text::encode(&mut out, &registry);
        out
    }

    fn tools(&self) -> impl Iterator<Item = (usize, &str)> {
        self.status
            .tools
            .iter()
            .enumerate()
            .map(|(t, tool)| (t, tool.tool.as_str()))
    }
}

type ToolCount = fn(&ToolLink) -> u64;
type Label<'a> = [(&'static str, &'a str); 1];

/// One value without labels.
fn one(
    encoder: &mut DescriptorEncoder<'_>,
    name: &str,
    help: &str,
    unit: Option<&Unit>,
    metric: &impl EncodeMetric,
) -> Result<(), Error> {
    metric.encode(encoder.encode_descriptor(name, help, unit, metric.metric_type())?)
}

/// One value for each set of labels.
fn many<L: EncodeLabelSet, M: EncodeMetric>(
    encoder: &mut DescriptorEncoder<'_>,
    name: &str,
    help: &str,
    unit: Option<&Unit>,
    kind: MetricType,
    values: impl IntoIterator<Item = (L, M)>,
) -> Result<(), Error> {
    let mut family = encoder.encode_descriptor(name, help, unit, kind)?;
    for (labels, metric) in values {
        metric.encode(family.encode_family(&labels)?)?;
    }
    Ok(())
}

fn quantiles(values: &Quantiles) -> [(Label<'static>, ConstGauge<f64>); 3] {
    let gauge = |ns: u64| ConstGauge::new(ns as f64 * 1e-9);
    [
        ([("quantile", "0.5")], gauge(values.p50_ns)),
        ([("quantile", "0.99")], gauge(values.p99_ns)),
        ([("quantile", "1")], gauge(values.max_ns)),
    ]
}

impl Collector for LoopMetrics {
    fn encode(&self, mut encoder: DescriptorEncoder<'_>) -> Result<(), Error> {
        let e = &mut encoder;
        let status = &self.status;
        let (hertz, seconds) = (Unit::Other("hertz".into()), Unit::Seconds);
        let count = |value: u64| ConstCounter::new(value);
        let gauge = |value: u64| ConstGauge::new(value as i64);
        let (version, instance, scene) = (env!("CARGO_PKG_VERSION"), &self.instance, &self.scene);
        let words = vec![
            ("version", version),
            ("instance", instance.as_str()),
            ("scene", scene.as_str()),
        ];
        one(e, "build", "What runs here", None, &Info::new(words))?;
        let help = "Endpoints where others than this machine and holders of identities may come in";
        one(e, "open_endpoints", help, None, &gauge(self.open))?;
        one(e, "loop_ticks", "Ticks run", None, &count(status.tick))?;
        one(
            e,
            "loop_late_ticks",
            "Ticks that began more than 100 us late",
            None,
            &count(status.late_ticks),
        )?;
        one(
            e,
            "loop_skipped_ticks",
            "Deadlines dropped",
            None,
            &count(status.skipped_ticks),
        )?;
        one(
            e,
            "loop_rate",
            "Nominal rate",
            Some(&hertz),
            &ConstGauge::new(status.rate_hz),
        )?;
        one(
            e,
            "loop_measured_rate",
            "Ticks a second by the clock; below half the nominal rate forces fade",
            Some(&hertz),
            &ConstGauge::new(self.measured_hz),
        )?;
        one(
            e,
            "loop_forces_overtaken",
            "Ticks whose forces were not sent because newer ones were there",
            None,
            &count(self.overtaken),
        )?;
        let state = match status.state {
            LoopState::Running => 0,
            LoopState::Paused => 1,
            LoopState::Stopping => 2,
        };
        one(
            e,
            "loop_state",
            "0 running, 1 paused, 2 stopping",
            None,
            &gauge(state),
        )?;
        one(
            e,
            "loop_quality",
            "Level of quality, 0 is full",
            None,
            &gauge(status.quality_level.into()),
        )?;
        let help = "Time between tick starts over the last status period";
        many(
            e,
            "loop_period",
            help,
            Some(&seconds),
            MetricType::Gauge,
            quantiles(&status.period),
        )?;
        let help = "Time in a tick over the last status period";
        many(
            e,
            "loop_step",
            help,
            Some(&seconds),
            MetricType::Gauge,
            quantiles(&status.step),
        )?;
        let overruns = CAUSES
            .iter()
            .zip(self.overruns)
            .map(|(cause, value)| ([("stage", *cause)], count(value)));
        many(
            e,
            "loop_overruns",
            "Ticks longer than their period",
            None,
            MetricType::Counter,
            overruns,
        )?;
        one(
            e,
            "bus_drops",
            "Records that the bus did not take in time",
            None,
            &count(self.bus_drops),
        )?;
        one(e, "events", "Events published", None, &count(self.events))?;
        one(
            e,
            "recorder_state",
            "0 off, 1 recording, 2 ring, 3 failed",
            None,
            &gauge(status.recorder as u64),
        )?;
        let help = "Bytes written by the recorder";
        one(
            e,
            "recorder_written",
            help,
            Some(&Unit::Bytes),
            &count(status.recorder_bytes),
        )?;
        one(
            e,
            "recorder_drops",
            "Records lost by the recorder",
            None,
            &count(status.recorder_drops),
        )?;
        self.encode_tools(e)
    }
}

impl LoopMetrics {
    /// What reaches the client of each tool, where it says so.
    fn encode_clients(&self, e: &mut DescriptorEncoder<'_>) -> Result<(), Error> {
        let clients = || {
            let clients = self.tools().zip(&self.clients);
            clients.filter_map(|((_, tool), counts)| Some((tool, counts.as_ref()?)))
        };
        type Read = fn(&ClientCounts) -> u64;
        let counters: [(&str, &str, Read); 2] = [
            (
                "client_forces_published",
                "Forces sent to the client that holds a tool, since it has it",
                |counts| counts.published,
            ),
            (
                "client_forces_received",
                "Forces that reached it, as it says",
                |counts| counts.received,
            ),
        ];
        for (name, help, value) in counters {
            let values = clients().map(|(tool, counts)| {
                let labels = [("tool", tool), ("client", counts.client.as_str())];
                (labels, ConstCounter::new(value(counts)))
            });
            many(e, name, help, None, MetricType::Counter, values)?;
        }
        let ages = clients().flat_map(|(tool, counts)| {
            let quantiles = ["0.5", "0.99", "1"].into_iter().zip(counts.age_ns);
            quantiles.map(move |(quantile, ns)| {
                let client = counts.client.as_str();
                let labels = [("tool", tool), ("client", client), ("quantile", quantile)];
                (labels, ConstGauge::new(ns as f64 * 1e-9))
            })
        });
        let help =
            "Age of the newest force that a client had when it sent a pose, as that pose arrived";
        let (seconds, kind) = (Unit::Seconds, MetricType::Gauge);
        many(e, "client_force_age", help, Some(&seconds), kind, ages)
    }

    fn encode_tools(&self, e: &mut DescriptorEncoder<'_>) -> Result<(), Error> {
        let tools = &self.status.tools;
        let of = |values: &[u64], t: usize| ConstCounter::new(values.get(t).copied().unwrap_or(0));
        let counters: [(&str, &str, ToolCount); 4] = [
            ("tool_poses_received", "Poses taken", |tool| tool.received),
            (
                "tool_poses_superseded",
                "Poses that a newer one replaced before a tick used them",
                |tool| tool.superseded,
            ),
            (
                "tool_poses_jumped",
                "Poses that the loop refused as a jump",
                |tool| tool.jumps,
            ),
            (
                "tool_stale_ticks",
                "Ticks whose newest pose was stale",
                |tool| tool.stale_ticks,
            ),
        ];
        for (name, help, value) in counters {
            let values = tools.iter().map(|tool| {
                (
                    [("tool", tool.tool.as_str())],
                    ConstCounter::new(value(tool)),
                )
            });
            many(e, name, help, None, MetricType::Counter, values)?;
        }
        let refused = tools.iter().flat_map(|tool| {
            let labels = |cause| [("tool", tool.tool.as_str()), ("cause", cause)];
            tool.refused()
                .map(|(cause, value)| (labels(cause), ConstCounter::new(value)))
        });
        many(
            e,
            "tool_poses_refused",
            "Poses dropped before the loop",
            None,
            MetricType::Counter,
            refused,
        )?;
        let adapters = self.adapters.iter().map(|(tool, what, value)| {
            let labels = [("tool", tool.as_str()), ("outcome", *what)];
            (labels, ConstCounter::new(*value))
        });
        let help = "Poses of ROS 2 drivers, by what became of them";
        many(e, "ros2_poses", help, None, MetricType::Counter, adapters)?;
        let published = tools.iter().map(|tool| {
            (
                [("tool", tool.tool.as_str())],
                ConstCounter::new(tool.forces_sent),
            )
        });
        let help = "Forces sent to devices";
        many(
            e,
            "tool_forces_published",
            help,
            None,
            MetricType::Counter,
            published,
        )?;
        self.encode_clients(e)?;
        let strangers = self
            .tools()
            .map(|(t, id)| ([("tool", id)], of(&self.strangers, t)));
        let help = "Poses of clients that did not hold the tool";
        many(
            e,
            "tool_poses_of_strangers",
            help,
            None,
            MetricType::Counter,
            strangers,
        )?;
        let suppressed = self
            .tools()
            .map(|(t, id)| ([("tool", id)], of(&self.suppressed, t)));
        let help = "Forces left out by a deadband";
        many(
            e,
            "tool_forces_suppressed",
            help,
            None,
            MetricType::Counter,
            suppressed,
        )?;
        let refused = self
            .tools()
            .map(|(t, id)| ([("tool", id)], of(&self.descriptions_refused, t)));
        let help = "Descriptions of devices that were dropped";
        many(
            e,
            "tool_descriptions_refused",
            help,
            None,
            MetricType::Counter,
            refused,
        )?;
        let energy = tools.iter().map(|tool| {
            (
                [("tool", tool.tool.as_str())],
                ConstGauge::new(tool.energy_j),
            )
        });
        many(
            e,
            "tool_energy",
            "Net work of the hand",
            Some(&Unit::Joules),
            MetricType::Gauge,
            energy,
        )
    }
}
