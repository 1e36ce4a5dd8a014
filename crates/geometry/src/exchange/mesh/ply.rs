//! PLY (Stanford polygons), as scanners write it: text, or binary of either byte order.
//!
//! Of the vertices x, y and z are read, of the faces their corners; every other property and element
//! is passed over. A file without faces is a cloud of points.

use super::stl::welded;
use super::{MeshFileError, checked, line_end, plain, polygon, words};
use crate::exchange::number;
use crate::math::Point3;
use crate::surface::Mesh;
use crate::surface::file::Unit;

/// Corners of one face at most; more is a damaged file.
const MOST_CORNERS: usize = 1 << 16;

#[derive(Clone, Copy, PartialEq)]
enum Form {
    Text,
    Little,
    Big,
}

#[derive(Clone, Copy)]
enum Scalar {
    Int(usize),
    Unsigned(usize),
    Float(usize),
}

impl Scalar {
    fn of(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::Int(1),
            b"uchar" | b"uint8" => Self::Unsigned(1),
            b"short" | b"int16" => Self::Int(2),
            b"ushort" | b"uint16" => Self::Unsigned(2),
            b"int" | b"int32" => Self::Int(4),
            b"uint" | b"uint32" => Self::Unsigned(4),
            b"float" | b"float32" => Self::Float(4),
            b"double" | b"float64" => Self::Float(8),
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::Int(size) | Self::Unsigned(size) | Self::Float(size) => size,
        }
    }

    /// The value of so many bytes, least significant first.
    fn value(self, bytes: [u8; 8]) -> f64 {
        let bits = u64::from_le_bytes(bytes);
        match self {
            Self::Int(1) => f64::from(bits as i8),
            Self::Int(2) => f64::from(bits as i16),
            Self::Int(_) => f64::from(bits as i32),
            Self::Unsigned(_) => bits as f64,
            Self::Float(4) => f64::from(f32::from_bits(bits as u32)),
            Self::Float(_) => f64::from_bits(bits),
        }
    }
}

struct Property {
    name: Vec<u8>,
    /// Of lists, the type of their length.
    length: Option<Scalar>,
    scalar: Scalar,
}

struct Element {
    name: Vec<u8>,
    count: usize,
    properties: Vec<Property>,
}

/// What stands after the header, a number at a time.
struct Values<'a> {
    form: Form,
    rest: &'a [u8],
}

fn short() -> MeshFileError {
    MeshFileError::Cut("PLY")
}

fn header_error(line: usize, wanted: &'static str, text: &[u8]) -> MeshFileError {
    super::wrong_line(line, wanted, text)
}

impl Values<'_> {
    fn next(&mut self, scalar: Scalar) -> Result<f64, MeshFileError> {
        if self.form == Form::Text {
            self.rest = self.rest.trim_ascii_start();
            let end = self.rest.iter().position(u8::is_ascii_whitespace);
            let (word, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
            self.rest = rest;
            if word.is_empty() {
                return Err(short());
            }
            return number::parse(word).ok_or_else(|| MeshFileError::Value {
                format: "PLY",
                wanted: "a number",
                found: "a word".into(),
            });
        }
        let (head, rest) = self
            .rest
            .split_at_checked(scalar.size())
            .ok_or_else(short)?;
        self.rest = rest;
        let mut bytes = [0; 8];
        for (k, byte) in head.iter().enumerate() {
            let at = if self.form == Form::Little {
                k
            } else {
                head.len() - 1 - k
            };
            bytes[at] = *byte;
        }
        Ok(scalar.value(bytes))
    }

    /// A list's items; its length is bounded before anything is kept.
    fn list(&mut self, length: Scalar, scalar: Scalar) -> Result<Vec<f64>, MeshFileError> {
        let count = self.next(length)?;
        if !(count >= 0.0 && count.fract() == 0.0 && count <= MOST_CORNERS as f64) {
            return Err(MeshFileError::Value {
                format: "PLY",
                wanted: "a number of corners",
                found: count.to_string(),
            });
        }
        (0..count as usize).map(|_| self.next(scalar)).collect()
    }
}

/// The points and triangles of a file; coordinates are in `unit`. Faces with more than three corners
/// become the triangles that cover them. A file without faces gives no triangles.
///
/// # Errors
/// A file cut short, with a header that is not PLY's, or with faces that name corners it does not
/// have, or whose edges cross.
fn contents(bytes: &[u8], unit: Unit) -> Result<(Vec<Point3>, Vec<[u32; 3]>), MeshFileError> {
    let (form, elements, rest) = header(bytes)?;
    let mut values = Values { form, rest };
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let mut faces = 0;
    for element in &elements {
        let place = |name: &[u8]| element.properties.iter().position(|p| p.name == name);
        let axes = [place(b"x"), place(b"y"), place(b"z")];
        let corners = element
            .properties
            .iter()
            .position(|p| p.length.is_some() && p.name.starts_with(b"vertex_ind"));
        let is_vertex = element.name == b"vertex";
        if is_vertex && axes.contains(&None) {
            return Err(MeshFileError::Value {
                format: "PLY",
                wanted: "the properties x, y and z of its vertices",
                found: "without".into(),
            });
        }
        for _ in 0..element.count {
            let mut row = [0.0; 3];
            for (k, property) in element.properties.iter().enumerate() {
                match property.length {
                    None => {
                        let value = values.next(property.scalar)?;
                        if let Some(axis) = axes.iter().position(|place| *place == Some(k)) {
                            row[axis] = value / unit.per_metre();
                        }
                    }
                    Some(length) => {
                        let list = values.list(length, property.scalar)?;
                        if element.name == b"face" && Some(k) == corners {
                            faces += 1;
                            triangles.extend(face(&list, faces, &points)?);
                        }
                    }
                }
            }
            if is_vertex {
                points.push(Point3::from(row));
            }
        }
    }
    checked(&points)?;
    Ok((points, triangles))
}

