//! Solid tools pressed on parts and slid over them in the loop: time of a tick, contact that is lost.

use super::slide::{PRESSED_M, scene};
use crate::measure::{Times, clocked};
use crate::{Effort, Row};

/// Tools, and how far each reaches below its reference point, m.
pub(super) const TOOLS: [(&str, &str, f64); 3] = [
    (
        "box",
        "box = { half_extents_m = [0.006, 0.005, 0.004] }",
        0.004,
    ),
    (
        "capsule",
        "capsule = { radius_m = 0.003, half_length_m = 0.005 }",
        0.008,
    ),
    (
        "surface",
        "surface = { builtin = \"sphere\", size = 0.005 }",
        0.005,
    ),
];
/// Ticks of the way down.
const APPROACH: usize = 200;
/// Of the part's length, and rad a tick: to and fro.
const WAY: f64 = 0.2;
const TURN: f64 = 4e-3;

/// Presses a tool on the top of a part, in its middle, and moves it to and fro.
pub(super) fn press(
    effort: Effort,
    step: &str,
    (_, shape, below_m): (&str, &str, f64),
    row: Row,
) -> Row {
    let ticks = match effort {
        Effort::Quick => 500,
        Effort::Full => 3_000,
    };
    let mut world = crate::world(&scene(step, shape, [0.0, 0.0, 0.5]));
    let Some((low, high)) = world.scene.skin(0).part().map(|part| part.part().bounds()) else {
        return row.saying("no part".to_owned());
    };
    let middle = nalgebra::center(&low, &high);
    let over = |k: usize, away_m: f64| {
        let x = middle.x + WAY * (high.x - low.x) * libm::sin(TURN * k as f64);
        [x, middle.y, high.z + below_m + away_m]
    };
    for k in 0..=APPROACH {
        world.at(over(
            0,
            PRESSED_M - 2.0 * PRESSED_M * k as f64 / APPROACH as f64,
        ));
    }
    let mut touched = 0;
    let mut times_s = Vec::with_capacity(ticks);
    for k in 0..ticks {
        let (took, tool) = clocked(|| world.at(over(k, -PRESSED_M)).tools[0]);
        times_s.push(took.as_secs_f64());
        touched += usize::from(tool.contact.is_some());
    }
    row.timed(Times::of(times_s))
        .saying(format!("{touched} of {ticks} ticks in touch"))
}
