//! Tools pressed into a slab, against closed forms of the half-space: Hertz, Sneddon, a flat punch, Mindlin.
//!
//! The slab is 60 mm × 60 mm × 30 mm, E = 20 kPa, bonded to the floor; its nets have spans of 7.5, 5 and 3.75 mm.
//! Each tool touches on a node, within a cell, on an edge and beside one. What the layer goes in less than a half-space
//! is taken off (Dimitriadis et al. 2002, to first order).

use super::indent::{failed, settled};
use super::world::World;
use super::{Effort, Row};
use std::f64::consts::PI;

const YOUNG_PA: f64 = 20e3;
const THICKNESS_M: f64 = 0.03;
/// Spans a side.
const NETS: [usize; 3] = [8, 12, 16];
/// Places, in spans from a node.
const PLACES: [[f64; 2]; 4] = [[0.0, 0.0], [0.5, 0.5], [0.5, 0.0], [0.3, 0.1]];
/// Friction of the tool in Mindlin's case, and the share of it that the force across comes to.
const FRICTION: f64 = 0.5;
const HELD: f64 = 0.5;

/// A shape with a closed form.
#[derive(Clone, Copy)]
enum Tool {
    Ball { radius_m: f64 },
    Cone { half_angle_rad: f64 },
    Punch { radius_m: f64 },
}

impl Tool {
    fn shape(self) -> String {
        match self {
            Self::Ball { radius_m } => format!("{{ sphere = {{ radius_m = {radius_m:?} }} }}"),
            Self::Cone { half_angle_rad } => {
                format!("{{ cone = {{ half_angle_rad = {half_angle_rad:?}, height_m = 0.03 }} }}")
            }
            Self::Punch { radius_m } => {
                format!("{{ cylinder = {{ radius_m = {radius_m:?}, half_length_m = 0.02 }} }}")
            }
        }
    }

    /// How far its lowest point is below its reference point, m.
    fn low_m(self) -> f64 {
        match self {
            Self::Ball { radius_m } => radius_m,
            Self::Cone { .. } => 0.0,
            Self::Punch { .. } => 0.02,
        }
    }

    /// Force on a half-space, N.
    fn force_n(self, plane_pa: f64, depth_m: f64) -> f64 {
        match self {
            Self::Ball { radius_m } => 4.0 / 3.0 * plane_pa * radius_m.sqrt() * depth_m.powf(1.5),
            Self::Cone { half_angle_rad } => {
                2.0 / PI * plane_pa * depth_m * depth_m * libm::tan(half_angle_rad)
            }
            Self::Punch { radius_m } => 2.0 * plane_pa * radius_m * depth_m,
        }
    }
}

struct Case {
    name: &'static str,
    tool: Tool,
    depths_m: &'static [f64],
    /// Pressed into all bodies, not the first alone.
    of_all: bool,
}

const fn case(name: &'static str, tool: Tool, depths_m: &'static [f64], of_all: bool) -> Case {
    Case {
        name,
        tool,
        depths_m,
        of_all,
    }
}

const fn ball(radius_m: f64) -> Tool {
    Tool::Ball { radius_m }
}

const fn cone(half_angle_rad: f64) -> Tool {
    Tool::Cone { half_angle_rad }
}

const fn punch(radius_m: f64) -> Tool {
    Tool::Punch { radius_m }
}

const CASES: [Case; 9] = [
    case("hertz/1mm", ball(1e-3), &[0.1e-3, 0.2e-3], true),
    case("hertz/2mm", ball(2e-3), &[0.1e-3, 0.4e-3], true),
    case("hertz/5mm", ball(5e-3), &[0.25e-3, 0.5e-3], false),
    case("hertz/10mm", ball(10e-3), &[0.25e-3, 1e-3], true),
    case("sneddon/0.3rad", cone(0.3), &[0.5e-3, 1e-3], false),
    case("sneddon/0.7rad", cone(0.7), &[0.5e-3, 1e-3], true),
    case("sneddon/1.2rad", cone(1.2), &[0.5e-3, 1e-3], false),
    case("punch/4mm", punch(4e-3), &[0.5e-3], false),
    case("punch/8mm", punch(8e-3), &[0.5e-3], false),
];
/// A model, its Poisson's ratio, and the layers of a slab with so many spans a side.
type Body = (&'static str, f64, fn(usize) -> usize);

const BODIES: [Body; 5] = [
    ("continuum", 0.3, |spans| spans / 2 + 1),
    ("continuum", 0.45, |spans| spans / 2 + 1),
    ("continuum", 0.49, |spans| spans / 2 + 1),
    ("lattice", 0.25, |spans| spans / 2 + 1),
    ("net", 0.3, |_| 4),
];

/// A row a tool and body: the deviation that is largest over nets, places and depths.
pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    for (k, body) in BODIES.into_iter().enumerate() {
        for case in CASES.iter().filter(|case| k == 0 || case.of_all) {
            let name = format!("theory/{}/{}/{}", case.name, body.0, body.1);
            if wanted(&name) {
                out(row(&name, effort, &|at| pressed(case, body, at, effort)));
            }
        }
        let name = format!("theory/mindlin/10mm/{}/{}", body.0, body.1);
        if wanted(&name) {
            out(row(&name, effort, &|at| pushed(body, at, effort)));
        }
    }
}

