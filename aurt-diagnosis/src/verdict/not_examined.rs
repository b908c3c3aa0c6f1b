//! What could not be looked at in these recordings, and why.

use crate::effects::backlash;
use crate::investigation::Investigation;
use crate::recordings::rows::{RecordingRows, Role};
use crate::request::{Question, QuestionedRecording, length};
use crate::transmission::LEAST_RATE_HZ;
use crate::verdict::NotExamined;
use crate::verdict::answer::UNRELATED;

/// Joints at rest, recordings that are short or slow, and measurements that say nothing.
pub(crate) fn not_examined(question: &Question<'_>, investigation: &Investigation) -> Vec<NotExamined> {
    let mut found = constant(question, investigation);
    found.extend(beside(question));
    found.extend(standing(question, investigation));
    found.extend(resting(question, investigation));
    found.extend(short(investigation));
    found.extend(unrelated(question, investigation));
    found.extend(slow(question));
    found
}

fn constant(question: &Question<'_>, investigation: &Investigation) -> Vec<NotExamined> {
    let mut found: Vec<NotExamined> = Vec::new();
    for (r, recording) in question.recordings.iter().enumerate() {
        let own = investigation.constant.iter().filter(|(of, ..)| *of == r);
        let joints: Vec<usize> = own.map(|(_, joint, _)| *joint).collect();
        if !joints.is_empty() {
            let name = &recording.data.name;
            found.push(NotExamined {
                recording: Some(name.clone()),
                reason: format!(
                    "the measurement of {} is constant in {name}: nothing was measured, and no claim is made",
                    question.names().joint_list(&joints)
                ),
                joints,
                effects: Vec::new(),
            });
        }
    }
    found
}

/// Joints whose measurement contains a motion beside the chain.
fn beside(question: &Question<'_>) -> Vec<NotExamined> {
    let names = question.names();
    let of_recording = |recording: &QuestionedRecording| {
        let name = recording.data.name.clone();
        let branches = recording.raw.report.branches.clone();
        branches.into_iter().filter(|branch| branch.moves).map(move |branch| NotExamined {
            recording: Some(name.clone()),
            reason: format!(
                "{} moves beside the chain in {name}, and no claim is made on {} upstream of it",
                branch.joint,
                names.joint_list(&branch.upstream)
            ),
            joints: branch.upstream,
            effects: Vec::new(),
        })
    };
    question.recordings.iter().flat_map(of_recording).collect()
}

/// Joints that stand in all recordings of a kind.
fn standing(question: &Question<'_>, investigation: &Investigation) -> Vec<NotExamined> {
    let beside = |joint: usize| {
        question.recordings.iter().flat_map(|r| &r.raw.report.branches).any(|b| b.upstream.contains(&joint))
    };
    let constant = |joint: usize| investigation.constant.iter().any(|(_, j, _)| *j == joint) || beside(joint);
    let of_kind = |(role, name): (Role, &str)| {
        let rows: Vec<_> = investigation.rows.iter().filter(|r| r.role == role && r.rows() > 0).collect();
        let moves = |j: usize| rows.iter().any(|r| r.joints[j].counted(0, r.rows()) > 0.0);
        let joints: Vec<usize> =
            (0..investigation.layout.rows.len()).filter(|j| !moves(*j) && !constant(*j)).collect();
        (!rows.is_empty() && !joints.is_empty()).then(|| NotExamined {
            recording: None,
            reason: format!(
                "{} {} not move in the {name} recordings: a joint at rest shows neither friction nor inertia",
                question.names().joint_list(&joints),
                if joints.len() == 1 { "does" } else { "do" },
            ),
            joints,
            effects: Vec::new(),
        })
    };
    [(Role::Calibration, "calibration"), (Role::Target, "target")].into_iter().filter_map(of_kind).collect()
}

/// Joints that rest for long in the recordings in question.
fn resting(question: &Question<'_>, investigation: &Investigation) -> Option<NotExamined> {
    let asked = |role: Role| investigation.rows.iter().filter(move |r| r.role == role && r.rows() > 0);
    let (role, name) = if asked(Role::Target).next().is_some() {
        (Role::Target, "target")
    } else {
        (Role::Calibration, "calibration")
    };
    let joints: Vec<usize> = (0..investigation.layout.rows.len())
        .filter(|j| asked(role).any(|r| r.joints[*j].stands_long()))
        .collect();
    let of_recording =
        |r: &RecordingRows| joints.iter().map(|j| r.joints[*j].standing_share()).fold(0.0, f64::max);
    let most = asked(role).map(of_recording).fold(0.0, f64::max);
    (!joints.is_empty()).then(|| NotExamined {
        recording: None,
        reason: format!(
            "{} in up to {:.0} % of the {name} recordings, while at rest: there a force shows only beyond what friction holds",
            question.names().joint_list(&joints),
            100.0 * most
        ),
        joints,
        effects: Vec::new(),
    })
}

fn short(investigation: &Investigation) -> Vec<NotExamined> {
    let said = |r: usize| {
        let name = &investigation.rows[r].name;
        let reason = length::brief(&investigation.partition, r)?;
        Some(NotExamined {
            recording: Some(name.clone()),
            joints: Vec::new(),
            effects: Vec::new(),
            reason: format!("{name} {reason}"),
        })
    };
    (0..investigation.rows.len()).filter_map(said).collect()
}

fn unrelated(question: &Question<'_>, investigation: &Investigation) -> Option<NotExamined> {
    let predicted = investigation.predicted.iter().enumerate();
    let joints: Vec<usize> =
        predicted.filter(|(_, share)| share.is_some_and(|s| s < UNRELATED)).map(|(j, _)| j).collect();
    (!joints.is_empty()).then(|| NotExamined {
        recording: None,
        reason: format!(
            "the measurement of {} is hardly related to the motion: the model predicts less than {:.0} % of its held-out variance",
            question.names().joint_list(&joints),
            100.0 * UNRELATED
        ),
        joints,
        effects: Vec::new(),
    })
}

fn slow(question: &Question<'_>) -> Option<NotExamined> {
    let slow = |r: &QuestionedRecording| r.data.data.segments.iter().all(|s| s.rate_hz < LEAST_RATE_HZ);
    question.recordings.iter().filter(|r| r.role != Role::Validation).all(slow).then(|| NotExamined {
        recording: None,
        joints: Vec::new(),
        effects: question.considers(&backlash::EFFECT).then(|| backlash::EFFECT.id.to_owned()).into_iter().collect(),
        reason: format!(
            "gears that ring or have play were not examined: a sampling rate of at least {LEAST_RATE_HZ:.0} Hz is required"
        ),
    })
}
