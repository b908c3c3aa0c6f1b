use aurt_recording::{PreprocessOptions, Recording, preprocess};

use super::Discrimination;
use crate::error::DiagnosisError;
use crate::evidence::baseline::extended_load;
use crate::evidence::gram::{BlockMoments, Moments};
use crate::hypotheses::candidates::build_term;
use crate::recordings::partition::{HELD_OUT_TAIL, Partition};
use crate::recordings::rows::{Fit, JointRows, RecordingRows, Role};
use crate::recordings::term_rows::term_rows;
use crate::recordings::unresolved::leave_out_unresolved;
use crate::vocabulary::Addition;

/// Second moments of all columns over a motion that is not recorded yet.
#[derive(Debug, Clone)]
pub struct MotionMoments {
    pub(super) moments: [Vec<Moments>; 2],
    pub(super) largest: Vec<f64>,
}

pub(super) fn add(sums: &mut [Vec<Moments>; 2], others: &[Vec<Moments>; 2]) {
    for (sum, moments) in sums.iter_mut().flatten().zip(others.iter().flatten()) {
        sum.add(moments, 1.0);
    }
}

impl Discrimination<'_> {
    /// The motion of a recording whose measurement is still unknown; what stands in its place is not used. It is filtered as
    /// the others were, and belongs to the targets where there are some.
    pub(super) fn moments(&self, motion: &Recording) -> Result<MotionMoments, DiagnosisError> {
        let Self { question, investigation, .. } = self;
        let (role, options) = self.like();
        let mut data = preprocess(motion, options)?;
        leave_out_unresolved(motion, &mut data, options)?;
        let load = extended_load(&investigation.baseline, question.model, &investigation.model);
        let own = Fit {
            model: question.model,
            load: &investigation.baseline.load,
            coefficients: &investigation.baseline.coefficients,
        };
        let mut rows = RecordingRows::evaluate("planned", role, &data, &investigation.model, &load, &own)?;
        for candidate in self.doubts.iter().flat_map(super::Doubt::candidates) {
            let candidate = &investigation.candidates[candidate];
            let Addition::Term(configuration) = &candidate.proposal.addition else { continue };
            if candidate.proposal.shapes.is_empty() {
                continue;
            }
            // The model of all candidates has the law with the shape that the search began with.
            let term = build_term(self.registry, candidate.effect, configuration)?;
            let series = term_rows(&*term, &**question.model.rigid_body(), &data)?;
            for (joint, columns) in term.joints(rows.joints.len()).iter().zip(&series) {
                for (column, values) in candidate.columns.iter().zip(columns) {
                    let place = investigation.layout.rows[*joint].iter().position(|c| c == column);
                    if let Some(place) = place {
                        rows.joints[*joint].set_column(place, values);
                    }
                }
            }
        }
        let largest = self.largest(&rows);
        let whole = Partition {
            blocks: vec![vec![(0, 0, rows.rows())]],
            held_out: Vec::new(),
            held_out_names: Vec::new(),
            pieces: vec![1],
            end_of_fit: vec![rows.rows()],
        };
        let mut moments = BlockMoments::accumulate(&[rows], &whole).total;
        // Without recordings for it, the last part of each confirms and is not fitted.
        if question.recordings.iter().all(|recording| recording.role != Role::Validation) {
            moments.iter_mut().flatten().for_each(|moments| moments.scale(1.0 - HELD_OUT_TAIL));
        }
        Ok(MotionMoments { moments, largest })
    }

    /// The largest torque of each joint in rows.
    fn largest(&self, rows: &RecordingRows) -> Vec<f64> {
        let Self { investigation, fitted, .. } = self;
        let own = fitted.own(&investigation.baseline.coefficients, &investigation.base_switches);
        let coefficient = |column: usize| match fitted.switches.iter().position(|s| s.column == column) {
            Some(k) => fitted.fit.coefficients[k],
            None => own.get(column).copied().unwrap_or(0.0),
        };
        let of_joint = |(joint, columns): (&JointRows, &Vec<usize>)| {
            let mut torque = vec![0.0; rows.rows()];
            for (k, column) in columns.iter().enumerate() {
                let factor = coefficient(*column);
                if factor != 0.0 {
                    torque.iter_mut().zip(joint.column(k)).for_each(|(sum, value)| *sum += factor * value);
                }
            }
            torque.into_iter().fold(0.0, |most: f64, torque| most.max(torque.abs()))
        };
        rows.joints.iter().zip(&investigation.layout.rows).map(of_joint).collect()
    }

    /// The part that a further recording takes, and how it is read: as the last of those in question.
    fn like(&self) -> (Role, &PreprocessOptions) {
        let of_role = |role: Role| self.question.recordings.iter().rev().find(|r| r.role == role);
        let last = of_role(Role::Target).or_else(|| of_role(Role::Calibration));
        // With a given model every recording is a question about it.
        let role = if of_role(Role::Target).is_some() || self.investigation.baseline.frozen {
            Role::Target
        } else {
            Role::Calibration
        };
        (role, &last.unwrap_or(&self.question.recordings[0]).options)
    }
}
