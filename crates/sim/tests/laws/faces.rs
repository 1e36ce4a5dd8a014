//! Free rigid bodies with flat faces: how they slide, spin, lie and stand on each other.

use crate::common::{Laws as _, World};
use palpate_geometry::math::{Point3, Random, Vector3};
use palpate_sim::tick::RigidMotion;

const FAR: [f64; 3] = [5.0, 5.0, 5.0];
const G: f64 = 9.81;

/// Points of a body of revolution with flat ends and a rounded rim; its lower face lies in z = 0.
fn puck_net(radius_m: f64, height_m: f64) -> String {
    // Twelve points around: a cubic B-spline is inside of its polygon by this.
    let out = 3.0 / (2.0 + libm::cos(std::f64::consts::PI / 6.0));
    let rim = 0.025 * height_m;
    // Four rows in a plane make a span of it.
    let mut profile: Vec<(f64, f64)> = [0.0, 0.3, 0.6, 0.85, 0.95].map(|part| (part, 0.0)).into();
    profile.extend([(1.0, rim), (1.0, 0.5 * height_m), (1.0, height_m - rim)]);
    profile.extend([0.95, 0.85, 0.6, 0.3, 0.0].map(|part| (part, height_m)));
    let rows: Vec<Vec<[f64; 3]>> = (0..12)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::PI / 6.0;
            let point = |&(part, z): &(f64, f64)| {
                let r = out * part * radius_m;
                [r * libm::cos(angle), r * libm::sin(angle), z]
            };
            profile.iter().map(point).collect()
        })
        .collect();
    format!("{rows:?}")
}

/// A puck whose lower face is at a height.
fn puck(id: &str, [radius_m, height_m]: [f64; 2], z: f64, density: f64, more: &str) -> String {
    let spans = 10;
    let inner = (1..spans).map(|k| f64::from(k) / f64::from(spans));
    let v: Vec<f64> = std::iter::repeat_n(0.0, 4)
        .chain(inner)
        .chain(std::iter::repeat_n(1.0, 4))
        .collect();
    let u: Vec<f64> = (0..=12).map(|k| f64::from(k) / 12.0).collect();
    format!(
        "[[body]]\nid = \"{id}\"\nfree = true\nmaterial = {{ density_kg_m3 = {density:?} }}\npose = {{ position = [0.0, 0.0, {z:?}] }}\n\
         {more}\n[body.surface.inline]\nformat = \"palpate.surface.v1\"\nunit = \"m\"\ndegree = [3, 3]\nperiodic = [true, false]\n\
         knots = [{u:?}, {v:?}]\npoints = {}\n",
        puck_net(radius_m, height_m)
    )
}

const FLOOR: &str = "[[body]]\nid = \"floor\"\nsurface = { builtin = \"sheet\", size = 2.0 }\n";

/// A puck of 200 kPa whose lower face is at a height.
fn soft_puck(id: &str, z: f64) -> String {
    let soft = "young_pa = 200e3, poisson = 0.3, density_kg_m3 = 1000.0, damping_s = 2e-3";
    puck(id, PUCK, z, 1000.0, "model = \"continuum\"\n")
        .replace("free = true\n", "")
        .replace("density_kg_m3 = 1000.0", soft)
}

fn rub(a: &str, b: &str, mu: f64) -> String {
    format!("[[contact]]\npair = [\"{a}\", \"{b}\"]\nfriction = {{ mu = {mu:?} }}\n")
}

/// On a floor that leans about y, under gravity.
fn world(slope_rad: f64, bodies: &str) -> World {
    World::new(&format!(
        "[gravity]\nacceleration = [{:?}, 0.0, {:?}]\n{FLOOR}{bodies}\n[[tool]]\nid = \"far\"\nshape = {{ point = {{}} }}\n\
         pose = {{ position = {FAR:?} }}\n",
        G * libm::sin(slope_rad),
        -G * libm::cos(slope_rad)
    ))
}

