//! The result of every narrow-phase query: contacts in order of depth, the parameter rectangles in
//! contact, and whether there is any overlap.

use crate::math::{Point3, Vector3};

/// Most contacts kept of one pair; the deepest stay.
pub const MAX_CONTACTS: usize = 32;

/// Which point of a tool a contact has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ToolPoint {
    /// Found by the query, and nothing of the tool beside it is known.
    #[default]
    Found,
    /// The deepest of an edge or a face, whose corners and fixed points are less deep by so much, m.
    Deepest {
        /// m, at least 0.
        by_m: f64,
    },
    /// A corner or tip.
    Corner,
    /// One of eight points of a round edge, the same in each query.
    Round,
}

/// A contact between a tool and a body, or a gap within the margin.
///
/// `on_body − on_tool = depth · normal`, to rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Parameter of the body's surface.
    pub u: f64,
    /// Parameter of the body's surface.
    pub v: f64,
    /// S(u, v), m.
    pub on_body: Point3,
    /// Point of the tool's boundary, m.
    pub on_tool: Point3,
    /// Unit vector out of the body, towards the tool.
    pub normal: Vector3,
    /// Penetration depth, m; negative: a gap, at most the margin asked for.
    pub depth_m: f64,
    /// Parameters of `on_tool`, where the tool is a B-spline surface (another body, or the same).
    pub tool_uv: Option<[f64; 2]>,
    /// Which point of the tool it is.
    pub point: ToolPoint,
}

/// A part of the body's parameter domain that holds everything of one contact region, in the
/// surface's own parameters. In a periodic direction `high` may pass the domain's end: the
/// rectangle then goes on behind the seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Least and greatest u.
    pub u: [f64; 2],
    /// Least and greatest v.
    pub v: [f64; 2],
}

/// What a narrow-phase query reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Gaps up to this are reported as contacts of negative depth, m (≥ 0).
    pub margin_m: f64,
    /// The body is an open sheet and the tool is on the side that its normals point away from.
    pub below: bool,
    /// How much nearer surfaces may come before they are looked at again, m: places of a face that may touch by then span it.
    pub closing_m: f64,
}

impl Reach {
    /// Penetration only, from the outer side.
    pub const TOUCH: Self = Self {
        margin_m: 0.0,
        below: false,
        closing_m: 0.0,
    };

    /// +1, or −1 below a sheet: what normals and signed distances of the body are multiplied with.
    pub fn side(&self) -> f64 {
        if self.below { -1.0 } else { 1.0 }
    }
}

/// Deepest first, then by u, then by v.
fn order(a: &Contact, b: &Contact) -> std::cmp::Ordering {
    b.depth_m
        .total_cmp(&a.depth_m)
        .then(a.u.total_cmp(&b.u))
        .then(a.v.total_cmp(&b.v))
}

/// The contacts of one pair. Room is made once; filling it allocates nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactSet {
    contacts: Vec<Contact>,
    rectangles: Vec<Rectangle>,
    overlap: bool,
    dropped: u32,
}

impl Default for ContactSet {
    fn default() -> Self {
        Self::new()
    }
}

impl ContactSet {
    /// Room for [`MAX_CONTACTS`].
    pub fn new() -> Self {
        Self {
            contacts: Vec::with_capacity(MAX_CONTACTS),
            rectangles: Vec::with_capacity(MAX_CONTACTS),
            overlap: false,
            dropped: 0,
        }
    }

