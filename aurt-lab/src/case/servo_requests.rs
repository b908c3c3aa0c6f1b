use aurt_simulation::Random;

use super::plan::{Plan, SinglePlan};
use super::request::{CaseRequest, CaseType};
use super::servo::effect::names;
use crate::strength::Strength;

/// The cases of a plan, which may name effects of this world alone, in an order that reveals nothing.
pub(super) fn requests(plan: &Plan, seed: u64) -> Vec<CaseRequest> {
    let mut random = Random::labelled(seed, "servo plan");
    let named = |of: &SinglePlan, in_vocabulary: bool| -> Vec<&'static str> {
        names(in_vocabulary)
            .filter(|id| of.effects.is_empty() || of.effects.iter().any(|name| name == id))
            .collect()
    };
    let request = |effects: &[&str], case_type: CaseType, strength: Strength| CaseRequest {
        robot: "servo_arm".into(),
        case_type,
        effects: effects.iter().map(|id| (*id).to_owned()).collect(),
        strength,
    };
    let mut all = Vec::new();
    let kinds =
        [(&plan.singles, true, CaseType::Single), (&plan.unknown_effects, false, CaseType::UnknownEffect)];
    for (of, in_vocabulary, case_type) in kinds {
        let Some(of) = of else { continue };
        for id in named(of, in_vocabulary) {
            let trials = of.strengths.iter().flat_map(|s| std::iter::repeat_n(*s, of.trials));
            all.extend(trials.map(|strength| request(&[id], case_type, strength)));
        }
    }
    if let Some(pairs) = &plan.pairs {
        let mut known = named(&SinglePlan { effects: pairs.effects.clone(), ..SinglePlan::default() }, true);
        for _ in 0..if known.len() < 2 { 0 } else { pairs.count } {
            random.shuffle(&mut known);
            all.push(request(&known[..2], CaseType::Pair, pairs.strength));
        }
    }
    let nulls = plan.nulls.as_ref().map_or(0, |n| n.count);
    all.extend((0..nulls).map(|_| request(&[], CaseType::Null, Strength::Medium)));
    random.shuffle(&mut all);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_ask_for_every_effect_at_every_strength() {
        let all = requests(
            &Plan::parse("[singles]\n[unknown_effects]\n[nulls]\ncount = 3", "plan.toml").unwrap(),
            5,
        );
        assert_eq!(all.len(), 3 * names(true).chain(names(false)).count() + 3);
        let nameless = |r: &&CaseRequest| r.case_type == CaseType::UnknownEffect;
        assert!(all.iter().filter(nameless).all(|r| ["backlash", "supply_sag"].contains(&&*r.effects[0])));
        let pairs =
            Plan::parse("[singles]\neffects = [\"stribeck\"]\n[pairs]\ncount = 4", "plan.toml").unwrap();
        let all = requests(&pairs, 5);
        assert_eq!(all.iter().filter(|r| r.case_type == CaseType::Single).count(), 3);
        let mut two = all.iter().filter(|r| r.case_type == CaseType::Pair).map(|r| &r.effects);
        assert!(two.all(|e| e.len() == 2 && e[0] != e[1]));
    }
}
