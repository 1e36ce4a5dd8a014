//! The narrow phase of each pair, with its scratch.

use super::scratch::BodyScratch;
use super::{Method, Pair, Scene};
use crate::solve::rows::{DeformingView, Facing, Holder, SampleInTouch};
use palpate_geometry::contact::exact::{self, ExactScratch};
use palpate_geometry::contact::implicit::ImplicitSolver;
use palpate_geometry::contact::mesh::MeshSolver;
use palpate_geometry::contact::own::SelfSolver;
use palpate_geometry::contact::pair::{PairSide, PairSolver};
use palpate_geometry::contact::spheres::{Counters, Solid, Spheres, SpheresPair};
use palpate_geometry::contact::{Contact, ContactSet, Reach, ToolShape};
use palpate_geometry::math::{Point3, Pose, Vector3};
use palpate_geometry::surface::{ClosestSolver, Surface};

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
    /// A function's solid.
    Implicit(Box<ImplicitSolver>),
    /// A triangle mesh.
    Mesh(Box<MeshSolver>),
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

/// A solid tool at a pose, as the `spheres` method sees it.
struct Placed<'a> {
    shape: &'a ToolShape,
    pose: &'a Pose,
}

impl Solid for Placed<'_> {
    fn signed_gap(&self, point: &Point3) -> (f64, Vector3) {
        // Ours point towards the tool's matter, theirs out of it.
        let (gap_m, inwards) = match self.shape {
            ToolShape::Implicit { tool, .. } => tool
                .signed_gap(self.pose, point)
                .unwrap_or((f64::INFINITY, Vector3::z())),
            ToolShape::Mesh(tool) => tool.signed_gap(self.pose, point),
            _ => (f64::INFINITY, Vector3::z()),
        };
        (gap_m, -inwards)
    }

    fn bounded_gap(&self, point: &Point3) -> Option<f64> {
        match self.shape {
            ToolShape::Mesh(tool) => Some(tool.signed_gap(self.pose, point).0),
            _ => None,
        }
    }

    fn may_meet_box(&self, low: &Point3, high: &Point3, margin_m: f64) -> bool {
        let Some((from, to)) = self.shape.bounds(self.pose) else {
            return true;
        };
        (0..3).all(|c| low[c] <= to[c] + margin_m && high[c] >= from[c] - margin_m)
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
        Self {
            surface: at_rest.clone(),
            solver: ClosestSolver::new(at_rest),
        }
    }

    fn place(&mut self, at_rest: &Surface, pose: &Pose) {
        for (now, rest) in self
            .surface
            .net_mut()
            .points_mut()
            .iter_mut()
            .zip(at_rest.net().points())
        {
            *now = pose * rest;
        }
        self.solver.net_changed();
    }

    fn side(&mut self) -> PairSide<'_> {
        PairSide {
            surface: &self.surface,
            solver: &mut self.solver,
        }
    }
}

