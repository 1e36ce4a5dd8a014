//! Each kind of finding on a scene that has it, and none on one that has not.

use super::{Finding, FindingKind};
use crate::scene::{Scene, file};
use std::path::Path;

fn built(text: &str) -> Scene {
    let loaded = file::parse(text, "s.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"));
    loaded.build().unwrap_or_else(|e| panic!("{e}"))
}

fn findings(text: &str) -> Vec<Finding> {
    built(text).findings()
}

/// The one finding whose path begins so.
fn one(text: &str, path: &str) -> Finding {
    let mut found = findings(text);
    found.retain(|finding| finding.path.starts_with(path));
    assert_eq!(found.len(), 1, "{path}: {:#?}", findings(text));
    found.remove(0)
}

/// A slab of gel on its lower side, and a ball above it.
const SLAB: &str = r#"
[loop]
rate_hz = 1000
[[body]]
id = "slab"
surface = { builtin = "sheet", net = [5, 5], size = 0.1 }
model = "continuum"
material = { young_pa = 20e3 }
lattice = { layers = 2, refine = "none", thickness_m = 0.02 }
fixed = [{ point = [0.0, 0.0, -0.019], normal = [0.0, 0.0, 1.0] }]
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.0, 0.0, 0.03] }
"#;

/// A soft ball over a floor.
const BALL: &str = r#"
[gravity]
acceleration = [0.0, 0.0, -9.81]
[[body]]
id = "floor"
surface = { builtin = "sheet", size = 0.3 }
[[body]]
id = "ball"
surface = { builtin = "sphere", size = 0.03 }
pose = { position = [0.0, 0.0, 0.035] }
model = "lattice"
material = { young_pa = 20e3, density_kg_m3 = 1000.0 }
lattice = { layers = 1, refine = "none" }
"#;

fn slab(from: &str, to: &str) -> String {
    assert!(SLAB.contains(from), "{from}");
    SLAB.replace(from, to)
}

fn ball(from: &str, to: &str) -> String {
    assert!(BALL.contains(from), "{from}");
    BALL.replace(from, to)
}

#[test]
fn nothing_is_found_about_scenes_as_they_are_meant() {
    for text in [SLAB, BALL] {
        assert_eq!(findings(text), [], "{text}");
    }
}

#[test]
fn slips_of_units_are_asked_about_at_their_keys() {
    for (from, to, path, meant) in [
        ("20e3 }", "20.0 }", "body[0].material.young_pa", "(20 kPa)"),
        (
            "20e3 }",
            "20e3, density_kg_m3 = 1.05 }",
            "body[0].material.density_kg_m3",
            "1050 kg/m³",
        ),
        (
            "20e3 }",
            "20e3, damping_s = 2.0 }",
            "body[0].material.damping_s",
            "(2 ms)",
        ),
        (
            "rate_hz = 1000",
            "rate_hz = 1",
            "loop.rate_hz",
            "1000 Hz (1 kHz)",
        ),
        (
            "[[body]]",
            "[gravity]\nacceleration = [0.0, 0.0, -9810.0]\n[[body]]",
            "gravity",
            "9.81",
        ),
        ("0.03] }", "50.0] }", "tool[0].pose", "in millimetres?"),
        (
            "[[tool]]",
            "[[tool]]\nfriction = { mu = 30.0 }",
            "tool[0].friction.mu",
            "0.3 (30 %)",
        ),
        (
            "[[tool]]",
            "[[tool]]\ncoupling = { stiffness_n_m = 1.0 }",
            "tool[0].coupling",
            "(1 N/mm)",
        ),
        (
            "[[tool]]",
            "[[tool]]\ndevice = { stale_s = 50.0 }",
            "tool[0].device.stale_s",
            "(50 ms)",
        ),
        (
            "radius_m = 0.01",
            "radius_m = 10.0",
            "tool[0].shape",
            "in millimetres?",
        ),
        (
            "\"none\"",
            "{ focus = [[20.0, 0.0, 0.0]] }",
            "body[0].lattice.refine",
            "m, in the body's frame",
        ),
    ] {
        let found = one(&slab(from, to), path);
        assert_eq!(found.kind, FindingKind::Unusual, "{found:?}");
        assert!(found.what.contains(meant), "{found:?}");
    }
    let large = slab("size = 0.1", "size = 100.0").replace("0.02 }", "20.0 }");
    assert!(
        one(&large, "body[0].surface")
            .what
            .contains("in millimetres?")
    );
}

