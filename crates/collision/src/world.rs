//! All outlines placed in the world; what did not move since the last query stays.

use std::ops::Range;

use nalgebra::Vector2;

use crate::{Collider, bounds::Bounds, outline::Outline, pose::Frame};

/// Every outline of every body in the world frame, in flat arrays.
#[derive(Debug, Default)]
pub(crate) struct World {
    bodies: Vec<Placement>,
    pieces: Vec<Piece>,
    /// World, as [`View`] hands them out.
    vertices: Vec<Vector2<f64>>,
    normals: Vec<Vector2<f64>>,
    /// The same in the bodies' frames.
    local_vertices: Vec<Vector2<f64>>,
    local_normals: Vec<Vector2<f64>>,
    /// Around each body.
    bounds: Vec<Bounds>,
    moved: Vec<bool>,
}

/// A body's collider, where it is, and what of the arrays is its.
#[derive(Debug)]
struct Placement {
    collider: Collider,
    frame: Frame,
    pieces: Range<usize>,
    vertices: Range<usize>,
    normals: Range<usize>,
}

/// One placed outline.
#[derive(Debug)]
pub(crate) struct Piece {
    vertices: Range<usize>,
    normals: Range<usize>,
    /// Box around the shape.
    pub(crate) bounds: Bounds,
    /// Radius around the core, m.
    pub(crate) radius: f64,
    /// Order of magnitude of the shape, m.
    pub(crate) size: f64,
    /// Whether it is a half-plane.
    pub(crate) unbounded: bool,
}

/// A placed outline with its points, as selection and evaluation read it.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    /// Vertices of the core, world, m.
    pub(crate) vertices: &'a [Vector2<f64>],
    /// Unit outward normals of the edges, world.
    pub(crate) normals: &'a [Vector2<f64>],
    /// All else.
    pub(crate) piece: &'a Piece,
}

/// Part of its length by which a lower bound of a height is lowered, against rounding.
const ROUNDING: f64 = 1e-12;

impl World {
    /// Places all bodies; their frames are finite.
    pub(crate) fn place(&mut self, colliders: &[Collider], frames: &[Frame]) {
        let same = self.bodies.len() == colliders.len()
            && self.bodies.iter().zip(colliders).all(|(body, other)| body.collider.is(other));
        if !same {
            self.lay_out(colliders, frames);
        }
        for (i, frame) in frames.iter().enumerate() {
            let moves = !same || !self.bodies[i].frame.is_at(frame.pose());
            self.moved[i] = moves;
            if moves {
                self.bodies[i].frame = *frame;
                self.place_body(i);
            }
        }
    }

    /// Number of bodies.
    pub(crate) fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Which bodies are not where they were before the last placement.
    pub(crate) fn moved(&self) -> &[bool] {
        &self.moved
    }

    /// A box around each body.
    pub(crate) fn bounds(&self) -> &[Bounds] {
        &self.bounds
    }

    /// Whether a body has no shapes.
    pub(crate) fn is_empty(&self, body: usize) -> bool {
        self.bodies[body].pieces.is_empty()
    }

    /// Whether a body has shapes that do not end.
    pub(crate) fn is_unbounded(&self, body: usize) -> bool {
        !self.bounds[body].is_finite() && !self.is_empty(body)
    }

