//! Forces along straight ways over a fillet, a sharp edge and a thread.

use super::slide::{PRESSED_M, RADIUS_M, ball, scene};
use palpate_geometry::math::{Point3, Vector3};
use palpate_record::chart::{Chart, Curve, Scale, page};

/// m from tick to tick, 20 mm/s; and ticks from one drawn point to the next.
const STEP_M: f64 = 2e-5;
const DRAWN: usize = 5;
/// Length of a way, m.
const LENGTH_M: f64 = 0.02;

/// A ball on a straight way over a part.
struct Way {
    name: &'static str,
    step: &'static str,
    /// Where the device starts, and its direction.
    start: Point3,
    along: Vector3,
    /// Away from the part.
    up: Vector3,
}

fn ways() -> [Way; 3] {
    let over_m = RADIUS_M - PRESSED_M;
    [
        Way {
            name: "fillet of 4 mm",
            step: include_str!("../../../geometry/tests/data/parts/filleted_box.step"),
            start: Point3::new(0.046, 0.02, 0.02 + over_m),
            along: Vector3::x(),
            up: Vector3::z(),
        },
        Way {
            name: "sharp edge",
            step: include_str!("../../../geometry/tests/data/parts/text_cut.step"),
            start: Point3::new(0.045, 0.01, -over_m),
            along: -Vector3::y(),
            up: -Vector3::z(),
        },
        Way {
            name: "thread, pitch 4 mm",
            step: include_str!("../../../geometry/tests/data/parts/thread.step"),
            start: Point3::new(0.012 + over_m, 0.0, 0.016),
            along: -Vector3::z(),
            up: Vector3::x(),
        },
    ]
}

/// Force over way of each, mm and N.
fn curve(way: &Way) -> Vec<(f64, f64)> {
    let at = |along_m: f64, up_m: f64| -> [f64; 3] {
        (way.start + way.along * along_m + way.up * up_m).into()
    };
    let mut world = crate::world(&scene(way.step, &ball(), at(0.0, 2.0 * RADIUS_M)));
    for k in (0..200).rev() {
        world.at(at(0.0, 2.0 * RADIUS_M * f64::from(k) / 200.0));
    }
    let ticks = (LENGTH_M / STEP_M).round() as usize;
    let mut points = Vec::new();
    for k in 0..=ticks {
        let along_m = STEP_M * k as f64;
        let force_n = world.at(at(along_m, 0.0)).tools[0].force_n.norm();
        if k.is_multiple_of(DRAWN) {
            points.push((along_m * 1e3, force_n));
        }
    }
    points
}

/// Force of a ball of 3 mm with 500 N/m on straight ways: an SVG document.
pub fn parts_picture() -> String {
    let curves = ways().map(|way| Curve {
        name: way.name.to_owned(),
        points: curve(&way),
        lined: true,
        hollow: false,
        titles: Vec::new(),
    });
    page(&[Chart {
        title: "Force of a ball on a straight way over a part".to_owned(),
        across: "way, mm".to_owned(),
        down: "force, N".to_owned(),
        scales: [Scale::Linear, Scale::Linear],
        curves: curves.into(),
    }])
}
