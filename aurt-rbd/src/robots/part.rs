use serde::{Deserialize, Serialize};

/// Which joints of a description move on its base; all others are fixed at zero.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Part {
    /// All.
    #[default]
    All,
    /// Those between the base and these links: one link gives a serial chain.
    Tips(Vec<String>),
    /// These, and those that follow them.
    Joints(Vec<String>),
}

impl From<Option<&str>> for Part {
    /// The chain to a tip; without one, all.
    fn from(tip: Option<&str>) -> Self {
        tip.map_or(Self::All, |tip| Self::Tips(vec![tip.to_owned()]))
    }
}
