//! Times closest-point queries on a teardrop: `cargo run --release --no-default-features --example closest_timing`.
//!
//! Prints median and 99th percentile of cold and warm queries and of a bounds refresh, beside a parry3d-f64 triangle mesh
//! of 82 × 82 samples in the same run. Wall clock on whatever machine this is: only ratios within one run mean anything.

use std::time::Instant;

use palpate::basis::KnotVector;
use palpate::math::{Point3, Vector3};
use palpate::surface::{ClosestSolver, ControlNet, Surface, WarmFoot};
use parry3d_f64::glamx::DVec3;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::TriMesh;

fn read(text: &str) -> Surface {
    let file: serde_json::Value = serde_json::from_str(text).expect("data file");
    let floats =
        |v: &serde_json::Value| -> Vec<f64> { v.as_array().into_iter().flatten().filter_map(|x| x.as_f64()).collect() };
    let rows = file["points"].as_array().expect("points");
    let points: Vec<Point3> =
        rows.iter().flat_map(|r| r.as_array().expect("row")).map(|p| Point3::from_slice(&floats(p)) * 1e-3).collect();
    let knots = |k: usize| KnotVector::new(3, floats(&file["knots"][k])).expect("knots");
    let columns = points.len() / rows.len();
    Surface::new(knots(0), knots(1), ControlNet::new(rows.len(), columns, points).expect("net"), None).expect("surface")
}

fn report(name: &str, mut times: Vec<f64>) {
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize] * 1e6;
    println!("  {name:<28} median {:7.2} µs   p99 {:7.2} µs   max {:8.1} µs", at(0.5), at(0.99), at(1.0));
}

fn main() {
    let mut seed = 1_u64;
    let mut unit = move || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    for (count, text) in [
        (8, include_str!("../src/surface/data/teardrop_8.json")),
        (12, include_str!("../src/surface/data/teardrop_12.json")),
        (20, include_str!("../src/surface/data/teardrop_20.json")),
    ] {
        println!("teardrop {count} × {count}");
        let mut surface = read(text);
        let mut solver = ClosestSolver::new(&surface);
        let mesh = mesh(&surface);
        let mut kinds: Vec<(&str, Vec<Point3>)> =
            vec![("near", vec![]), ("inside", vec![]), ("around", vec![]), ("far", vec![])];
        for _ in 0..5_000 {
            let frame = surface.frame(unit(), unit());
            let n = frame.du.cross(&frame.dv).try_normalize(0.0).unwrap_or_else(Vector3::z);
            kinds[0].1.push(frame.point + n * (unit() - 0.5) * 4e-3);
            let axis = nalgebra::center(&surface.point(0.0, 0.5 * unit()), &surface.point(0.5, 0.5 * unit()));
            kinds[1].1.push(nalgebra::center(&axis, &frame.point));
            let random = Vector3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5);
            kinds[2].1.push(Point3::new(0.0, 0.0, 0.05) + random * 0.15);
            kinds[3].1.push(Point3::new(0.0, 0.0, 0.05) + random * 2.0);
        }
        for (name, queries) in &kinds {
            let (mut ours, mut peers, mut sum, mut parts) = (vec![], vec![], 0.0, 0);
            for q in queries {
                let start = Instant::now();
                sum += solver.closest(&surface, q).distance;
                ours.push(start.elapsed().as_secs_f64());
                parts += solver.parts_visited();
                let start = Instant::now();
                sum += mesh.project_local_point(DVec3::new(q.x, q.y, q.z), false).point.x;
                peers.push(start.elapsed().as_secs_f64());
            }
            println!(" {name} (sum {sum:.3}, {:.1} parts a query)", parts as f64 / queries.len() as f64);
            report("cold", ours);
            report("parry mesh 82 × 82", peers);
        }
        // A tool that slides around the body at 0.1 m/s.
        for deform in [false, true] {
            let (mut times, mut warm, mut searches) = (vec![], WarmFoot::default(), 0);
            let mut last = Point3::origin();
            for k in 0..20_000 {
                let turn = k as f64 * 0.004;
                let q = Point3::new(0.024 * turn.cos(), 0.024 * turn.sin(), 0.03 + 0.01 * (turn * 0.3).sin());
                let mut moved = 0.0;
                if deform {
                    moved = 2e-6;
                    for p in surface.net_mut().points_mut() {
                        p.z += if k % 2 == 0 { 2e-6 } else { -2e-6 };
                    }
                    solver.net_changed();
                }
                let before = warm.budget_m;
                let start = Instant::now();
                solver.closest_warm_moved(&surface, &q, (q - last).norm(), moved, &mut warm);
                times.push(start.elapsed().as_secs_f64());
                searches += usize::from(warm.budget_m >= before);
                last = q;
            }
            println!(
                " sliding 0.1 m/s, {}: {searches} searches of {}",
                if deform { "net moves" } else { "rigid" },
                times.len()
            );
            report("warm", times);
        }
        let mut times = vec![];
        for _ in 0..2_000 {
            solver.net_changed();
            let start = Instant::now();
            solver.pieces(&surface);
            times.push(start.elapsed().as_secs_f64());
        }
        report("refresh of all bounds", times);
    }
}

fn mesh(surface: &Surface) -> TriMesh {
    let n = 82;
    let at = |k: usize| k as f64 / (n - 1) as f64;
    let vertices = (0..n * n).map(|k| surface.point(at(k / n), at(k % n))).map(|p| DVec3::new(p.x, p.y, p.z)).collect();
    let triangles = (0..(n - 1) * (n - 1))
        .flat_map(|k| {
            let (i, j) = ((k / (n - 1)) as u32, (k % (n - 1)) as u32);
            let at = |i: u32, j: u32| i * n as u32 + j;
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    TriMesh::new(vertices, triangles).expect("mesh")
}