#[test]
fn what_has_no_effect_is_told() {
    let lattice = slab("model = \"continuum\"", "model = \"lattice\"");
    for (from, to, path) in [
        (
            "20e3 }",
            "20e3, poisson = 0.45 }",
            "body[0].material.poisson",
        ),
        (
            "fixed = [",
            "region = [{ ball = { centre = [0.0, 0.0, 5.0], radius_m = 0.01 } }]\nfixed = [",
            "body[0].region[0]",
        ),
        ("-0.019]", "-19.0]", "body[0].fixed[0]"),
    ] {
        let found = one(&lattice.replace(from, to), path);
        assert_eq!(found.kind, FindingKind::Unusual, "{found:?}");
    }
    let rigid = slab("model = \"continuum\"", "model = \"rigid\"");
    assert!(one(&rigid, "body[0].fixed").what.contains("has no effect"));
}

#[test]
fn a_body_that_nothing_holds_is_told() {
    let loose = slab(
        "fixed = [{ point = [0.0, 0.0, -0.019], normal = [0.0, 0.0, 1.0] }]",
        "",
    );
    let found = one(&loose, "body[0]");
    assert!(
        found.what.contains("the first touch pushes it away"),
        "{found:?}"
    );
    let falls = format!("[gravity]\nacceleration = [0.0, 0.0, -9.81]\n{loose}");
    assert!(one(&falls, "body[0]").what.contains("falls for ever"));
    // A floor holds it; a plane that cuts does not.
    let plane = "[[tool]]\nid = \"plane\"\nshape = { plane = { normal = [0, 0, 1] } }\n\
                 pose = { position = [0.0, 0.0, -0.1] }\n";
    assert_eq!(findings(&format!("{falls}{plane}")), []);
    let cuts = format!("{falls}{plane}action = \"cut\"\n");
    assert!(one(&cuts, "body[0]").what.contains("falls for ever"));
    let touches = |scene: &Scene| scene.pairs.iter().any(|pair| pair.tool() == Some(1));
    assert!(touches(&built(&format!("{falls}{plane}"))) && !touches(&built(&cuts)));
}

// A slab cut by a table, a soft ball in another, a rigid one in a soft one: which bodies and how deep.
#[test]
fn bodies_that_stand_in_each_other_are_not_to_run_and_others_are() {
    let second = |body: &str, at: &str| {
        format!("{BALL}[[body]]\nid = \"other\"\npose = {{ position = {at} }}\n{body}")
    };
    let soft = "surface = { builtin = \"sphere\", size = 0.03 }\nmodel = \"lattice\"\nlattice = { layers = 1, refine = \"none\" }\n";
    let firm = "surface = { builtin = \"sphere\", size = 0.03 }\n";
    let table = "surface = { builtin = \"sheet\", size = 0.3 }\n";
    for (body, at) in [
        (soft, "[0.04, 0.0, 0.035]"),
        (soft, "[0.02, 0.0, 0.045]"),
        (firm, "[0.0, 0.04, 0.035]"),
        (table, "[0.0, 0.0, 0.035]"),
        (table, "[0.0, 0.0, 0.055]"),
    ] {
        let text = second(body, at);
        let wrong: Vec<Finding> = (findings(&text).into_iter())
            .filter(|finding| finding.kind == FindingKind::Wrong)
            .collect();
        assert_eq!(wrong.len(), 1, "{body} at {at}: {wrong:?}");
        assert!(wrong[0].what.contains("stand") && wrong[0].what.contains("mm in each other"));
        let loaded = file::parse(&text, "s.toml", Path::new(".")).unwrap();
        let refused = Scene::build_to_run(&loaded.spec, Path::new(".")).unwrap_err();
        assert_eq!(refused.problems[0].path, "body[2].pose");
        // A recording of it is replayed.
        assert!(loaded.build().is_ok());
    }
    for (body, at) in [
        (soft, "[0.061, 0.0, 0.035]"),
        (soft, "[0.0588, 0.0, 0.035]"),
        (table, "[0.0, 0.0, 0.067]"),
        (table, "[0.2, 0.0, 0.035]"),
    ] {
        let found = findings(&second(body, at));
        let wrong = found
            .iter()
            .any(|finding| finding.kind == FindingKind::Wrong);
        assert!(!wrong, "{body} at {at}: {found:?}");
    }
}

