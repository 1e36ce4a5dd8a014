//! One instance with its attributes, asked for by place; points, directions and axes. Each error names the instance.

use super::StepError;
use super::syntax::{Exchange, Record, Value};
use super::units::Unit;
use crate::math::{MOST_COORDINATE_M, Point3, Vector3, direction_of, first_outside};
use crate::part::{Axes, is_unit};
use std::cell::{Cell, RefCell};

/// Coordinates below this are 0, m.
const LEAST_M: f64 = 1e-100;

/// How often a byte of the file may be read on average, and how many bytes anyway. What solids share is read once for
/// each of them: files need two or three times.
const MOST_TIMES: usize = 16;
const ALWAYS_BYTES: usize = 1 << 20;

/// A file that is read so often at most.
pub(super) struct File<'a, 'b> {
    pub exchange: &'b Exchange<'a>,
    /// Bytes that may still be read.
    left: Cell<usize>,
    notes: RefCell<Vec<String>>,
}

/// An instance with its values.
pub(super) struct Entity<'a> {
    pub id: u64,
    records: Vec<Record<'a>>,
}

impl<'a, 'b> File<'a, 'b> {
    pub fn new(exchange: &'b Exchange<'a>) -> Self {
        let most = exchange.size().saturating_mul(MOST_TIMES);
        Self {
            exchange,
            left: Cell::new(most.saturating_add(ALWAYS_BYTES)),
            notes: RefCell::default(),
        }
    }

    /// Says once what was taken otherwise than the file says.
    pub fn note(&self, text: String) {
        let mut notes = self.notes.borrow_mut();
        if !notes.contains(&text) {
            notes.push(text);
        }
    }

    /// All that was noted.
    pub fn notes(&self) -> Vec<String> {
        self.notes.borrow().clone()
    }

    /// The instance that `from` refers to.
    pub fn entity(&self, id: u64, from: u64) -> Result<Entity<'a>, StepError> {
        let instance = self.exchange.find(id, from)?;
        let length = self.exchange.text(instance).len();
        let left = self.left.get().checked_sub(length);
        self.left.set(left.ok_or(StepError::TooOften { id })?);
        let records = self.exchange.records(instance)?;
        Ok(Entity { id, records })
    }

    /// The name of an instance's entity, without reading it; empty for complex instances and for none.
    pub fn name(&self, id: u64) -> &'a str {
        let instance = self.exchange.find(id, id);
        instance.map_or("", |instance| leading_name(self.exchange.text(instance)))
    }

    /// `CARTESIAN_POINT`, m.
    pub fn point(&self, id: u64, from: u64, unit: &Unit) -> Result<Point3, StepError> {
        let entity = self.entity(id, from)?;
        let [x, y, z] = entity.triple("CARTESIAN_POINT", "a point with three coordinates")?;
        // Squares of anything smaller are lost, and divisions by them give no number.
        let length_m = |x: f64| match unit.to_metres(x) {
            x_m if x_m.abs() < LEAST_M => 0.0,
            x_m => x_m,
        };
        let point = Point3::new(length_m(x), length_m(y), length_m(z));
        match first_outside(&[point]) {
            None => Ok(point),
            Some((_, value)) => Err(entity.value("a coordinate (m)", value, WITHIN)),
        }
    }

    /// `DIRECTION`, with length 1.
    pub fn direction(&self, id: u64, from: u64) -> Result<Vector3, StepError> {
        const WANTED: &str = "three numbers that are not all 0";
        let entity = self.entity(id, from)?;
        let [x, y, z] = entity.triple("DIRECTION", WANTED)?;
        let given = Vector3::new(x, y, z);
        // To the last bit, so that what is written reads back as it was.
        if is_unit(&given) {
            return Ok(given);
        }
        direction_of(&given).ok_or_else(|| StepError::Attribute {
            id,
            what: "DIRECTION".to_owned(),
            wanted: WANTED,
            found: format!("({x}, {y}, {z})"),
        })
    }

    /// `AXIS2_PLACEMENT_3D`: a point, the z axis, and about where x points.
    pub fn axes(&self, id: u64, from: u64, unit: &Unit) -> Result<Axes, StepError> {
        let entity = self.entity(id, from)?;
        if entity.kind() != "AXIS2_PLACEMENT_3D" {
            return Err(entity.other("an AXIS2_PLACEMENT_3D"));
        }
        let origin = self.point(entity.reference(1)?, id, unit)?;
        let direction = |k: usize, usual: Vector3| match entity.get(k) {
            Some(Value::Reference(to)) => self.direction(*to, id),
            _ => Ok(usual),
        };
        let z = direction(2, Vector3::z())?;
        let about = direction(3, Vector3::x())?;
        let axes = Axes::exactly(origin, &z, &about);
        axes.ok_or_else(|| entity.other("an AXIS2_PLACEMENT_3D with two directions"))
    }

    /// `VECTOR`, for its direction.
    pub fn vector(&self, id: u64, from: u64) -> Result<Vector3, StepError> {
        let entity = self.entity(id, from)?;
        if entity.kind() != "VECTOR" {
            return Err(entity.other("a VECTOR"));
        }
        let backwards = entity.number(2)? < 0.0;
        let direction = self.direction(entity.reference(1)?, id)?;
        Ok(if backwards { -direction } else { direction })
    }
}

const WITHIN: &str = "within ±1e12";

