//! Where on a body to work.

use super::smooth::Flow;
use palpate_proto::messages::SceneSnapshot;

/// Distance from where a ball touches at which it is free, m.
const CLEAR_M: f64 = 0.01;

/// Where on a body to work: chosen from the scene, so that scripts need no numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// A place near the surface, m.
    pub point: [f64; 3],
    /// From the body towards the tool, unit.
    pub outward: [f64; 3],
    /// Along the surface, unit, across `outward`.
    pub along: [f64; 3],
    /// Distance from `point` at which the tool is surely free, m.
    pub clear_m: f64,
}

impl Target {
    /// Aims a tool at the body nearest to where the scene puts it: straight towards the body's
    /// middle axis.
    pub fn of(scene: &SceneSnapshot, tool: &str) -> Option<Self> {
        let tool = scene.tools.iter().find(|t| t.id == tool)?;
        let from = tool.position;
        let distance = |p: &[f64; 3]| {
            (0..3)
                .map(|c| (p[c] - from[c]) * (p[c] - from[c]))
                .sum::<f64>()
        };
        let body = scene
            .bodies
            .iter()
            .filter(|b| !b.rest_points.is_empty())
            .min_by(|a, b| {
                let least = |body: &palpate_proto::messages::BodySnapshot| {
                    body.rest_points
                        .iter()
                        .map(distance)
                        .fold(f64::INFINITY, f64::min)
                };
                least(a).total_cmp(&least(b))
            })?;
        let near = *body
            .rest_points
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        // Straight in along the axis on which the tool is farthest from the net's nearest point.
        let away = [0, 1, 2].map(|c| from[c] - near[c]);
        let axis = (0..3)
            .max_by(|&a, &b| away[a].abs().total_cmp(&away[b].abs()))
            .unwrap_or(0);
        let mut outward = [0.0; 3];
        outward[axis] = if away[axis] < 0.0 { -1.0 } else { 1.0 };
        let mut along = [0.0; 3];
        along[if axis == 2 { 0 } else { 2 }] = 1.0;
        // First touch: the ball's centre stands off by its radius from the nearest net point's
        // plane.
        let mut point = from;
        point[axis] = near[axis] + outward[axis] * tool.radius;
        Some(Self {
            point,
            outward,
            along,
            clear_m: clear_m(&tool.shape, away[axis].abs()),
        })
    }

    /// Third direction.
    fn side(&self) -> [f64; 3] {
        let (a, b) = (self.outward, self.along);
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    }

    /// A place by its height over `point` and its distances along the surface, m.
    pub(super) fn place(&self, height: Flow, along: Flow, side: Flow) -> [Flow; 3] {
        let third = self.side();
        [0, 1, 2].map(|c| {
            Flow::constant(self.point[c])
                + height * self.outward[c]
                + along * self.along[c]
                + side * third[c]
        })
    }

    /// Height for `pressed` from 0, clear of the surface, to 1, in by `depth_m`.
    pub(super) fn height(&self, pressed: Flow, depth_m: f64) -> Flow {
        Flow::constant(self.clear_m) - pressed * (self.clear_m + depth_m)
    }
}

/// Height over the body's nearest point at which a tool is free that the scene puts at another, m. How far shapes other
/// than balls reach is not said; where the scene puts them they are free.
fn clear_m(shape: &str, away_m: f64) -> f64 {
    match shape {
        "point" | "sphere" | "plane" => CLEAR_M,
        _ => away_m.max(CLEAR_M),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A ring or a box may reach farther than a ball's 10 mm.
    #[test]
    fn a_tool_of_unknown_reach_starts_where_the_scene_puts_it() {
        for shape in ["point", "sphere", "plane"] {
            assert_eq!(clear_m(shape, 0.05), CLEAR_M, "{shape}");
        }
        for shape in ["surface", "implicit", "mesh"] {
            assert_eq!(clear_m(shape, 0.05), 0.05, "{shape}");
            assert_eq!(clear_m(shape, 0.001), CLEAR_M, "{shape}");
        }
    }
}
