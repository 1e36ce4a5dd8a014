//! What is asked and what is answered.

use palpate_geometry::math::Vector3;

/// Which way to isolate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum IsolateMethod {
    /// 1: along the farthest pair of points of the bodies.
    Farthest,
    /// 2: by the components of the farthest pair in the main region, signs from the extents.
    FarthestOfRegion,
    /// 3: along the normal of the main region.
    Normal,
    /// 4: along the weighted normals of all regions.
    Normals,
    /// 5: along the line of the centres of mass.
    Centroids,
    /// 6: halfway between 4 and 5.
    Blend,
    /// 7: the best of five blends of 4 and 5.
    BestBlend,
    /// A descent from the exit along 6, or from an earlier answer: a local minimum of the length.
    Local,
    /// Exits along 14 directions and those of the methods, descents from two.
    Global,
    /// Exits along 42 directions and those of the methods, descents from three.
    Thorough,
}

impl IsolateMethod {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Farthest,
        Self::FarthestOfRegion,
        Self::Normal,
        Self::Normals,
        Self::Centroids,
        Self::Blend,
        Self::BestBlend,
        Self::Local,
        Self::Global,
        Self::Thorough,
    ];

    /// `1` to `7`, `local`, `global`, `thorough`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Farthest => "1",
            Self::FarthestOfRegion => "2",
            Self::Normal => "3",
            Self::Normals => "4",
            Self::Centroids => "5",
            Self::Blend => "6",
            Self::BestBlend => "7",
            Self::Local => "local",
            Self::Global => "global",
            Self::Thorough => "thorough",
        }
    }

    /// The method of a name.
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name)
    }
}

/// How fine the triangles are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Resolution {
    /// Three cells to a knot span, 24 to 96 in a direction.
    #[default]
    Usual,
    /// So many cells in u and v of every body.
    Cells([usize; 2]),
    /// As usual, then twice as many in each direction until the length of the translation changes
    /// by less than the gap.
    Halving,
}

/// What to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsolateSpec {
    /// The way.
    pub method: IsolateMethod,
    /// Gap to leave, m; the answer's is this to 1.3 times this. `None`: a thousandth of the
    /// diagonal of the box round both.
    pub gap_m: Option<f64>,
    /// The most that the vector between the centres of mass may turn, degrees.
    pub max_turn_deg: Option<f64>,
    /// How fine.
    pub resolution: Resolution,
    /// The gap is that of the surfaces themselves; otherwise that of the triangles.
    pub exact: bool,
    /// Where the method has no answer, ask `Global`.
    pub fall_back: bool,
    /// An earlier answer, m: `Local` starts from it.
    pub warm_m: Option<Vector3>,
}

impl Default for IsolateSpec {
    fn default() -> Self {
        Self {
            method: IsolateMethod::Global,
            gap_m: None,
            max_turn_deg: None,
            resolution: Resolution::Usual,
            exact: true,
            fall_back: true,
            warm_m: None,
        }
    }
}

/// Why a method has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Reason {
    /// One body holds the other.
    #[error(
        "the surfaces do not cross: one body is inside the other, and this method needs an intersection region"
    )]
    NoRegion,
    /// Coplanar triangles.
    #[error("the surfaces coincide in parts, so their intersection lines are undefined")]
    Coincident,
    /// A region without a normal.
    #[error("the line of intersection encloses no area: it has no normal")]
    NoNormal,
    /// Centres of mass at one place.
    #[error("the centres of mass coincide: there is no direction from one to the other")]
    CoincidentCentroids,
    /// The search had nowhere to start.
    #[error("no starting direction separates the bodies within the allowed turn")]
    NoStart,
    /// Too many steps.
    #[error("still overlapping after {steps} steps")]
    StepLimit {
        /// Steps taken.
        steps: u32,
    },
    /// The answer turns too far.
    #[error("the translation found turns the bodies about each other by more than the limit")]
    Turned,
    /// A gap that is not to be had within the allowed turn.
    #[error("free of overlap, but there is no room for the gap")]
    NoGap,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IsolateStatus {
    /// The bodies were apart by at least the gap: nothing to do.
    Apart,
    /// Now they are.
    Isolated,
    /// They are not.
    Failed(Reason),
}

