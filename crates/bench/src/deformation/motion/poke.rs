//! The teardrop poked at random with a limp coupling, and let go.
//!
//! In and out by up to 12 mm at up to half a metre a second; at the end of each way the ball jumps
//! aside by some millimetres in one tick, often inside the body.

use super::super::indent::first_touch;
use super::drop::{Drop, SIDE_M};
use super::held::larger;
use super::{Effort, Row, Setting, World, failed, row};
use palpate_geometry::math::Random;

/// Ticks of pokes, and the time afterwards, three times, in ticks.
const TICKS: usize = 3_000;
const REST: usize = 500;
const SEEDS: [u64; 3] = [7, 11, 23];
/// Where pokes begin before the surface, m, and how far they go from there.
const BEFORE_M: f64 = 2e-3;
const DEEPEST_M: f64 = 12e-3;
/// Slowest and fastest, m/s.
const SPEED_M_S: [f64; 2] = [0.01, 0.5];
/// Widths of the jumps across and along the body, m.
const ASIDE_M: [f64; 2] = [4e-3, 6e-3];

/// Models with ν and d, ms.
const BODIES: [(&str, f64, u32); 11] = [
    ("continuum", 0.3, 2),
    ("continuum", 0.49, 2),
    ("continuum", 0.499, 2),
    ("net", 0.3, 2),
    ("net", 0.49, 2),
    ("continuum", 0.3, 0),
    ("continuum", 0.3, 5),
    ("continuum", 0.3, 20),
    ("continuum", 0.49, 0),
    ("continuum", 0.49, 5),
    ("continuum", 0.49, 20),
];

pub(super) fn rows(effort: Effort, wanted: &dyn Fn(&str) -> bool, out: &mut dyn FnMut(Row)) {
    let quick = effort == Effort::Quick;
    for (model, poisson, damping_ms) in BODIES {
        let case = format!("motion/poke/{model}/{poisson}/d{damping_ms}");
        let long = model == "net" || damping_ms != 2;
        if !wanted(&case) || (quick && long) {
            continue;
        }
        let seeds = if quick { &SEEDS[..1] } else { &SEEDS };
        for setting in [1, 2].map(Setting::auto) {
            let damping_s = f64::from(damping_ms) * 1e-3;
            let drop = Drop {
                coupling: "stiffness_n_m = 1000.0, damping_n_s_m = 1.0",
                device: "force_max_n = 20.0, ramp_s = 0.0",
                ..Drop::led(model, poisson, damping_s, setting)
            };
            let row = poked(&case, drop, seeds);
            out(row.unwrap_or_else(|why| failed(&case, &setting.method(), &why)));
        }
    }
}

/// Where the ball goes.
struct Pokes {
    random: Random,
    /// Along x where they begin, m.
    outside_m: f64,
    at: [f64; 3],
    goal_m: f64,
    speed_m_s: f64,
}

impl Pokes {
    fn new(seed: u64, touch_m: f64) -> Self {
        let outside_m = touch_m + BEFORE_M;
        Self {
            random: Random(seed),
            outside_m,
            at: [outside_m, SIDE_M[0], SIDE_M[1]],
            goal_m: outside_m,
            speed_m_s: 0.0,
        }
    }

    fn next(&mut self) -> [f64; 3] {
        if (self.at[0] - self.goal_m).abs() < 1e-9 {
            self.goal_m = self.outside_m - DEEPEST_M * self.random.unit();
            self.speed_m_s = self.random.float(SPEED_M_S[0], SPEED_M_S[1]);
            for k in 0..2 {
                self.at[k + 1] = SIDE_M[k] + 0.5 * ASIDE_M[k] * self.random.signed();
            }
        }
        let most_m = self.speed_m_s * 1e-3;
        self.at[0] += (self.goal_m - self.at[0]).clamp(-most_m, most_m);
        self.at
    }
}

/// The worst of all seeds.
#[derive(Default)]
struct Worst {
    force_n: f64,
    farthest_m: f64,
    /// From rest after each time, m.
    left_m: [f64; 3],
    faults: usize,
    ticks_s: Vec<f64>,
}

impl Worst {
    fn poke(&mut self, drop: Drop, seed: u64) -> Result<(), String> {
        let mut world = World::new(&drop.text())?;
        let mut pokes = Pokes::new(
            seed,
            first_touch(world.scene.rest_surface(0).expect("a surface")),
        );
        for _ in 0..TICKS {
            let force_n = world.at(pokes.next()).tools[0].force_n.norm();
            self.force_n = larger(self.force_n, force_n);
            self.farthest_m = larger(self.farthest_m, world.away_m()?);
        }
        for left_m in &mut self.left_m {
            for _ in 0..REST {
                world.at([0.2, SIDE_M[0], SIDE_M[1]]);
            }
            *left_m = larger(*left_m, world.away_m()?);
        }
        self.faults += world.faults;
        self.ticks_s.append(&mut world.ticks_s);
        Ok(())
    }
}

fn poked(case: &str, drop: Drop, seeds: &[u64]) -> Result<Row, String> {
    let mut worst = Worst::default();
    for &seed in seeds {
        worst.poke(drop, seed)?;
    }
    let note = format!(
        "at most {:.3} N and {:.1} mm; let go, from rest {} mm after 0.5, 1 and 1.5 s; {} faults in {} runs",
        worst.force_n,
        worst.farthest_m * 1e3,
        worst.left_m.map(|m| format!("{:.4}", m * 1e3)).join(", "),
        worst.faults,
        seeds.len(),
    );
    let error = (worst.left_m[2], "m from rest at the end");
    Ok(Row {
        wrong: Some(worst.faults),
        ..row(case, &drop.setting.method(), worst.ticks_s, error, note)
    })
}
