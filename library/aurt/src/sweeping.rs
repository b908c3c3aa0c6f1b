//! How a sweep reads recordings and fits: as `aurt run` does.

use aurt_calibration::{CalibrationOptions, Deviations, ShapeOptions};
use aurt_experiment::{Experiment, experiment::RecordingSource};
use aurt_sweep::{Data, Loader, PointError, Settings, Validate};

use crate::{
    data::{Instrument, Loaded, Pipeline, Purpose, Source},
    failure::Failure,
    fitting::{calibration_options, judged_rows},
    results::metrics::Role,
};

/// Reads what experiments name.
#[derive(Debug, Clone, Copy)]
pub struct ExperimentLoader;

impl Loader for ExperimentLoader {
    fn load(&self, experiment: &Experiment, validate: Validate) -> Result<Data, PointError> {
        load(experiment, validate).map_err(|failure| PointError::Recordings(failure.to_string()))
    }

    fn settings(&self, experiment: &Experiment) -> Settings {
        Settings {
            // Points are ranked by their errors; deviations that look at the rows again would cost more than a variant.
            calibration: CalibrationOptions {
                deviations: Deviations::White,
                ..calibration_options(experiment)
            },
            shapes: ShapeOptions::default(),
            rows: judged_rows(Role::Validation, experiment.preprocess.trim_rest),
        }
    }
}

fn load(experiment: &Experiment, validate: Validate) -> Result<Data, Failure> {
    let (preprocessing, instrument) = (experiment.preprocess.clone(), Instrument::of(experiment));
    let pipeline = Pipeline {
        joints: experiment.robot.robot_joints(),
        preprocessing: &preprocessing,
        instrument: &instrument,
    };
    let read = |sources: &[RecordingSource], purpose| -> Result<Vec<Loaded>, Failure> {
        sources.iter().map(|source| pipeline.read(Source::from(source), purpose)).collect()
    };
    let prepare = |recordings: &[Loaded], purpose| -> Result<Vec<_>, Failure> {
        recordings.iter().map(|loaded| pipeline.preprocess(loaded, purpose)).collect()
    };
    let calibration = read(&experiment.recordings.calibration, Purpose::Calibration)?;
    let held_out = match validate {
        Validate::HeldOut => read(&experiment.recordings.validation, Purpose::Validation)?,
        Validate::LeaveOneOut => Vec::new(),
    };
    let judged = match validate {
        Validate::HeldOut => &held_out,
        Validate::LeaveOneOut => &calibration,
    };
    Ok(Data {
        unit: pipeline.common_unit(calibration.iter().chain(&held_out))?.unwrap_or_default(),
        judged: prepare(judged, Purpose::Validation)?,
        calibration: prepare(&calibration, Purpose::Calibration)?,
    })
}
