//! What can be checked only when the number of joints is known.

use std::collections::BTreeSet;

use aurt_plugins::{BuildError, Node, Span};
use aurt_traits::ArmTerm;

use super::errors::Complaint;

#[derive(Debug)]
pub(super) enum JointCheck {
    Length {
        key: String,
        found: usize,
        span: Span,
    },
    Joint {
        joint: usize,
        span: Span,
    },
    /// An arm term that must fit the robot.
    ArmTerm {
        term: Box<dyn ArmTerm>,
        table: Node,
    },
}

impl JointCheck {
    /// What is wrong for a robot of `joints` joints and `links` links, which are more where joints follow others.
    pub(super) fn complaints(self, joints: usize, links: usize) -> Vec<Complaint> {
        match self {
            Self::Length { key, found, span } if found != joints => vec![Complaint::new(
                span,
                format!("`{key}` expects one entry per joint, so {joints}, found {found}"),
            )],
            Self::Joint { joint, span } if joint >= joints => {
                let last = joints.saturating_sub(1);
                vec![
                    Complaint::new(span, format!("there is no joint {joint}"))
                        .help(format!("joints count from 0; the robot has {joints}: 0 to {last}")),
                ]
            }
            Self::ArmTerm { term, table } => {
                let complaints = term.validate_on(joints, links).err().unwrap_or_default();
                BuildError::invalid(&table, complaints).into_iter().map(Complaint::from).collect()
            }
            Self::Length { .. } | Self::Joint { .. } => Vec::new(),
        }
    }
}

/// The joints that occur more than once.
pub(super) fn repeated(joints: &[usize]) -> BTreeSet<usize> {
    let mut seen = BTreeSet::new();
    joints.iter().copied().filter(|j| !seen.insert(*j)).collect()
}
