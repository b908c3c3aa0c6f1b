//! Series and clouds of points over a coordinate, in panels one above the other.

use std::fmt::Write;

use super::Target;
use super::drawing::{self, Sample, class, text};
use super::scale::{coordinate, padded, range, ticks};
use super::style::{Mark, Style};
use crate::escape;

#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Axis {
    pub label: String,
    /// Its unit; may be empty.
    pub unit: String,
}

impl Axis {
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into() }
    }

    fn title(&self) -> String {
        if self.unit.is_empty() { self.label.clone() } else { format!("{} [{}]", self.label, self.unit) }
    }
}

/// Values over the coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// What the legend calls it; layers of one name share an entry, an empty name has none.
    pub name: String,
    pub style: Style,
    pub mark: Mark,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
}

/// A stretch of the coordinate that is set off.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    pub x: [f64; 2],
    pub name: String,
}

/// Layers over one another, with one vertical axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    pub y: Axis,
    /// Height of the panel, in units of a drawing that is 720 wide (340 if small).
    pub height: f64,
    pub layers: Vec<Layer>,
    /// Stretches that are set off.
    pub windows: Vec<Window>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    pub title: String,
    pub name: String,
    /// What stands below it; may be empty.
    pub caption: String,
    pub x: Axis,
    pub panels: Vec<Panel>,
    /// Plots of one link show the same part of the coordinate.
    pub link: Option<String>,
    /// Whether it is one of many that stand side by side.
    pub small: bool,
}

const LEFT: f64 = 70.0;
const RIGHT: f64 = 12.0;
/// Room above a panel for the name of its axis.
const ABOVE: f64 = 22.0;
/// Room below the last panel for the coordinate.
const BELOW: f64 = 38.0;

impl Plot {
    fn width(&self) -> f64 {
        if self.small { 340.0 } else { 720.0 }
    }

    pub(crate) fn legend(&self) -> Vec<(String, Sample)> {
        let mut entries: Vec<(String, Sample)> = Vec::new();
        let layers = self.panels.iter().flat_map(|p| &p.layers);
        let shown = layers.map(|l| (&l.name, Sample::Line(class(l.style))));
        let windows = self.panels.iter().flat_map(|p| &p.windows).map(|w| (&w.name, Sample::Window));
        for (name, sample) in shown.chain(windows) {
            if !name.is_empty() && !entries.iter().any(|(known, _)| known == name) {
                entries.push((name.clone(), sample));
            }
        }
        entries
    }

    pub(crate) fn draw(&self, target: Target) -> String {
        let (width, area) = (self.width(), self.width() - LEFT - RIGHT);
        let x_range = padded(range(self.panels.iter().flat_map(|p| &p.layers).flat_map(|l| &l.x)), 0.0);
        let mut axes = String::new();
        let mut areas = String::new();
        let mut top = 0.0;
        for (k, panel) in self.panels.iter().enumerate() {
            top += ABOVE;
            let y_range = padded(range(panel.layers.iter().flat_map(|l| &l.y)), 0.06);
            let last = k + 1 == self.panels.len();
            axes.push_str(&self.axes(panel, x_range, y_range, top, area, last));
            let place = |x: f64, y: f64| {
                let [x, y] = [(x, x_range), (y, y_range)].map(|(v, [low, high])| (v - low) / (high - low));
                [x * area, (1.0 - y) * panel.height]
            };
            let content = panel.content(&place, area);
            let height = panel.height;
            let _ = match target {
                Target::Page => writeln!(
                    areas,
                    "<svg class=\"area\" x=\"{LEFT}\" y=\"{top}\" width=\"{area}\" height=\"{height}\" \
                     viewBox=\"0 0 {area} {height}\" preserveAspectRatio=\"none\" data-x=\"{} {}\" data-y=\"{} {}\" \
                     data-label=\"{}\">{content}</svg>",
                    x_range[0],
                    x_range[1],
                    y_range[0],
                    y_range[1],
                    escape::text(&panel.y.title()),
                ),
                Target::File => writeln!(
                    areas,
                    "<clipPath id=\"area{k}\"><rect width=\"{area}\" height=\"{height}\"/></clipPath>\
                     <g transform=\"translate({LEFT} {top})\"><g clip-path=\"url(#area{k})\">{content}</g></g>"
                ),
            };
            top += panel.height;
        }
        let height = top + BELOW;
        match target {
            Target::File => {
                drawing::file(width, height, &self.title, &self.legend(), &format!("{axes}{areas}"))
            }
            Target::Page => format!(
                "<svg class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\" \
                 data-size=\"{width} {height}\" data-margin=\"{LEFT} {RIGHT}\" data-label=\"{}\"{}>\n\
                 <g class=\"axes\">{axes}</g>\n{areas}<g class=\"cursor\"></g></svg>",
                escape::text(&format!("{}: {}", self.title, self.x.title())),
                escape::text(&self.x.title()),
                self.link
                    .as_ref()
                    .map_or_else(String::new, |l| format!(" data-link=\"{}\"", escape::text(l))),
            ),
        }
    }

