//! Where two ticks part: field by field, bit for bit.

use super::super::channel::NetRecord;
use palpate_geometry::math::Point3;
use palpate_sim::tick::record::{ContactReport, TickOutput, ToolOutput};
use serde::Serialize;
use std::slice::from_ref;

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
    first_number(tick, &tick_numbers(recorded), &tick_numbers(replayed))
}

/// Every bit that [`compare`] compares, in order.
pub(in super::super) fn compared_words(
    output: &TickOutput,
    tool_count: usize,
    mut take: impl FnMut(u64),
) {
    let floats = |vectors: &[(&str, &[f64])], take: &mut dyn FnMut(u64)| {
        let values = vectors.iter().flat_map(|(_, values)| *values);
        values.for_each(|x| take(x.to_bits()));
    };
    for tool in output.tools.first(tool_count) {
        tool_numbers(tool).iter().for_each(|(_, n)| take(*n));
        floats(&tool_vectors(tool), &mut take);
        take(
            tool.contact
                .map_or(0, |contact| 1 + u64::from(contact.body)),
        );
        if let Some(contact) = &tool.contact {
            floats(&contact_vectors(contact), &mut take);
        }
    }
    tick_numbers(output).iter().for_each(|(_, n)| take(*n));
}

fn tick_numbers(output: &TickOutput) -> [(&'static str, u64); 5] {
    [
        ("net_revision", output.net_revision),
        ("fault", output.fault.is_some().into()),
        ("moving", output.moving.into()),
        ("quality", output.quality.into()),
        ("state_hash", output.state_hash),
    ]
}

fn tool_numbers(tool: &ToolOutput) -> [(&'static str, u64); 5] {
    [
        ("pose_seq", tool.pose_seq),
        ("t_client_ns", tool.t_client_ns),
        ("pose_age_ticks", tool.pose_age_ticks.into()),
        ("flags", tool.flags.into()),
        ("contact_count", tool.contact_count.into()),
    ]
}

fn tool_vectors(tool: &ToolOutput) -> [(&'static str, &[f64]); 8] {
    [
        ("force_n", tool.force_n.as_slice()),
        ("torque_nm", tool.torque_nm.as_slice()),
        ("proxy_position", tool.proxy_position.coords.as_slice()),
        (
            "proxy_orientation",
            tool.proxy_orientation.coords.as_slice(),
        ),
        ("contact_force_n", tool.contact_force_n.as_slice()),
        ("contact_torque_nm", tool.contact_torque_nm.as_slice()),
        ("energy_j", from_ref(&tool.energy_j)),
        ("dissipated_j", from_ref(&tool.dissipated_j)),
    ]
}

fn contact_vectors(contact: &ContactReport) -> [(&'static str, &[f64]); 6] {
    [
        ("contact.u", from_ref(&contact.u)),
        ("contact.v", from_ref(&contact.v)),
        ("contact.point", contact.point.coords.as_slice()),
        ("contact.normal", contact.normal.as_slice()),
        ("contact.depth_m", from_ref(&contact.depth_m)),
        ("contact.force_n", contact.force_n.as_slice()),
    ]
}

fn compare_tool(tick: u64, a: &ToolOutput, b: &ToolOutput) -> Option<Difference> {
    let errors = [a, b].map(|tool| [("error_n", from_ref(&tool.error_n))]);
    first_number(tick, &tool_numbers(a), &tool_numbers(b))
        .or_else(|| first_vector(tick, &tool_vectors(a), &tool_vectors(b)))
        .or_else(|| match a.error_n.is_nan() {
            // An older file does not say.
            true => None,
            false => first_vector(tick, &errors[0], &errors[1]),
        })
        .or_else(|| match (&a.contact, &b.contact) {
            (None, None) => None,
            (Some(a), Some(b)) if a.body == b.body => {
                first_vector(tick, &contact_vectors(a), &contact_vectors(b))
            }
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

fn first_number(tick: u64, a: &[(&str, u64)], b: &[(&str, u64)]) -> Option<Difference> {
    let ((name, a), (_, b)) = a.iter().zip(b).find(|(a, b)| a != b)?;
    Some(Difference::of_numbers(tick, name, *a, *b))
}

fn first_vector(tick: u64, a: &[(&str, &[f64])], b: &[(&str, &[f64])]) -> Option<Difference> {
    a.iter().zip(b).find_map(|((name, a), (_, b))| {
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
            format!("{name}{part}"),
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
        let edits: [(&str, OutputEdit); 25] = [
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
            ("tools[0].error_n", |o| o.tools[0].error_n = 1.0),
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
