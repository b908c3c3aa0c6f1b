//! Findings for contacts with the surroundings.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::contact::{Contact, ContactOptions};
use crate::hypotheses::effects;
use crate::hypotheses::effects::ParameterValue;
use crate::investigation::Investigation;
use crate::recordings::rows::Role;
use crate::request::Question;
use crate::verdict::confidence::confidence;
use crate::verdict::sentence::joint_list;
use crate::verdict::{Evidence, Finding};

/// Findings for contacts with the surroundings.
pub(crate) fn contact_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
    let threshold = ContactOptions::new(question.f_dyn_hz).score;
    let one = |contact: &Contact| {
        let recording = &question.recordings[contact.recording];
        let kind = if recording.role == Role::Target { "target" } else { "calibration" };
        let [from, to] = contact.window_s;
        let number = |value: Value| ParameterValue { value, std: Value::Null };
        Finding {
            effect: "external_contact".to_owned(),
            family: effects::Family::X,
            joints: contact.joints.clone(),
            present_in: vec![kind.to_owned()],
            recording: Some(recording.data.name.clone()),
            window_s: Some(contact.window_s),
            confidence: confidence(contact.score, false),
            parameters: BTreeMap::from([
                ("link".to_owned(), number(json!(contact.link))),
                ("force_n".to_owned(), number(json!(contact.force_n))),
                ("window_s".to_owned(), number(json!(contact.window_s))),
            ]),
            alternatives: Vec::new(),
            evidence: Evidence { score: contact.score, threshold, ..Evidence::default() },
            stability: None,
            sentence: format!(
                "a contact at link {} of {} from {from:.1} to {to:.1} s, felt by {}",
                contact.link,
                recording.data.name,
                joint_list(&contact.joints)
            ),
        }
    };
    investigation.contacts.iter().map(one).collect()
}
