//! A diagnosis of the recordings with an effect, from what is known of them as they are.

use std::sync::Arc;

use crate::contact::{Contact, ContactOptions, ContactRows, find_contacts};
use crate::effects::{self, external_contact, time_delay};
use crate::error::DiagnosisError;
use crate::evidence::baseline::{Baseline, weighted_fit};
use crate::evidence::gram::BlockMoments;
use crate::evidence::judged::bound_floors;
use crate::evidence::problem::Problem;
use crate::evidence::residuals::residuals;
use crate::hypotheses::candidates::Candidate;
use crate::hypotheses::group::{Group, Switch};
use crate::injection::anew::Anew;
use crate::injection::ground::Known;
use crate::injection::prepared::{AddedRows, Prepared};
use crate::investigation::{Delay, Investigation, earn, mean_floor, reshape_judged};
use crate::recordings::divided::FitRows;
use crate::request::{Question, QuestionedRecording};
use crate::search::ground::{Ground, Recorded};
use crate::search::selection::{Selection, Selector};
use crate::verdict::{Verdict, write_verdict};

/// A selection and what it was made from.
struct Selected {
    problem: Problem,
    selection: Selection,
    switches: Vec<Switch>,
    coefficients: Vec<f64>,
    independent_share: f64,
}

/// What selection starts from.
struct Start<'a> {
    groups: &'a [Group],
    chosen: Vec<usize>,
    floor: &'a [f64],
    changed: &'a [usize],
}

