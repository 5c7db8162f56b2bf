//! Derivatives of whole runs, against differences and against each other.
//!
//! The loss is a linear function of all states with fixed coefficients. For every number of a
//! scene, every control and every initial coordinate: reverse mode, forward mode, and the
//! extrapolated central difference. The differences must stay on one side of every switch: the
//! modes of all active rows are the same at every point that they visit.

pub(crate) mod battery;
pub(crate) mod loss;
pub(crate) mod numbers;

use nalgebra::Vector3;
use tangency::diff::{Gradient, RolloutVector, StateVector, gradient, gradient_adding, tangent};
use tangency::{LcpSolver, Param, Rollout, Scene, State, rollout};
use tangency_bench::finite_difference::derivative;
use tangency_bench::signature::signature;

use crate::engine::{backends, built};
use battery::{Entry, battery};
use loss::{coefficients, loss};
use numbers::{controls, numbers};

/// What a difference is taken by.
#[derive(Clone, Copy, Debug)]
enum Input {
    Number(Param),
    Control(usize, usize),
}

struct Run<'a> {
    scene: Scene,
    solver: &'a dyn LcpSolver,
    controls: Vec<Vec<f64>>,
    tape: Rollout,
}

fn play(scene: &Scene, solver: &dyn LcpSolver, controls: &[Vec<f64>]) -> Rollout {
    let control = |k: usize, _: &State| controls[k].clone();
    rollout(scene, solver, scene.initial_state(), controls.len(), control)
        .unwrap_or_else(|error| panic!("{}: {error}", scene.def().name))
}

impl<'a> Run<'a> {
    fn new(entry: &Entry, solver: &'a dyn LcpSolver) -> Self {
        let scene = built(&entry.def);
        let controls = controls(scene.controls().len(), entry.steps);
        let tape = play(&scene, solver, &controls);
        Self { scene, solver, controls, tape }
    }

    fn gradient(&self) -> Gradient {
        gradient(&self.scene, &self.tape, |k, state| Some(coefficients(k, state)))
            .unwrap_or_else(|error| panic!("{}: {error}", self.scene.def().name))
    }

    fn directional(&self, along: &RolloutVector) -> f64 {
        let changes = tangent(&self.scene, &self.tape, along).expect("forward mode");
        let term = |(k, state)| coefficients(k, state).dot(&changes[k]);
        self.tape.states().enumerate().map(term).sum()
    }

    /// How far forward and reverse may part. Hinges 10⁻⁸ of a length apart amplify rounding by 10⁸.
    fn rounding(&self) -> f64 {
        if self.scene.def().name == "misfit hinges" { 1e-10 } else { 1e-11 }
    }

    fn value(&self, input: Input) -> f64 {
        match input {
            Input::Number(param) => self.scene.get(param).expect("a number of the scene"),
            Input::Control(k, channel) => self.controls[k][channel],
        }
    }

    fn direction(&self, input: Input) -> RolloutVector {
        let mut along = RolloutVector::zeros(&self.scene, self.controls.len());
        match input {
            Input::Number(param) => along.add(&self.scene, param, 1.0),
            Input::Control(k, channel) => along.controls[k][channel] = 1.0,
        }
        along
    }

    fn reverse(&self, by: &RolloutVector, input: Input) -> f64 {
        match input {
            Input::Number(param) => by.by(&self.scene, param),
            Input::Control(k, channel) => by.controls[k][channel],
        }
    }

    /// The run with one input changed.
    fn changed(&self, input: Input, value: f64) -> Rollout {
        let (mut scene, mut controls) = (self.scene.clone(), self.controls.clone());
        match input {
            Input::Number(param) => scene.set(param, value).expect("a value near a good one"),
            Input::Control(k, channel) => controls[k][channel] = value,
        }
        play(&scene, self.solver, &controls)
    }
}

