//! Rules R1 to R4 read off a net: which one an edit broke, and where.
//!
//! The rules are sufficient, not necessary: a net may break one and still be smooth to the eye.
//! They are checked to 1e-9 of the size. R5 is a matter of knots, see [`PatchTable::recovered`].

use super::error::Rule;
use super::patches::{Patch, PatchTable};
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::{SAME_POINT, Surface};
use serde::Serialize;

/// A rule that a net breaks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Broken {
    /// The rule that is broken.
    pub rule: Rule,
    /// Tube, joint or arc, and row of the net (v), or columns (u).
    pub place: String,
    /// By how much at worst, m; 0 where two rows coincide that should not.
    pub off_m: f64,
}

/// The rules that the net of a surface breaks, at the worst place of each joint and arc.
pub(super) fn broken(surface: &Surface, table: &PatchTable) -> Vec<Broken> {
    let net = Net {
        surface,
        table,
        tolerance: SAME_POINT * surface.size(),
    };
    let mut broken = Vec::new();
    for patch in table.distinct().filter(|patch| patch.arc == 1) {
        for joint in JointAngle::ALL {
            net.lines(patch, joint, &mut broken);
            net.plane(patch, joint, &mut broken);
        }
        for arc in [1, 2] {
            let patch = table.patch(patch.part, patch.leaf, arc);
            if net.on_a_fork(patch) {
                match net.is_outline(patch) {
                    true => net.outline(patch, &mut broken),
                    false => net.arch(patch, &mut broken),
                }
            } else if patch.part + 1 < table.parts {
                net.passage(patch, &mut broken);
            }
        }
    }
    broken
}

#[derive(Clone, Copy, Debug)]
enum JointAngle {
    Front,
    Back,
}

impl JointAngle {
    const ALL: [Self; 2] = [Self::Front, Self::Back];

    fn name(self) -> &'static str {
        match self {
            Self::Front => "front joint",
            Self::Back => "back joint",
        }
    }
}

struct Net<'a> {
    surface: &'a Surface,
    table: &'a PatchTable,
    tolerance: f64,
}

