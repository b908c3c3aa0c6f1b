use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::request::CaseType;
use super::world::World;
use crate::strength::Strength;
use aurt_simulation::SimulationError;
use aurt_simulation::effects::Family;
use aurt_simulation::robots::Rotors;

/// What is in a case; hidden from the diagnosis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Truth {
    pub case: String,
    #[serde(default)]
    pub world: World,
    pub seed: u64,
    pub robot: String,
    pub rotors: Rotors,
    pub case_type: CaseType,
    pub strength: Strength,
    pub effects: Vec<TrueEffect>,
    /// What else the experiment does not declare, weaker than the effects: to name it is neither right nor wrong.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub background: Vec<TrueEffect>,
    /// Name of the same recordings without the effects. What is claimed of those is no news, and does not count here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    /// Standard deviation of the measured torques' noise, Nm per joint.
    pub noise_nm: Vec<f64>,
    /// What can be reached on the held-out recordings.
    pub validation: Vec<ValidationFloor>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrueEffect {
    pub effect: String,
    pub family: Family,
    pub in_vocabulary: bool,
    /// The joints whose physics it is; of whole-arm effects those whose error it makes.
    pub joints: Vec<usize>,
    /// `calibration` if it is in all recordings, `target` if in the later ones alone.
    pub present_in: Vec<String>,
    pub recording: Option<String>,
    pub window_s: Option<[f64; 2]>,
    /// Parameters by canonical name, one value or one per joint.
    pub parameters: Vec<(String, Vec<f64>)>,
    /// Torque that the experiment's structure cannot absorb over noise, per joint, in the recording where it
    /// is largest (within its window, if it has one).
    pub achieved: Vec<f64>,
    pub fields: Value,
}

/// Root mean square residuals of a held-out recording after the usual preprocessing, Nm per joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ValidationFloor {
    pub recording: String,
    /// What the experiment's structure leaves of it.
    pub before_nm: Vec<f64>,
    /// What the same structure leaves of the same motion without the effects: what a perfect model would.
    pub floor_nm: Vec<f64>,
}

impl Truth {
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SimulationError> {
        crate::json_file::read(path.as_ref())
    }

    /// The truth as the text of its file.
    pub fn json(&self) -> Result<String, SimulationError> {
        let mut text = serde_json::to_string_pretty(self)
            .map_err(|error| SimulationError::unreadable(self.case.clone(), error.to_string()))?;
        text.push('\n');
        Ok(text)
    }
}
