//! [`Clarabel`] and its iteration on s.

use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver};
use tangency_lcp::{
    Guess, Lcp, LcpError, LcpSolution, LcpSolver, Metric, Polish, Polished, Scratch, SolveStats,
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
        _scratch: &mut Scratch,
    ) -> Result<LcpSolution, LcpError> {
        problem.validate()?;
        if problem.is_linear() {
            return solve_linear(problem);
        }
        let mut metric = Metric::new(problem);
        if metric.scale == 0.0 {
            metric.scale = 1.0; // everything is zero, and so is the solution
        }
        let (target, max_flips) = (self.tolerance, self.max_flips);
        let polish = Polish { problem, metric: &metric, target, max_flips };
        let stats = SolveStats::default();
        let mut search = Search { settings: self, polish, stats, best: None };
        if guess.is_some_and(|guess| search.warm(guess)) {
            return search.finish();
        }
        search.fixed_point()
    }
}

/// One solve.
struct Search<'a> {
    settings: &'a Clarabel,
    polish: Polish<'a>,
    stats: SolveStats,
    best: Option<Polished>,
}

impl Search<'_> {
    fn warm(&mut self, guess: &Guess) -> bool {
        if guess.modes.len() != self.polish.problem.rows.len() {
            return false;
        }
        let candidate = self.polish.modes(guess.modes.clone(), None);
        self.offer(candidate)
    }

    /// s ← μ|u_t|, one convex program and one polish each.
    fn fixed_point(mut self) -> Result<LcpSolution, LcpError> {
        let (problem, metric) = (self.polish.problem, self.polish.metric);
        let program = Program::new(problem, metric, self.settings.cone);
        let mut conic = self.conic(&program)?;
        let mut s = vec![0.0; problem.rows.len()];
        let mut anderson = Anderson::default();
        for _ in 0..self.settings.max_programs {
            // Updating b keeps Clarabel's ordering and equilibration.
            conic.update_b(&program.shifted(&s)).map_err(|e| refused(&e))?;
            conic.solve();
            self.stats.iterations += conic.solution.iterations;
            match verdict(conic.solution.status) {
                Verdict::Judge => {}
                Verdict::Infeasible => return self.infeasible(),
                Verdict::Failed if self.best.is_some() => break,
                Verdict::Failed => return Err(stopped(&conic)),
            }
            let iterate = program.recover(problem, metric, &conic.solution.x, &conic.solution.z);
            if let Some(candidate) = self.polish.approximate(&iterate)
                && self.offer(candidate)
            {
                break;
            }
            s = anderson.next(&s, &program.sliding(metric, &iterate));
        }
        self.finish()
    }

    /// Takes a candidate into account; true if it is good enough to stop.
    fn offer(&mut self, candidate: Polished) -> bool {
        self.stats.factorisations += candidate.solution.stats.factorisations;
        let reached = self.polish.reached(&candidate);
        if self.best.as_ref().is_none_or(|best| candidate.max() < best.max()) {
            self.best = Some(candidate);
        }
        reached
    }

    fn finish(self) -> Result<LcpSolution, LcpError> {
        let iterations = self.stats.iterations;
        let residual = self.best.as_ref().map_or(f64::INFINITY, Polished::max);
        match self.best {
            Some(best) if residual <= self.settings.acceptance => {
                Ok(LcpSolution { stats: self.stats, ..best.solution })
            }
            _ => Err(LcpError::NotConverged { iterations, residual }),
        }
    }

    /// Clarabel's certificate counts only if no candidate contradicts it.
    fn infeasible(self) -> Result<LcpSolution, LcpError> {
        let residual = self.best.as_ref().map_or(1.0, Polished::max);
        if residual <= self.settings.acceptance {
            return self.finish();
        }
        Err(LcpError::Infeasible { residual })
    }

    fn conic(&self, program: &Program) -> Result<DefaultSolver<f64>, LcpError> {
        let settings = self.settings.conic_settings();
        let Program { p, q, a, b, cones, .. } = program;
        DefaultSolver::new(p, q, a, b, cones, settings).map_err(|e| refused(&e))
    }
}

pub(crate) fn refused(error: &dyn std::fmt::Display) -> LcpError {
    let source = Box::new(ClarabelFailure::Refused { reason: error.to_string() });
    LcpError::Backend { solver: "clarabel", source }
}

pub(crate) fn stopped(conic: &DefaultSolver<f64>) -> LcpError {
    let status = conic.solution.status.to_string();
    LcpError::Backend { solver: "clarabel", source: Box::new(ClarabelFailure::Stopped { status }) }
}