fn motion(world: &World, body: usize) -> RigidMotion {
    world.state.rigid_motion(&world.scene, body).unwrap()
}

/// Of its axis, rad.
fn tilt(world: &World, body: usize) -> f64 {
    let [a, b] = [0.0, 1.0].map(|z| {
        world
            .state
            .carried_point(&world.scene, body, &Point3::new(0.0, 0.0, z))
    });
    let axis: Vector3 = b - a;
    libm::atan2(axis.xy().norm(), axis.z)
}

const PUCK: [f64; 2] = [0.02, 0.02];

#[test]
fn a_puck_that_is_set_flush_slides_as_coulomb_says() {
    for z in [0.0, 1e-7, 5e-5] {
        let mut world = world(
            0.0,
            &format!(
                "{}{}",
                puck("p", PUCK, z, 1000.0, "velocity_m_s = [0.6, 0.0, 0.0]"),
                rub("p", "floor", 0.1)
            ),
        );
        let start = motion(&world, 1).centre;
        let mut tilted = 0.0_f64;
        for _ in 0..200 {
            world.at_in_place(FAR);
            tilted = tilted.max(tilt(&world, 1));
        }
        let now = motion(&world, 1);
        // Of symplectic Euler, less the ticks in which it falls.
        let expected_m = 0.6 * 0.2 - 0.1 * G * 1e-6 * (200.0 * 201.0 / 2.0);
        let slid_m = (now.centre - start).x;
        assert!(
            (slid_m - expected_m).abs() < 1e-5 + 0.1 * z,
            "{slid_m} m for {expected_m}"
        );
        assert!(tilted < 1e-4, "it tilts by {tilted}");
        println!(
            "from {z} m: {:.3} mm, {:.4} m/s, tilt {tilted:.1e}",
            1e3 * (now.centre - start).x,
            now.velocity_m_s.x
        );
    }
}

#[test]
fn a_puck_that_spins_is_stopped_by_friction() {
    let mut world = world(
        0.0,
        &format!(
            "{}{}",
            puck("p", PUCK, 5e-5, 1000.0, "spin_rad_s = [0.0, 0.0, 5.0]"),
            rub("p", "floor", 0.3)
        ),
    );
    let mut stopped = None;
    for k in 0..400 {
        world.at_in_place(FAR);
        let spin = motion(&world, 1).spin_rad_s.z;
        if k % 10 == 0 && k < 120 {
            println!("{k}: {spin:.4} rad/s");
        }
        if stopped.is_none() && spin.abs() < 0.01 {
            stopped = Some(k);
        }
    }
    println!("stopped after {stopped:?} ticks");
    // 24 ms from where it lies, of a disc.
    assert!(
        stopped.is_some_and(|ticks| (20..=40).contains(&ticks)),
        "{stopped:?}"
    );
}

/// Kinetic and potential, J/kg; of a puck.
fn energy(world: &World, body: usize) -> f64 {
    let [radius_m, height_m] = PUCK;
    let RigidMotion {
        centre,
        velocity_m_s,
        spin_rad_s,
        ..
    } = motion(world, body);
    let [foot, top] = [0.0, 1.0].map(|z| {
        world
            .state
            .carried_point(&world.scene, body, &Point3::new(0.0, 0.0, z))
    });
    let axial = spin_rad_s.dot(&(top - foot));
    let axial_m2 = 0.5 * radius_m * radius_m;
    let across_m2 = radius_m * radius_m / 4.0 + height_m * height_m / 12.0;
    let across = spin_rad_s.norm_squared() - axial * axial;
    0.5 * (velocity_m_s.norm_squared() + axial_m2 * axial * axial + across_m2 * across)
        + G * centre.z
}

