//! Pixels to draw on, in the coordinates of the world.
//!
//! ```text
//!  x_px = W/2 + s (x − c_x),   y_px = H/2 − s (y − c_y),   s = min(W / width, H / height) of the view
//! ```
//!
//! with the view's centre c: y points up in the world and down in the picture. All that is drawn is convex
//! polygons; lines are thin ones.

use tiny_skia::{Color, FillRule, Paint, PathBuilder, Pixmap, Transform};

use crate::clip::{Point, within};
use crate::palette::Rgb;
use crate::{View, ViewError};

/// The most pixels of a side; beyond, the rasteriser works in tiles and less exactly.
const MOST: u32 = 8000;
/// Farther off than this, in pixels, places are not told apart.
const FAR: f64 = 1e9;
/// How far beyond the picture is drawn, in units of line width.
const BEYOND: f64 = 8.0;
/// Side of a picture whose lines are as wide as the numbers say, pixels.
const USUAL: f64 = 500.0;
/// The thinnest lines of small pictures, as a part of the usual ones.
const THINNEST: f64 = 0.6;
/// A dash and the gap after it, units.
const DASH: [f64; 2] = [7.0, 5.0];

pub(crate) struct Canvas {
    pixmap: Pixmap,
    center: [f64; 2],
    /// Pixels per metre.
    scale: f64,
    /// Pixels per unit of line width.
    unit: f64,
}

impl Canvas {
    pub(crate) fn new(
        [width, height]: [u32; 2],
        view: &View,
        background: Rgb,
    ) -> Result<Self, ViewError> {
        let size = ViewError::Size { width, height, most: MOST };
        if width > MOST || height > MOST {
            return Err(size);
        }
        let mut pixmap = Pixmap::new(width, height).ok_or(size)?;
        let [w, h] = [0, 1].map(|k| view.upper[k] - view.lower[k]);
        let scale = (f64::from(width) / w).min(f64::from(height) / h);
        let center = view.center();
        let fine =
            w > 0.0 && h > 0.0 && [scale, center[0], center[1]].iter().all(|x| x.is_finite());
        if !fine || scale <= 0.0 {
            return Err(ViewError::View { lower: view.lower, upper: view.upper });
        }
        let [r, g, b] = background;
        pixmap.fill(Color::from_rgba8(r, g, b, 255));
        let unit = (f64::from(width.min(height)) / USUAL).max(THINNEST);
        Ok(Self { pixmap, center, scale, unit })
    }

    pub(crate) fn finish(self) -> Pixmap {
        self.pixmap
    }

    /// Pixels per unit of line width: lines of large pictures are wider.
    pub(crate) fn unit(&self) -> f64 {
        self.unit
    }

    /// Centre of the view, m.
    pub(crate) fn center(&self) -> [f64; 2] {
        self.center
    }

    /// Pixels of a length, m.
    pub(crate) fn length(&self, length: f64) -> f64 {
        (length * self.scale).clamp(-FAR, FAR)
    }

    fn size(&self) -> [f64; 2] {
        [self.pixmap.width(), self.pixmap.height()].map(f64::from)
    }

    /// The middle of the picture, pixels.
    pub(crate) fn middle(&self) -> Point {
        self.size().map(|side| 0.5 * side)
    }

    /// The pixel where a point of the world is.
    pub(crate) fn pixel(&self, [x, y]: [f64; 2]) -> Point {
        let [u, v] = self.middle();
        [u + self.length(x - self.center[0]), v - self.length(y - self.center[1])]
    }

    /// The picture's corners with a border around it where lines may end unseen.
    pub(crate) fn frame(&self) -> [Point; 4] {
        let ([w, h], d) = (self.size(), BEYOND * self.unit);
        [[-d, -d], [w + d, -d], [w + d, h + d], [-d, h + d]]
    }

    /// What of a line or a convex polygon is seen.
    fn seen(&self, points: &[Point]) -> Vec<Point> {
        let [lower, _, upper, _] = self.frame();
        within(points, lower, upper)
    }

    /// Fills a convex polygon.
    pub(crate) fn fill(&mut self, points: &[Point], ink: Rgb) {
        let Some(path) = path(&self.seen(points)) else { return };
        let [r, g, b] = ink;
        let mut paint = Paint::default();
        paint.set_color_rgba8(r, g, b, 255);
        self.pixmap.fill_path(&path, &paint, FillRule::Winding, Transform::identity(), None);
    }

    /// Draws a line with square ends, so many units wide.
    pub(crate) fn line(&mut self, [a, b]: [Point; 2], ink: Rgb, width: f64) {
        let half = 0.5 * width * self.unit;
        let d = [b[0] - a[0], b[1] - a[1]];
        let length = d[0].hypot(d[1]);
        if length > 0.0 {
            let [u, v] = d.map(|x| half * x / length);
            let corner = |p: Point, along: f64, side: f64| {
                [p[0] + along * u - side * v, p[1] + along * v + side * u]
            };
            let [c, d] = [corner(b, 1.0, -1.0), corner(b, 1.0, 1.0)];
            self.fill(&[corner(a, -1.0, 1.0), corner(a, -1.0, -1.0), c, d], ink);
        }
    }

    /// Draws lines from point to point.
    pub(crate) fn lines(&mut self, points: &[Point], ink: Rgb, width: f64) {
        points.windows(2).for_each(|ends| self.line([ends[0], ends[1]], ink, width));
    }

    /// Draws what is seen of a line as dashes.
    pub(crate) fn dashed(&mut self, ends: [Point; 2], ink: Rgb, width: f64) {
        let seen = self.seen(&ends);
        let Some((a, b)) = farthest_from(ends[0], &seen) else { return };
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let [dash, gap] = DASH.map(|x| x * self.unit);
        let at = |s: f64| [0, 1].map(|k| a[k] + (s / length) * (b[k] - a[k]));
        let mut s = 0.0;
        while s < length {
            self.line([at(s), at((s + dash).min(length))], ink, width);
            s += dash + gap;
        }
    }
}

/// The points of a clipped line that are nearest to and farthest from one of its ends.
fn farthest_from([x, y]: Point, points: &[Point]) -> Option<(Point, Point)> {
    let far = |p: &Point| (p[0] - x).hypot(p[1] - y);
    let by_far = |p: &&Point, q: &&Point| far(p).total_cmp(&far(q));
    Some((*points.iter().min_by(by_far)?, *points.iter().max_by(by_far)?))
}

fn path(points: &[Point]) -> Option<tiny_skia::Path> {
    let (first, rest) = points.split_first()?;
    let mut path = PathBuilder::new();
    path.move_to(pixels(first[0]), pixels(first[1]));
    for p in rest {
        path.line_to(pixels(p[0]), pixels(p[1]));
    }
    path.close();
    path.finish()
}

#[expect(clippy::cast_possible_truncation, reason = "clipped to the picture")]
fn pixels(x: f64) -> f32 {
    x as f32
}
