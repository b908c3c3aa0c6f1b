//! From an investigation to a verdict.

use std::collections::BTreeMap;

use crate::evidence::account::STRUCTURE;
use crate::evidence::baseline::weighted_fit;
use crate::evidence::residuals::residuals;
use crate::evidence::total::TotalFit;
use crate::hypotheses::group::Switch;
use crate::investigation::{Fitted, Investigation};
use crate::recordings::rows::{RecordingRows, Role};
use crate::remainder::{Residual, Rest, remainders};
use crate::request::{Question, QuestionedRecording, SelectionOptions};
use crate::transmission::VisibleGear;
use crate::verdict::answer::answers;
use crate::verdict::contacts::contact_findings;
use crate::verdict::errors::Errors;
use crate::verdict::faults::fault_findings;
use crate::verdict::findings::{delay_finding, findings, indications};
use crate::verdict::held_out::{
    beyond_noise, differences, errors as errors_on_held_out, uncertainty, usual_friction,
};
use crate::verdict::not_examined::not_examined;
use crate::verdict::transmission::{is_gear_hinted, shaking_findings, shaking_indications};
use crate::verdict::{
    Answer, JointResidual, NotDecidable, SCHEMA, Shift, Verdict, localise, memory, registered,
};
use crate::vocabulary::{Effect, Means, Presence};
use aurt_traits::{ColumnGroup, MeasurementUnit, RigidBodyRegressor};

