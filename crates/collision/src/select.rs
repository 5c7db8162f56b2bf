//! Which parts of two shapes can touch: discrete, never differentiated.
//!
//! Parry's manifolds are not used here. Its half-plane manifolds give both points one identity, its
//! points carry positions instead of features, and where a box stands off the end of another it
//! reports side faces that a sliding box would catch on. What is needed is short:
//!
//! 1. The *reference* edge is the one with the greatest separation among both cores' edges (separating
//!    axes). The *incident* edge is the other core's edge that faces it.
//! 2. Where the two edges overlap sideways, either end of the overlap is a vertex of one against
//!    the line of the other: up to two contacts. Which shape was the reference does not show in
//!    them, so identities survive when the reference changes sides.
//! 3. Where the cores are apart and two vertices are nearest, that pair leads.
//!
//! A sharp polygon that is flush with an edge beyond that edge's end is left alone: otherwise a box
//! sliding from one floor plate to the next would catch on the second plate's side.

use nalgebra::Vector2;

use crate::{Part, pose::perp, world::View};

/// Lengths below this times the shapes' size are rounding.
const ROUNDING: f64 = 1e-11;

/// A polygon this near to the line of an edge is flush with it, relative to the shapes' size.
///
/// Wide enough for the penetration that a solver leaves.
const FLUSH: f64 = 1e-6;

/// Sine of the greatest angle at which two edges at a seam count as parallel.
const PARALLEL: f64 = 1e-3;

/// The parts of a and of b that touch.
pub(crate) type Pair = [Part; 2];

/// At most two pairs of parts, in no particular order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Selection {
    pairs: [Option<Pair>; 2],
}

impl Selection {
    /// The selected pairs.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Pair> {
        self.pairs.into_iter().flatten()
    }

    fn one(pair: Pair) -> Self {
        Self { pairs: [Some(pair), None] }
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

/// The pairs of parts of `a` and `b` that can touch; none beyond `reach`, m.
///
/// The nearest parts are among them, unless they are at a seam to be skipped.
pub(crate) fn select(a: &View<'_>, b: &View<'_>, reach: f64, seams: Seams) -> Selection {
    match (a.unbounded, b.unbounded) {
        (true, true) => Selection::default(),
        (true, false) => lowest(a, b, Side::A),
        (false, true) => lowest(b, a, Side::B),
        (false, false) => between_cores(a, b, reach, seams),
    }
}

/// Which body has the edge.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    A,
    B,
}

impl Side {
    /// The pair of an edge of this side and a vertex of the other.
    fn pair(self, edge: usize, vertex: usize) -> Pair {
        let (edge, vertex) = (Part::Edge(number(edge)), Part::Vertex(number(vertex)));
        match self {
            Self::A => [edge, vertex],
            Self::B => [vertex, edge],
        }
    }

    fn other(self) -> Self {
        match self {
            Self::A => Self::B,
            Self::B => Self::A,
        }
    }
}

/// Half-plane: the lowest vertex and the lower one of its neighbours.
fn lowest(plane: &View<'_>, core: &View<'_>, side: Side) -> Selection {
    let (count, size) = (core.vertices.len(), core.size);
    let height = |k: usize| plane.normals[0].dot(&(core.vertices[k] - plane.vertices[0]));
    let lowest = first_least(count, height);
    let (next, last) = ((lowest + 1) % count, (lowest + count - 1) % count);
    let neighbour = if height(last) < height(next) - ROUNDING * size { last } else { next };
    let second = (neighbour != lowest).then(|| side.pair(0, neighbour));
    Selection { pairs: [Some(side.pair(0, lowest)), second] }
}

/// Two bounded shapes.
fn between_cores(a: &View<'_>, b: &View<'_>, reach: f64, seams: Seams) -> Selection {
    let rounding = ROUNDING * (a.size + b.size);
    let Some(reference) = reference(a, b, rounding) else {
        return Selection::one([Part::Vertex(0); 2]); // two circles
    };
    let thickness = a.radius + b.radius;
    if reference.face.separation > reach + thickness {
        return Selection::default();
    }
    let pairing = Pairing { a, b, reference, rounding };
    let seen = pairing.selection();
    let catches = thickness == 0.0 && seams == Seams::Skip; // round sides roll over seams
    if catches && pairing.at_seam(&seen) { Selection::default() } else { seen }
}

/// One edge of a core against the whole of another core.
#[derive(Clone, Copy)]
struct Face {
    edge: usize,
    /// Least distance of the other core's vertices from the edge's line, m.
    separation: f64,
    /// The vertex at that distance.
    support: usize,
}

#[derive(Clone, Copy)]
struct Reference {
    side: Side,
    face: Face,
}

