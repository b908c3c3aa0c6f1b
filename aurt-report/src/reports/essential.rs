//! The elimination of parameters, as a section.

use aurt_calibration::EssentialReport;

use crate::figure::{Axis, Figure, Layer, Mark, Panel, Plot, Style};
use crate::page::{Block, Section};
use crate::results::essential::table;

/// The picture of the loss and the table of the order.
pub fn section(report: &EssentialReport) -> Section {
    Section::new(
        "Essential parameters",
        format!(
            "{} of {} parameters predict as well as all: {} blocks of time, each predicted by a fit to the others. Parameters \
             leave one by one, each time the one that explains least; the last set is kept whose error has not grown \
             significantly (5 %, one-sided).",
            report.kept, report.parameters, report.blocks
        ),
        vec![Block::Figure(picture(report)), Block::Table(table(report))],
    )
}

fn picture(report: &EssentialReport) -> Figure {
    let left = |eliminated: usize| report.parameters.saturating_sub(eliminated) as f64;
    let x: Vec<f64> = (0..=report.steps.len()).map(left).collect();
    let errors = report.steps.iter().map(|s| s.held_out_error);
    let y: Vec<f64> = std::iter::once(report.held_out_error).chain(errors).collect();
    let kept = report.kept as f64;
    let at_kept = x.iter().position(|p| *p == kept).map_or(f64::NAN, |k| y[k]);
    Figure::Plot(Plot {
        title: "Held-out error over the number of parameters".into(),
        name: "essential_parameters".into(),
        caption: "Mean squared error of the blocks, in variances of each joint's residual. Point: the set that is kept."
            .into(),
        x: Axis::new("parameters", ""),
        panels: vec![Panel {
            y: Axis::new("held-out error", "σ²"),
            height: 180.0,
            layers: vec![
                Layer { name: "held-out error".into(), style: Style::Predicted, mark: Mark::Line, x, y },
                Layer {
                    name: "kept".into(),
                    style: Style::Measured,
                    mark: Mark::Points,
                    x: vec![kept],
                    y: vec![at_kept],
                },
            ],
            windows: Vec::new(),
        }],
        link: None,
        small: false,
    })
}
