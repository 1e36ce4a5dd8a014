//! Torsion of a square bar, and what thin bars bend like: where cells lock.

use super::statics::{Elastostatic, Textbook, equilibrium, reactions};
use super::*;

const YOUNG_PA: f64 = 20e3;

/// Saint-Venant's torsion constant of a square of side 1: 0.140577.
fn square_torsion_constant() -> f64 {
    let term = |k: u32| {
        let odd = f64::from(2 * k + 1);
        libm::tanh(0.5 * std::f64::consts::PI * odd) / libm::pow(odd, 5.0)
    };
    (1.0 - 192.0 / libm::pow(std::f64::consts::PI, 5.0) * (0..40).map(term).sum::<f64>()) / 3.0
}

/// T / (dθ/dz) over G J: a bar of side a and length 3 a with its root clamped, so that its section
/// cannot warp there, and its tip turned, free to warp. The twist is measured between a and 2 a
/// from the root. By symmetry a quarter of the section does, with `half` cells along each side: at
/// x = 0 nothing moves along y and z, at y = 0 along x and z.
fn torsion(half: usize, poisson: f64) -> f64 {
    let (side, length, along) = (0.02, 0.06, 12);
    let grid = cuboid([half, half, along], [0.5 * side, 0.5 * side, length]);
    let solid = uniform(&grid, YOUNG_PA, poisson);
    // Strain of 1e-5 at the side.
    let turn = 2e-5 / side * length;
    let tip = |p: &Point3| p.z == length;
    let fixed = |p: &Point3, axis: usize| match axis {
        _ if p.z == 0.0 => Some(0.0),
        0 if p.y == 0.0 => Some(0.0),
        1 if p.x == 0.0 => Some(0.0),
        2 if p.x == 0.0 || p.y == 0.0 => Some(0.0),
        0 if tip(p) => Some(-turn * p.y),
        1 if tip(p) => Some(turn * p.x),
        _ => None,
    };
    let places = equilibrium(&solid, &fixed, &|_| Vector3::zeros());
    let reactions = reactions(&solid, &places);
    let of_tip = grid.nodes.iter().zip(&reactions).filter(|(p, _)| tip(p));
    let torque = 4.0 * of_tip.map(|(p, f)| p.x * f.y - p.y * f.x).sum::<f64>();
    // Sections turn as they are away from the ends: the mean over their nodes is the angle of each.
    let angle = |z: f64| {
        let (mut moment, mut size) = (0.0, 0.0);
        for (p, at) in grid
            .nodes
            .iter()
            .zip(&places)
            .filter(|(p, _)| (p.z - z).abs() < 1e-9)
        {
            moment += p.x * (at[1] - p.y) - p.y * (at[0] - p.x);
            size += p.x * p.x + p.y * p.y;
        }
        moment / size
    };
    let rate = |from: f64, to: f64| (angle(to * side) - angle(from * side)) / ((to - from) * side);
    let whole = rate(1.0, 2.0);
    assert!(
        (rate(1.0, 1.5) / whole - 1.0).abs() < 1e-3,
        "ν = {poisson}: the root is felt where the twist is measured"
    );
    let shear = YOUNG_PA / (2.0 * (1.0 + poisson));
    torque / whole / (shear * square_torsion_constant() * side.powi(4))
}

#[test]
fn twisted_square_bar_meets_saint_venant_with_order_2() {
    assert!((square_torsion_constant() - 0.140_577).abs() < 1e-6);
    for poisson in [0.0, 0.3, 0.49] {
        let errors = [2, 4, 8].map(|half| torsion(half, poisson) - 1.0);
        let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
        println!(
            "ν = {poisson}: G J at 4, 8, 16 cells a side off by {errors:.5?}, order {orders:.2?}"
        );
        // Warping that is continuous but not smooth enough only stiffens.
        assert!(errors.iter().all(|&e| e > 0.0), "ν = {poisson}: {errors:?}");
        assert!(
            errors[1] < 0.02 && errors[2] < 0.005,
            "ν = {poisson}: {errors:?}"
        );
        assert!(
            orders.iter().all(|order| (order - 2.0).abs() < 0.15),
            "ν = {poisson}: order {orders:?}"
        );
    }
}

/// Bending moment over that of a beam (a plate, if `wide`: no strain across) under the same
/// curvature. Ten times as long as thick, `layers` cells through the thickness, one across, each
/// `slender` times as long as thick; ends stay plane, all else is free: the curvature is even.
fn bending(
    build: &dyn Fn(&CellGrid) -> Box<dyn Elastostatic>,
    layers: usize,
    slender: f64,
    wide: bool,
) -> [f64; 2] {
    let (thick, long) = (0.01, 0.1);
    let along = (10.0 * layers as f64 / slender).round() as usize;
    // Strain of 1e-6 at the faces.
    let curvature = 2e-6 / thick;
    let grid = cuboid([along, layers, 1], [long, thick, thick]);
    let solid = build(&grid);
    let above = |p: &Point3| p.y - 0.5 * thick;
    let fixed = |p: &Point3, axis: usize| match axis {
        0 if p.x == 0.0 => Some(0.0),
        0 if p.x == long => Some(-curvature * long * above(p)),
        1 if p.x == 0.0 && p.y == 0.0 => Some(0.0),
        2 if wide || (p.x == 0.0 && p.y == 0.0 && p.z == 0.0) => Some(0.0),
        _ => None,
    };
    let places = equilibrium(solid.as_ref(), &fixed, &|_| Vector3::zeros());
    let of_nodes = reactions(solid.as_ref(), &places);
    let moment = |x: f64| -> f64 {
        let of_end = grid.nodes.iter().zip(&of_nodes).filter(|(p, _)| p.x == x);
        of_end.map(|(p, f)| -above(p) * f.x).sum::<f64>()
            / (curvature * YOUNG_PA * thick.powi(4) / 12.0)
    };
    [moment(long), -moment(0.0)]
}

