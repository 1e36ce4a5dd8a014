//! Degenerate input: what is refused, and what is answered all the same.

use super::{block, ellipsoid};
use crate::isolate::{
    Body, IsolateError, IsolateMethod, IsolateSpec, IsolateStatus, Reason, Resolution, Unsettled,
    isolate, isolate_all,
};
use palpate_geometry::math::Random;
use palpate_geometry::math::{Pose, Vector3};
use palpate_geometry::surface::{Surface, builtin};

fn ball(x: f64, y: f64, z: f64) -> Surface {
    ellipsoid([1.0; 3], Vector3::new(x, y, z))
}

fn plain() -> IsolateSpec {
    IsolateSpec::default()
}

#[test]
fn bodies_that_are_apart_stay_and_their_gap_is_told() {
    for exact in [false, true] {
        let spec = IsolateSpec { exact, ..plain() };
        let answer = isolate(&ball(0.0, 0.0, 0.0), &ball(0.0, 0.0, 2.5), &spec).unwrap();
        assert_eq!(
            (answer.status, answer.translation_m),
            (IsolateStatus::Apart, Vector3::zeros())
        );
        // Poles lie on the axis: clamped ends pass through them.
        assert!((answer.gap_m.unwrap() - 0.5).abs() < 1e-9, "{answer:?}");
    }
}

#[test]
fn bodies_that_touch_are_pushed_along_the_contact_normal() {
    for distance in [2.0, 2.0 + 1e-6] {
        let answer = isolate(&ball(0.0, 0.0, distance), &ball(0.0, 0.0, 0.0), &plain()).unwrap();
        assert_eq!(answer.status, IsolateStatus::Isolated);
        let along = answer.translation_m.normalize().z;
        assert!(
            along > 0.999 && answer.translation_m.norm() < 0.01,
            "{answer:?}"
        );
        let gap = answer.gap_m.unwrap();
        assert!((0.004..0.0060).contains(&gap), "{answer:?}");
    }
}

#[test]
fn a_body_inside_another_comes_out_by_the_global_search_and_the_reason_is_told() {
    let spec = IsolateSpec {
        method: IsolateMethod::Blend,
        ..plain()
    };
    let small = ellipsoid([0.2; 3], Vector3::new(0.3, 0.0, 0.0));
    let answer = isolate(&small, &ball(0.0, 0.0, 0.0), &spec).unwrap();
    assert_eq!(
        (answer.method, answer.fell_back),
        (IsolateMethod::Global, Some(Reason::NoRegion))
    );
    // 1 - 0.3 + 0.2, less what the splines stay inside their nets.
    assert!(
        (0.80..0.92).contains(&answer.translation_m.norm()),
        "{answer:?}"
    );
    // And the other way: the large one leaves the small one.
    let back = isolate(&ball(0.0, 0.0, 0.0), &small, &spec).unwrap();
    // Every direction round the axis is nearly as good, so lengths are compared.
    assert!(
        (back.translation_m.norm() / answer.translation_m.norm() - 1.0).abs() < 0.01,
        "{back:?}"
    );
    assert!(
        back.translation_m.x * answer.translation_m.x < 0.0,
        "{back:?}"
    );
    let strict = isolate(
        &small,
        &ball(0.0, 0.0, 0.0),
        &IsolateSpec {
            fall_back: false,
            ..spec
        },
    )
    .unwrap();
    assert_eq!(
        (strict.status, strict.gap_m),
        (IsolateStatus::Failed(Reason::NoRegion), None)
    );
    assert!(!strict.is_apart());
}

#[test]
fn identical_bodies_part_along_their_shortest_width() {
    let body = ellipsoid([1.0, 0.7, 0.4], Vector3::new(0.1, 0.2, 0.3));
    for method in IsolateMethod::ALL {
        let answer = isolate(&body, &body, &IsolateSpec { method, ..plain() }).unwrap();
        if method == IsolateMethod::Farthest && answer.fell_back.is_none() {
            continue;
        }
        // Twice the half axis, which the clamped ends reach.
        assert!(
            (answer.contact_m.norm() - 0.8).abs() < 0.01,
            "{method:?}: {answer:?}"
        );
    }
    let limited = IsolateSpec {
        max_turn_deg: Some(10.0),
        ..plain()
    };
    let answer = isolate(&body, &body, &limited).unwrap();
    assert_eq!(
        answer.status,
        IsolateStatus::Failed(Reason::CoincidentCentroids),
        "there is no direction to keep"
    );
}

