//! Patches as they are laid, and where they end: what all of a merge stands on.

use super::axis::try_normalised;
use super::layout::{Layout, Rims};
use super::rim::{Misfit, Rim, facing};
use super::sheet::Sheet;
use super::{DegreeRule, Edge, HideBy, MergeError, MergeSpec, overlap};
use palpate_geometry::math::first_outside;
use palpate_geometry::surface::{Direction, Surface, Trim};

/// Rows and columns of points that a patch may be given.
const POINTS: [usize; 2] = [5, 1001];

/// Patches that are laid, and where they end.
pub(super) struct Ground {
    /// As the layout places them, whole.
    sheets: Vec<Sheet>,
    pub layout: Layout,
    /// Merged, in u and v.
    pub degrees: [usize; 2],
    /// Of two places: the curves on which the patch ends, if it does.
    pub rims: [Option<Rim>; 2],
}

impl Ground {
    pub(super) fn new(surfaces: &[Surface], spec: &MergeSpec) -> Result<Self, MergeError> {
        check_spec(spec)?;
        check_nets(surfaces)?;
        check_knots(surfaces)?;
        check_trims(surfaces.len(), spec)?;
        let rims: Vec<Option<Rims>> = (spec.trims.iter())
            .map(|trim| trim.as_ref().map(Rims::new))
            .collect();
        let layout = Layout::new(surfaces, spec.arrangement, &rims)?;
        let sheets = Sheet::laid(surfaces, &layout);
        let degrees = degrees(&sheets, &layout, spec)?;
        let mut ground = Self {
            sheets,
            layout,
            degrees,
            rims: [None, None],
        };
        if surfaces.len() == 2 {
            for place in [0, 1] {
                ground.rims[place] = ground.trimmed(place, &rims, surfaces)?;
            }
            if rims.iter().all(Option::is_none) && spec.find_overlap && spec.hidden.is_empty() {
                ground.rims = ground.crossed();
            }
        }
        Ok(ground)
    }

    /// The direction in which two patches follow each other: 0 for u, 1 for v.
    pub(super) fn across(&self) -> usize {
        usize::from(self.layout.rows != 2)
    }

    /// The edge of a turned patch at the seam with the other.
    fn seam_edge(&self, place: usize) -> Edge {
        [[Edge::U1, Edge::V1], [Edge::U0, Edge::V0]][place][self.across()]
    }

    /// What the trim of a patch leaves at the seam.
    fn trimmed(
        &self,
        place: usize,
        rims: &[Option<Rims>],
        surfaces: &[Surface],
    ) -> Result<Option<Rim>, MergeError> {
        let placed = self.layout.places[place];
        let Some(rims) = rims.get(placed.patch).and_then(Option::as_ref) else {
            return Ok(None);
        };
        let edge = self.seam_edge(place);
        let rim = rims.at(placed.turn.source(edge)).clone();
        let rim = rim.map_err(|misfit| misfit.of(placed.patch, &surfaces[placed.patch]))?;
        let turns = placed.turn.reverses_along(edge);
        Ok(rim.map(|rim| if turns { rim.reversed() } else { rim }))
    }

    /// What the curves in which two patches cross leave of each.
    fn crossed(&self) -> [Option<Rim>; 2] {
        let direction = [Direction::U, Direction::V][self.across()];
        let [first, second] = [0, 1].map(|k| &self.sheets[k].surface);
        let Some(curves) = overlap::crossing(first, second, direction) else {
            return [None, None];
        };
        [0, 1].map(|place| {
            let mut rim = Rim::of_curves(&curves[place], self.seam_edge(place));
            if let Err(misfit) = &mut rim.graph {
                misfit.at = self.layout.places[place].turn.back(misfit.at);
            }
            Some(rim)
        })
    }

    /// Whether a place of a turned patch, in fractions of its domain, shows.
    pub(super) fn shows(&self, place: usize, at: [f64; 2]) -> bool {
        let rim = self.rims[place].as_ref();
        rim.is_none_or(|rim| rim.shows(facing(self.seam_edge(place), at)))
    }

    /// The patches with the curves on which their lines end, if they do.
    ///
    /// # Errors
    /// By lines: a curve that is no graph over the seam.
    pub(super) fn sheets(
        &self,
        surfaces: &[Surface],
        by: HideBy,
    ) -> Result<Vec<Sheet>, MergeError> {
        let mut sheets = self.sheets.clone();
        if by == HideBy::Lines {
            for (place, rim) in self.rims.iter().enumerate() {
                let Some(rim) = rim else { continue };
                let patch = self.layout.places[place].patch;
                let graph = rim.graph.clone();
                let graph = graph.map_err(|misfit| misfit.of(patch, &surfaces[patch]))?;
                sheets[place].end = Some((self.seam_edge(place), graph));
            }
        }
        Ok(sheets)
    }
}

