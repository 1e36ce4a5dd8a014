//! Against reference data, closed forms, dense samples and laws.

use super::*;
use crate::basis::KnotVector;
use crate::math::Random;
use crate::part::{Fineness, Part, SenseProblem};
use crate::surface::{ControlNet, Direction, Surface, builtin, file};
use std::f64::consts::{PI, TAU};

fn plane(normal: [f64; 3], offset_m: f64) -> CutPlane {
    let normal = Vector3::from(normal).normalize();
    CutPlane { normal, offset_m }
}

fn bent() -> Surface {
    file::read(include_str!("data/bent_teardrop.json")).unwrap()
}

/// A body of revolution about z: control points (r, z) of a cubic, from pole to pole.
fn revolved(profile: &[[f64; 2]]) -> Surface {
    lumpy(profile, |_, _| 1.0)
}

fn lumpy(profile: &[[f64; 2]], mut radius: impl FnMut(usize, usize) -> f64) -> Surface {
    let around = 12;
    let mut points = Vec::new();
    for i in 0..around {
        let (sin, cos) = (TAU * i as f64 / around as f64).sin_cos();
        for (j, [r, z]) in profile.iter().enumerate() {
            let r = r * radius(i, j);
            points.push(Point3::new(r * cos, r * sin, *z));
        }
    }
    let net = ControlNet::new(around, profile.len(), points).unwrap();
    let knots_u = KnotVector::periodic_uniform(3, around).unwrap();
    let knots_v = KnotVector::clamped_uniform(3, profile.len()).unwrap();
    let surface = Surface::new(knots_u, knots_v, net, None).unwrap();
    assert!(surface.topology().is_closed());
    surface.oriented_outward()
}

fn knobbly(random: &mut Random) -> Surface {
    let profile: Vec<[f64; 2]> = (0..10)
        .map(|j| {
            let (sin, cos) = (PI * f64::from(j) / 9.0).sin_cos();
            [
                0.05 * sin.max(0.0) * f64::from(u8::from(j > 0 && j < 9)),
                -0.05 * cos,
            ]
        })
        .collect();
    lumpy(&profile, |_, _| random.float(0.4, 1.6))
}

/// Pieces sum to the whole, above and below have the same cap, rims bound what fluxes say.
fn check_laws(surface: &Surface, cut: &Cut, what: &str) {
    let sum = |of: &dyn Fn(&Piece) -> f64| cut.pieces.iter().map(of).sum::<f64>();
    let volume = sum(&|p| p.volume_m3) / surface.volume().abs() - 1.0;
    assert!(
        volume.abs() < 1e-12,
        "{what}: volumes are off by {volume:e}"
    );
    let area = sum(&|p| p.skin_area_m2) / surface.area() - 1.0;
    assert!(area.abs() < 1e-6, "{what}: areas are off by {area:e}");
    let size2 = surface.size().powi(2);
    let caps = [true, false].map(|above| {
        let side = cut.pieces.iter().filter(|p| p.above == above);
        side.map(|p| p.cap_area_m2).sum::<f64>()
    });
    assert!(
        (caps[0] - caps[1]).abs() < 1e-11 * size2,
        "{what}: {caps:?}"
    );
    for piece in &cut.pieces {
        let rims: f64 = piece.caps.iter().map(|cap| cap.area_m2).sum();
        let off = (rims - piece.cap_area_m2).abs() / size2;
        assert!(
            off < 1e-10,
            "{what}: rims and fluxes differ by {off:e} of the size squared"
        );
        assert!(piece.volume_m3 > 0.0 && piece.caps.iter().all(|cap| cap.area_m2 > 0.0));
        assert!(!piece.caps.is_empty(), "{what}: a piece without a cap");
    }
    if let Some(whole) = surface.centroid() {
        let first: Vector3 = (cut.pieces.iter())
            .map(|p| p.centroid.coords * p.volume_m3)
            .sum();
        let off = (first / surface.volume().abs() - whole.coords).norm() / surface.size();
        assert!(off < 1e-12, "{what}: centroids are off by {off:e}");
    }
}