// Concentric: no line of centres, no unequal regions; the answer is still the shortest way out.
#[test]
fn coincident_centroids_leave_methods_5_and_6_without_a_line() {
    let long = ellipsoid([0.3, 0.3, 1.5], Vector3::zeros());
    let flat = ellipsoid([1.0, 1.0, 0.3], Vector3::zeros());
    let strict = IsolateSpec {
        fall_back: false,
        exact: false,
        ..plain()
    };
    let five = isolate(
        &long,
        &flat,
        &IsolateSpec {
            method: IsolateMethod::Centroids,
            ..strict
        },
    )
    .unwrap();
    assert_eq!(
        five.status,
        IsolateStatus::Failed(Reason::CoincidentCentroids)
    );
    let global = isolate(&long, &flat, &strict).unwrap();
    assert!((1.0..1.31).contains(&global.contact_m.norm()), "{global:?}");
}

// Coplanar faces, shared edges, corners in faces: the boxes' overlap is known to the last digit.
#[test]
fn boxes_with_coplanar_faces_part_by_their_least_overlap() {
    let fixed = block([0.0; 3], [1.0, 1.0, 1.0]);
    let cases = [
        ([0.75, 0.0, 0.0], 0.25),
        ([0.5, 0.5, 0.875], 0.125),
        ([0.25, 0.25, 0.25], 0.75),
        ([0.0, 0.0, -0.9], 0.1),
        ([0.9, 0.9, 0.8], 0.1),
    ];
    for exact in [false, true] {
        for (low, least) in cases {
            let moving = block(low, low.map(|x| x + 1.0));
            let answer = isolate(&moving, &fixed, &IsolateSpec { exact, ..plain() }).unwrap();
            assert_eq!(answer.status, IsolateStatus::Isolated, "{low:?}");
            assert!(
                (answer.contact_m.norm() - least).abs() < 1e-3,
                "{low:?}: {answer:?}"
            );
        }
    }
}

// The triangle test on boxes against intervals, ten thousand random places; near misses within
// rounding left out.
#[test]
fn overlap_of_boxes_is_overlap_of_their_intervals() {
    let body = |surface: &Surface, k| Body::new(surface, [8, 6], k).unwrap();
    let (a, b) = (
        body(&block([0.0; 3], [1.0, 0.5, 0.25]), 0),
        body(&block([0.0; 3], [0.3, 0.6, 0.9]), 1),
    );
    let mut random = Random(3);
    let mut counts = [0, 0];
    for _ in 0..10_000 {
        let by = Vector3::from_fn(|_, _| random.float(-1.2, 1.2));
        let (low, high) = (by, by + Vector3::new(1.0, 0.5, 0.25));
        let other = Vector3::new(0.3, 0.6, 0.9);
        let depth = (0..3)
            .map(|k| (high[k].min(other[k])) - low[k].max(0.0))
            .fold(f64::INFINITY, f64::min);
        if depth.abs() < 1e-9 {
            continue;
        }
        let found = a.overlaps(&by, &b);
        assert_eq!(found, depth > 0.0, "{by}");
        counts[usize::from(found)] += 1;
        if !found {
            let squared: f64 = (0..3)
                .map(|k| (low[k].max(0.0) - high[k].min(other[k])).max(0.0))
                .map(|gap| gap * gap)
                .sum();
            assert!((a.gap_m(&by, &b) - squared.sqrt()).abs() < 1e-12, "{by}");
        }
    }
    assert!(counts[0] > 1000 && counts[1] > 1000, "{counts:?}");
}

#[test]
fn bodies_far_from_the_origin_or_very_small_or_very_large_are_answered_alike() {
    let pair = |scale: f64, at: f64| {
        let place = Pose::translation(at, -at, 0.5 * at);
        [ball(0.0, 0.0, 0.0), ball(1.2, 0.5, 0.3)].map(|s| s.scaled(scale).transformed(&place))
    };
    let [moving, fixed] = pair(1.0, 0.0);
    let wanted = isolate(&moving, &fixed, &plain()).unwrap().contact_m;
    for (scale, at) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e5), (1e-3, 10.0)] {
        let [moving, fixed] = pair(scale, at);
        let found = isolate(&moving, &fixed, &plain()).unwrap();
        assert_eq!(
            found.status,
            IsolateStatus::Isolated,
            "scale {scale} at {at}"
        );
        let error = (found.contact_m / scale - wanted).norm();
        assert!(error < 5e-3, "scale {scale} at {at}: {error}");
    }
}

