use palpate_geometry::math::{Point3, Rotation, Vector3, rotation_by};
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::{Scene, file};
use palpate_sim::tick::record::TickInput;
use palpate_sim::tick::step;
use std::path::Path;
fn at(seq: u64, p: Point3, q: Rotation) -> TickInput {
    let mut input = TickInput::default();
    input.poses[0] = Some(DevicePose {
        seq,
        t_client_ns: 0,
        position: p,
        orientation: q,
        linear_velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
        buttons: 0,
    });
    input
}
struct Rng(u64);
impl Rng {
    fn f(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn n(&mut self) -> f64 {
        (0..12).map(|_| self.f()).sum::<f64>() - 6.0
    }
}
pub fn main() {
    let poses: usize = std::env::args().nth(1).map_or(16, |s| s.parse().unwrap());
    let only = std::env::args().nth(2).unwrap_or_default();
    let mv = std::env::var("MOVE").is_ok();
    let tools = [
        (
            "cone45",
            "{ cone = { half_angle_rad = 0.785, height_m = 0.015 } }",
        ),
        (
            "cone17",
            "{ cone = { half_angle_rad = 0.3, height_m = 0.015 } }",
        ),
        (
            "cylinder",
            "{ cylinder = { radius_m = 0.009, half_length_m = 0.012 } }",
        ),
        (
            "disc",
            "{ cylinder = { radius_m = 0.015, half_length_m = 0.0015 } }",
        ),
        (
            "box",
            "{ box = { half_extents_m = [0.011, 0.008, 0.006] } }",
        ),
        (
            "plate",
            "{ box = { half_extents_m = [0.018, 0.016, 0.0012] } }",
        ),
    ];
    let bodies = [
        ("sheet", "{ builtin = \"sheet\", size = 0.3 }"),
        ("sphere", "{ builtin = \"sphere\", size = 0.03 }"),
        ("teardrop", "{ builtin = \"teardrop\" }"),
        ("torus", "{ builtin = \"torus\", size = 0.03 }"),
    ];
    for (bn, b) in bodies {
        for (tn, t) in tools {
            if !only.is_empty() && !format!("{bn}/{tn}").contains(&only) {
                continue;
            }
            let mut r = Rng(7411);
            r.f();
            let mut pi = 0usize;
            let (mut bad, mut n, mut worst, mut ticks, mut wt, mut off) =
                (0, 0, 0.0f64, 0.0f64, 0.0f64, 0);
            for _ in 0..poses {
                let mut q = Rotation::from_quaternion(nalgebra_q(&mut r));
                #[allow(unused)]
                let idx = pi;
                pi += 1;
                if std::env::var("TILT").is_ok() {
                    let tilts = [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2, 0.1, 0.3];
                    let base = match (tn, idx / 8 % 2) {
                        ("cone45", 0) | ("cone17", 0) => {
                            rotation_by(&(Vector3::x() * std::f64::consts::PI))
                        }
                        ("cone45", _) => {
                            rotation_by(&(Vector3::y() * (std::f64::consts::FRAC_PI_2 + 0.785)))
                        }
                        ("cone17", _) => {
                            rotation_by(&(Vector3::y() * (std::f64::consts::FRAC_PI_2 + 0.3)))
                        }
                        (_, 0) => Rotation::identity(),
                        _ => rotation_by(&(Vector3::y() * std::f64::consts::FRAC_PI_2)),
                    };
                    let a = 6.2831853 * r.f();
                    q = rotation_by(&(Vector3::new(a.cos(), a.sin(), 0.0) * tilts[idx % 8])) * base;
                }
                let mut d = Vector3::new(r.n(), r.n(), r.n());
                let a = 6.283185307 * r.f();
                let base = match bn {
                    "sheet" => {
                        d = Vector3::z();
                        Point3::new(0.08 * (r.f() - 0.5), 0.08 * (r.f() - 0.5), 0.0)
                    }
                    "torus" => {
                        let z = d.z;
                        let m = d.x.abs();
                        d = Vector3::new(a.cos() * m, a.sin() * m, z);
                        Point3::new(0.03 * a.cos(), 0.03 * a.sin(), 0.0)
                    }
                    "teardrop" => {
                        d.z *= 0.3;
                        Point3::new(0.0, 0.0, 0.045)
                    }
                    _ => Point3::origin(),
                };
                let d = d.normalize();
                let text = format!(
                    "[[body]]\nid = \"b\"\nsurface = {b}\n[[tool]]\nid = \"t\"\nshape = {t}\npose = {{ position = [{:?}, {:?}, {:?}], orientation = [{:?}, {:?}, {:?}, {:?}] }}\ncoupling = {{ stiffness_n_m = 1000.0 }}\ndevice = {{ ramp_s = 0.0, speed_max_m_s = 1e6, force_max_n = 100.0 }}\n",
                    base.x + 0.13 * d.x,
                    base.y + 0.13 * d.y,
                    base.z + 0.13 * d.z,
                    q.i,
                    q.j,
                    q.k,
                    q.w
                );
                let loaded = match file::parse(&text, "x.toml", Path::new(".")) {
                    Ok(l) => l,
                    Err(e) => {
                        println!("{e:?}");
                        return;
                    }
                };
                let scene = Scene::build(&loaded.spec, Path::new(".")).unwrap();
                let mut state = scene.initial_state();
                let mut scratch = scene.scratch(&state);
                let mut seq = 0;
                let mut h = 0.13;
                let mut touched: Option<f64> = None;
                let mut deep = 0;
                let mut last = Vector3::zeros();
                let mut lt = Vector3::zeros();
                let (mut most, mut mt, mut mean, mut count) = (0.0f64, 0.0f64, 0.0, 0);
                let mut c0 = 0.0;
                let mut p = base;
                let mut lasts = Vector3::zeros();
                let mut lastlist = String::new();
                for _k in 0..3000 {
                    seq += 1;
                    if touched.is_none() {
                        h -= 2e-4;
                        if h < -0.08 {
                            break;
                        }
                        p = base + d * h;
                    } else if deep < 28 {
                        h -= 1e-4;
                        deep += 1;
                        p = base + d * h;
                    } else {
                        deep += 1;
                        if mv {
                            let w = d.cross(&Vector3::new(0.3, 0.5, 0.8)).normalize();
                            p += w * 2e-5;
                        }
                    }
                    let t0 = std::time::Instant::now();
                    let o = step(&scene, &mut state, &mut scratch, &at(seq, p, q));
                    if touched.is_none() && o.tools[0].contact_force_n.norm() > 1e-3 {
                        touched = Some(h);
                    }
                    let (f, m) = (o.tools[0].contact_force_n, o.tools[0].contact_torque_nm);
                    if deep > 28 + 80 {
                        if deep > 28 + 81 {
                            most = most.max((f - last).norm());
                            mt = mt.max((m - lt).norm());
                        }
                        mean += f.norm();
                        count += 1;
                        c0 += t0.elapsed().as_secs_f64();
                    }
                    let list: String = o
                        .contacts
                        .list()
                        .iter()
                        .map(|c| {
                            format!(
                                "   depth {:.4e} n {:.4?} at {:.5?} f {:.4?}\n",
                                c.depth_m, c.normal, c.point, c.force_n
                            )
                        })
                        .collect();
                    if deep > 28 + 81
                        && (f - last).norm() > 0.02 * f.norm() + 5e-3
                        && std::env::var("STEPS").is_ok()
                    {
                        println!(
                            "{bn}/{tn} {idx} tick {deep}: {last:.4?} -> {f:.4?}, free {:.6?} \n{lastlist}  ->\n{list}",
                            o.tools[0].proxy_position
                        );
                    }
                    lastlist = list;
                    last = f;
                    lt = m;
                    lasts = o.tools[0].proxy_position - p;
                    if std::env::var("SHOW").is_ok_and(|v| v == idx.to_string())
                        && deep > 28 + 150
                        && deep < 28 + 156
                    {
                        println!("f {:?} proxy {:?}", f, o.tools[0].proxy_position);
                        for c in o.contacts.list() {
                            println!(
                                "   depth {:.3e} n {:?} at {:?} force {:?}",
                                c.depth_m, c.normal, c.point, c.force_n
                            );
                        }
                    }
                    if deep > 28 + 230 {
                        break;
                    }
                }
                if touched.is_none() {
                    continue;
                }
                n += 1;
                let mean = mean / count as f64;
                let s = most / mean.max(1e-9);
                worst = worst.max(s);
                wt = wt.max(mt / (mean.max(1e-9) * 0.02));
                let lim = if mv { 0.02 + 5e-3 / mean } else { 0.005 };
                if s > lim || mean < 0.5 {
                    bad += 1;
                    println!("bad {idx}: step {s:.1e} mean {mean} p {p:?} q {q:?}");
                }
                if (lasts.norm() * 1000.0 - last.norm()).abs() > 0.05 * last.norm() {
                    off += 1;
                }
                ticks += c0 / count as f64;
            }
            println!(
                "{bn:9} {tn:9} bad {bad:3} of {n:3}  worst step {:.2e} of F, torque {:.2e} of F x 20 mm, tick {:.0} us, off {off}",
                worst,
                wt,
                1e6 * ticks / n.max(1) as f64
            );
        }
    }
    let _ = rotation_by(&Vector3::zeros());
}
fn nalgebra_q(r: &mut Rng) -> nalgebra::Quaternion<f64> {
    nalgebra::Quaternion::new(r.n(), r.n(), r.n(), r.n()).normalize()
}
