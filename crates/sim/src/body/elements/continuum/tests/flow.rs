//! Plastic flow of cells: closed forms of a drawn bar, volume, energy.

use super::*;
use crate::body::material::Plastic;

const YOUNG_PA: f64 = 40e3;
const SIDE_M: f64 = 0.02;
const DT_S: f64 = 1e-3;

fn law(yield_strain: f64, hardening: f64) -> Plastic {
    Plastic {
        yield_strain,
        rate_per_s: 20.0,
        hardening,
        limit: 0.6,
        spread_m: 0.0,
    }
}

/// One cube of a solid that flows, drawn along x, with its sides free.
struct Bar {
    solid: ContinuumLaw,
    flow: CellFlow,
    metrics: Vec<Lane>,
    strains: Vec<Lane>,
    amounts: Vec<Lane>,
    /// Along and across, over those at first.
    stretches: [f64; 2],
}

impl Bar {
    fn new(poisson: f64, law: Plastic, at_centres: bool) -> Self {
        let grid = cuboid([1, 1, 1], [SIDE_M; 3]);
        let elastic = [Elastic {
            young_pa: YOUNG_PA,
            poisson,
        }];
        let solid = match at_centres {
            true => ContinuumLaw::at_centres(&grid, &elastic).unwrap(),
            false => ContinuumLaw::new(&grid, &elastic).unwrap(),
        };
        let flow = CellFlow::new(law, &solid, DT_S);
        let lanes = vec![[0.0; 4]; flow.strain_lanes()];
        Self {
            metrics: flow.rest().to_vec(),
            strains: lanes.clone(),
            amounts: lanes,
            flow,
            solid,
            stretches: [1.0; 2],
        }
    }

    fn places(&self) -> Vec<Lane> {
        let [along, across] = self.stretches;
        let of = |p: &Point3| [p.x * along, p.y * across, p.z * across, 0.0];
        self.solid.rest().iter().map(of).collect()
    }

    /// Force along x and y on the far ends, of E times the first section.
    fn stresses(&self) -> [f64; 2] {
        let places = self.places();
        let mut residual = vec![[0.0; 4]; places.len()];
        self.solid
            .add_forces_of(&self.metrics, None, &places, &mut residual);
        [0, 1].map(|axis| {
            let far = residual.iter().zip(self.solid.rest());
            let sum: f64 = far
                .filter(|(_, p)| p[axis] > 0.5 * SIDE_M)
                .map(|(f, _)| f[axis])
                .sum();
            -sum / (YOUNG_PA * SIDE_M * SIDE_M)
        })
    }

    /// Finds the stretch across that leaves the sides free, and, if a nominal stress over E is given,
    /// the stretch along that bears it.
    fn settle(&mut self, stress: Option<f64>) {
        for _ in 0..40 {
            let wanted = [stress.unwrap_or(self.stresses()[0]), 0.0];
            let now = self.stresses();
            let miss = [now[0] - wanted[0], now[1] - wanted[1]];
            let mut slopes = [[0.0; 2]; 2];
            for (k, slope) in slopes.iter_mut().enumerate() {
                let step = 1e-7;
                self.stretches[k] += step;
                let there = self.stresses();
                self.stretches[k] -= step;
                *slope = [0, 1].map(|axis| (there[axis] - now[axis]) / step);
            }
            match stress {
                None => self.stretches[1] -= miss[1] / slopes[1][1],
                Some(_) => {
                    let [[a, c], [b, d]] = slopes;
                    let det = a * d - b * c;
                    self.stretches[0] -= (d * miss[0] - b * miss[1]) / det;
                    self.stretches[1] -= (a * miss[1] - c * miss[0]) / det;
                }
            }
            if miss[1].abs() < 1e-12 && (stress.is_none() || miss[0].abs() < 1e-12) {
                return;
            }
        }
        panic!("no equilibrium at {:?}", self.stretches);
    }

    fn flow(&mut self) -> bool {
        let places = self.places();
        self.flow.flow(
            &self.solid,
            &places,
            &mut self.metrics,
            &mut self.strains,
            &mut self.amounts,
        )
    }

    /// Product of the plastic stretches, of each point.
    fn plastic_volumes(&self) -> Vec<f64> {
        let determinant = |lanes: &[Lane]| {
            let [xx, yy, zz, xy, xz, yz] = [0, 1, 2, 3, 4, 5].map(|row| lanes[row][0]);
            xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
        };
        let both = self.metrics.chunks(6).zip(self.flow.rest().chunks(6));
        both.map(|(now, first)| (determinant(first) / determinant(now)).sqrt())
            .collect()
    }
}

// Held at a strain ε: p' = r (ε − p − y − H p), so that σ / E = ε − p falls towards where it yields.
#[test]
fn a_bar_that_is_held_relaxes_as_the_closed_form_says() {
    let (strain, yields, hardening) = (5e-3, 1e-3, 0.5);
    for (poisson, at_centres) in [(0.0, false), (0.3, false), (0.3, true), (0.45, false)] {
        let mut bar = Bar::new(poisson, law(yields, hardening), at_centres);
        bar.stretches[0] = 1.0 + strain;
        for tick in 0..400 {
            bar.settle(None);
            let t = f64::from(tick) * DT_S;
            let plastic =
                (strain - yields) / (1.0 + hardening) * -libm::expm1(-20.0 * (1.0 + hardening) * t);
            // Stresses count per first section; strains are small.
            let stress = bar.stresses()[0];
            assert!(
                (stress / (strain - plastic) - 1.0).abs() < 0.01,
                "ν {poisson}, {t} s: {stress} instead of {}",
                strain - plastic
            );
            bar.flow();
        }
        for volume in bar.plastic_volumes() {
            assert!((volume - 1.0).abs() < 1e-12, "plastic volume {volume}");
        }
        // Taken back by a little it is elastic: E, and nothing flows.
        let (before, from) = (bar.stresses()[0], bar.stretches[0]);
        bar.stretches[0] -= 1e-4;
        bar.settle(None);
        let slope = (before - bar.stresses()[0]) / 1e-4 * from;
        assert!(
            (slope - 1.0).abs() < 0.01,
            "ν {poisson}: unloads with {slope} E"
        );
        assert!(!bar.flow(), "it flows while it is unloaded");
    }
}

