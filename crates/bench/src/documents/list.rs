//! All tables of documents that a program writes.

use crate::figure::{Figure, short};
use crate::suite::{Suite, matches, row_of};
use crate::table::seconds;
use crate::{Effort, Row};
use anyhow::{Context as _, ensure};
use palpate_experiment::scenario::{NAMES, Scenario, Settings};
use palpate_modeling::branch::{Measures, Tree, grow};
use std::fmt::Write as _;
use std::process::Command;

/// Ways and bodies whose estimates stand in a document: each way on each kind of body, as far as minutes last.
const TRUSTED: [&str; 8] = [
    "/press/50mm_s/continuum",
    "/press/200mm_s/continuum",
    "/press/200mm_s/lattice",
    "/press/200mm_s/net/0.3",
    "/slide/continuum",
    "/slide/lattice",
    "/poke/continuum",
    "/jump/continuum",
];

/// A table, where it stands and what it is of.
pub(super) struct Table {
    pub name: String,
    pub document: &'static str,
    /// Files and folders that it is measured from, from the root.
    pub inputs: Vec<String>,
    /// It depends on the bits of the simulation.
    pub of_simulation: bool,
    /// It has times of the machine.
    pub timed: bool,
    pub measure: Box<dyn Fn() -> anyhow::Result<String>>,
}

