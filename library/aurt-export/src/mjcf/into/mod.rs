//! MuJoCo: the dynamics of a calibrated model in the user's own file.
//!
//! Attributes of `inertial` and `joint` along the chain are set where they stand; comments, blanks, shapes, actuators and all
//! else stay byte for byte. Bodies that are welded to a link, and bodies on joints beside the chain, keep what the file states,
//! and the body of the joint gets the rest. An attribute of an element overrides the default of its class.

mod edits;

use std::path::Path;

use aurt_rbd::{INERTIAL_PARAMETERS, LinkBody, SerialChain, inconsistencies};
use aurt_robots::{DescribedRobot, MjcfBody, MjcfJoint, MjcfLink, mjcf_links};
use roxmltree::{Document, Node, ParsingOptions};

use super::{
    body::numbers,
    joint::{JointDynamics, dynamics},
};
use crate::{ExportError, Source, naming::for_comment, source::frames};
use edits::Edits;

/// How far the chain of the file may be from that of the model: m, and entries of rotations.
const SAME_CHAIN: f64 = 1e-9;
/// Orientations of an inertial, which a full inertia does not need, and the other inertia.
const REPLACED: [&str; 6] = ["diaginertia", "quat", "axisangle", "xyaxes", "zaxis", "euler"];

/// The file whose dynamics are corrected.
#[derive(Debug, Clone, Copy)]
pub struct Original<'a> {
    /// Its contents.
    pub text: &'a str,
    /// What messages call it.
    pub path: &'a Path,
    /// The body that the chain starts from, and that at which it ends, where the file leaves a choice.
    pub base: Option<&'a str>,
    /// As `base`.
    pub tip: Option<&'a str>,
}

/// A corrected file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Corrected {
    /// Its contents.
    pub text: String,
    /// What was changed, body by body and joint by joint.
    pub changed: Vec<String>,
    /// What of the model MuJoCo has no word for.
    pub lost: Vec<String>,
    /// What a person should know of the file.
    pub notes: Vec<String>,
}

