//! A calibrated arm with drives as actuators of Isaac Lab, and what the conversion costs.

use crate::Experiment;
use aurt::Progress;
use aurt_calibration::drives::{DriveRecording, DrivenArm, stem};
use aurt_diagnosis::drives::Missed;
use aurt_export::isaac::{self, Actuator};
use aurt_traits::CommandSignal;

use super::setting::{of_drive, options_of, read_all};
use super::{CalibratedDrive, UNLIMITED, braking, follows_positions, number_of, values};
use crate::workbench::exporting::Exported;
use crate::workbench::failure::Failure;

/// What Isaac Lab has no number for, with the value at which it does nothing. Its friction of rest ends with the first motion.
const DROPPED: [(&str, f64); 9] = [
    ("speed_limit_rad_s", UNLIMITED),
    ("acceleration_limit_rad_s2", UNLIMITED),
    ("dead_band_rad", 0.0),
    ("command_offset_rad", 0.0),
    ("integral_nm_per_rad_s", 0.0),
    ("coulomb_per_load", 0.0),
    ("stribeck_velocity_rad_s", 1e-3),
    ("viscous_asymmetry_nm_s_per_rad", 0.0),
    ("torque_offset_nm", 0.0),
];

impl CalibratedDrive {
    /// The actuators of a robot called `name`; with an experiment, what is lost is said as the error of its held-out recordings.
    pub fn to_isaac(&self, name: &str, experiment: Option<&Experiment>) -> Result<Exported, Failure> {
        let arm = &self.arm;
        if !follows_positions(arm) {
            let reason = "actuators of Isaac Lab follow positions, and these drives do not";
            return Err(Failure::argument("TARGET", reason, "export a drive that follows positions"));
        }
        let actuator = |joint: &aurt_calibration::drives::DrivenJoint| {
            let (mechanics, [inside, behind]) = (&joint.mechanics, braking(joint));
            let of = |key: &str| number_of(joint, key).unwrap_or(0.0);
            Actuator {
                stiffness: of("gain_nm_per_rad"),
                damping: inside,
                armature: mechanics.rotor_inertia_kg_m2,
                friction: mechanics.coulomb_nm + mechanics.static_nm,
                dynamic_friction: mechanics.coulomb_nm,
                viscous_friction: mechanics.viscous_nm_s_per_rad + behind,
                effort_limit: Some(of("torque_limit_nm")).filter(|l| *l < UNLIMITED),
                delay_s: of("delay_s"),
            }
        };
        let actuators: Vec<Actuator> = arm.joints.iter().map(actuator).collect();
        let mut lost = Vec::new();
        if arm.command == CommandSignal::Linear {
            lost.push("commands on the line between two of them: actuators of Isaac Lab hold the last, half a period later on average".to_owned());
        }
        let held_out = experiment.map(|e| self.held_out(e)).transpose()?;
        let miss = |arm: &DrivenArm| -> Result<String, Failure> {
            let (Some(experiment), Some(held_out)) = (experiment, &held_out) else {
                return Ok(String::new());
            };
            let missed = Missed::of(arm, held_out, &options_of(experiment));
            let rms = 1e3 * missed.map_err(|e| of_drive(&e, experiment, &[]))?.rms_all_rad();
            Ok(format!("; held-out positions {rms:.2}e-3 without it"))
        };
        for (key, _) in DROPPED {
            let without = without(arm, &[key]);
            if without != values(arm) {
                let joints =
                    arm.names().into_iter().zip(values(arm)).zip(&without).filter(|((_, v), w)| v != *w);
                let list: Vec<String> =
                    joints.map(|((name, value), _)| format!("{name} {value:.4}")).collect();
                lost.push(format!("{}{}", list.join(", "), miss(&with(arm, &without))?));
            }
        }
        if held_out.is_some() && !lost.is_empty() {
            let all = without(arm, &DROPPED.map(|d| d.0));
            let [whole, reduced] =
                [miss(arm)?, miss(&with(arm, &all))?].map(|m| m.replace("; ", "").replace(" without it", ""));
            lost.push(format!("all of this: {whole} before, {reduced} after"));
        }
        Ok(isaac::export(name, &arm.chain, &actuators, lost)?.into())
    }

    fn held_out(&self, experiment: &Experiment) -> Result<Vec<DriveRecording>, Failure> {
        let read = read_all(experiment, &self.arm, &mut Vec::new(), &Progress::silent())?;
        Ok(read.into_iter().filter(|r| r.held_out).map(|r| r.recording).collect())
    }
}

/// The numbers without those under `keys`; the speed of a break-away that is not there does not count.
fn without(arm: &DrivenArm, keys: &[&str]) -> Vec<f64> {
    let mut left = values(arm);
    let names = arm.names();
    for (value, name) in left.iter_mut().zip(&names) {
        let joint: usize = name[stem(name).len()..].trim_start_matches('_').parse().unwrap_or_default();
        let holds = arm.joints.get(joint).is_some_and(|j| j.mechanics.static_nm > 0.0);
        let own = DROPPED.iter().find(|d| d.0 == stem(name) && keys.contains(&d.0));
        if let Some((_, nothing)) = own.filter(|d| holds || d.0 != "stribeck_velocity_rad_s") {
            *value = *nothing;
        }
    }
    left
}

fn with(arm: &DrivenArm, values: &[f64]) -> DrivenArm {
    let mut arm = arm.clone();
    arm.set_numbers(values);
    arm
}
