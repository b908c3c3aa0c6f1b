//! Orders of ripple that a trial's own measurement proposes.

use crate::error::DiagnosisError;
use crate::evidence::residuals::residuals;
use crate::hypotheses::candidates::{Candidate, build_term};
use crate::injection::anew::Anew;
use crate::injection::prepared::Prepared;
use crate::recordings::rows::{JointRows, RecordingRows, Role};
use crate::recordings::term_rows::term_rows;
use crate::vocabulary::{Addition, Context, Effect, Proposal};

impl Prepared<'_> {
    /// Proposes an effect anew, from the residual of the trial, on the changed joints, where it is not claimed of the
    /// recordings as they are.
    pub(super) fn propose_anew(
        &self,
        effect: &Effect,
        anew: &mut Anew,
        candidates: &mut [Candidate],
    ) -> Result<(), DiagnosisError> {
        let claimed: Vec<usize> = self
            .reference
            .selection
            .chosen
            .iter()
            .map(|c| self.reference.groups[c.group].candidate)
            .collect();
        let switches = crate::evidence::baseline::own_switches(self.question.model);
        let switches = if self.reference.baseline.frozen { Vec::new() } else { switches };
        for joint in anew.joints.clone() {
            let mut recordings: Vec<RecordingRows> = Vec::new();
            let mut left = Vec::new();
            for rows in anew.rows.iter().filter(|r| r.role != Role::Validation) {
                let mut alone = vec![JointRows::default(); rows.joints.len()];
                alone[joint].position_rad.clone_from(&rows.joints[joint].position_rad);
                left.push(residuals(rows, &self.reference.layout, &switches, &anew.coefficients));
                recordings.push(RecordingRows {
                    name: rows.name.clone(),
                    role: rows.role,
                    rate_hz: rows.rate_hz,
                    time_s: Vec::new(),
                    segment_starts: vec![0],
                    joints: alone,
                });
            }
            let context = Context {
                joints: joint + 1,
                links: 0,
                apart: &[],
                recordings: &recordings,
                residual: &left,
                inertial: &[],
                resolution_rad: &[],
            };
            let proposals = (effect.propose)(&context).into_iter().filter(|p| p.joints == [joint]);
            let open = |k: &usize| {
                candidates[*k].effect == effect
                    && candidates[*k].proposal.joints == [joint]
                    && !claimed.contains(k)
            };
            let places: Vec<usize> = (0..candidates.len()).filter(open).collect();
            for (place, proposal) in places.into_iter().zip(proposals) {
                self.put(anew, &mut candidates[place], proposal, joint)?;
            }
        }
        Ok(())
    }

    /// Replaces the proposal of a candidate on a joint, and its columns in the rows that fit.
    fn put(
        &self,
        anew: &mut Anew,
        candidate: &mut Candidate,
        proposal: Proposal,
        joint: usize,
    ) -> Result<(), DiagnosisError> {
        let Addition::Term(configuration) = &proposal.addition else { return Ok(()) };
        let term = build_term(self.registry, candidate.effect, configuration)?;
        let row = &self.reference.layout.rows[joint];
        let places: Vec<usize> =
            candidate.columns.iter().filter_map(|c| row.iter().position(|own| own == c)).collect();
        for (r, recording) in self.recordings.iter().enumerate() {
            let rows = &mut anew.rows[r].joints[joint];
            let length = rows.measurement.len();
            if length == 0 {
                continue;
            }
            let series = term_rows(&*term, &**self.question.model.rigid_body(), &recording.data.data)?;
            for (place, values) in places.iter().zip(series.iter().flatten()) {
                let column = rows.data[place * length..(place + 1) * length].iter_mut();
                for ((o, value), counts) in column.zip(values).zip(&rows.counts) {
                    *o = if *counts { *value } else { 0.0 };
                }
            }
        }
        candidate.proposal = proposal;
        anew.problem.renew(&anew.rows, &self.reference.partition, joint, &places);
        Ok(())
    }
}
