//! What the fuzz targets do with their bytes, and what they start from. `tests/hostile_bytes.rs`
//! runs the same functions on changed copies of the seeds, so that every build tries them without
//! libFuzzer.
//!
//! A reader may refuse, in a typed error; it may not panic, hang, or take memory that the length of
//! its input does not justify. What it accepts must be written and read again.

use palpate_geometry::basis::KnotVector;
use palpate_geometry::exchange::step::{PartPick, read_part};
use palpate_geometry::exchange::{Format, Pick, read_points, read_surface, write_surface};
use palpate_geometry::math::Point3;
use palpate_geometry::part::{Part, PartSolver};
use palpate_geometry::surface::builtin;
use palpate_geometry::surface::file::{self, Unit};
use palpate_sim::scene;
use std::path::Path;

/// A target: its name, what it does, and what it starts from.
pub struct Target {
    pub name: &'static str,
    pub run: fn(&[u8]),
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// All targets of this build.
pub const TARGETS: &[Target] = &[
    Target {
        name: "surface_json",
        run: surface_json,
        seeds: || surfaces(Format::Json),
    },
    Target {
        name: "step",
        run: step,
        seeds: || surfaces(Format::Step),
    },
    Target {
        name: "iges",
        run: iges,
        seeds: || surfaces(Format::Iges),
    },
    Target {
        name: "points",
        run: points,
        seeds: point_seeds,
    },
    Target {
        name: "scene",
        run: scene,
        seeds: scene_seeds,
    },
    Target {
        name: "knots",
        run: knots,
        seeds: knot_seeds,
    },
    Target {
        name: "messages",
        run: messages,
        seeds: message_seeds,
    },
    Target {
        name: "bus",
        run: bus,
        seeds: bus_seeds,
    },
    Target {
        name: "devices",
        run: devices,
        seeds: device_seeds,
    },
    Target {
        name: "session",
        run: session,
        seeds: session_seeds,
    },
];

/// A `palpate.surface.v1` document.
pub fn surface_json(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    if let Ok(surface) = file::read(text) {
        assert_eq!(
            file::read(&file::write(&surface, Unit::Metre)).ok(),
            Some(surface),
            "not read back"
        );
    }
}

/// A STEP file.
pub fn step(bytes: &[u8]) {
    surface(bytes, Format::Step);
    let read = read_part(bytes, &PartPick::default());
    if let Some(part) = read.ok().and_then(|read| Part::new(&read.brep).ok()) {
        PartSolver::new(&part).closest(&part, &Point3::origin());
    }
}

/// An IGES file.
pub fn iges(bytes: &[u8]) {
    surface(bytes, Format::Iges);
}

fn surface(bytes: &[u8], format: Format) {
    let Ok(imported) = read_surface(bytes, format, Pick::First) else {
        return;
    };
    // Refused when it comes apart at a knot.
    if let Ok(written) = write_surface(&imported.surface, format, Unit::Metre) {
        let again = read_surface(&written, format, Pick::First);
        assert!(again.is_ok(), "accepted, written, then refused: {again:?}");
    }
}

/// STL, OBJ, PLY, glTF and points as text: one target, since each is small.
pub fn points(bytes: &[u8]) {
    for format in [
        Format::Stl,
        Format::Obj,
        Format::Ply,
        Format::Glb,
        Format::Points,
    ] {
        if let Ok(points) = read_points(bytes, format, Unit::Metre) {
            assert!(
                points
                    .iter()
                    .all(|point| point.iter().all(|x| x.is_finite())),
                "{format:?}: not finite"
            );
        }
    }
}

/// A scene. Its files are not looked for.
pub fn scene(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let parsed = scene::file::parse(text, "scene.toml", Path::new("/nowhere"));
    // All values are checked, but nothing large is built of them.
    let checked = parsed.and_then(|mut loaded| {
        for body in &mut loaded.spec.bodies {
            body.model = Some(scene::spec::ModelSpec::Rigid);
            body.surface.net = body.surface.net.map(|net| net.map(|count| count.min(32)));
        }
        for tool in &mut loaded.spec.tools {
            if let scene::spec::ShapeSpec::Surface(surface) = &mut tool.shape {
                surface.net = surface.net.map(|net| net.map(|count| count.min(32)));
            }
        }
        loaded.with(palpate_thesis::METHODS).build().map(drop)
    });
    if let Err(error) = checked {
        assert!(!error.to_string().is_empty());
    }
}

/// A degree, whether periodic, and knots, eight bytes each.
pub fn knots(bytes: &[u8]) {
    let [degree, periodic, rest @ ..] = bytes else {
        return;
    };
    let values: Vec<f64> = rest
        .chunks_exact(8)
        .map(|c| f64::from_le_bytes([c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]]))
        .collect();
    let degree = usize::from(*degree);
    let made = if periodic % 2 == 1 {
        KnotVector::periodic(degree, values)
    } else {
        KnotVector::new(degree, values)
    };
    let Ok(knots) = made else { return };
    let (start, end) = knots.domain();
    for k in 0..=8 {
        let sum: f64 = knots
            .window(start + (end - start) * (f64::from(k) / 8.0))
            .values()
            .iter()
            .sum();
        assert!((sum - 1.0).abs() < 1e-9, "values sum to {sum}: {knots:?}");
    }
}

