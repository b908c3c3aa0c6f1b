//! Parameter files of `mujoco.sysid` and PACE, which correct a description.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Matrix4, Vector3};
use serde::Deserialize;

use crate::robots::body::Body;
use crate::robots::pose::Pose;
use crate::robots::tree::{Tree, TreeLink};
use crate::robots::{RobotError, RobotErrors};

/// Quantities of a joint, by their MJCF attributes.
const OF_JOINTS: [&str; 3] = ["armature", "damping", "frictionloss"];
/// Quantities of a body: kg; m in its frame; either, or the ten numbers of `InertiaType.Pseudo`.
const OF_BODIES: [&str; 3] = ["mass", "ipos", "inertia"];
/// Quantities of actuators and sensors.
const OF_DRIVES: [&str; 5] = ["kp", "kv", "delay", "bias", "gain"];
/// PACE's offset q = q_encoder + bias, whose sign is known.
const ENCODER_BIAS: &str = "encoder bias";
/// Remedy for names that state nothing.
const WRITE_OUT: &str =
    "rename it, or write the model with the identified numbers (`MjSpec.to_file`) and name that file";

/// A parameter.
#[derive(Debug, Clone)]
struct Parameter {
    name: String,
    line: u32,
    /// The joint, body or actuator; none for all.
    element: Option<String>,
    quantity: &'static str,
    values: Vec<f64>,
}

/// Identified parameters, which correct a description.
///
/// A file of `mujoco.sysid` (`ParameterDict.save_to_disk`) states numbers by name alone: a name is that of a joint, body or
/// actuator, a separator and the quantity, `elbow_damping`, or the quantity, which is then that of all joints. A file of PACE is a
/// JSON object of `joint_order`, `mean`, its vector of armature, viscous friction, friction, encoder bias and delay, and
/// `physics_dt_s`, the unit of the delay.
#[derive(Debug, Clone)]
pub struct ParameterFile {
    path: PathBuf,
    parameters: Vec<Parameter>,
    frozen: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Pace {
    joint_order: Vec<String>,
    mean: Vec<f64>,
    physics_dt_s: Option<f64>,
}

impl ParameterFile {
    /// Reads a file.
    ///
    /// # Errors
    /// As [`Self::parse`]; a file that cannot be read.
    pub fn read(path: &Path) -> Result<Self, RobotErrors> {
        Self::parse(&super::text_of(path)?, path)
    }

    /// As [`Self::read`], from text; `path` is what errors call it.
    ///
    /// # Errors
    /// Lines that neither program writes; names that state no quantity; numbers that no joint, body or drive has.
    pub fn parse(text: &str, path: &Path) -> Result<Self, RobotErrors> {
        let mut file = Self { path: path.into(), parameters: Vec::new(), frozen: Vec::new() };
        if text.trim_start().starts_with('{') {
            file.pace(text)?
        } else {
            file.sysid(text)?
        }
        let wrong = file.parameters.iter().enumerate().filter_map(|(k, parameter)| {
            let is_same =
                |p: &&Parameter| (&p.element, p.quantity) == (&parameter.element, parameter.quantity);
            let other = file.parameters[..k].iter().find(is_same);
            let reason =
                other.map(|other| format!("is `{}` again; remove one", other.name)).or(wrong(parameter))?;
            Some(file.error(parameter.line, &parameter.name, reason))
        });
        let errors: Vec<_> = wrong.collect();
        if !errors.is_empty() {
            return Err(RobotErrors(errors));
        }
        // What is said of one joint overrules what is said of all.
        file.parameters.sort_by_key(|parameter| parameter.element.is_some());
        Ok(file)
    }

