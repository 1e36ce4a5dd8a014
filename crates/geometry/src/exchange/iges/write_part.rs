//! Writes a part as an IGES file of trimmed surfaces. IGES 5.3, §4.24 (126), §4.36 (142), §4.38 (144).
//!
//! ```text
//! face ──▶ rational B-spline with ends (128) ◀─┬─ 144 ─▶ loops: 142 ─▶ in space (102 of 110 and 126)
//!                                              └────────────────────▶ in parameters (102 of 126)
//! ```
//! Planes, cylinders, cones, spheres and tori are written as the rational B-splines that they are, cut to the face; a face
//! that goes round is cut open along a line. The format has no solids here: faces do not share edges.

use super::write::{Entities, FREE, Head, IN_PARAMETERS, PART_OF, largest, parameters};
use crate::exchange::LengthUnit;
use crate::exchange::number::real;
use crate::exchange::spline::{FileCurve, SplineError, Written};
use crate::exchange::step::written_unit;
use crate::math::Point3;
use crate::part::flat::{FlatFace, FlatPiece};
use crate::part::{FlatProblem, Part};

/// Why a part was not written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WritePartError {
    /// A face that fits into no rectangle of parameters.
    #[error("face #{id}: {source}")]
    Face {
        /// In the file that it was read from.
        id: u64,
        /// What is wrong.
        source: FlatProblem,
    },
    /// A surface that IGES has no form for.
    #[error("face #{id}: {source}")]
    Surface {
        /// In the file that it was read from.
        id: u64,
        /// What is wrong.
        source: SplineError,
    },
}

/// The file of a part: coordinates in `unit` if that is m, cm, mm or inch, else in mm. Same part, same bytes.
///
/// # Errors
/// A face that no rectangle of parameters shows, or on a surface that comes apart at a knot.
pub fn write_part(part: &Part, unit: &LengthUnit, name: &str) -> Result<String, WritePartError> {
    let unit = written_unit(unit);
    let scale = 1.0 / unit.metres();
    let mut writer = Writer {
        entities: Entities::default(),
        unit: &unit,
        scale,
    };
    for (k, face) in part.faces().enumerate() {
        let id = face.id;
        let flat = (part.flattened(k)).map_err(|source| WritePartError::Face { id, source })?;
        (writer.face(&flat)).map_err(|source| WritePartError::Surface { id, source })?;
    }
    let (low, high) = part.bounds();
    // The format has ASCII names only.
    let name: String = name.chars().filter(|c| matches!(c, ' '..='~')).collect();
    let head = Head {
        name: if name.is_empty() { "part" } else { &name },
        unit: match unit.name() {
            "m" => (6, "M"),
            "cm" => (10, "CM"),
            "inch" => (1, "INCH"),
            _ => (2, "MM"),
        },
        resolution: part.gap_m().max(1e-9) * scale,
        largest: largest(&[low, high]) * scale,
    };
    Ok(writer.entities.file("trimmed surfaces of a part", &head))
}

struct Writer<'a> {
    entities: Entities,
    unit: &'a LengthUnit,
    /// Units to a metre.
    scale: f64,
}

