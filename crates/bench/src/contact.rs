//! The contact suite: the narrow phases and a triangle mesh on the same poses, each with its error.
//!
//! `exact` answers with certified queries, `spheres N` with points on an N × N grid, the mesh of
//! parry with 82 × 82 vertices of the surface. All but the warm queries first take over a net that
//! has moved: bounds, points, tree. "Cold" is a tool anywhere near, "warm" a rigid body and a tool
//! that wanders.

mod cones;
mod inputs;
mod methods;
mod oracle;
mod rigid;
mod solids;
mod still;
mod surfaces;
mod svg;

use self::inputs::{body, tool};
use self::methods::{Mesh, PARRY};
use super::measure::{Times, clocked, time};
use super::{Cases, Effort, Row};
use palpate_geometry::contact::ContactSet;
use palpate_geometry::surface::Surface;
use palpate_thesis::spheres::Spheres;
use std::time::Duration;

pub use self::svg::picture;

/// Nets of the table: the source thesis has 4 × 4 to 20 × 20.
const NETS: [usize; 9] = [4, 6, 8, 10, 12, 14, 16, 18, 20];
/// Resolutions of the table.
const RESOLUTIONS: [[usize; 2]; 5] = [[28, 28], [28, 82], [82, 82], [82, 244], [244, 244]];
/// Cells of each piece of a ball that is a mesh, 38 080 triangles and 100 880; and whether the tool wanders.
const MESHES: [(&str, [usize; 2], bool); 4] = [
    ("", [40, 24], false),
    ("/warm", [40, 24], true),
    ("/100k", [65, 39], false),
    ("/100k/warm", [65, 39], true),
];
/// Shares of a flat patch in touch, in percent.
const AREAS: [u32; 5] = [1, 5, 25, 50, 100];
/// Functions within 20 mm of the origin: two with kinks, and one without.
const FUNCTIONS: [(&str, &str); 3] = [
    (
        "box",
        "max(abs(x) - 0.0115, abs(y) - 0.0115, abs(z) - 0.0115)",
    ),
    (
        "lens",
        "max(hypot(hypot(x, y), z - 0.0102) - 0.0225, hypot(hypot(x, y), z + 0.0102) - 0.0225)",
    ),
    (
        "smooth-union",
        "-0.001*ln(exp((0.01 - hypot(hypot(x, y), z - 0.01))/0.001) + exp((0.01 - hypot(hypot(x, y), z + 0.01))/0.001))",
    ),
];
/// Radius of the ball, m; the bodies are about 0.1 m long.
const RADIUS_M: f64 = 0.01;

/// Runs cases of the suite. Each row is handed out as soon as
/// it is measured.
pub fn contact(effort: Effort, cases: Cases<'_>, out: &mut dyn FnMut(Row)) {
    let mut suite = Suite { effort, out };
    let wanted = |case: &str| cases.has(case);
    for (name, radius_m) in [("point", 0.0), ("sphere", RADIUS_M)] {
        for count in NETS {
            for (warm, temper) in [(false, "cold"), (true, "warm")] {
                let case = format!("{name}/{count}x{count}/{temper}");
                if wanted(&case) {
                    suite.ball(&case, &body(count), radius_m, warm, resolutions(count));
                }
            }
        }
    }
    for count in NETS {
        let case = format!("plane/{count}x{count}");
        if wanted(&case) {
            suite.plane(&case, &body(count), resolutions(count));
        }
    }
    for count in [8, 20] {
        let case = format!("implicit/{count}x{count}");
        if wanted(&case) {
            suite.implicit(&case, &body(count));
        }
        for (name, text) in FUNCTIONS {
            let case = format!("implicit/{count}x{count}/{name}");
            if wanted(&case) {
                suite.function(&case, &body(count), text);
            }
        }
        for (name, cells, warm) in MESHES {
            let case = format!("mesh/{count}x{count}{name}");
            if wanted(&case) {
                suite.mesh(&case, &body(count), cells, warm);
            }
        }
    }
    for count in NETS {
        // "When these surfaces just start colliding", and when they have.
        for (depth_m, name) in [(1e-3, ""), (4e-3, "/deep")] {
            let case = format!("surface/{count}x{count}{name}");
            if wanted(&case) && (name.is_empty() || count == 8 || count == 20) {
                suite.surfaces(
                    &case,
                    &body(count),
                    &tool(count),
                    depth_m,
                    resolutions(count),
                );
            }
        }
    }
    if wanted("curves/8x8") {
        suite.curves("curves/8x8", &body(8), &tool(8));
    }
    if wanted("self/sausage") {
        suite.sausage("self/sausage");
    }
    if wanted("self/sausage/followed") {
        suite.folding_sausage("self/sausage/followed");
    }
    if wanted("self/sausage/tick") {
        suite.pressed_sausage("self/sausage/tick");
    }
    if cases.are_chosen() {
        suite.still(&wanted);
        suite.rigid(&wanted);
    }
    suite.cones(&wanted);
    for percent in AREAS {
        for name in ["", "/sphere", "/plane"] {
            let case = format!("flat/{percent}{name}");
            if wanted(&case) {
                match name {
                    "" => suite.flat_surfaces(&case, percent),
                    "/sphere" => suite.flat_sphere(&case, percent),
                    _ => suite.flat_plane(&case, percent),
                }
            }
        }
    }
}

