//! Bars in groups, each group on a scale of its own, with the noise floor marked.

use std::fmt::Write;

use super::drawing::{self, Sample, class, text};
use super::scale::coordinate;
use super::{Style, Target};
use crate::escape;

/// Bars that are compared with each other.
#[derive(Debug, Clone, PartialEq)]
pub struct BarGroup {
    pub label: String,
    /// The values, in the order of [`Bars::series`]; absent ones are not drawn.
    pub values: Vec<Option<f64>>,
    /// A level to be marked, such as what noise alone leaves.
    pub level: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Bars {
    pub title: String,
    /// Stem of the file name.
    pub name: String,
    /// What stands below; may be empty.
    pub caption: String,
    pub unit: String,
    pub series: Vec<(String, Style)>,
    /// What the marked level is; empty if there is none.
    pub level_name: String,
    /// Whether all groups share one scale; else the largest bar of each fills the width.
    pub one_scale: bool,
    pub groups: Vec<BarGroup>,
}

const WIDTH: f64 = 360.0;
/// Width of a group that is a drawing of its own.
const GROUP_WIDTH: f64 = 280.0;
const BAR: f64 = 15.0;
const SPACE: f64 = 12.0;
/// Room for the numbers behind the bars.
const NUMBERS: f64 = 86.0;
/// Room above a group for its label.
const LABEL: f64 = 17.0;

impl Bars {
    pub(crate) fn legend(&self) -> Vec<(String, Sample)> {
        let mut entries: Vec<(String, Sample)> =
            self.series.iter().map(|(name, style)| (name.clone(), Sample::Bar(class(*style)))).collect();
        if self.groups.iter().any(|g| g.level.is_some()) {
            entries.push((self.level_name.clone(), Sample::Mark));
        }
        entries
    }

    fn largest(groups: &[BarGroup]) -> f64 {
        let values = groups.iter().flat_map(|g| g.values.iter().flatten().chain(&g.level));
        values.copied().filter(|v| v.is_finite()).fold(0.0, f64::max)
    }

    /// The figure: a file in one piece; on a page, groups on scales of their own as drawings of their own, which stand side
    /// by side as far as there is room.
    pub(crate) fn draw(&self, target: Target) -> String {
        let length = WIDTH - NUMBERS - 4.0;
        let mut svg = String::new();
        let mut top = 0.0;
        match target {
            Target::Page if self.is_divided() => {
                let groups = self.groups.iter().map(|group| {
                    let mut svg = String::new();
                    let height = self.group(group, 0.0, GROUP_WIDTH - NUMBERS - 4.0, &mut svg);
                    format!(
                        "<svg viewBox=\"0 0 {GROUP_WIDTH} {height}\" role=\"img\" aria-label=\"{}\">{svg}</svg>",
                        escape::text(&format!("{}, {}", self.title, group.label))
                    )
                });
                format!("<div class=\"groups\">{}</div>", groups.collect::<String>())
            }
            _ => {
                for group in &self.groups {
                    top = self.group(group, top, length, &mut svg);
                }
                match target {
                    Target::File => drawing::file(WIDTH, top, &self.title, &self.legend(), &svg),
                    Target::Page => format!(
                        "<svg viewBox=\"0 0 {WIDTH} {top}\" role=\"img\" aria-label=\"{}\">{svg}</svg>",
                        escape::text(&self.title)
                    ),
                }
            }
        }
    }

    /// Whether groups are drawings of their own on a page.
    pub(crate) fn is_divided(&self) -> bool {
        !self.one_scale && self.groups.len() > 1
    }

    /// Draws a group below `top`, its largest bar of that length; the end of the group.
    fn group(&self, group: &BarGroup, top: f64, length: f64, svg: &mut String) -> f64 {
        let of: &[BarGroup] = if self.one_scale { &self.groups } else { std::slice::from_ref(group) };
        let largest = Self::largest(of).max(1e-300);
        svg.push_str(&text(4.0, top + 12.0, "start", "axis", &group.label));
        let first = top + LABEL;
        let mut top = first;
        let mark = group.level.filter(|l| l.is_finite()).map(|l| 4.0 + length * l / largest);
        for ((name, style), value) in self.series.iter().zip(&group.values) {
            if let Some(value) = value.filter(|v| v.is_finite()) {
                let width = (length * value.max(0.0) / largest).max(0.5);
                let number = format!("{} {}", significant(value), self.unit);
                let _ = write!(
                    svg,
                    "<rect class=\"bar {}\" x=\"4\" y=\"{top}\" width=\"{}\" height=\"{}\">\
                     <title>{}</title></rect>",
                    class(*style),
                    coordinate(width),
                    BAR - 2.0,
                    escape::text(&format!("{}, {name}: {number}", group.label)),
                );
                let mut behind = 8.0 + width;
                // A number stands behind the mark that would go through it.
                let end = behind + 7.0 * number.chars().count() as f64;
                if let Some(mark) = mark.filter(|m| (behind - 3.0..end).contains(m)) {
                    behind = mark + 5.0;
                }
                svg.push_str(&text(behind, top + BAR - 4.5, "start", "tick", number.trim_end()));
            }
            top += BAR;
        }
        if let Some(x) = mark.map(coordinate) {
            let _ = write!(svg, "<path class=\"mark\" d=\"M{x} {}V{}\"/>", first - 2.0, top);
        }
        top + SPACE
    }
}

/// Three significant digits.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if value.fract() == 0.0 && value.abs() < 1000.0 {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&magnitude) {
        return format!("{value:.2e}");
    }
    let decimals = (2.0 - magnitude).max(0.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_on_scales_of_their_own_stand_side_by_side_on_a_page_and_in_one_piece_in_a_file() {
        let group = |label: &str, value| BarGroup {
            label: label.into(),
            values: vec![Some(value), None],
            level: Some(0.5 * value),
        };
        let mut bars = Bars {
            title: "error".into(),
            name: "errors".into(),
            caption: String::new(),
            unit: "Nm".into(),
            series: vec![("before".into(), Style::Before), ("after".into(), Style::After)],
            level_name: "noise".into(),
            one_scale: false,
            groups: vec![group("elbow <a>", 2.0), group("wrist", 0.01)],
        };
        let page = bars.draw(Target::Page);
        assert!(page.starts_with("<div class=\"groups\">"), "{page}");
        assert_eq!(
            (page.matches("<svg").count(), page.matches("<rect class=\"bar before\"").count()),
            (2, 2)
        );
        let widths: Vec<&str> = page.split(" width=\"").skip(1).filter_map(|w| w.split('"').next()).collect();
        assert_eq!(widths[0], widths[1], "each group has a scale of its own: {page}");
        assert!(page.contains("aria-label=\"error, elbow &lt;a&gt;\""), "{page}");
        assert_eq!(bars.draw(Target::File).matches("<svg xmlns").count(), 1);
        bars.one_scale = true;
        assert_eq!(bars.draw(Target::Page).matches("<svg").count(), 1);
    }
}