pub fn verdict(question: &Question<'_>, investigation: &Investigation) -> Verdict {
    let fitted = Fitted::new(investigation, investigation.switches());
    let (all, fit) = (&fitted.switches, &fitted.fit);
    let baseline = (
        &investigation.base_switches,
        weighted_fit(&investigation.problem, &investigation.base_switches, &investigation.floor).0,
    );
    let mut effects = findings(question, investigation, &fitted);
    effects.extend(delay_finding(question, investigation));
    let mut residual = joint_residuals(investigation, all, fit, baseline.0, &baseline.1);
    let mut held_out = errors_on_held_out(investigation, all, fit);
    if let Some(late) = &investigation.late {
        let before = &late.before;
        let own = &before.base_switches;
        let first = weighted_fit(&before.problem, own, &before.floor).0;
        for (now, then) in residual.iter_mut().zip(joint_residuals(before, own, &first, own, &first)) {
            now.baseline_rms = then.baseline_rms;
        }
        held_out.rms_before = errors_on_held_out(before, own, &first).rms_before;
    }
    if let Some(before) = &investigation.before_gears {
        for (now, then) in residual.iter_mut().zip(&before.baseline_rms) {
            now.baseline_rms = *then;
        }
        held_out.rms_before.clone_from(&before.held_out_rms);
    }
    let faults = fault_findings(question, investigation);
    let touched = contact_findings(question, investigation);
    let shaking = shaking_findings(question, investigation);
    let registered_models = registered::findings(question, investigation, &fitted);
    // What shakes is no part of the model: its joints' rows say nothing of how much else accounts for.
    let apart: Vec<usize> = shaking.iter().flat_map(|f| f.joints.iter().copied()).collect();
    let targets = question.recordings.iter().any(|r| r.role == Role::Target);
    let fitting: Vec<&RecordingRows> = investigation.rows.iter().collect();
    let left: Vec<Vec<Vec<f64>>> =
        fitting.iter().map(|r| residuals(r, &investigation.layout, all, &fit.coefficients)).collect();
    let own = (&*investigation.base_switches, &*investigation.baseline.coefficients);
    let full = (&**all, &*fit.coefficients);
    let fitted_rests = rests(investigation, &investigation.rows, own, full);
    let held_rests = rests(investigation, investigation.confirm.to_judge(), own, full);
    let has_claims = investigation.selection.chosen.iter().any(|c| c.withheld.is_none());
    let (mut remainder, explained) = remainders(&fitted_rests, &held_rests, has_claims, question.names());
    if let Some(given) = &investigation.problem.given {
        let off = given.rms(investigation.confirm.to_judge(), &investigation.layout);
        let judged = remainder.into_iter().zip(off).zip(&held_out.rms_after);
        remainder = judged.map(|((of_trees, off), rms)| of_trees.against(off, *rms)).collect();
    }
    for (joint, of_trees) in residual.iter_mut().zip(&remainder) {
        let follows = of_trees.follows.first().filter(|_| of_trees.rest == Rest::Something);
        joint.follows = follows.map(|f| f.feature.clone());
        joint.follows_share =
            joint.follows.as_ref().and(of_trees.predictable).map_or(0.0, |share| share.value);
    }
    let louder = memory::factors(&residual, &fitting, &left);
    for ((joint, factor), of_trees) in residual.iter_mut().zip(&louder).zip(&remainder) {
        joint.structure_left = joint.structure_left && *factor <= 1.0 || of_trees.rest == Rest::Something;
    }
    let errors = Errors::new((investigation, &fitted), targets, &apart, &louder);
    effects.extend(shaking.into_iter().chain(touched));
    effects.sort_by(|a, b| b.evidence.score.total_cmp(&a.evidence.score));
    // A fault that makes no difference stands behind physics that does.
    let place = if investigation.faults_matter { 0 } else { effects.len() };
    effects.splice(place..place, faults);
    // Changes come first, as in the headline.
    effects.sort_by_key(|e| targets && e.present_in.iter().any(|kind| kind != "target"));
    // What the targets alone keep says nothing of the others.
    let is_structure = |j: usize| !apart.contains(&j) && !errors.is_of_targets(j);
    let something = effects.is_empty() && is_gear_hinted(question, investigation)
        || residual.iter().any(|r| r.structure_left && is_structure(r.joint));
    let answered = |something| answers(investigation, &effects, &registered_models, &errors, something);
    let (mut answer, mut structure) = answered(something);
    let uncertain = uncertainty(investigation, &fitted);
    let held_out_differs = differences((investigation, &fitted), &uncertain, &residual, &held_out, &apart);
    if answer == Answer::NoMismatch && !held_out_differs.is_empty() {
        answer = Answer::HeldOutDiffers;
    } else if [answer, structure.unwrap_or(answer)].iter().all(|a| *a == Answer::NoMismatch) {
        // A disturbance of all fitted rows is in their noise, and not in that of held-out ones.
        let usual = usual_friction(investigation, &fitted);
        let expected: Vec<f64> =
            uncertain.iter().zip(usual).map(|(of_fit, friction)| of_fit + friction).collect();
        let beyond = beyond_noise(&expected, &residual, &held_out, &apart);
        residual.iter_mut().for_each(|r| r.structure_left |= beyond.contains(&r.joint));
        (answer, structure) = answered(!beyond.is_empty());
    }
    let mut verdict = Verdict {
        schema: SCHEMA,
        settings: SelectionOptions { f_dyn_hz: Some(question.f_dyn_hz), ..question.selection },
        unit: question.unit,
        gears_visible: visible_beside(
            &**question.model.rigid_body(),
            &residual,
            &investigation.gears_visible,
        ),
        joint_names: question.names().joints.to_vec(),
        link_names: question.names().links.to_vec(),
        verdict: answer,
        structure,
        effects,
        indications: shaking_indications(question, investigation)
            .into_iter()
            .chain(indications(question, investigation))
            .collect(),
        registered_models,
        not_decidable: not_decidable(question, investigation),
        not_examined: not_examined(question, investigation),
        residual,
        held_out,
        held_out_differs,
        explained,
        remainder,
        shifts: shifts(investigation, &fitted, &baseline.1),
        warnings: Vec::new(),
        notes: Vec::new(),
    };
    verdict.notes.extend(investigation.faults.iter().filter(|f| !f.suffices).map(|f| f.sentence.clone()));
    verdict.notes.extend(question.recordings.iter().filter_map(left_out));
    if let Some(asked_hz) = question.selection.f_dyn_hz.filter(|asked_hz| *asked_hz > question.f_dyn_hz) {
        verdict.notes.push(format!(
            "f_dyn is {} Hz where {asked_hz} Hz was asked for: above, noise of the positions biases inertias and looks like delays",
            question.f_dyn_hz
        ));
    }
    if question.unit == MeasurementUnit::Ampere {
        let scale = question.scale.map_or_else(
            || "differing torque constants of the drives resemble losses and gain errors".to_owned(),
            |scale| scale.note(question.names()),
        );
        verdict.notes.push(format!(
            "the model is in A: forces, torques, masses and stiffnesses are divided by torque constants, also where their unit is \
             given as N, Nm or kg; {scale}. Set `torque_constants_nm_per_a` in [robot] to obtain torques; `aurt gains` measures them \
             with a load of known mass"
        ));
    }
    verdict.notes.extend(investigation.untried.iter().cloned());
    verdict.notes.extend(investigation.noise_notes.iter().cloned());
    let wandering: Vec<usize> = (0..louder.len()).filter(|joint| louder[*joint] > STRUCTURE).collect();
    if !wandering.is_empty() {
        verdict.notes.push(format!(
            "the residual of {} exceeds the noise measured above the filters but shows no pattern in any coordinate, time window \
             or frequency; it is treated as slow noise, which can hide an effect of that size",
            question.names().joint_list_with(&wandering, |joint| format!(" ({:.1} times)", louder[joint]))
        ));
    }
    for recording in question.recordings {
        let of_file = recording.raw.report.warnings();
        verdict.warnings.extend(of_file.map(|warning| format!("{}: {warning}", recording.data.name)));
    }
    if let Some(warning) = worse_on_held_out(&verdict) {
        verdict.warnings.push(warning);
    }
    if investigation.undetermined {
        verdict.notes.push(
            "the calibration recordings do not determine all parameters that the target motion needs: the model was fitted to both \
             together, which can hide a change; calibrate on motions of all joints"
                .into(),
        );
    }
    if question.recordings.iter().any(|r| r.simulated.is_some()) {
        verdict
            .notes
            .push("the reference is the prediction of another simulator; it was not refitted".into());
    } else if investigation.baseline.frozen {
        let deviations = match investigation.problem.given {
            Some(_) => "what their deviations allow counts as noise",
            None => "they have no known deviations and are taken as exact",
        };
        verdict.notes.push(format!(
            "the given model was used as it is: its coefficients were not refitted, and {deviations}"
        ));
    }
    verdict
}

