//! The rows of a blending matrix in one direction, and the levels of cells between them.
//!
//! The finest level has one cell between neighbouring rows; each coarser one takes three cells for
//! one, down to nine or fewer ("every k-th row"): 28, 82 and 244 rows give 27, 81 and 243 cells,
//! which are powers of three. No cell reaches over a knot where the surface may have a crease,
//! because the bound of what a cell misses needs a continuous tangent: such a knot gets two rows,
//! one seen from each side.

use palpate_geometry::basis::{KnotVector, Side};

/// Index modulo count, for windows that run past the end of a period.
pub(super) fn wrap(index: usize, count: usize) -> usize {
    if index < count { index } else { index - count }
}

/// Depths closer than this share of the body's size are equal: far above rounding, far below what a
/// hand feels.
pub(super) const SAME_DEPTH: f64 = 1e-12;
/// Beyond an open edge a foot says nothing about sides unless it is seen from within this cosine of
/// the normal.
pub(super) const FACING: f64 = 0.7;

/// Cells of the coarsest level, at most, unless creases ask for more.
const COARSEST: usize = 9;
/// And at least: fewer would cover a closed surface with spheres as large as itself.
const LEAST: usize = 6;
/// Cells that become one on the next coarser level.
const STEP: usize = 3;

/// A cell of one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GridCell {
    /// Rows at its ends.
    pub rows: [u32; 2],
    /// Cells of the next finer level: from, to (excluded). Itself on the finest.
    pub children: [u32; 2],
    /// Knot spans that it touches: from, to (excluded).
    pub spans: [u32; 2],
    /// Cells of the finest level: from, to (excluded).
    pub finest: [u32; 2],
    /// Squared length in the parameter over 8: what a second derivative is multiplied with.
    pub eighth: f64,
}

/// One direction of the grid.
#[derive(Clone, Debug)]
pub(super) struct GridAxis {
    /// (rows) parameters.
    pub parameters: Vec<f64>,
    /// (rows) column of the first value, in the extended net.
    pub first: Vec<u32>,
    /// `degree + 1`.
    pub width: usize,
    /// (rows × width) basis values and their first derivatives.
    pub values: [Vec<f64>; 2],
    /// Coarsest first.
    pub levels: Vec<Vec<GridCell>>,
    /// (spans) column of the first control point that shapes a span.
    pub span_first: Vec<u32>,
    /// Columns of the net, and of the net with those that repeat after a period.
    pub columns: [usize; 2],
    /// Walking on beyond one end leads to the other.
    pub wraps: bool,
    /// The knots wrap: rectangles may pass the end.
    pub period: Option<f64>,
}

impl GridAxis {
    /// About `rows` rows, more where creases ask for them.
    pub fn new(knots: &KnotVector, rows: usize, wraps: bool) -> Self {
        let t = knots.knots();
        let spans: Vec<[f64; 2]> = knots.spans().map(|k| [t[k], t[k + 1]]).collect();
        let mut axis = Self {
            parameters: Vec::new(),
            first: Vec::new(),
            width: knots.degree() + 1,
            values: [Vec::new(), Vec::new()],
            levels: Vec::new(),
            span_first: knots.spans().map(|k| (k - knots.degree()) as u32).collect(),
            columns: [knots.count(), knots.basis_count()],
            wraps,
            period: knots.is_periodic().then(|| knots.length()),
        };
        let (mut finest, mut starts) = (Vec::new(), vec![0]);
        for [from, to] in smooth_parts(knots, &spans) {
            let share = (to - from) / knots.length();
            let cells = ((rows.max(2) - 1) as f64 * share).round().max(1.0) as usize;
            for k in 0..=cells {
                let u = if k == cells {
                    to
                } else {
                    from + (to - from) * k as f64 / cells as f64
                };
                axis.push_row(knots, u, if k == cells { Side::Left } else { Side::Right });
                if k > 0 {
                    let row = axis.parameters.len() as u32 - 1;
                    let k = finest.len() as u32;
                    finest.push(axis.cell([row - 1, row], [k, k + 1], [k, k + 1], &spans));
                }
            }
            starts.push(finest.len());
        }
        axis.build_levels(finest, starts, &spans);
        axis
    }

    fn push_row(&mut self, knots: &KnotVector, u: f64, side: Side) {
        // The end of a period seen from the left is its start, one period on: windows take it there
        // by themselves.
        let window = knots.window_from(u, side);
        self.parameters.push(u);
        self.first.push(window.first as u32);
        self.values[0].extend_from_slice(window.values());
        self.values[1].extend_from_slice(window.first_derivatives());
    }

