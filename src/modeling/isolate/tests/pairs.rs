//! The sixteen pairs with their published figures.

use crate::modeling::isolate::Body;
use crate::math::Vector3;
use crate::surface::{Surface, file};
use serde_json::Value;

/// A pair of the table.
pub struct GivenPair {
    pub name: String,
    pub moving: Surface,
    pub fixed: Surface,
    pub cells: [[usize; 2]; 2],
    pub document: Value,
}

impl GivenPair {
    pub fn bodies(&self) -> [Body; 2] {
        [Body::new(&self.moving, self.cells[0], 0).unwrap(), Body::new(&self.fixed, self.cells[1], 1).unwrap()]
    }

    pub fn number(&self, key: &str) -> f64 {
        self.document[key].as_f64().unwrap_or_else(|| panic!("{}: no {key}", self.name))
    }

    pub fn mtd_translation(&self) -> Vector3 {
        Vector3::from_fn(|k, _| self.document["mtd_translation_m"][k].as_f64().unwrap())
    }
}

/// All of them.
pub fn given() -> Vec<GivenPair> {
    super::super::given::ALL
        .iter()
        .map(|text| {
            let document: Value = serde_json::from_str(text).unwrap();
            let cells = |k: usize| [0, 1].map(|d| document["cells"][k][d].as_u64().unwrap() as usize);
            GivenPair {
                name: document["pair"].as_str().unwrap().to_owned(),
                moving: file::from_value(&document["moving"]).unwrap(),
                fixed: file::from_value(&document["fixed"]).unwrap(),
                cells: [cells(0), cells(1)],
                document,
            }
        })
        .collect()
}