/// The answer for one pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Isolated {
    /// How it ended.
    pub status: IsolateStatus,
    /// What to move the moving body by, m; zero when there is nothing to do, and when it failed.
    pub translation_m: Vector3,
    /// The translation at which the triangles first were free, before the gap, m.
    pub contact_m: Vector3,
    /// The gap after the translation, m; `None` when it failed.
    pub gap_m: Option<f64>,
    /// The gap is that of the surfaces, not of their triangles.
    pub exact: bool,
    /// Angle between the vectors of centres of mass before and after, degrees; `None` where one of
    /// them is zero.
    pub turn_deg: Option<f64>,
    /// The method that gave the answer.
    pub method: IsolateMethod,
    /// Why it is not the one asked for.
    pub fell_back: Option<Reason>,
    /// Steps of methods 1 to 7.
    pub steps: u32,
    /// Regions of intersection at first; 0 also where the surfaces coincide.
    pub regions: usize,
    /// Overlap tests on the triangles.
    pub overlap_tests: u32,
    /// Cells in u and v of the moving and of the fixed body.
    pub cells: [[usize; 2]; 2],
    /// With [`Resolution::Halving`]: by how much the last halving changed the length, m.
    pub change_m: Option<f64>,
}

impl Isolated {
    /// Whether the moving body went to the other side: a turn of more than 90 degrees.
    pub fn crossed(&self) -> bool {
        self.turn_deg.is_some_and(|turn| turn > 90.0)
    }

    /// Whether the bodies are apart after the translation.
    pub fn is_apart(&self) -> bool {
        !matches!(self.status, IsolateStatus::Failed(_))
    }
}

/// Why the question was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum IsolateError {
    /// An open surface.
    #[error(
        "surface {body} is open: it bounds no solid. Close it (edges that meet, or poles) before isolating it"
    )]
    Open {
        /// Its number, from 0.
        body: usize,
    },
    /// A surface that encloses nothing.
    #[error("surface {body} encloses no volume: it is flat, or turned inside out in parts")]
    NoVolume {
        /// Its number, from 0.
        body: usize,
    },
    /// A surface that crosses itself.
    #[error("surface {body} crosses itself near ({}, {}, {}) m: what is inside is not defined. Repair it first", at[0], at[1], at[2])]
    SelfIntersecting {
        /// Its number, from 0.
        body: usize,
        /// A place on the crossing, m.
        at: [f64; 3],
    },
    /// Coordinates that cannot be computed with.
    #[error("surface {body} has a control point beyond 1e60 m, or one that is not finite")]
    TooLarge {
        /// Its number, from 0.
        body: usize,
    },
    /// A grid that is too coarse or too fine.
    #[error("a grid of {} x {} cells: there must be at least 3 each way, and at most 2^20 corners", cells[0], cells[1])]
    Resolution {
        /// Cells in u and v.
        cells: [usize; 2],
    },
    /// A gap that is none.
    #[error(
        "a gap of {gap_m:e} m cannot be left between these bodies: give {least_m:e} m, below which rounding moves them, to \
         {most_m:e} m, the diagonal of the box round both"
    )]
    Gap {
        /// The gap, m.
        gap_m: f64,
        /// The least, m: 1e-9 of the diagonal of the box round the bodies; more if they are far from the origin.
        least_m: f64,
        /// That diagonal, m.
        most_m: f64,
    },
    /// An angle that is none.
    #[error("a turn of at most {0} degrees: it must be from 0 to 180")]
    MaxTurn(f64),
    /// A start that is not finite.
    #[error("the earlier answer to start from is not finite")]
    Warm,
    /// Too few bodies.
    #[error("{0} body: isolation needs at least two")]
    TooFew(usize),
}
