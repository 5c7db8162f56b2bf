//! Two convex cores and the parts of them that can touch.

use nalgebra::Vector2;

use crate::{
    Part,
    edge::Edge,
    select::{Pair, Selection, Side, first_least, part_number},
    world::View,
};

/// Lengths below this times the shapes' size are rounding.
const ROUNDING: f64 = 1e-11;

/// A polygon this near to the line of an edge is flush with it, relative to the shapes' size.
///
/// Wide enough for the penetration that a solver leaves.
const FLUSH: f64 = 1e-6;

/// Sine of the greatest angle at which two edges at a seam count as parallel.
const PARALLEL: f64 = 1e-3;

/// Two cores and the edge between them.
pub(crate) struct Pairing<'a> {
    a: &'a View<'a>,
    b: &'a View<'a>,
    /// Whose edge is between them.
    side: Side,
    face: Face<'a>,
    /// Whether either core is flush with the line of some edge of the other.
    flush: bool,
    /// Lengths below this are rounding, m.
    rounding: f64,
}

/// One edge of a core against the whole of another core.
#[derive(Clone, Copy)]
struct Face<'a> {
    edge: Edge<'a>,
    /// Least height of the other core's vertices over the edge, m.
    separation: f64,
    /// The vertex at that height.
    support: usize,
}

impl<'a> Pairing<'a> {
    /// Finds the edge with the greatest separation; ties favour body a. None for two circles.
    pub(crate) fn new(a: &'a View<'a>, b: &'a View<'a>) -> Option<Self> {
        let rounding = ROUNDING * (a.size + b.size);
        let (of_a, of_b) = (Survey::new(a, b, rounding), Survey::new(b, a, rounding));
        let (side, face) = match (of_a.widest, of_b.widest) {
            (Some(f), Some(g)) if g.separation > f.separation + rounding => (Side::B, g),
            (None, Some(g)) => (Side::B, g),
            (Some(f), _) => (Side::A, f),
            (None, None) => return None,
        };
        Some(Self { a, b, side, face, flush: of_a.flush || of_b.flush, rounding })
    }

    /// Separation of the cores along the best edge's normal, m; at most their distance.
    pub(crate) fn separation(&self) -> f64 {
        self.face.separation
    }

    /// The pairs of parts that can touch; the nearest are among them.
    pub(crate) fn selection(&self) -> Selection {
        let ends = self.ends();
        let nearest = self.least_gap(&ends);
        let support = Selection::one(self.side.pair(self.face.edge.index, self.face.support));
        if self.overlapping() {
            // Overlapping cores have at least one contact that says so, up to rounding: of two faces
            // that just touch, the ends' heights may come out positive.
            return if nearest <= self.rounding { ends } else { support };
        }
        if nearest <= self.face.separation + self.rounding {
            return ends; // no two points can be nearer than the separation
        }
        let ([v, w], distance) = self.nearest_vertices();
        if distance <= self.rounding {
            support // a direction between coincident vertices is noise
        } else if distance < nearest {
            ends.led_by([Part::Vertex(part_number(v)), Part::Vertex(part_number(w))])
        } else {
            ends
        }
    }

    /// Whether one polygon touches no more than the prolongation of the other's edge.
    pub(crate) fn at_seam(&self, selected: &Selection) -> bool {
        let flush = FLUSH * (self.a.size + self.b.size);
        if self.least_gap(selected) > flush {
            return self.flush;
        }
        self.parallel_overlap().is_some_and(|overlap| overlap <= flush)
    }

    /// Both ends of the part where the edge and the edge facing it lie over each other.
    fn ends(&self) -> Selection {
        let edge = self.face.edge;
        let of_facing = |vertex: usize| Some(self.side.pair(edge.index, vertex));
        let Some(facing) = self.facing() else {
            let over = edge.is_under(&self.other().vertices[0], self.rounding);
            return Selection { pairs: [if over { of_facing(0) } else { None }, None] };
        };
        // Where both have a vertex at an end, the facing edge's is enough: hence −rounding.
        let of_edge = |end: usize| {
            let over = facing.is_under(&edge.end_points()[end], -self.rounding);
            over.then(|| self.side.other().pair(facing.index, edge.ends()[end]))
        };
        let [start, end] = facing.ends();
        // Edges that face each other run in opposite directions, so start goes with start.
        let pairs = match facing.end_points().map(|x| edge.is_under(&x, self.rounding)) {
            [true, true] => [of_facing(start), of_facing(end)],
            [true, false] => [of_facing(start), of_edge(0)],
            [false, true] => [of_facing(end), of_edge(1)],
            [false, false] if covers(&facing, &edge) => [of_edge(0), of_edge(1)],
            [false, false] => [None, None],
        };
        Selection { pairs }
    }

