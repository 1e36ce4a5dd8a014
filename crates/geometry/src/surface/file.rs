//! The surface file `palpate.surface.v1` (JSON): read to metres, write in metres or millimetres.
//!
//! ```json
//! {"format": "palpate.surface.v1", "degree": [3, 3], "periodic": [false, false], "knots": [[0, …], [0, …]],
//!  "points": [[[x, y, z], …], …], "weights": [[1, …], …], "unit": "m", "flip_normal": false,
//!  "trim": [[[u, v], …], …]}
//! ```
//! Rows in u, columns in v. `weights`, `unit` ("m" unless given), `flip_normal`, `trim` and `name` may be
//! left out. `trim` are closed polylines in the parameters; what is on their left is kept. Without `flip_normal` a closed surface is turned so that its normals point outwards,
//! an open one has them along S_u × S_v.

use super::{ControlNet, Loaded, Surface, SurfaceError, Trim, TrimError};
use crate::basis::{KnotError, KnotVector, MAX_DEGREE};
use crate::math::Point3;
use serde_json::Value;

/// The value of `format`.
pub const FORMAT: &str = "palpate.surface.v1";

const KEYS: [&str; 10] = [
    "format",
    "degree",
    "periodic",
    "knots",
    "points",
    "weights",
    "unit",
    "flip_normal",
    "trim",
    "name",
];

/// Unit of the points in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// Metres: the numbers of the surface, bit for bit.
    #[default]
    Metre,
    /// Millimetres: reading them back may differ in the last bit.
    Millimetre,
}

impl Unit {
    /// As files write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Millimetre => "mm",
        }
    }

    /// How many of it a metre is.
    pub fn per_metre(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Millimetre => 1000.0,
        }
    }
}

/// Why a surface file was refused.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Not JSON, or cut short.
    #[error("not a JSON document: {0}")]
    Json(#[from] serde_json::Error),
    /// Another format, or none.
    #[error("\"format\" is {found}, this reads \"{FORMAT}\"")]
    Format {
        /// What stands there.
        found: String,
    },
    /// A key that must be there.
    #[error("\"{0}\" is missing")]
    Missing(&'static str),
    /// A key that looks like a misspelt one.
    #[error("unknown key \"{key}\"; did you mean \"{suggestion}\"?")]
    Misspelt {
        /// The key.
        key: String,
        /// A key of the format.
        suggestion: &'static str,
    },
    /// A value of another kind.
    #[error("{path} should be {wanted}, but is {found}")]
    Type {
        /// Where, for example `points[2][3]`.
        path: String,
        /// What should stand there.
        wanted: &'static str,
        /// What kind of value does.
        found: String,
    },
    /// A row with another number of columns than the first.
    #[error("{path} has {given} values, {path_first} has {needed}: all rows need the same number")]
    Ragged {
        /// The row.
        path: String,
        /// The first row.
        path_first: String,
        /// Values of the row.
        given: usize,
        /// Values of the first.
        needed: usize,
    },
    /// Too few or too many knots for the net.
    #[error(
        "{given} knots in {direction}, but degree {degree} with {count} control points needs {needed}{}",
        if *.periodic { " (one period: count + 1)" } else { " (count + degree + 1)" }
    )]
    KnotCount {
        /// `u` or `v`.
        direction: char,
        /// Knots of the file.
        given: usize,
        /// Polynomial degree.
        degree: usize,
        /// Control points in this direction.
        count: usize,
        /// Knots needed.
        needed: usize,
        /// Whether the direction is periodic.
        periodic: bool,
    },
    /// Values that make no surface.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// Loops that trim nothing.
    #[error(transparent)]
    Trim(#[from] TrimError),
    /// A trim where whole surfaces are needed.
    #[error(
        "the surface is trimmed, and here it would be used whole; remove \"trim\" if that is meant"
    )]
    Trimmed,
}

/// All that a document says.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The surface, m.
    pub loaded: Loaded,
    /// What is kept of it; all, where there is none.
    pub trim: Option<Trim>,
    /// Of the numbers in the document.
    pub unit: Unit,
}

/// Reads a document.
///
/// # Errors
/// See [`FileError`]; each says what is wrong and where.
///
/// # Examples
/// ```
/// use palpate_geometry::surface::{builtin, file};
/// let torus = builtin("torus", None, None)?;
/// let text = file::write(&torus, file::Unit::Metre);
/// assert_eq!(file::read(&text)?.net(), torus.net());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(json: &str) -> Result<Surface, FileError> {
    from_value(&serde_json::from_str(json)?)
}

