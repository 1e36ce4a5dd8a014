//! What a tool holds on to while its grab button is down.
//!
//! An anchor joins a point of the tool to a point of a surface in all three directions. Each of a
//! tool's anchors bears an equal part of the grip force at most; beyond it the surface point slips
//! off, and so that no hand feels a step the anchor weakens with the way it has slipped before it
//! lets go.

use palpate_geometry::math::{Point3, StateError, StateSink, StateSource, Vector3};

/// Most anchors of a tool.
pub const MAX_ANCHORS: usize = 16;
/// Layout of a saved grip and of the rows of its anchors. Before 1 the keys of those rows stood for
/// feet as well.
const LAYOUT: u64 = 1;
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

    /// All of it, in order.
    pub fn save(&self, sink: &mut impl StateSink) {
        let counts = u64::from(self.len) | u64::from(self.made) << 16;
        sink.word(counts | u64::from(self.fresh) << 32 | LAYOUT << 48);
        for Anchor {
            pair,
            number,
            u,
            v,
            offset,
        } in self.anchors()
        {
            sink.word(u64::from(*pair) | u64::from(*number) << 32);
            sink.floats(&[*u, *v]);
            sink.floats(offset.as_slice());
        }
    }

    /// In the order of [`GripState::save`].
    ///
    /// # Errors
    /// The source is too short, or holds too many anchors.
    pub fn restore(&mut self, source: &mut impl StateSource) -> Result<(), StateError> {
        *self = Self::default();
        let head = source.word()?;
        let [len, made, fresh, layout] = [0, 16, 32, 48].map(|shift| (head >> shift) & 0xffff);
        if layout != LAYOUT {
            return Err(StateError::Value {
                what: "layout of a grip, as another version of this program saves it",
                value: layout,
            });
        }
        if len > made || made > MAX_ANCHORS as u64 || fresh > 1 {
            return Err(StateError::Value {
                what: "grip",
                value: head,
            });
        }
        (self.len, self.made, self.fresh) = (len as u32, made as u32, fresh == 1);
        for anchor in &mut self.anchors[..len as usize] {
            let word = source.word()?;
            (anchor.pair, anchor.number) = (word as u32, (word >> 32) as u32);
            if u64::from(anchor.number) >= made {
                return Err(StateError::Value {
                    what: "anchor number",
                    value: word,
                });
            }
            let mut uv = [0.0; 2];
            source.floats(&mut uv)?;
            [anchor.u, anchor.v] = uv;
            source.floats(anchor.offset.as_mut_slice())?;
        }
        Ok(())
    }
}

/// What an anchor still bears, from 1 to 0, when its two points have come `apart_m` on a body of
/// the size `size_m`.
pub fn strength(apart_m: f64, size_m: f64) -> f64 {
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
    use palpate_geometry::math::{SavedState, Stateful};

    impl Stateful for GripState {
        fn save(&self, sink: &mut impl StateSink) {
            Self::save(self, sink);
        }
        fn restore(&mut self, source: &mut impl StateSource) -> Result<(), StateError> {
            Self::restore(self, source)
        }
    }

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
        let head = saved.words[0];
        for wrong in [head | 99, head & !(LAYOUT << 48), head + (1 << 48)] {
            saved.words[0] = wrong;
            assert!(saved.restore_into(&mut again).is_err(), "{wrong:#x}");
        }
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