// Friction shares between both: what is faster is slowed more, so that both end together (Farkas et al. 2003). It is low:
// a high one leans forward and turns aside.
#[test]
fn a_puck_that_slides_and_spins_slides_straight_and_stops_both_at_once() {
    for (speed, spin) in [(0.15, 10.0), (0.2, 4.0)] {
        let moving =
            format!("velocity_m_s = [{speed:?}, 0.0, 0.0]\nspin_rad_s = [0.0, 0.0, {spin:?}]");
        let bodies = format!(
            "{}{}",
            puck("p", [0.02, 0.004], 1e-6, 1000.0, &moving),
            rub("p", "floor", 0.3)
        );
        let mut world = world(0.0, &bodies);
        let mut stopped = [None; 2];
        for k in 0..300 {
            world.at_in_place(FAR);
            let now = motion(&world, 1);
            let fast = [
                now.velocity_m_s.norm() > 0.01 * speed,
                now.spin_rad_s.norm() > 0.01 * spin,
            ];
            for (stopped, fast) in stopped.iter_mut().zip(fast) {
                *stopped = stopped.filter(|_| !fast).or((!fast).then_some(k));
            }
        }
        let centre = motion(&world, 1).centre;
        println!("{speed} m/s, {spin} rad/s: stop after {stopped:?} ticks at {centre}");
        let [Some(slid), Some(spun)] = stopped else {
            panic!("it goes on: {stopped:?}");
        };
        // The slowest that friction may be.
        let longest = 3e3 * speed / (0.3 * G);
        assert!(
            i32::abs(slid - spun) <= 2 && f64::from(slid) < longest,
            "{stopped:?}, {longest}"
        );
        // Nine points stand for the disc, so its way is not exactly straight.
        assert!(
            centre.y.abs() < 0.02 * centre.x,
            "it turned aside: {centre}"
        );
    }
}

#[test]
fn a_puck_that_falls_on_its_rim_gains_no_energy_and_comes_to_lie() {
    let mut random = Random(44);
    for _ in 0..3 {
        let lean = 0.2 + 0.8 * random.unit();
        let (sin, cos) = (libm::sin(0.5 * lean), libm::cos(0.5 * lean));
        let bodies = puck("p", PUCK, 0.03, 1000.0, "").replace(
            "position = [0.0, 0.0, 0.03]",
            &format!("position = [0.0, 0.0, 0.03], orientation = [0.0, {sin:?}, 0.0, {cos:?}]"),
        );
        let mut world = world(0.0, &format!("{bodies}{}", rub("p", "floor", 0.3)));
        let (mut least, mut most_m) = (f64::INFINITY, 0.0);
        let asleep = (0..3_000).find(|_| {
            world.at_in_place(FAR);
            let now = energy(&world, 1);
            // Faces share by a compliance, which lifts by as much as it gave way.
            most_m = f64::max(most_m, (now - least) / G);
            least = least.min(now);
            world.state.is_left_alone(1)
        });
        let centre = motion(&world, 1).centre;
        println!(
            "leaning by {lean:.2} rad: asleep after {asleep:?} ticks at {centre}, tilt {:.1e}, gained {most_m:.1e} m",
            tilt(&world, 1)
        );
        assert!(most_m < 1e-6, "it gained {most_m} m of height");
        assert!(asleep.is_some(), "it never rests");
        assert!((centre.z - 0.01).abs() < 5e-6, "{centre}");
    }
}

#[test]
fn a_plate_is_carried_by_two_balls() {
    let mut text = puck("plate", [0.04, 0.008], 0.02002, 1000.0, "");
    for (id, x) in [("a", -0.02), ("b", 0.02)] {
        text += &format!(
            "[[body]]\nid = \"{id}\"\nfree = true\nmaterial = {{ density_kg_m3 = 1000.0 }}\n\
             surface = {{ builtin = \"sphere\", size = 0.01 }}\npose = {{ position = [{x:?}, 0.0, 0.01] }}\n"
        );
    }
    for id in ["a", "b"] {
        text += &rub(id, "floor", 0.3);
        text += &rub("plate", id, 0.3);
    }
    let mut world = world(0.0, &text);
    for _ in 0..150 {
        world.at_in_place(FAR);
    }
    let plate = motion(&world, 1);
    println!(
        "the plate is at {}, tilt {:.1e}",
        plate.centre,
        tilt(&world, 1)
    );
    assert!((plate.centre.z - 0.024).abs() < 5e-6, "{}", plate.centre);
    assert!(plate.centre.coords.xy().norm() < 2e-5 && tilt(&world, 1) < 1e-3);
}

