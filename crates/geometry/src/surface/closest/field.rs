//! The distance to a surface as a field over space: what collisions between two surfaces ask, many
//! places at a time.
//!
//! Feet here are local minima from a good start, several times quicker than certified ones; whoever
//! reports a depth certifies it afterwards.

use super::newton::{Evaluate, NewtonPlace, OnPieces, descend, descend_over};
use super::objective::{Distance, Jet, Smooth};
use super::{ClosestPoint, ClosestSolver};
use crate::math::Point3;
use crate::surface::bezier::BezierPieces;
use crate::surface::tensor::{Frame, Surface};

/// A foot with the surface's derivatives there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    /// The foot.
    pub at: ClosestPoint,
    /// Derivatives, as its own piece sees them.
    pub frame: Frame,
    /// No edge, crease or pole holds it.
    pub smooth: bool,
}

/// Where a descent over a surface ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bottom {
    /// Parameter u.
    pub u: f64,
    /// Parameter v.
    pub v: f64,
    /// Derivatives there.
    pub frame: Frame,
    /// Slope left along free directions, objective a metre.
    pub slope: f64,
    /// A minimum over the free directions, to rounding.
    pub minimum: bool,
}

struct By<F>(F);

/// The distance, to a ten-thousandth of itself: a slope of 2 d sin α with α of a hundredth.
struct Rough(Distance);

impl Smooth for Rough {
    #[inline]
    fn jet(&self, frame: &Frame) -> Jet {
        let jet = self.0.jet(frame);
        Jet {
            slope_noise: jet.slope_noise + 0.02 * jet.f.max(0.0).sqrt(),
            ..jet
        }
    }
}

impl<F: Fn(&Frame) -> Jet> Smooth for By<F> {
    #[inline]
    fn jet(&self, frame: &Frame) -> Jet {
        (self.0)(frame)
    }
}

impl ClosestSolver {
    /// The foot that the nearest of the sampled points leads to, its distance to four digits: where
    /// to follow from, and on which side.
    pub(crate) fn rough(&mut self, surface: &Surface, query: &Point3) -> ClosestPoint {
        let objective = Distance { q: *query };
        let start = self.samples.best(&self.pieces, &objective);
        let mut eval = OnPieces {
            pieces: &mut self.pieces,
            surface,
        };
        let found = descend_over(&mut eval, &Rough(objective), start);
        if found.free != [true; 2] {
            return self.foot(surface, query, found.place).at;
        }
        self.answer(surface, query, &found)
    }

    /// The foot that a given place leads to.
    pub(crate) fn near_from(&mut self, surface: &Surface, query: &Point3, u: f64, v: f64) -> Foot {
        let start = self.place(u, v);
        self.foot(surface, query, start)
    }

    fn foot(&mut self, surface: &Surface, query: &Point3, start: NewtonPlace) -> Foot {
        let objective = Distance { q: *query };
        let mut found = descend_over(
            &mut OnPieces {
                pieces: &mut self.pieces,
                surface,
            },
            &objective,
            start,
        );
        for _ in 0..6 {
            if found.free == [true; 2] {
                break;
            }
            let Some(start) = self.go_on(surface, query, &found) else {
                break;
            };
            let next = descend_over(
                &mut OnPieces {
                    pieces: &mut self.pieces,
                    surface,
                },
                &objective,
                start,
            );
            if next.jet.f < found.jet.f - found.jet.noise {
                found = next;
            } else {
                break;
            }
        }
        Foot {
            at: self.answer(surface, query, &found),
            frame: found.frame,
            smooth: found.free == [true; 2] && found.beyond.is_none(),
        }
    }

    /// The certified foot, with its frame.
    pub(crate) fn certain(&mut self, surface: &Surface, query: &Point3) -> Foot {
        let objective = Distance { q: *query };
        let best = self.nearest(surface, &objective);
        Foot {
            at: self.answer(surface, query, &best),
            frame: best.frame,
            smooth: best.free == [true; 2] && best.beyond.is_none(),
        }
    }

    /// Descends on any objective over this surface, over creases where that helps.
    pub(crate) fn descend_by(
        &mut self,
        surface: &Surface,
        u: f64,
        v: f64,
        jet: impl Fn(&Frame) -> Jet,
    ) -> Bottom {
        let start = self.place(u, v);
        let by = By(jet);
        let mut eval = OnPieces {
            pieces: &mut self.pieces,
            surface,
        };
        let mut best = descend(&mut eval, &by, start);
        for _ in 0..8 {
            let Some(place) = best.beyond else { break };
            let next = descend(&mut eval, &by, place);
            if next.jet.f < best.jet.f {
                best = next;
            } else {
                break;
            }
        }
        let minimum = best.is_minimum();
        let (u, v) = self.parameters(&best.place);
        Bottom {
            u,
            v,
            frame: best.frame,
            slope: best.slope,
            minimum,
        }
    }

    /// The pieces as they were when last brought up to date.
    pub(crate) fn pieces_now(&self) -> &BezierPieces {
        &self.pieces
    }

    /// Derivatives at a parameter pair of the domain, from the pieces.
    pub(crate) fn frame_at(&mut self, surface: &Surface, u: f64, v: f64) -> Frame {
        let NewtonPlace { i, j, u, v } = self.place(u, v);
        OnPieces {
            pieces: &mut self.pieces,
            surface,
        }
        .frame(i, j, u, v)
    }
}