    /// Reads the YAML of `save_to_disk`: blocks of `frozen`, `max_value`, `min_value`, `name`, `nominal` and `value`.
    fn sysid(&mut self, text: &str) -> Result<(), RobotErrors> {
        // Name, line, `frozen` and the numbers of `value`.
        let mut blocks: Vec<(String, u32, bool, Vec<f64>)> = Vec::new();
        let mut key = "";
        for (line, text) in (1..).zip(text.lines()) {
            let content = text.trim();
            if content.is_empty() || content == "---" || content.starts_with('#') {
                continue;
            }
            let unknown = "neither a line that `ParameterDict.save_to_disk` writes nor JSON; name its params_x_hat.yaml, or a file \
                           with PACE's `joint_order` and `mean`";
            if !text.starts_with([' ', '-']) {
                let name = content.strip_suffix(':').ok_or_else(|| self.error(line, content, unknown))?;
                let name = name.trim_matches(['"', '\'']).replace("''", "'");
                blocks.push((name, line, false, Vec::new()));
                key = "";
                continue;
            }
            let Some((name, _, frozen, values)) = blocks.last_mut() else {
                return Err(self.error(line, content, unknown).into());
            };
            let mut numbers = content;
            if !content.starts_with("- ") {
                let (of, value) =
                    content.split_once(':').ok_or_else(|| self.error(line, content, unknown))?;
                (key, numbers) = (of, value.trim());
                if !["frozen", "max_value", "min_value", "name", "nominal", "value"].contains(&key) {
                    let known = "is not known; known are frozen, max_value, min_value, name, nominal, value";
                    return Err(self.error(line, &format!("{name}, `{key}`"), known).into());
                }
            }
            match key {
                "frozen" => *frozen = numbers == "true",
                "value" => {
                    let numbers = numbers.trim_start_matches("- ").trim_matches(['[', ']']);
                    for number in numbers.split(',').map(str::trim).filter(|number| !number.is_empty()) {
                        let finite = number.parse().ok().filter(|value: &f64| value.is_finite());
                        let reason =
                            || format!("the value `{}` is no finite number", aurt_files::clipped(number));
                        values.push(finite.ok_or_else(|| self.error(line, name, reason()))?);
                    }
                }
                _ => {}
            }
        }
        let mut errors = Vec::new();
        for (name, line, frozen, values) in blocks {
            if frozen {
                self.frozen.push(name);
                continue;
            }
            let of = |quantity: &&&'static str| {
                let element = name.strip_suffix(**quantity)?;
                let named = element.strip_suffix(['_', '/', '.', ':']).filter(|element| !element.is_empty());
                (named.is_some() || element.is_empty()).then(|| (named.map(str::to_owned), **quantity))
            };
            let known = [&OF_JOINTS[..], &OF_BODIES, &OF_DRIVES].concat();
            match known.iter().find_map(|quantity| of(&quantity)) {
                Some((element, quantity)) => {
                    self.parameters.push(Parameter { name, line, element, quantity, values });
                }
                None => {
                    let reason = format!("ends in no quantity; known are {}; {WRITE_OUT}", known.join(", "));
                    errors.push(self.error(line, &name, reason));
                }
            }
        }
        if errors.is_empty() { Ok(()) } else { Err(RobotErrors(errors)) }
    }

