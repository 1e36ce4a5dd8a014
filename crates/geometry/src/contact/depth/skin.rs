//! Where a body is deepest inside a solid, be it a surface or a part.

use super::part::PartDepths;
use super::{DepthField, DepthSearch};
use crate::contact::{Contact, ContactSet, ToolPoint};
use crate::math::Point3;
use crate::skin::{Skin, SkinSolver};
use crate::surface::ClosestSolver;

/// Scratch against one body, sized once. Nothing in it outlives a query.
#[derive(Clone, Debug)]
pub(in crate::contact) enum SkinDepths {
    Surface(Box<DepthSearch>),
    Part(Box<PartDepths>),
}

/// A place where a body is deepest.
#[derive(Clone, Copy, Debug)]
pub(in crate::contact) struct Deepest {
    /// Of the body.
    pub place: [f64; 2],
    /// m.
    pub point: Point3,
    /// Which point it is.
    pub mark: ToolPoint,
}

impl SkinDepths {
    /// Makes room for the pieces of a surface, or the faces of a part.
    pub fn new(skin: &Skin) -> Self {
        match skin {
            Skin::Surface(surface) => {
                let mut solver = ClosestSolver::new(surface);
                Self::Surface(Box::new(DepthSearch::new(surface, &mut solver)))
            }
            Skin::Part(placed) => Self::Part(Box::new(PartDepths::new(placed.part()))),
        }
    }

    /// Finds the places that are deeper than those around them, and no farther outside than the margin, m; `beside`: contacts
    /// of the solid's edges.
    pub fn search(
        &mut self,
        skin: &Skin,
        solver: &mut SkinSolver,
        field: &impl DepthField,
        margin_m: f64,
        beside: &[Contact],
        out: &mut ContactSet,
    ) {
        match (self, skin, solver) {
            (Self::Surface(search), Skin::Surface(surface), SkinSolver::Surface(solver)) => {
                search.search(surface, solver, field, margin_m, beside, out);
            }
            (Self::Part(search), Skin::Part(placed), SkinSolver::Part(_)) => {
                let touched = beside.iter().any(|contact| contact.depth_m >= 0.0);
                search.search(placed, field, margin_m, touched, out);
            }
            _ => debug_assert!(false, "scratch of another body"),
        }
    }

    /// What the last search found.
    pub fn found<'a>(&'a self, skin: &'a Skin) -> impl Iterator<Item = Deepest> + 'a {
        let (tops, of_part) = match self {
            Self::Surface(search) => (&search.tops.found[..], &[][..]),
            Self::Part(search) => (&[][..], search.found()),
        };
        let tops = tops.iter().map(|top| Deepest {
            place: top.at,
            point: skin.point(top.at[0], top.at[1]),
            mark: ToolPoint::Found,
        });
        tops.chain(of_part.iter().map(|top| Deepest {
            place: top.place,
            point: top.point,
            mark: top.mark,
        }))
    }

    /// Diagonal of the body's box, m.
    pub fn size_m(&self) -> f64 {
        match self {
            Self::Surface(search) => search.tops.size_m,
            Self::Part(search) => search.size_m(),
        }
    }

    /// Adds the rectangles of a surface that the solid may reach into.
    pub fn report(&mut self, out: &mut ContactSet) {
        if let Self::Surface(search) = self {
            search.patches.report(&search.reached, out);
        }
    }

    /// Of a corner of the solid in the body and the tops that a way inside the solid joins with it, the deepest stays:
    /// false if that is none of them the corner.
    pub fn keeps(
        &mut self,
        [u, v]: [f64; 2],
        depth_m: f64,
        level_m: f64,
        depth: impl Fn([f64; 2]) -> f64,
    ) -> bool {
        let Self::Surface(search) = self else {
            return true;
        };
        let tops = &mut search.tops;
        let same = |at: [f64; 2]| tops.map.joined([u, v], at, level_m, &depth);
        if (tops.found.iter()).any(|t| t.height_m > depth_m && same(t.at)) {
            return false;
        }
        let map = tops.map;
        (tops.found).retain(|t| !map.joined([u, v], t.at, level_m, &depth));
        true
    }
}
