//! How errors fall as cells and steps become smaller, and a membrane whose answer is well known.

use super::statics::equilibrium;
use super::*;
use palpate_geometry::math::{Matrix3, gauss_legendre};

const SIDE_M: f64 = 0.1;
/// Of the manufactured displacement: strains of 0.06.
const AMPLITUDE_M: f64 = 0.02 * SIDE_M;
const YOUNG_PA: f64 = 20e3;

/// A displacement that is zero all round a cube, m, and its gradient.
fn manufactured(p: &Point3) -> (Vector3, Matrix3) {
    let along = Vector3::new(1.0, 0.5, -0.7) * AMPLITUDE_M;
    let wave = std::f64::consts::PI / SIDE_M;
    let (s, c) = (
        p.coords.map(|x| libm::sin(wave * x)),
        p.coords.map(|x| wave * libm::cos(wave * x)),
    );
    let slope = Vector3::new(c.x * s.y * s.z, s.x * c.y * s.z, s.x * s.y * c.z);
    (along * (s.x * s.y * s.z), along * slope.transpose())
}

/// First Piola stress of the law at a deformation gradient, Pa.
fn stress(elastic: &Elastic, f: &Matrix3) -> Matrix3 {
    let (shear, lame) = elastic.lame_pa();
    let (mu, lambda) = (4.0 / 3.0 * shear, lame + 5.0 / 6.0 * shear);
    let volume = f.determinant();
    let cofactor = f.try_inverse().unwrap().transpose() * volume;
    let grown = f.norm_squared() + 1.0;
    f * (mu * (1.0 - 1.0 / grown)) + cofactor * (lambda * (volume - 1.0) - 0.75 * mu)
}

/// Root of the mean square of the error of the displacement, m, where body forces hold the cube in the manufactured one;
/// `n` cells a side. Loads ∫ P ∇N dV and errors by 4³ points a cell.
fn error_m(n: usize, poisson: f64) -> f64 {
    let elastic = Elastic {
        young_pa: YOUNG_PA,
        poisson,
    };
    let grid = cuboid([n; 3], [SIDE_M; 3]);
    let solid = uniform(&grid, YOUNG_PA, poisson);
    let h = SIDE_M / n as f64;
    let rule = gauss_legendre(4);
    let mut points = Vec::new();
    for (a, wa) in &rule {
        for (b, wb) in &rule {
            for (c, wc) in &rule {
                points.push((
                    Vector3::new(*a, *b, *c).map(|x| 0.5 * (x + 1.0)),
                    wa * wb * wc / 8.0,
                ));
            }
        }
    }
    // Shape of a corner and its gradient; corners as those of a cell.
    let shape = |corner: usize, t: &Vector3| {
        let bit = |axis: usize| (corner >> (2 - axis)) & 1 == 1;
        let part = |axis: usize| if bit(axis) { t[axis] } else { 1.0 - t[axis] };
        let slope = |axis: usize| if bit(axis) { 1.0 / h } else { -1.0 / h };
        let [x, y, z] = [part(0), part(1), part(2)];
        (
            x * y * z,
            Vector3::new(slope(0) * y * z, x * slope(1) * z, x * y * slope(2)),
        )
    };
    let mut loads = vec![Vector3::zeros(); grid.nodes.len()];
    for cell in &grid.cells {
        let corner = grid.nodes[cell[0] as usize];
        for (t, weight) in &points {
            let (_, gradient) = manufactured(&(corner + t * h));
            let stress = stress(&elastic, &(Matrix3::identity() + gradient));
            for (k, &node) in cell.iter().enumerate() {
                loads[node as usize] += stress * shape(k, t).1 * (weight * h * h * h);
            }
        }
    }
    let edge = |x: f64| !(1e-9..=SIDE_M - 1e-9).contains(&x);
    let fixed = |p: &Point3, _: usize| p.iter().any(|&x| edge(x)).then_some(0.0);
    let places = equilibrium(&solid, &fixed, &|node| loads[node]);
    let mut sum = 0.0;
    for cell in &grid.cells {
        let corner = grid.nodes[cell[0] as usize];
        for (t, weight) in &points {
            let mut found = Vector3::zeros();
            for (k, &node) in cell.iter().enumerate() {
                let [x, y, z, _] = places[node as usize];
                found += (Point3::new(x, y, z) - grid.nodes[node as usize]) * shape(k, t).0;
            }
            sum += (found - manufactured(&(corner + t * h)).0).norm_squared() * weight * h * h * h;
        }
    }
    (sum / SIDE_M.powi(3)).sqrt()
}

