//! Surfaces from surfaces, curves, trees and points. Reports leave as JSON.

use crate::errors::surface_error;
use crate::surface::{Surface, direction_of, read_file};
use crate::values::{array, keyword, points, slice};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::exchange::{Format, read_points};
use palpate_geometry::math::Vector3;
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{self, CloudSpec, Curve, Fitted, GridSpec};
use palpate_modeling::branch::{Tree, grow};
use palpate_modeling::isolate::{IsolateMethod, IsolateSpec, IsolateStatus, Isolated, isolate_all};
use palpate_modeling::merge::{
    Arrangement, DegreeRule, Edge, Hidden, HideBy, MergeMethod, MergeSpec, Reading,
};
use palpate_modeling::pipe::{Answer, PipeLimits, Spine, pipe_surface};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use std::path::PathBuf;

fn choice<T: Copy>(name: &str, given: &str, known: &[(&str, T)]) -> PyResult<T> {
    known
        .iter()
        .find(|(word, _)| *word == given)
        .map(|(_, value)| *value)
        .ok_or_else(|| {
            let words = known
                .iter()
                .map(|(word, _)| *word)
                .collect::<Vec<_>>()
                .join(", ");
            PyValueError::new_err(format!("{name} {given:?} is not known; use {words}"))
        })
}

