//! Feet of two bodies that meet.
//!
//! Every contact of a query is a row where the query finds it: a foot that only came after the deepest
//! point would push a ball that rolls from behind, out of nothing. But a contact keeps the number of the
//! foot that it was in the last tick, so that solves start from what it carried and friction remembers
//! where it stuck.

use super::feet::{MAX_FEET, push_between};
use super::lying;
use super::warm::WarmRow;
use crate::party::BodyScratch;
use crate::party::Gives;
use crate::party::RigidStep;
use crate::scene::Pair;
use crate::solve::row_key::{FEET_OF_PAIR, RowKey};
use crate::solve::rows::{DeformingView, RowSet};
use palpate_geometry::contact::{Contact, ToolPoint};
use palpate_geometry::math::Point3;

/// Two bodies that meet: the pair's body first, then its holder.
pub(super) struct Meeting<'a> {
    pub p: usize,
    pub pair: &'a Pair,
    /// Of the pair's body.
    pub parts: &'a BodyScratch,
    /// Of the holder.
    pub theirs: &'a BodyScratch,
    pub views: [Option<DeformingView<'a>>; 2],
    /// How each goes within the tick, of rigid bodies that move.
    pub steps: [RigidStep; 2],
    pub margin_m: f64,
    /// Size of the pair's body, m.
    pub size_m: f64,
    /// A contact nearer than this to a foot of the last tick is that foot, m.
    pub same_m: f64,
    /// What the holder gives way, when it is free and the body rigid.
    pub lies: Option<Gives>,
    /// Of each: +1, or −1 where the other is below a sheet.
    pub sides: [f64; 2],
}

/// Rows beyond which none is added to span a face.
const SPANNED: usize = 9;

/// A contact this much deeper than those that are kept comes beside them, relative to the size.
const DEEPER: f64 = 1e-7;

/// So many feet that carry are a face of a body that deforms.
const STANDS: usize = 6;

/// Points of a free body closer than this, relative to what makes two contacts one foot, are one.
const SAME_POINT: f64 = 0.1;