    /// Whether the cores overlap.
    ///
    /// For two cores without area a separation of zero decides nothing: they may be in line.
    fn overlapping(&self) -> bool {
        let thin = self.a.vertices.len() < 3 && self.b.vertices.len() < 3;
        self.face.separation <= if thin { -self.rounding } else { 0.0 }
    }

    /// Length over which the edge and a parallel one facing it lie over each other, m.
    fn parallel_overlap(&self) -> Option<f64> {
        let (edge, facing) = (self.face.edge, self.facing()?);
        if edge.normal().perp(&facing.normal()).abs() > PARALLEL {
            return None;
        }
        let [low, high] = edge.shadow_of(&facing);
        Some(high.min(edge.length()) - low.max(0.0))
    }

    /// The other core's edge that faces the edge; none for a circle.
    fn facing(&self) -> Option<Edge<'a>> {
        Edge::facing(self.other(), self.face.support, &self.face.edge.normal(), ROUNDING)
    }

    fn other(&self) -> &'a View<'a> {
        match self.side {
            Side::A => self.b,
            Side::B => self.a,
        }
    }

    /// Least distance of the cores among the pairs, m; infinite for none.
    fn least_gap(&self, pairs: &Selection) -> f64 {
        let (a, b) = (self.a, self.b);
        let at = |core: &View<'_>, k: u16| -> Vector2<f64> { core.vertices[usize::from(k)] };
        let gap = |pair: Pair| match pair {
            [Part::Vertex(v), Part::Vertex(w)] => (at(b, w) - at(a, v)).norm(),
            [Part::Edge(e), Part::Vertex(w)] => Edge::new(a, usize::from(e)).height(&at(b, w)),
            [Part::Vertex(v), Part::Edge(e)] => Edge::new(b, usize::from(e)).height(&at(a, v)),
            [Part::Edge(_), Part::Edge(_)] => f64::INFINITY, // never selected
        };
        pairs.iter().map(gap).fold(f64::INFINITY, f64::min)
    }

    /// The nearest two vertices and their distance, m.
    fn nearest_vertices(&self) -> ([usize; 2], f64) {
        let (a, b) = (self.a.vertices, self.b.vertices);
        let squared = |k: usize| (b[k % b.len()] - a[k / b.len()]).norm_squared();
        let k = first_least(a.len() * b.len(), squared);
        ([k / b.len(), k % b.len()], squared(k).sqrt())
    }
}

/// All edges of a core against the whole of another core.
struct Survey<'a> {
    /// The edge with the greatest separation; ties favour the lower number.
    widest: Option<Face<'a>>,
    /// Whether the other core is flush with the line of some edge.
    flush: bool,
}

impl<'a> Survey<'a> {
    fn new(core: &'a View<'a>, other: &'a View<'a>, rounding: f64) -> Self {
        let (mut widest, mut flush) = (None, false);
        let mut greatest = f64::NEG_INFINITY;
        let tolerance = FLUSH * (core.size + other.size);
        for (index, (n, p)) in core.normals.iter().zip(core.vertices).enumerate() {
            let (support, separation) = lowest(n, p, other.vertices);
            flush |= separation.abs() <= tolerance;
            if separation > greatest + rounding {
                greatest = separation;
                widest = Some(Face { edge: Edge::new(core, index), separation, support });
            }
        }
        Self { widest, flush }
    }
}

/// The lowest vertex over the line with normal `n` through `p`, and its height, m.
fn lowest(n: &Vector2<f64>, p: &Vector2<f64>, vertices: &[Vector2<f64>]) -> (usize, f64) {
    let heights = vertices.iter().map(|v| n.dot(&(v - p))).enumerate();
    heights.fold((0, f64::INFINITY), |low, (k, h)| if h < low.1 { (k, h) } else { low })
}

/// Whether an edge reaches beyond both ends of the one that it faces.
fn covers(facing: &Edge<'_>, edge: &Edge<'_>) -> bool {
    let [low, high] = edge.shadow_of(facing);
    low < 0.0 && high > edge.length()
}
