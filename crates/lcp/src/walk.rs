//! From admissible impulses to a solution, one row at a time.
//!
//! The polish corrects all violated rows together and lets impulses be anything meanwhile. That is
//! quick, but where rows depend on each other and contradict each other a little (a pile in which one
//! contact too many counts as closed) impulses run away along the dependent direction. Here they
//! stay within their laws, as in the active-set methods of quadratic programming (Goldfarb & Idnani
//! 1983):
//!
//! ```text
//!  y* from the reduced system of the modes, near y        Δ = y* − y
//!  τ = the longest step ≤ 1 with  λₙ ≥ 0,  |λₜ| ≤ μ λₙ,  |λ| ≤ h          y ← y + τ Δ
//!  τ < 1:  the row that blocks opens, or slides
//!  τ = 1:  the open row that is violated most closes; the sliding row that slips backwards most sticks
//! ```
//!
//! Friction makes the problem non-monotone: a row that slips backwards may, once it sticks, press at
//! once against the bound that it left. Then it slides the other way; and a contact that may not close
//! with its friction against the slip is closed sticking, or with its friction along.

use crate::{ActiveSystem, Law, LcpSolution, Metric, Mode, Polish, Polished, Scratch, Sweeps};

/// Rows keep their modes while they violate them by less than this, relative to s*.
const KEEP: f64 = 1e-12;

/// A row is left aside once none of its modes leads on.
const MOST_ATTEMPTS: usize = 3;

/// What a whole step left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Violated {
    /// Nothing: a solution.
    None,
    /// This row.
    Row(usize),
    /// Rows of which no mode leads on.
    AllTried,
}

/// Admissible impulses, and modes that go with them.
#[derive(Clone, Debug)]
pub struct Walk<'a> {
    polish: Polish<'a>,
    impulses: Vec<f64>,
    modes: Vec<Mode>,
    /// How often each row was tried since the last one that led on.
    tried: Vec<usize>,
    /// The row that was violated last.
    last: Option<usize>,
    factorisations: u32,
}

/// How often sweeps of projected Gauss–Seidel and a walk follow each other.
const ROUNDS: usize = 3;
/// Sweeps before each walk.
const SWEEPS: usize = 200;
/// Greatest number of steps of a walk.
const MOST_STEPS: usize = 300;

/// What walks from more and more sweeps of projected Gauss–Seidel end in, each from where the other
/// is, with the factorisations that it took.
pub fn walks<'a>(
    polish: Polish<'a>,
    scratch: &'a mut Scratch,
) -> impl Iterator<Item = (Option<Polished>, u32)> + use<'a> {
    let mut sweeps = Sweeps::new(polish.problem);
    (0..ROUNDS).map(move |_| {
        (0..SWEEPS).for_each(|_| sweeps.sweep());
        let mut walk = Walk::new(polish, &sweeps.approximate());
        let candidate = walk.run(MOST_STEPS, scratch);
        sweeps = Sweeps::from(polish.problem, walk.impulses().to_vec());
        (candidate, walk.factorisations())
    })
}

impl<'a> Walk<'a> {
    /// Begins at impulses within their laws, such as those of [`Sweeps`](crate::Sweeps).
    #[must_use]
    pub fn new(polish: Polish<'a>, start: &LcpSolution) -> Self {
        let slacks = polish.problem.remainders(&start.velocities, &start.impulses);
        let (impulses, modes) = (start.impulses.clone(), Vec::new());
        let tried = vec![0; impulses.len()];
        let mut walk = Self { polish, impulses, modes, tried, last: None, factorisations: 0 };
        for (row, slack) in slacks.iter().enumerate() {
            let mode = walk.mode_at(row, *slack);
            walk.modes.push(mode);
        }
        walk
    }

    /// Where the walk is.
    #[must_use]
    pub fn impulses(&self) -> &[f64] {
        &self.impulses
    }

    /// Factorisations so far.
    #[must_use]
    pub fn factorisations(&self) -> u32 {
        self.factorisations
    }

    /// Walks until no row is violated, and polishes; `None` after `most` steps, or where no mode of a
    /// row leads on.
    pub fn run(&mut self, most: usize, scratch: &mut Scratch) -> Option<Polished> {
        for step in 0..most {
            let system = ActiveSystem::new(self.polish.problem, self.polish.metric, &self.modes);
            self.factorisations += 1;
            let reduced = system.solve(self.polish.problem, Some(&self.impulses));
            let target = system.spread(self.polish.problem, &reduced.impulses);
            if !target.iter().all(|y| y.is_finite()) {
                return None;
            }
            if let Some((row, mode)) = self.advance(&target) {
                self.set(row, mode);
                continue;
            }
            let slacks = self.polish.problem.remainders(&reduced.velocities, &self.impulses);
            // One at a time, and after a while the last one, which cannot cycle (Murty 1974).
            match self.violated(&slacks, step > most / 2) {
                Violated::None => {
                    return Some(self.polish.modes(&self.modes, Some(&self.impulses), scratch));
                }
                Violated::Row(row) => self.close(row, &slacks),
                Violated::AllTried => return None,
            }
        }
        None
    }

