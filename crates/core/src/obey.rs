//! Accelerations that obey the laws of rows, or given modes.

use nalgebra::Vector3;
use tangency_lcp::{
    Guess, Law, Lcp, LcpError, LcpSolution, Metric, Mode, Row, solve_assembled, solve_in_modes,
};

use crate::StepError;
use crate::island::Island;
use crate::record::{IslandRecord, StepRecord};
use crate::resolve::Division;
use crate::row::{RowContext, RowSource};
use crate::scratch::StepScratch;
use crate::solve::{guess, record, refusal};
use crate::stage::Stage;
use crate::touch::{NOISE, noise};

/// How many times more than all that drives it a row asks for whose friction must be at its bound: the
/// first that is enough.
const FAR: [f64; 4] = [4.0, 64.0, 1024.0, 1e6];

impl Division<'_> {
    /// An island in the modes that its laws ask for.
    pub(crate) fn found(
        &self,
        context: &RowContext<'_>,
        (before, free): (Option<&StepRecord>, &[Vector3<f64>]),
        (index, mut island): (usize, Island),
        scratch: &mut StepScratch,
    ) -> Result<IslandRecord, StepError> {
        if island.problem.is_linear() {
            return self.in_modes(context, island, &[], scratch);
        }
        let StepScratch { places, guess: to, .. } = scratch;
        let guessed = guess(context, before, index, &island, places, to);
        let guess = guessed.then(|| std::mem::take(&mut scratch.guess));
        let solution = self.obey(context, free, &mut island, guess.as_ref(), scratch);
        if let Some(guess) = guess {
            scratch.guess = guess;
        }
        let solution = solution.map_err(|source| refused(context, &island.bodies, source))?;
        let modes = solution.modes.clone();
        scratch.lcp.recycle(solution);
        self.in_modes(context, island, &modes, scratch)
    }

    /// The solution of an island that obeys its laws. The friction of what slides, and motors that are not at
    /// their speed, act in their direction whatever the acceleration: their rows ask for more than can be.
    /// `rates` are about how bodies accelerate.
    pub(crate) fn obey(
        &self,
        context: &RowContext<'_>,
        rates: &[Vector3<f64>],
        island: &mut Island,
        guess: Option<&Guess>,
        scratch: &mut StepScratch,
    ) -> Result<LcpSolution, LcpError> {
        let leaning = self.leaning(context, rates, island);
        let guess = guess.map(|guess| stick(guess, &leaning, &island.problem));
        let metric = Metric::new(&island.problem);
        let scale = drive(&island.problem, &metric);
        let own: Vec<f64> = leaning.iter().map(|(row, _)| island.problem.rows[*row].rhs).collect();
        let mut answer = Err(LcpError::NotConverged { iterations: 0, residual: f64::INFINITY });
        for far in FAR {
            for (row, speed) in &leaning {
                let rhs = far * scale * metric.root(*row) + speed.abs() / self.scene.dt;
                island.problem.rows[*row].rhs = -rhs.copysign(*speed);
            }
            let (problem, tolerance) = (&island.problem, self.scene.tolerance());
            let (guess, lcp) = (guess.as_ref(), &mut scratch.lcp);
            let found = solve_assembled(self.solver, problem, guess, lcp, tolerance);
            let leans = |solution: &LcpSolution| {
                let against = |speed: f64| if speed > 0.0 { Mode::Lower } else { Mode::Upper };
                let leans = |mode, speed| mode == Mode::Open || mode == against(speed);
                leaning.iter().all(|(row, speed)| leans(solution.modes[*row], *speed))
            };
            let enough = found.as_ref().map_or(true, |(solution, _)| leans(solution));
            if enough {
                answer = found.map(|(solution, _)| solution);
                break;
            }
        }
        for ((row, _), rhs) in leaning.iter().zip(own) {
            island.problem.rows[*row].rhs = rhs;
        }
        answer
    }

    /// The rows of what slides, and of motors that are not at their speed, with how fast that is.
    fn leaning(
        &self,
        context: &RowContext<'_>,
        rates: &[Vector3<f64>],
        island: &Island,
    ) -> Vec<(usize, f64)> {
        let bounded = |row: &usize| {
            matches!(island.problem.rows[*row].law, Law::Friction { .. } | Law::Bounded { .. })
        };
        let rows = (0..island.sources.len()).filter(bounded);
        let leaning = rows.filter_map(|row| {
            let (speed, noise) = self.drift(context, rates, island.sources[row]);
            (speed.abs() > noise).then_some((row, speed))
        });
        leaning.collect()
    }

    /// How fast a contact slides, or by how much a motor is off its speed, and what of it may be rounding.
    pub(crate) fn drift(
        &self,
        context: &RowContext<'_>,
        rates: &[Vector3<f64>],
        source: RowSource,
    ) -> (f64, f64) {
        let row = context.geometry(source);
        let target = match source {
            RowSource::Motor { joint } => context.motor_speed(joint),
            _ => 0.0,
        };
        let gain = |body: usize| rates[body] * self.scene.dt;
        (context.speed(&row) - target, noise(context, &row, gain) + NOISE * target.abs())
    }

    /// An island on given modes (one per row; none where all rows are equalities). Joints that contradict
    /// each other off their common positions give way as far as drift explains.
    pub(crate) fn in_modes(
        &self,
        context: &RowContext<'_>,
        mut island: Island,
        modes: &[Mode],
        scratch: &mut StepScratch,
    ) -> Result<IslandRecord, StepError> {
        let mut all = scratch.lcp.modes.filled(island.problem.rows.len(), Mode::Active);
        if !modes.is_empty() {
            all.copy_from_slice(modes);
        }
        let tolerance = self.scene.tolerance();
        let answer = solve_in_modes(&island.problem, &all, &mut scratch.lcp, tolerance);
        let answer = answer.or_else(|error| {
            let context = RowContext { stage: Stage::Loose, ..*context };
            island.stage = Stage::Loose;
            island.problem.soften(|row| context.softness(island.sources[row]));
            solve_in_modes(&island.problem, &all, &mut scratch.lcp, tolerance).map_err(|_| error)
        });
        scratch.lcp.modes.give(all);
        match answer {
            Ok((solution, residual)) => Ok(record(island, solution, residual)),
            Err(source) => Err(refused(context, &island.bodies, source)),
        }
    }
}

/// A guess in which what does not slide sticks, although it slid before: two contacts of one body that came to
/// rest could hold each other at their bounds, and so seem to slide.
fn stick(guess: &Guess, leaning: &[(usize, f64)], problem: &Lcp) -> Guess {
    let mut guess = guess.clone();
    for (row, it) in problem.rows.iter().enumerate() {
        if let Law::Friction { normal, .. } = it.law
            && !leaning.iter().any(|(leans, _)| *leans == row)
        {
            guess.modes[row] = guess.modes[normal as usize];
        }
    }
    guess
}

/// All that drives a problem, motors at their maximum included, in mass-weighted units.
pub(crate) fn drive(problem: &Lcp, metric: &Metric) -> f64 {
    let motor = |(row, it): (usize, &Row)| match it.law {
        Law::Bounded { max } => metric.impulse(row, max),
        _ => 0.0,
    };
    problem.rows.iter().enumerate().map(motor).fold(metric.scale, f64::max)
}

/// An error of an island; who divides the step answers it.
fn refused(context: &RowContext<'_>, bodies: &[u32], source: LcpError) -> StepError {
    refusal(context, f64::NAN, bodies, source)
}
