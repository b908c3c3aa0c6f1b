use std::path::Path;

use aurt_traits::{ColumnGroup, RobotModel};

/// In which recordings each arm term acts: a payload that one recording carries and another does not.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct TermScopes(Vec<Option<Vec<String>>>);

impl TermScopes {
    /// Every term in every recording.
    pub const fn everywhere() -> Self {
        Self(Vec::new())
    }

    /// For each arm term the names of its recordings, or `None` for all.
    pub const fn new(recordings: Vec<Option<Vec<String>>>) -> Self {
        Self(recordings)
    }

    /// Whether an arm term acts in a recording; names are compared whole or by their last part.
    pub fn acts(&self, term: usize, recording: &str) -> bool {
        let last = |name: &str| Path::new(name).file_name().map(|n| n.to_string_lossy().into_owned());
        self.0.get(term).and_then(Option::as_ref).is_none_or(|names| {
            names.iter().any(|n| n == recording || (last(n).is_some() && last(n) == last(recording)))
        })
    }

    /// Whether each coefficient of a model acts in a recording.
    pub fn acting(&self, model: &RobotModel, recording: &str) -> Vec<bool> {
        let mut acting = vec![true; model.parameters().len()];
        for (group, columns) in model.groups() {
            if let ColumnGroup::ArmTerm(k) = group {
                acting[columns.clone()].fill(self.acts(*k, recording));
            }
        }
        acting
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_compared_by_their_last_part() {
        let scopes = TermScopes::new(vec![None, Some(vec!["data/loaded.csv".into()])]);
        assert!(scopes.acts(0, "anything.csv") && scopes.acts(1, "loaded.csv") && scopes.acts(7, "x"));
        assert!(!scopes.acts(1, "empty.csv"));
    }
}
