use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::case_score::CaseScore;
use super::claim_set::ClaimDifference;
use super::share::Share;

/// Agreement of the verdicts on a case and on variants of it in which the robot is the same.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Invariance {
    /// Variants with the claims of the case as it is, over all variants and cases.
    pub same: Share,
    /// Claims of both, of those of a variant or its case; each joint is one.
    pub claims: Share,
    pub variants: BTreeMap<String, Share>,
    /// Pairs of halves of a reference with the same structural claims.
    pub halves: Share,
    /// Claims that appear or vanish.
    pub differences: Vec<VariantDifference>,
}

/// The claims by which a variant differs from its case, or the second half of a reference from the first.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct VariantDifference {
    pub case: String,
    /// The variant, or [`HALVES`].
    pub variant: String,
    pub claims: ClaimDifference,
}

/// Name of the pair of halves among variants.
pub const HALVES: &str = "halves";

impl Invariance {
    /// The agreement of some cases; none without a variant.
    pub fn of(scores: &[&CaseScore]) -> Option<Self> {
        let mut all = Self::default();
        for score in scores {
            for (variant, claims) in &score.variants {
                all.same.count(claims.is_none());
                all.claims.count += claims.common.count;
                all.claims.of += claims.common.of;
                all.variants.entry(variant.clone()).or_default().count(claims.is_none());
                all.note(&score.case, variant, claims);
            }
            if let Some(claims) = &score.halves {
                all.halves.count(claims.is_none());
                all.note(&score.case, HALVES, claims);
            }
        }
        (all.same.of + all.halves.of > 0).then_some(all)
    }

    fn note(&mut self, case: &str, variant: &str, claims: &ClaimDifference) {
        if !claims.is_none() {
            let (case, variant) = (case.to_owned(), variant.to_owned());
            self.differences.push(VariantDifference { case, variant, claims: claims.clone() });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::{Claim, score};

    #[test]
    fn variants_are_counted_each_for_itself() {
        let truth = serde_json::from_value(serde_json::json!({
            "case": "case_0001", "world": "clean", "seed": 1, "robot": "ur10e", "rotors": "geared",
            "case_type": "null", "strength": "medium", "effects": [], "noise_nm": [], "validation": [],
        }))
        .unwrap();
        let mut case = score(&truth, &Claim::failed(), None, None);
        assert_eq!(Invariance::of(&[&case]), None);
        let appears =
            ClaimDifference { appeared: vec!["spring on joint 1".into()], ..ClaimDifference::default() };
        case.variants.insert("half_rate".into(), ClaimDifference::default());
        case.variants.insert("degrees".into(), appears.clone());
        case.halves = Some(appears);
        let both = Invariance::of(&[&case, &case]).unwrap();
        assert_eq!((both.same, both.halves), (Share { count: 2, of: 4 }, Share { count: 0, of: 2 }));
        assert_eq!(both.variants["half_rate"], Share { count: 2, of: 2 });
        let differences: Vec<&str> = both.differences.iter().map(|d| d.variant.as_str()).collect();
        assert_eq!(differences, ["degrees", "halves", "degrees", "halves"]);
    }
}
