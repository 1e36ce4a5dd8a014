//! Contact rows: constraints between two parties, with the weights that carry their force to
//! control points.
//!
//! The first party is a body, pushed against the normal; the second, the holder, is a tool or
//! another body (or the same one, touching itself), pushed along it. Normals come from the surfaces
//! as they stand (at rest that is exact), gaps from where their free motion will take both.

use super::friction::FrictionLaw;
use super::row_key::RowId;
use palpate_geometry::basis::BasisWindow;
use palpate_geometry::contact::{ContactSamples, Facing, Weights};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;

/// Most tools of a scene.
pub const MAX_TOOLS: usize = 64;
/// Rows of a tick for each tool and each body that deforms.
const ROWS_PER_PARTY: usize = 24;
/// Parties for which there are rows at least and at most: buffers grow with the square of the rows.
const PARTIES: [usize; 2] = [8, 64];
/// Most rows of one pair.
pub const MAX_ROWS_PER_PAIR: usize = 96;
/// Most samples of one pair: the rest is for feet.
pub const MAX_SAMPLES_PER_PAIR: usize = MAX_ROWS_PER_PAIR - 16;

/// Who is pushed along a row's normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holder {
    /// A tool, by index.
    Tool(u32),
    /// A body, by index.
    Body(u32),
}

/// One unilateral constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Its pair and which of the pair's rows it is: from tick to tick the same.
    pub id: RowId,
    /// Body index.
    pub body: u32,
    /// The other party.
    pub holder: Holder,
    /// Unit vector from the body to the holder.
    pub normal: Vector3,
    /// Gap under free motion of both, m.
    pub gap_m: f64,
    /// Gap before it, m.
    pub now_m: f64,
    /// Added to its own compliance, relative to it: how much others carry in its stead.
    pub regularization: f64,
    /// Most that it counts as deep where rows share a force that balance does not, m: what it is deeper than the
    /// rows beside it, which stand for the rest.
    pub counts_m: f64,
    /// How far free motion of both takes the holder past the body, m; a grip: from one point to the
    /// other.
    pub slip: Vector3,
    /// Of free motion with the contact forces of the last tick, what these make, m; gap and slip are without.
    pub forced: Vector3,
    /// What the row does.
    pub law: FrictionLaw,
    /// Point on the body's surface now, m.
    pub point: Point3,
    /// Its parameters.
    pub u: f64,
    /// Its parameters.
    pub v: f64,
    /// From a tool's reference point to where the tool touches, m; zero on balls, which may turn as
    /// they like.
    pub arm: Vector3,
    /// The same in the tool's frame, m.
    pub on_tool: Vector3,
    /// Weights on the body in [`RowSet::weights_in`]; empty when it is rigid.
    pub on_body: Range,
    /// Weights on the holder; empty when it is a tool or rigid.
    pub on_holder: Range,
}

/// A range of the weights of a [`RowSet`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Range {
    start: u32,
    end: u32,
}

impl Row {
    /// The tool, when one holds it.
    pub fn tool(&self) -> Option<usize> {
        match self.holder {
            Holder::Tool(tool) => Some(tool as usize),
            Holder::Body(_) => None,
        }
    }

    /// Takes what forces move of the holder past the body from the row's free motion, m.
    pub fn take_back(&mut self, moved: &Vector3) {
        self.forced += moved;
        self.slip -= moved;
        self.gap_m -= moved.dot(&self.normal);
    }

    /// Its sides on a body: the sign with which the normal pushes that body, and the weights.
    pub fn sides_on(&self, body: usize) -> impl Iterator<Item = (f64, Range)> + use<> {
        let first = (self.body as usize == body).then_some((-1.0, self.on_body));
        let second = (self.holder == Holder::Body(body as u32)).then_some((1.0, self.on_holder));
        first.into_iter().chain(second)
    }
}

/// A party at the place of a row.
#[derive(Clone, Copy, Debug)]
pub enum Grip<'a> {
    /// It does not move.
    Fixed,
    /// It is going to move by this, m.
    Carried(Vector3),
    /// A deforming surface, seen through the windows of a parameter.
    Deforming(&'a DeformingView<'a>, &'a BasisWindow, &'a BasisWindow),
}

/// A deforming surface as rows see it.
#[derive(Clone, Copy, Debug)]
pub struct DeformingView<'a> {
    /// The surface now.
    pub surface: &'a Surface,
    /// Its net after free motion.
    pub predicted: &'a [Point3],
    /// Its samples.
    pub samples: &'a ContactSamples,
}

/// The rows of a tick and their basis weights.
#[derive(Debug)]
pub struct RowSet {
    /// Rows, ordered by pair and key.
    pub rows: Vec<Row>,
    controls: Vec<u32>,
    weights: Vec<f64>,
    scratch: Weights,
    /// Where the rows of the present pair begin.
    pair_start: usize,
    /// Most rows.
    most: usize,
}

/// Most rows of one tick over all pairs of a scene, whose tools and bodies that give way, deforming or
/// free, are `parties` together.
pub fn most_rows(parties: usize) -> usize {
    let [least, most] = PARTIES;
    ROWS_PER_PARTY * parties.clamp(least, most)
}

