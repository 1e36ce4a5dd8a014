//! What a tool holds on to while its grab button is down.
//!
//! An anchor joins a point of the tool to a point of a surface in all three directions. Each of a
//! tool's anchors bears an equal part of the grip force at most; beyond it the surface point slips
//! off, and so that no hand feels a step the anchor weakens with the way it has slipped before it
//! lets go.

use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::stateful;

/// Most anchors of a tool.
pub const MAX_ANCHORS: usize = 16;
/// Layout of a saved grip and of the rows of its anchors, in bits that no grip of the layout before
/// has: there the keys of those rows stood for feet as well.
const LAYOUT: u64 = 1 << 48;
/// Bit of the buttons that grabs.
pub const GRAB: u32 = 1;

/// A point of a tool and the point of a surface that it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    /// Pair of the plan.
    pub pair: u32,
    /// Its number among the tool's when they were made.
    pub number: u32,
    /// On the surface.
    pub u: f64,
    /// On the surface.
    pub v: f64,
    /// On the tool, from its reference point, tool frame, m. Not known while the grip is fresh.
    pub offset: Vector3,
}

/// Grip of one tool. Part of the state; empty while the button is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GripState {
    /// The first `len` hold.
    anchors: [Anchor; MAX_ANCHORS],
    len: u32,
    /// How many were made: each bears this part of the grip force.
    made: u32,
    /// Made in the last tick: where they are on the tool is where tool and surface came to stand.
    pub fresh: bool,
}

impl Default for GripState {
    fn default() -> Self {
        let none = Anchor {
            pair: 0,
            number: 0,
            u: 0.0,
            v: 0.0,
            offset: Vector3::zeros(),
        };
        Self {
            anchors: [none; MAX_ANCHORS],
            len: 0,
            made: 0,
            fresh: false,
        }
    }
}

impl GripState {
    /// As many anchors as a grip may have.
    pub fn full() -> Self {
        Self {
            len: MAX_ANCHORS as u32,
            made: MAX_ANCHORS as u32,
            ..Self::default()
        }
    }

    /// The anchors that hold.
    pub fn anchors(&self) -> &[Anchor] {
        &self.anchors[..self.len as usize]
    }

    /// The same, to be changed.
    pub fn anchors_mut(&mut self) -> &mut [Anchor] {
        &mut self.anchors[..self.len as usize]
    }

    /// True when anchors hold.
    pub fn holds(&self) -> bool {
        self.len > 0
    }

    /// Since the button went down nothing was grabbed: what slipped off is not taken again.
    pub fn is_open(&self) -> bool {
        self.made == 0
    }

    /// Part of the grip force that one anchor bears.
    pub fn part(&self) -> f64 {
        1.0 / f64::from(self.made.max(1))
    }

    /// Adds an anchor to a fresh grip, if there is room.
    pub fn make(&mut self, pair: u32, u: f64, v: f64) {
        if (self.len as usize) < MAX_ANCHORS {
            self.anchors[self.len as usize] = Anchor {
                pair,
                number: self.len,
                u,
                v,
                offset: Vector3::zeros(),
            };
            self.len += 1;
            self.made = self.len;
            self.fresh = true;
        }
    }

    /// Keeps the anchors that pass.
    pub fn retain(&mut self, mut keep: impl FnMut(&Anchor) -> bool) {
        let mut kept = 0;
        for k in 0..self.len as usize {
            let anchor = self.anchors[k];
            if keep(&anchor) {
                self.anchors[kept] = anchor;
                kept += 1;
            }
        }
        self.len = kept as u32;
        // States that behave alike are alike.
        self.anchors[kept..].fill(Self::default().anchors[0]);
    }
}

stateful!(GripState, |this, walk| {
    walk.clear(this)?;
    let GripState {
        anchors,
        len,
        made,
        fresh,
    } = this;
    walk.constant(
        "layout of a grip, as another version of this program saves it",
        LAYOUT,
    )?;
    walk.packed("grip", [(0, len), (16, made), (32, fresh)])?;
    let (len, made) = (*len, *made);
    let fits = len <= made && made as usize <= MAX_ANCHORS;
    walk.ensure(fits, "number of anchors", u64::from(made))?;
    for (_, anchor) in std::iter::zip(0..len, anchors) {
        let Anchor {
            pair,
            number,
            u,
            v,
            offset,
        } = anchor;
        walk.packed("anchor", [(0, pair), (32, number)])?;
        walk.ensure(*number < made, "anchor number", u64::from(*number))?;
        walk.float(u)?;
        walk.float(v)?;
        walk.vector(offset)?;
    }
    Ok(())
});

/// What an anchor still bears, from 1 to 0, when its two points have come `apart_m` on a body of
/// the size `size_m`.
pub fn strength(apart_m: f64, size_m: f64) -> f64 {
    debug_assert!(size_m > 0.0, "a body without size");
    let slipped = apart_m / (LETS_GO * size_m);
    (2.0 - 2.0 * slipped).clamp(0.0, 1.0)
}

/// An anchor lets go when its points are this far apart, relative to the body's size: a few
/// millimetres on a body that fits a hand. From half of it on it weakens.
const LETS_GO: f64 = 0.05;

/// How far apart tool and surface point are, m.
pub fn apart_m(on_tool: &Point3, on_surface: &Point3) -> f64 {
    (on_tool - on_surface).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_geometry::math::SavedState;

    #[test]
    fn a_grip_is_restored_as_it_was_and_never_overflows() {
        let mut grip = GripState::default();
        for k in 0..2 * MAX_ANCHORS as u32 {
            grip.make(k % 3, 0.01 * f64::from(k), 0.5);
        }
        assert_eq!(grip.anchors().len(), MAX_ANCHORS);
        grip.fresh = false;
        grip.retain(|anchor| anchor.number % 2 == 0);
        assert_eq!(
            (grip.anchors().len(), grip.part()),
            (MAX_ANCHORS / 2, 1.0 / MAX_ANCHORS as f64)
        );
        let mut saved = SavedState::default();
        saved.save_from(&grip);
        let mut again = GripState::default();
        saved.restore_into(&mut again).unwrap();
        assert_eq!(again, grip);
        grip.retain(|_| false);
        assert!(!grip.holds() && !grip.is_open());
        for (k, wrong) in [(0, LAYOUT + 1), (1, 99), (1, 1 | 17 << 16)] {
            let mut other = saved.clone();
            other.words[k] = wrong;
            assert!(other.restore_into(&mut again).is_err(), "{wrong:#x}");
        }
        // As the layout before began.
        saved.words.remove(0);
        assert!(saved.restore_into(&mut again).is_err());
    }

    #[test]
    fn strength_falls_without_a_step() {
        let mut before = strength(0.0, 0.1);
        assert_eq!(before, 1.0);
        for k in 1..=600 {
            let now = strength(f64::from(k) * 1e-5, 0.1);
            assert!(now <= before && before - now < 5e-3);
            before = now;
        }
        assert_eq!(before, 0.0);
        assert_eq!(strength(f64::INFINITY, 0.1), 0.0);
    }
}