impl Prepared<'_> {
    /// What is said of the recordings with something added, `turn` as a share of their lengths by which what the final model
    /// leaves of them is turned in a circle: 0 is the recordings' own noise. `effect` is what is added: orders of ripple are
    /// proposed anew where it is one. None where a delay is found, which takes another fit to say more of.
    ///
    /// # Errors
    /// What evaluation reports.
    pub fn said_with(
        &self,
        effect: &str,
        added: &AddedRows,
        turn: f64,
    ) -> Result<Option<Verdict>, DiagnosisError> {
        let question = &self.asked();
        let reference = &self.reference;
        let mut anew = self.anew(added, turn);
        let mut candidates = reference.candidates.clone();
        if let Some(effect) = effects::find(effect).filter(|e| e.reads_residual) {
            self.propose_anew(effect, &mut anew, &mut candidates)?;
        }
        let (groups, chosen) = self.hypotheses(&anew.joints);
        let several = anew.joints.len() > 1;
        let investigation = self.investigated(question, anew, candidates, groups, chosen)?;
        // One clock stamps all joints: what is on one of them is no delay.
        let considered = question.considers(&time_delay::EFFECT);
        if (several || investigation.is_late()) && considered && reference.late.is_none() {
            let recordings = self.with_added(added);
            let late = Question { recordings: &recordings, ..*question };
            if Delay::found(&late, &investigation)?.is_some() {
                return Ok(None);
            }
        }
        let mut investigation = investigation;
        earn(question, &mut investigation)?;
        Ok(Some(write_verdict(question, &investigation)))
    }

    /// Selection, contacts and what they leave.
    fn investigated(
        &self,
        question: &Question<'_>,
        anew: Anew,
        mut candidates: Vec<Candidate>,
        groups: Vec<Group>,
        chosen: Vec<usize>,
    ) -> Result<Investigation, DiagnosisError> {
        let reference = &self.reference;
        let (partition, layout) = (&reference.partition, &reference.layout);
        let Anew { mut rows, mut confirm, problem, coefficients, mut floors, joints } = anew;
        let baseline = Baseline { coefficients, ..reference.baseline.clone() };
        let mut floor = mean_floor(&rows, partition, &floors, |_| true);
        let start = Start { groups: &groups, chosen, floor: &floor, changed: &joints };
        let mut selected = self.select(question, problem, &mut rows, &mut candidates, &start);
        let mut contacts = reference.contacts.clone();
        if question.considers(&external_contact::EFFECT) {
            let found = self.contacts(question, &rows, &selected);
            if !found.is_empty() {
                let untouched = rows.clone();
                self.leave_out(&mut rows, &found);
                let problem = Problem::new(layout, BlockMoments::accumulate(&rows, partition));
                selected = self.select(question, problem, &mut rows, &mut candidates, &start);
                let again = self.contacts(question, &untouched, &selected);
                contacts.extend(found.into_iter().filter(|f| again.iter().any(|c| f.meets(c))));
            }
        }
        let Selected { problem, selection, switches, coefficients, independent_share } = selected;
        let noise_notes =
            bound_floors(&rows, layout, &switches, &coefficients, &mut floors, question.names());
        floor = mean_floor(&rows, partition, &floors, |_| true);
        let chosen = selection.chosen.iter().map(|c| groups[c.group].candidate);
        reshape_judged(&mut confirm, &candidates, chosen, question, self.registry, layout, partition)?;
        let mut investigation = Investigation {
            model: reference.model.clone(),
            baseline,
            rows,
            confirm,
            partition: partition.clone(),
            layout: layout.clone(),
            problem,
            candidates,
            groups,
            base_switches: reference.base_switches.clone(),
            floors,
            noise: reference.noise.clone(),
            noise_notes,
            floor,
            faults: reference.faults.clone(),
            faults_matter: reference.faults_matter,
            undetermined: reference.undetermined,
            late: None,
            shaking: reference.shaking.clone(),
            gears_visible: Vec::new(),
            before_gears: reference.before_gears.clone(),
            contacts,
            selection,
            indicated: Vec::new(),
            constant: reference.constant.clone(),
            predicted: reference.predicted.clone(),
            untried: Vec::new(),
            free: reference.free.clone(),
            mean_independent_share: independent_share,
        };
        investigation.confirm_chosen(question);
        Ok(investigation)
    }

    fn select(
        &self,
        question: &Question<'_>,
        problem: Problem,
        rows: &mut FitRows,
        candidates: &mut [Candidate],
        start: &Start<'_>,
    ) -> Selected {
        let recorded = Recorded {
            problem,
            rows,
            candidates,
            partition: &self.reference.partition,
            layout: &self.reference.layout,
            question,
            registry: self.registry,
        };
        let mut ground =
            Known { recorded, chance: &self.chance, shares: &self.shares, changed: start.changed };
        let mut selector = Selector {
            ground: &mut ground,
            baseline: &self.reference.base_switches,
            groups: start.groups,
            floor: start.floor,
            options: &question.selection,
        };
        let selection = selector.run_from(start.chosen.clone(), |_| {});
        let switches = selector.final_switches(&selection);
        let coefficients = weighted_fit(ground.problem(), &switches, start.floor).0.coefficients;
        let shares = ground.independent_shares(&switches, &coefficients);
        let independent_share = shares.iter().sum::<f64>() / shares.len().max(1) as f64;
        let Recorded { problem, .. } = ground.recorded;
        Selected { problem, selection, switches, coefficients, independent_share }
    }

    /// Contacts while the arm moves, in what a selection leaves.
    fn contacts(&self, question: &Question<'_>, rows: &FitRows, selected: &Selected) -> Vec<Contact> {
        let asked: Vec<usize> = (0..rows.len()).filter(|r| rows[*r].rows() > 0).collect();
        let searched: Vec<(_, Vec<Vec<bool>>)> = asked
            .iter()
            .map(|r| {
                let layout = &self.reference.layout;
                let left = residuals(&rows[*r], layout, &selected.switches, &selected.coefficients);
                let out = |counts: &Vec<bool>| counts.iter().map(|counts| !counts).collect();
                (left, rows[*r].joints.iter().map(|j| out(&j.counts)).collect())
            })
            .collect();
        let views: Vec<ContactRows<'_>> = asked
            .iter()
            .zip(&searched)
            .map(|(r, (residual, left_out))| ContactRows {
                rows: &rows[*r],
                origin_s: self.recordings[*r].origin_s(),
                residual,
                forces: &self.forces[*r],
                left_out,
            })
            .collect();
        let found = find_contacts(&views, &ContactOptions::new(question.f_dyn_hz));
        found.into_iter().map(|c| Contact { recording: asked[c.recording], ..c }).collect()
    }

    fn leave_out(&self, rows: &mut FitRows, contacts: &[Contact]) {
        for contact in contacts {
            let origin_s = self.recordings[contact.recording].origin_s();
            rows[contact.recording].leave_out(contact.window_s.map(|t| t + origin_s));
        }
    }

    /// The recordings with something added to their measurement behind the filters.
    fn with_added(&self, added: &AddedRows) -> Vec<QuestionedRecording> {
        let mut recordings = self.recordings.clone();
        for (recording, added) in recordings.iter_mut().zip(added) {
            let mut first = 0;
            for segment in &mut Arc::make_mut(&mut recording.data).data.segments {
                let kept = segment.rows();
                for (series, added) in segment.measurement.iter_mut().flatten().zip(added) {
                    let added = &added[first..first + kept];
                    series[..kept].iter_mut().zip(added).for_each(|(y, e)| *y += e);
                }
                first += kept;
            }
        }
        recordings
    }
}
