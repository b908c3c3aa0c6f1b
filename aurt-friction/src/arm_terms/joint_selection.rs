//! The `joints` key of arm terms that act on each joint by itself.

use aurt_traits::{Columns, ModelError, Parameter};
use serde::{Deserialize, Serialize};

/// The joints that a term acts on, each with coefficients of its own; all of the robot's unless listed.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct JointSelection(Option<Vec<usize>>);

impl JointSelection {
    /// Every joint of the robot.
    pub const fn all() -> Self {
        Self(None)
    }

    /// The listed joints, counted from 0.
    pub const fn of(joints: Vec<usize>) -> Self {
        Self(Some(joints))
    }

    /// Whether no list was given.
    pub const fn is_all(&self) -> bool {
        self.0.is_none()
    }

    /// The joints, ascending, of a robot of `robot_joints` joints.
    pub fn resolve(&self, robot_joints: usize) -> Vec<usize> {
        let Some(list) = &self.0 else { return (0..robot_joints).collect() };
        let mut joints = list.clone();
        joints.sort_unstable();
        joints.dedup();
        joints
    }

    /// Every complaint about the list, in the name of `model`.
    pub(crate) fn complaints(&self, model: &str, robot_joints: usize) -> Vec<ModelError> {
        let Some(list) = &self.0 else { return Vec::new() };
        let complaint = |reason| ModelError::parameter(model, "joints", reason);
        if list.is_empty() {
            return vec![complaint("must not be empty; leave the key out for all joints".into())];
        }
        let mut complaints = Vec::new();
        for (k, joint) in list.iter().enumerate() {
            if *joint >= robot_joints {
                let last = robot_joints.saturating_sub(1);
                complaints.push(complaint(format!(
                    "must lie between 0 and {last} (joints count from 0), contain {joint}"
                )));
            }
            if list[..k].contains(joint) {
                complaints.push(complaint(format!("must be distinct, contain {joint} twice")));
            }
        }
        complaints
    }

    /// The columns of every joint: the given (symbol, unit) pairs with the joint's number appended.
    pub(crate) fn columns(&self, robot_joints: usize, symbols: &[(&str, &str)]) -> Vec<Parameter> {
        self.resolve(robot_joints)
            .iter()
            .flat_map(|j| symbols.iter().map(move |(s, unit)| Parameter::new(format!("{s}_{j}"), *unit)))
            .collect()
    }

    /// Whether `column` belongs to `joint` when every joint has `per_joint` columns.
    pub(crate) fn owns(&self, robot_joints: usize, per_joint: usize, column: usize, joint: usize) -> bool {
        self.resolve(robot_joints).get(column / per_joint.max(1)) == Some(&joint)
    }

    /// Lets `write` fill the `per_joint` columns that each joint has in its own row, given the joint's place in
    /// the list and its number, and fills the others with zeros.
    pub(crate) fn write_own_rows(
        &self,
        robot_joints: usize,
        per_joint: usize,
        out: &mut Columns<'_>,
        mut write: impl FnMut(usize, usize, &mut Columns<'_>),
    ) {
        let joints = self.resolve(robot_joints);
        let (samples, row) = (out.samples(), joints.len() * per_joint);
        let (data, stride) = out.raw_mut();
        for (i, joint) in joints.iter().enumerate() {
            for column in 0..row {
                let start = (i * row + column) * stride;
                data[start..start + samples].fill(0.0);
            }
            let own = (i * row + i * per_joint) * stride;
            write(i, *joint, &mut Columns::new(&mut data[own..], per_joint, samples, stride));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_rows_are_a_diagonal_of_blocks() {
        let mut data = vec![9.0; 4 * 2 * 3];
        let mut out = Columns::new(&mut data, 8, 2, 3);
        JointSelection::of(vec![3, 1]).write_own_rows(5, 2, &mut out, |_, joint, own| {
            for k in 0..2 {
                own.column_mut(k).fill((10 * joint + k) as f64);
            }
        });
        let first: Vec<f64> = (0..8).map(|k| out.column(k)[0]).collect();
        assert_eq!(first, [10.0, 11.0, 0.0, 0.0, 0.0, 0.0, 30.0, 31.0]);
    }

    #[test]
    fn lists_are_checked_against_the_robot() {
        assert!(JointSelection::all().complaints("m", 6).is_empty());
        assert_eq!(JointSelection::of(vec![6, 1, 1]).complaints("m", 6).len(), 2);
        assert_eq!(JointSelection::of(Vec::new()).complaints("m", 6).len(), 1);
    }
}
