//! Laws that are made of the model's own coefficients, evaluated anew with those of the final model.
//!
//! Load-dependent friction, a tilted base, an encoder's offset, a joint's compliance and a gain error multiply a torque that the model
//! predicts. Their columns are of the model in question, whose coefficients take up part of what it lacks: a drive that loses a fifth of its load
//! makes the arm seem a tenth too heavy, and the loss, per load, too small. With the columns of the final coefficients
//! both are right; a few rounds of evaluation and least squares settle them.

use aurt_plugins::Registry;
use aurt_traits::{ArmTerm, ColumnGroup, LoadTorque, RobotModel};
use rayon::prelude::*;
use serde_json::json;

use crate::error::DiagnosisError;
use crate::evidence::baseline::{Baseline, reads_load};
use crate::evidence::judged::bound_floors;
use crate::hypotheses::candidates::{Candidate, build_term, with_terms};
use crate::hypotheses::group::Group;
use crate::investigation::Investigation;
use crate::investigation::fitted::Fitted;
use crate::investigation::selecting::{Parts, Selected, mean_floor};
use crate::noise::spectrum::RecordingNoise;
use crate::recordings::divided::{ConfirmRows, FitRows};
use crate::recordings::rows::{Fit, Instrument, RecordingRows, Role};
use crate::request::Question;
use crate::vocabulary::{AROUND, Addition};

/// Rounds at most; each leaves a fraction of the error that is the law's share of the load.
const ROUNDS: usize = 4;

/// The coefficients of the laws are settled when none moves by more than this share of its deviation.
const SETTLED: f64 = 0.1;

/// Columns that differ by less than this share of their largest value are the same.
const ROUNDING: f64 = 1e-9;

/// A model of the own columns, of the chosen laws, and of all that are made of the model's coefficients.
struct Final {
    model: RobotModel,
    /// Columns in it, and in the model of all candidates.
    columns: Vec<[usize; 2]>,
    /// Columns of gain errors in the latter, and their joints.
    gains: Vec<(usize, usize)>,
}

impl Final {
    /// The joint whose gain error has a column.
    fn gain_of(&self, column: usize) -> Option<usize> {
        self.gains.iter().find(|(own, _)| *own == column).map(|(_, joint)| *joint)
    }

    /// Its coefficients in recordings of a role.
    fn coefficients(&self, own: &[f64], fitted: &Fitted, role: Role) -> Vec<f64> {
        let mut all = own.to_vec();
        all.resize(self.model.parameters().len(), 0.0);
        for [here, there] in self.columns.iter().filter(|[_, there]| *there >= own.len()) {
            let value =
                |target_only| fitted.place(*there, target_only).map_or(0.0, |k| fitted.fit.coefficients[k]);
            all[*here] = value(false) + if role == Role::Calibration { 0.0 } else { value(true) };
        }
        all
    }
}

