use std::sync::Arc;

use aurt_recording::{PreprocessOptions, Preprocessed, Recording, preprocess};
use aurt_traits::{MeasurementUnit, RigidBodyRegressor};

use serde::{Deserialize, Serialize};

use crate::error::SimulationError;
use crate::robots::Robot;

/// An experiment with real recordings, as plain data.
#[derive(Debug, Clone)]
pub struct RealExperiment {
    /// What the robot is called in truths and reference names.
    pub name: String,
    /// The text of its table of modified Denavit–Hartenberg parameters, where the geometry is one.
    pub mdh_csv: Option<String>,
    /// Its rigid bodies under gravity.
    pub bodies: Arc<dyn RigidBodyRegressor>,
    /// Unit of the measurements, gains undone.
    pub unit: MeasurementUnit,
    /// The experiment without its section `[recordings]`: the geometry in `mdh.csv` where it is a table, gains undone.
    pub experiment_toml: String,
    /// How recordings are preprocessed, gains undone.
    pub options: PreprocessOptions,
    /// What the experiment's structure has beyond rigid bodies, joint by joint.
    pub structure: Structure,
    pub recordings: Vec<RealRecording>,
}

/// A recording of a real robot, measured in [`RealExperiment::unit`].
#[derive(Debug, Clone)]
pub struct RealRecording {
    /// What the experiment calls it.
    pub name: String,
    /// The recording, its window cut out, gains and offsets undone.
    pub recording: Recording,
}

impl RealExperiment {
    /// A recording after this experiment's preprocessing.
    pub fn preprocessed(&self, recording: &Recording) -> Result<Preprocessed, SimulationError> {
        preprocess(recording, &self.options)
            .map_err(|error| SimulationError::Preprocessing { reason: error.to_string() })
    }

    /// Checks that the recordings are those of the robot.
    pub(super) fn validate(&self) -> Result<(), SimulationError> {
        let joints = self.bodies.joints();
        let count = |what: String, expected: usize, found: usize| {
            if expected == found { Ok(()) } else { Err(SimulationError::Count { what, expected, found }) }
        };
        count("joints of the experiment's structure".into(), joints, self.structure.joints.len())?;
        if self.recordings.is_empty() {
            return Err(SimulationError::Preprocessing {
                reason: format!("{}: there is no recording to add an effect to", self.name),
            });
        }
        for real in &self.recordings {
            count(format!("{}: joints", real.name), joints, real.recording.joints())?;
            let measured = real.recording.measurement.as_ref().map_or(0, Vec::len);
            count(format!("{}: joints with a measured torque or current", real.name), joints, measured)?;
        }
        Ok(())
    }
}

/// Which terms beyond the base parameters a joint's row has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointStructure {
    pub coulomb: bool,
    pub viscous: bool,
    pub rotor: bool,
    /// Dry friction in proportion to the load.
    pub load: bool,
}

/// The terms of all joints.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    pub joints: Vec<JointStructure>,
}

impl Structure {
    /// What the robot has by itself.
    pub fn of(robot: &Robot) -> Self {
        let joints = robot
            .drives
            .iter()
            .map(|drive| JointStructure {
                coulomb: drive.coulomb_nm > 0.0,
                viscous: drive.viscous_nm_s > 0.0,
                rotor: drive.rotor_inertia_kg_m2 > 0.0,
                load: drive.load_coefficient > 0.0,
            })
            .collect();
        Self { joints }
    }
}
