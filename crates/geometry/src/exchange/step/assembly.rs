//! Which solids a file means and where they stand. ISO 10303-41, -43, -44.
//!
//! ```text
//! PRODUCT ◀─ PRODUCT_DEFINITION ◀─ …_SHAPE ◀─ SHAPE_DEFINITION_REPRESENTATION ─▶ representation ─▶ solids
//!                  ▲ ▲                                                            ▲ │ plain relationship: the same thing
//!      NEXT_ASSEMBLY_USAGE_OCCURRENCE ◀─ …_SHAPE ◀─ CONTEXT_DEPENDENT_… ─▶ relationship with transformation
//! ```
//! Only what a product's definition reaches is placed: drawings and properties list solids again. Representations that
//! plain relationships join are one node; from node to node lead assembly relations and `MAPPED_ITEM`s. Walks are lists,
//! not recursions: their depth is the file's.

use super::StepError;
use super::entity::{Entity, File, leading_name};
use super::pick::PartPick;
use super::surface::contains;
use super::syntax::Value;
use super::topology::SOLIDS;
use super::units::{self, Context, Unit};
use crate::math::{Matrix3, Vector3, direction_of};
use crate::part::Placing;
use std::collections::{BTreeMap, BTreeSet};

/// Places of parts, and steps to them, in one file.
const MOST_PLACES: usize = 250_000;
const MOST_STEPS: usize = 4_000_000;

/// What the file says about products and representations, by instance.
#[derive(Default)]
struct Said {
    representations: BTreeMap<u64, Representation>,
    /// `PRODUCT_DEFINITION_SHAPE`: what it is the shape of.
    shapes: BTreeMap<u64, u64>,
    /// `SHAPE_DEFINITION_REPRESENTATION`: shape, representation.
    drawn: Vec<[u64; 2]>,
    /// `PRODUCT_DEFINITION` → formation → product.
    definitions: BTreeMap<u64, u64>,
    formations: BTreeMap<u64, u64>,
    /// Number and name.
    products: BTreeMap<u64, [String; 2]>,
    /// `NEXT_ASSEMBLY_USAGE_OCCURRENCE`: the whole and its part.
    usages: BTreeMap<u64, [u64; 2]>,
    relations: BTreeMap<u64, Relation>,
    /// `CONTEXT_DEPENDENT_SHAPE_REPRESENTATION`, in order: relation, shape.
    placed: Vec<[u64; 2]>,
}

struct Representation {
    items: Vec<u64>,
    context: Option<u64>,
}

struct Relation {
    ends: [u64; 2],
    /// The operator, if it has one.
    transformed: Option<u64>,
}

/// How a node stands in another.
enum Link {
    /// Relation of representations, and which end is the part.
    Related { relation: u64, part: usize },
    /// `MAPPED_ITEM`, and the representation that lists it.
    Mapped { item: u64, whole: u64 },
    /// Without a place.
    Same,
}

/// Representations of one thing.
#[derive(Default)]
struct Node {
    /// Number and name of each product that it is a shape of.
    products: Vec<[String; 2]>,
    /// Solids, with the representation that lists them.
    items: Vec<[u64; 2]>,
    links: Vec<(usize, Link)>,
    children: Vec<(usize, Placing)>,
    /// It or a child has solids.
    shaped: bool,
}

/// A node's place in the whole.
pub(super) struct Place {
    pub node: usize,
    pub placing: Placing,
    /// Its product's name.
    pub name: String,
    /// Which place of its product, from 0.
    pub instance: usize,
}

/// The nodes that count, and their places.
pub(super) struct Assembly<'f, 'a, 'b> {
    file: &'f File<'a, 'b>,
    said: Said,
    nodes: Vec<Node>,
    contexts: BTreeMap<u64, Context>,
    /// Node of each representation.
    node_of: BTreeMap<u64, usize>,
    /// Nodes of each product's definition.
    shapes_of: BTreeSet<(u64, usize)>,
    roots: Vec<usize>,
}

