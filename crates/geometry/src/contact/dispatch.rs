//! Which query finds the contacts of a pair: a table over what stands against a body and the method
//! that is asked for. A combination without a query is refused when the pair is made, and a tool
//! shape that the table does not know does not compile.
//!
//! ```text
//! body               a surface                 a part
//! point, sphere      exact::ball               part::ball
//! plane              exact::plane              part::plane
//! implicit           implicit                  implicit
//! mesh               mesh                      mesh
//! surface            pair                      mesh, the part's
//! a body: surface    pair                      mesh, the part's
//! a body: part       mesh, the part's          mesh, the other part's
//! the body itself    own                       refused
//! ```
//! A part stands against surfaces and other parts as a solid: its triangles say where to look, and distances are its own.
//! A method that a caller brings ([`OtherMethod`]) stands in the place of all queries of a pair of surfaces.

use super::exact::{self, ExactScratch};
use super::features::FeatureSearch;
use super::implicit::ImplicitSolver;
use super::mesh::{MeshSolver, MeshTool};
use super::other::{ContactQuery, OtherMethod};
use super::own::SelfSolver;
use super::pair::{PairSide, PairSolver};
use super::part::{self, PartScratch, PartSide, PartSolid};
use super::placed::PlacedSurface;
use super::{Contact, ContactSet, Reach, ToolShape};
use crate::math::{Point3, Pose, Vector3};
use crate::skin::{Skin, SkinSide, SkinSolver};
use crate::surface::{ClosestPoint, ClosestSolver, Surface};
use std::sync::Arc;

/// How the contacts of a pair are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// On the surface itself.
    Exact,
    /// As a caller's method does, with this many points in u and in v.
    Other(&'static OtherMethod, [usize; 2]),
}

impl Method {
    /// Name in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Other(method, _) => method.name,
        }
    }
}

/// A body as pairs are made of it.
#[derive(Clone, Copy, Debug)]
pub struct BodyShape<'a> {
    /// At rest.
    pub skin: &'a Skin,
    /// What a closed part is to surfaces and other parts.
    pub solid: Option<&'a Arc<MeshTool>>,
}

impl<'a> From<&'a Skin> for BodyShape<'a> {
    fn from(skin: &'a Skin) -> Self {
        Self { skin, solid: None }
    }
}

/// What stands against a body.
#[derive(Clone, Copy, Debug)]
pub enum Party<'a> {
    /// A tool.
    Tool(&'a ToolShape),
    /// Another body.
    Body(BodyShape<'a>),
    /// The body itself, where it folds.
    Itself,
}

impl Party<'_> {
    /// The tool's shape, or `body` or `itself`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Tool(shape) => shape.name(),
            Self::Body(_) => "body",
            Self::Itself => "itself",
        }
    }

    /// Its surface, where it is one.
    pub fn surface(&self) -> Option<&Surface> {
        match self {
            Self::Body(body) => body.skin.surface(),
            Self::Tool(ToolShape::Surface(shape)) => Some(shape.surface()),
            Self::Tool(
                ToolShape::Point
                | ToolShape::Sphere { .. }
                | ToolShape::Plane { .. }
                | ToolShape::Implicit { .. }
                | ToolShape::Mesh(_),
            )
            | Self::Itself => None,
        }
    }
}

/// A pair that no query answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a body against {party:?} has no {method:?} contact: {why}; {help}")]
pub struct UnsupportedPair {
    /// What stands against the body: the name of a tool shape, `body` or `itself`.
    pub party: &'static str,
    /// The method that was asked for.
    pub method: &'static str,
    /// What it lacks.
    pub why: &'static str,
    /// What to do.
    pub help: &'static str,
}

impl<'a> SkinSide<'a> {
    /// A body that is a surface.
    pub fn surface(self) -> Option<PairSide<'a>> {
        Some(PairSide {
            surface: self.skin.surface()?,
            solver: self.solver.surface_mut()?,
        })
    }
}

/// Says whether a pair has a query; [`Narrow::new`] makes it.
///
/// # Errors
/// The combination has none.
pub fn check(body: BodyShape<'_>, party: Party<'_>, method: Method) -> Result<(), UnsupportedPair> {
    const EXACT: &str = "use method = \"exact\" or \"none\"";
    let refuse = |why, help| {
        Err(UnsupportedPair {
            party: party.name(),
            method: method.name(),
            why,
            help,
        })
    };
    let is_part = |body: &BodyShape<'_>| body.skin.part().is_some();
    let of_part = is_part(&body) || matches!(&party, Party::Body(other) if is_part(other));
    // The part that stands as a solid.
    let solid = match &party {
        Party::Body(other) if is_part(other) => Some(other.solid),
        Party::Body(_) | Party::Tool(ToolShape::Surface(_)) if is_part(&body) => Some(body.solid),
        _ => None,
    };
    match (party, method) {
        (party, Method::Other(other, _)) => match (other.refuses)(body, party) {
            Some(why) => refuse(why, EXACT),
            None if of_part || matches!(party, Party::Itself) => {
                refuse("it has contacts of two surfaces only", EXACT)
            }
            None => Ok(()),
        },
        (_, Method::Exact) if solid.is_some_and(|solid| solid.is_none()) => {
            Err(without_inside(party, method))
        }
        _ => Ok(()),
    }
}

