//! The surfaces of a STEP file: which instances they are, and their values. ISO 10303-42, §4.4.

use super::StepError;
use super::syntax::{Exchange, Instance, Record, Value};
use super::units::Unit;
use crate::basis::MAX_DEGREE;
use crate::exchange::spline::{FileSurface, Runs, SplineError};
use crate::math::Point3;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Entities whose knots we know.
const FORMS: [&str; 4] = [
    "B_SPLINE_SURFACE_WITH_KNOTS",
    "BEZIER_SURFACE",
    "QUASI_UNIFORM_SURFACE",
    "UNIFORM_SURFACE",
];

/// Surfaces that are none of ours, for the message.
const OTHERS: [&str; 8] = [
    "PLANE",
    "CYLINDRICAL_SURFACE",
    "CONICAL_SURFACE",
    "SPHERICAL_SURFACE",
    "TOROIDAL_SURFACE",
    "SURFACE_OF_REVOLUTION",
    "SURFACE_OF_LINEAR_EXTRUSION",
    "TRIANGULATED_FACE",
];

/// Instance numbers of all B-spline surfaces.
pub(super) fn find(exchange: &Exchange<'_>) -> Result<Vec<u64>, StepError> {
    let is_surface = |instance: &&Instance| -> bool {
        // Most instances are points: the text tells without parsing it.
        let text = exchange.text(instance);
        let may_be = text.first() == Some(&b'(')
            || FORMS.iter().any(|form| text.starts_with(form.as_bytes()));
        may_be
            && contains(text, b"_SURFACE")
            && exchange
                .records(instance)
                .is_ok_and(|records| form(&records).is_some())
    };
    let ids: Vec<u64> = exchange
        .instances()
        .iter()
        .filter(is_surface)
        .map(|instance| instance.id)
        .collect();
    if ids.is_empty() {
        let is_there = |name: &&&str| {
            exchange
                .instances()
                .iter()
                .any(|instance| exchange.text(instance).starts_with(name.as_bytes()))
        };
        let others = OTHERS.iter().filter(is_there).copied().collect();
        return Err(StepError::NoSurface {
            instances: exchange.instances().len(),
            others,
        });
    }
    Ok(ids)
}

pub(super) fn contains(text: &[u8], word: &[u8]) -> bool {
    text.windows(word.len()).any(|window| window == word)
}

fn form<'a>(records: &'a [Record<'_>]) -> Option<&'a str> {
    records
        .iter()
        .map(|record| record.name)
        .find(|name| FORMS.contains(name))
}

/// The `same_sense` of the first face on the surface.
pub(super) fn face_sense(exchange: &Exchange<'_>, surface: u64) -> Option<bool> {
    let faces = exchange.instances().iter().filter(|instance| {
        let text = exchange.text(instance);
        text.starts_with(b"ADVANCED_FACE") || text.starts_with(b"FACE_SURFACE")
    });
    for face in faces {
        let Ok(records) = exchange.records(face) else {
            continue;
        };
        if let [.., Value::Reference(on), Value::Enumeration(sense)] =
            records[0].arguments.as_slice()
            && *on == surface
        {
            return Some(*sense != "F");
        }
    }
    None
}

/// Attributes in the order of the standard, of a plain or a complex instance.
struct Attributes<'a> {
    id: u64,
    /// degree u, degree v, points, form, closed u, closed v, self-intersecting.
    common: Vec<Value<'a>>,
    /// Multiplicities u, multiplicities v, knots u, knots v, kind of knots.
    knots: Option<Vec<Value<'a>>>,
    form: &'a str,
    weights: Option<Value<'a>>,
}

