//! Parts: every solid and sheet of a file, or some, where its assemblies put them.

use super::StepError;
use super::assembly::{Assembly, Place, plain_text};
use super::entity::{File, leading_name};
use super::pick::{PartLeftOut, PartPick};
use super::syntax::{Exchange, Value};
use super::topology::{self, SOLIDS};
use super::units::{self, Context, Unit};
use crate::exchange::LengthUnit;
use crate::part::{Brep, BrepCurve, Carrier, Part, PartError, Placing};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Faces of one part in all its places; a face counts more the more control points it has.
const MOST_FACES: usize = 1_000_000;
const POINTS_A_FACE: usize = 64;

/// What a file has.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedPart {
    /// m, all in the coordinates of the file's uppermost assembly.
    pub brep: Brep,
    /// That of the first solid's representation.
    pub unit: LengthUnit,
    /// In the order of their faces.
    pub solids: Vec<PlacedSolid>,
    /// What the file has beside.
    pub left_out: PartLeftOut,
    /// What was taken otherwise than the file says.
    pub notes: Vec<String>,
}

/// A solid or a model of sheets in one place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlacedSolid {
    /// Of its product; its own where it has none.
    pub name: String,
    /// Its faces in the boundary.
    pub faces: Range<usize>,
    /// Which place of its product it stands in, from 0.
    pub instance: usize,
}

impl ImportedPart {
    /// The part. Senses that were wrong in the file are turned in the boundary too, and noted. With `partial`, faces that make
    /// no part are taken out of it and counted as left out.
    ///
    /// # Errors
    /// See [`Part::new`] and [`Part::partly`].
    pub fn part(&mut self, partial: bool) -> Result<Part, PartError> {
        let part = match partial {
            false => Part::new(&self.brep)?,
            true => {
                let names: Vec<&str> = self.brep.faces.iter().map(|f| f.carrier.name()).collect();
                let (part, gone) = Part::partly(&mut self.brep)?;
                for (face, error) in &gone {
                    self.left_out.unfit(names[*face as usize], error);
                }
                let kept = |at: usize| at - gone.partition_point(|(f, _)| (*f as usize) < at);
                for solid in &mut self.solids {
                    solid.faces = kept(solid.faces.start)..kept(solid.faces.end);
                }
                self.solids.retain(|solid| !solid.faces.is_empty());
                part
            }
        };
        part.senses().correct(&mut self.brep);
        self.notes.extend(part.senses().notes());
        Ok(part)
    }
}

/// Reads the boundary of a file's parts.
///
/// # Errors
/// See [`StepError`]; each says what is wrong and where.
pub fn read_part(bytes: &[u8], pick: &PartPick) -> Result<ImportedPart, StepError> {
    let exchange = Exchange::index(bytes)?;
    let file = File::new(&exchange);
    let mut left_out = PartLeftOut::default();
    let mut notes = Vec::new();
    let all = census(&file, &mut left_out, &mut notes);
    let mut assembly = Assembly::read(&file)?;
    let places = assembly.places(pick)?;
    let mut reader = Definitions {
        file: &file,
        partial: pick.partial,
        left_out,
        read: BTreeMap::new(),
        taken: BTreeSet::new(),
        unit: None,
    };
    let mut solids = Vec::new();
    let mut brep = Brep::default();
    if places.is_empty() {
        // A file without products, or whose solids none of them reaches.
        notes.push("no product or representation lists the solids: all are read".to_owned());
        reader.loose(&all, &mut brep, &mut solids)?;
    } else {
        reader.definitions(&mut assembly, &places)?;
        reader.put(&places, &mut brep, &mut solids)?;
    }
    let mut left_out = reader.left_out;
    notes.extend(file.notes());
    left_out.solids = all.iter().filter(|id| !reader.taken.contains(id)).count();
    let Some(unit) = reader.unit.filter(|_| !brep.faces.is_empty()) else {
        return Err(StepError::NoFaces {
            instances: exchange.instances().len(),
            left_out: left_out.to_string(),
        });
    };
    Ok(ImportedPart {
        brep,
        unit,
        solids,
        left_out,
        notes,
    })
}

/// What a node's solids are.
struct Definition {
    name: String,
    brep: Brep,
}

struct Definitions<'f, 'a, 'b> {
    file: &'f File<'a, 'b>,
    partial: bool,
    left_out: PartLeftOut,
    read: BTreeMap<usize, Vec<Definition>>,
    /// Solids that were read.
    taken: BTreeSet<u64>,
    unit: Option<Unit>,
}

