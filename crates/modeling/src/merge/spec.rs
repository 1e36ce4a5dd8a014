//! What is asked of a merge.

use palpate_geometry::surface::{Direction, Trim};

/// How the merged net is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MergeMethod {
    /// The source's: uniform parameters, knots put end to end, a plain least-squares fit.
    Seed,
    /// Chord-length parameters, outer edges held, knots placed where they miss least; as many
    /// control points as the seed's.
    #[default]
    Constrained,
    /// No fit: elevation and knot insertion; only control points near the seam move, for C¹ and
    /// higher.
    Exact,
}

/// The common degree of patches whose degrees differ, a direction at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DegreeRule {
    /// The highest.
    #[default]
    Raise,
    /// The lowest.
    Lower,
}

/// A side of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// u at the start of its domain.
    U0,
    /// u at its end.
    U1,
    /// v at the start of its domain.
    V0,
    /// v at its end.
    V1,
}

impl Edge {
    /// All four.
    pub const ALL: [Self; 4] = [Self::U0, Self::U1, Self::V0, Self::V1];

    /// The direction whose parameter is constant on the edge.
    pub fn direction(self) -> Direction {
        match self {
            Self::U0 | Self::U1 => Direction::U,
            Self::V0 | Self::V1 => Direction::V,
        }
    }

    /// At the end of its direction's domain, not at the start.
    pub fn at_end(self) -> bool {
        matches!(self, Self::U1 | Self::V1)
    }
}

/// Which patches meet, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrangement {
    /// Two patches, at their closest pair of edges.
    #[default]
    Closest,
    /// Two patches, at the named edge of each.
    Edges([Edge; 2]),
    /// Patches row after row: those of a row follow each other in v, rows in u. Patches are turned
    /// to fit.
    Grid {
        /// Rows, u.
        rows: usize,
        /// Columns, v.
        columns: usize,
    },
}

/// A part of a patch that does not show: its rows of points are dropped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hidden {
    /// Which patch, from 0.
    pub patch: usize,
    /// Direction of the range: the one in which the patches follow each other.
    pub direction: Direction,
    /// Parameters of the patch as given; one of the two ends of its domain is among them.
    pub range: [f64; 2],
}

/// What becomes of a patch that ends on a curve, and not on a row of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HideBy {
    /// The source's: each row of points with one that is hidden is dropped, and what shows of it is bridged.
    Rows,
    /// Each line across the seam ends on the curve; the curve must be a graph over the seam.
    Lines,
}

impl HideBy {
    /// Both, with their names.
    pub const ALL: [(&'static str, Self); 2] = [("rows", Self::Rows), ("lines", Self::Lines)];

    /// The one of a name.
    pub fn of(name: &str) -> Option<Self> {
        let named = Self::ALL.into_iter().find(|(known, _)| *known == name);
        named.map(|(_, by)| by)
    }

    /// As requests and reports call it.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }
}

/// What is asked of a merge.
#[derive(Clone, Debug, PartialEq)]
pub struct MergeSpec {
    /// c of the C^c at the seams; below the merged degree.
    pub continuity: usize,
    /// Method to use.
    pub method: MergeMethod,
    /// Degree, where those of the patches differ.
    pub degree: DegreeRule,
    /// Which edges meet.
    pub arrangement: Arrangement,
    /// Parts to leave out, of two patches.
    pub hidden: Vec<Hidden>,
    /// What is kept of each patch, of two; patches that are not listed are whole.
    pub trims: Vec<Option<Trim>>,
    /// Look for the curves in which two patches cross, and hide what lies beyond them; not if something is hidden already.
    pub find_overlap: bool,
    /// Where patches end on curves, of trims or of crossings. Without it both ways are tried, and the one with the smaller
    /// standard deviation over all points that show is taken.
    pub hide_by: Option<HideBy>,
    /// Rows and columns of points on each patch.
    pub points: usize,
    /// Least distance of a knot from its neighbours, as a share of the patch: how sharp a blend may
    /// become at the seam.
    pub least_span: f64,
    /// With [`MergeMethod::Constrained`]: insert knots until no point is farther off than this, m.
    pub tolerance_m: Option<f64>,
}

impl Default for MergeSpec {
    fn default() -> Self {
        Self {
            continuity: 2,
            method: MergeMethod::Constrained,
            degree: DegreeRule::Raise,
            arrangement: Arrangement::Closest,
            hidden: Vec::new(),
            trims: Vec::new(),
            hide_by: None,
            find_overlap: true,
            points: 101,
            least_span: 0.02,
            tolerance_m: None,
        }
    }
}