impl<'a> Attributes<'a> {
    fn of(exchange: &Exchange<'a>, id: u64) -> Result<Self, StepError> {
        let records = exchange.records(exchange.find(id, id)?)?;
        let name = records
            .iter()
            .map(|record| record.name)
            .find(|name| FORMS.contains(name))
            .unwrap_or(FORMS[0]);
        let with_knots = name == FORMS[0];
        let missing = |what: &str| StepError::Attribute {
            id,
            what: what.to_owned(),
            wanted: "there with all its attributes",
            found: "incomplete".to_owned(),
        };
        if let [record] = records.as_slice() {
            // name, then the common ones, then those of the knots.
            let needed = if with_knots { 13 } else { 8 };
            if record.arguments.len() < needed {
                return Err(missing(name));
            }
            let common = record.arguments[1..8].to_vec();
            let knots = with_knots.then(|| record.arguments[8..].to_vec());
            return Ok(Self {
                id,
                common,
                knots,
                form: name,
                weights: None,
            });
        }
        let part = |name: &str, needed: usize| {
            let record = records.iter().find(|record| record.name == name);
            record
                .map(|record| record.arguments.as_slice())
                .filter(|a| a.len() >= needed)
                .ok_or_else(|| missing(name))
        };
        let common = part("B_SPLINE_SURFACE", 7)?.to_vec();
        let knots = if with_knots {
            Some(part(FORMS[0], 4)?.to_vec())
        } else {
            None
        };
        let rational = records.iter().any(|record| record.name == RATIONAL);
        let weights = if rational {
            Some(part(RATIONAL, 1)?[0].clone())
        } else {
            None
        };
        Ok(Self {
            id,
            common,
            knots,
            form: name,
            weights,
        })
    }

    fn wrong(&self, what: &str, wanted: &'static str, found: &Value<'_>) -> StepError {
        StepError::Attribute {
            id: self.id,
            what: what.to_owned(),
            wanted,
            found: found.shown(),
        }
    }

    fn whole(&self, value: &Value<'_>, what: &str) -> Result<u64, StepError> {
        match value {
            Value::Number(number) if *number >= 0.0 && number.fract() == 0.0 && *number < 1e15 => {
                Ok(*number as u64)
            }
            other => Err(self.wrong(what, "a whole number", other)),
        }
    }

    fn list<'b>(&self, value: &'b Value<'a>, what: &str) -> Result<&'b [Value<'a>], StepError> {
        match value {
            Value::List(values) => Ok(values),
            other => Err(self.wrong(what, "a list", other)),
        }
    }

    /// A list of rows of one length: their number, that length, all values in order.
    fn grid<'b>(
        &self,
        value: &'b Value<'a>,
        what: &str,
    ) -> Result<(usize, usize, Vec<&'b Value<'a>>), StepError> {
        let rows = self.list(value, what)?;
        let mut all = Vec::new();
        let mut columns = 0;
        for (i, row) in rows.iter().enumerate() {
            let cells = self.list(row, what)?;
            if i == 0 {
                columns = cells.len();
            } else if cells.len() != columns {
                return Err(self.wrong(
                    &format!("row {i} of {what}"),
                    "as long as the first row",
                    row,
                ));
            }
            all.extend(cells);
        }
        Ok((rows.len(), columns, all))
    }
}

const RATIONAL: &str = "RATIONAL_B_SPLINE_SURFACE";

/// Reads the surface of instance `id`, its points in metres.
pub(super) fn read(
    exchange: &Exchange<'_>,
    id: u64,
    unit: &Unit,
) -> Result<FileSurface, StepError> {
    let attributes = Attributes::of(exchange, id)?;
    let common = &attributes.common;
    let degree = |k: usize, what: &str| {
        // What is too large for a usize on any machine is too large anyhow.
        attributes
            .whole(&common[k], what)
            .map(|degree| usize::try_from(degree).unwrap_or(usize::MAX))
    };
    let degrees = [degree(0, "u_degree")?, degree(1, "v_degree")?];
    let (rows, columns, cells) = attributes.grid(&common[2], "control_points_list")?;
    let mut points = Vec::with_capacity(cells.len());
    // Rows of seams and poles refer to the same points again.
    let mut known: BTreeMap<u64, Point3> = BTreeMap::new();
    for cell in cells {
        let Value::Reference(point) = cell else {
            return Err(attributes.wrong(
                "control_points_list",
                "references to CARTESIAN_POINTs",
                cell,
            ));
        };
        points.push(match known.entry(*point) {
            Entry::Occupied(point) => *point.get(),
            Entry::Vacant(place) => *place.insert(cartesian_point(exchange, *point, id, unit)?),
        });
    }
    let weights = attributes.weights.as_ref().map(|weights| {
        let (_, _, cells) = attributes.grid(weights, "weights_data")?;
        cells
            .into_iter()
            .map(|cell| number(&attributes, cell, "weights_data"))
            .collect::<Result<Vec<f64>, _>>()
    });
    let knots = match &attributes.knots {
        Some(knots) => {
            let u = runs(&attributes, 'u', &knots[0], &knots[2])?;
            let v = runs(&attributes, 'v', &knots[1], &knots[3])?;
            [u, v]
        }
        None => [
            implied(attributes.form, degrees[0], rows),
            implied(attributes.form, degrees[1], columns),
        ],
    };
    Ok(FileSurface {
        degrees,
        knots,
        rows,
        columns,
        points,
        weights: weights.transpose()?,
    })
}

