//! Temporary measurement.
#[path = "common/mod.rs"]
mod common;
use common::World;
use palpate_geometry::math::Vector3;
use std::time::Instant;

#[test]
#[ignore]
fn growth() {
    let sides = std::env::var("SIDES").unwrap_or("8,12,16,20,24,30".into());
    let matrix = std::env::var("MATRIX").unwrap_or("auto".into());
    for side in sides.split(',').map(|s| s.parse::<usize>().unwrap()) {
        let refine = std::env::var("REFINE").unwrap_or("\"none\"".into());
        let text = format!(
            r#"
[[body]]
id = "drop"
surface = {{ builtin = "teardrop", net = [12, 12] }}
model = "lattice"
material = {{ preset = "gel" }}
lattice = {{ builder = "transfinite", nodes = [{side}, {side}, {side}], refine = {refine} }}
integrator = {{ method = "implicit", matrix = "{matrix}" }}
fixed = [{{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }}]
[[tool]]
id = "ball"
shape = {{ sphere = {{ radius_m = 0.01 }} }}
pose = {{ position = [0.06, 0.003, 0.045] }}
coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}
device = {{ force_max_n = 1e9, ramp_s = 0.0 }}
"#
        );
        let t = Instant::now();
        let mut world = World::new(&text);
        let build = t.elapsed().as_secs_f64();
        let body = world.scene.deformable(0).unwrap();
        let (n, nnz, matrix, bytes, springs) = (
            body.unknown_count(),
            body.factor_non_zeros(),
            body.step_matrix().unwrap(),
            body.compliance_bytes(),
            body.spring_count(),
        );
        let state = body.rest_state();
        let mut scratch = body.scratch();
        let median = |mut f: Box<dyn FnMut() + '_>| {
            let mut all: Vec<f64> = (0..15)
                .map(|_| {
                    let t = Instant::now();
                    f();
                    t.elapsed().as_secs_f64() * 1e6
                })
                .collect();
            all.sort_by(f64::total_cmp);
            (all[7], all[0])
        };
        let pass = median(Box::new(|| {
            body.internal_forces(&state, &mut scratch);
        }));
        let mut moving = body.rest_state();
        moving
            .velocities
            .iter_mut()
            .for_each(|v| *v = Vector3::new(1e-3, 0.0, 0.0));
        let mut scratch = body.scratch();
        let predict = median(Box::new(|| {
            body.renew(&moving, &mut scratch);
        }));
        let follow = median(Box::new(|| { body.follow(&moving, &mut scratch); }));
        let mut copy = moving.clone();
        let cloned = median(Box::new(|| { copy.clone_from(&moving); }));
        println!("   follow {:.0} us clone {:.0} us bits {}", follow.0, cloned.0, body.factor_bits());
        let mut ticks: Vec<f64> = Vec::new();
        let mut force = 0.0;
        for k in 0..400 {
            let x = 0.034 - 4e-3 * (k as f64 / 200.0).min(1.0);
            let t = Instant::now();
            force = world.at_in_place([x, 0.003, 0.045]).tools.as_slice()[0]
                .force_n
                .norm();
            if k > 200 {
                ticks.push(t.elapsed().as_secs_f64() * 1e6);
            }
        }
        ticks.sort_by(f64::total_cmp);
        println!(
            "{side:3} n {n:6} {matrix} nnz {nnz:9} columns {:6.0} MB springs {springs} build {build:.1} s | pass {:.0} predict {:.0} (min {:.0}) us | press tick {:.0} us, force {force:.5} N",
            bytes as f64 / 1e6,
            pass.0,
            predict.0,
            predict.1,
            ticks[ticks.len() / 2]
        );
    }
}

#[test]
#[ignore]
fn scenes() {
    let all: Vec<_> = std::fs::read_dir("../../scenes").unwrap().map(|e| e.unwrap().path()).chain([std::path::PathBuf::from("../../recordings/golden/small-lattice.toml")]).collect();
    for entry in all {
        let path = if entry.is_dir() { entry.join("scene.toml") } else { entry };
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let Ok(loaded) = palpate_sim::scene::file::parse(&text, "scene.toml", path.parent().unwrap()) else { continue };
        let Ok(scene) = palpate_sim::scene::Scene::build(&loaded.spec, path.parent().unwrap()) else { continue };
        for b in 0..scene.body_count() {
            if let Some(body) = scene.deformable(b) {
                println!("{} {} unknowns {} nnz {} {:?} every {}", path.display(), scene.body_id(b), body.unknown_count(), body.factor_non_zeros(), body.step_matrix(), scene.steps_every(b));
            }
        }
    }
}
