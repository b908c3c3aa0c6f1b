//! Parameter files of `mujoco.sysid`, which correct a description.

use std::path::{Path, PathBuf};

use nalgebra::{Matrix3, Matrix4, Vector3};

use crate::robots::pose::{Body, Pose};
use crate::robots::tree::{Tree, TreeLink};
use crate::robots::{RobotError, RobotErrors};

/// Quantities of a joint, by their MJCF attributes.
const OF_JOINTS: [&str; 3] = ["armature", "damping", "frictionloss"];
/// Quantities of a body: kg; m in its frame; both, or the ten numbers of `InertiaType.Pseudo`.
const OF_BODIES: [&str; 3] = ["mass", "ipos", "inertia"];
/// Quantities of actuators and sensors.
const OF_DRIVES: [&str; 5] = ["kp", "kv", "delay", "bias", "gain"];
const KEYS: [&str; 6] = ["frozen", "max_value", "min_value", "name", "nominal", "value"];
const SYSID: &str = "is not a line of `ParameterDict.save_to_disk`; name params_x_hat.yaml of mujoco.sysid";
/// Remedy for names that state nothing.
const RENAME: &str = "rename it, or write the identified model with `MjSpec.to_file` and name that file";

#[derive(Debug, Clone)]
struct Parameter {
    name: String,
    line: u32,
    is_frozen: bool,
    values: Vec<f64>,
}

impl Parameter {
    /// The quantity that its name ends in, and what that is of; nothing for all.
    fn meaning(&self) -> Option<(&str, &'static str)> {
        let known = OF_JOINTS.into_iter().chain(OF_BODIES).chain(OF_DRIVES);
        known.into_iter().find_map(|quantity| match self.name.strip_suffix(quantity)? {
            "" => Some(("", quantity)),
            element => Some((element.strip_suffix(['_', '/', '.', ':'])?, quantity)),
        })
    }

    /// The fault of its numbers, if they have one.
    fn wrong(&self, quantity: &str) -> Option<String> {
        let counts: &[usize] = match quantity {
            "inertia" => &[1, 4, 10],
            "ipos" => &[3],
            "bias" | "gain" => return None,
            _ => &[1],
        };
        if !counts.contains(&self.values.len()) {
            return Some(format!("has {} numbers, and may have {counts:?}", self.values.len()));
        }
        let value = self.values[0];
        let is_mass = quantity == "mass" || quantity == "inertia" && self.values.len() < 10;
        let is_wrong = is_mass && value <= 0.0 || OF_JOINTS.contains(&quantity) && value < 0.0;
        is_wrong.then(|| format!("has the value {value}, which no {quantity} of a robot has"))
    }
}

/// A file of `ParameterDict.save_to_disk`, which states the meaning of its numbers by names alone: that of a joint, body or
/// actuator, a separator and a quantity, `elbow_damping`, or a quantity, which is then that of all joints.
#[derive(Debug, Clone)]
pub struct ParameterFile {
    path: PathBuf,
    parameters: Vec<Parameter>,
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
    /// Lines that are not of such a file; names that state no quantity; numbers that no joint, body or drive has.
    pub fn parse(text: &str, path: &Path) -> Result<Self, RobotErrors> {
        let mut file = Self { path: path.into(), parameters: Vec::new() };
        let mut key = "";
        for (line, text) in (1..).zip(text.lines()) {
            let content = text.trim();
            if content.is_empty() || content == "---" || content.starts_with('#') {
                continue;
            }
            let (before, mut numbers) = content.split_once(':').unwrap_or((content, ""));
            match (text.starts_with([' ', '-']), content.strip_suffix(':')) {
                (false, Some(name)) => {
                    let name = name.trim_matches(['"', '\'']).to_owned();
                    file.parameters.push(Parameter { name, line, is_frozen: false, values: Vec::new() });
                    key = "";
                }
                (true, _) if content.starts_with("- ") => numbers = content.trim_start_matches("- "),
                (true, _) if KEYS.contains(&before) => key = before,
                _ => return Err(file.error(line, content, SYSID).into()),
            }
            let Some(parameter) = file.parameters.last_mut() else {
                return Err(file.error(line, content, SYSID).into());
            };
            match key {
                "frozen" => parameter.is_frozen = numbers.trim() == "true",
                "value" => {
                    let numbers = numbers.trim().trim_matches(['[', ']']).split_terminator(',');
                    let read: Option<Vec<f64>> = numbers.map(|number| number.trim().parse().ok()).collect();
                    match read.filter(|read| read.iter().all(|value| value.is_finite())) {
                        Some(read) => parameter.values.extend(read),
                        None => return Err(file.error(line, content, "has no finite numbers").into()),
                    }
                }
                _ => {}
            }
        }
        let wrong = |p: &Parameter| {
            let known = [&OF_JOINTS[..], &OF_BODIES, &OF_DRIVES].concat().join(", ");
            let unknown = || Some(format!("ends in no quantity; known are {known}; {RENAME}"));
            let reason = p.meaning().map_or_else(unknown, |(_, quantity)| p.wrong(quantity))?;
            Some(file.error(p.line, &p.name, reason))
        };
        let errors: Vec<_> = file.applied().filter_map(wrong).collect();
        if errors.is_empty() { Ok(file) } else { Err(RobotErrors(errors)) }
    }

