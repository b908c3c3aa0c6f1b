use std::path::PathBuf;

use aurt_rbd::{MdhRows, MdhTable, gravity_complaint};

use super::{errors::Complaint, joint_count::JointCheck, section::Section};

/// `[robot]`: the arm itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// `mdh`: the file of modified Denavit–Hartenberg parameters.
    pub mdh: PathBuf,
    /// What that file holds, read as `mdh_rows` says (`"next"`, the default, or `"previous"`).
    pub table: MdhTable,
    /// `gravity_m_s2`: gravitational acceleration in the base frame.
    pub gravity_m_s2: [f64; 3],
    /// `torque_constants_nm_per_a`: torque per current of each joint's drive. With them currents become torques
    /// and the model is in Nm; without, it is in the unit of the measurement.
    pub torque_constants_nm_per_a: Option<Vec<f64>>,
}

impl Robot {
    /// Number of joints N.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.table.rows.len()
    }

    /// Reads `[robot]`; the number of joints is known even if other keys are wrong.
    pub(super) fn read(mut section: Section<'_, '_>) -> (Option<Self>, Option<usize>) {
        let mdh_node = section.require("mdh", "mdh = \"mdh.csv\"");
        let mdh = mdh_node.and_then(|node| section.file_of("mdh", node));
        let rows = section
            .choice("mdh_rows", &[("next", MdhRows::Next), ("previous", MdhRows::Previous)])
            .unwrap_or_default();
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
        let torque_constants_nm_per_a = section.take("torque_constants_nm_per_a").and_then(|node| {
            let key = "torque_constants_nm_per_a";
            let constants = section.numbers_of(key, node)?;
            if constants.contains(&0.0) {
                section.complain(key, node, "must not be zero", None);
                return None;
            }
            section.reader.check_joints(JointCheck::Length {
                key: key.to_owned(),
                found: constants.len(),
                span: node.span.clone(),
            });
            Some(constants)
        });
        let table = mdh_node.zip(mdh.as_ref()).and_then(|(node, path)| {
            MdhTable::from_path(path, rows)
                .map_err(|errors| {
                    for error in errors.0 {
                        section.reader.complain(Complaint::new(node.span.clone(), format!("`mdh`: {error}")));
                    }
                })
                .ok()
        });
        section.finish();
        let joints = table.as_ref().map(|t| t.rows.len());
        let robot = mdh.zip(table).zip(gravity_m_s2).map(|((mdh, table), gravity_m_s2)| Self {
            mdh,
            table,
            gravity_m_s2,
            torque_constants_nm_per_a,
        });
        (robot, joints)
    }
}
