//! An order of rows in which their matrix is a narrow band.

use crate::rows::Touching;
use crate::{Lcp, Scratch};

/// Below this number of rows a full matrix is as cheap as a band.
const SMALL: usize = 16;

/// Half-width of the band of the rows in the given order: the greatest distance of two rows that
/// share a body. `first` is working memory.
pub(crate) fn half_width(problem: &Lcp, rows: &[u32], first: &mut Vec<u32>) -> usize {
    let bodies = rows.iter().map(|row| problem.rows[*row as usize].bodies);
    greatest_distance(problem.mass.len(), bodies, first)
}

/// The same of all rows as they come.
pub(crate) fn half_width_of_all(problem: &Lcp, first: &mut Vec<u32>) -> usize {
    greatest_distance(problem.mass.len(), problem.rows.iter().map(|row| row.bodies), first)
}

fn greatest_distance(
    count: usize,
    rows: impl Iterator<Item = [u32; 2]>,
    first: &mut Vec<u32>,
) -> usize {
    first.clear();
    first.resize(count, u32::MAX);
    let mut greatest = 0;
    for (position, bodies) in (0..).zip(rows) {
        for body in bodies {
            if let Some(first) = first.get_mut(body as usize) {
                if *first == u32::MAX {
                    *first = position;
                }
                greatest = greatest.max(position - *first);
            }
        }
    }
    greatest as usize
}

/// Orders the rows by reverse Cuthill–McKee on their bodies where that narrows the band; returns
/// the half-width, which is `natural` in the order given.
pub(crate) fn narrow(
    problem: &Lcp,
    rows: &mut Vec<u32>,
    natural: usize,
    scratch: &mut Scratch,
) -> usize {
    if rows.len() <= SMALL || 2 * natural <= SMALL {
        return natural;
    }
    let position = cuthill_mckee(problem, rows);
    let mut sorted = rows.clone();
    sorted.sort_by_key(|&row| {
        let mut bodies = problem.rows[row as usize].blocks().map(|(body, _)| position[body]);
        let first = bodies.next().unwrap_or(0);
        let second = bodies.next().unwrap_or(first);
        (first.max(second), first.min(second), row)
    });
    let ordered = half_width(problem, &sorted, &mut scratch.spans);
    if ordered < natural {
        *rows = sorted;
    }
    ordered.min(natural)
}

/// Position of each body in a breadth-first walk over bodies that share a row; walks start at the
/// far end of a first walk, neighbours come by degree and then by index.
fn cuthill_mckee(problem: &Lcp, rows: &[u32]) -> Vec<usize> {
    let bodies = problem.mass.len();
    let graph = Graph {
        problem,
        rows,
        touching: Touching::new(problem, rows.iter().map(|&row| row as usize)),
    };
    let mut position = vec![usize::MAX; bodies];
    let mut count = 0;
    for body in 0..bodies {
        if position[body] == usize::MAX {
            let far = *graph.walk(body).last().unwrap_or(&body);
            for reached in graph.walk(far) {
                position[reached] = count;
                count += 1;
            }
        }
    }
    position
}

struct Graph<'a> {
    problem: &'a Lcp,
    rows: &'a [u32],
    touching: Touching,
}

impl Graph<'_> {
    fn neighbours(&self, body: usize) -> Vec<usize> {
        let other = |&(slot, side): &(u32, u32)| {
            let row = &self.problem.rows[self.rows[slot as usize] as usize];
            let body = row.bodies[1 - side as usize];
            (body != crate::NO_BODY).then_some(body as usize)
        };
        let mut found: Vec<usize> = self.touching.of(body).iter().filter_map(other).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    fn walk(&self, from: usize) -> Vec<usize> {
        let mut reached = vec![false; self.problem.mass.len()];
        reached[from] = true;
        let mut order = vec![from];
        let mut next = 0;
        while next < order.len() {
            let mut neighbours = self.neighbours(order[next]);
            neighbours.retain(|&body| !reached[body]);
            neighbours.sort_by_key(|&body| (self.touching.of(body).len(), body));
            for body in neighbours {
                reached[body] = true;
                order.push(body);
            }
            next += 1;
        }
        order
    }
}
