//! Where a tool rests on a rigid body: points of the tool, each with its number as long as it lasts.
//!
//! Of a tool whose edges are not known a query answers with one point where it lies along a line. With that row alone a
//! bar that may turn would tip over it, to be found at its other end in the next tick: it would rock for ever. So the
//! points of such a tool that touched are remembered, in the tool's frame; each is looked up again where the tool now
//! stands, by descent from its last foot. A point of the tool may never be inside of the body, so such a row is right
//! wherever the tool has rolled to meanwhile.

use super::feet::{MAX_FEET, ToolOnBody, push_foot};
use super::warm::WarmRow;
use crate::party::BodyScratch;
use crate::solve::row_key::{FEET_OF_PAIR, RowKey};
use crate::solve::rows::RowSet;
use palpate_geometry::contact::{Contact, ToolPoint};
use palpate_geometry::math::{Point3, Pose};

/// Points of the tool closer than this, relative to the body's size, are one.
const SAME: f64 = 2e-3;

/// Where the tool stands and how near counts.
pub(super) struct Placed<'a> {
    pub pose: &'a Pose,
    pub size_m: f64,
    /// +1, or −1 below a sheet.
    pub side: f64,
    /// Points that touched are looked up again.
    pub remembers: bool,
}

/// Rows of the contacts on a rigid body found now, and perhaps of those remembered from the last tick.
pub(super) fn push_manifold<'a>(
    rows: &mut RowSet,
    on: &ToolOnBody<'_>,
    found: impl Iterator<Item = &'a Contact>,
    remembered: &[WarmRow],
    parts: &BodyScratch,
    placed: &Placed<'_>,
) {
    let old = || {
        let own = remembered.iter().filter(|row| row.id.pair as usize == on.p);
        own.filter_map(|row| match row.id.key {
            RowKey::Foot(number) => Some((u32::from(number), row)),
            _ => None,
        })
    };
    let apart = |a: &Point3, b: &Point3| (a - b).norm() > SAME * placed.size_m;
    let place = |row: &WarmRow| placed.pose * Point3::from(row.on_tool);
    // Numbers in use, as bits; and those of contacts that are there already.
    let mut used = old().fold(0u64, |used, (number, _)| used | 1 << number);
    let mut taken = 0u64;
    let mut points = [Point3::origin(); MAX_FEET];
    let mut count = 0;
    for contact in found.take(MAX_FEET) {
        let near = |(number, row): &(u32, &WarmRow)| {
            taken >> number & 1 == 0 && !apart(&place(row), &contact.on_tool)
        };
        let number = match old().find(near) {
            Some((number, _)) => number,
            None => (!used).trailing_zeros(),
        };
        if number >= FEET_OF_PAIR {
            continue;
        }
        used |= 1 << number;
        taken |= 1 << number;
        push_foot(rows, on, RowKey::foot(number as usize), contact, 0.0);
        points[count] = contact.on_tool;
        count += 1;
    }
    for (number, row) in old().filter(|_| placed.remembers) {
        let on_tool = place(row);
        if count == MAX_FEET
            || taken >> number & 1 == 1
            || !points[..count].iter().all(|point| apart(point, &on_tool))
        {
            continue;
        }
        let Some(foot) = parts
            .solver
            .local(&parts.skin, &on_tool, row.uv[0], row.uv[1])
        else {
            continue;
        };
        let (normal, depth_m) = (
            foot.normal * placed.side,
            -foot.signed_distance * placed.side,
        );
        // Far off, or no number.
        let near = depth_m > -placed.size_m;
        if !near {
            continue;
        }
        let contact = Contact {
            u: foot.u,
            v: foot.v,
            on_body: foot.point,
            on_tool,
            normal,
            depth_m,
            tool_uv: None,
            point: ToolPoint::Found,
        };
        taken |= 1 << number;
        push_foot(rows, on, RowKey::foot(number as usize), &contact, 0.0);
        points[count] = on_tool;
        count += 1;
    }
}
