//! The narrow phase of each pair, with its scratch.

use super::state::BodyScratch;
use super::{Method, Pair, Scene};
use crate::contact::exact::{self, ExactScratch};
use crate::contact::own::{SelfSolver, TICK_FOLD};
use crate::contact::pair::{PairSide, PairSolver};
use crate::contact::rows::{DeformingView, Facing, Holder, SampleInTouch};
use crate::contact::spheres::{Counters, Spheres, SpheresPair};
use crate::contact::{Contact, ContactSet, Reach, ToolShape};
use crate::math::{Point3, Pose};
use crate::surface::{ClosestSolver, Surface};

/// The contacts of a pair and what finds them.
#[derive(Debug)]
pub(crate) struct PairScratch {
    pub set: ContactSet,
    narrow: Narrow,
}

/// What finds the contacts of a pair.
#[derive(Debug)]
enum Narrow {
    /// Balls and planes.
    Simple(Box<ExactScratch>),
    /// A tool that is a surface.
    Surface(Box<PairSolver>, Box<PlacedSurface>),
    /// A tool without a surface, on points of the body's.
    Spheres(Box<Spheres>),
    /// A tool that is a surface, on points of both.
    SurfaceSpheres(Box<TwoSpheres>, Box<PlacedSurface>),
    /// Two bodies.
    Bodies(Box<PairSolver>),
    /// Two bodies, on points of both.
    BodiesSpheres(Box<TwoSpheres>),
    /// A body with itself.
    Own(Box<SelfSolver>),
}

#[derive(Debug)]
struct TwoSpheres {
    body: Spheres,
    holder: Spheres,
    pair: SpheresPair,
}

impl TwoSpheres {
    fn new(body: &Surface, holder: &Surface, rows: [usize; 2]) -> Self {
        let (body, holder) = (Spheres::new(body, rows), Spheres::new(holder, rows));
        let pair = SpheresPair::new(&body, &holder);
        Self { body, holder, pair }
    }
}

/// A rigid surface where its tool stands.
#[derive(Debug)]
struct PlacedSurface {
    surface: Surface,
    solver: ClosestSolver,
}

impl PlacedSurface {
    fn new(at_rest: &Surface) -> Self {
        Self { surface: at_rest.clone(), solver: ClosestSolver::new(at_rest) }
    }

    fn place(&mut self, at_rest: &Surface, pose: &Pose) {
        for (now, rest) in self.surface.net_mut().points_mut().iter_mut().zip(at_rest.net().points()) {
            *now = pose * rest;
        }
        self.solver.net_changed();
    }

    fn side(&mut self) -> PairSide<'_> {
        PairSide { surface: &self.surface, solver: &mut self.solver }
    }
}

impl PairScratch {
    /// What the pair needs, and no more.
    pub fn new(scene: &Scene, pair: &Pair) -> Self {
        let surface = &scene.bodies[pair.body].surface;
        let narrow = match (pair.holder, pair.method) {
            (Holder::Body(other), _) if other as usize == pair.body => Narrow::Own(Box::new(SelfSolver::new(surface))),
            (Holder::Body(other), Method::Exact) => {
                Narrow::Bodies(Box::new(PairSolver::new(surface, &scene.bodies[other as usize].surface)))
            }
            (Holder::Body(other), Method::Spheres(rows)) => {
                let other = &scene.bodies[other as usize].surface;
                Narrow::BodiesSpheres(Box::new(TwoSpheres::new(surface, other, rows)))
            }
            (Holder::Tool(t), method) => match (&scene.tools[t as usize].shape, method) {
                (ToolShape::Surface(tool), Method::Exact) => Narrow::Surface(
                    Box::new(PairSolver::new(surface, tool.surface())),
                    Box::new(PlacedSurface::new(tool.surface())),
                ),
                (ToolShape::Surface(tool), Method::Spheres(rows)) => Narrow::SurfaceSpheres(
                    Box::new(TwoSpheres::new(surface, tool.surface(), rows)),
                    Box::new(PlacedSurface::new(tool.surface())),
                ),
                (_, Method::Spheres(rows)) => Narrow::Spheres(Box::new(Spheres::new(surface, rows))),
                (_, Method::Exact) => {
                    let mut solver = ClosestSolver::new(surface);
                    Narrow::Simple(Box::new(ExactScratch::new(surface, &mut solver)))
                }
            },
        };
        Self { set: ContactSet::new(), narrow }
    }

