//! How a sweep reads recordings and fits: as `aurt run` does.

use crate::Experiment;
use aurt::Role;
use aurt::data::{Loaded, Purpose, Source};
use aurt::duplicates::SampleRegister;
use aurt::fitting::judged_rows;
use aurt_calibration::{CalibrationOptions, Deviations, NamedRecording, ShapeOptions, ValidatedRows};
use aurt_traits::MeasurementUnit;

use crate::sweep::definition::Validate;

/// The recordings of an experiment, preprocessed.
#[derive(Debug, Clone)]
pub struct Data {
    pub calibration: Vec<NamedRecording>,
    /// To be judged on: the validation recordings, or with `leave_one_out` the calibration recordings in their order,
    /// preprocessed as validation recordings are.
    pub judged: Vec<NamedRecording>,
    pub unit: MeasurementUnit,
    pub warnings: Vec<String>,
}

/// How a point is fitted and judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    pub calibration: CalibrationOptions,
    pub shapes: ShapeOptions,
    /// The rows of a held-out recording that count.
    pub rows: ValidatedRows,
}

impl Settings {
    pub fn of(experiment: &Experiment) -> Self {
        Self {
            // Points are ranked by their errors; deviations that look at the rows again would cost more than a variant.
            calibration: CalibrationOptions { deviations: Deviations::White, ..experiment.calibration },
            shapes: ShapeOptions::default(),
            rows: judged_rows(Role::Validation, experiment.preprocess.trim_rest),
        }
    }
}

impl Data {
    pub fn read(experiment: &Experiment, validate: Validate) -> Result<Self, aurt::Error> {
        let pipeline = experiment.pipeline();
        let each = |sources: &[Source], purpose| -> Result<Vec<Loaded>, aurt::Error> {
            sources.iter().map(|source| pipeline.read(source.clone(), purpose)).collect()
        };
        let prepare = |recordings: &[Loaded], purpose| -> Result<Vec<_>, aurt::Error> {
            recordings.iter().map(|loaded| pipeline.preprocess(loaded, purpose)).collect()
        };
        let calibration = each(&experiment.recordings.calibration, Purpose::Calibration)?;
        let held_out = match validate {
            Validate::HeldOut => each(&experiment.recordings.validation, Purpose::Validation)?,
            Validate::LeaveOneOut => Vec::new(),
        };
        let role = |role: Role| move |loaded| (loaded, role.name());
        let roles = calibration.iter().map(role(Role::Calibration));
        SampleRegister::check(roles.chain(held_out.iter().map(role(Role::Validation))))?;
        let judged = match validate {
            Validate::HeldOut => &held_out,
            Validate::LeaveOneOut => &calibration,
        };
        let read = || calibration.iter().chain(&held_out);
        Ok(Self {
            unit: pipeline.common_unit(read())?.unwrap_or_default(),
            judged: prepare(judged, Purpose::Validation)?,
            calibration: prepare(&calibration, Purpose::Calibration)?,
            warnings: read().flat_map(Loaded::warnings).collect(),
        })
    }
}