/// The gears that would have shown: nothing is said of joints that keep something, nor of those that slide, whose gears are no
/// such angles and stiffnesses.
fn visible_beside(
    bodies: &dyn RigidBodyRegressor,
    residual: &[JointResidual],
    visible: &[VisibleGear],
) -> Vec<VisibleGear> {
    let is_open = |joint: usize| residual.iter().any(|r| r.joint == joint && r.structure_left);
    let beside = |gear: &VisibleGear| match is_open(gear.joint) || bodies.slides(gear.joint) {
        true => VisibleGear { joint: gear.joint, below_nm_rad: None, beyond_rad: None },
        false => *gear,
    };
    visible.iter().map(beside).collect()
}

/// That a long recording was looked at in stretches.
fn left_out(recording: &QuestionedRecording) -> Option<String> {
    let (raw, name) = (&recording.raw, &recording.data.name);
    let left_out: f64 = raw.report.left_out_s.iter().map(|[before, after]| after - before).sum();
    (left_out > 0.0).then(|| {
        let share = 100.0 * (1.0 - left_out / raw.duration_s());
        format!(
            "{name}: {} segments were examined, {share:.1} % of the recording",
            raw.report.left_out_s.len() + 1
        )
    })
}

/// A warning where the findings increase the held-out error on half of the joints: as a rule the held-out data show another
/// state of the robot than the targets.
fn worse_on_held_out(verdict: &Verdict) -> Option<String> {
    let held = &verdict.held_out;
    let grows = |(before, after): (&f64, &f64)| after / before;
    let ratios: Vec<f64> = held.rms_before.iter().zip(&held.rms_after).map(grows).collect();
    let worse = (0..ratios.len()).filter(|joint| held.is_worse(*joint)).count();
    let worst = (0..ratios.len()).max_by(|a, b| ratios[*a].total_cmp(&ratios[*b]))?;
    let found = !verdict.effects.is_empty() || !verdict.registered_models.is_empty();
    (2 * worse >= ratios.len() && found).then(|| {
        format!(
            "the findings increase the error on {} on {worse} of {} joints ({}: {:.3} before, {:.3} after). \
             Validation recordings are assumed to show the robot in the state of the targets; list one from before a change under \
             `calibration`. Without `validation` the last quarter of each target is held out",
            held.recordings.join(", "),
            ratios.len(),
            verdict.names().joint(worst),
            held.rms_before[worst],
            held.rms_after[worst],
        )
    })
}

