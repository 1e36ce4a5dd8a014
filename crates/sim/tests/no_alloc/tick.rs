//! The tick allocates nothing once it runs.

use crate::common::{Laws as _, World, many_tools, place_of_many, step_file, teardrop};
use crate::counting::allocations;
use palpate_sim::solve::rows::Holder;
use palpate_sim::tick::record::Command;

#[test]
fn the_counter_counts() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1u8; 100]))) > 0);
}

/// Approaches, presses, slides, leaves and comes back.
fn touch(world: &mut World) -> u64 {
    for _ in 0..5 {
        world.at_in_place([0.06, 0.003, 0.045]);
    }
    let mut touched = 0;
    let count = allocations(|| {
        for k in 0..3_000 {
            let t = f64::from(k) * 1e-3;
            let x = 0.036 + 0.012 * (4.0 * t).cos();
            let out = world.at_in_place([x, 0.003 + 0.004 * (3.0 * t).sin(), 0.045]);
            touched += u32::from(out.tools[0].contact.is_some());
        }
        for _ in 0..200 {
            world.silent_in_place();
        }
    });
    assert!(touched > 500, "only {touched} ticks in touch");
    count
}

#[test]
fn a_tick_on_a_rigid_body_allocates_nothing() {
    let text = teardrop(20e3, "\"none\"")
        .replace("lattice\"\n", "rigid\"\n")
        .replace("stiffness_n_m = inf", "stiffness_n_m = 800.0");
    assert_eq!(touch(&mut World::new(&text)), 0);
}

/// Over planes, fillets and edges, and over the B-splines of a thread.
#[test]
fn a_tick_on_a_part_allocates_nothing() {
    let (ball, block) = (
        "sphere = { radius_m = 0.003 }",
        "box = { half_extents_m = [0.003, 0.002, 0.003] }",
    );
    for (name, middle, reach_m, shape) in [
        ("filleted_box", [0.03, 0.02, 0.01], 0.03, ball),
        ("filleted_box", [0.03, 0.02, 0.01], 0.03, block),
        ("thread", [0.0, 0.0, 0.015], 0.012, ball),
    ] {
        let step = step_file(name);
        let mut world = World::new(&format!(
            "[[body]]\nid = \"part\"\nsurface = {{ inline = {{ step = '''\n{step}''' }} }}\n\
             [[tool]]\nid = \"ball\"\nshape = {{ {shape} }}\n\
             pose = {{ position = [0.2, 0.0, 0.0] }}\n\
             coupling = {{ stiffness_n_m = 500.0, damping_n_s_m = 0.0 }}\n\
             [[contact]]\npair = [\"ball\", \"part\"]\nfriction = {{ mu = 0.3 }}\n"
        ));
        let at = |k: u32| {
            let t = f64::from(k) * 1e-3;
            let (out, up) = (t.cos() * (0.3 * t).cos(), (0.3 * t).sin());
            let way = [out, t.sin() * (0.3 * t).cos(), up]
                .map(|x| x * (reach_m + 0.004 * (5.0 * t).sin()));
            [0, 1, 2].map(|c| middle[c] + way[c])
        };
        for k in 0..200 {
            let far = at(0).map(|x| x * (1.0 + 0.01 * f64::from(200 - k)));
            world.at_in_place(far);
        }
        let mut touched = 0;
        let count = allocations(|| {
            for k in 0..4_000 {
                let out = world.at_in_place(at(k));
                touched += u32::from(out.tools[0].contact.is_some());
            }
            for _ in 0..100 {
                world.silent_in_place();
            }
        });
        assert!(touched > 300, "{name}: only {touched} ticks in touch");
        assert_eq!(count, 0, "{name} {shape}");
    }
}

#[test]
fn a_tick_of_a_jelly_and_a_free_part_on_a_part_allocates_nothing() {
    let part = |id: &str, more: &str| {
        let step = step_file("filleted_box");
        format!(
            "[[body]]\nid = \"{id}\"\nsurface = {{ inline = {{ step = '''\n{step}''' }} }}\n{more}\n"
        )
    };
    let jelly = "[[body]]\nid = \"jelly\"\nsurface = { builtin = \"sphere\", size = 0.01 }\nmodel = \"lattice\"\n\
                 pose = { position = [0.012, 0.02, 0.0305] }\nlattice = { layers = 2, refine = \"none\" }\n";
    let upper = part(
        "upper",
        "free = true\npose = { position = [0.03, 0.0, 0.0203] }",
    );
    for upon in [jelly, &upper] {
        let mut world = World::new(&format!(
            "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n{}{upon}\n\
             [[tool]]\nid = \"ball\"\npose = {{ position = [0.2, 0.0, 0.0] }}\n",
            part("lower", "")
        ));
        let mut touched = 0;
        let count = allocations(|| {
            for _ in 0..300 {
                world.silent_in_place();
                touched += u32::from(world.scratch.contact_force_on(1).z > 0.0);
            }
        });
        assert!(touched > 30, "in touch for {touched} ticks");
        assert_eq!(count, 0, "{}", &upon[..24]);
    }
}

