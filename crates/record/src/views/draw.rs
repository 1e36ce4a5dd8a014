//! Bodies and tools as Foxglove primitives.

use palpate_geometry::math::Point3;
use palpate_geometry::skin::{Skin, motion_of_corners};
use palpate_geometry::surface::{Mesh, Surface};
use palpate_proto::foxglove as fox;
use palpate_sim::scene::Scene;

/// Cells of a body's grid in each direction: between these.
const CELLS: [usize; 2] = [12, 32];
/// Most triangles of a part.
const MOST_TRIANGLES: usize = 50_000;
/// Length of the arrow of 1 N, relative to the size of the scene.
const ARROW: f64 = 0.05;
/// Displacement that is drawn red, relative to the size of the body.
const RED: f64 = 0.1;

const TOOL: fox::Color = fox::Color {
    r: 0.95,
    g: 0.75,
    b: 0.25,
    a: 0.9,
};
const FORCE: fox::Color = fox::Color {
    r: 0.9,
    g: 0.2,
    b: 0.15,
    a: 1.0,
};
const SKIN: fox::Color = fox::Color {
    r: 0.55,
    g: 0.65,
    b: 0.85,
    a: 0.85,
};
const NET: fox::Color = fox::Color {
    r: 0.25,
    g: 0.3,
    b: 0.4,
    a: 0.6,
};

fn vector(x: f64, y: f64, z: f64) -> fox::Vector3 {
    fox::Vector3 { x, y, z }
}

fn point(p: &Point3) -> fox::Point3 {
    fox::Point3 {
        x: p.x,
        y: p.y,
        z: p.z,
    }
}

fn unturned(position: fox::Vector3) -> fox::Pose {
    let orientation = fox::Quaternion {
        x: 0.0,
        y: 0.0,
        z: 0.0,
        w: 1.0,
    };
    fox::Pose {
        position: Some(position),
        orientation: Some(orientation),
    }
}

fn origin() -> fox::Pose {
    unturned(vector(0.0, 0.0, 0.0))
}

/// A grid of points over a surface, ends included.
struct Grid {
    parameters: [Vec<f64>; 2],
    /// (cells in u × cells in v).
    shown: Vec<bool>,
}

impl Grid {
    fn over(surface: &Surface) -> Self {
        let knots = [surface.knots_u(), surface.knots_v()];
        let cells = knots.map(|knots| (2 * knots.spans().count()).clamp(CELLS[0], CELLS[1]));
        // Of each part between gaps a share of the cells; across a gap there is none.
        let mut parameters = [Vec::new(), Vec::new()];
        let mut real = [Vec::new(), Vec::new()];
        for k in 0..2 {
            let (from, to) = knots[k].domain();
            let mut ends = vec![from];
            ends.extend(knots[k].disjoined().into_iter().filter(|&knot| knot > from));
            ends.push(to);
            for (part, pair) in ends.windows(2).enumerate() {
                let share = (pair[1] - pair[0]) / (to - from);
                let count = ((cells[k] as f64 * share).round() as usize).max(1);
                if part > 0 {
                    real[k].push(false);
                }
                real[k].extend(std::iter::repeat_n(true, count));
                let last = if pair[1] < to {
                    pair[1].next_down()
                } else {
                    to
                };
                let at = |i: usize| pair[0] + (pair[1] - pair[0]) * i as f64 / count as f64;
                parameters[k].extend((0..=count).map(|i| if i == count { last } else { at(i) }));
            }
        }
        let joints = surface.joints();
        let middle = |k: usize, i: usize| 0.5 * (parameters[k][i] + parameters[k][i + 1]);
        let mut shown = Vec::with_capacity(real[0].len() * real[1].len());
        for (i, &in_u) in real[0].iter().enumerate() {
            for (j, &in_v) in real[1].iter().enumerate() {
                let twice = || {
                    joints
                        .as_ref()
                        .is_some_and(|t| t.is_duplicate_at(middle(0, i), middle(1, j)))
                };
                shown.push(in_u && in_v && !twice());
            }
        }
        Self { parameters, shown }
    }

