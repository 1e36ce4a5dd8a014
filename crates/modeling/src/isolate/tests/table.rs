//! The published table, method by method, on the published triangles.

use super::solved;
use crate::isolate::given::{self, GivenPair};
use crate::isolate::pair::Pair;
use crate::isolate::search::{SearchLimit, TranslationSearch, cone};
use crate::isolate::{Body, IsolateMethod, IsolateSpec, IsolateStatus, Isolated, Reason};
use palpate_geometry::math::Vector3;

fn strictly(pair: &GivenPair, bodies: &[Body; 2], method: IsolateMethod) -> Isolated {
    let spec = IsolateSpec {
        method,
        exact: false,
        fall_back: false,
        ..IsolateSpec::default()
    };
    solved(pair, bodies, &spec)
}

fn ratio(pair: &GivenPair, answer: &Isolated) -> f64 {
    answer.contact_m.norm() / pair.least_m
}

// The grids were inferred from the counts of triangles and the diagonals: both must fit, the latter
// to the six digits that the nets were published with.
#[test]
fn the_given_nets_on_the_given_grids_have_the_published_triangles_and_diameters() {
    let mut compared = 0;
    for given in given::all() {
        let [a, b] = given.bodies();
        let pair = Pair::new(&a, &b, Vector3::zeros());
        let Some(diameter) = given.document["diameter_m"].as_f64() else {
            continue;
        };
        let counts = [a.triangle_count(), b.triangle_count()].map(|n| n as u64);
        assert_eq!(
            counts,
            [0, 1].map(|k| given.document["triangles"][k].as_u64().unwrap()),
            "{}",
            given.name
        );
        assert!(
            (pair.diameter_m - diameter).abs() < 1e-6,
            "{}: {}",
            given.name,
            pair.diameter_m
        );
        compared += 1;
    }
    assert_eq!(compared, 12);
}

// Method 1 is left out: its first step lays one corner exactly on another, and whether that is
// overlap was a matter of rounding in the published runs (five of sixteen went on for ever).
// Identical bodies are left out of methods 2 to 6: the published figures come from lines of
// intersection that are noise, which are refused here.
#[test]
fn methods_2_to_7_reproduce_the_published_ratios_and_steps() {
    let methods = &IsolateMethod::ALL[1..7];
    let mut compared = 0;
    for given in given::all()
        .iter()
        .filter(|given| given.document["reference"].is_object())
    {
        let bodies = given.bodies();
        for &method in methods {
            let published = &given.document["reference"][method.name()];
            let answer = strictly(given, &bodies, method);
            if given.name.starts_with("16") {
                assert_eq!(
                    answer.status,
                    IsolateStatus::Failed(Reason::Coincident),
                    "{}",
                    given.name
                );
                continue;
            }
            let Some(wanted) = published["ratio"].as_f64() else {
                assert_eq!(
                    answer.status,
                    IsolateStatus::Failed(Reason::NoRegion),
                    "{} {method:?}",
                    given.name
                );
                continue;
            };
            let found = ratio(given, &answer);
            assert!(
                (found - wanted).abs() < 0.005,
                "{} {method:?}: {found}, published {wanted}",
                given.name
            );
            assert_eq!(
                u64::from(answer.steps),
                published["steps"].as_u64().unwrap(),
                "{} {method:?}",
                given.name
            );
            let turn = published["turn_deg"].as_f64().unwrap();
            let found = answer.turn_deg.unwrap();
            // The gaps differ by a tenth of a thousandth of the size, and method 7 has ties among
            // its blends.
            assert!(
                (found - turn).abs() < 1.0,
                "{} {method:?}: turn {found}, published {turn}",
                given.name
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 60);
}

#[test]
fn method_1_finds_the_published_exit_where_the_first_step_was_taken_for_free() {
    let mut same = 0;
    for given in given::all() {
        let published = &given.document["reference"]["1"];
        let (Some(wanted), Some(1)) = (published["ratio"].as_f64(), published["steps"].as_u64())
        else {
            continue;
        };
        let found = ratio(
            &given,
            &strictly(&given, &given.bodies(), IsolateMethod::Farthest),
        );
        assert!(
            (found - wanted).abs() < 0.005,
            "{}: {found}, published {wanted}",
            given.name
        );
        same += 1;
    }
    assert_eq!(same, 6);
}

// The bar is 1.05; the search reaches the known least length to a thousandth. A wrong basin is off
// by a tenth at least.
#[test]
fn the_global_search_reaches_the_least_known_length_of_every_pair() {
    for given in given::all() {
        let bodies = given.bodies();
        let answer = strictly(&given, &bodies, IsolateMethod::Global);
        assert_eq!(answer.status, IsolateStatus::Isolated, "{}", given.name);
        let found = ratio(&given, &answer);
        assert!((0.998..1.001).contains(&found), "{}: {found}", given.name);
        let again = strictly(&given, &bodies, IsolateMethod::Global);
        assert_eq!(again, answer, "{}: the same bits each time", given.name);
    }
}

// Negative control of the bar: what the local search is known to miss (deep ellipsoids, bar in a
// ring) must show.
#[test]
fn the_local_search_reaches_it_on_all_but_the_deep_and_wrapped_pairs() {
    for given in given::all() {
        let answer = strictly(&given, &given.bodies(), IsolateMethod::Local);
        let number = &given.name[..2];
        match number {
            "16" => assert_eq!(answer.status, IsolateStatus::Failed(Reason::NoStart)),
            "03" => assert!(
                (ratio(&given, &answer) - 1.3218).abs() < 0.01,
                "{}",
                ratio(&given, &answer)
            ),
            "09" => assert!(ratio(&given, &answer) > 10.0, "{}", ratio(&given, &answer)),
            _ => assert!(
                (0.998..1.01).contains(&ratio(&given, &answer)),
                "{number}: {}",
                ratio(&given, &answer)
            ),
        }
    }
}

// 300 directions instead of 14, six descents instead of two: the reference of the published table.
#[test]
fn no_spiral_of_three_hundred_directions_finds_a_shorter_way() {
    for given in given::all().iter().step_by(3) {
        let [a, b] = given.bodies();
        let mut pair = Pair::new(&a, &b, Vector3::zeros());
        let mut search = TranslationSearch {
            pair: &mut pair,
            limit: SearchLimit { most_rad: None },
        };
        let best = search
            .global(&cone(&Vector3::z(), std::f64::consts::PI, 300), 6)
            .unwrap();
        let found = best.norm() / given.least_m;
        assert!((0.998..1.001).contains(&found), "{}: {found}", given.name);
    }
}
