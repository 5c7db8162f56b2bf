//! All outlines placed in the world; what did not move since the last query stays.

use std::ops::Range;

use nalgebra::Vector2;

use crate::{Collider, bounds::Bounds, outline::Outline, pose::Frame, pose::Pose};

/// Every outline of every body in the world frame, in flat arrays.
#[derive(Debug, Default)]
pub(crate) struct World {
    colliders: Vec<Collider>,
    poses: Vec<Pose>,
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
    /// Bodies that are not where they were before the last placement, ascending.
    moving: Vec<u32>,
    /// Whether the last placement was of other colliders than the one before.
    is_new: bool,
}

/// What of the arrays is a body's.
#[derive(Debug)]
struct Placement {
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
        let same = self.colliders.len() == colliders.len()
            && self.colliders.iter().zip(colliders).all(|(one, other)| one.is(other));
        self.is_new = !same;
        self.moving.clear();
        if !same {
            self.lay_out(colliders);
            self.poses.clear();
            self.poses.extend(frames.iter().map(Frame::pose));
        }
        for (i, (pose, frame)) in (0..).zip(self.poses.iter_mut().zip(frames)) {
            if !same || !frame.is_at(pose) {
                *pose = *frame.pose();
                self.moving.push(i);
            }
        }
        for k in 0..self.moving.len() {
            let body = self.moving[k] as usize;
            self.place_body(body, &frames[body]);
        }
    }

    /// Number of bodies.
    pub(crate) fn len(&self) -> usize {
        self.bodies.len()
    }

    /// The bodies that are not where they were before the last placement, ascending.
    pub(crate) fn moving(&self) -> &[u32] {
        &self.moving
    }

    /// Whether the last placement was of other colliders than the one before.
    pub(crate) fn is_new(&self) -> bool {
        self.is_new
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
    fn lay_out(&mut self, colliders: &[Collider]) {
        self.colliders.clear();
        self.colliders.extend_from_slice(colliders);
        self.bodies.clear();
        self.pieces.clear();
        self.local_vertices.clear();
        self.local_normals.clear();
        for collider in colliders {
            let first = (self.pieces.len(), self.local_vertices.len(), self.local_normals.len());
            collider.outlines().iter().for_each(|outline| self.add(outline));
            self.bodies.push(Placement {
                pieces: first.0..self.pieces.len(),
                vertices: first.1..self.local_vertices.len(),
                normals: first.2..self.local_normals.len(),
            });
        }
        self.vertices.clone_from(&self.local_vertices);
        self.normals.clone_from(&self.local_normals);
        self.bounds.clear();
        self.bounds.resize(colliders.len(), Bounds::EMPTY);
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
    fn place_body(&mut self, body: usize, frame: &Frame) {
        let Placement { pieces, vertices, normals } = &self.bodies[body];
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