/// What is wrong with the derivative by one input, if anything.
fn defect(run: &Run<'_>, by: &RolloutVector, input: Input, scale: f64) -> Option<String> {
    let (x, modes) = (run.value(input), signature(&run.tape));
    let mut crossed = false;
    let difference = |x: f64| {
        let tape = run.changed(input, x);
        crossed |= signature(&tape) != modes;
        loss(&tape)
    };
    let length = if x.abs() < 1e-3 { 0.1 } else { x.abs() };
    let found = derivative(difference, x, 1e-3 * length);
    let (reverse, forward) = (run.reverse(by, input), run.directional(&run.direction(input)));
    let size = found.value.abs().max(scale);
    let (off, apart) = ((reverse - found.value).abs() / size, (forward - reverse).abs() / size);
    if crossed {
        Some(format!("{input:?}: the difference crosses a switch"))
    } else if off > 1e-7 || off.is_nan() {
        Some(format!("{input:?}: reverse {reverse}, difference {found:?}, off by {off:e}"))
    } else if apart > run.rounding() || apart.is_nan() {
        Some(format!("{input:?}: forward {forward}, reverse {reverse}, off by {apart:e}"))
    } else {
        None
    }
}

/// Distance of the run from the nearest switch, in mass-weighted units relative to each problem.
fn distance_to_switch(tape: &Rollout) -> f64 {
    let post = |r: &tangency::StepRecord| r.post.iter().flat_map(|p| p.islands.clone()).collect();
    let mut least = f64::INFINITY;
    for record in &tape.records {
        let post: Vec<_> = post(record);
        for island in record.islands.iter().chain(&post) {
            let margins = island.problem.margins(&island.solution);
            least = margins.into_iter().fold(least, f64::min);
        }
    }
    least
}

fn defects(entry: &Entry, solver: &dyn LcpSolver) -> Vec<String> {
    let run = Run::new(entry, solver);
    let name = &run.scene.def().name;
    let switch = distance_to_switch(&run.tape);
    let Gradient { by, report } = run.gradient();
    let mut found = Vec::new();
    if switch <= 1e-7 || !report.one_sided.is_empty() {
        found.push(format!("{name}: a row is {switch:e} from its switch, {:?}", report.one_sided));
    }
    let inputs = numbers(&run.scene).into_iter().filter(|p| !entry.except.contains(p));
    let mut inputs: Vec<Input> = inputs.map(Input::Number).collect();
    for channel in 0..run.scene.controls().len() {
        inputs.extend([0, entry.steps / 2].map(|k| Input::Control(k, channel)));
    }
    assert!(inputs.len() >= 10, "{name}: only {} inputs", inputs.len());
    let scale = 1e-3 * loss(&run.tape).abs().max(1.0);
    let all = inputs.into_iter().filter_map(|input| defect(&run, &by, input, scale));
    found.extend(all.map(|defect| format!("{name}, {defect}")));
    found
}

#[test]
fn every_number_of_every_scene() {
    for solver in backends() {
        let all: Vec<String> = battery().iter().flat_map(|e| defects(e, &*solver)).collect();
        assert!(all.is_empty(), "{}", all.join("\n"));
    }
}

/// Derivatives go through several displacements of a step, and through rows that they hold back.
#[test]
fn the_battery_knows_displacements() {
    for solver in backends() {
        let tapes: Vec<Rollout> = battery().iter().map(|e| Run::new(e, &*solver).tape).collect();
        let posts = || tapes.iter().flat_map(|tape| &tape.records).map(|record| &record.post);
        let times = |n: usize| posts().filter(|post| post.len() == n).count();
        assert!(times(2) >= 5 && times(3) >= 2, "{:?}", [1, 2, 3].map(times));
        assert!(posts().filter(|post| post.len() >= 2 && !post[1].slow.is_empty()).count() >= 2);
    }
}

