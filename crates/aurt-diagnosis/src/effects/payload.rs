//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct Payload;

impl Effect for Payload {
    fn id(&self) -> &'static str {
        "payload"
    }

    fn family(&self) -> Family {
        Family::I
    }

    fn title(&self) -> &'static str {
        "a load attached to a link"
    }

    fn decider(&self) -> &'static str {
        "the same motion without the load, as calibration recording"
    }

    fn source(&self) -> &'static str {
        include_str!("payload.rs")
    }

    fn whole_arm(&self) -> bool {
        true
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|link| {
                Proposal {
                    joints: (0..context.joints).collect(),
                    addition: Addition::Term(json!({"model":"payload","link":link})),
                    nonnegative: vec![],
                    presence: Presence::Change,
                    fixed: BTreeMap::new(),
                }
                .with("link", link as f64)
            })
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let mut p: BTreeMap<String, (Value, Value)> = BTreeMap::new();
        let find = |wanted: &str| {
            fitted.iter().find(|(n, _, _)| n.split('_').next() == Some(wanted)).map(|(_, v, s)| (*v, *s))
        };
        if let Some((mass, std)) = find("m") {
            p.insert("mass_kg".to_owned(), (json!(mass), json!(std)));
            let com = ["mX", "mY", "mZ"].map(|n| find(n).unwrap_or((0.0, 0.0)));
            p.insert("com_m".to_owned(), (json!(com.map(|c| c.0 / mass)), json!(com.map(|c| c.1 / mass))));
            let inertia = ["XX", "XY", "XZ", "YY", "YZ", "ZZ"].map(|n| find(n).unwrap_or((0.0, 0.0)));
            p.insert("inertia_kg_m2".to_owned(), (json!(inertia.map(|c| c.0)), json!(inertia.map(|c| c.1))));
        }
        p.extend(proposal.fixed.iter().map(|(k, v)| (k.clone(), (json!(v), Value::Null))));
        p
    }
}
