//! Raw problems: the interior point, polished as soon as it shows the active set; then Lemke's
//! method, polished.

use tangency_lcp::{LcpError, RawLcp, RawPolish, RawSolution, RawSolver, Scratch};
use tangency_lcp_lemke::candidates;

use crate::InteriorPoint;
use crate::feasibility::least_violation;
use crate::mehrotra::{BOLD, CAREFUL, Loop, Pace};
use crate::system::RowSystem;

impl RawSolver for InteriorPoint {
    fn name(&self) -> &'static str {
        "interior point"
    }

    fn solve_raw(&self, problem: &RawLcp) -> Result<RawSolution, LcpError> {
        solve_raw(problem, self)
    }
}

/// Solves a raw problem.
///
/// # Errors
/// [`LcpError::Infeasible`] if no z ≥ 0 has w ≥ 0; [`LcpError::NotConverged`] if no solution was
/// found (there may be none); a typed refusal for wrong sizes and numbers that are not finite.
pub fn solve_raw(problem: &RawLcp, settings: &InteriorPoint) -> Result<RawSolution, LcpError> {
    problem.validate()?;
    if problem.q.is_empty() {
        return Ok(RawSolution::empty());
    }
    let form = problem.box_form();
    let polish = RawPolish::new(problem, &form, settings.tolerance, settings.max_flips);
    let mut search = RawSearch { settings, polish, iterations: 0, pivots: 0 };
    let _ = search.interior(BOLD) || search.interior(CAREFUL) || search.pivoting();
    let RawSearch { polish, iterations, pivots, .. } = search;
    polish.finish(iterations, pivots).map_err(|error| {
        let tell = settings.tell_infeasible;
        match tell.then(|| least_violation(problem, settings)).flatten() {
            Some(residual) => LcpError::Infeasible { residual },
            None => error,
        }
    })
}

struct RawSearch<'a> {
    settings: &'a InteriorPoint,
    polish: RawPolish<'a>,
    iterations: u32,
    pivots: u32,
}

impl RawSearch<'_> {
    fn interior(&mut self, pace: Pace) -> bool {
        let before = self.iterations;
        let form = self.polish.form().clone();
        let (mut system, mut scratch) = (RowSystem::new(&form), Scratch::default());
        let mut path = Loop::new(&mut system, pace, &mut scratch);
        let mut tried: Vec<bool> = Vec::new();
        while path.iterations < self.settings.max_iterations && !self.polish.reached() {
            let going = path.advance(&mut scratch);
            let y = if going { path.y() } else { path.best_y() };
            self.iterations = before + path.iterations;
            let active = self.polish.active(y);
            if (path.best < 0.1 || !going) && active != tried {
                tried = active;
                self.polish.offer(y);
            }
            if !going {
                break;
            }
        }
        self.polish.offer(path.best_y())
    }

    fn pivoting(&mut self) -> bool {
        candidates(self.polish.form()).any(|(y, pivots)| {
            self.pivots += pivots;
            self.polish.offer(&y)
        })
    }
}
