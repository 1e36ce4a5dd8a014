//! Walls that are known: planes, hyperboloids, data; and how many pieces they have.

use super::*;
use palpate_geometry::surface::ClosestSolver;
use std::f64::consts::PI;

#[test]
fn equal_spheres_get_a_plane() {
    let way = Vector3::new(0.08, 0.01, 0.02);
    let two = truncated(&sphere(0.05, [0.0; 3]), &sphere(0.05, way.into()));
    let h = 0.05 - 0.5 * way.norm();
    let left = PI * (4.0 / 3.0 * 0.05f64.powi(3) - h * h * (0.15 - h) / 3.0);
    for volume in two.volumes_m3 {
        assert!((volume / left - 1.0).abs() < 1e-9, "{volume} {left}");
    }
    let [wall] = walls(&two)[..] else {
        panic!("one wall")
    };
    for p in places(wall) {
        let off_m = way.normalize().dot(&p.coords) - 0.5 * way.norm();
        assert!(off_m.abs() < 1e-9, "{p}: {off_m}");
    }
    assert!(two.walls[0].off_m < 1e-12, "{:?}", two.walls);
}

#[test]
fn unequal_spheres_get_a_sheet_of_a_hyperboloid() {
    let two = truncated(&sphere(0.05, [0.0; 3]), &sphere(0.03, [0.0, 0.0, 0.06]));
    // data of truncate_spheres, mm³.
    let known = [513824.9317871306e-9, 101927.22831646884e-9];
    for (volume, known) in two.volumes_m3.into_iter().zip(known) {
        assert!((volume / known - 1.0).abs() < 1e-6, "{volume} {known}");
    }
    assert!((two.before_m3[2] / 20943.951023931953e-9 - 1.0).abs() < 1e-7);
    let [wall] = walls(&two)[..] else {
        panic!("one wall")
    };
    let lead =
        |p: &Point3| (p.coords.norm() - 0.05) - ((p - Point3::new(0.0, 0.0, 0.06)).norm() - 0.03);
    let uneven = places(wall).map(|p| lead(&p).abs()).fold(0.0, f64::max);
    assert!(
        two.within_tolerance() && uneven < 2.0 * two.tolerance_m,
        "{uneven}"
    );
    // As measured between the places of the fit, and no more than a little.
    assert!(
        uneven < 1.5 * two.walls[0].uneven_m,
        "{uneven} {:?}",
        two.walls
    );
    let mut solver = ClosestSolver::new(wall);
    let middle = solver.closest(wall, &Point3::new(0.0, 0.0, 0.04));
    assert!(middle.distance < two.tolerance_m, "{middle:?}");
}

#[test]
fn the_wall_of_two_ellipsoids_is_where_another_program_has_it() {
    let [a, b] = ellipsoids();
    let two = truncated(&a, &b);
    let known = reference();
    let number = |name: &str| known[name].as_f64().unwrap() * 1e-9;
    let uncertain = number("uncertainty");
    for (volume, name) in two.volumes_m3.into_iter().zip(["volume_a", "volume_b"]) {
        assert!(
            (volume - number(name)).abs() < uncertain,
            "{name}: {volume}"
        );
    }
    assert!((two.before_m3[2] - number("overlap")).abs() < uncertain);
    assert!(two.within_tolerance(), "{:?}", two.walls);
    let [wall] = walls(&two)[..] else {
        panic!("one wall")
    };
    let mut solver = ClosestSolver::new(wall);
    let points = known["interface_points_xyz_depth"].as_array().unwrap();
    for point in points {
        let [x, y, z] = [0, 1, 2].map(|k| point[k].as_f64().unwrap() * 1e-3);
        let foot = solver.closest(wall, &Point3::new(x, y, z));
        assert!(foot.distance < two.tolerance_m, "{point}: {foot:?}");
    }
    assert_eq!(points.len(), 60);
}

#[test]
fn a_rod_through_a_ball_gets_two_tips() {
    let (ball, rod) = (sphere(0.05, [0.0; 3]), ellipsoid([0.01, 0.01, 0.09]));
    let two = truncated(&ball, &rod);
    assert_eq!(two.walls.iter().map(|w| w.rims).collect::<Vec<_>>(), [1, 1]);
    assert_union(&two, 1e-9);
    // The ball stays one piece, the rod becomes two solids with a face each on its old surface.
    let solids = |k: usize| two.breps[k].shells.len();
    assert_eq!((solids(0), solids(1)), (1, 2));
    assert_eq!(two.breps[1].faces.len(), 4);
}

#[test]
fn a_ball_in_the_hole_of_a_torus_gets_a_ring() {
    let torus = builtin("torus", None, Some(0.05)).unwrap();
    let two = truncated(&torus, &sphere(0.04, [0.001, 0.0, 0.002]));
    assert_eq!(two.walls.iter().map(|w| w.rims).collect::<Vec<_>>(), [2]);
    assert!(two.within_tolerance(), "{:?}", two.walls);
    assert_union(&two, 1e-7);
}

#[test]
fn bodies_that_overlap_twice_get_two_walls() {
    // A bent rod: both its ends in one body.
    let [rod, _] = ellipsoids();
    let bent = mapped(rod, |p| {
        let z = 1.8 * p.z;
        Point3::new(0.45 * p.x + 0.03 - 8.0 * z * z, 0.45 * p.y, z)
    });
    let body = moved(&ellipsoid([0.02, 0.03, 0.1]), [-0.01, 0.0, 0.0]);
    let two = truncated(&bent, &body);
    assert_eq!(two.walls.len(), 2, "{:?}", two.walls);
    assert_union(&two, 1e-6);
}
