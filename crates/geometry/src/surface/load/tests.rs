use super::super::{ClosestSolver, ControlNet, Surface, SurfaceError, builtin, file};
use super::*;
use crate::exchange::{Format, Pick, read_surface, write_surface};
use crate::math::Random;
use crate::surface::file::Unit;

/// A bumpy sheet of 1 cm a point.
fn sheet(random: &mut Random, knots: [KnotVector; 2], rational: bool) -> Surface {
    let [u, v] = knots;
    let (rows, columns) = (u.count(), v.count());
    let point = |k: usize| {
        let [i, j] = [k / columns, k % columns].map(|x| 0.01 * x as f64);
        Point3::new(i, j, 0.004 * random.signed())
    };
    let points = (0..rows * columns).map(point).collect();
    let weights = rational.then(|| (0..rows * columns).map(|k| 1.0 + (k % 3) as f64).collect());
    Surface::new(
        u,
        v,
        ControlNet::new(rows, columns, points).unwrap(),
        weights,
    )
    .unwrap()
}

/// `count` knots around `at`, some units in the last place or up to 4e-12 apart.
fn near(random: &mut Random, at: f64, count: usize) -> Vec<f64> {
    let gap = 4e-12 * 10_f64.powi(-(random.below(5) as i32));
    let mut knots = vec![at];
    while knots.len() < count {
        let last = knots[knots.len() - 1];
        knots.push((last + gap * random.unit()).max(last.next_up()));
    }
    knots
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Where {
    Inside,
    AtStart,
    AtEnd,
    Period,
}

/// Knots of a degree with `count` that nearly agree; the same made equal.
fn knots(random: &mut Random, degree: usize, count: usize, place: Where) -> KnotVector {
    let at = 0.3 + 0.3 * random.unit();
    let inner = near(random, at, count);
    let full = degree + 1;
    let mut all = Vec::new();
    match place {
        Where::Inside => {
            all.extend(vec![0.0; full]);
            all.extend(inner);
            all.extend(vec![1.0; full]);
        }
        Where::AtStart => {
            all.extend(vec![0.0; full - 1]);
            all.extend(near(random, f64::EPSILON, count));
            all.extend([0.5, 0.7]);
            all.extend(vec![1.0; full]);
        }
        Where::AtEnd => {
            all.extend(vec![0.0; full]);
            all.extend([0.2, 0.5]);
            all.extend(near(random, 1.0, count));
            let last = all[all.len() - 1];
            all.extend(vec![last.next_up(); full - 1]);
        }
        Where::Period => {
            all.push(0.0);
            all.extend(inner);
            all.extend((1..=full).map(|k| 0.7 + 0.2 * k as f64 / full as f64));
            all.push(1.0);
            return KnotVector::periodic(degree, all).unwrap();
        }
    }
    KnotVector::new(degree, all).unwrap()
}

const PLACES: [Where; 4] = [Where::Inside, Where::AtStart, Where::AtEnd, Where::Period];

// Up to `degree` knots only bend: the surface is the same when they are one. More are a bridge
// between two rows of control points.
#[test]
fn near_knots_become_one_where_that_moves_nothing_and_are_refused_with_their_joint_elsewhere() {
    let mut random = Random(1601);
    let (mut merged, mut refused) = (0, 0);
    for case in 0..400 {
        let degree = 1 + case % 5;
        let place = PLACES[random.below(4)];
        let count = match place {
            Where::Inside | Where::Period => 2 + random.below(degree + 1),
            Where::AtStart | Where::AtEnd => 1 + random.below(2),
        };
        let own = knots(&mut random, degree, count, place);
        let other = KnotVector::clamped_uniform(2, 4).unwrap();
        let direction = random.below(2);
        let pair = if direction == 0 {
            [own, other]
        } else {
            [other, own]
        };
        let rational = random.below(2) == 0;
        let given = sheet(&mut random, pair, rational);
        // At an end, one that nearly agrees is already as many as may be.
        let bridge = match place {
            Where::Inside | Where::Period => count > degree,
            Where::AtStart | Where::AtEnd => count > 1,
        };
        match given.clone().loaded() {
            Ok(Loaded {
                surface,
                merged: notes,
            }) => {
                assert!(
                    !bridge,
                    "case {case}: {place:?}, {count} of degree {degree}"
                );
                merged += 1;
                assert_eq!(notes.len(), 1, "case {case}: {notes:?}");
                assert_eq!(notes[0].direction, ['u', 'v'][direction]);
                for _ in 0..50 {
                    let (u, v) = (random.unit(), random.unit());
                    let apart = (surface.point(u, v) - given.point(u, v)).norm();
                    assert!(apart <= 1e-9 * given.size(), "case {case}: {apart}");
                }
                let again = surface.clone().loaded().unwrap();
                assert_eq!((again.surface, again.merged.len()), (surface, 0));
            }
            Err(error) => {
                assert!(bridge, "case {case}: {error}");
                refused += 1;
                let SurfaceError::NearKnots {
                    direction: d,
                    first,
                    last,
                    value,
                    ..
                } = error
                else {
                    panic!("case {case}: {error}");
                };
                let t = [given.knots_u(), given.knots_v()][direction].file_knots();
                assert_eq!(d, ['u', 'v'][direction]);
                assert!(last - first + 1 >= count && (t[first] - value).abs() < 1e-10);
            }
        }
    }
    assert!(
        merged > 100 && refused > 100,
        "{merged} merged, {refused} refused"
    );
}

#[test]
fn a_bridge_between_rows_that_are_one_place_is_no_bridge() {
    let mut random = Random(1602);
    for degree in 1..=5 {
        let own = knots(&mut random, degree, degree + 1, Where::Inside);
        let mut given = sheet(
            &mut random,
            [own, KnotVector::clamped_uniform(2, 4).unwrap()],
            false,
        );
        let columns = given.net().columns();
        for j in 0..columns {
            let point = *given.net().at(degree, j);
            given.net_mut().points_mut()[(degree + 1) * columns + j] = point;
        }
        let loaded = given.loaded().unwrap();
        assert_eq!(loaded.merged.len(), 1, "degree {degree}");
        assert_eq!(loaded.surface.knots_u().disjoined().len(), 1);
        assert!(!loaded.surface.topology().torn[0]);
    }
}

#[test]
fn every_reader_refuses_a_bridge_and_says_where_it_is() {
    let mut random = Random(1603);
    let t = [
        0.0,
        0.0,
        0.0,
        0.5,
        0.500_000_000_000_000_1,
        0.500_000_000_000_000_2,
        1.0,
        1.0,
        1.0,
    ];
    let own = KnotVector::new(2, t.to_vec()).unwrap();
    let given = sheet(
        &mut random,
        [KnotVector::clamped_uniform(3, 4).unwrap(), own],
        false,
    );
    for format in [Format::Json, Format::Step, Format::Iges] {
        let bytes = write_surface(&given, format, Unit::Metre).unwrap();
        let error = read_surface(&bytes, format, Pick::First)
            .unwrap_err()
            .to_string();
        let wanted = "knots 3 to 5 in v differ in their last digits near 0.5: the part of the surface between them is too \
                      narrow for parameters, and without it points would move by ";
        assert!(error.contains(wanted), "{format:?}: {error}");
    }
}

/// A closed surface whose ends are `gap_m` apart in the direction of its seam: u, or v when turned.
fn torn(random: &mut Random, name: &str, gap_m: f64, turned: bool) -> Surface {
    let mut whole = builtin(name, None, None).unwrap();
    let (rows, columns) = (whole.net().rows(), whole.net().columns());
    // Poles stay points: the gap is that of the seam.
    for j in 1..columns - 1 {
        let way = random.vector().normalize() * gap_m;
        whole.net_mut().points_mut()[(rows - 1) * columns + j] += way;
    }
    if turned { whole.swap_uv() } else { whole }
}

#[test]
fn what_is_closed_but_for_rounding_is_closed_bit_for_bit_and_other_gaps_are_told() {
    let mut random = Random(1501);
    for case in 0..60 {
        let (name, turned) = (["teardrop", "sphere"][case % 2], case % 4 > 1);
        let size = builtin(name, None, None).unwrap().size();
        let gap_m = size * 10_f64.powf(random.float(-13.0, -1.5));
        let given = torn(&mut random, name, gap_m, turned);
        let loaded = given.clone().loaded().unwrap().surface;
        let slits = loaded.slits();
        let share = gap_m / size;
        if share < 0.5e-9 {
            let d = usize::from(turned);
            let last = [loaded.net().rows(), loaded.net().columns()][d] - 1;
            assert_eq!(
                loaded.control_row(d, 0),
                loaded.control_row(d, last),
                "case {case}"
            );
            assert!(loaded.topology().is_closed() && slits.is_empty());
        } else if share > 2e-9 && share < 0.5e-3 {
            assert_eq!(loaded.net(), given.net(), "case {case}: kept open");
            assert!(!loaded.topology().is_closed());
            assert_eq!(slits.len(), 1, "case {case}: {slits:?}");
            assert_eq!(
                (slits[0].direction, slits[0].place),
                (['u', 'v'][usize::from(turned)], SlitPlace::Seam)
            );
            assert!(
                (slits[0].gap_m - gap_m).abs() < 1e-3 * gap_m + 1e-16,
                "{slits:?}"
            );
        } else if share > 2e-3 {
            assert!(slits.is_empty(), "case {case}: {slits:?}");
        }
    }
}

#[test]
fn poles_that_are_points_but_for_rounding_become_points_and_others_are_told() {
    let mut random = Random(1502);
    for case in 0..40 {
        let mut given = builtin("teardrop", None, None).unwrap();
        let (rows, columns) = (given.net().rows(), given.net().columns());
        let width_m = given.size() * 10_f64.powf(random.float(-13.0, -3.5));
        for i in 1..rows - 1 {
            given.net_mut().points_mut()[i * columns] += random.vector().normalize() * width_m;
        }
        let given = if case % 2 == 0 {
            given
        } else {
            given.swap_uv()
        };
        let name = ['v', 'u'][case % 2];
        let loaded = given.loaded().unwrap().surface;
        let share = width_m / loaded.size();
        if share < 0.5e-9 {
            let pole = loaded.control_row(1 - case % 2, 0);
            assert!(pole.iter().all(|p| p.0 == pole[0].0), "case {case}");
            assert!(loaded.topology().is_closed() && loaded.slits().is_empty());
        } else if share > 2e-9 {
            let slits = loaded.slits();
            assert_eq!(slits.len(), 1, "case {case}: {slits:?}");
            assert!(
                slits[0].direction == name && matches!(slits[0].place, SlitPlace::Pole(_)),
                "{slits:?}"
            );
        }
    }
}

// An open direction that repeats its points closes as a period does; at a knot that parts it a
// surface meets again.
#[test]
fn repeated_points_and_both_sides_of_a_parting_knot_are_made_equal() {
    let mut random = Random(1503);
    let torus = builtin("torus", None, None).unwrap();
    let (p, rows, columns) = (
        torus.knots_u().degree(),
        torus.net().rows(),
        torus.net().columns(),
    );
    let full = KnotVector::new(p, torus.knots_u().knots().to_vec()).unwrap();
    let mut points: Vec<Point3> = torus.net().points().to_vec();
    for k in 0..p * columns {
        points.push(points[k] + random.vector() * 1e-13);
    }
    let net = ControlNet::new(rows + p, columns, points).unwrap();
    let open = Surface::new(full, torus.knots_v().clone(), net, None).unwrap();
    assert_eq!(open.topology().closing[0], Closing::Touching);
    let loaded = open.loaded().unwrap().surface;
    for k in 0..p {
        assert_eq!(loaded.control_row(0, k), loaded.control_row(0, rows + k));
    }

    let mut parted = torus
        .insert_knots(super::super::Direction::U, &[0.5 + 1e-3; 4])
        .unwrap();
    let after = parted.knots_u().parted_after()[0];
    parted.net_mut().points_mut()[after * columns].x += 1e-13;
    let loaded = parted.clone().loaded().unwrap().surface;
    assert_eq!(
        loaded.control_row(0, after),
        loaded.control_row(0, after + 1)
    );
    parted.net_mut().points_mut()[after * columns].x += 1e-6;
    let slits = parted.loaded().unwrap().surface.slits();
    assert!(
        matches!(
            slits[..],
            [Slit {
                direction: 'u',
                place: SlitPlace::Joint(_),
                ..
            }]
        ),
        "{slits:?}"
    );
}

#[test]
fn no_narrow_sheet_or_builtin_is_told_to_have_a_slit() {
    for name in ["sheet", "sphere", "teardrop", "torus"] {
        assert!(
            builtin(name, None, None).unwrap().slits().is_empty(),
            "{name}"
        );
    }
    // 100 mm by 50 µm: its long edges are no seam, its short ones no poles.
    let mut strip = builtin("sheet", None, None).unwrap();
    for point in strip.net_mut().points_mut() {
        point.y *= 5e-4;
    }
    assert!(strip.slits().is_empty(), "{:?}", strip.slits());
}

#[test]
fn the_weights_of_a_seam_are_made_one_ratio() {
    let sphere = builtin("sphere", None, None).unwrap();
    let text = file::write(&sphere, Unit::Metre);
    let mut document: serde_json::Value = serde_json::from_str(&text).unwrap();
    let last = sphere.net().rows() - 1;
    let weight = document["weights"][last][2].as_f64().unwrap();
    document["weights"][last][2] = (weight * (1.0 + 3e-10)).into();
    assert_eq!(file::from_value(&document).unwrap(), sphere);
}

#[test]
fn queries_of_what_is_loaded_give_no_piece_up() {
    let mut random = Random(1604);
    for case in 0..40 {
        let degree = 1 + case % 5;
        let own = knots(
            &mut random,
            degree,
            2.min(degree + 1),
            PLACES[[0, 3][case % 2]],
        );
        let other = KnotVector::clamped_uniform(2, 4).unwrap();
        let Ok(loaded) = sheet(&mut random, [own, other], case % 3 == 0).loaded() else {
            continue;
        };
        let mut solver = ClosestSolver::new(&loaded.surface);
        for _ in 0..30 {
            let query = Point3::from(random.vector() * 0.05);
            solver.closest(&loaded.surface, &query);
        }
        assert_eq!(solver.pieces_given_up(), 0, "case {case}");
    }
}
