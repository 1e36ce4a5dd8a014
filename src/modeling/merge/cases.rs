//! Seven cases to compare methods by.
//!
//! The source describes its patches and does not publish them: these are made to its descriptions, about 100 mm wide.

use super::{Arrangement, Edge, MergeSpec};
use crate::surface::{Surface, file};

/// Patches and how they are arranged.
#[derive(Clone, Debug)]
pub struct Case {
    /// 1 … 7.
    pub number: usize,
    /// What makes it hard.
    pub title: &'static str,
    /// The patches.
    pub patches: Vec<Surface>,
    /// Rows, columns and edges; all else as usual.
    pub spec: MergeSpec,
}

/// Number, title, file and arrangement.
type Entry = (&'static str, &'static str, Arrangement);

const ENTRIES: [Entry; 7] = [
    ("similar curvature and knots", include_str!("data/case1.json"), Arrangement::Closest),
    ("different curvature", include_str!("data/case2.json"), Arrangement::Closest),
    ("different knots", include_str!("data/case3.json"), Arrangement::Closest),
    ("different knots and width", include_str!("data/case4.json"), Arrangement::Closest),
    ("intersecting, trimmed", include_str!("data/case5.json"), Arrangement::Edges([Edge::U1, Edge::U0])),
    ("degrees 3×3 and 4×5", include_str!("data/case6.json"), Arrangement::Closest),
    ("four patches", include_str!("data/case7.json"), Arrangement::Grid { rows: 2, columns: 2 }),
];

/// All seven.
///
/// # Panics
/// When the files that come with the program are damaged: a test reads them.
pub fn cases() -> Vec<Case> {
    let read = |text: &str| -> Vec<Surface> {
        let list: Vec<serde_json::Value> = serde_json::from_str(text).expect("a list of surfaces");
        list.iter().map(|value| file::from_value(value).expect("a surface")).collect()
    };
    let case = |(k, (title, text, arrangement)): (usize, Entry)| Case {
        number: k + 1,
        title,
        patches: read(text),
        spec: MergeSpec { arrangement, ..MergeSpec::default() },
    };
    ENTRIES.into_iter().enumerate().map(case).collect()
}
