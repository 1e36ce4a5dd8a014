//! B-spline surfaces: evaluation and closest points on arrays, files, triangles.

use crate::closest::{closest_rows, cores};
use crate::errors::{os_error, surface_error};
use crate::values::{
    array, finite, flat, floats, points, python, shape_text, shaped, slice, structured,
};
use numpy::{PyArray2, PyArrayDyn, PyUntypedArrayMethods};
use palpate_geometry::basis::KnotVector;
use palpate_geometry::exchange::{
    ExchangeError, Format, Pick, read_surface, write_mesh, write_surface,
};
use palpate_geometry::math::{Matrix3, Vector3};
use palpate_geometry::surface::file::Unit;
use palpate_geometry::surface::{
    self, ClosestSolver, ControlNet, Direction, Mesh, SurfaceError, builtin,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyTuple};
use std::path::PathBuf;
use std::sync::Arc;

/// An array of float64.
type Floats<'py> = Bound<'py, PyArrayDyn<f64>>;

/// Chord tolerance of triangles where none is given, relative to the surface's size.
const DEFAULT_TOLERANCE: f64 = 1e-3;
/// A tensor-product B-spline or NURBS surface; constant.
///
/// Parameters
/// ----------
/// degree : tuple of 2 ints
///     Degrees in u and v, 1 to 15.
/// knots : tuple of 2 sequences of floats
///     In u and v. Clamped or open: all `count + degree + 1`; periodic: one period of `count + 1`.
/// points : array (nu, nv, 3)
///     Control points, m.
/// weights : array (nu, nv), optional
///     Weights of a NURBS surface, above 0.
/// periodic : tuple of 2 bools
///     Directions that are closed.
/// flip_normal : bool
///     The outward side is that of `-(S_u × S_v)`.
///
/// Raises
/// ------
/// SurfaceError
///     Knots, net and weights that do not fit together, or knots that differ in their last digits.
#[pyclass(frozen, module = "palpate")]
#[derive(Clone)]
pub struct Surface {
    /// The surface, m.
    pub inner: Arc<surface::Surface>,
}

impl Surface {
    /// Wraps one.
    pub fn of(inner: surface::Surface) -> Self {
        Self {
            inner: Arc::new(inner),
        }
    }

    fn parameters(
        &self,
        value: &Bound<'_, PyAny>,
        direction: char,
    ) -> PyResult<(Vec<f64>, Vec<usize>)> {
        let name = direction.to_string();
        let array = array(value, &name)?;
        let values = slice(&array);
        finite(values, &name)?;
        let knots = if direction == 'u' {
            self.inner.knots_u()
        } else {
            self.inner.knots_v()
        };
        let checked = values.iter().enumerate().map(|(k, &x)| {
            knots
                .checked(x)
                .map_err(|error| surface_error(format!("{direction}[{k}]: {error}")))
        });
        Ok((checked.collect::<PyResult<_>>()?, array.shape().to_vec()))
    }
}

fn unit_of(unit: &str) -> PyResult<Unit> {
    match unit {
        "m" => Ok(Unit::Metre),
        "mm" => Ok(Unit::Millimetre),
        _ => Err(PyValueError::new_err(format!(
            "unit {unit:?} is not known; use \"m\" or \"mm\""
        ))),
    }
}

/// u or v.
pub fn direction_of(name: &str) -> PyResult<Direction> {
    match name {
        "u" => Ok(Direction::U),
        "v" => Ok(Direction::V),
        _ => Err(PyValueError::new_err(format!(
            "direction {name:?} is not known; use \"u\" or \"v\""
        ))),
    }
}

/// Points (n, 3), normals (n, 3), triangles (m, 3).
pub type MeshArrays<'py> = (Floats<'py>, Floats<'py>, Bound<'py, PyArray2<u32>>);

/// Triangles as arrays.
pub fn mesh_arrays<'py>(py: Python<'py>, mesh: &Mesh) -> PyResult<MeshArrays<'py>> {
    let normals: Vec<f64> = mesh.normals.iter().flat_map(|n| [n.x, n.y, n.z]).collect();
    let count = mesh.points.len();
    let triangles: Vec<Vec<u32>> = mesh.triangles.iter().map(|t| t.to_vec()).collect();
    Ok((
        shaped(py, flat(&mesh.points), &[count, 3])?,
        shaped(py, normals, &[count, 3])?,
        PyArray2::from_vec2(py, &triangles).map_err(crate::errors::internal)?,
    ))
}

