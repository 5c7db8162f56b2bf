//! Which parts of two shapes can touch: discrete, never differentiated.
//!
//! Parry's manifolds are not used here. Its half-plane manifolds give both points one identity, its
//! points carry positions instead of features, and where a box stands off the end of another it
//! reports side faces that a sliding box would catch on. What is needed is short:
//!
//! 1. Of both cores' edges take the one with the greatest separation (separating axes), and the
//!    other core's edge that faces it.
//! 2. Where the two edges lie over each other, either end of that part is a vertex of one against
//!    the line of the other: up to two contacts. Which core gave the first edge does not show in
//!    them, so identities survive when that changes.
//! 3. Where the cores are apart and two vertices are nearest, that pair leads.
//!
//! A sharp polygon that is flush with an edge beyond that edge's end is left alone: otherwise a box
//! sliding from one floor plate to the next would catch on the second plate's side.

use crate::{Part, pairing::Pairing, world::View};

/// Heights of a half-plane's vertices nearer than this times the shape's size tie.
const ROUNDING: f64 = 1e-11;

/// The parts of a and of b that touch.
pub(crate) type Pair = [Part; 2];

/// At most two pairs of parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Selection {
    /// The pairs.
    pub(crate) pairs: [Option<Pair>; 2],
}

impl Selection {
    /// A single pair.
    pub(crate) fn one(pair: Pair) -> Self {
        Self { pairs: [Some(pair), None] }
    }

    /// The selected pairs in ascending order.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Pair> {
        let [first, second] = self.pairs;
        let pairs = if first > second { [second, first] } else { [first, second] };
        pairs.into_iter().flatten()
    }

    /// `pair`, and one of these that shares no part with it: the far end of a nearly parallel edge.
    pub(crate) fn led_by(&self, pair: Pair) -> Self {
        let far = self.iter().find(|[p, q]| *p != pair[0] && *q != pair[1]);
        Self { pairs: [Some(pair), far] }
    }
}

/// What becomes of polygons that are flush with an edge beyond its end.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Seams {
    /// They are selected like all others.
    Keep,
    /// They are left alone, so that nothing catches on the far plate's side.
    Skip,
}

/// Which body has the edge.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Side {
    /// Body a.
    A,
    /// Body b.
    B,
}

impl Side {
    /// The pair of an edge of this side and a vertex of the other.
    pub(crate) fn pair(self, edge: usize, vertex: usize) -> Pair {
        let (edge, vertex) = (Part::Edge(part_number(edge)), Part::Vertex(part_number(vertex)));
        match self {
            Self::A => [edge, vertex],
            Self::B => [vertex, edge],
        }
    }

    /// The opposite side.
    pub(crate) fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// The pairs of parts of `a` and `b` that can touch; none beyond `reach`, m.
///
/// The nearest parts are among them, unless they are at a seam to be skipped.
pub(crate) fn select(a: &View<'_>, b: &View<'_>, reach: f64, seams: Seams) -> Selection {
    match (a.piece.unbounded, b.piece.unbounded) {
        (true, true) => Selection::default(),
        (true, false) => lowest(a, b, Side::A),
        (false, true) => lowest(b, a, Side::B),
        (false, false) => between_cores(a, b, reach, seams),
    }
}

/// Half-plane: the lowest vertex and the lower one of its neighbours.
fn lowest(plane: &View<'_>, core: &View<'_>, side: Side) -> Selection {
    let (count, size) = (core.vertices.len(), core.piece.size);
    let height = |k: usize| plane.normals[0].dot(&(core.vertices[k] - plane.vertices[0]));
    let lowest = first_least(count, height);
    let (next, last) = ((lowest + 1) % count, (lowest + count - 1) % count);
    let neighbour = if height(last) < height(next) - ROUNDING * size { last } else { next };
    let second = (neighbour != lowest).then(|| side.pair(0, neighbour));
    Selection { pairs: [Some(side.pair(0, lowest)), second] }
}

/// Two bounded shapes.
fn between_cores(a: &View<'_>, b: &View<'_>, reach: f64, seams: Seams) -> Selection {
    if a.normals.is_empty() && b.normals.is_empty() {
        return Selection::one([Part::Vertex(0); 2]); // two circles
    }
    let thickness = a.piece.radius + b.piece.radius;
    let Some(pairing) = Pairing::new(a, b, reach + thickness) else {
        return Selection::default();
    };
    let (selected, nearest) = pairing.selection();
    let catches = thickness == 0.0 && seams == Seams::Skip; // round sides roll over seams
    if catches && pairing.at_seam(nearest) { Selection::default() } else { selected }
}

/// The first k < count with the least value.
pub(crate) fn first_least(count: usize, value: impl Fn(usize) -> f64) -> usize {
    let lower = |(i, least): (usize, f64), k| {
        let v = value(k);
        if v < least { (k, v) } else { (i, least) }
    };
    (1..count).fold((0, value(0)), lower).0
}

/// Shapes have at most 65535 parts; `Shape::validate` sees to it.
pub(crate) fn part_number(index: usize) -> u16 {
    u16::try_from(index).expect("a valid shape has at most 65535 parts")
}
