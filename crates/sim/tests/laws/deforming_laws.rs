//! Laws of deforming bodies: what force must not depend on, what it must agree with, and that a
//! restored state goes on as it was.

use crate::common::{Laws as _, World, pose, press};
use palpate_geometry::math::{Rotation, SavedState, Vector3, state_hash};
use palpate_sim::body::DeformableState;
use palpate_sim::haptics::DevicePose;
use palpate_sim::tick::record::{Command, TickInput};
use palpate_sim::tick::{apply, restore, step};

fn ball(radius_m: f64) -> String {
    format!(
        "[[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = {radius_m:?} }} }}\n\
         pose = {{ position = [0.0, 0.0, 0.1] }}\n\
         coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}\n\
         device = {{ force_max_n = 1e9, ramp_s = 0.0, speed_max_m_s = 1e6 }}\n"
    )
}

/// A slab of 0.1 m × 0.1 m × 0.03 m with its underside fixed, and a ball of 20 mm.
fn slab(model: &str, lattice: &str, more: &str) -> String {
    format!(
        "[[body]]\nid = \"slab\"\nsurface = {{ builtin = \"sheet\", net = [7, 7], size = 0.1 }}\nmodel = \"{model}\"\n\
         lattice = {{ thickness_m = 0.03, {lattice} }}\n\
         fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}]\n{more}\n{}",
        ball(0.02)
    )
}

const PLAIN: &str = "layers = 4, refine = \"none\"";

fn body(world: &World, b: usize) -> &DeformableState {
    world.state.bodies[b].deformable.as_ref().unwrap()
}

fn base_n(world: &World, b: usize) -> Vector3 {
    world
        .scene
        .deformable(b)
        .unwrap()
        .base_reaction_n(body(world, b))
}

#[test]
fn force_grows_as_the_modulus() {
    let per_young = |young: f64| {
        let more = format!("material = {{ young_pa = {young:?} }}");
        press(
            &mut World::new(&slab("continuum", PLAIN, &more)),
            0.006,
            500,
        ) / young
    };
    let first = per_young(20e3);
    for scale in [10.0, 100.0, 1_000.0] {
        let share = per_young(20e3 * scale) / first;
        println!("F / E at {scale} times the modulus: {share}");
        assert!(
            (share - 1.0).abs() < 5e-3,
            "{scale} times the modulus gives {share} of its force"
        );
    }
}

fn held(rate_hz: u32, iterations: u32) -> f64 {
    let more = format!("integrator = {{ iterations = {iterations} }}");
    let text = format!(
        "[loop]\nrate_hz = {rate_hz}\n{}",
        slab("continuum", PLAIN, &more)
    );
    press(&mut World::new(&text), 0.006, 800)
}

#[test]
fn force_at_rest_does_not_depend_on_dt() {
    let reference = held(1_000, 1);
    for rate_hz in [4_000, 200, 50] {
        let share = held(rate_hz, 1) / reference;
        println!("{rate_hz} Hz: {share}");
        assert!(
            (share - 1.0).abs() < 1e-3,
            "{rate_hz} Hz: {share} of the force"
        );
    }
}

#[test]
fn force_at_rest_does_not_depend_on_iterations() {
    let reference = held(1_000, 1);
    for iterations in [2, 5] {
        let share = held(1_000, iterations) / reference;
        assert!(
            (share - 1.0).abs() < 1e-3,
            "{iterations} iterations: {share} of the force"
        );
    }
}

/// Coefficients of a + b x² + c x⁴ through forces, least squares, and the largest miss relative to
/// a.
fn even_trend(places: &[f64], forces: &[f64]) -> ([f64; 3], f64) {
    let scale = places.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let rows: Vec<[f64; 3]> = places
        .iter()
        .map(|x| x / scale)
        .map(|t| [1.0, t * t, t.powi(4)])
        .collect();
    let a = nalgebra::DMatrix::from_fn(rows.len(), 3, |r, c| rows[r][c]);
    let b = nalgebra::DVector::from_column_slice(forces);
    let fit = a.clone().svd(true, true).solve(&b, 1e-12).unwrap();
    let miss = (&a * &fit - &b)
        .iter()
        .fold(0.0_f64, |most, e| most.max(e.abs()));
    ([fit[0], fit[1], fit[2]], miss / fit[0])
}