/// Reads a document and the unit that its numbers are in; the surface is in metres.
///
/// # Errors
/// See [`FileError`]; trimmed surfaces are refused.
pub fn read_with_unit(json: &str) -> Result<(Loaded, Unit), FileError> {
    let document = read_document(json)?;
    let unit = document.unit;
    Ok((document.whole()?, unit))
}

/// Reads a document with the trim that it may have.
///
/// # Errors
/// See [`FileError`].
///
/// # Examples
/// ```
/// use palpate_geometry::surface::file::read_document;
/// let triangle = r#"{"format": "palpate.surface.v1", "degree": [1, 1], "knots": [[0, 0, 1, 1], [0, 0, 1, 1]],
///     "points": [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]]], "trim": [[[0, 0], [1, 0], [0, 1]]]}"#;
/// assert_eq!(read_document(triangle)?.trim.unwrap().loops()[0].len(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_document(json: &str) -> Result<Document, FileError> {
    document_of(&serde_json::from_str(json)?)
}

impl Document {
    fn whole(self) -> Result<Loaded, FileError> {
        match self.trim {
            None => Ok(self.loaded),
            Some(_) => Err(FileError::Trimmed),
        }
    }
}

fn unit_of(document: &Value) -> Result<Unit, FileError> {
    match document.get("unit") {
        None => Ok(Unit::Metre),
        Some(Value::String(unit)) if unit == "m" => Ok(Unit::Metre),
        Some(Value::String(unit)) if unit == "mm" => Ok(Unit::Millimetre),
        Some(other) => Err(wrong("unit", "\"m\" or \"mm\"", other)),
    }
}

/// Reads a document that is parsed already, such as one inside a scene.
///
/// # Errors
/// See [`FileError`].
pub fn from_value(document: &Value) -> Result<Surface, FileError> {
    Ok(load(document)?.surface)
}

/// [`from_value`], with what [`Surface::loaded`] changed.
///
/// # Errors
/// See [`FileError`]; trimmed surfaces are refused.
pub fn load(document: &Value) -> Result<Loaded, FileError> {
    document_of(document)?.whole()
}

fn document_of(document: &Value) -> Result<Document, FileError> {
    let Value::Object(map) = document else {
        return Err(wrong("the document", "an object", document));
    };
    // The format is checked first: another format may have other keys.
    match map.get("format") {
        Some(Value::String(format)) if format == FORMAT => {}
        Some(other) => {
            return Err(FileError::Format {
                found: match other.as_str().filter(|text| text.starts_with("palpate.")) {
                    Some(ours) => format!("{:?}", ours.chars().take(40).collect::<String>()),
                    None => described(other),
                },
            });
        }
        None => return Err(FileError::Missing("format")),
    }
    for key in map.keys().filter(|key| !KEYS.contains(&key.as_str())) {
        // Strange keys are notes of other programs, unless they are nearly one of ours.
        if let Some(suggestion) = KEYS
            .iter()
            .find(|known| strsim::damerau_levenshtein(known, key) <= 2)
        {
            return Err(FileError::Misspelt {
                key: key.clone(),
                suggestion,
            });
        }
    }
    let get = |key: &'static str| map.get(key).ok_or(FileError::Missing(key));
    let unit = unit_of(document)?;
    let (rows, columns, points) = points(get("points")?, unit)?;
    let degrees = pair(get("degree")?, "degree", "two whole numbers above 0")?;
    let periodic = match map.get("periodic") {
        None => &[Value::Bool(false), Value::Bool(false)],
        Some(value) => pair(value, "periodic", "two of true or false")?,
    };
    let knots = pair(get("knots")?, "knots", "two lists of numbers")?;
    let knots = |k: usize| {
        let (direction, count) = [('u', rows), ('v', columns)][k];
        let degree = degrees[k].as_u64().and_then(|d| usize::try_from(d).ok());
        let degree = degree.ok_or_else(|| {
            wrong(
                &format!("degree[{k}]"),
                "a whole number above 0",
                &degrees[k],
            )
        })?;
        let periodic = periodic[k]
            .as_bool()
            .ok_or_else(|| wrong(&format!("periodic[{k}]"), "true or false", &periodic[k]))?;
        let path = format!("knots[{k}]");
        let values: Vec<f64> = list(&knots[k], &path, "a list of numbers")?
            .iter()
            .enumerate()
            .map(|(i, value)| number(value, || format!("{path}[{i}]")))
            .collect::<Result<_, _>>()?;
        let given = values.len();
        let needed = if periodic {
            count.saturating_add(1)
        } else {
            count.saturating_add(degree).saturating_add(1)
        };
        // Counts first: with a knot too many, what follows from the values is beside the point.
        let fits = (1..=MAX_DEGREE).contains(&degree);
        if fits && count <= degree {
            return Err(SurfaceError::Knots {
                direction,
                source: KnotError::TooFew { count, degree },
            }
            .into());
        }
        if fits && given != needed {
            return Err(FileError::KnotCount {
                direction,
                given,
                degree,
                count,
                needed,
                periodic,
            });
        }
        let made = if periodic {
            KnotVector::periodic(degree, values)
        } else {
            KnotVector::new(degree, values)
        };
        made.map_err(|source| FileError::from(SurfaceError::Knots { direction, source }))
    };
    let (knots_u, knots_v) = (knots(0)?, knots(1)?);
    let weights = map
        .get("weights")
        .filter(|w| !w.is_null())
        .map(|w| weights(w, rows, columns))
        .transpose()?;
    let net = ControlNet::new(rows, columns, points).map_err(SurfaceError::from)?;
    let loaded = Surface::new(knots_u, knots_v, net, weights)?.loaded()?;
    let surface = match map.get("flip_normal") {
        None => loaded.surface.oriented_outward(),
        Some(Value::Bool(flip)) => loaded.surface.with_flip_normal(*flip),
        Some(other) => return Err(wrong("flip_normal", "true or false", other)),
    };
    let loops = map.get("trim").filter(|trim| !trim.is_null());
    let loops = loops.map(loops_of).transpose()?;
    let trim = loops.map(|loops| Trim::new(&surface, loops)).transpose()?;
    let loaded = Loaded { surface, ..loaded };
    Ok(Document { loaded, trim, unit })
}

