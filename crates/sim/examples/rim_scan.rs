use palpate_geometry::math::{Point3, Vector3};
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::TickInput;
use palpate_sim::tick::step;
use std::path::Path;
pub fn main() {
    let mut all: f64 = 0.0;
    for model in ["lattice", "continuum", "net", "membrane"] {
        for k in 0..8 {
            let over = [5e-4, 1e-3, 3e-3, 8e-3, 1e-4, 2e-3, 1.2e-2, 5e-3][k];
            let corner = k % 2 == 1;
            let y = if corner {
                0.05 + 0.01
            } else {
                0.003 * k as f64
            };
            let at = Point3::new(0.05 + 0.02 - over, y, 0.0202);
            let extra = if model == "membrane" {
                "thickness_m = 0.002, refine = \"none\""
            } else {
                "layers = 3, refine = [10, 10]"
            };
            let lattice = if model == "net" {
                String::new()
            } else {
                format!("lattice = {{ {extra} }}\n")
            };
            let text = format!(
                "[gravity]\nacceleration = [0, 0, -9.81]\n[[body]]\nid = \"floor\"\nsurface = {{ builtin = \"sheet\", size = 0.1 }}\n[[body]]\nid = \"ball\"\nsurface = {{ builtin = \"sphere\", size = 0.02 }}\nmodel = \"{model}\"\npose = {{ position = [{:?}, {:?}, {:?}] }}\nmaterial = {{ young_pa = 50e3, damping_s = 2e-3 }}\n{lattice}[[tool]]\nid = \"far\"\nshape = {{ point = {{}} }}\npose = {{ position = [5, 5, 5] }}\n",
                at.x, at.y, at.z
            );
            let loaded = match file::parse(&text, "x.toml", Path::new(".")) {
                Ok(l) => l,
                Err(e) => {
                    println!("{model}: {e}");
                    break;
                }
            };
            let scene = match Scene::build(&loaded.spec, Path::new(".")) {
                Ok(s) => s,
                Err(e) => {
                    println!("{model}: {e}");
                    break;
                }
            };
            let mut state = scene.initial_state();
            let mut scratch = scene.scratch(&state);
            let n = scene.rest_surface(1).net().points().len();
            let mut net = vec![Point3::origin(); n];
            let mut centre = |state: &palpate_sim::tick::SceneState| -> Point3 {
                state.copy_net(&scene, 1, &mut net);
                Point3::from(net.iter().map(|p| p.coords).sum::<Vector3>() / n as f64)
            };
            let mut before = centre(&state);
            let start = before;
            let (mut most, mut fastest) = (f64::MIN, 0.0f64);
            let show = std::env::var("SHOW").is_ok_and(|v| v == format!("{model}{k}"));
            for tick in 0..300 {
                let o = step(&scene, &mut state, &mut scratch, &TickInput::default());
                let c = centre(&state);
                let v = (c - before) * 1000.0;
                before = c;
                let e = 0.5 * v.norm_squared() + 9.81 * (c.z - start.z);
                if show && tick % 5 == 0 {
                    println!(
                        "{tick} c {:.4?} v {:.3?} e {e:.4}",
                        c.coords.as_slice(),
                        v.as_slice()
                    );
                    for c in o.contacts.list() {
                        println!(
                            "     {:?} depth {:.2e} n {:.2?} at {:.4?} f {:.3?}",
                            (c.u, c.v),
                            c.depth_m,
                            c.normal.as_slice(),
                            c.point.coords.as_slice(),
                            c.force_n.as_slice()
                        );
                    }
                }
                most = most.max(e);
                fastest = fastest.max(v.norm());
            }
            println!(
                "{model} {k} over {over} corner {corner}: fastest {fastest:.2} m/s, energy {most:.4} J/kg, end {:.4?}",
                before.coords.as_slice()
            );
            all = all.max(most);
        }
    }
    println!("most {all:.4}");
}
