//! Joints of a robot beside its chain.

use serde::{Deserialize, Serialize};

/// A joint on which a part of the robot moves that is no part of the chain; the model carries that part at rest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Branch {
    /// Its name, by which recordings have it.
    pub joint: String,
    /// The joints of the chain between the base and the branch, whose torque its motion changes.
    pub upstream: Vec<usize>,
    /// First moment that a unit of its motion displaces, kg m/rad, or kg for a joint that slides; `None` if no masses are
    /// stated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displaced: Option<f64>,
    /// Whether it slides: its positions are in m.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slides: bool,
    /// Whether it carries the base: its motion moves all joints of the chain, and where it stands turns gravity.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub carries_base: bool,
}