    /// Steps towards the target; the row that blocks, and its mode from now on.
    fn advance(&mut self, target: &[f64]) -> Option<(usize, Mode)> {
        let (mut longest, mut blocking) = (1.0, None);
        for row in 0..self.impulses.len() {
            if self.modes[row] != Mode::Active {
                continue;
            }
            for (room, towards, mode) in self.bounds(row, target) {
                if towards > 0.0 && room < longest * towards {
                    longest = (room / towards).max(0.0);
                    blocking = Some((row, mode));
                }
            }
        }
        for (y, target) in self.impulses.iter_mut().zip(target) {
            *y += longest * (target - *y);
        }
        self.confine();
        blocking
    }

    /// Takes away what rounding leaves outside the laws.
    fn confine(&mut self) {
        for (i, row) in self.polish.problem.rows.iter().enumerate() {
            let y = self.impulses[i];
            self.impulses[i] = match row.law {
                Law::Equality => y,
                Law::Unilateral => y.max(0.0),
                Law::Bounded { max } => y.clamp(-max, max),
                Law::Friction { normal, mu } => {
                    let bound = mu * self.impulses[normal as usize];
                    y.clamp(-bound, bound)
                }
            };
        }
    }

    /// Distances to the bounds of a row, how much of them a whole step takes, and the modes there.
    fn bounds(&self, row: usize, target: &[f64]) -> [(f64, f64, Mode); 2] {
        let (y, step) = (self.impulses[row], target[row] - self.impulses[row]);
        match self.polish.problem.rows[row].law {
            Law::Equality => [(0.0, 0.0, Mode::Active); 2],
            Law::Unilateral => [(y, -step, Mode::Open), (0.0, 0.0, Mode::Open)],
            Law::Bounded { max } => [(max - y, step, Mode::Upper), (max + y, -step, Mode::Lower)],
            Law::Friction { normal, mu } => {
                let normal = normal as usize;
                let h = mu * self.impulses[normal];
                let widens = mu * target[normal] - h;
                [(h - y, step - widens, Mode::Upper), (h + y, -step - widens, Mode::Lower)]
            }
        }
    }

    /// Gives a row its mode; the friction of a contact that opens goes with it.
    fn set(&mut self, row: usize, mode: Mode) {
        self.modes[row] = mode;
        if mode == Mode::Open {
            self.impulses[row] = 0.0;
            if let Some(friction) = self.polish.problem.friction_of(row) {
                self.modes[friction] = Mode::Open;
                self.impulses[friction] = 0.0;
            }
        }
    }

    /// The row whose mode its slack violates most, or the last one that does, of those that may
    /// still lead on.
    fn violated(&self, slacks: &[f64], last: bool) -> Violated {
        let metric: &Metric = self.polish.metric;
        let (mut worst, mut found) = (KEEP * metric.scale, Violated::None);
        for (row, slack) in slacks.iter().enumerate() {
            let u = metric.remainder(row, *slack);
            let violation = match (self.polish.problem.rows[row].law, self.modes[row]) {
                (Law::Unilateral, Mode::Open) | (_, Mode::Lower) => -u,
                (_, Mode::Upper) => u,
                _ => continue,
            };
            if violation <= worst {
                continue;
            }
            if self.tried[row] >= MOST_ATTEMPTS {
                found = if found == Violated::None { Violated::AllTried } else { found };
                continue;
            }
            found = Violated::Row(row);
            if !last {
                worst = violation;
            }
        }
        found
    }

    /// A violated row takes another mode: the likeliest first, and another each time that it is
    /// violated again at once.
    fn close(&mut self, row: usize, slacks: &[f64]) {
        if self.last.is_some_and(|last| last != row && self.modes[last] != Mode::Open) {
            self.tried.fill(0); // the last one led on
        }
        let attempt = self.tried[row];
        self.tried[row] += 1;
        self.last = Some(row);
        if self.modes[row] != Mode::Open {
            self.slide_back(row, attempt);
            return;
        }
        self.modes[row] = Mode::Active;
        if let Some(friction) = self.polish.problem.friction_of(row) {
            let (against, along) = if slacks[friction] > 0.0 {
                (Mode::Lower, Mode::Upper)
            } else {
                (Mode::Upper, Mode::Lower)
            };
            self.modes[friction] = [against, Mode::Active, along][attempt % 3];
        }
    }

    /// A row that slips backwards sticks, or goes to its other bound.
    fn slide_back(&mut self, row: usize, attempt: usize) {
        if attempt.is_multiple_of(2) {
            self.modes[row] = Mode::Active;
            return;
        }
        self.impulses[row] = -self.impulses[row];
        self.modes[row] = if self.modes[row] == Mode::Upper { Mode::Lower } else { Mode::Upper };
    }

    fn mode_at(&self, row: usize, slack: f64) -> Mode {
        let y = self.impulses[row];
        let bounded = |h: f64| match y {
            y if y >= h => Mode::Upper,
            y if y <= -h => Mode::Lower,
            _ => Mode::Active,
        };
        match self.polish.problem.rows[row].law {
            Law::Equality => Mode::Active,
            Law::Unilateral if y > 0.0 => Mode::Active,
            Law::Unilateral => Mode::Open,
            Law::Bounded { max } => bounded(max),
            Law::Friction { normal, .. } if self.modes[normal as usize] == Mode::Open => Mode::Open,
            Law::Friction { normal, mu } => {
                let h = mu * self.impulses[normal as usize];
                if y.abs() < h * (1.0 - 1e-12) {
                    Mode::Active
                } else if slack > 0.0 {
                    Mode::Lower
                } else {
                    Mode::Upper
                }
            }
        }
    }
}
