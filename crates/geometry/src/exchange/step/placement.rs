//! Where the assemblies of a STEP file put a surface. ISO 10303-43 and -44.
//!
//! ```text
//! surface ◀─ face ◀─ shell ◀─ solid ◀─ representation ─ relationship with transformation ─▶ representation of the assembly ─▶ …
//!                                            ▲─ REPRESENTATION_MAP ◀─ MAPPED_ITEM ◀─ representation of the assembly
//! ```
//! A transformation takes the axes of one placement to those of another.

use super::StepError;
use super::surface::cartesian_point;
use super::syntax::{Exchange, Instance, Record, Value};
use super::units::Unit;
use crate::math::{Point3, Pose, Rotation, Vector3, direction_of};
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
    unit: &'b Unit,
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
    let mut assemblies = Assemblies {
        exchange,
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
        let ends = [2, 3].map(|k| reference(relation.arguments.get(k)));
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
        let item = |k: usize| reference(operator.arguments.get(k));
        let placed = self.between(item(2), item(3));
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

    /// `AXIS2_PLACEMENT_3D`: a point, the z axis, and about where x points.
    fn axes(&self, id: u64) -> Result<Pose, StepError> {
        let records = self.exchange.records(self.exchange.find(id, id)?)?;
        let record = records
            .iter()
            .find(|record| record.name == "AXIS2_PLACEMENT_3D");
        let wrong = |wanted| StepError::Attribute {
            id,
            what: "a placement".to_owned(),
            wanted,
            found: (records.first()).map_or_else(String::new, |record| record.name.to_owned()),
        };
        let record = record.ok_or_else(|| wrong("an AXIS2_PLACEMENT_3D"))?;
        let at = reference(record.arguments.get(1));
        let at = at.ok_or_else(|| wrong("an AXIS2_PLACEMENT_3D at a point"))?;
        let origin = cartesian_point(self.exchange, at, id, self.unit)?;
        let direction = |k: usize, usual: Vector3| match reference(record.arguments.get(k)) {
            Some(direction) => self.direction(direction, id),
            None => Ok(usual),
        };
        let z = direction(2, Vector3::z())?;
        let about = direction(3, Vector3::x())?;
        let x = (about - z * z.dot(&about)).try_normalize(1e-12);
        let x = x.or_else(|| (Vector3::y() - z * z.y).try_normalize(1e-12));
        let x = x.ok_or_else(|| wrong("an AXIS2_PLACEMENT_3D with two directions"))?;
        let turn = nalgebra::Matrix3::from_columns(&[x, z.cross(&x), z]);
        let turn = nalgebra::Rotation3::from_matrix_unchecked(turn);
        Ok(Pose::from_parts(
            (origin - Point3::origin()).into(),
            Rotation::from_rotation_matrix(&turn),
        ))
    }

    /// `DIRECTION`, with length 1.
    fn direction(&self, id: u64, from: u64) -> Result<Vector3, StepError> {
        let records = self.exchange.records(self.exchange.find(id, from)?)?;
        let record = records.iter().find(|record| record.name == "DIRECTION");
        let ratios = record.and_then(|record| record.arguments.last());
        let read = match ratios {
            Some(Value::List(values)) => match values.as_slice() {
                [Value::Number(x), Value::Number(y), Value::Number(z)] => {
                    direction_of(&Vector3::new(*x, *y, *z))
                }
                _ => None,
            },
            _ => None,
        };
        read.ok_or_else(|| StepError::Attribute {
            id,
            what: "DIRECTION".to_owned(),
            wanted: "three numbers that are not all 0",
            found: ratios.map_or_else(|| "nothing".to_owned(), Value::shown),
        })
    }
}
