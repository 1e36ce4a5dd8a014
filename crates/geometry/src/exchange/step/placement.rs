//! Where the assemblies of a STEP file put a surface. ISO 10303-43 and -44.
//!
//! ```text
//! surface ◀─ face ◀─ shell ◀─ solid ◀─ representation ─ relationship with transformation ─▶ representation of the assembly ─▶ …
//!                                            ▲─ REPRESENTATION_MAP ◀─ MAPPED_ITEM ◀─ representation of the assembly
//! ```
//! A transformation takes the axes of one placement to those of another.

use super::StepError;
use super::assembly::second_is_part;
use super::entity::File;
use super::syntax::{Exchange, Instance, Record, Value};
use super::units::Unit;
use crate::math::{Point3, Pose, Rotation};
use std::collections::{BTreeMap, BTreeSet};

/// Assemblies inside each other at most, and places of one part; what a file says beyond is not a
/// single place anyway.
const MOST_DEPTH: usize = 32;
const MOST_PLACES: usize = 1_000;

/// A relation by which a representation stands in another.
struct Link {
    parent: u64,
    /// Or why it cannot be read, which matters only where the relation does.
    placed: Result<Pose, StepError>,
}

struct Assemblies<'a, 'b> {
    exchange: &'b Exchange<'a>,
    file: File<'a, 'b>,
    unit: &'b Unit,
    /// Relations whose second end is the part.
    turned: BTreeSet<u64>,
    /// (to, from), sorted: who refers to an instance.
    users: Vec<(u64, u64)>,
    links: BTreeMap<u64, Vec<Link>>,
}

/// Every place in which the file puts a surface: one, without assemblies.
///
/// # Errors
/// A placement on the way up that cannot be read.
pub(super) fn places(
    exchange: &Exchange<'_>,
    surface: u64,
    unit: &Unit,
) -> Result<Vec<Pose>, StepError> {
    let is_placing = |instance: &Instance| {
        let text = exchange.text(instance);
        text.starts_with(b"MAPPED_ITEM")
            || super::surface::contains(
                &text[..text.len().min(4096)],
                b"REPRESENTATION_RELATIONSHIP",
            )
    };
    // Most files have no assemblies.
    if !exchange.instances().iter().any(is_placing) {
        return Ok(vec![Pose::identity()]);
    }
    let mut users: Vec<(u64, u64)> = Vec::new();
    for instance in exchange.instances() {
        let to = exchange.references(instance);
        users.extend(to.into_iter().map(|to| (to, instance.id)));
    }
    users.sort_unstable();
    let file = File::new(exchange);
    let mut assemblies = Assemblies {
        exchange,
        turned: second_is_part(&file),
        file,
        unit,
        users,
        links: BTreeMap::new(),
    };
    for instance in exchange
        .instances()
        .iter()
        .filter(|instance| is_placing(instance))
    {
        assemblies.add(instance);
    }
    let mut found = Vec::new();
    for representation in assemblies.representations_above(surface) {
        let mut above = Vec::new();
        assemblies.place(representation, Pose::identity(), &mut above, &mut found)?;
    }
    if found.is_empty() {
        found.push(Pose::identity());
    }
    Ok(found)
}

fn reference(value: Option<&Value<'_>>) -> Option<u64> {
    match value {
        Some(Value::Reference(to)) => Some(*to),
        _ => None,
    }
}

