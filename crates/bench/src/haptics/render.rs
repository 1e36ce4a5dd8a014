//! Rendered force against the analytic one, along a path over a ball, a plane and a cylinder.

use super::{Bar, Figure};

/// Stiffness of the coupling, N/m, and radius of the tool, m.
const STIFFNESS_N_M: f64 = 800.0;
const TOOL_M: f64 = 0.005;
const BODY_M: f64 = 0.04;

/// Nearest point on the axis, plane or centre of a body, and how far its surface is from there.
type Core = fn([f64; 3]) -> ([f64; 3], f64);

pub(super) fn run(wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Figure)) {
    let bodies: [(&str, String, Core); 3] = [
        (
            "sphere",
            format!("{{ builtin = \"sphere\", size = {BODY_M} }}"),
            |_| ([0.0; 3], BODY_M),
        ),
        (
            "plane",
            "{ builtin = \"sheet\", size = 0.4 }".to_owned(),
            |p| ([p[0], p[1], 0.0], 0.0),
        ),
        ("cylinder", cylinder(), |p| ([0.0, 0.0, p[2]], BODY_M)),
    ];
    for (name, surface, core) in bodies {
        let case = format!("render/{name}");
        if !wanted(&case) {
            continue;
        }
        let (rms, worst, touched) = along_path(&surface, name, core);
        out(Figure {
            suite: "haptics",
            case,
            method: "ball of 5 mm, 800 N/m".to_owned(),
            value: rms,
            unit: "1",
            reference: 0.0,
            reference_is: "analytic",
            bar: Some(Bar::AtMost(1e-3)),
            note: format!(
                "root mean square over that of the force; worst {worst:.1e}; {touched} ticks in touch"
            ),
        });
    }
}

/// The wall of a cylinder about z, as a quadratic NURBS.
fn cylinder() -> String {
    let ring = [
        (1, 0),
        (1, 1),
        (0, 1),
        (-1, 1),
        (-1, 0),
        (-1, -1),
        (0, -1),
        (1, -1),
        (1, 0),
    ];
    let points: Vec<String> = ring
        .iter()
        .map(|(x, y)| {
            let at = |z: f64| {
                format!(
                    "[{:?}, {:?}, {z:?}]",
                    BODY_M * f64::from(*x),
                    BODY_M * f64::from(*y)
                )
            };
            format!("[{}, {}]", at(-0.1), at(0.1))
        })
        .collect();
    let corner = std::f64::consts::FRAC_1_SQRT_2;
    let weights: Vec<String> = (0..9)
        .map(|k| {
            if k % 2 == 0 {
                "[1.0, 1.0]".to_owned()
            } else {
                format!("[{corner:?}, {corner:?}]")
            }
        })
        .collect();
    format!(
        "{{ inline = {{ format = \"palpate.surface.v1\", degree = [2, 1], periodic = [false, false], \
         knots = [[0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4], [0, 0, 1, 1]], points = [{}], weights = [{}] }} }}",
        points.join(", "),
        weights.join(", ")
    )
}

fn along_path(surface: &str, name: &str, core: Core) -> (f64, f64, usize) {
    let text = format!(
        "[[body]]\nid = \"body\"\nsurface = {surface}\n[[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = {TOOL_M} }} }}\n\
         pose = {{ position = [0.1, 0.02, 0.1] }}\ncoupling = {{ stiffness_n_m = {STIFFNESS_N_M:?}, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 100.0, ramp_s = 0.0, speed_max_m_s = 1000.0 }}\n"
    );
    let mut world = crate::world(&text);
    let path = |t: f64| -> [f64; 3] {
        // Out of and into the body by up to 3 mm, over it and round it.
        let depth = 0.003 * libm::sin(2.3 * t);
        let (a, b) = (0.9 * t + 0.3, 0.6 * libm::sin(0.7 * t));
        let far = BODY_M + TOOL_M - depth;
        match name {
            "plane" => [
                0.06 * libm::sin(1.1 * t),
                0.05 * libm::cos(0.8 * t),
                TOOL_M - depth,
            ],
            "cylinder" => [
                far * libm::cos(a),
                far * libm::sin(a),
                0.05 * libm::sin(0.7 * t),
            ],
            _ => [
                far * libm::cos(a) * libm::cos(b),
                far * libm::sin(a) * libm::cos(b),
                far * libm::sin(b),
            ],
        }
    };
    // Out of touch to the path's begin.
    let first = path(0.0);
    for k in 0..=200 {
        let out = 1.0 + 0.5 * (1.0 - f64::from(k) / 200.0);
        world.at(if name == "plane" {
            [first[0], first[1], first[2] + 0.1 * (out - 1.0)]
        } else {
            first.map(|x| x * out)
        });
    }
    let (mut squares, mut forces, mut worst, mut touched) = (0.0, 0.0, 0.0f64, 0);
    for k in 0..20_000 {
        let p = path(f64::from(k) * 1e-3);
        let (centre, radius) = core(p);
        let away = [p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]];
        let distance = (away[0] * away[0] + away[1] * away[1] + away[2] * away[2]).sqrt();
        let push = (STIFFNESS_N_M * (radius + TOOL_M - distance)).max(0.0);
        let force = world.at(p).tools[0].force_n;
        let miss: f64 = (0..3)
            .map(|c| force[c] - push * away[c] / distance)
            .map(|x| x * x)
            .sum();
        squares += miss;
        forces += push * push;
        worst = worst.max(miss.sqrt());
        touched += usize::from(push > 0.0);
    }
    let scale = (forces / touched.max(1) as f64).sqrt();
    ((squares / forces).sqrt(), worst / scale, touched)
}
