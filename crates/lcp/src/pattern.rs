//! In which order bodies are eliminated, and which blocks that fills.
//!
//! Bodies are the vertices of a graph, pairs that share a row its edges. Eliminating a body joins its
//! later neighbours to each other. For convex bodies in the plane the graph is planar, and a good order
//! (approximate minimum degree; Amestoy, Davis & Duff 1996) keeps the fill near n log n.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

use crate::{Lcp, NO_BODY};

/// Elimination order and fill of one graph of bodies; kept as long as the graph stays.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    bodies: usize,
    /// The pair of bodies of each run of rows that share it: what the pattern was made from.
    runs: Vec<[u32; 2]>,
    /// Position of each body in the order of elimination.
    pub(crate) position: Vec<u32>,
    /// First block of each column, and the end of the last.
    pub(crate) start: Vec<u32>,
    /// Row (position) of each block below the diagonal, ascending within a column.
    pub(crate) row: Vec<u32>,
    /// For each column and each pair a ≤ b of its blocks: the block at (row b, row a), which is the
    /// diagonal one where a = b.
    pub(crate) target: Vec<u32>,
    /// The block of each run; [`NO_BLOCK`] where a body is alone.
    pub(crate) block: Vec<u32>,
}

/// The patterns of the problems that came last.
#[derive(Clone, Debug, Default)]
pub(crate) struct Patterns(Vec<Arc<Pattern>>);

/// More islands than this with a pattern of their own each are ordered anew every time.
const KEPT: usize = 16;

impl Patterns {
    /// The pattern of a problem.
    pub(crate) fn of(&mut self, problem: &Lcp) -> Arc<Pattern> {
        if let Some(known) = self.0.iter().find(|pattern| pattern.fits(problem)) {
            return Arc::clone(known);
        }
        if self.0.len() == KEPT {
            self.0.remove(0);
        }
        self.0.push(Arc::new(Pattern::new(problem)));
        Arc::clone(&self.0[self.0.len() - 1])
    }
}

/// A run that has no block off the diagonal.
pub(crate) const NO_BLOCK: u32 = u32::MAX;

impl Pattern {
    /// Whether it is the pattern of `problem`.
    pub(crate) fn fits(&self, problem: &Lcp) -> bool {
        self.bodies == problem.mass.len() && runs(problem).eq(self.runs.iter().copied())
    }

    /// Of a problem's bodies and rows.
    pub(crate) fn new(problem: &Lcp) -> Self {
        let bodies = problem.mass.len();
        let runs: Vec<[u32; 2]> = runs(problem).collect();
        let position = minimum_degree(bodies, &edges(&runs));
        let columns = fill(bodies, &edges(&runs), &position);
        let mut pattern = Self {
            bodies,
            runs,
            position,
            start: vec![0],
            row: columns.concat(),
            target: Vec::new(),
            block: Vec::new(),
        };
        for column in &columns {
            pattern.start.push(pattern.start[pattern.start.len() - 1] + number(column.len()));
        }
        pattern.target = columns.iter().flat_map(|rows| pattern.targets(rows)).collect();
        pattern.block = pattern.runs.iter().map(|run| pattern.block_of(*run)).collect();
        pattern
    }

    /// Number of bodies.
    pub(crate) fn bodies(&self) -> usize {
        self.bodies
    }

    /// Number of blocks off the diagonal.
    pub(crate) fn blocks(&self) -> usize {
        self.row.len()
    }

    /// Number of block products of a factorisation.
    pub(crate) fn products(&self) -> usize {
        self.target.len() + self.row.len()
    }

    /// Blocks of one column.
    pub(crate) fn column(&self, j: usize) -> std::ops::Range<usize> {
        self.start[j] as usize..self.start[j + 1] as usize
    }

