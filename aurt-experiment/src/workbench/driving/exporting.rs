//! A calibrated arm with drives as a MuJoCo model.

use std::path::Path;

use aurt_calibration::drives::{DriveRecording, DrivenArm};
use aurt_export::mjcf::{Beyond, DrivenJoint, Ground, driven};
use aurt_rbd::robots::{Part, parse};
use aurt_rbd::{INERTIAL_PARAMETERS, RobotDescription};
use aurt_recording::RobotJoints;

use super::fits::mjcf;
use super::second_opinion::given;
use super::{CalibratedDrive, UNLIMITED, braking, follows_positions, number_of};
use crate::workbench::exporting::Exported;
use crate::workbench::failure::Failure;

/// A stop that is not there beside one that is, rad.
const FAR_RAD: f64 = 1e3;
/// Sines on which a written file is compared: samples and their distance, amplitude without stops, and angular frequency of the
/// first joint.
const SAMPLES: usize = 500;
const STEP_S: f64 = 0.02;
const REACH_RAD: f64 = 0.3;
const SLOWEST_RAD_S: f64 = 2.0;

impl CalibratedDrive {
    /// The MuJoCo model of a robot called `name`, with a script for what MuJoCo has no words for.
    pub fn to_mjcf(&self, name: &str) -> Result<Exported, Failure> {
        let arm = &self.arm;
        let mut standard = arm.standard_parameters.clone();
        let (links, _) = standard.as_chunks_mut::<INERTIAL_PARAMETERS>();
        let mut lost = Vec::new();
        let mut joints = Vec::new();
        for (j, (joint, link)) in arm.joints.iter().zip(links).enumerate() {
            let mechanics = &joint.mechanics;
            let joint_name = self.names().joint(j);
            link.iter_mut().for_each(|p| *p *= mechanics.mass_scale);
            let of = |key: &str| number_of(joint, key);
            let get = |key: &str| of(key).unwrap_or(0.0);
            let limited = |key: &str| of(key).filter(|v| *v < UNLIMITED);
            let follows = of("gain_nm_per_rad");
            let gain = follows.or(of("torque_constant_nm_per_a")).or(of("torque_nm_per_v")).unwrap_or(1.0);
            let [inside, behind] = braking(joint);
            let stops = [mechanics.lower_stop_rad, mechanics.upper_stop_rad];
            for (key, unit) in [("dead_band_rad", "rad"), ("integral_nm_per_rad_s", "Nm/(rad s)")] {
                lost.extend(
                    Some(get(key))
                        .filter(|v| *v != 0.0)
                        .map(|v| format!("{joint_name}: {key} {v:.4} {unit}")),
                );
            }
            for (key, value) in [
                ("viscous_asymmetry_nm_s_per_rad", mechanics.viscous_asymmetry_nm_s_per_rad),
                ("position_offset_rad, to be added to recorded positions", mechanics.position_offset_rad),
            ] {
                lost.extend(Some(value).filter(|v| *v != 0.0).map(|v| format!("{joint_name}: {key} {v:.4}")));
            }
            joints.push(DrivenJoint {
                armature: mechanics.rotor_inertia_kg_m2,
                damping: mechanics.viscous_nm_s_per_rad + behind,
                friction_loss: mechanics.coulomb_nm,
                range: stops
                    .iter()
                    .any(|s| s.abs() < UNLIMITED)
                    .then(|| stops.map(|s| s.clamp(-FAR_RAD, FAR_RAD))),
                gain,
                bias: follows.map_or(0.0, |k| k * get("command_offset_rad")) + mechanics.torque_offset_nm,
                stiffness: follows.unwrap_or(0.0),
                braking: inside,
                limit: limited("torque_limit_nm"),
                delay_s: get("delay_s"),
                beyond: Beyond {
                    per_load: mechanics.coulomb_per_load,
                    excess: mechanics.static_nm,
                    stribeck: mechanics.stribeck_velocity_rad_s,
                    speed: limited("speed_limit_rad_s"),
                    acceleration: limited("acceleration_limit_rad_s2"),
                },
            });
        }
        let [x, y, z] = arm.chain.gravity_m_s2();
        let ground = arm.floor.filter(|_| x == 0.0 && y == 0.0 && z < 0.0).map(|floor| {
            lost.push(format!(
                "floor: its stiffness of {:.0} N/m; the engine's contact is stiff",
                floor.stiffness_n_per_m
            ));
            Ground {
                height_m: floor.height_m,
                friction: floor.friction,
                point_m: [floor.x_m, floor.y_m, floor.z_m],
            }
        });
        if ground.is_none() && arm.floor.is_some() {
            lost.push("the floor, which is not across the z axis of the base".into());
        }
        let mut exported: Exported =
            driven(name, &arm.chain, &standard, &joints, ground, arm.command, lost)?.into();
        if follows_positions(arm) {
            let compared = exported.files.first().map(|(name, text)| self.compared(name, text));
            exported.notes.extend(compared.map(|compared| {
                compared.unwrap_or_else(|e| format!("its positions were not compared with the model's: {e}"))
            }));
        }
        Ok(exported)
    }

