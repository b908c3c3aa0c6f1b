//! MCAP files of ROS 2: what Foxglove, rerun and PlotJuggler open. Series of joints are `sensor_msgs/msg/JointState`, which ROS 2
//! records; planned motions are one `trajectory_msgs/msg/JointTrajectory`, which `joint_trajectory_controller` subscribes to.
//!
//! Source: `sensor_msgs/msg/JointState.msg`, `trajectory_msgs/msg/JointTrajectory.msg`, `JointTrajectoryPoint.msg`.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};

use crate::error::RecordingError;
use crate::written::cdr::CdrWriter;
use crate::written::planned_motion::PlannedMotion;

/// Definitions that the messages share, in the form of `ros2msg` schemas.
const STAMP_SCHEMAS: &str = "\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

const JOINT_STATE: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
";

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

/// The states of all joints on a topic, as `[joint][sample]`; empty series are left out of its messages.
#[derive(Debug, Clone, Copy)]
pub struct JointTopic<'a> {
    /// Its name.
    pub name: &'a str,
    /// Positions, rad or m.
    pub position: &'a [Vec<f64>],
    /// Velocities, rad/s or m/s.
    pub velocity: &'a [Vec<f64>],
    /// Efforts, Nm or N.
    pub effort: &'a [Vec<f64>],
}

/// A file with a message of each topic at each stamp. Stamps count in s from `origin_s`, a whole number; `facts` stand with
/// every channel.
///
/// # Errors
/// [`RecordingError::Clock`] for stamps before 1970 or after 2038, which messages cannot have; `path` is what it names.
pub fn mcap(
    path: &Path,
    stamps_s: &[f64],
    origin_s: f64,
    joints: &[String],
    topics: &[JointTopic<'_>],
    facts: &[(&str, String)],
) -> Result<Vec<u8>, RecordingError> {
    let nanoseconds = |stamp: &f64| {
        let time_ns =
            (origin_s as i64).saturating_mul(1_000_000_000).saturating_add((stamp * 1e9).round() as i64);
        let time_ns = u64::try_from(time_ns).ok().filter(|ns| ns / 1_000_000_000 <= i32::MAX as u64);
        time_ns.filter(|_| stamp.is_finite()).ok_or_else(|| {
            RecordingError::clock(
                path,
                format!("the stamp {stamp} s is none that messages of ROS can have (1970 to 2038)"),
                "write Parquet or CSV, or shift the clock",
            )
        })
    };
    let stamps_ns = stamps_s.iter().map(nanoseconds).collect::<Result<Vec<_>, _>>()?;
    let facts = facts.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    written(path, |file| {
        let definition = [JOINT_STATE, STAMP_SCHEMAS].concat();
        let schema = file.add_schema("sensor_msgs/msg/JointState", "ros2msg", definition.as_bytes())?;
        let channels = topics.iter().map(|topic| file.add_channel(schema, topic.name, "cdr", &facts));
        let channels = channels.collect::<Result<Vec<_>, _>>()?;
        for (sample, time_ns) in stamps_ns.into_iter().enumerate() {
            for (channel, topic) in channels.iter().zip(topics) {
                let header = header(*channel, sample as u32, time_ns);
                file.write_to_known_channel(&header, &joint_state(time_ns, joints, topic, sample))?;
            }
        }
        Ok(())
    })
}

impl PlannedMotion {
    /// The motion as an MCAP file of ROS 2 with one message `trajectory_msgs/msg/JointTrajectory`. Its stamp is zero: controllers
    /// start it when they receive it.
    ///
    /// # Errors
    /// [`RecordingError::Malformed`] if the message does not fit an MCAP file; `path` is what it names.
    pub fn to_mcap(&self, path: &Path) -> Result<Vec<u8>, RecordingError> {
        written(path, |file| {
            let definition = [JOINT_TRAJECTORY, STAMP_SCHEMAS].concat();
            let name = "trajectory_msgs/msg/JointTrajectory";
            let schema = file.add_schema(name, "ros2msg", definition.as_bytes())?;
            let channel = file.add_channel(schema, TOPIC, "cdr", &BTreeMap::new())?;
            file.write_to_known_channel(&header(channel, 0, 0), &self.joint_trajectory())
        })
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

/// A file of the profile `ros2` with what `fill` adds; `path` is what errors name.
fn written(
    path: &Path,
    fill: impl FnOnce(&mut Writer<Cursor<Vec<u8>>>) -> Result<(), McapError>,
) -> Result<Vec<u8>, RecordingError> {
    let options = WriteOptions::new().profile("ros2").library(concat!("aurt ", env!("CARGO_PKG_VERSION")));
    let bytes = || {
        let mut file = options.compression(None).create(Cursor::new(Vec::new()))?;
        fill(&mut file)?;
        file.finish()?;
        Ok(file.into_inner().into_inner())
    };
    bytes().map_err(|error: McapError| {
        RecordingError::malformed(path, "its messages", error.to_string(), "write Parquet or CSV")
    })
}

const fn header(channel_id: u16, sequence: u32, time_ns: u64) -> MessageHeader {
    MessageHeader { channel_id, sequence, log_time: time_ns, publish_time: time_ns }
}

fn joint_state(time_ns: u64, joints: &[String], topic: &JointTopic<'_>, sample: usize) -> Vec<u8> {
    let mut message = CdrWriter::default();
    message.time(time_ns);
    message.text("");
    message.texts(joints);
    for series in [topic.position, topic.velocity, topic.effort] {
        message.numbers(series, sample);
    }
    message.finish()
}
