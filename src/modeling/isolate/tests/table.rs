//! The published table, method by method.

use super::pairs::{GivenPair, given};
use crate::math::Vector3;
use crate::modeling::isolate::{Body, IsolateSpec, Isolated, Method, isolate_ready};

pub fn solved(pair: &GivenPair, bodies: &[Body; 2], spec: &IsolateSpec) -> Isolated {
    let [a, b] = bodies;
    isolate_ready((&pair.moving, a), (&pair.fixed, b), &Vector3::zeros(), spec).unwrap()
}

#[test]
fn table() {
    let (ex, only) = (std::env::var("EX").is_ok(), std::env::var("ONLY").ok());
    for pair in given() {
        let bodies = pair.bodies();
        for method in Method::ALL {
            if only.as_ref().is_some_and(|o| !o.split(',').any(|o| o == method.name())) { continue; }
            let spec = IsolateSpec { method, exact: ex, fall_back: false, ..IsolateSpec::default() };
            let t = std::time::Instant::now();
            let answer = solved(&pair, &bodies, &spec);
            let ms = t.elapsed().as_secs_f64() * 1e3;
            let r = &pair.document["reference"][method.name()];
            println!("{:38} {:9} {:?} ratio {:.4} ({}) steps {} ({}) turn {:?} ({}) gap {:?} tests {} regions {} {ms:.1} ms", pair.name, method.name(), answer.status,
              answer.contact_m.norm() / pair.number("mtd_m"), r["ratio"], answer.steps, r["steps"], answer.turn_deg.map(|x| (x*100.0).round()/100.0), r["turn_deg"], answer.gap_m.map(|g| g / pair.number("diameter_m") * 1000.0), answer.overlap_tests, answer.regions);
        }
    }
}
