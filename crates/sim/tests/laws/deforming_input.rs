//! What is wrong with the deforming part of a scene is reported where it is, before the first tick.

use palpate_sim::scene::file;
use std::path::Path;

/// Why a scene is refused.
fn refusal(text: &str) -> String {
    file::parse(text, "s.toml", Path::new("."))
        .and_then(|loaded| loaded.with(palpate_thesis::METHODS).build())
        .map_or_else(|error| error.to_string(), |_| String::new())
}

/// A slab with these lines below line 7.
fn slab(model: &str, more: &str) -> String {
    format!(
        "[[body]]\nid = \"slab\"\nsurface = {{ builtin = \"sheet\", net = [5, 5], size = 0.1 }}\nmodel = \"{model}\"\n\
         \n\n\n{more}\n[[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = 0.01 }} }}\n"
    )
}

const THICK: &str = "lattice = { thickness_m = 0.02, layers = 2, refine = \"none\" }\n";

// Lines of the file where something is written down wrongly.
#[test]
fn a_value_out_of_range_names_its_line() {
    let cases = [
        (
            "material = { preset = \"jely\" }",
            "8:14: \"jely\" is not a material; did you mean \"jelly\"?",
        ),
        (
            "material = { poisson = 0.5 }",
            "8:14: poisson is 0.5; it must be at least 0 and below 0.5",
        ),
        ("material = { poisson = nan }", "8:14: poisson is NaN"),
        ("material = { poisson = -0.1 }", "8:14: poisson is -0.1"),
        ("material = { young_pa = inf }", "8:14: young_pa is inf"),
        (
            "material = { density_kg_m3 = 0.0 }",
            "8:14: density_kg_m3 is 0",
        ),
        ("material = { damping_s = -1.0 }", "8:14: damping_s is -1"),
        (
            "material = { plastic = { yield_strain = 0.1, rate_per_s = 1.0, limit = 1.0 } }",
            "8:64: limit is 1; it must be",
        ),
        (
            "material = { plastic = { yield_strain = -0.1, rate_per_s = 1.0 } }",
            "8:26: yield_strain is -0.1",
        ),
        (
            "material = { plastic = { yield_strain = 0.1, rate_per_s = nan } }",
            "8:46: rate_per_s is NaN",
        ),
        (
            "material = { plastic = { yield_strain = 0.1, rate_per_s = 1.0, spread_m = -1.0 } }",
            "8:64: spread_m is -1",
        ),
        (
            "material = { stiffening = { ratio = 0.5 } }",
            "8:29: ratio is 0.5; it must be 1 to 1000",
        ),
        (
            "material = { stiffening = { least_length = 1.0 } }",
            "8:29: least_length is 1",
        ),
        (
            "integrator = { every = 0 }",
            "8:16: every is 0; it must be 1 to 100",
        ),
        (
            "integrator = { every = 101 }",
            "8:16: every is 101; it must be 1 to 100",
        ),
        (
            "integrator = { iterations = 0 }",
            "8:16: iterations is 0; it must be 1 to 10",
        ),
        (
            "integrator = { iterations = 2, every = 4 }",
            "8:16: iterations is 2 and every is 4: contact is settled between the iterations of one tick",
        ),
        ("integrator = { substeps = 1001 }", "8:16: substeps is 1001"),
        ("integrator = { sleep_m_s = -1.0 }", "8:16: sleep_m_s is -1"),
        ("integrator = { method = \"magic\" }", "8:"),
        (
            "lattice = { nodes = [1, 8, 8] }",
            "8:13: nodes is [1, 8, 8]; each must be 2 to",
        ),
        (
            "lattice = { nodes = [8, 8, 100000] }",
            "8:13: nodes is [8, 8, 100000]",
        ),
        ("lattice = { cycles = 0 }", "8:13: cycles is 0"),
        (
            "lattice = { cells_per_span = 9 }",
            "8:13: cells_per_span is 9; it must be 1 to 8",
        ),
        (
            "lattice = { layers = 1000000000 }",
            "8:13: layers is 1000000000; it must be 1 to 64",
        ),
        (
            "lattice = { refine = [1000, 1000] }",
            "8:13: 1000 x 1000 points in 3 layers are more than 64000 nodes",
        ),
        (
            "lattice = { cell_layers = 0 }",
            "8:13: cell_layers is 0; it must be 1 to 64",
        ),
        (
            "lattice = { thickness_m = -0.1 }",
            "8:13: thickness_m is -0.1",
        ),
        (
            "fixed = [{ u = [0.5, 0.1], v = [0.0, 1.0] }]",
            "8:10: u = [0.5, 0.1], v = [0.0, 1.0] is not a range",
        ),
        (
            "fixed = [{ u = [nan, 0.1], v = [0.0, 1.0] }]",
            "8:10: u = [NaN, 0.1]",
        ),
        (
            "fixed = [{ point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 0.0] }]",
            "8:37: ",
        ),
        (
            "[[body.region]]\nyoung_pa = 1e3",
            "8:1: a region needs exactly one of ball, box",
        ),
        (
            "[[body.region]]\nball = { centre = [0.0, 0.0, 0.0], radius_m = 0.1 }\n[[body.region]]\npoisson = 0.1",
            "10:1: a region needs exactly one of ball, box",
        ),
        (
            "[[body.region]]\nball = { centre = [0.0, 0.0, 0.0], radius_m = 0.0 }",
            "9:36: radius_m is 0",
        ),
        (
            "[[body.region]]\nbox = { low = [0.0, 0.0, 0.0], high = [1.0, 0.0, 1.0] }",
            "9:9: low = ",
        ),
        (
            "[[body.region]]\nball = { centre = [0.0, 0.0, 0.0], radius_m = 0.1 }\npoisson = 0.7",
            "10:1: poisson is 0.7",
        ),
    ];
    for (more, expected) in cases {
        let reported = refusal(&slab("lattice", more));
        let expected = format!("s.toml:{expected}");
        assert!(
            reported.lines().any(|line| line.starts_with(&expected)),
            "{more:?} gives\n{reported}\nnot\n{expected}"
        );
    }
    let frame = format!("[gravity]\nframe = \"hnd\"\n{}", slab("lattice", THICK));
    let reported = refusal(&frame);
    assert!(
        reported.starts_with("s.toml:2:1: there is no tool \"hnd\""),
        "{reported}"
    );
}

