//! Calibrated models as sources and files of other programs.

use std::path::Path;

use aurt_experiment::{Registry, model_file::read_json};
use aurt_export::{Export, Provenance, Source, c, mjcf};
use aurt_simulation::Random;
use aurt_traits::{Motion, MotionView};
use serde_json::Value;

use crate::{calibrated_file::CalibratedModel, failure::Failure};

/// What a model is exported to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A C99 header and source.
    C,
    /// A MuJoCo model.
    Mjcf,
}

impl Target {
    /// Its name, as the command takes it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::C => "c",
            Self::Mjcf => "mjcf",
        }
    }
}

/// States at which the exported C is compared with the model.
const STATES: usize = 32;
const SEED: u64 = 1;
/// Positions of the states, rad or m, and accelerations, rad/s² or m/s².
const REACH: f64 = 3.0;
const ACCELERATION: f64 = 10.0;

/// The files of a target, of the model in `path`, for a robot called `name`.
///
/// # Errors
/// A file that is no calibrated model; [`Failure::Export`] for what the target cannot take.
pub fn export(path: &Path, name: &str, target: Target, registry: &Registry) -> Result<Export, Failure> {
    let calibrated = CalibratedModel::read(path, registry)?;
    let (document, text) = read_json(path)?;
    let calibration = &calibrated.calibration;
    let provenance = Provenance {
        file: path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned()),
        schema: document.get("schema").and_then(Value::as_u64).unwrap_or_default(),
        blake3: blake3::hash(text.as_bytes()).to_hex().to_string(),
        aurt_version: document.get("aurt_version").and_then(Value::as_str).map(str::to_owned),
        recordings: calibration.recordings.clone(),
    };
    let coefficients = calibration.coefficients();
    let standard: Option<Vec<f64>> =
        calibration.consistent.as_ref().map(|report| report.standard.iter().map(|s| s.value).collect());
    let source = Source {
        name,
        model: &calibrated.model,
        coefficients: &coefficients,
        load: &calibration.load,
        unit: calibration.unit,
        standard: standard.as_deref(),
        provenance: &provenance,
    };
    Ok(match target {
        Target::C => c::export(&source, &checks(&calibrated)?)?,
        Target::Mjcf => mjcf::export(&source)?,
    })
}

/// States within the velocities of the calibration and what the model predicts there; in the first, all joints rest.
fn checks(calibrated: &CalibratedModel) -> Result<Vec<c::Check>, Failure> {
    let joints = calibrated.model.joints();
    let mut random = Random::new(SEED);
    let mut within = |reach: f64| reach * (2.0 * random.unit() - 1.0);
    let mut states = Vec::with_capacity(STATES);
    for state in 0..STATES {
        let mut draw =
            |reach: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..joints).map(|j| within(reach(j))).collect() };
        let rests = state == 0;
        let speed = |j: usize| if rests { 0.0 } else { calibrated.calibration.ranges[j].velocity_rad_s };
        states.push([draw(&|_| REACH), draw(&speed), draw(&|_| ACCELERATION)]);
    }
    let by_joint =
        |k: usize| -> Vec<f64> { (0..joints).flat_map(|j| states.iter().map(move |s| s[k][j])).collect() };
    let times = (0..STATES).map(|n| n as f64).collect();
    let motion = Motion::new(joints, times, by_joint(0), by_joint(1), by_joint(2))?;
    let view: MotionView<'_> = motion.view();
    let torque = calibrated.torque(view)?;
    Ok(states
        .into_iter()
        .enumerate()
        .map(|(n, [q_rad, qd_rad_s, qdd_rad_s2])| c::Check {
            q_rad,
            qd_rad_s,
            qdd_rad_s2,
            torque_nm: torque.iter().map(|series| series[n]).collect(),
        })
        .collect())
}
