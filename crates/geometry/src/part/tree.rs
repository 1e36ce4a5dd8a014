//! Boxes in a tree: which items may be near a point.

use crate::math::{Point3, Vector3};

/// Corners of a box, m.
pub(super) type Corners = (Point3, Point3);

/// A binary tree over boxes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    corners: Corners,
    /// An item, or the indices of two nodes.
    holds: Holds,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Holds {
    Item(u32),
    Nodes(u32, u32),
}

impl Tree {
    /// Over items by their boxes.
    pub fn new(boxes: &[Corners]) -> Self {
        Self::over(boxes, (0..boxes.len() as u32).collect())
    }

    /// Over some items of those that have boxes.
    pub fn over(boxes: &[Corners], mut items: Vec<u32>) -> Self {
        let mut tree = Self::default();
        if !items.is_empty() {
            tree.build(boxes, &mut items);
        }
        tree
    }

    /// The boxes it was made of, by item; those of all items are in it.
    pub fn boxes(&self) -> Vec<Corners> {
        let mut all: Vec<(u32, Corners)> = self
            .nodes
            .iter()
            .filter_map(|node| match node.holds {
                Holds::Item(item) => Some((item, node.corners)),
                Holds::Nodes(..) => None,
            })
            .collect();
        all.sort_unstable_by_key(|&(item, _)| item);
        all.into_iter().map(|(_, corners)| corners).collect()
    }

    fn build(&mut self, boxes: &[Corners], items: &mut [u32]) -> u32 {
        let corners = items
            .iter()
            .map(|&k| boxes[k as usize])
            .reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1)))
            .unwrap_or((Point3::origin(), Point3::origin()));
        if let [item] = *items {
            self.nodes.push(Node {
                corners,
                holds: Holds::Item(item),
            });
            return self.nodes.len() as u32 - 1;
        }
        let axis = (corners.1 - corners.0).imax();
        let centre = |k: u32| {
            let (low, high) = boxes[k as usize];
            low[axis] + high[axis]
        };
        items.sort_unstable_by(|&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
        let (low, high) = items.split_at_mut(items.len() / 2);
        let low = self.build(boxes, low);
        let high = self.build(boxes, high);
        self.nodes.push(Node {
            corners,
            holds: Holds::Nodes(low, high),
        });
        self.nodes.len() as u32 - 1
    }

    /// A box around everything.
    pub fn bounds(&self) -> Option<Corners> {
        self.nodes.last().map(|node| node.corners)
    }

    /// Looks at items, near ones first, whose boxes are nearer than the ceiling (m²) that `look` lowers.
    pub fn nearest(&self, q: &Point3, ceiling: &mut f64, look: impl FnMut(u32, &mut f64)) {
        self.least(|corners| squared(corners, q), ceiling, look);
    }

    /// Looks at items, low ones first, that may be lower than the ceiling (m): `down` is a unit vector, heights are measured
    /// against it.
    pub fn lowest(&self, down: &Vector3, ceiling: &mut f64, look: impl FnMut(u32, &mut f64)) {
        let height = |(low, high): &Corners| -> f64 {
            let parts = (0..3).map(|k| (down[k] * low[k]).max(down[k] * high[k]));
            -parts.sum::<f64>()
        };
        self.least(height, ceiling, look);
    }

    /// Looks at items whose boxes, and those around them, pass.
    pub fn passing(&self, passes: impl Fn(&Corners) -> bool, mut look: impl FnMut(u32)) {
        let of = |corners: &Corners| if passes(corners) { 0.0 } else { 1.0 };
        self.least(of, &mut 1.0, |item, _| look(item));
    }

    /// Looks at items, least ones first, whose boxes have less than the ceiling.
    fn least(
        &self,
        of: impl Fn(&Corners) -> f64,
        ceiling: &mut f64,
        mut look: impl FnMut(u32, &mut f64),
    ) {
        let Some(last) = self.nodes.len().checked_sub(1) else {
            return;
        };
        let far = |k: u32| of(&self.nodes[k as usize].corners);
        // Deep enough for 2³² items; the far one of two waits.
        let mut waiting = [(0u32, 0.0f64); 64];
        let mut count = 1;
        waiting[0] = (last as u32, far(last as u32));
        while count > 0 {
            count -= 1;
            let (node, distance) = waiting[count];
            if distance >= *ceiling {
                continue;
            }
            match self.nodes[node as usize].holds {
                Holds::Item(item) => look(item, ceiling),
                Holds::Nodes(a, b) => {
                    let (a, b) = ((a, far(a)), (b, far(b)));
                    let (near, other) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                    waiting[count] = other;
                    waiting[count + 1] = near;
                    count += 2;
                }
            }
        }
    }
}

/// Squared distance from a point to a box, m².
pub(super) fn squared((low, high): &Corners, q: &Point3) -> f64 {
    (0..3)
        .map(|k| (low[k] - q[k]).max(q[k] - high[k]).max(0.0))
        .map(|d| d * d)
        .sum()
}
