//! Boundaries by hand, against closed forms and brute force.

mod senses;

use super::*;
use crate::math::{Matrix3, Point3, Random, Vector3};
use std::f64::consts::PI;

fn axes(origin: [f64; 3], z: [f64; 3], x: [f64; 3]) -> Axes {
    Axes::new(
        Point3::from(origin),
        &Vector3::from(z),
        Some(&Vector3::from(x)),
    )
    .expect("an axis")
}

/// Adds edges as they are asked for.
#[derive(Default)]
struct Maker(Brep);

impl Maker {
    fn vertex(&mut self, p: [f64; 3]) -> u32 {
        let p = Point3::from(p);
        let at = self.0.vertices.iter().position(|q| *q == p);
        at.unwrap_or_else(|| {
            self.0.vertices.push(p);
            self.0.vertices.len() - 1
        }) as u32
    }

    fn line(&mut self, a: [f64; 3], b: [f64; 3]) -> (u32, bool) {
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
    fn circle(&mut self, axes: Axes, radius_m: f64) -> u32 {
        let start = axes.to_world(&Vector3::new(radius_m, 0.0, 0.0));
        let v = self.vertex(start.into());
        self.edge(BrepCurve::Circle { axes, radius_m }, [v, v])
    }

    fn edge(&mut self, curve: BrepCurve, ends: [u32; 2]) -> u32 {
        let id = self.0.edges.len() as u64 + 100;
        self.0.edges.push(BrepEdge {
            id,
            curve,
            ends,
            along: true,
        });
        id as u32 - 100
    }

    fn face(&mut self, carrier: Carrier, same_sense: bool, loops: Vec<Vec<(u32, bool)>>) {
        let id = self.0.faces.len() as u64 + 1;
        let bounds = loops.into_iter().map(BrepBound::Loop).collect();
        self.0.faces.push(BrepFace {
            id,
            carrier,
            same_sense,
            bounds,
        });
    }

    fn polygon(&mut self, points: &[[f64; 3]], more: Vec<Vec<(u32, bool)>>) {
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

    fn solid(mut self) -> Brep {
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
fn drilled() -> Brep {
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
fn cone() -> Brep {
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
fn dome() -> Brep {
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
fn bend() -> Brep {
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

fn whole(carrier: Carrier) -> Brep {
    let mut maker = Maker::default();
    maker.face(carrier, true, vec![]);
    maker.solid()
}

#[test]
fn areas_and_volumes_are_those_of_closed_forms() {
    let frame = axes([0.01, 0.02, 0.03], [1.0, 2.0, 3.0], [1.0, 0.0, 0.0]);
    let r = 0.008;
    let cases = [
        (
            "drilled",
            drilled(),
            0.06 * 0.04 * 0.02 - PI * r * r * 0.02,
            2.0 * (0.0024 - PI * r * r) + 0.2 * 0.02 + 2.0 * PI * r * 0.02,
        ),
        (
            "cone",
            cone(),
            PI * 1e-6 / 3.0,
            PI * 1e-4 * (1.0 + 2f64.sqrt()),
        ),
        ("dome", dome(), 2.0 / 3.0 * PI * 1e-6, 3.0 * PI * 1e-4),
        (
            "bend",
            bend(),
            0.25 * 2.0 * PI * PI * 0.02 * 25e-6,
            PI * PI * 0.02 * 0.005 + 2.0 * PI * 25e-6,
        ),
        (
            "ball",
            whole(Carrier::Sphere {
                axes: frame,
                radius_m: 0.01,
            }),
            4.0 / 3.0 * PI * 1e-6,
            4.0 * PI * 1e-4,
        ),
        (
            "apple",
            whole(Carrier::Torus {
                axes: frame,
                major_m: 0.01,
                minor_m: 0.02,
            }),
            2.0 * PI / 3.0 * 9e-4 * 3e-4f64.sqrt() + 2.0 * PI * 4e-6 * (PI - 0.5f64.acos()),
            4.0 * PI * 0.02 * (3e-4f64.sqrt() + 0.01 * (PI - 0.5f64.acos())),
        ),
        (
            "ring",
            whole(Carrier::Torus {
                axes: frame,
                major_m: 0.02,
                minor_m: 0.005,
            }),
            2.0 * PI * PI * 0.02 * 25e-6,
            4.0 * PI * PI * 0.02 * 0.005,
        ),
    ];
    let mut random = Random(45);
    for (name, brep, volume, area) in cases {
        for turn in 0..8 {
            let rotation = random.rotation().to_rotation_matrix().into_inner();
            let mirror = if turn % 2 == 1 {
                Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0))
            } else {
                Matrix3::identity()
            };
            let placing = Placing {
                turn: rotation * mirror,
                scale: 1.0 + f64::from(turn),
                shift: random.vector() * 0.1,
            };
            let part = Part::new(&brep.placed(&placing).expect("in range"))
                .unwrap_or_else(|e| panic!("{name}: {e}"));
            let s = placing.scale;
            let measure = part.measure();
            let off = (measure.area_m2 / (area * s * s) - 1.0).abs();
            assert!(off < 1e-12, "{name}, {turn}: area off by {off:e}");
            let off = (measure.volume_m3.expect("closed") / (volume * s * s * s) - 1.0).abs();
            assert!(off < 1e-11, "{name}, {turn}: volume off by {off:e}");
            assert!(part.gap_m() < 1e-15 * s, "{name}: {:e}", part.gap_m());
        }
    }
}

/// Signed distances of the shapes above.
fn distance(name: &str, p: &Point3) -> f64 {
    let rho = p.x.hypot(p.y);
    match name {
        "drilled" => {
            let slab = |x: f64, w: f64| (x - 0.5 * w).abs() - 0.5 * w;
            let (a, b, c) = (slab(p.x, 0.06), slab(p.y, 0.04), slab(p.z, 0.02));
            let hole = 0.008 - (p.x - 0.03).hypot(p.y - 0.02);
            // Inside the hole: to its wall, or to the circle at its end.
            if hole > 0.0 {
                return hole.hypot(c.max(0.0));
            }
            let outside = Vector3::new(a.max(0.0), b.max(0.0), c.max(0.0)).norm();
            if outside > 0.0 {
                outside
            } else {
                a.max(b).max(c).max(hole)
            }
        }
        "dome" => {
            if p.z >= 0.0 {
                (p.coords.norm() - 0.01).max(-p.z)
            } else if rho <= 0.01 {
                -p.z
            } else {
                (rho - 0.01).hypot(p.z)
            }
        }
        "cone" => {
            let (side, t) = (
                (rho + p.z - 0.01) / 2f64.sqrt(),
                (rho - p.z + 0.01) / 2f64.sqrt(),
            );
            if p.z >= 0.0 && rho + p.z <= 0.01 {
                return (-p.z).max(side);
            }
            let length = 0.01 * 2f64.sqrt();
            let slant = side.hypot((-t).max(t - length).max(0.0));
            let base = p.z.hypot((rho - 0.01).max(0.0));
            slant.min(base)
        }
        _ => unreachable!("{name}"),
    }
}

#[test]
fn distances_and_signs_are_those_of_closed_forms() {
    let mut random = Random(46);
    for (name, brep) in [("drilled", drilled()), ("dome", dome()), ("cone", cone())] {
        let placing = Placing {
            turn: random.rotation().to_rotation_matrix().into_inner(),
            scale: 1.0,
            shift: random.vector() * 0.05,
        };
        let part = Part::new(&brep.placed(&placing).expect("in range")).expect("a part");
        let mut solver = PartSolver::new(&part);
        let mut worst = 0.0f64;
        for k in 0..20_000 {
            let p = Point3::from(random.vector().map(|x| x * 0.06));
            let q = placing.point(&p);
            let foot = solver.closest(&part, &q).expect("finite");
            let right = distance(name, &p);
            let off = (foot.signed_distance.expect("closed") - right).abs();
            assert!(off < 1e-14, "{name} {k}: {foot:?} at {p}, right {right}");
            worst = worst.max(off);
        }
        println!("{name}: off by {worst:.1e} m at most");
    }
}