    fn error(&self, line: u32, what: &str, reason: impl Into<String>) -> RobotError {
        let (path, what) = (self.path.clone(), aurt_files::clipped(what));
        RobotError::Element { path, line, what, reason: reason.into() }
    }

    fn applied(&self) -> impl Iterator<Item = &Parameter> {
        self.parameters.iter().filter(|p| !p.is_frozen)
    }

    fn of(&self, quantities: &[&str]) -> impl Iterator<Item = (&Parameter, &str, &'static str)> {
        let meant =
            self.applied().filter_map(|p| p.meaning().map(|(element, quantity)| (p, element, quantity)));
        meant.filter(|(_, _, quantity)| quantities.contains(quantity))
    }

    /// The names of the parameters of actuators and sensors, which no model of torques has.
    pub fn of_drives(&self) -> impl Iterator<Item = &str> {
        self.of(&OF_DRIVES).map(|(p, ..)| p.name.as_str())
    }

    /// The names of the parameters of bodies.
    pub fn of_bodies(&self) -> impl Iterator<Item = &str> {
        self.of(&OF_BODIES).map(|(p, ..)| p.name.as_str())
    }

    /// The names of the parameters that keep what the description has.
    pub fn frozen(&self) -> impl Iterator<Item = &str> {
        self.parameters.iter().filter(|p| p.is_frozen).map(|p| p.name.as_str())
    }

    /// The number of a quantity of a joint, or else of all, and the name of the parameter.
    pub fn value(&self, joint: &str, quantity: &str) -> Option<(f64, &str)> {
        let of = |element: &str| self.of(&[quantity]).find(|(_, of, _)| *of == element);
        of(joint).or_else(|| of("")).map(|(p, ..)| (p.values[0], p.name.as_str()))
    }

    /// Corrects joints and bodies, and notes what is not applied.
    pub(super) fn correct(&self, tree: &mut Tree) -> Result<(), RobotErrors> {
        let joints: Vec<String> = tree.joints.iter().filter(|j| j.moves()).map(|j| j.name.clone()).collect();
        let unknown = |p: &Parameter, kind: &str, element: &str, known: &[String]| {
            let element = aurt_files::clipped(element);
            let reason = format!("there is no {kind} `{element}`; known are {}; {RENAME}", known.join(", "));
            self.error(p.line, &p.name, reason)
        };
        let is_unknown = |element: &str| !element.is_empty() && !joints.iter().any(|joint| joint == element);
        let absent = self.of(&OF_JOINTS).filter(|(_, element, _)| is_unknown(element));
        let mut errors: Vec<_> =
            absent.map(|(p, element, _)| unknown(p, "joint", element, &joints)).collect();
        for joint in tree.joints.iter_mut().filter(|joint| joint.moves()) {
            let friction = &mut joint.friction;
            let numbers = [&mut joint.armature, &mut friction.viscous_nm_s_rad, &mut friction.coulomb_nm];
            for (number, quantity) in numbers.into_iter().zip(OF_JOINTS) {
                *number = self.value(&joint.name, quantity).map_or(*number, |(value, _)| value);
            }
        }
        let (mut kept, bodies) = (Vec::new(), tree.links.iter().filter(|link| link.place.is_some()));
        let bodies: Vec<String> = bodies.map(|link| link.name.clone()).collect();
        for (p, element, quantity) in self.of(&OF_BODIES) {
            let is_its = |link: &&mut TreeLink| link.place.is_some() && link.name == element;
            match tree.links.iter_mut().find(is_its).map(|link| (corrected(link, quantity, &p.values), link))
            {
                Some((Ok(body), link)) => link.body = Some(body),
                Some((Err(reason), _)) => errors.push(self.error(p.line, &p.name, reason)),
                None => errors.push(unknown(p, "body", element, &bodies)),
            }
            kept.extend((quantity == "inertia" && p.values.len() < 10).then_some(p.name.as_str()));
        }
        let frozen = self.frozen().collect();
        let unscaled =
            "`scale_rot_inertia` is not in the file, and the inertia about the centre of mass stays";
        for (what, names) in [("frozen parameters are not applied", frozen), (unscaled, kept)] {
            tree.notes.extend((!names.is_empty()).then(|| format!("{what}: {}", names.join(", "))));
        }
        if errors.is_empty() { Ok(()) } else { Err(RobotErrors(errors)) }
    }
}