// The net moves the same cells as the full model, by fewer coordinates. Slid across them, the force
// of a slab changes slowly and alike on both sides; what is left is the grid, and a hand would feel
// it. Three control points lie across the contact.
#[test]
fn a_net_presses_as_its_full_model_wherever_the_tool_stands() {
    let slide = |y: f64, model: &str, lattice: &str| {
        let text = slab(
            model,
            lattice,
            "material = { young_pa = 20e3, damping_s = 2e-3 }",
        );
        let text = text.replace("net = [7, 7]", "net = [11, 11]").replace(
            "sphere = { radius_m = 0.02 }",
            "sphere = { radius_m = 0.04 }",
        );
        assert!(text.contains("0.04"));
        // Nothing but the nets.
        let text = format!("{text}[[contact]]\npair = [\"ball\", \"slab\"]\nnear_field = false\n");
        let mut world = World::new(&text);
        world.at([-0.015, y, 0.041]);
        for k in 0..300 {
            world.at([-0.015, y, 0.04 - 0.008 * (f64::from(k) / 150.0).min(1.0)]);
        }
        let (mut places, mut forces) = (Vec::new(), Vec::new());
        for k in 0..=900 {
            let x = -0.015 + 0.03 * f64::from(k) / 900.0;
            let force = world.at([x, y, 0.032]).tools[0].force_n.z;
            // The start of the slide is felt in both.
            if (-0.0125..=0.0125).contains(&x) {
                places.push(x);
                forces.push(force);
            }
        }
        (places, forces)
    };
    let coarse = "layers = 4, refine = \"none\", cells_per_span = 2, cell_layers = 6";
    let reduced = slide(0.0, "net", coarse);
    let full = slide(0.0, "continuum", "layers = 7, refine = [19, 19]");
    let (net, whole) = (
        even_trend(&reduced.0, &reduced.1),
        even_trend(&full.0, &full.1),
    );
    // Forces on fine nets rattle from tick to tick, as rows of contact come and go (the full
    // model's by 13 %), another way at each y; the trend is what the body gives.
    let rattle = |y: f64| {
        let (places, forces) = slide(y, "net", coarse);
        even_trend(&places, &forces).1
    };
    let mut ripples = [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 2e-3, -1e-3].map(rattle);
    ripples.sort_by(f64::total_cmp);
    // Of one line alone it would be the chance of which rows its ticks begin with.
    let ripple = ripples[ripples.len() / 2];
    let trend = |x: f64| {
        let t = x / 0.0125;
        whole.0[0] + whole.0[1] * t * t + whole.0[2] * t.powi(4)
    };
    let misses = reduced
        .0
        .iter()
        .zip(&reduced.1)
        .map(|(x, force)| (force / trend(*x) - 1.0).abs());
    let miss = misses.fold(0.0, f64::max);
    println!(
        "net {:?} N, ripple {ripple}; full {:?} N, ripple {}; apart by {miss}",
        net.0, whole.0, whole.1
    );
    assert!(
        miss < 0.05,
        "the net is off by {miss}: {net:?}, full {whole:?}"
    );
    assert!(ripple < 0.02, "the net ripples by {ripple}");
}

/// Forces while the ball comes down at 60 mm/s.
fn coming_down(iterations: u32, friction: &str) -> Vec<f64> {
    let more = format!("integrator = {{ iterations = {iterations} }}");
    let text = slab("continuum", PLAIN, &more)
        .replace("id = \"ball\"", &format!("id = \"ball\"\n{friction}"));
    let mut world = World::new(&text);
    (0..120)
        .map(|k| {
            world
                .at([1e-5 * f64::from(k), 0.0, 0.021 - 6e-5 * f64::from(k)])
                .tools[0]
                .force_n
                .z
        })
        .collect()
}

#[test]
fn iterations_bring_a_moving_contact_nearer_to_its_end() {
    for friction in ["", "friction = { mu = 0.4 }"] {
        let end = coming_down(10, friction);
        let most = end.iter().copied().fold(0.0, f64::max);
        let mut last = f64::INFINITY;
        for iterations in [1, 2, 4, 7] {
            let forces = coming_down(iterations, friction);
            let worst = forces
                .iter()
                .zip(&end)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max)
                / most;
            println!("{friction} {iterations} iterations: {worst} of the largest force");
            assert!(
                worst < 0.8 * last,
                "{iterations} iterations are off by {worst}, fewer by {last}"
            );
            last = worst;
        }
    }
}