/// Corrects a file.
///
/// # Errors
/// As [`super::export`]; [`ExportError::Robot`] for what is wrong with the file;
/// [`ExportError::OtherChain`] if its chain is not that of the model; [`ExportError::Between`] for two joints in one body;
/// [`ExportError::Remainder`] if what is left for a body is no body.
pub fn correct(source: &Source<'_>, original: &Original<'_>) -> Result<Corrected, ExportError> {
    let Original { text, path, base, tip } = *original;
    let chain = source.chain()?;
    let standard = source.possible_bodies()?;
    let (robot, links) = mjcf_links(text, path, base, tip).map_err(ExportError::Robot)?;
    same_chain(chain, &robot)?;
    let options = ParsingOptions { nodes_limit: u32::MAX, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(ExportError::Xml)?;
    let element = |start: usize| document.descendants().find(|n| n.is_element() && n.range().start == start);

    let (joints, lost) = dynamics(source);
    let mut edits = Edits::default();
    let mut changed = Vec::new();
    let (bodies, _) = standard.as_chunks::<INERTIAL_PARAMETERS>();
    for (j, ((link, body), joint)) in links.iter().zip(bodies).zip(&joints).enumerate() {
        let (own, emptied) = rest(j, link, body)?;
        for other in emptied {
            if let Some(node) = other.inertial.and_then(element) {
                let none = [("mass", "0"), ("diaginertia", "0 0 0")].map(|(n, v)| (n, v.to_owned()));
                edits.set(text, node, &none, &["fullinertia"]);
                changed.push(format!("body {}: without mass, which is in body {}", other.name, own.0.name));
            }
        }
        if let Some(node) = element(own.0.start) {
            let inertial = own.0.inertial.and_then(element);
            changed.push(inertia(&mut edits, text, node, inertial, &own)?);
        }
        if let Some(node) = element(link.joint.start) {
            changed.extend(joint_attributes(&mut edits, text, node, &link.joint, joint));
        }
    }
    let root = document.root_element();
    let mut notes = robot.notes.clone();
    notes.extend(gravity(root, chain, &robot));
    notes.push(
        "actuators stay as they are: torques of the model are those at the joints, behind gears; shapes and meshes are named \
         relative to the file, so put it beside the original"
            .into(),
    );
    edits.insert(root.range().start, heading(source, &changed, &lost));
    Ok(Corrected { text: edits.apply(text), changed, lost, notes })
}

/// Whether the chain of the file is the one that was calibrated.
fn same_chain(chain: &SerialChain, robot: &DescribedRobot) -> Result<(), ExportError> {
    let other = |reason: String| Err(ExportError::OtherChain { reason });
    let theirs = SerialChain::new(robot.joints.clone(), chain.gravity_m_s2())?;
    let (expected, found) = (chain.joints().len(), theirs.joints().len());
    if expected != found {
        return other(format!("it has {found} joints, and the model has {expected}"));
    }
    for (j, (ours, other_joint)) in chain.joints().iter().zip(theirs.joints()).enumerate() {
        let name = &robot.joint_names[j];
        if ours.kind != other_joint.kind {
            return other(format!("its joint {name} does not move as joint {j} of the model does"));
        }
        if ours.sign != other_joint.sign {
            return other(format!("its joint {name} has the opposite sense of joint {j} of the model"));
        }
    }
    for (j, (ours, theirs)) in frames(chain)?.iter().zip(frames(&theirs)?).enumerate() {
        let entries = |frame: &aurt_rbd::LinkFrame| {
            frame.origin_m.into_iter().chain(frame.rotation.into_iter().flatten()).collect::<Vec<_>>()
        };
        let apart =
            entries(ours).iter().zip(entries(&theirs)).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        if apart > SAME_CHAIN {
            let name = &robot.joint_names[j];
            return other(format!(
                "its joint {name} is elsewhere than joint {j} of the model, by {apart:.2e}"
            ));
        }
    }
    Ok(())
}

/// The body of a joint with what is left for it of the link, and the bodies that have to give their mass to it.
type Rest<'l> = ((&'l MjcfBody, LinkBody), Vec<&'l MjcfBody>);

fn rest<'l>(
    j: usize,
    link: &'l MjcfLink,
    standard: &[f64; INERTIAL_PARAMETERS],
) -> Result<Rest<'l>, ExportError> {
    let Some(own) = &link.body else { return Err(ExportError::Between { joint: link.joint.name.clone() }) };
    let without = |left_out: &dyn Fn(&MjcfBody) -> bool| {
        let mut left = *standard;
        for body in link.carried.iter().filter(|b| !left_out(b)) {
            left.iter_mut().zip(body.standard).for_each(|(left, value)| *left -= value);
        }
        let body = LinkBody::from_standard_parameters(&left);
        body.filter(|_| inconsistencies(&left).is_empty())
    };
    if let Some(body) = without(&|_| false) {
        return Ok(((own, body), Vec::new()));
    }
    // Welded bodies may be without mass; bodies that move may not.
    if let Some(body) = without(&|b| b.welded) {
        let emptied = link.carried.iter().filter(|b| b.welded && b.standard.iter().any(|v| *v != 0.0));
        return Ok(((own, body), emptied.collect()));
    }
    let moving: Vec<&str> = link.carried.iter().filter(|b| !b.welded).map(|b| b.name.as_str()).collect();
    Err(ExportError::Remainder { link: j, body: own.name.clone(), carried: moving.join(", ") })
}