    /// The block of each row of the problem that this is the pattern of.
    pub(crate) fn list_blocks(&self, problem: &Lcp, blocks: &mut Vec<u32>) {
        let mut last = None;
        let mut next = self.block.iter();
        for row in &problem.rows {
            if last == Some(row.bodies) {
                blocks.push(blocks[blocks.len() - 1]);
            } else {
                blocks.extend(next.next());
                last = Some(row.bodies);
            }
        }
    }

    fn targets(&self, rows: &[u32]) -> Vec<u32> {
        let mut targets = Vec::new();
        for (a, first) in rows.iter().enumerate() {
            targets.push(*first);
            targets.extend(rows[a + 1..].iter().map(|second| self.find(*first, *second)));
        }
        targets
    }

    fn block_of(&self, run: [u32; 2]) -> u32 {
        if run.contains(&NO_BODY) {
            return NO_BLOCK;
        }
        let [a, b] = run.map(|body| self.position[body as usize]);
        self.find(a.min(b), a.max(b))
    }

    /// The block at (row, column).
    fn find(&self, column: u32, row: u32) -> u32 {
        let range = self.column(column as usize);
        let found = self.row[range.clone()].binary_search(&row).expect("filled");
        number(range.start + found)
    }
}

/// The pairs of bodies, one for all rows in sequence that share them.
fn runs(problem: &Lcp) -> impl Iterator<Item = [u32; 2]> {
    let mut last = None;
    problem
        .rows
        .iter()
        .map(|row| row.bodies)
        .filter(move |bodies| last.replace(*bodies) != Some(*bodies))
}

/// Pairs of two bodies, lower index first, sorted, each once.
fn edges(runs: &[[u32; 2]]) -> Vec<[u32; 2]> {
    let both = runs.iter().filter(|run| !run.contains(&NO_BODY) && run[0] != run[1]);
    let mut edges: Vec<[u32; 2]> = both.map(|[a, b]| [*a.min(b), *a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Position of each body by approximate minimum degree; as they come if that fails.
fn minimum_degree(bodies: usize, edges: &[[u32; 2]]) -> Vec<u32> {
    // Column b holds a < b: the upper triangle.
    let mut sorted: Vec<[u32; 2]> = edges.iter().map(|[a, b]| [*b, *a]).collect();
    sorted.sort_unstable();
    let mut start = vec![0_u32; bodies + 1];
    for [column, _] in &sorted {
        start[*column as usize + 1] += 1;
    }
    for body in 0..bodies {
        start[body + 1] += start[body];
    }
    let rows: Vec<u32> = sorted.iter().map(|[_, row]| *row).collect();
    let upper = SymbolicSparseColMatRef::new_checked(bodies, bodies, &start, None, &rows);
    let mut memory = MemBuffer::new(amd::order_scratch::<u32>(bodies, rows.len()));
    let (mut order, mut position) = (vec![0_u32; bodies], vec![0_u32; bodies]);
    let stack = MemStack::new(&mut memory);
    match amd::order(&mut order, &mut position, upper, amd::Control::default(), stack) {
        Ok(_) => position,
        Err(_) => (0..number(bodies)).collect(),
    }
}

/// Rows of the blocks below the diagonal, column by column.
///
/// ```text
///  rows(j) = { later neighbours of j }  ∪  ⋃ { rows(c) \ j : the first row of c is j }
/// ```
fn fill(bodies: usize, edges: &[[u32; 2]], position: &[u32]) -> Vec<Vec<u32>> {
    let mut columns: Vec<Vec<u32>> = vec![Vec::new(); bodies];
    for edge in edges {
        let [a, b] = edge.map(|body| position[body as usize]);
        columns[a.min(b) as usize].push(a.max(b));
    }
    for j in 0..bodies {
        let (done, later) = columns.split_at_mut(j + 1);
        let column = &mut done[j];
        column.sort_unstable();
        column.dedup();
        if let Some((parent, rest)) = column.split_first() {
            later[*parent as usize - j - 1].extend_from_slice(rest);
        }
    }
    columns
}

fn number(count: usize) -> u32 {
    u32::try_from(count).expect("fewer blocks than u32 counts")
}
