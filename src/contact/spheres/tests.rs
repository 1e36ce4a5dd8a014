use super::*;
use crate::basis::testing::Random;
use crate::surface::{ClosestSolver, builtin};

fn near_surface(random: &mut Random, surface: &Surface, off_m: f64) -> Point3 {
    let (u, v) = (random.float(0.0, 1.0), random.float(0.05, 0.95));
    surface.point(u, v) + surface.normal(u, v) * random.float(-off_m, off_m)
}

#[test]
fn balls_and_points_agree_with_the_certified_closest_point_and_errors_fall_with_the_square() {
    let surface = builtin("teardrop", None, None).unwrap();
    let size = surface.size();
    let mut solver = ClosestSolver::new(&surface);
    let mut worst = Vec::new();
    for rows in [28, 82, 244] {
        let mut spheres = Spheres::new(&surface, [rows; 2]);
        let (mut random, mut set, mut error) = (Random(1), ContactSet::new(), 0.0_f64);
        for k in 0..400 {
            let q = near_surface(&mut random, &surface, 0.01);
            let radius = [0.0, 0.012, 0.03][k % 3];
            let exact = radius - solver.closest(&surface, &q).signed_distance;
            spheres.ball(&q, radius, &Reach::TOUCH, &mut set);
            let depth = set.deepest().map(|c| c.depth_m);
            // What the grid may miss of the surface, at most.
            let allowed = 0.5 * size / (rows * rows) as f64 * 9.0;
            if exact.abs() > allowed {
                assert_eq!(depth.is_some(), exact > 0.0, "{rows}: {q} {radius}: {exact}");
            }
            if let Some(depth) = depth {
                error = error.max((depth - exact).abs());
            }
        }
        worst.push(error / size);
    }
    println!("{worst:?}");
    for pair in worst.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((5.0..16.0).contains(&ratio), "{worst:?}: three times the rows leave a ninth of the error");
    }
    assert!(worst[1] < 2e-4, "{worst:?}");
}