/// A part that has to be a solid and is none.
fn without_inside(party: Party<'_>, method: Method) -> UnsupportedPair {
    UnsupportedPair {
        party: party.name(),
        method: method.name(),
        why: "one of them is a part without an inside, and surfaces and other parts touch only closed ones",
        help: "close its shell, fit a surface to it (palpate surface fit), or exclude the pair with method = \"none\"",
    }
}

/// The contacts of a pair and what finds them.
#[derive(Debug)]
pub struct Narrow {
    /// What the last query found.
    pub set: ContactSet,
    query: Query,
    /// Of a tool with corners and edges.
    features: Option<Box<FeatureSearch>>,
}

/// What finds the contacts of a pair.
#[derive(Debug)]
enum Query {
    /// Points, balls and planes on a part.
    Part(Box<PartScratch>),
    /// A part, as a solid, against a surface or another part.
    PartSolid(Box<PartSolid>, Whose),
    /// Points, balls and planes.
    Simple(Box<ExactScratch>),
    /// A function's solid.
    Implicit(Box<ImplicitSolver>),
    /// A triangle mesh.
    Mesh(Box<MeshSolver>),
    /// A tool that is a surface.
    Surface(Box<PairSolver>, Box<PlacedSurface>),
    /// Two bodies.
    Bodies(Box<PairSolver>),
    /// By a caller's method; a tool that is a surface is placed.
    Other(Box<dyn ContactQuery>, Option<Box<PlacedSurface>>),
    /// A body with itself.
    Own(Box<SelfSolver>),
}

impl Query {
    /// `None` where a part is to be a solid and has no inside.
    fn new(body: BodyShape<'_>, party: Party<'_>, method: Method) -> Option<Self> {
        Some(match (body.skin, party, method) {
            (Skin::Part(placed), Party::Tool(shape), _) if is_simple(shape) => {
                Self::Part(Box::new(PartScratch::new(placed.part())))
            }
            (skin, Party::Tool(ToolShape::Implicit { .. }), Method::Exact) => {
                Self::Implicit(Box::new(ImplicitSolver::new(skin)))
            }
            (skin, Party::Tool(ToolShape::Mesh(tool)), Method::Exact) => {
                Self::Mesh(Box::new(MeshSolver::new(skin, tool)))
            }
            (Skin::Part(_), Party::Tool(ToolShape::Surface(tool)), _) => {
                let placed = PlacedSurface::new(tool.surface());
                let solid = PartSolid::new(&placed.skin, body.solid?);
                Self::PartSolid(Box::new(solid), Whose::BodyAgainst(Box::new(placed)))
            }
            (skin, Party::Body(other), Method::Exact) if other.skin.part().is_some() => {
                Self::PartSolid(Box::new(PartSolid::new(skin, other.solid?)), Whose::Holder)
            }
            (Skin::Part(_), Party::Body(other), Method::Exact) => Self::PartSolid(
                Box::new(PartSolid::new(other.skin, body.solid?)),
                Whose::Body,
            ),
            (Skin::Surface(surface), ..) => Self::of_surface(surface, party, method),
            (Skin::Part(_), ..) => return None,
        })
    }

    fn of_surface(body: &Surface, party: Party<'_>, method: Method) -> Self {
        let other = party.surface().unwrap_or(body);
        match (party, method) {
            (Party::Itself, _) => Self::Own(Box::new(SelfSolver::new(body))),
            (party, Method::Other(method, rows)) => {
                let placed = match party {
                    Party::Tool(ToolShape::Surface(_)) => Some(Box::new(PlacedSurface::new(other))),
                    _ => None,
                };
                Self::Other((method.make)(body, party, rows), placed)
            }
            (Party::Body(_), Method::Exact) => Self::Bodies(Box::new(PairSolver::new(body, other))),
            (Party::Tool(ToolShape::Surface(_)), Method::Exact) => Self::Surface(
                Box::new(PairSolver::new(body, other)),
                Box::new(PlacedSurface::new(other)),
            ),
            (Party::Tool(_), Method::Exact) => {
                let solver = &mut ClosestSolver::new(body);
                Self::Simple(Box::new(ExactScratch::new(body, solver)))
            }
        }
    }
}