    fn pace(&mut self, text: &str) -> Result<(), RobotErrors> {
        let read = serde_json::from_str(text);
        let Pace { joint_order, mean, physics_dt_s } = read.map_err(|e| {
            let line = u32::try_from(e.line()).unwrap_or(u32::MAX);
            self.error(
                line,
                "PACE's parameters",
                format!("{e}; write `joint_order`, `mean` and `physics_dt_s`"),
            )
        })?;
        let n = joint_order.len();
        if n == 0 || mean.len() != 4 * n + 1 {
            let reason = format!("has {} numbers, and {n} joints have {}", mean.len(), 4 * n + 1);
            return Err(self.error(1, "mean", reason + "; write `joint_order` of the same config.pt").into());
        }
        let mut add = |element: Option<&String>, quantity: &'static str, value: f64| {
            let name = element.map_or_else(|| quantity.to_owned(), |joint| format!("{joint}, {quantity}"));
            let element = element.cloned();
            self.parameters.push(Parameter { name, line: 1, element, quantity, values: vec![value] });
        };
        for (k, quantity) in [OF_JOINTS[0], OF_JOINTS[1], OF_JOINTS[2], ENCODER_BIAS].into_iter().enumerate()
        {
            joint_order
                .iter()
                .zip(&mean[k * n..])
                .for_each(|(joint, value)| add(Some(joint), quantity, *value));
        }
        // PACE rounds towards zero.
        let steps = mean[4 * n].trunc();
        match physics_dt_s {
            Some(step_s) => add(None, "delay", steps * step_s),
            None if steps != 0.0 => {
                let reason = "counts steps of the physics; add `physics_dt_s`, their duration in s";
                return Err(self.error(1, "mean, the delay", reason).into());
            }
            None => {}
        }
        Ok(())
    }

    fn error(&self, line: u32, name: &str, reason: impl Into<String>) -> RobotError {
        let what = aurt_files::clipped(name).to_string();
        RobotError::Element { path: self.path.clone(), line, what, reason: reason.into() }
    }

    /// The number of a quantity of a joint and the parameter's name: `armature`, `damping`, `frictionloss`, `kp`, `kv`, `delay` or
    /// `encoder bias`, what the coordinate exceeds the encoder by.
    #[must_use]
    pub fn of(&self, joint: &str, quantity: &str) -> Option<(f64, &str)> {
        let is_its =
            |p: &&Parameter| p.quantity == quantity && p.element.as_deref().is_none_or(|e| e == joint);
        let parameter = self.parameters.iter().rev().find(is_its)?;
        Some((*parameter.values.first()?, &parameter.name))
    }

    /// The names of the parameters of actuators and sensors, which no model of torques has.
    pub fn of_drives(&self) -> impl Iterator<Item = &str> {
        let is_drives = |p: &&Parameter| OF_DRIVES.contains(&p.quantity) || p.quantity == ENCODER_BIAS;
        self.parameters.iter().filter(is_drives).map(|p| p.name.as_str())
    }

    /// Corrects joints and bodies, and notes what has another meaning than it may seem to have.
    pub(super) fn correct(&self, tree: &mut Tree) -> Result<(), RobotErrors> {
        let mut errors = Vec::new();
        let mut kept = Vec::new();
        for p in self.parameters.iter().filter(|p| OF_JOINTS.contains(&p.quantity)) {
            let is_its = |name: &str| p.element.as_deref().is_none_or(|element| element == name);
            let mut found = false;
            for joint in tree.joints.iter_mut().filter(|joint| joint.moves() && is_its(&joint.name)) {
                found = true;
                *match p.quantity {
                    "armature" => &mut joint.armature,
                    "damping" => &mut joint.friction.viscous_nm_s_rad,
                    _ => &mut joint.friction.coulomb_nm,
                } = p.values[0];
            }
            let names = || tree.joints.iter().filter(|joint| joint.moves()).map(|joint| joint.name.as_str());
            errors.extend((!found).then(|| self.absent("joint", p, names().collect())));
        }
        for p in self.parameters.iter().filter(|p| OF_BODIES.contains(&p.quantity)) {
            let is_its =
                |link: &&mut TreeLink| link.place.is_some() && Some(&link.name) == p.element.as_ref();
            let Some(link) = tree.links.iter_mut().find(is_its) else {
                let links = tree.links.iter().filter(|link| link.place.is_some());
                errors.push(self.absent("body", p, links.map(|link| link.name.as_str()).collect()));
                continue;
            };
            match corrected(link, p) {
                Ok(body) => link.body = Some(body),
                Err(reason) => errors.push(self.error(p.line, &p.name, reason)),
            }
            if p.quantity == "inertia" && p.values.len() < 10 {
                kept.push(p.name.as_str());
            }
        }
        let frozen = self.frozen.iter().map(String::as_str).collect();
        for (what, names) in [
            ("parameters that are frozen are not applied, as in mujoco.sysid", frozen),
            (
                "the inertia about the centre of mass is the description's; `scale_rot_inertia` is not in the file",
                kept,
            ),
        ] {
            tree.notes.extend((!names.is_empty()).then(|| format!("{what}: {}", names.join(", "))));
        }
        if errors.is_empty() { Ok(()) } else { Err(RobotErrors(errors)) }
    }

    fn absent(&self, kind: &str, p: &Parameter, known: Vec<&str>) -> RobotError {
        let element = p.element.as_deref().unwrap_or_default();
        let reason = format!(
            "there is no {kind} `{}` in the description; known are {}",
            aurt_files::clipped(element),
            known.join(", ")
        );
        self.error(p.line, &p.name, format!("{reason}; {WRITE_OUT}"))
    }
}

