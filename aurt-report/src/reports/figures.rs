//! Figures that several reports have: series over time, residuals over coordinates.

use aurt_traits::MeasurementUnit;

use crate::figure::{
    Axis, Figure, Layer, Mark, Panel, Plot, Style, Window, decimated, quantile_means, subsample,
};
use crate::page::Block;

pub struct Series<'a> {
    pub name: &'a str,
    pub style: Style,
    pub values: &'a [f64],
}

/// Series over time in panels.
pub struct TimeFigure<'a> {
    pub title: String,
    /// Stem of the file name.
    pub name: String,
    pub time_s: &'a [f64],
    /// First samples of the stretches without gaps.
    pub segment_starts: &'a [usize],
    /// What is shown, panel by panel: the name of the values, their unit, the series.
    pub panels: Vec<(Axis, Vec<Series<'a>>)>,
    /// Windows that are set off in all panels.
    pub windows: &'a [([f64; 2], &'a str)],
    /// Figures that show the same part of time.
    pub link: String,
}

pub const HOW_TO_LOOK: &str = "Drag over a stretch to look closer, drag with Shift to move, double-click for all; + − ← → 0 do the \
                               same once a plot has the focus.";

/// Bytes that the series of one report may take, roughly.
const BUDGET: usize = 2_500_000;
/// Bytes of a point in a drawing.
const POINT: usize = 13;

/// How many points each series of a report may keep, if it has that many series in all.
pub fn points_per_series(series: usize) -> usize {
    (BUDGET / POINT / series.max(1)).clamp(200, 4000)
}

impl TimeFigure<'_> {
    /// The figure, with at most about that many points a series.
    pub fn figure(&self, points: usize) -> Figure {
        let all: Vec<&[f64]> = self.panels.iter().flat_map(|p| &p.1).map(|s| s.values).collect();
        let kept = decimated(&all, points / (2 + 2 * all.len()).max(1));
        // A line must not run across a gap: one value that is none stands before each stretch.
        let is_start = |k: usize| k > 0 && self.segment_starts.contains(&k);
        let breaks: Vec<bool> =
            kept.iter().enumerate().map(|(i, k)| i > 0 && (kept[i - 1] + 1..=*k).any(is_start)).collect();
        let with_breaks = |values: &[f64], in_gap: Option<f64>| -> Vec<f64> {
            let mut out = Vec::with_capacity(kept.len());
            for (k, fresh) in kept.iter().zip(&breaks) {
                if *fresh {
                    out.push(in_gap.unwrap_or(values[*k]));
                }
                out.push(values[*k]);
            }
            out
        };
        let time = with_breaks(self.time_s, None);
        let count = self.panels.len();
        let panels = self
            .panels
            .iter()
            .enumerate()
            .map(|(p, (y, series))| Panel {
                y: y.clone(),
                height: if p == 0 && count > 1 { 150.0 } else { 95.0 },
                layers: series
                    .iter()
                    .map(|s| Layer {
                        name: s.name.to_owned(),
                        style: s.style,
                        mark: Mark::Line,
                        x: time.clone(),
                        y: with_breaks(s.values, Some(f64::NAN)),
                    })
                    .collect(),
                windows: self
                    .windows
                    .iter()
                    .map(|(x, name)| Window { x: *x, name: (*name).to_owned() })
                    .collect(),
            })
            .collect();
        Figure::Plot(Plot {
            title: self.title.clone(),
            name: self.name.clone(),
            caption: String::new(),
            x: Axis::new("time since the first stamp", "s"),
            panels,
            link: Some(self.link.clone()),
            small: false,
        })
    }
}

/// Points of a cloud that are drawn.
const CLOUD: usize = 500;
/// Classes of equal count whose means are drawn.
const CLASSES: usize = 16;

/// The axis of something measured on a joint, which turns or slides.
pub fn measured_axis(quantity: Option<&str>, measured: MeasurementUnit, slides: bool) -> Axis {
    let is_force = slides && measured == MeasurementUnit::NewtonMetre;
    let own = if is_force { "force" } else { measured.quantity() };
    Axis::new(quantity.unwrap_or(own), measured.express_of_joint("Nm", slides))
}

/// Residuals of a joint over its velocity, position, load torque, acceleration and time, `x` in this order, folded under the joint's
/// name.
pub fn residuals_over(
    (joint, name): (usize, String),
    open: bool,
    x: [Vec<f64>; 5],
    (measured, slides): (MeasurementUnit, bool),
    residuals: &[Series<'_>],
) -> Block {
    let of_joint = |unit: &str| MeasurementUnit::NewtonMetre.express_of_joint(unit, slides);
    let unit = measured.express_of_joint("Nm", slides);
    let coordinates = [
        ("velocity", of_joint("rad/s")),
        ("position", of_joint("rad")),
        ("load torque", unit.clone()),
        ("acceleration", of_joint("rad/s²")),
        ("time", "s".to_owned()),
    ];
    let figures = coordinates.into_iter().zip(&x).map(|((coordinate, x_unit), x)| {
        Figure::Plot(Plot {
            title: format!("{name} over {coordinate}"),
            name: format!("residual_joint_{joint}_over_{}", coordinate.replace(' ', "_")),
            caption: String::new(),
            x: Axis::new(coordinate, x_unit),
            panels: vec![residual_panel(x, &unit, residuals)],
            link: None,
            small: true,
        })
    });
    let blocks = vec![Block::Figures(figures.collect())];
    Block::Folded { title: name, open, blocks }
}

/// One or two residuals over a coordinate, with means over classes of it.
fn residual_panel(x: &[f64], unit: &str, residuals: &[Series<'_>]) -> Panel {
    let mut layers = Vec::new();
    for residual in residuals {
        let finite: Vec<usize> =
            (0..x.len()).filter(|k| x[*k].is_finite() && residual.values[*k].is_finite()).collect();
        let pick = |of: &[f64], most: usize| -> Vec<f64> {
            subsample(finite.len(), most).into_iter().map(|k| of[finite[k]]).collect()
        };
        let layer = |mark, x, y, named: bool| Layer {
            name: if named { residual.name.to_owned() } else { String::new() },
            style: residual.style,
            mark,
            x,
            y,
        };
        layers.push(layer(Mark::Points, pick(x, CLOUD), pick(residual.values, CLOUD), false));
        let (mean_x, mean_y) = quantile_means(x, residual.values, CLASSES);
        layers.push(layer(Mark::Means, mean_x, mean_y, true));
    }
    // Means lie above all clouds.
    layers.sort_by_key(|l| l.mark == Mark::Means);
    Panel { y: Axis::new("residual", unit), height: 130.0, layers, windows: Vec::new() }
}

/// The last part of a recording's name, for headings; the whole stands where it was computed from.
pub fn file_name(recording: &str) -> &str {
    recording.rsplit(['/', '\\']).next().unwrap_or(recording)
}

/// The stem of a recording's name, for titles and file names.
pub fn stem(recording: &str) -> &str {
    let file = file_name(recording);
    file.rsplit_once('.').map_or(file, |(stem, _)| stem)
}
