//! A block of plasticine pressed by a given force, then left alone: the thesis' figures 5.9 (force)
//! and 5.10 (stiffness).
//!
//! A ball of 10 mm on a block of 0.1 × 0.1 × 0.06 m, its bottom fixed, pressed in or pulled out by
//! its grip.

use super::indent::failed;
use super::scenes::plasticine_text;
use super::world::World;
use super::{Effort, Row};
use palpate_record::chart::{self, Chart, Curve, Scale};
use palpate_sim::solve::grip::GRAB;
use std::fmt::Write;

/// Stiffness of the thesis' plasticine, Pa.
const YOUNG_PA: f64 = 13e6;
/// Force of the sweep over stiffnesses, N.
const FORCE_N: f64 = 30.0;

/// Force over displacement of the thesis' plasticine under this ball, about, N/m.
const PRESS_N_M: f64 = 255e3;

/// What a force did to the block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Pulled by a grip instead of pressed.
    pub pulled: bool,
    /// N.
    pub force_n: f64,
    /// E, Pa.
    pub young_pa: f64,
    /// Of the surface's middle along the force, under it, m.
    pub loaded_m: f64,
    /// The same a second after it, m.
    pub kept_m: f64,
}

/// The cases and their forces and stiffnesses.
fn cases(effort: Effort) -> Vec<(String, bool, f64, f64)> {
    let mut cases = Vec::new();
    let (forces, stiffnesses): (&[u32], &[u32]) = match effort {
        Effort::Quick => (&[10, 30, 60], &[3, 13, 30]),
        Effort::Full => (&[10, 20, 30, 40, 50, 60], &[3, 5, 8, 13, 20, 30]),
    };
    for (pulled, way) in [(true, "pull"), (false, "press")] {
        for &force in forces {
            cases.push((
                format!("plasticine/force/{force}/{way}"),
                pulled,
                f64::from(force),
                YOUNG_PA,
            ));
        }
        for &mega in stiffnesses {
            let name = format!("plasticine/stiffness/{mega}/{way}");
            cases.push((name, pulled, FORCE_N, f64::from(mega) * 1e6));
        }
    }
    cases
}

pub(super) fn rows(
    effort: Effort,
    wanted: &dyn Fn(&str) -> bool,
    out: &mut dyn FnMut(Row),
) -> Vec<Sweep> {
    let mut sweeps = Vec::new();
    for (case, pulled, force_n, young_pa) in
        cases(effort).into_iter().filter(|(case, ..)| wanted(case))
    {
        match row(&case, pulled, force_n, young_pa, effort) {
            Ok((row, sweep)) => {
                out(row);
                sweeps.push(sweep);
            }
            Err(why) => out(failed(&case, &why)),
        }
    }
    sweeps
}

fn row(
    case: &str,
    pulled: bool,
    force_n: f64,
    young_pa: f64,
    effort: Effort,
) -> Result<(Row, Sweep), String> {
    let mut world = World::new(&plasticine_text(young_pa))?;
    let (force, sweep) = swept(&mut world, pulled, force_n, young_pa, effort);
    let note = format!(
        "{:.4} mm under the force, {:.4} mm stay",
        sweep.loaded_m * 1e3,
        sweep.kept_m * 1e3
    );
    let row = world.row(case, "lattice implicit", note);
    let row = row.off_by(force / force_n - 1.0, "of the load");
    Ok((row, sweep))
}

/// Presses or pulls the block of [`plasticine_text`] with a force and leaves it alone: the force at
/// the end of it, N, and what it did.
pub(super) fn swept(
    world: &mut World,
    pulled: bool,
    force_n: f64,
    young_pa: f64,
    effort: Effort,
) -> (f64, Sweep) {
    let held = if effort == Effort::Quick { 400 } else { 1_500 };
    let (button, along) = if pulled { (GRAB, 1.0) } else { (0, -1.0) };
    // From above: a tool that begins inside gives no force. Then a touch, so light that nothing flows; a grip takes
    // hold in it.
    world.pressing([0.0, 0.0, 0.0101], 0);
    let mut z = 0.01 - 1e-5;
    for _ in 0..20 {
        world.pressing([0.0, 0.0, z], button);
    }
    // A hand that keeps the force: each tick it makes up for a fiftieth of what is missing, by the
    // block's stiffness under this ball.
    let gain_m_n = 0.02 / (PRESS_N_M * young_pa / YOUNG_PA);
    let mut force = 0.0;
    for _ in 0..held {
        force = -along * world.pressing([0.0, 0.0, z], button).tools[0].force_n.z;
        z += along * gain_m_n * (force_n - force);
    }
    let loaded_m = along * middle(world);
    for _ in 0..held.min(1_000) {
        world.pressing([0.0, 0.0, 0.05], 0);
    }
    let sweep = Sweep {
        pulled,
        force_n,
        young_pa,
        loaded_m,
        kept_m: along * middle(world),
    };
    (force, sweep)
}

