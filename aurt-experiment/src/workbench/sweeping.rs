//! How a sweep reads recordings and fits: as `aurt run` does.

use crate::Experiment;
use crate::sweep::{Data, Loader, PointError, Settings, Validate};
use aurt::data::{Loaded, Purpose, Source};
use aurt::duplicates::SampleRegister;
use aurt::fitting::judged_rows;
use aurt::{Error, Role};
use aurt_calibration::{CalibrationOptions, Deviations, ShapeOptions};

#[derive(Debug, Clone, Copy)]
pub struct ExperimentLoader;

impl Loader for ExperimentLoader {
    fn load(&self, experiment: &Experiment, validate: Validate) -> Result<Data, PointError> {
        load(experiment, validate).map_err(|failure| PointError::Recordings(failure.to_string()))
    }

    fn settings(&self, experiment: &Experiment) -> Settings {
        Settings {
            // Points are ranked by their errors; deviations that look at the rows again would cost more than a variant.
            calibration: CalibrationOptions { deviations: Deviations::White, ..experiment.calibration },
            shapes: ShapeOptions::default(),
            rows: judged_rows(Role::Validation, experiment.preprocess.trim_rest),
        }
    }
}

fn load(experiment: &Experiment, validate: Validate) -> Result<Data, Error> {
    let pipeline = experiment.pipeline();
    let each = |sources: &[Source], purpose| -> Result<Vec<Loaded>, Error> {
        sources.iter().map(|source| pipeline.read(source.clone(), purpose)).collect()
    };
    let prepare = |recordings: &[Loaded], purpose| -> Result<Vec<_>, Error> {
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
    Ok(Data {
        unit: pipeline.common_unit(read())?.unwrap_or_default(),
        judged: prepare(judged, Purpose::Validation)?,
        calibration: prepare(&calibration, Purpose::Calibration)?,
        warnings: read().flat_map(Loaded::warnings).collect(),
    })
}