impl Said {
    fn of(file: &File<'_, '_>) -> Result<Self, StepError> {
        let mut said = Self::default();
        for instance in file.exchange.instances() {
            let text = file.exchange.text(instance);
            let complex = text.first() == Some(&b'(');
            if complex && !contains(&text[..text.len().min(4096)], b"REPRESENTATION") {
                continue;
            }
            let name = leading_name(text);
            let relevant = complex
                || name.ends_with("REPRESENTATION")
                || name.ends_with("REPRESENTATION_RELATIONSHIP")
                || name.starts_with("PRODUCT")
                || name == "SHAPE_REPRESENTATION_WITH_PARAMETERS"
                || name == "NEXT_ASSEMBLY_USAGE_OCCURRENCE";
            if relevant {
                said.take(&file.entity(instance.id, instance.id)?, complex)?;
            }
        }
        Ok(said)
    }

    fn take(&mut self, entity: &Entity<'_>, complex: bool) -> Result<(), StepError> {
        let id = entity.id;
        if complex {
            return self.take_complex(entity);
        }
        match entity.kind() {
            "SHAPE_DEFINITION_REPRESENTATION" => {
                self.drawn
                    .push([entity.reference(0)?, entity.reference(1)?]);
            }
            "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION" => {
                self.placed
                    .push([entity.reference(0)?, entity.reference(1)?]);
            }
            "PRODUCT_DEFINITION_SHAPE" => drop(self.shapes.insert(id, entity.reference(2)?)),
            "PRODUCT_DEFINITION" | "PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS" => {
                self.definitions.insert(id, entity.reference(2)?);
            }
            "PRODUCT" => {
                let text = |k: usize| match entity.get(k) {
                    Some(Value::Text(text)) => plain_text(text),
                    _ => String::new(),
                };
                self.products.insert(id, [text(0), text(1)]);
            }
            "NEXT_ASSEMBLY_USAGE_OCCURRENCE" => {
                let ends = [entity.reference(3)?, entity.reference(4)?];
                self.usages.insert(id, ends);
            }
            "PRODUCT_DEFINITION_FORMATION"
            | "PRODUCT_DEFINITION_FORMATION_WITH_SPECIFIED_SOURCE" => {
                self.formations.insert(id, entity.reference(2)?);
            }
            "REPRESENTATION_RELATIONSHIP" | "SHAPE_REPRESENTATION_RELATIONSHIP" => {
                let ends = [entity.reference(2)?, entity.reference(3)?];
                let transformed = None;
                self.relations.insert(id, Relation { ends, transformed });
            }
            name if name.ends_with("REPRESENTATION") || name.ends_with("_WITH_PARAMETERS") => {
                self.representation(id, entity.longest());
            }
            _ => {}
        }
        Ok(())
    }

    fn take_complex(&mut self, entity: &Entity<'_>) -> Result<(), StepError> {
        let relation = [
            "REPRESENTATION_RELATIONSHIP",
            "SHAPE_REPRESENTATION_RELATIONSHIP",
        ]
        .into_iter()
        .find_map(|name| entity.part(name).filter(|own| own.len() >= 4));
        if let Some([.., Value::Reference(a), Value::Reference(b)]) = relation {
            let operator = entity.part("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION");
            let transformed = match operator {
                Some([.., Value::Reference(to)]) => Some(*to),
                Some(_) => return Err(entity.other("a relation with its transformation")),
                None => None,
            };
            let ends = [*a, *b];
            self.relations
                .insert(entity.id, Relation { ends, transformed });
        } else if let Some(own) = entity.part("REPRESENTATION") {
            self.representation(entity.id, own);
        }
        Ok(())
    }

    /// Name, items, context. Others that are called so have no list.
    fn representation(&mut self, id: u64, own: &[Value<'_>]) {
        let [_, Value::List(items), context, ..] = own else {
            return;
        };
        let reference = |value: &Value<'_>| match value {
            Value::Reference(to) => Some(*to),
            _ => None,
        };
        let representation = Representation {
            items: items.iter().filter_map(reference).collect(),
            context: reference(context),
        };
        self.representations.insert(id, representation);
    }
}

/// A string of the file: doubled quotes are one, `\X2\…\X0\` are code points of four digits.
pub(super) fn plain_text(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text)
        .replace("''", "'")
        .replace("\\\\", "\\");
    let mut parts = text.split("\\X2\\");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (coded, rest) = part.split_once("\\X0\\").unwrap_or(("", part));
        let digits: Vec<u16> = (coded.as_bytes().chunks(4))
            .filter_map(|four| u16::from_str_radix(std::str::from_utf8(four).ok()?, 16).ok())
            .collect();
        plain.push_str(&String::from_utf16_lossy(&digits));
        plain.push_str(rest);
    }
    plain
}

