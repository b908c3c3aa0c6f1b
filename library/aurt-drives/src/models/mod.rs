//! Drives, one a file.

mod current;
mod pd_law;
mod position_servo;
mod torque;
mod voltage;

pub use current::CurrentDrive;
pub use pd_law::PdLaw;
pub use position_servo::PositionServo;
pub use torque::TorqueDrive;
pub use voltage::VoltageDrive;
