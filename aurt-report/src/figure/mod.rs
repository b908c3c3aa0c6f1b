//! Figures: what they show, and the one drawing of it that page and file share.

mod arm;
mod bars;
mod drawing;
mod plot;
mod reduce;
mod scale;
mod style;

pub use arm::{Arm, NOISE_LIMIT, Shade};
pub use bars::{BarGroup, Bars};
pub use plot::{Axis, Layer, Panel, Plot, Window};
pub use reduce::{decimated, quantile_means, subsample};
pub use style::{Mark, Style};

use crate::escape;

#[derive(Debug, Clone, PartialEq)]
pub enum Figure {
    /// Series or clouds of points over a coordinate.
    Plot(Plot),
    Bars(Bars),
    Arm(Arm),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Target {
    /// Into a page, whose style and script see it.
    Page,
    /// Into a file of its own, which brings its style, title and legend.
    File,
}

impl Figure {
    /// The stem of its file name: letters, digits, `_` and `-` alone.
    pub fn name(&self) -> String {
        let name = match self {
            Self::Plot(plot) => &plot.name,
            Self::Bars(bars) => &bars.name,
            Self::Arm(arm) => &arm.name,
        };
        let plain = |c: char| if c.is_ascii_alphanumeric() || c == '_' || c == '-' { c } else { '_' };
        name.chars().map(plain).collect()
    }

    /// The figure as a file of its own, for papers: dark on white, with title and legend.
    pub fn to_svg(&self) -> String {
        match self {
            Self::Plot(plot) => plot.draw(Target::File),
            Self::Bars(bars) => bars.draw(Target::File),
            Self::Arm(arm) => arm.draw(Target::File),
        }
    }

    /// Whether it wants half of a wide page.
    pub(crate) const fn is_wide(&self) -> bool {
        matches!(self, Self::Bars(_) | Self::Arm(_))
    }

    pub(crate) fn to_html(&self) -> String {
        let (svg, title, caption, legend) = match self {
            Self::Plot(plot) => (plot.draw(Target::Page), &plot.title, &plot.caption, plot.legend()),
            Self::Bars(bars) => (bars.draw(Target::Page), &bars.title, &bars.caption, bars.legend()),
            Self::Arm(arm) => (arm.draw(Target::Page), &arm.title, &arm.caption, arm.legend()),
        };
        let mut entries = String::new();
        for (name, class) in legend {
            entries.push_str(&format!(
                "<span class=\"key\"><svg width=\"26\" height=\"12\" aria-hidden=\"true\">{}</svg>{}</span>",
                drawing::sample(class),
                escape::text(&name)
            ));
        }
        let kind = match self {
            Self::Plot(plot) if plot.small => "small",
            Self::Plot(_) => "large",
            Self::Bars(bars) if bars.is_divided() => "bars divided",
            Self::Bars(_) => "bars",
            Self::Arm(_) => "arm",
        };
        let caption = if caption.is_empty() {
            String::new()
        } else {
            format!("<p class=\"caption\">{}</p>", escape::text(caption))
        };
        format!(
            "<figure class=\"{kind}\"><figcaption><span class=\"title\">{}</span>{entries}</figcaption>\n{svg}\n\
             <div class=\"readout\" aria-live=\"off\"></div>{caption}</figure>\n",
            escape::text(title)
        )
    }
}
