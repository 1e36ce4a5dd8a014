//! Places of a part in two numbers, as places of a surface are: the face's index and the share of its range of u, added,
//! and v. A place of an edge or a vertex names one of the faces that meet there.

use super::part::{Face, Part, Side};
use crate::math::{Point3, Vector3};

/// The last share of a range that does not round to the next face, for up to 2²⁰ faces.
const LAST: f64 = 1.0 - 1e-9;

impl Part {
    /// The number of a place's face, and its parameters there. Numbers that are no place name the nearest.
    pub fn on_face(&self, [at, v]: [f64; 2]) -> (u32, [f64; 2]) {
        let last = self.faces.len() - 1;
        let face = (at.max(0.0) as usize).min(last);
        let [u0, u1] = self.faces[face].range_u;
        let share = (at - face as f64).clamp(0.0, 1.0) / LAST;
        (face as u32, [u0 + share * (u1 - u0), v])
    }

    /// Parameters of a face as a place of the part.
    pub fn place(&self, face: u32, uv: [f64; 2]) -> [f64; 2] {
        [
            f64::from(face) + LAST * self.faces[face as usize].share(uv[0]),
            uv[1],
        ]
    }

    /// A face at an edge, and where on it a place of the edge is.
    pub(super) fn beside_edge(&self, edge: u32, at: (usize, f64)) -> (u32, [f64; 2]) {
        let edge = &self.edges[edge as usize];
        let on = |side: &Side| {
            let uv = edge.on(side, &self.faces, at)?;
            let chart = &self.faces[side.face as usize].trim.chart;
            Some((side.face, chart.confined(uv)))
        };
        let first = edge.sides.first().map_or(0, |side| side.face);
        edge.sides.iter().find_map(on).unwrap_or((first, [0.0; 2]))
    }

    /// A face at a vertex that no edge reaches, and where on it that is.
    pub(super) fn beside_vertex(&self, vertex: u32) -> (u32, [f64; 2]) {
        let vertex = &self.vertices[vertex as usize];
        let face = vertex.face.unwrap_or(0);
        let apexes = self.faces[face as usize].carrier.apexes();
        let away = |apex: &Point3| (apex - vertex.point).norm_squared();
        let nearest = apexes
            .iter()
            .min_by(|a, b| away(&a.0).total_cmp(&away(&b.0)));
        (face, [0.0, nearest.map_or(0.0, |(_, _, v)| *v)])
    }

    /// A point is on an edge that only one face has, to within `close_m`: on the rim of a sheet.
    pub fn ends_at(&self, point: &Point3, close_m: f64) -> bool {
        let mut found = false;
        let mut ceiling = close_m * close_m;
        self.wires.nearest(point, &mut ceiling, |item, ceiling| {
            if let Some(edge) = self.edges.get(item as usize)
                && edge.sides.len() == 1
            {
                found |= edge.curve.closest(point, *ceiling).is_some();
            }
        });
        found
    }

    /// The point at a place, m.
    pub fn point(&self, place: [f64; 2]) -> Point3 {
        let (face, uv) = self.on_face(place);
        let face = &self.faces[face as usize];
        face.carrier.point(face.trim.chart.confined(uv))
    }

    /// Unit normal of the face at a place, out of the matter.
    pub fn normal(&self, place: [f64; 2]) -> Vector3 {
        let (face, uv) = self.on_face(place);
        let face = &self.faces[face as usize];
        face.normal(face.trim.chart.confined(uv))
    }
}

impl Face {
    /// How far along the face's range of u, 0 to 1.
    fn share(&self, u: f64) -> f64 {
        let [low, high] = self.range_u;
        let period = self.trim.chart.periods[0];
        let width = high - low;
        let mut along = u - low;
        if period > 0.0 {
            along = along.rem_euclid(period);
            if along > width && period - along < along - width {
                along = 0.0;
            }
        }
        if width > 0.0 {
            (along / width).clamp(0.0, 1.0)
        } else {
            0.0
        }
    }
}
