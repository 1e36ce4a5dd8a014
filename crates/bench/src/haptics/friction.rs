//! Where a ball begins to slip, and that it does not creep while it sticks.

use super::{Bar, Figure};
use palpate_sim::World;

fn sheet(mu: f64) -> String {
    format!(
        "[[body]]\nid = \"floor\"\nsurface = {{ builtin = \"sheet\", size = 0.2 }}\n[[tool]]\nid = \"ball\"\n\
         pose = {{ position = [0.0, 0.0, 0.03] }}\ncoupling = {{ stiffness_n_m = 1000.0, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 1e6, ramp_s = 0.0, speed_max_m_s = 1e6 }}\nfriction = {{ mu = {mu:?} }}\n"
    )
}

fn pressed(mu: f64) -> World {
    let mut world = crate::world(&sheet(mu));
    for height in [0.03, 0.0101, 0.008] {
        world.at([0.0, 0.0, height]);
    }
    world
}

pub(super) fn run(wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Figure)) {
    let figure = |case: &str, method: String, value, unit, reference, reference_is, bar| Figure {
        suite: "haptics",
        case: case.to_owned(),
        method,
        value,
        unit,
        reference,
        reference_is,
        bar: Some(Bar::AtMost(bar)),
        note: String::new(),
    };
    if wanted("friction/threshold") {
        for mu in [0.1, 0.3, 1.0] {
            let mut world = pressed(mu);
            let mut held: f64 = 0.0;
            for k in 0..4_000 {
                let tool = world
                    .at([0.001 * mu * f64::from(k) / 1_000.0, 0.0, 0.008])
                    .tools[0];
                if tool.proxy_position.x > 1e-9 {
                    break;
                }
                held = -tool.force_n.x / tool.force_n.z;
            }
            let mut row = figure(
                "friction/threshold",
                format!("μ = {mu}"),
                held,
                "1",
                mu,
                "μ",
                1.01 * mu,
            );
            row.note = format!("{:+.2} %", (held / mu - 1.0) * 100.0);
            out(row);
        }
    }
    if wanted("friction/drift") {
        let mut world = pressed(0.5);
        let mut place = [0.0; 2];
        let mut drift: f64 = 0.0;
        for k in 0..61_000 {
            // Held aside within the cone, trembling by 20 µm at 9 Hz.
            let tremble = 2e-5 * libm::sin(std::f64::consts::TAU * 9.0 * f64::from(k) * 1e-3);
            let tool = world
                .at([4e-4 + tremble, 1e-4 - tremble, 0.008 + 0.5 * tremble])
                .tools[0];
            let now = [tool.proxy_position.x, tool.proxy_position.y];
            if k < 1_000 {
                place = now;
            }
            drift = drift.max(libm::hypot(now[0] - place[0], now[1] - place[1]));
        }
        out(figure(
            "friction/drift",
            "60 s, trembling".to_owned(),
            drift,
            "m",
            0.0,
            "at rest",
            1e-9,
        ));
    }
}
