//! Merging without a fit.
//!
//! ```text
//! elevated to one degree ──▶ common knots across ──▶ knots end to end, k times at the seam ──▶ C⁰, no deviation
//!                                                                                 │ c > 0
//!                                   least change of the control points at the seam ▼ that makes them C^c
//! ```
//! A function over knots with the seam k − c times has control points q; put over knots with the
//! seam k times they are R q (knot insertion). The q with R q nearest to the patches' control
//! points is taken: where patches are C^c already nothing moves, else the c rows on each side of
//! the seam and the seam itself do, and no others.

use super::axis::{Axis, normalised};
use super::build::evenly;
use super::fit::Band;
use super::ground::{check_knots, check_nets, check_spec, degrees};
use super::layout::Layout;
use super::overlap::gap_m;
use super::plan::BlockRows;
use super::search::{intervals, parameters};
use super::sheet::Sheet;
use super::{DegreeRule, MergeError, MergeSpec, Merged, Seam};
use palpate_geometry::basis::{KnotError, KnotVector};
use palpate_geometry::math::Point3;
use palpate_geometry::surface::{ControlNet, Direction, Surface, SurfaceError};

/// Edges farther apart than this, as a share of the size, do not meet.
const MEET: f64 = 1e-6;
/// Knots nearer than this are one.
const SAME_KNOT: f64 = 1e-12;
/// Rows by which lengths and speeds are measured.
const ROWS: usize = 41;

pub(super) fn merge(surfaces: &[Surface], spec: &MergeSpec) -> Result<Merged, MergeError> {
    check_spec(spec)?;
    check_nets(surfaces)?;
    check_knots(surfaces)?;
    for (unfit, what) in [
        (!spec.hidden.is_empty(), "hidden parts"),
        (spec.trims.iter().any(Option::is_some), "trims"),
        (spec.tolerance_m.is_some(), "a tolerance"),
        (spec.degree == DegreeRule::Lower, "a lower degree"),
    ] {
        if unfit {
            return Err(MergeError::NotExact { what });
        }
    }
    let layout = Layout::new(surfaces, spec.arrangement, &[])?;
    let turned = Sheet::laid(surfaces, &layout);
    check_meeting(&turned, &layout)?;
    let degrees = degrees(&turned, &layout, spec)?;
    let alike = common(&turned, &layout, degrees)?;
    let sheets: Vec<Sheet> = alike.iter().cloned().map(Sheet::whole).collect();
    let directions = [Direction::U, Direction::V];
    let at = std::array::from_fn::<_, 2, _>(|d| {
        let blocks = if d == 0 { layout.rows } else { layout.columns };
        let axis = Axis::new(
            &sheets,
            &layout,
            directions[d],
            degrees[d],
            &vec![evenly(ROWS); blocks],
        );
        intervals(&axis).swap_remove(0)
    });
    let seams = |d: usize| {
        at[d][1..]
            .iter()
            .map(|interval| interval[0])
            .collect::<Vec<f64>>()
    };
    let mut surface = glued(&alike, &layout, degrees, &at)?;
    for d in [0, 1] {
        surface = smoothed(&surface, directions[d], &seams(d), spec.continuity)?;
    }
    let flip = turned[layout.places.iter().position(|p| p.patch == 0).unwrap_or(0)]
        .surface
        .flip_normal();
    let rows = std::array::from_fn(|d| {
        let fractions = evenly(spec.points);
        let of = |&interval| BlockRows {
            parameters: parameters(&fractions, interval),
            fractions: fractions.clone(),
        };
        at[d].iter().map(of).collect()
    });
    let all = [0, 1].map(|d| {
        seams(d).into_iter().map(move |at| Seam {
            direction: directions[d],
            at,
        })
    });
    Ok(Merged {
        surface: surface.with_flip_normal(flip),
        layout,
        rows,
        seams: all.into_iter().flatten().collect(),
        plan: None,
        within_tolerance: None,
        readings: Vec::new(),
        hide_by: None,
    })
}

fn check_meeting(turned: &[Sheet], layout: &Layout) -> Result<(), MergeError> {
    let size_m = turned.iter().map(|s| s.surface.size()).fold(0.0, f64::max);
    for (k, a) in turned.iter().enumerate() {
        let (i, j) = (k / layout.columns, k % layout.columns);
        let below = (i + 1 < layout.rows).then_some((k + layout.columns, Direction::U));
        let right = (j + 1 < layout.columns).then_some((k + 1, Direction::V));
        for (l, direction) in below.into_iter().chain(right) {
            let gap_m = gap_m(&a.surface, &turned[l].surface, direction);
            if gap_m > MEET * size_m {
                return Err(MergeError::Apart {
                    a: layout.places[k].patch,
                    b: layout.places[l].patch,
                    gap_m,
                });
            }
        }
    }
    Ok(())
}