/// Places of each loop, as given.
fn loops_of(value: &Value) -> Result<Vec<Vec<[f64; 2]>>, FileError> {
    let place = |ring: usize, k: usize, place: &Value| {
        let path = || format!("trim[{ring}][{k}]");
        let uv = place.as_array().map(Vec::as_slice);
        let Some([u, v]) = uv else {
            return Err(wrong(&path(), "two numbers", place));
        };
        Ok([number(u, path)?, number(v, path)?])
    };
    let rings = list(value, "trim", "a list of loops")?.iter().enumerate();
    rings
        .map(|(ring, places)| {
            let places = list(places, &format!("trim[{ring}]"), "a list of places")?;
            (places.iter().enumerate())
                .map(|(k, at)| place(ring, k, at))
                .collect()
        })
        .collect()
}

/// The document of a surface; [`read`] gives the same surface back, in metres bit for bit, but for
/// what [`Surface::loaded`] sets right.
pub fn write(surface: &Surface, unit: Unit) -> String {
    let columns = surface.net().columns();
    let scale = unit.per_metre();
    let points: Vec<Vec<[f64; 3]>> = surface
        .net()
        .points()
        .chunks(columns)
        .map(|row| {
            row.iter()
                .map(|p| [p.x * scale, p.y * scale, p.z * scale])
                .collect()
        })
        .collect();
    let (u, v) = (surface.knots_u(), surface.knots_v());
    let mut document = serde_json::json!({
        "format": FORMAT,
        "degree": [u.degree(), v.degree()],
        "periodic": [u.is_periodic(), v.is_periodic()],
        "knots": [u.file_knots(), v.file_knots()],
        "points": points,
        "unit": unit.name(),
        "flip_normal": surface.flip_normal(),
    });
    if let Some(weights) = surface.weights() {
        document["weights"] = weights.chunks(columns).map(<[f64]>::to_vec).collect();
    }
    document.to_string()
}

fn points(value: &Value, unit: Unit) -> Result<(usize, usize, Vec<Point3>), FileError> {
    let rows = list(value, "points", "a list of rows")?;
    let mut points = Vec::new();
    let mut columns = 0;
    for (i, row) in rows.iter().enumerate() {
        let row = list(row, &format!("points[{i}]"), "a row of points")?;
        if i == 0 {
            columns = row.len();
        }
        same_length("points", i, row.len(), columns)?;
        for (j, point) in row.iter().enumerate() {
            let path = || format!("points[{i}][{j}]");
            let wanted = "three numbers";
            let Value::Array(xyz) = point else {
                return Err(wrong(&path(), wanted, point));
            };
            let [x, y, z] = xyz.as_slice() else {
                return Err(wrong(&path(), wanted, point));
            };
            let coordinate = |value| number(value, path).map(|x| x / unit.per_metre());
            points.push(Point3::new(coordinate(x)?, coordinate(y)?, coordinate(z)?));
        }
    }
    Ok((rows.len(), columns, points))
}

