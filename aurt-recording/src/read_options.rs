use aurt_traits::MeasurementUnit;

use crate::branches::BranchTrack;
use crate::error::RecordingError;
use crate::recorded_as::{ColumnSelection, RecordedAs};
use crate::recording::RecordedJoints;
use crate::robot_joints::RobotJoints;

/// What to read, and which defects to accept.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// The joints of the robot; `None`: as many as there are position columns.
    pub joints: Option<RobotJoints>,
    /// Columns that are not to be found by their names.
    pub columns: ColumnSelection,
    /// Unit of the measurement; `None`: from the column names.
    pub unit: Option<MeasurementUnit>,
    /// What the file does not tell of itself.
    pub recorded: RecordedAs,
    /// Whether a file without positions is an error.
    pub needs_position: bool,
    /// Whether a recording without measurement is an error.
    pub needs_measurement: bool,
    /// A bag without joint states may be a planned motion (`trajectory_msgs/msg/JointTrajectory`).
    pub accepts_plan: bool,
    /// Share of rows that may be corrupt (finite but absurd values, time going back); they are dropped and
    /// reported. More is an error.
    pub max_corrupt_share: f64,
    /// Positions beyond this are corrupt, in rad.
    pub position_limit_rad: f64,
    /// Velocities beyond this are corrupt, in rad/s.
    pub velocity_limit_rad_s: f64,
    /// Measurements beyond this are corrupt, in the measurement's unit.
    pub measurement_limit: f64,
    /// Most memory, in bytes, that reading may take; `None`: 20 × the file + 200 MB. Text, which does not unpack to more than
    /// a few times its size, is not measured by it.
    pub memory_bytes: Option<u64>,
    /// Whether rows come from a machine that runs on: a needed cell that is no finite number makes its row corrupt
    /// instead of ending the reading, and the share of corrupt rows is judged at every piece, since no end may come.
    pub is_running: bool,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            joints: None,
            columns: ColumnSelection::default(),
            unit: None,
            recorded: RecordedAs::default(),
            needs_position: true,
            needs_measurement: true,
            accepts_plan: false,
            max_corrupt_share: 0.01,
            position_limit_rad: 1e4,
            velocity_limit_rad_s: 1e4,
            measurement_limit: 1e6,
            memory_bytes: None,
            is_running: false,
        }
    }
}

impl ReadOptions {
    /// The names of the robot's joints; empty where they have none.
    pub(crate) fn robot_names(&self) -> &[String] {
        self.joints.as_ref().map_or(&[], |robot| &robot.names)
    }

    /// The names of the joints to be read, in the robot's order; empty where nothing names them.
    pub(crate) fn joint_names(&self) -> &[String] {
        let stated = self.recorded.joint_names.as_deref();
        self.joints.as_ref().map_or_else(|| stated.unwrap_or_default(), |robot| robot.wanted(stated))
    }

    /// The joints of series that are in the order of [`Self::joint_names`], or, without any, those of `found`.
    pub(crate) fn joints_read(&self, found: &[String]) -> RecordedJoints {
        if !self.robot_names().is_empty() {
            return RecordedJoints::Named(self.robot_names().to_vec());
        }
        match &self.recorded.joint_names {
            Some(stated) => RecordedJoints::Stated(stated.clone()),
            None if found.is_empty() => RecordedJoints::Unnamed,
            None => RecordedJoints::Named(found.to_vec()),
        }
    }

    /// The joints beside the robot's chain, with nothing seen of them yet.
    pub(crate) fn branch_tracks(&self) -> Vec<BranchTrack> {
        let branches = self.joints.iter().flat_map(|robot| &robot.branches);
        branches.map(|branch| BranchTrack::new(branch.joint.clone())).collect()
    }

    pub(crate) fn slides(&self, joint: usize) -> bool {
        self.joints.as_ref().is_some_and(|robot| robot.slides(joint))
    }

    pub(crate) fn branch_slides(&self, joint: &str) -> bool {
        let mut branches = self.joints.iter().flat_map(|robot| &robot.branches);
        branches.any(|branch| branch.joint == joint && branch.slides)
    }

    pub(crate) fn joint_count(&self) -> Option<usize> {
        self.joints.as_ref().map(|robot| robot.count)
    }

    pub(crate) fn validate(&self) -> Result<(), RecordingError> {
        self.recorded.validate()?;
        let value = self.max_corrupt_share;
        if !(0.0..=1.0).contains(&value) {
            let remedy = "it is a share between 0 and 1";
            return Err(RecordingError::option("max_corrupt_share", value, remedy));
        }
        let limits = [
            ("position_limit_rad", self.position_limit_rad),
            ("velocity_limit_rad_s", self.velocity_limit_rad_s),
            ("measurement_limit", self.measurement_limit),
        ];
        for (option, value) in limits {
            if value.is_nan() || value <= 0.0 {
                return Err(RecordingError::option(option, value, "it must be a positive number"));
            }
        }
        Ok(())
    }
}
