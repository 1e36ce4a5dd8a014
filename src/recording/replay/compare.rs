//! Where two ticks part: field by field, bit for bit.

use super::super::channel::NetRecord;
use palpate_geometry::math::Point3;
use palpate_sim::tick::record::{ContactReport, TickOutput, ToolOutput};
use serde::Serialize;

/// The first place where recording and replay part.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// Tick.
    pub tick: u64,
    /// Field, for example `tools[0].force_n.x`.
    pub field: String,
    /// Recorded value.
    pub recorded: String,
    /// Replayed value.
    pub replayed: String,
    /// Steps of floating point between them, when both are floats.
    pub ulps: Option<u64>,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "tick {}: {} was {}, is {}",
            self.tick, self.field, self.recorded, self.replayed
        )?;
        self.ulps
            .map_or(Ok(()), |ulps| write!(f, " ({ulps} ULPs apart)"))
    }
}

impl Difference {
    pub(super) fn of_numbers(tick: u64, field: &str, recorded: u64, replayed: u64) -> Self {
        let text = |value| {
            if field.ends_with("hash") {
                format!("{value:016x}")
            } else {
                format!("{value}")
            }
        };
        Self {
            tick,
            field: field.into(),
            recorded: text(recorded),
            replayed: text(replayed),
            ulps: None,
        }
    }

    fn of_floats(tick: u64, field: String, recorded: f64, replayed: f64) -> Self {
        // Bits of floats, made monotonic across zero.
        let order = |x: f64| {
            let bits = x.to_bits() as i64;
            if bits < 0 {
                i64::MIN.wrapping_sub(bits)
            } else {
                bits
            }
        };
        let ulps = (!recorded.is_nan() && !replayed.is_nan())
            .then(|| order(recorded).abs_diff(order(replayed)));
        Self {
            tick,
            field,
            recorded: format!("{recorded:e}"),
            replayed: format!("{replayed:e}"),
            ulps,
        }
    }
}

/// First field that is not equal by bits, outputs before the hash: a force says more than a hash.
///
/// What follows from the poses alone (how far a device moved and turned) is not compared; neither
/// are the contacts beyond the deepest of each tool, which recordings do not hold. The state hash
/// covers what makes both.
pub(super) fn compare(
    recorded: &TickOutput,
    replayed: &TickOutput,
    tool_count: usize,
) -> Option<Difference> {
    let tick = recorded.tick;
    if tick != replayed.tick {
        return Some(Difference::of_numbers(tick, "tick", tick, replayed.tick));
    }
    for t in 0..tool_count {
        let (a, b) = (&recorded.tools[t], &replayed.tools[t]);
        let apart = compare_tool(tick, a, b);
        if let Some(mut difference) = apart {
            difference.field.insert_str(0, &format!("tools[{t}]."));
            return Some(difference);
        }
    }
    let fault = |output: &TickOutput| u64::from(output.fault.is_some());
    let numbers = [
        ("net_revision", recorded.net_revision, replayed.net_revision),
        ("fault", fault(recorded), fault(replayed)),
        ("moving", recorded.moving.into(), replayed.moving.into()),
        ("quality", recorded.quality.into(), replayed.quality.into()),
        ("state_hash", recorded.state_hash, replayed.state_hash),
    ];
    first_number(tick, &numbers)
}