/// The row of ratios to theory at spans and place.
fn row(
    name: &str,
    effort: Effort,
    ratios: &dyn Fn((usize, [f64; 2])) -> Result<Vec<f64>, String>,
) -> Row {
    let (nets, places) = match effort {
        Effort::Quick => (&NETS[..2], &PLACES[..2]),
        Effort::Full => (&NETS[..], &PLACES[..]),
    };
    let (mut worst, mut notes) = (0.0_f64, Vec::new());
    for &spans in nets {
        let mut of_net = Vec::new();
        for &at in places {
            match ratios((spans, at)) {
                Ok(found) => of_net.extend(found.iter().map(|ratio| ratio - 1.0)),
                Err(why) => return failed(name, &why),
            }
        }
        for off in &of_net {
            worst = if off.abs() > worst.abs() { *off } else { worst };
        }
        let least = of_net.iter().copied().fold(f64::INFINITY, f64::min);
        let most = of_net.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        notes.push(format!(
            "{:.2} mm {:+.1} … {:+.1} %",
            60.0 / spans as f64,
            least * 1e2,
            most * 1e2
        ));
    }
    let row = Row::new("deformation", name, "palpate").saying(notes.join(", "));
    row.off_by(worst, "of the force")
}

/// E / (1 − ν²), Pa.
fn plane_pa(poisson: f64) -> f64 {
    YOUNG_PA / (1.0 - poisson * poisson)
}

/// How much less far the layer goes in than a half-space, m/N.
fn layer_m_n(poisson: f64) -> f64 {
    let alpha = (1.2876 - 1.4678 * poisson + 1.3442 * poisson * poisson) / (1.0 - poisson);
    alpha / (PI * plane_pa(poisson) * THICKNESS_M)
}

/// The slab and a tool that a hand holds rigidly.
fn world((model, poisson, layers): Body, spans: usize, tool: Tool) -> Result<World, String> {
    let inner: Vec<f64> = (1..spans).map(|k| k as f64 / spans as f64).collect();
    let (layers, shape) = (layers(spans), tool.shape());
    World::new(&format!(
        r#"
[[body]]
id = "slab"
surface = {{ builtin = "sheet", net = [4, 4], size = 0.06 }}
model = "{model}"
material = {{ young_pa = {YOUNG_PA:?}, poisson = {poisson:?}, damping_s = 5e-3 }}
lattice = {{ thickness_m = {THICKNESS_M:?}, layers = {layers}, refine = {{ u = {inner:?}, v = {inner:?} }} }}
fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]

[[contact]]
pair = ["tool", "slab"]
friction = {{ mu = {FRICTION:?} }}

[[tool]]
id = "tool"
shape = {shape}
pose = {{ position = [0.0, 0.0, 0.04] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#
    ))
}

/// Ratios of forces at depths to those of theory.
fn pressed(
    case: &Case,
    body: Body,
    (spans, at): (usize, [f64; 2]),
    effort: Effort,
) -> Result<Vec<f64>, String> {
    let mut world = world(body, spans, case.tool)?;
    let mut hand = Hand::over(&case.tool, spans, at);
    let plane = plane_pa(body.1);
    let each = case.depths_m.iter().map(|&depth_m| {
        let force_n = hand.down_to(&mut world, depth_m, effort);
        let near_m = depth_m + layer_m_n(body.1) * force_n;
        force_n / case.tool.force_n(plane, near_m)
    });
    Ok(each.collect())
}

/// The hand that moves the tool.
struct Hand {
    place: [f64; 3],
    low_m: f64,
}

impl Hand {
    fn over(tool: &Tool, spans: usize, at: [f64; 2]) -> Self {
        let [x, y] = at.map(|share| share * 0.06 / spans as f64);
        Self {
            place: [x, y, tool.low_m() + 1e-4],
            low_m: tool.low_m(),
        }
    }

    /// Lowers the tool and holds it; its force, N.
    fn down_to(&mut self, world: &mut World, depth_m: f64, effort: Effort) -> f64 {
        let goal = self.low_m - depth_m;
        while self.place[2] > goal {
            self.place[2] = (self.place[2] - 4e-5).max(goal);
            world.at(self.place);
        }
        settled(1e-3, effort, || world.at(self.place).tools[0].force_n.z).force_n
    }
}

/// Mindlin's ratio: a pressed ball is pushed across until half of what friction holds.
fn pushed(body: Body, (spans, at): (usize, [f64; 2]), effort: Effort) -> Result<Vec<f64>, String> {
    let tool = Tool::Ball { radius_m: 0.01 };
    let mut world = world(body, spans, tool)?;
    let mut hand = Hand::over(&tool, spans, at);
    let force_n = hand.down_to(&mut world, 0.5e-3, effort);
    let shear_pa = YOUNG_PA / (2.0 * (1.0 + body.1));
    let radius_m = libm::cbrt(0.75 * force_n * 0.01 / plane_pa(body.1));
    // R. D. Mindlin (1949): u = 3 µ N (2 − ν) / (16 a G) (1 − (1 − T / (µ N))^⅔).
    let whole_m = 3.0 * FRICTION * force_n * (2.0 - body.1) / (16.0 * radius_m * shear_pa);
    let across_m = whole_m * (1.0 - libm::cbrt((1.0 - HELD).powi(2)));
    let from = hand.place[0];
    while hand.place[0] < from + across_m {
        hand.place[0] = (hand.place[0] + 1e-5).min(from + across_m);
        world.at(hand.place);
    }
    let held_n = settled(1e-3, effort, || -world.at(hand.place).tools[0].force_n.x).force_n;
    Ok(vec![held_n / (HELD * FRICTION * force_n)])
}
