//! The elimination of parameters, as a table.

use aurt_calibration::{EssentialReport, EssentialStep};

use crate::rendering::number::significant;
use crate::table::{Cell, Table};

/// Eliminations that are shown after the last one that was made.
const SHOWN_BEYOND: usize = 3;

/// The order of elimination with the loss at each step.
pub fn to_text(report: &EssentialReport) -> String {
    format!(
        "essential: {} of {} parameters; {} blocks of time, each predicted by a fit to the others; held-out error with all \
         parameters {} σ²\n{}",
        report.kept,
        report.parameters,
        report.blocks,
        significant(report.held_out_error, 5),
        table(report).to_text()
    )
}

pub fn table(report: &EssentialReport) -> Table {
    let mut table = Table::new(
        "Order of elimination. Bold: kept.",
        ["<without", "χ² lost", "held-out error, σ²", "growth", "±", "<"],
    );
    for step in shown(report) {
        table.row([
            Cell { text: step.parameter.clone(), strong: !step.eliminated },
            Cell::from(significant(step.chi_squared, 3)),
            Cell::from(significant(step.held_out_error, 5)),
            Cell::from(significant(step.growth, 2)),
            Cell::from(significant(step.growth_std, 2)),
            Cell::from(status(step)),
        ]);
    }
    table
}

fn shown(report: &EssentialReport) -> impl Iterator<Item = &EssentialStep> {
    let made = report.steps.iter().filter(|s| s.eliminated).count();
    report.steps.iter().take(made + SHOWN_BEYOND)
}

const fn status(step: &EssentialStep) -> &'static str {
    match (step.eliminated, step.significant) {
        (true, _) => "eliminated",
        (false, true) => "kept: significant",
        (false, false) => "kept",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_ends_soon_after_the_last_elimination() {
        let step = |k: usize| EssentialStep {
            parameter: format!("p_{k}"),
            chi_squared: k as f64,
            held_out_error: 1.0 + 0.01 * k as f64,
            growth: 0.01,
            growth_std: 0.002,
            significant: k == 2,
            eliminated: k < 2,
        };
        let report = EssentialReport {
            blocks: 12,
            parameters: 20,
            kept: 18,
            held_out_error: 1.0,
            steps: (0..10).map(step).collect(),
        };
        let text = to_text(&report);
        assert!(text.contains("18 of 20") && text.contains("p_4") && !text.contains("p_5"), "{text}");
        assert_eq!(text.matches("eliminated").count(), 2);
        assert_eq!(text.matches("kept: significant").count(), 1);
    }
}
