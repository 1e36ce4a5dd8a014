//! From patches and request to a plan.

use super::axis::{Axis, try_normalised};
use super::fit::Ends;
use super::knots::{Knots, interiors};
use super::layout::Layout;
use super::plan::{BlockRows, Line, MergePlan};
use super::search::{Choice, choose, parameters};
use super::{DegreeRule, Hidden, MergeError, MergeMethod, MergeSpec, Merged, Turn, overlap};
use palpate_geometry::math::first_outside;
use palpate_geometry::surface::{Direction, Surface};

/// Rows and columns of points that a patch may be given.
const POINTS: [usize; 2] = [5, 1001];
/// Rows of points by which knots are chosen.
const SEARCH_ROWS: usize = 34;

/// A merge that is ready to be done.
pub(super) struct Job {
    /// As the layout places them.
    pub turned: Vec<Surface>,
    pub layout: Layout,
    /// The patches along u and along v.
    pub axes: [Axis; 2],
    pub choices: [Choice; 2],
    /// (blocks) for u and v: where the patches are sampled.
    pub fractions: [Vec<Vec<f64>>; 2],
    pub ends: Ends,
}

impl Job {
    pub(super) fn new(surfaces: &[Surface], spec: &MergeSpec) -> Result<Self, MergeError> {
        check_spec(spec)?;
        check_nets(surfaces)?;
        check_knots(surfaces)?;
        let layout = Layout::new(surfaces, spec.arrangement)?;
        let turned: Vec<Surface> = layout
            .places
            .iter()
            .map(|p| p.turn.of(&surfaces[p.patch]))
            .collect();
        let degrees = degrees(&turned, &layout, spec)?;
        let fractions = fractions(surfaces, &turned, &layout, spec)?;
        let direction = [Direction::U, Direction::V];
        let axis = |d: usize, rows: &[Vec<f64>]| {
            Axis::new(&turned, &layout, direction[d], degrees[d], rows)
        };
        let axes = [0, 1].map(|d| axis(d, &fractions[d]));
        let choices = match spec.method {
            MergeMethod::Seed => axes
                .each_ref()
                .map(|axis| as_the_source(axis, spec.continuity)),
            _ => [0, 1].map(|d| {
                let thin: Vec<Vec<f64>> = fractions[d].iter().map(|f| thinned(f)).collect();
                choose(&axis(d, &thin), &axes[d], spec.continuity, spec.least_span)
            }),
        };
        let ends = if spec.method == MergeMethod::Seed {
            Ends::Free
        } else {
            Ends::Held
        };
        let job = Self {
            turned,
            layout,
            axes,
            choices,
            fractions,
            ends,
        };
        job.check_rows()?;
        Ok(job)
    }

    pub(super) fn plan(&self) -> Result<MergePlan, MergeError> {
        Ok(MergePlan::new(
            &self.turned,
            self.layout.clone(),
            [self.line(0)?, self.line(1)?],
            self.ends,
        ))
    }

    pub(super) fn merged(&self) -> Result<Merged, MergeError> {
        let plan = self.plan()?;
        Ok(Merged {
            surface: plan.combined(&self.turned)?,
            layout: self.layout.clone(),
            rows: [Direction::U, Direction::V].map(|d| plan.rows(d).to_vec()),
            seams: plan.seams(),
            plan: Some(plan),
            within_tolerance: None,
        })
    }

    fn line(&self, d: usize) -> Result<Line, MergeError> {
        let choice = &self.choices[d];
        let all = match self.ends {
            // The source's step 6: evenly from 0 to 1 over all rows, whatever patch they come from.
            Ends::Free => evenly(self.fractions[d].iter().map(Vec::len).sum()),
            Ends::Held => {
                let blocks = self.fractions[d].iter().zip(&choice.at);
                blocks
                    .flat_map(|(fractions, at)| parameters(fractions, *at))
                    .collect()
            }
        };
        let mut rest = all.as_slice();
        let rows = self.fractions[d].iter().map(|fractions| {
            let (own, others) = rest.split_at(fractions.len());
            rest = others;
            BlockRows {
                fractions: fractions.clone(),
                parameters: own.to_vec(),
            }
        });
        Ok(Line {
            knots: choice.knots.vector()?,
            seams: choice.knots.seams.clone(),
            rows: rows.collect(),
        })
    }

