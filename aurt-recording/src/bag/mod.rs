//! Bags of ROS 2 with `sensor_msgs/msg/JointState`, or with planned motions where these are accepted: MCAP, SQLite (`.db3`), and folders of several such files.

mod cdr;
mod container;
mod joint_state;
mod joint_trajectory;
mod joints;
mod mcap;
mod messages;
mod reading;
mod records;
mod sqlite;
mod topics;

pub use container::BAG;
pub(crate) use container::{BagFolder, described};