fn plain(surfaces: &[PyRef<'_, Surface>]) -> Vec<surface::Surface> {
    surfaces
        .iter()
        .map(|surface| (*surface.inner).clone())
        .collect()
}

/// Joins patches into one surface; returns it with a report as JSON.
#[pyfunction]
pub fn merge(
    py: Python<'_>,
    surfaces: Vec<PyRef<'_, Surface>>,
    options: &Bound<'_, PyDict>,
) -> PyResult<(Surface, String)> {
    let edge = |name: &str| {
        choice(
            "edge",
            name,
            &[
                ("u0", Edge::U0),
                ("u1", Edge::U1),
                ("v0", Edge::V0),
                ("v1", Edge::V1),
            ],
        )
    };
    let grid: Option<(usize, usize)> = keyword(options, "grid")?;
    let edges: Option<(String, String)> = keyword(options, "edges")?;
    let arrangement = match (grid, edges) {
        (Some(_), Some(_)) => {
            return Err(PyValueError::new_err("grid and edges exclude each other"));
        }
        (Some((rows, columns)), None) => Arrangement::Grid { rows, columns },
        (None, Some((a, b))) => Arrangement::Edges([edge(&a)?, edge(&b)?]),
        (None, None) => match surfaces.len() {
            0..=2 => Arrangement::Closest,
            columns => Arrangement::Grid { rows: 1, columns },
        },
    };
    let hide: Vec<(usize, String, (f64, f64))> = keyword(options, "hide")?;
    let ranges = hide.into_iter().map(|(patch, direction, (a, b))| {
        Ok(Hidden {
            patch,
            direction: direction_of(&direction)?,
            range: [a, b],
        })
    });
    let methods = [
        ("constrained", MergeMethod::Constrained),
        ("seed", MergeMethod::Seed),
        ("exact", MergeMethod::Exact),
    ];
    let spec = MergeSpec {
        continuity: keyword(options, "continuity")?,
        method: choice("method", &keyword::<String>(options, "method")?, &methods)?,
        degree: choice(
            "degree",
            &keyword::<String>(options, "degree")?,
            &[("raise", DegreeRule::Raise), ("lower", DegreeRule::Lower)],
        )?,
        arrangement,
        hidden: ranges.collect::<PyResult<_>>()?,
        hide_by: keyword::<Option<String>>(options, "hidden")?
            .map(|name| choice("hidden", &name, &HideBy::ALL))
            .transpose()?,
        find_overlap: keyword(options, "find_overlap")?,
        tolerance_m: keyword(options, "tolerance")?,
        ..MergeSpec::default()
    };
    let surfaces = plain(&surfaces);
    py.detach(|| {
        let merged = palpate_modeling::merge::merge(&surfaces, &spec).map_err(surface_error)?;
        let report = merged.report(&surfaces);
        let seams: Vec<_> = report
            .seams
            .iter()
            .map(|(seam, continuity)| {
                let direction = if seam.direction == surface::Direction::U {
                    "u"
                } else {
                    "v"
                };
                json!({"direction": direction, "at": seam.at, "continuity": continuity})
            })
            .collect();
        let words = json!({
            "deviation": report.deviation, "seams": seams, "before": report.before,
            "within_tolerance": merged.within_tolerance, "hidden": merged.hide_by.map(HideBy::name),
            "readings": merged.readings.iter().map(Reading::words).collect::<Vec<_>>(),
        });
        Ok((Surface::of(merged.surface), words.to_string()))
    })
}

/// Moves overlapping bodies apart; returns a translation of each (m) and a report as JSON.
#[pyfunction]
#[pyo3(signature = (surfaces, method="global", gap=None, max_turn=None, fall_back=true))]
pub fn isolate(
    py: Python<'_>,
    surfaces: Vec<PyRef<'_, Surface>>,
    method: &str,
    gap: Option<f64>,
    max_turn: Option<f64>,
    fall_back: bool,
) -> PyResult<(Vec<[f64; 3]>, String)> {
    let method = IsolateMethod::of(method).ok_or_else(|| {
        PyValueError::new_err(format!(
            "method {method:?} is not known; use local, global, thorough or 1 to 7"
        ))
    })?;
    let spec = IsolateSpec {
        method,
        gap_m: gap,
        max_turn_deg: max_turn,
        fall_back,
        ..IsolateSpec::default()
    };
    let surfaces = plain(&surfaces);
    py.detach(|| {
        let plain = |v: &Vector3| [v.x, v.y, v.z];
        let one = |answer: &Isolated| {
            let reason = match answer.status {
                IsolateStatus::Failed(reason) => Some(reason.to_string()),
                IsolateStatus::Apart | IsolateStatus::Isolated => None,
            };
            json!({
                "translation": plain(&answer.translation_m), "gap": answer.gap_m, "turn": answer.turn_deg,
                "method": answer.method.name(), "instead_because": answer.fell_back.map(|r| r.to_string()),
                "reason": reason, "regions": answer.regions,
            })
        };
        if let [moving, fixed] = &surfaces[..] {
            let answer = palpate_modeling::isolate::isolate(moving, fixed, &spec).map_err(surface_error)?;
            if let IsolateStatus::Failed(reason) = answer.status {
                return Err(surface_error(format!("not isolated: {reason}")));
            }
            let report = json!({"passes": 1, "moves": [one(&answer)]});
            return Ok((vec![plain(&answer.translation_m), [0.0; 3]], report.to_string()));
        }
        let all = isolate_all(&surfaces, &spec).map_err(surface_error)?;
        if let Some(reason) = all.unsettled {
            return Err(surface_error(format!("not isolated: {reason}")));
        }
        let moves: Vec<_> = all.moves.iter().map(|moved| one(&moved.answer)).collect();
        let report = json!({"passes": all.passes, "moves": moves});
        Ok((all.translations_m.iter().map(plain).collect(), report.to_string()))
    })
}

/// A curve as a dictionary: degree, knots, points (n, 3), weights and whether it is periodic.
fn curve(given: &Bound<'_, PyDict>) -> PyResult<Curve> {
    let degree = keyword(given, "degree")?;
    let knots = slice(&array(&keyword(given, "knots")?, "knots")?).to_vec();
    let knots = if keyword(given, "periodic")? {
        KnotVector::periodic(degree, knots)
    } else {
        KnotVector::new(degree, knots)
    };
    let (points, shape) = points(&keyword(given, "points")?, "points")?;
    if shape.len() != 1 {
        return Err(PyValueError::new_err(
            "points of a curve must have the shape (n, 3)",
        ));
    }
    let weights = keyword::<Option<Bound<'_, PyAny>>>(given, "weights")?
        .map(|weights| Ok::<_, PyErr>(slice(&array(&weights, "weights")?).to_vec()))
        .transpose()?;
    Curve::new(knots.map_err(surface_error)?, points, weights).map_err(surface_error)
}

/// The largest radius of a pipe around a curve, and the pipe of a given radius; JSON and surface.
#[pyfunction]
#[pyo3(signature = (spine, radius=None, tolerance=None))]
pub fn pipe(
    py: Python<'_>,
    spine: &Bound<'_, PyDict>,
    radius: Option<f64>,
    tolerance: Option<f64>,
) -> PyResult<(Option<Surface>, String)> {
    let curve = curve(spine)?;
    if let Some(radius) = radius.filter(|radius| !(radius.is_finite() && *radius > 0.0)) {
        return Err(PyValueError::new_err(format!(
            "radius is {radius}; it must be a finite length above 0, m"
        )));
    }
    py.detach(|| {
        let spine = Spine::new(&curve).map_err(surface_error)?;
        let limits = PipeLimits::of_spine(&spine);
        let answer = radius.map(|radius| limits.answer(radius));
        let free = answer.map(|answer| match answer {
            Answer::Free => Some(true),
            Answer::Intersects => Some(false),
            Answer::Unknown => None,
        });
        let made = radius.map(|radius| pipe_surface(&spine, radius, tolerance.unwrap_or(1e-6 * radius)));
        let made = made.transpose().map_err(surface_error)?;
        let [local, body, ends, end_body] = limits.bounds_m().map(|(_, radius)| radius);
        let report = json!({
            "r_max": limits.r_max_m().map(|(r, _)| r), "limit": limits.r_max_m().map(|(_, limit)| limit),
            "r_local": local, "r_bb": body, "r_ee": ends, "r_eb": end_body, "status": limits.status(),
            "free": free.flatten(), "deviation": made.as_ref().map(|pipe| pipe.deviation_m),
        });
        Ok((made.map(|pipe| Surface::of(pipe.surface)), report.to_string()))
    })
}

/// One surface for a tree of tubes (TOML text); with its patch table as JSON.
#[pyfunction]
pub fn branch(py: Python<'_>, tree: &str) -> PyResult<(Surface, String)> {
    let tree: Tree = toml::from_str(tree).map_err(surface_error)?;
    py.detach(|| {
        let grown = grow(&tree).map_err(surface_error)?;
        let report = json!({"patches": grown.patches.patches, "leaves": grown.patches.leaves, "ties": grown.ties});
        Ok((Surface::of(grown.surface), report.to_string()))
    })
}

/// A surface near points; with root-mean-square and largest distance, m.
#[pyfunction]
pub fn fit(
    py: Python<'_>,
    points: &Bound<'_, PyAny>,
    options: &Bound<'_, PyDict>,
) -> PyResult<(Surface, f64, f64)> {
    let net: Option<(usize, usize)> = keyword(options, "net")?;
    let (degree, closed, grid) = (
        keyword(options, "degree")?,
        keyword(options, "closed")?,
        keyword(options, "grid")?,
    );
    let smoothing: Option<f64> = keyword(options, "smoothing")?;
    let periodic: (bool, bool) = keyword(options, "periodic")?;
    let unit = choice(
        "unit",
        &keyword::<String>(options, "unit")?,
        &[("m", Unit::Metre), ("mm", Unit::Millimetre)],
    )?;
    let (list, shape) = match points.extract::<PathBuf>() {
        Ok(path) => {
            let wrong = |error| surface_error(format!("{}: {error}", path.display()));
            let format = Format::of(&path).map_err(wrong)?;
            let list = read_points(&read_file(&path)?, format, unit).map_err(wrong)?;
            let count = list.len();
            (list, vec![count])
        }
        Err(_) => {
            let (mut list, shape) = crate::values::points(points, "points")?;
            list.iter_mut().for_each(|point| *point /= unit.per_metre());
            (list, shape)
        }
    };
    if let Some((nu, nv)) = net.filter(|(nu, nv)| nu.saturating_mul(*nv) > 1 << 20) {
        return Err(PyValueError::new_err(format!(
            "net ({nu}, {nv}) is more than a fit supports (2^20 points)"
        )));
    }
    let counts = net.map(|(nu, nv)| [nu, nv]);
    let fitted = py.detach(|| match (grid, &shape[..]) {
        (true, &[rows, columns]) => {
            let spec = GridSpec {
                degree: [degree; 2],
                counts: counts.unwrap_or([rows, columns]),
                periodic: [periodic.0, periodic.1],
            };
            surface::Surface::fitted_to_grid(&list, rows, columns, &spec).map_err(surface_error)
        }
        (true, _) => Err(PyValueError::new_err(
            "points of a grid must have the shape (nu, nv, 3)",
        )),
        (false, _) => {
            let usual = CloudSpec::default();
            let spec = CloudSpec {
                closed,
                degree: [degree; 2],
                counts: counts.unwrap_or(usual.counts),
                smoothing: smoothing.unwrap_or(usual.smoothing),
                ..usual
            };
            surface::Surface::fitted_to_cloud(&list, &spec).map_err(surface_error)
        }
    });
    let Fitted {
        surface,
        rms_error,
        max_error,
    } = fitted?;
    Ok((Surface::of(surface), rms_error, max_error))
}

/// A dictionary as TOML text.
#[pyfunction]
pub fn toml_text(values: &Bound<'_, PyAny>) -> PyResult<String> {
    toml::to_string(&crate::values::toml_value(values, "")?).map_err(crate::errors::internal)
}
