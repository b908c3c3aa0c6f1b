//! What others fitted of drives and joints, in AURT's words.

use std::path::Path;

use aurt_calibration::drives::Mechanics;
use aurt_friction::drives::PositionServo;
use aurt_rbd::robots::{ParameterFile, Part, parse, position_actuators};
use aurt_recording::RobotJoints;
use serde_json::{Map, Value};

use crate::workbench::failure::Failure;

pub(super) struct Fit {
    pub kind: &'static str,
    /// One for each joint; surroundings (stops, loads) are not part of it.
    pub joints: Vec<(PositionServo, Mechanics)>,
    /// True where zeros of the joints are part of it.
    pub has_zeros: bool,
    pub lost: Vec<String>,
}

const MJCF: &str = "MJCF";
/// The least inertia that can be simulated.
const LEAST_ROTOR_KG_M2: f64 = 1e-7;

fn bare(gain_nm_per_rad: f64) -> PositionServo {
    PositionServo { gain_nm_per_rad, back_emf_nm_s_per_rad: 0.0, delay_s: 0.0, ..PositionServo::default() }
}

/// A rotor without friction.
fn rotor(rotor_inertia_kg_m2: f64) -> Mechanics {
    Mechanics { rotor_inertia_kg_m2: rotor_inertia_kg_m2.max(LEAST_ROTOR_KG_M2), ..Mechanics::default() }
}

/// The fit in a file: MJCF with actuators of positions, JSON of BAM, or JSON with the settings of Isaac Lab's actuators.
/// A parameter file corrects the first.
pub(super) fn read(path: &Path, parameters: Option<&Path>, joints: &RobotJoints) -> Result<Fit, Failure> {
    let parameters = &parameters.map(ParameterFile::read).transpose()?;
    let unreadable = |e: std::io::Error| Failure::unfit(path, e.to_string(), "name a file that can be read");
    let text = aurt_files::read_text(path, aurt_files::MOST_TEXT_BYTES).map_err(unreadable)?;
    if aurt_rbd::robots::is_mjcf(&text) {
        return mjcf(path, &text, parameters.as_ref(), joints);
    }
    let remedy = "name an MJCF file with actuators, BAM's JSON, or a JSON object with settings of Isaac Lab's actuators (`stiffness` …)";
    let value: Value = serde_json::from_str(&text)
        .map_err(|e| Failure::unfit(path, format!("is neither MJCF nor JSON: {e}"), remedy))?;
    match value.as_object() {
        Some(_) if parameters.is_some() => {
            let reason = "is not an MJCF file; --parameters corrects only these";
            Err(Failure::unfit(path, reason, "leave out --parameters; PACE's `mean` is part of JSON itself"))
        }
        Some(table) if table.contains_key("kt") => bam(path, table, joints.count),
        Some(table) if table.contains_key("stiffness") => isaac(path, &pace(path, table)?, joints),
        Some(table) if table.contains_key("drive_schema") => {
            let reason = "is a model of AURT itself, and `--model` compares what others fitted with the experiment's own";
            let remedy = "run the experiment without it, or write its numbers under [drive] with `estimate = []` and use `aurt run`";
            Err(Failure::unfit(path, reason, remedy))
        }
        _ => Err(Failure::unfit(path, "has neither `kt` (BAM) nor `stiffness` (Isaac Lab)", remedy)),
    }
}

fn correct(fit: &mut Fit, parameters: &ParameterFile, names: &[String]) {
    let mut used = Vec::new();
    for (joint, (servo, _)) in names.iter().zip(&mut fit.joints) {
        for (quantity, number) in [
            ("kp", &mut servo.gain_nm_per_rad),
            ("kv", &mut servo.firmware_damping_nm_s_per_rad),
            ("delay", &mut servo.delay_s),
        ] {
            if let Some((value, name)) = parameters.value(joint, quantity) {
                *number = value;
                used.push(name);
            }
        }
    }
    let frozen = parameters.frozen().map(|name| format!("the parameter `{name}` is frozen and not applied"));
    fit.lost.extend(frozen);
    let unused = parameters.of_drives().filter(|name| !used.contains(name)).chain(parameters.of_bodies());
    fit.lost.extend(
        unused.map(|name| {
            format!("the parameter `{name}` does not belong to friction, gain or delay of a joint")
        }),
    );
}

