//! Seven cases to compare methods by.
//!
//! The source describes its patches and does not publish them: these are made to its descriptions,
//! about 100 mm wide.

use super::{Arrangement, Edge, MergeSpec};
use palpate_geometry::surface::{Surface, file};

/// Patches and how they are arranged.
#[derive(Clone, Debug)]
pub struct MergeCase {
    /// 1 … 7.
    pub number: usize,
    /// What makes it hard.
    pub title: &'static str,
    /// The patches.
    pub patches: Vec<Surface>,
    /// Rows, columns and edges; all else as usual.
    pub spec: MergeSpec,
}

/// Title, files and arrangement.
type Entry = (&'static str, &'static [&'static str], Arrangement);

const ENTRIES: [Entry; 7] = [
    (
        "similar curvature and knots",
        &[
            include_str!("data/case1_a.json"),
            include_str!("data/case1_b.json"),
        ],
        Arrangement::Closest,
    ),
    (
        "different curvature",
        &[
            include_str!("data/case2_a.json"),
            include_str!("data/case2_b.json"),
        ],
        Arrangement::Closest,
    ),
    (
        "different knots",
        &[
            include_str!("data/case3_a.json"),
            include_str!("data/case3_b.json"),
        ],
        Arrangement::Closest,
    ),
    (
        "different knots and width",
        &[
            include_str!("data/case4_a.json"),
            include_str!("data/case4_b.json"),
        ],
        Arrangement::Closest,
    ),
    (
        "intersecting, trimmed",
        &[
            include_str!("data/case5_a.json"),
            include_str!("data/case5_b.json"),
        ],
        Arrangement::Edges([Edge::U1, Edge::U0]),
    ),
    (
        "degrees 3×3 and 4×5",
        &[
            include_str!("data/case6_a.json"),
            include_str!("data/case6_b.json"),
        ],
        Arrangement::Closest,
    ),
    (
        "four patches",
        &[
            include_str!("data/case7_a.json"),
            include_str!("data/case7_b.json"),
            include_str!("data/case7_c.json"),
            include_str!("data/case7_d.json"),
        ],
        Arrangement::Grid {
            rows: 2,
            columns: 2,
        },
    ),
];

/// All seven.
///
/// # Panics
/// When the files that come with the program are damaged: a test reads them.
pub fn cases() -> Vec<MergeCase> {
    let case = |(k, (title, files, arrangement)): (usize, Entry)| MergeCase {
        number: k + 1,
        title,
        patches: files
            .iter()
            .map(|text| file::read(text).expect("a surface that comes with the program"))
            .collect(),
        spec: MergeSpec {
            arrangement,
            ..MergeSpec::default()
        },
    };
    ENTRIES.into_iter().enumerate().map(case).collect()
}