/// They sleep by one rule, whatever they are made of, and bear each other's weight then.
#[test]
fn a_rigid_puck_between_soft_ones_rests_with_them() {
    let mut text = soft_puck("s0", 2e-5)
        + &puck("r", PUCK, 0.02004, 1000.0, "")
        + &soft_puck("s1", 0.04006)
        + &rub("s0", "floor", 0.3);
    text += &(rub("s0", "r", 0.3) + &rub("r", "s1", 0.3));
    let mut world = world(0.0, &text);
    let ticks = (0..1_000).find(|_| {
        world.at_in_place(FAR);
        (1..=3).all(|b| world.state.is_left_alone(b))
    });
    let middle = motion(&world, 2);
    println!(
        "asleep after {ticks:?} ticks; the middle at {}",
        middle.centre
    );
    assert!(ticks.is_some(), "they never rest");
    assert!(middle.centre.coords.xy().norm() < 2e-6, "{}", middle.centre);
    assert!(tilt(&world, 2) < 1e-3, "{}", tilt(&world, 2));
    assert_eq!(middle.velocity_m_s.norm(), 0.0);
}

#[test]
fn a_stack_of_pucks_rests() {
    for count in [1, 2, 5, 10] {
        let ids: Vec<String> = (0..count).map(|k| format!("p{k}")).collect();
        let mut text = String::new();
        for (k, id) in ids.iter().enumerate() {
            text += &puck(id, PUCK, 0.02002 * k as f64 + 2e-5, 1000.0, "");
        }
        text += &rub("p0", "floor", 0.3);
        for pair in ids.windows(2) {
            text += &rub(&pair[0], &pair[1], 0.3);
        }
        let mut world = world(0.0, &text);
        let began = std::time::Instant::now();
        let ticks = (0..2_000).find(|_| {
            world.at_in_place(FAR);
            (1..=count).all(|b| world.state.is_left_alone(b))
        });
        let took = began.elapsed().as_secs_f64() / ticks.unwrap_or(2_000) as f64;
        let top = motion(&world, count);
        println!(
            "{count}: asleep after {ticks:?} ticks, {:.2} ms each; top at {} moves {:.1e} m/s, tilt {:.1e}",
            1e3 * took,
            top.centre,
            top.velocity_m_s.norm(),
            tilt(&world, count)
        );
        assert!(ticks.is_some(), "{count} never rest");
        assert!(
            top.centre.coords.xy().norm() < 1e-6 * (1 + count) as f64,
            "it crept to {}",
            top.centre
        );
    }
}

#[test]
fn a_stack_on_a_slope_below_the_angle_of_friction_rests() {
    for lean_deg in [1.0f64, 3.0, 8.0] {
        let count = 5;
        let mut text = rub("p0", "floor", 0.5);
        for k in 0..count {
            text = puck(
                &format!("p{k}"),
                PUCK,
                0.02002 * f64::from(k) + 2e-5,
                1000.0,
                "",
            ) + &text;
            if k > 0 {
                text += &rub(&format!("p{}", k - 1), &format!("p{k}"), 0.5);
            }
        }
        let mut world = world(lean_deg.to_radians(), &text);
        let bodies = count as usize;
        let ticks = (0..1_000).find(|_| {
            world.at_in_place(FAR);
            (1..=bodies).all(|b| world.state.is_left_alone(b))
        });
        // Bodies are in the order of the text: the top one first.
        let top = motion(&world, 1).centre;
        println!("{lean_deg}°: asleep after {ticks:?} ticks, top at {top}");
        assert!(ticks.is_some(), "at {lean_deg}° it never rests");
        // It landed from gaps of 20 µm each.
        assert!(
            top.coords.xy().norm() < 1e-4 && (top.z - 0.09).abs() < 1e-5,
            "{top}"
        );
    }
}