/// The patches over [0, 1], of one degree, those of a block with the same knots along it.
fn common(
    turned: &[Sheet],
    layout: &Layout,
    degrees: [usize; 2],
) -> Result<Vec<Surface>, MergeError> {
    let mut patches = Vec::with_capacity(turned.len());
    for Sheet { surface: patch, .. } in turned {
        let mut patch = Surface::new(
            normalised(patch.knots_u()),
            normalised(patch.knots_v()),
            patch.net().clone(),
            None,
        )?;
        for (direction, degree) in [(Direction::U, degrees[0]), (Direction::V, degrees[1])] {
            for _ in patch.knots(direction).degree()..degree {
                patch = patch.elevated(direction)?;
            }
        }
        patches.push(patch);
    }
    for direction in [Direction::U, Direction::V] {
        let (blocks, of): (usize, fn(usize, usize) -> usize) = match direction {
            Direction::U => (layout.rows, |k, columns| k / columns),
            Direction::V => (layout.columns, |k, columns| k % columns),
        };
        for block in 0..blocks {
            let members: Vec<usize> = (0..patches.len())
                .filter(|&k| of(k, layout.columns) == block)
                .collect();
            let mut union: Vec<f64> = Vec::new();
            for &k in &members {
                let more = missing(&union, patches[k].knots(direction).knots());
                union.extend(more);
                union.sort_by(f64::total_cmp);
            }
            for &k in &members {
                let more = missing(patches[k].knots(direction).knots(), &union);
                patches[k] = patches[k].insert_knots(direction, &more)?;
            }
        }
    }
    Ok(patches)
}

/// What of `wanted` is not in `have`, each as often as it lacks; both rise.
fn missing(have: &[f64], wanted: &[f64]) -> Vec<f64> {
    let mut k = 0;
    let mut more = Vec::new();
    for &t in wanted {
        while k < have.len() && have[k] < t - SAME_KNOT {
            k += 1;
        }
        if k < have.len() && (have[k] - t).abs() <= SAME_KNOT {
            k += 1;
        } else {
            more.push(t);
        }
    }
    more
}

/// Nets put together; rows that meet become one, half way.
fn glued(
    alike: &[Surface],
    layout: &Layout,
    degrees: [usize; 2],
    at: &[Vec<[f64; 2]>; 2],
) -> Result<Surface, MergeError> {
    let first_of_block = |d: usize, block: usize| {
        if d == 0 {
            block * layout.columns
        } else {
            block
        }
    };
    let directions = [Direction::U, Direction::V];
    let mut knots = Vec::new();
    // Where each block's control points start in the merged net.
    let mut starts: [Vec<usize>; 2] = [Vec::new(), Vec::new()];
    for d in [0, 1] {
        let mut values = vec![0.0; degrees[d] + 1];
        let mut start = 0;
        for (block, [from, to]) in at[d].iter().enumerate() {
            let own = alike[first_of_block(d, block)].knots(directions[d]);
            starts[d].push(start);
            start += own.count() - 1;
            let inner = own.knots().iter().filter(|&&t| t > 0.0 && t < 1.0);
            values.extend(inner.map(|t| from * (1.0 - t) + to * t));
            let last = block + 1 == at[d].len();
            values.extend(std::iter::repeat_n(
                *to,
                if last { degrees[d] + 1 } else { degrees[d] },
            ));
        }
        knots.push(KnotVector::new(degrees[d], values)?);
    }
    let (rows, columns) = (knots[0].count(), knots[1].count());
    let mut points: Vec<Option<Point3>> = vec![None; rows * columns];
    for (k, patch) in alike.iter().enumerate() {
        let (top, left) = (starts[0][k / layout.columns], starts[1][k % layout.columns]);
        for i in 0..patch.net().rows() {
            for j in 0..patch.net().columns() {
                let point = *patch.net().at(i, j);
                let slot = &mut points[(top + i) * columns + left + j];
                *slot = Some(slot.map_or(point, |there| nalgebra::center(&there, &point)));
            }
        }
    }
    let points = points
        .into_iter()
        .map(|p| p.expect("blocks cover the net"))
        .collect();
    let v = knots.pop().expect("two directions");
    let u = knots.pop().expect("two directions");
    Ok(Surface::new(
        u,
        v,
        ControlNet::new(rows, columns, points).map_err(SurfaceError::from)?,
        None,
    )?)
}

