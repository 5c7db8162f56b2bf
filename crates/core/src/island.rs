//! Bodies that touch or are joined form an island: a problem of its own.

use nalgebra::Vector3;
use tangency_lcp::{Law, Lcp, NO_BODY, Row};

use crate::row::{RowContext, RowGeometry, RowSource, Stage};

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

/// Groups rows into islands, ordered by their lowest body, and assembles each.
pub(crate) fn assemble(
    context: &RowContext<'_>,
    momentum: &[Vector3<f64>],
    rows: &[RowSource],
) -> Vec<Island> {
    let geometry: Vec<RowGeometry> = rows.iter().map(|row| context.geometry(*row)).collect();
    let roots = roots(context, &geometry);
    let mut islands: Vec<Island> = Vec::new();
    let mut of_root = vec![usize::MAX; roots.len()];
    let mut local = vec![NO_BODY; roots.len()];
    let in_rows = |i: usize| roots[i] != usize::MAX;
    for body in (0..roots.len()).filter(|i| in_rows(*i)) {
        let root = roots[body];
        if of_root[root] == usize::MAX {
            of_root[root] = islands.len();
            let (bodies, sources, problem) = (Vec::new(), Vec::new(), Lcp::default());
            islands.push(Island { bodies, sources, problem, stage: context.stage });
        }
        let island = &mut islands[of_root[root]];
        local[body] = u32::try_from(island.bodies.len()).expect("fewer bodies than u32 counts");
        island.bodies.push(u32::try_from(body).expect("fewer bodies than u32 counts"));
        island.problem.mass.push(context.scene.bodies[body].mass);
        island.problem.momentum.push(momentum[body]);
    }
    for (source, geometry) in rows.iter().zip(&geometry) {
        let Some(body) = geometry.bodies.iter().flatten().find(|b| in_rows(**b)) else { continue };
        let island = &mut islands[of_root[roots[*body]]];
        let row = assemble_row(context, *source, geometry, &local, island.problem.rows.len());
        island.sources.push(*source);
        island.problem.rows.push(row);
    }
    islands
}

fn assemble_row(
    context: &RowContext<'_>,
    source: RowSource,
    geometry: &RowGeometry,
    local: &[u32],
    index: usize,
) -> Row {
    let mut row = Row {
        bodies: [NO_BODY; 2],
        jacobian: [Vector3::zeros(); 2],
        rhs: 0.0,
        compliance: 0.0,
        law: Law::Equality,
    };
    for side in 0..2 {
        let Some(body) = geometry.bodies[side].filter(|b| context.scene.is_dynamic(*b)) else {
            continue;
        };
        row.bodies[side] = local[body];
        row.jacobian[side] = geometry.jacobian[side];
    }
    set_right_side(context, source, geometry, &mut row);
    let normal = u32::try_from(index.saturating_sub(1)).expect("fewer rows than u32 counts");
    row.law = context.law(source, normal);
    row
}

/// b and c of a row; sides that are driven take their known velocity off b.
fn set_right_side(
    context: &RowContext<'_>,
    source: RowSource,
    geometry: &RowGeometry,
    row: &mut Row,
) {
    let (mut speed, mut driven) = (0.0, 0.0);
    for side in 0..2 {
        let Some(body) = geometry.bodies[side] else { continue };
        let part = geometry.jacobian[side].dot(&context.v[body]);
        speed += part;
        if !context.scene.is_dynamic(body) && context.stage.is_velocity() {
            driven += part;
        }
    }
    let rhs = context.rhs(source, geometry.value, speed);
    row.rhs = rhs.value - driven;
    row.compliance = rhs.compliance;
}

/// The lowest body of each dynamic body's island; `usize::MAX` for bodies without rows.
fn roots(context: &RowContext<'_>, geometry: &[RowGeometry]) -> Vec<usize> {
    let mut parent = vec![usize::MAX; context.scene.bodies.len()];
    for row in geometry {
        let mut first = usize::MAX;
        for body in row.bodies.iter().flatten().filter(|b| context.scene.is_dynamic(**b)) {
            if parent[*body] == usize::MAX {
                parent[*body] = *body;
            }
            let root = find(&mut parent, *body);
            if first == usize::MAX {
                first = root;
            } else {
                let (low, high) = (first.min(root), first.max(root));
                parent[high] = low;
            }
        }
    }
    (0..parent.len())
        .map(|i| if parent[i] == usize::MAX { usize::MAX } else { find(&mut parent, i) })
        .collect()
}

fn find(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}