/// Relations whose second end is the part: none, where what the file says cannot be read.
pub(super) fn second_is_part(file: &File<'_, '_>) -> BTreeSet<u64> {
    let mut assembly = Assembly {
        file,
        said: Said::of(file).unwrap_or_default(),
        nodes: Vec::new(),
        contexts: BTreeMap::new(),
        node_of: BTreeMap::new(),
        shapes_of: BTreeSet::new(),
        roots: Vec::new(),
    };
    assembly.join();
    let placed = assembly.placed().into_iter();
    placed
        .filter_map(|(_, part, relation)| (part == 1).then_some(relation))
        .collect()
}

impl<'f, 'a, 'b> Assembly<'f, 'a, 'b> {
    /// Reads what the file says, without the solids themselves.
    pub fn read(file: &'f File<'a, 'b>) -> Result<Self, StepError> {
        let mut assembly = Self {
            file,
            said: Said::of(file)?,
            nodes: Vec::new(),
            contexts: BTreeMap::new(),
            node_of: BTreeMap::new(),
            shapes_of: BTreeSet::new(),
            roots: Vec::new(),
        };
        assembly.join();
        assembly.list_items();
        assembly.relate();
        let starts = assembly.name_products();
        assembly.order(starts)?;
        Ok(assembly)
    }

    /// One node for the representations that plain relationships join.
    fn join(&mut self) {
        let placed: BTreeSet<u64> = self.said.placed.iter().map(|[to, _]| *to).collect();
        let mut beside: BTreeMap<u64, Vec<u64>> = BTreeMap::new();
        for (id, relation) in &self.said.relations {
            if relation.transformed.is_none() && !placed.contains(id) {
                let [a, b] = relation.ends;
                beside.entry(a).or_default().push(b);
                beside.entry(b).or_default().push(a);
            }
        }
        for &id in self.said.representations.keys() {
            if self.node_of.contains_key(&id) {
                continue;
            }
            let node = self.nodes.len();
            self.nodes.push(Node::default());
            let mut waiting = vec![id];
            while let Some(id) = waiting.pop() {
                let known = self.said.representations.contains_key(&id);
                if known && self.node_of.insert(id, node).is_none() {
                    waiting.extend(beside.get(&id).into_iter().flatten());
                }
            }
        }
        for [shape, to] in &self.said.drawn {
            if let (Some(of), Some(node)) = (self.said.shapes.get(shape), self.node_of.get(to)) {
                self.shapes_of.insert((*of, *node));
            }
        }
    }

    fn list_items(&mut self) {
        let mut seen = BTreeSet::new();
        for (&whole, representation) in &self.said.representations {
            let node = self.node_of[&whole];
            for &item in &representation.items {
                let name = self.file.name(item);
                let counts = SOLIDS.contains(&name) || name == "MAPPED_ITEM" || name.is_empty();
                if !counts || !seen.insert((node, item)) {
                    continue;
                }
                if SOLIDS.contains(&name) {
                    self.nodes[node].items.push([item, whole]);
                } else {
                    // Complex instances have no leading name.
                    if let Some(part) = self.mapped(item).and_then(|map| self.node_of.get(&map[1]))
                    {
                        let link = Link::Mapped { item, whole };
                        self.nodes[node].links.push((*part, link));
                    }
                }
            }
        }
    }

    /// The origin, the representation and the target of a `MAPPED_ITEM`.
    fn mapped(&self, item: u64) -> Option<[u64; 3]> {
        let entity = self.file.entity(item, item).ok()?;
        let [.., Value::Reference(map), Value::Reference(target)] = entity.part("MAPPED_ITEM")?
        else {
            return None;
        };
        let map = self.file.entity(*map, item).ok()?;
        match map.part("REPRESENTATION_MAP")? {
            [Value::Reference(origin), Value::Reference(to), ..] => Some([*origin, *to, *target]),
            _ => None,
        }
    }

