//! Robots as they are described elsewhere: what is read, against other programs, and what is refused.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod known;
mod mdh;
mod mjcf;
mod mujoco;
mod parameters;
mod peer;
mod pinocchio;
mod urdf;
