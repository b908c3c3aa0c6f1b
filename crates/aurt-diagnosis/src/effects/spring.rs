//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct Spring;

impl Effect for Spring {
    fn id(&self) -> &'static str {
        "spring"
    }

    fn family(&self) -> Family {
        Family::P
    }

    fn title(&self) -> &'static str {
        "a spring that acts on the joint"
    }

    fn decider(&self) -> &'static str {
        "static poses over the whole range of the joint"
    }

    fn source(&self) -> &'static str {
        include_str!("spring.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        (0..context.joints)
            .map(|j| Proposal::on_joint(j, json!({"model":"spring","joints":[j]}), vec![true]))
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let _ = proposal;
        named(&["stiffness_nm_rad", "offset_nm"], fitted)
    }
}
