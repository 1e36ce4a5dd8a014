//! Feet of tools on bodies that deform.
//!
//! The deepest point of a contact is a row of its own, so that no small tool sinks in between
//! samples. But where a tool has pressed a surface flat, microns decide which point is deepest, and
//! another one is with every tick: rows there would push each in its turn, and the force would
//! tremble. So a foot that carried goes along with the tool: the point of the tool that pressed
//! presses on, at the place of the surface that it has come to. A query adds a foot only where
//! neither another foot nor four samples hold the surface already. Every row that comes thus comes
//! where it carries nothing yet, and the force is as smooth as the tool's way.

use super::feet::{MAX_FEET, ToolOnBody, push_foot};
use super::warm::WarmRow;
use crate::party::BodyScratch;
use crate::solve::row_key::{FEET_OF_PAIR, RowKey};
use crate::solve::rows::{DeformingView, Row, RowSet};
use palpate_geometry::contact::{Contact, Facing, ToolPoint};
use palpate_geometry::math::{Point3, Pose};

/// Of a ball's radius: how far inside the ball the point lies whose foot on the surface is that of the
/// ball. From the centre it would be the deepest point itself, which bulges of microns move about;
/// from the skin it would never move on the ball. In between the foot comes nearer to the deepest
/// point by this share in a tick, on sharp bodies by more, and keeps its place on the ball where the
/// surface is as round as the ball.
const INWARD: f64 = 0.1;
/// A foot of which samples carry more is left out.
const MOST: f64 = 0.999;
/// Samples on each side that must be pressed before a foot between them gives way.
const FAR: isize = 2;
/// Of the margin: how deep a sample is in free motion that is pressed wholly.
const PRESSED: f64 = 0.1;
/// Of the body's size: feet nearer to each other have come together.
const SAME: f64 = 1e-3;

/// How feet of a tool go along with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Follow {
    /// The foot of a ball rolls to where the normals of both agree.
    Rolls,
    /// The point of the tool that touched touches on: it may never be inside of the body.
    Stays,
    /// A plane has no points of its own: its feet stay where they are on the body.
    OnBody,
}

/// A tool as its feet see it.
pub(super) struct FollowedTool<'a> {
    pub on: ToolOnBody<'a>,
    /// Of the body.
    pub view: &'a DeformingView<'a>,
    pub pose: &'a Pose,
    pub follow: Follow,
    pub size_m: f64,
    /// +1, or −1 below a sheet.
    pub side: f64,
    /// Every which sample is a row.
    pub every: usize,
    /// How much farther than the net shows it was in, m.
    pub sunk_m: f64,
    /// A contact nearer than this to a foot that is there already is no foot of its own.
    pub beside_m: f64,
}

/// Rows of the feet of the last tick and of `found`, deepest first. Rows of samples are there
/// already.
pub(super) fn push_feet<'a>(
    rows: &mut RowSet,
    tool: &FollowedTool<'_>,
    found: impl Iterator<Item = &'a Contact>,
    warm: &[WarmRow],
    parts: &BodyScratch,
    facing: impl Fn(&Point3) -> Option<Facing>,
) {
    let old = || {
        let own = warm.iter().filter(|row| row.id.pair as usize == tool.on.p);
        own.filter_map(|row| match row.id.key {
            RowKey::Foot(number) => Some((u32::from(number), row)),
            _ => None,
        })
    };
    // Numbers of the last tick stay taken: a new foot must not start from what another carried.
    let mut used = old().fold(0u64, |used, (number, _)| used | 1 << number);
    let mut points = [Point3::origin(); MAX_FEET];
    let mut count = 0;
    let apart =
        |points: &[Point3], x: &Point3, m: f64| points.iter().all(|other| (other - x).norm() > m);
    let push = |number: u32, contact: &Contact, share: f64, rows: &mut RowSet| {
        let (key, regularization) = (RowKey::foot(number as usize), share / (1.0 - share));
        push_foot(rows, &tool.on, key, contact, regularization);
    };
    for (number, row) in old() {
        let Some(contact) = tool.followed(row, parts, &facing) else {
            continue;
        };
        let same_m = SAME * tool.size_m;
        if count == MAX_FEET || !apart(&points[..count], &contact.on_body, same_m) {
            continue;
        }
        let share = carried(rows, &contact, tool);
        if share > MOST {
            continue;
        }
        push(number, &contact, share, rows);
        points[count] = contact.on_body;
        count += 1;
    }
    for contact in found {
        let number = (!used).trailing_zeros();
        if count == MAX_FEET || number >= FEET_OF_PAIR {
            return;
        }
        let share = carried(rows, contact, tool);
        if share > MOST
            || held(rows, contact, tool)
            || !apart(&points[..count], &contact.on_body, tool.beside_m)
        {
            continue;
        }
        used |= 1 << number;
        push(number, contact, share, rows);
        points[count] = contact.on_body;
        count += 1;
    }
}

