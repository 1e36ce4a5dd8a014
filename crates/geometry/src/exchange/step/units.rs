//! Contexts: the units of length and plane angle that numbers are in, and how far what should meet may be apart. ISO
//! 10303-41.
//!
//! A single surface is in the unit of the nearest context above it; what a part is made of in that of its
//! representation.

use super::StepError;
use super::syntax::{Exchange, Record, Value};
pub(super) use crate::exchange::LengthUnit as Unit;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

/// Units defined by units; one by another is all that is in use.
const MAX_CONVERSIONS: usize = 4;

/// Longest text of a unit: those in use have a hundred characters.
const MAX_TEXT: usize = 512;

const CONTEXT: &str = "GLOBAL_UNIT_ASSIGNED_CONTEXT";

/// The first context of the file that names a unit of length, for solids that no representation lists.
///
/// # Errors
/// There is none, or it cannot be read.
pub(super) fn any_context(exchange: &Exchange<'_>, solid: u64) -> Result<Context, StepError> {
    let may_be = |text: &[u8]| text.windows(CONTEXT.len()).any(|w| w == CONTEXT.as_bytes());
    for instance in exchange.instances() {
        if may_be(exchange.text(instance)) {
            match context(exchange, instance.id, instance.id) {
                Err(StepError::NoLengthUnit { .. }) => {}
                other => return other,
            }
        }
    }
    Err(StepError::NoLengthUnit { id: solid })
}

const UNCERTAINTY: &str = "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT";

/// What is measured: its SI unit, and the entity that says so of other units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Quantity {
    Length,
    Angle,
}

impl Quantity {
    fn si(self) -> (&'static str, &'static str) {
        match self {
            Self::Length => ("METRE", "m"),
            Self::Angle => ("RADIAN", "rad"),
        }
    }

    fn entity(self) -> &'static str {
        match self {
            Self::Length => "LENGTH_UNIT",
            Self::Angle => "PLANE_ANGLE_UNIT",
        }
    }
}

/// What the numbers of a representation mean.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Context {
    pub length: Unit,
    /// Its unit of plane angles, rad.
    pub angle_rad: f64,
    /// 0 where it states none, m.
    pub uncertainty_m: f64,
}

/// The context `id`. Angles are in radians where it names no unit for them.
///
/// # Errors
/// No unit of length, or units that cannot be read.
pub(super) fn context(exchange: &Exchange<'_>, id: u64, from: u64) -> Result<Context, StepError> {
    let mut units = Units {
        exchange,
        known: BTreeMap::new(),
    };
    let records = exchange.records(exchange.find(id, from)?)?;
    let length = units.of_context(id, &records, Quantity::Length)?;
    let length = length.ok_or(StepError::NoLengthUnit { id })?;
    let angle = units.of_context(id, &records, Quantity::Angle)?;
    let angle_rad = angle.map_or(1.0, |unit| {
        // Files round it; what they were written from did not.
        let degree = PI / 180.0;
        if (unit.metres() / degree - 1.0).abs() < 1e-6 {
            degree
        } else {
            unit.metres()
        }
    });
    let mut uncertainty_m: f64 = 0.0;
    let stated = records.iter().find(|record| record.name == UNCERTAINTY);
    if let Some(Value::List(measures)) = stated.and_then(|record| record.arguments.last()) {
        for measure in measures {
            if let Value::Reference(measure) = measure
                && let Some((value, unit)) = units.measure(*measure, id)?
                && let Some(unit) = units.unit(unit, *measure, 0, Quantity::Length)?
            {
                uncertainty_m = uncertainty_m.max(unit.to_metres(value));
            }
        }
    }
    Ok(Context {
        length,
        angle_rad,
        uncertainty_m: if uncertainty_m.is_finite() {
            uncertainty_m
        } else {
            0.0
        },
    })
}

/// The unit of the context above `surface`; of the only one in the file; millimetres, which STEP
/// files are in unless they say something else.
pub(super) fn length_unit(exchange: &Exchange<'_>, surface: u64) -> Result<Unit, StepError> {
    let mut units = Units {
        exchange,
        known: BTreeMap::new(),
    };
    let mut contexts: Vec<(u64, Unit)> = Vec::new();
    for instance in exchange.instances() {
        let text = exchange.text(instance);
        // The text tells without parsing every instance.
        let may_be = text.starts_with(b"(") || text.starts_with(CONTEXT.as_bytes());
        if !may_be
            || !text
                .windows(CONTEXT.len())
                .any(|window| window == CONTEXT.as_bytes())
        {
            continue;
        }
        let records = exchange.records(instance)?;
        if let Some(unit) = units.of_context(instance.id, &records, Quantity::Length)? {
            contexts.push((instance.id, unit));
        }
    }
    let Some((_, first)) = contexts.first() else {
        return Ok(Unit::assumed_millimetres());
    };
    if contexts.iter().all(|(_, unit)| unit == first) {
        return Ok(first.clone());
    }
    let above = context_above(
        exchange,
        surface,
        &contexts.iter().map(|context| context.0).collect(),
    );
    let found = contexts.iter().find(|context| Some(context.0) == above);
    Ok(found.map_or_else(|| first.clone(), |context| context.1.clone()))
}