    /// Removes all contacts and rectangles.
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.rectangles.clear();
        self.overlap = false;
        self.dropped = 0;
    }

    /// Body and tool change places; every contact has a place on both.
    pub fn turn_round(&mut self) {
        for contact in &mut self.contacts {
            let [u, v] = contact.tool_uv.unwrap_or_default();
            *contact = Contact {
                u,
                v,
                on_body: contact.on_tool,
                on_tool: contact.on_body,
                normal: -contact.normal,
                tool_uv: Some([contact.u, contact.v]),
                ..*contact
            };
        }
        self.rectangles.clear();
        self.contacts.sort_unstable_by(order);
    }

    /// Where each contact is on the tool, by its point there.
    pub fn find_on_tool(&mut self, mut place: impl FnMut(&Point3) -> Option<[f64; 2]>) {
        for contact in &mut self.contacts {
            contact.tool_uv = place(&contact.on_tool);
        }
    }

    /// Adds a contact at its place in the order: deepest first, then by u, then by v. The
    /// shallowest leaves a full set.
    pub fn push(&mut self, contact: Contact) {
        self.overlap |= contact.depth_m >= 0.0;
        let at = self
            .contacts
            .partition_point(|held| order(held, &contact).is_lt());
        if self.contacts.len() == MAX_CONTACTS {
            self.dropped += 1;
            if at == MAX_CONTACTS {
                return;
            }
            self.contacts.pop();
        }
        self.contacts.insert(at, contact);
    }

    /// Takes the contacts out; what was said of rectangles, overlap and what was dropped stays.
    pub(super) fn take_out(&mut self) {
        self.contacts.clear();
    }

    /// Leaves out the contacts that do not pass; they count as dropped.
    pub fn keep(&mut self, passes: impl FnMut(&Contact) -> bool) {
        let before = self.contacts.len();
        self.contacts.retain(passes);
        self.dropped += (before - self.contacts.len()) as u32;
    }

    /// Adds a rectangle in touch; those beyond [`MAX_CONTACTS`] are joined with the last.
    pub fn push_rectangle(&mut self, rectangle: Rectangle) {
        if self.rectangles.len() < MAX_CONTACTS {
            self.rectangles.push(rectangle);
        } else if let Some(last) = self.rectangles.last_mut() {
            last.u = [last.u[0].min(rectangle.u[0]), last.u[1].max(rectangle.u[1])];
            last.v = [last.v[0].min(rectangle.v[0]), last.v[1].max(rectangle.v[1])];
        }
    }

    /// For solids that overlap without a contact worth reporting.
    pub fn set_overlap(&mut self) {
        self.overlap = true;
    }

    /// For a narrow phase that had to leave something out: at least one more contact is counted as
    /// dropped.
    pub fn note_dropped(&mut self) {
        self.dropped += 1;
    }

    /// In order of depth.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The deepest contact.
    pub fn deepest(&self) -> Option<&Contact> {
        self.contacts.first()
    }

    /// Parameter rectangles that hold the parts of the body's surface in touch.
    pub fn rectangles(&self) -> &[Rectangle] {
        &self.rectangles
    }

    /// The two solids share a point.
    pub fn overlap(&self) -> bool {
        self.overlap
    }

    /// Contacts that found no room, or that a bounded search may have left out.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(depth_m: f64, u: f64) -> Contact {
        let (on_body, normal) = (Point3::origin(), Vector3::z());
        Contact {
            u,
            v: 0.0,
            on_body,
            on_tool: on_body - normal * depth_m,
            normal,
            depth_m,
            tool_uv: None,
            point: ToolPoint::Found,
        }
    }

    #[test]
    fn deepest_come_first_and_stay() {
        let mut set = ContactSet::new();
        set.push(contact(-0.1, 0.5));
        assert!(!set.overlap());
        for k in 0..MAX_CONTACTS + 8 {
            // 13 is prime to the modulus: every depth once.
            set.push(contact(((k * 13) % (MAX_CONTACTS + 8)) as f64, 0.0));
        }
        let depths: Vec<f64> = set.contacts().iter().map(|c| c.depth_m).collect();
        let expected: Vec<f64> = (8..MAX_CONTACTS + 8).rev().map(|k| k as f64).collect();
        assert_eq!(depths, expected);
        assert_eq!((set.overlap(), set.dropped()), (true, 9));
        set.keep(|contact| contact.depth_m < 30.0);
        assert_eq!(set.deepest().map(|contact| contact.depth_m), Some(29.0));
        assert_eq!(
            (set.contacts().len(), set.dropped()),
            (MAX_CONTACTS - 10, 19)
        );
    }
}
