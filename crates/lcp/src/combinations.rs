//! Modes of a few rows in all combinations: where contacts barely touch, or hold each other with
//! impulses of any size, nothing else tells which of them count.

use crate::{Law, Lcp, LcpSolution, Mode};

/// Most contacts, limits or motors that are tried in all their modes.
const MOST_DOUBTFUL: usize = 5;
/// Choices of modes times rows squared: what bounds the work on larger problems.
const WORK: usize = 100_000;

/// Rows that change their modes together, and the modes to choose from.
struct Doubt {
    rows: Vec<usize>,
    choices: Vec<Vec<Mode>>,
}

impl Lcp {
    /// All combinations of the modes of the rows that `solution` leaves most in doubt, the others as
    /// they are.
    pub fn neighbours(&self, solution: &LcpSolution) -> impl Iterator<Item = Vec<Mode>> + use<> {
        let margins = self.margins(solution);
        let mut rows: Vec<usize> = (0..margins.len()).collect();
        rows.sort_by(|a, b| margins[*a].total_cmp(&margins[*b]));
        let most = WORK / self.rows.len().pow(2).max(1);
        self.combinations(&solution.modes, &rows).take(most.max(1))
    }

    /// All combinations of the modes of the first few of `rows`, the others as in `modes`.
    fn combinations(
        &self,
        modes: &[Mode],
        rows: &[usize],
    ) -> impl Iterator<Item = Vec<Mode>> + use<> {
        let doubts = self.doubts(rows);
        let combinations: usize = doubts.iter().map(|doubt| doubt.choices.len()).product();
        let modes = modes.to_vec();
        (0..combinations).map(move |index| combination(&doubts, modes.clone(), index))
    }

    /// What the first few rows decide; a contact's normal and friction decide together.
    fn doubts(&self, rows: &[usize]) -> Vec<Doubt> {
        let mut leaders: Vec<usize> = Vec::new();
        for row in rows {
            let leader = match self.rows[*row].law {
                Law::Equality => continue,
                Law::Friction { normal, .. } => normal as usize,
                Law::Unilateral | Law::Bounded { .. } => *row,
            };
            if !leaders.contains(&leader) {
                leaders.push(leader);
            }
            if leaders.len() == MOST_DOUBTFUL {
                break;
            }
        }
        leaders.into_iter().map(|row| self.doubt(row)).collect()
    }

    fn doubt(&self, row: usize) -> Doubt {
        use Mode::{Active, Lower, Open, Upper};
        let own = |modes: &[Mode]| modes.iter().map(|mode| vec![*mode]).collect();
        match (self.rows[row].law, self.friction_of(row)) {
            (Law::Bounded { .. }, _) => {
                Doubt { rows: vec![row], choices: own(&[Active, Upper, Lower]) }
            }
            (_, None) => Doubt { rows: vec![row], choices: own(&[Active, Open]) },
            (_, Some(friction)) => {
                let pairs = [[Active, Active], [Active, Upper], [Active, Lower], [Open, Open]];
                Doubt { rows: vec![row, friction], choices: pairs.map(Vec::from).to_vec() }
            }
        }
    }

    /// The friction row of a normal row.
    pub(crate) fn friction_of(&self, row: usize) -> Option<usize> {
        let is_friction = |other: &usize| match self.rows[*other].law {
            Law::Friction { normal, .. } => normal as usize == row,
            _ => false,
        };
        (row + 1..self.rows.len()).find(is_friction)
    }
}

/// The combination of a number, read digit by digit.
fn combination(doubts: &[Doubt], mut modes: Vec<Mode>, mut index: usize) -> Vec<Mode> {
    for Doubt { rows, choices } in doubts {
        let choice = &choices[index % choices.len()];
        index /= choices.len();
        for (row, mode) in rows.iter().zip(choice) {
            modes[*row] = *mode;
        }
    }
    modes
}