/// Every kind of number occurs in the battery.
#[test]
fn the_battery_knows_every_kind_of_number() {
    let kind = |p: &Param| match p {
        Param::Shape(_, _, number) => format!("{number:?}"),
        _ => format!("{p:?}"),
    };
    let kind = |p: &Param| kind(p).split('(').next().expect("a name").to_owned();
    let mut found: Vec<String> = Vec::new();
    for entry in battery() {
        let all = numbers(&built(&entry.def));
        found.extend(all.iter().filter(|p| !entry.except.contains(p)).map(kind));
    }
    for expected in [
        "Mass",
        "Density",
        "Inertia",
        "Friction",
        "Restitution",
        "Radius",
        "Size",
        "Center",
        "Angle",
        "Vertex",
        "Offset",
        "Normal",
        "Position",
        "Velocity",
        "Gravity",
        "Dt",
        "AnchorA",
        "AnchorB",
        "Length",
        "MotorSpeed",
        "MotorMax",
        "Stiffness",
        "Damping",
        "Lower",
        "Upper",
        "Force",
    ] {
        assert!(found.iter().any(|k| k == expected), "no scene is differentiated by {expected}");
    }
}

/// (w, J d) = (Jᵀ w, d) for directions that move everything at once.
#[test]
fn reverse_and_forward_mode_are_transposes() {
    for solver in backends() {
        for entry in battery() {
            let run = Run::new(&entry, &*solver);
            let by = run.gradient().by;
            let mut along = RolloutVector::zeros(&run.scene, entry.steps);
            let mut reverse = Vec::new();
            for (i, param) in numbers(&run.scene).into_iter().enumerate() {
                let rate = (1.7 * i as f64 + 0.3).sin();
                along.add(&run.scene, param, rate);
                reverse.push(rate * by.by(&run.scene, param));
            }
            for (k, step) in along.controls.iter_mut().enumerate() {
                for (channel, u) in step.iter_mut().enumerate() {
                    *u = (0.9 * k as f64 + channel as f64).cos();
                    reverse.push(*u * by.controls[k][channel]);
                }
            }
            let forward = run.directional(&along);
            let size: f64 = reverse.iter().map(|r| r.abs()).sum();
            let off = (forward - reverse.iter().sum::<f64>()).abs() / size;
            assert!(off <= 1e-12, "{}: off by {off:e}", run.scene.def().name);
        }
    }
}

/// A parameter shared between bodies is the sum over them.
#[test]
fn seeds_may_be_added_in_place() {
    let solver = &backends()[0];
    for entry in battery() {
        let run = Run::new(&entry, &**solver);
        let add = |k: usize, state: &State, bar: &mut StateVector| bar.add(&coefficients(k, state));
        let added = gradient_adding(&run.scene, &run.tape, add).expect("a gradient");
        assert_eq!(added, run.gradient(), "{}", run.scene.def().name);
    }
}

#[test]
fn shared_parameters() {
    for solver in backends() {
        let scene = built(&tangency_bench::scenes::chain(4, 0.3, 0.2));
        let mut moved = scene.clone();
        moved.set(Param::Position(0, 2), -1.2).expect("an angle");
        let tape = crate::engine::run(&moved, &*solver, 40);
        let by = gradient(&moved, &tape, |k, s| Some(coefficients(k, s))).expect("a gradient").by;
        let shared = tangency::diff::Parameter::parse(&moved, "mass:links").expect("the group");
        let single: f64 = (0..4).map(|i| by.by(&moved, Param::Mass(i))).sum();
        assert!((shared.gradient(&moved, &by) - single).abs() <= 1e-13 * single.abs());
        let total =
            tangency::diff::Parameter::parse(&moved, "total_mass:links").expect("the group");
        assert!((total.gradient(&moved, &by) - single / 4.0).abs() <= 1e-13 * single.abs());
        let changes = tangent(&moved, &tape, &shared.direction(&moved, 40)).expect("forward mode");
        assert_eq!(changes[0].q, vec![Vector3::zeros(); 4]);
    }
}
