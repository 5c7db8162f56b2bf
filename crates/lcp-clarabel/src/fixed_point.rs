//! [`Clarabel`] and its iteration on s.

use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver};
use tangency_lcp::{
    Guess, Law, Lcp, LcpError, LcpSolution, LcpSolver, Method, Polish, Polished, Scratch, Search,
    solve_linear,
};

use crate::anderson::Anderson;
use crate::conic::Program;
use crate::status::{ClarabelFailure, Verdict, verdict};

/// How friction's cone is handed to Clarabel. In the plane both describe the same set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrictionCone {
    /// Two non-negative rows.
    #[default]
    Polyhedral,
    /// One second-order cone of dimension 2.
    SecondOrder,
}

/// Clarabel behind the solver trait.
///
/// Warm starts are not possible; a guess is tried through the polish first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clarabel {
    /// Natural residual, free of units, at which the search stops. Default 1e-12.
    pub tolerance: f64,
    /// Greatest natural residual that is returned as a solution. Default 1e-10.
    pub acceptance: f64,
    /// Clarabel's own tolerance. Default 1e-9; below that it fails more often than it gains.
    pub conic_tolerance: f64,
    /// Greatest number of convex programs per problem. Default 100.
    pub max_programs: u32,
    /// How the friction cone is written.
    pub cone: FrictionCone,
    /// Greatest number of mode corrections per polish. Default 8.
    pub max_flips: u32,
}

impl Default for Clarabel {
    fn default() -> Self {
        Self {
            tolerance: 1e-12,
            acceptance: 1e-10,
            conic_tolerance: 1e-9,
            max_programs: 100,
            cone: FrictionCone::default(),
            max_flips: 8,
        }
    }
}

impl Clarabel {
    pub(crate) fn conic_settings(&self) -> DefaultSettings<f64> {
        let tolerance = self.conic_tolerance;
        DefaultSettings {
            verbose: false,
            presolve_enable: false, // or b could not be updated
            max_threads: 1,
            tol_gap_abs: tolerance,
            tol_gap_rel: tolerance,
            tol_feas: tolerance,
            ..DefaultSettings::default()
        }
    }
}

impl LcpSolver for Clarabel {
    fn name(&self) -> &'static str {
        "clarabel"
    }

    fn solve(
        &self,
        problem: &Lcp,
        guess: Option<&Guess>,
        scratch: &mut Scratch,
    ) -> Result<LcpSolution, LcpError> {
        problem.validate()?;
        if problem.is_linear() {
            return solve_linear(problem);
        }
        let mut metric = scratch.metric(problem);
        if metric.scale == 0.0 {
            metric.scale = 1.0; // everything is zero, and so is the solution
        }
        let polish = Polish::new(problem, &metric, self.tolerance, self.max_flips);
        let mut search = Search::new(polish, self.acceptance, scratch);
        let found = if guess.is_some_and(|guess| search.offer_guess(guess)) {
            search.finish()
        } else {
            Programs { settings: self, search }.run()
        };
        scratch.give_metric(metric);
        found
    }
}

/// What is frozen in the convex programs.
#[derive(Clone, Copy, Debug)]
enum Iteration {
    /// s = μ|u_t|, De Saxcé's.
    Sliding { accelerated: bool },
    /// h = μ λₙ, Tresca's.
    Bounds,
}

/// How an iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Reached,
    Stalled,
    Infeasible,
}

/// One solve by programs, one after another.
struct Programs<'a> {
    settings: &'a Clarabel,
    search: Search<'a>,
}