/// Bytes of a file, or Python's error for it.
pub fn read_file(path: &PathBuf) -> PyResult<Vec<u8>> {
    std::fs::read(path).map_err(|error| os_error(path, &error))
}

#[pymethods]
impl Surface {
    #[new]
    #[pyo3(signature = (degree, knots, points, weights=None, *, periodic=(false, false), flip_normal=false))]
    fn new(
        degree: (usize, usize),
        knots: (Bound<'_, PyAny>, Bound<'_, PyAny>),
        points: &Bound<'_, PyAny>,
        weights: Option<&Bound<'_, PyAny>>,
        periodic: (bool, bool),
        flip_normal: bool,
    ) -> PyResult<Self> {
        let vector = |degree: usize, knots: &Bound<'_, PyAny>, periodic: bool, direction: char| {
            let array = array(knots, &format!("knots in {direction}"))?;
            let knots = slice(&array).to_vec();
            let vector = if periodic {
                KnotVector::periodic(degree, knots)
            } else {
                KnotVector::new(degree, knots)
            };
            vector.map_err(|source| surface_error(SurfaceError::Knots { direction, source }))
        };
        let (u, v) = (
            vector(degree.0, &knots.0, periodic.0, 'u')?,
            vector(degree.1, &knots.1, periodic.1, 'v')?,
        );
        let (list, shape) = self::points(points, "points")?;
        let [rows, columns] = shape[..] else {
            let shape = shape_text(&[&shape[..], &[3]].concat());
            return Err(PyValueError::new_err(format!(
                "points have the shape {shape}; (nu, nv, 3) is needed"
            )));
        };
        let net = ControlNet::new(rows, columns, list).map_err(surface_error)?;
        let weights = match weights {
            None => None,
            Some(weights) => {
                let array = array(weights, "weights")?;
                if array.shape() != [rows, columns] {
                    let shape = shape_text(array.shape());
                    return Err(PyValueError::new_err(format!(
                        "weights have the shape {shape}; ({rows}, {columns}) is needed"
                    )));
                }
                Some(slice(&array).to_vec())
            }
        };
        let made = surface::Surface::new(u, v, net, weights).and_then(surface::Surface::loaded);
        let made = made.map_err(surface_error)?.surface;
        Ok(Self::of(made.with_flip_normal(flip_normal)))
    }

    /// A built-in surface: `sheet`, `sphere`, `teardrop` or `torus`.
    ///
    /// Parameters
    /// ----------
    /// net : tuple of 2 ints, optional
    ///     Control points in u and v.
    /// size : float, optional
    ///     m; of a sphere its radius.
    #[staticmethod]
    #[pyo3(name = "builtin", signature = (name, net=None, size=None))]
    fn built_in(name: &str, net: Option<[usize; 2]>, size: Option<f64>) -> PyResult<Self> {
        builtin(name, net, size)
            .map(Self::of)
            .map_err(surface_error)
    }

    /// All surfaces of a file: .json, .step, .stp, .iges, .igs. Lengths become metres.
    ///
    /// Parameters
    /// ----------
    /// ignore_trims : bool
    ///     Takes surfaces whole of which the file shows a part, or that stand among other faces, which is an error
    ///     otherwise. `Part.load` takes STEP files as they are.
    ///
    /// Raises
    /// ------
    /// SurfaceError
    ///     What is wrong with the file, and where.
    #[staticmethod]
    #[pyo3(signature = (path, *, ignore_trims=false))]
    fn load(py: Python<'_>, path: PathBuf, ignore_trims: bool) -> PyResult<Vec<Self>> {
        let wrong = |error: ExchangeError| surface_error(format!("{}: {error}", path.display()));
        let format = Format::of(&path).map_err(wrong)?;
        let bytes = read_file(&path)?;
        py.detach(|| {
            let (mut all, mut count) = (Vec::new(), 1);
            while all.len() < count {
                let pick = Pick::Index(all.len());
                let read = read_surface(&bytes, format, pick).map_err(wrong)?;
                if read.left_out.is_any() && !ignore_trims {
                    return Err(surface_error(format!(
                        "{}: {} would be left out; `Part.load` takes a STEP file as it is, \
                         ignore_trims=True its B-splines whole",
                        path.display(),
                        read.left_out
                    )));
                }
                count = read.count;
                all.push(Self::of(read.surface));
            }
            Ok(all)
        })
    }

    /// Writes a file; its ending decides the format: .json, .step, .iges.
    #[pyo3(signature = (path, unit="m"))]
    fn save(&self, path: PathBuf, unit: &str) -> PyResult<()> {
        let wrong = |error: ExchangeError| surface_error(format!("{}: {error}", path.display()));
        let format = Format::of(&path).map_err(wrong)?;
        let bytes = write_surface(&self.inner, format, unit_of(unit)?).map_err(wrong)?;
        std::fs::write(&path, bytes).map_err(|error| os_error(&path, &error))
    }

    /// Degrees in u and v.
    #[getter]
    fn degree(&self) -> (usize, usize) {
        (self.inner.knots_u().degree(), self.inner.knots_v().degree())
    }

    /// Knots in u and v, as files have them: of a periodic direction one period.
    #[getter]
    fn knots<'py>(&self, py: Python<'py>) -> PyResult<(Floats<'py>, Floats<'py>)> {
        let array = |knots: &KnotVector| {
            let knots = knots.file_knots().to_vec();
            let count = knots.len();
            shaped(py, knots, &[count])
        };
        Ok((array(self.inner.knots_u())?, array(self.inner.knots_v())?))
    }

    /// Which of u and v are periodic.
    #[getter]
    fn periodic(&self) -> (bool, bool) {
        (
            self.inner.knots_u().is_periodic(),
            self.inner.knots_v().is_periodic(),
        )
    }

    /// First and last parameter, of u and of v.
    #[getter]
    fn domain(&self) -> ((f64, f64), (f64, f64)) {
        (self.inner.knots_u().domain(), self.inner.knots_v().domain())
    }

    /// The control net, (nu, nv, 3) m; a copy.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Floats<'py>> {
        let net = self.inner.net();
        shaped(py, flat(net.points()), &[net.rows(), net.columns(), 3])
    }

    /// (nu, nv), or None where the surface is not rational.
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Option<Floats<'py>>> {
        let net = self.inner.net();
        let weights = self.inner.weights();
        weights
            .map(|weights| shaped(py, weights.to_vec(), &[net.rows(), net.columns()]))
            .transpose()
    }

    /// The outward side is that of `-(S_u × S_v)`.
    #[getter]
    fn flip_normal(&self) -> bool {
        self.inner.flip_normal()
    }

    /// True when it bounds a solid.
    #[getter]
    fn closed(&self) -> bool {
        self.inner.topology().is_closed()
    }

    /// Diagonal of the box around the control points, m.
    #[getter]
    fn size(&self) -> f64 {
        self.inner.size()
    }

    /// m².
    fn area(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.inner.area())
    }

    /// m³; of a closed surface.
    fn volume(&self, py: Python<'_>) -> f64 {
        py.detach(|| self.inner.volume())
    }

    /// Centre of mass of the solid, or of the sheet where it is open, m; None without extent.
    fn centroid(&self, py: Python<'_>) -> Option<[f64; 3]> {
        py.detach(|| self.inner.centroid()).map(|p| [p.x, p.y, p.z])
    }

    /// Points of the surface, and derivatives.
    ///
    /// Parameters
    /// ----------
    /// u, v : float or array
    ///     Parameters inside the domain, broadcast against each other.
    /// derivatives : int
    ///     0: points only; 1 or 2: derivatives up to that order as well.
    ///
    /// Returns
    /// -------
    /// array (…, 3) or Derivatives
    ///     Points, m; with derivatives a named tuple `point`, `du`, `dv`, `duu`, `duv`, `dvv`, where
    ///     those that were not asked for are None.
    #[pyo3(signature = (u, v, derivatives=0))]
    fn evaluate<'py>(
        slf: &Bound<'py, Self>,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        derivatives: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        python(
            slf.py(),
            "palpate._surfaces",
            "_evaluate",
            (slf, u, v, derivatives),
        )
    }

    /// Unit outward normals (…, 3) at parameters that are broadcast against each other.
    fn normal<'py>(
        slf: &Bound<'py, Self>,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        python(slf.py(), "palpate._surfaces", "_normal", (slf, u, v))
    }

    /// Principal curvatures (…, 2), greater first, 1/m; positive where the surface bends away from its
    /// outward normal, NaN where they are not defined.
    fn curvature<'py>(
        slf: &Bound<'py, Self>,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        python(slf.py(), "palpate._surfaces", "_curvature", (slf, u, v))
    }

    /// Triangles: a `Mesh`.
    ///
    /// Parameters
    /// ----------
    /// tolerance : float, optional
    ///     Largest distance of the surface from its triangles, m; by default a thousandth of its
    ///     size.
    /// cells : int, optional
    ///     Instead: cells per knot span in u and in v.
    #[pyo3(signature = (tolerance=None, cells=None))]
    fn tessellate<'py>(
        slf: &Bound<'py, Self>,
        tolerance: Option<f64>,
        cells: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        python(
            slf.py(),
            "palpate._surfaces",
            "_tessellate",
            (slf, tolerance, cells),
        )
    }

    /// Joins this surface with others into one: `palpate.merge([self, *others], **options)`.
    #[pyo3(signature = (*others, **options))]
    fn merge<'py>(
        slf: &Bound<'py, Self>,
        others: &Bound<'py, PyTuple>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let all = PyList::new(slf.py(), [slf])?;
        others.iter().try_for_each(|other| all.append(other))?;
        slf.py()
            .import("palpate._surfaces")?
            .call_method("merge", (all,), options)
    }

    /// S, and its derivatives up to `order` (0 to 2), at parameters of one shape (…): arrays (…, 3)
    /// in the order S, S_u, S_v, S_uu, S_uv, S_vv.
    fn _evaluate<'py>(
        &self,
        py: Python<'py>,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
        order: usize,
    ) -> PyResult<Vec<Floats<'py>>> {
        let ((u, shape), (v, other)) = (self.parameters(u, 'u')?, self.parameters(v, 'v')?);
        debug_assert_eq!(shape, other, "broadcast before");
        let count = [1, 3, 6].get(order).copied();
        let Some(count) = count.filter(|_| u.len() == v.len()) else {
            return Err(PyValueError::new_err(
                "derivatives must be 0, 1 or 2, and u and v of one shape",
            ));
        };
        let values = py.detach(|| {
            let mut values = vec![Vec::with_capacity(3 * u.len()); count];
            for (&u, &v) in u.iter().zip(&v) {
                if count == 1 {
                    values[0].extend_from_slice(self.inner.point(u, v).coords.as_slice());
                    continue;
                }
                let frame = self.inner.frame(u, v);
                let all = [
                    frame.point.coords,
                    frame.du,
                    frame.dv,
                    frame.duu,
                    frame.duv,
                    frame.dvv,
                ];
                for (values, vector) in values.iter_mut().zip(all) {
                    values.extend_from_slice(vector.as_slice());
                }
            }
            values
        });
        let shape = [&shape[..], &[3]].concat();
        values
            .into_iter()
            .map(|values| shaped(py, values, &shape))
            .collect()
    }

    /// Unit outward normals (…, 3) at parameters of one shape (…).
    fn _normal<'py>(
        &self,
        py: Python<'py>,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Floats<'py>> {
        let ((u, shape), (v, _)) = (self.parameters(u, 'u')?, self.parameters(v, 'v')?);
        let values: Vec<f64> = py.detach(|| {
            let normals = u.iter().zip(&v).map(|(&u, &v)| self.inner.normal(u, v));
            normals.flat_map(|n| [n.x, n.y, n.z]).collect()
        });
        shaped(py, values, &[&shape[..], &[3]].concat())
    }

    /// The global, certified closest points: a structured array of dtype `CLOSEST` with the fields
    /// `u`, `v`, `point` (m), `normal` (outward unit), `distance` (m), `signed_distance` (m, negative
    /// inside) and `curvature` (the two principal ones, 1/m; NaN where they are not defined).
    ///
    /// Parameters
    /// ----------
    /// points : array (…, 3)
    ///     m.
    /// curvature : bool
    ///     False leaves the curvature NaN, which saves a little time.
    /// workers : int, optional
    ///     Threads; by default one per core. Results do not depend on it.
    #[pyo3(signature = (points, *, curvature=true, workers=None))]
    fn closest<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        curvature: bool,
        workers: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (queries, shape) = self::points(points, "points")?;
        let workers = workers.unwrap_or_else(cores).clamp(1, queries.len().max(1));
        let rows = py.detach(|| closest_rows(&self.inner, &queries, curvature, workers));
        structured(py, "CLOSEST", &rows, &shape)
    }

    /// Sum of the distances, m: what [`Surface::closest`] computes without the rows of its result;
    /// `examples/bench.py` compares the two.
    fn _closest_sum(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<f64> {
        let (queries, _) = self::points(points, "points")?;
        Ok(py.detach(|| {
            let mut solver = ClosestSolver::new(&self.inner);
            queries
                .iter()
                .map(|query| solver.closest(&self.inner, query).distance)
                .sum()
        }))
    }

    /// Principal curvatures (…, 2), greater first, 1/m, at parameters of one shape; NaN where they
    /// are not defined.
    fn _curvature<'py>(
        &self,
        py: Python<'py>,
        u: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Floats<'py>> {
        let ((u, shape), (v, _)) = (self.parameters(u, 'u')?, self.parameters(v, 'v')?);
        let values: Vec<f64> = py.detach(|| {
            let each = u.iter().zip(&v).map(|(&u, &v)| self.inner.curvature(u, v));
            each.flat_map(|c| c.map_or([f64::NAN; 2], |c| [c.max, c.min]))
                .collect()
        });
        shaped(py, values, &[&shape[..], &[2]].concat())
    }

    /// Triangles: points (n, 3) m, unit normals (n, 3), triangles (m, 3) of indices,
    /// counter-clockwise seen from outside.
    #[pyo3(signature = (tolerance=None, cells=None))]
    fn _tessellate<'py>(
        &self,
        py: Python<'py>,
        tolerance: Option<f64>,
        cells: Option<usize>,
    ) -> PyResult<MeshArrays<'py>> {
        let mesh = self.mesh(py, tolerance, cells)?;
        mesh_arrays(py, &mesh)
    }

    #[pyo3(signature = (path, tolerance=None, cells=None, unit="m"))]
    /// Writes triangles to a file: .stl, .obj or .glb.
    fn save_mesh(
        &self,
        py: Python<'_>,
        path: PathBuf,
        tolerance: Option<f64>,
        cells: Option<usize>,
        unit: &str,
    ) -> PyResult<()> {
        let wrong = |error: ExchangeError| surface_error(format!("{}: {error}", path.display()));
        let format = Format::of(&path).map_err(wrong)?;
        let bytes =
            write_mesh(&self.mesh(py, tolerance, cells)?, format, unit_of(unit)?).map_err(wrong)?;
        std::fs::write(&path, bytes).map_err(|error| os_error(&path, &error))
    }

    /// The same surface with at least `nu` × `nv` control points (knots are inserted).
    fn refined(&self, nu: usize, nv: usize) -> PyResult<Self> {
        self.inner
            .refined_to(nu, nv)
            .map(Self::of)
            .map_err(surface_error)
    }

    /// The same surface with its degree raised by one in `direction` (`u` or `v`).
    fn elevated(&self, direction: &str) -> PyResult<Self> {
        self.inner
            .elevated(direction_of(direction)?)
            .map(Self::of)
            .map_err(surface_error)
    }

    /// The part between two parameters in `u` and in `v`.
    fn part(&self, u: [f64; 2], v: [f64; 2]) -> PyResult<Self> {
        self.inner
            .sub_surface(u, v)
            .map(Self::of)
            .map_err(surface_error)
    }

    /// `matrix @ point + translation` of every point.
    #[pyo3(signature = (matrix=None, translation=None))]
    fn transformed(
        &self,
        matrix: Option<[[f64; 3]; 3]>,
        translation: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let [a, b, c] = matrix.unwrap_or([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let translation = translation.map_or(Ok([0.0; 3]), |t| floats::<3>(t, "translation"))?;
        let matrix = Matrix3::from_row_slice(&[a, b, c].concat());
        self.inner
            .affine(&matrix, &Vector3::from(translation))
            .map(Self::of)
            .map_err(surface_error)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other
            .cast::<Self>()
            .is_ok_and(|other| other.get().inner == self.inner)
    }

    #[staticmethod]
    fn _of(bytes: &[u8]) -> PyResult<Self> {
        let read = read_surface(bytes, Format::Json, Pick::First).map_err(surface_error)?;
        Ok(Self::of(read.surface))
    }

    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let bytes =
            write_surface(&slf.get().inner, Format::Json, Unit::Metre).map_err(surface_error)?;
        let arguments = (PyBytes::new(slf.py(), &bytes),).into_pyobject(slf.py())?;
        Ok((slf.getattr("_of")?, arguments))
    }

    fn __repr__(&self) -> String {
        let net = self.inner.net();
        let rational = if self.inner.weights().is_some() {
            ", rational"
        } else {
            ""
        };
        let (u, v) = self.degree();
        format!(
            "Surface({} x {} points, degrees {u} x {v}{rational})",
            net.rows(),
            net.columns()
        )
    }
}

impl Surface {
    fn mesh(&self, py: Python<'_>, tolerance: Option<f64>, cells: Option<usize>) -> PyResult<Mesh> {
        py.detach(|| match cells {
            Some(cells) => self.inner.tessellated([cells; 2]),
            None => self
                .inner
                .tessellated_to(tolerance.unwrap_or(DEFAULT_TOLERANCE * self.inner.size())),
        })
        .map_err(surface_error)
    }
}
