//! x
use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::*;

pub(super) struct TorqueRipple;

impl Effect for TorqueRipple {
    fn id(&self) -> &'static str {
        "torque_ripple"
    }

    fn family(&self) -> Family {
        Family::P
    }

    fn title(&self) -> &'static str {
        "torque ripple (a force that repeats with the joint angle)"
    }

    fn decider(&self) -> &'static str {
        "slow constant velocity over the joint's whole range"
    }

    fn source(&self) -> &'static str {
        include_str!("torque_ripple.rs")
    }

    fn proposals(&self, context: &Context<'_>) -> Vec<Proposal> {
        crate::periodogram::orders(context)
            .into_iter()
            .map(|(j, order)| {
                Proposal::on_joint(
                    j,
                    json!({"model":"torque_ripple","joints":[j],"cycles_per_revolution": order}),
                    vec![],
                )
                .with("order", order)
            })
            .collect()
    }

    fn parameters(
        &self,
        proposal: &Proposal,
        fitted: &[(String, f64, f64)],
    ) -> BTreeMap<String, (Value, Value)> {
        let mut p: BTreeMap<String, (Value, Value)> = BTreeMap::new();
        if let [(_, a, sa), (_, b, sb), ..] = fitted {
            let amplitude = a.hypot(*b);
            p.insert("amplitude_nm".to_owned(), (json!(amplitude), json!(sa.hypot(*sb))));
        }
        p.extend(proposal.fixed.iter().map(|(k, v)| (k.clone(), (json!(v), Value::Null))));
        p
    }
}