/// The fit in the text of an MJCF file with actuators of positions.
pub(super) fn mjcf(
    path: &Path,
    text: &str,
    parameters: Option<&ParameterFile>,
    joints: &RobotJoints,
) -> Result<Fit, Failure> {
    let part = if joints.names.is_empty() { Part::All } else { Part::Joints(joints.names.clone()) };
    let robot = parse(text, path, None, &part, parameters)?;
    let actuators = position_actuators(text, path)?;
    let names = if joints.names.is_empty() { &robot.joint_names } else { &joints.names };
    if names.len() != joints.count {
        let reason = format!("has {} joints, the experiment {}", names.len(), joints.count);
        return Err(Failure::unfit(path, reason, "give the experiment's joints their names"));
    }
    let one = |name: &String| {
        let missing = |what: &str| {
            Failure::unfit(
                path,
                format!("has no {what} `{name}`"),
                "name its joints as the experiment's robot does",
            )
        };
        let k = robot.joint_names.iter().position(|n| n == name).ok_or_else(|| missing("joint"))?;
        let actuator = actuators
            .iter()
            .find(|a| a.joint == *name)
            .ok_or_else(|| missing("actuator of a position for joint"))?;
        let servo = PositionServo {
            firmware_damping_nm_s_per_rad: actuator.braking_nm_s_per_rad,
            command_offset_rad: actuator.bias_nm / actuator.gain_nm_per_rad,
            delay_s: actuator.delay_s,
            torque_limit_nm: actuator.limit_nm.unwrap_or(bare(1.0).torque_limit_nm),
            ..bare(actuator.gain_nm_per_rad)
        };
        let mechanics = Mechanics {
            coulomb_nm: robot.friction[k].coulomb_nm,
            viscous_nm_s_per_rad: robot.friction[k].viscous_nm_s_rad,
            ..rotor(robot.armature_kg_m2[k])
        };
        Ok((servo, mechanics))
    };
    let joints: Result<_, Failure> = names.iter().map(one).collect();
    let creeps = "MuJoCo's frictionloss yields a little at rest; here it holds";
    let lost = vec![creeps.into(), "`ctrlrange` is not applied".into()];
    let mut fit = Fit { kind: MJCF, joints: joints?, has_zeros: false, lost };
    if let Some(parameters) = parameters {
        correct(&mut fit, parameters, names);
    }
    Ok(fit)
}

/// BAM's servos: name, duty per unit of position error and of firmware gain, largest duty (Rhoban/bam, `actuator.py` of each).
const SERVOS: [(&str, f64, f64); 5] = [
    ("mx64", 0.158, 0.9625),
    ("mx106", 0.158, 0.9625),
    ("xl320", 0.050_481_99, 1.0),
    ("sts3215", 0.166, 0.97),
    ("sts321512v", 0.166, 0.97),
];

const BAM_NUMBERS: &str = "kt R vin kp error_gain error_gain_ratio command_delay max_velocity max_pwm \
    friction_base friction_stribeck friction_viscous dtheta_stribeck load_friction_base load_friction_motor load_friction_external armature alpha";
const BAM_UNUSED: [&str; 7] = [
    "load_friction_stribeck",
    "load_friction_motor_stribeck",
    "load_friction_external_stribeck",
    "load_friction_motor_quad",
    "load_friction_external_quad",
    "max_current",
    "q_offset",
];

