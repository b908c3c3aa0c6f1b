use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::claim::{Answer, Claim};
use super::news::whole_arm;
use super::share::Share;

/// The claims of a verdict as a set, to be compared with those of another verdict: effects on joints, in the targets alone
/// or in all recordings. Alternatives, indications and parameters are not part of it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClaimSet(BTreeSet<SingleClaim>);

/// An effect on a joint, or on the whole arm.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct SingleClaim {
    effect: String,
    joint: Option<usize>,
    is_change: bool,
}

impl ClaimSet {
    /// The claims of a verdict; a diagnosis without a verdict has a member of its own.
    pub fn of(claim: &Claim) -> Self {
        let mut set = BTreeSet::new();
        if claim.verdict == Answer::Failed {
            set.insert(SingleClaim { effect: Answer::Failed.name().into(), joint: None, is_change: false });
        }
        for claimed in &claim.effects {
            let on = |joint: Option<usize>| SingleClaim {
                effect: claimed.effect.clone(),
                joint,
                is_change: claimed.is_change(),
            };
            if whole_arm(&claimed.effect) || claimed.joints.is_empty() {
                set.insert(on(None));
            } else {
                set.extend(claimed.joints.iter().map(|j| on(Some(*j))));
            }
        }
        Self(set)
    }

    /// Whether the diagnosis gave no verdict.
    pub fn is_failed(&self) -> bool {
        self.0.iter().any(|one| one.effect == Answer::Failed.name())
    }

    #[must_use]
    pub fn structure(mut self) -> Self {
        self.0.retain(|one| !one.is_change);
        self
    }

    /// The difference from another set: claims that appear here, and those of the other that vanish.
    pub fn difference(&self, from: &Self) -> ClaimDifference {
        // What a diagnosis without a verdict would have claimed is unknown.
        let list = |of: &Self, other: &Self| {
            if other.is_failed() { Vec::new() } else { words(of.0.difference(&other.0)) }
        };
        ClaimDifference {
            appeared: list(self, from),
            vanished: list(from, self),
            common: Share { count: self.0.intersection(&from.0).count(), of: self.0.union(&from.0).count() },
        }
    }
}

fn words<'a>(claims: impl Iterator<Item = &'a SingleClaim>) -> Vec<String> {
    let mut joints: BTreeMap<(&str, bool), Vec<String>> = BTreeMap::new();
    for claim in claims {
        let of_effect = joints.entry((&claim.effect, claim.is_change)).or_default();
        of_effect.extend(claim.joint.map(|j| j.to_string()));
    }
    let one = |((effect, is_change), joints): (&(&str, bool), &Vec<String>)| {
        let place = match &joints[..] {
            [] => String::new(),
            [joint] => format!(" on joint {joint}"),
            joints => format!(" on joints {}", joints.join(", ")),
        };
        format!("{effect}{place}{}", if *is_change { " (change)" } else { "" })
    };
    joints.iter().map(one).collect()
}

#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClaimDifference {
    pub appeared: Vec<String>,
    pub vanished: Vec<String>,
    /// Claims of both verdicts, of those of either; each joint is one.
    pub common: Share,
}

impl ClaimDifference {
    pub fn is_none(&self) -> bool {
        self.appeared.is_empty() && self.vanished.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn set(effects: &[(&str, &[usize], &str)]) -> ClaimSet {
        let effects: Vec<Value> = effects
            .iter()
            .map(|(effect, joints, kind)| json!({ "effect": effect, "joints": joints, "present_in": [kind] }))
            .collect();
        let claim = Claim::parse(json!({ "verdict": "named", "effects": effects })).unwrap();
        ClaimSet::of(&claim)
    }

    #[test]
    fn sets_are_compared_by_effect_joint_and_presence() {
        let one = set(&[("spring", &[2, 1], "calibration"), ("payload", &[0, 1], "target")]);
        // Claims on joints may be together or apart, in any order; a load is the whole arm's.
        let apart = [("payload", &[3][..], "target"), ("spring", &[1], "all"), ("spring", &[2], "all")];
        assert!(one.difference(&set(&apart)).is_none());
        let other = set(&[("spring", &[2], "target"), ("payload", &[0], "target")]);
        let difference = other.difference(&one);
        assert_eq!(difference.appeared, ["spring on joint 2 (change)"]);
        assert_eq!(difference.vanished, ["spring on joints 1, 2"]);
        assert_eq!(difference.common, Share { count: 1, of: 4 });
        assert!(set(&[("payload", &[0], "target")]).structure().difference(&set(&[])).is_none());
        assert_eq!(ClaimSet::of(&Claim::failed()).difference(&set(&[])).appeared, ["failed"]);
        assert!(ClaimSet::of(&Claim::failed()).difference(&one).vanished.is_empty());
    }
}
