//! Wavefront OBJ: corners, normals and faces as text.

use super::{MeshFileError, check, lines, point, words, wrong_line};
use crate::math::Point3;
use crate::surface::Mesh;
use crate::surface::file::Unit;
use std::fmt::Write as _;

/// The file of a mesh, with a normal for each corner; numbers read back bit for bit.
///
/// # Errors
/// A mesh that is empty, or whose parts do not fit each other.
pub fn write(mesh: &Mesh, unit: Unit) -> Result<String, MeshFileError> {
    check(mesh)?;
    let mut out = format!(
        "# palpate {}, {}\no surface\n",
        env!("CARGO_PKG_VERSION"),
        unit.name()
    );
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
pub fn read_points(bytes: &[u8], unit: Unit) -> Result<Vec<Point3>, MeshFileError> {
    let mut points = Vec::new();
    for (number, line) in lines(bytes) {
        let mut words = words(line);
        if words.next() == Some(b"v") {
            let corner = point(words, unit.per_metre());
            points.push(corner.ok_or_else(|| wrong_line(number, "v and three numbers", line))?);
        }
    }
    if points.is_empty() {
        Err(MeshFileError::Empty("corners (lines that begin with v)"))
    } else {
        Ok(points)
    }
}

/// The corners and faces of a file; faces with more than three corners become fans, everything else
/// is passed over. Normals are those of the triangles' turning, whatever the file has.
///
/// # Errors
/// A corner that is not three finite numbers, a face that names a corner which is not there, or no
/// face at all.
pub fn read(bytes: &[u8], unit: Unit) -> Result<Mesh, MeshFileError> {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for (number, line) in lines(bytes) {
        let mut words = words(line);
        match words.next() {
            Some(b"v") => {
                let corner = point(words, unit.per_metre());
                points.push(corner.ok_or_else(|| wrong_line(number, "v and three numbers", line))?);
            }
            Some(b"f") => {
                let wrong =
                    || wrong_line(number, "f and three or more corners that stand above", line);
                let corners: Option<Vec<u32>> =
                    words.map(|word| corner(word, points.len())).collect();
                let corners = corners
                    .filter(|corners| corners.len() >= 3)
                    .ok_or_else(wrong)?;
                triangles.extend(
                    corners
                        .windows(2)
                        .skip(1)
                        .map(|pair| [corners[0], pair[0], pair[1]]),
                );
            }
            _ => {}
        }
    }
    if triangles.is_empty() {
        return Err(MeshFileError::Empty("faces (lines that begin with f)"));
    }
    Mesh::from_triangles(points, triangles)
        .ok_or(MeshFileError::Empty("corners (lines that begin with v)"))
}

/// `7`, `7/1`, `7//3`, counted from 1, or from the last one back when negative.
fn corner(word: &[u8], count: usize) -> Option<u32> {
    let index = word.split(|&byte| byte == b'/').next()?;
    let index: i64 = std::str::from_utf8(index).ok()?.parse().ok()?;
    let count = i64::try_from(count).ok()?;
    let at = if index > 0 { index - 1 } else { count + index };
    (index != 0 && (0..count).contains(&at)).then(|| u32::try_from(at).ok())?
}
