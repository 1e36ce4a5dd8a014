//! Wavefront OBJ: corners, normals and faces as text.

use super::{MeshError, check, lines, point, words, wrong_line};
use crate::math::Point3;
use crate::surface::Mesh;
use crate::surface::file::Unit;
use std::fmt::Write as _;

/// The file of a mesh, with a normal for each corner; numbers read back bit for bit.
///
/// # Errors
/// A mesh that is empty, or whose parts do not fit each other.
pub fn write(mesh: &Mesh, unit: Unit) -> Result<String, MeshError> {
    check(mesh, unit.per_metre(), false)?;
    let mut out = format!("# palpate {}, {}\no surface\n", env!("CARGO_PKG_VERSION"), unit.name());
    for point in &mesh.points {
        let point = point * unit.per_metre();
        let _ = writeln!(out, "v {:?} {:?} {:?}", point.x, point.y, point.z);
    }
    for normal in &mesh.normals {
        let _ = writeln!(out, "vn {:?} {:?} {:?}", normal.x, normal.y, normal.z);
    }
    for triangle in &mesh.triangles {
        // Corners are counted from 1.
        let [a, b, c] = triangle.map(|k| u64::from(k) + 1);
        let _ = writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}");
    }
    Ok(out)
}

/// The corners of a file, in its order; everything else in it is passed over.
///
/// # Errors
/// A corner that is not three finite numbers, or none at all.
pub fn read_points(bytes: &[u8], unit: Unit) -> Result<Vec<Point3>, MeshError> {
    let mut points = Vec::new();
    for (number, line) in lines(bytes) {
        let mut words = words(line);
        if words.next() == Some(b"v") {
            let corner = point(words, unit.per_metre());
            points.push(corner.ok_or_else(|| wrong_line(number, "v and three numbers", line))?);
        }
    }
    if points.is_empty() { Err(MeshError::Empty("corners (lines that begin with v)")) } else { Ok(points) }
}