    /// Contacts of a tool at `pose` with a body.
    pub fn contacts(&mut self, shape: &ToolShape, pose: &Pose, parts: &mut BodyScratch, reach: Reach) {
        let Self { set, narrow } = self;
        set.clear();
        let place = Point3::from(pose.translation.vector);
        match (narrow, shape) {
            (Narrow::Simple(scratch), ToolShape::Plane { normal }) => {
                let plane = pose.rotation * normal;
                exact::plane::contacts(&parts.surface, &mut parts.solver, &place, &plane, &reach, scratch, set);
            }
            (Narrow::Simple(scratch), shape) => {
                let Some(radius_m) = shape.ball_radius_m() else { return };
                exact::ball::contacts(&parts.surface, &mut parts.solver, &place, radius_m, &reach, scratch, set);
            }
            (Narrow::Surface(solver, placed), ToolShape::Surface(tool)) => {
                placed.place(tool.surface(), pose);
                solver.contacts(side(parts), placed.side(), reach, set);
            }
            (Narrow::Spheres(spheres), shape) => {
                spheres.load(&parts.surface);
                match shape {
                    ToolShape::Plane { normal } => spheres.plane(&place, &(pose.rotation * normal), &reach, set),
                    shape => {
                        let Some(radius_m) = shape.ball_radius_m() else { return };
                        spheres.ball(&place, radius_m, &reach, set);
                    }
                }
            }
            (Narrow::SurfaceSpheres(two, placed), ToolShape::Surface(tool)) => {
                placed.place(tool.surface(), pose);
                two.body.load(&parts.surface);
                two.holder.load_at(tool.surface(), pose);
                two.pair.find(&mut two.body, &mut two.holder, &reach, set);
            }
            _ => {}
        }
    }

    /// Samples of a deforming body in touch with a tool at `pose`, for which [`PairScratch::contacts`] was asked.
    pub fn samples_in_touch(
        &mut self,
        shape: &ToolShape,
        pose: &Pose,
        view: &DeformingView<'_>,
        margin_m: f64,
        meets: impl Fn(&Point3, &Point3) -> bool,
        hits: &mut Vec<SampleInTouch>,
    ) {
        let place = Point3::from(pose.translation.vector);
        let plain = |(gap_m, normal)| Some(Facing { gap_m, normal, uv: [0.0; 2] });
        match shape {
            ToolShape::Plane { normal } => {
                let plane = pose.rotation * normal;
                let look = |x: &Point3| plain(exact::plane::signed_gap(&place, &plane, x));
                view.samples_in_touch(margin_m, meets, look, hits);
            }
            ToolShape::Point => hits.clear(),
            ToolShape::Sphere { radius_m } => {
                let look = |x: &Point3| plain(exact::ball::signed_gap(&place, *radius_m, x));
                view.samples_in_touch(margin_m, meets, look, hits);
            }
            ToolShape::Surface(_) => {
                hits.clear();
                let (Narrow::Surface(_, placed) | Narrow::SurfaceSpheres(_, placed)) = &self.narrow else { return };
                let contacts = self.set.contacts();
                let look = |x: &Point3| look_at(contacts, x, margin_m, &placed.surface, &placed.solver);
                view.samples_in_touch(margin_m, meets, look, hits);
            }
        }
    }

    /// Contacts of two bodies.
    pub fn body_contacts(&mut self, mine: &mut BodyScratch, theirs: &mut BodyScratch, reach: Reach) {
        let Self { set, narrow } = self;
        set.clear();
        match narrow {
            Narrow::Bodies(solver) => solver.contacts(side(mine), side(theirs), reach, set),
            Narrow::BodiesSpheres(two) => {
                two.body.load(&mine.surface);
                two.holder.load(&theirs.surface);
                two.pair.find(&mut two.body, &mut two.holder, &reach, set);
            }
            _ => {}
        }
    }

    /// Contacts of a body with itself.
    pub fn own_contacts(&mut self, parts: &mut BodyScratch, reach: Reach) {
        if let Narrow::Own(solver) = &mut self.narrow {
            let deepest_fold_m = TICK_FOLD * parts.surface.size();
            solver.contacts(&parts.surface, &mut parts.solver, reach, deepest_fold_m, &mut self.set);
        }
    }

    /// What the last query of the `spheres` method did.
    pub fn counters(&self) -> Option<&Counters> {
        match &self.narrow {
            Narrow::Spheres(spheres) => Some(spheres.counters()),
            Narrow::SurfaceSpheres(two, _) | Narrow::BodiesSpheres(two) => Some(two.pair.counters()),
            _ => None,
        }
    }
}

fn side(parts: &mut BodyScratch) -> PairSide<'_> {
    PairSide { surface: &parts.surface, solver: &mut parts.solver }
}

/// What a point of a body sees of the other surface, which touches it at these contacts.
///
/// A point inside a convex solid lies beyond the tangent plane at the solid's deepest point: that sorts out nearly all.
/// The foot is the one that leads on from the nearest contact's.
pub(crate) fn look_at(
    contacts: &[Contact],
    x: &Point3,
    margin_m: f64,
    other: &Surface,
    solver: &ClosestSolver,
) -> Option<Facing> {
    let away = |c: &Contact| (c.on_body - x).norm_squared();
    let beyond = contacts.iter().filter(|c| (x - c.on_tool).dot(&c.normal) > -margin_m);
    let [s, t] = beyond.min_by(|a, b| away(a).total_cmp(&away(b)))?.tool_uv?;
    let foot = solver.local(other, x, s, t)?;
    Some(Facing { gap_m: foot.signed_distance, normal: -foot.normal, uv: [foot.u, foot.v] })
}
