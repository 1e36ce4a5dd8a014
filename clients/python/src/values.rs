//! Numbers and arrays in and out.

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use palpate_geometry::math::{MOST_COORDINATE_M, Point3};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyByteArray, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

/// An argument by its name, of those that a wrapper hands over together.
pub fn keyword<'py, T: FromPyObjectOwned<'py>>(
    given: &Bound<'py, PyDict>,
    name: &str,
) -> PyResult<T> {
    let value = given.as_any().get_item(name)?;
    value.extract::<T>().map_err(|error| {
        let error: PyErr = error.into();
        let words = format!("argument '{name}': {}", error.value(given.py()));
        PyErr::from_type(error.get_type(given.py()), words)
    })
}

/// Numbers of any shape as a C-contiguous array of float64; copies only where it must. Refuses
/// what would lose something: text, complex numbers, objects.
pub fn array<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    if let Ok(array) = value.cast::<PyArrayDyn<f64>>()
        && array.is_c_contiguous()
    {
        return array
            .try_readonly()
            .map_err(|e| PyValueError::new_err(format!("{name}: {e}")));
    }
    let numpy = value.py().import("numpy")?;
    let refused = |_| {
        PyTypeError::new_err(format!(
            "{name} must be numbers; their rows must be equally long"
        ))
    };
    let array = numpy.call_method1("asarray", (value,)).map_err(refused)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !"fiu".contains(&kind) {
        let dtype = array.getattr("dtype")?;
        return Err(PyTypeError::new_err(format!(
            "{name} must be real numbers, not {dtype}"
        )));
    }
    let dtype = PyDict::new(value.py());
    dtype.set_item("dtype", "float64")?;
    let array = numpy.call_method("ascontiguousarray", (&array,), Some(&dtype))?;
    let array = array.cast_into::<PyArrayDyn<f64>>()?;
    array
        .try_readonly()
        .map_err(|e| PyValueError::new_err(format!("{name}: {e}")))
}

/// The numbers of an array that [`array`] gave.
pub fn slice<'a>(array: &'a PyReadonlyArrayDyn<'_, f64>) -> &'a [f64] {
    array.as_slice().expect("contiguous")
}

/// Refuses what nothing can be calculated with, NaN and infinity among it, with the index of the first.
pub fn finite(values: &[f64], name: &str) -> PyResult<()> {
    let within = |x: &f64| x.abs() <= MOST_COORDINATE_M;
    match values.iter().position(|x| !within(x)) {
        None => Ok(()),
        Some(k) => Err(PyValueError::new_err(format!(
            "{name}: value {k} is {}; it must be finite, within ±{MOST_COORDINATE_M:e}",
            values[k]
        ))),
    }
}

/// `N` finite numbers from a tuple, a list or an array.
pub fn floats<const N: usize>(value: &Bound<'_, PyAny>, name: &str) -> PyResult<[f64; N]> {
    let wrong =
        |what: String| PyValueError::new_err(format!("{name} must be {N} numbers, not {what}"));
    let plain = value.is_instance_of::<PyTuple>() || value.is_instance_of::<PyList>();
    let numbers: [f64; N] = match plain.then(|| value.extract::<[f64; N]>()) {
        Some(Ok(numbers)) => numbers,
        _ => {
            let array = array(value, name)?;
            if array.shape() != [N] {
                return Err(wrong(format!(
                    "an array of shape {}",
                    shape_text(array.shape())
                )));
            }
            slice(&array)
                .try_into()
                .map_err(|_| wrong("another number".into()))?
        }
    };
    finite(&numbers, name).map(|()| numbers)
}

/// As Python writes it.
pub fn shape_text(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        many => format!(
            "({})",
            many.iter()
                .map(usize::to_string)
                .collect::<Vec<_>>()
                .join(", ")
        ),
    }
}

/// Points of an array of shape (…, 3), and the shape without its last number.
pub fn points(value: &Bound<'_, PyAny>, name: &str) -> PyResult<(Vec<Point3>, Vec<usize>)> {
    let array = array(value, name)?;
    let Some((3, shape)) = array.shape().split_last() else {
        let shape = shape_text(array.shape());
        return Err(PyValueError::new_err(format!(
            "{name} must have the shape (…, 3), not {shape}"
        )));
    };
    finite(slice(&array), name)?;
    let points = slice(&array)
        .chunks_exact(3)
        .map(|p| Point3::new(p[0], p[1], p[2]));
    Ok((points.collect(), shape.to_vec()))
}

