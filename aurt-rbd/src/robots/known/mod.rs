//! Robots known by name.

mod arms;

use std::f64::consts::FRAC_PI_2;

use aurt_files::suggestion::likely;

use crate::{Joint, Placement};

use crate::robots::pose::{Pose, along};
use crate::robots::{DescribedRobot, JointFriction, JointLimits, Part};

pub use arms::KNOWN_ROBOTS;

/// An arm of revolute joints whose geometry and limits are public.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownRobot {
    /// What experiment files call it: `ur10e`.
    pub name: &'static str,
    /// Maker and model.
    pub title: &'static str,
    /// Where geometry and limits are from.
    pub source: &'static str,
    joint_names: JointNames,
    joints: &'static [KnownJoint],
}

/// How the ROS description of a robot names its joints.
#[derive(Debug, Clone, Copy, PartialEq)]
enum JointNames {
    Each(&'static [&'static str]),
    /// This and a number, counted from 1.
    Numbered(&'static str),
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct KnownJoint {
    /// Origin of the joint's frame in that of the joint before, in m.
    origin_m: [f64; 3],
    /// Roll, pitch and yaw of the joint's frame, in quarters of a turn.
    quarters: [f64; 3],
    /// The axis in the joint's frame.
    axis: [f64; 3],
    /// Lowest and highest position in degrees; `None` if it turns without end.
    position_deg: Option<[f64; 2]>,
    velocity_deg_s: f64,
    /// `None` where the source says nothing.
    torque_nm: Option<f64>,
}

/// The known robot of a name, in any mixture of upper and lower case.
pub fn known_robot(name: &str) -> Option<&'static KnownRobot> {
    KNOWN_ROBOTS.iter().find(|robot| robot.name.eq_ignore_ascii_case(name))
}

/// The known robot whose name is nearest to an unknown one.
pub fn probably_meant(name: &str) -> Option<&'static str> {
    likely(name, KNOWN_ROBOTS.iter().map(|robot| robot.name))
}

impl KnownRobot {
    /// Names of the joints in the robot's ROS description.
    pub fn joint_names(&self) -> Vec<String> {
        match self.joint_names {
            JointNames::Each(names) => names.iter().map(|&name| name.to_owned()).collect(),
            JointNames::Numbered(name) => (1..=self.joints.len()).map(|j| format!("{name}{j}")).collect(),
        }
    }

    /// Number of joints.
    pub const fn joints(&self) -> usize {
        self.joints.len()
    }

    /// The chain from the base to the last joint; without masses, which makers do not publish.
    pub fn description(&self) -> DescribedRobot {
        let mut here = Pose::identity();
        let mut joints = Vec::new();
        let mut frames = Vec::new();
        for joint in self.joints {
            let angles = joint.quarters.map(|q| q * FRAC_PI_2);
            let at_joint = here.then(&Pose::of(Placement::from_roll_pitch_yaw(joint.origin_m, angles)));
            let (turn, sign) = along(&joint.axis.into());
            let placement = at_joint.then(&Pose::turned(turn)).placement();
            joints.push(Joint { sign, ..Joint::revolute(placement) });
            frames.push(turn.transpose().into());
            here = Pose::turned(turn.transpose());
        }
        let limits = self.joints.iter().map(|joint| JointLimits {
            position_rad: joint.position_deg.map(|limits| limits.map(f64::to_radians)),
            velocity_rad_s: Some(joint.velocity_deg_s.to_radians()),
            torque_nm: joint.torque_nm,
        });
        DescribedRobot {
            name: self.name.into(),
            base: "base".into(),
            tip: "flange".into(),
            part: Part::All,
            joint_names: self.joint_names(),
            link_names: Vec::new(),
            joints,
            couplings: Vec::new(),
            limits: limits.collect(),
            friction: vec![JointFriction::default(); self.joints.len()],
            armature_kg_m2: vec![0.0; self.joints.len()],
            standard_parameters: None,
            frames,
            branches: Vec::new(),
            notes: Vec::new(),
        }
    }
}