/// The pieces as a part: its edges lie on its faces, no face is turned, and its measures are those of the pieces.
fn check_part(cut: &Cut, what: &str) {
    let sum: f64 = cut.pieces.iter().map(|p| p.skin_area_m2).sum();
    let size = cut.surface.size();
    for (k, piece) in cut.pieces.iter().enumerate() {
        let brep = cut.brep(&[k]).unwrap();
        let part = Part::new(&brep).unwrap_or_else(|e| panic!("{what}, piece {k}: {e}"));
        assert!(part.senses().turned.is_empty(), "{what}, piece {k}");
        assert!(
            part.gap_m() < 1e-9 * size,
            "{what}, piece {k}: gap {}",
            part.gap_m() / size
        );
        let measure = part.measure();
        // Normals at a sharp pole that is sheared, or lies on the cap, do not tell a part where its outside is.
        assert!(
            part.is_closed()
                || matches!(part.senses().problems[..], [SenseProblem::Crossing { .. }]),
            "{what}, piece {k}: {:?}",
            part.senses()
        );
        if let Some(volume) = measure.volume_m3 {
            let off = volume - piece.volume_m3;
            assert!(
                off.abs() < 1e-8 * size.powi(3),
                "{what}, piece {k}: volume off by {off:e}"
            );
        }
        // Parts have seven points a span: not enough where |S_u × S_v| has a kink within one.
        if (sum / cut.surface.area() - 1.0).abs() < 1e-10 {
            let area = measure.area_m2 - piece.skin_area_m2 - piece.cap_area_m2;
            assert!(
                area.abs() < 1e-7 * size.powi(2),
                "{what}, piece {k}: area off by {area:e}"
            );
        }
    }
}

/// Connected regions on both sides, of a fine grid of samples.
fn sampled_regions(surface: &Surface, plane: &CutPlane, count: usize) -> usize {
    let topology = surface.topology();
    let (u, v) = (surface.knots_u().domain(), surface.knots_v().domain());
    let at = |i: usize, j: usize| {
        let place = |(a, b): (f64, f64), k: usize| a + (b - a) * (k as f64 + 0.5) / count as f64;
        plane.height(&surface.point(place(u, i), place(v, j))) > 0.0
    };
    let above: Vec<bool> = (0..count * count)
        .map(|k| at(k / count, k % count))
        .collect();
    let mut sets = regions::Sets::new(count * count);
    let mut join = |a: usize, b: usize| {
        if above[a] == above[b] {
            sets.join(a, b);
        }
    };
    for i in 0..count {
        for j in 0..count {
            let here = i * count + j;
            if i + 1 < count || topology.wraps(0) {
                join(here, (i + 1) % count * count + j);
            }
            if j + 1 < count || topology.wraps(1) {
                join(here, i * count + (j + 1) % count);
            }
        }
    }
    (0..count * count).filter(|&k| sets.of(k) == k).count()
}

