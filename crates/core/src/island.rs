//! Bodies that touch or are joined form an island: a problem of its own.

use nalgebra::Vector3;
use tangency_lcp::{Lcp, NO_BODY, Row};

use crate::row::{RowContext, RowGeometry, RowSource, Stage};
use crate::rows::Rows;
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
}

impl Groups {
    /// Joins the dynamic bodies of every row.
    fn join(&mut self, context: &RowContext<'_>, geometry: &[RowGeometry]) {
        let bodies = context.scene.bodies.len();
        for list in [&mut self.parent, &mut self.island, &mut self.local] {
            list.clear();
            list.resize(bodies, NO_BODY);
        }
        for row in geometry {
            let mut first = NO_BODY;
            for body in row.bodies.into_iter().flatten().filter(|b| context.scene.is_dynamic(*b)) {
                if self.parent[body] == NO_BODY {
                    self.parent[body] = number(body);
                }
                let root = self.root(body);
                if first == NO_BODY {
                    first = root;
                } else {
                    self.parent[first.max(root) as usize] = first.min(root);
                }
            }
        }
    }

    fn root(&mut self, body: usize) -> u32 {
        let mut i = body;
        while self.parent[i] as usize != i {
            self.parent[i] = self.parent[self.parent[i] as usize];
            i = self.parent[i] as usize;
        }
        number(i)
    }

    /// The island of a body that has rows.
    fn island_of(&mut self, body: usize) -> Option<usize> {
        if self.parent[body] == NO_BODY {
            return None;
        }
        let root = self.root(body);
        Some(self.island[root as usize] as usize)
    }
}

/// Groups rows into islands, ordered by their lowest body, and assembles each.
pub(crate) fn assemble(
    context: &RowContext<'_>,
    momentum: &[Vector3<f64>],
    rows: &Rows,
    scratch: &mut StepScratch,
) -> Vec<Island> {
    let mut groups = std::mem::take(&mut scratch.groups);
    let mut islands = scratch.islands.take();
    groups.join(context, &rows.geometry);
    for (body, momentum) in momentum.iter().enumerate() {
        if groups.parent[body] == NO_BODY {
            continue;
        }
        if groups.parent[body] == number(body) {
            groups.island[body] = number(islands.len());
            islands.push(scratch.island(context.stage));
        }
        let index = groups.island_of(body).expect("it has rows");
        let island = &mut islands[index];
        groups.local[body] = number(island.bodies.len());
        island.bodies.push(number(body));
        island.problem.mass.push(context.scene.bodies[body].mass);
        island.problem.momentum.push(*momentum);
    }
    for (source, geometry) in rows.sources.iter().zip(&rows.geometry) {
        let mut sides = geometry.bodies.iter().flatten();
        let Some(index) = sides.find_map(|body| groups.island_of(*body)) else { continue };
        let island = &mut islands[index];
        let before = number(island.problem.rows.len()).saturating_sub(1);
        let row = assemble_row(context, *source, geometry, &groups.local, before);
        island.sources.push(*source);
        island.problem.rows.push(row);
    }
    scratch.groups = groups;
    islands
}

/// `before` is the index of the row before it.
fn assemble_row(
    context: &RowContext<'_>,
    source: RowSource,
    geometry: &RowGeometry,
    local: &[u32],
    before: u32,
) -> Row {
    let mut row = Row {
        bodies: [NO_BODY; 2],
        jacobian: [Vector3::zeros(); 2],
        rhs: 0.0,
        compliance: 0.0,
        law: context.law(source, before),
    };
    for side in 0..2 {
        let Some(body) = geometry.bodies[side].filter(|b| context.scene.is_dynamic(*b)) else {
            continue;
        };
        row.bodies[side] = local[body];
        row.jacobian[side] = geometry.jacobian[side];
    }
    set_right_side(context, source, geometry, &mut row);
    row
}

/// b and c of a row; sides that are driven take their known velocity off b.
fn set_right_side(
    context: &RowContext<'_>,
    source: RowSource,
    geometry: &RowGeometry,
    row: &mut Row,
) {
    let bounces = matches!(source, RowSource::Normal { .. });
    let speed = if bounces { context.speed(geometry) } else { 0.0 };
    let rhs = context.rhs(source, geometry.value, speed);
    row.rhs = rhs.value;
    row.compliance = rhs.compliance;
    if !context.stage.is_velocity() {
        return;
    }
    for side in 0..2 {
        let Some(body) = geometry.bodies[side] else { continue };
        if !context.scene.is_dynamic(body) {
            row.rhs -= geometry.jacobian[side].dot(&context.v[body]);
        }
    }
}

fn number(index: usize) -> u32 {
    u32::try_from(index).expect("fewer bodies and rows than u32 counts")
}
