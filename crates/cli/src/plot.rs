//! Figures, drawn alike as SVG and as PNG.
//!
//! A figure is a title, what the title does not say, a legend outside the data, and panels. The
//! letters are `DejaVu` Sans, which the program carries, so that no system fonts are needed.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Once;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::Failure;

/// Colours that stay apart in print and for colour-blind readers (Okabe & Ito 2008).
pub const PALETTE: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];
/// Text and frames.
pub const INK: RGBColor = RGBColor(40, 44, 52);
/// Secondary text.
pub const GREY: RGBColor = RGBColor(110, 116, 126);
const GRID: RGBColor = RGBColor(226, 229, 234);
const FONT: &str = "sans-serif";
/// A logarithmic axis shorter than this gets ticks within its decades.
const FEW_DECADES: f64 = 2.0;
/// Pixels of the PNG per unit of the SVG.
const PNG_SCALE: f64 = 2.0;

/// A chart of curves over two axes.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What it shows.
    pub title: String,
    /// What the title does not say.
    pub subtitle: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves, the last one on top.
    pub curves: Vec<Curve>,
    /// A dashed horizontal line and what it means.
    pub level: Option<(f64, String)>,
}

/// An axis.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Whether it is logarithmic; numbers that are not positive are then left out.
    pub log: bool,
    /// Where to put ticks; round numbers if not given.
    pub ticks: Option<Vec<f64>>,
    /// Shown range; that of the data if not given.
    pub range: Option<(f64, f64)>,
}

/// A line through points.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its name in the legend.
    pub label: String,
    /// Points.
    pub points: Vec<(f64, f64)>,
    /// Index into the palette.
    pub color: usize,
    /// Whether points are marked.
    pub marks: bool,
    /// Whether the line is dashed.
    pub dashed: bool,
}

impl Axis {
    /// A linear axis.
    #[must_use]
    pub fn linear(label: &str) -> Self {
        Self { label: label.into(), log: false, ticks: None, range: None }
    }

    /// A logarithmic axis.
    #[must_use]
    pub fn log(label: &str) -> Self {
        Self { log: true, ..Self::linear(label) }
    }

    /// Where a number lies on the axis.
    fn place(&self, number: f64) -> Option<f64> {
        let place = if self.log { number.log10() } else { number };
        (place.is_finite() && (!self.log || number > 0.0)).then_some(place)
    }

    fn span(&self, numbers: impl Iterator<Item = f64>) -> (f64, f64) {
        if let Some((low, high)) = self.range {
            return (self.place(low).unwrap_or(0.0), self.place(high).unwrap_or(1.0));
        }
        let places = numbers.filter_map(|number| self.place(number));
        let (low, high) =
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        if low > high {
            return (0.0, 1.0);
        }
        let margin = if high > low { 0.04 * (high - low) } else { 0.5 };
        (low - margin, high + margin)
    }

    /// Places of the ticks within a span.
    fn tick_places(&self, (low, high): (f64, f64)) -> Vec<f64> {
        if let Some(ticks) = &self.ticks {
            return ticks.iter().filter_map(|tick| self.place(*tick)).collect();
        }
        if self.log && high - low < FEW_DECADES {
            return Self::ticks_within_decades((low, high));
        }
        let step = if self.log {
            ((high - low) / 8.0).ceil().max(1.0)
        } else {
            let raw = (high - low) / 7.0;
            let power = 10.0_f64.powf(raw.log10().floor());
            let round = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
            round.into_iter().find(|step| *step >= raw).unwrap_or(raw)
        };
        let first = (low / step).ceil();
        let count = ((high / step).floor() - first).max(-1.0);
        let mut ticks = Vec::new();
        let mut k = 0.0;
        while k <= count {
            ticks.push((first + k) * step);
            k += 1.0;
        }
        ticks
    }

    /// 1, 2 and 5 times powers of ten; all digits within less than a decade.
    fn ticks_within_decades((low, high): (f64, f64)) -> Vec<f64> {
        let (mut ticks, mut decade) = (Vec::new(), low.floor());
        while decade <= high {
            let factors: &[f64] = if high - low < 0.7 {
                &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]
            } else {
                &[1.0, 2.0, 5.0]
            };
            ticks.extend(factors.iter().map(|factor| decade + factor.log10()));
            decade += 1.0;
        }
        ticks.retain(|place| (low..=high).contains(place));
        ticks
    }

    fn tick_label(&self, place: f64) -> String {
        if !self.log {
            let rounded = (place * 1e9).round() / 1e9;
            return minus(&format!("{}", if rounded == 0.0 { 0.0 } else { rounded }));
        }
        let number = 10.0_f64.powf(place);
        if self.ticks.is_some() || place.abs() < 3.5 {
            return format!("{}", (number * 1e6).round() / 1e6);
        }
        let (decade, factor) = (place.floor(), 10.0_f64.powf(place - place.floor()).round());
        if factor > 1.0 && factor < 10.0 {
            return format!("{factor}·10{}", superscript(&format!("{decade:.0}")));
        }
        format!("10{}", superscript(&format!("{place:.0}")))
    }
}