/// What comes over the bus: a message of each type, and the arguments of each command.
pub fn messages(bytes: &[u8]) {
    use palpate_client::proto::{any, codec, messages, rpc};
    for message in messages::ALL {
        if let Some(Ok(value)) = any::to_json(message.name, bytes) {
            assert!(value.is_object(), "{}", message.name);
        }
    }
    if let Ok(pose) = codec::decode::<messages::ToolPose>(bytes, "")
        && let Ok(pose) = pose.validated()
    {
        let numbers = pose.position.iter().chain(&pose.orientation);
        let mut numbers = numbers
            .chain(&pose.linear_velocity)
            .chain(&pose.angular_velocity);
        assert!(numbers.all(|x| x.is_finite()), "{pose:?}");
        let length = pose.orientation.iter().map(|q| q * q).sum::<f64>().sqrt();
        assert!((length - 1.0).abs() < 1e-6, "{pose:?}");
    }
    for method in rpc::METHODS {
        if rpc::Call::check_length(method, bytes.len()).is_ok()
            && let Err(error) = rpc::Call::parse(method, bytes)
        {
            assert!(!error.to_string().is_empty());
        }
    }
}

/// A sequence of messages into a loop in lockstep: what a state of the loop makes of the next one.
pub fn bus(bytes: &[u8]) {
    if let Err(what) = palpate_faults::messages(bytes) {
        panic!("{what}");
    }
}

/// Device and hand files.
pub fn devices(bytes: &[u8]) {
    use palpate_client::device::{DeviceModel, Hand};
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let errors = [
        DeviceModel::from_toml(text, "fuzz").err(),
        Hand::from_toml(text, "fuzz").err(),
    ];
    for error in errors.into_iter().flatten() {
        assert!(!error.to_string().is_empty());
    }
}

/// A recording.
pub fn session(bytes: &[u8]) {
    use palpate_record::{Contents, Session, computed_info, info};
    if let Ok(session) = Session::parse_any(Path::new("session.mcap"), bytes) {
        // From the index where there is one, and from the chunks; both must come to an end.
        let _ = (info(&session), computed_info(&session));
        if session.holds_inputs_only() {
            return;
        }
        if let Ok(contents) = Contents::of(&session) {
            assert!(contents.session().is_ok(), "read, written, then refused");
        }
    }
}

fn surfaces(format: Format) -> Vec<Vec<u8>> {
    let small = r#"{"format": "palpate.surface.v1", "degree": [1, 2], "knots": [[0, 0, 1, 1], [0, 0, 0, 2, 2, 2]],
        "points": [[[0, 0, 0], [0, 1, 0], [0, 2, 1]], [[1, 0, 0], [1, 1, 0], [1, 2, 1]]], "weights": [[1, 1, 1], [1, 0.5, 1]]}"#;
    let small = file::read(small).expect("a surface");
    let made = [
        ("sheet", Some([4, 4])),
        ("torus", Some([4, 5])),
        ("sphere", None),
    ];
    let made = made.map(|(name, net)| builtin(name, net, None).expect("a builtin"));
    made.iter()
        .chain([&small])
        .filter_map(|surface| write_surface(surface, format, Unit::Metre).ok())
        .collect()
}

