//! MuJoCo: a complete model file of a robot.
//!
//! Bodies carry the inertias of a calibration that found some a machine can have. Joints carry armature (the rotors), damping
//! (linear viscous friction), friction loss (the Coulomb level without load) and springs. All else has no word in MuJoCo:
//! it is listed in the file and in [`Export::lost`]. [`crate::into`] corrects the user's own file instead.

pub(crate) mod body;
mod driven;
pub(crate) mod joint;

use std::fmt::Write;

pub use driven::{Beyond, DrivenJoint, Ground, driven};

use crate::naming::{attribute, check_identifier, joint_names};
use crate::source::heading;
use crate::{Export, ExportError, Source};

/// Friction loss that holds: MuJoCo's own settings let a joint creep under a load that friction bears, and its friction
/// turns 9.5 ms before the velocity does. A time constant below two steps counts as two steps.
const HOLDS: &str = "solreffriction=\"0.002 1\" solimpfriction=\"0.9999 0.9999 0.001\"";

/// The MJCF file of a model.
///
/// # Errors
/// [`ExportError::NoBodies`] without standard parameters, [`ExportError::Impossible`] with those of no machine; models in
/// amperes; names that are no identifiers.
pub fn export(source: &Source<'_>) -> Result<Export, ExportError> {
    check_identifier(source.name)?;
    let chain = source.chain()?;
    let standard = source.possible_bodies()?;
    let (joints, mut lost) = joint::dynamics(source);
    lost.push("limits of positions and torques, and shapes that collide: the model file has none".into());
    let names = joint_names(chain, attribute, &[]);
    let bodies = body::tree(source.name, &names, chain, standard, &joints, "")?;

    let first = format!("{}, written by `aurt export mjcf`.", source.name);
    let mut text = heading(source, first, &[], "MuJoCo", &lost);
    let [x, y, z] = chain.gravity_m_s2();
    let _ = write!(
        text,
        "<mujoco model=\"{}\">\n  <compiler angle=\"radian\" inertiafromgeom=\"false\"/>\n  \
         <option gravity=\"{x:?} {y:?} {z:?}\" integrator=\"implicitfast\"/>\n  <default>\n    \
         <joint {HOLDS}/>\n  </default>\n  <worldbody>\n{bodies}  </worldbody>\n  \
         <actuator>\n",
        source.name
    );
    for (j, joint) in names.iter().enumerate() {
        let _ = writeln!(text, "    <motor name=\"motor_{j}\" joint=\"{joint}\"/>");
    }
    text.push_str("  </actuator>\n</mujoco>\n");
    let notes = vec![
        "capsules from joint to joint are there to be seen; they neither weigh nor collide".into(),
        format!("friction loss holds by `{HOLDS}`; with MuJoCo's own settings joints at rest creep"),
        "friction loss acts without load; friction that grows with the load is larger than it says".into(),
    ];
    Ok(Export { files: vec![(format!("{}.xml", source.name), text)], lost, notes })
}