impl<'a> Assemblies<'a, '_> {
    fn records(&self, id: u64) -> Vec<Record<'a>> {
        let instance = self.exchange.find(id, id);
        instance
            .and_then(|instance| self.exchange.records(instance))
            .unwrap_or_default()
    }

    fn users(&self, id: u64) -> impl Iterator<Item = u64> + '_ {
        let from = self.users.partition_point(|pair| pair.0 < id);
        self.users[from..]
            .iter()
            .take_while(move |pair| pair.0 == id)
            .map(|pair| pair.1)
    }

    /// Representations: those that list items in a context.
    fn is_representation(&self, id: u64) -> bool {
        let Ok(instance) = self.exchange.find(id, id) else {
            return false;
        };
        let text = self.exchange.text(instance);
        let name = text.split(|&b| b == b'(').next().unwrap_or_default();
        name.trim_ascii().ends_with(b"REPRESENTATION")
    }

    /// The nearest representations that contain an instance.
    fn representations_above(&self, id: u64) -> BTreeSet<u64> {
        let (mut seen, mut found) = (BTreeSet::from([id]), BTreeSet::new());
        let mut waiting = vec![id];
        while let Some(id) = waiting.pop() {
            for user in self.users(id) {
                if !seen.insert(user) {
                    continue;
                }
                match self.is_representation(user) {
                    true => drop(found.insert(user)),
                    false => waiting.push(user),
                }
            }
        }
        found
    }

    /// What an instance says about places of representations in others.
    fn add(&mut self, instance: &Instance) {
        let records = self.exchange.records(instance).unwrap_or_default();
        let part = |name: &str| records.iter().find(|record| record.name == name);
        if let Some(item) = part("MAPPED_ITEM") {
            let (map, target) = (
                reference(item.arguments.get(1)),
                reference(item.arguments.get(2)),
            );
            let map = map.map(|map| self.records(map)).unwrap_or_default();
            let map = map
                .iter()
                .find(|record| record.name == "REPRESENTATION_MAP");
            let Some(map) = map else { return };
            let origin = reference(map.arguments.first());
            let Some(child) = reference(map.arguments.get(1)) else {
                return;
            };
            let placed = self.between(origin, target);
            let parents: Vec<u64> = self
                .users(instance.id)
                .filter(|user| self.is_representation(*user))
                .collect();
            for parent in parents {
                self.links.entry(child).or_default().push(Link {
                    parent,
                    placed: placed.clone(),
                });
            }
            return;
        }
        let plain = [
            "REPRESENTATION_RELATIONSHIP",
            "SHAPE_REPRESENTATION_RELATIONSHIP",
        ];
        let relation = records
            .iter()
            .find(|record| plain.contains(&record.name) && record.arguments.len() >= 4);
        let Some(relation) = relation else { return };
        let order = if self.turned.contains(&instance.id) {
            [3, 2]
        } else {
            [2, 3]
        };
        let ends = order.map(|k| reference(relation.arguments.get(k)));
        let [Some(child), Some(parent)] = ends else {
            return;
        };
        let transformed = part("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION");
        let Some(transformed) = transformed else {
            // Two representations of one thing: the part's shape, and where its product is described.
            for (child, parent) in [(child, parent), (parent, child)] {
                let placed = Ok(Pose::identity());
                self.links
                    .entry(child)
                    .or_default()
                    .push(Link { parent, placed });
            }
            return;
        };
        let operator = reference(transformed.arguments.first());
        let operator = operator.map(|id| self.records(id)).unwrap_or_default();
        let operator = operator
            .iter()
            .find(|record| record.name == "ITEM_DEFINED_TRANSFORMATION");
        let Some(operator) = operator else { return };
        let [from, to] = order.map(|k| reference(operator.arguments.get(k)));
        let placed = self.between(from, to);
        self.links
            .entry(child)
            .or_default()
            .push(Link { parent, placed });
    }

    /// Every way up from a representation.
    fn place(
        &self,
        id: u64,
        placed: Pose,
        above: &mut Vec<u64>,
        found: &mut Vec<Pose>,
    ) -> Result<(), StepError> {
        if above.contains(&id) || above.len() > MOST_DEPTH || found.len() >= MOST_PLACES {
            return Ok(());
        }
        above.push(id);
        let mut top = true;
        for link in self.links.get(&id).into_iter().flatten() {
            if !above.contains(&link.parent) {
                top = false;
                self.place(link.parent, link.placed.clone()? * placed, above, found)?;
            }
        }
        if top {
            found.push(placed);
        }
        above.pop();
        Ok(())
    }

    /// The motion that takes one set of axes to another; those that are left out are the origin's.
    fn between(&self, from: Option<u64>, to: Option<u64>) -> Result<Pose, StepError> {
        let axes = |id: Option<u64>| id.map_or(Ok(Pose::identity()), |id| self.axes(id));
        Ok(axes(to)? * axes(from)?.inverse())
    }

    fn axes(&self, id: u64) -> Result<Pose, StepError> {
        let axes = self.file.axes(id, id, self.unit)?;
        let turn = nalgebra::Matrix3::from_columns(&[axes.x, axes.y, axes.z]);
        let turn = nalgebra::Rotation3::from_matrix_unchecked(turn);
        Ok(Pose::from_parts(
            (axes.origin - Point3::origin()).into(),
            Rotation::from_rotation_matrix(&turn),
        ))
    }
}
