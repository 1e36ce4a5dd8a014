//! Wavefront OBJ: corners, normals and faces as text.

use super::{MeshFileError, check, lines, plain, point, polygon, words, wrong_line};
use crate::math::Point3;
use crate::surface::Mesh;
use crate::surface::file::Unit;
use std::borrow::Cow;
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
    for (number, line) in statements(plain(bytes)?) {
        let mut words = words(&line);
        if words.next() == Some(b"v") {
            points.push(vertex(words, unit, number, &line)?);
        }
    }
    if points.is_empty() {
        Err(MeshFileError::Empty("corners (lines that begin with v)"))
    } else {
        Ok(points)
    }
}

/// The corners and faces of a file. Faces with more than three corners become the triangles that cover them, concave ones
/// too; what has no area (points `p`, lines `l`, curves) and what does not change the shape (names, materials, texture) is
/// passed over. Normals are those of the triangles' turning, whatever the file has.
///
/// # Errors
/// A corner that is not three finite numbers, a face that names a corner which is not there, or whose edges cross, curved
/// faces (`surf` and older kinds), or no face at all.
pub fn read(bytes: &[u8], unit: Unit) -> Result<Mesh, MeshFileError> {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let mut face = 0;
    for (line, text) in statements(plain(bytes)?) {
        let mut words = words(&text);
        match words.next() {
            Some(b"v") => points.push(vertex(words, unit, line, &text)?),
            // `fo` is its old name.
            Some(b"f" | b"fo") => {
                let corners: Option<Vec<u32>> =
                    words.map(|word| corner(word, points.len())).collect();
                let corners = corners
                    .filter(|corners| corners.len() >= 3)
                    .ok_or_else(|| {
                        let wanted = "f and three or more corners that stand above";
                        wrong_line(line, wanted, &text)
                    })?;
                face += 1;
                let found = polygon::triangles(&points, &corners);
                triangles.extend(found.map_err(|flaw| MeshFileError::Polygon {
                    face,
                    line: Some(line),
                    corners: corners.len(),
                    flaw,
                })?);
            }
            Some(word) => {
                if let Some(keyword) = CURVED.iter().find(|known| known.as_bytes() == word) {
                    return Err(MeshFileError::Faces { line, keyword });
                }
            }
            None => {}
        }
    }
    if triangles.is_empty() {
        return Err(MeshFileError::Empty("faces (lines that begin with f)"));
    }
    Mesh::from_triangles(points, triangles)
        .ok_or(MeshFileError::Empty("corners (lines that begin with v)"))
}

/// Faces that are not polygons: free-form ones, and the patches of before.
const CURVED: [&str; 4] = ["surf", "bsp", "bzp", "cdp"];

/// Lines without their comments, those that end with a backslash joined to the next; with the number of the first.
fn statements(text: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    let mut lines = lines(text).map(|(number, line)| {
        let said = line.split(|&byte| byte == b'#').next();
        (number, said.unwrap_or_default().trim_ascii_end())
    });
    std::iter::from_fn(move || {
        let (number, first) = lines.next()?;
        let mut whole = Cow::Borrowed(first);
        while whole.ends_with(b"\\") {
            let joined = whole.to_mut();
            joined.pop();
            joined.push(b' ');
            joined.extend_from_slice(lines.next().map_or(&[], |(_, line)| line));
        }
        Some((number, whole))
    })
}

/// The three coordinates of a corner; what follows them, a weight or a colour, is passed over.
fn vertex<'a>(
    words: impl Iterator<Item = &'a [u8]>,
    unit: Unit,
    number: usize,
    line: &[u8],
) -> Result<Point3, MeshFileError> {
    point(words, unit.per_metre()).ok_or_else(|| wrong_line(number, "v and three numbers", line))
}

/// `7`, `7/1`, `7//3`, counted from 1, or from the last one back when negative.
fn corner(word: &[u8], count: usize) -> Option<u32> {
    let index = word.split(|&byte| byte == b'/').next()?;
    let index: i64 = std::str::from_utf8(index).ok()?.parse().ok()?;
    let count = i64::try_from(count).ok()?;
    let at = if index > 0 { index - 1 } else { count + index };
    (index != 0 && (0..count).contains(&at)).then(|| u32::try_from(at).ok())?
}