#[test]
fn a_pause_in_contact_leaves_no_trace() {
    for iterations in [1, 3] {
        let text = slab(
            "continuum",
            PLAIN,
            &format!("integrator = {{ iterations = {iterations} }}"),
        );
        let (mut through, mut paused) = (World::new(&text), World::new(&text));
        let place = |k: u32| [0.0, 0.0, 0.021 - 5e-5 * f64::from(k.min(100))];
        for k in 0..60 {
            through.at(place(k));
            paused.at(place(k));
        }
        apply(
            &paused.scene,
            &mut paused.state,
            &mut paused.scratch,
            Command::Pause,
        );
        let stood = body(&paused, 0).clone();
        for _ in 0..20 {
            paused.at(place(60));
        }
        assert_eq!(*body(&paused, 0), stood);
        // The same body, met by the same tool in a world that was never paused.
        let mut saved = SavedState::default();
        saved.save_from(&paused.state);
        restore(
            &through.scene,
            &mut through.state,
            &mut through.scratch,
            &saved,
        )
        .unwrap();
        through.seq = paused.seq;
        for world in [&mut through, &mut paused] {
            apply(
                &world.scene,
                &mut world.state,
                &mut world.scratch,
                Command::Resume,
            );
        }
        for k in 60..200 {
            through.at(place(k));
            paused.at(place(k));
            assert_eq!(
                state_hash(&through.state),
                state_hash(&paused.state),
                "tick {k}"
            );
        }
    }
}

/// How much more force a layer bonded to its base takes than a half-space: the series of Dimitriadis et
/// al. 2002, Biophys. J. 82:2798, eq. 11, in χ = √(R δ) / h, with α and β of a bonded layer.
pub(super) fn bonded_layer(nu: f64, chi: f64) -> f64 {
    let alpha = -(1.2876 - 1.4678 * nu + 1.3442 * nu * nu) / (1.0 - nu);
    let beta = (0.6387 - 1.0277 * nu + 1.5164 * nu * nu) / (1.0 - nu);
    let pi = std::f64::consts::PI;
    1.0 - 2.0 * alpha / pi * chi + 4.0 * (alpha / pi).powi(2) * chi * chi
        - 8.0 / pi.powi(3) * (alpha.powi(3) + 4.0 * pi * pi / 15.0 * beta) * chi.powi(3)
        + 16.0 * alpha / pi.powi(4) * (alpha.powi(3) + 3.0 * pi * pi / 5.0 * beta) * chi.powi(4)
}

// Without lateral contraction a base that is held changes nothing: F = E A ε, but for 2 ε of the law's curvature.
#[test]
fn a_plate_on_a_block_presses_as_its_modulus_says() {
    let (young, side, thickness, strain) = (20e3, 0.1, 0.03, 1e-3);
    for model in ["continuum", "net"] {
        let text = format!(
            "[loop]\nrate_hz = 200\n[[body]]\nid = \"block\"\n\
             surface = {{ builtin = \"sheet\", net = [8, 8], size = {side:?} }}\nmodel = \"{model}\"\n\
             material = {{ young_pa = {young:?}, poisson = 0.0, damping_s = 5e-3 }}\n\
             lattice = {{ thickness_m = {thickness:?}, layers = 4, refine = \"none\" }}\n\
             fixed = [{{ point = [0.0, 0.0, {:?}], normal = [0.0, 0.0, 1.0] }}]\n\
             [[tool]]\nid = \"plate\"\nshape = {{ plane = {{ normal = [0.0, 0.0, -1.0] }} }}\n\
             pose = {{ position = [0.0, 0.0, 0.01] }}\n\
             coupling = {{ stiffness_n_m = inf, damping_n_s_m = 0.0 }}\ndevice = {{ force_max_n = 1e9 }}\n",
            1e-4 - thickness
        );
        let mut world = World::new(&text);
        let mut force = 0.0;
        for k in 0..600 {
            let share = (f64::from(k) / 200.0).min(1.0);
            let z = 0.001 - (0.001 + strain * thickness) * share;
            force = world.at([0.0, 0.0, z]).tools[0].force_n.z;
        }
        let ratio = force / (young * side * side * strain);
        println!("{model}: {ratio} of E A ε, base {} N", base_n(&world, 0).z);
        assert!((ratio - 1.0).abs() < 0.005, "{model}: {ratio} of E A ε");
    }
}

