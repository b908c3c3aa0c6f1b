//! Where a file has the bodies and joints of a chain, for programs that correct it in place.

use std::path::Path;

use crate::INERTIAL_PARAMETERS;

use crate::robots::pose::Pose;
use crate::robots::serial::{self, LinkPart};
use crate::robots::tree::{Tree, TreeJoint};
use crate::robots::{DescribedRobot, Part, RobotError, RobotErrors, element, mjcf, selection, urdf};

/// A format of robot descriptions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Of MuJoCo.
    Mjcf,
    /// Of ROS.
    Urdf,
}

/// A link of a chain, as a file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedLink {
    /// The joint that moves it.
    pub joint: PlacedJoint,
    /// The body that the joint moves; none for a link between two joints of one MJCF body.
    pub body: Option<PlacedBody>,
    /// What else it consists of: bodies that are welded to it, and bodies on joints beside the chain.
    pub carried: Vec<PlacedBody>,
}

/// A joint and what the file says of its dynamics, defaults of its class included, in the units of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedJoint {
    /// Its name.
    pub name: String,
    /// Byte at which its element begins.
    pub start: usize,
    /// Inertia of the rotor, kg m² or kg.
    pub armature: f64,
    /// Viscous friction, Nm s/rad or N s/m.
    pub damping: f64,
    /// Coulomb friction, Nm or N.
    pub friction_loss: f64,
    /// Stiffness of its spring, Nm/rad or N/m.
    pub stiffness: f64,
    /// Where that rests, in the file's unit of angles, or m.
    pub spring_ref: f64,
    /// That unit in rad; 1 of a joint that slides.
    pub unit: f64,
    /// Whether its actuators have armature or damping.
    pub is_driven: bool,
}

/// A body.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedBody {
    /// Its name.
    pub name: String,
    /// Byte at which the element `body` or `link` begins.
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

/// A part of a file of a format, as [`parse`](crate::robots::parse) gives it, and the places of its links.
///
/// # Errors
/// As [`read`](crate::robots::read); a file of another format.
pub fn placed_links(
    text: &str,
    path: impl AsRef<Path>,
    format: Format,
    base: Option<&str>,
    part: &Part,
) -> Result<(DescribedRobot, Vec<PlacedLink>), RobotErrors> {
    let path = path.as_ref();
    let document = element::document(text, path)?;
    let root = document.root_element();
    let (wanted, program) = match format {
        Format::Mjcf => (mjcf::ROOT, "MuJoCo"),
        Format::Urdf => (urdf::ROOT, "URDF"),
    };
    if !root.has_tag_name(wanted) {
        let found = root.tag_name().name();
        let reason = format!("the outermost element is <{found}>, and <{wanted}> of {program} is wanted");
        return Err(RobotError::NoTree { path: path.into(), reason }.into());
    }
    let tree = match format {
        Format::Mjcf => mjcf::read(root, path)?,
        Format::Urdf => urdf::read(root, path)?,
    };
    let selection = selection::select(&tree, base, part)?;
    let (links, _) = serial::links(&tree, &selection);
    let found = links.iter().map(|link| {
        let mut bodies = link.parts.iter().map(|part| body(&tree, part));
        PlacedLink {
            joint: joint(&tree.joints[link.joint]),
            body: bodies.next().flatten(),
            carried: bodies.flatten().collect(),
        }
    });
    Ok((serial::robot(&tree, base, part.clone())?, found.collect()))
}

fn joint(joint: &TreeJoint) -> PlacedJoint {
    PlacedJoint {
        name: joint.name.clone(),
        start: joint.start,
        armature: joint.armature,
        damping: joint.friction.viscous_nm_s_rad,
        friction_loss: joint.friction.coulomb_nm,
        stiffness: joint.spring.stiffness,
        spring_ref: joint.spring.reference,
        unit: joint.spring.unit,
        is_driven: joint.driven != [0.0; 2],
    }
}

fn body(tree: &Tree, part: &LinkPart) -> Option<PlacedBody> {
    let link = &tree.links[part.link];
    let place = link.place?;
    let Pose { rotation, origin_m } = part.pose.then(&place.frame);
    Some(PlacedBody {
        name: link.name.clone(),
        start: place.body,
        inertial: place.inertial,
        welded: part.welded,
        rotation: rotation.transpose().into(),
        origin_m: origin_m.into(),
        standard: part.standard,
    })
}
