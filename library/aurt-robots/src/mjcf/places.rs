//! Where an MJCF file has the bodies and joints of a chain, for programs that correct it in place.

use std::collections::HashMap;
use std::path::Path;

use aurt_rbd::INERTIAL_PARAMETERS;
use roxmltree::Node;

use super::{ROOT, classes::Classes, settings::Settings};
use crate::element::{self, Source};
use crate::pose::Pose;
use crate::serial::{self, Part};
use crate::tree::{Freedom, Tree};
use crate::{DescribedRobot, RobotError, RobotErrors, selection};

/// A link of a chain, as an MJCF file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct MjcfLink {
    /// The joint that moves it.
    pub joint: MjcfJoint,
    /// The body that the joint moves; none for a link between two joints of one body.
    pub body: Option<MjcfBody>,
    /// What else it consists of: bodies that are welded to it, and bodies on joints beside the chain.
    pub carried: Vec<MjcfBody>,
}

/// A joint and what the file says of its dynamics, defaults of its class included, in the units of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct MjcfJoint {
    /// Its name.
    pub name: String,
    /// Byte at which its element begins.
    pub start: usize,
    /// `armature`, kg m² or kg.
    pub armature: f64,
    /// `damping`, Nm s/rad or N s/m.
    pub damping: f64,
    /// `frictionloss`, Nm or N.
    pub friction_loss: f64,
    /// `stiffness`, Nm/rad or N/m.
    pub stiffness: f64,
    /// `springref`, in the file's unit of angles, or m.
    pub spring_ref: f64,
    /// That unit in rad; 1 of a joint that slides.
    pub unit: f64,
}

/// A body.
#[derive(Debug, Clone, PartialEq)]
pub struct MjcfBody {
    /// Its name.
    pub name: String,
    /// Byte at which the element `body` begins.
    pub start: usize,
    /// Byte at which its element `inertial` begins, if it has one.
    pub inertial: Option<usize>,
    /// Whether it moves with the link; else it is on a joint beside the chain, which is held at zero.
    pub welded: bool,
    /// Axes of the frame in which `inertial` is given, in the frame of the chain's link; row after row.
    pub rotation: [[f64; 3]; 3],
    /// Origin of that frame, m.
    pub origin_m: [f64; 3],
    /// Its standard parameters, {XX XY XZ YY YZ ZZ mX mY mZ m}, in the frame of the chain's link.
    pub standard: [f64; INERTIAL_PARAMETERS],
}

/// The chain from `base` to `tip` of an MJCF file, as [`parse`](crate::parse) gives it, and the places of its links.
///
/// # Errors
/// As [`read`](crate::read); a file that is no MJCF.
pub fn mjcf_links(
    text: &str,
    path: impl AsRef<Path>,
    base: Option<&str>,
    tip: Option<&str>,
) -> Result<(DescribedRobot, Vec<MjcfLink>), RobotErrors> {
    let path = path.as_ref();
    let document = element::document(text, path)?;
    let root = document.root_element();
    if !root.has_tag_name(ROOT) {
        let reason = format!(
            "the outermost element is <{}>, and <{ROOT}> of MuJoCo is wanted",
            root.tag_name().name()
        );
        return Err(RobotError::NoTree { path: path.into(), reason }.into());
    }
    let tree = super::read(root, path)?;
    let selection = selection::select(&tree, base, tip)?;
    let settings = Settings::read(root, &Source::of(root, path))?;
    let classes = Classes::read(root);
    let (links, _) = serial::links(&tree, &selection);
    let elements = root.descendants().filter(Node::is_element);
    let nodes: HashMap<usize, Node<'_, '_>> = elements.map(|node| (node.range().start, node)).collect();
    let mut found = Vec::new();
    for link in &links {
        let joint = &tree.joints[link.joint];
        // The tree was read from this document, so the element is there.
        let Some(node) = nodes.get(&joint.start).copied() else { continue };
        let unit = if matches!(joint.freedom, Freedom::Turns(_)) { settings.angles.unit_rad } else { 1.0 };
        let bodies = || link.parts.iter().map(|part| body(&tree, part));
        found.push(MjcfLink {
            joint: dynamics(node, &classes, joint.name.clone(), unit),
            body: bodies().next().flatten(),
            carried: bodies().skip(1).flatten().collect(),
        });
    }
    Ok((serial::chain(&tree, &selection)?, found))
}

fn dynamics<'x>(node: Node<'x, 'x>, classes: &Classes<'x>, name: String, unit: f64) -> MjcfJoint {
    let around = node.ancestors().skip(1).find_map(|a| a.attribute("childclass"));
    // What is no number has been refused by the reader, or is of springs, which it does not read.
    let of = |name| {
        let text = classes.attribute(node, around, name);
        text.and_then(|t| t.trim().parse().ok()).unwrap_or(0.0)
    };
    MjcfJoint {
        name,
        start: node.range().start,
        armature: of("armature"),
        damping: of("damping"),
        friction_loss: of("frictionloss"),
        stiffness: of("stiffness"),
        spring_ref: of("springref"),
        unit,
    }
}

fn body(tree: &Tree, part: &Part) -> Option<MjcfBody> {
    let link = &tree.links[part.link];
    let place = link.place?;
    let Pose { rotation, origin_m } = part.pose.then(&place.frame);
    Some(MjcfBody {
        name: link.name.clone(),
        start: place.body,
        inertial: place.inertial,
        welded: part.welded,
        rotation: std::array::from_fn(|r| std::array::from_fn(|c| rotation[(r, c)])),
        origin_m: origin_m.into(),
        standard: part.standard,
    })
}
