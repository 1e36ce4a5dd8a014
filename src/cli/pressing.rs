//! Tools that press the bodies nearest to them, in process: for figures of ticks in contact.

use palpate_geometry::math::{Point3, Rotation, Vector3};
use palpate_geometry::skin::SkinSolver;
use palpate_sim::haptics::DevicePose;
use palpate_sim::scene::Scene;
use palpate_sim::tick::record::{TickInput, TickOutput};

/// Stride of a tool, relative to the size of the body that it goes to.
const STRIDE: f64 = 2e-3;

/// How deep it presses from its first contact on, relative to the same.
const DEPTH: f64 = 0.03;

/// Strides at most.
const MOST_STRIDES: usize = 2_000;

/// One tool on its way.
struct Way {
    at: Point3,
    orientation: Rotation,
    /// Towards the body, as long as a stride; zero for a tool that presses nothing.
    stride: Vector3,
    /// Strides left.
    left: usize,
    touched: bool,
}

/// The tools of a scene.
pub struct Pressing {
    ways: Vec<Way>,
    seq: u64,
}

impl Pressing {
    /// Every tool at its start, about to go to the closest point of any body.
    pub fn new(scene: &Scene) -> Self {
        let way = |tool: usize| {
            let pose = &scene.spec.tools[tool].pose;
            let at = Point3::from(pose.position);
            let [x, y, z, w] = pose.orientation;
            let orientation = Rotation::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
            let carries = scene.spec.gravity.frame.as_deref() == Some(scene.tool_id(tool));
            let nearest = (0..scene.body_count())
                .filter(|_| !carries)
                .map(|body| {
                    let skin = scene.skin(body);
                    let foot = SkinSolver::new(skin).closest(skin, &at);
                    (foot, skin.size_m())
                })
                .min_by(|(a, _), (b, _)| a.signed_distance.total_cmp(&b.signed_distance));
            let stride = nearest.map_or_else(Vector3::zeros, |(foot, size_m)| {
                let towards = (foot.point - at).try_normalize(0.0).unwrap_or(-foot.normal);
                // From inside the way out is the way away from contact.
                let sign = if foot.signed_distance < 0.0 {
                    -1.0
                } else {
                    1.0
                };
                towards * (sign * STRIDE * size_m)
            });
            Way {
                at,
                orientation,
                stride,
                left: MOST_STRIDES,
                touched: false,
            }
        };
        Self {
            ways: (0..scene.tool_count()).map(way).collect(),
            seq: 0,
        }
    }

    /// Poses of the next tick, each tool a stride further; false when all have arrived.
    pub fn approach(&mut self, input: &mut TickInput) -> bool {
        let mut moving = false;
        for way in &mut self.ways {
            if way.left > 0 && way.stride != Vector3::zeros() {
                way.at += way.stride;
                way.left -= 1;
                moving = true;
            }
        }
        self.hold(input);
        moving
    }

    /// From its first contact on a tool goes on only as deep as it presses.
    pub fn felt(&mut self, output: &TickOutput) {
        for (t, way) in self.ways.iter_mut().enumerate() {
            if !way.touched && output.tools[t].contact_count > 0 {
                way.touched = true;
                way.left = way.left.min((DEPTH / STRIDE) as usize);
            }
        }
    }

    /// Poses of the next tick, with every tool where it is.
    pub fn hold(&mut self, input: &mut TickInput) {
        self.seq += 1;
        for (t, way) in self.ways.iter().enumerate() {
            input.poses[t] = Some(DevicePose {
                seq: self.seq,
                t_client_ns: 0,
                position: way.at,
                orientation: way.orientation,
                linear_velocity: Vector3::zeros(),
                angular_velocity: Vector3::zeros(),
                buttons: 0,
            });
        }
    }
}
