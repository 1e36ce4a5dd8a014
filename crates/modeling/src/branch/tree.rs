//! What a tree is asked to be: the parameters of its stem, its forks and its branches.
//!
//! Lengths are in metres, fractions are of a section's width. A fork lies in the frame of the
//! section below it: x from left to right, y from front to back, z along the branch. Left and right
//! are described as mirror images of each other: `outer_m` and `inner_m` count x away from the
//! middle.

use serde::{Deserialize, Serialize};

/// A whole tree: one surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tree {
    /// Degree round a section, p ≥ 2.
    #[serde(default = "three")]
    pub degree_u: usize,
    /// Degree along a branch, q ≥ 2.
    #[serde(default = "two")]
    pub degree_v: usize,
    /// What everything grows from.
    pub stem: Stem,
}

fn three() -> usize {
    3
}

fn two() -> usize {
    2
}

/// The stem: a straight tube downwards from z = 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stem {
    /// a: half of its size in x, m.
    pub half_width_m: f64,
    /// w: half of its size in y, m.
    pub half_depth_m: f64,
    /// e: from the joints to the control points beside them, m.
    pub neighbour_m: f64,
    /// h1: between the straight rows next to the fork, m.
    pub layer_m: f64,
    /// Rows below those.
    pub free_rows: usize,
    /// Between those rows, m.
    pub free_step_m: f64,
    /// How much wider each of them is than the one above, fraction of the stem's width.
    #[serde(default)]
    pub free_widening: f64,
    /// Where it divides; a tree without forks is a plain tube.
    #[serde(default)]
    pub fork: Option<Box<Fork>>,
}

/// A bifurcation at the top of a stem or branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fork {
    /// h: height of the arch between the branches, m.
    pub arch_m: f64,
    /// ez: from the joints to the control points beside them on the arch, m.
    pub neighbour_m: f64,
    /// rho: the open book lies this many layers above the fork.
    pub raise: f64,
    /// The branch towards −x.
    pub left: Branch,
    /// The branch towards +x.
    pub right: Branch,
}

/// One branch of a fork, from the fork up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Branch {
    /// delta: how far the open book is moved away from the middle, m.
    pub shift_m: f64,
    /// Outer corner of the first tilted row: away from the middle, and up, m.
    pub outer_m: [f64; 2],
    /// Its corner at the arch.
    pub inner_m: [f64; 2],
    /// Between tilted rows, m.
    pub tilt_step_m: f64,
    /// (q) from the middle of each tilted row to its joints, towards the arch; fractions of the
    /// width, from the fork up.
    pub front: Vec<f64>,
    /// Like `front`, where the free rows begin; it fades to 0 at the end.
    pub free_front: f64,
    /// From the joints to the control points beside them, fraction of the width, in every row from
    /// the first tilted one.
    pub neighbour: f64,
    /// Rows from the last tilted one (not counted) to the end (counted).
    pub free_rows: usize,
    /// Between them, m.
    pub free_step_m: f64,
    /// How far the free rows turn outwards, evenly, degrees.
    #[serde(default)]
    pub turn_deg: f64,
    /// How far they twist about the branch, right-handed, slowly at both ends, degrees.
    #[serde(default)]
    pub twist_deg: f64,
    /// The section at its end.
    pub end: End,
    /// h1 of its own fork, and the step of rows that only pass a level, m; a free step by default.
    #[serde(default)]
    pub layer_m: Option<f64>,
    /// Where it divides again.
    #[serde(default)]
    pub fork: Option<Box<Fork>>,
}

impl Branch {
    /// Between its straight rows, m.
    pub fn layer_m(&self) -> f64 {
        self.layer_m.unwrap_or(self.free_step_m)
    }
}

/// The section at the end of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct End {
    /// Half of its size from left to right, m.
    pub half_width_m: f64,
    /// Half of its size from front to back, m.
    pub half_depth_m: f64,
    /// A loop of its own instead of a rectangle: 4p + 4 control points (x, y) from the front joint
    /// round by the left, in units of width and depth (a rectangle fills −½ … ½). The control
    /// points beside a joint lie opposite each other.
    #[serde(default)]
    pub outline: Option<Vec<[f64; 2]>>,
}

impl Tree {
    /// Number of leaves.
    pub fn leaves(&self) -> usize {
        self.stem.fork.as_deref().map_or(1, Fork::leaves)
    }

    /// Forks on the longest way from the stem to a leaf.
    pub fn depth(&self) -> usize {
        self.stem.fork.as_deref().map_or(0, Fork::depth)
    }
}

impl Fork {
    /// Its branches, left to right.
    pub fn branches(&self) -> [(Hand, &Branch); 2] {
        [(Hand::Left, &self.left), (Hand::Right, &self.right)]
    }

    fn leaves(&self) -> usize {
        self.branches()
            .iter()
            .map(|(_, branch)| branch.fork.as_deref().map_or(1, Fork::leaves))
            .sum()
    }

    fn depth(&self) -> usize {
        1 + self
            .branches()
            .iter()
            .map(|(_, branch)| branch.fork.as_deref().map_or(0, Fork::depth))
            .max()
            .unwrap_or(0)
    }
}

/// Which branch of a fork.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    /// Towards −x.
    Left,
    /// Towards +x.
    Right,
}

impl Hand {
    /// Sign of its x.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }

    /// Letter of a node's name.
    pub fn letter(self) -> char {
        match self {
            Self::Left => 'L',
            Self::Right => 'R',
        }
    }
}