    fn cell(
        &self,
        rows: [u32; 2],
        children: [u32; 2],
        finest: [u32; 2],
        spans: &[[f64; 2]],
    ) -> GridCell {
        let [from, to] = rows.map(|row| self.parameters[row as usize]);
        let low = spans
            .iter()
            .position(|span| span[1] > from)
            .unwrap_or(spans.len() - 1);
        let high = spans
            .iter()
            .rposition(|span| span[0] < to)
            .unwrap_or(0)
            .max(low);
        GridCell {
            rows,
            children,
            spans: [low as u32, high as u32 + 1],
            finest,
            eighth: (to - from) * (to - from) / 8.0,
        }
    }

    /// `starts`: the first cell of each smooth part, and the number of all.
    fn build_levels(&mut self, finest: Vec<GridCell>, mut starts: Vec<usize>, spans: &[[f64; 2]]) {
        let mut levels = vec![finest];
        while let Some(last) = levels.last().filter(|last| last.len() > COARSEST) {
            let (mut coarser, mut next_starts) = (Vec::new(), vec![0]);
            for part in starts.windows(2) {
                for k in (part[0]..part[1]).step_by(STEP) {
                    let end = (k + STEP).min(part[1]);
                    let rows = [last[k].rows[0], last[end - 1].rows[1]];
                    let finest = [last[k].finest[0], last[end - 1].finest[1]];
                    coarser.push(self.cell(rows, [k as u32, end as u32], finest, spans));
                }
                next_starts.push(coarser.len());
            }
            if coarser.len() < LEAST {
                break;
            }
            starts = next_starts;
            levels.push(coarser);
        }
        levels.reverse();
        self.levels = levels;
    }

    /// Basis values (order 0) or first derivatives (1) of a row, `width` of them, and the column of
    /// the first.
    #[inline(always)]
    pub fn row(&self, row: u32, order: usize) -> (usize, &[f64]) {
        let row = row as usize;
        (
            self.first[row] as usize,
            &self.values[order][row * self.width..(row + 1) * self.width],
        )
    }

    /// Cells of the finest level.
    pub fn finest(&self) -> usize {
        self.levels[self.levels.len() - 1].len()
    }

    /// The cells of a level of the whole grid; the direction with fewer levels stays at its finest.
    #[inline(always)]
    pub fn level(&self, level: usize) -> &[GridCell] {
        &self.levels[level.min(self.levels.len() - 1)]
    }
}

/// The domain in parts that meet where a knot is repeated as often as the degree, or more.
fn smooth_parts(knots: &KnotVector, spans: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut parts = vec![spans[0]];
    for span in &spans[1..] {
        match parts.last_mut() {
            Some(last) if knots.multiplicity(span[0]) < knots.degree() => last[1] = span[1],
            _ => parts.push(*span),
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_three_give_full_levels() {
        let knots = KnotVector::clamped_uniform(3, 8).unwrap();
        for (rows, wanted) in [
            (28, vec![9, 27]),
            (82, vec![9, 27, 81]),
            (244, vec![9, 27, 81, 243]),
        ] {
            let axis = GridAxis::new(&knots, rows, false);
            assert_eq!(axis.levels.iter().map(Vec::len).collect::<Vec<_>>(), wanted);
            assert_eq!(axis.parameters.len(), rows);
        }
    }

    #[test]
    fn cells_of_every_level_tile_the_domain_and_stay_off_creases() {
        let creased =
            KnotVector::new(2, vec![0.0, 0.0, 0.0, 0.2, 0.5, 0.5, 0.7, 1.0, 1.0, 1.0]).unwrap();
        let others = [
            KnotVector::periodic_uniform(3, 7).unwrap(),
            KnotVector::clamped_uniform(1, 6).unwrap(),
        ];
        for knots in others.iter().chain([&creased]) {
            for rows in [2, 5, 28, 50, 82] {
                let axis = GridAxis::new(knots, rows, false);
                for level in &axis.levels {
                    let at = |row: u32| axis.parameters[row as usize];
                    assert_eq!(
                        (at(level[0].rows[0]), at(level[level.len() - 1].rows[1])),
                        knots.domain()
                    );
                    assert!(
                        level
                            .windows(2)
                            .all(|w| at(w[0].rows[1]) == at(w[1].rows[0])),
                        "{rows}: a hole"
                    );
                    if knots == &creased {
                        assert!(
                            level
                                .iter()
                                .all(|c| at(c.rows[1]) <= 0.5 || at(c.rows[0]) >= 0.5),
                            "{rows}"
                        );
                    }
                }
                for pair in axis.levels.windows(2) {
                    let ends: Vec<u32> = pair[0].iter().flat_map(|c| c.children).collect();
                    assert!(
                        ends.chunks(2).all(|c| c[0] < c[1])
                            && ends[ends.len() - 1] as usize == pair[1].len()
                    );
                }
            }
        }
    }
}