    fn points(&self, surface: &Surface) -> Vec<Point3> {
        let [us, vs] = &self.parameters;
        us.iter()
            .flat_map(|u| vs.iter().map(|v| surface.point(*u, *v)))
            .collect()
    }

    /// Two triangles a cell.
    fn indices(&self) -> Vec<u32> {
        let [rows, columns] = [0, 1].map(|k| self.parameters[k].len() - 1);
        let at = |i: usize, j: usize| (i * (columns + 1) + j) as u32;
        let cell = |i, j| {
            [
                at(i, j),
                at(i + 1, j),
                at(i + 1, j + 1),
                at(i, j),
                at(i + 1, j + 1),
                at(i, j + 1),
            ]
        };
        let cells = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
        cells
            .zip(&self.shown)
            .filter(|(_, shown)| **shown)
            .flat_map(|((i, j), _)| cell(i, j))
            .collect()
    }

    fn triangles(
        &self,
        points: &[Point3],
        pose: fox::Pose,
        color: fox::Color,
    ) -> fox::TriangleListPrimitive {
        fox::TriangleListPrimitive {
            pose: Some(pose),
            points: points.iter().map(point).collect(),
            color: Some(color),
            colors: Vec::new(),
            indices: self.indices(),
        }
    }
}

/// Farthest control point from the first, m.
fn size_m(skin: &Skin) -> f64 {
    let points = skin.points();
    let from = points.first().copied().unwrap_or_default();
    points
        .iter()
        .map(|p| (p - from).norm())
        .fold(1e-6, f64::max)
}

/// A body that can be drawn with any net.
pub(super) struct BodyShape {
    id: String,
    form: Form,
    rest_points: Vec<Point3>,
    size_m: f64,
}

enum Form {
    Surface(Box<Surface>, Grid),
    /// Corners around it, and its triangles; at rest.
    Part(Vec<Point3>, Mesh),
}

/// A body as it is.
pub(super) struct Drawn {
    net: Vec<Point3>,
    points: Vec<Point3>,
}

impl BodyShape {
    pub fn of(scene: &Scene, body: usize) -> Self {
        let skin = scene.skin(body);
        let (form, rest_points) = match skin.surface() {
            Some(rest) => {
                let grid = Grid::over(rest);
                let points = grid.points(rest);
                (Form::Surface(Box::new(rest.clone()), grid), points)
            }
            None => {
                let mesh = scene.part_outline(body, MOST_TRIANGLES).unwrap_or_default();
                let points = mesh.points.clone();
                (Form::Part(skin.points().to_vec(), mesh), points)
            }
        };
        Self {
            id: scene.body_id(body).to_owned(),
            form,
            rest_points,
            size_m: size_m(skin),
        }
    }

    pub fn topic(&self) -> String {
        format!("/view/body/{}/points", self.id)
    }

    /// x y z of each control point; as at rest when there are not as many as the body has.
    pub fn drawn(&self, net: &[f64]) -> Drawn {
        let now = net.chunks_exact(3);
        let now = || now.clone().map(|p| Point3::new(p[0], p[1], p[2]));
        match &self.form {
            Form::Surface(rest, grid) => {
                let mut surface = rest.clone();
                let points = surface.net_mut().points_mut();
                if net.len() == 3 * points.len() {
                    points.iter_mut().zip(now()).for_each(|(to, p)| *to = p);
                }
                Drawn {
                    points: grid.points(&surface),
                    net: surface.net().points().to_vec(),
                }
            }
            Form::Part(corners, mesh) => {
                let now: Vec<Point3> = now().collect();
                let motion = motion_of_corners(corners, &now).unwrap_or_default();
                Drawn {
                    points: mesh.points.iter().map(|p| motion * p).collect(),
                    net: Vec::new(),
                }
            }
        }
    }

