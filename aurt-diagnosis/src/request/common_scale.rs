//! Currents without torque constants, brought to one scale.
//!
//! The drives' torque constants K_j of an arm differ by factors. In amperes the bodies that load several joints are then other ones on
//! each, and a load on the flange is losses, springs and encoders with other zeros as well. Motion determines the ratios K_j/K_r: y_j =
//! (K_r/K_j) W_j ζ with rotors on all joints and a load that the targets may carry.

use aurt_calibration::{GainsOf, NamedRecording, TermScopes, estimate_gains};
use aurt_plugins::Registry;
use aurt_recording::PreprocessOptions;
use aurt_traits::{ArmTerm, MeasurementUnit, RobotModel};
use serde_json::{Value, json};

use crate::effects::{payload, rotor_inertia};
use crate::error::DiagnosisError;
use crate::recordings::rows::Role;
use crate::request::{CommonScale, Question, QuestionedRecording};

impl CommonScale {
    /// The ratios of currents that no torque constant or gain is stated of; what the other recordings determine decides for the targets.
    pub fn of(question: &Question<'_>, registry: &Registry) -> Option<Self> {
        let recordings = question.recordings;
        let is_stated = recordings.iter().any(|r| r.options.gains.is_some() || r.simulated.is_some());
        if question.unit != MeasurementUnit::Ampere || question.frozen.is_some() || is_stated {
            return None;
        }
        let estimate = |roles: &[Role]| Self::estimated(question, registry, roles);
        let all = estimate(&[Role::Calibration, Role::Target]);
        let has = |role| recordings.iter().any(|r| r.role == role);
        if !(has(Role::Calibration) && has(Role::Target)) {
            return all;
        }
        let own = estimate(&[Role::Calibration]);
        match (own, all) {
            (Some(own), Some(all)) => Some(if own.agrees(&all) { all } else { own }),
            (own, all) => own.or(all),
        }
    }

    fn estimated(question: &Question<'_>, registry: &Registry, roles: &[Role]) -> Option<Self> {
        let used = || question.recordings.iter().filter(|r| roles.contains(&r.role));
        let model = question.model;
        let mut terms = model.arm_terms().to_vec();
        let mut scopes: Vec<Option<Vec<String>>> = vec![None; terms.len() + 1];
        let mut add = |term: Value| -> Option<()> {
            terms.push(registry.build_from_json::<dyn ArmTerm>(&term).ok()?);
            Some(())
        };
        add(json!({"model": rotor_inertia::EFFECT.id, "joints": (0..model.joints()).collect::<Vec<_>>()}))?;
        let loaded: Vec<String> =
            used().filter(|r| r.role == Role::Target).map(|r| r.data.name.clone()).collect();
        if !loaded.is_empty() {
            add(json!({"model": payload::EFFECT.id, "link": model.joints() - 1}))?;
            scopes.push(Some(loaded));
        }
        let (body, base) = (model.rigid_body().clone(), model.base().clone());
        let beside = RobotModel::new(body, base, model.stacks().to_vec(), terms).ok()?;
        let recordings: Vec<NamedRecording> = used().map(|r| (*r.data).clone()).collect();
        let of = GainsOf {
            model: &beside,
            recordings: &recordings,
            scopes: &TermScopes::new(scopes),
            load: None,
            options: &question.calibration,
        };
        Self::known(&estimate_gains(&of).ok()?)
    }

    /// The recordings in the common scale.
    ///
    /// # Errors
    /// What preprocessing reports.
    pub fn applied(&self, question: &Question<'_>) -> Result<Vec<QuestionedRecording>, DiagnosisError> {
        let scaled = |recording: &QuestionedRecording| {
            let mut scaled = recording.clone();
            let gains = Some(self.factors());
            scaled.preprocessed_anew(PreprocessOptions { gains, ..recording.options.clone() })?;
            Ok(scaled)
        };
        question.recordings.iter().map(scaled).collect()
    }
}
