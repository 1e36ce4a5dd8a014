//! Point clouds as text: a point a line, coordinates apart by blanks, commas, semicolons or tabs.

use super::{MeshFileError, lines, plain, point, wrong_line};
use crate::math::Point3;
use crate::surface::file::Unit;

/// Reads `.xyz`, `.csv` and the like. Empty lines and what follows `#` are passed over, the first
/// line too if it names columns; further columns (normals, colours) are not read.
///
/// # Errors
/// A line that does not begin with three finite numbers, or no point at all.
pub fn read(bytes: &[u8], unit: Unit) -> Result<Vec<Point3>, MeshFileError> {
    let mut points = Vec::new();
    let mut titled = false;
    for (number, line) in lines(plain(bytes)?) {
        let line = line
            .split(|&byte| byte == b'#')
            .next()
            .unwrap_or_default()
            .trim_ascii();
        if line.is_empty() {
            continue;
        }
        let separates = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b',' | b';');
        let mut fields = line.split(separates).filter(|field| !field.is_empty());
        // A title is words: a point with a mistake in it is none.
        let is_title = !titled
            && points.is_empty()
            && fields
                .clone()
                .all(|field| super::super::number::parse(field).is_none());
        if is_title && fields.clone().next().is_some() {
            titled = true;
            continue;
        }
        let found = point(&mut fields, unit.per_metre());
        points.push(found.ok_or_else(|| wrong_line(number, "three numbers, x y z", line))?);
    }
    if points.is_empty() {
        Err(MeshFileError::Empty("points"))
    } else {
        Ok(points)
    }
}
