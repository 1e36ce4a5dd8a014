//! Ways to find contacts of surfaces that this crate does not have: a caller brings them.

use super::dispatch::{BodyShape, Party};
use super::{ContactSet, Reach, ToolShape};
use crate::math::Pose;
use crate::surface::Surface;
use std::any::Any;
use std::fmt::Debug;

/// A way to find the contacts of pairs of surfaces, or of surfaces and tools.
#[derive(Debug)]
pub struct OtherMethod {
    /// Name in files and messages.
    pub name: &'static str,
    /// Why it has no contacts of such a pair, if it has none.
    pub refuses: fn(BodyShape<'_>, Party<'_>) -> Option<&'static str>,
    /// What finds those of a body's surface and what stands against it, with so many points in u and in v.
    pub make: fn(&Surface, Party<'_>, [usize; 2]) -> Box<dyn ContactQuery>,
    /// Time of a query in touch with so many points in u and in v, of two surfaces or one, µs.
    pub query_us: fn([usize; 2], bool) -> f64,
}

// By name: there is one of each.
impl PartialEq for OtherMethod {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for OtherMethod {}

/// What finds the contacts of one pair, with all that it needs for it: queries allocate nothing. Results go to a set that
/// is empty. [`Any`], so that who brings it can ask what it did.
pub trait ContactQuery: Any + Debug + Send + Sync {
    /// Contacts of a tool at a pose with the body as it stands.
    fn contacts(
        &mut self,
        body: &Surface,
        shape: &ToolShape,
        pose: &Pose,
        reach: &Reach,
        set: &mut ContactSet,
    );

    /// Contacts of two bodies as they stand.
    fn body_contacts(
        &mut self,
        body: &Surface,
        other: &Surface,
        reach: &Reach,
        set: &mut ContactSet,
    );
}
