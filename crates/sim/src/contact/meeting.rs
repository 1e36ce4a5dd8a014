//! Feet of two bodies that meet.
//!
//! Every contact of a query is a row where the query finds it: a foot that only came after the deepest
//! point would push a ball that rolls from behind, out of nothing. But a contact keeps the number of the
//! foot that it was in the last tick, so that solves start from what it carried and friction remembers
//! where it stuck.

use super::feet::{MAX_FEET, TwoBodies, push_between};
use super::lying;
use super::warm::WarmRow;
use crate::party::BodyScratch;
use crate::party::Gives;
use crate::solve::row_key::{FEET_OF_PAIR, RowKey};
use crate::solve::rows::RowSet;
use palpate_geometry::contact::{Contact, ToolPoint};
use palpate_geometry::math::Point3;

/// Two bodies that meet: the pair's body first, then its holder.
pub(super) struct Meeting<'a> {
    pub of: TwoBodies<'a>,
    /// Of the pair's body.
    pub parts: &'a BodyScratch,
    /// Of the holder.
    pub theirs: &'a BodyScratch,
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

/// A contact this much deeper than those that are kept comes beside them however many there are, relative to the size.
const DEEPER: f64 = 1e-7;

/// Where as many rows carry as span a face, a contact comes beside them only when deeper by this, relative to the margin.
const MUCH_DEEPER: f64 = 0.1;

/// From this many feet that carry on, a body that deforms lies on a face.
const STANDS: usize = 6;

/// Points of a free body closer than this, relative to what makes two contacts one foot, are one.
const SAME_POINT: f64 = 0.1;

/// The contact spans a face with others.
fn spans(contact: &&Contact) -> bool {
    contact.point == ToolPoint::Round
}

/// What is pushed of a pair.
struct Pushed<'a> {
    rows: &'a mut RowSet,
    /// Points of the holder.
    points: [Point3; MAX_FEET],
    count: usize,
    /// Numbers of feet that are taken.
    used: u64,
}

impl Pushed<'_> {
    /// None of the points is nearer than this.
    fn is_apart(&self, contact: &Contact, apart_m: f64) -> bool {
        let mut points = self.points[..self.count].iter();
        points.all(|other| (other - contact.on_tool).norm() >= apart_m)
    }

    /// A foot that was not there in the last tick, if a number is left.
    fn new_key(&mut self) -> Option<RowKey> {
        let number = (!self.used).trailing_zeros();
        (number < FEET_OF_PAIR).then(|| {
            self.used |= 1 << number;
            RowKey::foot(number as usize)
        })
    }
}

