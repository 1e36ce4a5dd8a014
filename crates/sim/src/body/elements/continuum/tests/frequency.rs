//! First axial frequency of a bar, one end held: masses and steps of a body as its user has it.

use super::*;
use crate::body::{Inside, Integrator, Material, Solid, StepMatrix, StepSettings};

const YOUNG_PA: f64 = 20e3;
const DENSITY_KG_M3: f64 = 1_000.0;
const LONG_M: f64 = 0.1;
const SIDE_M: f64 = 0.01;
/// Steps in a period: backward Euler damps as ω dt / 2, and that moves the period by its square
/// only.
const STEPS: usize = 400;

/// √(E/ρ) / 4 L, Hz.
fn slender_hz() -> f64 {
    (YOUNG_PA / DENSITY_KG_M3).sqrt() / (4.0 * LONG_M)
}

/// Frequency of the tip over that of a slender bar: drawn out in its first mode by a strain of 1e-5
/// and let go, from the first to the third time it passes its rest.
fn ratio(across: usize, along: usize, poisson: f64, integrator: Integrator) -> f64 {
    let grid = cuboid([across, across, along], [SIDE_M, SIDE_M, LONG_M]);
    let material = Material {
        young_pa: YOUNG_PA,
        poisson,
        density_kg_m3: DENSITY_KG_M3,
        damping_s: 0.0,
        plastic: None,
        stiffening: None,
    };
    let fixed: Vec<bool> = grid.nodes.iter().map(|p| p.z == 0.0).collect();
    let solid = Solid::whole(
        &grid,
        &fixed,
        SIDE_M * SIDE_M * LONG_M,
        Inside::Continuum,
        |_| material,
    );
    let dt_s = 1.0 / (slender_hz() * STEPS as f64);
    let body = solid
        .build(
            &material,
            StepSettings {
                dt_s,
                integrator,
                sleep_m_s: 0.0,
            },
        )
        .unwrap();
    assert!((body.mass_kg() / (DENSITY_KG_M3 * SIDE_M * SIDE_M * LONG_M) - 1.0).abs() < 1e-12);
    let mut state = body.rest_state();
    let wave = std::f64::consts::FRAC_PI_2 / LONG_M;
    for (place, p) in state.positions.iter_mut().zip(&grid.nodes) {
        let strain = 1e-5 * libm::cos(wave * p.z);
        place.z += 1e-5 / wave * libm::sin(wave * p.z);
        if p.z > 0.0 {
            place.x -= poisson * strain * (p.x - 0.5 * SIDE_M);
            place.y -= poisson * strain * (p.y - 0.5 * SIDE_M);
        }
    }
    let tip: Vec<usize> = (0..grid.nodes.len())
        .filter(|&k| grid.nodes[k].z == LONG_M)
        .collect();
    let mut scratch = body.scratch();
    let mut passes_s = Vec::new();
    let mut before = 1.0;
    for step in 1..2 * STEPS {
        body.predict(&state, &mut scratch);
        body.advance(&mut state, &mut scratch);
        let out: f64 = tip.iter().map(|&k| state.positions[k].z - LONG_M).sum();
        if (out > 0.0) != (before > 0.0) {
            passes_s.push(dt_s * (step as f64 - out / (out - before)));
        }
        before = out;
    }
    1.0 / ((passes_s[2] - passes_s[0]) * slender_hz())
}

// Without lateral contraction each layer of nodes is one mass of a chain: f_h / f = sin x / x, x =
// π h / 4 L.
#[test]
fn axial_frequency_without_contraction_is_that_of_the_chain_of_masses() {
    let mut errors = Vec::new();
    for along in [5, 10, 20] {
        let x = std::f64::consts::FRAC_PI_4 / along as f64;
        let chain = libm::sin(x) / x;
        let explicit = ratio(1, along, 0.0, Integrator::Explicit { substeps: 1 });
        println!("{along} cells: f over the slender bar's {explicit:.6}, of the chain {chain:.6}");
        // Symplectic Euler quickens by (ω h)² / 24, a part in 1e5 here.
        assert!(
            (explicit / chain - 1.0).abs() < 3e-5,
            "{along} cells: {explicit}, the chain has {chain}"
        );
        errors.push((explicit - 1.0).abs());
    }
    let orders: Vec<f64> = errors
        .windows(2)
        .map(|pair| (pair[0] / pair[1]).log2())
        .collect();
    println!("order {orders:.2?}");
    assert!(
        errors[0] < 0.02 && errors.windows(2).all(|pair| pair[1] < 0.35 * pair[0]),
        "{errors:?}"
    );
}

// Rayleigh and Love: inertia of the sides' motion slows by 1 / √(1 + ν² k² a² / 6). The held end
// keeps its section, which shortens the bar by some of ν² of its side.
#[test]
fn first_axial_frequency_is_met_within_2_percent_by_every_method() {
    for poisson in [0.0, 0.3, 0.45] {
        let wave = std::f64::consts::FRAC_PI_2 * SIDE_M / LONG_M;
        let sides = 1.0 / (1.0 + poisson * poisson * wave * wave / 6.0).sqrt();
        let methods = [
            Integrator::Implicit {
                iterations: 1,
                matrix: StepMatrix::Auto,
            },
            Integrator::Implicit {
                iterations: 3,
                matrix: StepMatrix::Auto,
            },
            Integrator::Explicit { substeps: 1 },
        ];
        for method in methods {
            let share = ratio(2, 20, poisson, method) / sides;
            println!("ν = {poisson}, {method:?}: f over Rayleigh's {share:.5}");
            assert!(
                (share - 1.0).abs() < 0.02,
                "ν = {poisson}, {method:?}: {share}"
            );
        }
    }
}
