//! Currents without torque constants, brought to one scale.
//!
//! The drives' torque constants K_j of an arm differ by factors. In amperes the bodies that load several joints are then other ones on
//! each, and a load on the flange is losses, springs and encoders with other zeros as well. Motion determines the ratios K_j/K_r: y_j =
//! (K_r/K_j) W_j ζ with rotors on all joints and a load that the targets may carry, whatever else is missing.

use aurt_calibration::{Gains, GainsOf, NamedRecording, TermScopes, estimate_gains, with_deviation};
use aurt_plugins::Registry;
use aurt_recording::PreprocessOptions;
use aurt_traits::{ArmTerm, MeasurementUnit, RobotModel};
use serde_json::{Value, json};

use crate::error::DiagnosisError;
use crate::recordings::rows::Role;
use crate::request::{Question, QuestionedRecording};

/// Ratios of torque constants that recordings determine.
#[derive(Debug, Clone, PartialEq)]
pub struct CommonScale {
    /// The joint in whose scale currents are.
    reference: usize,
    /// K_j/K_r and its standard deviation; absent where nothing determines it.
    ratios: Vec<Option<[f64; 2]>>,
}

/// A ratio that is less certain than by this share is none: an arm's constants differ by factors of two.
const LEAST_CERTAIN: f64 = 0.1;

/// Deviations beyond which two estimates of a ratio differ: the targets' one is then that of something that has changed.
const SAME: f64 = 3.0;

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
        add(json!({"model": "rotor_inertia", "joints": (0..model.joints()).collect::<Vec<_>>()}))?;
        let loaded: Vec<String> =
            used().filter(|r| r.role == Role::Target).map(|r| r.data.name.clone()).collect();
        if !loaded.is_empty() {
            add(json!({"model": "payload", "link": model.joints() - 1}))?;
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

    fn known(gains: &Gains) -> Option<Self> {
        let known = gains.joints.iter().map(|gain| {
            let std = gain.ratio_std_dev.filter(|std| *std < LEAST_CERTAIN * gain.ratio)?;
            Some([gain.ratio, std])
        });
        let ratios: Vec<Option<[f64; 2]>> = known.collect();
        let others = ratios.iter().flatten().count() > 1;
        others.then_some(Self { reference: gains.reference, ratios })
    }

    /// True if no ratio of both differs.
    fn agrees(&self, other: &Self) -> bool {
        let Some(Some([scale, _])) = other.ratios.get(self.reference) else { return false };
        let both = self.ratios.iter().zip(&other.ratios).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
        both.into_iter()
            .all(|([a, std], [b, other])| (a - b / scale).abs() <= SAME * std.hypot(other / scale))
    }

    /// Factors that bring the measurement to the scale, joint by joint.
    pub(crate) fn factors(&self) -> Vec<f64> {
        self.ratios.iter().map(|ratio| ratio.map_or(1.0, |[ratio, _]| ratio)).collect()
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

    /// The note on what currents were compared in.
    pub(crate) fn note(&self, question: &Question<'_>) -> String {
        let names = question.names();
        let known = self.ratios.iter().enumerate().filter(|(j, _)| *j != self.reference);
        let ratio = |(j, ratio): (usize, &Option<[f64; 2]>)| {
            ratio.map(|[ratio, std]| format!("{} {}", names.joint(j), with_deviation(ratio, std)))
        };
        let ratios: Vec<String> = known.filter_map(ratio).collect();
        let unknown: Vec<usize> = (0..self.ratios.len()).filter(|j| self.ratios[*j].is_none()).collect();
        let mut note = format!(
            "currents are those that the drive of {} would have: torque constants over its own, as motion determines them, are {}",
            names.joint(self.reference),
            ratios.join(", ")
        );
        if !unknown.is_empty() {
            note.push_str(&format!("; for {} nothing determines them", names.joint_list(&unknown)));
        }
        note
    }
}