// Hertz' F = 4 E √R δ^1.5 / 3 (1 − ν²) on a bonded layer.
#[test]
fn a_sphere_on_a_thick_slab_presses_as_hertz_says() {
    let (young, nu, radius, thickness) = (20e3, 0.3, 0.06, 0.04);
    // x of knots, m: fine below the ball, coarse far off.
    let outer = [0.0185, 0.0265, 0.0405, 0.065];
    let inner = (-5..=5).map(|k| 0.0028 * f64::from(k));
    let mut knots: Vec<f64> = outer
        .iter()
        .flat_map(|x| [-x, *x])
        .chain(inner)
        .map(|x| 0.5 + x / 0.2)
        .collect();
    knots.sort_by(f64::total_cmp);
    let text = format!(
        "[loop]\nrate_hz = 200\n[[body]]\nid = \"slab\"\nsurface = {{ builtin = \"sheet\", net = [4, 4], size = 0.2 }}\n\
         model = \"continuum\"\nmaterial = {{ young_pa = {young:?}, poisson = {nu:?}, damping_s = 5e-3 }}\n\
         lattice = {{ thickness_m = {thickness:?}, layers = 11, refine = {{ u = {knots:?}, v = {knots:?} }} }}\n\
         fixed = [{{ point = [0.0, 0.0, -0.0399], normal = [0.0, 0.0, 1.0] }}]\n{}",
        ball(radius)
    );
    let mut world = World::new(&text);
    let depths = [1.0e-3, 1.6e-3, 2.4e-3, 3.6e-3];
    let (mut last, mut points) = (0.0, Vec::new());
    for depth in depths {
        let (mut force, mut low, mut high) = (0.0, f64::INFINITY, 0.0_f64);
        for k in 0..120 {
            let now = last + (depth - last) * (f64::from(k) / 30.0).min(1.0);
            let held = world.at([0.0, 0.0, radius - now]).tools[0].force_n.z;
            if k >= 60 {
                force += held / 60.0;
                (low, high) = (low.min(held), high.max(held));
            }
        }
        println!(
            "held between {low} and {high} N, base {} N",
            base_n(&world, 0).z
        );
        // There are more samples in touch than rows: which of them are rows must not change.
        assert!(high - low < 0.01 * force, "{depth} m: {low} to {high} N");
        last = depth;
        let corrected = force / bonded_layer(nu, (radius * depth).sqrt() / thickness);
        let hertz = 4.0 / 3.0 * young / (1.0 - nu * nu) * radius.sqrt() * depth.powf(1.5);
        println!(
            "{depth} m: {force} N, corrected {corrected}, Hertz {hertz}, ratio {}",
            corrected / hertz
        );
        points.push((depth.ln(), corrected.ln(), corrected / hertz));
    }
    let n = points.len() as f64;
    let (mx, my) = (
        points.iter().map(|p| p.0).sum::<f64>() / n,
        points.iter().map(|p| p.1).sum::<f64>() / n,
    );
    let slope = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>()
        / points.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>();
    println!("exponent {slope}");
    assert!((slope - 1.5).abs() < 0.05, "exponent {slope}");
    for (k, point) in points.iter().enumerate() {
        assert!(
            (point.2 - 1.0).abs() < 0.08,
            "at {} m: {} of Hertz",
            depths[k],
            point.2
        );
    }
}

/// Two teardrops side by side with their lower ends fixed, overlapping by about 2 mm at rest.
fn drops(model: &str, young_right_pa: f64) -> String {
    let drop = |id: &str, x: f64, young: f64| {
        format!(
            "[[body]]\nid = \"{id}\"\nsurface = {{ builtin = \"teardrop\", net = [8, 8] }}\n\
             pose = {{ position = [{x:?}, 0.0, 0.0] }}\nmodel = \"{model}\"\n\
             material = {{ young_pa = {young:?} }}\nlattice = {{ layers = 3, refine = [12, 13] }}\n\
             fixed = [{{ point = [0.0, 0.0, 0.006], normal = [0.0, 0.0, 1.0] }}]\n"
        )
    };
    drop("left", 0.0, 20e3) + &drop("right", -0.0335, young_right_pa) + &ball(0.01)
}

// What one body presses on the other it feels back, so the bases bear equal and opposite forces,
// whatever the bodies are made of.
#[test]
fn two_bodies_press_each_other_alike() {
    for (model, young) in [("lattice", 20e3), ("lattice", 2e6), ("continuum", 20e3)] {
        let mut world = World::new(&drops(model, young));
        world.rest(|world| _ = world.at_in_place([0.2, 0.2, 0.2]), 3_000);
        let (left, right) = (base_n(&world, 0), base_n(&world, 1));
        println!(
            "{model} against {young} Pa: {} N and {} N",
            left.norm(),
            right.norm()
        );
        assert!(left.norm() > 0.02, "{model}: they do not touch, {left}");
        let miss = (left + right).norm() / left.norm();
        assert!(
            miss < 1e-3,
            "{model} against {young} Pa: {left} and {right}, off by {miss}"
        );
    }
}

