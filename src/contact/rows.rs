//! Contact rows: unilateral constraints between a tool and points of a surface, with the weights that carry their force.
//!
//! Normals come from the surface as it stands (at rest that is exact), gaps from where its free motion will take it.

use super::samples::{SampleGrid, Weights, distance_squared_to_box};
use crate::math::{Point3, Vector3};
use crate::surface::Surface;

/// Most rows of one tick over all tools and bodies.
pub const MAX_ROWS: usize = 192;
/// Most tools of a scene: per-tick records have a fixed size.
pub const MAX_TOOLS: usize = 8;
/// Most rows of one tool on one body.
pub const MAX_ROWS_PER_PAIR: usize = 96;
/// `sample` of the row at the tool's own closest point.
pub const FOOT: u32 = u32::MAX;

/// One unilateral constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Tool index.
    pub tool: u32,
    /// Body index.
    pub body: u32,
    /// Sample of the body's grid, or [`FOOT`].
    pub sample: u32,
    /// Unit vector from the body to the tool.
    pub normal: Vector3,
    /// Gap under free motion of both, m.
    pub gap_m: f64,
    /// Surface point now, m.
    pub point: Point3,
    /// Surface parameters of a foot; a sample's are the grid's.
    pub u: f64,
    /// Surface parameters of a foot; a sample's are the grid's.
    pub v: f64,
    /// Range in [`RowSet::controls`] and [`RowSet::weights`]; empty on a rigid body.
    pub start: u32,
    /// End of that range.
    pub end: u32,
}

impl Row {
    /// An empty foot row of a pair.
    pub fn new(tool: usize, body: usize) -> Self {
        let (tool, body) = (tool as u32, body as u32);
        let (normal, point) = (Vector3::zeros(), Point3::origin());
        Self { tool, body, sample: FOOT, normal, gap_m: 0.0, point, u: 0.0, v: 0.0, start: 0, end: 0 }
    }

    /// What identifies the row from tick to tick; rows are ordered by it.
    pub fn key(&self) -> [u32; 3] {
        [self.tool, self.body, self.sample]
    }
}

/// The rows of a tick and their basis weights.
#[derive(Debug)]
pub struct RowSet {
    /// Rows, ordered by tool, body, sample.
    pub rows: Vec<Row>,
    /// Control indices of all rows.
    pub controls: Vec<u32>,
    /// Weights of all rows.
    pub weights: Vec<f64>,
    /// One sample's weights, while gathering.
    weight_scratch: Weights,
    /// By tool: where free motion of the coupling takes the proxy, m.
    pub free: [Point3; MAX_TOOLS],
    /// By tool: the proxy held back by the surfaces as they stand, m.
    pub proxies: [Point3; MAX_TOOLS],
    /// By tool: share of its contact forces that the limiter let through.
    pub factors: [f64; MAX_TOOLS],
}

impl RowSet {
    /// Room for [`MAX_ROWS`] rows on surfaces whose samples have at most `width` weights.
    pub fn new(width: usize) -> Self {
        Self {
            rows: Vec::with_capacity(MAX_ROWS),
            controls: Vec::with_capacity(MAX_ROWS * width),
            weights: Vec::with_capacity(MAX_ROWS * width),
            weight_scratch: Weights { controls: Vec::with_capacity(width), weights: Vec::with_capacity(width) },
            free: [Point3::origin(); MAX_TOOLS],
            proxies: [Point3::origin(); MAX_TOOLS],
            factors: [0.0; MAX_TOOLS],
        }
    }

    /// No rows.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.controls.clear();
        self.weights.clear();
    }

    /// Adds a row on a body that does not give way.
    pub fn push_rigid(&mut self, row: Row) {
        if self.rows.len() < MAX_ROWS {
            let end = self.controls.len() as u32;
            self.rows.push(Row { start: end, end, ..row });
        }
    }

    /// Adds a row whose force goes to control points by the weights last set in the scratch.
    fn push_weighted(&mut self, row: Row) {
        if self.rows.len() < MAX_ROWS {
            let start = self.controls.len() as u32;
            self.controls.extend_from_slice(&self.weight_scratch.controls);
            self.weights.extend_from_slice(&self.weight_scratch.weights);
            self.rows.push(Row { start, end: self.controls.len() as u32, ..row });
        }
    }

    /// Control indices and weights of a row.
    pub fn weights_of(&self, row: &Row) -> (&[u32], &[f64]) {
        let range = row.start as usize..row.end as usize;
        (&self.controls[range.clone()], &self.weights[range])
    }
}

/// A deforming surface as a tool sees it.
#[derive(Clone, Copy, Debug)]
pub struct DeformingView<'a> {
    /// Body index.
    pub body: u32,
    /// The surface now.
    pub surface: &'a Surface,
    /// Its net after free motion.
    pub predicted: &'a [Point3],
    /// Its samples.
    pub samples: &'a SampleGrid,
}

