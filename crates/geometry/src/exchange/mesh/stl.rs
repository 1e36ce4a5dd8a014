//! STL: triangles with their normals, binary (single precision) or text.

use super::{MeshFileError, check, checked, lines, point, words, wrong_line};
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
/// one; normals are those of the triangles' turning, whatever the file has.
///
/// # Errors
/// A file cut short, or coordinates that are not finite.
pub fn read(bytes: &[u8], unit: Unit) -> Result<Mesh, MeshFileError> {
    // Some binary files begin with "solid" too: their length tells.
    let corners = match binary(bytes) {
        Ok(triangles) => triangles
            .chunks_exact(TRIANGLE)
            .flat_map(|t| corners_of(t, unit))
            .collect(),
        Err(_) if bytes.trim_ascii_start().starts_with(b"solid") => text(bytes, unit)?,
        Err(error) => return Err(error),
    };
    welded(corners)
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
    if needed != bytes.len() as u64 {
        return Err(MeshFileError::Length {
            bytes: bytes.len(),
            triangles: count,
            needed,
        });
    }
    Ok(triangles)
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
    let mut ended = false;
    let mut last = 1;
    for (number, line) in lines(bytes) {
        let mut words = words(line);
        let Some(first) = words.next() else { continue };
        last = number;
        match first {
            b"vertex" => {
                let corner = point(words, unit.per_metre());
                corners.push(
                    corner.ok_or_else(|| wrong_line(number, "vertex and three numbers", line))?,
                );
            }
            // A corner may belong to no triangle only where a line is missing.
            b"endloop" if corners.len() % 3 != 0 || corners.is_empty() => {
                return Err(wrong_line(number, "three vertices before endloop", line));
            }
            b"endsolid" => ended = true,
            b"solid" => ended = false,
            b"facet" | b"outer" | b"endloop" | b"endfacet" => {}
            _ => {
                return Err(wrong_line(
                    number,
                    "a line of an STL file, such as vertex or facet",
                    line,
                ));
            }
        }
    }
    if !ended || corners.len() % 3 != 0 {
        return Err(wrong_line(
            last,
            "endsolid: the file seems to be cut short",
            b"",
        ));
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
