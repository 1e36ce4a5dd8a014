//! Quantities of a tick by name, each written once: tables, plots, measures, figures and Python read them from here.
//!
//! A new one is an entry at the end of [`QUANTITIES`] (of a tool) or [`OF_LOOP`]: tables of ticks keep their columns in
//! this order. Reading allocates nothing.

use super::record::{TickRecord, ToolOutput};
use crate::haptics::DevicePose;
use palpate_geometry::math::{Point3, Rotation, Vector3};

/// Most components of a quantity.
pub const MOST_COMPONENTS: usize = 7;

/// Components of a quantity; those that it does not have are zero.
pub type Components = [f64; MOST_COMPONENTS];

/// A tool in a tick.
#[derive(Clone, Copy, Debug)]
pub struct ToolTick<'a> {
    /// The pose that the tick got; none where there was no news, or where only outputs are known.
    pub pose: Option<&'a DevicePose>,
    /// What came out.
    pub output: &'a ToolOutput,
}

impl<'a> ToolTick<'a> {
    /// A tool of a record.
    pub fn of(record: &'a TickRecord, tool: usize) -> Self {
        Self {
            pose: record.input.poses[tool].as_ref(),
            output: &record.output.tools[tool],
        }
    }
}

impl<'a> From<&'a ToolOutput> for ToolTick<'a> {
    fn from(output: &'a ToolOutput) -> Self {
        Self { pose: None, output }
    }
}

/// How a quantity is read; `None` where a tick has no such thing.
#[derive(Clone, Copy, Debug)]
pub enum Read {
    /// One number or several.
    Numbers(fn(&ToolOutput) -> Option<Components>),
    /// A whole number.
    Whole(fn(&ToolOutput) -> u64),
    /// Index of a body.
    Body(fn(&ToolOutput) -> Option<u32>),
    /// Numbers of the pose that a tick got.
    OfPose(fn(&DevicePose) -> Components),
    /// A whole number of that pose.
    WholeOfPose(fn(&DevicePose) -> u32),
}

/// Something that a tick says of each tool.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// In Python, in measures of scenarios, in columns of sweeps and in plots.
    pub name: &'static str,
    /// Of SI; empty where it has none, and where components have several.
    pub unit: &'static str,
    /// In words.
    pub meaning: &'static str,
    /// Headings of its components in tables of ticks.
    pub columns: &'static [&'static str],
    /// Where it comes from.
    pub read: Read,
    /// What programs get where there is none; tables stay empty.
    pub absent: f64,
}

const fn quantity(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    columns: &'static [&'static str],
    read: Read,
) -> Quantity {
    Quantity {
        name,
        unit,
        meaning,
        columns,
        read,
        absent: f64::NAN,
    }
}

