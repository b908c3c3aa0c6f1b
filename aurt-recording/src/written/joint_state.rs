//! Series of joints as MCAP with `sensor_msgs/msg/JointState`, which ROS 2 records.
//!
//! Source: `sensor_msgs/msg/JointState.msg`.

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::RecordingError;
use crate::written::cdr::CdrWriter;
use crate::written::mcap::{McapWriter, STAMP_SCHEMAS};

const JOINT_STATE: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
";

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
    let mut file = McapWriter::new(path)?;
    let schema = file.schema("sensor_msgs/msg/JointState", &[JOINT_STATE, STAMP_SCHEMAS].concat())?;
    let facts: BTreeMap<_, _> = facts.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    let channels =
        topics.iter().map(|topic| file.topic(schema, topic.name, &facts)).collect::<Result<Vec<_>, _>>()?;
    for (sample, stamp) in stamps_s.iter().enumerate() {
        let time_ns =
            (origin_s as i64).saturating_mul(1_000_000_000).saturating_add((stamp * 1e9).round() as i64);
        let time_ns = u64::try_from(time_ns).ok().filter(|ns| ns / 1_000_000_000 <= i32::MAX as u64);
        let Some(time_ns) = time_ns.filter(|_| stamp.is_finite()) else {
            return Err(RecordingError::clock(
                path,
                format!("the stamp {stamp} s is none that messages of ROS can have (1970 to 2038)"),
                "write Parquet or CSV, or shift the clock",
            ));
        };
        for (channel, topic) in channels.iter().copied().zip(topics) {
            file.message(channel, sample as u32, time_ns, &joint_state(time_ns, joints, topic, sample))?;
        }
    }
    file.finish()
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