/// The edge with the greatest separation; ties favour body a. None for two circles.
fn reference(a: &View<'_>, b: &View<'_>, rounding: f64) -> Option<Reference> {
    let on = |side| move |face| Reference { side, face };
    let of_a = widest(a, b, rounding).map(on(Side::A));
    let of_b = widest(b, a, rounding).map(on(Side::B));
    match (of_a, of_b) {
        (Some(a), Some(b)) if b.face.separation > a.face.separation + rounding => Some(b),
        (None, b) => b,
        (a, _) => a,
    }
}

/// The edge of `core` from which `other` is furthest; ties favour the lower number.
fn widest(core: &View<'_>, other: &View<'_>, rounding: f64) -> Option<Face> {
    faces(core, other)
        .reduce(|best, face| if face.separation > best.separation + rounding { face } else { best })
}

fn faces<'a>(core: &'a View<'_>, other: &'a View<'_>) -> impl Iterator<Item = Face> + 'a {
    (0..core.normals.len()).map(|edge| {
        let (n, p) = (core.normals[edge], core.vertices[edge]);
        let distance = |k: usize| n.dot(&(other.vertices[k] - p));
        let support = first_least(other.vertices.len(), distance);
        Face { edge, separation: distance(support), support }
    })
}

/// Two cores and the edge between them.
struct Pairing<'a> {
    a: &'a View<'a>,
    b: &'a View<'a>,
    reference: Reference,
    rounding: f64,
}

