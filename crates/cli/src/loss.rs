//! What is differentiated: a formula over the final state and the impulses of the last step, or the distance to an observed motion.

use std::path::Path;

use tangency::diff::{RowImpulse, StateVector};
use tangency::{Scene, State, StepRecord};

use crate::Failure;
use crate::formula::Formula;
use crate::impulse::{IMPULSE, Impulse};
use crate::observations::Observations;

/// A number that judges a rollout.
#[derive(Clone, Debug)]
pub enum Loss {
    /// A formula over the final state and the last step.
    Formula(Formula<Variable>),
    /// Mean squared error against an observed motion.
    Observed(Observations),
}

/// What a formula knows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Variable {
    /// A number of the final state.
    Coordinate(Coordinate),
    /// An impulse of the last step.
    Impulse(Impulse),
}

/// The derivatives of a loss by what a rollout computed.
#[derive(Clone, Debug, Default)]
pub struct Seeds {
    /// ∂L/∂(state k) for every state of a rollout, the initial one first.
    pub states: Vec<Option<StateVector>>,
    /// ∂L/∂λ of the rows of the last step.
    pub impulses: Vec<RowImpulse>,
}

/// One number of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coordinate {
    /// The body.
    pub body: usize,
    /// Index into the names `x y angle vx vy omega`.
    pub component: usize,
}

const COMPONENTS: [&str; 6] = ["x", "y", "angle", "vx", "vy", "omega"];

impl Loss {
    /// Reads a loss: a trajectory file if there is one of this name, else a formula.
    ///
    /// # Errors
    /// What is wrong with the file, or with the formula and at which column.
    pub fn parse(text: &str, scene: &Scene) -> Result<Self, Failure> {
        let file = Path::new(text);
        if file.is_file() {
            return Observations::read(file, scene).map(Self::Observed);
        }
        let formula = Formula::parse(text, |name| Variable::parse(name, scene));
        formula.map(Self::Formula).map_err(|source| Failure::Loss { text: text.into(), source })
    }

    /// Its value over the states of a rollout, the initial one first, and its last step.
    #[must_use]
    pub fn value(&self, states: &[&State], last: Option<&StepRecord>) -> f64 {
        match self {
            Self::Formula(formula) => formula.evaluate(&numbers(formula, states, last)).0,
            Self::Observed(observed) => observed.loss(states),
        }
    }

    /// Its derivatives there.
    #[must_use]
    pub fn seeds(&self, states: &[&State], last: Option<&StepRecord>) -> Seeds {
        match self {
            Self::Formula(formula) => {
                let mut seeds =
                    Seeds { states: vec![None; states.len() - 1], impulses: Vec::new() };
                let mut end = StateVector::like(states[0]);
                let (_, slopes) = formula.evaluate(&numbers(formula, states, last));
                for (variable, slope) in formula.variables.iter().zip(slopes) {
                    match variable {
                        Variable::Coordinate(Coordinate { body, component }) => {
                            let list = if *component < 3 { &mut end.q } else { &mut end.v };
                            list[*body][component % 3] += slope;
                        }
                        Variable::Impulse(impulse) => {
                            let rows = last.map_or_else(Vec::new, |last| impulse.rows(last));
                            let seed = |it: RowImpulse| RowImpulse { value: slope, ..it };
                            seeds.impulses.extend(rows.into_iter().map(seed));
                        }
                    }
                }
                seeds.states.push(Some(end));
                seeds
            }
            Self::Observed(observed) => {
                let states = observed.seeds(states).into_iter().map(Some).collect();
                Seeds { states, impulses: Vec::new() }
            }
        }
    }
}

/// The values of the variables; impulses are 0 where there is no step.
fn numbers(formula: &Formula<Variable>, states: &[&State], last: Option<&StepRecord>) -> Vec<f64> {
    let state = states[states.len() - 1];
    let number = |variable: &Variable| match variable {
        Variable::Coordinate(Coordinate { body, component }) => {
            let list = if *component < 3 { &state.q } else { &state.v };
            list[*body][component % 3]
        }
        Variable::Impulse(impulse) => {
            let rows = last.map_or_else(Vec::new, |last| impulse.rows(last));
            rows.iter().map(|row| row.value).sum()
        }
    };
    formula.variables.iter().map(number).collect()
}

impl Variable {
    fn parse(name: &str, scene: &Scene) -> Result<Self, String> {
        match name.strip_prefix(IMPULSE) {
            Some(rest) if rest.trim_start().starts_with('(') => {
                Impulse::parse(rest, scene).map(Self::Impulse)
            }
            _ => Coordinate::parse(name, scene).map(Self::Coordinate),
        }
    }
}

impl Coordinate {
    fn parse(name: &str, scene: &Scene) -> Result<Self, String> {
        let expected = "variables are BODY.x, .y, .angle, .vx, .vy or .omega";
        let Some((body, component)) = name.rsplit_once('.') else {
            return Err(format!("unknown variable `{name}`; {expected}"));
        };
        let component = COMPONENTS.iter().position(|known| *known == component);
        let component =
            component.ok_or_else(|| format!("unknown variable `{name}`; {expected}"))?;
        let body = scene.body_index(body).ok_or_else(|| {
            let known: Vec<&str> = scene.bodies().iter().map(|b| b.name.as_str()).collect();
            format!("the scene has no body `{body}`; known: {}", known.join(", "))
        })?;
        Ok(Self { body, component })
    }
}
