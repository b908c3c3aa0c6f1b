//! What of a URDF file is corrected: `<inertial>` of links and `<dynamics>` of joints.

use aurt_rbd::LinkBody;
use aurt_rbd::robots::PlacedJoint;
use roxmltree::Node;

use super::edits::Edits;
use crate::mjcf::{body::numbers, joint::JointDynamics};

fn child<'a, 'x>(node: Node<'a, 'x>, name: &str) -> Option<Node<'a, 'x>> {
    node.children().find(|c| c.is_element() && c.tag_name().name() == name)
}

/// Sets mass, centre of mass and inertia of a link, along the link's axes.
pub(super) fn inertial(
    edits: &mut Edits,
    text: &str,
    (node, inertial): (Node<'_, '_>, Option<Node<'_, '_>>),
    body: &LinkBody,
) {
    let elements = [
        ("origin", vec![("xyz", numbers(&body.com_m)), ("rpy", "0 0 0".to_owned())]),
        ("mass", vec![("value", format!("{:?}", body.mass_kg))]),
        (
            "inertia",
            ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]
                .into_iter()
                .zip(body.inertia_at_com_kg_m2.map(|v| format!("{v:?}")))
                .collect(),
        ),
    ];
    let written = |(name, attributes): &(&str, Vec<(&str, String)>)| element(name, attributes);
    let Some(inertial) = inertial else {
        let inside: String = elements.iter().map(written).collect();
        edits.insert_first(text, node, &format!("<inertial>{inside}</inertial>"));
        return;
    };
    for stated in &elements {
        match child(inertial, stated.0) {
            Some(node) => edits.set(text, node, &stated.1, &[]),
            None => edits.insert_first(text, inertial, &written(stated)),
        }
    }
}

fn element(name: &str, attributes: &[(&str, String)]) -> String {
    let attributes: String = attributes.iter().map(|(name, value)| format!(" {name}=\"{value}\"")).collect();
    format!("<{name}{attributes}/>")
}

/// Sets what of a joint's dynamics differs from the file: the attribute, what is found, what is wanted.
pub(super) fn joint(
    edits: &mut Edits,
    text: &str,
    node: Node<'_, '_>,
    joint: &PlacedJoint,
    wanted: &JointDynamics,
) -> Vec<(&'static str, f64, f64)> {
    let mut differing = vec![
        ("damping", joint.damping, wanted.damping),
        ("friction", joint.friction_loss, wanted.friction_loss),
    ];
    differing.retain(|(_, found, wanted)| found != wanted);
    let attributes: Vec<(&str, String)> =
        differing.iter().map(|(name, _, wanted)| (*name, format!("{wanted:?}"))).collect();
    match child(node, "dynamics") {
        Some(dynamics) => edits.set(text, dynamics, &attributes, &[]),
        None if !attributes.is_empty() => {
            edits.insert_first(text, node, &element("dynamics", &attributes));
        }
        None => {}
    }
    differing
}