    /// Grid, numbers and names of one panel's axes.
    fn axes(
        &self,
        panel: &Panel,
        x_range: [f64; 2],
        y_range: [f64; 2],
        top: f64,
        area: f64,
        last: bool,
    ) -> String {
        let mut svg = String::new();
        let bottom = top + panel.height;
        let right = LEFT + area;
        for (value, label) in ticks(y_range, (panel.height / 22.0) as usize) {
            let y = bottom - (value - y_range[0]) / (y_range[1] - y_range[0]) * panel.height;
            let y = coordinate(y);
            let grid = if value == 0.0 { "zero" } else { "grid" };
            let _ = write!(svg, "<path class=\"{grid}\" d=\"M{LEFT} {y}H{right}\"/>");
            let y = y.parse().unwrap_or(bottom) + 4.0;
            svg.push_str(&text(LEFT - 6.0, y, "end", "tick", &label));
        }
        for (value, label) in ticks(x_range, (area / 56.0) as usize) {
            let x = coordinate(LEFT + (value - x_range[0]) / (x_range[1] - x_range[0]) * area);
            let _ = write!(svg, "<path class=\"grid\" d=\"M{x} {top}V{bottom}\"/>");
            if last {
                svg.push_str(&text(x.parse().unwrap_or(LEFT), bottom + 16.0, "middle", "tick", &label));
            }
        }
        svg.push_str(&text(4.0, top - 7.0, "start", "axis", &panel.y.title()));
        if last {
            svg.push_str(&text(right, bottom + 32.0, "end", "axis", &self.x.title()));
        }
        let height = panel.height;
        let _ = write!(
            svg,
            "<rect class=\"frame\" x=\"{LEFT}\" y=\"{top}\" width=\"{area}\" height=\"{height}\"/>"
        );
        svg
    }
}

impl Panel {
    /// Windows and layers, in coordinates of the panel's area.
    fn content(&self, place: &impl Fn(f64, f64) -> [f64; 2], area: f64) -> String {
        let mut svg = String::new();
        for window in &self.windows {
            let [from, to] = window.x.map(|x| place(x, 0.0)[0]);
            // A window that would be too thin to be seen is widened.
            let middle = 0.5 * (from + to);
            let half = (0.5 * (to - from)).max(area * 1e-3);
            let _ = write!(
                svg,
                "<rect class=\"window\" x=\"{}\" y=\"-9999\" width=\"{}\" height=\"20000\"><title>{}</title></rect>",
                coordinate(middle - half),
                coordinate(2.0 * half),
                escape::text(&window.name)
            );
        }
        for layer in &self.layers {
            let mark = match layer.mark {
                Mark::Line => "line",
                Mark::Points => "points",
                Mark::Means => "means",
            };
            let _ = write!(
                svg,
                "<path class=\"{mark} {}\" data-name=\"{}\" vector-effect=\"non-scaling-stroke\" d=\"{}\"/>",
                class(layer.style),
                escape::text(&layer.name),
                layer.path(place)
            );
        }
        svg
    }
}

impl Layer {
    fn path(&self, place: &impl Fn(f64, f64) -> [f64; 2]) -> String {
        let mut path = String::new();
        let mut joined = false;
        for (x, y) in self.x.iter().zip(&self.y) {
            if !x.is_finite() || !y.is_finite() {
                joined = false;
                continue;
            }
            let [x, y] = place(*x, *y).map(coordinate);
            // A line of no length with round ends is a dot whose size does not change when the plot is zoomed.
            let _ = match (self.mark, joined) {
                (Mark::Points, _) => write!(path, "M{x} {y}h0"),
                (_, false) => write!(path, "M{x} {y}"),
                (_, true) => write!(path, "L{x} {y}"),
            };
            joined = true;
        }
        path
    }
}
