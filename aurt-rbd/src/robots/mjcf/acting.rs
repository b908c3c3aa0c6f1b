//! `<actuator>` and `<option>`, as far as they act on joints.

use roxmltree::Node;

use super::classes::Classes;
use crate::robots::RobotError;
use crate::robots::element::{Element, Source};
use crate::robots::tree::TreeJoint;

/// Gravity of files that state none, m/s².
const GRAVITY: &str = "0 0 -9.81";

/// Adds gear² times armature and damping of the actuators to what drives their joints.
pub(super) fn drive<'x>(
    root: Node<'x, 'x>,
    (source, classes): (&Source<'_>, &Classes<'x>),
    joints: &mut [TreeJoint],
) -> Result<(), RobotError> {
    let sections = root.children().filter(|c| c.has_tag_name("actuator"));
    for node in sections.flat_map(|s| s.children()).filter(Node::is_element) {
        let of = |name: &str| classes.attribute(node, None, name);
        let driven = of("joint").or_else(|| of("jointinparent"));
        let Some(joint) = joints.iter_mut().find(|joint| Some(joint.name.as_str()) == driven) else {
            continue;
        };
        let what = format!("<actuator>, the {} of joint {}", node.tag_name().name(), joint.name);
        let element = Element { node, what, source };
        let number = |name: &str, default: f64, text: Option<&str>| {
            text.map_or(Ok([default]), |text| element.parsed(name, text)).map(|[number]| number)
        };
        let gear = number("gear", 1.0, of("gear").and_then(|gear| gear.split_whitespace().next()))?;
        for (at, name) in ["armature", "damping"].into_iter().enumerate() {
            joint.driven[at] += gear * gear * number(name, 0.0, of(name))?;
        }
    }
    Ok(())
}

/// What a `<flag>` says; later ones overrule earlier ones.
pub(super) fn is_disabled(root: Node<'_, '_>, flag: &str) -> bool {
    let flags = options(root).flat_map(|o| o.children()).filter(|c| c.has_tag_name("flag"));
    flags.filter_map(|f| f.attribute(flag)).last() == Some("disable")
}

/// What of `<option>` is not read.
pub(super) fn notes(root: Node<'_, '_>) -> Vec<String> {
    let of = |name: &str| options(root).filter_map(|o| o.attribute(name)).last();
    let acts = |text: &str| text.split_whitespace().any(|n| n.parse() != Ok(0.0));
    let mut notes = Vec::new();
    let fluid: Vec<&str> = ["density", "viscosity"].into_iter().filter(|n| of(n).is_some_and(acts)).collect();
    if !fluid.is_empty() {
        let wind = if of("wind").is_some_and(acts) { " and `wind`" } else { "" };
        notes.push(format!("forces of the fluid (`{}`{wind} of <option>) are not read", fluid.join("`, `")));
    }
    for (flag, what) in [("damper", "damping"), ("frictionloss", "frictionloss")] {
        if is_disabled(root, flag) {
            notes.push(format!("the file turns `{what}` off by <flag>, and so none is read"));
        }
    }
    let gravity = of("gravity").unwrap_or(GRAVITY);
    let same = |(a, b): (&str, &str)| a.parse::<f64>().ok() == b.parse().ok();
    if is_disabled(root, "gravity") {
        notes.push("the file turns gravity off by <flag>; what counts is gravity_m_s2".into());
    } else if !gravity.split_whitespace().zip(GRAVITY.split_whitespace()).all(same) {
        notes.push(format!(
            "gravity of the file is {gravity} m/s^2 in its world; what counts is gravity_m_s2"
        ));
    }
    notes
}

fn options<'x>(root: Node<'x, 'x>) -> impl Iterator<Item = Node<'x, 'x>> {
    root.children().filter(|c| c.has_tag_name("option"))
}