/// What is wrong with the numbers of a parameter.
fn wrong(Parameter { quantity, values, .. }: &Parameter) -> Option<String> {
    let counts: &[usize] = match *quantity {
        "inertia" => &[1, 4, 10],
        "ipos" => &[3],
        "bias" | "gain" => return None,
        _ => &[1],
    };
    if !counts.contains(&values.len()) {
        let counts: Vec<String> = counts.iter().map(ToString::to_string).collect();
        return Some(format!("has {} numbers, not {}", values.len(), counts.join(", ")));
    }
    let is_mass = *quantity == "mass" || *quantity == "inertia" && values.len() < 10;
    match values[0] {
        value if is_mass && value <= 0.0 => Some(format!("the mass {value} kg is not positive")),
        value if OF_JOINTS.contains(quantity) && value < 0.0 => Some(format!("{value} is below zero")),
        _ => None,
    }
}

/// The body of a link with a parameter.
fn corrected(link: &TreeLink, p: &Parameter) -> Result<Body, String> {
    let frame = link.place.map_or_else(Pose::identity, |place| place.frame);
    if let Ok(theta) = <[f64; 10]>::try_from(&p.values[..]) {
        return of_log_cholesky(theta, &frame).ok_or_else(|| "is no body of finite mass and inertia".into());
    }
    let mut body =
        link.body.ok_or("the body has no inertia that could be corrected; identify `InertiaType.Pseudo`")?;
    let (mass, centre) =
        if p.quantity == "ipos" { (None, &p.values[..]) } else { (Some(p.values[0]), &p.values[1..]) };
    body.mass_kg = mass.unwrap_or(body.mass_kg);
    if let [x, y, z] = *centre {
        body.pose.origin_m = frame.origin_m + frame.rotation * Vector3::new(x, y, z);
    }
    Ok(body)
}