/// Up to the parenthesis.
pub(super) fn leading_name(text: &[u8]) -> &str {
    let end = text
        .iter()
        .position(|b| !(b.is_ascii_alphanumeric() || *b == b'_'));
    std::str::from_utf8(&text[..end.unwrap_or(text.len())]).unwrap_or_default()
}

impl<'a> Entity<'a> {
    /// The entity's name; that of the first part that has attributes of its own for a complex instance.
    pub fn kind(&self) -> &'a str {
        match self.records.as_slice() {
            [] => "",
            [one] => one.name,
            several => (several.iter())
                .find(|record| record.arguments.len() > 1)
                .map_or(several[0].name, |record| record.name),
        }
    }

    /// It is this, or has a part of this name.
    pub fn is(&self, name: &str) -> bool {
        self.records.iter().any(|record| record.name == name)
    }

    /// An entity's own attributes, without the names that all geometry has before them.
    pub fn own(&self, name: &str) -> Option<&[Value<'a>]> {
        let record = self.records.iter().find(|record| record.name == name)?;
        let first = usize::from(self.records.len() == 1);
        record.arguments.get(first..)
    }

    /// All attributes of a part of this name.
    pub fn part(&self, name: &str) -> Option<&[Value<'a>]> {
        let record = self.records.iter().find(|record| record.name == name)?;
        Some(&record.arguments)
    }

    /// Attributes of the part that has most of them.
    pub fn longest(&self) -> &[Value<'a>] {
        let longest = self.records.iter().max_by_key(|r| r.arguments.len());
        longest.map_or(&[], |record| &record.arguments)
    }

    /// An attribute of an instance that is not complex.
    pub fn get(&self, k: usize) -> Option<&Value<'a>> {
        match self.records.as_slice() {
            [record] => record.arguments.get(k),
            _ => None,
        }
    }

    pub fn reference(&self, k: usize) -> Result<u64, StepError> {
        match self.get(k) {
            Some(Value::Reference(to)) => Ok(*to),
            other => Err(self.wrong(k, "a reference such as #7", other)),
        }
    }

    pub fn number(&self, k: usize) -> Result<f64, StepError> {
        match self.get(k) {
            Some(Value::Number(number)) => Ok(*number),
            Some(Value::Typed(_, values)) if matches!(values.as_slice(), [Value::Number(_)]) => {
                match values[0] {
                    Value::Number(number) => Ok(number),
                    _ => Err(self.wrong(k, "a number", self.get(k))),
                }
            }
            other => Err(self.wrong(k, "a number", other)),
        }
    }

    /// A length above 0, m.
    pub fn length(&self, k: usize, what: &str, unit: &Unit) -> Result<f64, StepError> {
        let length = self.number(k)?;
        let metres = unit.to_metres(length);
        if metres > 0.0 && metres <= MOST_COORDINATE_M {
            Ok(metres)
        } else {
            Err(self.value(what, length, "a length above 0, up to 1e12 m"))
        }
    }

    pub fn flag(&self, k: usize) -> Result<bool, StepError> {
        match self.get(k) {
            Some(Value::Enumeration("T")) => Ok(true),
            Some(Value::Enumeration("F")) => Ok(false),
            other => Err(self.wrong(k, ".T. or .F.", other)),
        }
    }

    /// A list of references.
    pub fn references(&self, k: usize) -> Result<Vec<u64>, StepError> {
        let Some(Value::List(values)) = self.get(k) else {
            return Err(self.wrong(k, "a list of references", self.get(k)));
        };
        let each = values.iter().map(|value| match value {
            Value::Reference(to) => Ok(*to),
            other => Err(self.wrong(k, "a list of references", Some(other))),
        });
        each.collect()
    }

    /// The three numbers that are the last attribute of an entity.
    fn triple(&self, name: &str, wanted: &'static str) -> Result<[f64; 3], StepError> {
        let Some(last) = self.part(name).map(<[Value<'_>]>::last) else {
            return Err(self.other(wanted));
        };
        if let Some(Value::List(values)) = last
            && let [Value::Number(x), Value::Number(y), Value::Number(z)] = values.as_slice()
        {
            return Ok([*x, *y, *z]);
        }
        Err(StepError::Attribute {
            id: self.id,
            what: name.to_owned(),
            wanted,
            found: last.map_or_else(|| "nothing".to_owned(), Value::shown),
        })
    }

    /// An attribute that is something else.
    pub fn wrong(&self, k: usize, wanted: &'static str, found: Option<&Value<'_>>) -> StepError {
        StepError::Attribute {
            id: self.id,
            what: format!("attribute {} of {}", k + 1, self.kind()),
            wanted,
            found: found.map_or_else(|| "nothing".to_owned(), Value::shown),
        }
    }

    /// An instance that is something else.
    pub fn other(&self, wanted: &'static str) -> StepError {
        StepError::Attribute {
            id: self.id,
            what: "the instance".to_owned(),
            wanted,
            found: format!("a {}", self.kind()),
        }
    }

    /// An entity that cannot be taken over.
    pub fn unreadable(&self, why: &'static str) -> StepError {
        StepError::Unreadable {
            id: self.id,
            entity: self.kind().to_owned(),
            why,
        }
    }

    /// A number that cannot be.
    pub fn value(&self, what: &str, value: f64, wanted: &'static str) -> StepError {
        StepError::Value {
            id: self.id,
            what: format!("{what} of {}", self.kind()),
            value,
            wanted,
        }
    }
}
