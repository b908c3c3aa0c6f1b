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
    /// The largest torque of each joint that the model of the diagnosis predicts, in the measurement's unit.
    pub largest: Vec<f64>,
}

impl MotionMoments {
    /// The moments of two motions, one after the other.
    pub(super) fn and(mut self, other: &Self) -> Self {
        add(&mut self.moments, &other.moments);
        self.largest.iter_mut().zip(&other.largest).for_each(|(most, other)| *most = most.max(*other));
        self
    }
}

pub(super) fn add(sums: &mut [Vec<Moments>; 2], others: &[Vec<Moments>; 2]) {
    for (sum, moments) in sums.iter_mut().flatten().zip(others.iter().flatten()) {
        sum.add(moments, 1.0);
    }
}

impl Discrimination<'_> {
    /// The motions that the diagnosis fitted, recorded again for as long as another.
    pub(super) fn recorded_again(&self, other: &MotionMoments) -> MotionMoments {
        let total = self.investigation.problem.total();
        let rows = |of: &[Vec<Moments>; 2]| of.iter().flatten().map(|m| m.rows).sum::<f64>();
        let share = rows(&other.moments) / rows(total).max(1.0);
        let mut moments = other.moments.clone();
        for (sum, moments) in moments.iter_mut().flatten().zip(total.iter().flatten()) {
            sum.scale(0.0);
            sum.add(moments, share);
        }
        MotionMoments { moments, largest: Vec::new() }
    }

    /// The motion of a recording whose measurement is still unknown; what stands in its place is not used. It is filtered as
    /// the others were, and belongs to the targets where there are some.
    ///
    /// # Errors
    /// What preprocessing and evaluation report.
    pub(super) fn planned(&self, motion: &Recording) -> Result<MotionMoments, DiagnosisError> {
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
        for candidate in self.contests.iter().flat_map(super::Contest::candidates) {
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

    /// Step and white noise of each joint's positions, rad, as they were recorded.
    pub(super) fn encoders(&self) -> Vec<[f64; 2]> {
        let noise = self.investigation.noise.first();
        let positions = noise.iter().flat_map(|noise| &noise.positions);
        positions.map(|position| [position.step_rad.unwrap_or(0.0), position.white_rad]).collect()
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