/// The nearest surface that is C^c at the seams of a direction.
fn smoothed(
    surface: &Surface,
    direction: Direction,
    seams: &[f64],
    continuity: usize,
) -> Result<Surface, MergeError> {
    if seams.is_empty() || continuity == 0 {
        return Ok(surface.clone());
    }
    let fine = surface.knots(direction);
    let (coarse, refinement) = removal(fine, seams, continuity)?;
    let along_u = if direction == Direction::U {
        surface.clone()
    } else {
        surface.swap_uv()
    };
    let width = 3 * along_u.net().columns();
    let samples: Vec<f64> = along_u
        .net()
        .points()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect();
    let moved = nearest(
        &refinement,
        coarse.count(),
        coarse.degree() + 1,
        &samples,
        width,
    );
    let points = moved
        .chunks_exact(3)
        .map(|x| Point3::new(x[0], x[1], x[2]))
        .collect();
    let net = ControlNet::new(coarse.count(), along_u.net().columns(), points)
        .map_err(SurfaceError::from)?;
    let smooth = Surface::new(coarse, along_u.knots_v().clone(), net, None)?;
    Ok(if direction == Direction::U {
        smooth
    } else {
        smooth.swap_uv()
    })
}

/// Rows of R: the first column that is not zero, and the values from there on.
type Rows = Vec<(usize, Vec<f64>)>;

/// Knots with each seam `continuity` times less, and the rows (first column, values) of R that put
/// them back.
fn removal(
    fine: &KnotVector,
    seams: &[f64],
    continuity: usize,
) -> Result<(KnotVector, Rows), KnotError> {
    let mut values = fine.knots().to_vec();
    for &seam in seams {
        let first = values.partition_point(|&t| t < seam);
        values.drain(first..first + continuity);
    }
    let coarse = KnotVector::new(fine.degree(), values)?;
    let mut insertions = Vec::new();
    let mut knots = coarse.clone();
    for &seam in seams {
        for _ in 0..continuity {
            let insertion = knots.insertion(seam)?;
            knots = insertion.knots.clone();
            insertions.push(insertion);
        }
    }
    let mut rows: Rows = vec![(0, Vec::new()); fine.count()];
    for column in 0..coarse.count() {
        let mut unit = vec![0.0; coarse.count()];
        unit[column] = 1.0;
        for insertion in &insertions {
            unit = insertion.apply(&unit, |a, b, alpha| a + alpha * (b - a));
        }
        for (row, value) in unit.into_iter().enumerate().filter(|(_, x)| *x != 0.0) {
            let (first, values) = &mut rows[row];
            if values.is_empty() {
                *first = column;
            }
            values.resize(column - *first, 0.0);
            values.push(value);
        }
    }
    Ok((coarse, rows))
}

/// q with R q nearest to the samples, (rows × width) → (count × width). Solved for what an average
/// of the samples misses, so rows that R only copies come out as they are.
fn nearest(
    rows: &[(usize, Vec<f64>)],
    count: usize,
    band: usize,
    samples: &[f64],
    width: usize,
) -> Vec<f64> {
    let mut normal = Band::new(count, band);
    let transposed = |x: &[f64]| {
        let mut out = vec![0.0; count * width];
        for ((first, values), x) in rows.iter().zip(x.chunks_exact(width)) {
            for (value, out) in values
                .iter()
                .zip(out[first * width..].chunks_exact_mut(width))
            {
                out.iter_mut().zip(x).for_each(|(o, x)| *o += value * x);
            }
        }
        out
    };
    for (first, values) in rows {
        normal.add_row(*first, values);
    }
    let normal = normal.factored();
    let mut points = transposed(samples);
    normal.solve(&mut points, width);
    let mut misses = samples.to_vec();
    for ((first, values), miss) in rows.iter().zip(misses.chunks_exact_mut(width)) {
        for (value, point) in values
            .iter()
            .zip(points[first * width..].chunks_exact(width))
        {
            miss.iter_mut()
                .zip(point)
                .for_each(|(m, p)| *m -= value * p);
        }
    }
    let mut correction = transposed(&misses);
    normal.solve(&mut correction, width);
    points.iter_mut().zip(correction).for_each(|(p, c)| *p += c);
    points
}