#[test]
fn a_tick_on_a_lattice_allocates_nothing() {
    let text = teardrop(20e3, "[16, 17]").replace("stiffness_n_m = inf", "stiffness_n_m = 800.0");
    assert_eq!(touch(&mut World::new(&text)), 0);
}

/// Falls and comes back while it is pressed.
#[test]
fn a_change_of_quality_allocates_nothing() {
    let text = teardrop(20e3, "[16, 17]").replace("stiffness_n_m = inf", "stiffness_n_m = 800.0");
    let mut world = World::new(&text.replace(
        "model = \"lattice\"\n",
        "model = \"lattice\"\nintegrator = { iterations = 3 }\n",
    ));
    for x in [0.06, 0.052, 0.044, 0.036] {
        world.at_in_place([x, 0.003, 0.045]);
    }
    let mut touched = 0;
    let count = allocations(|| {
        for k in 0..1_200u32 {
            if k % 150 == 0 {
                let level = [1, 2, 3, 2, 1, 0, 3, 0][k as usize / 150];
                palpate_sim::tick::apply(
                    &world.scene,
                    &mut world.state,
                    &mut world.scratch,
                    Command::Quality(level),
                );
            }
            let out = world.at_in_place([0.03 - 0.006 * (0.01 * f64::from(k)).sin(), 0.003, 0.045]);
            touched += u32::from(out.tools[0].contact.is_some());
        }
    });
    assert!(touched > 300, "only {touched} ticks in touch");
    assert_eq!(count, 0);
}

/// Is set back to the start now and then while it is pressed: each time the body is struck, and so
/// much damping brings it back to the ball within some 30 ms, at 2 / (d ω²) with ω = 60 /s.
#[test]
fn a_reset_allocates_nothing() {
    let soft = teardrop(20e3, "[16, 17]")
        .replace("stiffness_n_m = inf", "stiffness_n_m = 800.0")
        .replace(
            "young_pa = 20000.0 }",
            "young_pa = 20000.0, damping_s = 20e-3 }",
        );
    let plastic = soft.replace(
        "damping_s = 20e-3 }",
        "damping_s = 20e-3, plastic = { yield_strain = 0.01, rate_per_s = 20.0, hardening = 0.1, spread_m = 0.03 } }",
    );
    assert_ne!(plastic, soft);
    for text in [soft.replace("lattice\"\n", "rigid\"\n"), soft, plastic] {
        let mut world = World::new(&text);
        for x in [0.06, 0.052, 0.044, 0.036] {
            world.at_in_place([x, 0.003, 0.045]);
        }
        let mut touched = 0;
        let count = allocations(|| {
            for k in 0..1_000u32 {
                if k % 100 == 50 {
                    palpate_sim::tick::apply(
                        &world.scene,
                        &mut world.state,
                        &mut world.scratch,
                        Command::Reset,
                    );
                }
                let out =
                    world.at_in_place([0.03 - 0.006 * (0.01 * f64::from(k)).sin(), 0.003, 0.045]);
                touched += u32::from(out.tools[0].contact.is_some());
            }
        });
        assert!(touched > 200, "only {touched} ticks in touch");
        assert_eq!(count, 0);
    }
}

