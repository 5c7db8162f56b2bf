//! A film strip: moments of a motion side by side.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};
use tangency::{Scene, Shape, State};

use crate::plot::{Canvas, DrawError, Figure, GREY, INK, PALETTE};

/// Moments of one motion, and of another one drawn as outlines over it.
pub(super) struct Filmstrip<'a> {
    pub(super) title: String,
    pub(super) subtitle: String,
    pub(super) scene: &'a Scene,
    /// The motion, and what the legend calls it.
    pub(super) solid: (&'a str, Vec<&'a State>),
    /// The other motion at the same times.
    pub(super) outline: (&'a str, Vec<&'a State>),
}

const FRAME: (f64, f64) = (186.0, 200.0);
const COLUMNS: usize = 5;
const MARGIN: f64 = 20.0;
const CAPTION: f64 = 26.0;
const HEADER: f64 = 98.0;

impl Figure for Filmstrip<'_> {
    fn size(&self) -> (u32, u32) {
        let rows = u32::try_from(self.solid.1.len().div_ceil(COLUMNS)).unwrap_or(1);
        (5 * 186 + 40, 98 + rows * (200 + 26) + 14)
    }

    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<'_, DB>) -> Result<(), DrawError> {
        let legend = [(self.solid.0, PALETTE[0]), (self.outline.0, PALETTE[1])];
        canvas.header(&self.title, &self.subtitle, &legend)?;
        let window = Window::around(self.scene, self.solid.1.iter().chain(&self.outline.1));
        for (index, (solid, outline)) in self.solid.1.iter().zip(&self.outline.1).enumerate() {
            let (row, column) = (index / COLUMNS, index % COLUMNS);
            let left = MARGIN + column as f64 * FRAME.0;
            let top = HEADER + row as f64 * (FRAME.1 + CAPTION);
            let view = View { window, left, top };
            let corners = [(left, top), (left + FRAME.0, top + FRAME.1)];
            let [a, b] = corners.map(|(x, y)| canvas.at(x, y));
            let frame = Rectangle::new([a, b], canvas.stroke(RGBColor(200, 204, 210), 1.0));
            self.draw_bodies(canvas, &view, solid, PALETTE[0], true)?;
            self.draw_bodies(canvas, &view, outline, PALETTE[1], false)?;
            self.draw_hooks(canvas, &view)?;
            canvas.area.draw(&frame)?;
            let caption = format!("{:.2} s", solid.time);
            let at = (left + FRAME.0 / 2.0, top + FRAME.1 + 5.0);
            canvas.text(
                &caption,
                at,
                15.0,
                (FontStyle::Normal, GREY),
                (HPos::Center, VPos::Top),
            )?;
        }
        Ok(())
    }
}

impl Filmstrip<'_> {
    fn draw_bodies<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, DB>,
        view: &View,
        state: &State,
        color: RGBColor,
        solid: bool,
    ) -> Result<(), DrawError> {
        for (collider, pose) in self.scene.colliders().iter().zip(&state.q) {
            for shape in collider.shapes() {
                if !view.shows(pose.x, pose.y) {
                    continue;
                }
                let (s, c) = pose.z.sin_cos();
                let place = |[u, v]: [f64; 2]| {
                    let (x, y) = view.place([pose.x + c * u - s * v, pose.y + s * u + c * v]);
                    canvas.at(x, y)
                };
                let mut points: Vec<_> = rim(shape).into_iter().map(place).collect();
                if solid {
                    canvas.area.draw(&Polygon::new(points.clone(), color.mix(0.35)))?;
                }
                points.extend(points.first().copied());
                let width = if solid { 1.0 } else { 2.0 };
                canvas.area.draw(&PathElement::new(points, canvas.stroke(color, width)))?;
            }
        }
        Ok(())
    }

    /// The points where the world holds something.
    fn draw_hooks<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<'_, DB>,
        view: &View,
    ) -> Result<(), DrawError> {
        let held = self.scene.joints().iter().filter(|joint| joint.bodies[0].is_none());
        for joint in held {
            let (x, y) = view.place(joint.anchors[0].into());
            let [a, b] = [canvas.at(x - 4.0, y - 4.0), canvas.at(x + 4.0, y + 4.0)];
            canvas.area.draw(&Rectangle::new([a, b], INK.filled()))?;
        }
        Ok(())
    }
}

/// The part of the world that every frame shows.
#[derive(Clone, Copy)]
struct Window {
    center: [f64; 2],
    /// Units of the figure per metre.
    zoom: f64,
}

impl Window {
    /// Holds all bodies that are fixed somewhere; what flies away may leave it.
    fn around<'a>(scene: &Scene, states: impl Iterator<Item = &'a &'a State>) -> Self {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        let grouped = |i: &usize| !scene.bodies()[*i].groups.is_empty();
        let mut add = |state: &State, i: usize| {
            for axis in 0..2 {
                let (q, radius) = (state.q[i][axis], scene.colliders()[i].radius());
                low[axis] = low[axis].min(q - radius);
                high[axis] = high[axis].max(q + radius);
            }
        };
        let first = scene.initial_state();
        (0..scene.bodies().len()).for_each(|i| add(&first, i));
        for state in states {
            (0..scene.bodies().len()).filter(grouped).for_each(|i| add(state, i));
        }
        let zoom = (FRAME.0 / (high[0] - low[0])).min(FRAME.1 / (high[1] - low[1])) * 0.97;
        Self { center: [0, 1].map(|axis| f64::midpoint(low[axis], high[axis])), zoom }
    }
}

struct View {
    window: Window,
    left: f64,
    top: f64,
}

impl View {
    /// Whether a point of the world is in the frame.
    fn shows(&self, x: f64, y: f64) -> bool {
        let Window { center, zoom } = self.window;
        zoom * (x - center[0]).abs() < FRAME.0 / 2.0 && zoom * (y - center[1]).abs() < FRAME.1 / 2.0
    }

    /// Units of a point of the world, kept within the frame.
    fn place(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        let Window { center, zoom } = self.window;
        let across = (FRAME.0 / 2.0 + zoom * (x - center[0])).clamp(0.0, FRAME.0);
        let down = (FRAME.1 / 2.0 - zoom * (y - center[1])).clamp(0.0, FRAME.1);
        (self.left + across, self.top + down)
    }
}

/// Points around a shape in its body's frame; none for what has no bound.
fn rim(shape: &Shape) -> Vec<[f64; 2]> {
    const POINTS: u32 = 48;
    match shape {
        Shape::Circle { radius, center } => (0..POINTS)
            .map(|k| {
                let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(POINTS)).sin_cos();
                [center[0] + radius * c, center[1] + radius * s]
            })
            .collect(),
        Shape::Rectangle { width, height, center, angle } => {
            let (s, c) = angle.sin_cos();
            [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]
                .map(|[u, v]| [u * width, v * height])
                .map(|[u, v]| [center[0] + c * u - s * v, center[1] + s * u + c * v])
                .into()
        }
        Shape::Polygon { points } => points.clone(),
        Shape::Capsule { .. } | Shape::HalfPlane { .. } => Vec::new(),
    }
}
