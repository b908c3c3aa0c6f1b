//! Robots as they are described elsewhere: chains and trees of URDF and MJCF files, and robots known by name.
//!
//! [`read`] takes a [`Part`] of a URDF file or an MJCF file of MuJoCo: revolute, continuous and prismatic joints with axes in
//! any direction, bodies behind fixed joints merged into the links that carry them, other joints carried as fixed at
//! zero posture. [`KNOWN_ROBOTS`] lists geometry and limits of common arms. Either gives a [`DescribedRobot`].
//!
//! Files are read with limits ([`MOST_BYTES`], no document type, hence no entities); nothing that they refer to, such as
//! meshes, is opened.

mod description;
mod element;
mod error;
mod known;
mod mdh;
mod mjcf;
mod parameters;
mod places;
mod pose;
mod selection;
mod serial;
mod tree;
mod urdf;

use std::path::Path;

pub use description::{DescribedRobot, JointFriction, JointLimits, Part};
pub use error::{RobotError, RobotErrors};
pub use known::{KNOWN_ROBOTS, KnownRobot, known_robot, probably_meant};
pub use mdh::AsMdh;
pub use mjcf::{PositionActuator, position_actuators};
pub use parameters::ParameterFile;
pub use places::{Format, PlacedBody, PlacedJoint, PlacedLink, placed_links};

/// Files above this size are refused: descriptions of whole humanoids take half a megabyte.
pub const MOST_BYTES: u64 = 64 << 20;

/// Reads the joints of a part of a robot description file, on the link `base` or the file's root: a tree, or a chain where
/// there is no more. Joints come in the file's order, each after those that carry it; of a part that names tips or joints,
/// branches come in the order of these names. A parameter file corrects what the file states.
///
/// # Errors
/// Everything that is wrong with the file, each with its place; parameters of joints and bodies that the file has not.
pub fn read(
    path: impl AsRef<Path>,
    base: Option<&str>,
    part: &Part,
    parameters: Option<&ParameterFile>,
) -> Result<DescribedRobot, RobotErrors> {
    let path = path.as_ref();
    parse(&text_of(path)?, path, base, part, parameters)
}

fn text_of(path: &Path) -> Result<String, RobotErrors> {
    let unreadable = |source| RobotErrors::from(RobotError::Unreadable { path: path.into(), source });
    aurt_files::read_text(path, MOST_BYTES).map_err(unreadable)
}

/// As [`read`], from text; `path` is what errors call it.
///
/// # Errors
/// As [`read`].
pub fn parse(
    text: &str,
    path: impl AsRef<Path>,
    base: Option<&str>,
    part: &Part,
    parameters: Option<&ParameterFile>,
) -> Result<DescribedRobot, RobotErrors> {
    let mut tree = tree(text, path.as_ref())?;
    parameters.map_or(Ok(()), |parameters| parameters.correct(&mut tree))?;
    serial::robot(&tree, base, part.clone())
}

/// The links at which the moving chains of a robot description end, in the file's order; chains that differ only by
/// fixed joints count once.
///
/// # Errors
/// As [`read`].
pub fn tips(text: &str, path: impl AsRef<Path>, base: Option<&str>) -> Result<Vec<String>, RobotErrors> {
    let tree = tree(text, path.as_ref())?;
    let base = selection::base_of(&tree, base)?;
    Ok(selection::tips(&tree, base).into_iter().map(|tip| tree.links[tip].name.clone()).collect())
}

/// Whether a text is an MJCF file, by its outermost element.
pub fn is_mjcf(text: &str) -> bool {
    element::document(text, Path::new("")).is_ok_and(|d| d.root_element().tag_name().name() == mjcf::ROOT)
}

/// The links and joints of a file in either format.
fn tree(text: &str, path: &Path) -> Result<tree::Tree, RobotErrors> {
    let document = element::document(text, path)?;
    let root = document.root_element();
    if root.tag_name().name() == mjcf::ROOT { mjcf::read(root, path) } else { urdf::read(root, path) }
}
