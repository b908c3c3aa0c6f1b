//! What all figures have in common: styles, text, the frame of a file.

use super::style::Style;
use crate::escape;

/// Colours of Okabe and Ito (2008), which people with any usual colour vision tell apart, on white; before and after
/// differ in their dashes as well.
pub const FILE_STYLE: &str = "text{font:12px system-ui,'DejaVu Sans',Helvetica,Arial,sans-serif;fill:#222}\
    .title{font-weight:600;font-size:14px}\
    .grid{stroke:#d8d8d8;stroke-width:1}.zero{stroke:#777;stroke-width:1}.frame{fill:none;stroke:#777}\
    .line{fill:none;stroke-width:1.4;stroke-linejoin:round}\
    .points{fill:none;stroke-width:3;stroke-linecap:round;stroke-opacity:.45}\
    .means{fill:none;stroke-width:2.4;stroke-linejoin:round}\
    .measured{stroke:#333}.predicted,.after{stroke:#0072b2}.before{stroke:#d55e00}.floor{stroke:#009e73}\
    .line.before,.means.before{stroke-dasharray:5 3}.line.floor{stroke-dasharray:2 3}\
    .window{fill:#cc79a7;fill-opacity:.28}\
    .bar{stroke:none}.bar.before{fill:#d55e00;fill-opacity:.55}.bar.after,.bar.predicted{fill:#0072b2}\
    .bar.measured{fill:#777}.bar.floor{fill:#009e73}.mark{stroke:#009e73;stroke-width:2.5}\
    .link{fill:none;stroke:#555;stroke-width:4;stroke-linejoin:round;stroke-linecap:round}\
    .ground{stroke:#777;stroke-width:3}.joint circle{stroke:#222;stroke-width:1.2}\
    .joint .number{font-weight:600;fill:#111}.level0 circle{fill:#7fd0b5}.level1 circle{fill:#f0e442}\
    .level2 circle{fill:#e69f00}.level3 circle{fill:#f0622d}.levelless circle{fill:#ddd}";

pub const fn class(style: Style) -> &'static str {
    match style {
        Style::Measured => "measured",
        Style::Predicted => "predicted",
        Style::Before => "before",
        Style::After => "after",
        Style::Floor => "floor",
    }
}

/// What a legend shows of something, 26 × 12.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sample {
    Line(&'static str),
    Bar(&'static str),
    /// The mark of the noise floor across a bar.
    Mark,
    Window,
    Level(&'static str),
}

pub fn sample(sample: Sample) -> String {
    match sample {
        Sample::Line(class) => format!("<path class=\"line {class}\" d=\"M1 6L25 6\"/>"),
        Sample::Bar(class) => {
            format!("<rect class=\"bar {class}\" x=\"2\" y=\"1\" width=\"22\" height=\"10\"/>")
        }
        Sample::Mark => "<path class=\"mark\" d=\"M13 0V12\"/>".into(),
        Sample::Level(class) => {
            format!("<g class=\"joint {class}\"><circle cx=\"13\" cy=\"6\" r=\"5.5\"/></g>")
        }
        Sample::Window => "<rect class=\"window\" x=\"2\" y=\"0\" width=\"22\" height=\"12\"/>".into(),
    }
}

/// A text element; `anchor` is start, middle or end.
pub fn text(x: f64, y: f64, anchor: &str, class: &str, words: &str) -> String {
    format!(
        "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" class=\"{class}\">{}</text>",
        escape::text(words)
    )
}

/// Height of title and legend in a file.
pub const HEAD: f64 = 46.0;

/// A file of its own around a drawing of that size: style, background, title, legend.
pub fn file(width: f64, height: f64, title: &str, legend: &[(String, Sample)], drawing: &str) -> String {
    let total = height + HEAD;
    let mut entries = String::new();
    let mut x = 8.0;
    for (name, shown) in legend {
        entries.push_str(&format!("<g transform=\"translate({x} 26)\">{}</g>", sample(*shown)));
        entries.push_str(&text(x + 31.0, 36.0, "start", "key", name));
        // Wide enough for any usual font.
        x += 50.0 + 6.6 * name.chars().count() as f64;
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{total}\" viewBox=\"0 0 {width} {total}\">\n\
         <style>{FILE_STYLE}</style><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}{entries}\n\
         <g transform=\"translate(0 {HEAD})\">\n{drawing}</g>\n</svg>\n",
        text(8.0, 17.0, "start", "title", title)
    )
}
