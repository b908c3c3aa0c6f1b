//! The dynamics of a calibrated model in the user's own file, of MuJoCo or URDF.
//!
//! What the chain's elements say of inertias, friction, rotors and springs is set where it stands; comments, blanks, shapes,
//! limits and all else stay byte for byte; actuators lose armature and damping, which are in the joint's. Bodies that are welded to a link, and bodies on joints beside the chain,
//! keep what the file states, and the body of the joint gets the rest.

mod edits;
mod mjcf;
mod urdf;

use std::path::Path;

pub use aurt_rbd::robots::Format;
use aurt_rbd::robots::{DescribedRobot, Part, PlacedBody, PlacedLink, placed_links};
use aurt_rbd::{INERTIAL_PARAMETERS, LinkBody, SerialChain, inconsistencies};
use roxmltree::{Document, ParsingOptions};

use crate::mjcf::joint::dynamics;
use crate::source::{frames, heading};
use crate::urdf::{rotors_lost, springs_lost};
use crate::{ExportError, Source};
use edits::Edits;

/// How far the chain of the file may be from that of the model: m, and entries of rotations.
const SAME_CHAIN: f64 = 1e-9;
/// The file whose dynamics are corrected.
#[derive(Debug, Clone, Copy)]
pub struct Original<'a> {
    /// Its contents.
    pub text: &'a str,
    /// What messages call it.
    pub path: &'a Path,
    /// Its format.
    pub format: Format,
    /// The body that the robot stands on, where the file leaves a choice.
    pub base: Option<&'a str>,
    /// What of the file it is.
    pub part: &'a Part,
}

/// A corrected file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Corrected {
    /// Its contents.
    pub text: String,
    /// What was changed, body by body and joint by joint.
    pub changed: Vec<String>,
    /// What of the model the format cannot express.
    pub lost: Vec<String>,
    /// What a person should know of the file.
    pub notes: Vec<String>,
}

