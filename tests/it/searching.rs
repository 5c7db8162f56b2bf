//! Losses of a motion made small by descent, L-BFGS and Gauss–Newton.

use nalgebra::{DMatrix, DVector};
use tangency::control::{
    Bounds, ControlLimits, GaussNewton, GradientDescent, Iterate, Lbfgs, LeastSquares, Planner,
    Quadratic, Residuals, SceneDynamics, Shooting, ShootingError,
};
use tangency::diff::{Coordinates, Parameter, tangent};
use tangency::{ControlDef, ControlInput, LcpSolver, Scene, SceneDef};
use tangency_bench::scenes::{basket, disc, unit_scene};

use crate::accurate::accurate;
use crate::engine::{backends, built, near};

const GOAL: [f64; 2] = [3.6, 0.9];
const TIME: f64 = 1.2;

/// x = 3.88 − e (vₓ T − 3.88) after the board, y = 1.8 + v_y T − g T²/2.
fn exact_throw() -> [f64; 2] {
    [(3.88 + (3.88 - GOAL[0]) / 0.8) / TIME, (GOAL[1] - 1.8) / TIME + 9.81 * TIME / 2.0]
}

/// A throw off a board as a function of its velocity.
struct Throw {
    scene: Scene,
    parameters: Vec<Parameter>,
    cost: Quadratic,
    ball: usize,
}

impl Throw {
    fn new() -> Self {
        Self::of(&basket())
    }

    fn of(def: &SceneDef) -> Self {
        let scene = built(def);
        let names = ["velocity.x:ball", "velocity.y:ball"];
        let parameters = Parameter::parse_all(&scene, &names).expect("the scene's numbers");
        let order = Coordinates::of(&scene);
        let ball = scene.body_index("ball").expect("a ball");
        let mut cost = Quadratic::of_effort(order.size(), 0, 0.0);
        for (axis, goal) in GOAL.into_iter().enumerate() {
            cost.aim(order.pose(ball, axis).expect("a dynamic body"), goal, 0.0, 2.0);
        }
        Self { scene, parameters, cost, ball }
    }

    fn shooting<'a>(&'a self, solver: &'a dyn LcpSolver) -> Shooting<'a> {
        let Self { scene, parameters, cost, .. } = self;
        Shooting { scene, solver, parameters, cost, steps: 120 }
    }
}

/// The same as residuals, in forward mode.
struct Missed<'a>(Shooting<'a>, usize);

impl LeastSquares for Missed<'_> {
    type Error = ShootingError;

    fn linearise(&mut self, point: &[f64]) -> Result<Residuals, ShootingError> {
        let (scene, motion) = self.0.motion(point)?;
        let last = motion.last().q[self.1];
        let columns = self.0.parameters.iter().map(|parameter| {
            let along = parameter.direction(&scene, self.0.steps);
            let changes = tangent(&scene, &motion, &along)?;
            let change = changes[self.0.steps].q[self.1];
            Ok(DVector::from_column_slice(&[change.x, change.y]))
        });
        let columns: Vec<_> = columns.collect::<Result<_, ShootingError>>()?;
        let values = DVector::from_column_slice(&[last.x - GOAL[0], last.y - GOAL[1]]);
        Ok(Residuals { values, jacobian: DMatrix::from_columns(&columns) })
    }
}

#[track_caller]
fn check_throw(found: &[Iterate], tolerance: f64) {
    let last = found.last().expect("a start");
    for (found, exact) in last.point.iter().zip(exact_throw()) {
        near("velocity", *found, exact, tolerance);
    }
}

/// Over a wall and off a board into the basket, to the closed form: by each method from the same start.
#[test]
fn throws_off_the_board() {
    check_methods(&Throw::new());
}

#[test]
fn throws_off_the_board_in_accurate_steps() {
    check_methods(&Throw::of(&accurate(basket(), 0.01)));
}

