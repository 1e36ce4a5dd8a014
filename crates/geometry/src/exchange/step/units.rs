//! The length unit that a surface's coordinates are in: that of the nearest context above it. ISO
//! 10303-41.

use super::StepError;
use super::syntax::{Exchange, Record, Value};
pub(super) use crate::exchange::LengthUnit as Unit;
use std::collections::{BTreeMap, BTreeSet};

/// Units defined by units; one by another is all that is in use.
const MAX_CONVERSIONS: usize = 4;

/// Longest text of a unit: those in use have a hundred characters.
const MAX_TEXT: usize = 512;

const CONTEXT: &str = "GLOBAL_UNIT_ASSIGNED_CONTEXT";

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
        if let Some(unit) = units.of_context(instance.id, &records)? {
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
    known: BTreeMap<u64, Option<Unit>>,
}

impl Units<'_, '_> {
    /// The length unit among those of a context.
    fn of_context(&mut self, id: u64, records: &[Record<'_>]) -> Result<Option<Unit>, StepError> {
        let context = records.iter().find(|record| record.name == CONTEXT);
        let Some(Value::List(units)) = context.and_then(|record| record.arguments.last()) else {
            return Ok(None);
        };
        for unit in units {
            if let Value::Reference(unit) = unit
                && let Some(found) = self.length(*unit, id, 0)?
            {
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// The length that an instance is; `None` for an angle, or an instance that is not a unit.
    fn length(&mut self, id: u64, from: u64, depth: usize) -> Result<Option<Unit>, StepError> {
        if let Some(known) = self.known.get(&id) {
            return Ok(known.clone());
        }
        let unit = self.read(id, from, depth)?;
        self.known.insert(id, unit.clone());
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

    fn read(&mut self, id: u64, from: u64, depth: usize) -> Result<Option<Unit>, StepError> {
        let records = self.records(id, from)?;
        let part = |name: &str| {
            records
                .iter()
                .find(|record| record.name == name)
                .map(|record| record.arguments.as_slice())
        };
        if let Some([.., prefix, Value::Enumeration("METRE")]) = part("SI_UNIT") {
            let (what, wanted) = ("SI_UNIT".to_owned(), "with an SI prefix");
            let unit = match prefix {
                Value::Omitted | Value::Derived => Some(Unit::of_metres("m", 1.0, 1.0)),
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
        // Angles are conversion-based too: only what says that it is a length counts.
        let (Some(conversion), Some(_), true) = (
            part("CONVERSION_BASED_UNIT"),
            part("LENGTH_UNIT"),
            depth < MAX_CONVERSIONS,
        ) else {
            return Ok(None);
        };
        let [Value::Text(name), Value::Reference(measure)] = conversion else {
            return Ok(None);
        };
        let (name, measure) = (String::from_utf8_lossy(name).to_lowercase(), *measure);
        // Plain LENGTH_MEASURE_WITH_UNIT, or the complex form with MEASURE_WITH_UNIT.
        let factor_and_base = self.records(measure, id)?.iter().find_map(|record| {
            match record.arguments.as_slice() {
                [Value::Typed(_, factor), Value::Reference(base)] => match factor.as_slice() {
                    [Value::Number(factor)] => Some((*factor, *base)),
                    _ => None,
                },
                [Value::Number(factor), Value::Reference(base)] => Some((*factor, *base)),
                _ => None,
            }
        });
        let Some((factor, base)) = factor_and_base else {
            return Ok(None);
        };
        let Some(base) = self.length(base, measure, depth + 1)? else {
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