impl Meeting<'_> {
    /// Rows of `found`, deepest first.
    pub(super) fn push_feet(&self, rows: &mut RowSet, found: &[Contact], warm: &[WarmRow]) {
        let own = warm.iter();
        let own = own.filter(|row| row.id.pair as usize == self.of.p && row.id.key.is_foot());
        // Numbers of the last tick stay taken: a new foot must not start from what another carried.
        let number = |row: &WarmRow| match row.id.key {
            RowKey::Foot(number) => 1 << number,
            _ => 0,
        };
        let mut to = Pushed {
            rows,
            points: [Point3::origin(); MAX_FEET],
            count: 0,
            used: own.clone().map(number).fold(0, |used, bit| used | bit),
        };
        // Where a face lies, rounding decides which point is deepest: those that carried carry on.
        let lies = match self.deforms() {
            true => own.clone().filter(|row| row.force_n > 0.0).count() >= STANDS,
            false => self.lies.is_some() && found.iter().any(|contact| spans(&contact)),
        };
        match lies {
            true => self.push_face(&mut to, found, own),
            false => self.push_deepest(&mut to, found, own),
        }
    }

    fn deforms(&self) -> bool {
        self.of.views.iter().any(Option::is_some)
    }

    fn push(&self, to: &mut Pushed<'_>, key: RowKey, contact: &Contact) {
        push_between(to.rows, &self.of, key, contact);
        to.points[to.count] = contact.on_tool;
        to.count += 1;
    }

    /// Of a face: the feet of the last tick, then contacts that are deeper or span it.
    fn push_face<'r>(
        &self,
        to: &mut Pushed<'_>,
        found: &[Contact],
        own: impl Iterator<Item = &'r WarmRow> + Clone,
    ) {
        let apart_m = SAME_POINT * self.same_m;
        let mut kept_m = f64::NEG_INFINITY;
        let carried = own.clone().filter(|row| row.force_n > 0.0);
        let others = own.filter(|row| row.force_n <= 0.0);
        let kept = carried.clone().map(|row| (row, MAX_FEET));
        for (row, most) in kept.chain(others.map(|row| (row, SPANNED))) {
            let again = self
                .again(row)
                .filter(|contact| to.is_apart(contact, apart_m) && !self.is_held(to.rows, contact));
            if let Some(contact) = again.filter(|_| to.count < most) {
                kept_m = kept_m.max(contact.depth_m);
                self.push(to, row.id.key, &contact);
            }
        }
        let deeper_m = match carried.count() < SPANNED {
            true => DEEPER * self.size_m,
            false => MUCH_DEEPER * self.of.margin_m,
        };
        let deeper_m = kept_m + deeper_m;
        let deepest = found.iter().filter(|contact| !spans(contact));
        for contact in deepest.chain(found.iter().filter(spans)) {
            let most = match spans(&contact) || contact.depth_m <= deeper_m {
                true => SPANNED,
                false => MAX_FEET,
            };
            let is_new = to.count < most
                && to.is_apart(contact, self.same_m)
                && !self.is_held(to.rows, contact);
            if is_new {
                let Some(key) = to.new_key() else { return };
                self.push(to, key, contact);
            }
        }
    }

    /// The deepest contacts, each as the nearest foot of the last tick; of a free body also its points that touched.
    fn push_deepest<'r>(
        &self,
        to: &mut Pushed<'_>,
        found: &[Contact],
        own: impl Iterator<Item = &'r WarmRow> + Clone,
    ) {
        let mut old: [(Point3, Option<&WarmRow>); MAX_FEET] = [(Point3::origin(), None); MAX_FEET];
        let mut count = 0;
        for (old, row) in old.iter_mut().zip(own.clone()) {
            let [u, v] = row.uv;
            *old = (self.parts.skin.point(u, v), Some(row));
            count += 1;
        }
        let deepest = found.iter().filter(|contact| !spans(contact));
        for contact in deepest.take(MAX_FEET) {
            let away = |k: usize| (old[k].0 - contact.on_body).norm();
            let nearest = (0..count).min_by(|&a, &b| away(a).total_cmp(&away(b)));
            let nearest = nearest.filter(|&k| away(k) < self.same_m);
            let lies = self.lies.is_some();
            let jumps = lies && nearest.is_some_and(|k| away(k) > self.of.margin_m);
            let known = nearest.and_then(|k| {
                count -= 1;
                old.swap(k, count);
                old[count].1
            });
            let Some(row) = known else {
                let Some(key) = to.new_key() else { return };
                self.push(to, key, contact);
                continue;
            };
            // Along an edge any place may be the deepest by rounding: a foot does not jump from where it is as deep.
            let as_deep_m = contact.depth_m - DEEPER * self.size_m;
            let again = self.again(row).filter(|_| jumps);
            let again = again.filter(|again| again.depth_m >= as_deep_m);
            self.push(to, row.id.key, again.as_ref().unwrap_or(contact));
        }
        let apart_m = SAME_POINT * self.same_m;
        for row in own.filter(|_| self.lies.is_some()) {
            let mut left = old[..count].iter().filter_map(|(_, row)| *row);
            if !left.any(|left| left.id == row.id) || to.count == MAX_FEET {
                continue;
            }
            let again = self.again(row);
            if let Some(contact) = again.filter(|contact| to.is_apart(contact, apart_m)) {
                self.push(to, row.id.key, &contact);
            }
        }
    }

    /// The contact of a foot of the last tick, where it now is.
    fn again(&self, row: &WarmRow) -> Option<Contact> {
        let [mine, theirs] = self.of.views.each_ref().map(Option::is_some);
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
        let views = self.of.views.iter().zip(places).zip(keys);
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