// Trilinear cells come no nearer than h²; measured from 6 to 12 cells a side.
#[test]
fn a_manufactured_displacement_is_met_with_order_2_in_the_size_of_cells() {
    for poisson in [0.0, 0.3, 0.49] {
        let errors = [3, 6, 12].map(|n| error_m(n, poisson));
        let order = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
        println!("ν = {poisson}: errors {errors:?} m, orders {order:.2?}");
        assert!(order[1] >= 1.9, "ν = {poisson}: orders {order:?}");
        assert!(errors[2] < 0.01 * AMPLITUDE_M, "ν = {poisson}: {errors:?}");
    }
}

/// Where the tip of a bar of two cells across is after a third of its period, m: drawn out by a fifth, and let go.
fn tip_m(rate_hz: f64, iterations: usize) -> f64 {
    let grid = cuboid([2, 2, 8], [0.02, 0.02, 0.08]);
    let material = Material {
        young_pa: YOUNG_PA,
        poisson: 0.3,
        density_kg_m3: 1_000.0,
        damping_s: 5e-3,
        plastic: None,
        stiffening: None,
    };
    let fixed: Vec<bool> = grid.nodes.iter().map(|p| p.z == 0.0).collect();
    let solid = Solid::whole(&grid, &fixed, 0.02 * 0.02 * 0.08, Inside::Continuum, |_| {
        material
    });
    let settings = StepSettings {
        dt_s: 1.0 / rate_hz,
        integrator: Integrator::Implicit {
            iterations,
            matrix: StepMatrix::Auto,
        },
        sleep_m_s: 0.0,
    };
    let body = solid.build(&material, settings).unwrap();
    let (mut state, mut scratch) = (body.rest_state(), body.scratch());
    for place in &mut state.positions {
        place.z *= 1.2;
    }
    for _ in 0..(0.024 * rate_hz).round() as usize {
        body.predict(&state, &mut scratch);
        body.advance(&mut state, &mut scratch);
    }
    state.positions.last().unwrap().z
}

// Backward Euler is of first order in the step, also where one iteration is made.
#[test]
fn a_bar_that_is_let_go_moves_with_order_1_in_the_step() {
    for iterations in [1, 3] {
        let places = [1e3, 2e3, 4e3, 8e3].map(|rate_hz| tip_m(rate_hz, iterations));
        let steps = [0, 1, 2].map(|k| places[k + 1] - places[k]);
        let order = [0, 1].map(|k| (steps[k] / steps[k + 1]).abs().log2());
        println!("{iterations} iterations: {places:.6?} m, orders {order:.3?}");
        assert!(
            order[1] >= 0.95,
            "{iterations} iterations: orders {order:?}"
        );
    }
}

/// Deflection of the middle of the end of Cook's membrane times E t / F; `n` cells along each side, half its thickness in
/// one.
fn cook(n: usize) -> f64 {
    const UNIT_M: f64 = 1e-3;
    let mut grid = cuboid([n, n, 1], [1.0, 1.0, 0.5]);
    for p in &mut grid.nodes {
        let (s, t) = (p.x, p.y);
        *p = Point3::new(48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), p.z) * UNIT_M;
    }
    let solid = uniform(&grid, YOUNG_PA, 1.0 / 3.0);
    let fixed = |p: &Point3, axis: usize| {
        let held = if axis == 2 { p.z == 0.0 } else { p.x == 0.0 };
        held.then_some(0.0)
    };
    // Of both halves 1e-6 E t times a millimetre: strains of 1e-5.
    let force_n = 1e-6 * YOUNG_PA * UNIT_M * UNIT_M;
    let at_end = |node: usize| node / (2 * (n + 1)) == n;
    let load = |node: usize| {
        let share = match node / 2 % (n + 1) {
            j if j == 0 || j == n => 0.5,
            _ => 1.0,
        };
        let part = if at_end(node) {
            0.25 * share / n as f64
        } else {
            0.0
        };
        Vector3::new(0.0, part * force_n, 0.0)
    };
    let places = equilibrium(&solid, &fixed, &load);
    let middle = 2 * (n * (n + 1) + n / 2);
    (places[middle][1] - grid.nodes[middle].y) / (force_n / (YOUNG_PA * UNIT_M))
}

// Cook (1974), plane stress, ν = 1/3: 23.96.
#[test]
fn cooks_membrane_bends_by_what_is_known() {
    let found = [8, 16, 32].map(cook);
    println!("Cook: {found:.2?}, known 23.96");
    assert!((found[2] / 23.96 - 1.0).abs() < 0.02, "{found:?}");
    assert!(found.is_sorted(), "from below: {found:?}");
}
