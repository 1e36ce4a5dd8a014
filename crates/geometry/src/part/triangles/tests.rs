//! Small parts made by hand: closed meshes, volumes, normals.

use super::super::{
    Axes, Brep, BrepBound, BrepCurve, BrepEdge, BrepFace, BrepShell, Carrier, Part, Placing,
};
use super::{PartMesh, TrianglesError};
use crate::basis::KnotVector;
use crate::math::{Point3, Random, Vector3};
use crate::surface::{ControlNet, Surface};
use std::collections::BTreeMap;
use std::f64::consts::PI;

const MOST: usize = 2_000_000;

/// Parts under construction.
#[derive(Default)]
struct Maker(Brep);

impl Maker {
    fn vertex(&mut self, x: f64, y: f64, z: f64) -> u32 {
        self.0.vertices.push(Point3::new(x, y, z));
        self.0.vertices.len() as u32 - 1
    }

    fn edge(&mut self, curve: BrepCurve, ends: [u32; 2]) -> u32 {
        let id = self.0.edges.len() as u64 + 100;
        self.0.edges.push(BrepEdge {
            id,
            curve,
            ends,
            along: true,
        });
        self.0.edges.len() as u32 - 1
    }

    fn line(&mut self, ends: [u32; 2]) -> u32 {
        let [a, b] = ends.map(|v| self.0.vertices[v as usize]);
        let curve = BrepCurve::Line {
            origin: a,
            direction: (b - a).normalize(),
        };
        self.edge(curve, ends)
    }

    /// A whole circle about z through its vertex.
    fn circle(&mut self, centre: [f64; 3], radius_m: f64, turn: f64) -> u32 {
        let (sin, cos) = libm::sincos(turn);
        let [x, y, z] = centre;
        let v = self.vertex(x + radius_m * cos, y + radius_m * sin, z);
        let axes = axes(centre, Vector3::z());
        self.edge(BrepCurve::Circle { axes, radius_m }, [v, v])
    }

    fn face(&mut self, carrier: Carrier, same_sense: bool, bounds: Vec<BrepBound>) {
        let id = self.0.faces.len() as u64 + 1;
        self.0.faces.push(BrepFace {
            id,
            carrier,
            same_sense,
            bounds,
        });
    }

    fn done(mut self) -> Brep {
        self.0.shells.push(BrepShell {
            faces: (0..self.0.faces.len() as u32).collect(),
            closed: true,
            solid: Some(0),
        });
        self.0
    }
}

fn axes(origin: [f64; 3], z: Vector3) -> Axes {
    Axes::new(Point3::from(origin), &z, Some(&Vector3::x())).unwrap()
}

fn around(uses: &[(u32, bool)]) -> BrepBound {
    BrepBound::Loop(uses.to_vec())
}

/// A box from −half to half; the top and the bottom with round holes of a radius about z where there is one.
fn block(half: f64, hole: Option<f64>) -> Brep {
    let mut m = Maker::default();
    let v: Vec<u32> = (0..8)
        .map(|k| {
            let at = |bit: u32| if k >> bit & 1 == 1 { half } else { -half };
            m.vertex(at(0), at(1), at(2))
        })
        .collect();
    let rings = hole.map(|r| [-half, half].map(|z| m.circle([0.0, 0.0, z], r, 0.3)));
    let mut edges: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    // Corners counter-clockwise seen from outside, and the normal.
    let sides = [
        ([0, 2, 3, 1], -Vector3::z()),
        ([4, 5, 7, 6], Vector3::z()),
        ([0, 1, 5, 4], -Vector3::y()),
        ([2, 6, 7, 3], Vector3::y()),
        ([0, 4, 6, 2], -Vector3::x()),
        ([1, 3, 7, 5], Vector3::x()),
    ];
    for (k, (corners, normal)) in sides.into_iter().enumerate() {
        let mut uses = Vec::new();
        for i in 0..4 {
            let (a, b) = (v[corners[i]], v[corners[(i + 1) % 4]]);
            let key = (a.min(b), a.max(b));
            let e = *edges.entry(key).or_insert_with(|| m.line([key.0, key.1]));
            uses.push((e, a < b));
        }
        let mut bounds = vec![BrepBound::Loop(uses)];
        if let (Some(rings), 0 | 1) = (rings, k) {
            bounds.push(around(&[(rings[k], k == 0)]));
        }
        let origin = Point3::from(normal * half);
        // Every other plane lies the other way round.
        let same = k % 2 == 0;
        let axis = if same { normal } else { -normal };
        let carrier = Carrier::Plane(Axes::new(origin, &axis, None).unwrap());
        m.face(carrier, same, bounds);
    }
    if let (Some(rings), Some(radius_m)) = (rings, hole) {
        let carrier = Carrier::Cylinder {
            axes: axes([0.0; 3], Vector3::z()),
            radius_m,
        };
        let bounds = vec![around(&[(rings[0], false)]), around(&[(rings[1], true)])];
        m.face(carrier, false, bounds);
    }
    m.done()
}