#[test]
fn a_body_too_nearly_incompressible_is_not_to_run() {
    let at = |poisson: f64| slab("20e3 }", &format!("20e3, poisson = {poisson} }}"));
    assert_eq!(findings(&at(0.499)), []);
    let wrong = one(&at(0.4999), "body[0].material.poisson");
    assert_eq!(wrong.kind, FindingKind::Wrong);
    // In a part of it, too.
    let part = slab(
        "fixed = [",
        "region = [{ ball = { centre = [0.0, 0.0, -0.01], radius_m = 0.05 }, poisson = 0.4995 }]\nfixed = [",
    );
    assert_eq!(
        one(&part, "body[0].region[0].poisson").kind,
        FindingKind::Wrong
    );
}

#[test]
fn contacts_of_a_few_ticks_are_told_with_the_rate_that_gives_them_ten() {
    let stiff = ball("young_pa = 20e3", "young_pa = 20e6");
    let reported = one(&stiff, "body[1].material");
    assert!(reported.what.contains("ticks at 1 m/s"), "{reported:?}");
    assert!(reported.what.contains("rate_hz = "), "{reported:?}");
    let light = format!(
        "{}[[tool]]\nid = \"pen\"\npose = {{ position = [0.0, 0.0, 0.1] }}\n",
        ball("model = \"lattice\"", "free = true")
            .replace("lattice = { layers = 1, refine = \"none\" }", "")
            .replace("density_kg_m3 = 1000.0", "density_kg_m3 = 30.0")
    );
    let reported = one(&light, "tool[0].coupling.stiffness_n_m");
    assert!(reported.what.contains("% too low"), "{reported:?}");
    let heavy = light.replace("density_kg_m3 = 30.0", "density_kg_m3 = 3000.0");
    assert_eq!(findings(&heavy), []);
}

#[test]
fn free_bodies_of_very_different_masses_are_told() {
    let two = |density: f64| {
        format!(
            "{BALL}[[body]]\nid = \"lead\"\nsurface = {{ builtin = \"sphere\", size = 0.03 }}\npose = {{ position = [0.0, \
             0.0, 0.11] }}\nfree = true\nmaterial = {{ density_kg_m3 = {density} }}\n"
        )
    };
    assert_eq!(findings(&two(2_000.0)), []);
    let reported = one(&two(20_000.0), "body[2].material.density_kg_m3");
    assert!(
        reported.what.contains("times as heavy as ball"),
        "{reported:?}"
    );
}

#[test]
fn tools_that_start_inside_a_body_are_told_with_a_place_outside() {
    let text = format!("{BALL}[[tool]]\nid = \"pen\"\npose = {{ position = [0.0, 0.0, 0.05] }}\n");
    let reported = one(&text, "tool[0].pose");
    assert!(
        reported.what.contains("mm inside body ball"),
        "{reported:?}"
    );
}