/// The body of the pseudo-inertia J = U Uᵀ with U = e^α [[e^d₁, s₁₂, s₁₃, t₁], [0, e^d₂, s₂₃, t₂], [0, 0, e^d₃, t₃], [0, 0, 0, 1]] and
/// θ = (α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃) in the frame of its link (Rucker, Wensing 2022).
fn of_log_cholesky(theta: [f64; 10], frame: &Pose) -> Option<Body> {
    let [alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3] = theta;
    let [e0, e1, e2, e3] = [alpha, d1, d2, d3].map(libm::exp);
    #[rustfmt::skip]
    let u = Matrix4::new(
        e1, s12, s13, t1,
        0.0, e2, s23, t2,
        0.0, 0.0, e3, t3,
        0.0, 0.0, 0.0, 1.0,
    ) * e0;
    let j = u * u.transpose();
    let mass_kg = j[(3, 3)];
    let com = Vector3::new(j[(0, 3)], j[(1, 3)], j[(2, 3)]) / mass_kg;
    let second = j.fixed_view::<3, 3>(0, 0) - com * com.transpose() * mass_kg;
    let inertia_kg_m2 = Matrix3::identity() * second.trace() - second;
    let pose = frame.then(&Pose { origin_m: com, ..Pose::identity() });
    let is_finite = mass_kg > 0.0 && (inertia_kg_m2.sum() + pose.origin_m.sum()).is_finite();
    is_finite.then_some(Body { mass_kg, pose, inertia_kg_m2 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robots::{DescribedRobot, Part, parse_part_with};

    const ARM: &str = r#"<mujoco><worldbody><body name="upper"><inertial pos="0 0 0.2" mass="2" diaginertia="0.03 0.02 0.01"/>
        <joint name="shoulder" damping="1" axis="0 1 0"/><body name="fore" pos="0 0 0.4"><inertial pos="0 0 0.1" mass="1"
        diaginertia="0.01 0.01 0.01"/><joint name="elbow_1" frictionloss="0.5" axis="0 1 0"/></body></body></worldbody></mujoco>"#;

    fn corrected(parameters: &str) -> Result<DescribedRobot, String> {
        let file = ParameterFile::parse(parameters, Path::new("p.yaml")).map_err(|e| e.to_string())?;
        parse_part_with(ARM, "arm.xml", None, &Part::All, Some(&file)).map_err(|e| e.to_string())
    }

    #[test]
    fn a_file_of_sysid_corrects_joints_and_bodies() {
        let block = |name: &str, more: &str| {
            format!(
                "{name}:\n  frozen: false\n  max_value:\n  - 9.0\n  min_value:\n  - 0.0\n  name: x\n  nominal:\n  - 1.0\n{more}\n"
            )
        };
        let robot = corrected(
            &[
                block("armature", "  value:\n  - 0.05"),
                block("elbow_1_armature", "  value:\n  - 2.0e-02"),
                block("elbow_1/damping", "  value: [0.25]"),
                block("fore_inertia", "  value:\n  - 3.0\n  - 0.0\n  - 0.0\n  - -0.2"),
                block("shoulder_kp", "  value:\n  - - 90.0"),
                "shoulder_damping:\n  frozen: true\n  value:\n  - 7.0\n".into(),
            ]
            .concat(),
        )
        .unwrap();
        assert_eq!(robot.armature_kg_m2, [0.05, 0.02]);
        assert_eq!(robot.friction.iter().map(|f| f.viscous_nm_s_rad).collect::<Vec<_>>(), [1.0, 0.25]);
        assert_eq!(robot.friction[1].coulomb_nm, 0.5);
        let fore = &robot.standard_parameters.unwrap()[10..];
        let first_moment = (fore[6].powi(2) + fore[7].powi(2) + fore[8].powi(2)).sqrt();
        assert!((first_moment - 0.6).abs() < 1e-12 && fore[9] == 3.0, "{fore:?}");
        let notes = robot.notes.join("\n");
        assert!(notes.contains("frozen") && notes.contains("shoulder_damping"), "{notes}");
        assert!(notes.contains("`scale_rot_inertia`") && notes.contains("fore_inertia"), "{notes}");
    }

    #[test]
    fn a_file_of_pace_states_joints_encoders_and_the_delay() {
        let text = r#"{"joint_order": ["elbow_1", "shoulder"], "mean": [0.1, 0.2, 1, 2, 3, 4, 0.01, -0.02, 5.7], "physics_dt_s": 0.002}"#;
        let robot = corrected(text).unwrap();
        assert_eq!(robot.armature_kg_m2, [0.2, 0.1]);
        assert_eq!(robot.friction.iter().map(|f| f.coulomb_nm).collect::<Vec<_>>(), [4.0, 3.0]);
        let file = ParameterFile::parse(text, Path::new("p.json")).unwrap();
        assert_eq!(file.of("shoulder", "encoder bias"), Some((-0.02, "shoulder, encoder bias")));
        assert_eq!(file.of("shoulder", "delay"), Some((0.01, "delay")));
        assert_eq!(file.of_drives().count(), 3);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let value = |name: &str, value: &str| format!("{name}:\n  value:\n  - {value}\n");
        let pace = |mean: &str| format!(r#"{{"joint_order": ["elbow_1"], "mean": {mean}}}"#);
        for (text, said) in [
            (value("elbow_2_damping", "1.0"), "p.yaml:1: elbow_2_damping: there is no joint `elbow_2`"),
            (value("hand_mass", "1.0"), "there is no body `hand` in the description; known are upper, fore"),
            (value("mass", "1.0"), "there is no body ``"),
            (value("link1_mas", "1.0"), "ends in no quantity; known are armature, damping"),
            (value("damping", ".nan"), "p.yaml:3: damping: the value `.nan` is no finite number"),
            (value("elbow_1_damping", "-1.0"), "-1 is below zero"),
            (value("fore_mass", "0.0"), "the mass 0 kg is not positive"),
            (value("fore_inertia", "1.0\n  - 2.0"), "has 2 numbers, not 1, 4, 10"),
            (
                value("fore_inertia", "999.0\n  - 0\n  - 0\n  - 0\n  - 0\n  - 0\n  - 0\n  - 0\n  - 0\n  - 0"),
                "no body of finite",
            ),
            (value("damping", "1.0") + "damping:\n", "p.yaml:4: damping: is `damping` again"),
            ("damping:\n".to_owned(), "has 0 numbers, not 1"),
            (
                "damping:\n  volume: 1\n".to_owned(),
                "p.yaml:2: damping, `volume`: is not known; known are frozen",
            ),
            (
                "joint,damping\n".to_owned(),
                "neither a line that `ParameterDict.save_to_disk` writes nor JSON",
            ),
            (pace("[0.1, 1, 0.1, 0]"), "has 4 numbers, and 1 joints have 5"),
            (pace("[0.1, 1, 0.1, 0, 3]"), "add `physics_dt_s`"),
            (pace("[0.1, 1, 0.1, 0, NaN]"), "p.yaml:1: PACE's parameters"),
            (pace("[]}").replace("mean", "meen"), "unknown field `meen`"),
        ] {
            let refused = corrected(&text).unwrap_err();
            assert!(refused.contains(said), "{text}: {refused}");
        }
    }
}