// What gives way in a contact must not be measured by the light body alone: under a heavy one it would sink in.
#[test]
fn a_heavy_puck_stands_on_light_ones() {
    for (count, ratio) in [(1, 10.0), (1, 1_000.0), (2, 100.0)] {
        let mut text = String::new();
        for k in 0..=count {
            let density = if k == count { 100.0 * ratio } else { 100.0 };
            let z = 0.02002 * f64::from(k) + 2e-5;
            text += &puck(&format!("p{k}"), PUCK, z, density, "");
        }
        text += &rub("p0", "floor", 0.3);
        for k in 0..count {
            text += &rub(&format!("p{k}"), &format!("p{}", k + 1), 0.3);
        }
        let mut world = world(0.0, &text);
        let bodies = count as usize + 1;
        let ticks = (0..1_000).find(|_| {
            world.at_in_place(FAR);
            (1..=bodies).all(|b| world.state.is_left_alone(b))
        });
        let top = motion(&world, bodies).centre;
        let stands_m = 0.02 * f64::from(count) + 0.01;
        println!("{ratio} : 1 on {count}: asleep after {ticks:?} ticks, top at {top}");
        assert!(ticks.is_some(), "{ratio} : 1 on {count} never rests");
        assert!(
            (top.z - stands_m).abs() < 5e-6 && top.coords.xy().norm() < 5e-6,
            "{ratio} : 1 on {count}: the top is at {top}"
        );
    }
}

// A body between the grid points of a sheet is below none of them.
#[test]
fn a_small_face_lies_anywhere_on_a_large_sheet() {
    let mut random = Random(41);
    for _ in 0..6 {
        let at = [0, 1].map(|_| 1.8 * random.unit() - 0.9);
        let lying = puck("p", [0.012, 0.008], 1e-5, 1000.0, "");
        let lying = lying.replace(
            "position = [0.0, 0.0,",
            &format!("position = [{:?}, {:?},", at[0], at[1]),
        );
        let mut world = world(0.0, &format!("{lying}{}", rub("p", "floor", 0.3)));
        for _ in 0..40 {
            world.at_in_place(FAR);
        }
        let centre = motion(&world, 1).centre;
        let off = centre - Point3::new(at[0], at[1], 0.004);
        assert!(off.norm() < 5e-6, "at {at:?} it is off by {off}");
    }
}

// Feet of a face that gives way change with every micron: those that carried must carry on, or it creeps.
#[test]
fn a_soft_puck_rests_on_a_slope_below_the_angle_of_friction_and_slides_above_it() {
    let mu = 0.3;
    for share in [0.5, 0.95, 1.1] {
        let slope = libm::atan(share * mu);
        let soft = soft_puck("p", 2e-5);
        let mut world = world(slope, &format!("{soft}{}", rub("p", "floor", mu)));
        let net = |world: &World| {
            let mut points = world.scene.rest_surface(1).unwrap().net().points().to_vec();
            world.state.copy_net(&world.scene, 1, &mut points);
            points.iter().map(|p| p.x).sum::<f64>() / points.len() as f64
        };
        for _ in 0..250 {
            world.at_in_place(FAR);
        }
        let before = net(&world);
        for _ in 0..100 {
            world.at_in_place(FAR);
        }
        let went_m = net(&world) - before;
        // From rest, less the ticks in which it settles.
        let pull = G * (libm::sin(slope) - mu * libm::cos(slope));
        let free_m = 0.5 * pull * (0.35f64.powi(2) - 0.25f64.powi(2));
        println!("{share} of the angle of friction: {went_m:.2e} m, Coulomb {free_m:.2e}");
        match share < 1.0 {
            true => assert!(went_m.abs() < 1e-7, "it creeps by {went_m} m in 0.1 s"),
            false => assert!((went_m / free_m - 1.0).abs() < 0.1, "{went_m} for {free_m}"),
        }
    }
}