impl Programs<'_> {
    /// The iterations in turn, each with its share of the programs.
    fn run(mut self) -> Result<LcpSolution, LcpError> {
        self.search.stats.method = Method::InteriorPoint;
        let share = self.settings.max_programs.div_ceil(4);
        let accelerated = Iteration::Sliding { accelerated: true };
        let damped = Iteration::Sliding { accelerated: false };
        for (iteration, flips) in [(accelerated, 1), (Iteration::Bounds, 5), (damped, 5)] {
            self.search.polish.max_flips = flips * self.settings.max_flips;
            let end = match iteration {
                Iteration::Sliding { accelerated } => self.sliding(accelerated, share)?,
                Iteration::Bounds => self.bounds(2 * share)?,
            };
            match end {
                End::Reached => break,
                End::Infeasible => return self.infeasible(),
                End::Stalled => {}
            }
        }
        if !self.search.is_accepted() {
            let _ = self.correct_at_length() || self.search.walk();
        }
        self.search.finish()
    }

    /// The polish with twenty times its corrections: from the best modes found, and from those that
    /// rows alone would take at the free velocities.
    fn correct_at_length(&mut self) -> bool {
        self.search.polish.max_flips = 20 * self.settings.max_flips;
        let found = self.search.best.as_ref().map(|best| best.solution.modes.clone());
        let cold = [false, true].map(|slide| self.search.polish.cold_modes(slide));
        found.into_iter().chain(cold).any(|modes| self.search.offer_modes(&modes, None))
    }

    /// s ← μ|u_t|, one convex program and one polish each; damped if not accelerated.
    fn sliding(&mut self, accelerated: bool, programs: u32) -> Result<End, LcpError> {
        let (problem, metric) = (self.search.polish.problem, self.search.polish.metric);
        let program = Program::new(problem, metric, self.settings.cone);
        let mut conic = self.conic(&program)?;
        let mut s = match &self.search.best {
            Some(best) if !accelerated => program.sliding(metric, &best.solution),
            _ => vec![0.0; problem.rows.len()],
        };
        let mut anderson = Anderson::default();
        for _ in 0..programs {
            // Updating b keeps Clarabel's ordering and equilibration.
            conic.update_b(&program.shifted(&s)).map_err(|e| refused(&e))?;
            let iterate = match self.iterate(&mut conic, &program)? {
                Ok(iterate) => iterate,
                Err(end) => return Ok(end),
            };
            if self.search.offer_approximate(&iterate) {
                return Ok(End::Reached);
            }
            let next = program.sliding(metric, &iterate);
            if accelerated {
                s = anderson.next(&s, &next);
            } else {
                halfway(&mut s, &next);
            }
            if !program.has_friction() {
                break; // one program is all there is
            }
        }
        Ok(End::Stalled)
    }

    /// h ← μ λₙ: Tresca's friction with frozen bounds (Panagiotopoulos 1975), which fails elsewhere.
    fn bounds(&mut self, programs: u32) -> Result<End, LcpError> {
        let problem = self.search.polish.problem;
        let mut impulses = match &self.search.best {
            Some(best) => best.solution.impulses.clone(),
            None => vec![0.0; problem.rows.len()],
        };
        let mut bounded = problem.clone();
        for _ in 0..programs {
            for (row, original) in bounded.rows.iter_mut().zip(&problem.rows) {
                if let Law::Friction { normal, mu } = original.law {
                    row.law = Law::Bounded { max: mu * impulses[normal as usize].max(0.0) };
                }
            }
            let program = Program::new(&bounded, self.search.polish.metric, self.settings.cone);
            let mut conic = self.conic(&program)?;
            let iterate = match self.iterate(&mut conic, &program)? {
                Ok(iterate) => iterate,
                Err(end) => return Ok(end),
            };
            if self.search.offer_approximate(&iterate) {
                return Ok(End::Reached);
            }
            halfway(&mut impulses, &iterate.impulses);
        }
        Ok(End::Stalled)
    }

    /// Solves one program; `Err` inside if its status ends the iteration.
    fn iterate(
        &mut self,
        conic: &mut DefaultSolver<f64>,
        program: &Program,
    ) -> Result<Result<LcpSolution, End>, LcpError> {
        conic.solve();
        self.search.stats.iterations += conic.solution.iterations;
        match verdict(conic.solution.status) {
            Verdict::Judge => {
                let (problem, metric) = (self.search.polish.problem, self.search.polish.metric);
                let (x, z) = (&conic.solution.x, &conic.solution.z);
                Ok(Ok(program.recover(problem, metric, x, z)))
            }
            Verdict::Infeasible => Ok(Err(End::Infeasible)),
            Verdict::Failed if self.search.best.is_some() => Ok(Err(End::Stalled)),
            Verdict::Failed => Err(stopped(conic)),
        }
    }

    /// Clarabel's certificate counts only if no candidate contradicts it.
    fn infeasible(self) -> Result<LcpSolution, LcpError> {
        if self.search.is_accepted() {
            return self.search.finish();
        }
        let residual = self.search.best.as_ref().map_or(1.0, Polished::max);
        Err(LcpError::Infeasible { residual })
    }

    fn conic(&self, program: &Program) -> Result<DefaultSolver<f64>, LcpError> {
        let settings = self.settings.conic_settings();
        let Program { p, q, a, b, cones, .. } = program;
        DefaultSolver::new(p, q, a, b, cones, settings).map_err(|e| refused(&e))
    }
}

/// x ← (x + next) / 2.
fn halfway(x: &mut [f64], next: &[f64]) {
    x.iter_mut().zip(next).for_each(|(x, next)| *x = 0.5 * (*x + next));
}

pub(crate) fn refused(error: &dyn std::fmt::Display) -> LcpError {
    let source = Box::new(ClarabelFailure::Refused { reason: error.to_string() });
    LcpError::Backend { solver: "clarabel", source }
}

pub(crate) fn stopped(conic: &DefaultSolver<f64>) -> LcpError {
    let status = conic.solution.status.to_string();
    LcpError::Backend { solver: "clarabel", source: Box::new(ClarabelFailure::Stopped { status }) }
}