    /// Enough rows for the control points of every patch.
    fn check_rows(&self) -> Result<(), MergeError> {
        for (d, axis) in self.axes.iter().enumerate() {
            let inner = interiors(axis);
            for (block, fractions) in self.fractions[d].iter().enumerate() {
                let needed = inner[block].len() + axis.degree + 1;
                if fractions.len() < needed {
                    let place = if d == 0 {
                        block * self.layout.columns
                    } else {
                        block
                    };
                    let patch = self.layout.places[place].patch;
                    return Err(MergeError::TooFewRows {
                        patch,
                        rows: fractions.len(),
                        needed,
                    });
                }
            }
        }
        Ok(())
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
    turned: &[Surface],
    layout: &Layout,
    spec: &MergeSpec,
) -> Result<[usize; 2], MergeError> {
    let of = |direction| turned.iter().map(move |s| s.knots(direction).degree());
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

/// Where the blocks are sampled: evenly, less what is hidden.
fn fractions(
    surfaces: &[Surface],
    turned: &[Surface],
    layout: &Layout,
    spec: &MergeSpec,
) -> Result<[Vec<Vec<f64>>; 2], MergeError> {
    let even = evenly(spec.points);
    let mut all = [vec![even.clone(); layout.rows], vec![even; layout.columns]];
    if turned.len() > 2 {
        if let Some(hidden) = spec.hidden.first() {
            return Err(refused(hidden, "only two patches can have hidden parts"));
        }
        return Ok(all);
    }
    let d = if layout.rows == 2 { 0 } else { 1 };
    let mut shown = [[0.0_f64, 1.0_f64]; 2];
    for hidden in &spec.hidden {
        let (place, [start, end]) = hidden_part(hidden, surfaces, layout, d)?;
        let [first, last] = &mut shown[place];
        if start <= 0.0 {
            *first = first.max(end);
        } else {
            *last = last.min(start);
        }
    }
    let direction = [Direction::U, Direction::V][d];
    if spec.find_overlap
        && spec.hidden.is_empty()
        && let Some([first, second]) = overlap::beyond_crossing(&turned[0], &turned[1], direction)
    {
        shown[0][1] = first;
        shown[1][0] = second;
    }
    for (place, [start, end]) in shown.into_iter().enumerate() {
        all[d][place].retain(|&f| f >= start && f <= end);
        if all[d][place].len() < 2 {
            let needed = turned[place].knots(direction).count();
            let patch = layout.places[place].patch;
            return Err(MergeError::TooFewRows {
                patch,
                rows: all[d][place].len(),
                needed,
            });
        }
    }
    Ok(all)
}

/// Which place a hidden part belongs to, and its range as fractions of the turned patch.
fn hidden_part(
    hidden: &Hidden,
    surfaces: &[Surface],
    layout: &Layout,
    d: usize,
) -> Result<(usize, [f64; 2]), MergeError> {
    let Some(place) = layout.places.iter().position(|p| p.patch == hidden.patch) else {
        return Err(refused(hidden, "there is no such patch"));
    };
    let turn: Turn = layout.places[place].turn;
    let (direction, backwards) = turn.direction(hidden.direction);
    if direction != [Direction::U, Direction::V][d] {
        return Err(refused(
            hidden,
            "the patches follow each other in the other direction",
        ));
    }
    let [start, end] = hidden.range;
    if start.partial_cmp(&end) != Some(std::cmp::Ordering::Less) {
        return Err(refused(hidden, "it is empty or not a range"));
    }
    let knots = surfaces[hidden.patch].knots(hidden.direction);
    let (first, last) = knots.domain();
    if start <= first && end >= last {
        return Err(refused(hidden, "nothing of the patch would show"));
    }
    if (start > first && end < last) || end <= first || start >= last {
        return Err(refused(
            hidden,
            "one end of the patch's domain must be in it",
        ));
    }
    let [a, b] = [start, end].map(|t| ((t - first) / knots.length()).clamp(0.0, 1.0));
    Ok((
        place,
        if backwards {
            [1.0 - b, 1.0 - a]
        } else {
            [a, b]
        },
    ))
}

fn refused(hidden: &Hidden, reason: &'static str) -> MergeError {
    MergeError::Hidden {
        patch: hidden.patch,
        start: hidden.range[0],
        end: hidden.range[1],
        reason,
    }
}

/// Knots and shares of the source's steps 3 to 5.
fn as_the_source(axis: &Axis, continuity: usize) -> Choice {
    let n = axis.blocks.len() as f64;
    let at = (0..axis.blocks.len())
        .map(|b| [b as f64 / n, (b + 1) as f64 / n])
        .collect();
    let knots = Knots::joined(
        axis.degree,
        continuity,
        &interiors(axis),
        &at,
        Knots::seed_blend(continuity),
    );
    Choice { at, knots }
}

/// From 0 to 1, both exactly.
pub(super) fn evenly(count: usize) -> Vec<f64> {
    (0..count).map(|k| k as f64 / (count - 1) as f64).collect()
}

/// Some of them, with the first and the last.
fn thinned(fractions: &[f64]) -> Vec<f64> {
    let count = fractions.len().min(SEARCH_ROWS);
    (0..count)
        .map(|k| fractions[k * (fractions.len() - 1) / (count - 1)])
        .collect()
}
