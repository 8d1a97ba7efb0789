//! The plane that plots are drawn on: SVG of one size, axes, and the colours of the page.

use crate::batch::error::BatchError;
use crate::batch::improvement::chart::escaped;
use plotters::chart::{ChartBuilder, ChartContext, MeshStyle};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::prelude::{
    Cartesian2d, Color, DrawingArea, IntoDrawingArea, IntoFont, RGBColor, SVGBackend, TextStyle, WHITE,
};
use plotters::style::IntoTextStyle;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ops::Range;

/// Width of every plot, pixels.
pub(crate) const WIDTH: u32 = 880;
/// Text of axes, pixels.
pub(crate) const TEXT: i32 = 16;
/// Text.
pub(crate) const INK: RGBColor = RGBColor(31, 41, 51);
/// Lines of axes.
pub(crate) const GRID: RGBColor = RGBColor(221, 226, 232);

/// Colours that people with any colour vision tell apart (Okabe and Ito), the lightest left out.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];

pub(crate) type Plane<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// The colour of a scheduler with settings.
pub(crate) fn colour(kind: usize) -> RGBColor {
    COLOURS[kind % COLOURS.len()]
}

/// The same as a style sheet has it.
pub(crate) fn css_colour(kind: usize) -> String {
    let RGBColor(r, g, b) = colour(kind);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A plot: what `draw` puts on a white plane of this height, with a title for those who do not see it.
pub(crate) fn svg(
    height: u32,
    title: &str,
    draw: impl FnOnce(&Plane<'_>) -> Result<(), BatchError>,
) -> Result<String, BatchError> {
    let mut text = String::new();
    {
        let plane = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        plane.fill(&WHITE).map_err(failed)?;
        draw(&plane)?;
        plane.present().map_err(failed)?;
    }
    // Pages scale it to the width of the screen. A name makes it readable to those who hear the page.
    let label = format!("<svg role=\"img\" aria-label=\"{}\" ", escaped(title));
    Ok(text.replacen("<svg ", &label, 1))
}

/// A chart with margins for the labels of its axes.
pub(crate) fn chart<'a, 'b>(plane: &'a Plane<'b>) -> ChartBuilder<'a, 'b, SVGBackend<'b>> {
    let mut chart = ChartBuilder::on(plane);
    chart.margin(14).margin_right(34).x_label_area_size(52).y_label_area_size(72);
    chart
}

/// The axes of a chart in the style of the page.
pub(crate) fn axes<'a, 'b, X, Y>(
    chart: &'b mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>,
) -> MeshStyle<'a, 'b, X, Y, SVGBackend<'a>>
where
    X: Ranged + ValueFormatter<X::ValueType>,
    Y: Ranged + ValueFormatter<Y::ValueType>,
{
    let text = || ("sans-serif", TEXT).into_font().color(&INK);
    let mut axes = chart.configure_mesh();
    axes.bold_line_style(GRID)
        .light_line_style(GRID.mix(0.4))
        .axis_style(INK)
        .label_style(text())
        .axis_desc_style(text());
    axes
}

/// An error of the library that draws.
pub(crate) fn failed(error: impl std::fmt::Display) -> BatchError {
    BatchError::Plot(error.to_string())
}

/// Text of axes that ends at its place.
pub(crate) fn right_text<'a>() -> TextStyle<'a> {
    ("sans-serif", TEXT).into_text_style(&NO_SIZE).color(&INK).pos(Pos::new(HPos::Right, VPos::Center))
}

/// Text of axes that begins at its place.
pub(crate) fn left_text<'a>() -> TextStyle<'a> {
    ("sans-serif", TEXT).into_text_style(&NO_SIZE).color(&INK).pos(Pos::new(HPos::Left, VPos::Center))
}

/// Sizes of text are pixels: nothing to scale by.
const NO_SIZE: (u32, u32) = (WIDTH, WIDTH);

/// A logarithmic axis that holds some values, from a power of ten to another: ticks of other axes come twice.
pub(crate) fn decades(values: impl IntoIterator<Item = f64>) -> Option<Range<f64>> {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for value in values.into_iter().filter(|value| value.is_finite() && *value > 0.0) {
        (low, high) = (low.min(value), high.max(value));
    }
    (low <= high).then(|| {
        let (first, last) = (low.log10().floor(), high.log10().ceil());
        let last = if last <= first { first + 1.0 } else { last };
        10.0_f64.powf(first)..10.0_f64.powf(last)
    })
}

/// A linear axis from 0 that holds some values.
pub(crate) fn from_zero(values: impl IntoIterator<Item = f64>) -> Range<f64> {
    let high = values.into_iter().filter(|value| value.is_finite()).fold(0.0, f64::max);
    0.0..if high > 0.0 { 1.08 * high } else { 1.0 }
}

/// Seconds as people write them: `20 ms`, `1.5 s`.
pub(crate) fn time_text(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (s * 1e6, "µs"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s => (s, "s"),
    };
    let rounded = (value * 100.0).round() / 100.0;
    format!("{rounded} {unit}")
}

#[cfg(test)]
mod tests {
    use super::{decades, from_zero, time_text};

    #[test]
    fn axes_hold_their_values() {
        assert_eq!(decades([0.02, 0.5]), Some(0.01..1.0));
        assert_eq!(decades([1.0]), Some(1.0..10.0));
        assert_eq!(decades([0.0, f64::NAN]), None);
        assert_eq!((from_zero([2.0]).end, from_zero([]).end), (2.16, 1.0));
        assert_eq!([0.0005, 0.02, 1.5].map(time_text), ["500 µs", "20 ms", "1.5 s"]);
    }
}
