//! Series of joints as MCAP with `sensor_msgs/msg/JointState`: what ROS 2 records, and Foxglove, rerun and PlotJuggler open.
//!
//! Source: `sensor_msgs/msg/JointState.msg`; for CDR see `joint_state`.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions};

use crate::error::RecordingError;

const JOINT_STATE: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// What a topic says of all joints, as `[joint][sample]`; empty series are left out of its messages.
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
    let failed = |error: McapError| RecordingError::Malformed {
        path: path.to_owned(),
        place: "its messages".to_owned(),
        reason: error.to_string(),
        remedy: "write Parquet or CSV".to_owned(),
    };
    let options = WriteOptions::new().profile("ros2").library(concat!("aurt ", env!("CARGO_PKG_VERSION")));
    let mut file = options.compression(None).create(Cursor::new(Vec::new())).map_err(failed)?;
    let schema =
        file.add_schema("sensor_msgs/msg/JointState", "ros2msg", JOINT_STATE.as_bytes()).map_err(failed)?;
    let facts: BTreeMap<_, _> = facts.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    let add = |topic: &JointTopic<'_>| file.add_channel(schema, topic.name, "cdr", &facts).map_err(failed);
    let channels = topics.iter().map(add).collect::<Result<Vec<_>, _>>()?;
    for (sample, stamp) in stamps_s.iter().enumerate() {
        let time_ns =
            (origin_s as i64).saturating_mul(1_000_000_000).saturating_add((stamp * 1e9).round() as i64);
        let (seconds, rest) = (time_ns.div_euclid(1_000_000_000), time_ns.rem_euclid(1_000_000_000));
        let Some(seconds) = i32::try_from(seconds).ok().filter(|s| *s >= 0 && stamp.is_finite()) else {
            return Err(RecordingError::Clock {
                path: path.to_owned(),
                reason: format!("the stamp {stamp} s is none that messages of ROS can have (1970 to 2038)"),
                remedy: "write Parquet or CSV, or shift the clock".to_owned(),
            });
        };
        let (log_time, publish_time) = (time_ns as u64, time_ns as u64);
        for (channel_id, topic) in channels.iter().copied().zip(topics) {
            let message = cdr([seconds as u32, rest as u32], joints, topic, sample);
            let header = MessageHeader { channel_id, sequence: sample as u32, log_time, publish_time };
            file.write_to_known_channel(&header, &message).map_err(failed)?;
        }
    }
    file.finish().map_err(failed)?;
    Ok(file.into_inner().into_inner())
}

/// A message of a topic: seconds and nanoseconds, the joints' names, and their values at a sample.
fn cdr(stamp: [u32; 2], joints: &[String], topic: &JointTopic<'_>, sample: usize) -> Vec<u8> {
    let mut body = Vec::new();
    body.extend(stamp.iter().flat_map(|word| word.to_le_bytes()));
    word_text(&mut body, "");
    align(&mut body, 4);
    body.extend((joints.len() as u32).to_le_bytes());
    for name in joints {
        align(&mut body, 4);
        word_text(&mut body, name);
    }
    for series in [topic.position, topic.velocity, topic.effort] {
        align(&mut body, 4);
        body.extend((series.len() as u32).to_le_bytes());
        if !series.is_empty() {
            align(&mut body, 8);
        }
        for values in series {
            body.extend(values.get(sample).copied().unwrap_or(f64::NAN).to_le_bytes());
        }
    }
    let mut message = vec![0, 1, 0, 0];
    message.extend(body);
    message
}

/// A text with the zero that ends it.
fn word_text(body: &mut Vec<u8>, text: &str) {
    body.extend((text.len() as u32 + 1).to_le_bytes());
    body.extend(text.as_bytes());
    body.push(0);
}

fn align(body: &mut Vec<u8>, to: usize) {
    body.resize(body.len().next_multiple_of(to), 0);
}