/// A linear coordinate with its ticks where they were put.
struct Ticked {
    span: (f64, f64),
    ticks: Vec<f64>,
}

impl Ranged for Ticked {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    #[expect(clippy::cast_possible_truncation, reason = "figures are some thousand pixels wide")]
    fn map(&self, value: &f64, (first, last): (i32, i32)) -> i32 {
        let share = (value - self.span.0) / (self.span.1 - self.span.0);
        first + (share * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.span.0..self.span.1
    }
}

impl ValueFormatter<f64> for Ticked {
    fn format(value: &f64) -> String {
        value.to_string()
    }
}

fn minus(text: &str) -> String {
    text.replace('-', "−")
}

fn superscript(digits: &str) -> String {
    let raised = |c: char| match c.to_digit(10) {
        Some(d) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][d as usize],
        None => '⁻',
    };
    digits.chars().map(raised).collect()
}

/// A figure that could not be drawn; the backends' own errors differ in type.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct DrawError(String);

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for DrawError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self(error.to_string())
    }
}

/// Where a figure is drawn; `scale` turns units into pixels.
pub struct Canvas<'a, DB: DrawingBackend> {
    /// The area.
    pub area: &'a DrawingArea<DB, Shift>,
    /// Pixels per unit.
    pub scale: f64,
}

/// What can be drawn on any canvas.
pub trait Figure {
    /// Width and height, units.
    fn size(&self) -> (u32, u32);

    /// Draws it.
    ///
    /// # Errors
    /// What the backend says.
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<'_, DB>) -> Result<(), DrawError>;
}

/// Writes `stem.svg` and `stem.png`.
///
/// # Errors
/// [`Failure::Draw`].
pub fn save(figure: &impl Figure, stem: &Path) -> Result<[PathBuf; 2], Failure> {
    register_fonts();
    let files = ["svg", "png"].map(|extension| stem.with_extension(extension));
    let failure = |file: &PathBuf| {
        let file = file.clone();
        move |source: DrawError| Failure::Draw { file, message: source.to_string() }
    };
    let (width, height) = figure.size();
    let area = SVGBackend::new(&files[0], (width, height)).into_drawing_area();
    draw_on(figure, &area, 1.0).map_err(failure(&files[0]))?;
    let size = (pixels(f64::from(width), PNG_SCALE), pixels(f64::from(height), PNG_SCALE));
    drop(area);
    let area = BitMapBackend::new(&files[1], size).into_drawing_area();
    draw_on(figure, &area, PNG_SCALE).map_err(failure(&files[1]))?;
    drop(area);
    Ok(files)
}

fn draw_on<DB: DrawingBackend>(
    figure: &impl Figure,
    area: &DrawingArea<DB, Shift>,
    scale: f64,
) -> Result<(), DrawError> {
    area.fill(&WHITE)?;
    figure.draw(&Canvas { area, scale })?;
    area.present()?;
    Ok(())
}

fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let fonts =
            [(FontStyle::Normal, dejavu::sans::regular()), (FontStyle::Bold, dejavu::sans::bold())];
        for (style, bytes) in fonts {
            // Fails on malformed fonts only; drawing would then say that there is none.
            let _ = plotters::style::register_font(FONT, style, bytes);
        }
    });
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "figures are some thousand pixels wide"
)]
fn pixels(units: f64, scale: f64) -> u32 {
    (units * scale).round() as u32
}

#[expect(clippy::cast_possible_truncation, reason = "figures are some thousand pixels wide")]
fn coordinate(units: f64, scale: f64) -> i32 {
    (units * scale).round() as i32
}