fn weights(value: &Value, rows: usize, columns: usize) -> Result<Vec<f64>, FileError> {
    let lines = list(value, "weights", "a list of rows")?;
    if lines.len() != rows {
        return Err(SurfaceError::WeightCount {
            given: lines.len() * columns,
            needed: rows * columns,
        }
        .into());
    }
    let mut weights = Vec::with_capacity(rows * columns);
    for (i, line) in lines.iter().enumerate() {
        let line = list(line, &format!("weights[{i}]"), "a row of numbers")?;
        if line.len() != columns {
            let (path, path_first) = (format!("weights[{i}]"), "points[0]".to_owned());
            return Err(FileError::Ragged {
                path,
                path_first,
                given: line.len(),
                needed: columns,
            });
        }
        for (j, weight) in line.iter().enumerate() {
            weights.push(number(weight, || format!("weights[{i}][{j}]"))?);
        }
    }
    Ok(weights)
}

fn same_length(list: &str, i: usize, given: usize, needed: usize) -> Result<(), FileError> {
    if given == needed {
        return Ok(());
    }
    Err(FileError::Ragged {
        path: format!("{list}[{i}]"),
        path_first: format!("{list}[0]"),
        given,
        needed,
    })
}

fn list<'a>(
    value: &'a Value,
    path: &str,
    wanted: &'static str,
) -> Result<&'a Vec<Value>, FileError> {
    value.as_array().ok_or_else(|| wrong(path, wanted, value))
}

fn pair<'a>(
    value: &'a Value,
    path: &str,
    wanted: &'static str,
) -> Result<&'a [Value; 2], FileError> {
    let pair = value
        .as_array()
        .and_then(|values| values.as_slice().try_into().ok());
    pair.ok_or_else(|| wrong(path, wanted, value))
}

fn number(value: &Value, path: impl Fn() -> String) -> Result<f64, FileError> {
    value
        .as_f64()
        .ok_or_else(|| wrong(&path(), "a number", value))
}

fn wrong(path: &str, wanted: &'static str, found: &Value) -> FileError {
    FileError::Type {
        path: path.to_owned(),
        wanted,
        found: described(found),
    }
}

