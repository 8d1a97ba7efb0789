//! A chart as SVG: panels one above the other that share an axis of time, which is logarithmic behind a place for the time 0.

use std::fmt::Write;
use std::ops::Range;

/// Pixels.
const WIDTH: f64 = 760.0;
const LEFT: f64 = 76.0;
const RIGHT: f64 = 736.0;
/// Where the time 0 lies, and where the logarithmic axis begins.
const ZERO: f64 = LEFT + 34.0;
const BEGIN: f64 = LEFT + 68.0;

/// Colours for light pages, and for dark ones where the viewer says so.
const STYLE: &str = "<style>
text{font-family:Helvetica,Arial,sans-serif;font-size:13px;fill:#1f2933}
.title{font-size:16px;font-weight:bold}
.small{font-size:12px}
.page{fill:#ffffff}
.grid{stroke:#dde2e8;stroke-width:1}
.axis{stroke:#52606d;stroke-width:1;fill:none}
.band{fill:#2166ac;fill-opacity:0.22}
.median{stroke:#2166ac;stroke-width:2;fill:none}
.timed{stroke:#c2500a;stroke-width:1.5;fill:none}
.dot{fill:#c2500a}
@media (prefers-color-scheme:dark){
text{fill:#e6edf3}
.page{fill:#0d1117}
.grid{stroke:#2b323b}
.axis{stroke:#8b949e}
.band{fill:#58a6ff}
.median{stroke:#58a6ff}
.timed{stroke:#ff9d5c}
.dot{fill:#ff9d5c}
}
</style>
";

/// The axis of time, seconds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TimeAxis(Range<f64>);

impl TimeAxis {
    /// From a time to another; both become such that the axis has a length.
    pub(crate) fn new(first: f64, last: f64) -> Self {
        let first = first.max(1e-6);
        Self(first..last.max(10.0 * first))
    }

    /// Times from 0 to the end, as close as the axis can show.
    pub(crate) fn samples(&self, count: usize) -> Vec<f64> {
        let ratio = self.0.end / self.0.start;
        let time = |index: usize| self.0.start * ratio.powf(index as f64 / (count - 1) as f64);
        std::iter::once(0.0).chain((0..count).map(time)).collect()
    }

    /// Where a time lies. What comes before the logarithmic axis lies at its beginning.
    fn x(&self, seconds: f64) -> f64 {
        if seconds <= 0.0 {
            return ZERO;
        }
        let share = (seconds / self.0.start).ln() / (self.0.end / self.0.start).ln();
        BEGIN + share.clamp(0.0, 1.0) * (RIGHT - BEGIN)
    }

    /// Powers of ten on the axis.
    fn ticks(&self) -> Vec<f64> {
        let (first, last) = (self.0.start.log10().ceil() as i32, self.0.end.log10().floor() as i32);
        (first..=last).map(|power| 10.0_f64.powi(power)).collect()
    }
}

/// The chart so far.
pub(crate) struct Chart {
    body: String,
    axis: TimeAxis,
    height: f64,
}

/// A panel: where it lies, pixels from above, and the values that it shows.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    y: Range<f64>,
    values: Range<f64>,
}

impl Panel {
    fn y(&self, value: f64) -> f64 {
        let share = (value - self.values.start) / (self.values.end - self.values.start);
        self.y.end - share * (self.y.end - self.y.start)
    }
}

impl Chart {
    pub(crate) fn new(title: &str, subtitle: &str, axis: TimeAxis) -> Self {
        let title = escaped(title);
        let body = format!(
            "<title>{title}</title>\n<text class='title' x='{LEFT}' y='24'>{title}</text>\n\
             <text class='small' x='{LEFT}' y='43'>{}</text>\n",
            escaped(subtitle)
        );
        Self { body, axis, height: 58.0 }
    }

    /// Adds a panel below, with room for some values.
    pub(crate) fn panel(&mut self, height: f64, label: &str, values: &[f64]) -> Panel {
        let (ticks, values) = scale(values);
        let (top, bottom) = (self.height + 26.0, self.height + 26.0 + height);
        let panel = Panel { y: top..bottom, values };
        let _ = writeln!(self.body, "<text x='{LEFT}' y='{:.1}'>{}</text>", top - 9.0, escaped(label));
        for (tick, text) in ticks {
            let y = panel.y(tick);
            let _ = writeln!(self.body, "<line class='grid' x1='{LEFT}' x2='{RIGHT}' y1='{y:.1}' y2='{y:.1}'/>");
            let _ = writeln!(
                self.body,
                "<text class='small' text-anchor='end' x='{}' y='{:.1}'>{text}</text>",
                LEFT - 8.0,
                y + 4.0
            );
        }
        let x_ticks = self.axis.ticks().into_iter().map(|time| (self.axis.x(time), time.to_string()));
        for (x, text) in std::iter::once((ZERO, String::from("first path"))).chain(x_ticks) {
            let _ = writeln!(self.body, "<line class='grid' x1='{x:.1}' x2='{x:.1}' y1='{top:.1}' y2='{bottom:.1}'/>");
            let y = bottom + 17.0;
            let _ = writeln!(self.body, "<text class='small' text-anchor='middle' x='{x:.1}' y='{y:.1}'>{text}</text>");
        }
        let _ = writeln!(self.body, "<path class='axis' d='M{LEFT} {top:.1}V{bottom:.1}H{RIGHT}'/>");
        self.height = bottom + 24.0;
        panel
    }

    /// A line through points of time and value.
    pub(crate) fn line(&mut self, class: &str, panel: &Panel, points: impl IntoIterator<Item = (f64, f64)>) {
        let place = |(seconds, value)| format!("{:.1} {:.1}", self.axis.x(seconds), panel.y(value));
        let places: Vec<String> = points.into_iter().map(place).collect();
        let _ = writeln!(self.body, "<path class='{class}' d='M{}'/>", places.join("L"));
    }

    /// The area between two values at each time.
    pub(crate) fn band(&mut self, panel: &Panel, points: &[(f64, f64, f64)]) {
        let place = |seconds, value| format!("{:.1} {:.1}", self.axis.x(seconds), panel.y(value));
        let there = points.iter().map(|&(seconds, low, _)| place(seconds, low));
        let back = points.iter().rev().map(|&(seconds, _, high)| place(seconds, high));
        let places: Vec<String> = there.chain(back).collect();
        let _ = writeln!(self.body, "<path class='band' d='M{}Z'/>", places.join("L"));
    }

    /// A dot.
    pub(crate) fn dot(&mut self, panel: &Panel, (seconds, value): (f64, f64)) {
        let (x, y) = (self.axis.x(seconds), panel.y(value));
        let _ = writeln!(self.body, "<circle class='dot' cx='{x:.1}' cy='{y:.1}' r='4'/>");
    }

    /// The whole picture.
    pub(crate) fn svg(mut self, time: &str) -> String {
        let (middle, y, height) = (0.5 * (BEGIN + RIGHT), self.height + 14.0, self.height + 28.0);
        let time = escaped(time);
        let _ = writeln!(self.body, "<text text-anchor='middle' x='{middle:.1}' y='{y:.1}'>{time}</text>");
        let body = self.body;
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {height:.0}' width='{WIDTH}' height='{height:.0}'>\n\
             {STYLE}<rect class='page' width='{WIDTH}' height='{height:.0}'/>\n{body}</svg>\n"
        )
    }
}

/// Round numbers that enclose some values, with their texts, and the range from the first to the last.
fn scale(values: &[f64]) -> (Vec<(f64, String)>, Range<f64>) {
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = (finite().reduce(f64::min).unwrap_or(0.0), finite().reduce(f64::max).unwrap_or(1.0));
    let width = if high > low { high - low } else { 0.2 * high.abs().max(1e-3) };
    let raw = width / 4.0;
    let power = raw.log10().floor();
    let unit = 10.0_f64.powf(power);
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * unit).find(|step| *step >= raw).unwrap_or(raw);
    let (first, last) = ((low / step).floor() as i64, (high / step).ceil() as i64);
    let last = last.max(first + 1);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let ticks: Vec<(f64, String)> =
        (first..=last).map(|k| k as f64 * step).map(|tick| (tick, format!("{tick:.decimals$}"))).collect();
    (ticks, first as f64 * step..last as f64 * step)
}

pub(crate) fn escaped(text: &str) -> String {
    // Of the control characters XML allows no more than these.
    let kept = text.chars().filter(|c| !c.is_control() || matches!(c, '\t' | '\n'));
    kept.fold(String::new(), |mut out, character| {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '\'' => out.push_str("&#39;"),
            '"' => out.push_str("&quot;"),
            other => out.push(other),
        }
        out
    })
}

#[cfg(test)]
mod tests {
    use super::{BEGIN, Chart, RIGHT, TimeAxis, ZERO, scale};

    #[test]
    fn scales_enclose_their_values_with_round_numbers() {
        let texts = |values: &[f64]| scale(values).0.into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(texts(&[12.3, 29.0]), ["10", "15", "20", "25", "30"]);
        assert_eq!(texts(&[0.101, 0.142]), ["0.10", "0.12", "0.14", "0.16"]);
        for values in [&[7.0][..], &[0.0], &[], &[f64::NAN], &[-3.0, 4.0]] {
            let (ticks, range) = scale(values);
            assert!(ticks.len() >= 2 && range.end > range.start, "{values:?}: {ticks:?}");
            assert!(values.iter().all(|v| v.is_nan() || range.contains(v) || *v == range.end), "{values:?}: {range:?}");
        }
    }

    #[test]
    fn times_lie_on_a_logarithmic_axis() {
        let axis = TimeAxis::new(0.01, 100.0);
        assert_eq!(
            [0.0, 1e-3, 0.01, 1.0, 100.0].map(|t| axis.x(t).round()),
            [ZERO, BEGIN, BEGIN, 0.5 * (BEGIN + RIGHT), RIGHT]
        );
        assert_eq!(axis.ticks().len(), 5);
        assert_eq!(axis.samples(3).iter().map(|t| t.round()).collect::<Vec<_>>(), [0.0, 0.0, 1.0, 100.0]);
    }

    #[test]
    fn texts_are_escaped() {
        let svg = Chart::new("a<b & 'c'\u{7}", "", TimeAxis::new(1.0, 2.0)).svg("time");
        let read = roxmltree::Document::parse(&svg).unwrap();
        assert!(read.descendants().any(|node| node.text() == Some("a<b & 'c'")));
    }
}
