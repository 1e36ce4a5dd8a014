//! Tools of every kind on a rigid and on a soft body, in a hand: no more energy comes out than went
//! in.

use super::rig::Rig;
use super::{Bar, Figure};
use palpate_client::device::{DeviceModel, Goal, Hand};

/// Tool, how its reference point stands off the drop's side at first touch (m), and its coupling
/// for rotation.
const TOOLS: [(&str, &str, f64, &str); 5] = [
    ("point", "point = {}", 0.0, ""),
    ("sphere", "sphere = { radius_m = 0.01 }", 0.01, ""),
    ("plane", "plane = { normal = [-1.0, 0.0, 0.0] }", 0.0, ""),
    (
        "surface",
        "surface = { builtin = \"torus\", size = 0.01 }",
        0.014,
        "",
    ),
    (
        "bar",
        "cylinder = { radius_m = 0.006, half_length_m = 0.02 }",
        0.006,
        ", turning_stiffness_nm_rad = 0.3",
    ),
];

/// How far the side of the drop is from its axis at the height of the tools, m.
const SIDE_M: f64 = 0.0175;

pub(super) fn run(wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Figure)) {
    let model = DeviceModel::preset("ideal").unwrap_or_else(|error| panic!("{error}"));
    for (name, shape, off_m, turning) in TOOLS {
        for soft in [false, true] {
            let case = format!("energy/tool/{name}/{}", if soft { "soft" } else { "rigid" });
            if wanted(&case) {
                out(press(case, (shape, turning), SIDE_M + off_m, soft, &model));
            }
        }
    }
}

/// Five seconds: in by 5 mm, to and fro along the body by 5 mm, out, again.
fn press(
    case: String,
    (shape, turning): (&str, &str),
    touch_m: f64,
    soft: bool,
    model: &DeviceModel,
) -> Figure {
    let body = if soft {
        "model = \"lattice\"\nmaterial = { young_pa = 20e3, density_kg_m3 = 1000.0, damping_s = 2e-3 }\n\
         lattice = { layers = 2, refine = [12, 13] }\nfixed = [{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }]\n"
    } else {
        ""
    };
    let text = format!(
        "[[body]]\nid = \"drop\"\nsurface = {{ builtin = \"teardrop\" }}\n{body}[[tool]]\nid = \"tool\"\nshape = {{ {shape} }}\n\
         pose = {{ position = [0.08, 0.003, 0.045] }}\n\
         coupling = {{ stiffness_n_m = 800.0, damping_n_s_m = 0.0{turning} }}\n\
         device = {{ force_max_n = 100.0, ramp_s = 0.0, speed_max_m_s = 100.0 }}\nfriction = {{ mu = 0.3 }}\n"
    );
    let goal = |t_s: f64| {
        let (w, u) = (std::f64::consts::TAU * 0.4, std::f64::consts::TAU * 0.9);
        let share = 0.5 - 0.5 * libm::cos(w * t_s);
        let x = touch_m + 0.01 - 0.015 * share;
        let z = 0.045 + 0.005 * libm::sin(u * t_s);
        Goal::moving(
            [x, 0.003, z],
            [
                -0.0075 * w * libm::sin(w * t_s),
                0.0,
                0.005 * u * libm::cos(u * t_s),
            ],
        )
    };
    let mut rig = Rig::new(
        crate::world(&text),
        (model, &Hand::relaxed()),
        goal(0.0).position,
        0.0,
        None,
        1,
    );
    let (mut given, mut peak_n, mut touched): (f64, f64, usize) = (0.0, 0.0, 0);
    for _ in 0..5_000 {
        let out = rig.period(goal(rig.device.time_s() + 0.5e-3));
        given = given.max(-rig.device.energy().hand_j);
        peak_n = peak_n.max(out.force_n.norm());
        touched += usize::from(out.force_n.norm() > 0.0);
    }
    let energy = rig.device.energy();
    let note = format!(
        "{touched} ticks in touch, up to {peak_n:.2} N; the hand put in {:.2} mJ, of which {:.2} went into the loop",
        energy.hand_j * 1e3,
        energy.loop_j * 1e3
    );
    Figure {
        suite: "haptics",
        case,
        method: "more out than in".to_owned(),
        value: given,
        unit: "J",
        reference: 0.0,
        reference_is: "passive",
        bar: Some(Bar::AtMost(1e-12)),
        note,
    }
}