#[test]
fn pieces_are_those_of_the_reference_data() {
    let cases: serde_json::Value = serde_json::from_str(include_str!("data/cases.json")).unwrap();
    for case in cases.as_array().unwrap() {
        let name = case["case"].as_str().unwrap();
        let body = match case["body"].as_str().unwrap() {
            "teardrop_12.json" => builtin("teardrop", Some([12, 12]), None).unwrap(),
            _ => bent(),
        };
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        let normal = [0, 1, 2].map(|k| number(&case["normal"][k]));
        let cut = cut_by_plane(&body, &plane(normal, 1e-3 * number(&case["offset"]))).unwrap();
        check_laws(&body, &cut, name);
        let wanted = case["pieces"].as_array().unwrap();
        assert_eq!(cut.pieces.len(), wanted.len(), "{name}");
        for wanted in wanted {
            let above = wanted["side"] == "above";
            let volume = 1e-9 * number(&wanted["volume"]);
            let near = |p: &&Piece| p.above == above && (p.volume_m3 / volume - 1.0).abs() < 1e-3;
            let piece = cut.pieces.iter().find(near).unwrap();
            let off = |value: f64, wanted: f64| (value / wanted - 1.0).abs();
            let volume = off(piece.volume_m3, volume);
            let cap = off(piece.cap_area_m2, 1e-6 * number(&wanted["cap_area"]));
            let skin = off(piece.skin_area_m2, 1e-6 * number(&wanted["skin_area"]));
            let centre = [0, 1, 2].map(|k| 1e-3 * number(&wanted["centroid"][k]));
            let centre = (piece.centroid.coords - Vector3::from(centre)).norm() / body.size();
            assert!(
                volume.max(cap).max(skin).max(centre) < 1e-11,
                "{name}: volume {volume:.1e}, cap {cap:.1e}, skin {skin:.1e}, centroid {centre:.1e}"
            );
        }
        check_part(&cut, name);
    }
}

/// A ball's cap of height h.
fn check_ball(r: f64, h: f64, normal: &Vector3, piece: &Piece, what: &str) {
    let volume = PI * h * h * (3.0 * r - h) / 3.0;
    let centre = 0.75 * (2.0 * r - h).powi(2) / (3.0 * r - h);
    let sense = if piece.above { 1.0 } else { -1.0 };
    let cap = PI * h * (2.0 * r - h);
    let off = [
        (piece.volume_m3 - volume) / volume,
        // A flux through the skin: little is left of it where the cap is small and the skin is not.
        (piece.cap_area_m2 - cap) / if h > r { PI * r * r } else { cap },
        (piece.skin_area_m2 - TAU * r * h) / (TAU * r * h),
        (piece.centroid.coords - normal * (sense * centre)).norm() / r,
    ];
    // The plane is moved by 4e-15 of the farthest control point's height, 3 r at most, and a volume goes with h².
    let most = 1e-9 + 3e-14 * r / h;
    assert!(
        off.iter().all(|x| x.abs() < most),
        "{what}: off by {off:?}, allowed {most:e}"
    );
}

#[test]
fn balls_are_cut_into_caps_of_closed_form() {
    let mut random = Random(71);
    for k in 0..200 {
        let r = random.float(0.01, 0.2);
        let ball = builtin("sphere", None, Some(r)).unwrap();
        let normal = random.vector().normalize();
        let offset = r * random.float(-0.999, 0.999);
        let cut = cut_by_plane(
            &ball,
            &CutPlane {
                normal,
                offset_m: offset,
            },
        )
        .unwrap();
        let what = format!("ball {k}");
        assert_eq!(cut.pieces.len(), 2, "{what}");
        check_laws(&ball, &cut, &what);
        for (piece, h) in cut.pieces.iter().zip([r - offset, r + offset]) {
            check_ball(r, h, &normal, piece, &what);
        }
        if k % 20 == 0 {
            check_part(&cut, &what);
        }
    }
}