/// The whole dial on the nets of the thesis' second table, else its middle.
fn resolutions(count: usize) -> &'static [[usize; 2]] {
    if count == 8 || count == 20 {
        &RESOLUTIONS
    } else {
        &RESOLUTIONS[2..3]
    }
}

fn label([u, v]: [usize; 2]) -> String {
    if u == v {
        format!("spheres {u}")
    } else {
        format!("spheres {u}x{v}")
    }
}

/// How well a method did: its times, and its largest error where the answer is known.
struct Outcome {
    times: Times,
    error: f64,
}

/// Queries of a case, and the depth at some of them, m: below zero it stands for none.
struct Known {
    count: usize,
    depths: Vec<(usize, f64)>,
}

impl Known {
    /// Of about so many of the queries.
    fn of(count: usize, parts: usize, mut depth: impl FnMut(usize) -> f64) -> Self {
        let some = (0..count).step_by((count / parts).max(1));
        Self {
            count,
            depths: some.map(|k| (k, depth(k))).collect(),
        }
    }

    /// One depth, known at all queries, m.
    fn all(count: usize, depth_m: f64) -> Self {
        Self::of(count, count.max(1), |_| depth_m)
    }
}

struct Suite<'a> {
    effort: Effort,
    out: &'a mut dyn FnMut(Row),
}

impl Suite<'_> {
    fn count(&self, full: usize) -> usize {
        if self.effort == Effort::Quick {
            full / 20
        } else {
            full
        }
    }

    fn patience(&self) -> Duration {
        Duration::from_millis(if self.effort == Effort::Quick {
            100
        } else {
            3_000
        })
    }

    fn report(&mut self, case: &str, method: &str, peer: bool, result: &Outcome) {
        (self.out)(Row {
            peer,
            ..Row::new("contact", case, method)
                .timed(result.times)
                .off_by(result.error, "m")
        });
    }

    /// A row of a method of ours; the answer is the deepest contact.
    fn deepest(
        &mut self,
        case: &str,
        method: &str,
        known: &Known,
        mut ask: impl FnMut(usize, &mut ContactSet),
    ) {
        let mut set = ContactSet::new();
        let result = self.measure(known, |k| {
            let (time, ()) = clocked(|| ask(k, &mut set));
            (time, set.deepest().map(|c| c.depth_m))
        });
        self.report(case, method, false, &result);
    }

    /// Rows of points at some resolutions.
    fn spheres(
        &mut self,
        case: &str,
        surface: &Surface,
        resolutions: &[[usize; 2]],
        known: &Known,
        mut ask: impl FnMut(&mut Spheres, usize, &mut ContactSet),
    ) {
        for &rows in resolutions {
            let mut spheres = Spheres::new(surface, rows);
            self.deepest(case, &label(rows), known, |k, set| {
                ask(&mut spheres, k, set)
            });
        }
    }

    /// A row of the mesh.
    fn parry(
        &mut self,
        case: &str,
        surface: &Surface,
        known: &Known,
        mut ask: impl FnMut(&mut Mesh, usize) -> Option<f64>,
    ) {
        let mut mesh = Mesh::new(surface);
        let result = self.measure(known, |k| clocked(|| ask(&mut mesh, k)));
        self.report(case, PARRY, true, &result);
    }

    /// Times `ask` over the queries, and compares the depths it gives with those that are known.
    fn measure(
        &self,
        known: &Known,
        mut ask: impl FnMut(usize) -> (Duration, Option<f64>),
    ) -> Outcome {
        let mut depths = Vec::with_capacity(known.count);
        let times = time(known.count, self.patience(), |k| {
            let (time, depth) = ask(k);
            depths.push(depth);
            time
        });
        let miss = |&(k, exact): &(usize, f64)| match depths.get(k) {
            Some(Some(depth)) => (depth - exact.max(0.0)).abs(),
            Some(None) => exact.max(0.0),
            None => 0.0,
        };
        Outcome {
            times,
            error: known.depths.iter().map(miss).fold(0.0, f64::max),
        }
    }
}