/// x y z of each point, one after the other.
pub fn flat(points: &[Point3]) -> Vec<f64> {
    points.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}

/// A new array of this shape.
pub fn shaped<'py>(
    py: Python<'py>,
    values: Vec<f64>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    PyArray1::from_vec(py, values).reshape(shape.to_vec())
}

/// A structured array: `dtype` is a name in `palpate._dtypes`, `rows` the bytes of its rows.
pub fn structured<'py>(
    py: Python<'py>,
    dtype: &'static str,
    rows: &[u8],
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    static FROMBUFFER: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    static DTYPES: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let frombuffer = FROMBUFFER.get_or_try_init(py, || {
        Ok::<_, PyErr>(py.import("numpy")?.getattr("frombuffer")?.unbind())
    })?;
    let dtypes = DTYPES.get_or_try_init(py, || {
        Ok::<_, PyErr>(py.import("palpate._dtypes")?.into_any().unbind())
    })?;
    let dtype = dtypes.bind(py).getattr(dtype)?;
    if rows.is_empty() {
        return py
            .import("numpy")?
            .call_method1("zeros", (shape.to_vec(), dtype));
    }
    let array = frombuffer
        .bind(py)
        .call1((PyByteArray::new(py, rows), dtype))?;
    if shape.len() == 1 {
        Ok(array)
    } else {
        array.call_method1("reshape", (shape.to_vec(),))
    }
}

/// Calls a function of a Python module of this package.
pub fn python<'py, A: pyo3::call::PyCallArgs<'py>>(
    py: Python<'py>,
    module: &str,
    function: &str,
    arguments: A,
) -> PyResult<Bound<'py, PyAny>> {
    py.import(module)?.getattr(function)?.call1(arguments)
}

/// True when somebody beside us holds the object.
#[allow(deprecated)] // Its successor is unsafe, and this workspace has no unsafe code.
pub fn is_watched<T>(py: Python<'_>, object: &Py<T>) -> bool {
    object.get_refcnt(py) > 1
}

/// Values of a scene file from Python's: numbers, text, booleans, lists, arrays, dictionaries,
/// paths. Keys whose value is `None` are left out.
pub fn toml_value(value: &Bound<'_, PyAny>, path: &str) -> PyResult<toml::Value> {
    use toml::Value;
    if value.is_instance_of::<pyo3::types::PyBool>() {
        return Ok(Value::Boolean(value.extract()?));
    }
    if value.is_instance_of::<PyInt>() {
        let wrong =
            |_| PyValueError::new_err(format!("{path} is {value}, which no 64-bit integer holds"));
        return value.extract().map(Value::Integer).map_err(wrong);
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(Value::Float(value.extract()?));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_string()));
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        let mut table = toml::Table::new();
        for (key, value) in dict.iter().filter(|(_, value)| !value.is_none()) {
            let key = key.cast::<PyString>().map_err(|_| {
                PyTypeError::new_err(format!("{path}: the key {key} is not a string"))
            })?;
            let inside = if path.is_empty() {
                key.to_string()
            } else {
                format!("{path}.{key}")
            };
            table.insert(key.to_string(), toml_value(&value, &inside)?);
        }
        return Ok(Value::Table(table));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let mut list = Vec::new();
        for (k, item) in value.try_iter()?.enumerate() {
            list.push(toml_value(&item?, &format!("{path}[{k}]"))?);
        }
        return Ok(Value::Array(list));
    }
    // NumPy's numbers and arrays, and paths.
    if let Ok(plain) = value.call_method0("tolist") {
        return toml_value(&plain, path);
    }
    if let Ok(text) = value.call_method0("__fspath__") {
        return toml_value(&text, path);
    }
    let kind = value.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "{path} is a {kind}; a scene has numbers, strings, booleans, lists and dictionaries"
    )))
}

/// The net of a body as an array.
#[cfg(feature = "daemon")]
pub fn net_array<'py>(
    py: Python<'py>,
    points: &[Point3],
    rows: usize,
    columns: usize,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    shaped(py, flat(points), &[rows, columns, 3])
}
