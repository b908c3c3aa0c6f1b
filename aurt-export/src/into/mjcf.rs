//! What of a MuJoCo file is corrected: attributes of `inertial` and `joint`. An attribute of an element overrides the default
//! of its class.

use aurt_rbd::robots::{DescribedRobot, PlacedJoint};
use aurt_rbd::{LinkBody, SerialChain};
use roxmltree::Node;

use super::SAME_CHAIN;
use super::edits::Edits;
use crate::ExportError;
use crate::mjcf::body::numbers;
use crate::mjcf::joint::JointDynamics;

/// Orientations of an inertial: the inertia is written along the axes of the body.
const TURNS: [&str; 5] = ["quat", "axisangle", "xyaxes", "zaxis", "euler"];

/// Whether what is written would count.
pub(super) fn check(root: Node<'_, '_>) -> Result<(), ExportError> {
    let compilers = root.children().filter(|c| c.has_tag_name("compiler"));
    let from_shapes = compilers.filter_map(|c| c.attribute("inertiafromgeom")).next_back();
    if from_shapes == Some("true") { Err(ExportError::FromShapes) } else { Ok(()) }
}

/// Sets mass, centre of mass and inertia of a body.
pub(super) fn inertial(
    edits: &mut Edits<'_>,
    (node, inertial): (Node<'_, '_>, Option<Node<'_, '_>>),
    body: &LinkBody,
) {
    let [xx, xy, xz, yy, yz, zz] = body.inertia_at_com_kg_m2;
    // MuJoCo takes a full inertia of bodies with mass alone.
    let (inertia, other) = if body.mass_kg == 0.0 {
        (("diaginertia", numbers(&[0.0; 3])), "fullinertia")
    } else {
        (("fullinertia", numbers(&[xx, yy, zz, xy, xz, yz])), "diaginertia")
    };
    let attributes = [("pos", numbers(&body.com_m)), ("mass", format!("{:?}", body.mass_kg)), inertia];
    if let Some(inertial) = inertial {
        let mut without = TURNS.to_vec();
        without.push(other);
        edits.set(inertial, &attributes, &without);
    } else {
        let attributes = attributes.map(|(name, value)| format!(" {name}=\"{value}\"")).concat();
        edits.insert_first(node, &format!("<inertial{attributes}/>"));
    }
}

/// Attributes of a joint's dynamics: what is found, what is wanted.
pub(super) fn joint(joint: &PlacedJoint, wanted: &JointDynamics) -> Vec<(&'static str, f64, f64)> {
    // The reference of a spring that does not act says nothing.
    let spring_ref = if wanted.stiffness == 0.0 { joint.spring_ref } else { wanted.spring_ref / joint.unit };
    vec![
        ("armature", joint.armature, wanted.armature),
        ("damping", joint.damping, wanted.damping),
        ("frictionloss", joint.friction_loss, wanted.friction_loss),
        ("stiffness", joint.stiffness, wanted.stiffness),
        ("springref", joint.spring_ref, spring_ref),
    ]
}

/// Takes armature and damping from the actuators of a joint, which the model has at the joint: what of them is left, in words.
pub(super) fn undrive(edits: &mut Edits<'_>, root: Node<'_, '_>, joint: &PlacedJoint) -> Option<String> {
    if !joint.is_driven {
        return None;
    }
    let sections = root.children().filter(|c| c.has_tag_name("actuator"));
    let drives = |a: &Node<'_, '_>| {
        let driven = a.attribute("joint").or_else(|| a.attribute("jointinparent"));
        driven == Some(joint.name.as_str())
    };
    for node in sections.flat_map(|s| s.children()).filter(drives) {
        // An attribute of the element overrides the default of its class.
        edits.set(node, &["armature", "damping"].map(|name| (name, "0.0".into())), &[]);
    }
    Some(format!("actuators of joint {}: armature and damping to 0, they are in the joint's", joint.name))
}

/// What a person should know where gravity in the file is not that of the calibration.
pub(super) fn gravity(root: Node<'_, '_>, chain: &SerialChain, robot: &DescribedRobot) -> Option<String> {
    let option = root.children().filter(|c| c.has_tag_name("option"));
    let stated = option.filter_map(|o| o.attribute("gravity")).next_back();
    let ours = chain.gravity_m_s2();
    if robot.base != "world" {
        let base = &robot.base;
        return Some(format!(
            "the model was calibrated under gravity {ours:?} m/s^2 in the frame of `{base}`; see to the same"
        ));
    }
    let theirs: Vec<f64> = stated.map_or_else(
        || vec![0.0, 0.0, -9.81],
        |text| text.split_whitespace().filter_map(|n| n.parse().ok()).collect(),
    );
    let same = theirs.len() == 3 && theirs.iter().zip(ours).all(|(a, b)| (a - b).abs() <= SAME_CHAIN);
    (!same).then(|| {
        format!("the model was calibrated under gravity {ours:?} m/s^2, and that of the file is {theirs:?}; it stays")
    })
}
