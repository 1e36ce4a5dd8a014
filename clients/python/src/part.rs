//! Parts of STEP files: closest points on arrays, measures, triangles.

use crate::closest::cores;
use crate::errors::surface_error;
use crate::surface::{MeshArrays, mesh_arrays, read_file};
use crate::values::{points, python, structured};
use palpate_geometry::exchange::step::{PartPick, read_part};
use palpate_geometry::math::Point3;
use palpate_geometry::part::{self, PartMeasure, PartSolver, Support};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// Tolerance of triangles where none is given, relative to the part's size.
const DEFAULT_TOLERANCE: f64 = 1e-3;
/// Triangles at most.
const MOST_TRIANGLES: usize = 20_000_000;
/// Bytes of a row of dtype `PART_CLOSEST`.
const ROW: usize = 8 * 8 + 3 * 4;

/// A part from CAD: faces that are trimmed pieces of planes, cylinders, cones, spheres, tori and B-splines; constant.
/// `Part.load` makes one.
#[pyclass(frozen, module = "palpate")]
pub struct Part {
    inner: Arc<part::Part>,
    measure: PartMeasure,
    left_out: String,
    notes: Vec<String>,
}

#[pymethods]
impl Part {
    /// The part in a STEP file; several solids are one part. Lengths become metres.
    ///
    /// Parameters
    /// ----------
    /// part : str, optional
    ///     Only the product of this name.
    /// instance : int, optional
    ///     Only this place of it, from 0.
    /// partial : bool
    ///     Leaves out faces that cannot be read, which is an error otherwise; `left_out` says so.
    ///
    /// Raises
    /// ------
    /// SurfaceError
    ///     What is wrong with the file, and where.
    #[staticmethod]
    #[pyo3(signature = (path, *, part=None, instance=None, partial=false))]
    fn load(
        py: Python<'_>,
        path: PathBuf,
        part: Option<String>,
        instance: Option<usize>,
        partial: bool,
    ) -> PyResult<Self> {
        let bytes = read_file(&path)?;
        let wrong = |error: String| surface_error(format!("{}: {error}", path.display()));
        let pick = PartPick {
            part,
            instance,
            partial,
        };
        py.detach(|| {
            let mut read = read_part(&bytes, &pick).map_err(|error| wrong(error.to_string()))?;
            let made = read
                .part(partial)
                .map_err(|error| wrong(error.to_string()))?;
            Ok(Self {
                measure: made.measure(),
                left_out: match read.left_out.is_nothing() {
                    true => String::new(),
                    false => read.left_out.to_string(),
                },
                notes: read.notes,
                inner: Arc::new(made),
            })
        })
    }

    /// Of each face: what it lies on and its area, m².
    #[getter]
    fn faces(&self) -> Vec<(&'static str, f64)> {
        let names = self.inner.faces().map(|face| face.carrier.name());
        names
            .zip(self.measure.face_areas_m2.iter().copied())
            .collect()
    }

    /// Of all faces, m².
    #[getter]
    fn area(&self) -> f64 {
        self.measure.area_m2
    }

    /// m³, or None where the part has no inside.
    #[getter]
    fn volume(&self) -> Option<f64> {
        self.measure.volume_m3
    }

    /// How far edges are from their faces at most, m.
    #[getter]
    fn gap(&self) -> f64 {
        self.inner.gap_m()
    }

    /// Diagonal of a box around it, m.
    #[getter]
    fn size(&self) -> f64 {
        self.inner.size_m()
    }

    /// Whether it has an inside.
    #[getter]
    fn closed(&self) -> bool {
        self.inner.is_closed()
    }

    /// How many faces are turned: their sense, or the direction of their loops, is wrong in the file.
    #[getter]
    fn turned(&self) -> usize {
        self.inner.turned_faces()
    }

    /// What the file says and the part has not; empty if nothing.
    #[getter]
    fn left_out(&self) -> &str {
        &self.left_out
    }

    /// What was taken otherwise than the file says.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// Closest points, an array of dtype PART_CLOSEST.
    ///
    /// Parameters
    /// ----------
    /// points : array (…, 3)
    ///     m.
    /// workers : int, optional
    ///     Threads; by default one per core. Results do not depend on it.
    #[pyo3(signature = (points, *, workers=None))]
    fn closest<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        workers: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (queries, shape) = self::points(points, "points")?;
        let workers = workers.unwrap_or_else(cores).clamp(1, queries.len().max(1));
        let rows = py.detach(|| rows(&self.inner, &queries, workers));
        structured(py, "PART_CLOSEST", &rows, &shape)
    }

    /// Triangles: points (n, 3) m, unit normals (n, 3), triangles (m, 3) of indices.
    #[pyo3(signature = (tolerance=None))]
    fn _tessellate<'py>(
        &self,
        py: Python<'py>,
        tolerance: Option<f64>,
    ) -> PyResult<MeshArrays<'py>> {
        let tolerance_m = tolerance.unwrap_or(DEFAULT_TOLERANCE * self.inner.size_m());
        let made = py.detach(|| self.inner.triangles(tolerance_m, MOST_TRIANGLES));
        mesh_arrays(py, &made.map_err(surface_error)?.mesh)
    }

    /// Triangles within a tolerance (m; by default 1e-3 of the size), closed where the part is.
    #[pyo3(signature = (tolerance=None))]
    fn tessellate<'py>(
        slf: &Bound<'py, Self>,
        tolerance: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        python(
            slf.py(),
            "palpate._surfaces",
            "_part_mesh",
            (slf, tolerance),
        )
    }

    fn __repr__(&self) -> String {
        format!(
            "Part({} faces, {} edges, {})",
            self.inner.faces().len(),
            self.inner.edge_count(),
            if self.inner.is_closed() {
                "closed"
            } else {
                "open"
            }
        )
    }
}

/// A row of bytes for each query; which thread makes it does not matter to its bits.
fn rows(part: &part::Part, queries: &[Point3], workers: usize) -> Vec<u8> {
    let mut rows = vec![0_u8; queries.len() * ROW];
    let share = queries.len().div_ceil(workers).max(1);
    std::thread::scope(|scope| {
        for (queries, rows) in queries.chunks(share).zip(rows.chunks_mut(share * ROW)) {
            scope.spawn(move || {
                let mut solver = PartSolver::new(part);
                for (query, row) in queries.iter().zip(rows.chunks_exact_mut(ROW)) {
                    write(&mut solver, part, query, row);
                }
            });
        }
    });
    rows
}

fn write(solver: &mut PartSolver, part: &part::Part, query: &Point3, row: &mut [u8]) {
    let Some(foot) = solver.closest(part, query) else {
        row[..64]
            .chunks_exact_mut(8)
            .for_each(|x| x.copy_from_slice(&f64::NAN.to_ne_bytes()));
        return;
    };
    let (p, n) = (foot.point, foot.normal);
    let signed = foot.signed_distance.unwrap_or(f64::NAN);
    let values = [p.x, p.y, p.z, n.x, n.y, n.z, foot.distance, signed];
    for (bytes, value) in row.chunks_exact_mut(8).zip(values) {
        bytes.copy_from_slice(&value.to_ne_bytes());
    }
    let kind = match foot.support {
        Support::Face(_) => 0_u32,
        Support::Edge(_) => 1,
        Support::Vertex(_) => 2,
    };
    let numbers = [kind, foot.support.index(), foot.face];
    for (bytes, value) in row[64..].chunks_exact_mut(4).zip(numbers) {
        bytes.copy_from_slice(&value.to_ne_bytes());
    }
}