/// Slides with friction, grabs, pulls, slips off and lets go.
#[test]
fn a_tick_with_friction_and_a_grip_allocates_nothing() {
    let soft = teardrop(20e3, "\"none\"").replace("stiffness_n_m = inf", "stiffness_n_m = 800.0");
    let soft = format!(
        "{soft}friction = {{ mu = 0.4, mu_kinetic = 0.3 }}\ngrip = {{ force_max_n = 0.3 }}\n"
    );
    for text in [soft.replace("lattice\"\n", "rigid\"\n"), soft] {
        let mut world = World::new(&text);
        for x in [0.06, 0.052, 0.044, 0.036] {
            world.at_in_place([x, 0.003, 0.045]);
        }
        let (mut held, mut touched) = (0, 0);
        let count = allocations(|| {
            for k in 0..3_000 {
                let t = f64::from(k) * 1e-3;
                let place = [
                    0.03 + 0.006 * (4.0 * t).cos(),
                    0.003 + 0.004 * (9.0 * t).sin(),
                    0.045,
                ];
                let out = world.all_in_place(&[(place, u32::from(k % 900 > 300))]);
                held += u32::from(out.tools[0].flags & palpate_sim::tick::flags::GRABBING != 0);
                touched += u32::from(out.tools[0].contact.is_some());
            }
        });
        assert!(
            held > 200 && touched > 500,
            "held for {held}, touched for {touched} ticks"
        );
        assert_eq!(count, 0);
    }
}

#[test]
fn a_tick_of_a_tool_that_turns_allocates_nothing() {
    let soft = teardrop(20e3, "\"none\"")
        .replace(
            "sphere = { radius_m = 0.01 }",
            "cylinder = { radius_m = 0.008, half_length_m = 0.015 }",
        )
        .replace(
            "stiffness_n_m = inf",
            "turning_stiffness_nm_rad = 0.3, stiffness_n_m = 800.0",
        )
        .replace("ramp_s = 0.0", "ramp_s = 0.0, passivity = true");
    for friction in ["", "friction = { mu = 0.4, viscous_n_s_m = 0.3 }\n"] {
        let soft = format!("{soft}{friction}");
        for text in [soft.replace("lattice\"\n", "rigid\"\n"), soft] {
            let mut world = World::new(&text);
            for x in [0.06, 0.052, 0.044, 0.036] {
                world.at_in_place([x, 0.003, 0.045]);
            }
            let (mut touched, mut damped) = (0, 0);
            let count = allocations(|| {
                for k in 0..2_000 {
                    let t = f64::from(k) * 1e-3;
                    let out = world.at_in_place([
                        0.03 + 0.008 * (40.0 * t).cos(),
                        0.003 + 0.004 * (9.0 * t).sin(),
                        0.045,
                    ]);
                    touched += u32::from(out.tools[0].contact.is_some());
                    damped += u32::from(out.tools[0].flags & palpate_sim::tick::flags::DAMPED != 0);
                }
            });
            assert!(
                touched > 500,
                "touched for {touched} ticks, damped for {damped}"
            );
            assert_eq!(count, 0);
        }
    }
}

#[test]
fn a_tick_of_two_soft_bodies_allocates_nothing() {
    // Of springs: without a thread for it (`maker`), a tick makes the matrix that follows a continuum.
    let text = include_str!("../../../../scenes/two-drops.toml").replace("continuum", "lattice");
    let mut world = World::new(&text);
    for _ in 0..5 {
        world.at_in_place([0.06, 0.003, 0.045]);
    }
    let mut met = 0;
    let count = allocations(|| {
        for k in 0..2_000 {
            let t = f64::from(k) * 1e-3;
            let out = world.at_in_place([0.022 + 0.01 * (4.0 * t).cos(), 0.003, 0.045]);
            met += u32::from(
                out.contacts
                    .list()
                    .iter()
                    .any(|c| matches!(c.holder, Holder::Body(_))),
            );
        }
    });
    assert!(met > 300, "the bodies met in {met} ticks only");
    assert_eq!(count, 0);
}

#[test]
fn a_tick_of_a_plane_allocates_nothing() {
    let plane = |text: String| {
        let tool = "{ plane = { normal = [-1.0, 0.0, 0.0] } }";
        text.replace("{ sphere = { radius_m = 0.01 } }", tool)
            .replace("stiffness_n_m = inf", "stiffness_n_m = 800.0")
    };
    for text in [
        teardrop(20e3, "[16, 17]"),
        teardrop(20e3, "\"none\"").replace("lattice\"\n", "rigid\"\n"),
    ] {
        let mut world = World::new(&plane(text));
        for _ in 0..5 {
            world.at_in_place([0.06, 0.003, 0.045]);
        }
        let mut touched = 0;
        let count = allocations(|| {
            for k in 0..1_500 {
                let t = f64::from(k) * 1e-3;
                let out = world.at_in_place([0.02 + 0.006 * (8.0 * t).cos(), 0.003, 0.045]);
                touched += u32::from(out.tools[0].contact.is_some());
            }
        });
        assert!(touched > 300, "only {touched} ticks in touch");
        assert_eq!(count, 0);
    }
}