    /// Relations that usages place: their ends, which one is the part, and their number.
    fn placed(&self) -> Vec<([u64; 2], usize, u64)> {
        let mut links = Vec::new();
        let mut done = BTreeSet::new();
        for &[relation, shape] in &self.said.placed {
            let usage = self.said.shapes.get(&shape);
            let usage = usage.and_then(|usage| self.said.usages.get(usage));
            if let Some(Relation { ends, .. }) = self.said.relations.get(&relation)
                && done.insert(relation)
            {
                let part = usage.map_or(0, |usage| self.part_end(*ends, *usage));
                links.push((*ends, part, relation));
            }
        }
        links
    }

    /// Relations with a place, and usages without any.
    fn relate(&mut self) {
        let mut links = self.placed();
        let done: BTreeSet<u64> = links.iter().map(|link| link.2).collect();
        // Without a usage the first is the part, as the standard has it; unless it is the product.
        let products = self.product_nodes();
        for (&relation, Relation { ends, transformed }) in &self.said.relations {
            if transformed.is_some() && !done.contains(&relation) {
                let [a, b] = ends.map(|end| self.node_of.get(&end));
                let is_product = |node: Option<&usize>| node.is_some_and(|n| products.contains(n));
                let part = usize::from(is_product(a) && !is_product(b));
                links.push((*ends, part, relation));
            }
        }
        let mut inside: BTreeSet<usize> = (self.nodes.iter())
            .flat_map(|node| node.links.iter().map(|(part, _)| *part))
            .collect();
        for (ends, part, relation) in links {
            let [whole, child] = [ends[1 - part], ends[part]].map(|end| self.node_of.get(&end));
            if let (Some(&whole), Some(&child)) = (whole, child) {
                inside.insert(child);
                let link = Link::Related { relation, part };
                self.nodes[whole].links.push((child, link));
            }
        }
        let shapes_of = &self.shapes_of;
        let node = |definition: u64| {
            let mut all = shapes_of.range((definition, 0)..=(definition, usize::MAX));
            all.next().map(|(_, node)| *node)
        };
        for &[whole, child] in self.said.usages.values() {
            if let (Some(whole), Some(child)) = (node(whole), node(child))
                && whole != child
                && inside.insert(child)
            {
                self.nodes[whole].links.push((child, Link::Same));
            }
        }
    }

    /// Which end of a relation is the part: the usage's products decide, since programs write the ends in either order.
    fn part_end(&self, ends: [u64; 2], [whole, part]: [u64; 2]) -> usize {
        let nodes = ends.map(|end| self.node_of.get(&end));
        let is = |end: usize, definition: u64| {
            nodes[end].is_some_and(|node| self.shapes_of.contains(&(definition, *node)))
        };
        usize::from(!is(0, part) && is(1, part) || !is(1, whole) && is(0, whole))
    }

    /// Nodes that are the shape of a product.
    fn product_nodes(&self) -> BTreeSet<usize> {
        let drawn = self.said.drawn.iter().filter(|[shape, _]| {
            let of = self.said.shapes.get(shape);
            of.is_some_and(|of| self.said.definitions.contains_key(of))
        });
        drawn
            .filter_map(|[_, to]| self.node_of.get(to).copied())
            .collect()
    }

    /// The nodes to start from: those of products; all, where there is none. Then each solid counts where it is listed first.
    fn name_products(&mut self) -> BTreeSet<usize> {
        for [shape, to] in &self.said.drawn {
            let product = (self.said.shapes.get(shape))
                .and_then(|definition| self.said.definitions.get(definition))
                .and_then(|formation| self.said.formations.get(formation))
                .and_then(|product| self.said.products.get(product));
            if let (Some(product), Some(&node)) = (product, self.node_of.get(to)) {
                self.nodes[node].products.push(product.clone());
            }
        }
        let products = self.product_nodes();
        if !products.is_empty() {
            return products;
        }
        let mut seen = BTreeSet::new();
        for node in &mut self.nodes {
            node.items.retain(|[item, _]| seen.insert(*item));
        }
        (0..self.nodes.len()).collect()
    }

