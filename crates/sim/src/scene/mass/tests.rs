use super::*;
use palpate_geometry::math::Pose;
use palpate_geometry::surface::builtin;

const DENSITY: f64 = 800.0;

/// Sorted moments, relative to those that are expected.
fn assert_moments(mass: &Mass, mut expected: [f64; 3], tolerance: f64) {
    let mut moments = mass.moments_kg_m2;
    moments.sort_by(f64::total_cmp);
    expected.sort_by(f64::total_cmp);
    for (moment, expected) in moments.iter().zip(expected) {
        let error = moment / expected - 1.0;
        assert!(
            error.abs() < tolerance,
            "{moment} for {expected}: {error:e}"
        );
    }
}

/// A cube's surface as one clamped patch round four sides, closed by straight rows to the middles of top
/// and bottom: degree 1, so that it is exact.
fn cuboid(half: [f64; 3]) -> Surface {
    let round = [
        [1.0, 1.0],
        [-1.0, 1.0],
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 1.0],
    ];
    let rows = [(0.0, -1.0), (1.0, -1.0), (1.0, 1.0), (0.0, 1.0)];
    let points = round.iter().flat_map(|[x, y]| {
        rows.map(|(out, z)| Point3::new(half[0] * x * out, half[1] * y * out, half[2] * z))
    });
    let net = palpate_geometry::surface::ControlNet::new(5, 4, points.collect()).unwrap();
    let knots = |count| KnotVector::clamped_uniform(1, count).unwrap();
    Surface::new(knots(5), knots(4), net, None)
        .unwrap()
        .oriented_outward()
}

#[test]
fn a_box_has_its_mass_and_moments_to_rounding() {
    let half = [0.03, 0.02, 0.01];
    let mass = Mass::inside(&cuboid(half), DENSITY).unwrap();
    let kg = DENSITY * 8.0 * half.iter().product::<f64>();
    assert!((mass.mass_kg / kg - 1.0).abs() < 1e-13, "{}", mass.mass_kg);
    assert!(mass.centre.coords.norm() < 1e-16, "{}", mass.centre);
    let [a, b, c] = half.map(|h| h * h * kg / 3.0);
    assert_moments(&mass, [b + c, c + a, a + b], 1e-13);
}

// The builtin sphere and torus are near the shapes of their names; finer nets are nearer.
#[test]
fn sphere_ellipsoid_and_torus_come_near_to_their_closed_forms() {
    let sphere = builtin("sphere", Some([24, 15]), Some(0.05))
        .unwrap()
        .oriented_outward();
    let mass = Mass::inside(&sphere, DENSITY).unwrap();
    let kg = DENSITY * 4.0 / 3.0 * std::f64::consts::PI * 0.05f64.powi(3);
    println!("sphere: mass off by {:e}", mass.mass_kg / kg - 1.0);
    assert!((mass.mass_kg / kg - 1.0).abs() < 2e-3);
    assert_moments(&mass, [0.4 * kg * 0.05 * 0.05; 3], 3e-3);

    // Stretched exactly as the sphere is, it has the moments of what the sphere is.
    let mut ellipsoid = sphere.clone();
    for p in ellipsoid.net_mut().points_mut() {
        *p = Point3::new(2.0 * p.x, p.y, 0.5 * p.z);
    }
    let stretched = Mass::inside(&ellipsoid, DENSITY).unwrap();
    let second = |m: &Mass, k: usize| {
        // ∫ x_k² ρ dV from the moments about the axes, which are those of the world here.
        let axes = [0, 1, 2].map(|j| m.axes * Vector3::ith(j, 1.0));
        let about = |k: usize| -> f64 {
            (0..3)
                .map(|j| m.moments_kg_m2[j] * axes[j][k].powi(2))
                .sum()
        };
        0.5 * (about(0) + about(1) + about(2)) - about(k)
    };
    for (k, factor) in [4.0, 1.0, 0.25].into_iter().enumerate() {
        let ratio = second(&stretched, k) / second(&mass, k);
        assert!(
            (ratio / factor - 1.0).abs() < 1e-11,
            "{k}: {ratio} for {factor}"
        );
    }
    assert!((stretched.mass_kg / mass.mass_kg - 1.0).abs() < 1e-13);

    let torus = builtin("torus", Some([32, 24]), Some(0.05))
        .unwrap()
        .oriented_outward();
    let mass = Mass::inside(&torus, DENSITY).unwrap();
    // Ring and tube radii of the surface as it is: from its volume and its outermost point.
    let (low, high) = torus
        .net()
        .points()
        .iter()
        .fold((0.0f64, 0.0f64), |(a, b), p| (a.max(p.z), b.max(p.x)));
    println!("torus: {mass:?}, net to z {low} and x {high}");
    let tube = 2.0
        * mass
            .moments_kg_m2
            .iter()
            .fold(f64::INFINITY, |a, b| a.min(*b));
    let about_axis = mass.moments_kg_m2.iter().fold(0.0f64, |a, b| a.max(*b));
    // I_z = m (R² + 3/4 r²), I_x = m (R²/2 + 5/8 r²).
    let r2 = (tube - about_axis) * 2.0 / mass.mass_kg;
    let ring2 = about_axis / mass.mass_kg - 0.75 * r2;
    let kg = DENSITY * 2.0 * std::f64::consts::PI.powi(2) * ring2.sqrt() * r2;
    assert!(
        (mass.mass_kg / kg - 1.0).abs() < 5e-3,
        "{} for {kg}",
        mass.mass_kg
    );
}

#[test]
fn the_tensor_turns_and_moves_with_the_body() {
    let drop = builtin("teardrop", None, None).unwrap().oriented_outward();
    let mass = Mass::inside(&drop, DENSITY).unwrap();
    let pose = Pose::from_parts(
        Vector3::new(0.3, -0.2, 0.1).into(),
        rotation_by(&Vector3::new(0.4, 1.1, -0.7)),
    );
    let moved = Mass::inside(&drop.transformed(&pose), DENSITY).unwrap();
    assert!((moved.mass_kg / (DENSITY * drop.volume()) - 1.0).abs() < 1e-12);
    assert!((moved.centre - pose * mass.centre).norm() < 1e-15);
    assert_moments(&moved, mass.moments_kg_m2, 1e-11);
    let spin = Vector3::new(3.0, -1.0, 2.0);
    let (here, there) = (
        mass.momentum(&mass.axes, &spin),
        moved.momentum(&moved.axes, &(pose.rotation * spin)),
    );
    assert!((pose.rotation * here - there).norm() < 1e-11 * there.norm());
    assert!((mass.spin(&mass.axes, &here) - spin).norm() < 1e-13);
}

#[test]
fn what_encloses_nothing_has_no_mass() {
    let mut flat = builtin("sphere", None, None).unwrap();
    flat.net_mut()
        .points_mut()
        .iter_mut()
        .for_each(|p| p.z = 0.0);
    assert_eq!(Mass::inside(&flat, DENSITY), None);
}