fn corrected(link: &TreeLink, quantity: &str, values: &[f64]) -> Result<Body, &'static str> {
    let frame = link.place.map_or_else(Pose::identity, |place| place.frame);
    if let Ok(theta) = <[f64; 10]>::try_from(values) {
        return of_log_cholesky(theta, &frame).ok_or("gives a body without finite mass and inertia");
    }
    let mut body = link.body.ok_or("the body has no inertia to correct; identify `InertiaType.Pseudo`")?;
    let (mass, centre) = if quantity == "ipos" { (body.mass_kg, values) } else { (values[0], &values[1..]) };
    body.mass_kg = mass;
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
    let u = Matrix4::new(e1, s12, s13, t1, 0.0, e2, s23, t2, 0.0, 0.0, e3, t3, 0.0, 0.0, 0.0, 1.0) * e0;
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
    use crate::robots::{DescribedRobot, Part, parse};

    const ARM: &str = r#"<mujoco><worldbody><body name="upper"><inertial pos="0 0 0.2" mass="2" diaginertia="0.03 0.02 0.01"/>
        <joint name="shoulder" damping="1" axis="0 1 0"/><body name="fore" pos="0 0 0.4"><inertial pos="0 0 0.1" mass="1"
        diaginertia="0.01 0.01 0.01"/><joint name="elbow_1" frictionloss="0.5" axis="0 1 0"/></body></body></worldbody></mujoco>"#;

    fn corrected(parameters: &str) -> Result<DescribedRobot, String> {
        let file = ParameterFile::parse(parameters, Path::new("p.yaml")).map_err(|e| e.to_string())?;
        parse(ARM, "arm.xml", None, &Part::All, Some(&file)).map_err(|e| e.to_string())
    }

    #[test]
    fn joints_and_bodies_are_corrected_by_name() {
        let frozen = "shoulder_damping:\n  frozen: true\n  value:\n  - 7.0\n";
        let robot = corrected(&format!(
            "armature:\n  value:\n  - 0.05\nelbow_1_armature:\n  max_value:\n  - 9.0\n  value:\n  - 2.0e-02\n{frozen}\
             elbow_1/damping:\n  value: [0.25]\nfore_inertia:\n  value:\n  - 3.0\n  - 0.0\n  - 0.0\n  - -0.2\n"
        ))
        .unwrap();
        assert_eq!(robot.armature_kg_m2, [0.05, 0.02]);
        assert_eq!(robot.friction.iter().map(|f| f.viscous_nm_s_rad).collect::<Vec<_>>(), [1.0, 0.25]);
        assert_eq!(robot.friction[1].coulomb_nm, 0.5);
        let fore = &robot.standard_parameters.unwrap()[10..];
        let first_moment = (fore[6].powi(2) + fore[7].powi(2) + fore[8].powi(2)).sqrt();
        assert!((first_moment - 0.6).abs() < 1e-12 && fore[9] == 3.0, "{fore:?}");
        assert!(robot.notes.contains(&"frozen parameters are not applied: shoulder_damping".into()));
        assert!(
            robot
                .notes
                .iter()
                .any(|note| note.contains("`scale_rot_inertia`") && note.contains("fore_inertia"))
        );
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let value = |name: &str, value: &str| format!("{name}:\n  value:\n  - {value}\n");
        for (text, said) in [
            (value("elbow_2_damping", "1.0"), "p.yaml:1: elbow_2_damping: there is no joint `elbow_2`"),
            (value("hand_mass", "1.0"), "there is no body `hand`; known are upper, fore"),
            (value("mass", "1.0"), "there is no body ``"),
            (value("link1_mas", "1.0"), "ends in no quantity; known are armature, damping"),
            (value("damping", ".nan"), "p.yaml:3: - .nan: has no finite numbers"),
            (value("damping", "inf"), "p.yaml:3: - inf: has no finite numbers"),
            (value("elbow_1_damping", "-1.0"), "has the value -1, which no damping"),
            (value("fore_mass", "0.0"), "has the value 0, which no mass"),
            (value("fore_inertia", "1.0\n  - 2.0"), "has 2 numbers, and may have [1, 4, 10]"),
            (value("fore_inertia", &("999".to_owned() + &"\n  - 0".repeat(9))), "without finite mass"),
            ("damping:\n".to_owned(), "has 0 numbers, and may have [1]"),
            (
                "damping:\n  volume: 1\n".to_owned(),
                "p.yaml:2: volume: 1: is not a line of `ParameterDict.save_to_disk`",
            ),
            ("{\"damping\": 1}".to_owned(), "params_x_hat.yaml"),
        ] {
            let refused = corrected(&text).unwrap_err();
            assert!(refused.contains(said), "{text}: {refused}");
        }
    }
}
