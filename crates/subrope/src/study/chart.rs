//! A chart of error against cost, both logarithmic.

use super::axis::LogAxis;
use super::svg::{Anchor, Svg, Text};

/// What is drawn.
#[derive(Clone, Debug, Default)]
pub(super) struct Chart {
    pub title: String,
    pub x_label: String,
    pub y_label: String,
    pub series: Vec<Curve>,
    /// The Pareto front, by rising cost.
    pub front: Vec<(f64, f64)>,
    /// A level of the error.
    pub target: Option<(f64, String)>,
    /// Lines below the chart.
    pub notes: Vec<String>,
}

/// A series, from coarse to fine.
#[derive(Clone, Debug, Default)]
pub(super) struct Curve {
    pub name: String,
    pub points: Vec<Point>,
}

/// A member.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    pub x: f64,
    /// Smallest and largest cost seen.
    pub band: (f64, f64),
    pub y: f64,
    /// Shown when pointed at.
    pub hint: String,
}

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 560.0;
const LEFT: f64 = 84.0;
const RIGHT: f64 = 640.0;
const TOP: f64 = 48.0;
const BOTTOM: f64 = 452.0;
/// Left edge of the legend.
const LEGEND: f64 = 660.0;
const LINE: f64 = 22.0;

/// Colours that also those tell apart who see few (Okabe and Ito), on white.
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"];

/// Draws a chart; `None` when there is nothing to draw.
pub(super) fn draw(chart: &Chart) -> Option<String> {
    let points = || chart.series.iter().flat_map(|s| &s.points).filter(|p| p.x > 0.0 && p.y > 0.0);
    let x = LogAxis::around(points().flat_map(|p| [p.x, p.band.0, p.band.1]), LEFT, RIGHT)?;
    let target = chart.target.as_ref().map(|(value, _)| *value);
    let y = LogAxis::around(points().map(|p| p.y).chain(target), BOTTOM, TOP)?;
    let mut drawing = Drawing { svg: Svg::new(WIDTH, HEIGHT), x, y };
    drawing.text((LEFT, 28.0), &chart.title, Anchor::Start, 17.0, true);
    drawing.grid(chart);
    drawing.front(chart);
    for (index, curve) in chart.series.iter().enumerate() {
        drawing.curve(index, curve);
    }
    drawing.legend(chart);
    for (row, note) in chart.notes.iter().enumerate() {
        drawing.text((LEFT, BOTTOM + 66.0 + 16.0 * row as f64), note, Anchor::Start, 12.0, false);
    }
    Some(drawing.svg.finish())
}

struct Drawing {
    svg: Svg,
    x: LogAxis,
    y: LogAxis,
}

impl Drawing {
    fn text(&mut self, at: (f64, f64), text: &str, anchor: Anchor, size: f64, bold: bool) {
        self.svg.text(Text { at, text, anchor, size, bold });
    }

    fn grid(&mut self, chart: &Chart) {
        let style = |major: bool| if major { "stroke=\"#bbb\"" } else { "stroke=\"#eee\"" };
        for tick in self.x.ticks() {
            self.svg.line((tick.at, TOP), (tick.at, BOTTOM), style(tick.major));
            if tick.labelled {
                self.text((tick.at, BOTTOM + 20.0), &plain(tick.value), Anchor::Middle, 13.0, false);
            }
        }
        for tick in self.y.ticks() {
            self.svg.line((LEFT, tick.at), (RIGHT, tick.at), style(tick.major));
            if tick.labelled {
                let label = format!("{} %", plain(100.0 * tick.value));
                self.text((LEFT - 8.0, tick.at + 4.5), &label, Anchor::End, 13.0, false);
            }
        }
        let frame = "fill=\"none\" stroke=\"#444\"";
        self.svg.rectangle((LEFT, TOP), (RIGHT - LEFT, BOTTOM - TOP), frame);
        let middle = 0.5 * (LEFT + RIGHT);
        self.text((middle, BOTTOM + 42.0), &chart.x_label, Anchor::Middle, 14.0, false);
        let at = (22.0, 0.5 * (TOP + BOTTOM));
        self.svg.turned(Text { at, text: &chart.y_label, anchor: Anchor::Middle, size: 14.0, bold: false }, 90.0);
        if let Some((value, _)) = &chart.target {
            let at = self.y.at(*value);
            self.svg.line((LEFT, at), (RIGHT, at), TARGET);
        }
    }

    /// Below the curves: from each of its points across to the cost of the next, then down.
    fn front(&mut self, chart: &Chart) {
        let mut path: Vec<(f64, f64)> = Vec::new();
        for &(x, y) in &chart.front {
            let (x, y) = (self.x.at(x), self.y.at(y));
            if let Some(&(_, above)) = path.last() {
                path.push((x, above));
            }
            path.push((x, y));
        }
        if path.len() > 1 {
            self.svg.polyline(&path, FRONT);
        }
    }

    fn curve(&mut self, index: usize, curve: &Curve) {
        let colour = COLOURS[index % COLOURS.len()];
        let shown: Vec<&Point> = curve.points.iter().filter(|p| p.x > 0.0 && p.y > 0.0).collect();
        let at = |p: &Point| (self.x.at(p.x), self.y.at(p.y));
        let places: Vec<_> = shown.iter().map(|p| at(p)).collect();
        if places.len() > 1 {
            self.svg.polyline(&places, &format!("stroke=\"{colour}\" stroke-width=\"1.8\""));
        }
        for (point, place) in shown.into_iter().zip(places) {
            self.noise(point, place.1, colour);
            self.marker(index, place, &point.hint);
        }
    }