/// Height of the surface's middle, m; 0 at rest.
fn middle(world: &World) -> f64 {
    world.surface().point(0.5, 0.5).z
}

/// One line a sweep; nothing for none.
pub fn plasticine_table(sweeps: &[Sweep]) -> String {
    let mut text = String::new();
    for sweep in sweeps {
        let _ = writeln!(
            text,
            "plasticine {:<7} {:>5.0} N {:>6.0} MN/m²  {:>8.4} mm under load  {:>8.4} mm stay",
            if sweep.pulled { "pulled" } else { "pressed" },
            sweep.force_n,
            sweep.young_pa * 1e-6,
            sweep.loaded_m * 1e3,
            sweep.kept_m * 1e3
        );
    }
    text
}

/// Both sweeps, as an SVG document: displacement over force and over stiffness.
pub fn plasticine_picture(sweeps: &[Sweep]) -> String {
    let curves = |over_force: bool| {
        let mut curves = Vec::new();
        for (pulled, way) in [(true, "pulled"), (false, "pressed")] {
            let chosen: Vec<&Sweep> = sweeps
                .iter()
                .filter(|s| {
                    s.pulled == pulled
                        && if over_force {
                            s.young_pa == YOUNG_PA
                        } else {
                            s.force_n == FORCE_N
                        }
                })
                .collect();
            let mut add = |name: String, of: fn(&Sweep) -> f64| {
                let x = |s: &Sweep| {
                    if over_force {
                        s.force_n
                    } else {
                        s.young_pa * 1e-6
                    }
                };
                let mut points: Vec<(f64, f64)> =
                    chosen.iter().map(|s| (x(s), of(s) * 1e3)).collect();
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                points.dedup();
                curves.push(Curve {
                    name,
                    points,
                    lined: true,
                    hollow: !pulled,
                    titles: Vec::new(),
                });
            };
            add(format!("{way}, under load"), |s| s.loaded_m);
            add(format!("{way}, what stays"), |s| s.kept_m);
        }
        curves
    };
    let chart = |title: &str, across: &str, over_force| Chart {
        title: title.to_owned(),
        across: across.to_owned(),
        down: "displacement, mm".to_owned(),
        scales: [Scale::Linear, Scale::Linear],
        curves: curves(over_force),
    };
    chart::page(&[
        chart(
            "Plasticine, 13 MN/m², 2,500 kg/m³: displacement over force",
            "force, N",
            true,
        ),
        chart(
            "Plasticine under 30 N: displacement over stiffness",
            "Young's modulus, MN/m²",
            false,
        ),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(force_n: f64, young_pa: f64, loaded_m: f64) -> Sweep {
        Sweep {
            pulled: false,
            force_n,
            young_pa,
            loaded_m,
            kept_m: 0.5 * loaded_m,
        }
    }

    #[test]
    fn table_and_picture_show_every_sweep() {
        let sweeps = [
            sweep(10.0, YOUNG_PA, 1e-4),
            sweep(30.0, YOUNG_PA, 4e-4),
            sweep(30.0, 5e6, 9e-4),
        ];
        let text = plasticine_table(&sweeps);
        assert_eq!(text.lines().count(), 3);
        assert!(
            text.contains("0.9000 mm under load") && text.contains("0.4500 mm stay"),
            "{text}"
        );
        let svg = plasticine_picture(&sweeps);
        // Two sweeps over force and two over stiffness (30 N at 13 MN/m² is in both), each loaded
        // and kept.
        assert_eq!(svg.matches("<title>").count(), 8, "{svg}");
        assert_eq!(plasticine_table(&[]), "");
    }
}
