//! Scenes.

use std::path::PathBuf;
use std::sync::Arc;

use nalgebra::DVector;
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use tangency::diff::Coordinates;
use tangency::{BodyKind, Parameter, SceneFormat, StateVector};

use crate::arrays::{self, Numbers};
use crate::picture::Corners;
use crate::{errors, picture, state};

/// A checked scene. Never changes: `with_values` makes another one.
#[pyclass(frozen, module = "tangency", weakref)]
pub(crate) struct Scene {
    pub(crate) scene: Arc<tangency::Scene>,
    /// What was changed since it was built, in this order.
    changes: Vec<(String, f64)>,
}

/// What a pickle holds: the definition, and what was changed.
type Kept = (String, Vec<(String, f64)>);

impl Scene {
    fn of(def: &tangency::SceneDef) -> PyResult<Self> {
        let scene = tangency::Scene::new(def).map_err(errors::scene)?;
        Ok(Self { scene: Arc::new(scene), changes: Vec::new() })
    }

    fn changed(&self, values: Vec<(String, f64)>) -> PyResult<Self> {
        let mut scene = (*self.scene).clone();
        for (name, value) in &values {
            let parameter = Parameter::parse(&scene, name).map_err(errors::scene)?;
            parameter.set(&mut scene, *value).map_err(errors::scene)?;
        }
        let changes = self.changes.iter().cloned().chain(values).collect();
        Ok(Self { scene: Arc::new(scene), changes })
    }

    /// The parameters of these names.
    pub(crate) fn parameters(&self, names: &[String]) -> PyResult<Vec<Parameter>> {
        Parameter::parse_all(&self.scene, names).map_err(errors::scene)
    }
}

fn format(name: &str) -> PyResult<SceneFormat> {
    match name {
        "toml" => Ok(SceneFormat::Toml),
        "json" => Ok(SceneFormat::Json),
        _ => Err(PyValueError::new_err(format!("format is {name:?}; give \"toml\" or \"json\""))),
    }
}

