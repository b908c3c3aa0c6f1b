//! SDF: a complete description of a robot for Gazebo, version 1.9 of <http://sdformat.org/spec>.
//!
//! As in [`crate::urdf`], links carry the inertias of a calibration that found some a machine can have, joints the linear
//! viscous friction as `damping` and the Coulomb level without load as `friction`; springs have words here. The base is fixed
//! to the world. Rotors' inertias have no element; they and all else that is lost are listed in the file and in
//! [`Export::lost`].

use std::fmt::Write;

use aurt_rbd::{INERTIAL_PARAMETERS, JointKind, LinkBody};

use crate::mjcf::body::numbers;
use crate::mjcf::joint::{JointDynamics, dynamics};
use crate::naming::{attribute, check_identifier, joint_names};
use crate::source::{frames, heading};
use crate::urdf::{UNLIMITED, roll_pitch_yaw, rotors_lost, world_lost};
use crate::{Export, ExportError, Source};

/// The SDF file of a model.
///
/// # Errors
/// [`ExportError::NoBodies`] without standard parameters, [`ExportError::Impossible`] with those of no machine; models in
/// amperes; names that are no identifiers.
pub fn export(source: &Source<'_>) -> Result<Export, ExportError> {
    check_identifier(source.name)?;
    let chain = source.chain()?;
    let standard = source.possible_bodies()?;
    let name = source.name;
    let (joints, mut lost) = dynamics(source);
    lost.extend(rotors_lost(&joints));
    lost.extend(world_lost(chain));

    let first = format!("{name}, written by `aurt export sdf`.");
    let mut text = String::from("<?xml version=\"1.0\"?>\n") + &heading(source, first, &[], "SDF", &lost);
    let _ = write!(
        text,
        "<sdf version=\"1.9\">\n<model name=\"{name}\">\n  <link name=\"{name}_base\"/>\n  <joint name=\"{name}_mount\" \
         type=\"fixed\">\n    <parent>world</parent>\n    <child>{name}_base</child>\n  </joint>\n"
    );
    let (bodies, _) = standard.as_chunks::<INERTIAL_PARAMETERS>();
    // Links and joints share their names in SDF; `::` divides names.
    let mut taken = vec![format!("{name}_base"), format!("{name}_mount"), "world".to_owned()];
    taken.extend((0..joints.len()).map(|j| format!("{name}_link_{j}")));
    let names = joint_names(chain, |joint| attribute(&joint.replace("::", ":_")), &taken);
    for (j, (frame, body)) in frames(chain)?.iter().zip(bodies).enumerate() {
        let called = |link: usize| format!("{name}_link_{link}");
        let (parent, child) = (chain.parent(j).map_or_else(|| format!("{name}_base"), called), called(j));
        let kind = match chain.joints()[j].kind {
            JointKind::Revolute => "revolute",
            JointKind::Prismatic => "prismatic",
        };
        let [origin, turn] = [frame.origin_m, roll_pitch_yaw(&frame.rotation)].map(|v| numbers(&v));
        let JointDynamics { damping, friction_loss, stiffness, spring_ref, .. } = joints[j];
        let mut acts = format!("<damping>{damping:?}</damping><friction>{friction_loss:?}</friction>");
        if stiffness != 0.0 {
            let _ = write!(
                acts,
                "<spring_reference>{spring_ref:?}</spring_reference><spring_stiffness>{stiffness:?}</spring_stiffness>"
            );
        }
        let _ = write!(
            text,
            "  <joint name=\"{}\" type=\"{kind}\">\n    <pose relative_to=\"{parent}\">{origin} {turn}</pose>\n    \
             <parent>{parent}</parent>\n    <child>{child}</child>\n    <axis>\n      <xyz>0 0 {}</xyz>\n      \
             <limit><lower>-{UNLIMITED}</lower><upper>{UNLIMITED}</upper></limit>\n      <dynamics>{acts}</dynamics>\n    \
             </axis>\n  </joint>\n",
            names[j],
            chain.joints()[j].sign
        );
        let body = LinkBody::from_standard_parameters(body).ok_or(ExportError::NoBodies)?;
        let [xx, xy, xz, yy, yz, zz] = body.inertia_at_com_kg_m2;
        let _ = write!(
            text,
            "  <link name=\"{child}\">\n    <pose relative_to=\"{}\">0 0 0 0 0 0</pose>\n    <inertial>\n      \
             <pose>{} 0 0 0</pose>\n      <mass>{:?}</mass>\n      <inertia><ixx>{xx:?}</ixx><ixy>{xy:?}</ixy><ixz>{xz:?}</ixz>\
             <iyy>{yy:?}</iyy><iyz>{yz:?}</iyz><izz>{zz:?}</izz></inertia>\n    </inertial>\n  </link>\n",
            names[j],
            numbers(&body.com_m),
            body.mass_kg,
        );
    }
    text.push_str("</model>\n</sdf>\n");
    let notes = vec![
        "friction acts without load; friction that grows with the load is larger than it says".into(),
        "the base is fixed to the world where it stands; remove the joint to mount it elsewhere".into(),
    ];
    Ok(Export { files: vec![(format!("{name}.sdf"), text)], lost, notes })
}
