//! The experiment file of a case.

use aurt_traits::MeasurementUnit;

use super::layout::{Role, Slot};
use aurt_simulation::inject::{JointStructure, Structure};
use aurt_simulation::robots::Robot;

pub(super) fn file_name(slot: usize) -> String {
    format!("recording_{}.csv", slot + 1)
}

pub(super) fn text(robot: &Robot, structure: &Structure, slots: &[Slot], f_dyn_hz: f64) -> String {
    let numbers = |values: &[f64]| values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", ");
    let mut lines = vec![
        "schema = 1".to_owned(),
        String::new(),
        "[robot]".to_owned(),
        "mdh = \"mdh.csv\"".to_owned(),
        format!("gravity_m_s2 = [{}]", numbers(&robot.gravity_m_s2)),
    ];
    if robot.unit == MeasurementUnit::Ampere {
        let constants: Vec<f64> = robot.drives.iter().map(|d| d.torque_constant_nm_per_a).collect();
        lines.push(format!("torque_constants_nm_per_a = [{}]", numbers(&constants)));
    }
    lines.extend(joint_dynamics(structure));
    let rotors: Vec<String> =
        (0..robot.joints()).filter(|j| structure.joints[*j].rotor).map(|j| j.to_string()).collect();
    if !rotors.is_empty() {
        lines.push(String::new());
        lines.push("[[arm_terms]]".to_owned());
        lines.push("model = \"rotor_inertia\"".to_owned());
        lines.push(format!("joints = [{}]", rotors.join(", ")));
    }
    lines.push(String::new());
    lines.push("[recordings]".to_owned());
    for (role, key) in
        [(Role::Calibration, "calibration"), (Role::Target, "target"), (Role::Validation, "validation")]
    {
        let files: Vec<String> = slots
            .iter()
            .enumerate()
            .filter(|(_, slot)| slot.role == role)
            .map(|(k, _)| format!("\"{}\"", file_name(k)))
            .collect();
        if !files.is_empty() {
            lines.push(format!("{key} = [{}]", files.join(", ")));
        }
    }
    lines.push(String::new());
    lines.push("[preprocess]".to_owned());
    lines.push(format!("f_dyn_hz = {f_dyn_hz:?}"));
    lines.join("\n") + "\n"
}

/// The section `[joint_dynamics]`: what most joints have, and overrides for the others.
fn joint_dynamics(structure: &Structure) -> Vec<String> {
    let coulomb = |j: &JointStructure| match (j.coulomb, j.load) {
        (false, _) => "coulomb = { model = \"absent\" }",
        (true, false) => "coulomb = { model = \"none\" }",
        (true, true) => "coulomb = { model = \"absolute\" }",
    };
    let viscous = |j: &JointStructure| {
        if j.viscous {
            "viscous = { model = \"polynomial\", powers = [1] }"
        } else {
            "viscous = { model = \"polynomial\", powers = [] }"
        }
    };
    let usual = JointStructure { coulomb: true, viscous: true, rotor: false, load: false };
    let mut lines = vec![
        String::new(),
        "[joint_dynamics]".to_owned(),
        coulomb(&usual).to_owned(),
        "hysteresis = { model = \"sign\" }".to_owned(),
        viscous(&usual).to_owned(),
    ];
    for (j, joint) in structure.joints.iter().enumerate() {
        let other_coulomb = coulomb(joint) != coulomb(&usual);
        let other_viscous = viscous(joint) != viscous(&usual);
        if other_coulomb || other_viscous {
            lines.push(String::new());
            lines.push("[[joint_dynamics.override]]".to_owned());
            lines.push(format!("joints = [{j}]"));
            if other_coulomb {
                lines.push(coulomb(joint).to_owned());
            }
            if other_viscous {
                lines.push(viscous(joint).to_owned());
            }
        }
    }
    lines
}
