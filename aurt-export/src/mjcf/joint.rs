//! What joints of robot descriptions can say of friction, rotors and springs.

use std::collections::BTreeMap;

use aurt_traits::{ArmTerm, ColumnGroup};

use crate::Source;

#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct JointDynamics {
    pub armature: f64,
    pub damping: f64,
    pub friction_loss: f64,
    pub stiffness: f64,
    pub spring_ref: f64,
    pub range: Option<[f64; 2]>,
}

/// The attributes of all joints, and all coefficients that have none.
pub(crate) fn dynamics(source: &Source<'_>) -> (Vec<JointDynamics>, Vec<String>) {
    let mut joints = vec![JointDynamics::default(); source.model.joints()];
    let mut lost = Vec::new();
    for (j, joint) in joints.iter_mut().enumerate() {
        friction(source, j, joint, &mut lost);
    }
    for (k, term) in source.model.arm_terms().iter().enumerate() {
        let group = source.model.group(ColumnGroup::ArmTerm(k));
        let own = &source.coefficients[group.clone()];
        match term.name() {
            "rotor_inertia" => {
                for (joint, value) in term.joints(joints.len()).into_iter().zip(own) {
                    if *value >= 0.0 {
                        joints[joint].armature += value;
                    } else {
                        lost.push(format!(
                            "armature of joint {joint}: {value:.4} kg m^2, and none below 0 is taken"
                        ));
                    }
                }
            }
            "spring" => spring(&**term, own, &mut joints, &mut lost),
            name => {
                let named = source.model.parameters()[group].iter().zip(own);
                let values: Vec<String> =
                    named.map(|(p, v)| format!("{} = {v:.4} {}", p.name, p.unit)).collect();
                lost.push(format!("arm term {name}: {}", values.join(", ")));
            }
        }
    }
    (joints, lost)
}

/// The constant level becomes friction loss, the linear viscous coefficient damping; all else is lost.
fn friction(source: &Source<'_>, j: usize, joint: &mut JointDynamics, lost: &mut Vec<String>) {
    let stack = &source.model.stacks()[j];
    let own = &source.coefficients[source.model.group(ColumnGroup::JointDynamics(j))];
    let products = stack.coulomb().columns().len() * stack.hysteresis().columns().len();
    let slides = stack.hysteresis().columns().len() == 1 || stack.hysteresis().name() == "maxwell_slip";
    let mut left: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (k, (column, value)) in stack.columns().iter().zip(own).enumerate() {
        let level = k < products && (column.name == "F_C0" || column.name.starts_with("F_C0."));
        if level && slides && *value >= 0.0 {
            joint.friction_loss += value;
        } else if k >= products && column.name == "F_v1" && *value >= 0.0 {
            joint.damping += value;
        } else if *value != 0.0 {
            let slot = if k >= products { "viscous" } else { "coulomb" };
            left.entry(slot).or_default().push(format!("{} = {value:.4} {}", column.name, column.unit));
        }
    }
    for (slot, coefficients) in left {
        let model = if slot == "viscous" { stack.viscous().name() } else { stack.coulomb().name() };
        lost.push(format!("joint {j}, {slot} friction `{model}`: {}", coefficients.join(", ")));
    }
    let hysteresis = stack.hysteresis().name();
    if hysteresis != "sign" && products > 0 {
        lost.push(format!(
            "joint {j}, hysteresis `{hysteresis}`: the jump of friction at rest is the engine's own"
        ));
    }
}

/// k (q − q_0) becomes stiffness and spring reference.
fn spring(term: &dyn ArmTerm, own: &[f64], joints: &mut [JointDynamics], lost: &mut Vec<String>) {
    let acting = term.joints(joints.len());
    let per_joint = own.len() / acting.len().max(1);
    let rest =
        serde_json::to_value(term).ok().and_then(|d| d.get("rest_rad").and_then(serde_json::Value::as_f64));
    for (joint, own) in acting.iter().zip(own.chunks(per_joint.max(1))) {
        let (stiffness, constant) = match *own {
            [k, k_q0] => (k, k_q0),
            [k] => (k, k * rest.unwrap_or(0.0)),
            _ => continue,
        };
        if stiffness > 0.0 && joints[*joint].stiffness == 0.0 {
            joints[*joint].stiffness = stiffness;
            joints[*joint].spring_ref = constant / stiffness;
        } else {
            lost.push(format!(
                "spring of joint {joint}: {stiffness:.4} N m/rad, and one above 0 is taken for each joint"
            ));
        }
    }
}
