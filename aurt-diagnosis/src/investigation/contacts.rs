//! Contacts, while the arm moves and while it stands.

use crate::contact::{
    ALONE_S, Contact, ContactOptions, ContactRows, StandingRows, find_contacts, find_standing_contacts,
    force_columns,
};
use crate::error::DiagnosisError;
use crate::evidence::baseline::{Baseline, extended_load};
use crate::evidence::residuals::residuals;
use crate::hypotheses::group::Switch;
use crate::investigation::selecting::{Parts, Selected};
use crate::recordings::divided::FitRows;
use crate::recordings::rows::{Fit, RecordingRows, Role};
use crate::vocabulary::{Family, OwnFriction};
use aurt_recording::median;
use aurt_traits::{ColumnGroup, RobotModel};

impl Parts<'_> {
    /// Contacts of at least `shortest_s`, and what is selected without their windows, which are left out of `rows`. A
    /// contact has to be found again beside that: physics that the window had hidden may explain it.
    pub(super) fn with_contacts(
        &mut self,
        rows: &mut FitRows,
        selected: Selected,
        shortest_s: f64,
        progress: &mut impl FnMut(&str),
    ) -> Result<(Vec<Contact>, Selected), DiagnosisError> {
        let lasts = |c: &Contact| c.window_s[1] - c.window_s[0] > shortest_s;
        let mut found = self.contacts(rows, &selected)?;
        found.retain(lasts);
        if found.is_empty() {
            return Ok((found, selected));
        }
        let untouched = rows.clone();
        self.leave_out(rows, &found);
        let after = self.select(rows, progress);
        let mut again = self.contacts(&untouched, &after)?;
        again.retain(lasts);
        again.retain(|c| found.iter().any(|f| f.meets(c)));
        if again.len() == found.len() {
            return Ok((found, after));
        }
        *rows = untouched;
        found.retain(|f| again.iter().any(|c| f.meets(c)));
        self.leave_out(rows, &found);
        let selected = self.select(rows, progress);
        Ok((found, selected))
    }

    fn leave_out(&self, rows: &mut FitRows, contacts: &[Contact]) {
        for contact in contacts {
            let origin_s = self.question.recordings[contact.recording].origin_s();
            let [from, to] = contact.window_s.map(|t| t + origin_s);
            rows[contact.recording].leave_out([from - ALONE_S, to + ALONE_S]);
        }
    }

    /// Contacts in the recordings that are not for validation, while the arm moves, after all that was selected.
    pub(super) fn contacts(
        &self,
        rows: &[RecordingRows],
        selected: &Selected,
    ) -> Result<Vec<Contact>, DiagnosisError> {
        let asked: Vec<usize> = (0..rows.len()).filter(|r| rows[*r].rows() > 0).collect();
        let body = self.question.model.rigid_body();
        let mut searched = Vec::new();
        for r in &asked {
            let left = residuals(
                &rows[*r],
                self.layout,
                &selected.fitted.switches,
                &selected.fitted.fit.coefficients,
            );
            let out: Vec<Vec<bool>> =
                rows[*r].joints.iter().map(|j| j.counts.iter().map(|counts| !counts).collect()).collect();
            searched.push((left, out, force_columns(&**body, &rows[*r])?));
        }
        let views: Vec<ContactRows<'_>> = asked
            .iter()
            .zip(&searched)
            .map(|(r, (residual, left_out, forces))| ContactRows {
                rows: &rows[*r],
                origin_s: self.question.recordings[*r].origin_s(),
                residual,
                forces,
                left_out,
            })
            .collect();
        let mut found = find_contacts(&views, &ContactOptions::new(self.question.f_dyn_hz));
        for contact in &mut found {
            contact.recording = asked[contact.recording];
        }
        Ok(found)
    }

    /// Contacts while the arm stands: what its friction cannot hold against the rigid bodies' torque.
    pub(super) fn standing_contacts(
        &self,
        model: &RobotModel,
        baseline: &Baseline,
        moving: &[RecordingRows],
        selected: &Selected,
    ) -> Result<Vec<Contact>, DiagnosisError> {
        let mut found = Vec::new();
        let fit = selected.problem.fit(&selected.fitted.switches, &vec![1.0; selected.problem.joints()]);
        let left_rms: Vec<f64> = (0..selected.problem.joints())
            .map(|j| {
                let squares = fit.squared_errors[0][j] + fit.squared_errors[1][j];
                (squares / selected.problem.rows(j, false).max(1.0)).max(self.floor[j]).sqrt()
            })
            .collect();
        let load = extended_load(baseline, self.question.model, model);
        let own =
            Fit { model: self.question.model, load: &baseline.load, coefficients: &baseline.coefficients };
        // Friction of the fit, or of the given model where that was not fitted.
        let mut coefficients = baseline.coefficients.clone();
        for (switch, value) in selected.fitted.switches.iter().zip(&selected.fitted.fit.coefficients) {
            if switch.column < coefficients.len() && !switch.target_only && !baseline.frozen {
                coefficients[switch.column] = *value;
            }
        }
        for (r, recording) in self.question.recordings.iter().enumerate() {
            let (name, data) = (&recording.data.name, &recording.data.data);
            if recording.role == Role::Validation || recording.simulated.is_some() {
                continue;
            }
            // Beside a given model all recordings are targets.
            let role = moving[r].role;
            let at_rest = self.at_rest(model, selected, &coefficients, role);
            // Rows of all columns are what a diagnosis holds most of; these need few.
            let wanted = |c: usize| {
                c >= self.layout.first_instrument || at_rest.get(c).is_some_and(|value| *value != 0.0)
            };
            let standing = RecordingRows::evaluate_standing(name, role, data, (model, &load), &own, &wanted)?;
            let Some(mut standing) = standing else { continue };
            let end = self.partition.end_of_fit[r].min(standing.rows());
            let stands = |k: usize| standing.joints.iter().all(|j| j.counts[k]);
            if !(0..end).any(stands) {
                continue;
            }
            let mut residual = Vec::with_capacity(standing.joints.len());
            for (joint, columns) in standing.joints.iter_mut().zip(&self.layout.rows) {
                let columns = columns.iter().filter(|c| wanted(**c));
                let mut left = joint.residual(columns.map(|c| at_rest.get(*c).copied().unwrap_or(0.0)));
                left.truncate(end);
                residual.push(left);
                joint.data = Vec::new();
            }
            let rows = standing.part(0..end);
            // Laws that were selected beside the model's own level take part of it over, and hold at rest as well.
            let level = |j: usize, of: &[f64]| OwnFriction::of(self.question.model, j, of).coulomb_nm;
            let friction_nm: Vec<f64> = (0..rows.joints.len())
                .map(|j| {
                    let selected =
                        level(j, &coefficients) + self.creeping_friction(moving, selected, j, role);
                    selected.max(level(j, &baseline.coefficients)).max(0.0)
                })
                .collect();
            let forces = force_columns(&**self.question.model.rigid_body(), &rows)?;
            let view = StandingRows {
                rows: &rows,
                origin_s: self.question.recordings[r].origin_s(),
                residual: &residual,
                forces: &forces,
                friction_nm: &friction_nm,
                left_rms: &left_rms,
                margin_s: 0.5 / self.question.f_dyn_hz,
            };
            found.extend(
                find_standing_contacts(&view).into_iter().map(|contact| Contact { recording: r, ..contact }),
            );
        }
        Ok(found)
    }

    /// Torque by which the friction that was selected brakes a joint in its slowest tenth of rows, the median over recordings of a role:
    /// as much holds at rest, whichever law it is. 0 without such friction.
    fn creeping_friction(
        &self,
        rows: &[RecordingRows],
        selected: &Selected,
        joint: usize,
        role: Role,
    ) -> f64 {
        let chosen = selected.selection.chosen.iter().map(|c| &selected.groups[c.group]);
        let laws: Vec<&Switch> = chosen.filter(|g| g.effect.is_friction).flat_map(|g| &g.switches).collect();
        let of_law =
            |switch: &Switch| laws.contains(&switch) && (!switch.target_only || role == Role::Target);
        let fitted = selected.fitted.switches.iter().zip(&selected.fitted.fit.coefficients);
        let place = |switch: &Switch| self.layout.rows[joint].iter().position(|c| *c == switch.column);
        let columns: Vec<(usize, f64)> =
            fitted.filter(|(s, _)| of_law(s)).filter_map(|(s, value)| Some((place(s)?, *value))).collect();
        let mut braking: Vec<[f64; 2]> = Vec::new();
        for joint in rows.iter().filter(|r| r.role == role).map(|r| &r.joints[joint]) {
            for (k, v) in joint.velocity_rad_s.iter().enumerate().filter(|(k, _)| joint.counts[*k]) {
                let torque: f64 = columns.iter().map(|(c, value)| value * joint.column(*c)[k]).sum();
                braking.push([v.abs(), torque * v.signum()]);
            }
        }
        braking.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut slowest: Vec<f64> = braking[..braking.len().div_ceil(10)].iter().map(|b| b[1]).collect();
        if slowest.is_empty() { 0.0 } else { median(&mut slowest) }
    }

    /// Coefficients of the torque of an arm that stands: rigid bodies, loads, springs and offsets, no friction.
    fn at_rest(&self, model: &RobotModel, selected: &Selected, baseline: &[f64], role: Role) -> Vec<f64> {
        let mut at_rest = vec![0.0; self.layout.coefficients];
        let rigid = model.group(ColumnGroup::RigidBody);
        for column in rigid.clone().filter(|c| *c < baseline.len()) {
            at_rest[column] = baseline[column];
        }
        let still = |switch: &&Switch| {
            let mut groups = selected.selection.chosen.iter().map(|c| &selected.groups[c.group]);
            groups.any(|g| matches!(g.effect.family, Family::I | Family::P) && g.switches.contains(switch))
        };
        for (switch, value) in selected.fitted.switches.iter().zip(&selected.fitted.fit.coefficients) {
            if still(&switch) && (!switch.target_only || role == Role::Target) {
                at_rest[switch.column] += value;
            }
        }
        at_rest
    }
}
