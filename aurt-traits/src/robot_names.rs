use crate::RigidBodyRegressor;

/// Joints and links of a robot as people read them: by name where the robot names them, by number, counted from 0, where
/// it does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RobotNames<'a> {
    /// Names of the joints; empty where they have none.
    pub joints: &'a [String],
    /// Names of the links; empty where they have none.
    pub links: &'a [String],
}

impl<'a> RobotNames<'a> {
    /// The names that rigid bodies carry.
    pub fn of(body: &'a dyn RigidBodyRegressor) -> Self {
        Self { joints: body.joint_names(), links: body.link_names() }
    }

    /// Names of joints alone.
    pub const fn of_joints(joints: &'a [String]) -> Self {
        Self { joints, links: &[] }
    }

    /// A joint in a sentence: `elbow_joint`, or `joint 2`.
    pub fn joint(&self, joint: usize) -> String {
        self.joints.get(joint).map_or_else(|| format!("joint {joint}"), |name| printable(name))
    }

    /// A joint under a heading that says "joint": `elbow_joint`, or `2`.
    pub fn joint_cell(&self, joint: usize) -> String {
        self.joints.get(joint).map_or_else(|| joint.to_string(), |name| printable(name))
    }

    /// Joints in a sentence: `elbow_joint and wrist_1_joint`, or `joints 2 and 3`.
    pub fn joint_list(&self, joints: &[usize]) -> String {
        self.joint_list_with(joints, |_| String::new())
    }

    /// Joints in a sentence, each followed by what `detail` says of it: `joints 2 (1.5 times) and 3 (2 times)`.
    pub fn joint_list_with(&self, joints: &[usize], detail: impl Fn(usize) -> String) -> String {
        let cells: Vec<String> =
            joints.iter().map(|joint| format!("{}{}", self.joint_cell(*joint), detail(*joint))).collect();
        let prefix = match (joints.iter().all(|joint| self.joints.get(*joint).is_some()), joints.len()) {
            (true, _) => "",
            (false, 1) => "joint ",
            (false, _) => "joints ",
        };
        match &cells[..] {
            [] => String::new(),
            [one] => format!("{prefix}{one}"),
            [first @ .., last] => format!("{prefix}{} and {last}", first.join(", ")),
        }
    }

    /// A link in a sentence: `wrist_3_link`, or `link 5`.
    pub fn link(&self, link: usize) -> String {
        let name = self.links.get(link).filter(|name| !name.trim().is_empty());
        name.map_or_else(|| format!("link {link}"), |name| printable(name))
    }
}

/// A name on one line.
fn printable(name: &str) -> String {
    name.replace(char::is_control, " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_called_by_name_where_they_have_one_and_by_number_where_not() {
        let own = ["base_joint", "elbow\n_joint", "wrist_joint"].map(str::to_owned);
        let (named, nameless) = (RobotNames::of_joints(&own), RobotNames::default());
        let all = [[0].as_slice(), &[0, 1], &[0, 1, 2], &[]];
        assert_eq!(
            all.map(|joints| named.joint_list(joints)),
            ["base_joint", "base_joint and elbow _joint", "base_joint, elbow _joint and wrist_joint", ""]
        );
        assert_eq!(
            all.map(|joints| nameless.joint_list(joints)),
            ["joint 0", "joints 0 and 1", "joints 0, 1 and 2", ""]
        );
        assert_eq!([named.joint(2), nameless.joint(2)], ["wrist_joint", "joint 2"]);
        assert_eq!([named.joint_cell(2), nameless.joint_cell(2)], ["wrist_joint", "2"]);
        assert_eq!([named.link(1), nameless.link(1)], ["link 1", "link 1"]);
        assert_eq!(nameless.joint_list_with(&[1, 2], |j| format!(" ({j} V)")), "joints 1 (1 V) and 2 (2 V)");
    }
}