#[test]
fn random_planes_through_bodies_give_pieces_that_sum_to_the_whole() {
    let mut random = Random(72);
    let mut compared = 0;
    for k in 0..120 {
        let body = match k % 4 {
            0 => builtin(
                "teardrop",
                Some([[8, 8], [12, 12], [20, 20]][k / 4 % 3]),
                None,
            )
            .unwrap(),
            1 => bent(),
            2 => builtin("torus", None, None).unwrap(),
            _ => knobbly(&mut random),
        };
        let normal = random.vector().normalize();
        let (a, b) = (body.knots_u().domain(), body.knots_v().domain());
        let through = body.point(random.float(a.0, a.1), random.float(b.0, b.1));
        let plane = CutPlane {
            normal,
            offset_m: normal.dot(&through.coords),
        };
        let cut = cut_by_plane(&body, &plane).unwrap();
        let what = format!("cut {k}");
        check_laws(&body, &cut, &what);
        let parts: usize = cut.pieces.iter().map(|p| p.skins.len()).sum();
        let sampled = [300, 500].map(|count| sampled_regions(&body, &plane, count));
        if sampled[0] == sampled[1] {
            compared += 1;
            assert_eq!(parts, sampled[0], "{what}");
        }
        for _ in 0..200 {
            let (u, v) = (random.float(a.0, a.1), random.float(b.0, b.1));
            let piece = &cut.pieces[cut.piece_at(u, v)];
            let height = plane.height(&body.point(u, v));
            assert_eq!(
                piece.above,
                height > 0.0,
                "{what} at ({u}, {v}): {height:e}"
            );
        }
        if k % 10 < 3 {
            check_part(&cut, &what);
        }
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn a_plane_that_grazes_finds_the_cap() {
    let r = 0.05;
    let ball = builtin("sphere", None, Some(r)).unwrap();
    let mut random = Random(73);
    let mut normals: Vec<Vector3> = vec![Vector3::x(), Vector3::y(), Vector3::z(), -Vector3::z()];
    normals.extend((0..6).map(|_| random.vector().normalize()));
    for normal in normals {
        for h in [1e-3, 1e-6, 1e-9].map(|share| share * ball.size()) {
            let cut = cut_by_plane(
                &ball,
                &CutPlane {
                    normal,
                    offset_m: r - h,
                },
            )
            .unwrap();
            assert_eq!(cut.pieces.len(), 2);
            check_ball(
                r,
                h,
                &normal,
                &cut.pieces[0],
                &format!("{h} m of {normal:?}"),
            );
        }
    }
}

#[test]
fn a_plane_that_touches_cuts_nothing() {
    let ball = builtin("sphere", None, Some(0.05)).unwrap();
    let drop = builtin("teardrop", Some([12, 12]), None).unwrap();
    let mut random = Random(74);
    let mut planes: Vec<(&Surface, CutPlane)> = Vec::new();
    for normal in [
        Vector3::x(),
        -Vector3::x(),
        Vector3::y(),
        Vector3::z(),
        -Vector3::z(),
    ] {
        planes.push((
            &ball,
            CutPlane {
                normal,
                offset_m: 0.05,
            },
        ));
    }
    planes.push((&drop, plane([0.0, 0.0, 1.0], 0.0)));
    for _ in 0..40 {
        let (u, v) = (random.unit(), random.float(0.05, 0.95));
        let normal = ball.normal(u, v);
        let offset_m = normal.dot(&ball.point(u, v).coords);
        planes.push((&ball, CutPlane { normal, offset_m }));
        planes.push((
            &ball,
            CutPlane {
                normal: -normal,
                offset_m: -offset_m,
            },
        ));
    }
    for (body, plane) in planes {
        match cut_by_plane(body, &plane) {
            Err(CutError::Misses { distance_m, .. }) => assert_eq!(distance_m, 0.0, "{plane:?}"),
            Ok(cut) => panic!("{plane:?}: {:?}", cut.pieces),
            Err(error) => panic!("{plane:?}: {error}"),
        }
    }
}

#[test]
fn a_plane_that_misses_says_by_how_much() {
    let ball = builtin("sphere", None, Some(0.05)).unwrap();
    for (offset, wanted) in [(0.06, false), (-0.07, true)] {
        let Err(CutError::Misses { above, distance_m }) =
            cut_by_plane(&ball, &plane([1.0, 2.0, -1.0], offset))
        else {
            panic!("cut")
        };
        assert_eq!(above, wanted);
        assert!((distance_m - (offset.abs() - 0.05)).abs() < 1e-14);
    }
}

#[test]
fn a_figure_eight_at_a_saddle_parts_what_only_touches() {
    // The innermost point of a torus, at a corner of four Bézier pieces: 0.6 of the great radius.
    let ring = builtin("torus", None, None).unwrap();
    let at_saddle = cut_by_plane(&ring, &plane([1.0, 0.0, 0.0], 0.03)).unwrap();
    check_laws(&ring, &at_saddle, "saddle of a torus");
    assert_eq!(at_saddle.pieces.len(), 2);
    let caps = |cut: &Cut| cut.pieces.iter().map(|p| p.caps.len()).collect::<Vec<_>>();
    // Beside it: one cap, or two.
    let beyond = cut_by_plane(&ring, &plane([1.0, 0.0, 0.0], 0.03 + 1e-9)).unwrap();
    let before = cut_by_plane(&ring, &plane([1.0, 0.0, 0.0], 0.03 - 1e-9)).unwrap();
    assert_eq!((caps(&beyond), caps(&before)), (vec![1, 1], vec![2, 2]));
    for (one, other) in [(&at_saddle, &beyond), (&at_saddle, &before)] {
        for (a, b) in one.pieces.iter().zip(&other.pieces) {
            assert!((a.volume_m3 - b.volume_m3).abs() < 1e-9 * ring.size().powi(2));
        }
    }
    check_part(&beyond, "beyond the saddle");
    check_part(&before, "before the saddle");
    // Where the bent teardrop is level between its ends: above, two horns that touch.
    let body = bent();
    let saddle = saddle_of(&body);
    let cut = cut_by_plane(&body, &plane([1.0, 0.0, 0.0], saddle)).unwrap();
    check_laws(&body, &cut, "saddle of the bent teardrop");
    let horns = cut.pieces.iter().filter(|p| p.above).count();
    assert_eq!((horns, cut.pieces.len()), (2, 3));
    let beside = cut_by_plane(&body, &plane([1.0, 0.0, 0.0], saddle - 1e-8)).unwrap();
    assert_eq!(beside.pieces.len(), 2, "joined below the saddle");
}

/// The greatest x at which the part of the bent teardrop above a plane x = const hangs together.
fn saddle_of(body: &Surface) -> f64 {
    let pieces = |x: f64| {
        cut_by_plane(body, &plane([1.0, 0.0, 0.0], x))
            .unwrap()
            .pieces
            .len()
    };
    let (mut low, mut high) = (0.02, 0.045);
    assert_eq!((pieces(low), pieces(high)), (2, 3));
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if pieces(middle) == 2 {
            low = middle
        } else {
            high = middle
        }
    }
    // Newton's method for S_u · x = S_v · x = 0 from the nearest place of a grid.
    let mut best = (f64::INFINITY, 0.0, 0.0);
    for i in 0..200 {
        for j in 1..200 {
            let (u, v) = (f64::from(i) / 200.0, f64::from(j) / 200.0);
            let frame = body.frame(u, v);
            let off = frame.du.x.hypot(frame.dv.x) + 10.0 * (frame.point.x - high).abs();
            if off < best.0 {
                best = (off, u, v);
            }
        }
    }
    let (_, mut u, mut v) = best;
    for _ in 0..50 {
        let frame = body.frame(u, v);
        let (a, b, c) = (frame.duu.x, frame.duv.x, frame.dvv.x);
        let det = a * c - b * b;
        u -= (c * frame.du.x - b * frame.dv.x) / det;
        v -= (a * frame.dv.x - b * frame.du.x) / det;
    }
    let x = body.point(u, v).x;
    assert!((x - high).abs() < 1e-6, "{x} is not the saddle near {high}");
    x
}

#[test]
fn a_ring_is_cut_into_what_its_sections_say() {
    let ring = builtin("torus", None, None).unwrap();
    let half = 0.5 * ring.volume();
    for (normal, caps) in [
        ([0.0, 0.0, 1.0], 1),
        ([1.0, 0.0, 0.0], 2),
        ([0.3, 0.4, 0.0], 2),
    ] {
        let cut = cut_by_plane(&ring, &plane(normal, 0.0)).unwrap();
        let what = format!("ring across {normal:?}");
        check_laws(&ring, &cut, &what);
        check_part(&cut, &what);
        assert_eq!(cut.pieces.len(), 2, "{normal:?}");
        for piece in &cut.pieces {
            assert_eq!(piece.caps.len(), caps, "{normal:?}");
            assert_eq!(piece.rims.len(), 2, "{normal:?}");
            // Symmetric to rounding about the planes of its axes only.
            assert!(
                (piece.volume_m3 / half - 1.0).abs() < if normal[1] == 0.0 { 1e-12 } else { 1e-3 }
            );
        }
    }
}

#[test]
fn a_bowl_stays_one_piece_where_a_cap_joins_its_walls() {
    // Outside up from the lower pole, over the brim, inside down to the upper pole.
    let bowl = revolved(&[
        [0.0, 0.0],
        [0.02, 0.0],
        [0.05, 0.0],
        [0.06, 0.03],
        [0.06, 0.06],
        [0.05, 0.07],
        [0.05, 0.06],
        [0.05, 0.03],
        [0.04, 0.01],
        [0.02, 0.01],
        [0.0, 0.01],
    ]);
    let cut = cut_by_plane(&bowl, &plane([0.0, 0.0, 1.0], 0.03)).unwrap();
    check_laws(&bowl, &cut, "bowl");
    check_part(&cut, "bowl");
    let seen: Vec<_> = cut
        .pieces
        .iter()
        .map(|p| (p.above, p.skins.len(), p.rims.len(), p.caps.len()))
        .collect();
    assert_eq!(seen, [(true, 1, 2, 1), (false, 2, 2, 1)]);
    assert_eq!(cut.pieces[1].caps[0].rims.len(), 2);
    // On its side: through both walls, a cap like a C.
    let cut = cut_by_plane(&bowl, &plane([1.0, 0.0, 0.0], 0.01)).unwrap();
    check_laws(&bowl, &cut, "bowl on its side");
    check_part(&cut, "bowl on its side");
    assert_eq!(cut.pieces.len(), 2);
}

#[test]
fn a_plane_through_poles_and_along_the_seam_halves_a_ball() {
    let r = 0.05;
    let ball = builtin("sphere", None, Some(r)).unwrap();
    let mut random = Random(75);
    // y = 0 holds the line u = 0, on which the surface closes, and x = 0 and x = y lines of knots.
    let mut normals = vec![
        Vector3::y(),
        -Vector3::y(),
        Vector3::x(),
        Vector3::new(1.0, -1.0, 0.0),
    ];
    normals.extend((0..10).map(|_| Vector3::new(random.signed(), random.signed(), 0.0)));
    for normal in normals.into_iter().map(|n| n.normalize()) {
        let cut = cut_by_plane(
            &ball,
            &CutPlane {
                normal,
                offset_m: 0.0,
            },
        )
        .unwrap();
        let what = format!("{normal:?}");
        assert_eq!(cut.pieces.len(), 2, "{what}");
        check_laws(&ball, &cut, &what);
        check_part(&cut, &what);
        for piece in &cut.pieces {
            check_ball(r, r, &normal, piece, &what);
        }
    }
}

#[test]
fn a_plane_near_a_pole_is_cut_like_any_other() {
    let r = 0.05;
    let ball = builtin("sphere", None, Some(r)).unwrap();
    let mut random = Random(76);
    for exponent in 2..16 {
        for _ in 0..3 {
            let normal = Vector3::new(random.signed(), random.signed(), 0.0).normalize();
            let offset_m = r * 10f64.powi(-exponent);
            let cut = cut_by_plane(&ball, &CutPlane { normal, offset_m }).unwrap();
            let what = format!("{normal:?} at {offset_m}");
            assert_eq!(cut.pieces.len(), 2, "{what}");
            check_laws(&ball, &cut, &what);
            check_ball(r, r - offset_m, &normal, &cut.pieces[0], &what);
        }
    }
}

#[test]
fn an_open_sheet_becomes_two_without_caps() {
    let side = 0.1;
    let sheet = builtin("sheet", None, Some(side)).unwrap();
    // Off a corner: a triangle with legs of 0.03 and 0.06.
    let corner =
        CutPlane::through(&Point3::new(0.02, 0.05, 0.3), &Vector3::new(2.0, 1.0, 0.0)).unwrap();
    let middle = plane([1.0, 0.0, 0.5], 0.01);
    for (plane, above) in [
        (corner, 0.5 * 0.03 * 0.06),
        (middle, side * (0.05 - 0.01 * 1.25f64.sqrt())),
    ] {
        let cut = cut_by_plane(&sheet, &plane).unwrap();
        assert!(!cut.closed);
        let areas: Vec<f64> = cut.pieces.iter().map(|p| p.skin_area_m2).collect();
        assert_eq!(areas.len(), 2);
        assert!(
            (areas[0] - above).abs() < 1e-15 && (areas[0] + areas[1] - side * side).abs() < 1e-15
        );
        for (k, piece) in cut.pieces.iter().enumerate() {
            assert!(piece.caps.is_empty() && piece.volume_m3 == 0.0);
            let part = Part::new(&cut.brep(&[k]).unwrap()).unwrap();
            assert!(!part.is_closed() && part.gap_m() < 1e-12);
            assert!((part.measure().area_m2 - piece.skin_area_m2).abs() < 1e-12);
        }
    }
    assert!(matches!(
        cut_by_plane(&sheet, &plane([0.0, 0.0, 1.0], 1e-3)),
        Err(CutError::Misses { above: false, .. })
    ));
}

/// Each side of a triangle is another's, the other way round.
fn assert_watertight(triangles: &[[u32; 3]], what: &str) {
    let mut sides: Vec<[u32; 2]> = Vec::new();
    for t in triangles {
        sides.extend((0..3).map(|k| [t[k], t[(k + 1) % 3]]));
    }
    let mut back: Vec<[u32; 2]> = sides.iter().map(|[a, b]| [*b, *a]).collect();
    sides.sort_unstable();
    back.sort_unstable();
    assert!(
        sides.windows(2).all(|pair| pair[0] != pair[1]),
        "{what}: a side twice"
    );
    assert_eq!(sides, back, "{what}: open");
}

#[test]
fn triangles_of_pieces_are_watertight_and_know_where_they_come_from() {
    let drop = builtin("teardrop", Some([12, 12]), None).unwrap();
    let poles = plane(
        [
            -0.9574784472756424,
            0.28049080984875624,
            0.06752724333936483,
        ],
        0.0,
    );
    let cases = [
        ("middle", &drop, plane([0.0, 0.0, 1.0], 0.045)),
        (
            "oblique",
            &drop,
            plane(
                [0.7453559924999299, 0.29814239699997197, 0.5962847939999439],
                0.03,
            ),
        ),
        ("poles", &drop, poles),
        ("three", &bent(), plane([1.0, 0.0, 0.0], 0.045)),
        (
            "ring",
            &builtin("torus", None, None).unwrap(),
            plane([0.0, 0.0, 1.0], 0.0),
        ),
    ];
    let fineness = Fineness {
        tolerance_m: 2e-4,
        most: 100_000,
        plane_step_m: Some(4e-3),
    };
    for (what, body, plane) in cases {
        let cut = cut_by_plane(body, &plane).unwrap();
        for (k, piece) in cut.pieces.iter().enumerate() {
            let made = cut.triangles(k, &fineness).unwrap();
            assert_watertight(&made.mesh.triangles, what);
            assert!(
                made.deviation_m <= 1.01 * fineness.tolerance_m,
                "{what}: {}",
                made.deviation_m
            );
            let mut inner = 0;
            for (point, origin) in made.mesh.points.iter().zip(&made.origins) {
                let size = body.size();
                let height = plane.height(point);
                match origin {
                    Origin::Skin { u, v } => {
                        let off = (body.point(*u, *v) - point).norm();
                        assert!(off < 1e-9 * size, "{what}: {off:e} m off at ({u}, {v})");
                        assert!(if piece.above { height } else { -height } > -1e-10 * size);
                    }
                    Origin::Cap => {
                        inner += 1;
                        assert!(height.abs() < 1e-12 * size);
                    }
                }
            }
            let expected = piece.cap_area_m2 / 16e-6;
            assert!(
                f64::from(inner) > 0.3 * expected - 4.0,
                "{what}: {inner} points for {expected}"
            );
            let volume: f64 = (made.mesh.triangles.iter())
                .map(|t| {
                    let [a, b, c] = t.map(|k| made.mesh.points[k as usize].coords);
                    a.dot(&b.cross(&c)) / 6.0
                })
                .sum();
            let off =
                (volume - piece.volume_m3).abs() / (piece.skin_area_m2 * fineness.tolerance_m);
            assert!(
                off < 1.0,
                "{what}: volume off by {off} of area times tolerance"
            );
            let on_cap = made.caps.iter().flatten().count();
            assert!(on_cap > 0 && on_cap < made.caps.len());
        }
    }
}

#[test]
fn what_cannot_be_cut_says_so() {
    let ball = builtin("sphere", None, None).unwrap();
    let knots = KnotVector::new(1, vec![0.0, 0.0, 0.5, 0.5, 1.0, 1.0]).unwrap();
    let rows = [0.0, 0.4, 0.6, 1.0].map(|x| [0.0, 1.0].map(|y| Point3::new(x, y, 0.0)));
    let net = ControlNet::new(4, 2, rows.concat()).unwrap();
    let torn = Surface::new(knots, KnotVector::clamped_uniform(1, 2).unwrap(), net, None).unwrap();
    assert!(matches!(
        cut_by_plane(&torn, &plane([1.0, 0.0, 0.0], 0.2)),
        Err(CutError::Joined)
    ));
    for normal in [Vector3::zeros(), Vector3::new(f64::NAN, 0.0, 1.0)] {
        assert!(CutPlane::through(&Point3::origin(), &normal).is_none());
    }
    assert!(CutPlane::through(&Point3::new(f64::INFINITY, 0.0, 0.0), &Vector3::x()).is_none());
    let wrong = Fineness {
        tolerance_m: 0.0,
        most: 10,
        plane_step_m: None,
    };
    let cut = cut_by_plane(&ball, &plane([1.0, 0.0, 0.0], 0.0)).unwrap();
    assert!(cut.triangles(0, &wrong).is_err());
}

#[test]
fn parameters_the_other_way_round_give_the_same_pieces() {
    let drop = builtin("teardrop", Some([12, 12]), None).unwrap();
    let poles = plane(
        [
            -0.9574784472756424,
            0.28049080984875624,
            0.06752724333936483,
        ],
        0.0,
    );
    for plane in [plane([0.3, 0.4, 0.5], 0.03), poles] {
        let wanted = cut_by_plane(&drop, &plane).unwrap();
        let others = [
            drop.swap_uv(),
            drop.reversed(Direction::U),
            drop.reversed(Direction::V),
            drop.reversed(Direction::U).with_flip_normal(false),
        ];
        for (k, other) in others.iter().enumerate() {
            let cut = cut_by_plane(other, &plane).unwrap();
            check_part(&cut, &format!("way {k}"));
            for (a, b) in cut.pieces.iter().zip(&wanted.pieces) {
                assert_eq!(a.above, b.above);
                assert!((a.volume_m3 / b.volume_m3 - 1.0).abs() < 1e-12, "way {k}");
                assert!(
                    (a.cap_area_m2 / b.cap_area_m2 - 1.0).abs() < 1e-11,
                    "way {k}"
                );
            }
        }
    }
}