fn plane(z: f64, up: bool) -> Carrier {
    let normal = if up { Vector3::z() } else { -Vector3::z() };
    Carrier::Plane(axes([0.0, 0.0, z], normal))
}

/// Two circles and, if asked for, a seam between them.
fn cylinder(radius_m: f64, height: f64, seam: bool, turn: f64) -> Brep {
    let mut m = Maker::default();
    let low = m.circle([0.0; 3], radius_m, 0.0);
    let high = m.circle([0.0, 0.0, height], radius_m, turn);
    let carrier = Carrier::Cylinder {
        axes: axes([0.0; 3], Vector3::z()),
        radius_m,
    };
    let bounds = if seam {
        let line = m.line([0, 1]);
        vec![around(&[
            (low, true),
            (line, true),
            (high, false),
            (line, false),
        ])]
    } else {
        vec![around(&[(low, true)]), around(&[(high, false)])]
    };
    m.face(carrier, true, bounds);
    m.face(plane(0.0, false), true, vec![around(&[(low, false)])]);
    m.face(plane(height, true), true, vec![around(&[(high, true)])]);
    m.done()
}

fn sphere(radius_m: f64) -> Brep {
    let mut m = Maker::default();
    let v = m.vertex(0.0, 0.0, radius_m);
    let carrier = Carrier::Sphere {
        axes: axes([0.0; 3], Vector3::z()),
        radius_m,
    };
    m.face(carrier, true, vec![BrepBound::Vertex(v)]);
    m.done()
}

/// Half of it; `upright`: its poles are on the rim.
fn half_sphere(radius_m: f64, upright: bool) -> Brep {
    let mut m = Maker::default();
    let rim = m.circle([0.0; 3], radius_m, 0.0);
    let axis = if upright { Vector3::y() } else { Vector3::z() };
    let carrier = Carrier::Sphere {
        axes: axes([0.0; 3], axis),
        radius_m,
    };
    m.face(carrier, true, vec![around(&[(rim, true)])]);
    m.face(plane(0.0, false), true, vec![around(&[(rim, false)])]);
    m.done()
}

fn cone(radius_m: f64, height: f64) -> Brep {
    let mut m = Maker::default();
    let rim = m.circle([0.0, 0.0, -height], radius_m, 0.0);
    let apex = m.vertex(0.0, 0.0, 0.0);
    let carrier = Carrier::Cone {
        axes: axes([0.0; 3], -Vector3::z()),
        half_angle_rad: libm::atan2(radius_m, height),
    };
    let bounds = vec![around(&[(rim, true)]), BrepBound::Vertex(apex)];
    m.face(carrier, true, bounds);
    m.face(plane(-height, false), true, vec![around(&[(rim, false)])]);
    m.done()
}

/// Half a cone: its edges end at the apex.
fn half_cone(radius_m: f64, height: f64) -> Brep {
    let mut m = Maker::default();
    let [a, b] = [radius_m, -radius_m].map(|x| m.vertex(x, 0.0, -height));
    let apex = m.vertex(0.0, 0.0, 0.0);
    let arc = BrepCurve::Circle {
        axes: axes([0.0, 0.0, -height], Vector3::z()),
        radius_m,
    };
    let arc = m.edge(arc, [a, b]);
    let [up, down, base] = [[b, apex], [apex, a], [b, a]].map(|ends| m.line(ends));
    let carrier = Carrier::Cone {
        axes: axes([0.0; 3], -Vector3::z()),
        half_angle_rad: libm::atan2(radius_m, height),
    };
    let round = around(&[(arc, true), (up, true), (down, true)]);
    m.face(carrier, true, vec![round]);
    m.face(
        plane(-height, false),
        true,
        vec![around(&[(base, false), (arc, false)])],
    );
    let wall = Carrier::Plane(axes([0.0; 3], -Vector3::y()));
    let bounds = around(&[(base, true), (down, false), (up, false)]);
    m.face(wall, true, vec![bounds]);
    m.done()
}

fn torus(major_m: f64, minor_m: f64) -> Brep {
    let mut m = Maker::default();
    let carrier = Carrier::Torus {
        axes: axes([0.0; 3], Vector3::z()),
        major_m,
        minor_m,
    };
    m.face(carrier, true, Vec::new());
    m.done()
}

