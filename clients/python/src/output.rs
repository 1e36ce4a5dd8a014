//! What comes out of a tick.

use crate::built::Built;
use crate::values::{python, structured};
use numpy::PyArray1;
use palpate_geometry::math::Vector3;
use palpate_sim::solve::rows::Holder;
use palpate_sim::tick::explain::Explanation;
use palpate_sim::tick::quantity::{MOST_COMPONENTS, Quantity, Read};
use palpate_sim::tick::record::{ContactReport, TickOutput};
use pyo3::exceptions::{PyAttributeError, PyKeyError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyList};
use std::sync::Arc;

/// What one tick gives: forces for the devices, contacts, the hash of the state.
///
/// `force["ball"]` and the like are new arrays: they stay as they are when the simulation goes on.
#[pyclass(frozen, module = "palpate")]
pub struct Output {
    tick: TickOutput,
    built: Arc<Built>,
    explanation: Option<Explanation>,
}

impl Output {
    /// A copy of a tick's output.
    pub fn of(tick: &TickOutput, built: &Arc<Built>) -> Self {
        Self {
            tick: tick.clone(),
            built: built.clone(),
            explanation: None,
        }
    }

    /// An output with the explanation of its forces.
    pub fn explained(self, explanation: Option<Explanation>) -> Self {
        Self {
            explanation,
            ..self
        }
    }
}

fn by_tool(slf: &Bound<'_, Output>, name: &str) -> PyResult<ByTool> {
    let quantity = Quantity::named(name).filter(|quantity| !quantity.is_of_pose());
    let unknown = || PyAttributeError::new_err(format!("an output has no {name:?}"));
    Ok(ByTool {
        output: slf.clone().unbind(),
        quantity: quantity.ok_or_else(unknown)?,
    })
}

#[pymethods]
impl Output {
    /// Number of the tick, from 1.
    #[getter]
    fn tick(&self) -> u64 {
        self.tick.tick
    }

    /// Hash of the whole state after the tick: equal hashes are equal states, as in recordings.
    #[getter]
    fn hash(&self) -> u64 {
        self.tick.state_hash
    }

    /// By tool: force for the device, (3,) N, world axes.
    #[getter]
    fn force(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "force")
    }

    /// By tool: how far that force may be from the one that the exact step of the same length would give, N: an
    /// estimate, 0 on rigid bodies.
    #[getter]
    fn error_n(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "error_n")
    }

    /// By tool: torque for the device at the tool's reference point, (3,) N·m.
    #[getter]
    fn torque(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "torque")
    }

    /// By tool: force of all contacts, (3,) N, neither damped nor limited for the device.
    #[getter]
    fn contact_force(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "contact_force")
    }

    /// By tool: torque of all contacts about the tool's reference point, (3,) N·m.
    #[getter]
    fn contact_torque(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "contact_torque")
    }

    /// By tool: penetration of the device's tool, m; 0 without contact.
    #[getter]
    fn depth(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "depth")
    }

    /// By tool: where the surface holds the tool back, (7,): position in m, quaternion x y z w.
    #[getter]
    fn proxy(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "proxy")
    }

    /// By tool: net work of the device on the loop since the start, J.
    #[getter]
    fn energy(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "energy")
    }

    /// By tool: the part of the energy that the passivity controller took away, J.
    #[getter]
    fn dissipated(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "dissipated")
    }

    /// By tool: bits of `ForceFlags`.
    #[getter]
    fn flags(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "flags")
    }

    /// By tool: number of the pose that the tick answers.
    #[getter]
    fn pose_seq(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "pose_seq")
    }

    /// By tool: contacts that carried force.
    #[getter]
    fn contact_count(slf: &Bound<'_, Self>) -> PyResult<ByTool> {
        by_tool(slf, "contact_count")
    }

    /// Any other quantity of tools by its name, as recordings have it.
    fn __getattr__(slf: &Bound<'_, Self>, name: &str) -> PyResult<ByTool> {
        by_tool(slf, name)
    }

    /// Contacts that carry force, deepest first: structured array (contacts,) of dtype `CONTACT`.
    /// At most 16, or 2 for each tool where that is more.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut rows = Vec::new();
        self.tick
            .contacts
            .list()
            .iter()
            .for_each(|contact| push_contact(&mut rows, contact));
        structured(py, "CONTACT", &rows, &[self.tick.contacts.list().len()])
    }

    /// Why the forces are what they are, after `step(…, explain=True)`, else None: a dictionary with `rows`
    /// (`gap_m`, `gap_free_m`, `compliance_m_per_n` by party and in sum, `force_n`, `residual_m`), `bodies`
    /// (`residual_n`: what the step leaves of its own equation), `solve` (`direct_steps`, `left`) and `tools`. Of one row alone,
    /// -`gap_free_m` over the compliance is the force.
    #[getter]
    fn explain<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(explanation) = &self.explanation else {
            return Ok(None);
        };
        let text = serde_json::to_string(explanation).map_err(crate::errors::internal)?;
        python(py, "json", "loads", (text,)).map(Some)
    }

    /// A force or a state was not finite in this tick; forces were made safe.
    #[getter]
    fn fault(&self) -> bool {
        self.tick.fault.is_some()
    }

    fn __repr__(&self) -> String {
        let tools = self.built.tool_ids();
        let forces = tools.iter().enumerate().map(|(t, id)| {
            let f = self.tick.tools[t].force_n;
            format!("{id}: ({:.3}, {:.3}, {:.3}) N", f.x, f.y, f.z)
        });
        format!(
            "Output(tick={}, {})",
            self.tick.tick,
            forces.collect::<Vec<_>>().join(", ")
        )
    }
}