fn number(attributes: &Attributes<'_>, value: &Value<'_>, what: &str) -> Result<f64, StepError> {
    match value {
        Value::Number(number) => Ok(*number),
        other => Err(attributes.wrong(what, "numbers", other)),
    }
}

fn runs(
    attributes: &Attributes<'_>,
    direction: char,
    multiplicities: &Value<'_>,
    knots: &Value<'_>,
) -> Result<Runs, StepError> {
    let (what_times, what) = (
        format!("{direction}_multiplicities"),
        format!("{direction}_knots"),
    );
    let times = attributes.list(multiplicities, &what_times)?;
    let values = attributes.list(knots, &what)?;
    if times.len() != values.len() {
        let (knots, multiplicities) = (values.len(), times.len());
        let source = SplineError::Multiplicities {
            direction,
            knots,
            multiplicities,
        };
        return Err(StepError::Spline {
            id: attributes.id,
            source,
        });
    }
    let pairs = values.iter().zip(times);
    pairs
        .map(|(knot, times)| {
            Ok((
                number(attributes, knot, &what)?,
                attributes.whole(times, &what_times)?,
            ))
        })
        .collect()
}

/// The knots that the forms without any imply, of surfaces and of curves; ISO 10303-42, §4.4.40 ff.
pub(super) fn implied(form: &str, degree: usize, count: usize) -> Runs {
    if degree == 0 || degree > MAX_DEGREE || count <= degree {
        // Refused for its degree or its net, whatever the knots.
        return Vec::new();
    }
    let ends = degree as u64 + 1;
    let spans = if form.starts_with("BEZIER") {
        1
    } else {
        count - degree
    };
    if form.starts_with("UNIFORM") {
        return (0..count + degree + 1)
            .map(|k| (k as f64 - degree as f64, 1))
            .collect();
    }
    (0..=spans)
        .map(|k| (k as f64, if k == 0 || k == spans { ends } else { 1 }))
        .collect()
}

pub(super) fn cartesian_point(
    exchange: &Exchange<'_>,
    id: u64,
    from: u64,
    unit: &Unit,
) -> Result<Point3, StepError> {
    let records = exchange.records(exchange.find(id, from)?)?;
    let point = records
        .iter()
        .find(|record| record.name == "CARTESIAN_POINT");
    let coordinates = point.and_then(|record| record.arguments.last());
    if let Some(Value::List(values)) = coordinates
        && let [Value::Number(x), Value::Number(y), Value::Number(z)] = values.as_slice()
    {
        return Ok(Point3::new(
            unit.to_metres(*x),
            unit.to_metres(*y),
            unit.to_metres(*z),
        ));
    }
    let found = match (point, records.first()) {
        (Some(_), _) => coordinates.map_or_else(|| "nothing".to_owned(), Value::shown),
        (None, first) => first.map_or_else(
            || "nothing".to_owned(),
            |record| format!("a {}", record.name),
        ),
    };
    let what = "CARTESIAN_POINT".to_owned();
    Err(StepError::Attribute {
        id,
        what,
        wanted: "a point with three coordinates",
        found,
    })
}