impl Net<'_> {
    fn at(&self, column: usize, row: usize) -> Point3 {
        *self.surface.net().at(column, row)
    }

    /// Control points before, on and after a joint.
    fn around(&self, patch: &Patch, joint: JointAngle, row: usize) -> [Point3; 3] {
        let other = self.table.patch(patch.part, patch.leaf, 2);
        let columns = match joint {
            JointAngle::Front => [other.columns[1] - 1, patch.columns[0], patch.columns[0] + 1],
            JointAngle::Back => [patch.columns[1] - 1, patch.columns[1], other.columns[0] + 1],
        };
        columns.map(|column| self.at(column, row))
    }

    fn on_a_fork(&self, patch: &Patch) -> bool {
        patch.part + 1 < self.table.parts
            && self.table.patch(patch.part + 1, patch.leaf, patch.arc).node != patch.node
    }

    /// True for the arc that lies on the tube below: its last row is nearer to that than to another
    /// arch.
    fn is_outline(&self, patch: &Patch) -> bool {
        let other = self.table.patch(patch.part, patch.leaf, 3 - patch.arc);
        self.drop(patch) <= self.drop(other)
    }

    /// Greatest distance of the inverted T from the overlap layer on an arc, m.
    fn drop(&self, patch: &Patch) -> f64 {
        let row = patch.rows[1];
        let columns = patch.columns[0]..=patch.columns[1];
        columns
            .map(|c| (self.at(c, row) - self.at(c, row + 1)).norm())
            .fold(0.0, f64::max)
    }

    /// R1 in rows away from a fork: neighbours on a line with the joint, at one ratio.
    fn lines(&self, patch: &Patch, joint: JointAngle, out: &mut Vec<Broken>) {
        let last = patch.rows[1] - if self.on_a_fork(patch) { 2 } else { 0 };
        let mut worst = (0.0, 0);
        let mut ratio = None;
        for row in (patch.rows[0]..=last).rev() {
            let [before, at, after] = self.around(patch, joint, row);
            let (to, from) = (at - before, after - at);
            // The last row speaks for all.
            let ratio = *ratio.get_or_insert(from.norm() / to.norm().max(f64::MIN_POSITIVE));
            let off = (from - to * ratio).norm();
            if off > worst.0 {
                worst = (off, row);
            }
        }
        self.say(Rule::R1, worst.0, out, || {
            format!("{}, {}, row {}", patch.node, joint.name(), worst.1)
        });
    }

    /// R1 at a fork: neighbours in one plane in inverted T, open book and the q rows above.
    fn plane(&self, patch: &Patch, joint: JointAngle, out: &mut Vec<Broken>) {
        if !self.on_a_fork(patch) {
            return;
        }
        let [before, at, after] = self.around(patch, joint, patch.rows[1]);
        let Some(normal) = (before - at).cross(&(after - at)).try_normalize(0.0) else {
            return;
        };
        let mut worst = (0.0, 0);
        for row in patch.rows[1] - 1 - self.surface.knots_v().degree()..=patch.rows[1] {
            for point in self.around(patch, joint, row) {
                let off = normal.dot(&(point - at)).abs();
                if off > worst.0 {
                    worst = (off, row);
                }
            }
        }
        self.say(Rule::R1, worst.0, out, || {
            format!("{}, {}, row {}", patch.node, joint.name(), worst.1)
        });
    }

    /// Columns of an arc between its joints.
    fn inner(&self, patch: &Patch) -> std::ops::Range<usize> {
        patch.columns[0] + 1..patch.columns[1]
    }

    /// R2: from inverted T to open book every column of the arch moves alike, along one direction
    /// on both branches.
    fn arch(&self, patch: &Patch, out: &mut Vec<Broken>) {
        let t = patch.rows[1];
        let place = || format!("{}, arch, row {}", patch.node, t - 1);
        // The middle of the arch speaks for it.
        let middle = self.rise(patch);
        if middle.norm() <= self.tolerance {
            out.push(Broken {
                rule: Rule::R2,
                place: place(),
                off_m: 0.0,
            });
            return;
        }
        let off = self
            .inner(patch)
            .map(|column| (self.up(column, t) - middle).norm())
            .fold(0.0, f64::max);
        self.say(Rule::R2, off, out, place);
        if let Some(other) = self.across(patch) {
            let along = self
                .rise(other)
                .try_normalize(0.0)
                .unwrap_or_else(Vector3::zeros);
            self.say(Rule::R2, middle.cross(&along).norm(), out, || {
                format!(
                    "{} and {}, arch, row {}: two directions",
                    patch.node,
                    other.node,
                    t - 1
                )
            });
        }
        self.fold(patch, out);
    }

    /// The arc on the other side of an arch, for the left one.
    fn across(&self, patch: &Patch) -> Option<&Patch> {
        let below = |patch: &Patch| {
            self.table
                .patch(patch.part + 1, patch.leaf, patch.arc)
                .node
                .as_str()
        };
        self.table.distinct().find(|other| {
            (other.part, other.arc) == (patch.part, 3 - patch.arc)
                && other.leaf > patch.leaf
                && self.on_a_fork(other)
                && below(other) == below(patch)
                && !self.is_outline(other)
        })
    }

    /// From inverted T to open book, m.
    fn up(&self, column: usize, t: usize) -> Vector3 {
        self.at(column, t - 1) - self.at(column, t)
    }

    /// The rise from inverted T to open book in the middle of an arc.
    fn rise(&self, patch: &Patch) -> Vector3 {
        self.up((patch.columns[0] + patch.columns[1]) / 2, patch.rows[1])
    }

    /// R3: open book, inverted T = overlap, and the second layer on straight lines at one ratio.
    fn outline(&self, patch: &Patch, out: &mut Vec<Broken>) {
        let t = patch.rows[1];
        let off = self
            .inner(patch)
            .map(|c| (self.at(c, t) - self.at(c, t + 1)).norm())
            .fold(0.0, f64::max);
        self.say(Rule::R3, off, out, || {
            format!("{}, outline, rows {t} and {}", patch.node, t + 1)
        });
        let pair = |column: usize| (self.up(column, t), self.layer(column, t));
        let (up, down) = pair((patch.columns[0] + patch.columns[1]) / 2);
        if up.norm() <= self.tolerance {
            out.push(Broken {
                rule: Rule::R3,
                place: format!("{}, outline, row {}", patch.node, t - 1),
                off_m: 0.0,
            });
            return;
        }
        let ratio = up.norm() / down.norm().max(f64::MIN_POSITIVE);
        let off = self
            .inner(patch)
            .map(pair)
            .map(|(up, down)| (up - down * ratio).norm())
            .fold(0.0, f64::max);
        self.say(Rule::R3, off, out, || {
            format!("{}, outline, rows {} to {}", patch.node, t - 1, t + 2)
        });
        self.fold(patch, out);
    }

    /// A tube that passes a level goes on straight.
    fn passage(&self, patch: &Patch, out: &mut Vec<Broken>) {
        let t = patch.rows[1];
        let pair = |column: usize| (self.up(column, t), self.layer(column, t));
        let (up, down) = pair(patch.columns[0]);
        let ratio = up.norm() / down.norm().max(f64::MIN_POSITIVE);
        let columns = patch.columns[0]..=patch.columns[1];
        let off = columns
            .map(pair)
            .map(|(up, down)| (up - down * ratio).norm())
            .fold(0.0, f64::max);
        self.say(Rule::R3, off, out, || {
            format!("{}, passage, rows {} to {}", patch.node, t - 1, t + 2)
        });
    }

    /// From the second layer to the overlap layer.
    fn layer(&self, column: usize, t: usize) -> Vector3 {
        self.at(column, t + 1) - self.at(column, t + 2)
    }

    /// R4: the corner of the open book does not reach beyond the neighbours of the joint.
    fn fold(&self, patch: &Patch, out: &mut Vec<Broken>) {
        let t = patch.rows[1];
        let [first, last] = patch.columns;
        for (joint, beside) in [(first, first + 1), (last, last - 1)] {
            let along = self.at(beside, t) - self.at(joint, t);
            let reach = along.norm();
            let corner = (self.at(joint, t - 1) - self.at(joint, t)).dot(&along)
                / reach.max(f64::MIN_POSITIVE);
            self.say(Rule::R4, corner - reach, out, || {
                format!("{}, columns {joint} and {beside}", patch.node)
            });
        }
    }

    fn say(&self, rule: Rule, off_m: f64, out: &mut Vec<Broken>, place: impl Fn() -> String) {
        if off_m > self.tolerance {
            out.push(Broken {
                rule,
                place: place(),
                off_m,
            });
        }
    }
}