impl Parts<'_> {
    /// Evaluates the columns of all laws that are made of the model's coefficients with those of the final fit, in the rows
    /// that fit and in those that confirm, and fits again, until both agree. Whether columns of the final model have
    /// changed in that: with the new ones other laws may do better.
    pub(super) fn settle(
        &mut self,
        baseline: &Baseline,
        rows: &mut FitRows,
        confirm: &mut ConfirmRows,
        selected: &mut Selected,
    ) -> Result<bool, DiagnosisError> {
        let groups: Vec<&Group> =
            selected.selection.chosen.iter().map(|c| &selected.groups[c.group]).collect();
        let is_made_of_it = |g: &&Group| g.effect.reads_model;
        let has_loads = baseline.load != LoadTorque::Literal;
        // What a given model predicts was taken from the measurement.
        let own_columns = has_loads && !baseline.frozen && reads_load(self.question.model);
        if groups.is_empty() || !own_columns && !groups.iter().any(is_made_of_it) {
            return Ok(false);
        }
        let roles: Vec<Role> = rows.iter().map(|r| r.role).collect();
        let laws = self.laws(&groups)?;
        for round in 0..ROUNDS {
            let own = selected.fitted.own(self.own, self.base);
            for law in &laws {
                settle_law(&mut self.candidates[*law], &own, &selected.fitted);
            }
            let law = self.final_model(&laws)?;
            let evaluated = self.evaluate_final(baseline, (&law, &own), selected, &roles)?;
            let renewed: Vec<Renewed> = (0..evaluated.len())
                .flat_map(|r| self.renewed((r, &evaluated[r]), &law, (own_columns, &own)))
                .collect();
            let in_model = |column: usize| {
                column < own.len() || selected.fitted.switches.iter().any(|s| s.column == column)
            };
            // Arm terms do not say whether they read the load: rotors do not.
            let of_model = renewed.iter().filter(|new| in_model(self.layout.rows[new.joint][new.place]));
            if round == 0 && !of_model.into_iter().any(|new| new.differs_from(rows)) {
                return Ok(false);
            }
            for Renewed { recording, joint, place, values } in &renewed {
                let (fit, rest) = values.split_at(rows[*recording].rows());
                rows[*recording].joints[*joint].set_column(*place, fit);
                confirm.set_column(*recording, *joint, *place, rest);
            }
            for joint in 0..self.layout.rows.len() {
                let places: Vec<usize> = (0..self.layout.rows[joint].len())
                    .filter(|place| self.changes(self.layout.rows[joint][*place], &law, own_columns))
                    .collect();
                selected.problem.renew(rows, self.partition, joint, &places);
            }
            let switches = selected.fitted.switches.clone();
            let again = Fitted::of(&selected.problem, self.floor, selected.mean_independent_share, switches);
            let moved = self.moved(&again, &selected.fitted.fit.coefficients);
            selected.fitted = again;
            if moved <= SETTLED {
                break;
            }
        }
        Ok(true)
    }

    /// Puts the noise of recordings, and the floors that it makes, under the model with the loads among some candidates: what the links carry
    /// multiplies the noise of the accelerations.
    fn load_noise(
        &self,
        (baseline, fitted): (&Baseline, &Fitted),
        chosen: &[usize],
        rows: &[RecordingRows],
        noise: &mut [RecordingNoise],
        floors: &mut [Vec<f64>],
    ) -> Result<(), DiagnosisError> {
        let mut loads = Vec::new();
        for law in chosen {
            let Candidate { effect, proposal, registered: None, .. } = &self.candidates[*law] else {
                continue;
            };
            if let Addition::Term(configuration) = &proposal.addition
                && build_term(self.registry, effect, configuration)?.is_load()
                && !loads.contains(law)
            {
                loads.push(*law);
            }
        }
        if loads.is_empty() {
            return Ok(());
        }
        let law = self.final_model(&loads)?;
        let own = fitted.own(self.own, self.base);
        for (r, recording) in self.question.recordings.iter().enumerate() {
            let coefficients = law.coefficients(&own, fitted, rows[r].role);
            let load = match baseline.load {
                LoadTorque::Literal => LoadTorque::Literal,
                LoadTorque::Fitted(_) => LoadTorque::Fitted(coefficients.clone()),
            };
            let fit = Fit { model: &law.model, load: &load, coefficients: &coefficients };
            let data = &recording.data.data;
            let loaded = noise[r].under(data, &fit)?;
            for (j, floor) in floors[r].iter_mut().enumerate() {
                *floor += loaded.mean_left(j, data)? - noise[r].mean_left(j, data)?;
            }
            noise[r] = loaded;
        }
        Ok(())
    }

    /// By how many of its deviations the coefficient of a law has moved, at most.
    fn moved(&self, fitted: &Fitted, from: &[f64]) -> f64 {
        let law = |k: &usize| fitted.switches[*k].column >= self.own.len();
        let by = |k: usize| {
            (fitted.fit.coefficients[k] - from[k]).abs() / fitted.deviations[k].max(f64::MIN_POSITIVE)
        };
        (0..from.len()).filter(law).map(by).fold(0.0, f64::max)
    }

    /// The candidates of chosen laws, and of all that are made of the model's coefficients. Where a load was found, the
    /// latter keep that of the model in question: losses of a load that contain a spring's torque would take its place.
    fn laws(&self, chosen: &[&Group]) -> Result<Vec<usize>, DiagnosisError> {
        let mut is_loaded = false;
        for candidate in chosen.iter().map(|g| &self.candidates[g.candidate]) {
            if let Addition::Term(configuration) = &candidate.proposal.addition {
                is_loaded |= build_term(self.registry, candidate.effect, configuration)?.is_load();
            }
        }
        let chosen = |k: usize| chosen.iter().any(|g| g.candidate == k);
        let is_made_of_it = |k: usize| !is_loaded && self.candidates[k].effect.reads_model;
        Ok((0..self.candidates.len()).filter(|k| chosen(*k) || is_made_of_it(*k)).collect())
    }

    fn final_model(&self, laws: &[usize]) -> Result<Final, DiagnosisError> {
        let own = self.question.model;
        let mut terms: Vec<Box<dyn ArmTerm>> = own.arm_terms().to_vec();
        let mut added: Vec<(usize, &Candidate)> = Vec::new();
        let mut gains = Vec::new();
        for candidate in laws.iter().map(|law| &self.candidates[*law]) {
            match &candidate.proposal.addition {
                // A registered model that is no effect does not read what this is about.
                Addition::Term(configuration) if candidate.registered.is_none() => {
                    terms.push(build_term(self.registry, candidate.effect, configuration)?);
                    added.push((terms.len() - 1, candidate));
                }
                Addition::Instrument(joint, Instrument::Gain) => {
                    gains.push((candidate.columns[0], *joint));
                }
                _ => {}
            }
        }
        let model = with_terms(own, terms)?;
        let mut columns: Vec<[usize; 2]> = (0..own.parameters().len()).map(|c| [c, c]).collect();
        for (term, candidate) in added {
            let here = model.group(ColumnGroup::ArmTerm(term));
            columns.extend(here.zip(&candidate.columns).map(|(here, there)| [here, *there]));
        }
        Ok(Final { model, columns, gains })
    }

    fn evaluate_final(
        &self,
        baseline: &Baseline,
        (law, own): (&Final, &[f64]),
        selected: &Selected,
        roles: &[Role],
    ) -> Result<Vec<RecordingRows>, DiagnosisError> {
        let load = |role: Role| match baseline.load {
            LoadTorque::Literal => LoadTorque::Literal,
            LoadTorque::Fitted(_) => LoadTorque::Fitted(law.coefficients(own, &selected.fitted, role)),
        };
        let loads = [Role::Calibration, Role::Target].map(load);
        self.question
            .recordings
            .par_iter()
            .zip(roles)
            .map(|(recording, role)| {
                let load = &loads[usize::from(*role != Role::Calibration)];
                let fit = Fit { model: &law.model, load, coefficients: own };
                RecordingRows::of_model(&recording.data.name, recording.role, &recording.data.data, &fit)
            })
            .collect()
    }

    /// Whether a column of the model of all candidates is evaluated anew.
    fn changes(&self, column: usize, law: &Final, own_columns: bool) -> bool {
        if column < self.own.len() {
            return own_columns && !self.question.model.group(ColumnGroup::RigidBody).contains(&column);
        }
        law.columns.iter().any(|[_, there]| *there == column) || law.gain_of(column).is_some()
    }

    /// The columns of a recording that are evaluated anew.
    fn renewed(
        &self,
        (recording, whole): (usize, &RecordingRows),
        law: &Final,
        (own_columns, own): (bool, &[f64]),
    ) -> Vec<Renewed> {
        let mut renewed = Vec::new();
        for (joint, layout) in self.layout.rows.iter().enumerate() {
            let evaluated = &whole.joints[joint];
            let here = law.model.row_columns(joint);
            let of = |column: usize| {
                let [here_column, _] = law.columns.iter().find(|[_, there]| *there == column)?;
                here.iter().position(|c| c == here_column)
            };
            for (place, column) in layout.iter().enumerate() {
                if !self.changes(*column, law, own_columns) {
                    continue;
                }
                let values = match law.gain_of(*column) {
                    Some(of_joint) if of_joint == joint => {
                        let mut predicted = vec![0.0; whole.rows()];
                        for (k, c) in here.iter().enumerate().filter(|(_, c)| **c < own.len()) {
                            let column = evaluated.column(k).iter();
                            predicted.iter_mut().zip(column).for_each(|(p, v)| *p += own[*c] * v);
                        }
                        predicted
                    }
                    Some(_) => continue,
                    None => match of(*column) {
                        Some(k) => evaluated.column(k).to_vec(),
                        None => continue,
                    },
                };
                renewed.push(Renewed { recording, joint, place, values });
            }
        }
        renewed
    }
}

