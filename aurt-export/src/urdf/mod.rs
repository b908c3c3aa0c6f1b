//! URDF: a complete description of a robot, for Gazebo, Isaac and all else that reads it.
//!
//! Links carry the inertias of a calibration that found some a machine can have, joints the linear viscous friction as
//! `damping` and the Coulomb level without load as `friction`. Rotors' inertias have no element in URDF; they and all else
//! that is lost are listed in the file and in [`Export::lost`].

use std::fmt::Write;

use aurt_rbd::{INERTIAL_PARAMETERS, JointKind, LinkBody, SerialChain};

use crate::mjcf::body::numbers;
use crate::mjcf::joint::{JointDynamics, dynamics};
use crate::naming::{attribute, check_identifier, joint_names};
use crate::source::{frames, heading};
use crate::{Export, ExportError, Source};

/// Limits that do not limit: the file must state some of prismatic joints, and the model knows none.
pub(crate) const UNLIMITED: &str = "1e16";

/// The URDF file of a model.
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
    lost.extend(springs_lost(&joints));
    lost.extend(world_lost(chain));

    let first = format!("{name}, written by `aurt export urdf`.");
    let mut text = String::from("<?xml version=\"1.0\"?>\n") + &heading(source, first, &[], "URDF", &lost);
    let _ = write!(text, "<robot name=\"{name}\">\n  <link name=\"{name}_base\"/>\n");
    let (bodies, _) = standard.as_chunks::<INERTIAL_PARAMETERS>();
    let names = joint_names(chain, attribute, &[]);
    for (j, (frame, body)) in frames(chain)?.iter().zip(bodies).enumerate() {
        let called = |link: usize| format!("{name}_link_{link}");
        let (parent, child) = (chain.parent(j).map_or_else(|| format!("{name}_base"), called), called(j));
        let kind = chain.joints()[j].kind;
        let [origin, turn] = [frame.origin_m, roll_pitch_yaw(&frame.rotation)].map(|v| numbers(&v));
        let _ = write!(
            text,
            "  <joint name=\"{}\" type=\"{}\">\n    <parent link=\"{parent}\"/>\n    <child link=\"{child}\"/>\n    \
             <origin xyz=\"{origin}\" rpy=\"{turn}\"/>\n    <axis xyz=\"0 0 {}\"/>\n",
            names[j],
            match kind {
                JointKind::Revolute => "continuous",
                JointKind::Prismatic => "prismatic",
            },
            chain.joints()[j].sign
        );
        let JointDynamics { damping, friction_loss, .. } = joints[j];
        let _ = writeln!(text, "    <dynamics damping=\"{damping:?}\" friction=\"{friction_loss:?}\"/>");
        if kind == JointKind::Prismatic {
            let _ = writeln!(
                text,
                "    <limit lower=\"-{UNLIMITED}\" upper=\"{UNLIMITED}\" effort=\"{UNLIMITED}\" velocity=\"{UNLIMITED}\"/>"
            );
        }
        text.push_str("  </joint>\n");
        link(&mut text, &child, body)?;
    }
    text.push_str("</robot>\n");
    let notes =
        vec!["friction acts without load; friction that grows with the load is larger than it says".into()];
    Ok(Export { files: vec![(format!("{name}.urdf"), text)], lost, notes })
}

/// Rotors' inertias, which robot descriptions have no element for.
pub(crate) fn rotors_lost(joints: &[JointDynamics]) -> Vec<String> {
    let turning = joints.iter().enumerate().filter(|(_, joint)| joint.armature != 0.0);
    turning
        .map(|(j, joint)| {
            format!(
                "rotor inertia of joint {j}: {:?} kg m^2; set it where the engine has it, as `armature` in Isaac, MuJoCo and Drake",
                joint.armature
            )
        })
        .collect()
}

pub(crate) fn springs_lost(joints: &[JointDynamics]) -> Vec<String> {
    let springs = joints.iter().enumerate().filter(|(_, joint)| joint.stiffness != 0.0);
    springs
        .map(|(j, JointDynamics { stiffness, spring_ref, .. })| {
            format!("spring of joint {j}: {stiffness:.4} N m/rad about {spring_ref:.4} rad")
        })
        .collect()
}

/// What is of the world, or unknown to the model file.
pub(crate) fn world_lost(chain: &SerialChain) -> [String; 2] {
    let [x, y, z] = chain.gravity_m_s2();
    [
        format!("gravity, {x} {y} {z} m/s^2 in the base frame: the world has it"),
        "limits of positions, velocities and torques, and shapes: the model file has none".into(),
    ]
}

fn link(text: &mut String, name: &str, standard: &[f64; INERTIAL_PARAMETERS]) -> Result<(), ExportError> {
    let body = LinkBody::from_standard_parameters(standard).ok_or(ExportError::NoBodies)?;
    let [xx, xy, xz, yy, yz, zz] = body.inertia_at_com_kg_m2;
    let _ = write!(
        text,
        "  <link name=\"{name}\">\n    <inertial>\n      <origin xyz=\"{}\" rpy=\"0 0 0\"/>\n      <mass value=\"{:?}\"/>\n      \
         <inertia ixx=\"{xx:?}\" ixy=\"{xy:?}\" ixz=\"{xz:?}\" iyy=\"{yy:?}\" iyz=\"{yz:?}\" izz=\"{zz:?}\"/>\n    \
         </inertial>\n  </link>\n",
        numbers(&body.com_m),
        body.mass_kg,
    );
    Ok(())
}

/// Roll, pitch and yaw about fixed axes of R = Rot_z(yaw) Rot_y(pitch) Rot_x(roll).
pub(crate) fn roll_pitch_yaw(r: &[[f64; 3]; 3]) -> [f64; 3] {
    let level = r[0][0].hypot(r[1][0]);
    let pitch = (-r[2][0]).atan2(level);
    if level > 1e-12 {
        return [r[2][1].atan2(r[2][2]), pitch, r[1][0].atan2(r[0][0])];
    }
    // Roll and yaw turn about the same axis: roll takes it all.
    [(-r[1][2]).atan2(r[1][1]), pitch, 0.0]
}

#[cfg(test)]
mod tests {
    use aurt_rbd::{Joint, Placement};

    use super::*;

    #[test]
    fn angles_give_back_the_rotation_upright_ones_too() {
        let right = std::f64::consts::FRAC_PI_2;
        for angles in [[0.3, -0.7, 1.1], [0.0; 3], [0.4, right, 0.0], [-0.4, -right, 0.0], [3.0, 1.0, -3.0]] {
            let rotation = |angles| {
                let joint = Joint::revolute(Placement::from_roll_pitch_yaw([0.0; 3], angles));
                frames(&SerialChain::new(vec![joint], [0.0; 3]).unwrap()).unwrap()[0].rotation
            };
            let (wanted, found) = (rotation(angles), rotation(roll_pitch_yaw(&rotation(angles))));
            for (a, b) in wanted.iter().flatten().zip(found.iter().flatten()) {
                assert!((a - b).abs() < 1e-12, "{angles:?}: {wanted:?} {found:?}");
            }
        }
    }
}
