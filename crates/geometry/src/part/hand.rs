//! Boundaries by hand, and names of files, for tests.

use super::*;
use crate::math::{Point3, Vector3};
use std::f64::consts::PI;

/// STEP files in `tests/data/parts`.
pub(crate) const FILES: [&str; 12] = [
    "assembly",
    "cone_tip",
    "filleted_box",
    "loft",
    "pipe",
    "saddle",
    "seam_cut",
    "shelled_box",
    "sphere_minus_boxes",
    "text_cut",
    "thread",
    "turned",
];

pub(crate) fn axes(origin: [f64; 3], z: [f64; 3], x: [f64; 3]) -> Axes {
    Axes::new(
        Point3::from(origin),
        &Vector3::from(z),
        Some(&Vector3::from(x)),
    )
    .expect("an axis")
}

/// Adds edges as they are asked for.
#[derive(Default)]
pub(crate) struct Maker(pub(crate) Brep);

impl Maker {
    pub(crate) fn vertex(&mut self, p: [f64; 3]) -> u32 {
        let p = Point3::from(p);
        let at = self.0.vertices.iter().position(|q| *q == p);
        at.unwrap_or_else(|| {
            self.0.vertices.push(p);
            self.0.vertices.len() - 1
        }) as u32
    }

    pub(crate) fn line(&mut self, a: [f64; 3], b: [f64; 3]) -> (u32, bool) {
        let ends = [self.vertex(a), self.vertex(b)];
        let known = self.0.edges.iter().position(|e| {
            matches!(e.curve, BrepCurve::Line { .. })
                && (e.ends == ends || e.ends == [ends[1], ends[0]])
        });
        if let Some(k) = known {
            return (k as u32, self.0.edges[k].ends == ends);
        }
        let (a, b) = (Point3::from(a), Point3::from(b));
        let curve = BrepCurve::Line {
            origin: a,
            direction: (b - a).normalize(),
        };
        (self.edge(curve, ends), true)
    }

    /// From x of the axes round to x.
    pub(crate) fn circle(&mut self, axes: Axes, radius_m: f64) -> u32 {
        let start = axes.to_world(&Vector3::new(radius_m, 0.0, 0.0));
        let v = self.vertex(start.into());
        self.edge(BrepCurve::Circle { axes, radius_m }, [v, v])
    }

    pub(crate) fn edge(&mut self, curve: BrepCurve, ends: [u32; 2]) -> u32 {
        let id = self.0.edges.len() as u64 + 100;
        self.0.edges.push(BrepEdge {
            id,
            curve,
            ends,
            along: true,
        });
        id as u32 - 100
    }

    pub(crate) fn face(
        &mut self,
        carrier: Carrier,
        same_sense: bool,
        loops: Vec<Vec<(u32, bool)>>,
    ) {
        let id = self.0.faces.len() as u64 + 1;
        let bounds = loops.into_iter().map(BrepBound::Loop).collect();
        self.0.faces.push(BrepFace {
            id,
            carrier,
            same_sense,
            bounds,
        });
    }

    pub(crate) fn polygon(&mut self, points: &[[f64; 3]], more: Vec<Vec<(u32, bool)>>) {
        let n = points.len();
        let uses = (0..n)
            .map(|k| self.line(points[k], points[(k + 1) % n]))
            .collect();
        let [a, b, c] = [0, 1, 2].map(|k| Vector3::from(points[k]));
        let normal = (b - a).cross(&(c - b));
        let carrier = Carrier::Plane(axes(points[0], normal.into(), (b - a).into()));
        let mut loops = vec![uses];
        loops.extend(more);
        self.face(carrier, true, loops);
    }

    pub(crate) fn solid(mut self) -> Brep {
        let faces = (0..self.0.faces.len() as u32).collect();
        self.0.shells = vec![BrepShell {
            faces,
            closed: true,
            solid: Some(0),
        }];
        self.0
    }
}