impl Definitions<'_, '_, '_> {
    fn solid(&mut self, id: u64, from: u64, context: &Context) -> Result<Definition, StepError> {
        self.taken.insert(id);
        self.unit.get_or_insert_with(|| context.length.clone());
        let own = self.file.entity(id, from)?;
        let name = match own.get(0) {
            Some(Value::Text(text)) => plain_text(text),
            _ => String::new(),
        };
        let (partial, left_out) = (self.partial, &mut self.left_out);
        let brep = topology::read(self.file, id, from, context, partial, left_out)?;
        Ok(Definition { name, brep })
    }

    /// Reads each node once, however often it is placed.
    fn definitions(
        &mut self,
        assembly: &mut Assembly<'_, '_, '_>,
        places: &[Place],
    ) -> Result<(), StepError> {
        for place in places {
            if self.read.contains_key(&place.node) {
                continue;
            }
            let mut all = Vec::new();
            for [item, representation] in assembly.items(place.node).to_vec() {
                let context = assembly.context(representation)?;
                all.push(self.solid(item, representation, &context)?);
            }
            self.read.insert(place.node, all);
        }
        Ok(())
    }

    fn put(
        &self,
        places: &[Place],
        brep: &mut Brep,
        solids: &mut Vec<PlacedSolid>,
    ) -> Result<(), StepError> {
        let weight = |node: &usize| -> usize {
            let all = self.read.get(node).into_iter().flatten();
            all.map(|one| weight(&one.brep)).sum()
        };
        let weights: BTreeMap<usize, usize> =
            self.read.keys().map(|node| (*node, weight(node))).collect();
        let total = places.iter().fold(0, |sum: usize, place| {
            sum.saturating_add(weights[&place.node])
        });
        if total > MOST_FACES {
            let what = "faces in all places of the parts";
            return Err(StepError::TooMany {
                most: MOST_FACES,
                what,
            });
        }
        for place in places {
            for one in self.read.get(&place.node).into_iter().flatten() {
                let first = brep.faces.len();
                match place.placing == Placing::default() {
                    true => brep.add(one.brep.clone()),
                    false => brep.add(one.brep.placed(&place.placing)?),
                }
                let name = if place.name.is_empty() {
                    &one.name
                } else {
                    &place.name
                };
                solids.push(PlacedSolid {
                    name: name.clone(),
                    faces: first..brep.faces.len(),
                    instance: place.instance,
                });
            }
        }
        Ok(())
    }

    /// Solids that no representation lists, in the file's own unit.
    fn loose(
        &mut self,
        all: &[u64],
        brep: &mut Brep,
        solids: &mut Vec<PlacedSolid>,
    ) -> Result<(), StepError> {
        let Some(&first) = all.first() else {
            return Ok(());
        };
        let context = units::any_context(self.file.exchange, first)?;
        for &id in all {
            let one = self.solid(id, id, &context)?;
            let first = brep.faces.len();
            brep.add(one.brep);
            solids.push(PlacedSolid {
                name: one.name,
                faces: first..brep.faces.len(),
                instance: 0,
            });
        }
        Ok(())
    }
}

/// A measure of the memory that a boundary takes, in faces.
fn weight(brep: &Brep) -> usize {
    let surfaces = brep.faces.iter().map(|face| match &face.carrier {
        Carrier::Spline(surface) => surface.net().points().len(),
        _ => 0,
    });
    let curves = brep.edges.iter().map(|edge| match &edge.curve {
        BrepCurve::Spline(curve) => curve.points().len(),
        _ => 0,
    });
    let points = surfaces.sum::<usize>() + curves.sum::<usize>() + 4 * brep.edges.len();
    brep.faces.len() + points / POINTS_A_FACE
}

/// Counts what parts have not; returns the solids and sheets that no other contains.
fn census(file: &File<'_, '_>, left_out: &mut PartLeftOut, notes: &mut Vec<String>) -> Vec<u64> {
    let (mut solids, mut shells, mut inside) = (Vec::new(), Vec::new(), BTreeSet::new());
    let (mut faces, mut in_shells) = (Vec::new(), BTreeSet::new());
    let (mut styles, mut tolerances) = (0, 0);
    for instance in file.exchange.instances() {
        let text = file.exchange.text(instance);
        match leading_name(text) {
            "CLOSED_SHELL" | "OPEN_SHELL" => {
                shells.push(instance.id);
                in_shells.extend(file.exchange.references(instance));
            }
            "CONNECTED_FACE_SET" | "ORIENTED_FACE" => {
                in_shells.extend(file.exchange.references(instance));
            }
            "ADVANCED_FACE" | "FACE_SURFACE" => faces.push(instance.id),
            "ORIENTED_CLOSED_SHELL" => inside.extend(file.exchange.references(instance)),
            name if SOLIDS.contains(&name) => {
                inside.extend(file.exchange.references(instance));
                solids.push(instance.id);
            }
            "GEOMETRIC_CURVE_SET"
            | "EDGE_BASED_WIREFRAME_MODEL"
            | "SHELL_BASED_WIREFRAME_MODEL" => {
                left_out.wireframes += 1;
            }
            "GEOMETRIC_SET" => left_out.sets += 1,
            "CSG_SOLID"
            | "EXTRUDED_AREA_SOLID"
            | "REVOLVED_AREA_SOLID"
            | "SWEPT_DISK_SOLID"
            | "EXTRUDED_FACE_SOLID"
            | "REVOLVED_FACE_SOLID"
            | "SOLID_REPLICA"
            | "HALF_SPACE_SOLID" => left_out.constructed += 1,
            name if name.starts_with("TESSELLATED_S") || name == "TESSELLATED_GEOMETRIC_SET" => {
                left_out.tessellated += 1;
            }
            "DOCUMENT_FILE" => {
                let name = file.entity(instance.id, instance.id);
                if let Ok(entity) = name
                    && let Some(Value::Text(text)) = entity.get(0)
                    && text
                        .to_ascii_lowercase()
                        .windows(3)
                        .any(|w| w == b"stp" || w == b"ste")
                {
                    left_out.elsewhere.push(plain_text(text));
                }
            }
            "STYLED_ITEM" | "OVER_RIDING_STYLED_ITEM" => styles += 1,
            name if name.ends_with("_TOLERANCE") || name.starts_with("DIMENSIONAL_") => {
                tolerances += usize::from(name != "DIMENSIONAL_EXPONENTS");
            }
            _ => {}
        }
    }
    if styles > 0 {
        notes.push(format!("{styles} colours and styles are not read"));
    }
    if tolerances > 0 {
        notes.push(format!(
            "{tolerances} dimensions and tolerances are not read"
        ));
    }
    left_out.lone_faces = faces.iter().filter(|id| !in_shells.contains(id)).count();
    solids.extend(shells);
    solids.retain(|id| !inside.contains(id));
    solids.sort_unstable();
    solids
}