/// One tick with the first tool turned.
fn turned(world: &mut World, place: [f64; 3], angle: f64) {
    world.seq += 1;
    let mut input = TickInput::default();
    let orientation = Rotation::from_axis_angle(&Vector3::y_axis(), angle);
    input.poses[0] = Some(DevicePose {
        orientation,
        ..pose(world.seq, place)
    });
    step(&world.scene, &mut world.state, &mut world.scratch, &input);
}

/// Runs to a tick, saves, goes on; a fresh world restored from there must go on with the same bits.
fn goes_on(what: &str, text: &str, at: u32, tick: impl Fn(&mut World, u32)) {
    let (mut first, mut again) = (World::new(text), World::new(text));
    for k in 0..at {
        tick(&mut first, k);
    }
    let mut saved = SavedState::default();
    saved.save_from(&first.state);
    // A world that has been elsewhere.
    for k in 0..37 {
        tick(&mut again, k);
    }
    restore(&again.scene, &mut again.state, &mut again.scratch, &saved).unwrap();
    again.seq = first.seq;
    assert_eq!(
        state_hash(&first.state),
        state_hash(&again.state),
        "{what}: restored"
    );
    for k in at..at + 400 {
        tick(&mut first, k);
        tick(&mut again, k);
        assert_eq!(
            state_hash(&first.state),
            state_hash(&again.state),
            "{what}: tick {k}"
        );
    }
}

#[test]
fn a_restored_state_goes_on_with_the_same_bits() {
    let lower = |world: &mut World, k: u32| {
        world.at([0.001, 0.0, 0.021 - 0.008 * (f64::from(k) / 400.0).min(1.0)]);
    };
    for spread in ["0.0", "0.03"] {
        let plastic = format!(
            "material = {{ plastic = {{ yield_strain = 0.01, rate_per_s = 20.0, hardening = 0.1, spread_m = {spread} }} }}"
        );
        for model in ["lattice", "continuum", "net"] {
            goes_on(
                &format!("plastic flow of a {model}"),
                &slab(model, PLAIN, &plastic),
                300,
                lower,
            );
        }
    }
    // Asleep when it is saved, woken after 200 ticks.
    let late = |world: &mut World, k: u32| {
        world.at([
            0.0,
            0.0,
            0.03 - 0.02 * (f64::from(k.saturating_sub(500)) / 200.0).min(1.0),
        ]);
    };
    let mut sleeper = World::new(&slab("lattice", PLAIN, ""));
    (0..300).for_each(|k| late(&mut sleeper, k));
    assert!(
        sleeper
            .scene
            .deformable(0)
            .unwrap()
            .asleep(body(&sleeper, 0))
    );
    goes_on("sleep", &slab("lattice", PLAIN, ""), 300, late);
    // 301 and 302 lie within a step of three ticks.
    for at in [300, 301, 302] {
        goes_on(
            "every = 3",
            &slab("continuum", PLAIN, "integrator = { every = 3 }"),
            at,
            lower,
        );
    }
    for model in ["continuum", "membrane", "lattice"] {
        goes_on(
            model,
            &slab(model, PLAIN, "integrator = { iterations = 2 }"),
            300,
            lower,
        );
    }
    goes_on(
        "explicit",
        &slab("continuum", PLAIN, "integrator = { method = \"explicit\" }"),
        300,
        lower,
    );
    goes_on(
        "net",
        &slab("net", "layers = 3, refine = \"none\"", ""),
        300,
        lower,
    );
    let hand = "[[tool]]\nid = \"hand\"\nshape = { point = {} }\n";
    let body_only = slab("continuum", PLAIN, "").replace(&ball(0.02), "");
    let carried =
        format!("[gravity]\nacceleration = [0.0, 0.0, -9.81]\nframe = \"hand\"\n{body_only}{hand}");
    goes_on("carried frame", &carried, 300, |world, k| {
        let t = f64::from(k) * 1e-3;
        turned(
            world,
            [0.02 * libm::sin(9.0 * t), 0.0, 0.5],
            0.4 * libm::sin(5.0 * t),
        );
    });
}