/// A quarter of a turn of one, between two discs.
fn bend(major_m: f64, minor_m: f64) -> Brep {
    let mut m = Maker::default();
    let mut rim = |at: [f64; 3], z: Vector3| {
        let v = m.vertex(at[0], at[1], at[2] + minor_m);
        let axes = Axes::new(Point3::from(at), &z, Some(&Vector3::z())).unwrap();
        let curve = BrepCurve::Circle {
            axes,
            radius_m: minor_m,
        };
        (axes, m.edge(curve, [v, v]))
    };
    let (first, a) = rim([major_m, 0.0, 0.0], -Vector3::y());
    let (last, b) = rim([0.0, major_m, 0.0], -Vector3::x());
    let carrier = Carrier::Torus {
        axes: axes([0.0; 3], Vector3::z()),
        major_m,
        minor_m,
    };
    let bounds = vec![around(&[(a, false)]), around(&[(b, false)])];
    m.face(carrier, true, bounds);
    m.face(Carrier::Plane(first), true, vec![around(&[(a, true)])]);
    m.face(Carrier::Plane(last), true, vec![around(&[(b, true)])]);
    m.done()
}

/// The upper half of one, on a ring.
fn half_torus(major_m: f64, minor_m: f64) -> Brep {
    let mut m = Maker::default();
    let outer = m.circle([0.0; 3], major_m + minor_m, 0.2);
    let inner = m.circle([0.0; 3], major_m - minor_m, 0.9);
    let carrier = Carrier::Torus {
        axes: axes([0.0; 3], Vector3::z()),
        major_m,
        minor_m,
    };
    let rims = |along: bool| vec![around(&[(outer, along)]), around(&[(inner, !along)])];
    m.face(carrier, true, rims(true));
    m.face(plane(0.0, false), true, rims(false));
    m.done()
}

/// A cylinder as a B-spline that closes on itself; its circles begin at an angle from its seam.
fn spline_cylinder(radius_m: f64, height: f64, turn: f64) -> Brep {
    let mut brep = cylinder(radius_m, height, false, 0.0);
    let w = std::f64::consts::FRAC_1_SQRT_2;
    let ring = [
        [1, 0],
        [1, 1],
        [0, 1],
        [-1, 1],
        [-1, 0],
        [-1, -1],
        [0, -1],
        [1, -1],
        [1, 0],
    ];
    let mut points = Vec::new();
    let mut weights = Vec::new();
    for (k, [x, y]) in ring.map(|p| p.map(f64::from)).into_iter().enumerate() {
        for z in [0.0, height] {
            points.push(Point3::new(radius_m * x, radius_m * y, z));
            weights.push(if k % 2 == 1 { w } else { 1.0 });
        }
    }
    let knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4].map(f64::from).to_vec();
    let around = KnotVector::new(2, knots).unwrap();
    let along = KnotVector::clamped_uniform(1, 2).unwrap();
    let net = ControlNet::new(9, 2, points).unwrap();
    let surface = Surface::new(around, along, net, Some(weights)).unwrap();
    brep.faces[0].carrier = Carrier::Spline(Box::new(surface));
    for v in &mut brep.vertices {
        let (sin, cos) = libm::sincos(turn);
        (v.x, v.y) = (radius_m * cos, radius_m * sin);
    }
    brep
}

fn volume(mesh: &PartMesh) -> f64 {
    let p = |k: u32| mesh.mesh.points[k as usize].coords;
    let six = mesh
        .mesh
        .triangles
        .iter()
        .map(|t| p(t[0]).dot(&p(t[1]).cross(&p(t[2]))));
    six.sum::<f64>() / 6.0
}