    fn noise(&mut self, point: &Point, y: f64, colour: &str) {
        let (low, high) = (self.x.at(point.band.0), self.x.at(point.band.1));
        if high - low < 0.5 {
            return;
        }
        let style = format!("stroke=\"{colour}\" stroke-width=\"1.4\"");
        self.svg.line((low, y), (high, y), &style);
        for end in [low, high] {
            self.svg.line((end, y - 4.0), (end, y + 4.0), &style);
        }
    }

    /// Shapes change with the colours, and go on when these begin again.
    fn marker(&mut self, index: usize, (x, y): (f64, f64), hint: &str) {
        let style = format!("fill=\"{}\" stroke=\"#fff\" stroke-width=\"1\"", COLOURS[index % COLOURS.len()]);
        let r = 5.5;
        let shape: &[(f64, f64)] = match index % 5 {
            0 => return self.svg.circle((x, y), r, &style, hint),
            1 => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            2 => &[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)],
            3 => &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
            _ => &[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)],
        };
        let corners: Vec<_> = shape.iter().map(|(dx, dy)| (x + r * dx, y + r * dy)).collect();
        self.svg.polygon(&corners, &style, hint);
    }

    fn legend(&mut self, chart: &Chart) {
        let mut y = TOP + 10.0;
        for (index, curve) in chart.series.iter().enumerate() {
            let style = format!("stroke=\"{}\" stroke-width=\"1.8\"", COLOURS[index % COLOURS.len()]);
            self.svg.line((LEGEND, y), (LEGEND + 28.0, y), &style);
            self.marker(index, (LEGEND + 14.0, y), &curve.name);
            self.text((LEGEND + 36.0, y + 4.5), &curve.name, Anchor::Start, 13.0, false);
            y += LINE;
        }
        if chart.front.len() > 1 {
            self.svg.line((LEGEND, y), (LEGEND + 28.0, y), FRONT);
            self.text((LEGEND + 36.0, y + 4.5), "Pareto front", Anchor::Start, 13.0, false);
            y += LINE;
        }
        if let Some((_, label)) = &chart.target {
            self.svg.line((LEGEND, y), (LEGEND + 28.0, y), TARGET);
            self.text((LEGEND + 36.0, y + 4.5), label, Anchor::Start, 13.0, false);
            y += LINE;
        }
        if chart.series.iter().flat_map(|s| &s.points).any(|p| p.band.1 > p.band.0) {
            let style = "stroke=\"#222\" stroke-width=\"1.4\"";
            self.svg.line((LEGEND, y), (LEGEND + 28.0, y), style);
            for end in [LEGEND, LEGEND + 28.0] {
                self.svg.line((end, y - 4.0), (end, y + 4.0), style);
            }
            self.text((LEGEND + 36.0, y + 4.5), "fastest to slowest run", Anchor::Start, 13.0, false);
        }
    }
}

const FRONT: &str = "stroke=\"#999\" stroke-width=\"7\" stroke-opacity=\"0.35\" stroke-linejoin=\"round\"";
const TARGET: &str = "stroke=\"#b00020\" stroke-width=\"1.4\" stroke-dasharray=\"7 5\"";

/// A round number as people write it.
fn plain(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse().unwrap_or(value);
    if (1e-6..1e7).contains(&rounded) { format!("{rounded}") } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart() -> Chart {
        let point = |x: f64, y: f64| Point { x, band: (x, 1.3 * x), y, hint: "a < b & \"c\"".into() };
        Chart {
            title: "a < b & c".into(),
            series: (0..6)
                .map(|i| Curve { name: format!("s{i}"), points: vec![point(1.0 + f64::from(i), 0.1), point(9.0, 0.0)] })
                .collect(),
            front: vec![(1.0, 0.1), (2.0, 0.05)],
            target: Some((0.01, "target 1 %".into())),
            ..Chart::default()
        }
    }

    /// Tags of a drawing, in order, if every one that is opened is closed.
    fn tags(text: &str) -> Option<Vec<String>> {
        let (mut open, mut all) = (Vec::new(), Vec::new());
        for tag in text.split('<').skip(1) {
            let (inside, _) = tag.split_once('>')?;
            if inside.starts_with('?') || inside.ends_with('/') {
                all.push(inside.split([' ', '/']).next()?.to_owned());
            } else if let Some(name) = inside.strip_prefix('/') {
                (open.pop()? == name).then_some(())?;
            } else {
                open.push(inside.split(' ').next()?.to_owned());
                all.push(inside.split(' ').next()?.to_owned());
            }
        }
        open.is_empty().then_some(all)
    }

    #[test]
    fn drawings_are_well_formed() {
        let text = draw(&chart()).unwrap();
        let tags = tags(&text).unwrap();
        assert_eq!(tags.iter().filter(|t| *t == "svg").count(), 1);
        assert!(text.contains("a &lt; b &amp; c") && text.contains("target 1 %"));
        // Two series have circles: points without an error are left out, one marker is in the legend.
        assert_eq!(tags.iter().filter(|t| *t == "circle").count(), 4);
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }

    #[test]
    fn nothing_is_drawn_of_nothing() {
        assert_eq!(draw(&Chart::default()), None);
    }
}
