//! What of a URDF file is corrected: `<inertial>` of links and `<dynamics>` of joints.

use aurt_rbd::LinkBody;
use aurt_rbd::robots::PlacedJoint;
use roxmltree::Node;

use super::edits::Edits;
use crate::mjcf::body::numbers;
use crate::mjcf::joint::JointDynamics;

fn child<'a, 'x>(node: Node<'a, 'x>, name: &str) -> Option<Node<'a, 'x>> {
    node.children().find(|c| c.is_element() && c.tag_name().name() == name)
}

/// Sets mass, centre of mass and inertia of a link, along the link's axes.
pub(super) fn inertial(
    edits: &mut Edits<'_>,
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
        edits.insert_first(node, &format!("<inertial>{inside}</inertial>"));
        return;
    };
    for stated in &elements {
        match child(inertial, stated.0) {
            Some(node) => edits.set(node, &stated.1, &[]),
            None => edits.insert_first(inertial, &written(stated)),
        }
    }
}

fn element(name: &str, attributes: &[(&str, String)]) -> String {
    let attributes: String = attributes.iter().map(|(name, value)| format!(" {name}=\"{value}\"")).collect();
    format!("<{name}{attributes}/>")
}

/// Attributes of a joint's `<dynamics>`: what is found, what is wanted.
pub(super) fn joint(joint: &PlacedJoint, wanted: &JointDynamics) -> Vec<(&'static str, f64, f64)> {
    vec![("damping", joint.damping, wanted.damping), ("friction", joint.friction_loss, wanted.friction_loss)]
}

pub(super) fn set_dynamics(edits: &mut Edits<'_>, node: Node<'_, '_>, attributes: &[(&str, String)]) {
    match child(node, "dynamics") {
        Some(dynamics) => edits.set(dynamics, attributes, &[]),
        None if !attributes.is_empty() => edits.insert_first(node, &element("dynamics", attributes)),
        None => {}
    }
}