impl Rims {
    fn new(trim: &Trim) -> Self {
        Self(Edge::ALL.map(|edge| Rim::of_loops(trim.loops(), edge)))
    }
}

impl Misfit {
    /// As an error of the patch, in its parameters.
    fn of(self, patch: usize, surface: &Surface) -> MergeError {
        let at = |direction, share: f64| {
            let knots = surface.knots(direction);
            knots.domain().0 + knots.length() * share
        };
        MergeError::NoGraph {
            patch,
            what: self.what,
            u: at(Direction::U, self.at[0]),
            v: at(Direction::V, self.at[1]),
        }
    }
}

/// Trims are of two patches, and all that is hidden.
fn check_trims(given: usize, spec: &MergeSpec) -> Result<(), MergeError> {
    let any = spec.trims.iter().any(Option::is_some);
    let reasons = [
        (given != 2, "only two patches can be trimmed"),
        (
            spec.trims.len() > given,
            "there are more trims than patches",
        ),
        (
            !spec.hidden.is_empty(),
            "hidden ranges cannot be given as well; hide all of it by the trims",
        ),
    ];
    match reasons.into_iter().find(|(wrong, _)| any && *wrong) {
        Some((_, reason)) => Err(MergeError::Trims { given, reason }),
        None => Ok(()),
    }
}

pub(super) fn check_spec(spec: &MergeSpec) -> Result<(), MergeError> {
    let [least, most] = POINTS;
    if !(least..=most).contains(&spec.points) {
        return Err(MergeError::Points {
            given: spec.points,
            least,
            most,
        });
    }
    if !(spec.least_span > 0.0 && spec.least_span < 0.5) {
        let wanted = "it is a share of a patch above 0 and below 0.5";
        return Err(MergeError::Value {
            name: "least_span",
            value: spec.least_span,
            wanted,
        });
    }
    if let Some(value) = spec.tolerance_m.filter(|t| !(*t > 0.0 && t.is_finite())) {
        return Err(MergeError::Value {
            name: "tolerance_m",
            value,
            wanted: "it is a length above 0",
        });
    }
    Ok(())
}

/// Nets are finite and nothing is weighted.
pub(super) fn check_nets(surfaces: &[Surface]) -> Result<(), MergeError> {
    for (patch, surface) in surfaces.iter().enumerate() {
        if surface
            .weights()
            .is_some_and(|w| w.iter().any(|x| *x != w[0]))
        {
            return Err(MergeError::Rational { patch });
        }
        // Nets move after they were checked.
        if let Some((index, _)) = first_outside(surface.net().points()) {
            return Err(MergeError::NotFinite { patch, index });
        }
    }
    Ok(())
}

/// Knots can be scaled to [0, 1] without losing a span.
pub(super) fn check_knots(surfaces: &[Surface]) -> Result<(), MergeError> {
    for (patch, surface) in surfaces.iter().enumerate() {
        let clamped = surface.clamped();
        for (direction, name) in [(Direction::U, 'u'), (Direction::V, 'v')] {
            if let Err(source) = try_normalised(clamped.knots(direction)) {
                return Err(MergeError::Spans {
                    patch,
                    direction: name,
                    source,
                });
            }
        }
    }
    Ok(())
}

/// Merged degrees in u and v.
pub(super) fn degrees(
    sheets: &[Sheet],
    layout: &Layout,
    spec: &MergeSpec,
) -> Result<[usize; 2], MergeError> {
    let of = |direction| {
        let degrees = sheets.iter();
        degrees.map(move |s| s.surface.knots(direction).degree())
    };
    let chosen = |direction| match spec.degree {
        DegreeRule::Raise => of(direction).max(),
        DegreeRule::Lower => of(direction).min(),
    };
    let [u, v] =
        [Direction::U, Direction::V].map(|d| chosen(d).expect("there are two patches or more"));
    for (blocks, degree, direction) in [(layout.rows, u, 'u'), (layout.columns, v, 'v')] {
        if blocks > 1 && spec.continuity >= degree {
            return Err(MergeError::Continuity {
                continuity: spec.continuity,
                degree,
                direction,
            });
        }
    }
    Ok([u, v])
}