/// Balls, points, planes and another surface, in touch and apart, on a net that moves.
#[test]
fn contacts_by_spheres_allocate_nothing() {
    use palpate_geometry::contact::{ContactSet, Reach};
    use palpate_geometry::math::{Point3, Pose, Vector3};
    use palpate_geometry::surface::builtin;
    use palpate_thesis::spheres::{Spheres, SpheresPair};

    let mut body = builtin("teardrop", None, None).unwrap();
    let tool = builtin("sphere", None, Some(0.02)).unwrap();
    let (mut b, mut t) = (Spheres::new(&body, [82; 2]), Spheres::new(&tool, [28, 82]));
    let mut pair = SpheresPair::new(&b, &t);
    let mut set = ContactSet::new();
    let mut met = 0;
    let count = allocations(|| {
        for k in 0..60 {
            let (u, v) = (0.017 * f64::from(k), 0.5 + 0.4 * (0.3 * f64::from(k)).sin());
            let at = body.point(u, v) + body.normal(u, v) * (2e-3 * f64::from(k % 16));
            body.net_mut().points_mut()[k as usize].x += 1e-4;
            b.load(&body);
            t.load_at(&tool, &Pose::translation(at.x, at.y, at.z));
            for margin_m in [0.0, 1e-3] {
                let reach = Reach {
                    margin_m,
                    below: false,
                    closing_m: 0.0,
                };
                b.ball(&at, 5e-3, &reach, &mut set);
                met += set.contacts().len();
                b.point(&at, &reach, &mut set);
                b.plane(&at, &Vector3::new(1.0, 0.2, 0.3), &reach, &mut set);
                met += set.contacts().len();
                pair.find(&mut b, &mut t, &reach, &mut set);
                met += set.contacts().len();
            }
            b.ball(&Point3::new(1.0, 1.0, 1.0), 0.01, &Reach::TOUCH, &mut set);
        }
    });
    assert!(met > 200, "{met}");
    assert_eq!(count, 0);
}

#[test]
fn a_tick_of_any_shape_allocates_nothing() {
    let shapes = [
        "{ cylinder = { radius_m = 0.008, half_length_m = 0.02 } }",
        "{ implicit = { f = \"x^2 + 2*y^2 + z^2 - 1e-4\", reach_m = 0.01 } }",
        "{ surface = { builtin = \"torus\", size = 0.01 } }",
        "{ mesh = { inline = { vertices = [[0, 0, 0.01], [0.01, 0, -0.005], [-0.005, 0.009, -0.005], [-0.005, -0.009, -0.005]], \
         triangles = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]] } } }",
    ];
    for shape in shapes {
        let soft =
            teardrop(20e3, "\"none\"").replace("stiffness_n_m = inf", "stiffness_n_m = 800.0");
        for text in [soft.replace("lattice\"\n", "rigid\"\n"), soft] {
            let mut world = World::new(&text.replace("{ sphere = { radius_m = 0.01 } }", shape));
            for _ in 0..5 {
                world.at_in_place([0.06, 0.003, 0.045]);
            }
            let mut touched = 0;
            let count = allocations(|| {
                for k in 0..300 {
                    let t = f64::from(k) * 1e-2;
                    let out = world.at_in_place([0.032 + 0.014 * (4.0 * t).cos(), 0.003, 0.045]);
                    touched += u32::from(out.tools[0].contact.is_some());
                }
            });
            assert!(touched > 30, "{shape}: only {touched} ticks in touch");
            assert_eq!(count, 0, "{shape}");
        }
    }
}

/// A slab that a ball presses, slides on and leaves.
fn slab(model: &str, more: &str) -> String {
    format!(
        "[[body]]\nid = \"slab\"\nsurface = {{ builtin = \"sheet\", net = [7, 7], size = 0.1 }}\nmodel = \"{model}\"\n\
         lattice = {{ layers = 3, refine = \"none\", thickness_m = 0.03 }}\n\
         fixed = [{{ point = [0.0, 0.0, -0.0299], normal = [0.0, 0.0, 1.0] }}, {{ u = [0.0, 0.1], v = [0.0, 1.0] }}]\n{more}\n\
         [[tool]]\nid = \"ball\"\nshape = {{ sphere = {{ radius_m = 0.02 }} }}\n\
         pose = {{ position = [0.0, 0.0, 0.03] }}\ncoupling = {{ stiffness_n_m = 800.0, damping_n_s_m = 0.0 }}\n"
    )
}