#[rustfmt::skip]
/// Quantities of a tool, in the order of tables.
pub const QUANTITIES: &[Quantity] = &[
    quantity("pose", "m", "position and quaternion x y z w of the device, as applied in the tick",
        &["position_x_m", "position_y_m", "position_z_m", "orientation_x", "orientation_y", "orientation_z", "orientation_w"],
        Read::OfPose(|pose| placed(&pose.position, &pose.orientation))),
    quantity("velocity", "", "linear, m/s, and angular, rad/s, velocity of the device, as applied in the tick",
        &["velocity_x_m_s", "velocity_y_m_s", "velocity_z_m_s", "turning_x_rad_s", "turning_y_rad_s", "turning_z_rad_s"],
        Read::OfPose(|pose| {
            let (v, w) = (pose.linear_velocity, pose.angular_velocity);
            [v.x, v.y, v.z, w.x, w.y, w.z, 0.0]
        })),
    quantity("buttons", "", "bits of the buttons of the pose", &["buttons"],
        Read::WholeOfPose(|pose| pose.buttons)),
    quantity("pose_seq", "", "number of the pose that the tick answers", &["pose_seq"],
        Read::Whole(|out| out.pose_seq)),
    quantity("t_client_ns", "ns", "time of that pose on the clock of its client", &["t_client_ns"],
        Read::Whole(|out| out.t_client_ns)),
    quantity("pose_age_ticks", "ticks", "age of the pose in effect", &["pose_age_ticks"],
        Read::Whole(|out| u64::from(out.pose_age_ticks))),
    quantity("force", "N", "force for the device, world axes", &["force_x_n", "force_y_n", "force_z_n"],
        Read::Numbers(|out| three(&out.force_n))),
    quantity("torque", "N·m", "torque for the device at the tool's reference point",
        &["torque_x_nm", "torque_y_nm", "torque_z_nm"],
        Read::Numbers(|out| three(&out.torque_nm))),
    quantity("contact_force", "N", "force of all contacts, neither damped nor limited for the device",
        &["contact_force_x_n", "contact_force_y_n", "contact_force_z_n"],
        Read::Numbers(|out| three(&out.contact_force_n))),
    quantity("contact_torque", "N·m", "torque of all contacts about the tool's reference point",
        &["contact_torque_x_nm", "contact_torque_y_nm", "contact_torque_z_nm"],
        Read::Numbers(|out| three(&out.contact_torque_nm))),
    quantity("proxy", "m", "where the surface holds the tool back: position and quaternion x y z w",
        &["proxy_x_m", "proxy_y_m", "proxy_z_m", "proxy_orientation_x", "proxy_orientation_y", "proxy_orientation_z", "proxy_orientation_w"],
        Read::Numbers(|out| Some(placed(&out.proxy_position, &out.proxy_orientation)))),
    quantity("contact_uv", "", "surface parameters of the deepest contact", &["contact_u", "contact_v"],
        Read::Numbers(|out| out.contact.map(|contact| [contact.u, contact.v, 0.0, 0.0, 0.0, 0.0, 0.0]))),
    Quantity { absent: 0.0, ..quantity("depth", "m", "penetration of the device's tool; 0 without contact", &["depth_m"],
        Read::Numbers(|out| out.contact.and_then(|contact| one(contact.depth_m)))) },
    quantity("contact_point", "m", "point of the deepest contact on the surface",
        &["contact_x_m", "contact_y_m", "contact_z_m"],
        Read::Numbers(|out| out.contact.and_then(|contact| three(&contact.point.coords)))),
    quantity("contact_normal", "", "outward unit normal there", &["normal_x", "normal_y", "normal_z"],
        Read::Numbers(|out| out.contact.and_then(|contact| three(&contact.normal)))),
    quantity("contact_body", "", "body of the deepest contact", &["contact_body"],
        Read::Body(|out| out.contact.map(|contact| contact.body))),
    quantity("contact_count", "", "contacts that carried force", &["contact_count"],
        Read::Whole(|out| u64::from(out.contact_count))),
    quantity("energy", "J", "net work of the device on the loop since the start", &["energy_j"],
        Read::Numbers(|out| one(out.energy_j))),
    quantity("dissipated", "J", "the part of the energy that the passivity controller took away", &["dissipated_j"],
        Read::Numbers(|out| one(out.dissipated_j))),
    quantity("flags", "", "bits of `ForceFlags`", &["flags"],
        Read::Whole(|out| u64::from(out.flags))),
    // Older files do not say.
    quantity("error_n", "N", "how far the force may be from that of the exact step of the same length: an estimate", &["error_n"],
        Read::Numbers(|out| one(out.error_n).filter(|_| !out.error_n.is_nan()))),
];

/// Something that a tick says once, whatever its tools: a whole number.
#[derive(Clone, Copy, Debug)]
pub struct OfLoop {
    /// In Python.
    pub name: &'static str,
    /// In words.
    pub meaning: &'static str,
    /// Heading in tables of ticks, where it is in them.
    pub column: Option<&'static str>,
    /// Where it comes from.
    pub read: fn(&TickRecord) -> u64,
}

const fn of_loop(
    name: &'static str,
    meaning: &'static str,
    column: Option<&'static str>,
    read: fn(&TickRecord) -> u64,
) -> OfLoop {
    OfLoop {
        name,
        meaning,
        column,
        read,
    }
}

#[rustfmt::skip]
/// Quantities of the loop, in the order of tables.
pub const OF_LOOP: &[OfLoop] = &[
    of_loop("tick", "number of the tick, from 1", None, |record| record.output.tick),
    of_loop("moving", "1: bodies moved", Some("moving"), |record| u64::from(record.output.moving)),
    of_loop("quality", "level of quality, 0 is full", Some("quality"), |record| u64::from(record.output.quality)),
    of_loop("fault", "1: something went wrong, and the force was made safe", Some("fault"), |record| u64::from(record.output.fault.is_some())),
    of_loop("net_revision", "grows when any net changed", Some("net_revision"), |record| record.output.net_revision),
    of_loop("hash", "hash of all state after the tick", Some("state_hash"), |record| record.output.state_hash),
    of_loop("skipped", "deadlines dropped before the tick", Some("skipped"), |record| u64::from(record.input.skipped)),
    of_loop("late_ns", "how late the tick began, ns", Some("late_ns"), |record| record.late_ns),
    of_loop("wait_ns", "how long the pose waited that waited longest of those the tick took, ns; 0 where it took none", None, |record| record.wait_ns.unwrap_or(0)),
    of_loop("step_ns", "wall time of all stages, ns", None, |record| record.stage_ns.total()),
];

