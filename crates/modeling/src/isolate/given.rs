//! The pairs of closed surfaces that isolation is measured on: nets, grids, published lengths.

use super::{Body, IsolateError};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::{FileError, Surface, file};

/// One document a pair, in the order of their numbers.
const DOCUMENTS: [&str; 16] = [
    include_str!("data/01_spheres_shallow.json"),
    include_str!("data/02_ellipsoids_shallow.json"),
    include_str!("data/03_ellipsoids_deep.json"),
    include_str!("data/04_disc_and_needle.json"),
    include_str!("data/05_small_on_large_offset.json"),
    include_str!("data/06_crossed_sausages.json"),
    include_str!("data/07_bent_sausage_over_ellipsoid.json"),
    include_str!("data/08_torus_side_ellipsoid.json"),
    include_str!("data/09_torus_sausage_in_hole.json"),
    include_str!("data/10_linked_tori_overlapping.json"),
    include_str!("data/11_sphere_plugging_torus_hole.json"),
    include_str!("data/12_c_shape_around_bar.json"),
    include_str!("data/13_knobbly_body_ellipsoid.json"),
    include_str!("data/14_peanuts_side_by_side.json"),
    include_str!("data/15_contained.json"),
    include_str!("data/16_identical_ellipsoids.json"),
];

/// A pair with what is known about it.
#[derive(Clone, Debug)]
pub struct GivenPair {
    /// Number and description.
    pub name: String,
    /// The one that moves, m.
    pub moving: Surface,
    /// The one that stays, m.
    pub fixed: Surface,
    /// Cells in u and v of both.
    pub cells: [[usize; 2]; 2],
    /// Length of the shortest translation known for these triangles, m.
    pub least_m: f64,
    /// Everything in the document: `reference` holds the published figures of each method.
    pub document: serde_json::Value,
}

impl GivenPair {
    /// The shortest translation known for these triangles, m.
    pub fn least_translation_m(&self) -> Vector3 {
        Vector3::from_fn(|k, _| {
            self.document["mtd_translation_m"][k]
                .as_f64()
                .unwrap_or(f64::NAN)
        })
    }

    /// Both bodies on the pair's grids.
    pub fn bodies(&self) -> [Body; 2] {
        let [a, b] = self.cells;
        // The documents are part of the program: a test reads all of them.
        let ready = |body: Result<Body, IsolateError>| {
            body.unwrap_or_else(|error| panic!("{}: {error}", self.name))
        };
        [
            ready(Body::new(&self.moving, a, 0)),
            ready(Body::new(&self.fixed, b, 1)),
        ]
    }
}

/// All of them.
pub fn all() -> Vec<GivenPair> {
    DOCUMENTS.iter().map(|text| read(text)).collect()
}

fn read(text: &str) -> GivenPair {
    let document: serde_json::Value = serde_json::from_str(text).unwrap_or_default();
    let name = document["pair"].as_str().unwrap_or_default().to_owned();
    let surface = |key: &str| {
        let read: Result<Surface, FileError> = file::from_value(&document[key]);
        read.unwrap_or_else(|error| panic!("{name}: {key}: {error}"))
    };
    let cells = |k: usize, d: usize| document["cells"][k][d].as_u64().unwrap_or_default() as usize;
    GivenPair {
        moving: surface("moving"),
        fixed: surface("fixed"),
        cells: [[cells(0, 0), cells(0, 1)], [cells(1, 0), cells(1, 1)]],
        least_m: document["mtd_m"].as_f64().unwrap_or(f64::NAN),
        name,
        document,
    }
}