fn press_and_slide(world: &mut World) -> u64 {
    for _ in 0..8 {
        world.at_in_place([0.0, 0.0, 0.03]);
    }
    let mut touched = 0;
    let count = allocations(|| {
        for k in 0..800 {
            let t = f64::from(k) * 1e-3;
            let out = world.at_in_place([
                0.01 * (9.0 * t).sin(),
                0.0,
                0.018 + 0.006 * (20.0 * t).cos(),
            ]);
            touched += u32::from(out.tools[0].contact.is_some());
        }
        // Long enough to fall asleep.
        for _ in 0..400 {
            world.silent_in_place();
        }
    });
    assert!(touched > 200, "only {touched} ticks in touch");
    count
}

#[test]
fn a_tick_of_any_model_and_method_allocates_nothing() {
    let plastic = "plastic = { yield_strain = 0.005, rate_per_s = 20.0, hardening = 0.1, spread_m";
    let cases = [
        ("continuum", "integrator = { iterations = 2 }".to_owned()),
        (
            "continuum",
            "integrator = { method = \"explicit\" }".to_owned(),
        ),
        ("membrane", String::new()),
        ("net", String::new()),
        (
            "lattice",
            "integrator = { method = \"explicit\" }".to_owned(),
        ),
        (
            "lattice",
            "integrator = { method = \"xpbd\", substeps = 3 }".to_owned(),
        ),
        ("lattice", format!("material = {{ {plastic} = 0.0 }} }}")),
        ("lattice", format!("material = {{ {plastic} = 0.03 }} }}")),
        (
            "lattice",
            "material = { stiffening = { strain = 0.05, ratio = 3.0, least_length = 0.7 } }"
                .to_owned(),
        ),
        ("continuum", "integrator = { every = 4 }".to_owned()),
    ];
    for (model, more) in cases {
        assert_eq!(
            press_and_slide(&mut World::new(&slab(model, &more))),
            0,
            "{model}, {more}"
        );
    }
}

// Over a joint of a branching tube, whose stem is drawn twice.
#[test]
fn a_tick_on_a_branching_body_allocates_nothing() {
    let text = include_str!("../../../../scenes/vessel.toml")
        .replace("vessel.json", "../../scenes/vessel.json");
    let mut world = World::new(&text.replace("point = {}", "sphere = { radius_m = 0.004 }"));
    for _ in 0..8 {
        world.at_in_place([0.01, -0.03, -0.02]);
    }
    let mut touched = 0;
    let count = allocations(|| {
        for k in 0..800 {
            let t = f64::from(k) * 1e-3;
            // Over the front joint, and up to where the branches part.
            let out = world.at_in_place([
                0.008 * (9.0 * t).sin(),
                -0.023,
                -0.01 + 0.02 * (5.0 * t).sin(),
            ]);
            touched += u32::from(out.tools[0].contact.is_some());
        }
    });
    assert!(touched > 400, "only {touched} ticks in touch");
    assert_eq!(count, 0);
}

#[test]
fn a_tick_of_carried_bodies_allocates_nothing() {
    let carried = slab("continuum", "").replace("id = \"ball\"", "id = \"hand\"");
    let mut world = World::new(&format!(
        "[gravity]\nacceleration = [0.0, 0.0, -9.81]\nframe = \"hand\"\n{carried}"
    ));
    for _ in 0..8 {
        world.at_in_place([0.0, 0.0, 0.03]);
    }
    let count = allocations(|| {
        for k in 0..500 {
            world.at_in_place([0.02 * (f64::from(k) * 0.02).sin(), 0.0, 0.03]);
        }
    });
    assert_eq!(count, 0);
}

