use aurt_traits::{JointStack, LoadTorque, RobotModel};
use rayon::prelude::*;

use super::dynamics::Source;
use super::fit::FitRows;
use super::series::LoadSeries;
use crate::calibrate::{FittedTo, Setting, finished};
use crate::errors_in_positions::Shift;
use crate::rows::Observed;
use crate::system::estimate_coefficients;
use crate::{
    Calibration, CalibrationError, CalibrationOptions, Estimate, JointRange, LoadTorqueChoice,
    NamedRecording, System, TermScopes, estimate,
};

#[derive(Debug)]
pub(crate) struct Fitted {
    /// The load torque's weights.
    pub load: LoadTorque,
    /// τ_J of each piece.
    pub loads: Vec<LoadSeries>,
    /// The system that was solved.
    pub system: System,
    /// Its solution.
    pub estimate: Estimate,
}

/// The two passes of a linear fit.
pub(crate) fn fit(
    model: &RobotModel,
    rows: &FitRows<'_>,
    scopes: &TermScopes,
    options: &CalibrationOptions,
) -> Result<Fitted, CalibrationError> {
    rows.rigid().fits(model)?;
    let acting = rows.acting(model, scopes);
    let coefficients = model.parameters().len();
    let sources = Source::all(model);
    let others: Vec<Source<'_>> = sources.iter().filter(|s| !s.separable()).copied().collect();
    let stacks: Vec<(usize, &JointStack, usize)> = sources
        .iter()
        .filter(|s| s.separable())
        .filter_map(|source| match *source {
            Source::Stack { joint, stack, first_column } => Some((joint, stack, first_column)),
            Source::Term { .. } => None,
        })
        .collect();
    let system = |loads: &[LoadSeries]| -> Result<System, CalibrationError> {
        let mut columns = rows.columns(&others, &acting, loads)?;
        for stack in &stacks {
            columns.extend(rows.stack_columns(*stack, loads)?);
        }
        Ok(rows.system(coefficients, &columns))
    };
    let load = match options.load_torque {
        LoadTorqueChoice::Literal => LoadTorque::Literal,
        LoadTorqueChoice::Fitted => {
            let system = system(&rows.loads(model, &LoadTorque::Fitted(vec![0.0; coefficients]))?)?;
            if !sources.iter().any(Source::reads_load) {
                // A second fit would be this one.
                let estimate = estimate(&system, options.estimator)?;
                let load = LoadTorque::Fitted(estimate.solution.coefficients.clone());
                return Ok(Fitted { loads: rows.loads(model, &load)?, load, system, estimate });
            }
            LoadTorque::Fitted(estimate_coefficients(&system, options.estimator)?)
        }
    };
    let loads = rows.loads(model, &load)?;
    let system = system(&loads)?;
    let estimate = estimate(&system, options.estimator)?;
    Ok(Fitted { load, loads, system, estimate })
}

impl FitRows<'_> {
    /// τ_J of each piece.
    pub(crate) fn loads(
        &self,
        model: &RobotModel,
        load: &LoadTorque,
    ) -> Result<Vec<LoadSeries>, CalibrationError> {
        self.pieces()
            .par_iter()
            .map(|p| self.rigid().load_series(model, self.rigid().segment(p.recording, p.segment), load))
            .collect()
    }

    /// What a fit found out; `shift` is what noise of the positions does to it, where shapes were searched.
    pub(crate) fn calibration(
        &self,
        setting: &Setting<'_>,
        fitted: &Fitted,
        scopes: &TermScopes,
        shift: Option<&Shift>,
    ) -> Result<Calibration, CalibrationError> {
        let ranges = self.ranges(&fitted.load, &fitted.loads);
        let recordings: Vec<&NamedRecording> = self.recordings().collect();
        let Setting { model, options, .. } = *setting;
        let rows = Observed { model, recordings: &recordings, scopes, load: &fitted.load, options };
        let fitted_to = FittedTo {
            rows: Some(rows),
            bandwidth: self.bandwidth(),
            ranges,
            names: recordings.iter().map(|r| r.name.clone()).collect(),
            shift,
        };
        finished(setting, &fitted.system, fitted.estimate.clone(), &fitted.load, fitted_to)
    }

    fn ranges(&self, load: &LoadTorque, loads: &[LoadSeries]) -> Vec<JointRange> {
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        (0..self.rigid().joints())
            .map(|joint| {
                let speeds = self.pieces().iter().map(|p| {
                    let segment = self.rigid().segment(p.recording, p.segment);
                    largest(segment.motion.view().velocity_rad_s(joint))
                });
                let torque = loads.iter().map(|l| largest(l.joint(joint))).fold(0.0, f64::max);
                JointRange {
                    velocity_rad_s: speeds.fold(0.0, f64::max),
                    load_torque: matches!(load, LoadTorque::Fitted(_)).then_some(torque),
                }
            })
            .collect()
    }
}