/// What kind of value it is. It is not repeated: a scene of somebody else can name any file, and the
/// message goes where that one can read it.
fn described(value: &Value) -> String {
    match value {
        Value::Null => "null".into(),
        Value::Bool(is) => is.to_string(),
        Value::Number(_) => "a number".into(),
        Value::String(_) => "a text".into(),
        Value::Array(values) => format!("a list of {}", values.len()),
        Value::Object(_) => "an object".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::fifty_surfaces;
    use super::*;

    #[test]
    fn a_written_surface_is_read_back_bit_for_bit() {
        for (k, surface) in fifty_surfaces(51).into_iter().enumerate() {
            let surface = surface.with_flip_normal(k % 3 == 0);
            let again = read(&write(&surface, Unit::Metre)).unwrap();
            assert_eq!(again, surface);
            let bits = |s: &Surface| -> Vec<u64> {
                s.net()
                    .points()
                    .iter()
                    .flat_map(|p| p.iter().map(|x| x.to_bits()).collect::<Vec<_>>())
                    .collect()
            };
            assert_eq!(bits(&again), bits(&surface), "signs of zero too");
            let millimetres = read(&write(&surface, Unit::Millimetre)).unwrap();
            for (a, b) in millimetres
                .net()
                .points()
                .iter()
                .zip(surface.net().points())
            {
                assert!((a - b).norm() <= 4e-16 * b.coords.norm(), "{a} is not {b}");
            }
        }
    }

    fn sheet() -> Value {
        serde_json::json!({
            "format": FORMAT, "degree": [1, 1], "periodic": [false, false],
            "knots": [[0, 0, 1, 1], [0, 0, 1, 1]], "unit": "mm", "made_by": "hand",
            "points": [[[0, 0, 0], [0, 1000, 0]], [[1000, 0, 0], [1000, 1000, 5]]],
        })
    }

    #[test]
    fn millimetres_become_metres_and_notes_of_others_are_passed_over() {
        let surface = from_value(&sheet()).unwrap();
        assert_eq!(surface.net().at(1, 1), &Point3::new(1.0, 1.0, 0.005));
    }

    #[test]
    fn broken_documents_are_refused_with_what_and_where() {
        type Change = dyn Fn(&mut Value);
        let message = |change: &Change| {
            let mut document = sheet();
            change(&mut document);
            from_value(&document).unwrap_err().to_string()
        };
        let cases: [(&Change, &str); 22] = [
            (
                &|d| d["format"] = "palpate.surface.v2".into(),
                "\"format\" is \"palpate.surface.v2\", this reads \"palpate.surface.v1\"",
            ),
            (
                &|d| d["format"] = Value::Null,
                "\"format\" is null, this reads \"palpate.surface.v1\"",
            ),
            (
                &|d| drop(d.as_object_mut().unwrap().remove("knots")),
                "\"knots\" is missing",
            ),
            (
                &|d| d["weight"] = 1.into(),
                "unknown key \"weight\"; did you mean \"weights\"?",
            ),
            (
                &|d| d["unit"] = "cm".into(),
                "unit should be \"m\" or \"mm\", but is a text",
            ),
            (
                &|d| d["degree"] = 1.into(),
                "degree should be two whole numbers above 0, but is a number",
            ),
            (
                &|d| d["degree"][1] = 1.5.into(),
                "degree[1] should be a whole number above 0, but is a number",
            ),
            (
                &|d| d["degree"][0] = 0.into(),
                "knots in u: degree 0 is outside 1..=15",
            ),
            (
                &|d| d["periodic"][0] = "no".into(),
                "periodic[0] should be true or false, but is a text",
            ),
            (
                &|d| d["knots"][1][2] = Value::Null,
                "knots[1][2] should be a number, but is null",
            ),
            (
                &|d| d["knots"][0][3] = 0.5.into(),
                "knots in u: knot 3 (0.5) is smaller than the one before it (1)",
            ),
            (
                &|d| d["knots"][0] = serde_json::json!([0, 0, 0.5, 1, 1]),
                "5 knots in u, but degree 1 with 2 control points needs 4 (count + degree + 1)",
            ),
            (
                &|d| d["periodic"][1] = true.into(),
                "4 knots in v, but degree 1 with 2 control points needs 3 (one period: count + 1)",
            ),
            (
                &|d| d["points"][1][0] = serde_json::json!([1, 2]),
                "points[1][0] should be three numbers, but is a list of 2",
            ),
            (
                &|d| d["points"][0][1][2] = "x".into(),
                "points[0][1] should be a number, but is a text",
            ),
            (
                &|d| d["points"][1] = serde_json::json!([[0, 0, 0]]),
                "points[1] has 1 values, points[0] has 2: all rows need the same number",
            ),
            (
                &|d| d["weights"] = serde_json::json!([[1, 1], [1, -2]]),
                "weight (1, 1) is -2; weights are from 1e-9 to 1e9",
            ),
            (
                &|d| d["weights"] = serde_json::json!([[1, 1]]),
                "2 weights for 4 control points",
            ),
            (
                &|d| d["trim"] = 1.into(),
                "trim should be a list of loops, but is a number",
            ),
            (
                &|d| d["trim"] = serde_json::json!([[[0, 0], [1, 0], [0]]]),
                "trim[0][2] should be two numbers, but is a list of 1",
            ),
            (
                &|d| d["trim"] = serde_json::json!([[[0, 0], [1, 0], [0, 2]]]),
                "place 2 of loop 0 of trim, (0, 2), is outside of the domain: u from 0 to 1, v from 0 to 1",
            ),
            (
                &|d| d["trim"] = serde_json::json!([[[0, 0], [1, 0], [0, 1]]]),
                "the surface is trimmed, and here it would be used whole; remove \"trim\" if that is meant",
            ),
        ];
        for (change, wanted) in cases {
            assert_eq!(message(change), wanted);
        }
    }

    #[test]
    fn documents_cut_short_or_of_other_kinds_are_refused() {
        let whole = sheet().to_string();
        for end in 0..whole.len() {
            assert!(
                matches!(read(&whole[..end]), Err(FileError::Json(_))),
                "cut at {end}"
            );
        }
        assert!(matches!(read("[]"), Err(FileError::Type { .. })));
        assert!(matches!(read("{}"), Err(FileError::Missing("format"))));
        assert!(
            read(&whole.replace("1000", "1e999")).is_err(),
            "no infinite coordinates"
        );
        let empty = serde_json::json!({"format": FORMAT, "degree": [1, 1], "knots": [[], []], "points": []});
        assert!(from_value(&empty).is_err());
    }
}