/// 64 tools that press, rub, turn and grab, and a reset in between.
#[test]
fn a_tick_of_64_tools_allocates_nothing() {
    let turning = many_tools(
        0..64,
        "friction = { mu = 0.4 }\ngrip = { force_max_n = 0.3 }",
    )
    .replace(
        "damping_n_s_m = 0.0 }",
        "damping_n_s_m = 0.0, turning_stiffness_nm_rad = 0.3 }",
    )
    .replace(
        "sphere = { radius_m = 0.02 }",
        "cylinder = { radius_m = 0.02, half_length_m = 0.02 }",
    );
    // Cylinders that lie flat are dear.
    for (text, ticks) in [(many_tools(0..64, ""), 150), (turning, 50)] {
        let mut world = World::new(&text);
        let mut places = [([0.0; 3], 0); 64];
        let mut touched = 0;
        let mut press = |world: &mut World, k: u32| {
            for (tool, (place, buttons)) in places.iter_mut().enumerate() {
                let [x, y, _] = place_of_many(tool);
                let t = f64::from(k) * 0.02 + 0.1 * tool as f64;
                *place = [x + 0.004 * (1.7 * t).sin(), y, 0.02 + 0.004 * t.cos()];
                *buttons = u32::from((k + tool as u32) % 90 > 60);
            }
            let output = world.all_in_place(&places);
            touched += output
                .tools
                .first(64)
                .filter(|out| out.contact.is_some())
                .count();
        };
        for k in 0..5 {
            press(&mut world, k);
        }
        let count = allocations(|| {
            for k in 5..ticks {
                if k == ticks * 2 / 3 {
                    palpate_sim::tick::apply(
                        &world.scene,
                        &mut world.state,
                        &mut world.scratch,
                        Command::Reset,
                    );
                }
                press(&mut world, k);
            }
            for _ in 0..20 {
                world.silent_in_place();
            }
        });
        assert!(
            touched > 20 * ticks as usize,
            "only {touched} tools in touch"
        );
        assert_eq!(count, 0);
    }
}

/// A plate goes up and down by a script under a ball, another is carried by a tool.
#[test]
fn a_tick_with_rigid_bodies_that_move_allocates_nothing() {
    let mut world = World::new(
        "[[body]]\nid = \"plate\"\nsurface = { builtin = \"sheet\" }\n\
         motion = { repeat = true, waypoint = [ { time_s = 0.0, position = [0.0, 0.0, 0.0] }, { time_s = 0.4, position = [0.0, 0.0, 0.01] }, { time_s = 0.8, position = [0.0, 0.0, 0.0] } ] }\n\
         [[body]]\nid = \"tray\"\nsurface = { builtin = \"sheet\" }\npose = { position = [0.0, 0.0, -0.1] }\ncarried_by = \"hand\"\n\
         [[tool]]\nid = \"hand\"\nshape = { point = {} }\n[[tool]]\nid = \"ball\"\nshape = { sphere = { radius_m = 0.01 } }\npose = { position = [0.0, 0.0, 0.02] }\n",
    );
    for _ in 0..5 {
        world.all_in_place(&[([0.0; 3], 0), ([0.0, 0.0, 0.015], 0)]);
    }
    let mut touched = 0;
    let count = allocations(|| {
        for k in 0..1_600 {
            let aside = 1e-5 * f64::from(k);
            let out = world.all_in_place(&[([aside, 0.0, 0.0], 0), ([0.0, 0.0, 0.015], 0)]);
            touched += u32::from(out.tools[1].contact.is_some());
        }
    });
    assert!((400..1_400).contains(&touched), "{touched} ticks in touch");
    assert_eq!(count, 0);
}

/// A ball rolls on a plate, under a pen that pushes it, and comes to a soft one.
#[test]
fn a_tick_with_free_rigid_bodies_allocates_nothing() {
    let mut world = World::new(
        "[gravity]\nacceleration = [0.0, 0.0, -9.81]\n\
         [[body]]\nid = \"plate\"\nsurface = { builtin = \"sheet\", size = 0.4 }\n\
         [[body]]\nid = \"ball\"\nsurface = { builtin = \"sphere\", size = 0.02 }\npose = { position = [0.0, 0.0, 0.0201] }\n\
         free = true\nspin_rad_s = [0.0, 20.0, 5.0]\n\
         [[body]]\nid = \"soft\"\nsurface = { builtin = \"sphere\", size = 0.02 }\npose = { position = [0.05, 0.0, 0.0201] }\n\
         model = \"lattice\"\nlattice = { layers = 2, refine = \"none\" }\n\
         [[contact]]\npair = [\"ball\", \"plate\"]\nfriction = { mu = 0.4 }\n\
         [[tool]]\nid = \"pen\"\nshape = { sphere = { radius_m = 0.005 } }\npose = { position = [-0.05, 0.0, 0.02] }\n",
    );
    for _ in 0..5 {
        world.at_in_place([-0.05, 0.0, 0.02]);
    }
    let mut touched = 0;
    let count = allocations(|| {
        for k in 0..600 {
            let out = world.at_in_place([-0.05 + 2e-4 * f64::from(k), 0.0, 0.02]);
            touched += out.contacts.list().len();
        }
    });
    assert!(touched > 300, "{touched} contacts");
    assert_eq!(count, 0);
}