/// Effects all of whose candidates the baseline absorbs, in every kind of recording in which they are tried.
/// Share of a candidate's torque that the model leaves of it where it is looked for; none for what ties two joints, for what is also found
/// by other means, and for registered models, of which nothing is said.
pub(crate) fn share_left(investigation: &Investigation, candidate: usize) -> Option<f64> {
    let free = investigation.free[candidate];
    let candidate = &investigation.candidates[candidate];
    let ties_joints = candidate.proposal.joints.len() > 1 && !candidate.effect.is_whole_arm;
    let by_columns = candidate.effect.means == Means::Columns && candidate.registered.is_none();
    (!ties_joints && by_columns).then(|| match candidate.proposal.presence {
        Presence::Change if investigation.problem.has_target() => free[1],
        Presence::Change => 0.0,
        Presence::Any | Presence::Structure => free[0].max(free[1]),
    })
}

fn not_decidable(question: &Question<'_>, investigation: &Investigation) -> Vec<NotDecidable> {
    let mut absorbed: BTreeMap<&'static str, (&'static Effect, BTreeMap<usize, f64>)> = BTreeMap::new();
    for (index, candidate) in investigation.candidates.iter().enumerate() {
        let effect = candidate.effect;
        let Some(share) = share_left(investigation, index) else { continue };
        let joint =
            if candidate.proposal.joints.len() > 1 { usize::MAX } else { candidate.proposal.joints[0] };
        let largest =
            absorbed.entry(effect.id).or_insert((effect, BTreeMap::new())).1.entry(joint).or_insert(0.0);
        *largest = largest.max(share);
    }
    let joints = question.model.joints();
    let mut found = Vec::new();
    for (effect, shares) in absorbed.into_values() {
        let hidden: Vec<(usize, f64)> =
            shares.into_iter().filter(|(_, s)| *s < question.selection.free_share).collect();
        if hidden.is_empty() {
            continue;
        }
        let largest = hidden.iter().map(|(_, s)| *s).fold(0.0, f64::max);
        let concerned = if hidden.iter().any(|(j, _)| *j == usize::MAX) {
            (0..joints).collect()
        } else {
            hidden.iter().map(|(j, _)| *j).collect()
        };
        found.push(NotDecidable {
            effect: effect.id.to_owned(),
            joints: concerned,
            absorbed: 1.0 - largest * largest,
            record: effect.decider.to_owned(),
        });
    }
    found
}

