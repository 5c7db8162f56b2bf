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

/// What depends on which of two edges is the wider is certain beyond this many roundings.
const DOUBT: f64 = 4.0;

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
    edge: Edge,
    /// Least height of the other core's vertices over the edge, m.
    separation: f64,
    /// The vertex at that height.
    support: usize,
    /// The other core's edge that faces the edge; none for a circle.
    facing: Option<Edge>,
    /// Whether either core is flush with the line of some edge of the other.
    flush: bool,
    /// Lengths below this are rounding, m.
    rounding: f64,
}

/// One edge of a core against the whole of another core.
#[derive(Clone, Copy)]
struct Face {
    edge: usize,
    /// Least height of the other core's vertices over the edge, m.
    separation: f64,
    /// The vertex at that height.
    support: usize,
}

impl<'a> Pairing<'a> {
    /// Finds the edge with the greatest separation; ties favour body a. None for two circles, and
    /// for cores that some edge parts by more than `reach`, m.
    pub(crate) fn new(a: &'a View<'a>, b: &'a View<'a>, reach: f64) -> Option<Self> {
        let rounding = ROUNDING * (a.piece.size + b.piece.size);
        let of_a = Survey::new([a, b], rounding, reach, f64::NEG_INFINITY)?;
        let least = of_a.widest.map_or(f64::NEG_INFINITY, |f| f.separation);
        let of_b = Survey::new([b, a], rounding, reach, least)?;
        let (side, face) = match (of_a.widest, of_b.widest) {
            (Some(f), Some(g)) if g.separation > f.separation + rounding => (Side::B, g),
            (None, Some(g)) => (Side::B, g),
            (Some(f), _) => (Side::A, f),
            (None, None) => return None,
        };
        if face.separation > reach {
            return None;
        }
        let (own, other) = if side == Side::A { (a, b) } else { (b, a) };
        let Face { edge, separation, support } = face;
        let edge = Edge::new(own, edge);
        let facing = Edge::facing(other, support, &edge.normal, ROUNDING);
        let flush = of_a.flush || of_b.flush;
        Some(Self { a, b, side, edge, separation, support, facing, flush, rounding })
    }

    /// The pairs of parts that can touch, the nearest among them, and the least distance of the
    /// cores at them, m.
    pub(crate) fn selection(&self) -> (Selection, f64) {
        let ends = self.ends();
        let nearest = self.least_gap(&ends);
        let support =
            (Selection::one(self.side.pair(self.edge.index, self.support)), self.separation);
        if self.overlapping() {
            // Overlapping cores have at least one contact that says so, up to rounding: of two faces
            // that just touch, the ends' heights may come out positive.
            return if nearest <= self.rounding { (ends, nearest) } else { support };
        }
        if nearest <= self.separation + self.rounding {
            return (ends, nearest); // no two points can be nearer than the separation
        }
        let ([v, w], distance) = self.nearest_vertices();
        if distance <= self.rounding {
            support // a direction between coincident vertices is noise
        } else if distance < nearest {
            let led = ends.led_by([Part::Vertex(part_number(v)), Part::Vertex(part_number(w))]);
            (led, self.least_gap(&led))
        } else {
            (ends, nearest)
        }
    }

    /// Whether one polygon touches no more than the prolongation of the other's edge, if the pairs of
    /// parts are no nearer than `nearest`, m.
    pub(crate) fn at_seam(&self, nearest: f64) -> bool {
        let flush = FLUSH * (self.a.piece.size + self.b.piece.size);
        if nearest > flush {
            return self.flush;
        }
        self.parallel_overlap().is_some_and(|overlap| overlap <= flush)
    }

