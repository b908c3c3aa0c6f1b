//! Findings for contacts with the surroundings.

use aurt_calibration::with_deviation;
use serde_json::Value;

use crate::contact::{Contact, ContactOptions};
use crate::effects::external_contact;
use crate::investigation::Investigation;
use crate::parameters::{ParameterValue, Parameters};
use crate::recordings::rows::Role;
use crate::request::Question;
use crate::verdict::confidence::confidence;
use crate::verdict::{Evidence, Finding};

/// Findings for contacts with the surroundings.
pub(crate) fn contact_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
    let threshold = ContactOptions::new(question.f_dyn_hz).score;
    let names = question.names();
    let one = |contact: &Contact| {
        let recording = &question.recordings[contact.recording];
        let kind = if recording.role == Role::Target { "target" } else { "calibration" };
        let [from, to] = contact.window_s;
        Finding {
            present_in: vec![kind.to_owned()],
            recording: Some(recording.data.name.clone()),
            window_s: Some(contact.window_s),
            parameters: Parameters::from([
                ("link".to_owned(), ParameterValue::exact(contact.link)),
                (
                    "force_n".to_owned(),
                    ParameterValue::new(
                        contact.force_n,
                        contact.force_std_n.map_or(Value::Null, Value::from),
                    ),
                ),
                ("window_s".to_owned(), ParameterValue::exact(contact.window_s)),
            ]),
            sentence: format!(
                "a contact at {} from {from:.1} to {to:.1} s of {}, felt by {} (force_n = {} in the base frame)",
                names.link(contact.link),
                recording.data.name,
                names.joint_list(&contact.joints),
                force(contact)
            ),
            ..Finding::new(
                &external_contact::EFFECT,
                contact.joints.clone(),
                Evidence::of(contact.score, threshold),
                confidence(contact.score, false),
            )
        }
    };
    investigation.contacts.iter().map(one).collect()
}

/// The force with its deviation, axis by axis.
fn force(contact: &Contact) -> String {
    let axis = |k: usize| match contact.force_std_n {
        Some(std) => with_deviation(contact.force_n[k], std[k]),
        None => format!("{:.1}", contact.force_n[k]),
    };
    [0, 1, 2].map(axis).join(", ")
}
