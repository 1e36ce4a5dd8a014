//! Scenes of more than one test.

/// A rigid drop and a ball beside it: a scene of the program.
pub const RIGID_TEARDROP: &str = include_str!("../../../scenes/rigid-teardrop.toml");

/// The same scene without damping. A recording of it has a keyframe every 0.2 s.
pub const RIGID: &str = r#"
name = "rigid-teardrop"
[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [8, 8] }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
coupling = { stiffness_n_m = 1000.0, damping_n_s_m = 0.0 }
[record]
keyframe_s = 0.2
"#;

/// A rigid drop between two tools. It builds at once.
pub const TWO_BALLS: &str = r#"
[[body]]
id = "drop"
surface = { builtin = "teardrop", net = [8, 8] }
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
[[tool]]
id = "pen"
shape = { sphere = { radius_m = 0.005 } }
pose = { position = [-0.06, 0.003, 0.045] }
"#;

/// A drop that gives way, and a ball beside it.
pub const SOFT_DROP: &str = r#"
[[body]]
id = "drop"
surface = { builtin = "teardrop" }
model = "lattice"
lattice = { layers = 2, refine = [12, 13] }
fixed = [{ point = [0.0, 0.0, 0.015], normal = [0.0, 0.0, 1.0] }]
[[tool]]
id = "ball"
shape = { sphere = { radius_m = 0.01 } }
pose = { position = [0.06, 0.003, 0.045] }
"#;

/// [`SOFT_DROP`] at a rate that no machine keeps: the body never sleeps, and a step of it takes as long as ten
/// ticks.
pub fn too_slow() -> String {
    let awake = "model = \"lattice\"\nintegrator = { sleep_m_s = 0.0 }";
    let drop = SOFT_DROP
        .replace("refine = [12, 13]", "refine = [20, 21]")
        .replace("layers = 2", "layers = 8")
        .replace("model = \"lattice\"", awake);
    format!("[loop]\nrate_hz = 10000\n{drop}")
}

/// [`RIGID_TEARDROP`], and far from it a sheet with a large net: its snapshots do not fit into the buffers of a
/// socket.
pub fn with_large_net() -> String {
    format!(
        "{RIGID_TEARDROP}\n[[body]]\nid = \"far\"\nsurface = {{ builtin = \"sheet\", net = [128, 128], size = 0.1 }}\n\
         pose = {{ position = [0.0, 0.0, -1.0] }}\n"
    )
}