/// Rows of a suite: cases and methods, one `*` stands for anything.
#[derive(Clone, Copy)]
struct Rows(Suite, &'static [(&'static str, &'static str)]);

/// A column of a table of rows.
#[derive(Clone, Copy)]
enum Column {
    Median,
    P99,
    Error,
    Wrong,
    Note,
}

use Column::{Error, Median, Note, P99, Wrong};

const GEOMETRY: &str = "crates/geometry/src";

pub(super) fn tables() -> Vec<Table> {
    let mut all: Vec<Table> = NAMES.iter().map(|name| scenario(name)).collect();
    all.extend([
        rows(
            "surface",
            "docs/figures.md",
            &[Rows(
                Suite::Surface,
                &[
                    ("closest/*", "*"),
                    ("grid/*", "*"),
                    ("fit/*", "*"),
                    ("refresh-bounds/8x8", "*"),
                ],
            )],
            &[Median, P99, Error, Wrong],
            &[
                "crates/bench/src/surface.rs",
                "crates/bench/src/peers",
                GEOMETRY,
            ],
        ),
        rows(
            "contact",
            "docs/figures.md",
            &[Rows(
                Suite::Contact,
                &[
                    ("point/8x8/cold", "*"),
                    ("sphere/8x8/cold", "*"),
                    ("sphere/20x20/cold", "*"),
                    ("plane/8x8", "*"),
                    ("plane/20x20", "*"),
                    ("implicit/8x8", "*"),
                    ("mesh/8x8", "*"),
                    ("surface/8x8", "*"),
                    ("surface/20x20", "*"),
                    ("self/sausage", "*"),
                    ("flat/100", "*"),
                ],
            )],
            &[Median, P99, Error],
            &[
                "crates/bench/src/contact",
                "crates/thesis/src/spheres",
                "crates/bench/src/contact.rs",
                GEOMETRY,
            ],
        ),
        Table {
            of_simulation: true,
            ..rows_at(
                Effort::Quick,
                "deformation",
                "docs/figures.md",
                &[Rows(
                    Suite::Deformation,
                    &[
                        ("indent/12/x1", "lattice implicit"),
                        ("indent/12/x1", "continuum implicit"),
                        ("indent/12/x1000", "lattice implicit"),
                        ("indent/12/x1000", "continuum implicit"),
                        ("indent/12/net", "net implicit"),
                        ("indent/teardrop/*", "*"),
                    ],
                )],
                &[Error, Note],
                &[
                    "crates/bench/src/deformation/indent.rs",
                    "crates/bench/src/deformation/scenes.rs",
                ],
            )
        },
        Table {
            of_simulation: true,
            ..rows(
                "deformation times",
                "docs/figures.md",
                &[Rows(
                    Suite::Deformation,
                    &[("pass/*", "*"), ("tick/teardrop/*", "*")],
                )],
                &[Median, P99, Note],
                &[
                    "crates/bench/src/deformation/passes.rs",
                    "crates/bench/src/deformation/indent.rs",
                ],
            )
        },
        Table {
            of_simulation: true,
            timed: true,
            ..rows_at(
                Effort::Quick,
                "scaling",
                "docs/figures.md",
                &[Rows(
                    Suite::Scaling,
                    &[("scaling/side-by-side", "*"), ("scaling/*", "fit")],
                )],
                &[Median, Error, Note],
                &[
                    "crates/bench/src/deformation/scaling.rs",
                    "crates/bench/src/deformation/side_by_side.rs",
                ],
            )
        },
        Table {
            of_simulation: true,
            ..rows_at(
                Effort::Quick,
                "motion",
                "docs/figures.md",
                &[Rows(
                    Suite::Deformation,
                    &[
                        ("motion/ringdown/*", "palpate 1 it"),
                        ("motion/ringdown/*", "palpate 3 it"),
                        ("motion/frequency/*", "palpate 1 it"),
                        ("motion/press/*", "palpate 1 it"),
                        ("motion/press/*", "palpate 3 it"),
                        ("motion/bounce", "palpate 1 it"),
                        ("motion/bounce", "palpate 3 it"),
                        ("motion/spin/*", "palpate 1 it"),
                    ],
                )],
                &[Error],
                &[
                    "crates/bench/src/deformation/motion",
                    "crates/bench/src/exact_step",
                ],
            )
        },
        Table {
            of_simulation: true,
            ..rows_at(
                Effort::Quick,
                "cones",
                "docs/figures.md",
                &[Rows(Suite::Contact, &[("cones/*", "*")])],
                &[Error, Note],
                &["crates/bench/src/contact/cones.rs"],
            )
        },
        Table {
            of_simulation: true,
            ..rows_at(
                Effort::Quick,
                "theory",
                "docs/figures.md",
                &[Rows(Suite::Deformation, &[("theory/*", "*")])],
                &[Error, Note],
                &["crates/bench/src/deformation/theory.rs"],
            )
        },
        Table {
            of_simulation: true,
            ..rows_at(
                Effort::Quick,
                "engines",
                "docs/comparison.md",
                &[Rows(
                    Suite::Deformation,
                    &[("indent/12/x1", "*"), ("indent/12/x1000", "*")],
                )],
                &[Median, Error],
                &[
                    "benches/peers/deformation.py",
                    "crates/bench/src/peers/rapier.rs",
                    "crates/bench/src/deformation/indent.rs",
                    "crates/bench/src/deformation/peers.rs",
                    "crates/bench/src/deformation/scenes.rs",
                ],
            )
        },
        Table {
            of_simulation: true,
            measure: Box::new(|| {
                let mut rows = Vec::new();
                for part in TRUSTED {
                    let cases = crate::Cases::Containing(part);
                    crate::trust(Effort::Quick, cases, &mut |row| rows.push(row))
                        .map_err(anyhow::Error::msg)?;
                }
                Ok(crate::trust_table(&rows))
            }),
            ..table(
                "trust",
                "docs/comparison.md",
                &[
                    "crates/bench/src/deformation/motion/trust.rs",
                    "crates/bench/src/exact_step",
                ],
            )
        },
        Table {
            of_simulation: true,
            measure: Box::new(slides),
            ..table(
                "slides",
                "docs/contact.md",
                &[
                    "crates/bench/src/parts",
                    "crates/record/src/chart.rs",
                    GEOMETRY,
                ],
            )
        },
        Table {
            of_simulation: true,
            ..rows(
                "cuts",
                "docs/cut.md",
                &[Rows(Suite::Deformation, &[("cut/*", "*")])],
                &[Median, Error, Note],
                &["crates/bench/src/deformation/cuts.rs", GEOMETRY],
            )
        },
        Table {
            of_simulation: true,
            ..rows_at(
                Effort::Quick,
                "parts",
                "docs/figures.md",
                &[Rows(Suite::Parts, &[("slide/*", "*"), ("press/*", "*")])],
                &[Median, P99, Error, Wrong],
                &[
                    "crates/bench/src/parts/slide.rs",
                    "crates/bench/src/parts/press.rs",
                    GEOMETRY,
                ],
            )
        },
        rows(
            "contact and geometry",
            "docs/comparison.md",
            &[
                Rows(
                    Suite::Contact,
                    &[
                        ("sphere/8x8/cold", "exact"),
                        ("sphere/8x8/cold", "parry*"),
                        ("surface/8x8", "exact"),
                        ("surface/8x8", "parry*"),
                    ],
                ),
                Rows(
                    Suite::Surface,
                    &[("closest/cold/8x8", "*"), ("grid/82x82/normals", "*")],
                ),
            ],
            &[Median, P99, Error, Wrong],
            &[
                "crates/bench/src/contact",
                "crates/thesis/src/spheres",
                "crates/bench/src/surface.rs",
                "crates/bench/src/peers",
                GEOMETRY,
            ],
        ),
        figures(
            "haptics",
            "docs/figures.md",
            Rows(
                Suite::Haptics,
                &[
                    ("zwidth/*", "*"),
                    ("energy/*", "*"),
                    ("render/*", "*"),
                    ("friction/*", "*"),
                ],
            ),
            false,
        ),
        figures(
            "haptics times",
            "docs/figures.md",
            Rows(
                Suite::Haptics,
                &[("latency/*", "*"), ("lateness/*", "*"), ("rate/*", "*")],
            ),
            true,
        ),
        figures(
            "recordings",
            "docs/figures.md",
            Rows(
                Suite::Recording,
                &[
                    ("cost/tick", "*"),
                    ("size/teardrop", "*"),
                    ("loss/stall", "*"),
                    ("kill/*", "*"),
                    ("replay/speed", "*"),
                ],
            ),
            true,
        ),
        figures(
            "pages",
            "docs/figures.md",
            Rows(Suite::Viewer, &[("pages/*", "*")]),
            true,
        ),
        rows(
            "pipes",
            "docs/pipe.md",
            &[Rows(Suite::Modeling, &[("pipe/*", "*")])],
            &[Error, Wrong, Note],
            &[
                "crates/bench/src/modeling/pipe.rs",
                "crates/modeling/src/pipe",
                "crates/modeling/src/ipp",
            ],
        ),
        rows(
            "pipes times",
            "docs/pipe.md",
            &[Rows(Suite::Modeling, &[("pipe/*", "*")])],
            &[Median, P99],
            &[
                "crates/bench/src/modeling/pipe.rs",
                "crates/modeling/src/pipe",
                "crates/modeling/src/ipp",
            ],
        ),
        rows(
            "branches",
            "docs/branch.md",
            &[Rows(Suite::Modeling, &[("branch/*", "*")])],
            &[Error, Wrong, Note],
            &[
                "crates/bench/src/modeling/branch.rs",
                "crates/modeling/src/branch",
            ],
        ),
        rows(
            "branches times",
            "docs/branch.md",
            &[Rows(Suite::Modeling, &[("branch/*", "*")])],
            &[Median, P99],
            &[
                "crates/bench/src/modeling/branch.rs",
                "crates/modeling/src/branch",
            ],
        ),
        Table {
            measure: Box::new(trees),
            ..table(
                "trees",
                "docs/branch.md",
                &["crates/modeling/src/branch", GEOMETRY],
            )
        },
        isolation("isolation", false),
        isolation("isolation times", true),
        Table {
            measure: Box::new(|| printed(&["surface", "merge", "--cases"])),
            ..table(
                "merge",
                "docs/merge.md",
                &["crates/modeling/src/merge", GEOMETRY],
            )
        },
        rows(
            "merge times",
            "docs/merge.md",
            &[Rows(
                Suite::Modeling,
                &[
                    ("merge/case*", "constrained*"),
                    ("merge/case*", "seed C2 from scratch"),
                ],
            )],
            &[Median],
            &[
                "crates/bench/src/modeling/merge.rs",
                "crates/modeling/src/merge",
                GEOMETRY,
            ],
        ),
        rows(
            "random merges",
            "docs/merge.md",
            &[Rows(Suite::Modeling, &[("merge/random100", "*")])],
            &[Error, Note],
            &[
                "crates/bench/src/modeling/merge.rs",
                "crates/modeling/src/merge",
                GEOMETRY,
            ],
        ),
    ]);
    all
}

/// Without anything to measure.
fn table(name: &str, document: &'static str, inputs: &[&str]) -> Table {
    Table {
        name: name.to_owned(),
        document,
        inputs: inputs.iter().map(|input| (*input).to_owned()).collect(),
        of_simulation: false,
        timed: false,
        measure: Box::new(|| Ok(String::new())),
    }
}

/// What a scenario comes to.
fn scenario(name: &'static str) -> Table {
    let folder = format!("scenes/{name}");
    Table {
        of_simulation: true,
        measure: Box::new(move || {
            let report = Scenario::load(name)?.run(&Settings::default(), |_| {})?;
            Ok(report.markdown())
        }),
        ..table(
            &format!("scenario {name}"),
            "docs/scenarios.md",
            &[&folder, "crates/experiment/src/scenario"],
        )
    }
}

/// Rows of suites, a line each.
fn rows(
    name: &str,
    document: &'static str,
    from: &'static [Rows],
    columns: &'static [Column],
    inputs: &[&str],
) -> Table {
    rows_at(Effort::Full, name, document, from, columns, inputs)
}

fn rows_at(
    effort: Effort,
    name: &str,
    document: &'static str,
    from: &'static [Rows],
    columns: &'static [Column],
    inputs: &[&str],
) -> Table {
    let timed = columns.iter().any(|column| matches!(column, Median | P99));
    Table {
        timed,
        measure: Box::new(move || {
            let mut lines = vec![heading(columns)];
            for Rows(suite, patterns) in from {
                let asked: Vec<String> = patterns.iter().map(|(c, m)| row_of(c, m)).collect();
                let rows = suite.run(effort, &asked).rows;
                for (case, method) in *patterns {
                    let of = |row: &&Row| matches(case, &row.case) && matches(method, &row.method);
                    let before = lines.len();
                    lines.extend(rows.iter().filter(of).map(|row| line(row, columns)));
                    ensure!(
                        lines.len() > before,
                        "{case} {method}: there is no such row"
                    );
                }
            }
            Ok(markdown(&lines))
        }),
        ..table(name, document, inputs)
    }
}

fn heading(columns: &[Column]) -> Vec<String> {
    let name = |column: &Column| match column {
        Median => "median",
        P99 => "99th percentile",
        Error => "error",
        Wrong => "wrong answers",
        Note => "also",
    };
    let names = ["case", "method"]
        .into_iter()
        .chain(columns.iter().map(name));
    names.map(str::to_owned).collect()
}

fn line(row: &Row, columns: &[Column]) -> Vec<String> {
    let cell = |column: &Column| match column {
        Median => row.times.map(|times| seconds(times.median_s)),
        P99 => row.times.map(|times| seconds(times.p99_s)),
        Error => row.error.map(|error| match error.unit {
            // A share that is worth its percent.
            unit if unit.starts_with("of ") && (1e-5..10.0).contains(&error.value.abs()) => {
                format!("{:+.2} % {unit}", error.value * 100.0)
            }
            unit => format!("{:.1e} {unit}", error.value),
        }),
        Wrong => row.wrong.map(|wrong| wrong.to_string()),
        Note => Some(row.note.clone()),
    };
    let names = [format!("`{}`", row.case), row.method.clone()];
    let cells = columns
        .iter()
        .map(|column| cell(column).unwrap_or_default());
    names.into_iter().chain(cells).collect()
}

/// Figures of a suite, a line each.
fn figures(name: &str, document: &'static str, from: Rows, timed: bool) -> Table {
    let Rows(suite, patterns) = from;
    let source = match suite {
        Suite::Viewer => "crates/bench/src/viewer.rs".to_owned(),
        suite => format!("crates/bench/src/{}", suite.name()),
    };
    Table {
        of_simulation: true,
        timed,
        measure: Box::new(move || {
            let asked: Vec<String> = patterns.iter().map(|(c, m)| row_of(c, m)).collect();
            let measured = suite.run(Effort::Quick, &asked);
            ensure!(measured.failed.is_empty(), "{}", measured.failed.join("\n"));
            let mut lines = vec![
                ["quantity", "measured", "bar", "also"]
                    .map(str::to_owned)
                    .to_vec(),
            ];
            for (case, method) in patterns {
                let of = |figure: &&Figure| {
                    matches(case, &figure.case) && matches(method, &figure.method)
                };
                let before = lines.len();
                lines.extend(measured.figures.iter().filter(of).map(figure_line));
                ensure!(
                    lines.len() > before,
                    "{case} {method}: there is no such figure"
                );
            }
            Ok(markdown(&lines))
        }),
        ..table(name, document, &[&source])
    }
}

fn figure_line(figure: &Figure) -> Vec<String> {
    let unit = if figure.unit == "1" { "" } else { figure.unit };
    let met = if figure.is_met() { "" } else { " **missed**" };
    vec![
        format!("`{}` {}", figure.case, figure.method),
        format!("{} {unit}{met}", short(figure.value))
            .trim()
            .to_owned(),
        figure.bar.map_or(String::new(), |bar| bar.to_string()),
        figure.note.clone(),
    ]
}

/// Pairs of bodies, a line each: lengths by method, or times.
fn isolation(name: &str, timed: bool) -> Table {
    Table {
        timed,
        measure: Box::new(move || {
            let effort = if timed { Effort::Full } else { Effort::Quick };
            let measured = Suite::Modeling.run(effort, &["isolate/*".to_owned()]).rows;
            let methods: &[&str] = match timed {
                true => &["overlap", "local", "global", "surfaces"],
                false => &[
                    "1", "2", "3", "4", "5", "6", "7", "local", "global", "surfaces",
                ],
            };
            let mut lines: Vec<Vec<String>> = Vec::new();
            lines.push(
                ["pair"]
                    .iter()
                    .chain(methods)
                    .map(|name| (*name).to_owned())
                    .collect(),
            );
            let mut pairs: Vec<&str> = Vec::new();
            for row in &measured {
                if !pairs.contains(&row.method.as_str()) {
                    pairs.push(&row.method);
                }
            }
            for pair in pairs {
                let cell = |method: &&str| {
                    let ends = format!("/{method}");
                    let row = measured
                        .iter()
                        .find(|row| row.method == pair && row.case.ends_with(&ends));
                    let row = row.with_context(|| format!("{pair} has no row of {method}"))?;
                    anyhow::Ok(match timed {
                        true => row
                            .times
                            .map_or(String::new(), |times| seconds(times.median_s)),
                        false => length(row),
                    })
                };
                let cells: anyhow::Result<Vec<String>> = methods.iter().map(cell).collect();
                lines.push(std::iter::once(pair.to_owned()).chain(cells?).collect());
            }
            Ok(markdown(&lines))
        }),
        ..table(
            name,
            "docs/isolate.md",
            &[
                "crates/bench/src/modeling/isolate.rs",
                "crates/modeling/src/isolate",
            ],
        )
    }
}

/// Length over the least, and the steps of a method that takes steps, which its note tells.
fn length(row: &Row) -> String {
    let mut parts = row.note.split(", ");
    let steps = parts.find_map(|part| part.strip_suffix(" steps"));
    match (row.error, steps) {
        (None, _) => "none".to_owned(),
        (Some(error), Some("0") | None) => format!("{:.3}", 1.0 + error.value),
        (Some(error), Some(steps)) => format!("{:.3} / {steps}", 1.0 + error.value),
    }
}

/// The example trees, some with other degrees.
fn trees() -> anyhow::Result<String> {
    const Y: &str = include_str!("../../../modeling/src/branch/data/y.toml");
    const ASYMMETRIC: &str = include_str!("../../../modeling/src/branch/data/asymmetric.toml");
    const THREE: &str = include_str!("../../../modeling/src/branch/data/three.toml");
    const FOUR: &str = include_str!("../../../modeling/src/branch/data/four.toml");
    const TWISTED: &str = include_str!("../../../modeling/src/branch/data/twisted.toml");
    let all = [
        ("y", Y, [3, 2]),
        ("y", Y, [2, 2]),
        ("y", Y, [3, 3]),
        ("y", Y, [4, 3]),
        ("asymmetric", ASYMMETRIC, [3, 2]),
        ("three", THREE, [3, 2]),
        ("four", FOUR, [3, 2]),
        ("twisted", TWISTED, [3, 2]),
    ];
    let heading = [
        "tree",
        "degrees",
        "control points",
        "gap, m",
        "angle, °",
        "least sine",
        "Euler number, open ends",
        "folded edges, crossing pairs",
        "drawn, times",
    ];
    let mut lines = vec![heading.map(str::to_owned).to_vec()];
    for (name, text, [degree_u, degree_v]) in all {
        // A third tilted row lies beside the two that the examples have.
        let text = match degree_v {
            3 => text.replace("front = [0.15, 0.105]", "front = [0.15, 0.105, 0.06]"),
            _ => text.to_owned(),
        };
        let mut tree: Tree = toml::from_str(&text)?;
        (tree.degree_u, tree.degree_v) = (degree_u, degree_v);
        let grown = grow(&tree)?;
        let (measures, _) = Measures::of(&grown.surface, &grown.patches);
        let net = grown.surface.net();
        lines.push(vec![
            format!("`{name}`"),
            format!("{degree_u} × {degree_v}"),
            format!("{} × {}", net.rows(), net.columns()),
            format!("{:.1e}", measures.gap_m),
            format!("{:.1e}", measures.angle_deg),
            format!("{:.3}", measures.min_sine),
            format!("{}, {}", measures.euler, measures.loops),
            format!("{}, {}", measures.folded, measures.crossings),
            format!("{:.3}", measures.coverage),
        ]);
    }
    Ok(markdown(&lines))
}

/// Draws the forces of slides into a file of their own, and names it.
fn slides() -> anyhow::Result<String> {
    let path = super::root().join("docs/parts.svg");
    std::fs::write(&path, crate::parts_picture())
        .with_context(|| format!("cannot write {}", path.display()))?;
    Ok(
        "<img src=\"parts.svg\" alt=\"Force over the way of a ball of 3 mm on 500 N/m, pressed 1 mm: over a fillet and a \
        sharp edge it falls smoothly to zero, along a screw thread it rises and falls with the pitch\" width=\"640\">"
            .to_owned(),
    )
}

/// What a command of `palpate` prints.
fn printed(arguments: &[&str]) -> anyhow::Result<String> {
    let mut command = Command::new(std::env::current_exe()?);
    let output = command.arg("palpate").args(arguments).output()?;
    ensure!(
        output.status.success(),
        "palpate {}: {}",
        arguments.join(" "),
        String::from_utf8_lossy(&output.stderr)
    );
    Ok(String::from_utf8(output.stdout)?)
}

/// The first line is the heading.
fn markdown(lines: &[Vec<String>]) -> String {
    let mut text = String::new();
    for (k, line) in lines.iter().enumerate() {
        let cells: Vec<String> = line.iter().map(|cell| cell.replace('|', "\\|")).collect();
        let _ = writeln!(text, "| {} |", cells.join(" | "));
        if k == 0 {
            let _ = writeln!(text, "|{}", "---|".repeat(line.len()));
        }
    }
    text
}