impl<DB: DrawingBackend> Canvas<'_, DB> {
    /// Writes a line of text with its anchor at a point, units; returns its width, units.
    ///
    /// # Errors
    /// What the backend says.
    pub fn text(
        &self,
        text: &str,
        (x, y): (f64, f64),
        size: f64,
        (style, color): (FontStyle, RGBColor),
        anchor: (HPos, VPos),
    ) -> Result<f64, DrawError> {
        let font = FontDesc::new(FontFamily::SansSerif, size * self.scale, style);
        let style = TextStyle::from(font).color(&color).pos(Pos::new(anchor.0, anchor.1));
        self.area.draw_text(text, &style, self.at(x, y))?;
        let (width, _) = self.area.estimate_text_size(text, &style)?;
        Ok(f64::from(width) / self.scale)
    }

    /// Pixels of a point.
    #[must_use]
    pub fn at(&self, x: f64, y: f64) -> (i32, i32) {
        (coordinate(x, self.scale), coordinate(y, self.scale))
    }

    /// A stroke of a width in units.
    #[must_use]
    pub fn stroke(&self, color: RGBColor, width: f64) -> ShapeStyle {
        ShapeStyle {
            color: color.to_rgba(),
            filled: false,
            stroke_width: pixels(width, self.scale),
        }
    }

    /// Title, subtitle and legend; returns how high they are, units.
    ///
    /// # Errors
    /// What the backend says.
    pub fn header(
        &self,
        title: &str,
        subtitle: &str,
        legend: &[(&str, RGBColor)],
    ) -> Result<f64, DrawError> {
        let top_left = (HPos::Left, VPos::Top);
        self.text(title, (MARGIN, 14.0), 21.0, (FontStyle::Bold, INK), top_left)?;
        let mut y = 42.0;
        if !subtitle.is_empty() {
            self.text(subtitle, (MARGIN, y), 15.0, (FontStyle::Normal, GREY), top_left)?;
            y += 24.0;
        }
        if legend.is_empty() {
            return Ok(y);
        }
        let mut x = MARGIN;
        let width = f64::from(self.area.dim_in_pixel().0) / self.scale;
        for (label, color) in legend {
            let expected = SWATCH + 9.0 * label.chars().count() as f64;
            if x > MARGIN && x + expected > width - MARGIN {
                x = MARGIN;
                y += 22.0;
            }
            let middle = y + 11.0;
            let swatch = [self.at(x, middle), self.at(x + SWATCH, middle)];
            self.area.draw(&PathElement::new(swatch, self.stroke(*color, 4.0)))?;
            let (style, anchor) = ((FontStyle::Normal, INK), (HPos::Left, VPos::Center));
            let drawn = self.text(label, (x + SWATCH + 6.0, middle), 15.0, style, anchor)?;
            x += SWATCH + 6.0 + drawn + 18.0;
        }
        Ok(y + 26.0)
    }
}

const MARGIN: f64 = 20.0;
const SWATCH: f64 = 22.0;

impl Figure for Chart {
    fn size(&self) -> (u32, u32) {
        (820, 520)
    }

    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<'_, DB>) -> Result<(), DrawError> {
        let named = self.curves.iter().filter(|curve| !curve.label.is_empty());
        let mut legend: Vec<_> = named.map(|c| (c.label.as_str(), PALETTE[c.color])).collect();
        legend.extend(self.level.iter().map(|(_, label)| (label.as_str(), GREY)));
        let top = canvas.header(&self.title, &self.subtitle, &legend)?;
        let unit = |units: f64| pixels(units, canvas.scale);
        let (_, below) = canvas.area.split_vertically(unit(top));

        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        let x_span = self.x.span(points().map(|point| point.0));
        let level = self.level.as_ref().map(|(level, _)| *level);
        let y_span = self.y.span(points().map(|point| point.1).chain(level));
        let font = |size: f64| (FONT, size * canvas.scale).into_font().color(&INK);
        let mut chart = ChartBuilder::on(&below)
            .margin_right(unit(24.0))
            .margin_left(unit(10.0))
            .margin_bottom(unit(8.0))
            .margin_top(unit(6.0))
            .x_label_area_size(unit(50.0))
            .y_label_area_size(unit(72.0))
            .build_cartesian_2d(
                Ticked { span: x_span, ticks: self.x.tick_places(x_span) },
                Ticked { span: y_span, ticks: self.y.tick_places(y_span) },
            )?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(canvas.stroke(GRID, 1.0))
            .axis_style(canvas.stroke(INK, 1.0))
            .label_style(font(15.0))
            .axis_desc_style(font(17.0))
            .x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_label_formatter(&|place| self.x.tick_label(*place))
            .y_label_formatter(&|place| self.y.tick_label(*place))
            .draw()?;
        if let Some(y) = level.and_then(|level| self.y.place(level)) {
            let line = [(x_span.0, y), (x_span.1, y)];
            let style = canvas.stroke(GREY, 1.5);
            let dashed = DashedLineSeries::new(line, unit(6.0), unit(5.0), style);
            chart.draw_series(dashed)?;
        }
        for curve in &self.curves {
            let place = |(x, y): &(f64, f64)| Some((self.x.place(*x)?, self.y.place(*y)?));
            let points: Vec<_> = curve.points.iter().filter_map(place).collect();
            let style = canvas.stroke(PALETTE[curve.color], 2.5);
            if curve.dashed {
                let dashes = DashedLineSeries::new(points.clone(), unit(9.0), unit(6.0), style);
                chart.draw_series(dashes)?;
            } else {
                chart.draw_series(LineSeries::new(points.clone(), style))?;
            }
            if curve.marks {
                let mark = |p: (f64, f64)| Circle::new(p, unit(4.0), style.filled());
                chart.draw_series(points.into_iter().map(mark))?;
            }
        }
        Ok(())
    }
}