impl Pairing<'_> {
    fn selection(&self) -> Selection {
        let Reference { side, face } = self.reference;
        let ends = self.ends();
        let nearest = self.least_gap(&ends);
        let support = Selection::one(side.pair(face.edge, face.support));
        if self.overlapping() {
            // Overlapping cores have at least one contact that says so.
            return if nearest <= 0.0 { ends } else { support };
        }
        if nearest <= face.separation + self.rounding {
            return ends; // no pair of points can be nearer than the separation
        }
        let (vertices, distance) = self.nearest_vertices();
        if distance <= self.rounding {
            support // a direction between coincident vertices is noise
        } else if distance < nearest {
            led_by(vertices, &ends)
        } else {
            ends
        }
    }

    /// Both ends of the part where reference and incident edge lie over each other.
    fn ends(&self) -> Selection {
        let Reference { side, face } = self.reference;
        let (core, other) = self.sides();
        let Some(incident) = facing(other, face.support, &core.normals[face.edge]) else {
            let over = self.over(core, face.edge, &other.vertices[0]);
            return Selection { pairs: [over.then(|| side.pair(face.edge, 0)), None] };
        };
        let ends = edge_ends(other, incident);
        let over = ends.map(|k| self.over(core, face.edge, &other.vertices[k]));
        let of_incident = |k: usize| Some(side.pair(face.edge, ends[k]));
        let of_reference = |end: usize| {
            let vertex = edge_ends(core, face.edge)[end];
            let under = self.strictly_over(other, incident, &core.vertices[vertex]);
            under.then(|| side.other().pair(incident, vertex))
        };
        // Edges that face each other run in opposite directions.
        let pairs = match over {
            [true, true] => [of_incident(0), of_incident(1)],
            [true, false] => [of_incident(0), of_reference(0)],
            [false, true] => [of_incident(1), of_reference(1)],
            [false, false] if self.covers(core, other, face.edge, incident) => {
                [of_reference(0), of_reference(1)]
            }
            [false, false] => [None, None],
        };
        Selection { pairs }
    }

    /// Whether the cores overlap.
    ///
    /// For two cores without area a separation of zero decides nothing: they may be in line.
    fn overlapping(&self) -> bool {
        let flat = self.a.vertices.len() < 3 && self.b.vertices.len() < 3;
        self.reference.face.separation <= if flat { -self.rounding } else { 0.0 }
    }

    /// Whether one polygon touches only the prolongation of the other's edge.
    fn at_seam(&self, seen: &Selection) -> bool {
        let flush = FLUSH * (self.a.size + self.b.size);
        if self.least_gap(seen) > flush {
            let mut faces = faces(self.a, self.b).chain(faces(self.b, self.a));
            return faces.any(|face| face.separation.abs() <= flush);
        }
        self.sideways_overlap().is_some_and(|overlap| overlap <= flush)
    }

    /// Length over which parallel reference and incident edges lie over each other, m.
    fn sideways_overlap(&self) -> Option<f64> {
        let face = self.reference.face;
        let (core, other) = self.sides();
        let n = core.normals[face.edge];
        let incident = facing(other, face.support, &n)?;
        if n.perp(&other.normals[incident]).abs() > PARALLEL {
            return None;
        }
        let (low, high) = self.shadow(core, other, face.edge, incident);
        Some(high.min(length(core, face.edge)) - low.max(0.0))
    }

    /// Reference and other core.
    fn sides(&self) -> (&View<'_>, &View<'_>) {
        match self.reference.side {
            Side::A => (self.a, self.b),
            Side::B => (self.b, self.a),
        }
    }

    fn over(&self, core: &View<'_>, edge: usize, x: &Vector2<f64>) -> bool {
        let u = along(core, edge, x);
        (-self.rounding..=length(core, edge) + self.rounding).contains(&u)
    }

    /// As `over`, without the ends: there the two vertices coincide, and one contact is enough.
    fn strictly_over(&self, core: &View<'_>, edge: usize, x: &Vector2<f64>) -> bool {
        let u = along(core, edge, x);
        self.rounding < u && u < length(core, edge) - self.rounding
    }

    /// Whether the incident edge reaches beyond both ends of the reference edge.
    fn covers(&self, core: &View<'_>, other: &View<'_>, edge: usize, incident: usize) -> bool {
        let (low, high) = self.shadow(core, other, edge, incident);
        low < 0.0 && high > length(core, edge)
    }

    /// The incident edge's range along the reference edge, m.
    fn shadow(
        &self,
        core: &View<'_>,
        other: &View<'_>,
        edge: usize,
        incident: usize,
    ) -> (f64, f64) {
        let ends = edge_ends(other, incident).map(|k| along(core, edge, &other.vertices[k]));
        (ends[0].min(ends[1]), ends[0].max(ends[1]))
    }

    /// Least distance of the cores among the pairs, m; infinite for none.
    fn least_gap(&self, pairs: &Selection) -> f64 {
        let gap = |[p, q]: Pair| match (p, q) {
            (Part::Edge(e), Part::Vertex(v)) => height(self.a, e, &self.b.vertices[usize::from(v)]),
            (Part::Vertex(v), Part::Edge(e)) => height(self.b, e, &self.a.vertices[usize::from(v)]),
            (Part::Vertex(v), Part::Vertex(w)) => {
                (self.b.vertices[usize::from(w)] - self.a.vertices[usize::from(v)]).norm()
            }
            (Part::Edge(_), Part::Edge(_)) => f64::INFINITY, // never selected
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

/// The vertex pair, and an end that shares no vertex with it: the far end of a nearly parallel edge.
fn led_by([v, w]: [usize; 2], ends: &Selection) -> Selection {
    let pair = [Part::Vertex(number(v)), Part::Vertex(number(w))];
    let far = ends.iter().find(|[p, q]| *p != pair[0] && *q != pair[1]);
    Selection { pairs: [Some(pair), far] }
}

/// The edge at vertex `k` whose normal is most opposite to `n`; none for a circle.
fn facing(core: &View<'_>, k: usize, n: &Vector2<f64>) -> Option<usize> {
    let count = core.normals.len();
    if count == 0 {
        return None;
    }
    let adjacent = [k, (k + count - 1) % count];
    let (low, high) = (adjacent[0].min(adjacent[1]), adjacent[0].max(adjacent[1]));
    let opposite = |edge: usize| core.normals[edge].dot(n);
    Some(if opposite(high) < opposite(low) - ROUNDING { high } else { low })
}

/// The vertices at which an edge starts and ends.
fn edge_ends(core: &View<'_>, edge: usize) -> [usize; 2] {
    [edge, (edge + 1) % core.vertices.len()]
}

/// Distance of a point along an edge from its start, m.
fn along(core: &View<'_>, edge: usize, x: &Vector2<f64>) -> f64 {
    perp(&core.normals[edge]).dot(&(x - core.vertices[edge]))
}

/// Distance of a point from an edge's line, m.
fn height(core: &View<'_>, edge: u16, x: &Vector2<f64>) -> f64 {
    let edge = usize::from(edge);
    core.normals[edge].dot(&(x - core.vertices[edge]))
}

fn length(core: &View<'_>, edge: usize) -> f64 {
    let [v, w] = edge_ends(core, edge);
    (core.vertices[w] - core.vertices[v]).norm()
}

/// The first k < count with the least value.
fn first_least(count: usize, value: impl Fn(usize) -> f64) -> usize {
    let lower = |(i, least): (usize, f64), k| {
        let v = value(k);
        if v < least { (k, v) } else { (i, least) }
    };
    (1..count).fold((0, value(0)), lower).0
}

/// Shapes have at most 65535 parts; `Shape::validate` and `Collider::new` see to it.
fn number(index: usize) -> u16 {
    u16::try_from(index).expect("a valid shape has at most 65535 parts")
}
