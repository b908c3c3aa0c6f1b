//! Isaac Lab: actuators of drives that follow positions, as a Python file.
//!
//! PhysX (Isaac Sim 5 and later) holds a joint at rest up to `friction`, brakes a moving one by `dynamic_friction`, both in Nm, and
//! by `viscous_friction` q̇; the actuator gives clip(stiffness (q*(t − delay) − q) − damping q̇) within `effort_limit`.

use std::fmt::Write;

use aurt_rbd::SerialChain;

use crate::naming::{attribute, check_identifier, joint_names};
use crate::{Export, ExportError};

/// A joint with its drive in Isaac Lab's words.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Actuator {
    /// Nm/rad.
    pub stiffness: f64,
    /// Within the limit of the effort, Nm s/rad.
    pub damping: f64,
    /// kg m².
    pub armature: f64,
    /// What holds a joint at rest, Nm.
    pub friction: f64,
    /// What brakes a moving joint, Nm.
    pub dynamic_friction: f64,
    /// Nm s/rad.
    pub viscous_friction: f64,
    /// Nm; none leaves the limit of the scene's file.
    pub effort_limit: Option<f64>,
    /// Of the command, s.
    pub delay_s: f64,
}

/// A name with the number that it has in an actuator.
type Setting = (&'static str, fn(&Actuator) -> Option<f64>);

const SETTINGS: [Setting; 7] = [
    ("stiffness", |a| Some(a.stiffness)),
    ("damping", |a| Some(a.damping)),
    ("armature", |a| Some(a.armature)),
    ("friction", |a| Some(a.friction)),
    ("dynamic_friction", |a| Some(a.dynamic_friction)),
    ("viscous_friction", |a| Some(a.viscous_friction)),
    ("effort_limit", |a| a.effort_limit),
];

/// The Python file of the actuators of a robot called `name`, and what it `lost` before.
///
/// # Errors
/// [`ExportError::Name`].
pub fn export(
    name: &str,
    chain: &SerialChain,
    actuators: &[Actuator],
    lost: Vec<String>,
) -> Result<Export, ExportError> {
    check_identifier(name)?;
    let plain = |text: &str| attribute(text).replace(['"', '\\'], "_");
    let mut joints = String::new();
    for (joint, actuator) in joint_names(chain, plain, &[]).iter().zip(actuators) {
        let settings =
            SETTINGS.iter().filter_map(|(key, of)| of(actuator).map(|v| format!("\"{key}\": {v:?}")));
        let settings = settings.collect::<Vec<_>>().join(", ");
        let _ = writeln!(joints, "    \"{joint}\": ({:?}, {{{settings}}}),", actuator.delay_s);
    }
    let said: String = lost.iter().map(|l| format!("  {}\n", plain(l))).collect();
    let text = format!(
        "\"\"\"{name}, written by `aurt export isaac` for Isaac Lab with Isaac Sim 5 or later (friction in Nm).\n\n\
         Isaac Lab cannot express:\n{said}\"\"\"\n\n\
         # Of each joint the delay of its command in s, and its settings in SI units.\n\
         JOINTS = {{\n{joints}}}\n\n\n\
         def actuators(physics_dt_s):\n    \
             \"\"\"`ArticulationCfg.actuators` at a step of the physics; delays are rounded to whole steps.\"\"\"\n    \
             from isaaclab.actuators import DelayedPDActuatorCfg\n\n    \
             configured = {{}}\n    \
             for joint, (delay_s, settings) in JOINTS.items():\n        \
                 steps = round(delay_s / physics_dt_s)\n        \
                 configured[joint] = DelayedPDActuatorCfg(\n            \
                     joint_names_expr=[joint], min_delay=steps, max_delay=steps, **settings\n        )\n    \
             return configured\n"
    );
    let notes = vec![
        "stops, loads, zeros of the joints and the floor belong to the scene's file".into(),
        "BAM's JSON is not written: positions do not tell torque constant, resistance and the firmware's gain apart".into()];
    Ok(Export { files: vec![(format!("{name}_actuators.py"), text)], lost, notes })
}