fn compare_tool(tick: u64, a: &ToolOutput, b: &ToolOutput) -> Option<Difference> {
    let numbers = [
        ("pose_seq", a.pose_seq, b.pose_seq),
        ("t_client_ns", a.t_client_ns, b.t_client_ns),
        (
            "pose_age_ticks",
            a.pose_age_ticks.into(),
            b.pose_age_ticks.into(),
        ),
        ("flags", a.flags.into(), b.flags.into()),
        (
            "contact_count",
            a.contact_count.into(),
            b.contact_count.into(),
        ),
    ];
    let vectors = [
        ("force_n", a.force_n.as_slice(), b.force_n.as_slice()),
        ("torque_nm", a.torque_nm.as_slice(), b.torque_nm.as_slice()),
        (
            "proxy_position",
            a.proxy_position.coords.as_slice(),
            b.proxy_position.coords.as_slice(),
        ),
        (
            "proxy_orientation",
            a.proxy_orientation.coords.as_slice(),
            b.proxy_orientation.coords.as_slice(),
        ),
        (
            "contact_force_n",
            a.contact_force_n.as_slice(),
            b.contact_force_n.as_slice(),
        ),
        (
            "contact_torque_nm",
            a.contact_torque_nm.as_slice(),
            b.contact_torque_nm.as_slice(),
        ),
        (
            "energy_j",
            std::slice::from_ref(&a.energy_j),
            std::slice::from_ref(&b.energy_j),
        ),
        (
            "dissipated_j",
            std::slice::from_ref(&a.dissipated_j),
            std::slice::from_ref(&b.dissipated_j),
        ),
    ];
    first_number(tick, &numbers)
        .or_else(|| first_vector(tick, "", &vectors))
        .or_else(|| match (&a.contact, &b.contact) {
            (None, None) => None,
            (Some(a), Some(b)) if a.body == b.body => compare_contact(tick, a, b),
            (a, b) => {
                let body = |contact: &Option<ContactReport>| {
                    contact.map_or("none".into(), |c| format!("body {}", c.body))
                };
                let (recorded, replayed) = (body(a), body(b));
                Some(Difference {
                    tick,
                    field: "contact.body".into(),
                    recorded,
                    replayed,
                    ulps: None,
                })
            }
        })
}

fn compare_contact(tick: u64, a: &ContactReport, b: &ContactReport) -> Option<Difference> {
    let one = std::slice::from_ref;
    let vectors = [
        ("u", one(&a.u), one(&b.u)),
        ("v", one(&a.v), one(&b.v)),
        (
            "point",
            a.point.coords.as_slice(),
            b.point.coords.as_slice(),
        ),
        ("normal", a.normal.as_slice(), b.normal.as_slice()),
        ("depth_m", one(&a.depth_m), one(&b.depth_m)),
        ("force_n", a.force_n.as_slice(), b.force_n.as_slice()),
    ];
    first_vector(tick, "contact.", &vectors)
}

/// Equal in body, revision and every bit of every point.
pub(super) fn compare_net(recorded: &NetRecord, net: &[Point3]) -> Option<Difference> {
    let field = |what: String| format!("body {:?} net {what}", recorded.body);
    let count = 3 * net.len();
    if recorded.points.len() != count {
        let (a, b) = (recorded.points.len() as u64, count as u64);
        return Some(Difference::of_numbers(
            recorded.tick,
            &field("length".into()),
            a,
            b,
        ));
    }
    let replayed = || net.iter().flat_map(|point| point.coords.as_slice());
    let k = recorded
        .points
        .iter()
        .zip(replayed())
        .position(|(x, y)| x.to_bits() != y.to_bits())?;
    let field = field(format!("point {} coordinate {}", k / 3, k % 3));
    Some(Difference::of_floats(
        recorded.tick,
        field,
        recorded.points[k],
        net[k / 3].coords[k % 3],
    ))
}

fn first_number(tick: u64, pairs: &[(&str, u64, u64)]) -> Option<Difference> {
    let (name, a, b) = pairs.iter().find(|(_, a, b)| a != b)?;
    Some(Difference::of_numbers(tick, name, *a, *b))
}

