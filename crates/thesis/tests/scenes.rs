//! Scenes that name methods of this crate.

use palpate_sim::scene::SceneError;
use palpate_sim::scene::file::{self, Loaded};
use palpate_thesis::METHODS;
use std::path::Path;

fn scene(body: &str, contact: &str) -> Loaded {
    let text = format!(
        "[[body]]\nid = \"drop\"\nsurface = {{ builtin = \"teardrop\" }}\nmodel = \"lattice\"\n{body}\n\
         [[tool]]\nid = \"pen\"\nshape = {{ sphere = {{ radius_m = 0.005 }} }}\npose = {{ position = [0.2, 0.0, 0.0] }}\n{contact}"
    );
    file::parse(&text, "drop.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}"))
}

/// Lines of the file, keys and reasons.
fn problems(error: &SceneError) -> Vec<(usize, &str, &str)> {
    let line = |problem: &palpate_sim::scene::Problem| problem.place.as_ref().map_or(0, |p| p.line);
    (error.problems.iter())
        .map(|problem| (line(problem), &*problem.path, &*problem.reason))
        .collect()
}

#[test]
fn a_method_that_was_not_passed_is_refused_at_its_line_by_who_has_it() {
    let cases = [
        (
            "lattice = { builder = \"transfinite\", nodes = [8, 8, 8] }",
            "body[0].lattice.builder",
        ),
        (
            "lattice = { builder = \"som\", nodes = [8, 8, 8] }",
            "body[0].lattice.builder",
        ),
        (
            "material = { springs = \"seed\" }",
            "body[0].material.springs",
        ),
    ];
    for (body, key) in cases {
        let loaded = scene(body, "");
        refused_without(loaded, 5, key);
    }
    let contact = "[[contact]]\npair = [\"pen\", \"drop\"]\nmethod = \"spheres\"\n";
    refused_without(scene("", contact), 12, "contact[0].method");
}

/// Refused at this line and key without the methods, built with them.
fn refused_without(loaded: Loaded, line: usize, key: &str) {
    let error = loaded.build().unwrap_err();
    let [(at, path, reason)] = problems(&error)[..] else {
        panic!("{error}")
    };
    assert_eq!((at, path), (line, key), "{error}");
    assert!(
        reason.contains("the program `palpate`") && reason.contains("palpate_thesis::METHODS"),
        "{error}"
    );
    loaded
        .with(METHODS)
        .build()
        .unwrap_or_else(|e| panic!("{e}"));
}
