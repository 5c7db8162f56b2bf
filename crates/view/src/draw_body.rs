//! Bodies as polygons of pixels.

use std::f64::consts::{PI, TAU};

use tangency_collision::Pose;
use tangency_collision::pose::Frame;

use crate::canvas::Canvas;
use crate::clip::{Point, below};
use crate::look::{BodyLook, Form};
use crate::palette::{Rgb, shade};
use crate::view::above_ground;

/// Widths of lines, in units.
const EDGE: f64 = 1.1;
const MARK: f64 = 2.0;
/// Where the mark begins, as a part of its length: the centre has the body's colour.
const MARK_FROM: f64 = 0.35;
/// How far a chord may be off its arc, pixels.
const SAGITTA: f64 = 0.03;
/// The most chords of a circle; they are enough up to a radius of 10⁶ pixels.
const MOST_CHORDS: f64 = 16_000.0;

/// One body: its forms, and a mark along its x that shows the angle.
pub(crate) fn draw_body(canvas: &mut Canvas, look: &BodyLook, pose: &Pose, color: Rgb) {
    let frame = Frame::new(pose);
    for form in &look.forms {
        for (inset, ink) in [(0.0, shade(color)), (EDGE * canvas.unit(), color)] {
            let points = outline(canvas, form, &frame, inset);
            canvas.fill(&points, ink);
        }
    }
    if look.moves() && look.mark > 0.0 {
        let along = [MARK_FROM, 1.0].map(|part| [part * look.mark, 0.0]);
        canvas.line(along.map(|p| place(canvas, &frame, p)), shade(color), MARK);
    }
}

/// The pixel of a point in the body's frame.
fn place(canvas: &Canvas, frame: &Frame, local: [f64; 2]) -> Point {
    canvas.pixel(frame.point(&local.into()).into())
}

/// A form less a border of `inset` pixels; nothing where it is thinner than that.
fn outline(canvas: &Canvas, form: &Form, frame: &Frame, inset: f64) -> Vec<Point> {
    let narrowed = |radius: &f64| canvas.length(*radius) - inset;
    match form {
        Form::Polygon { points } => {
            let points: Vec<Point> = points.iter().map(|p| place(canvas, frame, *p)).collect();
            shrunk(points, inset)
        }
        Form::Circle { radius, .. } | Form::Capsule { radius, .. } if narrowed(radius) <= 0.0 => {
            Vec::new()
        }
        Form::Circle { center, radius } => {
            arc(place(canvas, frame, *center), narrowed(radius), 0.0, TAU)
        }
        Form::Capsule { a, b, radius } => {
            capsule([*a, *b].map(|p| place(canvas, frame, p)), narrowed(radius))
        }
        Form::HalfPlane { normal, offset } => {
            half_plane(canvas, *normal, *offset, frame.pose(), inset)
        }
    }
}

/// What of a polygon is at least `inset` inside all its edges. Polygons are counter-clockwise in the world
/// and clockwise as seen with y down: (b − a) × (x − a) < 0 inside.
fn shrunk(points: Vec<Point>, inset: f64) -> Vec<Point> {
    if inset == 0.0 {
        return points;
    }
    let mut kept = points.clone();
    for (i, a) in points.iter().enumerate() {
        let b = points[(i + 1) % points.len()];
        let d = [b[0] - a[0], b[1] - a[1]];
        let length = d[0].hypot(d[1]);
        if length > 0.0 {
            let cross = |[x, y]: Point| d[0] * (y - a[1]) - d[1] * (x - a[0]);
            kept = below(&kept, |x| cross(x) / length + inset);
        }
    }
    kept
}

/// Points on an arc of a circle, its chords no farther than [`SAGITTA`] from it: of an arc of angle φ the
/// middle is r (1 − cos φ/2) ≈ r φ²/8 beyond its chord.
fn arc([x, y]: Point, r: f64, from: f64, angle: f64) -> Vec<Point> {
    let chords = (angle / (8.0 * SAGITTA / r.max(SAGITTA)).sqrt()).ceil().clamp(8.0, MOST_CHORDS);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "8 to 16 000")]
    let count = chords as u32;
    let turn = |k: u32| from + angle * f64::from(k) / chords;
    (0..=count).map(|k| turn(k).sin_cos()).map(|(s, c)| [x + r * c, y + r * s]).collect()
}

/// Half circles about both ends, each facing away from the other.
fn capsule([a, b]: [Point; 2], r: f64) -> Vec<Point> {
    let turn = (b[1] - a[1]).atan2(b[0] - a[0]);
    let mut points = arc(b, r, turn - 0.5 * PI, PI);
    points.extend(arc(a, r, turn + 0.5 * PI, PI));
    points
}

/// The part of the picture more than `inset` below the edge: where d + n·(x − m) ≤ −inset, d the height of
/// the middle m.
fn half_plane(
    canvas: &Canvas,
    normal: [f64; 2],
    offset: f64,
    pose: &Pose,
    inset: f64,
) -> Vec<Point> {
    let (height, n) = above_ground(normal, offset, pose, canvas.center());
    let (d, m) = (canvas.length(height) + inset, canvas.middle());
    below(&canvas.frame(), |[x, y]| d + n[0] * (x - m[0]) - n[1] * (y - m[1]))
}