#[test]
fn bad_input_is_refused_with_what_and_where() {
    let good = ball(0.0, 0.0, 0.0);
    let sheet = builtin("sheet", None, None).unwrap();
    assert_eq!(
        isolate(&good, &sheet, &plain()),
        Err(IsolateError::Open { body: 1 })
    );
    let flat = ellipsoid([1.0, 1.0, 0.0], Vector3::zeros());
    assert_eq!(
        isolate(&flat, &good, &plain()),
        Err(IsolateError::NoVolume { body: 0 })
    );
    let mut crossed = ball(0.0, 0.0, 0.0);
    // One control point through the body and out at the other side.
    let far = 4 * 9 + 4;
    crossed.net_mut().points_mut()[far] = palpate_geometry::math::Point3::new(9.0, -15.0, 0.0);
    assert!(
        matches!(
            isolate(&crossed, &good, &plain()),
            Err(IsolateError::SelfIntersecting { body: 0, .. })
        ),
        "{:?}",
        isolate(&crossed, &good, &plain())
    );
    for gap in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-30, 1e3] {
        let spec = IsolateSpec {
            gap_m: Some(gap),
            ..plain()
        };
        assert!(
            matches!(isolate(&good, &good, &spec), Err(IsolateError::Gap { .. })),
            "{gap}"
        );
    }
    for turn in [-1.0, f64::NAN, 181.0] {
        let spec = IsolateSpec {
            max_turn_deg: Some(turn),
            ..plain()
        };
        assert!(
            matches!(isolate(&good, &good, &spec), Err(IsolateError::MaxTurn(_))),
            "{turn}"
        );
    }
    for cells in [[0, 9], [9, 2], [1 << 11, 1 << 11], [usize::MAX, 3]] {
        let spec = IsolateSpec {
            resolution: Resolution::Cells(cells),
            ..plain()
        };
        assert!(
            matches!(
                isolate(&good, &good, &spec),
                Err(IsolateError::Resolution { .. })
            ),
            "{cells:?}"
        );
    }
    let spec = IsolateSpec {
        warm_m: Some(Vector3::repeat(f64::NAN)),
        ..plain()
    };
    assert_eq!(isolate(&good, &good, &spec), Err(IsolateError::Warm));
    assert_eq!(
        isolate_all(std::slice::from_ref(&good), &plain()),
        Err(IsolateError::TooFew(1))
    );
    let mut infinite = good.clone();
    infinite.net_mut().points_mut()[3].x = f64::NAN;
    assert_eq!(
        isolate(&good, &infinite, &plain()),
        Err(IsolateError::TooLarge { body: 1 })
    );
}

#[test]
fn five_bodies_in_a_heap_come_apart_and_the_first_stays() {
    let bodies = [
        ball(0.0, 0.0, 0.0),
        ball(1.2, 0.1, 0.0),
        ball(0.5, 1.3, 0.1),
        ball(0.4, 0.3, 1.2),
        ball(0.3, 0.2, 0.1),
    ];
    let all = isolate_all(&bodies, &plain()).unwrap();
    assert_eq!(all.unsettled, None, "{:?}", all.moves);
    assert_eq!(all.translations_m[0], Vector3::zeros());
    let ready: Vec<Body> = bodies
        .iter()
        .enumerate()
        .map(|(k, s)| Body::new(s, [36, 21], k).unwrap())
        .collect();
    for j in 0..5 {
        for i in 0..j {
            let by = all.translations_m[j] - all.translations_m[i];
            assert!(!ready[j].overlaps(&by, &ready[i]), "bodies {i} and {j}");
        }
    }
    let last = all.moves.iter().map(|m| m.pass).max().unwrap();
    assert_eq!(all.passes, last + 1, "the last pass moves nothing");
}

// A ball between two walls that are nearer than it is wide: each pushes it into the other, for
// ever.
#[test]
fn a_body_with_no_room_between_two_others_is_named() {
    let walls = [
        block([-1.0, -9.0, -9.0], [0.0, 9.0, 9.0]),
        block([1.8, -9.0, -9.0], [3.8, 9.0, 9.0]),
        ball(0.9, 0.0, 0.0),
    ];
    let all = isolate_all(
        &walls,
        &IsolateSpec {
            exact: false,
            ..plain()
        },
    )
    .unwrap();
    match all.unsettled {
        Some(Unsettled::Passes {
            moving: 2,
            passes: 20,
            ..
        }) => {}
        // Pushed right through a wall: also apart.
        None => assert!(all.translations_m[2].norm() > 1.0, "{all:?}"),
        other => panic!("{other:?}"),
    }
}
