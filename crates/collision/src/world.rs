//! All outlines placed in the world, once per query.

use std::ops::Range;

use nalgebra::Vector2;

use crate::{Placed, outline::Outline, pose::Frame};

/// Every outline of every body in the world frame, in flat arrays.
pub(crate) struct World {
    vertices: Vec<Vector2<f64>>,
    normals: Vec<Vector2<f64>>,
    pieces: Vec<Piece>,
    /// Which pieces are whose, per body.
    bodies: Vec<Range<usize>>,
    frames: Vec<Frame>,
}

/// One placed outline.
struct Piece {
    vertices: Range<usize>,
    normals: Range<usize>,
    bounds: Bounds,
    radius: f64,
    size: f64,
    unbounded: bool,
}

/// A placed outline, as selection reads it.
#[derive(Clone, Copy)]
pub(crate) struct View<'a> {
    /// Vertices of the core, world, m.
    pub(crate) vertices: &'a [Vector2<f64>],
    /// Unit outward normals of the edges, world.
    pub(crate) normals: &'a [Vector2<f64>],
    /// Box around the shape.
    pub(crate) bounds: Bounds,
    /// Radius around the core, m.
    pub(crate) radius: f64,
    /// Order of magnitude of the shape, m.
    pub(crate) size: f64,
    /// Whether it is a half-plane.
    pub(crate) unbounded: bool,
}

/// An axis-parallel box, world, m; infinite around a half-plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    /// Lower left corner.
    pub(crate) min: Vector2<f64>,
    /// Upper right corner.
    pub(crate) max: Vector2<f64>,
}

impl World {
    /// Places all bodies; their poses are finite.
    pub(crate) fn new(bodies: &[Placed<'_>]) -> Self {
        let mut world = Self {
            vertices: Vec::new(),
            normals: Vec::new(),
            pieces: Vec::new(),
            bodies: Vec::with_capacity(bodies.len()),
            frames: Vec::with_capacity(bodies.len()),
        };
        for body in bodies {
            let (first, frame) = (world.pieces.len(), Frame::new(&body.pose));
            body.collider.outlines().iter().for_each(|outline| world.place(outline, &frame));
            world.bodies.push(first..world.pieces.len());
            world.frames.push(frame);
        }
        world
    }

    /// The outlines of one body, in the order of its shapes.
    pub(crate) fn views(&self, body: usize) -> impl Iterator<Item = View<'_>> {
        self.pieces[self.bodies[body].clone()].iter().map(|piece| View {
            vertices: &self.vertices[piece.vertices.clone()],
            normals: &self.normals[piece.normals.clone()],
            bounds: piece.bounds,
            radius: piece.radius,
            size: piece.size,
            unbounded: piece.unbounded,
        })
    }

    /// The frame of one body.
    pub(crate) fn frame(&self, body: usize) -> &Frame {
        &self.frames[body]
    }

    /// A box around each body.
    pub(crate) fn bounds(&self) -> Vec<Bounds> {
        let of = |pieces: &Range<usize>| {
            let boxes = self.pieces[pieces.clone()].iter().map(|piece| piece.bounds);
            boxes.fold(Bounds::EMPTY, Bounds::joined)
        };
        self.bodies.iter().map(of).collect()
    }

    fn place(&mut self, outline: &Outline, frame: &Frame) {
        let (v, n) = (self.vertices.len(), self.normals.len());
        self.vertices.extend(outline.vertices.iter().map(|l| frame.point(l)));
        self.normals.extend(outline.normals.iter().map(|n| frame.direction(n)));
        let bounds = if outline.unbounded {
            Bounds::EVERYTHING
        } else {
            Bounds::around(&self.vertices[v..]).grown(outline.radius)
        };
        self.pieces.push(Piece {
            vertices: v..self.vertices.len(),
            normals: n..self.normals.len(),
            bounds,
            radius: outline.radius,
            size: outline.size,
            unbounded: outline.unbounded,
        });
    }
}

impl Bounds {
    const EMPTY: Self = Self::all(f64::INFINITY, f64::NEG_INFINITY);
    /// Around a half-plane.
    pub(crate) const EVERYTHING: Self = Self::all(f64::NEG_INFINITY, f64::INFINITY);

    /// Whether the boxes are within `reach` of each other along both axes.
    pub(crate) fn near(&self, other: &Self, reach: f64) -> bool {
        (0..2).all(|k| self.min[k] - other.max[k] <= reach && other.min[k] - self.max[k] <= reach)
    }

    /// Whether it ends everywhere: not a half-plane's.
    pub(crate) fn is_finite(&self) -> bool {
        self.min.iter().chain(&self.max).all(|x| x.is_finite())
    }

    fn around(points: &[Vector2<f64>]) -> Self {
        points.iter().fold(Self::EMPTY, |b, p| Self { min: b.min.inf(p), max: b.max.sup(p) })
    }

    fn joined(self, other: Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    fn grown(self, by: f64) -> Self {
        Self { min: self.min.add_scalar(-by), max: self.max.add_scalar(by) }
    }

    const fn all(min: f64, max: f64) -> Self {
        Self { min: Vector2::new(min, min), max: Vector2::new(max, max) }
    }
}
