//! Which tools and bodies may touch, and how their contacts are found.

use super::door::At;
use super::mover::MovedBy;
use super::parts::{Body, BodyModel, FrameOf, Pair, Tool};
use super::spec::{ContactMethod, ContactSpec, SPHERES_RESOLUTION, SceneSpec};
use super::tool;
use crate::solve::friction::Friction;
use crate::solve::rows::Holder;
use palpate_geometry::contact::dispatch;
use palpate_geometry::contact::dispatch::Method;
use std::sync::Arc;

/// What a `[[contact]]` says, checked against the names of the scene alone.
pub(super) fn check(spec: &SceneSpec, contact: &ContactSpec, at: &At<'_>) -> Option<()> {
    let before = at.problem_count();
    let is_tool = |id: &str| spec.tools.iter().any(|tool| tool.id == id);
    let is_body = |id: &str| spec.bodies.iter().any(|body| body.id == id);
    let [holder, body] = &contact.pair;
    if !is_tool(holder) && !is_body(holder) {
        at.key("pair").refuse(format!(
            "there is no tool and no body {holder:?}; pairs are [tool or body, body]"
        ));
    }
    if !is_body(body) {
        at.key("pair").refuse(format!(
            "there is no body {body:?}; pairs are [tool or body, body]"
        ));
    }
    if spec
        .tools
        .iter()
        .any(|tool| &tool.id == holder && tool.action.is_some())
    {
        at.key("pair").refuse(format!(
            "tool {holder:?} cuts and touches nothing; drop the contact, or the tool's action"
        ));
    }
    match (contact.resolution, contact.method) {
        (Some(resolution), ContactMethod::Spheres) => {
            if resolution.iter().any(|n| !(4..=1_000).contains(n)) {
                at.key("resolution").refuse(format!(
                    "resolution is {resolution:?}; each of the two must be 4 to 1000"
                ));
            }
        }
        (Some(_), _) => at
            .key("resolution")
            .refuse("only method = \"spheres\" has a resolution; drop it or choose that method"),
        (None, _) => {}
    }
    if let Some(restitution) = contact.restitution
        && !(0.0..=1.0).contains(&restitution)
    {
        at.key("restitution").refuse(format!(
            "restitution is {restitution}; it must be 0 (they stay together) to 1 (they part as fast as they met)"
        ));
    }
    (at.problem_count() == before).then_some(())
}

/// Friction that the scene gives to its tools and contacts, by index.
pub(super) struct Frictions {
    tools: Vec<Option<Friction>>,
    contacts: Vec<Option<Friction>>,
}

impl Frictions {
    pub fn of(spec: &SceneSpec, top: &At<'_>) -> Option<Self> {
        let tools = spec.tools.iter().enumerate().map(|(t, tool)| {
            let at = top.key("tool").entry(t).key("friction");
            tool::friction(tool.friction.as_ref(), &at)
        });
        let tools: Vec<_> = tools.collect();
        let contacts = spec.contacts.iter().enumerate().map(|(c, contact)| {
            let at = top.key("contact").entry(c).key("friction");
            tool::friction(contact.friction.as_ref(), &at)
        });
        let contacts: Vec<_> = contacts.collect();
        Some(Self {
            tools: tools.into_iter().collect::<Option<_>>()?,
            contacts: contacts.into_iter().collect::<Option<_>>()?,
        })
    }
}