    pub fn entity(&self, stamp: fox::Timestamp, drawn: &Drawn) -> fox::SceneEntity {
        let (edges, triangles) = match &self.form {
            Form::Surface(rest, grid) => (
                rest.net_edges().into_iter().flatten().collect(),
                grid.triangles(&drawn.points, origin(), SKIN),
            ),
            Form::Part(_, mesh) => (
                Vec::new(),
                fox::TriangleListPrimitive {
                    pose: Some(origin()),
                    points: drawn.points.iter().map(point).collect(),
                    color: Some(SKIN),
                    colors: Vec::new(),
                    indices: mesh.triangles.iter().flatten().copied().collect(),
                },
            ),
        };
        let lines = fox::LinePrimitive {
            r#type: fox::line_primitive::Type::LineList.into(),
            pose: Some(origin()),
            thickness: 1.0,
            scale_invariant: true,
            points: drawn.net.iter().map(point).collect(),
            color: Some(NET),
            colors: Vec::new(),
            indices: edges,
        };
        fox::SceneEntity {
            timestamp: Some(stamp),
            frame_id: "world".into(),
            id: format!("body/{}", self.id),
            lines: vec![lines],
            triangles: vec![triangles],
            ..Default::default()
        }
    }

    /// x, y, z and how far from rest, four f32 a point, m; and that distance as a colour, from blue
    /// to red, four bytes.
    pub fn cloud(&self, stamp: fox::Timestamp, drawn: &Drawn) -> fox::PointCloud {
        let mut data = Vec::with_capacity(20 * drawn.points.len());
        for (now, rest) in drawn.points.iter().zip(&self.rest_points) {
            let away = (now - rest).norm();
            for value in [now.x, now.y, now.z, away] {
                data.extend_from_slice(&(value as f32).to_le_bytes());
            }
            let share = (away / (RED * self.size_m)).min(1.0);
            let mix = |from: f64, to: f64| (from + (to - from) * share).round() as u8;
            data.extend_from_slice(&[mix(90.0, 230.0), mix(120.0, 50.0), mix(210.0, 40.0), 255]);
        }
        use fox::packed_element_field::NumericType::{Float32, Uint8};
        let distances = ["x", "y", "z", "displacement_m"]
            .iter()
            .enumerate()
            .map(|(k, name)| (*name, 4 * k, Float32));
        let colours = ["red", "green", "blue", "alpha"]
            .iter()
            .enumerate()
            .map(|(k, name)| (*name, 16 + k, Uint8));
        let fields = distances
            .chain(colours)
            .map(|(name, offset, kind)| fox::PackedElementField {
                name: name.into(),
                offset: offset as u32,
                r#type: kind.into(),
            });
        fox::PointCloud {
            timestamp: Some(stamp),
            frame_id: "world".into(),
            pose: Some(origin()),
            point_stride: 20,
            fields: fields.collect(),
            data,
        }
    }
}

/// A tool that can be drawn in any pose.
pub(super) struct ToolShape {
    id: String,
    outline: Mesh,
    /// m for 1 N.
    arrow_m: f64,
}

impl ToolShape {
    pub fn of(scene: &Scene, tool: usize) -> Self {
        let size_m = (0..scene.body_count())
            .map(|body| size_m(scene.skin(body)))
            .fold(1e-3, f64::max);
        Self {
            id: scene.tool_id(tool).to_owned(),
            outline: scene.tool_outline(tool, size_m),
            arrow_m: ARROW * size_m,
        }
    }

    pub fn shape_topic(&self) -> String {
        format!("/view/tool/{}/shape", self.id)
    }

    /// Topic of its force and torque.
    pub fn wrench_topic(&self) -> String {
        format!("/tool/{}/wrench", self.id)
    }

