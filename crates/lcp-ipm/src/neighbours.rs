//! Other modes of the rows that a candidate leaves in doubt: where a few contacts barely touch, or
//! hold each other with impulses of any size, an approximate solution does not show their modes.

use tangency_lcp::{Law, Lcp, LcpSolution, Mode};

/// Most doubtful contacts, limits or motors that are tried in all their modes.
const MOST_DOUBTFUL: usize = 5;
/// Choices of modes times rows squared: what bounds the work on larger problems.
const WORK: usize = 100_000;

/// Rows that change their modes together, and the modes to choose from.
struct Doubt {
    rows: Vec<usize>,
    choices: Vec<Vec<Mode>>,
    margin: f64,
}

/// All combinations of the most doubtful rows' modes, the other rows as in `solution`.
pub(crate) fn neighbours(problem: &Lcp, solution: &LcpSolution) -> impl Iterator<Item = Vec<Mode>> {
    let mut doubts = doubts(problem, solution);
    doubts.sort_by(|a, b| a.margin.total_cmp(&b.margin));
    doubts.truncate(MOST_DOUBTFUL);
    let combinations: usize = doubts.iter().map(|doubt| doubt.choices.len()).product();
    let most = (WORK / problem.rows.len().pow(2).max(1)).max(1);
    let modes = solution.modes.clone();
    (0..combinations.min(most)).map(move |index| combination(&doubts, modes.clone(), index))
}

/// The combination of a number, read digit by digit.
fn combination(doubts: &[Doubt], mut modes: Vec<Mode>, mut index: usize) -> Vec<Mode> {
    for Doubt { rows, choices, .. } in doubts {
        let choice = &choices[index % choices.len()];
        index /= choices.len();
        for (row, mode) in rows.iter().zip(choice) {
            modes[*row] = *mode;
        }
    }
    modes
}

fn doubts(problem: &Lcp, solution: &LcpSolution) -> Vec<Doubt> {
    use Mode::{Active, Lower, Open, Upper};
    let margins = problem.margins(solution);
    let mut doubts: Vec<Doubt> = Vec::new();
    let mut of_row = vec![usize::MAX; problem.rows.len()];
    for (i, row) in problem.rows.iter().enumerate() {
        let margin = margins[i];
        match row.law {
            Law::Equality => {}
            Law::Unilateral => {
                of_row[i] = doubts.len();
                doubts.push(Doubt {
                    rows: vec![i],
                    choices: vec![vec![Active], vec![Open]],
                    margin,
                });
            }
            Law::Bounded { .. } => {
                let choices = vec![vec![Active], vec![Upper], vec![Lower]];
                doubts.push(Doubt { rows: vec![i], choices, margin });
            }
            Law::Friction { normal, .. } => {
                let contact = &mut doubts[of_row[normal as usize]];
                contact.rows.push(i);
                contact.choices =
                    [[Active, Active], [Active, Upper], [Active, Lower], [Open, Open]]
                        .map(Vec::from)
                        .to_vec();
                contact.margin = contact.margin.min(margin);
            }
        }
    }
    doubts
}
