//! Names of the models in scene files.

use serde::{Deserialize, Serialize};

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum ModelSpec {
    /// It does not deform.
    Rigid,
    /// A skin: springs between control points, bending along their rows.
    Membrane,
    /// A solid of springs between nodes; the control points are nodes.
    Lattice,
    /// An elastic solid (stable neo-Hookean) in the cells between the nodes: E and ν mean what they
    /// say.
    Continuum,
    /// A continuum on a finer grid of cells, moved by the control points and a few shells inside them.
    Net,
}

impl ModelSpec {
    /// Name of the model, as scenes write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid",
            Self::Membrane => "membrane",
            Self::Lattice => "lattice",
            Self::Continuum => "continuum",
            Self::Net => "net",
        }
    }
}
