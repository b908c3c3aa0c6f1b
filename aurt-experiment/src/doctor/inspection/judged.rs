//! Which parameters of a model motions determine, by their names.

use crate::workbench::experiments::friction;
use crate::workbench::failure::Failure;
use aurt_calibration::{
    CalibratedParameter, CalibrationOptions, NamedRecording, TermScopes, accumulate, badly_excited,
    calibrate, hardly_excited,
};
use aurt_plugins::Registry;
use aurt_report::rendering::number::significant;
use aurt_report::rendering::text::wrapped;
use aurt_traits::{ArmTerm, JointStack, LoadTorque, MeasurementUnit, RobotModel};
use serde_json::{Value, json};

use super::excitation::{Excitation, Excited, judge};

/// A parameter whose column is imitated by others up to this share of its own is hard to tell from them.
const SMALL_OWN_SHARE: f64 = 0.02;

/// The excitation of a model's parameters by a motion.
pub struct Judged {
    pub model: RobotModel,
    pub excited: Excited,
    /// What a calibration of the model on these recordings would warn of; nothing where they measured nothing.
    pub warnings: Vec<String>,
}

/// The least that a joint has.
pub fn plain_friction(registry: &Registry) -> Result<JointStack, Failure> {
    friction(registry, "constant", "sign", &[1])
}

/// What experiments often leave out, on all joints: rotors, and offsets of the measurement.
pub fn often_left_out(registry: &Registry) -> Result<Vec<Box<dyn ArmTerm>>, Failure> {
    ["rotor_inertia", "current_offset"]
        .iter()
        .map(|model| Ok(registry.build_from_json(&json!({ "model": model }))?))
        .collect()
}

impl Judged {
    /// Judges motions for a model, all together: what one does not excite another may. `unit` is that of the measurement,
    /// if there is any.
    pub fn new(
        model: RobotModel,
        recordings: &[NamedRecording],
        unit: Option<MeasurementUnit>,
        f_dyn_hz: f64,
    ) -> Result<Self, Failure> {
        let options = CalibrationOptions::default();
        // What was measured does not matter for what a motion excites, only that there is something.
        let mut motions = recordings.to_vec();
        for segment in motions.iter_mut().flat_map(|r| &mut r.data.segments) {
            segment.measurement = Some(vec![vec![0.0; segment.rows()]; segment.motion.joints()]);
        }
        let load = LoadTorque::Fitted(vec![0.0; model.parameters().len()]);
        let mut excited = judge(&accumulate(&model, &motions, &TermScopes::everywhere(), &load, &options)?);
        let determined = |k: usize| matches!(excited.coefficients[k], Excitation::Own(_));
        let all_determined = (0..excited.coefficients.len()).all(determined);
        let mut warnings = Vec::new();
        match unit.map(|unit| calibrate(&model, recordings, unit, f_dyn_hz, &options)) {
            Some(Ok(fit)) => {
                // What is determined in combinations only is said to be so, and has no precision of its own.
                let own: Vec<CalibratedParameter> = fit
                    .parameters
                    .into_iter()
                    .enumerate()
                    .filter(|(k, _)| determined(*k))
                    .map(|(_, p)| p)
                    .collect();
                warnings.extend(badly_excited(&own));
                if all_determined {
                    excited.condition_number = fit.condition_number;
                }
            }
            Some(Err(reason)) => warnings.push(reason.to_string()),
            None => {}
        }
        warnings.extend(hardly_excited(excited.condition_number));
        Ok(Self { model, excited, warnings })
    }

    pub fn findings(&self) -> Vec<String> {
        let (silent, combined) = (self.silent(), self.combined());
        let mut findings = Vec::new();
        if !silent.is_empty() || !combined.is_empty() {
            findings.push(format!(
                "{} of {} parameters are out of reach and {} are determined in combinations only",
                silent.len(),
                self.model.parameters().len(),
                combined.len()
            ));
        }
        findings.extend(self.warnings.iter().cloned());
        findings
    }

    /// Parameters that the motion determines, each with the share of its column that others cannot imitate.
    pub fn determined(&self) -> Vec<(&str, f64)> {
        let own = |(k, e): (usize, &Excitation)| match e {
            Excitation::Own(share) => Some((self.model.parameters()[k].name.as_str(), *share)),
            _ => None,
        };
        self.excited.coefficients.iter().enumerate().filter_map(own).collect()
    }

    fn names(&self, choose: impl Fn(&Excitation) -> bool) -> Vec<&str> {
        let parameters = self.model.parameters().iter().zip(&self.excited.coefficients);
        parameters.filter(|(_, e)| choose(e)).map(|(p, _)| p.name.as_str()).collect()
    }

    /// Parameters that the motion does not need.
    pub fn silent(&self) -> Vec<&str> {
        self.names(|e| *e == Excitation::Silent)
    }

    pub fn combined(&self) -> Vec<&str> {
        self.names(|e| matches!(e, Excitation::Combined(_)))
    }

    fn weak(&self) -> Vec<&str> {
        self.names(|e| matches!(e, Excitation::Own(share) if *share < SMALL_OWN_SHARE))
    }

    pub fn to_text(&self) -> String {
        let total = self.model.parameters().len();
        let (silent, combined, weak) = (self.silent(), self.combined(), self.weak());
        let mut text = wrapped(&format!(
            "{total} parameters ({} base parameters, Coulomb and viscous friction of every joint): {} determined, {} \
             only in combinations, {} out of reach",
            self.model.base().len(),
            total - combined.len() - silent.len(),
            combined.len(),
            silent.len()
        ));
        text.push_str(&wrapped(&format!(
            "condition number of what is determined: {}",
            significant(self.excited.condition_number, 3)
        )));
        text.extend(self.warnings.iter().map(|w| wrapped(w)));
        for (what, names) in
            [("out of reach", silent), ("only in combinations", combined), ("hard to tell apart", weak)]
        {
            if !names.is_empty() {
                text.push_str(&wrapped(&format!("{what}: {}", names.join(", "))));
            }
        }
        text
    }

    pub fn to_json(&self) -> Value {
        let parameters = self.model.parameters();
        let describe = |(k, excitation): (usize, &Excitation)| match excitation {
            Excitation::Own(share) => {
                json!({ "name": parameters[k].name, "is": "determined", "own_share": share })
            }
            Excitation::Combined(with) => {
                let with: Vec<&str> = with.iter().map(|w| parameters[*w].name.as_str()).collect();
                json!({ "name": parameters[k].name, "is": "combined", "with": with })
            }
            Excitation::Silent => json!({ "name": parameters[k].name, "is": "out_of_reach" }),
        };
        json!({
            "base_parameters": self.model.base().len(),
            "rank": self.excited.rank,
            "condition_number": self.excited.condition_number,
            "parameters": self.excited.coefficients.iter().enumerate().map(describe).collect::<Vec<_>>(),
        })
    }
}