    /// Both ends of the part where the edge and the edge facing it lie over each other.
    fn ends(&self) -> Selection {
        let edge = &self.edge;
        let of_facing = |vertex: usize| Some(self.side.pair(edge.index, vertex));
        let Some(facing) = &self.facing else {
            let over = edge.is_under(&self.other().vertices[0], self.rounding);
            return Selection { pairs: [if over { of_facing(0) } else { None }, None] };
        };
        // Where both have a vertex at an end, the facing edge's is enough: hence −rounding.
        let of_edge = |end: usize| {
            let over = facing.is_under(&edge.end_points[end], -self.rounding);
            over.then(|| self.side.other().pair(facing.index, edge.ends[end]))
        };
        let [start, end] = facing.ends;
        // Edges that face each other run in opposite directions, so start goes with start.
        let pairs = match facing.end_points.map(|x| edge.is_under(&x, self.rounding)) {
            [true, true] => [of_facing(start), of_facing(end)],
            [true, false] => [of_facing(start), of_edge(0)],
            [false, true] => [of_facing(end), of_edge(1)],
            [false, false] if covers(facing, edge) => [of_edge(0), of_edge(1)],
            [false, false] => [None, None],
        };
        Selection { pairs }
    }

    /// Whether the cores overlap.
    ///
    /// For two cores without area a separation of zero decides nothing: they may be in line.
    fn overlapping(&self) -> bool {
        let thin = self.a.vertices.len() < 3 && self.b.vertices.len() < 3;
        self.separation <= if thin { -self.rounding } else { 0.0 }
    }

    /// Length over which the edge and a parallel one facing it lie over each other, m.
    fn parallel_overlap(&self) -> Option<f64> {
        let (edge, facing) = (&self.edge, self.facing.as_ref()?);
        if edge.normal.perp(&facing.normal).abs() > PARALLEL {
            return None;
        }
        let [low, high] = edge.shadow_of(facing);
        Some(high.min(edge.length) - low.max(0.0))
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
        let over = |core: &View<'_>, e: u16, x: &Vector2<f64>| {
            core.normals[usize::from(e)].dot(&(x - at(core, e)))
        };
        let gap = |pair: Pair| match pair {
            [Part::Vertex(v), Part::Vertex(w)] => (at(b, w) - at(a, v)).norm(),
            [Part::Edge(e), Part::Vertex(w)] => over(a, e, &at(b, w)),
            [Part::Vertex(v), Part::Edge(e)] => over(b, e, &at(a, v)),
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
struct Survey {
    /// The edge with the greatest separation; ties favour the lower number.
    widest: Option<Face>,
    /// Whether the other core is flush with the line of some edge.
    flush: bool,
}

impl Survey {
    /// None as soon as an edge parts the cores by more than `reach` beyond doubt. Edges below `least`
    /// are of no interest, m.
    fn new([core, other]: [&View<'_>; 2], rounding: f64, reach: f64, least: f64) -> Option<Self> {
        let (mut widest, mut flush) = (None, false);
        let mut greatest = f64::NEG_INFINITY;
        let tolerance = FLUSH * (core.piece.size + other.piece.size);
        let (least, apart) = (least - DOUBT * rounding, reach + DOUBT * rounding);
        for (edge, (n, p)) in core.normals.iter().zip(core.vertices).enumerate() {
            // An edge this low is neither the widest nor flush.
            let low = least.max(greatest).min(-tolerance);
            let (support, separation) = lowest(n, p, other.vertices, low);
            flush |= separation.abs() <= tolerance;
            if separation > apart {
                return None;
            }
            if separation > greatest + rounding {
                greatest = separation;
                widest = Some(Face { edge, separation, support });
            }
        }
        Some(Self { widest, flush })
    }
}

/// The lowest vertex over the line with normal `n` through `p`, and its height, m; the first one
/// below `enough` will do.
fn lowest(
    n: &Vector2<f64>,
    p: &Vector2<f64>,
    vertices: &[Vector2<f64>],
    enough: f64,
) -> (usize, f64) {
    let mut lowest = (0, f64::INFINITY);
    for (k, v) in vertices.iter().enumerate() {
        let height = n.dot(&(v - p));
        if height < lowest.1 {
            lowest = (k, height);
            if height < enough {
                break;
            }
        }
    }
    lowest
}

/// Whether an edge reaches beyond both ends of the one that it faces.
fn covers(facing: &Edge, edge: &Edge) -> bool {
    let [low, high] = edge.shadow_of(facing);
    low < 0.0 && high > edge.length
}