fn first_vector(tick: u64, prefix: &str, pairs: &[(&str, &[f64], &[f64])]) -> Option<Difference> {
    pairs.iter().find_map(|(name, a, b)| {
        let k = a
            .iter()
            .zip(*b)
            .position(|(x, y)| x.to_bits() != y.to_bits())?;
        let part = if a.len() > 1 {
            [".x", ".y", ".z", ".w"][k]
        } else {
            ""
        };
        Some(Difference::of_floats(
            tick,
            format!("{prefix}{name}{part}"),
            a[k],
            b[k],
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::{Rotation, Vector3};
    use palpate_sim::solve::rows::Holder;

    #[test]
    fn zeros_of_either_sign_are_apart_and_equal_nans_are_not() {
        let mut a = TickOutput {
            tick: 7,
            ..TickOutput::default()
        };
        let mut b = a.clone();
        (a.tools[1].force_n.y, b.tools[1].force_n.y) = (f64::NAN, f64::NAN);
        assert_eq!(compare(&a, &b, 2), None);
        (a.tools[1].force_n.z, b.tools[1].force_n.z) = (0.0, -0.0);
        let found = compare(&a, &b, 2).unwrap();
        assert_eq!(
            (found.tick, found.field.as_str(), found.ulps),
            (7, "tools[1].force_n.z", Some(0))
        );
        // A scene has one tool: the slot of the second is of no meaning.
        assert_eq!(compare(&a, &b, 1), None);
    }

    #[test]
    fn every_field_is_compared_and_named() {
        let contact = ContactReport {
            body: 1,
            holder: Holder::Tool(0),
            u: 0.5,
            v: 0.5,
            point: Point3::origin(),
            normal: Vector3::zeros(),
            depth_m: 0.1,
            force_n: Vector3::zeros(),
        };
        let mut whole = TickOutput {
            tick: 3,
            ..TickOutput::default()
        };
        whole.tools[0].contact = Some(contact);
        type OutputEdit = fn(&mut TickOutput);
        let turned = |output: &mut TickOutput| {
            output.tools[0].proxy_orientation =
                Rotation::new_unchecked(nalgebra::Quaternion::new(0.5, 0.0, 0.0, 0.0));
        };
        let edits: [(&str, OutputEdit); 24] = [
            ("tick", |o| o.tick = 4),
            ("tools[0].pose_seq", |o| o.tools[0].pose_seq = 1),
            ("tools[0].t_client_ns", |o| o.tools[0].t_client_ns = 1),
            ("tools[0].pose_age_ticks", |o| o.tools[0].pose_age_ticks = 1),
            ("tools[0].flags", |o| o.tools[0].flags = 1),
            ("tools[0].contact_count", |o| o.tools[0].contact_count = 1),
            ("tools[0].torque_nm.x", |o| o.tools[0].torque_nm.x = 1.0),
            ("tools[0].proxy_position.y", |o| {
                o.tools[0].proxy_position.y = 1.0
            }),
            ("tools[0].proxy_orientation.w", turned),
            ("tools[0].contact_force_n.z", |o| {
                o.tools[0].contact_force_n.z = 1.0
            }),
            ("tools[0].contact_torque_nm.z", |o| {
                o.tools[0].contact_torque_nm.z = 1.0
            }),
            ("tools[0].energy_j", |o| o.tools[0].energy_j = 1.0),
            ("tools[0].dissipated_j", |o| o.tools[0].dissipated_j = 1.0),
            ("tools[0].contact.body", |o| o.tools[0].contact = None),
            ("tools[0].contact.u", |o| {
                o.tools[0].contact.as_mut().unwrap().u = 0.1
            }),
            ("tools[0].contact.point.x", |o| {
                o.tools[0].contact.as_mut().unwrap().point.x = 0.1
            }),
            ("tools[0].contact.normal.z", |o| {
                o.tools[0].contact.as_mut().unwrap().normal.z = 0.1
            }),
            ("tools[0].contact.depth_m", |o| {
                o.tools[0].contact.as_mut().unwrap().depth_m = 0.2
            }),
            ("tools[0].contact.force_n.y", |o| {
                o.tools[0].contact.as_mut().unwrap().force_n.y = 0.2
            }),
            ("net_revision", |o| o.net_revision = 1),
            ("fault", |o| {
                o.fault = Some(palpate_sim::tick::record::TickFault::NotFinite)
            }),
            ("moving", |o| o.moving = true),
            ("quality", |o| o.quality = 1),
            ("state_hash", |o| o.state_hash = 1),
        ];
        for (field, edit) in edits {
            let mut other = whole.clone();
            edit(&mut other);
            assert_eq!(
                compare(&whole, &other, 1)
                    .map(|found| found.field)
                    .as_deref(),
                Some(field)
            );
        }
    }
}
