//! STL: triangles with their normals, binary (single precision) or text.

use super::{MeshFileError, check, checked, lines, plain, point, words, wrong_line};
use crate::math::{Point3, Vector3};
use crate::surface::Mesh;
use crate::surface::file::Unit;
use std::fmt::Write as _;

/// Title, count.
const HEAD: usize = 84;
/// Normal, three corners, two bytes of nothing.
const TRIANGLE: usize = 50;

/// A binary file; coordinates in single precision.
///
/// # Errors
/// A mesh that is empty, or whose parts do not fit each other or the format.
pub fn write(mesh: &Mesh, unit: Unit) -> Result<Vec<u8>, MeshFileError> {
    check(mesh)?;
    let mut out = Vec::with_capacity(HEAD + TRIANGLE * mesh.triangles.len());
    // Not "solid", by which readers know the text form.
    let title = format!(
        "binary STL, {}, palpate {}",
        unit.name(),
        env!("CARGO_PKG_VERSION")
    );
    out.extend_from_slice(title.as_bytes());
    out.resize(HEAD - 4, b' ');
    out.extend_from_slice(&(mesh.triangles.len() as u32).to_le_bytes());
    for triangle in &mesh.triangles {
        let corners = corners(mesh, triangle, unit);
        let vectors = [
            normal(&corners),
            corners[0].coords,
            corners[1].coords,
            corners[2].coords,
        ];
        out.extend(vectors.iter().flat_map(|v| {
            v.iter()
                .flat_map(|x| (*x as f32).to_le_bytes())
                .collect::<Vec<_>>()
        }));
        out.extend_from_slice(&[0, 0]);
    }
    Ok(out)
}

/// A text file; coordinates in full precision.
///
/// # Errors
/// As the binary form.
pub fn write_ascii(mesh: &Mesh, unit: Unit) -> Result<String, MeshFileError> {
    check(mesh)?;
    let mut out = String::from("solid surface\n");
    for triangle in &mesh.triangles {
        let corners = corners(mesh, triangle, unit);
        let n = normal(&corners);
        let _ = writeln!(
            out,
            "facet normal {:?} {:?} {:?}\n outer loop",
            n.x, n.y, n.z
        );
        for corner in corners {
            let _ = writeln!(out, "  vertex {:?} {:?} {:?}", corner.x, corner.y, corner.z);
        }
        out.push_str(" endloop\nendfacet\n");
    }
    out.push_str("endsolid surface\n");
    Ok(out)
}

/// Reads either form; coordinates are in `unit`. Corners at the same place, bit for bit, become
/// one; normals are those of the triangles' turning, whatever the file has. Text may be in capitals, hold several solids, or begin
/// with a byte-order mark; binary triangles may be followed by zeros, or by less than another triangle.
///
/// # Errors
/// A file cut short, or coordinates that are not finite.
pub fn read(bytes: &[u8], unit: Unit) -> Result<Mesh, MeshFileError> {
    let corners = match (binary(bytes), as_text(bytes)?) {
        (Ok(triangles), _) => triangles
            .chunks_exact(TRIANGLE)
            .flat_map(|t| corners_of(t, unit))
            .collect(),
        (_, Some(body)) => text(body, unit)?,
        (Err(error), None) => return Err(error),
    };
    welded(corners)
}

/// The text of a file that is one, without its mark and what fills it up. Either form may begin with "solid", and text with
/// something else: what tells is that a text has no other bytes than those of text.
fn as_text(bytes: &[u8]) -> Result<Option<&[u8]>, MeshFileError> {
    let is_filling = |byte: &u8| matches!(byte, 0 | 0x1a);
    let end = bytes.iter().rposition(|byte| !is_filling(byte));
    let body = plain(&bytes[..end.map_or(0, |at| at + 1)])?.trim_ascii_start();
    let begins = body
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    let is_control = |byte: &u8| byte.is_ascii_control() && !byte.is_ascii_whitespace();
    let is_text = (begins || bytes.len() >= HEAD) && !body.iter().any(is_control);
    Ok(is_text.then_some(body))
}

fn corners(mesh: &Mesh, triangle: &[u32; 3], unit: Unit) -> [Point3; 3] {
    triangle.map(|k| mesh.points[k as usize] * unit.per_metre())
}

/// Zero for a triangle without area, as the format asks.
fn normal([a, b, c]: &[Point3; 3]) -> Vector3 {
    (b - a)
        .cross(&(c - a))
        .try_normalize(0.0)
        .unwrap_or_else(Vector3::zeros)
}

