//! Robots known by name.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

use aurt_files::suggestion::likely;
use serde::Deserialize;

use crate::robots::pose::{Pose, along};
use crate::robots::{DescribedRobot, JointFriction, JointLimits, Part};
use crate::{Joint, Placement};

/// All known robots, by name.
#[expect(clippy::expect_used, reason = "the file is part of the program, and tests read it")]
pub static KNOWN_ROBOTS: LazyLock<Vec<KnownRobot>> =
    LazyLock::new(|| toml::from_str::<Arms>(include_str!("arms.toml")).expect("known robots").robots);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Arms {
    robots: Vec<KnownRobot>,
}

/// An arm of revolute joints whose geometry and limits are public.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct KnownRobot {
    /// What experiment files call it: `ur10e`.
    pub name: String,
    /// Maker and model.
    pub title: String,
    /// Where geometry and limits are from.
    pub source: String,
    /// Names of its joints in its ROS description, where they are not `numbered`.
    joint_names: Vec<String>,
    /// The word before the number of each joint, counted from 1.
    numbered: String,
    /// Modified Denavit–Hartenberg parameters: twist in quarters of a turn (−1, 0 or 1), a and d in m.
    mdh: Vec<[f64; 3]>,
    /// Origins of the joints' frames in those of the joints before, in m; roll, pitch and yaw in quarters of a turn.
    frames: Vec<[f64; 6]>,
    /// Axes in the joints' frames; of none, z.
    axes: Vec<[f64; 3]>,
    /// Lowest and highest positions; joints that turn without end have no room between them.
    position_deg: Vec<[f64; 2]>,
    position_rad: Vec<[f64; 2]>,
    velocity_deg_s: Vec<f64>,
    velocity_rad_s: Vec<f64>,
    /// Empty where the source says nothing.
    torque_nm: Vec<f64>,
}

/// The known robot of a name, in any mixture of upper and lower case.
pub fn known_robot(name: &str) -> Option<&'static KnownRobot> {
    KNOWN_ROBOTS.iter().find(|robot| robot.name.eq_ignore_ascii_case(name))
}

/// The known robot whose name is nearest to an unknown one.
pub fn probably_meant(name: &str) -> Option<&'static str> {
    likely(name, KNOWN_ROBOTS.iter().map(|robot| &*robot.name))
}

impl KnownRobot {
    /// Names of the joints in the robot's ROS description.
    pub fn joint_names(&self) -> Vec<String> {
        if !self.joint_names.is_empty() {
            return self.joint_names.clone();
        }
        (1..=self.joints()).map(|j| format!("{}{j}", self.numbered)).collect()
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.mdh.len() + self.frames.len()
    }

    /// The chain from the base to the last joint; without masses, which makers do not publish.
    pub fn description(&self) -> DescribedRobot {
        let mut here = Pose::identity();
        let mut joints = Vec::new();
        let mut frames = Vec::new();
        let of_row =
            |&[alpha, a_m, d_m]: &[f64; 3]| [a_m, -d_m * alpha, d_m * (1.0 - alpha * alpha), alpha, 0.0, 0.0];
        for (j, [x, y, z, roll, pitch, yaw]) in
            self.mdh.iter().map(of_row).chain(self.frames.iter().copied()).enumerate()
        {
            let angles = [roll, pitch, yaw].map(|quarters| quarters * FRAC_PI_2);
            let at_joint = here.then(&Pose::of(Placement::from_roll_pitch_yaw([x, y, z], angles)));
            let (turn, sign) = along(&self.axes.get(j).copied().unwrap_or([0.0, 0.0, 1.0]).into());
            let placement = at_joint.then(&Pose::turned(turn)).placement();
            joints.push(Joint { sign, ..Joint::revolute(placement) });
            frames.push(turn.transpose().into());
            here = Pose::turned(turn.transpose());
        }
        DescribedRobot {
            name: self.name.clone(),
            base: "base".into(),
            tip: "flange".into(),
            part: Part::All,
            joint_names: self.joint_names(),
            link_names: Vec::new(),
            couplings: Vec::new(),
            limits: self.limits(),
            friction: vec![JointFriction::default(); joints.len()],
            armature_kg_m2: vec![0.0; joints.len()],
            joints,
            standard_parameters: None,
            frames,
            branches: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// The limits of the joints. Where a source gives them in rad, they are in degrees to its digits on the way.
    fn limits(&self) -> Vec<JointLimits> {
        let degrees = |radians: f64| radians * (180.0 / PI);
        let positions = self.position_rad.iter().map(|limits| limits.map(degrees));
        let velocities = self.velocity_rad_s.iter().copied().map(degrees);
        let positions = self.position_deg.iter().copied().chain(positions);
        let velocities = self.velocity_deg_s.iter().copied().chain(velocities);
        let limits = |(j, ([low, high], velocity)): (usize, ([f64; 2], f64))| JointLimits {
            position_rad: (low < high).then(|| [low, high].map(f64::to_radians)),
            velocity_rad_s: Some(velocity.to_radians()),
            torque_nm: self.torque_nm.get(j).copied(),
        };
        positions.zip(velocities).enumerate().map(limits).collect()
    }
}
