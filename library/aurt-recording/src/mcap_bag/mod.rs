//! MCAP, the container that ROS 2 records into.
//!
//! Source: the MCAP specification, <https://mcap.dev/spec>. Of its fifteen kinds of records a recording needs four; the crate
//! `mcap` brings two C libraries and some twenty crates, hence this reader.

mod joints;
mod messages;
mod records;
mod topics;

use crate::csv::Table;
use crate::mcap_bag::joints::Joints;
use crate::mcap_bag::messages::Messages;
use crate::mcap_bag::topics::Topic;
use crate::{ReadOptions, Recording, RecordingError, RecordingFormat, RecordingInput};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Bags in MCAP with `sensor_msgs/msg/JointState` in CDR, chunks uncompressed, lz4 or zstd.
///
/// The only topic of joint states is read, or the one that is stated, or `/joint_states` if it is among several. Joints are
/// put in the robot's order by their names where [`joint_names`](crate::RecordedAs::joint_names) gives it, else they stay in
/// the order of the message. Stamps are those of the messages' headers, or of the recorder if headers have none. Messages
/// are decoded one by one, nothing is held. A file that breaks off is read as far as it goes, and a remark says so.
#[derive(Debug, Clone, Copy)]
pub struct McapBag;

impl RecordingFormat for McapBag {
    fn name(&self) -> &'static str {
        "MCAP"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["mcap"]
    }

    fn recognises(&self, beginning: &[u8]) -> bool {
        beginning.starts_with(MAGIC)
    }

    fn read(
        &self,
        input: RecordingInput<'_>,
        options: &ReadOptions,
        piece_rows: usize,
        visit: &mut dyn FnMut(&Recording) -> Result<(), RecordingError>,
    ) -> Result<Recording, RecordingError> {
        let path = input.path;
        let (topic, remark) = Topic::choose(&input, options.recorded.topic.as_deref())?;
        let messages = Messages::new(path, input.rewound()?, &topic);
        let mut joints = Joints::open(messages, path, &topic, options)?;
        let names = joints.columns();
        let count = names.len();
        let mut table = Table::new(path, names, count, options)?;
        table.belongs_to(options.joints_read(joints.names()));
        remark.into_iter().for_each(|r| table.remark(r));
        joints.remarks().into_iter().for_each(|r| table.remark(r));
        let wanted = table.wanted();
        let format = format!("MCAP, topic {}", topic.name);
        let mut all = vec![0.0; count];
        let mut recording = table.read(format, piece_rows, visit, &mut |row| {
            if !joints.next(&mut all)? {
                return Ok(false);
            }
            for (value, column) in row.iter_mut().zip(&wanted) {
                *value = all[*column];
            }
            Ok(true)
        })?;
        recording.report.remarks.extend(joints.closing_remarks());
        recording.report.origin_s = joints.origin_s();
        Ok(recording)
    }
}