    /// The outlines of one body, in the order of its shapes.
    pub(crate) fn views(&self, body: usize) -> impl Iterator<Item = View<'_>> {
        self.bodies[body].pieces.clone().map(|piece| self.view(piece))
    }

    /// A lower bound of the distance of two bodies, m.
    pub(crate) fn apart(&self, i: usize, j: usize) -> f64 {
        match (self.plane(i), self.plane(j)) {
            (Some(plane), None) => self.height(plane, j),
            (None, Some(plane)) => self.height(plane, i),
            _ => self.bounds[i].apart(&self.bounds[j]),
        }
    }

    /// The piece of a body that is nothing but a half-plane.
    fn plane(&self, body: usize) -> Option<usize> {
        let pieces = &self.bodies[body].pieces;
        (pieces.len() == 1 && self.pieces[pieces.start].unbounded).then_some(pieces.start)
    }

    /// Height of a body's box over a half-plane, rounded down, m.
    fn height(&self, plane: usize, body: usize) -> f64 {
        let (plane, Bounds { min, max }) = (self.view(plane), self.bounds[body]);
        let n = plane.normals[0];
        let lowest = Vector2::new(
            if n.x > 0.0 { min.x } else { max.x },
            if n.y > 0.0 { min.y } else { max.y },
        );
        let r = lowest - plane.vertices[0];
        let height = n.dot(&r) - ROUNDING * (r.x.abs() + r.y.abs());
        if height.is_nan() { f64::NEG_INFINITY } else { height }
    }

    /// A vertex of a placed outline in its body's frame, m.
    pub(crate) fn local_vertex(&self, view: &View<'_>, k: u16) -> Vector2<f64> {
        self.local_vertices[view.piece.vertices.start + usize::from(k)]
    }

    /// A normal of a placed outline in its body's frame.
    pub(crate) fn local_normal(&self, view: &View<'_>, k: u16) -> Vector2<f64> {
        self.local_normals[view.piece.normals.start + usize::from(k)]
    }

    fn view(&self, piece: usize) -> View<'_> {
        let piece = &self.pieces[piece];
        View {
            vertices: &self.vertices[piece.vertices.clone()],
            normals: &self.normals[piece.normals.clone()],
            piece,
        }
    }

    /// Makes the arrays anew for other colliders.
    fn lay_out(&mut self, colliders: &[Collider], frames: &[Frame]) {
        self.bodies.clear();
        self.pieces.clear();
        self.local_vertices.clear();
        self.local_normals.clear();
        for (collider, frame) in colliders.iter().zip(frames) {
            let first = (self.pieces.len(), self.local_vertices.len(), self.local_normals.len());
            collider.outlines().iter().for_each(|outline| self.add(outline));
            self.bodies.push(Placement {
                collider: collider.clone(),
                frame: *frame,
                pieces: first.0..self.pieces.len(),
                vertices: first.1..self.local_vertices.len(),
                normals: first.2..self.local_normals.len(),
            });
        }
        self.vertices.clone_from(&self.local_vertices);
        self.normals.clone_from(&self.local_normals);
        self.bounds.clear();
        self.bounds.resize(colliders.len(), Bounds::EMPTY);
        self.moved.clear();
        self.moved.resize(colliders.len(), true);
    }

    fn add(&mut self, outline: &Outline) {
        let (v, n) = (self.local_vertices.len(), self.local_normals.len());
        self.local_vertices.extend_from_slice(&outline.vertices);
        self.local_normals.extend_from_slice(&outline.normals);
        self.pieces.push(Piece {
            vertices: v..self.local_vertices.len(),
            normals: n..self.local_normals.len(),
            bounds: Bounds::EVERYTHING,
            radius: outline.radius,
            size: outline.size,
            unbounded: outline.unbounded,
        });
    }

    /// Vertices, normals and boxes of one body where its frame is.
    fn place_body(&mut self, body: usize) {
        let Placement { frame, pieces, vertices, normals, .. } = &self.bodies[body];
        let local = &self.local_vertices[vertices.clone()];
        self.vertices[vertices.clone()]
            .iter_mut()
            .zip(local)
            .for_each(|(x, l)| *x = frame.point(l));
        let local = &self.local_normals[normals.clone()];
        self.normals[normals.clone()]
            .iter_mut()
            .zip(local)
            .for_each(|(n, l)| *n = frame.direction(l));
        let mut bounds = Bounds::EMPTY;
        for piece in &mut self.pieces[pieces.clone()] {
            if !piece.unbounded {
                let core = Bounds::around(&self.vertices[piece.vertices.clone()]);
                piece.bounds = core.grown(piece.radius);
            }
            bounds = bounds.joined(piece.bounds);
        }
        self.bounds[body] = bounds;
    }
}
