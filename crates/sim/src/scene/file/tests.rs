//! What is wrong with a scene file stands where the file says it.

use super::*;

const GOOD: &str =
    "[[body]]\nid = \"drop\"\nsurface = { builtin = \"teardrop\" }\n\n[[tool]]\nid = \"ball\"\n";

fn problems(text: &str) -> String {
    parse(text, "s.toml", Path::new("."))
        .and_then(|loaded| loaded.build())
        .map_or_else(|e| e.to_string(), |_| "no problem".into())
}

#[test]
fn ten_lines_make_a_scene() {
    let loaded = parse(GOOD, "dir/drop.toml", Path::new(".")).unwrap();
    assert_eq!(loaded.spec.name.as_deref(), Some("drop"));
    assert_eq!(loaded.spec.loop_.rate_hz, 1_000);
}

// A straight way has one speed; the smooth one is 15/8 as fast in its middle.
#[test]
fn the_fastest_way_that_is_moved_depends_on_its_interpolation() {
    let scene = |interpolation: &str, speed: f64| {
        let way_m = 0.1 * speed;
        format!(
            "[[body]]\nid = \"x\"\nsurface = {{ builtin = \"sheet\" }}\nmotion = {{ interpolation = \"{interpolation}\", waypoint = \
             [{{ time_s = 0.0, position = [0.0, 0.0, 0.0] }}, {{ time_s = 0.1, position = [{way_m}, 0.0, 0.0] }}] }}\n"
        )
    };
    for (interpolation, moved, refused) in [("linear", 9.99, 10.01), ("smooth", 5.33, 5.34)] {
        assert_eq!(
            problems(&scene(interpolation, moved)),
            "no problem",
            "{interpolation}"
        );
        let problem = problems(&scene(interpolation, refused));
        assert!(
            problem.contains("the way there reaches 10.0 m/s"),
            "{problem}"
        );
    }
}