impl RowSet {
    /// Room for `most` rows on surfaces whose points have at most `width` weights.
    pub fn new(most: usize, width: usize) -> Self {
        // Two sides a row.
        let room = 2 * most * width;
        Self {
            rows: Vec::with_capacity(most),
            controls: Vec::with_capacity(room),
            weights: Vec::with_capacity(room),
            scratch: Weights {
                controls: Vec::with_capacity(width),
                weights: Vec::with_capacity(width),
            },
            pair_start: 0,
            most,
        }
    }

    /// No rows.
    pub fn clear(&mut self) {
        self.rows.clear();
        self.controls.clear();
        self.weights.clear();
        self.pair_start = 0;
    }

    /// The rows that follow belong to the next pair.
    pub fn begin_pair(&mut self) {
        self.pair_start = self.rows.len();
    }

    /// Brings the rows of the present pair into their order.
    pub fn end_pair(&mut self) {
        let rows = &mut self.rows[self.pair_start..];
        rows.sort_unstable_by_key(|row| row.id.key);
        debug_assert!(
            rows.is_sorted_by(|a, b| a.id < b.id),
            "two rows of a pair have one key"
        );
    }

    /// Rows of the present pair so far, in the order in which they came.
    pub fn of_pair(&self) -> &[Row] {
        &self.rows[self.pair_start..]
    }

    /// The rows of the present pair, to be changed.
    pub fn of_pair_mut(&mut self) -> &mut [Row] {
        &mut self.rows[self.pair_start..]
    }

    /// Takes the rows of the present pair away.
    pub fn drop_pair(&mut self) {
        self.rows.truncate(self.pair_start);
        let ends = |row: &Row| row.on_body.end.max(row.on_holder.end) as usize;
        let used = self.rows.iter().map(ends).fold(0, usize::max);
        self.controls.truncate(used);
        self.weights.truncate(used);
    }

    /// True when the present pair may not have more rows.
    fn full(&self) -> bool {
        self.rows.len() == self.most || self.rows.len() - self.pair_start == MAX_ROWS_PER_PAIR
    }

    /// Adds a row whose gap is `row.gap_m` now, if it closes to less than `margin_m` or has; the
    /// gap then becomes that after free motion. `row.slip` is what the holder has slipped before
    /// the motions given here.
    pub fn push(&mut self, row: Row, body: Grip<'_>, holder: Grip<'_>, margin_m: f64) {
        debug_assert!(row.now_m == row.gap_m || row.now_m.is_nan(), "the gap now");
        debug_assert!(margin_m > 0.0, "a row must come near");
        if self.full() {
            return;
        }
        let (controls, weights) = (self.controls.len(), self.weights.len());
        let (away, on_body) = self.grip(body);
        let (towards, on_holder) = self.grip(holder);
        let gap_m = row.gap_m + (towards - away).dot(&row.normal);
        if gap_m < margin_m || row.gap_m < margin_m {
            let slip = row.slip + (towards - away);
            self.rows.push(Row {
                now_m: row.gap_m,
                gap_m,
                slip,
                on_body,
                on_holder,
                ..row
            });
        } else {
            self.controls.truncate(controls);
            self.weights.truncate(weights);
        }
    }

    /// Free motion of a party, and its weights.
    fn grip(&mut self, party: Grip<'_>) -> (Vector3, Range) {
        match party {
            Grip::Fixed => (Vector3::zeros(), Range::default()),
            Grip::Carried(motion) => (motion, Range::default()),
            Grip::Deforming(view, wu, wv) => {
                self.scratch.set(view.surface, wu, wv);
                let now = self.scratch.point(view.surface.net().points());
                let then = self.scratch.point(view.predicted);
                let start = self.controls.len() as u32;
                self.controls.extend_from_slice(&self.scratch.controls);
                self.weights.extend_from_slice(&self.scratch.weights);
                (
                    then - now,
                    Range {
                        start,
                        end: self.controls.len() as u32,
                    },
                )
            }
        }
    }

    /// Free motion of a body changed, at its control points by this, m.
    pub fn shift(&mut self, body: usize, change: &[Vector3]) {
        let Self {
            rows,
            controls,
            weights,
            ..
        } = self;
        for row in rows {
            for (sign, range) in row.sides_on(body) {
                let range = range.start as usize..range.end as usize;
                let mut moved = Vector3::zeros();
                for (&control, &weight) in controls[range.clone()].iter().zip(&weights[range]) {
                    moved += change[control as usize] * weight;
                }
                // The holder's motion counts as it is, the body's turned round.
                row.gap_m += sign * moved.dot(&row.normal);
                row.slip += moved * sign;
            }
        }
    }

    /// A point of a deforming surface after free motion, m.
    pub fn predicted_point(&mut self, view: &DeformingView<'_>, u: f64, v: f64) -> Point3 {
        let (wu, wv) = (
            view.surface.knots_u().window(u),
            view.surface.knots_v().window(v),
        );
        self.scratch.set(view.surface, &wu, &wv);
        self.scratch.point(view.predicted)
    }

