//! Planned motions as MCAP with one `trajectory_msgs/msg/JointTrajectory`, which `joint_trajectory_controller` subscribes to.
//!
//! Source: `trajectory_msgs/msg/JointTrajectory.msg`, `JointTrajectoryPoint.msg`.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::RecordingError;
use crate::written::cdr::CdrWriter;
use crate::written::mcap::{McapWriter, STAMP_SCHEMAS};
use crate::written::planned_motion::PlannedMotion;

const JOINT_TRAJECTORY: &str = "\
std_msgs/Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint[] points
================================================================================
MSG: trajectory_msgs/JointTrajectoryPoint
float64[] positions
float64[] velocities
float64[] accelerations
float64[] effort
builtin_interfaces/Duration time_from_start
================================================================================
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
";
/// The topic of the controller that packages of robots usually start.
const TOPIC: &str = "/joint_trajectory_controller/joint_trajectory";

impl PlannedMotion {
    /// The motion as an MCAP file of ROS 2 with one message `trajectory_msgs/msg/JointTrajectory`. Its stamp is zero: controllers
    /// start it when they receive it.
    ///
    /// # Errors
    /// [`RecordingError::Malformed`] if the message does not fit an MCAP file; `path` is what it names.
    pub fn to_mcap(&self, path: &Path) -> Result<Vec<u8>, RecordingError> {
        let mut file = McapWriter::new(path)?;
        let definition = [JOINT_TRAJECTORY, STAMP_SCHEMAS].concat();
        let schema = file.schema("trajectory_msgs/msg/JointTrajectory", &definition)?;
        let channel = file.topic(schema, TOPIC, &BTreeMap::new())?;
        file.message(channel, 0, 0, &self.joint_trajectory())?;
        file.finish()
    }

    fn joint_trajectory(&self) -> Vec<u8> {
        let mut message = CdrWriter::default();
        message.time(0);
        message.text("");
        message.texts(&self.joint_names);
        message.word(self.time_s.len() as u32);
        for (sample, time_s) in self.time_s.iter().enumerate() {
            for series in [&self.position_rad, &self.velocity_rad_s, &self.acceleration_rad_s2] {
                message.numbers(series, sample);
            }
            message.numbers(&[], sample);
            message.time((time_s * 1e9).round() as u64);
        }
        message.finish()
    }
}
