use aurt_diagnosis::{Answer, Verdict};

#[derive(Debug, Clone, Default)]
pub struct Claims {
    names: bool,
    /// Whether the verdict says that what is missing has no name.
    unexplained: bool,
    /// Whether it says that something is missing that has no name.
    leaves_something: bool,
    claims: Vec<(String, Vec<usize>)>,
}

impl Claims {
    pub fn of(verdict: &Verdict) -> Self {
        Self {
            names: matches!(verdict.verdict, Answer::Named | Answer::PartlyExplained),
            unexplained: verdict.verdict == Answer::Unexplained,
            leaves_something: !matches!(verdict.verdict, Answer::NoMismatch | Answer::Named),
            claims: verdict.effects.iter().map(|f| (f.effect.clone(), f.joints.clone())).collect(),
        }
    }

    /// The same with a further claim; `named` says whether the verdict names it.
    pub fn and(mut self, effect: &str, joints: Vec<usize>, named: bool) -> Self {
        self.claims.push((effect.to_owned(), joints));
        self.names = named;
        self
    }

    pub const fn is_unexplained(&self) -> bool {
        self.unexplained
    }

    /// Whether an effect is claimed, on a joint if one is given, whatever the verdict.
    pub fn lists(&self, effect: &str, joint: Option<usize>) -> bool {
        self.claims.iter().any(|(name, joints)| name == effect && joint.is_none_or(|j| joints.contains(&j)))
    }

    pub fn names(&self, effect: &str, joint: Option<usize>) -> bool {
        self.names && self.lists(effect, joint)
    }

    /// Whether more is claimed than of the recordings as they are: at the joint, or, of the arm, anywhere.
    pub fn exceeds(&self, reference: &Self, joint: Option<usize>) -> bool {
        let new = |(name, joints): &(String, Vec<usize>)| {
            let here: Vec<usize> = joints.iter().copied().filter(|j| joint.is_none_or(|k| k == *j)).collect();
            (joint.is_none() && joints.is_empty() && !reference.lists(name, None))
                || here.iter().any(|j| !reference.lists(name, Some(*j)))
        };
        self.leaves_something && !reference.leaves_something || self.claims.iter().any(new)
    }
}
