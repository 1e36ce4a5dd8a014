use super::*;
fn run(name: &str, a: &Surface, b: &Surface) -> Option<Truncated> {
    let start = std::time::Instant::now();
    let two = truncate(a, b, &TruncateSpec::default());
    match two {
        Ok(Some(two)) => {
            let v: f64 = two.volumes_m3.iter().sum();
            println!(
                "{name} {:?} {:?} tol {:.1e} volumes {:?} before {:?} union off {:.2e} gaps {:?}",
                start.elapsed(),
                two.walls,
                two.tolerance_m,
                two.volumes_m3,
                two.before_m3,
                v / two.union_m3() - 1.0,
                two.parts.each_ref().map(|p| p.gap_m())
            );
            Some(two)
        }
        Ok(None) => {
            println!("{name} None");
            None
        }
        Err(e) => {
            println!("{name} {:?} {e} {e:?}", start.elapsed());
            None
        }
    }
}

#[test]
#[ignore]
fn explore() {
    let only = std::env::var("ONLY").unwrap_or_default();
    let run = |name: &str, a: &Surface, b: &Surface| {
        if name.contains(&only) { run(name, a, b); }
    };
    run("equal", &sphere(0.05, [0.0; 3]), &sphere(0.05, [0.08, 0.01, 0.02]));
    run("deep", &sphere(0.05, [0.0; 3]), &sphere(0.03, [0.01, 0.0, 0.02]));
    run("shallow", &sphere(0.05, [0.0; 3]), &sphere(0.03, [0.0, 0.0, 0.0799999]));
    run("rod", &sphere(0.05, [0.0; 3]), &ellipsoid([0.01, 0.01, 0.09]));
    run("coaxial", &ellipsoid([0.04, 0.04, 0.02]), &ellipsoid([0.024, 0.024, 0.04]));
    run("ring", &builtin("torus", None, Some(0.05)).unwrap(), &sphere(0.04, [0.001, 0.0, 0.002]));
    run("torus cut", &builtin("torus", None, Some(0.05)).unwrap(), &sphere(0.04, [0.05, 0.0, 0.002]));
    run("cross", &ellipsoid([0.06, 0.015, 0.015]), &ellipsoid([0.015, 0.016, 0.06]));
    let mut random = Random(7);
    for k in 0..12 {
        let (a, b) = (knobbly(&mut random), knobbly(&mut random));
        let d = random.vector().normalize() * random.float(0.02, 0.05);
        let b = b.transformed(&Pose::translation(d.x, d.y, d.z));
        run(&format!("smooth {k}"), &a, &b);
    }
}