/// Walks up from the surface through what refers to it, in rings, until something there refers to a
/// context.
fn context_above(exchange: &Exchange<'_>, surface: u64, contexts: &BTreeSet<u64>) -> Option<u64> {
    let mut up: Vec<(u64, u64)> = Vec::new();
    let mut context_of: BTreeMap<u64, u64> = BTreeMap::new();
    for instance in exchange.instances() {
        for to in exchange.references(instance) {
            up.push((to, instance.id));
            if contexts.contains(&to) {
                context_of.entry(instance.id).or_insert(to);
            }
        }
    }
    up.sort_unstable();
    let mut seen = BTreeSet::from([surface]);
    let mut ring = vec![surface];
    while !ring.is_empty() {
        if let Some(context) = ring.iter().find_map(|id| context_of.get(id)) {
            return Some(*context);
        }
        let mut next = Vec::new();
        for id in ring {
            let from = up.partition_point(|pair| pair.0 < id);
            let users = up[from..]
                .iter()
                .take_while(|pair| pair.0 == id)
                .map(|pair| pair.1);
            next.extend(users.filter(|user| seen.insert(*user)));
        }
        ring = next;
    }
    None
}

/// Units by instance, each looked at once: many contexts may share one.
struct Units<'a, 'b> {
    exchange: &'b Exchange<'a>,
    known: BTreeMap<(Quantity, u64), Option<Unit>>,
}

impl Units<'_, '_> {
    /// The unit of a quantity among those of a context.
    fn of_context(
        &mut self,
        id: u64,
        records: &[Record<'_>],
        quantity: Quantity,
    ) -> Result<Option<Unit>, StepError> {
        let context = records.iter().find(|record| record.name == CONTEXT);
        let Some(Value::List(units)) = context.and_then(|record| record.arguments.last()) else {
            return Ok(None);
        };
        for unit in units {
            if let Value::Reference(unit) = unit
                && let Some(found) = self.unit(*unit, id, 0, quantity)?
            {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// What an instance is as a unit of a quantity; `None` for one of another, or an instance that is not a unit.
    fn unit(
        &mut self,
        id: u64,
        from: u64,
        depth: usize,
        quantity: Quantity,
    ) -> Result<Option<Unit>, StepError> {
        if let Some(known) = self.known.get(&(quantity, id)) {
            return Ok(known.clone());
        }
        let unit = self.read(id, from, depth, quantity)?;
        self.known.insert((quantity, id), unit.clone());
        Ok(unit)
    }

    /// Records of an instance that may be a unit.
    fn records(&self, id: u64, from: u64) -> Result<Vec<Record<'_>>, StepError> {
        let instance = self.exchange.find(id, from)?;
        if self.exchange.text(instance).len() > MAX_TEXT {
            Ok(Vec::new())
        } else {
            self.exchange.records(instance)
        }
    }

    /// A number and its unit. Plain LENGTH_MEASURE_WITH_UNIT, or the complex form with MEASURE_WITH_UNIT, or an
    /// uncertainty with its names behind.
    fn measure(&self, id: u64, from: u64) -> Result<Option<(f64, u64)>, StepError> {
        let records = self.records(id, from)?;
        let found = records
            .iter()
            .find_map(|record| match record.arguments.as_slice() {
                [Value::Typed(_, number), Value::Reference(unit), ..] => match number.as_slice() {
                    [Value::Number(number)] => Some((*number, *unit)),
                    _ => None,
                },
                [Value::Number(number), Value::Reference(unit), ..] => Some((*number, *unit)),
                _ => None,
            });
        Ok(found)
    }

    fn read(
        &mut self,
        id: u64,
        from: u64,
        depth: usize,
        quantity: Quantity,
    ) -> Result<Option<Unit>, StepError> {
        let records = self.records(id, from)?;
        let part = |name: &str| {
            records
                .iter()
                .find(|record| record.name == name)
                .map(|record| record.arguments.as_slice())
        };
        let (si, symbol) = quantity.si();
        if let Some([.., prefix, Value::Enumeration(name)]) = part("SI_UNIT")
            && *name == si
        {
            let (what, wanted) = ("SI_UNIT".to_owned(), "with an SI prefix");
            let unit = match prefix {
                Value::Omitted | Value::Derived => Some(Unit::of_metres(symbol, 1.0, 1.0)),
                Value::Enumeration(prefix) => prefixed(prefix),
                _ => None,
            };
            return unit.map(Some).ok_or_else(|| StepError::Attribute {
                id,
                what,
                wanted,
                found: prefix.shown(),
            });
        }
        // Angles are conversion-based as lengths are: only what says which it is counts.
        let (Some(conversion), Some(_), true) = (
            part("CONVERSION_BASED_UNIT"),
            part(quantity.entity()),
            depth < MAX_CONVERSIONS,
        ) else {
            return Ok(None);
        };
        let [Value::Text(name), Value::Reference(measure)] = conversion else {
            return Ok(None);
        };
        let (name, measure) = (String::from_utf8_lossy(name).to_lowercase(), *measure);
        let Some((factor, base)) = self.measure(measure, id)? else {
            return Ok(None);
        };
        let Some(base) = self.unit(base, measure, depth + 1, quantity)? else {
            return Ok(None);
        };
        let unit = base.times(&name, factor);
        if unit.is_length() {
            Ok(Some(unit))
        } else {
            Err(StepError::Unit {
                id,
                metres: unit.metres(),
            })
        }
    }
}

fn prefixed(prefix: &str) -> Option<Unit> {
    let (symbol, numerator, denominator) = match prefix {
        "KILO" => ("km", 1e3, 1.0),
        "HECTO" => ("hm", 1e2, 1.0),
        "DECA" => ("dam", 1e1, 1.0),
        "DECI" => ("dm", 1.0, 1e1),
        "CENTI" => ("cm", 1.0, 1e2),
        "MILLI" => ("mm", 1.0, 1e3),
        "MICRO" => ("µm", 1.0, 1e6),
        "NANO" => ("nm", 1.0, 1e9),
        "PICO" => ("pm", 1.0, 1e12),
        "MEGA" => ("Mm", 1e6, 1.0),
        _ => return None,
    };
    Some(Unit::of_metres(symbol, numerator, denominator))
}
