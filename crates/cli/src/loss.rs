//! What is differentiated: a formula over the final state, or the distance to an observed motion.

use std::path::Path;

use tangency::diff::StateVector;
use tangency::{Scene, State};

use crate::Failure;
use crate::formula::Formula;
use crate::observations::Observations;

/// A number that judges a rollout.
#[derive(Clone, Debug)]
pub enum Loss {
    /// A formula over the final state.
    Formula(Formula<Coordinate>),
    /// Mean squared error against an observed motion.
    Observed(Observations),
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
        let formula = Formula::parse(text, |name| Coordinate::parse(name, scene));
        formula.map(Self::Formula).map_err(|source| Failure::Loss { text: text.into(), source })
    }

    /// Its value over the states of a rollout, the initial one first.
    #[must_use]
    pub fn value(&self, states: &[&State]) -> f64 {
        match self {
            Self::Formula(formula) => formula.evaluate(&coordinates(formula, states)).0,
            Self::Observed(observed) => observed.loss(states),
        }
    }

    /// ∂L/∂(state k) for every state of a rollout.
    #[must_use]
    pub fn seeds(&self, states: &[&State]) -> Vec<Option<StateVector>> {
        match self {
            Self::Formula(formula) => {
                let mut seeds = vec![None; states.len() - 1];
                let mut last = StateVector::like(states[0]);
                let (_, slopes) = formula.evaluate(&coordinates(formula, states));
                for (Coordinate { body, component }, slope) in formula.variables.iter().zip(slopes)
                {
                    let list = if *component < 3 { &mut last.q } else { &mut last.v };
                    list[*body][component % 3] += slope;
                }
                seeds.push(Some(last));
                seeds
            }
            Self::Observed(observed) => observed.seeds(states).into_iter().map(Some).collect(),
        }
    }
}

fn coordinates(formula: &Formula<Coordinate>, states: &[&State]) -> Vec<f64> {
    let state = states[states.len() - 1];
    let number = |c: &Coordinate| {
        let list = if c.component < 3 { &state.q } else { &state.v };
        list[c.body][c.component % 3]
    };
    formula.variables.iter().map(number).collect()
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