    /// The shape, drawn once: it moves with the tool's frame.
    pub fn shape(&self, stamp: fox::Timestamp) -> fox::SceneUpdate {
        let triangles = fox::TriangleListPrimitive {
            pose: Some(origin()),
            points: self.outline.points.iter().map(point).collect(),
            color: Some(TOOL),
            colors: Vec::new(),
            indices: self.outline.triangles.iter().flatten().copied().collect(),
        };
        let entity = fox::SceneEntity {
            timestamp: Some(stamp),
            frame_id: self.frame(),
            id: format!("{}/shape", self.frame()),
            frame_locked: true,
            triangles: vec![triangles],
            ..Default::default()
        };
        fox::SceneUpdate {
            entities: vec![entity],
            ..Default::default()
        }
    }

    pub fn topic(&self) -> String {
        format!("/view/tool/{}", self.id)
    }

    pub fn frame(&self) -> String {
        format!("tool/{}", self.id)
    }

    /// The proxy's place in the values of a tick.
    pub fn pose(&self, values: &[f64]) -> Option<(fox::Vector3, fox::Quaternion)> {
        match values.get(6..13)? {
            &[px, py, pz, x, y, z, w] => Some((vector(px, py, pz), fox::Quaternion { x, y, z, w })),
            _ => None,
        }
    }

    /// The force on the tool.
    pub fn entity(
        &self,
        stamp: fox::Timestamp,
        values: &[f64],
        position: fox::Vector3,
    ) -> fox::SceneEntity {
        let mut entity = fox::SceneEntity {
            timestamp: Some(stamp),
            frame_id: "world".into(),
            id: self.frame(),
            ..Default::default()
        };
        let force = [values[0], values[1], values[2]];
        let newtons = force.iter().map(|x| x * x).sum::<f64>().sqrt();
        if newtons > 1e-6 && newtons.is_finite() {
            entity.arrows.push(self.arrow(position, force, newtons));
        }
        entity
    }

    /// Points along x before it is turned.
    fn arrow(&self, from: fox::Vector3, force: [f64; 3], newtons: f64) -> fox::ArrowPrimitive {
        let direction = palpate_geometry::math::Vector3::from(force);
        let turn = palpate_geometry::math::Rotation::rotation_between(
            &palpate_geometry::math::Vector3::x(),
            &direction,
        );
        let turn = turn.unwrap_or_else(|| {
            palpate_geometry::math::Rotation::from_axis_angle(
                &palpate_geometry::math::Vector3::z_axis(),
                std::f64::consts::PI,
            )
        });
        let [x, y, z, w]: [f64; 4] = turn.coords.into();
        let (length, width) = (self.arrow_m * newtons, 0.1 * self.arrow_m);
        fox::ArrowPrimitive {
            pose: Some(fox::Pose {
                position: Some(from),
                orientation: Some(fox::Quaternion { x, y, z, w }),
            }),
            shaft_length: 0.8 * length,
            shaft_diameter: width,
            head_length: 0.2 * length,
            head_diameter: 2.0 * width,
            color: Some(FORCE),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Triangles of a branching body cover it once, and none spans a gap.
    #[test]
    fn a_branching_body_is_drawn_once() {
        let text = include_str!("../../../../scenes/vessel.json");
        let surface = palpate_geometry::surface::file::read(text)
            .unwrap()
            .with_exact_seams();
        let grid = Grid::over(&surface);
        let points = grid.points(&surface);
        let indices = grid.indices();
        let area = |t: &[u32]| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|k| points[k as usize]);
            0.5 * (b - a).cross(&(c - a)).norm()
        };
        let drawn: f64 = indices.chunks_exact(3).map(area).sum();
        assert!(
            (drawn / surface.area() - 1.0).abs() < 0.03,
            "{drawn} m² of {} m²",
            surface.area()
        );
        let lines = surface.net_edges();
        assert!(
            !lines.contains(&[16 * 15, 17 * 15]) && !lines.contains(&[7, 8]),
            "a line across a gap"
        );
        assert!(lines.contains(&[15 * 15, 16 * 15]) && lines.contains(&[6, 7]));
    }
}