/// Puts noise and floors of an investigation under the loads that are in its model at last.
pub(super) fn load_noise(
    question: &Question<'_>,
    registry: &Registry,
    investigation: &mut Investigation,
) -> Result<(), DiagnosisError> {
    let chosen: Vec<&Group> =
        investigation.selection.chosen.iter().map(|c| &investigation.groups[c.group]).collect();
    let fitted = Fitted::new(investigation, investigation.switches_of(chosen.iter().copied()));
    let chosen: Vec<usize> = chosen.iter().map(|group| group.candidate).collect();
    let Investigation {
        candidates,
        partition,
        layout,
        base_switches,
        baseline,
        floor,
        noise,
        floors,
        rows,
        ..
    } = investigation;
    let parts = Parts {
        question,
        registry,
        candidates,
        partition,
        layout,
        base: base_switches,
        own: &baseline.coefficients,
        floor,
    };
    parts.load_noise((baseline, &fitted), &chosen, rows, noise, floors)?;
    let Investigation { rows, floors, noise_notes, .. } = investigation;
    let left = &fitted.fit.coefficients;
    noise_notes.extend(bound_floors(
        rows,
        &investigation.layout,
        &fitted.switches,
        left,
        floors,
        question.names(),
    ));
    investigation.floor = mean_floor(rows, &investigation.partition, floors, |_| true);
    Ok(())
}

