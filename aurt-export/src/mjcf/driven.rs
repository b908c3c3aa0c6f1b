//! A chain with drives: actuators that follow commands, and a script for what MuJoCo has no words for.

use std::fmt::Write;

use aurt_rbd::SerialChain;
use aurt_traits::CommandSignal;
use serde_json::{Value, json};

use super::body::numbers;
use super::joint::JointDynamics;
use super::{HOLDS, body};
use crate::naming::{attribute, check_identifier, joint_names};
use crate::{Export, ExportError};

/// The script beside a model whose drives MuJoCo cannot express.
const SCRIPT: &str = include_str!("drive.py");

/// A joint with its drive in MuJoCo's words: force = clip(gain · command(t − delay) + bias − stiffness · q − braking · q̇).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DrivenJoint {
    /// Rotor and gear, kg m².
    pub armature: f64,
    /// All viscous friction, Nm s/rad.
    pub damping: f64,
    /// F_C, Nm.
    pub friction_loss: f64,
    /// Stops, rad; infinite ones are none.
    pub range: Option<[f64; 2]>,
    /// Force per command.
    pub gain: f64,
    /// Force without command, Nm.
    pub bias: f64,
    /// Force per position, Nm/rad.
    pub stiffness: f64,
    /// Force per velocity within the clipping, Nm s/rad.
    pub braking: f64,
    /// Largest force of the actuator.
    pub limit: Option<f64>,
    /// Delay of the command, s.
    pub delay_s: f64,
    /// Friction in proportion to the load; excess of break-away, Nm, and its speed, rad/s; limits of the planned reference.
    pub beyond: Beyond,
}

/// What MuJoCo has no words for, and the script does.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Beyond {
    /// F_L.
    pub per_load: f64,
    /// F_S, Nm.
    pub excess: f64,
    /// v_S, rad/s.
    pub stribeck: f64,
    /// Speed limit of the reference, rad/s.
    pub speed: Option<f64>,
    /// Acceleration limit of the reference, rad/s².
    pub acceleration: Option<f64>,
}

impl Beyond {
    fn to_json(self) -> Value {
        json!({ "per_load": self.per_load, "excess": self.excess, "stribeck": self.stribeck, "speed": self.speed, "acceleration": self.acceleration })
    }

    fn lost(self, joint: usize) -> Option<String> {
        let mut said = Vec::new();
        if self.per_load != 0.0 {
            said.push(format!("dry friction of {:.4} of the load", self.per_load));
        }
        if self.excess != 0.0 {
            said.push(format!("break-away {:.4} Nm above sliding", self.excess));
        }
        for (limit, unit) in [(self.speed, "rad/s"), (self.acceleration, "rad/s^2")] {
            said.extend(limit.map(|l| format!("a reference planned within {l:.4} {unit}")));
        }
        (!said.is_empty()).then(|| format!("joint {joint}: {}", said.join(", ")))
    }
}

/// A surface under a point of the last link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Height in the base frame, m.
    pub height_m: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// The point in the frame of the last link, m.
    pub point_m: [f64; 3],
}