fn joint_residuals(
    investigation: &Investigation,
    all: &[Switch],
    fit: &TotalFit,
    base: &[Switch],
    base_fit: &TotalFit,
) -> Vec<JointResidual> {
    let rows: Vec<&RecordingRows> = investigation.rows.iter().filter(|r| r.rows() > 0).collect();
    let layout = &investigation.layout;
    let after: Vec<Vec<Vec<f64>>> =
        rows.iter().map(|r| residuals(r, layout, all, &fit.coefficients)).collect();
    let before: Vec<Vec<Vec<f64>>> =
        rows.iter().map(|r| residuals(r, layout, base, &base_fit.coefficients)).collect();
    (0..layout.rows.len())
        .map(|joint| {
            let counted: f64 = rows.iter().map(|r| r.joints[joint].counted(0, r.rows())).sum();
            let power = |parts: &[Vec<Vec<f64>>]| {
                let sum: f64 = parts.iter().flat_map(|p| &p[joint]).map(|r| r * r).sum();
                (sum / counted.max(1.0)).sqrt()
            };
            let floor_rms = investigation.floor[joint].sqrt();
            let unexplained_rms = power(&after);
            let structure_left = unexplained_rms > STRUCTURE * floor_rms;
            let windows_s = rows
                .iter()
                .zip(&after)
                .flat_map(|(r, residual)| localise::windows(r, joint, &residual[joint], floor_rms))
                .collect();
            JointResidual {
                joint,
                baseline_rms: power(&before),
                unexplained_rms,
                floor_rms,
                structure_left,
                follows_share: 0.0,
                follows: None,
                windows_s,
            }
        })
        .collect()
}

/// Rows with what two models leave of them, each of switches and coefficients.
fn rests<'r>(
    investigation: &'r Investigation,
    rows: &'r [RecordingRows],
    before: (&[Switch], &[f64]),
    after: (&[Switch], &[f64]),
) -> Vec<Residual<'r>> {
    let left =
        |rows, (switches, coefficients)| residuals(rows, &investigation.layout, switches, coefficients);
    let load = |rows: &RecordingRows| {
        (0..rows.joints.len()).map(|joint| rigid_body_load(investigation, rows, joint)).collect()
    };
    let of = |(rows, noise): (&'r RecordingRows, &'r Vec<f64>)| Residual {
        before: left(rows, before),
        after: left(rows, after),
        load_torque: load(rows),
        noise,
        rows,
    };
    rows.iter().zip(&investigation.floors).map(of).collect()
}

/// The rigid-body torque of the baseline at each row of a joint.
pub fn rigid_body_load(investigation: &Investigation, rows: &RecordingRows, joint: usize) -> Vec<f64> {
    let rigid = investigation.model.group(ColumnGroup::RigidBody);
    let mut load = vec![0.0; rows.rows()];
    for (k, column) in investigation.layout.rows[joint].iter().enumerate().filter(|(_, c)| rigid.contains(c))
    {
        let coefficient = investigation.baseline.coefficients.get(*column).copied().unwrap_or(0.0);
        for (l, value) in load.iter_mut().zip(rows.joints[joint].column(k)) {
            *l += coefficient * value;
        }
    }
    load
}

/// Parameters of the baseline that moved most, in standard deviations with the memory and the misfit of the residual.
fn shifts(investigation: &Investigation, fitted: &Fitted, base: &TotalFit) -> Vec<Shift> {
    let mut shifts: Vec<Shift> = (0..investigation.base_switches.len())
        .filter(|k| base.variance[*k].is_finite() && fitted.deviations[*k].is_finite())
        .map(|k| {
            let (before, after) = (base.coefficients[k], fitted.fit.coefficients[k]);
            Shift {
                parameter: investigation.model.parameters()[fitted.switches[k].column].name.clone(),
                before,
                after,
                in_std: (after - before).abs() / fitted.deviations[k].max(f64::MIN_POSITIVE),
            }
        })
        .filter(|s| s.in_std > 3.0)
        .collect();
    shifts.sort_by(|a, b| b.in_std.total_cmp(&a.in_std));
    shifts.truncate(12);
    shifts
}
