//! From patches that are laid to a plan.

use super::axis::Axis;
use super::fit::Ends;
use super::ground::Ground;
use super::knots::{Knots, interiors};
use super::layout::Layout;
use super::plan::{BlockRows, Line, MergePlan};
use super::search::{Choice, choose, parameters};
use super::sheet::Sheet;
use super::{Hidden, HideBy, MergeError, MergeMethod, MergeSpec, Merged, Turn};
use palpate_geometry::surface::{Direction, Surface};

/// Rows of points by which knots are chosen.
const SEARCH_ROWS: usize = 34;

/// A merge that is ready to be done.
pub(super) struct Job {
    /// As the layout places them.
    pub sheets: Vec<Sheet>,
    layout: Layout,
    /// The patches along u and along v.
    pub axes: [Axis; 2],
    pub choices: [Choice; 2],
    /// (blocks) for u and v: where the patches are sampled.
    pub fractions: [Vec<Vec<f64>>; 2],
    ends: Ends,
}

impl Job {
    pub(super) fn new(
        surfaces: &[Surface],
        ground: &Ground,
        spec: &MergeSpec,
        by: HideBy,
    ) -> Result<Self, MergeError> {
        let sheets = ground.sheets(surfaces, by)?;
        let layout = ground.layout.clone();
        let fractions = fractions(surfaces, ground, &sheets, spec)?;
        let direction = [Direction::U, Direction::V];
        let axis = |d: usize, rows: &[Vec<f64>]| {
            Axis::new(&sheets, &layout, direction[d], ground.degrees[d], rows)
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
            sheets,
            layout,
            axes,
            choices,
            fractions,
            ends,
        };
        job.check_rows(ground.across())?;
        Ok(job)
    }

    pub(super) fn merged(&self) -> Result<Merged, MergeError> {
        let lines = [self.line(0)?, self.line(1)?];
        let plan = MergePlan::new(&self.sheets, self.layout.clone(), lines, self.ends);
        Ok(Merged {
            surface: plan.combined(&self.sheets)?,
            layout: self.layout.clone(),
            rows: [Direction::U, Direction::V].map(|d| plan.rows(d).to_vec()),
            seams: plan.seams(),
            plan: Some(plan),
            within_tolerance: None,
            readings: Vec::new(),
            hide_by: None,
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

    /// Enough rows for the control points of every patch, `across` the seam of those that are reached at all.
    fn check_rows(&self, across: usize) -> Result<(), MergeError> {
        for (d, axis) in self.axes.iter().enumerate() {
            let inner = interiors(axis);
            for (block, fractions) in self.fractions[d].iter().enumerate() {
                let needed = inner[block].len() + axis.degree + 1;
                let place = if d == 0 {
                    block * self.layout.columns
                } else {
                    block
                };
                let reached = match &self.sheets[place].end {
                    Some((_, graph)) if d == across => graph.most,
                    _ => 1.0,
                };
                let rows = (reached * (fractions.len() - 1) as f64) as usize + 1;
                if rows < needed {
                    let patch = self.layout.places[place].patch;
                    return Err(MergeError::TooFewRows {
                        patch,
                        rows,
                        needed,
                    });
                }
            }
        }
        Ok(())
    }
}

/// Where the blocks are sampled: evenly, less what is hidden.
fn fractions(
    surfaces: &[Surface],
    ground: &Ground,
    sheets: &[Sheet],
    spec: &MergeSpec,
) -> Result<[Vec<Vec<f64>>; 2], MergeError> {
    let layout = &ground.layout;
    let even = evenly(spec.points);
    let mut all = [
        vec![even.clone(); layout.rows],
        vec![even.clone(); layout.columns],
    ];
    if sheets.len() > 2 {
        if let Some(hidden) = spec.hidden.first() {
            return Err(refused(hidden, "only two patches can have hidden parts"));
        }
        return Ok(all);
    }
    let d = ground.across();
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
    if let Some(rim) = &ground.rims[0] {
        shown[0][1] = rim.least;
    }
    if let Some(rim) = &ground.rims[1] {
        shown[1][0] = 1.0 - rim.least;
    }
    for (place, [start, end]) in shown.into_iter().enumerate() {
        let rows = &mut all[d][place];
        if let Some((edge, graph)) = &sheets[place].end {
            let from_outside = |f: &f64| match edge.at_end() {
                true => graph.mean * f,
                false => 1.0 - graph.mean * (1.0 - f),
            };
            *rows = even.iter().map(from_outside).collect();
            continue;
        }
        rows.retain(|&f| f >= start && f <= end);
        if rows.len() < 2 {
            let needed = sheets[place]
                .surface
                .knots([Direction::U, Direction::V][d])
                .count();
            let patch = layout.places[place].patch;
            return Err(MergeError::TooFewRows {
                patch,
                rows: rows.len(),
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