/// Every tool against every body, bodies that deform or are free against all others, and those that may touch
/// themselves; exceptions as the scene lists them.
pub(super) fn build(
    spec: &SceneSpec,
    frictions: &Frictions,
    tools: &[Tool],
    bodies: &[Arc<Body>],
    frame: Option<&FrameOf>,
    top: &At<'_>,
) -> Option<Vec<Pair>> {
    let mut pairs = Vec::new();
    let index = |k: usize| k as u32;
    let deforms = |body: usize| !matches!(bodies[body].model, BodyModel::Rigid);
    // The tool that carries the frame moves all bodies alike and touches none; nor does one that cuts.
    let touches = |tool: usize| {
        frame.is_none_or(|frame| frame.tool != tool) && spec.tools[tool].action.is_none()
    };
    for tool in (0..tools.len()).filter(|&tool| touches(tool)) {
        // Nor does one that carries a body touch that.
        let carries = |body: &usize| matches!(&bodies[*body].mover, Some(mover) if matches!(mover.by, MovedBy::Tool { tool: by, .. } if by == tool));
        pairs.extend(
            (0..bodies.len())
                .filter(|body| !carries(body))
                .map(|body| Pair {
                    holder: Holder::Tool(index(tool)),
                    body,
                    method: Method::Exact,
                    friction: frictions.tools[tool],
                    restitution: 0.0,
                    near_field: true,
                }),
        );
    }
    let of_bodies = |holder: usize, body: usize| Pair {
        holder: Holder::Body(index(holder)),
        body,
        method: Method::Exact,
        friction: None,
        restitution: 0.0,
        near_field: false,
    };
    for body in 0..bodies.len() {
        for other in body + 1..bodies.len() {
            let free = |body: usize| bodies[body].free().is_some();
            if free(body) && !deforms(other) && !free(other) {
                // Where a free body touched is remembered on the holder.
                pairs.push(of_bodies(body, other));
            } else if deforms(body) || deforms(other) || free(other) {
                // A sheet has no inside: it is asked for the side on which the other is.
                let sheet_second = bodies[other].two_sided && !bodies[body].two_sided;
                pairs.push(if sheet_second {
                    of_bodies(body, other)
                } else {
                    of_bodies(other, body)
                });
            }
        }
    }
    for body in 0..bodies.len() {
        if spec.bodies[body].self_contact && deforms(body) {
            pairs.push(of_bodies(body, body));
        }
    }
    let before = top.problem_count();
    let mut chosen = Vec::new();
    for (c, contact) in spec.contacts.iter().enumerate() {
        let [holder_id, body_id] = &contact.pair;
        let find = |id: &str| bodies.iter().position(|body| body.id == id);
        let holder = tools
            .iter()
            .position(|tool| &tool.id == holder_id)
            .map(|tool| Holder::Tool(index(tool)))
            .or_else(|| find(holder_id).map(|body| Holder::Body(index(body))));
        // Both exist: `check` has seen them.
        let (Some(holder), Some(body)) = (holder, find(body_id)) else {
            continue;
        };
        let named = |pair: &Pair| {
            let swapped = match holder {
                Holder::Body(other) => {
                    pair.holder == Holder::Body(index(body)) && pair.body == other as usize
                }
                Holder::Tool(_) => false,
            };
            (pair.holder == holder && pair.body == body) || swapped
        };
        if contact.friction.is_some() {
            pairs
                .iter_mut()
                .filter(|pair| named(pair))
                .for_each(|pair| pair.friction = frictions.contacts[c]);
        }
        if let Some(restitution) = contact.restitution {
            let rigid = |body: usize| !deforms(body);
            let bounces = match holder {
                Holder::Tool(_) => false,
                Holder::Body(other) => rigid(body) && rigid(other as usize),
            };
            let mut named = pairs.iter_mut().filter(|pair| named(pair)).peekable();
            // Two rigid bodies are a pair only if one of them is free.
            if !bounces || named.peek().is_none() {
                top.key("contact").entry(c).key("restitution").refuse(
                    "only two rigid bodies of which one is free have a restitution: others bounce as their \
                     material does, and tools do not; drop it, or give a body free = true",
                );
            }
            named.for_each(|pair| pair.restitution = restitution);
        }
        if let Some(near_field) = contact.near_field {
            if matches!(holder, Holder::Body(_)) {
                top.key("contact").entry(c).key("near_field").refuse(
                    "only tools go into a body by what its net does not show, bodies do not; drop it",
                );
            }
            let named = pairs.iter_mut().filter(|pair| named(pair));
            named.for_each(|pair| pair.near_field = near_field);
        }
        match contact.method {
            ContactMethod::Exact => {}
            ContactMethod::None => pairs.retain(|pair| !named(pair)),
            ContactMethod::Spheres => {
                let resolution = contact.resolution.unwrap_or(SPHERES_RESOLUTION);
                let at = top.key("contact").entry(c);
                let Some(method) = top.methods().contact_method("spheres", &at) else {
                    continue;
                };
                for pair in pairs.iter_mut().filter(|pair| named(pair)) {
                    pair.method = Method::Other(method, resolution);
                    chosen.push((pair.holder, pair.body, c));
                }
            }
        }
    }
    for pair in &pairs {
        let party = pair.party(tools, bodies);
        let Err(error) = dispatch::check(bodies[pair.body].shape(), party, pair.method) else {
            continue;
        };
        let of_pair =
            |named: &&(Holder, usize, usize)| (named.0, named.1) == (pair.holder, pair.body);
        match chosen.iter().rev().find(of_pair) {
            Some((_, _, c)) => top.key("contact").entry(*c).key("method").refuse(error),
            None => top.key("contact").refuse(format!(
                "{:?} and {:?}: {error}",
                match pair.holder {
                    Holder::Tool(tool) => &tools[tool as usize].id,
                    Holder::Body(other) => &bodies[other as usize].id,
                },
                bodies[pair.body].id
            )),
        }
    }
    (top.problem_count() == before).then_some(pairs)
}