impl DeformingView<'_> {
    /// The row at a parameter, `target` being the ball's centre in free motion.
    pub fn foot_row(
        &self,
        set: &mut RowSet,
        tool: u32,
        (u, v): (f64, f64),
        normal: Vector3,
        target: &Point3,
        radius_m: f64,
        margin_m: f64,
    ) {
        let (wu, wv) = (self.surface.knots_u().window(u), self.surface.knots_v().window(v));
        set.weight_scratch.set(self.surface, &wu, &wv);
        let point = set.weight_scratch.point(self.surface.net().points());
        let free = set.weight_scratch.point(self.predicted);
        let gap_m = (target - free).dot(&normal) - radius_m;
        let gap_now = (target - point).dot(&normal) - radius_m;
        if gap_m < margin_m || gap_now < margin_m {
            let row = Row { normal, gap_m, point, u, v, ..Row::new(tool as usize, self.body as usize) };
            set.push_weighted(row);
        }
    }

    /// Rows at the samples inside a ball with its centre at `centre` now and `target` in free motion.
    pub fn ball_rows(
        &self,
        set: &mut RowSet,
        tool: u32,
        centre: &Point3,
        target: &Point3,
        radius_m: f64,
        margin_m: f64,
    ) {
        let reach = radius_m + margin_m;
        let net = self.surface.net().points();
        let before = set.rows.len();
        let (patches_u, patches_v) = self.samples.patches();
        for patch_u in 0..patches_u {
            for patch_v in 0..patches_v {
                let (low, high) = self.samples.patch_box(net, patch_u, patch_v);
                if distance_squared_to_box(centre, &low, &high) > reach * reach {
                    continue;
                }
                for sample in self.samples.samples_of(patch_u, patch_v) {
                    let (wu, wv) = self.samples.windows(sample);
                    set.weight_scratch.set(self.surface, wu, wv);
                    let point = set.weight_scratch.point(net);
                    let away = centre - point;
                    let distance = away.norm();
                    if distance > reach || distance == 0.0 {
                        continue;
                    }
                    let normal = away / distance;
                    let free = set.weight_scratch.point(self.predicted);
                    let gap_m = (target - free).dot(&normal) - radius_m;
                    let gap_now = distance - radius_m;
                    if (gap_m < margin_m || gap_now < margin_m) && self.faces(wu, wv, &normal) {
                        let row = Row {
                            sample: sample as u32,
                            normal,
                            gap_m,
                            point,
                            ..Row::new(tool as usize, self.body as usize)
                        };
                        if set.rows.len() - before < MAX_ROWS_PER_PAIR {
                            set.push_weighted(row);
                        }
                    }
                }
            }
        }
    }

    /// Rows at the samples below a plane through `target` with outward unit normal `plane`.
    pub fn plane_rows(&self, set: &mut RowSet, tool: u32, target: &Point3, plane: &Vector3, margin_m: f64) {
        let net = self.surface.net().points();
        let before = set.rows.len();
        let (patches_u, patches_v) = self.samples.patches();
        for patch_u in 0..patches_u {
            for patch_v in 0..patches_v {
                let (low, high) = self.samples.patch_box(net, patch_u, patch_v);
                let centre = nalgebra::center(&low, &high);
                let half = (high - low) * 0.5;
                let reach = half.x * plane.x.abs() + half.y * plane.y.abs() + half.z * plane.z.abs();
                if (centre - target).dot(plane) - reach > margin_m {
                    continue;
                }
                for sample in self.samples.samples_of(patch_u, patch_v) {
                    let (wu, wv) = self.samples.windows(sample);
                    set.weight_scratch.set(self.surface, wu, wv);
                    let point = set.weight_scratch.point(net);
                    let gap_m = (set.weight_scratch.point(self.predicted) - target).dot(plane);
                    let gap_now = (point - target).dot(plane);
                    if (gap_m < margin_m || gap_now < margin_m)
                        && self.faces(wu, wv, &-plane)
                        && set.rows.len() - before < MAX_ROWS_PER_PAIR
                    {
                        let normal = -*plane;
                        let row = Row {
                            sample: sample as u32,
                            normal,
                            gap_m,
                            point,
                            ..Row::new(tool as usize, self.body as usize)
                        };
                        set.push_weighted(row);
                    }
                }
            }
        }
    }

    /// The surface there looks towards the tool; the far side of a thin body inside a large tool does not.
    fn faces(&self, wu: &crate::basis::BasisWindow, wv: &crate::basis::BasisWindow, normal: &Vector3) -> bool {
        let frame = self.surface.frame_in(wu, wv);
        let outward = frame.du.cross(&frame.dv);
        let toward = outward.dot(normal) * if self.surface.flip_normal() { -1.0 } else { 1.0 };
        toward > 0.0
    }
}