/// u = vin · clip(kp · error_gain · e), τ = (kt/R) u − (kt²/R) q̇; friction at most base + viscous |q̇| + e^(−|q̇/v|^α) stribeck, and
/// shares of the gearbox' torque |k_e τ_ext − k_m τ_motor|.
fn bam(path: &Path, table: &Map<String, Value>, joints: usize) -> Result<Fit, Failure> {
    for key in BAM_NUMBERS.split(' ').chain(BAM_UNUSED) {
        // What is no number would count as absent.
        if let Some(value) = table.get(key).filter(|value| !value.is_number() && !value.is_null()) {
            let reason =
                format!("`{key}` is {}, which is no number", aurt_files::clipped(&value.to_string()));
            return Err(Failure::unfit(path, reason, "write the number, without quotes"));
        }
    }
    let known = table.get("actuator").and_then(Value::as_str).and_then(|a| SERVOS.iter().find(|s| s.0 == a));
    let of = |key: &str| table.get(key).and_then(Value::as_f64);
    let need = |key: &str, otherwise: Option<f64>| {
        of(key).or(otherwise).filter(|v| v.is_finite()).ok_or_else(|| {
            let remedy = match key {
                "kp" | "vin" => format!(
                    "add \"{key}\", the {} of your robot: BAM keeps it with its recordings",
                    if key == "kp" { "firmware's gain" } else { "supply in V" }
                ),
                _ => format!("add \"{key}\" as BAM's class of this servo has it"),
            };
            Failure::unfit(path, format!("lacks the number `{key}`"), remedy)
        })
    };
    let (kt, resistance) = (need("kt", None)?, need("R", None)?);
    let per_volt = kt / resistance;
    let vin = need("vin", None)?;
    let duty =
        need("kp", None)? * need("error_gain", known.map(|k| k.1))? * of("error_gain_ratio").unwrap_or(1.0);
    let servo = PositionServo {
        back_emf_nm_s_per_rad: kt * per_volt,
        delay_s: of("command_delay").unwrap_or(0.0),
        speed_limit_rad_s: of("max_velocity").unwrap_or(bare(1.0).speed_limit_rad_s),
        torque_limit_nm: per_volt * vin * need("max_pwm", known.map(|k| k.2))?,
        ..bare(per_volt * vin * duty)
    };
    // A load L in balance is on both sides of the gearbox: |k_e L + k_m L|.
    let both = |base: &str, motor: &str, external: &str| {
        2.0 * of(base).unwrap_or(0.0) + of(motor).unwrap_or(0.0) + of(external).unwrap_or(0.0)
    };
    let mechanics = Mechanics {
        coulomb_nm: need("friction_base", None)?,
        coulomb_per_load: both("load_friction_base", "load_friction_motor", "load_friction_external"),
        static_nm: of("friction_stribeck").unwrap_or(0.0),
        stribeck_velocity_rad_s: of("dtheta_stribeck")
            .unwrap_or(Mechanics::default().stribeck_velocity_rad_s),
        viscous_nm_s_per_rad: need("friction_viscous", None)?,
        ..rotor(need("armature", None)?)
    };
    let mut lost = Vec::new();
    if mechanics.coulomb_per_load > 0.0 {
        lost.push("friction by load is that of a load in balance, without accelerations".to_owned());
    }
    if let Some(alpha) = of("alpha").filter(|a| *a != 2.0) {
        lost.push(format!("the Stribeck curve has the exponent {alpha:.3}; here it is 2"));
    }
    lost.extend(BAM_UNUSED.iter().filter_map(|key| of(key).map(|v| format!("`{key}` {v:.4} is not used"))));
    Ok(Fit { kind: "BAM", joints: vec![(servo, mechanics); joints], has_zeros: false, lost })
}

/// Settings that no recording of positions can tell the meaning of, or that engines apply differently.
const UNUSED: [&str; 5] = [
    "velocity_limit",
    "velocity_limit_sim",
    "actuator_velocity_limit",
    "joint_velocity_limit",
    "saturation_effort",
];
/// Names of the largest torque.
const EFFORTS: [&str; 4] =
    ["effort_limit", "effort_limit_sim", "actuator_effort_limit", "joint_effort_limit"];

/// Settings with PACE's vector `mean` written out: armature, viscous friction, friction and encoder bias of each joint of
/// `joint_order`, and the delay, of which PACE takes whole steps.
fn pace(path: &Path, table: &Map<String, Value>) -> Result<Map<String, Value>, Failure> {
    let mut table = table.clone();
    let Some(mean) = table.remove("mean") else { return Ok(table) };
    let order = serde_json::from_value::<Vec<String>>(table.remove("joint_order").unwrap_or_default());
    let mean = serde_json::from_value::<Vec<f64>>(mean);
    let (Ok(order), Ok(mean)) = (order, mean) else {
        let reason = "`mean` and `joint_order` have to be a list of numbers and a list of names";
        return Err(Failure::unfit(path, reason, "write those of PACE's mean_….pt and config.pt"));
    };
    let joints = order.len();
    if mean.len() != 4 * joints + 1 {
        let reason =
            format!("`mean` has {} numbers, and {joints} joints have {}", mean.len(), 4 * joints + 1);
        return Err(Failure::unfit(path, reason, "write `joint_order` of the same config.pt"));
    }
    let friction = ["static_friction", "dynamic_friction"];
    for (from, keys) in
        [&["armature"][..], &["viscous_friction"], &friction, &["encoder_bias"]].iter().enumerate()
    {
        let numbers =
            order.iter().cloned().zip(mean[from * joints..].iter().map(|value| Value::from(*value)));
        let numbers: Map<String, Value> = numbers.collect();
        table.extend(keys.iter().map(|key| ((*key).to_owned(), numbers.clone().into())));
    }
    table.extend(["min_delay", "max_delay"].map(|key| (key.to_owned(), mean[4 * joints].trunc().into())));
    Ok(table)
}