fn check_methods(throw: &Throw) {
    for solver in backends() {
        let mut shooting = throw.shooting(&*solver);
        let start = shooting.start();
        let descent = GradientDescent { rate: 0.3, clip: f64::INFINITY, iterations: 60 };
        let found = descent.minimise(&mut shooting, &start, &mut |_| ()).expect("a throw");
        check_throw(&found, 1e-8);
        let search = Lbfgs::unbounded(2);
        let found = search.minimise(&mut shooting, &start, &mut |_| ()).expect("a throw");
        check_throw(&found, 1e-10);
        let mut missed = Missed(shooting, throw.ball);
        let search = GaussNewton::unbounded(2);
        let found = search.minimise(&mut missed, &start, &mut |_| ()).expect("a throw");
        check_throw(&found, 1e-12);
    }
}

/// A mass of 1 kg that is to be at 1 m, at rest, after 20 steps of 0.05 s, at the least effort.
fn driven() -> SceneDef {
    let input = ControlInput::ForceX { body: "mass".into() };
    let controls = vec![ControlDef { name: "push".into(), input }];
    let body = tangency::BodyDef { mass: Some(1.0), ..disc("mass", 0.1, [0.0; 2]) };
    SceneDef { dt: 0.05, controls, ..unit_scene("driven mass", vec![body]) }
}

/// The controls of a linear motion and a quadratic cost are those of iterative LQR, which shares with
/// L-BFGS neither derivatives nor search; within limits, too.
#[test]
fn best_controls_are_those_of_the_planner() {
    check_controls(&driven());
}

#[test]
fn best_controls_of_accurate_steps() {
    check_controls(&accurate(driven(), driven().dt));
}

fn check_controls(def: &SceneDef) {
    let scene = built(def);
    for solver in backends() {
        let (place, n) = (0, 6);
        let mut cost = Quadratic::of_effort(n, 1, 0.01);
        cost.aim(place, 1.0, 0.0, 100.0);
        cost.aim(place + 3, 0.0, 0.0, 100.0);
        for limit in [f64::INFINITY, 4.0] {
            let limits = ControlLimits::new(vec![-limit], vec![limit]).expect("limits");
            let mut dynamics = SceneDynamics::new(&scene, &*solver);
            let (initial, guess) = (scene.initial_state(), vec![vec![0.0]; 20]);
            let plan = Planner { tolerance: 1e-14, ..Planner::default() }
                .plan(&mut dynamics, &cost, &limits, &initial, &guess)
                .expect("a plan");
            let mut shooting = Shooting {
                scene: &scene,
                solver: &*solver,
                parameters: &[],
                cost: &cost,
                steps: 20,
            };
            let bounds = shooting.bounds(&limits);
            let search = Lbfgs { bounds, memory: 20, iterations: 300 };
            let start = shooting.start();
            let found = search.minimise(&mut shooting, &start, &mut |_| ()).expect("controls");
            let last = found.last().expect("a start");
            near("cost", last.loss, plan.cost, 1e-9 * plan.cost);
            let far = plan.controls.iter().flatten().zip(&last.point);
            let far = far.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            near("controls", far, 0.0, 1e-3);
        }
    }
}

/// A search says which number it cannot begin with.
#[test]
fn a_search_begins_between_its_bounds() {
    let throw = Throw::new();
    for solver in backends() {
        let mut shooting = throw.shooting(&*solver);
        let bounds = vec![Bounds::FREE, Bounds { lower: 0.0, upper: 6.0 }];
        let search = Lbfgs { bounds, memory: 5, iterations: 5 };
        let refusal = search.minimise(&mut shooting, &[3.6, 6.0], &mut |_| ());
        let text = refusal.expect_err("6 is on the bound").to_string();
        assert_eq!(text, "number 1 begins at 6; begin between its bounds, 0 and 6");
        let refusal = shooting.motion(&[4.0]).expect_err("two are needed").to_string();
        assert!(refusal.starts_with("1 numbers, expected 2"), "{refusal}");
    }
}
