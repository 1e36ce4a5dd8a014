use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::TickInput;
use palpate_sim::tick::step;
use std::path::Path;

pub fn main() {
    let soft = "model = \"lattice\"\nlattice = { thickness_m = 0.03, layers = 3, refine = [14, 14] }\nmaterial = { young_pa = 20e3 }\nfixed = [{ point = [0.0, 0.0, -0.028], normal = [0.0, 0.0, 1.0] }]\n";
    for (bn, b) in [
        (
            "rigid",
            "surface = { builtin = \"sheet\", size = 0.2 }\n".to_string(),
        ),
        (
            "soft",
            format!("surface = {{ builtin = \"sheet\", size = 0.1 }}\n{soft}"),
        ),
    ] {
        for (tn, t, z) in [
            (
                "cyl",
                "{ cylinder = { radius_m = 0.012, half_length_m = 0.008 } }",
                0.006,
            ),
            (
                "box",
                "{ box = { half_extents_m = [0.01, 0.02, 0.005] } }",
                0.003,
            ),
            (
                "torus",
                "{ torus = { major_radius_m = 0.02, minor_radius_m = 0.004 } }",
                0.0035,
            ),
        ] {
            let text = format!(
                "[[body]]\nid = \"b\"\n{b}[[tool]]\nid = \"t\"\nshape = {t}\npose = {{ position = [0.003, 0.004, 0.03] }}\n"
            );
            let loaded = file::parse(&text, "x.toml", Path::new(".")).unwrap();
            let scene = Scene::build(&loaded.spec, Path::new(".")).unwrap();
            let mut state = scene.initial_state();
            let mut scratch = scene.scratch(&state);
            let mut time = 0.0;
            for k in 0..100u64 {
                let zz = 0.03 + (z - 0.03) * (k as f64 / 40.0).min(1.0);
                let mut input = TickInput::default();
                input.poses[0] = Some(DevicePose {
                    seq: k + 1,
                    t_client_ns: 0,
                    position: Point3::new(0.003, 0.004, zz),
                    orientation: Rotation::identity(),
                    linear_velocity: Vector3::zeros(),
                    angular_velocity: Vector3::zeros(),
                    buttons: 0,
                });

                let t0 = std::time::Instant::now();
                let o = step(&scene, &mut state, &mut scratch, &input);
                if k >= 60 {
                    time += t0.elapsed().as_secs_f64();
                }
                if k == 99 {
                    println!(
                        "{bn} {tn}: force {:.4} torque ({:.4}, {:.4})",
                        o.tools[0].force_n.z, o.tools[0].torque_nm.x, o.tools[0].torque_nm.y
                    );
                }
            }
            println!("   {:.0} us a tick", time / 40.0 * 1e6);
        }
    }
}