impl PairScratch {
    /// What the pair needs, and no more.
    pub fn new(scene: &Scene, pair: &Pair) -> Self {
        let surface = &scene.bodies[pair.body].surface;
        let narrow = match (pair.holder, pair.method) {
            (Holder::Body(other), _) if other as usize == pair.body => {
                Narrow::Own(Box::new(SelfSolver::new(surface)))
            }
            (Holder::Body(other), Method::Exact) => Narrow::Bodies(Box::new(PairSolver::new(
                surface,
                &scene.bodies[other as usize].surface,
            ))),
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
                (_, Method::Spheres(rows)) => {
                    Narrow::Spheres(Box::new(Spheres::new(surface, rows)))
                }
                (shape, Method::Exact) => {
                    let solver = &mut ClosestSolver::new(surface);
                    match shape {
                        ToolShape::Implicit { .. } => {
                            Narrow::Implicit(Box::new(ImplicitSolver::new(surface, solver)))
                        }
                        ToolShape::Mesh(tool) => {
                            Narrow::Mesh(Box::new(MeshSolver::new(surface, solver, tool)))
                        }
                        _ => Narrow::Simple(Box::new(ExactScratch::new(surface, solver))),
                    }
                }
            },
        };
        Self {
            set: ContactSet::new(),
            narrow,
        }
    }

    /// Contacts of a tool at `pose` with a body.
    pub fn contacts(
        &mut self,
        shape: &ToolShape,
        pose: &Pose,
        parts: &mut BodyScratch,
        reach: Reach,
    ) {
        let Self { set, narrow } = self;
        set.clear();
        let place = Point3::from(pose.translation.vector);
        match (narrow, shape) {
            (Narrow::Simple(scratch), ToolShape::Plane { normal }) => {
                let plane = pose.rotation * normal;
                exact::plane::contacts(
                    &parts.surface,
                    &mut parts.solver,
                    &place,
                    &plane,
                    &reach,
                    scratch,
                    set,
                );
            }
            (Narrow::Simple(scratch), shape) => {
                let Some(radius_m) = shape.ball_radius_m() else {
                    return;
                };
                exact::ball::contacts(
                    &parts.surface,
                    &mut parts.solver,
                    &place,
                    radius_m,
                    &reach,
                    scratch,
                    set,
                );
            }
            (Narrow::Implicit(solver), ToolShape::Implicit { tool, .. }) => {
                solver.contacts(&parts.surface, &mut parts.solver, tool, pose, &reach, set);
            }
            (Narrow::Mesh(solver), ToolShape::Mesh(tool)) => {
                solver.contacts(&parts.surface, &mut parts.solver, tool, pose, &reach, set);
            }
            (Narrow::Surface(solver, placed), ToolShape::Surface(tool)) => {
                placed.place(tool.surface(), pose);
                solver.contacts(side(parts), placed.side(), reach, set);
            }
            (Narrow::Spheres(spheres), shape) => {
                spheres.load(&parts.surface);
                match shape {
                    ToolShape::Plane { normal } => {
                        spheres.plane(&place, &(pose.rotation * normal), &reach, set)
                    }
                    ToolShape::Implicit { .. } | ToolShape::Mesh(_) => {
                        spheres.solid(&Placed { shape, pose }, &reach, set);
                    }
                    shape => {
                        let Some(radius_m) = shape.ball_radius_m() else {
                            return;
                        };
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

    /// Samples of a deforming body in touch with a tool at `pose`, for which
    /// [`PairScratch::contacts`] was asked.
    pub fn samples_in_touch(
        &self,
        shape: &ToolShape,
        pose: &Pose,
        view: &DeformingView<'_>,
        margin_m: f64,
        meets: impl Fn(&Point3, &Point3) -> bool,
        hits: &mut Vec<SampleInTouch>,
    ) {
        hits.clear();
        if !matches!(shape, ToolShape::Point) {
            view.samples_in_touch(
                margin_m,
                meets,
                |x| self.facing(shape, pose, x, margin_m),
                hits,
            );
        }
    }

    /// What a point of the body sees of a tool at `pose`, for which [`PairScratch::contacts`] was
    /// asked.
    pub fn facing(
        &self,
        shape: &ToolShape,
        pose: &Pose,
        x: &Point3,
        margin_m: f64,
    ) -> Option<Facing> {
        let place = Point3::from(pose.translation.vector);
        let (gap_m, normal) = match shape {
            ToolShape::Plane { normal } => {
                exact::plane::signed_gap(&place, &(pose.rotation * normal), x)
            }
            ToolShape::Point => return None,
            ToolShape::Sphere { radius_m } => exact::ball::signed_gap(&place, *radius_m, x),
            ToolShape::Implicit { tool, .. } => tool.signed_gap(pose, x)?,
            ToolShape::Mesh(tool) => tool.signed_gap(pose, x),
            ToolShape::Surface(_) => {
                let (Narrow::Surface(_, placed) | Narrow::SurfaceSpheres(_, placed)) = &self.narrow
                else {
                    return None;
                };
                return look_at(
                    self.set.contacts(),
                    x,
                    margin_m,
                    &placed.surface,
                    &placed.solver,
                );
            }
        };
        Some(Facing {
            gap_m,
            normal,
            uv: [0.0; 2],
        })
    }

    /// Contacts of two bodies.
    pub fn body_contacts(
        &mut self,
        mine: &mut BodyScratch,
        theirs: &mut BodyScratch,
        reach: Reach,
    ) {
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
    pub fn own_contacts(&mut self, parts: &mut BodyScratch, reach: Reach, deepest_m: f64) {
        if let Narrow::Own(solver) = &mut self.narrow {
            solver.contacts(
                &parts.surface,
                &mut parts.solver,
                reach,
                deepest_m,
                &mut self.set,
            );
        }
    }

    /// What the last query of the `spheres` method did.
    pub fn counters(&self) -> Option<&Counters> {
        match &self.narrow {
            Narrow::Spheres(spheres) => Some(spheres.counters()),
            Narrow::SurfaceSpheres(two, _) | Narrow::BodiesSpheres(two) => {
                Some(two.pair.counters())
            }
            _ => None,
        }
    }
}

fn side(parts: &mut BodyScratch) -> PairSide<'_> {
    PairSide {
        surface: &parts.surface,
        solver: &mut parts.solver,
    }
}

/// What a point of a body sees of the other surface, which touches it at these contacts.
///
/// A point inside a convex solid lies beyond the tangent plane at the solid's deepest point: that
/// sorts out nearly all. The foot is the one that leads on from the nearest contact's.
pub(crate) fn look_at(
    contacts: &[Contact],
    x: &Point3,
    margin_m: f64,
    other: &Surface,
    solver: &ClosestSolver,
) -> Option<Facing> {
    let away = |c: &Contact| (c.on_body - x).norm_squared();
    let beyond = contacts
        .iter()
        .filter(|c| (x - c.on_tool).dot(&c.normal) > -margin_m);
    let [s, t] = beyond.min_by(|a, b| away(a).total_cmp(&away(b)))?.tool_uv?;
    let foot = solver.local(other, x, s, t)?;
    Some(Facing {
        gap_m: foot.signed_distance,
        normal: -foot.normal,
        uv: [foot.u, foot.v],
    })
}
