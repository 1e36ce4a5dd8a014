//! Edges and tips that stand out: with which a part touches where it has no normal; and those on which its flat faces end.

use super::carrier::Carrier;
use super::fan::{beside, frame};
use super::part::{Face, Part, Side};
use crate::math::{Point3, Vector3};

/// Places of an edge in each of its segments: what a cubic between two leaves over is below 1e-9 of a quarter circle.
const PLACES: usize = 48;
/// Places of an edge at which it is asked whether it stands out.
const ASKED: usize = 9;
/// Of the size: a step from the end of a flat face, and of the step, how far what goes on from there is below it.
const STEP: f64 = 1e-3;
/// Two flat faces whose normals are this near are one plane.
const LEVEL: f64 = 1e-9;
const BELOW: f64 = 1e-6;

/// An edge that stands out.
pub(crate) struct SharpEdge {
    /// Places along it, m, and the way on from each.
    pub places: Vec<(Point3, Vector3)>,
    /// It comes back to its start.
    pub closed: bool,
}

impl Part {
    /// Edges whose faces meet at a greater angle than that of a cosine, on the outside, or at which a flat face ends and
    /// goes on round; and the apexes that no edge reaches.
    pub(crate) fn sharp_edges(&self, cosine: f64) -> (Vec<SharpEdge>, Vec<Point3>) {
        let stands_out = |k: usize, at: (usize, f64)| {
            let edge = &self.edges[k];
            let [one, other] = edge.sides.as_slice() else {
                return false;
            };
            let tangent = edge.curve.slope(at).normalize();
            let [Some((uv, n, out)), Some((st, m, inward))] =
                [one, other].map(|side| frame(self, edge, side, at, &tangent))
            else {
                return false;
            };
            if n.dot(&m) < cosine {
                return n.dot(&inward) < 0.0;
            }
            let step_m = STEP * self.size_m();
            let ends = |flat: &Side, on: &Side, normal: &Vector3, uv: [f64; 2], way: &Vector3| {
                let [flat, on] = [flat, on].map(|side| &self.faces[side.face as usize]);
                let flat = matches!(flat.carrier, Carrier::Plane(_));
                flat && !matches!(on.carrier, Carrier::Plane(_))
                    && beside(on, uv, &(way * step_m)).dot(normal) < -BELOW * step_m
            };
            ends(one, other, &n, st, &inward) || ends(other, one, &m, uv, &out)
        };
        let edges = (0..self.edges.len()).filter(|&k| {
            let edge = &self.edges[k];
            edge.curve.samples(ASKED).any(|at| stands_out(k, at))
        });
        let edges = edges.map(|k| {
            let edge = &self.edges[k];
            let straight = edge.curve.is_line();
            let count = if straight { 1 } else { PLACES };
            let place = |at: (usize, f64)| {
                let slope = edge.curve.slope(at);
                (edge.curve.point(at), slope.normalize())
            };
            let mut places: Vec<(Point3, Vector3)> = (0..edge.curve.segments())
                .flat_map(|segment| (0..count).map(move |i| (segment, i as f64 / count as f64)))
                .map(place)
                .collect();
            let closed = edge.ends[0] == edge.ends[1];
            if !closed {
                places.push(place((edge.curve.segments() - 1, 1.0)));
            }
            SharpEdge { places, closed }
        });
        let tips = (self.lone.iter()).map(|&v| self.vertices[v as usize].point);
        (edges.collect(), tips.collect())
    }

    /// By face: the plane of one that is flat and ends in edges at which faces meet at a greater angle than that of a cosine;
    /// outward unit normal and its distance from the origin, m.
    pub(crate) fn planes(&self, cosine: f64) -> Vec<Option<(Vector3, f64)>> {
        let plane = |face: &Face| match &face.carrier {
            Carrier::Plane(axes) => {
                let normal = face.normal([0.0; 2]);
                Some((normal, normal.dot(&axes.origin.coords)))
            }
            _ => None,
        };
        let mut planes: Vec<_> = self.faces.iter().map(plane).collect();
        for edge in &self.edges {
            let flat = |side: &Side| {
                let face = &self.faces[side.face as usize];
                matches!(face.carrier, Carrier::Plane(_))
            };
            let both_flat = edge.sides.iter().all(flat);
            let smooth = edge.curve.samples(ASKED).any(|at| {
                let tangent = edge.curve.slope(at).normalize();
                let normals = edge.sides.iter();
                let normals = normals.filter_map(|side| frame(self, edge, side, at, &tangent));
                let normals: Vec<_> = normals.map(|(_, normal, _)| normal).collect();
                let [n, m] = normals[..] else {
                    return false;
                };
                n.dot(&m) >= cosine && !(both_flat && n.cross(&m).norm() <= LEVEL)
            });
            for side in edge.sides.iter().filter(|_| smooth) {
                planes[side.face as usize] = None;
            }
        }
        planes
    }
}
