//! Robots as they are described elsewhere: what is read, against other programs, and what is refused.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use aurt_rbd::robots::{self, DescribedRobot, RobotErrors};

mod known;
mod mdh;
mod mjcf;
mod mujoco;
mod parameters;
mod peer;
mod pinocchio;
mod urdf;

/// The chain to a tip; without one, all joints.
fn parse(
    text: &str,
    path: &str,
    base: Option<&str>,
    tip: Option<&str>,
) -> Result<DescribedRobot, RobotErrors> {
    robots::parse(text, path, base, &tip.into(), None)
}