#[test]
fn every_problem_names_its_line() {
    let cases: [(&str, &str); 25] = [
        (
            "[loop]\nrate_hz = 0\n",
            "s.toml:2:1: rate_hz is 0; it must be 1 to 10000",
        ),
        (
            "[loop]\nrate = 5\n",
            "s.toml:2:1: \"rate\" is not known here; did you mean \"rate_hz\"?",
        ),
        (
            "[zenoh]\nconfig = \"bus.json5\"\n",
            "s.toml:1:2: a scene does not decide where the bus leads: give its configuration to `palpate serve` as \
             --zenoh-config FILE",
        ),
        ("[loop\n", "s.toml:1:6: "),
        (
            "[[body]]\nid = \"x\"\nsurface = { builtin = \"teardrip\" }\n",
            "s.toml:3:13: \"teardrip\" is not a builtin surface; did you mean \"teardrop\"?",
        ),
        (
            "[[body]]\nid = \"x\"\nsurface = { file = \"no.json\" }\n",
            "s.toml:3:13: there is no file",
        ),
        (
            "[[body]]\nid = \"x\"\nsurface = {}\n",
            "s.toml:3:1: surface needs exactly one",
        ),
        (
            "[[body]]\nid = \"x\"\nsurface = { builtin = \"sheet\" }\n[body.material]\nyoung_pa = -1.0\n",
            "s.toml:5:1: young_pa is -1",
        ),
        (
            "[[body]]\nid = \"x\"\nsurface = { builtin = \"sheet\" }\nlattice = { layers = 0 }\n",
            "s.toml:4:13: layers is 0",
        ),
        (
            "[[body]]\nid = \"X y\"\nsurface = { builtin = \"sheet\" }\n",
            "s.toml:2:1: \"X y\" is not a valid id",
        ),
        (
            "[[tool]]\nid = \"a\"\nshape = { sphere = { radius_m = 0.0 } }\n",
            "s.toml:3:22: radius_m is 0",
        ),
        (
            "[[tool]]\nid = \"a\"\n[[tool]]\nid = \"a\"\n",
            "s.toml:4:1: id \"a\" is taken",
        ),
        (
            "[[contact]]\npair = [\"ball\", \"drop\"]\nmethod = \"spheres\"\nresolution = [2, 82]\n",
            "s.toml:4:1: resolution is [2, 82]; each of the two must be 4 to 1000",
        ),
        (
            "[[body]]\nid = \"x\"\nsurface = { builtin = \"sheet\" }\nself_contact = true\n",
            "s.toml:4:1: a rigid body cannot come to touch itself",
        ),
        (
            "[[body]]\nid = \"x\"\nsurface = { builtin = \"sheet\" }\nmodel = \"membrane\"\nlattice = { thickness_m = 1e-3 }\nself_contact = true\n",
            "s.toml:6:1: a surface that is open has no inside",
        ),
        (
            "[[contact]]\npair = [\"pen\", \"drop\"]\n",
            "s.toml:2:1: there is no tool and no body \"pen\"",
        ),
        (
            "[[tool]]\nid = \"a\"\nfriction = { mu = -0.1 }\n",
            "s.toml:3:14: mu is -0.1; it must be 0 or more",
        ),
        (
            "[[tool]]\nid = \"a\"\nfriction = { mu = 0.3, mu_kinetic = 0.4 }\n",
            "s.toml:3:24: mu_kinetic is 0.4; it must be 0 to mu, which is 0.3",
        ),
        (
            "[[tool]]\nid = \"a\"\ngrip = { force_max_n = -1 }\n",
            "s.toml:3:10: force_max_n is -1; it must be 0 or more N (0: it never holds)",
        ),
        (
            "[[tool]]\nid = \"a\"\nshape = { sphere = { radius_m = 0.01 } }\naction = \"cut\"\n",
            "s.toml:4:1: only a plane cuts; give the tool the shape plane",
        ),
        (
            "[[contact]]\npair = [\"knife\", \"drop\"]\n[[tool]]\nid = \"knife\"\nshape = { plane = { normal = [0, 0, 1] } }\naction = \"cut\"\n",
            "s.toml:2:1: tool \"knife\" cuts and touches nothing",
        ),
        (
            "[[contact]]\npair = [\"ball\", \"drop\"]\nfriction = { mu = inf }\n",
            "s.toml:3:14: mu is inf; it must be 0, or from 1e-15 to 1e15",
        ),
        (
            "[[contact]]\npair = [\"ball\", \"drop\"]\nrestitution = 1.5\n",
            "s.toml:3:1: restitution is 1.5; it must be 0",
        ),
        (
            "[[contact]]\npair = [\"ball\", \"drop\"]\nrestitution = 0.5\n",
            "s.toml:3:1: only two rigid bodies of which one is free have a restitution",
        ),
        (
            "[[contact]]\npair = [\"drop\", \"drop\"]\nnear_field = true\n",
            "s.toml:3:1: only tools go into a body by what its net does not show",
        ),
    ];
    for (text, expected) in cases {
        // A whole scene around the case, after it, so that lines count from the case.
        let whole = if text.contains("[[body]]") {
            text.to_owned()
        } else {
            format!("{text}\n{GOOD}")
        };
        let reported = problems(&whole);
        assert!(
            reported.lines().any(|line| line.starts_with(expected)),
            "{text:?} gives\n{reported}\nnot\n{expected}"
        );
    }
}

#[test]
fn all_problems_are_listed_not_only_the_first() {
    let reported = problems(
        "[loop]\nrate_hz = 20000\n[record]\nnet_hz = 0.0\n[[body]]\nid = \"x\"\nsurface = { builtin = \"cube\" }\n",
    );
    assert_eq!(reported.lines().count(), 3, "{reported}");
}

#[test]
fn every_unknown_key_is_named_with_its_line() {
    let text = "nmae = \"x\"\n[[body]]\nid = \"drop\"\nsurface = { builtin = \"teardrop\", nett = [8, 8] }\n\
                materiel = 3\n[[tool]]\nid = \"ball\"\nshape = { sphere = { radius = 0.01, radius_m = 0.01 } }\n\
                [loop]\nrate = 1000\n";
    let error = parse(text, "s.toml", Path::new(".")).unwrap_err();
    let found: Vec<(usize, &str)> = (error.problems.iter())
        .map(|problem| {
            let word = problem.reason.split('"').nth(1).unwrap();
            (problem.place.as_ref().unwrap().line, word)
        })
        .collect();
    let expected = [
        (1, "nmae"),
        (4, "nett"),
        (5, "materiel"),
        (8, "radius"),
        (10, "rate"),
    ];
    assert_eq!(found, expected);
}

#[test]
fn unknown_keys_are_found_up_to_a_value_of_a_wrong_kind() {
    let text = "[[body]]\ncolour = \"red\"\nid = 3\nsurface = { builtin = \"teardrop\" }\n";
    let error = parse(text, "s.toml", Path::new(".")).unwrap_err();
    let lines = error
        .problems
        .iter()
        .map(|problem| problem.place.as_ref().unwrap().line);
    assert_eq!(lines.collect::<Vec<_>>(), [2, 3]);
}
