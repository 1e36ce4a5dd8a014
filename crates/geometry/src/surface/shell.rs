//! Triangles as the boundary of bodies: how many parts, whether they close, how many holes go
//! through them, area, volume; and points spread evenly over them.

use super::Mesh;
use crate::math::{Point3, Random, Vector3, first_outside};
use std::collections::BTreeMap;

/// Triangles whose corners at equal places are one corner.
#[derive(Clone, Debug, PartialEq)]
pub struct Shell {
    points: Vec<Point3>,
    triangles: Vec<[u32; 3]>,
}

/// What [`Shell::census`] counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Census {
    /// Parts that share no edge.
    pub components: usize,
    /// Edges that do not have exactly two triangles, one in each direction.
    pub open_edges: usize,
    /// Handles of a closed shell, all parts together: 0 for a ball, 1 for a torus.
    pub genus: usize,
    /// Area, m².
    pub area_m2: f64,
    /// Enclosed volume, m³; of an open shell, that of the cone from its middle.
    pub volume_m3: f64,
    /// Diagonal of the bounding box, m.
    pub size_m: f64,
}

impl Census {
    /// Every edge has two triangles.
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0
    }
}

impl Shell {
    /// Of a mesh: corners at the same place become one, triangles that lose their area by that are
    /// left out. `None` without any triangle, or with a coordinate that is not within
    /// ±[`MOST_COORDINATE_M`](crate::math::MOST_COORDINATE_M) or a corner that does not exist.
    pub fn of(mesh: &Mesh) -> Option<Self> {
        if first_outside(&mesh.points).is_some() {
            return None;
        }
        let mut known: BTreeMap<[u64; 3], u32> = BTreeMap::new();
        let mut points = Vec::new();
        let mut names = Vec::with_capacity(mesh.points.len());
        for point in &mesh.points {
            // −0 is 0.
            let key = [0, 1, 2].map(|k| (point[k] + 0.0).to_bits());
            names.push(*known.entry(key).or_insert_with(|| {
                points.push(*point);
                points.len() as u32 - 1
            }));
        }
        let mut triangles = Vec::with_capacity(mesh.triangles.len());
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|k| names.get(k as usize).copied());
            let (a, b, c) = (a?, b?, c?);
            if a != b && b != c && c != a {
                triangles.push([a, b, c]);
            }
        }
        (!triangles.is_empty()).then_some(Self { points, triangles })
    }

    /// Corners, each place once, m.
    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// Indices of corners.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    pub(super) fn corners(&self, triangle: usize) -> [Point3; 3] {
        self.triangles[triangle].map(|k| self.points[k as usize])
    }

    /// Area of each triangle, m².
    pub(super) fn areas(&self) -> Vec<f64> {
        let area = |t: usize| {
            let [a, b, c] = self.corners(t);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        (0..self.triangles.len()).map(area).collect()
    }

    /// Parts, closure, genus and measures.
    pub fn census(&self) -> Census {
        // By edge: triangles along it and against it.
        let mut edges: BTreeMap<(u32, u32), [u32; 2]> = BTreeMap::new();
        // Each corner's way to the one that stands for its part.
        let mut parent: Vec<usize> = (0..self.points.len()).collect();
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let sides = edges.entry((from.min(to), from.max(to))).or_default();
                sides[usize::from(from > to)] += 1;
                let (from, to) = (root(&mut parent, from), root(&mut parent, to));
                parent[from.max(to)] = from.min(to);
            }
        }
        let mut used = vec![false; self.points.len()];
        self.triangles
            .iter()
            .flatten()
            .for_each(|&k| used[k as usize] = true);
        let corners = used.iter().filter(|used| **used).count();
        let components = (0..self.points.len())
            .filter(|&k| used[k] && parent[k] == k)
            .count();
        let open_edges = edges.values().filter(|sides| **sides != [1, 1]).count();
        // Euler: V − E + F = 2 (components − genus) where it is closed.
        let euler = corners as i64 - edges.len() as i64 + self.triangles.len() as i64;
        let genus = (components as i64 - euler.div_euclid(2)).max(0) as usize;
        let (low, high) = self.bounds();
        let middle = nalgebra::center(&low, &high);
        let volume = self.triangles.iter().map(|t| {
            let [p, q, r] = t.map(|k| self.points[k as usize] - middle);
            p.dot(&q.cross(&r)) / 6.0
        });
        Census {
            components,
            open_edges,
            genus: if open_edges == 0 { genus } else { 0 },
            area_m2: self.areas().iter().sum(),
            volume_m3: volume.sum::<f64>().abs(),
            size_m: (high - low).norm(),
        }
    }

    fn bounds(&self) -> (Point3, Point3) {
        let first = self.points[0];
        let wider = |(l, h): (Point3, Point3), p: &Point3| (l.inf(p), h.sup(p));
        self.points.iter().fold((first, first), wider)
    }

    /// About `count` places, spread evenly over the area: triangle, and weights of its corners.
    /// Always the same ones.
    pub(super) fn places(&self, count: usize) -> Vec<(usize, [f64; 3])> {
        let areas = self.areas();
        let step = areas.iter().sum::<f64>() / count.max(1) as f64;
        let mut random = Random(1);
        // One place for each step of area along the list of triangles.
        let (mut places, mut passed) = (Vec::with_capacity(count + 1), 0.0);
        let mut next = 0.5 * step;
        for (triangle, area) in areas.iter().enumerate() {
            passed += area;
            while next < passed {
                let (a, b) = (libm::sqrt(random.unit()), random.unit());
                places.push((triangle, [1.0 - a, a * (1.0 - b), a * b]));
                next += step;
            }
        }
        places
    }

    /// The point of a place.
    pub(super) fn point(&self, (triangle, weights): (usize, [f64; 3])) -> Point3 {
        let corners = self.corners(triangle);
        Point3::from(
            (0..3)
                .map(|k| corners[k].coords * weights[k])
                .sum::<Vector3>(),
        )
    }

    /// The same shell with edges of at most `longest` (m): edges above it are halved, in both
    /// triangles alike.
    pub(super) fn with_edges_up_to(&self, longest: f64) -> Self {
        let mut shell = self.clone();
        // Each pass halves: 40 are beyond any file.
        for _ in 0..40 {
            let mut middles: BTreeMap<(u32, u32), u32> = BTreeMap::new();
            for &[a, b, c] in &shell.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    let key = (from.min(to), from.max(to));
                    let [p, q] = [key.0, key.1].map(|k| shell.points[k as usize]);
                    if (q - p).norm() > longest && !middles.contains_key(&key) {
                        middles.insert(key, shell.points.len() as u32);
                        shell.points.push(nalgebra::center(&p, &q));
                    }
                }
            }
            if middles.is_empty() {
                break;
            }
            let mut triangles = Vec::with_capacity(2 * shell.triangles.len());
            for &corners in &shell.triangles {
                split(corners, &middles, &mut triangles);
            }
            shell.triangles = triangles;
        }
        shell
    }
}