impl FollowedTool<'_> {
    /// Where a foot of the last tick is now.
    fn followed(
        &self,
        row: &WarmRow,
        parts: &BodyScratch,
        facing: impl Fn(&Point3) -> Option<Facing>,
    ) -> Option<Contact> {
        let skin = &parts.skin;
        let [u, v] = row.uv;
        let on_tool = self.pose * Point3::from(row.on_tool);
        let local = |query: &Point3| parts.solver.local(skin, query, u, v);
        let (u, v, on_body) = match self.follow {
            Follow::Rolls => {
                let foot = local(&(on_tool - self.pose * row.on_tool * INWARD))?;
                (foot.u, foot.v, foot.point)
            }
            Follow::OnBody => (u, v, skin.point(u, v)),
            Follow::Stays => {
                let foot = local(&on_tool)?;
                return Some(Contact {
                    u: foot.u,
                    v: foot.v,
                    on_body: foot.point,
                    on_tool,
                    normal: foot.normal * self.side,
                    depth_m: -foot.signed_distance * self.side,
                    tool_uv: None,
                    point: ToolPoint::Found,
                });
            }
        };
        let Facing { gap_m, normal, .. } = facing(&on_body)?;
        Some(Contact {
            u,
            v,
            on_body,
            on_tool: on_body + normal * gap_m,
            normal,
            depth_m: -gap_m,
            tool_uv: None,
            point: ToolPoint::Found,
        })
    }
}

/// Which share of a contact samples carry: 0 near the rim of the contact, 1 where samples are pressed
/// on all sides as far as [`FAR`] of them. It changes smoothly as samples come and go and as the
/// contact moves between them.
fn carried(rows: &RowSet, contact: &Contact, tool: &FollowedTool<'_>) -> f64 {
    let samples = tool.view.samples;
    let Some(around) = samples.around(contact.u, contact.v) else {
        return 0.0;
    };
    let pressed = |sample: usize| {
        let row = row_of(rows, sample, tool)?;
        let deep = -(row.gap_m + tool.sunk_m) / (PRESSED * tool.on.margin_m);
        let near = 1.0 - (row.now_m + tool.sunk_m) / tool.on.margin_m;
        Some(deep.clamp(0.0, 1.0) * near.clamp(0.0, 1.0))
    };
    let inside = |sample: usize| {
        let far = FAR * tool.every as isize;
        let corners = [[-far, -far], [-far, far], [far, -far], [far, far]];
        let share = |by| samples.further(sample, by).and_then(pressed).unwrap_or(0.0);
        corners.into_iter().map(share).fold(1.0, f64::min)
    };
    let shares = around.map(|(sample, weight)| match weight > 0.0 {
        true => weight * inside(sample),
        false => 0.0,
    });
    shares.into_iter().sum()
}

/// Samples on all sides of a contact are pressed: what rises between them is a bulge, and no foot.
fn held(rows: &RowSet, contact: &Contact, tool: &FollowedTool<'_>) -> bool {
    let around = tool.view.samples.around(contact.u, contact.v);
    around.is_some_and(|around| {
        around.into_iter().all(|(sample, weight)| {
            let is_in = |row: &Row| row.gap_m + tool.sunk_m < 0.0;
            weight > 0.0 && row_of(rows, sample, tool).is_some_and(is_in)
        })
    })
}

/// The row of a sample, or of the one that stands for it in a thinned grid.
fn row_of<'a>(rows: &'a RowSet, sample: usize, tool: &FollowedTool<'_>) -> Option<&'a Row> {
    let samples = tool.view.samples;
    let back = samples
        .place(sample)
        .map(|at| -((at % tool.every) as isize));
    let key = RowKey::sample(samples.further(sample, back)?);
    rows.of_pair().iter().find(|row| row.id.key == key)
}