// Under a constant load p' = r (σ / E − y − H p).
#[test]
fn a_bar_under_a_load_creeps_as_the_closed_form_says() {
    let (stress, yields, hardening) = (4e-3, 1e-3, 0.5);
    let mut bar = Bar::new(0.3, law(yields, hardening), false);
    for tick in 0..300 {
        bar.settle(Some(stress));
        let t = f64::from(tick) * DT_S;
        let plastic = (stress - yields) / hardening * -libm::expm1(-20.0 * hardening * t);
        let strain = bar.stretches[0] - 1.0;
        assert!(
            (strain / (stress + plastic) - 1.0).abs() < 0.012,
            "{t} s: {strain} instead of {}",
            stress + plastic
        );
        bar.flow();
    }
    // Half as much is below what it yields at by now, and springs back by σ / E.
    let drawn = bar.stretches[0];
    bar.settle(Some(0.5 * stress));
    let back = drawn - bar.stretches[0];
    assert!(
        (back / (0.5 * stress) - 1.0).abs() < 0.02,
        "springs back by {back}"
    );
    let volume = bar.stretches[0] * bar.stretches[1] * bar.stretches[1];
    // What is left of it is elastic: (1 − 2 ν) σ / E.
    assert!(
        (volume - 1.0 - 0.4 * 0.5 * stress).abs() < 2e-5,
        "volume {volume}"
    );
}

#[test]
fn flow_ends_at_its_limit_and_keeps_the_volume() {
    let mut bar = Bar::new(
        0.3,
        Plastic {
            limit: 0.2,
            ..law(0.0, 0.0)
        },
        false,
    );
    for tick in 0..3_000 {
        bar.stretches[0] = 1.0 + 1e-3 * f64::from(tick).min(600.0);
        bar.settle(None);
        bar.flow();
    }
    // Drawn to 1.6 of its length, of which 1.2 has flowed: 1.6 / 1.2 is elastic.
    let plastic = (bar.flow.rest()[0][0] / bar.metrics[0][0]).sqrt();
    assert!((plastic - 1.2).abs() < 1e-6, "plastic stretch {plastic}");
    assert!(bar.stresses()[0] > 0.2, "{:?}", bar.stresses());
    for volume in bar.plastic_volumes() {
        assert!((volume - 1.0).abs() < 1e-9, "plastic volume {volume}");
    }
}

#[test]
fn flow_never_makes_energy_and_forces_are_the_slope_of_what_is_left() {
    let grid = distorted(cuboid([3, 3, 2], [0.03, 0.03, 0.02]), 1e-3, 5);
    let elastic = vec![
        Elastic {
            young_pa: YOUNG_PA,
            poisson: 0.4
        };
        grid.cells.len()
    ];
    for spread_m in [0.0, 0.012] {
        let solid = ContinuumLaw::new(&grid, &elastic).unwrap();
        let flow = CellFlow::new(
            Plastic {
                spread_m,
                limit: 0.3,
                ..law(0.01, 0.1)
            },
            &solid,
            0.05,
        );
        let (mut metrics, mut random) = (flow.rest().to_vec(), Random(11));
        let mut strains = vec![[0.0; 4]; flow.strain_lanes()];
        let mut amounts = strains.clone();
        let mut fell_j = 0.0;
        let mut places: Vec<Lane> = Vec::new();
        for round in 0..60 {
            // Up to turned over.
            let by = 1e-3 * f64::from(round % 12 + 1);
            let of = |p: &Point3, d: Vector3| [p.x + d.x, p.y + d.y, p.z + d.z, 0.0];
            places = solid
                .rest()
                .iter()
                .map(|p| of(p, random.vector() * by))
                .collect();
            let before_j = solid.energy_flowed_j(&metrics, &places);
            flow.flow(&solid, &places, &mut metrics, &mut strains, &mut amounts);
            let after_j = solid.energy_flowed_j(&metrics, &places);
            assert!(
                after_j <= before_j * (1.0 + 1e-12),
                "spread {spread_m}, round {round}: {before_j} J became {after_j} J"
            );
            fell_j += before_j - after_j;
        }
        assert!(fell_j > 0.0, "nothing flowed");
        let mut residual = vec![[0.0; 4]; places.len()];
        solid.add_forces_of(&metrics, None, &places, &mut residual);
        let largest = residual
            .iter()
            .flatten()
            .fold(0.0f64, |a, f| a.max(f.abs()));
        for node in 0..places.len() {
            for axis in 0..3 {
                let step = 1e-8;
                let [above, below] = [step, -step].map(|step| {
                    let mut moved = places.clone();
                    moved[node][axis] += step;
                    solid.energy_flowed_j(&metrics, &moved)
                });
                let slope = (above - below) / (2.0 * step);
                assert!(
                    (residual[node][axis] + slope).abs() < 1e-5 * largest,
                    "{} is not {}",
                    residual[node][axis],
                    -slope
                );
            }
        }
    }
}
