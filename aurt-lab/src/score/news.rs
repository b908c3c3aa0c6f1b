use super::claim::{Claim, ClaimedAlternative, ClaimedEffect, is_change};
use crate::case::{TrueEffect, Truth};
use crate::effects::kind;

/// Effects that no recording tells apart: beside a Coulomb level, friction that differs by direction is a constant
/// while the joint moves.
const CLASS: [&str; 2] = ["coulomb_asymmetry", "current_offset"];

/// Alternatives of a claim that count: a class has at most three names.
pub(super) const ALTERNATIVES: usize = 2;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Sameness {
    Strict,
    /// The same identifier, or one that no recording tells from it.
    Class,
}

impl Sameness {
    pub fn same(self, a: &str, b: &str) -> bool {
        a == b || self == Self::Class && CLASS.contains(&a) && CLASS.contains(&b)
    }
}

/// Whether an effect concerns the arm as a whole; what nobody knows is on joints.
pub(super) fn whole_arm(effect: &str) -> bool {
    kind(effect).is_ok_and(aurt_simulation::effects::EffectKind::whole_arm)
}

/// Something that is so whether or not a diagnosis says it: an undeclared background, or what is claimed of the same
/// recordings without the effects.
#[derive(Debug, Clone, Copy)]
struct Known<'a> {
    effect: &'a str,
    joints: &'a [usize],
    change: bool,
}

/// A claim that is no old one.
#[derive(Debug, Clone)]
pub(super) struct News<'a> {
    pub effect: &'a str,
    pub joints: Vec<usize>,
    /// Whether it is claimed of the later recordings alone.
    pub change: bool,
    /// What else it could be, as far as that counts.
    pub alternatives: &'a [ClaimedAlternative],
}

/// What is known of a case besides its effects.
#[derive(Debug, Clone)]
pub(super) struct Background<'a> {
    known: Vec<Known<'a>>,
}

impl<'a> Background<'a> {
    /// The undeclared background of a case, and what is claimed of its reference.
    pub fn new(truth: &'a Truth, reference: Option<&'a Claim>) -> Self {
        let undeclared = truth.background.iter().map(|b| Known {
            effect: &b.effect,
            joints: &b.joints,
            change: is_change(&b.present_in),
        });
        let claimed = reference.into_iter().flat_map(|r| &r.effects).map(|c| Known {
            effect: &c.effect,
            joints: &c.joints,
            change: c.is_change(),
        });
        Self { known: undeclared.chain(claimed).collect() }
    }

    /// What is known of an effect. Which recordings lost rows is a fact of each of them, and no change of the machine.
    fn of(&self, effect: &str, change: bool) -> impl Iterator<Item = &Known<'a>> {
        let anywhen = effect == "dropped_samples";
        self.known
            .iter()
            .filter(move |k| (anywhen || k.change == change) && Sameness::Class.same(k.effect, effect))
    }

    pub fn has_on(&self, effect: &str, change: bool, joint: usize) -> bool {
        self.of(effect, change).any(|k| k.joints.contains(&joint))
    }

    /// Whether an effect is known on all of some joints, or at all if it is the whole arm's or on no joint.
    pub fn has(&self, effect: &str, change: bool, joints: &[usize]) -> bool {
        if whole_arm(effect) || joints.is_empty() {
            return self.of(effect, change).next().is_some();
        }
        joints.iter().all(|j| self.has_on(effect, change, *j))
    }

    /// Whether an effect is known on one of some joints, whenever it is present.
    pub fn overlaps(&self, claim: &ClaimedEffect) -> bool {
        self.known.iter().any(|k| k.effect == claim.effect && meet(&claim.effect, k.joints, &claim.joints))
    }

    /// The claims that are news, in the verdict's order: neither the background's nor the reference's. A claim on
    /// several joints is one for each of them.
    pub fn news(&self, truth: &Truth, claim: &'a Claim) -> Vec<News<'a>> {
        claim.effects.iter().filter_map(|c| self.one(truth, &claim.effects, c)).collect()
    }

    fn one(&self, truth: &Truth, claims: &[ClaimedEffect], claim: &'a ClaimedEffect) -> Option<News<'a>> {
        let change = claim.is_change();
        let alternatives = &claim.alternatives[..claim.alternatives.len().min(ALTERNATIVES)];
        let same = Sameness::Class;
        let is_true = |joint: usize| {
            let named = |e: &TrueEffect, by: &ClaimedEffect| {
                same.same(&e.effect, &by.effect) && by.joints.contains(&joint)
            };
            // A name of the background speaks of the truth that it says would do as well, unless another claim does.
            let or = |e: &TrueEffect| {
                alternatives.iter().any(|a| same.same(&e.effect, &a.effect))
                    && !claims.iter().any(|c| named(e, c))
            };
            let here = |e: &TrueEffect| e.joints.contains(&joint) && (named(e, claim) || or(e));
            // A claim of all recordings does not speak of an effect that came with the later ones.
            let came_later = |e: &TrueEffect| is_change(&e.present_in) && !change;
            truth.effects.iter().any(|e| here(e) && !came_later(e))
        };
        let joints: Vec<usize> = if whole_arm(&claim.effect) {
            claim.joints.clone()
        } else {
            let names = alternatives.iter().map(|a| a.effect.as_str()).chain([claim.effect.as_str()]);
            let new = |j: &usize| is_true(*j) || !names.clone().any(|name| self.has_on(name, change, *j));
            claim.joints.iter().copied().filter(new).collect()
        };
        let of_truth = truth.effects.iter().any(|e| Sameness::Class.same(&e.effect, &claim.effect));
        let old = if whole_arm(&claim.effect) || claim.joints.is_empty() {
            !of_truth && self.has(&claim.effect, change, &[])
        } else {
            joints.is_empty()
        };
        (!old).then_some(News { effect: &claim.effect, joints, change, alternatives })
    }
}

/// The first claim of every effect.
pub(super) fn distinct<'n, 'a>(news: impl Iterator<Item = &'n News<'a>>) -> Vec<&'n News<'a>> {
    let mut first: Vec<&News<'_>> = Vec::new();
    for one in news {
        if !first.iter().any(|f| f.effect == one.effect) {
            first.push(one);
        }
    }
    first
}

/// Whether two claims of an effect can be the same: on the whole arm, or on a common joint.
pub(super) fn meet(effect: &str, a: &[usize], b: &[usize]) -> bool {
    whole_arm(effect) || a.is_empty() && b.is_empty() || a.iter().any(|j| b.contains(j))
}

impl News<'_> {
    /// Whether it is the effect, by its label or by an alternative where these count.
    pub fn is(&self, effect: &str, alternatives: bool, sameness: Sameness) -> bool {
        sameness.same(self.effect, effect)
            || alternatives && self.alternatives.iter().any(|a| sameness.same(&a.effect, effect))
    }

    pub fn joints_as(&self, effect: &str, sameness: Sameness) -> &[usize] {
        if sameness.same(self.effect, effect) {
            return &self.joints;
        }
        let alternative = self.alternatives.iter().find(|a| sameness.same(&a.effect, effect));
        alternative.map(|a| a.joints.as_slice()).filter(|j| !j.is_empty()).unwrap_or(&self.joints)
    }

    /// How many claims it is: one, or one for each joint.
    pub fn count(&self) -> usize {
        if whole_arm(self.effect) { 1 } else { self.joints.len().max(1) }
    }
}
