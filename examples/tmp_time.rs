use palpate::contact::exact::{ExactScratch, ball, plane};
use palpate::contact::{ContactSet, Reach};
use palpate::math::{Point3, Vector3};
use palpate::surface::{ClosestSolver, builtin};
use std::time::Instant;
fn main() {
    let mut s = 1u64;
    let mut r = || {
        s = s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (s >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    for n in [8, 12, 20] {
        let drop = builtin("teardrop", Some([n, n]), None).unwrap();
        let size = drop.size();
        let net = drop.net().points();
        let c = Point3::from(net.iter().map(|p| p.coords).sum::<Vector3>() / net.len() as f64);
        let mut solver = ClosestSolver::new(&drop);
        let mut scratch = ExactScratch::new(&drop, &mut solver);
        let mut out = ContactSet::new();
        for (name, kind) in [
            ("sphere r=.05 near surface", 0),
            ("sphere r=.2 anywhere", 1),
            ("point", 2),
            ("plane", 3),
            ("plane shallow", 4),
            ("closest only", 5),
        ] {
            let mut times = vec![];
            let (mut parts, mut cts) = (0, 0);
            for _ in 0..4000 {
                let (u, v) = (0.5 + 0.5 * r(), 0.5 + 0.49 * r());
                let nrm = drop.normal(u, v);
                let at = drop.point(u, v) + nrm * (0.045 + 0.02 * r()) * size;
                let any = c + Vector3::new(r(), r(), r()) * 0.4 * size;
                let dir = Vector3::new(r(), r(), r()).normalize();
                let (_, _, top) = solver.deepest_along(&drop, &dir);
                let t = Instant::now();
                match kind {
                    0 => ball::contacts(&drop, &mut solver, &at, 0.05 * size, &Reach::TOUCH, &mut scratch, &mut out),
                    1 => ball::contacts(&drop, &mut solver, &any, 0.2 * size, &Reach::TOUCH, &mut scratch, &mut out),
                    2 => ball::contacts(&drop, &mut solver, &any, 0.0, &Reach::TOUCH, &mut scratch, &mut out),
                    3 => plane::contacts(&drop, &mut solver, &any, &-dir, &Reach::TOUCH, &mut scratch, &mut out),
                    4 => plane::contacts(
                        &drop,
                        &mut solver,
                        &(top - dir * 0.01 * size),
                        &-dir,
                        &Reach::TOUCH,
                        &mut scratch,
                        &mut out,
                    ),
                    _ => {
                        solver.closest(&drop, &any);
                    }
                }
                times.push(t.elapsed().as_nanos());
                parts += solver.parts_visited();
                cts += out.contacts().len();
            }
            times.sort();
            println!(
                "{n}² {name}: median {:.2} µs, p90 {:.2}, p99 {:.2}, max {:.1}; parts {:.1} contacts {:.2}",
                times[2000] as f64 / 1e3,
                times[3600] as f64 / 1e3,
                times[3960] as f64 / 1e3,
                times[3999] as f64 / 1e3,
                parts as f64 / 4000.0,
                cts as f64 / 4000.0
            );
        }
    }
}