/// τ = clip(stiffness (q*(t − delay) − q) − damping q̇); friction in Nm, dynamic while the joint moves (Isaac Sim 5 and later).
fn isaac(path: &Path, table: &Map<String, Value>, joints: &RobotJoints) -> Result<Fit, Failure> {
    let keys = "stiffness damping armature friction static_friction dynamic_friction encoder_bias viscous_friction \
                min_delay max_delay physics_dt_s";
    let keys: Vec<&str> = keys.split(' ').collect();
    if let Some(key) = table.keys().find(|k| ![&keys[..], &UNUSED, &EFFORTS].concat().contains(&k.as_str())) {
        let remedy = format!("known: {}", [&keys[..], &EFFORTS, &UNUSED].concat().join(", "));
        return Err(Failure::unfit(path, format!("`{key}` is not known"), remedy));
    }
    let of = |key: &str, joint: usize| -> Result<Option<f64>, Failure> {
        let value = match table.get(key) {
            None | Some(Value::Null) => return Ok(None),
            Some(Value::Array(list)) => list.get(joint),
            Some(Value::Object(named)) => {
                joints.names.get(joint).and_then(|name| named.get(name)).or_else(|| named.get(".*"))
            }
            value => value,
        };
        value.and_then(Value::as_f64).map(Some).ok_or_else(|| {
            let reason = format!("`{key}` has no number for joint {joint}");
            Failure::unfit(
                path,
                reason,
                "give one number, a list with one for each joint, or an object by the joints' names",
            )
        })
    };
    let one = |j: usize| {
        let get = |key: &str| Ok::<f64, Failure>(of(key, j)?.unwrap_or(0.0));
        // The newer name of `friction`.
        let holds = of("static_friction", j)?.map_or_else(|| get("friction"), Ok)?;
        let slides = of("dynamic_friction", j)?;
        if holds != 0.0 && slides.is_none() {
            let remedy =
                "add `dynamic_friction` in Nm; older releases take `friction` as a factor without unit";
            return Err(Failure::unfit(
                path,
                "`friction` without `dynamic_friction` has two meanings",
                remedy,
            ));
        }
        let slides = slides.unwrap_or(0.0);
        let steps = 0.5 * (get("min_delay")? + get("max_delay")?);
        if steps != 0.0 && of("physics_dt_s", j)?.is_none() {
            let remedy = "add `physics_dt_s`, the step of the physics in s";
            return Err(Failure::unfit(path, "delays are counted in steps of the physics", remedy));
        }
        let mut limit = bare(1.0).torque_limit_nm;
        for key in EFFORTS {
            limit = limit.min(of(key, j)?.unwrap_or(limit));
        }
        let servo = PositionServo {
            firmware_damping_nm_s_per_rad: get("damping")?,
            delay_s: steps * get("physics_dt_s")?,
            torque_limit_nm: limit,
            ..bare(get("stiffness")?)
        };
        let mechanics = Mechanics {
            coulomb_nm: slides,
            static_nm: (holds - slides).max(0.0),
            // What holds is gone as soon as the joint moves.
            stribeck_velocity_rad_s: 1e-3,
            viscous_nm_s_per_rad: get("viscous_friction")?,
            position_offset_rad: get("encoder_bias")?,
            ..rotor(get("armature")?)
        };
        Ok((servo, mechanics))
    };
    let fitted: Result<_, Failure> = (0..joints.count).map(one).collect();
    let unused = UNUSED.iter().filter(|key| table.get(**key).is_some_and(|v| !v.is_null()));
    Ok(Fit {
        kind: "Isaac Lab",
        joints: fitted?,
        has_zeros: table.get("encoder_bias").is_some_and(|bias| !bias.is_null()),
        lost: unused.map(|key| format!("`{key}` is not used")).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit(text: &str) -> Result<Fit, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fit.json");
        std::fs::write(&path, text).unwrap();
        read(&path, None, &RobotJoints::from(2)).map_err(|e| e.to_string())
    }

    #[test]
    fn a_servo_of_bam_has_gain_braking_and_limit_of_its_motor() {
        let servo = |more: &str| {
            fit(&format!(
                r#"{{"kt": 1.5, "R": 2.0, "armature": 0.03, "friction_base": 0.2, "friction_viscous": 0.03, "model": "m1",
                    "actuator": "sts3215", "kp": 16 {more}}}"#
            ))
        };
        let read = servo(r#", "vin": 12, "max_velocity": 5, "load_friction_base": 0.1"#).unwrap();
        let (drive, mechanics) = &read.joints[1];
        assert!((drive.gain_nm_per_rad - 1.5 / 2.0 * 12.0 * 16.0 * 0.166).abs() < 1e-12);
        assert!((drive.back_emf_nm_s_per_rad - 1.5 * 1.5 / 2.0).abs() < 1e-12);
        assert!((drive.torque_limit_nm - 1.5 / 2.0 * 12.0 * 0.97).abs() < 1e-12);
        assert_eq!(
            (drive.speed_limit_rad_s, mechanics.coulomb_nm, mechanics.coulomb_per_load),
            (5.0, 0.2, 0.2)
        );
        assert!(read.lost[0].contains("load in balance"));
        let refused = servo("").err().unwrap();
        assert!(refused.contains("`vin`") && refused.contains("supply in V"), "{refused}");
    }

    #[test]
    fn settings_of_isaac_lab_keep_their_meaning() {
        let read = fit(
            r#"{"stiffness": [10, 20], "damping": 0.3, "friction": 0.2, "dynamic_friction": 0.15, "viscous_friction": 0.1,
                "armature": 0.01, "min_delay": 2, "max_delay": 4, "physics_dt_s": 0.005, "effort_limit": 3, "velocity_limit": 9,
                "encoder_bias": [0, 0.02]}"#,
        )
        .unwrap();
        assert!(read.has_zeros && read.joints[1].1.position_offset_rad == 0.02);
        let (drive, mechanics) = &read.joints[1];
        assert_eq!(
            (drive.gain_nm_per_rad, drive.firmware_damping_nm_s_per_rad, drive.torque_limit_nm),
            (20.0, 0.3, 3.0)
        );
        assert!((drive.delay_s - 0.015).abs() < 1e-12 && (mechanics.static_nm - 0.05).abs() < 1e-12);
        assert_eq!((mechanics.coulomb_nm, mechanics.viscous_nm_s_per_rad), (0.15, 0.1));
        assert_eq!(read.lost, ["`velocity_limit` is not used"]);
        for (text, said) in [
            (r#"{"stiffness": 1, "friction": 0.2}"#, "two meanings"),
            (r#"{"stiffness": 1, "min_delay": 2}"#, "physics_dt_s"),
            (r#"{"stiffness": 1, "stifness": 2}"#, "`stifness` is not known"),
            (r#"{"stiffness": [1]}"#, "no number for joint 1"),
        ] {
            let refused = fit(text).err().unwrap();
            assert!(refused.contains(said), "{refused}");
        }
    }

    #[test]
    fn the_vector_of_pace_states_joints_encoders_and_the_delay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pace.json");
        let joints = RobotJoints { names: vec!["hip".into(), "knee".into()], ..RobotJoints::from(2) };
        let of = |more: &str| {
            let text = format!(
                r#"{{"stiffness": 85, "damping": 0.6, "max_delay": 10, "physics_dt_s": 0.002, {more}}}"#
            );
            std::fs::write(&path, text).unwrap();
            read(&path, None, &joints).map_err(|e| e.to_string())
        };
        let mean = "[0.1, 0.2, 1, 2, 3, 4, 0.01, -0.02, 5.7]";
        let fit = of(&format!(r#""joint_order": ["knee", "hip"], "mean": {mean}"#)).unwrap();
        let (servo, hip) = &fit.joints[0];
        assert!((servo.delay_s - 0.01).abs() < 1e-12 && servo.gain_nm_per_rad == 85.0 && fit.has_zeros);
        assert_eq!((hip.rotor_inertia_kg_m2, hip.viscous_nm_s_per_rad, hip.coulomb_nm), (0.2, 2.0, 4.0));
        assert_eq!((hip.static_nm, hip.position_offset_rad), (0.0, -0.02));
        for (more, said) in [
            (r#""joint_order": ["hip"], "mean": [1, 2]"#, "has 2 numbers, and 1 joints have 5"),
            (r#""joint_order": ["hip"], "mean": [1, 2, 3, 4, 0]"#, "has no number for joint 1"),
            (r#""mean": [1, 2]"#, "a list of numbers and a list of names"),
        ] {
            let refused = of(more).err().unwrap();
            assert!(refused.contains(said), "{refused}");
        }
    }
}