// What only shows when a body is built stands at its key too, or at the table that lacks it.
#[test]
fn what_does_not_go_together_names_its_key() {
    let cases = [
        (
            slab(
                "continuum",
                &format!("{THICK}integrator = {{ method = \"xpbd\" }}"),
            ),
            "body[0].integrator",
            "xpbd knows linear springs only",
        ),
        (
            slab(
                "net",
                &format!("{THICK}integrator = {{ method = \"xpbd\" }}"),
            ),
            "body[0].integrator",
            "xpbd moves nodes themselves",
        ),
        (
            slab("membrane", "lattice = { refine = \"none\" }"),
            "body[0].lattice.thickness_m",
            "needs a thickness",
        ),
        (
            slab("lattice", "lattice = { refine = \"none\" }"),
            "body[0].lattice.thickness_m",
            "needs a thickness",
        ),
        (
            slab(
                "membrane",
                &format!("{THICK}[[body.region]]\nball = {{ centre = [0, 0, 0], radius_m = 0.1 }}"),
            ),
            "body[0].region",
            "one material",
        ),
        (
            slab(
                "lattice",
                &format!(
                    "{THICK}fixed = [{{ u = [0.0, 1.0], v = [0.0, 1.0] }}, {{ point = [0, 0, 1], normal = [0, 0, 1] }}]"
                ),
            ),
            "body[0].lattice",
            "nodes are fixed: nothing can deform",
        ),
        (
            slab(
                "lattice",
                "lattice = { builder = \"transfinite\", nodes = [3, 3, 3], thickness_m = 0.02, refine = \"none\" }",
            ),
            "body[0].lattice",
            "control points are not seen by the",
        ),
        (
            slab(
                "lattice",
                &format!(
                    "{THICK}material = {{ young_pa = 200e9 }}\nintegrator = {{ method = \"explicit\" }}"
                ),
            ),
            "body[0].integrator",
            "substeps a tick, more than",
        ),
    ];
    for (text, key, why) in cases {
        let error = file::parse(&text, "s.toml", Path::new("."))
            .unwrap()
            .with(palpate_thesis::METHODS)
            .build()
            .unwrap_err();
        let found = error
            .problems
            .iter()
            .find(|problem| problem.path == key && problem.reason.contains(why));
        let Some(place) = found.and_then(|problem| problem.place.as_ref()) else {
            panic!("{text}\ngives\n{error}\nnot {key}: {why}");
        };
        // The key is written in this line, or the body does not write it at all.
        let last = key.rsplit('.').next().unwrap().split('[').next().unwrap();
        let line = text.lines().nth(place.line - 1).unwrap();
        assert!(
            line.contains(last)
                || line == "[[body]]"
                || key.starts_with("body[0].lattice.") && line.contains("lattice"),
            "{key} at line {}: {line}",
            place.line
        );
    }
}

// Problems of values and problems that only building finds come together, in order of lines.
#[test]
fn every_problem_of_a_scene_is_listed_at_once() {
    let text = "[[body]]\nid = \"slab\"\nsurface = { builtin = \"sheet\", net = [5, 5], size = 0.1 }\nmodel = \"membrane\"\n\n\
                [[body]]\nid = \"solid\"\nsurface = { builtin = \"sheet\", net = [5, 5], size = 0.1 }\nmodel = \"continuum\"\n\
                lattice = { thickness_m = 0.02, layers = 2, refine = \"none\" }\nintegrator = { method = \"xpbd\" }\n\n\
                [[tool]]\nid = \"ball\"\nshape = { cone = { half_angle_rad = 2.0, height_m = -1.0 } }\ngrip = { force_max_n = -1.0 }\n\n\
                [[tool]]\nid = \"pen\"\nshape = { implicit = { f = \"x +\" } }\n";
    let reported = refusal(text);
    let starts = [
        "s.toml:1:1: a membrane needs a thickness",
        "s.toml:11:1: xpbd knows linear springs only",
        "s.toml:15:20: half_angle_rad is 2; it must be between 0 and",
        "s.toml:15:42: height_m is -1; it must be a length",
        "s.toml:16:10: force_max_n is -1; it must be 0 or more N (0: it never holds)",
        "s.toml:20:24: ",
    ];
    let lines: Vec<&str> = reported.lines().collect();
    assert_eq!(lines.len(), starts.len(), "{reported}");
    for (line, start) in lines.iter().zip(starts) {
        assert!(line.starts_with(start), "{line}\nnot\n{start}");
    }
}
