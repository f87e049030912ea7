//! Scalable vector graphics, as much as a chart needs.

use std::fmt::{Display, Write as _};

/// A drawing that grows.
#[derive(Clone, Debug)]
pub(super) struct Svg {
    body: String,
    width: f64,
    height: f64,
}

/// How a text stands at its place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A text and where it stands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Text<'a> {
    pub at: (f64, f64),
    pub text: &'a str,
    pub anchor: Anchor,
    pub size: f64,
    pub bold: bool,
}

impl Svg {
    pub fn new(width: f64, height: f64) -> Self {
        Self { body: String::new(), width, height }
    }

    pub fn rectangle(&mut self, at: (f64, f64), size: (f64, f64), style: &str) {
        let ((x, y), (w, h)) = (at, size);
        let _ = writeln!(self.body, "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" {style}/>");
    }

    pub fn line(&mut self, a: (f64, f64), b: (f64, f64), style: &str) {
        let ((x1, y1), (x2, y2)) = (a, b);
        let _ = writeln!(self.body, "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>");
    }

    pub fn polyline(&mut self, points: &[(f64, f64)], style: &str) {
        let list: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(self.body, "<polyline points=\"{}\" fill=\"none\" {style}/>", list.join(" "));
    }

    /// A closed shape with a text that shows when it is pointed at.
    pub fn polygon(&mut self, points: &[(f64, f64)], style: &str, hint: &str) {
        let list: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let hint = escaped(hint);
        let _ = writeln!(self.body, "<polygon points=\"{}\" {style}><title>{hint}</title></polygon>", list.join(" "));
    }

    pub fn circle(&mut self, (x, y): (f64, f64), radius: f64, style: &str, hint: &str) {
        let hint = escaped(hint);
        let place = format!("cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius:.1}\"");
        let _ = writeln!(self.body, "<circle {place} {style}><title>{hint}</title></circle>");
    }

    pub fn text(&mut self, text: Text<'_>) {
        self.turned(text, 0.0);
    }

    /// A text turned counter-clockwise by an angle \[degrees\].
    pub fn turned(&mut self, text: Text<'_>, angle: f64) {
        let Text { at: (x, y), text, anchor, size, bold } = text;
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if bold { " font-weight=\"bold\"" } else { "" };
        let turn =
            if angle == 0.0 { String::new() } else { format!(" transform=\"rotate({} {x:.1} {y:.1})\"", -angle) };
        let place = format!("x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\"");
        let _ = writeln!(self.body, "<text {place}{weight}{turn}>{}</text>", escaped(text));
    }

    /// The whole file, on white.
    pub fn finish(self) -> String {
        let Self { body, width, height } = self;
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, sans-serif\" \
             fill=\"#222\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n{body}</svg>\n"
        )
    }
}

/// Text that is no markup.
pub(super) fn escaped(text: impl Display) -> String {
    text.to_string().replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
