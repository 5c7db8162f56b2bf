//! Scenes.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use nalgebra::DVector;
use numpy::{PyArray1, PyArray2, PyArray3};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use tangency::diff::Coordinates;
use tangency::{BodyKind, Param, Parameter, SceneFormat, StateVector};

use crate::arrays::{self, Numbers};
use crate::picture::Corners;
use crate::{errors, picture, state};

/// A checked scene: bodies, joints, forces, control channels and the numbers of the model.
///
/// Scenes never change; `with_values` makes another one. They compare by value, have a hash, can be
/// pickled and sent to other processes, and may be used from several threads at once.
///
/// Parameters
/// ----------
/// definition : SceneDef or mapping
///     A definition, or a mapping with the keys of a scene file.
///
/// Raises
/// ------
/// SceneError
///     If the scene cannot be: the message names field, value and remedy.
/// TypeError
///     If `definition` is something else, or holds something that has no place in a scene.
/// ValueError
///     If a number is NaN or infinite.
///
/// See Also
/// --------
/// Scene.load : Reads a scene file.
/// Scene.parse : Reads the text of one.
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
            parameter.set(&mut scene, *value).map_err(|error| errors::number(name, error))?;
        }
        let changes = self.changes.iter().cloned().chain(values).collect();
        Ok(Self { scene: Arc::new(scene), changes })
    }

    /// The number of the scene that a parameter sets: a density is a mass, and so is an inertia that follows it.
    fn number_set(&self, param: Param) -> Param {
        match param {
            Param::Density(i) => Param::Mass(i),
            Param::Inertia(i) if self.scene.bodies()[i].inertia_follows_mass => Param::Mass(i),
            _ => param,
        }
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

    /// Reads a scene file, TOML (`.toml`) or JSON (`.json`).
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     Where the file is.
    ///
    /// Returns
    /// -------
    /// Scene
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     If the file cannot be read or its scene cannot be; with line and column where there is one.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let scene = tangency::load_scene(path).map_err(errors::scene)?;
        Ok(Self { scene: Arc::new(scene), changes: Vec::new() })
    }

    /// Reads the text of a scene file.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     The text.
    /// format : {"toml", "json"}
    ///     Its format.
    ///
    /// Returns
    /// -------
    /// Scene
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     If the scene cannot be; with line and column where there is one.
    /// ValueError
    ///     If there is no such format.
    #[staticmethod]
    #[pyo3(signature = (text, format = "toml"))]
    fn parse(text: &str, format: &str) -> PyResult<Self> {
        let format = self::format(format)?;
        Self::of(&tangency::parse_scene(text, format).map_err(errors::scene)?)
    }

    /// The text of a scene file with the definition that the scene was built from.
    ///
    /// Numbers changed by `with_values` are not in it: they belong to the scene, not to its definition.
    ///
    /// Parameters
    /// ----------
    /// format : {"json", "toml"}
    ///     Its format.
    ///
    /// Returns
    /// -------
    /// str
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there is no such format.
    #[pyo3(signature = (format = "json"))]
    fn text(&self, format: &str) -> PyResult<String> {
        Ok(match self::format(format)? {
            SceneFormat::Toml => tangency::scene_to_toml(self.scene.def()),
            SceneFormat::Json => tangency::scene_to_json(self.scene.def()),
        })
    }

    /// Name of the scene.
    #[getter]
    fn name(&self) -> &str {
        &self.scene.def().name
    }

    /// What the scene is, for people.
    #[getter]
    fn description(&self) -> &str {
        &self.scene.def().description
    }

    /// Time step, s: that of the scene as it is, `with_values` included.
    #[getter]
    fn dt(&self) -> f64 {
        self.scene.dt()
    }

    /// How long a run lasts unless told otherwise, s.
    #[getter]
    fn duration(&self) -> f64 {
        self.scene.def().duration
    }

    /// Number of steps of a run of the scene's own duration.
    #[getter]
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a duration and a step are positive; what is too long ends at the greatest number"
    )]
    pub(crate) fn steps(&self) -> usize {
        (self.scene.def().duration / self.scene.dt()).round() as usize
    }

    /// Names of all bodies, in the order in which arrays have them.
    #[getter]
    fn bodies<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.scene.bodies().iter().map(|body| body.name.as_str()))
    }

    /// Names of all joints.
    #[getter]
    fn joints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.scene.joints().iter().map(|joint| joint.name.as_str()))
    }

    /// Names of the control channels, in the order in which controls have them.
    #[getter]
    fn controls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.scene.def().controls.iter().map(|control| control.name.as_str()))
    }

    /// Indices of the bodies that forces move.
    #[getter]
    fn dynamic<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, Coordinates::of(&self.scene).bodies())
    }

    /// Index of a body.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name.
    ///
    /// Returns
    /// -------
    /// int
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     If there is no such body.
    fn body(&self, name: &str) -> PyResult<usize> {
        let unknown = || PyKeyError::new_err(format!("the scene has no body {name:?}"));
        self.scene.body_index(name).ok_or_else(unknown)
    }

    /// Index of a joint.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     Its name.
    ///
    /// Returns
    /// -------
    /// int
    ///
    /// Raises
    /// ------
    /// KeyError
    ///     If there is no such joint.
    fn joint(&self, name: &str) -> PyResult<usize> {
        let unknown = || PyKeyError::new_err(format!("the scene has no joint {name:?}"));
        self.scene.joint_index(name).ok_or_else(unknown)
    }

    /// The state at the start, a `State`.
    #[getter]
    fn initial_state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        state::to_python(py, &self.scene.initial_state())
    }

    /// A number of the scene by its name, such as ``"mass:ball"``, ``"gravity.y"`` or ``"position.x:box"``.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     What it is and whose: ``"quantity:target"`` or ``"quantity.component:target"``, the target a body,
    ///     a joint, a group of bodies or ``*``.
    ///
    /// Returns
    /// -------
    /// float
    ///     In SI units; that of the first target where there are several.
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     If the scene has no such number; the message lists what there is.
    fn value(&self, name: &str) -> PyResult<f64> {
        Ok(Parameter::parse(&self.scene, name).map_err(errors::scene)?.value(&self.scene))
    }

    /// Refuses names of which two set the same number.
    fn _check_apart(&self, names: Vec<String>) -> PyResult<()> {
        let parameters = self.parameters(&names)?;
        let mut setters: BTreeMap<Param, &str> = BTreeMap::new();
        for (name, parameter) in names.iter().zip(&parameters) {
            for (param, _) in &parameter.targets {
                let other = setters.insert(self.number_set(*param), name);
                if let Some(other) = other.filter(|other| other != name) {
                    return Err(PyValueError::new_err(format!(
                        "{other:?} and {name:?} set the same number; give one of them"
                    )));
                }
            }
        }
        Ok(())
    }

    /// The same scene with other numbers.
    ///
    /// Parameters
    /// ----------
    /// values : dict of str to float
    ///     New numbers by name, as of `value`; set in this order. A name of several targets sets all of them.
    ///
    /// Returns
    /// -------
    /// Scene
    ///
    /// Raises
    /// ------
    /// SceneError
    ///     If the scene has no such number, or the number cannot be that.
    ///
    /// Examples
    /// --------
    /// >>> heavy = scene.with_values({"mass:links": 2.0, "friction:*": 0.3})  # doctest: +SKIP
    fn with_values(&self, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let pair = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| -> PyResult<_> {
            Ok((name.extract()?, value.extract()?))
        };
        self.changed(values.iter().map(pair).collect::<PyResult<_>>()?)
    }

    /// What a step from a state models: bodies that move freely, and islands with their rows.
    ///
    /// Parameters
    /// ----------
    /// state : State or (q, v), optional
    ///     The initial state unless given.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``dynamic_bodies`` and ``other_bodies`` (int), ``free_bodies`` (names), and ``islands``, a list of
    ///     dictionaries with ``bodies`` (names), ``path`` ("linear" or "complementarity") and the number of
    ///     ``equality_rows``, ``motor_rows``, ``limit_rows``, ``contact_rows`` and ``friction_rows``.
    ///
    /// Raises
    /// ------
    /// StepError
    ///     If geometry has no answer, as where two centres coincide.
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

    /// Mechanical energy: kinetic, of gravity (zero at the origin), and of springs.
    ///
    /// Parameters
    /// ----------
    /// state : State or (q, v), optional
    ///     The initial state unless given.
    ///
    /// Returns
    /// -------
    /// float
    ///     J.
    #[pyo3(signature = (state = None))]
    fn energy(&self, state: Option<&Bound<'_, PyAny>>) -> PyResult<f64> {
        Ok(self.scene.energy(&state::from_python(&self.scene, state)?))
    }

    /// Momentum of all dynamic bodies.
    ///
    /// Parameters
    /// ----------
    /// state : State or (q, v), optional
    ///     The initial state unless given.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (3,)
    ///     Linear momentum (N·s, N·s) and angular momentum about the origin (N·m·s).
    #[pyo3(signature = (state = None))]
    fn momentum<'py>(
        &self,
        py: Python<'py>,
        state: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let found = self.scene.total_momentum(&state::from_python(&self.scene, state)?);
        Ok(arrays::vector(py, &DVector::from_column_slice(found.as_slice())))
    }

    /// Largest position error of the rigid joints.
    ///
    /// Parameters
    /// ----------
    /// state : State or (q, v), optional
    ///     The initial state unless given.
    ///
    /// Returns
    /// -------
    /// float
    ///     m or rad.
    #[pyo3(signature = (state = None))]
    fn joint_drift(&self, state: Option<&Bound<'_, PyAny>>) -> PyResult<f64> {
        Ok(self.scene.joint_drift(&state::from_python(&self.scene, state)?))
    }

    /// Deepest penetration.
    ///
    /// Parameters
    /// ----------
    /// state : State or (q, v), optional
    ///     The initial state unless given.
    ///
    /// Returns
    /// -------
    /// float
    ///     m; 0 where nothing penetrates.
    ///
    /// Raises
    /// ------
    /// StepError
    ///     If geometry has no answer, as where two centres coincide.
    #[pyo3(signature = (state = None))]
    fn penetration(&self, state: Option<&Bound<'_, PyAny>>) -> PyResult<f64> {
        let state = state::from_python(&self.scene, state)?;
        self.scene.penetration(&state).map_err(errors::step)
    }

    /// The coordinates of the dynamic bodies as one vector.
    ///
    /// ::
    ///
    ///     x = (x₁ y₁ θ₁ … xₙ yₙ θₙ | ẋ₁ ẏ₁ ω₁ … ẋₙ ẏₙ ωₙ)
    ///
    /// Parameters
    /// ----------
    /// state : State or (q, v), optional
    ///     The initial state unless given.
    ///
    /// Returns
    /// -------
    /// ndarray, shape (6 n,)
    ///     Of the n bodies of `dynamic`.
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
    ///
    /// Parameters
    /// ----------
    /// x : array_like, shape (6 n,)
    ///     As `coordinates` gives them.
    /// state : State or (q, v), optional
    ///     Where all other bodies, and the time, come from; the initial state unless given.
    ///
    /// Returns
    /// -------
    /// State
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If `x` has another shape.
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

    /// Masses (kg, kg, kg·m²) of all bodies, shape (bodies, 3); zero for those that forces do not move.
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

    /// Shapes of every body as in a scene file, but about the centres of mass.
    ///
    /// A list per body of mappings like ``{"circle": {"radius": 0.1, "center": [0.0, 0.0]}}``; with the numbers
    /// that `with_values` gave.
    #[getter]
    fn shapes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let all: Vec<_> =
            self.scene.colliders().iter().map(tangency::collision::Collider::shapes).collect();
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
