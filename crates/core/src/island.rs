//! Bodies that touch or are joined form an island: a problem of its own.

use nalgebra::Vector3;
use tangency_lcp::{Law, Lcp, NO_BODY, Row};

use crate::row::{RowContext, RowSource, Stage};
use crate::rows::{Rows, set_right_side};
use crate::scratch::StepScratch;

/// The problem of one island, and what its bodies and rows are.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Island {
    /// Scene indices of the problem's bodies, ascending.
    pub(crate) bodies: Vec<u32>,
    /// Where each row comes from.
    pub(crate) sources: Vec<RowSource>,
    /// The problem.
    pub(crate) problem: Lcp,
    /// Which problem it is.
    pub(crate) stage: Stage,
}

impl Island {
    /// The same island in another stage; `None` if the stage asks for the same.
    pub(crate) fn at(&self, context: &RowContext<'_>) -> Option<Self> {
        let mut island = Self { stage: context.stage, ..self.clone() };
        for (source, row) in self.sources.iter().zip(&mut island.problem.rows) {
            set_right_side(context, *source, &context.geometry(*source), row);
        }
        island.problem.soften(|row| context.softness(self.sources[row]));
        (island.problem.rows != self.problem.rows).then_some(island)
    }
}

/// Which bodies belong together, by disjoint sets; [`NO_BODY`] stands for none.
#[derive(Debug, Default)]
pub(crate) struct Groups {
    /// A body of the same set with a lower index, or the body itself if it has the lowest.
    parent: Vec<u32>,
    /// The island of the set whose lowest body this is.
    island: Vec<u32>,
    /// Index of the body within its island.
    local: Vec<u32>,
    /// How many bodies are in a set.
    bound: usize,
    /// How many sets there are.
    sets: usize,
}

impl Groups {
    /// Joins the bodies of every row.
    fn join(&mut self, bodies: usize, rows: &[Row]) {
        for list in [&mut self.parent, &mut self.island, &mut self.local] {
            list.clear();
            list.resize(bodies, NO_BODY);
        }
        (self.bound, self.sets) = (0, 0);
        let mut last = [NO_BODY; 2];
        for row in rows {
            if row.bodies == last {
                continue;
            }
            last = row.bodies;
            match row.bodies.map(|body| self.root(body)) {
                [NO_BODY, _] | [_, NO_BODY] => {}
                [a, b] if a == b => {}
                [a, b] => {
                    self.parent[a.max(b) as usize] = a.min(b);
                    self.sets -= 1;
                }
            }
        }
    }

    /// Whether all bodies are one island.
    fn is_whole(&self) -> bool {
        self.sets == 1 && self.bound == self.parent.len()
    }

    /// The lowest body of a body's set, which it founds if it is in none.
    fn root(&mut self, body: u32) -> u32 {
        if body == NO_BODY {
            return NO_BODY;
        }
        let mut i = body;
        if self.parent[i as usize] == NO_BODY {
            self.parent[i as usize] = body;
            self.bound += 1;
            self.sets += 1;
        }
        while self.parent[i as usize] != i {
            self.parent[i as usize] = self.parent[self.parent[i as usize] as usize];
            i = self.parent[i as usize];
        }
        i
    }

    /// The island of a row, if it has a body.
    fn island_of(&mut self, row: &Row) -> Option<usize> {
        let body = row.bodies.into_iter().find(|body| *body != NO_BODY)?;
        let root = self.root(body);
        Some(self.island[root as usize] as usize)
    }

    /// A row over the bodies of its island, in which `before` is the row before it.
    fn localise(&self, row: &mut Row, before: u32) {
        row.bodies = row.bodies.map(|body| match body {
            NO_BODY => NO_BODY,
            body => self.local[body as usize],
        });
        if let Law::Friction { normal, .. } = &mut row.law {
            *normal = before;
        }
    }
}

/// Groups rows into islands, ordered by their lowest body; takes the rows.
pub(crate) fn assemble(
    context: &RowContext<'_>,
    momentum: &[Vector3<f64>],
    rows: &mut Rows,
    scratch: &mut StepScratch,
) -> Vec<Island> {
    let mut groups = std::mem::take(&mut scratch.groups);
    let mut islands = scratch.islands.take();
    groups.join(momentum.len(), &rows.list);
    if groups.is_whole() && rows.list.iter().all(is_bound) {
        islands.push(whole(context, momentum, rows, scratch));
        scratch.groups = groups;
        return islands;
    }
    for (body, momentum) in momentum.iter().enumerate() {
        let (parent, number) = (groups.parent[body], number(body));
        if parent == NO_BODY {
            continue;
        }
        let root = groups.root(number) as usize;
        if parent == number {
            groups.island[root] = self::number(islands.len());
            islands.push(scratch.island(context.stage));
        }
        let island = &mut islands[groups.island[root] as usize];
        groups.local[body] = self::number(island.bodies.len());
        island.bodies.push(number);
        island.problem.mass.push(context.scene.bodies[body].mass);
        island.problem.momentum.push(*momentum);
    }
    distribute(&mut groups, rows, &mut islands);
    scratch.groups = groups;
    islands
}

/// The island of all bodies: the scene's indices are its own.
fn whole(
    context: &RowContext<'_>,
    momentum: &[Vector3<f64>],
    rows: &mut Rows,
    scratch: &mut StepScratch,
) -> Island {
    let mut island = scratch.island(context.stage);
    island.bodies.extend(0..number(momentum.len()));
    island.problem.mass.extend(context.scene.bodies.iter().map(|body| body.mass));
    island.problem.momentum.extend_from_slice(momentum);
    std::mem::swap(&mut island.sources, &mut rows.sources);
    std::mem::swap(&mut island.problem.rows, &mut rows.list);
    island
}

fn is_bound(row: &Row) -> bool {
    row.bodies != [NO_BODY; 2]
}

/// Gives every row to its island.
fn distribute(groups: &mut Groups, rows: &mut Rows, islands: &mut [Island]) {
    if let [island] = islands
        && rows.list.iter().all(is_bound)
    {
        std::mem::swap(&mut island.sources, &mut rows.sources);
        std::mem::swap(&mut island.problem.rows, &mut rows.list);
        for (index, row) in island.problem.rows.iter_mut().enumerate() {
            groups.localise(row, number(index.saturating_sub(1)));
        }
        return;
    }
    for (source, row) in rows.sources.drain(..).zip(rows.list.drain(..)) {
        let Some(index) = groups.island_of(&row) else { continue };
        let island = &mut islands[index];
        let (mut row, before) = (row, number(island.problem.rows.len()).saturating_sub(1));
        groups.localise(&mut row, before);
        island.sources.push(source);
        island.problem.rows.push(row);
    }
}

fn number(index: usize) -> u32 {
    u32::try_from(index).expect("fewer bodies and rows than u32 counts")
}
