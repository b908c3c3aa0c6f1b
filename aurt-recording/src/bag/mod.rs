//! Bags of ROS 2 with `sensor_msgs/msg/JointState`: MCAP, SQLite (`.db3`), and folders of several such files.

mod container;
mod folder;
mod joint_state;
mod joints;
mod mcap;
mod messages;
mod reading;
mod records;
mod sqlite;
mod topics;

pub use container::Bag;
pub(crate) use folder::{BagFolder, described};
