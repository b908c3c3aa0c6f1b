use std::sync::Arc;

use aurt::data::Instrument;
use aurt_plugins::Node;
use aurt_rbd::robots::{DescribedRobot, Part, known_robot};
use aurt_rbd::{MdhRows, MdhTable, RbdError, RobotDescription, gravity_complaint};
use aurt_recording::RobotJoints;
use aurt_traits::RigidBodyRegressor;

use super::errors::Complaint;
use super::geometry::Geometry;
use super::recorded_as;
use super::section::Section;

/// `[robot]`: the arm itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// `mdh`, `urdf` or `name`: links and joints.
    pub geometry: Geometry,
    /// `gravity_m_s2`: gravitational acceleration in the base frame.
    pub gravity_m_s2: [f64; 3],
    /// `joint_names`: the joints by name, base first; by default those of the description, else those that `[recordings]`
    /// states. Empty where nothing names them.
    pub joint_names: Vec<String>,
}

impl Robot {
    pub fn joints(&self) -> usize {
        self.geometry.joints()
    }

    pub fn rigid_body(&self) -> Result<Arc<dyn RigidBodyRegressor>, RbdError> {
        match &self.geometry {
            Geometry::Mdh { table, .. } => {
                let chain = table.chain(self.gravity_m_s2)?;
                Ok(Arc::new(chain.with_joint_names(self.joint_names.clone())?))
            }
            Geometry::Urdf { robot, .. } | Geometry::Known(robot) => {
                let named = DescribedRobot { joint_names: self.joint_names.clone(), ..(**robot).clone() };
                named.rigid_body(self.gravity_m_s2)
            }
        }
    }

    pub fn robot_joints(&self) -> RobotJoints {
        RobotJoints {
            count: self.joints(),
            names: self.joint_names.clone(),
            branches: self.geometry.branches().to_vec(),
            sliding: self.geometry.sliding(),
        }
    }

    /// Reads `[robot]`; the number of joints is known even if other keys are wrong. What of it concerns the instrument goes there.
    pub(super) fn read(
        mut section: Section<'_, '_>,
        instrument: &mut Instrument,
    ) -> (Option<Self>, Option<usize>) {
        let geometry = read_geometry(&mut section);
        let gravity_m_s2 =
            section.require("gravity_m_s2", "gravity_m_s2 = [0.0, 0.0, -9.81]").and_then(|node| {
                let gravity =
                    section.numbers_exactly("gravity_m_s2", node, "x, y, z in m/s² in the base frame")?;
                if let Some(reason) = gravity_complaint(gravity) {
                    section.complain("gravity_m_s2", node, &reason, None);
                    return None;
                }
                Some(gravity)
            });
        instrument.torque_constants_nm_per_a = section.factors("torque_constants_nm_per_a");
        let stated = section.take("joint_names").and_then(|node| recorded_as::joint_names(&section, node));
        section.finish();
        let joints = geometry.as_ref().map(RobotDescription::joints);
        let robot = geometry.zip(gravity_m_s2).map(|(geometry, gravity_m_s2)| Self {
            joint_names: stated.unwrap_or_else(|| geometry.joint_names().to_vec()),
            geometry,
            gravity_m_s2,
        });
        (robot, joints)
    }
}

/// The geometry by the one of `mdh`, `urdf`, `mjcf` and `name` that is there.
fn read_geometry(section: &mut Section<'_, '_>) -> Option<Geometry> {
    let (urdf, mjcf) = (section.take("urdf"), section.take("mjcf"));
    let name = section.take("name");
    let base = section.take("base");
    let parts = ["tip", "tips", "joints"].map(|key| (key, section.take(key)));
    let mdh = if urdf.is_some() || mjcf.is_some() || name.is_some() {
        section.take("mdh")
    } else {
        section.require(
            "mdh",
            "mdh = \"mdh.csv\", urdf = \"robot.urdf\", mjcf = \"robot.xml\" or name = \"ur10e\"",
        )
    };
    let rows = section.choice("mdh_rows", &[("next", MdhRows::Next), ("previous", MdhRows::Previous)]);
    let given = [("mdh", mdh), ("urdf", urdf), ("mjcf", mjcf), ("name", name)];
    let given: Vec<(&str, &Node)> = given.into_iter().filter_map(|(key, node)| Some((key, node?))).collect();
    if let [(first, _), (second, node), ..] = given[..] {
        section.complain(second, node, &format!("is a second geometry beside `{first}`; remove one"), None);
        return None;
    }
    for (key, node) in [("base", base)].into_iter().chain(parts) {
        if let Some(node) = node.filter(|_| urdf.is_none() && mjcf.is_none()) {
            let what = if key == "base" || key == "tip" { "a link" } else { "a part" };
            section.complain(
                key,
                node,
                &format!("chooses {what} of a `urdf` or `mjcf`, which is not given"),
                None,
            );
        }
    }
    let parts: Vec<(&str, &Node)> = parts.into_iter().filter_map(|(key, node)| Some((key, node?))).collect();
    if let [(first, _), (second, node), ..] = parts[..] {
        let reason = format!("is a second choice beside `{first}` of what moves; remove one");
        section.complain(second, node, &reason, None);
        return None;
    }
    match *given.first()? {
        ("mdh", node) => read_mdh(section, node, rows.unwrap_or_default()),
        (key @ ("urdf" | "mjcf"), node) => {
            let path = section.file_of(key, node)?;
            let base = base.and_then(|node| section.text_of("base", node));
            let part = match parts.first() {
                None => Part::All,
                Some(("tip", node)) => Part::from(Some(section.text_of("tip", node)?)),
                Some((key, node)) => {
                    let of = if *key == "tips" { "links" } else { "joints" };
                    let names = recorded_as::names(section, key, of, node)?;
                    if names.is_empty() {
                        section.complain(key, node, "names nothing; leave it out for all joints", None);
                        return None;
                    }
                    if *key == "tips" { Part::Tips(names) } else { Part::Joints(names) }
                }
            };
            let robot = aurt_rbd::robots::read(&path, base, &part, None)
                .map_err(|errors| {
                    for error in errors.0 {
                        section
                            .reader
                            .complain(Complaint::new(node.span.clone(), format!("`{key}`: {error}")));
                    }
                })
                .ok()?;
            Some(Geometry::Urdf { path, robot: Box::new(robot) })
        }
        (_, node) => {
            let name = section.text_of("name", node)?;
            let known = known_robot(name);
            if known.is_none() {
                let meant = aurt_rbd::robots::probably_meant(name);
                let meant = meant.map(|name| format!("did you mean \"{name}\"? ")).unwrap_or_default();
                let help = format!(
                    "{meant}`aurt robots` lists those that are known; others need `mdh`, `urdf` or `mjcf`"
                );
                section.complain("name", node, &format!("names no known robot, is \"{name}\""), Some(help));
            }
            Some(Geometry::Known(Box::new(known?.description())))
        }
    }
}

fn read_mdh(section: &Section<'_, '_>, node: &Node, rows: MdhRows) -> Option<Geometry> {
    let path = section.file_of("mdh", node)?;
    let table = MdhTable::from_path(&path, rows)
        .map_err(|errors| {
            for error in errors.0 {
                section.reader.complain(Complaint::new(node.span.clone(), format!("`mdh`: {error}")));
            }
        })
        .ok()?;
    Some(Geometry::Mdh { path, table })
}
