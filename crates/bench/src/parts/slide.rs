//! A ball slid over parts in the loop: time of a tick, contact that is lost, steps of the force.

use crate::measure::{Times, clocked};
use crate::{Effort, Row};
use palpate_geometry::math::{Point3, Random, Vector3};
use palpate_geometry::skin::SkinSolver;

pub(super) const STIFFNESS_N_M: f64 = 500.0;
pub(super) const RADIUS_M: f64 = 0.003;
/// How deep it is pressed.
pub(super) const PRESSED_M: f64 = 0.001;
/// From tick to tick: 20 mm/s.
const STEP_M: f64 = 2e-5;
/// Of [`STEP_M`]: a longer step is one over a hollow, where the path itself jumps.
const JUMP: f64 = 1.5;
/// Times that a step is halved to shorten it.
const HALVINGS: usize = 12;

/// Ticks of the way from 4 mm outside to the depth.
const APPROACH: usize = 200;

/// A part as the text of a STEP file, and a tool with its shape: text of the scene.
pub(super) fn scene(step: &str, shape: &str, start: [f64; 3]) -> String {
    let step = toml::Value::String(step.to_owned());
    format!(
        "[[body]]\nid = \"part\"\nsurface = {{ inline = {{ step = {step} }} }}\n\
         [[tool]]\nid = \"tool\"\nshape = {{ {shape} }}\n\
         pose = {{ position = {start:?} }}\n\
         coupling = {{ stiffness_n_m = {STIFFNESS_N_M:?}, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 500.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}\n"
    )
}

/// The shape of the ball.
pub(super) fn ball() -> String {
    format!("sphere = {{ radius_m = {RADIUS_M:?} }}")
}

/// A smooth way around a box, m, 4 mm outside of it.
fn around(t: f64, (low, high): (Point3, Point3)) -> Point3 {
    let half = (high - low) * 0.5;
    let (sin, cos) = (libm::sin, libm::cos);
    let direction = Vector3::new(
        cos(1.3 * t) * cos(0.7 * t),
        sin(1.3 * t) * cos(0.7 * t),
        sin(0.7 * t),
    );
    let reach = (0..3)
        .map(|c| half[c] / direction[c].abs().max(1e-9))
        .fold(f64::INFINITY, f64::min);
    low + half + direction * (reach + 0.004)
}

/// What came of the ticks.
#[derive(Default)]
struct Slide {
    times_s: Vec<f64>,
    pressed: usize,
    lost: usize,
    /// Largest step of the force in a tick, N, that of the way with it, m, and the largest of one over the other, over
    /// the stiffness.
    step_n: f64,
    way_m: f64,
    worst: f64,
}

/// Slides a ball over a part.
pub(super) fn slide(effort: Effort, step: &str, row: Row) -> Row {
    let (phases, ticks) = match effort {
        Effort::Quick => (3, 2_000),
        Effort::Full => (8, 10_000),
    };
    let mut random = Random(7);
    let mut slide = Slide::default();
    for _ in 0..phases {
        slide.once(step, random.float(0.0, 20.0), ticks);
    }
    let Slide {
        pressed,
        step_n,
        way_m,
        ..
    } = slide;
    Row {
        wrong: Some(slide.lost),
        ..row
            .timed(Times::of(slide.times_s))
            .off_by(slide.worst, "× the step of the way")
            .saying(format!(
                "{pressed} ticks pressed; largest step of the force {:.1} mN, of the way × K {:.1} mN",
                step_n * 1e3,
                STIFFNESS_N_M * way_m * 1e3
            ))
    }
}

impl Slide {
    fn once(&mut self, step: &str, phase: f64, ticks: usize) {
        let mut world = crate::world(&scene(step, &ball(), [0.0, 0.0, 0.5]));
        let skin = world.scene.skin(0).clone();
        let Some(part) = skin.part() else { return };
        let bounds = part.part().bounds();
        let mut solver = SkinSolver::new(&skin);
        // On the way from the place around the part to its closest point, so far from that.
        let mut place = |t: f64, away_m: f64| {
            let over = around(t, bounds);
            let foot = solver.closest(&skin, &over);
            foot.point + (over - foot.point) / foot.distance * away_m
        };
        for k in 0..=APPROACH {
            let away_m = RADIUS_M + PRESSED_M - 2.0 * PRESSED_M * k as f64 / APPROACH as f64;
            world.at(place(phase, away_m).into());
        }
        let away_m = RADIUS_M - PRESSED_M;
        let mut last = place(phase, away_m);
        let mut before = world.at(last.into()).tools[0].force_n;
        let (mut t, mut stride) = (phase, 5e-4);
        let mut seen = SkinSolver::new(&skin);
        for _ in 0..ticks {
            let mut at = place(t + stride, away_m);
            for _ in 0..HALVINGS {
                if (at - last).norm() <= JUMP * STEP_M {
                    break;
                }
                stride *= 0.5;
                at = place(t + stride, away_m);
            }
            t += stride;
            let way_m = (at - last).norm();
            let (took, tool) = clocked(|| world.at(at.into()).tools[0]);
            self.times_s.push(took.as_secs_f64());
            // Over a hollow the closest point may change to one of another side, which is nearer to the ball.
            let pressed = seen.closest(&skin, &at).distance < RADIUS_M - 1e-7;
            self.pressed += usize::from(pressed);
            self.lost += usize::from(pressed && tool.contact.is_none());
            if way_m <= JUMP * STEP_M && pressed {
                let step_n = (tool.force_n - before).norm();
                if step_n > self.step_n {
                    (self.step_n, self.way_m) = (step_n, way_m);
                }
                // In the middle of a turn the way is nothing, and so is the force but for rounding.
                self.worst = self
                    .worst
                    .max(step_n / STIFFNESS_N_M / (way_m + 1e-2 * STEP_M));
            }
            stride *= (STEP_M / way_m.max(1e-9)).clamp(0.5, 2.0);
            (last, before) = (at, tool.force_n);
        }
    }
}
