//! Balls within balls, around things of which neighbours in the list are near each other.

use crate::math::{Point3, Vector3};

/// Balls in the next larger one.
const ARITY: usize = 8;

/// A ball: centre and radius, m.
pub(super) type Ball = (Point3, f64);

/// A tree of balls.
#[derive(Clone, Debug)]
pub(super) struct BallTree {
    /// The balls that it was made of, and those around [`ARITY`] of the level before; one at last.
    levels: Vec<Vec<Ball>>,
}

/// A ball of a tree: its level and its number there. Those at level 0 are what the tree was made of.
pub(super) type Node = (usize, usize);

impl BallTree {
    /// The tree of a list of balls; an empty list gives a tree without a root.
    pub fn new(balls: impl Iterator<Item = Ball>) -> Self {
        let mut levels = vec![balls.collect::<Vec<_>>()];
        let mut each = 1;
        // Around what the tree is made of: a ball around balls would be larger at each level.
        while levels.last().is_some_and(|last| last.len() > 1) {
            each *= ARITY;
            levels.push(levels[0].chunks(each).map(around).collect());
        }
        Self { levels }
    }

    /// The ball around all.
    pub fn root(&self) -> Option<Node> {
        let top = self.levels.len() - 1;
        (!self.levels[top].is_empty()).then_some((top, 0))
    }

    /// How many balls there are, of all levels.
    pub fn len(&self) -> usize {
        self.levels.iter().map(Vec::len).sum()
    }

    pub fn ball(&self, (level, k): Node) -> Ball {
        self.levels[level][k]
    }

    /// The balls in one that is not at level 0.
    pub fn within(&self, (level, k): Node) -> impl DoubleEndedIterator<Item = Node> + use<> {
        let last = self.levels[level - 1].len().min((k + 1) * ARITY);
        (k * ARITY..last).map(move |child| (level - 1, child))
    }

    /// Asks for balls from the root on, and for those within the ones that are taken.
    pub fn descend(&self, take: &mut impl FnMut(Node) -> bool) {
        fn ask(tree: &BallTree, node: Node, take: &mut impl FnMut(Node) -> bool) {
            if take(node) && node.0 > 0 {
                tree.within(node).for_each(|child| ask(tree, child, take));
            }
        }
        if let Some(root) = self.root() {
            ask(self, root, take);
        }
    }

    /// What of level 0 is in a ball.
    pub fn leaves(&self, (level, k): Node) -> std::ops::Range<usize> {
        let each = ARITY.pow(level as u32);
        k * each..self.levels[0].len().min((k + 1) * each)
    }
}

/// A ball around balls.
pub(super) fn around(balls: &[Ball]) -> Ball {
    let ends = balls.iter().map(|&(p, r)| (p, Vector3::repeat(r)));
    let (low, high) = ends.fold((balls[0].0, balls[0].0), |(low, high), (p, r)| {
        (low.inf(&(p - r)), high.sup(&(p + r)))
    });
    let centre = nalgebra::center(&low, &high);
    let away = balls.iter().map(|(p, r)| (p - centre).norm() + r);
    (centre, away.fold(0.0, f64::max))
}