/// The bytes of a row of dtype `CONTACT`.
pub fn push_contact(rows: &mut Vec<u8>, contact: &ContactReport) {
    let (tool, other) = match contact.holder {
        Holder::Tool(tool) => (tool as i32, -1),
        Holder::Body(body) => (-1, body as i32),
    };
    for index in [tool, contact.body as i32, other, 0] {
        rows.extend_from_slice(&index.to_ne_bytes());
    }
    let (normal, force) = (contact.normal, contact.force_n);
    let pressing_n = force.dot(&normal);
    let friction: Vector3 = force - normal * pressing_n;
    let numbers = [
        &[contact.u, contact.v][..],
        contact.point.coords.as_slice(),
        normal.as_slice(),
        &[contact.depth_m],
        force.as_slice(),
        &[pressing_n],
        friction.as_slice(),
    ];
    for x in numbers.into_iter().flatten() {
        rows.extend_from_slice(&x.to_ne_bytes());
    }
}

/// A value of each tool, read like a dictionary.
#[pyclass(frozen, mapping, module = "palpate")]
pub struct ByTool {
    output: Py<Output>,
    quantity: &'static Quantity,
}

impl ByTool {
    fn at<'py>(&self, py: Python<'py>, tool: usize) -> Bound<'py, PyAny> {
        let output = &self.output.get().tick.tools[tool];
        if let Read::Whole(read) = self.quantity.read {
            return PyInt::new(py, read(output)).into_any();
        }
        let mut row = Vec::with_capacity(MOST_COMPONENTS);
        self.quantity.push(&output.into(), &mut row);
        match row[..] {
            [x] => PyFloat::new(py, x).into_any(),
            _ => PyArray1::from_vec(py, row).into_any(),
        }
    }
}

#[pymethods]
impl ByTool {
    fn __getitem__<'py>(&self, py: Python<'py>, tool: &str) -> PyResult<Bound<'py, PyAny>> {
        let index = self.output.get().built.tool(tool)?;
        Ok(self.at(py, index))
    }

    fn __len__(&self) -> usize {
        self.output.get().built.scene.tool_count()
    }

    fn __contains__(&self, tool: &str) -> bool {
        self.output.get().built.scene.tool_index(tool).is_some()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, pyo3::types::PyIterator>> {
        PyList::new(py, self.keys())?.try_iter()
    }

    /// Ids of the tools.
    fn keys(&self) -> Vec<String> {
        self.output.get().built.tool_ids()
    }

    /// Values, by index of the tool.
    fn values<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyAny>> {
        (0..self.__len__()).map(|tool| self.at(py, tool)).collect()
    }

    /// Pairs of id and value.
    fn items<'py>(&self, py: Python<'py>) -> Vec<(String, Bound<'py, PyAny>)> {
        self.keys().into_iter().zip(self.values(py)).collect()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let each = self
            .items(py)
            .into_iter()
            .map(|(id, value)| Ok(format!("{id:?}: {}", value.repr()?)));
        Ok(format!(
            "{{{}}}",
            each.collect::<PyResult<Vec<_>>>()?.join(", ")
        ))
    }

    #[pyo3(signature = (tool, default=None))]
    /// The value of a tool, or `default` where there is no such tool.
    fn get<'py>(
        &self,
        py: Python<'py>,
        tool: &str,
        default: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        match self.__getitem__(py, tool) {
            Ok(value) => Ok(Some(value)),
            Err(error) if error.is_instance_of::<PyKeyError>(py) => Ok(default),
            Err(error) => Err(error),
        }
    }
}