    /// Finds the roots and the places of parts in each other, and what has solids below.
    fn order(&mut self, starts: BTreeSet<usize>) -> Result<(), StepError> {
        let mut counted = starts.clone();
        let mut waiting: Vec<usize> = starts.iter().copied().collect();
        let mut uses = vec![0_usize; self.nodes.len()];
        while let Some(node) = waiting.pop() {
            for (child, _) in &self.nodes[node].links {
                uses[*child] += 1;
                if counted.insert(*child) {
                    waiting.push(*child);
                }
            }
        }
        self.roots = starts.into_iter().filter(|node| uses[*node] == 0).collect();
        let mut order = self.roots.clone();
        let mut at = 0;
        while let Some(&node) = order.get(at) {
            for (child, _) in &self.nodes[node].links {
                uses[*child] -= 1;
                if uses[*child] == 0 {
                    order.push(*child);
                }
            }
            at += 1;
        }
        if let Some(node) = counted.iter().find(|node| uses[**node] > 0) {
            let inside = self.node_of.iter().find(|(_, at)| *at == node);
            let id = inside.map_or(0, |(id, _)| *id);
            return Err(StepError::Cycle { id });
        }
        for &node in order.iter().rev() {
            let links = std::mem::take(&mut self.nodes[node].links);
            let below = links
                .into_iter()
                .filter(|(child, _)| self.nodes[*child].shaped);
            let mut children = Vec::new();
            for (child, link) in below.collect::<Vec<_>>() {
                children.push((child, self.place(&link)?));
            }
            self.nodes[node].shaped = !self.nodes[node].items.is_empty() || !children.is_empty();
            self.nodes[node].children = children;
        }
        Ok(())
    }

    /// The context of a representation.
    pub fn context(&mut self, representation: u64) -> Result<Context, StepError> {
        let said = self.said.representations.get(&representation);
        let id = said.and_then(|said| said.context);
        let id = id.ok_or(StepError::NoLengthUnit { id: representation })?;
        if let Some(known) = self.contexts.get(&id) {
            return Ok(known.clone());
        }
        let context = units::context(self.file.exchange, id, representation)?;
        self.contexts.insert(id, context.clone());
        Ok(context)
    }

    fn place(&mut self, link: &Link) -> Result<Placing, StepError> {
        let (relation, part) = match *link {
            Link::Same => return Ok(Placing::default()),
            Link::Mapped { item, whole } => {
                let Some([origin, inner, target]) = self.mapped(item) else {
                    return Ok(Placing::default());
                };
                let origin = frame(self.file, origin, item, &self.context(inner)?.length)?;
                let target = frame(self.file, target, item, &self.context(whole)?.length)?;
                return Ok(target.after(&inverse(&origin)));
            }
            Link::Related { relation, part } => (relation, part),
        };
        let Some(Relation { ends, transformed }) = self.said.relations.get(&relation) else {
            return Ok(Placing::default());
        };
        let (ends, Some(operator)) = (*ends, *transformed) else {
            return Ok(Placing::default());
        };
        let entity = self.file.entity(operator, relation)?;
        if entity.kind() != "ITEM_DEFINED_TRANSFORMATION" {
            let unit = self.context(ends[1])?.length;
            let placing = frame(self.file, operator, relation, &unit)?;
            return Ok(if part == 0 {
                placing
            } else {
                inverse(&placing)
            });
        }
        let mut frames = [Placing::default(); 2];
        for k in [0, 1] {
            let unit = self.context(ends[k])?.length;
            frames[k] = frame(self.file, entity.reference(2 + k)?, operator, &unit)?;
        }
        Ok(frames[1 - part].after(&inverse(&frames[part])))
    }

    /// Names of the products that have solids, for messages.
    fn names(&self) -> Vec<String> {
        let shaped = self.nodes.iter().filter(|node| node.shaped);
        let names: BTreeSet<String> = shaped.flat_map(|node| &node.products).map(shown).collect();
        names.into_iter().collect()
    }

    /// The solids of a node: item and representation.
    pub fn items(&self, node: usize) -> &[[u64; 2]] {
        &self.nodes[node].items
    }