/// Points, spheres and planes.
fn is_simple(shape: &ToolShape) -> bool {
    matches!(
        shape,
        ToolShape::Point | ToolShape::Sphere { .. } | ToolShape::Plane { .. }
    )
}

/// Which of two parties is the part that stands against the other as a solid.
#[derive(Debug)]
enum Whose {
    /// The holder.
    Holder,
    /// The pair's body.
    Body,
    /// The pair's body, against a tool that is a surface.
    BodyAgainst(Box<PlacedSurface>),
}

/// What a point of one party sees of the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    /// Distance to the other party now, m; negative inside.
    pub gap_m: f64,
    /// Unit vector from the point's surface to the other party.
    pub normal: Vector3,
    /// Where on the other party, if that is a surface.
    pub uv: [f64; 2],
}

impl Narrow {
    /// What a pair needs, and no more.
    ///
    /// # Errors
    /// No query answers the combination, as [`check`] says.
    pub fn new(
        body: BodyShape<'_>,
        party: Party<'_>,
        method: Method,
    ) -> Result<Self, UnsupportedPair> {
        check(body, party, method)?;
        let features = match (party, method) {
            (Party::Tool(shape), Method::Exact) => shape.features(),
            _ => None,
        };
        let features = features.map(|features| Box::new(FeatureSearch::new(body.skin, features)));
        let query = Query::new(body, party, method);
        Ok(Self {
            set: ContactSet::new(),
            query: query.ok_or_else(|| without_inside(party, method))?,
            features,
        })
    }

    /// Contacts of a tool at `pose` with a body. `shape` is that with which the pair was made.
    pub fn contacts(&mut self, shape: &ToolShape, pose: &Pose, body: SkinSide<'_>, reach: Reach) {
        let Self {
            set,
            query,
            features,
        } = self;
        set.clear();
        let place = Point3::from(pose.translation.vector);
        let SkinSide { skin, solver } = body;
        let mut edges = features.as_mut().zip(shape.features());
        if let Some((search, known)) = &mut edges {
            search.find(known, pose, skin, solver, &reach);
        }
        let beside = (edges.as_ref()).map_or(&[][..], |(search, _)| search.found());
        match (query, shape, skin, &mut *solver) {
            (Query::Implicit(found), ToolShape::Implicit { tool, .. }, _, solver) => {
                let body = SkinSide { skin, solver };
                found.contacts(body, tool, pose, &reach, beside, set);
            }
            (Query::Mesh(found), ToolShape::Mesh(tool), _, solver) => {
                let body = SkinSide { skin, solver };
                found.contacts(body, tool, pose, &reach, beside, set);
            }
            (
                Query::PartSolid(found, Whose::BodyAgainst(placed)),
                ToolShape::Surface(tool),
                Skin::Part(part),
                _,
            ) => {
                placed.place(tool.surface(), pose);
                let PlacedSurface { skin, solver } = &mut **placed;
                found.contacts(skin, solver, part.pose(), &reach, set);
                set.turn_round();
            }
            (Query::Part(scratch), _, Skin::Part(placed), SkinSolver::Part(solver)) => {
                let side = PartSide {
                    part: placed.part(),
                    pose: placed.pose(),
                    solver,
                };
                match shape {
                    ToolShape::Plane { normal } => {
                        let plane = pose.rotation * normal;
                        part::plane::contacts(side, &place, &plane, &reach, scratch, set);
                    }
                    _ => {
                        let radius_m = shape.ball_radius_m().unwrap_or(0.0);
                        part::ball::contacts(side, &place, radius_m, &reach, scratch, set);
                    }
                }
            }
            (Query::Simple(scratch), _, Skin::Surface(surface), SkinSolver::Surface(solver)) => {
                match shape {
                    ToolShape::Plane { normal } => {
                        let plane = pose.rotation * normal;
                        exact::plane::contacts(
                            surface, solver, &place, &plane, &reach, scratch, set,
                        );
                    }
                    _ => {
                        let radius_m = shape.ball_radius_m().unwrap_or(0.0);
                        exact::ball::contacts(
                            surface, solver, &place, radius_m, &reach, scratch, set,
                        );
                    }
                }
            }
            (Query::Other(query, placed), _, Skin::Surface(surface), _) => {
                if let (Some(placed), ToolShape::Surface(tool)) = (placed, shape) {
                    placed.place(tool.surface(), pose);
                }
                query.contacts(surface, shape, pose, &reach, set);
            }
            (
                Query::Surface(found, placed),
                ToolShape::Surface(tool),
                Skin::Surface(surface),
                SkinSolver::Surface(solver),
            ) => {
                placed.place(tool.surface(), pose);
                if let Some(side) = placed.side() {
                    found.contacts(PairSide { surface, solver }, side, reach, set);
                }
            }
            _ => made_for_another(shape),
        }
        if let Some((search, known)) = edges {
            search.join(known, pose, skin, solver, &reach, set);
        }
    }