impl Meeting<'_> {
    /// Rows of `found`, deepest first.
    pub(super) fn push_feet(&self, rows: &mut RowSet, found: &[Contact], warm: &[WarmRow]) {
        let mut old = [(Point3::origin(), 0u8); MAX_FEET];
        let mut points = [Point3::origin(); MAX_FEET];
        let mut pushed = 0;
        let mut count = 0;
        // Numbers of the last tick stay taken: a new foot must not start from what another carried.
        let mut used = 0u64;
        for row in warm.iter().filter(|row| row.id.pair as usize == self.p) {
            let RowKey::Foot(number) = row.id.key else {
                continue;
            };
            used |= 1 << number;
            if count < MAX_FEET {
                let [u, v] = row.uv;
                old[count] = (self.parts.surface.point(u, v), number);
                count += 1;
            }
        }
        let push = |rows: &mut RowSet,
                    key: RowKey,
                    contact: &Contact,
                    points: &mut [Point3],
                    pushed: &mut usize| {
            let Self { views, steps, .. } = self;
            push_between(
                rows,
                self.p,
                self.pair,
                key,
                contact,
                views,
                steps,
                self.margin_m,
            );
            points[*pushed] = contact.on_tool;
            *pushed += 1;
        };
        let spans = |contact: &&Contact| contact.point == ToolPoint::Round;
        let deepest = found.iter().filter(|contact| !spans(contact));
        let near = |points: &[Point3], point: &Point3, apart_m: f64| {
            points.iter().any(|other| (other - point).norm() < apart_m)
        };
        let own = || {
            warm.iter()
                .filter(|row| row.id.pair as usize == self.p && row.id.key.is_foot())
        };
        let apart_m = SAME_POINT * self.same_m;
        // Where a face lies, rounding decides which point is deepest: those that carried carry on.
        let deforms = self.views.iter().any(Option::is_some);
        let lies = match deforms {
            true => own().filter(|row| row.force_n > 0.0).count() >= STANDS,
            false => self.lies.is_some() && found.iter().any(|contact| spans(&contact)),
        };
        if lies {
            let mut kept_m = f64::NEG_INFINITY;
            for (carried, most) in [(true, MAX_FEET), (false, SPANNED)] {
                for row in own().filter(|row| (row.force_n > 0.0) == carried) {
                    let apart = |contact: &Contact| {
                        !near(&points[..pushed], &contact.on_tool, apart_m)
                            && !self.is_held(rows, contact)
                    };
                    let again = self.again(row).filter(apart);
                    if let Some(contact) = again.filter(|_| pushed < most) {
                        kept_m = kept_m.max(contact.depth_m);
                        push(rows, row.id.key, &contact, &mut points, &mut pushed);
                    }
                }
            }
            let deeper_m = kept_m + DEEPER * self.size_m;
            for contact in deepest.chain(found.iter().filter(spans)) {
                let number = (!used).trailing_zeros();
                let most = match spans(&contact) || contact.depth_m <= deeper_m {
                    true => SPANNED,
                    false => MAX_FEET,
                };
                if number >= FEET_OF_PAIR {
                    return;
                }
                if pushed < most
                    && !near(&points[..pushed], &contact.on_tool, self.same_m)
                    && !self.is_held(rows, contact)
                {
                    used |= 1 << number;
                    let key = RowKey::foot(number as usize);
                    push(rows, key, contact, &mut points, &mut pushed);
                }
            }
            return;
        }
        for contact in deepest.take(MAX_FEET) {
            let away = |k: usize| (old[k].0 - contact.on_body).norm();
            let nearest = (0..count).min_by(|&a, &b| away(a).total_cmp(&away(b)));
            let number = match nearest.filter(|&k| away(k) < self.same_m) {
                Some(k) => {
                    count -= 1;
                    old.swap(k, count);
                    u32::from(old[count].1)
                }
                None => (!used).trailing_zeros(),
            };
            if number >= FEET_OF_PAIR {
                return;
            }
            used |= 1 << number;
            let key = RowKey::foot(number as usize);
            push(rows, key, contact, &mut points, &mut pushed);
        }
        for row in own().filter(|_| self.lies.is_some()) {
            let is_left = |(_, left): &(Point3, u8)| RowKey::Foot(*left) == row.id.key;
            if !old[..count].iter().any(is_left) || pushed == MAX_FEET {
                continue;
            }
            let apart = |contact: &Contact| !near(&points[..pushed], &contact.on_tool, apart_m);
            if let Some(contact) = self.again(row).filter(apart) {
                push(rows, row.id.key, &contact, &mut points, &mut pushed);
            }
        }
    }

    /// The contact of a foot of the last tick, where it now is.
    fn again(&self, row: &WarmRow) -> Option<Contact> {
        let [mine, theirs] = self.views.each_ref().map(Option::is_some);
        if mine || theirs {
            let on = [self.parts, self.theirs];
            return lying::on_soft(row, theirs, on, self.size_m, self.sides);
        }
        let holder = self.lies.as_ref()?;
        lying::again(row, holder, self.parts, self.size_m, self.sides[0])
    }

    /// Samples on all sides of a contact are pressed: what rises between them is a bulge, and no foot.
    fn is_held(&self, rows: &RowSet, contact: &Contact) -> bool {
        let [s, t] = contact.tool_uv.unwrap_or_default();
        let places = [[contact.u, contact.v], [s, t]];
        let keys = [RowKey::sample, RowKey::of_owner];
        let views = self.views.iter().zip(places).zip(keys);
        views
            .filter_map(|((view, at), key)| Some((view.as_ref()?, at, key)))
            .any(|(view, [u, v], key)| {
                let is_in = |sample: usize| {
                    let mut own = rows.of_pair().iter();
                    own.any(|row| row.id.key == key(sample) && row.gap_m < 0.0)
                };
                let around = view.samples.around(u, v);
                around.is_some_and(|four| four.into_iter().all(|(k, w)| w > 0.0 && is_in(k)))
            })
    }
}
