//! Which rows are active, slide or are saturated, given their modes.

use crate::{Fold, Law, Lcp, Mode, Scratch};

#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
pub(crate) fn list_active(problem: &Lcp, modes: &[Mode], rows: &mut Vec<u32>) {
    let active = |&row: &usize| match problem.rows[row].law {
        Law::Equality => true,
        Law::Unilateral | Law::Bounded { .. } => modes[row] == Mode::Active,
        Law::Friction { normal, .. } => {
            modes[row] == Mode::Active && modes[normal as usize] == Mode::Active
        }
    };
    rows.clear();
    rows.extend((0..problem.rows.len()).filter(active).map(|row| row as u32));
}

/// ±1 for a row on a bound.
fn direction(mode: Mode) -> Option<f64> {
    match mode {
        Mode::Upper => Some(1.0),
        Mode::Lower => Some(-1.0),
        Mode::Active | Mode::Open => None,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
pub(crate) fn list_folds(
    problem: &Lcp,
    modes: &[Mode],
    rows: &[u32],
    folds: &mut Vec<Fold>,
    scratch: &mut Scratch,
) {
    folds.clear();
    for (row, mode) in modes.iter().enumerate() {
        let Law::Friction { normal, mu } = problem.rows[row].law else { continue };
        let Some(sign) = direction(*mode) else { continue };
        if modes[normal as usize] == Mode::Active {
            folds.push(Fold { row: row as u32, column: normal, coefficient: sign * mu });
        }
    }
    place_folds(problem, rows, folds, scratch);
}

/// Turns the normal rows that folds name into their slots.
#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
pub(crate) fn place_folds(problem: &Lcp, rows: &[u32], folds: &mut [Fold], scratch: &mut Scratch) {
    if folds.is_empty() {
        return;
    }
    let mut slots = scratch.indices.filled(problem.rows.len(), u32::MAX);
    for (slot, &row) in rows.iter().enumerate() {
        slots[row as usize] = slot as u32;
    }
    for fold in folds {
        fold.column = slots[fold.column as usize];
    }
    scratch.indices.give(slots);
}

#[expect(clippy::cast_possible_truncation, reason = "row indices are u32")]
pub(crate) fn list_saturated(problem: &Lcp, modes: &[Mode], saturated: &mut Vec<(u32, f64)>) {
    saturated.clear();
    saturated.extend(modes.iter().enumerate().filter_map(
        |(row, mode)| match problem.rows[row].law {
            Law::Bounded { max } => direction(*mode).map(|sign| (row as u32, sign * max)),
            _ => None,
        },
    ));
}