/// A column of a joint's rows, over all rows of a recording.
struct Renewed {
    recording: usize,
    joint: usize,
    place: usize,
    values: Vec<f64>,
}

impl Renewed {
    /// Whether it is another than that of the rows that fit, beyond rounding.
    fn differs_from(&self, rows: &FitRows) -> bool {
        let joint = &rows[self.recording].joints[self.joint];
        let largest = self.values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let pairs = joint.column(self.place).iter().zip(&self.values).zip(&joint.counts);
        pairs.into_iter().any(|((old, new), counts)| *counts && (old - new).abs() > ROUNDING * largest)
    }
}

/// Gives a term around known bodies the inertial parameters of the final fit, and the coefficients around which it is linear.
fn settle_law(candidate: &mut Candidate, own: &[f64], fitted: &Fitted) {
    let Addition::Term(configuration) = &mut candidate.proposal.addition else { return };
    if let Some(values) = configuration.get_mut("inertial_values") {
        let count = values.as_array().map_or(0, Vec::len);
        *values = json!(own[..count]);
    }
    let around = AROUND.into_iter().find(|key| configuration.get(key).is_some());
    if let Some(around) = around.and_then(|key| configuration.get_mut(key)) {
        let place = |column: usize| fitted.place(column, true).or_else(|| fitted.place(column, false));
        let value = |column: &usize| place(*column).map_or(0.0, |k| fitted.fit.coefficients[k]);
        // Further columns are accessories.
        let angles = around.as_array().map_or(0, Vec::len);
        *around = candidate.columns.iter().take(angles).map(value).collect();
    }
}