// A cell bent to a curvature κ has the strains ε_xx = κ y and γ_xy = κ x of its corners, and ε_zz =
// d κ y of its sides, if they are free, with γ_yz = d κ z. Over μ κ² ⟨y²⟩ its energy is, with r =
// length / thickness, in the textbook       1 + ½ r² + 3/2 d² + ½ λ/μ (1 + d)², with mean
// dilatation  1 + ½ r² + 3/2 d² − 5/12 (1 + d)²: λ' = λ + 5/6 μ, but only on the mean of the
// volume, which does not change. ½ r² is the parasitic shear: either locks when its cells are long.
// A beam has 1 + ν, a plate 1 / (1 − ν). Layers stretch as they must, so n of them have 1 / n² of
// one's error.
#[test]
fn mean_dilatation_does_not_lock_where_the_textbook_does() {
    for (poisson, wide) in [(0.3, true), (0.49, true), (0.3, false), (0.49, false)] {
        let elastic = Elastic {
            young_pa: YOUNG_PA,
            poisson,
        };
        let lambda = 2.0 * poisson / (1.0 - 2.0 * poisson);
        let exact = if wide {
            1.0 / (1.0 - poisson)
        } else {
            1.0 + poisson
        };
        let plate = if wide {
            1.0 / (1.0 - poisson * poisson)
        } else {
            1.0
        };
        let ours =
            |grid: &CellGrid| Box::new(uniform(grid, YOUNG_PA, poisson)) as Box<dyn Elastostatic>;
        let textbook =
            |grid: &CellGrid| Box::new(Textbook::new(grid, &elastic)) as Box<dyn Elastostatic>;
        for slender in [1.0, 2.0, 5.0] {
            let shear = 0.5 * slender * slender;
            let (of_ours, of_textbook) = if wide {
                (1.0 - 5.0 / 12.0, 1.0 + 0.5 * lambda)
            } else {
                (11.0 / 26.0, 1.0 + 1.5 * lambda / (3.0 + lambda))
            };
            let expected = [of_ours, of_textbook].map(|cell| (cell + shear) / exact);
            let measured = [
                bending(&ours, 1, slender, wide),
                bending(&textbook, 1, slender, wide),
            ];
            let measured = measured.map(|ends| ends.map(|moment| moment / plate));
            let name = format!(
                "ν = {poisson}, {}, cells 1:{slender}",
                if wide { "plate" } else { "bar" }
            );
            println!(
                "{name}: moment over exact: ours {:.4}, textbook {:.4}",
                measured[0][0], measured[1][0]
            );
            for (ends, cell) in measured.iter().zip(expected) {
                assert!(
                    ends.iter().all(|end| (end / cell - 1.0).abs() < 1e-4),
                    "{name}: {ends:?}, not {cell}"
                );
            }
        }
    }
}

// Two and four layers: where the textbook's hexahedra are still off by a multiple, ours are by some
// percent.
#[test]
fn bent_plate_nears_the_exact_moment_with_the_square_of_its_layers_at_any_poisson_ratio() {
    for poisson in [0.0, 0.3, 0.49] {
        let plate = 1.0 / (1.0 - poisson * poisson);
        let elastic = Elastic {
            young_pa: YOUNG_PA,
            poisson,
        };
        let ours =
            |grid: &CellGrid| Box::new(uniform(grid, YOUNG_PA, poisson)) as Box<dyn Elastostatic>;
        let textbook =
            |grid: &CellGrid| Box::new(Textbook::new(grid, &elastic)) as Box<dyn Elastostatic>;
        let errors = |build: &dyn Fn(&CellGrid) -> Box<dyn Elastostatic>| {
            [1, 2, 4].map(|layers| bending(build, layers, 1.0, true)[0] / plate - 1.0)
        };
        let (ours, textbook) = (errors(&ours), errors(&textbook));
        println!(
            "ν = {poisson}: moment at 1, 2, 4 layers off by: ours {ours:.4?}, textbook {textbook:.4?}"
        );
        for pair in ours.windows(2) {
            assert!(
                (pair[0] / pair[1] - 4.0).abs() < 0.01,
                "ν = {poisson}: {ours:?}"
            );
        }
        assert!(ours[2].abs() < 0.03, "ν = {poisson}: {ours:?}");
        assert!(
            ours[2].abs() < 0.5 * textbook[2].abs(),
            "ν = {poisson}: ours {ours:?}, textbook {textbook:?}"
        );
        if poisson == 0.49 {
            assert!(
                textbook[0] > 10.0 && textbook[2] > 0.5,
                "the textbook's cells do not lock: {textbook:?}"
            );
        }
    }
}
