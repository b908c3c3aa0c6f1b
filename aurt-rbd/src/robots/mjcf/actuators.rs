//! `<actuator>` and `<option>`, as far as they act on joints; `<position>` and `<general>` actuators that follow a position.

use std::path::Path;

use roxmltree::Node;

use super::ROOT;
use super::classes::Classes;
use crate::robots::element::{Element, Source, document};
use crate::robots::tree::TreeJoint;
use crate::robots::{RobotError, RobotErrors};

/// An actuator that follows a position: torque = clip(gain (command(t − delay) − q) − braking q̇ + bias).
#[derive(Debug, Clone, PartialEq)]
pub struct PositionActuator {
    /// The joint that it drives.
    pub joint: String,
    /// `kp`, or `gainprm` and `biasprm`, in Nm/rad.
    pub gain_nm_per_rad: f64,
    /// `kv`, within the clipping, in Nm s/rad.
    pub braking_nm_s_per_rad: f64,
    /// A constant torque within the clipping, in Nm.
    pub bias_nm: f64,
    /// `forcerange`, in Nm.
    pub limit_nm: Option<f64>,
    /// `delay` of the command, in s.
    pub delay_s: f64,
}

/// The actuators of an MJCF file that follow positions, as MuJoCo computes them; `path` is what errors call it.
///
/// # Errors
/// A file that is no MJCF, and actuators of joints that are something else than a law of position.
pub fn position_actuators(text: &str, path: impl AsRef<Path>) -> Result<Vec<PositionActuator>, RobotErrors> {
    let path = path.as_ref();
    let document = document(text, path)?;
    let root = document.root_element();
    if !root.has_tag_name(ROOT) {
        let reason = format!("the outermost element is <{}>, not <{ROOT}>", root.tag_name().name());
        return Err(RobotError::NoTree { path: path.into(), reason }.into());
    }
    let (source, classes) = (Source::of(root, path), Classes::read(root));
    let mut found = Vec::new();
    let mut errors = Vec::new();
    for node in actuators(root) {
        let Some(joint) = node.attribute("joint").or_else(|| node.attribute("jointinparent")) else {
            continue;
        };
        let what = format!("<actuator>, the {} of joint {joint}", node.tag_name().name());
        match read(&Element { node, what, source: &source }, &classes, joint) {
            Ok(actuator) => found.push(actuator),
            Err(error) => errors.push(error),
        }
    }
    if errors.is_empty() { Ok(found) } else { Err(RobotErrors(errors)) }
}

fn read<'x>(
    element: &Element<'_, 'x>,
    classes: &Classes<'x>,
    joint: &str,
) -> Result<PositionActuator, RobotError> {
    let of = |name: &str| classes.attribute(element.node, None, name);
    let numbers = |name: &str| -> Result<Vec<f64>, RobotError> {
        let parsed = |n: &str| element.parsed(name, n).map(|[number]| number);
        of(name).unwrap_or_default().split_whitespace().map(parsed).collect()
    };
    let first = |name: &str, default: f64| Ok(numbers(name)?.first().copied().unwrap_or(default));
    if first("gear", 1.0)? != 1.0 {
        return Err(element.error(
            "`gear` is not 1, so that commands are no positions of the joint; state gains at the joint",
        ));
    }
    for name in ["dampratio", "timeconst"] {
        if first(name, 0.0)? != 0.0 {
            return Err(element.error(format!("`{name}` is not read; write out `kv`, and no activation")));
        }
    }
    let (gain, bias) = match element.node.tag_name().name() {
        "position" => {
            let (kp, kv) = (first("kp", 1.0)?, first("kv", 0.0)?);
            (kp, [0.0, -kp, -kv])
        }
        "general" => {
            let named = |name: &str, plain: &str| of(name).is_none_or(|kind| kind == plain);
            let is_affine = of("biastype") == Some("affine");
            if !is_affine || !named("gaintype", "fixed") || !named("dyntype", "none") {
                return Err(element
                    .error("follows no position: wanted is a fixed gain, an affine bias and no activation"));
            }
            let mut bias = numbers("biasprm")?;
            bias.resize(3, 0.0);
            (first("gainprm", 1.0)?, [bias[0], bias[1], bias[2]])
        }
        _ => return Err(element.error("is no actuator of a position; `position` and `general` are read")),
    };
    if gain <= 0.0 || (gain + bias[1]).abs() > 1e-9 * gain {
        return Err(element.error(format!(
            "its gain {gain} is not the stiffness {}, so that it follows no position",
            -bias[1]
        )));
    }
    let range = numbers("forcerange")?;
    let limit = match (&range[..], of("forcelimited")) {
        ([low, high], limited) if limited != Some("false") && low < high => {
            Some(high.min(-low)).filter(|limit| *limit > 0.0)
        }
        _ => None,
    };
    Ok(PositionActuator {
        joint: joint.to_owned(),
        gain_nm_per_rad: gain,
        braking_nm_s_per_rad: -bias[2],
        bias_nm: bias[0],
        limit_nm: limit,
        delay_s: first("delay", 0.0)?,
    })
}

/// Gravity of files that state none, m/s².
const GRAVITY: &str = "0 0 -9.81";

/// Adds gear² times armature and damping of the actuators to what drives their joints.
pub(super) fn drive<'x>(
    root: Node<'x, 'x>,
    (source, classes): (&Source<'_>, &Classes<'x>),
    joints: &mut [TreeJoint],
) -> Result<(), RobotError> {
    for node in actuators(root) {
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

fn actuators<'x>(root: Node<'x, 'x>) -> impl Iterator<Item = Node<'x, 'x>> {
    let sections = root.children().filter(|c| c.has_tag_name("actuator"));
    sections.flat_map(|s| s.children()).filter(Node::is_element)
}