#[pymethods]
impl Scene {
    #[new]
    fn new(py: Python<'_>, definition: &Bound<'_, PyAny>) -> PyResult<Self> {
        let module = py.import(intern!(py, "tangency.definitions"))?;
        let text: String = module.call_method1(intern!(py, "to_json"), (definition,))?.extract()?;
        Self::parse(&text, "json")
    }

    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let scene = tangency::load_scene(path).map_err(errors::scene)?;
        Ok(Self { scene: Arc::new(scene), changes: Vec::new() })
    }

    #[staticmethod]
    #[pyo3(signature = (text, format = "toml"))]
    fn parse(text: &str, format: &str) -> PyResult<Self> {
        let format = self::format(format)?;
        Self::of(&tangency::parse_scene(text, format).map_err(errors::scene)?)
    }

    #[pyo3(signature = (format = "json"))]
    fn text(&self, format: &str) -> PyResult<String> {
        Ok(match self::format(format)? {
            SceneFormat::Toml => tangency::scene_to_toml(self.scene.def()),
            SceneFormat::Json => tangency::scene_to_json(self.scene.def()),
        })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.scene.def().name
    }

    #[getter]
    fn description(&self) -> &str {
        &self.scene.def().description
    }

    #[getter]
    fn dt(&self) -> f64 {
        self.scene.dt()
    }

    #[getter]
    fn duration(&self) -> f64 {
        self.scene.def().duration
    }

    /// Steps of a run of the scene's own duration.
    #[getter]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a duration and a step are positive; what is too long ends at the greatest number"
    )]
    pub(crate) fn steps(&self) -> usize {
        (self.scene.def().duration / self.scene.dt()).round() as usize
    }

    #[getter]
    fn bodies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.scene.bodies().iter().map(|body| body.name.as_str()))
    }

    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.scene.joints().iter().map(|joint| joint.name.as_str()))
    }

    #[getter]
    fn controls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.scene.def().controls.iter().map(|control| control.name.as_str()))
    }

    /// Indices of the bodies that forces move.
    #[getter]
    fn dynamic<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, Coordinates::of(&self.scene).bodies())
    }

    fn body(&self, name: &str) -> PyResult<usize> {
        let unknown = || PyKeyError::new_err(format!("the scene has no body {name:?}"));
        self.scene.body_index(name).ok_or_else(unknown)
    }

    fn joint(&self, name: &str) -> PyResult<usize> {
        let unknown = || PyKeyError::new_err(format!("the scene has no joint {name:?}"));
        self.scene.joint_index(name).ok_or_else(unknown)
    }

    #[getter]
    fn initial_state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        state::to_python(py, &self.scene.initial_state())
    }

    fn value(&self, name: &str) -> PyResult<f64> {
        Ok(Parameter::parse(&self.scene, name).map_err(errors::scene)?.value(&self.scene))
    }

    fn with_values(&self, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let pair = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| -> PyResult<_> {
            Ok((name.extract()?, value.extract()?))
        };
        self.changed(values.iter().map(pair).collect::<PyResult<_>>()?)
    }

    #[pyo3(signature = (state = None))]
    fn inspect<'py>(
        &self,
        py: Python<'py>,
        state: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let state = state::from_python(&self.scene, state)?;
        let found = tangency::inspect(&self.scene, &state).map_err(errors::step)?;
        let all = PyDict::new(py);
        all.set_item("dynamic_bodies", found.dynamic_bodies)?;
        all.set_item("other_bodies", found.other_bodies)?;
        all.set_item("free_bodies", &found.free_bodies)?;
        let island = |island: &tangency::IslandInspection| -> PyResult<_> {
            let it = PyDict::new(py);
            it.set_item("bodies", &island.bodies)?;
            let linear = island.path == tangency::Path::Linear;
            it.set_item("path", if linear { "linear" } else { "complementarity" })?;
            it.set_item("equality_rows", island.equality_rows)?;
            it.set_item("motor_rows", island.motor_rows)?;
            it.set_item("limit_rows", island.limit_rows)?;
            it.set_item("contact_rows", island.contact_rows)?;
            it.set_item("friction_rows", island.friction_rows)?;
            Ok(it)
        };
        all.set_item("islands", found.islands.iter().map(island).collect::<PyResult<Vec<_>>>()?)?;
        Ok(all)
    }

    #[pyo3(signature = (state = None))]
    fn energy(&self, state: Option<&Bound<'_, PyAny>>) -> PyResult<f64> {
        Ok(self.scene.energy(&state::from_python(&self.scene, state)?))
    }

    #[pyo3(signature = (state = None))]
    fn momentum<'py>(
        &self,
        py: Python<'py>,
        state: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let found = self.scene.total_momentum(&state::from_python(&self.scene, state)?);
        Ok(arrays::vector(py, &DVector::from_column_slice(found.as_slice())))
    }

    #[pyo3(signature = (state = None))]
    fn joint_drift(&self, state: Option<&Bound<'_, PyAny>>) -> PyResult<f64> {
        Ok(self.scene.joint_drift(&state::from_python(&self.scene, state)?))
    }

    #[pyo3(signature = (state = None))]
    fn penetration(&self, state: Option<&Bound<'_, PyAny>>) -> PyResult<f64> {
        let state = state::from_python(&self.scene, state)?;
        self.scene.penetration(&state).map_err(errors::step)
    }

    /// x = (q, v) of the dynamic bodies.
    #[pyo3(signature = (state = None))]
    fn coordinates<'py>(
        &self,
        py: Python<'py>,
        state: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let state = state::from_python(&self.scene, state)?;
        Ok(arrays::vector(py, &Coordinates::of(&self.scene).of_state(&state)))
    }

    /// The state whose dynamic bodies have these coordinates.
    #[pyo3(signature = (x, state = None))]
    fn at_coordinates<'py>(
        &self,
        py: Python<'py>,
        x: Numbers,
        state: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let coordinates = Coordinates::of(&self.scene);
        x.expect("x", "(6 dynamic bodies,)", &[coordinates.size()])?;
        let mut state = state::from_python(&self.scene, state)?;
        let StateVector { q, v, .. } = coordinates.spread(x.vector().column(0));
        for body in coordinates.bodies() {
            (state.q[*body], state.v[*body]) = (q[*body], v[*body]);
        }
        state::to_python(py, &state)
    }

    /// Masses (kg, kg, kg·m²) per body; zero for those that forces do not move.
    #[getter]
    fn mass<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let of = |body: &tangency::Body| match body.kind {
            BodyKind::Dynamic => body.mass,
            _ => nalgebra::Vector3::zeros(),
        };
        arrays::triples(py, &self.scene.bodies().iter().map(of).collect::<Vec<_>>())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Kept)> {
        let rebuild = py.get_type::<Self>().getattr(intern!(py, "_rebuild"))?;
        Ok((rebuild, (self.text("json")?, self.changes.clone())))
    }

    #[staticmethod]
    fn _rebuild(text: &str, changes: Vec<(String, f64)>) -> PyResult<Self> {
        Self::parse(text, "json")?.changed(changes)
    }

    /// Shapes of every body as in a scene file, in the frames of the centres of mass.
    #[getter]
    fn shapes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let all: Vec<_> = self.scene.colliders().iter().map(|it| it.shapes()).collect();
        let text = serde_json::to_string(&all).map_err(errors::value)?;
        py.import(intern!(py, "json"))?.call_method1(intern!(py, "loads"), (text,))
    }

    /// A picture of a state, the initial one unless given.
    ///
    /// Parameters
    /// ----------
    /// state : State, optional
    ///     What is shown.
    /// width, height : int
    ///     Pixels, 1 to 8000.
    /// view : (float, float, float, float), optional
    ///     What part of the world it holds: x from, to, y from, to, m; fitted to the state unless given.
    ///
    /// Returns
    /// -------
    /// ndarray of uint8, shape (height, width, 3)
    ///     Red, green and blue, from the top left.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there is no such size, view or state.
    #[pyo3(signature = (state = None, width = 600, height = 400, *, view = None))]
    fn picture<'py>(
        &self,
        py: Python<'py>,
        state: Option<&Bound<'py, PyAny>>,
        width: u32,
        height: u32,
        view: Option<Corners>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let state = state::from_python(&self.scene, state)?;
        let view = picture::view(&self.scene, view, [&state])?;
        picture::rgb(py, &picture::draw(py, &self.scene, &state, (width, height), view)?)
    }

    /// The initial state as a PNG file, for notebooks.
    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let state = self.scene.initial_state();
        let view = picture::view(&self.scene, None, [&state])?;
        let image = picture::draw(py, &self.scene, &state, (600, 400), view)?;
        Ok(PyBytes::new(py, &image.to_png().map_err(errors::value)?))
    }

    /// Text that tells scenes apart: equal for equal scenes.
    #[getter]
    fn _key(&self) -> PyResult<String> {
        Ok(format!("{}{:?}", self.text("json")?, self.changes))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.scene.def() == other.scene.def() && self.changes == other.changes
    }

    fn __hash__(&self) -> u64 {
        use std::hash::{DefaultHasher, Hash, Hasher};
        let mut hasher = DefaultHasher::new();
        self.scene.def().name.hash(&mut hasher);
        self.scene.bodies().len().hash(&mut hasher);
        hasher.finish()
    }

    fn __repr__(&self) -> String {
        let def = self.scene.def();
        format!(
            "<tangency.Scene {:?}: {} bodies, {} joints, {} controls, dt {} s>",
            def.name,
            def.bodies.len(),
            def.joints.len(),
            def.controls.len(),
            self.scene.dt()
        )
    }
}
