//! Faces, loops and shells that are the wrong way round, against the same parts as they should be.

use super::*;

/// A box, from one corner to the opposite one.
fn cuboid([x0, y0, z0]: [f64; 3], [x1, y1, z1]: [f64; 3]) -> Brep {
    let mut maker = Maker::default();
    let [a, b, c, d] = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    let at = |[x, y]: [f64; 2], z: f64| [x, y, z];
    maker.polygon(&[at(a, z0), at(d, z0), at(c, z0), at(b, z0)], vec![]);
    maker.polygon(&[at(a, z1), at(b, z1), at(c, z1), at(d, z1)], vec![]);
    for [p, q] in [[a, b], [b, c], [c, d], [d, a]] {
        maker.polygon(&[at(p, z0), at(q, z0), at(q, z1), at(p, z1)], vec![]);
    }
    maker.solid()
}

/// 16 mm long, of radius 5 mm, with a seam.
fn cylinder() -> Brep {
    let mut maker = Maker::default();
    let (r, h) = (0.005, 0.016);
    let at = |z: f64| axes([0.0, 0.0, z], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let [low, high] = [0.0, h].map(|z| maker.circle(at(z), r));
    let seam = maker.line([r, 0.0, 0.0], [r, 0.0, h]);
    let side = Carrier::Cylinder {
        axes: at(0.0),
        radius_m: r,
    };
    let back = (seam.0, !seam.1);
    let walk = vec![(low, true), seam, (high, false), back];
    maker.face(side, true, vec![walk]);
    maker.face(Carrier::Plane(at(0.0)), false, vec![vec![(low, false)]]);
    maker.face(Carrier::Plane(at(h)), true, vec![vec![(high, true)]]);
    maker.solid()
}

fn ball(radius_m: f64) -> Brep {
    whole(Carrier::Sphere {
        axes: axes([0.001, 0.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 0.0]),
        radius_m,
    })
}

fn ring() -> Brep {
    whole(Carrier::Torus {
        axes: axes([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        major_m: 0.02,
        minor_m: 0.005,
    })
}

/// A slab, 21 × 21 × 2 mm, with a half ball of 10 mm on it.
fn bump() -> Brep {
    let w = 0.0105;
    let mut maker = Maker(cuboid([-w, -w, -0.002], [w, w, 0.0]));
    let frame = axes([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let rim = maker.circle(frame, 0.01);
    maker.0.faces[1]
        .bounds
        .push(BrepBound::Loop(vec![(rim, false)]));
    let sphere = Carrier::Sphere {
        axes: frame,
        radius_m: 0.01,
    };
    maker.face(sphere, true, vec![vec![(rim, true)]]);
    maker.solid()
}

/// The second one is a void of the first one.
fn hollow(outer: &Brep, void: &Brep) -> Brep {
    let mut both = outer.clone();
    let first = both.faces.len();
    both.add(void.clone());
    both.shells[1].solid = Some(0);
    for face in &mut both.faces[first..] {
        turn(face);
    }
    both
}

fn turn_loops(face: &mut BrepFace) {
    for bound in &mut face.bounds {
        if let BrepBound::Loop(uses) = bound {
            uses.reverse();
            uses.iter_mut()
                .for_each(|(_, forward)| *forward = !*forward);
        }
    }
}

fn turn(face: &mut BrepFace) {
    face.same_sense = !face.same_sense;
    turn_loops(face);
}

fn placed(brep: &Brep, random: &mut Random) -> Brep {
    let placing = Placing {
        turn: random.rotation().to_rotation_matrix().into_inner(),
        scale: 1.0,
        shift: random.vector() * 0.05,
    };
    brep.placed(&placing).expect("in range")
}

/// Same answers, to the bit but for the order in which sums are taken.
fn assert_same(name: &str, one: &Part, other: &Part, random: &mut Random) {
    assert!(one.is_closed() && other.is_closed(), "{name}");
    let [a, b] = [one, other].map(|part| part.measure().volume_m3.expect("closed"));
    assert!((a / b - 1.0).abs() < 1e-14, "{name}: {a} and {b}");
    let mut solvers = [one, other].map(PartSolver::new);
    let (low, high) = one.bounds();
    for _ in 0..200 {
        let share = random.vector().map(|x| 0.5 + x);
        let q = low + (high - low).component_mul(&share);
        let [a, b] = &mut solvers;
        let (a, mut b) = (a.closest(one, &q), b.closest(other, &q));
        if let (Some(a), Some(b)) = (&a, &mut b) {
            assert!((a.normal - b.normal).norm() < 1e-13, "{name}: {a:?}, {b:?}");
            // A vertex names one of its faces, the last that comes to it.
            (b.normal, b.face, b.place) = (a.normal, a.face, a.place);
        }
        assert_eq!(a, b, "{name} at {q}");
    }
}

fn all() -> [(&'static str, Brep, f64); 10] {
    let wall = ball(0.004);
    let hollow_volume = 0.03 * 0.02 * 0.02 - 4.0 / 3.0 * PI * 64e-9;
    let outer = cuboid([-0.01; 3], [0.02, 0.01, 0.01]);
    [
        ("box", cuboid([0.0; 3], [0.01, 0.02, 0.03]), 6e-6),
        ("cylinder", cylinder(), PI * 25e-6 * 0.016),
        ("drilled", drilled(), 48e-6 - PI * 64e-6 * 0.02),
        ("cone", cone(), PI * 1e-6 / 3.0),
        ("dome", dome(), 2.0 / 3.0 * PI * 1e-6),
        ("bend", bend(), 0.25 * 2.0 * PI * PI * 0.02 * 25e-6),
        ("ball", ball(0.01), 4.0 / 3.0 * PI * 1e-6),
        ("ring", ring(), 2.0 * PI * PI * 0.02 * 25e-6),
        ("bump", bump(), 0.882e-6 + 2.0 / 3.0 * PI * 1e-6),
        ("hollow", hollow(&outer, &wall), hollow_volume),
    ]
}

#[test]
fn parts_with_turned_faces_are_as_they_should_be() {
    let mut random = Random(451);
    for (name, brep, volume_m3) in all() {
        for _ in 0..6 {
            let brep = placed(&brep, &mut random);
            let part = Part::new(&brep).expect("a part");
            assert_eq!(*part.senses(), Senses::default(), "{name}");
            let off = part.measure().volume_m3.expect("closed") / volume_m3 - 1.0;
            assert!(off.abs() < 1e-11, "{name}: {off:e}");
            // One face.
            let k = random.below(brep.faces.len());
            let mut one = brep.clone();
            turn(&mut one.faces[k]);
            let made = Part::new(&one).expect("a part");
            assert_eq!(made.senses().turned, [brep.faces[k].id], "{name}");
            assert!(made.senses().notes()[0].contains("1 (#"), "{name}");
            assert_same(name, &part, &made, &mut random);
            // Half of them.
            let mut some = brep.clone();
            let mut turned = Vec::new();
            for face in &mut some.faces {
                if random.unit() < 0.5 {
                    turn(face);
                    turned.push(face.id);
                }
            }
            let made = Part::new(&some).expect("a part");
            assert_eq!(made.senses().turned, turned, "{name}");
            assert_same(name, &part, &made, &mut random);
            // All of them.
            let mut every = brep.clone();
            every.faces.iter_mut().for_each(turn);
            let made = Part::new(&every).expect("a part");
            assert_eq!(made.turned_faces(), brep.faces.len(), "{name}");
            assert_eq!(made.senses().inside_out, brep.shells.len(), "{name}");
            assert_same(name, &part, &made, &mut random);
        }
    }
}

// Where the carrier goes on without end, only one side of a loop can be the face.
#[test]
fn senses_and_loops_that_contradict_each_other_are_turned_too() {
    let mut random = Random(452);
    let flat = ["box", "cylinder", "drilled", "cone"];
    for (name, brep, _) in all().into_iter().filter(|(name, ..)| flat.contains(name)) {
        for _ in 0..6 {
            let brep = placed(&brep, &mut random);
            let part = Part::new(&brep).expect("a part");
            let k = random.below(brep.faces.len());
            let mut sense = brep.clone();
            sense.faces[k].same_sense = !sense.faces[k].same_sense;
            let mut loops = brep.clone();
            turn_loops(&mut loops.faces[k]);
            let mut every = brep.clone();
            every.faces.iter_mut().for_each(turn_loops);
            for (wrong, turned) in [(sense, 1), (loops, 1), (every, brep.faces.len())] {
                let made = Part::new(&wrong).unwrap_or_else(|e| panic!("{name}: {e}"));
                assert_eq!(made.turned_faces(), turned, "{name}");
                assert_same(name, &part, &made, &mut random);
            }
        }
    }
}

#[test]
fn voids_are_outside_whichever_way_the_file_has_them() {
    let mut random = Random(453);
    let outer = cuboid([-0.02; 3], [0.02; 3]);
    for void in [ball(0.01), cylinder(), ring_in(0.012)] {
        let right = hollow(&outer, &void);
        let part = Part::new(&right).expect("a part");
        assert_eq!(part.turned_faces(), 0);
        let mut wrong = right.clone();
        wrong.faces[6..].iter_mut().for_each(turn);
        let made = Part::new(&wrong).expect("a part");
        assert_eq!(made.turned_faces(), void.faces.len());
        assert_eq!(made.senses().inside_out, 1);
        assert_same("hollow", &part, &made, &mut random);
        let mut solver = PartSolver::new(&made);
        let signed = |solver: &mut PartSolver, p: [f64; 3]| {
            let foot = solver.closest(&made, &Point3::from(p)).expect("finite");
            foot.signed_distance.expect("closed")
        };
        assert!(signed(&mut solver, [0.0, 0.0, 0.03]) > 0.0);
        assert!(signed(&mut solver, [0.0195, 0.0195, 0.0]) < 0.0);
        // A solid in a void, as another shell of the solid.
        let mut twice = wrong.clone();
        let core = whole(Carrier::Sphere {
            axes: axes([0.0, 0.0, 0.008], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
            radius_m: 1e-4,
        });
        twice.add(core);
        twice.shells[2].solid = Some(0);
        let made = Part::new(&twice).expect("a part");
        let inside =
            void.faces.len() == 1 && matches!(void.faces[0].carrier, Carrier::Torus { .. });
        // The hole of the ring is matter: there, the third shell is a void that is the wrong way round.
        let more = usize::from(inside);
        assert_eq!(made.senses().inside_out, 1 + more);
        assert!(made.is_closed() == inside, "{:?}", made.senses());
    }
    // A void beside the solid.
    let beside = whole(Carrier::Sphere {
        axes: axes([0.05, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        radius_m: 0.01,
    });
    let made = Part::new(&hollow(&outer, &beside)).expect("a part");
    let [problem @ SenseProblem::Outside { .. }] = made.senses().problems.as_slice() else {
        panic!("{:?}", made.senses());
    };
    assert!(problem.to_string().contains("should be a void"));
    assert!(!made.is_closed() && made.measure().volume_m3.is_none());
}

fn ring_in(major_m: f64) -> Brep {
    whole(Carrier::Torus {
        axes: axes([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]),
        major_m,
        minor_m: 0.003,
    })
}

fn triangles(points: &[[f64; 3]], all: &[[usize; 3]]) -> Brep {
    let mut maker = Maker::default();
    for corners in all {
        maker.polygon(&corners.map(|k| points[k - 1]), vec![]);
    }
    maker.solid()
}

fn assert_no_inside(part: &Part) -> String {
    assert!(!part.is_closed() && part.measure().volume_m3.is_none());
    let q = Point3::new(0.001, 0.002, 0.003);
    let foot = PartSolver::new(part).closest(part, &q).expect("finite");
    assert_eq!(foot.signed_distance, None);
    part.senses().notes().join("\n")
}

#[test]
fn what_has_no_side_has_no_inside() {
    let mut random = Random(454);
    let points: Vec<[f64; 3]> = (0..6).map(|_| (random.vector() * 0.01).into()).collect();
    // The projective plane of six vertices: every edge joins two faces, and it has one side only.
    let projective = [
        [1, 2, 5],
        [1, 2, 6],
        [1, 3, 4],
        [1, 3, 6],
        [1, 4, 5],
        [2, 3, 4],
        [2, 3, 5],
        [2, 4, 6],
        [3, 5, 6],
        [4, 5, 6],
    ];
    let part = Part::new(&triangles(&points, &projective)).expect("a part");
    assert_eq!(part.turned_faces(), 0);
    let note = assert_no_inside(&part);
    assert!(note.contains("no common side"), "{note}");
    // Möbius' band of five triangles, as a sheet.
    let band: Vec<[usize; 3]> = (0..5)
        .map(|k| [k, k + 1, k + 2].map(|v| v % 5 + 1))
        .collect();
    let mut sheet = triangles(&points, &band);
    sheet.shells[0].closed = false;
    sheet.shells[0].solid = None;
    let note = assert_no_inside(&Part::new(&sheet).expect("a part"));
    assert!(note.contains("no common side"), "{note}");
    // A wall through a box: three faces at its edges.
    let mut maker = Maker(cuboid([0.0; 3], [0.01; 3]));
    maker.0.faces.clear();
    let half = |x0: f64, x1: f64, maker: &mut Maker| {
        let [a, b, c, d] = [[x0, 0.0], [x1, 0.0], [x1, 0.01], [x0, 0.01]];
        let at = |[x, y]: [f64; 2], z: f64| [x, y, z];
        maker.polygon(&[at(a, 0.0), at(d, 0.0), at(c, 0.0), at(b, 0.0)], vec![]);
        maker.polygon(
            &[at(a, 0.01), at(b, 0.01), at(c, 0.01), at(d, 0.01)],
            vec![],
        );
        let end = if x0 == 0.0 { [d, a] } else { [b, c] };
        for [p, q] in [[a, b], [c, d], end] {
            maker.polygon(&[at(p, 0.0), at(q, 0.0), at(q, 0.01), at(p, 0.01)], vec![]);
        }
    };
    half(0.0, 0.004, &mut maker);
    half(0.004, 0.01, &mut maker);
    let wall = [[0.0, 0.0], [0.01, 0.0], [0.01, 0.01], [0.0, 0.01]];
    maker.polygon(&wall.map(|[y, z]| [0.004, y, z]), vec![]);
    let note = assert_no_inside(&Part::new(&maker.solid()).expect("a part"));
    assert!(
        note.contains(": 4, first #") && note.contains("3 faces meet"),
        "{note}"
    );
    // A face is missing: the rest agrees, and is open.
    let mut open = cuboid([0.0; 3], [0.01; 3]);
    open.faces.remove(2);
    open.shells[0].faces.pop();
    turn(&mut open.faces[1]);
    let part = Part::new(&open).expect("a part");
    assert_eq!(part.senses().turned, [2]);
    let note = assert_no_inside(&part);
    assert!(note.contains("belong to one face only: 4"), "{note}");
}

// On a sphere both sides of a loop are bounded. Taken at its word, this one goes through the slab and out below.
#[test]
fn shells_that_are_inside_out_from_some_sides_have_no_inside() {
    let mut random = Random(455);
    for _ in 0..6 {
        let mut brep = placed(&bump(), &mut random);
        brep.faces[6].same_sense = false;
        let part = Part::new(&brep).expect("a part");
        let note = assert_no_inside(&part);
        assert!(note.contains("from some sides only"), "{note}");
    }
}

// The hole is a hundred-thousandth of the plate.
#[test]
fn small_holes_that_are_walked_the_wrong_way_are_refused() {
    let mut random = Random(456);
    let mut maker = Maker(cuboid([0.0; 3], [0.1, 0.1, 0.01]));
    let frame = axes([0.05, 0.05, 0.01], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let rim = maker.circle(frame, 1e-6);
    let face = |forward: bool| {
        let mut brep = maker.0.clone();
        brep.faces[1]
            .bounds
            .push(BrepBound::Loop(vec![(rim, forward)]));
        brep
    };
    for _ in 0..6 {
        assert!(Part::new(&placed(&face(false), &mut random)).is_ok());
        let wrong = Part::new(&placed(&face(true), &mut random));
        assert!(
            matches!(
                wrong,
                Err(PartError::Face {
                    id: 2,
                    source: TrimProblem::Contradiction { .. }
                })
            ),
            "{wrong:?}"
        );
    }
}