/// Sets mass, centre of mass and inertia of a body, and says so.
fn inertia(
    edits: &mut Edits,
    text: &str,
    node: Node<'_, '_>,
    inertial: Option<Node<'_, '_>>,
    (place, body): &(&MjcfBody, LinkBody),
) -> Result<String, ExportError> {
    let r = &place.rotation;
    let from: [f64; 3] = std::array::from_fn(|k| body.com_m[k] - place.origin_m[k]);
    let com_m: [f64; 3] = std::array::from_fn(|k| (0..3).map(|i| r[i][k] * from[i]).sum());
    let [xx, xy, xz, yy, yz, zz] = body.inertia_at_com_kg_m2;
    let ours = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    // Rᵀ I R: the inertia along the axes of the frame in which the file gives it.
    let entry = |a: usize, b: usize| -> f64 {
        (0..3).map(|i| (0..3).map(|k| r[i][a] * ours[i][k] * r[k][b]).sum::<f64>()).sum()
    };
    let full = [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)];
    let attributes =
        [("pos", numbers(&com_m)), ("mass", format!("{:?}", body.mass_kg)), ("fullinertia", numbers(&full))];
    let before = LinkBody::from_standard_parameters(&place.standard);
    if let Some(inertial) = inertial {
        edits.set(text, inertial, &attributes, &REPLACED);
    } else {
        let Some(first) = node.first_child() else {
            return Err(ExportError::Between { joint: place.name.clone() });
        };
        let blank = first.text().filter(|_| first.is_text()).unwrap_or_default();
        let [pos, mass, full] = attributes.map(|(name, value)| format!(" {name}=\"{value}\""));
        edits.insert(first.range().start, format!("{blank}<inertial{pos}{mass}{full}/>"));
    }
    let was = before.map_or_else(|| "none".into(), |b| format!("{:.4} kg", b.mass_kg));
    Ok(format!("body {}: mass {was} to {:.4} kg, with centre of mass and inertia", place.name, body.mass_kg))
}

/// Sets what of a joint's dynamics differs from the file.
fn joint_attributes(
    edits: &mut Edits,
    text: &str,
    node: Node<'_, '_>,
    joint: &MjcfJoint,
    wanted: &JointDynamics,
) -> Option<String> {
    // The reference of a spring that does not act says nothing.
    let spring_ref = if wanted.stiffness == 0.0 { joint.spring_ref } else { wanted.spring_ref / joint.unit };
    let differing: Vec<(&str, f64, f64)> = [
        ("armature", joint.armature, wanted.armature),
        ("damping", joint.damping, wanted.damping),
        ("frictionloss", joint.friction_loss, wanted.friction_loss),
        ("stiffness", joint.stiffness, wanted.stiffness),
        ("springref", joint.spring_ref, spring_ref),
    ]
    .into_iter()
    .filter(|(_, found, wanted)| found != wanted)
    .collect();
    let attributes: Vec<(&str, String)> =
        differing.iter().map(|(name, _, wanted)| (*name, format!("{wanted:?}"))).collect();
    edits.set(text, node, &attributes, &[]);
    let said: Vec<String> =
        differing.iter().map(|(name, found, wanted)| format!("{name} {found:.4} to {wanted:.4}")).collect();
    (!said.is_empty()).then(|| format!("joint {}: {}", joint.name, said.join(", ")))
}

/// What a person should know where gravity in the file is not that of the calibration.
fn gravity(root: Node<'_, '_>, chain: &SerialChain, robot: &DescribedRobot) -> Option<String> {
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

/// The comment before the outermost element.
fn heading(source: &Source<'_>, changed: &[String], lost: &[String]) -> String {
    let mut lines = vec!["Dynamics corrected by `aurt export mjcf` with `into`.".to_owned()];
    lines.extend(source.provenance.lines());
    lines.push("Changed:".into());
    lines.extend(changed.iter().map(|l| format!("  {l}")));
    lines.push("MuJoCo cannot express:".into());
    lines.extend(lost.iter().map(|l| format!("  {l}")));
    let lines: Vec<String> = lines.iter().map(|l| format!("  {}\n", for_comment(l))).collect();
    format!("<!--\n{}-->\n", lines.concat())
}