    /// What a point of the body sees of a tool at `pose`, for which [`Narrow::contacts`] was asked.
    /// A single point sees nothing of a point.
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
            ToolShape::Mesh(tool) => match &self.query {
                Query::Mesh(found) => found.signed_gap(tool, pose, x),
                _ => tool.signed_gap(pose, x),
            },
            ToolShape::Surface(_) => {
                let (Query::Surface(_, placed)
                | Query::Other(_, Some(placed))
                | Query::PartSolid(_, Whose::BodyAgainst(placed))) = &self.query
                else {
                    made_for_another(shape);
                    return None;
                };
                let contacts = self.set.contacts();
                let local = |x: &Point3, s, t| placed.solver.local(&placed.skin, x, s, t);
                return look_at(contacts, x, margin_m, local);
            }
        };
        Some(Facing {
            gap_m,
            normal,
            uv: [0.0; 2],
        })
    }

    /// From now on contacts of two bodies are manifolds, of those that are found on the surfaces themselves.
    pub fn spread(&mut self) {
        if let Query::Bodies(solver) = &mut self.query {
            solver.spread();
        }
    }

    /// Contacts of two bodies, for a pair made with [`Party::Body`]; `known`: `reach.below` says on
    /// which side of a sheet the other body is. Returns the side of an open body on which a closed one touches it, +1 or
    /// −1; `None` where they do not touch, or only at the rim.
    pub fn body_contacts(
        &mut self,
        mine: SkinSide<'_>,
        theirs: SkinSide<'_>,
        mut reach: Reach,
        known: bool,
    ) -> Option<f64> {
        let Self { set, query, .. } = self;
        set.clear();
        if let Query::PartSolid(solid, whose) = query {
            let holds = matches!(whose, Whose::Holder);
            let (on, part) = if holds {
                (mine, theirs)
            } else {
                (theirs, mine)
            };
            let part = part.skin.part()?;
            if !known && solid.is_on_sheet() {
                let foot = on.solver.closest(on.skin, &part.middle());
                reach.below = foot.signed_distance < 0.0;
            }
            solid.contacts(on.skin, on.solver, part.pose(), &reach, set);
            if !holds {
                set.turn_round();
            }
            return (!set.contacts().is_empty()).then(|| reach.side());
        }
        let (mine, theirs) = (mine.surface()?, theirs.surface()?);
        match query {
            Query::Bodies(solver) => {
                if known {
                    solver.contacts(mine, theirs, reach, set);
                } else {
                    solver.contacts_on_either_side(mine, theirs, reach, set);
                }
                return solver.side_in_touch();
            }
            Query::Other(query, _) => {
                query.body_contacts(mine.surface, theirs.surface, &reach, set);
            }
            _ => debug_assert!(false, "this pair was not made for two bodies"),
        }
        None
    }

    /// Contacts of a body with itself no deeper than `deepest_m`, for a pair made with
    /// [`Party::Itself`].
    pub fn own_contacts(&mut self, body: PairSide<'_>, reach: Reach, deepest_m: f64) {
        let Self { set, query, .. } = self;
        match query {
            Query::Own(solver) => {
                solver.contacts(body.surface, body.solver, reach, deepest_m, set);
            }
            _ => debug_assert!(false, "this pair was not made for a body with itself"),
        }
    }

    /// What finds the contacts, where that is a caller's method.
    pub fn other(&self) -> Option<&dyn ContactQuery> {
        match &self.query {
            Query::Other(query, _) => Some(&**query),
            _ => None,
        }
    }
}

fn made_for_another(shape: &ToolShape) {
    debug_assert!(false, "this pair was not made for a {}", shape.name());
}

/// What a point of a body sees of the other surface, which touches it at these contacts.
///
/// A point inside a convex solid lies beyond the tangent plane at the solid's deepest point: that
/// sorts out nearly all. The foot is the one that `local` leads to from the nearest contact's.
pub fn look_at(
    contacts: &[Contact],
    x: &Point3,
    margin_m: f64,
    local: impl Fn(&Point3, f64, f64) -> Option<ClosestPoint>,
) -> Option<Facing> {
    let away = |c: &Contact| (c.on_body - x).norm_squared();
    let beyond = contacts
        .iter()
        .filter(|c| (x - c.on_tool).dot(&c.normal) > -margin_m);
    let [s, t] = beyond.min_by(|a, b| away(a).total_cmp(&away(b)))?.tool_uv?;
    let foot = local(x, s, t)?;
    Some(Facing {
        gap_m: foot.signed_distance,
        normal: -foot.normal,
        uv: [foot.u, foot.v],
    })
}

#[cfg(test)]
mod tests;