/// 60 × 40 × 20 mm with a hole of radius 8 mm through it.
pub(crate) fn drilled() -> Brep {
    let mut maker = Maker::default();
    let (w, d, h, r) = (0.06, 0.04, 0.02, 0.008);
    let middle = |z: f64| [0.03, 0.02, z];
    let low = maker.circle(axes(middle(0.0), [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), r);
    let high = maker.circle(axes(middle(h), [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), r);
    let [a, b, c, e] = [[0.0, 0.0], [w, 0.0], [w, d], [0.0, d]];
    let at = |[x, y]: [f64; 2], z: f64| [x, y, z];
    // Around a hole one walks the other way.
    maker.polygon(
        &[at(a, 0.0), at(e, 0.0), at(c, 0.0), at(b, 0.0)],
        vec![vec![(low, true)]],
    );
    maker.polygon(
        &[at(a, h), at(b, h), at(c, h), at(e, h)],
        vec![vec![(high, false)]],
    );
    for [p, q] in [[a, b], [b, c], [c, e], [e, a]] {
        maker.polygon(&[at(p, 0.0), at(q, 0.0), at(q, h), at(p, h)], vec![]);
    }
    let seam = maker.line([0.03 + r, 0.02, 0.0], [0.03 + r, 0.02, h]);
    let axis = axes(middle(0.0), [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let back = (seam.0, !seam.1);
    maker.face(
        Carrier::Cylinder {
            axes: axis,
            radius_m: r,
        },
        false,
        vec![vec![(low, false), seam, (high, true), back]],
    );
    maker.solid()
}

/// A cone of 45° on its base, apex up, with a seam or a loop of a single vertex.
pub(crate) fn cone() -> Brep {
    let mut maker = Maker::default();
    let base = maker.circle(axes([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), 0.01);
    let apex = maker.vertex([0.0, 0.0, 0.01]);
    let down = axes([0.0, 0.0, 0.01], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    let carrier = Carrier::Cone {
        axes: down,
        half_angle_rad: PI / 4.0,
    };
    maker.face(carrier, true, vec![vec![(base, true)]]);
    maker.0.faces[0].bounds.push(BrepBound::Vertex(apex));
    let plane = Carrier::Plane(axes([0.0; 3], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]));
    maker.face(plane, true, vec![vec![(base, false)]]);
    maker.solid()
}

/// The upper half of a ball.
pub(crate) fn dome() -> Brep {
    let mut maker = Maker::default();
    let rim = maker.circle(axes([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), 0.01);
    let sphere = Carrier::Sphere {
        axes: axes([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        radius_m: 0.01,
    };
    maker.face(sphere, true, vec![vec![(rim, true)]]);
    let plane = Carrier::Plane(axes([0.0; 3], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]));
    maker.face(plane, true, vec![vec![(rim, false)]]);
    maker.solid()
}

/// A quarter of a ring of round wire.
pub(crate) fn bend() -> Brep {
    let mut maker = Maker::default();
    let (major, minor) = (0.02, 0.005);
    let first = axes([major, 0.0, 0.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]);
    let last = axes([0.0, major, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let a = maker.circle(first, minor);
    let b = maker.circle(last, minor);
    let torus = Carrier::Torus {
        axes: axes([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        major_m: major,
        minor_m: minor,
    };
    // The first circle runs from outside up: z × x of its axes is -z... both are walked with the face on the left.
    let up = |axes: &Axes| axes.y.z > 0.0;
    maker.face(
        torus,
        true,
        vec![vec![(a, !up(&first))], vec![(b, up(&last))]],
    );
    maker.face(Carrier::Plane(first), true, vec![vec![(a, true)]]);
    let end = Axes::new(last.origin, &-Vector3::x(), Some(&Vector3::y())).expect("an axis");
    maker.face(Carrier::Plane(end), true, vec![vec![(b, last.z.x < 0.0)]]);
    maker.solid()
}

pub(crate) fn whole(carrier: Carrier) -> Brep {
    let mut maker = Maker::default();
    maker.face(carrier, true, vec![]);
    maker.solid()
}

/// A prism over a polygon, counter-clockwise and convex at its second point, up to a height.
pub(crate) fn prism(points: &[[f64; 2]], height_m: f64) -> Brep {
    let mut maker = walls(points, height_m);
    let level = |z: f64| points.iter().map(move |p| [p[0], p[1], z]);
    let mut floor: Vec<[f64; 3]> = level(0.0).collect();
    floor.reverse();
    // So that it begins around the second point as well.
    let turn = floor.len() - 3;
    floor.rotate_left(turn);
    maker.polygon(&floor, vec![]);
    maker.polygon(&level(height_m).collect::<Vec<_>>(), vec![]);
    maker.solid()
}

/// The walls of a prism, and nothing else.
pub(crate) fn walls(points: &[[f64; 2]], height_m: f64) -> Maker {
    let mut maker = Maker::default();
    let n = points.len();
    for k in 0..n {
        let [a, b] = [points[k], points[(k + 1) % n]];
        let at = |p: [f64; 2], z: f64| [p[0], p[1], z];
        let wall = [at(a, 0.0), at(b, 0.0), at(b, height_m), at(a, height_m)];
        maker.polygon(&wall, vec![]);
    }
    maker
}

/// An upright cylinder on z = 0.
pub(crate) fn cylinder(radius_m: f64, height_m: f64) -> Brep {
    let mut maker = Maker::default();
    let frame = |z: f64| axes([0.0, 0.0, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let low = maker.circle(frame(0.0), radius_m);
    let high = maker.circle(frame(height_m), radius_m);
    let seam = maker.line([radius_m, 0.0, 0.0], [radius_m, 0.0, height_m]);
    let back = (seam.0, !seam.1);
    let around = Carrier::Cylinder {
        axes: frame(0.0),
        radius_m,
    };
    maker.face(
        around,
        true,
        vec![vec![(low, true), seam, (high, false), back]],
    );
    let floor = axes([0.0; 3], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    maker.face(Carrier::Plane(floor), true, vec![vec![(low, false)]]);
    maker.face(
        Carrier::Plane(frame(height_m)),
        true,
        vec![vec![(high, true)]],
    );
    maker.solid()
}

/// A box around z from 0 up, its upright edges rounded: half its width and depth, the radius, its height, m.
pub(crate) fn rounded(half_m: [f64; 2], radius_m: f64, height_m: f64) -> Brep {
    let mut maker = Maker::default();
    let signs = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let centres = signs.map(|s| [0, 1].map(|k| s[k] * (half_m[k] - radius_m)));
    // Each corner from its first point to its last, the other way round from one to the next.
    let ends = [0, 1, 2, 3].map(|k| {
        let [x, y] = centres[k];
        let [a, b] = signs[k];
        let (side, front) = ([x + a * radius_m, y], [x, y + b * radius_m]);
        if a * b > 0.0 {
            [side, front]
        } else {
            [front, side]
        }
    });
    let at = |p: [f64; 2], z: f64| [p[0], p[1], z];
    let mut arcs = [[0; 2]; 4];
    for (k, z) in [(0, 0.0), (1, height_m)] {
        for c in 0..4 {
            let frame = axes(at(centres[c], z), [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
            let ends = ends[c].map(|p| maker.vertex(at(p, z)));
            let curve = BrepCurve::Circle {
                axes: frame,
                radius_m,
            };
            arcs[c][k] = maker.edge(curve, ends);
        }
    }
    let mut rims = [Vec::new(), Vec::new()];
    for c in 0..4 {
        let [from, to] = ends[c];
        let next = ends[(c + 1) % 4][0];
        let around = Carrier::Cylinder {
            axes: axes(at(centres[c], 0.0), [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
            radius_m,
        };
        let up = maker.line(at(to, 0.0), at(to, height_m));
        let down = maker.line(at(from, height_m), at(from, 0.0));
        let uses = vec![(arcs[c][0], true), up, (arcs[c][1], false), down];
        maker.face(around, true, vec![uses]);
        let wall = [
            at(to, 0.0),
            at(next, 0.0),
            at(next, height_m),
            at(to, height_m),
        ];
        maker.polygon(&wall, vec![]);
        for (k, z) in [(0, 0.0), (1, height_m)] {
            rims[k].push((arcs[c][k], true));
            rims[k].push(maker.line(at(to, z), at(next, z)));
        }
    }
    let [low, high] = rims;
    let low = low
        .into_iter()
        .rev()
        .map(|(e, along)| (e, !along))
        .collect();
    let floor = axes([0.0; 3], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    maker.face(Carrier::Plane(floor), true, vec![low]);
    let top = axes([0.0, 0.0, height_m], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    maker.face(Carrier::Plane(top), true, vec![high]);
    maker.solid()
}