/// Closed, of an Euler characteristic, near its carriers, normals outward.
fn check(brep: &Brep, mesh: &PartMesh, euler: i64, tolerance_m: f64, what: &str) {
    let mut sides: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for t in &mesh.mesh.triangles {
        for k in 0..3 {
            *sides.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    for (&(a, b), &count) in &sides {
        assert!(
            a != b && count == 1,
            "{what}: {a} {b} is used {count} times"
        );
        assert!(sides.contains_key(&(b, a)), "{what}: {a} {b} is open");
    }
    let found =
        mesh.mesh.points.len() as i64 - sides.len() as i64 / 2 + mesh.mesh.triangles.len() as i64;
    assert_eq!(found, euler, "{what}");
    assert!(
        mesh.deviation_m <= tolerance_m,
        "{what}: {}",
        mesh.deviation_m
    );
    for (t, &f) in mesh.mesh.triangles.iter().zip(&mesh.faces) {
        let [a, b, c] = t.map(|k| mesh.mesh.points[k as usize]);
        let middle = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let face = &brep.faces[f as usize];
        let normal = (b - a).cross(&(c - a));
        let Some(uv) = face.carrier.foot(&middle) else {
            continue;
        };
        let off = (face.carrier.point(uv) - middle).norm();
        assert!(off <= tolerance_m, "{what}: {off}");
        let outward = face.carrier.normal(uv) * if face.same_sense { 1.0 } else { -1.0 };
        assert!(normal.dot(&outward) > 0.0, "{what}: {normal:?} {outward:?}");
    }
}

fn shapes() -> Vec<(&'static str, Brep, i64, f64)> {
    vec![
        ("block", block(0.5, None), 2, 1.0),
        ("drilled", block(0.5, Some(0.3)), 0, 1.0 - PI * 0.09),
        ("cylinder", cylinder(0.5, 2.0, false, 1.0), 2, PI * 0.5),
        ("with a seam", cylinder(0.5, 2.0, true, 0.0), 2, PI * 0.5),
        ("disc", cylinder(0.5, 1e-3, false, 1.0), 2, PI * 0.25e-3),
        ("rod", cylinder(0.01, 2.0, false, 1.0), 2, PI * 2e-4),
        ("sphere", sphere(0.5), 2, PI / 6.0),
        ("half", half_sphere(0.5, false), 2, PI / 12.0),
        ("half through poles", half_sphere(0.5, true), 2, PI / 12.0),
        ("cone", cone(0.5, 1.0), 2, PI / 12.0),
        ("half cone", half_cone(0.5, 1.0), 2, PI / 24.0),
        ("torus", torus(0.5, 0.2), 0, 2.0 * PI * PI * 0.5 * 0.04),
        ("bend", bend(0.5, 0.2), 2, 0.5 * PI * PI * 0.5 * 0.04),
        ("half torus", half_torus(0.5, 0.2), 0, PI * PI * 0.5 * 0.04),
        ("spline", spline_cylinder(0.5, 2.0, 0.7), 2, PI * 0.5),
        (
            "spline from its seam",
            spline_cylinder(0.5, 2.0, 0.0),
            2,
            PI * 0.5,
        ),
        (
            "thin wall",
            block(0.5, Some(0.4995)),
            0,
            1.0 - PI * 0.4995 * 0.4995,
        ),
    ]
}

#[test]
fn closed_near_and_outward_in_any_pose() {
    let mut random = Random(7);
    for (name, brep, euler, exact) in shapes() {
        for pose in 0..4 {
            let placing = match pose {
                0 => Placing::default(),
                _ => Placing {
                    turn: *random.rotation().to_rotation_matrix().matrix(),
                    scale: 1.0,
                    shift: random.vector(),
                },
            };
            let placed = brep.placed(&placing).unwrap();
            let part = Part::new(&placed).unwrap_or_else(|e| panic!("{name}: {e}"));
            let fine = if pose == 0 { 3e-4 } else { 3e-3 };
            for tolerance_m in [3e-2, fine] {
                let what = format!("{name}, pose {pose}, {tolerance_m}");
                let mesh = part
                    .triangles(tolerance_m, MOST)
                    .unwrap_or_else(|e| panic!("{what}: {e}"));
                check(&placed, &mesh, euler, tolerance_m * (1.0 + 1e-9), &what);
                let area: f64 = 7.0;
                let off = (volume(&mesh) - exact).abs();
                assert!(
                    off <= area * tolerance_m,
                    "{what}: {} {exact}",
                    volume(&mesh)
                );
            }
        }
    }
}

#[test]
fn what_cannot_be_divided_is_said() {
    let part = Part::new(&sphere(0.5)).unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            part.triangles(bad, MOST),
            Err(TrianglesError::Tolerance(_))
        ));
    }
    for (name, brep, ..) in shapes() {
        let part = Part::new(&brep).unwrap();
        let few = part.triangles(1e-3, 5);
        assert_eq!(few, Err(TrianglesError::TooMany { most: 5 }), "{name}");
        if name != "block" {
            let fine = part.triangles(1e-300, 1000);
            assert_eq!(fine, Err(TrianglesError::TooMany { most: 1000 }), "{name}");
        }
    }
}

#[test]
fn loops_that_cross_are_an_error() {
    for radius in [0.5001, 0.6, 0.7] {
        let Ok(part) = Part::new(&block(0.5, Some(radius))) else {
            continue;
        };
        let found = part.triangles(1e-2, MOST);
        assert!(found.is_err(), "a hole of {radius} m");
    }
    // What lies between a block and a hole around it is a disc with a square hole, all faces turned.
    let part = Part::new(&block(0.5, Some(2.0))).unwrap();
    assert_eq!(part.turned_faces(), part.faces().len());
    let volume = part.measure().volume_m3.unwrap();
    assert!((volume - (4.0 * PI - 1.0)).abs() < 1e-12, "{volume}");
    assert!(part.triangles(1e-2, MOST).is_ok());
}
