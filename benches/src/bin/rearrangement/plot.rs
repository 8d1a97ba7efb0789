//! Time and memory against the number of boxes, both axes logarithmic, as SVG.

use crate::Row;
use crate::instance::Kind;
use std::fmt::Write;

/// Pixels.
const WIDTH: f64 = 380.0;
const HEIGHT: f64 = 300.0;
const MARGIN: f64 = 64.0;

/// By kind.
const COLOURS: [&str; 3] = ["#2166ac", "#c2500a", "#3a7d44"];

/// A panel with a logarithmic axis of values.
struct Panel {
    left: f64,
    boxes: (f64, f64),
    values: (f64, f64),
}

impl Panel {
    fn x(&self, boxes: f64) -> f64 {
        self.left + share(self.boxes, boxes) * (WIDTH - 1.5 * MARGIN)
    }

    fn y(&self, value: f64) -> f64 {
        HEIGHT - share(self.values, value) * (HEIGHT - MARGIN)
    }
}

fn share((first, last): (f64, f64), value: f64) -> f64 {
    (value / first).ln() / (last / first).ln()
}

/// Medians of the solves that have an answer: solid lines with one arm, dashed ones with two.
pub fn plot(rows: &[Row]) -> String {
    let (width, height) = (2.0 * WIDTH + MARGIN, HEIGHT + MARGIN);
    let mut svg = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' font-family='Helvetica,Arial,sans-serif' \
         font-size='12'>\n<rect width='{width}' height='{height}' fill='#ffffff'/>\n"
    );
    add(&mut svg, rows, MARGIN, ("seconds", 1.0), "time (s)");
    add(&mut svg, rows, MARGIN + WIDTH, ("bytes", 1e-6), "peak memory (MB)");
    for (number, kind) in Kind::ALL.into_iter().enumerate() {
        let (x, y) = (MARGIN + 90.0 * number as f64, HEIGHT + 48.0);
        let _ = writeln!(svg, "<text x='{x}' y='{y}' fill='{}'>{}</text>", COLOURS[number], kind.name());
    }
    let _ = writeln!(svg, "<text x='{}' y='{}'>solid: one arm, dashed: two</text>", MARGIN + WIDTH, HEIGHT + 48.0);
    svg + "</svg>\n"
}

fn add(svg: &mut String, rows: &[Row], left: f64, (key, unit): (&str, f64), label: &str) {
    let median = |row: &Row| {
        let values = row.sorted(key);
        values.get(values.len() / 2).map(|value| (row.boxes as f64, value * unit))
    };
    let points: Vec<_> = rows.iter().filter_map(|row| Some((row, median(row)?))).collect();
    let Some(panel) = panel(left, points.iter().map(|&(_, point)| point)) else { return };
    let _ = writeln!(svg, "<text x='{left}' y='24' font-size='14'>{label}</text>");
    let mut power = panel.values.0;
    while power <= panel.values.1 * 1.001 {
        let (y, end) = (panel.y(power), panel.x(panel.boxes.1));
        let _ = writeln!(svg, "<path d='M{left} {y:.1}H{end:.1}' stroke='#dde2e8'/>");
        let _ = writeln!(svg, "<text x='{:.1}' y='{:.1}' text-anchor='end'>{power}</text>", left - 6.0, y + 4.0);
        power *= 10.0;
    }
    let mut sizes: Vec<usize> = rows.iter().map(|row| row.boxes).collect();
    sizes.sort_unstable();
    sizes.dedup();
    for boxes in sizes {
        let x = panel.x(boxes as f64);
        let _ = writeln!(svg, "<text x='{x:.1}' y='{:.1}' text-anchor='middle'>{boxes}</text>", HEIGHT + 18.0);
    }
    for (number, kind) in Kind::ALL.into_iter().enumerate() {
        for arms in [1, 2] {
            let of = points.iter().filter(|(row, _)| row.kind == kind && row.arms == arms);
            let places: Vec<_> = of.map(|&(_, (n, v))| format!("{:.1} {:.1}", panel.x(n), panel.y(v))).collect();
            let dashes = if arms == 1 { "" } else { " stroke-dasharray='6 4'" };
            let (colour, line) = (COLOURS[number], places.join("L"));
            if !places.is_empty() {
                let _ = writeln!(svg, "<path d='M{line}' fill='none' stroke='{colour}' stroke-width='2'{dashes}/>");
            }
        }
    }
}

/// A panel with room for some points, whose values go from a power of ten to another.
fn panel(left: f64, points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<Panel> {
    let (first, last) = (points.clone().map(|p| p.0), points.clone().map(|p| p.0));
    let boxes = (first.reduce(f64::min)?, last.reduce(f64::max)?);
    let (least, most) = (points.clone().map(|p| p.1).reduce(f64::min)?, points.map(|p| p.1).reduce(f64::max)?);
    let power = |exponent: f64| 10f64.powf(exponent);
    let values = (power(least.log10().floor()), power((most * 1.001).log10().ceil()));
    Some(Panel { left, boxes: (boxes.0, boxes.1.max(boxes.0 * 1.01)), values })
}