fn binary(bytes: &[u8]) -> Result<&[u8], MeshFileError> {
    let Some((head, triangles)) = bytes.split_at_checked(HEAD) else {
        return Err(MeshFileError::Short(bytes.len()));
    };
    let count = u32::from_le_bytes([head[80], head[81], head[82], head[83]]);
    let needed = HEAD as u64 + TRIANGLE as u64 * u64::from(count);
    let filling = usize::try_from(needed)
        .ok()
        .and_then(|end| bytes.get(end..));
    if !filling.is_some_and(|rest| rest.len() < TRIANGLE || rest.iter().all(|&byte| byte == 0)) {
        return Err(MeshFileError::Length {
            bytes: bytes.len(),
            triangles: count,
            needed,
        });
    }
    Ok(&triangles[..needed as usize - HEAD])
}

fn corners_of(triangle: &[u8], unit: Unit) -> Vec<Point3> {
    let number = |k: usize| {
        let at = 12 + 4 * k;
        let bytes = [
            triangle[at],
            triangle[at + 1],
            triangle[at + 2],
            triangle[at + 3],
        ];
        f64::from(f32::from_le_bytes(bytes)) / unit.per_metre()
    };
    (0..3)
        .map(|k| Point3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2)))
        .collect()
}

fn text(bytes: &[u8], unit: Unit) -> Result<Vec<Point3>, MeshFileError> {
    let mut corners = Vec::new();
    let (mut ended, mut last) = (false, 1);
    // Corners before this loop.
    let mut before = 0;
    for (number, line) in lines(bytes) {
        let lower = line.to_ascii_lowercase();
        let mut words = words(&lower).peekable();
        while let Some(first) = words.next() {
            last = number;
            let mut next_is = |word: &[u8]| words.next_if(|next| *next == word).is_some();
            match first {
                b"vertex" => {
                    let corner = point(&mut words, unit.per_metre());
                    let wrong = || wrong_line(number, "vertex and three numbers", line);
                    corners.push(corner.ok_or_else(wrong)?);
                }
                b"outer" if next_is(b"loop") => before = corners.len(),
                b"endloop" | b"end" if first == b"endloop" || next_is(b"loop") => {
                    if corners.len() != before + 3 {
                        return Err(wrong_line(number, "three vertices before endloop", line));
                    }
                    before = corners.len();
                }
                b"facet" => {
                    // Its normal, which may be left out.
                    if next_is(b"normal") {
                        words.by_ref().take(3).for_each(drop);
                    }
                }
                b"endfacet" => {}
                b"end" if next_is(b"facet") => {}
                b"solid" | b"endsolid" | b"end" if first != b"end" || next_is(b"solid") => {
                    ended = first != b"solid";
                    // Its name.
                    break;
                }
                _ => {
                    let wanted = "a line of an STL file, such as vertex or facet";
                    return Err(wrong_line(number, wanted, line));
                }
            }
        }
    }
    if !ended || corners.len() != before {
        let wanted = "endsolid: the file seems to be cut short";
        return Err(wrong_line(last, wanted, b""));
    }
    Ok(corners)
}

/// Corners, three a triangle, as a mesh with each place once, in order of first appearance.
pub(super) fn welded(corners: Vec<Point3>) -> Result<Mesh, MeshFileError> {
    if corners.is_empty() {
        return Err(MeshFileError::Empty("triangles"));
    }
    if corners.len() > u32::MAX as usize {
        return Err(MeshFileError::Many {
            what: "corners",
            count: corners.len(),
        });
    }
    checked(&corners)?;
    // Plus zero makes one of the two zeros.
    let key = |k: usize| [corners[k].x, corners[k].y, corners[k].z].map(|x| (x + 0.0).to_bits());
    let mut order: Vec<usize> = (0..corners.len()).collect();
    order.sort_by_key(|&k| (key(k), k));
    let mut first: Vec<usize> = (0..corners.len()).collect();
    for pair in order.windows(2) {
        if key(pair[0]) == key(pair[1]) {
            first[pair[1]] = first[pair[0]];
        }
    }
    let mut number = vec![0u32; corners.len()];
    let mut points = Vec::new();
    for k in 0..corners.len() {
        if first[k] == k {
            number[k] = points.len() as u32;
            points.push(corners[k]);
        } else {
            number[k] = number[first[k]];
        }
    }
    let triangles = number.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    Mesh::from_triangles(points, triangles).ok_or(MeshFileError::Empty("triangles"))
}