/// Corrects a file.
///
/// # Errors
/// As [`crate::mjcf::export`]; [`ExportError::Robot`] for what is wrong with the file;
/// [`ExportError::OtherChain`] if its chain is not that of the model; [`ExportError::Between`] for two joints in one body;
/// [`ExportError::Remainder`] if what is left for a body is no body; [`ExportError::FromShapes`] if what is written would not count.
pub fn correct(source: &Source<'_>, original: &Original<'_>) -> Result<Corrected, ExportError> {
    let Original { text, path, format, base, part } = *original;
    let chain = source.chain()?;
    let standard = source.possible_bodies()?;
    let (robot, links) = placed_links(text, path, format, base, part).map_err(ExportError::Robot)?;
    same_chain(chain, &robot)?;
    let options = ParsingOptions { nodes_limit: u32::MAX, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(ExportError::Xml)?;
    let root = document.root_element();
    let element = |start: usize| document.descendants().find(|n| n.is_element() && n.range().start == start);

    let (joints, mut lost) = dynamics(source);
    let mut notes = robot.notes.clone();
    match format {
        Format::Mjcf => {
            mjcf::check(root)?;
            notes.extend(mjcf::gravity(root, chain, &robot));
            notes.push(
                "actuators keep all but armature and damping: torques of the model are those at the joints, behind gears"
                    .into(),
            );
        }
        Format::Urdf => {
            lost.extend(rotors_lost(&joints).into_iter().chain(springs_lost(&joints)));
            let (gravity, base) = (chain.gravity_m_s2(), &robot.base);
            notes.push(format!(
                "the model was calibrated under gravity {gravity:?} m/s^2 in the frame of `{base}`; see to the same"
            ));
        }
    }
    notes.push("shapes and meshes are named relative to the file, so put it beside the original".into());

    let mut edits = Edits::new(text);
    let mut changed = Vec::new();
    let (bodies, _) = standard.as_chunks::<INERTIAL_PARAMETERS>();
    for (j, ((link, body), joint)) in links.iter().zip(bodies).zip(&joints).enumerate() {
        let (own, body, emptied) = rest(j, link, body)?;
        let mut write = |place: &PlacedBody, body: &LinkBody| {
            let Some(node) = element(place.start) else { return };
            let of = (node, place.inertial.and_then(element));
            match format {
                Format::Mjcf => mjcf::inertial(&mut edits, of, body),
                Format::Urdf => urdf::inertial(&mut edits, of, body),
            }
        };
        for other in emptied {
            write(other, &LinkBody { mass_kg: 0.0, com_m: [0.0; 3], inertia_at_com_kg_m2: [0.0; 6] });
            changed.push(format!("body {}: without mass, which is in body {}", other.name, own.name));
        }
        write(own, &along_axes(own, &body));
        let before = LinkBody::from_standard_parameters(&own.standard);
        let was = before.map_or_else(|| "none".into(), |b| format!("{:.4} kg", b.mass_kg));
        changed.push(format!(
            "body {}: mass {was} to {:.4} kg, with centre of mass and inertia",
            own.name, body.mass_kg
        ));
        let Some(node) = element(link.joint.start) else { continue };
        if format == Format::Mjcf {
            changed.extend(mjcf::undrive(&mut edits, root, &link.joint));
        }
        let mut differing = match format {
            Format::Mjcf => mjcf::joint(&link.joint, joint),
            Format::Urdf => urdf::joint(&link.joint, joint),
        };
        differing.retain(|(_, found, wanted)| found != wanted);
        let attributes: Vec<(&str, String)> =
            differing.iter().map(|(name, _, wanted)| (*name, format!("{wanted:?}"))).collect();
        match format {
            // It would overrule stiffness and damping.
            Format::Mjcf => edits.set(node, &attributes, &["springdamper"]),
            Format::Urdf => urdf::set_dynamics(&mut edits, node, &attributes),
        }
        if !differing.is_empty() {
            let said =
                differing.iter().map(|(name, found, wanted)| format!("{name} {found:.4} to {wanted:.4}"));
            changed.push(format!("joint {}: {}", link.joint.name, said.collect::<Vec<_>>().join(", ")));
        }
    }
    let (target, program) = match format {
        Format::Mjcf => ("mjcf", "MuJoCo"),
        Format::Urdf => ("urdf", "URDF"),
    };
    let first = format!("Dynamics corrected by `aurt export {target}` with `into`.");
    edits.insert(root.range().start, heading(source, first, &changed, program, &lost));
    Ok(Corrected { text: edits.apply(), changed, lost, notes })
}

fn same_chain(chain: &SerialChain, robot: &DescribedRobot) -> Result<(), ExportError> {
    let other = |reason: String| Err(ExportError::OtherChain { reason });
    if !robot.couplings.is_empty() {
        return other("joints of it follow others (mimic), and none of the model do".into());
    }
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
        if ours.parent != other_joint.parent {
            return other(format!("its joint {name} sits on another link than joint {j} of the model"));
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
type Rest<'l> = (&'l PlacedBody, LinkBody, Vec<&'l PlacedBody>);

fn rest<'l>(
    j: usize,
    link: &'l PlacedLink,
    standard: &[f64; INERTIAL_PARAMETERS],
) -> Result<Rest<'l>, ExportError> {
    let Some(own) = &link.body else { return Err(ExportError::Between { joint: link.joint.name.clone() }) };
    let without = |left_out: &dyn Fn(&PlacedBody) -> bool| {
        let mut left = *standard;
        for body in link.carried.iter().filter(|b| !left_out(b)) {
            left.iter_mut().zip(body.standard).for_each(|(left, value)| *left -= value);
        }
        let body = LinkBody::from_standard_parameters(&left);
        body.filter(|_| inconsistencies(&left).is_empty())
    };
    if let Some(body) = without(&|_| false) {
        return Ok((own, body, Vec::new()));
    }
    // Welded bodies may be without mass; bodies that move may not.
    if let Some(body) = without(&|b| b.welded) {
        let emptied = link.carried.iter().filter(|b| b.welded && b.standard.iter().any(|v| *v != 0.0));
        return Ok((own, body, emptied.collect()));
    }
    let moving: Vec<&str> = link.carried.iter().filter(|b| !b.welded).map(|b| b.name.as_str()).collect();
    Err(ExportError::Remainder { link: j, body: own.name.clone(), carried: moving.join(", ") })
}

/// A body of the chain's link in the frame in which the file states its inertia: Rᵀ (c − p) and Rᵀ I R.
fn along_axes(place: &PlacedBody, body: &LinkBody) -> LinkBody {
    let r = &place.rotation;
    let from: [f64; 3] = std::array::from_fn(|k| body.com_m[k] - place.origin_m[k]);
    let [xx, xy, xz, yy, yz, zz] = body.inertia_at_com_kg_m2;
    let ours = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let entry = |a: usize, b: usize| -> f64 {
        (0..3).map(|i| (0..3).map(|k| r[i][a] * ours[i][k] * r[k][b]).sum::<f64>()).sum()
    };
    LinkBody {
        mass_kg: body.mass_kg,
        com_m: std::array::from_fn(|k| (0..3).map(|i| r[i][k] * from[i]).sum()),
        inertia_at_com_kg_m2: [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(a, b)| entry(a, b)),
    }
}