    /// The positions of a written file, read back and simulated, beside those of the model.
    fn compared(&self, name: &str, contents: &[u8]) -> Result<String, Failure> {
        let (path, text) = (Path::new(name), String::from_utf8_lossy(contents));
        let (own, names) = (&self.arm, self.arm.chain.joint_names().to_vec());
        let described = parse(&text, path, None, &Part::All, None)?;
        if !names.is_empty() && described.joint_names != names {
            return Err(Failure::unfit(path, "lists the joints in another order", "compare it in MuJoCo"));
        }
        let joints = RobotJoints { names, ..RobotJoints::from(own.joints.len()) };
        let (mut read, _) = given(own, &mjcf(path, &text, None, &joints)?, self.names());
        read.chain = described.chain(own.chain.gravity_m_s2())?;
        read.standard_parameters = described.standard_parameters.unwrap_or_default();
        read.joints.iter_mut().for_each(|joint| joint.mechanics.mass_scale = 1.0);
        let time_s: Vec<f64> = (0..SAMPLES).map(|k| STEP_S * k as f64).collect();
        let sine = |(j, joint): (usize, &aurt_calibration::drives::DrivenJoint)| {
            let [low, high] = [joint.mechanics.lower_stop_rad, joint.mechanics.upper_stop_rad]
                .map(|stop| stop.clamp(-FAR_RAD, FAR_RAD) - joint.mechanics.position_offset_rad);
            let reach = (0.25 * (high - low)).min(REACH_RAD);
            let (middle, rate) = (0.0_f64.max(low + reach).min(high - reach), SLOWEST_RAD_S + 0.7 * j as f64);
            time_s.iter().map(|t| middle + reach * (rate * t).sin()).collect()
        };
        let command: Vec<Vec<f64>> = own.joints.iter().enumerate().map(sine).collect();
        let recording =
            DriveRecording { time_s, position_rad: command.clone(), command, ..DriveRecording::default() };
        let rollout = |arm: &DrivenArm| {
            arm.rollout(&recording).map_err(|e| Failure::unfit(path, e.to_string(), "simulate it in MuJoCo"))
        };
        let (ours, theirs) = (rollout(own)?, rollout(&read)?);
        let rms = ours.iter().zip(&theirs).enumerate().map(|(j, (ours, theirs))| {
            let squares: f64 = ours.iter().zip(theirs).map(|(a, b)| (a - b).powi(2)).sum();
            format!("{} {:.3}", self.names().joint(j), 1e3 * (squares / ours.len() as f64).sqrt())
        });
        let what = "read back and simulated by AURT without the script, its positions differ from the model's on sines of 10 s by \
                    (rms in 1e-3 rad or m)";
        Ok(format!("{what}: {}", rms.collect::<Vec<_>>().join(", ")))
    }
}