    /// All places of what is picked, in the order of the assembly.
    pub fn places(&self, pick: &PartPick) -> Result<Vec<Place>, StepError> {
        let part = pick.part.as_ref();
        let is = |product: &[String; 2]| part.is_some_and(|part| product.contains(part));
        let named: Vec<bool> = (self.nodes.iter())
            .map(|node| node.products.iter().any(is))
            .collect();
        let mut instances = vec![0; self.nodes.len()];
        let (mut found, mut occurrences, mut steps) = (Vec::new(), 0, 0);
        let start = |&node: &usize| (node, Placing::default(), None);
        let mut waiting: Vec<(usize, Placing, Option<usize>)> =
            self.roots.iter().rev().map(start).collect();
        while let Some((at, placing, mut inside)) = waiting.pop() {
            let node = &self.nodes[at];
            steps += 1;
            if !node.shaped {
                continue;
            }
            if inside.is_none() && (named[at] || pick.part.is_none() && !node.items.is_empty()) {
                inside = Some(occurrences);
                occurrences += 1;
            }
            if !node.items.is_empty() {
                let wanted = pick.instance.is_none_or(|k| inside == Some(k));
                if wanted && (inside.is_some() || pick.part.is_none()) {
                    found.push(Place {
                        node: at,
                        placing,
                        name: node.products.first().map_or_else(String::new, shown),
                        instance: instances[at],
                    });
                }
                instances[at] += 1;
            }
            if found.len() > MOST_PLACES || steps > MOST_STEPS {
                return Err(StepError::TooMany {
                    most: MOST_PLACES,
                    what: "places of parts",
                });
            }
            // A part that has solids of its own and others inside counts each by itself where none is named.
            let inside = inside.filter(|_| pick.part.is_some());
            for (child, placed) in node.children.iter().rev() {
                waiting.push((*child, placing.after(placed), inside));
            }
        }
        match (&pick.part, pick.instance) {
            (Some(name), _) if occurrences == 0 => Err(StepError::NoPart {
                name: name.clone(),
                names: self.names(),
            }),
            (_, Some(instance)) if instance >= occurrences => Err(StepError::NoInstance {
                instance,
                count: occurrences,
            }),
            _ => Ok(found),
        }
    }
}

fn shown([number, name]: &[String; 2]) -> String {
    if name.trim().is_empty() {
        number.clone()
    } else {
        name.clone()
    }
}

/// From coordinates along the axes of a placement, or under an operator, to those of its representation.
fn frame(file: &File<'_, '_>, id: u64, from: u64, unit: &Unit) -> Result<Placing, StepError> {
    let entity = file.entity(id, from)?;
    if entity.kind() == "AXIS2_PLACEMENT_3D" {
        let axes = file.axes(id, from, unit)?;
        return Ok(Placing {
            turn: Matrix3::from_columns(&[axes.x, axes.y, axes.z]),
            scale: 1.0,
            shift: axes.origin.coords,
        });
    }
    if entity.kind() != "CARTESIAN_TRANSFORMATION_OPERATOR_3D" {
        return Err(entity.unreadable("parts are placed by axes or by a transformation operator"));
    }
    // x, y, origin, scale, z, after names of which some programs write three.
    let [.., x, y, origin, scale, z] = entity.longest() else {
        return Err(entity.other("an operator with its attributes"));
    };
    let direction = |value: &Value<'_>| match value {
        Value::Reference(to) => file.direction(*to, id).map(Some),
        _ => Ok(None),
    };
    let Value::Reference(origin) = origin else {
        return Err(entity.other("an operator at a point"));
    };
    let (about, side) = (direction(x)?.unwrap_or_else(Vector3::x), direction(y)?);
    let z = direction(z)?.unwrap_or_else(Vector3::z);
    let across = |v: Vector3| direction_of(&v).filter(|_| v.norm() > 1e-9);
    let x = across(about - z * z.dot(&about));
    let x = x.or_else(|| across(Vector3::y() - z * z.y));
    let x = x.ok_or_else(|| entity.other("an operator with two directions"))?;
    // A y on the other side makes mirror images.
    let y = z.cross(&x);
    let y = if side.is_some_and(|side| side.dot(&y) < 0.0) {
        -y
    } else {
        y
    };
    let scale = match scale {
        Value::Number(scale) => *scale,
        _ => 1.0,
    };
    if !(1e-9..=1e9).contains(&scale) {
        return Err(entity.value("the scale", scale, "from 1e-9 to 1e9"));
    }
    Ok(Placing {
        turn: Matrix3::from_columns(&[x, y, z]),
        scale,
        shift: file.point(*origin, id, unit)?.coords,
    })
}

fn inverse(placing: &Placing) -> Placing {
    let (turn, scale) = (placing.turn.transpose(), 1.0 / placing.scale);
    Placing {
        turn,
        scale,
        shift: -(turn * placing.shift) * scale,
    }
}
