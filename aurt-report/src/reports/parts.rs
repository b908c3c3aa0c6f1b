//! Tables and lists that several reports have.

use aurt_calibration::{CalibratedParameter, Calibration, Estimator, LoadTorqueChoice};
use aurt_plugins::model::BASE_PARAMETER_SEED;
use aurt_traits::{RobotModel, RobotNames};

use crate::page::{Block, Section};
use crate::rendering::number::significant;
use crate::results::metrics::rest_velocity;
use crate::table::{Cell, Table};

/// The parameters with their intervals; those that nothing excites are set apart.
pub fn parameters(title: String, parameters: &[CalibratedParameter]) -> Block {
    let mut table = Table::new(
        "95 % confidence intervals, as in calibrated_parameters.csv",
        ["<parameter", "<unit", "value", "from", "to", "± % (1 σ)"],
    );
    let mut unexcited = Vec::new();
    let is_weak = |p: &CalibratedParameter| p.relative_std_dev_percent.is_some_and(|r| r > 50.0);
    for p in parameters {
        if !p.excited {
            unexcited.push(p.name.as_str());
            continue;
        }
        let [low, high] = p.interval_95.map_or([f64::NAN; 2], |i| i);
        table.row([
            Cell::from(p.name.as_str()),
            Cell::from(p.unit.as_str()),
            Cell::from(significant(p.value, 4)),
            Cell::from(significant(low, 4)),
            Cell::from(significant(high, 4)),
            Cell {
                text: p.relative_std_dev_percent.map_or_else(|| "–".into(), |r| significant(r, 2)),
                strong: is_weak(p),
            },
        ]);
    }
    let mut blocks = vec![Block::Table(table)];
    if parameters.iter().any(is_weak) {
        blocks.push(Block::Text(
            "Bold: the standard deviation exceeds half the value; these motions hardly excite the parameter."
                .into(),
        ));
    }
    if !unexcited.is_empty() {
        blocks.push(Block::Text(format!("Not excited, set to zero: {}.", unexcited.join(", "))));
    }
    Block::Folded { title, open: false, blocks }
}

pub fn experiment(title: &str, text: &str) -> Section {
    let blocks = vec![Block::Code(text.to_owned())];
    Section::new("Experiment", "", vec![Block::Folded { title: title.into(), open: false, blocks }])
}

/// The title of a column of joints: names stand left, numbers right.
pub const fn joint_column(names: RobotNames<'_>) -> &'static str {
    if names.joints.is_empty() { "joint" } else { "<joint" }
}

pub fn calibration_provenance(model: &RobotModel, calibration: &Calibration) -> Vec<(String, String)> {
    let options = &calibration.options;
    let unit = calibration.unit.symbol();
    let sigma: Vec<String> = calibration.sigma.iter().map(|s| significant(*s, 3)).collect();
    let names = model.names();
    let joints = (0..model.joints()).map(|j| {
        let stack = &model.stacks()[j];
        format!(
            "{}: {} × {} + {}",
            names.joint_cell(j),
            stack.coulomb().name(),
            stack.hysteresis().name(),
            stack.viscous().name()
        )
    });
    let mut terms: Vec<&str> = model.arm_terms().iter().map(|t| t.name()).collect();
    terms.dedup();
    vec![
        entry(
            "Model",
            format!(
                "{} joints, {} base parameters, {} coefficients in all; unit {unit}",
                model.joints(),
                model.base().len(),
                model.parameters().len()
            ),
        ),
        entry("Friction, joint by joint", joints.collect::<Vec<_>>().join("; ")),
        entry("Arm terms", if terms.is_empty() { "none".into() } else { terms.join(", ") }),
        entry(
            "Estimator",
            match options.estimator {
                Estimator::Wls => "weighted least squares, weights 1/σ² of each joint".into(),
                Estimator::Ols => "ordinary least squares".to_owned(),
                Estimator::Consistent => {
                    "weighted least squares, then the nearest physically consistent parameters".into()
                }
                Estimator::Essential => {
                    "weighted least squares of the fewest parameters that predict as well as all".into()
                }
                Estimator::Irls => "weighted least squares with weights by row, Huber's, then Tukey's".into(),
            },
        ),
        entry(
            "Load torque τ_J",
            match options.load_torque {
                LoadTorqueChoice::Fitted => "from the fitted rigid bodies".to_owned(),
                LoadTorqueChoice::Literal => "the sum of the base regressor's row".into(),
            },
        ),
        entry("Rest", format!("|q̇| at or below {}", rest_velocity(model, options))),
        entry("f_dyn", format!("{} Hz", calibration.f_dyn_hz)),
        entry("σ of each joint", format!("{} {unit}", sigma.join(", "))),
        entry("Condition number", significant(calibration.condition_number, 3)),
    ]
}

pub fn program(command: &str) -> Vec<(String, String)> {
    vec![
        entry("Program", format!("aurt {}, command {command}", env!("CARGO_PKG_VERSION"))),
        entry("Seed of the base parameters' observation", BASE_PARAMETER_SEED.to_string()),
    ]
}

/// A line of how something was computed.
pub fn entry(name: impl Into<String>, value: impl Into<String>) -> (String, String) {
    (name.into(), value.into())
}
