//! A filter of the instrument, which looks like elastic gears on several joints.
//!
//! Far below its corner, a second-order low-pass between motion and measurement adds c d²τ/dt² with one c for all joints
//! that it filters. So does an elastic gear, with c = M_jj/K_j: of several gears, whose inertias and stiffnesses differ,
//! no two have the same.

use crate::hypotheses::group::{Group, Switch};
use crate::search::selection::Selection;

/// On so many joints …
const FEWEST_JOINTS: usize = 3;
/// … coefficients that lie within this ratio of one another are one.
const WITHIN: f64 = 1.3;

/// Whether what was selected as elastic gears is a filter that several joints have in common.
pub(crate) fn is_common_filter(
    groups: &[Group],
    selection: &Selection,
    switches: &[Switch],
    coefficients: &[f64],
) -> bool {
    let mut elastic: Vec<f64> = selection
        .chosen
        .iter()
        .map(|c| &groups[c.group])
        .filter(|g| g.is_common_when_equal())
        .flat_map(|g| &g.switches)
        .filter_map(|own| switches.iter().position(|s| s == own).map(|k| coefficients[k]))
        .collect();
    elastic.sort_by(f64::total_cmp);
    elastic.windows(FEWEST_JOINTS).any(|of| of[0] > 0.0 && of[FEWEST_JOINTS - 1] < WITHIN * of[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::selection::Chosen;

    fn judged(coefficients: &[f64]) -> bool {
        let switch = |column| Switch { column, target_only: false, nonnegative: true };
        let group = |joint| Group {
            effect: "joint_elasticity",
            joints: vec![joint],
            candidate: joint,
            switches: vec![switch(joint)],
            accessory: Vec::new(),
        };
        let chosen = |group| Chosen {
            group,
            score: 20.0,
            threshold: 8.0,
            p_null: None,
            p_confirm: None,
            joint_loss: Vec::new(),
            rivals: Vec::new(),
        };
        let count = coefficients.len();
        let groups: Vec<Group> = (0..count).map(group).collect();
        let selection =
            Selection { chosen: (0..count).map(chosen).collect(), before: Vec::new(), after: Vec::new() };
        let switches: Vec<Switch> = (0..count).map(switch).collect();
        is_common_filter(&groups, &selection, &switches, coefficients)
    }

    #[test]
    fn gears_of_different_stiffness_are_gears() {
        assert!(!judged(&[2.8e-4, 2.6e-4]));
        assert!(!judged(&[2.8e-4, 5.0e-4, 1.1e-4, 0.0, 0.0, 0.0]));
    }

    #[test]
    fn one_coefficient_on_three_joints_is_a_filter() {
        assert!(judged(&[2.8e-4, 2.6e-4, 2.7e-4]));
        assert!(judged(&[2.8e-4, 9.0e-4, 2.6e-4, 2.7e-4]));
    }
}