/// The corner that stands for the part of this one; the ways on the path are halved.
fn root(parent: &mut [usize], corner: u32) -> usize {
    let mut k = corner as usize;
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

/// A triangle, divided at the middles of its edges that have one.
fn split(corners: [u32; 3], middles: &BTreeMap<(u32, u32), u32>, into: &mut Vec<[u32; 3]>) {
    let [a, b, c] = corners;
    let middle = |p: u32, q: u32| middles.get(&(p.min(q), p.max(q))).copied();
    match [middle(a, b), middle(b, c), middle(c, a)] {
        [None, None, None] => into.push(corners),
        [Some(x), Some(y), Some(z)] => {
            into.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
        }
        // Turned until the first edge has a middle and the last has none.
        [None, _, _] => split([b, c, a], middles, into),
        [Some(_), _, Some(_)] => split([c, a, b], middles, into),
        [Some(x), Some(y), None] => into.extend([[x, b, y], [a, x, y], [a, y, c]]),
        [Some(x), None, None] => into.extend([[a, x, c], [x, b, c]]),
    }
}

#[cfg(test)]
mod tests {
    use super::super::builtin;
    use super::*;

    fn of(name: &str) -> Shell {
        let surface = builtin(name, None, None).unwrap();
        Shell::of(&surface.tessellated([6; 2]).unwrap()).unwrap()
    }

    #[test]
    fn balls_tori_sheets_and_pairs_are_counted() {
        let ball = of("sphere").census();
        assert_eq!((ball.components, ball.open_edges, ball.genus), (1, 0, 0));
        let torus = of("torus").census();
        assert_eq!((torus.components, torus.open_edges, torus.genus), (1, 0, 1));
        assert!(!of("sheet").census().is_closed());
        let drop = builtin("teardrop", None, None).unwrap();
        let census = of("teardrop").census();
        assert!((census.volume_m3 / drop.volume() - 1.0).abs() < 0.02);
        let mut pair = of("sphere");
        let other = of("torus");
        let shift = pair.points.len() as u32;
        pair.points
            .extend(other.points.iter().map(|p| p + Vector3::x()));
        pair.triangles
            .extend(other.triangles.iter().map(|t| t.map(|k| k + shift)));
        let census = pair.census();
        assert_eq!((census.components, census.genus), (2, 1));
    }

    #[test]
    fn dividing_edges_changes_neither_shape_nor_kind() {
        let ball = of("teardrop");
        let fine = ball.with_edges_up_to(2e-3);
        let (before, after) = (ball.census(), fine.census());
        assert!(fine.points.len() > 2 * ball.points.len());
        assert_eq!(after.open_edges, 0);
        assert_eq!(after.genus, 0);
        assert!((after.volume_m3 / before.volume_m3 - 1.0).abs() < 1e-12);
        assert!((after.area_m2 / before.area_m2 - 1.0).abs() < 1e-12);
        for &[a, b, _] in &fine.triangles {
            assert!((fine.points[a as usize] - fine.points[b as usize]).norm() <= 2e-3);
        }
    }

    #[test]
    fn places_lie_evenly_on_the_area() {
        let ball = of("sphere");
        let places = ball.places(5_000);
        assert!(places.len().abs_diff(5_000) <= 1);
        let mean = places
            .iter()
            .map(|&p| ball.point(p).coords)
            .sum::<Vector3>()
            / places.len() as f64;
        let middle = nalgebra::center(&ball.bounds().0, &ball.bounds().1);
        assert!((mean - middle.coords).norm() < 0.02 * ball.census().size_m);
    }
}