fn one(x: f64) -> Option<Components> {
    Some([x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
}

fn three(v: &Vector3) -> Option<Components> {
    Some([v.x, v.y, v.z, 0.0, 0.0, 0.0, 0.0])
}

fn placed(p: &Point3, q: &Rotation) -> Components {
    let q = q.coords;
    [p.x, p.y, p.z, q.x, q.y, q.z, q.w]
}

impl Quantity {
    /// The quantity of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        QUANTITIES.iter().find(|quantity| quantity.name == name)
    }

    /// Number of its components.
    pub const fn width(&self) -> usize {
        self.columns.len()
    }

    /// Its components as numbers; `None` where there is no such thing.
    pub fn components(&self, of: &ToolTick<'_>) -> Option<Components> {
        match self.read {
            Read::Numbers(read) => read(of.output),
            Read::Whole(read) => one(read(of.output) as f64),
            Read::Body(read) => read(of.output).and_then(|body| one(f64::from(body))),
            Read::OfPose(read) => of.pose.map(read),
            Read::WholeOfPose(read) => of.pose.and_then(|pose| one(f64::from(read(pose)))),
        }
    }

    /// It is of the pose that a tick got, not of what came out.
    pub const fn is_of_pose(&self) -> bool {
        matches!(self.read, Read::OfPose(_) | Read::WholeOfPose(_))
    }

    /// Appends its components, [`Self::absent`] where there are none.
    pub fn push(&self, of: &ToolTick<'_>, to: &mut Vec<f64>) {
        let components = self.components(of).unwrap_or([self.absent; _]);
        to.extend_from_slice(&components[..self.width()]);
    }

    /// Writes its components, [`Self::absent`] where there are none, into a row that has room for them.
    pub fn write(&self, of: &ToolTick<'_>, row: &mut [f64]) {
        let components = self.components(of).unwrap_or([self.absent; _]);
        row.copy_from_slice(&components[..self.width()]);
    }
}

/// One number of a quantity: a scalar, the length of a vector, or one component.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    quantity: &'static Quantity,
    component: Option<usize>,
}

impl Number {
    /// By the name of a quantity (`force`, a vector's length) or of a column of tables (`force_x_n`).
    pub fn named(name: &str) -> Option<Self> {
        QUANTITIES.iter().find_map(|quantity| {
            let component = quantity.columns.iter().position(|column| *column == name);
            let whole = quantity.name == name && matches!(quantity.width(), 1 | 3);
            (whole || component.is_some()).then_some(Self {
                quantity,
                component,
            })
        })
    }

    /// All names that there are.
    pub fn names() -> impl Iterator<Item = &'static str> {
        QUANTITIES.iter().flat_map(|quantity| {
            let whole = matches!(quantity.width(), 1 | 3).then_some(quantity.name);
            let columns = quantity.columns.iter().copied();
            let columns = columns.filter(move |column| whole != Some(*column));
            whole.into_iter().chain(columns)
        })
    }

    /// That of the quantity, or of its column.
    pub fn name(&self) -> &'static str {
        let quantity = self.quantity;
        self.component
            .map_or(quantity.name, |k| quantity.columns[k])
    }

    /// What it is of.
    pub fn quantity(&self) -> &'static Quantity {
        self.quantity
    }

    /// Its value; [`Quantity::absent`] where there is none.
    pub fn of(&self, of: &ToolTick<'_>) -> f64 {
        match (self.quantity.components(of), self.component) {
            (None, _) => self.quantity.absent,
            (Some(components), Some(k)) => components[k],
            (Some([x, y, z, ..]), None) if self.quantity.width() == 3 => {
                Vector3::new(x, y, z).norm()
            }
            (Some([x, ..]), None) => x,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_each_reads_as_its_components_say() {
        let mut names: Vec<&str> = QUANTITIES.iter().map(|quantity| quantity.name).collect();
        let columns = || QUANTITIES.iter().flat_map(|quantity| quantity.columns);
        names.extend(columns().filter(|column| Quantity::named(column).is_none()));
        names.extend(OF_LOOP.iter().map(|quantity| quantity.name));
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count, "{names:?}");
        let output = ToolOutput {
            force_n: Vector3::new(3.0, 0.0, -4.0),
            error_n: f64::NAN,
            ..ToolOutput::default()
        };
        let of = ToolTick::from(&output);
        for name in Number::names() {
            assert!(Number::named(name).is_some(), "{name}");
        }
        for quantity in QUANTITIES {
            assert!(!quantity.meaning.is_empty() && quantity.width() <= MOST_COMPONENTS);
            let mut row = vec![1.0; quantity.width()];
            quantity.write(&of, &mut row);
            let absent = quantity.components(&of).is_none();
            assert_eq!(row[0].is_nan(), absent && quantity.name != "depth");
        }
        let number = |name: &str| Number::named(name).unwrap().of(&of);
        assert_eq!((number("force"), number("force_z_n")), (5.0, -4.0));
        assert!(number("depth") == 0.0 && number("error_n").is_nan());
        assert!(Number::named("pose").is_none() && Number::named("banana").is_none());
    }
}