fn point_seeds() -> Vec<Vec<u8>> {
    let mut binary = vec![b' '; 80];
    binary.extend_from_slice(&2u32.to_le_bytes());
    binary.extend(
        (0..24)
            .flat_map(|k| (k as f32).to_le_bytes())
            .take(48)
            .chain([0, 0]),
    );
    binary.extend(
        (0..24)
            .flat_map(|k| (k as f32).to_le_bytes())
            .take(48)
            .chain([0, 0]),
    );
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e-3 0\nendloop\nendfacet\nendsolid a\n";
    let obj = "# a\nv 1 2 3\nv 0.5 -1 2e-2\nv 0 0 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";
    let lines = "x,y,z\n1,2,3\n0.5;1;2 # a\n1e-3\t2\t3\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let json = br#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]}"#;
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let triangle: Vec<u8> = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    let mut glb = b"glTF".to_vec();
    let total = 12 + 8 + json.len() + 8 + triangle.len();
    for number in [2, total as u32, json.len() as u32] {
        glb.extend(number.to_le_bytes());
    }
    glb.extend(b"JSON");
    glb.extend(&json);
    glb.extend((triangle.len() as u32).to_le_bytes());
    glb.extend(b"BIN\0");
    glb.extend(&triangle);
    vec![
        binary,
        text.into(),
        obj.into(),
        lines.into(),
        ply.into(),
        glb,
    ]
}

fn scene_seeds() -> Vec<Vec<u8>> {
    vec![
        include_bytes!("../scenes/teardrop.toml").to_vec(),
        include_bytes!("../scenes/sheet.toml").to_vec(),
        include_bytes!("../scenes/rigid-teardrop.toml").to_vec(),
    ]
}

fn knot_seeds() -> Vec<Vec<u8>> {
    let seed = |degree: u8, periodic: u8, knots: &[f64]| {
        [degree, periodic]
            .into_iter()
            .chain(knots.iter().flat_map(|knot| knot.to_le_bytes()))
            .collect()
    };
    vec![
        seed(2, 0, &[0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0]),
        seed(3, 1, &[0.0, 0.1, 0.4, 0.4, 0.7, 1.0]),
        seed(1, 0, &[-1.0, 0.0, 1.0, 2.0, 3.0]),
    ]
}

fn message_seeds() -> Vec<Vec<u8>> {
    vec![
        include_bytes!("../proto/golden/tool_pose.bin").to_vec(),
        include_bytes!("../proto/golden/device_info.bin").to_vec(),
        include_bytes!("../proto/golden/scene_snapshot.bin").to_vec(),
        include_bytes!("../proto/golden/loop_status.bin").to_vec(),
        br#"{"before": 30, "after": 0, "path": "b.mcap"}"#.to_vec(),
        br#"{"bodies": ["a", "b"], "continuity": 1, "method": "constrained", "tolerance": 1e-4, "id": "ab"}"#.to_vec(),
    ]
}

fn bus_seeds() -> Vec<Vec<u8>> {
    use palpate_faults::sequence;
    let device = include_bytes!("../proto/golden/device_info.bin");
    let pose = include_bytes!("../proto/golden/tool_pose.bin");
    let command = |method: &str, arguments: &str| {
        let methods = palpate_client::proto::rpc::METHODS;
        let number = methods.iter().position(|known| *known == method);
        let mut bytes = vec![number.expect("a method") as u8];
        bytes.extend(arguments.bytes());
        bytes
    };
    // Into the body and out of it, with a device that says what it is, a pause, and another hand.
    (0..3)
        .map(|scene| {
            sequence(
                scene,
                &[
                    (1, 0, 1, device),
                    (5, 0, 32, &[0, 0, 0]),
                    (5, 0, 32, &[0xf0, 0, 0]),
                    (5, 0, 64, &[0xd8, 0, 0]),
                    (2, 1, 8, &command("pause", "{}")),
                    (2, 1, 8, &command("step", r#"{"ticks": 3}"#)),
                    (2, 1, 8, &command("resume", "{}")),
                    (0, 1, 16, pose),
                    (3, 0, 32, &[]),
                    (5, 2, 32, &[0xe0, 4, 4]),
                    (2, 1, 8, &command("reset", "{}")),
                    (4, 0, 64, &[]),
                ],
            )
        })
        .collect()
}

fn device_seeds() -> Vec<Vec<u8>> {
    vec![
        b"name = \"arm\"\nforce_max_n = 3.3\nmass_kg = 0.1\nrate_hz = 1000\n".to_vec(),
        b"stiffness_n_per_m = 300\ndamping_n_s_per_m = 4\nmass_kg = 0.2\n".to_vec(),
    ]
}

fn session_seeds() -> Vec<Vec<u8>> {
    vec![
        include_bytes!("../recordings/golden/rigid-teardrop-press.mcap").to_vec(),
        include_bytes!("../recordings/golden/two-hands.inputs.mcap").to_vec(),
    ]
}
