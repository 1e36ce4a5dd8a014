//! The published table, method by method.

use crate::modeling::isolate::given::{self, GivenPair};
use crate::math::Vector3;
use crate::modeling::isolate::{Body, IsolateSpec, Isolated, Method, isolate_ready};

pub fn solved(pair: &GivenPair, bodies: &[Body; 2], spec: &IsolateSpec) -> Isolated {
    let [a, b] = bodies;
    isolate_ready((&pair.moving, a), (&pair.fixed, b), &Vector3::zeros(), spec).unwrap()
}

#[test]
fn table() {
    let (ex, only) = (std::env::var("EX").is_ok(), std::env::var("ONLY").ok());
    for pair in given::all() {
        let bodies = pair.bodies();
        for method in Method::ALL {
            if only.as_ref().is_some_and(|o| !o.split(',').any(|o| o == method.name())) { continue; }
            let spec = IsolateSpec { method, exact: ex, fall_back: false, ..IsolateSpec::default() };
            let t = std::time::Instant::now();
            let answer = solved(&pair, &bodies, &spec);
            let ms = t.elapsed().as_secs_f64() * 1e3;
            let r = &pair.document["reference"][method.name()];
            println!("ex={ex} {:38} {:9} {:?} ratio {:.4} ({}) steps {} ({}) turn {:?} ({}) gap {:?} tests {} regions {} {ms:.1} ms", pair.name, method.name(), answer.status,
              answer.contact_m.norm() / pair.least_m, r["ratio"], answer.steps, r["steps"], answer.turn_deg.map(|x| (x*100.0).round()/100.0), r["turn_deg"], answer.gap_m.map(|g| g), answer.overlap_tests, answer.regions);
        }
    }
}

#[test]
fn reference() {
    use crate::modeling::isolate::{pair::Pair, search::{Limit, Search, cone}};
    for given in given::all() {
        let [a, b] = given.bodies();
        let mut pair = Pair::new(&a, &b, Vector3::zeros());
        let r = crate::modeling::isolate::regions::Regions::new(&pair, &Vector3::zeros()).map_or(0, |r| r.list.len());
        let best = Search { pair: &mut pair, limit: Limit { most_rad: None } }.global(&cone(&Vector3::z(), 3.2, 300), 6).unwrap();
        println!("REF {} regions {r} {} ratio {} {:?} diam {}", given.name, best.norm(), best.norm() / given.least_m, best.as_slice(), pair.diameter_m);
    }
}