/// The triangles of the face with that number, from 1, of these corners.
fn face(list: &[f64], face: usize, points: &[Point3]) -> Result<Vec<[u32; 3]>, MeshFileError> {
    let index = |&corner: &f64| {
        if corner >= 0.0 && corner.fract() == 0.0 && corner < points.len() as f64 {
            return Ok(corner as u32);
        }
        Err(MeshFileError::Corner {
            triangle: face - 1,
            corner: corner as u32,
            count: points.len(),
        })
    };
    let corners: Vec<u32> = list.iter().map(index).collect::<Result<_, _>>()?;
    polygon::triangles(points, &corners).map_err(|flaw| MeshFileError::Polygon {
        face,
        line: None,
        corners: corners.len(),
        flaw,
    })
}

/// Form, elements, and what follows the header.
fn header(bytes: &[u8]) -> Result<(Form, Vec<Element>, &[u8]), MeshFileError> {
    let (mut form, mut elements) = (None, Vec::<Element>::new());
    let mut rest = plain(bytes)?;
    let line_end = line_end(rest);
    for number in 1.. {
        let end = rest.iter().position(|&b| b == line_end).ok_or_else(short)?;
        let line = rest[..end].trim_ascii();
        rest = &rest[end + 1..];
        let words: Vec<&[u8]> = words(line).collect();
        match words.as_slice() {
            [b"ply"] if number == 1 => {}
            _ if number == 1 => return Err(header_error(1, "ply", line)),
            [b"format", name, _] => {
                form = Some(match *name {
                    b"ascii" => Form::Text,
                    b"binary_little_endian" => Form::Little,
                    b"binary_big_endian" => Form::Big,
                    _ => return Err(header_error(number, "a format of PLY", line)),
                });
            }
            [b"element", name, count] => {
                let count = std::str::from_utf8(count).ok().and_then(|c| c.parse().ok());
                let count = count.ok_or_else(|| header_error(number, "a count", line))?;
                elements.push(Element {
                    name: name.to_vec(),
                    count,
                    properties: Vec::new(),
                });
            }
            [b"property", kind @ .., name] => {
                let (length, scalar) = match kind {
                    [b"list", length, scalar] => (Scalar::of(length), Scalar::of(scalar)),
                    [scalar] => (None, Scalar::of(scalar)),
                    _ => (None, None),
                };
                let wanted = "property, a type of PLY and a name";
                let scalar = scalar.ok_or_else(|| header_error(number, wanted, line))?;
                let element = elements.last_mut();
                let element = element.ok_or_else(|| header_error(number, "element first", line))?;
                if kind.len() == 3 && length.is_none() {
                    return Err(header_error(number, wanted, line));
                }
                element.properties.push(Property {
                    name: name.to_vec(),
                    length,
                    scalar,
                });
            }
            [b"end_header"] => {
                let form = form.ok_or_else(|| header_error(number, "format before it", line))?;
                // Rows without a value would take no bytes, and any count of them no time to check.
                let empty = elements
                    .iter()
                    .any(|e| e.properties.is_empty() && e.count > 0);
                if empty {
                    return Err(header_error(number, "properties of each element", line));
                }
                return Ok((form, elements, rest));
            }
            [b"comment" | b"obj_info", ..] | [] => {}
            _ => return Err(header_error(number, "a line of a PLY header", line)),
        }
    }
    Err(short())
}

/// The triangles of a file; coordinates are in `unit`. Corners at the same place become one: scanners double those
/// at the seams of their pictures.
///
/// # Errors
/// As [`read_points`], or a file without faces.
pub fn read(bytes: &[u8], unit: Unit) -> Result<Mesh, MeshFileError> {
    let (points, triangles) = contents(bytes, unit)?;
    if triangles.is_empty() {
        return Err(MeshFileError::Empty("faces"));
    }
    let corners = triangles.iter().flatten().map(|&k| points[k as usize]);
    welded(corners.collect())
}

/// The vertices of a file, in its order; coordinates are in `unit`.
///
/// # Errors
/// A file cut short, with a header that is not PLY's, or without vertices.
pub fn read_points(bytes: &[u8], unit: Unit) -> Result<Vec<Point3>, MeshFileError> {
    let (points, _) = contents(bytes, unit)?;
    if points.is_empty() {
        return Err(MeshFileError::Empty("vertices"));
    }
    Ok(points)
}