    /// How far free motion takes a point of a deforming surface, m.
    pub fn free_motion(
        &mut self,
        view: &DeformingView<'_>,
        wu: &BasisWindow,
        wv: &BasisWindow,
    ) -> Vector3 {
        self.scratch.set(view.surface, wu, wv);
        let now = self.scratch.point(view.surface.net().points());
        self.scratch.point(view.predicted) - now
    }

    /// Control indices and weights of a side.
    pub fn weights_in(&self, range: Range) -> (&[u32], &[f64]) {
        debug_assert!(range.start <= range.end, "a range turned round");
        let range = range.start as usize..range.end as usize;
        (&self.controls[range.clone()], &self.weights[range])
    }
}

/// Which samples of a surface come to touch another party in a tick.
pub struct Approach<F> {
    /// Gap at which a sample counts as in touch, m.
    pub margin_m: f64,
    /// How much nearer any may come within the tick, m.
    pub closing_m: f64,
    /// How much nearer one does, in the windows of its parameters and along the normal that it sees, m.
    pub closes: F,
}

/// A surface sample in touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleInTouch {
    /// Index in its grid.
    pub index: usize,
    /// On the surface now, m.
    pub point: Point3,
    /// What it sees; the normal is from its surface to the other party.
    pub facing: Facing,
}

impl DeformingView<'_> {
    /// Samples that are in touch with another party, or will be under free motion. Where there are more than
    /// [`MAX_SAMPLES_PER_PAIR`], it is every second in u and v, or every third, and so on; returns
    /// which. A grid that was `thinned` in the last tick stays so until it has room to spare. `meets`
    /// says whether a box is worth a look, `look` what a point of the surface sees of the other
    /// party.
    pub fn samples_in_touch(
        &self,
        mut approach: Approach<impl FnMut(&BasisWindow, &BasisWindow, &Vector3) -> f64>,
        thinned: usize,
        meets: impl Fn(&Point3, &Point3) -> bool,
        mut look: impl FnMut(&Point3) -> Option<Facing>,
        out: &mut Vec<SampleInTouch>,
    ) -> usize {
        let mut every = thinned.max(1);
        // Every third sample is not among every second: each grid is collected from the start.
        while !self.collect(&mut approach, every, &meets, &mut look, out) {
            every += 1;
        }
        // Half full at the next finer grid is room to spare.
        let finer = every - 1;
        if every > 1 && out.len() * every * every < MAX_SAMPLES_PER_PAIR / 2 * finer * finer {
            match self.collect(&mut approach, finer, &meets, &mut look, out) {
                true => return finer,
                false => self.collect(&mut approach, every, &meets, &mut look, out),
            };
        }
        every
    }

    /// Those of every `every`-th sample; false where there are too many.
    fn collect(
        &self,
        approach: &mut Approach<impl FnMut(&BasisWindow, &BasisWindow, &Vector3) -> f64>,
        every: usize,
        meets: impl Fn(&Point3, &Point3) -> bool,
        mut look: impl FnMut(&Point3) -> Option<Facing>,
        out: &mut Vec<SampleInTouch>,
    ) -> bool {
        out.clear();
        let taken = |index: usize| {
            every == 1 || (self.samples.place(index).iter()).all(|at| at.is_multiple_of(every))
        };
        let net = self.surface.net().points();
        let (patches_u, patches_v) = self.samples.patches();
        for patch in 0..patches_u * patches_v {
            let (patch_u, patch_v) = (patch / patches_v, patch % patches_v);
            if self.samples.is_duplicate(patch_u, patch_v) {
                continue;
            }
            let (low, high) = self.samples.patch_box(net, patch_u, patch_v);
            if !meets(&low, &high) {
                continue;
            }
            for index in self.samples.samples_of(patch_u, patch_v) {
                if !taken(index) {
                    continue;
                }
                let (wu, wv) = self.samples.windows(index);
                let point = self.surface.point_in(wu, wv);
                let Some(facing) = look(&point) else { continue };
                let away_m = facing.gap_m - approach.margin_m;
                let touches = away_m < 0.0
                    || (away_m < approach.closing_m
                        && away_m < (approach.closes)(wu, wv, &facing.normal));
                if touches && faces(self.surface, wu, wv, &facing.normal) {
                    if out.len() == MAX_SAMPLES_PER_PAIR {
                        return false;
                    }
                    out.push(SampleInTouch {
                        index,
                        point,
                        facing,
                    });
                }
            }
        }
        true
    }
}

/// The surface there looks towards the other party; the far side of a thin body inside a large tool
/// does not.
fn faces(surface: &Surface, wu: &BasisWindow, wv: &BasisWindow, normal: &Vector3) -> bool {
    let frame = surface.frame_in(wu, wv);
    let outward = frame.du.cross(&frame.dv);
    let toward = outward.dot(normal) * if surface.flip_normal() { -1.0 } else { 1.0 };
    toward > 0.0
}