impl Writer<'_> {
    fn face(&mut self, face: &FlatFace) -> Result<(), SplineError> {
        let written = Written::new(&face.surface)?;
        let values = parameters(&written, self.scale);
        let surface = self.entities.add(128, PART_OF, "SURFACE", &values);
        let loops: Vec<u64> = (face.loops.iter())
            .map(|pieces| self.loop_on(surface, pieces))
            .collect();
        let (outer, holes) = match face.whole {
            true => (None, &loops[..]),
            false => (loops.first(), loops.get(1..).unwrap_or_default()),
        };
        // Whether the outer boundary is another one than the surface's.
        let mut values = vec![
            "144".to_owned(),
            surface.to_string(),
            u8::from(outer.is_some()).to_string(),
            holes.len().to_string(),
            outer.unwrap_or(&0).to_string(),
        ];
        values.extend(holes.iter().map(u64::to_string));
        self.entities.add(144, FREE, "FACE", &values);
        Ok(())
    }

    /// A loop: the curve in space is the master.
    fn loop_on(&mut self, surface: u64, pieces: &[FlatPiece]) -> u64 {
        let (mut flat, mut solid) = (Vec::new(), Vec::new());
        for piece in pieces {
            flat.push(self.picture(piece));
            solid.extend(self.curve(piece));
        }
        let flat = self.composite(&flat, IN_PARAMETERS);
        let solid = self.composite(&solid, PART_OF);
        let values = [142, 0, surface, flat, solid, 2].map(|x| x.to_string());
        self.entities.add(142, PART_OF, "LOOP", &values)
    }

    fn composite(&mut self, curves: &[u64], status: &str) -> u64 {
        let [one] = curves else {
            let mut values = vec!["102".to_owned(), curves.len().to_string()];
            values.extend(curves.iter().map(u64::to_string));
            return self.entities.add(102, status, "CURVE", &values);
        };
        *one
    }

    /// Straight ones as lines, all others as B-splines.
    fn curve(&mut self, piece: &FlatPiece) -> Option<u64> {
        let curve = FileCurve::of_segments(&piece.curve)?;
        if let ([a, b], 1) = (&curve.points[..], curve.degree) {
            let mut values = vec!["110".to_owned()];
            let ends = [a, b].into_iter().flat_map(|p| [p.x, p.y, p.z]);
            values.extend(ends.map(|x| real(self.unit.of_length(x), 'D')));
            return Some(self.entities.add(110, PART_OF, "EDGE", &values));
        }
        let unit = self.unit;
        let points: Vec<Point3> = (curve.points.iter())
            .map(|p| p.map(|x| unit.of_length(x)))
            .collect();
        let spline = Spline {
            degree: curve.degree,
            knots: (curve.knots.iter())
                .flat_map(|&(knot, times)| (0..times).map(move |_| knot))
                .collect(),
            weights: curve.weights,
            points,
            flat: false,
        };
        Some(self.entities.add(126, PART_OF, "EDGE", &spline.values()))
    }

    fn picture(&mut self, piece: &FlatPiece) -> u64 {
        let picture = &piece.picture;
        let (first, last) = (picture.breaks[0], picture.breaks[picture.breaks.len() - 1]);
        let inner = picture.breaks.iter().flat_map(|t| [*t; 3]);
        let spline = Spline {
            degree: 3,
            knots: [first].into_iter().chain(inner).chain([last]).collect(),
            weights: None,
            points: (picture.points.iter())
                .map(|[u, v]| Point3::new(*u, *v, 0.0))
                .collect(),
            flat: true,
        };
        self.entities
            .add(126, IN_PARAMETERS, "IMAGE", &spline.values())
    }
}

/// Entity 126, in the file's unit or in parameters.
struct Spline {
    degree: usize,
    knots: Vec<f64>,
    weights: Option<Vec<f64>>,
    points: Vec<Point3>,
    /// In the plane of x and y.
    flat: bool,
}

impl Spline {
    fn values(&self) -> Vec<String> {
        let flag = |flag: bool| u8::from(flag).to_string();
        let count = self.points.len();
        let closed = self.points[0] == self.points[count - 1];
        let mut out = vec![
            "126".to_owned(),
            (count - 1).to_string(),
            self.degree.to_string(),
            flag(self.flat),
            flag(closed),
            flag(self.weights.is_none()),
            flag(false),
        ];
        let one = |x: f64| real(x, 'D');
        out.extend(self.knots.iter().map(|&knot| one(knot)));
        out.extend((0..count).map(|k| one(self.weights.as_ref().map_or(1.0, |w| w[k]))));
        out.extend(self.points.iter().flat_map(|p| [p.x, p.y, p.z]).map(one));
        out.extend([self.knots[0], self.knots[self.knots.len() - 1]].map(one));
        let normal = if self.flat { [0.0, 0.0, 1.0] } else { [0.0; 3] };
        out.extend(normal.map(one));
        out
    }
}