/// The MJCF file of a chain with drives, and what it `lost` before. Who writes `data.ctrl` treats `command` as the estimate did:
/// the file states it as its custom text `command`.
///
/// # Errors
/// As [`super::export`].
pub fn driven(
    name: &str,
    chain: &SerialChain,
    standard: &[f64],
    joints: &[DrivenJoint],
    ground: Option<Ground>,
    command: CommandSignal,
    mut lost: Vec<String>,
) -> Result<Export, ExportError> {
    check_identifier(name)?;
    let names = joint_names(chain, attribute, &[]);
    let dynamics: Vec<JointDynamics> = joints
        .iter()
        .map(|j| JointDynamics {
            armature: j.armature,
            damping: j.damping,
            friction_loss: j.friction_loss,
            range: j.range,
            ..JointDynamics::default()
        })
        .collect();
    let mut plane = String::new();
    let mut tip = String::new();
    if let Some(Ground { height_m, friction, point_m }) = ground {
        let rubs = format!("friction=\"{friction:?} 0 0\" priority=\"1\" solref=\"0.004 1\"");
        let _ = writeln!(
            plane,
            "    <geom name=\"floor\" type=\"plane\" size=\"1 1 0.1\" pos=\"0 0 {height_m:?}\" contype=\"2\" conaffinity=\"0\" {rubs}/>"
        );
        let _ = writeln!(
            tip,
            "<geom name=\"tip\" size=\"1e-4\" pos=\"{}\" contype=\"0\" conaffinity=\"2\" mass=\"0\"/>",
            numbers(&point_m)
        );
    }
    let bodies = body::tree(name, &names, chain, standard, &dynamics, &tip)?;
    let beyond: Vec<String> =
        joints.iter().enumerate().filter_map(|(j, joint)| joint.beyond.lost(j)).collect();
    let needs_script = !beyond.is_empty();
    lost.splice(0..0, beyond);
    let said: String = lost.iter().map(|l| format!("  {}\n", l.replace("--", "- -"))).collect();
    let [x, y, z] = chain.gravity_m_s2();
    let (signal, between, order) = match command {
        CommandSignal::Hold => ("hold", "`data.ctrl` holds the last one", "zoh"),
        CommandSignal::Linear => ("linear", "`data.ctrl` is on the line between them", "linear"),
    };
    let mut text = format!(
        "<!--\n  {name}, written by `aurt export mjcf`. Tried with MuJoCo 4.0; older versions have no delay of actuators.\n  \
         Between two commands, {between}.\n  MuJoCo cannot express:\n{said}-->\n\
         <mujoco model=\"{name}\">\n  <custom>\n    <text name=\"command\" data=\"{signal}\"/>\n  </custom>\n  <compiler angle=\"radian\" inertiafromgeom=\"false\"/>\n  \
         <option gravity=\"{x:?} {y:?} {z:?}\" timestep=\"0.001\" integrator=\"implicitfast\"/>\n  <default>\n    \
         <joint {HOLDS}/>\n  </default>\n  <worldbody>\n{plane}{bodies}  </worldbody>\n  <actuator>\n"
    );
    for (j, (joint, own)) in names.iter().zip(joints).enumerate() {
        let law = numbers(&[own.bias, -own.stiffness, -own.braking]);
        let _ = write!(
            text,
            "    <general name=\"drive_{j}\" joint=\"{joint}\" gainprm=\"{:?}\" biastype=\"affine\" biasprm=\"{law}\"",
            own.gain
        );
        if let Some(limit) = own.limit {
            let _ = write!(text, " forcerange=\"{:?} {limit:?}\"", -limit);
        }
        if own.delay_s > 0.0 {
            // Samples of the history reach back by the delay at steps of a quarter of a millisecond.
            let samples = (own.delay_s / 2.5e-4).ceil() + 2.0;
            let _ = write!(text, " delay=\"{:?}\" nsample=\"{samples}\" interp=\"{order}\"", own.delay_s);
        }
        text.push_str("/>\n");
    }
    text.push_str("  </actuator>\n</mujoco>\n");
    let mut files = vec![(format!("{name}.xml"), text)];
    let mut notes =
        vec![format!("friction loss holds by `{HOLDS}`; with MuJoCo's own settings joints at rest creep")];
    if needs_script {
        let numbers: Vec<Value> = joints
            .iter()
            .map(|j| {
                let mut numbers = j.beyond.to_json();
                numbers["coulomb"] = json!(j.friction_loss);
                numbers
            })
            .collect();
        let numbers = json!(numbers).to_string().replace("null", "None").replace("},{", "},\n    {");
        files.push((
            format!("{name}_drive.py"),
            SCRIPT.replace("JOINTS = []", &format!("JOINTS = {numbers}")),
        ));
        notes.push(format!("`{name}_drive.py` does in each step what MuJoCo has no words for"));
    }
    Ok(Export { files, lost, notes })
}
